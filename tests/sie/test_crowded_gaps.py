"""Narrow zones beside a wide zone whose density has 300 knots. The parts of single knots are far
larger than their sum. The field on the narrow zones must have the small round-off of the sum.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline

import sie
from sie.jumps.density import DensityJumps
from sie.states.solve import SolveOptions

KNOTS = 300
ZONES = sie.Zones.of([[9.7, 10.3], [12.4, 270.6], [273.1, 273.9]])


def crowded() -> sie.Equation:
    """Equation whose density has the knots of a spline: the right side is its transform."""
    rng = np.random.default_rng(3)
    knots = np.arange(KNOTS) + rng.uniform(-0.3, 0.3, KNOTS)
    spline = BSpline(knots, np.pad(rng.normal(size=KNOTS - 9), 3), 2)
    at = knots[2:-2]
    pieces = np.column_stack(
        (spline(at), spline(at, 1), 0.5 * spline(0.5 * (at + np.append(at[1:], at[-1])), 2))
    )[:-1]
    jumps = np.diff(2 * pieces[:, 2], prepend=0.0, append=0.0)
    right = sie.PiecewiseTransform(sie.cauchy(), at, pieces, at, jumps)
    forcing = sie.Forcing(
        right, jumps=sie.Jumps(at, jumps, np.full(len(at), 2), of_density=True, spline=spline)
    )
    return sie.Equation(sie.cauchy(), forcing, (sie.ZoneTotals(),))


@pytest.fixture
def state(monkeypatch) -> sie.State:
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=1))
    return sie.solve_fixed(crowded(), ZONES, 1e-11)


def test_unknowns_have_the_size_of_the_density_which_agrees_with_the_sum_over_single_knots(
    state, monkeypatch
):
    t = np.linspace(-0.98, 0.98, 41)
    values = [state.density.at_t(zone, t) for zone in range(3)]
    assert state.iterated and np.abs(state.density.coefficients).max() > 1e3 * np.abs(values).max()
    assert np.abs(state.unknowns).max() < np.abs(values).max()
    monkeypatch.setattr("sie.dense.system.many_jumps", lambda *_: np.zeros(0, dtype=np.intp))
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10**6))
    parts = sie.solve_fixed(crowded(), ZONES, 1e-11)
    assert np.abs(parts.unknowns).max() > 1e3 * np.abs(values).max()
    assert values == pytest.approx(
        np.array([parts.density.at_t(zone, t) for zone in range(3)]), abs=1e-9
    )


def test_a_shift_of_zones_by_a_last_digit_changes_intensities_within_the_stated_noise(state):
    moved = replace(ZONES, a=ZONES.a * (1 + 3e-16), b=ZONES.b * (1 + 3e-16))
    other = sie.solve_fixed(crowded(), moved, 1e-11)
    change = np.abs(np.array(other.density.intensities) - np.array(state.density.intensities))
    assert np.all(change < state.intensity_noise)
    # The narrow zones' own round-off (`own`) is less than a tenth of the change. The rest comes
    # from the round-off of the wide zone.
    own = 4e-16 * np.sqrt(0.5 * ZONES.half) * np.abs(state.density.coefficients).sum(axis=1)
    assert np.all(change[:, [0, 2]] > 10 * own[[0, 2]])


def test_coefficients_of_jumps_beside_the_left_end_have_the_digits_of_those_beside_the_right():
    zones, places, count = sie.Zones.of([[-1.0, 1.0]]), np.array([1 - 2.0**-20, 0.75]), 3000
    height, order = np.array([0.8, 1.3]), np.array([2, 0])
    right, left = (
        DensityJumps.inside(zones, side * places, height, order, sie.cauchy()) for side in (1, -1)
    )
    turned = -((-1.0) ** np.arange(count)) * left.t_coefficients(zones, count)
    assert np.abs(turned - right.t_coefficients(zones, count)).max() < 1e-18
