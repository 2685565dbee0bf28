"""Rows of the equation for many zones, applied to unknowns by fast sums.

The rows are those of `sie.dense.system`: each zone's own part is -c_k, with c_k a Chebyshev
coefficient of its density, and the rest couples the zones. The preconditioner inverts the own part.
For the totals of the zones it solves a coarse problem: zones that interact through their totals
alone, with the same side conditions. The iterations account for the variation of a zone's field
over other zones, which decreases as the square of the distance. So the number of iterations does
not grow with the number of zones.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from sie.basis.data import Array, Index, numbered, record, root_of_squares
from sie.basis.interval import mean_potential
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.weight import needs_half
from sie.basis.zones import Zones
from sie.dense import modes
from sie.dense.modes import felt
from sie.dense.system import System
from sie.equation.conditions import ByZone, Linear, Rows, by_zone
from sie.equation.equation import Equation
from sie.fast.zone_sums import ZoneSums
from sie.jumps.right_side import ForcingJumps
from sie.trees.far import reaches


@dataclass(frozen=True)
class QuadratureOptions:
    """Options of a system of equations whose rows are applied by sums, without a matrix."""

    # Largest total number of rows of the side conditions that act on several zones. A small dense
    # system is solved for these rows.
    max_dense_conditions: int = 64
    # Length of a quadrature panel in the integral of the right side g over a gap, in units of g's
    # resolution length.
    lengths_per_panel: int = 2


_OPTIONS = QuadratureOptions()


@lru_cache(maxsize=1)
def _gauss_legendre() -> tuple[Array, Array, Array]:
    """(nodes, weights, matrix D of derivatives at the nodes) of the Gauss-Legendre rule.

    The product values @ D is the slope, at the nodes, of the polynomial through the values.
    """
    t, weights = np.polynomial.legendre.leggauss(SUMS.gauss_nodes)
    basis = np.polynomial.legendre.legvander(t, SUMS.gauss_nodes - 1)
    orders = np.eye(SUMS.gauss_nodes)
    slopes = np.polynomial.legendre.legval(t, np.polynomial.legendre.legder(orders)).T
    return (
        np.asarray(t),
        np.asarray(weights),
        np.asarray(np.linalg.solve(basis.T, slopes.T), dtype=np.float64),
    )


def unfit(equation: Equation, zones: Zones) -> str | None:
    """The reason, as a message, why fast sums do not apply to the equation; None if they do."""
    if len(zones.solved) < 2:
        return "fast sums need at least two zones"
    needs_half(zones.weight, "fast sums")
    if not reaches(equation.kernel, zones):
        return "fast sums do not support this kernel"
    per_zone = [c for c in equation.conditions if by_zone(c, zones) is not None]
    if (
        sum(c.count(zones) for c in equation.conditions if c not in per_zone)
        > _OPTIONS.max_dense_conditions
    ):
        return "too many rows of side conditions act on several zones"
    held = sorted(sum(zones.fixed_bounded, []))
    if len(per_zone) + bool(held) != 1 or (held and held != list(range(len(zones.solved)))):
        return (
            "fast sums need exactly one of these: a condition with a row for each zone, such as "
            "sie.ZoneTotals; a condition that compares zones, such as sie.EqualPotential; or one "
            "bounded fixed end on each zone"
        )
    return None


class IterativeSystem(System):
    """The system of equations whose rows are applied to the unknowns by sums, without a matrix.

    rough: whether a far field with an error of 1e-7 of the whole field is accurate enough.
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
            raise ValueError(
                "a condition on potentials needs the potential of the regular kernel: "
                "sie.Smooth(value, potential)"
            )
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
        """Parts of the intensities K at left and right ends that do not depend on the unknowns.
        K is the coefficient of 1 / sqrt(distance) in the density close to an end.
        """
        return self.intensities_of(self.beyond)

    def applied(self, y: Array, rough: bool = False) -> "tuple[Array, Applied]":
        """(left sides of the equation, quantities that side conditions use), for the unknowns y.

        rough: see `ZoneSums`.
        """
        rows, middle, mean = self.sums(y, rough or self.rough)
        rows -= y[self.own]
        if self.layout.columns:
            rows -= y[self.layout.coefficients :] @ self.column_rows
        return rows[self.kept], Applied(self, y, middle, self._with_own(y, mean, self.zones.depth))

    def felt(self, y: Array) -> Array:
        """Size of the field that the unknowns y of all other zones cause on each solved zone.

        It is the sum of the absolute values of the field's coefficients.
        """
        rows, count = np.abs(self.sums(y, rough=True)[0]), self.layout.m[self.zones.solved]
        zone = np.repeat(np.arange(len(count)), count)
        return np.asarray(np.bincount(zone, rows, minlength=len(count)), dtype=np.float64)

    def _with_own(self, y: Array, mean: Array, depth: Array) -> Array:
        """The given `mean` of the potential on each zone, plus the potential of its own charge.
        The charge of a zone is the integral of the density over the zone. The means of the
        primitives of the equation's columns are subtracted. depth: see `Zones`.
        """
        solved = self.zones.solved
        w = self.zones.half[solved]
        own = mean_potential(w, self.equation.kernel.datum, depth[solved])
        level = mean + own * y[self.layout.offset[solved]]
        if self.layout.columns and self.wants_levels:
            level = level - y[self.layout.coefficients :] @ self.column_means
        return np.asarray(level)

    @cached_property
    def levelled(self) -> bool:
        """Whether a side condition on potentials has a row for each zone or pair of neighbours."""
        return self.of_zones is not None and self.of_zones.of_levels

    @cached_property
    def of_zones(self) -> ByZone | None:
        """The first side condition with a row for each zone or pair of neighbours, or None."""
        found = (by_zone(c, self.zones) for c in self.equation.conditions)
        return next((one for one in found if one is not None), None)

    @cached_property
    def springs(self) -> Array:
        """The factor of c_0 divided by the factor of the level, in each zone's side condition.
        c_0 is the first coefficient of the zone's density, and the level is the constant part of
        the potential on the zone. The result is 0 if the condition contains no level, or
        differences of levels.
        """
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
        """Differences between neighbouring zones of `level_constants`, the known parts of levels.
        A level is the constant part of the potential on a zone.

        The differences are computed without the cancellation of large values.
        """
        return (
            np.diff(self.known_field[1]) + np.diff(self._known_rest) - self._forcing_differences()
        )

    @property
    def _known_rest(self) -> Array:
        # A rim is a zone with two different given values of the density at its ends. The known
        # change from one value to the other lies at the middle of the rim, however wide it is. So
        # the true width (`Zones.depth`) is not used here.
        none = np.zeros(len(self.zones))
        return self._with_own(self.layout.flat(self.known), self.known_field[2], none)

    @property
    def integrated(self) -> bool:
        """Whether integrals of the right side give the differences of its primitive."""
        forcing = self.equation.forcing
        return (
            forcing.resolution.length is not None
            and not forcing.value_jumps
            and not self.zones.have_values
        )

    def _forcing_differences(self) -> Array:
        """Mean of the right side's primitive over each zone, minus the mean over the previous zone.

        The rise across the gap comes from quadrature of the right side g. The rise along the zones
        comes from the coefficients of g, since the antiderivative of U_{k-1} is T_k / k.
        """
        zones, solved, forcing = self.zones, self.zones.solved, self.equation.forcing
        if not self.integrated:
            return np.diff(self._forcing_means())
        if self.rough:  # the round-off of the primitive is accurate enough
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
        """(integrals of the right side g over the gaps, their errors due to rounded positions).

        Positions are rounded to half a unit in the last digit. The error is zero if the forcing
        takes exact positions.
        """
        forcing = self.equation.forcing
        assert forcing.resolution.length is not None
        start, rest, length = self._gaps
        panels = np.ceil(length / (_OPTIONS.lengths_per_panel * forcing.resolution.length)).astype(
            np.intp
        )
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
        """(left end, rounded-off digits of the left end, length) of each gap between zones."""
        zones, solved = self.zones, self.zones.solved
        left, rest = zones.b[solved[:-1]], zones.rest[1, solved[:-1]]
        return left, rest, (zones.a[solved[1:]] - left) + (zones.rest[0, solved[1:]] - rest)

    def level_changes(self, y: Array) -> Array:
        return self.applied(y)[1].level

    def level_rounding(self, y: Array) -> Array | float:
        """Estimated round-off of the level of each zone, the constant part of the potential on it.

        The level is the mean of the potential minus the primitive of the right side. If a condition
        contains the level of each zone, the round-off is that of all terms of a level. These terms
        are at most the sum of all totals times the logarithm of the largest distance, plus the
        largest term of a zone's own total. Otherwise only differences between the levels of
        neighbours matter, and the round-off is that of the terms that differ.
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
        # Two neighbouring zones share the far field of the smallest tree node that contains both.
        # The round-off of this field cancels in the difference of the zones' potentials.
        apart = np.maximum(slope * self._gaps[2], typical * self.sums.far.targets.tree.parted)
        steps = 2.2e-16 * apart + (
            self._across_gaps[1] if self.integrated and not self.rough else 0.0
        )
        # With a period, the last zone and the image of the first zone are neighbours too. The
        # difference of their potentials is minus the sum of all other differences.
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
    """Quantities that side conditions use (integrals, levels, intensities), for unknowns y.

    The class implements `conditions.Rows`. Each matrix has one column with the values for y. edges:
    intensities K at the left and right ends of the solved zones (2, n), if they are not to be
    computed from y.
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
        """The intensities K at the fixed ends where K is prescribed, left ends first.
        K is the coefficient of 1 / sqrt(distance) in the density close to an end.
        """
        pairs = list(zip(self.zones.fixed_bounded, self.intensities(), strict=True))
        matrix, constants = (
            np.concatenate([linear[part][chosen] for chosen, linear in pairs]) for part in (0, 1)
        )
        return matrix, constants

    def on_plateaus(self, weight: Callable[[Array], Array] | None = None) -> float:
        return self.system.on_plateaus(weight)

    def amplitude(self, k: int) -> Linear:
        return self.y[[[self.system.layout.amplitude(k)]]], np.zeros(1)
