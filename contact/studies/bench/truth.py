"""True errors: a solution against an exact one, or against one of another formulation.

Two measures, both relative to the peak pressure (to the mean contact pressure where the peak is
infinite). `stated_measure` is what `Solution.error` bounds: pressures at equal normalised position,
ends over widths. `at_places` is what a grid can be judged by: pressures at the same x. Pressure
leaves an end as a square root, so there an end off by d is an error ~ sqrt(d).
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# Normalised positions: close at the ends, and none at a tip in the middle, where a wedge's pressure
# is infinite.
POSITIONS = np.cos((np.arange(24) + 0.5) * np.pi / 24)
# Near a tip with infinite pressure a grid is not compared, within this part of the zone's half
# width.
TIP = 0.01


class Exact(Protocol):
    """What is compared of either side."""

    @property
    def zones(self) -> Array: ...
    @property
    def load(self) -> float: ...
    @property
    def max_pressure(self) -> float: ...
    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array: ...
    def pressure(self, x: ArrayLike) -> Array: ...


def scale(exact: Exact) -> float:
    """Peak pressure, or the mean contact pressure where that is infinite."""
    if np.isfinite(exact.max_pressure):
        return float(exact.max_pressure)
    return float(exact.load / np.sum(np.diff(exact.zones, axis=1)))


def stated_measure(found: Exact, exact: Exact) -> float:
    """Largest of the pressure's error at equal normalised positions and of the ends' errors over
    widths; inf where the number of zones differs.
    """
    if len(found.zones) != len(exact.zones):
        return float("inf")
    zones = np.asarray(exact.zones)
    ends = np.abs(found.zones - zones) / np.diff(zones, axis=1)
    apart = [
        np.max(np.abs(found.pressure_at(POSITIONS, k) - exact.pressure_at(POSITIONS, k)))
        for k in range(len(zones))
    ]
    return float(max(ends.max(), max(apart) / scale(exact)))


def at_places(x: Array, pressure: Array, exact: Exact) -> tuple[float, float]:
    """(largest, mean) error of pressures at positions x; a tip of infinite pressure is left out."""
    true = np.asarray(exact.pressure(x))
    keep = np.isfinite(true)
    if not np.isfinite(exact.max_pressure):
        half = 0.5 * float(np.min(np.diff(exact.zones, axis=1)))
        keep &= np.min(np.abs(x[:, None] - np.mean(exact.zones, axis=1)), axis=1) > TIP * half
    apart = np.abs(pressure[keep] - true[keep]) / scale(exact)
    return float(apart.max()), float(apart.mean())


def comb(exact: Exact, points: int = 2048) -> Array:
    """Places at which a solution of ours is compared as a grid is: an even grid over the hull of
    the zones, and places close to every end.
    """
    zones = np.asarray(exact.zones)
    low, high = zones[0, 0], zones[-1, 1]
    margin = 0.1 * (high - low)
    even = np.linspace(low - margin, high + margin, points)
    width = np.diff(zones, axis=1)
    close = zones[:, :, None] + width[:, :, None] * np.concatenate(
        [s * np.geomspace(1e-6, 0.1, 12) for s in (-1, 1)]
    )
    return np.unique(np.concatenate((even, close.ravel())))
