"""Measurements of the solver: error, run time, memory, extreme scenes, and other codes (peers).

No other package imports this one; the commands `contact bench` and `contact stability` load it on
demand.
"""
