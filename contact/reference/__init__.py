"""Exact solutions and inverse design; nothing here imports the solver."""
