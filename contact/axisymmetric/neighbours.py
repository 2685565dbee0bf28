r"""The effect of neighbouring spots on a spot, as an Abel transform of their displacement.

A point force Q at the distance D from the centre of a ring of radius r < D displaces the ring, in
the mean, by (Q/(pi E*)) mean 1/|r - D| = (2Q/(pi^2 E* D)) K(r/D), with the complete elliptic
integral K. That is (2/pi) int_0^r psi(x) dx/sqrt(r^2 - x^2) with
psi = (Q/(pi E*))/sqrt(D^2 - x^2). Now let an axisymmetric pressure take the place of Q. The
displacement that it causes under itself is (2/pi) int_0^r w(t) dt/sqrt(r^2 - t^2). Integrated with
this pressure over its points, 1/sqrt(D^2 - x^2) becomes the potential of the pressure at the height
i x. Complex sources at t give this potential in closed form:

    psi(x) = (1/pi) int_-a^a w(t) dt / sqrt(D^2 - (x - t)^2),        |x| + a < D.

The azimuthal mean of every neighbour is thus exact, and the kernel is a smooth function of x - t.
Only some rings of neighbours are treated at their places. The other neighbours, N per unit area
with the load P each, act as the nominal pressure N P outside a circle of radius A. On average, this
circle contains pi A^2 N spots. This is the number of the neighbours treated at their places, plus 1
for the spot itself (for rings = 0 it is 1):

    psi(x) = -(2 N P/E*) sqrt(A^2 - x^2),                            x < A,

measured from the mean plane. With all rings there is no circle. The far rings then contribute a
power series in x - t, whose coefficients are lattice sums.

The sums of |R + d|^(-s) over a plane lattice, without R + d = 0, are computed by Ewald summation
with the cell area V as splitting parameter:

    Z(s; d) = pi^(s/2)/Gamma(s/2) [ sum' Gamma(s/2, pi rho^2/V) (pi rho^2)^(-s/2)
              + (1/V) sum_(k != 0) cos(2 pi k.d) (pi k^2)^(s/2-1) Gamma(1 - s/2, pi k^2 V)
              + V^(-s/2)/(s/2 - 1) - [d on the lattice] V^(-s/2)/(s/2) ],

with rho = |R + d| and k the points of the reciprocal lattice. The sum' leaves out R + d = 0, and
[d on the lattice] is 1 if d is a lattice point, else 0.

For s > 2, Z is the plain sum. For s = 1 the plain sum diverges, and Z is the sum minus the
potential of the same load spread evenly; the displacement is then measured from its mean.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import asin, ceil, cos, gamma, inf, isinf, log, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import erfc, gammaincc

from contact.axisymmetric.lattices import Lattice, Site
from contact.model.profiles.noise import EPS
from sie import Array

# Rings of neighbours with radii up to this many lattice spacings are summed one by one. For a wider
# ring, of radius D, 1/sqrt(D^2 - y^2) becomes a power series in y^2/D^2. As |y| is below one
# spacing, y^2/D^2 is below 1/12.
_NEAR_RINGS = 3.5


@dataclass(frozen=True)
class NeighbourKernel:
    """Kernel K(y): the sum of 1/sqrt(D^2 - y^2) over neighbours of one kind, at distances D.

    If a circle stands for further neighbours, a constant is subtracted (`surroundings`). radii,
    counts: the near rings [m]; tail: coefficients of (y/l)^(2k)/l for the other rings, with l =
    `spacing`.
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
        """Derivative K'(y) of the sum K(y) of 1/sqrt(D^2 - y^2) over the neighbours."""
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
    """Neighbours of one kind around a spot.
    Near neighbours are a sum over single spots, far ones a mean pressure.

    kernel: the sum over single neighbours; None if there are none. circle: radius A outside which
    the mean pressure stands for the neighbours; 0 if all neighbours are summed.
    """

    kernel: NeighbourKernel | None = None
    circle: float = 0.0
    density: float = 0.0

    def outside(self, x: ArrayLike) -> Array:
        """Effect at x of a mean pressure outside a circle: sqrt(A^2 - x^2), or 0 for x >= A.
        A is the radius of the circle.

        If `kernel` is given, A is subtracted here, since the constant of the kernel contains it.
        """
        x = np.asarray(x, dtype=np.float64)
        root = np.sqrt(np.maximum((self.circle - x) * (self.circle + x), 0.0))
        if self.kernel is None:
            return root
        return np.where(
            x < self.circle, -(x**2) / np.maximum(self.circle + root, 1e-300), -self.circle
        )

    def outside_slope(self, x: ArrayLike) -> Array:
        """Derivative of sqrt(A^2 - x^2) for x below the radius A of the circle; 0 for larger x."""
        x = np.asarray(x, dtype=np.float64)
        inside = x < self.circle
        square = np.where(inside, (self.circle - x) * (self.circle + x), 1.0)
        return np.where(inside, -x / np.sqrt(square), 0.0)

    def outside_integral(self, a: float) -> float:
        """The integral of `outside` from -a to a, for a not larger than the circle's radius."""
        if self.circle == 0.0:
            return 0.0
        turn = asin(a / self.circle)
        whole = self.circle**2 * (turn + sin(turn) * cos(turn))
        return whole - (2.0 * a * self.circle if self.kernel is not None else 0.0)


def surroundings(lattice: Lattice, shifts: list[Site], cut: float) -> Surroundings:
    """Neighbours of a spot on shifted lattices, given by the `shifts`.
    Neighbours up to `cut` lattice spacings away are single spots; farther ones are a mean pressure.

    If `cut` is infinite, all neighbours are single spots.
    """
    density = lattice.density * len(shifts)
    radii, counts = lattice.rings(shifts, min(cut, _NEAR_RINGS) if isinf(cut) else cut)
    near = radii <= _NEAR_RINGS
    # For each ring of neighbours that is wider than `_NEAR_RINGS`, of radius D, 1/sqrt(D^2 - y^2)
    # is a series in y/D. `order` contains the exponents of the terms that exceed round-off.
    order = 2 * np.arange(ceil(log(EPS) / log(_NEAR_RINGS**-2)) + 1)
    powers = -(order + 1)
    # Coefficients B_k of the series 1/sqrt(1 - z) = sum_k B_k z^k.
    binomial = np.cumprod([1.0, *((order[1:] - 1) / order[1:])])
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
        # The uniform load of `density` spots per unit area in the circle has the potential
        # 2 pi `density` `circle` at the centre. This potential is subtracted here, as a later
        # subtraction of large numbers would cost digits.
        sums[0] -= 2.0 * pi * density * circle * lattice.spacing
    kernel = NeighbourKernel(
        radii[near] * lattice.spacing, counts[near], binomial * sums, lattice.spacing
    )
    return Surroundings(kernel, circle, density)


@lru_cache(maxsize=1024)
def epstein(lattice: Lattice, shift: Site, s: int) -> float:
    """Sum Z(s; shift) of |R + shift|^(-s) over lattice points R, in units of spacing; s odd."""
    basis, cell = lattice.unit_basis, lattice.unit_area
    # The sum over lattice points extends to the radius `reach` sqrt(`cell`). The sum over vectors
    # of the reciprocal lattice extends at least to `reach` / sqrt(`cell`). Each omitted term is
    # below about exp(-pi `reach`^2) = EPS^2.
    reach = (-2.0 * log(EPS) / pi) ** 0.5
    near = lattice.distances(shift, reach * cell**0.5)
    direct = gammaincc(0.5 * s, pi * near**2 / cell) * gamma(0.5 * s) * (pi * near**2) ** (-0.5 * s)

    count = np.ceil(reach / cell**0.5 * np.linalg.norm(basis, axis=1)).astype(int) + 2
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
    """The incomplete Gamma function Gamma(1 - s/2, x) for odd s >= 1, by recurrence from s = 1."""
    value = np.sqrt(pi) * erfc(np.sqrt(x))
    for twice in range(-1, 1 - s, -2):
        value = (value - x ** (0.5 * twice) * np.exp(-x)) / (0.5 * twice)
    return np.asarray(value)
