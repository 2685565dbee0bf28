"""Tables of a smooth kernel that depends on the lag x - xi alone.

The range of the lag is divided into cells, and the kernel is a polynomial on each cell. If the
kernel's singularities are at least `length` away from the real axis, polynomials of degree 7 on
cells of width length/23 are exact to round-off. On such a cell, each coefficient of the Chebyshev
series is about 90 times smaller than the one before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import EPS, SUM_ROUNDING, Array, record
from sie.basis.kernels import Kernel, Regular
from sie.basis.sums import OPTIONS as BLOCKS


@dataclass(frozen=True)
class LagTableOptions:
    """Size of the table of a kernel that depends on the lag x - xi alone."""

    # Number of polynomial coefficients for each cell of the table.
    terms: int = 8

    @property
    def cells_per_length(self) -> float:
        """Number of cells in one `length` of the kernel, for a relative error of one round-off.

        With n cells in this length, each Chebyshev coefficient on a cell is 4 n times smaller than
        the one before.
        """
        return 0.25 * float(EPS ** (-1 / self.terms))


OPTIONS = LagTableOptions()


@record
class LagTable:
    """A kernel of the lag x - xi as polynomials on equal cells on both sides of the lag 0.

    step: width of a cell; cells: number of cells on either side. coefficients (terms, 2 cells):
    coefficients of powers of a coordinate that runs from -1 to 1 in each cell.
    """

    step: float
    cells: int
    coefficients: Array

    @classmethod
    def of(cls, function: Regular, reach: float, length: float) -> LagTable | None:
        """A table for lags x - xi from -reach to reach; None if no accurate table is possible.

        It is None if the kernel varies over less than its declared `length`, or the table would be
        too large.
        """
        step = length / OPTIONS.cells_per_length
        cells = math.ceil(reach / step)
        if 2 * cells > BLOCKS.memory_pairs:
            return None
        middles = step * (np.arange(-cells, cells) + 0.5)
        nodes = middles[:, None] + 0.5 * step * chebyshev.gauss(OPTIONS.terms)
        series = np.asarray(function(nodes, np.zeros(1))) @ chebyshev.to_series(OPTIONS.terms)
        powers = np.array(
            [np.pad(np.polynomial.chebyshev.cheb2poly(row), (0, k)) for row, k in _unit_series()]
        )
        table = cls(step, cells, np.ascontiguousarray((series @ powers).T))
        between = middles + 0.5 * step * np.cos(np.arange(len(middles)))
        error = np.abs(table(between) - np.asarray(function(between, np.zeros(1)))).max()
        # An error above this bound shows that the declared `length` of the kernel is wrong.
        return table if error <= OPTIONS.terms * SUM_ROUNDING * np.abs(series).max() else None

    def __call__(self, lag: Array) -> Array:
        """Values of the kernel at given lags x - xi, which are an array of any shape."""
        flat, out = lag.ravel(), np.empty(lag.size)
        for start in range(0, flat.size, BLOCKS.cache_pairs):
            # The place within the cell is computed before `cells` is added to the cell's number.
            # Otherwise digits would be lost near the lag 0.
            place = flat[start : start + BLOCKS.cache_pairs] / self.step
            cell = np.clip(np.floor(place), -self.cells, self.cells - 1)
            place = 2.0 * (place - cell) - 1.0
            index = cell.astype(np.intp) + self.cells
            total = self.coefficients[-1].take(index)
            for row in self.coefficients[-2::-1]:
                total *= place
                total += row.take(index)
            out[start : start + BLOCKS.cache_pairs] = total
        return out.reshape(lag.shape)


def _unit_series() -> list[tuple[Array, int]]:
    """Chebyshev coefficients of each polynomial T_k, k < `terms`, for a conversion to powers.
    Each item is (k zeros followed by a one, number of zeros that would follow the one).
    """
    return [
        (np.eye(OPTIONS.terms)[k][: k + 1], OPTIONS.terms - 1 - k) for k in range(OPTIONS.terms)
    ]


def regular_values(kernel: Kernel, x: Array, xi: Array, potential: bool = False) -> Array:
    """Regular part of the kernel (or of its potential) for points x (n,) and sources xi (q,).

    The shape is (n, q). A table of the lag is used if the kernel allows it and there are enough
    pairs.
    """
    function = kernel.regular_potential if potential else kernel.regular
    assert function is not None
    if (
        kernel.of_lag
        and math.isfinite(kernel.length)
        and not np.iscomplexobj(x)
        and len(x)
        and len(xi)
    ):
        reach = max(float(x.max() - xi.min()), float(xi.max() - x.min()), kernel.length)
        table = _table(kernel, potential, reach, len(x) * len(xi))
        if table is not None:
            return table(x[:, None] - xi)
    return np.asarray(function(x[:, None], xi))


def _table(kernel: Kernel, potential: bool, reach: float, pairs: int) -> LagTable | None:
    """Table of the kernel's regular part for |x - xi| <= `reach`; None if a table is not faster.

    It is None if making it would cost more than the direct evaluation of the pairs, or if there is
    no accurate table.
    """
    kept = kernel.kept_tables
    # The largest lag |x - xi| of the table is rounded up, so that the table can be used again after
    # zones have moved. With a period, the regular part is smooth up to lags of two periods, so that
    # the larger lag does no harm.
    key = potential, math.ceil(4 * math.log2(reach / kernel.length))
    if key not in kept:
        widest = kernel.length * 2.0 ** (key[1] / 4)
        if pairs < 2 * OPTIONS.terms * OPTIONS.cells_per_length * widest / kernel.length:
            return None
        function = kernel.regular_potential if potential else kernel.regular
        assert function is not None
        kept[key] = LagTable.of(function, widest, kernel.length)
    table: LagTable | None = kept[key]
    return table
