"""The gradient flow: ends that are driven outward advance, ends driven inward recede, to the
nearest equilibrium under a held control.

Under a held load on a half-plane, an end that advances only adds to the drive of the others,
dr_j/ds_i >= 0: what it pulls down comes nearer to them. Ends that are all driven outward then
advance together, without turning back, to the least equilibrium that holds them. Ends that are
all driven inward recede to the greatest equilibrium inside. A slowly changed control leads to the
same ones (cooperative systems: M. W. Hirsch, SIAM J. Math. Anal. 13, 1982, 167).

Under a held approach, and on a layer, an end that advances may hold back others. The same steps
are taken and the same certificate is asked for, but the branch is not proved to be the least.

The steps are Newton's,

    -J ds = r,   J = dr/ds,

with every end bounded by its limits. Where J has growing motions, mu D - J takes the place of -J,
D diagonal and mu above their growth.
"""

from dataclasses import dataclass

import numpy as np

from contact.adhesion.curve import TOLERANCES, Closed, Curve, State
from contact.adhesion.intervals import joined
from contact.adhesion.limits import LIMITS
from contact.adhesion.predictor import Predictor
from contact.errors import NotConverged
from sie import Array, Mask


@dataclass(frozen=True)
class FlowOptions:
    """Steps of ends that advance or recede under a held control.

    Drives are in units of the law's own: |K*|, or the reach. Lengths are over the interval.
    """

    # Longest step back of an end that the others relieve.
    max_back: float = 0.02
    resting_drive: float = 1e-4
    # How far past an equilibrium a step may end, over the drive at its start and in all; a further
    # limit where an end would run on from there.
    overshoot: float = 0.1
    max_drive_back: float = 0.05
    runaway_overshoot: float = 1e-3
    # Part of the chord to an equilibrium that a step which overshoots it takes.
    chord_part: float = 0.8
    # Share of the largest motion from which on an end belongs to a growing motion.
    runaway_share: float = 0.3
    # A gap below this part of its zones whose ends are driven by more than the next number has
    # closed; a zone below the third number, with such ends, is lost.
    closed_gap: float = 1e-2
    hard_drive: float = 0.5
    lost_zone: float = 0.02
    # The predictor is used for at least so many zones, if some end is driven by more than
    # `overshoot`.
    predictor_zones: int = 12
    predictor_tries: int = 4


FLOW = FlowOptions()
# Places inside a step at which the cubic of the drive is tested.
_INNER_PLACES = np.linspace(0.05, 0.95, 10)


def advanced(
    curve: Curve, table: Array, value: float, rest: float = TOLERANCES.resting_step
) -> State:
    """The least equilibrium that holds these intervals, whose ends are all driven outward.

    Raises `Closed` if there is none. rest: Newton's step, over the widths, of ends at rest.
    """
    found = _flow(curve, table, value, 1.0, rest)
    assert found is not None
    return found


def receded(curve: Curve, table: Array, value: float) -> State | None:
    """The greatest equilibrium inside these intervals, whose ends are all driven inward.

    None if all have come apart.
    """
    return _flow(curve, table, value, -1.0)


def _flow(
    curve: Curve, table: Array, value: float, sign: float, rest: float = TOLERANCES.resting_step
) -> State | None:
    here = curve.at(table, value, TOLERANCES.rough)
    widths, residual = here.widths, here.residual
    for _ in range(LIMITS.max_steps):
        predicted = _predictor(curve, here, sign)
        if sign > 0 and (merged := closing(curve, here, predicted)) is not None:
            here = curve.at(merged, value, TOLERANCES.rough)
            continue
        if sign < 0 and (apart := lost_zones(here, widths, residual)).any():
            if apart.all():
                return None
            stays = np.tile(~apart, 2)
            here, widths, residual = (
                curve.at(here.table[~apart], value, TOLERANCES.rough),
                widths[stays],
                residual[stays],
            )
            continue
        ahead = None if predicted is None else _predicted_step(curve, here, sign, predicted)
        here, move = (ahead, np.inf) if ahead is not None else _step(curve, here, sign)
        if at_rest(here, move, rest):
            return here
        if move == 0.0:
            break
        if sign < 0:
            # A zone that the others relieve on the way narrows anew from there.
            relieved = here.residual > residual
            widths, residual = (
                np.where(relieved, here.widths, widths),
                np.maximum(here.residual, residual),
            )
    raise NotConverged(
        "the ends of zones that grow or shrink under a held control did not come to rest"
    )


def at_rest(here: State, move: float, rest: float = TOLERANCES.resting_step) -> bool:
    """Whether ends are at rest after a step.

    move: largest part of a width moved. rest: largest Newton step of ends at rest. A step may be
    short only because another end reached its corner: then Newton's next step is longer.
    """
    driven = float(np.abs(here.residual).max())
    if here.growth < 0.0 and driven <= FLOW.hard_drive:
        newton = float(np.abs(here.newton / here.widths).max())
        return newton <= rest or (
            move <= TOLERANCES.resting_step and newton <= 10 * TOLERANCES.resting_step
        )
    return move <= TOLERANCES.resting_step and driven <= FLOW.resting_drive


def _predictor(curve: Curve, here: State, sign: float) -> Predictor | None:
    """The predictor of the drives on the way.

    None where zones are few, or where Newton's step is better.
    """
    if (
        len(here.table) < FLOW.predictor_zones
        or here.corners is not None
        or float((sign * here.residual).max()) < FLOW.overshoot
    ):
        return None
    return Predictor.of(curve, here, curve.fields(here, TOLERANCES.rough), sign)


def _predicted_step(curve: Curve, here: State, sign: float, predicted: Predictor) -> State | None:
    """The state after a predicted step; None if the prediction was wrong."""
    inward, outward = inward_and_outward(curve, here, detailed=False)
    limit = outward if sign > 0 else inward
    for _ in range(FLOW.predictor_tries):
        step = predicted.step(limit)
        ahead = curve.at(here.moved(sign * step), here.value, TOLERANCES.rough)
        astray = predicted.astray(step, sign * ahead.residual)
        if not astray.any():
            return ahead
        limit = np.where(astray, 0.5 * step, limit)
    return None


def _step(curve: Curve, here: State, sign: float) -> tuple[State, float]:
    """(next state, largest move over the widths)."""
    limit, back = limits(curve, here, sign)
    runaway: Mask | None = running_away(here)
    if np.any(runaway) and float(np.abs(here.residual).max()) <= FLOW.resting_drive:
        # Next to a turning point ends leave by the growing motion, not each as far as it may.
        runaway = None
    for _ in range(LIMITS.max_bisections):
        step = bounded_step(here, sign, limit, back, runaway)
        # Ends at rest are accurate only if the residual of those driven hard is small.
        ahead = curve.at(
            here.moved(step),
            here.value,
            max(1e-14, TOLERANCES.rough / max(1.0, float(np.abs(here.residual).max()))),
        )
        over = overshoots(here, ahead, step, sign)
        if not over.any():
            return ahead, float(np.abs(step / here.widths).max())
        # An end that has passed an equilibrium goes back to about there. All others move less,
        # too, in case that does not help.
        before, after = here.whole.residual, ahead.whole.residual
        part = np.divide(
            FLOW.chord_part * before,
            before - after,
            out=np.full(len(before), 0.5),
            where=before != after,
        )
        shorter = np.where(over, np.clip(np.where(part > 0.0, part, 0.5), 0.01, 0.5), 0.9)
        limit = shorter * np.minimum(limit, np.maximum(np.abs(step), 1e-12 * here.widths))
    raise NotConverged("no step of the ends keeps to the branch")


def limits(curve: Curve, here: State, sign: float) -> tuple[Array, Array]:
    """How far ends may move onward, and back, in a step (2n,)."""
    inward, outward = inward_and_outward(curve, here)
    if here.corners is not None:
        # An end rests at a sharp corner; a pinned end needs no step.
        adjacent = np.maximum(curve.to_corners(here.table), TOLERANCES.resting_step * here.widths)
        outward = np.where(here.pinned, outward, np.minimum(outward, adjacent))
    onward, back = (outward, inward) if sign > 0 else (inward, outward)
    return onward, np.minimum(back, FLOW.max_back * here.widths)


def inward_and_outward(curve: Curve, here: State, detailed: bool = True) -> tuple[Array, Array]:
    """How far ends may move inward and outward in a step, corners apart (2n,).

    detailed: no farther than the smallest feature of the profile.
    """
    known = curve.problem.detail if detailed else np.inf
    gaps = curve.gaps(here.table)
    room = TOLERANCES.max_into_gap * np.concatenate((np.roll(gaps, 1), gaps))
    # An end may reach the border, and then raises the error that says so.
    lo, hi = curve.problem.borders
    room[0], room[-1] = (
        min(room[0], 1.1 * (here.table[0, 0] - lo)),
        min(room[-1], 1.1 * (hi - here.table[-1, 1])),
    )
    return np.minimum(TOLERANCES.max_inward * here.widths, known), np.minimum(
        np.minimum(TOLERANCES.max_outward * here.widths, room), known
    )


def closing(curve: Curve, here: State, predicted: Predictor | None = None) -> Array | None:
    """The intervals with closed gaps joined, or gaps predicted to close; None if no gap closes."""
    table = here.table
    left, right = np.split(here.residual, 2)
    widths = np.diff(table, axis=1)[:, 0]
    gap = curve.gaps(table)
    adjacent = np.minimum(widths, np.roll(widths, -1))
    closes = (
        (gap < FLOW.closed_gap * adjacent)
        & (right > FLOW.hard_drive)
        & (np.roll(left, -1) > FLOW.hard_drive)
    )
    if predicted is not None:
        closes |= predicted.closes(gap, adjacent)
    if not closes.any():
        return None
    if closes.all():
        raise Closed
    return joined(table, closes, [], curve.problem.period)


def lost_zones(here: State, widths: Array, residual: Array) -> Mask:
    """Mask of the zones past the point of no return.

    They have shrunk below a part of their width at their smallest drive, and the force that
    shrinks them grows.
    """
    driven = here.residual < np.minimum(-FLOW.hard_drive, 1.5 * residual)
    return np.logical_and(*np.split(driven & (here.widths < FLOW.lost_zone * widths), 2))


def running_away(here: State) -> Mask:
    """Mask of the ends without which no motion of the others grows (2n,).

    They belong to gaps that snap shut, or to zones that come apart.
    """
    away = np.zeros(len(here.residual), dtype=bool)
    if here.growth < -TOLERANCES.neutral:
        return away
    while not away.all():
        stays = np.flatnonzero(~away)
        growth, motions = here.motions(stays)
        grows = growth >= -TOLERANCES.neutral
        if not grows.any():
            break
        size = np.abs(motions[:, grows])
        away[stays[(size > FLOW.runaway_share * size.max(axis=0)).any(axis=1)]] = True
    return away


def bounded_step(
    here: State, sign: float, limit: Array, most_back: Array, runaway: Mask | None = None
) -> Array:
    """Bound-constrained Newton step; shifted by mu D if J is indefinite.

    runaway: ends that move as far as their limits, while the others follow by Newton's step.
    """
    rates, residual = here.rates, here.residual
    if here.growth >= -TOLERANCES.neutral and runaway is None:
        return _damped_step(here, sign, limit)
    away = np.zeros(len(residual), dtype=bool) if runaway is None else runaway
    free, released = ~away, np.zeros(len(residual), dtype=bool)
    # An end a little beyond its equilibrium goes back, so that it does not run on.
    step = sign * np.where(sign * residual > -FLOW.resting_drive, limit, -most_back)
    while True:
        step[free] = np.linalg.solve(
            -rates[np.ix_(free, free)], residual[free] + rates[np.ix_(free, ~free)] @ step[~free]
        )
        far, back = (
            free & (sign * step > limit * (1 + 1e-12)),
            free & (sign * step < -most_back * (1 + 1e-12)),
        )
        step[far], step[back] = sign * limit[far], -sign * most_back[back]
        free &= ~(far | back)
        if not (far | back).any():
            # An end need not stay at its bound if others, bounded too, no longer drive it there.
            driven = np.sign(step) * (residual + rates @ step)
            late = ~(free | away | released) & (driven < 0.0)
            if not late.any():
                return np.asarray(step)
            free, released = free | late, released | late


def _damped_step(here: State, sign: float, limit: Array) -> Array:
    """Solution of (mu D - J) ds = r; mu is above the fastest growth and as small as the limits
    allow.
    """
    # An end that has gone too far waits for the others.
    free = sign * here.residual > -FLOW.resting_drive
    weight, rates, above = here.weight[free], here.rates[np.ix_(free, free)], 1e-6
    growth = max(here.growth_of(np.flatnonzero(free)), -above)
    step = np.zeros_like(here.residual)
    while True:
        moved = np.linalg.solve(np.diag((growth + above) * weight) - rates, here.residual[free])
        if np.all(np.abs(moved) <= limit[free]) or above > 1e9:
            step[free] = np.where(sign * moved < 0, 0.0, moved)
            return step
        above *= 2.0


def overshoots(here: State, ahead: State, step: Array, sign: float) -> Mask:
    """Mask of the ends that have passed an equilibrium in a step.

    They are driven the other way at its end or, by the cubic of the drive, on the way.
    """
    first, last = here.whole, ahead.whole
    before, after = sign * first.residual, sign * last.residual
    allowed = np.minimum(
        -FLOW.overshoot * np.minimum(np.abs(before), 1.0) - FLOW.resting_drive,
        1.1 * before - FLOW.resting_drive,
    )
    # Near a stable equilibrium an end that has gone a little too far comes back.
    far = (
        (np.abs(step) > FLOW.max_back * here.widths)
        | (here.growth < 0.0 <= ahead.growth)
        | (after < -FLOW.max_drive_back)
    )
    # Where motions grow for most of the way, it would run on, or be put back forever.
    if 0.0 < -here.growth <= ahead.growth:
        allowed = np.where(before > 0.0, -FLOW.runaway_overshoot, allowed)
    # A pinned end was at rest.
    far &= ~first.pinned
    over = (after < allowed) & far
    if float(np.abs(step / here.widths).max()) < FLOW.max_back:
        return np.asarray(over)
    rise, fall = sign * (first.rates @ step), sign * (last.rates @ step)
    u = _INNER_PLACES[:, None]
    way = (
        (1 + 2 * u) * (1 - u) ** 2 * before
        + u * (1 - u) ** 2 * rise
        + u**2 * (3 - 2 * u) * after
        + u**2 * (u - 1) * fall
    )
    return np.asarray(over | (far & np.any(way < np.minimum(allowed, after), axis=0)))
