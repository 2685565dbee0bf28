"""What surfaces that adhere do as a control rises and falls: equilibria that are followed, and the jumps between them.

    rising     the contact grows along its curve, until somewhere else the surfaces touch, or the curve turns (gaps snap shut, ends jump on)
    falling    it shrinks along its curve, until that turns (zones come apart, ends jump back)

After a jump the ends come to rest at the nearest equilibrium beyond (contact.search.equilibria.flow). Surfaces apart touch at no load and
no approach. Surfaces that are closed over the whole period stay closed, and zones never split: a gap within a zone begins without width,
and its ends have an intensity only once it has some, sqrt(width) times the tension there. To open it takes a flaw of a width that goes
with 1/tension^2 (A. A. Griffith, Phil. Trans. R. Soc. Lond. A 221, 1921, 163), and surfaces have none here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from contact.errors import NotConverged
from contact.formulation.equilibria import Equilibria, Point
from contact.formulation.maxima import maximum
from contact.search.equilibria.arc import Step, beyond, steps
from contact.search.equilibria.flow import Closed, receded
from contact.search.equilibria.growth import grown, touched
from contact.verify.certificate import openings

Array = NDArray[np.float64]

# A new zone over the overlap that was seen beyond its first touch; how narrow at the least; and what drives its ends that is nothing.
_NEW, _LEAST, _SLIGHT = 1e-2, 1e-12, 1e-6
# Of a step, from how near a value Newton's steps go there.
_ROUGHLY = 1e-6
_MOST_JUMPS = 10000


@dataclass(frozen=True, eq=False)
class Standing:
    """What there is under a value of the control: an equilibrium, or surfaces closed over the whole period, or apart."""

    value: float
    point: Point | None = None
    closed: bool = False

    @property
    def apart(self) -> bool:
        return self.point is None and not self.closed

    @property
    def count(self) -> int:
        """Of zones."""
        return 0 if self.point is None else len(self.point.table)


@dataclass(frozen=True, eq=False)
class Jump:
    """kind: jump-in (of surfaces apart), birth (of a zone, by touch), merge (a gap closes), full (the last one does), jump (ends alone),
    death (of zones), pull-off (of the last ones). place: scaled, where it begins."""

    kind: str
    place: float
    before: Standing
    after: Standing


@dataclass(frozen=True)
class History:
    """Of a problem's surfaces under a control. cell: [m], where they touch first; note: told every equilibrium on the way."""

    curve: Equilibria
    cell: tuple[float, float]
    note: Callable[[Point], None] = field(default=lambda at: None)

    def to(self, here: Standing, value: float) -> Iterator[Jump | Standing]:
        """The jumps on the way from a standing to a value, and at the end the standing there."""
        sense = 1.0 if value >= here.value else -1.0
        for _ in range(_MOST_JUMPS):
            if here.point is None:
                jump = self._first(here, value)
            else:
                found = self._along(here.point, value, sense)
                if isinstance(found, Standing):
                    yield found
                    return
                jump = found
            if jump is None:
                yield replace(here, value=value)
                return
            yield jump
            here = jump.after
        raise NotConverged("ever more jumps on a path")

    def _first(self, here: Standing, value: float) -> Jump | None:
        """Surfaces apart that come together."""
        if here.closed or value < 0.0 or here.value > 0.0:
            return None
        table = touched(self.curve, self.cell)
        after = self._after(table, 0.0)
        return Jump("full" if after.closed else "jump-in", float(table[0].mean()), Standing(0.0), after)

    def _along(self, here: Point, value: float, sense: float) -> Jump | Standing:
        """Along the curve from an equilibrium to the value, or to the first jump."""
        if here.value == value:
            return Standing(value, here)
        for step in steps(self.curve, here, sense):
            length, last = step.length, step.end.at
            if step.turns:
                length = step.turning()
                last = step.at(length)
            if arrives := sense * (last.value - value) >= 0.0:
                length = step.where(lambda at: at.value - value, step.start.at.value - value, last.value - value, length, _ROUGHLY)
                last = self.curve.settled(replace(step.at(length), value=value))
            overlaps = openings(self.curve.fields(last)).overlaps if sense > 0.0 else np.zeros((0, 2))
            if len(overlaps):
                return self._touch(step, length, overlaps)
            if arrives:
                return Standing(value, last)
            if step.turns:
                return self._turn(last, sense)
            self.note(last)
        raise NotConverged("the curve of equilibria ended")

    def _touch(self, step: Step, length: float, overlaps: Array) -> Jump:
        """The first touch of all within a step, in which surfaces came to overlap."""
        curve = self.curve
        place, width = 0.0, 0.0
        while len(overlaps):
            lo, hi = (float(end) for end in overlaps[0])
            place, width = 0.5 * (lo + hi), hi - lo

            def least(at: Point, lo: float = lo, hi: float = hi) -> tuple[float, float]:
                fields = curve.fields(at)
                x, depth = maximum(lambda x: -fields.formal_gap(x), np.linspace(lo, hi, 17))
                return x, -depth

            first, last = least(step.start.at)[1], least(step.at(length))[1]
            if not first > 0.0 > last:
                break
            length = step.where(lambda at, least=least: least(at)[1], first, last, length)  # type: ignore[misc]
            here = step.at(length)
            place = least(here)[0]
            # Elsewhere they may have touched before.
            overlaps = openings(curve.fields(here)).overlaps
            overlaps = overlaps[(overlaps[:, 0] > place) | (overlaps[:, 1] < place)]
        here = step.at(length)
        before, half = Standing(here.value, here), 0.5 * _NEW * width
        while True:
            new = np.concatenate((here.table, [[place - half, place + half]]))
            new = new[np.argsort(new[:, 0])]
            if half < _LEAST or np.all(curve.at(new, here.value).residual > -_SLIGHT):
                break
            half *= 0.1
        after = self._after(new, here.value)
        return Jump("full" if after.closed else "birth", place, before, after)

    def _turn(self, last: Point, sense: float) -> Jump:
        """From a turning point on."""
        table, before = beyond(self.curve, last, sense), Standing(last.value, last)
        moves = np.abs(np.column_stack(np.split(np.concatenate((last.table[:, 0] - table[:, 0], table[:, 1] - last.table[:, 1])), 2)))
        place = float(last.table.ravel()[int(np.argmax(moves))])
        if sense > 0.0:
            after = self._after(table, last.value)
            kind = "full" if after.closed else "merge" if after.count < before.count else "jump"
            return Jump(kind, place, before, after)
        rest = receded(self.curve, table, last.value)
        if rest is None:
            return Jump("pull-off", place, before, Standing(last.value))
        after = Standing(last.value, self.curve.settled(rest))
        return Jump("death" if after.count < before.count else "jump", place, before, after)

    def _after(self, table: Array, value: float) -> Standing:
        """What ends that advance from these zones come to."""
        try:
            return Standing(value, self.curve.settled(grown(self.curve, table, value)))
        except Closed:
            return Standing(value, closed=True)
