"""Localized contact: in, a scene in which one strip is solved exactly; out, its zones.

A strip is one period of the profile.
"""
