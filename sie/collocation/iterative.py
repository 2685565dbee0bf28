"""The system of many zones without its matrix: rows applied to unknowns by fast sums, solved by
preconditioned GMRES.

The rows are those of `system`: a zone's own part of them is -c_k, and what is left couples the
zones. The preconditioner is that own part and, for the zones' loads, a coarse problem: flat
punches, each seen by the others through its load alone, with the same side conditions. What is left
to the iterations is how zones bend each other, which falls off as the square of the distance, so
their number does not grow with that of the zones.
"""

import math
from collections.abc import Callable
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import norm

from sie.basis.data import Array, Index, numbered, record, root_of_squares
from sie.basis.interval import edge_scale, mean_potential
from sie.basis.zones import Zones
from sie.collocation import modes
from sie.collocation.modes import felt
from sie.collocation.system import System, condition_rows
from sie.collocation.zone_sums import ZoneSums
from sie.equation.conditions import ByZone, Linear, Rows, by_zone, speaks_of_levels
from sie.equation.equation import Equation
from sie.fast.far import reaches
from sie.fast.hierarchical import Inverse
from sie.fast.krylov import gmres
from sie.jumps.forcing import ForcingJumps

# To what the coarse problem is inverted: below the bending that it leaves out.
_COARSE = 1e-4
# A coarse inverse is kept from one set of zones to the next while the ends of nearly all zones move
# by less than this part of a width, and of the others by no more than the width.
_KEPT = 0.1
_NEARLY = 0.99
# What a correction leaves of the residual; corrections at the most; and one that leaves more than
# this of it is the last: rough sums leave much less, and so it is rounding.
_CORRECTED = 1e-6
_CORRECTIONS = 6
_STAGNANT = 1e-3
# From the square of this number of zones on, the tolerance is that of each.
_ALIKE = 10.0
# The residual that rounding leaves, over the size of the solution.
_ROUNDING = 3e-16
# Zones with less than this part of the largest coefficient are solved as if they had it.
_LIGHTEST = 1e-4
# Rows at most of conditions that are not of every zone by itself: a small system couples them.
_FEW_ROWS = 64
# Nodes for the integral of g over so many lengths of its resolution: of a wave of that length they
# leave 1e-19.
_GAUSS = 16
_LENGTHS = 2


@lru_cache(maxsize=1)
def _gauss_legendre() -> tuple[Array, Array, Array]:
    """(nodes, weights, D): values @ D is the slope of their polynomial at the nodes."""
    t, weights = np.polynomial.legendre.leggauss(_GAUSS)
    basis = np.polynomial.legendre.legvander(t, _GAUSS - 1)
    orders = np.eye(_GAUSS)
    slopes = np.polynomial.legendre.legval(t, np.polynomial.legendre.legder(orders)).T
    return (
        np.asarray(t),
        np.asarray(weights),
        np.asarray(np.linalg.solve(basis.T, slopes.T), dtype=np.float64),
    )


def unfit(equation: Equation, zones: Zones) -> str | None:
    """What the conditions lack of a coarse problem, or the kernel of fast sums; None if nothing."""
    if len(zones.solved) < 2:
        return "one zone is too few"
    if not reaches(equation.kernel, zones):
        return "the kernel is too general"
    per_zone = [c for c in equation.conditions if by_zone(c, zones) is not None]
    if sum(c.count(zones) for c in equation.conditions if c not in per_zone) > _FEW_ROWS:
        return "there are too many conditions that are of no zone by itself"
    held = sorted(sum(zones.held, []))
    if len(per_zone) + bool(held) != 1 or (held and held != list(range(len(zones.solved)))):
        return "every zone needs one condition of its own, all of one kind"
    return None


class IterativeSystem(System):
    """Rows applied to unknowns; no matrix is kept. rough: what far zones do is known to 1e-7 of all
    of it.
    """

    def __init__(
        self,
        equation: Equation,
        zones: Zones,
        m: Index,
        coefficients: Array,
        jumps: ForcingJumps,
        rough: bool = False,
    ) -> None:
        super().__init__(equation, zones, m, coefficients, jumps)
        self.rough = rough
        kernel = equation.kernel
        if kernel.regular is not None and kernel.regular_potential is None and self.wants_levels:
            raise ValueError("a condition on potentials needs the regular kernel's potential")
        self.sums = ZoneSums(zones, equation.kernel, self.layout)
        self._weights: dict[Callable[[Array], Array], tuple[list[Array], Array]] = {}
        columns = [
            self.projected(np.asarray(c.value(self.targets.x), dtype=float))
            for c in equation.columns
        ]
        self.column_rows = np.array(columns).reshape(-1, len(self.own))
        none = np.zeros(len(zones.solved))
        rows, middle, mean = (
            self.sums(self.layout.flat(self.known), rough)
            if self.known.any()
            else (np.zeros(len(self.own)), none, none)
        )
        if self.unseen_moments is not None:
            of_rows, of_levels = self.of_panels(self.unseen_moments)
            rows, middle = rows + of_rows, middle + of_levels
        self.known_field = rows, middle, mean
        self.equation_right = (self.layout.flat(self.lowest)[self.own] - rows)[self.kept]

    @cached_property
    def known_intensities(self) -> tuple[Array, Array]:
        """What is known of K at the left and right ends, without unknowns."""
        return self.intensities_of(self.beyond)

    # rows applied
    # ---------------------------------------------------------------------------------------------------
    def applied(self, y: Array, rough: bool = False) -> "tuple[Array, Applied]":
        """(rows of the equation, what conditions ask for) for unknowns y. rough: see `ZoneSums`."""
        rows, middle, mean = self.sums(y, rough or self.rough)
        rows -= y[self.own]
        if self.layout.columns:
            rows -= y[self.layout.coefficients :] @ self.column_rows
        return rows[self.kept], Applied(self, y, middle, self._with_own(y, mean))

    def felt(self, y: Array) -> Array:
        """What unknowns do to the solved zones other than their own: the sizes of its coefficients
        on each, added up.
        """
        rows, count = np.abs(self.sums(y, rough=True)[0]), self.layout.m[self.zones.solved]
        zone = np.repeat(np.arange(len(count)), count)
        return np.asarray(np.bincount(zone, rows, minlength=len(count)), dtype=np.float64)

    def _with_own(self, y: Array, mean: Array) -> Array:
        solved = self.zones.solved
        w = self.zones.half[solved]
        level = mean + mean_potential(w, self.equation.kernel.datum) * y[self.layout.offset[solved]]
        if self.layout.columns and self.wants_levels:
            level = level - y[self.layout.coefficients :] @ self.column_means
        return np.asarray(level)

    @cached_property
    def levelled(self) -> bool:
        """Whether a condition on potentials is what every zone has of its own."""
        return self.of_zones is not None and self.of_zones.of_levels

    @cached_property
    def of_zones(self) -> ByZone | None:
        """What every zone has of its own, but held ends."""
        found = (by_zone(c, self.zones) for c in self.equation.conditions)
        return next((one for one in found if one is not None), None)

    @cached_property
    def springs(self) -> Array:
        """What every zone's own condition on its level has of c_0 beside it."""
        own = self.of_zones
        none = np.zeros(len(self.zones.solved))
        return (
            none if own is None or not own.of_levels or own.differences else own.first / own.levels
        )

    @cached_property
    def column_means(self) -> Array:
        means = [self._column_means(c.primitive) for c in self.equation.columns]
        return np.array(means).reshape(-1, len(self.zones.solved))

    @cached_property
    def level_constants(self) -> Array:  # type: ignore[override]
        return self.known_field[1] + self._known_rest - self._forcing_means()

    @cached_property
    def step_constants(self) -> Array:
        """Differences of `level_constants` between neighbours, with the digits that the values have
        lost.
        """
        return (
            np.diff(self.known_field[1]) + np.diff(self._known_rest) - self._forcing_differences()
        )

    @property
    def _known_rest(self) -> Array:
        return self._with_own(self.layout.flat(self.known), self.known_field[2])

    @property
    def integrated(self) -> bool:
        """Whether differences of the primitive may be taken from g."""
        forcing = self.equation.forcing
        return forcing.resolution.length is not None and not forcing.value_jumps

    def _forcing_differences(self) -> Array:
        """Differences of the primitive's means between neighbours: over the gap by quadrature, over
        the zones from the coefficients of g, since the antiderivative of U_{k-1} is T_k / k.
        """
        zones, solved, forcing = self.zones, self.zones.solved, self.equation.forcing
        if not self.integrated:
            return np.diff(self._forcing_means())
        if self.rough:  # to the rounding of the primitive
            assert forcing.primitive is not None
            across = np.asarray(
                forcing.primitive(zones.a[solved[1:]]) - forcing.primitive(zones.b[solved[:-1]])
            )
        else:
            across = self._across_gaps[0]
        g, w = self.g[solved[0] :], zones.half[solved]
        weights = 1 / np.arange(1.0, g.shape[1])
        half_rise, offset = w * (g[:, 1::2] @ weights[::2]), w * (g[:, 2::2] @ weights[1::2])
        return across + half_rise[1:] + half_rise[:-1] - np.diff(offset)

    @cached_property
    def _across_gaps(self) -> tuple[Array, Array]:
        """(integral of g over every gap, what is left of the rounding of places in it: half a unit
        in the last digit, which the forcing's own arithmetic may lose of x).
        """
        forcing = self.equation.forcing
        assert forcing.resolution.length is not None
        start, rest, length = self._gaps
        panels = np.ceil(length / (_LENGTHS * forcing.resolution.length)).astype(np.intp)
        gap = np.repeat(np.arange(len(length)), panels)
        number = numbered(panels)
        size = (length / panels)[gap]
        t, weights, slope_of = _gauss_legendre()
        from_start = rest[gap][:, None] + (number * size)[:, None] + size[:, None] * (0.5 * (1 + t))
        left = start[gap][:, None]
        values = forcing.sampled(left, from_start, lambda g: g @ slope_of / (0.5 * size[:, None]))
        across = 0.5 * size * (values @ weights)
        if forcing.resolution.exact_places:
            return np.asarray(
                np.bincount(gap, across, minlength=len(length)), dtype=np.float64
            ), np.zeros(len(length))
        lost = 0.3 * np.spacing(np.maximum(np.abs(start), np.abs(start + length)))
        unit = max(float(np.abs(values).max(initial=0.0)), 1e-300)
        varies = np.bincount(
            gap, ((values / unit @ slope_of) ** 2) @ weights**2, minlength=len(length)
        )
        return np.asarray(
            np.bincount(gap, across, minlength=len(length)), dtype=np.float64
        ), lost * unit * np.sqrt(varies)

    @property
    def _gaps(self) -> tuple[Array, Array, Array]:
        """(left end, what rounding has cut off it, length) of the gaps between solved zones."""
        zones, solved = self.zones, self.zones.solved
        left, rest = zones.b[solved[:-1]], zones.rest[1, solved[:-1]]
        return left, rest, (zones.a[solved[1:]] - left) + (zones.rest[0, solved[1:]] - rest)

    def level_changes(self, y: Array) -> Array:
        return self.applied(y)[1].level

    def level_rounding(self, y: Array) -> Array | float:
        """The terms of a level are at most all totals at the farthest distance, and the largest at
        the nearest. Where only differences between neighbours matter, it is what is between them
        that is rounded.
        """
        zones, datum = self.zones, self.equation.kernel.datum
        own = np.abs(zones.half * y[self.layout.offset])
        near = np.abs(np.log(zones.half / datum))
        if any(c.levels and c.count(zones) == len(zones.solved) for c in self.equation.conditions):
            far = max(1.0, abs(math.log((zones.b[-1] - zones.a[0]) / datum)))
            return 2.2e-16 * float(
                own.sum() * far + (own * near).max() + np.abs(self.level_constants).max()
            )
        slope = float(np.abs(self.g).max())
        typical = float(
            root_of_squares(
                (root_of_squares(self.g) * np.sqrt(zones.half / zones.half.sum()))[None]
            )[0]
        )
        # Potentials of neighbours are put together apart from each other up to the node that holds
        # both.
        apart = np.maximum(slope * self._gaps[2], typical * self.sums.far.targets.tree.parted)
        steps = 2.2e-16 * apart + (
            self._across_gaps[1] if self.integrated and not self.rough else 0.0
        )
        # The step over the border is that of all others.
        border = float(root_of_squares(steps[None])[0])
        felt_left, felt_right = felt(
            *(
                gap[zones.solved] + zones.half[zones.solved]
                for gap in modes.gaps(zones, self.equation.kernel)
            )
        )
        out = 2.2e-16 * (slope * zones.half + own * near)
        out[zones.solved] += felt_left * np.append(border, steps) + felt_right * np.append(
            steps, border
        )
        return np.maximum(out, out[::-1]) if zones.symmetric else out

    def weighted(
        self, weight: Callable[[Array], Array], degree: int | None
    ) -> tuple[list[Array], Array]:
        if weight not in self._weights:
            self._weights[weight] = super().weighted(weight, degree)
        return self._weights[weight]


@record
class Applied(Rows):
    """What conditions may ask for (`conditions.Rows`), with rows already applied to one set of
    unknowns: one column. edges: K at both ends of the solved zones (2, n), where the unknowns do
    not tell it.
    """

    system: IterativeSystem
    y: Array
    middle: Array
    rest: Array
    edges: Array | None = None

    @property
    def level(self) -> Array:
        return self.middle + self.rest

    @property
    def zones(self) -> Zones:  # type: ignore[override]
        return self.system.zones

    def totals(self) -> Linear:
        solved = self.zones.solved
        scale = np.pi * self.zones.half[solved]
        return (scale * self.y[self.system.layout.offset[solved]])[
            :, None
        ], scale * self.system.known[solved, 0]

    def levels(self) -> Linear:
        return self.level[:, None], self.system.level_constants

    def level_steps(self) -> Linear:
        return (np.diff(self.middle) + np.diff(self.rest))[:, None], self.system.step_constants

    def integrals(self, weight: Callable[[Array], Array], degree: int | None = None) -> Linear:
        tables, constants = self.system.weighted(weight, degree)
        start = self.system.layout.offset[self.zones.solved]
        rows = np.array(
            [values @ self.y[s : s + len(values)] for values, s in zip(tables, start, strict=True)]
        )
        return rows[:, None], constants

    def intensities(self) -> tuple[Linear, Linear]:
        system = self.system
        left, right = (
            system.intensities_of(system.layout.padded(self.y))
            if self.edges is None
            else self.edges
        )
        constant_left, constant_right = system.known_intensities
        return (left[:, None], constant_left), (right[:, None], constant_right)

    def held(self) -> Linear:
        """K at the ends that are held at zero, those on the left first."""
        pairs = list(zip(self.zones.held, self.intensities(), strict=True))
        matrix, constants = (
            np.concatenate([linear[part][chosen] for chosen, linear in pairs]) for part in (0, 1)
        )
        return matrix, constants

    def amplitude(self, k: int) -> Linear:
        return self.y[[[self.system.layout.amplitude(k)]]], np.zeros(1)


class CoarseOperator:
    """The coarse problem's matrix and its inverse: mean potential on each solved zone from each
    c_0, less a constant times the total that makes it definite.
    """

    def __init__(self, zones: Zones, system: IterativeSystem) -> None:
        self.zones, self.kernel = zones, system.equation.kernel
        solved = zones.solved
        self.springs = np.zeros(len(solved))
        ends = np.array([0, len(solved) - 1])
        w = zones.half[solved]
        self.lowered = 0.0
        self.lowered = 1.0 + float(
            (
                self.entries(ends[:, None], np.arange(len(solved))) / (w * system.multiplicity())
            ).max()
        )
        self.springs = system.springs
        self.inverse = Inverse(self.entries, 0, len(solved), _COARSE)

    def entries(self, rows: Index, columns: Index) -> Array:
        solved, count = self.zones.solved, len(self.zones)
        i, j = solved[rows], solved[columns]
        out = self._of(i, j)
        if self.zones.symmetric:
            mirror = count - 1 - j
            out = out + np.where(mirror == j, 0.0, self._of(i, mirror))
        return out + np.where(i == j, self.springs[rows], 0.0)

    def _of(self, i: Index, j: Index) -> Array:
        zones, kernel = self.zones, self.kernel
        x, xi, w = zones.middle[i], zones.middle[j], zones.half[j]
        # A punch raises log((d + sqrt(d^2 - w^2)) / 2) at the distance d, and log(w / 2) on itself:
        # of all poles together one logarithm.
        product, away = np.ones(np.broadcast(i, j).shape), x - xi
        for shift in kernel.poles:
            d = np.maximum(np.abs(away - shift), w)
            product *= (0.5 / kernel.datum) * (d + np.sqrt((d - w) * (d + w)))
        out = np.log(product)
        if kernel.regular_potential is not None:
            out += kernel.regular_potential(x, xi)
        return np.asarray(w * (out - self.lowered))

    def near(self, system: IterativeSystem) -> bool:
        """Whether the zones of a system, and what it asks of them, are still about the same."""
        zones = system.zones
        if len(zones) != len(self.zones) or zones.symmetric != self.zones.symmetric:
            return False
        if np.any(np.abs(system.springs - self.springs) > _KEPT * np.abs(self.springs)):
            return False
        moved = np.maximum(np.abs(zones.a - self.zones.a), np.abs(zones.b - self.zones.b))
        part = moved / (self.zones.b - self.zones.a)
        return bool(part.max() <= 1.0 and np.mean(part <= _KEPT) >= _NEARLY)


class TwoLevelPreconditioner:
    """The preconditioner: -c_k from the rows of the equation, c_0 and the amplitudes from the side
    conditions.

    With level = G c_0 - (amplitudes' means) on every zone, G = C + constant, C the coarse operator:
    c_0 = C^-1 (level + unknown constant + ...), and the few unknowns left come from the conditions
    that are not asked of every zone. Where every zone has a held end, c_0 is what makes K vanish
    there.
    """

    def __init__(self, system: IterativeSystem, coarse: CoarseOperator | None) -> None:
        self.system, self.coarse = system, coarse
        zones, conditions = system.zones, system.equation.conditions
        counts = [c.count(zones) for c in conditions]
        starts = np.concatenate(([0], np.cumsum(counts)))
        kinds = [by_zone(c, zones) for c in conditions]
        self.others = [k for k, kind in enumerate(kinds) if kind is None]
        self.other_rows = np.concatenate(
            [np.arange(starts[k], starts[k + 1]) for k in self.others]
            or [np.zeros(0, dtype=np.intp)]
        )
        self.held = np.array(sum(zones.held, []), dtype=np.intp)
        at = next((k for k, kind in enumerate(kinds) if kind is not None), None)
        self.own, self.levels = system.of_zones, system.levelled
        # What every zone has of its own: rows of one condition, or those of held ends, which come
        # last.
        self.rows = (
            slice(int(starts[-1]), None)
            if at is None
            else slice(int(starts[at]), int(starts[at + 1]))
        )
        self.absolute = self.own is not None and not self.own.differences
        # Of what is no level: the condition that is every zone's own.
        self.closed = None if at is None or self.levels else conditions[at]
        self.seen = any(speaks_of_levels(conditions[k], zones) for k in self.others)
        layout, symmetry = system.layout, system.symmetry
        self.first = symmetry.position(layout.offset[zones.solved])
        self.rest = symmetry.position(system.diagonal)
        self.amplitudes = symmetry.position(layout.coefficients + np.arange(layout.columns))
        self._basis = self._responses()
        self._small = np.zeros((self._basis.shape[1],) * 2)
        for k, column in enumerate(self._basis.T):
            self._small[:, k] = self._scalars(column)

    def _responses(self) -> Array:
        """Folded unknowns that a unit of the constant and of each amplitude bring along, in
        columns.
        """
        system, with_constant = self.system, int(self.levels)
        out = np.zeros((system.symmetry.size, system.layout.columns + with_constant))
        if with_constant:
            self._close(out[:, 0], np.ones(len(self.first)))
        for k, column in enumerate(out.T[with_constant:]):
            column[self.amplitudes[k]] = 1.0
            column[self.rest] = -system.column_rows[k][system.kept]
            self._close(
                column, system.column_means[k] if self.levels else np.zeros(len(self.first))
            )
        return out

    def _close(self, folded: Array, wanted: Array) -> None:
        """Sets c_0 of every zone so that its level, or what else it has of its own, is as wanted."""
        system = self.system
        if self.levels:
            assert self.coarse is not None
            folded[self.first] = self.coarse.inverse(wanted)
            return
        view = Applied(system, system.symmetry.unfold(folded), np.zeros(0), np.zeros(0))
        if self.own is not None and self.closed is not None:
            folded[self.first] = (wanted - self.closed.rows(view)[0][:, 0]) / self.own.first
            return
        folded[self.first[self.held]] = (wanted - view.held()[0][:, 0]) / edge_scale(
            system.zones.half[system.zones.solved[self.held]]
        )

    def _scalars(self, folded: Array) -> Array:
        """The conditions that are single rows, and what ties the constant where levels are
        absolute.
        """
        system = self.system
        y = system.symmetry.unfold(folded)
        view = system.applied(y)[1] if self.seen else Applied(system, y, np.zeros(0), np.zeros(0))
        out = [
            float(row)
            for k in self.others
            for row in system.equation.conditions[k].rows(view)[0][:, 0]
        ]
        if self.levels and self.absolute:
            assert self.coarse is not None
            solved = system.zones.solved
            total = float((system.multiplicity() * system.zones.half[solved]) @ folded[self.first])
            # What the constant stands for, from the basis' first unknown: put in by `__call__`.
            out.append(self.coarse.lowered * total)
        return np.array(out)

    def __call__(self, right: Array) -> Array:
        system = self.system
        equations = len(self.rest)
        conditions = right[equations:]
        here = conditions[self.rows]
        out = np.zeros(system.symmetry.size)
        out[self.rest] = -right[:equations]
        if self.own is not None and self.levels:
            here = (
                here / self.own.levels
                if self.absolute
                else np.concatenate(([0.0], np.cumsum(here / self.own.levels)))
            )
        self._close(out, here)
        if self._basis.shape[1]:
            small, wanted = self._small.copy(), conditions[self.other_rows]
            missing = self._scalars(out)
            if self.levels and self.absolute:
                wanted = np.append(wanted, 0.0)
                small[-1, 0] += 1.0
            out += self._basis @ np.linalg.solve(small, wanted - missing)
        return out


class Iterative:
    """Solves the rows of an `IterativeSystem` for any right side.

    value: of an open condition, if there is one. Unknowns are counted in the largest of their zone,
    so that lightly loaded zones are as right as the others. error: the largest of what the last
    residual, preconditioned, says of the error of each zone's unknowns (Z,).
    """

    def __init__(
        self,
        system: IterativeSystem,
        coarse: CoarseOperator | None,
        tolerance: float,
        value: float = 0.0,
    ) -> None:
        self.system, self.tolerance, self.value = system, tolerance, value
        self.preconditioner = TwoLevelPreconditioner(system, coarse)
        self.equations = len(system.diagonal)
        self.error = np.zeros(len(system.zones))
        self.iterations = 0

    @property
    def size(self) -> int:
        return self.system.symmetry.size

    def rows(self, folded: Array, rough: bool = False) -> Array:
        system = self.system
        rows, view = system.applied(system.symmetry.unfold(folded), rough)
        return np.concatenate((rows, condition_rows(system.equation, view, 1)[0][:, 0]))

    def right(self) -> Array:
        """The right side of the equation and of its conditions."""
        system, none = self.system, np.zeros(len(self.system.zones.solved))
        values = condition_rows(
            system.equation, Applied(system, np.zeros(system.layout.size), none, none), 1
        )[1]
        opened = [
            condition.open
            for condition in system.equation.conditions
            for _ in range(condition.count(system.zones))
        ]
        values[np.flatnonzero(opened)] += self.value
        return np.concatenate((system.equation_right, values))

    def __call__(
        self,
        right: Array,
        near: Array | None = None,
        tolerance: float | None = None,
        taken: Callable[[Array], Array] | None = None,
    ) -> Array:
        """Folded unknowns; near: a first guess; tolerance: if another than that of the solver;
        taken: what is taken from the rows, of the unknowns too.
        """

        def rows(folded: Array, rough: bool = False) -> Array:
            return (
                self.rows(folded, rough)
                if taken is None
                else self.rows(folded, rough) - taken(folded)
            )

        plain = self.preconditioner(right) if near is None else near
        scale = self.scale_of(plain)
        # Norms of many zones add up what is asked of each.
        count = math.sqrt(len(self.system.zones.solved))
        wanted = max(
            (self.tolerance if tolerance is None else tolerance) * max(count / _ALIKE, 1.0),
            4 * _ROUNDING * count,
        )
        x = np.zeros(self.size) if near is None else near
        left_over = (plain if near is None else self.preconditioner(right - rows(near))) / scale
        before = float(norm(left_over))
        for _ in range(_CORRECTIONS):
            # Each correction is wanted to a part only, for which rough sums will do.
            part = max(wanted, _CORRECTED * before)
            found = gmres(
                lambda v: self.preconditioner(rows(v * scale, rough=True)) / scale, left_over, part
            )
            self.iterations += found.steps
            x = x + found.x * scale
            # What rough sums and rounding in a long recurrence leave, they do not see: the residual
            # itself is looked at.
            left_over = self.preconditioner(right - rows(x)) / scale
            self.error = self._by_zone(left_over * scale)
            size, before = before, float(norm(left_over))
            if found.steps == 0 or before <= 4 * wanted or before > _STAGNANT * size:
                break
        return x

    def _largest(self, folded: Array) -> Array:
        """Largest unknown of every solved zone."""
        return np.asarray(
            np.maximum.reduceat(
                np.abs(folded[: self.size - len(self.preconditioner.amplitudes)]),
                self.preconditioner.first,
            )
        )

    def _by_zone(self, folded: Array) -> Array:
        """Largest unknown of every zone, mirrored ones too."""
        zones = self.system.zones
        out = np.zeros(len(zones))
        out[zones.solved] = self._largest(folded)
        return np.maximum(out, out[::-1]) if zones.symmetric else out

    def scale_of(self, folded: Array) -> Array:
        """Largest unknown of its zone for every unknown, but not below a small part of the largest
        of all; 1 for amplitudes.
        """
        largest = self._largest(folded)
        top = float(largest.max())
        size = np.diff(
            np.append(self.preconditioner.first, self.size - len(self.preconditioner.amplitudes))
        )
        out = np.ones(self.size)
        out[: int(size.sum())] = np.repeat(
            np.maximum(largest, _LIGHTEST * top if top > 0 else 1.0), size
        )
        return out
