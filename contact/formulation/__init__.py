"""A scene as a scaled equation, by its pressure, by its gaps or in full contact.

A scene comes in; fields in SI units go out.
"""
