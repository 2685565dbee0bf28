r"""Interacting spots of one or several kinds: the equation of the second kind and Newton's method.

Let w_j(x), |x| <= a_j, be the Abel transform of the displacement that a spot of kind j, of radius
a_j, causes under itself. Its load is P_j = E* int w_j dx over (-a_j, a_j), and its pressure
p_j(r) = -(E*/pi) int_r^a_j w_j'(x) dx / sqrt(x^2 - r^2). Then

    w_j(x) = delta - d_j - g_j(x) - e_j(x) + sum_i (2 N_i P_i/E*) sqrt(A_ji^2 - x^2),
    e_j(x) = (1/pi) sum_i int_-a_i^a_i w_i(t) K_ji(x - t) dt,

with the approach delta, the transform g_j of the profile and the depth d_j of its tip. e_j is the
effect of the neighbours that are treated at their places. N_i is the number of spots of kind i per
unit area; the kernels K_ji and the radii A_ji are those of `neighbours`. For given radii this is a
linear system for e_j at Gauss nodes, the loads and delta. One side condition closes it: a total
load, w = 0 at an edge, or a tip that just touches. The correct radii have w_j(a_j) = 0. A shift of
a_j changes the integrals by w_j(a_j) da_j, which vanishes at the solution. So the Jacobian of the
edge values w_j(a_j) is diagonal, with the entries w_j'(a_j), and Newton's method replaces a_j by
a_j - w_j(a_j)/w_j'(a_j) under any side condition.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from contact.axisymmetric.neighbours import NeighbourKernel, Surroundings
from contact.axisymmetric.profiles import AxisymmetricProfile
from contact.axisymmetric.quadrature import half_gauss, panels
from contact.errors import NotConverged, OutOfRange
from contact.model.profiles.noise import EPS
from sie import Array


@dataclass(frozen=True)
class RadiusOptions:
    """Limits of Newton's method for the radii of the spots."""

    max_steps: int = 100
    # Relative step of the radii below which the iteration ends. It is about the round-off times the
    # condition number of the linear system.
    converged_step: float = 1e-13


_OPTIONS = RadiusOptions()


@dataclass(frozen=True)
class Kind:
    """A kind: all spots with the same profile and depth of the tips, and their number per area.

    around: for every kind, the `Surroundings` that its spots form around one spot of this kind.
    """

    profile: AxisymmetricProfile
    depth: float
    density: float
    around: Sequence[Surroundings]


@dataclass(frozen=True)
class Source:
    """Effect of one kind of spots on another, as a weighted sum of a kernel over nodes.

    The weights contain the transform w of the displacement of the first kind (head of this module).
    """

    nodes: Array
    weighted: Array  # 2 x weight x w; the sum over the nodes is P/E*
    kernel: NeighbourKernel

    def value(self, x: Array) -> Array:
        """The part of e(x) that spots of one kind cause.
        e(x) is the effect of all neighbours at x.
        """
        return both_sides(self.kernel.value, x, self.nodes) @ self.weighted / (2.0 * pi)

    def slope(self, x: Array) -> Array:
        return both_sides(self.kernel.slope, x, self.nodes) @ self.weighted / (2.0 * pi)


def both_sides(function: Callable[[Array], Array], x: Array, t: Array) -> Array:
    """The sum function(x - t) + function(x + t), with t along a new last axis."""
    return np.asarray(function(x[..., None] - t) + function(x[..., None] + t))


@dataclass(frozen=True)
class Surface:
    """Effect of all other spots on the displacement under a spot, after the Abel transform.
    The displacement is measured from the mean plane.

    sources: the neighbours treated at their places. nominal: the farther neighbours, as pairs of
    2 N P/E* and of the `Surroundings` with the circle outside which the nominal pressure N P acts.
    """

    sources: tuple[Source, ...]
    nominal: tuple[tuple[float, Surroundings], ...]

    def value(self, x: ArrayLike) -> Array:
        x = np.asarray(x, dtype=np.float64)
        nominal = sum((s * around.outside(x) for s, around in self.nominal), np.zeros(x.shape))
        return sum((source.value(x) for source in self.sources), -nominal)

    def slope(self, x: ArrayLike) -> Array:
        x = np.asarray(x, dtype=np.float64)
        return self.kept_slope(x) - sum(
            (s * around.outside_slope(x) for s, around in self.nominal), np.zeros(x.shape)
        )

    def kept_slope(self, x: ArrayLike) -> Array:
        """Derivative of the effect of the single neighbours, a part of `value`.
        The other part is due to the mean pressure of far neighbours.

        It is smooth up to the edges of these neighbours.
        """
        return sum((source.slope(np.asarray(x)) for source in self.sources), np.zeros(np.shape(x)))


@dataclass(frozen=True)
class State:
    """The forces, edge residuals and approach that solve the linear system for given radii.

    `forces` are P/E* and `edges` are w(a) of every kind, 0 without contact (head of this module).
    """

    radii: Array
    forces: Array
    edges: Array
    delta: float
    surfaces: tuple[Surface, ...]


# Type of a side condition: a function that returns the last row of the linear system, and the
# right-hand side of this row.
Condition = Callable[["Linear"], tuple[Array, float]]


class Linear:
    """The linear system of all kinds in contact, for given radii of the spots.

    The unknowns are e at the nodes of every kind in contact, P/E* of each kind, and delta. A
    quantity that is linear in the unknowns is stored as a row: their coefficients, then a constant.
    """

    def __init__(self, kinds: Sequence[Kind], radii: Array, n: int) -> None:
        self.kinds, self.radii = kinds, radii
        self.active = touching(radii)
        coupled = any(kind.around[i].kernel is not None for kind in kinds for i in self.active)
        self.unit, self.weight = half_gauss(n) if coupled else (np.empty(0), np.empty(0))
        m = self.unit.size
        self.at_e = {j: slice(k * m, (k + 1) * m) for k, j in enumerate(self.active)}
        self.at_force = {j: len(self.active) * m + k for k, j in enumerate(self.active)}
        self.at_delta = len(self.active) * (m + 1)
        self.size = self.at_delta + 1
        # The transform w of the displacement is a smooth part minus g, the transform of the
        # profile, which need not be smooth. Each part has its own quadrature. `smooth`: nodes for
        # the smooth part, and twice their weights. `rough`: nodes for g, and -2 g times their
        # weights.
        self.smooth = {j: (radii[j] * self.unit, 2.0 * radii[j] * self.weight) for j in self.active}
        self.rough = {j: self._rough(j) for j in self.active}
        every = np.eye(self.size + 1)
        self.w = {j: self.displaced(j, self.smooth[j][0], every[self.at_e[j]]) for j in self.active}

    def _rough(self, j: int) -> tuple[Array, Array]:
        """(nodes, -2 g(node) times the weight) of the quadrature for the transform g of the
        profile.
        """
        a, profile = float(self.radii[j]), self.kinds[j].profile
        nodes, weights = panels([0.0, *(min(b, a) for b in profile.breakpoints), a])
        return nodes, -2.0 * weights * profile.line(nodes)

    def displaced(self, j: int, x: Array, e: Array) -> Array:
        """Matrix rows for w_j(x) + g_j(x), the part of the transformed displacement that is smooth.
        g_j is the transform of the profile of kind j.

        e: the rows for e_j(x), the effect of the neighbours.
        """
        rows = -e
        rows[:, self.at_delta] += 1.0
        rows[:, -1] -= self.kinds[j].depth
        for k in self.active:
            rows[:, self.at_force[k]] += (
                2.0 * self.kinds[k].density * self.kinds[j].around[k].outside(x)
            )
        return rows

    def e(self, j: int, x: Array) -> Array:
        """Matrix rows for e_j(x), the effect of all single neighbours on a spot of kind j."""
        rows = np.zeros((x.size, self.size + 1))
        for i in self.active:
            kernel = self.kinds[j].around[i].kernel
            if kernel is not None:
                (t, weights), (s, rough) = self.smooth[i], self.rough[i]
                rows += both_sides(kernel.value, x, t) * weights @ self.w[i] / (2.0 * pi)
                rows[:, -1] += both_sides(kernel.value, x, s) @ rough / (2.0 * pi)
        return rows

    def row(self, at: Mapping[int, float]) -> Array:
        """A row of the matrix with given coefficients at given indices, and zeros elsewhere."""
        out = np.zeros(self.size)
        out[list(at)] = list(at.values())
        return out

    def solve(self, condition: Condition) -> State:
        matrix, right = np.zeros((self.size, self.size)), np.zeros(self.size)
        for j in self.active:
            at, row, kind, a = self.at_e[j], self.at_force[j], self.kinds[j], float(self.radii[j])
            x, weights = self.smooth[j]
            e = self.e(j, x)
            matrix[at], right[at] = -e[:, :-1], e[:, -1]
            matrix[at, at] += np.eye(x.size)
            # The last equation of kind j gives the load P_j of one spot: P_j/E* is the integral of
            # w_j, the transform of the displacement.
            matrix[row, row] = 1.0
            matrix[row, at] = weights
            matrix[row, self.at_delta] = -2.0 * a
            for k in self.active:
                matrix[row, self.at_force[k]] -= (
                    2.0 * self.kinds[k].density * kind.around[k].outside_integral(a)
                )
            right[row] = -2.0 * (a * kind.depth + kind.profile.line_integral(a))
        matrix[-1], right[-1] = condition(self)
        # Rows and columns have different units. So each row, and then each column, is scaled: its
        # largest entry becomes 1.
        rows = 1.0 / np.max(np.abs(matrix), axis=1)
        columns = 1.0 / np.max(np.abs(matrix * rows[:, None]), axis=0)
        matrix, right = matrix * rows[:, None] * columns, right * rows
        unknown = np.linalg.solve(matrix, right)
        # The rows of the matrix that belong to a tiny spot have much smaller terms than other rows.
        # One step of iterative refinement makes the error small in each row (Skeel 1980, doi
        # 10.1090/S0025-5718-1980-0572859-4).
        unknown += np.linalg.solve(matrix, right - matrix @ unknown)
        return self._state(columns * unknown)

    def _state(self, unknown: Array) -> State:
        delta = float(unknown[self.at_delta])
        forces, edges = np.zeros(len(self.kinds)), np.zeros(len(self.kinds))
        sources = {}
        for i in self.active:
            forces[i] = unknown[self.at_force[i]]
            (t, weights), (s, rough) = self.smooth[i], self.rough[i]
            sources[i] = (
                np.concatenate([t, s]),
                np.concatenate([weights * (self.w[i] @ np.append(unknown, 1.0)), rough]),
            )
        surfaces = []
        for j, kind in enumerate(self.kinds):
            seen = {i: kind.around[i] for i in self.active}
            acting = tuple(
                Source(*sources[i], around.kernel)
                for i, around in seen.items()
                if around.kernel is not None
            )
            nominal = tuple(
                (2.0 * self.kinds[i].density * forces[i], around)
                for i, around in seen.items()
                if around.circle > 0
            )
            surfaces.append(Surface(acting, nominal))
            if j in self.active:
                a = self.radii[j]
                edges[j] = (
                    delta - kind.depth - float(kind.profile.line(a)) - float(surfaces[j].value(a))
                )
        return State(self.radii.copy(), forces, edges, delta, tuple(surfaces))


def touching(radii: Array) -> list[int]:
    """The indices of the kinds in contact: those with a positive radius."""
    return [int(j) for j in np.flatnonzero(radii > 0)]


def total_load(pressure_over_E: float) -> Condition:
    """The condition that all loads per unit area, sum_j N_j P_j, add up to the nominal pressure."""
    return lambda linear: (
        linear.row({linear.at_force[j]: linear.kinds[j].density for j in linear.active}),
        pressure_over_E,
    )


def force(kind: int, force_over_E: float) -> Condition:
    """The side condition that each spot of one kind carries a given load."""
    return lambda linear: (linear.row({linear.at_force[kind]: 1.0}), force_over_E)


def closed_edge(kind: int) -> Condition:
    """The condition that w_j is 0 at the edge of a spot of kind j.
    w_j is the Abel transform of the displacement that the spot causes under itself.

    For radius 0, the condition says that the tip lies on the deformed surface and carries no load.
    """

    def row(linear: Linear) -> tuple[Array, float]:
        at = linear.radii[[kind]]
        rows = linear.displaced(kind, at, linear.e(kind, at))[0]
        return rows[:-1], (float(linear.kinds[kind].profile.line(at)[0]) if at[0] else 0.0) - float(
            rows[-1]
        )

    return row


def approach(delta: float) -> Condition:
    """The side condition that the approach of the surfaces equals delta."""
    return lambda linear: (linear.row({linear.at_delta: 1.0}), delta)


def solve_radii(kinds: Sequence[Kind], start: Array, condition: Condition, n: int) -> State:
    """Solution of the system, with the radii of the spots found by Newton's method.
    Spots whose initial radius is 0 stay out of contact.
    """
    radii = np.array(start, dtype=np.float64)
    active = touching(radii)
    trace = []
    for _ in range(_OPTIONS.max_steps):
        state = Linear(kinds, radii, n).solve(condition)
        steps, rounding = np.zeros_like(radii), True
        for j in active:
            a = radii[j]
            slope = float(kinds[j].profile.line_slope(a)) + float(state.surfaces[j].slope(a))
            # Newton's step needs a positive slope at the edge. If the slope is not positive, the
            # radius is doubled or halved.
            steps[j] = state.edges[j] / slope if slope > 0 else np.copysign(a, state.edges[j])
            size = abs(state.delta) + kinds[j].depth
            # For tiny spots round-off keeps the step above its tolerance. So the iteration also
            # ends if the residual w(a) at every edge is only round-off of the approach and the
            # depth (`size`).
            rounding &= bool(abs(state.edges[j]) <= 4 * EPS * size)
        steps[active] = np.clip(steps[active], -0.5 * radii[active], radii[active])
        trace.append(float(np.max(np.abs(steps[active] / radii[active]))))
        if trace[-1] <= _OPTIONS.converged_step or rounding:
            return state
        while room(kinds, radii + steps) <= 0:
            steps *= 0.5
        # A step that would use up more than three quarters of the room between the spots is halved.
        if room(kinds, radii + steps) < 0.25 * room(kinds, radii):
            steps *= 0.5
        radii = radii + steps
        # The spots are about to merge. The room between them is below the square root of round-off,
        # so that the kernel's square root of the room has lost half of its digits.
        if room(kinds, radii) < sqrt(EPS):
            raise OutOfRange(
                "the control value is out of range: the spots would merge with their neighbours "
                "before it is reached"
            )
    raise NotConverged(
        f"the radii of the spots did not converge in {_OPTIONS.max_steps} steps (relative size of "
        f"the last step: {trace[-1]:.2e})",
        trace,
    )


def room(kinds: Sequence[Kind], radii: Array) -> float:
    """Relative room between the spots.
    It is the least of 1 - (sum of two radii) / distance and of 1 - radius / `circle`.

    The number is at most 0 if two spots meet or a spot reaches its circle.
    """
    taken = [0.0]
    for j in touching(radii):
        for i in touching(radii):
            seen = kinds[j].around[i]
            if seen.kernel is not None:
                taken.append((radii[j] + radii[i]) / seen.kernel.nearest)
            if seen.circle > 0:
                taken.append(radii[j] / seen.circle)
    return float(1.0 - max(taken))
