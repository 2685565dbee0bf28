"""Newton's method for the ends of the zones, from an equation and a first guess of the zones."""
