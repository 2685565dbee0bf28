"""A density by places on the line and in the plane: what those on plain intervals and those beside
slits have in common.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sie.basis.data import Array, Complex, Index, Kept, Mask, nearest_image, wrapped
from sie.basis.interval import What, by_angle, edge_scale
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones


class Located(Kept):
    """A subclass, a dataclass with a field `bounded_ends`, knows the density by zone and distances
    from its ends.
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
            """The density at complex points."""

    def with_bounded_ends(self) -> Self:
        """The same density with the last traces of 1/sqrt(d) taken out at free ends, where the
        exact one has none.

        An end off by delta leaves K = A delta / 2 there: at equal normalised position the rest is
        right to delta over the width, while K / sqrt(d) would grow without bound towards the end.
        """
        return replace(self, bounded_ends=True)  # type: ignore[type-var]

    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        """Density at points given by zone index and the distances from the zone's ends over its
        half width (left + right = 2): no digit is lost near the ends.
        """
        raise NotImplementedError

    def at_t(self, zone: ArrayLike, t: ArrayLike) -> Array:
        """Density at normalised positions t in [-1, 1] of zones."""
        t = np.asarray(t, dtype=float)
        return self.at(zone, 1 + t, 1 - t)

    def by_angle(self, zone: ArrayLike, angle: Array) -> tuple[Array, Array]:
        """(density, its derivative by the angle) at angles of zones, t = cos(angle), by close
        differences.
        """
        return by_angle(lambda left, right: self.at(zone, left, right), angle)

    def following(self, zone: Any, angle: Array) -> tuple[Array, Array, Array]:
        """Sizes of the density at angles of zones, and of what motions of their left, of their
        right ends change it by there: see `Density.sensitivity`.
        """
        (value, slope), half = self.by_angle(zone, angle), np.tan(0.5 * angle)
        at_left, at_right = (
            one[zone] * edge_scale(self.zones.half[zone]) for one in self.edge_slopes
        )
        return np.abs(value), np.abs((slope + at_left) * half), np.abs((slope - at_right) / half)

    def followed(self, zones: Index, angles: list[Array]) -> Array:
        """The largest of these sizes in zones at angles of each (3, Z), zero in the others."""
        zone, out = np.repeat(zones, [len(one) for one in angles]), np.zeros((3, len(self.zones)))
        for largest, size in zip(out, self.following(zone, np.concatenate(angles)), strict=True):
            np.maximum.at(largest, zone, size)
        return out

    def locate(self, x: ArrayLike) -> tuple[Array, Index, Mask]:
        """(x moved by periods to lie right of the first zone's left end, index of the last zone
        that starts before it, whether it is inside that zone).
        """
        zones = self.zones
        place = wrapped(np.asarray(x, dtype=float), zones.a[0], self.kernel.period)
        i = np.asarray(np.maximum(np.searchsorted(zones.a, place, side="right") - 1, 0))
        return place, i, np.asarray((place >= zones.a[i]) & (place <= zones.b[i]))

    def into_period(self, x: Array) -> Array:
        """x moved by periods to within half of one of the zones' middle, where the kernel's poles
        are the near ones.
        """
        return nearest_image(x, 0.5 * (self.zones.a[0] + self.zones.b[-1]), self.kernel.period)

    def __call__(self, x: ArrayLike) -> Array:
        """Density at x (any shape), zero off the zones."""
        x, i, inside = self.locate(x)
        out = np.where(np.isnan(x), np.nan, 0.0)
        z, w = i[inside], self.zones.half[i[inside]]
        out[inside] = self.at(
            z, (x[inside] - self.zones.a[z]) / w, (self.zones.b[z] - x[inside]) / w
        )
        return out

    def transform(self, x: ArrayLike) -> NDArray[Any]:
        """(1/pi) PV int phi K dxi at x (any shape), on and off the zones; infinite at a singular
        end. At complex x what it is continued to, F(x) (see `plane`); there a zero imaginary part
        is the upper side of the line.
        """
        return (
            self._in_plane(x, "transform")
            if np.iscomplexobj(x)
            else self._on_line(np.asarray(x, dtype=float), False)
        )

    def potential(self, x: ArrayLike) -> NDArray[Any]:
        """(1/pi) int phi Lambda dxi at x (any shape), on and off the zones. At complex x the
        complex potential W, W' = F, whose real part is the harmonic function that is the potential
        on the line: it is analytic in either half plane, real on the line right of all zones (with
        a period: between the last zone and the next one), and W(conj x) = conj W(x).
        """
        if np.iscomplexobj(x):
            return self._in_plane(x, "potential")
        if self.kernel.regular is not None and self.kernel.regular_potential is None:
            raise ValueError("the regular kernel has no potential")
        return self._on_line(np.asarray(x, dtype=float), True)

    def _on_line(self, x: Array, potential: bool) -> Array:
        """Transform or potential at real x."""
        raise NotImplementedError

    def transform_slope(self, z: ArrayLike) -> Complex:
        """F'(z), the derivative of `transform` at complex z (any shape)."""
        return self._in_plane(z, "derivative")

    def _in_plane(self, z: ArrayLike, what: What) -> NDArray[Any]:
        points = np.asarray(z, dtype=complex)
        out, finite = np.full(points.shape, complex(np.nan, np.nan)), np.isfinite(points)
        out[finite] = self.plane(points[finite], what)
        return out
