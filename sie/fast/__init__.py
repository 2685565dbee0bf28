"""The equation of many zones without its matrix: fast sums over trees, and preconditioned GMRES."""
