"""A test for events that two loads with the same number of zones may hide between them.

A zone may be born and merge with a neighbour between two loads. The numbers of zones at both loads
do not show it. While the zones stay the same, their ends move smoothly, at rates known at both
loads. When two zones merge, an end jumps. So the distance that an end has moved is compared with
the trapezoidal rule for its rate; a disagreement asks for a load in between.

Next to a narrow zone or gap an end moves like the square root of the distance to the load of its
birth or closure. Its rate times the width of that zone or gap varies slowly, and is used instead.
"""

import numpy as np

from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.tables import room_beside
from contact.solution.solution import Solution
from sie import Array


def may_hide(low: Solution, high: Solution, rate_error: float, max_rate_ratio: float) -> bool:
    """Whether some end moved between two loads in another way than the end's rates predict.

    rate_error: relative error of an end's motion predicted from the end's rates at both loads.
    max_rate_ratio: ratio of these two rates above which their mean predicts nothing.
    """
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
        inside = (
            np.flatnonzero(middles + turn <= b)
            if period is not None
            else np.flatnonzero((middles >= a) & (middles <= b))
        )
        if len(inside) != 1:
            continue
        (i,) = inside
        motion = np.array([old[i, 0] + turn[i] - a, b - old[i, 1] - turn[i]])
        mean = 0.5 * (old_widths[i] + new_widths[k])
        first, last = old_rates[i] * (old_widths[i] / mean), new_rates[k] * (new_widths[k] / mean)
        slow, fast = np.sort(np.abs([first, last]), axis=0)
        distance = np.abs(motion)
        error = np.abs(motion - 0.5 * step * (first + last))
        unexplained = (error > rate_error * distance) | (fast > max_rate_ratio * slow)
        # A motion below the sum of the stated errors does not count, since it may be an error.
        if np.any(unexplained & (distance > (low.error + high.error) * (b - a))):
            return True
    return False


def ends_and_rates(solution: Solution) -> tuple[Array, Array] | None:
    """Zones [m], and outward motions of their ends per unit of ln(load) [m]; both (n, 2).

    None in full contact.
    """
    fields = solution.fields
    if not isinstance(fields, ZoneFields | GapFields):
        return None
    return fields.zone_table, fields.spreading
