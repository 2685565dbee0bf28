"""Substrates defined by a symbol: solved from light load to full contact under every control,
registered by name, and refused if they are wrong.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

import contact
from contact.model import registry
from contact.model.line_load import SmoothPart
from contact.studies.grid_judge import judge_line, judge_period
from contact.testing import SubstrateFault, check_substrate
from tests.contact.judge import solve, true_error
from tests.contact.test_own_operator import harmonic
from tests.tiers import diagonal

WAVE = contact.Sinusoid(0.01, 1.0)
TIPS = contact.Fourier(1.0, (-0.01, 0.006, 0.002), (0.002, -0.003, 0.001))


@dataclass(frozen=True)
class Soft(contact.Substrate):
    """Substrate with the symbol L = 1 + eps exp(-q h) and the kernel 1/r + eps r/(r^2 + h^2)."""

    eps: float = 0.8
    h: float = 0.1
    name = "soft"

    def symbol(self, q):
        return 1 + self.eps * np.exp(-q * self.h)


@dataclass(frozen=True)
class Grounded(contact.Substrate):
    """Substrate with the symbol L = tanh(q h), the kernel (pi/2h)/sinh(pi r/2h) and the potential
    ln tanh(pi r/4h).
    """

    h: float = 0.1
    name = "grounded"

    @property
    def compression(self):
        return self.h

    def symbol(self, q):
        return np.tanh(q * self.h)


BODIES = (Soft(), Soft(-0.6, 0.06), Grounded(), Grounded(1.0))
FULL = {body: np.pi * 0.01 / body.symbol(np.array([2 * np.pi]))[0] for body in BODIES}


def held(profile, body, share_of_full, **control):
    """Returns a periodic scene. Its mean pressure is `share_of_full` of the mean pressure at
    which the wave comes into full contact.
    """
    return contact.Scene(
        profile,
        1.0,
        contact.Periodic(),
        substrate=body,
        mean_pressure=share_of_full * FULL[body],
        **control,
    )


class TestKernelOfALine:
    R = np.concatenate(([0.0], np.geomspace(1e-7, 1e12, 400)))

    def test_is_that_of_the_closed_form_near_and_far(self):
        part, r = SmoothPart.of(Soft(0.8, 1.0).symbol, grounded=False), self.R
        assert np.abs((part.value(r) - 0.8 * r / (r * r + 1)) * np.maximum(r, 1)).max() < 1e-13
        assert np.abs(part.potential(r) - 0.4 * np.log1p(r * r)).max() < 1e-13
        primitive = 0.4 * (r * np.log1p(r * r) - 2 * r + 2 * np.arctan(r))
        assert np.abs((part.primitive(-r) + primitive) / np.maximum(r, 1)).max() < 1e-13

    def test_of_a_body_with_a_base_vanishes_far_away(self):
        part, r = SmoothPart.of(Grounded(1e-6).symbol, grounded=True), 1e-6 * self.R[1:]
        found = np.log(r / part.scale) + part.potential(r)
        assert np.abs(found - np.log(np.tanh(np.pi * r / 4e-6))).max() < 1e-13

    def test_of_unlike_scales_is_the_sum_of_both(self):
        part = SmoothPart.of(
            lambda q: 1 + 0.5 * np.exp(-q) - 0.3 * np.exp(-1e-5 * q), grounded=False
        )
        r = self.R
        expected = 0.5 * r / (r * r + 1) - 0.3 * r / (r * r + 1e-10)
        assert np.abs((part.value(r) - expected) * np.maximum(r, 1e-5)).max() < 1e-13


class TestASubstrate:
    @pytest.mark.parametrize("body", BODIES)
    def test_in_full_contact_has_the_pressure_of_its_symbol_and_gives_way_by_its_compression(
        self, body
    ):
        begins = FULL[body]
        full = contact.solve(held(WAVE, body, 1.5))
        x = np.linspace(-1, 1, 41)
        assert np.allclose(
            full.pressure(x), 1.5 * begins + begins * np.cos(2 * np.pi * x), rtol=0, atol=1e-13
        )
        assert full.approach == pytest.approx(
            0.01 + 2 * (body.compression or 0.0) * 1.5 * begins, rel=1e-12
        )
        if body.compression:
            again = contact.solve(
                replace(held(WAVE, body, 1.5), mean_pressure=None, approach=full.approach)
            )
            assert (
                again.mean_pressure == pytest.approx(1.5 * begins, rel=1e-12)
                and len(again.zones) == 0
            )
            assert again.stiffness == pytest.approx(0.5 / body.compression, rel=1e-12)

    @pytest.mark.parametrize(("body", "share"), diagonal(BODIES, [1e-3, 0.3]))
    def test_has_the_pressure_of_a_half_plane_under_an_equivalent_profile(self, body, share):
        solution = contact.solve(held(TIPS, body, share), tol=1e-9)
        assert solution.certificate.holds
        # The first 96 waves of the pressure make the equivalent profile of a half-plane. Higher
        # waves are neglected: for them L is nearly 1, or the pressure has hardly any. `left`
        # bounds this error.
        n = np.arange(1, 97)
        excess = body.symbol(2 * np.pi * n) - 1
        p = np.array([harmonic(solution, k) for k in n])
        added = 4 * excess * p / (2 * np.pi * n)
        cosine, sine = np.zeros(len(n)), np.zeros(len(n))
        cosine[:3], sine[:3] = TIPS.cosine, TIPS.sine
        plain = contact.Fourier(1.0, tuple(cosine + added.real), tuple(sine - added.imag))
        exact = solve(plain, contact.Periodic(), tol=1e-11, load=solution.load)
        left = np.abs(body.symbol(2 * np.pi * np.array([97.0])) - 1)[0]
        assert true_error(solution, exact) <= solution.error + exact.error + left

    @pytest.mark.parametrize(
        ("body", "control"),
        diagonal(BODIES, ["load", "approach", "contact_fraction", "half_width"]),
    )
    def test_is_the_same_under_every_control(self, body, control):
        given = contact.solve(held(WAVE, body, 0.4), tol=1e-10)
        value = (
            0.5 * float(np.diff(given.zones)[0, 0])
            if control == "half_width"
            else getattr(given, control)
        )
        again = contact.solve(
            replace(held(WAVE, body, 0.4), mean_pressure=None, **{control: value}), tol=1e-9
        )
        assert again.load == pytest.approx(given.load, rel=1e-8)
        assert again.approach == pytest.approx(given.approach, rel=1e-8)

    @pytest.mark.parametrize("body", BODIES)
    def test_agrees_with_an_independent_grid(self, body):
        solution = contact.solve(held(TIPS, body, 0.3))
        grid = judge_period(TIPS.height, (-0.5, 0.5), 1.0, body.symbol, solution.load, 2048)
        assert np.count_nonzero((solution.pressure(grid.x) > 0) != grid.contact) <= 4 * len(
            solution.zones
        )
        height = np.asarray(TIPS.height(grid.x))
        mean = 2 * (body.compression or 0.0) * solution.mean_pressure
        assert solution.approach == pytest.approx(grid.level + mean - height.min(), rel=2e-3)
        assert np.mean(solution.gap(grid.x)) == pytest.approx(solution.mean_gap, rel=1e-3)

    def test_in_isolated_contact_agrees_with_an_independent_grid(self):
        body = Soft(0.8, 0.1)
        scene = contact.Scene(
            contact.Biquadratic(1.0, 0.4), 1.0, contact.Isolated(), substrate=body, load=0.02
        )
        solution = contact.solve(scene)
        lo, hi = solution.zones[0, 0], solution.zones[-1, 1]
        window = 1.6 * lo - 0.6 * hi, 1.6 * hi - 0.6 * lo
        grid = judge_line(
            scene.profile.height, window, 1.0, lambda lag: 0.4 * np.log(lag**2 + 0.01), 0.02
        )
        assert np.count_nonzero((solution.pressure(grid.x) > 0) != grid.contact) <= 8
        assert solution.approach is None

    def test_with_a_base_has_an_approach_in_isolated_contact_measured_from_the_base(self):
        scene = contact.Scene(
            contact.Parabola(1.0), 1.0, contact.Isolated(), substrate=Grounded(0.1), load=0.01
        )
        solution = contact.solve(scene, tol=1e-10)
        # Far away the displacement is zero. Near the contact it equals a quadrature of the
        # pressure with the closed form of the potential.
        assert solution.displacement(np.array([3.0]))[0] == pytest.approx(0.0, abs=1e-14)
        again = contact.solve(replace(scene, load=None, approach=solution.approach), tol=1e-9)
        assert again.load == pytest.approx(0.01, rel=1e-8)
        t, weights = np.polynomial.legendre.leggauss(200)
        end = solution.zones[0, 1]
        angle = 0.25 * np.pi * (1 + t)
        x = end * np.sin(angle)
        p = solution.pressure(x) * np.cos(angle) * end * 0.25 * np.pi * weights
        at = np.array([2 * end])
        u = (
            -2
            / np.pi
            * sum(p @ np.log(np.tanh(np.pi * np.abs(at - side * x) / 0.4)) for side in (-1, 1))
        )
        assert solution.displacement(at)[0] == pytest.approx(u, rel=1e-9)

    @pytest.mark.parametrize("body", BODIES)
    def test_in_localized_contact_converges_to_periodic_contact_with_more_neighbours(self, body):
        exact = contact.solve(held(WAVE, body, 0.2), tol=1e-10)
        off = []
        for m in (4, 8):
            near = contact.solve(
                replace(
                    held(WAVE, body, 0.2),
                    interaction=contact.Localized("self-consistent", neighbours=m),
                ),
                tol=1e-10,
            )
            off.append(np.abs(near.zones - exact.zones).max())
        # The error of the model falls as (2m + 1)^-3 with m neighbours (docs/theory.md). It is
        # negligible where the body has a base.
        assert off[1] < 1.1 * (9 / 17) ** 3 * off[0] + 1e-9 and off[0] < 1e-4

    def test_half_plane_given_explicitly_gives_bitwise_the_same_zones(self):
        plain = contact.Scene(TIPS, 1.0, contact.Periodic(), mean_pressure=0.01)
        assert np.array_equal(
            contact.solve(plain).zones,
            contact.solve(replace(plain, substrate=contact.HalfPlane())).zones,
        )


@pytest.fixture
def registered():
    contact.register_substrate("test-soft")(Soft)
    yield
    registry.SUBSTRATES.forget("test-soft")
    Soft.name = "soft"


class TestByItsName:
    def test_it_is_made_and_listed(self, registered):
        assert contact.substrate("test-soft", eps=0.5, h=0.2) == Soft(0.5, 0.2)
        assert {"half-plane", "test-soft"} <= set(contact.substrates())

    def test_a_scene_file_says_it(self, registered, tmp_path):
        path = tmp_path / "scene.toml"
        path.write_text(
            '[profile]\nshape = "sinusoid"\namplitude = 0.01\nperiod = 1.0\n[material]\nE_star = 1.0\n[interaction]\nmodel = "periodic"\n'
            '[substrate]\nmodel = "test-soft"\neps = 0.5\n[law]\nmodel = "frictionless"\n[control]\nmean_pressure = 0.01\n'
        )
        scene = contact.load_scene(path)
        assert scene.substrate == Soft(0.5) and scene.law == contact.Frictionless()
        path.write_text(path.read_text().replace("test-soft", "tset-soft"))
        with pytest.raises(
            contact.SceneError,
            match=r"\[substrate\] model = 'tset-soft' is not known \(did you mean 'test-soft'",
        ):
            contact.load_scene(path)


def body(symbol, compression=None):
    """A substrate with this symbol(q)."""
    attributes = {"name": "made", "symbol": lambda self, q: symbol(q), "compression": compression}
    return type("Made", (contact.Substrate,), attributes)()


WRONG = {
    "real, finite": body(lambda q: 1 + 1j * np.exp(-q)),
    "of the shape of q": body(lambda q: 1.0),
    "overflow": body(lambda q: np.sinh(q) / np.cosh(q), 1.0),
    "raises TypeError": body(lambda q: 1 + None),
    "above 0": body(lambda q: 1 - 2 * np.exp(-q)),
    "1 for short waves, here at": body(lambda q: 1.5 + 0 * q),
    "like q^-1": body(lambda q: 1 + 1 / (1 + q)),
    "a body on a rigid base": body(np.tanh),
    "about 1 m": body(np.tanh, 2.0),
    "a length of at least 0": body(np.tanh, -1.0),
    "element by element": body(lambda q: 1 + np.exp(-np.abs(q - q.ravel()[0]))),
}


@pytest.mark.parametrize("fault", WRONG)
def test_a_symbol_of_no_elastic_body_is_refused_with_its_fault(fault):
    with pytest.raises(contact.SceneError) as caught:
        contact.Scene(WAVE, 1.0, contact.Periodic(), substrate=WRONG[fault], mean_pressure=0.01)
    assert fault in str(caught.value)
    assert not check_substrate(WRONG[fault], raises=False).ok


def test_check_substrate_raises_the_fault():
    assert all(check_substrate(one).ok for one in (*BODIES, contact.HalfPlane()))
    with pytest.raises(SubstrateFault, match="a body on a rigid base"):
        check_substrate(WRONG["a body on a rigid base"])
    with pytest.raises(SubstrateFault, match="contact.Substrate"):
        check_substrate(3)


@pytest.mark.parametrize("wrong", [None, 3, Soft, "half-plane"])
def test_a_value_that_is_no_substrate_is_refused(wrong):
    with pytest.raises(contact.SceneError, match="substrate = "):
        contact.Scene(WAVE, 1.0, contact.Periodic(), substrate=wrong, mean_pressure=0.01)


def test_a_datum_beside_a_base_and_a_kernel_beside_a_substrate_are_refused():
    with pytest.raises(contact.SceneError, match="measured from its base"):
        contact.Scene(
            contact.Parabola(1.0), 1.0, contact.Isolated(datum=1.0), substrate=Grounded(), load=0.01
        )
    from contact.studies.scene_families import Bed

    with pytest.raises(contact.SceneError, match="its own kernel"):
        contact.Scene(WAVE, 1.0, Bed(0.5, 0.1), substrate=Soft(), mean_pressure=0.01)
