"""Jumps, algebraic points and splines of a right side or a density, in closed form."""
