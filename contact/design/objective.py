"""Objectives: functions of one number of the contact, at one or several values of the control."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.derivatives.response import NUMBERS, STRESSES
from contact.errors import SceneError
from contact.inside.largest import Criterion
from contact.inside.stress import LATERAL
from contact.inside.yielding import CRITERIA
from contact.model.checks import finite_array, one_of, poisson_ratio, positive
from sie import Array

# The number that is the largest of several values, which are the local maxima of the pressure.
PEAK = "max_pressure"

Judged = Callable[[Sequence[Array]], tuple[float, Sequence[ArrayLike]]]


@dataclass(frozen=True)
class Objective:
    """An objective for a design: a function of one result of the contact, to be minimized.

    Parameters
    ----------
    number : str
        A number that has derivatives, see `contact.Response.of`.
    of : callable
        Takes a list with the number at each value of the control (an array, if the number is a
        table with an entry for each zone). Returns the value of the objective, and the list of its
        derivatives by the numbers.
    name : str
        The name that the user gave in place of an objective; else empty.

    Raises
    ------
    SceneError
        If the number is not known, or `of` is no function.

    Examples
    --------
    The sum of squares of the differences between the loads of zones and their mean.

    >>> import contact
    >>> def spread(loads):
    ...     away = loads[0] - loads[0].mean()
    ...     return away @ away, [2 * away]
    >>> contact.Objective("zone_loads", spread).number
    'zone_loads'
    """

    number: str
    of: Judged
    name: str = ""

    def __post_init__(self) -> None:
        one_of("objective.number", self.number, NUMBERS)
        if not callable(self.of):
            raise SceneError.of("objective.of", self.of, "a function of a list of numbers")


@dataclass(frozen=True, eq=False)
class Measured:
    """An objective that fits a result of the contact to measured values.
    It is the sum of the squares of the differences.

    Parameters
    ----------
    number : str
        A number of the contact that has derivatives, and is no array.
    values : array_like
        Its measured value at each value of the control.
    deviation : array_like
        Standard deviation of each measured value; differences are divided by it.

    Raises
    ------
    SceneError
        If the number is not known or is an array, or values and deviations are not finite.

    Examples
    --------
    >>> import contact
    >>> contact.Measured("load", [1e3, 4e3], deviation=10.0).deviation.tolist()
    [10.0, 10.0]
    """

    number: str
    values: Array
    deviation: Array

    def __init__(self, number: str, values: ArrayLike, deviation: ArrayLike = 1.0) -> None:
        one_of("objective.number", number, NUMBERS)
        if number.startswith("zone"):
            raise SceneError.of("objective.number", number, "a result that is no array")
        measured = np.atleast_1d(finite_array("values", values, ndim=None))
        spread = finite_array("deviation", deviation, ndim=None)
        if not (spread > 0.0).all() or spread.shape not in ((), measured.shape):
            allowed = "a number > 0, or a number > 0 for each of the values"
            raise SceneError.of("deviation", deviation, allowed)
        spread = np.broadcast_to(spread, measured.shape)
        for name, value in (("number", number), ("values", measured), ("deviation", spread)):
            object.__setattr__(self, name, value)


@dataclass(frozen=True)
class StressObjective:
    """An objective of the stresses in body 1: the largest stress, or the load of first yield.

    Parameters
    ----------
    number : str
        "max_stress", the largest equivalent stress (its mean over the values of the control), or
        "first_yield", the load of first yield, which depends on no control. With a minus sign
        before its name, the number is maximized.
    nu : float
        Poisson's ratio of body 1.
    strength : float or None
        Yield strength [Pa], for "first_yield" only.
    criterion, lateral : str
        The equivalent stress, as for `first_yield`.

    Raises
    ------
    SceneError
        If the number or the criterion is not known, or another number is out of its range.

    Examples
    --------
    >>> import contact
    >>> contact.StressObjective("-first_yield", nu=0.3, strength=1e9).of
    'first_yield'
    """

    number: str
    nu: float
    strength: float | None = None
    criterion: str = CRITERIA[0]
    lateral: str = LATERAL[0]

    def __post_init__(self) -> None:
        one_of("objective.number", self.number, STRESSES + tuple(f"-{one}" for one in STRESSES))
        one_of("criterion", self.criterion, CRITERIA)
        one_of("lateral", self.lateral, LATERAL)
        poisson_ratio("nu", self.nu)
        if self.of == "first_yield":
            positive("strength", self.strength)
        elif self.strength is not None:
            raise SceneError.of("strength", self.strength, f"left out for number = {self.number!r}")

    @property
    def of(self) -> str:
        """The number without its sign."""
        return self.number.removeprefix("-")

    @property
    def sign(self) -> float:
        """-1 if the number is maximized, else 1."""
        return -1.0 if self.number.startswith("-") else 1.0

    @property
    def rule(self) -> Criterion:
        """The criterion of the equivalent stress."""
        return Criterion(self.criterion, self.nu, self.lateral)


def objective_of(given: Any) -> Objective | Measured | StressObjective:
    """The objective as an object.
    The user gives a name, a name with a minus sign (to maximize), or an object.
    """
    if isinstance(given, (Objective, Measured, StressObjective)):
        return given
    if not isinstance(given, str):
        raise SceneError.of("objective", given, "the name of a result, or a contact.Objective")
    sign, number = (-1.0, given[1:]) if given.startswith("-") else (1.0, given)
    if number in STRESSES:
        raise SceneError.of(
            "objective", given, "a contact.StressObjective, which also gives the yield criterion"
        )
    one_of("objective", number, NUMBERS)
    if number.startswith("zone"):
        raise SceneError.of("objective", given, "a result that is no array, or a contact.Objective")

    def mean(values: Sequence[Array]) -> tuple[float, Sequence[ArrayLike]]:
        share = sign / len(values)
        return share * float(np.sum(values)), [share] * len(values)

    return Objective(number, mean, given)
