"""The shape of a designed contact: a Fourier series with a period, a Chebyshev series of f' alone."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.polynomial import chebyshev, polynomial
from numpy.typing import ArrayLike, NDArray

from contact.errors import SceneError
from contact.model.profiles.base import Profile
from sie import Array


@dataclass(frozen=True, eq=False)
class DesignedProfile(Profile):
    """The shape of a designed contact: f' a sum of Chebyshev polynomials on `hull`, or with a period

    f = sum cosine[k-1] cos(2 pi k x/L) + sine[k-1] sin(2 pi k x/L). It is made by `design`, and given to `contact.Scene`.

    Parameters
    ----------
    period : float or None
        Period L [m]; None: the body is alone.
    slope_series : array, (2 n,)
        Chebyshev coefficients of f' on the hull, for n zones; empty with a period.
    hull : tuple of float
        The outermost ends [m].
    cosine, sine : array, (n,)
        Fourier coefficients of f [m]; empty without a period.

    Attributes
    ----------
    coefficients : array, (2 n + 1,)
        Alone: f as a polynomial in x, lowest power first [m, 1, 1/m, ...]; loses digits beyond some ten zones.
    height, slope : callable
        f [m] and f' at positions x [m] of any shape.
    resolution : float
        A length the shape does not vary much within [m].

    Raises
    ------
    SceneError
        From `coefficients`, if there is a period.

    Examples
    --------
    One zone alone is that of Hertz: f = x^2/2R with R = pi E* a^2/4P.

    >>> import numpy as np
    >>> from contact.inverse import design
    >>> profile = design([[-1.0, 1.0]], E_star=1.0, load=0.25 * np.pi).profile
    >>> type(profile).__name__, bool(np.isclose(profile.coefficients[2], 0.5))
    ('DesignedProfile', True)
    """

    period: float | None
    slope_series: Array
    hull: tuple[float, float]
    cosine: Array
    sine: Array

    def _phases(self, x: ArrayLike) -> tuple[Array, Array, float]:
        assert self.period is not None
        k = 2.0 * pi / self.period
        orders = np.arange(1.0, len(self.cosine) + 1.0)
        return k * np.asarray(self.wrap(x))[..., None] * orders, orders, k

    def _local(self, x: ArrayLike) -> Array:
        lo, hi = self.hull
        x = np.asarray(x)
        return np.asarray(((x - lo) - (hi - x)) / (hi - lo))

    def height(self, x: ArrayLike) -> Array:
        """f(x), of zero mean over the period; alone, zero in the middle of the zones' hull."""
        if self.period is None:
            half = 0.5 * (self.hull[1] - self.hull[0])
            return np.asarray(half * chebyshev.chebval(self._local(x), chebyshev.chebint(self.slope_series)))
        phase, _, _ = self._phases(x)
        return np.asarray(np.cos(phase) @ self.cosine + np.sin(phase) @ self.sine)

    def slope(self, x: ArrayLike) -> Array:
        """f'(x)."""
        if self.period is None:
            return np.asarray(chebyshev.chebval(self._local(x), self.slope_series))
        phase, orders, k = self._phases(x)
        return np.asarray(k * (np.cos(phase) @ (orders * self.sine) - np.sin(phase) @ (orders * self.cosine)))

    def slope_conjugate(self, x: ArrayLike) -> Array | None:
        """H f' (cos -> sin, sin -> -cos); None without a period."""
        if self.period is None:
            return None
        phase, orders, k = self._phases(x)
        return np.asarray(k * (np.sin(phase) @ (orders * self.sine) + np.cos(phase) @ (orders * self.cosine)))

    @property
    def resolution(self) -> float:
        """A length the shape does not vary much within [m]."""
        if self.period is None:
            return (self.hull[1] - self.hull[0]) / len(self.slope_series)
        return self.period / len(self.cosine)

    @property
    def coefficients(self) -> Array:
        """Alone: f as a polynomial in x, lowest power first (loses digits beyond some ten zones)."""
        if self.period is not None:
            raise SceneError("a periodic design has `cosine` and `sine`, not polynomial `coefficients`")
        lo, hi = self.hull
        half, middle = 0.5 * (hi - lo), 0.5 * (hi + lo)
        series = half * chebyshev.chebint(self.slope_series)
        outer = chebyshev.cheb2poly(series)
        inner, power, total = np.array([-middle / half, 1.0 / half]), np.array([1.0]), np.zeros(1)
        for c in outer:
            total = polynomial.polyadd(total, c * power)
            power = polynomial.polymul(power, inner)
        return np.asarray(total)


def exp_of_power_sums(q: NDArray[np.inexact]) -> NDArray[np.complexfloating]:
    """Coefficients of prod (1 - y_i z)^{e_i} from q_k = sum e_i y_i^k: m S_m = -sum_{j=1}^m q_j S_{m-j}
    (Newton)."""
    s = np.zeros(len(q), dtype=np.result_type(q, np.complex64))
    s[0] = 1.0
    for m in range(1, len(q)):
        s[m] = -np.dot(q[1 : m + 1], s[m - 1 :: -1] if m > 0 else s[:0]) / m
    return s
