"""Closed form of one zone in a period for f = -sum_n d_n cos(n phi), phi = 2 pi x/L.

With the half width a and c = cos(2 pi a / L), the load per period is, by the Mehler-Dirichlet
integral of the Legendre polynomials P_n,

    P(a) = (pi E*/2) sum_n n d_n (P_{n-1}(c) - P_n(c)),

(for n = 1 it is Westergaard's pi E* d sin^2(pi a/L)). By the superposition of flat punches
(contact.reference.exact.base), with v^2 = cos(phi) - c', the pressure is

    p(x) = -(2 sqrt2 cos(phi/2) / L) int_0^V P'(c') dv,   V^2 = cos(phi) - c.

The integrand is a polynomial, so that Gauss-Legendre quadrature is exact (derived here).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, pi

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from contact.reference.exact import SymmetricZone

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class HarmonicZone(SymmetricZone):
    """Exact contact on [-a, a] of a profile of period 1 with harmonic amplitudes d_1, d_2, ...

    This is the true contact only if the pressure is positive and the gap is open.
    """

    amplitudes: tuple[float, ...]
    E_star: float
    half_width: float
    period = 1.0

    @cached_property
    def _series(self) -> Array:
        """Coefficients of the load as a Legendre series in cos(2 pi half_width/period)."""
        n = np.arange(1, len(self.amplitudes) + 1)
        weight = 0.5 * pi * self.E_star * n * np.array(self.amplitudes)
        return np.append(weight, 0.0) - np.append(0.0, weight)

    @property
    def load(self) -> float:
        return float(legendre.legval(cos(2 * pi * self.half_width), self._series))

    @property
    def max_pressure(self) -> float:
        return float(self.pressure_at(np.linspace(0.0, 1.0, 101)).max())

    def _pressure(self, r: Array, d: Array) -> Array:
        # The integral's upper limit `top` is the square root of cos(2 pi r) - cos(2 pi a), with the
        # half width a. The difference is computed as a product, 2 sin(pi d) sin(pi (a + r)) with d
        # = a - r, so that no digit is lost.
        top = np.sqrt(2 * np.sin(pi * d) * np.sin(pi * (self.half_width + r)))
        nodes, weights = legendre.leggauss(len(self.amplitudes) + 1)
        v = 0.5 * (1 + nodes) * top[..., None]
        values = legendre.legval(
            np.cos(2 * pi * r)[..., None] - v**2, legendre.legder(self._series)
        )
        return np.asarray(-np.sqrt(2.0) * np.cos(pi * r) * top * (values @ weights))
