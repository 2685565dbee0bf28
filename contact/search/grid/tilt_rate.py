"""Bracketed Newton method for the tilt that puts the load's centre (moment / load) at a place.

Under a given load the moment grows with the tilt, as the energy is convex. So a tilt with too small
a moment and a tilt with too large a moment bracket the root. Newton's steps, computed as if the
zones of contact were fixed, converge fast; a step that leaves the bracket, or does not halve the
error, is replaced by the middle of the bracket. A tilt at which the body has no equilibrium also
bounds the root.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from contact.errors import OutOfRange
from contact.formulation.tolerances import TOLERANCES
from contact.search.grid.conjugate_gradient import GridState, turning_rate
from sie import record


@record
class AtTilt:
    """A contact on a grid at one tilt.

    centre: centre of the load [m]. rate: d centre / d tilt [m]. fineness: the wanted centre counts
    as reached within this distance [m]. window: window of the grid [m].
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
        """The contact at a tilt, from its solution `state` on a grid.

        fineness: as in the class, but in grid cells.
        """
        h = state.influence.h
        x = np.asarray(window[0] + h * (np.arange(state.influence.n) + 0.5), dtype=np.float64)
        centre = float(state.pressure @ x) * h / state.load
        # Any contact resists rotation at least like a single cell in contact. This cell counts as a
        # flat punch as wide as the cell.
        least = math.pi / 16 * state.influence.E * h**2
        return cls(
            tilt, centre, max(turning_rate(state, x), least) / state.load, fineness * h, window
        )


def balanced(
    measure: Callable[[float], AtTilt], centre: float, tilts: Sequence[float], most: int
) -> AtTilt:
    """The contact with its load centred at `centre`, or the nearest one found in `most` trials.

    tilts: tilts to try first. Raises the error of `measure` if `measure` fails at all of `tilts`.
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
            if not low < tilt < high or high - low <= TOLERANCES.balance * abs(tilt):
                break
        try:
            trial = measure(tilt)
        except OutOfRange:
            if best is not None:
                low, high = (tilt, high) if tilt < best.tilt else (low, tilt)
            elif not waiting:
                raise
            continue
        error, before = (
            abs(centre - trial.centre),
            math.inf if best is None else abs(centre - best.centre),
        )
        if error <= trial.fineness:
            return trial
        low, high = (max(low, tilt), high) if trial.centre < centre else (low, min(high, tilt))
        if error <= before:
            # Newton's step is tried next if the error was halved, or if the bracket is still
            # infinite. A `rate` that has more than doubled shows that new places have come into
            # contact: then Newton's step with the new rate is tried, too.
            newton = (
                error <= 0.5 * before
                or high - low == math.inf
                or (best is not None and trial.rate > 2 * best.rate)
            )
            best = trial
    assert best is not None
    return best
