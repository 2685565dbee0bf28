"""Nearly full contact with the gaps as the unknown; the elastic operator must have an inverse."""

import math
from dataclasses import dataclass

from contact.formulation.controls import Control
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.tables import gaps_between
from contact.model.controls import Quantity
from contact.search.context import SolveContext
from contact.search.options import SEARCH
from contact.search.strategies.tightening import tightened
from contact.search.topology.failure import Failure, WrongTopology
from contact.search.topology.gap_form import GapForm
from contact.search.topology.intervals import united
from contact.search.topology.loop import NewtonSettings, refine_topology
from contact.solution.plan import Plan
from contact.solution.solution import Solution
from contact.verify.error import SolvedGaps, SolvedZones
from sie import Array


@dataclass(frozen=True)
class GapOptions:
    """Contact fractions above which the gaps are the unknowns, and not the zones."""

    # Contact fraction above which the gaps are the unknowns, as they then need fewer modes than the
    # zones. Values from 0.5 to 0.9 also lead to the solution.
    wide_contact: float = 0.7
    # The same fraction for several asperities with kinks in the valleys between them. No load
    # closes a gap over a kink, and a search for zones loses narrow gaps.
    wide_contact_with_kinks: float = 0.25


OPTIONS = GapOptions()

# The plan states why zones or gaps are the unknowns. The reason begins with these words if a
# similar solution had the same unknowns.
_AS_BEFORE = "they were the unknowns under a similar load: "


def why_not_gaps(context: SolveContext, problem: Problem) -> str:
    """The reason why the gaps cannot be the unknowns at any contact width; empty if they can."""
    scene, operator = context.scene, context.operator
    if problem.interaction.strip:
        return f"the {scene.interaction.name} model solves a strip, which has no full contact"
    if problem.period is None:
        return "an isolated body has no full contact"
    if scene.held(Quantity.HALF_WIDTH) is not None:
        return "the half width is given"
    if not scene.law.routes.gaps:
        return f"the law {scene.law.name} forbids gaps as the unknowns"
    if not operator.has_inverse:
        body = scene.interaction if operator.is_own else scene.substrate
        return f"the inverse of the elastic operator is unknown, as {body.name} has no symbol"
    if not context.full.approached:
        return "the contact cannot become full, as the profile ends at sharp corners"
    return ""


def gaps_are_better(
    context: SolveContext, problem: Problem, width: float, options: GapOptions | None = None
) -> bool:
    """Whether gaps are the better unknowns for a contact of about the scaled width `width`.

    The answer is noted in the plan.
    """
    options, period = options or OPTIONS, problem.period
    reason = why_not_gaps(context, problem)
    if reason or period is None:
        context.plan.decide("unknowns", "zones", reason)
        return False
    threshold, because = (
        options.wide_contact,
        "the first guess of the contact width is {} of the period",
    )
    if not (context.full.possible or context.single):
        threshold = options.wide_contact_with_kinks
        because = f"no load closes the gaps over kinks of valleys, and {because}"
    is_wide = width > threshold * period
    way = "gaps" if is_wide else "zones"
    context.plan.decide("unknowns", way, because, min(width / period, 1.0), threshold)
    return is_wide


def record_as_before(plan: Plan, before: Solution) -> None:
    """Record in the plan that the unknowns are those of `before`, zones or gaps, and why."""
    way = "gaps" if isinstance(before.fields, GapFields) else "zones"
    decided = before.plan.decisions.get("unknowns")
    if decided is None or decided.way != way:
        plan.decide("unknowns", way, "they are the unknowns of a solution under a similar load")
        return
    because = _AS_BEFORE + decided.because.removeprefix(_AS_BEFORE)
    plan.decide("unknowns", way, because, decided.measured, decided.threshold)


def record_unknowns(context: SolveContext, solved: SolvedZones | SolvedGaps) -> None:
    """Record in the plan whether the final solution has zones or gaps as its unknowns."""
    plan, module = context.plan, context.scene.law.routes.module
    decided = plan.decisions.get("unknowns")
    way = "gaps" if isinstance(solved, SolvedGaps) else "zones"
    if decided is None:
        because = f"a first guess of the {way} is available"
        if module is not None:
            because = f"the law {context.scene.law.name} is solved by {module}"
        elif way == "zones":
            because = why_not_gaps(context, solved.fields.problem) or because
        plan.decide("unknowns", way, because)
    elif decided.way != way:
        because = (
            "they are the unknowns of the final solution; the first choice was "
            f"{decided.way}, since {decided.because}"
        )
        plan.decide("unknowns", way, because, decided.measured, decided.threshold)


def gap_tolerance(context: SolveContext) -> float:
    """Tolerance of the ends of gaps, which is smaller than that of the ends of zones.

    The error of an end changes all of the pressure next to a narrow gap.
    """
    return SEARCH.tight_factor * context.tolerance


def by_gaps_if_better(
    context: SolveContext,
    problem: Problem,
    control: Control,
    width: float,
    zones: Array | None = None,
    strategy: str = "gaps",
    **newton: bool,
) -> SolvedGaps | None:
    """The contact with its gaps as unknowns; None if zones are better, or if the search fails.

    A failed search is recorded in the plan, where `strategy` names the attempt. width, zones,
    newton: see `by_gaps`.
    """
    if not gaps_are_better(context, problem, width):
        return None
    found = by_gaps(context, problem, control, width, zones, **newton)
    if isinstance(found, SolvedGaps):
        return found
    record_failed_gaps(context, strategy, found)
    return None


def record_failed_gaps(context: SolveContext, strategy: str, failure: Failure) -> None:
    """Record in the plan why the gaps led to no contact, so that the zones are the unknowns."""
    context.record_failure(strategy, failure)
    decided = context.plan.decisions.get("unknowns")
    if decided is not None:
        because = f"the search for gaps failed ({failure.reason}), although {decided.because}"
        context.plan.decide("unknowns", "zones", because, decided.measured, decided.threshold)


def by_gaps(
    context: SolveContext,
    problem: Problem,
    control: Control,
    width: float,
    zones: Array | None = None,
    **newton: bool,
) -> SolvedGaps | Failure:
    """The contact with its gaps as unknowns, or a Failure.

    width: approximate scaled width of the contact. zones: approximate zones of the contact, if they
    are known. newton: `abandon_if_far` and `allow_loss` of `NewtonSettings`.
    """
    form = GapForm(problem, context.cache.relief(problem))
    width = width if control.width is None else control.width
    with context.plan.timed("zone ends"):
        found = _from_guesses(context, form, control, width, zones, **newton)
        if isinstance(found, Failure):
            return found
        found = tightened_gaps(context, found)
    if not math.isfinite(found.error):
        return Failure("the error of the pressure could not be estimated from the gaps", found.free)
    return found


def _from_guesses(
    context: SolveContext,
    form: GapForm,
    control: Control,
    width: float,
    zones: Array | None,
    **newton: bool,
) -> SolvedGaps | Failure:
    """The contact with its gaps as unknowns, from a first guess of the gaps.

    The guess is the gaps between `zones`, or the places where full contact would need tension.
    """
    tolerance = gap_tolerance(context)
    period, guesses = form.problem.repeat_length, context.cache.gap_guesses(form.problem)
    try:
        mean = guesses.mean_of(width) if control.load is None else control.load / period
        if zones is not None and len(zones) > 0:
            table = united(gaps_between(zones, period), period, True, form.what)
            found = refine_topology(form, control, table, NewtonSettings(tolerance, mean, **newton))
            # If `zones` come from a solution, `abandon_if_far` is set, and the search ends here. A
            # grid may miss narrow gaps. So if `zones` come from a grid, the gaps are guessed again
            # below.
            if newton.get("abandon_if_far") or isinstance(found, SolvedGaps):
                return found
        return refine_topology(form, control, guesses.gaps(mean), NewtonSettings(tolerance, mean))
    except WrongTopology as wrong:
        return wrong.failure


def gaps_from_fields(
    problem: Problem, fields: GapFields, control: Control, newton: NewtonSettings
) -> SolvedGaps | Failure:
    """The contact from the gaps of a similar solution."""
    form = GapForm(problem, fields.relief)
    return refine_topology(form, control, fields.gap_slope.zones.table, newton)


def tightened_gaps(context: SolveContext, found: SolvedGaps, retry: bool = False) -> SolvedGaps:
    """The same gaps, solved more precisely if the stated error exceeds the wanted error.

    retry: solve again even if rounding kept the ends from reaching the last tolerance.
    """

    def again(here: SolvedGaps, tolerance: float) -> SolvedGaps | Failure:
        mean = here.fields.mean
        newton = NewtonSettings(tolerance, mean, abandon_if_far=True, initial_error=here.error)
        return gaps_from_fields(here.fields.problem, here.fields, here.control, newton)

    def is_limited_by_rounding(here: SolvedGaps, tolerance: float) -> bool:
        return here.free.trace[-1].move > tolerance and not retry

    tolerance = gap_tolerance(context)
    return tightened(context, found, tolerance, again, is_limited_by_rounding)
