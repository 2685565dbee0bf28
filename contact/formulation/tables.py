"""Operations on tables of intervals (n, 2), ascending, on a line that may be periodic."""

import numpy as np

from sie import Array, Index, Mask


def begun_from(table: Array, start: float, period: float | None) -> Array:
    """Intervals moved by whole periods so that they begin in [start, start + period)."""
    return (
        table
        if period is None
        else np.asarray(table - np.floor((table[:, :1] - start) / period) * period)
    )


def ascending(table: Array) -> Array:
    """Intervals sorted from left to right."""
    return np.asarray(table[np.argsort(table[:, 0])])


def in_cell(table: Array, start: float, period: float | None) -> Array:
    """Intervals moved to begin in [start, start + period), sorted from left to right."""
    return ascending(begun_from(table, start, period))


def centred_on(table: Array, centre: float, period: float | None) -> Array:
    """Intervals moved by whole periods so that their middles are nearest to a centre."""
    return (
        table
        if period is None
        else np.asarray(table - np.round((table.mean(axis=1) - centre) / period)[:, None] * period)
    )


def outward(before: Array, after: Array) -> Array:
    """Outward displacements of interval ends between two tables: left, then right ends (2n,)."""
    return np.concatenate((before[:, 0] - after[:, 0], after[:, 1] - before[:, 1]))


def located(table: Array, x: Array) -> tuple[Index, Mask]:
    """Index of the last interval that begins at or before x, and whether it contains x.

    Places before all rows get row 0.
    """
    row = np.maximum(np.searchsorted(table[:, 0], x, side="right") - 1, 0)
    return row, np.asarray((x > table[row, 0]) & (x < table[row, 1]))


def gaps_between(table: Array, period: float | None) -> Array:
    """The gap between each interval and the next one to the right (n, 2).

    The last gap crosses the border of the period, or is infinite without a period.
    """
    return np.column_stack(
        (table[:, 1], np.append(table[1:, 0], np.inf if period is None else table[0, 0] + period))
    )


def room_beside(table: Array, period: float | None) -> Array:
    """For each end (n, 2), the width of its interval or of its adjacent gap, whichever is less."""
    right = np.diff(gaps_between(table, period))
    return np.minimum(np.diff(table), np.column_stack((np.roll(right, 1), right)))


def parted_at_wide(table: Array, period: float, wide_fraction: float = 0.1) -> Array:
    """Intervals moved by whole periods so that a wide gap lies over the period's border.

    A gap is wide if it exceeds `wide_fraction` of the widest gap. The wide gap nearest to the
    border is taken, so that few rows move.
    """
    gaps = gaps_between(table, period)
    width = gaps[:, 1] - gaps[:, 0]
    wide = width >= wide_fraction * width.max()
    if len(table) < 2 or wide[-1]:
        return table
    middle = gaps.mean(axis=1)
    last = int(
        np.flatnonzero(wide)[
            np.argmin(np.minimum(middle - table[0, 0], table[-1, 1] - middle)[wide])
        ]
    )
    ahead, behind = table[last + 1 :], table[: last + 1]
    few_behind = middle[last] - table[0, 0] < table[-1, 1] - middle[last]
    return np.concatenate((ahead, behind + period) if few_behind else (ahead - period, behind))


def joined_where(table: Array, meets: Mask) -> Array:
    """The intervals; interval i and the next one are joined if `meets[i]` is True (n - 1,)."""
    return np.column_stack((table[np.append(True, ~meets), 0], table[np.append(~meets, True), 1]))


def united(table: Array) -> Array:
    """The union of the intervals, in which overlapping intervals are joined."""
    table = table[np.argsort(table[:, 0], kind="stable")]
    # A part of the union begins where an interval starts to the right of all earlier intervals.
    # `reach`: the largest right end of each interval and all earlier ones.
    reach = np.maximum.accumulate(table[:, 1])
    return joined_where(np.column_stack((table[:, 0], reach)), ~(table[1:, 0] > reach[:-1]))


def runs_of(flags: Mask, wraps: bool = False) -> list[tuple[int, int]]:
    """First and last index of every run of successive True values.

    wraps: the flags are periodic; a run over the border then ends beyond the last index.
    """
    change = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    runs = [(int(s), int(e) - 1) for s, e in zip(change[::2], change[1::2], strict=True)]
    if wraps and len(runs) > 1 and flags[0] and flags[-1]:
        runs = [*runs[1:-1], (runs[-1][0], runs[0][1] + len(flags))]
    return runs
