"""Inverse design: exact contact problems with any given zones, by choosing the profile that makes
them right.

With X^2 the product over all zone ends (of x - e, or of 2 sin(pi (x - e)/L) with a period L) and M
a product of the same kind with one root in every gap, such that int_gap X M dx = 0, the function
Phi = (E*/2)(f' - X M), f' the polynomial part of X M, is the Cauchy (Hilbert) transform of

    p = (E*/2)|X M| on the zones,   gap slope = X M between them,   f' a (trigonometric) polynomial.

n zones alone: n - 1 roots, f of degree 2n. n zones a period: n roots, f a Fourier series of n
harmonics (X and M change sign over a period as (-1)^n each, so that X M is periodic; its mean
vanishes because its gap integrals do). Derived from the general solution (34) of Muskhelishvili,
Singular Integral Equations (1953), ch. 11.

All factors are formed from distances to the ends of the point's own zone or gap, so nothing cancels
near an end.

The shape of a designed contact that is alone is a Chebyshev series of f'.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from contact.errors import SceneError
from contact.model.checks import finite_array, keep, positive, positive_or_none
from contact.model.profiles.base import Profile
from contact.model.profiles.fourier import Fourier
from contact.reference.exact.base import ExactContact, check_number
from contact.reference.exact.numerics import FROM_LEFT, FROM_RIGHT, WEIGHT, least_value
from contact.reference.inverse.product import CutProduct
from sie import Array, Mask


@dataclass(frozen=True, eq=False)
class DesignedProfile(Profile):
    """The shape of a designed contact that is alone: f' a sum of Chebyshev polynomials on `hull`.

    It is made by `design`, and given to `contact.Scene`; that of a design with a period is a
    `contact.Fourier`.

    Parameters
    ----------
    slope_series : array, (2 n,)
        Chebyshev coefficients of f' on the hull, for n zones.
    hull : tuple of float
        The outermost ends [m].

    Attributes
    ----------
    coefficients : array, (2 n + 1,)
        f as a polynomial in x, lowest power first [m, 1, 1/m, ...]; loses digits beyond some ten
        zones.
    height, slope : callable
        f [m] and f' at positions x [m] of any shape.
    resolution : float
        A length the shape does not vary much within [m].

    Examples
    --------
    One zone alone is that of Hertz: f = x^2/2R with R = pi E* a^2/4P.

    >>> import numpy as np
    >>> from contact.inverse import design
    >>> profile = design([[-1.0, 1.0]], E_star=1.0, load=0.25 * np.pi).profile
    >>> type(profile).__name__, bool(np.isclose(profile.coefficients[2], 0.5))
    ('DesignedProfile', True)
    """

    slope_series: Array
    hull: tuple[float, float]

    def _local(self, x: ArrayLike) -> Array:
        lo, hi = self.hull
        x = np.asarray(x)
        return np.asarray(((x - lo) - (hi - x)) / (hi - lo))

    @property
    def _height_series(self) -> Array:
        return np.asarray(
            0.5 * (self.hull[1] - self.hull[0]) * chebyshev.chebint(self.slope_series)
        )

    def height(self, x: ArrayLike) -> Array:
        """f(x), zero in the middle of the zones' hull."""
        return np.asarray(chebyshev.chebval(self._local(x), self._height_series))

    def slope(self, x: ArrayLike) -> Array:
        """f'(x)."""
        return np.asarray(chebyshev.chebval(self._local(x), self.slope_series))

    @property
    def resolution(self) -> float:
        """A length the shape does not vary much within [m]."""
        return (self.hull[1] - self.hull[0]) / len(self.slope_series)

    @property
    def coefficients(self) -> Array:
        """f as a polynomial in x, lowest power first (loses digits beyond some ten zones)."""
        return np.asarray(
            np.polynomial.Chebyshev(self._height_series, self.hull)
            .convert(kind=np.polynomial.Polynomial)
            .coef
        )


def exp_of_power_sums(q: NDArray[np.inexact]) -> NDArray[np.complexfloating]:
    """Coefficients of prod (1 - y_i z)^{e_i} from q_k = sum e_i y_i^k: m S_m = -sum_{j=1}^m q_j
    S_{m-j} (Newton).
    """
    s = np.zeros(len(q), dtype=np.result_type(q, np.complex64))
    s[0] = 1.0
    for m in range(1, len(q)):
        s[m] = -np.dot(q[1 : m + 1], s[m - 1 :: -1]) / m
    return s


@dataclass(frozen=True, eq=False)
class GivenZones(ExactContact):
    """A subclass has the profile, the loads of the zones, and the formulas in its distances dl, dr
    from the ends of an interval.
    """

    zones: Array
    E_star: float
    load: float

    def _check(self) -> None:
        keep(self, positive_or_none, "period")
        zones = finite_array("zones", self.zones, ndim=2)
        object.__setattr__(self, "zones", zones)
        if zones.shape[1] != 2 or np.any(np.diff(zones.ravel()) <= 0.0):
            raise SceneError.of("zones", self.zones, "an (n, 2) array of ends, strictly increasing")
        if self.period is not None and not zones[-1, 1] - zones[0, 0] < self.period:
            raise SceneError.of("zones", self.zones, f"within one period {self.period:.17g}")

    @cached_property
    def _long(self) -> CutProduct:
        """In the longest precision there is: what the profile and the loads are made of."""
        return CutProduct(self.zones.astype(np.longdouble), self.period)

    @cached_property
    def _product(self) -> CutProduct:
        return CutProduct(self.zones.astype(float), self.period)

    @property
    def profile(self) -> DesignedProfile | Fourier:
        """The shape with this contact."""
        raise NotImplementedError

    def _of_slope(self, harmonics: Array) -> Fourier:
        """The shape with a period whose slope has these coefficients of e^{-2 pi i m x/L}, m = 1,
        2, ...
        """
        wave = 2.0 * self._long._turn * np.arange(1, len(harmonics) + 1)
        cosine, sine = -2.0 * harmonics.imag / wave, 2.0 * harmonics.real / wave
        return Fourier(self._long.period, cosine.astype(float), sine.astype(float))  # type: ignore[arg-type]

    def _zone_pressure(self, i: int, dl: Array, dr: Array) -> Array:
        """p on the interval i, a zone."""
        raise NotImplementedError

    def _opening(self, i: int, dl: Array, dr: Array) -> Array:
        """Slope of the gap in the gap i (-1: left of all zones)."""
        raise NotImplementedError

    def _from_left(self, i: int, dl: Array, dr: Array) -> Mask:
        """Whether the gap at places of the gap i is integrated from the left."""
        raise NotImplementedError

    def _on(self, odd: bool, x: ArrayLike, function: Callable[[int, Array, Array], Array]) -> Array:
        """A function of gaps (odd) or of zones, by their numbers and the distances of places from
        their ends; 0 elsewhere.
        """
        x = np.asarray(x, dtype=float)
        interval, dl, dr = self._product.locate(x)
        values = np.zeros_like(x)
        for i in np.unique(interval[interval % 2 == odd]):
            here = interval == i
            values[here] = function(int(i), dl[here], dr[here])
        return values

    def gap(self, x: ArrayLike) -> Array:
        """u + f - approach [m], 0 in the zones: the slope integrated from an end of the gap."""
        return self._on(True, x, self._opened)

    def _opened(self, i: int, dl: Array, dr: Array) -> Array:
        left, right = dl[:, None], dr[:, None]
        rightward = self._from_left(i, left, right)
        way, rest = np.where(rightward, left, right), np.where(rightward, right, left)
        safe = np.where(way == 0.0, 1.0, way)  # the slope may be infinite at an end
        # From the end, way s^2: the slope may be as 1/s there.
        near, far = safe * FROM_LEFT**2, rest + safe * FROM_RIGHT * (1.0 + FROM_LEFT)
        values = self._opening(i, np.where(rightward, near, far), np.where(rightward, far, near))
        return np.asarray(
            np.sum(np.where(rightward, 2.0, -2.0) * way * FROM_LEFT * WEIGHT * values, axis=-1)
        )

    def height(self, x: ArrayLike) -> Array:
        """f(x) [m], up to a constant."""
        return self.profile.height(x)

    def slope(self, x: ArrayLike) -> Array:
        """f'(x)."""
        return self.profile.slope(x)

    @property
    def nearness(self) -> float:
        """Narrowest gap over widest zone: what makes a problem hard."""
        gaps = self._product.steps[1::2]
        return float(np.min(gaps) / np.max(self.zone_widths)) if gaps.size else np.inf

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Pressure [Pa] at the normalised position t in [-1, 1] of a zone, to rounding up to its
        ends.
        """
        check_number(zone, len(self.zones))
        t = np.asarray(t, dtype=float)
        half = 0.5 * self._product.steps[2 * zone]
        return self._zone_pressure(2 * zone, half * (1.0 + t), half * (1.0 - t))

    def pressure(self, x: ArrayLike) -> Array:
        """p(x) [Pa], 0 outside the zones."""
        return self._on(False, x, self._zone_pressure)

    def gap_slope(self, x: ArrayLike) -> Array:
        """(u + f)' between the zones, 0 in them."""
        return self._on(True, x, self._opening)

    def displacement(self, x: ArrayLike) -> Array:
        """u(x) [m] into the body, of zero mean; periodic only."""
        if self.approach is None:
            raise SceneError.of(
                "period", None, "a length > 0: an isolated displacement needs a datum"
            )
        return self.approach - (self.height(x) - self._least_height) + self.gap(x)

    def _greatest(self, beside: float, samples: int) -> float:
        """Greatest pressure, no nearer to the ends than an angle `beside`."""
        ends = beside, np.pi - beside
        zones = range(len(self.zones))
        return max(
            -least_value(
                lambda phi, zone=zone: -self.pressure_at(np.cos(phi), zone),  # type: ignore[misc]
                *ends,
                samples,
            )
            for zone in zones
        )

    @cached_property
    def _least_height(self) -> float:
        return least_value(self.height, 0.0, self.period or 0.0, 64 * len(self.zones) + 64)

    @cached_property
    def mean_gap(self) -> float | None:
        """Mean of the gap over the period, -(1/L) sum int_gap x g' dx; None without a period."""
        if self.period is None:
            return None
        nodes = [(g, *self._product.nodes(g)) for g in self._product.gaps]
        return (
            -sum(
                float(np.sum(weight * dl * self._opening(g, dl, dr))) for g, dl, dr, weight in nodes
            )
            / self.period
        )

    @property
    def approach(self) -> float | None:
        """min f = 0 and mean u = 0, so that approach = mean f - min f - mean gap; None without a
        period.
        """
        return None if self.mean_gap is None else -self._least_height - self.mean_gap


@dataclass(frozen=True, eq=False)
class DesignedContact(GivenZones):
    """An exact contact of given zones and load: the profile is chosen such that they are right; see
    the head of this module.

    p = (E*/2)|X M| on the zones, gap slope = X M between them; pressures, gaps and loads are exact
    to rounding. Derived from the general solution (34) of N. I. Muskhelishvili, Singular Integral
    Equations (1953), ch. 11.

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
        p [Pa], gap [m], its slope, u [m] (with a period), f [m] up to a constant and f' at
        positions x [m] of any shape.
    pressure_at : callable
        p [Pa] at normalised positions t in [-1, 1] of a zone, to rounding up to its ends.

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the zones are not strictly ascending and within
        one period.
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
        return np.array(
            [np.sum(weight * self._long.magnitude(i, dl, dr)) for i, dl, dr, weight in nodes]
        )

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
            # x = middle + half (v + 1/v)/2 maps (x - e)/unit to v (1 - e^{i phi}/v)(1 - e^{-i
            # phi}/v).
            points = np.concatenate([ends, roots])
            phi = 2.0 * np.arctan2(np.sqrt(hull[1] - points), np.sqrt(points - hull[0]))
            power_sums = np.array([2.0 * np.sum(exponents * np.cos(k * phi)) for k in range(2 * n)])
            series = 2.0 * self._long_scale * exp_of_power_sums(power_sums).real[::-1]
            series[0] *= 0.5
            return DesignedProfile(series.astype(float), hull)
        # Above the axis, w = e^{2 pi i z/L}: 2 sin(pi (z - e)/L) = i e^{-i pi (z - e)/L} (1 - w
        # e^{-2 pi i e/L}).
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

    def _zone_pressure(self, i: int, dl: Array, dr: Array) -> Array:
        return np.asarray(
            0.5 * self.E_star * self._scale * self._product.magnitude(i, dl, dr), dtype=float
        )

    def _opening(self, i: int, dl: Array, dr: Array) -> Array:
        return self._scale * self._product.side(i, dl, dr) * self._product.magnitude(i, dl, dr)

    def _from_left(self, i: int, dl: Array, dr: Array) -> Mask:
        """From the end on the same side of the gap's widest point."""
        return self._product.side(i, dl, dr) > 0.0

    @cached_property
    def max_pressure(self) -> float:
        """Peak pressure [Pa], from ever closer samples around the largest one of every zone."""
        return self._greatest(0.0, 129)


def design(
    zones: ArrayLike, E_star: float, load: float, period: float | None = None
) -> DesignedContact:
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
        If a number is not positive and finite, or the zones are not strictly ascending and within
        one period.

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
