"""The equation of many zones without its matrix: fast sums and preconditioned GMRES."""
