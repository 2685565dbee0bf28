r"""Curves of equilibria of a cohesive law: a constant tension s where the gap is below the reach h.

The unknowns are the ends c of the intervals I = {gap < h}. For given I, the contact is the
frictionless contact of a deformed profile (deformed_profile.py); this problem is convex and its
zones are unique. An outward motion ds of an end changes the energy by -s (h - gap(c)) ds. So the
residual and its Jacobian are

    r = 1 - gap(c)/h,   J = dr/ds = -(1/h) d gap(c)/ds.

They have the role of the edge intensities in `curve`. Under load control, tension anywhere brings
the surfaces closer everywhere. Then J is positive off its diagonal and the map I -> {gap < h} is
monotone: intervals whose ends are all driven outward grow to the smallest equilibrium that contains
them. Under approach control of a period this does not hold, since far from a tension the surfaces
move apart.

J includes the motion of the zones. Moving an end of I adds a point source at c. To first order the
response is the density of fixed zones with singular ends. Its intensities K move the ends of the
zones by 2 K/A, with the edge slope A of the pressure.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

import sie
from contact.adhesion.curve import ACCURACY, Curve, State
from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.inner_contact import (
    ContactLost,
    EndsCovered,
    InnerTolerances,
    contact_under,
    edge_slopes,
    sample_places,
    sampled_gap,
    samples_with_extremes,
    signs_hold,
)
from contact.adhesion.intervals import fitted, interval_of
from contact.errors import OutOfRange
from contact.formulation.controls import Control
from contact.formulation.fields import ZoneFields
from contact.formulation.problem import Problem
from contact.formulation.tables import outward
from contact.formulation.tolerances import allowed_overlap
from contact.model.profiles.noise import EPS
from sie import Array, Mask, record


@dataclass(frozen=True)
class CohesiveOptions:
    """Options of states under a cohesive law: limits for strips of tension, states and zones."""

    # A strip of tension next to a zone of contact counts as narrow below this fraction of the
    # zone's width. States with narrow strips are solved to round-off, because the rates of their
    # residuals magnify errors of the ends by (zone width/strip width)^2. At the start of a branch,
    # `cohesive_branch._moved_outward` moves the ends of zones outward, so that the strips can be
    # resolved.
    narrow_strip: float = 1e-3
    # Strips of tension are refused if they are narrower than this fraction of the width of the zone
    # next to them. The pressure at the end of such a zone varies too fast.
    narrowest_strip: float = 5e-7
    # Largest number of earlier states that are kept for warm starts.
    max_known: int = 256
    # Largest number of zones. It is bounded, because each step of the ends factors a dense matrix
    # of all unknowns.
    max_zones: int = 400


OPTIONS = CohesiveOptions()


@record
class CohesiveState(State):
    """A state under a cohesive law: the intervals of tension and the contact inside them.

    table: the intervals I (empty if the tension acts everywhere); zones: the contact (n, 2); q: the
    fields of the contact, None without contact; by_ends, level_rates: rates of the zones' ends
    (2n,) and of the level with respect to the ends of I and, in the last column, the value of the
    control; seen: the sampled gap, None if it was not sampled.
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
    ) -> "CohesiveState":
        """A state under tension on the whole period, where the tension has no ends."""
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
    def gap_samples(self) -> tuple[Array, Array]:
        """(ascending sample points outside the contact, gap at these points)."""
        if self.seen is not None:
            return self.seen
        assert self.q is not None
        return sampled_gap(self.q)

    @property
    def rate(self) -> float:
        """Derivative of the load by the approach along the curve, for a state under fixed load."""
        ends = np.linalg.solve(-self.rates, self.by_value)
        return float(-1.0 / (self.level_rates[-1] + self.level_rates[:-1] @ ends))

    @property
    def contact(self) -> Array:
        return self.zones

    @property
    def gains(self) -> Array:
        """Factors (2n,) from rates of the residuals to second derivatives of the energy: here 1.
        The residuals are already proportional to first derivatives of the energy by the ends.
        """
        return np.ones(len(self.residual))


@record
class PastState:
    """Intervals of tension, control value, zones and zone rates of an earlier state.

    It is kept to start the solution of other states.
    """

    table: Array
    value: float
    zones: Array
    by_ends: Array


@record
class StateOutline(State):
    """A state given only by its intervals, zones (n, 2), load and level (minus the approach)."""

    zones: Array

    @classmethod
    def of(
        cls, table: Array, value: float, load: float, level: float, zones: Array
    ) -> "StateOutline":
        none = np.zeros(0)
        return cls(
            table, float(value), none, np.zeros((0, 0)), none, float(load), float(level), zones
        )

    @property
    def contact(self) -> Array:
        return self.zones


@dataclass(frozen=True)
class CohesiveCurve(Curve):
    """The curve of equilibria under a cohesive law, with scaled tension and scaled reach.

    known: earlier states for warm starts; recent: the last state with its curve and tolerance;
    may_separate: whether states without contact are allowed (if the load is not controlled);
    formal: whether the number of zones is kept and the signs of q and of the gap are not checked.
    """

    problem: Problem
    control: Control
    known: list[PastState] = field(default_factory=list, compare=False, repr=False)
    recent: "list[tuple[CohesiveCurve, CohesiveState, float]]" = field(
        default_factory=list, compare=False, repr=False
    )
    may_separate: bool = False
    formal: bool = False

    @cached_property
    def stress(self) -> float:
        return self.problem.law.tension / self.problem.units.pressure

    @cached_property
    def reach(self) -> float:
        return self.problem.law.reach / self.problem.units.height

    @cached_property
    def strip(self) -> float:
        """Approximate width of the strip of tension next to a much wider zone."""
        law, units = self.problem.law, self.problem.units
        return 0.25 * math.pi * units.E_star * law.reach / law.tension / units.length

    @property
    def everywhere(self) -> TractionLoaded:
        """The frictionless problem of the profile deformed by tension on the whole period."""
        return TractionLoaded.of(self.problem, self.stress, np.zeros((0, 2)), everywhere=True)

    def at(
        self,
        table: Array,
        value: float,
        tolerance: float = ACCURACY.density,
        pinned: Mask | None = None,
        same_rates: CohesiveState | None = None,
    ) -> CohesiveState:
        """The state with tension on given intervals, which are cut at sharp corners.

        The zones start from those of the nearest known state. pinned: ends pinned at corners; None:
        all ends at corners that are not driven inward. same_rates: a state whose rates may be
        reused.
        """
        table = self.within(table)
        known_state = self.nearest(table, value) if self.known else None
        zones = (
            np.zeros((0, 2)) if known_state is None else self._followed(known_state, table, value)
        )
        try:
            here = self.from_zones(table, value, zones, tolerance, same_rates)
        except EndsCovered:
            # The first guess of the zones, taken from `known_state`, is so wide that zones cover
            # ends of intervals of tension. This happens if `known_state` has too few zones. So the
            # known state with the most zones is tried.
            more = max(
                (one for one in self.known if one.table.shape == table.shape),
                key=lambda one: len(one.zones),
                default=None,
            )
            if known_state is None or more is None or len(more.zones) <= len(known_state.zones):
                raise
            here = self.from_zones(table, value, self._followed(more, table, value), tolerance)
        if pinned is None or here.corners is None or np.array_equal(pinned, here.pinned):
            return here
        return here.with_pinned(pinned)

    def under(self, control: Control) -> "CohesiveCurve":
        return CohesiveCurve(
            self.problem, control, may_separate=self.may_separate, formal=self.formal
        )

    def again(self, here: State, value: float) -> CohesiveState:
        return self.from_zones(here.table, value, here.contact)

    def fitted(self, zones: Array, table: Array) -> Array:
        """The zones, cut so that they lie within the intervals."""
        return fitted(zones, table, self.problem.round, corners=self.problem.corners)

    def _followed(self, before: PastState, table: Array, value: float) -> Array:
        """The zones of a known state, extrapolated to other intervals and another control value."""
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
        # Each end of an extrapolated zone keeps at least a fifth of its old distance from the end
        # of the interval around the zone.
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

    def nearest(self, table: Array, value: float) -> PastState:
        """The known state with as many intervals as `table` and with the nearest ends.

        If no known state has this number of intervals, it is the last known state.
        """

        def away(one: PastState) -> tuple[float, float]:
            return float(np.abs(one.table - table).max()), abs(one.value - value)

        known = self.known
        same_rates = [one for one in known if one.table.shape == table.shape]
        return min(reversed(same_rates), key=away) if same_rates else known[-1]

    def from_zones(
        self,
        table: Array,
        value: float,
        zones: Array,
        tolerance: float = ACCURACY.density,
        same_rates: CohesiveState | None = None,
    ) -> CohesiveState:
        """The state with tension on given intervals, found from a first guess of the zones."""
        table = self.within(table)
        narrow = self.strip / float(np.diff(zones, axis=1).max(initial=0.0) or np.inf)
        wanted, of_rates = tolerance, ACCURACY.coarse
        if tolerance <= ACCURACY.density:
            of_rates = ACCURACY.rough
        if 0.0 < narrow < OPTIONS.narrow_strip:
            tolerance, of_rates = ACCURACY.density, max(ACCURACY.rough, of_rates * narrow)
        for curve, last, tightly in self.recent:
            if (
                tightly <= wanted
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
        pulled = TractionLoaded.of(self.problem, self.stress, table)
        point = (
            self._without_contact(table, value, pulled)
            if self._may_be_loose and len(zones) == 0
            else None
        )
        if point is None or (not self.formal and not self._is_apart(point)):
            try:
                tolerances = (
                    InnerTolerances(tolerance)
                    if wanted <= ACCURACY.density
                    else InnerTolerances.intermediate(tolerance)
                )
                point = self._point(
                    table,
                    value,
                    *self._contact_under(pulled, value, zones, tolerances),
                    of_rates,
                    same_rates,
                )
            except ContactLost:
                if not self._may_be_loose:
                    raise
                point = self._without_contact(table, value, pulled)
        self.recent[:] = [(self, point, wanted)]
        self.known.append(PastState(table, value, point.zones, point.by_ends))
        del self.known[: -OPTIONS.max_known]
        return point

    @property
    def _may_be_loose(self) -> bool:
        return self.may_separate and self.control.load is None

    def contact_under(
        self, pulled: TractionLoaded, value: float, zones: Array
    ) -> tuple[ZoneFields, tuple[Array, Array]]:
        """(fields of the contact pressure q, sampled gap) of the contact under a given tension.
        q is the true pressure plus the tension.
        """
        fields, gap_samples = self._contact_under(pulled, value, zones, InnerTolerances())
        return fields, sampled_gap(fields) if gap_samples is None else gap_samples

    def _contact_under(
        self, pulled: TractionLoaded, value: float, zones: Array, tolerances: InnerTolerances
    ) -> tuple[ZoneFields, tuple[Array, Array] | None]:
        return contact_under(
            pulled, lambda at: self.inner_control(at, value), zones, self.formal, tolerances
        )

    def under_all(self, value: float, zones: Array) -> CohesiveState:
        """The state under tension on the whole period, where the tension has no ends.
        It counts as stable, like a contact without adhesion, because a uniform tension on the whole
        period acts like an additional load.
        """
        pulled, none = self.everywhere, np.zeros((0, 2))
        pull = pulled.pulling.total
        may_separate: CohesiveState | None = None
        if self._may_be_loose:
            level, x = -value - self.yields * pull, sample_places(pulled, none)
            may_separate = CohesiveState.under_all(
                value,
                -pull,
                level,
                none,
                None,
                samples_with_extremes(lambda y: pulled.shape(y) + level, x),
            )
            apart = self._is_apart(may_separate)
            if len(zones) == 0 and (self.formal or apart):
                return may_separate
        try:
            fields, gap_samples = self.contact_under(pulled, value, zones)
        except ContactLost:
            if may_separate is None:
                raise
            return may_separate
        found = fields.density
        return CohesiveState.under_all(
            value, found.total - pull, float(fields.level), found.zones.table, fields, gap_samples
        )

    def inner_control(self, pulled: TractionLoaded, value: float) -> Control:
        """The control for the contact pressure q, whose load includes the force of the tension."""
        return replace(self.control, value=value + self.yields * pulled.pulling.total)

    @property
    def yields(self) -> float:
        """Change of the control's value per unit of load: 1, or the compliance of a spring, or 0.
        It is 1 if the load is the control, and 0 if the approach is.
        """
        if self.control.load is not None:
            return 1.0
        return float(self.control.yields or 0.0)

    def fields(self, here: State, tolerance: float = ACCURACY.density) -> ZoneFields:
        """The fields of a state, at the accuracy with which the state was solved."""
        assert isinstance(here, CohesiveState) and here.q is not None
        return here.q

    def gap(self, here: State, x: Array) -> Array:
        """The scaled gap at points x; in contact, the gap is round-off and not exactly 0."""
        assert isinstance(here, CohesiveState)
        if here.q is not None:
            return here.q.formal_gap(x)
        pulled = (
            self.everywhere
            if here.everywhere
            else TractionLoaded.of(self.problem, self.stress, here.table)
        )
        return np.asarray(pulled.shape(x) + here.level)

    def unit(self, here: State) -> float:
        if here.whole.by_value.any():
            return super().unit(here)
        # No residual depends on the control, so that `super().unit` would divide by zero. Under a
        # fixed load the unit is the total force of the tension, `bears`. Under another control the
        # unit is the reach plus the change of the control's value due to that force.
        bears = self.stress * float(np.diff(here.table, axis=1).sum())
        return bears if self.control.load is not None else self.reach + self.yields * bears

    @property
    def formally(self) -> "CohesiveCurve":
        return self if self.formal else replace(self, formal=True)

    def _is_apart(self, here: CohesiveState) -> bool:
        """Whether the surfaces of a state without contact overlap nowhere."""
        return bool(here.gap_samples[1].min() >= -allowed_overlap(reach=self.reach))

    def has_right_zones(self, here: State) -> bool:
        assert isinstance(here, CohesiveState)
        if here.q is None:
            return self._is_apart(here)
        return signs_hold(here.q, here.gap_samples)

    def vanishes(self, here: State, motion: Array) -> float:
        """Smallest factor on `motion`, a change of ends and control, at which a zone vanishes.

        The square of a zone's width, not the width, is nearly linear in the motion. So the zone
        vanishes after half of the fraction that the rate of its width gives.
        """
        assert isinstance(here, CohesiveState)
        widths = np.diff(here.zones, axis=1)[:, 0]
        narrower = -(here.by_ends @ motion).reshape(2, -1).sum(axis=0)
        with np.errstate(divide="ignore"):
            return float(
                np.where(narrower > 0.0, 0.5 * widths / narrower, np.inf).min(initial=np.inf)
            )

    def settled(self, here: State) -> CohesiveState:
        """The equilibrium nearest to a state, solved to round-off."""
        assert isinstance(here, CohesiveState)
        if not any(last is here for _, last, _ in self.recent):
            here = self.at(here.table, here.value)
        before = np.inf
        for _ in range(ACCURACY.max_newton_steps):
            size, tight = (
                float(np.abs(here.newton / here.widths).max()),
                self.recent[0][2] <= ACCURACY.density,
            )
            # Newton steps that no longer decrease are round-off.
            converged = tight and (size < 4 * EPS or size > 0.5 * before)
            if size > ACCURACY.other_equilibrium or converged:
                break
            before = size if tight else np.inf
            same_rates = here if tight and size < ACCURACY.rough else None
            here = self.at(here.moved(here.newton), here.value, same_rates=same_rates)
        return self.at(here.table, here.value)

    def _point(
        self,
        table: Array,
        value: float,
        fields: ZoneFields,
        gap_samples: tuple[Array, Array] | None,
        of_rates: float,
        same_rates: CohesiveState | None,
    ) -> CohesiveState:
        """The state that has the given fields, with its residuals and rates.

        same_rates: a close state, whose rates are reused if it has as many zones.
        """
        pulled, state = fields.problem, fields.state.whole
        assert isinstance(pulled, TractionLoaded)
        zones, load, level = (
            fields.density.zones.table,
            fields.density.total - pulled.pulling.total,
            float(fields.level),
        )
        # If an interval of tension and a zone of contact end at the same point, this end is pinned
        # at a sharp corner. The gap there is 0, so that the residual 1 - gap / reach is 1.
        at = table.T.ravel()
        is_open, residual = ~np.isin(at, zones), np.ones(len(at))
        residual[is_open] -= fields.formal_gap(at[is_open]) / self.reach
        if same_rates is not None and len(zones) == len(same_rates.zones):
            whole = same_rates.whole
            return self._at_corners(
                CohesiveState(
                    table,
                    value,
                    residual,
                    whole.rates,
                    whole.by_value,
                    load,
                    level,
                    zones,
                    fields,
                    same_rates.by_ends,
                    same_rates.level_rates,
                    gap_samples,
                )
            )
        if state.iteration is not None:
            # The rates of the residuals need one linear solution for each end, so a matrix is
            # factored instead of iterating.
            state = sie.solve_fixed(
                pulled.equation(self.inner_control(pulled, value)),
                state.density.zones,
                of_rates,
                direct=True,
            )
        density, count = state.density, len(table)
        free, open_ = at[is_open], np.flatnonzero(is_open)
        strengths = np.hstack((self.stress * np.eye(len(free)), np.zeros((len(free), 1))))
        values = np.zeros((len(state.condition_scale), len(free) + 1))
        first = state.condition_index[0]
        if self.control.load is not None:
            values[first, :-1], values[first, -1] = self.stress, 1.0
        else:
            # Under a fixed approach, the right side of each zone's side condition is minus the
            # value of `inner_control`. `values` holds the derivatives of this right side by the
            # free ends and by `value`.
            values[first : first + len(density.zones)] = np.append(
                np.full(len(free), -self.yields * self.stress), -1.0
            )
        answers = sie.answers(state, free, strengths, values, free)
        of_level = (
            np.append(np.zeros(len(free)), -1.0)
            if self.control.approach is not None
            else answers.levels.mean(axis=0)
        )
        change = of_level - answers.potentials
        transform = np.zeros(2 * count)
        transform[is_open] = density.transform(free)
        matrix, by_value = np.zeros((2 * count, 2 * count)), np.zeros(2 * count)
        matrix[np.ix_(open_, open_)], by_value[is_open] = change[:, :-1], change[:, -1]
        by_all = np.append(open_, 2 * count)
        levels, moved = np.zeros(2 * count + 1), np.zeros((2 * len(density.zones), 2 * count + 1))
        levels[by_all] = of_level
        with np.errstate(divide="ignore"):
            moves = 2 * answers.intensities / edge_slopes(pulled, state)[:, :, None]
        moves[(zones == np.array(pulled.corners)).T] = 0.0
        moved[:, by_all] = moves.reshape(-1, len(by_all))
        rates = -(matrix + self.explicit(pulled, at, transform)) / self.reach
        rates[~is_open], rates[:, ~is_open] = 0.0, 0.0
        by_value = -by_value / self.reach
        return self._at_corners(
            CohesiveState(
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
                gap_samples,
            )
        )

    def _at_corners(self, here: CohesiveState) -> CohesiveState:
        """The state with its ends at sharp corners pinned, except for ends that tend to recede."""
        corners = np.array(self.problem.corners)
        if not np.isfinite(corners).all():
            return here
        return here.with_pinned(
            (here.table == corners).T.ravel() & (here.residual >= -ACCURACY.rough)
        )

    def _without_contact(self, table: Array, value: float, pulled: TractionLoaded) -> CohesiveState:
        """The state without contact, if the control is not a load; its gap has a closed form."""
        count, pull = len(table), pulled.pulling.total
        at = np.concatenate((table[:, 0], table[:, 1]))
        level = -value - self.yields * pull
        gap = pulled.shape(at) + level
        gap_samples = samples_with_extremes(
            lambda x: pulled.shape(x) + level, sample_places(pulled, np.zeros((0, 2)))
        )
        rates = self.explicit(pulled, at, np.zeros(2 * count)) - self.yields * self.stress
        none, by_ends = np.zeros((0, 2)), np.zeros((0, 2 * count + 1))
        of_level = np.append(np.full(2 * count, -self.yields * self.stress), -1.0)
        return self._at_corners(
            CohesiveState(
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
                gap_samples,
            )
        )

    def explicit(self, pulled: TractionLoaded, at: Array, transform: Array) -> Array:
        """Derivatives of the gap at the tension's ends by outward displacements of these ends.
        The contact pressure q is held fixed.

        transform: the kernel's transform of the contact pressure q at the ends.
        """
        tension, count = pulled.pulling, len(at) // 2
        lag = at[:, None] - at
        np.fill_diagonal(lag, 1.0)
        between = self.stress / np.pi * tension.log(lag)
        # Only the other ends contribute to the slope of the gap at an end. The singular
        # contributions of the end itself and of its motion cancel.
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
