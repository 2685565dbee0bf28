"""Stresses inside the body: what comes in is a solution, what goes out stresses and first yield."""
