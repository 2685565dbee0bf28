r"""Curves of equilibria under a law of prescribed intensities, and the ways along them: by a growing or shrinking contact, and by turning
points.

With r_i = K_i - K* at every end, K* < 0 of the law, an end is driven outward while r_i > 0: by ds the energy changes by
(pi/E*)(K_i^2 - K*^2) ds. Under a held load or approach the other ends only gain by it, d r_j/ds_i >= 0, since what an end pulls down
comes nearer for the others. So the ends that are driven outward everywhere advance, together and without turning back, to the least
equilibrium that holds them, and those that are driven inward everywhere recede to the greatest one within them: what a slowly changed
control leads to, too (cooperative systems: M. W. Hirsch, SIAM J. Math. Anal. 13, 1982, 167). Steps that keep to that are those of

    -J ds = r,   J = dr/ds,

Newton's, over the ends that go no farther than they are let, given what the others do; where J has growing motions, mu D - J in place
of -J, D diagonal, mu above their growth. Where an equilibrium ceases to be
as the control falls, J has a zero eigenvalue: along the arc of the curve the control has an extreme there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

import sie
from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Approach, Control, Load
from contact.formulation.problem import Problem

Array = NDArray[np.float64]

# A step moves an end by at most these parts of its zone's width and of the gap beside it, and by this part of the profile's resolution.
_INWARD, _OUTWARD, _INTO_GAP, _OF_RESOLUTION = 0.3, 0.5, 0.4, 1.0
# On the way the states are solved to this; ends at rest: the last step over the widths.
_ROUGH, _REST = 1e-9, 1e-6
# By how much of r, and of K*, a step may pass a place of rest; from how near an equilibrium Newton's step is taken as it is.
_OVERSHOT, _SLIGHT, _NEAR, _FAR = 0.1, 1e-4, 0.02, 0.05
# A gap below this part of the zones beside it whose ends are driven by this part of K* has closed; likewise a zone has opened.
_CLOSED, _DRIVEN, _OPENED = 1e-2, 0.5, 0.02
_MOST_STEPS, _MOST_TRIES = 600, 40
# Along the arc: first and longest step in widths, Newton's steps in one, and how many.
_FIRST, _LONGEST, _CORRECTIONS, _MOST_ARCS = 0.02, 0.3, 8, 600
# Past a turning point ends are pushed on by this part of their zones.
_PUSH = 0.03
# Of the control, before the last turning point is looked for.
_HALVINGS = 5
_PLACES = np.linspace(0.05, 0.95, 10)


@dataclass(frozen=True, eq=False)
class Point:
    """Zones (n, 2) under a value of the control. residual: r over |K*| of the left and then the right ends (2n,); rates: dr/ds (2n, 2n);
    by_value: dr/d(value); load and level: scaled."""

    table: Array
    value: float
    residual: Array
    rates: Array
    by_value: Array
    load: float
    level: float

    @property
    def contact(self) -> Array:
        """The zones of contact."""
        return self.table

    @property
    def widths(self) -> Array:
        """Of the zone of each end (2n,)."""
        return np.tile(np.diff(self.table, axis=1)[:, 0], 2)

    @property
    def weight(self) -> Array:
        """What drives ends over their motion: in these, growing motions of wide and of narrow zones are compared."""
        return np.maximum(np.abs(np.diag(self.rates)), 1.0 / self.widths)

    @cached_property
    def growth(self) -> float:
        """Largest eigenvalue of J over D: negative where an equilibrium is stable."""
        return float(np.linalg.eigvals(self.rates / self.weight[:, None]).real.max())

    def moved(self, outward: Array) -> Array:
        """The zones with ends moved."""
        left, right = np.split(outward, 2)
        return self.table + np.column_stack((-left, right))


class Closed(Exception):
    """All gaps of a period have closed."""


@dataclass(frozen=True)
class Equilibria:
    """Those of a problem under one kind of control, by load or by approach."""

    problem: Problem
    kind: type[Control]

    def at(self, table: Array, value: float, tolerance: float = 1e-13) -> Point:
        """The state of given zones: one linear solution and its rates."""
        problem, control = self.problem, self.kind(value)
        lo, hi = problem.borders
        if table[0, 0] <= lo or table[-1, 1] >= hi:
            raise OutOfRange("a contact zone reaches the border of the part of the profile that is known")
        zones = sie.Zones.of(table, problem.end, problem.end)
        state = sie.solve_zones(problem.equation(control), zones, tolerance).whole
        rates, wanted = sie.end_rates(state), problem.end.intensity
        assert wanted is not None
        size = abs(wanted)
        values = np.zeros(len(state.condition_scale))
        first = state.condition_index[0]
        # The load is the total, the approach minus the level of every zone.
        values[first : first + (1 if self.kind is Load else len(table))] = 1.0 if self.kind is Load else -1.0
        unit = np.concatenate(state.response(values).intensities)
        residual = (np.concatenate(state.density.intensities) - wanted) / size
        level = float(state.levels.mean()) if self.kind is Load else -value
        return Point(table, value, residual, rates.intensities / size, unit / size, state.density.total, level)

    # growing and shrinking ------------------------------------------------------------------------------------------
    def advanced(self, table: Array, value: float) -> Point:
        """The least equilibrium that holds these zones, of which all ends are driven outward; `Closed` if there is none."""
        found = self._flowed(table, value, 1.0)
        assert found is not None
        return found

    def receded(self, table: Array, value: float) -> Point | None:
        """The greatest equilibrium within these zones, of which all ends are driven inward; None: all have come apart."""
        return self._flowed(table, value, -1.0)

    def _flowed(self, table: Array, value: float, sign: float) -> Point | None:
        here = self.at(table, value)
        widths, residual = here.widths, here.residual
        for _ in range(_MOST_STEPS):
            if sign > 0 and (merged := self._merged(here)) is not None:
                here = self.at(merged, value)
                continue
            if sign < 0 and (apart := _come_apart(here, widths, residual)).any():
                if apart.all():
                    return None
                stays = np.tile(~apart, 2)
                here, widths, residual = self.at(here.table[~apart], value), widths[stays], residual[stays]
                continue
            here, move = self._step(here, sign)
            if move <= _REST and np.abs(here.residual).max() <= _DRIVEN:
                return here
        raise NotConverged("the ends of zones that grow or shrink under a held control did not come to rest")

    def _step(self, here: Point, sign: float) -> tuple[Point, float]:
        """(next state, largest move over the widths)."""
        limit, back = self._limits(here, sign)
        for _ in range(_MOST_TRIES):
            step = _kept_step(here, sign, limit, back)
            # Of ends that are driven hard, little must be left out to know how those at rest are.
            ahead = self.at(here.moved(step), here.value, max(1e-14, _ROUGH / max(1.0, float(np.abs(here.residual).max()))))
            passed = _passed(here, ahead, step, sign)
            if not passed.any():
                return ahead, float(np.abs(step / here.widths).max())
            # What has passed an equilibrium moves less; if that is of no avail, so do all.
            limit = np.where(passed | (here.growth >= 0.0), 0.5, 0.9) * np.minimum(limit, np.maximum(np.abs(step), 1e-12 * here.widths))
        raise NotConverged("no step of the ends keeps to the branch")

    def _limits(self, here: Point, sign: float) -> tuple[Array, Array]:
        """How far ends may move onward, and back, in a step (2n,)."""
        resolution = self.problem.profile.resolution
        known = np.inf if resolution is None else _OF_RESOLUTION * resolution / self.problem.units.length
        gaps = self._gaps(here.table)
        room = _INTO_GAP * np.concatenate((np.roll(gaps, 1), gaps))
        # An end may reach the border, and is told of it then.
        lo, hi = self.problem.borders
        room[0], room[-1] = min(room[0], 1.1 * (here.table[0, 0] - lo)), min(room[-1], 1.1 * (hi - here.table[-1, 1]))
        inward, outward = np.minimum(_INWARD * here.widths, known), np.minimum(np.minimum(_OUTWARD * here.widths, room), known)
        onward, back = (outward, inward) if sign > 0 else (inward, outward)
        return onward, np.minimum(back, _NEAR * here.widths)

    def _gaps(self, table: Array) -> Array:
        """Right of each zone; infinite beyond the last without a period."""
        period = self.problem.period
        return np.append(table[1:, 0] - table[:-1, 1], np.inf if period is None else table[0, 0] + period - table[-1, 1])

    def _merged(self, here: Point) -> Array | None:
        """The zones without gaps that have closed; None if there is none."""
        table, period = here.table, self.problem.period
        left, right = np.split(here.residual, 2)
        widths = np.diff(table, axis=1)[:, 0]
        gap = self._gaps(table)
        beside = np.minimum(widths, np.roll(widths, -1))
        closes = (gap < _CLOSED * beside) & (right > _DRIVEN) & (np.roll(left, -1) > _DRIVEN)
        if not closes.any():
            return None
        if closes.all():
            raise Closed
        if closes[-1]:
            # The zones are counted on from one that begins at an open gap.
            assert period is not None
            start = int(np.flatnonzero(~closes)[0]) + 1
            table = np.concatenate((table[start:], table[:start] + period))
            closes = np.roll(closes, -start)
        begins = np.concatenate(([True], ~closes[:-1]))
        return np.column_stack((table[begins, 0], table[~closes, 1]))

    # along the arc --------------------------------------------------------------------------------------------------
    def turning_point(self, here: Point) -> Point:
        """Where the equilibrium ceases to be as the control falls."""
        unit = 1.0 / float(np.abs(here.by_value).max())
        tangent = _tangent(here, unit, None)
        length = _FIRST
        for _ in range(_MOST_ARCS):
            ahead = self._along(here, tangent, length, unit)
            if ahead is None:
                length *= 0.3
                if length < 1e-9:
                    break
                continue
            onward = _tangent(ahead, unit, tangent / np.append(ahead.widths / here.widths, 1.0))
            if onward[-1] >= 0.0:
                return self._turned(here, tangent, length, unit)
            here, tangent, length = ahead, onward, min(1.6 * length, _LONGEST)
        raise NotConverged("no turning point was found as the control falls")

    def _turned(self, here: Point, tangent: Array, length: float, unit: float) -> Point:
        """The turning point within a step along the arc, by the rate of the control: regula falsi (Illinois)."""
        def rate(at: Point | None) -> float:
            assert at is not None
            return float(_tangent(at, unit, tangent / np.append(at.widths / here.widths, 1.0))[-1])

        low, high = 0.0, length
        at_low, ahead = float(tangent[-1]), self._along(here, tangent, length, unit)
        at_high, best = rate(ahead), ahead
        for _ in range(40):
            middle = (low * at_high - high * at_low) / (at_high - at_low)
            best = self._along(here, tangent, middle, unit)
            if best is None:
                raise NotConverged("a turning point was not found")
            here_rate = rate(best)
            if abs(here_rate) < 1e-12 or high - low < 1e-13:
                break
            if here_rate < 0.0:
                low, at_low, at_high = middle, here_rate, 0.5 * at_high
            else:
                high, at_high, at_low = middle, here_rate, 0.5 * at_low
        assert best is not None
        return best

    def _along(self, here: Point, tangent: Array, length: float, unit: float) -> Point | None:
        """The equilibrium at a distance along the tangent, perpendicular to it; None if Newton does not come to it at once."""
        widths = here.widths
        moved, value = length * tangent[:-1] * widths, here.value + length * tangent[-1] * unit
        for k in range(_CORRECTIONS):
            table = here.moved(moved)
            if np.any(np.diff(table.ravel()) <= 0):
                return None
            at = self.at(table, value)
            matrix = np.block([[at.rates * widths, at.by_value[:, None] * unit], [tangent[None]]])
            step = np.linalg.solve(matrix, np.append(-at.residual, 0.0))
            size = float(np.abs(step).max())
            if size > (0.3 * length if k == 0 else length):
                return None
            moved, value = moved + step[:-1] * widths, value + step[-1] * unit
            if size < 1e-11:
                return self.at(here.moved(moved), value)
        return None

    def pull_off(self, here: Point) -> Point:
        """Where the last zones come apart as the control falls from an equilibrium; those before do so one after the other."""
        here, high = self._apart(here)
        # Between a value that holds and one that does not: near enough for the arc to have one turning point.
        for _ in range(_HALVINGS):
            middle = 0.5 * (here.value + high)
            rest = self.receded(here.table, middle)
            here, high = (rest, high) if rest is not None else (here, middle)
        while True:
            turned = self.turning_point(self.settled(here))
            unit = 1.0 / float(np.abs(turned.by_value).max())
            onward = _tangent(turned, unit, None)[:-1]
            onward = np.asarray(onward * (-np.sign(onward.sum()) * _PUSH / np.abs(onward).max()), dtype=np.float64)
            rest = self.receded(turned.moved(onward * turned.widths), turned.value)
            if rest is None:
                return turned
            here = rest

    def _apart(self, here: Point) -> tuple[Point, float]:
        """(an equilibrium, a lower value of the control under which there is none) as the control falls."""
        step = 1.0 / float(np.abs(here.by_value).max())
        for _ in range(_MOST_TRIES * 4):
            rest = self.receded(here.table, here.value - step)
            if rest is None:
                return here, here.value - step
            here, step = rest, 2.0 * step
        raise NotConverged("the surfaces do not come apart as the control falls")

    def settled(self, here: Point) -> Point:
        """The equilibrium near by, tightly."""
        for _ in range(_CORRECTIONS):
            here = self.at(here.table, here.value)
            step = np.asarray(np.linalg.solve(-here.rates, here.residual), dtype=np.float64)
            size = float(np.abs(step / here.widths).max())
            if size < 1e-11 or size > 1e-2:
                break
            here = self.at(here.moved(step), here.value)
        return here


def _come_apart(here: Point, widths: Array, residual: Array) -> NDArray[np.bool_]:
    """Which zones have come apart that were so wide and so driven: the narrower they are the more they are driven."""
    driven = here.residual < np.minimum(-_DRIVEN, 1.5 * residual)
    return np.logical_and(*np.split(driven & (here.widths < _OPENED * widths), 2))


def _kept_step(here: Point, sign: float, limit: Array, most_back: Array) -> Array:
    """Newton's step, in which ends go no farther than their limits, nor back but a little; where there are motions that run away,
    damped by as much as keeps these within the limits."""
    rates, residual = here.rates, here.residual
    if here.growth >= 0.0:
        return _damped_step(here, sign, limit)
    step = np.linalg.solve(-rates, residual)
    free = np.ones(len(residual), dtype=bool)
    while True:
        far, back = free & (sign * step > limit * (1 + 1e-12)), free & (sign * step < -most_back * (1 + 1e-12))
        if not (far | back).any():
            return np.asarray(step)
        step[far], step[back] = sign * limit[far], -sign * most_back[back]
        free &= ~(far | back)
        if not free.any():
            return np.asarray(step)
        step[free] = np.linalg.solve(-rates[np.ix_(free, free)], residual[free] + rates[np.ix_(free, ~free)] @ step[~free])


def _damped_step(here: Point, sign: float, limit: Array) -> Array:
    """(mu D - J) ds = r, mu above the fastest growth and as near to it as the limits let it."""
    # An end that has gone too far waits for what the others do.
    free = sign * here.residual > -_SLIGHT
    weight, rates, above = here.weight[free], here.rates[np.ix_(free, free)], 1e-6
    growth = max(float(np.linalg.eigvals(rates / weight[:, None]).real.max(initial=-1.0)), -above)
    step = np.zeros_like(here.residual)
    while True:
        moved = np.linalg.solve(np.diag((growth + above) * weight) - rates, here.residual[free])
        if np.all(np.abs(moved) <= limit[free]) or above > 1e9:
            step[free] = np.where(sign * moved < 0, 0.0, moved)
            return step
        above *= 2.0


def _passed(here: Point, ahead: Point, step: Array, sign: float) -> NDArray[np.bool_]:
    """Which ends have passed a place of rest in a step: they are driven the other way at its end or, by a cubic, on the way."""
    before, after = sign * here.residual, sign * ahead.residual
    allowed = np.minimum(-_OVERSHOT * np.minimum(np.abs(before), 1.0) - _SLIGHT, 1.1 * before - _SLIGHT)
    # Beside a stable equilibrium an end that has gone a little too far comes back.
    far = (np.abs(step) > _NEAR * here.widths) | (here.growth < 0.0 <= ahead.growth) | (after < -_FAR)
    passed = (after < allowed) & far
    if float(np.abs(step / here.widths).max()) < _NEAR:
        return np.asarray(passed)
    rise, fall = sign * (here.rates @ step), sign * (ahead.rates @ step)
    u = _PLACES[:, None]
    way = (1 + 2 * u) * (1 - u) ** 2 * before + u * (1 - u) ** 2 * rise + u**2 * (3 - 2 * u) * after + u**2 * (u - 1) * fall
    return np.asarray(passed | (far & np.any(way < np.minimum(allowed, after), axis=0)))


def _tangent(at: Point, unit: float, before: Array | None) -> Array:
    """Unit vector along the curve: motions over widths, and of the control over a unit; with the sense of the one before, else down."""
    matrix = np.column_stack((at.rates * at.widths, at.by_value * unit))
    _, _, rows = np.linalg.svd(matrix)
    tangent = rows[-1]
    back = tangent[-1] > 0 if before is None else tangent @ before < 0
    return np.asarray(-tangent if back else tangent)


def kind_of(control: Control) -> type[Control]:
    """The control that is held."""
    return Approach if control.approach is not None else Load
