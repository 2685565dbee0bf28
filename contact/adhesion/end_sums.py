"""Fast sums over the ends of many intervals; each term depends on the distance from one end.

The line is divided into cells between neighbouring ends; a cell with more than a few ends near it
is halved. The sum over ends farther away than the width of a cell is a short Chebyshev series on
the cell, computed at the first evaluation there. Near ends are summed directly.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.polynomial import chebyshev

import sie
from contact.adhesion.options import LIMITS, MOVES
from contact.model.profiles.noise import EPS
from sie import Array, Index, Mask, nearest_image, record, wrapped


@dataclass(frozen=True)
class EndSumOptions:
    """Options of the sums over ends of intervals, and of the cells that divide the line."""

    # Largest number of interval ends closer to a cell than the cell's width. A cell with more such
    # ends is halved.
    near_ends: int = 6
    # Largest number of pairs of a point and an end that are evaluated together. It bounds the
    # memory.
    block: int = 2**15


_OPTIONS = EndSumOptions()


@record
class Cells(sie.Kept):
    """The cells into which the line between given ends of intervals is divided.

    ends: (e,), ascending, within one period if there is one; longest: largest width of a cell.
    """

    ends: Array
    period: float | None
    longest: float

    @cached_property
    def edges(self) -> Array:
        """The borders of the cells, ascending."""
        ends = (
            self.ends if self.period is None else np.append(self.ends, self.ends[0] + self.period)
        )
        edges = np.unique(ends)
        for _ in range(LIMITS.max_iterations):
            long = np.diff(edges) > self.longest
            dense = np.flatnonzero(long | (self._is_near(edges).sum(axis=1) > _OPTIONS.near_ends))
            middle = 0.5 * (edges[dense] + edges[dense + 1])
            # A cell between two neighbouring floating-point numbers cannot be halved.
            middle = middle[(middle > edges[dense]) & (middle < edges[dense + 1])]
            if len(middle) == 0:
                break
            edges = np.sort(np.concatenate((edges, middle)))
        return np.asarray(edges)

    def _is_near(self, edges: Array) -> Mask:
        """Mask (cells, e) of the ends whose distance from a cell is less than the cell's width."""
        middle, half = 0.5 * (edges[1:] + edges[:-1])[:, None], 0.5 * np.diff(edges)[:, None]
        return np.asarray(np.abs(nearest_image(self.ends - middle, 0.0, self.period)) < 3.0 * half)

    @cached_property
    def near(self) -> tuple[Index, Index]:
        """(indices of ends for each cell, near ends first; number of ends near each cell).
        An end is near a cell if its distance from the cell is less than the cell's width.
        """
        near = self._is_near(self.edges)
        count = near.sum(axis=1)
        return np.argsort(~near, axis=1, kind="stable")[:, : int(count.max())], count

    def far(self, cells: Index) -> Mask:
        """Mask (cells, e) of ends that are farther from the given cells than the cell's width."""
        far = np.ones((len(cells), len(self.ends)), dtype=bool)
        order, count = self.near
        row, k = np.nonzero(np.arange(order.shape[1]) < count[cells][:, None])
        far[row, order[cells[row], k]] = False
        return far


class EndSum:
    """The sum over all ends, sum_k weights_k function(x - ends_k), as a function of x.

    The two ends of an interval have weights of opposite signs, so they are added in pairs.
    """

    def __init__(self, cells: Cells, weights: Array, function: Callable[[Array], Array]) -> None:
        self._cells, self._weights, self._function = cells, weights, function
        self._series: Array | None = None
        self._made: Mask = np.zeros(0, dtype=bool)

    def __call__(self, x: Array) -> Array:
        x = np.asarray(x, dtype=float)
        cells, flat = self._cells, x.ravel()
        if len(cells.ends) <= 2 * MOVES.few_zones:
            return self._direct(flat).reshape(x.shape)
        place, out = wrapped(flat, float(cells.ends[0]), cells.period), np.empty(flat.size)
        within = (place >= cells.edges[0]) & (place < cells.edges[-1])
        inner = np.flatnonzero(within)
        out[~within] = self._direct(flat[~within])
        block = _OPTIONS.block // _OPTIONS.near_ends
        for start in range(0, len(inner), block):
            here = inner[start : start + block]
            out[here] = self._inside(place[here], flat[here])
        return out.reshape(x.shape)

    def _inside(self, x: Array, given: Array) -> Array:
        """The sum over all ends at each of the points x, which lie in cells.
        Near ends are added directly, far ends by the Chebyshev series of the cell.

        given: the same points before they were shifted by periods. The shift has rounded x.
        """
        edges, (near, count) = self._cells.edges, self._cells.near
        cell = np.searchsorted(edges, x, side="right") - 1
        series = self._of_cells(np.unique(cell))
        a, b = edges[cell], edges[cell + 1]
        out: Array = np.asarray(
            chebyshev.chebval(((x - a) - (b - x)) / (b - a), series[:, cell], tensor=False),
            dtype=np.float64,
        )
        for k in range(int(count[cell].max(initial=0))):
            has = count[cell] > k
            of = near[cell[has], k]
            out[has] += self._weights[of] * self._function(given[has] - self._cells.ends[of])
        return out

    def _of_cells(self, cells: Index) -> Array:
        """Chebyshev series (terms, all cells): on each cell, the sum over ends far from the cell.

        Series of the given cells are computed if they are missing.
        """
        edges, terms = self._cells.edges, _terms()
        if self._series is None:
            self._series = np.zeros((terms, len(edges) - 1))
            self._made = np.zeros(len(edges) - 1, dtype=bool)
        new = cells[~self._made[cells]]
        t, to_series = _nodes()
        block = max(1, _OPTIONS.block // (terms * len(self._cells.ends)))
        for start in range(0, len(new), block):
            some = new[start : start + block]
            a, b = edges[some], edges[some + 1]
            # A point's distance from an end is the sum of two distances: from the end to the cell's
            # left border, and from there to the point. This loses fewer digits than a difference of
            # coordinates.
            lags = (a[:, None] - self._cells.ends)[:, None, :] + (0.5 * (b - a)[:, None] * (1 + t))[
                :, :, None
            ]
            weights = np.where(self._cells.far(some), self._weights, 0.0)
            # Ends near the cell have weight 0. The function may be infinite at these ends, so
            # infinite values are replaced.
            values = np.nan_to_num(self._function(lags))
            self._series[:, some] = to_series @ _paired(values * weights[:, None, :]).T
        self._made[new] = True
        return self._series

    def _direct(self, x: Array) -> Array:
        """The sum over all ends at each of the points x, computed directly, without series."""
        out, block = np.zeros(len(x)), max(1, _OPTIONS.block // max(1, len(self._cells.ends)))
        for start in range(0, len(x), block):
            out[start : start + block] = _paired(
                self._function(x[start : start + block, None] - self._cells.ends) * self._weights
            )
        return out


@cache
def _terms() -> int:
    """Number of terms of each Chebyshev series; n terms leave an error of (3 + sqrt(8))^-n.

    The singularities of the summed function are a cell's width away from the cell.
    """
    return math.ceil(-math.log(EPS) / math.log(3.0 + math.sqrt(8.0)))


@cache
def _nodes() -> tuple[Array, Array]:
    """(Chebyshev points on (-1, 1), matrix from values at the points to a Chebyshev series)."""
    t = chebyshev.chebpts1(_terms())
    return np.asarray(t), np.asarray(
        np.linalg.inv(chebyshev.chebvander(t, _terms() - 1)), dtype=np.float64
    )


def _paired(values: Array) -> Array:
    """Sums over the last axis; pairs of neighbouring, nearly opposite terms are added first."""
    return np.asarray((values[..., ::2] + values[..., 1::2]).sum(axis=-1))
