"""Zones with many knots of the right side. Their fields on other zones have the round-off of the
right side itself, not the larger one of its truncated powers.
"""

import mpmath
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import sie
from sie.dense import modes
from sie.dense import spline_moments as module
from sie.dense.spline_moments import coefficients, many_jumps, rule
from sie.dense.system import System

ZONES = sie.Zones.of(np.array([[-0.83, -0.1], [0.01, 0.7]]))
M = np.array([12, 20])


def rough(knots, seed=0):
    """A periodic cubic spline through a random walk, and its slope as the right side. The second
    derivative of the slope jumps at every inner knot.
    """
    rng = np.random.default_rng(seed)
    x = np.linspace(-1, 1, knots + 1)
    heights = 1e-3 * np.cumsum(rng.normal(size=knots + 1))
    heights[-1] = heights[0]
    spline = CubicSpline(x, heights, bc_type="periodic")
    slope = spline.derivative()
    jumps = 6 * np.diff(spline.c[0])
    orders = np.full(knots - 1, 2)
    return spline, sie.Forcing(slope, spline, sie.Jumps(x[1:-1], jumps, orders))


def system(forcing, kernel):
    jumps = forcing.jumps_within(ZONES, kernel)
    g = modes.sample(forcing, ZONES, jumps, np.full(2, 16), 1e-13, 512).coefficients
    return System(
        sie.Equation(kernel, forcing, (sie.Total(0.3), sie.EqualPotential())), ZONES, M, g, jumps
    )


def _cubic(c, x):
    value = c[0]
    for one in c[1:]:
        value = value * x + one
    return value


def exactly(spline, zone, weight, derivative):
    """The integral (1/pi) int f weight(theta) dtheta over a zone, where f is the spline or its
    derivative. It is computed piece by piece with 30 digits.
    """
    middle, half = ZONES.middle[zone], ZONES.half[zone]
    inner = [x for x in spline.x if abs(x - middle) < half]
    with mpmath.workdps(30):
        ends = [
            mpmath.mpf(middle) - mpmath.mpf(half),
            *map(mpmath.mpf, inner),
            mpmath.mpf(middle) + mpmath.mpf(half),
        ]
        total = mpmath.mpf(0)
        for lo, hi in zip(ends[:-1], ends[1:], strict=True):
            k = int(np.searchsorted(spline.x, float(lo + hi) / 2)) - 1
            c, start = [mpmath.mpf(v) for v in spline.c[:, k]], mpmath.mpf(spline.x[k])
            c = [3 * c[0], 2 * c[1], c[2]] if derivative else c
            first, last = (mpmath.acos(max(-1, min(1, (x - middle) / half))) for x in (lo, hi))
            total += mpmath.quad(
                lambda a, c=c, x=start: _cubic(c, middle + half * mpmath.cos(a) - x) * weight(a),
                [last, first],
            )
        return float(total / mpmath.pi)


def test_coefficients_and_means_are_those_of_the_right_side_to_its_own_digits():
    spline, forcing = rough(120)
    jumps = forcing.jumps_within(ZONES, sie.cauchy())
    chosen = many_jumps(forcing, ZONES, jumps)
    assert list(chosen) == [0, 1]
    found, means = coefficients(forcing, ZONES, jumps, chosen, M)
    powers = np.abs(jumps.height).sum()
    size = np.abs(forcing.value(np.linspace(-0.8, 0.7, 400))).max()
    assert powers > 1e3 * size  # truncated powers would lose three digits
    for zone, k in ((0, 1), (1, 9)):
        exact = exactly(
            spline, zone, lambda a, k=k: 2 * mpmath.sin(a) * mpmath.sin(k * a), derivative=True
        )
        assert found[zone, k] == pytest.approx(exact, abs=4e-16 * size)
    assert means[1] == pytest.approx(
        exactly(spline, 1, lambda a: 1, derivative=False), abs=4e-16 * np.abs(spline.c[3]).max()
    )


@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(2.2)], ids=["line", "period"])
def test_the_density_is_the_one_that_truncated_powers_give(kernel, monkeypatch):
    """The density from integrals between the jumps agrees with the density from truncated
    powers.

    In the first case the unknowns are coefficients of the whole density. In the second case the
    parts due to the jumps have closed forms, and are not among the unknowns.
    """
    _, forcing = rough(100)
    equation = sie.Equation(kernel, forcing, (sie.Total(0.3), sie.EqualPotential()))
    state = sie.solve_fixed(equation, ZONES)
    monkeypatch.setattr(module, "OPTIONS", module.MomentOptions(min_jumps=10**6))
    plain = sie.solve_fixed(equation, ZONES)
    assert len(state.system.by_moments) == 2 and len(plain.system.by_moments) == 0
    t = np.linspace(-0.98, 0.98, 41)
    for zone in (0, 1):
        assert state.density.at_t(zone, t) == pytest.approx(plain.density.at_t(zone, t), abs=1e-9)
    assert state.density.total == pytest.approx(0.3, abs=1e-13)
    assert np.ptp(state.levels) < 1e-15


@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(2.2)], ids=["line", "period"])
@pytest.mark.parametrize("mirrored", [False, True])
def test_the_density_beside_a_plateau_is_the_one_that_truncated_powers_give(
    kernel, mirrored, monkeypatch
):
    """The field of a plateau has logarithms at the plateau's ends. Their series in closed form is
    added to the series of the right side, which is computed by integrals between the jumps.
    """
    spline, forcing = rough(100)
    zones, value = np.array([[-0.83, -0.1], [0.01, 0.7]]), sie.free_with_value(0.3)
    if mirrored:
        zones = np.array([[-0.83, -0.1], [0.1, 0.83]])
        forcing = sie.Forcing(
            lambda x: spline(x, 1) - spline(-x, 1),
            lambda x: spline(x) + spline(-x),
            sie.Jumps(*_mirrored(forcing.jumps), orders=2),
        )
    zones = sie.Zones.of(zones, [sie.FREE, value], [value, sie.FREE], mirrored)
    equation = sie.Equation(kernel, forcing, (sie.Total(0.3), sie.EqualPotential())[: 2 - mirrored])
    state = sie.solve_fixed(equation, zones)
    monkeypatch.setattr(module, "OPTIONS", module.MomentOptions(min_jumps=10**6))
    plain = sie.solve_fixed(equation, zones)
    assert len(state.system.by_moments) == 2 - mirrored and len(plain.system.by_moments) == 0
    t = np.linspace(-0.98, 0.98, 41)
    for zone in (0, 1):
        expected = plain.density.at_t(zone, t)
        assert state.density.at_t(zone, t) == pytest.approx(expected, abs=1e-9)
        assert np.abs(expected).max() > 0.1
    assert np.ptp(state.levels) < 1e-14


def _mirrored(jumps):
    """Positions and heights of the jumps of g(x) - g(-x), for g with `jumps` of order 2."""
    at = np.concatenate((jumps.at, -jumps.at))
    order = np.argsort(at)
    return at[order], np.concatenate((jumps.heights, jumps.heights))[order]


def test_levels_lose_their_digits_to_truncated_powers(monkeypatch):
    """Means of the primitive from truncated powers have more than a hundred times the error of
    means from integrals between the jumps. So the test of the means above can fail.
    """
    spline, forcing = rough(120)
    exact = [exactly(spline, zone, lambda a: 1, derivative=False) for zone in (0, 1)]
    between = system(forcing, sie.cauchy())._forcing_means()
    monkeypatch.setattr(module, "OPTIONS", module.MomentOptions(min_jumps=10**6))
    powers = system(forcing, sie.cauchy())._forcing_means()
    assert np.abs(between - exact).max() < 1e-15 * np.abs(spline.c[3]).max()
    assert np.abs(powers - exact).max() > 100 * np.abs(between - exact).max()


def test_the_rule_between_jumps_is_exact_for_a_constant():
    """The weights of the rule add up to pi. The constant 1 has the coefficient 1 of U_0, and no
    others up to the degree 700.
    """
    _, forcing = rough(60)
    jumps = forcing.jumps_within(ZONES, sie.cauchy())
    rules = [rule(jumps, zone, highest) for zone, highest in ((0, 0), (1, 700))]
    for _, weights in rules:
        assert weights.sum() == pytest.approx(np.pi, rel=1e-14)
    flat = sie.Forcing(np.ones_like)
    sines, means = coefficients(flat, ZONES, jumps, np.array([0, 1]), np.array([0, 700]))
    assert (
        sines[1, 1] == pytest.approx(1.0, rel=1e-13)
        and np.abs(sines[1, 2:]).max() < 1e-14
        and not sines[0].any()
        and not means.any()
    )
