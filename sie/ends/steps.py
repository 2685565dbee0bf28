"""One Newton step of all free ends: its size, its round-off, and its damping."""

import math
from dataclasses import replace

import numpy as np

from sie.basis.data import Array, Mask, record
from sie.basis.weight import needs_half
from sie.basis.zones import Zones
from sie.dense import modes
from sie.ends.limits import border_distances
from sie.ends.motions import DirectMotions, IteratedMotions, motions_of
from sie.ends.options import NewtonOptions
from sie.ends.step_models import StepAtJumps, corner_distances, gap_steps, logarithms_in_gaps
from sie.equation.equation import Equation
from sie.slits.system import AnyDensity, AnyState
from sie.states.state import State


@record
class Branch:
    """Residual of the ends and growth rate of their displacements, before one Newton step.

    residual: largest difference of an intensity from its prescribed value; growth: largest real
    part of the eigenvalues that determine the stability of the ends. They show whether the search
    approaches a stable root.
    """

    residual: float
    growth: float


@record
class LastMoves:
    """The last step of the ends as it was carried out, after damping.

    residual: intensities before the step minus the prescribed intensities (2, Z). moves: outward
    moves (2, Z).
    """

    residual: Array
    moves: Array


@record
class NewtonStep:
    """One undamped Newton step of the free ends.

    moves: mask of the free ends (2, Z); delta: their outward steps (2, Z); noise: the round-off of
    `delta`; change: step of the open condition's value; weak: mask of the zones (Z,) with an end
    next to which the density has the wrong sign, so that the step is only a guess; branch: None if
    the prescribed intensities are zero; residual: intensities minus the prescribed ones (2, Z),
    None if there is a `branch`; depth: `Zones.depth` after the step, None without narrow rims.
    """

    moves: Mask
    delta: Array
    noise: Array
    change: float
    weak: Mask
    branch: Branch | None = None
    residual: Array | None = None
    depth: Array | None = None

    @property
    def certain(self) -> bool:
        """Whether the density has the right sign next to all ends, so that no step is a guess."""
        return not self.weak.any()

    def closes(self, gaps: Array) -> Mask:
        """Mask of the gaps (index: zone on the left) that the undamped step would close."""
        return np.asarray(self.delta[1] + np.roll(self.delta[0], -1) >= (1 - 1e-9) * gaps)

    def vanishes(self, zones: Zones) -> Mask:
        """Mask of the zones that the undamped step would shrink to nothing."""
        return np.asarray(self.delta.sum(axis=0) <= zones.a - zones.b)


def newton_step(
    state: AnyState,
    zones: Zones,
    options: NewtonOptions,
    value_response: AnyDensity | None,
    last: LastMoves | None,
) -> NewtonStep:
    """The next Newton step of the free ends of the zones, before damping.

    value_response: the density caused by a unit of the open condition's value, if there is one.
    last: the last step; None if there was none yet on these zones.
    """
    moves, density = zones.moves, state.density
    k = np.array(density.intensities)
    residual = np.where(moves, k - zones.intensities, 0.0)
    if zones.follow_ends:
        # A moving end has a prescribed intensity other than zero. Then narrow gaps are not treated
        # as cuts inside wide zones (`sie.slits`), so `state.whole` is the solution on the given
        # zones.
        return _coupled_step(state.whole, moves, residual, options, value_response)
    a, noise_k = np.array(density.edge_slopes), state.intensity_noise
    safe, weak = _safe_slopes(density, state.natural, options, residual, last)
    step_for = zones.weight.end_step
    delta = np.where(moves, step_for(residual, safe), 0.0)
    noise = np.where(moves, step_for(noise_k, np.abs(safe)), 0.0)
    change = 0.0
    if value_response is not None:
        k_unit = np.array(value_response.intensities)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            slope = np.where(moves, step_for(k_unit, safe), 0.0)
        largest = options.max_shrink, options.max_growth
        delta, change = bordered(state.equation, density.zones, delta, slope, largest)
        residual = np.where(moves, residual + change * k_unit, 0.0)
        a = a + change * np.array(value_response.edge_slopes)
    plain = NewtonStep(moves, delta, noise, change, weak, residual=residual)
    if not zones.weight.is_half:
        weak = np.asarray((weak & moves).any(axis=0))
        return replace(plain, weak=weak)
    return _with_step_models(state, plain, options, residual, a)


def wanted_signs(zones: Zones, signs: tuple[float, float]) -> Array:
    """Wanted sign (2, Z) of the density minus its prescribed value, near left and right ends.

    Near an end with a value, the density is wanted nearer to zero than this value.
    """
    side = np.broadcast_to(np.array(signs, dtype=float)[:, None], (2, len(zones)))
    return (
        np.where(zones.values == 0.0, side, -np.sign(zones.values)) if zones.have_values else side
    )


def _with_step_models(
    state: AnyState, plain: NewtonStep, options: NewtonOptions, residual: Array, a: Array
) -> NewtonStep:
    """The step, corrected near gaps and jumps, where K is not linear in the motion of an end.

    residual: intensity K minus the prescribed one (2, Z); a: edge slope A (2, Z). Both are those at
    the new value of the open condition (the side condition whose value is an unknown).
    """
    zones, forcing, kernel = state.density.zones, state.equation.forcing, state.equation.kernel
    needs_half(zones.weight, "steps of ends near gaps and jumps")
    side, moves = wanted_signs(zones, options.signs), plain.moves
    gaps = np.array(modes.gaps(zones, kernel))
    jumps = forcing.density_jumps
    tips = None
    if options.signs[0] != options.signs[1]:
        tips = logarithms_in_gaps(forcing, zones, kernel.period) if jumps else np.zeros(gaps.shape)
    across, holds = gap_steps(gaps, zones.b - zones.a, moves, side * residual, side * a, tips)
    delta, weak = np.where(holds, across, plain.delta), plain.weak & ~holds
    by_gaps = zones.weight.end_step(state.intensity_noise, np.abs(np.where(holds, a, 1.0)))
    noise = np.where(holds, by_gaps, plain.noise)
    if len(forcing.jumps):
        model = StepAtJumps(forcing, zones, kernel.period, (options.max_shrink, options.max_growth))
        bent = model.steps(side * residual, np.where(weak, 0.0, side * a), delta)
        bent = np.where(moves & ~(holds & jumps), bent, delta)
        # If a jump of the right side shortens the step, the round-off of the step (which comes from
        # that of the intensity K) is reduced by the same factor.
        noise = noise * np.minimum(np.abs(bent) / np.maximum(np.abs(delta), 1e-300), 1.0)
        delta = bent
    weak_zones = np.asarray((weak & moves).any(axis=0))
    return NewtonStep(moves, delta, noise, plain.change, weak_zones, residual=residual)


def _safe_slopes(
    density: AnyDensity,
    natural: Array,
    options: NewtonOptions,
    residual: Array,
    last: LastMoves | None,
) -> tuple[Array, Mask]:
    """(slopes (2, Z) for Newton's step, mask of ends whose edge slope A is 0 or of wrong sign).

    A is the edge slope of the density. At the solution A has the sign of the density. Far from the
    solution A may have the opposite sign or vanish. There the change of the residual in the last
    step gives a slope. If this slope has the wrong sign, too, A is replaced by its natural size.
    For kernels of thin layers, A and its natural size can be a hundred times too large, and the
    steps a hundred times too short. natural: largest coefficient of each zone except c_0 (Z,);
    residual: intensities minus the prescribed ones (2, Z).
    """
    a, side = np.array(density.edge_slopes), wanted_signs(density.zones, options.signs)
    size = natural * density.zones.slope_scale / np.sqrt(2)
    least, safe = 1e-8 * size, side * (size + 1e-300)
    weak = side * a <= least
    unsure = weak
    if last is not None:
        # The last step should have removed most of the residual. Where more than half of the
        # residual is left, the measured change of the residual gives a better slope than the edge
        # slope A. Changes by very small moves may be round-off.
        measured = np.abs(last.moves) > options.rounding_step * 2 * density.zones.half
        unsure = weak | (measured & (np.abs(residual) > 0.5 * np.abs(last.residual)))
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            secant = density.zones.weight.secant_slope(residual - last.residual, last.moves)
        usable = np.isfinite(secant) & (side * secant > least)
        safe = np.where(usable, secant, np.where(weak, safe, a))
    return np.where(unsure, safe, a), weak


def corners_of(state: AnyState) -> Array:
    """Distance (2, Z) of each end from the nearest jump of the right side; inf if there is none.

    It is also inf if narrow gaps are treated as cuts (slits) inside wide zones. The density changes
    over this distance.
    """
    equation, zones = state.equation, state.density.zones
    if state.density.slit_count or len(equation.forcing.kinks[0]) == 0:
        return np.full((2, len(zones)), np.inf)
    return corner_distances(equation.forcing, zones, equation.kernel.period)


def place_rounding(state: AnyState, corners: Array) -> Array:
    """Error of the ends (2, Z) due to rounded positions at which the right side g is evaluated.

    A rounding e of positions changes the intensity K by about sqrt(w / 2) g' e. The edge slope A is
    sqrt(2 w) g' if it comes from the smooth part of g alone. So the error of the end is about e.
    Jumps within the zone do not contribute, since their distances from the ends are known to full
    precision.
    """
    zones = state.density.zones
    if state.equation.forcing.resolution.exact_places:
        return np.zeros((2, len(zones)))
    rounding = 2 * np.spacing(np.abs([zones.a, zones.b]))
    whole = state.whole
    if not isinstance(whole, State) or state.density.slit_count or not np.isfinite(corners).any():
        return rounding
    # If an end is within round-off of a jump of the right side, its position is computed from its
    # exact distance from the jump. So the position has no round-off.
    rounding = np.where(corners < 4 * rounding, 0.0, rounding)
    cornered, g = whole.density.jumps.kinked, whole.system.g
    # The smooth part of the right side has the Chebyshev coefficients g_k. It contributes at most
    # sum k |g_k| times `slope_scale` to the edge slope A.
    smooth = 4 * (np.abs(g) @ np.arange(g.shape[1])) * zones.slope_scale + 1e-300
    part = smooth / np.maximum(np.abs(np.array(state.density.edge_slopes)), smooth)
    rounding[:, cornered] *= part[:, cornered]
    return np.asarray(rounding)


def bordered(
    equation: Equation,
    zones: Zones,
    delta: Array,
    slope: Array,
    largest: tuple[float, float] = (np.inf, np.inf),
) -> tuple[Array, float]:
    """(damped steps of the ends, change of the unknown value) that satisfy the end condition.

    The unknown value is that of the open side condition. delta: steps (2, Z) at its present value;
    slope: change of the steps by a unit of this value; largest: largest steps inward and outward,
    relative to the width of the zone. If undamped steps had to meet the end condition, an end with
    almost no edge slope would determine the value alone. A zone that is about to vanish has such
    ends.
    """
    residual, by_left, by_right = equation.end_conditions[0].residual(zones)
    gradient, width = np.array([by_left, by_right]), zones.b - zones.a
    inward, outward = largest
    free = np.ones(delta.shape, dtype=bool)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        change = -(residual + np.sum(gradient * delta)) / np.sum(gradient * slope)
        # After a few rounds of this loop, the same ends are damped in every round. At the latest,
        # this is so after as many rounds as there are ends.
        for _ in range(delta.size):
            wanted = delta + change * slope
            cut = np.clip(wanted, -inward * width, outward * width)
            before, free = free, cut == wanted
            by_change = np.sum((gradient * slope)[free])
            if np.array_equal(before, free) or by_change == 0.0:
                break
            change = (
                -(residual + np.sum(np.where(free, gradient * delta, gradient * cut))) / by_change
            )
        return delta + change * slope, float(change)


def damped(
    zones: Zones,
    equation: Equation,
    delta: Array,
    options: NewtonOptions,
    narrow: Mask | None = None,
) -> Array:
    """Outward steps (2, Z), limited to fractions of the zone, gap and distance to the border.

    The border is that of the right side's domain. narrow: mask of the rims whose changes of width
    are already limited. A rim is a zone with two different given values at its ends.
    """
    width = zones.b - zones.a
    gaps = np.array(modes.gaps(zones, equation.kernel))
    room = options.max_shrink * np.minimum(gaps, border_distances(zones, equation))
    outward = np.minimum(options.max_growth * width, room)
    inward = options.max_shrink * width
    if zones.have_values:
        # The intensity K of an end is linear only in motions shorter than the plateau or gap beside
        # the end. Without this limit, a plateau far narrower than its zones is lost.
        inward = np.minimum(inward, options.max_growth * gaps)
    plain = np.clip(delta, -inward, outward)
    shift, widens = 0.5 * (delta[1] - delta[0]), 0.5 * delta.sum(axis=0)
    far = zones.rims & (np.abs(shift) > options.max_growth * width)
    free = far if narrow is None else far | narrow
    if not free.any():
        return plain
    # A rim may move by many times its own width in one step.
    limited = np.clip(widens, -options.max_shrink * width, 0.5 * outward.min(axis=0))
    widens = limited if narrow is None else np.where(narrow, widens, limited)
    shift = np.clip(shift, -room[0], room[1])
    return np.where(free, [widens - shift, widens + shift], plain)


def _coupled_step(
    state: State,
    moves: Mask,
    residual: Array,
    options: NewtonOptions,
    value_response: AnyDensity | None,
) -> NewtonStep:
    """Newton step of all ends together, for prescribed intensities other than zero.

    The right end of a mirrored pair stands for both ends. If the state was found by iteration, the
    growth rate is not computed (nan), since it costs more than the step.
    """
    motions = motions_of(state)
    delta = motions.spread(motions.meeting(-motions.of(residual)))
    noise, change = motions.local(state.intensity_noise), 0.0
    if value_response is not None:
        by_value = motions.of(np.array(value_response.intensities))
        slope = motions.spread(motions.meeting(-by_value))
        delta, change = bordered(state.equation, state.density.zones, delta, slope)
    growth = math.nan if state.iterated else growth_of(motions, options.signs, value_response)
    branch = Branch(float(np.abs(residual).max()), growth)
    return NewtonStep(moves, delta, noise, change, np.zeros(moves.shape[1], dtype=bool), branch)


def growth_of(
    motions: DirectMotions | IteratedMotions,
    signs: tuple[float, float],
    value_response: AnyDensity | None,
) -> float:
    """Largest growth rate of small displacements of the ends; positive if unstable.

    With a condition on the ends, only displacements that keep this condition count.
    """
    if value_response is None:
        return motions.growth(np.array(signs, dtype=float))
    _, by_left, by_right = motions.state.equation.end_conditions[0].residual(motions.zones)
    side = np.array(signs, dtype=float)
    by_value = motions.of(side[:, None] * np.array(value_response.intensities))
    return motions.growth(side, motions.of(np.array([by_left, by_right])), by_value)
