"""What a density does anywhere on the line: its transform and its potential, in closed form from every zone and image.

A *source* is a zone moved by one of the kernel's poles. Seen from outside, z = (x - middle)/w and
rho = z - sgn(z) sqrt(z^2 - 1):

    transform  T_l / sqrt -> sgn(z) rho^l / sqrt(z^2 - 1),    sqrt U_l -> rho^(l+1)
    potential  T_l / sqrt -> -w rho^l / l,                    T_0 / sqrt -> w log(w / (2 |rho|)),

and on the zone itself -U_{l-1}(t) and the real parts at rho = e^{i theta}. The rest of the kernel is finished
by quadrature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sie.basis import chebyshev
from sie.basis.half_plane import sum_of_powers
from sie.basis.kernels import Kernel, Regular, regular_size
from sie.basis.zones import Zones
from sie.density.series import Evaluated, Series
from sie.fast.panels import Panels, Spread, panels_of
from sie.jumps.forcing import ForcingJumps

Array = NDArray[np.float64]
Index = NDArray[np.intp]

# Largest number of (point, source) pairs handled at once: bounds the memory of an evaluation.
CHUNK = 200_000
# From this number of (point, source) pairs on, far sources are summed fast.
MANY_PAIRS = 500_000
# The same once the series of the far ones are at hand.
SOME_PAIRS = 10_000
# Below this number of multiplications all pairs are summed to the same order; of few pairs, all powers are formed at once.
_SMALL, _FEW = 200_000, 256


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


@dataclass(frozen=True, eq=False)
class Seen:
    """Points seen from sources, (points, sources): distances from the ends over w (positive on the zone), rho, if on
    it."""

    left: Array
    right: Array
    root: Array
    rho: Array
    on: NDArray[np.bool_]
    any_on: bool

    @classmethod
    def of(cls, x: Array, sources: Sources, half: Array) -> Seen:
        left = ((x[:, None] - sources.a) - sources.rest[0]) / half
        right = ((sources.b - x[:, None]) + sources.rest[1]) / half
        on = (left >= 0) & (right >= 0)
        root = np.sqrt(np.abs(left * right))
        rho = np.where(left >= 0, 1.0, -1.0) / (0.5 * np.abs(left - right) + root)
        any_on = bool(on.any())
        if any_on:
            rho[on] = 0.5  # any value inside the unit circle: replaced by the zone's own closed form
        return cls(left, right, root, rho, on, any_on)


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
    if len(x) * len(sources) > (SOME_PAIRS if density.has_series else MANY_PAIRS) and density.treecode is not None:
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
    seen = Seen.of(x, sources, density.zones.half[zone])
    alpha, beta, u = density.bounded
    rho = seen.rho
    value = rho * power_sum(u, rho, zone)
    if np.any(alpha) or np.any(beta):
        a, b = alpha[zone], beta[zone]
        with np.errstate(divide="ignore", invalid="ignore"):
            edge = np.sign(rho) * (a + b * rho) / seen.root
        value += np.where((a == 0) & (b == 0), 0.0, edge)
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
    seen = Seen.of(x, sources, w)
    table = density.potential_coefficients
    first, rest, rho = table[zone, 0], table[:, 1:], seen.rho
    value = first * np.log(w / (2 * datum * np.abs(rho))) - rho * power_sum(rest, rho, zone)
    p, i = np.nonzero(density.is_near(zone, rho, seen.on))
    if len(p):
        value[p, i] = density.near_potential(zone[i], seen.left[p, i], seen.right[p, i], rho[p, i], seen.on[p, i])
    for place in density.jumps.sharp:
        for column in np.flatnonzero(zone == place):
            jumps = density.jumps.sharp_potential(place, seen.left[:, column], seen.right[:, column], rho[:, column])
            value[:, column] += jumps + density.sharp_totals[place] * math.log(w[column] / datum)
    return np.asarray(value @ w)


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


def panels_over(kernel: Kernel, zones: Zones) -> Panels | None:
    """The panels of a kernel's regular part over all zones."""
    return panels_of(kernel, float(zones.a[0]), float(zones.b[-1]))


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


def power_sum(u: Array, rho: Array, zone: Index) -> Array:
    """sum_k u[zone, k] rho^k for every (point, source); far points stop early, where rho^k has vanished."""
    count = u.shape[1]
    if count == 0:
        return np.zeros(rho.shape)
    if rho.size * count <= _SMALL:
        if rho.size > _FEW:
            c = u[zone]
            out = np.zeros(rho.shape) + c[:, -1]
            for k in range(count - 2, -1, -1):
                out *= rho
                out += c[:, k]
            return out
        powers = np.empty((*rho.shape, count))
        powers[..., 0] = 1.0
        powers[..., 1:] = rho[..., None]
        return np.asarray(np.einsum("psk,sk->ps", np.cumprod(powers, axis=-1), u[zone]))
    return sum_of_powers(u, rho.ravel(), np.tile(zone, rho.shape[0])).reshape(rho.shape)
