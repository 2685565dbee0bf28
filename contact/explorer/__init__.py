"""A page with sliders: a scene comes in; surfaces, pressure, load curve, stated error and its text
go out, on this machine alone.
"""
