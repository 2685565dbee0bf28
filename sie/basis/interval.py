r"""The basis on one interval, and all that is known of it in closed form.

On the interval of half width w, t = (x - middle)/w = cos(theta), a density is a sum of T_l / X, X =
(1 - t^2)^(1/2), or, which keeps its digits beside an end where it vanishes, (alpha + beta t) / X +
X sum u_k U_k. Off it, with zeta for t,

    R = (zeta^2 - 1)^(1/2), about zeta far away,       rho = zeta - R,  |rho| < 1,       -log(rho) = arcosh(zeta).

               on the interval                                     off it, on the line or at complex points
    transform  T_l / X -> -U_{l-1}                                 T_l / X -> rho^l / R,           X U_l -> rho^(l+1)
    potential  T_l / X -> -w T_l / l, T_0 / X -> w log(w / 2)      T_l / X -> -w rho^l / l,        T_0 / X -> w log(w / (2 |rho|))
    at an end  T_l / X -> K = (w/2)^(1/2) (+-1)^l                  sqrt(distance) times A = (2/w)^(1/2) (l + 1) (+-1)^l of X U_l

These formulas and the exponent 1/2 stand here, and everything else asks for them. No place is given
by t: on the line by its distances from both ends over w, or by |zeta| - 1; at complex points by
zeta + 1 and zeta - 1. So no digit is lost beside an end.
"""

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import EPS, TINY, Array, Complex, Index, Mask, record
from sie.basis.sums import cosine_sum, sine_sum, sum_of_powers

Number = NDArray[Any]
What = Literal["transform", "derivative", "potential"]

LOG2 = float(np.log(2.0))
# Step of central differences by an angle: it balances truncation and round-off.
_STEP = EPS ** (1 / 3)


# places
# -----------------------------------------------------------------------------------------------------------------
def theta(left: Any, right: Any) -> Array:
    """Angle from the right end, t = cos(theta), by the distances from both ends over w;
    theta(right, left) is that from the left end.
    """
    return np.asarray(2 * np.arctan2(np.sqrt(right), np.sqrt(left)))


def sides(angle: Array) -> tuple[Array, Array]:
    """(1 + t, 1 - t), the distances from both ends over w, at angles."""
    return 2 * np.cos(0.5 * angle) ** 2, 2 * np.sin(0.5 * angle) ** 2


def by_angle(of: Callable[[Array, Array], Array], angle: Array) -> tuple[Array, Array]:
    """(value, derivative by the angle) of a function of the distances from both ends over w, at
    angles, by close differences.
    """
    step = np.minimum(_STEP, 0.5 * np.minimum(angle, np.pi - angle))
    before, after = (of(*sides(at)) for at in (angle - step, angle + step))
    return 0.5 * (before + after), (after - before) / (2 * step)


def nearer_angle(left: Array, right: Array) -> Array:
    """Angle from the nearer end."""
    return theta(np.maximum(left, right), np.minimum(left, right))


def decay_rate(excess: Any) -> Array:
    """-log|rho| at |zeta| = 1 + excess: by so much does rho^l fall from each l to the next."""
    return np.asarray(2 * np.arcsinh(np.sqrt(0.5 * excess)))


class Seen:
    """Points of the line seen from intervals: R, rho, and (1 + rho, 1 - rho); T_0 / X has the
    potential w first(w / datum).
    """

    rho: Array
    root: Array
    excess: Array
    """|zeta| - 1."""

    @property
    def from_ends(self) -> tuple[Array, Array]:
        """(1 + rho, 1 - rho)."""
        past, size = self.rho > 0, np.abs(self.rho)
        small, large = (self.excess + np.abs(self.root)) * size, 1 + size
        return np.where(past, large, small), np.where(past, small, large)

    def first(self, width: Number) -> Array:
        """log(width / (2 |rho|))."""
        return np.asarray(np.log(width / (2 * np.abs(self.rho))))

    def transforms(self, count: int) -> Array:
        """What T_l / X, l = 0 ... count - 1, are transformed to, along a last axis."""
        table = np.empty((*np.shape(self.rho), count))
        table[..., 0] = 1 / self.root
        table[..., 1:] = self.rho[..., None]
        return np.cumprod(table, axis=-1, out=table)

    def potentials(self, count: int, width: Number) -> Array:
        """Their potentials over w, along a last axis; width: w over the datum."""
        power = np.arange(count)
        values = -(self.rho[..., None] ** power) / np.maximum(power, 1)
        values[..., 0] = self.first(width)
        return np.asarray(values)

    def one_by_one(
        self, potential: bool, width: Number, weight: Array | None = None
    ) -> Iterator[Array]:
        """The same, l = 0, 1, ..., one after the other, times a weight."""
        weight = np.ones_like(self.rho) if weight is None else weight
        power: Array = np.asarray(weight if potential else weight / self.root, dtype=float)
        yield power * self.first(width) if potential else power
        l = 0
        while True:
            power, l = power * self.rho, l + 1
            yield -power / l if potential else power


@record
class Outside(Seen):
    """Points of the line off intervals: the sign of zeta, and |zeta| - 1."""

    sign: Any
    excess: Array

    @property
    def zeta(self) -> Array:
        return np.asarray(self.sign * (1 + self.excess))

    @cached_property
    def _size(self) -> Array:
        return np.sqrt(self.excess * (self.excess + 2))

    @cached_property
    def root(self) -> Array:  # type: ignore[override]
        return np.asarray(self.sign * self._size)

    @cached_property
    def rho(self) -> Array:  # type: ignore[override]
        return np.asarray(self.sign / (1 + self.excess + self._size))

    @cached_property
    def log(self) -> Array:
        """-log|rho|."""
        return decay_rate(self.excess)


@record
class OnLine(Seen):
    """Points of the line seen from intervals: distances from the ends over w (positive on the
    interval), R and rho, if on it; there rho is any value inside the unit circle.
    """

    left: Array
    right: Array
    root: Array
    rho: Array
    on: Mask
    any_on: bool

    @classmethod
    def of(cls, left: Array, right: Array) -> "OnLine":
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
    """x + i y, the sign of a zero y kept."""
    x, y = np.broadcast_arrays(x, y)
    out = np.empty(x.shape, dtype=complex)
    out.real, out.imag = x, y
    return out


@record
class InPlane:
    """Points of the closed upper half plane seen from intervals, pair by pair, by zeta + 1 and zeta
    - 1, whose roots p and m are both in the first quadrant: R = p m, rho = 2 / (p + m)^2, 1 - rho =
    2 m / (p + m).
    """

    left: Complex
    less: Complex

    @classmethod
    def of(cls, from_a: Array, from_b: Array, y: Array) -> "InPlane":
        """By x - a, x - b and y, over the half width."""
        return cls(complex_of(from_a, y), complex_of(from_b, y))

    @cached_property
    def p(self) -> Complex:
        return np.asarray(np.sqrt(self.left))

    @cached_property
    def m(self) -> Complex:
        return np.asarray(np.sqrt(self.less))

    @cached_property
    def zeta(self) -> Complex:
        return np.asarray(0.5 * (self.left + self.less))

    @cached_property
    def root(self) -> Complex:
        """R."""
        return self.p * self.m

    @cached_property
    def rho(self) -> Complex:
        return np.asarray(2 / (self.p + self.m) ** 2)

    @property
    def from_ends(self) -> tuple[Complex, Complex]:
        """(1 + rho, 1 - rho)."""
        twice = 2 / (self.p + self.m)
        return twice * self.p, twice * self.m

    @cached_property
    def log(self) -> Complex:
        """-log(rho) = arcosh(zeta), its imaginary part from 0 to pi."""
        return np.asarray(2 * np.log((self.p + self.m) * np.sqrt(0.5)))

    def first(self, width: Number) -> Complex:
        """log(width / (2 rho))."""
        return np.asarray(np.log(0.5 * width) + self.log)

    def __getitem__(self, which: Any) -> "InPlane":
        return InPlane(self.left[which], self.less[which])

    def turned(self, c: Array, s: Array) -> Complex:
        """log(B) for jumps with cos(phi/2) = c, sin(phi/2) = s along a last axis."""
        p, m = self.p[..., None], self.m[..., None]
        return np.asarray(np.log(2 * (c - 1j * s) * (c * m + 1j * s * p) / (p + m)))


# off the interval
# -------------------------------------------------------------------------------------------------------
def of_t(
    c: Array, seen: InPlane | Outside | OnLine, w: Array, datum: float, row: Index, what: What
) -> Number:
    """Of sum c[row, l] T_l / X on intervals of half widths w."""
    if what == "potential":
        divided = c / np.maximum(np.arange(c.shape[1]), 1)
        return potential_of(divided, seen, w, datum, row)
    value = sum_of_powers(c, seen.rho, row)
    if what == "transform":
        return np.asarray(value / seen.root)
    slope = sum_of_powers(c * np.arange(c.shape[1]), seen.rho, row)
    return np.asarray(-(slope + seen.zeta / seen.root * value) / seen.root**2 / w)


def potential_of(
    divided: Array, seen: Seen | InPlane, w: Array, datum: float, row: Index
) -> Number:
    """The potential of sum c[row, l] T_l / X, by c_0, c_1, c_2 / 2, c_3 / 3 ..."""
    return np.asarray(
        w
        * (
            divided[row, 0] * seen.first(w / datum)
            - seen.rho * sum_of_powers(divided[:, 1:], seen.rho, row)
        )
    )


def transform_of(alpha: Array, beta: Array, u: Array, seen: Seen | InPlane, row: Index) -> Number:
    """The transform of (alpha + beta t) / X + X sum u_k U_k."""
    rho = seen.rho
    value = rho * sum_of_powers(u, rho, row)
    if not (np.any(alpha) or np.any(beta)):
        return value
    edge = _edge(alpha[row], beta[row], *seen.from_ends)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(edge == 0, 0.0, edge / seen.root) + value)


def _edge(a: Array, b: Array, from_left: Number, from_right: Number) -> Number:
    """a + b t, or a + b rho, by 1 +- t: near an end where it vanishes no digit is lost."""
    return np.asarray(0.5 * ((a + b) * from_left + (a - b) * from_right))


def transform_slope_of(alpha: Array, beta: Array, u: Array, seen: InPlane, row: Index) -> Complex:
    """w times the derivative of this."""
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


# on the interval
# --------------------------------------------------------------------------------------------------------
def values_on(
    alpha: Array, beta: Array, u: Array, row: Index, left: Array, right: Array, vanishing: Mask
) -> Array:
    """(alpha + beta t) / X + X sum u_k U_k; vanishing: whether it is zero at the left, at the right
    end of each, whatever rounding has left of alpha and beta.
    """
    root = np.sqrt(left * right)
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = alpha[row], beta[row]
        edge = _edge(a, b, left, right) / root
        no_edge = (a == 0) & (b == 0)
        if not np.all(root):
            no_edge |= (left == 0) & vanishing[0][row] | (right == 0) & vanishing[1][row]
        # The same places in every interval are one row of angles.
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
    """-sum c_l U_{l-1}(t), the transform of sum c_l T_l / X, pair by pair."""
    # At an end itself the limit.
    angle = np.maximum(nearer_angle(left, right), TINY)
    return np.asarray(-sine_sum(c[:, 1:], row, angle, left < right) / np.sin(angle))


def own_potential(divided: Array, row: Index, left: Array, right: Array, width: Array) -> Array:
    """The potential over w of the same, by c_0, c_1, c_2 / 2, ...; width: w over the datum of each
    pair.
    """
    return np.asarray(
        divided[row, 0] * (np.log(width) - LOG2)
        - cosine_sum(divided[:, 1:], row, theta(left, right))
    )


def integral_on(c: Array, row: Index, angle: Array) -> Array:
    """Integral over w of sum c_l T_l / X from the left end to the angle theta: int T_l / X dt =
    -sin(l theta) / l, pi - theta for l = 0.
    """
    nearer, flip = np.minimum(angle, np.pi - angle), angle > 0.5 * np.pi
    return np.asarray(
        c[row, 0] * (np.pi - angle)
        - sine_sum(c[:, 1:] / np.arange(1, c.shape[1]), row, nearer, flip)
    )


def mean_potential(w: Any, datum: Any) -> Any:
    """Mean over the interval (weight 1 / X) of the potential of T_0 / X; of the others it is zero."""
    return w * np.log(w / (2 * datum))


# at the ends
# ------------------------------------------------------------------------------------------------------------
def edge_scale(w: Any) -> Any:
    """K of T_l / X at the right end: the density is K / sqrt(d) at the distance d from an end."""
    return np.sqrt(0.5 * w)


def intensities(alpha: Array, beta: Array, w: Array) -> tuple[Array, Array]:
    """K at the left and at the right end of (alpha + beta t) / X + X sum u_k U_k."""
    root = edge_scale(w)
    return root * (alpha - beta), root * (alpha + beta)


def slope_scale(w: Any) -> Any:
    """A of what is the angle from an end, beside it: the density is K / sqrt(d) + A sqrt(d)."""
    return np.sqrt(2 / w)


def edge_slopes(
    alpha: Array, beta: Array, at_left: Array, at_right: Array, w: Array
) -> tuple[Array, Array]:
    """A at the left and at the right end of the same, of which sum u_k U_k is so much there."""
    # From (alpha + beta t) / X at t = 1 - d/w, to second order.
    left, right = (((alpha + s * beta) / 4 - s * beta) / np.sqrt(2 * w) for s in (-1.0, 1.0))
    scale = slope_scale(w)
    return scale * at_left + left, scale * at_right + right
