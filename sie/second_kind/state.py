"""The solution of kappa phi + T phi = g on given zones, with a stated error."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from sie.basis.data import EPS, HALF_DIGITS, SUM_ROUNDING, Array, Index, root_of_squares, widened
from sie.dense import modes
from sie.dense.lu import Factored
from sie.equation.conditions import of_levels, speaks_of_levels
from sie.second_kind.density import SecondKindDensity
from sie.second_kind.system import SecondKindRows, targets_at
from sie.states.base import Resolved
from sie.states.options import CHECK_ANGLES, CHECK_POINTS
from sie.states.options import OPTIONS as ERRORS
from sie.states.sizes import Sizes
from sie.states.state import AT_ENDS, residual_errors


@dataclass(frozen=True)
class SecondKindOptions:
    """Options for equations with kappa (second kind): numbers of modes of a zone, a round-off."""

    # The first number of modes of a zone, unless near neighbours require more.
    first_modes: int = 16
    # If a zone has too few modes, their number is multiplied by at least this factor.
    growth: float = 1.6
    # No modes are added if there would then be more unknowns than this. A matrix of this size takes
    # some seconds.
    max_unknowns: int = 4000
    # A search for free ends stops if coefficients have hardly decayed up to this mode, as beside
    # gaps below about 1e-4 of a zone's width. Each solution with more modes would take a second.
    search_modes: int = 768
    # Number of last coefficients of a zone. The largest of them shows whether modes are missing.
    last: int = 3
    # Round-off of a complex product divided by that of a real one: the square root of 5 (R. Brent,
    # C. Percival, P. Zimmermann, Math. Comp. 76, 2007, 1469-1481).
    complex_rounding: float = 5**0.5


OPTIONS = SecondKindOptions()


@dataclass(frozen=True, eq=False)
class SecondKindState(Resolved):
    """The solution of an equation with kappa on given zones, and data for its error estimate.

    Attributes
    ----------
    density : SecondKindDensity
        The solution phi of the equation.
    system : SecondKindRows
        The rows of the equation.
    solver : Factored
        The solver of these rows for further right sides.
    unknowns : ndarray
        All coefficients and amplitudes.
    condition_scale : ndarray
        The scale by which each row of the side conditions was divided.
    sizes : Sizes
        Numbers of modes of the zones.

    Examples
    --------
    >>> import numpy as np, sie
    >>> slid = sie.Equation(sie.cauchy(), np.zeros_like, sie.Total(1.0), kappa=0.5)
    >>> state = sie.solve_zones(slid, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> float(round(state.response(np.array([2.0])).total, 12)), state.density_error < 1e-13
    (2.0, True)
    """

    density: SecondKindDensity
    system: SecondKindRows
    solver: Factored = field(repr=False)
    unknowns: Array
    condition_scale: Array
    sizes: Sizes

    @property
    def iteration(self) -> None:
        """None, because the unknowns are not computed by an iterative solver."""
        return None

    @property
    def direct(self) -> Factored | None:
        """The solver, which has LU factors of a matrix; None in subclasses that iterate."""
        return self.solver

    @property
    def kept(self) -> Index:
        """Number of coefficients c_1, c_2, ... of the density on each zone (Z,), without c_0."""
        return self.system.layout.m

    @property
    def truncation(self) -> Array:
        """Relative size of the last coefficients of each zone (Z,); the same as `tails`."""
        return self.tails

    def response(self, values: Array, tolerance: float = 0.0) -> SecondKindDensity:
        """The density caused by given changes of the side conditions' values."""
        return density_of(self.system, self.solver(self._right_of(values)), True)

    def _right_of(self, values: Array) -> Array:
        """Right side of the system: 0 in the equation's rows, `values` in the conditions' rows."""
        right = np.zeros(self.solver.size, dtype=self.unknowns.dtype)
        right[self.solver.size - len(values) :] = values / self.condition_scale
        return right

    def with_value(self, condition: int, change: float) -> Self:
        """The solution after the value of one side condition has changed by `change`."""
        y = self.unknowns + self.solver(self._right_of(self.values(condition, change)))
        return replace(self, unknowns=y, density=density_of(self.system, y))

    @property
    def levels(self) -> Array:
        """Level of each zone (Z,): the constant value that a certain sum has on the zone.
        The sum is the potential of the density phi, plus the integral of kappa phi, minus the
        primitive of the right side; see `SecondKindRows.levels`.
        """
        rows, constants = self.system.levels()
        return np.asarray(rows @ self.unknowns + constants)

    def level_rates(self, values: Array) -> Array:
        """Changes of the zones' levels for given changes of the side conditions' values.
        See `levels`.
        """
        return np.asarray(self.system.levels()[0] @ self.solver(self._right_of(values)))

    # Newton's method for the positions of the ends uses the properties below.
    @property
    def _table(self) -> Array:
        """Coefficients of the density on each zone (Z, n + 1)."""
        return self.density.coefficients

    @cached_property
    def natural(self) -> Array:
        """Largest coefficient |c_n|, n > 0, of the density on each zone (Z,).
        c_0 is left out: it is given by the total of the density.
        """
        return self._sizes_from(1)

    def _sizes_from(self, first: int) -> Array:
        """Largest coefficient of the density on each zone (Z,), from the order `first` on.

        The densities of jumps count with their first Chebyshev coefficients.
        """
        out = np.abs(self._table[:, first:]).max(axis=1, initial=0.0)
        for one in self.density.known:
            of_jumps = np.abs(one.moments(OPTIONS.first_modes)[first:]).max()
            out[one.zone] = max(out[one.zone], float(of_jumps))
        return out

    @cached_property
    def intensity_noise(self) -> Array:
        """Round-off of the intensity K at the left and right ends (2, Z)."""
        (left, _), (right, _) = self.system.intensities()
        effect = self.solver.transposed(np.concatenate((left, right)).T)
        through_rows = root_of_squares(effect.T, self._row_errors).reshape(2, -1)
        own = 4 * EPS * self.density.zones.edge_scale * np.abs(self._table).sum(axis=1)
        return np.asarray(own + ERRORS.safety * through_rows)

    @cached_property
    def end_truncation(self) -> Array:
        """Error of each moving end (Z, 2) due to truncated series, divided by its zone's width."""
        zones = self.density.zones
        slopes = np.where(zones.moves, np.abs(np.array(self.density.edge_slopes)), np.inf)
        steps = zones.weight.end_step(self.intensity_truncation, np.maximum(slopes, 1e-300))
        return np.asarray(steps / (2 * zones.half)).T

    @property
    def intensity_truncation(self) -> Array:
        """Error of the intensity K at the left and right ends due to truncated series (2, Z).

        The missing coefficients of a zone count twice: once directly, and once because they change
        the rows of other zones.
        """
        return np.asarray(2 * self.density.zones.edge_scale * self.missing)

    @property
    def unresolved(self) -> bool:
        """Whether coefficients of a zone with `search_modes` or more modes have hardly decayed."""
        many = self.system.layout.m >= OPTIONS.search_modes
        return bool(np.any(many & (self.tails > modes.OPTIONS.nearly_decayed)))

    # The methods below estimate the stated error.
    @cached_property
    def zone_sizes(self) -> Array:
        """The largest coefficient of the density on each zone (Z,)."""
        return self._sizes_from(0)

    @cached_property
    def tails(self) -> Array:
        """Largest of the last coefficients of each zone (Z,), divided by its largest coefficient.
        It shows whether there are enough modes.
        """
        last = [np.abs(self._table[i, : m + 1][-OPTIONS.last :]).max() for i, m in self._modes]
        return np.array(last) / np.where(self.zone_sizes > 0, self.zone_sizes, 1.0)

    @property
    def _modes(self) -> list[tuple[int, int]]:
        """(zone, its highest mode) for all zones."""
        return list(enumerate(self.system.layout.m.tolist()))

    @cached_property
    def missing(self) -> Array:
        """Estimated sum of the truncated coefficients of each zone (Z,).

        It is assumed that the truncated coefficients decay, from the last kept ones on, as the
        second half of the kept ones does.
        """
        out = np.zeros(len(self.density.zones))
        for i, m in self._modes:
            c = np.abs(self._table[i, : m + 1])
            last, middle = c[-OPTIONS.last :].max(), c[m // 2 :][: OPTIONS.last].max()
            ratio = min(last / max(middle, 1e-300), 1.0) if middle > 0 else 0.0
            fall = ratio ** (ERRORS.slower_fall / max(m - m // 2 - OPTIONS.last, 1))
            out[i] = last * fall / max(1 - fall, 1 / m)
        return out

    @cached_property
    def _residuals(self) -> Array:
        """Residual of the equation at points between the nodes, times sin(theta): (Z, points).
        The residual is the left side minus the right side.
        """
        return self._residuals_at(
            np.broadcast_to(CHECK_ANGLES, (len(self.density.zones), CHECK_POINTS))
        )

    @cached_property
    def _end_residuals(self) -> Array:
        """(Left side minus right side) * sin(theta), next to the ends of each zone (Z, points).

        There all missing coefficients of the fields of near zones add up.
        """
        return self._residuals_at(
            np.concatenate((self._near_ends, np.pi - self._near_ends), axis=1)
        )

    @property
    def _near_ends(self) -> Array:
        """Angles 1/(2 m), 1/m, 2/m from each zone's right end (Z, 3); m: the zone's highest mode.

        A highest mode below 2 counts as 2.
        """
        return np.asarray(np.exp2([-1, 0, 1]) / np.maximum(self.system.layout.m, 2)[:, None])

    def _residuals_at(self, theta: Array) -> Array:
        """Residual of the equation at the angles theta (Z, points), times sin(theta).
        The residual is the left side minus the right side.
        """
        targets = targets_at(self.density.zones, theta)
        found = self.system.left_side(targets) @ self.unknowns - self.system.right_side(targets)
        return np.asarray(found.reshape(theta.shape) * np.sin(theta))

    @cached_property
    def _row_errors(self) -> Array:
        """Error of each row of the linear system due to round-off and truncated coefficients.

        Truncated coefficients act on the rows of other zones as the last kept one does, or less.
        The residual between the nodes and next to the ends, above its round-off, is an error of the
        rows. The right side g is evaluated at rounded places. So the round-off of g is the slope of
        g times the round-off of the places. The slope of the density serves as a bound of the slope
        of g.
        """
        zones, m = self.density.zones, self.system.layout.m
        unit = EPS * (OPTIONS.complex_rounding if zones.weight.is_complex else 1.0)
        out = unit * self.solver.size_of_rows + np.abs(self.solver.last) @ self.missing
        slopes = np.abs(self._table) @ np.arange(self._table.shape[1])
        places = modes.place_rounding(zones, np.arange(len(zones))) * slopes
        # Residuals are multiplied by sin(theta), which is small near ends. So their round-off is
        # multiplied by sin(theta), too.
        rounding, sines = SUM_ROUNDING * self.zone_sizes, np.sin(self._near_ends[:, -1])
        residual = np.maximum(
            np.abs(self._residuals).max(axis=1) - rounding,
            np.abs(self._end_residuals).max(axis=1) - rounding * sines,
        )
        out[: int(m.sum())] += np.repeat(places + np.maximum(residual, 0.0), m)
        out[len(out) - len(self.condition_scale) :] += self._level_errors / self.condition_scale
        return np.asarray(out)

    @property
    def _level_errors(self) -> Array:
        """Round-off of the zones' levels, in each row of the side conditions.
        `levels` defines the level of a zone.

        A row may contain differences of levels, which are smaller than the levels themselves. A
        potential next to a strong singularity is a sum of some eight terms.
        """
        out, zones = np.zeros(len(self.condition_scale)), self.density.zones
        for condition, first in zip(self.equation.conditions, self.condition_index, strict=True):
            count = condition.count(zones)
            if count and speaks_of_levels(condition, zones):
                rows, constants = self.system.levels()
                sizes = np.hypot(root_of_squares(rows, self.unknowns), np.abs(constants))
                part = np.abs(of_levels(condition, zones)) @ sizes
                out[first : first + count] = 8 * EPS * part
        return out

    @cached_property
    def density_rounding(self) -> Array:
        """Error of each zone's density (Z,), due to the errors of all rows of the linear system.

        The rows are changed by these errors, with one sign for all rows and with random signs of a
        fixed seed. The largest change of the density is taken. Near an end, a coefficient of order
        k counts `AT_ENDS` k times.
        """
        signs: Any = np.random.default_rng(0).standard_normal((self.solver.size, ERRORS.samples))
        signs[:, 0] = 1.0
        if self.density.zones.weight.is_complex:
            # The error of each row has a real and an imaginary part.
            signs = signs + 1j * np.random.default_rng(1).permuted(signs, axis=0)
        changes = self.solver(self._row_errors[:, None] * signs)
        weights = np.maximum(1.0, AT_ENDS * np.arange(self.system.layout.given.shape[1]))
        sizes = [root_of_squares(self.system.layout.padded(one) * weights) for one in changes.T]
        return np.asarray(ERRORS.safety * np.max(sizes, axis=0))

    def _errors_over(self, sizes: Array) -> Array:
        """Error of the density on each zone (Z,), divided by `sizes`; 0 where the size is 0.

        It is infinite if a zone is resolved to less than half of the digits: then the missing
        coefficients are not known even roughly.
        """
        if float(self.tails.max()) > HALF_DIGITS:
            return np.full(len(sizes), np.inf)
        sizes, m = np.where(sizes > 0.0, sizes, np.inf), self.system.layout.m
        error = (2 * AT_ENDS * self.missing * np.maximum(m, 1) + self.density_rounding) / sizes
        return error + residual_errors(self._residuals, sizes, m, np.zeros(len(m)))

    @property
    def noise(self) -> Array:
        """Round-off of positions x on each zone (Z,), divided by the half width of the zone."""
        rounding = modes.place_rounding(self.density.zones, np.arange(len(self.density.zones)))
        return np.asarray(rounding)

    def reason(self, tol: float) -> str:
        """The largest part of the stated error, in words."""
        size, m = max(self.size, 1e-300), self.system.layout.m
        zone = int(np.argmax(self.tails))
        unknown = float(self.tails[zone]) > HALF_DIGITS
        if unknown or self.missing[zone] * m[zone] > self.density_rounding.max():
            return (
                f"on zone {zone} (counted from 0) the last of {int(m[zone])} coefficients is "
                f"{self.tails[zone]:.1e} of the largest: the right side is rounded, noisy, "
                "singular or jumps there, or another zone is very close"
            )
        residuals = np.abs(self._residuals)
        if self.density_rounding.max() > residuals.max():
            return "rounding limits the accuracy: the side conditions nearly depend on each other"
        row, column = np.unravel_index(np.argmax(residuals), residuals.shape)
        zones = self.density.zones
        place = zones.middle[row] + zones.half[row] * math.cos(CHECK_ANGLES[column % CHECK_POINTS])
        return (
            f"at x = {place:.6g} on zone {int(row)} (counted from 0) the residual of the equation "
            f"is {residuals.max():.1e}, for a density of the size {size:.1e}"
        )


def density_of(system: SecondKindRows, y: Array, is_change: bool = False) -> SecondKindDensity:
    """The density with the unknowns y, and with the parts that jumps cause unless `is_change`."""
    layout = system.layout
    amplitudes = y[layout.coefficients :]
    table = widened(layout.padded(y), 2)
    plain = SecondKindDensity(system.zones, system.equation.kernel, table, amplitudes)
    return plain if is_change else replace(plain, known=system.jumps, beside=system.beside)
