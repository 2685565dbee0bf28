"""What a solution can be asked for beyond its density: report, figure, capacity, derivatives."""
