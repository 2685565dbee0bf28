"""The events that interrupt a curve of equilibria: zones begin, merge, close or are lost.

`Events` is for adhesion whose tension acts at the ends of zones only (JKR). A zone begins where
surfaces touch and jumps to a finite width, so that every change of the zones is a jump.
contact.adhesion.cohesive_events derives from it the events under a tension that acts across a gap.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from contact.adhesion.arc_step import Step
from contact.adhesion.curve import ACCURACY, Closed, Curve, State
from contact.adhesion.energy_descent import relaxed
from contact.adhesion.gradient_flow import receded
from contact.adhesion.nucleation import grown, touched
from contact.adhesion.options import MOVES
from contact.errors import NotConverged
from contact.formulation.roots import minimum
from contact.verify.certificate import openings
from sie import Array, record


@record
class PathState:
    """The state of a loading path at a value of the control.

    It is an equilibrium, or surfaces closed over the whole period, or surfaces apart.
    """

    value: float
    point: State | None = None
    closed: bool = False

    @property
    def apart(self) -> bool:
        return self.point is None and not self.closed

    @property
    def count(self) -> int:
        """Number of zones of contact."""
        return 0 if self.point is None else len(self.point.contact)


@record
class Jump:
    """An event of a loading path at which the zones of contact change.

    kind: see contact.sweeps.adhesive. place: scaled position x at which the change begins. smooth:
    true if no end jumps and no energy is lost.
    """

    kind: str
    place: float
    before: PathState
    after: PathState
    smooth: bool = False


def moves_both_ways(curve: Curve) -> bool:
    """Whether an advancing end may make other ends recede under this control.

    This happens under a fixed approach over a whole period or between sharp corners. Then every
    change of the control is followed through all jumps.
    """
    return curve.control.load is None and (
        curve.problem.period is not None or curve.problem.profile.support is not None
    )


@dataclass(frozen=True)
class Events:
    """Events of a loading path under adhesion that acts at the ends of zones only (JKR).

    cell: the interval [m] in which the surfaces first touch.
    """

    curve: Curve
    cell: tuple[float, float]

    @property
    def first(self) -> float:
        """Control value at which approaching surfaces first touch: zero load or approach."""
        return 0.0

    @property
    def by_load(self) -> bool:
        """Whether the load is the control."""
        return self.curve.control.load is not None

    def jump_in(self) -> Jump:
        """The jump from separated surfaces into contact."""
        table = touched(self.curve, self.cell, self.first)
        after = self.grown(table, self.first)
        return Jump(
            "full" if after.closed else "jump-in",
            float(table[0].mean()),
            PathState(self.first),
            after,
        )

    def reopening(self, here: PathState, value: float) -> Jump | None:
        """The jump at which closed surfaces open while the control decreases to `value`.

        None for JKR, since closed surfaces stay closed under adhesion without range.
        """
        return None

    def off_curve(self, here: State, value: float) -> Iterator[Jump | PathState] | None:
        """The events from a state under tension on the whole period to the control value `value`.
        The last event is a jump, or the path state at `value`. None if the tension acts on
        intervals, and always None under adhesion at the ends of zones.
        """
        return None

    def grown(self, table: Array, value: float) -> PathState:
        """The path state reached when the ends of given zones have advanced to an equilibrium."""
        try:
            try:
                return self._path_state(grown(self.curve, table, value))
            except NotConverged:
                # Under a fixed approach, an end that advances may stop another end or make it
                # recede.
                rest = None if self.by_load else relaxed(self.curve, table, value)
                if rest is None:
                    raise
                return self._path_state(rest)
        except Closed:
            return PathState(value, closed=True)

    def shrunk(self, table: Array, value: float) -> PathState:
        """The path state reached when the ends of given zones have receded to an equilibrium.

        Under a fixed approach in periodic contact, a lost zone lets the surfaces come closer
        elsewhere, so that zones may begin there.
        """
        try:
            rest = (receded if self.by_load else relaxed)(self.curve, table, value)
        except Closed:
            return PathState(value, closed=True)
        if rest is None:
            return (
                PathState(value)
                if self.by_load or value <= self.first
                else self.grown(touched(self.curve, self.cell, value), value)
            )
        return self._path_state(rest)

    def _path_state(self, here: State) -> PathState:
        rest = self.curve.settled(here)
        if not float(np.abs(rest.residual).max()) < ACCURACY.resting_step:
            raise NotConverged(
                "after a jump the ends of the zones did not reach an equilibrium, so the path "
                "could not be followed further"
            )
        return PathState(rest.value, rest)

    def kind(self, before: PathState, after: PathState, rises: bool) -> str:
        """Kind of a jump between two path states, such as "merge", "death" or "pull-off"."""
        if after.apart:
            return "pull-off"
        if after.closed:
            return "full"
        return ("merge" if rises else "death") if after.count < before.count else "jump"

    def jump(self, here: State, place: float, after: PathState, rises: bool) -> Jump:
        """The jump from the equilibrium `here` to the state `after`; it begins at x = `place`."""
        before = PathState(here.value, here)
        return Jump(self.kind(before, after, rises), place, before, after)

    def vanishing(self, here: State, sense: float) -> Jump | None:
        """The event at which a vanishing zone ends the curve of equilibria; none for JKR."""
        return None

    def smooth_changes(self, step: Step, length: float, last: State) -> Iterator[Jump]:
        """The events inside a step at which zones change but no end jumps; none for JKR."""
        return iter(())

    def first_jump(self, step: Step, length: float, last: State, sense: float) -> Jump | None:
        """The first jump in a step, where surfaces touch outside the zones; None if they do not."""
        may_overlap = sense > 0.0 or not self.by_load
        overlaps = (
            openings(self.curve.fields(last, ACCURACY.rough)).overlaps
            if may_overlap
            else np.zeros((0, 2))
        )
        if len(overlaps) == 0:
            return None
        curve = self.curve

        def least(at: State, lo: float, hi: float) -> tuple[float, float]:
            return minimum(curve.fields(at, ACCURACY.rough).formal_gap, np.linspace(lo, hi, 17))

        length, place, width = first_zero(
            step,
            length,
            last,
            overlaps,
            least,
            lambda at: openings(curve.fields(at, ACCURACY.rough)).overlaps,
        )
        here = step.at(length)
        after = self.grown(self._with_new(here, place, 0.5 * MOVES.new_width * width), here.value)
        return Jump("full" if after.closed else "birth", place, PathState(here.value, here), after)

    def _with_new(self, here: State, place: float, half: float) -> Array:
        """The zones, and a new zone at x = `place`, so narrow that all ends tend to advance."""
        table = here.table

        while True:
            new = np.concatenate((table, [[place - half, place + half]]))
            order = np.argsort(new[:, 0])
            at = self.curve.at(new[order], here.value, ACCURACY.rough).residual
            own = int(np.argmax(order))
            driven = at.min() > -ACCURACY.resting_step and at[[own, own + len(new)]].min() >= 0.0
            if driven or half < ACCURACY.neutral:
                return new[order]
            half *= 0.1


def first_zero(
    step: Step,
    length: float,
    end: State,
    seen: Array,
    least: Callable[[State, float, float], tuple[float, float]],
    others: Callable[[State], Array],
) -> tuple[float, float, float]:
    """The first zero of a condition in a step: (arc length, position x, width in x).

    The condition is a function of the position x and of the arc length. The returned position lies
    in the interval in which the condition was last found negative; the returned width is the width
    of this interval. end: the state at the arc length `length`. seen: intervals (n, 2) in which the
    condition is negative at this state. least: returns (position, value) of the condition's minimum
    at a state in an interval. others: returns the intervals in which the condition is negative at a
    state.
    """
    place, width = 0.0, 0.0
    while len(seen):
        lo, hi = (float(end) for end in seen[0])
        place, width = 0.5 * (lo + hi), hi - lo
        first, last = least(step.start.at, lo, hi)[1], least(end, lo, hi)[1]
        if not first > 0.0 > last:
            break

        def condition(at: State, lo: float = lo, hi: float = hi) -> float:
            return least(at, lo, hi)[1]

        length = step.where(condition, first, last, length)
        end = step.at(length)
        place = least(end, lo, hi)[0]
        # If the condition is negative in other intervals at this length, it has a zero at a smaller
        # length. The next pass searches for this zero.
        seen = others(end)
        seen = seen[(seen[:, 0] > place) | (seen[:, 1] < place)]
    return length, place, width
