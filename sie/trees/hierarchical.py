"""Approximate inverse of a matrix with off-diagonal blocks of low rank, by recursive halving.

With A = [[A1, U1 V1'], [U2 V2', A2]], W1 = A1^-1 U1 and W2 = A2^-1 U2, the unknowns are x1 = y1 -
W1 s2 and x2 = y2 - W2 s1, where y_i = A_i^-1 b_i, and s2 = V1' x2, s1 = V2' x1 solve a small system
(S. Ambikasaran and E. Darve, J. Sci. Comput. 57, 2013, 477-501). Low ranks come from adaptive cross
approximation with partial pivoting (M. Bebendorf, Numer. Math. 86, 2000, 565-589).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sie.basis.data import Array, Index

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
    """Approximate inverse of the diagonal block [first, end) of a matrix, from its entries.

    Its relative error is about `tolerance`.
    """

    def __init__(self, entries: Entries, first: int, end: int, tolerance: float) -> None:
        self.count = end - first
        if self.count <= _OPTIONS.leaf_size:
            here = np.arange(first, end)
            # An explicit inverse is faster to apply than LU factors. Its round-off is far below
            # `tolerance`.
            self.inverse = np.linalg.inv(entries(here[:, None], here))
            self.halves: tuple[Inverse, Inverse] | None = None
            return
        cut = (first + end) // 2
        self.halves = Inverse(entries, first, cut, tolerance), Inverse(entries, cut, end, tolerance)
        one, two = np.arange(first, cut), np.arange(cut, end)
        u1, self.v1 = cross(entries, one, two, tolerance)
        u2, self.v2 = cross(entries, two, one, tolerance)
        self.w1, self.w2 = self.halves[0](u1), self.halves[1](u2)
        r1, r2 = u1.shape[1], u2.shape[1]
        small = np.eye(r1 + r2)
        small[:r1, r1:] = self.v1.T @ self.w2
        small[r1:, :r1] = self.v2.T @ self.w1
        self.small = np.linalg.inv(small)

    def __call__(self, b: Array) -> Array:
        """The product of the approximate inverse with b, (n,) or (n, k)."""
        if self.halves is None:
            return np.asarray(self.inverse @ b)
        one, two = self.halves
        y1, y2 = one(b[: one.count]), two(b[one.count :])
        s = self.small @ np.concatenate((self.v1.T @ y2, self.v2.T @ y1))
        rank = self.v1.shape[1]
        return np.concatenate((y1 - self.w1 @ s[:rank], y2 - self.w2 @ s[rank:]))


def cross(entries: Entries, rows: Index, columns: Index, tolerance: float) -> tuple[Array, Array]:
    """(U, V) such that U V' approximates a block of a matrix, by adaptive cross approximation."""
    u, v = np.zeros((len(rows), _OPTIONS.leaf_size)), np.zeros((len(columns), _OPTIONS.leaf_size))
    unused = np.ones(len(rows), dtype=bool)
    # The first pivot row is the row nearest to the columns of the block, since the entries vary
    # most in this row.
    pivot = len(rows) - 1 if rows[0] < columns[0] else 0
    size = 0.0
    for k in range(min(_OPTIONS.leaf_size, len(rows), len(columns))):
        unused[pivot] = False
        row = entries(rows[pivot], columns) - v[:, :k] @ u[pivot, :k]
        j = int(np.argmax(np.abs(row)))
        if row[j] == 0.0:
            return u[:, :k], v[:, :k]
        column = entries(rows, columns[j]) - u[:, :k] @ v[j, :k]
        u[:, k], v[:, k] = column, row / row[j]
        new = float(np.linalg.norm(column) * np.linalg.norm(v[:, k]))
        size = max(size, new)
        if new <= tolerance * size or not unused.any():
            return u[:, : k + 1], v[:, : k + 1]
        pivot = int(np.argmax(np.where(unused, np.abs(column), -1.0)))
    return u, v
