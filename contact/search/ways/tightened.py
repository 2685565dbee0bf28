"""Solving again with a smaller inner tolerance, where the stated error came out above the wanted
one.
"""

from collections.abc import Callable
from typing import TypeVar

from contact.search.task import LEAST, Task
from contact.search.topology.missed import Missed
from contact.verify.certificate import Solved

Kind = TypeVar("Kind", bound=Solved)

# How often, and how much of the error a smaller tolerance must leave to be of use: what is left is
# rounding.
_TIMES = 3
_USELESS = 0.5


def tightened(
    task: Task,
    found: Kind,
    tolerance: float,
    again: Callable[[Kind, float], Kind | Missed],
    at_rest: Callable[[Kind, float], bool],
) -> Kind:
    """The best of what was found. again: from what was found, to a tolerance; at_rest: whether
    there is nothing to be gained. Where a smaller tolerance leaves the error, the least one is the
    last that is tried.
    """
    useless = False
    for _ in range(_TIMES):
        if found.error <= task.tol or tolerance <= LEAST or at_rest(found, tolerance):
            break
        tolerance = LEAST if useless else max(LEAST, 0.05 * tolerance * task.tol / found.error)
        better = again(found, tolerance)
        if isinstance(better, Missed):
            task.left("a smaller inner tolerance", better)
            break
        useless = better.error > _USELESS * found.error
        found = better if better.error < found.error else found
    return found
