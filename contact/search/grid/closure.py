"""The first-order closure on grids: the nominal pressure at which the contact of a strip is as wide as that of the strip alone under as
large a load.

    W(pbar) = W0(pbar L)

W: total width of the zones of the strip under a load and a nominal pressure beyond it; W0: of those of its profile alone, cut off at the
borders of the strip, under a load. Without the nominal pressure both are the same contact, and W is the larger one of any load below it;
under one far above the mean of the load W0 is. The contact alone only grows with its load. So the root lies between, and a bracket
holds it, about every centre, whether the strip is clear of its borders there or not. The centre is where its gaps beside the two borders
balance (contact.search.grid.centring): a root at which they are closed, or none, is a refusal. Grids are refined until they tell the gaps.
"""

from __future__ import annotations

import math
from functools import cached_property, partial

import numpy as np

from contact.formulation.problem import Problem
from contact.formulation.strip_turn import StripTurn
from contact.search.grid.coarse import grid_height, propose
from contact.search.grid.proposals import cut_of, whole_response
from contact.search.grid.scaling import ScaledScene
from contact.search.grid.strip import StripContact
from contact.search.grid.strip_at_rest import ROUGHLY, AtCentre, StripsOnGrids
from sie import record

# What the grid may have the miss off by, where that is little.
_SHARP = 0.05
# Miss that is near enough, and, by the rounding of ends to parts of a cell, of each end; width of a bracket of the logarithm of the nominal
# pressure; nominal pressures tried, and those to clear the border at first.
_CLOSE, _END, _CLOSED, _STEPS, _CLEARINGS = 1e-3, 0.1, 1e-3, 40, 4
# Points in contact that are so few.
_FEW = 16
# How the miss falls with the logarithm of the nominal pressure, as a first guess and at the least; least and largest steps of that, and
# one away from where zones reach the border.
_POWER, _FLATTEST, _LEAST, _LARGEST, _CLEARED = 0.8, -0.1, 2e-4, 1.0, 0.25


@record
class AtPressure(AtCentre):
    """Contacts of a strip and of its profile alone about a centre under a nominal pressure, all but the contacts scaled. widths: of the
    zones of both."""

    amplitude: float
    alone: StripContact
    widths: tuple[float, float]

    @property
    def wider(self) -> float:
        """By how much the strip's total width is larger than that of the profile alone: of what is in contact to what is not, the
        logarithm; -inf where the profile alone leaves no gap."""
        width, alone = self.widths
        if alone >= self.period:
            return -math.inf
        return math.log(width / alone * (self.period - alone) / (self.period - width)) if width < self.period else math.inf

    @property
    def blur(self) -> float:
        """What the grid may have that off by."""
        least = min(min(width, max(self.period - width, self.cell)) for width in self.widths)
        return _END * self.cell * 2 * (len(self.strip.zones) + len(self.alone.zones)) / least

    @property
    def told(self) -> bool:
        """Whether the grid tells the gaps."""
        return super().told and self.blur <= _SHARP


class ClosureGrid(StripsOnGrids[AtPressure]):
    """A scaled problem under a scaled load on grids of a period."""

    def __init__(self, scaled: ScaledScene, problem: Problem, load: float) -> None:
        super().__init__(problem, load)
        self.scaled = scaled
        # How the miss goes with the logarithm of the nominal pressure.
        self.rate = -_POWER

    def first(self) -> AtPressure:
        """The contacts under a nominal pressure that is the mean of the load, or a larger one, under which the strip is clear of its
        border."""
        here = self._held(self.load / self.period, self._cut[0], None)
        for _ in range(_CLEARINGS):
            if not here.touches:
                break
            here = self._held(here.amplitude * math.exp(_CLEARED), here.centre, here)
        return here

    def root(self, here: AtPressure, finely: bool) -> AtPressure:
        """The contacts at the root, roughly, from some near by; or the last ones looked at, with the strip's unrest, where it has none.
        finely: on the finest grids, even where a coarse one tells all."""
        return self.at_rest(here, self._cut[1], finely)

    def look(self, centre: float, near: AtPressure) -> AtPressure:
        """The contacts about a centre under the nominal pressure under which both are as wide, whether the strip is clear of its border
        or not: there always is one."""
        low, high = self.filled(centre)
        if low >= high:
            # The strip leaves no gap where its profile alone comes to leave none: no nominal pressure is told from others but that one.
            return self._held(high, centre, near)
        here, last = self._held(near.amplitude if low < near.amplitude < high else _between(low, high), centre, near), None
        for _ in range(_STEPS):
            if abs(here.wider) <= max(_CLOSE, here.blur) or math.log(high / max(low, 1e-300)) < _CLOSED:
                break
            low, high = (here.amplitude, high) if here.wider > 0.0 else (low, here.amplitude)
            step, last = self._step(here, last, low, high), here
            here = self._held(here.amplitude * math.exp(step), centre, here)
        return here

    def filled(self, centre: float) -> tuple[float, float]:
        """(the nominal pressure up to which the strip is in full contact, that from which on its profile alone is): the root lies between,
        where the first is the less."""
        if not self.grid.turns:
            return 0.0, math.inf
        turn = StripTurn(self.problem, centre, self.points)
        pressure, falls = self.load / np.pi - turn.relief, turn.half * (2 / np.pi - np.sin(turn.angles))
        beside = falls > 0.0
        strip = float((pressure[beside] / falls[beside]).min())
        filled = strip > 0.0 and bool((pressure[~beside] >= strip * falls[~beside]).all())
        return strip if filled else 0.0, np.pi * float(turn.relief.max()) / self.period

    def _step(self, here: AtPressure, last: AtPressure | None, low: float, high: float) -> float:
        """Of the logarithm of the nominal pressure: a secant's within the bracket, or to its middle."""
        bounded = low > 0.0 and high < math.inf
        middle = 0.5 * (math.log(low / here.amplitude) + math.log(high / here.amplitude)) if bounded else math.nan
        if math.isinf(here.wider):
            return math.copysign(_CLEARED, here.wider) if math.isnan(middle) else middle
        if last is not None and last.amplitude != here.amplitude and math.isfinite(last.wider):
            self.rate = min((here.wider - last.wider) / math.log(here.amplitude / last.amplitude), _FLATTEST)
        step = -here.wider / self.rate
        step = math.copysign(min(max(abs(step), _LEAST), _LARGEST), step)
        inside = low < here.amplitude * math.exp(step) < high
        return step if inside or math.isnan(middle) else middle

    @cached_property
    def _cut(self) -> tuple[float, float]:
        """(the first centre, the width of the gap that is cut): half a period from the middle of the widest gap of the period; of a body
        between sharp corners, its middle, and all that is beside it."""
        profile, units = self.problem.profile, self.problem.units
        assert profile.period is not None
        if profile.support is not None:
            left, right = (float(units.scaled(np.array(at))) for at in profile.support)
            return 0.5 * (left + right), self.period - (right - left)
        on_grid = partial(
            propose, partial(grid_height, profile), self.scaled.cell, whole_response(self.problem), load=self.load * units.load, tol=ROUGHLY
        )
        whole = on_grid(points=self.points)
        while np.count_nonzero(whole.state.contact) < _FEW and whole.points < self.finest:
            # Those of a finer grid may be on another summit.
            whole = on_grid(points=min(4 * whole.points, self.finest))
        middle, width = cut_of(whole, profile.x0, profile.period)
        return float(units.scaled(np.array(middle + 0.5 * profile.period))), width / units.length

    def _held(self, amplitude: float, centre: float, near: AtPressure | None) -> AtPressure:
        """Contacts under a nominal pressure about a centre."""
        strip = self.strip(amplitude, centre, self.points, ROUGHLY, None if near is None else near.strip)
        alone = self.alone(amplitude, centre, self.points, ROUGHLY, None if near is None else near.alone)
        return self._of(amplitude, centre, strip, alone)

    def _of(self, amplitude: float, centre: float, strip: StripContact, alone: StripContact) -> AtPressure:
        length = self.problem.units.length
        # Full contact on the grid is that to half a cell.
        widths = [self.period if each.width > self.period * length * (1 - 1e-9) else each.width / length for each in (strip, alone)]
        return AtPressure(
            centre, strip, self.beside(strip), self.period, strip.cell / length, None, amplitude, alone, (widths[0], widths[1])
        )

    def alone(self, amplitude: float, centre: float, points: int, tol: float, near: StripContact | None) -> StripContact:
        """The contact of its profile alone, under the load of the nominal pressure."""
        return self.proposed(partial(grid_height, self.problem.profile), amplitude * self.period, centre, points, tol, near)

    def closer(self, rough: AtPressure, points: int, tol: float) -> AtPressure:
        """The same contacts on finer grids."""
        strip = self.strip(rough.amplitude, rough.centre, points, tol, rough.strip)
        alone = self.alone(rough.amplitude, rough.centre, points, tol, rough.alone)
        return self._of(rough.amplitude, rough.centre, strip, alone)


def _between(low: float, high: float) -> float:
    """A nominal pressure within a bracket: half as far from its upper end, where it has no lower one."""
    return math.sqrt(low * high) if low > 0.0 else 0.5 * high
