"""Laws that every solution obeys, whatever its profile: balance of the load, equal approach of
all zones, signs of pressure and gap, scaling, shifts and mirror images.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contact
from contact.reference.inverse import random_problem
from tests.contact.judge import relative, solve

ISOLATED, PERIODIC = contact.Isolated(), contact.Periodic()
FAR = contact.Isolated(datum=2.0)
SELF = contact.Localized("self-consistent")
NODES, WEIGHTS = np.polynomial.legendre.leggauss(64)


def rough(seed, harmonics=8, period=1.0, size=0.01):
    rng = np.random.default_rng(seed)
    k = np.arange(1, harmonics + 1)
    return contact.Fourier(
        period, size * rng.normal(size=harmonics) / k, size * rng.normal(size=harmonics) / k
    )


def rough_points(seed, count=48):
    x = np.arange(count) / count - 0.5
    return contact.Sampled(x, -rough(seed, 6).height(x), period=1.0)


SCENES = [
    (contact.Sinusoid(0.01, 1.0), PERIODIC, {"mean_pressure": 0.02}),
    (contact.Wedge(0.05, period=1.0), PERIODIC, {"mean_pressure": 0.02}),
    (contact.Parabola(2.0, period=1.0), PERIODIC, {"contact_fraction": 0.4}),
    (contact.Biquadratic(1.0, 0.3, period=1.0), PERIODIC, {"mean_pressure": 0.004}),
    (
        contact.Polynomial([0.0, 0.01, 0.2, -0.04, 0.3], period=1.0),
        PERIODIC,
        {"mean_pressure": 0.005},
    ),
    (rough(1), PERIODIC, {"mean_pressure": 0.02}),
    (rough(4), SELF, {"mean_pressure": 0.004}),
    (rough(1), contact.Localized("self-consistent", neighbours=2), {"mean_pressure": 0.01}),
    (rough(4), contact.Localized("first-order"), {"mean_pressure": 0.004}),
    (rough_points(2), PERIODIC, {"mean_pressure": 0.02}),
    (contact.Parabola(1.0), FAR, {"load": 0.03}),
    (contact.Wedge(0.1), FAR, {"load": 0.03}),
    (contact.Biquadratic(1.0, 0.3), FAR, {"load": 1e-3}),
    (contact.Polynomial([5.0, 0.3, 1.0, -0.5, 0.4]), FAR, {"load": 0.03}),
]


@pytest.fixture(scope="module", params=SCENES, ids=lambda scene: f"{scene[0].name}-{scene[1].name}")
def solution(request):
    profile, model, control = request.param
    return solve(profile, model, tol=1e-9, **control)


def lowest(solution):
    x = around(solution)
    return float(np.min(solution.scene.profile.height(x)))


def around(solution, count=20001):
    """Returns dense positions over one period, or over three times the span of the zones."""
    a, b = solution.zones[0, 0], solution.zones[-1, 1]
    if solution.scene.period is None:
        return np.linspace(2 * a - b, 2 * b - a, count)
    return solution.scene.profile.x0 + solution.scene.period * np.linspace(0, 1, count)


def zone_integral(solution, weight=lambda x: 1.0):
    """Returns int weight p dx over all zones, by Gauss-Legendre quadrature in the angle. Its
    panels become shorter towards the middle of a zone, where the pressure may have the
    singularity of a tip.
    """
    panels = np.pi * np.concatenate(
        [0.5 - 0.5 * 0.2 ** np.arange(20), [0.5], 0.5 + 0.5 * 0.2 ** np.arange(20)[::-1]]
    )
    total = 0.0
    for k, (a, b) in enumerate(solution.zones):
        lo, hi = panels[:-1, None], panels[1:, None]
        angle = (lo + (hi - lo) * 0.5 * (1 + NODES)).ravel()
        step = (0.5 * (hi - lo) * WEIGHTS).ravel()
        p = solution.pressure_at(np.cos(angle), k)
        x = 0.5 * (a + b) + 0.5 * (b - a) * np.cos(angle)
        total += (
            float(np.sum(np.where(np.isfinite(p), p, 0.0) * np.sin(angle) * step * weight(x)))
            * 0.5
            * (b - a)
        )
    return total


class TestBalance:
    def test_the_pressure_carries_the_load(self, solution):
        # The quadrature is less accurate for a spline, because the pressure is not smooth at its
        # knots.
        tolerance = 1e-6 if solution.scene.profile.name == "sampled" else 1e-9
        assert abs(zone_integral(solution) / solution.load - 1) < tolerance

    def test_the_load_of_the_zones_is_the_load_and_their_widths_the_contact_fraction(
        self, solution
    ):
        assert np.all(solution.zone_loads > 0)
        assert abs(solution.zone_loads.sum() / solution.load - 1) < 1e-13
        if solution.scene.period is None:
            assert solution.contact_fraction is None
        else:
            assert (
                abs(solution.zone_widths.sum() / solution.scene.period - solution.contact_fraction)
                < 1e-15
            )
            assert abs(solution.load / solution.scene.period / solution.mean_pressure - 1) < 1e-14

    def test_the_control_has_its_prescribed_value(self, solution):
        name, value = solution.scene.control
        assert abs(getattr(solution, name) / value - 1) < 1e-9


class TestGeometry:
    def test_in_contact_displacement_and_profile_add_up_to_the_approach(self, solution):
        height = solution.scene.profile.height
        for a, b in solution.zones:
            x = np.linspace(a, b, 101)
            level = solution.displacement(x) + height(x) - lowest(solution)
            # `lowest` returns the lowest sample, which lies slightly above the true minimum. This
            # error shifts `level` by a constant, which does not change np.ptp(level).
            assert np.ptp(level) < 1e-9 * np.ptp(height(around(solution)))

    def test_on_the_zones_the_potential_of_the_density_fits_the_profile_with_one_level(
        self, solution
    ):
        fields = solution.fields
        density, problem = fields.density, fields.problem
        for k in range(len(density.zones)):
            x = density.zones.middle[k] + density.zones.half[k] * np.linspace(-0.95, 0.95, 24)
            total = density.potential(x) - problem.shape(x)
            for amplitude, column in zip(density.amplitudes, problem.unknown_columns, strict=True):
                total = total - amplitude * column.primitive(x)
            # The tolerance is relative to the total of the density, the scale of the
            # displacement.
            assert np.max(np.abs(total - fields.level)) < 1e-8 * density.total

    def test_nowhere_is_there_a_pull_or_an_overlap(self, solution):
        x = around(solution)
        pressure, gap = solution.pressure(x), solution.gap(x)
        finite = pressure[np.isfinite(pressure)]
        assert finite.min() >= -1e-9 * finite.max()
        assert gap.min() >= 0
        assert np.all((pressure == 0) | (gap == 0))
        assert solution.certificate.holds

    def test_outside_the_zones_the_gap_is_displacement_plus_profile_minus_approach(self, solution):
        x = around(solution, 400)
        x = x[solution.pressure(x) == 0]
        open_ = solution.displacement(x) + solution.scene.profile.height(x) - solution.approach
        size = np.ptp(solution.scene.profile.height(around(solution)))
        least = np.min(solution.scene.profile.height(around(solution)))
        assert np.max(np.abs(open_ - least - solution.gap(x))) < 1e-6 * size

    def test_the_displacement_of_a_period_has_no_mean(self, solution):
        if solution.scene.interaction.name != "periodic":
            pytest.skip("only the exact periodic model fixes it so")
        mean = np.mean(solution.displacement(around(solution)[:-1]))
        assert abs(mean) < 1e-5 * np.ptp(solution.scene.profile.height(around(solution)))

    def test_the_mean_gap_is_the_mean_of_the_gap(self, solution):
        if solution.scene.period is None:
            assert solution.mean_gap is None
            return
        assert abs(np.mean(solution.gap(around(solution)[:-1])) / solution.mean_gap - 1) < 1e-5

    def test_periodic_scenes_are_periodic_in_x(self, solution):
        period = solution.scene.period
        if period is None:
            pytest.skip("nothing repeats")
        x = np.linspace(-0.5, 0.5, 97)[:-1] + 1e-3
        for field in (solution.pressure, solution.gap, solution.displacement):
            for turns in (-3, 1):
                size = np.max(np.abs(field(x)[np.isfinite(field(x))]))
                # Rounding of x shifts a point relative to the zone ends. Near an end the pressure
                # changes by the square root of this shift.
                assert np.max(np.abs(field(x + turns * period) - field(x))) < 1e-6 * size

    def test_zones_are_ascending_disjoint_and_begin_in_the_cell(self, solution):
        zones, profile, period = solution.zones, solution.scene.profile, solution.scene.period
        assert np.all(np.diff(zones.ravel()) > 0)
        if period is not None:
            assert profile.x0 <= zones[0, 0] and zones[-1, 0] < profile.x0 + period
            assert zones[-1, 1] - period < zones[0, 0]


class TestStiffness:
    @pytest.mark.parametrize(
        "place", [k for k in range(len(SCENES)) if k != 2], ids=lambda k: SCENES[k][0].name
    )
    def test_is_the_derivative_of_the_load_by_the_approach(self, place):
        profile, model, control = SCENES[place]
        ((name, value),) = control.items()
        step = 1e-4
        ahead, here, behind = (
            solve(
                profile,
                model,
                tol=1e-11 if profile.name != "sampled" else 1e-9,
                **{name: value * factor},
            )
            for factor in (1 + step, 1, 1 - step)
        )
        difference = (ahead.load - behind.load) / (ahead.approach - behind.approach)
        # The error of the central difference is of second order in the step. The approaches add
        # about 1e-13 of their value, divided by the step.
        assert abs(here.stiffness / difference - 1) < 1e-5

    def test_without_a_datum_there_is_no_approach_and_no_stiffness(self):
        solution = solve(contact.Parabola(1.0), ISOLATED, load=0.01)
        assert solution.approach is None and solution.stiffness is None

    def test_the_datum_changes_the_approach_by_its_logarithm_and_not_the_zones(self):
        near, far = (
            solve(contact.Parabola(1.0), contact.Isolated(datum=d), load=0.01) for d in (1.0, 10.0)
        )
        assert abs((far.approach - near.approach) / (2 * 0.01 / np.pi * np.log(10)) - 1) < 1e-12
        assert np.array_equal(near.zones, far.zones)


def same(one, other, scale=1.0, pressure=1.0, tolerance=1e-11):
    """Asserts that `one`, with lengths times `scale` and pressures times `pressure`, agrees with
    `other`.
    """
    assert one.zones.shape == other.zones.shape
    assert np.max(np.abs(one.zones * scale - other.zones) / other.zone_widths[:, None]) < tolerance
    assert abs(one.load * scale * pressure / other.load - 1) < tolerance
    t = np.linspace(-0.97, 0.98, 16)
    for k in range(len(one.zones)):
        off = one.pressure_at(t, k) * pressure - other.pressure_at(t, k)
        assert np.max(np.abs(off)) < tolerance * other.max_pressure


class TestScaling:
    @pytest.mark.parametrize("length", [2.0**-30, 2.0**-14, 2.0**10])
    @pytest.mark.parametrize("modulus", [1.0, 2.0**40])
    def test_lengths_and_moduli_of_any_size_give_the_same_answer(self, length, modulus):
        # Scaling by a power of two changes only the exponents of the numbers, so round-off stays
        # the same.
        one = solve(rough(3), PERIODIC, mean_pressure=0.01)
        other = contact.Fourier(length, rough(3).cosine * length, rough(3).sine * length)
        same(
            one,
            solve(other, PERIODIC, modulus, mean_pressure=0.01 * modulus),
            length,
            modulus,
            1e-13,
        )

    @pytest.mark.parametrize("length", [2.0**-30, 2.0**10])
    def test_a_polynomial_without_a_given_length_is_solved_at_any_scale(self, length):
        one = solve(contact.Polynomial([0, 0.1, 1, 1, 2]), FAR, load=1e-2, tol=1e-12)
        scaled = contact.Polynomial([0, 0.1, 1 / length, 1 / length**2, 2 / length**3])
        other = solve(scaled, contact.Isolated(datum=2 * length), load=1e-2 * length, tol=1e-12)
        # The search begins with an interval of the same length at every scale, so Newton's method
        # starts from different ends.
        same(one, other, length, 1.0, 2e-12)
        assert abs(other.approach / one.approach / length - 1) < 1e-11

    @pytest.mark.parametrize("length", [1e-9, 1e-4, 1e3])
    def test_powers_of_ten_change_no_more_than_rounding(self, length):
        one = solve(contact.Sinusoid(0.01, 1.0), PERIODIC, mean_pressure=0.02)
        other = solve(contact.Sinusoid(0.01 * length, length), PERIODIC, 3e11, mean_pressure=6e9)
        same(one, other, length, 3e11, 1e-12)

    @pytest.mark.parametrize("factor", [1e-12, 1e-6, 1e6])
    def test_amplitude_and_load_together_scale_the_pressure(self, factor):
        one = solve(rough(3), PERIODIC, mean_pressure=0.01)
        flat = contact.Fourier(1.0, rough(3).cosine * factor, rough(3).sine * factor)
        same(one, solve(flat, PERIODIC, mean_pressure=0.01 * factor), 1.0, factor, 1e-12)

    @pytest.mark.parametrize("load", [1e-14, 1e-8, 1e-3, 10.0, 1e8])
    def test_hertz_is_self_similar_over_any_load(self, load):
        solution = solve(contact.Parabola(1.0), ISOLATED, load=load)
        assert abs(solution.zone_widths[0] / (4 * np.sqrt(load / np.pi)) - 1) < 1e-13


class TestShiftsAndMirrors:
    @pytest.mark.parametrize("shift", [0.1, 0.37, 0.5, -0.2])
    def test_a_shifted_fourier_series_has_the_shifted_answer(self, shift):
        wave = rough(5)
        turn = 2 * np.pi * np.arange(1, 9) * shift
        moved = contact.Fourier(
            1.0,
            wave.cosine * np.cos(turn) - wave.sine * np.sin(turn),
            wave.cosine * np.sin(turn) + wave.sine * np.cos(turn),
        )
        one, other = (solve(w, PERIODIC, mean_pressure=0.01) for w in (wave, moved))
        x = np.linspace(-0.5, 0.5, 301)
        assert np.max(np.abs(one.gap(x) - other.gap(x + shift))) < 1e-12
        assert relative(np.sort(other.zone_loads), np.sort(one.zone_loads)) < 1e-10
        assert abs(one.approach / other.approach - 1) < 1e-10

    @pytest.mark.parametrize("periodic", [True, False])
    def test_shifted_samples_have_the_shifted_answer(self, periodic):
        x = np.linspace(0, 1, 41)[: 40 if periodic else 41]
        heights = -rough(7, 5).height(x) - (0.0 if periodic else 0.4) * (x - 0.45) ** 2
        kind = {"period": 1.0} if periodic else {}
        model, control = (
            (PERIODIC, {"mean_pressure": 0.01}) if periodic else (ISOLATED, {"load": 0.002})
        )
        one = solve(contact.Sampled(x, heights, **kind), model, tol=1e-8, **control)
        other = solve(contact.Sampled(x + 16.0, heights, **kind), model, tol=1e-8, **control)
        assert np.max(np.abs(other.zones - 16 - one.zones) / one.zone_widths[:, None]) < 1e-8
        at = np.linspace(0.02, 0.97, 200)
        assert np.max(np.abs(one.gap(at) - other.gap(at + 16))) < 1e-11

    def test_a_mirrored_profile_has_the_mirrored_answer(self):
        wave = rough(6)
        one = solve(wave, PERIODIC, mean_pressure=0.01)
        other = solve(contact.Fourier(1.0, wave.cosine, -wave.sine), PERIODIC, mean_pressure=0.01)
        x = np.linspace(-0.5, 0.5, 401)
        assert np.max(np.abs(one.gap(x) - other.gap(-x))) < 1e-12
        assert relative(np.sort(other.zone_loads), np.sort(one.zone_loads)) < 1e-10

    @pytest.mark.parametrize("offset", [1.0, 1e6, -1e6])
    def test_a_constant_added_to_the_heights_changes_the_solution_only_by_round_off(self, offset):
        x = np.arange(64) / 64
        # These heights are multiples of 2^-12, so adding the offset does not round them.
        heights = np.round(np.sin(2 * np.pi * x) * 2**12 + 2**10 * np.cos(6 * np.pi * x)) / 2**12
        one = solve(contact.Sampled(x, heights, period=1.0), PERIODIC, mean_pressure=0.5, tol=1e-8)
        other = solve(
            contact.Sampled(x, heights + offset, period=1.0), PERIODIC, mean_pressure=0.5, tol=1e-8
        )
        same(one, other, tolerance=1e-12)
        assert abs(one.approach / other.approach - 1) < 1e-12
        bare = solve(contact.Polynomial([0, 0, 1, 0.5, 1]), FAR, load=0.01)
        lifted = solve(contact.Polynomial([offset, 0, 1, 0.5, 1]), FAR, load=0.01)
        same(bare, lifted, tolerance=1e-9)

    @pytest.mark.parametrize("pressure", [0.002, 0.01, 0.02])
    def test_solving_half_of_a_symmetric_problem_gives_the_whole_solution(self, pressure):
        even = contact.Fourier(1.0, [-0.01, 0.004, -0.006])
        tiny = contact.Fourier(
            1.0, [-0.01, 0.004, -0.006], [1e-300]
        )  # not declared symmetric, but symmetric in floating point
        half, whole = (solve(w, PERIODIC, mean_pressure=pressure) for w in (even, tiny))
        assert half.plan["symmetry"].used and not whole.plan["symmetry"].used
        same(half, whole, tolerance=1e-10)

    def test_a_symmetric_profile_with_its_summit_at_the_border_is_solved_as_with_it_in_the_middle(
        self,
    ):
        middle = solve(contact.Fourier(1.0, [-0.01]), PERIODIC, mean_pressure=0.01)
        border = solve(contact.Fourier(1.0, [0.01]), PERIODIC, mean_pressure=0.01)
        assert np.max(np.abs(border.zones - 0.5 - middle.zones) % 1.0) < 1e-12 or np.allclose(
            (border.zones - 0.5 - middle.zones + 0.5) % 1.0, 0.5, atol=1e-12
        )
        assert abs(border.approach / middle.approach - 1) < 1e-12
        strip = solve(contact.Fourier(1.0, [0.01]), SELF, mean_pressure=0.01)
        there = solve(contact.Fourier(1.0, [-0.01]), SELF, mean_pressure=0.01)
        assert abs(strip.contact_fraction / there.contact_fraction - 1) < 1e-10


class TestControlsAgree:
    @settings(max_examples=6)
    @given(st.integers(0, 200), st.floats(0.03, 0.9))
    def test_load_approach_and_contact_fraction_lead_to_one_another(self, seed, share):
        wave = rough(seed, 6)
        full = solve(wave, PERIODIC, contact_fraction=1.0)
        first = solve(wave, PERIODIC, tol=1e-9, mean_pressure=share * full.mean_pressure)
        for name in ("load", "approach", "contact_fraction"):
            again = solve(wave, PERIODIC, tol=1e-7, **{name: getattr(first, name)})
            same(first, again, tolerance=1e-6)

    @pytest.mark.parametrize(
        "model", [PERIODIC, SELF, contact.Localized("first-order"), FAR], ids=lambda m: m.name
    )
    def test_half_width_too_where_one_zone_is_symmetric(self, model):
        first = solve(contact.Sinusoid(0.01, 1.0), model, load=0.008)
        for name in ("approach", "half_width", "mean_pressure"):
            value = 0.5 * first.zone_widths[0] if name == "half_width" else getattr(first, name)
            same(first, solve(contact.Sinusoid(0.01, 1.0), model, **{name: value}), tolerance=1e-9)

    def test_contact_grows_with_the_load_in_every_measure(self):
        wave = rough(8)
        full = solve(wave, PERIODIC, contact_fraction=1.0).mean_pressure
        found = [
            solve(wave, PERIODIC, tol=1e-8, mean_pressure=s * full)
            for s in (0.01, 0.1, 0.3, 0.6, 0.9)
        ]
        for name in ("approach", "contact_fraction", "max_pressure"):
            assert np.all(np.diff([getattr(s, name) for s in found]) > 0)
        assert np.all(np.diff([s.mean_gap for s in found]) < 0)
        # The contact at one load lies within the contact at the next larger load.
        x = np.linspace(-0.5, 0.5, 5001)
        for less, more in zip(found[:-1], found[1:], strict=True):
            assert np.all(more.pressure(x)[less.pressure(x) > 0] > 0)

    def test_a_near_solution_saves_the_search_and_changes_nothing(self):
        answer = random_problem(np.random.default_rng(2), zones=3, period=1.0)
        scene = contact.Scene(answer.profile, 1.0, PERIODIC, load=answer.load)
        near = contact.solve(
            contact.Scene(answer.profile, 1.0, PERIODIC, load=0.9 * answer.load), tol=1e-6
        )
        same(
            contact.solve(scene, tol=1e-10),
            contact.solve(scene, tol=1e-10, near=near),
            tolerance=1e-9,
        )
