r"""Intervals of tension that are driven outward advance, and those driven inward recede
(contact.adhesion.cohesive_zone).

The steps are those of contact.adhesion.gradient_flow. What is different is which intervals there
are: new ones begin where the gap comes below the reach, and they become one where it is below it
all between; they are cut where it comes above. Contact is lost where the load of q does not press
any more.
"""

import numpy as np

from contact.adhesion import gradient_flow, jkr_guide
from contact.adhesion.cohesive_zone import Cohesive, CohesivePoint
from contact.adhesion.curve import Closed, NoState, Point
from contact.adhesion.grid_guide import GridTension
from contact.adhesion.inner_contact import Covered, Lost
from contact.adhesion.intervals import below, interval_of, joined, within
from contact.errors import NotConverged
from contact.formulation.tables import ascending, gaps_between, runs_of
from sie import Array

# Of the part of a gap below the reach, as wide a new interval begins.
_NEW = 0.5
# How often a step is shortened that would lose contact, or whose contact is not found.
_TRIES = 6
# How often, and by how much, intervals are widened that contact covers.
_WIDENINGS = 120
_WIDEN = 1.25
# Over an interval, what a strip beside its contact is taken to be at the least.
_LEAST = 1e-6
# By what new zones are driven that snap shut.
_SNAPS = 0.5
# So often ends are let go one way only; of the widths, how far else; what drives ends the other way
# that need not run away to be let go.
_ONE_WAY = 4
_SLOWLY = 0.5
_DRIVEN_BACK = 0.05
# Over the width of an interval, how far an end goes that contact covers as others advance.
_FARTHER = 0.01
# Intervals over a strip beside contact, that do not stay open.
_WIDE = 10.0
# Newton's step of ends that are about to rest, over their intervals and the gaps beside them.
_ABOUT_TO_REST = 1e-3
# Zones that recede without a grid.
FEW = 6
# Parts of the reach that it is made smaller or larger by on a grid.
_MARGINS = (0.02, 0.06, 0.2)

TOO_NARROW = (
    "the tension would act on strips narrower than a millionth of the zones beside them: "
    "under so large a stress adhesion is without range"
)


def advanced(
    curve: Cohesive,
    table: Array,
    value: float,
    guide: GridTension | None = None,
    zones: Array | None = None,
) -> CohesivePoint:
    """The least equilibrium that holds these intervals, of which all ends are driven outward;
    `Closed` if there is none. zones: that they begin with, where contact may cover some intervals.
    """
    start = None if zones is None else jkr_guide.near_advanced(curve, zones, value)
    if start is None and guide is not None:
        start = guided(curve, guide, table, value, 1.0)
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


def _led_on(curve: Cohesive, before: CohesivePoint, here: CohesivePoint) -> CohesivePoint:
    """The state that has new intervals, or one that a law without range leads to where new zones
    snap shut in them.
    """
    if len(here.zones) <= len(before.zones) or here.residual.max() < _SNAPS:
        return here
    ahead = jkr_guide.near_advanced(curve, here.zones, here.value)
    if ahead is None:
        return here
    # Where a zone has gone again, it does not snap shut without range.
    return ahead if ahead.q is not None and ahead.q.inside(here.zones.mean(axis=1)).all() else here


def receded(
    curve: Cohesive, table: Array, value: float, guide: GridTension | None = None
) -> CohesivePoint | None:
    """The greatest equilibrium within these intervals, of which all ends are driven inward; None
    where contact is lost.
    """
    try:
        start = None if guide is None else guided(curve, guide, table, value, -1.0)
        return _flowed(curve, table if start is None else start.table, value, -1.0)
    except Lost:
        return None


def guide_of(curve: Cohesive, zones: int, table: Array | None) -> GridTension | None:
    """A grid by which ends are guided that move from these intervals (None: from tension in all of
    a period); none without contact, or where a spring holds it.
    """
    held = curve.held
    if (
        zones == 0
        or curve.problem.profile.support is not None
        or (held.load is None and held.approach is None)
    ):
        return None
    return GridTension.of(curve.problem, table, held.load is not None)


def guide_down(curve: Cohesive, zones: int, table: Array) -> GridTension | None:
    """The same where zones recede from an equilibrium: of few of them the way itself is shorter."""
    return guide_of(curve, zones, table) if zones > FEW else None


def guided(
    curve: Cohesive, guide: GridTension, table: Array | None, value: float, sign: float
) -> CohesivePoint | None:
    """A state from which ends are all driven onward to the same equilibrium as from these intervals
    (None: tension in all of a period), and not far, by a grid; None where that does not tell. What
    the grid is wrong by is seen in what drives the ends: of what it makes rest that is the margin.
    """
    for margin in _MARGINS:
        try:
            found = guide.resting(table, value, sign, 1.0 - sign * margin)
            here = curve.from_zones(
                found.table, value, curve.fitted(found.zones, found.table), gradient_flow.ROUGH
            )
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
        if (
            driven.min() > 0.0
            and driven.max() < 2 * margin
            and (_parted if sign > 0 else _grown)(curve, here) is None
        ):
            return here
    return None


def _flowed(curve: Cohesive, table: Array, value: float, sign: float) -> CohesivePoint | None:
    here = curve.at(table, value, gradient_flow.ROUGH)
    first = here
    for _ in range(gradient_flow.MOST_STEPS):
        new = _other_intervals(curve, here, sign)
        if new is not None:
            if len(new) == 0:
                return None
            other = _with_other_intervals(curve, here, new, sign)
            first = here = _led_on(curve, here, other) if sign > 0 else other
            continue
        if sign < 0 and gradient_flow.come_apart(here, first.widths, first.residual).all():
            return None
        if _about_to_rest(curve, here):
            return here
        ahead, move = _step(curve, here, sign)
        assert isinstance(ahead, CohesivePoint)
        here = ahead
        if gradient_flow.at_rest(here, move):
            return here
        if move == 0.0:
            break
    raise NotConverged("the ends of the tension did not come to rest under a held control")


def _other_intervals(curve: Cohesive, here: CohesivePoint, sign: float) -> Array | None:
    """The intervals there are where ends have come to, as they go on; None if they are the same."""
    if sign > 0:
        return _grown(curve, here)
    # Ends that are let go may close a gap.
    parted = _parted(curve, here)
    return gradient_flow.closing(curve, here) if parted is None else parted


def _with_other_intervals(
    curve: Cohesive, here: CohesivePoint, table: Array, sign: float
) -> CohesivePoint:
    zones = curve.fitted(here.zones, table)
    if sign > 0:
        zones = _filled(curve, zones, table)
    return curve.from_zones(
        uncovered(curve, table, here.value, zones) if sign > 0 else table,
        here.value,
        zones,
        gradient_flow.ROUGH,
    )


def _filled(curve: Cohesive, zones: Array, table: Array) -> Array:
    """The zones with one in each interval without any that is far wider than a strip: what tension
    acts on there snaps shut, and while it is taken to be open it would pull on all others.
    """
    empty = np.ones(len(table), dtype=bool)
    empty[interval_of(zones, table)] = False
    new = table[
        empty & (np.diff(table, axis=1)[:, 0] > _WIDE * curve.strip)
    ] + curve.strip * np.array((1.0, -1.0))
    return ascending(np.concatenate((zones, new)))


def _about_to_rest(curve: Cohesive, here: CohesivePoint) -> bool:
    """Whether a stable equilibrium is so near that Newton's steps alone lead to it."""
    if here.growth >= 0.0 or np.abs(here.residual).max() > gradient_flow.DRIVEN:
        return False
    return bool(np.all(np.abs(here.newton) <= _ABOUT_TO_REST * curve.room(here.table)))


def settled(curve: Cohesive, here: Point, sign: float) -> CohesivePoint | None:
    """The equilibrium that ends about to rest have come to, tightly; where it has more intervals,
    or fewer, on from there.
    """
    for _ in range(_TRIES):
        try:
            tight = curve.settled(here)
        except Lost:
            # Of the last contact next to where it comes apart.
            if sign > 0:
                raise
            return None
        new = _other_intervals(curve, tight, sign)
        if new is None:
            return tight
        ahead = (advanced if sign > 0 else receded)(curve, new, here.value) if len(new) else None
        if ahead is None:
            return None
        here = ahead
    raise NotConverged("the intervals of the tension did not settle under a held control")


def uncovered(curve: Cohesive, table: Array, value: float, zones: Array) -> Array:
    """The intervals, or wider ones where contact covers these: what it covers is driven on, by more
    each time, and by little from the last of them that were covered where that went too far.
    """
    before, power, faster = table, 0, 1
    for _ in range(_WIDENINGS):
        try:
            here = curve.from_zones(table, value, curve.fitted(zones, table), gradient_flow.ROUGH)
        except Covered as covered:
            before, power = table, power + faster
            table = _widened(curve, table, zones, covered, _WIDEN ** (1 + power))
            continue
        if power == 0 or here.residual.min() > -gradient_flow.SLIGHT:
            return table
        table, power, faster = before, 0, 0
    raise NotConverged(TOO_NARROW)


def left_of_all(curve: Cohesive, value: float, zones: Array, look: tuple[Array, Array]) -> Array:
    """What is left of a tension on all of a period as it lets go where the gap beside zones of
    contact is above the reach: where contact comes to reach farther than that, more. Lost where no
    contact is left.
    """
    return uncovered(
        curve, below(zones, look, curve.reach, curve.problem.period, wide=True), value, zones
    )


def _widened(curve: Cohesive, table: Array, zones: Array, covered: Covered, by: float) -> Array:
    """zones: beside which the tension acts on strips, that are made so many times as wide where
    contact covers them.
    """
    width, gaps, zones = np.diff(table, axis=1)[:, 0], curve.gaps(table), curve.fitted(zones, table)
    strips = np.column_stack((width, width))
    i = interval_of(zones, table)
    np.minimum.at(
        strips, i, np.column_stack((zones[:, 0] - table[i, 0], table[i, 1] - zones[:, 1]))
    )
    left, right = covered.ends.reshape(2, -1)
    out = (by - 1) * np.clip(strips, _LEAST * width[:, None], 0.5 * width[:, None])
    out = np.minimum(out, 0.4 * np.column_stack((np.roll(gaps, 1), gaps)))
    table = table + np.column_stack((-1.0 * left, right)) * out
    # What contact goes on to close is closed.
    joins = (curve.gaps(table) < gradient_flow.CLOSED * np.minimum(width, np.roll(width, -1))) & (
        right | np.roll(left, -1)
    )
    if joins.all():
        raise Closed from covered
    return curve.within(joined(table, joins, [], curve.problem.round))


def _step(curve: Cohesive, here: Point, sign: float) -> tuple[Point, float]:
    onward = sign * here.residual
    if onward.min() < -_DRIVEN_BACK or (
        here.growth >= 0.0 and onward.max() <= gradient_flow.SLIGHT < -onward.min()
    ):
        return _let_go(curve, here, sign)
    limit, back = gradient_flow.limits(curve, here, sign)
    lost, beyond = 0, np.zeros(len(limit))
    size = curve.room(here.table)
    back_again = 0
    for _ in range(gradient_flow.MOST_TRIES):
        if back_again >= _ONE_WAY and here.growth >= 0.0:
            return _let_go(curve, here, sign)
        step = gradient_flow.kept_step(here, sign, limit, back) + beyond
        try:
            ahead = curve.at(here.moved(step), here.value, gradient_flow.ROUGH)
        except (Lost, NotConverged):
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
        passed = gradient_flow.passed(here, ahead, step, sign)
        if not passed.any():
            # Short of where contact is lost it is not at rest.
            return ahead, float(np.abs(step / size).max()) if lost == 0 else np.inf
        limit, back_again = _shorter(here, limit, step, np.where(passed, 0.5, 0.9)), back_again + 1
    raise NotConverged("no step of the ends keeps to the branch")


def _shorter(here: Point, limit: Array, step: Array, by: Array | float) -> Array:
    """Limits of a shorter step. A damped one keeps its shape, so that ends at rest do not hold up
    the others.
    """
    if here.growth >= 0.0:
        return np.asarray(float(np.min(by)) * limit * float((np.abs(step) / limit).max()))
    return np.asarray(by * np.minimum(limit, np.maximum(np.abs(step), 1e-12 * here.widths)))


def _let_go(curve: Cohesive, here: Point, sign: float) -> tuple[Point, float]:
    """Where ends that run away drive others the other way, as under a held approach: all ends down
    the slope of the energy, a step of the implicit Euler method, as long as lets them go no farther
    than they may.
    """
    inward, outward = gradient_flow.inward_and_outward(curve, here)
    onward, back = (outward, inward) if sign > 0 else (inward, outward)
    size = curve.room(here.table)
    onward, above = np.minimum(onward, _SLOWLY * np.maximum(size, 1e-3 * here.widths)), 1e-3
    for _ in range(gradient_flow.MOST_TRIES):
        step = here.damped_step(above)
        if np.all(np.abs(step) <= np.where(sign * step > 0.0, onward, back)):
            try:
                return curve.at(here.moved(step), here.value, gradient_flow.ROUGH), np.inf
            except Covered:
                pass
        above *= 2.0
    raise NotConverged("no step of the ends keeps to the branch")


def _grown(curve: Cohesive, here: CohesivePoint) -> Array | None:
    """The intervals with new ones, and with those as one between which the gap is below the reach;
    None if there are none.
    """
    (x, gap), table, period = here.look, here.table, curve.problem.round
    closed = gradient_flow.closing(curve, here)
    if closed is not None:
        return closed
    new, joins = [], np.zeros(len(table), dtype=bool)
    for i, (a, b) in enumerate(_outside(curve, table)):
        inner, place = within(x, a, b, period)
        reached = gap[inner] < curve.reach
        if len(inner) and reached.all() and np.isfinite(a) and np.isfinite(b):
            joins[i - (period is None)] = True
            continue
        for s, e in runs_of(reached):
            if place[s] == curve.problem.corners[0] and e < len(inner) - 1:
                new.append((place[s], place[s] + 0.5 * _NEW * (place[e + 1] - place[s])))
            elif place[e] == curve.problem.corners[1] and s > 0:
                new.append((place[e] - 0.5 * _NEW * (place[e] - place[s - 1]), place[e]))
            elif s > 0 and e < len(inner) - 1:
                lo, hi = place[s - 1], place[e + 1]
                middle, half = (
                    0.5 * (place[s] + place[e]),
                    0.5 * _NEW * max(place[e] - place[s], 0.1 * (hi - lo)),
                )
                new.append((middle - half, middle + half))
    if not new and not joins.any():
        return None
    if joins.all() and period is not None:
        raise Closed
    return joined(np.asarray(table), joins, new, period)


def _parted(curve: Cohesive, here: CohesivePoint) -> Array | None:
    """The intervals without parts over which the gap is above the reach, but those that begin at
    their ends; None if there are none.
    """
    (x, gap), table, period = here.look, here.table, curve.problem.round
    out: list[tuple[float, float]] = []
    changed = False
    for a, b in table:
        inner, place = within(x, a, b, period)
        above = gap[inner] > curve.reach
        holds = (here.zones[:, 0] > a) & (here.zones[:, 1] < b)
        if (
            len(inner)
            and above.all()
            and not np.any(interval_of(here.zones, table) == len(out))
            and not holds.any()
        ):
            changed = True
            continue
        left = a
        for s, e in runs_of(above):
            if s > 0 and e < len(inner) - 1:
                out.append((left, place[s - 1]))
                left, changed = place[e + 1], True
        out.append((left, b))
    return np.array(out).reshape(-1, 2) if changed else None


def _outside(curve: Cohesive, table: Array) -> list[tuple[float, float]]:
    """Between the intervals: with a period the last one ends at the first interval of the next."""
    if curve.problem.round is not None:
        return [(a, b) for a, b in gaps_between(table, curve.problem.round)]
    return list(zip(np.append(-np.inf, table[:, 1]), np.append(table[:, 0], np.inf), strict=True))
