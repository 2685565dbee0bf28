"""A strip at rest on grids: where its centre stays, on ever finer grids until they tell the gaps
beside its borders.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Generic, TypeVar

import numpy as np

from contact.formulation.problem import Problem
from contact.search.grid.centring import Unrest, rests, settled
from contact.search.grid.conjugate_gradient import Response
from contact.search.grid.nested_grids import grid_height
from contact.search.grid.strip import StripContact, StripGrid
from sie import Array, record

# Cells to a shortest length of the profile, at first and in the end, bounds of how many that makes
# of a period at first and in the end, and the tolerance of their contact.
_CELLS = 1
_CELLS_FINELY = 4
_FEWEST = 2**9
_MOST = 2**12
_FINEST = 2**14
ROUGHLY = 1e-3
# Cells that tell the room beside the border. How far the centre may go from the first one, over the
# gap that is cut, or the room beside the borders, and over the period.
_TELLING = 8
_REACH = 2.0
_FARTHEST = 0.125


@record
class AtCentre:
    """A strip about a centre, all but its contact scaled. beside: room beside both borders; unrest:
    why it is not where its centre stays.
    """

    centre: float
    strip: StripContact
    beside: tuple[float, float]
    period: float
    cell: float
    unrest: Unrest | None

    @property
    def touches(self) -> bool:
        return self.strip.touches_border

    @property
    def room(self) -> float:
        return max(self.beside[0], 0.0) + max(self.beside[1], 0.0)

    @property
    def miss(self) -> float:
        """Of the middle of the outermost ends, less the centre."""
        return 0.5 * (self.beside[0] - self.beside[1])

    @property
    def balance(self) -> float:
        """The same by the angle of the strip up to which the gaps at its borders reach: these go
        straight with what is not known.
        """
        left, right = (
            math.copysign(math.sqrt(abs(room) / self.period), room) for room in self.beside
        )
        return left - right

    @property
    def told(self) -> bool:
        """Whether the grid tells the gaps."""
        return self.room >= _TELLING * self.cell


Kind = TypeVar("Kind", bound=AtCentre)


class StripsOnGrids(Generic[Kind]):
    """Strips of a scaled problem under a scaled load."""

    def __init__(self, problem: Problem, load: float) -> None:
        self.problem, self.load = problem, load
        profile, units, neighbours = problem.profile, problem.units, problem.interaction.neighbours
        assert problem.period is not None and profile.period is not None
        self.period = problem.period
        response = Response(units.E_star, False, neighbours, rest=problem.operator.strip_rest)
        self.grid = StripGrid(
            response, profile.period, profile.feature, even_in_angle(problem) and not neighbours
        )
        features = 0.0 if profile.feature is None else profile.period / profile.feature
        self.points, self.finest = (
            2
            ** int(
                np.clip(
                    np.ceil(np.log2(max(cells * features, 1.0))),
                    math.log2(_FEWEST),
                    math.log2(most),
                )
            )
            for cells, most in ((_CELLS, _MOST), (_CELLS_FINELY, _FINEST))
        )
        # A body between corners is never cut.
        self.farthest = self.period * (_FARTHEST if profile.support is None else 1.0)

    def look(self, centre: float, near: Kind) -> Kind:
        """The strip about a centre, from another one."""
        raise NotImplementedError

    def at_rest(self, here: Kind, cut: float, finely: bool = False) -> Kind:
        """The strip where its centre stays, roughly, from one near by; or the last one looked at,
        with its unrest, where there is none. cut: the width of the gap that is cut; finely: on the
        finest grids, even where a coarse one tells all.
        """
        first, reach = here.centre, max(cut, here.room)
        while True:
            here = self.look(here.centre, here)
            here, unrest = settled(
                self.look, here, min(_REACH * max(reach, here.room), self.farthest)
            )
            if self.points >= self.finest or (
                unrest is None and rests(here) and here.told and not finely
            ):
                return replace(here, unrest=unrest)
            self.points = min(4 * self.points, self.finest)
            here = replace(here, centre=here.centre if unrest is None else first)

    def strip(
        self, amplitude: float, centre: float, points: int, tol: float, near: StripContact | None
    ) -> StripContact:
        """The contact of the strip under a nominal pressure."""
        column = self.problem.about(centre).columns[0].primitive
        assert column is not None
        return self.proposed(
            partial(pressed, self.problem, amplitude, column), self.load, centre, points, tol, near
        )

    def proposed(
        self,
        height: Callable[[Array], Array],
        load: float,
        centre: float,
        points: int,
        tol: float,
        near: StripContact | None,
    ) -> StripContact:
        units = self.problem.units
        middle = float(units.x(np.array(centre)))
        return self.grid.contact(height, middle, load * units.load, points, tol, near)

    def beside(self, strip: StripContact) -> tuple[float, float]:
        """Its room beside both borders."""
        left, right = strip.beside
        return left / self.problem.units.length, right / self.problem.units.length


class PressedStrip(StripsOnGrids[AtCentre]):
    """Strips under a nominal pressure that stays."""

    def __init__(self, problem: Problem, load: float, amplitude: float) -> None:
        super().__init__(problem, load)
        self.amplitude = amplitude

    def about(self, centre: float, points: int, tol: float, near: StripContact | None) -> AtCentre:
        """The strip about a centre."""
        strip = self.strip(self.amplitude, centre, points, tol, near)
        return AtCentre(
            centre,
            strip,
            self.beside(strip),
            self.period,
            strip.cell / self.problem.units.length,
            None,
        )

    def look(self, centre: float, near: AtCentre) -> AtCentre:
        return self.about(centre, self.points, ROUGHLY, near.strip)


def even_in_angle(problem: Problem) -> bool:
    """Whether grids even in the angle serve: a strip of a half-plane, and a profile without
    corners.
    """
    profile = problem.profile
    corners = len(profile.kinks) + len(profile.algebraic_points)
    return problem.operator.strip_rest is None and profile.support is None and corners == 0


def pressed(problem: Problem, nominal: float, column: Callable[[Array], Array], x: Array) -> Array:
    """The shape [m] with what the nominal pressure beyond the strip adds to it."""
    units = problem.units
    return grid_height(problem.profile, x) + nominal * units.height * np.asarray(
        column(units.scaled(x))
    )
