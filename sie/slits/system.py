"""Solutions on zones with narrow gaps, treated as slits of wide zones.

A slit is a narrow gap inside a wide zone, and its slack s is an unknown function (see
`sie.slits.slits`). The slack changes the right side of the wide zones' system by -s, and the level
of each wide zone by the mean of the integral of s. The coefficients of the density on a wide zone
are the right sides of the equations of its slits.

If the system of the wide zones is factorised, GMRES finds the common solution of both sets of
equations. If that system is solved by iteration, the response of the slits is part of the matrix
product in each step.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy.linalg import norm

from sie.basis.data import EPS, Array, Index, Kept, record, row_sizes, widened
from sie.basis.interval import root_weight, sides
from sie.basis.zones import Zones
from sie.dense.system import System
from sie.density.density import Density
from sie.equation.conditions import Linear, Trial, asked
from sie.equation.equation import Equation
from sie.graded.density import GradedDensity
from sie.graded.state import GradedState, is_graded, solve_graded
from sie.second_kind.density import SecondKindDensity
from sie.second_kind.solve import solve_second_kind
from sie.second_kind.state import SecondKindState
from sie.slits.density import SlitDensity
from sie.slits.slits import OPTIONS, SlitGeometry, Slits, merge
from sie.states.base import Answered, Solver, density_of
from sie.states.options import CHECK_ANGLES, CHECK_POINTS
from sie.states.options import OPTIONS as ERRORS
from sie.states.rounding import density_rounding, truncation_through_rows
from sie.states.sizes import Carried, Sizes, first_sizes
from sie.states.solve import SingularSystem, more_modes, solve_fixed
from sie.states.state import State, beside_ends, field_tails, residual_errors
from sie.trees.krylov import gmres


@record
class Opened(Trial):
    """Contributions of the slack s (the unknown in narrow gaps) to quantities in side conditions.

    The contributions are known numbers, so that all matrices are zero. slack: coefficients s_k of
    the slack in every wide zone that has slits; mean_opening: mean of the integral of s over each
    wide zone.
    """

    slack: dict[int, Array]
    mean_opening: Array
    system: System

    def levels(self) -> Linear:
        return self.level, self.mean_opening[self.zones.solved]

    def integrals(self, weight: Callable[[Array], Array], degree: int | None = None) -> Linear:
        """Part of the integrals of weight * density due to the slack s (unknown in narrow gaps).

        The first coefficients of the density are unknowns of the system and contain the share of s
        already. Only the higher coefficients of s are added here.
        """
        out = np.zeros(len(self.zones.solved))
        for place, i in enumerate(self.zones.solved.tolist()):
            if i in self.slack:
                values = self.system.moments(weight, i, len(self.slack[i]), degree)
                beyond = np.arange(
                    self.system.layout.m[i] + 1, min(len(self.slack[i]), len(values))
                )
                out[place] = np.pi * self.zones.half[i] * (values[beyond] @ self.slack[i][beyond])
        return self.level, out


class SlitsNotConverged(SingularSystem):
    """Raised if the joint solution of slits (narrow gaps) and wide zones does not converge.

    A wide zone consists of zones that are joined across slits. The response of a slit on the
    surrounding zones is too strong for the solver.
    """


class SlitSystem(Kept):
    """The equations of all slits (narrow gaps in wide zones), solved with the wide zones."""

    def __init__(self, geometry: SlitGeometry, base: State, linear: float) -> None:
        self.geometry, self.base, self.system = geometry, base, base.system
        # With a factorised matrix, a solution exact to round-off costs no more than an inexact one.
        # The tolerance is then zero.
        self.linear = linear if base.iterated else 0.0
        system = self.system
        modes = base.sizes.own[: len(geometry.wide)]
        self.slits = tuple(
            Slits(geometry, int(i), int(max(modes[i], system.layout.m[i])), system.jumps)
            for i in np.unique(geometry.slit_zone)
        )

    @cached_property
    def _given(self) -> list[Array]:
        """Known parts of the right sides of the slits' equations, for each wide zone with slits.

        They come from the jumps and from the coefficients of the density that are not unknowns.
        """
        out = []
        for here in self.slits:
            m = int(self.system.layout.m[here.zone])
            c = np.zeros(here.modes + 1)
            count = min(self.system.g.shape[1], len(c))
            c[: m + 1] = -self.system.taken[here.zone, : m + 1]
            c[m + 1 : count] = -self.system.g[here.zone, m + 1 : count]
            # The unknown coefficients of the density include those of the slack, the unknown
            # function in a slit. The slack's part due to jumps is known, and is subtracted here.
            seen = np.where(
                np.arange(here.modes + 1) <= m, here.slack_of_kinks[: here.modes + 1], 0.0
            )
            out.append(here.by_coefficients @ (c - seen) + here.of_jumps(self.system.jumps))
        return out

    @cached_property
    def _answers(self) -> list[tuple[Array, Array]]:
        """(matrix, constants) for each wide zone: slits' series = matrix @ unknowns + constants.

        The series are those of the unknown functions in the zone's slits (narrow gaps). The
        unknowns are those of the zone, and include the coefficients of the slack s.
        """
        out = []
        for here, given in zip(self.slits, self._given, strict=True):
            m = int(self.system.layout.m[here.zone])
            smooth = here.solve(here.by_coefficients[:, : m + 1])
            both = np.column_stack((smooth, here.solve(given)))
            answer = np.linalg.solve(
                np.eye(len(smooth)) + smooth @ here.slack_matrix[: m + 1], both
            )
            out.append(
                (np.asarray(answer[:, :-1], dtype=float), np.asarray(answer[:, -1], dtype=float))
            )
        return out

    def _series(self, folded: Array, homogeneous: bool) -> tuple[Array, ...]:
        """Series coefficients of the unknowns in all slits, given the wide zones' unknowns."""
        y, offset = self.base.symmetry.unfold(folded), self.system.layout.offset
        return tuple(
            by @ y[offset[here.zone] : offset[here.zone] + by.shape[1]]
            + (0.0 if homogeneous else given)
            for here, (by, given) in zip(self.slits, self._answers, strict=True)
        )

    def solve(
        self, values: Array | None = None, loose: float = 0.0
    ) -> tuple[Array, tuple[Array, ...], float]:
        """(unknowns of the wide zones, series of all slits, relative change in the last step).

        values: values of the side conditions, for a zero right side without jumps; None solves the
        equation itself. loose: tolerance of an iteration, used if it is larger than `linear`.
        """
        base, homogeneous, iteration = self.base, values is not None, self.base.iteration

        def slit_response(folded: Array) -> Array:
            """Change of the wide zones' right side by the slits, for the unknowns `folded`."""
            return self._right(self._series(folded, True), True)

        given = self._right(
            tuple(np.zeros_like(one) if homogeneous else one for _, one in self._answers),
            homogeneous,
        )
        if iteration is not None:
            # The slits' response is part of the operator, so that one iteration solves the
            # equations of the wide zones and of the slits.
            right, near = (
                (iteration.right(), base.folded_unknowns)
                if values is None
                else (base.right_of(values), None)
            )
            folded = iteration(right + given, near, max(self.linear, loose), slit_response)
            return folded, self._series(folded, homogeneous), 0.0
        start = (
            base.folded_unknowns if values is None else base.solver(base.right_of(values))
        ) + base.solver(given)

        def operator(folded: Array) -> Array:
            return np.asarray(folded - base.solver(slit_response(folded)))

        # The effect of a slit is about proportional to (slit's width / distance from the slit)^2. A
        # few steps of GMRES therefore suffice.
        folded = start + base.solver(slit_response(start))
        for _ in range(2):  # the second pass corrects the round-off of the first
            folded = folded + gmres(operator, start - operator(folded), EPS * float(norm(folded))).x
        change = float(np.abs(start - operator(folded)).max()) / max(
            float(np.abs(folded).max()), 1e-300
        )
        if not change <= max(OPTIONS.max_change, 10 * self.linear):
            raise SlitsNotConverged(
                "the iteration for a wide zone and its narrow gaps does not converge"
            )
        return folded, self._series(folded, homogeneous), change

    def _among_unknowns(self, slack: dict[int, Array]) -> Array:
        """Coefficients s_k of the slack (the unknown in slits), one for each unknown of the system.

        Each s_k stands at the unknown coefficient of the density that it is added to; the other
        entries are zero.
        """
        layout = self.system.layout
        s = np.zeros(layout.size)
        for zone, one in slack.items():
            count, first = min(int(layout.m[zone]) + 1, len(one)), int(layout.offset[zone])
            s[first : first + count] = one[:count]
        return s

    def slack(self, d: tuple[Array, ...], homogeneous: bool) -> dict[int, Array]:
        """Coefficients s_k of the slack (the slits' unknown) on every wide zone with slits."""
        return {
            here.zone: here.slack_matrix @ one + (0.0 if homogeneous else here.slack_of_kinks)
            for here, one in zip(self.slits, d, strict=True)
        }

    def mean_openings(self, d: tuple[Array, ...], homogeneous: bool) -> Array:
        """Mean of the opening (integral of the slack, the slits' unknown) over each wide zone."""
        out = np.zeros(len(self.geometry.wide))
        for here, one in zip(self.slits, d, strict=True):
            out[here.zone] = here.mean_row @ one + (0.0 if homogeneous else here.mean_of_kinks)
        return out

    def _right(self, d: tuple[Array, ...], homogeneous: bool) -> Array:
        """Change of the right side of the wide zones' system by the slack (the slits' unknown)."""
        system, base, slack = self.system, self.base, self.slack(d, homogeneous)
        rows, nothing = (
            -self._among_unknowns(slack)[system.diagonal],
            np.zeros((len(system.zones.solved), 0)),
        )
        view = Opened(
            system.zones, nothing, nothing, slack, self.mean_openings(d, homogeneous), system
        )
        constants = [asked(condition, view, 0)[1] for condition in system.equation.conditions]
        conditions = -np.concatenate(constants) / base.condition_scale if constants else np.zeros(0)
        return np.concatenate((rows, conditions))

    def density(
        self, folded: Array, d: tuple[Array, ...], homogeneous: bool = False
    ) -> tuple[State, SlitDensity]:
        """(solution on the wide zones, density on the given zones) for given unknowns.

        folded: unknowns of the wide zones; d: series of the slits.
        """
        base, system = self.base, self.system
        y = self.base.symmetry.unfold(folded)
        whole = base.homogeneous(y) if homogeneous else density_of(system, y)
        slack = self.slack(d, homogeneous)
        # `without` and `with_slits` have the density's coefficients on the wide zones, without and
        # with the part due to slits. In both, every zone has as many coefficients as the zone that
        # needs most.
        count = max(
            int(system.layout.m.max()) + 1,
            OPTIONS.min_slack_modes + 1,
            *map(len, slack.values()),
            whole.coefficients.shape[1],
        )
        without = widened(whole.coefficients, count)
        with_slits = without.copy()
        for zone, s in slack.items():
            coupled = int(system.layout.m[zone]) + 1
            without[zone, : len(s)][:coupled] -= s[:coupled]
            with_slits[zone, coupled : len(s)] += s[coupled:]
        whole, smooth = (
            replace(whole, coefficients=with_slits),
            replace(whole, coefficients=without),
        )
        left_over = base.linear_error if base.iteration is None else base.iteration.error
        state = replace(
            base, folded_unknowns=folded, unknowns=y, density=whole, linear_error=left_over
        )
        return state, SlitDensity(
            self.geometry, smooth, whole, self.slits, d, forced=not homogeneous
        )

    def tails(self, wide: State, d: tuple[Array, ...]) -> Array:
        """Sizes of the last coefficients of the field on each wide zone, less the slack's part.

        The slack is the unknown function in a slit. See `field_tails`.
        """
        return field_tails(
            self.system, wide.unknowns - self._among_unknowns(self.slack(d, False)), wide.density
        )


@record
class SlitState(Answered):
    """The solution on zones with narrow gaps, which are treated as cuts (slits) in wide zones.

    It has the members of `State`, for the zones as they were given (the pieces of the wide zones
    between the slits). whole: state of the wide zones, slits included; rest: last change of the
    common solution, relative to its largest coefficient.
    """

    slit_system: SlitSystem
    whole: State
    density: SlitDensity
    series: tuple[Array, ...]
    rest: float
    sizes: Sizes

    @property
    def geometry(self) -> SlitGeometry:
        return self.slit_system.geometry

    @property
    def solver(self) -> Solver:
        return self.whole.solver

    @property
    def condition_scale(self) -> Array:
        return self.whole.condition_scale

    @property
    def linear_error(self) -> Array:
        return self.whole.linear_error[self.geometry.piece_zone]

    @property
    def checked_zones(self) -> Index:
        """Indices of the zones on which the residual is evaluated."""
        return np.arange(len(self.density.zones))

    @property
    def left_out(self) -> Array:
        """Estimated neglected coefficients: zero on each zone, as the residual shows them all."""
        return np.zeros(len(self.density.zones))

    def wide_of(self, zones: Index) -> tuple[State, Index]:
        """(solution on wide zones, index of the wide zone that contains each given zone)."""
        return self.whole, self.geometry.piece_zone[zones]

    # The methods below give solutions for other values of the side conditions.
    def response(self, values: Array, tolerance: float = 0.0) -> SlitDensity:
        """The density caused by changes `values` of the side conditions, for a zero right side."""
        return self.slit_system.density(
            *self.slit_system.solve(values, tolerance)[:2], homogeneous=True
        )[1]

    def with_value(self, condition: int, change: float) -> "SlitState":
        """The state after the value of one side condition has changed by `change`."""
        folded, series, _ = self.slit_system.solve(self.values(condition, change))
        both = tuple(one + other for one, other in zip(self.series, series, strict=True))
        wide, density = self.slit_system.density(self.whole.folded_unknowns + folded, both)
        return replace(self, whole=wide, density=density, series=both)

    @property
    def levels(self) -> Array:
        """Mean, over each solved wide zone, of the potential minus the right side's primitive."""
        opened = self.slit_system.mean_openings(self.series, False)
        return self.whole.levels + opened[self.geometry.wide.solved]

    def level_rates(self, values: Array) -> Array:
        """Changes of the zones' `levels` caused by changes of the side conditions' values."""
        folded, series, _ = self.slit_system.solve(values)
        opened = self.slit_system.mean_openings(series, True)
        return (
            self.whole.system.level_changes(self.whole.symmetry.unfold(folded))
            + opened[self.geometry.wide.solved]
        )

    # The methods below estimate errors of the solution.
    @property
    def natural(self) -> Array:
        """Largest coefficient c_k, k > 0, of the density on the wide zone of each given zone."""
        return self.whole.natural[self.geometry.piece_zone]

    @cached_property
    def noise(self) -> Array:
        """For each given zone, the round-off of the right side on its wide zone (`State.noise`)."""
        return self.whole.noise[self.geometry.piece_zone]

    def _intensities_of(self, of_coefficients: Array, at_slits: float = 1.0) -> Array:
        """Errors of the intensities K at the ends of the given zones (2, n).
        K is the coefficient of 1 / sqrt(distance) in the density close to an end.
        of_coefficients: sum of the errors of the coefficients on each wide zone; at_slits: a factor
        at ends of slits.
        """
        geometry = self.geometry
        wide = geometry.wide.edge_scale * of_coefficients
        slits = at_slits * geometry.slits.edge_scale * of_coefficients[geometry.slit_zone]
        return np.array(self.density.edges((wide, wide), (slits, slits), (1.0, 1.0)))

    @cached_property
    def intensity_noise(self) -> Array:
        """Round-off of the intensities K at the left and right ends of the given zones (2, n).
        K is the coefficient of 1 / sqrt(distance) in the density close to an end.
        At the ends of slits the round-off is not averaged over a zone, and gets the factor
        `ERRORS.safety`.
        """
        rest = self.rest * row_sizes(self.whole.density.coefficients).max()
        # An intensity K is `edge_scale` times a sum of the zone's coefficients. So the round-off of
        # K, divided by `edge_scale`, is the round-off of this sum.
        noise = self.whole.intensity_noise.max(axis=0) / self.geometry.wide.edge_scale
        return self._intensities_of(noise + rest, ERRORS.safety)

    @cached_property
    def _tails(self) -> Array:
        """Estimated sum of the neglected coefficients of a slit's unknown function.
        Each wide zone has the largest sum of its slits, or 0 if it has no slits.

        The sum is extrapolated from the decay of the last coefficients.
        """
        out = np.zeros(len(self.geometry.wide))
        for here, row in zip(self.slit_system.slits, self.density.series, strict=True):
            for d in row:
                # The last two coefficients are compared with the two coefficients before them,
                # because every second coefficient may vanish by symmetry.
                last, before = np.abs(d[-2:]).max(), np.abs(d[-4:-2]).max()
                fall = min(last / before, 1.0) if before > 0 else 0.0
                out[here.zone] = max(out[here.zone], last * fall * len(d))
        return out

    @property
    def size(self) -> float:
        """The largest coefficient of the density on all wide zones."""
        return self.whole.size

    @cached_property
    def _neglected(self) -> Array:
        """Estimated sum of the neglected coefficients of the density on each wide zone."""
        at_ends = beside_ends(self.whole.kept, self._wide_residuals)
        return np.asarray(np.minimum(self.whole.left_out, 10 * np.maximum(self._residual, at_ends)))

    @cached_property
    def missing(self) -> Array:
        """Truncation error on each wide zone, as the sum of the neglected coefficients.

        It adds the neglected coefficients of the zone's series, those of the slits' series, and the
        part of the residual at the check angles that exceeds round-off.
        """
        rounding = 2e-15 * self.whole.zone_sizes + self.whole.jumps_rounding
        return np.asarray(
            self._neglected + 3 * np.maximum(self._residual - rounding, 0.0) + self._tails
        )

    @cached_property
    def _residual(self) -> Array:
        """Largest residual of the equation on each wide zone."""
        out = np.zeros(len(self.geometry.wide))
        np.maximum.at(out, self.geometry.piece_zone, np.abs(self._residuals).max(axis=1))
        return out

    @cached_property
    def _residuals(self) -> Array:
        """Residual of the equation at CHECK_ANGLES of each given zone (n, CHECK_POINTS).

        It is multiplied by sqrt(1 - t^2) of the wide zone.
        """
        zones, t = self.density.zones, np.cos(CHECK_ANGLES)
        x = (zones.middle[:, None] + zones.half[:, None] * t).ravel()
        value = self.density.transform(x) - self.right_side(x)
        return np.asarray(value.reshape(-1, CHECK_POINTS) * self._wide_sines)

    @cached_property
    def _wide_sines(self) -> Array:
        """sqrt(1 - t^2) of the wide zone at CHECK_ANGLES of each given zone (n, CHECK_POINTS)."""
        zones, geometry, t = self.density.zones, self.geometry, np.cos(CHECK_ANGLES)
        left = geometry.start[:, None] + (zones.half[:, None] * (1 + t))
        right = geometry.rest[:, None] + (zones.half[:, None] * (1 - t))
        return np.asarray(
            root_weight(left, right) / geometry.wide.half[geometry.piece_zone][:, None]
        )

    def _wide_residuals(self, wide: Index, theta: Array) -> Array:
        """Residual of the equation times sqrt(1 - t^2) on wide zones (n,) at angles (n, points).

        It is 0 in slits.
        """
        zones = self.geometry.wide
        x = (zones.middle[wide][:, None] + zones.half[wide][:, None] * np.cos(theta)).ravel()
        inside = self.density.locate(x)[2]
        value = np.zeros(len(x))
        value[inside] = self.density.transform(x[inside]) - self.right_side(x[inside])
        return np.asarray(value.reshape(theta.shape) * np.sin(theta))

    @cached_property
    def zone_errors(self) -> Array:
        """Estimated error of the density on each given zone, relative to its largest value there.

        Errors and values are multiplied by sqrt(1 - t^2) of the given zone.
        """
        return self._errors_over(self.zone_sizes) * self._sines.max(axis=1)

    @cached_property
    def density_rounding(self) -> Array:
        """Error of each wide zone's density due to truncation and round-off in all equations."""
        return density_rounding(self.whole, self.missing, self._no_modes)

    @cached_property
    def zone_sizes(self) -> Array:
        """Largest value of the density times sqrt(1 - t^2) on each given zone (n,)."""
        left, right = sides(CHECK_ANGLES)
        piece = np.arange(len(self.density.zones))[:, None]
        return np.asarray(
            np.abs(self.density.at(piece, left, right) * np.sin(CHECK_ANGLES)).max(axis=1)
        )

    @cached_property
    def _sines(self) -> Array:
        """Ratio of sqrt(1 - t^2) of each given zone to sqrt(1 - t^2) of its wide zone."""
        return np.asarray(np.sin(CHECK_ANGLES) / self._wide_sines)

    def _errors_over(self, sizes: Array) -> Array:
        """Error (n,) of the density on each given zone, divided by `sizes` of the density.

        The error is multiplied by sqrt(1 - t^2) of the wide zone.
        """
        wide, zone = self.whole, self.geometry.piece_zone
        sizes = np.where(sizes > 0.0, sizes, np.inf)
        of_wide = (
            wide.truncation_errors(self._neglected)
            + self._tails
            + self.density_rounding
            + wide.linear_error
            + self.rest * self.size
        )
        alone, rounding = np.bincount(zone)[zone] == 1, wide.jumps_rounding[zone]
        seen = residual_errors(self._residuals, sizes, wide.system.layout.m[zone], rounding, alone)
        return np.asarray(of_wide[zone] / sizes + seen)

    @cached_property
    def end_truncation(self) -> Array:
        """Truncation error of each moving end of the given zones, relative to the zone's width.

        Shape (n, 2). An error of the intensity K moves an end by 2 K / A. Here A is the edge slope,
        the coefficient of sqrt(d) in the density at the distance d from the end.
        """
        zones = self.density.zones
        slopes = np.where(zones.moves, np.abs(np.array(self.density.edge_slopes)), np.inf)
        through_rows = truncation_through_rows(self.whole, self.missing, self._no_modes).max(axis=0)
        missing = self.missing + through_rows / self.geometry.wide.edge_scale
        return np.asarray(self._intensities_of(missing) / np.maximum(slopes, 1e-300) / zones.half).T

    @property
    def _no_modes(self) -> Array:
        """An empty table: the residual's lowest modes are not known on wide zones with slits.

        The residual is known only on the given zones, which do not determine modes of a wide zone.
        """
        return np.zeros((len(self.geometry.wide.solved), 0))


AnyState = State | SlitState | GradedState | SecondKindState
AnyDensity = Density | SlitDensity | GradedDensity | SecondKindDensity


def solve_zones(
    equation: Equation, zones: Zones, tolerance: float = 1e-14, sizes: Sizes | None = None
) -> AnyState:
    """The solution on zones with fixed ends; narrow gaps may be treated as cuts in wide zones.

    Parameters
    ----------
    equation : Equation
    zones : Zones
    tolerance, sizes
        See `solve_fixed`.

    Returns
    -------
    State, SlitState, GradedState or SecondKindState
        A `SlitState` if narrow gaps were treated as slits. A `GradedState` if zones with fixed ends
        next to narrow gaps have graded coordinates. A `SecondKindState` if the equation has a
        kappa. Else a `State`.

    Raises
    ------
    ValueError, SingularSystem
        See `solve_fixed`.

    Examples
    --------
    >>> import numpy as np, sie
    >>> still = sie.Forcing(np.zeros_like, np.zeros_like)
    >>> near = sie.Zones.of([[-1.0, -0.001], [0.001, 1.0]])
    >>> charge = sie.Equation(sie.cauchy(), still, (sie.Total(1.0), sie.EqualPotential()))
    >>> state = sie.solve_zones(charge, near)
    >>> state.density.totals.round(9).tolist()
    [0.5, 0.5]
    """
    equation.check_count(zones)
    if equation.second_kind:
        return solve_second_kind(equation, equation.weighted(zones), tolerance, sizes)
    sizes = first_sizes(equation, zones, tolerance) if sizes is None else sizes
    if is_graded(equation, zones):
        return solve_graded(equation, zones, tolerance, sizes)
    found = merge(equation, zones, sizes.joined)
    if found is None:
        return solve_fixed(equation, zones, tolerance, sizes)
    try:
        state = _solved_with_slits(equation, found, tolerance, sizes)
    except SlitsNotConverged:
        return solve_fixed(equation, zones, tolerance, sizes)
    if any(here.kinks for here in state.slit_system.slits) and state.density_error > max(
        tolerance / ERRORS.negligible, OPTIONS.max_change
    ):
        # An undeclared jump of a derivative of the right side does no harm in a gap between the
        # given zones. If the gap is a slit, the jump lies within a wide zone. The solution without
        # slits may then be better.
        separate = solve_fixed(equation, zones, tolerance, sizes)
        return separate if separate.density_error < state.density_error else state
    return state


def _solved_with_slits(
    equation: Equation, found: SlitGeometry, tolerance: float, sizes: Sizes
) -> SlitState:
    """The solution on wide zones with slits; `sizes` gets their modes and counts of evaluations."""
    sizes.joined, inner = found.slit_after >= 0, sizes.wide
    if inner is None or len(inner.own) != len(found.wide):
        inner = first_sizes(equation, found.wide)
    inner.carried = sizes.carried
    # If `equation.grows` is false, the number of modes stays as it is. The solution on the wide
    # zones alone is then only the start of the joint iteration, and its relative error may be 1.
    inner.linear = sizes.linear if equation.grows else 1.0
    inner.start = not equation.grows
    inner.rough, inner.value = sizes.rough, sizes.value
    counts = inner.profile_evaluations, inner.kernel_evaluations, inner.iterations
    while True:
        before = inner.iterations
        state = solve_fixed(equation, found.wide, tolerance, inner)
        slit_system = SlitSystem(found, state, sizes.linear)
        folded, series, rest = slit_system.solve()
        if state.iteration is not None:
            more = state.iteration.iterations - (inner.iterations - before)
            inner.iterations += more
            inner.kernel_evaluations += more * state.iteration.system.sums.size
        wide, density = slit_system.density(folded, series)
        # The field that the slits cause through the smooth part of the kernel may need more modes
        # on the wide zones.
        least = more_modes(wide, slit_system.tails(wide, series), tolerance)
        if least is None:
            break
        inner.least = least
    if inner.carried is not None:
        slack = slit_system.slack(series, False)
        inner.carried = sizes.carried = Carried.of(wide.system, wide.unknowns, slack)
    sizes.wide = inner
    sizes.solves += 1
    sizes.profile_evaluations += inner.profile_evaluations - counts[0]
    sizes.kernel_evaluations += inner.kernel_evaluations - counts[1]
    sizes.iterations += inner.iterations - counts[2]
    return SlitState(slit_system, wide, density, series, rest, sizes)
