"""One punch on a half-plane, nothing else: equation (6), and (34) for several zones."""

from __future__ import annotations

from dataclasses import dataclass

import sie
from contact.model.checks import positive_or_none
from contact.model.interactions.base import Interaction
from contact.model.registry import register_interaction


@register_interaction("isolated")
@dataclass(frozen=True)
class Isolated(Interaction):
    """K = 1/(x - xi) (Muskhelishvili 1953). A periodic profile is its one cell.

    datum: the length d [m] of u(x) = -(2/(pi E*)) int p ln|(x - xi)/d| dxi; without it a half-plane has no approach.
    """

    datum: float | None = None
    allows = ("load", "mean_pressure", "approach", "half_width")
    turns = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "datum", positive_or_none("datum", self.datum))

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        return sie.cauchy(1.0 if self.datum is None else self.datum / unit)
