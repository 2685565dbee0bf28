"""Several zones are found from the profile and the load alone. Inverse design makes problems with
known exact solutions.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings

import contact
from contact.reference.inverse import design, random_problem
from sie.states.solve import SolveOptions
from tests.contact.judge import counterparts, relative, solve, true_error
from tests.contact.strategies import designed_contacts
from tests.tiers import quick

ISOLATED, PERIODIC = contact.Isolated(), contact.Periodic()


def solved(answer, tol=1e-9, **control):
    control = control or {"load": answer.load}
    model = ISOLATED if answer.period is None else PERIODIC
    return solve(answer.profile, model, answer.E_star, tol=tol, **control)


class TestInverseDesign:
    @settings(max_examples=14)
    @given(designed_contacts(min_zones=2, max_zones=12, periodic=True, nearest=0.1))
    def test_zones_of_a_period_are_found_from_profile_and_load_alone(self, answer):
        # Round-off of the profile limits the accuracy of zones that carry a tiny part of the
        # load. So the zone loads may differ at most by a factor of 100.
        assume(answer.zone_loads.min() > 1e-2 * answer.zone_loads.max())
        solution = solved(answer, tol=1e-9)
        assert true_error(solution, answer) <= solution.error <= 1e-9
        assert solution.certificate.holds
        assert (
            relative(solution.zone_loads[counterparts(solution, answer)[0]], answer.zone_loads)
            < 1e-8
        )
        assert abs(solution.mean_gap / answer.mean_gap - 1) < 1e-8

    @settings(max_examples=12)
    @given(designed_contacts(min_zones=2, max_zones=5, periodic=False, nearest=0.2))
    def test_zones_of_isolated_contact_are_found_from_profile_and_load_alone(self, answer):
        # The profile f is a polynomial whose degree is twice the number of zones. High degrees
        # are ill-conditioned, so there are at most five zones.
        assume(answer.zone_loads.min() > 1e-2 * answer.zone_loads.max())
        solution = solved(answer, tol=1e-9)
        assert true_error(solution, answer) <= solution.error <= 1e-9

    @pytest.mark.parametrize("count", quick([2, 3, 5, 8, 12], [2, 5]))
    def test_every_control_of_a_rough_period_leads_to_the_same_zones(self, count):
        answer = random_problem(np.random.default_rng(count), zones=count, period=1e-3, E_star=1e9)
        for control in ("load", "mean_pressure", "approach", "contact_fraction"):
            solution = solved(answer, tol=1e-8, **{control: getattr(answer, control)})
            assert true_error(solution, answer) <= solution.error <= 1e-8

    @pytest.mark.parametrize("profile", ["designed", "rough"])
    def test_fast_sums_lead_to_the_same_zones_as_a_matrix(self, profile, monkeypatch):
        if profile == "designed":
            answer = random_problem(
                np.random.default_rng(8), zones=24, period=1.0, spread=3.0, fraction=0.4
            )
            scene = contact.Scene(answer.profile, 1.0, PERIODIC, load=answer.load)
        else:
            rng, k = np.random.default_rng(3), np.arange(1, 65)
            waves = 1e-3 * np.maximum(k, 4) ** -1.3 * np.exp(2j * np.pi * rng.uniform(size=64))
            scene = contact.Scene(
                contact.Fourier(1.0, waves.real, waves.imag), 1.0, PERIODIC, mean_pressure=2e-3
            )
        by_matrix = contact.solve(scene, tol=1e-9)
        monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=50))
        by_sums = contact.solve(scene, tol=1e-9)
        assert by_sums.plan["fast sums"].used and not by_matrix.plan["fast sums"].used
        allowed = (by_sums.error + by_matrix.error) * by_matrix.zone_widths[:, None]
        assert len(by_sums.zones) >= 8 and np.all(
            np.abs(by_sums.zones - by_matrix.zones) <= allowed
        )

    @pytest.mark.parametrize("tol", [1e-3, 1e-5, 1e-7, 1e-9])
    def test_the_stated_error_is_no_less_than_the_true_one_at_any_tolerance(self, tol):
        for seed in range(6):
            answer = random_problem(np.random.default_rng(seed), zones=2 + seed, period=2 * np.pi)
            solution = solved(answer, tol=tol)
            assert true_error(solution, answer) <= solution.error <= tol

    @pytest.mark.parametrize("gap", [3e-2, 1e-3, 1e-4])
    def test_zones_that_nearly_touch_stay_apart(self, gap):
        ends = np.array([[-0.3, -0.05], [-0.05 + gap * 0.25, 0.2], [0.3, 0.35]])
        answer = design(ends, 1.0, 0.02, 1.0)
        solution = solved(answer, tol=1e-6)
        assert true_error(solution, answer) <= solution.error <= 1e-6

    def test_a_zone_across_the_border_of_the_cell_is_named_by_its_left_end(self):
        answer = design(np.array([[-0.2, 0.1], [0.4, 0.7]]), 1.0, 0.05, 1.0)
        solution = solved(answer)
        assert true_error(solution, answer) < 1e-9
        assert solution.zones[1, 0] < 0.5 < solution.zones[1, 1]
        assert abs(float(solution.pressure(-0.45)) / float(solution.pressure(0.55)) - 1) < 1e-12

    def test_zones_whose_widths_differ_by_a_factor_of_a_thousand_are_found(self):
        answer = design(np.array([[-0.4, -0.1], [0.0, 3e-4], [0.2, 0.4]]), 1.0, 0.02, 1.0)
        solution = solved(answer, tol=1e-7)
        assert true_error(solution, answer) <= solution.error <= 1e-7

    def test_fields_of_several_zones_are_the_exact_ones(self):
        answer = random_problem(np.random.default_rng(5), zones=6, period=1.0)
        solution = solved(answer)
        x = np.linspace(-0.8, 1.1, 500)
        size = float(np.ptp(answer.height(x)))
        assert np.max(np.abs(solution.gap(x) - answer.gap(x))) < 1e-11 * size
        assert np.max(np.abs(solution.displacement(x) - answer.displacement(x))) < 1e-11 * size

    def test_an_end_moved_by_1e_5_of_its_zone_is_detected_as_an_error(self):
        answer = random_problem(np.random.default_rng(3), zones=4, period=1.0)
        solution = solved(answer)
        moved = answer.zones.copy()
        moved[1, 1] += 1e-5 * (moved[1, 1] - moved[1, 0])
        assert true_error(solution, design(moved, 1.0, answer.load, 1.0)) > 1e-6


class TestManyAsperities:
    def test_equal_asperities_share_the_load_and_repeat_one_solution(self):
        one = solve(contact.Sinusoid(0.01, 0.2), PERIODIC, mean_pressure=0.03)
        five = solve(contact.Fourier(1.0, [0, 0, 0, 0, -0.01]), PERIODIC, mean_pressure=0.03)
        assert len(five.zones) == 5
        assert relative(five.zone_loads, one.load) < 1e-9
        assert relative(five.zone_widths, one.zone_widths[0]) < 1e-9
        x = np.linspace(-0.5, 0.5, 77)
        assert (
            np.max(np.abs(five.pressure(x) - one.pressure(x))) < 1e-4 * one.max_pressure
        )  # near an end: of order sqrt(end error)
        assert np.max(np.abs(five.gap(x) - one.gap(x))) < 1e-11

    def test_a_rough_profile_keeps_its_certificate_from_the_first_touch_to_nearly_full_contact(
        self,
    ):
        rng = np.random.default_rng(11)
        k = np.arange(1, 25)
        wave = contact.Fourier(
            1.0, 0.01 * rng.normal(size=24) / k**1.3, 0.01 * rng.normal(size=24) / k**1.3
        )
        full = solve(wave, PERIODIC, contact_fraction=1.0).mean_pressure
        x = np.linspace(-0.5, 0.5, 20001)
        fractions = []
        for share in (1e-8, 1e-4, 0.01, 0.1, 0.4, 0.7, 0.9, 0.99, 0.999):
            solution = solve(wave, PERIODIC, tol=1e-7, mean_pressure=share * full)
            pressure = solution.pressure(x)
            assert solution.certificate.holds
            assert pressure.min() >= -1e-9 * pressure.max()
            assert solution.gap(x).min() >= 0
            assert relative(solution.mean_pressure, share * full) < 1e-7
            fractions.append(solution.contact_fraction)
        assert np.all(np.diff(fractions) > 0)

    def test_a_dip_of_the_pressure_between_its_samples_is_found_and_opened(self):
        # One zone with 192 modes would meet the tolerance. But in one interval, 5e-4 of the
        # period wide, its pressure would be negative by up to 3e-4 of the peak.
        rng = np.random.default_rng(13)
        n, decay = int(rng.integers(2, 41)), rng.uniform(0, 2)
        k = np.arange(1, n + 1)
        size = k**-decay * rng.normal(size=n)
        phase = rng.uniform(0, 2 * np.pi, n)
        wave = contact.Fourier(1.0, 0.01 * size * np.cos(phase), 0.01 * size * np.sin(phase))
        full = solve(wave, PERIODIC, contact_fraction=1.0).mean_pressure
        solution = solve(wave, PERIODIC, tol=1e-7, mean_pressure=0.5 * full)
        pressure = solution.pressure(np.linspace(-0.5, 0.5, 200001))
        assert len(solution.zones) > 1
        assert pressure.min() >= -1e-9 * pressure.max()


class TestLightApproach:
    @pytest.mark.parametrize("approach", quick([1e-4, 1e-7, 1e-9], [1e-9]))
    def test_tips_between_the_points_of_any_grid_are_found_at_an_approach_below_its_lowest_point(
        self, approach
    ):
        profile, datum = contact.Biquadratic(radius=20.0, spacing=1.3), contact.Isolated(datum=7.0)
        solution = solve(profile, datum, tol=1e-8, approach=approach)
        assert len(solution.zones) == 2 and solution.certificate.holds
        again = solve(profile, datum, tol=1e-8, load=solution.load)
        assert abs(again.approach / approach - 1) < 1e-7

    @pytest.mark.parametrize("load", [1e-8, 1e-11])
    def test_a_light_load_is_carried_by_a_lower_minimum_far_away(self, load):
        """The profile f = x^2 (x - 50)^2 / 5000 - x / 1e5 has the curvature 1 at both of its
        minima. The minimum near x = 50 is lower, so it carries a light load. Hertz's half width
        there is a = 2 sqrt(P / (pi E*)).
        """
        profile = contact.Polynomial((0.0, -1e-5, 0.5, -0.02, 2e-4))
        solution = solve(profile, ISOLATED, tol=1e-6, load=load)
        assert len(solution.zones) == 1 and abs(solution.zones.mean() - 50.0) < 1e-4
        assert abs(np.diff(solution.zones)[0, 0] / (4 * np.sqrt(load / np.pi)) - 1) < 1e-5

    def test_an_approach_that_no_load_causes_is_refused(self):
        with pytest.raises(contact.OutOfRange, match="no load"):
            solve(
                contact.Biquadratic(radius=20.0, spacing=1.3),
                contact.Isolated(datum=1.0),
                tol=1e-8,
                approach=1e3,
            )
        with pytest.raises(contact.OutOfRange, match="no load"):
            solve(
                contact.Biquadratic(radius=20.0, spacing=1.3),
                contact.Isolated(datum=1e-2),
                tol=1e-8,
                approach=1e-6,
            )
