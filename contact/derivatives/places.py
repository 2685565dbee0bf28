"""Places at which the pressure is highest, and at which the profile is lowest.

The derivative of a maximum by a parameter is the derivative of the function at the fixed place of
the maximum. If there are several places with the same maximum, the derivative is one-sided: it is
the largest of the derivatives at these places.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Chebyshev

from contact.formulation.full_contact import period_samples
from contact.formulation.quadrature import chebyshev_nodes
from contact.formulation.roots import maximum, reaches
from contact.formulation.tolerances import TOLERANCES
from contact.model.profiles.base import Profile
from contact.model.profiles.derive import DETAIL, detail_of
from contact.model.profiles.noise import EPS
from contact.solution.solution import Solution
from contact.verify.minima import SAMPLING
from sie import Array

# Half width of the window in which the place of a maximum is refined by a polynomial of degree 5,
# divided by the shortest length over which the function varies. The truncation error is the fifth
# power of this ratio, and so as small as round-off.
WINDOW = EPS ** (1 / 5)


def peaks(solution: Solution) -> Array:
    """Places [m] (k,) of the largest pressure; empty if it is infinite or not positive."""
    x = _samples(solution)
    return _maxima(solution.pressure, x, Window.of(solution)) if len(x) else x


def _samples(solution: Solution) -> Array:
    """Ascending places [m] between which the pressure has at most one local maximum.

    Empty if the largest pressure is infinite or not positive.
    """
    zones, profile = solution.zones, solution.scene.profile
    if not np.isfinite(solution.max_pressure) or not solution.max_pressure > 0:
        return np.zeros(0)
    if len(zones) == 0:
        return np.zeros(0) if profile.period is None else period_samples(profile)
    width = float(np.max(zones[:, 1] - zones[:, 0]))
    shortest = profile.resolution or np.inf
    count = SAMPLING.min_points + int(min(8 * width / shortest, SAMPLING.max_points))
    angle = np.linspace(np.pi, 0.0, count)
    middle, half = zones.mean(axis=1)[:, None], 0.5 * np.diff(zones, axis=1)
    return np.asarray((middle + half * np.cos(angle)).ravel())


def tops(solution: Solution, most: int) -> Array:
    """Ascending places [m] of the highest local maxima of the pressure, at most `most` of them."""
    x = _samples(solution)
    if len(x) == 0:
        return x
    if len(solution.zones) == 0:
        # The last sample is the first one of the next period.
        x = np.concatenate((x, x[1:2] + x[-1] - x[0]))
    inside = 1 + np.flatnonzero(np.isfinite(reaches(np.asarray(solution.pressure(x)))[1:-1]))
    lo, hi = x[inside - 1], x[inside + 1]
    rows = np.arange(len(lo))
    # Each zoom narrows the bracket to a quarter, and a parabola squares the error that is left.
    for _ in range(6):
        fine = lo[:, None] + (hi - lo)[:, None] * np.linspace(0, 1, 9)
        value = np.asarray(solution.pressure(fine))
        best = np.argmax(value, axis=1)
        lo, hi = fine[rows, np.maximum(best - 1, 0)], fine[rows, np.minimum(best + 1, 8)]
    middle = np.clip(best, 1, 7)
    before, here, after = (value[rows, middle + k] for k in (-1, 0, 1))
    bend = np.maximum(2 * here - before - after, np.finfo(float).tiny)
    step = np.clip(0.5 * (after - before) / bend, -1.0, 1.0)
    place = fine[rows, middle] + step * (fine[:, 1] - fine[:, 0])
    value = np.asarray(solution.pressure(place))
    order = np.argsort(-value)
    apart: list[int] = []
    for k in order.tolist():
        # Equal samples are both local maxima.
        if all(abs(place[k] - place[j]) > hi[k] - lo[k] for j in apart):
            apart.append(k)
    return np.sort(place[apart[:most]])


def lowest(solution: Solution) -> Array:
    """Places [m] (k,) at which the height of the profile is lowest."""
    profile, zones = solution.scene.profile, solution.zones
    if profile.summits is not None:
        at = np.asarray(profile.summits, dtype=float)
        height = np.asarray(profile.height(at))
        size = float(np.ptp(height)) + abs(float(height.min()))
        return np.asarray(at[height <= height.min() + TOLERANCES.height_rounding * size])
    if profile.period is not None:
        x = period_samples(profile)
    else:
        lo, hi = profile.known or (zones[0, 0], zones[-1, 1])
        detail = profile.resolution or detail_of(profile.height, lo, hi)
        count = DETAIL.samples_per_length * (hi - lo) / detail
        x = np.linspace(lo, hi, int(np.clip(count, DETAIL.min_samples, SAMPLING.max_points)))
    ends = np.array([[x[0], x[-1]]])
    window = Window(ends, profile.resolution or np.inf, _kinks(profile), 0.0)
    return _maxima(lambda at: -np.asarray(profile.height(at)), x, window)


def _kinks(profile: Profile) -> Array:
    points = np.asarray(profile.algebraic_points).reshape(-1, 4)
    return np.concatenate((profile.kinks[:, 0], points[:, 0]))


@dataclass(frozen=True)
class Window:
    """Data for refining the place of a maximum of a function.

    ends: intervals [m]; each maximum lies in one of them. shortest: shortest length [m] over which
    the profile varies. cusps: places [m] at which the function is not smooth. error: relative error
    of the function.
    """

    ends: Array
    shortest: float
    cusps: Array
    error: float

    @classmethod
    def of(cls, solution: Solution) -> Window:
        """The window for maxima of the pressure, or of a stress on the surface, of a solution."""
        profile, ends = solution.scene.profile, solution.zones
        if len(ends) == 0:
            ends = profile.x0 + np.array([[0.0, profile.period or 1.0]])
        cusps = np.asarray(profile.algebraic_points).reshape(-1, 4)[:, 0]
        return cls(ends, profile.resolution or np.inf, cusps, solution.error)

    def size(self, place: float) -> float:
        """Half width of the window around a place in which a maximum is refined."""
        widths = self.ends[:, 1] - self.ends[:, 0]
        inside = (self.ends[:, 0] <= place) & (place <= self.ends[:, 1])
        width = float(widths[inside].min()) if inside.any() else float(widths.min())
        return WINDOW * min(width, self.shortest)

    def corrected(self, function: Callable[[Array], Array], place: float) -> float:
        """The place of a maximum, where the derivative is 0, refined from a nearby place."""
        half = self.size(place)
        if len(self.cusps):
            nearest = float(self.cusps[int(np.argmin(np.abs(self.cusps - place)))])
            if abs(nearest - place) <= half:
                return nearest
        t = chebyshev_nodes(16)
        value = np.asarray(function(place + half * t))
        if not np.isfinite(value).all():
            return place
        slope = Chebyshev.fit(t, value, 5, domain=[-1, 1]).deriv()
        bend = slope.deriv()
        at = 0.0
        for _ in range(4):
            step = float(slope(at)) / (float(bend(at)) or np.inf)
            if not abs(at - step) <= 1:
                return place
            at -= step
        return place + half * at


def _maxima(function: Callable[[Array], Array], x: Array, window: Window) -> Array:
    value = np.asarray(function(x), dtype=float)
    finite = np.where(np.isfinite(value), value, -np.inf)
    place, highest = maximum(function, x, value=finite)
    span = float(np.ptp(finite[np.isfinite(finite)])) or abs(highest)
    close = TOLERANCES.margin * max(TOLERANCES.rounding, window.error) * span
    bound = reaches(finite)
    found = [window.corrected(function, place)]
    for k in np.flatnonzero(bound >= highest - close).tolist():
        lo, hi = x[max(k - 1, 0)], x[min(k + 1, len(x) - 1)]
        if any(lo - window.size(one) <= one <= hi + window.size(one) for one in found):
            continue
        other, at = maximum(function, np.linspace(lo, hi, 9))
        if at >= highest - close:
            found.append(window.corrected(function, other))
    return np.array(found)
