"""Places of one contact that compete for a largest number, and derivatives of their values.

The number is the pressure at the local maxima of the pressure, or the equivalent stress at the
local maxima of this stress, or the inverse of the load under which such a maximum of the stress
yields. Let s be the stress at one maximum under the load P of first yield, s_P the derivative of s
by the load, and Y the strength. To first order, this place yields under the load P + (Y - s) / s_P.
At the place that yields first, this load and its derivatives are exact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.derivatives.places import tops
from contact.derivatives.result import Sensitivity
from contact.derivatives.stresses import LargestStress
from contact.design.objective import PEAK, StressObjective
from contact.design.variables import Variables
from contact.errors import SceneError
from contact.inside.yielding import Yield
from contact.solution.solution import Solution
from sie import Array


@dataclass(frozen=True)
class Places:
    """The places of one contact that compete for a largest number.

    by: derivatives of the contact. number: "max_pressure" or "max_stress". most: how many places
    count at most. first: first yield, if the values are inverse loads.
    """

    by: Sensitivity
    number: str
    most: int
    first: Yield | None = None

    @classmethod
    def of_pressure(cls, solution: Solution, most: int) -> Places:
        """The local maxima of the pressure."""
        return cls(Sensitivity(solution, stated=False, tops=tops(solution, most)), PEAK, most)

    @classmethod
    def of_stress(
        cls, solution: Solution, wanted: StressObjective, most: int, tol: float
    ) -> Places:
        """The local maxima of the stress; under the load of first yield if this is sought."""
        found, yield_error = None, 0.0
        if wanted.strength is not None:
            found = solution.first_yield(
                wanted.strength, wanted.nu, wanted.criterion, wanted.lateral, tol
            )
            if found.solution is None or found.note:
                raise SceneError(
                    f"the load of first yield has no derivatives, since there is {found.note}",
                    "objective",
                )
            solution, yield_error = found.solution, found.error
        stress = LargestStress(solution, wanted.rule, yield_error, local=True)
        return cls(Sensitivity(solution, stated=False, stress=stress), "max_stress", most, found)

    @property
    def largest(self) -> float:
        """The largest pressure or stress, or the load of first yield."""
        return float(self._numbers.max()) if self.first is None else self.first.load

    @property
    def values(self) -> Array:
        """Values (k,) at the places: a pressure, a stress, or an inverse load."""
        return self._numbers if self.first is None else self._inverse_loads

    def slopes(self, variables: Variables) -> Array:
        """Derivatives (k, n) of `values` by the n entries of the vector of data."""
        table = variables.top_slopes(self.by, self.number).T[: self.most]
        if self.first is None:
            return table
        with np.errstate(divide="ignore", invalid="ignore"):
            loads = variables.gradient(self.by, "load") - table / self._rise[:, None]
        inverse = self._inverse_loads[:, None]
        return np.where(inverse > 0, -loads * inverse**2, 0.0)

    @property
    def _numbers(self) -> Array:
        """The pressure or the stress at the places."""
        return np.asarray(getattr(self.by.linearized.values, self.number))[: self.most]

    @property
    def _rise(self) -> Array:
        """Derivatives of the stresses by the load."""
        return self.by.linearized.by_load.values.max_stress[: self.most]

    @property
    def _inverse_loads(self) -> Array:
        """Inverse loads at which the places yield; 0 if the stress does not grow with the load."""
        assert self.first is not None
        below, rise = self._numbers.max() - self._numbers, self._rise
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(rise > 0, 1 / (self.first.load + below / rise), 0.0)
