"""The tilt under which a load has a given centre: moment / load, found on coarse grids.

At a given load the moment grows with the tilt: both belong to one convex energy. So the root is
bracketed by any two tilts, one with a moment too small and one too large. Newton's steps, with the
contact held as it is, lead there fast; where they leave the bracket, or do not halve what is
missing, the bracket is halved. A tilt at which the contact runs off bounds it too.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from contact.errors import OutOfRange
from contact.search.grid.conjugate_gradient import GridState, turning_rate
from sie import record

# A bracket closed to this part of the tilt holds no root that was not met: the grid's contact jumps
# there.
_CLOSED = 1e-9


@record
class AtTilt:
    """A contact at one tilt: centre of the load [m], its rate d centre / d tilt [m], and the window
    of its grid [m].

    fineness: the distance to the wanted centre that is near enough [m].
    """

    tilt: float
    centre: float
    rate: float
    fineness: float
    window: tuple[float, float]

    @classmethod
    def of(
        cls, tilt: float, window: tuple[float, float], state: GridState, fineness: float
    ) -> "AtTilt":
        """Read from a grid's contact; fineness: in cells."""
        h = state.influence.h
        x = np.asarray(window[0] + h * (np.arange(state.influence.n) + 0.5), dtype=np.float64)
        centre = float(state.pressure @ x) * h / state.load
        # One cell in contact does not turn on the grid: it turns as the flat punch of its width
        # would.
        least = math.pi / 16 * state.influence.E * h**2
        return cls(
            tilt, centre, max(turning_rate(state, x), least) / state.load, fineness * h, window
        )


def balanced(
    measure: Callable[[float], AtTilt], centre: float, tilts: Sequence[float], most: int
) -> AtTilt:
    """The contact whose load has its centre there, from a few tilts to try first; the nearest of
    `most` at the most.

    Raises what `measure` raises where it does so at all of the first tilts.
    """
    low, high = -math.inf, math.inf
    best: AtTilt | None = None
    newton = False
    waiting = list(tilts)
    for _ in range(most):
        if waiting:
            tilt = waiting.pop(0)
            if not low < tilt < high:
                continue
        else:
            assert best is not None
            step = best.tilt + (centre - best.centre) / best.rate
            tilt = step if newton and low < step < high else 0.5 * (low + high)
            newton = False
            if not low < tilt < high or high - low <= _CLOSED * abs(tilt):
                break
        try:
            lean = measure(tilt)
        except OutOfRange:
            if best is not None:
                low, high = (tilt, high) if tilt < best.tilt else (low, tilt)
            elif not waiting:
                raise
            continue
        miss, before = (
            abs(centre - lean.centre),
            math.inf if best is None else abs(centre - best.centre),
        )
        if miss <= lean.fineness:
            return lean
        low, high = (max(low, tilt), high) if lean.centre < centre else (low, min(high, tilt))
        if miss <= before:
            # More places in contact turn less for the same moment: then Newton knows better than it
            # did.
            newton = (
                miss <= 0.5 * before
                or high - low == math.inf
                or (best is not None and lean.rate > 2 * best.rate)
            )
            best = lean
    assert best is not None
    return best
