"""Measurements of the solver: error, run time, memory, peers, extreme scenes.

No other package imports this one; the commands `contact bench` and `contact stability` load it on
demand.
"""
