"""Check for heights whose round-off is large enough to contradict the slope.

An example is cosh(x) - 1 near x = 0. Over an interval the height rises by the integral of the
slope. A difference between the rise and the integral is round-off if it does not grow on far wider
intervals, where the rise is larger. The difference grows with the interval if the slope is not the
derivative of the height.
"""

import math
from dataclasses import dataclass

import numpy as np

from contact.formulation.claims import OPTIONS as CLAIMS
from contact.formulation.problem import Problem
from contact.model.profiles.derive import VERDICTS, verdicts
from contact.model.profiles.noise import EPS
from contact.model.units import quantity
from sie import Array


@dataclass(frozen=True)
class InputCheckOptions:
    """Limits of the check for round-off in the heights.

    counts: smallest reported difference of height and slope, relative to the rise of the height.
    grows: largest factor by which round-off may grow on the wider intervals.
    """

    counts: float = 1e-7
    grows: float = 1e3


_OPTIONS = InputCheckOptions()
# Number of parts of the widest zone, and of Gauss nodes on each part. On each part, the rise of the
# height is compared with the integral of the slope.
_PARTS = CLAIMS.panels


def height_rounding(problem: Problem, table: Array) -> str:
    """Message on round-off in the heights over scaled zones (n, 2); "" if it is harmless.

    The message says how many digits are left. It is also empty if height and slope contradict each
    other for another reason than round-off.
    """
    zone = table[int(np.argmax(table[:, 1] - table[:, 0]))]
    middle, half = 0.5 * float(zone[0] + zone[1]), 0.5 * float(zone[1] - zone[0])
    here, rise, largest = _differences(problem, middle, half)
    if not here > _OPTIONS.counts * rise:
        return ""
    # A difference between height and slope that exceeds the noise of the heights is no round-off:
    # the height or the slope is wrong.
    at = middle + half * np.linspace(-1, 1, _PARTS)
    scale = np.full(at.shape, half / _PARTS)
    if verdicts(problem.shape, problem.slope, at, scale).contradicted.any():
        return ""
    # If height and slope agree on a wider interval, their difference on the zone is round-off. The
    # widest interval is 1/sqrt(EPS) times as wide as the zone.
    for power in range(2, int(0.5 * -np.log(EPS) / np.log(VERDICTS.ratio)) + 1):
        wider = VERDICTS.ratio**power
        there, risen, _ = _differences(problem, middle, wider * half)
        if there <= 10 * _OPTIONS.counts * risen and there <= _OPTIONS.grows * here:
            break
    else:
        return ""
    height, width = problem.units.height, 2 * half * problem.units.length
    digits = math.floor(math.log10(max(rise / largest, 1.0)))
    left = f"{digits or 'no'} {'digit is' if digits == 1 else 'digits are'} left"
    rises, rounded = (quantity(part * height, "m", 2) for part in (rise, largest))
    return (
        f"the heights of the profile vary by {rises} over {quantity(width, 'm', 2)} of contact, "
        f"but are rounded to about {rounded}: {left}. A small difference of large numbers loses "
        "digits: write the height in a form that keeps its digits near the lowest place, such as "
        "2 sinh(x/2)^2 instead of cosh(x) - 1"
    )


def _differences(problem: Problem, middle: float, half: float) -> tuple[float, float, float]:
    """Differences of the height's rise and the slope's integral on the parts of an interval.

    Returns the median of the absolute differences, the range of the cumulated integrals, and the
    range of the cumulated differences. All three numbers are 0 if a value is not finite.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_PARTS)
    at = middle + half * np.linspace(-1, 1, _PARTS + 1)
    with np.errstate(all="ignore"):
        step = at[1:] - at[:-1]
        x = 0.5 * (at[1:] + at[:-1])[:, None] + 0.5 * step[:, None] * nodes
        expected = 0.5 * step * (problem.slope(x.ravel()).reshape(x.shape) @ weights)
        difference = np.diff(problem.shape(at)) - expected
        rise, largest = (
            float(np.ptp(np.concatenate(([0.0], np.cumsum(parts)))))
            for parts in (expected, difference)
        )
    if not (np.isfinite(difference).all() and math.isfinite(rise)):
        return 0.0, 0.0, 0.0
    # A few parts on which the profile bends too sharply for the quadrature hardly change the
    # median.
    return float(np.median(np.abs(difference))), rise, largest
