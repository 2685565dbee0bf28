"""The rows of an equation on given intervals as a matrix, and the numbers of unknowns."""
