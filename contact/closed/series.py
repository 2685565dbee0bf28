"""Chebyshev series on one interval: from samples of G = sum g_k T_k(t) to Phi = sqrt(1 - t^2) sum
g_k U_{k-1}(t), and off the interval.

Bounded at both ends, Phi has the coefficients of G itself; its integral is pi g_1/2 times the half
length, and off the interval its transform is sum g_k rho^k, rho = z - sgn(z) sqrt(z^2 - 1). Moving
both ends outwards raises Phi by q(+-1) / sqrt(1 - t^2), q = sum g_k U_{k-1}: so the load grows with
the half length at the rate pi q(1), and all that is needed of a step is two sums over the samples.
"""

from functools import lru_cache

import numpy as np
from scipy import fft

from sie import Array, Index, record

# Samples of q for each degree: between them it lies within the hull of the samples, widened by 1 /
# cos(pi / 2 _DENSER) - 1 (H. Ehlich & K. Zeller, Math. Z. 86, 1964, 41, doi 10.1007/BF01111276).
_DENSER = 8
# Nodes up to which a product with a stored matrix is faster than the call of a fast transform.
_MATRICES = 128
# Orders up to which a sum of powers is Horner's; and numbers in a table of powers at the most.
_FEW = 8
_AT_ONCE = 1 << 20
WIDENED = 1.0 / np.cos(0.5 * np.pi / _DENSER) - 1.0


@record
class Table:
    """Nodes t and what is made of values there. odd: of an odd G, on the right half alone.

    sums: of g_1, q(1), the last two coefficients, q(-1) and the mean (nodes, 6). The angles at
    which q is looked at are given by their sines and cosines.
    """

    odd: bool
    t: Array
    sums: Array
    sines: Array
    cosines: Array

    def coefficients(self, values: Array) -> Array:
        """g_k of values (..., nodes)."""
        size = values.shape[-1]
        if size <= _MATRICES:
            return np.asarray(values.dot(_matrix(size, self.odd)))
        if self.odd:
            return np.asarray(fft.dct(values, type=4) / size)
        return np.asarray(fft.dct(values, type=2)[..., 1:] / size)

    def samples(self, g: Array) -> Array:
        """q at the looks, of coefficients (..., some of the orders)."""
        if len(self.t) <= _MATRICES:
            return np.asarray(g.dot(_looks(len(self.t), self.odd)[: g.shape[-1]]))
        each = 2 if self.odd else 1
        padded = np.zeros((*g.shape[:-1], len(self.sines) * each))
        padded[..., : g.shape[-1] * each : each] = g
        return np.asarray(0.5 * fft.dst(padded, type=3)[..., : len(self.sines)] / self.sines)


@lru_cache(maxsize=64)
def orders(count: int, odd: bool) -> Index:
    """The first orders k >= 1 of a series."""
    return np.arange(1, 2 * count, 2) if odd else np.arange(1, count + 1)


@lru_cache(maxsize=64)
def powers(count: int, odd: bool) -> Array:
    """1, k and k^2 of these (orders, 3)."""
    return np.vander(orders(count, odd).astype(float), 3, increasing=True)


@lru_cache(maxsize=32)
def table(size: int, odd: bool) -> Table:
    """size: number of nodes."""
    degree = 2 * size if odd else size
    angle = (np.arange(size) + 0.5) * (np.pi / degree)
    matrix = _matrix(size, odd)
    k = orders(matrix.shape[1], odd)
    looks = _DENSER * degree // (2 if odd else 1)
    at = (np.arange(looks) + 0.5) * (np.pi / (_DENSER * degree))
    far_edge = matrix @ (k * (2.0 * (k % 2) - 1.0))
    sums = np.column_stack(
        (matrix[:, 0], matrix @ k, matrix[:, -2:], far_edge, np.full(size, 1.0 / size))
    )
    return Table(odd, np.cos(angle), sums, np.sin(at), np.cos(at))


@lru_cache(maxsize=8)
def _matrix(size: int, odd: bool) -> Array:
    """From values to coefficients (nodes, orders)."""
    degree = 2 * size if odd else size
    k = orders(size if odd else size - 1, odd)
    # Whole turns taken off exactly: of k theta, rounding would grow with k.
    turns = (2 * np.arange(size)[:, None] + 1) * k % (4 * degree)
    return np.asarray(np.cos(turns * (np.pi / (2 * degree))) * ((4 if odd else 2) / degree))


@lru_cache(maxsize=8)
def _looks(size: int, odd: bool) -> Array:
    """sin(k theta) / sin(theta) at the looks (orders, looks)."""
    degree = 2 * size if odd else size
    at = (np.arange(_DENSER * degree // (2 if odd else 1)) + 0.5) * (np.pi / (_DENSER * degree))
    return np.asarray(np.sin(orders(size if odd else size - 1, odd)[:, None] * at) / np.sin(at))


def summed(g: Array, odd: bool, t: Array) -> Array:
    """q(t) = sum g_k U_{k-1}(t) at points of [-1, 1], (orders,) and any shape: by Clenshaw's
    recurrence.
    """
    dense = g
    if odd:
        dense = np.zeros(2 * len(g))
        dense[::2] = g
    twice = 2.0 * t
    last, before = np.zeros(np.shape(t)), np.zeros(np.shape(t))
    for c in dense[::-1]:
        last, before = c + twice * last - before, last
    return last


def off(g: Array, odd: bool, t: Array) -> Array:
    """sum g_k rho^k, rho = t - sgn(t) sqrt(t^2 - 1), at |t| >= 1 (..., points) for coefficients
    (..., orders).
    """
    count = g.shape[-1]
    if not count:
        return np.zeros(t.shape)
    root = np.sqrt((t - 1.0) * (t + 1.0))
    # Of an odd series there is but the right half.
    rho = 1.0 / (t + (root if odd else np.copysign(root, t)))
    step = rho * rho if odd else rho
    if _FEW < count and rho.size * count < _AT_ONCE:
        # Each time as many powers again from those before.
        raised, known = np.empty((count, *rho.shape)), 1
        raised[0] = rho
        while known < count:
            more = min(known, count - known)
            np.multiply(raised[:more], step, out=raised[known : known + more])
            known, step = known + more, step * step
        return np.asarray(g.dot(raised) if rho.ndim == 1 else np.einsum("rk,krp->rp", g, raised))
    total: Array | float = 0.0
    for c in g.T[::-1, ..., None]:
        total = total * step + c
    return np.asarray(total * rho)


def off_integral(g: Array, odd: bool, t: Array) -> Array:
    """The integral of `off` from +-1 to t all of one sign, of one row: int rho^k dt = [(1 -
    rho^(k-1))/(k-1) - (1 - rho^(k+1))/(k+1)]/2 from 1 on, and (-1)^(k-1) times that from -1 on.
    """
    z = np.abs(t)
    log = np.log(z + np.sqrt((z - 1.0) * (z + 1.0)))
    total = np.zeros(np.shape(z))
    sides = np.where(orders(len(g), odd) % 2, 1.0, np.sign(t[0]))
    for k, c in zip(orders(len(g), odd), sides * g, strict=True):
        lower = log if k == 1 else -np.expm1(-(k - 1) * log) / (k - 1)
        total += 0.5 * c * (lower + np.expm1(-(k + 1) * log) / (k + 1))
    return total
