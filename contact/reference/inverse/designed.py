"""Inverse design of frictionless contacts: the profile that has given zones.

X^2 is the product over all zone ends e of x - e, or of 2 sin(pi (x - e)/L) with a period L. M is a
product of the same kind with one root in every gap, such that int_gap X M dx = 0. Let f' be the
polynomial part of X M, which is a trigonometric polynomial with a period. Then
Phi = (E*/2)(f' - X M) is the Cauchy (Hilbert) transform of the pressure p, and

    p = (E*/2)|X M| on the zones,   gap slope = X M between the zones.
For n isolated zones M has n - 1 roots, and f is a polynomial of degree 2n. For n zones in a period
M has n roots, and f is a Fourier series of n harmonics. (X and M are both multiplied by (-1)^n over
a period, so that X M is periodic; the mean slope vanishes because the gap integrals do.) Derived
from the general solution (34) of Muskhelishvili, Singular Integral Equations (1953), ch. 11.

A point x is given by its distances to the two ends of the zone or gap in which it lies. The factors
of X and M are formed from these distances, so that nothing cancels near an end.
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
    """The profile f of an isolated designed contact: f' is a Chebyshev series on `hull`.

    `design` makes it, for `contact.Scene`. The profile of a periodic design is a `contact.Fourier`.

    Parameters
    ----------
    slope_series : array, (2 n,)
        Chebyshev coefficients of f' on the hull, for n zones.
    hull : tuple of float
        The outermost ends [m].

    Attributes
    ----------
    coefficients : array, (2 n + 1,)
        f as a polynomial in x, lowest power first [m, 1, 1/m, ...]; inaccurate for more than some
        ten zones.
    height, slope : callable
        f [m] and f' at positions x [m] of any shape.
    resolution : float
        Length over which the profile varies little [m].

    Examples
    --------
    One isolated zone is Hertz's: f = x^2/2R with R = pi E* a^2/4P.

    >>> import numpy as np
    >>> from contact.inverse import design
    >>> profile = design([[-1.0, 1.0]], E_star=1.0, load=0.25 * np.pi).profile
    >>> type(profile).__name__, bool(np.isclose(profile.coefficients[2], 0.5))
    ('DesignedProfile', True)
    """

    slope_series: Array
    hull: tuple[float, float]

    def _local(self, x: ArrayLike) -> Array:
        """Position x mapped so that the interval from the first to the last zone end is [-1, 1]."""
        lo, hi = self.hull
        x = np.asarray(x)
        return np.asarray(((x - lo) - (hi - x)) / (hi - lo))

    @property
    def _height_series(self) -> Array:
        return np.asarray(
            0.5 * (self.hull[1] - self.hull[0]) * chebyshev.chebint(self.slope_series)
        )

    def height(self, x: ArrayLike) -> Array:
        """Height f(x) [m] of the profile.
        It is 0 in the middle between the first and the last zone end.
        """
        return np.asarray(chebyshev.chebval(self._local(x), self._height_series))

    def slope(self, x: ArrayLike) -> Array:
        """Slope f'(x) of the profile."""
        return np.asarray(chebyshev.chebval(self._local(x), self.slope_series))

    @property
    def resolution(self) -> float:
        """Length over which the profile varies little [m]: hull divided by number of terms."""
        return (self.hull[1] - self.hull[0]) / len(self.slope_series)

    @property
    def coefficients(self) -> Array:
        """Coefficients of the profile f as a polynomial in x, from lowest to highest power."""
        return np.asarray(
            np.polynomial.Chebyshev(self._height_series, self.hull)
            .convert(kind=np.polynomial.Polynomial)
            .coef
        )


def exp_of_power_sums(q: NDArray[np.inexact]) -> NDArray[np.complexfloating]:
    """Coefficients S_m of prod_i (1 - y_i z)^{e_i} as a power series in z, from power sums q.

    They follow from the power sums q_k = sum_i e_i y_i^k by Newton's identity
    m S_m = -sum_{j=1}^m q_j S_{m-j}.
    """
    s = np.zeros(len(q), dtype=np.result_type(q, np.complex64))
    s[0] = 1.0
    for m in range(1, len(q)):
        s[m] = -np.dot(q[1 : m + 1], s[m - 1 :: -1]) / m
    return s


@dataclass(frozen=True, eq=False)
class GivenZones(ExactContact):
    """Base class of exact contacts for which the zones are given and the profile follows.
    The fields follow from the product X M of `CutProduct`.

    A subclass defines the profile, the zone loads, the pressure and the slope of the gap. Its
    formulas take the distances dl and dr of a point from the left and right end of its interval.
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
    def _extended(self) -> CutProduct:
        """The product X M of `CutProduct` in extended precision, for the profile and the loads."""
        return CutProduct(self.zones.astype(np.longdouble), self.period)

    @cached_property
    def _product(self) -> CutProduct:
        """The product X M of `CutProduct` in double precision, for the pressure and the gap."""
        return CutProduct(self.zones.astype(float), self.period)

    @property
    def profile(self) -> DesignedProfile | Fourier:
        """The profile of the body that has this contact."""
        raise NotImplementedError

    def _of_slope(self, harmonics: Array) -> Fourier:
        """The periodic profile whose slope has the Fourier coefficients `harmonics`.
        The coefficients belong to e^{-2 pi i m x/L} for m = 1, 2, ...
        """
        wave = 2.0 * self._extended._turn * np.arange(1, len(harmonics) + 1)
        cosine, sine = -2.0 * harmonics.imag / wave, 2.0 * harmonics.real / wave
        assert self.period is not None
        return Fourier(self.period, cosine.astype(float), sine.astype(float))

    def _zone_pressure(self, i: int, dl: Array, dr: Array) -> Array:
        """Pressure at points of the zone with interval number i.
        dl and dr are the distances to its ends.
        """
        raise NotImplementedError

    def _opening(self, i: int, dl: Array, dr: Array) -> Array:
        """Slope of the gap at points of the gap with interval number i (-1: left of all zones)."""
        raise NotImplementedError

    def _from_left(self, i: int, dl: Array, dr: Array) -> Mask:
        """Mask of the points of gap i for which the slope is integrated from the left end.
        For all other points it is integrated from the right end.
        """
        raise NotImplementedError

    def _on(self, odd: bool, x: ArrayLike, function: Callable[[int, Array, Array], Array]) -> Array:
        """Values of `function` at the points x in gaps (if `odd`) or in zones; 0 at all other x.

        The arguments of `function` are the number of an interval, and the distances of points from
        the left and the right end of this interval.
        """
        x = np.asarray(x, dtype=float)
        interval, dl, dr = self._product.locate(x)
        values = np.zeros_like(x)
        for i in np.unique(interval[interval % 2 == odd]):
            here = interval == i
            values[here] = function(int(i), dl[here], dr[here])
        return values

    def gap(self, x: ArrayLike) -> Array:
        """Gap [m] between the surfaces: displacement + profile - approach; 0 in the zones.

        The gap is the integral of its slope from a zone end.
        """
        return self._on(True, x, self._opened)

    def _opened(self, i: int, dl: Array, dr: Array) -> Array:
        left, right = dl[:, None], dr[:, None]
        rightward = self._from_left(i, left, right)
        length, rest = np.where(rightward, left, right), np.where(rightward, right, left)
        safe = np.where(length == 0.0, 1.0, length)  # the slope may be infinite at an end
        # Near an end the slope of the gap may grow like 1/sqrt(distance from the end). With
        # distance = length s^2, the integrand is smooth in the integration variable s.
        start, stop = safe * FROM_LEFT**2, rest + safe * FROM_RIGHT * (1.0 + FROM_LEFT)
        values = self._opening(
            i, np.where(rightward, start, stop), np.where(rightward, stop, start)
        )
        sign = np.where(rightward, 2.0, -2.0)
        return np.asarray(np.sum(sign * length * FROM_LEFT * WEIGHT * values, axis=-1))

    def height(self, x: ArrayLike) -> Array:
        """Height f(x) [m] of the profile, up to a constant."""
        return self.profile.height(x)

    def slope(self, x: ArrayLike) -> Array:
        """Slope f'(x) of the profile f of the designed body."""
        return self.profile.slope(x)

    @property
    def nearness(self) -> float:
        """Width of the narrowest gap divided by the width of the widest zone."""
        gaps = self._product.steps[1::2]
        return float(np.min(gaps) / np.max(self.zone_widths)) if gaps.size else np.inf

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Pressure [Pa] at the position t of a zone, from -1 at its left to 1 at its right end.
        It is accurate up to the ends.
        """
        check_number(zone, len(self.zones))
        t = np.asarray(t, dtype=float)
        half = 0.5 * self._product.steps[2 * zone]
        return self._zone_pressure(2 * zone, half * (1.0 + t), half * (1.0 - t))

    def pressure(self, x: ArrayLike) -> Array:
        """Contact pressure p(x) [Pa]; 0 outside the zones."""
        return self._on(False, x, self._zone_pressure)

    def gap_slope(self, x: ArrayLike) -> Array:
        """Slope of the gap, (u + f)', with displacement u and profile f; 0 in the zones."""
        return self._on(True, x, self._opening)

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement u(x) [m] of the surface into the body, with mean 0.
        Raises SceneError without a period.
        """
        if self.approach is None:
            raise SceneError.of(
                "period",
                None,
                "a length > 0: without a period the displacement has an unknown constant",
            )
        return self.approach - (self.height(x) - self._least_height) + self.gap(x)

    def _greatest(self, margin: float, samples: int) -> float:
        """Largest pressure [Pa] of all zones.
        Each zone is searched at the normalised positions cos(phi) in [-1, 1]. The angle phi goes
        from `margin` to pi - `margin`.
        """

        def peak(zone: int) -> float:
            def minus_pressure(phi: Array) -> Array:
                return -self.pressure_at(np.cos(phi), zone)

            return -least_value(minus_pressure, margin, np.pi - margin, samples)

        return max(peak(zone) for zone in range(len(self.zones)))

    @cached_property
    def _least_height(self) -> float:
        return least_value(self.height, 0.0, self.period or 0.0, 64 * len(self.zones) + 64)

    @cached_property
    def mean_gap(self) -> float | None:
        """Mean gap [m] over the period: -(1/L) times the sum of int x gap'(x) dx over the gaps.

        None without a period.
        """
        if self.period is None:
            return None
        total = 0.0
        for g in self._product.gaps:
            dl, dr, weight = self._product.nodes(g)
            total -= float(np.sum(weight * dl * self._opening(g, dl, dr)))
        return total / self.period

    @property
    def approach(self) -> float | None:
        """Approach [m]: -min f - mean gap, for the profile f of mean 0; None without a period.

        The displacement, too, has the mean 0.
        """
        return None if self.mean_gap is None else -self._least_height - self.mean_gap


@dataclass(frozen=True, eq=False)
class DesignedContact(GivenZones):
    """An exact frictionless contact with given zones and load.
    The profile of the body follows from them.

    p = (E*/2)|X M| on the zones, gap slope = X M between them: see the head of this module.
    Pressures, gaps and loads are exact to round-off. Derived from the general solution (34) of N.
    I. Muskhelishvili, Singular Integral Equations (1953), ch. 11.

    Parameters
    ----------
    zones : array_like, (n, 2)
        Ends of the zones [m], ascending; within one period if there is one.
    E_star : float
        Reduced modulus [Pa].
    load : float
        P > 0 of all zones per unit thickness, per period if there is one [N/m].
    period : float or None
        Period L [m]; None: the body is isolated.

    Attributes
    ----------
    profile : DesignedProfile or Fourier
        The profile that has this contact.
    max_pressure : float
        Largest pressure [Pa].
    zone_loads, zone_widths : array, (n,)
        Load [N/m] and width [m] of every zone.
    mean_pressure, contact_fraction : float or None
        P/L [Pa], and the part of the period in contact; None without a period.
    nearness : float
        Width of the narrowest gap divided by that of the widest zone; the problem is hard if it is
        small.
    approach, mean_gap : float or None
        With min f = 0 and mean u = 0 [m]; None without a period.
    pressure, gap, gap_slope, displacement, height, slope : callable
        p [Pa], gap [m], its slope, u [m] (with a period), f [m] up to a constant and f' at
        positions x [m] of any shape.
    pressure_at : callable
        p [Pa] at normalised positions t in [-1, 1] of a zone, accurate up to its ends.

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the zones are not strictly ascending and within
        one period.
    NotConverged
        From every attribute, if the roots of M are not found.

    Examples
    --------
    One zone a period is Westergaard's: P = pi E* Delta sin^2(pi a/L).

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
        return self._extended.rounded()

    @cached_property
    def _raw_loads(self) -> Array:
        """Integrals of |X M| over each zone, not yet scaled to the given load.
        The pressure is proportional to |X M|.
        """
        nodes = [(i, *self._extended.nodes(i)) for i in range(0, 2 * len(self.zones), 2)]
        return np.array(
            [np.sum(weight * self._extended.magnitude(i, dl, dr)) for i, dl, dr, weight in nodes]
        )

    @cached_property
    def _extended_scale(self) -> Any:
        """The factor of X M with which the pressure (E*/2)|X M| carries the given load."""
        return self.load / (0.5 * self.E_star * np.sum(self._raw_loads))

    @property
    def _scale(self) -> float:
        return float(self._extended_scale)

    @cached_property
    def profile(self) -> DesignedProfile | Fourier:
        """The profile of the body that has this contact."""
        hull = (float(self.zones[0, 0]), float(self.zones[-1, 1]))
        ends = self._extended.zones.ravel()
        roots = ends[list(self._extended.gaps)] + self._extended.roots[:, 0]
        exponents = np.concatenate([np.full(len(ends), 0.5), np.ones(len(roots))])
        n = len(self.zones)
        if self.period is None:
            # X M becomes a series in powers of v, where x = middle + half (v + 1/v)/2, with the
            # middle and the half width of `hull`. For a zone end or a root of M at e = middle +
            # half cos(phi), the factor in X^2 or M is (x - e)/unit = v (1 - e^{i phi}/v)(1 - e^{-i
            # phi}/v), with unit = half/2.
            points = np.concatenate([ends, roots])
            phi = 2.0 * np.arctan2(np.sqrt(hull[1] - points), np.sqrt(points - hull[0]))
            power_sums = np.array([2.0 * np.sum(exponents * np.cos(k * phi)) for k in range(2 * n)])
            series = 2.0 * self._extended_scale * exp_of_power_sums(power_sums).real[::-1]
            series[0] *= 0.5
            return DesignedProfile(series.astype(float), hull)
        # Let z be a complex point above the real axis and w = e^{2 pi i z/L}. The factor of an end
        # or root e is then 2 sin(pi (z - e)/L) = i e^{-i pi (z - e)/L} (1 - w e^{-2 pi i e/L}).
        angle = 2.0 * self._extended.pi / self.period * np.concatenate([ends, roots])
        power_sums = np.array([np.sum(exponents * np.exp(-1j * k * angle)) for k in range(n + 1)])
        phase = np.exp(0.5j * np.sum(exponents * angle))
        coefficients = phase * exp_of_power_sums(power_sums)
        # `coefficients[k]` is the factor of w^(k - n) in X M above the real axis. The constant term
        # has k = n and is 2i/E* times the mean pressure. The mean pressure is positive, which fixes
        # the sign of the square root X.
        coefficients *= np.sign(coefficients[n].imag) * self._extended_scale
        return self._of_slope(coefficients[n - 1 :: -1])

    @property
    def zone_loads(self) -> Array:
        """Load [N/m] of every zone; their sum is the given load."""
        return np.asarray(self.load * self._raw_loads / np.sum(self._raw_loads), dtype=float)

    def _zone_pressure(self, i: int, dl: Array, dr: Array) -> Array:
        return np.asarray(
            0.5 * self.E_star * self._scale * self._product.magnitude(i, dl, dr), dtype=float
        )

    def _opening(self, i: int, dl: Array, dr: Array) -> Array:
        return self._scale * self._product.side(i, dl, dr) * self._product.magnitude(i, dl, dr)

    def _from_left(self, i: int, dl: Array, dr: Array) -> Mask:
        """Mask of the points of gap i for which the slope is integrated from the left end.
        For all other points it is integrated from the right end.

        The points of the mask lie on the left of the widest point of the gap.
        """
        return self._product.side(i, dl, dr) > 0.0

    @cached_property
    def max_pressure(self) -> float:
        """Largest pressure [Pa]."""
        return self._greatest(0.0, 129)
