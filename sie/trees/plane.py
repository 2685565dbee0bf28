"""Fields at points of the plane, summed over the nodes of a tree of intervals."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from sie.basis.data import Array, Index, Kept, record
from sie.basis.interval import Complex, InPlane, What, of_t, of_t_with_slope
from sie.basis.kernels import Kernel, Regular
from sie.basis.sums import OPTIONS as SUMS
from sie.trees.tree import SEPARATION, TERMS, Tree

# A point is far from a tree node (an interval) if the sum of its distances from the two ends of the
# node, divided by the node's half width, is at least this number. Such points lie on or outside an
# ellipse about the node. There |rho|, with rho = zeta - sqrt(zeta^2 - 1) and zeta = (z - middle) /
# half width, is so small that the first TERMS moments of the node give its field.
_FAR = 2 * (1 + SEPARATION)


@dataclass(frozen=True)
class PlaneOptions:
    """Options for transforms and potentials at complex points x + iy."""

    block: int = 1 << 15  # points at once; insensitive: 2^13 to 2^17 take the same time
    # Distance from the middle of all intervals, in periods, up to which the regular part of
    # Hilbert's kernel is a power series. The series converges up to 3/2.
    series_reach: float = 0.9
    # The coefficients of the power series follow from values on a circle of this radius, in
    # periods. At distances up to `series_reach`, the last terms of the series are round-off.
    circle: float = 1.2
    # Number of coefficients of the power series, from twice as many values on the circle.
    # (series_reach / circle)^128 is 1e-16, and the aliasing, (circle / 1.5)^256, is far smaller.
    terms: int = 128


OPTIONS = PlaneOptions()

# Type of a function of pairs of a point x + iy and an interval. For each pair, it returns the
# interval's fields at the point.
OfLeaves = Callable[[Array, Array, Index, Sequence[What]], list[Complex]]


def fields_of_tree(
    tree: Tree,
    series: Array,
    kernel: Kernel,
    points: tuple[Array, Array],
    whats: Sequence[What],
    leaf: OfLeaves,
) -> list[Complex]:
    """Fields at points x + iy due to the kernel's poles, one array for each of `whats`.

    For each point, nodes are split from the root down until they are far or are a single interval.

    series: first moments of each node, coefficients of T_l / sqrt(1 - t^2). leaf: function that
    returns the fields of near intervals.
    """

    def of(seen: InPlane, w: Array, node: Index) -> Sequence[Complex]:
        if tuple(whats) == ("transform", "derivative"):
            return of_t_with_slope(series, seen, w, node)
        return [of_t(series, seen, w, kernel.datum, node, what) for what in whats]

    x, y = points
    out = [np.zeros(len(x), dtype=complex) for _ in whats]
    for shift in kernel.poles:
        near_points, near_items = [], []
        for start in range(0, len(x), OPTIONS.block):
            point = np.arange(start, min(start + OPTIONS.block, len(x)))
            node = np.zeros(len(point), dtype=np.intp)
            while len(point):
                at, w = x[point] - shift, tree.half[node]
                seen = InPlane.of((at - tree.lo[node]) / w, (at - tree.hi[node]) / w, y[point] / w)
                far = np.abs(seen.left) + np.abs(seen.less) > _FAR
                some, here = seen[far], point[far]
                for total, value in zip(out, of(some, w[far], node[far]), strict=True):
                    np.add.at(total, here, value)
                leaves = ~far & (tree.item[node] >= 0)
                near_points.append(point[leaves])
                near_items.append(tree.item[node[leaves]])
                split = ~far & ~leaves
                point = np.repeat(point[split], 2)
                node = np.column_stack((tree.left[node[split]], tree.right[node[split]])).ravel()
        if not near_points:
            continue
        i, item = np.concatenate(near_points), np.concatenate(near_items)
        if len(i):
            for total, value in zip(out, leaf(x[i] - shift, y[i], item, whats), strict=True):
                np.add.at(total, i, value)
    return out


@record
class HilbertRest(Kept):
    """The part of a transform or potential that is due to the regular part of Hilbert's kernel.
    The regular part is the kernel without its three poles at 0 and +-L.

    middle: middle of all intervals; parts: nodes within half a period of `middle`, and weights,
    which represent the density.
    """

    kernel: Kernel
    middle: float
    parts: list[tuple[Array, Array]]

    def __call__(self, z: Complex, what: What) -> Complex:
        """The field `what` at points z, Im z >= 0, |Re z - `middle`| at most half a period."""
        period, regular = self.period, self.kernel.regular_of(what)
        assert regular is not None
        out, u = np.empty(len(z), dtype=complex), (z - self.middle) / period
        near = np.abs(u) < OPTIONS.series_reach
        scaled, total = u[near] / OPTIONS.circle, np.zeros(int(near.sum()), dtype=complex)
        if len(total):
            for coefficient in self._coefficients(what):
                total *= scaled
                total += coefficient
        out[near] = total
        # The other points z are far from the real line, so that subtracting the poles from the
        # whole kernel loses no digits.
        far = regular if what == "potential" else partial(_less_poles, period, what)
        out[~near] = self._summed(far, z[~near])
        return out

    @property
    def period(self) -> float:
        assert self.kernel.period is not None
        return self.kernel.period

    def _coefficients(self, what: What) -> list[complex]:
        """Coefficients of the power series of the field about the middle of all intervals.
        The highest power is first.
        """
        if what not in self._kept:
            count = 2 * OPTIONS.terms
            turns = np.arange(count) / count
            circle = self.period * OPTIONS.circle * np.exp(2j * np.pi * turns)
            regular = self.kernel.regular_of(what)
            assert regular is not None
            values = self._summed(regular, self.middle + circle)
            terms = np.fft.fft(values)[: OPTIONS.terms] / count
            self._kept[what] = terms[::-1].tolist()
        return self._kept[what]

    @cached_property
    def _kept(self) -> dict[What, list[complex]]:
        return {}

    def _summed(self, of: Regular, at: Complex) -> Complex:
        total = np.zeros(len(at), dtype=complex)
        for start in range(0, len(at), SUMS.cache_pairs // TERMS):
            here = slice(start, start + SUMS.cache_pairs // TERMS)
            for xi, weight in self.parts:
                total[here] += np.asarray(of(at[here, None], xi)) @ weight  # type: ignore[arg-type]
        return total


def _less_poles(period: float, what: What, at: Array, xi: Array) -> Array:
    """Hilbert's kernel without its poles at 0 and +-L, or its derivative, far from the line."""
    d = (at - xi) / period
    wave = np.exp(2j * np.pi * d)
    if what == "transform":
        whole = -1j * np.pi * (1 + 2 * wave / (1 - wave))
        return np.asarray((whole - 1 / d - 1 / (d - 1) - 1 / (d + 1)) / period)
    whole = 4 * np.pi**2 * wave / (1 - wave) ** 2
    return np.asarray((whole + 1 / d**2 + 1 / (d - 1) ** 2 + 1 / (d + 1) ** 2) / period**2)
