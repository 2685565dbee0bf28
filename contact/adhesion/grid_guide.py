"""The grid guide: first guesses of intervals of tension, grown or shrunk on a grid.

The contact under a tension on intervals I is the frictionless contact of the surfaces that the
tension has deformed (contact.search.grid.conjugate_gradient). With the reach h of the tension, the
map

    I -> {gap < h}

is monotone on a half-plane under a fixed load. Intervals whose ends are all driven outward grow to
the least equilibrium that contains them. Intervals whose ends are all driven inward shrink to the
greatest equilibrium inside them. On a grid, an iteration of the map costs a few Fourier transforms.
The reach is taken a little smaller for growth and a little larger for shrinking. In spite of the
error of the grid, the intervals found then lie inside the intervals of the equilibrium after
growth, and contain them after shrinking.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

import sie
from contact.adhesion.curve import ACCURACY, Closed
from contact.adhesion.inner_contact import ContactLost
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import NotConverged
from contact.formulation.problem import Problem
from contact.formulation.tables import runs_of
from contact.search.grid.conjugate_gradient import GridState, Influence, solve_grid
from contact.search.grid.nested_grids import MOST_POINTS, grid_height, zones_of
from contact.search.grid.proposals import placed, whole_response
from sie import Array, Mask, record


@dataclass(frozen=True)
class GridOptions:
    """Options of the grid on which intervals of tension are moved."""

    # Least number of cells for each feature of the profile, and for each strip of tension.
    cells: int = 32
    # Largest number of cells of the grid, unless the profile itself needs more cells.
    max_points: int = 2**16


GRID = GridOptions()


@record
class GridRest:
    """Scaled intervals of tension in equilibrium (m, 2), and the zones of contact inside them."""

    table: Array
    zones: Array
    state: GridState


@record
class GridGuide(sie.Kept):
    """A problem under a law with tension, discretised on a grid.

    x0, width: left end and width of the grid [m], which covers a period, or a window in isolated
    contact. by_load: whether the control is a load, else an approach.
    """

    problem: Problem
    x0: float
    width: float
    points: int
    by_load: bool

    @classmethod
    def of(cls, problem: Problem, table: Array | None, by_load: bool) -> "GridGuide | None":
        """The grid problem around the scaled intervals `table`; None if it needs too many cells."""
        profile, law, units = problem.profile, problem.law, problem.units
        if problem.period is not None and profile.period is not None:
            x0, width = profile.x0, profile.period
        else:
            assert table is not None
            around = (MOVES.widening - 1.0) * float(table[-1, 1] - table[0, 0])
            lo, hi = problem.borders
            window = units.x(
                np.array([max(lo, table[0, 0] - around), min(hi, table[-1, 1] + around)])
            )
            x0, width = float(window[0]), float(window[1] - window[0])
        feature = width if profile.feature is None else profile.feature
        strip = 0.25 * math.pi * units.E_star * law.reach / law.tension
        least = GRID.cells * width / feature
        wanted = max(least, GRID.cells * width / strip)
        # With more cells than the maximum in the next line, the gradient flow without a grid takes
        # less time.
        if not wanted <= max(GRID.max_points, min(least, MOST_POINTS)):
            return None
        return cls(problem, x0, width, 2 ** math.ceil(math.log2(wanted)), by_load)

    @property
    def cell(self) -> float:
        """Width of a cell [m]."""
        return self.width / self.points

    @property
    def repeats(self) -> bool:
        return self.problem.period is not None

    @cached_property
    def x(self) -> Array:
        """Middles of the cells [m]."""
        return np.asarray(self.x0 + self.cell * (np.arange(self.points) + 0.5))

    @cached_property
    def heights(self) -> Array:
        profile = self.problem.profile
        return (
            grid_height(profile, self.x)
            if self.by_load
            else np.asarray(profile.height(self.x), dtype=np.float64)
        )

    @cached_property
    def influence(self) -> Influence:
        return whole_response(self.problem).on(self.points, self.cell)

    def resting(
        self,
        table: Array | None,
        value: float,
        sign: float,
        reach: float,
        warm_start: GridState | None = None,
    ) -> GridRest:
        """Intervals of tension and zones in equilibrium, after growth (sign 1) or shrinking (-1).

        reach: factor on the law's reach. table: the first intervals; None for tension in all of a
        period. Raises ContactLost, Closed, or NotConverged at the border of the window.
        """
        limit = reach * self.problem.law.reach
        share = np.ones(self.points) if table is None else self._shares(table)
        start = None if warm_start is None else warm_start.pressure
        for _ in range(LIMITS.max_steps):
            state = self._contact(share, value, start)
            new = shares_below(state.gap - limit)
            new = np.maximum(share, new) if sign > 0 else np.minimum(share, new)
            change, share, start = float(np.abs(new - share).max()), new, state.pressure
            if change < MOVES.short_move:
                break
        below = state.gap < limit
        if np.any(~below & (share == 1.0) if sign > 0 else below & (share == 0.0)):
            raise NotConverged(
                "on the coarse grid some ends of the tension advance while others recede"
            )
        found = self._table(below, state.gap - limit)
        return GridRest(found, placed(self.problem, zones_of(state, self.x)), state)

    def least_value(self, table: Array | None, value: float) -> float:
        """Approximate lowest value of the control at which shrinking intervals do not vanish.

        It is found by bisection between `value` and a value without contact.
        """
        high, low = value, self._lost(value)
        warm_start: GridRest | None = None
        least = ACCURACY.coarse * (high - low)
        while high - low > least:
            middle = 0.5 * (high + low)
            try:
                warm_start = self.resting(
                    table if warm_start is None else warm_start.table,
                    middle,
                    -1.0,
                    1.0,
                    None if warm_start is None else warm_start.state,
                )
                high = middle
            except Closed:
                high = middle
            except ContactLost:
                low = middle
        return high

    def _lost(self, value: float) -> float:
        """A value of the control at which no contact is left."""
        problem, law = self.problem, self.problem.law
        if self.by_load:
            return -law.tension * self.width / problem.units.load
        step = law.reach / problem.units.height
        for _ in range(LIMITS.max_iterations):
            try:
                self.resting(None, value - step, -1.0, 1.0)
            except ContactLost:
                return value - step
            except Closed:
                pass
            step *= 2.0
        raise NotConverged("no approach was found at which the surfaces are separate")

    def _contact(self, share: Array, value: float, start: Array | None) -> GridState:
        units, tension = self.problem.units, self.problem.law.tension
        deformed = self.heights - self.influence.apply(tension * share)
        if self.by_load:
            load = value * units.load + tension * float(share.sum()) * self.cell
            if not load > 0.0:
                raise ContactLost
            state = solve_grid(
                deformed, self.influence, load=load, start=start, tol=ACCURACY.coarse
            )
        else:
            state = solve_grid(
                deformed,
                self.influence,
                level=self.problem.lowest + value * units.height,
                start=start,
                tol=ACCURACY.coarse,
            )
        if not state.load > 0.0:
            raise ContactLost
        return state

    def _shares(self, table: Array) -> Array:
        """Fraction of each cell that is covered by the intervals of tension."""
        rows = np.asarray(self.problem.units.x(table)) - self.x0
        edges = self.cell * np.arange(self.points + 1)
        out = np.zeros(self.points)
        for shift in (-self.width, 0.0, self.width) if self.repeats else (0.0,):
            for a, b in rows + shift:
                if b > 0.0 and a < self.width:
                    out += (
                        np.clip(np.minimum(edges[1:], b) - np.maximum(edges[:-1], a), 0.0, None)
                        / self.cell
                    )
        return np.minimum(out, 1.0)

    def _table(self, below: Mask, above: Array) -> Array:
        """Scaled intervals in which the gap on the grid is below a limit.

        below: cells with a gap below the limit; above: the gap minus the limit.
        """
        if self.repeats and below.all():
            raise Closed
        if not below.any():
            raise ContactLost
        if not self.repeats and (below[0] or below[-1]):
            raise NotConverged("the tension reaches the border of the coarse grid")
        n = self.points
        first, last = np.array(runs_of(below, self.repeats)).T
        before, after = above[(first - 1) % n], above[(last + 1) % n]
        left = first - above[first] / (above[first] - before)
        right = last + above[last % n] / (above[last % n] - after)
        return np.asarray(
            self.problem.units.scaled(self.x[0] + self.cell * np.column_stack((left, right)))
        )


def shares_below(above: Array) -> Array:
    """Fraction of each cell in which a function is negative, given its values at cell middles.
    The function is linear between neighbouring middles.
    """
    half = 0.5 * (above + np.roll(above, -1))
    return 0.5 * (_part_below(above, half) + np.roll(_part_below(half, np.roll(above, -1)), 1))


def _part_below(a: Array, b: Array) -> Array:
    """Fraction of a length on which a function that varies linearly from a to b is negative."""
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = a / (a - b)
    return np.where(
        (a < 0) & (b < 0), 1.0, np.where(a < 0, crossing, np.where(b < 0, 1.0 - crossing, 0.0))
    )
