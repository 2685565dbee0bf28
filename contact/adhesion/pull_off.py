"""Pull-off: the last contact as the control falls, after all earlier events.

Each zone is lost at a turning point of the curve of equilibria. The curve is followed to the last
turning point from an equilibrium near this point.
"""

from collections.abc import Callable
from contextlib import suppress

from contact.adhesion.arc_length import past_turning_point, steps
from contact.adhesion.arc_step import Step, let_go
from contact.adhesion.curve import ACCURACY, Closed, Curve, NoState, State
from contact.adhesion.gradient_flow import receded
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import NotConverged
from contact.formulation.controls import Load
from sie import Array, record

Recede = Callable[[Curve, Array, float], State | None]


def pull_off(
    curve: Curve,
    here: State,
    recede: Recede = receded,
    past_cut: Callable[[State], float] = lambda at: -1.0,
) -> State:
    """The last equilibrium with contact as the control falls.

    recede: moves ends inward to an equilibrium. past_cut: a function of a state that is positive if
    one of its intervals must be cut in two.
    """
    with suppress(NotConverged):
        for _ in range(LIMITS.patience):
            if len(here.contact) > 1:
                break
            # With one zone, the curve is followed to its end, which is usually the pull-off. The
            # bisection in `near_the_last` would need more states.
            end = _end(curve, here, past_cut)
            rest = recede(curve, end.table, end.about.value)
            if rest is None:
                return end.exactly()
            here = rest
    here = near_the_last(curve, here, recede)
    for _ in range(LIMITS.max_iterations):
        end = _end(curve, here, past_cut)
        rest = recede(curve, end.table, end.about.value)
        if rest is None:
            return end.exactly()
        here = rest
    raise NotConverged(
        f"pull-off was not found: zones were left after {LIMITS.max_iterations} events"
    )


def lowered_by_load(
    curve: Curve, here: State, lead_to_load: Callable[[Curve, State], State]
) -> State:
    """An equilibrium under a fixed approach with fewer zones, found by first lowering the load.

    While the load is lowered, all ends recede, and the remaining zones do not depend on the path.
    Under a fixed approach, the other zones advance when a zone is lost. The state `here` itself is
    returned if it has one zone, if the load is the control, or if the approach found is not lower.
    lead_to_load: a function of a curve and a state, which returns an equilibrium near the least
    load.
    """
    if curve.control.load is not None or len(here.contact) < 2:
        return here
    loaded = curve.under(Load(here.load))
    try:
        rest = lead_to_load(loaded, loaded.again(here, here.load))
        found = curve.again(rest, -rest.level)
    except (Closed, NoState, NotConverged):
        return here
    return found if found.value < here.value and found.growth < 0.0 else here


@record
class _End:
    """The end of a curve of equilibria.

    about: a state near the end; table: intervals past the end. exactly: a function that returns the
    state at the end itself.
    """

    about: State
    table: Array
    exactly: Callable[[], State]


def _end(curve: Curve, here: State, past_cut: Callable[[State], float]) -> _End:
    """The end of the curve in the direction in which the control falls.

    The curve ends at a turning point, or where an end of an interval leaves a sharp corner or an
    interval is cut.
    """
    for step in steps(curve, curve.settled(here), -1.0, False):
        # A turning point is first located roughly. It need not be the end of the curve, as an
        # interval may be cut before the turning point.
        length = step.turning(False) if step.turns else step.length
        last = step.at(length, False) if step.turns else step.end.at
        if step.turns or step.lets_go or past_cut(step.start.at) < 0.0 < past_cut(last):
            return _end_in(curve, step, length, last, past_cut)
    raise NotConverged("pull-off was not found: the curve of equilibria was lost")


def _end_in(
    curve: Curve, step: Step, length: float, last: State, past_cut: Callable[[State], float]
) -> _End:
    """The end of the curve of equilibria, which lies inside the given step.

    last: the equilibrium at the distance `length` from the step's start.
    """
    if step.lets_go and not step.turns:
        return _End(last, let_go(step), lambda: last)
    first = past_cut(step.start.at)
    if not first < 0.0 < past_cut(last):
        return _End(last, past_turning_point(curve, last, -1.0), lambda: step.at(step.turning()))
    until = step.where(past_cut, first, past_cut(last), length, ACCURACY.coarse, False)
    length = min(until + 2 * ACCURACY.coarse * length, length)
    about = step.at(length, False)
    return _End(
        about, about.table, lambda: step.at(step.where(past_cut, first, past_cut(about), length))
    )


def controls_above(least: float, value: float) -> tuple[float, ...]:
    """Values of the control a little above the least value, in ascending order."""
    return tuple(least + part * (value - least) for part in MOVES.margins)


def near_the_last(curve: Curve, here: State, recede: Recede = receded) -> State:
    """An equilibrium whose control value is just above the lowest value of all equilibria."""
    here, high = _bracket(curve, here, recede)
    for _ in range(LIMITS.patience):
        middle = 0.5 * (here.value + high)
        rest = recede(curve, here.table, middle)
        here, high = (rest, high) if rest is not None else (here, middle)
    return here


def _bracket(curve: Curve, here: State, recede: Recede) -> tuple[State, float]:
    """(an equilibrium, a lower value of the control at which there is no equilibrium)."""
    # Under a fixed load, the remaining zones do not depend on the path. So large steps are allowed.
    step = (
        curve.unit(here)
        if curve.control.load is None
        else max(curve.unit(here), 0.5 * abs(here.value))
    )
    for _ in range(LIMITS.max_iterations):
        rest = recede(curve, here.table, here.value - step)
        if rest is None:
            return here, here.value - step
        here, step = rest, 2.0 * step
    raise NotConverged(
        "pull-off was not found: the surfaces remain in contact at every value of the control that "
        "was tried"
    )
