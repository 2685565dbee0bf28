"""The load at which a body alone, of given moment or upright, has a given approach.

The approach grows with the load up to its maximum over the datum. Where a tilt makes most of it, it goes with 1/load^2, elsewhere
about with the load: so Newton's step is one on a power of the load, the one that the last two stiffnesses ask for, bracketed. Every
state on the way is a solution under its load, from the zones of the last. Upright, contact only grows with the load: the approach
is concave in it, below its tangents, which tell soon that no load has the approach.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from contact.errors import OutOfRange
from contact.solution import Solution

_CLOSED = 1e-9
_MOST = 80
# Of the first load: the logarithm of the datum over a width changes it by less.
_LIGHT = 1e-4


def at_approach(
    solved: Callable[[float, Solution | None], Solution], approach: float, first: float, least: float, bounded: bool,
    nearness: float, concave: bool = False,
) -> Solution:
    """The solution next to the approach [m]; solved(load, near). first: a load to begin with [N/m], least: one that is too small.
    bounded: the contact of a large load may reach the end of what is known of the body. nearness: of the load, what it may be off.
    concave: the approach is, in the load.

    OutOfRange if no load has the approach.
    """
    low, high, load = least, math.inf, max(first, 2 * least)
    best: Solution | None = None
    last, largest = None, -math.inf
    reach = (0.0, math.inf)  # loads between which tangents allow the approach
    for _ in range(_MOST):
        step = math.nan
        try:
            here = solved(load, best)
        except OutOfRange as refusal:
            last = refusal
            too_large = bounded if best is None else load > best.load
            low, high = (low, load) if too_large else (load, high)
            if concave and best is None and load < _LIGHT * first:
                break
        else:
            assert here.approach is not None and here.stiffness is not None
            largest = max(largest, here.approach)
            miss, stiffness = approach - here.approach, here.stiffness
            step, best = _newton(here, best, miss), here
            tangent = load + miss * stiffness
            if stiffness > 0.0 and abs(miss * stiffness) <= nearness * load:
                return here
            # Beyond the maximum of the approach the stiffness is negative.
            rises = stiffness > 0.0 and miss > 0.0
            low, high = (load, high) if rises else (low, load)
            reach = (tangent, reach[1]) if rises else (reach[0], tangent) if stiffness < 0.0 else reach
        if not low < step < high:
            step = math.sqrt(low * high) if 0.0 < low and high < math.inf else 10 * low if low > 0.0 else 0.1 * high
        if concave and not reach[0] < min(reach[1], high):
            break
        load = step
        if high - low <= _CLOSED * low:
            break
    if best is None and last is not None:
        raise last
    raise OutOfRange(f"no load has the approach {approach:.6g} m; the largest of those tried was {largest:.6g} m")


def _newton(here: Solution, before: Solution | None, miss: float) -> float:
    """The load at which approach = constant + B load^q is right, with the slope found here and q from the slope found before;
    nan if there is none."""
    assert here.stiffness is not None
    power = 1.0
    if before is not None and before.stiffness is not None and before.load != here.load and before.stiffness * here.stiffness > 0.0:
        power -= math.log(here.stiffness / before.stiffness) / math.log(here.load / before.load)
    power = min(max(power, -4.0), 1.0)
    relative = miss * here.stiffness / here.load
    if abs(power * relative) < 1e-6:
        return here.load * (1.0 + relative)
    grown = 1.0 + power * relative
    return here.load * grown ** (1.0 / power) if grown > 0.0 and abs(math.log(grown) / power) < 300.0 else math.nan
