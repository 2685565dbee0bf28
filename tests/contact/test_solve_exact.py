"""The solver against closed forms: the pressure at equal scaled positions in a zone, the zone
ends divided by the zone widths, and the numbers of a solution.
"""

from __future__ import annotations

import numpy as np
import pytest

import contact
from contact.reference import exact
from tests.contact.judge import end_error, pressure_error, relative, solve, true_error

L, DELTA, E = 1e-4, 1e-6, 1.1e11
WAVE = contact.Sinusoid(DELTA, L)
ISOLATED, PERIODIC = contact.Isolated(), contact.Periodic()
# Scaled positions in the zone of a punch with sharp corners. Its pressure error is divided by the
# mean contact pressure, since the peak is infinite. At these positions 1/sqrt(1 - t^2) is below
# 10.
WITHIN = np.linspace(-0.99, 0.99, 40)


def westergaard(a_over_L):
    return exact.Westergaard(DELTA, L, E, a_over_L * L)


def numbers_agree(solution, reference, tolerance, stiffness=None):
    for name in ("load", "approach", "max_pressure"):
        value = getattr(reference, name)
        if value is None or np.isinf(value):
            assert getattr(solution, name) == value, name
        else:
            assert relative(getattr(solution, name), value) < tolerance, name
    if reference.stiffness is not None:
        assert relative(solution.stiffness, reference.stiffness) < (stiffness or tolerance)


class TestWestergaard:
    @pytest.mark.parametrize("a_over_L", [0.001, 0.02, 0.1, 0.2, 0.3, 0.4, 0.45])
    @pytest.mark.parametrize(
        "control", ["load", "mean_pressure", "approach", "half_width", "contact_fraction"]
    )
    def test_every_control_gives_pressure_and_ends_to_1e_10(self, a_over_L, control):
        answer = westergaard(a_over_L)
        solution = solve(WAVE, PERIODIC, E, **{control: getattr(answer, control)})
        assert true_error(solution, answer) < 1e-10
        assert true_error(solution, answer) <= solution.error <= 1e-10
        # The compliance is d approach/d load = -(2/(pi E*)) ln sin A with A = pi a/L. Near A =
        # pi/2 the relative error of the stiffness is the end error times about 1/cos A.
        numbers_agree(solution, answer, 1e-10, stiffness=1e-10 / np.cos(np.pi * a_over_L) ** 2)

    @pytest.mark.parametrize("a_over_L", [0.49, 0.499])
    @pytest.mark.parametrize("control", ["load", "mean_pressure", "half_width", "contact_fraction"])
    def test_gaps_down_to_a_five_hundredth_of_the_period_are_found_to_1e_10(
        self, a_over_L, control
    ):
        answer = westergaard(a_over_L)
        solution = solve(WAVE, PERIODIC, E, **{control: getattr(answer, control)})
        assert true_error(solution, answer) < 1e-10

    def test_an_approach_near_its_limit_determines_the_gap_only_within_round_off(self):
        # With A = pi a/L, 1 - approach/Delta is about cos^4(A)/2 = 5e-11. Rounding of the
        # approach changes this difference by about 5e-6 of itself, and so the width of the gap by
        # about 1e-6 of itself.
        answer = westergaard(0.499)
        solution = solve(WAVE, PERIODIC, E, tol=1e-5, approach=answer.approach)
        assert true_error(solution, answer) <= solution.error <= 1e-5

    @pytest.mark.parametrize("a_over_L", [0.05, 0.25, 0.4])
    def test_a_tolerance_of_1e_12_is_met(self, a_over_L):
        answer = westergaard(a_over_L)
        solution = solve(WAVE, PERIODIC, E, tol=1e-12, mean_pressure=answer.mean_pressure)
        assert true_error(solution, answer) < 1e-12
        assert solution.error <= 1e-12

    @pytest.mark.parametrize("a_over_L", [0.05, 0.25, 0.45])
    def test_gap_and_displacement_are_the_closed_forms(self, a_over_L):
        answer = westergaard(a_over_L)
        solution = solve(WAVE, PERIODIC, E, half_width=answer.half_width)
        x = np.linspace(-0.7 * L, 0.9 * L, 201)
        assert np.max(np.abs(solution.gap(x) - answer.gap(x))) < 1e-12 * DELTA
        assert np.max(np.abs(solution.displacement(x) - answer.displacement(x))) < 1e-12 * DELTA

    def test_a_wave_given_as_a_fourier_series_has_the_same_solution(self):
        answer = westergaard(0.3)
        wave = contact.Fourier(L, [0.0, -DELTA, 0.0])
        twice = solve(wave, PERIODIC, E, load=2 * exact.Westergaard(DELTA, L / 2, E, 0.15 * L).load)
        assert len(twice.zones) == 2
        once = solve(contact.Fourier(L, [-DELTA]), PERIODIC, E, load=answer.load)
        assert true_error(once, answer) < 1e-10

    def test_an_answer_off_by_a_millionth_is_told_from_the_right_one(self):
        answer = westergaard(0.3)
        wrong = westergaard(0.3 * (1 + 1e-6))
        solution = solve(WAVE, PERIODIC, E, half_width=answer.half_width)
        assert pressure_error(solution, wrong) > 1e-7
        assert end_error(solution, wrong) > 1e-7


class TestIsolatedZones:
    @pytest.mark.parametrize("control", ["load", "approach", "half_width"])
    @pytest.mark.parametrize("a", [1e-7, 1e-3, 0.3])
    def test_hertz(self, control, a):
        answer = exact.HertzLine(1.0, E, a, datum=1.0)
        solution = solve(
            contact.Parabola(1.0),
            contact.Isolated(datum=1.0),
            E,
            **{control: getattr(answer, control)},
        )
        assert true_error(solution, answer) < 1e-10
        numbers_agree(solution, answer, 1e-10)

    @pytest.mark.parametrize("control", ["load", "approach", "half_width"])
    def test_a_wedge_with_its_tip_and_ends(self, control):
        answer = exact.IsolatedWedge(0.1, E, 1e-3, datum=0.1)
        solution = solve(
            contact.Wedge(0.1),
            contact.Isolated(datum=0.1),
            E,
            **{control: getattr(answer, control)},
        )
        assert true_error(solution, answer) < 1e-9
        numbers_agree(solution, answer, 1e-9)

    @pytest.mark.parametrize("control", ["load", "approach"])
    def test_a_flat_punch(self, control):
        answer = exact.IsolatedPunch(0.3, E, 2e5, datum=1.0)
        solution = solve(
            contact.Flat(0.6), contact.Isolated(datum=1.0), E, **{control: getattr(answer, control)}
        )
        assert true_error(solution, answer, WITHIN) < 1e-10
        numbers_agree(solution, answer, 1e-10)
        outside = np.array([0.31, 0.5, 3.0])
        assert np.allclose(
            solution.displacement(outside), answer.displacement(outside), rtol=1e-11, atol=0
        )
        assert np.all(np.isinf(solution.gap(outside)))

    @pytest.mark.parametrize("inner_over_c", [0.98, 0.8, 0.4, 0.02, 2e-3])
    def test_two_zones_of_a_biquadratic_down_to_their_merging(self, inner_over_c):
        answer = exact.IsolatedBiquadratic.from_inner_end(
            0.05 * inner_over_c, radius=1.0, spacing=0.1, E_star=E
        )
        solution = solve(contact.Biquadratic(1.0, 0.1), ISOLATED, E, load=answer.load)
        assert true_error(solution, answer) < 1e-10
        assert relative(solution.zone_loads, answer.zone_loads) < 1e-10

    @pytest.mark.parametrize("over_merging", [1.001, 1.5, 20.0, 1e4])
    def test_one_zone_of_a_biquadratic_above_the_merging_load(self, over_merging):
        merging = exact.IsolatedBiquadratic(1.0, 0.1, E, 1.0).merging_load
        answer = exact.IsolatedBiquadratic(1.0, 0.1, E, over_merging * merging)
        solution = solve(contact.Biquadratic(1.0, 0.1), ISOLATED, E, load=answer.load)
        assert true_error(solution, answer) < 1e-10


class TestRows:
    @pytest.mark.parametrize("a_over_L", [0.01, 0.1, 0.25, 0.4, 0.45, 0.49])
    def test_kuznetsov_parabolas(self, a_over_L):
        answer = exact.PeriodicParabola(1.0, L, E, a_over_L * L)
        profile = contact.Parabola(1.0, period=L)
        for control in ("load", "contact_fraction", "approach"):
            solution = solve(profile, PERIODIC, E, **{control: getattr(answer, control)})
            assert true_error(solution, answer) < 1e-10
            numbers_agree(solution, answer, 1e-9, stiffness=1e-9 / np.cos(np.pi * a_over_L) ** 2)

    @pytest.mark.parametrize("a_over_L", [0.01, 0.1, 0.25, 0.4, 0.45])
    def test_wedges_with_tips_and_ends(self, a_over_L):
        answer = exact.PeriodicWedge(0.1, L, E, a_over_L * L)
        profile = contact.Wedge(0.1, period=L)
        for control in ("load", "contact_fraction"):
            solution = solve(profile, PERIODIC, E, **{control: getattr(answer, control)})
            assert true_error(solution, answer) < 1e-9
            assert solution.max_pressure == np.inf

    @pytest.mark.parametrize("width_over_L", [0.01, 0.3, 0.8, 0.98, 0.998])
    def test_flat_punches_up_to_nearly_touching(self, width_over_L):
        answer = exact.PeriodicPunch(0.5 * width_over_L * L, L, E, 3e3)
        profile = contact.Flat(width_over_L * L, period=L)
        solution = solve(profile, PERIODIC, E, load=answer.load)
        assert true_error(solution, answer, WITHIN) < 1e-10
        assert solution.mean_gap == np.inf
        # The approach is -(2P/(pi E*)) ln sin A with A = pi a/L. For the widest punch ln sin A is
        # only -5e-6, so rounding of A has a large relative effect. The stated error includes this
        # effect.
        solution = solve(profile, PERIODIC, E, tol=1e-8, approach=answer.approach)
        assert true_error(solution, answer, WITHIN) <= solution.error <= 1e-8


class TestTheStatedError:
    """`Solution.error` is never below the true error, whatever the tolerance."""

    @pytest.mark.parametrize("tol", [1e-3, 1e-5, 1e-8, 1e-11])
    @pytest.mark.parametrize("a_over_L", [0.03, 0.2, 0.42])
    def test_is_no_less_than_the_true_one_and_no_more_than_the_tolerance(self, tol, a_over_L):
        a = a_over_L * L
        cases = [
            (WAVE, exact.Westergaard(DELTA, L, E, a)),
            (contact.Parabola(1.0, period=L), exact.PeriodicParabola(1.0, L, E, a)),
            (contact.Wedge(0.01, period=L), exact.PeriodicWedge(0.01, L, E, a)),
        ]
        for profile, answer in cases:
            solution = solve(profile, PERIODIC, E, tol=tol, load=answer.load)
            assert true_error(solution, answer) <= solution.error <= tol

    @pytest.mark.parametrize("tol", [1e-4, 1e-8])
    def test_holds_where_two_zones_nearly_touch(self, tol):
        for inner in (0.03, 0.004, 0.0005):
            answer = exact.IsolatedBiquadratic.from_inner_end(
                inner, radius=1.0, spacing=0.1, E_star=1.0
            )
            solution = solve(contact.Biquadratic(1.0, 0.1), ISOLATED, tol=tol, load=answer.load)
            assert true_error(solution, answer) <= solution.error <= tol
