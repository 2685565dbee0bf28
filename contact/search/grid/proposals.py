"""Zones proposed by the coarse grid, placed where the scaled problem wants them."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np

from contact.extras import require
from contact.formulation.controls import Control, Load
from contact.formulation.problem import Problem
from contact.formulation.tables import ascending, centred_on, gaps_between
from contact.model.interactions.periodic import Periodic
from contact.model.profiles.derive import detail_of
from contact.search.grid.conjugate_gradient import Response
from contact.search.grid.nested_grids import Proposal, grid_height, propose
from contact.search.grid.scaling import ScaledScene
from sie import Array

# Cells by which the centre of a strip's zones may miss its place.
_CELLS = 0.1
# Of the last grid: ends are off by parts of a cell, and what its signs do not tell the corrections
# of the zones do.
_CLOSELY = 1e-5
# How often a strip at rest is looked at once more, on the last grid, about the middle of its zones.
_CENTRINGS = 2
# Of a width, or of what it leaves of the period: near enough for a load to begin with; cells in it
# at least; of a grid that tells as much, cells to a shortest length of the shape, and its
# tolerance.
_ABOUT = 0.03
_SEEN = 64
_PER_FEATURE = 2
_ROUGHLY = 1e-3
# The same from the finest grid, of many zones and of few, how many such grids, and the least rate
# that a width grows with.
_CLOSE = (1e-3, 0.05)
_FINE_GRIDS = 3
_FLATTEST = 0.2
# Lengths of the kernel to a shortest length of the shape: a cell is about two of them.
_LENGTHS = 32.0
# Zones missing, or too many, that a grid may leave to Newton, as far as the width tells.
_MISSED = 0.3
# Change of a load, over it, after which a grid's contact is a good start.
_BESIDE = 0.02
# Loads over each other that are near enough to begin with, whatever lies between.
_CLOSE_BY = 1.1


def proposed(
    scaled: ScaledScene,
    problem: Problem,
    control: Control,
    points: int | None,
    tol: float = _CLOSELY,
    held: bool = False,
    near: Proposal | None = None,
) -> Proposal:
    """Zones from a grid of so many points, or of as many as the profile's resolution asks for, to a
    tolerance; held: of a strip that stays where it is; near: under another load, to begin with.
    """
    units, profile, interaction, by_load = (
        problem.units,
        problem.profile,
        problem.interaction,
        control.load is not None,
    )
    detail = profile.feature or detail_of(profile.height, *scaled.cell) if points is None else None
    if detail is not None:
        # Newton moves an end by about the kernel's length in a step: the grid comes as near.
        detail = min(detail, _LENGTHS * problem.kernel.length * units.length)
    found = propose(
        partial(grid_height, profile) if by_load else profile.height,
        scaled.cell,
        whole_response(problem),
        resolution=detail,
        points=points,
        load=control.value * units.load if by_load else None,
        level=None if by_load else problem.lowest + control.value * units.height,
        tol=tol,
        near=None if near is None else near.state,
        between_points=True,
    )
    if interaction.strip and found.load > 0.0:
        return _in_strip(problem, control, points, found, held)
    return found


def whole_response(problem: Problem) -> Response:
    """What pressure does on the whole line, or in all periods: of a strip the grid of the whole
    period tells where to cut.
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


def _in_strip(
    problem: Problem, control: Control, points: int | None, whole: Proposal, held: bool
) -> Proposal:
    """From a grid of the strip, under the nominal pressure beyond it, from the contact of the whole
    period, where that leaves a gap: the strip is cut there, or where it would leave the last one,
    and then follows its zones.
    """
    units, profile = problem.units, problem.profile
    assert profile.period is not None
    load = whole.state.load if control.load is None else control.load * units.load
    nominal = (
        load / units.load / problem.repeat_length
        if problem.amplitude is None
        else problem.amplitude
    )
    middle = cut_of(whole, profile.x0, profile.period)[0] + 0.5 * profile.period
    if profile.support is not None:
        middle = 0.5 * sum(profile.support)
    if held:
        middle = float(units.x(np.array(problem.centre)))
    at_rest, wide = (
        require("contact.search.grid.strip_at_rest"),
        whole.points if points is None else points,
    )
    strips = at_rest.PressedStrip(problem, load / units.load, nominal)
    here = strips.about(float(units.scaled(np.array(middle))), strips.points, at_rest.ROUGHLY, None)
    if not held:
        here = strips.at_rest(here, strips.farthest)
    unrest = here.unrest
    for _ in range(0 if unrest is not None else 1 if held else _CENTRINGS):
        here = strips.about(here.centre, wide, _CLOSELY, None)
        if abs(here.miss) <= _CELLS * here.cell:
            break
        here = replace(here, centre=here.centre + here.miss)
    return Proposal(here.strip.zones, wide, False, here.touches, unrest=unrest, in_strip=True)


def cut_of(whole: Proposal, x0: float, period: float) -> tuple[float, float]:
    """(the middle of the widest gap of a period, its width); in full contact the place of least
    pressure.
    """
    if whole.full or len(whole.zones) == 0:
        return x0 + period * (int(np.argmin(whole.state.pressure)) + 0.5) / whole.points, 0.0
    gaps = gaps_between(whole.zones, period)
    left, right = gaps[np.argmax(np.diff(gaps)[:, 0])]
    return 0.5 * float(left + right), float(right - left)


def of_width(scaled: ScaledScene, problem: Problem, width: float) -> Proposal:
    """Zones from a grid under a load at which they have about the given scaled total width: from
    one no finer than the width asks for first, then from one as fine as the profile's resolution
    does.
    """
    period, length = problem.repeat_length, problem.units.length
    load, rate, roughly = _load_of_width(scaled, problem, width)
    before: tuple[float, float] | None = None
    found, fine = roughly, list[tuple[float, Proposal]]()
    for _ in range(_FINE_GRIDS):
        # Farther off than that, coarser grids are the shorter way.
        beside = before is not None and abs(math.log(load / before[0])) < _BESIDE
        found = proposed(scaled, problem, Load(load), None, near=found if beside else roughly)
        miss = _miss(found.width / length, width, period)
        if before is not None and math.isfinite(miss - before[1]) and load != before[0]:
            rate = max((miss - before[1]) / math.log(load / before[0]), _FLATTEST)
        fine.append((abs(miss), found))
        # So near that hardly a zone is missing, or one too many.
        if not math.isfinite(miss) or abs(miss) < min(
            max(_MISSED / max(len(found.zones), 1), _CLOSE[0]), _CLOSE[1]
        ):
            break
        before, load = (load, miss), load * math.exp(min(max(-miss / rate, -0.5), 0.5))
    # Where the width jumps with the load, the last step may leave the bracket: the nearest grid is
    # the start.
    return min(fine, key=lambda tried: tried[0])[1]


def _miss(found: float, width: float, period: float) -> float:
    """By how much a width is off: of what is in contact to what is not, the logarithm goes about
    straight with that of the load.
    """
    if not 0.0 < found < period:
        return math.copysign(math.inf, found - width)
    return math.log(found / width * (period - width) / (period - found))


def _load_of_width(
    scaled: ScaledScene, problem: Problem, width: float
) -> tuple[float, float, Proposal]:
    """(a scaled load at which a grid's zones have about the given scaled total width, by false
    position, d miss / d log(load), these). It is that of a first guess: the grid is no finer than
    the width asks for.
    """
    units, profile, period = problem.units, problem.profile, problem.repeat_length
    near_enough, least = (
        _ABOUT * min(width, period - width),
        _SEEN * period / min(width, period - width),
    )
    features = 16.0 if profile.feature is None else units.length * period / profile.feature
    points = 2 ** int(np.clip(np.ceil(np.log2(max(_PER_FEATURE * features, least))), 8, 17))
    low, high, at_low, at_high, last, load = 0.0, math.inf, -math.inf, math.inf, 0.0, 0.1
    tried: list[tuple[float, float]] = []
    near: Proposal | None = None
    for _ in range(60):
        near = proposed(scaled, problem, Load(load), points, _ROUGHLY, near=near)
        found = near.width / units.length
        miss = _miss(found, width, period)
        tried.append((math.log(load), miss))
        if abs(found - width) < near_enough or high < _CLOSE_BY * low:
            break
        # The end that stays a second time loses half of its weight, for the other to come nearer.
        weight = 0.5 if miss * last > 0 else 1.0
        if miss < 0:
            low, at_low, at_high = load, miss, weight * at_high
        else:
            high, at_high, at_low = load, miss, weight * at_low
        last = miss
        if low == 0.0:
            load = (
                high * min(max((width / found) ** 2, 1e-3), 0.3) if found < period else 0.3 * high
            )
        elif high == math.inf:
            load = 10 * low
        else:
            share = at_high / (at_high - at_low) if math.isfinite(at_high - at_low) else 0.5
            load = high * (low / high) ** min(max(share, 0.02), 0.98)
    rises = [
        (miss - tried[-1][1]) / (at - tried[-1][0])
        for at, miss in tried[-2:-1]
        if math.isfinite(miss - tried[-1][1])
    ]
    assert near is not None
    return load, max(rises[0], _FLATTEST) if rises else 1.0, near


def placed(problem: Problem, zones: Array) -> Array:
    """Zones [m] in scaled variables, cut at the widest gap of the period where the model wants them
    in one strip; a body between sharp corners is never cut.
    """
    scaled = problem.units.scaled(zones)
    period = problem.period
    if period is None:
        return scaled
    bounded = np.isfinite(problem.corners).all()
    if problem.profile.symmetric or bounded:
        # About the origin, so that mirror images stand together; of a body between sharp corners
        # there where these are.
        middle = 0.5 * sum(problem.corners) if bounded else 0.0
        scaled = ascending(centred_on(scaled, middle, period))
    if problem.interaction.strip and len(scaled) and not bounded:
        gaps = np.diff(gaps_between(scaled, period))[:, 0]
        if gaps[-1] < (1 - 1e-6) * gaps.max():
            first = int(np.argmax(gaps)) + 1
            scaled = np.concatenate((scaled[first:], scaled[:first] + period))
    return np.asarray(scaled)


def about(problem: Problem, table: Array) -> Problem:
    """The problem with its strip centred on the scaled zones from which Newton starts."""
    if not problem.interaction.strip:
        return problem
    middle = 0.5 * float(table[0, 0] + table[-1, 1])
    near_origin = abs(middle) < 0.25 * float((table[:, 1] - table[:, 0]).min())
    return problem.about(0.0 if problem.profile.symmetric and near_origin else middle)
