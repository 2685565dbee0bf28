"""Ends at which the density has a given value, and the plateaus beyond them.

The closed forms are those of a pressure limit H on a half-plane (E* = 2 throughout): the unknown is
the pressure, and it is H on the plateaus.
"""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

import sie
from sie.ends.steps import damped
from sie.jumps.logarithms import Logarithms

FREE = sie.FREE


def cylinder(a=1.0, c=0.6):
    """(H, load) of a cylinder, T p = x, with a plateau on |x| < c and contact on |x| < a."""
    m = (c / a) ** 2
    limit = np.pi * a / (2 * ellipk(m))
    return limit, limit / a * (2 * a * a * ellipe(m) - (a * a - c * c) * ellipk(m))


def wave(outer=0.9, inner=0.5):
    """The limit H for T p = sin 2u with the period pi, a plateau on |u| < inner and contact on
    |u| < outer.
    """
    k = np.tan(inner) / np.tan(outer)
    return np.pi * np.sin(outer) * np.cos(inner) / ellipk(k * k)


WAVE = sie.Forcing(lambda x: np.sin(2 * x), lambda x: -0.5 * np.cos(2 * x))
PARABOLA = sie.Forcing(lambda x: x, lambda x: 0.5 * x * x)
# Mean pressure of `wave` with A = outer and C = inner: sin^2 A + sin^2 C - (2 H / pi) J, where
# the integral J was computed with 30 digits.
MEAN_OF_WAVE = 0.59267767061


def test_a_punch_between_plateaus_that_end_at_its_corners():
    ends = sie.free_with_value(1.0, until=-2.0), sie.free_with_value(1.0, until=2.0)
    equation = sie.Equation(sie.cauchy(), np.zeros_like, sie.Total(2 * np.sqrt(3)))
    found = sie.solve(equation, sie.Zones.of([[-0.5, 1.5]], *ends), tol=1e-11)
    x = np.linspace(-0.99, 0.99, 9)
    exact = 2 / np.pi * np.arctan(np.sqrt(3) / np.sqrt(1 - x * x))
    assert np.abs(found.zones.table - [[-1, 1]]).max() < found.error < 1e-11
    assert np.abs(found.density(x) - exact).max() < 1e-12
    assert found.density([-2.5, -1.5, 1.5, 2.5]).tolist() == [0, 1, 1, 0]
    assert np.allclose(found.density.plateaus, [[-2, -1], [1, 2]], atol=1e-11)


@pytest.mark.parametrize("symmetric", [False, True])
def test_a_cylinder_with_a_plateau_in_the_middle(symmetric):
    limit, load = cylinder()
    end = sie.free_with_value(limit)
    conditions = (sie.Total(load),) if symmetric else (sie.Total(load), sie.EqualPotential())
    guess = [[-0.95, -0.5], [0.5, 0.95]] if symmetric else [[-0.9, -0.5], [0.45, 1.2]]
    zones = sie.Zones.of(guess, [FREE, end], [end, FREE], symmetric)
    found = sie.solve(sie.Equation(sie.cauchy(), PARABOLA, conditions), zones, tol=1e-11)
    assert np.abs(found.zones.table - [[-1, -0.6], [0.6, 1]]).max() < found.error
    assert abs(found.density(0.8) - 0.6138418256) < 1e-10
    assert abs(found.density.total - load) < 1e-13
    level = found.density.potential([-1, -0.7, 0.6, 0.7, 1]) - PARABOLA.primitive(
        np.array([-1, -0.7, 0.6, 0.7, 1])
    )
    assert np.ptp(level) < 1e-12


@pytest.mark.parametrize("turn", [False, True], ids=["in the cell", "across its border"])
def test_a_wave_with_a_plateau_at_its_crest(turn):
    limit = wave()
    end = sie.free_with_value(limit)
    guess, left, right = [[-0.8, -0.55], [0.4, 1.0]], [FREE, end], [end, FREE]
    if turn:
        guess = [[0.4, 1.0], [np.pi - 0.8, np.pi - 0.55]]
        left, right = right, left
    conditions = sie.Total(MEAN_OF_WAVE * np.pi), sie.EqualPotential()
    equation = sie.Equation(sie.hilbert(np.pi), WAVE, conditions)
    found = sie.solve(equation, sie.Zones.of(guess, left, right), tol=1e-11)
    exact = [[0.5, 0.9], [np.pi - 0.9, np.pi - 0.5]] if turn else [[-0.9, -0.5], [0.5, 0.9]]
    assert np.abs(found.zones.table - exact).max() < 1e-10
    density, x = found.density, np.array([0.2, 0.7, 2.0])
    above = density.transform(x + 1e-12j)
    assert np.abs(above - density.transform(x) + 1j * density(x)).max() < 1e-10
    assert abs(density.transform(0.3 + 30j) + 1j * MEAN_OF_WAVE) < 1e-9
    z, h = 0.3 + 0.4j, 1e-5
    slope = (density.transform(z + h) - density.transform(z - h)) / (2 * h)
    assert abs(density.transform_slope(z) - slope) < 1e-9


@pytest.mark.parametrize(
    ("kappa", "moves"), [(0.0, True), (0.2, True), (-0.4, True), (1.0, True), (-0.4, False)]
)
def test_the_equation_holds_by_quadrature(kappa, moves):
    """Half a parabola with a corner at -1.5. A plateau reaches from the corner to the left end
    of the zone, where the density has the plateau's value. The right end is free.
    """
    value, corner = 0.9, -1.5
    left = (sie.free_with_value if moves else sie.bounded_with_value)(value, until=corner)
    given = (sie.Total(1.2),) if moves else ()
    equation = sie.Equation(sie.cauchy(), lambda x: 0.5 * (x + 1.5), given, kappa=kappa)
    found = sie.solve(equation, sie.Zones.of([[-0.6, 0.7]], left, FREE))
    (a, b), density = found.zones.table[0], found.density
    assert np.allclose(density.at_t(0, [-1, 1]), [value, 0.0], atol=1e-12)
    # The substitution x = a + (b - a) sin(angle)^2 makes square roots at both ends smooth, and
    # other powers smoother. So Gauss's rule converges faster.
    t, weights = np.polynomial.legendre.leggauss(240)
    angle = 0.25 * np.pi * (1 + t)
    s, rule = a + (b - a) * np.sin(angle) ** 2, 0.25 * np.pi * weights
    rule = rule * (b - a) * np.sin(2 * angle)
    phi = density(s)
    for x in a + (b - a) * np.array([0.1, 0.5, 0.9]):
        whole = rule @ ((phi - density(x)) / (x - s)) + density(x) * np.log((x - a) / (b - x))
        whole += value * np.log((x - corner) / (x - a))
        assert abs(kappa * density(x) + whole / np.pi - 0.5 * (x + 1.5)) < 1e-5
        assert abs(found.residual(x)) < 1e-12
    z = 0.2 + 0.3j
    of_plateau = value * np.log((z - corner) / (z - a))
    assert abs(density.transform(z) - (rule @ (phi / (z - s)) + of_plateau) / np.pi) < 1e-6
    assert abs(density.total - rule @ phi - value * (a - corner)) < 1e-6
    of_plateau = 0.5 * value * (a * a - corner * corner)
    assert abs(density.moment() - rule @ (s * phi) - of_plateau) < 1e-6


def test_a_small_kappa_changes_the_solution_little():
    def found(kappa):
        left = sie.free_with_value(0.9, until=-1.5)
        equation = sie.Equation(
            sie.cauchy(), lambda x: 0.5 * (x + 1.5), sie.Total(1.2), kappa=kappa
        )
        return sie.solve(equation, sie.Zones.of([[-0.6, 0.7]], left, FREE), tol=1e-10)

    none, small = found(0.0), found(1e-9)
    assert np.abs(none.zones.table - small.zones.table).max() < 1e-8
    assert (
        np.abs(none.density.at_t(0, [-0.5, 0.5]) - small.density.at_t(0, [-0.5, 0.5])).max() < 1e-8
    )


def test_derivatives_by_the_load_are_those_of_the_closed_form():
    limit, load = cylinder()
    end = sie.free_with_value(limit)
    zones = sie.Zones.of([[-0.95, -0.5], [0.5, 0.95]], [FREE, end], [end, FREE])
    equation = sie.Equation(sie.cauchy(), PARABOLA, (sie.Total(load), sie.EqualPotential()))
    by_load = sie.solve(equation, zones, tol=1e-11).derivative(values=[1.0, 0.0])

    # For another half width a and the same H, c follows because K(m) is proportional to a.
    def at(a):
        c = a * np.sqrt(brentq(lambda m: np.pi * a / (2 * ellipk(m)) - limit, 1e-9, 1 - 1e-9))
        return c, cylinder(a, c)[1]

    h = 1e-4
    (c_more, more), (c_less, less) = at(1 + h), at(1 - h)
    exact = np.array([[c_more - c_less], [2 * h]]).T / (more - less)
    assert np.abs(by_load.ends[1] - exact).max() < 1e-6


def test_many_plateaus_by_fast_sums_are_those_of_a_matrix():
    count, period = 40, 2 * np.pi
    end = sie.free_with_value(1.2)
    start = period * np.arange(count)[:, None]
    table = (start[..., None] + np.array([[-1.6, -0.6], [0.6, 1.6]])).reshape(-1, 2)
    table += 0.05 * np.random.default_rng(0).uniform(-1, 1, table.shape)
    zones = sie.Zones.of(table, [FREE, end] * count, [end, FREE] * count)
    length = count * period
    sine = sie.Forcing(np.sin, lambda x: -np.cos(x))
    equation = sie.Equation(
        sie.hilbert(length), sine, (sie.Total(0.55 * length), sie.EqualPotential())
    )
    fast = sie.solve_fixed(equation, zones)
    matrix = sie.solve_fixed(equation, zones, direct=True)
    assert fast.iterated and not matrix.iterated
    x = zones.middle[:40]
    assert np.abs(fast.density(x) - matrix.density(x)).max() < 1e-11
    assert abs(fast.density.total - 0.55 * length) < 1e-10


@pytest.mark.parametrize(
    ("left", "right", "message"),
    [
        (FREE, sie.free_with_value(1.0), "has only one end"),
        (sie.free_with_value(1.0, until=2.0), FREE, "wrong side"),
    ],
)
def test_plateaus_that_do_not_end_are_refused(left, right, message):
    equation = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(1.0))
    with pytest.raises(ValueError, match=message):
        sie.solve(equation, sie.Zones.of([[-1.0, 1.0]], left, right))


def test_plateaus_with_two_values_are_refused():
    ends = [FREE, sie.free_with_value(1.0)], [sie.free_with_value(2.0), FREE]
    equation = sie.Equation(sie.cauchy(), PARABOLA, (sie.Total(1.0), sie.EqualPotential()))
    with pytest.raises(ValueError, match="same value"):
        sie.solve(equation, sie.Zones.of([[-1.0, -0.5], [0.5, 1.0]], *ends))


def test_a_plateau_at_the_crest_of_full_contact():
    """The limit minus the pressure is the pressure of Westergaard's contact, with its zone at
    the trough of the pressure.
    """
    limit, mean = 1.5, 1.0
    end = sie.free_with_value(limit)
    equation = sie.Equation(sie.hilbert(np.pi), WAVE, sie.Total(mean * np.pi))
    found = sie.solve(equation, sie.Zones.of([[0.7, 2.5]], end, end), tol=1e-11)
    half = np.arcsin(np.sqrt(limit - mean))
    assert np.abs(found.zones.table - np.pi / 2 - [[-half, half]]).max() < 1e-11
    away = np.array([-0.6, 0.0, 0.4])
    exact = limit - 2 * np.cos(away) * np.sqrt(np.sin(half) ** 2 - np.sin(away) ** 2)
    assert np.abs(found.density(np.pi / 2 + away) - exact).max() < 1e-11


@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(1.0)], ids=["alone", "period"])
def test_the_field_of_many_plateaus_by_a_tree_is_the_sum_over_their_ends(kernel, monkeypatch):
    rng, value, count = np.random.default_rng(3), sie.free_with_value(1.7), 120
    # Each row of `ends` is a zone, a plateau and a zone. In every third row the left zone is
    # very narrow.
    ends = np.sort(rng.uniform(0.05, 0.9, 4 * count)).reshape(-1, 4)
    ends[::3, 1] = ends[::3, 0] + 1e-7 * (ends[::3, 1] - ends[::3, 0])
    zones = sie.Zones.of(ends.reshape(-1, 2), [FREE, value] * count, [value, FREE] * count)
    fast = Logarithms.of_plateaus(zones, kernel)
    slow = Logarithms.of_plateaus(zones, kernel)
    monkeypatch.setattr(slow, "_are_many", lambda points: False)
    zone = np.repeat(np.arange(len(zones)), 40)
    left = np.tile(1 + np.cos(np.pi * (np.arange(40) + 0.5) / 40), len(zones))
    x = rng.uniform(-0.3, 1.3, 5000)
    lag = (x[:, None] - fast.at + 0.5) % 1.0 - 0.5 if kernel.period else x[:, None] - fast.at
    rounding = 1e-15 / np.abs(lag).min(axis=1)  # of the logarithm of a rounded lag
    for of, allowed in (
        (lambda terms: terms.on_zones(zone, left), 0.0),
        (lambda terms: terms.at_points(x), rounding),
        (lambda terms: terms.primitive_at(x), 0.0),
    ):
        assert np.all(np.abs(of(fast) - of(slow)) < 1e-12 + allowed)
    assert {"_sums_on_zones", "_sums_on_line"} <= set(vars(fast))
    assert "_sums_on_line" not in vars(slow)


def test_a_newton_step_widens_a_narrow_plateau_by_at_most_its_own_width():
    value = sie.free_with_value(1.0)
    zones = sie.Zones.of([[-1.0, -0.001], [0.001, 1.0]], [FREE, value], [value, FREE])
    equation = sie.Equation(sie.cauchy(), PARABOLA, (sie.Total(1.0), sie.EqualPotential()))
    asked = np.array([[0.0, -0.4], [-0.4, 0.0]])
    after = zones.moved(damped(zones, equation, asked, sie.NewtonOptions()))
    assert after.a[1] - after.b[0] == pytest.approx(0.004)
