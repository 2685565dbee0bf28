"""Nearly full contact: found by its gaps, where the operator has an inverse and the contact is wide."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.formulation.relief import ScaledRelief
from contact.search.gap_topology import find_gaps, settle_gaps
from contact.search.missed import Missed
from contact.search.task import LEAST, Task
from contact.verify.gap_accuracy import Gapped

Array = NDArray[np.float64]

# Contact of more than this part of the period is solved by its gaps.
_NEARLY_FULL = 0.7
# The same for several asperities whose valleys have kinks: gaps over them, however narrow, are unknowns like any others.
_WITH_KINKS = 0.25
# An end of a gap moves all of the pressure beside it: gaps are found to this part of what zones are.
OF_GAPS = 0.01
# A smaller inner tolerance that leaves more of the error than this does no good: what is left is rounding.
USELESS = 0.5

NOT_WIDE = Missed("the contact is not wide enough to be solved by its gaps, or the operator has no inverse")


def worth_gaps(task: Task, problem: Problem, width: float) -> bool:
    """Whether contact of about this scaled width is better solved by its gaps."""
    if not (task.full.approached and task.operator.has_inverse and task.scene.law.by_gaps) or problem.period is None:
        return False
    return width > (_NEARLY_FULL if task.full.possible or task.single else _WITH_KINKS) * problem.period


def by_gaps(
    task: Task, problem: Problem, control: Control, width: float, zones: Array | None = None, near: bool = False
) -> Gapped | Missed:
    """The contact solved by its gaps, where it is about as wide as that."""
    if control.half_width is not None or not worth_gaps(task, problem, width):
        return NOT_WIDE
    relief = ScaledRelief.of(task.full.relief, problem)
    with task.plan.timed("zone ends"):
        found = find_gaps(problem, control, relief, OF_GAPS * task.tolerance, width, zones, near)
        if isinstance(found, Missed):
            return found
        found = tightened_gaps(task, found, control)
    return found if math.isfinite(found.error) else Missed("the gaps leave no pressure that could be told", found.free)


def gaps_beside(task: Task, near: Gapped, control: Control, tolerance: float) -> Gapped | Missed:
    """From the gaps of a solution near by."""
    fields = near.fields
    return settle_gaps(fields.problem, control, fields.relief, fields.density.zones.table, fields.mean, tolerance, near=True)


def tightened_gaps(task: Task, found: Gapped, control: Control, stuck: bool = False) -> Gapped:
    """Solved again from the same gaps with a smaller inner tolerance, where the error came out above the wanted one. stuck: even
    where rounding has kept the ends from the tolerance before."""
    tolerance, useless = OF_GAPS * task.tolerance, False
    for _ in range(3):
        if found.error <= task.tol or tolerance <= LEAST or (found.free.trace[-1].move > tolerance and not stuck):
            break
        tolerance = LEAST if useless else max(LEAST, 0.05 * tolerance * task.tol / found.error)
        better = gaps_beside(task, found, control, tolerance)
        if isinstance(better, Missed):
            break
        before = found.error
        found = better if better.error < before else found
        useless = better.error > USELESS * before
    return found
