"""Scaled controls: a given quantity becomes a side condition of the integral equation.

The condition depends on the unknown, the pressure (left) or the slope of the gap (right). The level
of a zone is minus its approach:

    load        int p = P, equal levels of all zones     mean pressure P / period
    approach    level -approach of every zone            mean gap = mean f - approach + mean u
    machine     level - compliance int p = -value
    half width  given ends, which do not move
    width       int p unknown, equal levels,             mean pressure unknown,
                ends with a given total width            ends with a given total width

Here `compliance` is that of the spring of a testing machine. The mean displacement, mean u, is
`compression` times the mean pressure. Loads are per period where there is one. Loads are in units
of `Units.load`, approaches in `Units.height`, widths in `Units.length`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

import sie
from contact.errors import OutOfRange
from contact.formulation.units import Units
from contact.model.controls import Quantity
from contact.model.scene import Scene
from sie import Array

Conditions = tuple[tuple[sie.Condition, ...], tuple[sie.TotalWidth, ...]]


@dataclass(frozen=True)
class Control:
    """A controlled quantity, such as the load, with its given value in scaled variables.

    The member that is named like the controlled quantity (`load`, `approach`, `half_width` or
    `width`) is the value. The other three members are None.
    """

    value: float
    name: ClassVar[str]
    counted_in: ClassVar[str]
    quantity: ClassVar[Quantity | None] = None
    # Compliance d approach / d load of the loading device. It is 0 if the device prescribes the
    # approach, and None if the device prescribes the load.
    compliance: ClassVar[float | None] = None

    def _if(self, quantity: Quantity) -> float | None:
        return self.value if self.quantity is quantity else None

    @property
    def load(self) -> float | None:
        return self._if(Quantity.LOAD)

    @property
    def approach(self) -> float | None:
        return self._if(Quantity.APPROACH)

    @property
    def half_width(self) -> float | None:
        return self._if(Quantity.HALF_WIDTH)

    @property
    def width(self) -> float | None:
        return self._if(Quantity.WIDTH)

    def conditions(self) -> Conditions:
        """Side conditions on the unknown pressure, and side conditions on the ends of zones."""
        raise NotImplementedError

    def gap_conditions(
        self, period: float, mean_height: Callable[[], float], compression: float
    ) -> Conditions:
        """Side conditions on the unknown slope of the gap, and side conditions on the ends of gaps.

        The mean pressure is the unknown amplitude of the equation's column 0. mean_height: mean of
        the profile above its lowest place. compression: mean displacement for a unit of mean
        pressure.
        """
        raise NotImplementedError

    def unit(self, units: Units) -> float:
        """The value in SI units of the controlled quantity if its scaled value is 1."""
        return float(getattr(units, self.counted_in))

    def described(self, units: Units) -> str:
        """Name and value of the control, for a message."""
        return f"{self.name} {self.value * self.unit(units):.6g}"


@dataclass(frozen=True)
class Load(Control):
    """Control by the load, or on a periodic scene by the load per period."""

    name, counted_in = "load", "load"
    quantity = Quantity.LOAD

    def conditions(self) -> Conditions:
        return (sie.Total(self.value), sie.EqualPotential()), ()

    def gap_conditions(
        self, period: float, mean_height: Callable[[], float], compression: float
    ) -> Conditions:
        return (sie.Amplitude(0, self.value / period), sie.ZoneTotals(0.0)), ()


@dataclass(frozen=True)
class Approach(Control):
    """Control by the approach, which must have the given value at every zone."""

    name, counted_in = "approach", "height"
    quantity = Quantity.APPROACH
    compliance = 0.0

    def conditions(self) -> Conditions:
        return (sie.Level(-self.value),), ()

    def gap_conditions(
        self, period: float, mean_height: Callable[[], float], compression: float
    ) -> Conditions:
        # The profile f has the minimum 0. The mean displacement is `compression` times the mean
        # pressure. So the mean gap is mean f - approach + `compression` times the mean pressure.
        # `ZoneMoments` prescribes minus the integral of the gap over the period.
        opened = sie.ZoneMoments((self.value - mean_height()) * period)
        return (
            opened if compression == 0.0 else _MeanGap(opened, compression * period),
            sie.ZoneTotals(0.0),
        ), ()


@dataclass(frozen=True)
class Machine(Control):
    """Control by the approach of the far end of a spring in series with the contact.

    This is the approach of the contact plus `spring_compliance` times the load.
    """

    spring_compliance: float
    name, counted_in = "machine", "height"

    @property
    def compliance(self) -> float:  # type: ignore[override]
        return self.spring_compliance

    def conditions(self) -> Conditions:
        return (_SpringLevel(-self.value, self.spring_compliance),), ()


@dataclass(frozen=True)
class HalfWidth(Control):
    """Control by the half width of one zone about the origin; the ends of the zone do not move."""

    name, counted_in = "half_width", "length"
    quantity = Quantity.HALF_WIDTH

    def conditions(self) -> Conditions:
        return (), ()


@dataclass(frozen=True)
class Width(Control):
    """Control by the total width of all zones; the load is unknown."""

    name, counted_in = "width", "length"
    quantity = Quantity.WIDTH

    def conditions(self) -> Conditions:
        return (sie.Total(None), sie.EqualPotential()), (sie.TotalWidth(self.value),)

    def gap_conditions(
        self, period: float, mean_height: Callable[[], float], compression: float
    ) -> Conditions:
        return (sie.Amplitude(0, None), sie.ZoneTotals(0.0)), (sie.TotalWidth(period - self.value),)


@dataclass(frozen=True)
class _SpringLevel(sie.Condition):
    """Condition of loading by a spring: approach + `compliance` * load = -`value` at every zone."""

    value: float
    compliance: float
    levels = True

    def count(self, zones: sie.Zones) -> int:
        return len(zones.solved)

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        matrix, constants = system.levels()
        totals, known = system.totals()
        weight = system.multiplicity()
        return (
            matrix - self.compliance * (weight @ totals),
            constants - self.compliance * (weight @ known),
            np.full(len(constants), self.value),
        )


@dataclass(frozen=True)
class _MeanGap(sie.Condition):
    """Condition on the difference (`depth` times the mean pressure) - (integral of all gaps)."""

    opened: sie.ZoneMoments
    depth: float

    def count(self, zones: sie.Zones) -> int:
        return 1

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        matrix, constants, value = self.opened.rows(system)
        row, constant = system.amplitude(0)
        return matrix + self.depth * row, constants + self.depth * constant, value


_KINDS: dict[Quantity, type[Control]] = {
    kind.quantity: kind for kind in (Load, Approach, HalfWidth, Width)
}


def scaled_control(scene: Scene, units: Units) -> Control:
    """The scene's control (the controlled quantity and its value) in scaled variables."""
    held = scene.control_object.held(scene)
    assert held is not None
    kind, value = _KINDS[held.quantity], held.value
    unit = kind(value).unit(units)
    scaled = value / unit if unit > 0.0 else math.inf
    if not math.isfinite(scaled) or (scaled == 0.0 and value != 0.0):
        raise OutOfRange(
            f"the ratio of the {kind.name} {value:.6g} to the scene's own size, {unit:.6g}, is "
            "outside the range of floating-point numbers: check that all data are in SI units"
        )
    return kind(scaled)
