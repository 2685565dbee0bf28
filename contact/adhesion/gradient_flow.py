r"""Ends of zones that are driven outward advance, and those driven inward recede, to the nearest
equilibrium under a held control.

With r_i = K_i - K* at every end (contact.adhesion.curve), on a half-plane under a held load
the other ends only gain by one that advances, d r_j/ds_i >= 0, since what an end pulls down comes
nearer for the others. So the ends that are driven outward everywhere advance, together and without
turning back, to the least equilibrium that holds them, and those that are driven inward everywhere
recede to the greatest one within them: what a slowly changed control leads to, too (cooperative
systems: M. W. Hirsch, SIAM J. Math. Anal. 13, 1982, 167). Under a held approach, and on a layer, an
end that advances may hold back others: there the same steps are taken, and the same certificate is
asked for, but the branch is not proved to be the least. Steps that keep to that are those of

    -J ds = r,   J = dr/ds,

Newton's, over the ends that go no farther than they are let, given what the others do; where J has
growing motions, mu D - J in place of -J, D diagonal, mu above their growth.
"""

import numpy as np

from contact.adhesion.curve import NEUTRAL, Closed, Equilibria, Point
from contact.adhesion.intervals import joined
from contact.adhesion.predictor import Foretold
from contact.errors import NotConverged
from sie import Array, Mask

# A step moves an end by at most these parts of its zone's width and of the gap beside it, and by
# this part of the profile's detail.
_INWARD = 0.3
_OUTWARD = 0.5
_INTO_GAP = 0.4
_OF_DETAIL = 1.0
# On the way the states are solved to this; ends at rest: the last step over the widths.
ROUGH = 1e-9
REST = 1e-6
_SETTLED = 1e-5
# By how much of r, and of K*, a step may pass a place of rest, the second where an end would run on
# from there; from how near an equilibrium Newton's step is taken as it is.
_OVERSHOT = 0.1
_RUN_ON = 1e-3
SLIGHT = 1e-4
_NEAR = 0.02
_FAR = 0.05
# Of the way to a place of rest, by the chord.
_SHORT_OF = 0.8
# Of the largest in a growing motion, ends that run away.
_SHARE = 0.3
# A gap below this part of the zones beside it whose ends are driven by this part of K* has closed;
# likewise a zone has opened.
CLOSED = 1e-2
DRIVEN = 0.5
_OPENED = 0.02
# Zones from which on it is foretold what ends are driven by that are driven by so much, and how
# often a step by that is shortened.
_MANY = 12
_HARD = 0.1
_FORETOLD_TRIES = 4
MOST_STEPS = 3000
MOST_TRIES = 40
_PLACES = np.linspace(0.05, 0.95, 10)


def advanced(curve: Equilibria, table: Array, value: float, rest: float = REST) -> Point:
    """The least equilibrium that holds these zones, of which all ends are driven outward; `Closed`
    if there is none. rest: Newton's step over the widths at which stable ends are at rest.
    """
    found = _flowed(curve, table, value, 1.0, rest)
    assert found is not None
    return found


def receded(curve: Equilibria, table: Array, value: float) -> Point | None:
    """The greatest equilibrium within these zones, of which all ends are driven inward; None: all
    have come apart.
    """
    return _flowed(curve, table, value, -1.0)


def _flowed(
    curve: Equilibria, table: Array, value: float, sign: float, rest: float = REST
) -> Point | None:
    here = curve.at(table, value, ROUGH)
    widths, residual = here.widths, here.residual
    for _ in range(MOST_STEPS):
        told = _foretold(curve, here, sign)
        if sign > 0 and (merged := closing(curve, here, told)) is not None:
            here = curve.at(merged, value, ROUGH)
            continue
        if sign < 0 and (apart := come_apart(here, widths, residual)).any():
            if apart.all():
                return None
            stays = np.tile(~apart, 2)
            here, widths, residual = (
                curve.at(here.table[~apart], value, ROUGH),
                widths[stays],
                residual[stays],
            )
            continue
        ahead = None if told is None else _step_as_told(curve, here, sign, told)
        here, move = (ahead, np.inf) if ahead is not None else _step(curve, here, sign)
        if at_rest(here, move, rest):
            return here
        if move == 0.0:
            break
        if sign < 0:
            # A zone that others relieve on the way narrows anew from there.
            relieved = here.residual > residual
            widths, residual = (
                np.where(relieved, here.widths, widths),
                np.maximum(here.residual, residual),
            )
    raise NotConverged(
        "the ends of zones that grow or shrink under a held control did not come to rest"
    )


def at_rest(here: Point, move: float, rest: float = REST) -> bool:
    """Whether ends are at rest after a step of this largest move over the widths: Newton's next one
    is none either, as one may be short since another end has come to its corner. rest: that step
    over the widths.
    """
    driven = float(np.abs(here.residual).max())
    if here.growth < 0.0 and driven <= DRIVEN:
        newton = float(np.abs(here.newton / here.widths).max())
        return newton <= rest or (move <= REST and newton <= _SETTLED)
    return move <= REST and driven <= SLIGHT


def _foretold(curve: Equilibria, here: Point, sign: float) -> Foretold | None:
    """What ends are driven by as they move on; None where Newton's step is the better one, or zones
    are few.
    """
    if (
        len(here.table) < _MANY
        or here.corners is not None
        or float((sign * here.residual).max()) < _HARD
    ):
        return None
    return Foretold.of(curve, here, curve.fields(here, ROUGH), sign)


def _step_as_told(curve: Equilibria, here: Point, sign: float, told: Foretold) -> Point | None:
    """Next state where it was told well enough."""
    inward, outward = inward_and_outward(curve, here, detailed=False)
    limit = outward if sign > 0 else inward
    for _ in range(_FORETOLD_TRIES):
        step = told.step(limit)
        ahead = curve.at(here.moved(sign * step), here.value, ROUGH)
        astray = told.astray(step, sign * ahead.residual)
        if not astray.any():
            return ahead
        limit = np.where(astray, 0.5 * step, limit)
    return None


def _step(curve: Equilibria, here: Point, sign: float) -> tuple[Point, float]:
    """(next state, largest move over the widths)."""
    limit, back = limits(curve, here, sign)
    runaway: Mask | None = running_away(here)
    if np.any(runaway) and float(np.abs(here.residual).max()) <= SLIGHT:
        # Next to a turning point they leave by the motion that grows, not each as far as it may.
        runaway = None
    for _ in range(MOST_TRIES):
        step = kept_step(here, sign, limit, back, runaway)
        # Of ends that are driven hard, little must be left out to know how those at rest are.
        ahead = curve.at(
            here.moved(step),
            here.value,
            max(1e-14, ROUGH / max(1.0, float(np.abs(here.residual).max()))),
        )
        gone_past = passed(here, ahead, step, sign)
        if not gone_past.any():
            return ahead, float(np.abs(step / here.widths).max())
        # What has passed an equilibrium goes to where it is about; if that is of no avail, all
        # others move less, too.
        before, after = here.whole.residual, ahead.whole.residual
        part = np.divide(
            _SHORT_OF * before, before - after, out=np.full(len(before), 0.5), where=before != after
        )
        shorter = np.where(gone_past, np.clip(np.where(part > 0.0, part, 0.5), 0.01, 0.5), 0.9)
        limit = shorter * np.minimum(limit, np.maximum(np.abs(step), 1e-12 * here.widths))
    raise NotConverged("no step of the ends keeps to the branch")


def limits(curve: Equilibria, here: Point, sign: float) -> tuple[Array, Array]:
    """How far ends may move onward, and back, in a step (2n,)."""
    inward, outward = inward_and_outward(curve, here)
    if here.corners is not None:
        # At a sharp corner it rests; one that is held there asks for no step.
        beside = np.maximum(curve.to_corners(here.table), REST * here.widths)
        outward = np.where(here.held, outward, np.minimum(outward, beside))
    onward, back = (outward, inward) if sign > 0 else (inward, outward)
    return onward, np.minimum(back, _NEAR * here.widths)


def inward_and_outward(
    curve: Equilibria, here: Point, detailed: bool = True
) -> tuple[Array, Array]:
    """How far ends may move in a step whatever they are driven by, sharp corners left aside (2n,).
    detailed: no farther than the detail of the profile is.
    """
    known = _OF_DETAIL * curve.problem.detail if detailed else np.inf
    gaps = curve.gaps(here.table)
    room = _INTO_GAP * np.concatenate((np.roll(gaps, 1), gaps))
    # An end may reach the border, and is told of it then.
    lo, hi = curve.problem.borders
    room[0], room[-1] = (
        min(room[0], 1.1 * (here.table[0, 0] - lo)),
        min(room[-1], 1.1 * (hi - here.table[-1, 1])),
    )
    return np.minimum(_INWARD * here.widths, known), np.minimum(
        np.minimum(_OUTWARD * here.widths, room), known
    )


def closing(curve: Equilibria, here: Point, told: Foretold | None = None) -> Array | None:
    """The zones without gaps that have closed, or of which it is foretold; None if there is none."""
    table = here.table
    left, right = np.split(here.residual, 2)
    widths = np.diff(table, axis=1)[:, 0]
    gap = curve.gaps(table)
    beside = np.minimum(widths, np.roll(widths, -1))
    closes = (gap < CLOSED * beside) & (right > DRIVEN) & (np.roll(left, -1) > DRIVEN)
    if told is not None:
        closes |= told.closes(gap, beside)
    if not closes.any():
        return None
    if closes.all():
        raise Closed
    return joined(table, closes, [], curve.problem.period)


def come_apart(here: Point, widths: Array, residual: Array) -> Mask:
    """Which zones have come apart that were so wide when they were driven least: the narrower they
    are the more they are driven.
    """
    driven = here.residual < np.minimum(-DRIVEN, 1.5 * residual)
    return np.logical_and(*np.split(driven & (here.widths < _OPENED * widths), 2))


def running_away(here: Point) -> Mask:
    """The ends without which no motion of the others grows (2n,): those of gaps that snap shut, of
    zones that come apart.
    """
    away = np.zeros(len(here.residual), dtype=bool)
    if here.growth < -NEUTRAL:
        return away
    while not away.all():
        stays = np.flatnonzero(~away)
        growth, motions = here.motions(stays)
        grows = growth >= -NEUTRAL
        if not grows.any():
            break
        size = np.abs(motions[:, grows])
        away[stays[(size > _SHARE * size.max(axis=0)).any(axis=1)]] = True
    return away


def kept_step(
    here: Point, sign: float, limit: Array, most_back: Array, runaway: Mask | None = None
) -> Array:
    """Newton's step, in which ends go no farther than their limits, nor back but a little; where
    there are motions that run away, damped by as much as keeps these within the limits, or, told
    which, with these ends going as far as they may.
    """
    rates, residual = here.rates, here.residual
    if here.growth >= -NEUTRAL and runaway is None:
        return _damped_step(here, sign, limit)
    away = np.zeros(len(residual), dtype=bool) if runaway is None else runaway
    free, released = ~away, np.zeros(len(residual), dtype=bool)
    # One that has gone a little beyond its rest, to where it would run on, goes back.
    step = sign * np.where(sign * residual > -SLIGHT, limit, -most_back)
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
            # One that others were to drive so far, before they were kept from it, need not go
            # there.
            driven = np.sign(step) * (residual + rates @ step)
            late = ~(free | away | released) & (driven < 0.0)
            if not late.any():
                return np.asarray(step)
            free, released = free | late, released | late


def _damped_step(here: Point, sign: float, limit: Array) -> Array:
    """(mu D - J) ds = r, mu above the fastest growth and as near to it as the limits let it."""
    # An end that has gone too far waits for what the others do.
    free = sign * here.residual > -SLIGHT
    weight, rates, above = here.weight[free], here.rates[np.ix_(free, free)], 1e-6
    growth = max(here.growth_of(np.flatnonzero(free)), -above)
    step = np.zeros_like(here.residual)
    while True:
        moved = np.linalg.solve(np.diag((growth + above) * weight) - rates, here.residual[free])
        if np.all(np.abs(moved) <= limit[free]) or above > 1e9:
            step[free] = np.where(sign * moved < 0, 0.0, moved)
            return step
        above *= 2.0


def passed(here: Point, ahead: Point, step: Array, sign: float) -> Mask:
    """Which ends have passed a place of rest in a step: they are driven the other way at its end
    or, by a cubic, on the way.
    """
    first, last = here.whole, ahead.whole
    before, after = sign * first.residual, sign * last.residual
    allowed = np.minimum(
        -_OVERSHOT * np.minimum(np.abs(before), 1.0) - SLIGHT, 1.1 * before - SLIGHT
    )
    # Beside a stable equilibrium an end that has gone a little too far comes back.
    far = (
        (np.abs(step) > _NEAR * here.widths) | (here.growth < 0.0 <= ahead.growth) | (after < -_FAR)
    )
    # Where motions grow for most of the way it would run on, or be put back for ever.
    if 0.0 < -here.growth <= ahead.growth:
        allowed = np.where(before > 0.0, -_RUN_ON, allowed)
    # One that was held was at rest.
    far &= ~first.held
    over = (after < allowed) & far
    if float(np.abs(step / here.widths).max()) < _NEAR:
        return np.asarray(over)
    rise, fall = sign * (first.rates @ step), sign * (last.rates @ step)
    u = _PLACES[:, None]
    way = (
        (1 + 2 * u) * (1 - u) ** 2 * before
        + u * (1 - u) ** 2 * rise
        + u**2 * (3 - 2 * u) * after
        + u**2 * (u - 1) * fall
    )
    return np.asarray(over | (far & np.any(way < np.minimum(allowed, after), axis=0)))
