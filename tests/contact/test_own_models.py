"""User-defined profiles and interactions, against exact solutions that the comments derive."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import i0, i1

import contact
import sie
from contact.model import registry
from contact.model.interactions.base import Interaction
from contact.reference import exact
from contact.testing import check_profile
from tests.contact.judge import solve, true_error

ISOLATED = contact.Isolated()
WITHIN = np.linspace(-0.99, 0.99, 40)


@dataclass(frozen=True)
class Cosh(contact.Profile):
    """The profile s (cosh(x/s) - 1), without a method for the slope."""

    scale: float

    def height(self, x):
        return self.scale * (np.cosh(np.asarray(x) / self.scale) - 1)

    symmetric = True
    summits = np.zeros(1)


@dataclass(frozen=True)
class Exponential(contact.Profile):
    """The profile s (exp(x/s) - x/s - 1): steep on the right, flat on the left."""

    scale: float

    def height(self, x):
        t = np.asarray(x) / self.scale
        return self.scale * (np.expm1(t) - t)

    def slope(self, x):
        return np.expm1(np.asarray(x) / self.scale)


@dataclass(frozen=True)
class Tilted(contact.Profile):
    """A tilted flat punch with sharp corners: its left corner touches first."""

    tilt: float
    width: float

    def height(self, x):
        x = np.asarray(x, dtype=float)
        inside = np.abs(x) <= 0.5 * self.width * (1 + 1e-12)
        return np.where(inside, self.tilt * x, np.inf)

    def slope(self, x):
        return np.full(np.shape(x), self.tilt)

    @property
    def support(self):
        return -0.5 * self.width, 0.5 * self.width


@dataclass(frozen=True)
class Rounded(contact.Profile):
    """A profile that is flat from its sharp left corner to 0, and a parabola to the right of 0."""

    radius: float
    width: float

    def height(self, x):
        x = np.asarray(x, dtype=float)
        inside = np.abs(x) <= 0.5 * self.width * (1 + 1e-12)
        return np.where(inside, np.maximum(x, 0) ** 2 / (2 * self.radius), np.inf)

    def slope(self, x):
        return np.maximum(np.asarray(x, dtype=float), 0) / self.radius

    @property
    def support(self):
        return -0.5 * self.width, 0.5 * self.width

    @property
    def jumps(self):
        return np.array([[0.0, 2, 1 / self.radius]])


def answer_of(zone, load, pressure):
    """An exact one-zone solution for `true_error`. pressure: function of the scaled position."""
    t = np.linspace(-1, 1, 2001)[1:-1]
    return SimpleNamespace(
        zones=np.array([zone]),
        zone_widths=np.array([zone[1] - zone[0]]),
        load=load,
        max_pressure=float(np.max(pressure(t))),
        pressure_at=lambda t, zone=0: pressure(np.asarray(t)),
    )


class TestCosh:
    # The load of a zone of half width a is P = (E*/2) int x f'/sqrt(a^2 - x^2) dx (Shtaerman). Here
    # it is (pi E*/2) a I_1(a/s).
    @pytest.mark.parametrize("a", [1e-3, 0.3, 2.0])
    def test_the_derived_slope_gives_the_load_of_the_closed_form(self, a):
        load = 0.5 * np.pi * a * i1(a)
        for control in ({"load": load}, {"half_width": a}):
            solution = solve(Cosh(1.0), ISOLATED, tol=1e-8, **control)
            assert abs(solution.zones[0, 1] / a - 1) < 1e-8
            assert abs(solution.load / load - 1) < 2e-8
        assert solution.plan["numerical slope"].used

    def test_once_registered_the_profile_is_made_by_name_and_passes_its_check(self):
        contact.register_profile("cosh-of-the-test")(Cosh)
        try:
            made = contact.profile("cosh-of-the-test", scale=2.0)
            assert made == Cosh(2.0)
            assert check_profile(made).ok
            with pytest.raises(contact.SceneError):
                contact.profile("cosh-of-the-test", size=2.0)
        finally:
            registry.PROFILES.forget("cosh-of-the-test")


class TestExponential:
    # The zone is [m - w, m + w], in units of s. The condition e^m I_0(w) = 1 makes the pressure
    # bounded at both ends. The load is P = (pi E*/2) w e^m I_1(w).
    @pytest.mark.parametrize("w", [1e-4, 0.1, 1.0, 4.0])
    def test_an_asymmetric_zone_is_where_the_pressure_is_bounded_at_both_ends(self, w):
        middle = -np.log(i0(w))
        load = 0.5 * np.pi * w * i1(w) / i0(w)
        solution = solve(Exponential(1.0), ISOLATED, tol=1e-8, load=load)
        assert np.max(np.abs(solution.zones[0] - [middle - w, middle + w])) < 1e-8 * 2 * w
        assert abs(solution.load / load - 1) < 1e-12


class TestTiltedPunch:
    # The transform T of sqrt((1-t)/(1+t)) is 1. So the pressure between the left corner -h and the
    # free end b is (E*/2) tilt sqrt((b-x)/(x+h)), and the load is P = (pi E*/4) tilt (b+h).
    @pytest.mark.parametrize("share", [0.01, 0.5, 0.98])
    def test_a_light_load_touches_from_one_corner_with_one_free_end(self, share):
        tilt, h = 0.01, 1.0
        load = share * 0.5 * np.pi * tilt * h
        solution = solve(Tilted(tilt, 2 * h), ISOLATED, tol=1e-9, load=load)
        answer = answer_of(
            [-h, -h + 2 * h * share], load, lambda t: 0.5 * tilt * np.sqrt((1 - t) / (1 + t))
        )
        answer.max_pressure = np.inf
        assert solution.max_pressure == np.inf
        assert true_error(solution, answer, WITHIN) <= solution.error <= 1e-9

    @pytest.mark.parametrize("share", [1.02, 2.0, 100.0])
    def test_under_a_heavy_load_both_corners_touch_and_are_singular(self, share):
        tilt, h = 0.01, 1.0
        load = share * 0.5 * np.pi * tilt * h
        solution = solve(Tilted(tilt, 2 * h), ISOLATED, tol=1e-9, load=load)
        answer = answer_of(
            [-h, h], load, lambda t: (load / (np.pi * h) - 0.5 * tilt * t) / np.sqrt(1 - t * t)
        )
        answer.max_pressure = np.inf
        assert true_error(solution, answer, WITHIN) <= solution.error <= 1e-9


class TestRoundedPunch:
    @pytest.mark.parametrize("b", [1e-3, 0.1, 0.7])
    def test_is_singular_at_its_corner_and_bounded_on_its_round_side(self, b):
        # On the zone x = m + w cos(th) the pressure obeys T p = g = max(x, 0)/2R, for E* = 1. Let
        # x = 0 at th0, and let p be the sum of c_j T_j(t)/sqrt(1 - t^2) with t = cos(th). Then
        # P = pi w c_0, and c_j = -(2/pi) int_0^th0 g sin(j th) sin(th) dth for j > 0. The intensity
        # at b vanishes if the sum of all c_j is zero. So P = w int_0^th0 g (1 + cos th) dth.
        radius, left = 2.0, -1.0
        m, w = 0.5 * (b + left), 0.5 * (b - left)
        theta = np.arccos(-m / w)
        nodes, weights = np.polynomial.legendre.leggauss(60)
        angle = 0.5 * theta * (1 + nodes)
        g = 0.5 * (m + w * np.cos(angle)) / radius
        load = w * float(np.sum(0.5 * theta * weights * g * (1 + np.cos(angle))))
        solution = solve(Rounded(radius, 2.0), ISOLATED, tol=1e-9, load=load)
        assert solution.zones[0, 0] == -1.0
        assert abs(solution.zones[0, 1] - b) < 1e-9 * 2 * w
        assert solution.max_pressure == np.inf
        assert abs(float(solution.pressure_at(1.0))) < 1e-9 * load


@dataclass(frozen=True)
class Bedded(Interaction):
    """A half-plane on a soft bed, with the kernel 1/(x - xi) + c (x - xi); c in 1/m^2."""

    c: float
    name = "bedded"

    def kernel(self, period, unit):
        c = self.c * unit**2
        return sie.cauchy() + sie.Smooth(
            lambda x, xi: c * (x - xi), lambda x, xi: 0.5 * c * (x - xi) ** 2
        )


@dataclass(frozen=True)
class Breathing(Interaction):
    """A periodic substrate with the kernel (pi/L) cot(pi r/L) + c k sin(k r).

    Here r is the distance x - xi, L the period, and k = 2 pi/L.
    """

    c: float
    name = "breathing"
    needs_period = True

    @property
    def images(self):
        return None

    def kernel(self, period, unit):
        k = 2 * np.pi / period
        soft = sie.Smooth(
            lambda x, xi: self.c * k * np.sin(k * (x - xi)),
            lambda x, xi: -self.c * np.cos(k * (x - xi)),
        )
        return sie.hilbert(period) + soft


class TestOwnInteractions:
    @pytest.mark.parametrize("c", [-0.5, 0.0, 0.3])
    def test_a_bed_under_a_parabola_changes_its_radius(self, c):
        # For a symmetric zone the integral of p(xi) (x - xi) is P x. So the curvature 1/R becomes
        # 1/R - 2 c P/(pi E*).
        load, radius = 0.4, 1.0
        curvature = 1 / radius - 2 * c * load / np.pi
        a = np.sqrt(4 * load / (np.pi * curvature))
        answer = answer_of([-a, a], load, lambda t: 0.5 * curvature * a * np.sqrt(1 - t * t))
        solution = solve(contact.Parabola(radius), Bedded(c), tol=1e-9, load=load)
        assert true_error(solution, answer) <= solution.error <= 1e-9

    def test_several_zones_under_a_user_defined_kernel_are_found_too(self):
        solution = solve(contact.Biquadratic(1.0, 0.4), Bedded(-0.5), tol=1e-8, load=2e-3)
        plain = solve(contact.Biquadratic(1.0, 0.4), ISOLATED, tol=1e-8, load=2e-3)
        assert len(solution.zones) == 2
        assert abs(solution.load / 2e-3 - 1) < 1e-9
        assert np.max(np.abs(solution.zones - plain.zones)) > 1e-6

    @pytest.mark.parametrize("c", [-0.2, 0.2])
    def test_a_periodic_kernel_with_a_regular_part_changes_the_wave(self, c):
        # For an even p the integral of p(xi) sin k(x - xi) is S sin kx, where S is the integral of
        # p(xi) cos k xi. So the amplitude D becomes D - 2 c S/(pi E*). The exact solution is
        # Westergaard's for the changed amplitude, and S is computed from its pressure.

        changed = exact.Westergaard(0.01, 1.0, 1.0, 0.2)
        nodes = np.cos((np.arange(200) + 0.5) * np.pi / 200)
        p = changed.pressure_at(nodes) * np.sqrt(1 - nodes**2) * 0.2 * np.pi / 200
        share = float(np.sum(p * np.cos(2 * np.pi * 0.2 * nodes)))
        wave = contact.Sinusoid(0.01 + 2 * c * share / np.pi, 1.0)
        solution = solve(wave, Breathing(c), tol=1e-9, load=changed.load)
        assert true_error(solution, changed) <= solution.error <= 1e-9
