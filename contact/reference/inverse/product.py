"""The product X M of an inverse design, from distances that do not cancel.

X^2 is a product with one factor for each zone end e. M is a product with one factor for each gap:
its root in the gap is placed so that int_gap X M dx = 0. The factor of an end or root e is
(x - e)/unit, or 2 sin(pi (x - e)/L) with a period. Interval i lies between end i and end i + 1:
zones have even numbers, gaps odd ones. With a period the last gap wraps around.
"""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.errors import NotConverged
from sie import Index, Mask

Array = NDArray[np.floating]

# The number pi to more digits than any long double has.
_PI = "3.14159265358979323846264338327950288"


@dataclass(frozen=True, eq=False)
class CutProduct:
    """The product X M: X^2 has a root at every zone end, and M has one root in every gap.

    The zones, (n, 2), are ascending, and within one period if there is one.

    All numbers have the precision of `zones`. The profile's coefficients lose about one digit per
    zone, so they are computed in extended precision and rounded at the end.
    """

    zones: Array
    period: float | None = None

    def rounded(self) -> "CutProduct":
        """Return the same product X M in double precision, with the roots of M rounded as well."""
        other = CutProduct(self.zones.astype(float), self.period)
        other.__dict__["roots"] = self.roots.astype(float)
        return other

    @property
    def pi(self) -> Any:
        """The number pi in the precision of the zones (double or extended)."""
        return self.zones.dtype.type(_PI)

    @cached_property
    def _turn(self) -> Any:
        return self.pi / self.period

    @cached_property
    def steps(self) -> Array:
        """Lengths of the intervals between neighbouring zone ends; zones and gaps alternate."""
        ends = self.zones.ravel()
        steps = np.diff(ends)
        return steps if self.period is None else np.append(steps, ends[0] + self.period - ends[-1])

    @property
    def gaps(self) -> range:
        """Numbers of the intervals that are gaps between zones.
        Each of these gaps contains one root of M.
        """
        return range(1, 2 * len(self.zones) - (self.period is None), 2)

    @cached_property
    def _unit(self) -> Any:
        """Unit of length of the factors (x - e)/unit, which keeps their products near one.

        This is a quarter of the length of the zones' hull: the logarithmic capacity of the hull.
        """
        return 0.25 * (self.zones[-1, 1] - self.zones[0, 0])

    def _sum(self, first: int, last: int) -> Any:
        """Sum of the lengths of the intervals with numbers first ... last - 1.

        If last < first, the sum runs through the last interval and goes on with interval 0.
        """
        if first <= last:
            return np.sum(self.steps[first:last])
        return np.sum(self.steps[first:]) + np.sum(self.steps[:last])

    @cached_property
    def _leftward(self) -> Array:
        """Matrix of distances between zone ends.
        Entry [i, j] is the distance from end i leftward to end j.

        Without a period it is nan if j > i, and in an extra row and column for the intervals left
        and right of all zones.
        """
        m = 2 * len(self.zones)
        distances = np.array(
            [
                [self._sum(j, i) if self.period or j <= i else np.nan for j in range(m)]
                for i in range(m)
            ]
        )
        return distances if self.period else np.pad(distances, (0, 1), constant_values=np.nan)

    def _distances(self, i: int, dl: Array, dr: Array) -> tuple[Array, Array]:
        """(distances leftward, distances rightward) from points of interval i to every zone end.
        Each array has the shape (..., 2n).

        A point is `dl` from the left end and `dr` from the right end of its interval.
        """
        m = 2 * len(self.zones)
        after = (i + 1) % m if self.period else i + 1
        return dl[..., None] + self._leftward[i, :m], dr[..., None] + self._leftward[:m, after]

    def _factors(self, left: Array, right: Array, positive_side: Mask) -> Array:
        """Signed factors (x - e)/unit at points x, where e are zone ends or roots of M.

        Where `positive_side` is true, e lies at the distance `left` on the left of x. Elsewhere e
        lies at the distance `right` on the right of x. With a period both distances exist, and the
        factors are 2 sin(pi (x - e)/L).
        """
        if self.period is None:
            return np.where(positive_side, left, -right) / self._unit
        return 2.0 * np.sin(self._turn * np.minimum(left, right))

    def _end_factors(self, i: int, dl: Array, dr: Array) -> Array:
        """Absolute values (..., 2n) of the factors x - e of all zone ends e.
        The points x lie in interval i.
        """
        return np.abs(
            self._factors(*self._distances(i, dl, dr), np.arange(2 * len(self.zones)) <= i)
        )

    def _root_distances(
        self, i: int, dl: Array, dr: Array, offsets: Array
    ) -> tuple[Array, Array, Mask]:
        """Distances from points of interval i to all roots of M, which has one root in each gap.
        Returns (distances leftward, distances rightward, mask of the roots on the left of interval
        i, with the root in gap i). `offsets`, (roots, 2), are the distances of the roots from the
        ends of their gaps. If a point x and a root r lie in the same gap, the leftward distance is
        x - r with its sign, and the rightward distance is inf.
        """
        gaps = np.array(self.gaps, dtype=int)
        left, right = self._distances(i, dl, dr)
        left, right = (
            left[..., (gaps + 1) % left.shape[-1]] + offsets[:, 1],
            right[..., gaps] + offsets[:, 0],
        )
        if i in self.gaps:
            own = self.gaps.index(i)
            s, rest = offsets[own]
            left[..., own] = np.where(dl < dr, dl - s, rest - dr)
            right[..., own] = np.inf
        return left, right, gaps <= i

    @cached_property
    def roots(self) -> Array:
        """Table of the roots of M, one per gap: distances from left and right end of the gap.

        Newton's method solves int_gap |X| M = 0 for all gaps.
        """
        gaps = list(self.gaps)
        width = self.steps[gaps]
        offsets = np.repeat(0.5 * width[:, None], 2, axis=1)
        nodes = [self.nodes(g) for g in gaps]
        samples = [
            (dl, dr, weight * self.root(g, dl, dr))
            for g, (dl, dr, weight) in zip(gaps, nodes, strict=True)
        ]
        for _ in range(60):  # it takes about ten
            rows = [
                self._gap_row(row, g, *at, offsets)
                for row, (g, at) in enumerate(zip(gaps, samples, strict=True))
            ]
            residual = np.array([r for r, _ in rows], dtype=float)
            jacobian = np.array([j for _, j in rows], dtype=float).reshape(len(gaps), len(gaps))
            step = -np.linalg.solve(jacobian, residual)
            # A Newton step is limited to nine tenths of the distance from a root of M to the end of
            # its gap, so that the root stays in the gap.
            limit = np.where(step > 0.0, offsets[:, 1], offsets[:, 0])
            step = np.sign(step) * np.minimum(np.abs(step), 0.9 * limit)
            offsets = offsets + np.outer(step, [1.0, -1.0])
            if np.all(np.abs(step) <= 8.0 * np.finfo(width.dtype).eps * width):
                return offsets
        raise NotConverged(
            "the inverse design did not converge: the roots of its product M were not found"
        )

    def _gap_row(
        self, row: int, g: int, dl: Array, dr: Array, weight: Array, offsets: Array
    ) -> tuple[Any, Array]:
        """(integral of |X| M over one gap, derivatives of this integral by the roots of M).
        The integral must be 0, so that both neighbouring zones have the same approach.

        The integral and its derivatives are divided by the integral of |X M|. `weight` is the
        quadrature weight times |X|.
        """
        left, right, is_left = self._root_distances(g, dl, dr, offsets)
        factors = self._factors(left, right, is_left)
        others = np.prod(np.delete(factors, row, axis=-1), axis=-1) * weight
        own = factors[:, row]
        # If a node coincides with the root of M in this gap, the inverse of the factor of this root
        # is infinite at the node. The derivative by this root is computed in another way below.
        with np.errstate(divide="ignore"):
            if self.period is None:
                logarithmic = 1.0 / np.where(is_left, left, -right)
                own_slope = np.full_like(own, 1.0 / self._unit)
            else:
                turn = self._turn
                sign = np.where(left < right, 1.0, -1.0)
                logarithmic = sign * turn / np.tan(turn * np.minimum(left, right))
                own_slope = 2.0 * turn * np.cos(turn * left[:, row])
        scale = np.sum(np.abs(others * own))
        derivative = -(others * own) @ np.where(np.isfinite(logarithmic), logarithmic, 0.0) / scale
        derivative[row] = -np.sum(others * own_slope) / scale
        return np.sum(others * own) / scale, derivative

    def nodes(self, i: int) -> tuple[Any, Any, Any]:
        """Nodes and weights of a Gauss-Chebyshev rule on interval i.
        Each node is given by its distances from both ends of the interval.

        Returns (distances dl from the left end, distances dr from the right end, weights). Near
        the ends the integrand may grow like 1/sqrt(distance). It is analytic up to the next zone
        ends outside the interval. The distance to the nearer of these, divided by the length of the
        interval, sets the number of nodes.
        """
        m, h = len(self.steps), self.steps[i]
        nearest = min(
            (
                float(self.steps[k % m])
                for k in (i - 1, i + 1)
                if self.period is not None or 0 <= k < m
            ),
            default=float(h),
        )
        count = 40 + ceil(20.0 / min(1.0, sqrt(nearest / float(h))))
        phi = self.pi * (np.arange(count) + 0.5) / count
        return (
            h * np.sin(0.5 * phi) ** 2,
            h * np.cos(0.5 * phi) ** 2,
            0.5 * h * self.pi / count * np.sin(phi),
        )

    def root(self, i: int, dl: Array, dr: Array) -> Array:
        """The value |X| at points of interval i.
        X^2 is the product of the factors x - e of all zone ends e.
        """
        return np.asarray(np.sqrt(np.prod(self._end_factors(i, dl, dr), axis=-1)))

    def poles(self, i: int, dl: Array, dr: Array) -> Array:
        """Inverses 1/factor (..., 2n) of the signed factors x - e of all zone ends e.
        The points x lie in interval i.

        With a period and an even number of zones they are cos(pi (x - e)/L)/factor, so that X times
        a pole is periodic.
        """
        factors = self._end_factors(i, dl, dr)
        with np.errstate(divide="ignore"):
            if self.period is None or len(self.zones) % 2:
                return np.asarray(
                    np.where(np.arange(2 * len(self.zones)) <= i, 1.0, -1.0) / factors
                )
            return np.asarray(np.cos(self._turn * (dl[..., None] + self._leftward[i])) / factors)

    def at_end(self, e: int) -> tuple[int, Any, Any]:
        """The zone end e as (interval number, distance from its left end, from its right end)."""
        zero = np.zeros(1, dtype=self.zones.dtype)
        if e + 1 < 2 * len(self.zones) or self.period is not None:
            return e, zero, self.steps[[e]]
        return e - 1, self.steps[[e - 1]], zero

    def end_factors(self) -> Array:
        """For every zone end e, the absolute value at e of the product of the factors of all other
        ends.
        """
        factors = np.array(
            [self._end_factors(*self.at_end(e))[0] for e in range(2 * len(self.zones))]
        )
        np.fill_diagonal(factors, 1.0)
        return np.asarray(np.prod(factors, axis=1))

    def magnitude(self, i: int, dl: Array, dr: Array) -> Array:
        """The value |X M| at points of interval i, not scaled to carry the load.
        X has its roots at zone ends, M has one root in each gap.
        """
        ends = self.root(i, dl, dr)
        return ends * np.abs(
            np.prod(self._factors(*self._root_distances(i, dl, dr, self.roots)), axis=-1)
        )

    def side(self, i: int, dl: Array, dr: Array) -> Array:
        """Sign of the slope of a gap: +1 left of the gap's widest point, -1 right of this point.

        The widest point is a root of M. The sign is -1 left of all zones and +1 right of all zones.
        """
        if i < 0:
            return np.full_like(dl, -1.0)
        return (
            np.where(dl < self.roots[self.gaps.index(i), 0], 1.0, -1.0)
            if i in self.gaps
            else np.ones_like(dl)
        )

    def locate(self, x: Array) -> tuple[Index, Array, Array]:
        """(number of the interval, distances from its left and right end) for every point x.

        The number is -1 left of all zones.
        """
        ends = self.zones.ravel()
        if self.period is not None:
            x = x - self.period * np.floor((x - ends[0]) / self.period)
        i = np.searchsorted(ends, x, side="right") - 1
        if self.period is not None:
            i = np.maximum(i, 0)  # round-off may put x below the first end
        dl = x - ends[np.maximum(i, 0)]
        right = np.append(ends[1:], np.nan if self.period is None else ends[0] + self.period)
        dr = np.where(i < 0, ends[0] - x, right[np.maximum(i, 0)] - x)
        # Rounding in the shift of x by whole periods may make a distance slightly negative.
        return i, np.where(dl < 0.0, 0.0, dl), np.where(dr < 0.0, 0.0, dr)
