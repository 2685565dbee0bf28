"""Tables of zones or intervals (n, 2) on a line that repeats: rows moved by whole periods, their widths kept."""

from __future__ import annotations

import numpy as np

from sie import Array


def begun_from(table: Array, start: float, period: float | None) -> Array:
    """Rows moved to begin in [start, start + period); as they are where nothing repeats."""
    return table if period is None else np.asarray(table - np.floor((table[:, :1] - start) / period) * period)


def centred_on(table: Array, centre: float, period: float | None) -> Array:
    """Rows moved to have their middles within half a period of a centre."""
    return table if period is None else np.asarray(table - np.round((table.mean(axis=1) - centre) / period)[:, None] * period)
