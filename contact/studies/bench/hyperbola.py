"""A blunted wedge, f = s (sqrt(x^2 + d^2) - d), on a lone body: a slope that turns over the length
d, in closed form.

The superposition of flat punches (see contact.reference.exact.base) with the load of half width a

    P(a) = E* int_0^(pi/2) a sin(th) f'(a sin(th)) dth = s E* d (E(-q) - K(-q)),   q = a^2 / d^2,

complete elliptic integrals of parameter -q (derived here; d -> 0 gives the wedge's s E* a, and d >>
a Hertz's).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipe, ellipkm1

from contact.model.profiles.base import Profile
from contact.reference.exact import SymmetricZone

Array = NDArray[np.float64]

# Nodes of the tanh-sinh rule between a point and the end.
_TAU = np.arange(-60, 61) * 0.06
_GROW = np.pi * np.sinh(_TAU)
_LEFT = 1 / (1 + np.exp(-_GROW))
_RIGHT = 1 / (1 + np.exp(_GROW))
_WEIGHT = 0.06 * np.pi * np.cosh(_TAU) * _LEFT * _RIGHT


@dataclass(frozen=True)
class BluntedWedge(Profile):
    """f = s (sqrt(x^2 + d^2) - d)."""

    steepness: float
    rounding: float

    def height(self, x: ArrayLike) -> Array:
        x = np.asarray(x)
        root = np.sqrt(x * x + self.rounding**2)
        return np.asarray(self.steepness * x * x / (root + self.rounding))

    def slope(self, x: ArrayLike) -> Array:
        x = np.asarray(x)
        return np.asarray(self.steepness * x / np.sqrt(x * x + self.rounding**2))

    symmetric = property(lambda self: True)  # type: ignore[assignment]
    summits = property(lambda self: np.zeros(1))  # type: ignore[assignment]
    resolution = property(lambda self: self.rounding)  # type: ignore[assignment]


@dataclass(frozen=True)
class IsolatedBluntedWedge(SymmetricZone):
    """The contact of half width a; pressures by one double-exponential quadrature, for |t| not much
    below d/a.
    """

    steepness: float
    rounding: float
    E_star: float
    half_width: float
    period = None

    def _load(self, s: Array) -> Array:
        q = (s / self.rounding) ** 2
        # K(-q) by its complementary parameter 1 + q, since scipy's ellipk loses none there either
        # way.
        return np.asarray(
            self.steepness * self.E_star * self.rounding * (ellipe(-q) - ellipkm1(1 + q))
        )

    def _load_rate(self, s: Array) -> Array:
        """dP/ds, by dE/dm = (E - K)/2m and dK/dm = (E - (1 - m) K)/(2 m (1 - m)) at m = -q."""
        q = (s / self.rounding) ** 2
        e, k = ellipe(-q), ellipkm1(1 + q)
        by_q = (e - k) / (2 * q) - (e - (1 + q) * k) / (2 * q * (1 + q))
        return np.asarray(
            self.steepness * self.E_star * self.rounding * by_q * 2 * s / self.rounding**2
        )

    @property
    def load(self) -> float:
        return float(self._load(np.array(self.half_width)))

    @property
    def max_pressure(self) -> float:
        """At the tip: (1/pi) int P'(s)/s ds; bounded above by the wedge's at x = d, which is what
        is used as its scale.
        """
        return float(self.pressure_at(self.rounding / self.half_width))

    def _pressure(self, r: Array, d: Array) -> Array:
        """(1/pi) int_x^a P'(s) / sqrt(s^2 - x^2) ds with s = x cosh(v), so that the layer near x is
        stretched.
        """
        a, r = self.half_width, r[..., None]
        top = np.arccosh(np.maximum(a / r, 1.0))
        s = np.minimum(r * np.cosh(top * _LEFT), a)
        return np.asarray((self._load_rate(s) * _WEIGHT).sum(-1) * top[..., 0] / np.pi)
