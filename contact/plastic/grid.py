"""The first contacts and plateaus, from a grid on which the pressure is at most the limit H."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contact.errors import OutOfRange
from contact.formulation import tables
from contact.plastic.loop import AT_BORDER
from contact.plastic.spots import Spots, tidied
from contact.search.grid.conjugate_gradient import GridState
from contact.search.grid.nested_grids import zones_of
from contact.search.grid.proposals import placed, proposed
from contact.search.grid.scaling import ScaledScene
from contact.search.grid.tilt import known_part
from contact.search.options import SEARCH
from sie import Array


def proposed_spots(scaled: ScaledScene, limit: float, points: int | None) -> tuple[Spots, int]:
    """(first guess of contacts and plateaus, number of grid points), from a contact on a grid.
    The pressure is at most `limit` [Pa]. It has this value on the plateaus. If the contact is too
    narrow for the grid, the guess has no contacts.

    Raises OutOfRange if the contact reaches the border of the part of the profile that is known.
    """
    problem, control = scaled.problem, scaled.control
    for _ in range(SEARCH.max_steps):
        found = proposed(scaled, control, points, cap=limit)
        if not found.touches_border or problem.profile.support is not None:
            break
        scaled = _wider(scaled)
    state, (lo, hi) = found.state, scaled.cell
    x = np.asarray(lo + (hi - lo) / found.points * (np.arange(found.points) + 0.5), dtype=float)
    plateaus = placed(problem, _plateaus(state, x))
    if state.full:
        begin = float(problem.units.scaled(np.array(lo)))
        contacts = np.array([[begin, begin + problem.repeat_length]])
    else:
        contacts = placed(problem, zones_of(state, x, True))
        if len(contacts) == 0:
            return Spots(contacts, contacts), found.points
        corners = problem.corners
        for side, edge in enumerate(corners):
            # If a contact ends less than one cell from a sharp corner, it is extended to the
            # corner.
            end = contacts[-side, side]
            if (
                np.isfinite(edge)
                and abs(edge - end) < (hi - lo) / problem.units.length / found.points
            ):
                contacts[-side, side] = edge
        for side, edge in enumerate(corners):
            if len(plateaus) and contacts[-side, side] == edge:
                near = (hi - lo) / problem.units.length / found.points
                if abs(plateaus[-side, side] - edge) < near:
                    plateaus[-side, side] = edge
    return tidied(Spots(contacts, tables.ascending(plateaus), state.full), problem), found.points


def _wider(scaled: ScaledScene) -> ScaledScene:
    """The scene in a window twice as wide; OutOfRange if the window is all of the known profile."""
    (lo, hi), known = scaled.cell, known_part(scaled.problem.profile) or (-np.inf, np.inf)
    half = 0.5 * (hi - lo)
    cell = max(known[0], lo - half), min(known[1], hi + half)
    if cell == scaled.cell:
        raise OutOfRange(AT_BORDER)
    return replace(scaled, cell=cell)


def _plateaus(state: GridState, x: Array) -> Array:
    """Plateaus (m, 2) [m] of a grid solution: intervals on which the pressure p is the limit H.

    Next to a plateau (H - p)^2 is linear in x, as p^2 is near the end of a contact. Its zero,
    extrapolated from two grid points, is the end of the plateau.
    """
    n, h = state.influence.n, state.influence.h
    wraps = state.influence.is_periodic
    below = (state.influence.cap - state.pressure) ** 2
    rows = []
    for first, last in tables.runs_of(state.capped, wraps):
        ends = []
        for at, side in ((first, -1), (last, 1)):
            one, two = below[(at + side) % n], below[(at + 2 * side) % n]
            inner = min(one / (two - one), 1.0) if two > one else 0.5
            ends.append(float(x[0]) + h * (at + side * (1.0 - float(inner))))
        # A plateau is at least half a cell wide, and contains the middle of its run of grid cells.
        middle = float(x[0]) + 0.5 * h * (first + last)
        rows.append((min(ends[0], middle - 0.25 * h), max(ends[1], middle + 0.25 * h)))
    return np.array(rows).reshape(-1, 2)
