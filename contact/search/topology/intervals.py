"""The algebra of intervals, be they zones or the gaps between them: parts cut out, neighbours
merged, overlapping ones united.
"""

import numpy as np

from contact.formulation import tables
from contact.search.topology.failure import WrongTopology
from sie import Array, Index


def without(table: Array, parts: Array) -> Array:
    """Intervals (n, 2) without the parts (m, 2), both ascending."""
    # Of very many few are cut.
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
    """Each of the intervals `met` with the one after it; the last one with the first of the next
    period, if there is one.
    """
    closed = np.isin(np.arange(len(table)), met)
    out = tables.joined_where(table, closed[:-1])
    if closed[-1] and period is not None and len(out) > 1:
        out[-1, 1] = out[0, 1] + period
        out = out[1:]
    return out


def united(table: Array, period: float | None, around: bool, what: str) -> Array:
    """Overlapping intervals as one. around: the last one may reach over the border of the period.
    what: they are, for a message.
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
