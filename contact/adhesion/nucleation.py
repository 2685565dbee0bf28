"""Nucleation: zones begin at first touch, and where surfaces overlap as other zones advance.

Inside intervals of tension, zones begin, merge, split and vanish without a jump. They do so where
the gap or the pressure becomes zero.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from contact.adhesion.cohesive_state import CohesiveState
from contact.adhesion.cohesive_zone import CohesiveCurve
from contact.adhesion.curve import ACCURACY, Curve, State
from contact.adhesion.gradient_flow import advanced
from contact.adhesion.options import LIMITS, MOVES, SAMPLES
from contact.errors import NotConverged
from contact.formulation.roots import minimum
from contact.formulation.tables import ascending, runs_of
from contact.search.topology.changes import Change, changes, overlapping
from contact.verify.certificate import openings
from sie import Array


def grown(curve: Curve, table: Array, value: float, rest: float = ACCURACY.resting_step) -> State:
    """The equilibrium with the smallest zones that contain the zones `table`.

    All ends of the zones `table` must be driven outward. In the equilibrium the surfaces overlap
    nowhere. Raises `Closed` if there is no such equilibrium. rest: largest Newton step, relative to
    the widths, of ends at rest.
    """
    for _ in range(LIMITS.max_iterations):
        here = advanced(curve, table, value, rest)
        new = curve.within(openings(curve.fields(here, ACCURACY.rough)).overlaps)
        if len(new) == 0:
            return here
        table = _driven_outward(curve, here, new)
    raise NotConverged(
        f"under adhesion, new zones still appeared after {LIMITS.max_iterations} rounds of growth"
    )


def _driven_outward(curve: Curve, here: State, overlaps: Array) -> Array:
    """The zones of a state, plus a narrow new zone in each overlap unless that zone would recede.
    Overlaps are intervals in which the surfaces overlap.

    A new zone is left out if the residuals of both ends are negative. If this is true of all new
    zones, all are kept.
    """
    while True:
        table = with_new(here.table, overlaps)
        left, right = np.split(curve.at(table, here.value, ACCURACY.rough).whole.residual, 2)
        away = table[(left < 0.0) & (right < 0.0)].mean(axis=1)
        stays = ~np.array([np.any((away > lo) & (away < hi)) for lo, hi in overlaps])
        if stays.all() or not stays.any():
            return table
        overlaps = overlaps[stays]


def with_new(table: Array, overlaps: Array) -> Array:
    """The zones, and a narrow new zone in the middle of each overlap of the surfaces."""
    middle, half = overlaps.mean(axis=1), 0.5 * MOVES.new_width * np.diff(overlaps, axis=1)[:, 0]
    return ascending(np.concatenate((table, np.column_stack((middle - half, middle + half)))))


def touched(curve: Curve, cell: tuple[float, float], value: float = 0.0) -> Array:
    """Narrow intervals around the lowest points of the profile, where surfaces first touch.
    `cell` is the part of the profile, in metres, that is searched.

    The ends of the intervals are all driven outward at the control value `value`, or pinned at
    sharp corners. On a level stretch of the profile the interval is as wide as this stretch.
    """
    problem, (lo, hi) = (
        curve.problem,
        cell if curve.problem.profile.support is None else curve.problem.profile.support,
    )
    period, profile = problem.period, problem.profile
    per_feature = 0.0 if profile.resolution is None else 8 * (hi - lo) / profile.resolution
    x = problem.units.scaled(
        np.linspace(lo, hi, int(np.clip(per_feature, SAMPLES.profile_samples, SAMPLES.max_samples)))
    )
    kinks = problem.forcing.kinks[0]
    x = np.unique(np.concatenate((x, kinks[(kinks > x[0]) & (kinks < x[-1])])))
    f = problem.shape(x)
    least = f.min()
    low = np.flatnonzero((f[1:-1] <= f[:-2]) & (f[1:-1] <= f[2:])) + 1
    if period is not None and min(f[0], f[-1]) <= f[low].min(initial=np.inf):
        low = np.append(low, 0)
    ends = np.array([0, len(x) - 1])
    if profile.support is not None:
        low = np.append(low, ends[[f[0] <= f[1], f[-1] <= f[-2]]])
    together = ACCURACY.neutral * max(float(np.ptp(f)), 1.0)
    # A level stretch of the profile (of constant, lowest height) would be found twice, at both
    # borders, if it crossed the border of the cell. In this case no level stretch is used.
    whole = profile.support is not None or not (
        f[0] - least <= together and f[-1] - least <= together
    )
    level = [
        (x[s], x[e]) for s, e in runs_of(f - least <= together) if e - s > LIMITS.patience and whole
    ]
    low = low[[all(not s <= x[i] <= e for s, e in level) for i in low]]
    step = float(np.diff(x).max())
    tips = []
    for i in low[f[low] - least <= 0.05 * np.ptp(f)]:
        around = np.clip(np.linspace(x[i] - 2 * step, x[i] + 2 * step, 65), *problem.corners)
        tips.append(minimum(problem.shape, around))
    lowest = min([depth for _, depth in tips] + [float(least)] * bool(level))
    chosen = sorted(place for place, depth in tips if depth - lowest <= together)
    places = [p for k, p in enumerate(chosen) if k == 0 or p - chosen[k - 1] > step]
    if period is not None and len(places) > 1 and places[0] + period - places[-1] <= step:
        places = places[:-1]
    if problem.profile.symmetric and problem.units.origin == 0.0:
        places = [0.0 if abs(p) < 1e-6 * step else p for p in places]
    half = 0.25 * MOVES.new_width * (1.0 if period is None else min(period, step * 1e3))
    while True:
        narrow = [(place - half, place + half) for place in places]
        table = curve.within(np.array(sorted(narrow + [(s - half, e + half) for s, e in level])))
        if np.all(curve.at(table, value).whole.residual > 0.0) or half < 1e-12:
            return table
        half *= 0.1


def changes_between(
    before: CohesiveState, after: CohesiveState, period: float | None
) -> list[Change]:
    """Births, mergers, splits and deaths of zones between two states, with their places.

    For births and deaths, the place is the interval in which the zone is sought.
    """
    if len(before.zones) == len(after.zones) and all(
        len(overlapping(before.zones, a, b, period)) == 1 for a, b in after.zones
    ):
        return []
    without = {"birth": before.zones, "death": after.zones}
    return [
        replace(change, where=about(without[change.kind], *change.where, period))
        if change.of_gap
        else change
        for change in changes(before.zones, after.zones, period, only_grows=False)
    ]


def about(zones: Array, a: float, b: float, period: float | None) -> tuple[float, float]:
    """An interval around (a, b) that contains no other zone.
    (a, b) is the interval in which a zone begins or vanishes.
    """
    lo, hi = 1.5 * a - 0.5 * b, 1.5 * b - 0.5 * a
    for shift in (0.0,) if period is None else (-period, 0.0, period):
        for left, right in zones + shift:
            if right <= a:
                lo = max(lo, float(0.5 * (right + a)))
            elif left >= b:
                hi = min(hi, float(0.5 * (left + b)))
    return float(lo), float(hi)


def condition(curve: CohesiveCurve, here: CohesiveState, change: Change) -> tuple[float, float]:
    """(position, value) of the least gap; for a merger or split of zones, of the least pressure."""
    x = np.linspace(*change.where, SAMPLES.samples)
    if change.of_gap:
        return minimum(partial(curve.gap, here), x)
    assert here.q is not None
    return minimum(here.q.density, x)


def with_change(zones: Array, change: Change, place: float) -> Array:
    """The zones with one zone more: a new zone of zero width, or one zone cut in two."""
    if change.of_gap:
        return ascending(np.concatenate((zones, [[place, place]])))
    out = []
    for a, b in zones:
        out += [(a, place), (place, b)] if a < place < b else [(a, b)]
    return np.array(out)
