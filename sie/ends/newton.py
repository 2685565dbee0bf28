"""Newton's method on the ends of zones.

The equation is solved on given zones. At distance d from an end the density is
K / sqrt(d) + A sqrt(d), with the intensity K and the edge slope A. At the solution K is the
prescribed intensity. Let the prescribed intensities be zero. Then an outward motion delta_i of end
i changes K_i by -(A_i / 2) delta_i and no other K. The reason is that, to first order, the motion
of an end adds nothing singular to a bounded density. So delta = 2 K / A is a Newton step that costs
one linear solve. A condition on the ends alone (their total width) borders this diagonal Jacobian.
If an intensity other than zero is prescribed, the change of the density is d^(-3/2)-singular and
couples all ends (see `motions`).
"""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sie.basis.data import HALF_DIGITS, Array, Index, Mask
from sie.basis.interval import sides
from sie.basis.zones import Zones
from sie.dense import modes
from sie.density.density import Density
from sie.ends.limits import DomainLimit, domain_limit, pinned_at_limits, released
from sie.ends.motions import DirectMotions, IteratedMotions, motions_of
from sie.ends.options import NewtonOptions, WarmStart
from sie.ends.progress import Convergence, Progress, Step
from sie.ends.rims import are_narrow, end_scales, with_rim_steps, without_alternation
from sie.ends.steps import (
    LastMoves,
    NewtonStep,
    corners_of,
    damped,
    growth_of,
    newton_step,
    place_rounding,
)
from sie.equation.equation import Equation
from sie.fast.iteration import OPTIONS as ITERATION
from sie.slits.system import AnyDensity, AnyState, solve_zones
from sie.states.options import CHECK_ANGLES
from sie.states.options import OPTIONS as ERRORS
from sie.states.rounding import density_changes
from sie.states.sizes import Sizes, first_sizes, sizes_like
from sie.states.solve import SingularSystem
from sie.states.state import State

# With more unknowns than this, shorter series of the density in the first steps save time. With
# fewer unknowns, the linear system costs less than the rest of a step. Insensitive: 128 or 512
# would do as well.
MANY_UNKNOWNS = 256

_CONVERGED = "the ends have converged"
_UNSTABLE = (
    "the ends have converged to an unstable root: displaced ends do not return to it, and another "
    "root may be near"
)
_UNRESOLVED = "the modes of a zone do not resolve a column or the kernel's regular part"
_HARDLY_RESOLVED = (
    "even many modes of a zone hardly resolve the density: a gap is narrow, or one zone has become "
    "far wider than the others"
)
_UNDETERMINED = (
    "the intensities do not determine the ends: some motion of the ends, for example of all ends "
    "together, changes the intensities by no more than rounding"
)


@dataclass(frozen=True, eq=False)
class Free:
    """Result of the search for the free ends of the zones.

    The driving force of an end is s (K - K*), with s the sign of the density next to it
    (`NewtonOptions.signs`), K the intensity and K* the prescribed one. A positive force drives the
    end outward: adhesive contact grows while K is above K*, a crack while |K| is above |K*|. There
    may be several roots, and the search finds one near its start. A root is stable if displaced
    ends return to it. Then the real parts of all eigenvalues of d(driving force)/d(outward motions)
    are negative. Only motions that keep the condition on the ends count, and only symmetric ones if
    the zones are symmetric. If the prescribed intensities are zero, s dK/d(end) = -s A / 2 with the
    edge slope A, and the root is stable.

    Attributes
    ----------
    state : State
        The equation solved on the last zones; `density` is its density.
    converged : bool
        Whether the ends have converged.
    end_error : ndarray
        Remaining move of each end relative to its zone's width (Z, 2), with round-off but without
        `end_truncation`.
    rounding : ndarray
        The round-off in `end_error` (Z, 2).
    trace : tuple of Step
        The Newton steps.
    value, value_error : float
        Value of the open condition (the side condition whose value is an unknown; None if there is
        none), and the last change of this value.
    lost : ndarray
        Zones that vanished.
    met : ndarray
        Gaps that closed, each given by the zone on its left.
    stable : bool or None
        Whether the root is stable, as defined above; None if no root was found.
    reason : str
        Why the search stopped.
    left : ndarray
        The outward moves of the ends (2, Z) that remain after convergence.

    Examples
    --------
    >>> import numpy as np, sie
    >>> hertz = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(np.pi / 2),))
    >>> free = sie.find_ends(hertz, sie.Zones.of([[-0.5, 2.0]]))
    >>> free.converged, free.stable, free.reason
    (True, True, 'the ends have converged')
    """

    state: AnyState
    converged: bool
    end_error: Array
    rounding: Array
    trace: tuple[Step, ...]
    value: float | None
    value_error: float = 0.0
    lost: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    met: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    stable: bool | None = None
    reason: str = ""
    left: Array = field(default_factory=lambda: np.zeros((2, 0)))

    @property
    def next_zones(self) -> Zones:
        """The zones with their ends moved by `left`, the moves that remain after the last step."""
        zones = self.density.zones
        return zones.moved(self.left) if self.left.shape[1] else zones

    @property
    def density(self) -> AnyDensity:
        """The density on the zones of the last step."""
        return self.state.density

    @cached_property
    def end_truncation(self) -> Array:
        """Error of each end due to truncated coefficients, relative to its zone's width (Z, 2)."""
        zones = self.density.zones
        if not zones.follow_ends:
            by_width = self.state.end_truncation
            return by_width * (2 * zones.half / self.end_scales)[:, None]
        by_intensities = self._motions.local(self.state.whole.intensity_truncation)
        return np.asarray((by_intensities / self._width).T)

    @cached_property
    def end_scales(self) -> Array:
        """Length (Z,) by which errors of each zone's ends are divided: mostly its width."""
        return end_scales(self.density.zones, self.state.equation)

    @cached_property
    def narrow_rims(self) -> Mask:
        """Mask (Z,) of the narrow rims, much narrower than the gaps or plateaus beside them.

        A rim is a zone whose density has two different given values at its ends.
        """
        return are_narrow(self.density.zones, self.state.equation)

    @cached_property
    def bent_rims(self) -> Array:
        """Largest difference, on each narrow rim, from the density for a constant right side (Z,).

        It is 0 on zones that are not `narrow_rims`. The difference is proportional to the width of
        the rim. It is given for the width with which the equation is solved (see `Zones.depth`).
        """
        density, out = self.density, np.zeros(len(self.density.zones))
        if not self.narrow_rims.any():
            return out
        assert isinstance(density, Density)
        rims = np.flatnonzero(self.narrow_rims)
        at = rims[:, None], *sides(CHECK_ANGLES)
        solved = replace(density, zones=replace(density.zones, depth=out))
        out[rims] = np.abs(solved.at(*at) - density.passage(*at)).max(axis=1)
        return out

    @cached_property
    def followed(self) -> Array:
        """Error of the density at fixed positions on each zone (Z,), due to the errors of all ends.

        It is zero if all prescribed intensities are zero. Otherwise the motion of an end changes
        the density of all zones to first order.
        """
        if not self.density.zones.follow_ends:
            return np.zeros(len(self.density.zones))
        errors = self._motions.of((self.end_error + self.end_truncation).T * self._width)
        signs = np.random.default_rng(0).choice([-1.0, 1.0], (len(errors), ERRORS.samples))
        return density_changes(self.state.whole, self._motions.responses(errors[:, None] * signs))

    @cached_property
    def _motions(self) -> DirectMotions | IteratedMotions:
        return motions_of(self.state.whole)

    @property
    def _width(self) -> Array:
        return np.asarray(self.density.zones.b - self.density.zones.a)

    @property
    def unresolved(self) -> bool:
        """Whether the search failed because the modes of a zone do not resolve the equation.

        A search with other zones close to these would fail for the same reason.
        """
        return not self.converged and self.reason == _UNRESOLVED


def find_ends(
    equation: Equation,
    zones: Zones,
    tolerance: float = 1e-12,
    options: NewtonOptions | None = None,
    start: WarmStart | None = None,
) -> Free:
    """Find the free ends of the zones, at which the density has the prescribed intensities.

    Parameters
    ----------
    equation : Equation
        Kernel, right side, side conditions. One side condition may have an unknown value (the open
        condition); a condition on the ends then determines it.
    zones : Zones
        First guess of the ends, with their kinds.
    tolerance : float
        Largest remaining error of an end, relative to its zone's width.
    options : NewtonOptions or None
        Options of Newton's method.
    start : WarmStart or None
        Further data for the start: the value of the open condition, the error of the ends, and
        numbers of modes.

    Returns
    -------
    Free
        Whether the ends were found, where they are, and their errors.

    Raises
    ------
    ValueError, SingularSystem
        As `solve_fixed`.

    Examples
    --------
    >>> import numpy as np, sie
    >>> hertz = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(np.pi / 2),))
    >>> sie.find_ends(hertz, sie.Zones.of([[-0.5, 2.0]])).density.zones.table.round(12).tolist()
    [[-1.0, 1.0]]
    """
    search = _Search(equation, zones, tolerance, options or NewtonOptions(), start or WarmStart())
    while (found := search.step()) is None:
        pass
    return found


class _Search:
    """One search for the ends: its zones, its progress, and the value of an open condition."""

    def __init__(
        self,
        equation: Equation,
        zones: Zones,
        tolerance: float,
        options: NewtonOptions,
        start: WarmStart,
    ) -> None:
        zones = equation.weighted(zones)
        equation.check_count(zones)
        self.equation, self.zones, self.options, self.start = equation, zones, options, start
        self.decay = max(0.1 * tolerance, 3e-16) if options.decay is None else options.decay
        self.value = start.value
        gaps = modes.gaps(zones, equation.kernel)[1]
        self.progress = Progress(options, tolerance, zones.b - zones.a, gaps, start.initial_error)
        self.sizes = _sizes_at_first(equation, zones, start.modes_like)
        # The density caused by a unit change of the value of the open condition (the side condition
        # whose value is an unknown). It is None if it has not been computed yet.
        self.value_response: AnyDensity | None = None
        self.last: LastMoves | None = None

    def step(self) -> Free | None:
        """Solve the equation, then move the ends; return the result if the search has ended."""
        state, loose, is_released = self._solved()
        motion = self._newton_step(state)
        if motion is None:
            return self._undetermined(state)
        motion = with_rim_steps(motion, state, self.options, self.progress.tolerance)
        corners = corners_of(state)
        by_places = np.where(motion.moves, place_rounding(state, corners), 0.0)
        motion = replace(motion, noise=motion.noise + by_places)
        opened = self.equation.open_condition is not None
        scales = end_scales(self.zones, self.equation)
        rest = self.progress.after(self.zones, motion, corners, self.value, opened, scales)
        if rest.reached and not is_released and not loose and self._rims_rest(motion):
            return self._converged(state, motion, rest)
        border = domain_limit(self.zones, self.equation, motion.delta)
        if self._is_given_up(state, motion, border):
            reason = self._reason(state, motion, border)
            return self._result(state, motion, rest, reason)
        self.value += motion.change
        return self._moved(state, motion, rest)

    def _rims_rest(self, motion: NewtonStep) -> bool:
        """Whether the step nearly keeps the true widths of very narrow rims.

        A rim is a zone with two different given values at its ends. The tolerance of `depth`, the
        logarithm of a true width, is only the square root of the ends' tolerance: an error of
        `depth` is multiplied by `rims.least_part` to give an error of the ends.
        """
        if motion.depth is None:
            return True
        change = np.abs(motion.depth - self.zones.depth).max()
        return bool(change <= np.sqrt(self.progress.tolerance))

    def _solved(self) -> tuple[AnyState, bool, bool]:
        """(solution, whether it is inexact, whether an end fixed at a limit was set free).

        A state is inexact if its tolerance is larger than that of a final solution.
        """
        sizes, progress = self.sizes, self.progress
        # The open condition is the side condition whose value is an unknown. An iterative solver
        # adds the guess `self.value` to the condition's right side. This saves a second solve for
        # the value.
        sizes.linear, sizes.value = progress.linear, self.value
        sizes.rough = sizes.linear > ITERATION.correction
        decay = self._size_of_last_coefficients()
        state = self._state(decay)
        loose = decay > self.decay or (state.iterated and sizes.linear > progress.tightest)
        self.zones, is_released = released(self.zones, state.density, self.options)
        if is_released and self.zones.follow_ends:
            # An end that was fixed at a limit is now free. The motions of free ends are computed
            # from `state`, which is therefore solved again on the changed zones.
            state = self._state(decay)
        return state, loose, is_released

    def _size_of_last_coefficients(self) -> float:
        """Relative size of the coefficients at which the series of the next solution end.

        If there are many unknowns, the series are only as long as the accuracy of the next step
        requires. Without data of an earlier iterative solution (`carried`), they are also long
        enough that their error does not close the narrowest gap.
        """
        zones, kernel, loosest = self.zones, self.equation.kernel, self.options.first_solution
        if self.sizes.carried is None:
            if modes.coupled(zones, kernel, self.decay, self.sizes.least).sum() <= MANY_UNKNOWNS:
                return self.decay
            gap = float((np.minimum(*modes.gaps(zones, kernel)) / (2 * zones.half)).min())
            loosest = min(loosest, self.options.forcing * gap)
        return max(self.decay, min(loosest, self.progress.left_to_solve))

    def _state(self, decay: float) -> AnyState:
        """The solution on the present zones, with the present guess of a side condition's value.

        The open condition is the side condition whose value is an unknown.
        """
        state = solve_zones(self.equation, self.zones, decay, self.sizes)
        opened = self.equation.open_condition
        if opened is None or self.value == 0.0 or state.iterated:
            return state
        return state.with_value(opened, self.value)

    def _newton_step(self, state: AnyState) -> NewtonStep | None:
        """The next Newton step; None if the prescribed intensities do not determine the ends."""
        opened, response = self.equation.open_condition, self.value_response
        if opened is not None and (
            response is None
            or not state.iterated
            or _moved_part(state, response) > ERRORS.negligible
        ):
            # The response is the density per unit change of the open condition's value. Its
            # relative error changes the Newton step by the same relative amount, which the next
            # step corrects. So the square root of the solution's tolerance is accurate enough, and
            # an iterative solution keeps its response while the ends hardly move. With LU factors a
            # new response costs little.
            tolerance = float(np.sqrt(self.sizes.linear))
            self.value_response = state.response(state.values(opened), tolerance)
        motion = newton_step(state, self.zones, self.options, self.value_response, self.last)
        if motion.branch is not None:
            self.progress.branches.append(motion.branch)
        if np.isfinite(motion.delta).all():
            return motion
        if motion.branch is None:
            raise SingularSystem("no motion of the ends satisfies the condition on the ends")
        return None

    def _moved(self, state: AnyState, motion: NewtonStep, rest: Convergence) -> Free | None:
        """Move the ends; return the result if a vanished zone or a closed gap ends the search."""
        equation, options = self.equation, self.options
        keeps_places = equation.forcing.cornered or equation.forcing.resolution.exact_places
        gaps = modes.gaps(self.zones, equation.kernel)[1]
        closes = motion.closes(gaps)
        vanishes = motion.vanishes(self.zones)
        before = self.zones
        narrow = None if motion.depth is None else are_narrow(before, equation)
        if narrow is not None and self.last is not None:
            motion = without_alternation(motion, before, narrow, self.last)
        moves = damped(before, equation, motion.delta, options, narrow)
        self.zones = zones = pinned_at_limits(before.moved(moves, keeps_places), options.limits)
        if motion.depth is not None:
            self.zones = zones = replace(zones, depth=motion.depth)
        if motion.residual is not None:
            moved = np.array([before.a - zones.a, zones.b - before.b])
            self.last = LastMoves(motion.residual, moved)
        gaps = modes.gaps(zones, equation.kernel)[1]
        lost, met = self.progress.vanished(zones, gaps, vanishes, closes)
        changes = len(lost) + len(met)
        if changes == 0:
            return None
        if options.allow_loss and changes < len(zones) and not zones.symmetric:
            # Zones that vanish bear little load, so the search continues without them.
            self.zones, kept = zones.changed(lost, met, equation.kernel.period)
            self.value_response, self.last, self.sizes = None, None, self.sizes.of(kept)
            self.progress.continue_with(
                self.zones, modes.gaps(self.zones, equation.kernel)[1], kept
            )
            return None
        change = "a zone has vanished" if len(lost) else "a gap has closed"
        reason = "; ".join(filter(None, [change, self.progress.past_fold]))
        return replace(
            self._result(state, motion, rest, reason), value=self.value, lost=lost, met=met
        )

    def _converged(self, state: AnyState, motion: NewtonStep, rest: Convergence) -> Free:
        """The result of the search when the ends have converged."""
        if motion.branch is not None and state.whole.iteration is not None:
            checked = self._with_iterated_errors(state.whole, motion, rest)
            if checked is None:
                return self._undetermined(state)
            motion, rest = checked
        opened = self.equation.open_condition
        if opened is not None and not state.iterated:
            # The last Newton step also changes the value of the open condition (the side condition
            # whose value is an unknown). With LU factors the solution for the new value costs
            # almost nothing. An iterative solver would have to solve again.
            state, self.value = (
                state.with_value(opened, motion.change),
                self.value + motion.change,
            )
        state = state.with_bounded_ends() if self.options.bounded_ends else state
        stable = motion.branch is None or motion.branch.growth < 0.0
        return replace(
            self._result(state, motion, rest, _CONVERGED if stable else _UNSTABLE),
            converged=True,
            value=self.value if opened is not None else None,
            stable=stable,
            left=damped(state.density.zones, self.equation, motion.delta, self.options),
        )

    def _result(self, state: AnyState, motion: NewtonStep, rest: Convergence, reason: str) -> Free:
        """The result of the search at this state, marked as not converged."""
        return Free(
            state,
            False,
            rest.error,
            rest.rounding,
            tuple(self.progress.trace),
            self.value if self.equation.open_condition is not None else None,
            abs(motion.change),
            reason=reason,
        )

    def _undetermined(self, state: AnyState) -> Free:
        """The result of the search when the intensities do not determine the ends."""
        unknown = np.full((len(state.density.zones), 2), np.inf)
        trace = tuple(self.progress.trace)
        return Free(state, False, unknown, unknown, trace, self.value, reason=_UNDETERMINED)

    def _with_iterated_errors(
        self, state: State, motion: NewtonStep, rest: Convergence
    ) -> tuple[NewtonStep, Convergence] | None:
        """(last step with the growth rate of end displacements, errors including the iteration's).

        The result is None if the intensities do not determine the ends.
        """
        assert state.iteration is not None and motion.branch is not None
        motions, zones = IteratedMotions(state, state.iteration), state.density.zones
        amplification = motions.amplification()
        if amplification * HALF_DIGITS > 1.0:  # fewer than half of the digits are left
            return None
        errors = motion.noise + ITERATION.correction * np.abs(motion.delta)
        error = (amplification * errors / (zones.b - zones.a)).T
        growth = growth_of(motions, self.options.signs, self.value_response)
        motion = replace(motion, branch=replace(motion.branch, growth=growth))
        return motion, replace(rest, error=rest.error + error, rounding=rest.rounding + error)

    def _is_given_up(self, state: AnyState, motion: NewtonStep, border: DomainLimit) -> bool:
        """Whether further Newton steps would be useless or are not allowed."""
        progress = self.progress
        return (
            progress.is_hopeless(motion.certain)
            or bool(self._unresolved(state))
            or (self.start.abandon_if_far and not progress.is_close())
            or border.reached
            or len(progress.trace) > self.options.max_steps
        )

    def _unresolved(self, state: AnyState) -> str:
        """Message that the modes do not resolve the equation; empty if they do."""
        if not ((self.equation.grows or self.equation.second_kind) and state.unresolved):
            return ""
        return _UNRESOLVED if self.equation.grows else _HARDLY_RESOLVED

    def _reason(self, state: AnyState, motion: NewtonStep, border: DomainLimit) -> str:
        """Message: the reason why the search ends without a solution."""
        if unresolved := self._unresolved(state):
            return unresolved
        if border.reached:
            return border.reason
        steps = len(self.progress.trace)
        reason = self.progress.past_fold or f"the ends did not converge in {steps} steps"
        reason = f"{reason}; {border.reason}" if border.reason else reason
        if motion.certain:
            return reason
        zone = int(np.flatnonzero(motion.weak)[0])
        return (
            f"{reason}; beside an end of zone {zone} (counted from 0) the density does not have "
            "the sign given by `signs`: start from other zones, give other signs or allow more "
            "steps; there may also be no such density"
        )


def _sizes_at_first(equation: Equation, zones: Zones, modes_like: AnyState | Sizes | None) -> Sizes:
    """Numbers of modes to start with: those of `modes_like` if given, else from the zones alone."""
    if modes_like is None:
        return first_sizes(equation, zones)
    if isinstance(modes_like, Sizes):
        return sizes_like(modes_like, equation, zones, True)
    return sizes_like(modes_like.sizes, equation, zones, False)


def _moved_part(state: AnyState, response: AnyDensity) -> float:
    """Sum of the ends' moves since `response` was computed, divided by the sum of the widths.

    It is infinite if the zones, or the gaps that are treated as slits, are not the same.
    """
    tables = [
        (one.zones.table, other.zones.table)
        for one, other in ((state.density, response), (state.whole.density, response.whole))
    ]
    if any(len(now) != len(then) for now, then in tables):
        return np.inf
    return max(float(np.abs(now - then).sum() / np.diff(then).sum()) for now, then in tables)
