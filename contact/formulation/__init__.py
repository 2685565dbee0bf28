"""A scene as a scaled equation, by its pressure, by its gaps, or in full contact; a density in,
fields in SI units out.
"""
