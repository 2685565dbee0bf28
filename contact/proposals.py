"""Zones proposed by the coarse grid, placed where the scaled problem wants them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from contact.framing import Framed
from contact.problem import Control, Problem
from contact.search import grid_height, propose

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Proposed:
    """Zones (n, 2) [m], the grid's points, and whether it is in full contact or touches the border of what is known."""

    zones: Array
    points: int
    full: bool
    touches_border: bool

    @property
    def width(self) -> float:
        """Total width [m], inf in full contact."""
        return math.inf if self.full else float(np.sum(self.zones[:, 1] - self.zones[:, 0]))


def proposed(frame: Framed, problem: Problem, control: Control, points: int | None) -> Proposed:
    """Zones from a grid of so many points, or of as many as the profile's resolution asks for."""
    if control.kind == "width":
        return _by_width(frame, problem, control, points)
    units, profile, interaction = problem.units, problem.profile, problem.interaction
    by_load = control.kind == "load"
    found = propose(
        partial(grid_height, profile) if by_load else profile.height, frame.cell, E=units.E_star,
        periodic=interaction.needs_period, datum=getattr(interaction, "datum", None) or 1.0,
        resolution=profile.resolution, points=points, load=control.value * units.load if by_load else None,
        level=None if by_load else problem.lowest + control.value * units.height,
    )
    return Proposed(found.zones, found.points, found.full, found.touches_border)


def _by_width(frame: Framed, problem: Problem, control: Control, points: int | None) -> Proposed:
    """At the load at which the grid's zones have the given total width, by bisection on its logarithm."""
    width = control.value * problem.units.length
    low, high, load = 0.0, math.inf, 0.1
    best: Proposed | None = None
    for _ in range(60):
        found = proposed(frame, problem, Control("load", load), points)
        if best is None or not found.full:
            best = found
        if abs(found.width / width - 1) < 0.03:
            break
        low, high = (load, high) if found.width < width else (low, load)
        # Coarse grids do for large loads; only where the zones are narrow must the grid be fine.
        if low == 0.0:
            load = high * min(max((width / found.width) ** 2, 1e-3), 0.3) if found.width < math.inf else 0.3 * high
        else:
            load = 10 * low if high == math.inf else math.sqrt(low * high)
    assert best is not None
    return best


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
