"""The load at which a body of given moment has a given approach at x = 0.

The approach grows with the load, at fixed moment, up to its maximum over the datum: Newton by the stiffness, bracketed. Every
state on the way is a solution under its load and the moment, from the zones of the last.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from contact.errors import OutOfRange
from contact.solution import Solution

# Of the load: near enough for the zones to be those of the approach.
_NEAR = 1e-5
_CLOSED = 1e-9
_MOST = 80


def at_approach(
    solved: Callable[[float, Solution | None], Solution], approach: float, first: float, least: float, bounded: bool
) -> Solution:
    """The solution next to the approach [m]; solved(load, near). first: a load to begin with [N/m], least: one that is too small.
    bounded: the contact of a large load may reach the end of what is known of the body.

    OutOfRange if no load has the approach.
    """
    low, high, load = least, math.inf, max(first, 2 * least)
    best: Solution | None = None
    for _ in range(_MOST):
        step = math.nan
        try:
            here = solved(load, best)
        except OutOfRange:
            too_large = bounded if best is None else load > best.load
            low, high = (low, load) if too_large else (load, high)
        else:
            assert here.approach is not None and here.stiffness is not None
            best, miss, stiffness = here, approach - here.approach, here.stiffness
            step = load + miss * stiffness
            if stiffness > 0.0 and abs(step - load) <= _NEAR * load:
                return here
            # Beyond the maximum of the approach the stiffness is negative.
            low, high = (load, high) if stiffness > 0.0 and miss > 0.0 else (low, load)
        if not low < step < high:
            step = math.sqrt(low * high) if 0.0 < low and high < math.inf else 10 * low if low > 0.0 else 0.1 * high
        load = step
        if high - low <= _CLOSED * low:
            break
    found = "" if best is None or best.approach is None else f", the last one tried had {best.approach:.6g} m"
    raise OutOfRange(f"no load has the approach {approach:.6g} m under this moment{found}")
