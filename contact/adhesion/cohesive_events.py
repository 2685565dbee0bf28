"""The events of a curve of equilibria under a tension of finite range.

The ends that jump are those of the intervals of tension. An interval begins where the gap falls
below the reach, and is cut where the gap exceeds the reach. A new interval, like a cut, has a
finite width at once. Inside the intervals the contact is frictionless: zones begin, merge, split
and vanish without a jump, where a pressure or a gap is zero. Under tension in all of a period no
end is free, and the contact is followed along the values of the control. Closed surfaces open where
their tension reaches the stress of the law.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from contact.adhesion import cohesive_flow, cohesive_pull_off
from contact.adhesion.arc_step import Step
from contact.adhesion.cohesive_state import CohesiveState, PastState
from contact.adhesion.cohesive_zone import CohesiveCurve
from contact.adhesion.corrector import along
from contact.adhesion.curve import ACCURACY, Closed, NoState, State
from contact.adhesion.curve_point import ARC_OPTIONS, onward
from contact.adhesion.events import Events, Jump, PathState, first_zero
from contact.adhesion.inner_contact import ContactLost, EndsCovered
from contact.adhesion.intervals import interval_of, joined
from contact.adhesion.nucleation import about, changes_between, condition, touched, with_change
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import NotConverged
from contact.formulation.roots import maximum, minimum, smooth_root
from contact.formulation.tables import ascending, located, runs_of
from contact.search.topology.changes import Change
from sie import Array, Index, wrapped

At = Callable[[float], CohesiveState]


@dataclass(frozen=True)
class CohesiveEvents(Events):
    """Events of a loading path under a tension of finite range.

    advanced: returns the equilibrium that grows from first touch under no load. pressed: returns
    the scaled zones under tension on the whole period, at a control value. full: value of the
    control at which surfaces under tension everywhere close. size: scale of the values of the
    control.
    """

    curve: CohesiveCurve
    advanced: Callable[[], CohesiveState]
    pressed: Callable[[float], Array]
    full: float
    size: float

    @property
    def first(self) -> float:
        return 0.0 if self.curve.control.load is not None else -self.curve.reach

    def jump_in(self) -> Jump:
        before = PathState(self.first)
        if self.curve.control.load is not None:
            try:
                after = PathState(self.first, self.curve.settled(self.advanced()))
            except Closed:
                after = self.under_all(self.first)
        else:
            after = self.grown(touched(self.curve, self.cell, self.first), self.first)
        place = (
            0.0
            if after.point is None
            else float(np.mean(after.point.table[:1]) if len(after.point.table) else 0.0)
        )
        return Jump("full" if after.closed else "jump-in", place, before, after)

    def grown(self, table: Array, value: float) -> PathState:
        try:
            return PathState(
                value, self.curve.settled(cohesive_flow.advanced(self.curve, table, value))
            )
        except Closed:
            return self.under_all(value)

    def shrunk(self, table: Array, value: float) -> PathState:
        rest = cohesive_flow.receded(self.curve, table, value)
        return PathState(value) if rest is None else PathState(value, self.curve.settled(rest))

    def kind(self, before: PathState, after: PathState, rises: bool) -> str:
        if after.apart or after.closed:
            return "pull-off" if after.apart else "full"
        if after.count == before.count:
            return "jump"
        fewer = after.count < before.count
        return ("merge" if fewer else "birth") if rises else ("death" if fewer else "split")

    def first_jump(self, step: Step, length: float, last: State, sense: float) -> Jump | None:
        """The first jump in a step: the gap crosses the reach of the tension.
        Outside the intervals of tension the gap falls below the reach, or inside them it rises
        above the reach. Points next to the ends of the intervals do not count. None if there is no
        jump.
        """
        found: list[tuple[float, float, float, bool]] = []
        for outside in (True, False):
            seen = self._wrong(last, outside)
            if len(seen):
                least, others = (
                    partial(self._least, outside=outside),
                    partial(self._wrong, outside=outside),
                )
                found.append((*first_zero(step, length, last, seen, least, others), outside))
        if not found:
            return None
        length, place, width, outside = min(found, key=lambda one: one[0])
        here = step.at(length)
        return self.jump(here, place, self._changed(here, place, width, outside), outside)

    def _changed(self, here: State, place: float, width: float, begins: bool) -> PathState:
        """The path state after an interval of tension begins at x = `place`, or is cut there."""
        curve, half, period = self.curve, 0.5 * MOVES.new_width * width, self.curve.problem.round
        if period is not None:
            place -= np.floor((place - here.table[0, 0]) / period) * period
        assert isinstance(here, CohesiveState)
        sign = 1.0 if begins else -1.0
        while True:
            if begins:
                table = joined(
                    here.table,
                    np.zeros(len(here.table), dtype=bool),
                    [(place - half, place + half)],
                    period,
                )
            else:
                table = _cut(here.table, place, half)
            try:
                at = curve.from_zones(table, here.value, curve.fitted(here.zones, table))
            except EndsCovered:
                # A zone of contact covers a new end, so the new ends are put closer to `place`.
                if half < ACCURACY.neutral:
                    raise
                half *= 0.1
                continue
            # The residuals must drive the new ends in the direction of the jump, outward where an
            # interval begins and inward where it is cut. They must drive no other end in the
            # opposite direction.
            new = np.abs(np.append(table[:, 0], table[:, 1]) - place) < 2 * half
            if half < ACCURACY.neutral or (
                np.all(sign * at.residual > -ACCURACY.resting_step)
                and np.all(sign * at.residual[new] > 0.0)
            ):
                break
            half *= 0.1
        return (self.grown if begins else self.shrunk)(table, here.value)

    def _wrong(self, here: State, outside: bool) -> Array:
        """Intervals (n, 2) in which the tension should act but does not, or should not but does.
        It should act where the gap is below the reach of the tension.

        With `outside`, only places without tension and with a gap below the reach are returned.
        Otherwise only places with tension and with a gap above the reach are returned. Places next
        to the ends of the intervals of tension do not count.
        """
        curve, period = self.curve, self.curve.problem.round
        assert isinstance(here, CohesiveState)
        (x, gap), table, found = here.gap_samples, here.table, []
        x = wrapped(x, float(table[0, 0]), period)
        order = np.argsort(x)
        x, gap = x[order], gap[order]
        inside = located(table, x)[1]
        wrong = (~inside & (gap < curve.reach)) if outside else (inside & (gap > curve.reach))
        ends = np.append(table.ravel(), table[0, 0] + (period or np.inf))
        for s, e in runs_of(wrong):
            lo, hi = x[max(s - 1, 0)], x[min(e + 1, len(x) - 1)]
            # An error of an interval's end causes a run of wrong samples next to this end. Such
            # runs are left out.
            if s > 0 and e < len(x) - 1 and not np.any((ends > lo) & (ends < hi)):
                found.append((lo, hi))
        return np.array(found).reshape(-1, 2)

    def _least(self, here: State, lo: float, hi: float, outside: bool) -> tuple[float, float]:
        """(x, value) of the least margin between the gap and the reach, for x from lo to hi.
        The margin is gap - reach where no tension acts (`outside`), and reach - gap where it acts.
        It is positive until an interval of tension begins at x, or is cut there.
        """
        curve, sign = self.curve, -1.0 if outside else 1.0
        place, most = maximum(
            lambda x: sign * (curve.gap(here, np.asarray(x)) - curve.reach), np.linspace(lo, hi, 17)
        )
        return place, -most

    def vanishing(self, here: State, sense: float) -> Jump | None:
        """The event at which a contact zone shrinks to a point; None if no zone does.

        The curve of equilibria ends at this event.
        """
        curve = self.curve
        assert isinstance(here, CohesiveState)
        if sense > 0.0 or len(here.zones) == 0:
            return None
        i = interval_of(here.zones, here.table)
        share = np.diff(here.zones, axis=1)[:, 0] / np.diff(here.table, axis=1)[i, 0]
        k = int(np.argmin(share))
        if share[k] > MOVES.small_part:
            return None
        if curve.control.load is not None and share.max() <= MOVES.small_part:
            last = cohesive_pull_off.touching(curve, here.table, float(here.zones[k].mean()))
            others = np.delete(here.zones.mean(axis=1), k)
            points = np.sort(np.append(others, last.zones[0, 0]))
            last = replace(last, zones=np.column_stack((points, points)))
            return Jump(
                "pull-off",
                float(last.zones[0, 0]),
                PathState(last.value, last),
                PathState(last.value),
            )
        # Usually one zone vanishes alone, but equal zones vanish together.
        for vanishing in (np.array([k]), np.flatnonzero(share <= MOVES.small_part)):
            touch = self._without(here, vanishing)
            if touch is not None:
                break
        else:
            return None
        places, state = touch
        touching = replace(
            state, zones=ascending(np.concatenate((state.zones, np.column_stack((places, places)))))
        )
        place = float(places[0])
        if state.growth < 0.0:
            return Jump(
                "death",
                place,
                PathState(state.value, touching),
                PathState(state.value, state),
                smooth=True,
            )
        width = float(np.diff(state.table[i[k]])[0])
        table = state.table.copy()
        table[i[k]] += np.array([MOVES.short_move, -MOVES.short_move]) * width
        return self.jump(touching, place, self.shrunk(table, state.value), False)

    def _without(self, here: CohesiveState, vanishing: Index) -> tuple[Array, CohesiveState] | None:
        """(positions x at which zones vanish, equilibrium without them and with zero gap there).

        None if no such equilibrium is found.
        """
        count, period = len(here.zones), self.curve.problem.round
        others = np.delete(here.zones, vanishing, axis=0)
        each = [
            Change("death", about(others, float(a), float(b), period))
            for a, b in here.zones[vanishing]
        ]
        known = PastState(
            here.table,
            here.value,
            others,
            np.delete(here.by_ends, np.append(vanishing, vanishing + count), axis=0),
        )
        formal = replace(self.curve, formal=True, known=[known])

        def state(value: float, table: Array) -> CohesiveState:
            at, before = formal.at(table, value), np.inf
            for _ in range(LIMITS.max_iterations):
                step = np.linalg.solve(-at.rates, at.residual)
                at = formal.at(at.moved(np.asarray(step, dtype=np.float64)), value)
                size = float(np.abs(step / at.widths).max())
                # The iteration ends if this Newton step is small, or if the next step is predicted
                # to be small. It also ends if the steps no longer shrink because of round-off.
                if (
                    size < ACCURACY.neutral
                    or size * size < ACCURACY.neutral * before
                    or 0.5 * before < size < ACCURACY.rough
                ):
                    break
                before = size
            return at

        touches = ACCURACY.rough * self.curve.reach
        value, step = here.value, 1e-4 / float(np.abs(here.by_value).max())
        try:
            at = state(value, here.table)
            least = condition(formal, at, each[0])[1]
            for _ in range(LIMITS.max_iterations):
                at = state(value + step, at.table)
                value, before, least = value + step, least, condition(formal, at, each[0])[1]
                if (
                    least == before
                    or 0.5 * abs(before) < abs(least) < touches
                    or abs(step) < 1e-2 * ACCURACY.neutral * abs(value)
                ):
                    break
                step *= -least / (least - before)
        except (NotConverged, NoState, np.linalg.LinAlgError):
            return None
        if abs(least) > touches or at.gap_samples[1].min() < -touches:
            return None
        return np.sort([condition(formal, at, one)[0] for one in each]), at

    def smooth_changes(self, step: Step, length: float, last: State) -> Iterator[Jump]:
        def at(part: float) -> CohesiveState:
            here = step.at(part)
            assert isinstance(here, CohesiveState)
            return here

        def states_from(here: CohesiveState, ahead: bool, reach: float) -> Iterator[At]:
            place = onward(self.curve, step.start, here)
            if not ahead:
                place = replace(place, tangent=-place.tangent)
            formal = self._formal(here)
            # `formally` follows the curve with as many zones of contact as `here`, the state at one
            # end of the step. The number of zones may change just beyond the other end of the step.
            # So three ranges of increasing length are tried.
            for past in (0.0, MOVES.small_part, ARC_OPTIONS.longest_step):

                def formally(u: float, part: float = 1.0 + past) -> CohesiveState:
                    found = here if u == 0.0 else along(formal, place, u * part * reach)
                    if not isinstance(found, CohesiveState):
                        raise NotConverged(
                            "a change of the zones inside a step of the path was not located"
                        )
                    return found

                yield formally

        start = step.start.at
        assert isinstance(start, CohesiveState) and isinstance(last, CohesiveState)
        yield from self._between(at, states_from, (0.0, start), (length, last))

    def _formal(self, here: CohesiveState) -> CohesiveCurve:
        return replace(
            self.curve,
            formal=True,
            known=[PastState(here.table, here.value, here.zones, here.by_ends)],
        )

    def _between(
        self,
        at: At,
        states_from: Callable[[CohesiveState, bool, float], Iterator[At]],
        low: tuple[float, CohesiveState],
        high: tuple[float, CohesiveState],
        least: float | None = None,
    ) -> Iterator[Jump]:
        """Generate the jumps at which zones begin, merge, split or vanish between two states.

        low, high: pairs of a position on the path and the state there; at: the state at a position.
        states_from: for a given state, yields functions of a fraction u from 0 to 1. Each returns
        the state after this fraction of the way, ahead of or behind the given state, with as many
        zones. least: smallest range of positions that is halved if several zones change in it; by
        default a small part of the range from low to high.
        """
        found = changes_between(low[1], high[1], self.curve.problem.round)
        if not found:
            return
        if least is None:
            least = ACCURACY.coarse * abs(high[0] - low[0])
        if len(found) > 1 and abs(high[0] - low[0]) > least:
            middle = 0.5 * (low[0] + high[0])
            state = middle, at(middle)
            yield from self._between(at, states_from, low, state, least)
            yield from self._between(at, states_from, state, high, least)
            return
        for change in found:
            jump = self._located(change, states_from, low, high)
            if jump is not None:
                yield jump

    def _located(
        self,
        change: Change,
        states_from: Callable[[CohesiveState, bool, float], Iterator[At]],
        low: tuple[float, CohesiveState],
        high: tuple[float, CohesiveState],
    ) -> Jump | None:
        smooth = low[1] if change.ahead else high[1]
        first = condition(self.curve, smooth, change)[1]
        if not first > 0.0:
            return None
        for formally in states_from(smooth, change.ahead, high[0] - low[0]):
            try:
                last = condition(self.curve, formally(1.0), change)[1]
            except (NotConverged, NoState):
                continue
            if last < 0.0:
                break
        else:
            return None
        try:
            root = smooth_root(
                lambda u: condition(self.curve, formally(u), change)[1],
                {0.0: first, 1.0: last},
                ACCURACY.neutral,
            )
            here = formally(root)
        except (NotConverged, NoState):
            return None
        place = condition(self.curve, here, change)[0]
        other = replace(here, zones=with_change(here.zones, change, place))
        before, after = (here, other) if change.ahead else (other, here)
        return Jump(
            change.kind,
            place,
            PathState(here.value, before),
            PathState(here.value, after),
            smooth=True,
        )

    def under_all(self, value: float) -> PathState:
        """The path state at the control value `value`, with tension on the whole period.
        From the control value `self.full` on, the surfaces are in full contact.
        """
        if value >= self.full:
            return PathState(value, closed=True)
        return PathState(value, self.curve.under_all(value, self.pressed(value)))

    def reopening(self, here: PathState, value: float) -> Jump | None:
        if value >= self.full:
            return None
        after = self.under_all(self.full - ACCURACY.resting_step * self.size)
        assert isinstance(after.point, CohesiveState)
        return Jump(
            "open",
            self._last_gap(after.point),
            PathState(self.full, closed=True),
            replace(after, value=self.full),
            smooth=True,
        )

    def _last_gap(self, here: CohesiveState) -> float:
        (x, gap) = here.gap_samples
        return float(x[int(np.argmax(gap))])

    def off_curve(self, here: State, value: float) -> Iterator[Jump | PathState] | None:
        return (
            self._under_all_to(here, value)
            if isinstance(here, CohesiveState) and here.everywhere
            else None
        )

    def _under_all_to(self, here: CohesiveState, value: float) -> Iterator[Jump | PathState]:
        rises = value > here.value
        end = min(value, self.full - ACCURACY.resting_step * self.size) if rises else value
        # The path is followed while there are gaps. So the last control value `end` is below
        # `self.full`, the value at which all gaps close.
        at, step, halvings = here.value, MOVES.small_part * (end - here.value), 0
        while at != end:
            ahead = end if abs(step) >= abs(end - at) else at + step
            try:
                new = self.curve.under_all(ahead, here.zones)
            except ContactLost:
                yield self._lost(here)
                return
            except (NotConverged, NoState):
                step, halvings = 0.5 * step, halvings + 1
                if halvings > LIMITS.max_iterations:
                    raise
                continue
            jump = None if rises else self._let_go(here, new)
            last = new if jump is None else jump.before.point
            assert isinstance(last, CohesiveState)
            yield from self._between(
                partial(self.curve.under_all, zones=here.zones),
                self._by_value(here, new),
                (here.value, here),
                (last.value, last),
            )
            if jump is not None:
                yield jump
                return
            if ahead != end:
                yield PathState(ahead, new)
            here, at = new, ahead
        if end == value:
            yield PathState(value, here)
        else:
            yield Jump(
                "full",
                self._last_gap(here),
                PathState(self.full, here),
                PathState(self.full, closed=True),
                smooth=True,
            )

    def _by_value(
        self, low: CohesiveState, high: CohesiveState
    ) -> Callable[[CohesiveState, bool, float], Iterator[At]]:
        def states_from(here: CohesiveState, ahead: bool, reach: float) -> Iterator[At]:
            formal, move = self._formal(here), reach if ahead else -reach
            yield (
                lambda u: here if u == 0.0 else formal.under_all(here.value + u * move, here.zones)
            )

        return states_from

    def _let_go(self, here: CohesiveState, new: CohesiveState) -> Jump | None:
        """The jump where, as the control falls, the gap first exceeds the reach of the tension.

        None if the gap does not exceed the reach between the states `here` and `new`.
        """
        curve, period = self.curve, self.curve.problem.round
        (x, gap) = new.gap_samples
        if not gap.max() > curve.reach:
            return None
        assert period is not None

        def most(value: float) -> tuple[CohesiveState, float, float]:
            at = curve.under_all(value, here.zones)
            place, height = maximum(lambda y: curve.gap(at, np.asarray(y)), at.gap_samples[0])
            return at, place, height - curve.reach

        value, first = here.value, most(here.value)[2]
        if first < 0.0:
            value = smooth_root(lambda v: most(v)[2], {value: first, new.value: most(new.value)[2]})
        at, place, _ = most(value)
        half = 0.5 * MOVES.new_width * period
        while True:
            table = np.array([[place + half, place + period - half]])
            try:
                cut = curve.from_zones(table, value, curve.fitted(at.zones, table))
                if half < ACCURACY.neutral or np.all(cut.residual < ACCURACY.resting_step):
                    break
            except (ContactLost, EndsCovered):
                if half < ACCURACY.neutral:
                    break
            half *= 0.1
        return self.jump(at, place, self.shrunk(table, value), False)

    def _lost(self, here: CohesiveState) -> Jump:
        """The jump at which the last zone shrinks to a point, under tension on the whole period."""
        pulled = self.curve.everywhere
        samples = [np.sort(here.gap_samples[0]), *(np.linspace(a, b, 65) for a, b in here.zones)]
        place, lowest = min((minimum(pulled.shape, x) for x in samples), key=lambda found: found[1])
        value = -pulled.pulling.total
        touch = CohesiveState.under_all(
            value, value, -lowest, np.array([[place, place]]), None, (np.zeros(0), np.zeros(0))
        )
        return Jump("pull-off", place, PathState(value, touch), PathState(value))


def _cut(table: Array, place: float, half: float) -> Array:
    """The intervals of tension, without the points from `place - half` to `place + half`."""
    i = int(interval_of(np.array([[place, place]]), table)[0])
    return np.concatenate(
        (table[:i], [[table[i, 0], place - half], [place + half, table[i, 1]]], table[i + 1 :])
    )
