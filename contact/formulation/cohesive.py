r"""Curves of equilibria under a law that pulls with a constant tension s where the gap is below its reach h.

The ends c of the intervals I = {gap < h} are the unknowns. Under the tension on given I the contact is the frictionless one of a deformed
profile (contact.formulation.tension): convex, its zones unique. By an outward motion of an end the energy changes by -s (h - gap(c)) ds, so

    r = 1 - gap(c)/h,   J = dr/ds = -(1/h) d gap(c)/ds,

play the part that the intensities have in `equilibria`: tension anywhere brings the surfaces nearer everywhere, hence J is positive off its
diagonal, the map I -> {gap < h} keeps order, and from intervals all of whose ends are driven outward they advance to the least equilibrium
that holds them. In J the zones follow: what an end of I adds is a unit source at c, to first order answered by the density of zones that
are held with singular ends, whose intensities move these by 2 K/A.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sie
from contact.errors import NotConverged, OutOfRange
from contact.formulation import equilibria
from contact.formulation.controls import Control, Load
from contact.formulation.equilibria import Closed, Equilibria, Point
from contact.formulation.fields import ZoneFields
from contact.formulation.maxima import maximum
from contact.formulation.problem import Problem
from contact.formulation.tension import Pulled

Array = NDArray[np.float64]

# Newton's steps of the zones under a given tension, and how often their number may change.
_STEPS, _ROUNDS = 80, 16
# After so many changes of their number the zones are left to the engine's search.
_PLAIN = 3
# A zone's end moves at most by these parts of its width, and of the gap beside it; it comes so much nearer to the end of its interval.
_INWARD, _OUTWARD, _INTO_GAP, _NEARER = 0.3, 0.5, 0.45, 0.25
# Of what an end was off by, from which on Newton's steps only take it to and fro.
_AS_FAR = 0.3
# What rounding may leave of a step, over the strip of tension beside an end.
_ROUNDED = 1e-5
# So near to the end of its interval, over its width, a zone that goes on covers it.
_COVERED = 1e-6
# A zone narrower than this part of what it was, and a gap beside which both ends go on, are gone.
_GONE = 1e-3
# Of the overlap in which a new zone begins, and of the part of a gap below the reach in which a new interval does.
_NEW = 0.5
# Points between two zones, or in a part of an interval, at the least, and at the most; how far from the zones of a lone body.
_FEWEST, _MOST, _FAR = 24, 20000, 1e3
_TRIES = 6
# Steps along the arc that are shorter, beside a state without contact, are not looked at for a turning point.
_SHORTEST = 1e-6
# Of the control, until the gap somewhere comes to the reach.
_HALVINGS = 60
# Over the width of an interval, how far an end goes that contact covers as others advance.
_FARTHER = 0.01
# States that are remembered.
_KNOWN = 256
# Angles of a zone at which the sign of q is looked at, at the most, where the profile does not vary faster.
_SIGNS = 128


TOO_NARROW = (
    "the tension would act on strips narrower than a millionth of the zones beside them: under so large a stress adhesion is without range"
)


class Lost(Exception):
    """No contact is left under a tension."""


class Covered(Exception):
    """Contact goes on to the ends of intervals of tension. ends: which (2m,)."""

    def __init__(self, ends: NDArray[np.bool_]) -> None:
        super().__init__("contact reaches the end of an interval of tension")
        self.ends = ends


@dataclass(frozen=True, eq=False)
class CohesivePoint(Point):
    """table: the intervals I; zones: the contact within them (n, 2); fields: of q; by_ends, level_rates: motions of the zones' ends (2n,),
    and of the level, by those of I and by the value of the control, the last column; look: sampled places without contact, ascending, and the gap there."""

    zones: Array
    fields: ZoneFields
    by_ends: Array
    level_rates: Array
    look: tuple[Array, Array]

    @property
    def rate(self) -> float:
        """d load/d approach on the curve of equilibria, of a state under a held load."""
        ends = np.linalg.solve(-self.rates, self.by_value)
        return float(-1.0 / (self.level_rates[-1] + self.level_rates[:-1] @ ends))

    @property
    def contact(self) -> Array:
        return self.zones


@dataclass(frozen=True, eq=False)
class Known:
    """Of a state, what first guesses of others come from."""

    table: Array
    value: float
    zones: Array
    by_ends: Array


@dataclass(frozen=True, eq=False)
class Everywhere(Point):
    """Under tension in all of a period: there are no ends of it."""

    zones: Array

    @classmethod
    def of(cls, curve: Cohesive, fields: ZoneFields, value: float) -> Everywhere:
        none = np.zeros(0)
        load = fields.density.total - curve.everywhere.pulling.total
        zones = fields.density.zones.table
        return cls(np.zeros((0, 2)), value, none, np.zeros((0, 0)), none, load, float(fields.level), zones)

    @property
    def contact(self) -> Array:
        return self.zones


@dataclass(frozen=True)
class Cohesive(Equilibria):
    """Those of a problem whose law has a tension and a reach, both scaled here."""

    problem: Problem
    kind: type[Control]
    last: dict[str, Any] = field(default_factory=dict, compare=False, repr=False)

    @cached_property
    def stress(self) -> float:
        return self.problem.law.tension / self.problem.units.pressure

    @cached_property
    def reach(self) -> float:
        return self.problem.law.reach / self.problem.units.height

    @property
    def everywhere(self) -> Pulled:
        """The problem under tension in all of a period."""
        return Pulled.of(self.problem, self.stress, np.zeros((0, 2)), everywhere=True)

    # one state --------------------------------------------------------------------------------------------------------
    def advanced(self, table: Array, value: float) -> Point:
        try:
            return super().advanced(table, value)
        except Covered as covered:
            raise NotConverged(TOO_NARROW) from covered

    def at(self, table: Array, value: float, tolerance: float = 1e-13) -> CohesivePoint:
        """The contact under the tension on given intervals; zones are looked for from those of the last state."""
        return self.from_zones(table, value, _followed(self._nearest(table), table, value, self.problem.period))

    def _nearest(self, table: Array) -> Known:
        """Of the states known, the one of the nearest intervals as many as these; else the last."""
        known = self.last["known"]
        alike = [one for one in known if one.table.shape == table.shape]
        return min(reversed(alike), key=lambda one: float(np.abs(one.table - table).max())) if alike else known[-1]

    def from_zones(self, table: Array, value: float, zones: Array) -> CohesivePoint:
        """The same from a first guess of the zones."""
        lo, hi = self.problem.borders
        if table[0, 0] <= lo or table[-1, 1] >= hi:
            raise OutOfRange("the tension reaches the border of the part of the profile that is known")
        pulled = Pulled.of(self.problem, self.stress, table)
        fields, look = self.contact(pulled, value, zones)
        point = self._point(table, value, fields, look)
        self.last["point"] = point
        known = self.last.setdefault("known", [])
        known.append(Known(table, value, point.zones, point.by_ends))
        del known[:-_KNOWN]
        return point

    def control(self, pulled: Pulled, value: float) -> Control:
        """That of q: its load has the tension, too."""
        return self.kind(value + pulled.pulling.total) if self.kind is Load else self.kind(value)

    def contact(self, pulled: Pulled, value: float, zones: Array) -> tuple[ZoneFields, tuple[Array, Array]]:
        """(fields of q on the zones of contact under a tension, the gap beside them)."""
        control = self.control(pulled, value)
        if control.load is not None and not control.load > 0.0:
            raise Lost
        for done in range(_ROUNDS):
            # Where narrow gaps close or open within an interval, their ends act on each other: the engine's own steps know how.
            state = (self._settled if done < _PLAIN else self._searched)(pulled, control, zones)
            fields = ZoneFields(pulled, state)
            look = self._look(fields)
            found = _corrected(fields, look)
            if found is None:
                return fields, look
            zones = fitted(found, pulled.pulling.table, self.problem.period, pulled.pulling.everywhere)
            if len(zones) == 0:
                raise Lost
        raise NotConverged("the zones under a given tension did not settle")

    def _settled(self, pulled: Pulled, control: Control, zones: Array) -> sie.State:
        """Newton on the ends of zones whose number is given, or falls."""
        equation, first = pulled.equation(control), np.diff(zones, axis=1)[:, 0]
        before: tuple[Array, Array] | None = None
        best, stuck = np.inf, 0
        for _ in range(_STEPS):
            state = sie.solve_fixed(equation, sie.Zones.of(zones, pulled.end, pulled.end), 1e-14)
            k, slope = np.array(state.density.intensities), np.array(state.density.edge_slopes)
            width, (room, shared) = np.diff(zones, axis=1)[:, 0], self._room(pulled, zones)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = np.where(slope > 0, 2 * k / slope, np.copysign(np.inf, k))
            if before is not None and len(before[0]) == len(zones):
                # An end that has gone too far, and nearly as far as it was off, is between its last two places.
                back = np.array([zones[:, 0] - before[0][:, 0], before[0][:, 1] - zones[:, 1]])
                turned = (k * before[1] < 0) & (np.abs(k) > _AS_FAR * np.abs(before[1]))
                step = np.where(turned, back * k / np.where(turned, k - before[1], 1.0), step)
            before = zones, k
            # Beside the end of an interval K goes with the root of the distance from there.
            alone = ~shared & np.isfinite(step) & (room > 0)
            own = np.where(alone, room, 1.0)
            near = np.clip(1 - np.where(alone, step, 0.0) / (2 * own), np.sqrt(_NEARER), 4.0)
            rooted = np.where(alone, own * (1 - near**2), step)
            step = np.where(np.abs(step) < 0.1 * room, step, rooted)
            least = np.minimum(width, np.where(shared, np.inf, np.maximum(room, 1e-300)))
            miss = float(np.abs(step / least).max())
            best, stuck = min(best, miss), stuck + 1 if miss > 0.5 * best else 0
            # Of narrow strips rounding leaves more.
            if miss < 1e-11 or (stuck > 2 and miss < _ROUNDED):
                return state
            covers = ~shared & (room < _COVERED * width) & (step > 0.5 * room)
            if covers.any():
                i = _interval_of(zones, pulled.pulling.table)
                ends = np.zeros((2, len(pulled.pulling.table)), dtype=bool)
                for side in (0, 1):
                    ends[side, i[covers[side]]] = True
                raise Covered(ends.ravel())
            limit = np.minimum(_OUTWARD * width, np.where(shared, _INTO_GAP, 1 - _NEARER) * room)
            moved = np.clip(step, -_INWARD * width, limit)
            if float(np.abs(moved / least).max()) < 1e-9:
                zones = zones + np.column_stack((-moved[0], moved[1]))
                return sie.solve_fixed(equation, sie.Zones.of(zones, pulled.end, pulled.end), 1e-14)
            lost = (width < _GONE * first) & (step < -_INWARD * width).all(axis=0)
            if lost.any():
                if lost.all():
                    raise Lost
                zones, first = zones[~lost], first[~lost]
                continue
            zones = zones + np.column_stack((-moved[0], moved[1]))
            zones, first = self._joined(pulled, zones, first, step)
        raise NotConverged("the ends of zones under a given tension did not come to rest")

    def _searched(self, pulled: Pulled, control: Control, zones: Array) -> sie.AnyState:
        """The same by the engine's search, of zones that stay within their intervals."""
        equation, table, everywhere = pulled.equation(control), pulled.pulling.table, pulled.pulling.everywhere
        for _ in range(_ROUNDS):
            free = sie.find_ends(equation, sie.Zones.of(zones, pulled.end, pulled.end), 1e-10)
            ended = free.density.zones.table
            if len(free.lost):
                if len(free.lost) == len(ended):
                    raise Lost
                zones = np.delete(ended, free.lost, axis=0)
            elif len(free.met):
                inner = [i for i in free.met if i + 1 < len(ended)]
                begins, ends = np.ones(len(ended), dtype=bool), np.ones(len(ended), dtype=bool)
                begins[[i + 1 for i in inner]], ends[inner] = False, False
                zones = np.column_stack((ended[begins, 0], ended[ends, 1]))
            else:
                i = _interval_of(ended, table) if len(table) else np.zeros(len(ended), dtype=np.intp)
                within = everywhere or len(table) == 0 or bool(np.all((ended[:, 0] > table[i, 0]) & (ended[:, 1] < table[i, 1])))
                return free.state if free.converged and within else self._settled(pulled, control, zones)
        raise NotConverged("the number of zones under a given tension did not settle")

    def _room(self, pulled: Pulled, zones: Array) -> tuple[Array, NDArray[np.bool_]]:
        """(how far each end (2, n) is from what is next to it, whether that is another zone: else the end of its interval)."""
        period, tension = self.problem.period, pulled.pulling
        if period is None:
            gaps = np.concatenate(([np.inf], zones[1:, 0] - zones[:-1, 1], [np.inf]))
        else:
            inner = zones[1:, 0] - zones[:-1, 1]
            around = zones[0, 0] + period - zones[-1, 1]
            gaps = np.concatenate(([around], inner, [around]))
        beside = np.array([gaps[:-1], gaps[1:]])
        if tension.everywhere or len(tension.table) == 0:
            return beside, np.ones(beside.shape, dtype=bool)
        i = _interval_of(zones, tension.table)
        away = np.array([zones[:, 0] - tension.table[i, 0], tension.table[i, 1] - zones[:, 1]])
        return np.minimum(beside, away), beside < away

    def _joined(self, pulled: Pulled, zones: Array, first: Array, step: Array) -> tuple[Array, Array]:
        """Zones between which nothing is left as one."""
        gap = zones[1:, 0] - zones[:-1, 1]
        width = np.diff(zones, axis=1)[:, 0]
        meets = (gap < _GONE * np.minimum(width[1:], width[:-1])) & (step[1, :-1] > 0.3 * gap) & (step[0, 1:] > 0.3 * gap)
        if not meets.any():
            return zones, first
        begins, ends = np.append(True, ~meets), np.append(~meets, True)
        return np.column_stack((zones[begins, 0], zones[ends, 1])), first[begins]

    def _look(self, fields: ZoneFields) -> tuple[Array, Array]:
        """(places without contact, the gap there)."""
        zones, pulled = fields.density.zones.table, fields.problem
        assert isinstance(pulled, Pulled)
        table, period = pulled.pulling.table, self.problem.period
        lo, hi = self.problem.borders
        if period is not None:
            left, right = [float(zones[-1, 1]) - period], [float(zones[0, 0]) + period]
            edges = [(float(b), float(a)) for b, a in zip(zones[:, 1], [*zones[1:, 0], right[0]], strict=True)]
            marks = np.concatenate((table.ravel(), table.ravel() + period, table.ravel() - period))
        else:
            both = np.concatenate((table.ravel(), zones.ravel()))
            span = float(both.max() - both.min())
            left, right = [max(lo, both.min() - _FAR * span)], [min(hi, both.max() + _FAR * span)]
            edges = [(float(b), float(a)) for b, a in zip([*left, *zones[:, 1]], [*zones[:, 0], *right], strict=True)]
            marks = table.ravel()
        spacing = fields.spacing if self.problem.profile.resolution is not None else np.inf
        found = []
        for begin, end in edges:
            cuts = np.concatenate(([begin], np.sort(marks[(marks > begin) & (marks < end)]), [end]))
            for a, b in zip(cuts[:-1], cuts[1:], strict=True):
                found.append(_places(float(a), float(b), 0.25 * spacing))
        x = np.concatenate(found)
        return x, fields.formal_gap(x)

    # how it follows ---------------------------------------------------------------------------------------------------
    def _point(self, table: Array, value: float, fields: ZoneFields, look: tuple[Array, Array]) -> CohesivePoint:
        pulled, state = fields.problem, fields.state.whole
        assert isinstance(pulled, Pulled)
        tension, density, count = pulled.pulling, state.density, len(table)
        at = np.concatenate((table[:, 0], table[:, 1]))
        strengths = np.hstack((self.stress * np.eye(2 * count), np.zeros((2 * count, 1))))
        values = np.zeros((len(state.condition_scale), 2 * count + 1))
        first = state.condition_index[0]
        by_load = self.kind is Load
        if by_load:
            values[first, :-1], values[first, -1] = self.stress, 1.0
        else:
            values[first : first + len(density.zones), -1] = -1.0
        answers = sie.answers(state, at, strengths, values, at)
        level = answers.levels.mean(axis=0) if by_load else np.append(np.zeros(2 * count), -1.0)
        change = level - answers.potentials
        matrix = change[:, :-1]
        between = self._explicit(pulled, at, density.transform(at))
        gap = fields.formal_gap(at)
        with np.errstate(divide="ignore"):
            moved = 2 * answers.intensities / np.array(density.edge_slopes)[:, :, None]
        return CohesivePoint(
            table, value, 1 - gap / self.reach, -(matrix + between) / self.reach, -change[:, -1] / self.reach,
            density.total - tension.total, float(fields.level), density.zones.table, fields, moved.reshape(-1, 2 * count + 1), level, look,
        )

    # growing and shrinking --------------------------------------------------------------------------------------------
    def receded(self, table: Array, value: float) -> Point | None:
        try:
            return self._flowed(self._held(table, value), value, -1.0)
        except Lost:
            return None

    def _held(self, table: Array, value: float) -> Array:
        """The intervals, with ends that contact covers taken back to where they come from."""
        before = self._nearest(table).table
        for _ in range(_TRIES):
            try:
                self.at(table, value)
                break
            except Covered as covered:
                if len(before) != len(table):
                    raise
                table = np.where(covered.ends.reshape(2, -1).T, 0.5 * (table + before), table)
        return table

    def _flowed(self, table: Array, value: float, sign: float) -> CohesivePoint | None:
        here = self.at(table, value)
        for _ in range(equilibria._MOST_STEPS):
            new = self._parted(here) if sign < 0 else self._grown(here)
            if new is not None:
                if len(new) == 0:
                    return None
                here = self.from_zones(new, value, fitted(here.zones, new, self.problem.period))
                continue
            ahead, move = self._step(here, sign)
            assert isinstance(ahead, CohesivePoint)
            here = ahead
            if move <= equilibria._REST and np.abs(here.residual).max() <= equilibria._DRIVEN:
                return here
        raise NotConverged("the ends of the tension did not come to rest under a held control")

    def _step(self, here: Point, sign: float) -> tuple[Point, float]:
        limit, back = self._limits(here, sign)
        lost, beyond = 0, np.zeros(len(limit))
        for _ in range(equilibria._MOST_TRIES):
            step = equilibria._kept_step(here, sign, limit, back) + beyond
            try:
                ahead = self.at(here.moved(step), here.value)
            except Lost:
                lost += 1
                if lost > _TRIES:
                    raise
                limit = 0.3 * np.minimum(limit, np.abs(step))
                continue
            except Covered as covered:
                # What has gone too far inward goes less far; what others have pushed out goes farther.
                if sign < 0:
                    limit = np.where(covered.ends, 0.5, 0.9) * np.minimum(limit, np.abs(step))
                else:
                    beyond = np.where(covered.ends, 2 * beyond + _FARTHER * here.widths, beyond)
                continue
            finally:
                self.last["point"] = here
            passed = equilibria._passed(here, ahead, step, sign)
            if not passed.any():
                self.last["point"] = ahead
                # Short of where contact is lost it is not at rest.
                return ahead, float(np.abs(step / here.widths).max()) if lost == 0 else np.inf
            kept = np.where(passed | (here.growth >= 0.0), 0.5, 0.9)
            limit = kept * np.minimum(limit, np.maximum(np.abs(step), 1e-12 * here.widths))
        raise NotConverged("no step of the ends keeps to the branch")

    def _grown(self, here: CohesivePoint) -> Array | None:
        """The intervals with new ones, and with those as one between which the gap is below the reach; None if there are none."""
        (x, gap), table, period = here.look, here.table, self.problem.period
        closed = super()._merged(here)
        if closed is not None:
            return closed
        new, joins = [], np.zeros(len(table), dtype=bool)
        for i, (a, b) in enumerate(self._outside(table)):
            inner = _within(x, a, b, period)
            below = gap[inner] < self.reach
            if len(inner) and below.all() and np.isfinite(a) and np.isfinite(b):
                joins[i - (period is None)] = True
                continue
            for s, e in _runs(below):
                if s > 0 and e < len(inner) - 1:
                    place = _unwrapped(x[inner], a, b, period)
                    lo, hi = place[s - 1], place[e + 1]
                    middle, half = 0.5 * (place[s] + place[e]), 0.5 * _NEW * max(place[e] - place[s], 0.1 * (hi - lo))
                    new.append((middle - half, middle + half))
        if not new and not joins.any():
            return None
        if joins.all() and period is not None:
            raise Closed
        return _joined_table(np.asarray(table), joins, new, period)

    def _parted(self, here: CohesivePoint) -> Array | None:
        """The intervals without parts over which the gap is above the reach, but those that begin at their ends; None if there are none."""
        (x, gap), table, period = here.look, here.table, self.problem.period
        out, changed = [], False
        for a, b in table:
            inner = _within(x, a, b, period)
            above = gap[inner] > self.reach
            if len(inner) and above.all() and not np.any(_interval_of(here.zones, table) == len(out)) and not self._holds(here, a, b):
                changed = True
                continue
            left = a
            place = _unwrapped(x[inner], a, b, period)
            for s, e in _runs(above):
                if s > 0 and e < len(inner) - 1:
                    out.append((left, place[s - 1]))
                    left, changed = place[e + 1], True
            out.append((left, b))
        return np.array(out).reshape(-1, 2) if changed else None

    def _holds(self, here: CohesivePoint, a: float, b: float) -> bool:
        return bool(np.any((here.zones[:, 0] > a) & (here.zones[:, 1] < b)))

    def _outside(self, table: Array) -> list[tuple[float, float]]:
        """Between the intervals: with a period the last one ends at the first interval of the next."""
        if self.problem.period is not None:
            return list(zip(table[:, 1], np.append(table[1:, 0], table[0, 0] + self.problem.period), strict=True))
        return list(zip(np.append(-np.inf, table[:, 1]), np.append(table[:, 0], np.inf), strict=True))

    # where contact ends -----------------------------------------------------------------------------------------------
    def pull_off(self, here: Point) -> Point:
        """Where the last zones come apart as the control falls: at a turning point, or where the last of them has shrunk to a point."""
        self.last["point"], self.last["lost"] = here, False
        try:
            return super().pull_off(here)
        except Covered as covered:
            raise NotConverged(TOO_NARROW) from covered
        except NotConverged:
            if not self.last["lost"]:
                raise
        return self._touching(self.last["point"])

    def pull_off_from_all(self, zones: Array, value: float) -> Point:
        """The same of a contact under tension everywhere: from where the gap somewhere comes to its reach, or to the last touch."""
        problem, pulled = self.problem, self.everywhere
        assert problem.period is not None
        lost = -pulled.pulling.total if self.kind is Load else -self.stress * problem.compression
        high, found, opened = value, self.contact(pulled, value, zones), False
        low = lost
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if middle in (low, high) or high - low < 1e-14 * (value - lost):
                break
            try:
                here = self.contact(pulled, middle, found[0].density.zones.table)
            except Lost:
                low = middle
                continue
            if here[1][1].max() > self.reach:
                low, opened = middle, True
            else:
                high, found = middle, here
        fields, (x, gap) = found
        state = Everywhere.of(self, fields, high)
        if not opened:
            return state
        # At the place that comes to the reach first the tension lets go.
        inside = fields.density.zones.table
        table = below(inside, (x, np.where(gap == gap.max(), 2 * self.reach, gap)), self.reach, problem.period, wide=True)
        try:
            self.from_zones(table, high, fitted(inside, table, problem.period))
        except Lost:
            return state
        rest = self.receded(table, high - 1e-9 * (value - lost))
        return state if rest is None else self.pull_off(rest)

    def _along(self, here: Point, tangent: Array, length: float, unit: float) -> Point | None:
        if self.last["lost"] and length < _SHORTEST:
            raise NotConverged("contact is lost before a turning point")
        self.last["point"] = here
        try:
            ahead = super()._along(here, tangent, length, unit)
        except Lost:
            self.last["lost"] = True
            ahead = None
        except Covered:
            ahead = None
        if ahead is None:
            self.last["point"] = here
        return ahead

    def _touching(self, here: CohesivePoint) -> CohesivePoint:
        """The equilibrium beside one of hardly any contact in which the surfaces touch in one point, without pressure."""
        table, at = here.table, float(here.zones.mean())
        half = 0.02 * float(np.diff(table, axis=1).max())
        for _ in range(_STEPS):
            pulled = Pulled.of(self.problem, self.stress, table)
            at, height = maximum(lambda x, pulled=pulled: -pulled.shape(np.asarray(x)), np.linspace(at - half, at + half, 65))
            ends, tension = np.concatenate((table[:, 0], table[:, 1])), pulled.pulling
            gap = pulled.shape(ends) + height
            rates = self._explicit(pulled, ends, np.zeros(len(ends))) - self.stress / np.pi * tension.log(at - ends)
            step = np.linalg.solve(rates, self.reach - gap)
            table = table + np.column_stack((-step[: len(table)], step[len(table) :]))
            if float(np.abs(step).max()) < 1e-14 * float(np.diff(table, axis=1).min()):
                break
        load, level = -pulled.pulling.total, height
        value = load if self.kind is Load else -level
        return replace(here, table=table, value=value, load=load, level=float(level), zones=np.array([[at, at]]))

    def _explicit(self, pulled: Pulled, at: Array, transform: Array) -> Array:
        """Rates of the gap at the ends of the tension by their outward motions, but for what the contact answers; transform: of q there."""
        tension, count = pulled.pulling, len(at) // 2
        table = tension.table
        lag = at[:, None] - at
        np.fill_diagonal(lag, 1.0)
        between = self.stress / np.pi * tension.log(lag)
        own = np.concatenate((tension.log(table[:, 1] - table[:, 0]),) * 2) * self.stress / np.pi
        others = np.array([tension.others(j % count, float(x)) for j, x in enumerate(at)])
        outward = np.concatenate((-np.ones(count), np.ones(count)))
        np.fill_diagonal(between, own + outward * (pulled.own_slope(at) - transform + others))
        return between


# zones and intervals --------------------------------------------------------------------------------------------------
def _places(a: float, b: float, spacing: float) -> Array:
    """Points in (a, b), closer beside its ends."""
    count = int(np.clip((b - a) / spacing, _FEWEST, _MOST))
    return a + (b - a) * np.sin(0.5 * np.pi * (np.arange(count) + 0.5) / count) ** 2


def _within(x: Array, a: float, b: float, period: float | None) -> NDArray[np.intp]:
    """Which places lie in (a, b), from left to right."""
    place = _unwrapped(x, a, b, period)
    inner = np.flatnonzero((place > a) & (place < b))
    return np.asarray(inner[np.argsort(place[inner])])


def _unwrapped(x: Array, a: float, b: float, period: float | None) -> Array:
    return x if period is None else x - np.floor((x - a) / period) * period


def _runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    change = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    return [(int(s), int(e) - 1) for s, e in zip(change[::2], change[1::2], strict=True)]


def _interval_of(zones: Array, table: Array) -> NDArray[np.intp]:
    """The interval that each zone lies in."""
    return np.maximum(np.searchsorted(table[:, 0], zones.mean(axis=1), side="right") - 1, 0)


def fitted(zones: Array, table: Array, period: float | None, everywhere: bool = False) -> Array:
    """Zones moved by periods into intervals, and cut to lie within."""
    if everywhere or len(table) == 0:
        return zones[np.argsort(zones[:, 0])]
    out = []
    for a, b in zones:
        middle = 0.5 * (a + b)
        shift = 0.0 if period is None else -np.floor((middle - table[0, 0]) / period) * period
        a, b, middle = a + shift, b + shift, middle + shift
        i = max(int(np.searchsorted(table[:, 0], middle, side="right")) - 1, 0)
        lo, hi = table[i]
        if middle >= hi or middle <= lo:
            continue
        slack = 1e-2 * (hi - lo)
        a, b = (max(a, lo + slack) if a <= lo else a), (min(b, hi - slack) if b >= hi else b)
        if a < b:
            out.append((a, b))
    found = np.array(out).reshape(-1, 2)
    return np.asarray(found[np.argsort(found[:, 0])])


def below(zones: Array, look: tuple[Array, Array], reach: float, period: float | None, wide: bool = False) -> Array:
    """Intervals about zones in which the gap is below the reach, by its samples beside these, and up to half of the way to where it is told
    to be equal; wide: beyond that. Closed where it is so everywhere."""
    ends = zones.ravel() if period is None else np.append(zones.ravel(), zones[0] + period)
    x, gap = np.concatenate((look[0], ends)), np.concatenate((look[1], np.zeros(len(ends))))
    order = np.lexsort((gap, x))
    x, gap = x[order], gap[order]
    runs = _runs(gap < reach)
    if period is not None and len(runs) == 1 and runs[0] == (0, len(x) - 1):
        raise Closed
    if period is None and (runs[0][0] == 0 or runs[-1][1] == len(x) - 1):
        raise OutOfRange("the tension reaches the border of the part of the profile that is known")

    def crossing(inner: int, outer: int) -> float:
        way = (reach - gap[inner]) / (gap[outer] - gap[inner]) if np.isfinite(gap[outer]) else 0.0
        way = 0.5 * (1 + way) if wide else 0.5 * way
        return float(x[inner] + (x[outer] - x[inner]) * way)

    out = [[crossing(s, s - 1) if s else np.nan, crossing(e, e + 1) if e < len(x) - 1 else np.nan] for s, e in runs]
    if np.isnan(out[0][0]):
        assert period is not None
        out[0][0] = out.pop()[0] - period
    return np.array(out)


def _followed(before: Known, table: Array, value: float, period: float | None) -> Array:
    """Where the zones of a state are about to be after its intervals and the value have moved."""
    zones = before.zones
    if len(before.table) != len(table):
        return fitted(zones, table, period)
    outward = np.concatenate((before.table[:, 0] - table[:, 0], table[:, 1] - before.table[:, 1]))
    move = before.by_ends @ np.append(outward, value - before.value)
    count = len(zones)
    width = np.diff(zones, axis=1)[:, 0]
    i = _interval_of(zones, before.table)
    left = np.clip(move[:count], -0.4 * width, None)
    right = np.clip(move[count:], -0.4 * width, None)
    new = zones + np.column_stack((-left, right))
    # Nearer to the end of an interval than a part of what it was a zone does not come at once.
    room = np.array([zones[:, 0] - before.table[i, 0], before.table[i, 1] - zones[:, 1]])
    new[:, 0] = np.maximum(new[:, 0], table[i, 0] + 0.2 * room[0])
    new[:, 1] = np.minimum(new[:, 1], table[i, 1] - 0.2 * room[1])
    middle, share = 0.5 * (zones[1:, 0] + zones[:-1, 1]), 1e-3 * (zones[1:, 0] - zones[:-1, 1])
    new[1:, 0], new[:-1, 1] = np.maximum(new[1:, 0], middle + share), np.minimum(new[:-1, 1], middle - share)
    if np.any(new[:, 1] <= new[:, 0]) or np.any(new[1:, 0] <= new[:-1, 1]):
        return fitted(zones, table, period)
    return np.asarray(new)


def _corrected(fields: ZoneFields, look: tuple[Array, Array]) -> Array | None:
    """Zones with pulling parts cut out and new ones where the surfaces overlap; None where there are no such places."""
    density, (x, gap) = fields.density, look
    zones, out, changed = density.zones, [], False
    varies = fields.spacing if fields.problem.profile.resolution is not None else np.inf
    # Beside the ends, where the tension bends it sharply, q does not change its sign.
    counts = np.minimum(density.sampling, np.maximum(_SIGNS, 8 * zones.half / varies).astype(np.intp))
    for i, n in enumerate(counts):
        theta = (np.arange(n) + 0.5) * np.pi / n
        left, right = 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2
        q = density.at(np.full(n, i), left, right)[::-1] / np.sqrt(left * right)
        place = zones.a[i] + zones.half[i] * left[::-1]
        begin = float(zones.a[i])
        for s, e in _runs(q < -1e-9 * np.abs(q).max()):
            changed = True
            if s > 0:
                out.append((begin, float(0.5 * (place[s] + place[s - 1]))))
            begin = float(0.5 * (place[e] + place[e + 1])) if e < n - 1 else np.inf
        if np.isfinite(begin):
            out.append((begin, float(zones.b[i])))
    rounding = fields.gap_rounding + 2 * float(np.abs(fields.formal_gap(zones.middle)).max())
    inside = density.locate(x)[2]
    for s, e in _runs((gap < -rounding) & ~inside):
        lo, hi = x[max(s - 1, 0)], x[min(e + 1, len(x) - 1)]
        if (s == 0 or lo in zones.table) and (e == len(x) - 1 or hi in zones.table):
            continue
        middle, half = 0.5 * (x[s] + x[e]), 0.5 * _NEW * max(x[e] - x[s], 0.2 * (hi - lo))
        out.append((float(middle - half), float(middle + half)))
        changed = True
    if not changed:
        return None
    found = np.array(sorted(out)).reshape(-1, 2)
    overlapping = found[1:, 0] <= found[:-1, 1]
    begins, ends = np.append(True, ~overlapping), np.append(~overlapping, True)
    return np.column_stack((found[begins, 0], found[ends, 1]))


def _joined_table(table: Array, joins: NDArray[np.bool_], new: list[tuple[float, float]], period: float | None) -> Array:
    """The intervals, those after which joins is set as one with the next, and the new ones."""
    joins = joins.copy()
    if period is None:
        joins[-1] = False
    if joins[-1]:
        start = int(np.flatnonzero(~joins)[0]) + 1
        table = np.concatenate((table[start:], table[:start] + period))
        joins = np.roll(joins, -start)
    begins = np.concatenate(([True], ~joins[:-1]))
    table = np.column_stack((table[begins, 0], table[~joins, 1]))
    if new:
        added = np.array(new)
        if period is not None:
            added = added - np.floor((added[:, :1] - table[0, 0]) / period) * period
        table = np.concatenate((table, added))
        table = table[np.argsort(table[:, 0])]
    return np.asarray(table)


def united_about(table: Array, zones: Array, period: float | None) -> Array:
    """Intervals widened to hold these zones, which lie in them but for their ends."""
    rows = np.concatenate((table, zones if period is None else zones - np.floor((zones[:, :1] - table[0, 0]) / period) * period))
    if period is not None:
        # One that begins just before the first interval is counted from there.
        late = (rows[:, 1] >= table[0, 0] + period) & (rows[:, 0] > table[-1, 1])
        rows[late] -= period
    rows = rows[np.argsort(rows[:, 0])]
    reach = np.maximum.accumulate(rows[:, 1])
    first = np.flatnonzero(np.append(True, rows[1:, 0] > reach[:-1]))
    return np.column_stack((rows[first, 0], reach[np.append(first[1:], len(rows)) - 1]))
