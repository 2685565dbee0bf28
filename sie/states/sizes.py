"""Numbers of unknowns of the zones, and data that one solution passes to the next."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Index, Mask, record, wrapped
from sie.basis.zones import Zones
from sie.dense import modes
from sie.dense.system import Layout, System
from sie.equation.checks import check_functions
from sie.equation.equation import Equation
from sie.fast.coarse import CoarseOperator
from sie.fast.system import IterativeSystem
from sie.states.options import OPTIONS
from sie.trees.panels import panels_over


@dataclass(eq=False)
class Sizes:
    """Numbers of modes with which a solve starts, and other data kept from the last solve.

    own: number of coefficients of the right side on each zone; least: number of coupled modes of
    each zone; carried: see `Carried`; coarse: coarse operator of an iteration, reused while zones
    change little; primitive_rounding: round-off of the right side's primitive, once it is known;
    linear: relative tolerance of an iteration, 0 for the round-off limit; rough: whether sums with
    an error of 1e-7 are accurate enough; start: whether the solution is only the start of another
    one, so that the first guess is accepted; iterations, solves, profile_evaluations,
    kernel_evaluations: counts so far; value: value of the open condition, used by an iteration;
    growth: see `modes.Growth`; wide, joined: see below.
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
    coarse: CoarseOperator | None = None
    primitive_rounding: float | None = None
    growth: modes.Growth | None = None
    wide: Sizes | None = None
    """Sizes of the wide zones that are made by joining zones, if narrow gaps are slits."""
    joined: Mask | None = None
    """Mask of the zones to whose right a narrow gap was treated as a slit."""

    def of(self, kept: Index) -> Sizes:
        """These sizes for a part of the zones: those with the indices `kept`."""
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
    """Data of an iterative solution that give a first guess of the next solution.

    If a free end moves by d, the density at fixed positions changes by the order d^2. So do the
    total of the end's zone and the field that this zone causes on other zones. Totals and fields
    are therefore carried over. The coefficients of the right side are known on any zones.

    middle, half: middles and half widths of the zones (n,); totals: integrals of the density over
    them, divided by pi (n,); field: coefficients in U_{k-1}, k = 1 ... m, of the field of the other
    zones on each zone, at the index offset + k. Beyond the coupled modes they are those of the
    zone's slits. amplitudes: those of the columns.
    """

    middle: Array
    half: Array
    totals: Array
    field: Array
    layout: Layout
    amplitudes: Array

    @classmethod
    def of(cls, system: System, y: Array, slits: dict[int, Array]) -> Carried:
        """The data to carry over from the solution with unknowns y: totals and fields of zones.

        slits: for each zone with slits, the coefficients that its slits add to its own.
        """
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
        return cls(zones.middle, zones.half, totals, field, layout, y[coupled.coefficients :])

    def near(self, system: IterativeSystem) -> Array:
        """Predicted unknowns of another system, from which the iteration of that system starts."""
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
        """Index of the stored zone that corresponds to each new zone; -1 if there is none.

        The new zone's middle lies in the stored one, and their widths differ by less than a factor
        of two.
        """
        i = np.maximum(np.searchsorted(self.middle - self.half, middle, side="right") - 1, 0)
        alike = (
            (np.abs(middle - self.middle[i]) < self.half[i])
            & (half < 2 * self.half[i])
            & (2 * half > self.half[i])
        )
        return np.where(alike, i, -1)

    def _totals(self, middle: Array, half: Array, place: Index) -> Array:
        """Predicted integral of the density over each new zone, divided by pi.

        A new zone without a corresponding stored zone gets the sum over the stored zones within it.
        """
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


def first_sizes(equation: Equation, zones: Zones, tolerance: float = 0.0) -> Sizes:
    """Numbers of modes with which the first solve on the zones starts.

    If the kernel has a user's regular part, or a column has an unknown number of modes, zones start
    with a few modes, and more are added later. Else the distances between the zones determine the
    numbers. tolerance: truncation tolerance of the coefficients; that of an iteration is a fraction
    of it.
    """
    check_functions(equation, zones)
    least: int | Index
    panels = panels_over(equation.kernel, zones)
    if panels is not None and all(
        column.resolution.modes is not None for column in equation.columns
    ):
        least = np.minimum(panels.modes(zones.half), modes.least(zones, equation.kernel))
    elif equation.grows:
        least = modes.least(zones, equation.kernel)
    else:
        least = max((column.resolution.modes or 0 for column in equation.columns), default=0)
    own = modes.own_at_first(zones, equation.forcing.jumps.singular_at, equation.kernel.period)
    return Sizes(own, least, linear=OPTIONS.negligible * tolerance)


def sizes_like(left: Sizes, equation: Equation, zones: Zones, last: bool) -> Sizes:
    """Numbers of modes to start with, from those of a solution on about the same zones.

    left: the `Sizes` of that solution. If the number of zones differs, the result is that of
    `first_sizes`. last: whether no further solution starts from `left`; then the unknowns in `left`
    are passed on as the first guess of an iteration.
    """
    alike = len(left.own) == len(zones)
    if last:
        # `joined`, the mask of gaps treated as cuts (slits) in wide zones, is valid only for the
        # same number of zones.
        kept = {
            name: getattr(left, name)
            for name in ("carried", "coarse", "solves", "primitive_rounding")
        }
        return replace(first_sizes(equation, zones), joined=left.joined if alike else None, **kept)
    if not alike:
        return first_sizes(equation, zones)
    return Sizes(
        left.own,
        left.least,
        primitive_rounding=left.primitive_rounding,
        wide=left.wide and replace(left.wide, carried=None),
    )
