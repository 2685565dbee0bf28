"""The shape of a designed contact that is alone: a Chebyshev series of f'."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from contact.model.profiles.base import Profile
from sie import Array


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
