"""Measurements of the solver: error against run time, cost against size, peers, extreme scenes.

No other room imports this one; the commands `contact bench` and `contact stability` load it on
demand.
"""
