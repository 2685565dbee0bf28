"""The solution on given zones, with its stated error."""

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

# What T_k / sqrt(1 - t^2) without its singularity comes to beside an end, over k.
_AT_ENDS = 0.73
# What samples at the nodes leave out is folded back onto the coefficients that are kept, and counts
# twice.
_FOLDED = 2.0
# How much slower coefficients are taken to fall beyond the last ones.
_SLOWER = 0.9
# Of the largest of a series' last coefficients where these are rounding, over sqrt(1 - t^2) beside
# an end, which moves so that no 1/sqrt is left there: 0.42 n^1.5 of their size on average, a third
# of the largest, half of which is for _FOLDED.
_OF_ROUNDING = 0.08
# Series so long hardly show in the residual away from the ends what they leave out beside these;
# where all of it adds up, over how many.
_LONG = 96
_ADDING_UP = np.array([0.5, 1.0, 2.0])
# Points of every zone at which the residual is looked at: none of them a node.
LOOKS = 15
THETA = (np.arange(LOOKS) + 0.4142) * np.pi / LOOKS
# sin(k theta) there, for as many k as the points tell apart, and what finds their amplitudes.
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
        """The state without slits, and the places of zones among its own."""
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
        """Estimated error of the density on each zone, over that zone's own largest coefficient
        (Z,).
        """
        return self._errors_over(self.zone_sizes)

    def _errors_over(self, sizes: Array) -> Array:
        """Error of the density on each zone over these sizes (Z,): neglected coefficients, the
        residual between the nodes, and what truncation and rounding of all rows do to the solution,
        which no residual shows. 0 where a size is 0.

        With its singularity taken out, T_k / sqrt(1 - t^2) reaches 0.73 k near an end: so much does
        an error of c_k count. Coefficients of one sign that fall slowly add up within (1 - fall)^2
        of the end alone, where the weight sqrt(1 - t^2) is about 1 - fall^2.
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
        """What truncation and rounding of the rows of all zones do to the density on each (Z,)."""
        return density_rounding(self, self.missing, self.low_residuals)

    @cached_property
    def end_truncation(self) -> Array:
        """Shift of moving ends by the truncation, over their zone's width (Z, 2): 2 K / A by its K."""
        zones = self.density.zones
        slopes = np.where(zones.moves, np.abs(self.density.edge_slopes), np.inf)
        return np.asarray(self.intensity_truncation / np.maximum(slopes, 1e-300) / zones.half).T

    @cached_property
    def intensity_truncation(self) -> Array:
        """Error of K at the left and right ends by truncation (2, Z): of the zone's own
        coefficients, and through all rows.
        """
        through_rows = truncation_through_rows(self, self.missing, self.low_residuals)
        return np.asarray(edge_scale(self.density.zones.half) * self.missing + through_rows)

    @cached_property
    def missing(self) -> Array:
        """Sum of the coefficients that each zone lacks (Z,): its own, those of the other zones'
        fields, and the residual.
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
        """Coefficients of the residual's lowest modes on each solved zone (solved zones, 7), above
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
        """Sum of the coefficients that each zone neglects (Z,), as the decay of the last ones has
        it.
        """
        return np.asarray(
            self.neglected * self.zone_sizes / np.maximum(self.sizes.own[: len(self.neglected)], 1)
        )

    def made_of(self, left_out: Array) -> Array:
        """What such sums make of the density of each zone (Z,)."""
        return np.asarray(_FOLDED * left_out * np.maximum(self.sizes.own[: len(left_out)], 1))

    @cached_property
    def _missing(self) -> Array:
        """The same, but not more than ten times the residual, which would show them: a series may
        fall faster towards its end.
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
        """Sum of the coefficients beyond the coupled modes of what other zones do (Z,): they fall
        as their distance has it. Of those that a user's functions may have the last three are taken
        as they are.
        """
        fall = self._falls
        last = _last_of_fields(
            self.system, self.unknowns, fall, continued=not self.system.equation.grows
        )
        return np.asarray(last * fall / np.maximum(1 - fall, 1e-3))

    @cached_property
    def _falls(self) -> Array:
        """Ratio of each coefficient of what other zones do to the one before (Z,), as their
        distance has it.
        """
        return np.exp(-modes.decay(self.density.zones, self.density.kernel))

    @cached_property
    def noise(self) -> Array:
        """What rounding of the right side amounts to in each zone, over its largest coefficient:
        where coefficients have stopped falling.
        """
        return np.asarray(np.where(self._stopped, self.truncation * 2 * np.sqrt(self.kept), 0.0))

    @cached_property
    def kept(self) -> Index:
        """How many coefficients of the right side there are on each zone."""
        g = self.system.g[: len(self.truncation)] != 0.0
        return np.maximum(g.shape[1] - 1 - np.argmax(g[:, ::-1], axis=1), 1)

    @cached_property
    def _stopped(self) -> Mask:
        """Whether they have stopped falling: what is left of them at the end, or was cut off there,
        is rounding.
        """
        head, last = self._ends_of_series
        return np.asarray((self.kept < self.sizes.own[: len(self.kept)]) | (last > 0.5 * head))

    @cached_property
    def _ends_of_series(self) -> tuple[Array, Array]:
        """The largest of a few coefficients of the right side half way and at the end of each
        zone's series.
        """
        head, last = self._some_up_to(0.5), self._some_up_to(1.0)
        return np.array([row.max() for row in head]), np.array([row.max() for row in last])

    def _some_up_to(self, part: float) -> list[Array]:
        """Sizes of a few coefficients of the right side, from such a part of each zone's series
        down.
        """
        kept = self.kept.tolist()
        return [
            np.abs(row[int(part * k) :: -1][: max(4, k // 8)])
            for row, k in zip(self.system.g[: len(kept)], kept, strict=True)
        ]

    @cached_property
    def neglected(self) -> Array:
        """Sum of 0.73 k |c_k| over the neglected coefficients, estimated from the decay of the last
        ones, over the largest of the zone.
        """
        n = self.kept
        if len(n) == 0:
            return self.truncation
        head, last = self._ends_of_series
        with np.errstate(divide="ignore", invalid="ignore"):
            fall = np.where(head > 0, np.maximum(last / head, 1e-300), 1.0) ** (2.0 * _SLOWER / n)
        rest = 1 / np.maximum(1 - fall, 1.0 / n)
        flat, following = np.array(
            [_continued(row, one) for row, one in zip(self._some_up_to(1.0), fall, strict=True)]
        ).T
        falling = _AT_ENDS * (n + rest) * rest * following
        # Of rounding there is as much in all of them: its sum grows as a random walk.
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
        """Residual of the equation times sqrt(1 - t^2) at a few points of every solved zone, no
        nodes.
        """
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
            # The other half is not solved: data that are no mirror images leave their residual
            # there.
            mirrored = -transformed - self.right_side(-x) - system.jumps.left_out(-x)
            value = np.where(np.abs(mirrored) > np.abs(value), mirrored, value)
        return np.asarray(value.reshape(theta.shape) * np.sin(theta))


def _continued(row: Array, fall: float) -> tuple[bool, float]:
    """(whether the last coefficients of a series, from the end down, fall by less than half of what
    all of them do, the next one as they and that have it, over their largest): they may come and
    go, and the largest of them need not be the first one.
    """
    few = len(row)
    flat = row[: few // 2].max() > row[few // 2 :].max() * fall ** (few / 4)
    return flat, fall**few if flat else float(
        (row * fall ** np.arange(1.0, few + 1)).max() / max(row.max(), 1e-300)
    )


def beside_ends(kept: Index, residual: Callable[[Index, Array], Array]) -> Array:
    """The largest residual so close to the ends of zones that all that long series leave out adds
    up there, 0 of short ones (n,). kept: coefficients of each; residual: times sqrt(1 - t^2), of
    some of the zones (k,) at angles (k, points).
    """
    out, long = np.zeros(len(kept)), np.flatnonzero(kept >= _LONG)
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
    """Error of the density over its size on zones (n,), for residuals of the equation at THETA (n,
    LOOKS).

    rounding: of the jumps' parts, which has its share in the residuals; separated: where the points
    tell the first modes from the rest. Of the rest only the largest value is known; the density is
    off by up to as many times that as there are modes.
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
    # A few points see the residual to a factor; its rounding adds up as the modes do, but not with
    # their order.
    beyond = 3 * np.maximum(high - 4e-15 - rounding / size, 0.0) * coupled + 1.5 * low
    return np.asarray(beyond + high + 5e-16 * coupled)


def field_tails(system: System, y: Array, density: Density) -> Array:
    """Last coupled coefficients of what the other zones and the columns do, over the zone's largest
    one (Z,).
    """
    layout, g = system.layout, system.lowest
    if layout.m.max() < 8:
        return np.zeros(len(layout.m))
    last = _last_of_fields(system, y)
    top = coefficient_sizes(density)
    # What is left is a difference of numbers of the size of the right side and of the fields that
    # were summed: below their rounding there is no tail, as where a zone has little of a load that
    # its neighbours share.
    rounding = 8 * 2.2e-16 * row_sizes(g)
    if system.field_sizes is not None:
        rounding[system.zones.solved] += 8 * 2.2e-16 * (system.field_sizes @ np.abs(y))
    tail = np.maximum(last - rounding, 0.0)
    return np.asarray(tail / np.where(top > 0, top, 1.0))


def _last_of_fields(
    system: System, y: Array, fall: Array | None = None, continued: bool = True
) -> Array:
    """Largest of the last three coupled coefficients of what the other zones and the columns do
    (Z,); of few modes zero.

    fall: ratio of each coefficient to the one before; continued: whether all three are continued to
    the last by it. Samples at m nodes fold coefficient m + 1 + j back onto m + 1 - j, so that of a
    slow fall nearly nothing is left there: 1 - fall^(2 j) of it.
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
