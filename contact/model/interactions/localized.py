"""The localization principle of Goryacheva & Tsukanov (2020, doi 10.3389/fmech.2020.00045), equation (13).

The zones of one strip are solved exactly, with m copies of the strip on each side kept explicitly; beyond the width
W = (2m + 1) L only the nominal pressure acts, which adds

    (2 pbar / pi) artanh(2 (x - centre) / W)

to the right side, and to the displacement what a uniform pressure on everything but the strip does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import sie
from contact.errors import SceneError
from contact.model.checks import integer, one_of
from contact.model.interactions.base import Interaction
from contact.model.registry import register_interaction

Array = NDArray[np.float64]

_INSIDE = 1 - 1e-15

CLOSURES = ("first-order", "self-consistent")


@register_interaction("localized")
@dataclass(frozen=True)
class Localized(Interaction):
    """One strip solved exactly, the rest of the surface as its nominal pressure, self-consistent or to first order.

    closure: what pbar is. "first-order" takes the isolated load of the same total width over L, as the paper's worked
    examples do; "self-consistent" takes the load itself. neighbours: m, self-consistent only if above 0.
    """

    closure: str = "first-order"
    neighbours: int = 0
    needs_period = True
    allows = ("load", "mean_pressure", "approach", "half_width")
    exact = False
    strip = True

    def __post_init__(self) -> None:
        one_of("closure", self.closure, CLOSURES)
        integer("neighbours", self.neighbours)
        if self.neighbours and self.follows_isolated:
            raise SceneError.of("neighbours", self.neighbours, "0 with closure 'first-order'; more are self-consistent")

    @property
    def follows_isolated(self) -> bool:
        return self.closure == "first-order"

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        assert period is not None
        return sie.images(period, self.neighbours, datum=period)

    def columns(self, period: float | None, centre: float) -> tuple[sie.Forcing, ...]:
        """The nominal pressure beyond the strip and, as its primitive, the potential of a uniform one within it: a uniform
        pressure everywhere displaces nothing, in the mean of a period."""
        assert period is not None
        beyond = _Beyond(0.5 * (2 * self.neighbours + 1) * period, period, centre)
        return (sie.Forcing(beyond.slope, beyond.height),)

    def side_conditions(self, period: float | None) -> tuple[sie.Condition, ...]:
        assert period is not None
        return (sie.Amplitude(0, per_total=1 / period),)


@dataclass(frozen=True)
class _Beyond:
    """The nominal pressure beyond a strip of that half width about its centre."""

    half: float
    period: float
    centre: float

    def slope(self, x: Array) -> Array:
        # Zones on their way may pass the border of the strip for a step: the term stays finite there.
        return np.asarray(2 / np.pi * np.arctanh(np.clip((x - self.centre) / self.half, -_INSIDE, _INSIDE)))

    def height(self, x: Array) -> Array:
        half, length = self.half, self.period
        before, after = half + (x - self.centre), half - (x - self.centre)
        total = _entropy(before / length) + _entropy(after / length) - 2 * half / length
        return np.asarray(length * total / math.pi)


def _entropy(x: Array) -> Array:
    """x ln x, zero at zero."""
    x = np.maximum(x, 0.0)
    return np.asarray(x * np.log(np.where(x > 0, x, 1.0)))
