"""The density: its values, transforms and potentials anywhere, from its coefficients."""
