"""Sums over all zones in linear time: a tree over the zones, every node an equivalent zone.

What a zone does off it depends on the moments M_l = (1/pi) int phi T_l dxi of its density alone, M_0 = w c_0 and M_l = w c_l / 2, and
so does what a whole node of the tree does, with moments about its hull:

    transform  (sgn z / (R sqrt(z^2 - 1))) (M_0 + 2 sum M_l rho^l)         potential  M_0 log(R / (2 |rho|)) - 2 sum M_l rho^l / l

R its half width. Moments of children become those of their parent by T_j(alpha + beta s) = sum_k A_jk T_k(s), and the same A takes
the Chebyshev series of what is far from a parent to its children; the potential comes along as its value at the middle of each
node, since its derivative is the transform; it is summed in two words, for its differences between neighbours. So zones need no
nodes of their own: coefficients in, coefficients out. Only near zones see each other directly, by the closed forms of `assemble`.
Greengard & Rokhlin (1987), J. Comput. Phys. 73, 325-348, in one dimension and with Chebyshev series in place of powers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie import chebyshev, lazy
from sie.assemble import Layout
from sie.kernels import Kernel
from sie.tree import TERMS, Pairs, Tree, interactions
from sie.zones import Zones

Array = NDArray[np.float64]
Index = NDArray[np.intp]

# Pairs handled at once: their powers stay in the cache.
_BLOCK = 512
_TWICE = np.array([1.0] + [2.0] * (TERMS - 1))
_ORDER = np.arange(TERMS)
# Powers below e^-_VANISHED are left out of near sums.
_VANISHED = 40.0


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
        e = (gap + width * (1 + np.where(right, nodes, -nodes))) / half
        root = np.sqrt(e * (e + 2))
        sign = np.where(right, 1.0, -1.0)
        self.rho = sign / (1 + e + root)
        self.front = sign / (root * half)
        e = (gap + width) / half
        self.centre = sign / (1 + e + np.sqrt(e * (e + 2)))
        self.log = np.log(half / (2 * np.abs(self.centre) * kernel.datum))
        self.to_series = chebyshev.t_matrix(TERMS, TERMS) * (2 / TERMS)
        self.to_series[:, 0] *= 0.5

    @cached_property
    def _regular(self) -> tuple[Array, Array] | None:
        """The regular part between the roots, on their nodes: (of the transform, of the potential at the middle)."""
        kernel = self.kernel
        if kernel.regular is None:
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


@dataclass(frozen=True, eq=False)
class NearRows:
    """Sparse matrices of what near zones do: the transform at the inner Lobatto nodes of each solved zone, one zone after the
    other, and the potential at their middles."""

    transform: Any
    potential: Any

    @classmethod
    def of(cls, zones: Zones, kernel: Kernel, layout: Layout, pairs: Pairs) -> NearRows:
        solved = zones.solved
        other = ~((solved[pairs.target] == pairs.source) & (pairs.shift == 0.0))
        place, source, shift = pairs.target[other], pairs.source[other], pairs.shift[other]
        zone = solved[place]
        right = zones.middle[zone] > zones.middle[source] + shift
        sign = np.where(right, 1.0, -1.0)
        gap = np.where(right, zones.a[zone] - (zones.b[source] + shift), (zones.a[source] + shift) - zones.b[zone])
        half, width = zones.half[source], zones.half[zone]
        m = layout.m[zone]
        # The decay at the node nearest to the source tells how many powers are seen.
        e = (gap + width * np.array([chebyshev.lobatto(int(n))[1][min(1, n)] for n in range(int(m.max(initial=0)) + 1)])[m]) / half
        need = np.ceil(_VANISHED / np.arccosh(1 + e) / 8).astype(np.intp) * 8
        terms = np.minimum(layout.m[source] + 1, need)
        per_zone = np.bincount(place, terms, minlength=len(solved)).astype(np.intp)
        before = np.cumsum(terms) - terms
        start = np.concatenate(([0], np.cumsum(per_zone)))[place]
        in_row = before - start
        rows = layout.m[solved]
        pointer = np.concatenate(([0], np.cumsum(np.repeat(per_zone, rows))))
        first_row = np.concatenate(([0], np.cumsum(rows)))
        data, column = np.empty(pointer[-1]), np.empty(pointer[-1], dtype=np.int32)
        pot_data, pot_column = np.empty(int(per_zone.sum())), np.empty(int(per_zone.sum()), dtype=np.int32)
        key = m * (int(terms.max(initial=0)) + 1) + terms
        order = np.argsort(key, kind="stable")
        cuts = np.flatnonzero(np.diff(key[order], prepend=-1, append=-1))
        for lo, hi in zip(cuts[:-1], cuts[1:], strict=True):
            group = order[lo:hi]
            nodes, count = int(m[group[0]]), int(terms[group[0]])
            power = np.arange(count)
            columns = layout.offset[source[group]][:, None] + power
            e_middle = (gap[group] + width[group]) / half[group]
            rho = sign[group] / (1 + e_middle + np.sqrt(e_middle * (e_middle + 2)))
            values = -(rho[:, None] ** power) / np.maximum(power, 1)
            values[:, 0] = np.log(half[group] / (2 * np.abs(rho) * kernel.datum))
            at = before[group][:, None] + power
            pot_data[at], pot_column[at] = values * half[group][:, None], columns
            if nodes == 0:
                continue
            _, from_right, from_left = chebyshev.lobatto(nodes)
            away = np.where(right[group][:, None], from_left[1:-1], from_right[1:-1]) * width[group][:, None]
            e_nodes = (gap[group][:, None] + away) / half[group][:, None]
            root = np.sqrt(e_nodes * (e_nodes + 2))
            table = np.empty((len(group), nodes, count))
            table[..., 0] = sign[group][:, None] / root
            table[..., 1:] = (sign[group][:, None] / (1 + e_nodes + root))[..., None]
            np.cumprod(table, axis=2, out=table)
            row = first_row[place[group]][:, None] + np.arange(nodes)
            into = (pointer[row] + in_row[group][:, None])[..., None] + power
            data[into] = table
            column[into] = columns[:, None, :]
        sparse = lazy.scipy_sparse()
        size = layout.size
        potential_pointer = np.concatenate(([0], np.cumsum(per_zone)))
        return cls(
            sparse.csr_array((data, column, pointer), shape=(len(pointer) - 1, size)),
            sparse.csr_array((pot_data, pot_column, potential_pointer), shape=(len(solved), size)),
        )


class ZoneSums:
    """What all zones and images do on the solved zones, but for a zone's action on itself, as U coefficients and as the mean of
    the potential (weight 1 / sqrt(1 - t^2))."""

    def __init__(self, zones: Zones, kernel: Kernel, layout: Layout) -> None:
        self.zones, self.kernel, self.layout = zones, kernel, layout
        solved = zones.solved
        sources = Nested(Tree.over(zones.a, zones.b))
        targets = Nested(Tree.over(zones.a[solved], zones.b[solved])) if zones.symmetric else sources
        self.far = FarSum(sources, targets, kernel)
        self.near = NearRows.of(zones, kernel, layout, self.far.near)
        m = layout.m[solved]
        self.first_row = np.concatenate(([0], np.cumsum(m)))
        self.groups = [(int(n), np.flatnonzero(m == n)) for n in np.unique(m)]
        k = np.arange(TERMS)
        self.lead = np.where(k <= layout.m[:, None], layout.offset[:, None] + k, layout.size)
        self.scale = zones.half[:, None] * np.where(k, 0.5, 1.0)

    @property
    def size(self) -> int:
        """Closed forms evaluated in one sum."""
        return int(self.near.transform.nnz) + len(self.far.far) * TERMS

    def __call__(self, y: Array) -> tuple[Array, Array, Array]:
        """(U coefficients k = 1 ... m of every solved zone, one after the other; mean potential of each, in two words)."""
        zones, solved = self.zones, self.zones.solved
        leaves = np.append(y, 0.0)[self.lead] * self.scale
        series, middle, mean = self.far(leaves)
        mean = mean + self.near.potential @ y
        at_nodes = self.near.transform @ y
        far = 0.5 * series
        far[:, :-2] -= 0.5 * series[:, 2:]
        far[:, 0] += 0.5 * series[:, 0]
        rows = np.empty(len(at_nodes))
        for m, group in self.groups:
            if m == 0:
                continue
            place = self.first_row[group][:, None] + np.arange(m)
            u = chebyshev.u_coefficients(at_nodes[place])
            count = min(m, TERMS)
            u[:, :count] += far[group, :count]
            rows[place] = u
            # The primitive of U_{k-1} is T_k / k: its mean is 0, its value at the middle cos(k pi / 2) / k.
            k = np.arange(2, m + 1, 2)
            to_mean = -np.cos(0.5 * np.pi * k) / k
            mean[group] += zones.half[solved[group]] * (u[:, 1::2] @ to_mean)
        return rows, middle, mean


def reaches(kernel: Kernel, zones: Zones) -> bool:
    """Whether the sums of this module hold for the kernel: poles, and a regular part that is smooth across all zones."""
    if kernel.regular is None:
        return kernel.regular_potential is None
    return kernel.sure and kernel.regular_potential is not None and kernel.reach >= zones.b[-1] - zones.a[0]
