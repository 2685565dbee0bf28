"""The rows of the equation kappa phi + T phi = g on given zones.

The unknowns are, for each zone, the coefficients c_0 ... c_m of the functions S_n (see
`sie.basis.weighted`), and the amplitudes lambda of the columns. A zone's own part of the left side
is -sum c_n D_(n-1) with polynomials D. So the rows are, at the m zeros of U_m on each zone,

    -sum c_n D_(n-1) + (field of other zones, images and regular part) - sum lambda C = g,

each multiplied by sin(theta) of its node.
"""

from collections.abc import Callable, Iterator
from functools import cached_property

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Index, record
from sie.basis.interval import sides
from sie.basis.kernels import Kernel, regular_size
from sie.basis.lag_table import regular_values
from sie.basis.weighted import JacobiFunctions
from sie.basis.zones import Zones
from sie.dense.modes import OPTIONS as MODES
from sie.dense.system import Layout, Places, Targets
from sie.equation.conditions import Linear, Rows
from sie.equation.equation import Equation
from sie.jumps.logarithms import Logarithms
from sie.second_kind.jumps import Known


def bases_of(zones: Zones) -> list[JacobiFunctions]:
    """The basis functions S_n (weight times polynomial) of each zone, from the zone's kappa."""
    kappa = zones.weight.kappa
    assert kappa is not None
    return [JacobiFunctions(one) for one in kappa.tolist()]


def alike(zones: Zones, m: Index) -> Iterator[tuple[JacobiFunctions, int, Index]]:
    """Groups of zones with the same kappa and the same highest mode: (basis, mode, zones)."""
    kappa, bases = zones.weight.kappa, bases_of(zones)
    assert kappa is not None
    kinds = set(zip(kappa.tolist(), m.tolist(), strict=True))
    for k, highest in sorted(kinds, key=lambda kind: (kind[0].real, kind[0].imag, kind[1])):
        group = np.flatnonzero((kappa == k) & (m == highest))
        yield bases[group[0]], int(highest), group


def nodes(zones: Zones, m: Index) -> tuple[Targets, Array]:
    """(the zeros of U_m on each zone, sin(theta) of these nodes)."""
    every = Targets.lobatto(zones, np.arange(len(zones)), m)
    inner = np.concatenate([np.arange(n + 2) % (n + 1) > 0 for n in m.tolist()])
    sines = [np.sin(chebyshev.angles(n)[1:-1]) for n in m.tolist()]
    points = Targets(every.zone[inner], every.left[inner], every.right[inner], every.x[inner])
    return points, np.concatenate(sines)


def targets_at(zones: Zones, theta: Array) -> Targets:
    """The points of each zone at its angles theta (Z, points)."""
    zone = np.repeat(np.arange(len(zones)), theta.shape[1])
    half = zones.half[:, None]
    left, right = ((half * side).ravel() for side in sides(theta))
    x = np.where(left <= right, zones.a[zone] + left, zones.b[zone] - right)
    return Targets(zone, left, right, x)


def fields(zones: Zones, kernel: Kernel, targets: Targets | Places, layout: Layout) -> Array:
    """Left side kappa phi + T phi at points, for a unit of each coefficient (points, unknowns)."""
    numbers = zones.weight.numbers
    out = np.zeros((len(targets.x), layout.size), dtype=numbers)
    for basis, m, sources in alike(zones, layout.m):
        block = np.zeros((len(targets.x), len(sources), m + 1), dtype=numbers)
        for shift in kernel.poles:
            seen, others = targets.relative_to(zones, sources, shift)
            if others is not None and len(zones) == 1:
                continue
            table = basis.transforms(m + 1, seen)
            block += table if others is None else table * others[..., None]
        out[:, layout.offset[sources][:, None] + np.arange(m + 1)] = block
    if isinstance(targets, Targets):
        _add_own(out, zones, targets, layout)
    if kernel.regular is not None:
        out += regular_fields(zones, kernel, targets.x, layout)
    return out


def _add_own(out: Array, zones: Zones, targets: Targets, layout: Layout) -> None:
    """Add to `out`, a table of `fields`, the left side on each zone due to its own density."""
    for i, basis in enumerate(bases_of(zones)):
        here, m, first = np.flatnonzero(targets.zone == i), int(layout.m[i]), layout.offset[i]
        w = zones.half[i]
        table = basis.images.table(m, targets.left[here] / w, targets.right[here] / w)
        out[here, first + 1 : first + m + 1] -= table


def regular_fields(
    zones: Zones, kernel: Kernel, x: Array, layout: Layout, potential: bool = False
) -> Array:
    """Part of transform or potential due to the kernel's regular part (points, unknowns).

    Each column belongs to a unit of one unknown.
    """
    out = np.zeros((len(x), layout.size), dtype=zones.weight.numbers)
    for basis, m, sources in alike(zones, layout.m):
        for i in sources.tolist():
            w = float(zones.half[i])
            means, first = (
                regular_means(kernel, (zones.middle[i], w, m), x, potential),
                layout.offset[i],
            )
            out[:, first : first + m + 1] = w * (means @ basis.moments(m + 1, means.shape[1]))
    return out


def regular_means(
    kernel: Kernel, zone: tuple[float, float, int], x: Array, potential: bool
) -> Array:
    """Means over a zone of the kernel's regular part times T_l, at points x (points, l).

    The mean is taken over the zone's angle theta. zone: its middle, half width and highest mode;
    potential: whether the regular part of the potential takes the place of the kernel's.
    """
    middle, w, m = zone
    q = regular_size(kernel, w, m)
    values = regular_values(kernel, x, middle + w * chebyshev.gauss(q), potential)
    return chebyshev.t_means(values, q)


def potentials(zones: Zones, kernel: Kernel, targets: Targets, layout: Layout) -> Array:
    """Potential of a unit of each unknown coefficient at points on the zones (points, unknowns).

    On the zone itself, kappa times the integral of its density up to the point is added.
    """
    numbers = zones.weight.numbers
    out = np.zeros((len(targets.x), layout.size), dtype=numbers)
    for basis, m, sources in alike(zones, layout.m):
        block = np.zeros((len(targets.x), len(sources), m + 1), dtype=numbers)
        w = zones.half[sources]
        for shift in kernel.poles:
            seen, others = targets.relative_to(zones, sources, shift)
            table = basis.potentials(m + 1, seen)
            table[..., 0] += np.log(w / kernel.datum)
            block += table if others is None else table * others[..., None]
        out[:, layout.offset[sources][:, None] + np.arange(m + 1)] = block * w[:, None]
    for i, basis in enumerate(bases_of(zones)):
        here, m, first = np.flatnonzero(targets.zone == i), int(layout.m[i]), layout.offset[i]
        left, right, w = targets.left[here], targets.right[here], zones.half[i]
        table = -basis.singular.mirrored.table(m + 1, left / w, right / w)
        table[:, 1:] /= np.arange(1, m + 1)
        table[:, 0] = basis.level + np.log(w / kernel.datum)
        out[here, first : first + m + 1] += w * table
    if kernel.regular is not None:
        if kernel.regular_potential is None:
            raise ValueError(
                "a condition on potentials needs the potential of the regular kernel: "
                "sie.Smooth(value, potential)"
            )
        out += regular_fields(zones, kernel, targets.x, layout, potential=True)
    return out


@record
class SecondKindRows(Rows):
    """Matrix rows of the equation, and of the quantities that side conditions use (see `Rows`)."""

    equation: Equation
    zones: Zones
    layout: Layout
    jumps: tuple[Known, ...]

    @cached_property
    def beside(self) -> Logarithms | None:
        """Logarithms of the right side due to plateaus of the density beside zones; else None."""
        zones = self.zones
        return Logarithms.of_plateaus(zones, self.equation.kernel) if zones.have_values else None

    @cached_property
    def points(self) -> tuple[Targets, Array]:
        """(the nodes of all zones, sin(theta) of each node)."""
        return nodes(self.zones, self.layout.m)

    def rows(self) -> tuple[Array, Array]:
        """(matrix, right side) of the equation at the nodes; rows are multiplied by sin(theta)."""
        targets, sines = self.points
        return sines[:, None] * self.left_side(targets), sines * self.right_side(targets)

    def right_side(self, targets: Targets) -> Array:
        """Right side for the smooth part of the density, at points on the zones.

        It is the given right side minus the left side for the closed-form parts of the density,
        which jumps of the right side and given values at ends cause.
        """
        out = self.forcing_at(targets)
        zones, kernel = self.zones, self.equation.kernel
        if self.beside is not None:
            left = targets.left / zones.half[targets.zone]
            out += self.beside.on_zones(targets.zone, left)
            out += self.beside.near.own_transform(targets.zone, left)
        for one in self.jumps:
            w, own = zones.half[one.zone], targets.zone == one.zone
            out[own] -= one.own(targets.left[own] / w, targets.right[own] / w)
            for shift in kernel.poles:
                seen, others = targets.relative_to(zones, np.array([one.zone]), shift)
                value = one.transform(seen)[:, 0]
                out -= value if others is None else value * others[:, 0]
            if kernel.regular is not None:
                of_zone = zones.middle[one.zone], float(w), int(self.layout.m[one.zone])
                means = regular_means(kernel, of_zone, targets.x, False)
                out -= w * (means @ one.moments(means.shape[1]))
        return out

    def forcing_at(self, targets: Targets) -> Array:
        """The right side g of the equation, with its jumps, at points on the zones."""
        numbers = self.zones.weight.numbers
        g = np.asarray(self.equation.forcing.value(targets.x), dtype=numbers)
        return np.broadcast_to(g, targets.x.shape).copy()

    def left_side(self, targets: Targets | Places) -> Array:
        """Left side of the equation at points, for a unit of each unknown (points, unknowns).

        An unknown amplitude contributes minus its column.
        """
        out = fields(self.zones, self.equation.kernel, targets, self.layout)
        for number, column in enumerate(self.equation.columns):
            out[:, self.layout.coefficients + number] = -np.asarray(column.value(targets.x))
        return out

    def _by_zone(self, of_zone: Callable[[int, JacobiFunctions, int], Array]) -> Linear:
        """(matrix, zeros): row i has of_zone(i, basis, m) at the coefficients of zone i, else 0."""
        out = np.zeros((len(self.zones), self.layout.size), dtype=self.zones.weight.numbers)
        for i, basis in enumerate(bases_of(self.zones)):
            m, first = int(self.layout.m[i]), self.layout.offset[i]
            out[i, first : first + m + 1] = of_zone(i, basis, m)
        return out, np.zeros(len(self.zones))

    def totals(self) -> Linear:
        half, known = self.zones.half, np.zeros(len(self.zones))
        for one in self.jumps:
            known[one.zone] += half[one.zone] * one.total
        rows, _ = self._by_zone(lambda i, basis, m: np.pi * half[i] * (np.arange(m + 1) == 0))
        return rows, known

    def integrals(self, weight: Callable[[Array], Array], degree: int | None = None) -> Linear:
        known = np.zeros(len(self.zones))

        def of_zone(i: int, basis: JacobiFunctions, m: int) -> Array:
            means = self.means(weight, i, m + 1 if degree is None else degree + 1)
            means = np.pi * self.zones.half[i] * means
            for one in self.jumps:
                if one.zone == i:
                    known[i] += means @ one.moments(len(means))
            return np.asarray(means @ basis.moments(m + 1, len(means)))

        return self._by_zone(of_zone)[0], known

    def means(self, weight: Callable[[Array], Array], zone: int, count: int) -> Array:
        """Means of `weight` times T_l over the angle theta of a zone.

        They are computed up to the l at which they have decayed.
        """
        size = max(count, MODES.first_nodes)
        while True:
            x = self.zones.middle[zone] + self.zones.half[zone] * chebyshev.gauss(size)
            means = chebyshev.t_means(np.broadcast_to(np.asarray(weight(x), dtype=float), x.shape))
            last = float(np.abs(means[-4:]).max())
            if last <= 1e-14 * float(np.abs(means).max()) or size >= MODES.max_nodes:
                return means
            size *= 2

    def intensities(self) -> tuple[Linear, Linear]:
        scale = self.zones.edge_scale
        left = self._by_zone(lambda i, basis, m: scale[0, i] * basis.edge_values(m + 1)[0])
        right = self._by_zone(lambda i, basis, m: scale[1, i] * basis.edge_values(m + 1)[1])
        return left, right

    def levels(self) -> Linear:
        """Level of each zone: a constant that follows from the density phi and the right side g.

        On a zone, the following sum is constant: the potential, plus the integral of kappa phi from
        the left end of the first zone, minus the primitives of g and of the columns (times their
        amplitudes). The level is the mean of this sum over the nodes of the zone.
        """
        return self._levels

    @cached_property
    def _levels(self) -> Linear:
        equation, zones, layout = self.equation, self.zones, self.layout
        if equation.forcing.primitive is None or any(c.primitive is None for c in equation.columns):
            raise ValueError(
                "a condition on potentials needs the primitives of the right side and of columns"
            )
        targets, _ = self.points
        out = potentials(zones, equation.kernel, targets, layout)
        for number, column in enumerate(equation.columns):
            assert column.primitive is not None
            out[:, layout.coefficients + number] = -np.asarray(column.primitive(targets.x))
        primitive = equation.forcing.primitive(targets.x)
        constants = -np.asarray(primitive, dtype=zones.weight.numbers)
        constants += self._known_potential(targets)
        starts = np.cumsum(layout.m) - layout.m
        rows = np.add.reduceat(out, starts, axis=0) / layout.m[:, None]
        kappa = zones.weight.kappa
        assert kappa is not None
        before = np.tril(np.ones((len(zones), len(zones))), -1) * kappa
        totals, known = self.totals()
        rows += before @ totals
        return rows, np.add.reduceat(constants, starts) / layout.m + before @ known

    def _known_potential(self, targets: Targets) -> Array:
        """Potential of the densities that jumps of the right side cause, at points on the zones.
        On the zone of a jump, kappa times the integral of the jump's density is added.
        """
        zones, kernel, out = self.zones, self.equation.kernel, np.zeros(len(targets.x))
        for one in self.jumps:
            w, own = zones.half[one.zone], targets.zone == one.zone
            level = one.total / np.pi * np.log(w / kernel.datum)
            out[own] += w * (level + one.own_level(targets.left[own] / w, targets.right[own] / w))
            for shift in kernel.poles:
                seen, others = targets.relative_to(zones, np.array([one.zone]), shift)
                value = w * (level + one.potential(seen)[:, 0])
                out += value if others is None else value * others[:, 0]
            if kernel.regular is not None:
                of_zone = zones.middle[one.zone], float(w), int(self.layout.m[one.zone])
                means = regular_means(kernel, of_zone, targets.x, True)
                out += w * (means @ one.moments(means.shape[1]))
        return out

    def on_plateaus(self, weight: Callable[[Array], Array] | None = None) -> float:
        if self.beside is None or self.beside.plateaus is None:
            return 0.0
        plateaus = self.beside.plateaus
        return plateaus.total if weight is None else plateaus.integral(weight)

    def amplitude(self, k: int) -> Linear:
        row = np.zeros((1, self.layout.size))
        row[0, self.layout.amplitude(k)] = 1.0
        return row, np.zeros(1)
