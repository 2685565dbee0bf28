"""Derivatives of intensities and levels by the places of ends, against the flat punch and against
solutions with moved ends.
"""

from __future__ import annotations

import numpy as np
import pytest

import sie

END = sie.free_with_intensity(-0.1)
APART = np.array([[-1.0, -0.3], [0.0, 0.5], [0.8, 1.0]])
MIRRORED = np.array([[-1.0, -0.5], [-0.2, 0.2], [0.5, 1.0]])
FORCING = sie.Forcing(
    lambda x: np.sin(3 * x) + 2 * x + 0.3 * np.cos(5 * x),
    lambda x: -np.cos(3 * x) / 3 + x**2 + 0.06 * np.sin(5 * x),
)
ODD = sie.Forcing(lambda x: np.sin(3 * x) + 2 * x, lambda x: -np.cos(3 * x) / 3 + x**2)
KERNELS = [sie.cauchy(), sie.cauchy(3.0), sie.hilbert(3.0), sie.images(2.5, 2)]


def _state(kernel, forcing, conditions, table, symmetric=False):
    zones = sie.Zones.of(table, END, END, symmetric=symmetric)
    return sie.solve_fixed(sie.Equation(kernel, forcing, conditions), zones, 1e-15)


def _moved(table, side, i, by, symmetric):
    moved = table.copy()
    moved[i, side] += by if side else -by
    if symmetric:
        moved[len(table) - 1 - i, 1 - side] = -moved[i, side]
    return moved


def test_rates_of_a_flat_punch_under_a_given_load():
    # Both ends have K = P / (pi sqrt(2 w)) with the half width w = 2. If one end moves outward by
    # e, w grows by e / 2, and K at both ends changes by -K e / (4 w).
    state = _state(
        sie.cauchy(), sie.Forcing(np.zeros_like, np.zeros_like), (sie.Total(1.0),), [[-2.0, 2.0]]
    )
    k = 1 / (np.pi * np.sqrt(4.0))
    assert sie.end_rates(state).intensities == pytest.approx(
        -k / 8.0 * np.array([[1.0, 1.0], [1.0, 1.0]]), rel=1e-13
    )


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize(
    "conditions",
    [(sie.Total(1.0), sie.EqualPotential()), (sie.Level(-2.0),), (sie.ZoneTotals(0.3),)],
)
@pytest.mark.parametrize(
    ("forcing", "table", "symmetric"),
    [(FORCING, APART, False), (ODD, MIRRORED, True), (ODD, MIRRORED[[0, 2]], True)],
)
def test_rates_are_those_of_solutions_with_moved_ends(
    kernel, conditions, forcing, table, symmetric
):
    rates = sie.end_rates(_state(kernel, forcing, conditions, table, symmetric))
    levels = not isinstance(conditions[0], sie.ZoneTotals)
    size = np.abs(rates.intensities).max()
    for j, (side, i) in enumerate(rates.ends):
        h = 1e-4 * (table[i, 1] - table[i, 0])
        states = [
            _state(kernel, forcing, conditions, _moved(table, side, i, q * h, symmetric), symmetric)
            for q in (1, -1, 2, -2)
        ]
        of_ends = [
            np.array([np.array(s.density.intensities)[end] for end in rates.ends]) for s in states
        ]
        slope = (8 * (of_ends[0] - of_ends[1]) - (of_ends[2] - of_ends[3])) / (12 * h)
        assert np.abs(slope - rates.intensities[:, j]).max() < 1e-9 * size
        if levels:
            of_levels = [s.levels for s in states]
            slope = (8 * (of_levels[0] - of_levels[1]) - (of_levels[2] - of_levels[3])) / (12 * h)
            assert np.abs(slope - rates.levels[:, j]).max() < 1e-8
