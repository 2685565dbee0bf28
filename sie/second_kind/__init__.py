"""Equations of the second kind, kappa phi + T phi = g, with other exponents than 1/2."""
