"""The first-order closure of several zones: contacts of the strip and of its profile alone, and how these follow what is not known.

Beside the ends of both that is the centre of the strip, its nominal pressure and the load. A unit of each calls up a density on the same
zones, and the ends move by 2 K / A of it, as in a step of Newton's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

import sie
from contact.formulation.fields import by_nominal_pressure, moved_ends, moves_by
from contact.formulation.tables import room_beside
from contact.verify.accuracy import Found
from sie import Array, Mask, record

# Tolerance of what a motion of the centre calls up, and of contacts of which a difference is taken; by what part of the gap beside the
# border, or of a zone there, the centre is moved to see what that does.
_ROUGHLY, _CLOSELY, _SHIFT = 1e-6, 1e-11, 1e-3
# Part of the total width below which a zone, or a gap, is narrow.
_NARROW = 1e-2


@record
class Place:
    """unknowns: centre, nominal pressure and load, scaled. strip, alone: zones (n, 2) of the strip and of its profile alone."""

    unknowns: Array
    strip: Array
    alone: Array

    def as_many(self, other: Place) -> bool:
        """Whether both have as many zones as before."""
        return self.strip.shape == other.strip.shape and self.alone.shape == other.alone.shape


@record
class Moved:
    """place: where all ends have come to; the largest move over the width of a zone or of a gap beside it, the same of those that are not
    narrow, and over the width of its zone."""

    place: Place
    largest: float
    bold: float
    off: float


@record
class At:
    """Contacts of the strip and of its profile alone. unknowns: centre, nominal pressure and load, scaled."""

    unknowns: Array
    strip: Found
    alone: Found

    @property
    def period(self) -> float:
        assert self.strip.fields.problem.period is not None
        return self.strip.fields.problem.period

    @cached_property
    def table(self) -> Array:
        return self.strip.free.density.zones.table

    def same_zones(self, other: At) -> bool:
        """Whether both have as many zones as before."""
        return len(self.table) == len(other.table) and len(table_of(self.alone)) == len(table_of(other.alone))

    @property
    def cut_off(self) -> Mask:
        """Whether the profile alone is in contact at the left and at the right border of the strip."""
        zones = self.alone.free.density.zones
        return np.array([zones.a[0], zones.b[-1]]) == np.array(self.alone.fields.problem.cut)

    @cached_property
    def own(self) -> tuple[Array, Array]:
        """Outward moves of all ends (2, Z) that Newton's next step under these unknowns makes, of the strip and of its profile alone."""
        return _own_moves(self.strip), _own_moves(self.alone)

    @property
    def misses(self) -> Array:
        """Of the width and the centre, after those moves."""
        middle = 0.5 * float(self.table[0, 0] + self.table[-1, 1])
        strip, alone = self.own
        wider = float(strip.sum()) - float(alone.sum())
        return np.array([width_of(self.strip) - width_of(self.alone) + wider, middle + _aside(strip) - self.unknowns[0]])

    def after(self, step: Array, rates: Rates, part: float) -> Moved:
        """By a step of the unknowns, and all ends by their own moves beside those it calls up. part: of a width or a gap that may go."""
        strip, alone = self.table, table_of(self.alone)
        moved, moved_alone = self._moved(step, rates)
        # What is cut off at the borders of the strip moves with these, narrow zones as they are.
        along = np.zeros(len(alone))
        along[[0, -1]] = np.where(self.cut_off, step[0], 0.0)
        moved_alone = moved_alone + along * [[1.0], [-1.0]]
        largest = bold = off = 0.0
        for move, table in ((moved, strip), (moved_alone, alone)):
            room, width = room_beside(table, None), np.diff(table)
            parts, wide = np.abs(move.T) / room, room > _NARROW * width.sum()
            largest, bold = max(largest, float(parts.max())), max(bold, float(parts[wide].max(initial=0.0)))
            off = max(off, float((np.abs(move.T) / width).max()))
        there = Place(self.unknowns + step, spread(strip, moved, part), spread(alone, moved_alone, part) + along[:, None])
        border = self.alone.fields.problem.about(float(there.unknowns[0])).cut
        there.alone.flat[[0, -1]] = np.where(self.cut_off, np.array(border), there.alone.flat[[0, -1]])
        return Moved(there, largest, bold, off)

    def _moved(self, step: Array, rates: Rates) -> tuple[Array, Array]:
        """Outward moves of the ends of the strip and of its profile alone by a step, with their own."""
        return rates.of_strip(step) + self.own[0], rates.alone_by_centre * step[0] + rates.alone * step[1] + self.own[1]


@record
class StripRates(sie.Kept):
    """How the ends of a strip move outward, and its approach grows, by its centre, its nominal pressure and its load: each found when it
    is first asked for, to a tolerance, where it is found by iteration."""

    strip: Found
    tolerance: float

    @cached_property
    def _shifted(self) -> sie.AnyState:
        return _shifted(self.strip)

    @cached_property
    def _pressed(self) -> sie.AnyState:
        return by_nominal_pressure(self.strip.fields.problem, self.strip.fields.state.density.zones, _ROUGHLY)

    @cached_property
    def by_centre(self) -> Array:
        """(2, Z)."""
        return moves_by(self._shifted.density, self.strip.fields.state.density)

    @cached_property
    def by_pressure(self) -> Array:
        """By the nominal pressure (2, Z)."""
        return moves_by(self._pressed.density, self.strip.fields.state.density)

    @cached_property
    def by_load(self) -> Array:
        """(2, Z)."""
        return moved_ends(self.strip.fields.state, 0, tolerance=self.tolerance)

    @cached_property
    def approach(self) -> Array:
        """Of the approach, by all three (3,)."""
        state = self.strip.fields.state
        by_load = float(state.level_rates(state.values()).mean())
        return -np.array([self._shifted.levels.mean(), self._pressed.levels.mean(), by_load])

    def of_strip(self, step: Array) -> Array:
        """Motions of the ends of the strip by a step of the unknowns."""
        moved = step[0] * self.by_centre + step[1] * self.by_pressure
        return moved if step[2] == 0.0 else moved + step[2] * self.by_load

    def of_ends(self, off: Array) -> Array:
        """What unknowns that are off make of the ends (Z, 2) over the widths of their zones, at the most."""
        moved = abs(off[0]) * np.abs(self.by_centre) + abs(off[1]) * np.abs(self.by_pressure)
        if off[2:].any():
            moved = moved + abs(off[2]) * np.abs(self.by_load)
        return np.asarray(moved.T / np.diff(table_of(self.strip), axis=1))


@record
class Rates(StripRates):
    """The same, and of its profile alone."""

    at: At

    @classmethod
    def of(cls, at: At, tolerance: float) -> Rates:
        return cls(at.strip, tolerance, at)

    @cached_property
    def alone(self) -> Array:
        """Of its profile alone by the nominal pressure (2, Z): its load is that of a period."""
        return self.at.period * moved_ends(self.at.alone.fields.state, 0, tolerance=self.tolerance)

    @cached_property
    def alone_by_centre(self) -> Array:
        """Of its profile alone by the centre (2, Z): where it touches a border of the strip that is cut off there, and bears a load that
        moves with the border, to which its other ends give way."""
        alone, low_high = self.at.alone, self.at.cut_off
        problem, zones = alone.fields.problem, alone.free.density.zones
        moved = np.zeros((2, len(zones)))
        if not low_high.any():
            return moved
        moved[[0, 1], [0, -1]] = low_high * (-1.0, 1.0)
        away, own = _SHIFT * float(room_beside(zones.table, None)[[0, -1]].min()), []
        for shift in (away, -away):
            equation = problem.about(problem.centre + shift).equation(alone.control)
            density = sie.solve_zones(equation, zones.moved(shift * moved), _CLOSELY).density
            own.append(moves_by(density, density))
        return np.asarray(moved + (own[0] - own[1]) / (2 * away))

    @cached_property
    def matrix(self) -> Array:
        """Of the misses by the centre and the nominal pressure (2, 2)."""
        width = float(self.by_centre.sum() - self.alone_by_centre.sum()), float(self.by_pressure.sum() - self.alone.sum())
        return np.array([width, (_aside(self.by_centre) - 1.0, _aside(self.by_pressure))])

    @cached_property
    def following(self) -> Array:
        """How the unknowns grow with the load (3,)."""
        return np.append(-np.linalg.solve(self.matrix, (float(self.by_load.sum()), _aside(self.by_load))), 1.0)


def _shifted(strip: Found) -> sie.AnyState:
    """What a unit of motion of the strip's centre adds to its density on the same zones, by a difference."""
    # Where the strip is its own mirror image, this is not.
    problem, zones = strip.fields.problem, replace(strip.fields.state.density.zones, symmetric=False)
    assert problem.period is not None and problem.amplitude is not None
    pressure, ends = problem.amplitude, zones.table[[0, -1], [0, 1]] - problem.centre
    away = _SHIFT * (0.5 * problem.period - float(np.abs(ends).max()))
    ahead, behind = (problem.about(problem.centre + shift).columns[0] for shift in (away, -away))
    assert ahead.primitive is not None and behind.primitive is not None
    forcing = sie.Forcing(
        _Difference(ahead.value, behind.value, 0.5 * pressure / away),
        _Difference(ahead.primitive, behind.primitive, 0.5 * pressure / away), between=True,
    )
    equation = sie.Equation(problem.kernel, forcing, (sie.Total(0.0), sie.EqualPotential()))
    return sie.solve_zones(equation, zones, _ROUGHLY)


@dataclass(frozen=True)
class _Difference:
    """(ahead - behind) factor, as a function."""

    ahead: Callable[[Array], Array]
    behind: Callable[[Array], Array]
    factor: float

    def __call__(self, x: Array) -> Array:
        return (self.ahead(x) - self.behind(x)) * self.factor


def _aside(moved: Array) -> float:
    """What outward moves (2, Z) do to the middle of the outermost ends."""
    return 0.5 * float(moved[1, -1] - moved[0, 0])


def _own_moves(found: Found) -> Array:
    """Outward moves 2 K / A (2, Z) that the ends of a contact have left."""
    return moves_by(found.free.density, found.free.density)


def spread(table: Array, moved: Array, part: float) -> Array:
    """Ends after outward moves (2, Z), cut to what widths and gaps allow. part: of them that may go."""
    outward = np.clip(moved.T, -part * np.diff(table), part * room_beside(table, None))
    return np.asarray(table + outward * [-1, 1])


def width_of(found: Found) -> float:
    zones = found.free.density.zones
    return float((zones.b - zones.a).sum())


def table_of(found: Found) -> Array:
    return found.free.density.zones.table
