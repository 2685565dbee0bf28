"""Knots of a spline in a slit between two intervals with hundreds of knots. The series in the
slit decays to round-off all the same.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

import sie


@pytest.fixture(scope="module")
def state() -> sie.AnyState:
    """A solution on two intervals with 450 knots each; two knots lie in the slit between them."""
    rng, n = np.random.default_rng(3), 960
    at = np.arange(n) + rng.uniform(-0.3, 0.3, n)
    g = BSpline(at, rng.normal(size=n - 3), 2)
    jumps = np.diff(g.derivative(2)(0.5 * (at[1:] + at[:-1])))[2:-2]
    at = at[3:-3]
    middle = 0.5 * (at[475] + at[476])
    forcing = sie.Forcing(g, g.antiderivative(), sie.Jumps(at, jumps, np.full(len(at), 2)))
    zones = sie.Zones.of([[middle - 450.2, middle - 0.6], [middle + 0.65, middle + 450.3]])
    return sie.solve_zones(
        sie.Equation(sie.cauchy(), forcing, (sie.Total(500.0), sie.EqualPotential())), zones, 1e-12
    )


def test_the_error_stated_is_that_of_rounding(state: sie.AnyState) -> None:
    assert isinstance(state.density, sie.SlitDensity)
    assert len(state.density.jumps) == 1  # the jump that `ConjugateSpline.inside` adds
    assert state.density_error < 1e-10


def test_the_equation_holds_between_the_ends_and_the_gap_closes(state: sie.AnyState) -> None:
    density = state.density
    (a, b), (c, d) = density.zones.table
    x = np.concatenate(
        (np.linspace(a, b, 41)[1:-1], np.linspace(c, d, 41)[1:-1], [b - 1e-3, c + 1e-3])
    )
    g = state.equation.forcing.value
    assert density.transform(x) == pytest.approx(g(x), abs=1e-9 * np.abs(g(x)).max())
    level = density.potential(x) - state.equation.forcing.primitive(x)
    assert np.ptp(level) < 1e-7 * np.abs(density.potential(x)).max()
