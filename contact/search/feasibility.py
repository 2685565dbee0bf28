r"""Controls that no load can bring about, refused before any search.

Flat tops: where f is least on a whole stretch, all of the stretch is in contact under any load. In
contact the displacement is u = approach - f, which is at most approach - min f. As u is harmonic in
the body, u is smaller than this bound outside contact. A point of the stretch outside contact would
therefore have a negative gap. So contact is wider than the stretches together under every positive
load, and narrows to them as the load goes to zero.

Sharp corners: a body cannot touch outside its sharp corners. So no load makes the contact wider
than the distance between the corners.

A body on the whole line that falls without bound on one side has no equilibrium under any load. Far
away the gap is f(x) - tilt x up to a logarithm, so that f must rise faster than tilt x on both
sides. This growth is checked from decade to decade of x, far beyond any contact. Where the tilt is
unknown, some tilt must do: f must not fall faster than all straight lines on either side, and
f(x) + f(-x) must rise.
"""

import numpy as np

from contact.errors import OutOfRange
from contact.formulation.full_contact import period_samples
from contact.formulation.tables import runs_of
from contact.formulation.tolerances import TOLERANCES
from contact.model.controls import Quantity
from contact.model.profiles.base import Profile
from contact.model.scene import Scene
from sie import Array, Mask

# Distances [m] from x = 0, far larger than any contact, at which the growth of the profile is
# tested.
_DISTANCES = 10.0 ** np.arange(5, 13)
_UPWARDS = (
    "height(x) is the gap at zero load and must grow away from the contact (change the sign of "
    "heights that are measured upwards)"
)
_REMEDY = (
    "no load has an equilibrium. Give a profile that rises on both sides, or make a given tilt "
    "smaller than its slopes, or give a profile with a period (the isolated body is then one "
    "period of it)"
)


def refuse_below_plateau(scene: Scene) -> None:
    """Raise OutOfRange for a contact width that is not wider than the flat top of the profile."""
    profile, fraction, half_width = (
        scene.profile,
        scene.given_fraction,
        scene.held(Quantity.HALF_WIDTH),
    )
    if fraction is not None and profile.period is not None:
        width = float(np.diff(lowest_stretches(profile)).sum())
        if (
            width > 0.0
            and fraction * profile.period <= width + TOLERANCES.rounding * profile.period
        ):
            raise OutOfRange(
                f"contact_fraction = {fraction:.15g} is not above {width / profile.period:.15g}: "
                f"the lowest part of the profile, flat over {width:.6g} m of each period, is in "
                "contact under any load; give a larger fraction, or give a load"
            )
    if half_width is not None:
        reach = _level_from(profile, half_width)
        if reach > 0.0:
            raise OutOfRange(
                f"half_width = {half_width:.15g} m is not above {reach:.15g} m: up to this "
                "distance from x = 0 the profile is flat, and it is in contact under any load; "
                "give a larger half width, or give a load"
            )


def refuse_beyond_corners(scene: Scene) -> None:
    """Raise OutOfRange if the given contact is wider than the body between its sharp corners."""
    support, period, fraction = scene.profile.support, scene.profile.period, scene.given_fraction
    if support is None or period is None or fraction is None:
        return
    most = (support[1] - support[0]) / period
    if fraction > most * (1.0 + TOLERANCES.rounding):
        raise OutOfRange(
            f"contact_fraction = {fraction:.15g} is above {most:.15g}: no load makes the contact "
            "wider than the body between its sharp corners; give a smaller fraction"
        )


def lowest_stretches(profile: Profile) -> Array:
    """Intervals (n, 2) [m] of one period on which the profile is flat and has its least height.

    Only intervals wider than two samples are found.
    """
    x = period_samples(profile)
    height = np.asarray(profile.height(x), dtype=np.float64)
    size = np.abs(height[np.isfinite(height)]).max(initial=0.0)
    highest = float(height.min()) + TOLERANCES.rounding * float(size)

    def lies_low(x: Array) -> Mask:
        return np.asarray(
            (np.asarray(profile.height(x)) <= highest) & (np.asarray(profile.slope(x)) == 0)
        )

    low = lies_low(x)
    if low.all():
        return np.array([[x[0], x[-1]]])
    # The samples are shifted around the period, so that the first sample lies in no lowest
    # interval. Then no such interval crosses the border of the shifted period.
    first = int(np.argmin(low))
    at = np.concatenate((x[first:-1], x[: first + 1] + (x[-1] - x[0])))
    runs = runs_of(np.roll(low[:-1], -first))
    return np.array(
        [
            [_edge(lies_low, at[s], at[s - 1]), _edge(lies_low, at[e], at[e + 1])]
            for s, e in runs
            if e - s > 1
        ]
    ).reshape(-1, 2)


def _edge(holds, inside: float, outside: float) -> float:  # type: ignore[no-untyped-def]
    """The x between `inside` and `outside` where the condition `holds` ends, by bisection."""
    while (middle := 0.5 * (inside + outside)) not in (inside, outside):
        if bool(holds(np.array([middle]))[0]):
            inside = middle
        else:
            outside = middle
    return inside


def _level_from(profile: Profile, half_width: float) -> float:
    """Distance [m] from x = 0 up to which the height of a symmetric profile is constant.

    It is 0 if the profile is not level up to `half_width`.
    """

    def is_level(x: Array) -> Mask:
        return np.asarray(np.asarray(profile.slope(x)) == 0)

    # At the edge of the flat part, `profile.slope` may give the slope outside the flat part. The
    # largest sampled x therefore lies just inside `half_width`.
    if not is_level(half_width * np.append(np.arange(1, 32) / 32, 1 - TOLERANCES.rounding)).all():
        return 0.0
    reach = half_width
    while reach < 2.0**64 * half_width:  # a profile level beyond that is a plane
        if not is_level(np.array([2 * reach]))[0]:
            return _edge(is_level, reach, 2 * reach)
        reach *= 2
    return reach


def refuse_unbounded(scene: Scene) -> None:
    """Raise OutOfRange for a body on the whole line that has no equilibrium under any load."""
    profile = scene.profile
    if (
        scene.period is not None
        or profile.period is not None
        or profile.support is not None
        or profile.extent is not None
    ):
        return
    with np.errstate(all="ignore"):
        # Mean slopes of the profile over each decade of distance from x = 0, in the outward
        # direction.
        right, left = (
            np.diff(np.asarray(profile.height(side * _DISTANCES), dtype=np.float64))
            / np.diff(_DISTANCES)
            for side in (1.0, -1.0)
        )
        if scene.turned and scene.moment is not None:
            _refuse_at_any_tilt(right, left)
        else:
            _refuse_as_it_stands(right, left, scene.tilt or 0.0)


def _refuse_as_it_stands(right: Array, left: Array, tilt: float) -> None:
    """Raise OutOfRange if the body, turned by its tilt, falls or stays flat on one side."""
    for side, slope in (("right", right - tilt), ("left", left + tilt)):
        turned = f", turned by {tilt:.6g}," if tilt else ""
        # The body is taken to fall without bound if its height falls at least twice as much in each
        # decade of distance as in the decade before. The factor 10 is the ratio of the widths of
        # two successive decades.
        if np.all(slope < 0) and np.all(10 * slope[1:] < 2 * slope[:-1]):
            raise OutOfRange(
                f"the profile{turned} falls without bound on the {side}: {_REMEDY}; {_UPWARDS}"
            )
        if tilt and np.all(np.abs(slope) <= TOLERANCES.rounding * abs(tilt)):
            raise OutOfRange(
                f"the profile{turned} does not rise on the {side}, as the tilt equals the slope "
                f"of this flank: {_REMEDY}"
            )


def _refuse_at_any_tilt(right: Array, left: Array) -> None:
    """Raise OutOfRange if no tilt makes the profile rise on both sides."""
    for side, slope in (("right", right), ("left", left)):
        if np.all(slope < 0) and np.all(slope[1:] < 2 * slope[:-1]):
            raise OutOfRange(
                f"at every tilt the profile falls without bound on the {side}: {_REMEDY}; "
                f"{_UPWARDS}"
            )
    if np.all(right + left <= TOLERANCES.rounding * (np.abs(right) + np.abs(left))):
        raise OutOfRange(f"the profile does not rise on both sides at any tilt: {_REMEDY}")
