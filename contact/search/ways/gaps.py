"""Nearly full contact: found by its gaps, where the operator has an inverse and the contact is
wide.
"""

import math

from contact.formulation.controls import Control
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.tables import gaps_between
from contact.search.task import Task
from contact.search.topology.by_gaps import ByGaps
from contact.search.topology.intervals import united
from contact.search.topology.loop import Newton, refine_topology
from contact.search.topology.missed import Missed, WrongTopology
from contact.search.ways.tightened import tightened
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

NOT_WIDE = Missed(
    "the contact is not wide enough to be solved by its gaps, or the operator has no inverse"
)


def worth_gaps(task: Task, problem: Problem, width: float) -> bool:
    """Whether contact of about this scaled width is better solved by its gaps."""
    if (
        not (task.full.approached and task.operator.has_inverse and task.scene.law.by_gaps)
        or problem.period is None
    ):
        return False
    return (
        width
        > (_NEARLY_FULL if task.full.possible or task.single else _WITH_KINKS) * problem.period
    )


def by_gaps(
    task: Task,
    problem: Problem,
    control: Control,
    width: float,
    zones: Array | None = None,
    near: bool = False,
    drops: bool = False,
) -> SolvedGaps | Missed:
    """The contact solved by its gaps, where it is about as wide as that; drops: see `Newton`."""
    if control.half_width is not None or not worth_gaps(task, problem, width):
        return NOT_WIDE
    form = ByGaps(problem, task.shared.relief(problem))
    with task.plan.timed("zone ends"):
        found = _found(task, form, control, width, zones, near, drops)
        if isinstance(found, Missed):
            return found
        found = tightened_gaps(task, found)
    return (
        found
        if math.isfinite(found.error)
        else Missed("the gaps leave no pressure that could be told", found.free)
    )


def _found(
    task: Task,
    form: ByGaps,
    control: Control,
    width: float,
    zones: Array | None,
    near: bool,
    drops: bool,
) -> SolvedGaps | Missed:
    """First guesses, Newton, signs. width: about that of all contact, zones: about where it is;
    near: these are those of a solution, and given up as soon as they turn out to be far.
    """
    tolerance, period = OF_GAPS * task.tolerance, form.problem.repeat_length
    try:
        width = width if control.width is None else control.width
        mean = (
            control.load / period
            if control.load is not None
            else task.shared.first_gaps(form.problem).mean_of(width)
        )
        if zones is not None and len(zones) > 0:
            # Where zones are known about, so are the gaps; but not those that a grid does not see.
            newton = Newton(tolerance, mean, near=near, drops=drops)
            found = refine_topology(
                form, control, united(gaps_between(zones, period), period, True, form.what), newton
            )
            if near or isinstance(found, SolvedGaps):
                return found
        first = task.shared.first_gaps(form.problem)
        return refine_topology(form, control, first.gaps(mean), Newton(tolerance, mean))
    except WrongTopology as wrong:
        return wrong.missed


def gaps_beside(
    problem: Problem,
    near: GapFields,
    control: Control,
    tolerance: float,
    closely: bool,
    off: float = 1.0,
) -> SolvedGaps | Missed:
    """From the gaps of fields near by. closely: given up as soon as these turn out to be far off.
    off: see `Newton`.
    """
    form = ByGaps(problem, near.relief)
    return refine_topology(
        form, control, near.density.zones.table, Newton(tolerance, near.mean, near=closely, off=off)
    )


def tightened_gaps(task: Task, found: SolvedGaps, stuck: bool = False) -> SolvedGaps:
    """Solved again from the same gaps, where the error came out above the wanted one. stuck: even
    where rounding has kept the ends from the tolerance before.
    """

    def again(here: SolvedGaps, tolerance: float) -> SolvedGaps | Missed:
        return gaps_beside(
            here.fields.problem, here.fields, here.control, tolerance, closely=True, off=here.error
        )

    def at_rest(here: SolvedGaps, tolerance: float) -> bool:
        return here.free.trace[-1].move > tolerance and not stuck

    return tightened(task, found, OF_GAPS * task.tolerance, again, at_rest)
