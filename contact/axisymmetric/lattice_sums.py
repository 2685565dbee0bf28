r"""Sums of |R + d|^(-s) over a plane lattice, R + d = 0 left out, by Ewald's split at one cell area V.

    Z(s; d) = pi^(s/2)/Gamma(s/2) [ sum' Gamma(s/2, pi rho^2/V) (pi rho^2)^(-s/2)
              + (1/V) sum_(k != 0) cos(2 pi k.d) (pi k^2)^(s/2-1) Gamma(1 - s/2, pi k^2 V)
              + V^(-s/2)/(s/2 - 1) - [d on the lattice] V^(-s/2)/(s/2) ],   rho = |R + d|, k reciprocal.

For s > 2 it is the plain sum; for s = 1, where that diverges, it is the sum less the potential of the same load spread
evenly: with it the displacement is measured from its own mean.
"""

from functools import lru_cache
from math import gamma, pi

import numpy as np
from scipy.special import erfc, gammaincc

from contact.axisymmetric.lattices import Lattice, Site
from sie import Array

_REACH = 4.0  # in roots of the cell area: exp(-pi 16) is below rounding


@lru_cache(maxsize=1024)
def epstein(lattice: Lattice, shift: Site, s: int) -> float:
    """Z(s; shift) of the lattice in units of its spacing, s odd."""
    basis, cell = lattice.unit_basis, lattice.unit_area
    near = lattice.distances(shift, _REACH * cell**0.5)
    direct = gammaincc(0.5 * s, pi * near**2 / cell) * gamma(0.5 * s) * (pi * near**2) ** (-0.5 * s)

    count = np.ceil(_REACH / cell**0.5 * np.linalg.norm(basis, axis=1)).astype(int) + 2
    i, j = (n.ravel() for n in np.meshgrid(*(np.arange(-n, n + 1) for n in count), indexing="ij"))
    other = (i != 0) | (j != 0)
    wave = np.stack([i[other], j[other]], axis=1) @ np.linalg.inv(basis).T
    square = pi * np.sum(wave**2, axis=1)
    phase = np.cos(2.0 * pi * (i[other] * shift[0] + j[other] * shift[1]))
    far = phase * square ** (0.5 * s - 1.0) * _upper_gamma(s, square * cell) / cell

    loose = cell ** (-0.5 * s) * (1.0 / (0.5 * s - 1.0) - (1.0 / (0.5 * s) if lattice.holds(shift) else 0.0))
    return float(pi ** (0.5 * s) / gamma(0.5 * s) * (np.sum(direct) + np.sum(far) + loose))


def _upper_gamma(s: int, x: Array) -> Array:
    """Gamma(1 - s/2, x) for odd s >= 1, down from Gamma(1/2, x) by parts."""
    value = np.sqrt(pi) * erfc(np.sqrt(x))
    for twice in range(-1, 1 - s, -2):
        value = (value - x ** (0.5 * twice) * np.exp(-x)) / (0.5 * twice)
    return np.asarray(value)
