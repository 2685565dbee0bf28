"""Nearly full contact, solved by its gaps.
The solutions are compared with closed forms and with solutions by zones, down to the smallest
gaps.
"""

import numpy as np
import pytest

import contact
from contact.reference import exact
from contact.reference.inverse import random_problem
from contact.search.strategies.gaps import GapOptions
from contact.studies.scene_families import PiecewiseLinear
from tests.contact.corners import polygon
from tests.contact.judge import pressure_error, true_error
from tests.tiers import quick

AMPLITUDE, PERIOD, MODULUS = 1e-6, 1e-4, 1.1e11
WAVE = contact.Sinusoid(AMPLITUDE, PERIOD)
T = np.array([-0.999, -0.9, -0.3, 0.0, 0.5, 0.99])


def closed(gap):
    """Westergaard's contact whose gap is this fraction of the period."""
    return exact.Westergaard(AMPLITUDE, PERIOD, MODULUS, 0.5 * PERIOD * (1 - gap))


def errors(solution, truth):
    """The larger of the errors of the pressure (over its largest value) and of the ends."""
    pressure = np.abs(solution.pressure_at(T) - truth.pressure_at(T)).max() / truth.max_pressure
    ends = np.abs(solution.zones - truth.zones).max() / truth.zone_widths[0]
    return max(pressure, ends)


@pytest.mark.parametrize("gap", [0.2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_the_wave_is_exact_up_to_gaps_of_a_millionth_of_the_period(gap):
    truth = closed(gap)
    solution = contact.solve(contact.Scene(WAVE, MODULUS, contact.Periodic(), load=truth.load))
    # With wider gaps, contact is one zone with a solution in closed form.
    assert (solution.certificate.note == "solved by its gaps") == (gap < 0.05)
    assert errors(solution, truth) < 1e-9
    assert errors(solution, truth) <= solution.error


def test_a_load_a_part_in_a_million_off_is_seen():
    truth = closed(1e-2)
    solution = contact.solve(
        contact.Scene(WAVE, MODULUS, contact.Periodic(), load=truth.load * (1 + 1e-6))
    )
    assert errors(solution, truth) > 1e-8


@pytest.mark.parametrize("gap", [0.2, 1e-2])
def test_numbers_and_fields_are_those_of_the_closed_form(gap):
    truth = closed(gap)
    solution = contact.solve(
        contact.Scene(WAVE, MODULUS, contact.Periodic(), load=truth.load), tol=1e-10
    )
    x = np.linspace(-0.7, 0.7, 41) * PERIOD
    assert solution.approach == pytest.approx(truth.approach, rel=1e-12)
    assert solution.stiffness == pytest.approx(truth.stiffness, rel=1e-9)
    assert solution.max_pressure == pytest.approx(truth.max_pressure, rel=1e-12)
    assert solution.zone_loads.sum() == pytest.approx(truth.load, rel=1e-12)
    assert solution.gap(x) == pytest.approx(truth.gap(x), abs=1e-12 * AMPLITUDE)
    assert solution.displacement(x) == pytest.approx(truth.displacement(x), abs=1e-12 * AMPLITUDE)
    assert solution.mean_gap == pytest.approx(AMPLITUDE - truth.approach, abs=1e-12 * AMPLITUDE)


@pytest.mark.parametrize("control", ["approach", "contact_fraction"])
def test_other_controls_come_to_the_same_contact(control):
    truth = closed(0.05)
    scene = contact.Scene(WAVE, MODULUS, contact.Periodic(), **{control: getattr(truth, control)})
    assert errors(contact.solve(scene), truth) < 1e-9


@pytest.mark.parametrize("seed", quick(range(6), [0, 1]))
def test_gaps_and_zones_give_the_same_contact(seed, monkeypatch):
    design = random_problem(np.random.default_rng(seed), zones=4, period=1.0, fraction=0.8)
    scene = contact.Scene(design.profile, 1.0, contact.Periodic(), load=design.load)
    by_gaps = contact.solve(scene)
    monkeypatch.setattr("contact.search.strategies.gaps.OPTIONS", GapOptions(wide_contact=2.0))
    by_zones = contact.solve(scene)
    assert (by_gaps.certificate.note, by_zones.certificate.note) == ("solved by its gaps", "")
    assert by_gaps.zones == pytest.approx(design.zones, abs=1e-9)
    assert by_zones.zones == pytest.approx(design.zones, abs=1e-9)
    assert by_gaps.zone_loads == pytest.approx(by_zones.zone_loads, rel=1e-7)
    assert by_gaps.approach == pytest.approx(by_zones.approach, rel=1e-9)


@pytest.mark.parametrize("share", [0.99, 1 - 1e-6, 1 - 1e-10])
def test_a_rough_profile_next_to_full_contact_is_open_where_it_should_be(share):
    rng = np.random.default_rng(3)
    k = np.arange(1, 31)
    profile = contact.Fourier(
        1.0, 0.01 * rng.normal(size=30) * k**-1.3, 0.01 * rng.normal(size=30) * k**-1.3
    )
    full = contact.solve(contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0))
    solution = contact.solve(
        contact.Scene(profile, 1.0, contact.Periodic(), load=share * full.load)
    )
    x = np.linspace(-0.5, 0.5, 20001)
    assert 0.9 < solution.contact_fraction < 1.0
    assert solution.pressure(x).min() > -1e-9 * solution.max_pressure
    assert solution.gap(x).min() >= 0.0
    assert solution.mean_gap > 0.0


class TestBorders:
    @pytest.mark.parametrize("gap", [1e-4, 1e-5, 1e-6])
    def test_gaps_over_a_smooth_valley_under_a_contact_fraction(self, gap):
        answer = exact.Westergaard(1e-6, 1e-4, 1e9, 0.5e-4 * (1 - gap))
        scene = contact.Scene(
            contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), contact_fraction=1 - gap
        )
        solution = contact.solve(scene)
        assert true_error(solution, answer) <= solution.error <= 1e-8
        assert abs(solution.load / answer.load - 1) < 1e-13

    @pytest.mark.parametrize("gap", quick([1e-8, 1e-9, 1e-12], [1e-9]))
    def test_the_stated_error_covers_the_position_of_a_gap_that_rounding_may_shift_in_its_valley(
        self, gap
    ):
        cosine, sine = np.array([1e-6, 2e-7, 1e-7]), np.array([3e-7, 0.0, 2e-8])
        wave = contact.Fourier(PERIOD, cosine, sine)
        # The maximum of H f' is found by Newton's method on its derivative.
        k = 2 * np.pi / PERIOD * np.arange(1, 4)
        x = PERIOD * np.argmax(wave.slope_conjugate(PERIOD * np.arange(4096) / 4096)) / 4096
        for _ in range(6):
            up = np.sum(k**2 * (-cosine * np.sin(k * x) + sine * np.cos(k * x)))
            x += up / np.sum(k**3 * (cosine * np.cos(k * x) + sine * np.sin(k * x)))
        with np.errstate(
            divide="raise", invalid="raise"
        ):  # intermediate gaps are narrower than the rounding of their positions
            best = _best(contact.Scene(wave, 1e9, contact.Periodic(), contact_fraction=1 - gap))
        off = (0.5 * float(best.zones.sum()) + 0.5 * PERIOD - x) / PERIOD + 0.5
        assert abs(off - np.floor(off) - 0.5) <= best.error

    def test_an_approach_whose_last_digit_changes_the_load_is_refused_for_that(self):
        answer = exact.PeriodicWedge(0.1, 1.0, 1e9, 0.5 * (1 - 1e-6))
        scene = contact.Scene(
            contact.Wedge(0.1, 1.0), 1e9, contact.Periodic(), approach=answer.approach
        )
        with pytest.raises(
            contact.NotConverged,
            match="rounding of the approach in its last digit changes the load .*: give a load",
        ) as refused:
            contact.solve(scene)
        best = refused.value.best
        assert pressure_error(best, answer) <= best.error
        # One unit more or less in the last digit of the approach changes the load by about as
        # much as the stiffness predicts.
        shifted = [np.nextafter(answer.approach, side) for side in (0.0, 1.0)]
        loads = [
            _best(contact.Scene(contact.Wedge(0.1, 1.0), 1e9, contact.Periodic(), approach=a)).load
            for a in shifted
        ]
        assert (
            0.2
            < abs(loads[1] - loads[0])
            / best.load
            / (2 * np.spacing(answer.approach) * best.stiffness / best.load)
            < 5
        )

    def test_an_approach_far_below_the_heights_gives_the_load_it_came_from(self):
        # The slope of the gap over so deep a valley hardly depends on so small a pressure.
        terrace = polygon(
            np.array([-4.67, -2.6, 0.1, 0.55, 2.2, 3.82]),
            -np.array([0.0, 0.0, 0.0, 0.15, 0.15, 0.15]),
            9.35,
        )
        loaded = contact.solve(contact.Scene(terrace, 1e9, contact.Periodic(), load=1e4), tol=1e-8)
        solution = contact.solve(
            contact.Scene(terrace, 1e9, contact.Periodic(), approach=loaded.approach), tol=1e-8
        )
        assert abs(solution.load / loaded.load - 1) < loaded.error + solution.error < 1e-8


def _best(scene):
    try:
        return contact.solve(scene)
    except contact.NotConverged as failure:
        return failure.best


def test_the_relief_of_the_pressure_is_sampled_once_for_all_loads_of_a_curve():
    profile = contact.self_affine(
        hurst=0.8, period=1.0, shortest=1 / 40, longest=1.0, rms_slope=0.1, seed=3
    )
    scene = contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)
    full = contact.solve(scene).load
    found = contact.solve_many(scene, np.array([0.6, 0.7, 0.75]) * full, "load")
    (relief,) = {solution.fields.relief for solution in found}
    for solution in found:
        x, pressure = solution.fields.samples
        assert len(x) == len(relief.samples[0]) and np.ptp(x) < solution.fields.period
        assert pressure == pytest.approx(solution.fields.formal_pressure(x), abs=1e-12)
        # The largest sample is not above the largest pressure, and not much below it.
        peak = pressure.max() * solution.fields.problem.units.pressure
        assert 0.99 * solution.max_pressure < peak <= (1 + 1e-12) * solution.max_pressure


def test_a_declared_kink_without_a_jump_leaves_the_pressure_finite():
    profile = PiecewiseLinear(np.array([-0.5, -0.25, 0, 0.25]), np.array([2, 1, 0, 0.4]), 1.0)
    assert profile.kinks[1, 1] == 0.0
    found = contact.solve(contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=0.9))
    assert found.certificate.note == "solved by its gaps"
    pressure = found.pressure([-0.25, -0.25 + 1e-12])
    assert pressure[0] == pytest.approx(pressure[1], rel=1e-9)


def test_a_declared_kink_without_a_jump_does_not_matter_in_a_zone():
    at, heights = np.array([-2.0, -0.5, -0.25, 0.0, 0.5, 2.0]), np.array([1.1, 0.2, 0.1, 0, 0.3, 2])
    profile = PiecewiseLinear(at, heights)
    assert profile.kinks[1, 1] == 0.0
    found = contact.solve(contact.Scene(profile, 1.0, contact.Isolated(), load=0.3))
    pressure = found.pressure([-0.25, -0.25 + 1e-12])
    assert found.zones[0, 0] < -0.3 and pressure[0] == pytest.approx(pressure[1], rel=1e-9)
