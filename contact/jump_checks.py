"""Jumps and powers in a profile, seen from its values: what `contact.testing` holds declared ones
against.

Jumps of f', f'' and f''' at a place are seen from its two sides. On either side a polynomial goes
through points s +- h, s +- 2h, ... and is differentiated at s, for a ladder of steps h. Long steps
reach past what the shape does beside s, short ones lose their digits to rounding: the step is
chosen where two neighbours agree best. A bend that is smooth, only sharp, looks like a jump from
afar: a jump counts as one only if it is there from as near as rounding lets.
"""

import dataclasses
from collections.abc import Callable, Iterator
from math import ceil, comb, factorial, log2

import numpy as np

from contact.model.profiles.base import Profile
from contact.model.profiles.derive import detail_of
from sie import Array, Mask

_A_SIDE = 6  # points beside a place
_DIFFERENCES = 8  # order of the differences that tell powers from what is smooth
_POWER = 2e-3  # of a declared power: what may be missing of it
_FALLING = 0.7  # of what is missing at a step: what is smooth leaves less at the next one
_HALVED = 30  # steps, each half of the one before
_POINTS = 400
_RESOLVED = 1e-2  # of a window: a smallest length of the shape that is well seen in it
_UNIT = float(np.finfo(float).eps)
_CLEAR = 0.05  # of a jump: rounding below this still shows it
_UNCHANGED = 0.2  # of a jump: how far it may seem to change from nearer by
_NEAREST = 1e-8  # of where a kink is first seen: from how near it is looked at
_JUMP = 1e-3  # of the largest slope: a jump smaller than this cannot be told from a steep slope
# of a declared jump, and of the largest slope over the window to the power that fits: less is
# rounding
_STEP = 1e-6
_ONE = 1e-12  # of the window: places this near are one
_FARTHEST = 0.1  # of the window: how far to look from a place
# of the window: differences of the slope over this show the second derivative where it is smooth
_BEND = 1e-7
_PLACED = 1e-9  # of the window: how well the place of a jump is known then
_MOST_BENDS = 50  # places looked at where the second derivative seems to jump


@dataclasses.dataclass(frozen=True)
class Seen:
    """Jumps of f^(1), f^(2), f^(3), one place a row: their heights, how far these may be off, and
    whether each is there from near by.
    """

    height: Array
    doubt: Array
    sharp: Mask


def jumps_at(profile: Profile, places: Array, reach: Array, nearest: float = 0.0) -> Seen:
    """Jumps at places, looked at from no farther than `reach` (one for each place, beyond which
    there may be other jumps).

    nearest: the shortest step, for places that are not known to the last digit.
    """
    # f' where the author gives it, else f: a derived slope takes its points from both sides.
    first = 0 if profile.slope_is_derived else 1
    function = profile.height if profile.slope_is_derived else profile.slope
    k = np.arange(1.0, _A_SIDE + 1)
    # Row m of the inverse holds the weights of the m-th derivative at 0 over m!, for points a step
    # apart.
    taylor = np.linalg.inv(np.vander(k, increasing=True))
    seen, rounding = np.zeros((_HALVED, len(places), 3)), np.full((_HALVED, len(places), 3), np.inf)
    for j in range(_HALVED):
        h = reach / _A_SIDE * 0.5**j
        if j > 1 and not np.any(h >= nearest):
            break
        right, left = (
            np.asarray(function(places[:, None] + side * h[:, None] * k), dtype=float)
            for side in (1, -1)
        )
        size = np.maximum(np.abs(right), np.abs(left)).max(axis=1)
        # The place itself is rounded too: by what that moves the values.
        moved = np.abs(places) / h * np.maximum(np.ptp(right, axis=1), np.ptp(left, axis=1))
        for order in (1, 2, 3):
            m = order - first
            weights = taylor[m] * factorial(m)
            seen[j, :, order - 1] = (right @ weights - (-1.0) ** m * (left @ weights)) / h**m
            rounding[j, :, order - 1] = 2 * _UNIT * (size + moved) * np.abs(weights).sum() / h**m
        rounding[j, h < nearest] = np.inf
    off = np.abs(np.diff(seen, axis=0)) + rounding[1:]
    best = np.argmin(off, axis=0)
    height, doubt = (np.take_along_axis(a, best[None], axis=0)[0] for a in (seen[1:], off))
    near = (rounding[1:] <= _CLEAR * np.abs(height)) & (
        np.arange(_HALVED - 1)[:, None, None] >= best
    )
    sharp = np.all(~near | (np.abs(seen[1:] - height) <= _UNCHANGED * np.abs(height)), axis=0)
    return Seen(height, doubt, sharp)


def kinks(profile: Profile, x: Array) -> Iterator[str]:
    lo, hi = float(x[0]), float(x[-1])
    width = hi - lo
    if profile.period is not None:
        # A cell that starts off any likely kink, so that the border of the profile's own cell lies
        # inside.
        width = profile.period
        lo = profile.x0 - 0.0123456789 * width
    scale = float(np.max(np.abs(np.asarray(profile.slope(x)))))
    declared = np.asarray(profile.kinks, dtype=np.float64).reshape(-1, 2)
    slope, reach, rounding = _sharp_slope(profile, width, x)
    points = np.asarray(profile.algebraic_points, dtype=np.float64)
    for s, jump in declared:
        seen = float(np.diff(slope(np.array([s - 2 * reach, s + 2 * reach])))[0])
        # An algebraic point of an exponent near 1 looks like a kink from anywhere.
        seen -= sum(
            (left + right) * n * (2 * reach) ** (n - 1) for at, n, left, right in points if at == s
        )
        if abs(seen - jump) > _JUMP * max(scale, abs(jump)) + rounding:
            yield f"kink declared at {s:.6g} with jump {jump:.6g}: the slope jumps by {seen:.6g} there"
    for s, jump in slope_jumps(slope, lo, lo + width, reach, max(scale, rounding / _JUMP)):
        at = float(profile.wrap(s)) if profile.period is not None else s
        away = np.abs(np.append(declared[:, 0], points[:, 0]) - at)
        if profile.period is not None:
            away = np.minimum(away, profile.period - away)
        if np.any(away <= max(4 * reach, 1e-6 * width)):
            continue
        found = _kink(profile, s, jump, 4 * reach)
        if found is not None:
            at = float(profile.wrap(found[0])) if profile.period is not None else found[0]
            yield f"the slope jumps by {found[1]:.6g} at {at:.9g}, and kinks does not say so"


def _kink(profile: Profile, s: float, jump: float, h: float) -> tuple[float, float] | None:
    """Place and jump of a kink about s, looked at from ever nearer, as far as rounding lets.

    None where there is no kink: the jump of a bend that is only sharp falls with the distance,
    that of rounding grows.
    """
    least, found = max(64 * _UNIT * abs(s), _NEAREST * h), None
    while h > least:
        at = s + h * np.linspace(-1, 1, 17)
        h /= 4
        if profile.slope_is_derived:
            right, here, left = (np.asarray(profile.height(at + k * h)) for k in (1, 0, -1))
            bends, rounding = (
                (right - 2 * here + left) / h,
                4 * _UNIT * float(np.max(np.abs(here))) / h,
            )
        else:
            right, left = (np.asarray(profile.slope(at + k * h)) for k in (1, -1))
            bends, rounding = right - left, 4 * _UNIT * float(np.max(np.abs(right)))
        if rounding > _CLEAR * abs(jump):
            break
        s = float(at[np.argmax(np.abs(bends))])
        beside = s + h * np.array([-3.0, -1.0, 1.0, 3.0])
        if profile.slope_is_derived:
            rises = np.diff(np.asarray(profile.height(beside))) / (2 * h)
            seen = float(rises[2] - rises[0])
        else:
            seen = float(np.diff(np.asarray(profile.slope(beside[1:3])))[0])
        if not 0.5 < abs(seen / jump) < 3.0:
            return None
        jump, found = seen, (s, seen)
    return found


def _sharp_slope(
    profile: Profile, width: float, x: Array
) -> tuple[Callable[[Array], Array], float, float]:
    """The slope, the distance at which its two sides can be told apart, and its rounding."""
    if not profile.slope_is_derived:
        return (lambda x: np.asarray(profile.slope(x))), 1e-10 * width, 0.0
    # The derived slope is no use beside a kink; short differences of the height blur it by their
    # step only.
    h = 1e-6 * width
    rounding = 4 * _UNIT * float(np.max(np.abs(np.asarray(profile.height(x))))) / h
    return (
        (
            lambda x: (
                (np.asarray(profile.height(x + h)) - np.asarray(profile.height(x - h))) / (2 * h)
            )
        ),
        h,
        rounding,
    )


def slope_jumps(
    slope: Callable[[Array], Array], lo: float, hi: float, reach: float, scale: float
) -> list[tuple[float, float]]:
    """Where the slope jumps: intervals of a fine grid, halved towards the larger change down to
    `reach`.
    """
    edges = np.linspace(lo, hi, 2001)
    a, b = edges[:-1], edges[1:]
    fa, fb = slope(a), slope(b)
    for _ in range(max(0, ceil(log2((hi - lo) / 2000 / (4 * reach))))):
        m = (a + b) / 2
        fm = slope(m)
        left = np.abs(fm - fa) >= np.abs(fb - fm)
        a, fa = np.where(left, a, m), np.where(left, fa, fm)
        b, fb = np.where(left, m, b), np.where(left, fm, fb)
    found = np.abs(fb - fa) > _JUMP * scale
    places: list[tuple[float, float]] = []
    for s, jump in zip((a + b)[found] / 2, (fb - fa)[found], strict=True):
        if not places or s - places[-1][0] > 16 * reach:
            places.append((float(s), float(jump)))
    return places


def higher_jumps(profile: Profile, x: Array) -> Iterator[str]:
    jumps = np.asarray(profile.jumps)
    if jumps.ndim != 2 or jumps.shape[1] != 3 or not np.isin(jumps[:, 1], (2, 3)).all():
        yield "jumps must be an array of shape (k, 3): position, order 2 or 3, jump of that derivative"
        return
    lo, hi = window_of(profile) if profile.period is not None else (float(x[0]), float(x[-1]))
    width, periodic, ends = hi - lo, profile.period is not None, ends_of(profile)
    declared = _declared_places(profile, lo, width)
    seen = jumps_at(profile, declared, _reach(declared, np.append(declared, ends), width, periodic))
    scale = float(np.max(np.abs(np.asarray(profile.slope(x)))))
    yield from _against_declared(profile, declared, seen, scale, width)
    if profile.slope_is_derived or not scale > 0:
        return
    found = _bends(profile, lo, width, scale)
    away = np.abs(found[:, None] - np.append(declared, _rough(profile)))
    away = np.minimum(away, width - away) if periodic else away
    found = np.sort(found[np.all(away > 1e-5 * width, axis=1)])
    if len(found):
        reach = _reach(found, np.concatenate((declared, found, ends)), width, periodic)
        seen = jumps_at(profile, found, reach, nearest=100 * _BEND * width)
        # Both sides' slopes are continued to a place beside that of the jump: there they differ by
        # the distance times it.
        beside = seen.height[:, 0] / np.where(seen.height[:, 1] == 0, np.inf, seen.height[:, 1])
        found = found - np.where(np.abs(beside) < 10 * _BEND * width, beside, 0.0)
        seen = jumps_at(profile, found, reach, nearest=_PLACED * width)
        yield from _against_declared(profile, found, seen, scale, width)


def _declared_places(profile: Profile, lo: float, width: float) -> Array:
    """Where something may jump by what the profile says of itself; the border of its cell is one of
    them.
    """
    tips = [] if profile.summits is None else [np.asarray(profile.summits, dtype=np.float64)]
    border = [lo] if profile.period is not None else []
    places = np.unique(
        np.concatenate(
            (border, profile.kinks[:, 0], profile.jumps[:, 0], profile.breakpoints, *tips)
        )
    )
    places = places[np.append(True, np.diff(places) > _ONE * width)] if len(places) else places
    # Derivatives of low powers are infinite there; `powers` sees to these.
    places = np.setdiff1d(places, _rough(profile))
    if ends := ends_of(profile):
        places = places[(places > ends[0]) & (places < ends[1])]
    return np.asarray(places)


def _rough(profile: Profile) -> Array:
    """Algebraic points at which the third derivative is not continuous."""
    points = np.asarray(profile.algebraic_points, dtype=np.float64)
    return np.asarray(np.unique(points[points[:, 1] <= 3.0, 0]))


def powers(profile: Profile, x: Array) -> Iterator[str]:
    """Algebraic points by differences of an order so high that all that is smooth vanishes faster
    than the powers, on either side.
    """
    points = np.asarray(profile.algebraic_points, dtype=np.float64)
    lo, hi = window_of(profile)
    others = np.concatenate((profile.breakpoints, ends_of(profile)))
    for s in np.unique(points[:, 0]):
        reach = float(_reach(np.array([s]), others, hi - lo, profile.period is not None)[0])
        for side, column in ((-1.0, 2), (1.0, 3)):
            n, c = points[points[:, 0] == s][:, [1, column]].T
            ratio = _power_left(profile, float(s), side * reach, n, c)
            if ratio > _POWER:
                told = ", ".join(
                    f"{one:.6g} |x - s|^{power:.6g}" for power, one in zip(n, c, strict=True)
                )
                where = "left" if side < 0 else "right"
                yield f"algebraic point declared at {s:.6g}, {told} on its {where}: the profile differs by {ratio:.2g} of that"


def _power_left(profile: Profile, s: float, reach: float, n: Array, c: Array) -> float:
    """The least part of declared powers that high differences of the profile do not show, over a
    ladder of steps; 0 where rounding hides them, or hides them before what is smooth has fallen
    away.
    """
    derived = profile.slope_is_derived
    function = profile.height if derived else profile.slope
    power, size = (n, c) if derived else (n - 1, np.sign(reach) * n * c)
    weights = np.array([(-1.0) ** k * comb(_DIFFERENCES, k) for k in range(_DIFFERENCES + 1)])
    found = []
    for j in range(_HALVED):
        # Not at s itself: of a low power the rounding of the place is seen there.
        y = abs(reach) / (_DIFFERENCES + 1) * 0.5**j * np.arange(1, _DIFFERENCES + 2)
        values = np.asarray(function(s + np.sign(reach) * y), dtype=np.float64)
        declared = float(weights @ (y[:, None] ** power @ size))
        # Of the places too: next to s these are told to a few digits.
        rounding = _UNIT * float(np.abs(weights) @ np.abs(values)) * (1.0 + abs(s) / y[0])
        if abs(declared) > 10 * rounding / _POWER:
            found.append(abs(float(weights @ values) - declared) / abs(declared))
    return 0.0 if len(found) < 3 or found[-1] < _FALLING * found[-2] else min(found)


def _reach(places: Array, others: Array, width: float, periodic: bool) -> Array:
    """How far from each place there is no other, with a little room."""
    others = np.concatenate((others, others - width, others + width)) if periodic else others
    others = np.concatenate(([-np.inf], np.sort(others), [np.inf]))
    before = others[np.searchsorted(others, places - _ONE * width) - 1]
    after = others[np.searchsorted(others, places + _ONE * width)]
    return np.asarray(
        np.minimum(0.9 * np.minimum(places - before, after - places), _FARTHEST * width)
    )


def _against_declared(
    profile: Profile, places: Array, seen: Seen, scale: float, width: float
) -> Iterator[str]:
    """Jumps of the second and third derivative at each place against what is declared there;
    `kinks` sees to those of the slope.
    """
    for order in (2, 3):
        listed = profile.jumps[profile.jumps[:, 1] == order]
        which = np.searchsorted(places, listed[:, 0] - _ONE * width)
        known = which < len(places)
        known[known] = places[which[known]] <= listed[known, 0] + _ONE * width
        claimed = np.bincount(which[known], listed[known, 2], len(places))
        height, doubt = seen.height[:, order - 1], seen.doubt[:, order - 1]
        off = np.abs(height - claimed) - 10 * doubt
        least = np.maximum(
            _STEP * np.maximum(np.abs(height), np.abs(claimed)),
            _STEP * scale / width ** (order - 1),
        )
        for i in np.flatnonzero((off > least) & ((claimed != 0) | seen.sharp[:, order - 1])):
            s = places[i]
            if claimed[i]:
                yield f"jump declared at {s:.6g} of order {order}, {claimed[i]:.6g}: the profile shows {height[i]:.6g}"
            else:
                row = f"[{s:.9g}, {order}, {height[i]:.6g}]"
                yield f"derivative {order} jumps by {height[i]:.6g} at {s:.9g}, and jumps does not say so: {row}"


def _bends(profile: Profile, lo: float, width: float, scale: float) -> Array:
    """Where the second derivative seems to jump, to a few steps of its differences."""
    h = _BEND * width
    if profile.period is not None:
        lo -= 0.0123456789 * width  # so that the border of the cell lies inside

    def bend(x: Array) -> Array:
        return np.asarray(
            (np.asarray(profile.slope(x + h)) - np.asarray(profile.slope(x - h))) / (2 * h)
        )

    first, last = (
        (lo, lo + width) if profile.period is not None else (lo + 2 * h, lo + width - 2 * h)
    )
    size = max(float(np.max(np.abs(bend(np.linspace(first, last, 997))))), scale / width)
    places = np.array([s for s, _ in slope_jumps(bend, first, last, 2 * h, size)][:_MOST_BENDS])
    return (
        np.asarray(profile.wrap(places), dtype=np.float64) if profile.period is not None else places
    )


def window_of(profile: Profile) -> tuple[float, float]:
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
    """Half width [m] of a window about 0 in which a shape is smooth and finite, else 1 m."""
    half = 1.0
    for _ in range(_HALVED):
        with np.errstate(all="ignore"):
            finite = np.isfinite(
                np.asarray(profile.height(np.linspace(-half, half, _POINTS)))
            ).all()
        if finite and detail_of(profile.height, -half, half) > _RESOLVED * half:
            return half
        half /= 4
    return 1.0


def ends_of(profile: Profile) -> tuple[float, ...]:
    """Where a profile without a period begins and ends; empty of one that goes on."""
    return (profile.support or profile.extent or ()) if profile.period is None else ()
