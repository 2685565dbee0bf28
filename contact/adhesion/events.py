"""What happens on the way along a curve of equilibria, by its law: what surfaces do that come
together, and where something begins.

Here of adhesion without range. A zone begins where surfaces touch, and takes a width at once: every
change of the zones is a jump.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from contact.adhesion.arc_length import Step
from contact.adhesion.curve import Closed, Equilibria, Point
from contact.adhesion.energy_descent import relaxed
from contact.adhesion.gradient_flow import ROUGH, receded
from contact.adhesion.nucleation import grown, touched
from contact.errors import NotConverged
from contact.formulation.roots import minimum
from contact.verify.certificate import openings
from sie import Array, record

# Of the width that a new zone comes to, how much it begins with.
_OF_REST = 0.5
# A new zone over the overlap that was seen beyond its first touch; how narrow at the least; and
# what drives its ends that is nothing.
NEW = 1e-2
LEAST = 1e-12
SLIGHT = 1e-6


@record
class Standing:
    """What there is under a value of the control: an equilibrium, or surfaces closed over the whole
    period, or apart.
    """

    value: float
    point: Point | None = None
    closed: bool = False

    @property
    def apart(self) -> bool:
        return self.point is None and not self.closed

    @property
    def count(self) -> int:
        """Of zones."""
        return 0 if self.point is None else len(self.point.contact)


@record
class Jump:
    """What happens to the zones: kind (contact.sweeps.adhesive); place: scaled, where it begins;
    smooth: nothing jumps, nothing is lost.
    """

    kind: str
    place: float
    before: Standing
    after: Standing
    smooth: bool = False


def followed_by_approach(curve: Equilibria) -> bool:
    """Whether ends may hold back, or drive on, one another from one end of a body to the other, as
    its approach is held: a change of the control is followed then through all jumps.
    """
    return curve.held.load is None and (
        curve.problem.period is not None or curve.problem.profile.support is not None
    )


@dataclass(frozen=True)
class Following:
    """cell: [m], where the surfaces touch first."""

    curve: Equilibria
    cell: tuple[float, float]

    @property
    def first(self) -> float:
        """Value of the control at which surfaces that are apart come together."""
        return 0.0

    @property
    def by_load(self) -> bool:
        """Whether the load is held."""
        return self.curve.held.load is not None

    def begun(self) -> Jump:
        """What they come to there."""
        table = touched(self.curve, self.cell, self.first)
        after = self.grown(table, self.first)
        return Jump(
            "full" if after.closed else "jump-in",
            float(table[0].mean()),
            Standing(self.first),
            after,
        )

    def opened(self, here: Standing, value: float) -> Jump | None:
        """Where surfaces that are closed over the whole period open as the control falls to a
        value; None if they stay closed.
        """
        return None

    def beside_curve(self, here: Point, value: float) -> Iterator[Jump | Standing] | None:
        """Of an equilibrium that is none of the curve that is followed by the motions of ends: what
        happens on its way to a value, up to a jump, or the standing there. None of others.
        """
        return None

    def grown(self, table: Array, value: float) -> Standing:
        """What ends that advance from these places come to."""
        try:
            try:
                return self._at_rest(grown(self.curve, table, value))
            except NotConverged:
                # Under a held approach ends that advance may hold back one another.
                rest = None if self.by_load else relaxed(self.curve, table, value)
                if rest is None:
                    raise
                return self._at_rest(rest)
        except Closed:
            return Standing(value, closed=True)

    def shrunk(self, table: Array, value: float) -> Standing:
        """What ends that recede from these places come to. Under a held approach a tension that is
        lost raises the surface of a period elsewhere, where it may come to overlap.
        """
        try:
            rest = (receded if self.by_load else relaxed)(self.curve, table, value)
        except Closed:
            return Standing(value, closed=True)
        if rest is None:
            return (
                Standing(value)
                if self.by_load or value <= self.first
                else self.grown(touched(self.curve, self.cell, value), value)
            )
        return self._at_rest(rest)

    def _at_rest(self, here: Point) -> Standing:
        rest = self.curve.settled(here)
        if not float(np.abs(rest.residual).max()) < SLIGHT:
            raise NotConverged(
                "after a jump ends of zones hold back one another, and do not come to rest: it is not followed on"
            )
        return Standing(rest.value, rest)

    def kind(self, before: Standing, after: Standing, rises: bool) -> str:
        """Of a jump past a turning point."""
        if after.apart:
            return "pull-off"
        if after.closed:
            return "full"
        return ("merge" if rises else "death") if after.count < before.count else "jump"

    def jump(self, here: Point, place: float, after: Standing, rises: bool) -> Jump:
        """From an equilibrium past a turning point."""
        before = Standing(here.value, here)
        return Jump(self.kind(before, after, rises), place, before, after)

    def gone(self, here: Point, sense: float) -> Jump | None:
        """The end of a curve that is none of its turning points, beside an equilibrium; None if
        there is none.
        """
        return None

    def passed(self, step: Step, length: float, last: Point) -> Iterator[Jump]:
        """What happens without a jump within a step."""
        return iter(())

    def interrupted(self, step: Step, length: float, last: Point, sense: float) -> Jump | None:
        """The first jump within a step that is no turn: of all touches, where surfaces came to
        overlap.
        """
        looks = sense > 0.0 or not self.by_load
        overlaps = openings(self.curve.fields(last, ROUGH)).overlaps if looks else np.zeros((0, 2))
        if len(overlaps) == 0:
            return None
        curve = self.curve

        def least(at: Point, lo: float, hi: float) -> tuple[float, float]:
            return minimum(curve.fields(at, ROUGH).formal_gap, np.linspace(lo, hi, 17))

        length, place, width = first_of(
            step,
            length,
            last,
            overlaps,
            least,
            lambda at: openings(curve.fields(at, ROUGH)).overlaps,
        )
        here = step.at(length)
        after = self.grown(self._with_new(here, place, 0.5 * NEW * width), here.value)
        return Jump("full" if after.closed else "birth", place, Standing(here.value, here), after)

    def _with_new(self, here: Point, place: float, half: float) -> Array:
        """The zones with one that begins at a place, all of whose ends are driven outward: a narrow
        one, or one about as wide as it is to be where they are driven so there, too.
        """
        table = here.table

        def driven(half: float) -> tuple[Array, float]:
            new = np.concatenate((table, [[place - half, place + half]]))
            order = np.argsort(new[:, 0])
            at = self.curve.at(new[order], here.value, ROUGH).residual
            own = int(np.argmax(order))
            return new[order], float(
                at[[own, own + len(new)]].min()
            ) if at.min() > -SLIGHT else -1.0

        new, most = driven(half)
        while most < 0.0 and half >= LEAST:
            half *= 0.1
            new, most = driven(half)
        if 0.0 < most < 1.0:
            # Of surfaces that only touch what drives the ends falls by the power 3/2 of the width.
            wider, left = driven(_OF_REST * (1.0 - most) ** (-2.0 / 3.0) * half)
            new = wider if left > 0.0 else new
        return new


def first_of(
    step: Step,
    length: float,
    end: Point,
    seen: Array,
    least: Callable[[Point, float, float], tuple[float, float]],
    others: Callable[[Point], Array],
) -> tuple[float, float, float]:
    """(how far within a step it is to where something is zero first, its place, the width in which
    it was seen). end: the state at the length; seen: intervals (n, 2) in which it is negative
    there; least: its (place, value) in an interval; others: intervals in which it is negative.
    """
    place, width = 0.0, 0.0
    while len(seen):
        lo, hi = (float(end) for end in seen[0])
        place, width = 0.5 * (lo + hi), hi - lo
        first, last = least(step.start.at, lo, hi)[1], least(end, lo, hi)[1]
        if not first > 0.0 > last:
            break
        length = step.where(lambda at, lo=lo, hi=hi: least(at, lo, hi)[1], first, last, length)  # type: ignore[misc]
        end = step.at(length)
        place = least(end, lo, hi)[0]
        # Elsewhere it may have been before.
        seen = others(end)
        seen = seen[(seen[:, 0] > place) | (seen[:, 1] < place)]
    return length, place, width
