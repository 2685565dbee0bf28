"""`solve`: one call for fixed and free ends, with a stated error or a reason for failure."""

import copy
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sie import reasons
from sie.basis import inputs
from sie.basis.data import EPS, Array
from sie.basis.kernels import Regular, Smooth
from sie.basis.zones import Zones
from sie.dense import modes
from sie.ends.newton import Free, find_ends
from sie.ends.options import NewtonOptions, WarmStart
from sie.equation.equation import Equation
from sie.equation.forcing import Forcing, Function
from sie.graded.state import GradedState
from sie.results import figure, pickling
from sie.results.capacity import capacity_of
from sie.results.derivative import Change, Derivative, Linearized, without_slits
from sie.results.graded_derivative import GradedLinearized
from sie.results.gradient import Adjoint, Functional, Gradient
from sie.results.report import Report
from sie.results.second_kind_derivative import SecondKindLinearized
from sie.second_kind.state import SecondKindState
from sie.slits.system import AnyDensity, AnyState, solve_zones
from sie.states.solve import SingularSystem


@dataclass(frozen=True)
class SolveOptions:
    """Tolerances of the coefficients and of the ends, relative to the solution's tolerance."""

    # Tolerances of free ends, as fractions of the tolerance `tol` of the solution. They are tried
    # in turn until the stated error is at most `tol`. If all ends are fixed, the first number gives
    # the first tolerance of the coefficients.
    parts: tuple[float, ...] = (0.1, 1e-3, 1e-5)


OPTIONS = SolveOptions()


@dataclass(frozen=True, eq=False)
class Solution:
    """The solution found by `solve`, with its stated errors.

    Parameters
    ----------
    density : Density, SlitDensity, GradedDensity or SecondKindDensity
        The unknown function phi; call it at points of the line, see `Density`.
    zones : Zones
        The n zones, with the converged free ends; `zones.table` is the (n, 2) array of ends.
    error : float
        Bound of two relative errors: (i) the density's error times sqrt(1 - t^2), at equal
        normalised position t in its zone, divided by the density's largest coefficient; (ii) each
        free end's error divided by its zone's width. Infinite if the ends have not converged.
    errors : ndarray
        The same bound for each zone (n,), but relative to the zone's own largest coefficient. An
        entry is larger than `error` if other zones have much larger densities.
    value : float or None
        The value found for the side condition of unknown value, if there is one.
    state : State
        The last solved state: levels, responses to changed side conditions, and parts of the error.
    search : Free or None
        The search for the ends, step by step; None if all ends were fixed.

    Examples
    --------
    >>> import sie
    >>> crack = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: 1 + 0 * x), (sie.Total(0.0),))
    >>> found = sie.solve(crack, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> float(found.density(0.6).round(12)), found.error < 1e-10
    (-0.75, True)
    """

    density: AnyDensity
    zones: Zones
    error: float
    value: float | None = None
    errors: Array = field(repr=False, kw_only=True)
    state: AnyState = field(repr=False, kw_only=True)
    search: Free | None = field(default=None, repr=False, kw_only=True)

    @property
    def amplitudes(self) -> Array:
        """Amplitudes (k,) of the columns `Equation.columns`, which the solution determines."""
        return self.density.amplitudes

    @property
    def levels(self) -> Array:
        """Mean over each zone (n,) of the density's potential minus the right side's primitive."""
        return self.state.levels

    def residual(self, x: ArrayLike) -> Array:
        """Left side minus right side of the equation at points of the zones.

        Parameters
        ----------
        x : array_like
            Points, of any shape. With a period they may lie in any period.

        Returns
        -------
        ndarray
            Of the shape of x; NaN off the zones.

        Examples
        --------
        >>> import numpy as np, sie
        >>> crack = sie.Equation(sie.cauchy(), np.exp, sie.Total(0.0))
        >>> found = sie.solve(crack, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
        >>> left_over = found.residual([-0.5, 0.3, 2.0])
        >>> bool(np.abs(left_over[:2]).max() < 1e-10), bool(np.isnan(left_over[2]))
        (True, True)
        """
        place, zone, inside = self.density.locate(x)
        out, at = np.full(place.shape, np.nan, dtype=self.zones.weight.numbers), place[inside]
        of_jumps = self.density.jumps.left_out(at)
        out[inside] = self.density.transform(at) - self.state.right_side(at) - of_jumps
        kappa = self.zones.weight.kappa
        if kappa is not None:
            out[inside] += kappa[zone[inside]] * self.density(at)
        return out

    def report(self) -> Report:
        """A report on the resolution of each zone and on the condition number of the system.

        Returns
        -------
        Report
            `print` shows it as a table.

        Examples
        --------
        >>> import sie
        >>> crack = sie.Equation(sie.cauchy(), lambda x: 1 + 0 * x, sie.ZoneTotals(0.0))
        >>> zones = sie.Zones.of([[-2, -1], [1, 2]], sie.SINGULAR, sie.SINGULAR)
        >>> report = sie.solve(crack, zones).report()
        >>> str(report).splitlines()[-1][:48]
        '26 unknowns, solved by LU factors of a matrix wi'
        """
        steps = None if self.search is None else len(self.search.trace)
        return Report.of(self.state, self.error, self.errors, steps)

    @property
    def capacity(self) -> float:
        """Logarithmic capacity of the zones, in their unit of length.

        The solution must have the right side zero and one potential on all zones: ends SINGULAR,
        and the conditions `Total(1.0)` and, for several zones, `EqualPotential()`. With Hilbert's
        kernel it is the capacity of the arcs that the zones form on a circle whose circumference is
        the period.

        Raises
        ------
        ValueError
            If the problem is not of this kind; the message says what differs.

        Examples
        --------
        The capacity of an interval is a quarter of its length.

        >>> import numpy as np, sie
        >>> plate = sie.Equation(sie.cauchy(), np.zeros_like, sie.Total(1.0))
        >>> found = sie.solve(plate, sie.Zones.of([[0.0, 2.0]], sie.SINGULAR, sie.SINGULAR))
        >>> round(found.capacity, 12)
        0.5
        """
        return capacity_of(self.state, self.error)

    def derivative(
        self,
        dg: Forcing | Function | None = None,
        *,
        values: Sequence[ArrayLike] | ArrayLike | None = None,
        dkernel: Smooth | Regular | None = None,
        dends: ArrayLike | None = None,
        dintensities: ArrayLike | None = None,
    ) -> Derivative:
        """Derivative of the solution by a parameter, from the derivatives of the problem's data.

        It is the exact derivative of the discrete problem. It takes one or a few solves with the LU
        factors of the solution. For a solution by iteration, each of these solves is an iteration.

        Parameters
        ----------
        dg : Forcing, callable or None
            Derivative of the right side by the parameter; a `Forcing` if potentials (primitive) or
            jumps need it. None: no change, as for the following parameters.
        values : sequence or None
            Derivatives of the values of the conditions, one entry for each condition (a number, or
            an array with its rows). Conditions on the ends come last.
        dkernel : Smooth, callable or None
            Derivative of the kernel, a smooth function of (x, xi).
        dends : array_like (n, 2) or None
            Derivatives of the positions of the fixed ends; zero for free ends.
        dintensities : array_like (2, n) or None
            Derivatives of the prescribed intensities; zero for singular ends.

        Returns
        -------
        Derivative
            `density` at fixed x, `ends`, `intensities`, `amplitudes` and `value`.

        Raises
        ------
        ValueError
            For wrong input, for functions that are not resolved, with kappa for other parameters
            than `dg` and `values`, and for gaps that are too narrow for a solution without slits.
            Narrow gaps beside fixed ends raise it only if `dends` or `dkernel` is given.
        SingularSystem
            If the ends, or the unknown value of a side condition, are not determined, as at a
            turning point of the load.

        Examples
        --------
        Griffith's crack [-a, a] under a unit traction has |K| = sqrt(a / 2), so that d|K|/da is
        1 / sqrt(8 a).

        >>> import numpy as np, sie
        >>> crack = sie.Equation(sie.cauchy(), np.ones_like, sie.Total(0.0))
        >>> found = sie.solve(crack, sie.Zones.of([[-2.0, 2.0]], sie.SINGULAR, sie.SINGULAR))
        >>> longer = found.derivative(dends=[[-1.0, 1.0]])
        >>> np.abs(longer.intensities).round(12).tolist()
        [[0.25], [0.25]]
        """
        with np.errstate(all="ignore"):
            if isinstance(self.state, SecondKindState):
                if any(one is not None for one in (dkernel, dends, dintensities)):
                    raise ValueError(
                        "with kappa the derivatives by dkernel, dends and dintensities are not "
                        "known: only those by dg and values"
                    )
                change = Change.of(self.state, dg, values)
                return SecondKindLinearized(self.state, change).derivative()
            if isinstance(self.state, GradedState) and dends is None and dkernel is None:
                change = Change.of(self.state, dg, values, dintensities=dintensities)
                return GradedLinearized(self.state, change).derivative()
            state = without_slits(self.state, self.value)
            change = Change.of(state, dg, values, dkernel, dends, dintensities)
            return Linearized(state, change).derivative()

    def gradient(
        self,
        weight: Function | None = None,
        *,
        intensities: ArrayLike | None = None,
        ends: ArrayLike | None = None,
    ) -> Gradient:
        """Derivatives of one functional of the solution by all data, from one adjoint solve.

        The functional is the integral of weight(x) times the density, plus sums of intensities K at
        singular ends and of positions of ends, with the given factors. A solution by iteration is
        computed once more with a matrix.

        Parameters
        ----------
        weight : callable or None
            weight(x), x (n,), smooth on each zone.
        intensities : array_like (2, n) or None
            Factors of the intensities; they must be zero except at singular ends.
        ends : array_like (n, 2) or None
            Factors of the positions of the ends.

        Returns
        -------
        Gradient
            `values`, `ends`, `intensities`; call it with a change of the right side.

        Raises
        ------
        ValueError
            For wrong input, for symmetric zones, and for too many unknowns for a matrix.
        SingularSystem
            If the ends, or the unknown value of a side condition, are not determined.

        Examples
        --------
        The right end a of a cylinder's contact has the derivative 1 / (pi a) by the load P.

        >>> import numpy as np, sie
        >>> hertz = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(np.pi / 2))
        >>> found = sie.solve(hertz, sie.Zones.of([[-0.9, 1.2]]))
        >>> by_data = found.gradient(ends=[[0.0, 1.0]])
        >>> float((np.pi * by_data.values[0][0]).round(9)), float(round(by_data(np.ones_like), 9))
        (1.0, -1.0)
        """
        with np.errstate(all="ignore"):
            state = without_slits(self.state, self.value, factors=True)
            functional = Functional.of(state, weight, intensities, ends)
            return Adjoint(state).gradient(functional)

    def plot(self, ax: Any = None) -> Any:
        """Draw the density over the zones, with matplotlib.

        Parameters
        ----------
        ax : matplotlib Axes or None
            Where to draw; None makes a new figure, without pyplot.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ImportError
            Without matplotlib.

        Examples
        --------
        >>> import sie
        >>> hertz = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(1.0))
        >>> figure = sie.solve(hertz, sie.Zones.of([[-1.0, 1.0]])).plot()
        >>> figure.axes[0].get_ylabel()
        'density'
        """
        return figure.draw(self.density, ax)

    def __getstate__(self) -> Any:
        pickling.check(self.state.equation)
        return super().__getstate__()  # type: ignore[misc]

    def __copy__(self) -> "Solution":
        return replace(self)

    def __deepcopy__(self, memo: dict[int, Any]) -> "Solution":
        # `__getstate__` is not called here, since it raises an error for functions that cannot be
        # pickled.
        return replace(
            self, **{one.name: copy.deepcopy(getattr(self, one.name), memo) for one in fields(self)}
        )


class NotConverged(ArithmeticError):
    """Raised if no solution to the wanted tolerance was found.

    Parameters
    ----------
    reason : str
        The reason, in words.
    best : Solution or None
        The best solution that was reached, with its own error; None if no system could be solved.

    Examples
    --------
    >>> import sie
    >>> hertz = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(1.0),))
    >>> try:
    ...     sie.solve(hertz, sie.Zones.of([[-1.0, 2.0]]), max_steps=1)
    ... except sie.NotConverged as stopped:
    ...     print(stopped.reason, stopped.best.zones.table.shape)
    the ends did not converge in 2 steps (1, 2)
    """

    def __init__(self, reason: str, best: Solution | None = None) -> None:
        super().__init__(reason)
        self.reason, self.best = reason, best


def solve(
    equation: Equation,
    zones: Zones,
    tol: float = 1e-10,
    *,
    value: float = 0.0,
    signs: tuple[float, float] = (1.0, 1.0),
    max_steps: int = 40,
) -> Solution:
    """Solve a singular integral equation on zones with fixed ends, free ends, or both.

    Parameters
    ----------
    equation : Equation
        Kernel, right side, side conditions.
    zones : Zones
        The zones with the kinds of their ends; where ends are free, a first guess of them.
    tol : float
        Tolerance of the stated error, 0 < tol < 1.
    value : float
        First guess for the value of the side condition whose value is unknown, if there is one.
    signs : (float, float)
        Signs of the wanted density close to free left and free right ends. With them Newton's
        method tells outward from inward motions if the ends are far from the solution.
    max_steps : int
        Largest number of Newton steps of the ends.

    Returns
    -------
    Solution
        `density`, `zones` and `error` <= tol.

    Raises
    ------
    ValueError
        For wrong input; the message says what is missing, too much or out of range. `CountError`, a
        ValueError, if side conditions and unknowns do not match.
    NotConverged
        With `reason` and `best`, if the error cannot be brought below tol.

    Examples
    --------
    Half a period of a wave touches: sin^2(pi a / L) = load / (amplitude L) (H. M. Westergaard, J.
    Appl. Mech. 6, 1939, A49).

    >>> import numpy as np, sie
    >>> wave = sie.Forcing(lambda x: np.sin(2 * np.pi * x))
    >>> touching = sie.Equation(sie.hilbert(1.0), wave, (sie.Total(0.5),))
    >>> found = sie.solve(touching, sie.Zones.of([[-0.1, 0.2]]))
    >>> found.zones.table.round(10).tolist()
    [[-0.25, 0.25]]
    """
    _check_problem(equation, zones, tol)
    _check_search(value, signs, max_steps)
    # NumPy's warnings are suppressed, since the values of a user's functions are checked.
    with np.errstate(all="ignore"):
        if not zones.moves.any():
            return _solve(equation, zones, tol, _fixed(equation, zones, tol))
        options, start = NewtonOptions(max_steps=max_steps, signs=signs), WarmStart(value=value)
        return _solve(equation, zones, tol, _free(equation, zones, tol, options, start))


def _solve(equation: Equation, zones: Zones, tol: float, solutions: Iterator[Solution]) -> Solution:
    """The first solution that meets `tol`, of `solutions` that are more and more accurate.

    Raises NotConverged if none does.
    """
    try:
        found = _best(solutions, tol)
    except SingularSystem as error:
        if zones.moves.any() and _solvable(equation, zones):
            raise NotConverged(
                f"the search for the ends reached zones on which there is no solution: {error}"
            ) from error
        raise ValueError(f"{error}") from error
    if found.error <= tol:
        return found
    raise NotConverged(_reason(found, tol), found)


def _check_problem(equation: Equation, zones: Zones, tol: float) -> None:
    """Raise ValueError for an equation, zones or a tolerance that are not valid."""
    if not isinstance(equation, Equation):
        raise ValueError(f"the equation must be a sie.Equation, got {type(equation).__name__}")
    if not isinstance(zones, Zones):
        raise ValueError(
            "the zones must be sie.Zones, such as sie.Zones.of([[a, b]], left, right), got "
            f"{type(zones).__name__}"
        )
    if not (inputs.is_number(tol) and 0 < tol < 1):
        raise ValueError(f"tol must be a number between 0 and 1, got {inputs.shown(tol)}")


def _check_search(value: float, signs: tuple[float, float], max_steps: int) -> None:
    """Raise ValueError for a first guess, signs or number of steps that are not valid."""
    inputs.number("value, the first guess of the unknown value,", value)
    if not (
        isinstance(signs, tuple | list)
        and len(signs) == 2
        and all(inputs.is_number(sign) and sign in (-1, 1) for sign in signs)
    ):
        raise ValueError(
            "signs must be a pair of 1 or -1, the signs of the density beside left and right ends, "
            "got "
            f"{inputs.shown(signs)}"
        )
    inputs.whole("max_steps", max_steps, 1)


def _solvable(equation: Equation, zones: Zones) -> bool:
    """Whether the system of equations on the given zones has a unique solution."""
    try:
        solve_zones(equation, zones)
    except SingularSystem:
        return False
    return True


def _best(solutions: Iterator[Solution], tol: float) -> Solution:
    """The first solution that meets the tolerance, or else the one with the smallest error."""
    best = next(solutions)
    while best.error > tol and (found := next(solutions, None)) is not None:
        best = found if found.error < best.error else best
    return best


def _fixed(equation: Equation, zones: Zones, tol: float) -> Iterator[Solution]:
    """Yield solutions on zones with fixed ends, first to the tolerance, then to round-off."""
    for decay in (max(OPTIONS.parts[0] * tol, EPS), EPS):
        state = solve_zones(equation, zones, decay)
        yield _with_errors(state)
        if not isinstance(state, GradedState) and _unresolvable(equation, zones, tol):
            break  # the first solution has the largest number of modes already


def _free(
    equation: Equation, zones: Zones, tol: float, options: NewtonOptions, start: WarmStart
) -> Iterator[Solution]:
    """Yield solutions with free ends, for smaller and smaller tolerances of the ends."""
    for part in OPTIONS.parts:
        free = find_ends(equation, zones, max(part * tol, EPS), options, start)
        yield _with_errors(free.state, free)
        if not free.converged:
            break
        zones, start = free.density.zones, WarmStart(value=free.value or 0.0)


def _with_errors(state: AnyState, search: Free | None = None) -> Solution:
    """The `Solution` of a solved state of the equation, with its stated errors.

    search: the search for the free ends; None if no end is free.
    """
    zones, value = state.density.zones, None if search is None else search.value
    if search is not None and not search.converged:
        unknown = np.full(len(zones), math.inf)
        return Solution(
            state.density, zones, math.inf, value, errors=unknown, state=state, search=search
        )
    of_ends, moved = np.zeros(len(zones)), np.zeros(len(zones))
    if search is not None:
        ends = search.end_error + search.end_truncation
        _, by_left, by_right = state.density.sensitivity
        of_ends, moved = (
            ends.max(axis=1),
            ends[:, 0] * by_left + ends[:, 1] * by_right + search.followed,
        )
    moved = moved + _jump_rounding(state)
    sizes = np.where(state.zone_sizes > 0.0, state.zone_sizes, math.inf)
    of_density = float(moved.max()) / max(state.size, 1e-300) + state.density_error
    # An evaluation of the density adds four round-offs: of the coefficients, of the square root,
    # and of the distances from both ends.
    evaluation = 4 * EPS
    error = max(float(of_ends.max()), of_density) + evaluation
    errors = np.maximum(of_ends, moved / sizes + state.zone_errors) + evaluation
    return Solution(state.density, zones, error, value, errors=errors, state=state, search=search)


def _jump_rounding(state: AnyState) -> Array:
    """Round-off of the density on each zone (n,) that the closed forms of its jumps cause.

    The terms of single jumps may be much larger than their sum.
    """
    jumps, out = state.density.jumps, np.zeros(len(state.whole.density.zones))
    np.maximum.at(out, jumps.zone, 2 * EPS * np.abs(jumps.height) * jumps.sine)
    return out[state.wide_of(np.arange(len(state.density.zones)))[1]]


def _reason(found: Solution, tol: float) -> str:
    """The reason, as a message, why a solution's error exceeds the tolerance."""
    search = found.search
    if search is not None and not search.converged:
        return reasons.of_search(search)
    reason = reasons.of_error(found.state, search, tol)
    return f"the stated error is {found.error:.1e}, above tol = {tol:.1e}: {reason}"


def _unresolvable(equation: Equation, zones: Zones, tol: float) -> bool:
    """Whether two zones are too close to each other even for the largest number of modes."""
    fallen = modes.decay(zones, equation.kernel) * modes.OPTIONS.max_modes
    return float(fallen.min()) < -math.log(OPTIONS.parts[0] * tol)
