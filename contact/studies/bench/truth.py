"""True errors: a solution compared with an exact solution, or with one by another formulation.

There are two measures of the error. `stated_measure` is the error that `Solution.error` bounds: of
pressures at equal normalised positions, and of ends relative to the widths of zones. `at_places`
compares pressures at the same x, which is possible for grids, too. Near an end the pressure is a
square root of the distance, so that an error d of the end makes an error of order sqrt(d) at the
same x. Both measures divide errors of pressure by the largest pressure, or by the mean contact
pressure if the peak is infinite.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def positions(count: int = 24) -> Array:
    """Normalised positions in a zone, dense near the ends of the zone; `count` must be even.

    With an even count, no position is in the middle, where a wedge's pressure is infinite.
    """
    return np.asarray(np.cos((np.arange(count) + 0.5) * np.pi / count))


class Exact(Protocol):
    """Attributes and methods that a tested solution and an exact solution must have."""

    @property
    def zones(self) -> Array: ...
    @property
    def load(self) -> float: ...
    @property
    def max_pressure(self) -> float: ...
    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array: ...
    def pressure(self, x: ArrayLike) -> Array: ...


def scale(exact: Exact) -> float:
    """Return the largest pressure, or the mean contact pressure if the peak is infinite."""
    if np.isfinite(exact.max_pressure):
        return float(exact.max_pressure)
    return float(exact.load / np.sum(np.diff(exact.zones, axis=1)))


def stated_measure(found: Exact, exact: Exact) -> float:
    """Return the relative error of the pressure or of the zones' ends, whichever is larger.

    Pressures are compared at equal normalised positions in a zone. The result is inf if the numbers
    of zones differ.
    """
    if len(found.zones) != len(exact.zones):
        return float("inf")
    zones = np.asarray(exact.zones)
    ends = np.abs(found.zones - zones) / np.diff(zones, axis=1)
    t = positions()
    apart = [
        np.max(np.abs(found.pressure_at(t, k) - exact.pressure_at(t, k))) for k in range(len(zones))
    ]
    return float(max(ends.max(), max(apart) / scale(exact)))


def at_places(x: Array, pressure: Array, exact: Exact) -> tuple[float, float]:
    """Return (largest error, mean error) of the pressures at the positions x.

    The middle hundredth of a zone is left out if its pressure is infinite.
    """
    true = np.asarray(exact.pressure(x))
    keep = np.isfinite(true)
    if not np.isfinite(exact.max_pressure):
        half = 0.5 * float(np.min(np.diff(exact.zones, axis=1)))
        keep &= np.min(np.abs(x[:, None] - np.mean(exact.zones, axis=1)), axis=1) > 0.01 * half
    apart = np.abs(pressure[keep] - true[keep]) / scale(exact)
    return float(apart.max()), float(apart.mean())


def comb(exact: Exact, points: int = 2048) -> Array:
    """Return positions at which pressures are compared: an even grid, and points near zone ends."""
    zones = np.asarray(exact.zones)
    low, high = zones[0, 0], zones[-1, 1]
    margin = 0.1 * (high - low)
    even = np.linspace(low - margin, high + margin, points)
    width = np.diff(zones, axis=1)
    close = zones[:, :, None] + width[:, :, None] * np.concatenate(
        [s * np.geomspace(1e-6, 0.1, 12) for s in (-1, 1)]
    )
    return np.unique(np.concatenate((even, close.ravel())))
