"""Fields that densities on intervals cause on far intervals, in linear time by a tree.

Moments of a density phi, (1/pi) int phi T_k dxi, are passed up the tree, from children to parents.
Chebyshev series of the transform are passed down it, from parents to children. See L. Greengard and
V. Rokhlin, J. Comput. Phys. 73, 1987, 325-348, here in one dimension and with Chebyshev series in
place of powers.
"""

from functools import cached_property, partial
from types import ModuleType
from typing import Any

import numpy as np

from sie.basis import chebyshev, compiled
from sie.basis.data import Array, Index, record, sum_error, widened
from sie.basis.interval import Outside
from sie.basis.kernels import Kernel
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.zones import Zones
from sie.trees.panels import panels_over
from sie.trees.tree import TERMS, Tree, interactions

# Factors of the moments of order k in a Chebyshev series: 1 for k = 0, and 2 for k > 0.
_TWICE = np.sign(np.arange(TERMS)) + np.ones(TERMS)


def antiderivatives(s: Array) -> Array:
    """Integrals of the Chebyshev polynomials T_k, k < TERMS, from 0 to s (n,): (n, TERMS).

    For k >= 2 the antiderivative is T_(k+1) / (2 (k+1)) - T_(k-1) / (2 (k-1)).
    """
    t = np.empty((TERMS + 1, len(s)))
    t[0], t[1] = 1.0, s
    for k in range(2, TERMS + 1):
        np.multiply(2 * s, t[k - 1], out=t[k])
        t[k] -= t[k - 2]
    t[::2] -= np.resize([1.0, -1.0], TERMS // 2 + 1)[:, None]
    order = np.arange(2, TERMS)[:, None]
    return np.concatenate(
        ([s, 0.5 * s * s], 0.5 / (order + 1) * t[3:] - 0.5 / (order - 1) * t[1:-2])
    ).T


@record
class Nested:
    """A tree with the matrices that carry moments up to parents and series down to children.

    kept: whether the matrices are stored for the next sum.
    """

    tree: Tree
    kept: bool = True

    @cached_property
    def _place(self) -> tuple[Array, Array]:
        """(alpha, beta) of each node, such that alpha + beta s is the variable of its parent.

        The variable s of a node runs from -1 to 1 on its hull.
        """
        tree = self.tree
        up = np.maximum(tree.parent, 0)
        width = np.maximum(tree.hi[up] - tree.lo[up], 1e-300)
        alpha = (
            ((tree.lo - tree.lo[up]) - (tree.hi[up] - tree.hi)) + tree.rest.sum(axis=0)
        ) / width
        return alpha, 2 * tree.half / width

    @cached_property
    def _all(self) -> Array:
        return self._made(slice(0, len(self.tree)))

    def matrices(self, nodes: slice) -> Array:
        """Matrices A that express a parent's Chebyshev polynomials by those of the given nodes.
        T_j(alpha + beta s) = sum_k A_jk T_k(s), where alpha + beta s is the parent's variable.

        The shape is (TERMS, TERMS, nodes), with j and k first.
        """
        return self._all[:, :, nodes] if self.kept else self._made(nodes)

    def _made(self, nodes: slice) -> Array:
        """The matrices A of `matrices`, by a recurrence over j for T_j(alpha + beta s)."""
        every = self._place[0][nodes], self._place[1][nodes]
        a = np.zeros((TERMS, TERMS, len(every[0])))
        a[0, 0], a[1, 0], a[1, 1] = 1.0, *every
        for start in range(0, len(every[0]), (SUMS.cache_pairs // TERMS)):
            here = slice(start, start + (SUMS.cache_pairs // TERMS))
            (alpha, beta), part = (one[here] for one in every), a[:, :, here]
            for j in range(1, TERMS - 1):
                row, new = part[j, : j + 1], part[j + 1, : j + 2]
                np.multiply(row, 2 * alpha, out=new[: j + 1])
                new[:j] -= part[j - 1, :j]
                moved = row * beta
                new[1:] += moved
                new[1] += moved[0]
                new[:j] += moved[1:]
        return a

    @cached_property
    def rises(self) -> Array:
        """Rise of the potential from a parent's middle to a child's middle, for each term.

        A term is one of the Chebyshev series of the transform on the parent. Row n holds the rises
        from the parent of node n to node n, for unit coefficients.
        """
        tree = self.tree
        up = np.maximum(tree.parent, 0)
        return antiderivatives(self._place[0]) * tree.half[up][:, None]

    def _slices(self) -> list[slice]:
        """Slices of the tree's nodes, each within one level of the tree (nodes of equal depth).

        A slice is the whole level if the matrices are stored, and else at most `SUMS.cache_pairs`
        nodes.
        """
        levels, most = self.tree.levels, len(self.tree) if self.kept else SUMS.cache_pairs
        bounds = zip(levels[1:-1], levels[2:], strict=True)
        return [
            slice(s, min(s + most, end)) for start, end in bounds for s in range(start, end, most)
        ]

    def upward(self, leaves: Array) -> Array:
        """Chebyshev moments of a density on all nodes of the tree, from those on the intervals.
        leaves: the moments on the intervals (n, terms).
        """
        tree, terms = self.tree, leaves.shape[1]
        out = np.zeros((terms, len(tree)))
        out[:, tree.leaves] = leaves.T
        for here in reversed(self._slices()):
            moved = np.einsum("jkn,kn->jn", self.matrices(here)[:terms, :terms], out[:, here])
            out[:, tree.parent[here][::2]] = moved[:, ::2] + moved[:, 1::2]
        return out.T

    def upward_by(self, loops: ModuleType, leaves: Array) -> Array:
        """Moments on all nodes, as `upward` gives them, by compiled loops without matrices."""
        moments = np.zeros((len(self.tree), leaves.shape[1]))
        moments[self.tree.leaves] = leaves
        loops.upward(self._structure, *self._place, moments)
        return moments

    def downward_by(
        self, loops: ModuleType, series: Array, middle: Array
    ) -> tuple[Array, Array, Array]:
        """Fields on every interval, as `downward` gives them, by compiled loops.
        The series have the shape (nodes, terms).
        """
        leaves, rest = self.tree.leaves, np.zeros_like(middle)
        loops.downward(self._structure, *self._place, self.rises, (series, middle, rest))
        return series[leaves], middle[leaves], rest[leaves]

    @cached_property
    def _structure(self) -> tuple[Index, Index]:
        return np.array(self.tree.levels), self.tree.parent

    def downward(self, series: Array, middle: Array) -> tuple[Array, Array, Array]:
        """Fields on every interval, each the sum of the fields given at the tree nodes around it.

        The result is (Chebyshev series of the transform (intervals, terms), potential at the
        middle, correction to be added to this potential). The correction is the potential's
        round-off.
        """
        tree, terms, leaves = self.tree, len(series), self.tree.leaves
        rest = np.zeros_like(middle)
        for here in self._slices():
            above = series[:, tree.parent[here]]
            series[:, here] += np.einsum("jn,jkn->kn", above, self.matrices(here)[:terms, :terms])
            # The round-off of each sum is kept in `rest` and added at the next level of the tree.
            up = tree.parent[here]
            before = middle[up]
            added = middle[here] + np.einsum("nj,jn->n", self.rises[here, :terms], above) + rest[up]
            middle[here], rest[here] = before + added, sum_error(before, added)
        return np.ascontiguousarray(series[:, leaves].T), middle[leaves], rest[leaves]


class FarSum:
    """Fast sum of the fields that source intervals cause on far target intervals.
    The result is a Chebyshev series of the transform, and the potential at the middle, for each
    target.

    near_terms: number of terms of a sum over near intervals that is computed together with each sum
    over far ones. The two sums together decide whether compiled loops are loaded.
    """

    def __init__(self, sources: Nested, targets: Nested, kernel: Kernel) -> None:
        self.sources, self.targets, self.kernel = sources, targets, kernel
        s, t = sources.tree, targets.tree
        far, self.near = interactions(t, s, kernel.poles)
        self.far = far
        self._right = t.lo[far.target] > s.lo[far.source] + far.shift
        past = (t.lo[far.target] - (s.hi[far.source] + far.shift)) + (
            t.rest[0, far.target] - s.rest[1, far.source]
        )
        before = ((s.lo[far.source] + far.shift) - t.hi[far.target]) + (
            s.rest[0, far.source] - t.rest[1, far.target]
        )
        self._gap = np.where(self._right, past, before)
        self._half, self._width = s.half[far.source], t.half[far.target]
        self._sign = np.where(self._right, 1.0, -1.0)
        at_middle = Outside(self._sign, (self._gap + self._width) / self._half)
        self.centre, self.log = at_middle.rho, at_middle.first(self._half / kernel.datum)
        self._nodes: dict[int, tuple[Array, Array]] = {}
        self.near_terms = 0

    @property
    def terms(self) -> int:
        """Number of terms of the sums over far and near intervals."""
        return len(self.far) * TERMS**2 + self.near_terms

    def _at(self, terms: int, here: slice = slice(None)) -> tuple[Array, Array]:
        """(rho, factor) at the Chebyshev nodes of each target, for the pairs of far nodes.
        The transform is the factor times a sum of powers of rho = z - sgn(z) sqrt(z^2 - 1).

        z: position of a node, measured from the source's middle in half widths of the source.
        """
        nodes, half = chebyshev.gauss(terms)[:, None], self._half[here]
        away = self._gap[here] + self._width[here] * (
            1 + np.where(self._right[here], nodes, -nodes)
        )
        seen = Outside(self._sign[here], away / half)
        return seen.rho, 1 / (seen.root * half)

    @cached_property
    def _regular(self) -> tuple[Array, Array] | None:
        """Matrix and row that give the fields of the kernel's regular part from moments.

        Both act on a density's moments at the root of the source tree. The matrix gives the
        transform at Chebyshev nodes of the root of the target tree, the row gives the potential at
        the middle of this root. A regular part given by the user is treated by panels instead, and
        the result is None.
        """
        kernel = self.kernel
        if kernel.regular is None or not kernel.sure:
            return None
        assert kernel.regular_potential is not None
        s, t = self.sources.tree, self.targets.tree
        x = 0.5 * (t.lo[0] + t.hi[0]) + t.half[0] * chebyshev.gauss(TERMS)
        xi = 0.5 * (s.lo[0] + s.hi[0]) + s.half[0] * chebyshev.gauss(TERMS)
        from_moments = chebyshev.t_matrix(TERMS, TERMS) * _TWICE / TERMS
        values = chebyshev.to_series(TERMS).T @ kernel.regular(x[:, None], xi) @ from_moments
        middle = kernel.regular_potential(np.array([0.5 * (t.lo[0] + t.hi[0])]), xi) @ from_moments
        return np.asarray(values), np.asarray(middle)

    def __call__(self, leaves: Array, rough: bool = False) -> tuple[Array, Array, Array]:
        """The far field on all targets, from the moments of all source intervals (n, TERMS).

        The result is that of `Nested.downward`. rough: whether half of the terms are enough. They
        give half of the digits, an error of 1e-7 of the sum, at a quarter of the time.
        """
        terms = TERMS // 2 if rough else TERMS
        loops = compiled.loops("tree_sums", self.terms, self.targets.kept)
        of = self._by_arrays if loops is None else partial(self._by_loops, loops)
        series, middle, rest = of(leaves[:, :terms])
        return widened(series, TERMS), middle, rest

    def _by_loops(self, loops: ModuleType, leaves: Array) -> tuple[Array, Array, Array]:
        terms, count = leaves.shape[1], len(self.targets.tree)
        moments = self.sources.upward_by(loops, leaves)
        doubled = moments * _TWICE[:terms]
        divided = doubled / np.maximum(np.arange(terms), 1)
        values, middle = np.zeros((count, terms)), np.zeros(count)
        compiled.in_threads(
            loops.far_fields,
            self._pairs[0] * terms**2,
            self._pairs,
            (doubled, divided),
            np.ascontiguousarray(chebyshev.gauss(terms)),
            (values, middle),
        )
        series = values @ chebyshev.to_series(terms)
        if self._regular is not None:
            series[0] += self._regular[0][:terms, :terms] @ moments[0]
            middle[0] += float(self._regular[1][:terms] @ moments[0])
        return self.targets.downward_by(loops, series, middle)

    @cached_property
    def _pairs(self) -> tuple[Any, ...]:
        """Data of the pairs of far nodes, sorted by target, for the compiled loop `far_fields`."""
        first = np.flatnonzero(np.diff(self.far.target, prepend=-1))
        return (
            np.append(first, len(self.far)),
            self.far.target[first],
            self.far.source,
            self._sign,
            self._gap,
            self._half,
            self._width,
            self.centre,
            self.log,
        )

    def _by_arrays(self, leaves: Array) -> tuple[Array, Array, Array]:
        terms = leaves.shape[1]
        # The data at the nodes of all pairs are stored only if the sum is computed several times.
        if self.targets.kept and terms not in self._nodes:
            self._nodes[terms] = self._at(terms)
        nodes = self._nodes.get(terms)
        moments = self.sources.upward(leaves)
        count = len(self.targets.tree)
        values, middle = np.zeros((terms, count)), np.zeros(count)
        moments_twice = np.ascontiguousarray((moments * _TWICE[:terms]).T)
        block = SUMS.cache_pairs // terms
        for s in range(0, len(self.far), block):
            here = slice(s, min(s + block, len(self.far)))
            target, source = self.far.target[here], self.far.source[here]
            c = moments_twice[:, source]
            centre = self.centre[here]
            rho, front = (
                self._at(terms, here) if nodes is None else (nodes[0][:, here], nodes[1][:, here])
            )
            value = np.empty(rho.shape)
            value[:] = c[-1]
            potential = c[-1] / (terms - 1)
            for k in range(terms - 2, -1, -1):
                value *= rho
                value += c[k]
                potential = potential * centre
                if k:
                    potential += c[k] / k
            value *= front
            first = np.flatnonzero(np.diff(target, prepend=-1))
            values[:, target[first]] += np.add.reduceat(value, first, axis=1)
            middle[target[first]] += np.add.reduceat(c[0] * self.log[here] - potential, first)
        series = chebyshev.to_series(terms).T @ values
        if self._regular is not None:
            series[:, 0] += self._regular[0][:terms, :terms] @ moments[0]
            middle[0] += float(self._regular[1][:terms] @ moments[0])
        return self.targets.downward(series, middle)


def reaches(kernel: Kernel, zones: Zones) -> bool:
    """Whether fast sums over all zones apply to the kernel.

    They apply if the kernel has no regular part, or if its regular part is smooth across all zones.
    """
    if kernel.regular is None:
        return kernel.regular_potential is None
    if kernel.sure:
        return kernel.regular_potential is not None and kernel.reach >= float(zones.b[-1]) - float(
            zones.a[0]
        )
    return panels_over(kernel, zones) is not None
