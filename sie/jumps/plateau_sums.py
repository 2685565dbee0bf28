"""Sums over many plateaus at many points, in linear time.

A plateau is an interval beside a zone, on which the density has a given constant value v. At the
lag y from its beginning and y' from its end, the plateau has the transform (v/pi) (ln|y| - ln|y'|)
for each pole of the kernel. The points lie in cells, which are intervals of the line. On each cell,
the transform of all distant plateaus is one Chebyshev series (`sie.trees.far`). The terms of the
few plateaus near a cell are added in closed form by a function of the caller, which may leave out
singular terms.
"""

from collections.abc import Callable

import numpy as np
from numpy.polynomial.chebyshev import chebint

from sie.basis.data import Array, Index, numbered
from sie.basis.kernels import Kernel
from sie.basis.sums import OPTIONS, stretches
from sie.trees.far import FarSum, Nested
from sie.trees.piecewise import clenshaw
from sie.trees.tree import TERMS, Tree

# Type of a function of pairs of a point and a near plateau: (cell of the point, its lags from the
# beginning and the end of the plateau (2, pairs), plateau, shift of the plateau). It returns the
# terms of the two ends (2, pairs), for the value pi of the density.
OfPairs = Callable[[Index, Array, Index, Array], Array]


class PlateauSums:
    """Transform and potential of plateaus, by Chebyshev series on cells of the line.

    plateaus: ends of the plateaus (m, 2), and the density on each (m,); a, b: left and right ends
    of the cells, ascending.
    """

    def __init__(self, plateaus: tuple[Array, Array], a: Array, b: Array, kernel: Kernel) -> None:
        table, values = plateaus
        order = np.argsort(table[:, 0], kind="stable")
        self.table, self.values, self.index = table[order], values[order] / np.pi, order
        self.a, self.half = a, 0.5 * (b - a)
        # These sums are computed on new zones in every step of Newton's method. So they count as
        # repeated sums (`kept`) in the decision to load the compiled loops.
        far = FarSum(Nested(Tree.over(*self.table.T)), Nested(Tree.over(a, b)), kernel)
        near = far.near
        self.source, self.shift = near.source, near.shift
        self.start = np.searchsorted(near.target, np.arange(len(a) + 1))
        # The integral of T_k over [-1, 1] is 2 / (1 - k^2) for even k, and 0 for odd k.
        k = np.arange(0.0, TERMS)
        moments = np.where(k % 2, 0.0, 2 / np.where(k % 2, 1.0, 1 - k * k))
        weight = 0.5 * np.diff(self.table, axis=1)[:, 0] * self.values
        series, value, rest = far(weight[:, None] * moments)
        potentials = chebint(series, axis=1) * self.half[:, None]
        potentials[:, 0] += value + rest
        self._series = {False: np.ascontiguousarray(series.T), True: potentials.T.copy()}

    def __call__(self, cell: Index, left: Array, near: OfPairs, potential: bool = False) -> Array:
        """Transform of all plateaus at points (n,), or the potential if `potential` is true.

        cell: cell of each point; left: distance of the point from the cell's left end.
        """
        out = np.empty(len(left))
        count = self.start[cell + 1] - self.start[cell]
        for here in stretches(count + 4, OPTIONS.memory_pairs):
            cells, each = cell[here], count[here]
            pair = numbered(each) + np.repeat(self.start[cells], each)
            source, shift = self.source[pair], self.shift[pair]
            row = np.repeat(np.arange(len(cells)), each)
            away = left[here][row] + ((self.a[cells][row] - shift) - self.table[source].T)
            begin, end = near(cells[row], away, self.index[source], shift)
            terms = np.bincount(row, self.values[source] * (begin - end), minlength=len(cells))
            half = self.half[cells]
            t = np.clip(left[here] / np.where(half > 0.0, half, 1.0) - 1.0, -1.0, 1.0)
            out[here] = clenshaw(self._series[potential], cells, t) + terms
        return out
