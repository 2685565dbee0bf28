"""Nearly full contact: found by its gaps, where the operator has an inverse and the contact is
wide.
"""

import math

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

# Contact of more than this part of the period is solved by its gaps.
_NEARLY_FULL = 0.7
# The same for several asperities whose valleys have kinks: gaps over them, however narrow, are
# unknowns like any others.
_WITH_KINKS = 0.25
# An end of a gap moves all of the pressure beside it: gaps are found to this part of what zones
# are.
OF_GAPS = 0.01

NOT_WIDE = Failure(
    "the contact is not wide enough to be solved by its gaps, or the operator has no inverse"
)


def worth_gaps(context: SolveContext, problem: Problem, width: float) -> bool:
    """Whether contact of about this scaled width is better solved by its gaps."""
    if (
        not (
            context.full.approached
            and context.operator.has_inverse
            and context.scene.law.routes.gaps
        )
        or problem.period is None
    ):
        return False
    return (
        width
        > (_NEARLY_FULL if context.full.possible or context.single else _WITH_KINKS)
        * problem.period
    )


def by_gaps(
    context: SolveContext,
    problem: Problem,
    control: Control,
    width: float,
    zones: Array | None = None,
    abandon_if_far: bool = False,
    allow_loss: bool = False,
) -> SolvedGaps | Failure:
    """The contact solved by its gaps, where it is about as wide as that; allow_loss: see `NewtonSettings`."""
    if control.half_width is not None or not worth_gaps(context, problem, width):
        return NOT_WIDE
    form = GapForm(problem, context.cache.relief(problem))
    with context.plan.timed("zone ends"):
        found = _found(context, form, control, width, zones, abandon_if_far, allow_loss)
        if isinstance(found, Failure):
            return found
        found = tightened_gaps(context, found)
    return (
        found
        if math.isfinite(found.error)
        else Failure("the gaps leave no pressure that could be told", found.free)
    )


def _found(
    context: SolveContext,
    form: GapForm,
    control: Control,
    width: float,
    zones: Array | None,
    abandon_if_far: bool,
    allow_loss: bool,
) -> SolvedGaps | Failure:
    """First guesses, Newton, signs. width: about that of all contact, zones: about where it is;
    abandon_if_far: these are those of a solution, and given up as soon as they turn out to be far.
    """
    tolerance, period = OF_GAPS * context.tolerance, form.problem.repeat_length
    try:
        width = width if control.width is None else control.width
        mean = (
            control.load / period
            if control.load is not None
            else context.cache.first_gaps(form.problem).mean_of(width)
        )
        if zones is not None and len(zones) > 0:
            # Where zones are known about, so are the gaps; but not those that a grid does not see.
            newton = NewtonSettings(
                tolerance, mean, abandon_if_far=abandon_if_far, allow_loss=allow_loss
            )
            found = refine_topology(
                form, control, united(gaps_between(zones, period), period, True, form.what), newton
            )
            if abandon_if_far or isinstance(found, SolvedGaps):
                return found
        first = context.cache.first_gaps(form.problem)
        return refine_topology(form, control, first.gaps(mean), NewtonSettings(tolerance, mean))
    except WrongTopology as wrong:
        return wrong.failure


def gaps_beside(
    problem: Problem,
    near: GapFields,
    control: Control,
    tolerance: float,
    abandon_if_far: bool,
    initial_error: float = 1.0,
) -> SolvedGaps | Failure:
    """From the gaps of fields near by. abandon_if_far: given up as soon as these turn out to be far off.
    initial_error: see `NewtonSettings`.
    """
    form = GapForm(problem, near.relief)
    return refine_topology(
        form,
        control,
        near.gap_slope.zones.table,
        NewtonSettings(
            tolerance, near.mean, abandon_if_far=abandon_if_far, initial_error=initial_error
        ),
    )


def tightened_gaps(context: SolveContext, found: SolvedGaps, stuck: bool = False) -> SolvedGaps:
    """Solved again from the same gaps, where the error came out above the wanted one. stuck: even
    where rounding has kept the ends from the tolerance before.
    """

    def again(here: SolvedGaps, tolerance: float) -> SolvedGaps | Failure:
        return gaps_beside(
            here.fields.problem,
            here.fields,
            here.control,
            tolerance,
            abandon_if_far=True,
            initial_error=here.error,
        )

    def at_rest(here: SolvedGaps, tolerance: float) -> bool:
        return here.free.trace[-1].move > tolerance and not stuck

    return tightened(context, found, OF_GAPS * context.tolerance, again, at_rest)
