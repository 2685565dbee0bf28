"""Preconditioned GMRES on the rows of many zones."""

import math
from collections.abc import Callable

import numpy as np
from scipy.linalg import norm

from sie.basis.data import Array
from sie.dense.system import condition_rows
from sie.fast.coarse import CoarseOperator
from sie.fast.preconditioner import TwoLevelPreconditioner
from sie.fast.system import Applied, IterativeSystem
from sie.trees.krylov import gmres

# A correction reduces the residual by this factor; there are so many corrections at most. One that
# leaves more than `_STAGNANT` of the residual is the last: rough sums leave much less, so it is
# rounding.
_CORRECTED = 1e-6
_CORRECTIONS = 6
_STAGNANT = 1e-3
# From the square of this number of zones on, the tolerance is that of each.
_ALIKE = 10.0
# Residual by rounding, over the size of the solution.
_ROUNDING = 3e-16
# Zones with less than this part of the largest coefficient are scaled as if they had it.
_LIGHTEST = 1e-4


class Iterative:
    """Solves the rows of an `IterativeSystem` for any right side.

    value: of an open condition, if there is one. Unknowns are scaled by the largest of their zone,
    so that lightly loaded zones are as accurate as others. error: the error of each zone's unknowns
    (Z,), as the last preconditioned residual has it.
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
        # Answers to random errors of the rows, with what these were made of: see `states.rounding`.
        self.random_changes: tuple[tuple[bytes, bytes], list[Array]] | None = None

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
        """The folded unknowns for a right side.

        near: first guess; tolerance: if not that of the solver; taken: a linear map of the unknowns
        that is subtracted from the rows.
        """

        def rows(folded: Array, rough: bool = False) -> Array:
            return (
                self.rows(folded, rough)
                if taken is None
                else self.rows(folded, rough) - taken(folded)
            )

        plain = self.preconditioner(right) if near is None else near
        scale = self.scale_of(plain)
        # The norm adds up the errors of all zones.
        count = math.sqrt(len(self.system.zones.solved))
        wanted = max(
            (self.tolerance if tolerance is None else tolerance) * max(count / _ALIKE, 1.0),
            4 * _ROUNDING * count,
        )
        x = np.zeros(self.size) if near is None else near
        left_over = (plain if near is None else self.preconditioner(right - rows(near))) / scale
        before = float(norm(left_over))
        for _ in range(_CORRECTIONS):
            # Rough sums are accurate enough for a partial reduction.
            part = max(wanted, _CORRECTED * before)
            found = gmres(
                lambda v: self.preconditioner(rows(v * scale, rough=True)) / scale, left_over, part
            )
            self.iterations += found.steps
            x = x + found.x * scale
            # GMRES does not see the errors of rough sums and of long recurrences, so the residual
            # is recomputed.
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
        """Largest unknown of every zone, mirrored ones included."""
        zones = self.system.zones
        out = np.zeros(len(zones))
        out[zones.solved] = self._largest(folded)
        return np.maximum(out, out[::-1]) if zones.symmetric else out

    def scale_of(self, folded: Array) -> Array:
        """Scale of every unknown: the largest of its zone, with a lower bound; 1 for amplitudes."""
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
