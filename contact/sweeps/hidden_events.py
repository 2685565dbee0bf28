"""A test for events that two loads with the same number of zones may hide between them.

A zone may be born and merge with a neighbour between two loads. The numbers of zones at both loads
do not show this. While the zones stay the same, their ends move smoothly, at rates (derivatives by
ln(load)) that are known at both loads. When two zones merge, an end jumps. So the distance that an
end has moved is compared with the integral of its rate by the trapezoidal rule. If they disagree, a
solution at a load in between is needed.

Next to a narrow zone or gap, an end moves like the square root of the distance to the load at which
the zone is born or the gap closes. The rate of such an end, times the width of the zone or gap,
varies slowly and is used instead.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.tables import room_beside
from contact.solution.solution import Solution
from sie import Array, record


@dataclass(frozen=True)
class HiddenOptions:
    """Limits within which the motion of a zone end agrees with its prediction.
    The prediction uses the end's rates, which are derivatives by ln(load).
    """

    # If an end's rates at two loads differ by more than this factor, its displacement between the
    # loads cannot be predicted from the rates.
    max_rate_ratio: float = 1.5
    # Bound of the relative error of an end's displacement that is predicted from its rates. If the
    # rates are smooth and the loads differ by less than a third, the actual error is several times
    # smaller.
    rate_error: float = 0.1


OPTIONS = HiddenOptions()


@record
class Ends:
    """Zones at one load, and the outward derivatives of their ends by ln(load), both (n, 2).

    A zone that is just born has no width, and the rates of its ends are nan.

    error: stated error of the ends, relative to the width of their zone.
    """

    zones: Array
    rates: Array
    error: float

    @classmethod
    def of(cls, solution: Solution) -> "Ends | None":
        """The zones of a solution [m] and the rates of their ends; None in full contact."""
        both = ends_and_rates(solution)
        return None if both is None else cls(*both, solution.error)


def may_hide(low: Solution, high: Solution) -> bool:
    """Whether a zone end moved between two loads in another way than the end's rates predict.
    A rate is a derivative by ln(load).
    """
    before, after = Ends.of(low), Ends.of(high)
    if before is None or after is None or low.load >= high.load:
        return False
    return unexplained(before, after, float(np.log(high.load / low.load)), low.scene.period)


def unexplained(low: Ends, high: Ends, step: float, period: float | None) -> bool:
    """Whether a zone end moved over `step` in ln(load) in another way than its rates predict.
    A rate is a derivative by ln(load).
    """
    for motion, first, last, known in _motions(low, high, period):
        slow, fast = np.sort(np.abs([first, last]), axis=0)
        distance = np.abs(motion)
        error = np.abs(motion - 0.5 * step * (first + last))
        doubted = (error > OPTIONS.rate_error * distance) | (fast > OPTIONS.max_rate_ratio * slow)
        if np.any(doubted & (distance > known)):
            return True
    return False


def jumped(low: Ends, high: Ends, step: float, period: float | None) -> bool:
    """Whether a zone end moved over `step` in ln(load) farther than its rates explain.
    A rate is a derivative by ln(load), at the low or the high load.

    Such an end has passed over a zone that was born beside it.
    """
    return any(
        bool(np.any(motion > (1 + OPTIONS.rate_error) * 0.5 * step * (first + last) + known))
        for motion, first, last, known in _motions(low, high, period)
    )


def _motions(
    low: Ends, high: Ends, period: float | None
) -> Iterator[tuple[Array, Array, Array, float]]:
    """Yield four values for each zone of the high load that contains exactly one of the low load.
    They are the outward displacements of its two ends, their rates at the low load and at the high
    load, and the sum of the stated errors of an end.

    The rates are derivatives by ln(load), multiplied by widths as the head of this file says.
    """
    old, old_rates, new, new_rates = low.zones, low.rates, high.zones, high.rates
    old_widths, new_widths = room_beside(old, period), room_beside(new, period)
    middles = old.mean(axis=1)
    for k, (a, b) in enumerate(new):
        turn = np.zeros(len(old)) if period is None else np.ceil((a - middles) / period) * period
        inside = np.flatnonzero((middles + turn >= a) & (middles + turn <= b))
        if len(inside) != 1:
            continue
        (i,) = inside
        motion = np.array([old[i, 0] + turn[i] - a, b - old[i, 1] - turn[i]])
        mean = 0.5 * (old_widths[i] + new_widths[k])
        first, last = old_rates[i] * (old_widths[i] / mean), new_rates[k] * (new_widths[k] / mean)
        # The width of a new zone grows like a square root of the load's increase. So the product of
        # the width and its rate is constant.
        first = np.where(np.isnan(first), last, first)
        yield motion, first, last, (low.error + high.error) * float(b - a)


def ends_and_rates(solution: Solution) -> tuple[Array, Array] | None:
    """Zones [m], and outward derivatives of their ends by ln(load) [m]; both (n, 2).

    None in full contact.
    """
    fields = solution.fields
    if not isinstance(fields, ZoneFields | GapFields):
        return None
    return fields.zone_table, fields.spreading
