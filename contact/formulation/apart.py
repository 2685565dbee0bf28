"""Surfaces that do not touch: no pressure, no displacement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

import sie
from contact.formulation.fields import mean_shape
from contact.formulation.problem import Problem

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ApartFields(sie.Kept):
    """approach [m], not above zero; None where no approach is held: then they may be anywhere, and their gap is infinite."""

    problem: Problem
    approach: float | None

    def pressure(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def displacement(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def gap(self, x: ArrayLike) -> Array:
        if self.approach is None:
            return np.full(np.shape(x), np.inf)
        return np.asarray(self.problem.profile.height(np.asarray(x, dtype=float)) - self.problem.lowest - self.approach)

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        raise IndexError("surfaces apart have no zones: use pressure(x)")

    @property
    def cohesive(self) -> Array:
        return np.zeros((0, 2))

    @property
    def starts(self) -> Array:
        return np.zeros(0)

    @property
    def loads(self) -> Array:
        return np.zeros(0)

    @property
    def load(self) -> float:
        return 0.0

    @property
    def max_pressure(self) -> float:
        return 0.0

    @property
    def contact_fraction(self) -> float:
        return 0.0

    @property
    def stiffness(self) -> float:
        return 0.0

    @property
    def widening_rate(self) -> float:
        return 0.0

    @property
    def mean_gap(self) -> float:
        if self.approach is None:
            return np.inf
        return mean_shape(self.problem) * self.problem.units.height - self.approach
