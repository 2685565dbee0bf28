"""Sums over the ends of many intervals of a function of the distance from there, at many places.

The line is cut into cells: between neighbouring ends, and halved where more than a few ends are
near. What ends do that are farther from a cell than its width is a short Chebyshev series on it,
made when a place in it is first met; the near ones are taken one by one.
"""

from collections.abc import Callable
from functools import cache, cached_property

import numpy as np
from numpy.polynomial import chebyshev

import sie
from sie import Array, Index, Mask, nearest_image, record, wrapped

# Terms of a series, of which the last are rounding where what is summed up is singular no nearer
# than a cell's width; ends that may be near a cell, halvings, and ends that are few enough to be
# taken one by one everywhere.
_TERMS = 20
_NEAR = 6
_HALVINGS = 40
_FEW = 16
# Pairs of places and ends handled at once.
_BLOCK = 2**15


@record
class Cells(sie.Kept):
    """of ends (e,), ascending, in one period if there is one; longest: of a cell."""

    ends: Array
    period: float | None
    longest: float

    @cached_property
    def edges(self) -> Array:
        """Where they begin, and where the last one ends."""
        ends = (
            self.ends if self.period is None else np.append(self.ends, self.ends[0] + self.period)
        )
        edges = np.unique(ends)
        for _ in range(_HALVINGS):
            long = np.diff(edges) > self.longest
            dense = np.flatnonzero(long | (self._is_near(edges).sum(axis=1) > _NEAR))
            middle = 0.5 * (edges[dense] + edges[dense + 1])
            # Ends next to one another have no place between them.
            middle = middle[(middle > edges[dense]) & (middle < edges[dense + 1])]
            if len(middle) == 0:
                break
            edges = np.sort(np.concatenate((edges, middle)))
        return np.asarray(edges)

    def _is_near(self, edges: Array) -> Mask:
        """Whether ends are no farther from cells than these are wide (cells, e)."""
        middle, half = 0.5 * (edges[1:] + edges[:-1])[:, None], 0.5 * np.diff(edges)[:, None]
        return np.asarray(np.abs(nearest_image(self.ends - middle, 0.0, self.period)) < 3.0 * half)

    @cached_property
    def near(self) -> tuple[Index, Index]:
        """(the ends near each cell, the first ones in each row, how many)."""
        near = self._is_near(self.edges)
        count = near.sum(axis=1)
        return np.argsort(~near, axis=1, kind="stable")[:, : int(count.max())], count

    def far(self, cells: Index) -> Mask:
        """The ends that are not near these cells (cells, e)."""
        far = np.ones((len(cells), len(self.ends)), dtype=bool)
        order, count = self.near
        row, k = np.nonzero(np.arange(order.shape[1]) < count[cells][:, None])
        far[row, order[cells[row], k]] = False
        return far


class EndSum:
    """sum_k weights_k function(x - ends_k), the weights of the two ends of an interval of opposite
    signs.
    """

    def __init__(self, cells: Cells, weights: Array, function: Callable[[Array], Array]) -> None:
        self._cells, self._weights, self._function = cells, weights, function
        self._series: Array | None = None
        self._made: Mask = np.zeros(0, dtype=bool)

    def __call__(self, x: Array) -> Array:
        x = np.asarray(x, dtype=float)
        cells, flat = self._cells, x.ravel()
        if len(cells.ends) <= _FEW:
            return self._one_by_one(flat).reshape(x.shape)
        place, out = wrapped(flat, float(cells.ends[0]), cells.period), np.empty(flat.size)
        within = (place >= cells.edges[0]) & (place < cells.edges[-1])
        inner = np.flatnonzero(within)
        out[~within] = self._one_by_one(flat[~within])
        block = _BLOCK // _NEAR
        for start in range(0, len(inner), block):
            here = inner[start : start + block]
            out[here] = self._inside(place[here], flat[here])
        return out.reshape(x.shape)

    def _inside(self, x: Array, given: Array) -> Array:
        """given: the places before they were moved by periods, which may round them."""
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
        """The series of all cells (_TERMS, cells), those of these ones made."""
        edges = self._cells.edges
        if self._series is None:
            self._series, self._made = (
                np.zeros((_TERMS, len(edges) - 1)),
                np.zeros(len(edges) - 1, dtype=bool),
            )
        new = cells[~self._made[cells]]
        t, to_series = _nodes()
        block = max(1, _BLOCK // (_TERMS * len(self._cells.ends)))
        for start in range(0, len(new), block):
            some = new[start : start + block]
            a, b = edges[some], edges[some + 1]
            # Distances from the beginning of a cell are not rounded as places are.
            lags = (a[:, None] - self._cells.ends)[:, None, :] + (0.5 * (b - a)[:, None] * (1 + t))[
                :, :, None
            ]
            weights = np.where(self._cells.far(some), self._weights, 0.0)
            # Of what is near nothing is taken, so that nothing there may be infinite.
            values = np.nan_to_num(self._function(lags))
            self._series[:, some] = to_series @ _paired(values * weights[:, None, :]).T
        self._made[new] = True
        return self._series

    def _one_by_one(self, x: Array) -> Array:
        out, block = np.zeros(len(x)), max(1, _BLOCK // max(1, len(self._cells.ends)))
        for start in range(0, len(x), block):
            out[start : start + block] = _paired(
                self._function(x[start : start + block, None] - self._cells.ends) * self._weights
            )
        return out


@cache
def _nodes() -> tuple[Array, Array]:
    """(places on (-1, 1), the matrix that makes a series of values there)."""
    t = chebyshev.chebpts1(_TERMS)
    return np.asarray(t), np.asarray(
        np.linalg.inv(chebyshev.chebvander(t, _TERMS - 1)), dtype=np.float64
    )


def _paired(values: Array) -> Array:
    """Sums over the last axis, both ends of an interval first: these all but cancel."""
    return np.asarray((values[..., ::2] + values[..., 1::2]).sum(axis=-1))
