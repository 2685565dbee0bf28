"""Flat punch with sharp corners, alone and in a row of period L.

Alone: M. A. Sadowsky (1928); K. L. Johnson, Contact Mechanics (1985), sec. 2.8. In a row: derived,
with the substitution tan(pi x/L).
"""

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from numpy.typing import ArrayLike

from contact.reference.exact.base import (
    Array,
    SymmetricZone,
    arcosh1p,
    cosine,
    known,
    sine,
    sine_excess,
)


class _Punch(SymmetricZone):
    """What the two share: the profile, a load that the half-width does not set, and the forms, in
    which alone sin(pi x/L) is x.
    """

    def __post_init__(self) -> None:
        self._check("load", "E_star", "half_width")

    def _height(self, r: Array) -> Array:
        return np.where(r <= self.half_width, 0.0, inf)

    def _slope(self, r: Array) -> Array:
        return np.zeros_like(r)

    max_pressure = property(lambda self: inf)  # type: ignore[assignment]

    def _gap(self, e: Array) -> Array:
        return np.full_like(e, inf)

    def _pressure(self, r: Array, d: Array) -> Array:
        root = np.sqrt(sine(d, self.period) * sine(self.half_width + r, self.period))
        with np.errstate(divide="ignore"):
            return self.load / (pi * self._turn) * cosine(self.half_width, self.period, d) / root

    def _fall(self, e: Array) -> Array:
        """approach - u at the distance e from the punch [m]."""
        return (
            2.0
            * self.load
            / (pi * self.E_star)
            * arcosh1p(sine_excess(self.half_width, e, self.period))
        )

    def displacement(self, x: ArrayLike) -> Array:
        """u(x) [m]: the approach in contact, falling outside."""
        return known("u", self.approach) - self._fall(
            np.maximum(np.abs(self._reduced(x)) - self.half_width, 0.0)
        )

    def _left(self) -> float:
        return 0.0


@dataclass(frozen=True)
class IsolatedPunch(_Punch):
    """A flat punch alone (Sadowsky 1928): p = P/(pi sqrt(a^2 - x^2)), approach = (2P/pi E*)
    ln(2d/a);

    outside u = approach - (2P/pi E*) arcosh(|x|/a). The gap outside is infinite, as the profile is.
    K. L. Johnson, Contact Mechanics (1985), sec. 2.8, doi 10.1017/CBO9781139171731.

    Parameters
    ----------
    half_width : float
        Half width a of the punch [m].
    E_star : float
        Reduced modulus [Pa].
    load : float
        P per unit thickness [N/m].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it (None) there is no approach.

    Attributes
    ----------
    pressure, gap, zones, approach : as in `SymmetricZone`
        What every such zone has, and what else is there.

    Raises
    ------
    SceneError
        If a number is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import IsolatedPunch
    >>> punch = IsolatedPunch(half_width=1e-3, E_star=1e9, load=1e4)
    >>> bool(np.isclose(punch.pressure(0.0), 1e4 / (np.pi * 1e-3)))
    True
    """

    half_width: float
    E_star: float
    load: float
    datum: float | None = None
    period = None


@dataclass(frozen=True)
class PeriodicPunch(_Punch):
    """A row of flat punches (derived), v = pi x/L, A = pi a/L: p = (P/L) cos v/sqrt(sin^2 A - sin^2
    v),

    approach = -(2P/pi E*) ln sin A; outside u = approach - (2P/pi E*) arcosh(sin v/sin A).

    Parameters
    ----------
    half_width : float
        Half width a of a punch [m].
    period : float
        Period L [m].
    E_star : float
        Reduced modulus [Pa].
    load : float
        P per period [N/m].

    Attributes
    ----------
    pressure, gap, zones, approach : as in `SymmetricZone`
        What every such zone has, and what else is there.

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the zone is as wide as its period.

    Examples
    --------
    Half of the period in contact, sin A = 1/sqrt(2): the approach is P ln(2)/(pi E*).

    >>> import numpy as np
    >>> from contact.exact import PeriodicPunch
    >>> row = PeriodicPunch(half_width=2.5e-4, period=1e-3, E_star=1e9, load=1e4)
    >>> bool(np.isclose(row.approach, 1e4 * np.log(2) / (np.pi * 1e9)))
    True
    """

    half_width: float
    period: float
    E_star: float
    load: float
    datum = None
