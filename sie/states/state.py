"""A solution on given zones with its stated error."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sie.basis.data import Array, Index, Mask, row_sizes
from sie.basis.interval import edge_scale
from sie.dense import modes
from sie.dense.system import System
from sie.density.density import Density
from sie.states.base import Solved, coefficient_sizes
from sie.states.rounding import density_rounding, intensity_rounding, truncation_through_rows

# max over t of |T_k / sqrt(1 - t^2) - its singular parts| is 0.73 k, near an end.
_AT_ENDS = 0.73
# Sampling at nodes folds the neglected coefficients back onto the kept ones: they count twice.
_FOLDED = 2.0


@dataclass(frozen=True)
class ErrorOptions:
    """Options of the stated error."""

    # Neglected coefficients are assumed to fall with this part of the observed rate.
    slower_fall: float = 0.9


_OPTIONS = ErrorOptions()

# Rounding of n last coefficients, next to an end that moves so that no 1/sqrt(d) is left: 0.42
# n^1.5 times their mean size, which is a third of the largest; _FOLDED counts the other half.
_OF_ROUNDING = 0.08
# Long series are checked next to the ends too, where all that they neglect adds up. The angles are
# these over the number of coefficients.
_ADDING_UP = np.array([0.5, 1.0, 2.0])
# Points of every zone at which the residual is evaluated; none of them is a node.
LOOKS = 15
THETA = (np.arange(LOOKS) + 0.4142) * np.pi / LOOKS
# sin(k theta) at these points for as many k as they separate, and the inverse.
_FIRST = np.sin(THETA[:, None] * np.arange(1, 1 + LOOKS // 2))
_FIRST_OF = np.linalg.pinv(_FIRST)


@dataclass(frozen=True, eq=False)
class State(Solved):
    """The solution on given zones, with what its error is made of.

    Attributes
    ----------
    density : Density
        The wanted function.
    system, solver
        The equation's rows, and what solves them for further right sides.
    unknowns, folded_unknowns : ndarray
        The coefficients, and those of the solved half of symmetric zones.
    conditions_from : int
        The first row of the side conditions.
    condition_scale : ndarray
        What each of these rows was divided by.
    truncation, tails : ndarray
        What the neglected coefficients may amount to, over the largest coefficient of the same zone
        (Z,), and the same of the coupled modes.
    linear_error : ndarray
        What an iteration left of the error of each zone's coefficients (Z,), 0 for a direct solve.
    sizes : Sizes
        How many functions each zone has.

    Examples
    --------
    >>> import numpy as np, sie
    >>> punch = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (sie.Total(1.0),))
    >>> state = sie.solve_fixed(punch, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> float(round(state.response(np.array([2.0])).total, 12)), state.density_error < 1e-14
    (2.0, True)
    """

    @property
    def whole(self) -> "State":
        """The state without slits: this one."""
        return self

    def wide_of(self, zones: Index) -> "tuple[State, Index]":
        """The state without slits, and the indices of zones in it."""
        return self, zones

    @cached_property
    def intensity_noise(self) -> Array:
        """Rounding of K at the left and right ends (2, Z)."""
        return intensity_rounding(self)

    @cached_property
    def size(self) -> float:
        """The largest coefficient of the density on all zones."""
        return float(self.zone_sizes.max())

    @cached_property
    def density_error(self) -> float:
        """Estimated error of the density on these zones, over its `size`."""
        return float(self._errors_over(np.full(len(self.zone_sizes), self.size)).max())

    @cached_property
    def zone_errors(self) -> Array:
        """Estimated error of the density on each zone (Z,), over that zone's own largest
        coefficient.
        """
        return self._errors_over(self.zone_sizes)

    def _errors_over(self, sizes: Array) -> Array:
        """Error of the density on each zone over given sizes (Z,); 0 where a size is 0.

        It is the sum of the neglected coefficients, the residual between the nodes, and the effect
        of truncation and rounding of all rows, which no residual shows. With its singularity taken
        out, T_k / sqrt(1 - t^2) reaches 0.73 k near an end, and an error of c_k counts as much.
        Coefficients of one sign that fall slowly add up within (1 - fall)^2 of the end only, where
        sqrt(1 - t^2) is about 1 - fall^2.
        """
        zones, modes_of = self.density.zones, self.system.layout.m
        solved, sizes = zones.solved, np.where(sizes > 0.0, sizes, np.inf)
        fields = self._missing_fields * (1 - self._falls**2)
        error = self.made_of(self._missing) + _AT_ENDS * fields * modes_of
        error = (error + self.linear_error + self.density_rounding) / sizes
        seen = residual_errors(
            self._residuals, sizes[solved], modes_of[solved], self.jumps_rounding[solved]
        )
        error[solved] += seen
        return np.maximum(error, error[::-1]) if zones.symmetric else error

    @cached_property
    def density_rounding(self) -> Array:
        """Effect of the truncation and rounding of all rows on the density of each zone (Z,)."""
        return density_rounding(self, self.missing, self.low_residuals)

    @cached_property
    def end_truncation(self) -> Array:
        """Error of moving ends by truncation, over their zone's width (Z, 2): 2 K / A of the error
        of K.
        """
        zones = self.density.zones
        slopes = np.where(zones.moves, np.abs(self.density.edge_slopes), np.inf)
        return np.asarray(self.intensity_truncation / np.maximum(slopes, 1e-300) / zones.half).T

    @cached_property
    def intensity_truncation(self) -> Array:
        """Error of K at the left and right ends by truncation (2, Z): own coefficients, and all
        rows.
        """
        through_rows = truncation_through_rows(self, self.missing, self.low_residuals)
        return np.asarray(edge_scale(self.density.zones.half) * self.missing + through_rows)

    @cached_property
    def missing(self) -> Array:
        """Sum of the coefficients that each zone lacks (Z,): its own, those of fields, and the
        residual.
        """
        out, solved = self._missing + self._missing_fields, self.density.zones.solved
        out[solved] += 3 * np.maximum(self._residual - self.residual_rounding[solved], 0.0)
        return np.maximum(out, out[::-1]) if self.density.zones.symmetric else out

    @cached_property
    def residual_rounding(self) -> Array:
        """Rounding in the residual of each zone (Z,)."""
        return 2e-15 * self.zone_sizes + self.jumps_rounding

    @cached_property
    def low_residuals(self) -> Array:
        """Amplitudes of the residual's lowest modes on each solved zone (solved zones, 7), above
        rounding.
        """
        rounding = self.residual_rounding[self.density.zones.solved, None]
        return np.maximum(np.abs(self._residuals @ _FIRST_OF.T) - rounding, 0.0)

    @cached_property
    def zone_sizes(self) -> Array:
        """The largest coefficient of the density on each zone, jumps included (Z,)."""
        return coefficient_sizes(self.density)

    @cached_property
    def jumps_rounding(self) -> Array:
        """Rounding of the parts of all jumps of each zone (Z,)."""
        return self.system.jumps.rounding(len(self.density.zones))

    @cached_property
    def left_out(self) -> Array:
        """Sum of the coefficients that each zone neglects (Z,), extrapolated from the decay of the
        last ones.
        """
        return np.asarray(
            self.neglected * self.zone_sizes / np.maximum(self.sizes.own[: len(self.neglected)], 1)
        )

    def made_of(self, left_out: Array) -> Array:
        """Errors of the density of each zone (Z,) by such sums."""
        return np.asarray(_FOLDED * left_out * np.maximum(self.sizes.own[: len(left_out)], 1))

    @cached_property
    def _missing(self) -> Array:
        """`left_out`, bounded by ten times the residual.

        The residual would show more: a series may fall faster towards its end than it is
        extrapolated.
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
        """Sum of the coefficients of the other zones' fields beyond the coupled modes (Z,).

        They fall geometrically, by distance. A user's functions may fall otherwise: then the last
        three coefficients are taken as they are.
        """
        fall = self._falls
        last = _last_of_fields(
            self.system, self.unknowns, fall, continued=not self.system.equation.grows
        )
        return np.asarray(last * fall / np.maximum(1 - fall, 1e-3))

    @cached_property
    def _falls(self) -> Array:
        """Ratio of successive coefficients of the other zones' fields (Z,), by distance."""
        return np.exp(-modes.decay(self.density.zones, self.density.kernel))

    @cached_property
    def noise(self) -> Array:
        """Rounding of the right side in each zone over its largest coefficient, where coefficients
        are noise.
        """
        return np.asarray(np.where(self._stopped, self.truncation * 2 * np.sqrt(self.kept), 0.0))

    @cached_property
    def kept(self) -> Index:
        """Number of coefficients of the right side on each zone."""
        g = self.system.g[: len(self.truncation)] != 0.0
        return np.maximum(g.shape[1] - 1 - np.argmax(g[:, ::-1], axis=1), 1)

    @cached_property
    def _stopped(self) -> Mask:
        """Mask of the zones whose last coefficients are rounding: they fall no more, or were cut
        off there.
        """
        head, last = self._ends_of_series
        return np.asarray((self.kept < self.sizes.own[: len(self.kept)]) | (last > 0.5 * head))

    @cached_property
    def _ends_of_series(self) -> tuple[Array, Array]:
        """(largest of a few coefficients at half of each series, and at its end), of the right
        side.
        """
        head, last = self._some_up_to(0.5), self._some_up_to(1.0)
        return np.array([row.max() for row in head]), np.array([row.max() for row in last])

    def _some_up_to(self, part: float) -> list[Array]:
        """A few coefficients of the right side of each zone, downwards from a given part of its
        series.
        """
        kept = self.kept.tolist()
        return [
            np.abs(row[int(part * k) :: -1][: max(4, k // 8)])
            for row, k in zip(self.system.g[: len(kept)], kept, strict=True)
        ]

    @cached_property
    def neglected(self) -> Array:
        """Sum of 0.73 k |c_k| over the neglected coefficients, over the zone's largest coefficient.

        It is extrapolated from the decay of the last coefficients.
        """
        n = self.kept
        if len(n) == 0:
            return self.truncation
        head, last = self._ends_of_series
        with np.errstate(divide="ignore", invalid="ignore"):
            fall = np.where(head > 0, np.maximum(last / head, 1e-300), 1.0) ** (
                2.0 * _OPTIONS.slower_fall / n
            )
        rest = 1 / np.maximum(1 - fall, 1.0 / n)
        flat, following = np.array(
            [_continued(row, one) for row, one in zip(self._some_up_to(1.0), fall, strict=True)]
        ).T
        falling = _AT_ENDS * (n + rest) * rest * following
        # Rounding is in all coefficients alike: its sum grows as a random walk.
        rounding = np.maximum(_OF_ROUNDING * n**1.5, np.where(self._stopped, 0.0, falling))
        return np.asarray(
            self.truncation
            * np.maximum(np.where(self._stopped | (flat > 0), rounding, falling), 1.0)
        )

    @cached_property
    def _residual(self) -> Array:
        """The largest residual of each solved zone at a few points."""
        return np.asarray(np.abs(self._residuals).max(axis=1))

    @cached_property
    def _residuals(self) -> Array:
        """Residual of the equation times sqrt(1 - t^2) at a few points of every solved zone."""
        return self._residuals_at(
            self.density.zones.solved,
            np.broadcast_to(THETA, (len(self.density.zones.solved), LOOKS)),
        )

    def _residuals_at(self, solved: Index, theta: Array) -> Array:
        """Residual of the equation times sqrt(1 - t^2) on zones (n,) at angles (n, points)."""
        system, zones = self.system, self.density.zones
        t = np.cos(theta)
        x = (zones.middle[solved][:, None] + zones.half[solved][:, None] * t).ravel()
        transformed = self.density.transform(x)
        value = transformed - self.right_side(x) - system.jumps.left_out(x)
        if zones.symmetric:
            # The mirrored half is not solved: data that are not symmetric leave their residual
            # there.
            mirrored = -transformed - self.right_side(-x) - system.jumps.left_out(-x)
            value = np.where(np.abs(mirrored) > np.abs(value), mirrored, value)
        return np.asarray(value.reshape(theta.shape) * np.sin(theta))


def _continued(row: Array, fall: float) -> tuple[bool, float]:
    """(whether the last coefficients hardly fall, the next coefficient over their largest).

    row: last coefficients from the end downwards; fall: their ratio over the whole series. If they
    fall by less than half of that, they come and go, and the largest need not be the first.
    """
    few = len(row)
    flat = row[: few // 2].max() > row[few // 2 :].max() * fall ** (few / 4)
    return flat, fall**few if flat else float(
        (row * fall ** np.arange(1.0, few + 1)).max() / max(row.max(), 1e-300)
    )


def beside_ends(kept: Index, residual: Callable[[Index, Array], Array]) -> Array:
    """The largest residual close to the ends of long series (n,), 0 of short ones.

    There all neglected coefficients add up. kept: number of coefficients of each; residual: times
    sqrt(1 - t^2), of given zones (k,) at angles (k, points).
    """
    out, long = np.zeros(len(kept)), np.flatnonzero(kept >= modes.OPTIONS.long_series)
    if len(long):
        theta = _ADDING_UP / kept[long, None]
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
    """Error of the density over its size on zones (n,), for residuals at THETA (n, LOOKS).

    rounding: of the jumps' parts, which is part of the residuals; separated: where the points
    separate the first modes from the rest. Of the rest only the largest value is known, and the
    density is off by up to that times the number of modes.
    """
    low = residuals @ _FIRST_OF.T
    rest = np.abs(residuals - low @ _FIRST.T).max(axis=1)
    high = np.where(separated, rest, np.abs(residuals).max(axis=1)) / size
    low = (
        np.where(
            separated, np.abs(low) @ np.maximum(_AT_ENDS * np.arange(1, low.shape[1] + 1), 1.0), 0.0
        )
        / size
    )
    # A few points see the residual to within a factor. Rounding adds up over the modes, but without
    # their order as weight.
    beyond = 3 * np.maximum(high - 4e-15 - rounding / size, 0.0) * coupled + 1.5 * low
    return np.asarray(beyond + high + 5e-16 * coupled)


def field_tails(system: System, y: Array, density: Density) -> Array:
    """Last coupled coefficients of the other zones' fields and of the columns, over the zone's
    largest (Z,).
    """
    layout, g = system.layout, system.lowest
    if layout.m.max() < 8:
        return np.zeros(len(layout.m))
    last = _last_of_fields(system, y)
    top = coefficient_sizes(density)
    # A tail is a difference of the right side and of the fields that were summed. Below their
    # rounding there is none, as where a zone has a small share of a load that its neighbours take.
    rounding = 8 * 2.2e-16 * row_sizes(g)
    if system.field_sizes is not None:
        rounding[system.zones.solved] += 8 * 2.2e-16 * (system.field_sizes @ np.abs(y))
    tail = np.maximum(last - rounding, 0.0)
    return np.asarray(tail / np.where(top > 0, top, 1.0))


def _last_of_fields(
    system: System, y: Array, fall: Array | None = None, continued: bool = True
) -> Array:
    """Largest of the last three coupled coefficients of the other zones' fields and the columns
    (Z,).

    It is 0 of few modes. fall: ratio of successive coefficients; continued: whether the three
    are continued to the last one by it. Sampling at m nodes folds coefficient m + 1 + j back
    onto m + 1 - j, so that of slowly falling coefficients only 1 - fall^(2 j) is left there.
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
