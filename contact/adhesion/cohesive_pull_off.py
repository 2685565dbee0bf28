"""Pull-off under a tension: at a turning point, or where the last zone has shrunk to a point."""

import numpy as np

from contact.adhesion import jkr_guide
from contact.adhesion import pull_off as common_pull_off
from contact.adhesion.cohesive_flow import (
    TOO_NARROW,
    guide_down,
    guide_of,
    guided,
    intervals_left,
    receded,
)
from contact.adhesion.cohesive_rates import own_gap_rates
from contact.adhesion.cohesive_state import CohesiveState, StateOutline
from contact.adhesion.cohesive_zone import CohesiveCurve
from contact.adhesion.curve import ACCURACY, Curve, NoState, State
from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.inner_contact import ContactLost, EndsCovered
from contact.adhesion.intervals import within
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import NotConverged
from contact.formulation.roots import maximum, minimum
from sie import Array


def pull_off(curve: CohesiveCurve, here: State) -> State:
    """The last equilibrium with contact as the control falls.

    here: an equilibrium; the data of a `StateOutline` suffice.
    """

    def recede(under: Curve, table: Array, value: float) -> State | None:
        assert isinstance(under, CohesiveCurve)
        return receded(under, table, value, guide_down(under, len(under.known[-1].zones), table))

    def lead_to_load(under: Curve, at: State) -> State:
        assert isinstance(under, CohesiveCurve)
        return common_pull_off.near_the_last(under, _near_pull_off(under, at), recede)

    try:
        if curve.control.load is not None:
            here = _near_pull_off(curve, here)
        here = common_pull_off.lowered_by_load(curve, here, lead_to_load)
        here = curve.again(here, here.value)
        return common_pull_off.pull_off(
            curve, here, recede, lambda at: _highest_within(curve, at) / curve.reach - 1.0
        )
    except EndsCovered as covered:
        raise NotConverged(TOO_NARROW) from covered
    except (ContactLost, NotConverged):
        last = curve.known[-1]
        if (
            not np.diff(last.zones, axis=1).sum()
            < MOVES.small_part * np.diff(last.table, axis=1).sum()
        ):
            raise
    # All zones have nearly vanished. The last point of contact is sought in the widest one. If
    # several are equally wide, any of them will do, since all shrink to points at once.
    widest = int(np.argmax(np.diff(last.zones, axis=1)))
    return touching(curve, last.table, float(last.zones[widest].mean()))


def _highest_within(curve: CohesiveCurve, here: State) -> float:
    """The largest gap inside the intervals of tension, away from the ends of the intervals."""
    assert isinstance(here, CohesiveState)
    (x, gap), period, highest = here.gap_samples, curve.problem.round, 0.0
    for a, b in here.table:
        inner, place = within(x, a, b, period)
        value = gap[inner]
        nearer = np.flatnonzero(value < curve.reach)
        if len(nearer) < 2:
            continue
        value = value[nearer[0] : nearer[-1] + 1]
        top = int(np.argmax(value))
        if 0 < top < len(value) - 1 and value[top] > highest:
            at = nearer[0] + top
            highest = maximum(
                lambda y: curve.gap(here, np.asarray(y)),
                place[at - 1 : at + 2],
                value=value[top - 1 : top + 2],
            )[1]
    return highest


def _near_pull_off(curve: CohesiveCurve, here: State) -> State:
    """An equilibrium near the least control value at which there is contact.
    This value is estimated by means of a law without range (JKR) or on a grid.

    The state `here` is returned if no approximate search is possible, or if it fails.
    """
    if (
        len(here.contact) > MOVES.few_zones
        and (rest := jkr_guide.near_pull_off(curve, here, receded)) is not None
    ):
        return rest
    guide = guide_down(curve, len(here.contact), here.table)
    if guide is None:
        return here
    try:
        least = guide.least_value(here.table, here.value)
    except NotConverged:
        # The search on the grid fails if some zones advance. This may happen under a fixed
        # approach, where some zones advance while others recede.
        return here
    for control in common_pull_off.controls_above(least, here.value):
        rest = receded(curve, here.table, control, guide)
        if rest is not None:
            return rest
    return here


def pull_off_from_all(curve: CohesiveCurve, zones: Array, value: float) -> State:
    """The last equilibrium, as the control falls, of a contact under tension everywhere.

    Either the gap somewhere exceeds the reach first, or the surfaces last touch at one point.
    """
    rest = _cut_near_pull_off(curve, zones, value)
    if rest is not None:
        return pull_off(curve, rest)
    problem, pulled = curve.problem, curve.everywhere
    # Without contact, the force of the tension is the only load. The approach at which contact is
    # lost includes the displacement due to this force.
    load = -pulled.pulling.total
    lost = (
        load
        if curve.control.load is not None
        else (curve.value_per_load * load - curve.stress * problem.compression)
    )
    low, high, found, opened = lost, value, curve.contact_under(pulled, value, zones), False
    for _ in range(LIMITS.max_iterations):
        middle = 0.5 * (low + high)
        if middle in (low, high) or high - low < ACCURACY.density * (value - lost):
            break
        try:
            here = curve.contact_under(pulled, middle, found[0].density.zones.table)
        except NoState:
            low = middle
            continue
        if here[1][1].max() > curve.reach:
            low, opened = middle, True
        else:
            high, found = middle, here
    fields, (x, gap) = found
    inside = fields.density.zones.table
    state = StateOutline.of(
        np.zeros((0, 2)), high, fields.density.total + load, fields.level, inside
    )
    if not opened:
        return state
    # As the control falls, the gap exceeds `curve.reach` before contact is lost. Below the control
    # value `high`, the tension acts on intervals only.
    try:
        table = intervals_left(
            curve, high, inside, (x, np.where(gap == gap.max(), 2 * curve.reach, gap))
        )
    except ContactLost:
        return state
    rest = receded(curve, table, high - ACCURACY.rough * (value - lost))
    return state if rest is None else pull_off(curve, rest)


def _cut_near_pull_off(curve: CohesiveCurve, zones: Array, value: float) -> State | None:
    """An equilibrium near the least control value with contact, which is estimated on a grid.
    In this equilibrium the tension acts on intervals, no longer on the whole period.

    None if the grid gives no answer, or if no gap exceeds the reach.
    """
    guide = guide_of(curve, len(zones), None)
    if guide is None:
        return None
    least = guide.least_value(None, value)
    for control in common_pull_off.controls_above(least, value):
        try:
            start = guided(curve, guide, None, control, -1.0)
        except ContactLost:
            continue
        rest = None if start is None else receded(curve, start.table, control)
        if rest is not None:
            return rest
    return None


def touching(curve: CohesiveCurve, table: Array, at: float) -> StateOutline:
    """The equilibrium at which the surfaces touch at one point without pressure.

    It is found from a state whose contact has almost vanished. table: the intervals of tension of
    this state; at: the position of its contact.
    """
    half = 0.02 * float(np.diff(table, axis=1).max())
    lowest = 0.0
    for _ in range(LIMITS.max_iterations):
        pulled = TractionLoaded.of(curve.problem, curve.stress, table)
        at, lowest = minimum(pulled.shape, np.linspace(at - half, at + half, 65))
        ends, tension = np.concatenate((table[:, 0], table[:, 1])), pulled.pulling
        gap = pulled.shape(ends) - lowest
        rates = own_gap_rates(pulled, ends, np.zeros(len(ends)))
        rates -= curve.stress / np.pi * tension.log(at - ends)
        free = (table != np.array(curve.problem.corners)).T.ravel() | (gap > curve.reach)
        step = np.zeros(len(ends))
        step[free] = np.linalg.solve(rates[np.ix_(free, free)], curve.reach - gap[free])
        table = curve.within(table + np.column_stack((-step[: len(table)], step[len(table) :])))
        if np.any(np.diff(table, axis=1) <= 0.0):
            raise NotConverged("the last point of contact before pull-off was not found")
        if float(np.abs(step).max()) < ACCURACY.density * float(np.diff(table, axis=1).min()):
            break
    load = -TractionLoaded.of(curve.problem, curve.stress, table).pulling.total
    value = load if curve.control.load is not None else curve.value_per_load * load + lowest
    return StateOutline.of(table, value, load, -lowest, np.array([[at, at]]))
