"""For authors of profiles and substrates: `check_profile(MyProfile(...))`, `check_substrate(MyBody(...))` say what is wrong with one.

Every claim a profile makes (its slope, period, symmetry, kinks, tips, conjugate) is held against its height; those of a substrate against
its symbol.

Jumps of f', f'' and f''' at a place are seen from its two sides. On either side a polynomial goes through points s +- h, s +- 2h, ... and
is differentiated at s, for a ladder of steps h. Long steps reach past what the shape does beside s, short ones lose their digits to
rounding: the step is chosen where two neighbours agree best. A bend that is smooth, only sharp, looks like a jump from afar: a jump
counts as one only if it is there from as near as rounding lets.
"""

import copy
import dataclasses
import warnings
from collections.abc import Callable, Iterator
from math import ceil, comb, factorial, log2
from typing import Any

import numpy as np

from contact.errors import ContactError, SceneError, shown
from contact.model.declared import require_body, require_declarations
from contact.model.profiles.base import Profile
from contact.model.profiles.derive import detail_of, scale_of, verdicts
from contact.model.substrates.base import Substrate
from sie import Array, Mask

_A_SIDE = 6  # points beside a place
_DIFFERENCES = 8  # order of the differences that tell powers from what is smooth
_POWER = 2e-3  # of a declared power: what may be missing of it
_FALLING = 0.7  # of what is missing at a step: what is smooth leaves less at the next one
_HALVED = 30  # steps, each half of the one before
_UNIT = float(np.finfo(float).eps)
_CLEAR = 0.05  # of a jump: rounding below this still shows it
_UNCHANGED = 0.2  # of a jump: how far it may seem to change from nearer by


@dataclasses.dataclass(frozen=True)
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
    k = np.arange(1.0, _A_SIDE + 1)
    # Row m of the inverse holds the weights of the m-th derivative at 0 over m!, for points a step apart.
    taylor = np.linalg.inv(np.vander(k, increasing=True))
    seen, rounding = np.zeros((_HALVED, len(places), 3)), np.full((_HALVED, len(places), 3), np.inf)
    for j in range(_HALVED):
        h = reach / _A_SIDE * 0.5**j
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
            rounding[j, :, order - 1] = 2 * _UNIT * (size + moved) * np.abs(weights).sum() / h**m
        rounding[j, h < nearest] = np.inf
    off = np.abs(np.diff(seen, axis=0)) + rounding[1:]
    best = np.argmin(off, axis=0)
    height, doubt = (np.take_along_axis(a, best[None], axis=0)[0] for a in (seen[1:], off))
    near = (rounding[1:] <= _CLEAR * np.abs(height)) & (np.arange(_HALVED - 1)[:, None, None] >= best)
    sharp = np.all(~near | (np.abs(seen[1:] - height) <= _UNCHANGED * np.abs(height)), axis=0)
    return Seen(height, doubt, sharp)


_POINTS = 400
_SAME = 1e-9  # of the largest value met: two evaluations of one quantity
_SLOPE = 1e-6  # of the largest slope: what differences of the height can vouch for
_NEAREST = 1e-8  # of where a kink is first seen: from how near it is looked at
_RESOLVED = 1e-2  # of a window: a smallest length of the shape that is well seen in it
_JUMP = 1e-3  # of the largest slope: a jump smaller than this cannot be told from a steep slope
_STEP = 1e-6  # of a declared jump, and of the largest slope over the window to the power that fits: less is rounding
_ONE = 1e-12  # of the window: places this near are one
_FARTHEST = 0.1  # of the window: how far to look from a place
_BEND = 1e-7  # of the window: differences of the slope over this show the second derivative where it is smooth
_PLACED = 1e-9  # of the window: how well the place of a jump is known then
_MOST_BENDS = 50  # places looked at where the second derivative seems to jump
_CONJUGATE = 2e-3  # of the largest slope: the rule below is of second order and kinks cost it digits


class Fault(ContactError, AssertionError):
    """A plug-in that contradicts itself; `report` has the whole list."""

    def __init__(self, report: "Report") -> None:
        super().__init__(str(report))
        self.report = report


class ProfileFault(Fault):
    """A profile that does."""


class SubstrateFault(Fault):
    """A substrate that does."""


@dataclasses.dataclass(frozen=True)
class Report:
    """What was checked, what is wrong, and what could be better."""

    subject: str
    checked: tuple[str, ...]
    faults: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def ok(self) -> bool:
        return not self.faults

    def __str__(self) -> str:
        head = f"{self.subject}: " + ("nothing wrong found" if self.ok else f"{len(self.faults)} fault(s)")
        lines = [f"  - {fault}" for fault in self.faults] + [f"  (note: {note})" for note in self.notes]
        return "\n".join([head, *lines, f"  checked: {', '.join(self.checked)}"])


def check_profile(profile: Profile, window: tuple[float, float] | None = None, raises: bool = True) -> Report:
    """Check what a profile says of itself against its height.

    Parameters
    ----------
    profile : Profile
        The profile.
    window : (float, float) or None
        Where to look [m]; None: its support, extent, cell or a length among its fields.
    raises : bool
        Whether a fault is raised, or only reported.

    Returns
    -------
    Report
        What was checked, what is wrong, and what could be better.

    Raises
    ------
    ProfileFault
        If anything is wrong; it carries the report.

    Examples
    --------
    >>> import contact
    >>> from contact.testing import check_profile
    >>> check_profile(contact.Sinusoid(1e-6, 1e-4)).ok
    True
    """
    checked: list[str] = []
    faults: list[str] = []
    notes: list[str] = []
    if not isinstance(profile, Profile):
        faults.append(f"{type(profile).__name__} does not derive from contact.Profile")
    else:
        x: Array | None = None
        for what, check in _CHECKS:
            checked.append(what)
            try:
                if x is None:
                    x = _points(profile, window)
                with warnings.catch_warnings(), np.errstate(all="ignore"):
                    warnings.simplefilter("ignore")
                    found = list(check(profile, x))
            except Exception as error:  # the author's code may fail in any way; the report says how
                found = [f"{what}: raises {type(error).__name__}: {error}"]
            faults += [f for f in found if not f.startswith("note: ")]
            notes += [f.removeprefix("note: ") for f in found if f.startswith("note: ")]
            if faults and what in ("declarations", "values"):
                break  # the rest would only repeat it
        if profile.slope_is_derived:
            notes.append("slope(x) is derived from the height: a closed form is faster and more accurate")
    return _reported(Report(shown(profile), tuple(checked), tuple(faults), tuple(notes)), ProfileFault if raises else None)


def check_substrate(substrate: Substrate, raises: bool = True) -> Report:
    """Check a substrate: that its symbol is one of an elastic body, and that scenes can hold and compare it.

    Parameters
    ----------
    substrate : Substrate
        The body.
    raises : bool
        Whether a fault is raised, or only reported.

    Returns
    -------
    Report
        What was checked, what is wrong, and what could be better.

    Raises
    ------
    SubstrateFault
        If anything is wrong; it carries the report.

    Examples
    --------
    >>> import contact
    >>> from contact.testing import check_substrate
    >>> check_substrate(contact.Layer(thickness=1e-3, nu=0.3)).ok
    True
    """
    faults: list[str] = []
    notes: list[str] = []
    if not isinstance(substrate, Substrate):
        faults.append(f"{type(substrate).__name__} does not derive from contact.Substrate")
    else:
        try:
            require_body(substrate)
        except ContactError as error:
            faults.append(str(error))
        try:
            if substrate != copy.copy(substrate) or hash(substrate) != hash(copy.copy(substrate)):
                faults.append("it does not equal its own copy: make it a frozen dataclass")
        except Exception as error:  # the author's code may fail in any way; the report says how
            faults.append(f"it cannot be compared or hashed ({type(error).__name__}: {error}): make it a frozen dataclass")
        if not getattr(type(substrate), "name", ""):
            notes.append("it has no name: @contact.register_substrate(\"...\") makes it known to scene files")
    report = Report(shown(substrate), ("symbol", "compression", "copies"), tuple(faults), tuple(notes))
    return _reported(report, SubstrateFault if raises else None)


def _reported(report: Report, fault: type[Fault] | None) -> Report:
    """The report, or the fault that it is raised as."""
    if fault is not None and not report.ok:
        raise fault(report)
    return report


def _window(profile: Profile) -> tuple[float, float]:
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
            finite = np.isfinite(np.asarray(profile.height(np.linspace(-half, half, _POINTS)))).all()
        if finite and detail_of(profile.height, -half, half) > _RESOLVED * half:
            return half
        half /= 4
    return 1.0


def _points(profile: Profile, window: tuple[float, float] | None) -> Array:
    """Seeded positions in the window, none on a kink."""
    lo, hi = _window(profile) if window is None else window
    x = np.sort(np.random.default_rng(1).uniform(lo, hi, _POINTS))
    kinks = profile.kinks
    if np.ndim(kinks) == 2 and np.size(kinks):
        away = np.min(np.abs(x[:, None] - np.asarray(kinks)[None, :, 0]), axis=1) > 1e-4 * (hi - lo)
        x = x[away]
    return x


def _declarations(profile: Profile, x: Array) -> Iterator[str]:
    try:
        require_declarations(profile)
    except SceneError as error:
        yield str(error)
        return
    period = profile.period
    if period is not None:
        for name in ("kinks", "algebraic_points"):
            outside = [s for s in getattr(profile, name)[:, 0].tolist() if not profile.x0 <= s < profile.x0 + period]
            if outside:
                yield f"{name} at {outside} lie outside the cell [{profile.x0:g}, {profile.x0 + period:g})"
    if not dataclasses.is_dataclass(profile) or not profile.__dataclass_params__.frozen:
        yield "note: not a frozen dataclass: changed after a solve, it is not what was solved"


def _values(profile: Profile, x: Array) -> Iterator[str]:
    for name in ("height", "slope"):
        value = np.asarray(getattr(profile, name)(x.copy()))
        if value.shape != x.shape:
            yield f"{name}(x) of shape {x.shape} has shape {value.shape}: it must have the shape of x"
        elif value.dtype.kind not in "fiu":
            yield f"{name}(x) is of type {value.dtype}: it must be real"
        elif not np.isfinite(value).all():
            i = int(np.flatnonzero(~np.isfinite(value))[0])
            yield f"{name}({x[i]:.6g}) is {value[i]}: it must be finite inside [{x[0]:.3g}, {x[-1]:.3g}]"
    if profile.support is not None:
        lo, hi = profile.support
        out = [lo - 1e-3 * (hi - lo), hi + 1e-3 * (hi - lo)]
        if not np.all(np.isposinf(profile.height(np.array(out)))):
            yield f"height is not +inf just outside the support ({lo:g}, {hi:g})"


def _shapes(profile: Profile, x: Array) -> Iterator[str]:
    for name in ("height", "slope"):
        function = getattr(profile, name)
        given = x[:6].copy()
        whole = np.asarray(function(given))
        size = float(np.max(np.abs(np.asarray(function(x.copy())))))
        if not np.array_equal(given, x[:6]):
            yield f"{name}(x) changes the array it is given"
        # A derived slope chooses its steps from all its points, so single values may differ a little.
        tolerance = (_SLOPE if name == "slope" and profile.slope_is_derived else _SAME) * size
        tries: list[tuple[str, Any, Array]] = [
            ("an array of shape (2, 3)", x[:6].reshape(2, 3), whole.reshape(2, 3)),
            ("an empty array", np.empty(0), np.empty(0)),
        ]
        for what, argument, expected in tries:
            try:
                got = np.asarray(function(argument))
            except Exception as error:
                yield f"{name}(x) raises {type(error).__name__} for {what}: {error}"
                continue
            if got.shape != np.shape(expected):
                yield f"{name}(x) for {what} has shape {got.shape}, not {np.shape(expected)}"
            elif np.any(np.abs(got - expected) > tolerance):
                yield f"{name}(x) for {what} differs from its values elsewhere: it must work by elements"
        for what, argument in (("a number", float(x[0])), ("a list", x[:6].tolist())):
            try:
                function(argument)
            except Exception:
                yield f"note: {name}(x) takes no {what[2:]}: np.asarray(x) lets it"


def _periodicity(profile: Profile, x: Array) -> Iterator[str]:
    if profile.period is None:
        return
    for name in ("height", "slope"):
        function = getattr(profile, name)
        here = np.asarray(function(x))
        size = np.ptp(here) if name == "height" else np.max(np.abs(here))
        for turns in (-2, 1, 3):
            off = np.abs(np.asarray(function(x + turns * profile.period)) - here)
            if name == "height" and profile.support is not None:
                off = off[np.isfinite(here)]
            if off.size and not np.max(off) <= max(_SLOPE * size, 0.0):
                i = int(np.argmax(off))
                yield f"{name} is not periodic: at {x[i]:.6g} and {turns} period(s) on it off by {off[i]:.3g}"
                break


def _slope(profile: Profile, x: Array) -> Iterator[str]:
    if profile.slope_is_derived:
        return
    scale = scale_of(x, profile.resolution, (float(x[0]), float(x[-1])))
    judged = verdicts(profile.height, profile.slope, x, scale)
    if judged.contradicted.any():
        i = int(np.argmax(np.where(judged.contradicted, judged.off, 0.0)))
        told = f"about x = {x[i]:.6g} its mean is {judged.claimed[i]:.9g}, and the height rises by {judged.seen[i]:.9g} a length"
        yield f"slope disagrees with the height: {told}"


def _continuity(profile: Profile, x: Array) -> Iterator[str]:
    lo, hi = float(x[0]), float(x[-1])
    heights = np.asarray(profile.height(x))
    size = max(float(np.ptp(heights)), 4 * _UNIT * float(np.max(np.abs(heights))) / _JUMP)
    for s, step in _jumps(lambda t: np.asarray(profile.height(t)), lo, hi, 1e-10 * (hi - lo), size):
        yield f"the height jumps by {step:.6g} at {s:.6g}: it must be continuous"
        return


def _symmetry(profile: Profile, x: Array) -> Iterator[str]:
    both = x[(-x >= x[0]) & (-x <= x[-1])]
    if both.size == 0:
        if profile.symmetric and profile.extent is None and profile.support is None:
            yield "note: symmetric is claimed but the window has no point whose mirror image lies in it"
        return
    right, left = np.asarray(profile.height(both)), np.asarray(profile.height(-both))
    off = float(np.max(np.abs(right - left)))
    even = off <= _SLOPE * float(np.ptp(right)) or off == 0
    if profile.symmetric and not even:
        i = int(np.argmax(np.abs(right - left)))
        at = f"{left[i]:.6g} at {-both[i]:.6g} and {right[i]:.6g} at {both[i]:.6g}"
        yield f"symmetric is claimed, but the height is {at}"
    if even and not profile.symmetric and both.size > x.size // 2:
        yield "note: the height looks symmetric; a property symmetric = True would halve the work"


def _kinks(profile: Profile, x: Array) -> Iterator[str]:
    lo, hi = float(x[0]), float(x[-1])
    width = hi - lo
    if profile.period is not None:
        # A cell that starts off any likely kink, so that the border of the profile's own cell lies inside.
        width = profile.period
        lo = profile.x0 - 0.0123456789 * width
    scale = float(np.max(np.abs(np.asarray(profile.slope(x)))))
    declared = np.asarray(profile.kinks, dtype=np.float64).reshape(-1, 2)
    slope, reach, rounding = _sharp_slope(profile, width, x)
    points = np.asarray(profile.algebraic_points, dtype=np.float64)
    for s, jump in declared:
        seen = float(np.diff(slope(np.array([s - 2 * reach, s + 2 * reach])))[0])
        # An algebraic point of an exponent near 1 looks like a kink from anywhere.
        seen -= sum((left + right) * n * (2 * reach) ** (n - 1) for at, n, left, right in points if at == s)
        if abs(seen - jump) > _JUMP * max(scale, abs(jump)) + rounding:
            yield f"kink declared at {s:.6g} with jump {jump:.6g}: the slope jumps by {seen:.6g} there"
    for s, jump in _jumps(slope, lo, lo + width, reach, max(scale, rounding / _JUMP)):
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
            bends, rounding = (right - 2 * here + left) / h, 4 * _UNIT * float(np.max(np.abs(here))) / h
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


def _sharp_slope(profile: Profile, width: float, x: Array) -> tuple[Callable[[Array], Array], float, float]:
    """The slope, the distance at which its two sides can be told apart, and its rounding."""
    if not profile.slope_is_derived:
        return (lambda x: np.asarray(profile.slope(x))), 1e-10 * width, 0.0
    # The derived slope is no use beside a kink; short differences of the height blur it by their step only.
    h = 1e-6 * width
    rounding = 4 * _UNIT * float(np.max(np.abs(np.asarray(profile.height(x))))) / h
    return (lambda x: (np.asarray(profile.height(x + h)) - np.asarray(profile.height(x - h))) / (2 * h)), h, rounding


def _jumps(slope: Callable[[Array], Array], lo: float, hi: float, reach: float, scale: float) -> list[tuple[float, float]]:
    """Where the slope jumps: intervals of a fine grid, halved towards the larger change down to `reach`."""
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


def _higher_jumps(profile: Profile, x: Array) -> Iterator[str]:
    jumps = np.asarray(profile.jumps)
    if jumps.ndim != 2 or jumps.shape[1] != 3 or not np.isin(jumps[:, 1], (2, 3)).all():
        yield "jumps must be an array of shape (k, 3): position, order 2 or 3, jump of that derivative"
        return
    lo, hi = _window(profile) if profile.period is not None else (float(x[0]), float(x[-1]))
    width, periodic, ends = hi - lo, profile.period is not None, _ends(profile)
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
        # Both sides' slopes are continued to a place beside that of the jump: there they differ by the distance times it.
        beside = seen.height[:, 0] / np.where(seen.height[:, 1] == 0, np.inf, seen.height[:, 1])
        found = found - np.where(np.abs(beside) < 10 * _BEND * width, beside, 0.0)
        seen = jumps_at(profile, found, reach, nearest=_PLACED * width)
        yield from _against_declared(profile, found, seen, scale, width)


def _declared_places(profile: Profile, lo: float, width: float) -> Array:
    """Where something may jump by what the profile says of itself; the border of its cell is one of them."""
    tips = [] if profile.summits is None else [np.asarray(profile.summits, dtype=np.float64)]
    border = [lo] if profile.period is not None else []
    places = np.unique(np.concatenate((border, profile.kinks[:, 0], profile.jumps[:, 0], profile.breakpoints, *tips)))
    places = places[np.append(True, np.diff(places) > _ONE * width)] if len(places) else places
    # Derivatives of low powers are infinite there; `_powers` sees to these.
    places = np.setdiff1d(places, _rough(profile))
    if ends := _ends(profile):
        places = places[(places > ends[0]) & (places < ends[1])]
    return np.asarray(places)


def _rough(profile: Profile) -> Array:
    """Algebraic points at which the third derivative is not continuous."""
    points = np.asarray(profile.algebraic_points, dtype=np.float64)
    return np.asarray(np.unique(points[points[:, 1] <= 3.0, 0]))


def _powers(profile: Profile, x: Array) -> Iterator[str]:
    """Algebraic points by differences of an order so high that all that is smooth vanishes faster than the powers, on either side."""
    points = np.asarray(profile.algebraic_points, dtype=np.float64)
    lo, hi = _window(profile)
    others = np.concatenate((profile.breakpoints, _ends(profile)))
    for s in np.unique(points[:, 0]):
        reach = float(_reach(np.array([s]), others, hi - lo, profile.period is not None)[0])
        for side, column in ((-1.0, 2), (1.0, 3)):
            n, c = points[points[:, 0] == s][:, [1, column]].T
            ratio = _power_left(profile, float(s), side * reach, n, c)
            if ratio > _POWER:
                told = ", ".join(f"{one:.6g} |x - s|^{power:.6g}" for power, one in zip(n, c, strict=True))
                where = "left" if side < 0 else "right"
                yield f"algebraic point declared at {s:.6g}, {told} on its {where}: the profile differs by {ratio:.2g} of that"


def _power_left(profile: Profile, s: float, reach: float, n: Array, c: Array) -> float:
    """The least part of declared powers that high differences of the profile do not show, over a ladder of steps; 0 where rounding hides
    them, or hides them before what is smooth has fallen away."""
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
    return np.asarray(np.minimum(0.9 * np.minimum(places - before, after - places), _FARTHEST * width))


def _against_declared(profile: Profile, places: Array, seen: Seen, scale: float, width: float) -> Iterator[str]:
    """Jumps of the second and third derivative at each place against what is declared there; `_kinks` sees to those of the slope."""
    for order in (2, 3):
        listed = profile.jumps[profile.jumps[:, 1] == order]
        which = np.searchsorted(places, listed[:, 0] - _ONE * width)
        known = which < len(places)
        known[known] = places[which[known]] <= listed[known, 0] + _ONE * width
        claimed = np.bincount(which[known], listed[known, 2], len(places))
        height, doubt = seen.height[:, order - 1], seen.doubt[:, order - 1]
        off = np.abs(height - claimed) - 10 * doubt
        least = np.maximum(_STEP * np.maximum(np.abs(height), np.abs(claimed)), _STEP * scale / width ** (order - 1))
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
        return np.asarray((np.asarray(profile.slope(x + h)) - np.asarray(profile.slope(x - h))) / (2 * h))

    first, last = (lo, lo + width) if profile.period is not None else (lo + 2 * h, lo + width - 2 * h)
    size = max(float(np.max(np.abs(bend(np.linspace(first, last, 997))))), scale / width)
    places = np.array([s for s, _ in _jumps(bend, first, last, 2 * h, size)][:_MOST_BENDS])
    return np.asarray(profile.wrap(places), dtype=np.float64) if profile.period is not None else places


def _summits(profile: Profile, x: Array) -> Iterator[str]:
    if profile.summits is None:
        return
    tips = np.asarray(profile.summits, dtype=np.float64)
    near = 1e-4 * (profile.resolution or float(x[-1] - x[0]))
    top = np.asarray(profile.height(tips))
    for side in (-near, near):
        lower = np.asarray(profile.height(tips + side)) < top - _SAME * float(np.ptp(profile.height(x)))
        if lower.any():
            yield f"summits names {tips[lower].tolist()}, but the height is smaller beside: tips are minima"
            return


def _conjugate(profile: Profile, x: Array) -> Iterator[str]:
    if profile.period is None:
        return
    at = x[:: max(1, x.size // 20)]
    given = profile.slope_conjugate(at)
    if given is None:
        return
    # (1/L) PV int f'(x - s) cot(pi s/L) ds by the midpoint rule, which the pole falls between.
    n = max(1 << 14, 16 * ceil(profile.period / (profile.resolution or profile.period)))
    s = (np.arange(n) + 0.5) / n
    slope = np.asarray(profile.slope(at[:, None] - profile.period * s))
    expected = slope @ (1 / np.tan(np.pi * s)) / n
    off = np.abs(np.asarray(given) - expected)
    i = int(np.argmax(off))
    if off[i] > _CONJUGATE * max(float(np.max(np.abs(slope))), float(np.max(np.abs(expected)))):
        yield f"slope_conjugate({at[i]:.6g}) = {given[i]:.6g}, the slope's integral is {expected[i]:.6g}"


def _ends(profile: Profile) -> tuple[float, ...]:
    """Where a profile without a period begins and ends; empty of one that goes on."""
    return (profile.support or profile.extent or ()) if profile.period is None else ()


_CHECKS: tuple[tuple[str, Callable[[Profile, Array], Iterator[str]]], ...] = (
    ("declarations", _declarations), ("values", _values), ("shapes", _shapes), ("periodicity", _periodicity),
    ("continuity", _continuity), ("slope", _slope), ("symmetry", _symmetry), ("kinks", _kinks),
    ("jumps", _higher_jumps), ("powers", _powers), ("summits", _summits), ("conjugate", _conjugate),
)
