"""Objective and conditions of a design as functions of the vector of its data."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from contact.derivatives.result import Sensitivity
from contact.design.objective import PEAK, Measured, Objective, StressObjective
from contact.design.places import Places
from contact.design.result import Condition, Step
from contact.design.variables import Variables
from contact.errors import NotConverged, SceneError, unwarned
from contact.formulation.tolerances import TOLERANCES
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.solver import solve
from sie import Array

AnyObjective = Objective | Measured | StressObjective


class Contacts(NamedTuple):
    """The contacts of one design, one for each value of the control, and their derivatives."""

    solutions: tuple[Solution, ...]
    by: tuple[Sensitivity, ...]
    tops: tuple[Places, ...]  # local maxima of the pressure, if they are needed
    stresses: tuple[Places, ...]  # local maxima of the equivalent stress, if they are needed

    @property
    def at_first_yield(self) -> bool:
        """Whether the stresses were computed under the load of first yield."""
        return bool(self.stresses) and self.stresses[0].first is not None


class Problem:
    """Objective and conditions as functions of the vector of data; it records all evaluations."""

    def __init__(
        self,
        variables: Variables,
        objective: AnyObjective,
        conditions: tuple[Condition, ...],
        at: tuple[float, ...],
        tol: float,
    ) -> None:
        self.variables, self.objective, self.conditions = variables, objective, conditions
        self.at, self.tol = at, tol
        self.of_pressure = isinstance(objective, Objective) and objective.name == PEAK
        self._bounds = [
            (one.number, bound, sign)
            for one in conditions
            for bound, sign in ((one.low, 1.0), (one.high, -1.0))
            if np.isfinite(bound)
        ]
        self.needs_tops = self.of_pressure or any(
            number == PEAK and sign < 0 for number, _, sign in self._bounds
        )
        self.history: list[Step] = []
        self._vectors: list[Array] = []
        self._yields_at: float | None = None  # value of the control at the last first yield
        self._known: dict[bytes, Contacts] = {}
        self._gradients: dict[tuple[bytes, str], list[Array]] = {}

    @property
    def minimizes_levels(self) -> bool:
        """Whether the search minimizes levels t, one for each contact, instead of the objective.
        A level is at least as large as each value of `competing` for its contact.
        """
        wanted = self.objective
        if isinstance(wanted, StressObjective):
            return wanted.number in ("max_stress", "-first_yield")
        return self.of_pressure

    def contact(self, vector: Array) -> Contacts:
        """The contacts of a design, one for each value of the control; each is solved once."""
        key = np.asarray(vector, dtype=float).tobytes()
        if key not in self._known:
            scene = self.variables.scene_of(vector)
            name = scene.control[0]
            with unwarned():
                found = tuple(self._solved(scene.under(name, value)) for value in self.at)
            by = tuple(Sensitivity(one, stated=False) for one in found)
            most, wanted = len(vector) + 1, self.objective
            tops: tuple[Places, ...] = ()
            stresses: tuple[Places, ...] = ()
            if self.needs_tops:
                tops = tuple(Places.of_pressure(one, most) for one in found)
            if isinstance(wanted, StressObjective):
                some = found
                if wanted.strength is not None:
                    # First yield does not depend on the control. The search for first yield begins
                    # at the value of the control at which the last design yields first.
                    some = found[:1]
                    if self._yields_at is not None:
                        some = (self._solved(scene.under(name, self._yields_at)),)
                stresses = tuple(Places.of_stress(one, wanted, most, self.tol) for one in some)
                if wanted.strength is not None:
                    self._yields_at = stresses[0].by.solution.scene.control[1]
            self._known[key] = Contacts(found, by, tops, stresses)
            self._vectors.append(np.array(vector, dtype=float))
            self.history.append(
                Step(self.variables.values(vector), self.value(vector), self.numbers(vector))
            )
        return self._known[key]

    def best(self, last: Array) -> Array:
        """The vector of the best evaluated design that satisfies the conditions to the tolerance.

        It is `last` if no other design is better than `last` by more than the tolerance. If no
        design satisfies the conditions, the vector with the smallest violation is returned.
        """
        self.contact(last)
        values = np.array([step.objective for step in self.history])
        violations = np.array([self.violation(one) for one in self._vectors])
        allowed = violations <= TOLERANCES.margin * self.tol
        if not allowed.any():
            return self._vectors[int(np.argmin(violations))]
        least = int(np.argmin(np.where(allowed, values, np.inf)))
        worse = self.value(last) - values[least] > self.tol * abs(values[least])
        if worse or self.violation(last) > TOLERANCES.margin * self.tol:
            return self._vectors[least]
        return last

    def violation(self, vector: Array) -> float:
        """Largest violation of a condition, divided by the size of its bound; 0 if all hold."""
        return max(0.0, -float(self.rooms(vector).min(initial=0.0)))

    def _solved(self, scene: Scene) -> Solution:
        """Contact of a scene; if the tolerance is missed, one with half of the wanted digits."""
        try:
            return solve(scene, self.tol)
        except NotConverged as failure:
            best = failure.best
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
                raise SceneError(
                    f"{number} is infinite for a design, or the scene does not define it", number
                )
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
        if isinstance(self.objective, StressObjective):
            largest = [one.largest for one in self.contact(vector).stresses]
            return self.objective.sign * float(np.mean(largest))
        return float(self.objective.of(self.table(vector, self.objective.number))[0])

    def gradient(self, vector: Array) -> Array:
        """Derivatives of the objective by the n entries of the vector of data (n,)."""
        if isinstance(self.objective, Measured):
            return 2 * self.residuals(vector) @ self.residual_slopes(vector)
        if isinstance(self.objective, StressObjective):
            return self.objective.sign * self._of_stress(vector)
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

    def _of_stress(self, vector: Array) -> Array:
        """Derivatives (n,) of the mean of the largest stress, or of the load of first yield."""
        found = self.contact(vector)
        values, slopes = self.competing(vector), self.competing_slopes(vector)
        first = np.argmax(values, axis=1)
        mean = slopes[np.arange(len(first)), first].mean(axis=0)
        # The values at first yield are inverse loads.
        return np.asarray(-mean * found.stresses[0].largest ** 2 if found.at_first_yield else mean)

    def competing(self, vector: Array) -> Array:
        """Values at the places that compete for the objective: a row of n + 1 for each contact.

        The places are local maxima of the pressure or of the stress (`Places`). A row holds only
        the n + 1 largest values: in a design of n data, more than n + 1 values are not equal in
        general. Missing values are 0.
        """
        found = self.contact(vector)
        return self._values(vector, found.tops if self.of_pressure else found.stresses)

    def competing_slopes(self, vector: Array) -> Array:
        """Derivatives of `competing` by the n entries of the vector of data.
        The shape is (contacts, n + 1, n).
        """
        found = self.contact(vector)
        if self.of_pressure:
            return self._slopes(vector, "tops", found.tops)
        return self._slopes(vector, "stresses", found.stresses)

    def tops(self, vector: Array) -> Array:
        """The highest local maxima of the pressure: a row of n + 1 for each value of the control.
        Missing values are 0.
        """
        return self._values(vector, self.contact(vector).tops)

    def top_slopes(self, vector: Array) -> Array:
        """Derivatives of `tops` by the n entries of the vector of data.
        The shape is (values of the control, n + 1, n).
        """
        return self._slopes(vector, "tops", self.contact(vector).tops)

    def _values(self, vector: Array, rows: tuple[Places, ...]) -> Array:
        out = np.zeros((len(rows), len(vector) + 1))
        for row, one in zip(out, rows, strict=True):
            row[: len(one.values)] = one.values
        return out

    def _slopes(self, vector: Array, name: str, rows: tuple[Places, ...]) -> Array:
        key = np.asarray(vector, dtype=float).tobytes(), name
        if key not in self._gradients:
            table = []
            for one in rows:
                slopes = np.zeros((len(vector) + 1, len(vector)))
                slopes[: len(one.values)] = one.slopes(self.variables)
                table.append(slopes)
            self._gradients[key] = table
        return np.array(self._gradients[key])

    def rooms(self, vector: Array) -> Array:
        """Distances of the conditions' numbers from their bounds, divided by the bounds' size.
        A design that meets all conditions has no distance below 0.
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
