"""The graded coordinate s of a zone between narrow gaps.

Let a zone of width W have the gaps g and g' on its left and right. A place has the distances d and
d' from the zone's ends. Its graded coordinate s runs from -1 to 1 and is linear in

    u = log((d + g) / (d' + g')),          du/ds = B = log((1 + W/g) (1 + W/g')) / 2.

Near a narrow gap, equal steps of s are equal ratios of the distance from the zone beyond the gap. A
density next to a gap of 1e-12 of the zone needs some 80 Chebyshev polynomials of s. In x it would
need 1e7.

The map s -> x is a Moebius transform of exp(B s), and x - x' follows from s - s':

    x - x' = L sinh(B (s - s')/2) / (2 cosh(u/2) cosh(u'/2)),        L = W + g + g',
    dx/ds = B L / (4 cosh^2(u/2)) = B (d + g) (d' + g') / L,
    (dx/ds) / (x - x') = (B/2) (coth(B (s - s')/2) - tanh(u/2)).

In s a Cauchy kernel therefore remains a Cauchy kernel plus a smooth one. The nearest singularities
of x as a function of s are at the distance pi/B from the real axis.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis import chebyshev
from sie.basis.data import Array, Complex, Kept, record
from sie.basis.interval import complex_of

Numbers = NDArray[Any]
"""Real or complex numbers."""


@record
class Places:
    """Places on or near one zone, in its graded coordinate s.

    left, right: 1 + s and 1 - s; u: see the head of this file; from_a, from_b: distances from the
    zone's ends; rate: dx/ds. All are complex for complex places.
    """

    left: Any
    right: Any
    u: Any
    from_a: Any
    from_b: Any
    rate: Any

    def __getitem__(self, which: Any) -> Places:
        return Places(
            self.left[which],
            self.right[which],
            self.u[which],
            self.from_a[which],
            self.from_b[which],
            self.rate[which],
        )


@record
class Grading(Kept):
    """Graded coordinate of a zone of width `width`, with gaps of widths `before` and `after`."""

    width: float
    before: float
    after: float

    @cached_property
    def reach(self) -> float:
        """The length L of the zone together with the gaps on both sides."""
        return self.width + self.before + self.after

    @cached_property
    def stretch(self) -> float:
        """B = du/ds, where exp(u) is the ratio of the distances from both adjacent zones."""
        return 0.5 * float(np.log1p(self.width / self.before) + np.log1p(self.width / self.after))

    @cached_property
    def first_u(self) -> float:
        """u at the zone's left end; exp(u) is the ratio of distances from both adjacent zones."""
        return float(np.log(self.before / (self.width + self.after)))

    @cached_property
    def last_u(self) -> float:
        """u at the zone's right end; exp(u) is the ratio of distances from both adjacent zones."""
        return float(np.log((self.width + self.before) / self.after))

    def at(self, left: Array, right: Array) -> Places:
        """`Places` on the zone: s is the graded coordinate, left = 1 + s and right = 1 - s."""
        with np.errstate(over="ignore"):
            u = np.where(
                left < right, self.first_u + self.stretch * left, self.last_u - self.stretch * right
            )
            from_a = self.before * np.expm1(self.stretch * left) / (1 + np.exp(u))
            from_b = self.after * np.expm1(self.stretch * right) / (1 + np.exp(-u))
        return Places(left, right, u, from_a, from_b, self._rate(from_a, from_b))

    def of(self, from_a: Numbers, from_b: Numbers) -> Places:
        """`Places` at signed distances from the zone's ends, up to the ends of adjacent zones.

        At complex places the distances are complex.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            past_a, past_b = from_a + self.before, from_b + self.after
            left = _log1p(from_a / self.before) + _log1p(from_a / past_b)
            right = _log1p(from_b / self.after) + _log1p(from_b / past_a)
            return Places(
                left / self.stretch,
                right / self.stretch,
                np.log(past_a / past_b),
                from_a,
                from_b,
                self._rate(from_a, from_b),
            )

    def _rate(self, from_a: Numbers, from_b: Numbers) -> Numbers:
        """dx/ds at points given by distances from both zone ends; s is the graded coordinate."""
        return np.asarray(
            self.stretch * (from_a + self.before) * ((from_b + self.after) / self.reach)
        )

    @cached_property
    def ends(self) -> Places:
        """The `Places` of the zone's left and right end."""
        return self.at(np.array([0.0, 2.0]), np.array([2.0, 0.0]))

    @cached_property
    def end_rates(self) -> Array:
        """dx/ds at the zone's left and right end, with the graded coordinate s."""
        return np.asarray(self.ends.rate)

    @cached_property
    def end_bends(self) -> Array:
        """(d^2x/ds^2) / (dx/ds) at the zone's left and right end, with the graded coordinate s."""
        return np.asarray(-self.stretch * np.tanh(0.5 * self.ends.u))

    def scale(self, places: Places, powers: Array) -> Numbers:
        """(l/L)^m (r/L)^n with the distances l and r of places from the left and right neighbour.

        powers: the exponents m and n, each 0 or 1. L is the distance between the two neighbouring
        zones.
        """
        left = (places.from_a + self.before) / self.reach if powers[0] else 1.0
        right = (places.from_b + self.after) / self.reach if powers[1] else 1.0
        return np.asarray(left * right * np.ones(np.shape(places.u)))

    def scale_bends(self, powers: Array) -> Array:
        """The derivative d log(`scale`) / ds at both ends, with the graded coordinate s."""
        ends = self.ends
        return np.asarray(
            ends.rate
            * (powers[0] / (ends.from_a + self.before) - powers[1] / (ends.from_b + self.after))
        )

    # The methods below are functions of pairs: points along the first axis, sources along the last.
    def turns(self, points: Places, sources: Places) -> Numbers:
        """(B / 2) (s - s') for points s and sources s'; B is `stretch`, s the graded coordinate.

        The difference s - s' is computed from the zone's end that is nearer to the point.
        """
        from_left = points.left[:, None] - sources.left
        from_right = sources.right - points.right[:, None]
        nearer = (np.real(points.left) < np.real(points.right))[:, None]
        return np.asarray(0.5 * self.stretch * np.where(nearer, from_left, from_right))

    def kernel(self, points: Places, sources: Places) -> Array:
        """(dx/ds) / (x - x') for points x and sources x' on the zone, with dx/ds at x."""
        ratio = np.cosh(0.5 * sources.u) / np.cosh(0.5 * points.u)[:, None]
        return np.asarray(0.5 * self.stretch * ratio / np.sinh(self.turns(points, sources)))

    def smooth_kernel(self, points: Places, sources: Places) -> Numbers:
        """(dx/ds) / (x - x') - 1 / (s - s'): the kernel in s without its pole, which is smooth."""
        rest = coth_less_pole(self.turns(points, sources))
        return np.asarray(0.5 * self.stretch * (rest - np.tanh(0.5 * points.u)[:, None]))

    def smooth_kernel_slope(self, points: Places, sources: Places) -> Complex:
        """Derivative of `smooth_kernel` with respect to the coordinate s of the points."""
        slope = coth_less_pole_slope(self.turns(points, sources))
        bend = 1 / np.cosh(0.5 * points.u)[:, None] ** 2
        return np.asarray((0.5 * self.stretch) ** 2 * (slope - bend))

    def log_ratio(self, points: Places, sources: Places) -> Numbers:
        """log((x - x') / (s - s')), for `points` at x(s) and `sources` at x' = x(s')."""
        y = self.turns(points, sources)
        return np.asarray(
            np.log(0.25 * self.reach * self.stretch)
            + log_sinhc(y)
            - np.log(np.cosh(0.5 * points.u))[:, None]
            - np.log(np.cosh(0.5 * sources.u))
        )


# Below this size of y, coth(y) - 1/y and the derivative of this function are summed as series. The
# first neglected terms are then below round-off.
_SMALL = 0.1


def coth_less_pole(y: Numbers) -> Numbers:
    """coth(y) - 1/y, for real y or complex y with |Im y| < pi/2."""
    square, small = y * y, np.abs(y) < _SMALL
    series = (
        y
        / 3
        * (1 - square / 15 * (1 - square * 2 / 21 * (1 - square / 10 * (1 - square * 10 / 99))))
    )
    y = np.where(small, 1.0, y)
    return np.asarray(np.where(small, series, 1 / np.tanh(y) - 1 / y))


def coth_less_pole_slope(y: Numbers) -> Numbers:
    """The derivative 1/y^2 - 1/sinh(y)^2 of `coth_less_pole`."""
    square, small = y * y, np.abs(y) < _SMALL
    series = (
        1 - square / 5 * (1 - square * 10 / 63 * (1 - square * 7 / 50 * (1 - square * 10 / 77)))
    ) / 3
    y = np.where(small, 1.0, y)
    with np.errstate(over="ignore"):
        return np.asarray(np.where(small, series, 1 / y**2 - 1 / np.sinh(y) ** 2))


def log_sinhc(y: Numbers) -> Numbers:
    """log(sinh(y) / y), for real y or complex y with |Im y| < pi/2."""
    safe = np.where(y == 0, 1.0, y)
    return np.asarray(np.where(y == 0, 0.0, np.log(np.sinh(safe) / safe)))


def _log1p(z: Numbers) -> Numbers:
    """log(1 + z); for small complex z, NumPy's `log1p` loses digits."""
    if not np.iscomplexobj(z):
        return np.asarray(np.log1p(z))
    x, y = z.real, z.imag
    return complex_of(0.5 * np.log1p(x * (2 + x) + y * y), np.arctan2(y, 1 + x))


def gauss(grading: Grading, count: int) -> Places:
    """`Places` of the zone's `count` sources, at the zeros of T_count(s) (Gauss's nodes)."""
    return grading.at(*chebyshev.gauss_sides(count))


def collocation(grading: Grading, count: int) -> Places:
    """`Places` of the zone's `count` - 1 collocation nodes, at the zeros of U_(count - 1)(s)."""
    _, right, left = chebyshev.lobatto(count - 1)
    return grading.at(left[1:-1], right[1:-1])
