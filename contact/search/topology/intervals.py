"""Operations on intervals, which are zones or gaps: cutting parts out, merging, uniting."""

import numpy as np

from contact.formulation import tables
from contact.search.topology.failure import WrongTopology
from sie import Array, Index

# Width of a new zone, divided by the width over which the bodies overlap without the zone. This
# ratio is 1 / sqrt(2) in Hertz's contact of spheres, and about the same in plane contact.
NEW_ZONE = 0.7


def half_width_of_new(overlap: Array, distance: Array) -> Array:
    """Half widths of new zones in intervals where the bodies would overlap without these zones.

    overlap: half widths of these intervals. The gap is a parabola of curvature 1/R and depth
    overlap^2 / 2R. A Hertz contact of half width a, between two zones at the given distance l,
    removes the depth a^2 / 2R (ln(4 l / a) + 1/2).
    """
    half = 0.5 * overlap
    for _ in range(3):  # the logarithm hardly depends on `half`
        half = overlap / np.sqrt(np.log(4.0 * distance / half) + 0.5)
    return half


def distance_to_nearest(marks: Array | Index, x: Array | Index) -> Array:
    """Distance of each x from the nearest of the ascending `marks`, which are at least two."""
    after = np.clip(np.searchsorted(marks, x), 1, len(marks) - 1)
    return np.asarray(np.minimum(np.abs(marks[after] - x), np.abs(x - marks[after - 1])), float)


# An interval is not resolved if it contains fewer samples or grid cells than this.
NARROW = 3


def without(table: Array, parts: Array) -> Array:
    """The intervals `table` (n, 2) after `parts` (m, 2) are cut out; both arrays are ascending."""
    # Few intervals overlap one of the `parts`. Only these intervals are cut, one by one.
    first = np.searchsorted(parts[:, 1], table[:, 0], side="right")
    after = np.searchsorted(parts[:, 0], table[:, 1], side="left")
    rows = []
    for i in np.flatnonzero(after > first):
        left, b = table[i]
        for lo, hi in parts[first[i] : after[i]]:
            if lo > left:
                rows.append([left, lo])
            left = max(left, hi)
        if left < b:
            rows.append([left, b])
    out = np.concatenate((table[after <= first], np.array(rows).reshape(-1, 2)))
    return np.asarray(out[np.argsort(out[:, 0], kind="stable")])


def merged(table: Array, met: Index, period: float | None) -> Array:
    """The intervals; each interval whose index is in `met` is merged with the next one.

    With a period, the last interval may be merged with the first interval of the next period.
    """
    closed = np.isin(np.arange(len(table)), met)
    out = tables.joined_where(table, closed[:-1])
    if closed[-1] and period is not None and len(out) > 1:
        out[-1, 1] = out[0, 1] + period
        out = out[1:]
    return out


def united(table: Array, period: float | None, around: bool, what: str) -> Array:
    """The intervals, with overlapping ones united; raises WrongTopology if they fill the period.

    around: whether the last interval may reach over the border of the period. what: name of an
    interval in the message.
    """
    if len(table) == 0:
        return table
    out = tables.united(table)
    if around and period is not None and len(out) > 1 and out[-1, 1] >= out[0, 0] + period:
        out[0, 0] = out[-1, 0] - period
        out = out[:-1]
    if period is not None and out[-1, 1] - out[0, 0] >= period:
        raise WrongTopology(f"the {what}s fill the period", None)
    return out
