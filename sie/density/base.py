"""Base class of densities: values on the line, fields on the line and at complex points."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sie.basis.data import Array, Complex, Index, Kept, Mask, nearest_image, wrapped
from sie.basis.interval import What, by_angle, complex_of, end_changes
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.jumps.logarithms import Logarithms, Plateaus


class DensityBase(Kept):
    """Base class of densities, evaluated by zone and distances from the zone's ends.

    A subclass is a data class with a field `bounded_ends`.
    """

    if TYPE_CHECKING:

        @property
        def zones(self) -> Zones: ...
        @property
        def kernel(self) -> Kernel: ...
        @property
        def edge_slopes(self) -> tuple[Array, Array]: ...
        @property
        def plane(self) -> Callable[[Complex, What], Complex]:
            """Transform of the density, its derivative, and the potential, at complex points."""

    @property
    def beside(self) -> Logarithms | None:
        """Logarithms in the fields of plateaus; None if there are none.
        A plateau is an interval beside a zone, on which the density is a given constant.
        """
        return None

    @property
    def plateaus(self) -> Array:
        """Plateaus (m, 2): intervals outside the zones, on which the density has given values."""
        return np.zeros((0, 2)) if self.beside is None else self._plateaus.table

    @property
    def _plateaus(self) -> Plateaus:
        assert self.beside is not None and self.beside.plateaus is not None
        return self.beside.plateaus

    @property
    def upper_bound(self) -> float:
        """An upper bound of the density's values that takes little time; inf if none is known."""
        return math.inf

    @property
    def exponents(self) -> Array:
        """Exponents of the density at left and right ends (2, Z): density ~ distance^exponent.

        `intensities` are the limits of density * d^(-exponent); d is the distance from the end. The
        exponents are -1/2 unless the equation has a kappa.
        """
        exponent = -np.asarray(self.zones.weight.exponent)
        return np.broadcast_to(exponent, (2, len(self.zones))).copy()

    def with_bounded_ends(self) -> Self:
        """This density without the terms in 1/sqrt(distance) that round-off causes at free ends.

        An error delta of an end causes the intensity K = A delta / 2, where A is the coefficient of
        sqrt(d). At equal normalised position, the error of the rest of the density is about delta
        divided by the width. The part K / sqrt(d) would grow without bound near the end.
        """
        return replace(self, bounded_ends=True)  # type: ignore[type-var]

    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        """Density at points, each given by its zone and the distances from both ends of the zone.
        The distances are divided by the half width.

        left + right = 2; no digit is lost close to the ends.
        """
        raise NotImplementedError

    def at_t(self, zone: ArrayLike, t: ArrayLike) -> Array:
        """Density on zones at normalised positions t, which run from -1 to 1."""
        t = np.asarray(t, dtype=float)
        return self.at(zone, 1 + t, 1 - t)

    def by_angle(self, zone: ArrayLike, angle: Array) -> tuple[Array, Array]:
        """(density, d density / d angle) on zones, at t = cos(angle).

        The derivative is a central difference.
        """
        return by_angle(lambda left, right: self.at(zone, left, right), angle)

    def change_sizes(self, zone: Any, angle: Array) -> tuple[Array, Array, Array]:
        """Absolute values of the density and of its changes by motions of the left and right ends.

        They are taken at the given angles on zones. For the changes see `Density.sensitivity`.
        """
        value, slope = self.by_angle(zone, angle)
        at_left, at_right = (one[zone] / self.zones.slope_scale[zone] for one in self.edge_slopes)
        by_left, by_right = end_changes(slope, at_left, at_right, angle)
        return np.abs(value), np.abs(by_left), np.abs(by_right)

    def largest_changes(self, zones: Index, angles: list[Array]) -> Array:
        """Largest values, on each zone, of |density| and of its changes by motions of the two ends.
        The shape is (3, Z), see `change_sizes`.

        zones: the zones to evaluate; all others get zero. angles: for each of `zones`, the angles.
        """
        zone, out = np.repeat(zones, [len(one) for one in angles]), np.zeros((3, len(self.zones)))
        for largest, size in zip(out, self.change_sizes(zone, np.concatenate(angles)), strict=True):
            np.maximum.at(largest, zone, size)
        return out

    def locate(self, x: ArrayLike) -> tuple[Array, Index, Mask]:
        """(moved x, index of a zone for each x, whether x lies inside this zone).

        x is moved by whole periods to lie right of the first zone's left end. The zone is the last
        one that starts before x.
        """
        zones = self.zones
        place = wrapped(np.asarray(x, dtype=float), zones.a[0], self.kernel.period)
        i = np.asarray(np.maximum(np.searchsorted(zones.a, place, side="right") - 1, 0))
        return place, i, np.asarray((place >= zones.a[i]) & (place <= zones.b[i]))

    def into_period(self, x: Array) -> Array:
        """x moved by whole periods to within half a period of the middle of all zones.

        For such points, the shifts `kernel.poles` lead to the images of the zones nearest to x.
        """
        return nearest_image(x, 0.5 * (self.zones.a[0] + self.zones.b[-1]), self.kernel.period)

    def __call__(self, x: ArrayLike) -> Array:
        """Density at x (any shape). It is zero off the zones, except on plateaus beside zones,
        where it has a given constant value.
        """
        x, i, inside = self.locate(x)
        out = np.where(np.isnan(x), np.nan, 0.0).astype(self.zones.weight.numbers)
        z, w = i[inside], self.zones.half[i[inside]]
        out[inside] = self.at(
            z, (x[inside] - self.zones.a[z]) / w, (self.zones.b[z] - x[inside]) / w
        )
        if self.beside is not None:
            out[~inside] += self._plateaus.density(x[~inside], self.kernel.period)
        return out

    def transform(self, x: ArrayLike) -> NDArray[Any]:
        """Transform (1/pi) PV int phi(xi) K(x, xi) dxi of the density phi at any x; K: the kernel.

        x has any shape. The transform is infinite at a singular end. At complex x it is the
        analytic continuation F(x), see `sie.density.plane`; a zero imaginary part stands for the
        upper side of the line.
        """
        if np.iscomplexobj(x):
            return self._in_plane(x, "transform")
        x = np.asarray(x, dtype=float)
        if self.beside is None:
            return self._on_line(x, False)
        x = self.beside.off_positions(x)
        return self._on_line(x, False) - self.beside.at_points(x.ravel()).reshape(x.shape)

    def potential(self, x: ArrayLike) -> NDArray[Any]:
        """Potential (1/pi) int phi(xi) Lambda(x, xi) dxi of the density phi at any x.

        Lambda is the potential of the kernel. x has any shape. At complex x the result is the
        complex potential W, whose derivative is the transform. The real part of W is the harmonic
        function that equals the potential on the line. W is analytic in either half plane,
        W(conj x) = conj W(x), and W is real on the line right of all zones (with a period: between
        the last zone and the next).
        """
        if np.iscomplexobj(x):
            return self._in_plane(x, "potential")
        if self.kernel.regular is not None and self.kernel.regular_potential is None:
            raise ValueError(
                "the regular kernel has no potential: give it, as in sie.Smooth(value, potential)"
            )
        x = np.asarray(x, dtype=float)
        out = self._on_line(x, True)
        if self.beside is not None:
            out = out - self.beside.primitive_at(x.ravel()).reshape(x.shape)
        return out

    def _on_line(self, x: Array, potential: bool) -> Array:
        """Transform, or potential if `potential` is true, at real x."""
        raise NotImplementedError

    def transform_slope(self, z: ArrayLike) -> Complex:
        """The derivative F'(z) of `transform` at complex z (any shape)."""
        return self._in_plane(z, "derivative")

    def transform_with_slope(self, z: ArrayLike) -> tuple[Complex, Complex]:
        """(F(z), F'(z)) at complex z with Im z >= 0 (any shape); NaN where z is not finite.

        It takes less time than `transform` and `transform_slope`.
        """
        points = np.asarray(z, dtype=complex)
        nothing, finite = complex(np.nan, np.nan), np.isfinite(points)
        value, slope = np.full(points.shape, nothing), np.full(points.shape, nothing)
        at = points[finite]
        if self.beside is not None:
            at = complex_of(self.beside.off_positions(at.real), at.imag)
        value[finite], slope[finite] = self._with_slope(at)
        if self.beside is not None:
            value[finite] -= self.beside.in_plane(at, "transform")
            slope[finite] -= self.beside.in_plane(at, "derivative")
        return value, slope

    def _with_slope(self, points: Complex) -> tuple[Complex, Complex]:
        """The transform and its derivative at finite points (n,) in the upper half plane."""
        return self.plane(points, "transform"), self.plane(points, "derivative")

    def _in_plane(self, z: ArrayLike, what: What) -> NDArray[Any]:
        """Transform, its derivative, or potential at complex z; NaN where z is not finite."""
        points = np.asarray(z, dtype=complex)
        out, finite = np.full(points.shape, complex(np.nan, np.nan)), np.isfinite(points)
        at = points[finite]
        if self.beside is not None:
            at = complex_of(self.beside.off_positions(at.real), at.imag)
        out[finite] = self.plane(at, what)
        if self.beside is not None:
            out[finite] -= self.beside.in_plane(at, what)
        return out
