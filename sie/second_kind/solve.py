"""Solve kappa phi + T phi = g on given zones, with as many modes as it needs.

A few unknowns are solved for by the LU factors of a matrix, many by fast sums and GMRES.
"""

from dataclasses import replace

import numpy as np

from sie.basis.data import Array, Index, root_of_squares, widened
from sie.basis.zones import Zones
from sie.dense import modes
from sie.dense.system import Layout, condition_rows
from sie.equation.equation import Equation
from sie.second_kind import many_levels
from sie.second_kind.jumps import known_parts
from sie.second_kind.many import ManyRows, ManySolver, unfit
from sie.second_kind.many_state import ManyState
from sie.second_kind.state import OPTIONS, SecondKindState, density_of
from sie.second_kind.system import SecondKindRows
from sie.states.sizes import Sizes, first_sizes
from sie.states.solve import OPTIONS as SOLVE
from sie.states.solve import SingularSystem, TooLarge, regular_factors


def solve_second_kind(
    equation: Equation, zones: Zones, tolerance: float, sizes: Sizes | None
) -> SecondKindState:
    """Solve an equation with kappa on given zones, with as many modes as it needs.

    tolerance: size that the last coefficients may have, relative to the largest coefficient; sizes:
    numbers of modes to start from. Raises ValueError for equations that cannot be solved with
    kappa, and SingularSystem if the linear system is singular or not finite.
    """
    if zones.symmetric:
        raise ValueError("an equation with kappa has no mirror symmetry: leave out symmetric=True")
    sizes = first_sizes(equation, zones, tolerance) if sizes is None else sizes
    least = np.maximum(sizes.least, OPTIONS.first_modes)
    m = modes.coupled(zones, equation.kernel, tolerance, least)
    # Moving ends with prescribed intensities need derivatives by the ends, which are finite
    # differences of two solutions for each end.
    solves = int(zones.moves.sum()) if zones.follow_ends else 1
    if zones.follow_ends and solves * np.sum(m + 1) > 4 * OPTIONS.max_unknowns:
        raise TooLarge(
            f"{solves} free ends with prescribed intensities and {int(np.sum(m + 1))} unknowns are "
            "too many for an equation with kappa"
        )
    state: SecondKindState | None = None
    while True:
        state = _solve_once(equation, zones, m, sizes, state)
        sizes.growth = (
            modes.Growth.first(m, state.tails)
            if sizes.growth is None
            else sizes.growth.after(m, state.tails, np.zeros_like(m))
        )
        least_tail = max(tolerance, 10 * sizes.linear) if state.iterated else tolerance
        enough = np.maximum(least_tail, sizes.growth.floor)
        few = (state.tails > enough) & (m < modes.COUPLED_SIZES[-1])
        wanted = np.minimum(OPTIONS.growth * m, modes.COUPLED_SIZES[-1])
        more = modes.COUPLED_SIZES[np.searchsorted(modes.COUPLED_SIZES, wanted)]
        m = np.where(few, more, m)
        sizes.least = state.system.layout.m
        hopeless = zones.moves.any() and state.unresolved
        too_many = solves * np.sum(m + 1) > OPTIONS.max_unknowns and not state.iterated
        if hopeless or too_many or not few.any():
            return state


def solve_moved(state: SecondKindState, outward: Array) -> SecondKindState:
    """The solution on zones whose ends are moved outward by `outward` (2, Z).
    The numbers of modes do not change.
    """
    zones, m = state.density.zones.moved(outward), state.system.layout.m
    return _solve_once(state.equation, zones, m, state.sizes, None)


def _solve_once(
    equation: Equation, zones: Zones, m: Index, sizes: Sizes, fewer: SecondKindState | None
) -> SecondKindState:
    """The solution with m modes on each zone; `fewer`: a solution with fewer modes, or None."""
    layout = Layout(m, len(equation.columns))
    parts = known_parts(equation.forcing, zones, equation.kernel.period)
    system = SecondKindRows(equation, zones, layout, parts)
    lacking: str | None = "fast sums need more unknowns"
    if layout.size > SOLVE.min_fast_unknowns:
        by_levels = any(condition.levels for condition in equation.conditions)
        lacking = (many_levels.unfit if by_levels else unfit)(equation, zones)
    if lacking is None:
        return _solve_iterated(system, sizes, fewer if isinstance(fewer, ManyState) else None)
    if layout.size > SOLVE.max_matrix_unknowns:
        raise TooLarge(
            f"{len(zones)} zones with {layout.size} unknowns are too many for a matrix, and "
            f"{lacking}"
        )
    matrix, right = system.rows()
    rows, values = condition_rows(equation, system, layout.size)
    scale = np.abs(rows).max(axis=1, initial=0.0)
    if np.any(scale == 0):
        raise SingularSystem("a side condition does not depend on the density")
    matrix = np.concatenate((matrix, rows / scale[:, None]))
    right = np.concatenate((right, values / scale))
    if not (np.all(np.isfinite(matrix)) and np.all(np.isfinite(right))):
        raise SingularSystem(
            "the right side, a column, the kernel or a side condition is not finite on the zones"
        )
    solver = regular_factors(equation, matrix)
    y = solver(right)
    terms = np.hypot(root_of_squares(matrix, y), np.abs(right))
    last = matrix[:, layout.offset + m].copy()
    # The columns `last` estimate the effect of truncated coefficients, which cause no error in the
    # rows of their own zone.
    last[np.arange(int(m.sum())), np.repeat(np.arange(len(m)), m)] = 0.0
    solver = replace(solver, size_of_rows=terms, last=last)
    sizes.solves += 1
    sizes.profile_evaluations += int(m.sum())
    sizes.kernel_evaluations += matrix.size
    return SecondKindState(density_of(system, y), system, solver, y, scale, sizes)


def _solve_iterated(system: SecondKindRows, sizes: Sizes, last: ManyState | None) -> ManyState:
    """The solution by fast sums and GMRES; `last`: the solution with fewer modes, if any."""
    solver, values, scale = _iteration(system, sizes, last)
    rows = solver.rows
    right = np.concatenate((rows.right, values))
    if not np.all(np.isfinite(right)):
        raise SingularSystem("the right side or a side condition is not finite on the zones")
    guess = None
    if last is not None:
        table = widened(last.density.coefficients, system.layout.given.shape[1])
        guess = np.concatenate((table[system.layout.given], last.density.amplitudes))
    y = solver(right, guess=guess)
    if not np.all(np.isfinite(y)):
        raise SingularSystem(
            "the iteration that solves many zones gives values that are not finite"
        )
    sizes.solves += 1
    sizes.profile_evaluations += len(rows.others)
    sizes.iterations += solver.iterations
    sizes.kernel_evaluations += solver.iterations * rows.sums.size
    solver.tolerance = 0.0
    return ManyState(density_of(system, y), system, solver, y, scale, sizes)


def _iteration(
    system: SecondKindRows, sizes: Sizes, last: ManyState | None
) -> tuple[ManySolver, Array, Array]:
    """(solver by fast sums, values of the conditions divided by their scales, the scales)."""
    far = None if last is None else last.solver.rows.sums.far
    if any(condition.levels for condition in system.equation.conditions):
        rows = many_levels.LevelRows.of(system, far)
        values = rows.condition_values(sizes.value)
        return many_levels.LevelSolver(rows, sizes.linear), values, np.ones(len(values))
    plain = ManyRows.of(system, far)
    return ManySolver(plain, sizes.linear), *plain.conditions()
