"""Strategies to find the contact of a `SolveContext`; a strategy that fails returns a `Failure`."""
