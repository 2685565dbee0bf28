"""Stresses inside the body: a solution comes in, stresses and the load of first yield go out."""
