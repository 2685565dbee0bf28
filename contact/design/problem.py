"""Objective and conditions of a design as functions of the vector of its data."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from contact.derivatives.places import tops as highest_places
from contact.derivatives.result import Sensitivity
from contact.design.objective import PEAK, Measured, Objective
from contact.design.result import Condition, Step
from contact.design.variables import Variables
from contact.errors import NotConverged, SceneError, unwarned
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.solver import solve
from sie import Array


class Contacts(NamedTuple):
    """The contacts of one design, one for each value of the control, and their derivatives."""

    solutions: tuple[Solution, ...]
    by: tuple[Sensitivity, ...]
    tops: tuple[Sensitivity, ...]


class Problem:
    """Objective and conditions as functions of the vector of data; it records all evaluations."""

    def __init__(
        self,
        variables: Variables,
        objective: Objective | Measured,
        conditions: tuple[Condition, ...],
        at: tuple[float, ...],
        tol: float,
    ) -> None:
        self.variables, self.objective, self.conditions = variables, objective, conditions
        self.at, self.tol = at, tol
        # Whether the least t is sought that no local maximum of the pressure exceeds.
        self.levels = isinstance(objective, Objective) and objective.name == PEAK
        self._bounds = [
            (one.number, bound, sign)
            for one in conditions
            for bound, sign in ((one.low, 1.0), (one.high, -1.0))
            if np.isfinite(bound)
        ]
        self.needs_tops = self.levels or any(
            number == PEAK and sign < 0 for number, _, sign in self._bounds
        )
        self.history: list[Step] = []
        self._known: dict[bytes, Contacts] = {}
        self._gradients: dict[tuple[bytes, str], list[Array]] = {}

    def contact(self, vector: Array) -> Contacts:
        """The contacts of a design, one for each value of the control; each is solved once."""
        key = np.asarray(vector, dtype=float).tobytes()
        if key not in self._known:
            scene = self.variables.scene_of(vector)
            name = scene.control[0]
            with unwarned():
                found = tuple(self._solved(scene.under(name, value)) for value in self.at)
            by = tuple(Sensitivity(one, stated=False) for one in found)
            tops: tuple[Sensitivity, ...] = ()
            if self.needs_tops:
                places = [highest_places(one, len(vector) + 1) for one in found]
                tops = tuple(
                    Sensitivity(one, stated=False, tops=at)
                    for one, at in zip(found, places, strict=True)
                )
            self._known[key] = Contacts(found, by, tops)
            self.history.append(
                Step(self.variables.values(vector), self.value(vector), self.numbers(vector))
            )
        return self._known[key]

    def _solved(self, scene: Scene) -> Solution:
        """Contact of a scene; if the tolerance is missed, one with half of the digits right."""
        try:
            return solve(scene, self.tol)
        except NotConverged as missed:
            best = missed.best
            if isinstance(best, Solution) and best.error <= self.tol**0.5:
                if best.certificate.holds:
                    return best
            raise

    def table(self, vector: Array, number: str) -> list[Array]:
        """Values of a number of the contact, one for each value of the control."""
        out = []
        for one in self.contact(vector).solutions:
            value = getattr(one, number)
            if value is None or not np.all(np.isfinite(value)):
                raise SceneError(f"{number} is infinite, or the scene does not define it", number)
            out.append(np.asarray(value, dtype=float))
        return out

    def derivatives(self, vector: Array, number: str) -> list[Array]:
        """Derivatives of a number by the entries of the vector of data, at each control value."""
        key = np.asarray(vector, dtype=float).tobytes(), number
        if key not in self._gradients:
            self._gradients[key] = [
                self.variables.gradient(one, number) for one in self.contact(vector).by
            ]
        return self._gradients[key]

    def residuals(self, vector: Array) -> Array:
        """Computed minus measured values, divided by their standard deviations (m,)."""
        wanted = self.objective
        assert isinstance(wanted, Measured)
        values = np.array(self.table(vector, wanted.number))
        return np.asarray((values - wanted.values) / wanted.deviation)

    def residual_slopes(self, vector: Array) -> Array:
        """Derivatives (m, n) of the m `residuals` by the n entries of the vector of data."""
        wanted = self.objective
        assert isinstance(wanted, Measured)
        return np.array(self.derivatives(vector, wanted.number)) / wanted.deviation[:, None]

    def value(self, vector: Array) -> float:
        """Value of the objective for a vector of data."""
        if isinstance(self.objective, Measured):
            return float(np.sum(self.residuals(vector) ** 2))
        return float(self.objective.of(self.table(vector, self.objective.number))[0])

    def gradient(self, vector: Array) -> Array:
        """Derivatives of the objective by the n entries of the vector of data (n,)."""
        if isinstance(self.objective, Measured):
            return 2 * self.residuals(vector) @ self.residual_slopes(vector)
        table = self.table(vector, self.objective.number)
        of = self.objective.of(table)[1]
        out = np.zeros(len(vector))
        for slopes, weight in zip(self.derivatives(vector, self.objective.number), of, strict=True):
            part = np.asarray(weight, dtype=float)
            out += slopes.reshape(len(vector), -1) @ np.ravel(part)
        return out

    def numbers(self, vector: Array) -> Array:
        """Numbers that have conditions, at all values of the control, as one array."""
        return np.array([v for one in self.conditions for v in self.table(vector, one.number)])

    def tops(self, vector: Array) -> Array:
        """Local maxima of the pressure (values of the control, k), the highest n + 1 of them.

        More than n + 1 do not determine a design of n data. Missing ones are 0.
        """
        out = np.zeros((len(self.at), len(vector) + 1))
        for row, one in zip(out, self.contact(vector).tops, strict=True):
            row[: len(one.linearized.peaks)] = one.linearized.values.max_pressure
        return out

    def top_slopes(self, vector: Array) -> Array:
        """Derivatives of `tops` by the vector (values of the control, k, n)."""
        key = np.asarray(vector, dtype=float).tobytes(), "tops"
        if key not in self._gradients:
            table = []
            for one in self.contact(vector).tops:
                slopes = np.zeros((len(vector) + 1, len(vector)))
                slopes[: len(one.linearized.peaks)] = self.variables.top_slopes(one).T
                table.append(slopes)
            self._gradients[key] = table
        return np.array(self._gradients[key])

    def rooms(self, vector: Array) -> Array:
        """Distances of all conditions from their bounds, divided by the bounds' size.
        A design that meets all conditions has none below 0.
        """
        rooms = [np.zeros(0)]
        for number, bound, sign in self._bounds:
            below_peaks = number == PEAK and sign < 0
            values = self.tops(vector) if below_peaks else np.array(self.table(vector, number))
            rooms.append(sign * (np.ravel(values) - bound) / (abs(bound) or 1.0))
        return np.concatenate(rooms)

    def room_slopes(self, vector: Array) -> Array:
        """Derivatives (m, n) of the m `rooms` by the n entries of the vector of data."""
        n = len(vector)
        slopes = [np.zeros((0, n))]
        for number, bound, sign in self._bounds:
            below_peaks = number == PEAK and sign < 0
            of = self.top_slopes if below_peaks else partial(self.derivatives, number=number)
            slopes.append(sign * np.reshape(of(vector), (-1, n)) / (abs(bound) or 1.0))
        return np.concatenate(slopes)
