"""A solution on given zones with its error estimate."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from sie.basis.data import Array, Index, Mask, row_sizes
from sie.basis.sums import OPTIONS as SUMS
from sie.dense import modes
from sie.dense.system import System
from sie.density.density import Density
from sie.states.base import Solved, coefficient_sizes
from sie.states.options import CHECK_ANGLES, CHECK_POINTS, OPTIONS
from sie.states.rounding import density_rounding, intensity_rounding, truncation_through_rows

# Maximum over t of |T_k - T_(k mod 2)| / (k sqrt(1 - t^2)) for large k, reached near an end. The
# difference of the polynomials is zero at both ends, so that the quotient has no singular part.
AT_ENDS = 0.73
# Round-off of a sum of n coefficients close to a free end, divided by n^1.5 times the largest error
# of a coefficient. Divided by n^1.5 times the mean error, it is 0.42. The largest error is about
# three times the mean, which gives 0.14. `State.truncation_errors` doubles it, so about half is
# used.
_OF_ROUNDING = 0.08


@dataclass(frozen=True, eq=False)
class State(Solved):
    """The solution on given zones, with the data for its error estimate.

    Attributes
    ----------
    density : Density
        The solution phi of the equation.
    system, solver
        The rows of the equation, and the solver of these rows for further right sides.
    unknowns, folded_unknowns : ndarray
        All unknowns, and those solved for (about half of them if zones are symmetric).
    conditions_from : int
        Index of the first row of the side conditions.
    condition_scale : ndarray
        The scale by which each of these rows was divided.
    truncation, tails : ndarray
        Sizes of the last coefficients of the right side (Z,), and of the last coupled modes (Z,).
        Both are relative to the largest coefficient of the zone.
    linear_error : ndarray
        Remaining error of each zone's coefficients from an iteration (Z,), 0 for a direct solve.
    sizes : Sizes
        Numbers of modes of the zones.

    Examples
    --------
    >>> import numpy as np, sie
    >>> punch = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (sie.Total(1.0),))
    >>> state = sie.solve_fixed(punch, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> float(round(state.response(np.array([2.0])).total, 12)), state.density_error < 1e-14
    (2.0, True)
    """

    @cached_property
    def intensity_noise(self) -> Array:
        """Round-off of the intensity K at the left and right ends (2, Z).
        K is the coefficient of 1 / sqrt(distance) in the density close to an end.
        """
        return intensity_rounding(self)

    def _errors_over(self, sizes: Array) -> Array:
        """Error of the density on each zone (Z,), divided by `sizes`; 0 where the size is 0.

        It is the sum of four errors: the neglected coefficients, the residual between the nodes,
        the remaining error of an iteration, and the effect of truncation and round-off of all rows.
        No residual shows the last one. Without its singularity, T_k / sqrt(1 - t^2) reaches 0.73 k
        close to an end, so an error of c_k counts 0.73 k times. Coefficients of one sign with the
        ratio `fall` near 1 add up within a distance (1 - fall)^2 of the end only, where
        sqrt(1 - t^2) is about 1 - fall^2.
        """
        zones, modes_of = self.density.zones, self.system.layout.m
        solved, sizes = zones.solved, np.where(sizes > 0.0, sizes, np.inf)
        fields = self._missing_fields * (1 - self._falls**2)
        error = self.truncation_errors(self._missing) + AT_ENDS * fields * modes_of
        error = (error + self.linear_error + self.density_rounding) / sizes
        seen = residual_errors(
            self._residuals, sizes[solved], modes_of[solved], self.jumps_rounding[solved]
        )
        error[solved] += seen
        return np.maximum(error, error[::-1]) if zones.symmetric else error

    @cached_property
    def density_rounding(self) -> Array:
        """Error of each zone's density (Z,) due to truncation and round-off of the rows."""
        return density_rounding(self, self.missing, self.low_residuals)

    @cached_property
    def end_truncation(self) -> Array:
        """Error of the position of each moving end due to truncated series, in zone widths (Z, 2).

        An error dK of the intensity moves an end by 2 dK / A, with the edge slope A.
        """
        zones = self.density.zones
        slopes = np.where(zones.moves, np.abs(self.density.edge_slopes), np.inf)
        return np.asarray(self.intensity_truncation / np.maximum(slopes, 1e-300) / zones.half).T

    @cached_property
    def intensity_truncation(self) -> Array:
        """Error of the intensity K at the left and right ends due to truncated series (2, Z).
        K is the coefficient of 1 / sqrt(distance) in the density close to an end.

        It is caused by the zone's own missing coefficients, and by the truncation of all rows.
        """
        through_rows = truncation_through_rows(self, self.missing, self.low_residuals)
        return np.asarray(self.density.zones.edge_scale * self.missing + through_rows)

    @cached_property
    def missing(self) -> Array:
        """Estimated sum of the truncated coefficients of each zone (Z,).

        It adds the truncated coefficients of the right side, those of the other zones' fields, and
        the part of the residual above the residual's round-off.
        """
        out, solved = self._missing + self._missing_fields, self.density.zones.solved
        out[solved] += 3 * np.maximum(self._residual - self.residual_rounding[solved], 0.0)
        return np.maximum(out, out[::-1]) if self.density.zones.symmetric else out

    @cached_property
    def residual_rounding(self) -> Array:
        """Round-off of the residual of the equation on each zone (Z,)."""
        return 2e-15 * self.zone_sizes + self.jumps_rounding

    @cached_property
    def low_residuals(self) -> Array:
        """Amplitudes (solved zones, 7) of the lowest modes of the residual on each solved zone.

        The round-off is subtracted from them.
        """
        rounding = self.residual_rounding[self.density.zones.solved, None]
        return np.maximum(np.abs(self._residuals @ separated_modes()[1].T) - rounding, 0.0)

    @cached_property
    def zone_sizes(self) -> Array:
        """The largest coefficient of the density on each zone (Z,), jumps included."""
        return coefficient_sizes(self.density)

    @cached_property
    def jumps_rounding(self) -> Array:
        """Round-off of the closed forms of the jumps, summed for each zone (Z,)."""
        return self.system.jumps.rounding(len(self.density.zones))

    @cached_property
    def left_out(self) -> Array:
        """Sum of the neglected coefficients of each zone's right side (Z,).

        The sum is extrapolated from the decay of the last coefficients.
        """
        return np.asarray(
            self.neglected * self.zone_sizes / np.maximum(self.sizes.own[: len(self.neglected)], 1)
        )

    def truncation_errors(self, left_out: Array) -> Array:
        """Errors of each zone's density (Z,) caused by neglected coefficients with given sums (Z,).

        The sums are multiplied by the number of coefficients, since a coefficient c_k counts about
        k times close to an end. They also count twice, since sampling at nodes adds the neglected
        coefficients to kept ones.
        """
        return np.asarray(2 * left_out * np.maximum(self.sizes.own[: len(left_out)], 1))

    @cached_property
    def _missing(self) -> Array:
        """Estimated sum of the neglected coefficients of each zone, at most ten times the residual.
        It is `left_out` with this upper bound.

        A larger sum would show in the residual. The extrapolation may be too large, because a
        series may decay faster towards its end.
        """
        missing = self.left_out.copy()
        solved = self.density.zones.solved
        beside = beside_ends(
            self.kept[solved], lambda places, theta: self._residuals_at(solved[places], theta)
        )
        missing[solved] = np.minimum(missing[solved], 10 * np.maximum(self._residual, beside))
        if self.density.zones.symmetric:
            missing[: len(missing) // 2] = missing[::-1][: len(missing) // 2]
        return missing

    @cached_property
    def _missing_fields(self) -> Array:
        """Sum of the neglected Chebyshev coefficients of other zones' fields on each zone (Z,).

        They are the coefficients beyond the coupled modes.

        They decay geometrically, at a rate that follows from the distance. The fields of a user's
        functions may decay otherwise: then the largest of the last three coefficients is used.
        """
        fall = self._falls
        last = _last_of_fields(
            self.system, self.unknowns, fall, continued=not self.system.equation.grows
        )
        return np.asarray(last * fall / np.maximum(1 - fall, 1e-3))

    @cached_property
    def _falls(self) -> Array:
        """Ratio of successive Chebyshev coefficients of other zones' fields, on each zone (Z,)."""
        return np.exp(-modes.decay(self.density.zones, self.density.kernel))

    @cached_property
    def noise(self) -> Array:
        """Round-off of each zone's right side, relative to the zone's largest coefficient.

        It is zero on zones whose last coefficients are not noise.
        """
        return np.asarray(np.where(self._stopped, self.truncation * 2 * np.sqrt(self.kept), 0.0))

    @cached_property
    def kept(self) -> Index:
        """Number of nonzero coefficients of the right side on each zone."""
        g = self.system.g[: len(self.truncation)] != 0.0
        return np.maximum(g.shape[1] - 1 - np.argmax(g[:, ::-1], axis=1), 1)

    @cached_property
    def _stopped(self) -> Mask:
        """Mask of the zones for which the last coefficients of the right side are only round-off.

        They no longer decrease, or the series was cut where they stopped decreasing.
        """
        head, last = self._ends_of_series
        return np.asarray((self.kept < self.sizes.own[: len(self.kept)]) | (last > 0.5 * head))

    @cached_property
    def _ends_of_series(self) -> tuple[Array, Array]:
        """Largest |coefficient| near the middle of each zone's series, and near the series' end.

        The series are those of the right side. A few coefficients are compared at both places.
        """
        head, last = self._some_up_to(0.5), self._some_up_to(1.0)
        return np.array([row.max() for row in head]), np.array([row.max() for row in last])

    def _some_up_to(self, part: float) -> list[Array]:
        """Absolute values of a few coefficients of each zone's right side, below a certain mode.
        This mode is `part` times the number of nonzero coefficients.
        """
        kept = self.kept.tolist()
        return [
            np.abs(row[int(part * k) :: -1][: max(4, k // 8)])
            for row, k in zip(self.system.g[: len(kept)], kept, strict=True)
        ]

    @cached_property
    def neglected(self) -> Array:
        """Effect of the neglected coefficients c_k of each zone: the sum of 0.73 k |c_k|.
        It is divided by the zone's largest coefficient. 0.73 k is the maximum of T_k / sqrt(1 -
        t^2) without its singular part.

        It is extrapolated from the decay of the last coefficients.
        """
        n = self.kept
        if len(n) == 0:
            return self.truncation
        head, last = self._ends_of_series
        with np.errstate(divide="ignore", invalid="ignore"):
            fall = np.where(head > 0, np.maximum(last / head, 1e-300), 1.0) ** (
                2.0 * OPTIONS.slower_fall / n
            )
        rest = 1 / np.maximum(1 - fall, 1.0 / n)
        flat, following = np.array(
            [_continued(row, one) for row, one in zip(self._some_up_to(1.0), fall, strict=True)]
        ).T
        falling = AT_ENDS * (n + rest) * rest * following
        # Round-off has the same size in all coefficients c_k. The terms k c_k then add up like a
        # random walk, to about n^1.5 times this size.
        rounding = np.maximum(_OF_ROUNDING * n**1.5, np.where(self._stopped, 0.0, falling))
        return np.asarray(
            self.truncation
            * np.maximum(np.where(self._stopped | (flat > 0), rounding, falling), 1.0)
        )

    @cached_property
    def _residual(self) -> Array:
        """The largest residual of the equation on each solved zone, at CHECK_ANGLES."""
        return np.asarray(np.abs(self._residuals).max(axis=1))

    @cached_property
    def _residuals(self) -> Array:
        """Residual of the equation times sqrt(1 - t^2), at check angles on each solved zone.
        The angles are CHECK_ANGLES.
        """
        return self._residuals_at(
            self.density.zones.solved,
            np.broadcast_to(CHECK_ANGLES, (len(self.density.zones.solved), CHECK_POINTS)),
        )

    def _residuals_at(self, solved: Index, theta: Array) -> Array:
        """Residual of the equation times sqrt(1 - t^2), on zones `solved` (n,) at angles `theta`.
        theta has the shape (n, points).
        """
        system, zones = self.system, self.density.zones
        t = np.cos(theta)
        x = (zones.middle[solved][:, None] + zones.half[solved][:, None] * t).ravel()
        transformed = self.density.transform(x)
        value = transformed - self.right_side(x) - system.jumps.left_out(x)
        if zones.symmetric:
            # The mirrored half of the zones is not solved. If the data are not exactly symmetric, a
            # residual remains in this half.
            mirrored = -transformed - self.right_side(-x) - system.jumps.left_out(-x)
            value = np.where(np.abs(mirrored) > np.abs(value), mirrored, value)
        return np.asarray(value.reshape(theta.shape) * np.sin(theta))


@lru_cache(maxsize=1)
def separated_modes() -> tuple[Array, Array]:
    """Values of sin(k theta) at CHECK_ANGLES, k <= CHECK_POINTS / 2, and a pseudo-inverse.
    The pseudo-inverse gives the amplitudes of these low modes of a residual from its values.
    """
    values = np.sin(CHECK_ANGLES[:, None] * np.arange(1, 1 + CHECK_POINTS // 2))
    return values, np.linalg.pinv(values)


def _continued(row: Array, fall: float) -> tuple[bool, float]:
    """Extrapolation of a series of coefficients to the next coefficient.
    The result is (whether the last coefficients `row` hardly decrease, estimate of the next
    coefficient divided by the largest of `row`).

    row: last coefficients in descending order of the mode; fall: mean ratio of successive
    coefficients of the whole series. If the last ones decrease at less than half of this rate, they
    oscillate, and the next one is predicted from the largest of them.
    """
    few = len(row)
    flat = row[: few // 2].max() > row[few // 2 :].max() * fall ** (few / 4)
    return flat, fall**few if flat else float(
        (row * fall ** np.arange(1.0, few + 1)).max() / max(row.max(), 1e-300)
    )


def beside_ends(kept: Index, residual: Callable[[Index, Array], Array]) -> Array:
    """For each zone with a long series, the largest residual close to its ends; 0 for others.

    All neglected coefficients add up there, at angles of about one over their number. kept: number
    of coefficients of each zone; residual: function of zones (k,) and angles (k, points), the
    residual times sqrt(1 - t^2).
    """
    out, long = np.zeros(len(kept)), np.flatnonzero(kept >= SUMS.max_direct_terms)
    if len(long):
        theta = np.exp2([-1, 0, 1]) / kept[long, None]
        out[long] = np.abs(residual(long, np.concatenate((theta, np.pi - theta), axis=1))).max(
            axis=1
        )
    return out


def residual_errors(
    residuals: Array,
    size: Array | float,
    coupled: Index,
    rounding: Array,
    separated: Mask | bool = True,
) -> Array:
    """Relative error of the density on each zone (n,), from residuals at CHECK_ANGLES.
    residuals: the residual times sqrt(1 - t^2), of the shape (n, angles).

    rounding: round-off of the jumps' closed forms, which the residuals include. separated: mask of
    the zones on which the angles separate the first modes of the residual from the others. Of the
    others only the largest value of their sum is known. They cause an error of the density of up to
    this value times the number of modes.
    """
    values, amplitudes_of = separated_modes()
    low = residuals @ amplitudes_of.T
    rest = np.abs(residuals - low @ values.T).max(axis=1)
    high = np.where(separated, rest, np.abs(residuals).max(axis=1)) / size
    low = (
        np.where(
            separated, np.abs(low) @ np.maximum(AT_ENDS * np.arange(1, low.shape[1] + 1), 1.0), 0.0
        )
        / size
    )
    # Between CHECK_ANGLES the residual may be about three times as large as at these angles.
    # `coupled` is the number of modes of each zone, and `5e-16 * coupled` is their round-off.
    beyond = 3 * np.maximum(high - 4e-15 - rounding / size, 0.0) * coupled + 1.5 * low
    return np.asarray(beyond + high + 5e-16 * coupled)


def field_tails(system: System, y: Array, density: Density) -> Array:
    """Size of the last coefficients of the field on each zone (Z,), relative to its density.
    The field is that of the other zones and of the columns (terms of unknown amplitude). The sizes
    are divided by the largest coefficient of the zone's density.
    """
    layout, g = system.layout, system.lowest
    if layout.m.max() < 8:
        return np.zeros(len(layout.m))
    last = _last_of_fields(system, y)
    top = coefficient_sizes(density)
    # Each of the last coefficients is the sum of a coefficient of the right side and an unknown. A
    # coefficient within the round-off of this sum counts as zero. This matters for a zone that
    # bears a small part of its neighbours' load.
    rounding = 8 * 2.2e-16 * row_sizes(g)
    if system.field_sizes is not None:
        rounding[system.zones.solved] += 8 * 2.2e-16 * (system.field_sizes @ np.abs(y))
    tail = np.maximum(last - rounding, 0.0)
    return np.asarray(tail / np.where(top > 0, top, 1.0))


def _last_of_fields(
    system: System, y: Array, fall: Array | None = None, continued: bool = True
) -> Array:
    """Largest of the last three of the m coefficients of the field on each zone (Z,).
    The field is that of the other zones and of the columns (terms of unknown amplitude), and m is
    the number of modes of the zone.

    The result is 0 for fewer than 8 modes.
    fall: ratio of successive coefficients; continued: whether each of the three is extrapolated to
    the last one with this ratio. Sampling at m nodes subtracts coefficient m + 1 + j from
    m + 1 - j, so that only the fraction 1 - fall^(2 j) of a slowly decaying one remains.
    """
    layout, g = system.layout, system.lowest
    some, away = np.flatnonzero(layout.m >= 8)[:, None], np.arange(3)
    last, out = layout.m[some] - away, np.zeros(len(layout.m))
    of_g = np.where(last < g.shape[1], g[some, np.minimum(last, g.shape[1] - 1)], 0.0)
    size = np.abs(y[layout.offset[some] + last] + of_g)
    if fall is not None:
        size = size * fall[some] ** (away * continued) / (1 - fall[some] ** (2 * (away + 1)))
    out[some[:, 0]] = size.max(axis=1, initial=0.0)
    return out
