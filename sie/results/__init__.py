"""Results of a solution beyond its density: report, figure, capacity and derivatives."""
