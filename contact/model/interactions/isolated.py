"""One punch, nothing else: equation (6), and (34) for several zones."""

from __future__ import annotations

from dataclasses import dataclass

from contact.model.checks import positive_or_none
from contact.model.interactions.base import Interaction
from contact.model.registry import register_interaction


@register_interaction("isolated")
@dataclass(frozen=True)
class Isolated(Interaction):
    """The line load of the substrate, on a half-plane 1/(x - xi) (Muskhelishvili 1953). A periodic profile is its one cell.

    datum: the distance d [m] from a line load at which it displaces nothing, on a half-plane u(x) = -(2/(pi E*)) int p ln|(x - xi)/d| dxi;
    without it a body without a base has no approach.
    """

    datum: float | None = None
    allows = ("load", "mean_pressure", "approach", "half_width")
    turns = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "datum", positive_or_none("datum", self.datum))
