"""Jumps of a profile's derivatives, and its algebraic points, estimated from values of the profile.

Jumps of f', f'' and f''' at a place s are estimated from values on its two sides. On either side a
polynomial goes through the values at distances h, 2h, ... from s and is differentiated at s. The
step h is halved again and again. Long steps reach past the features of the shape near s, and short
steps lose digits to round-off: the step is chosen at which two successive estimates agree best. A
smooth but sharp bend looks like a jump from afar. So a jump counts only if it stays the same when
it is estimated from shorter distances, as far as round-off permits.
"""

import dataclasses
from collections.abc import Callable, Iterator
from math import ceil, comb, factorial, log2

import numpy as np

from contact.model.profiles.base import Profile
from contact.model.profiles.derive import DETAIL, detail_of
from contact.model.profiles.noise import EPS, ROUND_OFF
from sie import Array, Mask


@dataclasses.dataclass(frozen=True)
class CheckOptions:
    """Tolerances by which checks tell a user's true declarations (kinks, ...) from false ones.

    points: number of points on either side of a place from which jumps are estimated. Also the
        order of the differences that separate powers of the distance from smooth parts.
    unchanged: largest relative change of a jump between two distances from which it is estimated.
        Also the largest relative round-off of such an estimate, and the largest relative error of a
        declared jump that is small.
    jump: smallest jump of the slope that counts as a kink, relative to the largest slope. Smaller
        changes may be a steep slope. Twice this fraction of a declared power may be missing.
    same: largest relative difference of two values that agree.
    stands_out: deviation from a smooth function, divided by the median deviation, above which a
        place is examined. 16 to 256 find the same corners.
    slowest_fall: exponent n. For short waves, the symbol L of a body must approach 1 faster than
        q^n, with q the wave number.
    """

    points: int = 6
    unchanged: float = 0.1
    jump: float = 1e-3
    same: float = 1e-6
    stands_out: float = 64.0
    slowest_fall: float = -8.0


CHECKS = CheckOptions()
# Number of halvings of a step until it is round-off relative to the first step.
_HALVINGS = int(-np.log2(ROUND_OFF))
# Step of the differences that estimate the second derivative, relative to the checked interval. A
# corner is examined at distances that decrease to this fraction of the first distance.
BEND_STEP = np.sqrt(ROUND_OFF)


def unlikely_border(profile: Profile) -> float:
    """Left end of a cell, chosen where a kink is unlikely."""
    assert profile.period is not None
    return profile.x0 - (np.sqrt(2) - 1) * profile.period


@dataclasses.dataclass(frozen=True)
class JumpEstimates:
    """Estimated jumps of the first, second and third derivatives of f, one row for each place.

    height: the jumps. doubt: their errors. sharp: whether a jump stays the same when it is
    estimated from shorter distances.
    """

    height: Array
    doubt: Array
    sharp: Mask


def jumps_at(profile: Profile, places: Array, reach: Array, nearest: float = 0.0) -> JumpEstimates:
    """Estimated jumps of the derivatives at `places`, from values of the profile close to them.

    Place number i uses values at distances up to `reach[i]` on both sides.

    nearest: the shortest step, for places that are not known to the last digit.
    """
    # Values of f' are used if the author defines f', otherwise values of f. A slope computed from f
    # would mix points from both sides of a jump.
    first = 0 if profile.slope_is_derived else 1
    function = profile.height if profile.slope_is_derived else profile.slope
    k = np.arange(1.0, CHECKS.points + 1)
    # Row m of the inverse holds the weights that give the Taylor coefficient f^(m)(0)/m! from the
    # values at 1, 2, 3, ...
    taylor = np.linalg.inv(np.vander(k, increasing=True))
    shape = (_HALVINGS, len(places), 3)
    seen, rounding = np.zeros(shape), np.full(shape, np.inf)
    for j in range(_HALVINGS):
        h = reach / CHECKS.points * 0.5**j
        if j > 1 and not np.any(h >= nearest):
            break
        right, left = (
            np.asarray(function(places[:, None] + side * h[:, None] * k), dtype=float)
            for side in (1, -1)
        )
        size = np.maximum(np.abs(right), np.abs(left)).max(axis=1)
        # The places are known up to round-off. This changes the values of the function close to
        # them.
        moved = np.abs(places) / h * np.maximum(np.ptp(right, axis=1), np.ptp(left, axis=1))
        for order in (1, 2, 3):
            m = order - first
            weights = taylor[m] * factorial(m)
            seen[j, :, order - 1] = (right @ weights - (-1.0) ** m * (left @ weights)) / h**m
            rounding[j, :, order - 1] = 2 * EPS * (size + moved) * np.abs(weights).sum() / h**m
        rounding[j, h < nearest] = np.inf
    change = np.abs(np.diff(seen, axis=0)) + rounding[1:]
    best = np.argmin(change, axis=0)
    height, doubt = (np.take_along_axis(a, best[None], axis=0)[0] for a in (seen[1:], change))
    nearer = np.arange(_HALVINGS - 1)[:, None, None] >= best
    nearer &= rounding[1:] <= CHECKS.unchanged * np.abs(height)
    same = np.abs(seen[1:] - height) <= CHECKS.unchanged * np.abs(height)
    return JumpEstimates(height, doubt, np.all(~nearer | same, axis=0))


def declared_jumps(
    slope: Callable[[Array], Array],
    kinks: Array,
    distance: Array,
    powers: Array,
    rounding: float = 0.0,
) -> tuple[Array, Array]:
    """Jumps of `slope` at declared kinks (n, 2), and errors of the jumps minus allowed errors.

    The slope is read at `distance` and at half of it on both sides of each kink, and the jump is
    extrapolated to the kink. A declared jump is false if its entry of the second array is positive.
    powers: the algebraic points of the profile. rounding: additional round-off of `slope`, as that
    of a difference quotient.
    """
    at, declared = kinks.T
    seen, size = [], np.abs(declared)
    for d in (distance, distance / 2):
        left, right = (np.asarray(slope(at + side * d), dtype=np.float64) for side in (-1, 1))
        jump, size = right - left, np.maximum(size, np.maximum(np.abs(left), np.abs(right)))
        for s, n, on_left, on_right in powers:
            # If the kink is also an algebraic point, the power of the distance adds a difference
            # between the slopes on the two sides. This difference is subtracted from `jump`.
            jump -= np.where(at == s, (on_left + on_right) * n * d ** (n - 1), 0.0)
        seen.append(jump)
    jump = 2 * seen[1] - seen[0]
    doubt = 2 * np.abs(seen[1] - seen[0]) + 16 * EPS * size + rounding
    allowed = np.minimum(CHECKS.jump * size, CHECKS.unchanged * np.abs(declared)) + doubt
    return jump, np.abs(jump - declared) - allowed


def slope_jumps(
    slope: Callable[[Array], Array], lo: float, hi: float, reach: float, scale: float
) -> list[tuple[float, float]]:
    """Places and sizes of the jumps of a function `slope` in the interval from lo to hi.

    Intervals of a fine grid are halved towards the larger change, down to about `reach`. A change
    counts if it exceeds the fraction `CheckOptions.jump` of `scale`.
    """
    cells = 2 * DETAIL.samples
    edges = np.linspace(lo, hi, cells + 1)
    a, b = edges[:-1], edges[1:]
    fa, fb = slope(a), slope(b)
    for _ in range(max(0, ceil(log2((hi - lo) / cells / (4 * reach))))):
        m = (a + b) / 2
        fm = slope(m)
        left = np.abs(fm - fa) >= np.abs(fb - fm)
        a, fa = np.where(left, a, m), np.where(left, fa, fm)
        b, fb = np.where(left, m, b), np.where(left, fm, fb)
    found = np.abs(fb - fa) > CHECKS.jump * scale
    places: list[tuple[float, float]] = []
    for s, jump in zip((a + b)[found] / 2, (fb - fa)[found], strict=True):
        if not places or s - places[-1][0] > 16 * reach:
            places.append((float(s), float(jump)))
    return places


def higher_jumps(profile: Profile, x: Array) -> Iterator[str]:
    """Messages about jumps of f'' and f''' that are falsely declared or not declared."""
    jumps = np.asarray(profile.jumps)
    if jumps.ndim != 2 or jumps.shape[1] != 3 or not np.isin(jumps[:, 1], (2, 3)).all():
        yield (
            "jumps must be an array of shape (k, 3); its columns are the position, the order "
            "of the derivative (2 or 3), and the jump of this derivative"
        )
        return
    lo, hi = window_of(profile) if profile.period is not None else (float(x[0]), float(x[-1]))
    width, periodic, ends = hi - lo, profile.period is not None, ends_of(profile)
    declared = _declared_places(profile, lo, width)
    room = room_around(declared, np.append(declared, ends), width, periodic)
    scale = float(np.max(np.abs(np.asarray(profile.slope(x)))))
    seen = jumps_at(profile, declared, room)
    yield from _against_declared(profile, declared, seen, scale, width)
    if profile.slope_is_derived or not scale > 0:
        return
    found = _bends(profile, lo, width, scale)
    away = np.abs(found[:, None] - np.append(declared, _rough(profile)))
    away = np.minimum(away, width - away) if periodic else away
    found = np.sort(found[np.all(away > 1e-5 * width, axis=1)])
    if len(found):
        step = BEND_STEP * width
        room = room_around(found, np.concatenate((declared, found, ends)), width, periodic)
        seen = jumps_at(profile, found, room, nearest=100 * step)
        # The place found by differences is at an unknown distance d from the true jump of f''. The
        # slopes extrapolated to this place from its two sides differ by about d times the jump. So
        # d is this difference divided by the jump.
        distance = seen.height[:, 0] / np.where(seen.height[:, 1] == 0, np.inf, seen.height[:, 1])
        found = found - np.where(np.abs(distance) < 10 * step, distance, 0.0)
        seen = jumps_at(profile, found, room, nearest=step / 100)
        yield from _against_declared(profile, found, seen, scale, width)


def _declared_places(profile: Profile, lo: float, width: float) -> Array:
    """Declared places at which a derivative may jump, and the border of the cell."""
    tips = [] if profile.summits is None else [np.asarray(profile.summits, dtype=np.float64)]
    border = [lo] if profile.period is not None else []
    places = np.unique(
        np.concatenate(
            (border, profile.kinks[:, 0], profile.jumps[:, 0], profile.breakpoints, *tips)
        )
    )
    apart = np.diff(places, prepend=-np.inf) > _one_place(width)
    # Algebraic points of a power up to 3 are left out: there the third derivative is not
    # continuous. The function `powers` checks these points.
    places = np.setdiff1d(places[apart], _rough(profile))
    if ends := ends_of(profile):
        places = places[(places > ends[0]) & (places < ends[1])]
    return np.asarray(places)


def _one_place(width: float) -> float:
    """Distance below which two places in an interval of this width count as one."""
    return ROUND_OFF * width


def _rough(profile: Profile) -> Array:
    """Algebraic points of a power of at most 3, where the third derivative is not continuous."""
    points = np.asarray(profile.algebraic_points, dtype=np.float64)
    return np.asarray(np.unique(points[points[:, 1] <= 3.0, 0]))


def powers(profile: Profile, x: Array) -> Iterator[str]:
    """Messages about wrong algebraic points, found by differences of high order on each side.

    In such differences smooth parts vanish faster than the powers.
    """
    points = np.asarray(profile.algebraic_points, dtype=np.float64)
    lo, hi = window_of(profile)
    others = np.concatenate((profile.breakpoints, ends_of(profile)))
    for s in np.unique(points[:, 0]):
        periodic = profile.period is not None
        room = float(room_around(np.array([s]), others, hi - lo, periodic)[0])
        for side, column in ((-1.0, 2), (1.0, 3)):
            n, c = points[points[:, 0] == s][:, [1, column]].T
            ratio = _missing_power(profile, float(s), side * room, n, c)
            if ratio > 2 * CHECKS.jump:
                terms = ", ".join(
                    f"{one:.6g} |x - s|^{power:.6g}" for power, one in zip(n, c, strict=True)
                )
                where = "left" if side < 0 else "right"
                yield (
                    f"algebraic_points declares {terms} on the {where} of s = {s:.6g}, but the "
                    f"profile differs from this by a fraction of {ratio:.2g}"
                )


def _missing_power(profile: Profile, s: float, room: float, n: Array, c: Array) -> float:
    """Relative deviation of differences of the profile from those of the declared powers.

    The differences are of high order, on one side of the place s. Steps are halved again and again,
    and the smallest deviation is returned. The result is 0 if round-off hides the powers at all
    steps for which the smooth part is negligible.
    """
    derived = profile.slope_is_derived
    function = profile.height if derived else profile.slope
    power, size = (n, c) if derived else (n - 1, np.sign(room) * n * c)
    order = CHECKS.points
    weights = np.array([(-1.0) ** k * comb(order, k) for k in range(order + 1)])
    found = []
    for j in range(_HALVINGS):
        # The value at the point s itself is not used: for a low power, the round-off of s changes
        # this value strongly.
        y = abs(room) / (order + 1) * 0.5**j * np.arange(1, order + 2)
        values = np.asarray(function(s + np.sign(room) * y), dtype=np.float64)
        declared = float(weights @ (y[:, None] ** power @ size))
        # The places have the round-off `EPS` |s|. This changes the values at the distance y[0] from
        # s by a fraction of about `EPS` |s| / y[0].
        rounding = EPS * float(np.abs(weights) @ np.abs(values)) * (1.0 + abs(s) / y[0])
        if abs(declared) > 10 * rounding / (2 * CHECKS.jump):
            found.append(abs(float(weights @ values) - declared) / abs(declared))
    # If the last halving of the step still decreased the deviation, the differences still contain
    # the smooth part of the function. Then the deviation is unknown, and 0 is returned.
    return 0.0 if len(found) < 3 or found[-1] < 0.7 * found[-2] else min(found)


def room_around(places: Array, others: Array, width: float, periodic: bool) -> Array:
    """For each place, a distance within which there is none of the places `others`."""
    others = np.concatenate((others, others - width, others + width)) if periodic else others
    others = np.concatenate(([-np.inf], np.sort(others), [np.inf]))
    before = others[np.searchsorted(others, places - _one_place(width)) - 1]
    after = others[np.searchsorted(others, places + _one_place(width))]
    nearest = np.minimum(places - before, after - places)
    return np.asarray(np.minimum(0.9 * nearest, 0.5 * width))


def _against_declared(
    profile: Profile, places: Array, seen: JumpEstimates, scale: float, width: float
) -> Iterator[str]:
    """Messages about wrong jumps of f'' and f''' at the given places.

    `corners.kinks` checks the jumps of f'.
    """
    for order in (2, 3):
        listed = profile.jumps[profile.jumps[:, 1] == order]
        which = np.searchsorted(places, listed[:, 0] - _one_place(width))
        known = which < len(places)
        known[known] = places[which[known]] <= listed[known, 0] + _one_place(width)
        claimed = np.bincount(which[known], listed[known, 2], len(places))
        height, doubt = seen.height[:, order - 1], seen.doubt[:, order - 1]
        error = np.abs(height - claimed) - 10 * doubt
        size = np.maximum(np.abs(height), np.abs(claimed))
        least = CHECKS.same * np.maximum(size, scale / width ** (order - 1))
        for i in np.flatnonzero((error > least) & ((claimed != 0) | seen.sharp[:, order - 1])):
            s = places[i]
            if claimed[i]:
                yield (
                    f"jumps declares that derivative {order} jumps by {claimed[i]:.6g} at {s:.6g}, "
                    f"but it jumps by {height[i]:.6g}"
                )
            else:
                row = f"[{s:.9g}, {order}, {height[i]:.6g}]"
                yield (
                    f"derivative {order} jumps by {height[i]:.6g} at {s:.9g}: add the row {row} to "
                    "jumps"
                )


def _bends(profile: Profile, lo: float, width: float, scale: float) -> Array:
    """Places at which f'' seems to jump, accurate to a few times `BEND_STEP` of the width."""
    h, periodic = BEND_STEP * width, profile.period is not None
    if periodic:
        lo = unlikely_border(profile)

    def bend(x: Array) -> Array:
        rise = np.asarray(profile.slope(x + h)) - np.asarray(profile.slope(x - h))
        return np.asarray(rise / (2 * h))

    first, last = (lo, lo + width) if periodic else (lo + 2 * h, lo + width - 2 * h)
    size = float(np.max(np.abs(bend(np.linspace(first, last, DETAIL.samples)))))
    found = slope_jumps(bend, first, last, 2 * h, max(size, scale / width))
    # A noisy shape seems to bend everywhere. Therefore only the first places are examined, at most
    # a tenth of the number of samples.
    places = np.array([s for s, _ in found][: DETAIL.samples // 10])
    return np.asarray(profile.wrap(places), dtype=np.float64) if periodic else places


def window_of(profile: Profile) -> tuple[float, float]:
    """The interval [m] in which the checks examine a profile."""
    ends = profile.support or profile.extent or profile.known
    if ends is not None:
        return ends
    length = profile.resolution
    if length is None and dataclasses.is_dataclass(profile):
        sizes = [getattr(profile, f.name) for f in dataclasses.fields(profile)]
        length = next((float(s) for s in sizes if isinstance(s, float) and s > 0), None)
    half = length or _half_window(profile)
    return -half, half


def _half_window(profile: Profile) -> float:
    """Half width [m] of an interval about 0 in which a shape is smooth and finite.

    It is 1 m if no such interval is found.
    """
    half = 1.0
    for _ in range(_HALVINGS):
        with np.errstate(all="ignore"):
            x = np.linspace(-half, half, DETAIL.samples)
            finite = np.isfinite(np.asarray(profile.height(x))).all()
        if finite and detail_of(profile.height, -half, half) > 0.01 * half:
            return half
        half /= 4
    return 1.0


def ends_of(profile: Profile) -> tuple[float, ...]:
    """Left and right end of a body without a period; empty if the body has no ends."""
    return (profile.support or profile.extent or ()) if profile.period is None else ()
