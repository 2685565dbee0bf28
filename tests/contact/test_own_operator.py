"""Models whose operator is not the half-plane's: solved by their own kernel, or refused by name.

The exact solution, for any zones: the waves of the kernel act only on the harmonics p_n of the
pressure. So zones and pressure are those of a half-plane under another profile, which is known once
the pressure is. With the symbol L_n at the wave number q_n, this profile is f plus the sum over all
n != 0 of 2 (L_n - 1) p_n exp(i q_n x)/(E* abs(q_n)).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

import contact
import sie
from contact.studies.grid_judge import fault, judge
from contact.studies.scene_families import Bed, Buried, Coated, PiecewiseLinear, Waves
from tests.contact.judge import solve, true_error

WAVE = contact.Sinusoid(0.01, 1.0)
# Mean pressure at which full contact of WAVE begins on a half-plane: pi E* amplitude / period.
FULL = np.pi * 0.01
TOGETHER = (0.8, -0.4, 0.3)
TIPS = contact.Fourier(1.0, (-0.01, 0.006, 0.002), (0.002, -0.003, 0.001))


def harmonic(solution, n):
    """The harmonic p_n = (1/L) int p exp(-2 pi i n x/L) dx of the pressure, with the period L = 1.

    The integral over each zone is taken in the angle, in which the pressure is smooth.
    """
    angle = (np.arange(4000) + 0.5) * np.pi / 4000
    t, total = np.cos(angle), 0.0
    for k, (a, b) in enumerate(solution.zones):
        x = 0.5 * (a + b) + 0.5 * (b - a) * t
        p = solution.pressure_at(t, k) * np.sin(angle) * 0.5 * (b - a) * np.pi / 4000
        total += np.sum(p * np.exp(-2j * np.pi * n * x))
    return total


def on_a_half_plane(solution, excess):
    """The solution of the equivalent half-plane (see the head of this file), under the same load.

    excess: L_n - 1 for n = 1, 2, ...
    """
    profile = solution.scene.profile
    if isinstance(profile, contact.Sinusoid):
        cosine, sine = [-profile.amplitude], [0.0]
    else:
        cosine, sine = list(profile.cosine), list(profile.sine)
    size = max(len(cosine), len(excess))
    added = [4 * e * harmonic(solution, n) / (2 * np.pi * n) for n, e in enumerate(excess, 1)] + [
        0.0
    ] * size
    c = [(cosine + [0.0] * size)[n] + np.real(added[n]) for n in range(size)]
    s = [(sine + [0.0] * size)[n] - np.imag(added[n]) for n in range(size)]
    return solve(
        contact.Fourier(1.0, tuple(c), tuple(s)), contact.Periodic(), tol=1e-12, load=solution.load
    )


class TestByItsZones:
    @pytest.mark.parametrize("share", [0.01, 0.3, 0.6, 0.66])
    def test_a_wave_on_a_softer_body_is_wider_than_on_a_half_plane(self, share):
        solution = solve(WAVE, Waves((0.5,)), tol=1e-8, mean_pressure=share * FULL)
        assert solution.certificate.holds
        assert true_error(solution, on_a_half_plane(solution, (0.5,))) <= solution.error <= 1e-8

    @pytest.mark.parametrize("share", [0.02, 0.2, 0.45])
    def test_several_zones_of_an_unsymmetric_profile_are_right(self, share):
        solution = solve(TIPS, Waves(TOGETHER), tol=1e-8, mean_pressure=share * FULL)
        assert true_error(solution, on_a_half_plane(solution, TOGETHER)) <= solution.error <= 1e-8

    def test_a_narrow_gap_between_zones_is_right(self):
        solution = solve(TIPS, Waves(TOGETHER), tol=1e-8, load=0.0575)
        left = solution.zones[1, 0] - solution.zones[0, 1]
        assert left < 0.05 * solution.zone_widths.min()
        assert true_error(solution, on_a_half_plane(solution, TOGETHER)) <= solution.error <= 1e-8

    def test_its_contact_fraction_and_its_approach_lead_back_to_the_load(self):
        given = solve(TIPS, Bed(0.9, 0.1), tol=1e-10, mean_pressure=0.2 * FULL)
        for control in ("contact_fraction", "approach"):
            again = solve(TIPS, Bed(0.9, 0.1), tol=1e-8, **{control: getattr(given, control)})
            assert again.load == pytest.approx(given.load, rel=1e-7)

    def test_the_mean_gap_and_the_stiffness_are_those_of_the_gap_and_of_loads_and_approaches(self):
        near = [
            solve(TIPS, Bed(0.9, 0.1), tol=1e-11, load=0.2 * FULL * (1 + h))
            for h in (-1e-4, 0.0, 1e-4)
        ]
        x = (np.arange(20000) + 0.5) / 20000
        assert np.mean(near[1].gap(x)) == pytest.approx(near[1].mean_gap, rel=1e-6)
        rate = (near[2].load - near[0].load) / (near[2].approach - near[0].approach)
        assert near[1].stiffness == pytest.approx(rate, rel=1e-6)
        assert np.mean(near[1].displacement(x)) == pytest.approx(0.0, abs=1e-7 * near[1].approach)

    def test_a_constant_in_its_potential_changes_nothing(self):
        one, other = (
            solve(TIPS, model, tol=1e-9, mean_pressure=0.2 * FULL)
            for model in (Waves((0.5,)), Raised())
        )
        assert other.approach == pytest.approx(one.approach, rel=1e-12)
        assert other.mean_gap == pytest.approx(one.mean_gap, rel=1e-9)

    @pytest.mark.parametrize("model", [Buried(0.8, 0.1), Buried(-0.6, 1.0)])
    def test_a_lone_body_agrees_with_an_independent_grid_and_has_no_approach(self, model):
        solution = solve(contact.Biquadratic(1.0, 0.4), model, tol=1e-8, load=0.02)
        assert fault(solution.scene, solution) == ""
        assert solution.approach is None and solution.stiffness is None

    @pytest.mark.parametrize("load", [1.0, 100.0])
    def test_a_kernel_that_varies_within_a_cell_of_the_first_grid_is_averaged_over_the_cell(
        self, load
    ):
        # The depth is small compared to the contact, and very small compared to a cell of the first
        # grid.
        solution = solve(
            contact.Parabola(1e-3), Buried(-0.65, 1e-7), E_star=1e10, tol=1e-8, load=load
        )
        assert fault(solution.scene, solution) == ""
        # If the contact were much narrower than the depth, the body would be a half-plane. If it
        # were much wider, the half-plane would be 1 + eps times as soft. The width lies between
        # these limits.
        radius = np.sqrt(4 * load * 1e-3 / (np.pi * 1e10))
        assert np.sqrt(0.35) * radius < solution.zones[0, 1] < radius

    def test_the_window_of_the_grid_of_an_isolated_body_is_sought_with_its_own_kernel(self):
        # The body is so soft that its contact is wider than the window of the grid for a
        # half-plane.
        wide = solve(
            contact.Polynomial((0.0, 0.0, 1.0, 0.3, 0.5)), Buried(300.0, 0.1), tol=1e-8, load=1e-3
        )
        assert fault(wide.scene, wide) == "" and len(wide.zones) == 1

    def test_a_kernel_too_fine_for_the_modes_of_a_zone_is_reported_after_one_grid(self):
        # A grid of four times as many points would lead to the same zones, but only after minutes.
        at, heights = (
            np.array([-1.0, -0.9996, -0.6, 0.4, 0.4004, 1.0]),
            np.array([0.3, 0.03, -0.1, -0.1, 0.0, 0.3]),
        )
        with pytest.raises(
            contact.NotConverged, match="do not resolve a column or the kernel's regular part"
        ) as refused:
            solve(
                PiecewiseLinear(at, heights, None),
                Buried(1.2, 1e-3),
                E_star=1.0,
                tol=1e-8,
                load=0.05,
            )
        assert sum("a grid of" in left for left in refused.value.best.plan.tried) == 1


class TestFullContact:
    @pytest.mark.parametrize(
        "control",
        [{"mean_pressure": 0.7 * FULL}, {"mean_pressure": 0.9 * FULL}, {"contact_fraction": 1.0}],
    )
    def test_is_refused_by_name_where_no_symbol_is_declared(self, control):
        with pytest.raises(contact.OutOfRange, match="'waves' gives a kernel and no symbol"):
            solve(WAVE, Waves((0.5,)), tol=1e-8, **control)

    def test_no_approach_reaches_the_mean_of_the_profile(self):
        with pytest.raises(contact.OutOfRange, match="the mean of the profile"):
            solve(WAVE, Waves((0.5,)), approach=0.01)

    def test_begins_where_the_declared_symbol_says(self):
        model = Coated(0.5, 0.2)
        begins = FULL / model.multiplier(np.array([2 * np.pi]), 1.0)[0]
        assert solve(WAVE, model, contact_fraction=1.0).mean_pressure == pytest.approx(
            begins, rel=1e-13
        )
        assert solve(WAVE, model, mean_pressure=0.999 * begins, tol=1e-8).contact_fraction < 1
        full = solve(WAVE, model, mean_pressure=1.5 * begins)
        x = np.linspace(-1, 1, 41)
        assert np.allclose(
            full.pressure(x), 1.5 * begins + begins * np.cos(2 * np.pi * x), rtol=0, atol=1e-13
        )

    def test_of_a_measured_trace_is_that_of_an_independent_grid(self):
        heights = 1e-3 * np.sin(7.0 * np.arange(24) ** 2)
        profile = contact.Sampled(np.arange(24) / 24, heights, period=1.0)
        scene = contact.Scene(profile, 1.0, Coated(0.9, 0.03), contact_fraction=1.0)
        full = contact.solve(scene)
        found = judge(
            replace(scene, contact_fraction=None, load=1.001 * full.load), 1.001 * full.load
        )
        assert found.fraction == 1.0
        x, size = found.x, full.max_pressure
        assert (
            np.max(np.abs(full.pressure(x) + 1e-3 * full.mean_pressure - found.pressure))
            < 1e-3 * size
        )

    def test_a_symbol_alone_gives_the_same_contact_as_its_kernel(self):
        one, other = (
            solve(TIPS, model, tol=1e-10, mean_pressure=0.3 * FULL)
            for model in (Bed(0.9, 0.05), Coated(0.9, 0.05))
        )
        assert true_error(one, other) <= one.error + other.error
        assert one.approach == pytest.approx(other.approach, rel=1e-12)

    def test_the_plan_says_what_the_operator_offers(self):
        said = {
            model.name: contact.plan(contact.Scene(WAVE, 1.0, model, mean_pressure=0.01))[
                "inverse operator"
            ]
            for model in (contact.Periodic(), Coated(0.5, 0.2), Waves((0.5,)), contact.Localized())
        }
        assert [part.used for part in said.values()] == [True, True, False, False]
        assert "no symbol" in said["waves"].reason and "has a symbol" in said["coated"].reason


class TestPath:
    @pytest.mark.parametrize(
        "kind, loads",
        [("birth", [1e-5, 1e-3]), pytest.param("merge", [0.05, 0.065], marks=pytest.mark.slow)],
    )
    def test_an_event_is_where_the_number_of_zones_changes(self, kind, loads):
        scene = contact.Scene(TIPS, 1.0, Waves(TOGETHER), load=1.0)
        found = contact.path(scene, loads).events
        assert [event.kind for event in found] == [kind]
        for event in found:
            counts = [
                len(contact.solve(replace(scene, load=event.load * (1 + h)), tol=1e-8).zones)
                for h in (-1e-4, 1e-4)
            ]
            assert counts == [len(event.before), len(event.after)]

    @pytest.mark.slow
    def test_with_a_symbol_it_ends_in_full_contact_and_without_one_is_refused_there(self):
        model, bare = Coated(0.5, 0.2), Bed(0.5, 0.2)
        begins = FULL / model.multiplier(np.array([2 * np.pi]), 1.0)[0]
        loads = [0.9 * begins, 1.2 * begins]
        event = contact.path(contact.Scene(WAVE, 1.0, model, load=1.0), loads).events[-1]
        assert event.kind == "full" and event.load == pytest.approx(begins, rel=1e-12)
        with pytest.raises(contact.OutOfRange, match="no symbol"):
            contact.path(contact.Scene(WAVE, 1.0, bare, load=1.0), loads)


@dataclass(frozen=True)
class Raised(contact.Interaction):
    """The same kernel as Waves((0.5,)), with an additional constant in its potential."""

    name = "raised"
    needs_period = True

    def kernel(self, period, unit):
        k = 2 * np.pi / period
        smooth = sie.Smooth(
            lambda x, xi: 0.5 * k * np.sin(k * (x - xi)),
            lambda x, xi: 3.0 - 0.5 * np.cos(k * (x - xi)),
        )
        return sie.hilbert(period) + smooth


def made(kernel, **attributes):
    """An interaction of a new class, with this function kernel(period, unit) and attributes."""
    body = {
        "name": "made",
        "needs_period": True,
        "kernel": lambda self, period, unit: kernel(period, unit),
        **attributes,
    }
    return type("Made", (contact.Interaction,), body)()


def waves(sine, cosine):
    """A function kernel(period, unit): Hilbert's kernel plus a smooth part with its potential."""

    def kernel(period, unit):
        k = 2 * np.pi / period
        return sie.hilbert(period) + sie.Smooth(
            lambda x, xi: sine(k, x, xi), cosine and (lambda x, xi: cosine(k, x, xi))
        )

    return kernel


def sine(k, x, xi):
    return 0.5 * k * np.sin(k * (x - xi))


def cosine(k, x, xi):
    return -0.5 * np.cos(k * (x - xi))


WRONG = {
    "no potential": made(waves(sine, None)),
    "not the derivative of its potential": made(waves(sine, lambda k, x, xi: 2 * cosine(k, x, xi))),
    "not depend on x - xi alone": made(
        waves(lambda k, x, xi: k * np.sin(k * x) * np.cos(k * xi), cosine)
    ),
    "not odd": made(waves(lambda k, x, xi: sine(k, x, xi) + np.cos(k * (x - xi)), cosine)),
    "does not repeat": made(
        lambda period, unit: replace(
            sie.hilbert(period)
            + sie.Smooth(lambda x, xi: 0.1 * (x - xi), lambda x, xi: 0.05 * (x - xi) ** 2)
        )
    ),
    "kernel.period": made(lambda period, unit: sie.cauchy()),
    "symbol is above 0": made(
        waves(lambda k, x, xi: -3 * sine(k, x, xi), lambda k, x, xi: -3 * cosine(k, x, xi))
    ),
    "does not scale with the unit": made(
        lambda period, unit: (
            sie.hilbert(period)
            + sie.Smooth(
                lambda x, xi: 0.01 * np.sin(2 * np.pi / period * (x - xi)),
                lambda x, xi: -0.01 * period / 2 / np.pi * np.cos(2 * np.pi / period * (x - xi)),
            )
        )
    ),
    "a sie.Kernel": made(lambda period, unit: None),
    "raises ValueError": made(lambda period, unit: sie.hilbert(None) + None),
    "the kernel's symbol at harmonic 1": made(
        waves(sine, cosine), symbol=lambda self, q: np.ones_like(q)
    ),
    "1 for short waves": made(
        waves(sine, cosine), symbol=lambda self, q: 1 + 0.1 * np.ones_like(q)
    ),
    "above 0: at q": made(waves(sine, cosine), symbol=lambda self, q: 1 - 2 * np.exp(-q / 50)),
    "real, finite, and of the shape": made(waves(sine, cosine), symbol=lambda self, q: 1.0),
}


@pytest.mark.parametrize("fault", WRONG)
def test_a_model_that_is_no_elastic_body_is_refused_when_the_scene_is_made(fault):
    with pytest.raises(contact.SceneError) as caught:
        contact.Scene(WAVE, 1.0, WRONG[fault], mean_pressure=0.01)
    assert fault.split("kernel.")[-1] in str(caught.value)
