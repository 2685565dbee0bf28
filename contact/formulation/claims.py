"""Check of the properties that a user's profile declares, against its heights.

Checked are the slope, the jumps at kinks, symmetry, period and summits. Over a panel between
declared breakpoints the height rises by the integral of the slope f'. The rise and the integral are
compared. Where they differ by more than the rounding of the heights and the error of the
quadrature, the difference divided by the integral of |f'| is the relative error of the slope. This
error changes pressures and ends in proportion, so it is added to the stated error. A factor common
to the slope on all panels is fitted as well. An error of the slope is not seen if it is below some
ten times the round-off of the heights, divided by their range.

Quadrature also fails on a panel with an undeclared corner. So the panel is divided into parts, and
the two parts with the largest differences are left out. Only a difference that remains on the
other parts counts as an error of the slope. Undeclared corners inside zones show in the residual of
the equation; in full contact they show in the Fourier series of the slope
(contact.formulation.conjugate).

The package's own profile classes are not checked here: their tests check them.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from contact.errors import SceneError
from contact.model.plugin_checks.jumps import CHECKS, declared_jumps
from contact.model.profiles.base import Profile, is_of_package
from contact.model.profiles.noise import EPS, MEDIAN, PLACES, STEP, deviations
from sie import Array, record


@dataclass(frozen=True)
class ClaimOptions:
    """Options for the check of a profile's declared properties against its heights.

    With any value doubled or halved, the check finds the same errors.

    panels: number of panels. nodes: number of nodes of Gauss's rule, which is applied to a whole
    panel, to its halves and to its thirds. It is also the number of parts into which a panel is
    divided if height and slope disagree on it. margin: factor on estimated errors; also the ratio
    of the errors of pressures and ends to the relative error of the slope.
    """

    panels: int = 16
    nodes: int = 8
    margin: float = 4.0


OPTIONS = ClaimOptions()


@record
class Claims:
    """Result of the check of a profile's declared properties against its heights.

    error: relative error of pressures and ends. limit: cause of that error, in words. fault: a
    false claim, in words; empty if there is none.
    """

    error: float = 0.0
    limit: str = ""
    fault: str = ""


_TRUE = Claims()


def of(profile: Profile, zones: Array | None = None) -> Claims:
    """Check a profile's slope, kinks, symmetry, period and summits against its heights.

    The profile is checked over its cell or extent. An unbounded profile is checked around the
    `zones` (n, 2) [m].

    The result is kept with the profile. Raises SceneError where a claim is false.
    """
    if is_of_package(profile):
        return _TRUE
    interval = _interval(profile, zones)
    if interval is None:
        return _TRUE
    known: dict[tuple[float, float], Claims] = profile.claims_seen
    if interval not in known:
        with np.errstate(all="ignore"):
            known[interval] = _checked(profile, interval, zones)
    claims = known[interval]
    if claims.fault:
        raise SceneError(f"the profile contradicts itself: {claims.fault}", "profile", profile)
    return claims


def _interval(profile: Profile, zones: Array | None) -> tuple[float, float] | None:
    """Interval [m] in which the profile is checked.
    It is None for an unbounded profile if no zones are given.

    An interval around given zones is rounded outward, so that similar zones have the same interval.
    """
    known = profile.support or profile.known
    if known is not None:
        return float(known[0]), float(known[1])
    if zones is None or len(zones) == 0:
        return None
    first, last = float(np.min(zones)), float(np.max(zones))
    step = 2.0 ** np.ceil(np.log2(last - first))
    return float(np.floor(first / step) * step), float(np.ceil(last / step) * step)


def _checked(profile: Profile, interval: tuple[float, float], zones: Array | None) -> Claims:
    lo, hi = interval
    panels = _resolved(profile, _Panels.of(profile, *_panels(profile, lo, hi)))
    # Slopes below `least`, as on the far flanks of narrow bumps, are lost in the round-off of sums
    # that contain the slopes in contact.
    least = EPS * (panels.largest if zones is None else _steepest(profile, zones))
    mismatch, limit = max(
        _mismatch(profile, panels, least), _common_mismatch(profile, panels, least)
    )
    if mismatch > CHECKS.same and not profile.slope_is_derived:
        return Claims(fault=limit)
    fault = _kink_fault(profile, panels) or _symmetry_fault(profile, panels, lo, hi)
    fault = fault or _period_fault(profile, panels) or _summit_fault(profile, panels, lo, hi)
    return Claims(OPTIONS.margin * mismatch, limit, fault)


def _steepest(profile: Profile, zones: Array) -> float:
    """Largest |f'| on the zones."""
    nodes, _ = np.polynomial.legendre.leggauss(OPTIONS.nodes)
    at = zones.mean(axis=1)[:, None] + 0.5 * np.diff(zones, axis=1) * nodes
    slope = np.abs(np.asarray(profile.slope(at.ravel()), dtype=np.float64))
    return float(slope.max(initial=0.0, where=np.isfinite(slope)))


def _panels(profile: Profile, lo: float, hi: float) -> tuple[Array, Array]:
    """Left ends and right ends (n,) of panels that contain no declared breakpoint.

    They cover the interval. If that would take too many panels, fewer panels are spread evenly over
    the interval.
    """
    length, options = hi - lo, OPTIONS
    resolution = profile.resolution
    most = options.panels
    wanted = most if resolution is None else max(most, np.ceil(2 * length / resolution))
    breaks = np.unique(np.asarray(profile.breakpoints, dtype=np.float64))
    breaks = breaks[(breaks > lo) & (breaks < hi)]
    width = length / wanted
    starts = lo + width * np.floor(np.linspace(0.0, wanted - 1.0, most))
    a = np.concatenate((starts, breaks[:: max(1, len(breaks) // most)]))
    following = np.append(breaks, hi)[np.searchsorted(breaks, a, side="right")]
    b = np.minimum(a + width, following)
    wide = b - a > CHECKS.same * width
    order = np.argsort(a[wide])
    return a[wide][order], b[wide][order]


def _resolved(profile: Profile, panels: "_Panels") -> "_Panels":
    """The panels; those whose quadrature error exceeds the rounding are divided into parts."""
    coarse = panels.quadrature > panels.rounding
    if not coarse.any():
        return panels
    cuts = np.linspace(panels.a[coarse], panels.b[coarse], OPTIONS.nodes + 1)
    a = np.concatenate((panels.a[~coarse], cuts[:-1].T.ravel()))
    b = np.concatenate((panels.b[~coarse], cuts[1:].T.ravel()))
    order = np.argsort(a)
    return _Panels.of(profile, a[order], b[order])


@lru_cache(maxsize=4)
def _rules(count: int) -> tuple[Array, Array]:
    """Three Gauss rules on (0, 2): for the whole, for 2 equal parts and for 3 equal parts.

    Returns the nodes of all three rules, and one column of weights for each rule. A column is 0 at
    the nodes of the other two rules.
    """
    nodes, weights = np.polynomial.legendre.leggauss(count)
    at = [(2 * k + 1 + nodes) / parts for parts in (1, 2, 3) for k in range(parts)]
    rule = np.zeros((6 * count, 3))
    for column, (first, parts) in enumerate(((0, 1), (1, 2), (3, 3))):
        rule[first * count : (first + parts) * count, column] = np.tile(weights, parts) / parts
    return np.concatenate(at), rule


def _rounding(heights: Array, steepness: Array) -> Array:
    """Round-off of the heights in each panel: that of the largest height, plus 4 times the noise.

    The rows of `heights` (8, n) belong to seven places at the first end of a panel, and to its
    second end. The rows of `steepness` (2, n) are |f'| next to the first end, and the largest |f'|
    of the panel. Noise is proportional to the heights or, where places are rounded, to |f'|. The
    ratio of noise to height, and that of noise to |f'|, are medians over all panels. The larger of
    the two noises counts: heights far away may have much larger noise.
    """
    largest = np.abs(heights).max(axis=0, initial=0.0, where=np.isfinite(heights))
    seen = np.nan_to_num(deviations(heights[:-1]), posinf=0.0, neginf=0.0) / MEDIAN
    noise = np.zeros(len(largest))
    for at_first_end, size in ((np.abs(heights[0]), largest), steepness):
        known = (at_first_end > 0.0) & np.isfinite(at_first_end)
        if known.any():
            noise = np.maximum(noise, size * np.median(seen[known] / at_first_end[known]))
    return np.asarray(EPS * largest + 4 * noise)


def _with_neighbours(values: Array) -> Array:
    """Array (n, 5): for each value a row of the two before it, the value, and the two after it."""
    return np.lib.stride_tricks.sliding_window_view(np.pad(values, 2, mode="edge"), 5)


@record
class _Panels:
    """Intervals (panels) from `a` to `b` (n,), with the change of the height over each panel.
    This rise is compared with the integral of the slope over the panel.

    size: integral of |f'|. quadrature: error of the integral by Gauss's rule. rounding: round-off
    of rise and integral. steepest: largest |f'|. heights: at both ends (2, n). noise: rounding of
    a height.
    """

    a: Array
    b: Array
    rise: Array
    integral: Array
    size: Array
    quadrature: Array
    rounding: Array
    steepest: Array
    heights: Array
    noise: Array

    @classmethod
    def of(cls, profile: Profile, a: Array, b: Array) -> "_Panels":
        at, rule = _rules(OPTIONS.nodes)
        half = (0.5 * (b - a))[:, None]
        x = a[:, None] + half * at
        slope = np.asarray(profile.slope(x.ravel()), dtype=np.float64).reshape(x.shape)
        sums = half * (slope @ rule)
        inward = np.concatenate((a + STEP * (b - a) * PLACES[:, None], b[None]))
        heights = np.asarray(profile.height(inward), dtype=np.float64)
        steepest = np.abs(slope).max(axis=1, initial=0.0, where=np.isfinite(slope))
        first = np.abs(slope[:, np.argmin(at)])
        noise = _rounding(heights, np.array([first, steepest]))
        rounded = noise + deviations(heights[:-1]) + 16 * EPS * steepest * (b - a)
        return cls(
            a,
            b,
            heights[-1] - heights[0],
            sums[:, 2],
            half[:, 0] * (np.abs(slope) @ rule[:, 2]),
            np.ptp(sums, axis=1),
            rounded,
            steepest,
            heights[[0, -1]],
            noise,
        )

    @property
    def doubt(self) -> Array:
        """Largest difference of a panel's rise and slope integral that errors of both may cause."""
        return OPTIONS.margin * (self.quadrature + self.rounding)

    @property
    def largest(self) -> float:
        """The largest absolute slope at the quadrature nodes of all panels."""
        return float(self.steepest.max(initial=0.0))

    @property
    def difference(self) -> Array:
        """Rise of the height minus integral of the slope on each panel; 0 if not finite."""
        out = self.rise - self.integral
        return np.where(np.isfinite(out), out, 0.0)


def _mismatch(profile: Profile, panels: _Panels, least: float) -> tuple[float, str]:
    """Largest relative error of the slope, and a message on it; (0, "") if no error is found.

    An error counts only if it remains when the two worst parts of its panel are left out. least:
    the smallest slope that counts.
    """
    which = np.flatnonzero(np.abs(panels.difference) > panels.doubt)
    if not len(which):
        return 0.0, ""
    count = OPTIONS.nodes
    cuts = np.linspace(panels.a[which], panels.b[which], count + 1)
    parts = _Panels.of(profile, cuts[:-1].T.ravel(), cuts[1:].T.ravel())
    difference, size, noise = (
        of.reshape(-1, count).T for of in (parts.difference, parts.size, parts.noise)
    )
    # On each of the `count` parts of a panel, the rise of the height is compared with the integral
    # of the slope. Near an undeclared corner, the quadrature fails on one or two parts. So the two
    # parts with the largest difference are left out. If the slope is wrong, other parts differ,
    # too. Each part left out adds the noise of two heights to the sum over the other parts.
    rest = np.argsort(np.abs(difference), axis=0)[:-2]
    difference, size = (
        np.take_along_axis(of, rest, axis=0).sum(axis=0) for of in (difference, size)
    )
    seen = np.abs(difference) > panels.doubt[which] + 4 * OPTIONS.margin * noise.max(axis=0)
    # An error is divided by `size`. This is at least `CHECKS.same` times the largest slope of the
    # panel and its neighbours, times the panel's length: errors of tiny slopes do not count. Slopes
    # far away do not matter either, as they may be much larger than those in the zones.
    steepest = _with_neighbours(panels.steepest).max(axis=1)
    steepest = np.maximum(CHECKS.same * steepest, least)
    size = np.maximum(size, (steepest * (panels.b - panels.a))[which])
    relative = np.where(seen, np.abs(difference) / size, 0.0)
    worst = int(np.argmax(relative))
    if not relative[worst] > 0.0:
        return 0.0, ""
    k = int(which[worst])
    return float(relative[worst]), (
        f"{_kind(profile)} disagrees with the height: from x = {panels.a[k]:.9g} to "
        f"{panels.b[k]:.9g} m the height rises by {panels.rise[k]:.9g} m, but the integral of the "
        f"slope is {panels.integral[k]:.9g} m"
    )


def _common_mismatch(profile: Profile, panels: _Panels, least: float) -> tuple[float, str]:
    """Relative error of the slope common to all panels, and a message; (0, "") if there is none.

    Many panels together show a false factor that the rounding of heights hides on each of them. The
    factor is fitted by least squares, weighted by the errors of the panels. Panels that differ from
    the median factor by more than their own error are left out: they may have a corner.
    """
    rise, weight = panels.integral, 1 / (panels.rounding + panels.quadrature) ** 2
    # A panel whose integral is not above its error, as on the flank of a narrow bump, is not used.
    known = np.maximum(panels.doubt, least * (panels.b - panels.a))
    usable = np.isfinite(weight * rise**2) & (np.abs(rise) > known)
    if not usable.any():
        return 0.0, ""
    median = np.median(panels.difference[usable] / rise[usable])
    usable &= np.abs(panels.difference - median * rise) <= panels.doubt
    weight = np.where(usable, weight, 0.0)
    total = float(weight @ rise**2)
    factor = float(weight @ (rise * panels.difference)) / total if total > 0 else 0.0
    # The rounding error of a panel is at least four standard deviations of the height's rise over
    # the panel. So `1 / np.sqrt(total)` is at least four standard deviations of the fitted factor.
    if not abs(factor) > 1 / np.sqrt(total):
        return 0.0, ""
    return abs(factor), (
        f"{_kind(profile)} disagrees with the height: over {np.count_nonzero(usable)} intervals, "
        f"the height rises by {1 + factor:.12g} times the integral of the slope"
    )


def _kind(profile: Profile) -> str:
    derived = profile.slope_is_derived
    return "the slope that is derived from the heights" if derived else "slope"


def _kink_fault(profile: Profile, panels: _Panels) -> str:
    """Message on a kink whose declared jump is not that of the slope; "" if there is none."""
    kinks = np.asarray(profile.kinks, dtype=np.float64)
    if profile.slope_is_derived or len(kinks) == 0:
        return ""
    # Several kinks at the same place of the period are replaced by one kink with the sum of their
    # jumps.
    at, which = np.unique(np.asarray(profile.wrap(kinks[:, 0])), return_inverse=True)
    kinks = np.column_stack((at, np.bincount(which, kinks[:, 1])))
    kinks = kinks[:: max(1, len(kinks) // OPTIONS.panels)]
    places = np.unique(np.asarray(profile.breakpoints, dtype=np.float64))
    apart = float(np.diff(places).min(initial=float(np.max(panels.b - panels.a))))
    distance = CHECKS.same * apart + 4 * np.spacing(np.abs(kinks[:, 0]))
    powers = np.asarray(profile.algebraic_points, dtype=np.float64)
    seen, error = declared_jumps(profile.slope, kinks, distance, powers)
    worst = int(np.argmax(np.where(np.isfinite(error), error, -np.inf)))
    if not error[worst] > 0.0:
        return ""
    return (
        f"kink declared at x = {kinks[worst, 0]:.9g} m with the jump {kinks[worst, 1]:.6g}, but "
        f"the slope jumps by {seen[worst]:.6g} there"
    )


def _symmetry_fault(profile: Profile, panels: _Panels, lo: float, hi: float) -> str:
    """Message on two heights that contradict the declared symmetry; "" if there are none."""
    inside = (-panels.a >= lo) & (-panels.a <= hi)
    if not profile.symmetric or not inside.any():
        return ""
    x, here = panels.a[inside], panels.heights[0, inside]
    there = np.asarray(profile.height(-x), dtype=np.float64)
    return _differ(
        x,
        here,
        there,
        panels,
        "symmetric is claimed, but the height is {0:.9g} m at x = {1:.6g} m and {2:.9g} m at "
        "x = {3:.6g} m",
        -x,
    )


def _period_fault(profile: Profile, panels: _Panels) -> str:
    """Message on two heights that contradict the declared period; "" if there are none."""
    if profile.period is None:
        return ""
    x = panels.a + profile.period
    message = (
        "the height does not repeat with the period: it is {0:.9g} m at x = {1:.6g} m and "
        "{2:.9g} m at x = {3:.6g} m"
    )
    return _differ(
        panels.a,
        panels.heights[0],
        np.asarray(profile.height(x), dtype=np.float64),
        panels,
        message,
        x,
    )


def _differ(x: Array, here: Array, there: Array, panels: _Panels, message: str, y: Array) -> str:
    """Message on the heights at x[i] and y[i] that differ most; "" if all pairs agree."""
    places = 8 * EPS * (np.abs(x) + np.abs(y)) * panels.largest
    error = np.abs(here - there) - OPTIONS.margin * (float(panels.noise.max()) + places)
    # Heights are infinite beyond a sharp corner of the profile. Such places are not compared.
    error = np.where(np.isfinite(error), error, -np.inf)
    heights = panels.heights[np.isfinite(panels.heights)]
    worst = int(np.argmax(error))
    if not error[worst] > CHECKS.same * float(np.ptp(heights)):
        return ""
    return message.format(here[worst], x[worst], there[worst], y[worst])


def _summit_fault(profile: Profile, panels: _Panels, lo: float, hi: float) -> str:
    """Message on a place where the profile is lower than at all declared summits; "" if none."""
    if profile.summits is None:
        return ""
    tips = np.asarray(profile.summits, dtype=np.float64)
    if not np.any((tips >= lo) & (tips <= hi)):
        return ""
    top = float(np.min(np.asarray(profile.height(tips))))
    lowest = int(np.argmin(np.where(np.isfinite(panels.heights[0]), panels.heights[0], np.inf)))
    below = top - float(panels.heights[0, lowest])
    allowed = OPTIONS.margin * panels.noise[lowest]
    if not below > allowed + CHECKS.same * float(np.ptp(panels.heights[0])):
        return ""
    return (
        "summits are not the lowest places of the profile: the least height at a summit is "
        f"{top:.9g} m, but the height at x = {panels.a[lowest]:.6g} m is "
        f"{panels.heights[0, lowest]:.9g} m"
    )
