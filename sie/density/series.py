"""A density as series on its zones: coefficients, jumps, values, and fields on the line.

`sie.basis.interval` has the closed forms for a zone and its images. The regular part of the kernel
is integrated by quadrature.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sie.basis import chebyshev, interval
from sie.basis.data import EPS, Array, Index, widened
from sie.basis.kernels import Kernel, Regular, regular_size
from sie.basis.lag_table import regular_values
from sie.basis.sums import OPTIONS as BLOCKS
from sie.basis.zones import Zones
from sie.density.base import DensityBase
from sie.jumps.logarithms import Logarithms
from sie.jumps.right_side import ForcingJumps
from sie.trees.panels import Panels, panels_over
from sie.trees.skeleton import Skeleton


@dataclass(frozen=True)
class DensityOptions:
    """Positions and numbers of the points at which a density and its errors are evaluated."""

    # No error of the density is stated closer to a singular end or a kink than this distance,
    # relative to the half width. The error grows without bound there.
    end_distance: float = 0.01
    # Least number of angles at which the density is sampled on a zone. The density is also sampled
    # on both sides of kinks: the zone's highest ones, at most this number.
    samples: int = 32
    # Largest number of angles theta = arccos(t) of a zone at which the change of the density by
    # motions of the zone's ends is evaluated.
    max_angles: int = 256


OPTIONS = DensityOptions()


@dataclass(frozen=True, eq=False)
class Series(DensityBase):
    """The density on each zone: sum_j c_j T_j(t) / sqrt(1 - t^2), plus closed forms of jumps.
    The jumps are those of the right side or the density inside the zones.

    `sie.Density` explains the fields.
    """

    zones: Zones
    kernel: Kernel
    coefficients: Array
    jumps: ForcingJumps
    amplitudes: Array
    bounded_ends: bool = False
    edges: tuple[Array, Array] | None = None

    @property
    def beside(self) -> Logarithms | None:
        return None if self.jumps.plateaus is None else self.jumps.logarithms

    # The methods below give properties of the density on each zone.
    @cached_property
    def singular(self) -> tuple[Array, Array]:
        """(alpha, beta) of the density's unbounded part (alpha + beta t) / sqrt(1 - t^2)."""
        alpha, beta = self.edges or chebyshev.edge_part(self.coefficients)
        if not self.bounded_ends:
            return alpha, beta
        left, right = self.zones.moves & self.zones.bounded
        k_left, k_right = np.where(left, 0.0, alpha - beta), np.where(right, 0.0, alpha + beta)
        return 0.5 * (k_left + k_right), 0.5 * (k_right - k_left)

    @cached_property
    def bounded(self) -> tuple[Array, Array, Array]:
        """Coefficients (alpha, beta, u) of an unbounded and a bounded part of the density.
        The sum is (alpha + beta t) / X + X sum u_k U_k, with X = sqrt(1 - t^2). The closed forms of
        jumps are not included.
        """
        return *self.singular, chebyshev.bounded_part(self.coefficients)[2]

    @property
    def upper_bound(self) -> float:
        """An upper bound of the density on all zones; inf if there are jumps or infinite values.

        The bounded part of the density is sum u_k sin (k + 1) theta, which is at most sum |u_k|.
        """
        alpha, beta, series = self.bounded
        rounding = EPS * np.abs(self.coefficients).sum(axis=1)
        if len(self.jumps) or np.any(alpha + np.abs(beta) > rounding):
            return math.inf
        return float(np.abs(series).sum(axis=1).max())

    @cached_property
    def sampling(self) -> Index:
        """Number of angles theta = arccos(t) that resolve the density on each zone (Z,).
        The angles are equidistant.

        It is twice the number of terms of the Chebyshev series, plus four for every jump.
        """
        modes = np.count_nonzero(self.coefficients, axis=1)
        jumps = np.zeros(len(self.zones), dtype=np.intp)
        jumps[: len(self.jumps.count)] = self.jumps.count
        return np.clip(2 * modes + 4 * jumps, OPTIONS.samples, BLOCKS.cache_pairs)

    def first(self, count: int) -> Array:
        """First `count` coefficients of T_l / sqrt(1 - t^2) in each zone's density, with jumps."""
        out = widened(self.coefficients[:, :count], count)
        return out + self.jumps.t_coefficients(self.zones, count) if len(self.jumps) else out

    @cached_property
    def totals(self) -> Array:
        """Integral of the density over each zone (Z,)."""
        return np.asarray(np.pi * self.zones.half * self.first(1)[:, 0])

    @property
    def total(self) -> float:
        """Integral of the density over all zones and plateaus (stretches of constant density)."""
        return float(self.totals.sum()) + (0.0 if self.beside is None else self._plateaus.total)

    def moment(self, about: float = 0.0) -> float:
        """First moment of the density: the integral of (x - about) times the density."""
        w = self.zones.half
        of_plateaus = 0.0 if self.beside is None else self._plateaus.integral(lambda x: x - about)
        return of_plateaus + float(
            np.sum(
                (self.zones.middle - about) * self.totals + np.pi * w * w * self.first(2)[:, 1] / 2
            )
        )

    @cached_property
    def intensities(self) -> tuple[Array, Array]:
        """Intensities K at both ends of each zone: the density is K / sqrt(d) at a distance d."""
        return interval.intensities(*self.singular, self.zones.half)

    @cached_property
    def edge_slopes(self) -> tuple[Array, Array]:
        """Edge slopes A of the density at both ends of each zone.
        A is the coefficient of sqrt(d) in the density at the distance d from the end.
        """
        left, right = interval.edge_slopes(
            *self.singular, *chebyshev.slopes_at_ends(self.coefficients), self.zones.half
        )
        jump_left, jump_right = self.jumps.edge_slopes(self.zones)
        scale = self.zones.slope_scale
        return left + scale * jump_left, right + scale * jump_right

    @cached_property
    def sensitivity(self) -> tuple[Array, Array, Array]:
        """Largest density on each zone, and its largest changes by motions of the zone's ends.
        The result is (largest density, largest change by a motion of the left end, largest change
        by a motion of the right end).

        Each has one value for each zone.

        A change is taken at equal normalised position. It is divided by the motion of the end that
        causes it, in units of the zone's width. Values closer to singular ends and kinks than
        `DensityOptions.end_distance` do not count, because they are unbounded.

        To first order, a motion of an end leaves a bounded density unchanged at fixed places. Only
        the moved end gains a part K / sqrt(d), and the density on the new zone lacks this part. At
        equal t = cos(theta), a motion of the right end by eps widths changes the density by

            -eps cot(theta/2) (phi_theta(theta) - phi_theta(0)),    phi_theta = d phi / d theta,

        with the density phi. The first term is eps (1 + t) phi'(t), the second is due to the part
        K / sqrt(d).
        """
        none, out = np.zeros(len(self.zones)), np.zeros((3, len(self.zones)))
        bounded, counts = (
            replace(self, edges=(none, none)),
            np.minimum(self.sampling, OPTIONS.max_angles),
        )
        bent = np.array(sorted(self.jumps.by_zone), dtype=np.intp)
        straight = np.delete(np.arange(len(self.zones)), bent)
        for n in np.unique(counts[straight]):
            group = straight[counts[straight] == n]
            out[:, group] = [
                each.max(axis=1)
                for each in bounded.change_sizes(group[:, None], even_angles(n)[None])
            ]
        if len(bent):
            even = [even_angles(n) for n in counts[bent]]
            zone = np.repeat(bent, counts[bent])
            np.maximum.at(
                out[0], zone, np.abs(bounded.at(zone, *interval.sides(np.concatenate(even))))
            )
            near_kinks = [
                angles_at_kinks(*self.jumps.sharpest(i), theta)
                for i, theta in zip(bent.tolist(), even, strict=True)
            ]
            out[1:] += bounded.largest_changes(bent, near_kinks)[1:]
        # The density's part (alpha + beta t) / sqrt(1 - t^2) is left out of `bounded`, but changes
        # too: if one end is fixed and the other end moves, the load spreads over another width.
        alpha, beta = self.singular
        out[1:] += (np.abs(alpha) + np.abs(beta)) / interval.root_weight(
            OPTIONS.end_distance, 2 - OPTIONS.end_distance
        )
        return out[0], out[1], out[2]

    # The methods below give the density, and the integral of the density, at given places.
    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        """Density at points given by a zone and distances from the zone's ends in half widths.

        left + right = 2; no digit is lost close to the ends.
        """
        left, right = np.asarray(left, dtype=float), np.asarray(right, dtype=float)
        zone, left, right = np.broadcast_arrays(np.asarray(zone, dtype=np.intp), left, right)
        # Close to an end the density is K / sqrt(distance) plus bounded terms. At ends where the
        # density is bounded, K is only round-off, and `values_on` does not divide K by the distance
        # zero.
        out = interval.values_on(self.bounded, zone, left, right, self.zones.bounded)
        if len(self.jumps):
            out = out + self.jumps.density(zone.ravel(), left.ravel(), right.ravel()).reshape(
                out.shape
            )
        if self.zones.depth.any():
            # A rim is a zone with two different given values at its ends. It is computed with a
            # larger width than its true width. The deviation of the density from `passage`, the
            # density on a very narrow rim, is proportional to the width. So it is multiplied by
            # the true width over the width used.
            part = np.exp(self.zones.depth)[zone]
            out = np.where(
                part < 1.0, part * out + (1 - part) * self.passage(zone, left, right), out
            )
        return np.asarray(out)

    def passage(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        """The density on a rim that is so narrow that the right side does not vary on it.
        A rim is a zone with two different given values of the density at its ends. There the
        density is a linear function of the angle arccos(t).
        """
        at_left, at_right = self.zones.values[:, np.asarray(zone)]
        return np.asarray(at_right + (at_left - at_right) * interval.theta(left, right) / np.pi)

    def integral_at(self, zone: ArrayLike, angle: ArrayLike) -> Array:
        """Integral of the density from a zone's left end to the point t = cos(angle)."""
        zone, angle = np.broadcast_arrays(
            np.asarray(zone, dtype=np.intp), np.asarray(angle, dtype=float)
        )
        w, out = self.zones.half[zone], interval.integral_on(self.coefficients, zone, angle)
        if len(self.jumps):
            out = out + self.jumps.integral(zone.ravel(), *interval.sides(angle.ravel())).reshape(
                out.shape
            )
        return np.asarray(w * out)

    def integral(self, x: ArrayLike) -> Array:
        """Integral of the density up to x from the left end of the zone that contains x.

        The integral is zero for x off the zones. If the total of every zone is zero, minus this
        integral is the opening of cracks.

        Examples
        --------
        The total on the left half of a zone, and up to the right end.

        >>> import numpy as np, sie
        >>> zone = sie.Zones.of([[-1.0, 1.0]])
        >>> hertz = sie.Density.from_function(lambda x: np.sqrt(1 - x**2), zone)
        >>> (hertz.integral([0.0, 1.0]) / np.pi).round(12).tolist()
        [0.25, 0.5]
        """
        x, i, inside = self.locate(x)
        out = np.zeros(x.shape)
        z, w = i[inside], self.zones.half[i[inside]]
        left, right = (x[inside] - self.zones.a[z]) / w, (self.zones.b[z] - x[inside]) / w
        out[inside] = self.integral_at(z, interval.theta(left, right))
        return out

    # The properties below are tables from which sums over zones are computed.
    @cached_property
    def quadrature(self) -> list[tuple[Array, Array]]:
        """Quadrature nodes, and weights times density, for the kernel's regular part."""
        return quadrature(self.zones, self.kernel, self.coefficients, self.jumps)

    @cached_property
    def panel_moments(self) -> tuple[Panels | Skeleton, Array] | None:
        """Fast-sum form of the kernel's regular part, and the density's moments for it.
        The form is `Panels` (equal parts of the line) or a `Skeleton` (an interpolation from a few
        source positions).

        It is None if the regular part is not computed by panels.
        """
        panels = panels_over(self.kernel, self.zones)
        return (
            None
            if panels is None
            else (
                panels,
                moments_of(panels, self.zones, self.kernel, self.coefficients, self.jumps),
            )
        )

    @cached_property
    def potential_coefficients(self) -> Array:
        """Table (zones, n + 1) of c_0 and c_k / k (k > 0), from which potentials follow.
        c_k is the coefficient of T_k / sqrt(1 - t^2) in the density of a zone.

        The table does not include the jumps whose potential `ForcingJumps.sharp_potential` gives.
        """
        c, high = self.coefficients, self.jumps.high_coefficients(self.zones)
        table = widened(c, high.shape[1]) + widened(high, c.shape[1])
        table[:, 1:] /= np.arange(1, table.shape[1])
        return table

    @cached_property
    def sharp_totals(self) -> Array:
        """Coefficient (Z,) of T_0 / sqrt(1 - t^2) in the part of the density due to some jumps.
        These are the jumps whose potential is a closed form, see `ForcingJumps.sharp_potential`.
        """
        high = self.jumps.high_coefficients(self.zones)[:, :1]
        return np.asarray(self.jumps.t_coefficients(self.zones, 1)[:, 0] - high.sum(axis=1))


def even_angles(count: int) -> Array:
    """`count` equidistant angles in (0, pi); the first is half a step from 0."""
    return (np.arange(count) + 0.5) * np.pi / count


def angles_at_kinks(left: Array, height: Array, theta: Array) -> Array:
    """The angles `theta` of a zone, with one more on each side of the density's largest kinks.

    left, height: distances of all kinks from the zone's left end, divided by its half width, and
    their heights. Angles too close to a kink are left out. The limit is `end_distance`, or an
    eighth of the mean distance between kinks if that is smaller.
    """
    if len(left) == 0:
        return theta
    away, order = min(OPTIONS.end_distance, 0.25 / len(left)), np.argsort(left)
    s = left[order] - 1
    largest = s[np.argsort(-np.abs(height[order]))[: OPTIONS.samples]]
    t = np.concatenate((np.cos(theta), largest - away, largest + away))
    place = np.searchsorted(s, t)
    distance = np.minimum(
        np.abs(t - s[np.maximum(place - 1, 0)]), np.abs(t - s[np.minimum(place, len(s) - 1)])
    )
    return np.asarray(np.arccos(t[(distance > 0.999 * away) & (np.abs(t) < 1)]))


def from_zones(
    density: Series, x: Array, zone: Index, shift: Array | float, potential: bool
) -> Array:
    """Transform or potential at points x of the density on zones that are moved by `shift`.
    It is the part of the field that one pole of the kernel, at this shift, causes.

    The result is pair by pair if all arrays are (n,). With x (n, 1) it has a column for each zone.
    """
    zones, w, jumps = density.zones, density.zones.half[zone], density.jumps
    seen = interval.OnLine.of(
        zones.beyond_a(x - shift, zone) / w, zones.before_b(x - shift, zone) / w
    )
    if potential:
        value = interval.potential_of(
            density.potential_coefficients, seen, w, density.kernel.datum, zone
        )
    else:
        value = interval.transform_of(*density.bounded, seen, zone)
    if seen.any_on:
        own = np.nonzero(seen.on)
        of, half, left, right = (
            zone[own[-1]],
            zones.half[zone[own[-1]]],
            seen.left[own],
            seen.right[own],
        )
        if potential:
            value[own] = half * interval.own_potential(
                density.potential_coefficients, of, left, right, half / density.kernel.datum
            )
        else:
            value[own] = interval.own_transform(density.coefficients, of, left, right)
    named = list(jumps.by_zone)
    if named:
        carried = np.zeros(len(zones), dtype=bool)
        carried[named] = True
        pairs = np.nonzero(np.broadcast_to(carried[zone], value.shape))
        of, there = zone[pairs[-1]], seen[pairs]
        if potential:
            sharp = jumps.sharp_potential(of, there)
            value[pairs] += zones.half[of] * (
                sharp + density.sharp_totals[of] * np.log(zones.half[of] / density.kernel.datum)
            )
        else:
            value[pairs] += jumps.transform(of, there)
    return np.asarray(value)


def regular_at(density: Series, x: Array, regular: Regular) -> Array:
    """Part of the transform or potential at points x that the kernel's regular part causes.

    It is summed by panels if the kernel has any, else by Gauss-Chebyshev quadrature on every zone.
    """
    if density.panel_moments is not None:
        panels, moments = density.panel_moments
        return panels.at(panels.spread(x), moments, regular is not density.kernel.regular)
    potential = regular is not density.kernel.regular
    kernel = density.kernel

    def values(some: Array, xi: Array) -> Array:
        return regular_values(kernel, some[:, 0], xi[0], potential)

    return by_quadrature(
        density.quadrature,
        x,
        values,
        BLOCKS.cache_pairs if np.isinf(kernel.length) else BLOCKS.memory_pairs,
    )


def by_quadrature(
    parts: list[tuple[Array, Array]],
    x: NDArray[Any],
    regular: Callable[..., NDArray[Any]],
    pairs: int = BLOCKS.cache_pairs,
) -> NDArray[Any]:
    """sum_j regular(x, xi_j) weight_j at real or complex x, in blocks of `pairs` pairs.

    parts: pairs (nodes xi, weights).
    """
    out = np.zeros(x.shape, dtype=np.result_type(x, *(weights for _, weights in parts)))
    for xi, weights in parts:
        block = max(1, pairs // weights.size)
        for s in range(0, len(x), block):
            out[s : s + block] += regular(x[s : s + block, None], xi[None, :]) @ weights
    return out


def moments_of(
    panels: Panels | Skeleton, zones: Zones, kernel: Kernel, table: Array, jumps: ForcingJumps
) -> Array:
    """Moments of a density on the panels of the kernel's regular part.

    table: coefficients of T_k / sqrt(1 - t^2) in the density without jumps, as in `quadrature`.
    """
    nodes, weights = (
        np.concatenate(parts)
        for parts in zip(*quadrature(zones, kernel, table, jumps), strict=True)
    )
    return panels.moments(panels.spread(nodes), weights)


def quadrature(
    zones: Zones, kernel: Kernel, table: Array, jumps: ForcingJumps
) -> list[tuple[Array, Array]]:
    """Quadrature nodes, and weights times density, for integrals with the kernel's regular part.
    The result is a list of pairs (nodes, weights times density).

    There is one pair for all zones with the same number of nodes. table: coefficients (zones,
    n + 1) of T_k / sqrt(1 - t^2) in the density without jumps.
    """
    m, panels = table.shape[1] - 1, panels_over(kernel, zones)
    sizes = (
        np.array([regular_size(kernel, w, m) for w in zones.half])
        if panels is None
        else panels.modes(zones.half) + 2
    )
    found = []
    for q in np.unique(sizes):
        group = np.flatnonzero(sizes == q)
        count = min(int(q), m + 1)
        xi = zones.middle[group][:, None] + zones.half[group][:, None] * chebyshev.gauss(int(q))
        c = table[group, :count]
        if len(jumps):
            count = int(q)
            c = widened(c, count) + jumps.t_coefficients(zones, count)[group]
        weights = chebyshev.t_values(c, int(q)) * (zones.half[group] / q)[:, None]
        found.append((xi.ravel(), weights.ravel()))
    return found
