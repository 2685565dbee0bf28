"""What is given of a contact, scaled: a load, an approach, the half width of one zone, or the width
of all zones together.

Each control knows the side conditions that fix it, where the pressure is the unknown and where the
slope of the gap is:

    load        int p = P, one level on all zones                      mean pressure P / period
    approach    the level -approach on every zone                      mean gap = mean f - approach
    machine     level - give int p = -value on every zone
    half width  the ends themselves, which stand where they are given
    width       int p unknown, one level; ends with a total width      mean pressure unknown; ends likewise

Loads are per period where there is one, in `Units.load`; approaches in `Units.height`, widths in
`Units.length`.
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
    """A given value, scaled. load, approach, half_width, width: that value where it is this
    quantity, else None.
    """

    value: float
    name: ClassVar[str]
    counted_in: ClassVar[str]
    quantity: ClassVar[Quantity | None] = None
    # d(approach)/d(load) of what holds the contact: 0 where that holds the approach, None where it
    # holds the load.
    yields: ClassVar[float | None] = None

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
        """Side conditions on the pressure, and on the ends of its zones."""
        raise NotImplementedError

    def gap_conditions(
        self, period: float, mean_height: Callable[[], float], compression: float
    ) -> Conditions:
        """Side conditions on the slope of the gap, whose column 0 is the mean pressure, and on the
        ends of the gaps. mean_height: of the profile above its lowest place; compression: mean
        displacement under a unit of mean pressure.
        """
        raise NotImplementedError

    def unit(self, units: Units) -> float:
        """The unit of the value, in SI."""
        return float(getattr(units, self.counted_in))

    def told(self, units: Units) -> str:
        """Name and value for a message."""
        return f"{self.name} {self.value * self.unit(units):.6g}"


@dataclass(frozen=True)
class Load(Control):
    """The load, per period where there is one."""

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
    """The approach: minus the level of the zones."""

    name, counted_in = "approach", "height"
    quantity = Quantity.APPROACH
    yields = 0.0

    def conditions(self) -> Conditions:
        return (sie.Level(-self.value),), ()

    def gap_conditions(
        self, period: float, mean_height: Callable[[], float], compression: float
    ) -> Conditions:
        # min f = 0, and u has the mean of the compression: the mean of f less the mean gap, and
        # that.
        opened = sie.ZoneMoments((self.value - mean_height()) * period)
        return (
            opened if compression == 0.0 else _OpenedAndSunk(opened, compression * period),
            sie.ZoneTotals(0.0),
        ), ()


@dataclass(frozen=True)
class Machine(Control):
    """The approach of the far end of a spring: that of the contact and `give` times the load, give
    > 0.
    """

    give: float
    name, counted_in = "machine", "height"

    @property
    def yields(self) -> float:  # type: ignore[override]
        return self.give

    def conditions(self) -> Conditions:
        return (_Sprung(-self.value, self.give),), ()


@dataclass(frozen=True)
class HalfWidth(Control):
    """The half width of one zone about the origin; its ends stand where they are given."""

    name, counted_in = "half_width", "length"
    quantity = Quantity.HALF_WIDTH

    def conditions(self) -> Conditions:
        return (), ()


@dataclass(frozen=True)
class Width(Control):
    """The width of all zones together; the load is unknown."""

    name, counted_in = "width", "length"
    quantity = Quantity.WIDTH

    def conditions(self) -> Conditions:
        return (sie.Total(None), sie.EqualPotential()), (sie.TotalWidth(self.value),)

    def gap_conditions(
        self, period: float, mean_height: Callable[[], float], compression: float
    ) -> Conditions:
        return (sie.Amplitude(0, None), sie.ZoneTotals(0.0)), (sie.TotalWidth(period - self.value),)


@dataclass(frozen=True)
class _Sprung(sie.Condition):
    """The level of every zone, less `give` times the total, has a value."""

    value: float
    give: float
    levels = True

    def count(self, zones: sie.Zones) -> int:
        return len(zones.solved)

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        matrix, constants = system.levels()
        totals, known = system.totals()
        weight = system.multiplicity()
        return (
            matrix - self.give * (weight @ totals),
            constants - self.give * (weight @ known),
            np.full(len(constants), self.value),
        )


@dataclass(frozen=True)
class _OpenedAndSunk(sie.Condition):
    """What the gaps open, and `depth` times the amplitude of column 0, add up to a value."""

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
    """The scene's control in scaled variables."""
    held = scene.control_object.held(scene)
    assert held is not None
    kind, value = _KINDS[held.quantity], held.value
    unit = kind(value).unit(units)
    scaled = value / unit if unit > 0.0 else math.inf
    if not math.isfinite(scaled) or (scaled == 0.0 and value != 0.0):
        raise OutOfRange(
            f"{kind.name} {value:.6g} and the scene's own size, {unit:.6g}, lie farther apart than "
            "numbers reach: are the units those "
            "of SI?"
        )
    return kind(scaled)
