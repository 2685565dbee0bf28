"""The rows of the equation on zones with graded coordinates.

On each zone the density is F(s) / (sqrt(1 - s^2) dx/ds), with the graded coordinate s of
`sie.graded.grading`. The unknowns are the values F_k of F at the n zeros s_k of T_n. They are
called charges: the integral of the density over the zone is pi/n sum F_k. Gauss's rule also holds
for the principal value at the n - 1 zeros s_r of U_(n-1) (F. Erdogan and G. D. Gupta, Quart. Appl.
Math. 29, 1972, 525-534). By this rule, the equation is

    sum_k (F_k / n) (dx/ds)_r K(x_r, x_k) - (dx/ds)_r sum lambda C(x_r) = (dx/ds)_r g(x_r),

with the kernel K, the columns C of unknown amplitudes lambda, and the right side g. The first sum
runs over the nodes of all zones. Rows are multiplied by dx/ds, so that all are of the size of
charges. Differences x_r - x_k are computed from distances from ends and from the widths of gaps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import EPS, SUM_ROUNDING, Array, Index, Kept, sum_error
from sie.basis.kernels import Kernel
from sie.basis.lag_table import regular_values
from sie.basis.weight import needs_half
from sie.basis.zones import Zones
from sie.dense.modes import gaps, place_rounding
from sie.dense.system import Layout
from sie.equation.conditions import Linear, Rows
from sie.equation.equation import Equation
from sie.equation.forcing import Forcing
from sie.graded.closed_parts import ClosedParts, Seen
from sie.graded.grading import Grading, Places, collocation, gauss
from sie.jumps.right_side import ForcingJumps


@dataclass(frozen=True)
class GradedOptions:
    """Limits for the use of graded coordinates, which are finer next to narrow gaps.
    Numbers of modes and unknowns are limited, too.
    """

    # A gap next to a fixed end is narrow if its width is below this fraction of the wider adjacent
    # zone. Series in the coordinate t of a zone then need 200 modes or more, series in the graded
    # coordinate 50. Insensitive: half or twice this value changes only computing times.
    max_gap: float = 0.005
    # Up to this number of unknowns, the coordinate t of a zone is as fast as a graded one. Levels
    # (constant parts of the potential on zones) have more digits with the coordinate t.
    min_plain_unknowns: int = 900
    # In the graded coordinate of a zone, a gap wider than this multiple of the zone's width counts
    # as this multiple. So the coordinate is defined next to infinite gaps, too. Next to such gaps
    # it is nearly linear.
    max_grading_gap: float = 1.0
    # Number of modes of a zone that resolve the right side, in addition to the modes that resolve
    # fields across the gaps.
    extra_modes: int = 8
    # If a zone has too few modes, the rate of decay of its coefficients gives a larger number for
    # the next solution. `growth` is a safety factor of this number.
    growth: float = 1.1
    # Largest number of modes of one zone, and of all zones together. A matrix with `max_unknowns`
    # columns takes some seconds.
    max_modes: int = 1024
    max_unknowns: int = 4000


OPTIONS = GradedOptions()


def gradings_of(zones: Zones, kernel: Kernel) -> list[Grading]:
    """The graded coordinate of each zone, determined by the widths of the gaps beside it."""
    width = 2 * zones.half
    least = np.finfo(float).tiny / np.finfo(float).eps
    before, after = (
        np.clip(gap, least, OPTIONS.max_grading_gap * width) for gap in exact_gaps(zones, kernel)
    )
    return [
        Grading(*one) for one in zip(width.tolist(), before.tolist(), after.tolist(), strict=True)
    ]


def resolving_sizes(gradings: list[Grading]) -> Index:
    """Number of modes of each zone that resolve functions with singularities at complex places.
    The singularities are at the distance pi / `stretch` from the real axis of the graded coordinate
    s.
    """
    stretch = np.array([one.stretch for one in gradings])
    return even_sizes(-np.log(EPS) / np.arcsinh(np.pi / stretch) + OPTIONS.extra_modes)


def first_sizes(gradings: list[Grading]) -> Index:
    """Number of modes with which each zone is solved first.

    Fields of one zone on the next one, across a gap, are singular at the distance pi/B from the
    real axis of the graded coordinate s, with B = `stretch`. So Gauss's rule with n nodes
    integrates them with an error of exp(-2 n asinh(pi/B)).
    """
    stretch = np.array([one.stretch for one in gradings])
    return even_sizes(-np.log(EPS) / (2 * np.arcsinh(np.pi / stretch)) + OPTIONS.extra_modes)


def even_sizes(count: Array) -> Index:
    """For each number in `count`, the smallest even number that is not below it."""
    return 2 * np.ceil(0.5 * count).astype(np.intp)


def exact_gaps(zones: Zones, kernel: Kernel) -> tuple[Array, Array]:
    """Widths of the gaps left and right of each zone, accurate also for very narrow gaps.
    The digits of the ends beyond double precision, `zones.rest`, are included.
    """
    left, right = (gap.copy() for gap in gaps(zones, kernel))
    between = difference(zones.a[1:], zones.b[:-1]) + (zones.rest[0, 1:] - zones.rest[1, :-1])
    left[1:], right[:-1] = between, between
    shifts = [shift for shift in kernel.poles if shift > 0]
    if shifts:
        border = difference(zones.a[:1], zones.b[-1:], -min(shifts))
        left[0] = right[-1] = float(border[0] + zones.rest[0, 0] - zones.rest[1, -1])
    return left, right


def difference(x: Array, y: Array, shift: float = 0.0) -> Array:
    """The difference x - y - shift with a single rounding error."""
    first = x - y
    both = first - shift
    error = sum_error(x, -y) + sum_error(first, np.full_like(first, -shift))
    return np.asarray(both + error)


class GradedSystem(Rows, Kept):
    """Matrix rows, in graded coordinates, of the equation and of quantities in side conditions.
    `Rows` lists these quantities.

    sizes: number of unknowns of each zone; jumps: jumps of the right side in the zones, whose
    densities are not among the unknowns. Matrices have a column for each node of each zone, then
    one for each column of the equation.
    """

    def __init__(self, equation: Equation, zones: Zones, sizes: Index, jumps: ForcingJumps) -> None:
        needs_half(zones.weight, "graded coordinates")
        self.closed = ClosedParts(zones, equation.kernel, jumps) if len(jumps) else None
        self.equation, self.zones, self.sizes = equation, zones, sizes
        self.gradings = gradings_of(zones, equation.kernel)
        pairs = list(zip(self.gradings, sizes.tolist(), strict=True))
        self.sources = [gauss(grading, n) for grading, n in pairs]
        self.targets = [collocation(grading, n) for grading, n in pairs]
        self.layout = Layout(sizes - 1, len(equation.columns))
        self.offset, self.nodes, self.size = (
            self.layout.offset,
            self.layout.coefficients,
            self.layout.size,
        )

    @cached_property
    def zone_of(self) -> Index:
        """Index of the zone of each source (quadrature node)."""
        return np.repeat(np.arange(len(self.zones)), self.sizes)

    @cached_property
    def weights(self) -> Array:
        """For each source (quadrature node), 1/n with the number n of sources on its zone."""
        return np.asarray(1.0 / self.sizes[self.zone_of])

    @cached_property
    def from_ends(self) -> tuple[Array, Array]:
        """Distances of all sources (quadrature nodes) from both ends of their zones."""
        return (
            np.concatenate([one.from_a for one in self.sources]),
            np.concatenate([one.from_b for one in self.sources]),
        )

    @cached_property
    def source_x(self) -> Array:
        """Positions x of all sources (quadrature nodes)."""
        return np.concatenate([self.positions(i, one) for i, one in enumerate(self.sources)])

    def positions(self, zone: int, places: Places) -> Array:
        """Positions x of the given `places` on a zone."""
        start, away = self._rounded(zone, places)
        return np.asarray(start + away)

    def _rounded(self, zone: int, places: Places) -> tuple[Array, Array]:
        """For points of a zone: position of the nearer end, and signed distance from this end."""
        zones, left = self.zones, places.from_a <= places.from_b
        start = np.where(left, zones.a[zone], zones.b[zone])
        rest = np.where(left, zones.rest[0, zone], zones.rest[1, zone])
        return start, np.where(left, places.from_a, -places.from_b) + rest

    # The methods below give the fields that all sources (quadrature nodes) cause on one zone.
    def gaps_from(self, zone: int, shift: float) -> tuple[Array, Array]:
        """(distances (Z,) of a zone from moved zones on its left, from moved zones on its right).

        All zones are moved by `shift`. A distance is negative if the moved zone lies on the
        opposite side, or is the zone itself.
        """
        zones = self.zones
        ahead = difference(np.full(len(zones), zones.a[zone]), zones.b, shift)
        behind = -difference(np.full(len(zones), zones.b[zone]), zones.a, shift)
        ahead = ahead + (zones.rest[0, zone] - zones.rest[1])
        return ahead, behind + (zones.rest[0] - zones.rest[1, zone])

    def lags(self, zone: int, places: Places, shift: float) -> Array:
        """Differences x - x' - shift of points x on a zone and all sources x' (quadrature nodes).
        The shape is (points, sources).

        Entries for the zone's own sources are meaningless if the shift is zero.
        """
        ahead, behind = self.gaps_from(zone, shift)
        z, (from_a, from_b) = self.zone_of, self.from_ends
        with np.errstate(invalid="ignore"):
            return np.where(
                (ahead >= 0)[z],
                ahead[z] + from_b + places.from_a[:, None],
                -(behind[z] + from_a + places.from_b[:, None]),
            )

    def own(self, zone: int) -> slice:
        """The matrix columns of the sources (quadrature nodes) on one zone."""
        return slice(int(self.offset[zone]), int(self.offset[zone] + self.sizes[zone]))

    def fields(self, zone: int, places: Places) -> Array:
        """Transform at points of a zone per unit of each unknown F_k, times dx/ds.
        F_k is the charge at source (quadrature node) k, and s the graded coordinate of the zone.

        The array has the shape (places, sources).

        The zone's own part is that of Gauss's rule, which is exact at collocation nodes only.
        """
        out = self.far_fields(zone, places)
        grading, own = self.gradings[zone], self.own(zone)
        out[:, own] += grading.kernel(places, self.sources[zone]) / self.sizes[zone]
        return out

    def far_fields(self, zone: int, places: Places) -> Array:
        """Transform at points of a zone per unit of each unknown, without the pole on the zone.
        The terms 1 / (x - x') between points x and sources x' of the same zone are left out. The
        transform is multiplied by dx/ds, with the graded coordinate s of the zone.
        """
        kernel, own = self.equation.kernel, self.own(zone)
        out = np.zeros((len(places.u), self.nodes))
        for shift in kernel.poles:
            with np.errstate(divide="ignore"):
                part = 1 / self.lags(zone, places, shift)
            if shift == 0.0:
                part[:, own] = 0.0
            out += part
        if kernel.regular is not None:
            out += regular_values(kernel, self.positions(zone, places), self.source_x)
        out *= places.rate[:, None] * self.weights
        return out

    def potentials(self, zone: int, places: Places) -> Array:
        """Potential at points of a zone (rows) per unit of each unknown F_k (columns).
        F_k is the charge at source (quadrature node) k.

        The term log|s - s'| of the zone's own sources s' is left out; s is the graded coordinate.
        """
        kernel, own = self.equation.kernel, self.own(zone)
        out = np.zeros((len(places.u), self.nodes))
        for shift in kernel.poles:
            with np.errstate(divide="ignore"):
                part = np.log(np.abs(self.lags(zone, places, shift)))
            if shift == 0.0:
                part[:, own] = self.gradings[zone].log_ratio(places, self.sources[zone])
            out += part - np.log(kernel.datum)
        if kernel.regular is not None:
            if kernel.regular_potential is None:
                raise ValueError(
                    "a condition on potentials needs the potential of the regular kernel: "
                    "sie.Smooth(value, potential)"
                )
            out += regular_values(kernel, self.positions(zone, places), self.source_x, True)
        return out * self.weights

    # The methods below assemble the equation on the solved zones.
    def equation_rows(self) -> tuple[Array, Array]:
        """(matrix, right side) of the equation at the collocation nodes of all solved zones.
        On symmetric zones, only the nodes of one half are used.
        """
        rows, values = [], []
        for zone in self.zones.solved.tolist():
            places = self.targets[zone]
            places = places[: self.row_count(zone)]
            matrix = np.zeros((len(places.u), self.size))
            matrix[:, : self.nodes] = self.fields(zone, places)
            x = self.positions(zone, places)
            for k, column in enumerate(self.equation.columns):
                matrix[:, self.nodes + k] = -places.rate * np.asarray(column.value(x))
            rows.append(matrix)
            values.append(places.rate * self.right_side(zone)[: len(places.u)])
        return np.concatenate(rows), np.concatenate(values)

    def row_count(self, zone: int) -> int:
        """Number of rows (collocation nodes) of the equation on a solved zone.

        On a zone about the centre of symmetry both sides of the equation are odd, so that the nodes
        on the right half of the zone are enough.
        """
        count = int(self.sizes[zone]) - 1
        return count // 2 if self.zones.central and zone == self.zones.solved[0] else count

    def right_side(self, zone: int) -> Array:
        """Right side at a zone's collocation nodes, minus the transform of the jumps' density."""
        places, forcing = self.targets[zone], self.equation.forcing
        start, away = self._rounded(zone, places)
        closed = self.closed
        smooth = 0.0 if closed is None else closed.smooth_part(zone, places)
        if float(place_rounding(self.zones, np.array([zone]))[0]) <= SUM_ROUNDING:
            values = np.asarray(forcing.value(start + away), dtype=float)
        else:
            values = forcing.sampled(
                start, away, lambda g: chebyshev.slopes(g + smooth) / places.rate
            )
        if closed is None:
            return values
        return values + smooth - closed.transforms(zone, places, start + away, self._seen(zone))

    def _seen(self, zone: int) -> list[Seen]:
        """Positions, relative to `zone`, of the zones with jumps and of their images."""
        assert self.closed is not None
        out = []
        for shift in self.equation.kernel.poles:
            ahead, behind = self.gaps_from(zone, shift)
            for i in self.closed.named:
                gap = float(max(ahead[i], behind[i]))
                out.append(Seen(i, shift, gap, bool(ahead[i] >= 0), i == zone and shift == 0.0))
        return out

    # The methods below give the rows of the quantities that side conditions use (see `Rows`).
    def _zero_rows(self) -> Array:
        return np.zeros((len(self.zones.solved), self.size))

    def _summed(self, values: Array) -> Linear:
        """Integrals over each solved zone of the density times a function.
        values: the values of the function at the sources (quadrature nodes).
        """
        rows = self._zero_rows()
        for row, zone in zip(rows, self.zones.solved, strict=True):
            own = self.own(zone)
            row[own] = np.pi * (self.weights * values)[own]
        return rows, np.zeros(len(rows))

    def totals(self) -> Linear:
        rows, constants = self._summed(np.ones(self.nodes))
        if self.closed is not None:
            constants = self.closed.density.totals[self.zones.solved]
        return rows, constants

    def integrals(self, weight: Callable[[Array], Array], degree: int | None = None) -> Linear:
        values = np.asarray(weight(self.source_x), dtype=float)
        rows, constants = self._summed(np.broadcast_to(values, (self.nodes,)))
        if self.closed is not None:
            constants = self.closed.integrals(weight)[self.zones.solved]
        return rows, constants

    def intensities(self) -> tuple[Linear, Linear]:
        left, right = self._zero_rows(), self._zero_rows()
        # The function F, whose values at the nodes are the unknowns, tends to zero next to a
        # bounded end. So F is divided by `Grading.scale`, then extrapolated to the end and
        # multiplied by the scale there.
        powers = np.isfinite(self.zones.intensities).astype(float)
        for place, zone in enumerate(self.zones.solved.tolist()):
            n, grading = int(self.sizes[zone]), self.gradings[zone]
            own = self.own(zone)
            series = chebyshev.to_series(n)
            series = series / grading.scale(self.sources[zone], powers[:, zone])[:, None]
            at_ends = grading.scale(grading.ends, powers[:, zone])
            scale = at_ends / np.sqrt(2 * grading.end_rates)
            left[place, own] = scale[0] * (series @ (1.0 - 2.0 * (np.arange(n) % 2)))
            right[place, own] = scale[1] * series.sum(axis=1)
        none = np.zeros(len(left))
        return (left, none), (right, none)

    def amplitude(self, k: int) -> Linear:
        row = np.zeros((1, self.size))
        row[0, self.layout.amplitude(k)] = 1.0
        return row, np.zeros(1)

    def levels(self) -> Linear:
        """Level of each solved zone: mean of (potential minus primitive of the right side).

        The mean has the weight 1 / sqrt(1 - s^2). With this weight, the mean of log|s - s'| over s
        is -log(2) for every s'.
        """
        return self._levels

    @cached_property
    def _levels(self) -> Linear:
        rows, constants = self._zero_rows(), np.zeros(len(self.zones.solved))
        for place, zone in enumerate(self.zones.solved.tolist()):
            parts = [self.targets[zone], self.gradings[zone].ends]
            n, own = self.sizes[zone], self.own(zone)
            # The level of a zone is a mean over the zone, computed by Lobatto's rule: an end has
            # half the weight of an inner node.
            for places, weight in zip(parts, (1.0 / n, 0.5 / n), strict=True):
                x = self.positions(zone, places)
                rows[place, : self.nodes] += weight * self.potentials(zone, places).sum(axis=0)
                for k, column in enumerate(self.equation.columns):
                    rows[place, self.nodes + k] -= weight * _primitive("every column", column, x)
                constants[place] -= weight * _primitive("the right side", self.equation.forcing, x)
                if self.closed is not None:
                    of_jumps = self.closed.potentials(zone, places, x, self._seen(zone))
                    constants[place] += weight * float(of_jumps.sum())
            rows[place, own] -= np.log(2) * self.weights[own]
        return rows, constants

    # The methods below choose the unknowns that are solved for.
    @cached_property
    def source_of(self) -> Index:
        """Index of each unknown's mirror image if only the image is solved for, else its own."""
        out = np.arange(self.size)
        if self.zones.symmetric:
            mirrored = self.nodes - 1 - np.arange(self.nodes)
            # Unknowns are ordered by zone from left to right, and from right to left in each zone.
            zone = len(self.zones) - 1 - self.zone_of
            inner = np.arange(self.nodes) - self.offset[self.zone_of]
            mirrored = self.offset[zone] + self.sizes[zone] - 1 - inner
            at_left = self.zone_of < self.zones.solved[0]
            if self.zones.central:
                at_left |= (self.zone_of == self.zones.solved[0]) & (
                    inner > mirrored - self.offset[zone]
                )
            out[: self.nodes] = np.where(at_left, mirrored, out[: self.nodes])
        return out

    @cached_property
    def kept(self) -> Index:
        """Indices of the unknowns that are solved for; on symmetric zones, half of all."""
        return np.flatnonzero(self.source_of == np.arange(self.size))

    def fold(self, matrix: Array) -> Array:
        """The matrix with columns only for the unknowns that are solved for.
        On symmetric zones, the columns of unknowns that are mirror images of each other are added.
        """
        if not self.zones.symmetric:
            return matrix
        follow = np.setdiff1d(np.arange(self.size), self.kept)
        matrix = matrix.copy()
        matrix[:, self.source_of[follow]] += matrix[:, follow]
        return np.asarray(matrix[:, self.kept])

    def unfold(self, y: Array) -> Array:
        """All unknowns, from the values y of the unknowns that are solved for.
        On symmetric zones, the other unknowns are mirror images of these.
        """
        out = np.zeros((self.size, *y.shape[1:]))
        out[self.kept] = y
        return np.asarray(out[self.source_of])

    def series(self, unknowns: Array, powers: Array | None = None) -> Array:
        """Chebyshev coefficients (zones, n) of the function F on each zone, from the unknowns.
        The unknowns are the values of F at the nodes. F is the density times sqrt(1 - s^2) dx/ds,
        with the graded coordinate s.

        powers: coefficients are those of F divided by `Grading.scale` with these powers (2, zones).
        """
        out = np.zeros((len(self.zones), int(self.sizes.max())))
        for zone, n in enumerate(self.sizes.tolist()):
            values = unknowns[self.own(zone)]
            if powers is not None:
                values = values / self.gradings[zone].scale(self.sources[zone], powers[:, zone])
            out[zone, :n] = values @ chebyshev.to_series(n)
        return out

    def powers_for(self, unknowns: Array) -> Array:
        """Powers (0 or 1) of the two factors by which the function F on each zone is divided.
        F is the density times sqrt(1 - s^2) dx/ds, with the graded coordinate s. The two factors
        are those of `Grading.scale`, one for each end. The shape of the powers is (2, zones).

        The quotient is expanded in a series, whose round-off is relative to its largest value. Next
        to a narrow gap, F may be as large as on the rest of the zone, or fall in proportion to the
        distance from the zone beyond the gap. In the first case the errors of the density times
        sqrt(1 - t^2) are least without the division, in the second case with it.
        """
        out = np.zeros((2, len(self.zones)))
        for zone, grading in enumerate(self.gradings):
            charges = np.abs(unknowns[self.own(zone)])
            for side, gap in enumerate((grading.before, grading.after)):
                divided = charges / grading.scale(self.sources[zone], np.eye(2)[side])
                largest = divided.max() * np.sqrt(gap / grading.reach)
                out[side, zone] = float(largest <= charges.max())
        return out

    def on_finer(self, unknowns: Array, powers: Array, finer: GradedSystem) -> Array:
        """The unknowns interpolated to the nodes of `finer`, a system with more nodes on the zones.

        powers: those of `powers_for`.
        """
        out = np.zeros(finer.size)
        out[finer.nodes :] = unknowns[self.nodes :]
        series = self.series(unknowns, powers)
        for zone, n in enumerate(finer.sizes.tolist()):
            scale = finer.gradings[zone].scale(finer.sources[zone], powers[:, zone])
            out[finer.own(zone)] = scale * chebyshev.t_values(series[zone, : self.sizes[zone]], n)
        return out


def _primitive(name: str, forcing: Forcing, x: Array) -> float:
    """Sum over the points x of the primitive of the right side or of a column.
    name: name of the right side or the column in the error message.
    """
    if forcing.primitive is None:
        raise ValueError(f"a condition on potentials needs the primitive of {name}")
    return float(np.asarray(forcing.primitive(x), dtype=float).sum())
