"""Contact under a limit of the pressure: first guess from a grid, search loop, and tolerance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contact.errors import NotConverged, OutOfRange
from contact.formulation.problem import Problem
from contact.model.controls import Quantity
from contact.model.units import counted
from contact.plastic.fields import PlasticFields
from contact.plastic.grid import proposed_spots
from contact.plastic.loop import NARROW_RIM, PlasticLoop
from contact.plastic.spots import Spots, tidied
from contact.plastic.widths import at_width
from contact.search.context import SolveContext
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import ScaledScene, scaled_scene
from contact.search.options import LEAST, SEARCH
from contact.search.topology.failure import Failure
from contact.solution.solution import Solution
from contact.verify.error import SolvedZones


def found(context: SolveContext) -> SolvedZones:
    """The contact of the scene of `context`, in which the pressure reaches its limit somewhere."""
    scene = context.scene
    if scene.given_load is None and scene.held(Quantity.APPROACH) is None:
        return at_width(context, _again)
    scaled = scaled_scene(context.scene, context.single)
    failure = Failure("no grid was tried")
    start = context.warm_start
    if start is not None and isinstance(start.fields, PlasticFields):
        context.plan.decide("first guess", "the warm start", "a similar solution is available")
        outcome = _solved(context, scaled, spots_of(scaled.problem, start))
        if isinstance(outcome, SolvedZones):
            return outcome
        context.record_failure("contacts and plateaus of a similar solution", outcome)
    part = context.plan["coarse search"]
    part.used, part.reason = True, "the pressure reaches its limit"
    context.plan.decide("first guess", "a grid", part.reason)
    points: int | None = None
    for _ in range(SEARCH.max_attempts):
        with context.plan.timed("coarse search"):
            spots, count = proposed_spots(scaled, context.scene.law.pressure_range.highest, points)
        part.detail = f"{count} points, {counted(len(spots.plateaus), 'plateau')} proposed"
        outcome = (
            _solved(context, scaled, spots)
            if spots.full or len(spots.contacts)
            else Failure("the contact is narrower than a cell of the grid; give a load")
        )
        if isinstance(outcome, SolvedZones):
            return outcome
        failure = outcome
        context.record_failure(f"contacts and plateaus of a grid of {count} points", failure)
        if failure.at_border:
            raise OutOfRange(failure.reason)
        if failure.reason == NARROW_RIM:
            break
        points = 4 * count
    raise NotConverged(f"not converged: {failure.reason}")


def _again(context: SolveContext, here: Solution) -> SolvedZones | Failure:
    """The contact under the same load as a given solution, started from this solution."""
    scaled = scaled_scene(context.scene.under("load", here.load), context.single)
    return _solved(context, scaled, spots_of(scaled.problem, here))


def spots_of(problem: Problem, similar: Solution) -> Spots:
    """Contacts and plateaus of a solution, in the units of a scaled problem."""
    fields = similar.fields
    if not isinstance(fields, PlasticFields):
        return Spots(placed(problem, similar.zones), np.zeros((0, 2)))
    units = fields.problem.units
    contacts, plateaus = (
        placed(problem, units.x(table)) for table in (fields.spots.contacts, fields.spots.plateaus)
    )
    return tidied(Spots(contacts, plateaus, fields.spots.full), problem, rims=False)


def _solved(context: SolveContext, scaled: ScaledScene, spots: Spots) -> SolvedZones | Failure:
    """The contact, started from a guess of its contacts and plateaus.
    The tolerance is lowered as long as the error is above `tol`.
    """
    problem, control = scaled.problem, scaled.control
    highest = context.scene.law.pressure_range.highest / problem.units.pressure
    # With a looser tolerance, the ends would count as found while the narrow elastic rims next to
    # plateaus still move.
    loop = PlasticLoop(problem, control, highest, min(context.tolerance, SEARCH.intermediate))
    with context.plan.timed("zone ends"):
        outcome = loop.solved(spots)
        while isinstance(outcome, SolvedZones) and outcome.error > context.tol:
            if loop.tolerance <= LEAST:
                break
            loop = replace(loop, tolerance=max(LEAST, SEARCH.tight_factor * loop.tolerance))
            better = loop.tightened(outcome)
            if not isinstance(better, SolvedZones):
                break
            # The error stays the same if the last Newton step was already below this tolerance. An
            # even smaller tolerance may still help: next to a narrow plateau, a small motion of an
            # end changes the pressure by many times as much.
            if better.error <= outcome.error:
                outcome = better
    return outcome
