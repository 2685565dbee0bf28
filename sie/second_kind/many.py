"""Equations with kappa on many zones: fast sums and GMRES in place of a matrix.

On a zone, the zone's own density sum c_n S_n gives the left side kappa phi + T phi = -sum c_n
D_(n-1), with the polynomials D_n of `sie.basis.weighted`. So the rows are the coefficients of the
equation in the polynomials D_(k-1), k = 1 ... m,

    -c_k + (coefficient of the field of other zones and images) = g_k,

and the coefficients c_0 follow from the totals of the zones, or from the prescribed intensities if
each zone has one fixed bounded end. The fields of other zones are small and smooth, so the rows are
close to minus the identity, and GMRES needs few steps.

Far from a zone, its field is that of a density sum m_l T_l / sqrt(1 - t^2) with the moments m_l of
`JacobiFunctions.moments`. So the tree of `sie.trees` sums the fields of far zones. A table of the
transforms of S_n gives the fields of near zones.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np
from scipy.linalg import norm

from sie.basis import chebyshev, lazy
from sie.basis.data import DIGITS, EPS, SUM_ROUNDING, Array, Index, record
from sie.basis.interval import Outside, decay_rate
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.dense import modes
from sie.dense.system import Layout
from sie.equation.conditions import Linear, Rows, ZoneTotals
from sie.equation.equation import Equation
from sie.fast.iteration import OPTIONS as ITERATION
from sie.second_kind.system import SecondKindRows, alike, targets_at
from sie.states.options import CHECK_ANGLES
from sie.trees.far import FarSum, Nested, reaches
from sie.trees.krylov import gmres
from sie.trees.panels import panels_over
from sie.trees.tree import TERMS, Pairs, Tree, apart

# Type of a function from the number of modes of a zone to (1 + t, 1 - t) of points on it.
PointsOf = Callable[[int], tuple[Array, Array]]


def lacks_fast_fields(equation: Equation, zones: Zones) -> str | None:
    """The reason, as a message, why fields cannot be summed by trees; None if they can."""
    if len(zones) < 2:
        return "fast sums need at least two zones"
    if zones.weight.is_complex:
        return "fast sums do not support a complex kappa"
    if zones.have_values:
        return "with kappa, fast sums do not support given values of the density at ends"
    if zones.follow_ends:
        return "with kappa, fast sums do not support prescribed intensities of free ends"
    if not reaches(equation.kernel, zones) or panels_over(equation.kernel, zones) is not None:
        return "with kappa, fast sums do not support this kernel"
    return None


def unfit(equation: Equation, zones: Zones) -> str | None:
    """The reason, as a message, why fast sums with kappa do not apply; None if they do."""
    lacking = lacks_fast_fields(equation, zones)
    if lacking is not None:
        return lacking
    if equation.columns:
        return "with kappa, fast sums need a condition on potentials if the equation has columns"
    kinds = [type(condition) for condition in equation.conditions]
    held = sorted(sum(zones.fixed_bounded, []))
    by_totals = kinds == [ZoneTotals] and not held
    if not by_totals and (kinds or held != list(range(len(zones)))):
        return (
            "with kappa, fast sums need either sie.ZoneTotals as the only condition and no bounded "
            "fixed end, or no condition and one bounded fixed end on each zone"
        )
    return None


def nodes_of(m: int) -> tuple[Array, Array]:
    """(1 + t, 1 - t) at the zeros t of U_m."""
    _, right, left = chebyshev.lobatto(m)
    return left[1:-1], right[1:-1]


def between_nodes(m: int) -> tuple[Array, Array]:
    """(1 + t, 1 - t) at the check points t = cos(CHECK_ANGLES), the same for any number m."""
    return 2 * np.cos(0.5 * CHECK_ANGLES) ** 2, 2 * np.sin(0.5 * CHECK_ANGLES) ** 2


@record
class FieldSums:
    """Field of all zones and their images on each zone, without the zone's own field."""

    zones: Zones
    layout: Layout
    far: FarSum

    @classmethod
    def of(cls, zones: Zones, kernel: Kernel, layout: Layout) -> Self:
        """The `FieldSums` of the given zones, with a new tree."""
        nested = Nested(Tree.over(zones.a, zones.b, zones.rest))
        return cls(zones, layout, FarSum(nested, nested, kernel))

    @cached_property
    def groups(self) -> list[tuple[Any, int, Index, Index]]:
        """For each kappa and number m of modes: (basis, m, zones, unknowns of these zones)."""
        return [
            (basis, m, group, self.layout.offset[group][:, None] + np.arange(m + 1))
            for basis, m, group in alike(self.zones, self.layout.m)
        ]

    @property
    def size(self) -> int:
        """Number of terms per evaluation: entries of the near matrix plus terms of far series."""
        return int(self.near.nnz) + len(self.far.far) * TERMS

    @cached_property
    def near(self) -> Any:
        """Sparse matrix from the unknowns to the field of near zones at the nodes of each zone."""
        return self._near(nodes_of)

    @cached_property
    def near_between(self) -> Any:
        """Sparse matrix like `near`, but to the field at CHECK_ANGLES between the nodes."""
        return self._near(between_nodes)

    def _near(self, points: PointsOf) -> Any:
        zones, layout, pairs = self.zones, self.layout, self.far.near
        other = ~((pairs.target == pairs.source) & (pairs.shift == 0.0))
        target, source, shift = pairs.target[other], pairs.source[other], pairs.shift[other]
        sign, gap = apart(zones, Pairs(target, source, shift))
        # The transforms of a zone's modes decay with the mode number, most slowly at the point
        # nearest to the zone. The rate of decay there gives the number of modes above round-off.
        first = np.array([points(int(n))[0].min() for n in range(1, int(layout.m.max()) + 1)])
        excess = (gap + zones.half[target] * first[layout.m[target] - 1]) / zones.half[source]
        need = np.ceil(DIGITS / decay_rate(excess) / 8).astype(np.intp) * 8
        terms = np.minimum(layout.m[source] + 1, need)
        kappa = zones.weight.kappa
        assert kappa is not None
        number = np.unique(kappa, return_inverse=True)[1]
        key = np.column_stack((number[source], layout.m[target], terms))
        kinds, kind = np.unique(key, axis=0, return_inverse=True)
        order = np.argsort(kind.ravel(), kind="stable")
        cuts = np.searchsorted(kind.ravel()[order], np.arange(len(kinds) + 1))
        counts = np.array([len(points(int(n))[0]) for n in layout.m])
        first_row = np.cumsum(counts) - counts
        basis_of = {int(number[group[0]]): basis for basis, _, group, _ in self.groups}
        data, rows, columns = [], [], []
        for (which, m, count), lo, hi in zip(kinds.tolist(), cuts[:-1], cuts[1:], strict=True):
            some = order[lo:hi]
            left, right = points(m)
            w = zones.half[source[some]][:, None]
            inner = np.where(sign[some][:, None] > 0, left, right) * zones.half[target[some], None]
            seen = Outside(sign[some][:, None], (gap[some][:, None] + inner) / w)
            table = basis_of[which].transforms(count, seen)
            row = first_row[target[some]][:, None] + np.arange(len(left))
            column = layout.offset[source[some]][:, None] + np.arange(count)
            data.append(table.ravel())
            rows.append(np.broadcast_to(row[:, :, None], table.shape).ravel())
            columns.append(np.broadcast_to(column[:, None, :], table.shape).ravel())
        sparse = lazy.module("scipy.sparse")
        none = [np.zeros(0, dtype=np.intp)]
        entries = np.concatenate(data or [np.zeros(0)])
        places = (np.concatenate(rows or none), np.concatenate(columns or none))
        shape = (int(counts.sum()), layout.size)
        return sparse.coo_array((entries, places), shape=shape).tocsr()

    def _far_series(self, y: Array, rough: bool) -> Array:
        """Chebyshev series (Z, TERMS), on each zone, of the transform of all zones far from it."""
        return self._far(y, rough)[0]

    def _far(self, y: Array, rough: bool) -> tuple[Array, Array, Array]:
        """(series of the transform, two parts of the potential in the middle of each zone).

        Both are due to far zones, whose densities the unknowns y determine.
        """
        leaves = np.zeros((len(self.zones), TERMS))
        for basis, m, group, unknowns in self.groups:
            leaves[group] = y[unknowns] @ basis.moments(m + 1, TERMS).T
        leaves[:, 1:] *= 0.5
        return self.far(leaves * self.zones.half[:, None], rough)

    def __call__(self, y: Array, rough: bool = False) -> Array:
        """Coefficients of the other zones' field, zone by zone.
        They belong to its expansion in the polynomials D_k, which the head of this file defines.

        rough: whether an error of 1e-7 of the whole far field is small enough.
        """
        return self.projected(self.near @ y, self.far_rows(self._far_series(y, rough)))

    def fields_and_middles(self, y: Array, rough: bool) -> tuple[Array, Array]:
        """(coefficients as from `__call__`, potential of far zones in the middle of each zone)."""
        series, middle, rest = self._far(y, rough)
        return self.projected(self.near @ y, self.far_rows(series)), middle + rest

    @staticmethod
    def far_rows(series: Array) -> Array:
        """Coefficients of U_(k-1), from coefficients of T_l (Z, TERMS) of the same functions."""
        far = 0.5 * series
        far[:, :-2] -= 0.5 * series[:, 2:]
        far[:, 0] += 0.5 * series[:, 0]
        return np.asarray(far)

    def near_potential(self) -> Any:
        """Sparse matrix from the unknowns to the potential of near zones in each zone's middle."""
        zones, layout, pairs = self.zones, self.layout, self.far.near
        other = ~((pairs.target == pairs.source) & (pairs.shift == 0.0))
        target, source, shift = pairs.target[other], pairs.source[other], pairs.shift[other]
        sign, gap = apart(zones, Pairs(target, source, shift))
        excess = (gap + zones.half[target]) / zones.half[source]
        data, rows, columns = [], [], []
        for basis, m, group, _ in self.groups:
            some = np.flatnonzero(np.isin(source, group))
            w = zones.half[source[some]]
            table = basis.potentials(m + 1, Outside(sign[some], excess[some]))
            table[:, 0] += np.log(w / self.far.kernel.datum)
            data.append((table * w[:, None]).ravel())
            rows.append(np.repeat(target[some], m + 1))
            columns.append((layout.offset[source[some]][:, None] + np.arange(m + 1)).ravel())
        sparse = lazy.module("scipy.sparse")
        places = np.concatenate(rows), np.concatenate(columns)
        shape = (len(zones), layout.size)
        return sparse.coo_array((np.concatenate(data), places), shape=shape).tocsr()

    def projected(self, at_nodes: Array, far: Array | None = None) -> Array:
        """Coefficients of a field in the polynomials D_(k-1) (file's head) on each zone in turn.

        k runs from 1 to the number m of modes. The field is the sum of its part with values
        `at_nodes` and of the series `far` in U_(k-1).
        """
        out, first = np.empty(len(at_nodes)), np.cumsum(self.layout.m) - self.layout.m
        for basis, m, group, _ in self.groups:
            place = first[group][:, None] + np.arange(m)
            u = chebyshev.u_coefficients(at_nodes[place])
            if far is not None:
                u[:, : min(m, TERMS)] += far[group, : min(m, TERMS)]
            out[place] = u @ basis.from_u(m).T
        return out

    def between(self, y: Array) -> Array:
        """Field of other zones on each zone, at CHECK_ANGLES between its nodes (Z, points)."""
        series = self._far_series(y, False)
        waves = np.cos(np.arange(TERMS)[:, None] * CHECK_ANGLES)
        return np.asarray(series @ waves + (self.near_between @ y).reshape(-1, len(CHECK_ANGLES)))


@dataclass(frozen=True, eq=False)
class ManyRows(Rows):
    """Linear system of an equation with kappa on many zones, without its matrix."""

    dense: SecondKindRows
    sums: FieldSums = field(repr=False)
    y: Array | None = None

    @classmethod
    def of(cls, system: SecondKindRows, far: FarSum | None = None) -> Self:
        """The linear system of the equation of `system`.

        far: sums over far zones; new ones are computed if it is None.
        """
        zones, layout = system.zones, system.layout
        if far is None:
            return cls(system, FieldSums.of(zones, system.equation.kernel, layout))
        return cls(system, FieldSums(zones, layout, far))

    @property
    def zones(self) -> Zones:  # type: ignore[override]
        return self.dense.zones

    @cached_property
    def others(self) -> Index:
        """Indices of the coefficients c_k with k > 0, one index for each row of the equation."""
        layout = self.dense.layout
        return np.delete(np.arange(layout.coefficients), layout.offset)

    @cached_property
    def held(self) -> tuple[Index, Array | None]:
        """(zone of each condition, values of p_k, k > 0, at that zone's bounded fixed end).

        p_k are the orthogonal polynomials of the basis functions. The values are None if the
        conditions prescribe the totals of the zones.
        """
        left, right = self.zones.fixed_bounded
        if not left and not right:
            return np.arange(len(self.zones)), None
        is_left = np.isin(np.arange(len(self.zones)), left)
        out, first = np.empty(len(self.others)), np.cumsum(self.dense.layout.m)
        for basis, m, group, _ in self.sums.groups:
            at_left, at_right = basis.edge_values(m + 1)
            place = (first - self.dense.layout.m)[group][:, None] + np.arange(m)
            out[place] = np.where(is_left[group][:, None], at_left[1:], at_right[1:])
        return np.array([*left, *right], dtype=np.intp), out

    def conditions(self) -> tuple[Array, Array]:
        """(right sides of the side conditions divided by scales, the scales)."""
        zones, equation = self.zones, self.dense.equation
        if equation.conditions:
            _, constants, totals = equation.conditions[0].rows(self)
            scale = np.pi * zones.half
            return (totals - constants) / scale, scale
        sides = list(zip((zones.left, zones.right), zones.fixed_bounded, strict=True))
        wanted = np.array([ends[i].intensity for ends, chosen in sides for i in chosen])
        scales = zip(zones.edge_scale, zones.fixed_bounded, strict=True)
        scale = np.concatenate([one[chosen] for one, chosen in scales if chosen])
        return wanted / scale, scale

    @cached_property
    def right(self) -> Array:
        """Coefficients of the right side in the polynomials D_k (file's head), zone by zone."""
        return self.sums.projected(self.dense.right_side(self.dense.points[0]))

    def residuals(self, y: Array) -> Array:
        """Residual of the equation at CHECK_ANGLES of the zones, times sin(theta) (Z, points)."""
        zones, out = self.zones, self.sums.between(y)
        left, right = between_nodes(0)
        for basis, m, group, unknowns in self.sums.groups:
            out[group] -= y[unknowns[:, 1:]] @ basis.images.table(m, left, right).T
        g = self.dense.right_side(targets_at(zones, np.broadcast_to(CHECK_ANGLES, out.shape)))
        return np.asarray((out - g.reshape(out.shape)) * np.sin(CHECK_ANGLES))

    def totals(self) -> Linear:
        layout, scale = self.dense.layout, np.pi * self.zones.half
        first = np.zeros(len(scale)) if self.y is None else self.y[layout.offset]
        return (scale * first)[:, None], self.known_totals

    @cached_property
    def known_totals(self) -> Array:
        """Integral over each zone (Z,) of the part of the density that is known in closed form."""
        known = np.zeros(len(self.zones))
        for one in self.dense.jumps:
            known[one.zone] += self.zones.half[one.zone] * one.total
        return known


class ManySolver:
    """Iterative solver of the linear system `ManyRows`, for any right side.

    Right sides have the rows of the equation first. Then come the totals divided by pi times the
    half width, or the intensities at bounded ends divided by `Zones.edge_scale`.

    tolerance: relative to the unknowns of each zone, 0 for the limit of round-off; error: remaining
    error of each zone's unknowns (Z,) in the last solve to that tolerance; is_loose: whether the
    first tolerance was far from round-off, as in the first steps of Newton's method; iterations:
    number of steps of GMRES so far.
    """

    def __init__(self, rows: ManyRows, tolerance: float) -> None:
        self.rows, self.tolerance, self.iterations = rows, tolerance, 0
        # A pair for round-off estimates: (unknowns of a solution, changes of the density's
        # coefficients due to random errors of the equations). It is None before the first estimate.
        self.random_changes: tuple[Array, Array] | None = None
        self.is_loose = tolerance > ITERATION.correction
        self.error = np.zeros(len(rows.zones))
        self.order, self.edge_values = rows.held

    def _firsts(self, v: Array, given: Array) -> Array:
        """Coefficients c_0 (Z,), from the other coefficients `v` and the conditions' values."""
        m = self.rows.dense.layout.m
        out = np.zeros(len(m))
        out[self.order] = given
        if self.edge_values is None:
            return out
        return out - np.add.reduceat(self.edge_values * v, np.cumsum(m) - m)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.rows.dense.layout.size

    def __call__(
        self, right: Array, tolerance: float | None = None, guess: Array | None = None
    ) -> Array:
        """Solve for the unknowns of the linear system, for the given right sides.

        tolerance: replaces the solver's own tolerance; guess: a first guess of the unknowns.
        """
        rows, layout = self.rows, self.rows.dense.layout
        others, equations = rows.others, len(rows.others)
        none = np.zeros(len(layout.m))
        rounding = 4 * EPS * np.sqrt(len(layout.m))
        wanted = max(self.tolerance if tolerance is None else tolerance, float(rounding))
        y = np.zeros(layout.size)
        y[layout.offset] = self._firsts(np.zeros(equations), right[equations:])
        given = rows.sums(y, wanted > ITERATION.correction) - right[:equations]

        def operator(v: Array, rough: bool) -> Array:
            y = np.zeros(layout.size)
            y[others], y[layout.offset] = v, self._firsts(v, none)
            return v - rows.sums(y, rough)

        scale = self._scale(given, right[equations:])
        start = None if guess is None else guess[others]
        x, left_over = self._iterated(operator, given, scale, start, wanted)
        if tolerance is None:
            starts = np.cumsum(layout.m) - layout.m
            self.error = np.maximum.reduceat(np.abs(left_over * scale), starts)
        y[others], y[layout.offset] = x, self._firsts(x, right[equations:])
        return y

    def _iterated(
        self,
        operator: Callable[[Array, bool], Array],
        given: Array,
        scale: Array,
        start: Array | None,
        wanted: float,
    ) -> tuple[Array, Array]:
        """(solution x of operator(x) = given, by GMRES and corrections; residual / `scale`).

        operator: its second argument says whether rough sums suffice. start: a first guess of x.
        wanted: largest norm of the residual divided by `scale`.
        """
        is_rough = wanted > ITERATION.correction
        x = np.zeros(len(given)) if start is None else start
        left_over = (given if start is None else given - operator(x, is_rough)) / scale
        before = float(norm(left_over))
        while True:
            part = max(wanted, ITERATION.correction * before)
            found = gmres(lambda v: operator(v * scale, True) / scale, left_over, part)
            self.iterations += found.steps
            x = x + found.x * scale
            left_over = (given - operator(x, is_rough)) / scale
            size, before = before, float(norm(left_over))
            stagnant = not before <= np.sqrt(ITERATION.correction) * size
            if found.steps == 0 or before <= 4 * wanted or stagnant:
                return x, left_over

    def _scale(self, given: Array, firsts: Array) -> Array:
        """Scale of each unknown: the largest of |`given`| and |`firsts`| on its zone.
        If this is very small, a small fraction of the largest scale of all zones replaces it.
        """
        m = self.rows.dense.layout.m
        largest = np.maximum.reduceat(np.abs(given), np.cumsum(m) - m)
        largest = np.maximum(largest, np.abs(firsts))
        top = float(largest.max())
        least = ITERATION.min_scale * top if top > 0 else 1.0
        return np.repeat(np.maximum(largest, least), m)

    def row_errors(self, y: Array, residuals: Array, missing: Array) -> Array:
        """Error of each equation: round-off, truncated coefficients, residual between the nodes.

        The errors of the equation's rows are errors of values at the nodes times sin(theta).
        missing: estimated sum of the truncated coefficients of each zone (Z,).
        """
        rows, zones, layout = self.rows, self.rows.zones, self.rows.dense.layout
        table = layout.padded(y)
        sizes = np.abs(table).max(axis=1)
        starts = np.cumsum(layout.m) - layout.m
        # Row k is the coefficient of sin(k theta) in the equation's values times sin(theta). So the
        # mean square of these values on a zone is about half the sum of squares of the rows.
        squares = rows.right**2 + y[rows.others] ** 2
        terms = np.sqrt(0.5 * np.add.reduceat(squares, starts))
        last = np.zeros(layout.size)
        last[layout.offset + layout.m] = missing
        truncated = np.add.reduceat(np.abs(rows.sums(last, rough=True)), starts)
        # `places` is the error of the right side g due to the rounding of the nodes. The slope of g
        # is bounded by the sum of k |g_k| over the coefficients g_k, without the constant term D_0.
        varies = np.where(np.isin(np.arange(layout.coefficients), layout.offset + 1), 0.0, 1.0)
        orders = np.concatenate([np.arange(1, m + 1) for m in layout.m.tolist()])
        slopes = np.add.reduceat(orders * varies[rows.others] * np.abs(rows.right), starts)
        places = modes.place_rounding(zones, np.arange(len(zones))) * slopes
        residual = np.abs(residuals).max(axis=1) - SUM_ROUNDING * sizes
        by_zone = EPS * terms + truncated + places + np.maximum(residual, 0.0) + self.error
        return np.concatenate(
            (np.repeat(by_zone, layout.m), EPS * np.abs(y[layout.offset])[self.order])
        )

    def projected(self, values: Array) -> Array:
        """Right sides for the rows of coefficients, from right sides for the rows at the nodes.

        values: sin(theta) times a function at the nodes, followed by the totals.
        """
        count, sines = len(self.rows.others), self.rows.dense.points[1]
        of_equation = self.rows.sums.projected(values[:count] / sines)
        return np.concatenate((of_equation, values[count:]))
