"""The derivative of a solution by a parameter of its problem, from the solution's own solver.

Let s be the parameter. The derivative of T phi = g + sum lambda_k C_k at fixed x is

    T phi' = g' - (1/pi) int phi k' dxi + sum lambda_k' C_k,

with k' the derivative of the kernel. So phi' is a density of the same equation. At an end that
moves outward at the rate e, phi = K d^(-1/2) + A d^(1/2) + ... at the distance d gives

    phi' = -(K/2) e d^(-3/2) + (K' + A e / 2) d^(-1/2) + ...

The motion of a free end with K = 0 follows from the intensity k of phi': e = 2 k / A. The terms
d^(-3/2) are the singular densities of `sie.ends.motions`. A free end with a prescribed intensity
other than zero moves so that the intensity stays as prescribed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sie.basis import chebyshev, inputs
from sie.basis.data import EPS, Array, widened
from sie.basis.interval import intensities as intensities_of
from sie.basis.kernels import Kernel, Regular, Smooth, cauchy
from sie.basis.zones import BOUNDED, SINGULAR, Zones
from sie.dense import modes
from sie.dense.system import System
from sie.density.density import Density
from sie.density.series import regular_at
from sie.ends.motions import IteratedMotions, Moved, motions_of, rows_of_motions
from sie.equation.checks import check_functions
from sie.equation.conditions import Rows, ZoneMoments, asked
from sie.equation.equation import Equation
from sie.equation.forcing import Forcing, Function
from sie.fast.system import Applied, IterativeSystem
from sie.graded.density import GradedDensity
from sie.graded.system import GradedSystem
from sie.jumps.right_side import ForcingJumps
from sie.results.moved_density import MovedDensity
from sie.second_kind.density import SecondKindDensity
from sie.second_kind.system import SecondKindRows
from sie.slits.system import AnyDensity, AnyState
from sie.states.base import density_of
from sie.states.solve import SingularSystem, TooLarge, rows_of, solve_fixed
from sie.states.state import State


@dataclass(frozen=True)
class DerivativeOptions:
    """Limits of errors, and numbers of nodes, for the derivative of a solution."""

    # Largest accepted ratio of the last coefficients of a series to its largest coefficient. The
    # series are those of a user's function or of the density's derivative. Below this limit, and
    # for a solution to the default tolerance, the derivative has half of the digits of a double.
    max_tail: float = 1e-8
    # For a solution with slits (narrow gaps inside a wide zone) or graded coordinates, the
    # derivative is computed from a solution of the same problem without either. `max_error` bounds
    # the stated error of this other solution.
    max_error: float = 1e-8
    # The product of the density and the kernel's derivative by the parameter is integrated with at
    # least and at most these numbers of nodes on a zone. The number is doubled until the integral
    # no longer changes.
    least_nodes: int = 64
    most_nodes: int = 4096
    # The number of nodes suffices if doubling it changes the integral by at most this fraction of
    # the integral's size. The fraction is some hundred round-offs.
    field_change: float = 1e-13


OPTIONS = DerivativeOptions()


@dataclass(frozen=True, eq=False)
class Derivative:
    """The derivative of a solution by a parameter. `Solution.derivative` makes it.

    Attributes
    ----------
    density : Density, MovedDensity, GradedDensity or SecondKindDensity
        Derivative of the density at fixed x. It is singular at free ends. Its transform is the
        derivative of the transform at fixed points off the zones, without the part that a change
        of the kernel adds.
    ends : (n, 2) array
        Derivatives of the positions of the ends.
    intensities : (2, n) array
        Derivatives of the intensities K at left and right ends.
    amplitudes : (k,) array
        Derivatives of the amplitudes of the columns.
    value : float or None
        Derivative of the unknown value of a side condition; None if all values are given.

    Examples
    --------
    A cylinder under the load P = pi a^2 / 2 touches on [-a, a]: da/dP = 1 / (pi a).

    >>> import numpy as np, sie
    >>> hertz = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(np.pi / 2))
    >>> found = sie.solve(hertz, sie.Zones.of([[-0.9, 1.2]]))
    >>> by_load = found.derivative(values=[1.0])
    >>> (by_load.ends * np.pi).round(9).tolist(), float(round(by_load.density.total, 12))
    ([[-1.0, 1.0]], 1.0)
    """

    density: Density | MovedDensity | GradedDensity | SecondKindDensity
    ends: Array
    intensities: Array
    amplitudes: Array
    value: float | None = None


@dataclass(frozen=True, eq=False)
class Change:
    """The derivatives of the data of a problem by the parameter, after checks.
    `Change.of` makes them from a user's values.

    forcing: derivative of the right side, with the effect of the kernel's change; None: no change.
    values: derivatives of the values of all side conditions, one for each row. of_ends: derivative
    of the value of the condition on the ends. outward: outward motions of the fixed ends (2, n).
    intensities: derivatives of the prescribed K (2, n).
    """

    forcing: Forcing | None
    values: Array
    of_ends: float
    outward: Array
    intensities: Array

    @classmethod
    def of(
        cls,
        state: AnyState,
        dg: Forcing | Function | None = None,
        values: Sequence[ArrayLike] | ArrayLike | None = None,
        dkernel: Smooth | Regular | None = None,
        dends: ArrayLike | None = None,
        dintensities: ArrayLike | None = None,
    ) -> "Change":
        zones = state.density.zones
        forcing = _forcing(dg)
        if dkernel is not None:
            density = state.density
            assert isinstance(density, Density), "only solutions without slits come here"
            forcing = _with_kernel(forcing, _kernel_field(density, dkernel))
        moved = table_of("dends", dends, (len(zones), 2)).T * [[-1.0], [1.0]]
        if np.any(moved[zones.moves]):
            raise ValueError(
                "dends must be zero for free ends, since free ends follow from the problem"
            )
        if zones.symmetric and np.any(moved != moved[::-1, ::-1]):
            raise ValueError("dends of symmetric zones must be mirror images")
        k = table_of("dintensities", dintensities, (2, len(zones)))
        if np.any(k[np.isnan(zones.intensities)]):
            raise ValueError(
                "dintensities must be zero at singular ends, since the intensity there follows "
                "from the problem"
            )
        rows, of_ends = _values(state.equation, zones, values)
        moments = any(isinstance(one, ZoneMoments) for one in state.equation.conditions)
        if moments and (moved.any() or zones.moves.any()):
            raise ValueError(
                "ZoneMoments takes moments about the middles of the zones, which move with the "
                "ends: use sie.Weighted or sie.moment instead"
            )
        return cls(forcing, rows, of_ends, moved, k)

    def held(self, zones: Zones) -> list[float]:
        """Derivatives of the prescribed intensities at fixed bounded ends, left ends first."""
        return [
            float(self.intensities[side, zones.solved[p]])
            for side, places in enumerate(zones.fixed_bounded)
            for p in places
        ]


def table_of(name: str, given: ArrayLike | None, shape: tuple[int, int]) -> Array:
    """The numbers `given` as an array of this shape; zeros if `given` is None."""
    table = np.zeros(shape) if given is None else inputs.table_of(name, given)
    if table.shape != shape:
        raise ValueError(f"{name} must be finite numbers of shape {shape}, got {table.shape}")
    if not np.isfinite(table).all():
        raise ValueError(f"{name} must be finite numbers, got {inputs.shown(given)}")
    return table


def _values(
    equation: Equation, zones: Zones, given: Sequence[ArrayLike] | ArrayLike | None
) -> tuple[Array, float]:
    """Derivatives of right sides: (of all side conditions, of the condition on the ends)."""
    names = (*equation.conditions, *equation.end_conditions)
    values = [0.0] * len(names) if given is None else _several(given)
    if len(values) != len(names):
        raise ValueError(
            f"values must have one entry for each of the {len(names)} conditions "
            f"({', '.join(map(str, names))}), got {inputs.shown(given)}"
        )
    rows = []
    for condition, value in zip(equation.conditions, values, strict=False):
        count = condition.count(zones)
        row = inputs.numbers(f"values: that of {condition}", value)
        if len(row) not in (1, count):
            raise ValueError(f"values: {condition} has {count} rows, got {len(row)} values")
        if condition.open and row.any():
            raise ValueError(f"values: the value of {condition} is unknown; give zero for it")
        rows.append(np.broadcast_to(row, (count,)) if len(row) == 1 else row)
    of_ends = [inputs.number("values", value) for value in values[len(equation.conditions) :]]
    return np.concatenate([np.zeros(0), *rows]), sum(of_ends)


def _several(given: Any) -> list[Any]:
    return list(given) if isinstance(given, list | tuple | np.ndarray) else [given]


def _forcing(dg: Forcing | Function | None) -> Forcing | None:
    if dg is None or isinstance(dg, Forcing):
        return dg
    inputs.function("dg", dg)
    return Forcing(dg)


def _with_kernel(forcing: Forcing | None, added: Forcing) -> Forcing:
    """The derivative of the right side, minus the field `added` of the kernel's derivative.

    `added` is the transform of the density with the kernel's derivative in place of the kernel.
    """
    if forcing is None:
        return Forcing(_Minus(None, added.value), added.primitive and _Minus(None, added.primitive))
    primitive = None
    if forcing.primitive is not None and added.primitive is not None:
        primitive = _Minus(forcing.primitive, added.primitive)
    return replace(forcing, value=_Minus(forcing.value, added.value), primitive=primitive)


@dataclass(frozen=True)
class _Minus:
    """The function first - second; it is -second if `first` is None."""

    first: Function | None
    second: Function

    def __call__(self, x: Array) -> Array:
        taken = np.asarray(self.second(x))
        return -taken if self.first is None else np.asarray(self.first(x) - taken)


@dataclass(frozen=True, eq=False)
class _KernelField:
    """The transform or potential of a density with a smooth kernel, as a function of x."""

    density: Density
    regular: Regular

    def __call__(self, x: Array) -> Array:
        return regular_at(self.density, x.ravel(), self.regular).reshape(x.shape)


def _kernel_field(density: Density, dkernel: Smooth | Regular) -> Forcing:
    """Transform of `density` with the kernel `dkernel` alone, as the value of a `Forcing`.
    Its primitive is the potential, if `dkernel` has one.

    The number of nodes on each zone is doubled until the transform no longer changes.
    """
    kernel: Kernel = cauchy() + dkernel
    assert kernel.regular is not None
    zones = density.zones
    t = chebyshev.lobatto(OPTIONS.least_nodes // 4)[0]
    x = (zones.middle[:, None] + zones.half[:, None] * t).ravel()
    nodes, last = max(density.coefficients.shape[1], OPTIONS.least_nodes), None
    while True:
        table = widened(density.coefficients, nodes)
        wider = replace(density, kernel=kernel, coefficients=table)
        field_of = _KernelField(wider, kernel.regular)
        here = np.asarray(field_of(x))
        if not np.isfinite(here).all():
            raise ValueError("dkernel is not finite on the zones")
        size = np.abs(here).max()
        if last is not None and np.abs(here - last).max() <= OPTIONS.field_change * size:
            break
        if nodes >= OPTIONS.most_nodes:
            raise ValueError("dkernel is not resolved on the zones: it is not smooth there")
        nodes, last = 2 * nodes, here
    potential = kernel.regular_potential
    return Forcing(field_of, None if potential is None else _KernelField(wider, potential))


def without_slits(state: AnyState, value: float | None, factors: bool = False) -> State:
    """The solution on the same zones, but without slits (narrow gaps inside a wide zone).
    Derivatives are computed from it.

    factors: whether it must have LU factors; then an iterated solution is computed again.
    """
    if state.equation.second_kind:
        raise ValueError("gradients are known for kappa = 0 only")
    if isinstance(state, State) and not (factors and state.iterated):
        return state.with_bounded_ends()
    try:
        found = solve_fixed(state.equation, state.density.zones, direct=factors)
    except TooLarge as error:
        raise ValueError(f"{error}: use `derivative`, one parameter at a time") from error
    opened = state.equation.open_condition
    if opened is not None:
        found = found.with_value(opened, value or 0.0)
    if not isinstance(state, State) and found.density_error > OPTIONS.max_error:
        raise ValueError(
            "gaps between the zones are too narrow for this derivative: it needs a solution "
            f"without slits and graded coordinates, which has an error of {found.density_error:.1e}"
        )
    return found.with_bounded_ends()


def known_parts(system: System | GradedSystem | SecondKindRows, view: Rows, size: int) -> Array:
    """Constant parts (rows,) of all side conditions of a system, without the unknowns' terms.

    view: gives the quantities that the conditions use; its matrices have `size` columns.
    """
    parts = [asked(one, view, size)[1] for one in system.equation.conditions]
    if any(system.zones.fixed_bounded):
        pairs = zip(system.zones.fixed_bounded, view.intensities(), strict=True)
        parts += [constants[chosen] for chosen, (_, constants) in pairs]
    return np.concatenate([np.zeros(0), *parts])


def end_rates_of(density: AnyDensity, lack: Array) -> Array:
    """Outward motions (2, Z) of the free ends that change the intensity at them from 0 to `lack`.

    density: density of the solution; the motions are proportional to `lack` / its edge slopes.
    """
    zones = density.zones
    slopes = np.array(density.edge_slopes)
    if np.any(slopes[zones.moves] == 0.0):
        raise SingularSystem(
            "beside a free end the density does not grow as sqrt(distance), so the motion of the "
            "end is not determined"
        )
    rates = zones.weight.end_step(-lack, np.where(zones.moves, slopes, 1.0))
    return np.where(zones.moves, rates, 0.0)


class LinearEquations:
    """Base class: the linear equations for the derivative of one solution by a parameter.

    right: right sides of the equations; those of the side conditions come last.
    """

    right: Array

    def __init__(self, state: Any, change: Change) -> None:
        self.state, self.change = state, change
        self.zones, self.system = state.density.zones, state.system

    def answer(self, right: Array) -> tuple[Array, Array]:
        """(unknowns of the density's derivative, outward motions of all ends) from `right`.
        `right` is a right side of the linear equations.
        """
        raise NotImplementedError

    def solved(self) -> tuple[Array, Array, float | None]:
        """(unknowns, outward motions of ends, derivative of the open value).

        The open value is the unknown value of a side condition. The condition on the ends
        determines it. Its derivative is None if all values are known.
        """
        y, outward = self.answer(self.right)
        state, equation = self.state, self.state.equation
        if equation.open_condition is None:
            return y, outward, None
        unit = np.zeros_like(self.right)
        rows = state.values(equation.open_condition) / state.condition_scale
        unit[len(unit) - len(rows) :] = rows
        more_y, more_outward = self.answer(self.right + unit)
        normal = np.array(equation.end_conditions[0].residual(self.zones)[1:])
        rate = float((normal * (more_outward - outward)).sum())
        if rate == 0.0:
            raise SingularSystem(
                "the unknown value of the side condition has no effect on the condition on the ends"
            )
        value = (self.change.of_ends - float((normal * outward).sum())) / rate
        return y + value * (more_y - y), outward + value * (more_outward - outward), value


class Linearized(LinearEquations):
    """The linear equations for the derivative of a solution without slits or graded coordinates."""

    def __init__(self, state: State, change: Change) -> None:
        super().__init__(state, change)
        self.motions: IteratedMotions | None = None
        if state.iteration is not None:
            self.motions = IteratedMotions(state, state.iteration)
        self.changed = None if change.forcing is None else self._changed_system(change.forcing)
        self.right = self._right()

    def _changed_system(self, forcing: Forcing) -> System:
        """The linear system for the derivative.
        Its right side is `forcing`, the derivative of the solution's right side.
        """
        zones, system = self.zones, self.system
        equation = replace(system.equation, forcing=forcing)
        check_functions(equation, zones)
        kernel = equation.kernel
        jumps: ForcingJumps = forcing.jumps_within(zones, kernel)
        own = modes.own_at_first(zones, forcing.jumps.singular_at, kernel.period)
        samples = modes.sample(forcing, zones, jumps, own, EPS, modes.most_own(zones))
        size = np.abs(samples.coefficients).max(axis=1, initial=0.0)
        wrong = samples.tail > OPTIONS.max_tail * np.maximum(size, size.max())
        if not np.isfinite(samples.coefficients).all() or wrong.any():
            raise ValueError(
                "the change of the right side is not finite, or not resolved on zone "
                f"{int(np.argmax(wrong))} (counted from 0): declare its jumps"
            )
        kind = IterativeSystem if isinstance(system, IterativeSystem) else System
        return kind(equation, zones, system.layout.m, samples.coefficients, jumps)

    def _right(self) -> Array:
        """Right sides of all rows of the equations for the derivative.
        The effect of moving ends is not included.
        """
        state, zones = self.state, self.zones
        out = np.zeros(state.solver.size)
        rows = np.concatenate((self.change.values, self.change.held(zones)))
        if self.changed is not None:
            equation_right, constants = self._constants(self.changed)
            out[: state.conditions_from] = equation_right
            rows = rows - constants
        out[state.conditions_from :] = rows / state.condition_scale
        return out

    def _constants(self, system: System) -> tuple[Array, Array]:
        """(right sides of the equation, constant parts of the side conditions) of a system."""
        view: Rows = system
        size, none = system.layout.size, np.zeros(len(self.zones.solved))
        if isinstance(system, IterativeSystem):
            equation_right = system.equation_right
            view, size = Applied(system, np.zeros(size), none, none), 1
        else:
            equation_right = system.equation_rows()[1]
        return equation_right, known_parts(system, view, size)

    def unknowns(self, right: Array, outward: Array) -> Array:
        """The unknowns for a right side, if the ends move outward by `outward` (2, Z)."""
        state = self.state
        if outward.any():
            moved = Moved.of(state, outward[:, :, None])
            if self.motions is None:
                right = right - rows_of_motions(state, rows_of(state), moved)[:, 0]
            else:
                one = Moved.of(state, outward)
                right = right - self.motions.applied(np.zeros(len(right)), one)[0]
        iteration = state.iteration
        folded = state.solver(right) if iteration is None else iteration(right, None, 0.0)
        return state.symmetry.unfold(folded)

    def density(self, y: Array) -> Density:
        """The derivative of the density without its singular terms at moving ends.
        `y` are the unknowns of the equations for the derivative.
        """
        changed = self.changed
        return self.state.homogeneous(y) if changed is None else density_of(changed, y)

    def intensities(self, y: Array, outward: Array) -> Array:
        """Derivatives (2, Z) of the intensities of the density at the zone ends by the parameter.

        y: the unknowns of the density's derivative. outward: outward motions of all ends (2, Z).
        """
        alpha, beta = chebyshev.edge_part(self.density(y).coefficients)
        own = Moved.of(self.state, outward).own
        return np.array(intensities_of(alpha, beta, self.zones.half)) + own

    def answer(self, right: Array) -> tuple[Array, Array]:
        zones, outward = self.zones, self.change.outward
        y = self.unknowns(right, outward)
        if not zones.moves.any():
            return y, outward
        lack = np.where(zones.moves, self.change.intensities - self.intensities(y, outward), 0.0)
        if zones.follow_ends:
            motions = motions_of(self.state)
            found = motions.meeting(motions.of(lack), 0.0)
            if not np.isfinite(found).all():
                raise SingularSystem(
                    "the prescribed intensities do not determine the ends: some motion of the ends "
                    "leaves the intensities unchanged"
                )
            outward = outward + motions.spread(found)
            return self.unknowns(right, outward), outward
        return y, outward + end_rates_of(self.state.density, lack)

    def derivative(self) -> Derivative:
        return self._assembled(*self.solved())

    def _assembled(self, y: Array, outward: Array, value: float | None) -> Derivative:
        zones, plain = self.zones, self.density(y)
        k, asked_k = self.intensities(y, outward), self.change.intensities
        k = np.where(np.isnan(zones.intensities), k, asked_k)
        # If a bounded end does not move and its intensity stays zero, the derivative of the density
        # is also bounded at this end. Its computed intensity there is then only round-off.
        rests = zones.bounded & (outward == 0.0) & (asked_k == 0.0)
        alpha, beta = chebyshev.edge_part(plain.coefficients)
        edges = np.where(rests, 0.0, [alpha - beta, alpha + beta])
        kinds = [[BOUNDED if rest else SINGULAR for rest in side] for side in rests]
        fixed = replace(zones, left=tuple(kinds[0]), right=tuple(kinds[1]))
        smooth = replace(
            plain, zones=fixed, edges=(0.5 * (edges[0] + edges[1]), 0.5 * (edges[1] - edges[0]))
        )
        moved = Moved.of(self.state, outward)
        strength = np.where(zones.bounded, 0.0, moved.strength)
        density: Density | MovedDensity = smooth
        if strength.any():
            carrier = self.state.homogeneous(moved.coefficients)
            density = MovedDensity(smooth, strength, carrier)
        ends = (outward * [[-1.0], [1.0]]).T
        return Derivative(density, ends, k, smooth.amplitudes, value)
