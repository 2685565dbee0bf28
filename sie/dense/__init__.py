"""An equation on given intervals in, the density out: how many functions, rows, the solve, and what
rounding does to it.
"""
