"""Zones proposed by a coarse grid, then scaled and moved into the cell of the problem."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np

from contact.formulation.controls import Control, Load
from contact.formulation.problem import Problem
from contact.formulation.tables import ascending, centred_on, gaps_between
from contact.model.interactions.periodic import Periodic
from contact.model.profiles.derive import detail_of
from contact.search.grid import nested_grids
from contact.search.grid.conjugate_gradient import OPTIONS, Response
from contact.search.grid.nested_grids import Proposal, grid_height, propose
from contact.search.grid.scaling import ScaledScene
from contact.search.options import SEARCH
from contact.verify.minima import SAMPLING
from sie import Array


def proposed(
    scaled: ScaledScene,
    control: Control,
    points: int | None,
    start: Proposal | None = None,
    cap: float = math.inf,
) -> Proposal:
    """Zones of the contact on a grid, as a start for Newton's method.

    points: number of points; None: as many as the profile's resolution needs. start: a contact
    under another load, to begin with. cap: largest pressure that the surface bears [Pa].
    """
    problem = scaled.problem
    units, profile, by_load = problem.units, problem.profile, control.load is not None
    return propose(
        partial(grid_height, profile) if by_load else profile.height,
        scaled.cell,
        replace(whole_response(problem), cap=cap),
        resolution=_detail(scaled) if points is None else None,
        points=points,
        load=control.value * units.load if by_load else None,
        level=None if by_load else problem.lowest + control.value * units.height,
        tol=OPTIONS.fine_tolerance,
        start=None if start is None else start.state,
        between_points=True,
    )


def _detail(scaled: ScaledScene) -> float:
    """Length [m] that a grid divides into `per_feature` cells: the size of profile details.

    A Newton step may move an end by about the length over which the kernel varies. So a grid cell
    may be up to twice this length, and the result up to 2 `per_feature` times this length.
    """
    problem, profile = scaled.problem, scaled.problem.profile
    cells = 2 * nested_grids.OPTIONS.per_feature
    return min(
        profile.feature or detail_of(profile.height, *scaled.cell),
        cells * problem.kernel.length * problem.units.length,
    )


def whole_response(problem: Problem) -> Response:
    """The response of the surface to pressure on the whole line or period.

    A localized model solves only a strip of the period, but this response is that of the whole
    period.
    """
    operator, interaction = problem.operator, problem.interaction
    whole = operator if not interaction.strip else replace(operator, interaction=Periodic())
    return Response(
        problem.units.E_star,
        interaction.needs_period,
        datum=operator.datum or 1.0,
        rest=None if interaction.needs_period else operator.rest,
        symbol=None if operator.is_plain else whole.multiplier,
        compression=operator.compression or 0.0,
    )


def of_width(scaled: ScaledScene, width: float) -> Proposal:
    """Zones from a grid, under a load at which their scaled total width is about `width`.

    The load is bracketed on a grid that just resolves the width. Each of the finer nested grids
    corrects the load. The finest grid, which just resolves the profile, then removes a small error
    only. Zones that this grid does not resolve are found by the check of signs. Without the finest
    grid a rough contact of more than 30 zones takes two to four times as long.
    """
    grids, period = nested_grids.OPTIONS, scaled.problem.repeat_length
    least = grids.coarsest * period / min(width, period - width)
    least = min(max(4 * grids.coarsest, least), SAMPLING.max_points)
    cell = scaled.cell[1] - scaled.cell[0]
    points = finest = nested_grids.points_for(cell, _detail(scaled), SAMPLING.max_points)[0]
    while points < least:
        points *= 2
    while points % 2 == 0 and points // 2 >= least:
        points //= 2
    load, rate, found = _load_of_width(scaled, width, points)
    while 2 * points < finest:
        points *= 2
        load, rate, found = _corrected(scaled, width, (load, rate, found), points)
    finest = max(points, finest)
    return _corrected(scaled, width, (load, rate, found), finest, is_last=True)[2]


def _corrected(
    scaled: ScaledScene,
    width: float,
    start: tuple[float, float, Proposal],
    points: int,
    is_last: bool = False,
) -> tuple[float, float, Proposal]:
    """A scaled load, corrected on a grid so that the zones have a given total width.

    start: a load, the derivative of the width's error by the logarithm of the load, and the zones,
    all from a coarser grid. is_last: whether the grid, of `points` points, is the finest one. There
    the allowed error of the width is smaller. Returns the same three results for this grid.
    """
    (load, rate, near), before = start, (math.nan, math.nan)
    tried: list[tuple[float, Proposal]] = []
    for _ in range(SEARCH.max_attempts):
        found = near = proposed(scaled, Load(load), points, start=near)
        error = _width_error(
            found.width / scaled.problem.units.length, width, scaled.problem.repeat_length
        )
        tried.append((abs(error), found))
        if not math.isfinite(error):
            break
        if load != before[0] and math.isfinite(before[1]):
            slope = (error - before[1]) / math.log(load / before[0])
            rate = slope if slope > 0.0 else rate  # it may be negative at a jump
        before = (load, error)
        load *= math.exp(min(max(-error / rate, -0.5), 0.5))
        allowed = SEARCH.missing_zones
        if is_last:
            allowed = min(allowed / max(len(found.zones), 1), SEARCH.grid_error)
        if abs(error) < allowed:
            break
    # The contact width may jump at some load. So the last trial need not be the closest to `width`.
    return load, rate, min(tried, key=lambda one: one[0])[1]


def _width_error(found: float, width: float, period: float) -> float:
    """Error of the width `found` relative to `width`, measured by ln(contact width / gap width).

    It is nearly linear in the logarithm of the load.
    """
    if not 0.0 < found < period:
        return math.copysign(math.inf, found - width)
    return math.log(found / width * (period - width) / (period - found))


def _load_of_width(scaled: ScaledScene, width: float, points: int) -> tuple[float, float, Proposal]:
    """A scaled load at which the zones have about a given total width, by false position.

    points: number of points of the grid.

    Returns the load, the derivative of the width's error by the logarithm of the load, and the
    zones.
    """
    units, period = scaled.problem.units, scaled.problem.repeat_length
    smaller = min(width, period - width)
    low, high, at_low, at_high, last, load = 0.0, math.inf, -math.inf, math.inf, 0.0, 0.1
    tried: list[tuple[float, float]] = []
    found: Proposal | None = None
    for _ in range(SEARCH.max_steps):
        found = proposed(scaled, Load(load), points, start=found)
        contact = found.width / units.length
        error = _width_error(contact, width, period)
        tried.append((math.log(load), error))
        # If the contact width jumps at a load, no load gives the wanted width. The search then ends
        # with a bracket narrower than a tenth of the load.
        if abs(contact - width) < SEARCH.grid_error * smaller or high < 1.1 * low:
            break
        # If the same end of the bracket stays for a second time, the function value at this end is
        # halved (Illinois method).
        weight = 0.5 if error * last > 0 else 1.0
        if error < 0:
            low, at_low, at_high = load, error, weight * at_high
        else:
            high, at_high, at_low = load, error, weight * at_low
        last = error
        if low == 0.0:
            # The contact width of a parabola grows as the square root of the load. So the load is
            # reduced by the square of the ratio of the widths.
            factor = min(max((width / contact) ** 2, 1e-3), 0.3) if contact < period else 0.3
            load = high * factor
        elif high == math.inf:
            load = 10 * low
        else:
            share = at_high / (at_high - at_low) if math.isfinite(at_high - at_low) else 0.5
            load = high * (low / high) ** min(max(share, 0.02), 0.98)
    rates = [
        (error - tried[-1][1]) / (at - tried[-1][0])
        for at, error in tried[-2:-1]
        if math.isfinite(error - tried[-1][1])
    ]
    assert found is not None
    return load, rates[0] if rates and rates[0] > 0.0 else 1.0, found


def placed(problem: Problem, zones: Array) -> Array:
    """Given zones [m], scaled and moved by whole periods into the cell of the problem.

    In a strip the period is cut at its widest gap. A body between sharp corners is never cut.
    """
    scaled = problem.units.scaled(zones)
    period = problem.period
    if period is None:
        return scaled
    bounded = np.isfinite(problem.corners).all()
    if problem.profile.symmetric or bounded:
        # If the body has corners, the period is centred on the middle between the corners. If not,
        # it is centred on the origin. The period of a symmetric profile then contains the mirror
        # image of each zone.
        middle = 0.5 * sum(problem.corners) if bounded else 0.0
        scaled = ascending(centred_on(scaled, middle, period))
    if problem.interaction.strip and len(scaled) and not bounded:
        gaps = np.diff(gaps_between(scaled, period))[:, 0]
        # The border of the period now lies in the last gap. It is moved to the widest gap.
        if gaps[-1] < (1 - 1e-6) * gaps.max():
            first = int(np.argmax(gaps)) + 1
            scaled = np.concatenate((scaled[first:], scaled[:first] + period))
    return np.asarray(scaled)


def about(problem: Problem, table: Array) -> Problem:
    """The problem, with a localized model's strip centred on the zones of a first guess.

    table: these zones, scaled. The problem of a model without a strip is unchanged.
    """
    if not problem.interaction.strip:
        return problem
    middle = 0.5 * float(table[0, 0] + table[-1, 1])
    near_origin = abs(middle) < 0.25 * float((table[:, 1] - table[:, 0]).min())
    return problem.about(0.0 if problem.profile.symmetric and near_origin else middle)
