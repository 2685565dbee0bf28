"""The best design that a search finds, and the record of all designs that it evaluates."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from contact.model.scene import Scene
from contact.solution.solution import Solution
from sie import Array


class Step(NamedTuple):
    """One evaluation of a design: its data by name, the objective, and the conditions' numbers."""

    data: dict[str, Any]
    objective: float
    conditions: Array


class Condition(NamedTuple):
    """A number of the contact and its bounds, which hold at every value of the control."""

    number: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Design:
    """The best evaluated design that satisfies all conditions; `contact.optimize` makes it.

    Parameters
    ----------
    scene : Scene
        The scene with the best data.
    data : dict
        The best data by name.
    solutions : tuple of Solution
        The contact at each value of the control.
    objective : float
        Value of the objective for the best data.
    optimality : float
        Norm of the part of the gradient that no active bound or condition balances, divided by the
        norm of the gradient at the start. It is 0 at an optimum.
    history : tuple of Step
        Every evaluation in order: `data`, `objective` and `conditions`.
    covariance : ndarray or None
        For measured values: covariance of the entries of the data, in the order of `data`, if the
        model holds and the deviations are right; else None.
    message : str
        Why the search stopped.

    Examples
    --------
    >>> import contact
    >>> wave = contact.Scene(
    ...     contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), mean_pressure=1e7
    ... )
    >>> best = contact.optimize(wave, "max_pressure", over={"profile.amplitude": (5e-7, 2e-6)})
    >>> round(best.data["profile.amplitude"], 12), len(best.solutions)
    (5e-07, 1)
    """

    scene: Scene
    data: dict[str, Any]
    solutions: tuple[Solution, ...] = field(repr=False)
    objective: float
    optimality: float
    history: tuple[Step, ...] = field(repr=False)
    covariance: Array | None = field(default=None, repr=False)
    message: str = ""

    @property
    def solution(self) -> Solution:
        """The contact at the first value of the control."""
        return self.solutions[0]
