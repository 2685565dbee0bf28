"""Nearly full contact, solved for its gaps: the operator needs an inverse, the contact is wide."""

import math
from dataclasses import dataclass

from contact.formulation.controls import Control
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.tables import gaps_between
from contact.search.context import SolveContext
from contact.search.strategies.tightening import tightened
from contact.search.topology.failure import Failure, WrongTopology
from contact.search.topology.gap_form import GapForm
from contact.search.topology.intervals import united
from contact.search.topology.loop import NewtonSettings, refine_topology
from contact.verify.error import SolvedGaps
from sie import Array


@dataclass(frozen=True)
class GapOptions:
    """From which contact fraction gaps are the unknowns, and how precisely they are found."""

    # Both ways solve a contact between 0.5 and 0.9; gaps need fewer modes above about 0.7.
    wide_contact: float = 0.7
    # With kinks in the valleys of several asperities: no load closes a gap over a kink, and narrow
    # ones are lost between zones.
    wide_contact_with_kinks: float = 0.25
    # Tolerance of gap ends over that of zone ends. An end of a gap moves all the pressure next to
    # it, and a gap is narrow where contact is nearly full.
    tolerance_factor: float = 0.01


OPTIONS = GapOptions()

NOT_WIDE = Failure(
    "the contact is not wide enough to be solved by its gaps, or the operator has no inverse"
)


def gaps_are_better(
    context: SolveContext, problem: Problem, width: float, options: GapOptions | None = None
) -> bool:
    """Whether contact of about this scaled width is better solved for its gaps.

    The answer is kept in the plan.
    """
    options, period = options or OPTIONS, problem.period
    if period is None:
        context.plan.decide("unknowns", "zones", "a lone body has no full contact")
        return False
    if not (
        context.full.approached and context.operator.has_inverse and context.scene.law.routes.gaps
    ):
        context.plan.decide("unknowns", "zones", "full contact, or its operator, is not known")
        return False
    closes = context.full.possible or context.single
    threshold = options.wide_contact if closes else options.wide_contact_with_kinks
    is_wide = width > threshold * period
    context.plan.decide(
        "unknowns",
        "gaps" if is_wide else "zones",
        "contact is {} of the period",
        min(width / period, 1.0),
        threshold,
    )
    return is_wide


def by_gaps(
    context: SolveContext,
    problem: Problem,
    control: Control,
    width: float,
    zones: Array | None = None,
    **newton: bool,
) -> SolvedGaps | Failure:
    """The contact solved for its gaps, if its scaled width is about `width` and that is wide.

    zones: about where contact is, if that is known. newton: `abandon_if_far` and `allow_loss` of
    `NewtonSettings`.
    """
    if control.half_width is not None or not gaps_are_better(context, problem, width):
        return NOT_WIDE
    form = GapForm(problem, context.cache.relief(problem))
    width = width if control.width is None else control.width
    with context.plan.timed("zone ends"):
        found = _from_guesses(context, form, control, width, zones, **newton)
        if isinstance(found, Failure):
            return found
        found = tightened_gaps(context, found)
    if not math.isfinite(found.error):
        return Failure("the gaps leave no pressure that could be told", found.free)
    return found


def _from_guesses(
    context: SolveContext,
    form: GapForm,
    control: Control,
    width: float,
    zones: Array | None,
    **newton: bool,
) -> SolvedGaps | Failure:
    """Gaps from those between the known zones; else from where full contact would pull."""
    tolerance = OPTIONS.tolerance_factor * context.tolerance
    period, guesses = form.problem.repeat_length, context.cache.gap_guesses(form.problem)
    try:
        mean = guesses.mean_of(width) if control.load is None else control.load / period
        if zones is not None and len(zones) > 0:
            table = united(gaps_between(zones, period), period, True, form.what)
            found = refine_topology(form, control, table, NewtonSettings(tolerance, mean, **newton))
            # A grid does not see all gaps; the zones of a solution leave none out.
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
    """The same gaps solved more precisely, if the stated error exceeds the wanted one.

    retry: also where rounding kept the ends from the tolerance before.
    """

    def again(here: SolvedGaps, tolerance: float) -> SolvedGaps | Failure:
        mean = here.fields.mean
        newton = NewtonSettings(tolerance, mean, abandon_if_far=True, initial_error=here.error)
        return gaps_from_fields(here.fields.problem, here.fields, here.control, newton)

    def is_limited_by_rounding(here: SolvedGaps, tolerance: float) -> bool:
        return here.free.trace[-1].move > tolerance and not retry

    tolerance = OPTIONS.tolerance_factor * context.tolerance
    return tightened(context, found, tolerance, again, is_limited_by_rounding)
