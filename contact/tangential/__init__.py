"""Contacts in full sliding: a `SolveContext` comes in, zones with their stated error go out."""
