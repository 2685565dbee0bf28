"""Full contact: the load where it begins, its exact pressure, and profiles that never reach it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import contact
from contact.formulation import conjugate
from contact.formulation.conjugate import Conjugate, clausen2, clausen3
from contact.reference import exact
from contact.verify.error import limit
from tests.contact.judge import relative, solve
from tests.tiers import quick

PERIODIC = contact.Periodic()
L, DELTA, E = 1e-4, 1e-6, 1.1e11
WAVE = contact.Sinusoid(DELTA, L)
X = np.linspace(-0.5, 0.5, 401)
COSINE, SINE = np.array([-0.01, 0.004, 0.0, 0.002]), np.array([0.003, -0.002, 0.001, 0.0])
ROUGH = contact.Fourier(1.0, COSINE, SINE)


def rough_pressure(mean, x=X):
    """The pressure mean - (E*/2) H f' for E* = 1, where H cos = sin and H sin = -cos."""
    k = 2 * np.pi * np.arange(1, 5)
    return mean - 0.5 * (
        np.cos(np.outer(x, k)) @ (k * COSINE) + np.sin(np.outer(x, k)) @ (k * SINE)
    )


def smallest_rough_load():
    fine = np.linspace(-0.5, 0.5, 2_000_001)
    return -rough_pressure(0.0, fine).min()


class TestSmallestLoad:
    def test_of_a_sinusoid_is_pi_E_amplitude_over_period(self):
        solution = solve(WAVE, PERIODIC, E, contact_fraction=1.0)
        assert abs(solution.mean_pressure / (np.pi * E * DELTA / L) - 1) < 1e-13
        assert abs(float(solution.pressure(0.5 * L))) < 1e-12 * solution.max_pressure

    def test_of_a_fourier_series_lifts_the_lowest_pressure_to_zero(self):
        solution = solve(ROUGH, PERIODIC, contact_fraction=1.0)
        # The grid of the reference value misses the minimum by 1e-13 times the curvature.
        assert abs(solution.mean_pressure / smallest_rough_load() - 1) < 1e-11
        assert solution.pressure(X).min() > -1e-12

    def test_of_samples_of_a_wave_is_nearly_that_of_the_wave(self):
        x = np.arange(128) / 128
        solution = solve(
            contact.Sampled(x, 0.01 * np.cos(2 * np.pi * x), period=1.0),
            PERIODIC,
            contact_fraction=1.0,
        )
        assert (
            abs(solution.mean_pressure / (np.pi * 0.01) - 1) < (2 * np.pi / 128) ** 4
        )  # error of the slope of a cubic spline

    @pytest.mark.parametrize(
        "profile",
        [contact.Wedge(0.1, period=1.0), contact.Parabola(1.0, period=1.0)],
        ids=lambda p: p.name,
    )
    def test_does_not_exist_where_a_valley_has_a_kink(self, profile):
        with pytest.raises(contact.OutOfRange, match="full contact"):
            solve(profile, PERIODIC, contact_fraction=1.0)

    def test_does_not_exist_for_a_punch_that_ends(self):
        with pytest.raises(contact.SceneError, match="contact_fraction"):
            solve(contact.Flat(0.5, period=1.0), PERIODIC, contact_fraction=1.0)
        assert len(solve(contact.Flat(0.5, period=1.0), PERIODIC, load=1e9).zones) == 1

    def test_below_it_there_are_gaps_and_above_it_none(self):
        least = solve(ROUGH, PERIODIC, contact_fraction=1.0).mean_pressure
        below = solve(ROUGH, PERIODIC, tol=1e-7, mean_pressure=least * (1 - 1e-6))
        assert len(below.zones) >= 1 and below.contact_fraction < 1
        assert below.mean_gap > 0
        above = solve(ROUGH, PERIODIC, mean_pressure=least * (1 + 1e-6))
        assert above.zones.shape == (0, 2)

    @pytest.mark.parametrize("distance", [1e-2, 1e-4, 1e-6])
    def test_the_last_gap_of_a_sinusoid_closes_as_the_square_root(self, distance):
        # Westergaard: pbar/p* = sin^2 A with A = pi a/L, so cos A = sqrt(distance).
        star = np.pi * E * DELTA / L
        solution = solve(WAVE, PERIODIC, E, tol=1e-6, mean_pressure=star * (1 - distance))
        gap = L - solution.zone_widths[0]
        assert abs(gap / (2 * L / np.pi * np.arcsin(np.sqrt(distance))) - 1) < 1e-5


class TestPressure:
    @pytest.mark.parametrize("over", [1.0, 1.5, 1e3])
    def test_of_a_sinusoid_is_the_mean_and_a_cosine(self, over):
        star = np.pi * E * DELTA / L
        answer = exact.FullContactSinusoid(DELTA, L, E, max(over, 1 + 1e-12) * star)
        solution = solve(WAVE, PERIODIC, E, mean_pressure=answer.mean_pressure)
        x = L * np.linspace(-1.2, 0.7, 333)
        assert (
            np.max(np.abs(solution.pressure(x) - answer.pressure(x))) < 1e-12 * answer.max_pressure
        )
        assert relative(solution.max_pressure, answer.max_pressure) < 1e-12
        assert np.max(np.abs(solution.displacement(x) - answer.displacement(x))) < 1e-13 * DELTA
        assert abs(solution.approach / DELTA - 1) < 1e-13

    def test_of_a_fourier_series_is_the_conjugate_of_its_slope(self):
        solution = solve(ROUGH, PERIODIC, mean_pressure=0.2)
        assert np.max(np.abs(solution.pressure(X) - rough_pressure(0.2))) < 1e-13
        assert np.max(np.abs(solution.pressure(X) - rough_pressure(0.2 + 1e-9))) > 1e-10

    def test_of_samples_carries_the_load_and_answers_the_equation(self):
        n = 64
        x = np.arange(n) / n
        rng = np.random.default_rng(0)
        heights = (
            sum(rng.normal() / k**3 * np.cos(2 * np.pi * k * x + k) for k in range(1, 6)) * 1e-3
        )
        profile = contact.Sampled(x, heights, period=1.0)
        least = solve(profile, PERIODIC, contact_fraction=1.0).mean_pressure
        solution = solve(profile, PERIODIC, mean_pressure=1.5 * least)
        assert abs(np.mean(solution.pressure(np.arange(4096) / 4096)) / (1.5 * least) - 1) < 1e-7
        # H H = -1 on functions with zero mean. So the transform H of the pressure, by FFT,
        # returns the slope.
        fine = (np.arange(4096) + 0.5) / 4096
        spectrum = np.fft.rfft(solution.pressure(fine)) * -1j
        spectrum[0] = 0
        back = 2 * np.fft.irfft(spectrum)
        assert np.max(np.abs(back - profile.slope(fine))) < 1e-4 * np.max(
            np.abs(profile.slope(fine))
        )

    def test_goes_over_into_the_one_just_below_full_contact(self):
        least = solve(ROUGH, PERIODIC, contact_fraction=1.0).mean_pressure
        below = solve(ROUGH, PERIODIC, tol=1e-7, mean_pressure=least * (1 - 1e-8))
        above = solve(ROUGH, PERIODIC, mean_pressure=least)
        # A gap of width g changes the pressure by about g^2 times the curvature of the
        # pressure. This is as small as the difference of the loads.
        assert np.max(np.abs(below.pressure(X) - above.pressure(X))) < 1e-6 * above.max_pressure


class TestNumbers:
    def test_everything_is_in_contact(self):
        solution = solve(ROUGH, PERIODIC, mean_pressure=0.2)
        assert solution.contact_fraction == 1.0
        assert solution.zones.shape == (0, 2)
        assert solution.zone_loads.shape == solution.zone_widths.shape == (0,)
        assert solution.mean_gap == 0.0 and solution.stiffness == np.inf
        assert not np.any(solution.gap(X))
        assert abs(solution.load - 0.2) < 1e-16
        assert solution.certificate.holds and solution.error <= 1e-10
        assert len(solution.to_dict()) > 5

    def test_surface_and_profile_are_the_approach_apart(self):
        solution = solve(ROUGH, PERIODIC, mean_pressure=0.2)
        lowest = ROUGH.height(np.linspace(-0.5, 0.5, 200001)).min()
        assert (
            np.max(np.abs(solution.displacement(X) + ROUGH.height(X) - lowest - solution.approach))
            < 1e-10
        )

    def test_an_approach_of_the_mean_height_or_more_names_no_load(self):
        full = solve(ROUGH, PERIODIC, contact_fraction=1.0).approach
        # Round-off of the approach and of the mean height must not decide.
        for approach in (full, full * (1 - 4e-16), full * (1 - 1e-15), 1.0001 * full, 10 * full):
            with pytest.raises(contact.OutOfRange, match="mean of the profile"):
                solve(ROUGH, PERIODIC, approach=approach)
        assert solve(ROUGH, PERIODIC, tol=1e-6, approach=0.99 * full).contact_fraction < 1

    def test_models_without_all_neighbours_have_no_full_contact(self):
        star = np.pi * E * DELTA / L
        for model in (contact.Isolated(), contact.Localized("first-order")):
            with pytest.raises(contact.OutOfRange):
                solve(WAVE, model, E, mean_pressure=10 * star)
        strip = solve(
            WAVE, contact.Localized("self-consistent"), E, tol=1e-8, mean_pressure=10 * star
        )
        assert 0.9 < strip.contact_fraction < 1


class Rough(contact.Profile):
    """f' = u - 1/2 + c sum_k cos(2 pi k u) / k^2 with u = x mod 1.
    The valley has a kink; the jump of f'' in the same place is not declared.
    """

    period, c = 1.0, 0.1

    def height(self, x):
        u = np.asarray(x, dtype=float) % 1.0
        return u * (u - 1) / 2 + self.c * np.pi**2 * u * (1 - 3 * u + 2 * u * u) / 6

    def slope(self, x):
        u = np.asarray(x, dtype=float) % 1.0
        return u - 0.5 + self.c * np.pi**2 * (1 / 6 - u * (1 - u))

    def slope_conjugate(self, x):
        u = np.asarray(x, dtype=float)
        u = u - np.round(u)
        return -np.log(np.abs(2 * np.sin(np.pi * u))) / np.pi + self.c * clausen2(u)

    @property
    def kinks(self):
        return np.array([[0.0, -1.0]])


def test_a_conjugate_in_closed_form_is_taken_where_the_series_does_not_end():
    conjugate = Conjugate(Rough())
    x = np.concatenate((np.geomspace(1e-4, 0.5, 50), -np.geomspace(1e-4, 0.5, 50)))
    assert np.max(np.abs(conjugate.smooth(x) - Rough.c * clausen2(x))) < 1e-13
    # Next to the kink the conjugate is linear, but Clausen's function behaves like u ln u.
    beside = np.array([-1e-6, 0.0, 1e-9, 1e-6])
    assert np.max(np.abs(conjugate.smooth(beside) - Rough.c * clausen2(beside))) < 1e-4 * Rough.c


class Arcs(contact.Profile):
    """Cubic arcs on a wave, without a conjugate in closed form.
    At random places the first or the second derivative of the slope jumps.
    """

    period = 2.0

    def __init__(self, places):
        rng = np.random.default_rng(7)
        self.at = np.sort(rng.uniform(0, 2, places))
        self.order, self.height_of = rng.integers(2, 4, places), rng.standard_normal(places)

    def _sum(self, x, derivative):
        """The height or (derivative = 1) the slope of the arcs: a sum of Bernoulli polynomials.
        These are periodic; their derivatives of the order `order` jump.
        """
        u = ((np.asarray(x, dtype=float)[..., None] - self.at) / 2.0) % 1.0
        second = (((u - 1) * u + 1 / 6) / 2) * 2.0, (((u - 1.5) * u + 0.5) * u / 6) * 4.0
        third = second[1] * 1.0, ((((u - 2) * u + 1) * u * u - 1 / 30) / 24) * 8.0
        return (
            -np.where(
                self.order == 2,
                (second if derivative else third)[0],
                (second if derivative else third)[1],
            )
            @ self.height_of
        )

    def height(self, x):
        return self._sum(x, 0) - np.cos(np.pi * np.asarray(x, dtype=float))

    def slope(self, x):
        return self._sum(x, 1) + np.pi * np.sin(np.pi * np.asarray(x, dtype=float))

    @property
    def jumps(self):
        return np.column_stack((self.at, self.order, self.height_of))


@pytest.mark.parametrize("places", [3, 300])
def test_few_jumps_are_summed_one_by_one_and_many_as_one_piecewise_quadratic(places, monkeypatch):
    profile = Arcs(places)
    seen = []
    for name in ("clausen2", "clausen3"):
        inner = getattr(conjugate, name)
        monkeypatch.setattr(
            conjugate, name, lambda u, inner=inner: (seen.append(u.shape[-1]), inner(u))[1]
        )
    x = np.concatenate(
        (np.random.default_rng(1).uniform(0, 2, 200), profile.at[:3], profile.at[:3] + 1e-9)
    )
    found = Conjugate(profile).smooth(x)
    assert max(seen) <= places and (places < 100 or max(seen) == 1)
    u = ((x[:, None] - profile.at) / 2.0 + 0.5) % 1.0 - 0.5
    parts = np.where(
        profile.order == 2, -2.0 / (2 * np.pi**2) * clausen2(u), 4.0 / (4 * np.pi**3) * clausen3(u)
    )
    wanted = parts @ profile.height_of - np.pi * np.cos(np.pi * x)
    assert found == pytest.approx(wanted, abs=1e-12 * np.abs(wanted).max())


class Rippled(contact.Profile):
    """A row of parabolas of curvature 0.04 with ripples, and with kinks between them."""

    period, x0 = 1.0, -0.5
    kinks = np.array([[-0.5, -0.04]])

    def __init__(self, ripple):
        self.ripple = ripple

    def height(self, x):
        y = np.asarray(x) - np.round(x)
        return 0.02 * y**2 - self.ripple * np.cos(10 * np.pi * y)

    def slope(self, x):
        y = np.asarray(x) - np.round(x)
        return 0.04 * y + 10 * np.pi * self.ripple * np.sin(10 * np.pi * y)


class TestAllButKinks:
    """Gaps over concave kinks never close.
    Above some load they are too narrow for floating-point numbers, while all other gaps are
    closed.
    """

    @pytest.mark.parametrize("share", [0.98, 1.0001, 2.0, 30.0, 1e6])
    def test_a_row_of_wedges_under_any_load_has_the_pressure_of_the_closed_form(self, share):
        # mean = (slope/pi) artanh(sin A). For share = 1 the gap extends over 1e-13 of the
        # period on either side of the valley, so cos A = pi 1e-13.
        mean = share * 0.01 / np.pi * np.log(2 / (np.pi * 1e-13))
        solution = solve(contact.Wedge(0.01, period=1.0), PERIODIC, mean_pressure=mean)
        x = np.array([1e-6, 0.01, 0.2, 0.4, 0.499, 0.5 - 1e-6])
        # The pressure is (slope/pi) arcosh(tan A/tan u). Here tan A = sinh(pi mean/slope) is
        # far larger than all tan u.
        expected = mean - 0.01 / np.pi * np.log(np.tan(np.pi * x))
        assert (len(solution.zones) == 0) == (share > 1) and solution.certificate.holds
        assert np.abs(solution.pressure(x) - expected).max() < 1e-10 * mean
        if share > 1:
            assert solution.contact_fraction == 1.0 and solution.certificate.undecided
            assert "1 gap over a kink is missing" in solution.certificate.note

    @pytest.mark.filterwarnings("ignore::contact.ModelWarning")
    def test_smooth_valleys_close_at_loads_of_their_own(self):
        path = contact.path(
            contact.Scene(Rippled(-0.02), 1.0, PERIODIC, load=1.0), [0.313, 0.316, 2.0]
        )
        x = np.linspace(0.38, 0.42, 2_000_001)
        full = (0.02 / np.pi) * np.log(2 * np.cos(np.pi * x)) - 0.1 * np.pi * np.cos(10 * np.pi * x)
        # The last two gaps close at the same load.
        last = path.events[-1]
        assert [event.kind for event in path.events] == ["full"] and len(last.before) == 2
        assert abs(last.load + full.min()) < 1e-11
        assert abs(min(last.position % 1, -last.position % 1) - x[np.argmin(full)]) < 1e-6

    @pytest.mark.filterwarnings("ignore::contact.ModelWarning")
    @pytest.mark.parametrize("loads", quick([[0.45, 2.0], [0.35, 0.45, 2.0]], [[0.45, 2.0]]))
    def test_the_gap_over_the_kink_narrows_without_an_event(self, loads):
        path = contact.path(contact.Scene(Rippled(0.02), 1.0, PERIODIC, load=1.0), loads)
        zones = [len(solution.zones) for solution in path.solutions]
        assert zones == [1] * (len(loads) - 1) + [0] and path.events == ()


def test_the_uncertainty_of_gaps_by_rounding_is_named():
    zones = SimpleNamespace(a=np.array([0.0, 1.0]), b=np.array([0.5, 1.001]))
    free = SimpleNamespace(
        density=SimpleNamespace(zones=zones),
        rounding=np.array([[0, 0], [2e-10, 1e-10]]),
        end_error=np.array([[0, 0], [3e-10, 1e-10]]),
    )
    why = limit(free, 1e-8, "gap", error=2e-8)
    assert "gaps uncertain by 2.0e-10 of their width" in why and "1e+02 times" in why
    narrow = limit(free, 1e-10, "gap", error=2e-8)
    assert narrow.startswith("rounding of heights and slopes makes the ends of a gap uncertain by")
    assert "this gap has 2.0e-03 of the width" in narrow
    # An end error that is left by Newton's method does not come from round-off.
    free.end_error = free.end_error * 10
    assert limit(free, 1e-8, "gap", error=2e-8) == ""
