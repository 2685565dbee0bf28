r"""Curves of equilibria under a law that pulls with a constant tension s where the gap is below its
reach h.

The ends c of the intervals I = {gap < h} are the unknowns. Under the tension on given I the contact
is the frictionless one of a deformed profile (pulled.py): convex, its zones unique. By an outward
motion of an end the energy changes by -s (h - gap(c)) ds, so

    r = 1 - gap(c)/h,   J = dr/ds = -(1/h) d gap(c)/ds,

play the part that the intensities have in `equilibria`: under a held load tension anywhere brings
the surfaces nearer everywhere, so J is positive off its diagonal, the map I -> {gap < h} keeps
order, and from intervals all of whose ends are driven outward they advance to the least equilibrium
that holds them. Under a held approach of a period that is not so: the level stays, and far from a
tension the surfaces move apart. In J the zones follow: what an end of I adds is a unit source at c,
to first order answered by the density of zones that are held with singular ends, whose intensities
move these by 2 K/A.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

import sie
from contact.adhesion.curve import HELD, Equilibria, Point
from contact.adhesion.deformed_profile import Pulled
from contact.adhesion.inner_contact import (
    TIGHT,
    Covered,
    Lost,
    Tolerances,
    contact_under,
    edge_slopes,
    look_around,
    look_at,
    looked,
    signs_hold,
)
from contact.adhesion.intervals import fitted, interval_of
from contact.errors import OutOfRange
from contact.formulation.controls import Control
from contact.formulation.fields import ZoneFields
from contact.formulation.problem import Problem
from contact.formulation.tables import outward
from sie import Array, Mask, record

# Surfaces that overlap by this part of the reach only touch.
_TOUCHING = 1e-12
# To which the densities are solved that rates are told of where zones are many: of a state, and of
# one on the way.
_OF_RATES = 1e-10
_OF_ROUGH_RATES = 1e-4
# Newton's steps to an equilibrium near by; over the widths, a step that is rounding, and one that
# is of another equilibrium.
_SETTLING = 8
_SETTLED = 1e-15
_ANOTHER = 1e-2
# Over the widest zone, strips below which a state on the way is solved as tightly as any, and its
# rates more tightly by as much: they go by how far the ends of zones are off over their strips,
# times zones over strips.
_NARROW = 1e-3
# Over the widths, tight states no farther apart than this have the same rates.
_ALIKE = 1e-9
# States that are remembered.
_KNOWN = 256


@record
class CohesivePoint(Point):
    """table: the intervals I, none where everywhere is set; zones: the contact within them (n, 2);
    q: its fields, None where the surfaces only pull; by_ends, level_rates: motions of the zones'
    ends (2n,), and of the level, by those of I and by the value of the control, the last column;
    seen: what was looked at, None where nothing was.
    """

    zones: Array
    q: ZoneFields | None
    by_ends: Array
    level_rates: Array
    seen: tuple[Array, Array] | None
    everywhere: bool = False

    @classmethod
    def under_all(
        cls,
        value: float,
        load: float,
        level: float,
        zones: Array,
        q: ZoneFields | None,
        seen: tuple[Array, Array],
    ) -> "CohesivePoint":
        """Under tension in all of a period, of which no end moves."""
        none, still = np.zeros(0), np.zeros((2 * len(zones), 1))
        return cls(
            np.zeros((0, 2)),
            value,
            none,
            np.zeros((0, 0)),
            none,
            load,
            level,
            zones,
            q,
            still,
            np.array([-1.0]),
            seen,
            True,
        )

    @cached_property
    def look(self) -> tuple[Array, Array]:
        """(sampled places without contact, ascending, the gap there)."""
        if self.seen is not None:
            return self.seen
        assert self.q is not None
        return look_at(self.q)

    @property
    def rate(self) -> float:
        """d load/d approach on the curve of equilibria, of a state under a held load."""
        ends = np.linalg.solve(-self.rates, self.by_value)
        return float(-1.0 / (self.level_rates[-1] + self.level_rates[:-1] @ ends))

    @property
    def contact(self) -> Array:
        return self.zones

    @property
    def gains(self) -> Array:
        """1: the slope of the energy goes with the gap itself."""
        return np.ones(len(self.residual))


@record
class Known:
    """Of a state, what first guesses of others come from."""

    table: Array
    value: float
    zones: Array
    by_ends: Array


@record
class Loose(Point):
    """A state of which only its intervals, zones (n, 2), load and level are told."""

    zones: Array

    @classmethod
    def of(cls, table: Array, value: float, load: float, level: float, zones: Array) -> "Loose":
        none = np.zeros(0)
        return cls(
            table, float(value), none, np.zeros((0, 0)), none, float(load), float(level), zones
        )

    @property
    def contact(self) -> Array:
        return self.zones


@dataclass(frozen=True)
class Cohesive(Equilibria):
    """Those of a problem whose law has a tension and a reach, both scaled here.

    recent: the last state, of which curve, and how tightly solved; loose: surfaces that pull
    without touching are states, too, where the load is not held; formal: the number of zones stays
    as it is, whatever the signs of q and of the gap.
    """

    problem: Problem
    held: Control
    known: list[Known] = field(default_factory=list, compare=False, repr=False)
    recent: "list[tuple[Cohesive, CohesivePoint, float]]" = field(
        default_factory=list, compare=False, repr=False
    )
    loose: bool = False
    formal: bool = False

    @cached_property
    def stress(self) -> float:
        return self.problem.law.tension / self.problem.units.pressure

    @cached_property
    def reach(self) -> float:
        return self.problem.law.reach / self.problem.units.height

    @cached_property
    def strip(self) -> float:
        """About how wide tension acts beside a zone that is far wider."""
        law, units = self.problem.law, self.problem.units
        return 0.25 * math.pi * units.E_star * law.reach / law.tension / units.length

    @property
    def everywhere(self) -> Pulled:
        """The problem under tension in all of a period."""
        return Pulled.of(self.problem, self.stress, np.zeros((0, 2)), everywhere=True)

    # one state
    # --------------------------------------------------------------------------------------------------------
    def at(
        self,
        table: Array,
        value: float,
        tolerance: float = TIGHT,
        held: Mask | None = None,
        alike: CohesivePoint | None = None,
    ) -> CohesivePoint:
        """The contact under the tension on given intervals, no farther than to sharp corners; zones
        are looked for from those of the last state. held: at corners; None: those that are there
        and are not driven inward. alike: a state that has the same rates.
        """
        table = self.within(table)
        near = self.nearest(table, value) if self.known else None
        zones = np.zeros((0, 2)) if near is None else self._followed(near, table, value)
        try:
            here = self.from_zones(table, value, zones, tolerance, alike)
        except Covered:
            # Zones that a state has lost are not found again where others are driven on for them.
            more = max(
                (one for one in self.known if one.table.shape == table.shape),
                key=lambda one: len(one.zones),
                default=None,
            )
            if near is None or more is None or len(more.zones) <= len(near.zones):
                raise
            here = self.from_zones(table, value, self._followed(more, table, value), tolerance)
        if held is None or here.corners is None or np.array_equal(held, here.held):
            return here
        return here.holding(held)

    def under(self, control: Control) -> "Cohesive":
        return Cohesive(self.problem, control, loose=self.loose, formal=self.formal)

    def again(self, here: Point, value: float) -> CohesivePoint:
        return self.from_zones(here.table, value, here.contact)

    def fitted(self, zones: Array, table: Array) -> Array:
        """Zones cut to lie within intervals."""
        return fitted(zones, table, self.problem.round, corners=self.problem.corners)

    def _followed(self, before: Known, table: Array, value: float) -> Array:
        """Where the zones of a state are about to be after its intervals and the value have moved."""
        zones = before.zones
        if len(before.table) != len(table):
            return self.fitted(zones, table)
        move = before.by_ends @ np.append(outward(before.table, table), value - before.value)
        count = len(zones)
        width = np.diff(zones, axis=1)[:, 0]
        i = interval_of(zones, before.table)
        left = np.clip(move[:count], -0.4 * width, None)
        right = np.clip(move[count:], -0.4 * width, None)
        new = zones + np.column_stack((-left, right))
        # Nearer to the end of an interval than a part of what it was a zone does not come at once.
        room = np.array([zones[:, 0] - before.table[i, 0], before.table[i, 1] - zones[:, 1]])
        new[:, 0] = np.maximum(new[:, 0], table[i, 0] + 0.2 * room[0])
        new[:, 1] = np.minimum(new[:, 1], table[i, 1] - 0.2 * room[1])
        middle, share = 0.5 * (zones[1:, 0] + zones[:-1, 1]), 1e-3 * (zones[1:, 0] - zones[:-1, 1])
        new[1:, 0], new[:-1, 1] = (
            np.maximum(new[1:, 0], middle + share),
            np.minimum(new[:-1, 1], middle - share),
        )
        if np.any(new[:, 1] <= new[:, 0]) or np.any(new[1:, 0] <= new[:-1, 1]):
            return self.fitted(zones, table)
        return np.asarray(new)

    def nearest(self, table: Array, value: float) -> Known:
        """Of the states known, the one of the nearest intervals as many as these, and under the
        nearest value; else the last.
        """

        def away(one: Known) -> tuple[float, float]:
            return float(np.abs(one.table - table).max()), abs(one.value - value)

        known = self.known
        alike = [one for one in known if one.table.shape == table.shape]
        return min(reversed(alike), key=away) if alike else known[-1]

    def from_zones(
        self,
        table: Array,
        value: float,
        zones: Array,
        tolerance: float = TIGHT,
        alike: CohesivePoint | None = None,
    ) -> CohesivePoint:
        """The same from a first guess of the zones."""
        table, narrow = (
            self.within(table),
            self.strip / float(np.diff(zones, axis=1).max(initial=0.0) or np.inf),
        )
        asked, of_rates = tolerance, _OF_RATES if tolerance <= TIGHT else _OF_ROUGH_RATES
        if 0.0 < narrow < _NARROW:
            tolerance, of_rates = TIGHT, max(_OF_RATES, of_rates * narrow)
        for curve, last, tightly in self.recent:
            if (
                tightly <= asked
                and curve == self
                and last.value == value
                and np.array_equal(last.table, table)
            ):
                return last
        lo, hi = self.problem.borders
        if table[0, 0] <= lo or table[-1, 1] >= hi:
            raise OutOfRange(
                "the tension reaches the border of the part of the profile that is known"
            )
        pulled = Pulled.of(self.problem, self.stress, table)
        point = (
            self._without_contact(table, value, pulled)
            if self._may_be_loose and len(zones) == 0
            else None
        )
        if point is None or (not self.formal and point.look[1].min() < -_TOUCHING * self.reach):
            try:
                tolerances = (
                    Tolerances(tolerance) if asked <= TIGHT else Tolerances.on_the_way(tolerance)
                )
                point = self._point(
                    table,
                    value,
                    *self._contact_under(pulled, value, zones, tolerances),
                    of_rates,
                    alike,
                )
            except Lost:
                if not self._may_be_loose:
                    raise
                point = self._without_contact(table, value, pulled)
        self.recent[:] = [(self, point, asked)]
        self.known.append(Known(table, value, point.zones, point.by_ends))
        del self.known[:-_KNOWN]
        return point

    @property
    def _may_be_loose(self) -> bool:
        return self.loose and self.held.load is None

    def contact_under(
        self, pulled: Pulled, value: float, zones: Array
    ) -> tuple[ZoneFields, tuple[Array, Array]]:
        """(fields of q on the zones of contact under a tension and a value of the control, the gap
        beside them).
        """
        fields, look = self._contact_under(pulled, value, zones, Tolerances())
        return fields, look_at(fields) if look is None else look

    def _contact_under(
        self, pulled: Pulled, value: float, zones: Array, tolerances: Tolerances
    ) -> tuple[ZoneFields, tuple[Array, Array] | None]:
        return contact_under(
            pulled, lambda at: self.control(at, value), zones, self.formal, tolerances
        )

    def under_all(self, value: float, zones: Array) -> CohesivePoint:
        """The contact under tension in all of a period; as stable as the frictionless one."""
        pulled, none = self.everywhere, np.zeros((0, 2))
        pull = pulled.pulling.total
        loose: CohesivePoint | None = None
        if self._may_be_loose:
            level, x = -value - self.yields * pull, look_around(pulled, none)
            loose = CohesivePoint.under_all(
                value, -pull, level, none, None, looked(lambda y: pulled.shape(y) + level, x)
            )
            if len(zones) == 0 and (self.formal or loose.look[1].min() >= -_TOUCHING * self.reach):
                return loose
        try:
            fields, look = self.contact_under(pulled, value, zones)
        except Lost:
            if loose is None:
                raise
            return loose
        found = fields.density
        return CohesivePoint.under_all(
            value, found.total - pull, float(fields.level), found.zones.table, fields, look
        )

    def control(self, pulled: Pulled, value: float) -> Control:
        """That of q: its load has the tension, too."""
        return replace(self.held, value=value + self.yields * pulled.pulling.total)

    @property
    def yields(self) -> float:
        """What a unit of load adds to the value of the control."""
        if self.held.load is not None:
            return 1.0
        return float(self.held.yields or 0.0)

    def fields(self, here: Point, tolerance: float = TIGHT) -> ZoneFields:
        """As tightly as it was solved."""
        assert isinstance(here, CohesivePoint) and here.q is not None
        return here.q

    def gap(self, here: Point, x: Array) -> Array:
        """The scaled gap at places, rounding left as it is in contact."""
        assert isinstance(here, CohesivePoint)
        if here.q is not None:
            return here.q.formal_gap(x)
        pulled = (
            self.everywhere if here.everywhere else Pulled.of(self.problem, self.stress, here.table)
        )
        return np.asarray(pulled.shape(x) + here.level)

    def unit(self, here: Point) -> float:
        if here.whole.by_value.any():
            return super().unit(here)
        # Contact covers all ends: what the tension could bear, or its reach.
        bears = self.stress * float(np.diff(here.table, axis=1).sum())
        return bears if self.held.load is not None else self.reach + self.yields * bears

    @property
    def formally(self) -> "Cohesive":
        return self if self.formal else replace(self, formal=True)

    def has_right_zones(self, here: Point) -> bool:
        assert isinstance(here, CohesivePoint)
        if here.q is None:
            return bool(here.look[1].min() >= -_TOUCHING * self.reach)
        return signs_hold(here.q, here.look)

    def vanishes(self, here: Point, motion: Array) -> float:
        """By the squares of the zones' widths, which fall evenly."""
        assert isinstance(here, CohesivePoint)
        widths = np.diff(here.zones, axis=1)[:, 0]
        narrower = -(here.by_ends @ motion).reshape(2, -1).sum(axis=0)
        with np.errstate(divide="ignore"):
            return float(
                np.where(narrower > 0.0, 0.5 * widths / narrower, np.inf).min(initial=np.inf)
            )

    # how it follows
    # ---------------------------------------------------------------------------------------------------
    def settled(self, here: Point) -> CohesivePoint:
        """The equilibrium near by, tightly."""
        assert isinstance(here, CohesivePoint)
        if not any(last is here for _, last, _ in self.recent):
            here = self.at(here.table, here.value)
        before = np.inf
        for _ in range(_SETTLING):
            size, tight = float(np.abs(here.newton / here.widths).max()), self.recent[0][2] <= TIGHT
            # Steps that do not fall any more are rounding.
            if size > _ANOTHER or (tight and (size < _SETTLED or size > 0.5 * before)):
                break
            before = size if tight else np.inf
            alike = here if tight and size < _ALIKE else None
            here = self.at(here.moved(here.newton), here.value, alike=alike)
        return self.at(here.table, here.value)

    def _point(
        self,
        table: Array,
        value: float,
        fields: ZoneFields,
        look: tuple[Array, Array] | None,
        of_rates: float,
        alike: CohesivePoint | None,
    ) -> CohesivePoint:
        """alike: a state whose intervals are so near that all follows their ends as there, if it
        has as many zones.
        """
        pulled, state = fields.problem, fields.state.whole
        assert isinstance(pulled, Pulled)
        zones, load, level = (
            fields.density.zones.table,
            fields.density.total - pulled.pulling.total,
            float(fields.level),
        )
        # An end that zones cover is held at its corner.
        at = table.T.ravel()
        beside, residual = ~np.isin(at, zones), np.ones(len(at))
        residual[beside] -= fields.formal_gap(at[beside]) / self.reach
        if alike is not None and len(zones) == len(alike.zones):
            whole = alike.whole
            return self._at_corners(
                CohesivePoint(
                    table,
                    value,
                    residual,
                    whole.rates,
                    whole.by_value,
                    load,
                    level,
                    zones,
                    fields,
                    alike.by_ends,
                    alike.level_rates,
                    look,
                )
            )
        if state.iteration is not None:
            # There are as many right sides as ends: a matrix once, not an iteration for each.
            state = sie.solve_fixed(
                pulled.equation(self.control(pulled, value)),
                state.density.zones,
                of_rates,
                direct=True,
            )
        density, count = state.density, len(table)
        free, open_ = at[beside], np.flatnonzero(beside)
        strengths = np.hstack((self.stress * np.eye(len(free)), np.zeros((len(free), 1))))
        values = np.zeros((len(state.condition_scale), len(free) + 1))
        first = state.condition_index[0]
        if self.held.load is not None:
            values[first, :-1], values[first, -1] = self.stress, 1.0
        else:
            # Minus the value stands in the row of every zone.
            values[first : first + len(density.zones)] = np.append(
                np.full(len(free), -self.yields * self.stress), -1.0
            )
        answers = sie.answers(state, free, strengths, values, free)
        of_level = (
            np.append(np.zeros(len(free)), -1.0)
            if self.held.approach is not None
            else answers.levels.mean(axis=0)
        )
        change = of_level - answers.potentials
        transform = np.zeros(2 * count)
        transform[beside] = density.transform(free)
        matrix, by_value = np.zeros((2 * count, 2 * count)), np.zeros(2 * count)
        matrix[np.ix_(open_, open_)], by_value[beside] = change[:, :-1], change[:, -1]
        by_all = np.append(open_, 2 * count)
        levels, moved = np.zeros(2 * count + 1), np.zeros((2 * len(density.zones), 2 * count + 1))
        levels[by_all] = of_level
        with np.errstate(divide="ignore"):
            moves = 2 * answers.intensities / edge_slopes(pulled, state)[:, :, None]
        moves[(zones == np.array(pulled.corners)).T] = 0.0
        moved[:, by_all] = moves.reshape(-1, len(by_all))
        rates = -(matrix + self.explicit(pulled, at, transform)) / self.reach
        rates[~beside], rates[:, ~beside] = 0.0, 0.0
        by_value = -by_value / self.reach
        return self._at_corners(
            CohesivePoint(
                table,
                value,
                residual,
                rates,
                by_value,
                load,
                level,
                zones,
                fields,
                moved,
                levels,
                look,
            )
        )

    def _at_corners(self, here: CohesivePoint) -> CohesivePoint:
        """With ends held that are at sharp corners and not driven inward."""
        corners = np.array(self.problem.corners)
        if not np.isfinite(corners).all():
            return here
        return here.holding((here.table == corners).T.ravel() & (here.residual >= -HELD))

    def _without_contact(self, table: Array, value: float, pulled: Pulled) -> CohesivePoint:
        """The surfaces as they pull without touching, the load not being held: their gap is
        explicit.
        """
        count, pull = len(table), pulled.pulling.total
        at = np.concatenate((table[:, 0], table[:, 1]))
        level = -value - self.yields * pull
        gap = pulled.shape(at) + level
        look = looked(lambda x: pulled.shape(x) + level, look_around(pulled, np.zeros((0, 2))))
        rates = self.explicit(pulled, at, np.zeros(2 * count)) - self.yields * self.stress
        none, by_ends = np.zeros((0, 2)), np.zeros((0, 2 * count + 1))
        of_level = np.append(np.full(2 * count, -self.yields * self.stress), -1.0)
        return self._at_corners(
            CohesivePoint(
                table,
                value,
                1 - gap / self.reach,
                -rates / self.reach,
                np.full(2 * count, 1.0 / self.reach),
                -pull,
                level,
                none,
                None,
                by_ends,
                of_level,
                look,
            )
        )

    def explicit(self, pulled: Pulled, at: Array, transform: Array) -> Array:
        """Rates of the gap at the ends of the tension by their outward motions, but for what the
        contact answers; transform: of q there.
        """
        tension, count = pulled.pulling, len(at) // 2
        lag = at[:, None] - at
        np.fill_diagonal(lag, 1.0)
        between = self.stress / np.pi * tension.log(lag)
        # The slope that all other ends make there; of its own and of its motion nothing is left
        # together.
        slopes = (
            self.stress
            / np.pi
            * tension.logs(at)
            * np.concatenate((np.ones(count), -np.ones(count)))
        )
        np.fill_diagonal(slopes, 0.0)
        away = np.concatenate((-np.ones(count), np.ones(count)))
        np.fill_diagonal(between, away * (pulled.own_slope(at) - transform + slopes.sum(axis=1)))
        return between
