"""Solve a found contact more precisely, if its stated error exceeds the wanted one."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contact.errors import NotConverged
from contact.extras import require
from contact.search.context import SolveContext
from contact.search.grid.proposals import about
from contact.search.grid.scaling import ScaledScene
from contact.search.strategies.full_contact import Full
from contact.search.strategies.gaps import tightened_gaps
from contact.search.strategies.guesses import Outcome
from contact.search.strategies.tightening import tightened
from contact.search.topology.failure import Failure, attempted
from contact.solution.assemble import undeclared_corner
from contact.verify.error import SolvedGaps, SolvedZones, body_limit, limit, position_rounding

Search = Callable[[SolveContext], Outcome]


def refined(context: SolveContext, found: Outcome, search: Search | None = None) -> Outcome:
    """The contact with the wanted error, or else the contact with the smallest error.

    search: function that searches for a contact from the beginning; it is called with a smaller
    tolerance, or without the warm start. None: no such search, as only the contact followed along a
    path is wanted.
    """
    search = search or _no_search
    outcome = _refined_once(context, found, search)
    if isinstance(outcome, Full) or outcome.error <= context.tol:
        return outcome
    if not (context.previous or context.warm_start):
        return outcome
    # A solution found from a warm start may have larger rounding errors than one that is found
    # without a warm start. So the search is repeated without the warm start.
    afresh, decisions = replace(context, previous=(), warm_start=None), context.plan.decisions
    context.plan.decisions = dict(decisions)
    other: Outcome | Failure = attempted(lambda: _refined_once(afresh, search(afresh), search))
    if isinstance(other, Failure):
        context.record_failure(
            "a search without similar solutions, as with them the error is above the tolerance",
            other,
        )
    elif isinstance(other, Full) or other.error < outcome.error:
        return other
    context.plan.decisions = decisions
    return outcome


def _no_search(context: SolveContext) -> Outcome:
    raise NotConverged("a contact that is followed along a path is not searched for again")


def _refined_once(context: SolveContext, found: Outcome, search: Search) -> Outcome:
    """The contact, solved to smaller tolerances as long as the stated error decreases."""
    if isinstance(found, Full):
        return found
    if isinstance(found, SolvedGaps) and found.error > context.tol:
        found = _by_zones(context, found)
    if isinstance(found, SolvedGaps):
        if found.error > context.tol:
            with context.plan.timed("zone ends"):
                found = tightened_gaps(context, found, retry=True)
        return found
    return _tightened(context, found, search)


def _by_zones(context: SolveContext, found: SolvedGaps) -> SolvedZones | SolvedGaps:
    """The solution `found` by gaps, or the same contact solved by zones if that is more precise.

    The zones are not tried if the error comes from the approach (`control_error`). Near full
    contact the approach is a difference of large numbers in both formulations.
    """
    if replace(found, control_error=0.0).error <= context.tol:
        return found
    problem = found.fields.problem
    control, table = context.control(problem), found.fields.zones
    other = context.refine_topology(
        about(problem, table), control, table, initial_error=found.error
    )
    if not (isinstance(other, SolvedZones) and other.error < found.error):
        return found
    because = "with gaps as the unknowns, the stated error is {}"
    context.plan.decide("unknowns", "zones", because, found.error, context.tol)
    return other


def _tightened(
    context: SolveContext, found: SolvedZones, search: Search
) -> SolvedZones | SolvedGaps:
    """The contact `found`, solved more precisely: from its zones, or by the whole `search`."""

    def again(
        here: SolvedZones | SolvedGaps, tolerance: float
    ) -> SolvedZones | SolvedGaps | Failure:
        """The contact of `here`, solved to a smaller tolerance."""
        finer = replace(context, tolerance=tolerance)

        def solved() -> Outcome:
            same = _from_same_zones(finer, here) if isinstance(here, SolvedZones) else None
            return same or search(finer)

        better: Outcome | Failure = attempted(solved)
        if isinstance(better, Full):
            return Failure("the search with a smaller tolerance found full contact")
        return better

    def cannot_improve(here: SolvedZones | SolvedGaps, tolerance: float) -> bool:
        return (
            not isinstance(here, SolvedZones)
            or _is_rounding(context, here)
            or _holds_corner(context, here)
        )

    first: SolvedZones | SolvedGaps = found
    return tightened(context, first, context.tolerance, again, cannot_improve)


def _from_same_zones(context: SolveContext, found: SolvedZones) -> SolvedZones | None:
    """The contact, solved from the same zones to a smaller tolerance; None if that fails."""
    problem, model, profile = found.fields.problem, context.scene.interaction, context.scene.profile
    control, table = context.control(problem), found.free.density.zones.table
    if not model.strip:
        better = context.refine_topology(problem, control, table, initial_error=found.error)
        return better if isinstance(better, SolvedZones) else None
    assert profile.period is not None
    scaled = ScaledScene(problem, control, (profile.x0, profile.x0 + profile.period))
    if not model.follows_isolated:
        return require("contact.localized.strips").centred(context, scaled, table)
    whole = replace(problem, amplitude=None, centre=0.0)
    return require("contact.localized.closure").first_order(
        context, replace(scaled, problem=whole), found
    )


def _holds_corner(context: SolveContext, found: SolvedZones) -> bool:
    """Whether a zone contains an undeclared corner; a smaller tolerance then does not help."""
    table = found.fields.problem.units.x(found.free.density.zones.table)
    return bool(undeclared_corner(context.scene, np.asarray(table)))


def _is_rounding(context: SolveContext, found: SolvedZones) -> bool:
    """Whether rounding exceeds the wanted error, so that a smaller tolerance does not help."""
    problem = found.fields.problem
    if found.rounded or body_limit(problem, found.free.density.zones.table, context.tol):
        return True
    if found.free.state.iterated:
        return False
    # The function `limit` compares errors with a quarter of its tolerance argument. Hence the
    # factors 4.
    return bool(
        limit(found.free, 4 * context.tol, "zone", 4 * position_rounding(found), problem.end)
    )
