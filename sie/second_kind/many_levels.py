"""Equations with kappa on many zones under conditions on levels, by fast sums and GMRES.

A level is the constant part of the potential on a zone (`SecondKindRows.levels`). The unknowns are
the coefficients c_k, k > 0, of all zones, then c_0 of all zones and the amplitudes of the columns.
The rows of the equation are those of `many`. For the rows of the conditions, the tree gives the
potential of the unknowns' density in the middle of each zone. These rows are multiplied by the
inverse of a small matrix: the matrix of the conditions for densities c_0 / sqrt(1 - t^2) alone. So
all rows are close to the identity, and GMRES needs few steps.

The tree also sums the fields of the densities that jumps of the right side cause.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import lu_factor, lu_solve, norm

from sie.basis.data import EPS, Array, Index, record
from sie.basis.interval import Outside
from sie.basis.zones import Zones
from sie.equation.conditions import Linear, Rows, Trial, asked
from sie.equation.equation import Equation
from sie.second_kind.many import (
    ManyRows,
    ManySolver,
    PointsOf,
    between_nodes,
    lacks_fast_fields,
    nodes_of,
)
from sie.second_kind.state import OPTIONS
from sie.second_kind.system import bases_of, targets_at
from sie.states.options import CHECK_ANGLES
from sie.trees.tree import TERMS, apart

Weight = Callable[[Array], Array]


def _middle(m: int) -> tuple[Array, Array]:
    """(1 + t, 1 - t) in the middle t = 0 of a zone, for any number `m` of modes."""
    return np.ones(1), np.ones(1)


def unfit(equation: Equation, zones: Zones) -> str | None:
    """The reason, as a message, why fast sums do not apply with potentials; None if they do."""
    lacking = lacks_fast_fields(equation, zones)
    if lacking is not None:
        return lacking
    if any(zones.fixed_bounded):
        return (
            "with kappa fast sums support bounded fixed ends only if each zone has one and there "
            "is no side condition"
        )
    if len(zones) > OPTIONS.max_unknowns:
        return (
            "with kappa fast sums with a condition on potentials support at most "
            f"{OPTIONS.max_unknowns} zones"
        )
    if not any(condition.levels for condition in equation.conditions):
        return "with kappa fast sums need a condition on potentials"
    primitives = [part.primitive for part in (equation.forcing, *equation.columns)]
    if any(one is None for one in primitives):
        return "a condition on potentials needs the primitives of the right side and of columns"
    return None


class LevelRows(ManyRows):
    """Linear system of an equation with conditions on potentials, for many zones."""

    # The next two methods give fields of the density's part that jumps of the right side cause.
    # This part is known in closed form.
    @cached_property
    def _known_far(self) -> tuple[Array, Array]:
        """(series of the transform, potential in each zone's middle) due to jumps on far zones."""
        leaves = np.zeros((len(self.zones), TERMS))
        for one in self.dense.jumps:
            leaves[one.zone] += one.moments(TERMS)
        leaves[:, 1:] *= 0.5
        series, middle, rest = self.sums.far(leaves * self.zones.half[:, None])
        return series, middle + rest

    def _known_near(self, points: PointsOf, potential: bool) -> Array:
        """Transform or potential at the points of each zone, due to jumps in it and in near zones.

        In the potential, a zone's own jumps add kappa times the integral of their density up to the
        point.
        """
        zones, layout = self.zones, self.sums.layout
        counts = np.array([len(points(int(n))[0]) for n in layout.m])
        out, first = np.zeros(int(counts.sum())), np.cumsum(counts) - counts
        pairs = self.sums.far.near
        sign, gap = apart(zones, pairs)
        own = (pairs.target == pairs.source) & (pairs.shift == 0.0)
        order = np.argsort(pairs.source, kind="stable")
        starts = np.searchsorted(pairs.source[order], np.arange(len(zones) + 1))
        for one in self.dense.jumps:
            w, level = zones.half[one.zone], 0.0
            if potential:
                level = one.total / np.pi * float(np.log(w / self.dense.equation.kernel.datum))
            seen = order[starts[one.zone] : starts[one.zone + 1]]
            excess, signs, rows = [], [], []
            for k in seen.tolist():
                target = int(pairs.target[k])
                left, right = points(int(layout.m[target]))
                row = first[target] + np.arange(len(left))
                if own[k]:
                    out[row] += (
                        w * (level + one.own_level(left, right))
                        if potential
                        else one.own(left, right)
                    )
                    continue
                inner = zones.half[target] * (left if sign[k] > 0 else right)
                excess.append((gap[k] + inner) / w)
                signs.append(np.full(len(left), sign[k]))
                rows.append(row)
            if rows:
                at = Outside(np.concatenate(signs), np.concatenate(excess))
                values = w * (level + one.potential(at)) if potential else one.transform(at)
                np.add.at(out, np.concatenate(rows), values)
        return out

    @cached_property
    def right(self) -> Array:  # type: ignore[override]
        g = self.dense.forcing_at(self.dense.points[0])
        if not self.dense.jumps:
            return self.sums.projected(g)
        at_nodes = g - self._known_near(nodes_of, False)
        return self.sums.projected(at_nodes, -self.sums.far_rows(self._known_far[0]))

    def residuals(self, y: Array) -> Array:
        zones, out = self.zones, self.sums.between(y)
        left, right = between_nodes(0)
        for basis, m, group, unknowns in self.sums.groups:
            out[group] -= y[unknowns[:, 1:]] @ basis.images.table(m, left, right).T
        targets = targets_at(zones, np.broadcast_to(CHECK_ANGLES, out.shape))
        g = self.dense.forcing_at(targets).reshape(out.shape)
        if self.dense.jumps:
            waves = np.cos(np.arange(TERMS)[:, None] * CHECK_ANGLES)
            near = self._known_near(between_nodes, False).reshape(out.shape)
            g = g - near - self._known_far[0] @ waves
        for number, column in enumerate(self.dense.equation.columns):
            amplitude = y[self.sums.layout.coefficients + number]
            g = g + amplitude * np.asarray(column.value(targets.x)).reshape(out.shape)
        return np.asarray((out - g) * np.sin(CHECK_ANGLES))

    @cached_property
    def column_rows(self) -> Array:
        """Coefficients of the equation's columns (functions of unknown amplitude), as in `right`.
        The shape is (columns, rows).
        """
        x = self.dense.points[0].x
        columns = [
            self.sums.projected(np.broadcast_to(np.asarray(one.value(x), dtype=float), x.shape))
            for one in self.dense.equation.columns
        ]
        return np.array(columns).reshape(-1, len(self.others))

    @cached_property
    def column_heights(self) -> Array:
        """Primitives of the equation's columns in the middles of zones (columns, Z)."""
        x, columns = self.zones.middle, self.dense.equation.columns
        heights = [np.asarray(one.primitive(x), dtype=float) for one in columns if one.primitive]
        return np.array(heights).reshape(-1, len(x))

    @cached_property
    def near_middles(self) -> Any:
        """Sparse matrix from the unknowns to the potential of near zones in each zone's middle."""
        return self.sums.near_potential()

    @cached_property
    def level_constants(self) -> Array:
        """Part of each zone's constant potential (level) that no unknown changes (Z,)."""
        forcing, zones = self.dense.equation.forcing, self.zones
        assert forcing.primitive is not None
        out = -np.asarray(forcing.primitive(zones.middle), dtype=float)
        if self.dense.jumps:
            out = out + self._known_near(_middle, True) + self._known_far[1]
        return np.asarray(out + self._before(self.known_totals))

    def _before(self, totals: Array) -> Array:
        """For each zone, the sum of kappa times `totals` over all zones to its left."""
        kappa = self.zones.weight.kappa
        assert kappa is not None
        sheared = kappa * totals
        return np.asarray(np.cumsum(sheared) - sheared)

    @cached_property
    def _own_levels(self) -> list[Array]:
        """Change of a zone's level (constant potential) per unit of each unknown of the zone.

        There is one row for each of `sums.groups`. The rows are divided by the half width of the
        zone, and lack the logarithm of the half width.
        """
        out = []
        for basis, m, _, _ in self.sums.groups:
            row = -basis.singular.mirrored.table(m + 1, np.ones(1), np.ones(1))[0]
            row[1:] /= np.arange(1, m + 1)
            row[0] = basis.level
            out.append(row)
        return out

    def applied(self, y: Array, rough: bool = False) -> tuple[Array, "AppliedRows"]:
        """(part of the equation's rows, `AppliedRows`), for the unknowns y.
        The part is the coefficients of other zones' field minus those of amplitudes times columns.
        """
        field, middle = self.sums.fields_and_middles(y, rough)
        zones, layout = self.zones, self.sums.layout
        level = middle + self.near_middles @ y
        for row, (_, _, group, unknowns) in zip(self._own_levels, self.sums.groups, strict=True):
            level[group] += zones.half[group] * (y[unknowns] @ row)
        first = y[layout.offset]
        level += zones.half * np.log(zones.half / self.dense.equation.kernel.datum) * first
        level += self._before(np.pi * zones.half * first)
        amplitudes = y[layout.coefficients :]
        level -= amplitudes @ self.column_heights
        return field - amplitudes @ self.column_rows, AppliedRows(self, y, level)

    def condition_values(self, opened: float) -> Array:
        """Right sides of all side conditions: prescribed values less the conditions' constants.

        opened: added to the value of the open condition, whose value is unknown.
        """
        applied, out = self.applied(np.zeros(self.sums.layout.size))[1], []
        for condition in self.dense.equation.conditions:
            _, constants, values = asked(condition, applied, 1)
            out.append(values - constants + (opened if condition.open else 0.0))
        return np.concatenate(out)

    def condition_rows(self, applied: "AppliedRows") -> Array:
        """Left sides of all conditions without constants, for the unknowns of `applied`."""
        rows = [asked(one, applied, 1)[0][:, 0] for one in self.dense.equation.conditions]
        return np.concatenate(rows)

    def integral_rows(self, weight: Weight, degree: int | None) -> tuple[list[Array], Array]:
        """(rows for integrals of `weight` * density over zones, known parts of the integrals)."""
        if (weight, degree) not in self._integrals:
            known, rows, layout = np.zeros(len(self.zones)), [], self.sums.layout
            for i, basis in enumerate(bases_of(self.zones)):
                m = int(layout.m[i])
                means = self.dense.means(weight, i, m + 1 if degree is None else degree + 1)
                means = np.pi * self.zones.half[i] * means
                rows.append(np.asarray(means @ basis.moments(m + 1, len(means))))
                known[i] = sum(
                    float(means @ one.moments(len(means)))
                    for one in self.dense.jumps
                    if one.zone == i
                )
            self._integrals[weight, degree] = rows, known
        return self._integrals[weight, degree]

    @cached_property
    def _integrals(self) -> dict[tuple[Weight, int | None], tuple[list[Array], Array]]:
        return {}

    @cached_property
    def coarse(self) -> tuple[Array, Index]:
        """LU factors of the side conditions' matrix, with only c_0 and amplitudes as unknowns."""
        zones, layout = self.zones, self.sums.layout
        count, columns = len(zones), layout.columns
        level = np.zeros((count, count + columns))
        level[:, :count] = self._bare_potentials()
        level[:, count:] = -self.column_heights.T
        kappa = zones.weight.kappa
        assert kappa is not None
        level[:, :count] += np.tril(np.ones((count, count)), -1) * (kappa * np.pi * zones.half)
        first = np.eye(count, count + columns)
        trial = _Coarse(zones, first, level)
        matrix = np.concatenate(
            [asked(one, trial, count + columns)[0] for one in self.dense.equation.conditions]
        )
        factors: tuple[Array, Index] = lu_factor(matrix)
        return factors

    def _bare_potentials(self) -> Array:
        """Potentials in zones' middles (rows) of 1 / sqrt(1 - t^2) on each zone (columns)."""
        zones, kernel = self.zones, self.dense.equation.kernel
        x, half = zones.middle, zones.half
        out = np.zeros((len(x), len(x)))
        for shift in kernel.poles:
            away = np.abs(x[:, None] - x - shift)
            own = (np.eye(len(x)) > 0) if shift == 0.0 else np.zeros(out.shape, dtype=bool)
            excess = np.maximum(away / half - 1, np.where(own, 1.0, 0.0))
            value = Outside(1.0, excess).first(half / kernel.datum)
            out += np.where(own, np.log(0.5 * half / kernel.datum), value)
        if kernel.regular_potential is not None:
            out += kernel.regular_potential(x[:, None], x)
        return out * half


@record
class _Coarse(Trial):
    """A `Trial` whose unknowns are c_0 of each zone and, last, the amplitudes of the columns."""

    def amplitude(self, k: int) -> Linear:
        row = np.zeros((1, self.first.shape[1]))
        row[0, len(self.first) + k] = 1.0
        return row, np.zeros(1)


@record
class AppliedRows(Rows):
    """Quantities for side conditions; the product with the unknowns `y` replaces each matrix."""

    of: LevelRows
    y: Array
    level: Array

    @property
    def zones(self) -> Zones:  # type: ignore[override]
        return self.of.zones

    def totals(self) -> Linear:
        first = self.y[self.of.sums.layout.offset]
        return (np.pi * self.zones.half * first)[:, None], self.of.known_totals

    def levels(self) -> Linear:
        return self.level[:, None], self.of.level_constants

    def integrals(self, weight: Weight, degree: int | None = None) -> Linear:
        rows, known = self.of.integral_rows(weight, degree)
        starts = self.of.sums.layout.offset
        values = [row @ self.y[s : s + len(row)] for row, s in zip(rows, starts, strict=True)]
        return np.array(values)[:, None], known

    def intensities(self) -> tuple[Linear, Linear]:
        raise ValueError(
            "with kappa, many zones cannot have conditions on intensities: use fewer zones"
        )

    def amplitude(self, k: int) -> Linear:
        return self.y[[self.of.sums.layout.amplitude(k)]][:, None], np.zeros(1)


class LevelSolver(ManySolver):
    """Iterative solver of the system `LevelRows`; right sides end with the conditions' values."""

    rows: LevelRows

    def __init__(self, rows: LevelRows, tolerance: float) -> None:
        super().__init__(rows, tolerance)
        self.order, self.edge_values = np.arange(len(rows.zones)), None

    def __call__(
        self, right: Array, tolerance: float | None = None, guess: Array | None = None
    ) -> Array:
        rows, layout = self.rows, self.rows.sums.layout
        others, equations, count = rows.others, len(rows.others), len(layout.m)
        lasts = np.concatenate((layout.offset, layout.coefficients + np.arange(layout.columns)))
        rounding = 4 * EPS * np.sqrt(count)
        wanted = max(self.tolerance if tolerance is None else tolerance, float(rounding))

        def unknowns(x: Array) -> Array:
            y = np.zeros(layout.size)
            y[others], y[lasts] = x[:equations], x[equations:]
            return y

        def operator(x: Array, rough: bool) -> Array:
            field, applied = rows.applied(unknowns(x), rough)
            values = lu_solve(rows.coarse, rows.condition_rows(applied))
            return np.concatenate((x[:equations] - field, values))

        given = np.concatenate((-right[:equations], lu_solve(rows.coarse, right[equations:])))
        scale = self._scale(given[:equations], given[equations : equations + count])
        starts = np.cumsum(layout.m) - layout.m
        top = np.full(layout.columns, float(scale.max()))
        scale = np.concatenate((scale, scale[starts], top))
        start = None if guess is None else np.concatenate((guess[others], guess[lasts]))
        x, left_over = self._iterated(operator, given, scale, start, wanted)
        if tolerance is None:
            rest = np.abs(left_over * scale)
            self.error = np.maximum.reduceat(rest[:equations], starts)
            self.error = np.maximum(self.error, rest[equations : equations + count])
        return unknowns(x)

    def row_errors(self, y: Array, residuals: Array, missing: Array) -> Array:
        rows, zones = self.rows, self.rows.zones
        by_zone = super().row_errors(y, residuals, missing)[: len(rows.others)]
        first = np.abs(zones.half * y[rows.sums.layout.offset])
        logs = np.abs(np.log(zones.half / rows.dense.equation.kernel.datum))
        # A level (constant potential of a zone) is a sum of the zones' potentials, each about
        # `first` * (1 + `logs`). The round-off errors of these terms are added as a root of
        # squares.
        size = float(np.hypot(norm(first * (1 + logs)), np.abs(rows.level_constants).max()))
        applied, out = rows.applied(y)[1], []
        for condition in rows.dense.equation.conditions:
            matrix, constants, values = asked(condition, applied, 1)
            terms = np.abs(matrix[:, 0]) + np.abs(constants) + np.abs(values)
            out.append(np.full(len(terms), 8 * EPS * size) if condition.levels else EPS * terms)
        return np.concatenate((by_zone, *out))
