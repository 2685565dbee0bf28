"""The transform of a piecewise quadratic function, against closed forms in forty digits, and the
number of jumps near a cell.
"""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

import sie

Array = NDArray[np.float64]


def drawn(rng: np.random.Generator, ends: Array) -> tuple[Array, Array]:
    """(pieces, jumps of the second derivative at all ends) of a random function on the pieces.
    The function and its slope vanish at the first and the last end.
    """
    step = np.diff(ends)
    bend = rng.standard_normal(len(step))
    # Effect of each piece's second derivative on slope and value at the last end. The first and
    # the last piece are changed so that both are zero there.
    effect = np.array([step, step * (ends[-1] - ends[1:] + 0.5 * step)])
    some = np.array([0, len(step) - 1])
    bend[some] -= np.linalg.solve(effect[:, some], effect @ bend)
    slope = np.concatenate(([0.0], np.cumsum(bend * step)[:-1]))
    value = np.concatenate(([0.0], np.cumsum(slope * step + 0.5 * bend * step**2)[:-1]))
    return np.column_stack((value, slope, 0.5 * bend)), np.diff(bend, prepend=0.0, append=0.0)


@pytest.mark.parametrize("kind", ["even", "random", "in heaps"])
def test_the_transform_equals_that_of_its_pieces_in_forty_digits(kind: str) -> None:
    rng = np.random.default_rng(3)
    inner = {
        "even": np.arange(1.0, 13),
        "random": np.sort(rng.uniform(0, 13, 12)),
        "in heaps": 5 + np.geomspace(1e-6, 1, 12),
    }[kind]
    ends = np.concatenate(([0.0], inner, [13.0]))
    pieces, jumps = drawn(rng, ends)
    made = sie.PiecewiseTransform(sie.cauchy(), ends, pieces, ends, jumps)
    x = np.concatenate((rng.uniform(0.1, 12.9, 6), inner[:2] + 1e-8))
    wanted = np.array([exact(ends, pieces, place) for place in x])
    assert np.max(np.abs(made(x) - wanted)) < 2e-13 * np.max(np.abs(pieces[:, 0]))


def exact(ends: Array, pieces: Array, x: float) -> float:
    with mpmath.workdps(40):
        total = mpmath.mpf(0)
        for a, b, piece in zip(ends[:-1], ends[1:], pieces, strict=True):
            left, length = mpmath.mpf(x) - mpmath.mpf(a), mpmath.mpf(b) - mpmath.mpf(a)
            p0, p1, p2 = (mpmath.mpf(c) for c in piece)
            # In closed form, by division of the piece, a polynomial of xi - a, by x - xi.
            total += (p0 + left * (p1 + left * p2)) * mpmath.log(abs(left / (left - length)))
            total -= (p1 + p2 * left) * length + p2 * length**2 / 2
        return float(total / mpmath.pi)


@pytest.mark.parametrize("kind", ["even", "random", "in heaps"])
def test_at_most_twelve_jumps_are_near_a_cell_and_cells_are_at_most_four_per_piece(
    kind: str,
) -> None:
    rng, n = np.random.default_rng(4), 3000
    x = {
        "even": np.arange(n + 1.0),
        "random": np.sort(rng.uniform(0, n, n + 1)),
        "in heaps": np.sort(
            np.concatenate((rng.uniform(0, n, n // 2), n / 3 + rng.normal(size=n // 2 + 1)))
        ),
    }[kind]
    pieces, jumps = drawn(rng, x)
    made = sie.PiecewiseTransform(sie.hilbert(x[-1] - x[0]), x, pieces, x[:-1], jumps[:-1])
    assert made.most_near <= 12
    assert len(made) <= 4 * n
