"""Closed form of an isolated wedge with a flat top, f = s max(|x| - d, 0).

The wedge has the slope s, and its top the half width d. If the zone has the half width a > d, the
load is P(a) = E* s sqrt(a^2 - d^2). By the superposition of flat punches of half width b
(contact.reference.exact.base) the pressure is

    p(x) = (1/pi) int_max(|x|, d)^a P'(b) db / sqrt(b^2 - x^2)
         = (E* s/pi) ln[(sqrt(a^2 - d^2) + sqrt(a^2 - x^2)) / sqrt|x^2 - d^2|]

(derived here). The limit d -> 0 is the wedge's arcosh(a/|x|).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.model.profiles.base import Profile
from contact.reference.exact import SymmetricZone

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TruncatedWedge(Profile):
    """A wedge of slope s with a flat top |x| <= d, f = s max(|x| - d, 0); its corners are kinks."""

    steepness: float
    half_top: float

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(self.steepness * np.maximum(np.abs(x) - self.half_top, 0.0))

    def slope(self, x: ArrayLike) -> Array:
        x = np.asarray(x)
        return np.asarray(np.where(np.abs(x) > self.half_top, self.steepness * np.sign(x), 0.0))

    symmetric = property(lambda self: True)  # type: ignore[assignment]
    summits = property(lambda self: np.zeros(1))  # type: ignore[assignment]
    kinks = property(  # type: ignore[assignment]
        lambda self: np.array([[-self.half_top, self.steepness], [self.half_top, self.steepness]])
    )


@dataclass(frozen=True)
class IsolatedTruncatedWedge(SymmetricZone):
    """The exact contact of a `TruncatedWedge`, for a zone that is wider than the flat top."""

    steepness: float
    half_top: float
    E_star: float
    half_width: float
    period = None

    @property
    def load(self) -> float:
        a, d = self.half_width, self.half_top
        return self.E_star * self.steepness * sqrt((a - d) * (a + d))

    def _pressure(self, r: Array, d: Array) -> Array:
        a, corner = self.half_width, self.half_top
        top = sqrt((a - corner) * (a + corner)) + np.sqrt(d * (a + r))
        with np.errstate(divide="ignore"):
            value = np.log(top / np.sqrt(np.abs((r - corner) * (r + corner))))
        return np.asarray(self.E_star * self.steepness / np.pi * value)
