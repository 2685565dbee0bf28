"""What every contact designed to given zones shares: they, and numbers and fields built on the pressure and the slope of the gap.
The shape of one that is alone is a Chebyshev series of f'."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from contact.errors import SceneError
from contact.model.checks import finite_array, keep, positive_or_none
from contact.model.profiles.base import Profile
from contact.model.profiles.fourier import Fourier
from contact.reference.exact.base import FROM_LEFT, FROM_RIGHT, WEIGHT, Zoned, least_value
from contact.reference.inverse.product import CutProduct
from sie import Array, Mask


@dataclass(frozen=True, eq=False)
class DesignedProfile(Profile):
    """The shape of a designed contact that is alone: f' a sum of Chebyshev polynomials on `hull`.

    It is made by `design`, and given to `contact.Scene`; that of a design with a period is a `contact.Fourier`.

    Parameters
    ----------
    slope_series : array, (2 n,)
        Chebyshev coefficients of f' on the hull, for n zones.
    hull : tuple of float
        The outermost ends [m].

    Attributes
    ----------
    coefficients : array, (2 n + 1,)
        f as a polynomial in x, lowest power first [m, 1, 1/m, ...]; loses digits beyond some ten zones.
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
        return np.asarray(0.5 * (self.hull[1] - self.hull[0]) * chebyshev.chebint(self.slope_series))

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
        return np.asarray(np.polynomial.Chebyshev(self._height_series, self.hull).convert(kind=np.polynomial.Polynomial).coef)


def exp_of_power_sums(q: NDArray[np.inexact]) -> NDArray[np.complexfloating]:
    """Coefficients of prod (1 - y_i z)^{e_i} from q_k = sum e_i y_i^k: m S_m = -sum_{j=1}^m q_j S_{m-j}
    (Newton)."""
    s = np.zeros(len(q), dtype=np.result_type(q, np.complex64))
    s[0] = 1.0
    for m in range(1, len(q)):
        s[m] = -np.dot(q[1 : m + 1], s[m - 1 :: -1] if m > 0 else s[:0]) / m
    return s


class GivenZones(Zoned):
    """A subclass has the profile, the loads of the zones, and the formulas in its distances dl, dr from the ends of an interval."""

    # Annotations only: a subclass has them as its fields.
    zones: Array
    E_star: float
    load: float
    period: float | None

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
        """The shape with a period whose slope has these coefficients of e^{-2 pi i m x/L}, m = 1, 2, ..."""
        wave = 2.0 * self._long._turn * np.arange(1, len(harmonics) + 1)
        cosine, sine = -2.0 * harmonics.imag / wave, 2.0 * harmonics.real / wave
        return Fourier(self._long.period, cosine.astype(float), sine.astype(float))  # type: ignore[arg-type]

    def _zone_pressure(self, zone: int, dl: Array, dr: Array) -> Array:
        raise NotImplementedError

    def _opening(self, i: int, dl: Array, dr: Array) -> Array:
        """Slope of the gap in the gap i (-1: left of all zones)."""
        raise NotImplementedError

    def _from_left(self, i: int, dl: Array, dr: Array) -> Mask:
        """Whether the gap at places of the gap i is integrated from the left."""
        raise NotImplementedError

    def gap(self, x: ArrayLike) -> Array:
        """u + f - approach [m], 0 in the zones: the slope integrated from an end of the gap."""
        x = np.asarray(x, dtype=float)
        interval, dl, dr = self._product.locate(x)
        gap = np.zeros_like(x)
        outside = (interval % 2 == 1) & ((dl != 0.0) | (interval < 0)) & (dr != 0.0)
        for i in np.unique(interval[outside]):
            here = outside & (interval == i)
            left, right = dl[here][:, None], dr[here][:, None]
            rightward = self._from_left(int(i), left, right)
            way, rest = np.where(rightward, left, right), np.where(rightward, right, left)
            # From the end, way s^2: the slope may be as 1/s there.
            near, far = way * FROM_LEFT**2, rest + way * FROM_RIGHT * (1.0 + FROM_LEFT)
            values = self._opening(int(i), np.where(rightward, near, far), np.where(rightward, far, near))
            gap[here] = np.sum(np.where(rightward, 2.0, -2.0) * way * FROM_LEFT * WEIGHT * values, axis=-1)
        return gap

    def _nodes(self, i: int) -> Any:
        """dl, dr and weights of integrals over an interval."""
        raise NotImplementedError

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
        """Pressure [Pa] at the normalised position t in [-1, 1] of a zone, to rounding up to its ends."""
        if zone not in range(len(self.zones)):
            raise SceneError.of("zone", zone, f"0 to {len(self.zones) - 1}")
        t = np.asarray(t, dtype=float)
        half = 0.5 * self._product.steps[2 * zone]
        return self._zone_pressure(zone, half * (1.0 + t), half * (1.0 - t))

    def pressure(self, x: ArrayLike) -> Array:
        """p(x) [Pa], 0 outside the zones."""
        x = np.asarray(x, dtype=float)
        interval, dl, dr = self._product.locate(x)
        p = np.zeros_like(x)
        for zone in range(len(self.zones)):
            here = interval == 2 * zone
            p[here] = self._zone_pressure(zone, dl[here], dr[here])
        return p

    def gap_slope(self, x: ArrayLike) -> Array:
        """(u + f)' between the zones, 0 in them."""
        x = np.asarray(x, dtype=float)
        interval, dl, dr = self._product.locate(x)
        slope = np.zeros_like(x)
        for i in np.unique(interval[interval % 2 == 1]):
            here = interval == i
            slope[here] = self._opening(int(i), dl[here], dr[here])
        return slope

    def displacement(self, x: ArrayLike) -> Array:
        """u(x) [m] into the body, of zero mean; periodic only."""
        if self.approach is None:
            raise SceneError.of("period", None, "a length > 0: an isolated displacement needs a datum")
        return self.approach - (self.height(x) - self._least_height) + self.gap(x)

    def _greatest(self, beside: float, samples: int) -> float:
        """Greatest pressure, no nearer to the ends than an angle `beside`."""
        ends = beside, np.pi - beside
        zones = range(len(self.zones))
        return max(-least_value(lambda phi, zone=zone: -self.pressure_at(np.cos(phi), zone), *ends, samples) for zone in zones)  # type: ignore[misc]

    @cached_property
    def _least_height(self) -> float:
        return least_value(self.height, 0.0, self.period or 0.0, 64 * len(self.zones) + 64)

    @cached_property
    def mean_gap(self) -> float | None:
        """Mean of the gap over the period, -(1/L) sum int_gap x g' dx; None without a period."""
        if self.period is None:
            return None
        total = 0.0
        for g in self._product.gaps:
            dl, dr, weight = (np.asarray(v, dtype=float) for v in self._nodes(g))
            total -= float(np.sum(weight * dl * self._opening(g, dl, dr)))
        return total / self.period

    @property
    def approach(self) -> float | None:
        """min f = 0 and mean u = 0, so that approach = mean f - min f - mean gap; None without a period."""
        return None if self.mean_gap is None else -self._least_height - self.mean_gap
