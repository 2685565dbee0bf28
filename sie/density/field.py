"""What a density does anywhere on the line: its transform and its potential, in closed form from every zone and image.

A *source* is a zone moved by one of the kernel's poles; what it does on itself and off it `sie.basis.interval` knows. The rest of the
kernel is finished by quadrature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sie.basis.arrays import Array, Index, Mask
from sie.basis.interval import OnLine, potential_of, transform_of
from sie.basis.kernels import Kernel, Regular
from sie.basis.zones import Zones
from sie.density.series import Series
from sie.fast.panels import Spread

# Largest number of (point, source) pairs handled at once: bounds the memory of an evaluation.
CHUNK = 16_000


@dataclass(frozen=True, eq=False)
class Sources:
    """Zones moved by poles: zone index and ends of each, and what rounding has cut off them (`Zones.rest`)."""

    zone: Index
    a: Array
    b: Array
    own: Mask
    rest: Array

    @classmethod
    def of(cls, zones: Zones, kernel: Kernel) -> Sources:
        """Every zone at every pole; `own` marks those that are not moved."""
        shift = np.asarray(kernel.poles)[:, None]
        zone = np.tile(np.arange(len(zones)), len(kernel.poles))
        own = np.repeat(shift[:, 0] == 0.0, len(zones))
        return cls(zone, (zones.a + shift).ravel(), (zones.b + shift).ravel(), own, zones.rest[:, zone])

    def chosen(self, which: Mask) -> Sources:
        return Sources(self.zone[which], self.a[which], self.b[which], self.own[which], self.rest[:, which])

    def __len__(self) -> int:
        return len(self.zone)


def seen_from(sources: Sources, x: Array, half: Array) -> OnLine:
    """Points seen from sources, (points, sources)."""
    left = ((x[:, None] - sources.a) - sources.rest[0]) / half
    right = ((sources.b - x[:, None]) + sources.rest[1]) / half
    return OnLine.of(left, right)


def transform_from(density: Series, x: Array, sources: Sources) -> Array:
    """What sources add to (1/pi) PV int phi K dxi at points x (n,)."""
    zone = sources.zone
    seen = seen_from(sources, x, density.zones.half[zone])
    value, rho = transform_of(*density.bounded, seen, zone), seen.rho
    if seen.any_on:
        p, i = np.nonzero(seen.on)
        value[p, i] = density.own_transform(zone[i], seen.left[p, i], seen.right[p, i])
    for place in density.jumps.by_zone:
        for column in np.flatnonzero(zone == place):
            on = seen.on[:, column]
            value[on, column] += density.jumps.own_transform(place, seen.left[on, column])
            z = 0.5 * (seen.left[~on, column] - seen.right[~on, column])
            value[~on, column] += density.jumps.transform(place, z, rho[~on, column])
    return np.asarray(value.sum(axis=1))


def potential_from(density: Series, x: Array, sources: Sources) -> Array:
    """What sources add to (1/pi) int phi Lambda dxi at points x (n,)."""
    zone, datum = sources.zone, density.kernel.datum
    w = density.zones.half[zone]
    seen = seen_from(sources, x, w)
    value, rho = potential_of(density.potential_coefficients, seen, w, datum, zone), seen.rho
    p, i = np.nonzero(density.is_near(zone, rho, seen.on))
    if len(p):
        value[p, i] = density.near_potential(zone[i], seen[p, i])
    for place in density.jumps.sharp:
        for column in np.flatnonzero(zone == place):
            jumps = density.jumps.sharp_potential(place, seen.left[:, column], seen.right[:, column], rho[:, column])
            value[:, column] += w[column] * (jumps + density.sharp_totals[place] * math.log(w[column] / datum))
    return np.asarray(value.sum(axis=1))


def regular_at(density: Series, x: Array, regular: Regular) -> Array:
    """The regular part of the kernel (or of its potential): through its panels, where it has some, else by Gauss-Chebyshev quadrature on
    every zone."""
    if density.panel_moments is not None:
        panels, moments = density.panel_moments
        return panels.at(Spread.of(panels, x), moments, regular is not density.kernel.regular)
    out = np.zeros(x.shape)
    for xi, weights in density.quadrature:
        block = max(1, CHUNK // weights.size)
        for s in range(0, len(x), block):
            out[s : s + block] += regular(x[s : s + block, None], xi[None, :]) @ weights
    return out
