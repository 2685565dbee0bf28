"""The derivative of a solution of an equation with kappa, for fixed ends that stay in place.

The derivative of the density at fixed x is a density of the same equation, with the changes of the
right side and of the conditions' values. At distance d from a free end the density is A d^(1-p),
with an exponent p that follows from kappa. A motion e of the end adds (1 - p) A e d^(-p) to the
density at fixed x. The derivative has the term k d^(-p) there, so that e = k / ((1 - p) A).
"""

from dataclasses import replace

import numpy as np

from sie.basis.data import Array
from sie.equation.checks import check_functions
from sie.equation.forcing import Forcing
from sie.results.derivative import (
    OPTIONS,
    Change,
    Derivative,
    LinearEquations,
    end_rates_of,
    known_parts,
)
from sie.second_kind.density import SecondKindDensity
from sie.second_kind.jumps import known_parts as known_densities
from sie.second_kind.state import OPTIONS as STATES
from sie.second_kind.state import SecondKindState, density_of
from sie.second_kind.system import SecondKindRows


class SecondKindLinearized(LinearEquations):
    """Linear equations for the derivative of a solution along `change`.
    The integral equation is of the second kind: it contains kappa times the density.

    Raises ValueError for ends with a given value, for free ends with a given intensity that is not
    zero, and for a solution by an iteration.
    """

    def __init__(self, state: SecondKindState, change: Change) -> None:
        super().__init__(state, change)
        self.changed: SecondKindRows | None = None
        if state.iterated or self.zones.follow_ends or self.zones.have_values:
            raise ValueError(
                "with kappa, derivatives are not known for solutions by an iteration (many zones), "
                "for given values at ends, or for given intensities at free ends"
            )
        held = np.array(change.held(self.zones))
        rows = np.concatenate((change.values, held)).astype(self.zones.weight.numbers)
        count = state.solver.size - len(rows)
        equation_right = np.zeros(count, dtype=rows.dtype)
        if change.forcing is not None:
            self.changed = self._changed_system(change.forcing)
            targets, sines = self.changed.points
            equation_right = sines * self.changed.right_side(targets)
            rows = rows - known_parts(self.changed, self.changed, self.system.layout.size)
        self.right = np.concatenate((equation_right, rows / state.condition_scale))
        if not np.isfinite(self.right).all():
            raise ValueError("the change of the right side is not finite on the zones")

    def _changed_system(self, forcing: Forcing) -> SecondKindRows:
        """The linear system whose right side is `forcing`, the change of the original forcing."""
        equation = replace(self.system.equation, forcing=forcing)
        check_functions(equation, self.zones)
        jumps = known_densities(forcing, self.zones, equation.kernel.period)
        return SecondKindRows(equation, self.zones, self.system.layout, jumps)

    def density(self, y: Array) -> SecondKindDensity:
        """The derivative of the density, with the unknowns y and the jumps of `change.forcing`."""
        return density_of(self.changed or self.system, y, self.changed is None)

    def answer(self, right: Array) -> tuple[Array, Array]:
        y = self.state.solver(right)
        if not self.zones.moves.any():
            return y, np.zeros((2, len(self.zones)))
        return y, end_rates_of(self.state.density, -np.array(self.density(y).intensities))

    def derivative(self) -> Derivative:
        y, outward, value = self.solved()
        density = self.density(y)
        table, modes = np.abs(density.coefficients), self.system.layout.m.tolist()
        last = [row[: m + 1][-STATES.last :].max() for row, m in zip(table, modes, strict=True)]
        if max(last) > OPTIONS.max_tail * table.max():
            raise ValueError(
                "the change of the right side is not resolved on zone "
                f"{int(np.argmax(last))} (counted from 0)"
            )
        k = np.where(np.isnan(self.zones.intensities), np.array(density.intensities), 0.0)
        return Derivative(density, (outward * [[-1.0], [1.0]]).T, k, density.amplitudes, value)
