"""Whether a profile's heights are rounded so coarsely that they no longer say what its slope says:
cosh(x) - 1 at x = 1e-6.

Over an interval the height rises by the integral of the slope. What is missing is rounding if it
stays as small over intervals far wider, where the rise is larger; of a height and a slope that do
not go together it grows with them.
"""

import math

import numpy as np

from contact.formulation.problem import Problem
from contact.model.profiles.derive import verdicts
from sie import Array

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
# Intervals in the zones that are looked at, and how much wider ones.
_PLACES = 16
_WIDER = (1e2, 1e3, 1e4, 1e5, 1e6)
# Of a rise: what is missing that is worth telling, and what is nothing; and the largest that
# rounding becomes over wider intervals.
_COARSE = 1e-7
_NOTHING = 1e-6
_GROWS = 1e3


def told(problem: Problem, table: Array) -> str:
    """What rounding leaves of the heights over scaled zones (n, 2), in words; empty where that is
    enough, or where something else is amiss.
    """
    zone = table[int(np.argmax(table[:, 1] - table[:, 0]))]
    middle, half = 0.5 * float(zone[0] + zone[1]), 0.5 * float(zone[1] - zone[0])
    here, rise, apart = _missing(problem, middle, half)
    if not here > _COARSE * rise:
        return ""
    # Heights with digits that contradict the slope are not rounded: one of the two is wrong.
    at = middle + half * np.linspace(-1, 1, _PLACES)
    scale = np.full(at.shape, half / _PLACES)
    if verdicts(problem.shape, problem.slope, at, scale).contradicted.any():
        return ""
    for wider in _WIDER:
        there, risen, _ = _missing(problem, middle, wider * half)
        if there <= _NOTHING * risen and there <= _GROWS * here:
            break
    else:
        return ""
    height, width = problem.units.height, 2 * half * problem.units.length
    digits = math.floor(math.log10(max(rise / apart, 1.0)))
    return (
        f"the heights of the profile vary by {rise * height:.1e} m over {width:.1e} m of contact, and are rounded to about "
        f"{apart * height:.1e} m: {digits or 'no'} {'digit is' if digits == 1 else 'digits are'} left, as of a small difference of large "
        "numbers; give the height in a form that keeps them near its lowest place, as 2 sinh(x/2)^2 for cosh(x) - 1"
    )


def _missing(problem: Problem, middle: float, half: float) -> tuple[float, float, float]:
    """(what is missing of the rises over parts of an interval, of as many more as less; the largest
    rise, and the most that is missing of any), scaled.
    """
    at = middle + half * np.linspace(-1, 1, _PLACES + 1)
    with np.errstate(all="ignore"):
        heights = problem.shape(at)
        rise = np.diff(heights)
        step = at[1:] - at[:-1]
        x = 0.5 * (at[1:] + at[:-1])[:, None] + 0.5 * step[:, None] * _NODES
        expected = 0.5 * step * (problem.slope(x.ravel()).reshape(x.shape) @ _WEIGHTS)
        missing = rise - expected
        total, most = (
            float(np.ptp(np.concatenate(([0.0], np.cumsum(parts)))))
            for parts in (expected, missing)
        )
    if not (np.isfinite(missing).all() and math.isfinite(total)):
        return 0.0, 0.0, 0.0
    # Of a shape that bends sharply few parts show it.
    return float(np.median(np.abs(missing))), total, most
