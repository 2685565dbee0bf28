"""What happens on the way along a curve of equilibria where a tension acts beside the contact
(contact.adhesion.cohesive_zone).

The ends that jump are those of the tension: its intervals begin where the gap comes below the
reach, and are cut where it comes above, and either takes a width at once. Within them the contact
is frictionless: zones begin, meet, part and vanish without a jump, where a pressure or a gap is
zero. Under tension in all of a period there are no ends, and the contact is followed by the value
of the control; closed surfaces open from there where their tension comes to the stress.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from contact.adhesion import arc_length, cohesive_flow, cohesive_pull_off
from contact.adhesion.arc_length import Step
from contact.adhesion.cohesive_zone import Cohesive, CohesivePoint, Known
from contact.adhesion.curve import Closed, NoState, Point
from contact.adhesion.events import LEAST, NEW, SLIGHT, Following, Jump, Standing, first_of
from contact.adhesion.inner_contact import Covered, Lost
from contact.adhesion.intervals import interval_of, joined
from contact.adhesion.nucleation import about, changes_between, condition, touched, with_change
from contact.errors import NotConverged
from contact.formulation.roots import maximum, minimum, smooth_root
from contact.formulation.tables import ascending, located, runs_of
from contact.search.topology.changes import Change
from sie import Array, Index, wrapped

At = Callable[[float], CohesivePoint]

# Steps by the value of the control, and how often one is halved; how often a stretch with several
# changes is.
_STEPS = 8
_HALVINGS = 40
_PARTS = 12
# How much farther than a step its end is looked for, seen from there.
_FARTHER = (1.0, 1.1, 1.5)
# Newton's steps to an equilibrium, the last one over the widths, and a gap over the reach that is
# none.
_NEWTON = 20
_STILL = 1e-12
_TOUCHES = 1e-9
# Of a value, a step to where contact vanishes that is none.
_STEADY = 1e-14
# Over its width, how far an interval of tension is pushed inward that has let go.
_PUSH = 0.03
# Of the value, short of full contact: there the last gap closes.
_SHORT = 1e-7


@dataclass(frozen=True)
class FollowingUnderTension(Following):
    """advanced: the least equilibrium about first touch under no load; pressed: scaled zones under
    tension in all of a period; full: value of the control from which surfaces under tension
    everywhere are closed, size: what such values are counted in.
    """

    curve: Cohesive
    advanced: Callable[[], CohesivePoint]
    pressed: Callable[[float], Array]
    full: float
    size: float

    @property
    def first(self) -> float:
        return 0.0 if self.curve.held.load is not None else -self.curve.reach

    def begun(self) -> Jump:
        before = Standing(self.first)
        if self.curve.held.load is not None:
            try:
                after = Standing(self.first, self.curve.settled(self.advanced()))
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

    def grown(self, table: Array, value: float) -> Standing:
        try:
            return Standing(
                value, self.curve.settled(cohesive_flow.advanced(self.curve, table, value))
            )
        except Closed:
            return self.under_all(value)

    def shrunk(self, table: Array, value: float) -> Standing:
        rest = cohesive_flow.receded(self.curve, table, value)
        return Standing(value) if rest is None else Standing(value, self.curve.settled(rest))

    def kind(self, before: Standing, after: Standing, rises: bool) -> str:
        if after.apart or after.closed:
            return "pull-off" if after.apart else "full"
        if after.count == before.count:
            return "jump"
        fewer = after.count < before.count
        return ("merge" if fewer else "birth") if rises else ("death" if fewer else "split")

    # where a tension begins or lets go
    # -------------------------------------------------------------------------------
    def interrupted(self, step: Step, length: float, last: Point, sense: float) -> Jump | None:
        """The first place within a step at which the gap comes to the reach away from the ends of
        the tension.
        """
        found: list[tuple[float, float, float, bool]] = []
        for outside in (True, False):
            seen = self._wrong(last, outside)
            if len(seen):
                least, others = (
                    partial(self._least, outside=outside),
                    partial(self._wrong, outside=outside),
                )
                found.append((*first_of(step, length, last, seen, least, others), outside))
        if not found:
            return None
        length, place, width, outside = min(found, key=lambda one: one[0])
        here = step.at(length)
        return self.jump(here, place, self._changed(here, place, width, outside), outside)

    def _changed(self, here: Point, place: float, width: float, begins: bool) -> Standing:
        """What an interval of tension that begins at a place comes to, or one that is cut there."""
        curve, half, period = self.curve, 0.5 * NEW * width, self.curve.problem.round
        if period is not None:
            place -= np.floor((place - here.table[0, 0]) / period) * period
        assert isinstance(here, CohesivePoint)
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
            at = curve.from_zones(table, here.value, curve.fitted(here.zones, table))
            # The ends that are new are driven, all others at rest.
            new = np.abs(np.append(table[:, 0], table[:, 1]) - place) < 2 * half
            if half < LEAST or (
                np.all(sign * at.residual > -SLIGHT) and np.all(sign * at.residual[new] > 0.0)
            ):
                break
            half *= 0.1
        return (self.grown if begins else self.shrunk)(table, here.value)

    def _wrong(self, here: Point, outside: bool) -> Array:
        """Places away from the ends of the tension between which the gap is below the reach outside
        of it, or above it inside (n, 2).
        """
        curve, period = self.curve, self.curve.problem.round
        assert isinstance(here, CohesivePoint)
        (x, gap), table, found = here.look, here.table, []
        x = wrapped(x, float(table[0, 0]), period)
        order = np.argsort(x)
        x, gap = x[order], gap[order]
        inside = located(table, x)[1]
        wrong = (~inside & (gap < curve.reach)) if outside else (inside & (gap > curve.reach))
        ends = np.append(table.ravel(), table[0, 0] + (period or np.inf))
        for s, e in runs_of(wrong):
            lo, hi = x[max(s - 1, 0)], x[min(e + 1, len(x) - 1)]
            # A run beside an end is what the end misses by.
            if s > 0 and e < len(x) - 1 and not np.any((ends > lo) & (ends < hi)):
                found.append((lo, hi))
        return np.array(found).reshape(-1, 2)

    def _least(self, here: Point, lo: float, hi: float, outside: bool) -> tuple[float, float]:
        """(place, value) of what is above zero while no tension begins, or lets go, between two
        places.
        """
        curve, sign = self.curve, -1.0 if outside else 1.0
        place, most = maximum(
            lambda x: sign * (curve.gap(here, np.asarray(x)) - curve.reach), np.linspace(lo, hi, 17)
        )
        return place, -most

    def gone(self, here: Point, sense: float) -> Jump | None:
        """Contact that shrinks to a point within its interval of tension, and on which the interval
        hangs: without it that lets go.
        """
        curve = self.curve
        assert isinstance(here, CohesivePoint)
        if sense > 0.0 or len(here.zones) == 0:
            return None
        i = interval_of(here.zones, here.table)
        share = np.diff(here.zones, axis=1)[:, 0] / np.diff(here.table, axis=1)[i, 0]
        k = int(np.argmin(share))
        if share[k] > cohesive_pull_off.SHRUNK:
            return None
        if curve.held.load is not None and share.max() <= cohesive_pull_off.SHRUNK:
            last = cohesive_pull_off.touching(curve, here.table, float(here.zones[k].mean()))
            others = np.delete(here.zones.mean(axis=1), k)
            points = np.sort(np.append(others, last.zones[0, 0]))
            last = replace(last, zones=np.column_stack((points, points)))
            return Jump(
                "pull-off",
                float(last.zones[0, 0]),
                Standing(last.value, last),
                Standing(last.value),
            )
        # As a rule one alone, but two of the same kind together.
        for gone in (np.array([k]), np.flatnonzero(share <= cohesive_pull_off.SHRUNK)):
            touch = self._without(here, gone)
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
                Standing(state.value, touching),
                Standing(state.value, state),
                smooth=True,
            )
        width = float(np.diff(state.table[i[k]])[0])
        table = state.table.copy()
        table[i[k]] += np.array([_PUSH, -_PUSH]) * width
        return self.jump(touching, place, self.shrunk(table, state.value), False)

    def _without(self, here: CohesivePoint, gone: Index) -> tuple[Array, CohesivePoint] | None:
        """(places, equilibrium) in which the surfaces just touch where zones are about to vanish;
        None if it was not found.
        """
        count, period = len(here.zones), self.curve.problem.round
        others = np.delete(here.zones, gone, axis=0)
        each = [
            Change("death", about(others, float(a), float(b), period)) for a, b in here.zones[gone]
        ]
        known = Known(
            here.table,
            here.value,
            others,
            np.delete(here.by_ends, np.append(gone, gone + count), axis=0),
        )
        formal = replace(self.curve, formal=True, known=[known])

        def state(value: float, table: Array) -> CohesivePoint:
            at, before = formal.at(table, value), np.inf
            for _ in range(_NEWTON):
                step = np.linalg.solve(-at.rates, at.residual)
                at = formal.at(at.moved(np.asarray(step, dtype=np.float64)), value)
                size = float(np.abs(step / at.widths).max())
                # What is left falls as the steps do, until it is rounding.
                if size < _STILL or size * size < _STILL * before or 0.5 * before < size < _TOUCHES:
                    break
                before = size
            return at

        touches = _TOUCHES * self.curve.reach
        value, step = here.value, 1e-4 / float(np.abs(here.by_value).max())
        try:
            at = state(value, here.table)
            least = condition(formal, at, each[0])[1]
            for _ in range(_NEWTON):
                at = state(value + step, at.table)
                value, before, least = value + step, least, condition(formal, at, each[0])[1]
                if (
                    least == before
                    or 0.5 * abs(before) < abs(least) < touches
                    or abs(step) < _STEADY * abs(value)
                ):
                    break
                step *= -least / (least - before)
        except (NotConverged, NoState, np.linalg.LinAlgError):
            return None
        if abs(least) > touches or at.look[1].min() < -touches:
            return None
        return np.sort([condition(formal, at, one)[0] for one in each]), at

    # what changes without a jump
    # ----------------------------------------------------------------------------------------
    def passed(self, step: Step, length: float, last: Point) -> Iterator[Jump]:
        def at(part: float) -> CohesivePoint:
            here = step.at(part)
            assert isinstance(here, CohesivePoint)
            return here

        def beside(here: CohesivePoint, ahead: bool, reach: float) -> Iterator[At]:
            place = arc_length.onward(self.curve, step.start, here)
            if not ahead:
                place = replace(place, tangent=-place.tangent)
            formal = self._formal(here)
            for part in _FARTHER:

                def formally(u: float, part: float = part) -> CohesivePoint:
                    found = here if u == 0.0 else arc_length.along(formal, place, u * part * reach)
                    if not isinstance(found, CohesivePoint):
                        raise NotConverged(
                            "a change of the zones on the way along a curve was not located"
                        )
                    return found

                yield formally

        start = step.start.at
        assert isinstance(start, CohesivePoint) and isinstance(last, CohesivePoint)
        yield from self._between(at, beside, (0.0, start), (length, last), _PARTS)

    def _formal(self, here: CohesivePoint) -> Cohesive:
        return replace(
            self.curve, formal=True, known=[Known(here.table, here.value, here.zones, here.by_ends)]
        )

    def _between(
        self,
        at: At,
        beside: Callable[[CohesivePoint, bool, float], Iterator[At]],
        low: tuple[float, CohesivePoint],
        high: tuple[float, CohesivePoint],
        parts: int,
    ) -> Iterator[Jump]:
        """Changes of the zones between two states. beside: from a state on, ahead or back so far at
        1, with the zones that it has.
        """
        found = changes_between(low[1], high[1], self.curve.problem.round)
        if not found:
            return
        if len(found) > 1 and parts:
            middle = 0.5 * (low[0] + high[0])
            state = middle, at(middle)
            yield from self._between(at, beside, low, state, parts - 1)
            yield from self._between(at, beside, state, high, parts - 1)
            return
        for change in found:
            jump = self._located(change, beside, low, high)
            if jump is not None:
                yield jump

    def _located(
        self,
        change: Change,
        beside: Callable[[CohesivePoint, bool, float], Iterator[At]],
        low: tuple[float, CohesivePoint],
        high: tuple[float, CohesivePoint],
    ) -> Jump | None:
        smooth = low[1] if change.ahead else high[1]
        first = condition(self.curve, smooth, change)[1]
        if not first > 0.0:
            return None
        for formally in beside(smooth, change.ahead, high[0] - low[0]):
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
                arc_length.NEAR,
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
            Standing(here.value, before),
            Standing(here.value, after),
            smooth=True,
        )

    # tension everywhere
    # ---------------------------------------------------------------------------------------------------
    def under_all(self, value: float) -> Standing:
        """Under tension in all of a period."""
        if value >= self.full:
            return Standing(value, closed=True)
        return Standing(value, self.curve.under_all(value, self.pressed(value)))

    def opened(self, here: Standing, value: float) -> Jump | None:
        if value >= self.full:
            return None
        after = self.under_all(self.full - _SHORT * self.size)
        assert isinstance(after.point, CohesivePoint)
        return Jump(
            "open",
            self._last_gap(after.point),
            Standing(self.full, closed=True),
            replace(after, value=self.full),
            smooth=True,
        )

    def _last_gap(self, here: CohesivePoint) -> float:
        (x, gap) = here.look
        return float(x[int(np.argmax(gap))])

    def beside_curve(self, here: Point, value: float) -> Iterator[Jump | Standing] | None:
        return (
            self._under_all_to(here, value)
            if isinstance(here, CohesivePoint) and here.everywhere
            else None
        )

    def _under_all_to(self, here: CohesivePoint, value: float) -> Iterator[Jump | Standing]:
        rises = value > here.value
        end = min(value, self.full - _SHORT * self.size) if rises else value
        # Seen from full contact on, the first value lies short of it.
        at, step, halvings = here.value, (end - here.value) / _STEPS, 0
        while at != end:
            ahead = end if abs(step) >= abs(end - at) else at + step
            try:
                new = self.curve.under_all(ahead, here.zones)
            except Lost:
                yield self._lost(here)
                return
            except (NotConverged, NoState):
                step, halvings = 0.5 * step, halvings + 1
                if halvings > _HALVINGS:
                    raise
                continue
            jump = None if rises else self._let_go(here, new)
            last = new if jump is None else jump.before.point
            assert isinstance(last, CohesivePoint)
            yield from self._between(
                partial(self.curve.under_all, zones=here.zones),
                self._by_value(here, new),
                (here.value, here),
                (last.value, last),
                _PARTS,
            )
            if jump is not None:
                yield jump
                return
            if ahead != end:
                yield Standing(ahead, new)
            here, at = new, ahead
        if end == value:
            yield Standing(value, here)
        else:
            yield Jump(
                "full",
                self._last_gap(here),
                Standing(self.full, here),
                Standing(self.full, closed=True),
                smooth=True,
            )

    def _by_value(
        self, low: CohesivePoint, high: CohesivePoint
    ) -> Callable[[CohesivePoint, bool, float], Iterator[At]]:
        def beside(here: CohesivePoint, ahead: bool, reach: float) -> Iterator[At]:
            formal, move = self._formal(here), reach if ahead else -reach
            yield (
                lambda u: here if u == 0.0 else formal.under_all(here.value + u * move, here.zones)
            )

        return beside

    def _let_go(self, here: CohesivePoint, new: CohesivePoint) -> Jump | None:
        """Where the gap somewhere comes to the reach as the control falls."""
        curve, period = self.curve, self.curve.problem.round
        (x, gap) = new.look
        if not gap.max() > curve.reach:
            return None
        assert period is not None

        def most(value: float) -> tuple[CohesivePoint, float, float]:
            at = curve.under_all(value, here.zones)
            place, height = maximum(lambda y: curve.gap(at, np.asarray(y)), at.look[0])
            return at, place, height - curve.reach

        value, first = here.value, most(here.value)[2]
        if first < 0.0:
            value = smooth_root(lambda v: most(v)[2], {value: first, new.value: most(new.value)[2]})
        at, place, _ = most(value)
        half = 0.5 * NEW * period
        while True:
            table = np.array([[place + half, place + period - half]])
            try:
                cut = curve.from_zones(table, value, curve.fitted(at.zones, table))
                if half < LEAST or np.all(cut.residual < SLIGHT):
                    break
            except (Lost, Covered):
                if half < LEAST:
                    break
            half *= 0.1
        return self.jump(at, place, self.shrunk(table, value), False)

    def _lost(self, here: CohesivePoint) -> Jump:
        """Under a held load, where the last contact under tension everywhere shrinks to a point."""
        pulled = self.curve.everywhere
        looks = [np.sort(here.look[0]), *(np.linspace(a, b, 65) for a, b in here.zones)]
        place, lowest = min((minimum(pulled.shape, x) for x in looks), key=lambda found: found[1])
        value = -pulled.pulling.total
        touch = CohesivePoint.under_all(
            value, value, -lowest, np.array([[place, place]]), None, (np.zeros(0), np.zeros(0))
        )
        return Jump("pull-off", place, Standing(value, touch), Standing(value))


def _cut(table: Array, place: float, half: float) -> Array:
    """The intervals, the one about a place without what lies about it."""
    i = int(interval_of(np.array([[place, place]]), table)[0])
    return np.concatenate(
        (table[:i], [[table[i, 0], place - half], [place + half, table[i, 1]]], table[i + 1 :])
    )
