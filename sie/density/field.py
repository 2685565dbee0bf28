"""What a density does anywhere on the line: its transform and its potential, in closed form from every zone and image.

A *source* is a zone moved by one of the kernel's poles; what it does on itself and off it `sie.basis.interval` knows. The rest of the
kernel is finished by quadrature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sie.basis import chebyshev
from sie.basis.interval import OnLine, potential_of, transform_of
from sie.basis.kernels import Kernel, Regular, regular_size
from sie.basis.zones import Zones
from sie.density.series import Evaluated, Series
from sie.fast.panels import Panels, Spread, panels_over
from sie.jumps.forcing import ForcingJumps

Array = NDArray[np.float64]
Index = NDArray[np.intp]

# Largest number of (point, source) pairs handled at once: bounds the memory of an evaluation.
CHUNK = 16_000
# From this number of (point, source) pairs on, far sources are summed fast; all that follow are, once their series are at hand.
MANY_PAIRS = 500_000


@dataclass(frozen=True, eq=False)
class Sources:
    """Zones moved by poles: zone index and ends of each, and what rounding has cut off them (`Zones.rest`)."""

    zone: Index
    a: Array
    b: Array
    own: NDArray[np.bool_]
    rest: Array

    @classmethod
    def of(cls, zones: Zones, kernel: Kernel) -> Sources:
        """Every zone at every pole; `own` marks those that are not moved."""
        shift = np.asarray(kernel.poles)[:, None]
        zone = np.tile(np.arange(len(zones)), len(kernel.poles))
        own = np.repeat(shift[:, 0] == 0.0, len(zones))
        return cls(zone, (zones.a + shift).ravel(), (zones.b + shift).ravel(), own, zones.rest[:, zone])

    def chosen(self, which: NDArray[np.bool_]) -> Sources:
        return Sources(self.zone[which], self.a[which], self.b[which], self.own[which], self.rest[:, which])

    def __len__(self) -> int:
        return len(self.zone)


def seen_from(sources: Sources, x: Array, half: Array) -> OnLine:
    """Points seen from sources, (points, sources)."""
    left = ((x[:, None] - sources.a) - sources.rest[0]) / half
    right = ((sources.b - x[:, None]) + sources.rest[1]) / half
    return OnLine.of(left, right)


def transform_at(density: Evaluated, x: Array, sources: Sources) -> Array:
    """(1/pi) PV int phi K dxi at points x (n,), by blocks."""
    return _by_blocks(density, x, sources, _transform, density.kernel.regular)


def potential_at(density: Evaluated, x: Array, sources: Sources) -> Array:
    """(1/pi) int phi Lambda dxi at points x (n,), by blocks."""
    return _by_blocks(density, x, sources, _potential, density.kernel.regular_potential)


def transform_from(density: Series, x: Array, sources: Sources) -> Array:
    """What some sources add to the transform at points x (n,)."""
    return _transform(density, x, sources)


def potential_from(density: Series, x: Array, sources: Sources) -> Array:
    """What some sources add to the potential at points x (n,)."""
    return _potential(density, x, sources)


def _by_blocks(density: Evaluated, x: Array, sources: Sources, what, regular: Regular | None) -> Array:  # type: ignore[no-untyped-def]
    if (density.has_series or len(x) * len(sources) > MANY_PAIRS) and density.treecode is not None:
        here = density.treecode
        value = here.potential(x) if what is _potential else here.transform(x)
        return value if regular is None or density.kernel.sure else np.asarray(value + regular_at(density, x, regular))
    out = np.zeros(x.shape) if regular is None else regular_at(density, x, regular)
    block = max(1, CHUNK // len(sources))
    for s in range(0, len(x), block):
        part = x[s : s + block]
        out[s : s + block] += what(density, part, sources)
    return out


def _transform(density: Series, x: Array, sources: Sources) -> Array:
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


def _potential(density: Series, x: Array, sources: Sources) -> Array:
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


def regular_at(density: Evaluated, x: Array, regular: Regular) -> Array:
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


def moments_of(panels: Panels, zones: Zones, kernel: Kernel, table: Array, jumps: ForcingJumps) -> Array:
    """Moments of the panels of a density, see `quadrature`."""
    nodes, weights = (np.concatenate(parts) for parts in zip(*quadrature(zones, kernel, table, jumps), strict=True))
    return panels.moments(Spread.of(panels, nodes), weights)


def quadrature(zones: Zones, kernel: Kernel, table: Array, jumps: ForcingJumps) -> list[tuple[Array, Array]]:
    """(nodes, weights times density) for the regular part, of T coefficients (zones, n + 1) and jumps; zones of equal size together."""
    m, panels = table.shape[1] - 1, panels_over(kernel, zones)
    sizes = np.array([regular_size(kernel, w, m) for w in zones.half]) if panels is None else panels.modes(zones.half) + 2
    found = []
    for q in np.unique(sizes):
        group = np.flatnonzero(sizes == q)
        count = min(int(q), m + 1)
        xi = zones.middle[group][:, None] + zones.half[group][:, None] * chebyshev.gauss(int(q))
        c = table[group, :count]
        if len(jumps):
            count = int(q)
            c = np.pad(c, ((0, 0), (0, count - c.shape[1]))) + jumps.t_coefficients(zones, count)[group]
        weights = chebyshev.t_values(c, int(q)) * (zones.half[group] / q)[:, None]
        found.append((xi.ravel(), weights.ravel()))
    return found

