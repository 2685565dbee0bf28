"""The first-order closure on grids: the nominal pressure at which the contact of a strip is as wide as that of the strip alone under as
large a load.

    W(pbar) = W0(pbar L)

W: total width of the zones of the strip under a load and a nominal pressure beyond it; W0: of those of its profile alone, cut off at the
borders of the strip, under a load. Without the nominal pressure both are the same contact, and W is the larger one of any load below it;
under one as large as the mean of the load itself as a rule W0 is. The contact alone only grows with its load. So the root lies between,
and a bracket holds it, as far as the strip has a contact clear of its border there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from contact.formulation.problem import Problem
from contact.search.grid.coarse import Proposal, grid_height, propose
from contact.search.grid.conjugate_gradient import Response
from contact.search.grid.proposals import cut_of, pressed, whole_response
from contact.search.grid.scaling import ScaledScene

Array = NDArray[np.float64]

# Cells to a shortest length of the profile, bounds of how many that makes of a period, and the tolerance of their contact.
_CELLS, _FEWEST, _MOST, _ROUGHLY = 1, 2**9, 2**12, 1e-3
# Logarithm of the widths over each other that is near enough; of a bracket that holds the root, or shows that there is none.
_CLOSE, _CLOSED = 1e-3, 5e-3
# Nominal pressures tried, and how often a strip is moved to the middle of its zones under one of them.
_STEPS, _CENTRINGS = 30, 4
# How the miss falls with the logarithm of the nominal pressure, as a first guess and at the least; least and largest steps of that, and
# one away from where zones reach the border.
_POWER, _FLATTEST, _LEAST, _LARGEST, _CLEARED = 0.8, -0.1, 2e-3, 1.0, 0.25


@dataclass(frozen=True, eq=False)
class AtPressure:
    """Contacts of a strip and of its profile alone under a nominal pressure, scaled as the centre [of the strip] is. reaches: a zone of
    the strip reaches its border."""

    amplitude: float
    centre: float
    strip: Proposal
    alone: Proposal | None

    @property
    def reaches(self) -> bool:
        return self.alone is None

    @property
    def miss(self) -> float:
        """Logarithm of the strip's total width over that of the profile alone."""
        assert self.alone is not None
        return math.log(_width(self.strip) / _width(self.alone))


class ClosureGrid:
    """A scaled problem under a scaled load on grids of a period."""

    def __init__(self, scaled: ScaledScene, problem: Problem, load: float) -> None:
        self.scaled, self.problem, self.load = scaled, problem, load
        profile, units = problem.profile, problem.units
        assert problem.period is not None and profile.period is not None
        self.period, self.length = problem.period, profile.period
        self.response = Response(units.E_star, False, rest=problem.operator.strip_rest)
        features = 0.0 if profile.feature is None else _CELLS * profile.period / profile.feature
        self.points = 2 ** int(np.clip(np.ceil(np.log2(max(features, 1.0))), math.log2(_FEWEST), math.log2(_MOST)))

    def first(self) -> AtPressure:
        """The contacts under a nominal pressure that is the mean of the load."""
        return self._at(self.load / self.period, self._first_centre(), None)

    def root(self, here: AtPressure) -> AtPressure | None:
        """The contacts at the root, roughly, from some; None where the strip's reaches its border before it is as narrow as that of its
        profile alone."""
        low, high, touching = 0.0, math.inf, False
        last: AtPressure | None = None
        for _ in range(_STEPS):
            if here.reaches:
                # A smaller nominal pressure lets the zones at the border grow.
                low, touching = here.amplitude, True
            elif abs(here.miss) <= _CLOSE:
                return here
            elif here.miss > 0.0:
                low, touching = here.amplitude, False
            else:
                high = here.amplitude
            if low > 0.0 and math.log(high / low) < _CLOSED:
                return None if touching else here
            step = _step(here, last, low, high)
            last = None if here.reaches else here
            here = self._at(here.amplitude * math.exp(step), here.centre, here)
        return None if here.reaches else here

    def _first_centre(self) -> float:
        """Half a period from the middle of the widest gap of the period."""
        profile, units = self.problem.profile, self.problem.units
        assert profile.period is not None
        whole = propose(
            partial(grid_height, profile), self.scaled.cell, whole_response(self.problem), points=self.points,
            load=self.load * units.load, tol=_ROUGHLY,
        )
        return float(units.scaled(np.array(cut_of(whole, profile.x0, profile.period) + 0.5 * profile.period)))

    def _at(self, amplitude: float, centre: float, near: AtPressure | None) -> AtPressure:
        """Contacts under a nominal pressure, the strip moved to the middle of its zones."""
        strip = self.strip(amplitude, centre, self.points, _ROUGHLY, None if near is None else near.strip)
        for _ in range(_CENTRINGS):
            before, centre = centre, _middle(self.problem, strip)
            if not strip.touches_border and abs(centre - before) <= self.period / self.points:
                break
            strip = self.strip(amplitude, centre, self.points, _ROUGHLY, strip)
        if strip.touches_border:
            return AtPressure(amplitude, centre, strip, None)
        alone = self.alone(amplitude, centre, self.points, _ROUGHLY, None if near is None else near.alone)
        return AtPressure(amplitude, centre, strip, alone)

    def strip(self, amplitude: float, centre: float, points: int | None, tol: float, near: Proposal | None) -> Proposal:
        """The contact of the strip."""
        column = self.problem.about(centre).columns[0].primitive
        assert column is not None
        return self._proposed(partial(pressed, self.problem, amplitude, column), self.load, centre, points, tol, near)

    def alone(self, amplitude: float, centre: float, points: int | None, tol: float, near: Proposal | None) -> Proposal:
        """The contact of its profile alone, under the load of the nominal pressure."""
        return self._proposed(partial(grid_height, self.problem.profile), amplitude * self.period, centre, points, tol, near)

    def closer(self, rough: AtPressure, points: int, tol: float) -> AtPressure:
        """The same contacts on finer grids."""
        strip = self.strip(rough.amplitude, rough.centre, points, tol, rough.strip)
        return replace(rough, strip=strip, alone=self.alone(rough.amplitude, rough.centre, points, tol, rough.alone))

    def _proposed(self, height: object, load: float, centre: float, points: int | None, tol: float, near: Proposal | None) -> Proposal:
        units, profile = self.problem.units, self.problem.profile
        middle = float(units.x(np.array(centre)))
        return propose(
            height, (middle - 0.5 * self.length, middle + 0.5 * self.length), self.response, resolution=profile.feature,  # type: ignore[arg-type]
            points=points, load=load * units.load, tol=tol, near=None if near is None else near.state,
        )


def _step(here: AtPressure, last: AtPressure | None, low: float, high: float) -> float:
    """Of the logarithm of the nominal pressure: a secant's within the bracket, or to its middle; out of the reach of the border as long as
    nothing bounds it."""
    middle = 0.5 * (math.log(low / here.amplitude) + math.log(high / here.amplitude)) if low > 0.0 and high < math.inf else math.nan
    if here.reaches:
        return _CLEARED if math.isnan(middle) else middle
    rate = -_POWER
    if last is not None and last.amplitude != here.amplitude:
        rate = min((here.miss - last.miss) / math.log(here.amplitude / last.amplitude), _FLATTEST)
    step = -here.miss / rate
    step = math.copysign(min(max(abs(step), _LEAST), _LARGEST), step)
    inside = low < here.amplitude * math.exp(step) < high
    return step if inside or math.isnan(middle) else middle


def _width(proposal: Proposal) -> float:
    return float((proposal.zones[:, 1] - proposal.zones[:, 0]).sum())


def _middle(problem: Problem, strip: Proposal) -> float:
    return float(problem.units.scaled(np.array(0.5 * (strip.zones[0, 0] + strip.zones[-1, 1]))))
