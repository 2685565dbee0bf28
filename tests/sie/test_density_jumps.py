"""Jumps of the density and of its derivatives: closed forms against their series and against
quadrature.
"""

import numpy as np
import pytest
from scipy.integrate import quad

import sie
from sie.jumps.density import DensityJumps
from tests.sie import reference
from tests.tiers import diagonal, quick

ZONES = sie.Zones.of([[-1.3, 0.4], [0.9, 1.6]])
NO_COEFFICIENTS = np.zeros((2, 1))
PERIOD = 3.5
# (position, order) of the jump, near the ends and near the middle of both zones.
PLACES = [(-1.25, 0), (-0.45, 0), (1.1, 0), (-0.9, 1), (1.55, 1), (0.1, 2), (1.25, 2)]
each_place = pytest.mark.parametrize(
    ("at", "order"), quick(PLACES, [(-0.45, 0), (-0.9, 1), (1.25, 2)])
)


def single(at, order, height=0.8, kernel=None):
    """(jumps, density): the closed-form density that the engine subtracts for a single jump."""
    kernel = kernel or sie.cauchy()
    jumps = DensityJumps.inside(
        ZONES, np.array([at]), np.array([height]), np.array([order]), kernel
    )
    return jumps, sie.Density(ZONES, kernel, NO_COEFFICIENTS, jumps, np.zeros(0))


def density_of(density):
    return lambda t, zone: density.at_t(zone, np.asarray(t))


@each_place
def test_the_closed_density_is_the_sum_of_its_series(at, order):
    jumps, density = single(at, order)
    zone, count = int(jumps.zone[0]), 40000
    t = np.array([-0.95, -0.4, 0.13, 0.8])
    theta = np.arccos(t)
    summed = (
        np.cos(theta[:, None] * np.arange(count))
        @ jumps.t_coefficients(ZONES, count)[zone]
        / np.sin(theta)
    )
    assert density.at_t(zone, t) == pytest.approx(summed, abs=2e-3 / count**order)


@each_place
def test_the_density_jumps_in_the_derivative_of_its_order_and_vanishes_at_the_ends(at, order):
    _, density = single(at, order)
    h = 1e-3
    x = at + h * np.arange(1, 5)
    weights = {
        0: [4.0, -6.0, 4.0, -1.0],
        1: [-26 / 6, 9.5, -7.0, 11 / 6],
        2: [3.0, -8.0, 7.0, -2.0],
    }[order]
    above = np.dot(weights, density(x)) / h**order
    below = np.dot(weights, density(2 * at - x)) * (-1.0) ** order / h**order
    assert above - below == pytest.approx(0.8, rel=1e-3)
    assert density(ZONES.table.ravel()) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(PERIOD)], ids=["cauchy", "hilbert"])
@each_place
def test_the_transform_is_that_of_the_density_on_and_off_the_zone(at, order, kernel):
    _, density = single(at, order, kernel=kernel)
    plain = reference.cauchy if kernel.period is None else reference.hilbert(PERIOD)
    for x in (-2.0, -1.35, 0.42, 0.8, 1.7, 30.0, -1.0, -0.2, 0.35, 1.0, 1.4):
        expected = reference.transform(
            density_of(density), ZONES.table, x if kernel.period is None else inside(x), plain, [at]
        )
        assert density.transform(x) == pytest.approx(expected, abs=1e-10)


def inside(x):
    return x - PERIOD * np.round((x - 0.15) / PERIOD)


@each_place
def test_the_potential_is_that_of_the_density_on_and_off_the_zone(at, order):
    _, density = single(at, order)
    for x in (-2.0, -1.0, 0.3, 0.42, 1.0, 1.58, 30.0):
        expected = reference.potential(
            density_of(density), ZONES.table, x, reference.log_cauchy, [at]
        )
        assert density.potential(x) == pytest.approx(expected, abs=1e-10)


@each_place
def test_the_integral_along_the_zone_is_that_of_the_density(at, order):
    _, density = single(at, order)
    zone = int(density.jumps.zone[0])
    a, b = ZONES.table[zone]
    for x in np.linspace(a, b, 7)[1:]:
        pieces = [a, at, x] if at < x else [a, x]
        expected = sum(
            quad(density, lo, hi, epsabs=1e-12)[0]
            for lo, hi in zip(pieces[:-1], pieces[1:], strict=True)
        )
        theta = 2 * np.arctan2(np.sqrt(b - x), np.sqrt(x - a))
        assert density.integral_at(zone, theta) == pytest.approx(expected, abs=1e-10)


def equation(kernel, at, order, height):
    """(equation, forcing) for a density with jumps, whose totals are zero.

    The right side is x plus (height / pi) (x - at)^order ln|x - at| / order! for each jump. For
    order 0 this term follows from the declared jump, so `value` does not contain it.
    """
    q = np.array(order)
    factorial = np.array([1.0, 1.0, 2.0])[q]

    def value(x):
        with np.errstate(divide="ignore", invalid="ignore"):
            away = x[:, None] - at
            logs = away**q * np.log(np.abs(away)) / factorial
        # At x = at, this term has the limit zero.
        return x + np.where((q > 0) & (away != 0), logs, 0.0) @ height / np.pi

    forcing = sie.Forcing(
        value, jumps=sie.Jumps(np.array(at), np.array(height), q, of_density=True)
    )
    return sie.Equation(kernel, forcing, (sie.ZoneTotals(0.0),)), forcing


def test_right_sides_with_logarithms_need_few_modes_and_are_satisfied_everywhere():
    at, order, height = (
        [-1.25, -0.45, 1.1, 0.2, 1.55],
        [0, 0, 0, 1, 2],
        np.array([0.8, -0.3, 1.1, 0.7, -2.0]),
    )
    problem, forcing = equation(sie.cauchy(), at, order, height)
    state = sie.solve_fixed(problem, sie.Zones.of(ZONES.table, sie.SINGULAR, sie.SINGULAR))
    assert state.sizes.own.max() <= 48
    x = np.concatenate((np.linspace(-1.29, 0.39, 50), np.linspace(0.91, 1.59, 50)))
    logs = sum(
        h / np.pi * np.log(np.abs(x - s))
        for s, q, h in zip(at, order, height, strict=True)
        if q == 0
    )
    assert state.density.transform(x) == pytest.approx(forcing.value(x) + logs, abs=1e-11)
    assert state.density.totals == pytest.approx(0.0, abs=1e-14)
    left_of, right_of = (state.density(np.array(at) + side) for side in (-1e-9, 1e-9))
    kinks = np.array(order) == 0
    assert (right_of - left_of)[kinks] == pytest.approx(height[kinks], abs=1e-6)


@pytest.mark.parametrize("half_width", [1e-3, 1e-9])
def test_a_zone_far_from_the_origin_loses_no_digit_to_its_width(half_width):
    # With a power of two as half width, both ends are exact in binary and symmetric about 0.375.
    half_width = 2.0 ** np.round(np.log2(half_width))
    zone = sie.Zones.of([[0.375 - half_width, 0.375 + half_width]], sie.SINGULAR, sie.SINGULAR)
    forcing = sie.Forcing(
        np.zeros_like, jumps=sie.Jumps(np.array([0.375]), np.array([-1.0]), of_density=True)
    )
    problem = sie.Equation(sie.cauchy(), forcing, (sie.ZoneTotals(0.0),))
    state = sie.solve_fixed(problem, zone)
    t = np.array([-0.9, -0.2, 0.3, 0.8])
    # With the half width w, the right side is -(1/pi) ln(w |t|). The density -eta has the
    # transform -(1/pi) ln(2 |t|). The remaining constant -(1/pi) ln(w/2) is the transform of
    # -constant T_1 / sqrt(1 - t^2).
    eta = np.arccos(t) / np.pi - (t < 0)
    constant = -np.log(half_width / 2) / np.pi
    assert state.density.at_t(0, t) == pytest.approx(
        -eta - constant * t / np.sqrt(1 - t * t), abs=1e-13
    )


@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(PERIOD)], ids=["cauchy", "hilbert"])
@each_place
def test_the_potential_rises_by_the_integral_of_the_transform_from_end_to_end(at, order, kernel):
    _, density = single(at, order, kernel=kernel)
    lo, hi = ZONES.b[0], ZONES.a[1]
    t, weight = np.polynomial.legendre.leggauss(40)
    u = 0.5 * (1 + t)
    # At the ends the transform has a singularity in the root of the distance. With this
    # substitution the integrand is smooth.
    x = lo + (hi - lo) * u * u * (3 - 2 * u)
    risen = (hi - lo) * np.sum(weight * density.transform(x) * 3 * u * (1 - u))
    assert np.diff(density.potential(np.array([lo, hi])))[0] == pytest.approx(risen, abs=1e-14)


def test_conditions_on_potentials_are_refused_beside_jumps_of_the_density():
    forcing = sie.Forcing(np.zeros_like, jumps=sie.Jumps(np.zeros(1), np.ones(1), of_density=True))
    with pytest.raises(ValueError, match="potentials"):
        sie.Equation(sie.cauchy(), forcing, (sie.Total(1.0), sie.EqualPotential()))


OUTSIDE = [-1.31, 0.4, 0.4 + 1e-4, 0.89]


def beside(at, kernel=None, height=0.8):
    kernel = kernel or sie.cauchy()
    jumps = DensityJumps.inside(
        ZONES, np.array([at]), np.array([height]), np.zeros(1, dtype=int), kernel
    )
    return jumps, sie.Density(ZONES, kernel, NO_COEFFICIENTS, jumps, np.zeros(0))


@pytest.mark.parametrize("at", OUTSIDE)
def test_a_logarithm_just_outside_has_its_own_bounded_density(at):
    jumps, density = beside(at)
    count, t = 40000, np.array([-0.95, -0.4, 0.13, 0.8])
    theta = np.arccos(t)
    for zone in set(jumps.logarithms.near.zone.tolist()):
        a, b = ZONES.table[zone]
        rho = np.sqrt(abs(at - b) * abs(at - a)) / (0.5 * (b - a))
        s = (2 * at - a - b) / (b - a)
        rho = s - np.sign(s) * rho
        j = np.arange(1, count)
        expected = -0.8 * 2 / np.pi * np.sin(theta[:, None] * j) @ (rho**j / j)
        slow = 2e-4 if abs(rho) > 0.99 else 1e-12
        assert density.at_t(zone, t) == pytest.approx(expected, abs=slow)
        summed = (
            np.cos(theta[:, None] * np.arange(count))
            @ jumps.t_coefficients(ZONES, count)[zone]
            / np.sin(theta)
        )
        assert density.at_t(zone, t) == pytest.approx(summed, abs=slow)
        # If the logarithm lies exactly at an end, the density there has a limit that is not zero.
        limits = np.where(ZONES.table[zone] == at, -0.8, 0.0)
        assert density.at_t(zone, np.array([-1.0, 1.0])) == pytest.approx(limits, abs=1e-15)


@pytest.mark.parametrize(("at", "kernel"), diagonal(OUTSIDE, ["cauchy", "hilbert"]))
def test_fields_of_a_logarithm_outside_a_zone_are_those_of_its_density(at, kernel):
    kernel = sie.cauchy() if kernel == "cauchy" else sie.hilbert(PERIOD)
    _, density = beside(at, kernel)
    plain = reference.cauchy if kernel.period is None else reference.hilbert(PERIOD)
    log = reference.log_cauchy if kernel.period is None else reference.log_hilbert(PERIOD)
    for x in (-2.0, 0.42, 1.7, -1.0, 0.35, 1.4):
        moved = x if kernel.period is None else inside(x)
        assert density.transform(x) == pytest.approx(
            reference.transform(density_of(density), ZONES.table, moved, plain), abs=1e-9
        )
        assert density.potential(x) == pytest.approx(
            reference.potential(density_of(density), ZONES.table, moved, log), abs=1e-9
        )
    for a, b in ZONES.table:
        x = np.linspace(a, b, 6)[1:-1]
        expected = [quad(density, a, end, epsabs=1e-12, limit=200)[0] for end in x]
        assert density.integral(x) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("distance", [0.0, 1e-12, 1e-6, 1e-3, 0.1])
def test_a_logarithm_near_an_end_costs_no_modes(distance):
    height = np.array([0.8, -0.5])
    problem, forcing = equation(sie.cauchy(), [1.6 + distance, -1.3 - distance], [0, 0], height)
    state = sie.solve_fixed(problem, sie.Zones.of(ZONES.table, sie.SINGULAR, sie.SINGULAR))
    assert state.sizes.own.max() <= 24
    x = np.linspace(0.91, 1.59, 50)
    logs = height[0] / np.pi * np.log(np.abs(x - 1.6 - distance)) + height[1] / np.pi * np.log(
        np.abs(x + 1.3 + distance)
    )
    assert state.density.transform(x) == pytest.approx(forcing.value(x) + logs, abs=1e-11)
