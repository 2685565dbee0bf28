"""What was found, solved more tightly, or better, where its stated error is above the wanted one."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contact.extras import require
from contact.search.context import SolveContext
from contact.search.grid.proposals import about, placed
from contact.search.grid.scaling import ScaledScene, scaled_scene_about
from contact.search.strategies.full_contact import Full
from contact.search.strategies.gaps import tightened_gaps
from contact.search.strategies.guesses import Outcome
from contact.search.strategies.tightening import tightened
from contact.search.topology.failure import Failure, attempted
from contact.verify.error import SolvedGaps, SolvedZones, body_limit, limit, position_rounding

# Zones of a lone body farther than so many times their span from the origin of places.
_FAR_OFF = 64.0


def refined(
    context: SolveContext, found: Outcome, again: Callable[[SolveContext], Outcome]
) -> Outcome:
    """again: the whole search, for a context that asks for more, or that begins from nothing."""
    outcome = _as_told(context, found, again)
    if (
        isinstance(outcome, Full)
        or outcome.error <= context.tol
        or not (context.previous or context.warm_start)
    ):
        return outcome
    # From solutions near by ends may have come to rest where rounding moves them more than where a
    # search would have left them.
    afresh = replace(context, previous=(), warm_start=None)
    other: Outcome | Failure = attempted(lambda: _as_told(afresh, again(afresh), again))
    if isinstance(other, Failure):
        context.record_failure(
            "a search from nothing, as from others the error is above the tolerance", other
        )
        return outcome
    return other if isinstance(other, Full) or other.error < outcome.error else outcome


def _as_told(
    context: SolveContext, found: Outcome, again: Callable[[SolveContext], Outcome]
) -> Outcome:
    """What was found by the ways of the context, as tightly as it takes."""
    # Under a tension what belongs to it is solved as tightly as there is where it is found.
    if isinstance(found, Full) or context.scene.law.tension:
        return found
    if isinstance(found, SolvedGaps) and found.error > context.tol:
        found = _by_zones(context, found)
    if isinstance(found, SolvedGaps):
        if found.error > context.tol:
            with context.plan.timed("zone ends"):
                found = tightened_gaps(context, found, stuck=True)
        return found
    return _tightened(context, _counted_from_there(context, found), again)


def _counted_from_there(context: SolveContext, found: SolvedZones) -> SolvedZones:
    """Zones of a lone body that lie far from where they were looked for, solved again with places
    counted from there: else these are rounded to much of the zones' widths.
    """
    scene, zones = context.scene, found.free.density.zones
    span, away = float(zones.b[-1] - zones.a[0]), float(max(-zones.a[0], zones.b[-1]))
    if (
        scene.interaction.needs_period
        or scene.turned
        or scene.profile.support is not None
        or away < _FAR_OFF * span
    ):
        return found
    table = np.asarray(found.fields.problem.units.x(zones.table))
    scaled = scaled_scene_about(scene, 0.0, table)
    there = context.refine_topology(
        scaled.problem, context.control(scaled.problem), placed(scaled.problem, table)
    )
    return found if isinstance(there, Failure) else there


def _by_zones(context: SolveContext, found: SolvedGaps) -> SolvedZones | SolvedGaps:
    """The same contact with the pressure as the unknown, if that comes out better; not where it is
    the approach that tells too little: near full contact the level of the zones, a difference of
    large numbers, tells no more.
    """
    if replace(found, off=0.0).error <= context.tol:
        return found
    problem = found.fields.problem
    control, table = context.control(problem), found.fields.zones
    other = context.refine_topology(
        about(problem, table), control, table, initial_error=found.error
    )
    return other if isinstance(other, SolvedZones) and other.error < found.error else found


def _tightened(
    context: SolveContext, found: SolvedZones, whole: Callable[[SolveContext], Outcome]
) -> SolvedZones | SolvedGaps:
    """Solved again from the same zones; from the start, if they do not stand up to it."""

    def again(
        here: SolvedZones | SolvedGaps, tolerance: float
    ) -> SolvedZones | SolvedGaps | Failure:
        sharper = replace(context, tolerance=tolerance)

        def better_found() -> Outcome:
            same = _from_the_same(sharper, here) if isinstance(here, SolvedZones) else None
            return same or whole(sharper)

        better: Outcome | Failure = attempted(better_found)
        return (
            Failure("full contact, as the whole search says")
            if isinstance(better, Full)
            else better
        )

    def at_rest(here: SolvedZones | SolvedGaps, tolerance: float) -> bool:
        return not isinstance(here, SolvedZones) or _is_rounding(context, here)

    first: SolvedZones | SolvedGaps = found
    return tightened(context, first, context.tolerance, again, at_rest)


def _from_the_same(context: SolveContext, found: SolvedZones) -> SolvedZones | None:
    """The same zones more tightly; None where they do not stand up to it."""
    problem, model, profile = found.fields.problem, context.scene.interaction, context.scene.profile
    control, table = context.control(problem), found.free.density.zones.table
    if not model.strip:
        better = context.refine_topology(problem, control, table, initial_error=found.error)
        return better if isinstance(better, SolvedZones) else None
    assert profile.period is not None
    scaled = ScaledScene(problem, control, (profile.x0, profile.x0 + profile.period))
    strips = require("contact.localized.strips")
    if not model.follows_isolated:
        return strips.centred(context, scaled, table)
    return strips.first_order(
        context, replace(scaled, problem=replace(problem, amplitude=None, centre=0.0)), found
    )


def _is_rounding(context: SolveContext, found: SolvedZones) -> bool:
    """Whether rounding alone, of a solution that no iteration left an error in, is above the wanted
    error.
    """
    if found.rounded or body_limit(
        found.fields.problem, found.free.density.zones.table, context.tol
    ):
        return True
    end = found.fields.problem.end
    return not found.free.state.iterated and bool(
        limit(found.free, 4 * context.tol, "zone", 4 * position_rounding(found), end)
    )
