"""Contacts of a given approach or contact fraction, found from contacts under given loads.

A contact under a load can always be found. The load is bracketed until the controlled quantity is
close to its given value. From the zones under that load Newton's method finds the zones at the
given value itself.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Control, Load
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.tolerances import TOLERANCES
from contact.model.controls import Quantity
from contact.model.profiles.noise import EPS
from contact.model.units import counted, quantity
from contact.search.context import SolveContext
from contact.search.grid.nested_grids import Proposal
from contact.search.grid.proposals import of_width, placed
from contact.search.grid.scaling import ScaledScene, scaled_scene_about
from contact.search.grid.tilt import known_part
from contact.search.options import SEARCH
from contact.search.strategies.gaps import (
    by_gaps_if_better,
    gap_tolerance,
    gaps_from_fields,
    record_as_before,
    tightened_gaps,
)
from contact.search.strategies.load_search import KnownLoads, approach, contact_fraction, nearer
from contact.search.topology.failure import NOT_APPLICABLE, Failure
from contact.search.topology.loop import NewtonSettings
from contact.solution.assemble import undeclared_corner
from contact.solution.solution import Solution
from contact.verify.error import SolvedGaps, SolvedZones
from sie import Array


@dataclass(frozen=True)
class LoadControlOptions:
    """Limits up to which the zones of a similar solution are a better start than a grid."""

    # Largest difference of contact width between the similar and the wanted solution, relative to
    # the contact width or the gap width, whichever is smaller. If the difference is larger, a grid
    # is as good a start for Newton's method.
    max_change: float = 0.2


OPTIONS = LoadControlOptions()


def at_approach(context: SolveContext, nearness: float) -> Solution:
    """A solution under the load of the wanted approach; `nearness` is the load's relative error.

    Raises OutOfRange if no load has that approach.
    """
    scene = context.scene
    wanted, moment = scene.held(Quantity.APPROACH), scene.moment or 0.0
    assert wanted is not None
    known = known_part(scene.profile)
    reach = math.inf if known is None or moment == 0.0 else known[1] if moment > 0 else -known[0]
    if not reach > 0.0:
        side = ("x > 0", "x <= 0") if moment > 0.0 else ("x < 0", "x >= 0")
        raise OutOfRange(
            f"moment {moment:.6g} N is out of range: the load would have to act at {side[0]}, but "
            f"the profile lies at {side[1]}; change the sign of the moment"
        )
    length = abs(wanted) or scene.operator.datum or 1.0
    guess = SEARCH.light_load * scene.E_star * length
    first = guess if context.warm_start is None else context.warm_start.load
    limits = KnownLoads(
        least=abs(moment) / reach,
        bounded=known is not None and scene.profile.support is None,
        concave=moment == 0.0 and context.operator.is_plain and scene.law.equilibria.unique,
    )
    largest = -math.inf
    for here, error in nearer(_solver_of_loads(context), approach, wanted, first, limits):
        _raise_if_corner(context, here)
        if error <= nearness:
            return here
        largest = max(largest, here.approach or 0.0)
    tried = f"; the largest approach of the loads that were tried is {largest:.6g} m"
    raise OutOfRange(
        f"no load gives the approach {wanted:.6g} m{tried if largest > -math.inf else ''}"
    )


def at_level(context: SolveContext) -> SolvedZones:
    """Contact of an isolated body at an approach, from zones at a load of about this approach."""
    failure, problem = Failure("no load was tried"), None
    for nearness in (SEARCH.rough, SEARCH.intermediate):
        context = context.with_warm_start(at_approach(context, nearness))
        start = context.warm_start
        assert start is not None
        loaded = context.scene.under("load", start.load)
        problem = scaled_scene_about(loaded, start.tilt or 0.0, start.zones).problem
        found = context.refine_topology(
            problem, context.control(problem), placed(problem, start.zones)
        )
        if isinstance(found, SolvedZones):
            because = "its approach is close to the given one"
            context.plan.decide("first guess", "a solution under a load", because)
            return found
        failure = found
        context.record_failure("zones under a load with about this approach", failure)
    assert problem is not None
    raise context.error(failure, problem)


def by_fraction(context: SolveContext, scaled: ScaledScene) -> SolvedZones | SolvedGaps:
    """The contact with a given contact fraction, from solutions at a converging series of loads."""
    problem, control, goal = scaled.problem, scaled.control, context.scene.given_fraction
    assert goal is not None
    smaller_part = min(goal, 1 - goal)
    start = context.warm_start
    # A similar solution is a better start than a grid only if the solution's contact fraction is
    # close to `goal`.
    change = (
        math.inf if start is None else abs((start.contact_fraction or 0.0) - goal) / smaller_part
    )
    if start is None or change > OPTIONS.max_change:
        outcome = _by_first_guess(context, scaled, goal)
        if not isinstance(outcome, float):
            return outcome
        first, way = outcome, "a solution under a load"
        context.plan.decide("first guess", way, "no contact of this fraction was found from a grid")
    else:
        first = start.load
        because = "its contact fraction differs by {} of the smaller of contact and gaps"
        context.plan.decide("first guess", "the warm start", because, change, OPTIONS.max_change)
    near_enough, last, error = SEARCH.rough, None, 1.0
    solve_load = _solver_of_loads(context)

    def solve(load: float, nearest: Solution | None) -> Solution:
        if nearest is not None:
            fraction, rate = contact_fraction(nearest)
            change = abs(rate * (load - nearest.load))
            if change >= OPTIONS.max_change * min(fraction, 1 - fraction):
                # A grid is a better start than a solution whose contact fraction is so different.
                nearest = None
        elif start is not None and load == start.load:
            return start
        return solve_load(load, nearest)

    # The search ends when the width of the bracket, divided by the load, is at most `closed`.
    # Round-off prevents a narrower bracket.
    limits = KnownLoads(closed=64 * EPS)
    for here, load_error in nearer(solve, contact_fraction, goal, first, limits):
        _raise_if_corner(context, here)
        last, fraction = here, contact_fraction(here)[0]
        # `error` is the larger of two relative errors: of the load and of the contact fraction. The
        # error of the fraction is larger if the fraction grows fast with the load.
        error = max(load_error, abs(goal - fraction) / smaller_part)
        if error > near_enough:
            continue
        near_enough = 0.5 * error
        found = _from_solution(context, problem, control, here)
        if not isinstance(found, Failure):
            return found
        context.record_failure(f"zones under a load of {quantity(here.load, 'N/m', 6)}", found)
        if found.at_border:
            raise context.error(found, problem)
    assert last is not None
    return _at_jump(context, problem, control, last)


def _by_first_guess(
    context: SolveContext, scaled: ScaledScene, goal: float
) -> SolvedZones | SolvedGaps | float:
    """The contact with contact fraction `goal`, from a first guess of the zones or gaps.
    If the search fails, the result is the load [N/m] at which a grid contact has about this
    fraction.
    """
    problem, control = scaled.problem, scaled.control
    # Close to full contact, grids do not resolve the narrow gaps that remain. The gaps are guessed
    # from the places where full contact needs tension.
    if 1 - goal < SEARCH.rough:
        because = "a grid does not resolve the gaps"
        context.plan.decide("first guess", "the tension in full contact", because)
        found_by_gaps = by_gaps_if_better(context, problem, control, control.value)
        if found_by_gaps is not None:
            return found_by_gaps
    part = context.plan["coarse search"]
    with context.plan.timed("coarse search"):
        proposal = of_width(scaled, control.value)
    part.detail = f"{proposal.points} points, {counted(len(proposal.zones), 'zone')} proposed"
    context.plan.decide("first guess", "a grid", "the load of a contact fraction is unknown")
    found = _from_grid(context, problem, control, proposal)
    if not isinstance(found, Failure):
        return found
    context.record_failure("zones of about this width from a grid", found)
    return proposal.load


def _from_grid(
    context: SolveContext, problem: Problem, control: Control, proposal: Proposal
) -> SolvedZones | SolvedGaps | Failure:
    """The contact of a given width, from the zones of a grid contact of about that width."""
    if proposal.full or len(proposal.zones) == 0:
        return Failure("the grid has no zones of about this width")
    table = placed(problem, proposal.zones)
    found_by_gaps = by_gaps_if_better(
        context, problem, control, control.value, table, "gaps between zones of a grid"
    )
    if found_by_gaps is not None:
        return found_by_gaps
    # All zone widths are multiplied by one factor, so that their sum is the wanted width. Without
    # this, Newton's first step would be too long on a thin layer, whose kernel is short.
    half = np.diff(table) / 2
    table = table + half * [-1.0, 1.0] * (control.value / (2 * half.sum()) - 1.0)
    return _refined(context, problem, control, table, proposal.load / problem.units.load)


def _at_jump(
    context: SolveContext, problem: Problem, control: Control, last: Solution
) -> SolvedZones | SolvedGaps:
    """The contact of a given width, solved under the load at which `last` has this width.

    This is used at a load at which a zone is born or two zones merge, as solving for the width
    fails there. Raises NotConverged where the contact fraction jumps with the load.
    """
    assert last.contact_fraction is not None and problem.period is not None
    error = abs(last.contact_fraction - control.value / problem.period)
    load = Load(last.load / problem.units.load)
    is_there = error <= KnownLoads().closed
    found = _from_solution(context, problem, load, last) if is_there else NOT_APPLICABLE
    if isinstance(found, Failure):
        raise NotConverged(
            "no load in double precision has the contact fraction "
            f"{context.scene.given_fraction:.15g}: at the mean pressure {last.mean_pressure:.15g} "
            f"Pa it is {last.contact_fraction:.15g}, and beside this pressure it jumps past the "
            "given fraction; give a load",
            (),
            last,
        )
    if isinstance(found, SolvedGaps):
        return replace(
            found,
            control_error=found.control_error + TOLERANCES.rounding * load.value / problem.period,
        )
    narrowest = float(np.diff(found.free.density.zones.table, axis=1).min())
    return replace(found, control_error=error * problem.period / narrowest)


def _from_solution(
    context: SolveContext, problem: Problem, control: Control, start: Solution
) -> SolvedZones | SolvedGaps | Failure:
    """The contact from the zones, or the gaps, of a similar solution."""
    fields = start.fields
    record_as_before(context.plan, start)
    if not isinstance(fields, GapFields):
        load = start.load / problem.units.load
        return _refined(context, problem, control, placed(problem, start.zones), load)
    newton = NewtonSettings(gap_tolerance(context), fields.mean)
    with context.plan.timed("zone ends"):
        found = gaps_from_fields(problem, fields, control, newton)
        return found if isinstance(found, Failure) else tightened_gaps(context, found)


def _refined(
    context: SolveContext, problem: Problem, control: Control, table: Array, load: float
) -> SolvedZones | Failure:
    """Zones that pass the check of signs, found from a table of zones close to the solution."""
    return context.refine_topology(problem, control, table, load_guess=load)


def _raise_if_corner(context: SolveContext, here: Solution) -> None:
    """Raise NotConverged if an undeclared corner keeps the error of `here` above the tolerance.

    Solutions at other loads would have an error of the same size.
    """
    if here.error <= max(context.tol, SEARCH.intermediate):
        return
    if corner := undeclared_corner(context.scene, here.zones):
        raise NotConverged(
            f"under the load {quantity(here.load, 'N/m', 6)} the stated error {here.error:.2g} is "
            f"above the tolerance {context.tol:.2g}: {corner}",
            (),
            here,
        )


def _solver_of_loads(context: SolveContext) -> Callable[[float, Solution | None], Solution]:
    """A function that solves the scene under a load, from the nearest solution."""
    tolerance = SEARCH.intermediate

    def solve(load: float, nearest: Solution | None) -> Solution:
        """The solution under a load, or the best approximation if its error is below `rough`."""
        nonlocal tolerance
        loaded, start = context.scene.under("load", load), nearest or context.warm_start
        try:
            return context.solve_scene(loaded, tolerance, start, context.progress)
        except NotConverged as failure:
            # An error above the tolerance but below `SEARCH.rough` is small enough for an
            # intermediate solution.
            if failure.best is None or not failure.best.error < SEARCH.rough:
                raise
            # The tolerance of the next loads is twice the error that was reached at this load. With
            # a smaller tolerance, each load would repeat the attempts that failed here.
            tolerance = min(2 * failure.best.error, SEARCH.rough)
            return failure.best

    return solve
