"""The first-order closure on grids: the nominal pressure at which the contact of a strip is as wide as that of the strip alone under as
large a load.

    W(pbar) = W0(pbar L)

W: total width of the zones of the strip under a load and a nominal pressure beyond it; W0: of those of its profile alone, cut off at the
borders of the strip, under a load. Without the nominal pressure both are the same contact, and W is the larger one of any load below it;
under one as large as the mean of the load itself as a rule W0 is. The contact alone only grows with its load. So the root lies between,
and a bracket holds it, as far as the strip has a contact clear of its border there. Where it has not, the bracket closes on the nominal
pressure from which on it is clear, with W0 still the larger: then there is none. Grids are refined until they tell the gaps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from contact.formulation.problem import Problem
from contact.formulation.strip_turn import StripTurn
from contact.search.grid.centring import Strip, Unrest, settled
from contact.search.grid.coarse import grid_height, propose
from contact.search.grid.conjugate_gradient import Response
from contact.search.grid.proposals import cut_of, pressed, whole_response
from contact.search.grid.scaling import ScaledScene
from contact.search.grid.strip import StripContact, StripGrid
from sie import Array, record

# Cells to a shortest length of the profile, at first and in the end, bounds of how many that makes of a period at first, and the tolerance
# of their contact.
_CELLS, _CELLS_FINELY, _FEWEST, _MOST, _ROUGHLY = 1, 4, 2**9, 2**12, 1e-3
# Cells that tell the room beside the border, and that are none; of the finest grid. What the grid may have the miss off by: of a miss
# that is sure, and that is little.
_TELLING, _TOUCHING, _FINEST, _SURE, _SHARP = 8, 4, 2**14, 3.0, 0.05
# Miss that is near enough, and, by the rounding of ends to parts of a cell, of each end; width of a bracket of the logarithm of the nominal
# pressure.
_CLOSE, _END, _CLOSED = 1e-3, 0.1, 1e-3
# Nominal pressures tried, and those to clear the border at first; of one under which the profile alone leaves no gap, the part under which
# that is asked once more.
_STEPS, _CLEARINGS, _LIGHTER = 40, 4, 0.95
# Centres tried between the borders, steps of them over the room there and of the logarithm of the nominal pressure, to begin with, the
# longest over the room, the cells that a bracket is narrowed to, and one of the nominal pressure that tells the nearer border.
_PLACES, _ASIDE, _ASIDE_PRESSURE, _FARTHEST, _NARROW, _NEARLY = 24, 0.1, 1e-2, 4.0, 0.5, 5e-3
# How the miss falls with the logarithm of the nominal pressure, as a first guess and at the least; least and largest steps of that, and
# one away from where zones reach the border.
_POWER, _FLATTEST, _LEAST, _LARGEST, _CLEARED = 0.8, -0.1, 2e-4, 1.0, 0.25


@record
class AtPressure:
    """Contacts of a strip and of its profile alone under a nominal pressure, all but the contacts scaled. widths: of the zones of both."""

    amplitude: float
    placed: Strip
    alone: StripContact
    widths: tuple[float, float]
    period: float

    @property
    def centre(self) -> float:
        return self.placed.centre

    @property
    def strip(self) -> StripContact:
        return self.placed.contact

    @property
    def unrest(self) -> Unrest | None:
        return self.placed.unrest

    @property
    def reaches(self) -> bool:
        """Whether a zone of the strip reaches its border."""
        return self.unrest is Unrest.BORDER

    @property
    def miss(self) -> float:
        """By how much the strip's total width is larger than that of the profile alone: of what is in contact to what is not, the
        logarithm; -inf where the profile alone leaves no gap."""
        width, alone = self.widths
        if alone >= self.period:
            return -math.inf
        return math.log(width / alone * (self.period - alone) / (self.period - width)) if width < self.period else math.inf

    @property
    def blur(self) -> float:
        """What the grid may have the miss off by."""
        least = min(min(width, max(self.period - width, self.placed.cell)) for width in self.widths)
        return _END * self.placed.cell * 2 * (len(self.strip.zones) + len(self.alone.zones)) / least


class ClosureGrid:
    """A scaled problem under a scaled load on grids of a period."""

    def __init__(self, scaled: ScaledScene, problem: Problem, load: float) -> None:
        self.scaled, self.problem, self.load = scaled, problem, load
        profile, units = problem.profile, problem.units
        assert problem.period is not None and profile.period is not None
        self.period = problem.period
        response = Response(units.E_star, False, rest=problem.operator.strip_rest)
        self.grid = StripGrid(response, profile.period, profile.feature, StripTurn.serves(problem))
        features = 0.0 if profile.feature is None else profile.period / profile.feature
        self.points, self.finest = (
            2 ** int(np.clip(np.ceil(np.log2(max(cells * features, 1.0))), math.log2(_FEWEST), math.log2(most)))
            for cells, most in ((_CELLS, _MOST), (_CELLS_FINELY, _FINEST))
        )
        # How the miss goes with the logarithm of the nominal pressure.
        self.rate = -_POWER

    def first(self) -> AtPressure:
        """The contacts under a nominal pressure that is the mean of the load, or a larger one, under which the strip is clear of its
        border."""
        centre = self._first_centre()
        here = self._at(self.load / self.period, centre, None)
        for _ in range(_CLEARINGS):
            if here.unrest is None:
                break
            here = self._at(here.amplitude * math.exp(_CLEARED), centre, here)
        return here

    def root(self, here: AtPressure, finely: bool) -> AtPressure:
        """The contacts at the root, roughly, from some; with the strip's unrest, where it has none: then the profile alone is in wider
        contact wherever the strip is clear of its border. finely: on the finest grids, even where a coarse one has a root."""
        found, clear = self._followed(here)
        while self.points < self.finest and (finely or found.unrest is not None):
            # What a coarse grid tells is the beginning of what a finer one does.
            if found.unrest is not None and clear is None:
                return found
            self.points = min(4 * self.points, self.finest)
            beside = found if found.unrest is None or clear is None else clear
            found, clear = self._followed(self._at(beside.amplitude, beside.centre, beside))
        if found.unrest is None or clear is None or clear.placed.room < _TOUCHING * clear.placed.cell:
            return found
        return self._balanced(clear)

    def _followed(self, here: AtPressure) -> tuple[AtPressure, AtPressure | None]:
        """(the root, or where its search ends, the last contacts with a strip clear of its border on the way): the centre of the strip
        follows its zones under every nominal pressure."""
        low, high = 0.0, math.inf
        last: AtPressure | None = None
        # The last ones that are too wide alone, and those that are not, or not clear of the border.
        wide: AtPressure | None = None
        lost: AtPressure | None = None
        for _ in range(_STEPS):
            if here.unrest is None and abs(here.miss) <= max(_CLOSE, here.blur):
                return here, here
            if here.unrest is None and here.miss < 0.0:
                high, wide = here.amplitude, here
            else:
                # A smaller nominal pressure lets the zones at the border grow.
                low, lost = here.amplitude, here
            shut = low > 0.0 and math.log(high / low) < _CLOSED
            if lost is not None and (shut or (lost.reaches and wide is not None and self._covers(lost))):
                return lost, wide
            step = self._step(here, last, low, high)
            last = None if here.unrest is not None else here
            here = self._at(here.amplitude * math.exp(step), (wide or here).centre, wide or here)
        return replace(here, placed=replace(here.placed, unrest=here.unrest or Unrest.JUMP)), wide

    def _covers(self, here: AtPressure) -> bool:
        """Whether the profile alone leaves no gap, under clearly less load neither: no strip clear of its border is then as wide."""
        if not math.isinf(here.miss):
            return False
        lighter = self.alone(_LIGHTER * here.amplitude, here.centre, self.points, _ROUGHLY, here.alone)
        return self._of(here.amplitude, here.placed, lighter).miss == -math.inf

    def _balanced(self, clear: AtPressure) -> AtPressure:
        """The root between centres at which the strip reaches its left border and its right one first, as its nominal pressure falls.

        Near full contact no centre that follows the zones stays: the nearer to a border the place to cut at is moved, the faster the zone
        beside it comes on. So the middle of the zones lies to the left of the centre at the one end, to the right at the other, and is the
        centre between.
        """
        here, side = self._closed(clear.centre, clear)
        left: AtPressure | None = None
        right: AtPressure | None = None
        step = _ASIDE * max(here.placed.room, 4 * here.placed.cell)
        for looks in range(_PLACES):
            if here.unrest is None and here.placed.rests:
                return here
            left, right = (here, right) if side < 0.0 else (left, here)
            if left is None or right is None:
                if step > _FARTHEST * here.placed.room:
                    break
                centre = here.centre - math.copysign(step, side)
                step *= 2
            elif abs(right.centre - left.centre) < _NARROW * here.placed.cell:
                break
            else:
                known = left.unrest is None and right.unrest is None and looks % 2
                share = left.placed.miss / (left.placed.miss - right.placed.miss) if known else 0.5
                centre = left.centre + min(max(share, 0.1), 0.9) * (right.centre - left.centre)
            here, side = self._closed(centre, here)
        both = [each for each in (left, right) if each is not None]
        why = Unrest.BORDER if any(each.unrest is not None for each in both) else Unrest.JUMP
        return replace(here, placed=replace(here.placed, unrest=why))

    def _closed(self, centre: float, near: AtPressure) -> tuple[AtPressure, float]:
        """(the contacts about a centre under the nominal pressure of the root there, negative where the left border is the nearer one);
        where there is no root, about the least nominal pressure under which the strip is clear of its border, with that for its unrest."""
        low, high, amplitude, width = 0.0, math.inf, near.amplitude, _ASIDE_PRESSURE
        clear: AtPressure | None = None
        touched: Strip | None = None
        for _ in range(_STEPS):
            here = self._held(amplitude, centre, clear or near)
            if not here.placed.touches and abs(here.miss) <= max(_CLOSE, here.blur):
                return here, here.placed.miss
            if here.placed.touches or here.miss > 0.0:
                low, touched = amplitude, here.placed if here.placed.touches else None
            else:
                high, clear = amplitude, here
            if low == 0.0 or clear is None:
                amplitude *= math.exp(width if clear is None else -width)
                width *= 2
            elif math.log(high / low) < (_CLOSED if touched is None else _NEARLY):
                break
            else:
                amplitude = math.sqrt(low * high)
        assert clear is not None
        if touched is None:
            return clear, clear.placed.miss
        return replace(clear, placed=replace(clear.placed, unrest=Unrest.BORDER)), touched.side or clear.placed.miss

    def _step(self, here: AtPressure, last: AtPressure | None, low: float, high: float) -> float:
        """Of the logarithm of the nominal pressure: a secant's within the bracket, or to its middle; out of the reach of the border as long
        as nothing bounds it."""
        bounded = low > 0.0 and high < math.inf
        middle = 0.5 * (math.log(low / here.amplitude) + math.log(high / here.amplitude)) if bounded else math.nan
        if here.unrest is not None:
            return _CLEARED if math.isnan(middle) else middle
        if math.isinf(here.miss):
            return -_CLEARED if math.isnan(middle) else middle
        if last is not None and last.amplitude != here.amplitude and math.isfinite(last.miss):
            self.rate = min((here.miss - last.miss) / math.log(here.amplitude / last.amplitude), _FLATTEST)
        step = -here.miss / self.rate
        step = math.copysign(min(max(abs(step), _LEAST), _LARGEST), step)
        inside = low < here.amplitude * math.exp(step) < high
        return step if inside or math.isnan(middle) else middle

    def _first_centre(self) -> float:
        """Half a period from the middle of the widest gap of the period; of a body between sharp corners, its middle."""
        profile, units = self.problem.profile, self.problem.units
        assert profile.period is not None
        if profile.support is not None:
            return float(units.scaled(np.array(0.5 * sum(profile.support))))
        whole = propose(
            partial(grid_height, profile), self.scaled.cell, whole_response(self.problem), points=self.points,
            load=self.load * units.load, tol=_ROUGHLY,
        )
        return float(units.scaled(np.array(cut_of(whole, profile.x0, profile.period) + 0.5 * profile.period)))

    def _look(self, amplitude: float, centre: float, near: StripContact | None) -> Strip:
        contact = self.strip(amplitude, centre, self.points, _ROUGHLY, near)
        ends = self.problem.units.scaled(contact.zones[[0, -1], [0, 1]])
        room = self.period - float(ends[1] - ends[0])
        return Strip(centre, contact, 0.5 * float(ends[0] + ends[1]), room, contact.cell / self.problem.units.length)

    def _held(self, amplitude: float, centre: float, near: AtPressure) -> AtPressure:
        """Contacts under a nominal pressure about a centre."""
        placed = self._look(amplitude, centre, near.strip)
        return self._of(amplitude, placed, self.alone(amplitude, centre, self.points, _ROUGHLY, near.alone))

    def _at(self, amplitude: float, centre: float, near: AtPressure | None) -> AtPressure:
        """Contacts under a nominal pressure, the strip moved to the middle of its zones, on grids that tell the gaps."""

        def look(centre: float, beside: Strip) -> Strip:
            return self._look(amplitude, centre, beside.contact)

        placed = settled(look, self._look(amplitude, centre, None if near is None else near.strip))
        while True:
            alone = self.alone(amplitude, placed.centre, self.points, _ROUGHLY, None if near is None else near.alone)
            here = self._of(amplitude, placed, alone)
            told = placed.room >= _TELLING * placed.cell and (abs(here.miss) > _SURE * here.blur or here.blur <= _SHARP)
            if self.points >= max(self.finest, _FEWEST) or here.unrest is not None or told:
                return here
            self.points *= 2
            placed = settled(look, look(placed.centre, placed))

    def _of(self, amplitude: float, placed: Strip, alone: StripContact) -> AtPressure:
        length = self.problem.units.length
        widths = placed.contact.width / length, alone.width / length
        # Full contact on the grid is that to half a cell.
        full = self.period * (1 - 1e-9)
        return AtPressure(amplitude, placed, alone, (widths[0], self.period if widths[1] > full else widths[1]), self.period)

    def strip(self, amplitude: float, centre: float, points: int, tol: float, near: StripContact | None) -> StripContact:
        """The contact of the strip."""
        column = self.problem.about(centre).columns[0].primitive
        assert column is not None
        return self._proposed(partial(pressed, self.problem, amplitude, column), self.load, centre, points, tol, near)

    def alone(self, amplitude: float, centre: float, points: int, tol: float, near: StripContact | None) -> StripContact:
        """The contact of its profile alone, under the load of the nominal pressure."""
        return self._proposed(partial(grid_height, self.problem.profile), amplitude * self.period, centre, points, tol, near)

    def closer(self, rough: AtPressure, points: int, tol: float) -> AtPressure:
        """The same contacts on finer grids."""
        strip = self.strip(rough.amplitude, rough.centre, points, tol, rough.strip)
        alone = self.alone(rough.amplitude, rough.centre, points, tol, rough.alone)
        return self._of(rough.amplitude, replace(rough.placed, contact=strip, cell=strip.cell / self.problem.units.length), alone)

    def _proposed(
        self, height: Callable[[Array], Array], load: float, centre: float, points: int, tol: float, near: StripContact | None
    ) -> StripContact:
        units = self.problem.units
        middle = float(units.x(np.array(centre)))
        return self.grid.contact(height, middle, load * units.load, points, tol, near)
