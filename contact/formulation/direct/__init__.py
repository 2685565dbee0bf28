"""Scenes that are one interval of a line, without a coupled system: in, a symmetric profile and
loads; out, ends, pressure, error.
"""
