"""Jumps of f', f'' and f''' at a place, seen from its two sides.

On either side a polynomial goes through points s +- h, s +- 2h, ... and is differentiated at s, for a ladder of steps h. Long steps
reach past what the shape does beside s, short ones lose their digits to rounding: the step is chosen where two neighbours agree best.
A bend that is smooth, only sharp, looks like a jump from afar: a jump counts as one only if it is there from as near as rounding lets.
"""

from dataclasses import dataclass
from math import factorial

import numpy as np

from contact.model.profiles.base import Profile
from sie import Array, Mask

_POINTS = 6  # a side
_STEPS = 30  # each half of the one before
_EPS = float(np.finfo(float).eps)
_CLEAR = 0.05  # of a jump: rounding below this still shows it
_SAME = 0.2  # of a jump: how far it may seem to change from nearer by


@dataclass(frozen=True)
class Seen:
    """Jumps of f^(1), f^(2), f^(3), one place a row: their heights, how far these may be off, and whether each is there from near by."""

    height: Array
    doubt: Array
    sharp: Mask


def jumps_at(profile: Profile, places: Array, reach: Array, nearest: float = 0.0) -> Seen:
    """Jumps at places, looked at from no farther than `reach` (one for each place, beyond which there may be other jumps).

    nearest: the shortest step, for places that are not known to the last digit.
    """
    # f' where the author gives it, else f: a derived slope takes its points from both sides.
    first = 0 if profile.slope_is_derived else 1
    function = profile.height if profile.slope_is_derived else profile.slope
    k = np.arange(1.0, _POINTS + 1)
    # Row m of the inverse holds the weights of the m-th derivative at 0 over m!, for points a step apart.
    taylor = np.linalg.inv(np.vander(k, increasing=True))
    seen, rounding = np.zeros((_STEPS, len(places), 3)), np.full((_STEPS, len(places), 3), np.inf)
    for j in range(_STEPS):
        h = reach / _POINTS * 0.5**j
        if j > 1 and not np.any(h >= nearest):
            break
        right, left = (np.asarray(function(places[:, None] + side * h[:, None] * k), dtype=float) for side in (1, -1))
        size = np.maximum(np.abs(right), np.abs(left)).max(axis=1)
        # The place itself is rounded too: by what that moves the values.
        moved = np.abs(places) / h * np.maximum(np.ptp(right, axis=1), np.ptp(left, axis=1))
        for order in (1, 2, 3):
            m = order - first
            weights = taylor[m] * factorial(m)
            seen[j, :, order - 1] = (right @ weights - (-1.0) ** m * (left @ weights)) / h**m
            rounding[j, :, order - 1] = 2 * _EPS * (size + moved) * np.abs(weights).sum() / h**m
        rounding[j, h < nearest] = np.inf
    off = np.abs(np.diff(seen, axis=0)) + rounding[1:]
    best = np.argmin(off, axis=0)
    height, doubt = (np.take_along_axis(a, best[None], axis=0)[0] for a in (seen[1:], off))
    near = (rounding[1:] <= _CLEAR * np.abs(height)) & (np.arange(_STEPS - 1)[:, None, None] >= best)
    sharp = np.all(~near | (np.abs(seen[1:] - height) <= _SAME * np.abs(height)), axis=0)
    return Seen(height, doubt, sharp)
