"""Equations of the second kind, kappa phi + T phi = g, whose density has other exponents than 1/2."""
