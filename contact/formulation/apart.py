"""Surfaces that do not touch: no pressure, no displacement."""

import numpy as np
from numpy.typing import ArrayLike

from contact.formulation.fields import NoZones, mean_shape
from contact.formulation.problem import Problem
from sie import Array, record


@record
class ApartFields(NoZones):
    """approach [m], not above zero; None where no approach is held: then they may be anywhere, and their gap is infinite."""

    problem: Problem
    approach: float | None
    load = max_pressure = contact_fraction = stiffness = 0.0

    def pressure(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def displacement(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def gap(self, x: ArrayLike) -> Array:
        if self.approach is None:
            return np.full(np.shape(x), np.inf)
        return np.asarray(self.problem.profile.height(np.asarray(x, dtype=float)) - self.problem.lowest - self.approach)

    @property
    def mean_gap(self) -> float:
        if self.approach is None:
            return np.inf
        return mean_shape(self.problem) * self.problem.units.height - self.approach
