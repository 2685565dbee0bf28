"""Fields of surfaces that attract each other without contact: a uniform tension on intervals."""

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.uniform_tension import UniformTension
from contact.formulation.fields import NoZones, mean_shape
from contact.formulation.problem import Problem
from contact.formulation.quadrature import cuts_between, panels
from sie import Array, Complex, record, wrapped


def integral_outside(
    function: Callable[[Array], Array], pulled: TractionLoaded, zones: Array, spacing: float
) -> float:
    """Scaled integral of a function over the intervals of tension outside the zones.

    The quadrature has panels no wider than the spacing, with borders where the profile or one of
    its derivatives jumps.
    """
    return sum(_integral(function, pulled, a, b, spacing) for a, b in _parts_beside(pulled, zones))


def integral_on_zones(
    function: Callable[[Array], Array], pulled: TractionLoaded, zones: Array, spacing: float
) -> float:
    """Scaled integral of a function over the zones."""
    return sum(_integral(function, pulled, float(a), float(b), spacing) for a, b in zones)


def _parts_beside(pulled: TractionLoaded, zones: Array) -> list[tuple[float, float]]:
    """The intervals of tension without the zones of contact inside them."""
    tension, parts = pulled.pulling, []
    for lo, hi in _intervals(tension, zones):
        shifts = (0.0,) if tension.period is None else (-tension.period, 0.0, tension.period)
        inside = sorted(
            (float(a + shift), float(b + shift))
            for a, b in zones
            for shift in shifts
            if b + shift > lo and a + shift < hi
        )
        ends = [lo, *(min(max(end, lo), hi) for zone in inside for end in zone), hi]
        parts += [(a, b) for a, b in zip(ends[::2], ends[1::2], strict=True) if b > a]
    return parts


def _intervals(tension: UniformTension, zones: Array) -> list[tuple[float, float]]:
    if not tension.everywhere:
        return [(float(a), float(b)) for a, b in tension.table]
    first = float(zones[0, 1]) if len(zones) else 0.0
    return [(first, first + tension.width)]


def _integral(
    function: Callable[[Array], Array], pulled: TractionLoaded, a: float, b: float, spacing: float
) -> float:
    breaks = wrapped(pulled.forcing.jumps.broken_at, a, pulled.period)
    x, weight = panels(cuts_between(a, b, spacing, breaks))
    return float(function(x) @ weight)


@record
class SeparatedFields(NoZones):
    """The fields of surfaces without contact under a tension.

    problem: the problem with the scene's law; pulled: the problem of the profile that the tension
    has deformed; level: minus the scaled approach. The stiffness is None, since the ends of the
    intervals of tension move with the approach.
    """

    problem: Problem
    pulled: TractionLoaded
    level: float
    pressure_bound = max_pressure = contact_fraction = 0.0
    stiffness = None

    @property
    def tension(self) -> UniformTension:
        return self.pulled.pulling

    def pressure(self, x: ArrayLike) -> Array:
        return np.asarray(-self.problem.law.tension * self.tension.holds(self._scaled(x)))

    def pressure_transform(self, x: Array, y: Array) -> tuple[Complex, Complex]:
        units = self.problem.units
        pull, bend = self.tension.in_plane(self._scaled(x) + 1j * (y / units.length))
        return -pull * units.pressure, -bend * (units.pressure / units.length)

    @property
    def deep_pressure(self) -> float:
        if not self.problem.operator.is_periodic:
            return 0.0
        return self.load / (self.problem.repeat_length * self.problem.units.length)

    def displacement(self, x: ArrayLike) -> Array:
        return np.asarray(self.tension.height(self._scaled(x)) * self.problem.units.height)

    def gap(self, x: ArrayLike) -> Array:
        return np.asarray(self.scaled_gap(self._scaled(x)) * self.problem.units.height)

    def scaled_gap(self, x: Array) -> Array:
        return np.asarray(self.pulled.shape(x) + self.level)

    def _scaled(self, x: ArrayLike) -> Array:
        return np.asarray(self.problem.units.scaled(np.asarray(x, dtype=float)))

    @property
    def cohesive(self) -> Array:  # type: ignore[override]
        """The intervals of tension (m, 2) [m]."""
        return np.asarray(
            self.problem.units.x(np.array(_intervals(self.tension, np.zeros((0, 2)))))
        )

    @property
    def load(self) -> float:  # type: ignore[override]
        return -self.tension.total * self.problem.units.load

    @property
    def approach(self) -> float | None:  # type: ignore[override]
        return (
            -self.level * self.problem.units.height if self.problem.operator.has_approach else None
        )

    @property
    def mean_gap(self) -> float:  # type: ignore[override]
        sunk = self.problem.compression * self.tension.total / self.problem.repeat_length
        return (mean_shape(self.problem) - sunk + self.level) * self.problem.units.height

    @cached_property
    def _spacing(self) -> float:
        detail = self.problem.detail
        return detail if np.isfinite(detail) else self.tension.width / 16

    @cached_property
    def borne_beside(self) -> float:  # type: ignore[override]
        """Scaled integral of pressure * (profile height - gap) over the intervals of tension."""
        return -self.tension.stress * integral_outside(
            lambda x: self.pulled.own_shape(x) - self.scaled_gap(x),
            self.pulled,
            np.zeros((0, 2)),
            self._spacing,
        )

    @cached_property
    def opened(self) -> float:
        """Integral of the gap over the intervals of tension [m^2]."""
        units = self.problem.units
        return (
            integral_outside(self.scaled_gap, self.pulled, np.zeros((0, 2)), self._spacing)
            * units.length
            * units.height
        )
