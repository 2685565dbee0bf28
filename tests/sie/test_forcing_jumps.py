"""Jumps of the right side and of its derivatives: closed forms against their series and against
quadrature.
"""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

import sie
from sie.basis.interval import by_angle
from sie.jumps.right_side import ForcingJumps
from tests.sie import reference
from tests.tiers import quick

ZONES = sie.Zones.of([[-1.3, 0.4], [0.9, 1.6]])
NO_COEFFICIENTS = np.zeros((2, 1))
# (position, order) of the jump, near the ends and near the middle of both zones.
PLACES = [(-1.25, 0), (-0.45, 0), (1.1, 0), (-0.9, 1), (1.55, 1), (0.1, 2), (1.25, 2)]
each_place = pytest.mark.parametrize(
    ("at", "order"), quick(PLACES, [(-0.45, 0), (-0.9, 1), (1.25, 2)])
)


def single(at, order, height=0.8, kernel=None):
    """(jumps, density): the closed-form density that the engine subtracts for a single jump."""
    kernel = kernel or sie.cauchy()
    jumps = ForcingJumps.within(
        ZONES, np.array([at]), np.array([height]), np.array([order]), kernel.period
    )
    return jumps, sie.Density(ZONES, kernel, NO_COEFFICIENTS, jumps, np.zeros(0))


def forcing(at, order, height=0.8, smooth=0.0):
    """g = smooth x + height (x - at)_+^order / order!, with its primitive."""
    factorial = [1.0, 1.0, 2.0]

    def value(x):
        return smooth * x + height * np.where(x > at, (x - at) ** order, 0.0) / factorial[order]

    def primitive(x):
        return 0.5 * smooth * x * x + height * np.maximum(x - at, 0.0) ** (order + 1) / factorial[
            order
        ] / (order + 1)

    return sie.Forcing(
        value, primitive, sie.Jumps(np.array([at]), np.array([height]), np.array([order]))
    )


@each_place
def test_the_closed_density_is_the_sum_of_its_series(at, order):
    jumps, density = single(at, order)
    zone = int(jumps.zone[0])
    t = np.array([-0.95, -0.4, 0.13, 0.8])
    count = 40000
    series = jumps.t_coefficients(ZONES, count)[zone]
    theta = np.arccos(t)
    summed = np.cos(theta[:, None] * np.arange(count)) @ series / np.sin(theta)
    # The terms decay as l^-(1 + order), with the index l, and oscillate. So the truncation error is
    # a moderate multiple of the last term. The tolerance is 80 times count^-(1 + order).
    assert density.at_t(zone, t) == pytest.approx(summed, abs=2e-3 / count**order)


@each_place
def test_the_transform_off_the_zone_is_that_of_the_density(at, order):
    _, density = single(at, order)
    for x in (-2.0, -1.35, 0.42, 0.8, 1.7, 30.0):
        expected = reference.transform(density_of(density), ZONES.table, x, reference.cauchy, [at])
        assert density.transform(x) == pytest.approx(expected, abs=1e-11)


@each_place
def test_the_transform_on_the_zone_is_that_of_the_density(at, order):
    _, density = single(at, order)
    for x in (-1.0, -0.2, 0.35, 1.0, 1.4):
        expected = reference.transform(density_of(density), ZONES.table, x, reference.cauchy, [at])
        assert density.transform(x) == pytest.approx(expected, abs=1e-10)


@each_place
def test_the_potential_is_that_of_the_density_on_and_off_the_zone(at, order):
    _, density = single(at, order)
    for x in (-2.0, -1.0, 0.3, 0.42, 1.0, 1.58, 30.0):
        expected = reference.potential(
            density_of(density), ZONES.table, x, reference.log_cauchy, [at]
        )
        assert density.potential(x) == pytest.approx(expected, abs=1e-10)


@each_place
def test_right_sides_with_jumps_need_few_modes_and_are_satisfied_everywhere(at, order):
    g = forcing(at, order, smooth=1.0)
    state = sie.solve_fixed(
        sie.Equation(sie.cauchy(), g, (sie.Total(0.7), sie.EqualPotential())),
        sie.Zones.of(ZONES.table, sie.SINGULAR, sie.SINGULAR),
    )
    assert state.sizes.own.max() <= 24
    x = np.concatenate((np.linspace(-1.29, 0.39, 50), np.linspace(0.91, 1.59, 50)))
    assert state.density.transform(x) == pytest.approx(g.value(x), abs=1e-12)
    level = state.density.potential(x) - g.primitive(x)
    assert np.ptp(level) < 1e-12


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9, 1e-13])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_kink_very_near_an_end_is_solved_like_any_other(distance, side):
    at = side * (1 - distance)
    g = forcing(at, 0, height=1.0)
    zones = sie.Zones.of([[-1, 1]], sie.SINGULAR, sie.SINGULAR)
    state = sie.solve_fixed(sie.Equation(sie.cauchy(), g, (sie.Total(1.0),)), zones)
    t = np.linspace(-0.99, 0.99, 31)
    phi = 2 * np.arctan2(np.sqrt(1 - at), np.sqrt(1 + at))
    theta = np.arccos(t)
    kappa = np.log(np.abs(np.sin((theta + phi) / 2) / np.sin((theta - phi) / 2)))
    # With g = (step - phi/pi) + phi/pi, the first part has the density kappa/pi, the second
    # -(phi/pi) T_1 / sqrt(1 - t^2). A multiple of T_0 / sqrt(1 - t^2) makes the total 1.
    expected = kappa / np.pi + (-phi / np.pi * t + (1 - np.sin(phi)) / np.pi) / np.sin(theta)
    assert state.density.at_t(0, t) == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("n", [16, 24, 48])
@pytest.mark.parametrize("zone", [(-1.0, 1.0), (-0.37, 0.91), (100.3, 100.7)])
def test_a_kink_at_a_node_or_one_round_off_beside_it_is_solved_like_any_other(n, zone):
    a, b = zone
    w = 0.5 * (b - a)
    t = np.linspace(-0.98, 0.98, 33)
    theta = np.arccos(t)
    from_node = sie.basis.chebyshev.lobatto(n)
    for k in (1, n // 3, n // 2, n):
        node = (
            a + w * from_node[2][k]
            if from_node[2][k] <= from_node[1][k]
            else b - w * from_node[1][k]
        )
        for at in (node, np.nextafter(node, np.inf), np.nextafter(node, -np.inf)):
            g = forcing(at, 0)
            equation = sie.Equation(sie.cauchy(), g, (sie.Total(1.0),))
            density = sie.solve_fixed(
                equation, sie.Zones.of([zone], sie.SINGULAR, sie.SINGULAR)
            ).density
            phi = 2 * np.arctan2(np.sqrt(b - at), np.sqrt(at - a))
            kappa = 0.8 * np.log(np.abs(np.sin((theta + phi) / 2) / np.sin((theta - phi) / 2)))
            rest = -0.8 * phi * t + 1 / w - 0.8 * np.sin(phi)
            assert density.at_t(0, t) == pytest.approx(
                (kappa + rest / np.sin(theta)) / np.pi, abs=2e-12
            )


def test_a_thousand_kinks_are_carried_exactly():
    rng = np.random.default_rng(5)
    at, heights = np.sort(rng.uniform(-1.5, 1.5, 1000)), rng.normal(size=1000)

    def value(x):
        return 4 * x + (x[..., None] > at) @ heights

    def primitive(x):
        return 2 * x * x + np.maximum(x[..., None] - at, 0) @ heights

    equation = sie.Equation(
        sie.cauchy(), sie.Forcing(value, primitive, sie.Jumps(at, heights)), (sie.Total(1.0),)
    )
    state = sie.solve_fixed(equation, sie.Zones.of([[-1, 1]], sie.SINGULAR, sie.SINGULAR))
    x = np.linspace(-0.99, 0.99, 101)
    assert state.sizes.own[0] == 16
    # The tolerance is the round-off of sums of a thousand terms of size one.
    assert state.density.transform(x) == pytest.approx(value(x), abs=1e-12)
    assert np.ptp(state.density.potential(x) - primitive(x)) < 1e-12


def test_with_a_period_jumps_repeat():
    kernel = sie.hilbert(2.0 * np.pi)
    near, far = single(-0.45, 0, kernel=kernel)[1], single(-0.45 + 6 * np.pi, 0, kernel=kernel)[1]
    x = np.linspace(-2.0, 2.0, 9)
    assert far.transform(x) == pytest.approx(near.transform(x), abs=1e-13)


def test_jumps_outside_the_zones_are_ignored():
    jumps = ForcingJumps.within(
        ZONES, np.array([-1.3, 0.4, 0.6, 5.0]), np.ones(4), np.zeros(4, dtype=int), None
    )
    assert len(jumps) == 0


def test_a_column_of_unknown_amplitude_must_be_smooth():
    column = sie.Forcing(np.sign, np.abs, sie.Jumps(np.array([0.0]), np.array([2.0])))
    with pytest.raises(ValueError, match="must be smooth"):
        sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (sie.Total(1.0),), columns=(column,))


def density_of(density):
    return lambda t, zone: density.at_t(zone, t)


@pytest.mark.parametrize("at", [-1.25, -0.45, 1.1])
def test_the_integral_of_kinks_along_a_zone_is_that_of_the_density(at):
    breaks = [at]
    _, density = single(at, 0)
    zone = int(density.jumps.zone[0])
    a, b = ZONES.table[zone]
    for x in np.linspace(a, b, 6)[1:]:
        pieces = [a, *(s for s in breaks if s < x), x]
        expected = sum(
            quad(density, lo, hi, epsabs=1e-12)[0]
            for lo, hi in zip(pieces, pieces[1:], strict=False)
        )
        half = 0.5 * (b - a)
        found = half * density.jumps.integral(
            np.array([zone]), np.array([(x - a) / half]), np.array([(b - x) / half])
        )
        assert found == pytest.approx(expected, abs=1e-10)


@each_place
def test_the_slope_over_the_angle_is_that_of_the_density(at, order):
    _, density = single(at, order)
    zone, step = int(density.jumps.zone[0]), 1e-5

    def value(theta):
        return density.jumps.density(zone, 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2)

    theta = np.array([0.3, 1.0, 1.9, 2.9])
    slope = by_angle(lambda left, right: density.jumps.density(zone, left, right), theta)[1]
    # The error of the central difference is largest beside the jump, where the third derivative
    # is large.
    assert slope == pytest.approx(
        (value(theta + step) - value(theta - step)) / (2 * step), rel=1e-5, abs=1e-8
    )


@pytest.fixture(scope="module")
def many_knots():
    """(cubic spline through noise, jumps of its third derivative, solved density).

    The right side is the spline's slope. The parts of the single knots have independent
    round-off, and their sum is far smaller than each of them.
    """
    rng = np.random.default_rng(3)
    knots = np.linspace(-1, 1, 301)
    spline = CubicSpline(knots, 1e-3 * rng.normal(size=knots.size))
    third = np.diff(6 * spline.c[0])
    g = sie.Forcing(
        lambda x: spline(x, 1), spline, sie.Jumps(knots[1:-1], third, np.full(len(third), 2))
    )
    zones = sie.Zones.of([[-0.9, 0.95]], sie.SINGULAR, sie.SINGULAR)
    return (
        spline,
        third,
        sie.solve_fixed(sie.Equation(sie.cauchy(), g, (sie.Total(1.0),)), zones, 1e-13).density,
    )


def test_the_potential_on_a_zone_of_many_knots_is_the_primitive_of_the_right_side(many_knots):
    spline, third, density = many_knots
    x = np.linspace(-0.89, 0.94, 57)
    assert np.ptp(density.potential(x) - spline(x)) < np.finfo(float).eps * np.abs(third).sum()


@pytest.mark.parametrize("away", [1e-8, 1e-6, 1e-4])
def test_the_potential_beside_a_zone_of_many_knots_is_the_primitive_of_its_transform(
    many_knots, away
):
    _, third, density = many_knots
    nodes, weights = np.polynomial.legendre.leggauss(24)
    # The integral is over the root of the distance from the end, in which the transform is
    # smooth. The distance runs from away / 4 to away.
    root = np.sqrt(away) * (0.75 + 0.25 * nodes)
    rise = float((0.25 * np.sqrt(away) * weights * 2 * root) @ density.transform(0.95 + root**2))
    found = np.diff(density.potential(0.95 + away * np.array([0.25, 1.0])))[0]
    # The tolerance is that of independent round-off of each knot's part.
    assert abs(found - rise) < np.finfo(float).eps * np.linalg.norm(third)


def test_coefficients_of_jumps_stop_at_the_count_of_each_zone():
    at, orders = (np.array(part) for part in zip(*PLACES, strict=True))
    jumps = ForcingJumps.within(ZONES, at, np.linspace(0.5, 1.5, len(at)), orders, None)
    every, counts = jumps.t_coefficients(ZONES, 40), np.array([7, 40])
    assert jumps.first_coefficients(ZONES, counts) == pytest.approx(
        np.where(np.arange(40) < counts[:, None], every, 0.0), abs=1e-15
    )
