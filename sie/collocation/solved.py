"""A solution on given zones, without what its error is made of (see `fixed`): unknowns, and answers
to further right sides.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Index, Kept, Mask, record, row_sizes, wrapped
from sie.collocation import modes
from sie.collocation.factored import Factored
from sie.collocation.iterative import CoarseOperator, Iterative, IterativeSystem
from sie.collocation.system import Layout, MirrorSymmetry, System
from sie.density.density import Density
from sie.equation.conditions import of_levels, speaks_of_levels
from sie.equation.equation import Equation
from sie.jumps.forcing import ForcingJumps

# With the last coupled coefficients above this part of the largest, zones lie too close to what is
# singular beside them.
UNRESOLVED = 1e-6


@dataclass(eq=False)
class Sizes:
    """Modes to start from; kept from one solve to the next so that growth is paid for once.

    primitive_rounding: of the right side's primitive, once it has been looked at. linear: tolerance
    of solutions by iteration, relative; 0: as tight as rounding allows. rough: whether sums to 1e-7
    will do for them. start: whether they are no more than a start, for which those of the last
    solve will do. iterations: their number so far. value: of the open condition, if there is one,
    with which these are found.
    """

    own: Index
    least: int | Index
    profile_evaluations: int = 0
    kernel_evaluations: int = 0
    solves: int = 0
    linear: float = 0.0
    rough: bool = False
    start: bool = False
    value: float = 0.0
    iterations: int = 0
    carried: Carried | None = None
    primitive_rounding: float | None = None
    growth: modes.Growth | None = None
    wide: Sizes | None = None
    """Those of the wide zones, where narrow gaps are slits."""
    joined: Mask | None = None
    """After which of the zones a narrow gap was a slit."""

    def of(self, kept: Index) -> Sizes:
        """Those of some of the zones."""
        least = self.least if isinstance(self.least, int) else self.least[kept]
        return replace(
            self,
            own=self.own[kept],
            least=least,
            wide=None,
            joined=None if self.joined is None else self.joined[kept],
        )


@record
class Carried:
    """What a solve by iteration leaves to the next one, on zones most of which are about the same.

    Where ends move by d, a density whose ends are about free changes by d^2 at fixed places: so do
    the total of a zone and what the others do to it, while what the right side makes of its
    coefficients is known on any zones.

    coarse: inverse; middle, half: of the zones (n,); totals: of each, over pi (n,); field: what the
    others do to each, coefficients of U_{k-1} at offset + k, k = 1 ... m (n,), and its own slits,
    which bend it beyond the coupled modes too; amplitudes: of the columns.
    """

    coarse: CoarseOperator | None
    middle: Array
    half: Array
    totals: Array
    field: Array
    layout: Layout
    amplitudes: Array

    @classmethod
    def of(
        cls, coarse: CoarseOperator | None, system: System, y: Array, slits: dict[int, Array]
    ) -> Carried:
        """slits: what those of zones that have some add to their coefficients."""
        coupled, zones = system.layout, system.zones
        m = coupled.m.copy()
        for zone, s in slits.items():
            m[zone] = max(m[zone], len(s) - 1)
        layout, totals = Layout(m, 0), zones.half * (y[coupled.offset] + system.known[:, 0])
        at = np.repeat(layout.offset - coupled.offset, coupled.m + 1) + np.arange(
            coupled.coefficients
        )
        field = np.zeros(layout.size)
        field[at] = (coupled.flat(system.lowest) + y)[: coupled.coefficients]
        for zone, s in slits.items():
            first = int(layout.offset[zone])
            field[first + coupled.m[zone] + 1 : first + len(s)] = s[coupled.m[zone] + 1 :]
        return cls(
            coarse, zones.middle, zones.half, totals, field, layout, y[coupled.coefficients :]
        )

    def near(self, system: IterativeSystem) -> Array:
        """Unknowns of another system to start from."""
        zones, layout, period = system.zones, system.layout, system.equation.kernel.period
        at = wrapped(zones.middle, float(self.middle[0] - self.half[0]), period)
        place = self._place(at, zones.half)
        y = -layout.flat(system.lowest)
        modes_of = np.where(place >= 0, self.layout.m[place], 0)
        for n in np.unique(modes_of):
            group = np.flatnonzero(modes_of == n)
            old, k = place[group], np.arange(1, n + 1)
            shift, stretch = (
                (at[group] - self.middle[old]) / self.half[old],
                zones.half[group] / self.half[old],
            )
            moved = chebyshev.u_moved(self.field[self.layout.offset[old, None] + k], shift, stretch)
            coupled = k <= layout.m[group, None]
            y[(layout.offset[group, None] + k)[coupled]] += moved[coupled]
        y[layout.offset] = self._totals(at, zones.half, place) / zones.half - system.known[:, 0]
        y[layout.coefficients :] = self.amplitudes
        return np.asarray(y[system.symmetry.keep])

    def _place(self, middle: Array, half: Array) -> Index:
        """Which of these each of other zones is, of about the same width; -1 where there is none."""
        i = np.maximum(np.searchsorted(self.middle - self.half, middle, side="right") - 1, 0)
        alike = (
            (np.abs(middle - self.middle[i]) < self.half[i])
            & (half < 2 * self.half[i])
            & (2 * half > self.half[i])
        )
        return np.where(alike, i, -1)

    def _totals(self, middle: Array, half: Array, place: Index) -> Array:
        """Totals over pi: of zones that are none of these, of those in them."""
        order = np.argsort(middle)
        within = order[
            np.maximum(np.searchsorted((middle - half)[order], self.middle, side="right") - 1, 0)
        ]
        within = np.where(np.abs(self.middle - middle[within]) < half[within], within, len(middle))
        return np.where(
            place >= 0,
            self.totals[place],
            np.bincount(within, self.totals, minlength=len(middle) + 1)[:-1],
        )


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
