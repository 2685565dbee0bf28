"""`Numbers`: results of a contact (such as its load), or the derivatives of results, or errors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields as fields_of
from typing import Any

import numpy as np

from contact.solution.solution import Solution
from sie import Array, record

Value = float | Array


@record
class Numbers:
    """Results of a contact, in SI units; nan for results that are not defined or not known.

    approach, max_pressure and max_stress are arrays: with an entry for each lowest place of the
    profile, each place of the largest pressure, and each place of the largest stress. Where the
    entries of a derivative differ, the derivative is one-sided.
    """

    load: float
    approach: Array
    mean_gap: float
    contact_fraction: float
    max_pressure: Array
    stiffness: float
    zones: Array
    zone_loads: Array
    max_stress: Array

    @classmethod
    def of_degrees(cls, numbers: Numbers, degrees: Mapping[str, float]) -> Numbers:
        """Each result times its degree in `degrees`; results that are not named there become 0."""
        names = [one.name for one in fields_of(cls)]
        return cls(**{n: getattr(numbers, n) * degrees.get(n, 0.0) for n in names})

    def __add__(self, other: Numbers) -> Numbers:
        return self._with(other, lambda a, b: a + b)

    def __mul__(self, factor: float) -> Numbers:
        return self._with(self, lambda a, _: factor * a)

    def __sub__(self, other: Numbers) -> Numbers:
        return self + other * -1.0

    def __abs__(self) -> Numbers:
        return self._with(self, lambda a, _: np.abs(a))

    def _with(self, other: Numbers, of: Callable[[Any, Any], Any]) -> Numbers:
        names = [one.name for one in fields_of(self)]
        return Numbers(**{n: of(getattr(self, n), getattr(other, n)) for n in names})

    def largest(self, name: str) -> Value:
        """The result of this name.
        Of results at several places, such as `approach`, it is the largest.
        """
        value = getattr(self, name)
        if name in ("approach", "max_pressure", "max_stress"):
            return float(np.max(value)) if np.size(value) else np.nan
        return np.asarray(value) if np.ndim(value) else float(value)


def values(solution: Solution, peaks: int, tips: int, max_stress: Array) -> Numbers:
    """The results of a solution as `Numbers`.
    `peaks` and `tips` are the numbers of places with the largest pressure and the lowest height.
    """
    missing = np.nan
    fraction, gap = solution.contact_fraction, solution.mean_gap
    approach, stiffness = solution.approach, solution.stiffness
    return Numbers(
        solution.load,
        np.full(tips, missing if approach is None else approach),
        missing if gap is None else gap,
        missing if fraction is None else fraction,
        np.full(peaks, solution.max_pressure),
        missing if stiffness is None else stiffness,
        solution.zones,
        solution.zone_loads,
        max_stress,
    )
