"""Unknowns of a solution on given zones, and its responses to further right sides.

`sie.states.state` estimates the error of a solution.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from sie.basis.data import Array, Index, Kept, row_sizes
from sie.dense import modes
from sie.dense.lu import Factored
from sie.dense.system import MirrorSymmetry, System
from sie.density.density import Density
from sie.equation.conditions import of_levels, speaks_of_levels
from sie.equation.equation import Equation
from sie.fast.iteration import Iterative
from sie.jumps.right_side import ForcingJumps
from sie.states.reasons import reason_of
from sie.states.sizes import Sizes

# Solver of the linear system for any right side, by LU factors or by an iteration.
Solver = Factored | Iterative


class Answered(Kept):
    """Common base class of solutions with and without slits.
    A slit is a narrow gap that is treated as part of a wide zone.

    The members follow from `whole`: this solution itself or, with slits, the solution on the wide
    zones.
    """

    if TYPE_CHECKING:

        @property
        def density(self) -> Any: ...
        @property
        def whole(self) -> Any: ...
        @property
        def zone_sizes(self) -> Array: ...
        def _errors_over(self, sizes: Array) -> Array: ...

    def with_bounded_ends(self) -> Self:
        """The same solution, but its density has no terms in 1/sqrt(distance) at free ends."""
        return replace(self, density=self.density.with_bounded_ends())  # type: ignore[type-var]

    @property
    def equation(self) -> Equation:
        return self.whole.system.equation

    def right_side(self, x: Array) -> Array:
        """The equation's right side at points x, plus its columns times their amplitudes."""
        columns = zip(self.density.amplitudes, self.equation.columns, strict=True)
        return np.asarray(
            self.equation.forcing.value(x)
            + sum(amplitude * column.value(x) for amplitude, column in columns)
        )

    @property
    def condition_index(self) -> Index:
        """Index of the first row of each side condition among the rows of all side conditions."""
        counts = [c.count(self.whole.density.zones) for c in self.equation.conditions]
        return np.cumsum([0, *counts], dtype=np.intp)[:-1]

    def values(self, condition: int = 0, change: float = 1.0) -> Array:
        """Changes of the values of all side conditions, if only one condition is changed.

        The change is `change` in the first row of this condition, and zero in all other rows.
        """
        out = np.zeros(len(self.whole.condition_scale))
        out[self.condition_index[condition]] = change
        return out

    @cached_property
    def size(self) -> float:
        """Largest coefficient of the density on all zones; `density_error` is relative to it."""
        return float(self.zone_sizes.max())

    @cached_property
    def density_error(self) -> float:
        """Estimated error of the density, the largest of all zones, relative to `size`."""
        return float(self._errors_over(np.full(len(self.density.zones), self.size)).max())

    @cached_property
    def zone_errors(self) -> Array:
        """Estimated error of the density on each zone (Z,), relative to its largest coefficient."""
        return self._errors_over(self.zone_sizes)

    def reason(self, tol: float) -> str:
        """The reason, as a message, why the stated error is not below `tol`."""
        return reason_of(self, tol)

    @property
    def coupled(self) -> int:
        """Number of unknowns of the linear system for all zones together."""
        return int(self.whole.solver.size)

    @property
    def iterated(self) -> bool:
        """Whether the unknowns were computed by an iteration, not by LU factors."""
        return self.whole.iteration is not None

    @property
    def unresolved(self) -> bool:
        """Whether even the largest number of modes does not resolve the equation on the zones.

        Then a zone lies too close to a singularity, or a user's function varies too much.
        """
        most_modes = int(self.whole.system.layout.m.max()) >= modes.most(self.equation.kernel)
        return most_modes and self.whole.field_tail > modes.OPTIONS.nearly_decayed


class Resolved(Answered):
    """Base class of solutions in which every gap is resolved: none is treated as a slit."""

    @property
    def whole(self) -> Any:
        """The solution in which every gap is resolved: this object itself."""
        return self

    def wide_of(self, zones: Index) -> tuple[Any, Index]:
        """(solution in which every gap is resolved, indices of the given zones in it).
        The solution is this object itself.
        """
        return self, zones


@dataclass(frozen=True, eq=False)
class Solved(Resolved):
    """Base class of `State`: a solution's data, and its responses to changed side conditions."""

    density: Density
    system: System
    solver: Solver = field(repr=False)
    unknowns: Array
    folded_unknowns: Array
    conditions_from: int
    condition_scale: Array
    truncation: Array
    tails: Array
    linear_error: Array
    sizes: Sizes

    def response(self, values: Array, tolerance: float = 0.0) -> Density:
        """The change of the density if the side conditions' values change by `values`.

        tolerance: relative tolerance of an iterative solution.
        """
        return self.homogeneous(self.response_unknowns(values, tolerance))

    def response_unknowns(self, values: Array, tolerance: float = 0.0) -> Array:
        """Changes of the unknowns if the side conditions' values change by `values`."""
        right, iteration = self.right_of(values), self.iteration
        return self.symmetry.unfold(
            self.solver(right) if iteration is None else iteration(right, None, tolerance)
        )

    def right_of(self, values: Array) -> Array:
        """Right side of the system for given condition values and a zero right side g."""
        right = np.zeros(self.solver.size)
        right[self.conditions_from :] = values / self.condition_scale
        return right

    def with_value(self, condition: int, change: float) -> Self:
        """The solution after the value of one side condition has changed by `change`."""
        folded = self.folded_unknowns + self.solver(self.right_of(self.values(condition, change)))
        unknowns = self.symmetry.unfold(folded)
        return replace(
            self,
            folded_unknowns=folded,
            unknowns=unknowns,
            density=density_of(self.system, unknowns),
        )

    @property
    def checked_zones(self) -> Index:
        """Indices of the zones on which the residual of the equation is evaluated."""
        return self.density.zones.solved

    @property
    def rest(self) -> float:
        """Change in the last step of the iteration between zones and slits; 0 without slits."""
        return 0.0

    @property
    def symmetry(self) -> MirrorSymmetry:
        return self.system.symmetry

    @property
    def levels(self) -> Array:
        """Level of each solved zone: mean of the potential minus the right side's primitive."""
        return self.system.level_changes(self.unknowns) + self.system.level_constants

    def level_rates(self, values: Array) -> Array:
        """Changes of the solved zones' `levels` for given changes of the side conditions' values.
        The level of a zone is the mean of the potential minus the primitive of the right side.
        """
        return self.system.level_changes(self.response_unknowns(values))

    @cached_property
    def natural(self) -> Array:
        """Largest coefficient of the density on each zone, without c_0.
        c_0 is given by the total of the density on the zone.
        """
        return coefficient_sizes(self.density, 1)

    @property
    def direct(self) -> Factored | None:
        """The solver if it has LU factors of a matrix; None if it is an iteration."""
        return self.solver if isinstance(self.solver, Factored) else None

    @property
    def iteration(self) -> Iterative | None:
        """The solver if it is an iteration; None if it has LU factors of a matrix."""
        return self.solver if isinstance(self.solver, Iterative) else None

    @property
    def field_tail(self) -> float:
        """Largest of the relative sizes `tails` of last coupled modes, over all zones.
        It is small if the zones have enough modes.
        """
        return float(self.tails.max())

    @cached_property
    def level_rows(self) -> Array:
        """Coefficients (rows, solved zones) of the zones' levels in the rows of side conditions.
        The level of a zone is the mean of the potential minus the primitive of the right side.
        """
        zones = self.density.zones
        out = np.zeros((len(self.condition_scale), len(zones.solved)))
        for condition, first in zip(self.equation.conditions, self.condition_index, strict=True):
            count = condition.count(zones)
            if count and speaks_of_levels(condition, zones):
                out[first : first + count] = of_levels(condition, zones)
        return out / self.condition_scale[:, None]

    def homogeneous(self, y: Array) -> Density:
        """The density that the unknowns y describe if the right side is zero and has no jumps."""
        layout, density = self.system.layout, self.density
        return Density(
            density.zones,
            density.kernel,
            layout.padded(y),
            ForcingJumps.none(),
            y[layout.coefficients :],
        )


def coefficient_sizes(density: Density, start: int = 0) -> Array:
    """The largest density coefficient of each zone (Z,) from index `start` on, jumps included."""
    sizes = row_sizes(density.coefficients[:, start:])
    if len(density.jumps) == 0:
        return sizes
    count = modes.OPTIONS.first_nodes
    leading = density.first(count)[:, start:]
    return np.maximum(row_sizes(leading), row_sizes(density.coefficients[:, count:]))


def density_of(system: System, y: Array) -> Density:
    """The density with the unknowns y, plus the known parts that the right side causes.

    The coefficients up to the last coupled mode come from y. Higher coefficients are minus those of
    the right side.
    """
    layout, g = system.layout, system.g
    out = np.zeros((len(layout.m), max(layout.given.shape[1], g.shape[1])))
    np.negative(g, out=out[:, : g.shape[1]])
    coupled = out[:, : layout.given.shape[1]]
    coupled[layout.given] = y[: layout.coefficients] - system.taken[layout.given]
    return Density(
        system.zones, system.equation.kernel, out, system.jumps, y[layout.coefficients :]
    )
