"""Where contact under a tension comes apart as its control falls: at a turning point, or where the
last zone has shrunk to a point.
"""

import numpy as np

from contact.adhesion import jkr_guide
from contact.adhesion import pull_off as apart
from contact.adhesion.cohesive_flow import (
    FEW,
    TOO_NARROW,
    guide_down,
    guide_of,
    guided,
    left_of_all,
    receded,
)
from contact.adhesion.cohesive_zone import Cohesive, CohesivePoint, Loose
from contact.adhesion.curve import Equilibria, NoState, Point
from contact.adhesion.deformed_profile import Pulled
from contact.adhesion.inner_contact import Covered, Lost
from contact.adhesion.intervals import within
from contact.errors import NotConverged
from contact.formulation.roots import maximum, minimum
from sie import Array

# Newton's steps of a state without contact.
_STEPS = 80
# Of the control, until the gap somewhere comes to the reach.
_HALVINGS = 60
# Zones over their intervals: of contact that is all but lost.
SHRUNK = 0.1


def pull_off(curve: Cohesive, here: Point) -> Point:
    """Where the last zones come apart as the control falls: at a turning point, or where the last
    of them has shrunk to a point. here: an equilibrium, of which what `Loose` tells is enough.
    """

    def recede(under: Equilibria, table: Array, value: float) -> Point | None:
        assert isinstance(under, Cohesive)
        return receded(under, table, value, guide_down(under, len(under.known[-1].zones), table))

    def near(under: Equilibria, at: Point) -> Point:
        assert isinstance(under, Cohesive)
        return apart.near_the_last(under, _about_to_part(under, at), recede)

    try:
        if curve.held.load is not None:
            here = _about_to_part(curve, here)
        here = apart.lowered_by_load(curve, here, near)
        here = curve.again(here, here.value)
        return apart.pull_off(
            curve, here, recede, lambda at: _highest_within(curve, at) / curve.reach - 1.0
        )
    except Covered as covered:
        raise NotConverged(TOO_NARROW) from covered
    except (Lost, NotConverged):
        last = curve.known[-1]
        if not np.diff(last.zones, axis=1).sum() < SHRUNK * np.diff(last.table, axis=1).sum():
            raise
    # Of several, one: where these are alike all of them touch.
    widest = int(np.argmax(np.diff(last.zones, axis=1)))
    return touching(curve, last.table, float(last.zones[widest].mean()))


def _highest_within(curve: Cohesive, here: Point) -> float:
    """The largest gap within the intervals, but for what begins at their ends."""
    assert isinstance(here, CohesivePoint)
    (x, gap), period, highest = here.look, curve.problem.round, 0.0
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


def _about_to_part(curve: Cohesive, here: Point) -> Point:
    """The equilibrium that this one has come to under a control a little above the least at which a
    grid holds any; itself without one.
    """
    if (
        len(here.contact) > FEW
        and (rest := jkr_guide.about_to_part(curve, here, receded)) is not None
    ):
        return rest
    guide = guide_down(curve, len(here.contact), here.table)
    if guide is None:
        return here
    try:
        least = guide.least_value(here.table, here.value)
    except NotConverged:
        # Under a held approach others are driven on by what recedes: it does not tell.
        return here
    for control in apart.above(least, here.value):
        rest = receded(curve, here.table, control, guide)
        if rest is not None:
            return rest
    return here


def pull_off_from_all(curve: Cohesive, zones: Array, value: float) -> Point:
    """The same of a contact under tension everywhere: from where the gap somewhere comes to its
    reach, or to the last touch.
    """
    rest = _open_and_about_to_part(curve, zones, value)
    if rest is not None:
        return pull_off(curve, rest)
    problem, pulled = curve.problem, curve.everywhere
    # Without contact the load is the tension's, and the base gives way to it.
    load = -pulled.pulling.total
    lost = (
        load
        if curve.held.load is not None
        else (curve.yields * load - curve.stress * problem.compression)
    )
    low, high, found, opened = lost, value, curve.contact_under(pulled, value, zones), False
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high) or high - low < 1e-14 * (value - lost):
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
    state = Loose.of(np.zeros((0, 2)), high, fields.density.total + load, fields.level, inside)
    if not opened:
        return state
    # At the place that comes to the reach first the tension lets go.
    try:
        table = left_of_all(
            curve, high, inside, (x, np.where(gap == gap.max(), 2 * curve.reach, gap))
        )
    except Lost:
        return state
    rest = receded(curve, table, high - 1e-9 * (value - lost))
    return state if rest is None else pull_off(curve, rest)


def _open_and_about_to_part(curve: Cohesive, zones: Array, value: float) -> Point | None:
    """The equilibrium that a contact under tension everywhere has come to under a control a little
    above the least at which a grid holds any; None where that does not tell, or where the tension
    has not let go before.
    """
    guide = guide_of(curve, len(zones), None)
    if guide is None:
        return None
    least = guide.least_value(None, value)
    for control in apart.above(least, value):
        try:
            start = guided(curve, guide, None, control, -1.0)
        except Lost:
            continue
        rest = None if start is None else receded(curve, start.table, control)
        if rest is not None:
            return rest
    return None


def touching(curve: Cohesive, table: Array, at: float) -> Loose:
    """The equilibrium in which the surfaces touch in one point, without pressure, beside one of
    hardly any contact there.
    """
    half = 0.02 * float(np.diff(table, axis=1).max())
    lowest = 0.0
    for _ in range(_STEPS):
        pulled = Pulled.of(curve.problem, curve.stress, table)
        at, lowest = minimum(pulled.shape, np.linspace(at - half, at + half, 65))
        ends, tension = np.concatenate((table[:, 0], table[:, 1])), pulled.pulling
        gap = pulled.shape(ends) - lowest
        rates = curve.explicit(
            pulled, ends, np.zeros(len(ends))
        ) - curve.stress / np.pi * tension.log(at - ends)
        free = (table != np.array(curve.problem.corners)).T.ravel() | (gap > curve.reach)
        step = np.zeros(len(ends))
        step[free] = np.linalg.solve(rates[np.ix_(free, free)], curve.reach - gap[free])
        table = curve.within(table + np.column_stack((-step[: len(table)], step[len(table) :])))
        if np.any(np.diff(table, axis=1) <= 0.0):
            raise NotConverged("the place where the surfaces touch last was not found")
        if float(np.abs(step).max()) < 1e-14 * float(np.diff(table, axis=1).min()):
            break
    load = -Pulled.of(curve.problem, curve.stress, table).pulling.total
    value = load if curve.held.load is not None else curve.yields * load + lowest
    return Loose.of(table, value, load, -lowest, np.array([[at, at]]))
