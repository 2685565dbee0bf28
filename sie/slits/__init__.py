"""Intervals beside narrow gaps, taken as one wide interval with slits: the same equation in, the
same density out.
"""
