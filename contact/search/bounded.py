r"""Whether a body on the whole line can rest at all: what falls without bound on one side finds no hold under any load.

Far away the gap is f(x) - tilt x but for a logarithm, so f must rise faster than tilt x on both sides. Looked at from decade to
decade, far beyond any contact; where the tilt is not given, some tilt must do: f must not fall faster than all straight lines on
either side, and f(x) + f(-x) must rise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact.errors import OutOfRange
from contact.model.scene import Scene

Array = NDArray[np.float64]

# Distances [m] at which a body on the whole line is looked at.
_FAR = 10.0 ** np.arange(5, 13)
_ROUNDING = 16 * np.finfo(np.float64).eps
_REMEDY = (
    "no load finds a hold. Give a tilt below its slopes, a part that rises on both sides, or a period, of which one cell stands alone"
)


def refuse_unbounded(scene: Scene) -> None:
    """OutOfRange where a body alone on the whole line has no lowest place, as it stands or at any tilt."""
    profile = scene.profile
    if scene.period is not None or profile.period is not None or profile.support is not None or profile.extent is not None:
        return
    with np.errstate(all="ignore"):
        # Mean slopes over each decade, outwards.
        right, left = (np.diff(np.asarray(profile.height(side * _FAR), dtype=np.float64)) / np.diff(_FAR) for side in (1.0, -1.0))
        if scene.turned and scene.moment is not None:
            _refuse_at_any_tilt(right, left)
        else:
            _refuse_as_it_stands(right, left, scene.tilt or 0.0)


def _refuse_as_it_stands(right: Array, left: Array, tilt: float) -> None:
    for side, slope in (("right", right - tilt), ("left", left + tilt)):
        turned = f", turned by {tilt:.6g}," if tilt else ""
        # From each decade to the next it falls by more; a straight line by ten times as much.
        if np.all(slope < 0) and np.all(10 * slope[1:] < 2 * slope[:-1]):
            raise OutOfRange(f"the profile{turned} falls without bound on the {side}: {_REMEDY}")
        if tilt and np.all(np.abs(slope) <= _ROUNDING * abs(tilt)):
            raise OutOfRange(f"the profile{turned} stands on its own flank on the {side} and does not rise there: {_REMEDY}")


def _refuse_at_any_tilt(right: Array, left: Array) -> None:
    for side, slope in (("right", right), ("left", left)):
        if np.all(slope < 0) and np.all(slope[1:] < 2 * slope[:-1]):
            raise OutOfRange(f"the profile falls without bound on the {side}, at any tilt: {_REMEDY}")
    if np.all(right + left <= _ROUNDING * (np.abs(right) + np.abs(left))):
        raise OutOfRange(f"the profile does not rise on both sides, at any tilt: {_REMEDY}")
