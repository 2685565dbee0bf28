"""Solutions on given zones, by a matrix or by iteration, and their stated errors."""
