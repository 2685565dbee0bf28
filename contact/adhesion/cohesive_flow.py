"""The gradient flow of the ends of the intervals of tension (contact.adhesion.cohesive_zone).

Intervals of tension whose ends are driven outward advance; those driven inward recede. The steps
are those of contact.adhesion.gradient_flow. In addition, the set of intervals changes. A new
interval begins where the gap falls below the reach. Two intervals become one where the gap is below
the reach all the way between them. An interval is cut where the gap exceeds the reach. Contact is
lost where the total load of contact and tension no longer presses the surfaces together.
"""

import numpy as np

from contact.adhesion import gradient_flow, jkr_guide
from contact.adhesion.cohesive_state import CohesiveState
from contact.adhesion.cohesive_zone import CohesiveCurve
from contact.adhesion.curve import ACCURACY, Closed, NoState, State
from contact.adhesion.grid_guide import GridGuide
from contact.adhesion.inner_contact import ContactLost, EndsCovered
from contact.adhesion.intervals import below, interval_of, joined, within
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import NotConverged
from contact.formulation.tables import ascending, gaps_between, runs_of
from sie import Array

TOO_NARROW = (
    "the strips of tension beside the zones are too narrow to be resolved, since the stress of the "
    "law is so large: use contact.JKR(work)"
)


def advanced(
    curve: CohesiveCurve,
    table: Array,
    value: float,
    guide: GridGuide | None = None,
    zones: Array | None = None,
) -> CohesiveState:
    """The equilibrium with the smallest intervals of tension around the intervals `table`.

    All ends of the intervals `table` must tend to advance: their residuals are positive. Raises
    `Closed` if there is no such equilibrium. zones: first guess of the contact, which may cover
    ends of the intervals.
    """
    start = None if zones is None else jkr_guide.before_advanced(curve, zones, value)
    if start is None and guide is not None:
        start = guided(curve, guide, table, value, 1.0)
    if start is not None:
        table = start.table
    elif zones is not None:
        table = uncovered(curve, table, value, zones)
    try:
        found = _flow(curve, table, value, 1.0)
    except EndsCovered as covered:
        raise NotConverged(TOO_NARROW) from covered
    assert found is not None
    return found


def _past_snaps(curve: CohesiveCurve, before: CohesiveState, here: CohesiveState) -> CohesiveState:
    """The state `here`, or the state after its new zones of contact have snapped wider.

    The state after the snap is found from a law without range (JKR).
    """
    if len(here.zones) <= len(before.zones) or here.residual.max() < MOVES.hard_drive:
        return here
    ahead = jkr_guide.before_advanced(curve, here.zones, here.value)
    if ahead is None:
        return here
    # `here` is kept if one of its zones is missing from `ahead`. At such a zone the law without
    # range (JKR), from which `ahead` is built, gives no contact.
    return ahead if ahead.q is not None and ahead.q.inside(here.zones.mean(axis=1)).all() else here


def receded(
    curve: CohesiveCurve, table: Array, value: float, guide: GridGuide | None = None
) -> CohesiveState | None:
    """The equilibrium with the largest intervals of tension inside the intervals `table`.

    All ends of the intervals `table` must tend to recede: their residuals are negative. None where
    contact is lost.
    """
    try:
        start = None if guide is None else guided(curve, guide, table, value, -1.0)
        return _flow(curve, table if start is None else start.table, value, -1.0)
    except ContactLost:
        return None


def guide_of(curve: CohesiveCurve, zones: int, table: Array | None) -> GridGuide | None:
    """A grid problem that predicts where the ends of given intervals of tension come to rest.

    None if there is no contact, if the profile ends at sharp corners, or if the control is a
    spring. table: None for tension in all of a period.
    """
    control = curve.control
    if (
        zones == 0
        or curve.problem.profile.support is not None
        or (control.load is None and control.approach is None)
    ):
        return None
    return GridGuide.of(curve.problem, table, control.load is not None)


def guide_down(curve: CohesiveCurve, zones: int, table: Array) -> GridGuide | None:
    """A grid problem that predicts where receding ends come to rest; None for few zones."""
    return guide_of(curve, zones, table) if zones > MOVES.few_zones else None


def guided(
    curve: CohesiveCurve, guide: GridGuide, table: Array | None, value: float, sign: float
) -> CohesiveState | None:
    """A state near equilibrium, found on a grid; its ends all tend to move in one direction.

    The ends are driven outward for sign 1, inward for sign -1. On the grid, the reach of the
    tension is changed by a fraction, the margin. None if the error of the grid exceeds the margin,
    so that residuals have the wrong sign or are too large. table: None for tension in all of a
    period.
    """
    for margin in MOVES.margins:
        try:
            found = guide.resting(table, value, sign, 1.0 - sign * margin)
            here = curve.from_zones(
                found.table, value, curve.fitted(found.zones, found.table), ACCURACY.rough
            )
        except Closed:
            if sign > 0 and margin == MOVES.margins[-1]:
                raise
            continue
        except ContactLost:
            # On the grid, the reach of the tension is enlarged by the fraction `margin`. If
            # receding ends lose all contact even for the largest margin, there is no equilibrium.
            if sign < 0 and margin == MOVES.margins[-1]:
                raise
            continue
        except (NoState, NotConverged):
            continue
        driven = sign * here.residual
        if (
            driven.min() > 0.0
            and driven.max() < 2 * margin
            and (_intervals_cut if sign > 0 else _intervals_grown)(curve, here) is None
        ):
            return here
    return None


def _flow(curve: CohesiveCurve, table: Array, value: float, sign: float) -> CohesiveState | None:
    here = curve.at(table, value, ACCURACY.rough)
    first = here
    for _ in range(LIMITS.max_steps):
        new = _changed_intervals(curve, here, sign)
        if new is not None:
            if len(new) == 0:
                return None
            other = _on_new_intervals(curve, here, new, sign)
            first = here = _past_snaps(curve, here, other) if sign > 0 else other
            continue
        if sign < 0 and gradient_flow.lost_zones(here, first.widths, first.residual).all():
            return None
        if _is_near_rest(curve, here):
            return here
        ahead, move = gradient_flow.moved_on(curve, here, sign)
        assert isinstance(ahead, CohesiveState)
        here = ahead
        if gradient_flow.at_rest(here, move):
            return here
        if move == 0.0:
            break
    raise NotConverged(
        "the ends of the intervals of tension did not converge at a fixed value of the control"
    )


def _changed_intervals(curve: CohesiveCurve, here: CohesiveState, sign: float) -> Array | None:
    """The intervals of tension after births, merges and cuts at a state; None if unchanged."""
    if sign > 0:
        return _intervals_grown(curve, here)
    # In a receding flow, some ends may still advance and close a gap.
    parted = _intervals_cut(curve, here)
    return gradient_flow.closing(curve, here) if parted is None else parted


def _on_new_intervals(
    curve: CohesiveCurve, here: CohesiveState, table: Array, sign: float
) -> CohesiveState:
    """The state near `here` with tension on other intervals `table`, to rough accuracy."""
    zones = curve.fitted(here.zones, table)
    if sign > 0:
        zones = _filled(curve, zones, table)
    return curve.from_zones(
        uncovered(curve, table, here.value, zones) if sign > 0 else table,
        here.value,
        zones,
        ACCURACY.rough,
    )


def _filled(curve: CohesiveCurve, zones: Array, table: Array) -> Array:
    """The zones, and one more zone in each wide interval of tension without contact.

    In an interval far wider than a strip of tension, surfaces snap into contact. Without the new
    zone, the tension of this interval would move the ends of all other intervals.
    """
    empty = np.ones(len(table), dtype=bool)
    empty[interval_of(zones, table)] = False
    new = table[
        empty & (np.diff(table, axis=1)[:, 0] > curve.strip / MOVES.small_part)
    ] + curve.strip * np.array((1.0, -1.0))
    return ascending(np.concatenate((zones, new)))


def _is_near_rest(curve: CohesiveCurve, here: CohesiveState) -> bool:
    """Whether `here` is so near a stable equilibrium that Newton's method alone converges."""
    if here.growth >= 0.0 or np.abs(here.residual).max() > MOVES.hard_drive:
        return False
    return bool(np.all(np.abs(here.newton) <= ACCURACY.coarse * curve.room(here.table)))


def settled(curve: CohesiveCurve, here: State, sign: float) -> CohesiveState | None:
    """The equilibrium near a state whose ends are almost at rest, to full accuracy.

    If intervals of tension begin, merge or are cut there, the flow goes on from the new intervals.
    """
    for _ in range(LIMITS.patience):
        try:
            tight = curve.settled(here)
        except ContactLost:
            # Newton's method has lost the contact, since the state was close to pull-off.
            if sign > 0:
                raise
            return None
        new = _changed_intervals(curve, tight, sign)
        if new is None:
            return tight
        ahead = (advanced if sign > 0 else receded)(curve, new, here.value) if len(new) else None
        if ahead is None:
            return None
        here = ahead
    raise NotConverged(
        "the number of intervals of tension did not converge at a fixed value of the control"
    )


def uncovered(curve: CohesiveCurve, table: Array, value: float, zones: Array) -> Array:
    """The intervals of tension, widened where contact covers the ends of an interval.

    Each widening is by a larger factor than the one before. If the ends are driven inward
    afterwards, the last widening is replaced by several small ones.
    """
    before, power, faster = table, 0, 1
    for _ in range(LIMITS.max_iterations):
        try:
            here = curve.from_zones(table, value, curve.fitted(zones, table), ACCURACY.rough)
        except EndsCovered as covered:
            before, power = table, power + faster
            table = _widened(curve, table, zones, covered, MOVES.widening ** (1 + power))
            continue
        if power == 0 or here.residual.min() > -ACCURACY.coarse:
            return table
        table, power, faster = before, 0, 0
    raise NotConverged(TOO_NARROW)


def intervals_left(
    curve: CohesiveCurve, value: float, zones: Array, gap_samples: tuple[Array, Array]
) -> Array:
    """Intervals of tension around the zones, after the tension acted on the whole period.
    They are the intervals in which the sampled gap is below the reach of the tension.

    Raises ContactLost where no contact is left.
    """
    return uncovered(
        curve, below(zones, gap_samples, curve.reach, curve.problem.period, wide=True), value, zones
    )


def _widened(
    curve: CohesiveCurve, table: Array, zones: Array, covered: EndsCovered, by: float
) -> Array:
    """The intervals of tension, widened at those of their ends that contact covers.

    A strip is the part of an interval between its end and the nearest contact. by: the factor by
    which the strips at covered ends are widened.
    """
    width, gaps, zones = np.diff(table, axis=1)[:, 0], curve.gaps(table), curve.fitted(zones, table)
    strips = np.column_stack((width, width))
    i = interval_of(zones, table)
    np.minimum.at(
        strips, i, np.column_stack((zones[:, 0] - table[i, 0], table[i, 1] - zones[:, 1]))
    )
    left, right = covered.ends.reshape(2, -1)
    out = (by - 1) * np.clip(strips, ACCURACY.resting_step * width[:, None], 0.5 * width[:, None])
    out = np.minimum(out, MOVES.max_move * np.column_stack((np.roll(gaps, 1), gaps)))
    table = table + np.column_stack((-1.0 * left, right)) * out
    # Two intervals are joined if the gap between them is very narrow and contact covers an end of
    # this gap.
    joins = (curve.gaps(table) < MOVES.vanished * np.minimum(width, np.roll(width, -1))) & (
        right | np.roll(left, -1)
    )
    if joins.all():
        raise Closed from covered
    return curve.within(joined(table, joins, [], curve.problem.round))


def _intervals_grown(curve: CohesiveCurve, here: CohesiveState) -> Array | None:
    """The intervals of tension, with new intervals where the gap is below the reach.
    Two intervals are merged if the gap is below the reach everywhere between them.

    None if nothing changed.
    """
    (x, gap), table, period = here.gap_samples, here.table, curve.problem.round
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
                new.append((place[s], place[s] + 0.25 * (place[e + 1] - place[s])))
            elif place[e] == curve.problem.corners[1] and s > 0:
                new.append((place[e] - 0.25 * (place[e] - place[s - 1]), place[e]))
            elif s > 0 and e < len(inner) - 1:
                lo, hi = place[s - 1], place[e + 1]
                middle, half = (
                    0.5 * (place[s] + place[e]),
                    0.25 * max(place[e] - place[s], 0.1 * (hi - lo)),
                )
                new.append((middle - half, middle + half))
    if not new and not joins.any():
        return None
    if joins.all() and period is not None:
        raise Closed
    return joined(np.asarray(table), joins, new, period)


def _intervals_cut(curve: CohesiveCurve, here: CohesiveState) -> Array | None:
    """The intervals of tension, without parts where the gap exceeds the reach of the tension.

    Places next to an end of an interval are not removed, since that end recedes over them. None if
    nothing changed.
    """
    (x, gap), table, period = here.gap_samples, here.table, curve.problem.round
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


def _outside(curve: CohesiveCurve, table: Array) -> list[tuple[float, float]]:
    """Intervals (left, right) without tension; the last may cross the border of the period."""
    if curve.problem.round is not None:
        return [(a, b) for a, b in gaps_between(table, curve.problem.round)]
    return list(zip(np.append(-np.inf, table[:, 1]), np.append(table[:, 0], np.inf), strict=True))
