"""Contact of elastically different bodies in full sliding, from the zones without friction.

Let kappa be the coefficient of the pressure in the equation. The terms with kappa add nothing to
the quadratic form of the pressure. So the inequalities for pressure and gap are as monotone as
without friction, and the zones are unique. The first guess is the contact without friction under
the same control. In nearly full contact the unknown is the slope of the gaps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from contact.errors import NotConverged, OutOfRange
from contact.formulation.problem import Problem
from contact.model.controls import Quantity
from contact.model.laws import Frictionless
from contact.search.context import SceneCache, SolveContext
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import scaled_scene, scaled_scene_about
from contact.search.options import SEARCH
from contact.search.refine import refined
from contact.search.strategies.full_contact import (
    Full,
    full_under,
    refuse_full_approach,
    smallest_full,
)
from contact.search.strategies.gaps import (
    by_gaps,
    gaps_are_better,
    record_failed_gaps,
    why_not_gaps,
)
from contact.search.strategies.guesses import Outcome
from contact.search.strategies.load_search import approach, contact_fraction, nearer
from contact.search.topology.failure import Failure
from contact.solution.solution import Solution
from sie import Array, record


@dataclass(frozen=True)
class SlidingOptions:
    """Options of the search that raises kappa (the coefficient of p in the equation) in steps."""

    least_step: float = 1 / 64  # relative to `law.beta`; smaller steps never helped


OPTIONS = SlidingOptions()


def found(context: SolveContext) -> Outcome:
    """The contact for the scene of `context`, with its stated error."""
    return refined(context, _found(context), _found)


@record
class Start:
    """A contact from which a search begins: its zones [m], tilt [rad] and load [N/m]."""

    zones: Array
    tilt: float | None
    load: float

    @classmethod
    def of(cls, contact: Solution) -> Start:
        return cls(contact.zones, contact.tilt, contact.load)

    @classmethod
    def of_outcome(cls, found: Outcome) -> Start | None:
        """Zones, tilt and load of an outcome, to begin another search; None for full contact."""
        if isinstance(found, Full):
            return None
        fields = found.fields
        return cls(fields.zone_table, fields.tilt, fields.load)


def _found(context: SolveContext) -> Outcome:
    """The contact, started from a similar solution or else from the frictionless contact."""
    scene, similar = context.scene, context.warm_start
    if scene.given_fraction == 1.0:
        context.plan.decide("full contact", "full contact", "the contact fraction is 1")
        return smallest_full(context)
    if similar is not None and len(similar.zones):
        outcome = _from(context, Start.of(similar))
        if not isinstance(outcome, Failure):
            return outcome
        context.record_failure("zones of a similar solution", outcome)
    bare = replace(scene, law=Frictionless())
    context.plan.decide("first guess", "the contact without friction", "its zones are similar")
    with context.plan.timed("coarse search"):
        smooth = context.solve_scene(bare, max(context.tol, SEARCH.intermediate))
    outcome = _from(context, Start.of(smooth))
    if isinstance(outcome, Failure):
        context.record_failure("zones without friction", outcome)
        outcome = _along_kappa(context, Start.of(smooth), outcome)
    if isinstance(outcome, Failure) and scene.given_load is None:
        context.record_failure("kappa raised in steps", outcome)
        near_by = _under_loads(context, smooth.load)
        outcome = outcome if near_by is None else _from(context, Start.of(near_by))
    if not isinstance(outcome, Failure):
        return outcome
    raise outcome.refusal or NotConverged(f"not converged: {outcome.reason}")


def _along_kappa(context: SolveContext, start: Start, failure: Failure) -> Outcome | Failure:
    """The contact, found by raising kappa in steps from zero.
    kappa is the coefficient of p in the equation; Newton's method follows each step.

    failure: the failure at the whole kappa in a single step; it is returned if all steps fail.
    """
    law: Any = context.scene.law
    reached, step, last = 0.0, 0.5, failure
    while step >= OPTIONS.least_step:
        share = min(reached + step, 1.0)
        scene = replace(context.scene, law=replace(law, beta=share * law.beta))
        here = replace(context, scene=scene, cache=SceneCache(scene))
        outcome = _from(context if share == 1.0 else here, start)
        if isinstance(outcome, Failure):
            step, last = 0.5 * step, outcome
            continue
        if share == 1.0:
            return outcome
        start = Start.of_outcome(outcome) or start
        reached, step = share, 2 * step
    return last


def _under_loads(context: SolveContext, first: float) -> Solution | None:
    """A contact whose approach or contact fraction is close to the wanted one, or None.
    It is found by a search over loads, which begins at the load `first`.

    The search is needed if a small zone is about to merge with its neighbour. Newton's method may
    then fail to converge from the contact without friction.
    """
    scene, fraction = context.scene, context.scene.given_fraction
    goal = scene.held(Quantity.APPROACH) if fraction is None else fraction
    assert goal is not None

    def under(load: float, start: Solution | None) -> Solution:
        return context.solve_scene(scene.under("load", load), SEARCH.intermediate, start)

    quantity = approach if fraction is None else contact_fraction
    found: Solution | None = None
    for here, error in nearer(under, quantity, goal, first):
        found = here
        if error <= SEARCH.tight_factor * SEARCH.rough:
            break
    return found


def _from(context: SolveContext, start: Start) -> Outcome | Failure:
    """The contact, started from the zones of a similar contact.
    The result is a Failure if the search fails.
    """
    scene = context.scene
    if scene.turned and scene.moment is not None:
        scaled = scaled_scene_about(scene, start.tilt or 0.0, start.zones)
    else:
        scaled = scaled_scene(scene, context.single)
    problem, control = scaled.problem, scaled.control
    if full := full_under(context, control):
        return full
    refuse_full_approach(context, problem, control)
    table = placed(problem, start.zones)
    # The contact without friction may be full where the sliding contact still has gaps. Then
    # `table` is empty, and the width counts as the whole period.
    width = float((table[:, 1] - table[:, 0]).sum()) if len(table) else problem.period or 0.0
    by_its_gaps = _gaps_are_known(context, problem) and (
        len(table) == 0 or gaps_are_better(context, problem, width)
    )
    if by_its_gaps:
        gaps = by_gaps(context, problem, control, width, table if len(table) else None)
        if not isinstance(gaps, Failure):
            return gaps
        record_failed_gaps(context, "gaps", gaps)
    if len(table) == 0:
        if full := full_under(context, control, but_for_kinks=True):
            return full
        return Failure(
            "the contact without friction has no gap that is wide enough to be resolved, and with "
            "elastic mismatch gaps over kinks are found only if they are resolved: use a smaller "
            "load"
        )
    load = start.load / problem.units.load
    found = context.refine_topology(problem, control, table, load_guess=load)
    if not isinstance(found, Failure):
        return found
    if found.at_border:
        raise context.error(found, problem)
    if not by_its_gaps and _gaps_are_known(context, problem):
        gaps = by_gaps(context, problem, control, width, table)
        if not isinstance(gaps, Failure):
            return gaps
    return replace(found, refusal=_refusal(context, found, problem))


def _refusal(
    context: SolveContext, failure: Failure, problem: Problem
) -> OutOfRange | NotConverged | None:
    error = context.error(failure, problem)
    return error if isinstance(error, OutOfRange | NotConverged) else None


def _gaps_are_known(context: SolveContext, problem: Problem) -> bool:
    """Whether the slope of the gap may be the unknown.
    For that, the slope must be smooth in each gap.
    """
    reason, profile = why_not_gaps(context, problem), problem.profile
    if not reason and (len(profile.jumps) or (profile.kinks[:, 1] < 0).any()):
        reason = (
            "with elastic mismatch gaps need a profile whose second and third derivatives do not "
            "jump, and which has no kinks in valleys"
        )
    if reason:
        context.plan.decide("unknowns", "zones", reason)
    return not reason
