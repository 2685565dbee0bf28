r"""Chebyshev densities on one interval, with transforms and potentials in closed form.

On an interval of half width w let t = (x - middle)/w = cos(theta) and X = (1 - t^2)^(1/2). A
density is a sum of T_l / X. It equals (alpha + beta t) / X + X sum u_k U_k. The second form loses
no digits close to an end where the density vanishes. Off the interval, t is called zeta, and

    R = (zeta^2 - 1)^(1/2), about zeta far away,    rho = zeta - R, |rho| < 1,
    -log(rho) = arcosh(zeta).

               on the interval               off it, on the line or at complex points
    transform  T_l / X -> -U_{l-1}           T_l / X -> rho^l / R,    X U_l -> rho^(l+1)
    potential  T_l / X -> -w T_l / l,        T_l / X -> -w rho^l / l,
               T_0 / X -> w log(w / 2)       T_0 / X -> w log(w / (2 |rho|))
    at an end  T_l / X:  K = (w/2)^(1/2) (+-1)^l,  the factor of distance^(-1/2)
               X U_l:    A = (2/w)^(1/2) (l + 1) (+-1)^l,  the factor of distance^(1/2)

These formulas are for the exponent 1/2 (see `sie.basis.weight`). A place on the line is given by
its distances from both ends divided by w, or by |zeta| - 1. A complex point is given by zeta + 1
and zeta - 1. With t or zeta alone, digits would be lost close to an end.
"""

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import EPS, TINY, Array, Complex, Index, Mask, record
from sie.basis.sums import cosine_sum, sine_sum, sum_and_slope, sum_of_powers
from sie.basis.weight import HALF

Number = NDArray[Any]
What = Literal["transform", "derivative", "potential"]


# The functions below convert coordinates on an interval: t = cos(theta), `left` = 1 + t, `right` =
# 1 - t and the angle theta.
def theta(left: Any, right: Any) -> Array:
    """The angle theta of a place t = cos(theta) on an interval; it is 0 at the right end.

    left, right: distances from both ends, divided by the half width. theta(right, left) is the
    angle from the left end.
    """
    return np.asarray(2 * np.arctan2(np.sqrt(right), np.sqrt(left)))


def sides(angle: Array) -> tuple[Array, Array]:
    """(1 + t, 1 - t) of t = cos(angle): distances from both ends, divided by the half width."""
    return 2 * np.cos(0.5 * angle) ** 2, 2 * np.sin(0.5 * angle) ** 2


def root_weight(left: Any, right: Any) -> Array:
    """sqrt(1 - t^2) at a place t, from its distances to both ends divided by the half width."""
    return np.asarray(np.sqrt(left * right))


def half_angles(left: Any, right: Any) -> tuple[Array, Array]:
    """(cos(theta/2), sin(theta/2)) at t = cos(theta), from `left` = 1 + t and `right` = 1 - t."""
    return np.asarray(np.sqrt(0.5 * left)), np.asarray(np.sqrt(0.5 * right))


def by_angle(of: Callable[[Array, Array], Array], angle: Array) -> tuple[Array, Array]:
    """(value, derivative by the angle) of a function of (1 + t, 1 - t), where t = cos(angle).

    The step balances truncation and round-off.
    """
    step = np.minimum(np.cbrt(EPS), 0.5 * np.minimum(angle, np.pi - angle))
    before, after = (of(*sides(at)) for at in (angle - step, angle + step))
    return 0.5 * (before + after), (after - before) / (2 * step)


def end_changes(slope: Array, at_left: Array, at_right: Array, angle: Array) -> tuple[Array, Array]:
    """Changes of a density at fixed t per motion of the left end, and per motion of the right end.
    Motions are measured in widths of the zone, and are positive to the left.

    slope: derivative of the density by the angle; at_left, at_right: the slopes of the density at
    the ends, by the angle from each end. See `Series.sensitivity` for the formula.
    """
    tangent = np.tan(0.5 * angle)
    return (slope + at_left) * tangent, (slope - at_right) / tangent


def nearer_angle(left: Array, right: Array) -> Array:
    """Angle of a place on an interval, measured from the nearer end: 0 ... pi / 2."""
    return theta(np.maximum(left, right), np.minimum(left, right))


def decay_rate(excess: Any) -> Array:
    """The rate -log|rho| at which the powers of rho = zeta - sqrt(zeta^2 - 1) decay.

    excess: |zeta| - 1.
    """
    return np.asarray(2 * np.arcsinh(np.sqrt(0.5 * excess)))


def excess_of(rate: float) -> float:
    """The excess |zeta| - 1 for which `decay_rate` gives the given rate."""
    return 2 * float(np.sinh(0.5 * rate)) ** 2


class Seen:
    """Base class of points x in the coordinate zeta = (x - middle) / half width of an interval.
    root = sqrt(zeta^2 - 1) and rho = zeta - root are functions of this coordinate.
    """

    rho: Array
    root: Array
    excess: Array
    """|zeta| - 1."""

    @property
    def from_ends(self) -> tuple[Array, Array]:
        """(1 + rho, 1 - rho) with rho = zeta - sqrt(zeta^2 - 1), without cancellation."""
        past, size = self.rho > 0, np.abs(self.rho)
        small, large = (self.excess + np.abs(self.root)) * size, 1 + size
        return np.where(past, large, small), np.where(past, small, large)

    def first(self, width: Number) -> Array:
        """Potential of 1 / sqrt(1 - t^2), divided by the half width w: log(width / (2 |rho|)).

        width: w divided by the kernel's `datum`; rho: see the class.
        """
        return np.asarray(np.log(width / (2 * np.abs(self.rho))))

    def transforms(self, count: int) -> Array:
        """Transforms of T_l / sqrt(1 - t^2), l = 0 ... count - 1, along a new last axis."""
        table = np.empty((*np.shape(self.rho), count))
        table[..., 0] = 1 / self.root
        table[..., 1:] = self.rho[..., None]
        return np.cumprod(table, axis=-1, out=table)

    def potentials(self, count: int, width: Number) -> Array:
        """Potentials of T_l / sqrt(1 - t^2), divided by the half width w, along a new last axis.

        l = 0 ... count - 1; width: w divided by the kernel's `datum`.
        """
        power = np.arange(count)
        values = -(self.rho[..., None] ** power) / np.maximum(power, 1)
        values[..., 0] = self.first(width)
        return np.asarray(values)

    def one_by_one(
        self, potential: bool, width: Number, weight: Array | None = None
    ) -> Iterator[Array]:
        """Yield `weight` times the transform (or potential) of T_l / sqrt(1 - t^2), l = 0, 1, ...

        The potentials are divided by the half width w; width: w divided by the kernel's `datum`.
        """
        weight = np.ones_like(self.rho) if weight is None else weight
        power: Array = np.asarray(weight if potential else weight / self.root, dtype=float)
        yield power * self.first(width) if potential else power
        l = 0
        while True:
            power, l = power * self.rho, l + 1
            yield -power / l if potential else power


@record
class Outside(Seen):
    """Points x outside intervals, given by the sign of zeta and by |zeta| - 1 (see `Seen`)."""

    sign: Any
    excess: Array

    @property
    def zeta(self) -> Array:
        """The coordinate zeta = (x - middle) / w of the points x, with the half width w."""
        return np.asarray(self.sign * (1 + self.excess))

    @cached_property
    def _size(self) -> Array:
        """The absolute value of `root` = sqrt(zeta^2 - 1)."""
        return np.sqrt(self.excess * (self.excess + 2))

    @cached_property
    def root(self) -> Array:  # type: ignore[override]
        """The root sqrt(zeta^2 - 1) of the coordinate zeta, with the sign of zeta."""
        return np.asarray(self.sign * self._size)

    @cached_property
    def rho(self) -> Array:  # type: ignore[override]
        """rho = zeta - sqrt(zeta^2 - 1), between -1 and 1, for the coordinate zeta."""
        return np.asarray(self.sign / (1 + self.excess + self._size))

    @cached_property
    def log(self) -> Array:
        """The rate -log|rho| at which the powers of rho decay (see `decay_rate`)."""
        return decay_rate(self.excess)


@record
class OnLine(Seen):
    """Points of the real line, on or off an interval, in coordinates relative to the interval.

    For zeta and rho see `Seen`. left, right: zeta + 1 and 1 - zeta, which are the distances from
    the ends divided by the half width, positive inside. root: sqrt(|zeta^2 - 1|), with the sign of
    zeta off the interval. on: whether a point is on the interval; there rho has no meaning and is
    set to 0.5. any_on: whether any point is on its interval.
    """

    left: Array
    right: Array
    root: Array
    rho: Array
    on: Mask
    any_on: bool

    @classmethod
    def of(cls, left: Array, right: Array) -> "OnLine":
        """Points from their distances `left` and `right` to the ends, divided by the half width."""
        on = (left >= 0) & (right >= 0)
        sign = np.where(left >= 0, 1.0, -1.0)
        size = np.sqrt(np.abs(left * right))
        rho = sign / (0.5 * np.abs(left - right) + size)
        any_on = bool(on.any())
        if any_on:
            rho[on] = 0.5
        return cls(left, right, sign * size, rho, on, any_on)

    @property
    def excess(self) -> Array:  # type: ignore[override]
        return np.maximum(-self.left, -self.right)

    @property
    def zeta(self) -> Array:
        return 0.5 * (self.left - self.right)

    def __getitem__(self, which: Any) -> "OnLine":
        return OnLine(
            self.left[which],
            self.right[which],
            self.root[which],
            self.rho[which],
            self.on[which],
            self.any_on,
        )


def complex_of(x: Any, y: Any) -> Complex:
    """The complex numbers x + i y; the sign of a zero y is kept."""
    x, y = np.broadcast_arrays(x, y)
    out = np.empty(x.shape, dtype=complex)
    out.real, out.imag = x, y
    return out


@record
class InPlane:
    """Complex points x + iy, y >= 0, each in the coordinate zeta of its own interval.

    With zeta = (x + iy - middle) / half width, left = zeta + 1 and less = zeta - 1. The square
    roots p of `left` and m of `less` lie in the first quadrant. Then sqrt(zeta^2 - 1) = p m, and
    rho = zeta - sqrt(zeta^2 - 1) is 2 / (p + m)^2, and 1 - rho is 2 m / (p + m).
    """

    left: Complex
    less: Complex

    @classmethod
    def of(cls, from_a: Array, from_b: Array, y: Array) -> "InPlane":
        """The points x + i y, given x - a, x - b and y divided by the half width of (a, b)."""
        return cls(complex_of(from_a, y), complex_of(from_b, y))

    @cached_property
    def p(self) -> Complex:
        """The square root p of zeta + 1, for the point's coordinate zeta."""
        return np.asarray(np.sqrt(self.left))

    @cached_property
    def m(self) -> Complex:
        """The square root m of zeta - 1, for the point's coordinate zeta."""
        return np.asarray(np.sqrt(self.less))

    @cached_property
    def zeta(self) -> Complex:
        return np.asarray(0.5 * (self.left + self.less))

    @cached_property
    def root(self) -> Complex:
        """sqrt(zeta^2 - 1) for the point's coordinate zeta, as the product of p and m."""
        return self.p * self.m

    @cached_property
    def rho(self) -> Complex:
        """rho = zeta - sqrt(zeta^2 - 1) for the coordinate zeta, without cancellation."""
        return np.asarray(2 / (self.p + self.m) ** 2)

    @property
    def from_ends(self) -> tuple[Complex, Complex]:
        """(1 + rho, 1 - rho) with rho = zeta - sqrt(zeta^2 - 1), without cancellation."""
        twice = 2 / (self.p + self.m)
        return twice * self.p, twice * self.m

    @cached_property
    def log(self) -> Complex:
        """arcosh(zeta) = -log(rho) of the coordinate zeta; the imaginary part is 0 ... pi."""
        return np.asarray(2 * np.log((self.p + self.m) * np.sqrt(0.5)))

    def first(self, width: Number) -> Complex:
        """Potential of 1 / sqrt(1 - t^2), divided by the half width w: log(width / (2 rho)).

        width: w divided by the kernel's `datum`; rho: see `rho`.
        """
        return np.asarray(np.log(0.5 * width) + self.log)

    def __getitem__(self, which: Any) -> "InPlane":
        return InPlane(self.left[which], self.less[which])

    def turned(self, c: Array, s: Array) -> Complex:
        """log(1 - rho e^(-i phi)), rho = zeta - sqrt(zeta^2 - 1), for angles phi on the last axis.

        c, s: cos(phi/2) and sin(phi/2).
        """
        p, m = self.p[..., None], self.m[..., None]
        return np.asarray(np.log(2 * (c - 1j * s) * (c * m + 1j * s * p) / (p + m)))


# The functions below give transforms and potentials of densities at points off the interval.
def of_t(
    c: Array, seen: InPlane | Outside | OnLine, w: Array, datum: float, row: Index, what: What
) -> Number:
    """Transform (or its derivative, or potential) of sum_l c[row, l] T_l / sqrt(1 - t^2).

    what: which of these three. seen: points off the intervals. w: half width of the interval of
    each point; row: row of `c` for each point. datum: length that divides distances in potentials.
    """
    if what == "potential":
        divided = c / np.maximum(np.arange(c.shape[1]), 1)
        return potential_of(divided, seen, w, datum, row)
    if what == "transform":
        return np.asarray(sum_of_powers(c, seen.rho, row) / seen.root)
    return of_t_with_slope(c, seen, w, row)[1]


def of_t_with_slope(
    c: Array, seen: InPlane | Outside | OnLine, w: Array, row: Index
) -> tuple[Number, Number]:
    """Transform of sum_l c[row, l] T_l / sqrt(1 - t^2), and its derivative; see `of_t`."""
    value, slope = sum_and_slope(c, seen.rho, row)
    value = value / seen.root
    return value, -(slope / seen.root + seen.zeta / seen.root * value) / seen.root / w


def potential_of(
    divided: Array, seen: Seen | InPlane, w: Array, datum: float, row: Index
) -> Number:
    """Potential of sum_l c_l T_l / sqrt(1 - t^2); rows of `divided` hold c_0 and c_l / l."""
    return np.asarray(
        w
        * (
            divided[row, 0] * seen.first(w / datum)
            - seen.rho * sum_of_powers(divided[:, 1:], seen.rho, row)
        )
    )


def transform_of(alpha: Array, beta: Array, u: Array, seen: Seen | InPlane, row: Index) -> Number:
    """Transform of the density (alpha + beta t) / X + X sum u_k U_k, X = sqrt(1 - t^2)."""
    rho = seen.rho
    value = rho * sum_of_powers(u, rho, row)
    if not (np.any(alpha) or np.any(beta)):
        return value
    edge = _edge(alpha[row], beta[row], *seen.from_ends)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(edge == 0, 0.0, edge / seen.root) + value)


def _edge(a: Array, b: Array, from_left: Number, from_right: Number) -> Number:
    """The value a + b t, computed from `from_left` = 1 + t and `from_right` = 1 - t.

    No digit is lost close to an end where the result vanishes.
    """
    return np.asarray(0.5 * ((a + b) * from_left + (a - b) * from_right))


def transform_slope_of(alpha: Array, beta: Array, u: Array, seen: InPlane, row: Index) -> Complex:
    """The derivative by x of `transform_of`, multiplied by the half width w."""
    a, b, rho = alpha[row], beta[row], seen.rho
    with np.errstate(divide="ignore", invalid="ignore"):
        edge = (
            -(
                _edge(a, b, *seen.from_ends) / seen.root * seen.zeta / seen.root
                + b * rho / seen.root
            )
            / seen.root
        )
        value = rho * sum_of_powers(-u * np.arange(1, u.shape[1] + 1), rho, row)
        value = np.where(value == 0, 0.0, value / seen.root)
    return np.asarray(np.where((a == 0) & (b == 0), 0.0, edge) + value)


# The functions below give values, transforms, potentials and integrals of densities at points on
# the interval.
def values_on(
    bounded: tuple[Array, Array, Array], row: Index, left: Array, right: Array, vanishing: Mask
) -> Array:
    """Values of (alpha + beta t) / X + X sum u_k U_k on the interval, with X = sqrt(1 - t^2).

    bounded: (alpha, beta, u). left, right: distances from both ends divided by the half width.
    vanishing: whether the density is zero at the left and at the right end of each interval. At
    such an end the first term, which is round-off divided by zero, is left out.
    """
    (alpha, beta, u), root = bounded, root_weight(left, right)
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = alpha[row], beta[row]
        edge = _edge(a, b, left, right) / root
        no_edge = (a == 0) & (b == 0)
        if not np.all(root):
            no_edge |= (left == 0) & vanishing[0][row] | (right == 0) & vanishing[1][row]
        # If all intervals have the same points t, the angles of the first row serve for all rows.
        l, r = (
            (left[:1], right[:1])
            if left.ndim == 2 and left.strides[0] == 0 == right.strides[0]
            else (left, right)
        )
        sums = sine_sum(
            u,
            row,
            np.broadcast_to(nearer_angle(l, r), left.shape),
            np.broadcast_to(l < r, left.shape),
        )
        return np.asarray(np.where(no_edge, 0.0, edge) + sums)


def own_transform(c: Array, row: Index, left: Array, right: Array) -> Array:
    """Transform of sum c_l T_l / sqrt(1 - t^2) on its own interval: -sum c_l U_{l-1}(t)."""
    # At an end the angle is zero, and sine_sum / sin(angle) is 0/0. A tiny angle gives the limit of
    # this ratio.
    angle = np.maximum(nearer_angle(left, right), TINY)
    return np.asarray(-sine_sum(c[:, 1:], row, angle, left < right) / np.sin(angle))


def own_potential(divided: Array, row: Index, left: Array, right: Array, width: Array) -> Array:
    """Potential of sum c_l T_l / sqrt(1 - t^2) on the interval, divided by the half width w.

    divided: the table c_0, c_1, c_2 / 2, c_3 / 3, ...; width: w divided by `datum`, for each pair.
    """
    return np.asarray(
        divided[row, 0] * np.log(0.5 * width) - cosine_sum(divided[:, 1:], row, theta(left, right))
    )


def integral_on(c: Array, row: Index, angle: Array) -> Array:
    """Integral over t, from t = -1 to t = cos(angle), of sum c_l T_l / sqrt(1 - t^2).

    For c_l = 1 it is -sin(l theta) / l, or pi - theta if l = 0, where theta is `angle`.
    """
    nearer, flip = np.minimum(angle, np.pi - angle), angle > 0.5 * np.pi
    return np.asarray(
        c[row, 0] * (np.pi - angle)
        - sine_sum(c[:, 1:] / np.arange(1, c.shape[1]), row, nearer, flip)
    )


def mean_potential(w: Any, datum: Any, depth: Any = 0.0) -> Any:
    """Mean over an interval of the potential of the density 1 / sqrt(1 - t^2) on it.
    The weight of the mean is 1 / sqrt(1 - t^2), too.

    For T_l / sqrt(1 - t^2) with l > 0 the mean is zero. w: half width. datum: length by which the
    potential divides distances. depth: see `Zones`.
    """
    return w * (np.log(w / (2 * datum)) + depth)


# The functions below give a density's intensity K and edge slope A: at the distance d from an end
# the density is K / sqrt(d) + A sqrt(d).
def intensities(alpha: Array, beta: Array, w: Array) -> tuple[Array, Array]:
    """Intensities K at both ends of the density (alpha + beta t) / sqrt(1 - t^2).
    K is the coefficient of 1 / sqrt(d), with the distance d from the end.
    """
    root = HALF.edge_scale(w)
    return root * (alpha - beta), root * (alpha + beta)


def edge_slopes(
    alpha: Array, beta: Array, at_left: Array, at_right: Array, w: Array
) -> tuple[Array, Array]:
    """Edge slopes A at both ends of the density (alpha + beta t) / X + X sum u_k U_k.
    X = sqrt(1 - t^2). A is the coefficient of sqrt(d), with the distance d from the end.

    at_left, at_right: values of sum u_k U_k at the ends.
    """
    # `left` and `right` are the coefficients of sqrt(d) in (alpha + beta t) / sqrt(1 - t^2), at
    # t = -1 + d/w and t = 1 - d/w.
    left, right = (((alpha + s * beta) / 4 - s * beta) / np.sqrt(2 * w) for s in (-1.0, 1.0))
    scale = HALF.slope_scale(w)
    return scale * at_left + left, scale * at_right + right
