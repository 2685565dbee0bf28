"""Solve the equation on given zones: choose the modes, sample, assemble, solve.

A few unknowns are solved for by the LU factors of a matrix, many by fast sums and GMRES
(`sie.fast`).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import lapack

from sie.basis import chebyshev
from sie.basis.data import EPS, Array, Index, root_of_squares
from sie.basis.zones import Zones
from sie.dense import modes
from sie.dense.lu import Factored
from sie.dense.system import System, condition_rows
from sie.equation.checks import check_functions
from sie.equation.equation import Equation
from sie.fast.coarse import CoarseOperator
from sie.fast.iteration import Iterative
from sie.fast.system import IterativeSystem, unfit
from sie.jumps.right_side import ForcingJumps
from sie.states.base import Solver, coefficient_sizes, density_of
from sie.states.sizes import Carried, Sizes, first_sizes
from sie.states.state import State, field_tails


@dataclass(frozen=True)
class SolveOptions:
    """Numbers of unknowns from which fast sums are used, and up to which a matrix is allowed."""

    # From this number of unknowns on, fast sums cost less than a matrix (measured on one core).
    min_fast_unknowns: int = 600
    # Largest number of unknowns for which a matrix is used. This matrix and its LU factors need
    # more than six gigabytes of memory.
    max_matrix_unknowns: int = 20_000


OPTIONS = SolveOptions()


class SingularSystem(ArithmeticError):
    """The linear system has no unique solution.
    For example, side conditions depend on each other.

    Examples
    --------
    >>> import numpy as np, sie
    >>> same = sie.Total(1.0), sie.Weighted(np.ones_like, 1.0)
    >>> twice = sie.Equation(sie.cauchy(), sie.Forcing(np.sin), same)
    >>> try:
    ...     sie.solve_fixed(twice, sie.Zones.of([[-2, -1], [1, 2]], sie.SINGULAR, sie.SINGULAR))
    ... except sie.SingularSystem as error:
    ...     print(error)
    the system is singular: the side conditions depend on each other
    """


class TooLarge(SingularSystem):
    """There are too many unknowns for a matrix, and fast sums do not apply to this equation."""


def solve_fixed(
    equation: Equation,
    zones: Zones,
    tolerance: float = 1e-14,
    sizes: Sizes | None = None,
    largest: int | None = None,
    direct: bool = False,
) -> State:
    """Solve the equation on given zones; the density may be singular at all ends.

    A Newton step of the free ends uses the intensities at these ends.

    Parameters
    ----------
    equation : Equation
    zones : Zones
        The zones; free ends are not moved.
    tolerance : float
        Truncation tolerance of the coefficients, relative to the largest.
    sizes : Sizes or None
        Numbers of modes to start from, kept from one solve to the next.
    largest : int or None
        Largest number of modes of a zone. None: 8191, or up to 32767 if there are few zones and
        their coefficients have nearly decayed by then.
    direct : bool
        Whether to use a matrix for any number of unknowns up to `max_matrix_unknowns`. This pays
        off if many right sides follow.

    Returns
    -------
    State
        The density, with the data for its error estimate.

    Raises
    ------
    ValueError
        If a function contradicts its declaration (see `check_functions`); `CountError` if the
        numbers of conditions and unknowns do not match.
    SingularSystem
        If the side conditions depend on each other, or something is not finite.

    Examples
    --------
    >>> import numpy as np, sie
    >>> punch = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (sie.Total(np.pi),))
    >>> zones = sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR)
    >>> float(sie.solve_fixed(punch, zones).density(0.6).round(12))
    1.25
    """
    equation.check_count(zones)
    if equation.second_kind:
        raise ValueError("solve_fixed needs kappa = 0; for other kappa call sie.solve_zones")
    if sizes is None:
        sizes = first_sizes(equation, zones, tolerance)
    if sizes.solves == 0:
        check_functions(equation, zones)
    kernel = equation.kernel
    jumps = equation.forcing.jumps_within(zones, kernel)
    samples = modes.sample(
        equation.forcing,
        zones,
        jumps,
        sizes.own,
        tolerance,
        modes.most_own(zones) if largest is None else largest,
    )
    sizes.own = samples.own
    sizes.profile_evaluations += samples.evaluations
    while True:
        m = modes.coupled(zones, kernel, tolerance, sizes.least)
        unknowns = int(np.sum(m + 1))
        lacking = (
            "this calculation needs a matrix"
            if direct
            else unfit(equation, zones)
            if unknowns > OPTIONS.min_fast_unknowns
            else "fast sums need more unknowns"
        )
        if lacking and unknowns > OPTIONS.max_matrix_unknowns:
            raise TooLarge(
                f"{len(zones)} zones with {unknowns} unknowns are too many for a matrix, and "
                f"{lacking}"
            )
        state = (_solve_once if lacking else _solve_iterated)(
            equation, zones, m, samples, jumps, sizes
        )
        more = more_modes(state, state.tails, tolerance)
        if more is None:
            return state
        sizes.least = more


def more_modes(state: State, tails: Array, tolerance: float) -> Index | None:
    """Number of modes of each zone for the next solution; None if the present numbers suffice.
    Only modes whose coefficients are unknowns of the linear system for all zones are counted. Each
    zone gets its own number, since it would cost too much to give all zones as many as the worst
    one. A zone gets no more modes if its last coefficients (`tails`) are below the error of an
    iteration.
    """
    m, zones, panels = state.system.layout.m, state.system.zones, state.system.panels
    kernel, sizes = state.equation.kernel, state.sizes
    sizes.growth = (
        modes.Growth.first(m, tails)
        if sizes.growth is None
        else sizes.growth.after(m, tails, sizes.own)
    )
    enough = max(modes.enough(kernel, tolerance), 10 * sizes.linear if state.iterated else 0.0)
    few = (tails > np.maximum(enough, sizes.growth.floor)) & (m < modes.most(kernel))
    if panels is not None and not any(
        column.resolution.modes is None for column in state.equation.columns
    ):
        # `panels.modes` is the number of modes that resolve the kernel's regular part on a zone to
        # round-off. A zone that has this many modes gets no more.
        few &= m < panels.modes(zones.half)
    if not state.equation.grows or not few.any():
        return None
    return np.where(
        few, modes.COUPLED_SIZES[np.searchsorted(modes.COUPLED_SIZES[:-1], m, side="right")], m
    )


def _solve_once(
    equation: Equation,
    zones: Zones,
    m: Index,
    samples: modes.Samples,
    jumps: ForcingJumps,
    sizes: Sizes,
) -> State:
    system = System(equation, zones, m, samples.coefficients, jumps)
    matrix, right, scale = _rows(equation, system)
    if not all(np.all(np.isfinite(part)) for part in (samples.coefficients, right, matrix)):
        raise SingularSystem(_not_finite(equation, system))
    solver = regular_factors(equation, matrix)
    folded = solver(right)
    terms = np.hypot(root_of_squares(matrix, folded), right)
    last = matrix[:, system.last_unknowns]
    solver = replace(
        solver,
        size_of_rows=_size_of_rows(system, terms),
        last=last,
        rows=matrix if zones.follow_ends else None,
    )
    sizes.kernel_evaluations += matrix.size
    return _state(system, solver, folded, scale, samples, sizes)


def regular_factors(equation: Equation, matrix: Array) -> Factored:
    """The LU factors of a matrix whose rows are of size one; `SingularSystem` if it is singular."""
    solver = Factored.of(matrix)
    # The rows of the side conditions have been divided by their sizes. So a reciprocal condition
    # number below 4 `EPS` is zero within round-off.
    singular = 4 * EPS
    condition = _condition(solver, matrix)
    if condition < singular and _condition(Factored.of(rows := _even(matrix)), rows) < singular:
        raise SingularSystem(_singular(equation))
    return replace(solver, reciprocal_condition=condition)


def _condition(solver: Factored, matrix: Array) -> float:
    """Estimate of the reciprocal condition number of a matrix, from its LU factors."""
    estimate = lapack.zgecon if np.iscomplexobj(solver.lu) else lapack.dgecon
    found = (
        estimate(solver.lu, np.abs(matrix).sum(axis=0).max(initial=0.0))[0]
        if np.isfinite(solver.lu).all()
        else 0.0
    )
    return float(found)


def _even(matrix: Array) -> Array:
    """The matrix, equilibrated: each row, then each column, is divided by its largest entry.

    Kernels and columns of very different sizes would otherwise make a regular matrix look singular.
    """
    for axis in (1, 0):
        largest = np.abs(matrix).max(axis=axis, keepdims=True)
        matrix = matrix / np.where(largest > 0, largest, 1.0)
    return matrix


def _singular(equation: Equation) -> str:
    """Message that explains why the linear system of an equation is singular.

    If the kernel has poles alone, only side conditions can make it singular.
    """
    if equation.kernel.grows or not equation.conditions:
        return (
            "the system is singular: some density other than zero contributes neither to the "
            "equation nor to the side conditions"
        )
    return "the system is singular: the side conditions depend on each other"


def _not_finite(equation: Equation, system: System) -> str:
    """Message that says which function of an equation is not finite on the zones, and where."""
    zones = system.zones
    # About as many Chebyshev nodes as the right side has coefficients are added on each zone. They
    # are similar to the nodes at which the right side was sampled.
    t = chebyshev.lobatto(max(16, system.g.shape[1] - 1))[0][1:-1]
    more = (zones.middle[:, None] + zones.half[:, None] * t).ravel()
    return not_finite(equation, np.concatenate((system.targets.x, more)))


def not_finite(equation: Equation, x: Array) -> str:
    """Message that says which function of an equation is not finite at places x, and where."""
    for name, part in (
        ("the right side", equation.forcing),
        *((f"column {k}", c) for k, c in enumerate(equation.columns)),
    ):
        wrong = ~np.isfinite(np.asarray(part.value(x), dtype=float))
        if wrong.any():
            return f"{name} is not finite on the zones, for example at x = {x[wrong][0]:.6g}"
    return (
        "the kernel's regular part, a primitive or a side condition is not finite on the zones, or "
        "numbers overflow"
    )


def _size_of_rows(system: System, terms: Array) -> Array:
    """Size of the terms of each row of the linear system; the row's round-off is relative to it.

    The rows of the equation come from values at nodes. Each has the round-off of these values,
    however small the row itself is, as in the highest modes. terms: root of the sum of squares of
    the terms of each row.
    """
    rows = system.diagonal
    zone = np.searchsorted(system.layout.offset, rows, side="right") - 1
    count = np.maximum(np.bincount(zone, minlength=len(system.zones)), 1)
    unit = max(float(terms.max(initial=0.0)), 1e-300)
    squares = (terms / unit) ** 2
    squares[: len(rows)] += (
        np.bincount(zone, squares[: len(rows)], minlength=len(system.zones)) / count
    )[zone]
    return np.asarray(unit * np.sqrt(squares))


def _solve_iterated(
    equation: Equation,
    zones: Zones,
    m: Index,
    samples: modes.Samples,
    jumps: ForcingJumps,
    sizes: Sizes,
) -> State:
    """The solution by fast sums and GMRES.

    It starts from the last solution if there is one.
    """
    system = IterativeSystem(equation, zones, m, samples.coefficients, jumps, sizes.rough)
    carried = (
        sizes.carried
        if sizes.carried is not None and len(sizes.carried.amplitudes) == system.layout.columns
        else None
    )
    coarse = sizes.coarse
    if system.levelled and (coarse is None or not coarse.serves(system)):
        coarse = sizes.coarse = CoarseOperator(zones, system)
    solver = Iterative(system, coarse, sizes.linear, sizes.value)
    right = solver.right()
    if not (np.all(np.isfinite(samples.coefficients)) and np.all(np.isfinite(right))):
        raise SingularSystem(_not_finite(equation, system))
    near = None if carried is None else carried.near(system)
    folded = near if near is not None and sizes.start else solver(right, near)
    if not np.all(np.isfinite(folded)):
        raise SingularSystem(_singular(equation))
    sizes.iterations += solver.iterations
    sizes.kernel_evaluations += solver.iterations * system.sums.size
    solver.tolerance = 0.0
    state = _state(system, solver, folded, np.ones(solver.size - solver.equations), samples, sizes)
    sizes.carried = Carried.of(system, state.unknowns, {})
    return state


def _state(
    system: System,
    solver: Solver,
    folded: Array,
    scale: Array,
    samples: modes.Samples,
    sizes: Sizes,
) -> State:
    y = system.symmetry.unfold(folded)
    density = density_of(system, y)
    sizes.solves += 1
    top = coefficient_sizes(density, 1)
    truncation = samples.tail / np.where(top > 0, top, 1.0)
    tail = np.maximum(field_tails(system, y, density), system.source_tails)
    if system.zones.symmetric:
        tail = np.maximum(tail, tail[::-1])
    left_over = solver.error if isinstance(solver, Iterative) else np.zeros(len(system.zones))
    return State(
        density,
        system,
        solver,
        y,
        folded,
        solver.size - len(scale),
        scale,
        truncation,
        tail,
        left_over,
        sizes,
    )


def rows_of(state: State) -> Array:
    """The matrix of the linear system of a solution, with a column for each unknown solved for."""
    direct = state.direct
    return (
        direct.rows
        if direct is not None and direct.rows is not None
        else _rows(state.equation, state.system, state.condition_scale)[0]
    )


def _rows(
    equation: Equation, system: System, scale: Array | None = None
) -> tuple[Array, Array, Array]:
    """(matrix of the linear system, its right side, scales of the side conditions).
    The matrix has a column for each unknown that is solved for.

    The rows of the side conditions are divided by their scales, so that all are of size one.
    """
    matrix, right = system.equation_rows()
    rows, values = condition_rows(equation, system, system.layout.size)
    if scale is None:
        scale = np.abs(rows).max(axis=1, initial=0.0)
        if np.any(scale == 0):
            raise SingularSystem("a side condition does not depend on the density")
    matrix = system.symmetry.fold(np.concatenate((matrix, rows / scale[:, None])))
    return matrix, np.concatenate((right, values / scale)), scale
