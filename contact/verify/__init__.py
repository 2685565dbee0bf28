"""Checks of a solution: fields come in, a certificate and a stated error go out."""
