"""Preconditioned GMRES on the rows of many zones."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import norm

from sie.basis.data import EPS, Array
from sie.dense.system import condition_rows
from sie.fast.coarse import CoarseOperator
from sie.fast.preconditioner import TwoLevelPreconditioner
from sie.fast.system import Applied, IterativeSystem
from sie.trees.krylov import gmres


@dataclass(frozen=True)
class IterationOptions:
    """Options of the preconditioned GMRES iteration."""

    # Factor by which one run of GMRES reduces the residual. Within a run, fields are computed by
    # fast sums with an error of 1e-7 (rough sums). So each run only adds a correction to the
    # solution, and the residual is then computed again.
    correction: float = 1e-6
    # The unknowns of each zone are divided by the largest unknown of the zone. This option is the
    # lower bound of the divisor, relative to the largest unknown of all zones.
    min_scale: float = 1e-4


OPTIONS = IterationOptions()


class Iterative:
    """Iterative solver of the equations of an `IterativeSystem`, for any right side.

    value: the value of the open condition, if there is one (a side condition whose value is an
    unknown). error: the error of each zone's unknowns (Z,), estimated by the last preconditioned
    residual.

    Each unknown is scaled by the largest unknown of its zone, so that lightly loaded zones are as
    accurate as others.
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
        # A key and its value, which `states.rounding` computes and stores. The key is the bytes of
        # two arrays, the sizes of random errors of the rows. The value is the changes of the
        # solution that these errors cause.
        self.random_changes: tuple[tuple[bytes, bytes], list[Array]] | None = None

    @property
    def size(self) -> int:
        return self.system.symmetry.size

    def rows(self, folded: Array, rough: bool = False) -> Array:
        system = self.system
        rows, view = system.applied(system.symmetry.unfold(folded), rough)
        return np.concatenate((rows, condition_rows(system.equation, view, 1)[0][:, 0]))

    def right(self) -> Array:
        """The right sides of the equation's rows, followed by those of its side conditions."""
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
        """Solve for the unknowns of the solved zones, which are half of all zones if symmetric.

        right: the right sides of all rows; near: a first guess of the unknowns; tolerance: replaces
        the tolerance of the solver; taken: a linear map of the unknowns that is subtracted from the
        rows.
        """

        def rows(folded: Array, rough: bool = False) -> Array:
            return (
                self.rows(folded, rough)
                if taken is None
                else self.rows(folded, rough) - taken(folded)
            )

        plain = self.preconditioner(right) if near is None else near
        scale = self.scale_of(plain)
        # The tolerance is at least the round-off of the residual's norm, to which all zones
        # contribute.
        rounding = 4 * EPS * math.sqrt(len(self.system.zones.solved))
        wanted = max(self.tolerance if tolerance is None else tolerance, rounding)
        x = np.zeros(self.size) if near is None else near
        left_over = (plain if near is None else self.preconditioner(right - rows(near))) / scale
        before = float(norm(left_over))
        while True:
            # GMRES uses sums with an error of 1e-7 (rough sums). They are accurate enough to reduce
            # the residual by the factor `correction`, but no further.
            part = max(wanted, OPTIONS.correction * before)
            found = gmres(
                lambda v: self.preconditioner(rows(v * scale, rough=True)) / scale, left_over, part
            )
            self.iterations += found.steps
            x = x + found.x * scale
            # GMRES does not notice the errors of its rough sums and of long recurrences, so the
            # residual is computed again with accurate sums.
            left_over = self.preconditioner(right - rows(x)) / scale
            self.error = self._by_zone(left_over * scale)
            size, before = before, float(norm(left_over))
            # If the residual has decreased much less than GMRES has estimated, the rest of the
            # residual is round-off.
            stagnant = not before <= math.sqrt(OPTIONS.correction) * size
            if found.steps == 0 or before <= 4 * wanted or stagnant:
                return x

    def _largest(self, folded: Array) -> Array:
        """Largest absolute value of the unknowns of each solved zone."""
        return np.asarray(
            np.maximum.reduceat(
                np.abs(folded[: self.size - len(self.preconditioner.amplitudes)]),
                self.preconditioner.first,
            )
        )

    def _by_zone(self, folded: Array) -> Array:
        """Largest absolute value of the unknowns of each zone, mirrored zones included."""
        zones = self.system.zones
        out = np.zeros(len(zones))
        out[zones.solved] = self._largest(folded)
        return np.maximum(out, out[::-1]) if zones.symmetric else out

    def scale_of(self, folded: Array) -> Array:
        """Scale of each unknown: the largest unknown of the same zone, but no less than a bound.

        The scale of amplitudes is 1.
        """
        largest = self._largest(folded)
        top = float(largest.max())
        size = np.diff(
            np.append(self.preconditioner.first, self.size - len(self.preconditioner.amplitudes))
        )
        out = np.ones(self.size)
        out[: int(size.sum())] = np.repeat(
            np.maximum(largest, OPTIONS.min_scale * top if top > 0 else 1.0), size
        )
        return out
