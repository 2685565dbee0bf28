"""Flat punch with sharp corners, isolated and periodic.

Isolated: M. A. Sadowsky (1928); K. L. Johnson, Contact Mechanics (1985), sec. 2.8. Periodic:
derived with the substitution tan(pi x/L).
"""

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from numpy.typing import ArrayLike

from contact.reference.exact.base import SymmetricZone, with_datum
from contact.reference.exact.numerics import Array, arcosh1p, cosine, sine, sine_excess


class _Punch(SymmetricZone):
    """Formulas of isolated and periodic flat punches; load and half width are independent."""

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
        unit = self.load / (pi * self._sine_unit)
        with np.errstate(divide="ignore"):
            return unit * cosine(self.half_width, self.period, d) / root

    def _depth(self, e: Array) -> Array:
        """Approach minus displacement [m] at the distance e outside an end of the punch."""
        unit = 2.0 * self.load / (pi * self.E_star)
        return unit * arcosh1p(sine_excess(self.half_width, e, self.period))

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement u(x) [m]: equal to the approach in contact, smaller outside."""
        e = np.maximum(np.abs(self._reduced(x)) - self.half_width, 0.0)
        return with_datum("the displacement", self.approach) - self._depth(e)

    def _approach_by_parts(self) -> float:
        return 0.0


@dataclass(frozen=True)
class IsolatedPunch(_Punch):
    """An isolated flat punch (Sadowsky 1928).

    p = P/(pi sqrt(a^2 - x^2)), approach = (2P/pi E*) ln(2d/a); outside u = approach - (2P/pi E*)
    arcosh(|x|/a), and the gap is infinite, as the profile is. Everything else is in
    `SymmetricZone`. K. L. Johnson, Contact Mechanics (1985), sec. 2.8, doi
    10.1017/CBO9781139171731.

    Parameters
    ----------
    half_width : float
        Half width a of the punch [m].
    E_star : float
        Reduced modulus [Pa].
    load : float
        P per unit thickness [N/m].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it there is no approach.

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
    """A flat punch once in every period; its formulas are derived here.

    With v = pi x/L and A = pi a/L,
    p = (P/L) cos v/sqrt(sin^2 A - sin^2 v), approach = -(2P/pi E*) ln sin A; outside u = approach -
    (2P/pi E*) arcosh(sin v/sin A). Everything else is in `SymmetricZone`.

    Parameters
    ----------
    half_width : float
        Half width a of the punch [m].
    period : float
        Period L [m].
    E_star : float
        Reduced modulus [Pa].
    load : float
        P per period [N/m].

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the zone is as wide as its period.

    Examples
    --------
    With half of the period in contact sin A = 1/sqrt(2), so the approach is P ln(2)/(pi E*).

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
