r"""A constant tension beside the contact, on a grid: its intervals as they grow or shrink to rest,
many ends and places at once.

Under the tension on intervals I the contact is that of the surfaces which the tension has deformed
(conjugate_gradient.py), and

    I -> {gap < h}

keeps order on a half-plane under a held load, h the reach: from intervals all of whose ends are
driven outward it grows to the least equilibrium that holds them, from such as are driven inward it
shrinks to the greatest within. On a grid that costs a few transforms a round. A reach taken a
little smaller as they grow, and a little larger as they shrink, makes up for what the grid is wrong
by: then these intervals lie within the ones that are looked for, or hold them.
"""

import math
from functools import cached_property

import numpy as np

import sie
from contact.adhesion.curve import Closed
from contact.adhesion.inner_contact import Lost
from contact.errors import NotConverged
from contact.formulation.problem import Problem
from contact.formulation.tables import runs_of
from contact.search.grid.conjugate_gradient import GridState, Influence, solve_grid
from contact.search.grid.nested_grids import MOST_POINTS, grid_height, zones_of
from contact.search.grid.proposals import placed, whole_response
from sie import Array, Mask, record

# Cells to a length over which the profile varies, to the strip that adhesion without range would
# leave, and in all at the least; so many are few, so many times as many as the profile asks for may
# be asked for by strips, and so many at the most.
_PER_FEATURE = 16
_PER_STRIP = 32
_FEWEST = 256.0
_FEW = 2**14
_FINER = 8
_MOST = 2**18
# Beside the intervals of a lone body, over what they span, the window of the grid.
_AROUND = 0.25
# Rounds, the change of a cell's share that ends them, and the tolerance of a contact on the way.
_ROUNDS = 400
_STILL = 0.02
_TOL = 1e-4
# Of the control, between a value that holds a contact and one that does not.
_HALVINGS = 12
_DOUBLINGS = 60


@record
class Resting:
    """Scaled intervals (m, 2), ascending, and the zones of contact within them."""

    table: Array
    zones: Array
    state: GridState


@record
class GridTension(sie.Kept):
    """problem: with the law that has the tension; x0, width: the period, or the window of a lone
    body, that the cells are parts of [m]; by_load: whether the control is a load, else an approach.
    """

    problem: Problem
    x0: float
    width: float
    points: int
    by_load: bool

    @classmethod
    def of(cls, problem: Problem, table: Array | None, by_load: bool) -> "GridTension | None":
        """table: scaled intervals from which ends are to move; None where what the tension acts on
        is too narrow for a grid.
        """
        profile, law, units = problem.profile, problem.law, problem.units
        if problem.period is not None and profile.period is not None:
            x0, width = profile.x0, profile.period
        else:
            assert table is not None
            around = _AROUND * float(table[-1, 1] - table[0, 0])
            lo, hi = problem.borders
            window = units.x(
                np.array([max(lo, table[0, 0] - around), min(hi, table[-1, 1] + around)])
            )
            x0, width = float(window[0]), float(window[1] - window[0])
        feature = width if profile.feature is None else profile.feature
        strip = 0.25 * math.pi * units.E_star * law.reach / law.tension
        least = _PER_FEATURE * width / feature
        wanted = max(least, _PER_STRIP * width / strip)
        # Of few zones on narrow strips the way itself is shorter than so fine a grid.
        if not wanted <= max(_FEW, min(_FINER * least, _MOST), min(least, MOST_POINTS)):
            return None
        return cls(problem, x0, width, 2 ** math.ceil(math.log2(max(wanted, _FEWEST))), by_load)

    @property
    def cell(self) -> float:
        """Width of one [m]."""
        return self.width / self.points

    @property
    def repeats(self) -> bool:
        return self.problem.period is not None

    @cached_property
    def x(self) -> Array:
        """Their middles [m]."""
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
        near: GridState | None = None,
    ) -> Resting:
        """Where intervals, or the whole period, come to that grow (sign 1) or shrink (-1), for so
        many times the reach. Lost, Closed; NotConverged where they come to the border of the
        window.
        """
        limit = reach * self.problem.law.reach
        share = np.ones(self.points) if table is None else self._shares(table)
        start = None if near is None else near.pressure
        for _ in range(_ROUNDS):
            state = self._contact(share, value, start)
            new = shares_below(state.gap - limit)
            new = np.maximum(share, new) if sign > 0 else np.minimum(share, new)
            change, share, start = float(np.abs(new - share).max()), new, state.pressure
            if change < _STILL:
                break
        below = state.gap < limit
        if np.any(~below & (share == 1.0) if sign > 0 else below & (share == 0.0)):
            raise NotConverged("the ends of the tension are not all driven one way")
        found = self._table(below, state.gap - limit)
        return Resting(found, placed(self.problem, zones_of(state, self.x)), state)

    def least_value(self, table: Array | None, value: float) -> float:
        """About the lowest value of the control at which intervals that shrink still come to rest."""
        high, low = value, self._lost(value)
        near: Resting | None = None
        for _ in range(_HALVINGS):
            middle = 0.5 * (high + low)
            try:
                near = self.resting(
                    table if near is None else near.table,
                    middle,
                    -1.0,
                    1.0,
                    None if near is None else near.state,
                )
                high = middle
            except Closed:
                high = middle
            except Lost:
                low = middle
        return high

    def _lost(self, value: float) -> float:
        """A value of the control at which nothing is left."""
        problem, law = self.problem, self.problem.law
        if self.by_load:
            return -law.tension * self.width / problem.units.load
        step = law.reach / problem.units.height
        for _ in range(_DOUBLINGS):
            try:
                self.resting(None, value - step, -1.0, 1.0)
            except Lost:
                return value - step
            except Closed:
                pass
            step *= 2.0
        raise NotConverged("no approach at which the surfaces are apart")

    def _contact(self, share: Array, value: float, start: Array | None) -> GridState:
        units, tension = self.problem.units, self.problem.law.tension
        deformed = self.heights - self.influence.apply(tension * share)
        if self.by_load:
            load = value * units.load + tension * float(share.sum()) * self.cell
            if not load > 0.0:
                raise Lost
            state = solve_grid(deformed, self.influence, load=load, start=start, tol=_TOL)
        else:
            state = solve_grid(
                deformed,
                self.influence,
                level=self.problem.lowest + value * units.height,
                start=start,
                tol=_TOL,
            )
        if not state.load > 0.0:
            raise Lost
        return state

    def _shares(self, table: Array) -> Array:
        """What intervals take of each cell."""
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
        """Scaled intervals in which the gap is below the limit; above: what it has more than that."""
        if self.repeats and below.all():
            raise Closed
        if not below.any():
            raise Lost
        if not self.repeats and (below[0] or below[-1]):
            raise NotConverged("the tension comes to the border of the window")
        n = self.points
        first, last = np.array(runs_of(below, self.repeats)).T
        before, after = above[(first - 1) % n], above[(last + 1) % n]
        left = first - above[first] / (above[first] - before)
        right = last + above[last % n] / (above[last % n] - after)
        return np.asarray(
            self.problem.units.scaled(self.x[0] + self.cell * np.column_stack((left, right)))
        )


def shares_below(above: Array) -> Array:
    """What of each cell lies where a function, linear between the middles of the cells, is below
    zero.
    """
    half = 0.5 * (above + np.roll(above, -1))
    return 0.5 * (_part_below(above, half) + np.roll(_part_below(half, np.roll(above, -1)), 1))


def _part_below(a: Array, b: Array) -> Array:
    """Part of a length on which what goes from a to b is below zero."""
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = a / (a - b)
    return np.where(
        (a < 0) & (b < 0), 1.0, np.where(a < 0, crossing, np.where(b < 0, 1.0 - crossing, 0.0))
    )
