"""A scene solved on a grid of values of its parameters; the result is a table of numbers."""
