"""The density on zones with graded coordinates, and its fields on the line and in the plane.

On a zone the density is psi(s) / (dx/ds), psi(s) = sum c_l T_l(s) / sqrt(1 - s^2), with the graded
coordinate s of `sie.graded.grading`. The transform of one zone at a place x of coordinate s is

    (1/pi) int psi(s') ds' / (x - x') = (Q(s) + sum_k (F_k / n) R(s, s_k)) / (dx/ds),
    R(s, s') = (dx/ds) / (x - x') - 1 / (s - s'),

Q is the transform of psi in s, which is known in closed form. The smooth R is integrated by Gauss's
rule: s_k are its n nodes on the zone, and F_k the values of psi sqrt(1 - s^2) at the nodes. Far
from a zone Gauss's rule is enough for 1 / (x - x') itself. Potentials are split in the same way.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sie.basis import chebyshev, interval
from sie.basis.data import DIGITS, EPS, Array, Complex, Index, Mask, by_rows
from sie.basis.interval import InPlane, OnLine, What, complex_of, excess_of
from sie.basis.kernels import Kernel, Regular
from sie.basis.lag_table import regular_values
from sie.basis.sums import OPTIONS as BLOCKS
from sie.basis.zones import Zones
from sie.density.base import DensityBase
from sie.density.density import Density
from sie.graded.grading import Places
from sie.graded.system import GradedSystem, resolving_sizes
from sie.jumps.right_side import ForcingJumps


@dataclass(frozen=True, eq=False)
class GradedDensity(DensityBase):
    """The density phi on zones beside narrow gaps, each zone with a graded coordinate s.

    This class has the members of `Density`. The function `solve_zones` creates its objects.

    Attributes
    ----------
    system : GradedSystem
        The zones, their graded coordinates and the nodes of Gauss's rule.
    unknowns : ndarray
        The charges F_k at the nodes, then the amplitudes of the equation's columns.
    bounded_ends : bool
        Whether terms 1/sqrt(d) that round-off causes at free ends are removed; see
        `Density.with_bounded_ends`.
    forced : bool
        Whether the density includes the closed-form density of the right side's jumps. The response
        to other values of side conditions does not include it.

    Examples
    --------
    Plates in tandem, 1e-12 of their width apart; F(z) = 1 - sqrt((z - b) (z - b') / (z - a) (z -
    a')) with leading edges a, a' and trailing edges b, b'.

    >>> import numpy as np, sie
    >>> plates = sie.Zones.of([[-1.0, 0.0], [1e-12, 1.0]], sie.SINGULAR, sie.BOUNDED)
    >>> density = sie.solve(sie.Equation(sie.cauchy(), np.ones_like), plates).density
    >>> type(density).__name__, float(round(density.total / np.pi, 10))
    ('GradedDensity', 1.0)
    """

    system: GradedSystem = field(repr=False)
    unknowns: Array = field(repr=False)
    bounded_ends: bool = False
    forced: bool = True

    @property
    def zones(self) -> Zones:
        return self.system.zones

    @property
    def kernel(self) -> Kernel:
        return self.system.equation.kernel

    @property
    def whole(self) -> GradedDensity:
        """The density on the given zones, which is this object: no gap is a cut in a wider zone."""
        return self

    @property
    def slit_count(self) -> int:
        """Number of narrow gaps that are treated as cuts (slits) inside wider zones: zero here."""
        return 0

    def opening(self, x: ArrayLike) -> tuple[Mask, Array]:
        """(mask of the points x in slits, integral of the slit's unknown): False and zero.

        A slit is a narrow gap that is treated as a cut inside a wider zone. This density has none.
        """
        shape = np.shape(x)
        return np.zeros(shape, dtype=bool), np.zeros(shape)

    @property
    def jumps(self) -> ForcingJumps:
        """The jumps of the right side within the zones."""
        closed = self.system.closed
        return closed.jumps if self.forced and closed is not None else ForcingJumps.none()

    @property
    def closed(self) -> Density | None:
        """Density due to jumps of the right side, in closed form; None if there are no jumps."""
        closed = self.system.closed
        return closed.density if self.forced and closed is not None else None

    @property
    def amplitudes(self) -> Array:
        return self.unknowns[self.system.nodes :]

    @cached_property
    def fine(self) -> tuple[GradedSystem, Array]:
        """A system with more nodes, and its unknowns. The nodes resolve psi = density * dx/ds.

        The unknowns of the solved system may be the smoother quotient psi / `Grading.scale`. The
        scale is singular at the distance pi/B from the real axis of s, with B = `Grading.stretch`.
        Therefore psi needs more nodes.
        """
        system, divided = self.system, self.powers.any(axis=0)
        most = np.maximum(system.sizes, resolving_sizes(system.gradings))
        sizes = np.where(divided, most, system.sizes)
        if np.all(sizes == system.sizes):
            return system, self.unknowns
        jumps = self.system.closed.jumps if self.system.closed else ForcingJumps.none()
        finer = GradedSystem(system.equation, system.zones, sizes, jumps)
        return finer, system.on_finer(self.unknowns, self.powers, finer)

    @property
    def nodes(self) -> GradedSystem:
        """The system whose nodes are the quadrature nodes for fields of the density; see `fine`."""
        return self.fine[0]

    @cached_property
    def coefficients(self) -> Array:
        """Coefficients (Z, n) of psi = density * dx/ds = sum c_l T_l(s) / sqrt(1 - s^2)."""
        return self.nodes.series(self.fine[1])

    @cached_property
    def sampling(self) -> Index:
        """Number of angles that resolve the density on each zone (Z,)."""
        return 2 * self.system.sizes

    @cached_property
    def powers(self) -> Array:
        """1 or 0 (2, Z): whether psi is divided by the left and right factor of `Grading.scale`.

        psi is the density times dx/ds. `GradedSystem.powers_for` chooses these powers.
        """
        return self.system.powers_for(self.unknowns)

    @cached_property
    def divided(self) -> Array:
        """Coefficients (Z, n) of psi / `Grading.scale` on each zone; psi = density * dx/ds."""
        return self.system.series(self.unknowns, self.powers)

    @cached_property
    def _psi(self) -> tuple[Array, Array, Array]:
        """(alpha, beta, u) of density * dx/ds = (alpha + beta s) / X + X sum u_k U_k.

        X = sqrt(1 - s^2), with the graded coordinate s.
        """
        return self._bounded(self.coefficients)

    @cached_property
    def _series(self) -> tuple[Array, Array, Array]:
        """(alpha, beta, u) as in `_psi`, but for the density * dx/ds divided by `Grading.scale`."""
        return self._bounded(self.divided)

    def _bounded(self, c: Array) -> tuple[Array, Array, Array]:
        """(alpha, beta, u) of (alpha + beta s) / X + X sum u_k U_k; c: coefficients of T_l / X.

        With `bounded_ends`, the unbounded terms are set to zero at moving bounded ends.
        """
        alpha, beta, u = chebyshev.bounded_part(c)
        if self.bounded_ends:
            left, right = self.zones.moves & self.zones.bounded
            k_left, k_right = np.where(left, 0.0, alpha - beta), np.where(right, 0.0, alpha + beta)
            alpha, beta = 0.5 * (k_left + k_right), 0.5 * (k_right - k_left)
        return alpha, beta, u

    @cached_property
    def charges(self) -> Array:
        """Weight F_k / n of each node of `nodes` in Gauss's rule; see the head of this file."""
        system, unknowns = self.fine
        return np.asarray(unknowns[: system.nodes] * system.weights)

    # The methods below give values and integrals of the density on the zones.
    def places(self, zone: int, left: Array, right: Array) -> Places:
        """`Places` on a zone, from distances left and right from its ends in half widths."""
        half = self.zones.half[zone]
        return self.system.gradings[zone].of(half * left, half * right)

    def on(self, zone: int, places: Places) -> Array:
        """The density at places of a zone."""
        row = np.full(np.shape(places.u), zone, dtype=np.intp)
        left, right = np.maximum(places.left, 0.0), np.maximum(places.right, 0.0)
        psi = interval.values_on(self._series, row, left, right, self.zones.bounded)
        scale = self.system.gradings[zone].scale(places, self.powers[:, zone])
        out = np.asarray(psi * (scale / places.rate))
        if self.closed is None:
            return out
        half = self.zones.half[zone]
        return out + self.closed.at(zone, places.from_a / half, places.from_b / half)

    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        of, lefts, rights = np.broadcast_arrays(
            np.asarray(zone, dtype=np.intp), np.asarray(left, float), np.asarray(right, float)
        )
        out = np.empty(of.shape)
        for i in np.unique(of).tolist():
            here = of == i
            out[here] = self.on(i, self.places(i, lefts[here], rights[here]))
        return out

    def integral_at(self, zone: ArrayLike, angle: ArrayLike) -> Array:
        """Integral of the density from a zone's left end to its point t = cos(angle).

        t runs from -1 at the left end of the zone to 1 at its right end.
        """
        of, angles = np.broadcast_arrays(np.asarray(zone, dtype=np.intp), np.asarray(angle, float))
        return self._integral(of, *interval.sides(angles))

    def integral(self, x: ArrayLike) -> Array:
        """Integral of the density up to x from the left end of the zone that contains x.

        The integral is zero for x off the zones.
        """
        x, i, inside = self.locate(x)
        out, z = np.zeros(x.shape), i[inside]
        w = self.zones.half[z]
        sides = self.zones.beyond_a(x[inside], z) / w, self.zones.before_b(x[inside], z) / w
        out[inside] = self._integral(z, *(np.maximum(side, 0.0) for side in sides))
        return out

    def _integral(self, zone: Index, left: Array, right: Array) -> Array:
        """Integral of the density from the left end of each zone to a point of the zone.

        left, right: distances of the point from the zone's ends, in half widths.
        """
        out = np.empty(zone.shape)
        for i in np.unique(zone).tolist():
            here = zone == i
            places = self.places(i, left[here], right[here])
            angle = interval.theta(np.maximum(places.left, 0.0), np.maximum(places.right, 0.0))
            row = np.full(angle.shape, i, dtype=np.intp)
            out[here] = interval.integral_on(self.coefficients, row, angle)
        if self.closed is not None:
            out += self.closed.integral_at(zone, interval.theta(left, right))
        return out

    @cached_property
    def totals(self) -> Array:
        """Integral of the density over each zone (Z,)."""
        out = np.asarray(np.pi * self.coefficients[:, 0])
        return out if self.closed is None else out + self.closed.totals

    @property
    def total(self) -> float:
        """Integral of the density over all zones."""
        return float(self.totals.sum())

    def moment(self, about: float = 0.0) -> float:
        """Integral of (x - about) times the density."""
        out = float(np.pi * self.charges @ (self.nodes.source_x - about))
        return out if self.closed is None else out + self.closed.moment(about)

    @cached_property
    def _end_rates(self) -> Array:
        """dx/ds (2, Z) at the left and right end of each zone, with the graded coordinate s."""
        return np.array([grading.end_rates for grading in self.system.gradings]).T

    @cached_property
    def _end_scales(self) -> Array:
        """`Grading.scale`, the divisor of psi, at the left and right ends of the zones (2, Z)."""
        pairs = zip(self.system.gradings, self.powers.T, strict=True)
        return np.array([grading.scale(grading.ends, powers) for grading, powers in pairs]).T

    @cached_property
    def intensities(self) -> tuple[Array, Array]:
        """Intensities K at both ends of each zone; K is the coefficient of 1 / sqrt(distance)."""
        alpha, beta, _ = self._series
        charges = self._end_scales * np.array([alpha - beta, alpha + beta])
        left, right = charges / np.sqrt(2 * self._end_rates)
        return left, right

    @cached_property
    def edge_slopes(self) -> tuple[Array, Array]:
        """Edge slopes A at both ends of each zone; A is the coefficient of sqrt(distance).

        Let e be the distance from an end in s, q the factor `Grading.scale`, which depends on s,
        and m = dx/ds. Next to the end, psi is q (k / sqrt(e) + a sqrt(e)). With the derivatives m'
        and q' towards the outside of the zone, A = q (a - k q'/q + 3/4 k m'/m) / m^(3/2).
        """
        alpha, beta, _ = self._series
        at_ends = chebyshev.slopes_at_ends(self.divided)
        one = np.ones(len(self.zones))
        slopes = np.array(interval.edge_slopes(alpha, beta, *at_ends, one))
        k = np.array(interval.intensities(alpha, beta, one))
        pairs = list(zip(self.system.gradings, self.powers.T, strict=True))
        bends = np.array(
            [0.75 * grading.end_bends - grading.scale_bends(powers) for grading, powers in pairs]
        ).T
        outward = bends * np.array([[-1.0], [1.0]])
        out = self._end_scales * (slopes + k * outward) / self._end_rates**1.5
        left, right = out if self.closed is None else out + np.array(self.closed.edge_slopes)
        return left, right

    @cached_property
    def sensitivity(self) -> tuple[Array, Array, Array]:
        """Largest density on each zone, and its largest changes by motions of the zone's two ends.

        See `Density.sensitivity`. All are absolute values at the nodes, times sqrt(1 - t^2), where
        t runs from -1 to 1 on the zone.
        """
        out = np.zeros((3, len(self.zones)))
        for zone in range(len(self.zones)):
            out[:, zone] = [size.max() for size in self._changes_on(zone)]
        return out[0], out[1], out[2]

    def _changes_on(self, zone: int) -> list[Array]:
        """[density, its change by a motion of the left end, of the right end] at a zone's nodes.

        They are absolute values times sqrt(1 - t^2). The slope of the density is a central
        difference in s: beside a narrow gap, steps in s are short steps in x.
        """
        grading, half, n = (
            self.system.gradings[zone],
            self.zones.half[zone],
            self.system.sizes[zone],
        )
        angle = (np.arange(n) + 0.5) * (np.pi / n)
        step = np.cbrt(EPS) * angle.min()
        here, there = (grading.at(*interval.sides(angle + by)) for by in (-step, step))
        lag = np.where(
            here.from_a < here.from_b, there.from_a - here.from_a, here.from_b - there.from_b
        )
        places = self.system.sources[zone]
        theta = interval.theta(places.from_a / half, places.from_b / half)
        rise = (self.on(zone, there) - self.on(zone, here)) / lag
        scale = self.zones.slope_scale[zone]
        at_left, at_right = (one[zone] / scale for one in self.edge_slopes)
        slope = -rise * half * np.sin(theta)
        changes = interval.end_changes(slope, at_left, at_right, theta)
        return [np.abs(one) * np.sin(theta) for one in (self.on(zone, places), *changes)]

    # The methods below give the transform and the potential.
    def _smooth(self, zone: int, places: Places) -> NDArray[Any]:
        """Part of a zone's transform, times dx/ds, due to the smooth R (head of this file)."""
        matrix = self.system.gradings[zone].smooth_kernel(places, self.nodes.sources[zone])
        return np.asarray(matrix @ self.charges[self.nodes.own(zone)])

    def _on_line(self, x: Array, potential: bool) -> Array:
        flat = self.into_period(x).ravel()
        field = self._potential_at if potential else self._transform_at
        return np.asarray(by_rows(field, flat, max_rows=self.block)).reshape(x.shape)

    @property
    def block(self) -> int:
        """Number of points that are evaluated together, so that tables of pairs fit into memory."""
        return max(1, BLOCKS.memory_pairs // self.nodes.nodes)

    def _transform_at(self, x: Array) -> Array:
        """Transform at real points of one period."""
        out = self._poles_at(x, "transform") + self._regular_at(x, self.kernel.regular)
        return out if self.closed is None else out + self.closed.transform(x)

    def _potential_at(self, x: Array) -> Array:
        """Potential at real points of one period."""
        out = self._poles_at(x, "potential")
        out = out + self._regular_at(x, self.kernel.regular_potential)
        return out if self.closed is None else out + self.closed.potential(x)

    def _poles_at(self, x: Array, what: What) -> Array:
        """Part of the density's field at real points that the poles of the kernel cause."""
        out = np.zeros(x.shape)
        for shift in self.kernel.poles:
            for zone in range(len(self.zones)):
                out += self.of_zone(zone, *self.from_ends(zone, x - shift), what)
        return out

    def _regular_at(self, x: Array, regular: Regular | None) -> Array | float:
        """Part of the density's field at real points that the kernel's regular part causes."""
        if regular is None:
            return 0.0
        potential = regular is not self.kernel.regular
        values = regular_values(self.kernel, x, self.nodes.source_x, potential)
        return np.asarray(values @ self.charges)

    def from_ends(self, zone: int, x: Array) -> tuple[Array, Array]:
        """Signed distances of places x from the left and from the right end of a zone."""
        index = np.array(zone, dtype=np.intp)
        return self.zones.beyond_a(x, index), self.zones.before_b(x, index)

    def of_zone(self, zone: int, from_a: Any, from_b: Any, what: What) -> NDArray[Any]:
        """Field of one zone at real or complex places with the given distances from its ends."""
        grading, out = self.system.gradings[zone], np.zeros(from_a.shape, dtype=from_a.dtype)
        near = self._near(zone, from_a, from_b)
        out[~near] = self._far(zone, from_a[~near], from_b[~near], what)
        places = grading.of(from_a[near], from_b[near])
        out[near] = self._split(zone, places, what)
        return out

    def _near(self, zone: int, from_a: Any, from_b: Any) -> Mask:
        """Mask of places so close to a zone that Gauss's rule for 1 / (x - x') is not accurate."""
        grading, n = self.system.gradings[zone], int(self.nodes.sizes[zone])
        # Gauss's rule with n nodes has the error rho^(2 n), where rho is |s - sqrt(s^2 - 1)| and s
        # the graded coordinate of the place.
        excess = excess_of(0.5 * DIGITS / n)
        real = np.real(from_a) > -grading.before, np.real(from_b) > -grading.after
        with np.errstate(invalid="ignore", divide="ignore"):
            places = grading.of(from_a, from_b)
            size = 0.5 * (np.abs(places.left) + np.abs(places.right))
        return np.asarray(np.logical_and(*real) & (size - 1 < excess))

    def _far(self, zone: int, from_a: Any, from_b: Any, what: What) -> NDArray[Any]:
        """Field of one zone at places far from the zone, by Gauss's rule."""
        sources, charges = self.nodes.sources[zone], self.charges[self.nodes.own(zone)]
        beyond_b = (np.real(from_b) < 0.5 * np.real(from_a + from_b))[:, None]
        lag = np.where(beyond_b, sources.from_b - from_b[:, None], from_a[:, None] - sources.from_a)
        if what == "transform":
            return np.asarray((1 / lag) @ charges)
        if what == "derivative":
            return np.asarray(-(1 / lag**2) @ charges)
        return np.asarray(np.log(lag if np.iscomplexobj(lag) else np.abs(lag)) @ charges) - float(
            np.log(self.kernel.datum) * charges.sum()
        )

    def _split(self, zone: int, places: Places, what: What) -> NDArray[Any]:
        """Field of one zone at places on or near it; the kernel's pole is integrated exactly."""
        row, c = np.full(places.u.shape, zone, dtype=np.intp), self.coefficients
        if np.iscomplexobj(places.u):
            # A place on the zone counts as a place on the zone's upper side, whether its imaginary
            # part is 0.0 or -0.0.
            seen: Any = InPlane(_upper(places.left), _upper(-places.right))
            on = np.zeros(places.u.shape, dtype=bool)
        else:
            seen = OnLine.of(places.left, places.right)
            on = seen.on
        if what == "potential":
            divided = c / np.maximum(np.arange(c.shape[1]), 1)
            closed = interval.potential_of(divided, seen, np.ones(len(row)), 1.0, row)
            if on.any():
                some = places[on]
                closed[on] = interval.own_potential(
                    divided, row[on], some.left, some.right, np.ones(len(row[on]))
                )
            grading, sources = self.system.gradings[zone], self.nodes.sources[zone]
            charges = self.charges[self.nodes.own(zone)]
            rest = (grading.log_ratio(places, sources) - np.log(self.kernel.datum)) @ charges
            return np.asarray(closed + rest)
        closed = interval.transform_of(*self._psi, seen, row)
        if on.any():
            some = places[on]
            closed[on] = interval.own_transform(c, row[on], some.left, some.right)
        both = closed + self._smooth(zone, places)
        if what == "transform":
            return np.asarray(both / places.rate)
        slope = interval.transform_slope_of(*self._psi, seen, row)
        grading, sources = self.system.gradings[zone], self.nodes.sources[zone]
        slope = (
            slope
            + grading.smooth_kernel_slope(places, sources) @ (self.charges[self.nodes.own(zone)])
        )
        bend = grading.stretch * np.tanh(0.5 * places.u)
        return np.asarray((slope + bend * both) / places.rate**2)

    @property
    def plane(self) -> GradedPlane:
        """The fields of the density at complex points."""
        return GradedPlane(self)


@dataclass(frozen=True)
class GradedPlane:
    """The transform of a graded density, its derivative, and its potential at complex points."""

    density: GradedDensity

    def __call__(self, z: Complex, what: What) -> Complex:
        """The transform, its derivative, or the potential at complex points z (n,)."""
        density, kernel = self.density, self.density.kernel
        x, y = z.real, np.abs(z.imag)
        place = density.into_period(x)

        def upper(x: Array, y: Array) -> Complex:
            return self._upper(x, y, what)

        out = np.asarray(by_rows(upper, place, y, max_rows=density.block))
        if what == "potential":
            turns = np.full(len(x), float(sum(shift > 0 for shift in kernel.poles)))
            if kernel.period is not None:
                turns += np.round((x - place) / kernel.period)
            out = out - 1j * np.pi * density.charges.sum() * turns
        out = np.where(z.imag < 0, np.conj(out), out)
        return out if density.closed is None else out + density.closed.plane(z, what)

    def _upper(self, x: Array, y: Array, what: What) -> Complex:
        """Transform, its derivative or potential (`what`) at x + i y, y >= 0, of one period."""
        density = self.density
        out = np.zeros(len(x), dtype=complex)
        for shift in density.kernel.poles:
            for zone in range(len(density.zones)):
                from_a, from_b = density.from_ends(zone, x - shift)
                out += density.of_zone(zone, complex_of(from_a, y), complex_of(from_b, -y), what)
        regular = density.kernel.regular_of(what)
        if regular is not None:
            points: Any = complex_of(x, y)
            out += np.asarray(regular(points[:, None], density.nodes.source_x)) @ density.charges
        return out


def _upper(z: Complex) -> Complex:
    """Complex numbers z with their imaginary part replaced by |Im z|."""
    return complex_of(z.real, np.abs(z.imag))
