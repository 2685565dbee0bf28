r"""Densities of the second-kind equation kappa phi + T phi = g on one interval, in closed form.

T phi(t) is (1/pi) PV int phi(s) / (t - s) ds over (-1, 1). With cot(pi alpha) = kappa, 0 < alpha <
1, a density at the distance d from an end is K d^(gamma - 1) + A d^gamma, with gamma = alpha at
the right end and 1 - alpha at the left end. A density is a sum of

    S_n(t) = w(t) p_n(t),    w = sin(pi alpha) (1 - t)^(alpha - 1) (1 + t)^(-alpha).

The polynomials p_n and q_n are those of `sie.basis.jacobi`; D_n(t) is (-1)^n q_n(-t). For kappa = 0
p_n is T_n, q_n and D_n are U_n, and the formulas below are those of `sie.basis.interval`. kappa may
be complex, except for i times beta with |beta| >= 1; alpha then is complex. The transform of S at
a point zeta off the interval is F(zeta) = (1/pi) int S(t) / (zeta - t) dt.

    on the interval  (kappa + T) S_n = -D_(n-1),    (kappa + T) S_0 = 0
    off it           S_0 -> (zeta - 1)^(alpha - 1) (zeta + 1)^(-alpha); S_n: minimal solution of the
                     recurrence of p_n (W. Gautschi, SIAM Review 9, 1967, 24-82)
    integral         of S_n from -1 to t is -(1 - t^2) w q_(n-1) / n for n > 0
    potential        on the interval, of S_n: -P_n / n - kappa int S_n, with the polynomial P_n
                     that is p_n for 1 - alpha; S_0: log 2 + psi(1 - alpha) + gamma - kappa int S_0
                     off it, of S_n: -1/n times the transform of (1 - t^2) w q_(n-1)

N. I. Muskhelishvili, Singular Integral Equations, 1953, ch. 14; G. Szegő, Orthogonal Polynomials,
4.62. Points t on the interval are given by their distances left = 1 + t and right = 1 - t from its
ends, points off the interval by the classes of `sie.basis.interval`.
"""

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from sie.basis.data import Array, Kept
from sie.basis.interval import InPlane, OnLine, Outside
from sie.basis.jacobi import Family, log_ratio, transform_sum, transform_table
from sie.basis.lerch import beta_share, complex_or_real, value_transform
from sie.basis.weight import alphas, power

Number = NDArray[Any]
Points = InPlane | OnLine | Outside


def exponent_of(kappa: complex) -> complex:
    """The exponent alpha with cot(pi alpha) = kappa and a real part in (0, 1).

    It has all digits for large kappa too. 1 - alpha is the exponent of -kappa.

    Parameters
    ----------
    kappa : float or complex
        The factor of the density in kappa phi + T phi = g.

    Returns
    -------
    float or complex

    Examples
    --------
    >>> from sie.basis.weighted import exponent_of
    >>> exponent_of(0.0), exponent_of(1.0)
    (0.5, 0.25)
    """
    return complex_or_real(alphas(np.asarray(kappa))[0])


class Split(NamedTuple):
    """Coefficients that give a density accurately close to ends where it is bounded.

    The density is w (k_left (1 - t) / 2 + k_right (1 + t) / 2) + (1 - t^2) w sum_n q_n(t) q[n],
    with the weight w and the Jacobi polynomials q_n. For several densities, k_left and k_right are
    arrays, and q has a row for each density.
    """

    k_left: Any
    k_right: Any
    q: Number


@dataclass(frozen=True)
class JacobiFunctions(Kept):
    """Densities S_n = w p_n for the equation kappa phi + T phi = g on (-1, 1).
    w is the weight, which is singular at both ends; p_n are Jacobi polynomials. The module's
    docstring has the formulas.

    Parameters
    ----------
    kappa : float or complex
        The factor of the density.

    Examples
    --------
    The density of kappa phi + T phi = 1 with the integral 0 is -2 sqrt(alpha (1 - alpha)) S_1.

    >>> import numpy as np
    >>> from sie.basis.weighted import JacobiFunctions
    >>> weighted, t = JacobiFunctions(2.0), np.array([-0.5, 0.0, 0.9])
    >>> c = np.array([0.0, -2 * np.sqrt(weighted.alpha * weighted.rest)])
    >>> weighted.own(c, 1 + t, 1 - t).round(12).tolist()
    [1.0, 1.0, 1.0]
    """

    kappa: complex

    @cached_property
    def alpha(self) -> Any:
        """The exponent alpha of the weight, with cot(pi alpha) = kappa."""
        return exponent_of(self.kappa)

    @cached_property
    def rest(self) -> Any:
        """The exponent 1 - alpha, without cancellation where alpha is close to 1."""
        return exponent_of(-self.kappa)

    @cached_property
    def sine(self) -> Any:
        """sin(pi alpha), the constant factor of the weight; alpha is the exponent."""
        if isinstance(self.kappa, complex):
            # Near kappa = i and kappa = -i, the sum 1 + kappa^2 loses digits. The product of 1 + i
            # kappa and 1 - i kappa does not.
            return 1.0 / cmath.sqrt((1 + 1j * self.kappa) * (1 - 1j * self.kappa))
        return 1.0 / math.hypot(1.0, self.kappa)

    @property
    def mirrored(self) -> "JacobiFunctions":
        """The densities for -kappa, which are mirror images of the densities for kappa.
        The density n for -kappa at t is (-1)^n times the density n for kappa at -t.
        """
        return JacobiFunctions(-self.kappa)

    @cached_property
    def singular(self) -> Family:
        """Jacobi polynomials p_n, orthogonal with the weight w; the products w p_n are densities.
        The densities solve the equation kappa phi + T phi = g.
        """
        return Family(self.alpha, self.rest)

    @cached_property
    def bounded(self) -> Family:
        """Jacobi polynomials q_n, orthogonal with the bounded weight (1 - t^2) w.
        They represent the bounded part of a density in a `Split`.
        """
        return Family(self.alpha, self.rest, bounded=True)

    @cached_property
    def images(self) -> Family:
        """Polynomials D_n(t) = (-1)^n q_n(-t), in which the right side of the equation is expanded.
        q_n are the Jacobi polynomials of `bounded`.
        """
        return self.bounded.mirrored

    def recurrence(self, count: int) -> tuple[Number, Number]:
        """Recurrence coefficients (a_n, b_n), n = 0 ... count - 1, of the Jacobi polynomials p_n.
        The recurrence is t p_n = b_(n+1) p_(n+1) + a_n p_n + b_n p_(n-1).

        t p_0 = 2 b_1 p_1 + a_0 p_0, as for Chebyshev's T_n. b_0 is zero.
        """
        return self.singular.recurrence(count)

    # The methods below give the density and its integrals on the interval.
    def weight(self, left: Any, right: Any) -> Number:
        """The weight w = sin(pi alpha) (1 - t)^(alpha - 1) (1 + t)^(-alpha).
        left, right: 1 + t and 1 - t of the points t.
        """
        left, right = np.asarray(left, dtype=float), np.asarray(right, dtype=float)
        return np.asarray(self.sine * right ** (self.alpha - 1) * left**-self.alpha)

    def bounded_weight(self, left: Any, right: Any) -> Number:
        """The bounded weight (1 - t^2) w, which vanishes at both ends; w is `weight`."""
        left, right = np.asarray(left, dtype=float), np.asarray(right, dtype=float)
        return np.asarray(self.sine * power(right, self.alpha) * power(left, self.rest))

    def values(self, c: Number, left: Any, right: Any) -> Number:
        """Sum of c_n p_n with Jacobi polynomials p_n; its product with `weight` is a density."""
        return self.singular.sums(c, left, right)

    def table(self, count: int, left: Any, right: Any) -> Number:
        """Values of the Jacobi polynomials p_n, n = 0 ... count - 1, along a new last axis.
        left, right: 1 + t and 1 - t of the points.
        """
        return self.singular.table(count, left, right)

    def own(self, c: Number, left: Any, right: Any) -> Number:
        """Right side kappa phi + T phi of a density phi = w sum_n c_n p_n on the interval.
        w is the weight, p_n are Jacobi polynomials, and T is the transform.
        """
        return -self.images.sums(c[1:], left, right)

    def split(self, c: Number, left_bounded: Any = False, right_bounded: Any = False) -> Split:
        """The density w sum_n c_n p_n as a `Split`, coefficients accurate near bounded ends.
        w is the weight, p_n are Jacobi polynomials. c has the shape (n,), or a row for each of
        several densities.

        At an end declared bounded the intensity is only round-off, and is set to zero. The
        coefficients follow from p_n = b_(n+1) q_n + e_n q_(n-1) - b_n q_(n-2), the last one first.
        """
        at_left, at_right = self.edge_values(c.shape[-1])
        k_left = np.where(left_bounded, 0.0, c @ at_left)
        k_right = np.where(right_bounded, 0.0, c @ at_right)
        count = max(c.shape[-1] - 2, 0)
        q = np.zeros((count + 2, *c.shape[:-1]), dtype=self.singular.numbers(c))
        b = self.recurrence(count + 3)[1]
        n = np.arange(1.0, count + 2)
        e = 2 * n * (self.alpha - self.rest) / (4 * n * n - 1)
        for m in range(count - 1, -1, -1):
            q[m] = (b[m + 3] * q[m + 2] + e[m + 1] * q[m + 1] - c[..., m + 2]) / b[m + 2]
        return Split(k_left, k_right, np.moveaxis(q[:count], 0, -1))

    def values_q(self, q: Number, left: Any, right: Any) -> Number:
        """Sum of q[n] q_n(t) with the Jacobi polynomials q_n of the bounded weight (1 - t^2) w.
        The coefficients q are those of a `Split`.
        """
        return self.bounded.sums(q, left, right)

    def density(self, split: Split, left: Any, right: Any) -> Number:
        """The density that a `Split` represents, at points on the interval; zero at bounded ends.
        left, right: 1 + t and 1 - t of the points t.

        For several densities, the first axis of the result numbers the densities.
        """
        left, right = np.asarray(left, dtype=float), np.asarray(right, dtype=float)
        out = self.bounded_weight(left, right) * self.values_q(split.q, left, right)
        with np.errstate(divide="ignore"):
            if np.any(split.k_left):
                ratio = power(right, self.alpha) * left**-self.alpha
                out += np.multiply.outer(0.5 * self.sine * split.k_left, ratio)
            if np.any(split.k_right):
                ratio = right**-self.rest * power(left, self.rest)
                out += np.multiply.outer(0.5 * self.sine * split.k_right, ratio)
        return np.asarray(out)

    def integral_to(self, c: Number, left: Any, right: Any) -> Number:
        """Integral from -1 to t of w sum_n c_n p_n (weight w, Jacobi polynomials p_n)."""
        left, right = np.asarray(left, dtype=float), np.asarray(right, dtype=float)
        higher = self.values_q(c[1:] / np.arange(1, len(c)), left, right)
        first = beta_share(self.rest, self.alpha, 0.5 * left, 0.5 * right)
        return np.asarray(np.pi * c[0] * first - self.bounded_weight(left, right) * higher)

    def total(self, c: Number) -> complex:
        """Integral of w sum_n c_n p_n over the interval (weight w, Jacobi polynomials p_n)."""
        return complex_or_real(np.pi * c[0])

    def first_moment(self, c: Number) -> complex:
        """Integral of t w sum_n c_n p_n over the interval (weight w, Jacobi polynomials p_n)."""
        a, b = self.recurrence(2)
        return complex_or_real(np.pi * (a[0] * c[0] + (b[1] * c[1] if len(c) > 1 else 0.0)))

    # The methods below give the density's behaviour at the ends.
    def edge_values(self, count: int) -> tuple[Number, Number]:
        """Values of the Jacobi polynomials p_n, n = 0 ... count - 1, at t = -1 and at t = 1."""
        return self.singular.at_minus_one(count), self.singular.at_one(count)

    def edge_derivatives(self, count: int) -> tuple[Number, Number]:
        """Derivatives of the Jacobi polynomials p_n, n = 0 ... count - 1, at t = -1 and t = 1."""
        squares, (left, right) = np.arange(count) ** 2, self.edge_values(count)
        return -squares * left / (2 * self.rest), squares * right / (2 * self.alpha)

    @property
    def edge_scale(self) -> tuple[Any, Any]:
        """Factors K of the terms K d^(gamma - 1) of the weight w at the left and the right end.
        d is the distance from the end, for the half width 1. gamma is 1 - alpha at the left end and
        alpha at the right end.
        """
        return self.sine * 2.0**-self.rest, self.sine * 2.0**-self.alpha

    def intensities(self, c: Number) -> tuple[Any, Any]:
        """Factors K of the terms K d^(gamma - 1) of a density at the left and the right end.
        The density is w sum_n c_n p_n, with the weight w and Jacobi polynomials p_n. d is the
        distance from the end, for the half width 1. gamma is 1 - alpha at the left end and alpha at
        the right end.
        """
        (left, right), (at_left, at_right) = self.edge_scale, self.edge_values(len(c))
        return left * complex_or_real(at_left @ c), right * complex_or_real(at_right @ c)

    def edge_slopes(self, c: Number) -> tuple[Any, Any]:
        """Factors A of the terms A d^gamma of a density at the left and the right end.
        The density is w sum_n c_n p_n, with the weight w and Jacobi polynomials p_n. d is the
        distance from the end, for the half width 1. gamma is 1 - alpha at the left end and alpha at
        the right end.
        """
        (left, right), (at_left, at_right) = self.edge_scale, self.edge_values(len(c))
        slope_left, slope_right = self.edge_derivatives(len(c))
        return (
            left * complex_or_real((0.5 * self.rest * at_left + slope_left) @ c),
            right * complex_or_real((0.5 * self.alpha * at_right - slope_right) @ c),
        )

    # The methods below give transforms of densities at points off the interval.
    def transforms(self, count: int, points: Points) -> Number:
        """Transforms of the densities w p_n at points off the interval, n = 0 ... count - 1.
        w is the weight, p_n are Jacobi polynomials. The index n is along a new last axis.
        """

        def of(half: JacobiFunctions, sign: float, less: Number, left: Number) -> Number:
            table = transform_table(half.singular, count, less, left)
            return np.asarray(table * sign ** np.arange(count))

        return self._by_halves(points, of, (count,))

    def transform_of(self, c: Number, points: Points) -> Number:
        """Transform, off the interval, of w sum_n c_n p_n (weight w, Jacobi polynomials p_n)."""

        def of(half: JacobiFunctions, sign: float, less: Number, left: Number) -> Number:
            return transform_sum(half.singular, c * sign ** np.arange(len(c)), less, left)

        return self._by_halves(points, of)

    def slope_of(self, c: Number, points: Points) -> Number:
        """Derivative by zeta of the transform of w sum_n c_n p_n at points zeta off the interval.
        w is the weight, p_n are Jacobi polynomials.
        """
        return self.split_slope(self.split(c), points)

    def split_transform(self, split: Split, points: Points) -> Number:
        """Transform, off the interval, of a density given as a `Split` (a record of coefficients).
        At ends where the density is bounded, the transform is finite.
        """

        def of(half: JacobiFunctions, sign: float, less: Number, left: Number) -> Number:
            at_left, at_right = split[:2] if sign > 0 else split[1::-1]
            q = split.q * sign ** np.arange(len(split.q))
            out, ratio = transform_sum(half.bounded, q, less, left), log_ratio(less, left)
            if at_left:
                out = out - 0.5 * at_left * np.expm1(half.alpha * ratio)
            if at_right:
                out = out + 0.5 * at_right * np.expm1(-half.rest * ratio)
            return np.asarray(out)

        return self._by_halves(points, of)

    def split_slope(self, split: Split, points: Points) -> Number:
        """Derivative by zeta of the transform of a density that is given as a `Split`.

        The derivative of (1 - t^2) w q_n by t is -(n + 1) w p_(n+1), with the weight w and the
        Jacobi polynomials p_n and q_n.
        """

        def of(half: JacobiFunctions, sign: float, less: Number, left: Number) -> Number:
            at_left, at_right = split[:2] if sign > 0 else split[1::-1]
            ratio = log_ratio(less, left)
            out = np.zeros_like(ratio)
            if at_left:
                out = out + half.alpha * at_left * np.exp(half.alpha * ratio)
            if at_right:
                out = out + half.rest * at_right * np.exp(-half.rest * ratio)
            # In the left half plane, `_by_halves` negates the values at the mirror images of
            # points, but a derivative keeps its sign there. The factor `sign` undoes this negation.
            return np.asarray(-sign * out / left / less)

        count = len(split.q)
        c = np.concatenate((np.zeros(1), -split.q * np.arange(1, count + 1)))
        return self._by_halves(points, of) + self.transform_of(c, points)

    # The methods below give the potential (1/pi) int phi(t) log|zeta - t| dt of a density phi. Its
    # derivative by zeta is the transform.
    @cached_property
    def level(self) -> Any:
        """Potential of the weight w plus kappa times the integral of w from -1 to t.
        On the interval, this sum does not depend on t.
        """
        digamma = complex_or_real(special.digamma(self.rest))
        return math.log(2.0) + digamma + float(np.euler_gamma)

    def own_potential(self, c: Number, left: Any, right: Any) -> Number:
        """Potential of w sum_n c_n p_n on the interval (weight w, Jacobi polynomials p_n).

        It is `own_level` minus kappa times the integral of the density from -1 to t.
        """
        level = self.own_level(c, left, right)
        return np.asarray(level - self.kappa * self.integral_to(c, left, right))

    def own_level(self, c: Array, left: Any, right: Any) -> Array:
        """On the interval, a density's potential plus kappa times its integral from -1 to t.
        The density is w sum_n c_n p_n, with the weight w and Jacobi polynomials p_n.

        For the density w p_0 it is `level`. For w p_n with n > 0 it is -1/n times the polynomial
        p_n of the mirrored family.
        """
        divided = c / np.maximum(np.arange(len(c)), 1)
        divided[0] = 0.0
        return np.asarray(c[0] * self.level - self.singular.mirrored.sums(divided, left, right))

    def potentials(self, count: int, points: Points) -> Number:
        """Potentials of the densities w p_n at points off the interval, n = 0 ... count - 1.
        w is the weight, p_n are Jacobi polynomials. The index n is along a new last axis.

        At complex points they are analytic functions whose real part is the potential.
        """

        def of(half: JacobiFunctions, sign: float, less: Number, left: Number) -> Number:
            table = transform_table(half.bounded, count - 1, less, left)
            return np.asarray(table * sign ** np.arange(count - 1) / np.arange(1, count))

        first = self._first_potential(points)[..., None]
        if count == 1:
            return first
        return np.concatenate((first, -self._by_halves(points, of, (count - 1,))), axis=-1)

    def potential_of(self, c: Number, points: Points) -> Number:
        """Potential of w sum_n c_n p_n off the interval (weight w, Jacobi polynomials p_n)."""
        q = -c[1:] / np.arange(1, len(c))
        higher = self.split_transform(Split(0.0, 0.0, q), points)
        return np.asarray(c[0] * self._first_potential(points) + higher)

    def _first_potential(self, points: Points) -> Number:
        """Potential of the weight w off the interval.
        Integration by parts gives it from the transform of the integral of w.
        """
        left, less = from_ends(points)
        distance = np.log(left if np.iscomplexobj(left) else np.abs(left))
        return np.asarray(distance - np.pi * value_transform(self.alpha, self.rest, left, less))

    def _by_halves(
        self,
        points: Points,
        of: Callable[["JacobiFunctions", float, Number, Number], Number],
        shape: tuple[int, ...] = (),
    ) -> Number:
        """Transform at points of the whole plane, by a function `of` for the right half plane.

        At zeta in the right half plane, the result is of(densities, 1, zeta - 1, zeta + 1). At zeta
        in the left half plane, `of` is called at -zeta, with the mirrored densities and the sign
        -1, and its result is negated. On the real line, logarithms and roots take the side of the
        line from the sign of a zero imaginary part. The sign in -zeta is the right one.
        """
        left, less = from_ends(points)
        mirror = (left + less).real < 0
        parts = [(~mirror, of(self, 1.0, less[~mirror], left[~mirror]))] if not mirror.all() else []
        if mirror.any():
            parts.append((mirror, -of(self.mirrored, -1.0, -left[mirror], -less[mirror])))
        numbers = np.result_type(less, *(values for _, values in parts))
        out = np.empty((*less.shape, *shape), dtype=numbers)
        for here, values in parts:
            out[here] = values
        return out

    # The methods below give matrices that convert coefficients from one basis to another.
    def from_u(self, count: int) -> Array:
        """Matrix C from coefficients of the right side in U_j to its coefficients in D_i.
        U_j = sum_i C[i, j] D_i, with Chebyshev polynomials U_j of the second kind and the
        polynomials D_i of `images`. C is upper triangular, of the shape (count, count).
        """
        return _from_u(self.kappa, count)

    def moments(self, count: int, length: int) -> Array:
        """Chebyshev moments (length, count) that give the field of each w p_n off the interval.
        w is the weight, p_n a Jacobi polynomial, and n < `count`.

        With S_n = w p_n, m[l, n] = (2 - delta_l0) / pi int S_n T_l dt. Off the interval sum_n c_n
        S_n has the field of sum_l (m c)_l T_l / sqrt(1 - t^2). Moments with l < n are zero.
        """
        return _moments(self.kappa, count, length)

    def first_moments(self, length: int) -> Array:
        """Chebyshev moments (2 - delta_l0) / pi int w T_l dt of the weight w, l < `length`.
        They are the first column of `moments`.

        They are the coefficients of rho^l in the power series of ((1 + rho) / (1 - rho))^(1 - 2
        alpha). This function is sqrt(zeta^2 - 1) times the transform of w, with rho = zeta -
        sqrt(zeta^2 - 1).
        """
        twice = 2 * self.recurrence(1)[0][0]
        out = np.ones(max(length, 2))
        out[1] = twice
        for l in range(1, length - 1):
            out[l + 1] = (twice * out[l] + (l - 1) * out[l - 1]) / (l + 1)
        return out[:length]


def from_ends(points: Points) -> tuple[Number, Number]:
    """(zeta + 1, zeta - 1) of points off the interval, without cancellation."""
    if isinstance(points, InPlane):
        return np.asarray(points.left, complex), np.asarray(points.less, complex)
    if isinstance(points, OnLine):
        return np.asarray(points.left, float), -np.asarray(points.right, float)
    sign, excess = np.broadcast_arrays(points.sign, np.asarray(points.excess, float))
    return np.where(sign > 0, 2 + excess, -excess), np.where(sign > 0, excess, -2 - excess)


def _times_t(a: Number, b: Number, v: Number) -> Number:
    """Coefficients of t f(t) from the coefficients v of f, in orthogonal polynomials.
    a, b: coefficients of the three-term recurrence of the polynomials.
    """
    out = a * v
    out[1:] += b[1:] * v[:-1]
    out[:-1] += b[1:] * v[1:]
    return np.asarray(out)


@lru_cache(maxsize=64, typed=True)
def _from_u(kappa: float, count: int) -> Array:
    weighted = JacobiFunctions(kappa)
    a, b = weighted.images.recurrence(count)
    rows = np.zeros((count, count))
    rows[0, 0] = 2 * math.sqrt(weighted.alpha * weighted.rest)
    for j in range(1, count):
        rows[j] = 2 * _times_t(a, b, rows[j - 1])
        if j > 1:
            rows[j] -= rows[j - 2]
    rows.flags.writeable = False
    return rows.T


@lru_cache(maxsize=64, typed=True)
def _moments(kappa: complex, count: int, length: int) -> Array:
    size = max(count, length)
    a, b = JacobiFunctions(kappa).recurrence(size)
    # In the basis p_0 / sqrt(2), p_1, p_2, ... the matrix of the multiplication by t is symmetric.
    b = b.copy()
    b[1:2] *= math.sqrt(2.0)
    out = np.zeros((length, count), dtype=a.dtype)
    here, before = np.zeros((2, size), dtype=a.dtype)
    here[0] = 1.0
    for l in range(length):
        out[l] = here[:count]
        here, before = (2.0 if l else 1.0) * _times_t(a, b, here) - before, here
    out[1:] *= 2.0
    out[:, 1:] *= math.sqrt(0.5)
    out.flags.writeable = False
    return out
