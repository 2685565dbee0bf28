"""LU factors of a matrix, for one right side and for many."""

from __future__ import annotations

from dataclasses import field

import numpy as np
from scipy.linalg import lapack, lu_factor

from sie.basis.data import Array, Index, record
from sie.basis.sums import OPTIONS as SUMS


@record
class Factored:
    """LU factors of the matrix whose rows are the equation and the side conditions.

    size_of_rows: root of the sum of squares of each row's terms at the solution; last: the columns
    of the matrix for the last coefficient of each solved zone; rows: the matrix itself, kept only
    if moving ends have prescribed intensities, whose rates need it; reciprocal_condition: estimate
    of the reciprocal condition number of the matrix in the 1-norm, NaN if it was not estimated.
    """

    lu: Array
    pivots: Index
    size_of_rows: Array = field(default_factory=lambda: np.zeros(0))
    last: Array = field(default_factory=lambda: np.zeros((0, 0)), repr=False)
    rows: Array | None = field(default=None, repr=False)
    reciprocal_condition: float = np.nan

    @staticmethod
    def of(matrix: Array) -> Factored:
        return Factored(*lu_factor(matrix, check_finite=False))

    @property
    def size(self) -> int:
        return len(self.lu)

    def __call__(self, right: Array) -> Array:
        return self._solved(right, 0)

    def transposed(self, right: Array) -> Array:
        """The solution of the system with the transposed matrix, for one or several right sides."""
        return self._solved(right, 1)

    def _solved(self, right: Array, trans: int) -> Array:
        if right.size == 0:
            return np.zeros(right.shape)
        solve = lapack.zgetrs if np.iscomplexobj(self.lu) else lapack.dgetrs
        if right.ndim == 1 or right.size > SUMS.min_matrix_pairs:
            return np.asarray(solve(self.lu, self.pivots, right, trans)[0])
        # A few right sides are solved one by one. Solved together, they would make BLAS use several
        # threads. This would save no time, and the idle threads would spin for another 0.1 s.
        out = np.empty(right.shape, dtype=self.lu.dtype)
        for i, column in enumerate(right.T):
            out[:, i] = solve(self.lu, self.pivots, column, trans)[0]
        return out
