"""Solve again with a smaller tolerance, if the stated error exceeds the wanted one."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from contact.search.context import LEAST, SolveContext
from contact.search.topology.failure import Failure
from contact.verify.certificate import Solved

Kind = TypeVar("Kind", bound=Solved)


@dataclass(frozen=True)
class TighteningOptions:
    """How often a contact is solved again, and by how much the tolerance decreases."""

    max_solves: int = 3  # the error falls with the tolerance, so one or two suffice
    safety: float = 0.05  # factor on the tolerance that would just suffice


def tightened(
    context: SolveContext,
    found: Kind,
    tolerance: float,
    again: Callable[[Kind, float], Kind | Failure],
    is_limited_by_rounding: Callable[[Kind, float], bool],
    options: TighteningOptions = TighteningOptions(),
) -> Kind:
    """The most precise of a solution and of further solutions of the same contact.

    again: solves from a solution to a tolerance. If a smaller tolerance hardly reduces the error,
    the smallest tolerance is tried as the last one.
    """
    is_useless = False  # whether the last solve left more than half of the error
    for _ in range(options.max_solves):
        if found.error <= context.tol or tolerance <= LEAST:
            break
        if is_limited_by_rounding(found, tolerance):
            break
        wanted = options.safety * tolerance * context.tol / found.error
        tolerance = LEAST if is_useless else max(LEAST, wanted)
        better = again(found, tolerance)
        if isinstance(better, Failure):
            context.record_failure("a smaller inner tolerance", better)
            break
        is_useless = 2 * better.error > found.error
        found = better if better.error < found.error else found
    return found
