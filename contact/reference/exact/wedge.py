"""Wedge f = slope |x|, isolated and periodic (a sharp valley at L/2).

Isolated: K. L. Johnson, Contact Mechanics (1985), sec. 5.2, doi 10.1017/CBO9781139171731. Periodic:
J. M. Block & L. M. Keer, "Periodic contact problems in plane elasticity", J. Mech. Mater. Struct. 3
(2008).
"""

from dataclasses import dataclass
from math import asinh, pi, tanh

import numpy as np
from scipy.special import spence

from contact.reference.exact.base import IsolatedZone, PeriodicZone, SymmetricZone
from contact.reference.exact.numerics import Array, arccos1m, arcosh1p, half_width_from_sine, sine


@dataclass(frozen=True)
class _Wedge(SymmetricZone):
    """Profile f = slope |x|, and the formulas that both wedges share."""

    wedge_slope: float

    def _height(self, r: Array) -> Array:
        return self.wedge_slope * r

    def _slope(self, r: Array) -> Array:
        return np.full_like(r, self.wedge_slope)

    def _pressure(self, r: Array, d: Array) -> Array:
        # With u = pi |x|/L and A = pi a/L, tan A/tan u - 1 = sin(A - u)/(cos A sin u).
        with np.errstate(divide="ignore"):
            y = sine(d, self.period) / (self._cosine() * sine(r, self.period))
        return self.E_star * self.wedge_slope / pi * arcosh1p(y)

    def _gap_slope(self, e: Array) -> Array:
        # With u = pi x/L and A = pi a/L, 1 - tan A/tan u = sin(u - A)/(cos A sin u). The gap is
        # integrated numerically: the periodic integral is a dilogarithm, and the isolated closed
        # form cancels for small e.
        y = sine(e, self.period) / (self._cosine() * sine(self.half_width + e, self.period))
        return 2.0 * self.wedge_slope / pi * arccos1m(y)


@dataclass(frozen=True)
class IsolatedWedge(IsolatedZone, _Wedge):
    """An isolated wedge f = slope |x|.

    p = (E* slope/pi) arcosh(a/|x|), P = E* slope a, gap = (2 slope/pi)(x arccos(a/x) - a
    arcosh(x/a)), approach = (2 slope a/pi)(ln(2d/a) + 1). The pressure is the first term of (26)
    in Goryacheva & Tsukanov (2020), where |x| is missing in print. The class method `from_load`
    makes the solution at a given load; everything else is in `SymmetricZone`. K. L. Johnson,
    Contact Mechanics (1985), sec. 5.2, doi 10.1017/CBO9781139171731.

    Parameters
    ----------
    wedge_slope : float
        Slope of the flanks.
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
    >>> from contact.exact import IsolatedWedge
    >>> wedge = IsolatedWedge.from_load(1e4, wedge_slope=0.01, E_star=1e9)
    >>> bool(np.isclose(wedge.half_width, 1e4 / (1e9 * 0.01)))
    True
    """

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        return load / (shape["E_star"] * shape["wedge_slope"])

    def load_rate(self, s: Array) -> Array:
        """Derivative dP/da of the load by the half width a, at a = s."""
        return np.full_like(s, self.E_star * self.wedge_slope)

    @property
    def load(self) -> float:
        return self.E_star * self.wedge_slope * self.half_width

    def _approach_by_parts(self) -> float:
        return 2.0 * self.wedge_slope * self.half_width / pi


@dataclass(frozen=True)
class PeriodicWedge(PeriodicZone, _Wedge):
    """A periodic wedge (Block & Keer 2008), with u = pi x/L, A = pi a/L and s = sin A:

    (25) p = (E* slope/pi) arcosh(tan A/tan|u|),   mean pressure = (E* slope/pi) artanh s,
    gap slope = (2 slope/pi) arccos(tan A/tan u),
    approach = (2 L slope/pi^2)(chi_2(s) - artanh(s) ln s), chi_2 Legendre's chi function.

    The approach is derived from dP/da. The class methods `from_load`, `from_mean_pressure` and
    `from_contact_fraction` start from one of these numbers; everything else is in `SymmetricZone`.
    J. M. Block & L. M. Keer, J. Mech. Mater. Struct. 3 (2008).

    Parameters
    ----------
    wedge_slope : float
        Slope of the flanks of f = slope |x|, |x| <= L/2.
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
    >>> import numpy as np
    >>> from contact.exact import PeriodicWedge
    >>> row = PeriodicWedge.from_contact_fraction(0.5, period=1e-3, wedge_slope=0.01, E_star=1e9)
    >>> bool(np.isclose(row.mean_pressure, 1e7 / np.pi * np.arctanh(np.sin(np.pi / 4))))
    True
    """

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        y = pi * load / (shape["E_star"] * shape["wedge_slope"] * shape["period"])
        return half_width_from_sine(tanh(y), 1.0 / float(np.cosh(min(y, 700.0))), shape["period"])

    @property
    def load(self) -> float:
        # With s = sin A, artanh s = arsinh(s/cos A), which is accurate near full contact.
        unit = self.period * self.E_star * self.wedge_slope / pi
        return unit * asinh(self._sine() / self._cosine())

    def _approach_by_parts(self) -> float:
        return 2.0 * self.period * self.wedge_slope / pi**2 * legendre_chi(self._sine())


def legendre_chi(s: float) -> float:
    """chi_2(s) = sum s^(2k+1)/(2k+1)^2 = (Li_2(s) - Li_2(-s))/2, 0 <= s <= 1."""
    if s < 0.5:
        # scipy's dilogarithm loses relative accuracy for small s; 27 terms leave 0.25^27 = 5e-17.
        k = 2 * np.arange(27) + 1
        return float(np.sum(s**k / k**2.0))
    return 0.5 * float(spence(1.0 - s) - spence(1.0 + s))
