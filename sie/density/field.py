"""What a density does anywhere on the line: its transform and its potential, in closed form from every zone and image.

What a zone, or one moved by one of the kernel's poles, does on itself and off it `sie.basis.interval` knows. The rest of the kernel is
finished by quadrature.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import Array, Index
from sie.basis.interval import OnLine, potential_of, transform_of
from sie.basis.kernels import Regular
from sie.density.series import Series
from sie.fast.panels import Spread

# Largest number of (point, source) pairs handled at once: bounds the memory of an evaluation.
CHUNK = 16_000


def from_zones(density: Series, x: Array, zone: Index, shift: Array | float, potential: bool) -> Array:
    """What zones moved by `shift` do at points by the poles of the kernel: pair by pair, all (n,), or, x (n, 1), at every point."""
    zones, w, jumps = density.zones, density.zones.half[zone], density.jumps
    seen = OnLine.of(zones.beyond_a(x - shift, zone) / w, zones.before_b(x - shift, zone) / w)
    if potential:
        value = potential_of(density.potential_coefficients, seen, w, density.kernel.datum, zone)
    else:
        value = transform_of(*density.bounded, seen, zone)
    if seen.any_on:
        own = np.nonzero(seen.on)
        value[own] = (density.own_potential if potential else density.own_transform)(zone[own[-1]], seen[own])
    named = list(jumps.by_zone)
    if named:
        carried = np.zeros(len(zones), dtype=bool)
        carried[named] = True
        pairs = np.nonzero(np.broadcast_to(carried[zone], value.shape))
        of, there = zone[pairs[-1]], seen[pairs]
        if potential:
            sharp = jumps.sharp_potential(of, there)
            value[pairs] += zones.half[of] * (sharp + density.sharp_totals[of] * np.log(zones.half[of] / density.kernel.datum))
        else:
            value[pairs] += jumps.transform(of, there)
    return np.asarray(value)


def regular_at(density: Series, x: Array, regular: Regular) -> Array:
    """The regular part of the kernel (or of its potential): through its panels, where it has some, else by Gauss-Chebyshev quadrature on
    every zone."""
    if density.panel_moments is not None:
        panels, moments = density.panel_moments
        return panels.at(Spread.of(panels, x), moments, regular is not density.kernel.regular)
    return by_quadrature(density.quadrature, x, regular)


def by_quadrature(parts: list[tuple[Array, Array]], x: NDArray[Any], regular: Callable[..., NDArray[Any]]) -> NDArray[Any]:
    """Sums over nodes with weights, at real or complex points."""
    out = np.zeros(x.shape, dtype=x.dtype)
    for xi, weights in parts:
        block = max(1, CHUNK // weights.size)
        for s in range(0, len(x), block):
            out[s : s + block] += regular(x[s : s + block, None], xi[None, :]) @ weights
    return out
