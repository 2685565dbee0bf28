"""Designed contacts are checked against laws that the design does not compute.
The laws are the singular integral equation, the load, and the signs of pressure and gap.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact.errors import SceneError
from contact.model.profiles.base import Profile
from contact.reference import exact, inverse
from tests.contact import reference
from tests.contact.strategies import designed_contacts

# The quadrature sums about 1000 terms, up to 100 times as large as the result: 1e5 eps.
TOL = 2e-11


def nodes_for(problem):
    """Number of quadrature nodes at which only round-off is left.
    Gauss-Chebyshev quadrature converges like exp(-2 n sqrt(2 gap/half width)) with n nodes;
    20/sqrt(nearness) nodes suffice.
    """
    return 200 + int(40 / np.sqrt(min(problem.nearness, 1.0)))


@given(designed_contacts())
def test_the_pressure_solves_the_singular_integral_equation_on_every_zone(problem):
    assert reference.equation_error(problem, nodes=nodes_for(problem)) < TOL


@given(designed_contacts())
def test_pressures_are_positive_gaps_open_and_zone_loads_add_up(problem):
    t = np.concatenate([[1e-15 - 1.0], np.linspace(-0.999, 0.999, 101)])
    for zone in range(len(problem.zones)):
        assert np.all(problem.pressure_at(t, zone) > 0.0)
    ends = problem.zones.ravel()
    right = np.append(
        problem.zones[1:, 0],
        ends[0] + problem.period if problem.period else ends[-1] + np.ptp(ends),
    )
    for left, end in zip(problem.zones[:, 1], right, strict=True):
        assert np.all(problem.gap(left + (end - left) * np.array([1e-6, 0.1, 0.5, 0.9])) > 0.0)
    assert reference.load_of(problem, nodes_for(problem)) == pytest.approx(problem.load, rel=1e-12)
    assert np.sum(problem.zone_loads) == pytest.approx(problem.load, rel=1e-14)


@given(designed_contacts(periodic=True))
def test_the_displacement_is_the_logarithmic_potential_of_the_pressure(problem):
    """The pressure alone determines the approach, the gaps between all zones and the heights."""
    ends = np.append(problem.zones.ravel(), problem.zones[0, 0] + problem.period)
    x = np.concatenate(
        [
            b + (a - b) * np.array([0.1, 0.5, 0.9])
            for b, a in zip(ends[1::2], ends[2::2], strict=True)
        ]
    )
    u = reference.displacement_of(problem, x, 4 * nodes_for(problem))
    scale = np.max(np.abs(u)) + np.max(np.abs(problem.height(x)))
    np.testing.assert_allclose(problem.displacement(x), u, rtol=0.0, atol=1e-10 * scale)


@given(designed_contacts())
def test_the_gap_closes_at_both_sides_of_every_gap(problem):
    """The slope of the gap, integrated from either end, gives the same gap at its widest point."""
    ends = problem.zones.ravel()
    for k, g in enumerate(problem._product.gaps):
        widest = ends[g] + problem._product.roots[k, 0]
        step = 1e-9 * problem._product.steps[g]
        before, after = problem.gap(np.array([widest - step, widest + step]))
        assert before == pytest.approx(after, rel=1e-9)


@given(designed_contacts(), st.floats(-2.0, 2.0))
def test_slopes_are_derivatives_of_heights(problem, where):
    length = problem.period or np.ptp(problem.zones)
    step = 1e-3 * length / len(problem.zones)
    x = problem.zones[0, 0] + np.array([0.1, 0.45, 0.8]) * length
    if problem.period:
        x = x + where * length
    f = [problem.height(x + k * step) for k in (-3, -2, -1, 1, 2, 3)]
    difference = (-f[0] + 9 * f[1] - 45 * f[2] + 45 * f[3] - 9 * f[4] + f[5]) / (60 * step)
    sample = problem.zones[0, 0] + np.linspace(0.0, length, 400)
    # The truncation error (2 pi/1000)^6/140 of the difference is below round-off of f/(60 step).
    scale = np.max(np.abs(problem.slope(sample)))
    np.testing.assert_allclose(difference, problem.slope(x), rtol=0.0, atol=1e-8 * scale)


def test_one_periodic_zone_is_westergaard():
    true = exact.Westergaard(1e-6, 1e-4, 1.1e11, 3e-5)
    problem = inverse.design(true.zones, 1.1e11, true.load, 1e-4)
    t = np.linspace(-1.0, 1.0, 21)
    np.testing.assert_allclose(problem.pressure_at(t), true.pressure_at(t), rtol=1e-13)
    x = np.linspace(-6e-5, 6e-5, 25)
    np.testing.assert_allclose(problem.gap(x), true.gap(x), rtol=1e-11, atol=1e-24)
    np.testing.assert_allclose(
        problem.height(x) - problem.height(0.0), true.height(x), rtol=0.0, atol=1e-20
    )
    assert problem.approach == pytest.approx(true.approach, rel=1e-12)
    assert problem.max_pressure == pytest.approx(true.max_pressure, rel=1e-13)


def test_one_zone_alone_is_hertz_and_two_are_the_biquadratic():
    hertz = exact.HertzLine(2e-3, 1.1e11, 3e-5)
    one = inverse.design(hertz.zones, 1.1e11, hertz.load)
    np.testing.assert_allclose(
        one.profile.coefficients, [0.0, 0.0, 1.0 / (2 * 2e-3)], rtol=1e-13, atol=1e-18
    )
    double = exact.IsolatedBiquadratic(2e-3, 5e-5, 1.1e11, 100.0)
    two = inverse.design(double.zones, 1.1e11, double.load)
    x = np.linspace(-5e-5, 5e-5, 41)
    np.testing.assert_allclose(two.pressure(x), double.pressure(x), rtol=1e-8, atol=1e-6)
    np.testing.assert_allclose(two.gap(x), double.gap(x), rtol=1e-9, atol=1e-24)
    np.testing.assert_allclose(
        two.slope(x), double.slope(x), rtol=0.0, atol=1e-14 * double.slope(x[-1])
    )


def test_a_periodic_design_of_n_zones_has_n_harmonics_and_its_conjugate_slope():
    problem = inverse.random_problem(np.random.default_rng(5), 7, 2.0)
    assert len(problem.profile.cosine) == len(problem.profile.sine) == 7
    x = 0.37
    s = 2.0 / 4000 * (np.arange(4000) + 0.5)
    # The trapezoidal rule with nodes staggered about x is exact for the principal value of a
    # trigonometric polynomial.
    conjugate = np.mean(problem.slope(x - s) / np.tan(np.pi * s / 2.0))
    assert problem.profile.slope_conjugate(x) == pytest.approx(conjugate, rel=1e-11)


def test_a_narrow_gap_and_a_narrow_zone_keep_their_digits():
    zones = np.array([[-0.4, -1e-7], [1e-7, 0.2], [0.2 + 1e-5, 0.2 + 2e-5], [0.4, 0.4 + 1e-6]])
    for period in (None, 1.0):
        problem = inverse.design(zones, 2.0, 0.1, period)
        assert reference.equation_error(problem, nodes=60000) < 1e-10
        x = 1e-7 * np.array([-0.9, -0.5, 0.0, 0.5, 0.9])
        # In a gap |x| < w far narrower than its surroundings, the slope X M is proportional to
        # x sqrt(w^2 - x^2), and the gap to (w^2 - x^2)^(3/2).
        shape = problem.gap(x) / problem.gap(0.0)
        np.testing.assert_allclose(shape, (1.0 - (x / 1e-7) ** 2) ** 1.5, rtol=1e-5)


def test_the_random_problem_is_reproducible_and_inside_its_cell():
    for seed in range(20):
        problem = inverse.random_problem(np.random.default_rng(seed), period=1e-4, E_star=1e11)
        again = inverse.random_problem(np.random.default_rng(seed), period=1e-4, E_star=1e11)
        np.testing.assert_array_equal(problem.zones, again.zones)
        assert 1 <= len(problem.zones) <= 12
        assert np.all(problem.zones[:, 0] >= -0.5e-4) and np.all(problem.zones[:, 0] < 0.5e-4)
        assert isinstance(problem.profile, Profile) and not problem.profile.slope_is_derived


@pytest.mark.parametrize(
    "zones",
    [
        [],
        [0.0, 1.0],
        [[0.0, 0.1, 0.2]],
        [[0.1, 0.0]],
        [[0.0, 0.1], [0.1, 0.2]],
        [[0.0, 0.3], [0.2, 0.4]],
        [[0.0, np.nan]],
        [[0.0, 0.5], [0.6, 1.0]],
    ],
)
def test_zones_that_are_not_ascending_or_longer_than_the_period_are_refused(zones):
    with pytest.raises(SceneError, match="zones"):
        inverse.design(zones, 1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Displaced:
    """The pressure of a design with a wrong last end, and the profile of the true design.
    The end is wrong by 1e-7 of the width of its zone.
    """

    true: inverse.DesignedContact
    wrong: inverse.DesignedContact
    zones = property(lambda self: self.wrong.zones)
    period = property(lambda self: self.true.period)
    E_star = property(lambda self: self.true.E_star)

    def slope(self, x):
        return self.true.slope(x)

    def pressure_at(self, t, zone=0):
        return self.wrong.pressure_at(t, zone)


@pytest.mark.parametrize("period", (None, 1.0))
def test_an_end_wrong_by_1e_7_fails_the_same_law(period):
    true = inverse.random_problem(np.random.default_rng(3), 4, period)
    ends = true.zones.copy()
    ends[-1, 1] += 1e-7 * true.zone_widths[-1]
    wrong = inverse.design(ends, true.E_star, true.load, period)
    assert reference.equation_error(true, nodes=nodes_for(true)) < TOL
    assert reference.equation_error(Displaced(true, wrong), nodes=nodes_for(true)) > 100.0 * TOL
