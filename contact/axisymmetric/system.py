r"""Spots of one or several kinds that carry each other's neighbours: the second-kind equation, and
Newton for the radii.

With w_j(x), |x| <= a_j, the Abel transform of kind j's own displacement (P_j = E* int w_j, p_j =
-(E*/pi) int w_j'/sqrt),

    w_j(x) = delta - d_j - g_j(x) - e_j(x) + sum_i (2 N_i P_i/E*) sqrt(A_ji^2 - x^2),
    e_j(x) = (1/pi) sum_i int_-a_i^a_i w_i(t) K_ji(x - t) dt,

g_j the profile's transform, d_j the depth of its tip, K and A from `neighbours`. For given radii
this is linear in e_j at Gauss nodes, the loads and delta, closed by one side condition: a total
load, w = 0 at the edge, or a tip that just touches. The right radii have w_j(a_j) = 0. A shift of
a_j changes the integrals by w_j(a_j) da_j only, which vanishes there: the Jacobian of the edge
values is diagonal, w_j'(a_j), and a_j -> a_j - w_j(a_j)/w_j'(a_j) is Newton's step, under any side
condition.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from contact.axisymmetric.neighbours import NeighbourKernel, Surroundings
from contact.axisymmetric.profiles import AxisymmetricProfile
from contact.axisymmetric.quadrature import half_gauss, panels
from contact.errors import NotConverged, OutOfRange
from sie import Array

_STEPS = 100
_SETTLED = 1e-13  # relative step of the radii: the next one would be its square
_ROUNDING = 1e-15  # of w at an edge, to the approach: a spot just born settles no further


@dataclass(frozen=True)
class Kind:
    """Spots of one profile, tip depth and density [1/m^2]; around: the spots of every kind as seen
    from one of these.
    """

    profile: AxisymmetricProfile
    depth: float
    density: float
    around: Sequence[Surroundings]


@dataclass(frozen=True)
class Source:
    """One kind's w at quadrature nodes 0 < t < a, acting through a kernel."""

    nodes: Array
    weighted: Array  # 2 x weight x w: summing it gives P/E*
    kernel: NeighbourKernel

    def value(self, x: Array) -> Array:
        """Its part of e(x)."""
        return both_sides(self.kernel.value, x, self.nodes) @ self.weighted / (2.0 * pi)

    def slope(self, x: Array) -> Array:
        return both_sides(self.kernel.slope, x, self.nodes) @ self.weighted / (2.0 * pi)


def both_sides(function: Callable[[Array], Array], x: Array, t: Array) -> Array:
    """function(x - t) + function(x + t), t along a new last axis."""
    return np.asarray(function(x[..., None] - t) + function(x[..., None] + t))


@dataclass(frozen=True)
class Surface:
    """What all the other spots do to one: the Abel transform of the displacement they make, from
    the mean plane.
    """

    sources: tuple[Source, ...]
    nominal: tuple[tuple[float, Surroundings], ...]  # 2 N P/E* outside its circle

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
        """That of the neighbours kept, without the nominal pressure: smooth up to D - a."""
        return sum((source.slope(np.asarray(x)) for source in self.sources), np.zeros(np.shape(x)))


@dataclass(frozen=True)
class State:
    """A solved system: radii, P/E* and w(a) of every kind (0 where it does not touch), delta, and
    what acts on whom.
    """

    radii: Array
    forces: Array
    edges: Array
    delta: float
    surfaces: tuple[Surface, ...]


# A side condition: the last row of the system, and its right-hand side.
Condition = Callable[["Linear"], tuple[Array, float]]


class Linear:
    """The linear system at given radii; the unknowns are e at the nodes of every touching kind,
    P/E*, and delta.

    What is linear in them is kept as rows: the factors of the unknowns, and a constant last.
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
        # w at nodes and 2 x weights: all of it but the profile's g, and that, which need not be
        # smooth.
        self.smooth = {j: (radii[j] * self.unit, 2.0 * radii[j] * self.weight) for j in self.active}
        self.rough = {j: self._rough(j) for j in self.active}
        every = np.eye(self.size + 1)
        self.w = {j: self.displaced(j, self.smooth[j][0], every[self.at_e[j]]) for j in self.active}

    def _rough(self, j: int) -> tuple[Array, Array]:
        """Nodes and 2 x weights x -g."""
        a, profile = float(self.radii[j]), self.kinds[j].profile
        nodes, weights = panels([0.0, *(min(b, a) for b in profile.breakpoints), a])
        return nodes, -2.0 * weights * profile.line(nodes)

    def displaced(self, j: int, x: Array, e: Array) -> Array:
        """w_j(x) but for g_j, by e_j(x): rows."""
        rows = -e
        rows[:, self.at_delta] += 1.0
        rows[:, -1] -= self.kinds[j].depth
        for k in self.active:
            rows[:, self.at_force[k]] += (
                2.0 * self.kinds[k].density * self.kinds[j].around[k].outside(x)
            )
        return rows

    def e(self, j: int, x: Array) -> Array:
        """e_j(x): rows."""
        rows = np.zeros((x.size, self.size + 1))
        for i in self.active:
            kernel = self.kinds[j].around[i].kernel
            if kernel is not None:
                (t, weights), (s, rough) = self.smooth[i], self.rough[i]
                rows += both_sides(kernel.value, x, t) * weights @ self.w[i] / (2.0 * pi)
                rows[:, -1] += both_sides(kernel.value, x, s) @ rough / (2.0 * pi)
        return rows

    def row(self, at: Mapping[int, float]) -> Array:
        """A row over the unknowns, zero elsewhere."""
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
            # P_j/E* = int w_j
            matrix[row, row] = 1.0
            matrix[row, at] = weights
            matrix[row, self.at_delta] = -2.0 * a
            for k in self.active:
                matrix[row, self.at_force[k]] -= (
                    2.0 * self.kinds[k].density * kind.around[k].outside_integral(a)
                )
            right[row] = -2.0 * (a * kind.depth + kind.profile.line_integral(a))
        matrix[-1], right[-1] = condition(self)
        # Rows and columns have units; bring each row, then each column, to size one.
        rows = 1.0 / np.max(np.abs(matrix), axis=1)
        columns = 1.0 / np.max(np.abs(matrix * rows[:, None]), axis=0)
        matrix, right = matrix * rows[:, None] * columns, right * rows
        unknown = np.linalg.solve(matrix, right)
        # The rows of a spot just born have terms far smaller than others: elimination is exact to
        # the largest term of all, and with one step of refinement to the largest of each row (Skeel
        # 1980, doi 10.1090/S0025-5718-1980-0572859-4).
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
    """The kinds that are in contact: of a radius."""
    return [int(j) for j in np.flatnonzero(radii > 0)]


def total_load(pressure_over_E: float) -> Condition:
    """sum_j N_j P_j = nominal pressure."""
    return lambda linear: (
        linear.row({linear.at_force[j]: linear.kinds[j].density for j in linear.active}),
        pressure_over_E,
    )


def force(kind: int, force_over_E: float) -> Condition:
    """P_j given."""
    return lambda linear: (linear.row({linear.at_force[kind]: 1.0}), force_over_E)


def closed_edge(kind: int) -> Condition:
    """w_j(a_j) = 0 at the radius given; of a kind that carries nothing yet at its tip, which is on
    the deformed surface.
    """

    def row(linear: Linear) -> tuple[Array, float]:
        at = linear.radii[[kind]]
        rows = linear.displaced(kind, at, linear.e(kind, at))[0]
        return rows[:-1], (float(linear.kinds[kind].profile.line(at)[0]) if at[0] else 0.0) - float(
            rows[-1]
        )

    return row


def approach(delta: float) -> Condition:
    """delta given."""
    return lambda linear: (linear.row({linear.at_delta: 1.0}), delta)


def refine_topology(kinds: Sequence[Kind], start: Array, condition: Condition, n: int) -> State:
    """Newton's radii from a start; 0 marks a kind that does not touch."""
    radii = np.array(start, dtype=np.float64)
    active = touching(radii)
    trace = []
    for _ in range(_STEPS):
        state = Linear(kinds, radii, n).solve(condition)
        steps, rounding = np.zeros_like(radii), True
        for j in active:
            a = radii[j]
            slope = float(kinds[j].profile.line_slope(a)) + float(state.surfaces[j].slope(a))
            # A profile flat at a, or one pushed from beside, has no step of Newton's: a doubling
            # finds its way.
            steps[j] = state.edges[j] / slope if slope > 0 else np.copysign(a, state.edges[j])
            rounding &= bool(abs(state.edges[j]) <= _ROUNDING * (abs(state.delta) + kinds[j].depth))
        steps[active] = np.clip(steps[active], -0.5 * radii[active], radii[active])
        trace.append(float(np.max(np.abs(steps[active] / radii[active]))))
        if trace[-1] <= _SETTLED or rounding:
            return state
        while room(kinds, radii + steps) <= 0:
            steps *= 0.5
        # Not onto the limit itself: half of what is left, at most.
        if room(kinds, radii + steps) < 0.25 * room(kinds, radii):
            steps *= 0.5
        radii = radii + steps
        if room(kinds, radii) < 1e-7:
            raise OutOfRange(
                "out of range: the spots would grow into their neighbours before this is reached"
            )
    raise NotConverged(
        f"the radii have not settled in {_STEPS} steps (last {trace[-1]:.2e})", trace
    )


def room(kinds: Sequence[Kind], radii: Array) -> float:
    """What is left, relative, before spots meet their neighbours or their circle; <= 0: they do."""
    taken = [0.0]
    for j in touching(radii):
        for i in touching(radii):
            seen = kinds[j].around[i]
            if seen.kernel is not None:
                taken.append((radii[j] + radii[i]) / seen.kernel.nearest)
            if seen.circle > 0:
                taken.append(radii[j] / seen.circle)
    return float(1.0 - max(taken))
