"""Double-exponential quadrature on panels, accurate to round-off for endpoint singularities.

Algebraic and logarithmic singularities are allowed at the ends of a panel (Takahasi & Mori 1974,
doi 10.2977/prims/1195192451). Every radius where a profile is not smooth is an end of a panel.
"""

from collections.abc import Sequence
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from contact.reference.exact.numerics import FROM_LEFT, FROM_RIGHT, WEIGHT
from sie import Array


def panels(edges: Sequence[ArrayLike]) -> tuple[Array, Array]:
    """Nodes and weights of the quadrature on the intervals between successive edges.
    They are along a new last axis.

    Edges are broadcast and must not decrease; an empty panel has weights 0.
    """
    ends = [np.asarray(e, dtype=np.float64)[..., None] for e in edges]
    nodes, weights = [], []
    for lo, hi in zip(ends, ends[1:], strict=False):
        width = hi - lo
        # Each node is computed from the nearer end of its panel, so that its distance from that end
        # loses no digits.
        nodes.append(np.where(FROM_LEFT < 0.5, lo + width * FROM_LEFT, hi - width * FROM_RIGHT))
        weights.append(width * WEIGHT)
    return np.concatenate(np.broadcast_arrays(*nodes), axis=-1), np.concatenate(
        np.broadcast_arrays(*weights), axis=-1
    )


def quarter(x: ArrayLike, breaks: ArrayLike) -> tuple[Array, Array]:
    """A rule for the integral of F(x sin phi) over 0 < phi < pi/2: points x sin phi and weights.

    Panels end where x sin phi equals one of the `breaks`.
    """
    x = np.asarray(x, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        inner = [
            np.arcsin(np.clip(np.where(x > 0, b / x, 1.0), 0.0, 1.0)) for b in np.asarray(breaks)
        ]
    phi, weight = panels([np.zeros_like(x), *inner, np.full_like(x, 0.5 * pi)])
    return x[..., None] * np.sin(phi), weight


def half_gauss(n: int) -> tuple[Array, Array]:
    """The n positive nodes of the 2n-point Gauss-Legendre rule, and their weights.

    For even F, int_-1^1 F = 2 sum w F.
    """
    nodes, weights = np.polynomial.legendre.leggauss(2 * n)
    return nodes[n:], weights[n:]
