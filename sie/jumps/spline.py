"""What takes the place of very many jumps of order 2 in one zone, whichever side of the equation they are on."""

from __future__ import annotations

from typing import Protocol

from sie.basis.arrays import Array
from sie.basis.interval import Complex, InPlane, What


class Spline(Protocol):
    """A part of the density that goes with a quadratic spline, of the right side or of the density itself: places are distances from both
    ends of the zone over its half width. What one of the two kinds does not have is a ValueError."""

    @property
    def knots(self) -> Array:
        """Those inside the zone."""

    @property
    def jumps(self) -> Array:
        """Half of the jumps of the second derivative at these."""

    @property
    def size(self) -> float:
        """The largest of the numbers that are added up."""

    @property
    def edge_slopes(self) -> tuple[float, float]:
        """Coefficient of the angle from the left and from the right end."""

    @property
    def mean_offset(self) -> float:
        """Mean over theta of the primitive of the right side, less half of its values at both ends; over the half width."""

    def t_coefficients(self, count: int) -> Array:
        """First `count` coefficients of the density as a sum of T_l / sqrt(1 - t^2)."""

    def density(self, left: Array, right: Array) -> Array:
        """The density."""

    def angular_slope(self, left: Array, right: Array) -> Array:
        """Its derivative by theta."""

    def integral(self, left: Array) -> Array:
        """Its integral from the left end."""

    def own_transform(self, left: Array) -> Array:
        """What the kernel makes of it on the zone."""

    def transform_off(self, z: Array, rho: Array) -> Array:
        """And off the zone."""

    def potential(self, left: Array, right: Array, rho: Array) -> Array:
        """Its potential over the half width, less c_0 log(half width), on the zone and off it."""

    def in_plane(self, seen: InPlane, what: What) -> Complex:
        """Transform at complex points, or its derivative by zeta."""
