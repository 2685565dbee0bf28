r"""Densities whose right side in kappa phi + T phi = g jumps inside the interval, in closed form.

With the weight w and exponent alpha of `sie.basis.weighted`, and a place s in (-1, 1), let

    J_s(t) = total / pi  int_t^1 w(x) / (x - s) dx,       t > s,
    J_s(t) = total / pi  int_(-1)^t w(x) / (s - x) dx,    t < s,
    total = sin(pi alpha) (1 - s)^(1 - alpha) (1 + s)^alpha = int J_s dt.

J_s vanishes at both ends and has a logarithm and a step at s:

    (kappa + T) J_s = H(t - s) - h,    h = I_((1 - s)/2)(1 - alpha, alpha),

with Heaviside's step H and the regularised incomplete beta function I. With `lerch` and

    u = (1 + t)(1 - s) / ((1 - t)(1 + s))

J_s is on the two sides of s

    J_s = sin(pi alpha)^2 / pi  u^(1 - alpha) lerch(1 - alpha, u),    t < s,
    J_s = sin(pi alpha)^2 / pi  u^(-alpha) lerch(alpha, 1 / u),       t > s,

and the transform F(zeta) of J_s off the interval is the integral of sin(pi alpha) / pi  y^(-alpha)
/ (1 + y) from (1 - s) / (1 + s) to -u(zeta). The derivative of F by zeta is -total / pi F_0(zeta) /
(zeta - s), with the transform F_0 of w. For kappa = 0 J_s is a logarithm. Jumps of the k-th
derivative of the right side have the densities (t - s)^k J_s:

    (kappa + T) (t - s)^k J_s = (t - s)^k (H(t - s) - h) - sum_(j < k) P_j (t - s)^(k - 1 - j) / pi,

where P_j is the integral of (t - s)^j J_s, which is total / (pi (j + 1)) times that of (t - s)^j w.
Since (t - s) J_s' = -total / pi w, integration by parts gives the potential V_k of (t - s)^k J_s:

    (k + 1) V_k = F[(t - s)^(k + 1) J_s] + total / pi V[(t - s)^k w],

where F[] is the transform and V[] the potential of a density. The integrals of the densities from
-1 to t follow in the same way.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import DIGITS, Array, Kept
from sie.basis.interval import InPlane, OnLine
from sie.basis.jacobi import log_ratio
from sie.basis.lerch import beta_share, lerch
from sie.basis.weighted import JacobiFunctions, Points, from_ends

Number = NDArray[Any]


@dataclass(frozen=True)
class JumpOptions:
    """Limit of |rho| below which the transform of a jump's density is a sum over moments.
    Closer to the interval, where |rho| is larger, the transform is a closed form.
    """

    # Limit of |rho|, with rho = zeta - sqrt(zeta^2 - 1) at the point zeta. Above the limit, the
    # closed form loses less than a digit. Insensitive: 0.2 to 0.5.
    far: float = 0.35


OPTIONS = JumpOptions()
# Number of Chebyshev moments that a transform needs at points where |rho| is at most `far`.
FAR_TERMS = int(np.ceil(-DIGITS / np.log(OPTIONS.far)))


@dataclass(frozen=True, eq=False)
class PowerJump(Kept):
    """Densities whose right side has a jump (k = 0), a kink (k = 1), ... at positions s.
    The density is (t - s)^k J_s. J_s is the closed-form solution of kappa phi + T phi = g for a
    unit step g at s, up to a constant in g.

    The module's docstring has the formulas. All methods broadcast arrays of points against the
    array of positions s. The argument `order` is k. The densities vanish at both ends.

    Parameters
    ----------
    weighted : JacobiFunctions
        The Jacobi functions on the interval, for the coefficient kappa of the equation.
    left, right : ndarray
        1 + s and 1 - s of the places.

    Examples
    --------
    >>> import numpy as np
    >>> from sie.basis.power_jump import PowerJump
    >>> from sie.basis.weighted import JacobiFunctions
    >>> jump = PowerJump(JacobiFunctions(0.0), np.array([1.0]), np.array([1.0]))  # a jump at t = 0
    >>> jump.own(np.array([-0.5, 0.5])).round(12).tolist()
    [-0.5, 0.5]
    >>> value = jump.density(np.array([1.6]), np.array([0.4]), np.array([0.6]))
    >>> (value - np.arccosh(1 / 0.6) / np.pi).round(14).tolist()
    [0.0]
    """

    weighted: JacobiFunctions
    left: Array
    right: Array

    @cached_property
    def total(self) -> Array:
        """Integral of a jump's density J_s: sin(pi alpha) (1 - s)^(1 - alpha) (1 + s)^alpha."""
        return self.weighted.mirrored.bounded_weight(self.left, self.right)

    @cached_property
    def levels(self) -> tuple[Array, Array]:
        """Values of (kappa + T) J_s to the left and to the right of s; both are constants.
        J_s is the density of a unit jump of the right side at s, T the transform. The values are -h
        and 1 - h, each with all digits.

        The module's docstring defines h.
        """
        w, left, right = self.weighted, 0.5 * self.left, 0.5 * self.right
        return -beta_share(w.rest, w.alpha, right, left), beta_share(w.alpha, w.rest, left, right)

    def own(self, away: Any, order: int = 0) -> Array:
        """Right side (kappa + T) phi of the density phi = (t - s)^k J_s of a jump at s.
        The points are on the interval; k is `order`, T the transform, and `away` is t - s.
        """
        away, (before, beyond) = np.asarray(away, dtype=float), self.levels
        return _multiplied(np.where(away > 0, beyond, before), away, self.powers(order))

    def density(self, left: Any, right: Any, away: Any, order: int = 0) -> Array:
        """Density (t - s)^k J_s of a jump at s, at points t on the interval; k is `order`.
        left, right, away: 1 + t, 1 - t and t - s.
        """
        w = self.weighted
        left, right, away, at_left, at_right = np.broadcast_arrays(
            *(np.asarray(x, dtype=float) for x in (left, right, away, self.left, self.right))
        )
        out = np.empty(left.shape)
        for here, a, near, far in (
            (away <= 0, w.rest, left * at_right, right * at_left),
            (away > 0, w.alpha, right * at_left, left * at_right),
        ):
            ratio, rest = near[here] / far[here], 2 * np.abs(away[here]) / far[here]
            out[here] = ratio**a * lerch(a, ratio, rest)
        out *= w.sine**2 / np.pi
        return np.asarray(np.where(away == 0, 0.0, out) * away**order if order else out)

    def integral_to(self, left: Any, right: Any, away: Any, order: int = 0) -> Array:
        """Integral from -1 to t of (t - s)^k J_s, the density of a jump at s; k is `order`.

        It is integrated by parts, since (t - s) J_s' is -total / pi times the weight w.
        """
        away, rest = np.asarray(away, dtype=float), np.asarray(0.0)
        for c, factor in zip(
            _monomials(self.weighted, order + 1), self._binomial(order), strict=True
        ):
            rest = rest + factor * self.weighted.integral_to(c, left, right)
        edge = self.density(left, right, away, order) * away
        return np.asarray(
            (np.where(away == 0, 0.0, edge) + self.total / np.pi * rest) / (1 + order)
        )

    def by_parts(self, order: int = 0) -> Array:
        """Coefficients of (total / pi) (t - s)^order w as a sum of the densities w p_n.
        They are along a new first axis. w is the weight, p_n are Jacobi polynomials, and `total` is
        the integral of the density of a jump at s.

        The sum arises if fields of the jump's density are integrated by parts.
        """
        out: Array = np.asarray(0.0)
        for c, factor in zip(
            _monomials(self.weighted, order + 1), self._binomial(order), strict=True
        ):
            out = out + np.multiply.outer(c, self.total / np.pi * factor)
        return out

    def powers(self, count: int) -> list[Array]:
        """Integrals over (-1, 1) of (t - s)^j J_s, j = 0 ... count - 1.
        J_s is the density of a jump of the right side at s.
        """
        return [self.total * moment / (j + 1) for j, moment in enumerate(self._weights(count))]

    def _weights(self, count: int) -> list[Array]:
        """Integrals of (t - s)^j w(t) over (-1, 1), divided by pi, for j < `count`.
        w is the weight, s the position of a jump.
        """
        by_t = _monomials(self.weighted, count)[:, 0]
        return [
            np.asarray(sum(m * f for m, f in zip(by_t[: j + 1], self._binomial(j), strict=True)))
            for j in range(count)
        ]

    def _binomial(self, order: int) -> list[Array]:
        """Coefficients of t^j, j = 0 ... k, in (t - s)^k, with k = `order`."""
        place = 0.5 * (self.left - self.right)
        return [math.comb(order, j) * (-place) ** (order - j) for j in range(order + 1)]

    def edge_slopes(self, order: int = 0) -> tuple[Array, Array]:
        """Edge slopes A of the densities at the left and the right end, for the half width 1.
        At a small distance d from an end, the density (t - s)^k J_s of a jump at s is A d^gamma.
        The exponent gamma is 1 - alpha at the left end and alpha at the right end; k is `order`.
        """
        w = self.weighted
        scale = w.sine**2 / np.pi
        at_left = scale / w.rest * (0.5 * self.right / self.left) ** w.rest
        at_right = scale / w.alpha * (0.5 * self.left / self.right) ** w.alpha
        return (-self.left) ** order * at_left, self.right**order * at_right

    def moments(self, length: int, order: int = 0) -> Array:
        """Chebyshev moments (2 - delta_l0) / pi int phi T_l dt, l < `length`, of the densities phi.
        phi = (t - s)^k J_s is the density of a jump (k = 0) or a kink (k = 1) at s; k is `order`.

        They are along a new last axis, and are defined as in `JacobiFunctions.moments`.
        """
        size = length + order
        means = np.empty((*self.left.shape, size))
        for here, sign, half in self._halves(self.right <= self.left):
            means[here] = half._means(size) * sign ** np.arange(size)
        for _ in range(order):
            by_t = means[..., 1:].copy()
            by_t[..., 1:] = 0.5 * (means[..., 2:] + means[..., :-2])
            means = by_t - 0.5 * (self.left - self.right)[..., None] * means[..., :-1]
        means[..., 1:] *= 2
        return np.asarray(means / np.pi)

    def _means(self, length: int) -> Array:
        """Integrals of J_s T_l over (-1, 1), l < `length`, as an array (number of jumps, length).
        J_s is the density of a jump at s, T_l a Chebyshev polynomial. All positions s are in the
        right half of the interval.

        The integrals n_l of -J_s' T_l obey (n_(l+1) + n_(l-1)) / 2 - s n_l = total / pi int w T_l.
        The recurrence is rewritten for differences of the n_l. It then needs 1 - s instead of s, so
        that no digits are lost near s = 1.
        """
        count = length + 2
        weights = self.weighted.first_moments(count)
        slopes = np.zeros((count, len(self.left)))
        step = np.zeros(len(self.left))
        for l in range(count - 1):
            step = step + self.total * weights[l] - 2 * self.right * slopes[l]
            slopes[l + 1] = slopes[l] + step
        out = np.empty((length, len(self.left)))
        order = np.arange(1.0, count)[:, None]
        divided = slopes[1:] / order
        out[0] = slopes[1]
        out[1:] = 0.5 * divided[1:length]
        out[2:] -= 0.5 * divided[: length - 2]
        return out.T

    def transform(self, points: Points, away: Number | None = None, order: int = 0) -> Number:
        """Transform of the density (t - s)^k J_s at points zeta off the interval; k is `order`.
        (t - s)^k J_s is the density of a jump, at s, of the right side (k = 0) or of its k-th
        derivative.

        away: zeta - s. It is needed if a point is closer to s than to both ends.
        """
        return self._near_and_far(points, away, (order, 0))

    def slope(self, points: Points, away: Number | None = None, order: int = 0) -> Number:
        """Derivative of `transform` by zeta, the coordinate of the points.
        `transform` is that of the density (t - s)^order J_s of a jump at s.
        """
        return self._near_and_far(points, away, (order, 1))

    def _near_and_far(self, points: Points, away: Number | None, what: tuple[int, int]) -> Number:
        """Transform of the jumps' densities, or its derivative by the points' coordinate zeta.
        Near the interval, closed forms are used. Far from the interval their terms cancel, and a
        sum over Chebyshev moments is used instead.

        what: (order, 1 for the slope and 0 for the transform).
        """
        left, less = from_ends(points)
        if away is None:
            away = np.where((left + less).real > 0, less + self.right, left - self.left)
        which = np.arange(self.left.size).reshape(self.left.shape)
        left, less, away, which = np.broadcast_arrays(left, less, away, which)
        far = np.abs(rho_of(left, less)) < OPTIONS.far
        out, near = np.empty(left.shape, dtype=less.dtype), ~far
        if far.any():
            out[far] = self._by_moments(which[far], left[far], less[far], what)
        if near.any():
            of = self._near_slope if what[1] else self._near
            out[near] = of(which[near], (left[near], less[near], away[near]), what[0])
        return out

    def _by_moments(
        self, which: NDArray[np.intp], left: Number, less: Number, what: tuple[int, int]
    ) -> Number:
        """Transform of the jumps' densities at points far from the interval, or its derivative.
        The transform is sum m_l rho^l / sqrt(zeta^2 - 1), with the Chebyshev moments m_l of the
        densities and rho = zeta - sqrt(zeta^2 - 1).
        """
        table = self.moments(FAR_TERMS, what[0]).reshape(-1, FAR_TERMS)[which].T
        return series_slope(table, left, less) if what[1] else series(table, left, less)

    def _near(
        self, which: NDArray[np.intp], point: tuple[Number, Number, Number], order: int
    ) -> Number:
        """Transform of (t - s)^order J_s at pairs of a point zeta and a jump at s, in closed form.

        point: zeta + 1, zeta - 1 and zeta - s of each pair. which: the index of its place s.
        """
        out = np.empty_like(point[1])
        at_left, at_right = np.ravel(self.left), np.ravel(self.right)
        before, beyond = (np.ravel(level) for level in self.levels)
        # The transform is a constant plus or minus `_jump_transform`. The constant is the value of
        # (kappa + T) J_s to the left of s (`before`) or to the right of s (`beyond`). Of these two
        # constants the smaller one is used, so that a small transform loses no digits.
        kept = (-before <= beyond)[which]
        at, pair = which[kept], tuple(x[kept] for x in point)
        out[kept] = before[at] + _jump_transform(self.weighted, at_left[at], at_right[at], pair)
        at, pair = which[~kept], tuple(-np.conj(point[i][~kept]) for i in (1, 0, 2))
        mirrored = _jump_transform(self.weighted.mirrored, at_right[at], at_left[at], pair)
        out[~kept] = beyond[at] - np.conj(mirrored)
        powers = [np.ravel(power)[which] for power in self.powers(order)]
        return _multiplied(out, point[2], powers)

    def _near_slope(
        self, which: NDArray[np.intp], point: tuple[Number, Number, Number], order: int
    ) -> Number:
        """Derivative of the transform by zeta at pairs of a point zeta and a jump, in closed form.
        The arguments are those of `_near`.
        """
        left, less, away = point
        points = InPlane(left, less) if np.iscomplexobj(less) else OnLine.of(left, -less)
        weight, scale = self.weighted.transform_of(np.ones(1), points), np.ravel(self.total) / np.pi
        if order == 0:
            return np.asarray(-scale[which] * weight / away)
        # With k = `order`, the derivative by t of the density (t - s)^k J_s is k (t - s)^(k - 1)
        # J_s - (total / pi) (t - s)^(k - 1) w. J_s is the density of a jump at s, `total` the
        # integral of J_s, and w the weight.
        weights = [np.pi * np.ravel(moment)[which] for moment in self._weights(order - 1)]
        by_weight = _multiplied(weight, away, weights)
        return np.asarray(order * self._near(which, point, order - 1) - scale[which] * by_weight)

    def _halves(
        self, kept: NDArray[np.bool_]
    ) -> Iterator[tuple[NDArray[np.bool_], float, "PowerJump"]]:
        """Yield the jumps where `kept` is true, and the mirror images of the other jumps.
        Each item is (mask of the jumps, 1 or -1 for mirror images, densities of the jumps).
        """
        if kept.any():
            yield kept, 1.0, PowerJump(self.weighted, self.left[kept], self.right[kept])
        if not kept.all():
            yield (
                ~kept,
                -1.0,
                PowerJump(self.weighted.mirrored, self.right[~kept], self.left[~kept]),
            )


def _jump_transform(
    w: JacobiFunctions, at_left: Array, at_right: Array, point: tuple[Number, ...]
) -> Number:
    """The transform of J_s plus a constant, at pairs of a point zeta and a jump position s.
    J_s is the density of a jump of the right side at s. The value is sin(pi alpha) / pi times the
    integral of y^(-alpha) / (1 + y) from 0 to (zeta + 1) (1 - s) / ((zeta - 1) (1 + s)).

    at_left, at_right: 1 + s and 1 - s; point: zeta + 1, zeta - 1 and zeta - s. On the line off the
    interval, the result is between 0 and 1.
    """
    left, less, away = point
    ratio = at_right / at_left
    logarithm, from_minus_one = log_ratio(less, left), 2 * away / (less * at_left)
    y, out = left / less * ratio, np.empty_like(less)
    # A point is `inside` if |y| <= 1. If y is near -1, the test uses `from_minus_one`, which is
    # y + 1 without cancellation.
    size = np.minimum(np.abs(from_minus_one), 1.0)
    inside = np.where(size < 0.5, from_minus_one.real >= 0.5 * size**2, np.abs(y) <= 1)
    for here, a, sign in ((inside, w.rest, 1.0), (~inside, w.alpha, -1.0)):
        rest = from_minus_one[here] if sign > 0 else from_minus_one[here] / y[here]
        power = np.exp(-sign * a * logarithm[here]) * ratio[here] ** (sign * a)
        part = w.sine / np.pi * power * lerch(a, -(y[here] ** sign), rest)
        out[here] = part if sign > 0 else 1 - part
    return out


def _multiplied(transform: Number, away: Number, powers: list[Array]) -> Number:
    """Transform of (t - s)^k f from the transform of f, with k the length of `powers`.
    away: zeta - s. powers: the integrals of (t - s)^j f, j < k.
    """
    for power in powers:
        transform = transform * away - power / np.pi
    return transform


def _monomials(weighted: JacobiFunctions, count: int) -> Array:
    """Matrix whose row j has the coefficients of t^j in the Jacobi polynomials p_n, j < `count`."""
    a, b = weighted.recurrence(count + 1)
    out = np.zeros((count, count + 1))
    out[:1, 0] = 1.0
    for j in range(count - 1):
        c, by_t = out[j], out[j + 1]
        by_t += a * c
        by_t[1:] += b[1:] * c[:-1]
        by_t[1:2] += b[1:2] * c[:1]
        by_t[:-1] += b[1:] * c[1:]
    return out


def rho_of(left: Number, less: Number) -> Number:
    """The number rho = zeta - sqrt(zeta^2 - 1), from left = zeta + 1 and less = zeta - 1.
    Off the interval [-1, 1], |rho| is below 1.
    """
    if np.iscomplexobj(less):
        return np.asarray(2 / (np.sqrt(left) + np.sqrt(less)) ** 2)
    size = 2 / (np.sqrt(np.abs(left)) + np.sqrt(np.abs(less))) ** 2
    return np.asarray(np.copysign(size, left))


def series(moments: Array, left: Number, less: Number) -> Number:
    """Transform of sum m_l T_l(t) / sqrt(1 - t^2) at points zeta off the interval (-1, 1).
    It is sum m_l rho^l / sqrt(zeta^2 - 1) with rho = zeta - sqrt(zeta^2 - 1).

    moments: the m_l along the first axis; further axes, if any, are those of the points. left,
    less: zeta + 1 and zeta - 1.
    """
    rho = rho_of(left, less)
    value = np.zeros_like(rho)
    for moment in moments[::-1]:
        value = value * rho + moment
    return np.asarray(value / (0.5 * (left + less) - rho))


def series_slope(moments: Array, left: Number, less: Number) -> Number:
    """Derivative by zeta of `series`, the transform of sum m_l T_l / sqrt(1 - t^2).
    moments: the coefficients m_l. left, less: zeta + 1 and zeta - 1.
    """
    rho = rho_of(left, less)
    root = 0.5 * (left + less) - rho
    value, slope = np.zeros_like(rho), np.zeros_like(rho)
    for l in range(len(moments) - 1, -1, -1):
        value = value * rho + moments[l]
        slope = slope * rho + l * moments[l]
    return np.asarray(-(slope + 0.5 * (left + less) / root * value) / root**2)


def series_potential(moments: Array, left: Array, less: Array) -> Array:
    """Potential of sum m_l T_l / sqrt(1 - t^2) at real points zeta off the interval.
    moments: the coefficients m_l. left, less: zeta + 1 and zeta - 1.
    """
    rho = rho_of(left, less)
    value = np.zeros_like(rho)
    for l in range(len(moments) - 1, 0, -1):
        value = value * rho + moments[l] / l
    return np.asarray(-moments[0] * np.log(2 * np.abs(rho)) - value * rho)
