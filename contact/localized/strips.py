"""Contact in one strip under a nominal pressure beyond it (the localized model): the strip is
centred on its zones, and the first-order closure takes the nominal pressure from the isolated load
of the same total width.
"""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from contact.closed.half_width import guess_half_width
from contact.errors import OutOfRange
from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.localized.derivatives import table_of
from contact.localized.one_zone import FirstOrder
from contact.localized.several_zones import SeveralZones
from contact.model.interactions.periodic import Periodic
from contact.search.context import SolveContext
from contact.search.grid.centring import Unrest
from contact.search.grid.proposals import about, proposed
from contact.search.grid.scaling import ScaledScene
from contact.search.strategies.guesses import from_grid, no_rest, search
from contact.search.topology.failure import EXACT, Failure, attempted
from contact.search.topology.loop import NewtonSettings, refine_topology
from contact.search.topology.pressure_form import PressureForm
from contact.verify.error import SolvedZones
from sie import Array, record

# Steps of the centre of a strip, how much longer than its miss, or than the step before, a secant's
# step may be, and how often one is shortened.
_CENTRINGS = 30
_LONGER = 16.0
_LONGER_AGAIN = 4.0
_SHORTENED = 3
# In how many steps of it the miss must halve, and how often zones may come or go meanwhile.
_STALLED = 4
_CHANGES = 3
# Samples of one zone in which the lowest places are counted; a missed one costs a longer search.
LOOKS = 2**10


@record
class _Centring:
    """Centre of a strip, how far off it the zones' middle is, and the zones."""

    centre: float
    miss: float
    table: Array


def centred(context: SolveContext, scaled: ScaledScene, start: Array | None) -> SolvedZones:
    """Zones of a strip that is centred on them: secants on the centre, under which zones are taken
    as they are, and a look at the signs where it stays.
    """
    if start is not None:
        scaled = replace(scaled, problem=about(scaled.problem, start))
    found = _in_strip(context, scaled, start)
    certified, before, moved = True, None, math.inf
    # How far ends move with what their middle is off the centre.
    follows = 1.0
    passed: list[float] = []
    changed = 0
    for _ in range(_CENTRINGS):
        zones, problem = found.free.density.zones, found.fields.problem
        centre, width = problem.centre, float((zones.b - zones.a).min())
        miss = 0.0 if zones.symmetric else 0.5 * float(zones.a[0] + zones.b[-1]) - centre
        # Near the digits of the zones the centre no longer comes nearer.
        if (
            abs(miss) * max(follows, 1.0)
            <= 0.1 * context.tolerance * width + np.spacing(abs(centre))
            or moved / 4 < abs(miss) < 1e-7 * width
        ):
            if certified:
                found = replace(
                    found, control_error=found.control_error + abs(miss) * follows / width
                )
                return _with_longer_series(context, scaled, found)
            found, certified, before, moved = (
                _in_strip(context, replace(scaled, problem=problem), zones.table),
                True,
                None,
                math.inf,
            )
            continue
        passed.append(abs(miss))
        if len(passed) > _STALLED and min(passed[-_STALLED:]) > 0.5 * min(passed[:-_STALLED]):
            break
        step, rate, moved = miss, None, math.inf
        if before is not None and before.table.shape == zones.table.shape and before.miss != miss:
            longest = max(_LONGER * abs(miss), _LONGER_AGAIN * abs(centre - before.centre))
            secant = float(miss * (centre - before.centre) / (before.miss - miss))
            step, moved = (
                min(max(secant, -longest), longest),
                abs(miss) if abs(secant) <= longest else math.inf,
            )
            rate = (zones.table - before.table) / (centre - before.centre)
            follows = float(np.abs(rate).max()) * abs(
                (centre - before.centre) / (before.miss - miss)
            )
        before = _Centring(centre, miss, zones.table)
        found, certified = _moved(context, scaled, found, step, rate)
        changed += certified
        if changed > _CHANGES:
            raise no_rest(problem, scaled.control, Unrest.LOST)
    raise context.error(
        Failure(f"the centre of the strip did not settle; {EXACT}", found.free),
        found.fields.problem,
    )


def _with_longer_series(
    context: SolveContext, scaled: ScaledScene, found: SolvedZones
) -> SolvedZones:
    """Where the series of the column is cut short, as it is so near to the border of a strip: under
    a load the nominal pressure is known, and with that a part of the right side, which has as many
    modes as it takes.
    """
    problem, load = found.fields.problem, found.control.load
    if problem.interaction.follows_isolated:
        return found
    if problem.amplitude is not None:
        return replace(
            found, fields=replace(found.fields, amplitude_rate=1 / problem.repeat_length)
        )
    if load is None or float(found.fields.state.end_truncation.max()) <= context.tol:
        return found
    given = replace(scaled, problem=problem.with_amplitude(load / problem.repeat_length))
    longer = attempted(lambda: centred(context, given, found.free.density.zones.table))
    if isinstance(longer, Failure):
        context.record_failure("the nominal pressure as given", longer)
        return found
    return longer


def _moved(
    context: SolveContext, scaled: ScaledScene, found: SolvedZones, step: float, rate: Array | None
) -> tuple[SolvedZones, bool]:
    """(zones after a step of the centre, or after a shorter one that they follow, whether their
    signs were looked at). rate: of the zones with the centre, where it is known.
    """
    problem, table = found.fields.problem, found.free.density.zones.table
    for _ in range(_SHORTENED):
        there, expected = (
            problem.about(problem.centre + step),
            table if rate is None else table + step * rate,
        )
        moved = refine_topology(
            PressureForm(there),
            scaled.control,
            expected,
            NewtonSettings(context.tolerance, abandon_if_far=True),
            formal=True,
        )
        if isinstance(moved, SolvedZones):
            return moved, False
        again = attempted(
            partial(from_grid, context, replace(scaled, problem=there), fixed_centre=True)
        )
        if isinstance(again, SolvedZones):
            return again, True
        step *= 0.25
    raise context.error(
        Failure(f"the zones do not follow the centre of the strip; {EXACT}", found.free), problem
    )


def _in_strip(context: SolveContext, scaled: ScaledScene, start: Array | None) -> SolvedZones:
    """Zones of a strip where it is."""
    found = search(context, scaled, start)
    assert isinstance(found, SolvedZones)  # a strip has no full contact to be near to
    return found


def first_order(
    context: SolveContext, scaled: ScaledScene, found: SolvedZones | None = None
) -> SolvedZones:
    """Closure by the isolated load of the same total width; `found`: the same less tightly."""

    def strip(problem: Problem, control: Control, start: Array | None) -> SolvedZones:
        return centred(context, replace(scaled, problem=problem, control=control), start)

    alone = partial(_reference, context)
    if scaled.control.half_width is not None:
        guess = 2 * scaled.control.half_width
    elif context.single:
        guess = 2 * guess_half_width(scaled.problem, scaled.control)
    else:
        several = SeveralZones(context, scaled, strip)
        if found is not None:
            pressure = found.fields.problem.amplitude
            assert pressure is not None
            return several.found(pressure, found.free.density.zones.table)
        with context.plan.timed("coarse search"):
            pressure = _about_load(scaled) / scaled.problem.repeat_length
        zones = table_of(strip(scaled.problem.with_amplitude(pressure), scaled.control, None))
        if not _is_asperity(scaled.problem, zones):
            return several.found(pressure, zones)
        one = FirstOrder(scaled.problem, strip, alone, zones)
        with context.plan.timed("isolated reference"):
            outcome: SolvedZones | Failure = attempted(
                lambda: one.found(scaled.control, float(np.ptp(zones)))
            )
        if not isinstance(outcome, Failure):
            return outcome
        if isinstance(outcome.refusal, OutOfRange):
            raise outcome.refusal
        # Other zones may come into contact; the width is then that of several.
        context.record_failure("one zone by its width", outcome)
        return several.found(pressure, zones)
    with context.plan.timed("isolated reference"):
        return FirstOrder(scaled.problem, strip, alone, None).found(scaled.control, guess)


def _is_asperity(problem: Problem, zones: Array) -> bool:
    """Whether the contact is one zone with one lowest place of the profile in it, which it grew
    from.
    """
    if len(zones) != 1:
        return False
    inside = np.linspace(float(zones[0, 0]), float(zones[0, 1]), LOOKS)
    height = problem.shape(inside)
    return int(np.sum((height[1:-1] < height[:-2]) & (height[1:-1] <= height[2:]))) <= 1


def _about_load(scaled: ScaledScene) -> float:
    """The load, or that of the exact contact of the period, scaled."""
    problem, control = scaled.problem, scaled.control
    if control.load is not None:
        return control.load
    exact = replace(problem, interaction=Periodic())
    return proposed(replace(scaled, problem=exact), control, None).load / problem.units.load


def _reference(
    context: SolveContext, problem: Problem, control: Control, start: Array | None
) -> SolvedZones:
    """The isolated problem of the same total width, as a formal solution: it is not asked to be a
    contact.
    """
    if control.half_width is not None:
        start = np.array([[-control.half_width, control.half_width]])
    assert start is not None
    middle = 0.5 * float(start[0, 0] + start[-1, 1])
    if len(start) > 1 or abs(middle) > 0.25 * float(start[0, 1] - start[0, 0]):
        problem = problem.about(middle)
    found = refine_topology(
        PressureForm(problem), control, start, NewtonSettings(context.tolerance), formal=True
    )
    if isinstance(found, Failure):
        raise context.error(
            Failure(
                f"the isolated reference of the first-order closure was not found: {found.reason}; {EXACT}",
                found.free,
            ),
            problem,
        )
    return found
