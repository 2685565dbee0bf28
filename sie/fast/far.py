"""Far sums: what intervals do on other intervals far from them, by a tree and Chebyshev series, in time linear in their number.

Moments of what stands on an interval, the integrals of T_k over pi, go up the tree; series of the transform come down it
(L. Greengard and V. Rokhlin, J. Comput. Phys. 73 (1987) 325-348, in one dimension and with Chebyshev series in place of powers).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sie.basis import chebyshev
from sie.basis.interval import Outside
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.fast.panels import panels_of
from sie.fast.tree import TERMS, Tree, interactions

Array = NDArray[np.float64]

# Pairs handled at once: their powers stay in the cache.
_BLOCK = 512
_TWICE = np.array([1.0] + [2.0] * (TERMS - 1))
_ORDER = np.arange(TERMS)


def antiderivatives(s: Array) -> Array:
    """int_0^s T_k, k = 0 ... TERMS - 1, along a new last axis."""
    theta = np.arccos(np.clip(s, -1.0, 1.0))[..., None]
    up, down = _ORDER + 1, np.maximum(_ORDER - 1, 1)
    at_zero = np.cos(up * np.pi / 2) / (2 * up) - np.where(_ORDER > 1, np.cos((_ORDER - 1) * np.pi / 2) / (2 * down), 0.0)
    out = np.cos(up * theta) / (2 * up) - np.where(_ORDER > 1, np.cos((_ORDER - 1) * theta) / (2 * down), 0.0)
    out, at_zero = np.asarray(out), np.asarray(at_zero)
    out[..., 0] *= 2  # int T_0 = T_1
    at_zero[0] *= 2
    return np.asarray(out - at_zero)


@dataclass(frozen=True, eq=False)
class Nested:
    """A tree with what takes series from children to parents and back; kept: whether to keep it for the next sum."""

    tree: Tree
    kept: bool = True

    @cached_property
    def _place(self) -> tuple[Array, Array]:
        """(alpha, beta): a child's hull in its parent's variable."""
        tree = self.tree
        up = np.maximum(tree.parent, 0)
        width = np.maximum(tree.hi[up] - tree.lo[up], 1e-300)
        alpha = ((tree.lo - tree.lo[up]) - (tree.hi[up] - tree.hi)) / width
        return alpha, (tree.hi - tree.lo) / width

    @cached_property
    def _all(self) -> Array:
        return self._made(slice(0, len(self.tree)))

    def matrices(self, nodes: slice) -> Array:
        """A of these nodes, (n, TERMS, TERMS)."""
        return self._all[nodes] if self.kept else self._made(nodes)

    def _made(self, nodes: slice) -> Array:
        alpha, beta = self._place[0][nodes], self._place[1][nodes]
        a = np.zeros((len(alpha), TERMS, TERMS))
        a[:, 0, 0] = 1.0
        a[:, 1, 0], a[:, 1, 1] = alpha, beta
        alpha, beta = alpha[:, None], beta[:, None]
        for j in range(1, TERMS - 1):
            row, new = a[:, j], a[:, j + 1]
            new[:] = 2 * alpha * row - a[:, j - 1]
            new[:, 1:] += beta * row[:, :-1]
            new[:, 1] += beta[:, 0] * row[:, 0]
            new[:, :-1] += beta * row[:, 1:]
        return a

    @cached_property
    def rises(self) -> Array:
        """Potential at a node's middle less that at its parent's, from the parent's series: rises @ series."""
        tree = self.tree
        up = np.maximum(tree.parent, 0)
        return antiderivatives(self._place[0]) * tree.half[up][:, None]

    def _slices(self) -> list[slice]:
        levels = self.tree.levels
        return [slice(s, e) for s, e in zip(levels[1:-1], levels[2:], strict=True)]

    def upward(self, leaves: Array) -> Array:
        """Moments of all nodes (n, TERMS) from those of the intervals."""
        tree = self.tree
        out = np.zeros((len(tree), TERMS))
        out[tree.leaves] = leaves
        for here in reversed(self._slices()):
            moved = np.matmul(self.matrices(here), out[here, :, None])[..., 0]
            out[tree.parent[here][::2]] = moved[::2] + moved[1::2]
        return out

    def downward(self, series: Array, middle: Array) -> tuple[Array, Array, Array]:
        """Chebyshev series of the transform and potential at the middle (two words), of every interval, from those given at
        nodes."""
        tree = self.tree
        rest = np.zeros_like(middle)
        for here in self._slices():
            up = tree.parent[here]
            above = series[up]
            series[here] += np.matmul(above[:, None, :], self.matrices(here))[:, 0]
            added = middle[here] + np.einsum("nj,nj->n", self.rises[here], above) + rest[up]
            middle[here] = middle[up] + added
            # What the sum has lost (Knuth's two-sum).
            back = middle[here] - middle[up]
            rest[here] = (middle[up] - (middle[here] - back)) + (added - back)
        leaves = tree.leaves
        return series[leaves], middle[leaves], rest[leaves]


class FarSum:
    """What the far zones do on target intervals: (series of the transform, potential at the middle in two words)."""

    def __init__(self, sources: Nested, targets: Nested, kernel: Kernel) -> None:
        self.sources, self.targets, self.kernel = sources, targets, kernel
        s, t = sources.tree, targets.tree
        far, self.near = interactions(t, s, kernel.poles)
        self.far = far
        right = t.lo[far.target] > s.lo[far.source] + far.shift
        past = t.lo[far.target] - (s.hi[far.source] + far.shift)
        before = (s.lo[far.source] + far.shift) - t.hi[far.target]
        gap = np.where(right, past, before)
        half, width = s.half[far.source], t.half[far.target]
        nodes = chebyshev.gauss(TERMS)[:, None]
        sign = np.where(right, 1.0, -1.0)
        at_nodes = Outside(sign, (gap + width * (1 + np.where(right, nodes, -nodes))) / half)
        self.rho, self.front = at_nodes.rho, 1 / (at_nodes.root * half)
        at_middle = Outside(sign, (gap + width) / half)
        self.centre, self.log = at_middle.rho, at_middle.first(half / kernel.datum)
        self.to_series = chebyshev.t_matrix(TERMS, TERMS) * (2 / TERMS)
        self.to_series[:, 0] *= 0.5

    @cached_property
    def _regular(self) -> tuple[Array, Array] | None:
        """The regular part between the roots, on their nodes: (of the transform, of the potential at the middle); not that of a user's
        own, which has panels."""
        kernel = self.kernel
        if kernel.regular is None or not kernel.sure:
            return None
        assert kernel.regular_potential is not None
        s, t = self.sources.tree, self.targets.tree
        x = 0.5 * (t.lo[0] + t.hi[0]) + t.half[0] * chebyshev.gauss(TERMS)
        xi = 0.5 * (s.lo[0] + s.hi[0]) + s.half[0] * chebyshev.gauss(TERMS)
        from_moments = chebyshev.t_matrix(TERMS, TERMS) * _TWICE / TERMS
        values = self.to_series.T @ kernel.regular(x[:, None], xi) @ from_moments
        middle = kernel.regular_potential(np.array([0.5 * (t.lo[0] + t.hi[0])]), xi) @ from_moments
        return np.asarray(values), np.asarray(middle)

    def __call__(self, leaves: Array) -> tuple[Array, Array, Array]:
        moments = self.sources.upward(leaves)
        count = len(self.targets.tree)
        values, middle = np.zeros((count, TERMS)), np.zeros(count)
        moments_twice = np.ascontiguousarray((moments * _TWICE).T)
        for s in range(0, len(self.far), _BLOCK):
            here = slice(s, min(s + _BLOCK, len(self.far)))
            target, source = self.far.target[here], self.far.source[here]
            c = moments_twice[:, source]
            rho, centre = self.rho[:, here], self.centre[here]
            value = np.empty(rho.shape)
            value[:] = c[-1]
            potential = c[-1] / (TERMS - 1)
            for k in range(TERMS - 2, -1, -1):
                value *= rho
                value += c[k]
                potential = potential * centre
                if k:
                    potential += c[k] / k
            value *= self.front[:, here]
            first = np.flatnonzero(np.diff(target, prepend=-1))
            values[target[first]] += np.add.reduceat(value, first, axis=1).T
            middle[target[first]] += np.add.reduceat(c[0] * self.log[here] - potential, first)
        series = values @ self.to_series
        if self._regular is not None:
            series[0] += self._regular[0] @ moments[0]
            middle[0] += float(self._regular[1] @ moments[0])
        return self.targets.downward(series, middle)


def reaches(kernel: Kernel, zones: Zones) -> bool:
    """Whether far sums hold for the kernel: poles, and a regular part that is smooth across all zones."""
    if kernel.regular is None:
        return kernel.regular_potential is None
    if kernel.regular_potential is None:
        return False
    first, last = float(zones.a[0]), float(zones.b[-1])
    return kernel.reach >= last - first if kernel.sure else panels_of(kernel, first, last) is not None
