"""The first-order closure of one zone: the nominal pressure is the isolated load P0 of the same
width, over the period.

    pbar = P0(W) / L,      W = width of the zone of the strip under this nominal pressure

(Goryacheva & Tsukanov 2020, (16) with P_s = P0). For given W both problems are ordinary ones, so
that what is controlled is a function of W, whose root is taken on the branch that starts at zero
load and ends at the first maximum: by Newton's steps, kept on that branch. Of several zones:
first_order_several.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Control, HalfWidth, Load, Width
from contact.formulation.problem import Problem
from contact.localized.derivatives import At, Rates, table_of
from contact.model.interactions.isolated import Isolated
from contact.search.topology.failure import EXACT
from contact.verify.error import SolvedZones
from sie import Array, record

Search = Callable[[Problem, Control, Array | None], SolvedZones]

# Widths tried; part of the period up to which there are any, step over the width that is taken at
# the rates of the last one, one that rounding may keep from falling, and widths as good as one: on
# the way to the widest, to a maximum, and to zones that another search tells as well.
_STEPS = 80
_WIDEST = 0.9998
_LAST = 1e-8
_ROUNDED = 1e-6
_CLOSED = 1e-9
_AT_MAXIMUM = 1e-7
_ELSEWHERE = 1e-2
# Part of a bracket that is left on either side, and towards a width that has no contact.
_INSIDE = 0.1
_CAREFUL = 0.25


@record
class _AtWidth:
    """The contacts of a width: what they have of what is controlled, and what is wanted of it; how
    the first grows with the width and with the load, and centre and nominal pressure with the load.
    """

    at: At
    width: float
    has: float
    wanted: float
    slope: float
    by_load: float
    following: Array

    @property
    def miss(self) -> float:
        return self.has - self.wanted

    @property
    def step(self) -> float:
        """Newton's, of the width."""
        return -self.miss / self.slope if self.slope > 0.0 else math.inf


class FirstOrder:
    """The pair of problems, and the search for the width that carries the control.

    strip, alone: searches for the zone of the strip under a given nominal pressure, and for that of
    the isolated reference. first: about the zone, where it is not one about the origin.
    """

    def __init__(self, problem: Problem, strip: Search, alone: Search, first: Array | None) -> None:
        self.problem, self.strip, self.alone, self.first = problem, strip, alone, first
        self.isolated = replace(
            problem, interaction=Isolated(), centre=0.0, amplitude=None, reference=True
        )
        self.together: SolvedZones | None = None

    def found(self, control: Control, guess: float) -> SolvedZones:
        """The zone that carries the control. guess: of its width, which a half width gives."""
        given = control.half_width is not None
        here = self._at_width(control, guess) if given else self._carrying(control, guess)
        strip, rate, more = (
            here.at.strip,
            float(here.following[1]),
            0.0 if given else -here.miss / here.by_load,
        )
        _, pressure, load = (float(unknown) for unknown in here.at.unknowns)
        problem = strip.fields.problem.with_amplitude(pressure + rate * more)
        final = self.strip(
            problem, Load(load + more if control.load is None else control.load), table_of(strip)
        )
        return replace(final, fields=replace(final.fields, amplitude_rate=rate), control=control)

    @property
    def _period(self) -> float:
        assert self.problem.period is not None
        return self.problem.period

    def _at_width(self, control: Control, width: float) -> _AtWidth:
        """Zones of the strip of this total width under P0 of the same width."""
        of_width = HalfWidth(0.5 * width) if self.first is None else Width(width)
        start = _widened(self.first if self.together is None else table_of(self.together), width)
        alone = self.alone(self.isolated, of_width, start)
        pressure = alone.fields.density.total / self._period
        problem = self.problem if self.together is None else self.together.fields.problem
        strip = self.together = self.strip(problem.with_amplitude(pressure), of_width, start)
        at = At(
            np.array([strip.fields.problem.centre, pressure, strip.fields.density.total]),
            strip,
            alone,
        )
        rates = Rates(at)
        grows = rates.following
        has, by_load = float(at.unknowns[2]), 1.0
        if control.approach is not None:
            has, by_load = -strip.fields.level, float(rates.approach @ grows)
        return _AtWidth(
            at,
            width,
            has,
            control.value,
            by_load / float(grows[1] * rates.alone.sum()),
            by_load,
            grows,
        )

    def _carrying(self, control: Control, guess: float) -> _AtWidth:
        """At the root: Newton's steps within a bracket, whose lower end, once there is one, carries
        too little and lies on the branch.
        """
        high, carries, lost = _WIDEST * self._period, False, None
        low: _AtWidth | None = None
        fallen: _AtWidth | None = None
        width, last = min(guess, 0.5 * high), math.inf
        for _ in range(_STEPS):
            try:
                here = self._at_width(control, width)
            except (OutOfRange, NotConverged) as refusal:
                if low is None:
                    raise
                high, carries, lost, fallen, here = width, False, refusal, None, low
            else:
                step = abs(here.step)
                if step <= _LAST * width or (step > 0.5 * last and last < _ROUNDED * width):
                    return here
                last = step
                if here.miss > 0.0:
                    high, carries = width, True
                elif here.slope > 0.0:
                    low = here
                else:
                    high, carries, lost, fallen = width, False, None, here
            if low is not None and not carries and self._is_past(low, high, fallen, lost):
                raise lost if isinstance(lost, NotConverged) else self._refused(control, low)
            width = self._next(here, low, high, carries, fallen, lost)
        raise NotConverged(
            f"not converged: the width under the first-order closure did not settle; {EXACT}"
        )

    def _is_past(
        self, low: _AtWidth, high: float, fallen: _AtWidth | None, lost: Exception | None
    ) -> bool:
        """Whether nothing up to an upper end is to be expected that carries what is asked for."""
        if lost is not None:
            # Of zones from grids another search follows, which tells more than the last digits of a
            # width do.
            return (
                high - low.width
                < (
                    _AT_MAXIMUM
                    if self.first is None or isinstance(lost, OutOfRange)
                    else _ELSEWHERE
                )
                * high
            )
        if fallen is not None:
            # It bends down there, and stays below its tangents.
            return low.slope * (high - low.width) < min(-low.miss, _AT_MAXIMUM * low.has)
        return high - low.width < _CLOSED

    def _next(
        self,
        here: _AtWidth,
        low: _AtWidth | None,
        high: float,
        carries: bool,
        fallen: _AtWidth | None,
        lost: Exception | None,
    ) -> float:
        """The width to look at."""
        least = 0.0 if low is None else low.width
        there = here.width + here.step
        if least < there < high:
            return min(there, 2 * here.width)
        if low is None or carries:
            return 0.5 * (least + high)
        if fallen is not None:
            # The maximum, by secants of the slope.
            part = low.slope / (low.slope - fallen.slope)
            return least + min(max(part, _INSIDE), 1 - _INSIDE) * (high - least)
        return least + _CAREFUL * (high - least) if lost is not None else min(high, 2 * here.width)

    def _refused(self, control: Control, low: _AtWidth) -> OutOfRange:
        units = self.problem.units
        largest = (
            f"{low.has * control.unit(units):.6g} at total width {low.width * units.length:.6g} m"
        )
        return OutOfRange(
            f"{control.described(units)} is beyond the largest that the first-order closure carries on the branch from zero "
            f"load, {largest}; interaction = Periodic() has no such limit"
        )


def _widened(table: Array | None, width: float) -> Array | None:
    """Zones each widened in proportion to a new total width."""
    if table is None:
        return None
    middle, half = table.mean(axis=1), 0.5 * np.diff(table, axis=1)[:, 0]
    half = half * (0.5 * width / float(half.sum()))
    return np.column_stack((middle - half, middle + half))
