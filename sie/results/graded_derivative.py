"""The derivative of a solution on zones with graded coordinates, whose fixed ends stay in place."""

from dataclasses import replace

import numpy as np

from sie.basis.data import Array
from sie.equation.checks import check_functions
from sie.equation.forcing import Forcing
from sie.graded.density import GradedDensity
from sie.graded.state import GradedState
from sie.graded.system import GradedSystem
from sie.results.derivative import (
    OPTIONS,
    Change,
    Derivative,
    LinearEquations,
    end_rates_of,
    known_parts,
)


class GradedLinearized(LinearEquations):
    """Linear equations for the derivative of a solution on zones next to narrow gaps.

    The rows are those of `sie.graded.system`, whose right sides are values at nodes.
    """

    def __init__(self, state: GradedState, change: Change) -> None:
        super().__init__(state.with_bounded_ends(), change)
        self.changed: GradedSystem | None = None
        rows = np.concatenate((change.values, change.held(self.zones)))
        out = np.zeros(state.solver.size)
        if change.forcing is not None:
            self.changed = system = self._changed_system(change.forcing)
            out[: state.conditions_from] = system.equation_rows()[1]
            rows = rows - known_parts(system, system, system.size)
        out[state.conditions_from :] = rows / state.condition_scale
        if not np.isfinite(out).all():
            raise ValueError("the change of the right side is not finite on the zones")
        self.right = out

    def _changed_system(self, forcing: Forcing) -> GradedSystem:
        """The linear system whose right side is `forcing`, the change of the original forcing."""
        equation = replace(self.system.equation, forcing=forcing)
        check_functions(equation, self.zones)
        jumps = forcing.jumps_within(self.zones, equation.kernel)
        return GradedSystem(equation, self.zones, self.system.sizes, jumps)

    def density(self, y: Array) -> GradedDensity:
        """The derivative of the density, with the unknowns y.
        It also has the jumps that `change.forcing` causes, if there is a forcing.
        """
        forced = self.changed is not None
        system = self.changed or self.system
        return GradedDensity(system, y, bounded_ends=False, forced=forced)

    def answer(self, right: Array) -> tuple[Array, Array]:
        y = self.system.unfold(self.state.solver(right))
        k = np.array(self.density(y).intensities)
        return y, end_rates_of(self.state.density, self.change.intensities - k)

    def derivative(self) -> Derivative:
        y, outward, value = self.solved()
        density, zones = self.density(y), self.zones
        for zone, n in enumerate(self.system.sizes.tolist()):
            c = np.abs(density.divided[zone, :n])
            if c[-4:].max() > OPTIONS.max_tail * c.max():
                raise ValueError(
                    f"the change of the right side is not resolved on zone {zone} (counted from 0)"
                )
        given = np.isnan(zones.intensities)
        k = np.where(given, np.array(density.intensities), self.change.intensities)
        ends = (outward * [[-1.0], [1.0]]).T
        return Derivative(density, ends, k, density.amplitudes, value)
