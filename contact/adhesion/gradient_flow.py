"""The gradient flow of the ends of zones to the nearest equilibrium under a fixed control.

Ends that are driven outward advance, ends that are driven inward recede.

Under a fixed load on a half-plane, an end i that advances only raises the residuals of the others,
dr_j/ds_i >= 0: the surfaces come closer there. Ends that are all driven outward then advance
together, without turning back, to the least equilibrium that contains them. Ends that are all
driven inward recede to the greatest equilibrium inside. A slowly changed control leads to the same
equilibria (cooperative systems: M. W. Hirsch, SIAM J. Math. Anal. 13, 1982, 167).

Under a fixed approach, and on a layer, an end that advances may lower the residuals of others. The
steps and the certificate are the same, but the equilibrium is not proved to be the least.

The steps are Newton's,

    -J ds = r,   J = dr/ds,

with r the residuals and s the outward displacements of the ends; the step of each end is bounded by
its limits. If J has positive eigenvalues, mu D - J replaces -J: D is a diagonal damping and mu
exceeds the largest growth rate. The steps are the same for both kinds of law. The flow of a
cohesive zone (contact.adhesion.cohesive_flow) differs in how its intervals change.
"""

import math

import numpy as np

from contact.adhesion.curve import ACCURACY, Closed, Curve, State
from contact.adhesion.inner_contact import ContactLost, EndsCovered
from contact.adhesion.intervals import joined
from contact.adhesion.options import LIMITS, MOVES, SAMPLES
from contact.adhesion.predictor import Predictor
from contact.errors import NotConverged
from sie import Array, Mask


def advanced(
    curve: Curve, table: Array, value: float, rest: float = ACCURACY.resting_step
) -> State:
    """The equilibrium with the smallest intervals that contain the intervals `table`.

    All ends of the intervals `table` must tend to advance: their residuals are positive. Raises
    `Closed` if there is no such equilibrium. rest: largest Newton step, relative to the widths, of
    ends at rest.
    """
    found = _flow(curve, table, value, 1.0, rest)
    assert found is not None
    return found


def receded(curve: Curve, table: Array, value: float) -> State | None:
    """The equilibrium with the largest intervals inside the intervals `table`.

    All ends of the intervals `table` must tend to recede: their residuals are negative. None if all
    zones are lost.
    """
    return _flow(curve, table, value, -1.0)


def _flow(
    curve: Curve, table: Array, value: float, sign: float, rest: float = ACCURACY.resting_step
) -> State | None:
    here = curve.at(table, value, ACCURACY.rough)
    widths, residual = here.widths, here.residual
    for _ in range(LIMITS.max_steps):
        predicted = _predictor(curve, here, sign)
        if sign > 0 and (merged := closing(curve, here, predicted)) is not None:
            here = curve.at(merged, value, ACCURACY.rough)
            continue
        # For each end, `widths` and `residual` belong to the state at which this end tended least
        # to recede. `lost_zones` compares the present state with these values.
        widths = np.where(here.residual > residual, here.widths, widths) if sign < 0 else widths
        residual = np.maximum(here.residual, residual) if sign < 0 else residual
        if sign < 0 and (apart := lost_zones(here, widths, residual)).any():
            if apart.all():
                return None
            stays = np.tile(~apart, 2)
            here, widths, residual = (
                curve.at(here.table[~apart], value, ACCURACY.rough),
                widths[stays],
                residual[stays],
            )
            continue
        ahead = None if predicted is None else _predicted_step(curve, here, sign, predicted)
        here, move = (ahead, np.inf) if ahead is not None else moved_on(curve, here, sign)
        if at_rest(here, move, rest):
            return here
        if move == 0.0:
            break
    raise NotConverged(
        "the ends of the growing or shrinking zones did not converge at a fixed value of the "
        "control"
    )


def at_rest(here: State, move: float, rest: float = ACCURACY.resting_step) -> bool:
    """Whether all ends of intervals have converged to an equilibrium after a step.

    move: largest displacement of an end in this step, relative to the widths. rest: largest Newton
    step of ends at rest. The step may be short only because an end has reached its sharp corner.
    Then the next Newton step is longer.
    """
    driven = float(np.abs(here.residual).max())
    if here.growth < 0.0 and driven <= MOVES.hard_drive:
        newton = float(np.abs(here.newton / here.widths).max())
        return newton <= rest or (
            move <= ACCURACY.resting_step and newton <= 10 * ACCURACY.resting_step
        )
    return move <= ACCURACY.resting_step and driven <= ACCURACY.coarse


def _predictor(curve: Curve, here: State, sign: float) -> Predictor | None:
    """A predictor of the residuals of all ends during the next step; None if it is no use.
    It is None for few zones, sharp corners or small residuals, where Newton's step is better.
    """
    if (
        len(here.table) < MOVES.few_zones
        or here.corners is not None
        or float((sign * here.residual).max()) < MOVES.small_part
    ):
        return None
    return Predictor.of(curve, here, curve.fields(here, ACCURACY.rough), sign)


def _predicted_step(curve: Curve, here: State, sign: float, predicted: Predictor) -> State | None:
    """The state after a predicted step; None if the prediction was wrong."""
    inward, outward = inward_and_outward(curve, here, detailed=False)
    limit = outward if sign > 0 else inward
    for _ in range(LIMITS.patience):
        step = predicted.step(limit)
        ahead = curve.at(here.moved(sign * step), here.value, ACCURACY.rough)
        astray = predicted.astray(step, sign * ahead.residual)
        if not astray.any():
            return ahead
        limit = np.where(astray, 0.5 * step, limit)
    return None


def moved_on(curve: Curve, here: State, sign: float) -> tuple[State, float]:
    """(next state of the flow, largest relative displacement of an end in this step).
    The displacement is divided by the width of the end's zone or of the gap next to the end,
    whichever is smaller.
    """
    onward = sign * here.residual
    if onward.min() < -MOVES.small_drive or (
        here.growth >= 0.0 and onward.max() <= ACCURACY.coarse < -onward.min()
    ):
        return _let_go(curve, here, sign)
    limit, back = limits(curve, here, sign)
    accuracy = ACCURACY.rough / max(1.0, float(np.abs(here.residual).max()))
    lost, beyond = 0, np.zeros(len(limit))
    size = curve.room(here.table)
    back_again = 0
    for _ in range(LIMITS.max_iterations):
        if back_again >= LIMITS.patience and here.growth >= 0.0:
            return _let_go(curve, here, sign)
        step = bounded_step(here, sign, limit, back) + beyond
        try:
            # The accuracy of a state is relative to the largest residual. Ends at rest need an
            # absolute accuracy, so the tolerance is smaller if residuals are large.
            ahead = curve.at(here.moved(step), here.value, max(ACCURACY.density, accuracy))
        except (ContactLost, NotConverged):
            lost += 1
            if lost > LIMITS.patience:
                raise
            limit = _shorter(here, limit, step, MOVES.least_part)
            continue
        except EndsCovered as covered:
            # Contact covers some ends of the intervals of tension. In an inward flow, all steps are
            # shortened, those of covered ends most. In an outward flow, covered ends are moved
            # farther out.
            if sign < 0:
                limit = _shorter(here, limit, step, np.where(covered.ends, 0.5, 0.9))
            else:
                beyond = np.where(covered.ends, 2 * beyond + MOVES.short_move * here.widths, beyond)
            continue
        passed = overshoots(here, ahead, step, sign)
        if not passed.any():
            # If an attempt has failed before, the motion is returned as inf, because the motion of
            # the shortened step would count as convergence.
            return ahead, float(np.abs(step / size).max()) if lost == 0 else np.inf
        # From the second overshoot on, ends that went too far take at most half of their step, so
        # that few attempts follow.
        most = 0.9 if back_again == 0 else 0.5
        limit = _shorter(here, limit, step, np.where(passed, _chord(here, ahead, most), 0.9))
        back_again += 1
    raise NotConverged("no step of the ends was found that stays on the branch")


def _shorter(here: State, limit: Array, step: Array, by: Array | float) -> Array:
    """New limits (2n,) of the steps of the ends, after `step` under the old `limit` has failed.

    by: factor of the failed step, for all ends or for each one. If the state is unstable, one
    factor shortens the limits of all ends in proportion.
    """
    if here.growth >= 0.0:
        return np.asarray(float(np.min(by)) * limit * float((np.abs(step) / limit).max()))
    return np.asarray(by * np.minimum(limit, np.maximum(np.abs(step), 1e-12 * here.widths)))


def _chord(here: State, ahead: State, most: float) -> Array:
    """Fraction (2n,) of a step at which each residual vanishes by linear interpolation.

    It is between `MOVES.least_part` and `most`.
    """
    before, after = here.whole.residual, ahead.whole.residual
    part = np.full(len(before), 0.5)
    np.divide(before, before - after, out=part, where=before * after < 0.0)
    return np.clip(part, MOVES.least_part, most)


def _let_go(curve: Curve, here: State, sign: float) -> tuple[State, float]:
    """(state after an implicit Euler step within the limits, inf).
    The number inf stands for the size of the step, because this step must not count as convergence.

    This step is taken where some ends are driven back while others advance, as under a fixed
    approach.
    """
    inward, outward = inward_and_outward(curve, here)
    onward, back = (outward, inward) if sign > 0 else (inward, outward)
    size = curve.room(here.table)
    onward, above = np.minimum(onward, 0.5 * np.maximum(size, 1e-3 * here.widths)), 1e-3
    for _ in range(LIMITS.max_iterations):
        step = here.damped_step(above)
        if np.all(np.abs(step) <= np.where(sign * step > 0.0, onward, back)):
            try:
                return curve.at(here.moved(step), here.value, ACCURACY.rough), np.inf
            except EndsCovered:
                pass
        above *= 2.0
    raise NotConverged("no step of the ends was found that stays on the branch")


def limits(curve: Curve, here: State, sign: float) -> tuple[Array, Array]:
    """(longest allowed steps of the ends in the direction of the flow, and against it)."""
    inward, outward = inward_and_outward(curve, here)
    if here.corners is not None:
        # An end moves at most to its sharp corner. The corner does not limit the step of a pinned
        # end.
        adjacent = np.maximum(curve.to_corners(here.table), ACCURACY.resting_step * here.widths)
        outward = np.where(here.pinned, outward, np.minimum(outward, adjacent))
    onward, back = (outward, inward) if sign > 0 else (inward, outward)
    return onward, np.minimum(back, MOVES.short_move * here.widths)


def inward_and_outward(curve: Curve, here: State, detailed: bool = True) -> tuple[Array, Array]:
    """(longest allowed inward steps of the ends, outward ones), regardless of sharp corners.

    detailed: whether the steps are also limited to the smallest feature of the profile.
    """
    known = curve.problem.detail if detailed else np.inf
    gaps = curve.gaps(here.table)
    room = MOVES.max_move * np.concatenate((np.roll(gaps, 1), gaps))
    # An end may step past the border of the known profile. `Curve.at` then raises OutOfRange.
    lo, hi = curve.problem.borders
    room[0], room[-1] = (
        min(room[0], 1.1 * (here.table[0, 0] - lo)),
        min(room[-1], 1.1 * (hi - here.table[-1, 1])),
    )
    return np.minimum(MOVES.max_move * here.widths, known), np.minimum(
        np.minimum(here.widths, room), known
    )


def closing(curve: Curve, here: State, predicted: Predictor | None = None) -> Array | None:
    """The intervals, joined where a gap has closed or will close; None if no gap closes."""
    table = here.table
    left, right = np.split(here.residual, 2)
    widths = np.diff(table, axis=1)[:, 0]
    gap = curve.gaps(table)
    adjacent = np.minimum(widths, np.roll(widths, -1))
    closes = (
        (gap < MOVES.vanished * adjacent)
        & (right > MOVES.hard_drive)
        & (np.roll(left, -1) > MOVES.hard_drive)
    )
    if predicted is not None:
        closes |= predicted.closes(gap, adjacent)
    if not closes.any():
        return None
    if closes.all():
        raise Closed
    return joined(table, closes, [], curve.problem.period)


def lost_zones(here: State, widths: Array, residual: Array) -> Mask:
    """Mask of zones that will vanish: the narrower they get, the more their ends recede.

    Such a zone is much narrower than at the state where its ends were driven inward least.
    widths, residual: width of the zone and residual of each end (2n,) at that state.
    """
    driven = here.residual < np.minimum(-MOVES.hard_drive, 1.5 * residual)
    return np.logical_and(*np.split(driven & (here.widths < MOVES.vanished * widths), 2))


def bounded_step(here: State, sign: float, limit: Array, most_back: Array) -> Array:
    """Newton step of the ends within bounds; damped if the state is not stable."""
    rates, residual = here.rates, here.residual
    if here.growth >= -ACCURACY.neutral:
        return _damped_step(here, sign, limit)
    step = np.zeros(len(residual))
    free, released = step == 0.0, step != 0.0
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
            # An end at its bound may tend to move back after other ends were put at their bounds.
            # The end is then released, but only once.
            driven = np.sign(step) * (residual + rates @ step)
            late = ~(free | released) & (driven < 0.0)
            if not late.any():
                return step
            free, released = free | late, released | late


def _damped_step(here: State, sign: float, limit: Array) -> Array:
    """The damped Newton step ds of the ends, whose residual r has the Jacobian J = dr/ds.

    It solves (mu D - J) ds = r with the diagonal matrix D of the weights. mu exceeds the largest
    growth rate and is as small as the limits allow.
    """
    # An end whose residual has the sign opposite to `sign` does not move in this step.
    free = sign * here.residual > -ACCURACY.coarse
    weight, rates, least = here.weight[free], here.rates[np.ix_(free, free)], 1e-6
    growth = max(here.growth_of(np.flatnonzero(free)), -least)

    def moved(above: float) -> Array:
        damping = np.diag((growth + above) * weight)
        return np.asarray(np.linalg.solve(damping - rates, here.residual[free]))

    def is_allowed(moves: Array) -> bool:
        return bool(np.all(np.abs(moves) <= limit[free]))

    # mu is growth + above. The number `above` is bracketed, then the bracket's ratio is reduced to
    # 1.1: with more damping the steps are shorter, and more of them are needed.
    above, factor = least, 16.0
    moves = moved(above)
    while not is_allowed(moves) and above <= 1e9:
        above *= factor
        moves = moved(above)
    low = above / factor
    while low >= least and above > 1.1 * low:
        middle = math.sqrt(low * above)
        trial = moved(middle)
        if is_allowed(trial):
            above, moves = middle, trial
        else:
            low = middle
    step = np.zeros_like(here.residual)
    step[free] = np.where(sign * moves < 0, 0.0, moves)
    return step


def overshoots(here: State, ahead: State, step: Array, sign: float) -> Mask:
    """Mask of the ends that have passed an equilibrium in a step.

    The residual of such an end changes its sign: at the end of the step, or inside the step by
    cubic interpolation.
    """
    first, last = here.whole, ahead.whole
    before, after = sign * first.residual, sign * last.residual
    allowed = np.minimum(
        -MOVES.small_part * np.minimum(np.abs(before), 1.0) - ACCURACY.coarse,
        1.1 * before - ACCURACY.coarse,
    )
    # Short steps are exempt from the test: near a stable equilibrium a small overshoot corrects
    # itself.
    far = (
        (np.abs(step) > MOVES.short_move * here.widths)
        | (here.growth < 0.0 <= ahead.growth)
        | (after < -MOVES.small_drive)
    )
    # An end that has passed an equilibrium in the step does not come back if the state `ahead`,
    # after the step, is unstable. So no overshoot is allowed if the growth rate of `ahead` is at
    # least the decay rate of `here`.
    if 0.0 < -here.growth <= ahead.growth:
        allowed = np.where(before > 0.0, -ACCURACY.coarse, allowed)
    # Ends that were pinned before the step are left out: they have passed no equilibrium.
    far &= ~first.pinned
    over = (after < allowed) & far
    if float(np.abs(step / here.widths).max()) < MOVES.short_move:
        return np.asarray(over)
    rise, fall = sign * (first.rates @ step), sign * (last.rates @ step)
    u = np.linspace(0.0, 1.0, SAMPLES.samples)[1:-1, None]
    way = (
        (1 + 2 * u) * (1 - u) ** 2 * before
        + u * (1 - u) ** 2 * rise
        + u**2 * (3 - 2 * u) * after
        + u**2 * (u - 1) * fall
    )
    return np.asarray(over | (far & np.any(way < np.minimum(allowed, after), axis=0)))
