"""The first-order closure near full contact: Newton's steps on the centre and the nominal pressure, of which both contacts are solved by
their gaps (contact.formulation.strip_turn).

A step asks the ends of all gaps to move, by what a unit of the centre and of the nominal pressure calls up on the same gaps; from there
each contact is found under the new ones, with the gaps that its signs ask for. Nothing but gaps is unknown, so that a step takes a small
part of what one solution by the zones takes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

import sie
from contact.formulation.fields import moves_by
from contact.formulation.problem import Problem
from contact.formulation.strip_turn import TURN, StripTurn
from contact.formulation.tables import centred_on
from contact.search.topology.intervals import united, without
from contact.search.topology.missed import WrongTopology
from contact.search.ways.first_order_contacts import Place, spread
from sie import Array

# Angles to a shortest length of the profile, and bounds of how many.
_CLOSE, _FEWEST, _MOST = 32, 2**12, 2**17
# Tolerance of the ends, and of what a unit of the unknowns calls up.
_ENDS, _RATES = 1e-8, 1e-6
# Steps at the most, how often one is halved, largest part of the room beside the border and of the nominal pressure in one.
_STEPS, _HALVED, _TRUSTED, _LARGEST = 25, 4, 0.25, 0.2
# Rounds in which signs are looked at; of the largest pressure, and of the largest gap: what is none. Samples looked at.
_ROUNDS, _NONE, _OVERLAP, _SAMPLES = 8, 1e-6, 1e-4, 2**14
# Of a gap or a zone that may go in a step; and what it is no farther than at the root.
_PART, _THERE = 0.4, 1e-6
_NEWTON = 25


class _Lost(Exception):
    """No gaps that lead on."""


@dataclass(frozen=True, eq=False)
class GapContact:
    """A contact by its gaps in the angle. beyond: the nominal pressure beyond the strip."""

    turn: StripTurn
    beyond: float
    mean: float
    state: sie.AnyState

    @cached_property
    def table(self) -> Array:
        """The gaps (n, 2) of a turn."""
        return self.state.density.zones.table

    @cached_property
    def opened(self) -> float:
        """Total width of the gaps of the strip."""
        ends = _turned(self.table)
        return 0.5 * self.turn.half * float((ends[:, 1] - ends[:, 0]).sum())

    @property
    def borders(self) -> tuple[int, int] | None:
        """The gaps about the left and about the right border, where there are both."""
        found = [np.flatnonzero((self.table[:, 0] < at) & (self.table[:, 1] > at)) for at in (0.0, np.pi)]
        return (int(found[0][0]), int(found[1][0])) if len(found[0]) and len(found[1]) else None

    def moves(self, values: Array | None, beyond: float, mean: float) -> Array:
        """Outward moves (2, n) that a change of the right side calls up."""
        equation = self.turn.equation(values, beyond, mean)
        return moves_by(sie.solve_zones(equation, self.state.density.zones, _RATES).density, self.state.density)

    def widening(self, moved: Array) -> float:
        """What that adds to the width of the gaps."""
        return 0.5 * self.turn.half * float((np.abs(np.sin(self.table.T)) * moved).sum())


def _turned(angle: Array) -> Array:
    """The integral of |sin|."""
    turns = np.floor(angle / np.pi)
    return np.asarray(2 * turns + 1 - np.cos(angle - np.pi * turns))


@dataclass(frozen=True, eq=False)
class _Both:
    """Contacts of the strip and of its profile alone under a centre and a nominal pressure."""

    centre: float
    pressure: float
    strip: GapContact
    alone: GapContact

    @cached_property
    def misses(self) -> Array:
        """Of the width and of the centre."""
        left, right = self._ends
        middle = -0.5 * self.strip.turn.half * (math.cos(left) + math.cos(right))
        return np.array([self.alone.opened - self.strip.opened, middle])

    @property
    def room(self) -> float:
        """Between the outermost ends and the borders of the strip, together."""
        left, right = self._ends
        return self.strip.turn.half * (2 - math.cos(left) + math.cos(right))

    @property
    def _ends(self) -> tuple[float, float]:
        assert self.strip.borders is not None
        left, right = self.strip.borders
        return float(self.strip.table[left, 1]), float(self.strip.table[right, 0])

    @cached_property
    def rates(self) -> tuple[Array, Array]:
        """(outward moves of the gaps of the strip by the centre and the nominal pressure (2, 2, n), the same of those alone)."""
        turn = self.strip.turn
        added = 2 * turn.half / np.pi
        strip = [self.strip.moves(turn.by_centre, 0.0, 0.0), self.strip.moves(None, turn.half, -added)]
        alone = [self.alone.moves(turn.by_centre, 0.0, 0.0), self.alone.moves(None, 0.0, added)]
        return np.array(strip), np.array(alone)

    @cached_property
    def matrix(self) -> Array:
        """Of the misses by the centre and the nominal pressure."""
        strip, alone = self.rates
        assert self.strip.borders is not None
        (left, right), sides = self.strip.borders, np.sin(self._ends)
        widths = [self.alone.widening(a) - self.strip.widening(s) for s, a in zip(strip, alone, strict=True)]
        middle = [0.5 * self.strip.turn.half * float(sides[0] * s[1, left] - sides[1] * s[0, right]) for s in strip]
        return np.array([widths, middle])


@dataclass(frozen=True, eq=False)
class GapClosure:
    """The root under a scaled load."""

    problem: Problem
    load: float

    def root(self, start: Place) -> Place:
        """From some zones near by; raises _Lost."""
        here = self._at(float(start.unknowns[0]), float(start.unknowns[1]), start)
        for _ in range(_STEPS):
            step = -np.linalg.solve(here.matrix, here.misses)
            strip, alone = (np.tensordot(step, rates, 1) for rates in here.rates)
            largest = max(_largest(here.strip.table, strip), _largest(here.alone.table, alone))
            if DEBUG: print("   gap step", here.misses, "step", step, "largest", f"{largest:.1e}", "sv", np.linalg.svd(here.matrix*np.array([here.room,here.pressure])/here.room,compute_uv=False),len(here.strip.table),len(here.alone.table),"room",here.room, time.process_time())
            if largest < _THERE:
                return self._place(here)
            step = step / max(1.0, abs(step[0]) / (_TRUSTED * here.room), abs(step[1]) / (_LARGEST * here.pressure))
            here = self._after(here, step)
        raise _Lost("did not settle")

    def _after(self, here: _Both, step: Array) -> _Both:
        for halved in range(_HALVED + 1):
            strip, alone = (np.tensordot(step, rates, 1) for rates in here.rates)
            try:
                return self._with(
                    here.centre + step[0], here.pressure + step[1], spread(here.strip.table, strip, _PART),
                    spread(here.alone.table, alone, _PART),
                )
            except _Lost:
                if halved == _HALVED:
                    raise
                step = 0.5 * step
        raise AssertionError

    def _at(self, centre: float, pressure: float, zones: Place) -> _Both:
        turn = StripTurn(self.problem, centre, self._points)
        return self._with(centre, pressure, turn.gaps_of(zones.strip), turn.gaps_of(zones.alone))

    def _with(self, centre: float, pressure: float, strip: Array, alone: Array) -> _Both:
        turn = StripTurn(self.problem, centre, self._points)
        added = 2 * turn.half * pressure / np.pi
        found = _contact(turn, pressure, self.load / np.pi - added, strip)
        if found.borders is None:
            raise _Lost("border")
        return _Both(centre, pressure, found, _contact(turn, 0.0, added, alone))

    @cached_property
    def _points(self) -> int:
        profile = self.problem.profile
        assert profile.period is not None
        features = 16.0 if profile.feature is None else profile.period / profile.feature
        return 2 ** int(np.clip(np.ceil(np.log2(_CLOSE * features)), math.log2(_FEWEST), math.log2(_MOST)))

    def _place(self, here: _Both) -> Place:
        turn = here.strip.turn
        return Place(np.array([here.centre, here.pressure, self.load]), turn.zones_of(here.strip.table), turn.zones_of(here.alone.table))


def _largest(table: Array, moved: Array) -> float:
    gaps = np.append(table[1:, 0] - table[:-1, 1], table[0, 0] + TURN - table[-1, 1])
    room = np.minimum(table[:, 1] - table[:, 0], np.array([np.roll(gaps, 1), gaps]))
    return float((np.abs(moved) / room).max())


def _contact(turn: StripTurn, beyond: float, mean: float, table: Array) -> GapContact:
    """From about its gaps, with those that its signs ask for."""
    equation = turn.equation(turn.relief, beyond * turn.half, mean)
    for _ in range(_ROUNDS):
        if len(table) == 0:
            raise _Lost("no gap")
        try:
            free = sie.find_ends(equation, sie.Zones.of(table), _ENDS, _NEWTON, signs=(1.0, -1.0), drops=True)
        except (ValueError, sie.SingularSystem) as e:
            raise _Lost(str(e)) from e
        if not free.converged:
            raise _Lost(free.reason)
        found = GapContact(turn, beyond, mean, free.state)
        pulls, overlaps = _signs(found)
        if len(pulls) == 0 and len(overlaps) == 0:
            return found
        if DEBUG: print("      signs", pulls, overlaps)
        try:
            table = united(np.concatenate((without(found.table, overlaps), pulls)), TURN, True, "gap")
        except WrongTopology as e:
            raise _Lost(str(e)) from e
        table = centred_on(table, np.pi - 1e-3, TURN)
        table = table[np.argsort(table[:, 0])]
    raise _Lost("signs")


def _signs(found: GapContact) -> tuple[Array, Array]:
    """(where the pressure pulls, where the gap is negative) on even samples."""
    turn, density = found.turn, found.state.density
    zones = density.zones
    every = max(1, turn.points // _SAMPLES)
    angle = np.concatenate((turn.angles[::every], TURN - turn.angles[::-every]))
    angle = np.sort(zones.a[0] + (angle - zones.a[0]) % TURN)
    inside = density.locate(angle)[2]
    pressure = found.mean - turn.between(turn.relief, angle) + found.beyond * turn.half * np.abs(np.sin(angle)) + density.transform(angle)
    pulls = _runs(~inside & (pressure < -_NONE * np.abs(pressure[~inside]).max(initial=0.0)), angle)
    overlaps = []
    for k in range(len(zones)):
        count = int(np.clip(4 * (zones.b[k] - zones.a[k]) / (angle[1] - angle[0]) / 4, 32, 1024))
        at = np.pi * (np.arange(count) + 0.5) / count
        # The gap from its nearer end on.
        rise = density.at(k, 2 * np.cos(at / 2) ** 2, 2 * np.sin(at / 2) ** 2)[::-1] * np.sin(at)
        gap = np.where(at < np.pi / 2, np.cumsum(rise), -np.cumsum(rise[::-1])[::-1])
        overlaps.append(_runs(gap < -_OVERLAP * np.abs(gap).max(), zones.middle[k] - zones.half[k] * np.cos(at)))
    return pulls, np.concatenate(overlaps)


def _runs(where: Array, angle: Array) -> Array:
    """From the first to the last of each run of samples, and half a step on."""
    change = np.flatnonzero(np.diff(np.concatenate(([False], where, [False])).astype(np.int8)))
    first, last = change[::2], change[1::2] - 1
    half = 0.5 * np.gradient(angle)
    return np.column_stack((angle[first] - half[first], angle[last] + half[last]))
import time
DEBUG=False
