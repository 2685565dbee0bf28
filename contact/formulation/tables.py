"""Tables of zones or intervals (n, 2), ascending, on a line that may repeat: rows moved by whole periods, and what lies between them."""

from __future__ import annotations

import numpy as np

from sie import Array

# Of the widest gap.
_CLEARLY = 0.5


def begun_from(table: Array, start: float, period: float | None) -> Array:
    """Rows moved to begin in [start, start + period); as they are where nothing repeats."""
    return table if period is None else np.asarray(table - np.floor((table[:, :1] - start) / period) * period)


def centred_on(table: Array, centre: float, period: float | None) -> Array:
    """Rows moved to have their middles within half a period of a centre."""
    return table if period is None else np.asarray(table - np.round((table.mean(axis=1) - centre) / period)[:, None] * period)


def gaps_between(table: Array, period: float | None) -> Array:
    """The gap right of each row (n, 2), that of the last over the border of the period; where nothing repeats, without end."""
    return np.column_stack((table[:, 1], np.append(table[1:, 0], np.inf if period is None else table[0, 0] + period)))


def parted_at_widest(table: Array, period: float) -> Array:
    """Rows that begin right of the widest gap, as far as that is clearly wider than the one over the border, about where they were."""
    gaps = np.diff(gaps_between(table, period))[:, 0]
    if len(table) < 2 or gaps[-1] >= _CLEARLY * gaps.max():
        return table
    first = int(np.argmax(gaps)) + 1
    ahead, behind = table[first:], table[:first]
    centre = 0.5 * (table[0, 0] + table[-1, 1])
    middle = 0.5 * (table[first, 0] + table[first - 1, 1] + period)
    turn = period * np.round((middle - centre) / period)
    return np.concatenate((ahead - turn, behind + (period - turn)))
