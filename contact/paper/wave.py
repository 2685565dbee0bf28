"""The sinusoid f = Delta (1 - cos(2 pi x/L)) by the localization principle: equations (18)-(24)."""

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from contact.paper.one_zone import OneZone
from contact.reference.exact import Westergaard
from contact.reference.exact.base import Array
from contact.reference.exact.localized import FIRST_ORDER
from contact.reference.exact.sinusoid import IsolatedSinusoid


@dataclass(frozen=True)
class LocalizedWave(OneZone):
    """(20)-(24), Goryacheva & Tsukanov (2020), with k = 2 pi/L and s = sqrt(L^2 - 4a^2)/L:

    (20) p0 = (2 pi Delta E*/L) sqrt(1 - t^2) sum (-1)^j J_(2j+1)(ka) U_2j(t),  t = x/a,
    (23) mean pressure = (pi^2 Delta E*/L^2) a J_1(ka) (2 - s),
    (24) p(0) = (pi Delta E*/L) int_0^ka J_0 + (2 pi Delta E*/L^2) a J_1(ka) arctan(2a/(L s)),

    both first-order. OutOfRange where the pressure would be negative at the ends.
    """

    amplitude: float
    period: float
    E_star: float
    half_width: float
    closure: str = FIRST_ORDER
    _family = IsolatedSinusoid
    _shape = "amplitude"

    @property
    def isolated(self) -> IsolatedSinusoid:
        """(20)-(22)."""
        return IsolatedSinusoid(self.amplitude, self.period, self.E_star, self.half_width)

    @property
    def exact(self) -> Westergaard:
        """(18)-(19), Westergaard (1939)."""
        return Westergaard(self.amplitude, self.period, self.E_star, self.half_width)


@dataclass(frozen=True)
class PrintedWestergaard(Westergaard):
    """(18) as printed: the factor sqrt(2 pi E* Delta)/L for sqrt(2) pi E* Delta/L, the root drawn too far. It has the
    dimension of sqrt(Pa/m), and in the units at hand is 1/sqrt(pi E* Delta) of the pressure whose mean is (19)."""

    def pressure(self, x: ArrayLike) -> Array:
        """(18) as printed, 0 outside the zone."""
        u = 2.0 * pi / self.period * self._reduced(x)
        below = np.cos(u) - np.cos(2.0 * pi / self.period * self.half_width)
        factor = sqrt(2.0 * pi * self.E_star * self.amplitude) / self.period
        return np.asarray(factor * np.cos(0.5 * u) * np.sqrt(np.maximum(below, 0.0)))


@dataclass(frozen=True)
class AlmostFullWave:
    """K. L. Johnson (1985), sec. 13.2, almost complete contact: the gap of half-width b = L/2 - a is a crack alone in the
    pressure of full contact, whose stress intensity vanishes,

    mean pressure = p* (1 - (pi b/L)^2),   p* = pi E* Delta/L.

    The exact (19) has sin^2 for the square. The results section names it for 2a/L beyond 0.7.
    """

    amplitude: float
    period: float
    E_star: float
    half_width: float

    @property
    def mean_pressure(self) -> float:
        gap = pi * (0.5 - self.half_width / self.period)
        return pi * self.E_star * self.amplitude / self.period * (1.0 - gap * gap)
