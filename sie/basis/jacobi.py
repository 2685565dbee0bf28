"""Jacobi polynomials of the second-kind equation on (-1, 1), without loss of digits at the ends.

With alpha in (0, 1) there are two families, normalised by an integral over (-1, 1):

    singular  p_n of degree n:  int w p_n^2 dt = pi / 2 (pi for n = 0),
              w = sin(pi alpha) (1 - t)^(alpha - 1) (1 + t)^(-alpha)
    bounded   q_n of degree n:  int (1 - t^2) w q_n^2 dt = pi / 2

For alpha = 1/2 they are Chebyshev's T_n and U_n. Both obey the recurrence

    t p_n = b_(n+1) p_(n+1) + a_n p_n + b_n p_(n-1),        t p_0 = 2 b_1 p_1 + a_0 p_0,
    a_n = (2 alpha - 1) / (4 n^2 - 1),    b_n = ((n - 1 + alpha) (n - alpha))^(1/2) / (2 n - 1);

the recurrence of q_n has -a_(n+1) and b_(n+1) instead of a_n and b_n. The values at t = 1 are

    p_n(1) = prod_(k < n) ((k + alpha) / (k + 1 - alpha))^(1/2),
    q_n(1) = (n + 1) p_(n+1)(1) / (2 alpha),

and the values at t = -1 have 1 - alpha instead of alpha, and the sign (-1)^n (Szegő, Orthogonal
Polynomials, 4.1 and 4.5). Near an end the rounding of t alone would cause an error of n^2 units of
round-off. So the recurrence is written for f_n = p_n / p_n(1), with the distance 1 - t from the
nearer end as the given number,

    up_n (f_(n+1) - f_n) = down_n (f_n - f_(n-1)) - (1 - t) f_n

(C. Reinsch's variant of Clenshaw's algorithm).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import DIGITS, Array, Index

Number = NDArray[Any]


@dataclass(frozen=True)
class SweepOptions:
    """Options of the recurrences over n that give transforms at points off the interval.

    The transforms F_n of the two families are the minimal solutions of the recurrences. They decay
    as rho^n, with rho = zeta - sqrt(zeta^2 - 1) at the point zeta, while all other solutions grow
    as rho^(-n) (W. Gautschi, SIAM Review 9, 1967, 24-82).
    """

    # At a point, the recurrence for the transforms runs towards larger n if round-off grows by less
    # than this factor over all n, and otherwise towards smaller n. Half this value halves the
    # largest errors, but makes the longest recurrence towards smaller n a third longer.
    max_growth: float = 10.0
    # Up to this number of points, one recurrence towards smaller n serves all points. If there are
    # more, they are divided into groups whose recurrences have similar numbers of steps. The
    # overhead of one step is as large as the cost of this step for some hundred points.
    min_grouped: int = 200


OPTIONS = SweepOptions()


@dataclass(frozen=True)
class Family:
    """The Jacobi polynomials p_n, or q_n if `bounded` is true, for one exponent alpha.
    They are orthogonal on (-1, 1): the p_n with the weight w, which is proportional to
    (1 - t)^(alpha - 1) (1 + t)^(-alpha), and the q_n with the weight (1 - t^2) w. The head of this
    file defines w and the normalisation.

    alpha, rest: alpha and 1 - alpha, each without cancellation, real or complex. bounded: whether
    the polynomials are the q_n.
    """

    alpha: Any
    rest: Any
    bounded: bool = False

    @property
    def is_complex(self) -> bool:
        """Whether alpha is a complex number."""
        return isinstance(self.alpha, complex)

    def numbers(self, *others: Number) -> Any:
        """The NumPy type, real or complex, of products of the polynomials with the given arrays."""
        return np.result_type(np.asarray(self.alpha), *others)

    @property
    def mirrored(self) -> "Family":
        """The family whose polynomial n at t is (-1)^n times this family's polynomial n at -t."""
        return Family(self.rest, self.alpha, self.bounded)

    def recurrence(self, count: int) -> tuple[Array, Array]:
        """Coefficients (a_n, b_n), n < `count`, of the three-term recurrence of the polynomials.
        The recurrence is t p_n = b_(n+1) p_(n+1) + a_n p_n + b_n p_(n-1). b_0 is zero. The head of
        this file has the exception for n = 0.
        """
        return _recurrence(self, count, self.is_complex)

    def at_one(self, count: int) -> Array:
        """Values of the polynomials n = 0 ... count - 1 at the right end t = 1."""
        return _at_one(self, count, self.is_complex)

    def at_minus_one(self, count: int) -> Array:
        """Values of the polynomials n = 0 ... count - 1 at the left end t = -1."""
        return np.asarray(self.mirrored.at_one(count) * (1.0 - 2.0 * (np.arange(count) % 2)))

    def steps(self, count: int) -> tuple[Array, Array]:
        """Coefficients (up_n, down_n), n < `count`, of the recurrence for f_n = p_n / p_n(1).
        The recurrence is up_n (f_(n+1) - f_n) = down_n (f_n - f_(n-1)) - (1 - t) f_n.
        """
        return _steps(self, count, self.is_complex)

    def sums(self, c: Array, left: Any, right: Any) -> Array:
        """Sum of c_n p_n(t) over the polynomials p_n of the family; left is 1 + t, right is 1 - t.

        c: the coefficients along the last axis; other axes come first in the result.
        """
        left, right = np.broadcast_arrays(np.asarray(left, float), np.asarray(right, float))
        out = np.zeros((*c.shape[:-1], *right.shape), dtype=self.numbers(c))
        for family, sign, distance, here in self._halves(left, right):
            signed = c * sign ** np.arange(c.shape[-1])
            out[..., here] = _sum_from_end(family, signed * family.at_one(c.shape[-1]), distance)
        return out

    def table(self, count: int, left: Any, right: Any) -> Array:
        """Values of the polynomials n = 0 ... count - 1 at given points, along a new last axis.
        left, right: 1 + t and 1 - t of the points.
        """
        left, right = np.broadcast_arrays(np.asarray(left, float), np.asarray(right, float))
        out = np.zeros((*right.shape, count), dtype=self.numbers())
        for family, sign, distance, here in self._halves(left, right):
            scale = family.at_one(count) * sign ** np.arange(count)
            out[here] = _table_from_end(family, count, distance) * scale
        return out

    def _halves(
        self, left: Array, right: Array
    ) -> Iterator[tuple["Family", float, Array, NDArray[np.bool_]]]:
        """Yield (family, sign, distances 1 - t, mask) for the points of each half of the interval.
        For the left half the family is mirrored, so that the nearer end is always t = 1. The
        polynomial n of the mirrored family has the additional factor sign^n.
        """
        beyond = right <= left
        for family, sign, distance, here in (
            (self, 1.0, right, beyond),
            (self.mirrored, -1.0, left, ~beyond),
        ):
            if here.any():
                yield family, sign, distance[here], here


def _cached(count: int, *tables: Array) -> tuple[Array, ...]:
    """The first `count` entries of cached tables, as views that cannot be written to."""
    for table in tables:
        table.flags.writeable = False
    return tuple(table[:count] for table in tables)


# A real and a complex family may compare equal. So the last argument, whether alpha is complex,
# gives each of them its own entry of the cache.
@lru_cache(maxsize=256)
def _recurrence(family: Family, count: int, _: bool) -> tuple[Array, Array]:
    n = np.arange(count, dtype=float) + (1.0 if family.bounded else 0.0)
    a: Array = np.asarray((family.alpha - family.rest) / (4 * n * n - 1))
    products = (n - 1 + family.alpha) * (n - 1 + family.rest)
    b: Array = np.asarray(np.sqrt(products) / (2 * n - 1))
    if family.bounded:
        a = np.negative(a)
    b[:1] = 0.0
    return _cached(count, a, b)  # type: ignore[return-value]


@lru_cache(maxsize=256)
def _at_one(family: Family, count: int, _: bool) -> Array:
    # In a product of a thousand doubles, round-off would add up. `np.longdouble` prevents this on
    # platforms where it has more digits than a double.
    k = np.arange(count + 1, dtype=np.longdouble)
    factors = np.ones(count + 2, dtype=family.numbers(k))
    factors[1:] = np.sqrt((k + family.alpha) / (k + family.rest))
    values = np.cumprod(factors)
    if family.bounded:
        values = values[1:] * (k + 1) / (2 * family.alpha)
    return _cached(count, np.asarray(values, dtype=family.numbers()))[0]


@lru_cache(maxsize=256)
def _steps(family: Family, count: int, _: bool) -> tuple[Array, Array]:
    n, alpha, rest = np.arange(count, dtype=float), family.alpha, family.rest
    if family.bounded:
        up = (n + 2) * (n + 1 + alpha) / ((n + 1) * (2 * n + 3))
        down = n * (n + rest) / ((n + 1) * (2 * n + 1))
    else:
        up = (n + alpha) / (2 * n + 1)
        up[:1] *= 2
        down = (n - 1 + rest) / (2 * n - 1)
        down[:1] = 0.0
    return _cached(count, up, down)  # type: ignore[return-value]


def _sum_from_end(family: Family, c: Array, distance: Array) -> Array:
    """Sum of c_n f_n at distances 1 - t, with f_n = p_n / p_n(1) and the polynomials p_n."""
    up, down = family.steps(c.shape[-1])
    value, change = np.zeros((2, *c.shape[:-1], *distance.shape), dtype=family.numbers(c))
    for n in range(c.shape[-1] - 1, -1, -1):
        both = value + change
        value += c[..., n, None] - both * distance / up[n]
        change = both * (down[n] / up[n])
    return value


def _table_from_end(family: Family, count: int, distance: Array) -> Array:
    """Values of f_n = p_n / p_n(1), the polynomials p_n scaled to the value 1 at t = 1.
    The values for n = 0 ... count - 1 are along a new last axis. distance: 1 - t of each point.
    """
    up, down = family.steps(count)
    rows = np.ones((count, *distance.shape), dtype=family.numbers())
    change = np.zeros_like(rows[0])
    for n in range(count - 1):
        change = (change * down[n] - distance * rows[n]) / up[n]
        rows[n + 1] = rows[n] + change
    return np.moveaxis(rows, 0, -1)


# The functions below give the transforms F_n(zeta) = (1/pi) int phi(t) / (zeta - t) dt of a family.
# phi is p_n w, or q_n (1 - t^2) w for the bounded family, with the weight w. A point zeta in the
# right half plane is given by less = zeta - 1 and left = zeta + 1. The recurrences are for F_n
# divided by the value of the polynomial n at t = 1.
def log_ratio(less: Number, left: Number) -> Number:
    """log((zeta - 1) / (zeta + 1)), accurate near zeta = -1 and zeta = 1, and for large |zeta|.
    less and left are zeta - 1 and zeta + 1.
    """
    near = np.minimum(np.abs(less), np.abs(left)) < 2.0
    parts = (x[near] if np.iscomplexobj(x) else np.abs(x[near]) for x in (less, left))
    above, below = (np.log(part) for part in parts)
    out = np.empty_like(less)
    out[near] = above - below
    out[~near] = -2 * np.arctanh(2 / (less[~near] + left[~near]))
    return out


def transform_table(family: Family, count: int, less: Number, left: Number) -> Number:
    """Transforms (P, count) of the family's polynomials, each multiplied by the weight.
    The polynomials have the degrees 0 ... count - 1. less, left: zeta - 1 and zeta + 1 of the P
    points zeta, which lie in the right half plane.
    """
    out = np.empty((count, len(less)), dtype=family.numbers(less))
    for here, last in _directions(count, less, left, all_terms=True):
        if last == 0:
            for n, value in enumerate(_upward(family, count, less[here], left[here])):
                out[n, here] = value
            continue
        change = np.zeros(0)
        for n, change in _downward(family, last, less[here], left[here]):
            if n < count:
                out[n, here] = 1 + change
        out[0, here] = _first(family, change, less[here], left[here])
        out[:, here] = np.cumprod(out[:, here], axis=0)
    return np.asarray(out.T * family.at_one(count))


def transform_sum(family: Family, c: Array, less: Number, left: Number) -> Number:
    """The sum of c_n F_n at points (P,).
    F_n is the transform of the weight times the family's polynomial of degree n. less, left: zeta -
    1 and zeta + 1 of the points zeta.
    """
    out = np.zeros(len(less), dtype=family.numbers(less, c))
    if len(c) == 0:
        return out
    scaled = c * family.at_one(len(c))
    for here, last in _directions(len(c), less, left, all_terms=False):
        total = np.zeros(len(less[here]), dtype=out.dtype)
        if last == 0:
            for n, value in enumerate(_upward(family, len(c), less[here], left[here])):
                total += scaled[n] * value
            out[here] = total
            continue
        change = total
        for n, change in _downward(family, last, less[here], left[here]):
            if n < len(c):
                total = (scaled[n] + total) * (1 + change)
        out[here] = (scaled[0] + total) * _first(family, change, less[here], left[here])
    return out


def _directions(
    count: int, less: Number, left: Number, all_terms: bool
) -> Iterator[tuple[Index, int]]:
    """Yield groups of points, each with the direction of the recurrence for the transforms F_n.
    A group is (indices of its points, the n at which the recurrence towards smaller n starts). This
    n is 0 if the recurrence runs towards larger n.

    Let N be the n at which the recurrence towards smaller n starts. An error of the ratio of
    transforms at N changes F_n by rho^(2 (N - n)) F_n. N is so large that this change is round-off
    of F_0 for all n below `count`. Without `all_terms`, terms below round-off of F_0 may be left
    out.
    """
    rate = 2 * np.log(np.abs(np.sqrt(less) + np.sqrt(left))) - np.log(2.0)
    down = rate * count >= np.log(OPTIONS.max_growth)
    if not down.all():
        yield np.flatnonzero(~down), 0
    points, rate = np.flatnonzero(down), rate[down]
    if len(points) == 0:
        return
    terms = np.full(len(points), float(count)) if all_terms else np.minimum(count, DIGITS / rate)
    last = np.ceil(np.maximum(terms, 0.5 * (terms + DIGITS / rate))) + 2
    group = np.ceil(np.log2(last)) if len(points) > OPTIONS.min_grouped else np.zeros(len(points))
    for number in np.unique(group):
        here = group == number
        yield points[here], int(last[here].max())


def _upward(family: Family, count: int, less: Number, left: Number) -> Iterator[Number]:
    """Yield the scaled transforms f_n, n = 0 ... count - 1, at points close to (-1, 1).
    f_n is the transform of the weight times the polynomial of degree n, divided by the polynomial's
    value at t = 1. The recurrence runs towards larger n.
    """
    up, down = family.steps(count)
    alpha, power = family.alpha, np.expm1(family.alpha * log_ratio(less, left))
    if family.bounded:
        value = -2 * alpha - left * power
        change = (less * value - 2 * alpha * family.rest) / up[0]
    else:
        value = less ** (alpha - 1) * left**-alpha
        change = power / up[0]
    for n in range(1, count):
        yield value
        value = value + change
        change = (down[n] * change + less * value) / up[n]
    yield value


def _downward(
    family: Family, last: int, less: Number, left: Number
) -> Iterator[tuple[int, Number]]:
    """Yield (n, f_n / f_(n-1) - 1) for n from `last` down to 1, with the scaled transforms f_n.
    f_n is the transform of the weight times the polynomial of degree n, divided by the polynomial's
    value at t = 1.

    For points on the line and real alpha all terms have one sign, so that nothing cancels.
    """
    up, down = family.steps(last + 1)
    rho = 2 / (np.sqrt(less) + np.sqrt(left)) ** 2
    before, after = family.at_one(last + 1)[-2:]
    change = rho * (before / after) - 1
    for n in range(last, 0, -1):
        yield n, change
        if n > 1:
            change = (up[n - 1] * change - less) / down[n - 1]
            change = change / (1 - change)


def _first(family: Family, change: Number, less: Number, left: Number) -> Number:
    """The first scaled transform f_0, from which the ratios of `_downward` give all f_n.
    f_n is the transform of the weight times the polynomial of degree n, divided by the polynomial's
    value at t = 1. change: f_1 / f_0 - 1.
    """
    if family.bounded:
        return 2 * family.alpha * family.rest / (less - family.steps(1)[0][0] * change)
    return np.asarray(less ** (family.alpha - 1) * left**-family.alpha)
