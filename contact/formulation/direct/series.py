"""Chebyshev series on one interval: from samples of G = sum g_k T_k(t) to Phi = sqrt(1 - t^2) sum g_k U_{k-1}(t), and off the interval.

Bounded at both ends, Phi has the coefficients of G itself; its integral is pi g_1/2 times the half length, and off the interval its
transform is sum g_k rho^k, rho = z - sgn(z) sqrt(z^2 - 1). Moving both ends outwards raises Phi by q(+-1) / sqrt(1 - t^2), q = sum g_k
U_{k-1}: so the load grows with the half length at the rate pi q(1), and all that is needed of a step is two sums over the samples.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import fft

Array = NDArray[np.float64]

# Samples of q for each degree: between them it lies within the hull of the samples, widened by 1 / cos(pi / 2 _DENSER) - 1 (H. Ehlich &
# K. Zeller, Math. Z. 86, 1964, 41, doi 10.1007/BF01111276).
_DENSER = 8
# Nodes up to which a product with a stored matrix is faster than the call of a fast transform.
_MATRICES = 64
# Orders up to which a sum of powers is Horner's; and numbers in a table of powers at the most.
_FEW, _AT_ONCE = 12, 1 << 20
WIDENED = 1.0 / np.cos(0.5 * np.pi / _DENSER) - 1.0


@dataclass(frozen=True, eq=False)
class Table:
    """Nodes t and what is made of values there. odd: of an odd G, on the right half alone.

    orders: k >= 1 of the coefficients; first: of g_1; edge, far_edge: of q(1) and q(-1); last: of the last two coefficients; sums: of g_1,
    q(1), those two, q(-1) and the mean at once. The angles at which q is looked at are given by their sines and cosines.
    """

    odd: bool
    t: Array
    orders: NDArray[np.intp]
    first: Array
    edge: Array
    far_edge: Array
    last: Array
    sums: Array
    sines: Array
    cosines: Array

    def coefficients(self, values: Array) -> Array:
        """g_k of values (rows, nodes)."""
        size = values.shape[1]
        if size <= _MATRICES:
            return np.asarray(values @ _matrix(size, self.odd))
        if self.odd:
            return np.asarray(fft.dct(values, type=4, axis=1) / size)
        return np.asarray(fft.dct(values, type=2, axis=1)[:, 1:] / size)

    def samples(self, g: Array) -> Array:
        """q at the looks, of coefficients (rows, some of the orders)."""
        if len(self.t) <= _MATRICES:
            return np.asarray(g @ _looks(len(self.t), self.odd)[0][:, : g.shape[1]].T)
        padded = self._padded(g, 1)
        return np.asarray(0.5 * fft.dst(padded, type=3, axis=1)[:, : len(self.sines)] / self.sines)

    def followed(self, g: Array) -> tuple[Array, Array]:
        """What sqrt(1 - t^2) q changes by at most at places t that stay, when the half length grows by a part of itself, and when the
        middle moves by a part of the half length (rows,): ends that move add q(+-1) / sqrt(1 - t^2), and the place moves with them."""
        rising = g * self.orders[: g.shape[1]]
        if self.odd:
            odd, even = rising.sum(axis=1)[:, None], 0.0
        else:
            uneven = self.orders[: g.shape[1]] % 2 == 1
            odd, even = rising[:, uneven].sum(axis=1)[:, None], rising[:, ~uneven].sum(axis=1)[:, None]
        if len(self.t) <= _MATRICES:
            slopes = rising @ _looks(len(self.t), self.odd)[1][:, : g.shape[1]].T
        else:
            slopes = 0.5 * fft.dct(self._padded(rising, 0), type=3, axis=1)[:, : len(self.sines)]
        by_half = (odd + self.cosines * (even - slopes)) / self.sines
        if self.odd:
            # The middle stays.
            return np.abs(by_half).max(axis=1), np.zeros(len(g))
        by_middle = (even + odd * self.cosines - slopes) / self.sines
        return np.abs(by_half).max(axis=1), np.abs(by_middle).max(axis=1)

    def _padded(self, g: Array, first: int) -> Array:
        """Coefficients by order, from order `first` on, as many as there are looks over a half turn."""
        padded = np.zeros((len(g), len(self.sines) * (2 if self.odd else 1)))
        padded[:, self.orders[: g.shape[1]] - first] = g
        return padded


@lru_cache(maxsize=32)
def table(size: int, odd: bool) -> Table:
    """size: number of nodes."""
    degree = 2 * size if odd else size
    angle = (np.arange(size) + 0.5) * (np.pi / degree)
    orders = np.arange(1, degree, 2 if odd else 1)
    matrix = _matrix(size, odd)
    looks = _DENSER * degree // (2 if odd else 1)
    at = (np.arange(looks) + 0.5) * (np.pi / (_DENSER * degree))
    far_edge = matrix @ (orders * (2.0 * (orders % 2) - 1.0))
    last = np.ascontiguousarray(matrix[:, -2:])
    first, edge = matrix[:, 0].copy(), matrix @ orders
    sums = np.column_stack((first, edge, last, far_edge, np.full(size, 1.0 / size)))
    return Table(odd, np.cos(angle), orders, first, edge, far_edge, last, sums, np.sin(at), np.cos(at))


@lru_cache(maxsize=8)
def _matrix(size: int, odd: bool) -> Array:
    """From values to coefficients (nodes, orders)."""
    degree = 2 * size if odd else size
    orders = np.arange(1, degree, 2 if odd else 1)
    # Whole turns taken off exactly: of k theta, rounding would grow with k.
    turns = (2 * np.arange(size)[:, None] + 1) * orders % (4 * degree)
    return np.asarray(np.cos(turns * (np.pi / (2 * degree))) * ((4 if odd else 2) / degree))


@lru_cache(maxsize=8)
def _looks(size: int, odd: bool) -> tuple[Array, Array]:
    """sin(k theta) / sin(theta) and cos(k theta) at the looks (looks, orders)."""
    degree = 2 * size if odd else size
    orders = np.arange(1, degree, 2 if odd else 1)
    at = (np.arange(_DENSER * degree // (2 if odd else 1)) + 0.5) * (np.pi / (_DENSER * degree))
    return np.sin(at[:, None] * orders) / np.sin(at)[:, None], np.cos(at[:, None] * orders)


def summed(g: Array, orders: NDArray[np.intp], t: Array) -> Array:
    """q(t) = sum g_k U_{k-1}(t) at points of [-1, 1], (orders,) and any shape: by Clenshaw's recurrence."""
    count = int(orders[-1]) if len(orders) else 0
    dense = np.zeros(count)
    dense[orders - 1] = g
    twice = 2.0 * t
    last, before = np.zeros(np.shape(t)), np.zeros(np.shape(t))
    for c in dense[::-1]:
        last, before = c + twice * last - before, last
    return last


def off(g: Array, orders: NDArray[np.intp], z: Array) -> Array:
    """sum g_k rho^k at z >= 1 (rows, points) for coefficients (rows, orders)."""
    rho = 1.0 / (z + np.sqrt((z - 1.0) * (z + 1.0)))
    step = rho * rho if len(orders) > 1 and orders[1] == 3 else rho
    if _FEW < len(orders) and rho.size * len(orders) < _AT_ONCE:
        powers = np.broadcast_to(step[:, :, None], (*step.shape, len(orders))).copy()
        powers[:, :, 0] = rho
        return np.asarray((np.multiply.accumulate(powers, axis=2) @ g[:, :, None])[:, :, 0])
    total = np.zeros(np.shape(z))
    for k in range(len(orders) - 1, -1, -1):
        total = total * step + g[:, k, None]
    return np.asarray(total * rho)


def off_integral(g: Array, orders: NDArray[np.intp], z: Array) -> Array:
    """The integral of `off` from 1 to z, of one row of coefficients: int rho^k dz = [(1 - rho^(k-1))/(k-1) - (1 - rho^(k+1))/(k+1)]/2."""
    log = np.log(z + np.sqrt((z - 1.0) * (z + 1.0)))
    total = np.zeros(np.shape(z))
    for k, c in zip(orders, g, strict=True):
        lower = log if k == 1 else -np.expm1(-(k - 1) * log) / (k - 1)
        total += 0.5 * c * (lower + np.expm1(-(k + 1) * log) / (k + 1))
    return total
