"""Zones proposed by the coarse grid, placed where the scaled problem wants them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from contact.framing import Framed
from contact.leaning import known_part
from contact.problem import Control, Problem
from contact.search import Proposal, grid_height, propose
from contact.turning import Lean, balanced

Array = NDArray[np.float64]

# Cells by which the centre of the load may miss its place, tilts tried on one grid, and how often a window is doubled.
_CELLS = 0.1
_MOST_TILTS = 12
_WIDENINGS = 4
# Of a width: near enough for a load to begin with.
_ABOUT = 0.03


@dataclass(frozen=True, eq=False)
class Proposed:
    """Zones (n, 2) [m], the grid's points, whether it is in full contact or touches the border of what is known, and the tilt
    under which the moment is right, where that is unknown."""

    zones: Array
    points: int
    full: bool
    touches_border: bool
    tilt: float | None = None

    @property
    def width(self) -> float:
        """Total width [m], inf in full contact."""
        return math.inf if self.full else float(np.sum(self.zones[:, 1] - self.zones[:, 0]))


def proposed(frame: Framed, problem: Problem, control: Control, points: int | None) -> Proposed:
    """Zones from a grid of so many points, or of as many as the profile's resolution asks for."""
    if problem.moment is not None:
        return _by_moment(frame, problem, control, points)
    units, profile, interaction = problem.units, problem.profile, problem.interaction
    by_load = control.kind == "load"
    found = propose(
        partial(grid_height, profile) if by_load else profile.height, frame.cell, E=units.E_star,
        periodic=interaction.needs_period, datum=interaction.datum or 1.0, rest=problem.operator.rest,
        resolution=profile.feature, points=points, load=control.value * units.load if by_load else None,
        level=None if by_load else problem.lowest + control.value * units.height,
    )
    return Proposed(found.zones, found.points, found.full, found.touches_border)


class _TooNarrow(Exception):
    """The contact reaches the border of the window."""


def _by_moment(frame: Framed, problem: Problem, control: Control, points: int | None) -> Proposed:
    """At the tilt under which the grid's load has the given centre, in a window that is widened where the contact reaches its
    border."""
    units, load = problem.units, control.value * problem.units.load
    assert problem.moment is not None
    centre, limits = problem.moment * units.moment / load, known_part(problem.profile) or (-math.inf, math.inf)
    lo, hi = frame.cell
    for widened in range(_WIDENINGS + 1):
        cell, last = (lo, hi), widened == _WIDENINGS or (lo, hi) == limits

        def lean(tilt: float, cell: tuple[float, float] = cell, last: bool = last) -> Lean[Proposal]:
            profile = problem.turned_to(tilt).profile
            found = propose(
                partial(grid_height, profile), cell, E=units.E_star, periodic=False, resolution=profile.feature,
                points=points, load=load, rest=problem.operator.rest,
            )
            if found.touches_border and not last:
                raise _TooNarrow
            return Lean.of(tilt, cell, found, _CELLS, found)

        try:
            best = balanced(lean, centre, (problem.tilt,), _MOST_TILTS)
            break
        except _TooNarrow:
            half = 0.5 * (hi - lo)
            lo, hi = max(limits[0], lo - half), min(limits[1], hi + half)
    return Proposed(best.found.zones, best.found.points, False, best.found.touches_border, best.tilt)


def load_of_width(frame: Framed, problem: Problem, width: float) -> float:
    """A scaled load at which a grid's zones have about the given scaled total width, by bisection on its logarithm."""
    wanted = width * problem.units.length
    low, high, load = 0.0, math.inf, 0.1
    for _ in range(60):
        found = proposed(frame, problem, Control("load", load), None)
        if abs(found.width / wanted - 1) < _ABOUT:
            break
        low, high = (load, high) if found.width < wanted else (low, load)
        # Coarse grids do for large loads; only where the zones are narrow must the grid be fine.
        if low == 0.0:
            load = high * min(max((wanted / found.width) ** 2, 1e-3), 0.3) if found.width < math.inf else 0.3 * high
        else:
            load = 10 * low if high == math.inf else math.sqrt(low * high)
    return load


def placed(problem: Problem, zones: Array) -> Array:
    """Zones [m] in scaled variables, cut at the widest gap of the period where the model wants them in one strip."""
    scaled = problem.units.scaled(zones)
    period = problem.period
    if period is None:
        return scaled
    if problem.profile.symmetric:
        # About the origin, so that mirror images stand together.
        scaled = scaled - np.round(scaled.mean(axis=1) / period)[:, None] * period
        scaled = scaled[np.argsort(scaled[:, 0])]
    if problem.interaction.strip and len(scaled):
        gaps = np.append(scaled[1:, 0] - scaled[:-1, 1], scaled[0, 0] + period - scaled[-1, 1])
        if gaps[-1] < (1 - 1e-6) * gaps.max():
            first = int(np.argmax(gaps)) + 1
            scaled = np.concatenate((scaled[first:], scaled[:first] + period))
    return np.asarray(scaled)


def about(problem: Problem, table: Array) -> Problem:
    """The problem with its strip centred on the scaled zones from which Newton starts."""
    if not problem.interaction.strip:
        return problem
    middle = 0.5 * float(table[0, 0] + table[-1, 1])
    near_origin = abs(middle) < 0.25 * float((table[:, 1] - table[:, 0]).min())
    return problem.about(0.0 if problem.profile.symmetric and near_origin else middle)
