"""Measurements of the solver: error against run time, cost against size, peers, and stiff or
extreme scenes.

Nothing else of the package imports this one; the commands `contact bench` and `contact stability`
load it on demand.
"""
