r"""What neighbouring spots do to a spot, in the plane of its Abel transform.

A point force Q at distance D lifts the ring of radius r < D by (Q/(pi E*)) mean 1/|r - D| =
(2Q/(pi^2 E* D)) K(r/D), and that is (2/pi) int_0^r psi(x) dx/sqrt(r^2 - x^2) with psi = (Q/(pi
E*))/sqrt(D^2 - x^2). Averaged over the places of an axisymmetric pressure with u = (2/pi) int
w/sqrt(r^2 - t^2) of its own, 1/sqrt(D^2 - x^2) is the potential of that pressure at the height i x,
where complex sources t give it in closed form:

    psi(x) = (1/pi) int_-a^a w(t) dt / sqrt(D^2 - (x - t)^2),        |x| + a < D.

The azimuthal mean of every neighbour is thus exact, and one smooth difference kernel. Beyond the
rings that are kept stands the nominal pressure N P outside the circle A of the same number of
spots, pi A^2 N = their number (A = 0: none kept):

    psi(x) = -(2 N P/E*) sqrt(A^2 - x^2),                            x < A,

from the mean plane. All rings: no circle, and lattice sums in place of the far part of the series
in (x - t)^2/D^2.

The sums of |R + d|^(-s) over a plane lattice, R + d = 0 left out, are found by Ewald's split at one
cell area V:

    Z(s; d) = pi^(s/2)/Gamma(s/2) [ sum' Gamma(s/2, pi rho^2/V) (pi rho^2)^(-s/2)
              + (1/V) sum_(k != 0) cos(2 pi k.d) (pi k^2)^(s/2-1) Gamma(1 - s/2, pi k^2 V) +
              V^(-s/2)/(s/2 - 1) - [d on the lattice] V^(-s/2)/(s/2) ],   rho = |R + d|, k
              reciprocal.

For s > 2 it is the plain sum; for s = 1, where that diverges, it is the sum less the potential of
the same load spread evenly: with it the displacement is measured from its own mean.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import asin, cos, gamma, inf, isinf, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import erfc, gammaincc

from contact.axisymmetric.lattices import Lattice, Site
from sie import Array

_NEAR = 3.5  # spacings: beyond, (x - t)^2/D^2 < 1/12
_TERMS = 16  # 12^-16 is below rounding

# 1/sqrt(1 - z) = sum_k B_k z^k
_BINOMIAL = np.cumprod([1.0, *((2 * k - 1) / (2 * k) for k in range(1, _TERMS))])


@dataclass(frozen=True)
class NeighbourKernel:
    """K(y) = sum of 1/sqrt(D^2 - y^2) over the spots of one kind around a spot, less a constant
    where a circle is.

    Built by `kernel_of`. `radii`, `counts`: the near rings [m]; `tail`: coefficients of
    (y/l)^(2k)/l for the rest.
    """

    radii: Array
    counts: NDArray[np.int64]
    tail: Array
    spacing: float

    @property
    def nearest(self) -> float:
        return float(self.radii[0]) if self.radii.size else inf

    def value(self, y: ArrayLike) -> Array:
        y = np.asarray(y, dtype=np.float64)
        far = np.polynomial.polynomial.polyval((y / self.spacing) ** 2, self.tail)
        rings = zip(self.radii, self.counts, strict=True)
        return np.asarray(
            sum((n / np.sqrt((r - y) * (r + y)) for r, n in rings), far / self.spacing)
        )

    def slope(self, y: ArrayLike) -> Array:
        """K'(y)."""
        y = np.asarray(y, dtype=np.float64)
        far = np.polynomial.polynomial.polyval(
            (y / self.spacing) ** 2, 2 * np.arange(1, self.tail.size) * self.tail[1:]
        )
        rings = zip(self.radii, self.counts, strict=True)
        return np.asarray(
            y * sum((n / ((r - y) * (r + y)) ** 1.5 for r, n in rings), far / self.spacing**3)
        )


@dataclass(frozen=True)
class Surroundings:
    """The spots of one kind as seen from a spot: their kernel, None if none is kept, and their
    circle A, 0 if none.
    """

    kernel: NeighbourKernel | None
    circle: float
    density: float

    def outside(self, x: ArrayLike) -> Array:
        """sqrt(A^2 - x^2), less the A that the kernel's constant holds; 0 without a circle and
        beyond it.
        """
        x = np.asarray(x, dtype=np.float64)
        root = np.sqrt(np.maximum((self.circle - x) * (self.circle + x), 0.0))
        if self.kernel is None:
            return root
        return np.where(
            x < self.circle, -(x**2) / np.maximum(self.circle + root, 1e-300), -self.circle
        )

    def outside_slope(self, x: ArrayLike) -> Array:
        """-x/sqrt(A^2 - x^2), x < A."""
        x = np.asarray(x, dtype=np.float64)
        inside = x < self.circle
        square = np.where(inside, (self.circle - x) * (self.circle + x), 1.0)
        return np.where(inside, -x / np.sqrt(square), 0.0)

    def outside_integral(self, a: float) -> float:
        """int_-a^a of `outside`, a <= A."""
        if self.circle == 0.0:
            return 0.0
        turn = asin(a / self.circle)
        whole = self.circle**2 * (turn + sin(turn) * cos(turn))
        return whole - (2.0 * a * self.circle if self.kernel is not None else 0.0)


def surroundings(lattice: Lattice, shifts: list[Site], cut: float) -> Surroundings:
    """Of the points of the lattice moved by the shifts: those within `cut` spacings kept, inf for
    all of them.
    """
    density = lattice.density * len(shifts)
    radii, counts = lattice.rings(shifts, min(cut, _NEAR) if isinf(cut) else cut)
    near = radii <= _NEAR
    powers = -(2 * np.arange(_TERMS) + 1)
    if isinf(cut):
        circle = 0.0
        whole = np.array([sum(epstein(lattice, s, -int(p)) for s in shifts) for p in powers])
        sums = whole - np.sum(counts * radii ** powers[:, None], axis=1)
    else:
        own = any(lattice.holds(s) for s in shifts)
        circle = sqrt((np.sum(counts) + own) / (pi * density))
        if not radii.size:
            return Surroundings(None, circle, density)
        sums = np.sum(counts[~near] * radii[~near] ** powers[:, None], axis=1)
        # The mean 2 pi N A of the same load spread over the circle, so that no large constants meet
        # later.
        sums[0] -= 2.0 * pi * density * circle * lattice.spacing
    kernel = NeighbourKernel(
        radii[near] * lattice.spacing, counts[near], _BINOMIAL * sums, lattice.spacing
    )
    return Surroundings(kernel, circle, density)


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

    loose = cell ** (-0.5 * s) * (
        1.0 / (0.5 * s - 1.0) - (1.0 / (0.5 * s) if lattice.holds(shift) else 0.0)
    )
    return float(pi ** (0.5 * s) / gamma(0.5 * s) * (np.sum(direct) + np.sum(far) + loose))


def _upper_gamma(s: int, x: Array) -> Array:
    """Gamma(1 - s/2, x) for odd s >= 1, down from Gamma(1/2, x) by parts."""
    value = np.sqrt(pi) * erfc(np.sqrt(x))
    for twice in range(-1, 1 - s, -2):
        value = (value - x ** (0.5 * twice) * np.exp(-x)) / (0.5 * twice)
    return np.asarray(value)
