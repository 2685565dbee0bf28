"""Sinusoidal waviness (Westergaard 1939): f(x) = amplitude (1 - cos(2 pi x/L))."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from contact.model.checks import positive
from contact.model.profiles.base import Array, Profile
from contact.model.registry import register_profile


@register_profile("sinusoid")
@dataclass(frozen=True)
class Sinusoid(Profile):
    """f = amplitude (1 - cos(2 pi x/period)): half the peak-to-valley height is the amplitude."""

    amplitude: float
    period: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "amplitude", positive("amplitude", self.amplitude))
        object.__setattr__(self, "period", positive("period", self.period))

    def _turns(self, x: ArrayLike) -> Array:
        """x in periods, less the nearest whole number: cheaper than `wrap`, and all that sine and cosine need."""
        turns = np.asarray(x, dtype=np.float64) / self.period
        return np.asarray(turns - np.rint(turns))

    def height(self, x: ArrayLike) -> Array:
        # 1 - cos = 2 sin^2 keeps the digits near the tip.
        return np.asarray(2 * self.amplitude * np.sin(pi * self._turns(x)) ** 2)

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(2 * pi * self.amplitude / self.period * np.sin(2 * pi * self._turns(x)))

    def slope_conjugate(self, x: ArrayLike) -> Array:
        """H sin = -cos."""
        return np.asarray(-2 * pi * self.amplitude / self.period * np.cos(2 * pi * self._turns(x)))

    @property
    def symmetric(self) -> bool:
        return True

    @property
    def summits(self) -> Array:
        return np.array([0.0])

    @property
    def resolution(self) -> float:
        return self.period
