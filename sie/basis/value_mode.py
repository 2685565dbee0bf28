r"""Density of kappa phi + T phi = g with the value 1 at one end and 0 at the other, in closed form.

With the value 1 at the left end it is V(t) = I_((1 - t)/2)(alpha, 1 - alpha), I the regularised
incomplete beta function. The derivative V' is -1/pi times the weight w of `sie.basis.weighted`. The
right side of V, and its transform F at points zeta off the interval, are

    (kappa + T) V = (log((1 + t) / 2) - psi(alpha) - gamma) / pi,
    F(zeta) = -1/pi  int_u^1 (1 - v^(alpha - 1)) / (1 - v) dv,    u = (zeta - 1) / (zeta + 1),

psi the digamma function and gamma Euler's constant. For kappa = 0 V is arccos(t) / pi. The density
with the value 1 at the right end is the mirror image, with -kappa. Beyond the end with the value 1,
the density may keep this value. The right side of that part contains a logarithm, too, and the two
logarithms cancel.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from sie.basis.data import Array
from sie.basis.jacobi import log_ratio
from sie.basis.lerch import beta_share, value_transform
from sie.basis.weighted import JacobiFunctions, Points, from_ends

Number = NDArray[Any]


@dataclass(frozen=True)
class ValueMode:
    """The density with the value 1 at one end of (-1, 1) and 0 at the other.
    Its right side kappa phi + T phi is a multiple of the logarithm of the distance from the end
    with the value 1, plus a constant.

    Parameters
    ----------
    weighted : JacobiFunctions
        The basis densities on the interval, for the factor kappa.
    at_left : bool
        Whether the value at the left end is 1.

    Examples
    --------
    >>> import numpy as np
    >>> from sie.basis.value_mode import ValueMode
    >>> from sie.basis.weighted import JacobiFunctions
    >>> mode, t = ValueMode(JacobiFunctions(0.0)), np.array([-0.25, 0.0])
    >>> mode.density(1 + t, 1 - t).round(6).tolist()  # arccos(t) / pi
    [0.580431, 0.5]
    >>> mode.own(1 + t, 1 - t).round(6).tolist()
    [0.129064, 0.220636]
    """

    weighted: JacobiFunctions
    at_left: bool = True

    @property
    def _half(self) -> JacobiFunctions:
        """The basis densities `weighted`, mirrored if this density is 1 at the right end."""
        return self.weighted if self.at_left else self.weighted.mirrored

    @property
    def _sign(self) -> float:
        return 1.0 if self.at_left else -1.0

    def _sides(self, left: Any, right: Any) -> tuple[Array, Array]:
        """Distances from the end where the density is 1, and from the other end."""
        left, right = np.asarray(left, dtype=float), np.asarray(right, dtype=float)
        return (left, right) if self.at_left else (right, left)

    @property
    def total(self) -> float:
        """Integral of the density over the interval."""
        return 2 * self._half.rest

    def density(self, left: Any, right: Any) -> Array:
        """The density at places given by left = 1 + t and right = 1 - t."""
        w, (near, far) = self._half, self._sides(left, right)
        return beta_share(w.alpha, w.rest, 0.5 * far, 0.5 * near)

    def own(self, left: Any, right: Any) -> Array:
        """Right side kappa phi + T phi of this density phi on the interval; T is the transform."""
        near, _ = self._sides(left, right)
        constant = float(special.digamma(self._half.alpha)) + float(np.euler_gamma)
        return np.asarray(self._sign / np.pi * (np.log(0.5 * near) - constant))

    def integral_to(self, left: Any, right: Any) -> Array:
        """Integral of the density from -1 to t."""
        w, (near, far) = self._half, self._sides(left, right)
        a, b = w.recurrence(2)
        by_weight = w.integral_to(np.array([1 + a[0], 2 * b[1]]), near, far)
        value = near * self.density(left, right) + by_weight / np.pi
        return np.asarray(value if self.at_left else self.total - value)

    def edge_slopes(self) -> tuple[float, float]:
        """Factors A of the terms A d^gamma of this density at the left and right end.
        d is the distance from the end, for the half width 1. gamma is 1 - alpha at the left end and
        alpha at the right end. At the end with the value 1, A d^gamma is added to this value.
        """
        w = self._half
        near = -w.sine / np.pi / w.rest * 0.5**w.rest
        far = w.sine / np.pi / w.alpha * 0.5**w.alpha
        return (near, far) if self.at_left else (far, near)

    def moments(self, length: int) -> Array:
        """Chebyshev moments (2 - delta_l0) / pi int V T_l dt of this density V, for l < `length`.

        They are defined as in `JacobiFunctions.moments`.
        """
        weights = self._half.first_moments(length + 1)
        weights[1:] *= 0.5
        n = np.arange(1.0, length + 1)
        # `divided` is ((1/pi) int w T_n dt - T_n(-1)) / n, with the weight w. Integration by parts
        # gives the moments of V from `divided`.
        divided = (weights[1:] - (1 - 2 * (n % 2))) / n
        out = divided.copy()
        out[1:] *= 0.5
        out[2:] -= 0.5 * divided[: length - 2]
        out[1:] *= 2
        return np.asarray(out / np.pi * self._sign ** np.arange(length))

    def transform(self, points: Points) -> Number:
        """Transform (1/pi) int V(t) / (zeta - t) dt of this density V at points zeta.
        The points are off the interval.
        """

        def of(w: JacobiFunctions, left: Number, less: Number) -> Number:
            return value_transform(w.alpha, w.rest, left, less)

        return self._mirrored(points, of, -1.0)

    def slope(self, points: Points) -> Number:
        """Derivative of `transform` by the coordinate zeta of the points."""

        def of(w: JacobiFunctions, left: Number, less: Number) -> Number:
            return np.asarray(np.expm1(-w.rest * log_ratio(less, left)) / (-np.pi * left))

        return self._mirrored(points, of, 1.0)

    def _mirrored(
        self, points: Points, of: Callable[[JacobiFunctions, Number, Number], Number], sign: float
    ) -> Number:
        """Transform of this density (or its derivative), by a function `of`.
        `of` is for the density with the value 1 at the left end. If this density has the value 1 at
        the right end, `of` is called at the mirror images of the points. The result is then
        multiplied by `sign`.
        """
        left, less = from_ends(points)
        if self.at_left:
            return of(self._half, left, less)
        return np.asarray(sign * np.conj(of(self._half, -np.conj(less), -np.conj(left))))
