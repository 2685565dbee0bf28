"""Jumps of a right side, or of a density, and splines: each in, its transform and potential in
closed form out.
"""
