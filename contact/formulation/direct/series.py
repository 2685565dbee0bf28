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

Array = NDArray[np.float64]

# Samples of q for each degree: between them it lies within the hull of the samples, widened by 1 / cos(pi / 2 _DENSER) - 1 (H. Ehlich &
# K. Zeller, Math. Z. 86, 1964, 41, doi 10.1007/BF01111276).
_DENSER = 8
WIDENED = 1.0 / np.cos(0.5 * np.pi / _DENSER) - 1.0


@dataclass(frozen=True, eq=False)
class Table:
    """Nodes t and what is made of values there. odd: of an odd G, on the right half alone.

    orders: k >= 1 of the coefficients; to_coefficients: (nodes, orders); first: of g_1; edge, far_edge: of q(1) and q(-1). samples: of q
    at angles, (angles, orders), whose sines and cosines are these; by_half, by_middle: of what sqrt(1 - t^2) q at a place t that stays
    changes by when the half length grows by a part of itself, and when the middle moves by a part of the half length.
    """

    t: Array
    orders: NDArray[np.intp]
    to_coefficients: Array
    first: Array
    edge: Array
    far_edge: Array
    samples: Array
    by_half: Array
    by_middle: Array
    sines: Array
    cosines: Array


@lru_cache(maxsize=16)
def table(size: int, odd: bool) -> Table:
    """size: number of nodes."""
    degree = 2 * size if odd else size
    angle = (np.arange(size) + 0.5) * (np.pi / degree)
    orders = np.arange(1, degree, 2 if odd else 1)
    # Whole turns taken off exactly: of k theta, rounding would grow with k.
    turns = (2 * np.arange(size)[:, None] + 1) * orders % (4 * degree)
    matrix = np.cos(turns * (np.pi / (2 * degree))) * ((4 if odd else 2) / degree)
    looks = _DENSER * degree // (2 if odd else 1)
    at = (np.arange(looks) + 0.5) * (np.pi / (_DENSER * degree))
    sines, cosines = np.sin(at), np.cos(at)
    samples = np.sin(at[:, None] * orders) / sines[:, None]
    # Ends that move add q(+-1) / sqrt(1 - t^2), and the place moves on with them.
    slopes, uneven = np.cos(at[:, None] * orders), orders % 2 == 1
    t = cosines[:, None]
    by_half = orders * (np.where(uneven, 1.0, t) - t * slopes) / sines[:, None]
    by_middle = orders * (np.where(uneven, t, 1.0) - slopes) / sines[:, None]
    far_edge = matrix @ (orders * (2.0 * uneven - 1.0))
    return Table(
        np.cos(angle), orders, matrix, matrix[:, 0].copy(), matrix @ orders, far_edge, samples, by_half, by_middle, sines, cosines
    )


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
