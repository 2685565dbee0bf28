"""Limits of loops that all modules of contact.adhesion share."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchLimits:
    """Limits of loops that usually end long before: larger limits only delay a failure."""

    max_newton_steps: int = 80
    # Halvings and doublings: about as many as a double has bits.
    max_bisections: int = 60
    # Steps of a search that widens or lowers something by a factor, and events in a row.
    max_tries: int = 200
    # Steps of a flow, of a curve and of growth on a grid.
    max_steps: int = 3000


LIMITS = SearchLimits()
