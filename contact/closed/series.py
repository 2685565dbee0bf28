"""Odd Chebyshev series on one interval: coefficients, sums and integrals from samples.

Let t run from -1 to 1 on the interval. The right side G = sum g_k T_k(t), over odd k, gives the
solution Phi = sqrt(1 - t^2) sum g_k U_{k-1}(t), bounded at both ends. The integral of Phi is
pi g_1/2 times the half length. Outside the interval the Hilbert transform of Phi is sum g_k rho^k
with rho = t - sgn(t) sqrt(t^2 - 1).

With the polynomial q = sum g_k U_{k-1}, a longer interval raises Phi by q(1) / sqrt(1 - t^2) per
unit of half length. So the integral grows with the half length at the rate pi q(1). A Newton step
therefore needs only g_1 and q(1), two sums over the samples of G.
"""

from functools import lru_cache

import numpy as np
from scipy import fft

from sie import Array, Index, record

# Number of samples of the polynomial q = sum g_k U_{k-1}, divided by the degree of q. With so many
# samples, their second differences bound q between neighbouring samples.
SAMPLES_PER_DEGREE = 8


@record
class Table:
    """The Chebyshev nodes t > 0, and matrices that act on a function's values at these nodes.

    sums (nodes, 4): gives g_1, q(1) and the last two coefficients from the values. matrix: gives
    all coefficients from the values. sines, cosines: of the angles at which q is sampled.
    """

    t: Array
    sums: Array
    matrix: Array
    sines: Array
    cosines: Array

    def samples(self, g: Array) -> Array:
        """The polynomial q = sum g_k U_{k-1} at the sampling angles, from g (..., orders)."""
        padded = np.zeros((*g.shape[:-1], 2 * len(self.sines)))
        padded[..., : 2 * g.shape[-1] : 2] = g
        return np.asarray(0.5 * fft.dst(padded, type=3)[..., : len(self.sines)] / self.sines)


@lru_cache(maxsize=64)
def orders(count: int) -> Index:
    """The first `count` odd orders k = 1, 3, 5, ... of the series."""
    return np.arange(1, 2 * count, 2)


@lru_cache(maxsize=64)
def powers(count: int) -> Array:
    """The powers 1, k and k^2 of the first odd orders k, as an array (orders, 3)."""
    return np.vander(orders(count).astype(float), 3, increasing=True)


@lru_cache(maxsize=32)
def table(size: int) -> Table:
    """The `Table` with `size` nodes: the positive ones of the 2 * `size` Chebyshev nodes."""
    degree, k = 2 * size, orders(size)
    # Full turns are removed while the angle is an integer. Otherwise the round-off of k * theta
    # would grow with k.
    turns = (2 * np.arange(size)[:, None] + 1) * k % (4 * degree)
    matrix = np.cos(turns * (np.pi / (2 * degree))) * (4 / degree)
    sums = np.column_stack((matrix[:, 0], matrix @ k, matrix[:, -2:]))
    angle = (np.arange(size) + 0.5) * (np.pi / degree)
    samples = SAMPLES_PER_DEGREE * size
    at = (np.arange(samples) + 0.5) * (0.5 * np.pi / samples)
    return Table(np.cos(angle), sums, matrix, np.sin(at), np.cos(at))


def summed(g: Array, t: Array) -> Array:
    """Polynomial q(t) = sum g_k U_{k-1}(t) for |t| <= 1, by Clenshaw's recurrence in T_2(t)."""
    # The recurrence is U_{k+1} = 2 T_2 U_{k-1} - U_{k-3}, with U_{-2} = -1.
    twice = 2.0 * (2.0 * t * t - 1.0)
    last, before = np.zeros(np.shape(t)), np.zeros(np.shape(t))
    for c in g[::-1]:
        last, before = c + twice * last - before, last
    return last + before


def outside_transform(g: Array, t: Array) -> Array:
    """Hilbert transform of a series with coefficients g, at points t >= 1 outside the zone.
    It is the sum of g_k rho^k, with rho = t - sqrt(t^2 - 1). The shape of t is (..., points).
    """
    rho = 1.0 / (t + np.sqrt((t - 1.0) * (t + 1.0)))
    square = rho * rho
    if rho.ndim == 1 and len(g):
        raised = np.empty((len(g), len(rho)))
        raised[0], raised[1:] = rho, square
        return np.asarray(g.dot(np.multiply.accumulate(raised)))
    total: Array | float = 0.0
    for c in g.T[::-1, ..., None]:
        total = total * square + c
    return np.asarray(total * rho)


def outside_transform_integral(g: Array, t: Array) -> Array:
    """Integral from 1 to t of the Hilbert transform `outside_transform`, for one load.
    So the coefficients g have the shape (orders,).

    int rho^k dt = [(1 - rho^(k-1))/(k-1) - (1 - rho^(k+1))/(k+1)]/2.
    """
    log = np.log(t + np.sqrt((t - 1.0) * (t + 1.0)))
    total = np.zeros(np.shape(t))
    for k, c in zip(orders(len(g)), g, strict=True):
        lower = log if k == 1 else -np.expm1(-(k - 1) * log) / (k - 1)
        total += 0.5 * c * (lower + np.expm1(-(k + 1) * log) / (k + 1))
    return total
