"""The solution of an equation with kappa on many zones, by an iteration."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from sie.basis.data import EPS, Array, root_of_squares
from sie.second_kind.density import SecondKindDensity
from sie.second_kind.many import ManySolver
from sie.second_kind.many_levels import LevelRows
from sie.second_kind.state import AT_ENDS, SecondKindState, density_of
from sie.states.options import OPTIONS as ERRORS

_NO_LEVELS = (
    "with kappa and many zones, the levels of the zones are known only if the equation has a "
    "condition on potentials"
)


@dataclass(frozen=True, eq=False)
class ManyState(SecondKindState):
    """A `SecondKindState` whose unknowns were found by fast sums and GMRES.

    Attributes
    ----------
    solver : ManySolver
        The iteration, for further right sides.
    """

    solver: ManySolver = field(repr=False)  # type: ignore[assignment]

    @property
    def direct(self) -> None:
        """None, because there are no LU factors of a matrix."""
        return None

    @property
    def iterated(self) -> bool:
        """Whether the unknowns were computed by an iteration, not by LU factors."""
        return True

    def response(self, values: Array, tolerance: float = 0.0) -> SecondKindDensity:
        """The change of the density if the side conditions' values change by `values`."""
        y = self.solver(self._right_of(values), tolerance)
        return density_of(self.system, y, True)

    @property
    def levels(self) -> Array:
        """Level of each zone, the constant part of the potential on the zone.
        Raises ValueError if no side condition contains levels.
        """
        rows = self.solver.rows
        if not isinstance(rows, LevelRows):
            raise ValueError(_NO_LEVELS)
        return np.asarray(rows.applied(self.unknowns)[1].level + rows.level_constants)

    def level_rates(self, values: Array) -> Array:
        """Changes of the zones' levels if the values of the side conditions change by `values`.
        A level is the constant part of the potential on a zone.

        Raises ValueError if there is no condition on levels.
        """
        rows = self.solver.rows
        if not isinstance(rows, LevelRows):
            raise ValueError(_NO_LEVELS)
        return rows.applied(self.solver(self._right_of(values), 0.0))[1].level

    @cached_property
    def _residuals(self) -> Array:
        return self.solver.rows.residuals(self.unknowns)

    @cached_property
    def _row_errors(self) -> Array:
        return self.solver.row_errors(self.unknowns, self._residuals, self.missing)

    @cached_property
    def _changes(self) -> Array:
        """Changes of the density's coefficients due to random errors of all rows of the equations.
        The shape is (samples, Z, n + 1).
        """
        kept = self.solver.random_changes
        if kept is not None and kept[0] is self.unknowns:
            return kept[1]
        signs = np.random.default_rng(0).standard_normal((ERRORS.samples, self.solver.size))
        signs[0] = 1.0
        errors = self._row_errors * signs
        unit = float(np.abs(errors).max(initial=0.0)) or 1.0
        rights = [self.solver.projected(one / unit) for one in errors]
        # The solver's tolerance limits a norm over all zones. Multiplied by the square root of the
        # number of zones, it allows the error `ERRORS.negligible` on each zone.
        tolerance = ERRORS.negligible * np.sqrt(len(self.density.zones))
        changes = [unit * self.solver(one, tolerance) for one in rights]
        out = np.array([self.system.layout.padded(one) for one in changes])
        self.solver.random_changes = self.unknowns, out
        return out

    @cached_property
    def intensity_noise(self) -> Array:
        """Round-off of the intensity K at the left and right ends (2, Z).
        K is the factor of the singular term in the density close to an end.
        """
        if self.solver.is_loose:
            # A solver with a loose tolerance leaves an error of the iteration that is larger than
            # round-off. The next Newton step removes this error.
            return np.asarray(ERRORS.safety * self.density.zones.edge_scale * self.solver.error)
        zones, count = self.density.zones, self._changes.shape[2]
        left, right = self.density.edge_values(count)
        changes = np.array(
            [np.abs(np.sum(self._changes * one, axis=2)).max(axis=0) for one in (left, right)]
        )
        own = 4 * EPS * np.abs(self._table).sum(axis=1)
        return np.asarray(zones.edge_scale * (own + ERRORS.safety * changes))

    @cached_property
    def density_rounding(self) -> Array:
        """Error of each zone's density (Z,) due to errors of all rows of the system of equations.

        As for `SecondKindState`; the changes of the density are found by the iteration.
        """
        weights = np.maximum(1.0, AT_ENDS * np.arange(self._changes.shape[2]))
        sizes = [root_of_squares(one * weights) for one in self._changes]
        return np.asarray(ERRORS.safety * np.max(sizes, axis=0))
