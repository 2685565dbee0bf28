"""The density of an equation of the second kind, on its zones and off them."""

from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sie.basis import chebyshev, interval
from sie.basis.data import Array, Complex, Index, Mask, by_rows
from sie.basis.interval import InPlane, Outside, What, complex_of
from sie.basis.kernels import Kernel, Regular, regular_size
from sie.basis.lerch import complex_or_real
from sie.basis.power_jump import FAR_TERMS, rho_of, series, series_potential
from sie.basis.power_jump import OPTIONS as JUMPS
from sie.basis.sums import OPTIONS as BLOCKS
from sie.basis.weight import Weight
from sie.basis.weighted import JacobiFunctions, Split, from_ends
from sie.basis.zones import Zones
from sie.density.base import DensityBase
from sie.density.series import OPTIONS, angles_at_kinks, by_quadrature, even_angles
from sie.density.treecode import Treecode
from sie.jumps.logarithms import Logarithms
from sie.jumps.right_side import ForcingJumps
from sie.second_kind.jumps import Known, KnownJumps
from sie.second_kind.system import bases_of
from sie.trees.far import reaches
from sie.trees.panels import panels_over


@dataclass(frozen=True)
class TreeOptions:
    """Option for summing the fields of all zones at real points by a tree code."""

    min_zones: int = 32  # with fewer zones, a direct sum takes no longer


TREES = TreeOptions()


@dataclass(frozen=True, eq=False)
class SecondKindDensity(DensityBase):
    """Density of an equation with kappa: sum c_n S_n on each zone, S_n = weight * polynomial.

    S_n = sin(pi alpha) (1 - t)^(alpha - 1) (1 + t)^(-alpha) p_n(t), with cot(pi alpha) = kappa and
    orthogonal polynomials p_n (`sie.basis.weighted`). Calling the object gives the density at
    points of the line, zero off the zones.

    Attributes
    ----------
    zones : Zones
        The zones, Z of them.
    kernel : Kernel
        The kernel of the transform.
    coefficients : ndarray
        Coefficients c_n on each zone (Z, n + 1), complex for a complex kappa.
    amplitudes : ndarray
        Amplitudes of the equation's columns (k,).
    known : tuple of Known
        Closed-form parts of the density. Jumps of the right side inside zones and given values of
        the density at ends cause them.
    bounded_ends : bool
        Whether the intensities K at free ends, which are only round-off, are set to zero.
    beside : Logarithms or None
        Logarithmic terms of the right side that the plateaus beside the zones cause.

    Examples
    --------
    Sliding with friction: the pressure under a flat punch on -1 < x < 1 (theory: N. I.
    Muskhelishvili, Some Basic Problems of the Mathematical Theory of Elasticity, 1953, sect. 116).

    >>> import numpy as np, sie
    >>> slid = sie.Equation(sie.cauchy(), np.zeros_like, sie.Total(1.0), kappa=1.0)
    >>> density = sie.solve(slid, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR)).density
    >>> density.exponents.round(12).tolist()
    [[-0.25], [-0.75]]
    >>> float(round(density(0.0) * np.pi * np.sqrt(2), 12))
    1.0
    """

    zones: Zones
    kernel: Kernel
    coefficients: Array
    amplitudes: Array = field(default_factory=lambda: np.zeros(0))
    known: tuple[Known, ...] = ()
    bounded_ends: bool = False
    beside: Logarithms | None = None

    @property
    def whole(self) -> Any:
        """The density on the given zones, which is this object: no gap is a cut in a wider zone."""
        return self

    @property
    def slit_count(self) -> int:
        """Number of narrow gaps that are treated as cuts (slits) inside wider zones: zero here."""
        return 0

    @property
    def jumps(self) -> ForcingJumps:
        """No jumps: with kappa, the densities of the right side's jumps are in `known`."""
        return ForcingJumps.none()

    @property
    def sampling(self) -> Index:
        """Number of equidistant angles that resolve the density on each zone (Z,)."""
        counts = 2 * np.count_nonzero(self.coefficients, axis=1)
        for one in self._known_jumps:
            counts[one.zone] += 4 * len(one.factors)
        return np.maximum(counts, OPTIONS.samples)

    @cached_property
    def bases(self) -> list[JacobiFunctions]:
        """The basis functions S_n (weight times orthogonal polynomial) of each zone."""
        return bases_of(self.zones)

    @cached_property
    def _split(self) -> list[Split]:
        """The density on each zone as a `Split`, which keeps its digits close to bounded ends."""
        zero = self._vanishing
        return [
            basis.split(c, bool(left), bool(right))
            for basis, c, left, right in zip(self.bases, self.coefficients, *zero, strict=True)
        ]

    @property
    def _vanishing(self) -> Mask:
        """Mask (2, Z) of the left and right ends where the intensity K is only round-off."""
        return self.zones.bounded & ~(self.zones.moves & (not self.bounded_ends))

    @cached_property
    def intensities(self) -> tuple[Array, Array]:
        """Intensities K at both ends of each zone: the density is K d^(-p) at small distances d."""
        values = self.edge_values(self.coefficients.shape[1])
        ends = [np.sum(one * self.coefficients, axis=1) for one in values]
        left, right = self.zones.edge_scale * np.where(self._vanishing, 0.0, ends)
        return left, right

    def edge_values(self, count: int) -> tuple[Array, Array]:
        """Values of the polynomials p_n of S_n at left and at right ends, each (Z, count)."""
        every = np.array([basis.edge_values(count) for basis in self._families])
        left, right = every[self._family].transpose(1, 0, 2)
        return left, right

    @cached_property
    def _family(self) -> Index:
        """Index of each zone's kappa in the sorted list of the different kappas (Z,)."""
        return np.asarray(np.unique(self._kappa, return_inverse=True)[1])

    @cached_property
    def _families(self) -> list[JacobiFunctions]:
        """The basis functions S_n (weight times polynomial) for each different kappa of zones."""
        return [JacobiFunctions(one) for one in np.unique(self._kappa).tolist()]

    @property
    def _numbers(self) -> Any:
        """The type of the density's values, float or complex."""
        return self.zones.weight.numbers

    @property
    def _kappa(self) -> Array:
        kappa = self.zones.weight.kappa
        assert kappa is not None
        return kappa

    @cached_property
    def edge_slopes(self) -> tuple[Array, Array]:
        """Edge slopes A at the left and the right end of each zone.

        At the distance d from an end with the exponent p (`zones.weight.exponent`), the density is
        K d^(-p) + A d^(1 - p).
        """
        unit = np.eye(self.coefficients.shape[1])
        every = np.array(
            [np.array([basis.edge_slopes(one) for one in unit]).T for basis in self._families]
        )
        units = np.einsum("zsn,zn->sz", every[self._family], self.coefficients)
        for one in self.known:
            units[:, one.zone] += one.edge_slopes()
        left, right = units * self.zones.half ** (self.zones.weight.exponent - 1)
        return left, right

    @cached_property
    def totals(self) -> Array:
        """Integral of the density over each zone (Z,)."""
        out = np.pi * self.coefficients[:, 0]
        for one in self.known:
            out[one.zone] += one.total
        return np.asarray(self.zones.half * out)

    @property
    def total(self) -> Any:
        """Integral of the density over all zones and plateaus."""
        of_zones = complex_or_real(self.totals.sum())
        return of_zones + (0.0 if self.beside is None else self._plateaus.total)

    def moment(self, about: float = 0.0) -> Any:
        """Integral of (x - about) times the density."""
        zones = self.zones
        first = [
            basis.first_moment(c) for basis, c in zip(self.bases, self.coefficients, strict=True)
        ]
        of_jumps = np.zeros(len(zones))
        for one in self.known:
            of_jumps[one.zone] += 0.5 * np.pi * one.moments(2)[1]
        about_middles = zones.half**2 * (np.array(first) + of_jumps)
        of_plateaus = 0.0 if self.beside is None else self._plateaus.integral(lambda x: x - about)
        of_zones = np.sum((zones.middle - about) * self.totals + about_middles)
        return of_plateaus + complex_or_real(of_zones)

    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        """Density at points given by a zone and distances from the zone's ends in half widths."""
        zone, left, right = np.broadcast_arrays(
            np.asarray(zone, dtype=np.intp),
            np.asarray(left, dtype=float),
            np.asarray(right, dtype=float),
        )
        out = np.empty(zone.shape, dtype=self._numbers)
        with np.errstate(divide="ignore", invalid="ignore"):
            for i in np.unique(zone).tolist():
                here = zone == i
                out[here] = self._at(i, left[here], right[here])
        return out

    def _at(self, i: int, left: Array, right: Array) -> Array:
        """Density on zone i at distances left = 1 + t and right = 1 - t from its ends."""
        out = self.bases[i].density(self._split[i], left, right)
        for one in self.known:
            if one.zone == i:
                out = out + one.density(left, right)
        return np.asarray(out)

    def integral(self, x: ArrayLike) -> Array:
        """Integral of the density up to x from the left end of the zone that contains x.

        The integral is zero for x off the zones.
        """
        x, zone, inside = self.locate(x)
        out, at = np.zeros(x.shape, dtype=self._numbers), np.flatnonzero(inside.ravel())
        for i in np.unique(zone.ravel()[at]).tolist():
            here, w = at[zone.ravel()[at] == i], self.zones.half[i]
            left = (x.ravel()[here] - self.zones.a[i]) / w
            right = (self.zones.b[i] - x.ravel()[here]) / w
            out.ravel()[here] = self._integral_to(i, left, right)
        return out

    def integral_at(self, zone: ArrayLike, angle: ArrayLike) -> Array:
        """Integral of the density from a zone's left end to positions t = cos(angle) in it."""
        zone, angle = np.broadcast_arrays(np.asarray(zone, np.intp), np.asarray(angle, float))
        left, right = interval.sides(angle)
        out = np.empty(zone.shape, dtype=self._numbers)
        for i in np.unique(zone).tolist():
            out[zone == i] = self._integral_to(i, left[zone == i], right[zone == i])
        return out

    def _integral_to(self, i: int, left: Array, right: Array) -> Array:
        """Integral of the density on zone i from its left end to t; left = 1 + t, right = 1 - t."""
        value = self.bases[i].integral_to(self.coefficients[i], left, right)
        of_jumps = [one.integral_to(left, right) for one in self.known if one.zone == i]
        return np.asarray(self.zones.half[i] * (value + sum(of_jumps)))

    def opening(self, x: ArrayLike) -> tuple[Mask, Array]:
        """(False, 0) at every x, because no gap is treated as a cut (slit) in a wider zone."""
        shape = np.shape(x)
        return np.zeros(shape, dtype=bool), np.zeros(shape)

    @cached_property
    def sensitivity(self) -> tuple[Array, Array, Array]:
        """For each zone, the largest density and its largest changes by motions of the two ends.
        The result is (largest density, change by the left end, change by the right end).

        Changes are those at equal normalised position t, divided by the motion of the end in widths
        of the zone. A motion of the right end by eps widths changes a bounded density phi by
        eps ((1 + t) phi'(t) + 2 alpha A (1 - t)^(alpha - 1)), with the edge slope A at this end for
        the half width 1. Values closer to an end than `DensityOptions.end_distance` do not count.
        """
        out, counts = np.zeros((3, len(self.zones))), np.minimum(self.sampling, OPTIONS.max_angles)
        kinds = np.column_stack((self._family, counts))
        for number, count in np.unique(kinds, axis=0).tolist():
            group = np.flatnonzero((self._family == number) & (counts == count))
            out[:, group] = self._changes(group, even_angles(count))
        for zone in sorted({one.zone for one in self._known_jumps if one.order == 0}):
            at, heights = self._kinks_of(zone)
            angle = angles_at_kinks(at, heights, even_angles(int(counts[zone])))
            out[1:, zone] = self._changes(np.array([zone]), angle)[1:, 0]
        return out[0], out[1], out[2]

    @property
    def _known_jumps(self) -> list[KnownJumps]:
        """Closed forms of the densities due to jumps, without those of given values at ends."""
        return [one for one in self.known if isinstance(one, KnownJumps)]

    def _kinks_of(self, zone: int) -> tuple[Array, Array]:
        """(distances of kinks from the zone's left end in half widths, heights of these kinks)."""
        parts = [one for one in self._known_jumps if one.zone == zone and one.order == 0]
        at = np.concatenate([np.ravel(one.closed.left) for one in parts])
        return at, np.concatenate([one.factors for one in parts])

    def _changes(self, group: Index, angle: Array) -> Array:
        """The three results of `sensitivity` (3, zones) on the zones `group`, all of one kappa.

        Angles closer to an end than `DensityOptions.end_distance` are moved to that distance.
        """
        least = np.sqrt(2 * OPTIONS.end_distance)
        angle = np.clip(angle, least, np.pi - least)
        left, right = interval.sides(angle)
        basis = self._families[self._family[group[0]]]
        scale = self.zones.half ** (self.zones.weight.exponent - 1)
        at_left, at_right = (np.array(self.edge_slopes) / scale)[:, group, None]
        value, by_theta = interval.by_angle(partial(self._values, basis, group), angle)
        slope = -by_theta / np.sin(angle)
        moved_right = left * slope + 2 * basis.alpha * at_right * right**-basis.rest
        moved_left = right * slope - 2 * basis.rest * at_left * left**-basis.alpha
        return np.array([np.abs(one).max(axis=1) for one in (value, moved_left, moved_right)])

    def _values(self, basis: JacobiFunctions, group: Index, left: Array, right: Array) -> Array:
        """Density at the same scaled points of several zones with one kappa (zones, points).
        left, right: distances 1 + t and 1 - t of the points from the zones' ends.
        """
        split = basis.split(self.coefficients[group], *self._vanishing[:, group])
        out = basis.density(split, left, right)
        for one in self.known:
            out[group == one.zone] += one.density(left, right)
        return np.asarray(out)

    # The methods below give the fields of the density.
    def _on_line(self, x: Array, potential: bool) -> Array:
        """Transform, or potential if `potential` is true, at real x."""
        flat = self.into_period(x).ravel()
        if self._tree is None:
            out = by_rows(partial(self._sums_on_line, potential=potential), flat)
        else:
            # The sums over the tree contain the fields of the kernel's regular part too.
            of = self._tree.potential if potential else self._tree.transform
            return np.asarray(of(flat).reshape(x.shape))
        regular = self.kernel.regular_potential if potential else self.kernel.regular
        if regular is not None:
            out = out + self._regular(flat, regular)
        return np.asarray(out.reshape(x.shape))

    @cached_property
    def _tree(self) -> Any:
        """Tree code for sums over many zones; None for few zones or a kernel without tree sums."""
        few = len(self.zones) < TREES.min_zones
        if few or np.iscomplexobj(self._kappa) or not reaches(self.kernel, self.zones):
            return None
        if panels_over(self.kernel, self.zones) is not None:
            return None
        return SecondKindTree(self)  # type: ignore[arg-type]

    def first(self, count: int) -> Array:
        """The first `count` Chebyshev moments of the density of each zone (Z, count)."""
        out = np.empty((len(self.zones), count), dtype=self._numbers)
        for i, (basis, c) in enumerate(zip(self.bases, self.coefficients, strict=True)):
            known = sum(one.moments(count) for one in self.known if one.zone == i)
            out[i] = basis.moments(len(c), count) @ c + known
        return out

    def _sums_on_line(self, x: Array, potential: bool) -> Array:
        """Part of the transform, or of the potential, at real x due to the poles of the kernel."""
        out = np.zeros(len(x), dtype=self._numbers)
        for i in range(len(self.zones)):
            for shift in self.kernel.poles:
                out += self._of_zone(i, x - shift, potential)
        return out

    def _of_zone(self, i: int, x: Array, potential: bool) -> Array:
        """Transform or potential of zone i at real x (P,), without the zone's periodic images."""
        w, zone = self.zones.half[i], np.full(len(x), i)
        basis, c = self.bases[i], self.coefficients[i]
        left, right = self.zones.beyond_a(x, zone) / w, self.zones.before_b(x, zone) / w
        on = (left >= 0) & (right >= 0)
        beyond = np.where(right < 0, -right, -left)
        seen = Outside(np.where(right < 0, 1.0, -1.0)[~on], beyond[~on])
        out = np.empty(len(x), dtype=self._numbers)
        out[~on] = self._off_zone(i, seen, potential)
        of_zone = [one for one in self.known if one.zone == i]
        if on.any():
            left, right = left[on], right[on]
            if potential:
                own = basis.own_potential(c, left, right)
                for one in of_zone:
                    integral = one.integral_to(left, right)
                    own = own + one.own_level(left, right) - basis.kappa * integral
            else:
                own = basis.own(c, left, right) + sum(one.own(left, right) for one in of_zone)
                own = own - basis.kappa * self._at(i, left, right)
            out[on] = own
        if not potential:
            return out
        total = c[0] + sum(one.total for one in of_zone) / np.pi
        return np.asarray(w * (out + total * np.log(w / self.kernel.datum)))

    def _off_zone(self, i: int, seen: Outside, potential: bool) -> Array:
        """Transform of zone i at points off the zone; with `potential`, its potential instead.

        The potential is divided by the half width of the zone. Far away, a sum over moments takes
        less time than the closed forms.
        """
        basis, of_zone = self.bases[i], [one for one in self.known if one.zone == i]
        left, less = from_ends(seen)
        far = np.abs(rho_of(left, less)) < JUMPS.far
        out = np.empty(less.shape, dtype=self._numbers)
        near = Outside(np.asarray(seen.sign)[~far], seen.excess[~far])
        if far.any():
            of = series_potential if potential else series
            out[far] = of(self._far_moments[i], left[far], less[far])
        if potential:
            out[~far] = basis.potential_of(self.coefficients[i], near)
            out[~far] += sum(one.potential(near) for one in of_zone)
        else:
            out[~far] = basis.split_transform(self._split[i], near)
            out[~far] += sum(one.transform(near) for one in of_zone)
        return out

    @cached_property
    def _far_moments(self) -> list[Array]:
        """The Chebyshev moments of each zone's density that determine its field far away."""
        return list(self.first(FAR_TERMS))

    def _regular(self, x: Any, regular: Regular) -> Any:
        """Part of the transform (or potential) at points x due to the smooth kernel `regular`."""
        return by_quadrature(self._quadrature, x, regular, BLOCKS.cache_pairs)

    @cached_property
    def _quadrature(self) -> list[tuple[Array, Array]]:
        """Pairs (nodes, weights times density) for integrals with the kernel's regular part."""
        return [self._rule(i, basis) for i, basis in enumerate(self.bases)]

    def _rule(self, i: int, basis: JacobiFunctions) -> tuple[Array, Array]:
        """(nodes, weights times density) on zone i that resolve the kernel's regular part."""
        c, w = self.coefficients[i], float(self.zones.half[i])
        q = regular_size(self.kernel, w, len(c) - 1)
        series = basis.moments(len(c), q) @ c
        series = series + sum(one.moments(q) for one in self.known if one.zone == i)
        x = self.zones.middle[i] + w * chebyshev.gauss(q)
        return x, chebyshev.t_values(series, q) * (w / q)

    def plane(self, z: Complex, what: What) -> Complex:
        """Transform or its derivative at complex points z (n,)."""
        if what == "potential":
            raise ValueError("with kappa the potential is known only at real points")
        if np.iscomplexobj(self.coefficients):
            out, below = np.empty(len(z), dtype=complex), z.imag < 0
            out[~below] = self._above(z[~below], what)
            # Below the real line, the transform at z is the conjugate of the transform of the
            # conjugate density at conj(z).
            out[below] = np.conj(self._conjugate._above(np.conj(z[below]), what))
            return out
        above = self._above(z.real + 1j * np.abs(z.imag), what)
        return np.where(z.imag < 0, np.conj(above), above)

    @cached_property
    def _conjugate(self) -> "SecondKindDensity":
        """The density with conjugate values."""
        zones = replace(self.zones, weight=Weight(np.conj(self._kappa)))
        return replace(self, zones=zones, coefficients=np.conj(self.coefficients))

    def _above(self, z: Complex, what: What) -> Complex:
        """Transform or its derivative at points z (n,) of the closed upper half plane."""
        x, y = self.into_period(z.real), np.abs(z.imag)
        out = np.zeros(len(x), dtype=complex)
        for i, basis in enumerate(self.bases):
            w, zone = self.zones.half[i], np.full(len(x), i)
            for shift in self.kernel.poles:
                from_a = self.zones.beyond_a(x - shift, zone) / w
                from_b = -self.zones.before_b(x - shift, zone) / w
                seen = InPlane.of(from_a, from_b, y / w)
                if what == "transform":
                    out += basis.split_transform(self._split[i], seen)
                else:
                    out += basis.split_slope(self._split[i], seen) / w
                for one in (one for one in self.known if one.zone == i):
                    away, is_slope = (x[:, None] - shift - one.x) / w, what == "derivative"
                    value = one.in_plane(seen, (away, y / w, is_slope))
                    out += value / w if is_slope else value
        regular = self.kernel.regular_of(what)
        if regular is not None:
            out = out + self._regular(complex_of(x, y), regular)
        return np.where(z.imag < 0, np.conj(out), out)


class SecondKindTree(Treecode):
    """Tree code for the fields of a density with kappa; near zones use their closed forms."""

    density: SecondKindDensity  # type: ignore[assignment]

    def _beyond(self, x: Array, potential: bool) -> Array:
        return self.density._sums_on_line(x, potential)

    def _near(self, x: Array, source: Index, shift: Array, potential: bool) -> Array:
        out, order = np.empty(len(x)), np.argsort(source, kind="stable")
        cuts = np.flatnonzero(np.diff(source[order], prepend=-1, append=-1))
        for lo, hi in zip(cuts[:-1], cuts[1:], strict=True):
            here = order[lo:hi]
            zone = int(source[here[0]])
            out[here] = self.density._of_zone(zone, x[here] - shift[here], potential)
        return out
