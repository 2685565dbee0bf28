"""The first-order closure: the nominal pressure is the isolated load P0 of the same total width, over the period.

    pbar = P0(W) / L,      W = total width of the zones of the strip under this nominal pressure

(Goryacheva & Tsukanov 2020, (16) with P_s = P0). For given W both problems are ordinary ones, so that what is controlled is a function
of W. For one zone about the origin that is cheap, and its root is taken on the branch that starts at zero load and ends at the first
maximum. Several zones, or one of unknown place, are found by pbar: at a given pbar those of the strip solve a convex problem, and

    miss(pbar) = P0(W(pbar)) / L - pbar

is a function of one number. A larger pbar leaves narrower zones: from the load over L, which is too large, downwards they grow, and the
first root is that of the branch from zero load. Past the largest load of that branch there is none: the miss turns, or a zone reaches
the border of the strip.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Control, HalfWidth, Load, Width
from contact.formulation.problem import Problem
from contact.formulation.roots import bracketed
from contact.model.interactions.isolated import Isolated
from contact.verify.accuracy import Found

Array = NDArray[np.float64]
Search = Callable[[Problem, Control, Array | None], Found]
Touches = Callable[[Problem, Control], bool]

_STEPS = 30
# How often a step towards a nominal pressure at which a zone reaches the border is halved, and how often what is left between that and one
# at which none does; a step by less than this part is not looked at beforehand.
_HALVED, _SEARCHED, _SHORT = 3, 6, 0.02
# Where the miss turns by this much short of zero, over the least of it that was seen, it has no root.
_NEAR_TURN = 0.5
# Relative differences of load and nominal pressure that tell their rate.
_APART = 1e-4


class FirstOrder:
    """The pair of problems, and the search for the nominal pressure that carries the control.

    strip, alone: searches for the zones of the strip under a given nominal pressure, and for those of the isolated reference. touches:
    whether these reach the border, as a coarse grid has it. single: one zone about the origin.
    """

    def __init__(self, problem: Problem, strip: Search, alone: Search, touches: Touches, tolerance: float, single: bool) -> None:
        self.problem, self.strip, self.alone, self.touches, self.tolerance = problem, strip, alone, touches, tolerance
        self.single = single
        self.isolated = replace(problem, interaction=Isolated(), centre=0.0, amplitude=None, reference=True)
        self.together: Found | None = None
        # How nearly the nominal pressure is found, or the miss brought to zero.
        self.close = 0.0

    def found(self, control: Control, guess: float) -> tuple[Found, float]:
        """The zones that carry the control, and d amplitude / d load at them (for the stiffness). guess: of their total width where
        there is one about the origin, else of the amplitude."""
        if control.half_width is not None:
            self.single = True
            found, amplitude = self._at_width(2 * control.half_width)
        elif self.single:
            found, amplitude = self._at_width(self._width_for(control, guess))
        else:
            amplitude = self._amplitude_for(control, guess)
            assert self.together is not None
            found = self.together
        rate, off = (self._rate(found), 0.0) if self.single else self._rate_and_off(found, control, amplitude)
        load = found.fields.density.total
        final = self.strip(found.fields.problem.with_amplitude(amplitude), Load(load), _table(found))
        return replace(final, fields=replace(final.fields, amplitude_rate=rate), control=control, off=off), amplitude

    @property
    def _period(self) -> float:
        assert self.problem.period is not None
        return self.problem.period

    def _at_width(self, width: float) -> tuple[Found, float]:
        """(zones of the strip of this total width under P0 of the same width, that nominal pressure)."""
        control = self._of_width(width)
        start = _widened(self.together, width)
        amplitude = self.alone(self.isolated, control, start).fields.density.total / self._period
        problem = self.problem if self.together is None else self.together.fields.problem
        self.together = self.strip(problem.with_amplitude(amplitude), control, start)
        return self.together, amplitude

    def _of_width(self, width: float) -> Control:
        return HalfWidth(0.5 * width) if self.single else Width(width)

    def _rate(self, found: Found) -> float:
        """d amplitude / d load = dP0/dW over dP/dW, by central differences: the stiffness needs no more digits than they have."""
        width = _width(found)
        step = min(1e-5 * width, 0.25 * (self._period - width))
        (ahead, more), (behind, less) = self._at_width(width + step), self._at_width(width - step)
        return (more - less) / (ahead.fields.density.total - behind.fields.density.total)

    def _rate_and_off(self, found: Found, control: Control, amplitude: float) -> tuple[float, float]:
        """(d amplitude / d load of vanishing miss; how far the ends may be off, over the widths of their zones, by what the nominal
        pressure is off), by central differences in both."""
        load = found.fields.density.total
        ahead, behind = (self._missed_from(found, Load(load * (1 + more)), amplitude)[0] for more in (_APART, -_APART))
        (above, wide), (below, narrow) = (self._missed_from(found, Load(load), amplitude * (1 + more)) for more in (_APART, -_APART))
        rate = -(ahead - behind) / load / ((above - below) / amplitude)
        if control.load is None:
            # Under another control the zones follow the nominal pressure otherwise.
            (above, wide), (below, narrow) = (self._missed_from(found, control, amplitude * (1 + more)) for more in (_APART, -_APART))
        apart = 2 * _APART * amplitude
        moved = float((np.abs(wide - narrow) / np.diff(_table(found), axis=1)).max()) / apart
        return rate, moved * self.close * (1 + apart / abs(above - below))

    def _missed_from(self, found: Found, control: Control, amplitude: float) -> tuple[float, Array]:
        """The miss at a nominal pressure near that of what was found, and the zones there."""
        self.together = found
        missed = self._miss(control, amplitude)
        return missed, _table(self.together)

    def _width_for(self, control: Control, guess: float) -> float:
        """Bracket the root upwards from zero width, then close the bracket."""

        def miss(width: float) -> float:
            found, _ = self._at_width(width)
            got = found.fields.density.total if control.load is not None else -found.fields.level
            return got - control.value

        limit, lost = 0.9998 * self._period, None
        high = min(guess, 0.5 * limit)
        at_high = miss(high)
        while at_high > 0:
            high *= 0.5
            at_high = miss(high)
        low, at_low = high, at_high
        step = 0.25 * high
        while at_high <= 0:
            low, at_low = high, at_high
            if limit - high < 1e-9:
                raise lost if isinstance(lost, NotConverged) else self._refused(control, low, at_low)
            high = min(high + step, limit)
            try:
                at_high = miss(high)
            except (OutOfRange, NotConverged) as refusal:
                limit, step, lost = high, 0.25 * (high - low), refusal
                high, at_high = low, at_low
                if step < 1e-7 * limit:
                    # That a search has failed does not show that there is no more to be carried.
                    raise lost if isinstance(lost, NotConverged) else self._refused(control, low, at_low) from None
                continue
            if at_high < at_low:
                # Past a maximum: come closer from below until it is clear that the root is not before it.
                if step < 1e-7 * high:
                    raise self._refused(control, low, at_low)
                limit = min(limit, high)
                step *= 0.25
                high, at_high = low, at_low
        # Rounding may keep the bracket from closing: then its last point is as good as any.
        return bracketed(miss, {low: at_low, high: at_high}, xtol=4e-16 * high, rtol=1e-15, most=2 * _STEPS)

    def _amplitude_for(self, control: Control, guess: float) -> float:
        """The first root of the miss below the load over L, by secants: the first step goes to P0 / L, which is the root to first order
        in what the neighbours do."""
        at = guess
        here = step = self._miss(control, at)
        close = self.close = max(1e-15, 0.01 * self.tolerance) * max(abs(guess), abs(here))
        halved, lost = 0, None
        passed = [(at, here)]
        for _ in range(_STEPS):
            if abs(here) <= close:
                return at
            best = self.together
            if abs(step) > _SHORT * abs(at):
                step = self._inside(control, at, step)
            try:
                there = self._miss(control, at + step)
            except (OutOfRange, NotConverged) as refusal:
                self.together, step, halved, lost = best, 0.5 * step, halved + 1, refusal
                if halved > _HALVED:
                    break
                continue
            before, missed, at, here = at, here, at + step, there
            passed.append((at, here))
            if here * missed < 0:
                return self._between(control, {before: missed, at: here}, close)
            if abs(here) >= abs(missed):
                return self._beyond_turn(control, passed[-3:], close)
            step = here * (at - before) / (missed - here)
        raise lost if isinstance(lost, NotConverged) else self._refused(control)

    def _inside(self, control: Control, at: float, step: float) -> float:
        """A step, or as much of it as leaves the zones clear of the border: a smaller nominal pressure leaves wider ones. Where next to
        nothing of it does, there is no nominal pressure to be found on the way."""
        if not self._reaches(control, at + step):
            return step
        inside, outside = 0.0, step
        for _ in range(_SEARCHED):
            middle = 0.5 * (inside + outside)
            inside, outside = (inside, middle) if self._reaches(control, at + middle) else (middle, outside)
        if inside == 0.0:
            raise self._refused(control)
        return inside

    def _reaches(self, control: Control, amplitude: float) -> bool:
        """Whether a zone reaches the border at a nominal pressure; below zero there is none."""
        problem = self.problem.with_amplitude(amplitude)
        if self.together is not None:
            problem = problem.about(self.together.fields.problem.centre)
        return amplitude <= 0.0 or self.touches(problem, control)

    def _miss(self, control: Control, amplitude: float) -> float:
        """P0(W) / L less the nominal pressure at which W is the total width."""
        problem, start = self.problem.with_amplitude(amplitude), None
        if self.together is not None:
            problem, start = problem.about(self.together.fields.problem.centre), _table(self.together)
        self.together = self.strip(problem, control, start)
        alone = self.alone(self.isolated, self._of_width(_width(self.together)), _table(self.together))
        return alone.fields.density.total / self._period - amplitude

    def _between(self, control: Control, known: dict[float, float], close: float) -> float:
        last = math.nan

        def miss(at: float) -> float:
            nonlocal last
            last, found = at, self._miss(control, at)
            return found if abs(found) > close else 0.0

        # Rounding may keep the bracket from closing: then its last point is as good as any.
        root = bracketed(miss, known, xtol=close, rtol=1e-15, most=_STEPS)
        if last != root:
            self._miss(control, root)
        return root

    def _beyond_turn(self, control: Control, passed: list[tuple[float, float]], close: float) -> float:
        """The root before the turn of the miss, where the top of the parabola through the last points is beyond zero."""
        if len(passed) == 3:
            top, highest = _turn(passed)
            # One that stays as far from zero as its points has no root to be looked for.
            if highest * passed[0][1] > 0 and abs(highest) > _NEAR_TURN * min(abs(missed) for _, missed in passed):
                raise self._refused(control)
            there = self._miss(control, top)
            if abs(there) <= close:
                return top
            if there * passed[0][1] < 0:
                return self._between(control, {passed[0][0]: passed[0][1], top: there}, close)
        raise self._refused(control)

    def _refused(self, control: Control, width: float | None = None, miss: float = 0.0) -> OutOfRange:
        units = self.problem.units
        unit = control.unit(units)
        largest = "" if width is None else f", {(control.value + miss) * unit:.6g} at total width {width * units.length:.6g} m"
        return OutOfRange(
            f"{control.told(units)} is beyond the largest that the first-order closure carries on the branch from zero "
            f"load{largest}; interaction = Periodic() has no such limit"
        )


def _turn(points: list[tuple[float, float]]) -> tuple[float, float]:
    """Where the parabola through three points turns, and its value there."""
    (a, fa), (b, fb), (c, fc) = points
    up, down = (b - a) * (fb - fc), (b - c) * (fb - fa)
    top = b - 0.5 * ((b - a) * up - (b - c) * down) / (up - down)
    value = sum(f * (top - p) * (top - q) / ((at - p) * (at - q)) for at, f, p, q in ((a, fa, b, c), (b, fb, a, c), (c, fc, a, b)))
    return top, value


def _table(found: Found) -> Array:
    return found.free.density.zones.table


def _width(found: Found) -> float:
    zones = found.free.density.zones
    return float((zones.b - zones.a).sum())


def _widened(found: Found | None, width: float) -> Array | None:
    """Zones each widened in proportion to a new total width."""
    if found is None:
        return None
    zones = found.free.density.zones
    half = zones.half * (width / _width(found))
    return np.column_stack((zones.middle - half, zones.middle + half))
