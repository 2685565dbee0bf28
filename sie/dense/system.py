"""The rows of the equation on given zones, with the fields of the zones in closed form.

The unknowns are, per zone, the coefficients c_0 ... c_m of T_l / sqrt(1 - t^2), and the amplitudes
lambda of the columns. Projected on U_{k-1}, a zone's own transform is -c_k, so the rows are

    -c_k + (field of other zones, images and regular part)_k - sum lambda C_k = g_k,  k = 1 ... m,

with C_k and g_k the coefficients of the columns and of the right side: a second-kind system. For
k > m the coefficients are c_k = -g_k, because the field of the other zones is smooth and has no
such modes. Fields are computed in `sie.basis.interval`. If zones are symmetric, only half of the
unknowns are kept, and the mirrored ones follow from them.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Index, Mask, numbered, record, root_of_squares, widened
from sie.basis.interval import Outside, mean_potential
from sie.basis.kernels import Kernel, regular_size
from sie.basis.lag_table import regular_values
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.weight import needs_half
from sie.basis.zones import Zones
from sie.dense.modes import OPTIONS
from sie.dense.spline_moments import coefficients as coefficients_between
from sie.dense.spline_moments import many_jumps, of_logarithms
from sie.density.series import moments_of
from sie.equation.conditions import Linear, Rows, asked, speaks_of_levels
from sie.equation.equation import Equation
from sie.jumps.right_side import ForcingJumps
from sie.trees.panels import Panels, panels_over
from sie.trees.skeleton import Skeleton
from sie.trees.tree import TERMS


@record
class Layout:
    """Order of the unknowns in their array: coefficients zone by zone, then amplitudes.

    Zone i has the coefficients offset[i] ... offset[i] + m[i]. The amplitudes of the columns follow
    after all zones. m: highest mode of each zone; columns: number of columns.
    """

    m: Index
    columns: int

    @cached_property
    def offset(self) -> Index:
        return np.concatenate(([0], np.cumsum(self.m + 1)[:-1]))

    @property
    def coefficients(self) -> int:
        return int(np.sum(self.m + 1))

    @property
    def size(self) -> int:
        return self.coefficients + self.columns

    def amplitude(self, k: int) -> int:
        """Index of the unknown amplitude of the equation's term `columns[k]`."""
        if not 0 <= k < self.columns:
            raise ValueError(
                f"a condition uses the amplitude of column {k} (counted from 0), but the equation "
                f"has {self.columns} columns"
            )
        return self.coefficients + k

    @cached_property
    def given(self) -> Mask:
        """Mask of those entries of a (zones, max m + 1) table of coefficients that are unknowns."""
        return np.asarray(np.arange(int(self.m.max()) + 1) <= self.m[:, None])

    def padded(self, y: Array) -> Array:
        """The unknown coefficients as a (zones, max m + 1) table, with zeros for missing modes."""
        out = np.zeros(self.given.shape, dtype=y.dtype)
        out[self.given] = y[: self.coefficients]
        return out

    def flat(self, table: Array) -> Array:
        """The array of unknowns that contains the coefficients of a table (zones, max m + 1).
        The amplitudes of the equation's columns are zero in this array.

        This method is the inverse of `padded`.
        """
        out, count = np.zeros(self.size), self.given.shape[1]
        out[: self.coefficients] = widened(table, count)[:, :count][self.given]
        return out


@record
class Targets:
    """Points on zones, for each of which the distances from both ends of its zone are known.

    zone: index of the zone of each point; left, right: distances from the ends of the zone; x:
    positions.
    """

    zone: Index
    left: Array
    right: Array
    x: Array

    @classmethod
    def lobatto(cls, zones: Zones, chosen: Index, m: Index) -> "Targets":
        """The Lobatto nodes of each chosen zone, including the ends, from right to left."""
        count = m[chosen] + 2
        start = np.cumsum(count) - count
        zone = np.repeat(chosen, count)
        lefts, rights = np.empty((2, len(zone)))
        for n in np.unique(m[chosen]):
            some = np.flatnonzero(m[chosen] == n)
            _, r, lf = chebyshev.lobatto(int(n))
            at = start[some][:, None] + np.arange(int(n) + 2)
            w = zones.half[chosen[some]][:, None]
            lefts[at], rights[at] = lf * w, r * w
        x = np.where(lefts <= rights, zones.a[zone] + lefts, zones.b[zone] - rights)
        return cls(zone, lefts, rights, x)

    def relative_to(
        self, zones: Zones, sources: Index, shift: float
    ) -> tuple[Outside, Array | None]:
        """(points in coordinates relative to each source zone, mask of points off that zone).

        The zones `sources` are moved by `shift`.

        Both results have the shape (points, sources). The mask is 0 for a target on the source
        itself, else 1. It is None if `shift` is not 0, since then there is no such pair. Distances
        are sums of the gap between the two zones and the distance of the point from its own zone's
        end. So digits are lost only in the gap, the difference of two ends. The position of a
        target on the source itself is arbitrary: the caller uses another formula.
        """
        a, b = zones.a[sources] + shift, zones.b[sources] + shift
        z = self.zone
        right = zones.middle[z][:, None] > zones.middle[sources] + shift
        (rest_a, rest_b), seen_a, seen_b = (
            zones.rest[:, sources],
            zones.rest[0, z][:, None],
            zones.rest[1, z][:, None],
        )
        past_b = (zones.a[z][:, None] - b) + (seen_a - rest_b) + self.left[:, None]
        past_a = (a - zones.b[z][:, None]) + (rest_a - seen_b) + self.right[:, None]
        own = z[:, None] == sources if shift == 0.0 else None
        e = np.where(right, past_b, past_a) / zones.half[sources]
        sign = np.where(right, 1.0, -1.0)
        return (
            (Outside(sign, e), None)
            if own is None
            else (Outside(sign, np.where(own, 1.0, e)), np.where(own, 0.0, 1.0))
        )


@record
class Places:
    """Points x that lie outside all zones."""

    x: Array

    def relative_to(
        self, zones: Zones, sources: Index, shift: float
    ) -> tuple[Outside, Array | None]:
        """The points relative to the zones `sources`, which are moved by `shift`."""
        return outside(zones.a[sources] + shift, zones.b[sources] + shift, self.x[:, None]), None


def outside(a: Array, b: Array, x: Array) -> Outside:
    """Points x outside the intervals [a, b], in coordinates relative to each interval."""
    right = x > 0.5 * (a + b)
    return Outside(np.where(right, 1.0, -1.0), np.where(right, x - b, a - x) / (0.5 * (b - a)))


def fields(
    zones: Zones, kernel: Kernel, targets: Targets | Places, layout: Layout, potential: bool
) -> Array:
    """Transform or potential at the targets, if one unknown is 1 and all others are 0.
    The table (points, unknowns) has a column for each unknown.

    If `potential` is true, the table contains the potential divided by the half width of the
    unknown's zone. The effect of a zone on itself is omitted.
    """
    out = np.zeros((len(targets.x), layout.size))
    for m in np.unique(layout.m):
        sources = np.flatnonzero(layout.m == m)
        block = np.zeros((m + 1, len(targets.x), len(sources)))
        for shift in kernel.poles:
            seen, others = targets.relative_to(zones, sources, shift)
            if others is not None and len(zones) == 1:
                continue
            terms = seen.one_by_one(potential, zones.half[sources] / kernel.datum, others)
            for k, term in zip(range(m + 1), terms, strict=False):
                block[k] += term
        columns = layout.offset[sources][:, None] + np.arange(m + 1)
        out[:, columns] = block.transpose(1, 2, 0)
    if kernel.regular is not None:
        _add_regular(out, zones, kernel, targets.x, layout, potential)
    return out


def _add_regular(
    out: Array, zones: Zones, kernel: Kernel, x: Array, layout: Layout, potential: bool
) -> None:
    """Add, to the table `out`, the fields at points x that the kernel's regular part causes."""
    regular = kernel.regular_potential if potential else kernel.regular
    if regular is None:
        raise ValueError(
            "a condition on potentials needs the potential of the regular kernel: "
            "sie.Smooth(value, potential)"
        )
    panels = panels_over(kernel, zones)
    if panels is not None:
        moments = _panel_moments(zones, panels, layout, potential)
        out[:, : layout.coefficients] += panels.at(panels.spread(x), moments, potential)
        return
    for middle, w, m, first in zip(
        zones.middle, zones.half, layout.m.tolist(), layout.offset, strict=True
    ):
        q = regular_size(kernel, w, m)
        count = min(m, q - 1) + 1
        nodes = middle + w * chebyshev.gauss(q)
        for start in range(0, len(x), rows := max(1, SUMS.cache_pairs * TERMS // q)):
            some = slice(start, start + rows)
            block = chebyshev.t_means(regular_values(kernel, x[some], nodes, potential), count)
            out[some, first : first + count] += block if potential else w * block


def _panel_moments(
    zones: Zones, panels: Panels | Skeleton, layout: Layout, over_width: bool
) -> Array:
    """Moments, on panels or a skeleton, of the density with one coefficient 1 and the others 0.
    The shape is (moments, coefficients). Panels are equal parts of the line, a skeleton is a set of
    source points; both are for fast sums of a smooth kernel.

    over_width: whether the moments are divided by the half width of the zone.
    """
    out = np.zeros((panels.size, layout.coefficients))
    modes = panels.modes(zones.half)
    for i in range(len(zones)):
        q = int(modes[i]) + 2
        count = min(int(layout.m[i]), int(modes[i])) + 1
        xi = zones.middle[i] + zones.half[i] * chebyshev.gauss(q)
        weights = chebyshev.t_matrix(q, count) * ((1.0 if over_width else zones.half[i]) / q)
        out[:, layout.offset[i] : layout.offset[i] + count] = panels.moments(
            panels.spread(xi), weights
        )
    return out


class System(Rows):
    """Matrix rows of the equation, and of the quantities that side conditions use (see `Rows`).

    coefficients: U coefficients g_k of the smooth part of the right side at [:, k], for all zones.
    """

    def __init__(
        self, equation: Equation, zones: Zones, m: Index, coefficients: Array, jumps: ForcingJumps
    ) -> None:
        needs_half(zones.weight, "the rows of the equation")
        self.equation, self.zones, self.jumps, self.g = equation, zones, jumps, coefficients
        self.layout = Layout(m, len(equation.columns))
        self.known = jumps.first_coefficients(zones, m + 1)
        # On zones with many jumps, the unknown coefficients up to mode m are those of the whole
        # density, jumps included.
        self.by_moments = many_jumps(equation.forcing, zones, jumps)
        self.taken = np.zeros_like(self.known)
        self.lowest = coefficients
        if len(self.by_moments):
            self._take(m)
        self.targets = Targets.lobatto(zones, zones.solved, m)
        self.starts = np.concatenate(([0], np.cumsum(m[zones.solved] + 2)))
        # Each row k = 1 ... m of a solved zone has an unknown c_k, with index `own`. A zone at the
        # centre of symmetry keeps only the rows of even k.
        zone, k = np.repeat(zones.solved, m[zones.solved]), numbered(m[zones.solved]) + 1
        self.own = self.layout.offset[zone] + k
        self.kept: Index | slice = (
            np.flatnonzero((k % 2 == 0) | (zone != zones.solved[0]))
            if zones.central
            else slice(None)
        )
        self.source_tails = np.zeros(len(zones))
        # Largest value of the field of each unknown on each solved zone; None if the numbers of
        # modes are fixed.
        self.field_sizes: Array | None = None

    def _take(self, m: Index) -> None:
        zones, chosen = self.zones, self.by_moments
        both = np.union1d(chosen, len(zones) - 1 - chosen) if zones.symmetric else chosen
        within = np.arange(self.known.shape[1]) <= m[both, None]
        taken = self.known[both]
        if self.equation.forcing.value_jumps:
            # The logarithms of plateaus are no part of g. Their closed forms stay known.
            taken = taken - self.jumps.near_coefficients(zones, taken.shape[1])[both]
        self.taken[both] = np.where(within, taken, 0.0)
        self.known = self.known - self.taken
        if self.equation.forcing.value_jumps:
            of_g, means = coefficients_between(self.equation.forcing, zones, self.jumps, chosen, m)
            # The logarithms need as many nodes as the smooth part of g has coefficients.
            nodes = np.max((self.g[chosen] != 0.0) * np.arange(self.g.shape[1]), axis=1)
            logs, means_of_logs = of_logarithms(
                zones, self.jumps, chosen, np.maximum(nodes, OPTIONS.first_nodes)
            )
            count = max(of_g.shape[1], logs.shape[1])
            of_g = widened(of_g, count) + widened(logs, count)
            self.moment_means = means + means_of_logs
        else:
            # If the density has the jumps, g has logarithms there, and `coefficients_between` would
            # gain nothing. The lowest coefficients of g are then those of the smooth part of g,
            # minus those of the density with the jumps (`taken`).
            of_g = widened(self.g[chosen], self.taken.shape[1])
            of_g[:, : self.taken.shape[1]] -= self.taken[chosen]
        count = max(self.g.shape[1], of_g.shape[1])
        self.lowest = widened(self.g, count).copy()
        inner = np.arange(count) <= m[chosen, None]
        self.lowest[chosen] = np.where(inner, widened(of_g, count), self.lowest[chosen])

    def equation_rows(self) -> tuple[Array, Array]:
        """(matrix, right side) of the equation on the solved zones.

        The solved zones are half of all zones if the zones are symmetric.
        """
        layout, zones = self.layout, self.zones
        if len(self.own) == 0:  # only the totals are unknown
            return np.zeros((0, layout.size)), np.zeros(0)
        raw = fields(zones, self.equation.kernel, self.targets, layout, potential=False)
        if self.equation.kernel.grows and panels_over(self.equation.kernel, zones) is None:
            # The last coefficients of the kernel as a function of xi show whether the quadrature
            # resolves the kernel.
            if np.isfinite(self.equation.kernel.length):
                self.source_tails = self._quadrature_tails()
            else:
                last = layout.offset + layout.m - np.minimum([[0], [1], [2]], layout.m)
                self.source_tails = np.abs(raw[:, last]).max(axis=(0, 1)) / max(
                    1.0, np.abs(raw).max()
                )
        for number, column in enumerate(self.equation.columns):
            raw[:, layout.coefficients + number] = -column.value(self.targets.x)
        if self.equation.grows:
            self.field_sizes = np.maximum.reduceat(np.abs(raw), self.starts[:-1], axis=0)
        rows, right = self.projected(raw), layout.flat(self.lowest)[self.own]
        if len(self.jumps):
            right -= rows @ layout.flat(self.known)
        if self.unseen_moments is not None:
            right -= self.of_panels(self.unseen_moments)[0]
        rows[np.arange(len(rows)), self.own] -= 1.0
        return rows[self.kept], right[self.kept]

    def _quadrature_tails(self) -> Array:
        """Relative error on each zone (Z,) of the quadrature of the kernel's regular part.
        The kernel has a finite `length`, over which it varies.

        In Gauss's rule, a high Chebyshev coefficient of the kernel acts on the highest mode as if
        it were a low one (aliasing). The error is the size of this coefficient, extrapolated for x
        at both ends and in the middle of the zone.
        """
        zones, kernel, tails = self.zones, self.equation.kernel, np.zeros(len(self.zones))
        assert kernel.regular is not None
        for i, (middle, half, m) in enumerate(
            zip(zones.middle, zones.half, self.layout.m.tolist(), strict=True)
        ):
            q = regular_size(kernel, half, m)
            x = middle + half * np.array([[-1.0], [0.0], [1.0]])
            size = np.abs(chebyshev.t_means(kernel.regular(x, middle + half * chebyshev.gauss(q))))
            fallen = size[:, -3:].max() / max(size.max(), 1e-300)
            tails[i] = min(size.max(), 1.0) * fallen ** (2.0 - m / q) if fallen > 0.0 else 0.0
        return tails

    def projected(self, values: Array) -> Array:
        """Coefficients in U_{k-1} of functions, from their values at the nodes of all solved zones.
        k runs from 1 to the number m of modes. The coefficients are listed zone by zone.
        """
        m = self.layout.m[self.zones.solved]
        first, out = np.cumsum(m) - m, np.empty((int(m.sum()), *values.shape[1:]))
        for count in set(m.tolist()):
            group, k = np.flatnonzero(m == count)[:, None], np.arange(count)
            out[first[group] + k] = chebyshev.u_coefficients(
                values[self.starts[group] + 1 + k].swapaxes(1, -1)
            ).swapaxes(1, -1)
        return out

    @cached_property
    def panels(self) -> Panels | Skeleton | None:
        """Panels or skeleton for fast sums of the kernel's regular part; None if neither applies.
        Panels are equal parts of the line. A skeleton interpolates from a few source points.
        """
        return panels_over(self.equation.kernel, self.zones)

    @cached_property
    def unseen_moments(self) -> Array | None:
        """Moments, on `panels`, of the part of the density above mode m; None if not needed.

        The coefficients above m are known, from the right side and its jumps. The result is None
        without panels, or if modes up to m resolve the regular part of the kernel.
        """
        zones, panels = self.zones, self.panels
        if panels is None or np.all(panels.modes(zones.half) <= self.layout.m):
            return None
        count = int(panels.modes(zones.half).max()) + 1
        table = -widened(self.g, count)[:, :count]
        if len(self.jumps):
            table += self.jumps.t_coefficients(zones, count)
        table = np.where(np.arange(count) > self.layout.m[:, None], table, 0.0)
        return moments_of(panels, zones, self.equation.kernel, table, ForcingJumps.none())

    def of_panels(self, moments: Array) -> tuple[Array, Array]:
        """Part of (equation's rows, zones' levels) that is due to the kernel's regular part.
        The level of a zone is the mean of the potential minus the primitive of the right side.

        moments: moments of the density on the panels.
        """
        assert self.panels is not None
        spread = self.panels.spread(self.targets.x)
        rows = self.projected(self.panels.at(spread, moments, False))
        if self.equation.kernel.regular_potential is None:
            return rows, np.zeros(len(self.zones.solved))
        return rows, self.means(self.panels.at(spread, moments, True))

    @cached_property
    def diagonal(self) -> Index:
        """For each solved row k of the equation, the index of the unknown coefficient c_k.

        On symmetric zones, `MirrorSymmetry` chooses these rows.
        """
        return self.own[self.kept]

    @cached_property
    def last_unknowns(self) -> Index:
        """Index, among the unknowns solved for, of the highest Chebyshev coefficient of each zone.
        Only solved zones are included; of symmetric zones they are the right half.

        A zone at the centre of symmetry has even coefficients only.
        """
        solved, m = self.zones.solved, self.layout.m
        last = m[solved] - (m[solved] % 2) * ((np.arange(len(solved)) == 0) & self.zones.central)
        return self.symmetry.position(self.layout.offset[solved] + last)

    @cached_property
    def symmetry(self) -> "MirrorSymmetry":
        return MirrorSymmetry.of(self.zones, self.layout)

    def _zero_rows(self) -> Array:
        return np.zeros((len(self.zones.solved), self.layout.size))

    def totals(self) -> Linear:
        solved = self.zones.solved
        rows = self._zero_rows()
        scale = np.pi * self.zones.half[solved]
        rows[np.arange(len(solved)), self.layout.offset[solved]] = scale
        return rows, scale * self.known[solved, 0]

    def integrals(self, weight: Callable[[Array], Array], degree: int | None = None) -> Linear:
        tables, constants = self.weighted(weight, degree)
        rows = self._zero_rows()
        for place, (i, values) in enumerate(zip(self.zones.solved, tables, strict=True)):
            rows[place, self.layout.offset[i] : self.layout.offset[i] + len(values)] = values
        return rows, constants

    def weighted(
        self, weight: Callable[[Array], Array], degree: int | None
    ) -> tuple[list[Array], Array]:
        """(factors of the unknowns, constants) of the integral of `weight` times the density.

        Both have one entry for each solved zone.
        """
        tables, constants = [], np.zeros(len(self.zones.solved))
        least = max(self.g.shape[1], int(self.layout.m.max()) + 1, 16) + 16
        known: dict[int, Array] = {}
        for place, i in enumerate(self.zones.solved):
            m = int(self.layout.m[i])
            values = np.pi * self.zones.half[i] * self.moments(weight, i, least, degree)
            size = len(values)
            tables.append(values[: m + 1])
            beyond = -self.g[i, m + 1 : size]
            constants[place] = values[m + 1 : m + 1 + len(beyond)] @ beyond
            if len(self.jumps):
                if size not in known:
                    known[size] = self.jumps.t_coefficients(self.zones, size)
                constants[place] += (
                    values @ known[size][i] - values[: m + 1] @ self.taken[i, : m + 1][:size]
                )
        return tables, constants

    def moments(
        self, weight: Callable[[Array], Array], zone: int, size: int, degree: int | None = None
    ) -> Array:
        """Means over a zone, with respect to theta, of the function `weight` times T_l.

        If `weight` is a polynomial of the given `degree`, the orders are l = 0 ... degree. For
        other functions the number of means is doubled, from `size` on, until they have decayed.
        """
        if degree is not None:
            return self._moments(weight, zone, degree + 2)[: degree + 1]
        while True:
            values = self._moments(weight, zone, size)
            if (
                np.abs(values[-8:]).max() <= 1e-14 * np.abs(values).max()
                or size >= OPTIONS.max_nodes
            ):
                return values
            size *= 2

    def _moments(self, weight: Callable[[Array], Array], zone: int, nodes: int) -> Array:
        x = self.zones.middle[zone] + self.zones.half[zone] * chebyshev.gauss(nodes)
        return chebyshev.t_means(np.broadcast_to(np.asarray(weight(x), dtype=float), x.shape))

    def intensities(self) -> tuple[Linear, Linear]:
        left, right = self._zero_rows(), self._zero_rows()
        for place, i in enumerate(self.zones.solved):
            m, root = int(self.layout.m[i]), self.zones.edge_scale[i]
            here = slice(self.layout.offset[i], self.layout.offset[i] + m + 1)
            right[place, here] = root
            left[place, here] = root * (1.0 - 2.0 * (np.arange(m + 1) % 2))
        constant_left, constant_right = self.intensities_of(self.beyond)
        return (left, constant_left), (right, constant_right)

    def intensities_of(self, coefficients: Array) -> tuple[Array, Array]:
        """The intensities K at the left and the right end of each solved zone.
        K is the coefficient of 1 / sqrt(distance from the end).

        coefficients: those of the density, (all zones, n + 1).
        """
        solved = self.zones.solved
        table, root = coefficients[solved], self.zones.edge_scale[solved]
        return root * (table[:, ::2].sum(axis=1) - table[:, 1::2].sum(axis=1)), root * table.sum(
            axis=1
        )

    @cached_property
    def beyond(self) -> Array:
        """Known coefficients (zones, n + 1) of the density that contribute to the intensities K.

        Above the highest mode m they are minus those of the right side. Up to m they correct for
        jumps whose coefficients are contained in the unknowns.
        """
        count = max(self.g.shape[1], self.taken.shape[1])
        g, taken = widened(self.g, count), widened(self.taken, count)
        within = np.arange(count) <= self.layout.m[:, None]
        return np.where(within, -taken, -g)

    def on_plateaus(self, weight: Callable[[Array], Array] | None = None) -> float:
        plateaus = self.jumps.plateaus
        if plateaus is None:
            return 0.0
        return plateaus.total if weight is None else plateaus.integral(weight)

    def amplitude(self, k: int) -> Linear:
        row = np.zeros((1, self.layout.size))
        row[0, self.layout.amplitude(k)] = 1.0
        return row, np.zeros(1)

    @cached_property
    def wants_levels(self) -> bool:
        """Whether any side condition contains levels of zones.
        The level of a zone is the mean of the potential minus the primitive of the right side g.
        """
        return any(speaks_of_levels(c, self.zones) for c in self.equation.conditions)

    @property
    def level_constants(self) -> Array:
        return self.levels()[1]

    def level_changes(self, y: Array) -> Array:
        """The part of the zones' `levels` that is linear in the unknowns y.
        The level of a zone is the mean of the potential minus the primitive of the right side.
        """
        return np.asarray(self.levels()[0] @ y)

    @property
    def integrated(self) -> bool:
        """Whether differences between zones' levels are computed as integrals of the right side g.
        The level of a zone is the mean over the zone of the potential minus the primitive of g.
        Integrals of g between zones do not have the round-off of this primitive.
        """
        return False

    def level_rounding(self, y: Array) -> Array | float:
        """Root mean square round-off of each zone's level, as far as the potentials cause it.
        The level is the mean over the zone of the potential minus the primitive of the right side.
        """
        return 2.2e-16 * root_of_squares(self.levels()[0], y)

    def levels(self) -> Linear:
        """(rows, constants) such that the levels of the solved zones are rows @ y + constants.
        y: the unknowns. The level of a zone is the mean of the potential minus the primitive of the
        right side g.

        The mean of a zone's own potential is w c_0 log(w / 2), with the half width w. The mean of
        the primitive of g follows from its values at the ends and from the coefficients of g, since
        the antiderivative of U_{k-1} is T_k / k.
        """
        return self._levels

    @cached_property
    def _levels(self) -> Linear:
        zones, layout, kernel = self.zones, self.layout, self.equation.kernel
        solved = zones.solved
        raw = fields(zones, kernel, self.targets, layout, potential=True)
        raw[:, : layout.coefficients] *= np.repeat(zones.half, layout.m + 1)
        rows = self.means(raw)
        rows[np.arange(len(solved)), layout.offset[solved]] += mean_potential(
            zones.half[solved], kernel.datum
        )
        constants = rows @ layout.flat(self.known)
        if self.unseen_moments is not None:
            constants = constants + self.of_panels(self.unseen_moments)[1]
        # The true width of a rim (a zone with two different given values at its ends) is
        # exp(`Zones.depth`) times its width here. The unknown total of the density is spread over
        # the true width, so that its mean potential is corrected. The known part is not corrected.
        rows[np.arange(len(solved)), layout.offset[solved]] += (zones.half * zones.depth)[solved]
        for k, column in enumerate(self.equation.columns):
            rows[:, layout.coefficients + k] = -self._column_means(column.primitive)
        return rows, constants - self._forcing_means()

    def _column_means(self, primitive: Callable[[Array], Array] | None) -> Array:
        if primitive is None:
            raise ValueError(
                "a condition on potentials needs the primitive of every column: give `primitive`"
            )
        return self.means(primitive(self.targets.x))

    def means(self, values: Array) -> Array:
        """Means over each solved zone, in the angle theta, of values at its nodes (n, ...)."""
        return np.array(
            [
                (values[s:e].sum(axis=0) - 0.5 * (values[s] + values[e - 1])) / (e - s - 1)
                for s, e in zip(self.starts[:-1], self.starts[1:], strict=True)
            ]
        )

    def _forcing_means(self) -> Array:
        zones, forcing = self.zones, self.equation.forcing
        if forcing.primitive is None:
            raise ValueError(
                "a condition on potentials needs the primitive of the right side: give `primitive`"
            )
        solved = zones.solved
        w = zones.half[solved]
        ends, rest = np.array([zones.a[solved], zones.b[solved]]), zones.rest[:, solved]
        heights = np.asarray(forcing.primitive(ends)) + self.jumps.primitive_left_out(ends)
        if forcing.resolution.exact_places and rest.any():
            heights = heights + rest * np.asarray(forcing.value(ends))
        mean = 0.5 * heights.sum(axis=0)
        if len(self.jumps):
            mean = mean + w * self.jumps.mean_offsets(zones)[solved]
        even = self.g[solved[0] :, 2::2]
        mean = np.asarray(mean - w * (even @ (0.5 / np.arange(1.0, even.shape[1] + 1))))
        if len(self.by_moments):
            mean[np.searchsorted(solved, self.by_moments)] = self.moment_means
        return mean


def condition_rows(equation: Equation, system: Rows, size: int) -> tuple[Array, Array]:
    """(rows, right sides) of all side conditions, then of the intensities at fixed ends."""
    zones, rows, values = system.zones, [np.zeros((0, size))], [np.zeros(0)]
    for condition in equation.conditions:
        matrix, constants, wanted = asked(condition, system, size)
        rows.append(matrix)
        values.append(wanted - constants)
    if any(zones.fixed_bounded):
        for ends, chosen, (matrix, constants) in zip(
            (zones.left, zones.right), zones.fixed_bounded, system.intensities(), strict=True
        ):
            rows.append(matrix[chosen])
            values.append(
                np.array([ends[zones.solved[p]].intensity for p in chosen]) - constants[chosen]
            )
    return np.concatenate(rows), np.concatenate(values)


@record
class MirrorSymmetry:
    """Selection of the unknowns that are solved for: half of all for symmetric zones, else all.

    whole: number of all unknowns; size: number of kept ones; keep: indices of the kept ones. The
    unknowns at `follow` are `sign` times those at `source`.
    """

    whole: int
    size: int
    keep: Index | slice
    follow: Index
    sign: Array
    source: Index

    @classmethod
    def of(cls, zones: Zones, layout: Layout) -> "MirrorSymmetry":
        none = np.zeros(0, dtype=np.intp)
        if not zones.symmetric:
            return cls(layout.size, layout.size, slice(None), none, np.zeros(0), none)
        count = len(zones)
        pairs = zones.solved[1:] if zones.central else zones.solved
        keep: list[Index] = []
        if zones.central:
            middle = zones.solved[0]
            keep = [layout.offset[middle] + np.arange(0, layout.m[middle] + 1, 2)]
        size = layout.m[pairs] + 1
        k = numbered(size)
        source = np.repeat(layout.offset[pairs], size) + k
        follow = np.repeat(layout.offset[count - 1 - pairs], size) + k
        kept = np.concatenate([*keep, source, layout.coefficients + np.arange(layout.columns)])
        return cls(
            layout.size,
            len(kept),
            kept,
            follow,
            np.asarray(1.0 - 2.0 * (k % 2), dtype=np.float64),
            source,
        )

    def position(self, unknowns: Index) -> Index:
        """Positions of the given unknowns among the unknowns solved for; -1 for other unknowns."""
        places = np.full(self.whole, -1, dtype=np.intp)
        places[self.keep] = np.arange(self.size)
        return np.asarray(places[unknowns])

    def fold(self, matrix: Array) -> Array:
        """The matrix for the unknowns solved for; columns of mirror images are added to theirs."""
        if len(self.follow):
            matrix[:, self.source] += matrix[:, self.follow] * self.sign
        return np.asarray(matrix[:, self.keep])

    def unfold(self, y: Array) -> Array:
        out = np.zeros(self.whole)
        out[self.keep] = y
        if len(self.follow):
            out[self.follow] = self.sign * out[self.source]
        return out
