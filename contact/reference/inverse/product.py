"""The product X M of an inverse design, on the real line or around a period, from distances that
never cancel.

X^2 has one factor for each zone end, M one for each root, one root in every gap, placed so that
int_gap X M dx = 0. A factor is (x - e)/unit alone, 2 sin(pi (x - e)/L) with a period. Interval i
lies between end i and end i + 1: zones have even numbers, gaps odd ones; with a period the last gap
wraps around.
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

_NEWTON_STEPS = 60
_PI = "3.14159265358979323846264338327950288"


@dataclass(frozen=True, eq=False)
class CutProduct:
    """X M for zones (n, 2), ascending, within one period if there is one, in the precision of
    `zones`.

    Coefficients of the profile lose as many digits as there are zones to tell apart: what is
    rounded to double precision in the end is better made in a longer one.
    """

    zones: Array
    period: float | None = None

    def rounded(self) -> "CutProduct":
        """The same in double precision, with these roots."""
        other = CutProduct(self.zones.astype(float), self.period)
        other.__dict__["roots"] = self.roots.astype(float)
        return other

    @property
    def pi(self) -> Any:
        """pi in the precision of the zones."""
        return self.zones.dtype.type(_PI)

    @cached_property
    def _turn(self) -> Any:
        return self.pi / self.period

    @cached_property
    def steps(self) -> Array:
        """Lengths of the intervals."""
        ends = self.zones.ravel()
        steps = np.diff(ends)
        return steps if self.period is None else np.append(steps, ends[0] + self.period - ends[-1])

    @property
    def gaps(self) -> range:
        """Interval numbers of the gaps that hold a root of M."""
        return range(1, 2 * len(self.zones) - (self.period is None), 2)

    @cached_property
    def _unit(self) -> Any:
        """A quarter of the hull, its logarithmic capacity: products of many factors stay near one."""
        return 0.25 * (self.zones[-1, 1] - self.zones[0, 0])

    def _sum(self, first: int, last: int) -> Any:
        """Steps first .. last - 1 added up going right, around the period if needed: no
        subtraction.
        """
        if first <= last:
            return np.sum(self.steps[first:last])
        return np.sum(self.steps[first:]) + np.sum(self.steps[:last])

    @cached_property
    def _leftward(self) -> Array:
        """[i, j]: the way left from end i to end j; alone nan where there is none, and before the
        first end and behind the last.
        """
        m = 2 * len(self.zones)
        ways = np.array(
            [
                [self._sum(j, i) if self.period or j <= i else np.nan for j in range(m)]
                for i in range(m)
            ]
        )
        return ways if self.period else np.pad(ways, (0, 1), constant_values=np.nan)

    def _ways(self, i: int, dl: Array, dr: Array) -> tuple[Array, Array]:
        """Ways left and right to every end, (..., 2n), from points of interval i, `dl` from its
        left and `dr` from its right end.
        """
        m = 2 * len(self.zones)
        after = (i + 1) % m if self.period else i + 1
        return dl[..., None] + self._leftward[i, :m], dr[..., None] + self._leftward[:m, after]

    def _factors(self, left: Array, right: Array, positive_side: Mask) -> Array:
        """Signed factors (x - e)/unit or 2 sin(pi (x - e)/L), cut at e + L: e is `left` behind x,
        or `right` ahead.
        """
        if self.period is None:
            return np.where(positive_side, left, -right) / self._unit
        return 2.0 * np.sin(self._turn * np.minimum(left, right))

    def _end_factors(self, i: int, dl: Array, dr: Array) -> Array:
        """|factors| of all ends at points of interval i, (..., 2n)."""
        return np.abs(self._factors(*self._ways(i, dl, dr), np.arange(2 * len(self.zones)) <= i))

    def _root_distances(
        self, i: int, dl: Array, dr: Array, offsets: Array
    ) -> tuple[Array, Array, Mask]:
        """Ways left and right to all roots, (..., roots), and whether each lies behind; `offsets`
        (roots, 2) from the ends of their gaps. The way left to the root of the point's own gap
        carries the sign of x - r, that right is none.
        """
        gaps = np.array(self.gaps, dtype=int)
        left, right = self._ways(i, dl, dr)
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
        """Offsets (roots, 2) of the roots of M from the ends of their gaps: Newton on int_gap |X| M
        = 0.
        """
        gaps = list(self.gaps)
        width = self.steps[gaps]
        offsets = np.repeat(0.5 * width[:, None], 2, axis=1)
        nodes = [self.nodes(g) for g in gaps]
        samples = [
            (dl, dr, weight * self.root(g, dl, dr))
            for g, (dl, dr, weight) in zip(gaps, nodes, strict=True)
        ]
        for _ in range(_NEWTON_STEPS):
            rows = [
                self._gap_row(row, g, *at, offsets)
                for row, (g, at) in enumerate(zip(gaps, samples, strict=True))
            ]
            residual = np.array([r for r, _ in rows], dtype=float)
            jacobian = np.array([j for _, j in rows], dtype=float).reshape(len(gaps), len(gaps))
            step = -np.linalg.solve(jacobian, residual)
            # A root never leaves its gap: at most nine tenths of the way to the end it heads for.
            room = np.where(step > 0.0, offsets[:, 1], offsets[:, 0])
            step = np.sign(step) * np.minimum(np.abs(step), 0.9 * room)
            offsets = offsets + np.outer(step, [1.0, -1.0])
            if np.all(np.abs(step) <= 8.0 * np.finfo(width.dtype).eps * width):
                return offsets
        raise NotConverged("the roots of M of an inverse design did not converge")

    def _gap_row(
        self, row: int, g: int, dl: Array, dr: Array, weight: Array, offsets: Array
    ) -> tuple[Any, Array]:
        """int_gap |X| M of one gap and its derivatives by all roots, relative to int_gap |X M|."""
        left, right, behind = self._root_distances(g, dl, dr, offsets)
        factors = self._factors(left, right, behind)
        others = np.prod(np.delete(factors, row, axis=-1), axis=-1) * weight
        own = factors[:, row]
        with np.errstate(
            divide="ignore"
        ):  # a node on the gap's own root: that column is replaced below
            if self.period is None:
                logarithmic = 1.0 / np.where(behind, left, -right)
                own_slope = np.full_like(own, 1.0 / self._unit)
            else:
                turn = self._turn
                way = np.where(left < right, 1.0, -1.0)
                logarithmic = way * turn / np.tan(turn * np.minimum(left, right))
                own_slope = 2.0 * turn * np.cos(turn * left[:, row])
        scale = np.sum(np.abs(others * own))
        derivative = -(others * own) @ np.where(np.isfinite(logarithmic), logarithmic, 0.0) / scale
        derivative[row] = -np.sum(others * own_slope) / scale
        return np.sum(others * own) / scale, derivative

    def nodes(self, i: int) -> tuple[Any, Any, Any]:
        """Gauss-Chebyshev nodes of the first kind of interval i as angles' half sines: dl, dr,
        weights for int F dx, F ~ 1/sqrt or milder at the ends.

        The integrand is analytic up to the neighbouring ends, at a relative distance that sets the
        number of nodes.
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
        """|X| on interval i."""
        return np.asarray(np.sqrt(np.prod(self._end_factors(i, dl, dr), axis=-1)))

    def poles(self, i: int, dl: Array, dr: Array) -> Array:
        """1/factor of every end, signed, (..., 2n); with a period and an even number of zones
        cos/factor, so that X times it repeats.
        """
        factors = self._end_factors(i, dl, dr)
        with np.errstate(divide="ignore"):
            if self.period is None or len(self.zones) % 2:
                return np.asarray(
                    np.where(np.arange(2 * len(self.zones)) <= i, 1.0, -1.0) / factors
                )
            return np.asarray(np.cos(self._turn * (dl[..., None] + self._leftward[i])) / factors)

    def at_end(self, e: int) -> tuple[int, Any, Any]:
        """Interval and distances of the place of an end: in the interval to its right, or in that
        to its left where it is the last.
        """
        zero = np.zeros(1, dtype=self.zones.dtype)
        if e + 1 < 2 * len(self.zones) or self.period is not None:
            return e, zero, self.steps[[e]]
        return e - 1, self.steps[[e - 1]], zero

    def end_factors(self) -> Array:
        """|product of the factors of all other ends| at every end."""
        factors = np.array(
            [self._end_factors(*self.at_end(e))[0] for e in range(2 * len(self.zones))]
        )
        np.fill_diagonal(factors, 1.0)
        return np.asarray(np.prod(factors, axis=1))

    def magnitude(self, i: int, dl: Array, dr: Array) -> Array:
        """|X M| on interval i before scaling."""
        ends = self.root(i, dl, dr)
        return ends * np.abs(
            np.prod(self._factors(*self._root_distances(i, dl, dr, self.roots)), axis=-1)
        )

    def side(self, i: int, dl: Array, dr: Array) -> Array:
        """+1 where the gap grows with x: left of the root of M in a gap; right of all zones."""
        if i < 0:
            return np.full_like(dl, -1.0)
        return (
            np.where(dl < self.roots[self.gaps.index(i), 0], 1.0, -1.0)
            if i in self.gaps
            else np.ones_like(dl)
        )

    def locate(self, x: Array) -> tuple[Index, Array, Array]:
        """Interval of every point (-1: left of all zones) and its distances to the ends of it."""
        ends = self.zones.ravel()
        if self.period is not None:
            x = x - self.period * np.floor((x - ends[0]) / self.period)
        i = np.searchsorted(ends, x, side="right") - 1
        if self.period is not None:
            i = np.maximum(i, 0)  # a rounding below the first end
        dl = x - ends[np.maximum(i, 0)]
        beyond = np.append(ends[1:], np.nan if self.period is None else ends[0] + self.period)
        dr = np.where(i < 0, ends[0] - x, beyond[np.maximum(i, 0)] - x)
        # Moving by a period may leave a distance a rounding below zero.
        return i, np.where(dl < 0.0, 0.0, dl), np.where(dr < 0.0, 0.0, dr)
