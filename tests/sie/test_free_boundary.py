"""Free ends: Newton's method finds those of the closed forms and converges quadratically, for
many first guesses, scales and controls.
"""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import sie
from sie.ends.progress import Progress
from sie.ends.steps import bordered
from tests.sie import exact

T = np.cos(np.pi * np.arange(1, 39) / 39)


def forcing_of(form):
    at = np.array(getattr(form, "jumps_at", ()))
    return sie.Forcing(
        form.value, form.primitive, sie.Jumps(at, np.array(getattr(form, "jumps", ())))
    )


def kernel_of(form):
    return sie.cauchy() if form.period is None else sie.hilbert(form.period)


def search(form, start, tolerance=1e-13, end=sie.FREE, symmetric=False, conditions=None, **options):
    if conditions is None:
        conditions = (sie.Total(form.total), sie.EqualPotential())
    equation = sie.Equation(kernel_of(form), forcing_of(form), conditions, **options)
    return sie.find_ends(equation, sie.Zones.of(start, end, end, symmetric=symmetric), tolerance)


def end_errors(found, form):
    table = found.density.zones.table
    return np.abs(table - form.zones) / (form.zones[:, 1:] - form.zones[:, :1])


def assert_found(found, form, tolerance=1e-13):
    assert found.converged
    error = end_errors(found, form)
    assert error.max() < tolerance
    assert np.all(error <= found.end_error + 4e-16)  # ends of the closed forms are rounded
    for i in range(len(form.zones)):
        exact_values = form.at(T, i)
        assert (
            np.abs(found.density.at_t(i, T) - exact_values).max()
            < 10 * tolerance * np.abs(exact_values).max()
        )


# Closed forms
# ------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("start", [(-0.6, 0.9), (-0.1, 0.1), (-3.0, 2.0), (0.2, 0.9), (-1.0, 1.0)])
def test_hertz_is_found_from_anywhere_near_or_far(start):
    assert_found(search(exact.Hertz(1.0), [start]), exact.Hertz(1.0))


@pytest.mark.parametrize("start", [(-0.4, 0.5), (-0.71, 0.69), (-0.05, 0.9), (-2.0, 2.0)])
def test_the_wedge_is_found_with_its_kink_inside(start):
    assert_found(search(exact.Wedge(0.7, 1.5), [start]), exact.Wedge(0.7, 1.5))


@pytest.mark.parametrize("share", [0.001, 0.01, 0.1, 0.25, 0.4, 0.45, 0.49, 0.499])
@pytest.mark.parametrize("symmetric", [False, True])
def test_westergaard_is_found_from_first_touch_to_almost_full_contact(share, symmetric):
    form = exact.Westergaard(share, 1.0)
    start = min(0.7 * share, 0.43)
    # Near full contact the load determines the square of the gap's half width, 1/2 - a/L. So the
    # error of the ends is round-off divided by this half width.
    tolerance = max(1e-13, 4e-15 / (0.5 - share), 4e-16 / share)
    found = search(form, [[-start, start]], symmetric=symmetric)
    assert_found(found, form, tolerance)


@pytest.mark.parametrize(
    "starts", [slice(6), pytest.param(slice(6, None), marks=pytest.mark.slow)], ids=["few", "more"]
)
@pytest.mark.parametrize("share", [0.495, 0.499, 0.4995])
def test_the_stated_error_of_ends_near_full_contact_holds_for_any_first_guess(share, starts):
    form, chance = exact.Westergaard(share, 1.0), np.random.default_rng(5)
    for left, right in chance.uniform(0.6, 1.0, (25, 2))[starts]:
        found = search(form, [[-0.44 * left, 0.44 * right]])
        assert found.converged
        assert np.all(end_errors(found, form) <= found.end_error + 4e-16)


@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("start", [[(-0.9, -0.2), (0.2, 0.9)], [(-0.75, -0.35), (0.35, 0.75)]])
def test_two_zones_are_found(symmetric, start):
    assert_found(
        search(exact.TwoZones(0.3, 0.8, 2.0), start, symmetric=symmetric),
        exact.TwoZones(0.3, 0.8, 2.0),
    )


def test_a_sharp_end_stays_while_the_free_one_is_found():
    form = exact.Tilted(-0.3, 0.9, 2.0)
    zones = sie.Zones.of([[0.1, 0.9]], sie.FREE, sie.SINGULAR)
    found = sie.find_ends(
        sie.Equation(sie.cauchy(), forcing_of(form), (sie.Total(form.total),)), zones, 1e-13
    )
    assert_found(found, form)
    assert found.density.zones.b[0] == 0.9


def test_ends_wrong_by_a_millionth_are_detected():
    found = search(exact.Hertz(1.0, 1 + 1e-6), [(-0.6, 0.9)])
    with pytest.raises(AssertionError):
        assert_found(found, exact.Hertz(1.0 + 1e-6))


# Controls
# ------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "form", [exact.Westergaard(0.25, 1.0), exact.Hertz(0.7, 3.0), exact.TwoZones(0.3, 0.8, 2.0)]
)
def test_a_total_width_instead_of_the_total_finds_the_total(form):
    width = float(np.sum(form.zones[:, 1] - form.zones[:, 0]))
    start = form.zones + 0.1 * np.array([-0.3, 0.5])
    conditions = (sie.Total(None), sie.EqualPotential())
    found = search(form, start, conditions=conditions, end_conditions=(sie.TotalWidth(width),))
    assert_found(found, form, 2e-13)
    assert found.value == pytest.approx(form.total, rel=1e-12)
    assert found.density.total == pytest.approx(form.total, rel=1e-12)


def test_a_level_instead_of_the_total_finds_the_same_ends():
    form = exact.Hertz(0.7, 3.0)
    level = float(search(form, [(-0.6, 0.9)]).density.potential(0.0))
    assert_found(search(form, [(-0.6, 0.9)], conditions=(sie.Level(level),)), form)


# Prescribed intensities
# ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("start", [(-0.8, 0.8), (-1.5, 1.5), (-1.3, 0.7), (-1.02, 1.02)])
@pytest.mark.parametrize("intensity", [-0.2, -0.01, 0.1])
def test_ends_of_prescribed_intensity_are_found(start, intensity):
    form = exact.PrescribedIntensity(1.0, intensity)
    found = search(form, [start], 1e-12, sie.free_with_intensity(intensity))
    assert found.converged
    assert end_errors(found, form).max() < 1e-12
    assert np.array(found.density.intensities) == pytest.approx(
        np.full((2, 1), intensity), rel=1e-11
    )
    assert found.density.at_t(0, T) == pytest.approx(form.at(T), rel=1e-10, abs=1e-11)


def test_prescribed_intensity_in_half_a_symmetric_problem():
    form = exact.PrescribedIntensity(1.0, -0.2)
    found = search(form, [(-0.8, 0.8)], 1e-12, sie.free_with_intensity(-0.2), symmetric=True)
    assert found.converged
    assert end_errors(found, form).max() < 1e-12


def test_prescribed_intensity_and_total_width_together_find_the_total():
    form = exact.PrescribedIntensity(1.0, -0.2)
    found = search(
        form,
        [(-0.9, 0.8)],
        1e-12,
        sie.free_with_intensity(-0.2),
        conditions=(sie.Total(None),),
        end_conditions=(sie.TotalWidth(2.0),),
    )
    assert found.converged
    assert end_errors(found, form).max() < 1e-12
    assert found.value == pytest.approx(form.total, rel=1e-11)
    assert found.density.total == pytest.approx(form.total, rel=1e-11)


# Newton
# --------------------------------------------------------------------------------------------------------------
def order(found):
    """Exponent q in move_{n+1} ~ move_n^q, fitted to moves between 1e-12 (round-off) and 0.2."""
    moves = np.array([step.move for step in found.trace])
    inside = (moves < 0.2) & (moves > 1e-12)
    steps = np.flatnonzero(inside[:-1] & inside[1:])
    return np.polyfit(np.log(moves[steps]), np.log(moves[steps + 1]), 1)[0]


@pytest.mark.parametrize(
    ("form", "start"),
    [
        (exact.Westergaard(0.3, 1.0), [(-0.23, 0.27)]),
        (exact.TwoZones(0.3, 0.8), [(-0.83, -0.26), (0.33, 0.79)]),
        (exact.Wedge(0.7), [(-0.5, 0.9)]),
    ],
)
def test_the_ends_converge_quadratically(form, start):
    found = search(form, start)
    assert found.converged
    assert 1.8 < order(found) < 2.3


def test_prescribed_intensities_converge_quadratically_too():
    found = search(
        exact.PrescribedIntensity(1.0, -0.2), [(-1.5, 1.5)], 1e-12, sie.free_with_intensity(-0.2)
    )
    assert 1.8 < order(found) < 2.3


def intensities(form, zones):
    equation = sie.Equation(
        kernel_of(form), forcing_of(form), (sie.Total(form.total), sie.EqualPotential())
    )
    return sie.solve_fixed(equation, sie.Zones.of(zones)).density


@pytest.mark.parametrize(
    "form", [exact.TwoZones(0.3, 0.8), exact.Westergaard(0.3, 1.0), exact.Wedge(0.7)]
)
def test_at_the_solution_each_intensity_depends_on_its_own_end_only(form):
    slopes = np.array(intensities(form, form.zones).edge_slopes)
    count = len(form.zones)
    for side in (0, 1):
        for j in range(count):
            h = 1e-5 * (form.zones[j, 1] - form.zones[j, 0])
            outward = np.zeros((count, 2))
            outward[j, side] = h if side else -h
            change = np.array(intensities(form, form.zones + outward).intensities)
            change -= np.array(intensities(form, form.zones - outward).intensities)
            expected = np.zeros((2, count))
            expected[side, j] = -0.5 * slopes[side, j]
            # The central difference has a relative error of the order of 1e-5 squared.
            assert change / (2 * h) == pytest.approx(expected, abs=1e-8 * np.abs(slopes).max())


def test_the_trace_lists_the_steps():
    found = search(exact.Hertz(1.0), [(-0.6, 0.9)])
    assert len(found.trace) == 5
    assert found.trace[0].zones == pytest.approx(np.array([[-0.6, 0.9]]))
    assert found.trace[-1].move < 1e-13
    assert found.value is None


# Scales and places
# ---------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("length", 10.0 ** np.arange(-9, 4))
@pytest.mark.parametrize("period", [None, 1.0])
def test_the_units_of_length_and_of_the_density_do_not_matter(length, period):
    stress = 1e7 / length
    form = exact.Wedge(0.3, 1.0) if period is None else exact.Westergaard(0.3, 1.0)
    at = np.array(getattr(form, "jumps_at", ())) * length
    forcing = sie.Forcing(
        lambda x: stress * form.value(x / length),
        lambda x: stress * length * form.primitive(x / length),
        sie.Jumps(at, stress * np.array(getattr(form, "jumps", ()))),
    )
    kernel = sie.cauchy() if period is None else sie.hilbert(length)
    equation = sie.Equation(kernel, forcing, (sie.Total(form.total * stress * length),))
    found = sie.find_ends(equation, sie.Zones.of([[-0.2 * length, 0.25 * length]]), 1e-13)
    assert found.converged
    assert len(found.trace) <= 6
    assert found.density.zones.table / length == pytest.approx(form.zones, abs=1e-13)
    assert found.density.at_t(0, T) / stress == pytest.approx(form.at(T), rel=1e-12)


@pytest.mark.parametrize("periods", [-4, 1, 1000, 1_000_000])
def test_zones_are_found_many_periods_away_to_the_rounding_of_their_place(periods):
    form = exact.Westergaard(0.3, 1.0)
    equation = sie.Equation(sie.hilbert(1.0), forcing_of(form), (sie.Total(form.total),))
    found = sie.find_ends(equation, sie.Zones.of(periods + np.array([[-0.2, 0.25]])), 1e-13)
    assert found.converged
    error = np.abs(found.density.zones.table - periods - form.zones) / 0.6
    # At the place x, sin(2 pi x) has a round-off of 2 pi eps |x|.
    assert error.max() < max(1e-13, 10 * np.spacing(abs(float(periods))))
    assert np.all(error <= found.end_error + 4e-16)


# Kinks near the ends
# -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("distance", [0.3, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6])
@pytest.mark.parametrize("start", [(-0.3, 0.4), (-0.95, 0.97), (-1.4, 1.2)])
def test_ends_just_past_a_kink_are_found(distance, start):
    kink, jump = 1 - distance, 0.5

    def value(x):
        return x + jump * (x > kink) - jump * (x < -kink)

    forcing = sie.Forcing(value, jumps=sie.Jumps(np.array([-kink, kink]), np.array([jump, jump])))
    # The total of a density with bounded ends is int g x / sqrt(1 - x^2) dx.
    total = 0.5 * math.pi + 2 * jump * math.sqrt(distance * (2 - distance))
    found = sie.find_ends(
        sie.Equation(sie.cauchy(), forcing, (sie.Total(total),)), sie.Zones.of([start]), 1e-12
    )
    assert found.converged
    assert len(found.trace) <= 12
    assert found.density.zones.table == pytest.approx(np.array([[-1.0, 1.0]]), abs=2e-12)


def test_ends_just_short_of_a_kink_are_found():
    for distance in (1e-1, 1e-3, 1e-6):
        kink = 1 + distance
        forcing = sie.Forcing(
            lambda x, kink=kink: x + 0.5 * np.sign(x) * (np.abs(x) > kink),
            jumps=sie.Jumps(np.array([-kink, kink]), np.array([0.5, 0.5])),
        )
        equation = sie.Equation(sie.cauchy(), forcing, (sie.Total(0.5 * math.pi),))
        for start in ((-0.3, 0.4), (-1.4, 1.9)):
            found = sie.find_ends(equation, sie.Zones.of([start]), 1e-12)
            assert found.converged
            assert found.density.zones.table == pytest.approx(np.array([[-1.0, 1.0]]), abs=2e-12)


# Problems without a solution
# ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("total", [0.0, -1.0])
def test_a_total_no_zone_can_have_loses_the_zone(total):
    equation = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(total),))
    found = sie.find_ends(equation, sie.Zones.of([[-1, 1]]))
    assert not found.converged
    assert list(found.lost) == [0]


def test_a_total_beyond_the_full_period_closes_the_gap():
    equation = sie.Equation(
        sie.hilbert(1.0), forcing_of(exact.Westergaard(0.3, 1.0)), (sie.Total(1.1),)
    )
    found = sie.find_ends(equation, sie.Zones.of([[-0.4, 0.3]]))
    assert not found.converged
    assert list(found.met) == [0]


def test_zones_that_should_be_one_meet():
    conditions = (sie.Total(math.pi / 2), sie.EqualPotential())
    equation = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x, lambda x: x * x / 2), conditions)
    found = sie.find_ends(equation, sie.Zones.of([[-0.9, -0.05], [0.05, 0.9]]))
    assert not found.converged
    assert list(found.met) == [0]


def test_few_steps_are_not_convergence():
    equation = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(math.pi / 2),))
    found = sie.find_ends(
        equation, sie.Zones.of([[-0.3, 0.2]]), 1e-13, sie.NewtonOptions(max_steps=2)
    )
    assert not found.converged
    assert found.end_error.max() > 1e-3


# Stability, and reasons for the end of a search
# --------------------------------------------------------------------------------------
def adhesive(total, start, intensity=-0.2, **options):
    """Search for the ends with g = x, a given total P and a given intensity K.

    On a zone of half width a, P(a) = pi (a^2 / 2 + K sqrt(2 a)). With K < 0, P falls with growing
    a to a minimum, the fold, and rises from there.
    """
    end = sie.free_with_intensity(intensity)
    equation = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(total),))
    return sie.find_ends(
        equation, sie.Zones.of([start], end, end), 1e-10, sie.NewtonOptions(**options)
    )


@pytest.mark.parametrize(
    ("start", "stable"), [(0.05, False), (0.1, False), (0.4, True), (1.5, True)]
)
def test_of_two_roots_the_one_found_is_reported_as_stable_or_unstable(start, stable):
    found = adhesive(-0.3, (-start, 1.1 * start))
    half = 0.5 * float(np.diff(found.density.zones.table)[0, 0])
    assert found.converged
    assert math.pi * (half**2 / 2 - 0.2 * math.sqrt(2 * half)) == pytest.approx(-0.3, abs=1e-9)
    fold = (0.2 / math.sqrt(2)) ** (2 / 3)
    assert (half > fold) == stable == found.stable
    assert ("unstable root" in found.reason) != stable


def test_a_load_past_the_fold_is_the_reason_reported():
    for start in ((-0.05, 0.06), (-0.3, 0.3), (-1.0, 1.2)):
        found = adhesive(-0.4, start)
        assert not found.converged and found.stable is None
        assert "past a fold" in found.reason


def test_a_given_width_makes_an_unstable_root_stable():
    end = sie.free_with_intensity(-0.2)
    equation = sie.Equation(
        sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(None),), (), (sie.TotalWidth(0.27),)
    )
    found = sie.find_ends(equation, sie.Zones.of([[-0.12, 0.15]], end, end), 1e-10)
    assert found.converged and found.stable
    assert adhesive(found.value, (-0.13, 0.14)).stable is False


@pytest.mark.parametrize(
    ("load", "start", "stable"),
    [(lambda x: -np.exp(-x * x), 2.0, True), (lambda x: -1 - 0.1 * x * x, 0.4, False)],
)
def test_a_crack_is_stable_where_its_intensity_falls_as_it_grows(load, start, stable):
    left, right = sie.free_with_intensity(-0.3), sie.free_with_intensity(0.3)
    equation = sie.Equation(sie.cauchy(), sie.Forcing(load), (sie.ZoneTotals(),))
    found = sie.find_ends(
        equation,
        sie.Zones.of([[-start, start]], left, right),
        1e-10,
        sie.NewtonOptions(signs=(-1.0, 1.0)),
    )
    assert found.converged and found.stable == stable


def test_a_crack_whose_position_is_undetermined_is_reported():
    left, right = sie.free_with_intensity(-0.3), sie.free_with_intensity(0.3)
    equation = sie.Equation(
        sie.cauchy(), sie.Forcing(lambda x: -np.ones_like(x)), (sie.ZoneTotals(),)
    )
    found = sie.find_ends(
        equation,
        sie.Zones.of([[-0.4, 0.5]], left, right),
        1e-10,
        sie.NewtonOptions(signs=(-1.0, 1.0)),
    )
    assert not found.converged
    assert (
        "do not determine the ends" in found.reason
        or "fold" in found.reason
        or "did not converge" in found.reason
    )


def test_every_search_says_why_it_stopped():
    assert search(exact.Hertz(1.0), [(-0.6, 0.9)]).reason == "the ends have converged"
    assert search(exact.Hertz(1.0), [(-0.6, 0.9)]).stable
    few = sie.find_ends(
        sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(1.0),)),
        sie.Zones.of([[-0.3, 0.2]]),
        options=sie.NewtonOptions(max_steps=2),
    )
    assert "3 steps" in few.reason and few.stable is None
    equation = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(-1.0),))
    assert "a zone has vanished" in sie.find_ends(equation, sie.Zones.of([[-1, 1]])).reason


def test_an_end_with_almost_no_edge_slope_does_not_determine_the_unknown_value_alone():
    # An undamped step would widen the narrow zone enormously. Damping limits each of its ends to
    # half of its width, 0.01 together. The ends of the wide zone must supply the rest of the
    # missing width 0.1.
    zones = sie.Zones.of([[0.0, 1.0], [2.0, 2.01]])
    held = SimpleNamespace(end_conditions=(sie.TotalWidth(1.11),))
    slope = np.array([[1.0, 1e6], [1.0, 1e6]])
    delta, change = bordered(held, zones, np.zeros((2, 2)), slope, (0.3, 0.5))
    assert change == pytest.approx(0.5 * (0.1 - 0.01))
    np.testing.assert_allclose(delta, change * slope)


def test_zones_that_undamped_steps_would_remove_several_times_are_lost():
    zones = sie.Zones.of([[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]])
    progress = Progress(sie.NewtonOptions(), 1e-12, np.ones(3), np.ones(3))
    asked = [[False, True, False], [False, True, True], [False, True, True]]
    lost = [
        progress.vanished(zones, np.ones(3), np.array(one), np.zeros(3, dtype=bool))[0].tolist()
        for one in asked
    ]
    # Three steps in a row would remove zone 1, so it is lost. Zone 2 is lost together with it,
    # because two steps in a row would remove zone 2.
    assert lost == [[], [], [1, 2]]
