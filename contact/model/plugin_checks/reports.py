"""Reports on users' profiles and substrates: each declaration is compared with values.

The claims of a profile (slope, period, symmetry, kinks, tips, conjugate) are compared with its
height, those of a substrate with its symbol.
"""

import copy
import dataclasses
import warnings
from collections.abc import Callable, Iterator
from math import ceil
from typing import Any

import numpy as np

from contact.errors import ContactError, SceneError, shown
from contact.model.plugin_checks.corners import kinks
from contact.model.plugin_checks.declarations import require_declarations
from contact.model.plugin_checks.jumps import CHECKS, higher_jumps, powers, slope_jumps, window_of
from contact.model.plugin_checks.operators import require_body
from contact.model.profiles.base import Profile
from contact.model.profiles.derive import DETAIL, scale_of, verdicts
from contact.model.profiles.noise import EPS, ROUND_OFF
from contact.model.substrates.base import Substrate
from sie import Array


class Fault(ContactError, AssertionError):
    """Error raised for a plug-in that contradicts itself; `report` is the complete list of its
    faults.
    """

    # A report is a list, which must not be shortened as other error messages are.
    longest = 10**6

    def __init__(self, report: "Report") -> None:
        super().__init__(str(report))
        self.report = report


class ProfileFault(Fault):
    """Error raised for a profile that contradicts itself."""


class SubstrateFault(Fault):
    """Error raised for a substrate that contradicts itself."""


@dataclasses.dataclass(frozen=True)
class Report:
    """The result of a check: names of the checks, faults found, and notes on possible
    improvements.
    """

    subject: str
    checked: tuple[str, ...]
    faults: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def ok(self) -> bool:
        return not self.faults

    def __str__(self) -> str:
        head = f"{self.subject}: " + (
            "nothing wrong found" if self.ok else f"{len(self.faults)} fault(s)"
        )
        lines = [f"  - {fault}" for fault in self.faults] + [
            f"  (note: {note})" for note in self.notes
        ]
        return "\n".join([head, *lines, f"  checked: {', '.join(self.checked)}"])


def check_profile(
    profile: Profile, window: tuple[float, float] | None = None, raises: bool = True
) -> Report:
    """Check the declarations of a profile against its height.

    Parameters
    ----------
    profile : Profile
        The profile.
    window : (float, float) or None
        Interval [m] that is checked; None: the profile's support, extent or cell. If it has none of
        these: an interval about 0 whose half width is a length in the profile.
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
                break  # further checks would fail for the same reason
        if profile.slope_is_derived:
            notes.append(
                "slope(x) is computed from differences of heights: a formula is faster and more "
                "accurate"
            )
    return _reported(
        Report(shown(profile), tuple(checked), tuple(faults), tuple(notes)),
        ProfileFault if raises else None,
    )


def check_substrate(substrate: Substrate, raises: bool = True) -> Report:
    """Check that a substrate's symbol is that of an elastic body, and that scenes can hold and
    compare the substrate.

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
                faults.append("it does not equal its own copy: make its class a frozen dataclass")
        except Exception as error:  # the author's code may fail in any way; the report says how
            faults.append(
                f"it cannot be compared or hashed ({type(error).__name__}: {error}): make its "
                "class a frozen dataclass"
            )
        if not getattr(type(substrate), "name", ""):
            notes.append(
                'it has no name: register its class by @contact.register_substrate("...") to use '
                "it in scene files"
            )
    report = Report(
        shown(substrate), ("symbol", "compression", "copies"), tuple(faults), tuple(notes)
    )
    return _reported(report, SubstrateFault if raises else None)


def _reported(report: Report, fault: type[Fault] | None) -> Report:
    """Return the report. If it has faults and `fault` is given, raise this error instead."""
    if fault is not None and not report.ok:
        raise fault(report)
    return report


def _points(profile: Profile, window: tuple[float, float] | None) -> Array:
    """Random positions in the interval, with a fixed seed; none of them is on a kink."""
    lo, hi = window_of(profile) if window is None else window
    x = np.sort(np.random.default_rng(1).uniform(lo, hi, DETAIL.samples))
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
            outside = [
                s
                for s in getattr(profile, name)[:, 0].tolist()
                if not profile.x0 <= s < profile.x0 + period
            ]
            if outside:
                yield (
                    f"{name} at {outside} lie outside the cell [{profile.x0:g}, "
                    f"{profile.x0 + period:g})"
                )
    if not dataclasses.is_dataclass(profile) or not profile.__dataclass_params__.frozen:
        yield (
            "note: the class is not a frozen dataclass: a profile that is changed after a solve no "
            "longer belongs to the solution"
        )


def _values(profile: Profile, x: Array) -> Iterator[str]:
    for name in ("height", "slope"):
        value = np.asarray(getattr(profile, name)(x.copy()))
        if value.shape != x.shape:
            yield (
                f"{name}(x) has shape {value.shape} for x of shape {x.shape}: it must have the "
                "shape of x"
            )
        elif value.dtype.kind not in "fiu":
            yield f"{name}(x) has numbers of type {value.dtype}: they must be real"
        elif not np.isfinite(value).all():
            i = int(np.flatnonzero(~np.isfinite(value))[0])
            yield (
                f"{name}({x[i]:.6g}) is {value[i]}: it must be finite inside [{x[0]:.3g}, "
                f"{x[-1]:.3g}]"
            )
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
            yield f"{name}(x) changes the array x: compute with a copy of x"
        # A slope derived from heights is a difference quotient, whose step depends on all given
        # points. So the slopes for fewer points may differ a little.
        tolerance = CHECKS.same * size
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
                yield (
                    f"{name}(x) for {what} differs from its values at the same points in a "
                    "one-dimensional array: compute it element by element"
                )
        for what, argument in (("a number", float(x[0])), ("a list", x[:6].tolist())):
            try:
                function(argument)
            except Exception:
                yield f"note: {name}(x) accepts no {what[2:]}: convert x by np.asarray(x)"


def _periodicity(profile: Profile, x: Array) -> Iterator[str]:
    if profile.period is None:
        return
    for name in ("height",) if profile.slope_is_derived else ("height", "slope"):
        function = getattr(profile, name)
        here = np.asarray(function(x))
        size = np.ptp(here) if name == "height" else np.max(np.abs(here))
        for turns in (-2, 1, 3):
            difference = np.abs(np.asarray(function(x + turns * profile.period)) - here)
            if name == "height" and profile.support is not None:
                difference = difference[np.isfinite(here)]
            if difference.size and not np.max(difference) <= max(CHECKS.same * size, 0.0):
                i = int(np.argmax(difference))
                yield (
                    f"{name} is not periodic: from x = {x[i]:.6g} to x plus {turns} period(s) it "
                    f"changes by {difference[i]:.3g}"
                )
                break


def _slope(profile: Profile, x: Array) -> Iterator[str]:
    if profile.slope_is_derived:
        return
    scale = scale_of(x, profile.resolution, (float(x[0]), float(x[-1])))
    judged = verdicts(profile.height, profile.slope, x, scale)
    if judged.contradicted.any():
        i = int(np.argmax(np.where(judged.contradicted, judged.discrepancy, 0.0)))
        means = (
            f"near x = {x[i]:.6g} the mean of slope(x) is {judged.claimed[i]:.9g}, but the mean "
            f"slope of the heights is {judged.seen[i]:.9g}"
        )
        yield f"slope disagrees with the height: {means}"


def _continuity(profile: Profile, x: Array) -> Iterator[str]:
    lo, hi = float(x[0]), float(x[-1])
    heights = np.asarray(profile.height(x))
    size = max(float(np.ptp(heights)), 4 * EPS * float(np.max(np.abs(heights))) / CHECKS.jump)
    for s, step in slope_jumps(
        lambda t: np.asarray(profile.height(t)), lo, hi, 1e-10 * (hi - lo), size
    ):
        yield f"the height jumps by {step:.6g} at {s:.6g}: it must be continuous"
        return


def _symmetry(profile: Profile, x: Array) -> Iterator[str]:
    both = x[(-x >= x[0]) & (-x <= x[-1])]
    if both.size == 0:
        if profile.symmetric and profile.extent is None and profile.support is None:
            yield (
                "note: symmetric is True but was not checked: the window has no two points x and -x"
            )
        return
    right, left = np.asarray(profile.height(both)), np.asarray(profile.height(-both))
    difference = float(np.max(np.abs(right - left)))
    even = difference <= CHECKS.same * float(np.ptp(right)) or difference == 0
    if profile.symmetric and not even:
        i = int(np.argmax(np.abs(right - left)))
        at = f"{left[i]:.6g} at {-both[i]:.6g} and {right[i]:.6g} at {both[i]:.6g}"
        yield f"symmetric is True, but the height is {at}"
    if even and not profile.symmetric and both.size > x.size // 2:
        yield "note: the height looks symmetric; set symmetric = True to halve the computing time"


def _summits(profile: Profile, x: Array) -> Iterator[str]:
    if profile.summits is None:
        return
    tips = np.asarray(profile.summits, dtype=np.float64)
    distance = 1e-4 * (profile.resolution or float(x[-1] - x[0]))
    top = np.asarray(profile.height(tips))
    rounding = ROUND_OFF * float(np.max(np.abs(profile.height(x))))
    for side in (-distance, distance):
        lower = np.asarray(profile.height(tips + side)) < top - rounding
        if lower.any():
            yield (
                f"summits has {tips[lower].tolist()}, but the height is smaller next to it: a "
                "summit must be a minimum of the height"
            )
            return


def _conjugate(profile: Profile, x: Array) -> Iterator[str]:
    if profile.period is None:
        return
    at = x[:: max(1, x.size // 20)]
    given = profile.slope_conjugate(at)
    if given is None:
        return
    # The Hilbert transform (1/L) PV int f'(x - s) cot(pi s/L) ds, with L the period, by the
    # midpoint rule. The pole s = 0 lies between two points of the rule.
    per_length = DETAIL.samples_per_length
    n = per_length * ceil(profile.period / (profile.resolution or profile.period))
    n = max(DETAIL.max_samples, n)
    s = (np.arange(n) + 0.5) / n
    slope = np.asarray(profile.slope(at[:, None] - profile.period * s))
    expected = slope @ (1 / np.tan(np.pi * s)) / n
    difference = np.abs(np.asarray(given) - expected)
    # The midpoint rule is less accurate for an x near a kink. So the tolerance is larger there.
    away = np.abs(at[:, None] - np.append(np.asarray(profile.kinks)[:, 0], np.inf)).min(axis=1)
    relative = 2 * CHECKS.jump + 4 * (profile.period / (n * away)) ** 2
    excess = difference - relative * max(float(np.abs(slope).max()), float(np.abs(expected).max()))
    i = int(np.argmax(excess))
    if excess[i] > 0:
        yield (
            f"slope_conjugate({at[i]:.6g}) = {given[i]:.6g}, but the Hilbert transform of the "
            f"slope is {expected[i]:.6g}"
        )


_CHECKS: tuple[tuple[str, Callable[[Profile, Array], Iterator[str]]], ...] = (
    ("declarations", _declarations),
    ("values", _values),
    ("shapes", _shapes),
    ("periodicity", _periodicity),
    ("continuity", _continuity),
    ("slope", _slope),
    ("symmetry", _symmetry),
    ("kinks", kinks),
    ("jumps", higher_jumps),
    ("powers", powers),
    ("summits", _summits),
    ("conjugate", _conjugate),
)
