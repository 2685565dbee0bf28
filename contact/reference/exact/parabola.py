"""Parabola f = x^2/2R, isolated (Hertz) and periodic (Kuznetsov; a sharp valley at L/2).

H. Hertz (1882); K. L. Johnson, Contact Mechanics (1985), sec. 4.2. Ye. A. Kuznetsov, "Periodic
contact problem for half-plane allowing for forces of friction", Sov. Appl. Mech. 12 (1976), and
Kuznetsov (1978) for the load (28).
"""

from dataclasses import dataclass
from math import exp, expm1, pi, sqrt

import numpy as np

from contact.reference.exact.base import IsolatedZone, PeriodicZone, SymmetricZone
from contact.reference.exact.numerics import (
    Array,
    arcosh1p,
    cosine,
    half_width_from_sine,
    log_of,
    sine,
)


@dataclass(frozen=True)
class _Parabola(SymmetricZone):
    """The profile f = x^2/2R of the isolated and of the periodic parabola."""

    radius: float

    def _height(self, r: Array) -> Array:
        return r * r / (2.0 * self.radius)

    def _slope(self, r: Array) -> Array:
        return r / self.radius


@dataclass(frozen=True)
class HertzLine(IsolatedZone, _Parabola):
    """The contact of an isolated parabola f = x^2/2R (Hertz 1882).

    p = (E*/2R) sqrt(a^2 - x^2), P = pi E* a^2/4R, gap = (1/2R)(x sqrt(x^2 - a^2) - a^2
    arcosh(x/a)), approach = (a^2/2R)(ln(2d/a) + 1/2), which is greatest at a = 2d. The class method
    `from_load` makes the solution at a given load; everything else is in `SymmetricZone`. K. L.
    Johnson, Contact Mechanics (1985), sec. 4.2, doi 10.1017/CBO9781139171731.

    Parameters
    ----------
    radius : float
        Radius of curvature R of f = x^2/2R [m].
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width a of the zone [m].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it there is no approach.

    Raises
    ------
    SceneError
        If a number is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import HertzLine
    >>> hertz = HertzLine.from_load(1e4, radius=1.0, E_star=1e9)
    >>> bool(np.isclose(hertz.half_width, np.sqrt(4e4 / (np.pi * 1e9))))
    True
    >>> bool(np.isclose(hertz.max_pressure, 2e4 / (np.pi * hertz.half_width)))
    True
    """

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        return sqrt(4.0 * load * shape["radius"] / (pi * shape["E_star"]))

    def _pressure(self, r: Array, d: Array) -> Array:
        return self.E_star / (2.0 * self.radius) * np.sqrt(d * (self.half_width + r))

    def load_rate(self, s: Array) -> Array:
        """Derivative dP/ds of the load P by the half width s."""
        return pi * self.E_star / (2.0 * self.radius) * s

    def load_at(self, s: Array) -> Array:
        """Load P [N/m] of a zone of half width s."""
        return pi * self.E_star / (4.0 * self.radius) * s**2


@dataclass(frozen=True)
class PeriodicParabola(PeriodicZone, _Parabola):
    """The contact of a periodic parabola f = x^2/2R, |x| <= L/2 (Kuznetsov 1978).

    Kuznetsov gives the load (28); the other formulas are derived from flat punches:
    P = -(L^2 E*/2 pi R) ln cos A, p = (L E*/2 pi R) arcosh(cos u/cos A), gap slope = (L/pi R)
    arccos(cos u/cos A), u = pi x/L, A = pi a/L; approach = (L^2/4 pi^2 R)(Li_2(sin^2 A) + ln sin^2
    A ln cos^2 A), with the dilogarithm Li_2. It tends to the mean height L^2/24R of the profile as
    the contact becomes full. The class methods `from_load`,
    `from_mean_pressure` and `from_contact_fraction` start from one of these numbers; everything
    else is in `SymmetricZone`. Ye. A. Kuznetsov, Sov. Appl. Mech. 12 (1976); (28) as given by
    Goryacheva & Tsukanov (2020), doi 10.3389/fmech.2020.00045.

    Parameters
    ----------
    radius : float
        Radius of curvature R of f = x^2/2R, |x| <= L/2 [m].
    period : float
        Period L [m].
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width a of the zone [m].

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the zone is as wide as its period.

    Examples
    --------
    With half of the period in contact cos A = 1/sqrt(2), so P = L^2 E* ln(2)/(4 pi R).

    >>> import numpy as np
    >>> from contact.exact import PeriodicParabola
    >>> row = PeriodicParabola(radius=1.0, period=1e-2, E_star=1e9, half_width=2.5e-3)
    >>> bool(np.isclose(row.load, 1e-4 * 1e9 * np.log(2) / (4 * np.pi)))
    True
    """

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        y = 2.0 * pi * load * shape["radius"] / (shape["period"] ** 2 * shape["E_star"])
        return half_width_from_sine(sqrt(-expm1(-2.0 * y)), exp(-y), shape["period"])

    def _pressure(self, r: Array, d: Array) -> Array:
        # The pressure is proportional to arcosh(cos u/cos A), with u = pi x/L and A = pi a/L. The
        # variable `half` is (cos u - cos A)/2, computed without cancellation.
        half = sine(0.5 * (self.half_width + r), self.period) * sine(0.5 * d, self.period)
        unit = self.period * self.E_star / (2.0 * pi * self.radius)
        return unit * arcosh1p(2.0 * half / self._cosine())

    def load_at(self, s: Array) -> Array:
        """Load P [N/m] of a zone of half width s."""
        unit = self.period**2 * self.E_star / (2.0 * pi * self.radius)
        return -unit * log_of(cosine(s, self.period), sine(s, self.period))

    def load_rate(self, s: Array) -> Array:
        """Derivative dP/ds of the load P by the half width s."""
        unit = self.period * self.E_star / (2.0 * self.radius)
        # The half width s may be rounded to L/2. There dP/ds is infinite, but its integrals are
        # finite.
        return unit * sine(s, self.period) / np.maximum(cosine(s, self.period), 1e-100)
