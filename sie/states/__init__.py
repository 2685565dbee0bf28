"""Solutions on given zones, by a matrix or by iteration, with their stated errors."""
