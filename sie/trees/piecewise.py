"""The transform of a piecewise quadratic function at many points, in linear time.

The transform is (1/pi) PV int f(xi) K(x - xi) dxi. A jump J of f'' at s adds the term
(J/2 pi) (x - s)^2 ln|x - s| to it. A jump of f' adds the term (J/pi) (x - s) ln|x - s|. The line is
cut into cells: the pieces of f, halved where more than a few jumps are near. On a cell the terms of
the near jumps are evaluated in closed form. The rest is analytic, and a Chebyshev series represents
it. The series is computed once, from a fast sum over the pieces (`sie.trees.far`) and from closed
forms of the pieces near the cell,

    int_-1^1 (p_0 + p_1 u + p_2 u^2) / (z - u) du
        = (p_0 + p_1 z + p_2 z^2) ln|(z + 1)/(z - 1)| - 2 p_1 - 2 p_2 z.

So no number is larger than f itself, whereas truncated powers of n jumps grow to n^2 times f.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sie.basis import chebyshev
from sie.basis.data import Array, Complex, Index, Kept, by_rows, record
from sie.basis.interval import Outside, What, complex_of
from sie.basis.kernels import Kernel, cauchy
from sie.basis.sums import OPTIONS as SUMS
from sie.trees.far import FarSum, Nested
from sie.trees.plane import HilbertRest, fields_of_tree
from sie.trees.tree import SEPARATION, TERMS, Tree


@dataclass(frozen=True)
class CellOptions:
    """Options of the cells into which the line is divided for a piecewise function."""

    # A cell is halved if more than `max_jumps` jumps are near the cell. It is also halved if two of
    # these jumps are closer together than `min_distance` of the cell's length. On a longer cell the
    # terms of these jumps would be much larger than the function f.
    max_jumps: int = 12
    min_distance: float = 0.2


_OPTIONS = CellOptions()


_WITH_SLOPE: tuple[What, What] = ("transform", "derivative")


class PiecewiseTransform:
    """The transform (1/pi) PV int f(xi) K(x - xi) dxi of a piecewise quadratic function f.
    K is the kernel, and f is continuous.

    f is p_0 + p_1 (xi - s_i) + p_2 (xi - s_i)^2 on the interval [s_i, s_i+1]. It is zero beyond the
    first and the last end.

    Parameters
    ----------
    kernel : Kernel
        The kernel of the transform.
    ends : array_like
        Ends s_i of the pieces (n + 1,), ascending. If the kernel has a period, they cover exactly
        one period, and f repeats.
    pieces : array_like
        The coefficients p of each piece (n, 3).
    at, jumps : array_like
        Distinct positions and heights (k,) of the jumps of f''; those of one period, if there is
        one.
    kinks : array_like or None
        Heights (k,) of the jumps of f' at the same positions; None if f' does not jump.

    Examples
    --------
    A quadratic B-spline on [0, 3]: f is symmetric about x = 1.5, so that its transform is zero
    there.

    >>> import numpy as np, sie
    >>> ends = np.array([0.0, 1.0, 2.0, 3.0])
    >>> pieces = [[0, 0, 0.5], [0.5, 1, -1], [0.5, -1, 0.5]]
    >>> jumps = [1.0, -3.0, 3.0, -1.0]
    >>> bump = sie.PiecewiseTransform(sie.cauchy(), ends, pieces, ends, jumps)
    >>> float(round(abs(bump(1.5)), 12))
    0.0
    """

    def __init__(
        self,
        kernel: Kernel,
        ends: ArrayLike,
        pieces: ArrayLike,
        at: ArrayLike,
        jumps: ArrayLike,
        kinks: ArrayLike | None = None,
    ) -> None:
        ends, pieces, at, jumps = (
            np.asarray(values, dtype=float) for values in (ends, pieces, at, jumps)
        )
        kinks = np.zeros(0) if kinks is None else np.asarray(kinks, dtype=float)
        self.kernel = kernel
        if kernel.period is not None:
            at = np.concatenate([at + shift for shift in (-kernel.period, 0.0, kernel.period)])
            jumps, kinks = np.tile(jumps, 3), np.tile(kinks, 3)
        order = np.argsort(at, kind="stable")
        self._at, self._jumps = at[order], jumps[order] / (2 * np.pi)
        self._kinks = kinks[order] / np.pi if len(kinks) else None
        self.ends = _cells(ends, self._at)
        self.half = 0.5 * np.diff(self.ends)
        # Jumps within `SEPARATION` half lengths of a cell are evaluated in closed form. A series of
        # TERMS terms resolves the effect of all other jumps.
        reach = SEPARATION * self.half
        self._first = np.searchsorted(self._at, self.ends[:-1] - reach)
        self._count = np.searchsorted(self._at, self.ends[1:] + reach, side="right") - self._first
        self._pieces = ends, pieces

    def __len__(self) -> int:
        return len(self.half)

    @property
    def most_near(self) -> int:
        """Largest number of jumps that are evaluated in closed form at one point."""
        return int(self._count.max())

    @cached_property
    def _series(self) -> Array:
        """Chebyshev coefficients (TERMS, cells) of the transform on each cell, without some terms.
        The terms of jumps near the cell are left out, because they are evaluated in closed form.
        """
        ends, pieces = self._pieces
        a, w = self.ends[:-1], self.half
        piece = np.minimum(np.searchsorted(ends, a, side="right") - 1, len(pieces) - 1)
        # The polynomials are expressed in the variable u, which goes from -1 to 1 on each cell.
        p, start = pieces[piece], (a - ends[piece]) + w
        local = np.column_stack(
            (
                p[:, 0] + start * (p[:, 1] + start * p[:, 2]),
                (p[:, 1] + 2 * start * p[:, 2]) * w,
                p[:, 2] * w * w,
            )
        )
        moments = (local @ _monomials()) * (w / np.pi)[:, None]
        tree = Nested(Tree.over(a, self.ends[1:]), kept=False)
        far = FarSum(tree, tree, self.kernel)
        series = far(moments)[0]
        near, (left, right) = far.near, chebyshev.gauss_sides(TERMS)
        values = np.zeros((len(w), TERMS))
        for s in range(0, len(near), SUMS.cache_pairs):
            here = slice(s, s + SUMS.cache_pairs)
            found = self._from(
                near.target[here], near.source[here], near.shift[here], local, moments
            )
            np.add.at(values, near.target[here], found)
        cells = np.arange(len(w))
        for s in range(0, len(w), SUMS.cache_pairs):
            some = cells[s : s + SUMS.cache_pairs, None]
            values[some[:, 0]] -= self._near(some, w[some] * left, w[some] * right)
        return np.ascontiguousarray((series + values @ chebyshev.to_series(TERMS)).T)

    def _from(
        self, target: Index, source: Index, shift: Array, local: Array, moments: Array
    ) -> Array:
        """Transform of f on the cells `source`, at nodes of the cells `target` (pairs, nodes)."""
        left, right = chebyshev.gauss_sides(TERMS)
        a, b, w = self.ends[:-1], self.ends[1:], self.half
        after = (a[target] + b[target]) >= (a[source] + b[source]) + 2 * shift
        own = (target == source) & (shift == 0.0)
        wide, size = w[target][:, None], w[source][:, None]
        # `outside` is the distance of each node of the target from the nearer end of the source,
        # divided by the half width of the source. It is the sum of two distances: the gap between
        # the two cells, and the node's distance from the nearer end of the target.
        past_b = (a[target] - (b[source] + shift))[:, None] + wide * left
        before_a = ((a[source] + shift) - b[target])[:, None] + wide * right
        outside = np.where(after[:, None], past_b, before_a) / size
        outside[own] = 0.0
        sign = np.where(after, 1.0, -1.0)[:, None]
        z = np.where(own[:, None], 0.5 * (left - right), sign * (1 + outside))
        ratio = np.where(
            own[:, None], left / right, (2 + outside) / np.where(own[:, None], 1.0, outside)
        )
        log = np.where(own[:, None], 1.0, sign) * np.log(ratio)
        p = local[source].T[:, :, None]
        out = ((p[0] + z * (p[1] + z * p[2])) * log - 2 * (p[1] + p[2] * z)) / np.pi
        # Far from a cell, the closed form of its field suffers from cancellation. There the cell's
        # moments are used instead.
        distant = np.flatnonzero(outside.min(axis=1) > SEPARATION)
        if len(distant):
            e, m = outside[distant], moments[source[distant]]
            seen = Outside(sign[distant], e)
            total = np.zeros(e.shape)
            for k in range(TERMS - 1, 0, -1):
                total = (total + 2 * m[:, k, None]) * seen.rho
            out[distant] = (total + m[:, :1]) / (seen.root * size[distant])
        return np.asarray(out)

    def _near(self, cell: Index, from_left: Array, from_right: Array) -> Array:
        """Sum at each point of the closed forms of the jumps near the point's cell.

        Points are given by their cells and their distances from both ends of the cells.
        """
        shape = np.broadcast_shapes(cell.shape, from_left.shape)
        cell, x = np.broadcast_to(cell, shape).ravel(), np.broadcast_to(from_left, shape).ravel()
        from_right = np.broadcast_to(from_right, shape).ravel()
        total, count = np.zeros(len(x)), self._count[cell]
        for k in range(int(count.max(initial=0))):
            here = slice(None) if count.min() > k else np.flatnonzero(count > k)
            of = cell[here]
            jump = self._first[of] + k
            s = self._at[jump]
            away = np.where(
                s <= self.ends[of],
                x[here] + (self.ends[of] - s),
                (self.ends[of + 1] - s) - from_right[here],
            )
            size = np.abs(away) / self.half[of]
            weight = self._jumps[jump] * away
            if self._kinks is not None:
                weight += self._kinks[jump]
            total[here] += weight * away * np.log(np.where(size == 0, 1.0, size))
        return total.reshape(shape)

    def __call__(self, x: ArrayLike) -> Array:
        """The transform of f at points between the first and the last end of the pieces."""
        x = np.asarray(x, dtype=float)
        return np.reshape(by_rows(self._at_points, x.ravel(), max_rows=SUMS.cache_pairs), x.shape)

    def in_plane(self, z: Complex) -> tuple[Complex, Complex]:
        """The transform of f and its derivative at points z (n,) with Im z >= 0.

        With a period, the points lie within half a period of the middle of the pieces.
        """
        plane, whats = self._plane, _WITH_SLOPE
        value, slope = fields_of_tree(
            plane.tree, plane.series, self.kernel, (z.real, z.imag), whats, plane.of_pieces
        )
        if self.kernel.regular is None:
            return value, slope
        rest = self._rest
        return value + rest(z, "transform"), slope + rest(z, "derivative")

    @cached_property
    def _rest(self) -> HilbertRest:
        tree = self._plane.tree
        middle = 0.5 * float(tree.lo[0] + tree.hi[0])
        return HilbertRest(self.kernel, middle, [self._plane.nodes])

    @cached_property
    def _plane(self) -> "PiecesInPlane":
        return PiecesInPlane.of(*self._pieces)

    def _at_points(self, x: Array) -> Array:
        cell = np.clip(np.searchsorted(self.ends, x, side="right") - 1, 0, len(self) - 1)
        left, right = x - self.ends[cell], self.ends[cell + 1] - x
        return np.asarray(
            clenshaw(self._series, cell, 0.5 * (left - right) / self.half[cell])
            + self._near(cell, left, right)
        )


@record
class PiecesInPlane(Kept):
    """The pieces of a piecewise quadratic function, as sources of fields at complex points.

    tree: over the pieces. series: the first TERMS moments of each node of the tree, as coefficients
    of T_l / sqrt(1 - t^2). local: coefficients of each piece in the variable u, which goes from -1
    to 1.
    """

    tree: Tree
    series: Array
    local: Array

    @classmethod
    def of(cls, ends: Array, pieces: Array) -> "PiecesInPlane":
        tree, w = Tree.over(ends[:-1], ends[1:]), 0.5 * np.diff(ends)
        p, q, r = pieces.T
        local = np.column_stack((p + w * (q + w * r), (q + 2 * w * r) * w, r * w * w))
        twice = np.where(np.arange(TERMS), 2.0, 1.0)
        moments = Nested(tree, kept=False).upward((local @ _monomials()) * (w / np.pi)[:, None])
        return cls(tree, moments * twice / tree.half[:, None], local)

    def field(self, z: Complex, what: What) -> Complex:
        """Transform (1/pi) int f / (z - xi) dxi or its derivative at points z (n,), Im z >= 0."""
        points = (z.real, z.imag)
        return fields_of_tree(self.tree, self.series, cauchy(), points, (what,), self.of_pieces)[0]

    def of_pieces(self, x: Array, y: Array, piece: Index, whats: Sequence[What]) -> list[Complex]:
        """Transform of one piece, or the transform's derivative, at each point x + i y.
        piece: for each point, the index of this piece.
        """
        leaf = self.tree.leaves[piece]
        w = self.tree.half[leaf]
        left = complex_of((x - self.tree.lo[leaf]) / w, y / w)
        right = complex_of((x - self.tree.hi[leaf]) / w, y / w)
        p, q, r = self.local[piece].T
        z = np.where(np.abs(left) < np.abs(right), left - 1, right + 1)
        value, bend = p + z * (q + z * r), q + 2 * z * r
        # The infinite logarithm at an end of a piece is replaced by 0. The infinite terms of the
        # two adjacent pieces cancel, since f is continuous.
        log = np.log(np.where(left == 0, 1.0, left)) - np.log(np.where(right == 0, 1.0, right))
        fields = []
        for what in whats:
            if what == "transform":
                fields.append(np.asarray((value * log - 2 * (q + z * r)) / np.pi))
            else:
                with np.errstate(divide="ignore", invalid="ignore"):
                    rate = bend * log + value * (1 / left - 1 / right) - 2 * r
                fields.append(np.asarray(rate / (np.pi * w)))
        return fields

    @cached_property
    def nodes(self) -> tuple[Array, Array]:
        """Nodes over all pieces, and weights that reproduce the first moments of f / pi."""
        tree = self.tree
        xi = 0.5 * (tree.lo[0] + tree.hi[0]) + tree.half[0] * chebyshev.gauss(TERMS)
        weights = chebyshev.t_matrix(TERMS, TERMS) @ self.series[0] * (tree.half[0] / TERMS)
        return xi, np.asarray(weights)


def clenshaw(table: Array, cell: Index, t: Array) -> Array:
    """Sum over k of table[k, cell] T_k(t) at each point, by Clenshaw's recurrence.
    cell: the table's column for each point.
    """
    out = np.empty(len(t))
    for start in range(0, len(t), SUMS.cache_pairs):
        here = slice(start, start + SUMS.cache_pairs)
        of, x = cell[here], t[here]
        twice, one, two, new = 2 * x, np.zeros(len(x)), np.zeros(len(x)), np.empty(len(x))
        for row in table[:0:-1]:
            np.multiply(twice, one, out=new)
            new += row[of]
            new -= two
            one, two, new = new, one, two
        out[here] = table[0][of] + x * one - two
    return out


def _cells(ends: Array, at: Array) -> Array:
    """Ends of the cells: the intervals of `ends`, halved until each has few jumps `at` nearby."""
    between = np.append(np.diff(at), np.inf)
    while True:
        length = np.diff(ends)
        reach = 0.5 * SEPARATION * length
        first = np.searchsorted(at, ends[:-1] - reach)
        near = np.searchsorted(at, ends[1:] + reach, side="right") - first
        dense = near > _OPTIONS.max_jumps
        for k in range(_OPTIONS.max_jumps - 1):
            of = np.flatnonzero((near > k + 1) & ~dense)
            dense[of[between[first[of] + k] < _OPTIONS.min_distance * length[of]]] = True
        many = np.flatnonzero(dense)
        if len(many) == 0:
            return ends
        ends = np.insert(ends, many + 1, 0.5 * (ends[many] + ends[many + 1]))


def _monomials() -> Array:
    """Integrals of u^j T_k(u) from -1 to 1 for j = 0, 1, 2 (3, TERMS)."""
    u, weight = np.polynomial.legendre.leggauss(TERMS)
    table = np.cos(np.arccos(u)[:, None] * np.arange(TERMS))
    return np.asarray(np.array([weight, weight * u, weight * u * u]) @ table)
