r"""Flat tops: the widths of contact that no load has.

Where f is least on a whole stretch, all of that stretch is in contact at any load: f + u is the approach at some point of contact,
so u is nowhere larger than the approach less min f, and being harmonic it stays below that outside contact; there the gap at a
point of the stretch would be negative. So contact is wider than the stretches together at every positive load, and narrows to them
as the load goes to zero.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact.errors import OutOfRange
from contact.formulation.full import period_samples
from contact.model.profiles.base import Profile
from contact.model.scene import Scene
from contact.verify.certificate import runs_of

Array = NDArray[np.float64]

_EPS = np.finfo(np.float64).eps
# Edges are known to this part of a period.
_HAIR = 64 * _EPS
# Of bisections, and of doublings in search of an end.
_STEPS = 64


def refuse_below_plateau(scene: Scene) -> None:
    """OutOfRange for a contact fraction or a half width that the flat top of the profile does not leave to any load."""
    kind, value = scene.control
    profile = scene.profile
    if kind == "contact_fraction" and profile.period is not None:
        width = float(np.diff(lowest_stretches(profile)).sum())
        if width > 0.0 and value * profile.period <= width + _HAIR * profile.period:
            raise OutOfRange(
                f"contact_fraction {value:.15g} is not above {width / profile.period:.15g}: the lowest part of the profile is flat over "
                f"{width:.6g} m of each period, and any load has all of it in contact; ask for more, or give a load"
            )
    if kind == "half_width":
        reach = _level_from(profile, value)
        if reach > 0.0:
            raise OutOfRange(
                f"half_width {value:.15g} m is not above {reach:.15g} m: so far the profile is flat about x = 0, and any load has all of "
                "that in contact; ask for more, or give a load"
            )


def lowest_stretches(profile: Profile) -> Array:
    """(n, 2) stretches of a period on which f is at its least and without slope, wider than two samples; [m]."""
    x = period_samples(profile)
    height = np.asarray(profile.height(x), dtype=np.float64)
    size = np.abs(height[np.isfinite(height)]).max(initial=0.0)
    highest = float(height.min()) + 8 * _EPS * float(size)

    def lies_low(x: Array) -> NDArray[np.bool_]:
        return np.asarray((np.asarray(profile.height(x)) <= highest) & (np.asarray(profile.slope(x)) == 0))

    low = lies_low(x)
    if low.all():
        return np.array([[x[0], x[-1]]])
    # Begun at a place that is not low, no stretch lies across the border.
    first = int(np.argmin(low))
    at = np.concatenate((x[first:-1], x[: first + 1] + (x[-1] - x[0])))
    runs = runs_of(np.roll(low[:-1], -first))
    return np.array([
        [_edge(lies_low, at[s], at[s - 1]), _edge(lies_low, at[e], at[e + 1])] for s, e in runs if e - s > 1
    ]).reshape(-1, 2)


def _edge(holds, inside: float, outside: float) -> float:  # type: ignore[no-untyped-def]
    """Where a property that holds inside ends, by bisection."""
    for _ in range(_STEPS):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if bool(holds(np.array([middle]))[0]) else (inside, middle)
    return inside


def _level_from(profile: Profile, half_width: float) -> float:
    """How far a symmetric profile has no slope about x = 0, if that is a half width or more; else 0. [m]"""

    def is_level(x: Array) -> NDArray[np.bool_]:
        return np.asarray(np.asarray(profile.slope(x)) == 0)

    # The left side has the mirror image's slopes; at an edge itself the slope may be either side's.
    if not is_level(half_width * np.append(np.arange(1, 32) / 32, 1 - 2 * _EPS)).all():
        return 0.0
    reach = half_width
    for _ in range(_STEPS):
        if not is_level(np.array([2 * reach]))[0]:
            return _edge(is_level, reach, 2 * reach)
        reach *= 2
    return reach
