"""The potential on a stretch without zones, at many points: near zones one by one, far ones by interpolation.

What a zone does is analytic away from it. On [lo, hi], zones at a distance of at least half the stretch are seen through
Chebyshev interpolation at a fixed number of nodes: with z = 2, rho = 2 - sqrt(3) = 0.268, and 26 nodes leave 1e-15.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sie import chebyshev
from sie.density import Density

Array = NDArray[np.float64]

_NODES = 26


@dataclass(frozen=True, eq=False)
class LocalPotential:
    """The potential of a density on [lo, hi], an interval without zones in it."""

    density: Density
    lo: float
    hi: float
    far: Array
    near: tuple[tuple[float, NDArray[np.intp]], ...]

    @classmethod
    def on(cls, density: Density, lo: float, hi: float) -> LocalPotential:
        """Choose the near zones of [lo, hi] and interpolate all others."""
        zones, reach = density.zones, 0.5 * (hi - lo)
        near = []
        for shift in density.kernel.poles:
            distance = np.maximum(zones.a + shift - hi, lo - (zones.b + shift))
            near.append((shift, np.flatnonzero(distance < reach)))
        t = chebyshev.gauss(_NODES)
        x = 0.5 * (lo + hi) + 0.5 * (hi - lo) * t
        values = density.potential_along(x) - _sum_near(density, x, near)
        weights = chebyshev.t_matrix(_NODES, _NODES) * (2 / _NODES)
        far = values @ weights
        far[0] *= 0.5
        return cls(density, lo, hi, far, tuple(near))

    def __call__(self, x: Array) -> Array:
        """Potential at points x (n,) of [lo, hi]."""
        t = (2 * x - (self.lo + self.hi)) / (self.hi - self.lo)
        smooth = np.polynomial.chebyshev.chebval(t, self.far)
        return np.asarray(smooth + _sum_near(self.density, x, self.near))


def _sum_near(density: Density, x: Array, near: object) -> Array:
    total = np.zeros(x.shape)
    for shift, chosen in near:  # type: ignore[attr-defined]
        if len(chosen):
            total += density.potential_of(x, shift, chosen)
    return total
