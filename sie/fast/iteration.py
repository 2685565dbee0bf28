"""Preconditioned GMRES on the rows of many zones."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import norm

from sie.basis.data import Array
from sie.dense.system import condition_rows
from sie.fast.coarse import CoarseOperator
from sie.fast.preconditioner import TwoLevelPreconditioner
from sie.fast.system import Applied, IterativeSystem
from sie.trees.krylov import gmres


@dataclass(frozen=True)
class IterationOptions:
    """Options of preconditioned GMRES."""

    # A correction reduces the residual by this factor; there are so many corrections at most. One
    # that leaves more than `stagnant` of the residual is the last: rough sums leave much less, so
    # it is rounding.
    correction: float = 1e-6
    max_corrections: int = 6
    stagnant: float = 1e-3
    # Zones with less than this part of the largest coefficient are scaled as if they had it.
    min_scale: float = 1e-4
    # For more zones than these, the tolerance of the norm grows so that it stays that of each zone.
    norm_zones: int = 100


_OPTIONS = IterationOptions()
EPS = float(np.finfo(float).eps)


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
        count = len(self.system.zones.solved)
        norm_of_many = math.sqrt(max(count / _OPTIONS.norm_zones, 1.0))
        wanted = self.tolerance if tolerance is None else tolerance
        wanted = max(wanted * norm_of_many, 4 * EPS * math.sqrt(count))
        x = np.zeros(self.size) if near is None else near
        left_over = (plain if near is None else self.preconditioner(right - rows(near))) / scale
        before = float(norm(left_over))
        for _ in range(_OPTIONS.max_corrections):
            # Rough sums are accurate enough for a partial reduction.
            part = max(wanted, _OPTIONS.correction * before)
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
            if found.steps == 0 or before <= 4 * wanted or before > _OPTIONS.stagnant * size:
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
            np.maximum(largest, _OPTIONS.min_scale * top if top > 0 else 1.0), size
        )
        return out
