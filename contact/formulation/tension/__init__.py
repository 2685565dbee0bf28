"""A constant tension beside the contact: its intervals, the zones within them, equilibria of both,
fields of surfaces that touch or not.
"""
