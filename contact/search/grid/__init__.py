"""A scene in, the scaled problem and about where its zones are out: a coarse contact on ever finer
grids.
"""
