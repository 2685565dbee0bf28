r"""Intervals of tension that are driven outward advance, and those driven inward recede (contact.formulation.tension.cohesive).

The steps are those of contact.search.equilibria.flow. What is different is which intervals there are: new ones begin where the gap comes
below the reach, and they become one where it is below it all between; they are cut where it comes above. Contact is lost where the load
of q does not press any more.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from contact.errors import NotConverged
from contact.formulation.equilibria import Closed, Equilibria, NoState, Point
from contact.formulation.roots import maximum
from contact.formulation.tables import gaps_between, runs_of
from contact.formulation.tension.cohesive import Cohesive, CohesivePoint, Loose
from contact.formulation.tension.contact import Covered, Lost
from contact.formulation.tension.intervals import below, interval_of, joined, within
from contact.formulation.tension.pulled import Pulled
from contact.search.equilibria import arc, flow
from contact.search.equilibria.growth import grown
from contact.search.equilibria.relaxation import relaxed
from contact.search.grid.tension import GridTension
from sie import Array, wrapped

# Of the part of a gap below the reach, as wide a new interval begins.
_NEW = 0.5
# How often a step is shortened that would lose contact.
_TRIES = 6
# How often, and by how much, intervals are widened that contact covers.
_WIDENINGS, _WIDEN = 120, 1.25
# Over an interval, what a strip beside its contact is taken to be at the least.
_LEAST = 1e-6
# After so many times the same again.
_HASTE = 3
# So often ends are let go one way only; of the widths, how far else.
_ONE_WAY, _SLOWLY = 4, 0.5
# Newton's steps of a state without contact.
_STEPS = 80
# Of the control, until the gap somewhere comes to the reach.
_HALVINGS = 60
# Over the width of an interval, how far an end goes that contact covers as others advance.
_FARTHER = 0.01
# Intervals over a strip beside contact, that do not stay open.
_WIDE = 10.0
# Newton's step of ends that are about to rest, over their intervals and the gaps beside them.
_ABOUT_TO_REST = 1e-3
# Zones that recede without a grid.
_FEW = 6
# Parts of the reach that it is made smaller or larger by on a grid.
_MARGINS = (0.02, 0.06, 0.2)
# Of a control, above the least at which a grid holds a contact, from where that is followed to where it comes apart.
_ABOVE = (0.005, 0.02, 0.08, 0.3)
# Parts of the work of adhesion that it is made smaller or larger by where it is to have no range; Newton's steps for the width of a strip,
# and to where ends are driven by as much; by what they are driven that are not far from rest.
_MORE, _STEPS_OF_STRIP, _STEPS_TO_MARGIN, _NOT_FAR = (0.02, 0.2), 30, 5, 0.25
# Zones over their intervals: of contact that is all but lost.
SHRUNK = 0.1

TOO_NARROW = (
    "the tension would act on strips narrower than a millionth of the zones beside them: under so large a stress adhesion is without range"
)


def advanced(
    curve: Cohesive, table: Array, value: float, guide: GridTension | None = None, zones: Array | None = None
) -> CohesivePoint:
    """The least equilibrium that holds these intervals, of which all ends are driven outward; `Closed` if there is none. zones: that they
    begin with, where contact may cover some intervals."""
    start = None if zones is None else _near_without_range(curve, zones, value)
    if start is None and guide is not None:
        start = _guided(curve, guide, table, value, 1.0)
    if start is not None:
        table = start.table
    elif zones is not None:
        table = uncovered(curve, table, value, zones)
    try:
        found = _flowed(curve, table, value, 1.0)
    except Covered as covered:
        raise NotConverged(TOO_NARROW) from covered
    assert found is not None
    return found


def receded(curve: Cohesive, table: Array, value: float, guide: GridTension | None = None) -> CohesivePoint | None:
    """The greatest equilibrium within these intervals, of which all ends are driven inward; None where contact is lost."""
    try:
        start = None if guide is None else _guided(curve, guide, table, value, -1.0)
        return _flowed(curve, _held(curve, table, value) if start is None else start.table, value, -1.0)
    except Lost:
        return None


def guide_of(curve: Cohesive, zones: int, table: Array | None) -> GridTension | None:
    """A grid by which ends are guided that move from these intervals (None: from tension in all of a period); none without contact, or
    where a spring holds it."""
    held = curve.held
    if zones == 0 or curve.problem.profile.support is not None or (held.load is None and held.approach is None):
        return None
    return GridTension.of(curve.problem, table, held.load is not None)


def guide_down(curve: Cohesive, zones: int, table: Array) -> GridTension | None:
    """The same where zones recede from an equilibrium: of few of them the way itself is shorter."""
    return guide_of(curve, zones, table) if zones > _FEW else None


def _guided(curve: Cohesive, guide: GridTension, table: Array | None, value: float, sign: float) -> CohesivePoint | None:
    """A state from which ends are all driven onward to the same equilibrium as from these intervals (None: tension in all of a period), and
    not far, by a grid; None where that does not tell. What the grid is wrong by is seen in what drives the ends: of what it makes rest that
    is the margin."""
    for margin in _MARGINS:
        try:
            found = guide.resting(table, value, sign, 1.0 - sign * margin)
            here = curve.from_zones(found.table, value, curve.fitted(found.zones, found.table), flow.ROUGH)
        except Closed:
            if sign > 0 and margin == _MARGINS[-1]:
                raise
            continue
        except Lost:
            # Where nothing is left of what holds the equilibrium, that is nothing, too.
            if sign < 0 and margin == _MARGINS[-1]:
                raise
            continue
        except (NoState, NotConverged):
            continue
        driven = sign * here.residual
        if driven.min() > 0.0 and driven.max() < 2 * margin and (_parted if sign > 0 else _grown)(curve, here) is None:
            return here
    return None


def _near_without_range(curve: Cohesive, zones: Array, value: float) -> CohesivePoint | None:
    """A state not far within the least equilibrium that holds these zones, of which all ends are driven outward, where tension acts on
    strips narrower than zones: from those that a little less adhesion without range makes of them; None where that does not tell."""
    for margin in _MORE:
        short = _without_range(curve, zones, 1.0 - margin)
        if short is None:
            return None
        with suppress(Closed, NoState, Lost, NotConverged):
            found = _with_range(curve, short, grown(short, zones, value), margin)
            if found is not None:
                return found
    return None


def _without_range(curve: Cohesive, zones: Array, share: float) -> Equilibria | None:
    """The equilibria under so much of the adhesion without range; None where strips are no narrower than zones, or there is no such law."""
    if curve.problem.profile.support is not None or curve.strip > float(np.median(np.diff(zones, axis=1))):
        return None
    law = curve.problem.law.without_range(share)
    return None if law is None else Equilibria(replace(curve.problem, law=law), curve.held)


def _with_range(curve: Cohesive, short: Equilibria, tips: Point, margin: float) -> CohesivePoint | None:
    """The state with range about an equilibrium under so much less adhesion without, of which all ends are driven outward by about the
    margin (inward, where it is negative); None where they are not.

    Beside a tip, p = A sqrt(v) - K/sqrt(v) at a depth v, contact ends farther in, where K is what a strip of width d takes,
    2 s sqrt(d)/pi, and at the strip's end the gap is the reach h, 4 s d/pi + 4 A d^(3/2)/3 = E* h.
    """
    wide = (1.0 - margin) * curve.strip
    by_slope = np.pi / (3 * curve.stress) * np.maximum(np.concatenate(short.fields(tips, flow.ROUGH).density.edge_slopes), 0.0)
    d = np.full(len(by_slope), wide)
    for _ in range(_STEPS_OF_STRIP):
        d -= (d * (1 + by_slope * np.sqrt(d)) - wide) / (1 + 1.5 * by_slope * np.sqrt(d))
    # K over that of the tip is one less what drives an end.
    inward: Array = np.asarray(np.linalg.solve(-tips.rates, 1 - np.sqrt(d / wide) - tips.residual), dtype=np.float64)
    zones, table = tips.moved(-inward), tips.moved(d - inward)
    joins = curve.gaps(table) <= 0.0
    if joins.all() or np.any(zones[:, 1] <= zones[:, 0]):
        return None
    here = curve.from_zones(joined(table, joins, [], curve.problem.round), tips.value, zones, flow.ROUGH)
    for _ in range(_STEPS_TO_MARGIN):
        driven = here.residual * math.copysign(1.0, margin)
        if driven.min() > 0.0 and driven.max() < _NOT_FAR:
            return here
        if here.growth >= 0.0:
            break
        inward, outward = flow.inward_and_outward(curve, here)
        step = np.linalg.solve(-here.rates, here.residual - margin)
        here = curve.at(here.moved(np.clip(step, -inward, outward)), tips.value, flow.ROUGH)
    return None


def _held(curve: Cohesive, table: Array, value: float) -> Array:
    """The intervals, with ends that contact covers taken back to where they come from."""
    before = curve.nearest(table, value).table if curve.known else table
    for _ in range(_TRIES):
        try:
            curve.at(table, value, flow.ROUGH)
            break
        except Covered as covered:
            if len(before) != len(table):
                raise
            table = np.where(covered.ends.reshape(2, -1).T, 0.5 * (table + before), table)
    return table


def _flowed(curve: Cohesive, table: Array, value: float, sign: float) -> CohesivePoint | None:
    here = curve.at(table, value, flow.ROUGH)
    first = here
    for _ in range(flow.MOST_STEPS):
        new = _parted(curve, here) if sign < 0 else _grown(curve, here)
        if new is not None:
            if len(new) == 0:
                return None
            first = here = _with_other_intervals(curve, here, new, sign)
            continue
        if sign < 0 and flow.come_apart(here, first.widths, first.residual).all():
            return None
        if _about_to_rest(curve, here):
            return here
        ahead, move = _step(curve, here, sign)
        assert isinstance(ahead, CohesivePoint)
        here = ahead
        if flow.at_rest(here, move):
            return here
        if move == 0.0:
            break
    raise NotConverged("the ends of the tension did not come to rest under a held control")


def _with_other_intervals(curve: Cohesive, here: CohesivePoint, table: Array, sign: float) -> CohesivePoint:
    zones = curve.fitted(here.zones, table)
    if sign > 0:
        zones = _filled(curve, zones, table)
    return curve.from_zones(uncovered(curve, table, here.value, zones) if sign > 0 else table, here.value, zones, flow.ROUGH)


def _filled(curve: Cohesive, zones: Array, table: Array) -> Array:
    """The zones with one in each interval without any that is far wider than a strip: what tension acts on there snaps shut, and while it
    is taken to be open it would pull on all others."""
    empty = np.ones(len(table), dtype=bool)
    empty[interval_of(zones, table)] = False
    new = table[empty & (np.diff(table, axis=1)[:, 0] > _WIDE * curve.strip)] + curve.strip * np.array((1.0, -1.0))
    found = np.concatenate((zones, new))
    return np.asarray(found[np.argsort(found[:, 0])])


def _about_to_rest(curve: Cohesive, here: CohesivePoint) -> bool:
    """Whether a stable equilibrium is so near that Newton's steps alone lead to it."""
    if here.growth >= 0.0 or np.abs(here.residual).max() > flow.DRIVEN:
        return False
    return bool(np.all(np.abs(here.newton) <= _ABOUT_TO_REST * curve.room(here.table)))


def settled(curve: Cohesive, here: Point, sign: float) -> CohesivePoint | None:
    """The equilibrium that ends about to rest have come to, tightly; where it has more intervals, or fewer, on from there."""
    for _ in range(_TRIES):
        tight = curve.settled(here)
        new = _parted(curve, tight) if sign < 0 else _grown(curve, tight)
        if new is None:
            return tight
        ahead = (advanced if sign > 0 else receded)(curve, new, here.value) if len(new) else None
        if ahead is None:
            return None
        here = ahead
    raise NotConverged("the intervals of the tension did not settle under a held control")


def uncovered(curve: Cohesive, table: Array, value: float, zones: Array) -> Array:
    """The intervals, or wider ones where contact covers these: what it covers is driven on, by more each time, and by little from the last
    of them that were covered where that went too far."""
    before, power, faster = table, 0, 1
    for _ in range(_WIDENINGS):
        try:
            here = curve.from_zones(table, value, curve.fitted(zones, table), flow.ROUGH)
        except Covered as covered:
            before, power = table, power + faster
            table = _widened(curve, table, zones, covered, _WIDEN ** (1 + power // _HASTE))
            continue
        if power < _HASTE or here.residual.min() > -flow.SLIGHT:
            return table
        table, power, faster = before, 0, 0
    raise NotConverged(TOO_NARROW)


def _widened(curve: Cohesive, table: Array, zones: Array, covered: Covered, by: float) -> Array:
    """zones: beside which the tension acts on strips, that are made so many times as wide where contact covers them."""
    width, gaps, zones = np.diff(table, axis=1)[:, 0], curve.gaps(table), curve.fitted(zones, table)
    strips = np.column_stack((width, width))
    i = interval_of(zones, table)
    np.minimum.at(strips, i, np.column_stack((zones[:, 0] - table[i, 0], table[i, 1] - zones[:, 1])))
    left, right = covered.ends.reshape(2, -1)
    out = (by - 1) * np.clip(strips, _LEAST * width[:, None], 0.5 * width[:, None])
    out = np.minimum(out, 0.4 * np.column_stack((np.roll(gaps, 1), gaps)))
    table = table + np.column_stack((-1.0 * left, right)) * out
    # What contact goes on to close is closed.
    joins = (curve.gaps(table) < flow.CLOSED * np.minimum(width, np.roll(width, -1))) & (right | np.roll(left, -1))
    if joins.all():
        raise Closed from covered
    return curve.within(joined(table, joins, [], curve.problem.round))


def _step(curve: Cohesive, here: Point, sign: float) -> tuple[Point, float]:
    limit, back = flow.limits(curve, here, sign)
    onward = sign * here.residual
    if here.growth >= 0.0 and onward.max() <= flow.SLIGHT < -onward.min():
        return _let_go(curve, here, sign)
    lost, beyond = 0, np.zeros(len(limit))
    size = curve.room(here.table)
    back_again = 0
    for _ in range(flow.MOST_TRIES):
        if back_again >= _ONE_WAY and here.growth >= 0.0:
            return _let_go(curve, here, sign)
        step = flow.kept_step(here, sign, limit, back) + beyond
        try:
            ahead = curve.at(here.moved(step), here.value, flow.ROUGH)
        except Lost:
            lost += 1
            if lost > _TRIES:
                raise
            limit = _shorter(here, limit, step, 0.3)
            continue
        except Covered as covered:
            # What has gone too far inward goes less far; what others have pushed out goes farther.
            if sign < 0:
                limit = _shorter(here, limit, step, np.where(covered.ends, 0.5, 0.9))
            else:
                beyond = np.where(covered.ends, 2 * beyond + _FARTHER * here.widths, beyond)
            continue
        passed = flow.passed(here, ahead, step, sign)
        if not passed.any():
            # Short of where contact is lost it is not at rest.
            return ahead, float(np.abs(step / size).max()) if lost == 0 else np.inf
        limit, back_again = _shorter(here, limit, step, np.where(passed, 0.5, 0.9)), back_again + 1
    raise NotConverged("no step of the ends keeps to the branch")


def _shorter(here: Point, limit: Array, step: Array, by: Array | float) -> Array:
    """Limits of a shorter step. A damped one keeps its shape, so that ends at rest do not hold up the others."""
    if here.growth >= 0.0:
        return np.asarray(float(np.min(by)) * limit * float((np.abs(step) / limit).max()))
    return np.asarray(by * np.minimum(limit, np.maximum(np.abs(step), 1e-12 * here.widths)))


def _let_go(curve: Cohesive, here: Point, sign: float) -> tuple[Point, float]:
    """Where ends that run away drive others the other way, as under a held approach: all ends down the slope of the energy, a step of
    the implicit Euler method, as long as lets them go no farther than they may."""
    onward, back = flow.limits(curve, here, sign)
    size = curve.room(here.table)
    onward, above = np.minimum(onward, _SLOWLY * np.maximum(size, 1e-3 * here.widths)), 1e-3
    for _ in range(flow.MOST_TRIES):
        step: Array = np.linalg.solve(np.diag((max(here.growth, 0.0) + above) * here.weight) - here.rates, here.residual).astype(np.float64)
        if np.all(np.abs(step) <= np.where(sign * step > 0.0, onward, back)):
            try:
                return curve.at(here.moved(np.asarray(step, dtype=np.float64)), here.value, flow.ROUGH), np.inf
            except Covered:
                pass
        above *= 2.0
    raise NotConverged("no step of the ends keeps to the branch")


def _grown(curve: Cohesive, here: CohesivePoint) -> Array | None:
    """The intervals with new ones, and with those as one between which the gap is below the reach; None if there are none."""
    (x, gap), table, period = here.look, here.table, curve.problem.round
    closed = flow.closing(curve, here)
    if closed is not None:
        return closed
    new, joins = [], np.zeros(len(table), dtype=bool)
    for i, (a, b) in enumerate(_outside(curve, table)):
        inner = within(x, a, b, period)
        below = gap[inner] < curve.reach
        if len(inner) and below.all() and np.isfinite(a) and np.isfinite(b):
            joins[i - (period is None)] = True
            continue
        for s, e in runs_of(below):
            place = wrapped(x[inner], a, period)
            if place[s] == curve.problem.corners[0] and e < len(inner) - 1:
                new.append((place[s], place[s] + 0.5 * _NEW * (place[e + 1] - place[s])))
            elif place[e] == curve.problem.corners[1] and s > 0:
                new.append((place[e] - 0.5 * _NEW * (place[e] - place[s - 1]), place[e]))
            elif s > 0 and e < len(inner) - 1:
                lo, hi = place[s - 1], place[e + 1]
                middle, half = 0.5 * (place[s] + place[e]), 0.5 * _NEW * max(place[e] - place[s], 0.1 * (hi - lo))
                new.append((middle - half, middle + half))
    if not new and not joins.any():
        return None
    if joins.all() and period is not None:
        raise Closed
    return joined(np.asarray(table), joins, new, period)


def _parted(curve: Cohesive, here: CohesivePoint) -> Array | None:
    """The intervals without parts over which the gap is above the reach, but those that begin at their ends; None if there are none."""
    (x, gap), table, period = here.look, here.table, curve.problem.round
    out: list[tuple[float, float]] = []
    changed = False
    for a, b in table:
        inner = within(x, a, b, period)
        above = gap[inner] > curve.reach
        if len(inner) and above.all() and not np.any(interval_of(here.zones, table) == len(out)) and not _holds(here, a, b):
            changed = True
            continue
        left = a
        place = wrapped(x[inner], a, period)
        for s, e in runs_of(above):
            if s > 0 and e < len(inner) - 1:
                out.append((left, place[s - 1]))
                left, changed = place[e + 1], True
        out.append((left, b))
    return np.array(out).reshape(-1, 2) if changed else None


def _holds(here: CohesivePoint, a: float, b: float) -> bool:
    return bool(np.any((here.zones[:, 0] > a) & (here.zones[:, 1] < b)))


def _outside(curve: Cohesive, table: Array) -> list[tuple[float, float]]:
    """Between the intervals: with a period the last one ends at the first interval of the next."""
    if curve.problem.round is not None:
        return [(a, b) for a, b in gaps_between(table, curve.problem.round)]
    return list(zip(np.append(-np.inf, table[:, 1]), np.append(table[:, 0], np.inf), strict=True))


def pull_off(curve: Cohesive, here: Point) -> Point:
    """Where the last zones come apart as the control falls: at a turning point, or where the last of them has shrunk to a point."""
    def recede(under: Equilibria, table: Array, value: float) -> Point | None:
        assert isinstance(under, Cohesive)
        return receded(under, table, value, guide_down(under, len(under.known[-1].zones), table))

    def near(under: Equilibria, at: Point) -> Point:
        assert isinstance(under, Cohesive)
        return arc.near_the_last(under, _about_to_part(under, at), recede)

    try:
        if curve.held.load is not None:
            here = _about_to_part(curve, here)
        here = arc.lowered_by_load(curve, here, near)
        return arc.pull_off(curve, here, recede, lambda at: _highest_within(curve, at) / curve.reach - 1.0)
    except Covered as covered:
        raise NotConverged(TOO_NARROW) from covered
    except (Lost, NotConverged):
        last = curve.known[-1]
        if not np.diff(last.zones, axis=1).sum() < SHRUNK * np.diff(last.table, axis=1).sum():
            raise
    return touching(curve, last.table, float(last.zones.mean()))


def _highest_within(curve: Cohesive, here: Point) -> float:
    """The largest gap within the intervals, but for what begins at their ends."""
    assert isinstance(here, CohesivePoint)
    (x, gap), period, highest = here.look, curve.problem.round, 0.0
    for a, b in here.table:
        inner = within(x, a, b, period)
        place, value = wrapped(x[inner], a, period), gap[inner]
        nearer = np.flatnonzero(value < curve.reach)
        if len(nearer) < 2:
            continue
        value = value[nearer[0] : nearer[-1] + 1]
        top = int(np.argmax(value))
        if 0 < top < len(value) - 1 and value[top] > highest:
            at = nearer[0] + top
            highest = maximum(
                lambda y: curve.gap(here, np.asarray(y)), place[at - 1 : at + 2], value=value[top - 1 : top + 2]
            )[1]
    return highest


def _about_to_part(curve: Cohesive, here: Point) -> Point:
    """The equilibrium that this one has come to under a control a little above the least at which a grid holds any; itself without one."""
    rest = _about_to_part_without_range(curve, here)
    if rest is not None:
        return rest
    guide = guide_down(curve, len(here.contact), here.table)
    if guide is None:
        return here
    try:
        least = guide.least_value(here.table, here.value)
    except NotConverged:
        # Under a held approach others are driven on by what recedes: it does not tell.
        return here
    for above in _ABOVE:
        rest = receded(curve, here.table, least + above * (here.value - least), guide)
        if rest is not None:
            return rest
    return here


def _about_to_part_without_range(curve: Cohesive, here: Point) -> Point | None:
    """The same by a little more adhesion without range, where tension acts on strips narrower than zones; None where that does not tell."""
    short = _without_range(curve, here.contact, 1.0 + _MORE[0]) if len(here.contact) > _FEW else None
    if short is None:
        return None
    with suppress(Closed, NoState, NotConverged):
        # A little more of it widens the contact.
        first = relaxed(short, here.table, here.value)
        least = here.value if first is None else arc.near_the_last(short, first).value
        for above in _ABOVE:
            value = least + above * (here.value - least)
            tips = None if first is None else flow.receded(short, first.table, value)
            start = None if tips is None else _with_range(curve, short, tips, -_MORE[0])
            rest = None if start is None else receded(curve, start.table, value)
            if rest is not None:
                return rest
    return None


def pull_off_from_all(curve: Cohesive, zones: Array, value: float) -> Point:
    """The same of a contact under tension everywhere: from where the gap somewhere comes to its reach, or to the last touch."""
    rest = _open_and_about_to_part(curve, zones, value)
    if rest is not None:
        return pull_off(curve, rest)
    problem, pulled = curve.problem, curve.everywhere
    assert problem.period is not None
    # Without contact the load is the tension's, and the base gives way to it.
    load = -pulled.pulling.total
    lost = load if curve.held.load is not None else (curve.yields * load - curve.stress * problem.compression)
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
    table = below(inside, (x, np.where(gap == gap.max(), 2 * curve.reach, gap)), curve.reach, problem.period, wide=True)
    try:
        curve.from_zones(table, high, curve.fitted(inside, table))
    except Lost:
        return state
    rest = receded(curve, table, high - 1e-9 * (value - lost))
    return state if rest is None else pull_off(curve, rest)


def _open_and_about_to_part(curve: Cohesive, zones: Array, value: float) -> Point | None:
    """The equilibrium that a contact under tension everywhere has come to under a control a little above the least at which a grid holds
    any; None where that does not tell, or where the tension has not let go before."""
    guide = guide_of(curve, len(zones), None)
    if guide is None:
        return None
    least = guide.least_value(None, value)
    for above in _ABOVE:
        control = least + above * (value - least)
        try:
            start = _guided(curve, guide, None, control, -1.0)
        except Lost:
            continue
        rest = None if start is None else receded(curve, start.table, control)
        if rest is not None:
            return rest
    return None


def touching(curve: Cohesive, table: Array, at: float) -> Loose:
    """The equilibrium in which the surfaces touch in one point, without pressure, beside one of hardly any contact there."""
    half = 0.02 * float(np.diff(table, axis=1).max())
    height = 0.0
    for _ in range(_STEPS):
        pulled = Pulled.of(curve.problem, curve.stress, table)
        at, height = maximum(_risen(pulled), np.linspace(at - half, at + half, 65))
        ends, tension = np.concatenate((table[:, 0], table[:, 1])), pulled.pulling
        gap = pulled.shape(ends) + height
        rates = curve.explicit(pulled, ends, np.zeros(len(ends))) - curve.stress / np.pi * tension.log(at - ends)
        free = (table != np.array(curve.problem.corners)).T.ravel() | (gap > curve.reach)
        step = np.zeros(len(ends))
        step[free] = np.linalg.solve(rates[np.ix_(free, free)], curve.reach - gap[free])
        table = curve.within(table + np.column_stack((-step[: len(table)], step[len(table) :])))
        if np.any(np.diff(table, axis=1) <= 0.0):
            raise NotConverged("the place where the surfaces touch last was not found")
        if float(np.abs(step).max()) < 1e-14 * float(np.diff(table, axis=1).min()):
            break
    load = -Pulled.of(curve.problem, curve.stress, table).pulling.total
    value = load if curve.held.load is not None else curve.yields * load - height
    return Loose.of(table, value, load, height, np.array([[at, at]]))


def _risen(pulled: Pulled) -> Callable[[Array], Array]:
    return lambda x: -pulled.shape(np.asarray(x))
