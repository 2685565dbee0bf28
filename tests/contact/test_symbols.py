"""Bodies given by a user's symbol L(q), from light load to full contact, under every control; and
narrow gaps as slits under their kernels.

Two references are used. One is an independent grid with the same symbol
(contact.studies.grid_judge). The other one is to full accuracy: the formulation by the pressure
on zones against the formulation by the slope of the gaps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

import contact
import sie
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.studies.grid_judge import judge_line, judge_period
from tests.contact.judge import solve, true_error
from tests.tiers import diagonal

TIPS = contact.Fourier(1.0, (-0.004, 0.0024, 0.0008), (0.0008, -0.0012, 0.0004))
WAVE = contact.Sinusoid(0.004, 1.0)
CONTROLS = ("load", "approach", "contact_fraction")


@dataclass(frozen=True)
class Body(contact.Interaction):
    """A body with the symbol L = 1 + eps exp(-q depth)."""

    eps: float
    depth: float
    name = "body"
    needs_period = True

    def symbol(self, q):
        return 1 + self.eps * np.exp(-q * self.depth)


@dataclass(frozen=True)
class KernelAlone(contact.Interaction):
    """The body of `Body` without its symbol: its kernel is Hilbert's kernel plus a geometric
    series in closed form.
    """

    eps: float
    depth: float
    name = "kernel alone"
    needs_period = True

    def kernel(self, period, unit):
        k, eps = 2 * np.pi / period, self.eps
        r = np.exp(-k * self.depth / unit)

        def value(x, xi):
            return k * eps * r * np.sin(k * (x - xi)) / (1 - 2 * r * np.cos(k * (x - xi)) + r * r)

        return sie.hilbert(period) + sie.Smooth(
            value, lambda x, xi: 0.5 * eps * np.log(1 - 2 * r * np.cos(k * (x - xi)) + r * r)
        )


@dataclass(frozen=True)
class Bonded(contact.Interaction):
    """A layer bonded to a rigid base. For long waves its symbol L is proportional to s = q h, or
    to s^3 if nu = 1/2.
    """

    thickness: float
    nu: float
    name = "bonded"
    needs_period = True

    def symbol(self, q):
        s, k = np.minimum(q * self.thickness, 40.0), 3 - 4 * self.nu
        return (2 * k * np.sinh(2 * s) - 4 * s) / (2 * k * np.cosh(2 * s) + 1 + k * k + 4 * s * s)


@dataclass(frozen=True)
class Lone(contact.Interaction):
    """A body for isolated contact, with the kernel K = 1/r + eps r/(r^2 + depth^2)."""

    eps: float
    depth: float
    datum: float | None = 10.0
    name = "lone"

    def kernel(self, period, unit):
        eps, depth = self.eps, self.depth / unit
        smooth = sie.Smooth(
            lambda x, xi: eps * (x - xi) / ((x - xi) ** 2 + depth**2),
            lambda x, xi: self.rest((x - xi) * unit),
        )
        return sie.cauchy(self.datum / unit) + smooth

    def rest(self, lag):
        return 0.5 * self.eps * np.log(lag**2 + self.depth**2)


def full_pressure(profile, body):
    return contact.solve(contact.Scene(profile, 1.0, body, contact_fraction=1.0)).mean_pressure


def agrees_with_a_grid(solution, n=1024):
    """Asserts that contact, pressure and approach agree with an independent grid, within the
    error of its cells.
    """
    profile, body = solution.scene.profile, solution.scene.interaction
    found = judge_period(
        profile.height, (profile.x0, profile.x0 + 1.0), 1.0, body.symbol, solution.load, n
    )
    assert found.settled
    cells = np.count_nonzero((solution.pressure(found.x) > 0) != found.contact)
    assert cells <= 4 * (len(solution.zones) + 1)
    # At a zone end the grid's pressure has an error of the order of the square root of a cell.
    # Its mean error is of the order of a cell divided by the contact width.
    off = np.abs(solution.pressure(found.x) - found.pressure)
    assert off.sum() < max(0.5 / np.count_nonzero(found.contact), 0.005) * found.pressure.sum()
    level = found.level - profile.height(found.x).min()
    assert solution.approach == pytest.approx(level, rel=2e-3)


class TestFromLightLoadToFullContact:
    @pytest.mark.parametrize(
        ("body", "share"),
        diagonal(
            [Body(-0.5, 0.05), Body(2.0, 0.3), Bonded(0.05, 0.3), Bonded(0.05, 0.5)],
            [1e-3, 0.2, 0.6, 0.95, 0.9999],
        ),
        ids=str,
    )
    def test_the_contact_agrees_with_an_independent_grid(self, body, share):
        solution = solve(TIPS, body, tol=1e-8, mean_pressure=share * full_pressure(TIPS, body))
        assert solution.certificate.holds and solution.error <= 1e-8
        agrees_with_a_grid(solution)

    @pytest.mark.slow
    @pytest.mark.parametrize("share", [1e-3, 0.5, 0.98])
    @pytest.mark.parametrize("eps", [-0.5, 0.5, 2.0])
    @pytest.mark.parametrize("depth", [0.01, 0.1, 1.0])
    def test_the_contact_agrees_with_the_grid_for_shallow_and_deep_symbols(self, eps, depth, share):
        body = Body(eps, depth)
        solution = solve(TIPS, body, tol=1e-8, mean_pressure=share * full_pressure(TIPS, body))
        assert solution.certificate.holds and solution.error <= 1e-8
        agrees_with_a_grid(solution, 2048)

    @pytest.mark.parametrize(
        ("body", "share"), diagonal([Body(0.8, 0.1), Bonded(0.1, 0.3)], [0.01, 0.4, 0.98]), ids=str
    )
    def test_every_control_leads_back_to_the_same_contact(self, body, share):
        given = solve(TIPS, body, tol=1e-10, mean_pressure=share * full_pressure(TIPS, body))
        for control in CONTROLS:
            again = solve(TIPS, body, tol=1e-8, **{control: getattr(given, control)})
            assert (
                again.certificate.holds
                and true_error(again, given) <= again.error + given.error + 1e-9
            ), control

    @pytest.mark.parametrize("half_width", [0.01, 0.3, 0.49])
    def test_a_half_width_leads_to_a_load_that_leads_back_to_it(self, half_width):
        given = solve(WAVE, Body(0.8, 0.1), tol=1e-9, half_width=half_width)
        again = solve(WAVE, Body(0.8, 0.1), tol=1e-9, load=given.load)
        assert again.zones == pytest.approx(given.zones, rel=1e-7)

    def test_full_contact_begins_at_the_pressure_that_the_symbol_gives(self):
        body = Body(0.8, 0.1)
        begins = full_pressure(TIPS, body)
        x = np.arange(4096) / 4096
        waves = np.fft.rfft(TIPS.height(x))
        q = 2 * np.pi * np.arange(1, len(waves))
        pressure = -np.fft.irfft(np.append(0.0, q * waves[1:] / (2 * body.symbol(q))))
        assert begins == pytest.approx(-pressure.min(), rel=1e-5)
        assert solve(TIPS, body, mean_pressure=(1 + 1e-9) * begins).contact_fraction == 1
        nearly = solve(TIPS, body, tol=1e-6, mean_pressure=(1 - 1e-9) * begins)
        assert 1 - 1e-3 < nearly.contact_fraction < 1 and nearly.certificate.holds


class TestTheTwoFormulations:
    @pytest.mark.parametrize(
        ("case", "body"),
        diagonal(
            [(TIPS, 0.8), (TIPS, 0.97), (WAVE, 0.9)],
            [Body(-0.5, 0.05), Body(2.0, 0.1), Body(0.5, 1.0)],
        ),
    )
    def test_gaps_and_zones_give_the_same_contact(self, case, body):
        profile, share = case
        pressure = share * full_pressure(profile, body)
        gaps = solve(profile, body, tol=1e-10, mean_pressure=pressure)
        # Without a symbol there is no inverse operator, so the unknowns are zones.
        zones = solve(profile, KernelAlone(body.eps, body.depth), tol=1e-10, mean_pressure=pressure)
        assert isinstance(gaps.fields, GapFields) and isinstance(zones.fields, ZoneFields)
        assert true_error(zones, gaps) <= zones.error + gaps.error
        for name in ("approach", "mean_gap", "stiffness", "max_pressure"):
            assert getattr(gaps, name) == pytest.approx(getattr(zones, name), rel=1e-8), name
        assert gaps.zone_loads == pytest.approx(zones.zone_loads, rel=1e-8)
        x = np.linspace(-0.5, 0.5, 101)
        assert gaps.gap(x) == pytest.approx(zones.gap(x), abs=1e-9 * np.ptp(profile.height(x)))

    def test_gaps_with_a_kink_give_the_same_contact_as_zones(self):
        profile = contact.Parabola(10.0, period=1.0)  # its valleys have kinks
        gaps = solve(profile, Body(0.8, 0.1), tol=1e-9, contact_fraction=0.9)
        zones = solve(profile, KernelAlone(0.8, 0.1), tol=1e-9, load=gaps.load)
        assert isinstance(gaps.fields, GapFields) and isinstance(zones.fields, ZoneFields)
        assert true_error(zones, gaps) <= zones.error + gaps.error


class TestCompression:
    """On a layer the displacement has a mean: the uniform compression under the mean pressure."""

    def scene(self, share=None, **control):
        scene = contact.Scene(
            TIPS, 1.0, contact.Periodic(), substrate=contact.Layer(0.1, 0.3), contact_fraction=1.0
        )
        control = control or {"load": share * contact.solve(scene).load}
        return replace(scene, contact_fraction=None, **control)

    @pytest.mark.parametrize("share", [0.01, 0.3, 0.9, 0.999])
    def test_the_mean_displacement_is_the_uniform_compression(self, share):
        given = contact.solve(self.scene(share), tol=1e-10)
        assert isinstance(given.fields, GapFields) == (share > 0.5) and given.certificate.holds
        x = (np.arange(4096) + 0.5) / 4096 - 0.5
        sunk = 2 * given.scene.substrate.compression * given.mean_pressure
        assert np.mean(given.displacement(x)) == pytest.approx(
            sunk, rel=1e-6, abs=1e-7 * given.approach
        )
        again = contact.solve(self.scene(approach=given.approach), tol=1e-8)
        assert again.load == pytest.approx(given.load, rel=1e-7)

    def test_the_stiffness_is_the_derivative_of_the_load_by_the_approach(self):
        near = [contact.solve(self.scene(0.9 * (1 + h)), tol=1e-11) for h in (-1e-4, 0.0, 1e-4)]
        assert isinstance(near[1].fields, GapFields)
        rate = (near[2].load - near[0].load) / (near[2].approach - near[0].approach)
        assert near[1].stiffness == pytest.approx(rate, rel=1e-6)


class TestNarrowGaps:
    # The shares of the pressure at full contact lie just below the merger of the two zones.
    @pytest.mark.parametrize(
        "body, share",
        [(Body(0.8, 0.1), 0.4576), (KernelAlone(0.8, 0.1), 0.4576), (Body(-0.5, 0.02), 0.33657)],
        ids=str,
    )
    def test_a_narrow_gap_between_zones_is_solved_as_a_slit(self, body, share):
        full = full_pressure(TIPS, Body(body.eps, body.depth))
        solution = solve(TIPS, body, tol=1e-8, mean_pressure=share * full)
        assert isinstance(solution.fields.density, sie.SlitDensity) and solution.certificate.holds
        found = judge_period(
            TIPS.height, (-0.5, 0.5), 1.0, Body(body.eps, body.depth).symbol, solution.load, 2048
        )
        assert abs(found.fraction - solution.contact_fraction) < 4 / 2048

    def test_solving_with_and_without_slits_gives_the_same_contact(self, monkeypatch):
        full = full_pressure(TIPS, Body(0.8, 0.1))
        slit = solve(TIPS, Body(0.8, 0.1), tol=1e-9, mean_pressure=0.4576 * full)
        monkeypatch.setattr("sie.slits.system.merge", lambda *_: None)
        apart = solve(TIPS, Body(0.8, 0.1), tol=1e-7, mean_pressure=0.4576 * full)
        assert isinstance(slit.fields.density, sie.SlitDensity) and not isinstance(
            apart.fields.density, sie.SlitDensity
        )
        assert true_error(slit, apart) <= slit.error + apart.error

    def test_a_narrow_gap_in_isolated_contact_is_solved_as_a_slit(self):
        profile, body = contact.Biquadratic(1.0, 0.4), Lone(0.8, 0.3)
        solution = solve(profile, body, tol=1e-8, load=0.017878)
        assert isinstance(solution.fields.density, sie.SlitDensity) and solution.certificate.holds
        found = judge_line(profile.height, (-0.8, 0.8), 1.0, body.rest, solution.load, 1024)
        ends = found.x[np.flatnonzero(found.contact)[[0, -1]]]
        assert solution.zones[[0, -1], [0, 1]] == pytest.approx(ends, abs=4 * 1.6 / 1024)

    def test_a_rough_trace_is_solved_at_every_load(self):
        rng = np.random.default_rng(5)
        heights = 1e-3 * rng.standard_normal(40)
        profile = contact.Sampled(np.arange(40) / 40, heights, period=1.0)
        body = Body(1.0, 0.03)
        for share in (0.02, 0.3, 0.9):
            solution = solve(
                profile, body, tol=1e-7, mean_pressure=share * full_pressure(profile, body)
            )
            assert solution.certificate.holds and solution.error <= 1e-7
            found = judge_period(
                profile.height,
                (profile.x0, profile.x0 + 1.0),
                1.0,
                body.symbol,
                solution.load,
                1024,
            )
            assert (
                abs(found.fraction - solution.contact_fraction)
                < 2 * (len(solution.zones) + 1) / 1024
            )


def test_isolated_contact_is_the_same_by_load_and_by_approach():
    scene = contact.Scene(contact.Biquadratic(1.0, 0.4), 1.0, Lone(0.8, 0.3), load=0.05)
    given = contact.solve(scene, tol=1e-9)
    again = contact.solve(replace(scene, load=None, approach=given.approach), tol=1e-8)
    assert again.load == pytest.approx(given.load, rel=1e-7)
