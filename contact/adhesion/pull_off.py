"""Where a contact comes apart as its control falls, zone after zone: by turning points of the curve
of equilibria, from near the last.
"""

from collections.abc import Callable
from contextlib import suppress

from contact.adhesion.arc_length import ABOUT, Step, beyond, let_go, steps
from contact.adhesion.curve import Closed, Equilibria, NoState, Point
from contact.adhesion.gradient_flow import receded
from contact.errors import NotConverged
from contact.formulation.controls import Load
from sie import Array, record

Recede = Callable[[Equilibria, Array, float], Point | None]

# Of the control, before the last turning point is looked for; and of steps of the control.
_HALVINGS = 5
_MOST_TRIES = 160
# Of the control, above the least at which there may be an equilibrium, from where one is followed
# to where it comes apart.
_ABOVE = (0.005, 0.02, 0.08, 0.3)
# Ends that one zone is followed to before that, at the most; zones that come apart one after the
# other from there on.
_MOST_DIRECT = 3
_MOST_TURNS = 200


def pull_off(
    curve: Equilibria,
    here: Point,
    recede: Recede = receded,
    torn: Callable[[Point], float] = lambda at: -1.0,
) -> Point:
    """Where the last zones come apart as the control falls from an equilibrium; those before do so
    one after the other. recede: how ends that are driven inward come to rest; torn: above zero for
    a state of the curve that is none, its intervals having been cut before.
    """
    with suppress(NotConverged):
        for _ in range(_MOST_DIRECT):
            if len(here.contact) > 1:
                break
            # One zone is followed to its end at once, as a rule the last one: that takes fewer
            # states than to learn where there is none.
            end = _end(curve, here, torn)
            rest = recede(curve, end.table, end.about.value)
            if rest is None:
                return end.exactly()
            here = rest
    here = near_the_last(curve, here, recede)
    for _ in range(_MOST_TURNS):
        end = _end(curve, here, torn)
        rest = recede(curve, end.table, end.about.value)
        if rest is None:
            return end.exactly()
        here = rest
    raise NotConverged("ever more zones come apart as the control falls")


def lowered_by_load(
    curve: Equilibria, here: Point, near: Callable[[Equilibria, Point], Point]
) -> Point:
    """The equilibrium under a held approach that a contact comes to as its load falls to a little
    above the least, where few of its zones are left; itself where that does not lead down, or of
    one zone, or under a held load. near: to that load. Under a load what is left does not depend on
    the way there, and ends go one way; under an approach each zone that comes apart drives others
    on.
    """
    if curve.held.load is not None or len(here.contact) < 2:
        return here
    loaded = curve.under(Load(here.load))
    try:
        rest = near(loaded, loaded.again(here, here.load))
        found = curve.again(rest, -rest.level)
    except (Closed, NoState, NotConverged):
        return here
    return found if found.value < here.value and found.growth < 0.0 else here


@record
class _End:
    """Where an equilibrium ceases to be: about, and exactly; table: from where ends move on."""

    about: Point
    table: Array
    exactly: Callable[[], Point]


def _end(curve: Equilibria, here: Point, torn: Callable[[Point], float]) -> _End:
    """As the control falls: by a turn of the curve, as ends let go, or where it is torn."""
    for step in steps(curve, curve.settled(here), -1.0, False):
        # Of those before the last it is enough to know where they are about.
        length = step.turning(False) if step.turns else step.length
        last = step.at(length, False) if step.turns else step.end.at
        if step.turns or step.lets_go or torn(step.start.at) < 0.0 < torn(last):
            return _end_in(curve, step, length, last, torn)
    raise NotConverged("the curve of equilibria ended")


def _end_in(
    curve: Equilibria, step: Step, length: float, last: Point, torn: Callable[[Point], float]
) -> _End:
    """That in a step; last: the equilibrium at the length."""
    if step.lets_go and not step.turns:
        return _End(last, let_go(step), lambda: last)
    first = torn(step.start.at)
    if not first < 0.0 < torn(last):
        return _End(last, beyond(curve, last, -1.0), lambda: step.at(step.turning()))
    until = step.where(torn, first, torn(last), length, ABOUT, False)
    length = min(until + 2 * ABOUT * length, length)
    about = step.at(length, False)
    return _End(about, about.table, lambda: step.at(step.where(torn, first, torn(about), length)))


def above(least: float, value: float) -> tuple[float, ...]:
    """Controls a little above the least at which something else tells that there is an equilibrium,
    and ever nearer to one where it is.
    """
    return tuple(least + part * (value - least) for part in _ABOVE)


def near_the_last(curve: Equilibria, here: Point, recede: Recede = receded) -> Point:
    """The equilibrium under a value not far above one under which there is none: near enough for
    the arc to have one turning point.
    """
    here, high = _apart(curve, here, recede)
    for _ in range(_HALVINGS):
        middle = 0.5 * (here.value + high)
        rest = recede(curve, here.table, middle)
        here, high = (rest, high) if rest is not None else (here, middle)
    return here


def _apart(curve: Equilibria, here: Point, recede: Recede) -> tuple[Point, float]:
    """(an equilibrium, a lower value of the control under which there is none) as the control
    falls.
    """
    # Under a load what is left does not depend on the way there.
    step = (
        curve.unit(here)
        if curve.held.load is None
        else max(curve.unit(here), 0.5 * abs(here.value))
    )
    for _ in range(_MOST_TRIES):
        rest = recede(curve, here.table, here.value - step)
        if rest is None:
            return here, here.value - step
        here, step = rest, 2.0 * step
    raise NotConverged("the surfaces do not come apart as the control falls")
