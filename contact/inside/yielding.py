"""First yield: the load and the place at which the equivalent stress first reaches the strength.

The value of the scene's control is changed until the largest equivalent stress (`largest.py`)
equals the strength. First a bracket is found; then regula falsi is applied to the logarithms of
control and stress. Under a law that limits the pressure, the largest stress may fall again as the
load grows, so the bracket is sought from small loads up.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contact.errors import NotConverged, OutOfRange, SceneError
from contact.inside.largest import OPTIONS as LARGEST
from contact.inside.largest import Body, Criterion, Peak, largest
from contact.inside.stress import LATERAL
from contact.model.checks import one_of, poisson_ratio, positive
from contact.model.laws.plastic import bearing_width
from contact.model.scene import Scene

CRITERIA = ("mises", "tresca")


@dataclass(frozen=True)
class YieldOptions:
    """Options of the search for the load of first yield."""

    max_ratio: float = 8.0  # largest factor on the control in a step of the search for a bracket
    # Relative error of the load at which a tip comes into contact. A gap below the round-off of the
    # heights counts as closed, which shifts this load: two searches from different loads differed
    # by 2e-6.
    touch_error: float = 1e-5
    # Smallest factor on the given value of the control. If the stress is infinite even under this
    # smallest value, the load of first yield is 0.
    least_ratio: float = 1e-6


OPTIONS = YieldOptions()


@dataclass(frozen=True)
class Yield:
    """First yield: the load at which the equivalent stress reaches the strength, and the point.

    Parameters
    ----------
    load : float
        The load [N/m], per period if there is one; 0 if the body yields under any load.
    x, y : float
        The place in body 1 [m]; y is the depth.
    error : float
        Bound of the relative error of the load.
    note : str
        Why the load is 0, or the load at which a sharp corner or tip comes into contact; else "".
    solution : Solution or None
        The contact at first yield; None if the load is 0.
    criterion : Criterion or None
        The criterion that gives the equivalent stress; None if the load is 0.

    Examples
    --------
    A cylinder yields below the surface at p_0 = Y / 0.5575 for nu = 0.3.

    >>> import contact
    >>> cylinder = contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), load=1e3)
    >>> found = contact.solve(cylinder).first_yield(1e6, nu=0.3)
    >>> depth = float(found.y / found.solution.zones[0, 1])
    >>> round(1e6 / found.solution.max_pressure, 8), round(depth, 6)
    (0.55751622, 0.704292)
    """

    load: float
    x: float
    y: float
    error: float = 0.0
    note: str = ""
    solution: Any = field(default=None, repr=False)
    criterion: Criterion | None = field(default=None, repr=False)


def first_yield(
    body: Body, at: Callable[[float], Body], strength: float, criterion: Criterion
) -> Yield:
    """Find the load of first yield by changing the value of the scene's control.

    at: a function that returns the solution under another value of the control `changed_control`.
    """
    check(strength, criterion)
    search = _Search(at, strength, criterion)
    if body.scene.law.pressure_range.has_limit:
        return search.from_below(body)
    value = body.scene.control[1]
    if value <= 0:
        raise SceneError.of(
            body.scene.control[0], value, "above 0, since first yield is sought at multiples of it"
        )
    search.add(value, body)
    return search.run()


def check(strength: float, criterion: Criterion) -> None:
    """Raise SceneError if the strength or a part of the criterion is not what it must be."""
    positive("strength", strength)
    one_of("criterion", criterion.name, CRITERIA)
    poisson_ratio("nu", criterion.nu)
    one_of("lateral", criterion.lateral, LATERAL)


def changed_control(scene: Scene) -> str:
    """Name of the control that the search changes.
    It is the load if the law limits the pressure, and the scene's own control otherwise.
    """
    return "load" if scene.law.pressure_range.has_limit else scene.control[0]


# A trial of the search: ln(control), ln(largest stress / strength), the contact, and its `Peak`
# (the largest stress and its position).
Point = tuple[float, float, Body, Peak]


@dataclass
class _Search:
    """Search for first yield: a bracket of ln(control) that is made smaller.

    below, above: the last trials with a largest stress below the strength, and not below it.
    """

    at: Callable[[float], Body]
    strength: float
    criterion: Criterion
    below: Point | None = None
    above: Point | None = None
    solves: int = 0

    def add(self, value: float, body: Body) -> Point:
        place = infinite_at(body)
        peak = largest(body, self.criterion) if place is None else Peak(np.inf, 0.0, place, 0.0)
        ratio = peak.stress / self.strength
        point = (float(np.log(value)), float(np.log(max(ratio, 1e-300))), body, peak)
        if point[1] < 0:
            self.below = point
        else:
            self.above = point
        self.solves += 1
        return point

    def solve(self, level: float) -> Point:
        if self.solves >= LARGEST.max_steps:
            raise OutOfRange(
                f"first yield was not found within {self.solves} solutions: the largest stress "
                "does not reach the strength, or it changes too slowly with the load"
            )
        value = float(np.exp(level))
        return self.add(value, self.at(value))

    def run(self) -> Yield:
        point = self.below or self.above
        assert point is not None
        start, last, slope = point[0], point, 0.5
        while self.below is None or self.above is None:
            wanted = -last[1] / slope if np.isfinite(last[1]) else -np.inf
            limit = np.log(OPTIONS.max_ratio)
            level = last[0] + float(np.clip(wanted + np.sign(wanted) * 0.01, -limit, limit))
            if np.isinf(last[1]) and level < start + np.log(OPTIONS.least_ratio):
                peak = last[3]
                return Yield(0.0, peak.x, peak.y, 0.0, _NOTE)
            new = self.solve(level)
            if np.isfinite(new[1]) and np.isfinite(last[1]):
                rate = (new[1] - last[1]) / (new[0] - last[0])
                if rate < 1e-6 and new[1] < 0:
                    raise OutOfRange(
                        f"no yield: the largest stress is {np.exp(new[1]):.3g} times the strength "
                        "and no longer grows with the load"
                    )
                slope = float(np.clip(rate, 0.05, 4.0))
            last = new
        return self._within()

    def from_below(self, body: Body) -> Yield:
        """First yield under a limit of the pressure, sought from small loads up."""
        highest = body.scene.law.pressure_range.highest
        support = body.scene.profile.support
        if support is not None:
            return self._cornered(support[0], highest * self.criterion.at_corner)
        self._refuse_above_bound(body, highest)
        if _is_wedge(body):
            return self._at_any_load(self.add(body.load, body))
        point = self._start(body)
        if point[1] >= 0:
            if point[2].max_pressure <= 0.5 * highest:
                return self.run()  # elastic: the largest stress grows with the load
            return Yield(0.0, point[3].x, point[3].y, 0.0, _BLUNTED)
        most = highest * bearing_width(body.scene)
        # `end` is the last load tried. It is the largest load that the body can bear or, if there
        # is no such load, a load far above the given one.
        end = most
        if np.isinf(most):
            end = OPTIONS.max_ratio**2 * max(body.load, point[2].load)
        return self._scanned(point, most, end)

    def _refuse_above_bound(self, body: Body, highest: float) -> None:
        """Raise OutOfRange if no pressure up to `highest` can cause yield."""
        deep = highest if self.criterion.lateral != LATERAL[0] else 0.0
        most = float(self.criterion.bound(np.array(highest), highest, deep))
        if self.strength > most:
            raise OutOfRange(
                f"no yield: pressures up to {highest:.6g} Pa, the limit of the law, cause a stress "
                f"of at most {most:.4g} Pa, which is below the strength"
            )

    def _scanned(self, point: Point, most: float, end: float) -> Yield:
        """First yield above the load of `point`, by a scan of loads up to `end`.

        most: an upper bound [N/m] of the loads that the body bears; it may be infinite.
        """
        points, load, ended = [point], point[2].load, ""
        tops: dict[int, Point] = {}  # results of `_top`, by the index of the middle one of 3 points
        while load < end and most - load > load / OPTIONS.max_ratio**3:
            load += 0.5 * min(load, most - load)
            new = self._trial(float(np.log(load)))
            if new is None:
                ended = f"; at {load:.6g} N/m no contact was found, and no larger load was tried"
                # The largest load with a contact is approached by bisection.
                most, load = load, points[-1][2].load
                continue
            points.append(new)
            if _may_reach(points[-3:]):
                top = tops[len(points) - 2] = self._top(points[-3:])
                if top[1] >= 0:
                    return self._between(points[-3], top)
            if new[1] >= 0:
                return self._between(points[-2], new)
        best = int(np.argmax([one[1] for one in points]))
        top = points[best]
        if 0 < best < len(points) - 1:
            top = tops.get(best) or self._top(points[best - 1 : best + 2])
            if top[1] >= 0:
                return self._between(points[best - 1], top)
        if not ended and np.isinf(bearing_width(top[2].scene)):
            ended = "; no larger load was tried"
        raise OutOfRange(
            "no yield: the stress does not reach the strength at loads up to "
            f"{points[-1][2].load:.6g} N/m; the largest stress is {top[3].stress:.4g} Pa, at "
            f"{top[2].load:.4g} N/m{ended}"
        )

    def _cornered(self, x: float, reached: float) -> Yield:
        """First yield of a punch with a sharp corner at x, where the stress is always `reached`."""
        if reached >= self.strength:
            return Yield(0.0, x, 0.0, 0.0, _BLUNTED)
        raise SceneError.of(
            "strength",
            self.strength,
            f"at most {reached:.4g} Pa, the stress at the sharp corners under any load",
        )

    def _at_any_load(self, point: Point) -> Yield:
        """First yield of a body whose stresses are the same under any load, as at `point`."""
        peak = point[3]
        if point[1] >= 0:
            return Yield(0.0, peak.x, peak.y, 0.0, _BLUNTED)
        raise OutOfRange(
            f"no yield: the largest stress of a wedge is {peak.stress:.4g} Pa under any load, "
            "which is below the strength"
        )

    def _between(self, below: Point, above: Point) -> Yield:
        self.below, self.above, self.solves = below, above, 0
        return self._within()

    def _start(self, body: Body) -> Point:
        """A contact whose largest pressure is at most half of the limit, if there is one.

        Such a contact is elastic, and so are the contacts under smaller loads. At a sharp tip the
        pressure is at the limit under any load. Then the contact under the smallest load tried is
        returned.
        """
        half = 0.5 * body.scene.law.pressure_range.highest
        point, step = self.add(body.load, body), float(np.log(OPTIONS.max_ratio))
        least = point[0] + np.log(OPTIONS.least_ratio)
        while point[2].max_pressure > half and point[0] > least:
            new = self._trial(point[0] - step)
            if new is None:
                break
            point = new
        most = np.log(half * bearing_width(body.scene))
        while point[1] < 0 and point[2].max_pressure <= half and point[0] + step < most:
            new = self._trial(point[0] + step)
            if new is None or new[2].max_pressure > half:
                break
            point = new
        self.below, self.above = (point, None) if point[1] < 0 else (None, point)
        return point

    def _trial(self, level: float) -> Point | None:
        """The contact under a load; None if there is none, or none is found.
        Under very small loads, a scene may be refused because of the round-off of heights.
        """
        try:
            return self.solve(level)
        except (NotConverged, OutOfRange, SceneError):
            return None

    def _top(self, points: list[Point]) -> Point:
        """The largest stress around the middle one of three points, by golden-section search.

        The search ends where the strength is reached.
        """
        low, middle, high = points
        while middle[1] < 0 and middle[1] - min(low[1], high[1]) > 1e-6:
            side = low if middle[0] - low[0] > high[0] - middle[0] else high
            new = self._trial(middle[0] + 0.5 * (3 - 5**0.5) * (side[0] - middle[0]))
            if new is None:
                break
            inner, outer = (middle, new) if new[1] < middle[1] else (new, middle)
            if side is low:
                low, high = (outer, high) if inner is middle else (low, outer)
            else:
                low, high = (low, outer) if inner is middle else (outer, high)
            middle = inner
        return middle

    def _within(self) -> Yield:
        """Load of first yield within the bracket, by regula falsi with the Illinois weights."""
        assert self.below is not None and self.above is not None
        low, high = self.below, self.above
        weights = [1.0, 1.0]
        side, last = 0, low if abs(low[1]) < abs(high[1]) else high
        slope = 0.5
        while True:
            slope = _rate(low, high) or slope
            width = high[0] - low[0]
            if abs(last[1]) < 1e-11 or width < 1e-12:
                break
            f_low, f_high = weights[0] * low[1], weights[1] * high[1]
            level = 0.5 * (low[0] + high[0])
            if np.isfinite(f_high):
                level = low[0] - f_low * width / (f_high - f_low)
            previous, last = last, self.solve(level)
            slope = _rate(previous, last) or slope
            if last[1] < 0:
                low, weights[0] = last, 1.0
                weights[1] = 0.5 * weights[1] if side < 0 else 1.0
                side = -1
            else:
                high, weights[1] = last, 1.0
                weights[0] = 0.5 * weights[0] if side > 0 else 1.0
                side = 1
            # `last[1]` is ln(largest stress / strength). If it is below `noise`, it is smaller than
            # the error of the stress.
            noise = 0.1 * last[3].error / self.strength
            if abs(last[1]) < noise:
                break
        if np.isinf(high[1]):
            # At larger loads a sharp corner or tip is in contact, where the stress is infinite.
            body, tip, rule = low[2], high[3], self.criterion
            return Yield(
                body.load, tip.x, tip.y, OPTIONS.touch_error + body.error, _NOTE, body, rule
            )
        body, peak = last[2], last[3]
        error = (peak.error / self.strength + abs(last[1])) / max(abs(slope), 1e-3)
        error += body.error
        return Yield(body.load, peak.x, peak.y, float(error), "", body, self.criterion)


def _rate(one: Point, other: Point) -> float:
    """The slope of ln(largest stress) as a function of ln(load), between two contacts.
    The result is 0 if the slope is undefined.
    """
    if not (np.isfinite(one[1]) and np.isfinite(other[1])) or one[2].load == other[2].load:
        return 0.0
    return float((other[1] - one[1]) / np.log(other[2].load / one[2].load))


_NOTE = (
    "a sharp corner, a sharp tip or an adhesive end of a zone, where the stress is infinite under "
    "any load"
)


def _may_reach(points: list[Point]) -> bool:
    """Whether a concave curve through three points may reach the strength near the middle one.

    The middle one must have the largest stress.
    """
    if len(points) < 3 or points[1][1] < max(points[0][1], points[2][1]):
        return False
    low, middle, high = points
    left, right = middle[0] - low[0], high[0] - middle[0]
    rise, fall = middle[1] - low[1], middle[1] - high[1]
    return middle[1] + max(rise * right / left, fall * left / right) >= 0


_BLUNTED = "a sharp corner or tip, where the pressure equals its limit under any load"


def _is_wedge(body: Body) -> bool:
    """Whether the profile is a wedge: straight on both sides of one tip, without an end.

    A wedge has no length of its own. So a larger load stretches the distribution of the pressure
    along x and does not change its values.
    """
    scene = body.scene
    profile, tips = scene.profile, scene.profile.kinks[:, 0]
    if scene.period is not None or profile.known is not None or len(tips) != 1:
        return False
    size = float(np.abs(body.zones - tips[0]).max()) * np.geomspace(1e-3, 1e3, 25)
    rise = np.asarray(profile.height(tips[0] + size * [[-1.0], [1.0]]))
    slope = (rise - float(np.asarray(profile.height(tips))[0])) / size
    return bool(np.all(np.ptp(slope, axis=1) <= 1e-9 * np.abs(slope).max()))


def infinite_at(body: Body) -> float | None:
    """Position x [m] on the surface at which the stress is infinite; None if there is none.

    It is a sharp corner or tip in contact, or an end of a zone with a prescribed intensity.
    """
    if not body.fields.problem.end.intensity and np.isfinite(body.max_pressure):
        return None
    kinks = body.scene.profile.kinks
    with np.errstate(all="ignore"):
        at = np.concatenate((kinks[kinks[:, 1] > 0, 0], body.zones.ravel()))
        pressure = np.abs(body.pressure(at))
    infinite = np.flatnonzero(np.isinf(pressure) | np.isnan(pressure))
    if len(infinite):
        return float(at[infinite[0]])
    # Without an intensity, the only place left is a concave kink, where the pressure may tend to
    # -infinity. In truth a gap opens there, which is too narrow to be resolved.
    return float(at[0]) if body.fields.problem.end.intensity and len(at) else None
