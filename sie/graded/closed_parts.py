"""The closed-form density due to jumps, on zones with graded coordinates, and its fields.

Jumps and powers of the right side, and jumps of the density, have densities in closed form (see
`sie.jumps`). These densities are functions of x and vanish at the ends of their zone. The rest of
the right side is smooth on each zone. Fields on other zones are computed from the widths of gaps
and the distances of points from the ends of zones.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import HALF_DIGITS, Array, Kept, record
from sie.basis.interval import OnLine
from sie.basis.kernels import Kernel
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.zones import Zones
from sie.dense.modes import OPTIONS as MODES
from sie.density.density import Density
from sie.density.series import by_quadrature
from sie.graded.grading import Places
from sie.jumps.right_side import ForcingJumps


@record
class ClosedParts(Kept):
    """Closed-form densities of the jumps of the right side, or of the density, on all zones."""

    zones: Zones
    kernel: Kernel
    jumps: ForcingJumps

    @cached_property
    def density(self) -> Density:
        """The density that consists of the closed-form densities of the jumps on all zones."""
        table = np.zeros((len(self.zones), SUMS.max_direct_terms))
        return Density(self.zones, self.kernel, table, self.jumps, np.zeros(0))

    @cached_property
    def named(self) -> list[int]:
        """Indices of the zones that contain jumps, in ascending order."""
        return sorted(self.jumps.by_zone)

    def smooth_part(self, zone: int, places: Places) -> Array:
        """The function that cancels jumps and singular points of the right side, on a zone.
        Its sum with the right side is smooth.
        """
        left = places.from_a / self.zones.half[zone]
        return self.jumps.smooth_part(np.full(len(left), zone, dtype=np.intp), left)

    def transforms(self, zone: int, places: Places, x: Array, seen: list[Seen]) -> Array:
        """Transform, at points of a zone, of the closed-form densities of jumps in other zones.
        Images of all zones count. The jumps in the zone itself count only with the kernel's regular
        part.

        seen: the zones with jumps and their images, see `Seen`.
        """
        out = np.zeros(len(x))
        for one in seen:
            if one.shift != 0.0 or one.zone != zone:
                row = np.full(len(x), one.zone, dtype=np.intp)
                out += self.jumps.transform(row, one.on_line(self.zones, places))
        regular = self.kernel.regular
        return out if regular is None else out + by_quadrature(self.density.quadrature, x, regular)

    def potentials(self, zone: int, places: Places, x: Array, seen: list[Seen]) -> Array:
        """Potential, at points of a zone, of the jumps' closed-form density on the zones `seen`."""
        out, totals = np.zeros(len(x)), self.density.sharp_totals
        for one in seen:
            row, half = np.full(len(x), one.zone, dtype=np.intp), self.zones.half[one.zone]
            sharp = self.jumps.sharp_potential(row, one.on_line(self.zones, places))
            out += half * (sharp + totals[one.zone] * np.log(half / self.kernel.datum))
        regular = self.kernel.regular_potential
        return out if regular is None else out + by_quadrature(self.density.quadrature, x, regular)

    def integrals(self, weight: Callable[[Array], Array]) -> Array:
        """Integral over each zone (Z,) of a weight times the closed-form density of the jumps."""
        out, size = np.zeros(len(self.zones)), SUMS.max_direct_terms
        for zone in self.named:
            while True:
                x = self.zones.middle[zone] + self.zones.half[zone] * chebyshev.gauss(size)
                values = np.asarray(weight(x), dtype=float)
                means = chebyshev.t_means(np.broadcast_to(values, x.shape))
                # The integral is a sum of products of `means` and the density's coefficients. Both
                # decay, so `means` need not decay to round-off.
                if (
                    np.abs(means[-8:]).max() <= HALF_DIGITS**1.5 * np.abs(means).max()
                    or size >= MODES.max_nodes
                ):
                    break
                size *= 2
            table = self.jumps.t_coefficients(self.zones, size)[zone]
            out[zone] = np.pi * self.zones.half[zone] * float(means @ table)
        return out


@record
class Seen:
    """Position of a zone with jumps, moved by `shift`, relative to the points of another zone.

    zone: index of the zone with jumps; gap: distance between the two zones; ahead: whether the
    points are to the right of the zone with jumps; is_own: whether the points are on the zone with
    jumps itself, without a shift. Then `gap` and `ahead` are meaningless.
    """

    zone: int
    shift: float
    gap: float
    ahead: bool
    is_own: bool

    def on_line(self, zones: Zones, places: Places) -> OnLine:
        """Positions of the points relative to the zone with jumps, in units of its half width."""
        half = zones.half[self.zone]
        if self.is_own:
            return OnLine.of(places.from_a / half, places.from_b / half)
        if self.ahead:
            past = (self.gap + places.from_a) / half
            return OnLine.of(2 + past, -past)
        past = (self.gap + places.from_b) / half
        return OnLine.of(-past, 2 + past)
