"""Closed form of an isolated wedge with a rounded tip, f = s (sqrt(x^2 + d^2) - d).

Here s is the slope of the wedge, and d the length over which it is rounded. By the superposition of
flat punches (contact.reference.exact.base) the load at half width a is

    P(a) = E* int_0^(pi/2) a sin(th) f'(a sin(th)) dth = s E* d (E(-q) - K(-q)),   q = a^2 / d^2,

where E and K are complete elliptic integrals of parameter -q (derived here). The limit d -> 0 is
the load s E* a of the wedge, and d >> a gives Hertz's load.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipe, ellipkm1

from contact.model.profiles.base import Profile
from contact.reference.exact import SymmetricZone
from contact.reference.exact.numerics import integrated

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BluntedWedge(Profile):
    """The profile f = s (sqrt(x^2 + d^2) - d): a wedge of slope s, rounded over a length d."""

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
    """The exact contact of a `BluntedWedge`, a rounded wedge.
    Its pressure is inaccurate for |x| << `rounding`.
    """

    steepness: float
    rounding: float
    E_star: float
    half_width: float
    period = None

    def _load(self, s: Array) -> Array:
        """Load P(s) of a zone of half width s.
        The elliptic integral K(-q) is computed as ellipkm1(1 + q).
        """
        q = (s / self.rounding) ** 2
        unit = self.steepness * self.E_star * self.rounding
        return np.asarray(unit * (ellipe(-q) - ellipkm1(1 + q)))

    def _load_rate(self, s: Array) -> Array:
        """Derivative dP/ds of the load P of a zone by its half width s.

        The elliptic integrals E and K of the parameter m = -q = -s^2/d^2 have the derivatives
        dE/dm = (E - K)/2m and dK/dm = (E - (1 - m) K)/(2 m (1 - m)).
        """
        q = (s / self.rounding) ** 2
        e, k = ellipe(-q), ellipkm1(1 + q)
        by_q = (e - k) / (2 * q) - (e - (1 + q) * k) / (2 * q * (1 + q))
        return np.asarray(self.steepness * self.E_star / self.rounding * by_q * 2 * s)

    @property
    def load(self) -> float:
        return float(self._load(np.array(self.half_width)))

    @property
    def max_pressure(self) -> float:
        """Pressure at x = `rounding`, which is close to the largest pressure.
        Errors of the pressure are divided by this value.
        """
        return float(self.pressure_at(self.rounding / self.half_width))

    def _pressure(self, r: Array, d: Array) -> Array:
        """Pressure (1/pi) int_x^a P'(s)/sqrt(s^2 - x^2) ds, where P' is the derivative of the load.
        P(s) is the load of a zone of half width s.

        With s = x cosh(v) the integrand is smooth in v. The integral is split in halves, since P'
        may change over a short length d within a long interval.
        """
        a, column = self.half_width, r[..., None]
        half = 0.5 * np.arccosh(np.maximum(a / r, 1.0))

        def rate(v: Array) -> Array:
            return self._load_rate(np.minimum(column * np.cosh(v), a))

        first = integrated(lambda v, _: rate(v), half)
        return np.asarray(
            (first + integrated(lambda v, _: rate(half[..., None] + v), half)) / np.pi
        )
