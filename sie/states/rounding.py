"""Effect of rounding and truncation of the rows on the density and on the intensities at the ends.

Each row of A y = b is rounded by the root of the sum of its terms' squares, because roundings are
independent of each other. The intensities are linear in the unknowns, K = C y, so one solve for X =
A^-T C^T gives the effect of every row on every K. Levels are differences of large potentials and
heights, and have the rounding of these. So a lightly loaded zone between heavy ones is affected by
the rounding of all heights.
"""

from dataclasses import dataclass

import numpy as np

from sie.basis.chebyshev import bounded_part
from sie.basis.data import Array, Index, by_rows, root_of_squares
from sie.basis.interval import edge_scale
from sie.basis.zones import Zones
from sie.dense.lu import Factored
from sie.dense.modes import conformal_radius, gaps
from sie.equation.conditions import speaks_of_levels
from sie.equation.equation import Forcing
from sie.states.base import Solved

EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class RoundingOptions:
    """Options of the random errors of rows."""

    # The largest of some hundred rounding errors is about four times their root mean square.
    safety: float = 4.0
    # Relative tolerance of the iterative answer to random errors. A looser one would miss the few
    # motions that nearly dependent conditions enlarge.
    solution: float = 1e-2
    # Samples of random errors: the estimate is below a quarter of the true size once in a hundred
    # times.
    samples: int = 4
    # Angles of each zone at which the density is evaluated.
    angles: int = 24
    # Distance from an end, over the half width, within which singular parts are left out.
    end_distance: float = 0.03
    # Ends at which the rounding of the primitive is measured.
    primitive_samples: int = 32


OPTIONS = RoundingOptions()


def intensity_rounding(state: Solved) -> Array:
    """Rounding of K at the left and right end of each zone, (2, Z)."""
    density, system = state.density, state.system
    zones = density.zones
    # Rounding acts on what is subtracted, the right side and the fields, however small the rest is.
    subtracted = (
        sum(
            by_rows(lambda rows: np.abs(rows).sum(axis=1), table)
            for table in (density.coefficients, system.g)
        )
        + state.natural
    )
    own = 4e-16 * edge_scale(zones.half) * subtracted
    if state.direct is None:
        own = (
            own
            + _of_levels(state)
            + np.sqrt(2 * zones.half) * state.linear_error
            + _of_others(state)
        )
    if state.direct is None or _stands_alone(state):
        return np.array([own, own])
    return np.asarray(own + OPTIONS.safety * _through_rows(state))


def _stands_alone(state: Solved) -> bool:
    """Whether one zone is given by its own rows and its total.

    Then nothing else is unknown, and nothing acts on it from outside, as images of itself may.
    """
    equation = state.system.equation
    kernel = equation.kernel
    plain = kernel.poles == (0.0,) and kernel.period is None and kernel.regular is None
    return len(state.density.zones) == 1 and plain and not equation.columns


def _of_others(state: Solved) -> Array | float:
    """Effect on K (Z,) of the rounding of the jumps' parts in other zones.

    It is sampled by the field of one random density of that size. Narrow zones are affected by a
    wide one with many knots, whose parts are much larger than their sum.
    """
    system, zones = state.system, state.density.zones
    layout, rounding = system.layout, system.jumps.rounding(len(zones))
    if system.equation.forcing.value_jumps:
        # The effect of these on others is computed from the right side itself.
        rounding[system.by_moments] = 0.0
    if not rounding.any():
        return 0.0
    order = np.arange(layout.coefficients) - np.repeat(layout.offset, layout.m + 1)
    shaken = np.zeros(layout.size)
    # Totals are given; the first of the other coefficients differ most.
    shaken[: layout.coefficients] = np.where(
        order > 0, np.repeat(rounding, layout.m + 1) / (1 + order), 0.0
    )
    shaken[: layout.coefficients] *= np.random.default_rng(0).standard_normal(layout.coefficients)
    out = np.zeros(len(zones))
    assert state.iteration is not None
    out[zones.solved] = state.iteration.system.felt(shaken)
    out = np.maximum(out, out[::-1]) if zones.symmetric else out
    return np.asarray(OPTIONS.safety * edge_scale(zones.half) * out)


def _of_levels(state: Solved) -> Array | float:
    """Effect on K of the rounding of the potentials that determine the zones' totals (Z,)."""
    equation, zones = state.system.equation, state.density.zones
    if len(zones) == 1 or not any(speaks_of_levels(c, zones) for c in equation.conditions):
        return 0.0
    w = zones.half
    # An error e of a level is met by c_0 = e / (w log(w / 2R)), and K by that over sqrt(2 w).
    # Neighbours that are no wider hold less of it than a plane would.
    radius = conformal_radius(*(gap + w for gap in gaps(zones, equation.kernel)))
    logarithm = np.maximum(np.log(0.5 * np.minimum(radius, equation.kernel.datum) / w), 1.0)
    return np.asarray(2 * _level_noise(state) / (logarithm * np.sqrt(2 * w)))


def _through_rows(state: Solved) -> Array:
    """Root mean square of the effect of the rounding of all rows on each K, (2, Z)."""
    solver = state.direct
    assert solver is not None
    effect = _effect_on_intensities(state, solver)
    rounding, levels = _of_rows(state, solver)
    of_levels = state.level_rows.T @ effect[state.conditions_from :]
    both = np.hypot(root_of_squares(effect.T, rounding), root_of_squares(of_levels.T, levels))
    return _of_solved(state, both.reshape(2, -1))


def _effect_on_intensities(state: Solved, solver: Factored) -> Array:
    """Derivatives of K at the left, then right ends of the solved zones by the rows (rows, 2
    zones).
    """
    (left, _), (right, _) = state.system.intensities()
    return solver.transposed(state.symmetry.fold(np.concatenate((left, right))).T)


def _of_solved(state: Solved, values: Array) -> Array:
    """Values at the ends of the solved zones (2, n) spread to all zones (2, Z)."""
    zones = state.system.zones
    out = np.zeros((2, len(zones)))
    out[:, zones.solved] = values
    return np.maximum(out, out[::-1, ::-1]) if zones.symmetric else out


def truncation_through_rows(state: Solved, missing: Array, low: Array) -> Array:
    """Effect of the truncation of all rows on K at both ends of each zone (2, Z); see
    `_row_truncation`.
    """
    solver = state.direct
    if solver is None:
        padded = state.system.layout.padded
        changes = [
            np.abs(padded(one)).sum(axis=1) for one in _iterated_changes(state, missing, low)
        ]
        return np.asarray(
            edge_scale(state.density.zones.half) * np.max(changes, axis=0) * np.ones((2, 1))
        )
    if _stands_alone(state):
        return np.zeros((2, len(state.density.zones)))
    effect = np.abs(_effect_on_intensities(state, solver))
    return _of_solved(state, (_row_truncation(state, solver, missing, low) @ effect).reshape(2, -1))


def _row_truncation(state: Solved, solver: Factored, missing: Array, low: Array) -> Array:
    """Error of each row by truncation: by the coefficients that zones lack, and the lowest
    residuals.

    missing: sum of these coefficients (Z,); low: of the residual on the solved zones (solved
    zones, modes). Coefficients beyond the last one act on the rows as the last one does, or
    less. Conditions may carry their effect to other zones and enlarge it: K = 0 at an end next
    to a strong zone, for example, determines the total of a distant one.
    """
    system = state.system
    layout, solved = system.layout, system.zones.solved
    out = np.abs(solver.last) @ np.where(layout.m[solved] > 0, missing[solved], 0.0)
    some, of_low = _low_rows(state, low)
    out[some] += of_low
    return np.asarray(out)


def _iterated_changes(state: Solved, missing: Array, low: Array) -> list[Array]:
    """Answers to `OPTIONS.samples` random errors of the rows, as unknowns, by iteration.

    The errors of the rows are those of `_row_truncation`, the rounding of their terms, and what the
    iteration has left of the totals. Each row has a random sign of its own. With one sign for each
    unknown, the answer would be these unknowns, and nothing elsewhere.
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
        changes.append(symmetry.unfold(iteration(right, None, OPTIONS.solution)))
    iteration.error, iteration.random_changes = stated, (asked, changes)
    return changes


def _low_rows(state: Solved, low: Array) -> tuple[Index, Array]:
    """(indices of the rows of the lowest modes, their errors by the residual): see
    `_row_truncation`.
    """
    layout, solved = state.system.layout, state.system.zones.solved
    rows = state.system.diagonal
    zone = np.searchsorted(layout.offset, rows, side="right") - 1
    mode = rows - layout.offset[zone] - 1
    some = np.flatnonzero(mode < low.shape[1])
    return some, np.asarray(low[np.searchsorted(solved, zone[some]), mode[some]])


def _of_rows(state: Solved, solver: Factored) -> tuple[Array, Array]:
    """(rounding of the rows without levels, rounding of the levels of the solved zones)."""
    rounding, of_levels = EPS * solver.size_of_rows, state.level_rows.any(axis=1)
    rounding[state.conditions_from :][of_levels] = 0.0
    count = len(state.density.zones.solved)
    return rounding, np.broadcast_to(
        _level_noise(state), (count,)
    ) if of_levels.any() else np.zeros(count)


def density_rounding(state: Solved, missing: Array, low: Array) -> Array:
    """Effect of truncation and rounding of all rows on the density of each zone (Z,).

    The singularities are taken out of the density. Where conditions nearly depend on each other,
    the effect is many times the errors of the rows. So the rows are changed at random, always by
    the same numbers, and the change of the density is measured. missing, low: see
    `_row_truncation`.
    """
    zones, solver = state.density.zones, state.direct
    if _stands_alone(state):
        return np.zeros(len(zones))
    if solver is None:
        return _of_levels(state) / edge_scale(zones.half) + density_changes(
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
    """Size of a random change of the density on each zone (Z,), from samples of unknowns."""
    largest = _largest(
        np.concatenate([state.system.layout.padded(one) for one in unknowns])
    ).reshape(len(unknowns), -1)
    return np.asarray(
        OPTIONS.safety * root_of_squares(largest.T, np.full(len(unknowns), len(unknowns) ** -0.5))
    )


def _largest(coefficients: Array) -> Array:
    """Largest value on each zone of sum c_k T_k / sqrt(1 - t^2), and of its bounded part, at a few
    angles.

    Places closer to the ends than OPTIONS.end_distance do not count.
    """
    k = np.arange(max(coefficients.shape[1], 2))
    # The angles are denser next to the ends, where high modes add up.
    theta = np.pi * np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, OPTIONS.angles)[:, None]) ** 2
    u = bounded_part(coefficients)[2]
    whole = (
        coefficients
        @ np.cos(theta * k[: coefficients.shape[1]]).T
        / np.maximum(np.sin(theta), np.sqrt(2 * OPTIONS.end_distance)).T
    )
    bounded = u @ np.sin(theta * k[1 : u.shape[1] + 1]).T
    return np.asarray(np.maximum(np.abs(whole).max(axis=1), np.abs(bounded).max(axis=1)))


def _level_noise(state: Solved) -> Array:
    """Root mean square of the rounding of the zones' levels, by potentials and by heights."""
    sizes, forcing = state.sizes, state.system.equation.forcing
    if state.system.integrated:
        return np.asarray(state.system.level_rounding(state.unknowns))
    if sizes.primitive_rounding is None:
        sizes.primitive_rounding = primitive_rounding(
            forcing, state.system.zones, state.density.kernel.period
        )
    return np.hypot(state.system.level_rounding(state.unknowns), sizes.primitive_rounding)


def primitive_rounding(forcing: Forcing, zones: Zones, period: float | None) -> float:
    """Rounding of the values of the primitive.

    As data they are rounded to a part of their rise between the zones. In evaluation the rounding
    is the deviation from straight lines over a few units in the last digit.
    """
    assert forcing.primitive is not None
    ends = np.unique(np.concatenate((zones.a, zones.b)))
    ahead = zones.a[1:] if period is None else np.append(zones.a[1:], zones.a[0] + period)
    between = 0.5 * (ahead + zones.b[: len(ahead)])
    between = between[(between > forcing.within[0]) & (between < forcing.within[1])]
    # A zone alone does not depend on heights next to it, which for steep powers are many decades
    # larger.
    heights = np.asarray(
        forcing.primitive(ends if len(zones) == 1 else np.concatenate((ends, between)))
    )
    look = ends[:: max(1, len(ends) // OPTIONS.primitive_samples)]
    near = look[:, None] + 4 * np.spacing(np.abs(look))[:, None] * np.arange(-4, 5)
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
