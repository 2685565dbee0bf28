r"""Curves of equilibria of a cohesive law: a constant tension where the gap is below the reach h.

The unknowns are the ends c of the intervals I = {gap < h}. For given I, the contact is the
frictionless contact of a deformed profile (deformed_profile.py); this problem is convex and its
zones are unique. An outward motion ds of an end changes the energy by -sigma (h - gap(c)) ds, with
the tension sigma. So the residual and its Jacobian are

    r = 1 - gap(c)/h,   J = dr/ds = -(1/h) d gap(c)/ds.

They replace the residual and the Jacobian of the edge intensities (contact.adhesion.curve). Under a
fixed load, tension anywhere brings the surfaces closer everywhere. Then J is positive off its
diagonal and the map I -> {gap < h} is monotone: intervals whose ends are all driven outward grow to
the smallest equilibrium that contains them. Under a given approach of a periodic contact the map is
not monotone, since the surfaces move apart far from an interval of tension.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from contact.adhesion.cohesive_rates import contact_rates, own_gap_rates, value_per_load
from contact.adhesion.cohesive_state import CohesiveState, PastState
from contact.adhesion.curve import ACCURACY, Curve, State, direct
from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.inner_contact import ContactLost, EndsCovered, InnerTolerances, contact_under
from contact.adhesion.inner_signs import (
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
from contact.formulation.tables import located, outward
from contact.formulation.tolerances import allowed_overlap
from contact.model.profiles.noise import EPS
from sie import Array, Mask


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
        rates_from: CohesiveState | None = None,
    ) -> CohesiveState:
        """The state with tension on given intervals, which are cut at sharp corners.

        The zones start from those of the nearest known state. pinned: ends pinned at corners; None:
        all ends at corners that are not driven inward. rates_from: a state whose rates may be
        reused.
        """
        table = self.within(table)
        known_state = self.nearest(table, value) if self.known else None
        zones = (
            np.zeros((0, 2)) if known_state is None else self._followed(known_state, table, value)
        )
        try:
            here = self.from_zones(table, value, zones, tolerance, rates_from)
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
        """The zones of the state `before`, extrapolated to other intervals and another control."""
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
        same_shape = [one for one in known if one.table.shape == table.shape]
        return min(reversed(same_shape), key=away) if same_shape else known[-1]

    def from_zones(
        self,
        table: Array,
        value: float,
        zones: Array,
        tolerance: float = ACCURACY.density,
        rates_from: CohesiveState | None = None,
    ) -> CohesiveState:
        """The state with tension on given intervals, found from a first guess of the zones.

        rates_from: a close state; its rates are reused if both states have equally many zones.
        """
        table = self.within(table)
        for curve, last, tightly in self.recent:
            if (
                tightly <= tolerance
                and curve == self
                and last.value == value
                and np.array_equal(last.table, table)
            ):
                return last
        lo, hi = self.problem.borders
        if table[0, 0] <= lo or table[-1, 1] >= hi:
            raise OutOfRange(
                "the tension reaches the border of the known part of the profile: give the profile "
                'over a longer interval or, if branch is "receding", use "advancing"'
            )
        pulled = TractionLoaded.of(self.problem, self.stress, table)
        point = None
        if self._may_be_loose and len(zones) == 0:
            point = self._without_contact(pulled, value)
        if point is None or (not self.formal and not self._is_apart(point)):
            try:
                point = self._in_contact(pulled, value, zones, tolerance, rates_from)
            except ContactLost:
                if not self._may_be_loose:
                    raise
                point = self._without_contact(pulled, value)
        self.recent[:] = [(self, point, tolerance)]
        self.known.append(PastState(table, value, point.zones, point.by_ends))
        del self.known[: -OPTIONS.max_known]
        return point

    def _in_contact(
        self,
        pulled: TractionLoaded,
        value: float,
        zones: Array,
        tolerance: float,
        rates_from: CohesiveState | None,
    ) -> CohesiveState:
        """The state with contact under the tension of `pulled`; see `from_zones` for the rest."""
        tolerances, of_rates = InnerTolerances.intermediate(tolerance), ACCURACY.coarse
        if tolerance <= ACCURACY.density:
            tolerances, of_rates = InnerTolerances(tolerance), ACCURACY.rough
        narrow = self.strip / float(np.diff(zones, axis=1).max(initial=0.0) or np.inf)
        if 0.0 < narrow < OPTIONS.narrow_strip:
            tolerances = replace(tolerances, density=ACCURACY.density)
            of_rates = max(ACCURACY.rough, of_rates * narrow)
        fields, gap_samples = self._contact_under(pulled, value, zones, tolerances)
        own = fields.problem
        assert isinstance(own, TractionLoaded)
        zones, table = fields.density.zones.table, pulled.pulling.table
        # If an interval of tension and a zone of contact end at the same point, this end is pinned
        # at a sharp corner. The gap there is 0, so that the residual 1 - gap / reach is 1.
        at = table.T.ravel()
        if (covered := located(zones, at)[1]).any():
            raise EndsCovered(covered)
        is_open, residual = ~np.isin(at, zones), np.ones(len(at))
        residual[is_open] -= fields.formal_gap(at[is_open]) / self.reach
        if rates_from is not None and len(zones) == len(rates_from.zones):
            rates = rates_from.all_rates
        else:
            equation = own.equation(self.inner_control(own, value))
            state = direct(fields.state.whole, equation, of_rates)
            rates = contact_rates(own, state, self.control, self.reach, is_open)
        return CohesiveState(
            table,
            value,
            residual,
            rates.residual,
            rates.by_value,
            fields.density.total - own.pulling.total,
            float(fields.level),
            zones,
            fields,
            rates.zones,
            rates.level,
            gap_samples,
        ).at_corners(self.problem.corners)

    def _without_contact(self, pulled: TractionLoaded, value: float) -> CohesiveState:
        """The state without contact, if the control is not a load; its gap has a closed form."""
        table, pull = pulled.pulling.table, pulled.pulling.total
        at, count = table.T.ravel(), table.size
        level = -value - self.value_per_load * pull
        gap = pulled.shape(at) + level
        gap_samples = samples_with_extremes(
            lambda x: pulled.shape(x) + level, sample_places(pulled, np.zeros((0, 2)))
        )
        rates = own_gap_rates(pulled, at, np.zeros(count)) - self.value_per_load * self.stress
        return CohesiveState(
            table,
            value,
            1 - gap / self.reach,
            -rates / self.reach,
            np.full(count, 1.0 / self.reach),
            -pull,
            level,
            np.zeros((0, 2)),
            None,
            np.zeros((0, count + 1)),
            np.append(np.full(count, -self.value_per_load * self.stress), -1.0),
            gap_samples,
        ).at_corners(self.problem.corners)

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
        separated: CohesiveState | None = None
        if self._may_be_loose:
            level, x = -value - self.value_per_load * pull, sample_places(pulled, none)
            separated = CohesiveState.under_all(
                value,
                -pull,
                level,
                none,
                None,
                samples_with_extremes(lambda y: pulled.shape(y) + level, x),
            )
            apart = self._is_apart(separated)
            if len(zones) == 0 and (self.formal or apart):
                return separated
        try:
            fields, gap_samples = self.contact_under(pulled, value, zones)
        except ContactLost:
            if separated is None:
                raise
            return separated
        found = fields.density
        return CohesiveState.under_all(
            value, found.total - pull, float(fields.level), found.zones.table, fields, gap_samples
        )

    def inner_control(self, pulled: TractionLoaded, value: float) -> Control:
        """The control for the contact pressure q, whose load includes the force of the tension."""
        return replace(self.control, value=value + self.value_per_load * pulled.pulling.total)

    @property
    def value_per_load(self) -> float:
        """Change of the control's value per unit of load."""
        return value_per_load(self.control)

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
        return bears if self.control.load is not None else self.reach + self.value_per_load * bears

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
        vanishes at half of the factor at which its width, extrapolated linearly, would be zero.
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
            rates_from = here if tight and size < ACCURACY.rough else None
            here = self.at(here.moved(here.newton), here.value, rates_from=rates_from)
        return self.at(here.table, here.value)
