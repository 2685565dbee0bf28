"""Solve the equation on given zones: choose the modes, sample, assemble, one LU, and read off the ends."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack, lu_factor, lu_solve

from sie import modes
from sie.assemble import System
from sie.density import Density
from sie.ends import End
from sie.equation import Equation
from sie.steps import Steps
from sie.zones import Zones

Array = NDArray[np.float64]
Index = NDArray[np.intp]


# A reciprocal condition below this is rounding: the rows are of size one.
_DEPENDENT = 1e-15


class SingularSystem(ArithmeticError):
    """The assembled system has no unique solution: the side conditions depend on each other."""


@dataclass(eq=False)
class Sizes:
    """Modes to start from; kept from one solve to the next so that growth is paid for once."""

    own: Index
    least: int
    profile_evaluations: int = 0
    kernel_evaluations: int = 0
    solves: int = 0


@dataclass(frozen=True, eq=False)
class State:
    """The solution on given zones, with what its error is made of.

    density; the LU factors for further right sides; `truncation`: what the neglected coefficients may amount to, over
    the largest coefficient of the same zone (Z,); `field_tail`: the same for the coupled modes of all zones.
    """

    density: Density
    system: System
    factors: tuple[Array, Array] = field(repr=False)
    unknowns: Array
    folded_unknowns: Array
    conditions_from: int
    condition_scale: Array
    truncation: Array
    field_tail: float
    sizes: Sizes

    def response(self, values: Array) -> Density:
        """The density caused by unit changes of the side conditions' values: right side zero, conditions = values."""
        y = self.response_unknowns(values)
        return self._homogeneous_density(y)

    def response_unknowns(self, values: Array) -> Array:
        """The unknowns of `response`, to be put into rows of the system."""
        right = np.zeros(self.factors[0].shape[0])
        right[self.conditions_from :] = values / self.condition_scale
        return _unfold(self.system, lu_solve(self.factors, right))

    def with_value(self, condition: int, change: float) -> State:
        """The state after the value of one side condition has changed."""
        values = np.zeros(len(self.condition_scale))
        values[self.condition_index[condition]] = change
        right = np.zeros(self.factors[0].shape[0])
        right[self.conditions_from :] = values / self.condition_scale
        folded = self.folded_unknowns + lu_solve(self.factors, right)
        unknowns = _unfold(self.system, folded)
        return replace(self, folded_unknowns=folded, unknowns=unknowns, density=density_of(self.system, unknowns))

    def homogeneous(self, right: Array) -> Density:
        """The density for another right side of the assembled rows, no forcing and no steps."""
        return self._homogeneous_density(_unfold(self.system, lu_solve(self.factors, right)))

    def _homogeneous_density(self, y: Array) -> Density:
        layout = self.system.layout
        density = self.density
        return Density(density.zones, density.kernel, layout.padded(y), Steps.none(), y[layout.coefficients :])

    @cached_property
    def density_error(self) -> float:
        """Estimated error of the density on these zones, over its peak: neglected coefficients, and the equation's
        residual between the nodes.

        With its singularity taken out, T_k / sqrt(1 - t^2) reaches 0.73 k (near an end): so much does an error of c_k
        count.
        """
        coefficients = np.abs(self.density.coefficients).max(axis=1) + np.abs(self.system.known).max(axis=1, initial=0.0)
        peak = float(coefficients.max())
        if peak == 0.0:
            return 0.0
        neglected = float((self.neglected * coefficients).max()) / peak
        residual = self._residual / peak
        coupled = self.system.layout.m[self.density.zones.solved]
        # A few points see the residual to a factor; its rounding adds up as the modes do, but does not grow with their
        # order.
        beyond = 3 * np.maximum(residual - 4e-15, 0.0) * coupled
        return neglected + float((beyond + residual + 6e-16 * coupled).max())

    @cached_property
    def end_truncation(self) -> Array:
        """What the density's error may shift each zone's moving ends by, over its width: 2 K / A for the K that it
        makes."""
        zones, solved = self.density.zones, self.density.zones.solved
        size = np.abs(self.density.coefficients).max(axis=1) + np.abs(self.system.known).max(axis=1, initial=0.0)
        missing = np.zeros(len(zones))
        missing[solved] = (self.neglected * size)[solved] / np.maximum(self.sizes.own[solved], 1)
        missing[solved] += 3 * np.maximum(self._residual - 2e-15 * size[solved], 0.0)
        intensity = np.sqrt(zones.half / 2) * missing
        moves = np.array([[end.moves for end in zones.left], [end.moves for end in zones.right]])
        slopes = np.where(moves, np.abs(self.density.edge_slopes), np.inf).min(axis=0)
        return np.asarray(intensity / np.maximum(slopes, 1e-300) / zones.half)

    @cached_property
    def waviness(self) -> Array:
        """Mean order of each zone's coefficients: how fast the density varies over the zone."""
        size = np.abs(self.density.coefficients)
        return np.asarray((size @ np.arange(size.shape[1])) / np.maximum(size.sum(axis=1), 1e-300))

    @cached_property
    def neglected(self) -> Array:
        """Sum of 0.73 k |c_k| over the neglected coefficients, estimated from the decay of the last ones, over the
        largest of the zone."""
        n = self.sizes.own[: len(self.truncation)]
        if len(n) == 0:
            return self.truncation
        size = np.abs(self.system.g)
        window = np.maximum(4, n // 8)
        head = np.array([size[i, k // 2 - w + 1 : k // 2 + 1].max() for i, (k, w) in enumerate(zip(n, window, strict=True))])
        last = np.array([size[i, k - w + 1 : k + 1].max() for i, (k, w) in enumerate(zip(n, window, strict=True))])
        with np.errstate(divide="ignore", invalid="ignore"):
            fall = np.where(head > 0, np.maximum(last / head, 1e-300), 1.0) ** (2.0 / n)
        # Coefficients that fall no further are rounding, whose sum grows as a random walk.
        weight = np.where(last > 0.5 * head, 2 * np.sqrt(n), 0.73 * n * fall**window / np.maximum(1 - fall, 1.0 / n))
        return np.asarray(self.truncation * np.maximum(weight, 1.0))

    @cached_property
    def _residual(self) -> Array:
        """Residual of the equation times sqrt(1 - t^2), the largest of a few points of every solved zone that are no
        nodes."""
        system, zones = self.system, self.density.zones
        theta = (np.arange(9) + 0.4142) * np.pi / 9
        t = np.cos(theta)
        x = (zones.middle[zones.solved][:, None] + zones.half[zones.solved][:, None] * t).ravel()
        equation = system.equation
        value = self.density.transform(x) - equation.forcing.value(x)
        for amplitude, column in zip(self.density.amplitudes, equation.columns, strict=True):
            value = value - amplitude * column.value(x)
        return np.asarray(np.abs(value.reshape(-1, len(t)) * np.sin(theta)).max(axis=1))

    @cached_property
    def condition_index(self) -> Index:
        """First row of each side condition among the conditions' rows."""
        zones = self.density.zones
        counts = [c.count(zones) for c in self.system.equation.conditions]
        return np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.intp)


def first_sizes(equation: Equation, zones: Zones) -> Sizes:
    """Modes to begin with: a few to resolve columns and regular kernels, else as many as the distances ask for."""
    least = 16 if equation.grows else max((column.modes or 0 for column in equation.columns), default=0)
    return Sizes(np.full(len(zones), 16), least)


def solve_fixed(
    equation: Equation, zones: Zones, tolerance: float = 1e-14, sizes: Sizes | None = None, largest: int = 8192
) -> State:
    """Solve on given zones, with singular ends allowed at moving ends (their intensity is what a Newton step needs).

    Raises CountError if conditions and index do not match, SingularSystem if the conditions are dependent.
    """
    equation.check_count(zones)
    if sizes is None:
        sizes = first_sizes(equation, zones)
    kernel = equation.kernel
    steps = equation.forcing.jumps_within(zones, kernel.period)
    samples = modes.sample(equation.forcing, zones, steps, sizes.own, tolerance, largest)
    sizes.own = samples.own
    sizes.profile_evaluations += samples.evaluations
    while True:
        m = modes.coupled(zones, kernel, tolerance, sizes.least)
        state = _solve_once(equation, zones, m, samples, steps, sizes)
        if not equation.grows or state.field_tail <= tolerance * 10 or int(m.max()) >= modes.COUPLED_SIZES[-1]:
            return state
        sizes.least = int(modes.COUPLED_SIZES[np.searchsorted(modes.COUPLED_SIZES, int(m.max()), side="right")])


def _solve_once(
    equation: Equation, zones: Zones, m: Index, samples: modes.Samples, steps: Steps, sizes: Sizes
) -> State:
    system = System(equation, zones, m, samples.coefficients, steps)
    matrix, right, scale = _rows(equation, system)
    lu, pivots = lu_factor(matrix, overwrite_a=False, check_finite=False)
    if not (np.all(np.isfinite(samples.coefficients)) and np.all(np.isfinite(right)) and np.all(np.isfinite(lu))):
        raise SingularSystem("the right side, a column or a side condition is not finite on the zones")
    if lapack.dgecon(lu, np.abs(matrix).sum(axis=0).max(initial=0.0))[0] < _DEPENDENT:
        raise SingularSystem("the system is singular: the side conditions depend on each other")
    folded = lu_solve((lu, pivots), right, check_finite=False)
    y = _unfold(system, folded)
    density = density_of(system, y)
    sizes.kernel_evaluations += matrix.size
    sizes.solves += 1
    top = np.abs(density.coefficients[:, 1:]).max(axis=1, initial=0.0) + np.abs(system.known).max(axis=1, initial=0.0)
    truncation = samples.tail / np.where(top > 0, top, 1.0)
    tail = max(_field_tail(system, y, density), system.source_tail)
    return State(density, system, (lu, pivots), y, folded, matrix.shape[0] - len(scale), scale, truncation, tail, sizes)


def assembled(
    equation: Equation, zones: Zones, m: Index, sizes: Sizes, tolerance: float, scale: Array | None = None
) -> tuple[System, Array, Array, Array]:
    """(system, matrix, right side, condition scale) at given zones and coupled modes, without solving."""
    steps = equation.forcing.jumps_within(zones, equation.kernel.period)
    samples = modes.sample(equation.forcing, zones, steps, sizes.own, tolerance, int(sizes.own.max()))
    system = System(equation, zones, m, samples.coefficients, steps)
    return system, *_rows(equation, system, scale)


def _rows(equation: Equation, system: System, scale: Array | None = None) -> tuple[Array, Array, Array]:
    """Rows of the equation and of the side conditions over the kept unknowns; conditions scaled to size one."""
    matrix, right = system.equation_rows()
    rows, values = _condition_rows(equation, system.zones, system)
    if scale is None:
        scale = np.abs(rows).max(axis=1, initial=0.0)
        if np.any(scale == 0):
            raise SingularSystem("a side condition does not depend on the density")
    matrix = _fold(system, np.concatenate((matrix, rows / scale[:, None])))
    return matrix, np.concatenate((right, values / scale)), scale


def density_of(system: System, y: Array) -> Density:
    """The density with unknowns y: coefficients up to m from y, those beyond minus the right side's."""
    layout, g = system.layout, system.g
    solved = layout.padded(y)
    out = np.zeros((len(layout.m), max(solved.shape[1], g.shape[1])))
    out[:, : g.shape[1]] = -g
    out[:, 0] = 0.0
    given = np.arange(solved.shape[1]) <= layout.m[:, None]
    out[:, : solved.shape[1]] = np.where(given, solved, out[:, : solved.shape[1]])
    return Density(system.zones, system.equation.kernel, out, system.steps, y[layout.coefficients :])


def _condition_rows(equation: Equation, zones: Zones, system: System) -> tuple[Array, Array]:
    """All side conditions, and intensity zero at fixed bounded ends, as rows and values."""
    rows, values = [], []
    for condition in equation.conditions:
        matrix, constants, wanted = condition.rows(system)
        rows.append(matrix)
        values.append(wanted - constants)
    bounded_left = [p for p, i in enumerate(zones.solved) if _held(zones.left[i])]
    bounded_right = [p for p, i in enumerate(zones.solved) if _held(zones.right[i])]
    if zones.central and 0 in bounded_left:
        bounded_left.remove(0)  # the mirror image of the right end
    if bounded_left or bounded_right:
        left, right = system.intensities()
        for chosen, (matrix, constants) in ((bounded_left, left), (bounded_right, right)):
            rows.append(matrix[chosen])
            values.append(-constants[chosen])
    return np.concatenate(rows) if rows else np.zeros((0, system.layout.size)), np.concatenate(values or [np.zeros(0)])


def _held(end: End) -> bool:
    return not end.moves and end.intensity is not None


def _field_tail(system: System, y: Array, density: Density) -> float:
    """Last coupled coefficients of what the other zones and the columns do, over the largest coefficient of the
    zone."""
    layout, g = system.layout, system.g
    if layout.m.max() < 8:
        return 0.0
    field = layout.padded(y)
    count = min(g.shape[1], field.shape[1])
    field[:, 1:count] += g[:, 1:count]
    k = np.arange(field.shape[1])
    last = (k <= layout.m[:, None]) & (k > layout.m[:, None] - 3) & (layout.m[:, None] >= 8)
    top = np.maximum(np.abs(density.coefficients).max(axis=1), np.abs(system.known).max(axis=1, initial=0.0))
    # What is left is a difference of numbers of the size of the right side: below their rounding there is no tail.
    rounding = 8 * 2.2e-16 * np.abs(g).max(axis=1)
    tail = np.maximum(np.abs(np.where(last, field, 0.0)).max(axis=1) - rounding, 0.0)
    return float((tail / np.where(top > 0, top, 1.0)).max())


def _mirror_signs(system: System) -> tuple[Index, Index, Array, Index]:
    """Kept unknowns of a symmetric set, and (target, sign, source) of those that follow from them."""
    layout, zones = system.layout, system.zones
    keep, follow, sign, source = [], [], [], []
    count = len(zones)
    for i in zones.solved:
        k = np.arange(layout.m[i] + 1)
        if zones.central and i == zones.solved[0]:
            keep.append(layout.offset[i] + k[::2])
            continue
        keep.append(layout.offset[i] + k)
        follow.append(layout.offset[count - 1 - i] + k)
        sign.append(1.0 - 2.0 * (k % 2))
        source.append(layout.offset[i] + k)
    keep.append(layout.coefficients + np.arange(layout.columns))
    empty = np.zeros(0, dtype=np.intp)
    return (
        np.concatenate(keep),
        np.concatenate(follow or [empty]),
        np.concatenate(sign or [np.zeros(0)]),
        np.concatenate(source or [empty]),
    )


def _fold(system: System, matrix: Array) -> Array:
    """Columns of mirrored zones added to those they follow from; the rest of a symmetric set's unknowns dropped."""
    if not system.zones.symmetric:
        return matrix
    keep, follow, sign, source = _mirror_signs(system)
    matrix[:, source] += matrix[:, follow] * sign
    return matrix[:, keep]


def _unfold(system: System, y: Array) -> Array:
    if not system.zones.symmetric:
        return y
    keep, follow, sign, source = _mirror_signs(system)
    out = np.zeros(system.layout.size)
    out[keep] = y
    out[follow] = sign * out[source]
    return out
