"""The derivatives of a functional of a measured profile by the heights of all its points.

The spline through points (x, z) is a cubic polynomial on each interval. The heights z and the
slopes s at both ends of the interval determine it; the slopes solve A s = R z with matrices A and
R. Let a weighted sum of heights and slopes of the spline have the derivatives g by z at fixed s,
and k by s at fixed z. Then the whole derivative of this sum by z is g + R^T A^(-T) k (T:
transposed).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.derivatives.adjoint import Weights
from contact.extras import require
from contact.model.profiles.sampled import Sampled
from sie import Array


def by_heights(profile: Sampled, weights: Weights) -> Array:
    """Derivatives of a functional by the heights of all points of a measured profile.
    Heights count upwards, so that the profile is f = max - height.
    """
    repeats = profile.period is not None
    x = np.append(profile.x, profile.x[0] + profile.period) if repeats else profile.x
    at = np.asarray(profile.wrap(weights.x), dtype=float)
    piece = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    width = np.diff(x)[piece]
    u = (at - x[piece]) / width
    v = 1 - u
    # Hermite's cubic basis and its derivative, for the heights at the left and right end of an
    # interval, and the slopes at the left and right end.
    value = (v * v * (1 + 2 * u), u * u * (1 + 2 * v), u * v * v * width, -u * u * v * width)
    rise = (-6 * u * v / width, 6 * u * v / width, v * (v - 2 * u), u * (u - 2 * v))
    n = len(profile.x)
    sums = np.zeros((2, n))
    for j, (one, two) in enumerate(zip(value, rise, strict=True)):
        # With a period, the end of the last interval is the first point.
        np.add.at(sums[j // 2], (piece + j % 2) % n, weights.heights * one + weights.slopes * two)
    g, k = sums
    matrix, right = _slopes(np.diff(x), repeats)
    solved = require("scipy.sparse.linalg").splu(matrix.T.tocsc()).solve(k)
    return -np.asarray(g + right.T @ solved)


def _slopes(h: Array, repeats: bool) -> tuple[Any, Any]:
    """Matrices A and R with A s = R z, for the slopes s of the spline through the heights z.

    C. de Boor, A Practical Guide to Splines, Springer 1978, chapter IV.
    """
    sparse = require("scipy.sparse")
    n = len(h) if repeats else len(h) + 1
    rows: list[tuple[int, int, float, float]] = []
    inner = range(n) if repeats else range(1, n - 1)
    for i in inner:
        before, after = h[i - 1], h[i % len(h)]
        left, right = (i - 1) % n, (i + 1) % n
        rows += [
            (i, left, 1 / before, -3 / before**2),
            (i, i, 2 / before + 2 / after, 3 / before**2 - 3 / after**2),
            (i, right, 1 / after, 3 / after**2),
        ]
    if not repeats:
        # The "not-a-knot" condition: the third derivative does not jump at the second point and at
        # the last but one.
        for i, step, a, b in ((0, 1, h[0], h[1]), (n - 1, -1, h[-1], h[-2])):
            d, sign = a + b, float(step)
            first, second = sign * (a + 2 * d) * b / d / a, sign * a * a / d / b
            rows += [
                (i, i, b, -first),
                (i, i + step, d, first - second),
                (i, i + 2 * step, 0.0, second),
            ]
    at, to, a, r = (np.array(column) for column in zip(*rows, strict=True))
    shape = (n, n)
    return sparse.csr_matrix((a, (at, to)), shape), sparse.csr_matrix((r, (at, to)), shape)
