"""Approximate inverse of a matrix with off-diagonal blocks of low rank, by recursive halving.

With A = [[A1, U1 V1'], [U2 V2', A2]] and W_i = A_i^-1 U_i, the solution of A x = b is
x1 = y1 - W1 s1, x2 = y2 - W2 s2, where y_i = A_i^-1 b_i, and s1 = V1' x2, s2 = V2' x1 solve a small
system (S. Ambikasaran and E. Darve, J. Sci. Comput. 57, 2013, 477-501). Low ranks come from
adaptive cross approximation with partial pivoting (M. Bebendorf, Numer. Math. 86, 2000, 565-589).

All blocks of one level are equally large and are treated together, as a stack of matrices.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import Array, Index, Mask

Entries = Callable[[Index, Index], Array]
"""entries(rows, columns) returns the matrix entries at the indices, which are broadcast."""


@dataclass(frozen=True)
class InverseOptions:
    """Options of the approximate inverse of a matrix by recursive halving."""

    # Largest number of rows of a diagonal block that is inverted directly, and largest rank of an
    # off-diagonal block.
    leaf_size: int = 64


_OPTIONS = InverseOptions()


class Inverse:
    """Approximate inverse of a matrix with `count` rows, from its entries.

    Its relative error is about `tolerance`.
    """

    def __init__(self, entries: Entries, count: int, tolerance: float) -> None:
        # The rows are cut into 2^depth leaves, which differ by at most one row. Shorter leaves are
        # padded with a row of the unit matrix, so that all are equally long.
        depth = max(0, math.ceil(math.log2(max(count, 1) / _OPTIONS.leaf_size)))
        first = np.arange(2**depth + 1) * count // 2**depth
        size = np.diff(first)
        place = np.arange(size.max())
        self.is_row = place < size[:, None]
        self.index = first[:-1, None] + np.minimum(place, size[:, None] - 1)
        # Explicit inverses of the leaves are faster to apply than LU factors. Their round-off is
        # far below `tolerance`.
        leaves = entries(self.index[:, :, None], self.index[:, None, :])
        both = self.is_row[:, :, None] & self.is_row[:, None, :]
        self.leaves = np.linalg.inv(np.where(both, leaves, np.eye(len(place))))
        # For each level, from the leaves to the root: V', W and the inverse of the small matrix.
        self.levels: list[tuple[Array, Array, Array]] = []
        for level in range(depth):
            nodes = 2 ** (depth - level)
            rows, is_row = self.index.reshape(nodes, -1), self.is_row.reshape(nodes, -1)
            u, v = cross_approximation(
                entries, (rows, is_row), (_siblings(rows), _siblings(is_row)), tolerance
            )
            w, of_sibling = self._solved(u), v.transpose(0, 2, 1)
            rank = u.shape[2]
            small = np.zeros((nodes // 2, 2, rank, 2, rank))
            small[:, 0, :, 1], small[:, 1, :, 0] = np.moveaxis(
                (of_sibling @ _siblings(w)).reshape(-1, 2, rank, rank), 1, 0
            )
            matrix = np.eye(2 * rank) + small.reshape(-1, 2 * rank, 2 * rank)
            self.levels.append((of_sibling, w, np.asarray(np.linalg.inv(matrix), dtype=float)))

    def __call__(self, b: Array) -> Array:
        """The product (n,) of the approximate inverse with the vector b (n,)."""
        padded = np.where(self.is_row, b[self.index], 0.0)
        return np.asarray(self._solved(padded[:, :, None])[self.is_row][:, 0])

    def _solved(self, b: Array) -> Array:
        """The inverses of the diagonal blocks of the highest level made so far, times a stack b.

        b: right sides of all rows, split into any number of blocks, (blocks, rows, columns).
        """
        shape, columns = b.shape, b.shape[2]
        y = self.leaves @ b.reshape(len(self.leaves), -1, columns)
        for of_sibling, w, small in self.levels:
            y = y.reshape(len(w), -1, columns)
            s = small @ (of_sibling @ _siblings(y)).reshape(len(small), -1, columns)
            y -= w @ s.reshape(len(w), -1, columns)
        return y.reshape(shape)


def _siblings(blocks: NDArray[Any]) -> NDArray[Any]:
    """A stack of blocks, in which neighbouring blocks 0 and 1, 2 and 3, ... change places."""
    pairs = blocks.reshape(-1, 2, *blocks.shape[1:])
    return np.asarray(pairs[:, ::-1].reshape(blocks.shape))


def cross_approximation(
    entries: Entries, rows: tuple[Index, Mask], columns: tuple[Index, Mask], tolerance: float
) -> tuple[Array, Array]:
    """(U, V) such that U V' approximates blocks of a matrix, by adaptive cross approximation.

    rows, columns: for each of n blocks, the indices of its rows (n, rows) or of its columns
    (n, columns), and a mask of those that count. The other rows and columns of U V' are zero.
    """
    (row, is_row), (column, is_column) = rows, columns
    most = min(_OPTIONS.leaf_size, row.shape[1], column.shape[1])
    u, v = np.zeros((*row.shape, most)), np.zeros((*column.shape, most))
    unused = is_row.copy()
    # The first pivot row is the row nearest to the columns of the block, since the entries vary
    # most in this row.
    last = is_row.sum(axis=1) - 1
    pivot = np.where(row[:, 0] < column[:, 0], last, 0)
    size, active = np.zeros(len(row)), np.arange(len(row))
    for k in range(most):
        unused[active, pivot] = False
        pivot_row = entries(row[active, pivot][:, None], column[active])
        pivot_row -= (v[active, :, :k] @ u[active, pivot, :k, None])[:, :, 0]
        pivot_row[~is_column[active]] = 0.0
        j = np.argmax(np.abs(pivot_row), axis=1)
        top = pivot_row[np.arange(len(active)), j]
        live = top != 0.0
        active, pivot_row, j, top = active[live], pivot_row[live], j[live], top[live]
        if len(active) == 0:
            return u[:, :, :k], v[:, :, :k]
        pivot_column = entries(row[active], column[active, j][:, None])
        pivot_column -= (u[active, :, :k] @ v[active, j, :k, None])[:, :, 0]
        pivot_column[~is_row[active]] = 0.0
        u[active, :, k], v[active, :, k] = pivot_column, pivot_row / top[:, None]
        new = np.linalg.norm(pivot_column, axis=1) * np.linalg.norm(v[active, :, k], axis=1)
        size[active] = np.maximum(size[active], new)
        goes_on = (new > tolerance * size[active]) & unused[active].any(axis=1)
        pivot = np.argmax(np.where(unused[active], np.abs(pivot_column), -1.0), axis=1)[goes_on]
        active = active[goes_on]
        if len(active) == 0:
            return u[:, :, : k + 1], v[:, :, : k + 1]
    return u, v
