"""Tables of zones or intervals (n, 2), ascending, on a line that may repeat: rows moved by whole periods, and what lies between them."""

from __future__ import annotations

import numpy as np

from sie import Array


def begun_from(table: Array, start: float, period: float | None) -> Array:
    """Rows moved to begin in [start, start + period); as they are where nothing repeats."""
    return table if period is None else np.asarray(table - np.floor((table[:, :1] - start) / period) * period)


def centred_on(table: Array, centre: float, period: float | None) -> Array:
    """Rows moved to have their middles within half a period of a centre."""
    return table if period is None else np.asarray(table - np.round((table.mean(axis=1) - centre) / period)[:, None] * period)


def gaps_between(table: Array, period: float | None) -> Array:
    """The gap right of each row (n, 2), that of the last over the border of the period; where nothing repeats, without end."""
    return np.column_stack((table[:, 1], np.append(table[1:, 0], np.inf if period is None else table[0, 0] + period)))
