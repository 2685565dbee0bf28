"""What surfaces that adhere do as a control rises and falls: equilibria that are followed, and the
jumps between them.

    rising     the contact grows along its curve, until somewhere else the surfaces come together, or the curve turns (gaps snap shut, ends
               jump on)
    falling    it shrinks along its curve, until that turns (zones come apart, ends jump back)

After a jump the ends come to rest at the nearest equilibrium beyond
(contact.adhesion.gradient_flow). What begins elsewhere, and whether closed surfaces open again, is
a matter of the law (contact.adhesion.events): without a range of adhesion surfaces that
are closed over the whole period stay closed, and zones never split, as a gap within a zone begins
without width, and its ends have an intensity only once it has some, sqrt(width) times the tension
there. To open it takes a flaw of a width that goes with 1/tension^2 (A. A. Griffith, Phil. Trans.
R. Soc. Lond. A 221, 1921, 163), and surfaces have none here.
"""

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from contact.adhesion.arc_length import Step, SymmetryLost, beside, beyond, let_go, steps
from contact.adhesion.curve import Point
from contact.adhesion.events import Following, Jump, Standing
from contact.errors import NotConverged

# Of a step, from how near a value Newton's steps go there.
_ROUGHLY = 1e-6
_MOST_JUMPS = 10000


@dataclass(frozen=True)
class History:
    """Of a problem's surfaces under a control. note: told every equilibrium on the way."""

    law: Following
    note: Callable[[Point], None] = field(default=lambda at: None)

    def to(self, here: Standing, value: float) -> Iterator[Jump | Standing]:
        """What happens on the way from a standing to a value, and at the end the standing there."""
        sense = 1.0 if value >= here.value else -1.0
        for _ in range(_MOST_JUMPS):
            found = yield from self._on(here, value, sense)
            yield found
            if isinstance(found, Standing):
                return
            here = found.after
        raise NotConverged("ever more jumps on a path")

    def _on(
        self, here: Standing, value: float, sense: float
    ) -> Generator[Jump | Standing, None, Jump | Standing]:
        law = self.law
        if here.point is None:
            if here.closed:
                jump = law.opened(here, value) if sense < 0.0 else None
            else:
                jump = None if value < law.first or here.value > law.first else law.begun()
            return replace(here, value=value) if jump is None else jump
        if here.value == value:
            return Standing(value, here.point)
        beside = law.beside_curve(here.point, value)
        return (
            yield from self._along(here.point, value, sense)
            if beside is None
            else self._noted(beside)
        )

    def _noted(
        self, beside: Iterator[Jump | Standing]
    ) -> Generator[Jump | Standing, None, Jump | Standing]:
        """Of an equilibrium that is none of the curve."""
        last: Jump | Standing | None = None
        for found in beside:
            if last is not None:
                yield last
            last = found
            standing = found if isinstance(found, Standing) else found.before
            if standing.point is not None:
                self.note(standing.point)
        assert last is not None
        return last

    def _along(
        self, here: Point, value: float, sense: float
    ) -> Generator[Jump | Standing, None, Jump | Standing]:
        """Along the curve from an equilibrium to the value, or to the first jump."""
        law = self.law
        try:
            for step in steps(law.curve, here, sense, False):
                length, last = step.length, step.end.at
                if step.turns:
                    length = step.turning()
                    last = step.at(length)
                if arrives := sense * (last.value - value) >= 0.0:
                    length, last = self._arriving(step, length, last, value)
                if (jump := law.interrupted(step, length, last, sense)) is not None:
                    assert jump.before.point is not None
                    yield from law.passed(step, length, jump.before.point)
                    return jump
                yield from law.passed(step, length, last)
                if arrives:
                    return Standing(value, last)
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
        raise NotConverged("the curve of equilibria ended")

    def _arriving(
        self, step: Step, length: float, last: Point, value: float
    ) -> tuple[float, Point]:
        """(how far within a step it is to a value of the control, the equilibrium there)."""
        found = step.arriving(value)
        if found is None:
            length = step.where(
                lambda at: at.value - value,
                step.start.at.value - value,
                last.value - value,
                length,
                _ROUGHLY,
                False,
            )
            found = self.law.curve.settled(replace(step.at(length), value=value))
        else:
            length = step.start.length(found)
        return length, found

    def _ended(self, failure: NotConverged, here: Point, value: float, sense: float) -> Jump:
        """What happens where the curve breaks off, if that lies before the value."""
        end = self.law.gone(here, sense)
        if end is None and isinstance(failure, SymmetryLost):
            failure = failure.located()
            end = self._aside(failure)
        if end is None or sense * (end.before.value - value) > 0.0:
            raise failure
        return end

    def _aside(self, lost: SymmetryLost) -> Jump:
        """From where a symmetry is lost on, one of the two ways: the other one is its mirror image."""
        try:
            after = self.law.shrunk(beside(lost.at), lost.at.value)
        except NotConverged:
            raise lost from None
        return self.law.jump(lost.at, float(lost.at.contact.mean()), after, False)

    def _at_corner(self, step: Step, after: Point) -> Jump:
        """An end that has reached a sharp corner, or leaves it, without a jump."""
        before = step.end.at
        reached = bool((after.held & ~before.held).any())
        standing = Standing(before.value, after)
        return Jump(
            "held" if reached else "freed",
            _place(before, after),
            Standing(before.value, before),
            standing,
            smooth=True,
        )

    def _let_go(self, step: Step) -> Jump:
        """From where ends let go of sharp corners on."""
        last = step.end.at
        assert step.after is not None
        return self.law.jump(
            last, _place(last, step.after), self.law.shrunk(let_go(step), last.value), False
        )

    def _turn(self, last: Point, sense: float) -> Jump:
        """From a turning point on."""
        law, rises = self.law, sense > 0.0
        table = beyond(law.curve, last, sense)
        place = float(last.table.ravel()[int(np.argmax(np.abs(table - last.table)))])
        return law.jump(last, place, (law.grown if rises else law.shrunk)(table, last.value), rises)


def _place(before: Point, after: Point) -> float:
    """Of the first end that is held at one of two points alone."""
    return float(before.table.T.ravel()[int(np.argmax(before.held != after.held))])
