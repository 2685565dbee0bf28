"""Whether zones may have been born and have merged again between two loads, of which their numbers
at both tell nothing.

On a branch with fixed zones their ends move smoothly, at rates that are known at both loads. Where
two zones merge the end of one jumps to that of the other: the way it went is more than its rates
make of it. So where way and rates do not go together, one looks between. An end beside a narrow
zone or gap goes as the root of what is left to the load at which that is born or closes: even over
the way is its rate times that width.
"""

import numpy as np

from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.tables import room_beside
from contact.solution.solution import Solution
from sie import Array

# Of a way that the rates at both loads leave open: smooth ends leave several times less between
# loads that are near one another.
_OPEN = 0.1
# Rates over one another whose mean tells little of the way.
_UNLIKE = 1.5
# Of a zone's width: ways that hold no zone that could be told from rounding.
_NOTHING = 1e-6


def may_hide(low: Solution, high: Solution) -> bool:
    """Whether the ends of some zone, that both loads have, went a way that their rates do not tell."""
    before, after = ends_and_rates(low), ends_and_rates(high)
    if before is None or after is None or low.load >= high.load:
        return False
    (old, old_rates), (new, new_rates) = before, after
    period = low.scene.period
    step = np.log(high.load / low.load)
    old_widths, new_widths = room_beside(old, period), room_beside(new, period)
    for k, (a, b) in enumerate(new):
        middles = old.mean(axis=1)
        turn = np.zeros(len(old)) if period is None else np.ceil((a - middles) / period) * period
        held = (
            np.flatnonzero(middles + turn <= b)
            if period is not None
            else np.flatnonzero((middles >= a) & (middles <= b))
        )
        if len(held) != 1:
            continue
        (i,) = held
        way = np.array([old[i, 0] + turn[i] - a, b - old[i, 1] - turn[i]])
        mean = 0.5 * (old_widths[i] + new_widths[k])
        first, last = old_rates[i] * (old_widths[i] / mean), new_rates[k] * (new_widths[k] / mean)
        slow, fast = (
            np.minimum(np.abs(first), np.abs(last)),
            np.maximum(np.abs(first), np.abs(last)),
        )
        open_ = (np.abs(way - 0.5 * step * (first + last)) > _OPEN * np.abs(way)) | (
            fast > _UNLIKE * slow
        )
        if np.any(open_ & (np.abs(way) > _NOTHING * (b - a))):
            return True
    return False


def ends_and_rates(solution: Solution) -> tuple[Array, Array] | None:
    """(zones [m], how far their ends move outward as the load grows by a factor of e, both (n, 2));
    None in full contact.
    """
    fields = solution.fields
    if not isinstance(fields, ZoneFields | GapFields):
        return None
    return fields.zone_table, fields.spreading
