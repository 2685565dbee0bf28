"""A solution on given zones, without what its error is made of (see `fixed`): unknowns, and answers
to further right sides.
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
from sie.jumps.forcing import ForcingJumps
from sie.states.sizes import Sizes

# With the last coupled coefficients above this part of the largest, zones lie too close to what is
# singular beside them.
UNRESOLVED = 1e-6


# What solves the assembled rows for further right sides: by their factors, or by iteration.
Solver = Factored | Iterative


class Answered(Kept):
    """What states on plain zones and beside slits have in common, by the state without slits."""

    if TYPE_CHECKING:

        @property
        def density(self) -> Any: ...
        @property
        def whole(self) -> Solved: ...

    def with_bounded_ends(self) -> Self:
        """The same state with the density of `Density.with_bounded_ends`."""
        return replace(self, density=self.density.with_bounded_ends())  # type: ignore[type-var]

    @property
    def equation(self) -> Equation:
        return self.whole.system.equation

    def right_side(self, x: Array) -> Array:
        """The equation's right side at points."""
        columns = zip(self.density.amplitudes, self.equation.columns, strict=True)
        return np.asarray(
            self.equation.forcing.value(x)
            + sum(amplitude * column.value(x) for amplitude, column in columns)
        )

    @property
    def condition_index(self) -> Index:
        """First row of each side condition among the conditions' rows."""
        counts = [c.count(self.whole.density.zones) for c in self.equation.conditions]
        return np.cumsum([0, *counts], dtype=np.intp)[:-1]

    def values(self, condition: int = 0, change: float = 1.0) -> Array:
        """A change of the value of one side condition, the first one if none is named, among those
        of all.
        """
        out = np.zeros(len(self.whole.condition_scale))
        out[self.condition_index[condition]] = change
        return out

    @property
    def coupled(self) -> int:
        """How many unknowns are solved for together."""
        return int(self.whole.solver.size)

    @property
    def iterated(self) -> bool:
        """Whether the unknowns come from an iteration, to its tolerance."""
        return self.whole.iteration is not None

    @property
    def unresolved(self) -> bool:
        """Whether the most modes that zones are given do not show what the columns do on them."""
        return self.whole.field_tail > UNRESOLVED and int(
            self.whole.system.layout.m.max()
        ) >= modes.most(self.equation.kernel)


@dataclass(frozen=True, eq=False)
class Solved(Answered):
    """The fields of `State`, and how it answers."""

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
        """The density caused by unit changes of the side conditions' values: right side zero,
        conditions = values; tolerance: of a solution by iteration.
        """
        return self.homogeneous(self.response_unknowns(values, tolerance))

    def response_unknowns(self, values: Array, tolerance: float = 0.0) -> Array:
        """The unknowns of `response`, to be put into rows of the system."""
        right, iteration = self.right_of(values), self.iteration
        return self.symmetry.unfold(
            self.solver(right) if iteration is None else iteration(right, None, tolerance)
        )

    def right_of(self, values: Array) -> Array:
        """The right side of the rows for values of the side conditions, that of the equation zero."""
        right = np.zeros(self.solver.size)
        right[self.conditions_from :] = values / self.condition_scale
        return right

    def with_value(self, condition: int, change: float) -> Self:
        """The state after the value of one side condition has changed."""
        folded = self.folded_unknowns + self.solver(self.right_of(self.values(condition, change)))
        unknowns = self.symmetry.unfold(folded)
        return replace(
            self,
            folded_unknowns=folded,
            unknowns=unknowns,
            density=density_of(self.system, unknowns),
        )

    @property
    def symmetry(self) -> MirrorSymmetry:
        return self.system.symmetry

    @property
    def levels(self) -> Array:
        """Level of each solved zone: mean of potential minus the primitive of the right side."""
        return self.system.level_changes(self.unknowns) + self.system.level_constants

    def level_rates(self, values: Array) -> Array:
        """Change of the levels by unit changes of the side conditions' values."""
        return self.system.level_changes(self.response_unknowns(values))

    @cached_property
    def natural(self) -> Array:
        """Size of each zone's density, but for its total."""
        return coefficient_sizes(self.density, 1)

    @property
    def direct(self) -> Factored | None:
        """The solver, where it has a matrix."""
        return self.solver if isinstance(self.solver, Factored) else None

    @property
    def iteration(self) -> Iterative | None:
        """The solver, where it iterates."""
        return self.solver if isinstance(self.solver, Iterative) else None

    @property
    def field_tail(self) -> float:
        """The largest of `tails`."""
        return float(self.tails.max())

    @cached_property
    def level_rows(self) -> Array:
        """What the rows of the side conditions make of the levels of the solved zones (rows,
        zones).
        """
        zones = self.density.zones
        out = np.zeros((len(self.condition_scale), len(zones.solved)))
        for condition, first in zip(self.equation.conditions, self.condition_index, strict=True):
            count = condition.count(zones)
            if count and speaks_of_levels(condition, zones):
                out[first : first + count] = of_levels(condition, zones)
        return out / self.condition_scale[:, None]

    def homogeneous(self, y: Array) -> Density:
        """The density with unknowns y, no right side and no jumps."""
        layout, density = self.system.layout, self.density
        return Density(
            density.zones,
            density.kernel,
            layout.padded(y),
            ForcingJumps.none(),
            y[layout.coefficients :],
        )


# The largest coefficient of what jumps add to a density is among so many first ones.
LEADING_COEFFICIENTS = 8


def coefficient_sizes(density: Density, start: int = 0) -> Array:
    """The largest coefficient of the whole density on each zone, jumps included, from coefficient
    `start` on (Z,).
    """
    sizes = row_sizes(density.coefficients[:, start:])
    if len(density.jumps) == 0:
        return sizes
    leading = density.first(LEADING_COEFFICIENTS)[:, start:]
    return np.maximum(row_sizes(leading), row_sizes(density.coefficients[:, LEADING_COEFFICIENTS:]))


def density_of(system: System, y: Array) -> Density:
    """The density with unknowns y: coefficients up to m from y, those beyond minus the right
    side's.
    """
    layout, g = system.layout, system.g
    out = np.zeros((len(layout.m), max(layout.given.shape[1], g.shape[1])))
    np.negative(g, out=out[:, : g.shape[1]])
    coupled = out[:, : layout.given.shape[1]]
    coupled[layout.given] = y[: layout.coefficients] - system.taken[layout.given]
    return Density(
        system.zones, system.equation.kernel, out, system.jumps, y[layout.coefficients :]
    )
