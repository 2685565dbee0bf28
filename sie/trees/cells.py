"""Cells of the line; on each, the field of all distant intervals is one Chebyshev series."""

import numpy as np

from sie.basis.data import Array


def cells_around(a: Array, b: Array, lo: float, hi: float) -> Array:
    """Ends of the cells: the intervals [a, b], and parts of the gaps between them.
    The intervals are in ascending order. The cells together cover the line from `lo` to `hi`.

    In a gap, each part is twice as long as the one before it, counted from an interval. This way
    few intervals are near any cell.
    """
    before = np.diff(np.concatenate(([2 * lo - a[0]], b[:-1], a)).reshape(2, -1), axis=0)[0]
    after = np.append(before[1:], 2 * (hi - b[-1]))
    ends, step = [np.array([lo, hi]), a, b], b - a
    while True:
        left, right = step < 0.5 * before, step < 0.5 * after
        if not (left.any() or right.any()):
            return np.sort(np.concatenate(ends))
        ends += [a[left] - step[left], b[right] + step[right]]
        step = 2 * step
