"""The loading path: equilibria that are followed as a control rises and falls, and their jumps.

    rising     the contact grows along its curve, until the surfaces come together somewhere else,
               or the curve turns (gaps snap shut, ends jump on)
    falling    the contact shrinks along its curve, until the curve turns (zones vanish, ends jump
               back)

After a jump the ends come to rest at the next equilibrium in their direction
(contact.adhesion.gradient_flow). Where new zones begin, and whether closed surfaces open again,
depends on the law (contact.adhesion.events). Without a range of adhesion, surfaces that are
closed over the whole period stay closed, and zones never split. A gap inside a zone would begin
without width, and the edge intensity at its ends is proportional to the tension times sqrt(width).
So a gap opens only from a flaw whose width is proportional to 1/tension^2 (A. A. Griffith, Phil.
Trans. R. Soc. Lond. A 221, 1921, 163), and these surfaces have no flaws.
"""

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from contact.adhesion.arc_length import SymmetryLost, past_turning_point, pushed_off, steps
from contact.adhesion.arc_step import Step, let_go
from contact.adhesion.curve import ACCURACY, State
from contact.adhesion.events import Events, Jump, PathState
from contact.adhesion.options import LIMITS
from contact.errors import NotConverged
from contact.formulation.tables import gaps_between
from contact.search.topology.changes import changes
from sie import nearest_image


@dataclass(frozen=True)
class LoadingPath:
    """A loading path: the states of a problem's surfaces as the control changes.

    note: a function that is called with every equilibrium on the way.
    """

    events: Events
    note: Callable[[State], None] = field(default=lambda at: None)

    def to(self, here: PathState, value: float) -> Iterator[Jump | PathState]:
        """Generate the events from a path state to a control value, and the path state there."""
        sense = 1.0 if value >= here.value else -1.0
        for _ in range(LIMITS.max_steps):
            found = yield from self._next(here, value, sense)
            yield found
            if isinstance(found, PathState):
                return
            here = found.after
        raise NotConverged(
            f"the path has more than {LIMITS.max_steps} events before the next value of the control"
        )

    def _next(
        self, here: PathState, value: float, sense: float
    ) -> Generator[Jump | PathState, None, Jump | PathState]:
        events = self.events
        if here.point is None:
            if here.closed:
                jump = events.reopening(here, value) if sense < 0.0 else None
            else:
                jump = (
                    None if value < events.first or here.value > events.first else events.jump_in()
                )
            return replace(here, value=value) if jump is None else jump
        if here.value == value:
            return PathState(value, here.point)
        on_way = events.off_curve(here.point, value)
        return (
            yield from self._along(here.point, value, sense)
            if on_way is None
            else self._recorded(on_way)
        )

    def _recorded(
        self, events: Iterator[Jump | PathState]
    ) -> Generator[Jump | PathState, None, Jump | PathState]:
        """Yield all events except the last and return the last; pass each state to `note`."""
        last: Jump | PathState | None = None
        for found in events:
            if last is not None:
                yield last
            last = found
            standing = found if isinstance(found, PathState) else found.before
            if standing.point is not None:
                self.note(standing.point)
        assert last is not None
        return last

    def _along(
        self, here: State, value: float, sense: float
    ) -> Generator[Jump | PathState, None, Jump | PathState]:
        """Generate the events from the equilibrium `here` to the control's `value` or to a jump."""
        events = self.events
        try:
            for step in steps(events.curve, here, sense, False):
                length, last = step.length, step.end.at
                if step.turns:
                    length = step.turning()
                    last = step.at(length)
                if arrives := sense * (last.value - value) >= 0.0:
                    length, last = self._arriving(step, length, last, value)
                if (jump := events.first_jump(step, length, last, sense)) is not None:
                    assert jump.before.point is not None
                    yield from events.smooth_changes(step, length, jump.before.point)
                    return jump
                yield from events.smooth_changes(step, length, last)
                if arrives:
                    return PathState(value, last)
                if step.turns:
                    return self._turn(last, sense)
                if step.lets_go:
                    return self._let_go(step)
                if step.after is not None:
                    yield self._at_corner(step, step.after)
                self.note(last)
                here = last
        except NotConverged as failure:
            return self._ended(failure, here, value, sense)
        raise NotConverged("the curve of equilibria ended before the next value of the control")

    def _arriving(
        self, step: Step, length: float, last: State, value: float
    ) -> tuple[float, State]:
        """(length inside `step` at which the control equals `value`, equilibrium there)."""
        found = step.arriving(value)
        if found is None:
            length = step.where(
                lambda at: at.value - value,
                step.start.at.value - value,
                last.value - value,
                length,
                ACCURACY.resting_step,
                False,
            )
            found = self.events.curve.settled(replace(step.at(length), value=value))
        else:
            length = step.start.length(found)
        return length, found

    def _ended(self, failure: NotConverged, here: State, value: float, sense: float) -> Jump:
        """The jump at the end of the curve, if it comes before `value`; else raises `failure`."""
        end = self.events.vanishing(here, sense)
        if end is None and isinstance(failure, SymmetryLost):
            failure = failure.located()
            end = self._aside(failure)
        if end is None or sense * (end.before.value - value) > 0.0:
            raise failure
        return end

    def _aside(self, lost: SymmetryLost) -> Jump:
        """The jump where mirror symmetry is lost, to one of two states that mirror each other."""
        try:
            after = self.events.shrunk(pushed_off(lost.at), lost.at.value)
        except NotConverged:
            raise lost from None
        return self._jump(lost.at, float(lost.at.contact.mean()), after, False)

    def _at_corner(self, step: Step, after: State) -> Jump:
        """The event at which an end reaches or leaves a sharp corner without a jump."""
        before = step.end.at
        reached = bool((after.pinned & ~before.pinned).any())
        standing = PathState(before.value, after)
        return Jump(
            "held" if reached else "freed",
            _place(before, after),
            PathState(before.value, before),
            standing,
            smooth=True,
        )

    def _let_go(self, step: Step) -> Jump:
        """The event at which ends leave their sharp corners and jump inward."""
        last = step.end.at
        assert step.after is not None
        return self._jump(
            last, _place(last, step.after), self.events.shrunk(let_go(step), last.value), False
        )

    def _turn(self, last: State, sense: float) -> Jump:
        """The jump from an equilibrium at a turning point of the curve."""
        events, rises = self.events, sense > 0.0
        table = past_turning_point(events.curve, last, sense)
        place = float(last.table.ravel()[int(np.argmax(np.abs(table - last.table)))])
        return self._jump(
            last, place, (events.grown if rises else events.shrunk)(table, last.value), rises
        )

    def _jump(self, before: State, end: float, after: PathState, rises: bool) -> Jump:
        """The jump from the equilibrium `before`, in which the end at x = `end` moves first.

        The place of the jump is the middle of the zone that separates or of the gap that closes; of
        several zones or gaps, the one nearest to `end` counts. Intervals of tension without contact
        count as zones. If zones only change their widths, the place of the jump is `end`.
        """
        period = self.events.curve.problem.period
        zones = before.contact if len(before.contact) else before.table
        if after.point is None:
            gone = gaps_between(zones, period) if after.closed else zones
        else:
            found = changes(zones, after.point.contact, period, only_grows=False)
            gone = np.array([one.where for one in found if one.kind in ("death", "merge")])
        if len(gone):
            middles = gone.mean(axis=1)
            away = nearest_image(middles, end, period) - end
            end = float(middles[np.argmin(np.abs(away))])
        return self.events.jump(before, end, after, rises)


def _place(before: State, after: State) -> float:
    """Position of the first end that is pinned (at a sharp corner) in only one of two states."""
    return float(before.table.T.ravel()[int(np.argmax(before.pinned != after.pinned))])
