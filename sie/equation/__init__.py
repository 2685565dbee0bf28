"""The equation as data: kernel, right side, columns and side conditions, checked once."""
