"""A scene over a grid of values of its parameters: a scene and lists of values come in, a table of
numbers on that grid goes out.
"""
