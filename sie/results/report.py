"""A short report of a solution: the resolution of each zone, and the condition of the system."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from sie.basis.data import Array, Index
from sie.slits.system import AnyState


@dataclass(frozen=True)
class ReportOptions:
    """Limit of the number of rows in a printed report."""

    # Largest number of zones in the table, so that it fits on a screen.
    max_rows: int = 24


OPTIONS = ReportOptions()


@dataclass(frozen=True, eq=False)
class Report:
    """Numbers of modes, errors and intensities of a solution on each zone.
    `print` shows them as a table.

    If there are many zones, the table shows those with the largest errors.

    Attributes
    ----------
    zones : (n, 2) array
        The ends.
    modes : (n,) array
        Number of coefficients of the right side on each zone.
    coupled : (n,) array
        Number of modes by which each zone is coupled to the others.
    last : (n,) array
        Size of the last coefficients of the right side and of the field of the other zones,
        relative to the zone's largest coefficient. Narrow gaps between free ends make several zones
        one series; these zones have equal entries here, in `modes` and in `coupled`.
    intensities : (2, n) array
        The intensities K at left and right ends.
    totals : (n,) array
        Integral of the density over each zone.
    errors : (n,) array
        `Solution.errors`.
    error : float
        `Solution.error`.
    unknowns : int
        Number of unknowns of the system in which all zones are solved together.
    condition : float or None
        Condition number of the system's matrix in the 1-norm, estimated from its LU factors by
        LAPACK's `dgecon` (W. W. Hager, SIAM J. Sci. Stat. Comput. 5, 1984, 311-316). The rows of
        the side conditions are divided by their largest entries. None: there is no matrix, the
        system was solved by an iteration.
    iterations : int
        Number of steps of the iteration, 0 if the system was solved with a matrix.
    steps : int or None
        Number of Newton steps of the free ends, None if all ends are fixed.

    Examples
    --------
    >>> import sie
    >>> hertz = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(1.0))
    >>> report = sie.solve(hertz, sie.Zones.of([[-1.0, 1.0]])).report()
    >>> float(report.totals[0].round(12)), report.unknowns, report.condition < 10
    (1.0, 1, True)
    """

    zones: Array
    modes: Index
    coupled: Index
    last: Array
    intensities: Array
    totals: Array
    errors: Array = field(repr=False)
    error: float
    unknowns: int
    condition: float | None
    iterations: int
    steps: int | None

    @classmethod
    def of(cls, state: AnyState, error: float, errors: Array, steps: int | None) -> "Report":
        """The report of a solution that was found in `steps` Newton steps of the ends.
        `error` and `errors` are its error bounds.
        """
        density = state.density
        whole, zone = state.wide_of(np.arange(len(density.zones)))
        solver = whole.direct
        return cls(
            density.zones.table,
            whole.kept[zone],
            whole.system.layout.m[zone],
            np.maximum(whole.truncation, whole.tails)[zone],
            np.array(density.intensities),
            np.asarray(density.totals),
            errors,
            error,
            state.coupled,
            None if solver is None else 1.0 / max(solver.reciprocal_condition, math.ulp(0.0)),
            whole.sizes.iterations,
            steps,
        )

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        yield (
            f"{'zone':>4} {'left end':>14} {'right end':>14} {'modes':>6} {'coupled':>7} "
            f"{'last':>8} {'K left':>11} {'K right':>11} {'total':>11} {'error':>8}"
        )
        shown = np.arange(len(self.zones))
        if len(shown) > OPTIONS.max_rows:
            shown = np.sort(np.argsort(-self.errors, kind="stable")[: OPTIONS.max_rows])
        for i in shown:
            ends = self.zones[i]
            yield (
                f"{i:>4} {ends[0]:>14.8g} {ends[1]:>14.8g} {self.modes[i]:>6} "
                f"{self.coupled[i]:>7} {self.last[i]:>8.1e} {self.intensities[0, i]:>11.4g} "
                f"{self.intensities[1, i]:>11.4g} {self.totals[i]:>11.4g} {self.errors[i]:>8.1e}"
            )
        if len(shown) < len(self.zones):
            yield f"(the {len(shown)} of {len(self.zones)} zones with the largest errors)"
        searched = "" if self.steps is None else f"; free ends found in {self.steps} steps"
        yield f"stated error {self.error:.1e}, relative to the largest coefficient{searched}"
        if self.condition is None:
            yield (
                f"{self.unknowns} unknowns, solved by {self.iterations} steps of an iteration: "
                "there is no matrix, so no condition number"
            )
        else:
            yield (
                f"{self.unknowns} unknowns, solved by LU factors of a matrix with a condition "
                f"number of about {self.condition:.1e} (1-norm, estimated)"
            )
