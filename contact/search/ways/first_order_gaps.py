"""The first-order closure near full contact: Newton's steps on the centre and the nominal pressure, of which both contacts are solved by
their gaps (contact.formulation.strip_turn).

A step asks the ends of all gaps to move, by what a unit of the centre and of the nominal pressure calls up on the same gaps; from there
each contact is found under the new ones, with the gaps that its signs ask for. Nothing but gaps is unknown, so that a step takes a small
part of what one solution by the zones takes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.polynomial.legendre import leggauss, legint, legvander

import sie
from contact.formulation.fields import moves_by
from contact.formulation.problem import Problem
from contact.formulation.strip_turn import TURN, StripTurn
from contact.formulation.tables import centred_on, gaps_between, room_beside
from contact.search.grid.centring import Unrest
from contact.search.topology.intervals import united, without
from contact.search.topology.missed import WrongTopology
from contact.search.ways.first_order_contacts import Place, spread
from contact.verify.minima import follow, lowest, may_be_negative
from sie import Array, Index, record

# Angles to a shortest length of the profile, and bounds of how many.
_CLOSE, _FEWEST, _MOST = 32, 2**12, 2**17
# Tolerance of the ends, and of what a unit of the unknowns calls up.
_ENDS, _RATES, _ROUGHLY, _FINER, _FAR = 1e-6, 1e-5, 1e-3, 1e-2, 0.1
# Coefficients that are left out at the most, and over the tolerance of the ends.
_DECAY, _CUT = 1e-5, 0.1
# Steps at the most, how often one is halved, largest part of the room beside the border and of the nominal pressure in one.
_STEPS, _HALVED, _TRUSTED, _LARGEST = 25, 1, 0.5, 0.2
# How often signs are looked at, and on the way; of the largest pressure, and of the largest gap: what is none. Samples looked at.
_ROUNDS, _ON_THE_WAY, _NONE, _OVERLAP, _SAMPLES = 6, 1, 1e-6, 1e-4, 2**14
# Of a gap or a zone that may go in a step; and what it is no farther than at the root.
_PART, _THERE, _NEAR = 0.4, 1e-2, 0.05
# Steps in which what is missed does not halve, after which it is given up; gaps so few that a step astray costs little.
_STALLED, _FEW_GAPS = 3, 24
_NEWTON = 25
# Steps by the exact profile, how long one may be after which there is none, and before which coefficients are cut off sooner, by what;
# what may be unsure over their tolerance, what of that the last step may leave, the part to which they are cut off later where the rest is
# more, and the last one.
_FINE_STEPS, _SQUARE, _SHORT, _COARSER, _UNSURE, _SETTLED, _SHORTER, _SHORTEST = 8, 3e-6, 1e-3, 1e3, 100.0, 10.0, 1e-2, 1e-15
# Zones over the gaps beside them, from which on ends are found the more closely.
_STEEP = 30.0
# What is left after the last step, over what it is estimated as.
_MARGIN = 2.0
# How often signs are looked at by the exact profile; samples of a zone at the most, and what is low there, over its largest pressure; what
# ends that are off make of signs.
_LOOKS, _LOOKED_AT, _LOW, _TOLD = 4, 40000, 1e-3, 10.0
# Nodes of a panel of a gap, and panels at the least.
_IN_PANEL, _PANELS = 8, 16
_EPS = float(np.finfo(np.float64).eps)
# What gaps come to that steps by the exact profile have moved over each other.
_OVER_EACH_OTHER = ValueError, sie.SingularSystem


@dataclass(frozen=True)
class _How:
    """tolerance: of the ends; looks: how often signs are looked at."""

    tolerance: float
    looks: int

    @property
    def decay(self) -> float:
        """Of the coefficients: ends come to rest where less than their tolerance is cut off."""
        return min(_DECAY, _CUT * self.tolerance)


class Lost(Exception):
    """No gaps that lead on; why: what keeps the strip from a root."""

    def __init__(self, reason: str, why: Unrest = Unrest.LOST) -> None:
        super().__init__(reason)
        self.why = why


@record
class GapContact:
    """A contact by its gaps in the angle. beyond: the nominal pressure beyond the strip; table: the gaps (n, 2) of a turn; found: None of
    gaps that were moved on."""

    turn: StripTurn
    beyond: float
    mean: float
    table: Array
    found: sie.AnyState | None = None

    @property
    def equation(self) -> sie.Equation:
        return self.turn.equation(self.turn.relief_at, self.beyond * self.turn.half, self.mean)

    @cached_property
    def state(self) -> sie.AnyState:
        """On the gaps as they are."""
        return sie.solve_zones(self.equation, sie.Zones.of(self.table), _DECAY) if self.found is None else self.found

    @cached_property
    def opened(self) -> float:
        """Total width of the gaps of the strip."""
        ends = _turned(self.table)
        return 0.5 * self.turn.half * float((ends[:, 1] - ends[:, 0]).sum())

    @property
    def steepest(self) -> float:
        """The widest zone over a gap beside it: about how many times the pressure follows ends over their zones' widths."""
        table = self.turn.zones_of(self.table)
        border = self.turn.centre + self.turn.half * np.array([-1.0, 1.0])
        gaps = np.diff(np.concatenate((border[:1], table.ravel(), border[1:])).reshape(-1, 2), axis=1)[:, 0]
        return float((np.diff(table, axis=1)[:, 0] / np.minimum(gaps[:-1], gaps[1:])).max())

    @property
    def borders(self) -> tuple[int, int] | None:
        """The gaps about the left and about the right border, where there are both."""
        found = [np.flatnonzero((self.table[:, 0] < at) & (self.table[:, 1] > at)) for at in (0.0, np.pi)]
        return (int(found[0][0]), int(found[1][0])) if len(found[0]) and len(found[1]) else None

    def moves(self, given: Callable[[Array], Array] | None, beyond: float, mean: float) -> Array:
        """Outward moves (2, n) that a change of the right side calls up."""
        equation = self.turn.equation(given, beyond, mean)
        return moves_by(sie.solve_zones(equation, self.state.density.zones, _RATES).density, self.state.density)

    def finely(self, decay: float) -> tuple[Array, Array, list[sie.Density]]:
        """(outward moves (2, n) that the exact profile and longer series ask for, what they leave, slopes of the gap): profile and nominal
        pressure call up one each, with the jumps that are their own."""
        turn, zones = self.turn, sie.Zones.of(self.table)
        parts = [turn.equation(turn.exact_at, 0.0, self.mean)]
        parts += [turn.equation(None, self.beyond * turn.half, 0.0)] if self.beyond else []
        states = [sie.solve_zones(equation, zones, decay) for equation in parts]
        slopes = [np.array(state.density.edge_slopes) for state in states]
        slope = np.sum(slopes, axis=0)
        moved = np.asarray(2 * np.sum([np.array(state.density.intensities) for state in states], axis=0) / slope)
        widths = np.diff(self.table, axis=1).T
        unsure = np.sum([np.abs(state.end_truncation.T * own) for state, own in zip(states, slopes, strict=True)], axis=0) * widths
        unsure += 2 * np.sum([state.whole.intensity_noise for state in states], axis=0)
        return moved, np.asarray(unsure / np.abs(slope) + moved**2 / widths), [state.whole.density for state in states]

    def failing(self, slopes: list[sie.Density], off: float) -> tuple[Array, Array]:
        """(where the pressure pulls, where the gap is negative), by the exact profile, as closely as ends that are off by such a part
        of their gaps tell."""
        turn, zones = self.turn, gaps_between(self.table, TURN)
        zones = zones[(zones[:, 1] % TURN < np.pi) | (zones[:, 0] % TURN < np.pi)]
        middle, half = zones.mean(axis=1), 0.5 * np.diff(zones)[:, 0]

        def pressure(zone: Index, theta: Array, relief: Callable[[Array], Array]) -> Array:
            angle = middle[zone] + half[zone] * np.cos(theta)
            pulled = np.sum([slope.transform(angle) for slope in slopes], axis=0)
            return np.asarray((self.mean - relief(angle) + self.beyond * turn.half * np.abs(np.sin(angle)) + pulled) / np.sin(theta))

        found = []
        # As close as the turn's own angles in the middle of a zone.
        count = np.clip(turn.points * half, 96, _LOOKED_AT).astype(int)
        for one, n in enumerate(count):
            theta = np.pi * (np.arange(n) + 0.5) / n
            value = pressure(np.full(n, one), theta, turn.relief_at)
            low = (value[1:-1] <= value[:-2]) & (value[1:-1] <= value[2:]) & (value[1:-1] < _LOW * np.abs(value).max())
            at = np.flatnonzero(low | may_be_negative(value[:-2], value[1:-1], value[2:])) + 1
            found.append((np.full(len(at), one), theta[at - 1], theta[at + 1], np.full(len(at), np.abs(value).max())))
        zone, lo, hi, scale = (np.concatenate(part) for part in zip(*found, strict=True))
        dips = follow(lambda i, theta: pressure(i, theta, turn.exact_at), zone, lo, hi, scale, (64 * _EPS + off) * scale)
        pulls = [(middle[i] + half[i] * math.cos(last), middle[i] + half[i] * math.cos(first)) for i, first, last in dips.negative]
        return np.array(pulls).reshape(-1, 2), self._closed(slopes, off)

    def _closed(self, slopes: list[sie.Density], off: float) -> Array:
        """Where the gap is negative: its slope summed up by Gauss's rule between the places where that bends."""
        knots, out = np.sort(self.turn.jumps[0]), []
        t, weights = leggauss(_IN_PANEL)
        # Of a panel from its left edge to its nodes, by the polynomial through these.
        sums = legint(np.linalg.inv(legvander(t, _IN_PANEL - 1)), lbnd=-1)
        within = legvander(t, _IN_PANEL) @ sums
        for k, (left, right) in enumerate(self.table):
            middle, half = 0.5 * (left + right), 0.5 * (right - left)
            inside = left + (knots - left) % TURN
            inside = np.arccos(np.clip((middle - inside[inside < right]) / half, -1.0, 1.0))
            edges = np.unique(np.concatenate((np.linspace(0.0, np.pi, _PANELS + 1), inside)))
            widths = 0.5 * np.diff(edges)
            theta = (edges[:-1] + widths)[:, None] + widths[:, None] * t
            sides = 2 * np.sin(0.5 * theta) ** 2, 2 * np.cos(0.5 * theta) ** 2
            rise = np.sum([slope.at(k, *sides) for slope in slopes], axis=0) * np.sin(theta)
            before = np.append(0.0, np.cumsum((rise @ weights) * widths)[:-1])
            gap = (before[:, None] + (rise @ within.T) * widths[:, None]).ravel()
            at = np.flatnonzero((gap[1:-1] < gap[:-2]) & (gap[1:-1] < gap[2:])) + 1
            for place, value, bend in lowest(theta.ravel(), gap, at):
                if value < -(64 * _EPS + off) * np.abs(gap).max():
                    reach = math.sqrt(-value / bend)
                    out.append(middle - half * np.cos([max(place - reach, 0.0), min(place + reach, np.pi)]))
        return np.array(out).reshape(-1, 2)

    def widening(self, moved: Array) -> float:
        """What that adds to the width of the gaps."""
        return 0.5 * self.turn.half * float((np.abs(np.sin(self.table.T)) * moved).sum())


def _turned(angle: Array) -> Array:
    """The integral of |sin|."""
    turns = np.floor(angle / np.pi)
    return np.asarray(2 * turns + 1 - np.cos(angle - np.pi * turns))


@record
class _Both:
    """Contacts of the strip and of its profile alone under a centre and a nominal pressure."""

    centre: float
    pressure: float
    strip: GapContact
    alone: GapContact
    kept: tuple[Array, Array] | None = None

    @cached_property
    def misses(self) -> Array:
        """Of the width and of the centre."""
        left, right = self._ends
        middle = -0.5 * self.strip.turn.half * (math.cos(left) + math.cos(right))
        return np.array([self.alone.opened - self.strip.opened, middle])

    @property
    def few(self) -> bool:
        """Whether there are so few gaps that steps which lead astray cost little."""
        return len(self.strip.table) + len(self.alone.table) <= _FEW_GAPS

    def same_gaps(self, other: _Both) -> bool:
        """Whether both have as many gaps as before."""
        return self.strip.table.shape == other.strip.table.shape and self.alone.table.shape == other.alone.table.shape

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
        if self.kept is not None:
            return self.kept
        turn = self.strip.turn
        added = 2 * turn.half / np.pi
        strip = [self.strip.moves(turn.by_centre_at, 0.0, 0.0), self.strip.moves(None, turn.half, -added)]
        alone = [self.alone.moves(turn.by_centre_at, 0.0, 0.0), self.alone.moves(None, 0.0, added)]
        return np.array(strip), np.array(alone)

    @cached_property
    def step(self) -> Array:
        """Newton's, of the centre and the nominal pressure."""
        return np.asarray(-np.linalg.solve(self.matrix, self.misses))

    @property
    def following(self) -> Array:
        """How the unknowns grow with the load."""
        by_load = self.strip.moves(None, 0.0, 1 / np.pi)
        return np.asarray(-np.linalg.solve(self.matrix, (-self.strip.widening(by_load), self.aside(by_load))))

    def aside(self, moved: Array) -> float:
        """What outward moves of the gaps of the strip do to the middle of its outermost ends."""
        assert self.strip.borders is not None
        (left, right), sides = self.strip.borders, np.sin(self._ends)
        return 0.5 * self.strip.turn.half * float(sides[0] * moved[1, left] - sides[1] * moved[0, right])

    def missed_by(self, strip: Array, alone: Array) -> Array:
        """What width and centre are missed by at the most where the ends of gaps (2, n) are off."""
        return np.array([self.strip.widening(strip) + self.alone.widening(alone), self.aside(strip * [[-1.0], [1.0]])])

    @property
    def far(self) -> float:
        """Newton's step over the room beside the border and the nominal pressure."""
        return float(np.linalg.norm(self.step / (self.room, self.pressure)))

    def closing(self, step: Array) -> Array:
        """By what part the gaps at the left and at the right border open in a step."""
        assert self.strip.borders is not None
        (left, right), moved = self.strip.borders, self.moved(step)[0]
        ends = self._ends
        return np.array([moved[1, left] / ends[0], moved[0, right] / (np.pi - ends[1])])

    def moved(self, step: Array) -> tuple[Array, Array, float]:
        """(outward moves of the gaps of the strip and of those alone by a step, the largest over the width of a gap or a zone)."""
        strip, alone = (np.tensordot(step, rates, 1) for rates in self.rates)
        return strip, alone, max(_largest(self.strip, strip), _largest(self.alone, alone))

    @cached_property
    def matrix(self) -> Array:
        """Of the misses by the centre and the nominal pressure."""
        strip, alone = self.rates
        widths = [self.alone.widening(a) - self.strip.widening(s) for s, a in zip(strip, alone, strict=True)]
        return np.array([widths, [self.aside(s) for s in strip]])


@record
class Root:
    """The zones at the root. ends: what those of the strip may be off, over the zones' widths (n, 2), but for what the centre and the
    nominal pressure are; unsure: what width and centre may be missed by (2,); inverse: the unknowns by these (2, 2); following: how centre
    and nominal pressure grow with the load (2,)."""

    place: Place
    ends: Array
    unsure: Array
    inverse: Array
    following: Array


@record
class GapClosure:
    """The root under a scaled load, whose gaps are found to a tolerance, that of the pressure beside them. carefully: in steps that gaps
    and zones stay which are to become narrower."""

    problem: Problem
    load: float
    tolerance: float
    carefully: bool = False

    def root(self, start: Place) -> Root:
        """From some zones near by, with the gaps that the exact profile asks for; raises Lost."""
        try:
            root, failing = self._root(self._begun(start, True))
            for _ in range(_LOOKS):
                if failing is None:
                    return root
                before = failing
                root, failing = self._put_right(before)
                if failing is not None and failing.as_many(before):
                    break
        except _OVER_EACH_OTHER as e:
            raise Lost(str(e)) from e
        raise Lost("the number of gaps did not settle")

    def _put_right(self, start: Place) -> tuple[Root, Place | None]:
        """From gaps of which some are new: as they are, since samples may not tell them, else with those that samples tell."""
        try:
            return self._root(self._begun(start, False))
        except (Lost, *_OVER_EACH_OTHER):
            return self._root(replace(self, carefully=True)._begun(start, True))

    def _begun(self, start: Place, sampled: bool) -> _Both:
        """From some zones near by, at the root of the samples, or as they are."""
        centre, pressure = (float(unknown) for unknown in start.unknowns[:2])
        turn = StripTurn(self.problem, centre, self._points)
        gaps = turn.gaps_of(start.strip), turn.gaps_of(start.alone)
        if not sampled:
            return self._on(turn, pressure, *gaps)
        return replace(self._settled(self._with(turn, pressure, *gaps, _How(_ROUGHLY, _ROUNDS))), kept=None)

    def _root(self, here: _Both) -> tuple[Root, Place | None]:
        """(from near by, its zones with what is missing where signs fail)."""
        # Beside gaps that are narrow for their zones the pressure is steep, and follows ends the more closely.
        tolerance = self.tolerance * min(1.0, _STEEP / here.strip.steepest)
        matrix, size, decay = here.matrix, np.array([here.room, here.pressure]), _COARSER * tolerance
        step, before = np.zeros(2), 0.0
        # Newton's steps by the exact profile and longer series, at the same rates, those of the misses put right by secants.
        for _ in range(_FINE_STEPS):
            (strip, of_strip, slopes), (alone, of_alone, slopes_alone) = (each.finely(decay) for each in (here.strip, here.alone))
            missed = here.misses + (here.alone.widening(alone) - here.strip.widening(strip), here.aside(strip))
            # What is missed by less than it is unsure tells nothing more.
            told = all(np.abs(own).max() <= of.max() for own, of in ((strip, of_strip), (alone, of_alone)))
            told &= bool((np.abs(missed) <= here.missed_by(of_strip, of_alone)).all())
            matrix = matrix + (np.outer(missed, step / size**2) / ((step / size) ** 2).sum() if step.any() and not told else 0.0)
            step = np.asarray(-np.linalg.solve(matrix, missed))
            by_strip, by_alone, largest = here.moved(step)
            # A step at rates that are kept leaves about as much of what is missed as the one before it has.
            rest, before = max(_RATES, min(float(np.linalg.norm(missed)) / before, 1.0) if before else 1.0), float(np.linalg.norm(missed))
            of_strip, of_alone = (of + rest * np.abs(by) for of, by in ((of_strip, by_strip), (of_alone, by_alone)))
            left = here.missed_by(of_strip, of_alone)
            inverse = np.asarray(np.linalg.inv(matrix))
            tables = [each.table + _outward(moved) for each, moved in ((here.strip, strip + by_strip), (here.alone, alone + by_alone))]
            turn = StripTurn(self.problem, here.centre + float(step[0]), self._points)
            pressure = here.pressure + float(step[1])
            largest = max(largest, _largest(here.strip, strip), _largest(here.alone, alone))
            # By what width and centre may be missed, beside what each end is off itself.
            by_misses = [here.strip.turn.of_zones(here.strip.table, _outward(here.moved(by)[0]), float(by[0])) for by in inverse.T]
            off = _MARGIN * np.tensordot(left, by_misses, 1)
            ends = _MARGIN * here.strip.turn.of_zones(here.strip.table, of_strip.T)
            if largest < _SQUARE and decay <= tolerance:
                settled = told or rest * largest < _SETTLED * tolerance
                if float((off + ends).max()) < _UNSURE * tolerance or (settled and decay <= _SHORTEST):
                    break
                decay *= _SHORTER if settled and decay > _SHORTEST else 1.0
            elif largest < _SHORT:
                decay = min(decay, tolerance)
            here = replace(self._on(turn, pressure, *tables), kept=here.rates)
        if largest > _SHORT:
            # Width and centre ask for the same there.
            raise Lost("the steps by the exact profile come to no rest")
        following = self._on(turn, pressure, *tables).following
        zones, alone = (turn.zones_of(table) for table in tables)
        unknowns = np.array([turn.centre, pressure, self.load])
        failing = here.strip.failing(slopes, _TOLD * largest), here.alone.failing(slopes_alone, _TOLD * largest)
        corrected = None
        if any(len(places) for signs in failing for places in signs):
            parts = (_corrected(each.table, *signs) for each, signs in zip((here.strip, here.alone), failing, strict=True))
            corrected = Place(unknowns, *(turn.zones_of(part) for part in parts))
        return Root(Place(unknowns, zones, alone), ends, left, inverse, following), corrected

    def _on(self, turn: StripTurn, pressure: float, strip: Array, alone: Array) -> _Both:
        """On gaps as they are."""
        added = 2 * turn.half * pressure / np.pi
        found = GapContact(turn, pressure, self.load / np.pi - added, strip), GapContact(turn, 0.0, added, alone)
        return _Both(turn.centre, pressure, *found)

    def _settled(self, here: _Both) -> _Both:
        """At the root, as nearly as samples tell it."""
        looked, halved, steps = True, math.inf, 0
        for _ in range(_STEPS):
            halved, steps = (here.far, 0) if here.far < 0.5 * halved else (halved, steps + 1)
            if steps > _STALLED:
                break
            largest = here.moved(here.step)[2]
            if largest < _THERE:
                if looked:
                    return here
                before, looked = here, True
                here = self._with(here.strip.turn, here.pressure, here.strip.table, here.alone.table, _How(_ENDS, _ROUNDS), here)
                if here.same_gaps(before):
                    return replace(here, kept=before.rates)
                continue
            looked = largest > _FAR
            before = here
            here = self._after(here, _How(min(max(_FINER * largest, _ENDS), _ROUGHLY), _ON_THE_WAY if looked else 0))
            if largest < _NEAR and here.same_gaps(before):
                here = replace(here, kept=before.rates)
        # The gap at a border is as wide in the angle as its intensity is large, and so goes straight with the unknowns.
        closes = float(here.closing(here.step).min()) <= -1.0
        why = Unrest.BORDER if closes and float(here.misses[0]) < -here.room else Unrest.LOST
        raise Lost("the nominal pressure did not settle", why)

    def _after(self, here: _Both, how: _How) -> _Both:
        """After a step, or as much of it as brings the root nearer, as the rates before it have that (P. Deuflhard, Newton Methods for
        Nonlinear Problems, 2004, section 3.1): with the last part of it in any case, since widths bend where gaps come and go."""
        size = np.array([here.room, here.pressure])
        beside, centre, pressure = here.closing(here.step), *np.abs(here.step)
        bold = [np.abs(beside).max() / _TRUSTED, centre / self._feature, pressure / (_LARGEST * here.pressure)]
        if self.carefully:
            moves = here.moved(here.step)[:2]
            bold += [_shrinking(each.table, by) / _PART for each, by in zip((here.strip, here.alone), moves, strict=True)]
        whole = 1 / max(1.0, *bold)
        step = whole * here.step
        there: _Both | None = None
        reason = Lost("")
        for halved in range(_HALVED + 1 if here.few else 1):
            part = 0.5**halved
            strip, alone, _ = here.moved(part * step)
            turn = StripTurn(self.problem, here.centre + part * float(step[0]), self._points)
            strip, alone = (spread(each.table, by, _PART) for each, by in ((here.strip, strip), (here.alone, alone)))
            try:
                there = self._with(turn, here.pressure + part * float(step[1]), strip, alone, how, here)
            except Lost as lost:
                reason = lost
                continue
            if np.linalg.norm(np.linalg.solve(here.matrix, there.misses) / size) <= (1 - 0.25 * part * whole) * here.far:
                break
        if there is None:
            raise reason
        return there

    def _with(self, turn: StripTurn, pressure: float, strip: Array, alone: Array, how: _How, like: _Both | None = None) -> _Both:
        """From about such gaps. like: the ones before."""
        like_strip, like_alone = (None, None) if like is None else (like.strip.found, like.alone.found)
        begun = self._on(turn, pressure, strip, alone)
        found = _contact(begun.strip, how, like_strip)
        if found.borders is None:
            raise Lost("the strip reaches its border", Unrest.BORDER)
        return replace(begun, strip=found, alone=_contact(begun.alone, how, like_alone))

    @cached_property
    def _feature(self) -> float:
        """The scaled length on which the profile varies."""
        profile = self.problem.profile
        assert profile.period is not None
        return (profile.feature or profile.period / 16) / self.problem.units.length

    @cached_property
    def _points(self) -> int:
        assert self.problem.period is not None
        features = self.problem.period / self._feature
        return 2 ** int(np.clip(np.ceil(np.log2(_CLOSE * features)), math.log2(_FEWEST), math.log2(_MOST)))


def _outward(moved: Array) -> Array:
    """Outward moves (2, n) as changes of a table (n, 2)."""
    return np.asarray(np.column_stack((-moved[0], moved[1])))


def _shrinking(table: Array, moved: Array) -> float:
    """The largest part of a gap of a turn, or of what is between two, that goes in outward moves (2, n). Near its end one goes with the
    root of what is left until then: of one that is to lose a half, all goes."""
    between = np.diff(gaps_between(table, TURN))[:, 0]
    parts = -moved.sum(axis=0) / np.diff(table)[:, 0], (moved[1] + np.roll(moved[0], -1)) / between
    return float(max(part.max() for part in parts))


def _largest(gaps: GapContact, moved: Array) -> float:
    return float((np.abs(moved.T) / room_beside(gaps.table, TURN)).max())


def _contact(begun: GapContact, how: _How, like: sie.AnyState | None) -> GapContact:
    """From about its gaps, with those that its signs ask for. like: one that was found on about the same."""
    equation, table = begun.equation, begun.table
    for look in range(how.looks + 1):
        if len(table) == 0:
            raise Lost("no gap", Unrest.BORDER)
        try:
            zones = sie.Zones.of(table)
            free = sie.find_ends(
                equation, zones, how.tolerance, _NEWTON, signs=(1.0, -1.0), drops=True, decay=how.decay, bounded_ends=False, like=like
            )
        except (ValueError, sie.SingularSystem) as e:
            raise Lost(str(e)) from e
        if not free.converged and look == how.looks:
            raise Lost(free.reason)
        found, like = replace(begun, table=free.density.zones.table, found=free.state), free.state
        if look == how.looks:
            # Where that does not settle it is looked at once more at the root.
            return found
        pulls, overlaps = _signs(found)
        if len(pulls) == 0 and len(overlaps) == 0:
            if not free.converged:
                raise Lost(free.reason)
            return found
        table = _corrected(found.table, pulls, overlaps)
    raise AssertionError


def _corrected(table: Array, pulls: Array, overlaps: Array) -> Array:
    """Gaps with those that are missing, without what is in contact."""
    try:
        table = united(np.concatenate((without(table, overlaps), pulls)), TURN, True, "gap")
    except WrongTopology as e:
        raise Lost(str(e)) from e
    table = centred_on(table, np.pi - 1e-3, TURN)
    return table[np.argsort(table[:, 0])]


def _signs(found: GapContact) -> tuple[Array, Array]:
    """(where the pressure pulls, where the gap is negative) on even samples of half a turn, of which the other is the mirror image."""
    turn, density = found.turn, found.state.density
    zones = density.zones
    every = max(1, turn.points // _SAMPLES)
    angle = turn.angles[::every]
    inside = density.locate(angle)[2]
    pressure = found.mean - turn.relief_at(angle) + found.beyond * turn.half * np.sin(angle) + density.transform(angle)
    pulls = ~inside & (pressure < -_NONE * np.abs(pressure[~inside]).max(initial=0.0))
    angle, pulls = np.concatenate((angle, TURN - angle[::-1])), np.concatenate((pulls, pulls[::-1]))
    # From a place in a gap on none is cut in two.
    first = int(np.searchsorted(angle, zones.a[0] % TURN))
    pulls = _runs(np.roll(pulls, -first), zones.a[0] + (np.roll(angle, -first) - zones.a[0]) % TURN)
    overlaps: list[Array] = []
    mirrored: list[Array] = []
    for k in np.flatnonzero(zones.a < np.pi):
        count = int(np.clip((zones.b[k] - zones.a[k]) / (angle[1] - angle[0]), 32, 1024))
        at = np.pi * (np.arange(count) + 0.5) / count
        # The gap from its nearer end on.
        rise = density.at(k, 2 * np.cos(at / 2) ** 2, 2 * np.sin(at / 2) ** 2)[::-1] * np.sin(at)
        gap = np.where(at < np.pi / 2, np.cumsum(rise), -np.cumsum(rise[::-1])[::-1])
        overlaps.append(_runs(gap < -_OVERLAP * np.abs(gap).max(), zones.middle[k] - zones.half[k] * np.cos(at)))
        if 0.0 < zones.a[k] and zones.b[k] < np.pi:
            mirrored.append(TURN - overlaps[-1][::-1, ::-1])
    return pulls, np.concatenate((*overlaps, *mirrored[::-1]))


def _runs(where: Array, angle: Array) -> Array:
    """From the first to the last of each run of samples, and half a step on."""
    change = np.flatnonzero(np.diff(np.concatenate(([False], where, [False])).astype(np.int8)))
    first, last = change[::2], change[1::2] - 1
    half = 0.5 * np.gradient(angle)
    return np.column_stack((angle[first] - half[first], angle[last] + half[last]))
