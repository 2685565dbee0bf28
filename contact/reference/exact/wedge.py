"""Wedge f = slope |x|, isolated and periodic (a sharp valley at L/2).

Isolated: K. L. Johnson, Contact Mechanics (1985), sec. 5.2, doi 10.1017/CBO9781139171731. Periodic:
J. M. Block & L. M. Keer, "Periodic contact problems in plane elasticity", J. Mech. Mater. Struct. 3
(2008).
"""

from dataclasses import dataclass
from math import pi, tanh

import numpy as np

from contact.reference.exact.base import IsolatedZone, PeriodicZone, SymmetricZone
from contact.reference.exact.numerics import Array, arcosh1p, cosine, half_width_from_sine, sine


@dataclass(frozen=True)
class _Wedge(SymmetricZone):
    """Profile f = slope |x|, and the formulas common to isolated and periodic wedges."""

    wedge_slope: float

    def _height(self, r: Array) -> Array:
        return self.wedge_slope * r

    def _slope(self, r: Array) -> Array:
        return np.full_like(r, self.wedge_slope)

    def _pressure(self, r: Array, d: Array) -> Array:
        # `y` is tan A/tan u - 1, with u = pi |x|/L and A = pi a/L. The form
        # sin(A - u)/(cos A sin u) does not cancel near the end of the zone.
        with np.errstate(divide="ignore"):
            y = sine(d, self.period) / (self._cosine() * sine(r, self.period))
        return self.E_star * self.wedge_slope / pi * arcosh1p(y)


@dataclass(frozen=True)
class IsolatedWedge(IsolatedZone, _Wedge):
    """The contact of an isolated wedge f = slope |x|.

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

    def load_at(self, s: Array) -> Array:
        """Load P [N/m] of a zone of half width s."""
        return self.E_star * self.wedge_slope * s

    def load_rate(self, s: Array) -> Array:
        """Derivative dP/ds of the load P by the half width s."""
        return np.full_like(s, self.E_star * self.wedge_slope)


@dataclass(frozen=True)
class PeriodicWedge(PeriodicZone, _Wedge):
    """The contact of a periodic wedge f = slope |x|, |x| <= L/2 (Block & Keer 2008).

    With u = pi x/L, A = pi a/L and s = sin A,

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

    def load_at(self, s: Array) -> Array:
        """Load P [N/m] of a zone of half width s."""
        # The load is proportional to artanh(sin A) = arsinh(tan A) with A = pi s/L. The form with
        # arsinh is accurate near full contact.
        unit = self.period * self.E_star * self.wedge_slope / pi
        return unit * np.arcsinh(sine(s, self.period) / cosine(s, self.period))

    def load_rate(self, s: Array) -> Array:
        """Derivative dP/ds of the load P by the half width s."""
        # The half width s may be rounded to L/2. There dP/ds is infinite, but its integrals are
        # finite.
        return self.E_star * self.wedge_slope / np.maximum(cosine(s, self.period), 1e-100)
