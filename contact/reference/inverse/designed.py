"""Inverse design: exact contact problems with any given zones, by choosing the profile that makes them right.

With X^2 the product over all zone ends (of x - e, or of 2 sin(pi (x - e)/L) with a period L) and M a product
of the same kind with one root in every gap, such that int_gap X M dx = 0, the function Phi = (E*/2)(f' - X
M), f' the polynomial part of X M, is the Cauchy (Hilbert) transform of

    p = (E*/2)|X M| on the zones,   gap slope = X M between them,   f' a (trigonometric) polynomial.

n zones alone: n - 1 roots, f of degree 2n. n zones a period: n roots, f a Fourier series of n harmonics (X
and M change sign over a period as (-1)^n each, so that X M is periodic; its mean vanishes because its gap
integrals do). Derived from the general solution (34) of Muskhelishvili, Singular Integral Equations (1953),
ch. 11.

All factors are formed from distances to the ends of the point's own zone or gap, so nothing cancels near an
end.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.model.checks import keep, positive
from contact.model.profiles.fourier import Fourier
from contact.reference.inverse.given import DesignedProfile, GivenZones, exp_of_power_sums
from contact.reference.inverse.product import CutProduct
from sie import Array, Mask


@dataclass(frozen=True, eq=False)
class DesignedContact(GivenZones):
    """An exact contact of given zones and load: the profile is chosen such that they are right; see the head of this module.

    p = (E*/2)|X M| on the zones, gap slope = X M between them; pressures, gaps and loads are exact to rounding. Derived from the
    general solution (34) of N. I. Muskhelishvili, Singular Integral Equations (1953), ch. 11.

    Parameters
    ----------
    zones : array_like, (n, 2)
        Ends of the zones [m], ascending; within one period if there is one.
    E_star : float
        Reduced modulus [Pa].
    load : float
        P > 0 of all zones per unit thickness, per period if there is one [N/m].
    period : float or None
        Period L [m]; None: the body is alone.

    Attributes
    ----------
    profile : DesignedProfile or Fourier
        The shape that has this contact.
    max_pressure : float
        Peak pressure [Pa].
    zone_loads, zone_widths : array, (n,)
        Load [N/m] and width [m] of every zone.
    mean_pressure, contact_fraction : float or None
        P/L [Pa], and the share of the period in contact; None without a period.
    nearness : float
        Narrowest gap over widest zone: what makes a problem hard.
    approach, mean_gap : float or None
        From min f = 0 and mean u = 0 [m]; None without a period.
    pressure, gap, gap_slope, displacement, height, slope : callable
        p [Pa], gap [m], its slope, u [m] (with a period), f [m] up to a constant and f' at positions x [m] of any shape.
    pressure_at : callable
        p [Pa] at normalised positions t in [-1, 1] of a zone, to rounding up to its ends.

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the zones are not strictly ascending and within one period.
    NotConverged
        From whatever is asked of it, if the roots of M are not found.

    Examples
    --------
    One zone a period is that of a wave: P = pi E* Delta sin^2(pi a/L).

    >>> import numpy as np
    >>> from contact.inverse import DesignedContact
    >>> wave = DesignedContact(np.array([[-0.25, 0.25]]), E_star=1.0, load=0.5 * np.pi, period=1.0)
    >>> bool(np.isclose(wave.profile.cosine[0], -1.0))  # f = -Delta cos(2 pi x/L)
    True
    """

    zones: Array
    E_star: float
    load: float
    period: float | None = None

    def __post_init__(self) -> None:
        keep(self, positive, "E_star", "load")
        self._check()

    @cached_property
    def _product(self) -> CutProduct:
        return self._long.rounded()

    @cached_property
    def _raw_loads(self) -> Array:
        """int |X M| over each zone before scaling."""
        nodes = [(i, *self._long.nodes(i)) for i in range(0, 2 * len(self.zones), 2)]
        return np.array([np.sum(weight * self._long.magnitude(i, dl, dr)) for i, dl, dr, weight in nodes])

    @cached_property
    def _long_scale(self) -> Any:
        """The factor of X M that gives the load."""
        return self.load / (0.5 * self.E_star * np.sum(self._raw_loads))

    @property
    def _scale(self) -> float:
        return float(self._long_scale)

    # The profile: the polynomial part of X M
    @cached_property
    def profile(self) -> DesignedProfile | Fourier:
        """The shape with this contact."""
        hull = (float(self.zones[0, 0]), float(self.zones[-1, 1]))
        ends = self._long.zones.ravel()
        roots = ends[list(self._long.gaps)] + self._long.roots[:, 0]
        exponents = np.concatenate([np.full(len(ends), 0.5), np.ones(len(roots))])
        n = len(self.zones)
        if self.period is None:
            # x = middle + half (v + 1/v)/2 maps (x - e)/unit to v (1 - e^{i phi}/v)(1 - e^{-i phi}/v).
            points = np.concatenate([ends, roots])
            phi = 2.0 * np.arctan2(np.sqrt(hull[1] - points), np.sqrt(points - hull[0]))
            power_sums = np.array([2.0 * np.sum(exponents * np.cos(k * phi)) for k in range(2 * n)])
            series = 2.0 * self._long_scale * exp_of_power_sums(power_sums).real[::-1]
            series[0] *= 0.5
            return DesignedProfile(series.astype(float), hull)
        # Above the axis, w = e^{2 pi i z/L}: 2 sin(pi (z - e)/L) = i e^{-i pi (z - e)/L} (1 - w e^{-2 pi i
        # e/L}).
        angle = 2.0 * self._long.pi / self.period * np.concatenate([ends, roots])
        power_sums = np.array([np.sum(exponents * np.exp(-1j * k * angle)) for k in range(n + 1)])
        phase = np.exp(0.5j * np.sum(exponents * angle))
        coefficients = phase * exp_of_power_sums(power_sums)
        # The constant term is 2 i p_mean/E*: this fixes the sign of the root.
        coefficients *= np.sign(coefficients[n].imag) * self._long_scale
        return self._of_slope(coefficients[n - 1 :: -1])

    @property
    def zone_loads(self) -> Array:
        """Load of every zone [N/m]; they add up to the load."""
        return np.asarray(self.load * self._raw_loads / np.sum(self._raw_loads), dtype=float)

    def _zone_pressure(self, zone: int, dl: Array, dr: Array) -> Array:
        return np.asarray(0.5 * self.E_star * self._scale * self._product.magnitude(2 * zone, dl, dr), dtype=float)

    def _opening(self, i: int, dl: Array, dr: Array) -> Array:
        return self._scale * self._product.side(i, dl, dr) * self._product.magnitude(i, dl, dr)

    def _nodes(self, i: int) -> Any:
        return self._product.nodes(i)

    def _from_left(self, i: int, dl: Array, dr: Array) -> Mask:
        """From the end on the same side of the gap's widest point."""
        return self._product.side(i, dl, dr) > 0.0

    @cached_property
    def max_pressure(self) -> float:
        """Peak pressure [Pa], from ever closer samples around the largest one of every zone."""
        return self._greatest(0.0, 129)


def design(zones: ArrayLike, E_star: float, load: float, period: float | None = None) -> DesignedContact:
    """The exact contact with these zones and this load (per period).

    Parameters
    ----------
    zones : array_like, (n, 2)
        Ends of the zones [m], ascending; within one period if there is one.
    E_star : float
        Reduced modulus [Pa].
    load : float
        P > 0 of all zones per unit thickness, per period if there is one [N/m].
    period : float or None
        Period L [m]; None: the body is alone.

    Returns
    -------
    DesignedContact
        With its `profile`, to be given to `contact.Scene`.

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the zones are not strictly ascending and within one period.

    Examples
    --------
    The solver finds the zones that were asked for.

    >>> import contact
    >>> import numpy as np
    >>> from contact.inverse import design
    >>> made = design([[-2.0, -1.0], [0.5, 3.0]], E_star=1.0, load=0.1)
    >>> found = contact.solve(contact.Scene(made.profile, 1.0, contact.Isolated(), load=0.1))
    >>> bool(np.allclose(found.zones, made.zones, atol=1e-7))
    True
    """
    return DesignedContact(np.asarray(zones), E_star, load, period)
