"""Contacts of up to twelve zones with an exact solution by inverse design. Newton's method finds
their free ends from first guesses that are wrong by up to a fifth of a width.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sie
from contact.reference import inverse
from tests.tiers import diagonal

EPS = np.finfo(float).eps
T = np.linspace(-0.99, 0.99, 41)


@st.composite
def designs(draw, spread=3.0, most=12):
    """(problem, its equation, first guess) with 2 to `most` zones, isolated or with the period 1.

    Widths and gaps differ by factors of at most about `spread`.
    """
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    period = draw(st.sampled_from([None, 1.0]))
    # Without a period, the loads of many zones differ by factors of a million. If the ends of a
    # heavily loaded zone were wrong by a fifth of its width, the change of its load would exceed
    # the load of a light zone.
    count = draw(st.integers(2, most if period else min(most, 6)))
    problem = inverse.random_problem(rng, count, period, E_star=2.0, spread=spread)
    return problem, equation_of(problem), perturbed(problem, rng, draw(st.floats(0.0, 0.2)))


def equation_of(problem):
    """Equation of the problem; since E* = 2, its right side is the profile's slope f'."""
    kernel = sie.cauchy() if problem.period is None else sie.hilbert(problem.period)
    forcing = sie.Forcing(problem.profile.slope, problem.profile.height)
    return sie.Equation(kernel, forcing, (sie.Total(problem.load), sie.EqualPotential()))


def perturbed(problem, rng, share):
    """The ends, each moved by up to `share` of its zone's width, outward by at most 0.4 of the
    gap beside it.
    """
    ends, widths = problem.zones, problem.zone_widths
    between = ends[1:, 0] - ends[:-1, 1]
    border = np.inf if problem.period is None else ends[0, 0] + problem.period - ends[-1, 1]
    gaps = np.column_stack((np.append(border, between), np.append(between, border)))
    outward = np.minimum(share * rng.uniform(-1, 1, ends.shape) * widths[:, None], 0.4 * gaps)
    return ends + outward * [-1, 1]


def pressure_error(problem, density):
    """Largest error at equal positions t in the zones, divided by the largest pressure."""
    peak = max(problem.pressure_at(T, i).max() for i in range(len(problem.zones)))
    return (
        max(
            np.abs(density.at_t(i, T) - problem.pressure_at(T, i)).max()
            for i in range(len(problem.zones))
        )
        / peak
    )


@given(designs())
def test_all_ends_and_pressures_are_found_from_ends_wrong_by_a_fifth_of_a_width(case):
    problem, equation, start = case
    found = sie.find_ends(equation, sie.Zones.of(start), 1e-12)
    error = np.abs(found.density.zones.table - problem.zones) / problem.zone_widths[:, None]
    assert found.converged
    assert error.max() < 1e-9
    assert pressure_error(problem, found.density) < 1e-9
    # The ends of the design are rounded, too.
    assert np.all(error <= found.end_error + 4 * EPS)


@given(designs(), st.sampled_from([1e-3, 1e-5, 1e-7, 1e-9]))
def test_the_stated_error_of_every_end_holds_at_any_tolerance(case, tolerance):
    problem, equation, start = case
    found = sie.find_ends(equation, sie.Zones.of(start), tolerance)
    error = np.abs(found.density.zones.table - problem.zones) / problem.zone_widths[:, None]
    assert found.converged
    assert np.all(error <= found.end_error + found.state.end_truncation + 4 * EPS)


@given(designs(spread=10.0, most=8))
def test_widths_and_gaps_may_differ_by_a_factor_of_ten(case):
    problem, equation, _ = case
    start = perturbed(problem, np.random.default_rng(1), 0.05)
    found = sie.find_ends(equation, sie.Zones.of(start), 1e-12)
    error = np.abs(found.density.zones.table - problem.zones) / problem.zone_widths[:, None]
    assert found.converged
    assert error.max() < 1e-8
    assert pressure_error(problem, found.density) < 1e-9


@given(designs())
def test_on_the_exact_zones_the_pressure_and_the_loads_are_those_of_the_design(case):
    problem, equation, _ = case
    density = sie.solve_fixed(equation, sie.Zones.of(problem.zones)).density
    assert pressure_error(problem, density) < 1e-11
    assert density.total == pytest.approx(problem.load, rel=1e-13)
    assert density.totals == pytest.approx(problem.zone_loads, rel=1e-9, abs=1e-11 * problem.load)


@given(designs(most=6))
def test_between_the_zones_the_slope_of_the_gap_is_that_of_the_design(case):
    problem, equation, _ = case
    density = sie.solve_fixed(equation, sie.Zones.of(problem.zones)).density
    begin, end = problem.zones[:-1, 1], problem.zones[1:, 0]
    x = (begin + np.array([[0.1], [0.5], [0.8]]) * (end - begin)).ravel()
    largest = np.abs(problem.profile.slope(x)).max()
    assert density.transform(x) == pytest.approx(
        problem.profile.slope(x) - problem.gap_slope(x), abs=1e-10 * largest
    )


@given(designs(most=6))
def test_a_load_wrong_by_a_millionth_is_detected(case):
    problem, equation, start = case
    wrong = inverse.design(problem.zones, 2.0, problem.load * (1 + 1e-6), problem.period)
    found = sie.find_ends(equation, sie.Zones.of(start), 1e-12)
    assert pressure_error(wrong, found.density) > 1e-8


@pytest.mark.parametrize(("gap", "period"), diagonal([1e-1, 1e-2, 1e-3], [None, 1.0]))
def test_nearly_touching_zones_are_found_from_ends_wrong_by_a_tenth_of_a_width(gap, period):
    problem = inverse.design([[-0.2, -0.1 * gap], [0.1 * gap, 0.2]], 2.0, 0.05, period)
    for seed in range(4):
        start = perturbed(problem, np.random.default_rng(seed), 0.1)
        found = sie.find_ends(equation_of(problem), sie.Zones.of(start), 1e-12)
        error = np.abs(found.density.zones.table - problem.zones) / problem.zone_widths[:, None]
        assert found.converged
        # Round-off changes an end beside the gap by about EPS / (gap / width)^2.
        assert error.max() < 100 * EPS / gap**2
        assert pressure_error(problem, found.density) < 100 * EPS / gap**2


def test_a_gap_ten_times_too_narrow_and_out_of_place_opens_again():
    problem = inverse.design([[-0.2, -0.05], [0.05, 0.2]], 2.0, 0.05, 1.0)
    for middle in (-0.03, 0.0, 0.03):
        start = [[-0.21, middle - 0.005], [middle + 0.005, 0.2]]
        found = sie.find_ends(equation_of(problem), sie.Zones.of(start), 1e-12)
        assert found.converged
        assert found.density.zones.table == pytest.approx(problem.zones, abs=1e-12)


# Convergence with the number of modes
# --------------------------------------------------------------------------------
@pytest.mark.parametrize("gap", [0.4, 0.1, 0.03])
def test_the_error_falls_with_the_coupled_modes_as_the_distance_of_the_zones_predicts(gap):
    ends = np.array([[-1.0, -0.5 * gap], [0.5 * gap, 1.0]])
    forcing = sie.Forcing(lambda x: np.ones_like(x), lambda x: x)
    equation = sie.Equation(sie.cauchy(), forcing, (sie.Total(1.0), sie.EqualPotential()))
    zones = sie.Zones.of(ends, sie.SINGULAR, sie.SINGULAR)
    best = sie.solve_fixed(equation, zones, 1e-15).density
    modes, errors = [], []
    for tolerance in 10.0 ** -np.arange(1, 12):
        state = sie.solve_fixed(equation, zones, tolerance)
        modes.append(int(state.system.layout.m.max()))
        errors.append(np.abs(state.density.at_t(1, T) - best.at_t(1, T)).max())
    modes, places = np.unique(modes, return_index=True)
    errors = np.array(errors)[places]
    clear = (errors > 1e-13) & (modes >= 4)
    rate = -np.polyfit(modes[clear], np.log(errors[clear]), 1)[0]
    z = 1 + gap / (0.5 * (1 - 0.5 * gap))
    predicted = np.log(z + np.sqrt(z * z - 1))
    # The field of the other zone is singular at that zone's near end z. So the coefficients decay
    # as exp(-predicted m), times a power of m.
    assert rate == pytest.approx(predicted, rel=0.07)


def test_own_coefficients_fall_as_the_nearest_pole_of_the_right_side_predicts():
    pole = 0.3
    forcing = sie.Forcing(lambda x: x / (x * x + pole**2))
    zones = sie.Zones.of([[-1, 1]], sie.SINGULAR, sie.SINGULAR)
    density = sie.solve_fixed(sie.Equation(sie.cauchy(), forcing, (sie.Total(1.0),)), zones).density
    c = np.abs(density.coefficients[0, 2:60:2])
    rate = -np.polyfit(np.arange(2, 60, 2), np.log(c), 1)[0]
    assert rate == pytest.approx(np.arcsinh(pole), rel=1e-3)
