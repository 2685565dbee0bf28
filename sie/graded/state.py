"""Solutions on zones with graded coordinates: solving, stated errors, and responses."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import EPS, HALF_DIGITS, SUM_ROUNDING, Array, Index, Mask, root_of_squares
from sie.basis.zones import Zones
from sie.dense import modes
from sie.dense.lu import Factored
from sie.dense.system import condition_rows
from sie.equation.checks import check_functions
from sie.equation.conditions import speaks_of_levels
from sie.equation.equation import Equation
from sie.graded.density import GradedDensity
from sie.graded.system import (
    OPTIONS,
    GradedSystem,
    even_sizes,
    exact_gaps,
    first_sizes,
    gradings_of,
)
from sie.states.base import Answered
from sie.states.options import OPTIONS as ERRORS
from sie.states.rounding import primitive_rounding
from sie.states.sizes import Sizes
from sie.states.solve import SingularSystem, TooLarge, not_finite, regular_factors


def is_graded(equation: Equation, zones: Zones) -> bool:
    """Whether zones get graded coordinates, because a fixed end lies next to a narrow gap.

    Moving ends must have the prescribed intensity zero, no end may have a given value of the
    density, and there must not be too many unknowns. `TooLarge` is raised if there are too many
    unknowns and plain coordinates do not suffice.
    """
    fixed_left, fixed_right = ~zones.moves
    if zones.follow_ends or zones.have_values or not (fixed_left.any() or fixed_right.any()):
        return False
    before, after = exact_gaps(zones, equation.kernel)
    width = 2 * zones.half
    # Entry i of `fixed` and `narrow` describes the gap between zone i and the next zone.
    fixed = fixed_right | np.roll(fixed_left, -1)
    narrow = after < OPTIONS.max_gap * np.maximum(width, np.roll(width, -1))
    if not np.any(narrow & fixed):
        return False
    plain = -np.log(EPS) / modes.decay(zones, equation.kernel)
    if plain.sum() <= OPTIONS.min_plain_unknowns:
        return False
    unknowns = int(first_sizes(gradings_of(zones, equation.kernel)).sum())
    # Estimated error if coordinates are not graded. The field that a zone causes across the
    # narrowest gap is a series with the largest number of modes; `left` is the relative size of its
    # last coefficient.
    left = np.exp(-modes.OPTIONS.max_modes * modes.decay(zones, equation.kernel).min())
    if unknowns > OPTIONS.max_unknowns and left > modes.OPTIONS.nearly_decayed:
        raise TooLarge(
            f"{len(zones)} zones with gaps as narrow as {after.min():.1e} need at least {unknowns} "
            f"unknowns, but at most {OPTIONS.max_unknowns} are possible: use fewer zones or wider "
            "gaps"
        )
    return unknowns <= OPTIONS.max_unknowns


@dataclass(frozen=True, eq=False)
class GradedState(Answered):
    """Solution on zones with graded coordinates, which are refined next to narrow gaps.
    It has the same members as `State`, the solution in ordinary coordinates.

    density: the wanted function; solver: LU factors of the rows; conditions_from: index of the
    first row of the side conditions; condition_scale: scales of these rows; row_sizes: root of the
    sum of squares of each row's terms; sizes: numbers of modes, and counts of evaluations;
    value_changes: changes of the side conditions' values, see `with_value`.
    """

    density: GradedDensity
    solver: Factored = field(repr=False)
    conditions_from: int
    condition_scale: Array = field(repr=False)
    row_sizes: Array = field(repr=False)
    sizes: Sizes = field(repr=False)
    value_changes: Array = field(repr=False)

    @property
    def system(self) -> GradedSystem:
        return self.density.system

    @property
    def whole(self) -> Any:
        """The solution with no gap treated as a slit: this object itself."""
        return self

    def wide_of(self, zones: Index) -> tuple[Any, Index]:
        """(solution with no gap treated as a slit, indices of the given zones in that solution).

        In this class no gap is treated as a slit, so the solution is this object itself.
        """
        return self, zones

    @property
    def direct(self) -> Factored:
        """The solver: LU factors of a matrix."""
        return self.solver

    @property
    def kept(self) -> Index:
        """Number of Chebyshev coefficients of the density on each zone (Z,)."""
        return self.system.sizes

    @property
    def truncation(self) -> Array:
        """Relative size of the last coefficients of each zone, the same as `tails`.
        Here the right side is not expanded in a series of its own.
        """
        return self.tails

    @property
    def iteration(self) -> None:
        """None, because the unknowns are not computed by an iterative solver."""
        return None

    @property
    def unresolved(self) -> bool:
        """Whether even the largest number of modes does not resolve the equation on the zones."""
        return bool(
            np.any((self.system.sizes >= OPTIONS.max_modes) & (self.tails > ERRORS.negligible))
        )

    # The methods below give solutions for other values of the side conditions.
    def response(self, values: Array, tolerance: float = 0.0) -> GradedDensity:
        """Change of the density if the values of the side conditions change by `values`."""
        return replace(
            self.density, unknowns=self._answer(values), bounded_ends=False, forced=False
        )

    def _answer(self, values: Array) -> Array:
        """Changes of the unknowns if the side conditions' values change by `values`."""
        right = np.zeros(self.solver.size)
        right[self.conditions_from :] = values / self.condition_scale
        return self.system.unfold(self.solver(right))

    def with_value(self, condition: int, change: float) -> GradedState:
        """The solution after the value of one side condition has changed by `change`."""
        values = self.values(condition, change)
        density = replace(self.density, unknowns=self.density.unknowns + self._answer(values))
        return replace(self, density=density, value_changes=self.value_changes + values)

    @property
    def levels(self) -> Array:
        """Level of each solved zone: mean of (potential minus primitive of the right side)."""
        rows, constants = self.system.levels()
        return np.asarray(rows @ self.density.unknowns + constants)

    def level_rates(self, values: Array) -> Array:
        """Changes of the zones' `levels` if the side conditions' values change by `values`.
        The level of a zone is the mean of the potential minus the primitive of the right side.
        """
        return np.asarray(self.system.levels()[0] @ self._answer(values))

    # The methods below estimate errors of the solution. Charges are values of the function phi
    # sqrt(1 - s^2) dx/ds, with the density phi and the graded coordinate s.
    @cached_property
    def tails(self) -> Array:
        """For each zone (Z,), the largest of its last four coefficients over that of all of them.
        This ratio shows whether there are enough modes.
        """
        c, out = np.abs(self.density.divided), np.zeros(len(self.density.zones))
        for zone, n in enumerate(self.system.sizes.tolist()):
            out[zone] = _ratio(c[zone, n - 4 : n].max(), c[zone].max())
        return out

    @property
    def field_tail(self) -> float:
        return float(self.tails.max())

    @cached_property
    def charge_sizes(self) -> Array:
        """Largest value of the density times sqrt(1 - s^2) dx/ds on each zone (Z,)."""
        out = np.zeros(len(self.density.zones))
        for zone, places in enumerate(self.system.sources):
            charges = self._values(zone) * places.rate * np.sqrt(places.left * places.right)
            out[zone] = np.abs(charges).max()
        return out

    def _values(self, zone: int) -> Array:
        """Values of the density at the nodes of a zone, with 0 in place of infinite values."""
        values = self.density.on(zone, self.system.sources[zone])
        return np.where(np.isfinite(values), values, 0.0)

    @property
    def natural(self) -> Array:
        """Largest coefficient of each zone's series except the first one.
        The first coefficient gives the total of the density.
        """
        return np.asarray(np.abs(self.density.coefficients[:, 1:]).max(axis=1, initial=0.0))

    @property
    def linear_error(self) -> Array:
        return np.zeros(len(self.density.zones))

    @property
    def noise(self) -> Array:
        """Round-off of the right side, not yet contained in `residuals`: zero on each zone."""
        return np.zeros(len(self.density.zones))

    @cached_property
    def residuals(self) -> Array:
        """Size of the residual of each row of the equation, then of each side condition.

        The charges are interpolated to twice as many nodes. The residual of a row is the largest
        one at the row's own node and at the new nodes on both sides of this node. Close to a gap
        the terms of a row may be tiny, and so is the row's residual.
        """
        system, zones = self.system, self.density.zones
        finer = GradedSystem(self.equation, zones, 2 * system.sizes, self.density.jumps)
        matrix, right = finer.equation_rows()
        rows, values = condition_rows(self.equation, finer, finer.size)
        unknowns = system.on_finer(self.density.unknowns, self.density.powers, finer)
        wrong = np.abs(matrix @ unknowns - right)
        out, start = [], 0
        for zone in zones.solved.tolist():
            count = system.row_count(zone)
            row = start + 1 + 2 * np.arange(count)
            after = np.minimum(row + 1, start + finer.row_count(zone) - 1)
            out.append(np.maximum(np.maximum(wrong[row - 1], wrong[row]), wrong[after]))
            start += finer.row_count(zone)
        wrong = np.abs(rows @ unknowns - values - self.value_changes) / self.condition_scale
        return np.concatenate((*out, wrong))

    @cached_property
    def missing(self) -> Array:
        """Estimated sum of the neglected coefficients of each zone's series (Z,)."""
        c, out = np.abs(self.density.divided), np.zeros(len(self.density.zones))
        for zone, n in enumerate(self.system.sizes.tolist()):
            last, before = c[zone, n - 4 : n].max(), c[zone, n // 2 - 2 : n // 2 + 2].max()
            fall = min(last / before, 0.99) ** (2.0 / n) if before > 0.0 else 0.0
            out[zone] = last * fall / (1 - fall)
        return out

    @cached_property
    def _change_series(self) -> Array:
        """Changes of each zone's series (samples, Z, n) by random errors of the linear system."""
        system, chance = self.system, np.random.default_rng(0)
        errors, rows = np.hypot(EPS * self.row_sizes, self.residuals), self.conditions_from
        if any(speaks_of_levels(one, system.zones) for one in self.equation.conditions):
            period = self.density.kernel.period
            noise = primitive_rounding(self.equation.forcing, system.zones, period)
            errors[rows:] = np.hypot(errors[rows:], noise / self.condition_scale)
        shaken = errors[:, None] * chance.standard_normal((self.solver.size, ERRORS.samples))
        changes = system.unfold(self.solver(shaken)).T
        return ERRORS.safety * np.array(
            [system.series(one, self.density.powers) for one in changes]
        )

    @cached_property
    def _errors(self) -> tuple[Array, Array, Array]:
        """For each zone: (error of phi sqrt(1 - t^2), its largest value, error of the charges).
        phi: density; t: coordinate on the zone. Charges are values of phi sqrt(1 - s^2) dx/ds, with
        the graded coordinate s.
        """
        system = self.system
        errors, sizes, charges = np.zeros((3, len(system.zones)))
        for zone, places in enumerate(system.sources):
            grading, powers = system.gradings[zone], self.density.powers[:, zone]
            scale = grading.scale(places, powers)
            root = np.sqrt(places.from_a * places.from_b) / system.zones.half[zone] / places.rate
            over = root / np.sqrt(places.left * places.right)
            sizes[zone] = float((np.abs(self._values(zone)) * root * places.rate).max())
            changed = chebyshev.t_values(
                self._change_series[:, zone, : system.sizes[zone]], int(system.sizes[zone])
            )
            wrong = scale * (np.abs(changed).max(axis=0) + self.missing[zone])
            errors[zone], charges[zone] = float((wrong * over).max()), float(wrong.max())
        return errors, sizes, charges

    @property
    def zone_sizes(self) -> Array:
        """Largest value of the density times sqrt(1 - t^2) on each zone (Z,)."""
        return self._errors[1]

    @property
    def size(self) -> float:
        """Largest value of the density times sqrt(1 - t^2) on all zones."""
        return float(self.zone_sizes.max())

    @cached_property
    def density_error(self) -> float:
        """Estimated relative error of the density phi, and of the charges phi sqrt(1 - s^2) dx/ds.
        s is the graded coordinate on a zone.

        It is the sum of two relative errors: that of the density times sqrt(1 - t^2), and that of
        the charges. Next to a narrow gap the density may be orders of magnitude larger than on
        the rest of the zones; charges are not.
        """
        errors, sizes, charges = self._errors
        return _ratio(errors.max(), sizes.max()) + _ratio(charges.max(), self.charge_sizes.max())

    @cached_property
    def zone_errors(self) -> Array:
        """Estimated relative error of density and charges on each zone (Z,).
        It is computed as `density_error`, but from the errors and sizes on this zone alone.
        """
        errors, sizes, charges = self._errors
        of_charges = zip(charges, self.charge_sizes, strict=True)
        pairs = zip(zip(errors, sizes, strict=True), of_charges, strict=True)
        return np.array([_ratio(*one) + _ratio(*other) for one, other in pairs])

    @cached_property
    def density_rounding(self) -> Array:
        """Error of the density times sqrt(1 - t^2) on each zone (Z,).
        It is caused by errors of the rows of the linear system, such as round-off.
        """
        return self._errors[0]

    def _intensity_errors(self, of_ends: Array) -> Array:
        """Errors of the intensities K, from errors `of_ends` (2, Z) of the series at zone ends."""
        pairs = zip(self.system.gradings, self.density.powers.T, strict=True)
        scale = np.array(
            [one.scale(one.ends, powers) / np.sqrt(2 * one.end_rates) for one, powers in pairs]
        ).T
        return np.asarray(of_ends * scale)

    @cached_property
    def intensity_noise(self) -> Array:
        """Error (2, Z) of the intensities K at both ends, due to errors of the linear system."""
        c = self._change_series
        signs = 1.0 - 2.0 * (np.arange(c.shape[2]) % 2)
        at_ends = np.array([c @ signs, c.sum(axis=2)])
        return self._intensity_errors(np.abs(at_ends).max(axis=1))

    @cached_property
    def intensity_truncation(self) -> Array:
        """Error (2, Z) of the intensities K at both ends, due to truncation of the series."""
        return self._intensity_errors(np.array([self.missing, self.missing]))

    @cached_property
    def end_truncation(self) -> Array:
        """Error of the position of each moving end that truncation of the series causes (Z, 2).
        It is divided by the half width of the end's zone.
        """
        zones = self.density.zones
        slopes = np.where(zones.moves, np.abs(np.array(self.density.edge_slopes)), np.inf)
        return np.asarray(self.intensity_truncation / np.maximum(slopes, 1e-300) / zones.half).T

    def reason(self, tol: float) -> str:
        """The reason, as a message, for the largest part of the stated error."""
        zone = int(np.argmax(self.tails * self.charge_sizes))
        n = int(self.system.sizes[zone])
        if self.tails[zone] > 0.1 * tol and OPTIONS.growth * self.coupled > OPTIONS.max_unknowns:
            return (
                f"with {self.coupled} unknowns the last modes on zone {zone} (counted from 0) are "
                f"still {self.tails[zone]:.1e} of the largest, and at most {OPTIONS.max_unknowns} "
                "unknowns are possible with narrow gaps beside fixed ends: use fewer zones or "
                "wider gaps"
            )
        if self.tails[zone] > 0.1 * tol:
            return (
                f"on zone {zone} (counted from 0), which lies beside a narrow gap, the last of {n} "
                f"modes is {self.tails[zone]:.1e} of the largest: the right side, a column or the "
                "kernel varies too fast for these modes, is rounded or noisy, or jumps"
            )
        rounding = EPS * float(self.row_sizes.max())
        return (
            f"rounding limits the accuracy beside narrow gaps: rounding errors of {rounding:.1e} "
            "in the equation and in the side conditions change the charges (weighted values of the "
            f"density), of the size {self.charge_sizes.max():.1e}, by "
            f"{float(self._errors[2].max()):.1e}"
        )


def _ratio(error: float, size: float) -> float:
    """The quotient error / size; 0 if the size is 0."""
    return float(error / size) if size > 0.0 else 0.0


def solve_graded(equation: Equation, zones: Zones, tolerance: float, sizes: Sizes) -> GradedState:
    """The solution on zones whose coordinates are graded, that is, refined next to narrow gaps.

    Modes are added to zones until the last ones have decayed to the tolerance, or no longer decay.
    """
    if sizes.solves == 0:
        check_functions(equation, zones)
    jumps = equation.forcing.jumps_within(zones, equation.kernel)
    enough = max(ERRORS.negligible * tolerance, SUM_ROUNDING)
    count, last = first_sizes(gradings_of(zones, equation.kernel)), np.full(len(zones), np.inf)
    while True:
        if zones.symmetric:
            count = np.maximum(count, count[::-1])
        state = _solve_once(equation, GradedSystem(equation, zones, count, jumps), sizes)
        tails = state.tails
        # If more modes do not halve the relative size of the last coefficients (`tails`), these
        # coefficients are round-off.
        more: Mask = (tails > enough) & (count < OPTIONS.max_modes) & (tails < 0.5 * last)
        # Coefficients are assumed to decay exponentially, so that the number of modes is
        # proportional to the number of digits. `tails` near 1 would make `wanted` far too large, so
        # `tails` are clipped.
        digits = np.log(np.clip(tails, enough, HALF_DIGITS**0.5))
        wanted = even_sizes(np.where(more, OPTIONS.growth * np.log(enough) / digits, 1.0) * count)
        wanted = np.minimum(wanted, OPTIONS.max_modes)
        if not more.any():
            return state
        if wanted.sum() > OPTIONS.max_unknowns:
            # At most `max_unknowns` unknowns are allowed. Those not yet used are given to the zones
            # that need more, in proportion to their needs.
            spare = (OPTIONS.max_unknowns - count.sum()) / (wanted - count).sum()
            if spare * (wanted - count).max() < 2.0:
                return state
            wanted = count + 2 * (0.5 * spare * (wanted - count)).astype(np.intp)
        last, count = np.where(more, tails, last), wanted


def _solve_once(equation: Equation, system: GradedSystem, sizes: Sizes) -> GradedState:
    """The solution of the linear system with the numbers of modes that `system` has."""
    matrix, right = system.equation_rows()
    rows, values = condition_rows(equation, system, system.size)
    scale = np.abs(rows).max(axis=1, initial=0.0)
    if np.any(scale == 0):
        raise SingularSystem("a side condition does not depend on the density")
    matrix = system.fold(np.concatenate((matrix, rows / scale[:, None])))
    right = np.concatenate((right, values / scale))
    if not (np.all(np.isfinite(matrix)) and np.all(np.isfinite(right))):
        raise SingularSystem(not_finite(equation, system.source_x))
    solver = regular_factors(equation, matrix)
    y = solver(right)
    # One step of iterative refinement reduces the error of each row to the round-off of the row's
    # own terms (R. D. Skeel, Math. Comp. 35, 1980, 817-832). Next to a gap these terms are tiny.
    y = y + solver(right - matrix @ y)
    sizes.solves += 1
    sizes.profile_evaluations += system.nodes
    sizes.kernel_evaluations += matrix.size
    return GradedState(
        GradedDensity(system, system.unfold(y)),
        solver,
        len(right) - len(scale),
        scale,
        np.hypot(root_of_squares(matrix, y), right),
        sizes,
        np.zeros(len(scale)),
    )
