"""Fields of a contact with a constant tension beside it: of q = p + s on the intervals where s pulls, and what they are in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.formulation.cohesive import Cohesive, CohesivePoint
from contact.formulation.controls import Approach, Control, Load
from contact.formulation.equilibria import Point
from contact.formulation.fields import ZoneFields, mean_shape
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.tension import Pulled, Tension

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PulledFields(ZoneFields):
    """problem: `Pulled`; law_problem: the same with the scene's law; rate: d load/d approach, scaled, None under tension everywhere."""

    law_problem: Problem | None = None
    rate: float | None = None

    def __getstate__(self) -> dict[str, Any]:
        return super().__getstate__() | {"law_problem": self.law_problem, "rate": self.rate}

    @property
    def pulled(self) -> Pulled:
        assert isinstance(self.problem, Pulled)
        return self.problem

    @property
    def tension(self) -> Tension:
        return self.pulled.pulling

    @property
    def cohesive(self) -> Array:
        """The intervals in which the gap is below the reach of the tension, contact within them included (m, 2) [m]."""
        units, tension = self.problem.units, self.tension
        if tension.everywhere:
            assert tension.period is not None
            first = float(self.density.zones.middle[0]) - 0.5 * tension.period
            return np.asarray(units.x(np.array([[first, first + tension.period]])))
        return np.asarray(units.x(tension.table))

    def _place(self, kind: type[Control]) -> tuple[Cohesive, CohesivePoint]:
        """The curve that the solution lies on, and its place there."""
        curve = self._curve(kind)
        return curve, curve.from_zones(self.tension.table, self._value(kind), self.density.zones.table)

    def _curve(self, kind: type[Control]) -> Cohesive:
        assert self.law_problem is not None
        return Cohesive(self.law_problem, kind)

    def _value(self, kind: type[Control]) -> float:
        return float(self.density.total - self.tension.total) if kind is Load else -self.level

    def pull_off(self, kind: type[Control]) -> Point:
        if self.tension.everywhere:
            return self._curve(kind).pull_off_from_all(self.density.zones.table, self._value(kind))
        curve, here = self._place(kind)
        return curve.pull_off(here)

    # the shape is the profile's own, and the displacement the tension's, too
    def _shape(self, x: Array) -> Array:
        return self.pulled.own_shape(x)

    def _raised(self, x: Array, potential: Array) -> Array:
        return np.asarray(super()._raised(x, potential) + self.tension.height(x))

    @cached_property
    def stiffness(self) -> float | None:
        if self.tension.everywhere:
            return super().stiffness
        if self.approach is None or self.rate is None:
            return None
        units = self.problem.units
        return units.load / units.height * self.rate

    @property
    def mean_displacement(self) -> float:
        assert self.problem.period is not None
        return self.problem.compression * (self.density.total - self.tension.total) / self.problem.period

    @cached_property
    def mean_gap(self) -> float:
        own = self.law_problem
        assert own is not None
        return (mean_shape(own) + self.mean_displacement + self.level) * self.problem.units.height

    @property
    def load(self) -> float:
        return (self.density.total - self.tension.total) * self.problem.units.load

    @cached_property
    def loads(self) -> Array:
        """Of the zones of contact; the tension beside them is not in it."""
        zones = self.density.zones
        return (self.density.totals - self.tension.stress * (zones.b - zones.a)) * self.problem.units.load

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        return super().pressure_at(zone, t) - self.tension.stress * self.problem.units.pressure

    @cached_property
    def max_pressure(self) -> float:
        return float(super().max_pressure - self.tension.stress * self.problem.units.pressure)

    def pressure(self, x: ArrayLike) -> Array:
        scaled = self._scaled(x)
        q = self.density(scaled)
        return np.asarray(q - self.tension.stress * self.tension.holds(scaled)) * self.problem.units.pressure

    def second_variation(self, held: str) -> Array:
        """d^2 energy/ds_i ds_j by outward motions of the ends of the tension, times the roots of their intervals' widths and over 2 w, at
        the held "load" or "approach"."""
        _, here = self._place(Approach if held == "approach" else Load)
        root = np.sqrt(here.widths)
        return np.asarray(-0.5 * root[:, None] * here.rates * root)


@dataclass(frozen=True, eq=False)
class PulledGapFields(GapFields):
    """Nearly full contact under tension everywhere, by its gaps: the bare contact less the tension (scaled)."""

    stress: float = 0.0

    def __getstate__(self) -> dict[str, Any]:
        return super().__getstate__() | {"stress": self.stress}

    @property
    def _lower(self) -> float:
        return self.stress * self.problem.units.pressure

    @property
    def cohesive(self) -> Array:
        units, first = self.problem.units, float(self.density.zones.middle[0])
        return np.asarray(units.x(np.array([[first, first + self.period]])))

    @property
    def load(self) -> float:
        return super().load - self._lower * self.period * self.problem.units.length

    @cached_property
    def loads(self) -> Array:
        return super().loads - self._lower * np.diff(self.zones, axis=1)[:, 0] * self.problem.units.length

    def pressure(self, x: ArrayLike) -> Array:
        return super().pressure(x) - self._lower

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        return super().pressure_at(zone, t) - self._lower

    @cached_property
    def max_pressure(self) -> float:
        return float(super().max_pressure - self._lower)
