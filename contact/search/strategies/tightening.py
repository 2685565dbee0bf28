"""Solve again with a smaller tolerance, if the stated error exceeds the wanted one."""

from collections.abc import Callable
from typing import TypeVar

from contact.search.context import INNER, SolveContext
from contact.search.options import LEAST, SEARCH
from contact.search.topology.failure import Failure
from contact.verify.certificate import Solved

Kind = TypeVar("Kind", bound=Solved)


def tightened(
    context: SolveContext,
    found: Kind,
    tolerance: float,
    again: Callable[[Kind, float], Kind | Failure],
    is_limited_by_rounding: Callable[[Kind, float], bool],
) -> Kind:
    """The most precise solution: `found`, or the same contact solved to a smaller tolerance.

    again: function that solves the contact again, from a solution and to a tolerance. If a smaller
    tolerance hardly reduces the error, the smallest tolerance is tried as the last one.
    """
    is_useless = False  # whether the last solve left more than half of the error
    for _ in range(SEARCH.max_attempts):
        if found.error <= context.tol or tolerance <= LEAST:
            break
        if is_limited_by_rounding(found, tolerance):
            break
        wanted = INNER * tolerance * context.tol / found.error
        tolerance = LEAST if is_useless else max(LEAST, wanted)
        decisions = dict(context.plan.decisions)
        better = again(found, tolerance)
        if isinstance(better, Failure):
            context.plan.decisions = decisions
            context.record_failure("a smaller inner tolerance", better)
            break
        is_useless = 2 * better.error > found.error
        if better.error < found.error:
            found = better
        else:
            context.plan.decisions = decisions
    return found
