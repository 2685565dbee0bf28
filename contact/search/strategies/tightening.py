"""Solving again with a smaller inner tolerance, where the stated error came out above the wanted
one.
"""

from collections.abc import Callable
from typing import TypeVar

from contact.search.context import LEAST, SolveContext
from contact.search.topology.failure import Failure
from contact.verify.certificate import Solved

Kind = TypeVar("Kind", bound=Solved)

# How often, and how much of the error a smaller tolerance must leave to be of use: what is left is
# rounding.
_TIMES = 3
_USELESS = 0.5


def tightened(
    context: SolveContext,
    found: Kind,
    tolerance: float,
    again: Callable[[Kind, float], Kind | Failure],
    at_rest: Callable[[Kind, float], bool],
) -> Kind:
    """The best of what was found. again: from what was found, to a tolerance; at_rest: whether
    there is nothing to be gained. Where a smaller tolerance leaves the error, the least one is the
    last that is tried.
    """
    useless = False
    for _ in range(_TIMES):
        if found.error <= context.tol or tolerance <= LEAST or at_rest(found, tolerance):
            break
        tolerance = LEAST if useless else max(LEAST, 0.05 * tolerance * context.tol / found.error)
        better = again(found, tolerance)
        if isinstance(better, Failure):
            context.record_failure("a smaller inner tolerance", better)
            break
        useless = better.error > _USELESS * found.error
        found = better if better.error < found.error else found
    return found
