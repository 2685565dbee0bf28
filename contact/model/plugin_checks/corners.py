"""Corners of a profile: checks of declared kinks, and a search for corners that are not declared.

A strong corner is enclosed by halving intervals towards the larger change of the slope. A faint
corner stands out in differences of sixth order, in which smooth parts vanish. A smooth but sharp
bend looks like a corner from afar. So a corner counts only if its jump stays the same when it is
estimated from shorter distances.
"""

from collections.abc import Callable, Iterator

import numpy as np

from contact.model.plugin_checks.jumps import (
    BEND_STEP,
    CHECKS,
    declared_jumps,
    jumps_at,
    room_around,
    slope_jumps,
    unlikely_border,
)
from contact.model.profiles.base import Profile
from contact.model.profiles.derive import DETAIL
from contact.model.profiles.noise import EPS, PLACES, deviations
from sie import Array


def kinks(profile: Profile, x: Array) -> Iterator[str]:
    """Messages about wrongly declared kinks: declared jumps that the slope does not have, and
    corners that are not declared.
    """
    lo, hi = float(x[0]), float(x[-1])
    width = hi - lo
    if profile.period is not None:
        # The search starts at a place where a kink is unlikely, and covers one period from there. A
        # kink at the border of the profile's own cell then lies inside the searched interval.
        width = profile.period
        lo = unlikely_border(profile)
    scale = float(np.max(np.abs(np.asarray(profile.slope(x)))))
    declared = np.asarray(profile.kinks, dtype=np.float64).reshape(-1, 2)
    slope, reach, rounding = _sharp_slope(profile, width, x)
    points = np.asarray(profile.algebraic_points, dtype=np.float64)
    jumps, errors = declared_jumps(
        slope, declared, np.full(len(declared), 2 * reach), points, rounding
    )
    for (s, jump), seen, error in zip(declared, jumps, errors, strict=True):
        if error > 0.0:
            yield (
                f"kink declared at x = {s:.6g} m with the jump {jump:.6g}, but the slope jumps by "
                f"{seen:.6g} there"
            )
    for s, jump in slope_jumps(slope, lo, lo + width, reach, max(scale, rounding / CHECKS.jump)):
        at = float(profile.wrap(s)) if profile.period is not None else s
        away = np.abs(np.append(declared[:, 0], points[:, 0]) - at)
        if profile.period is not None:
            away = np.minimum(away, profile.period - away)
        if np.any(away <= max(4 * reach, 1e-6 * width)):
            continue
        found = _followed(profile, s, jump, 4 * reach)
        if found is not None:
            at = float(profile.wrap(found[0])) if profile.period is not None else found[0]
            yield (
                f"the slope jumps by {found[1]:.6g} at x = {at:.9g} m, but the profile does "
                "not declare this jump in `kinks`"
            )


def _followed(profile: Profile, s: float, jump: float, h: float) -> tuple[float, float] | None:
    """Position and slope jump of a corner near s; None if there is no corner.
    They are found from finite differences over shorter and shorter distances h.

    As h decreases, the jump at a smooth but sharp bend falls, and a jump due to round-off grows.
    """
    least, found = max(64 * EPS * abs(s), BEND_STEP * h), None
    while h > least:
        at = s + h * np.linspace(-1, 1, 17)
        h /= 4
        if profile.slope_is_derived:
            right, here, left = (np.asarray(profile.height(at + k * h)) for k in (1, 0, -1))
            bends = (right - 2 * here + left) / h
            rounding = 4 * EPS * float(np.max(np.abs(here))) / h
        else:
            right, left = (np.asarray(profile.slope(at + k * h)) for k in (1, -1))
            bends, rounding = right - left, 4 * EPS * float(np.max(np.abs(right)))
        if rounding > CHECKS.unchanged * abs(jump):
            break
        s = float(at[np.argmax(np.abs(bends))])
        around = s + h * np.array([-3.0, -1.0, 1.0, 3.0])
        if profile.slope_is_derived:
            rises = np.diff(np.asarray(profile.height(around))) / (2 * h)
            seen = float(rises[2] - rises[0])
        else:
            seen = float(np.diff(np.asarray(profile.slope(around[1:3])))[0])
        if not 0.5 < abs(seen / jump) < 3.0:
            return None
        jump, found = seen, (s, seen)
    return found


def _sharp_slope(
    profile: Profile, width: float, x: Array
) -> tuple[Callable[[Array], Array], float, float]:
    """(slope, reach, rounding): the slope as a function, and the round-off of its values.
    The function is not to be used at distances below `reach` from a corner.
    """
    if not profile.slope_is_derived:
        return (lambda x: np.asarray(profile.slope(x))), 1e-10 * width, 0.0
    # A slope that is computed numerically from heights is wrong near a corner. Differences of the
    # height over a short step h show the corner, smeared over h.
    h = 1e-6 * width
    rounding = 4 * EPS * float(np.max(np.abs(np.asarray(profile.height(x))))) / h

    def slope(x: Array) -> Array:
        rise = np.asarray(profile.height(x + h)) - np.asarray(profile.height(x - h))
        return np.asarray(rise / (2 * h))

    return slope, h, rounding


def undeclared_corner(profile: Profile, intervals: Array) -> str:
    """A message on the first undeclared corner in intervals (n, 2) [m]; "" if there is none."""
    for lo, hi in intervals.tolist():
        found = corner(profile, lo, hi)
        if found is not None:
            at = float(profile.wrap(found[0]))
            return (
                f"the slope jumps by {found[1]:.6g} at x = {at:.9g} m, but the profile does "
                "not declare this jump in `kinks`"
            )
    return ""


def corner(profile: Profile, lo: float, hi: float) -> tuple[float, float] | None:
    """Position and slope jump of the most conspicuous undeclared corner; None without a corner.
    The corner is sought in the interval from `lo` to `hi`.
    """
    function = profile.height if profile.slope_is_derived else profile.slope
    # There are `per_length` = 256 samples in the smallest length over which the profile varies.
    # Sixth differences of a smooth profile are then about (2 pi / 256)^6 of its amplitude. More
    # samples would make a corner of the heights less visible.
    per_length = DETAIL.min_samples
    count = per_length * (hi - lo) / (profile.resolution or hi - lo)
    count = int(np.clip(count, DETAIL.samples, DETAIL.max_samples))
    x = np.linspace(lo, hi, count + 1)
    rough, last = _roughness(function, x)
    declared = _repeated(profile, np.asarray(profile.breakpoints, dtype=np.float64))
    holds_one = np.diff(np.searchsorted(declared, (x[:-last], x[last:])), axis=0)[0] > 0
    rough[holds_one] = 0.0
    i = int(np.argmax(rough))
    if not rough[i] > CHECKS.stands_out * float(np.median(rough)):
        return None
    a, b = float(x[i]), float(x[i + last])
    # The interval (a, b) around the corner shrinks until round-off hides the corner, or until its
    # width is round-off of the places or of the searched length hi - lo. Without hi - lo, an
    # interval around a corner at 0 would shrink to underflow.
    while b - a > 64 * EPS * max(abs(a), abs(b), hi - lo):
        x = np.linspace(a, b, 4 * last + 1)
        rough, last = _roughness(function, x)
        i = int(np.argmax(rough))
        if not rough[i] > 64 * EPS * float(np.abs(function(x)).max()):
            break
        a, b = float(x[i]), float(x[i + last])
    # If the last interval (a, b) around the corner contains 0, the corner is taken to be at 0.
    at = np.array([0.0 if a <= 0.0 <= b else 0.5 * (a + b)])
    room = room_around(at, np.append(declared, (lo, hi)), hi - lo, periodic=False)
    seen = jumps_at(profile, at, room, nearest=4 * (b - a))
    jump, doubt = float(seen.height[0, 0]), float(seen.doubt[0, 0])
    return (float(at[0]), jump) if seen.sharp[0, 0] and abs(jump) > 10 * doubt else None


def _roughness(function: Callable[[Array], Array], x: Array) -> tuple[Array, int]:
    """Deviation from a smooth function, for every group of seven successive samples.
    The second value is the number of steps in a group (six).
    """
    values = np.asarray(function(x), dtype=np.float64)
    groups = np.lib.stride_tricks.sliding_window_view(values, len(PLACES))
    rough = deviations(groups.T)
    return np.where(np.isfinite(rough), rough, 0.0), len(PLACES) - 1


def _repeated(profile: Profile, places: Array) -> Array:
    """The places in the cell and their copies in the two adjacent cells, in ascending order.
    Without a period, these are only the places themselves.
    """
    if profile.period is not None:
        places = np.concatenate([places + turn * profile.period for turn in (-1, 0, 1)])
    return np.sort(places)
