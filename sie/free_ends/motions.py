r"""What motions of free ends do to edge intensities and levels: the singular densities that stand for them.

See `end_rates` for the formulas. A motion d of the right end of a zone of half width w leaves s S, s = -K d / (sqrt(2) w^(3/2)): the
coefficients -2 l s to all but the zone itself, the level -w s and a part of both K there.
"""

from __future__ import annotations

import numpy as np

from sie.basis.data import Array, record
from sie.basis.interval import edge_scale
from sie.collocation.fixed import State


@record
class Moved:
    """coefficients: of the singular densities, as the rest sees them (unknowns, ...); own_level: what they do to their zones' own levels
    (Z, ...); own: and to the intensities at both ends of these (2, Z, ...)."""

    coefficients: Array
    own_level: Array
    own: Array

    @classmethod
    def of(cls, state: State, d: Array) -> Moved:
        """By outward motions d (2, Z, ...) of the left and right ends."""
        zones, layout = state.density.zones, state.system.layout
        more = (1,) * (d.ndim - 2)
        w = zones.half.reshape(-1, *more)
        k, slope = (np.array(part).reshape(2, -1, *more) for part in (state.density.intensities, state.density.edge_slopes))
        strength = -k * d / (np.sqrt(2.0) * w**1.5)
        zone = np.repeat(np.arange(len(zones)), layout.m + 1)
        order = (np.arange(layout.coefficients) - layout.offset[zone]).reshape(-1, *more)
        turned = 1.0 - 2.0 * (order % 2)
        coefficients = np.zeros((layout.size, *d.shape[2:]))
        coefficients[: layout.coefficients] = -2.0 * order * (strength[1][zone] + turned * strength[0][zone])
        root = strength * edge_scale(w)
        return cls(coefficients, -w * strength.sum(axis=0), 0.25 * root + 0.5 * root[::-1] - 0.5 * slope * d)


def free_ends(state: State) -> list[tuple[int, int]]:
    """(side, zone) of the ends that move, of mirrored pairs the right one."""
    zones = state.density.zones
    mirrored = int(zones.solved[0]) if zones.central else -1
    kinds = (zones.left, zones.right)
    return [
        (side, int(i)) for side in (0, 1) for i in zones.solved if kinds[side][i].moves and (side, i) != (0, mirrored)
    ]


def spread(state: State, ends: list[tuple[int, int]], values: Array) -> Array:
    """Values of ends (E, ...) as (2, Z, ...), mirrored ones filled in."""
    zones = state.density.zones
    out = np.zeros((2, len(zones), *values.shape[1:]))
    if not ends:
        return out
    side, zone = np.array(ends).T
    out[side, zone] = values
    if zones.symmetric:
        out[1 - side, len(zones) - 1 - zone] = values
    return out
