"""Effect of round-off and truncation of the system's rows on the density and on the intensities.

The round-offs of different terms are independent. So the round-off of a row of the system A y = b
is EPS times the root of the sum of squares of the row's terms. The intensities K are linear in the
unknowns, K = C y, so one solve for X = A^-T C^T gives the effect of every row on every K. Levels
are differences of large potentials and large heights (values of the primitive of the right side g).
They have the round-off of these. So a lightly loaded zone between heavy ones is affected by the
round-off of all heights.
"""

import numpy as np

from sie.basis.chebyshev import bounded_part
from sie.basis.data import EPS, Array, Index, by_rows, root_of_squares
from sie.basis.zones import Zones
from sie.dense.lu import Factored
from sie.dense.modes import conformal_radius, gaps
from sie.density.series import OPTIONS as SAMPLES
from sie.equation.conditions import speaks_of_levels
from sie.equation.equation import Forcing
from sie.states.base import Solved
from sie.states.options import OPTIONS

# Relative tolerance of an iterative solution for one sample of random errors. Samples differ from
# one another by more than this.
SAMPLE_TOLERANCE = 0.1


def intensity_rounding(state: Solved) -> Array:
    """Round-off of the intensity K at the left and right end of each zone, (2, Z).
    K is the coefficient of 1 / sqrt(distance) in the density close to an end.
    """
    density, system = state.density, state.system
    zones = density.zones
    # An intensity is a difference of the right side and the fields of zones. Its round-off is
    # relative to the right side and the fields, however small the difference is.
    subtracted = (
        sum(
            by_rows(lambda rows: np.abs(rows).sum(axis=1), table)
            for table in (density.coefficients, system.g)
        )
        + state.natural
    )
    own = 4e-16 * zones.edge_scale * subtracted
    if state.direct is None:
        own = (
            own + _of_levels(state) + 2 * zones.edge_scale * state.linear_error + _of_others(state)
        )
    if state.direct is None or _stands_alone(state):
        return np.array([own, own])
    return np.asarray(own + OPTIONS.safety * _through_rows(state))


def _stands_alone(state: Solved) -> bool:
    """Whether there is only one zone, with no field on it but that of its own density.

    There are no images, no regular part of the kernel and no columns, so that nothing but the
    coefficients of the zone is unknown.
    """
    equation = state.system.equation
    kernel = equation.kernel
    plain = kernel.poles == (0.0,) and kernel.period is None and kernel.regular is None
    return len(state.density.zones) == 1 and plain and not equation.columns


def _of_others(state: Solved) -> Array | float:
    """Error of each zone's intensities K (Z,) caused by the round-off of jumps in other zones.
    K is the coefficient of 1 / sqrt(distance) in the density close to an end.

    The round-off is replaced by one random density of the same size, and the field of this density
    gives the error. The error matters for narrow zones next to a wide zone with many jumps, because
    the terms of the jumps are much larger than their sum.
    """
    system, zones = state.system, state.density.zones
    layout, rounding = system.layout, system.jumps.rounding(len(zones))
    if system.equation.forcing.value_jumps:
        # The field of the zones `by_moments`, which have many jumps, is computed from the right
        # side itself, without this round-off.
        rounding[system.by_moments] = 0.0
    if not rounding.any():
        return 0.0
    order = np.arange(layout.coefficients) - np.repeat(layout.offset, layout.m + 1)
    shaken = np.zeros(layout.size)
    # The errors of coefficients decrease with the order. The totals, of order 0, are prescribed and
    # have no error.
    shaken[: layout.coefficients] = np.where(
        order > 0, np.repeat(rounding, layout.m + 1) / (1 + order), 0.0
    )
    shaken[: layout.coefficients] *= np.random.default_rng(0).standard_normal(layout.coefficients)
    out = np.zeros(len(zones))
    assert state.iteration is not None
    out[zones.solved] = state.iteration.system.felt(shaken)
    out = np.maximum(out, out[::-1]) if zones.symmetric else out
    return np.asarray(OPTIONS.safety * zones.edge_scale * out)


def _of_levels(state: Solved) -> Array | float:
    """Error of intensities K (Z,) due to round-off of levels; 0 if no condition uses levels.
    K is the coefficient of 1 / sqrt(distance) close to an end. A level is the constant part of the
    potential on a zone.
    """
    equation, zones = state.system.equation, state.density.zones
    if len(zones) == 1 or not any(speaks_of_levels(c, zones) for c in equation.conditions):
        return 0.0
    w = zones.half
    # Let w be the half width, and R the conformal radius between neighbours that are grounded
    # half-lines. Then an error e of a zone's level changes its coefficient c_0 by e / (w log(2R /
    # w)). Neighbours no wider than the zone screen the zone less than half-lines do. So the smaller
    # logarithm log(R / 2w) is used, and at least 1. The intensity K changes by `edge_scale` times
    # the change of c_0.
    radius = conformal_radius(*(gap + w for gap in gaps(zones, equation.kernel)))
    logarithm = np.log(0.5 * np.minimum(radius, equation.kernel.datum) / w) - zones.depth
    logarithm = np.maximum(logarithm, 1.0)
    return np.asarray(zones.edge_scale * 2 * _level_noise(state) / (logarithm * 2 * w))


def _through_rows(state: Solved) -> Array:
    """Root mean square effect of the round-off of all rows on each intensity K (2, Z).
    K is the coefficient of 1 / sqrt(distance) in the density close to an end.
    """
    solver = state.direct
    assert solver is not None
    effect = _effect_on_intensities(state, solver)
    rounding, levels = _of_rows(state, solver)
    of_levels = state.level_rows.T @ effect[state.conditions_from :]
    both = np.hypot(root_of_squares(effect.T, rounding), root_of_squares(of_levels.T, levels))
    return _of_solved(state, both.reshape(2, -1))


def _effect_on_intensities(state: Solved, solver: Factored) -> Array:
    """Derivatives of the intensities K by the right sides of the system's rows, (rows, 2 n).
    K is the coefficient of 1 / sqrt(distance) in the density close to an end.

    The columns are the left ends of the n solved zones, then their right ends.
    """
    (left, _), (right, _) = state.system.intensities()
    return solver.transposed(state.symmetry.fold(np.concatenate((left, right))).T)


def _of_solved(state: Solved, values: Array) -> Array:
    """Values at all ends (2, Z), from values at the ends of the solved zones (2, n).
    The ends of other zones are mirror images, or have the value 0.
    """
    zones = state.system.zones
    out = np.zeros((2, len(zones)))
    out[:, zones.solved] = values
    return np.maximum(out, out[::-1, ::-1]) if zones.symmetric else out


def truncation_through_rows(state: Solved, missing: Array, low: Array) -> Array:
    """Effect of the truncation of series on the intensity K at both ends of each zone (2, Z).
    K is the coefficient of 1 / sqrt(distance) in the density close to an end.

    missing, low: see `_row_truncation`.
    """
    solver = state.direct
    if solver is None:
        padded = state.system.layout.padded
        changes = [
            np.abs(padded(one)).sum(axis=1) for one in _iterated_changes(state, missing, low)
        ]
        return np.asarray(
            state.density.zones.edge_scale * np.max(changes, axis=0) * np.ones((2, 1))
        )
    if _stands_alone(state):
        return np.zeros((2, len(state.density.zones)))
    effect = np.abs(_effect_on_intensities(state, solver))
    return _of_solved(state, (_row_truncation(state, solver, missing, low) @ effect).reshape(2, -1))


def _row_truncation(state: Solved, solver: Factored, missing: Array, low: Array) -> Array:
    """Error of each row of the system due to truncated coefficients and low modes of the residual.

    missing: sum of the truncated coefficients (Z,); low: amplitudes of the residual's lowest modes
    (solved zones, modes). Truncated coefficients act on the rows as the last kept coefficient does,
    or less. Side conditions may carry this effect to other zones and enlarge it. For example, K = 0
    at an end next to a strong zone may determine the total of a distant zone.
    """
    system = state.system
    layout, solved = system.layout, system.zones.solved
    out = np.abs(solver.last) @ np.where(layout.m[solved] > 0, missing[solved], 0.0)
    some, of_low = _low_rows(state, low)
    out[some] += of_low
    return np.asarray(out)


def _iterated_changes(state: Solved, missing: Array, low: Array) -> list[Array]:
    """Changes of the unknowns due to random errors of the system's rows, one for each sample.

    The errors of the rows are those of `_row_truncation`, the round-off of their terms, and the
    iteration's remaining error of the totals. Each row has its own random sign. If instead each
    unknown had a random sign, the change would be the error of this unknown and no other.
    """
    iteration, symmetry = state.iteration, state.symmetry
    assert iteration is not None
    asked = missing.tobytes(), low.tobytes()
    if iteration.random_changes is not None and iteration.random_changes[0] == asked:
        return iteration.random_changes[1]
    chance, last, stated = np.random.default_rng(0), state.system.last_unknowns, iteration.error
    solved = state.density.zones.solved
    changes = []
    for _ in range(OPTIONS.samples):
        wrong = EPS * state.folded_unknowns * chance.standard_normal(symmetry.size)
        lacking = np.where(state.system.layout.m[solved] > 0, missing[solved], 0.0)
        wrong[last] += lacking * chance.choice([-1.0, 1.0], len(last))
        wrong[iteration.preconditioner.first] += state.linear_error[solved] * chance.choice(
            [-1.0, 1.0], len(last)
        )
        rows = np.abs(iteration.rows(wrong, rough=True))
        some, of_low = _low_rows(state, low)
        rows[some] += of_low
        right = rows * chance.choice([-1.0, 1.0], len(rows))
        changes.append(symmetry.unfold(iteration(right, None, SAMPLE_TOLERANCE)))
    iteration.error, iteration.random_changes = stated, (asked, changes)
    return changes


def _low_rows(state: Solved, low: Array) -> tuple[Index, Array]:
    """(indices of the matrix rows of the lowest modes, errors of these rows due to the residual).

    low: see `_row_truncation`.
    """
    layout, solved = state.system.layout, state.system.zones.solved
    rows = state.system.diagonal
    zone = np.searchsorted(layout.offset, rows, side="right") - 1
    mode = rows - layout.offset[zone] - 1
    some = np.flatnonzero(mode < low.shape[1])
    return some, np.asarray(low[np.searchsorted(solved, zone[some]), mode[some]])


def _of_rows(state: Solved, solver: Factored) -> tuple[Array, Array]:
    """(round-off of the system's rows, round-off of the levels of the solved zones).
    A level is the constant part of the potential on a zone.

    In the first array, the rows of side conditions on levels are zero, because their round-off
    follows from the second array.
    """
    rounding, of_levels = EPS * solver.size_of_rows, state.level_rows.any(axis=1)
    rounding[state.conditions_from :][of_levels] = 0.0
    count = len(state.density.zones.solved)
    return rounding, np.broadcast_to(
        _level_noise(state), (count,)
    ) if of_levels.any() else np.zeros(count)


def density_rounding(state: Solved, missing: Array, low: Array) -> Array:
    """Error of each zone's density (Z,) due to truncation and round-off of the equations' rows.

    The density is taken without its singular factors. If conditions nearly depend on each other,
    the effect is many times the errors of the rows. So the rows are changed at random, with a fixed
    seed, and the change of the density is measured. missing, low: see `_row_truncation`.
    """
    zones, solver = state.density.zones, state.direct
    if _stands_alone(state):
        return np.zeros(len(zones))
    if solver is None:
        return _of_levels(state) / zones.edge_scale + density_changes(
            state, _iterated_changes(state, missing, low)
        )
    chance = np.random.default_rng(0)
    rounding, levels = _of_rows(state, solver)
    rounding = np.hypot(rounding, _row_truncation(state, solver, missing, low))
    shaken = rounding[:, None] * chance.standard_normal((solver.size, OPTIONS.samples))
    shaken[state.conditions_from :] += state.level_rows @ (
        levels[:, None] * chance.standard_normal((OPTIONS.samples, len(levels))).T
    )
    return density_changes(state, [state.symmetry.unfold(change) for change in solver(shaken).T])


def density_changes(state: Solved, unknowns: list[Array]) -> Array:
    """Root mean square of sampled changes of each zone's density (Z,), times a safety factor.

    unknowns: the change of the unknowns in each sample.
    """
    largest = _largest(
        np.concatenate([state.system.layout.padded(one) for one in unknowns])
    ).reshape(len(unknowns), -1)
    return np.asarray(
        OPTIONS.safety * root_of_squares(largest.T, np.full(len(unknowns), len(unknowns) ** -0.5))
    )


def _largest(coefficients: Array) -> Array:
    """Largest value on each zone of S = sum c_k T_k / sqrt(1 - t^2) and of its bounded part.

    S is evaluated at a few angles. The factor 1 / sqrt(1 - t^2) is kept below its value at the
    distance `OPTIONS.end_distance` from an end.
    """
    k = np.arange(max(coefficients.shape[1], 2))
    # At an end all |T_k| are 1, so that the terms of many modes may add up there. Therefore the
    # angles lie closer together near the ends.
    theta = np.pi * np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, SAMPLES.samples)[:, None]) ** 2
    u = bounded_part(coefficients)[2]
    whole = (
        coefficients
        @ np.cos(theta * k[: coefficients.shape[1]]).T
        / np.maximum(np.sin(theta), np.sqrt(2 * OPTIONS.end_distance)).T
    )
    bounded = u @ np.sin(theta * k[1 : u.shape[1] + 1]).T
    return np.asarray(np.maximum(np.abs(whole).max(axis=1), np.abs(bounded).max(axis=1)))


def _level_noise(state: Solved) -> Array:
    """Root mean square round-off of the level of each zone.
    The level is the mean of the potential minus the primitive of the right side.
    """
    sizes, forcing = state.sizes, state.system.equation.forcing
    if state.system.integrated:
        return np.asarray(state.system.level_rounding(state.unknowns))
    if sizes.primitive_rounding is None:
        sizes.primitive_rounding = primitive_rounding(
            forcing, state.system.zones, state.density.kernel.period
        )
    return np.hypot(state.system.level_rounding(state.unknowns), sizes.primitive_rounding)


def primitive_rounding(forcing: Forcing, zones: Zones, period: float | None) -> float:
    """Round-off of the values of the right side's primitive at the ends of zones.

    The round-off has two parts. Values are rounded relative to their range on the zones and between
    them. The round-off of their evaluation is measured as the deviation from straight lines over a
    few units in the last digit of x.
    """
    assert forcing.primitive is not None
    ends = np.unique(np.concatenate((zones.a, zones.b)))
    ahead = zones.a[1:] if period is None else np.append(zones.a[1:], zones.a[0] + period)
    between = 0.5 * (ahead + zones.b[: len(ahead)])
    between = between[(between > forcing.within[0]) & (between < forcing.within[1])]
    # A single zone needs no values outside the zone. If the right side is a steep power, the values
    # outside may be many decades larger than those at the ends.
    heights = np.asarray(
        forcing.primitive(ends if len(zones) == 1 else np.concatenate((ends, between)))
    )
    sampled_ends = ends[:: max(1, len(ends) // SAMPLES.samples)]
    near = sampled_ends[:, None] + 4 * np.spacing(np.abs(sampled_ends))[:, None] * np.arange(-4, 5)
    bend = 0.5 * np.abs(
        np.diff(np.asarray(forcing.primitive(near.ravel())).reshape(near.shape), 2, axis=1)
    )
    finite = heights[np.isfinite(heights)]
    return float(
        np.hypot(
            EPS * np.ptp(finite) if len(finite) else 0.0, _root_mean_square(bend[np.isfinite(bend)])
        )
    )


def _root_mean_square(values: Array) -> float:
    return (
        float(root_of_squares(np.full((1, len(values)), len(values) ** -0.5), values)[0])
        if len(values)
        else 0.0
    )
