"""A layer on a rigid base: its symbol, its kernel, and contacts against other solutions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pytest

import contact
import sie
from contact.studies.grid_judge import judge_period
from tests.contact.judge import solve, true_error
from tests.tiers import diagonal, quick

KINDS = [("bonded", 0.3), ("smooth", 0.3), ("bonded", 0.499), ("bonded", 0.5), ("bonded", 0.0)]
PERIODIC, ALONE = contact.Periodic(), contact.Isolated()
WAVE = contact.Sinusoid(0.1, 1.0)


def westergaard(half_width):
    """(Scaled positions in the zone, Westergaard's pressure there for E* = 1, its load)."""
    t = np.linspace(-0.999, 0.999, 33)
    u, A = np.pi * half_width * t, np.pi * half_width
    return (
        t,
        0.2 * np.pi * np.cos(u) * np.sqrt(np.sin(A) ** 2 - np.sin(u) ** 2),
        0.1 * np.pi * np.sin(A) ** 2,
    )


def on_a_layer(layer, half_width):
    """The profile that on a layer has the pressure of Westergaard's contact on a half-plane.

    It is f - sum of 4 (L_n - 1) p_n cos(q_n x)/(E* q_n). Here f is the wave, L_n the symbol at the
    wave number q_n, and p_n the mean of p cos(q_n x) over the period, with the pressure p.
    """
    n = np.arange(1, int(4 / layer.thickness) + 4)
    angle = (np.arange(4000) + 0.5) * np.pi / 4000 - 0.5 * np.pi
    s = np.sin(np.pi * half_width)
    u = np.arcsin(s * np.sin(angle))
    p = (0.2 * np.pi * (s * np.cos(angle)) ** 2 / 4000) @ np.cos(2 * np.outer(u, n))
    added = -4 * (layer.symbol(2 * np.pi * n) - 1) * p / (2 * np.pi * n)
    added[0] -= 0.1
    return contact.Fourier(1.0, tuple(added), (0.0,) * len(n))


class TestSymbol:
    def test_is_that_of_the_layers_equations(self):
        # The numbers come from the equations of elasticity in the layer, which for one wave are
        # ordinary differential equations across the layer.
        s = np.array([0.3, 1.0, 2.5])
        assert contact.Layer(1.0, 0.3).symbol(s) == pytest.approx(
            [0.12313858166, 0.41575179846, 0.86752762805], rel=1e-10
        )
        assert contact.Layer(1.0, 0.3, "smooth").symbol(s) == pytest.approx(
            [0.14997346138, 0.49089465366, 0.92433056679], rel=1e-10
        )

    @pytest.mark.parametrize("base, nu", KINDS)
    def test_neither_overflows_nor_cancels(self, base, nu):
        mp = pytest.importorskip("mpmath")
        s = np.geomspace(1e-8, 300.0, 60)
        found = contact.Layer(2.0, nu, base).symbol(0.5 * s)
        with mp.workdps(60):
            k = 3 - 4 * mp.mpf(nu)
            for x, value in zip(map(mp.mpf, s), found, strict=True):
                if base == "smooth":
                    exact = (mp.cosh(2 * x) - 1) / (mp.sinh(2 * x) + 2 * x)
                else:
                    exact = (2 * k * mp.sinh(2 * x) - 4 * x) / (
                        2 * k * mp.cosh(2 * x) + 1 + k * k + 4 * x * x
                    )
                assert abs(mp.mpf(float(value)) / exact - 1) < 1e-15
        assert np.array_equal(
            contact.Layer(2.0, nu, base).symbol(np.array([1e3, 1e8, 1e300])), [1, 1, 1]
        )

    @pytest.mark.parametrize("base, nu", KINDS)
    def test_of_long_waves_is_the_compression(self, base, nu):
        layer = contact.Layer(3.0, nu, base)
        assert layer.symbol(np.array([1e-9]))[0] / 1e-9 == pytest.approx(
            layer.compression, rel=1e-14, abs=1e-16
        )


@pytest.mark.parametrize("base, nu", KINDS)
class TestContact:
    def test_full_contact_is_that_of_the_symbol(self, base, nu):
        layer = contact.Layer(0.2, nu, base)
        L = layer.symbol(2 * np.pi * np.arange(1, 3))
        full = solve(
            contact.Fourier(1.0, (-0.1, 0.02), (0.0, 0.03)),
            PERIODIC,
            substrate=layer,
            mean_pressure=3.0,
        )
        x = np.linspace(-0.5, 0.5, 41)
        f = (
            -0.1 * np.cos(2 * np.pi * x) / L[0],
            (0.02 * np.cos(4 * np.pi * x) + 0.03 * np.sin(4 * np.pi * x)) / L[1],
        )
        expected = 3.0 - np.pi * f[0] - 2 * np.pi * f[1]
        assert len(full.zones) == 0
        assert np.abs(full.pressure(x) - expected).max() < 1e-12 * full.max_pressure

    @pytest.mark.parametrize("thickness", [2.0, 0.2, 0.05])
    def test_is_westergaards_on_a_profile_designed_for_the_layer(self, base, nu, thickness):
        layer, a = contact.Layer(thickness, nu, base), 0.2
        t, pressure, load = westergaard(a)
        solution = solve(on_a_layer(layer, a), PERIODIC, tol=1e-8, substrate=layer, load=load)
        off = max(
            np.abs(solution.pressure_at(t, 0) - pressure).max() / pressure.max(),
            np.abs(solution.zones - [[-a, a]]).max() / (2 * a),
        )
        # The last term is the round-off of the profile's heights divided by the layer's compliance
        # for a wave as long as the contact, relative to that of a half-plane.
        assert off < solution.error + 4e-15 / layer.symbol(np.array([np.pi / (2 * a)]))[0]

    def test_a_thick_layer_is_a_half_plane_up_to_the_square_of_its_thickness(self, base, nu):
        plain = solve(contact.Parabola(1.0), ALONE, tol=1e-11, load=0.01)
        off = []
        for h in (4.0, 16.0):
            layered = solve(
                contact.Parabola(1.0),
                ALONE,
                tol=1e-11,
                substrate=contact.Layer(h, nu, base),
                load=0.01,
            )
            off.append(abs(plain.zones[0, 1] - layered.zones[0, 1]))
        assert np.log(off[0] / off[1]) / np.log(4) == pytest.approx(2, abs=0.05)

    def test_agrees_with_an_independent_grid(self, base, nu):
        profile, layer = (
            contact.Fourier(1.0, (-0.01, 0.006, 0.002), (0.002, -0.003, 0.001)),
            contact.Layer(0.1, nu, base),
        )
        solution = solve(profile, PERIODIC, tol=1e-8, substrate=layer, load=0.02)
        grid = judge_period(profile.height, (-0.5, 0.5), 1.0, layer.symbol, 0.02, 1024)
        assert np.count_nonzero((solution.pressure(grid.x) > 0) != grid.contact) <= 4 * max(
            len(solution.zones), 1
        )
        height = np.asarray(profile.height(grid.x))
        assert solution.approach == pytest.approx(
            grid.level + 2 * layer.compression * 0.02 - height.min(), rel=5e-3
        )


INTERACTIONS = [PERIODIC, ALONE, contact.Localized("self-consistent"), contact.Localized()]


@pytest.mark.parametrize(("kind", "interaction"), diagonal(KINDS, INTERACTIONS))
def test_every_control_leads_back_to_the_same_zones(kind, interaction):
    base, nu = kind
    scene = contact.Scene(
        WAVE, 1.0, interaction, substrate=contact.Layer(0.3, nu, base), half_width=0.2
    )
    given = contact.solve(scene, tol=1e-9)
    for control in ("load", "approach"):
        again = contact.solve(
            replace(scene, half_width=None, **{control: getattr(given, control)}), tol=1e-8
        )
        assert np.abs(again.zones - given.zones).max() < 1e-8


class TestLimits:
    @pytest.mark.parametrize("base", ["smooth", "bonded"])
    def test_a_thin_layer_is_winklers_up_to_its_thickness(self, base):
        off = []
        for h in (0.016, 0.008):
            layer = contact.Layer(h, 0.3, base)
            solution = solve(
                contact.Parabola(1.0), ALONE, tol=1e-4, substrate=layer, half_width=0.2
            )
            x = np.linspace(-0.15, 0.15, 13)
            expected = (solution.approach - 0.5 * x**2) / (2 * layer.compression)
            off.append(np.abs(solution.pressure(x) / expected - 1).max())
        assert off[0] < 0.2 and off[1] < 0.6 * off[0]

    def test_on_a_thin_layer_the_periodic_contact_is_the_isolated_one(self):
        scene = contact.Scene(
            WAVE, 1.0, PERIODIC, substrate=contact.Layer(0.02, 0.3), half_width=0.1
        )
        one, alone = (
            contact.solve(scene, tol=1e-11),
            contact.solve(replace(scene, interaction=ALONE), tol=1e-11),
        )
        assert true_error(one, alone) < one.error + alone.error
        assert one.approach == pytest.approx(alone.approach, rel=1e-11)
        assert one.stiffness == pytest.approx(alone.stiffness, rel=1e-9)

    def test_several_isolated_zones_are_those_of_a_long_period(self):
        layer = contact.Layer(0.1, 0.3)
        alone = solve(contact.Biquadratic(1.0, 0.4), ALONE, tol=1e-9, substrate=layer, load=0.02)
        row = solve(
            contact.Biquadratic(1.0, 0.4, period=4.0),
            PERIODIC,
            tol=1e-9,
            substrate=layer,
            load=0.02,
        )
        assert true_error(alone, row) < alone.error + row.error

    def test_a_zone_too_wide_for_its_layer_is_refused_with_the_reason(self):
        scene = contact.Scene(
            contact.Parabola(1.0), 1.0, ALONE, substrate=contact.Layer(0.5e-4, 0.3), half_width=0.4
        )
        with pytest.raises(
            contact.OutOfRange,
            match=r"9444 times as wide as the length 85 µm over which the kernel of the substrate varies",
        ):
            contact.solve(scene)


@pytest.mark.parametrize(("kind", "interaction"), diagonal(KINDS, [PERIODIC, ALONE]))
@pytest.mark.parametrize("thickness", [3e-3, pytest.param(1e-3, marks=pytest.mark.slow)])
def test_a_contact_of_hundreds_of_thicknesses_has_few_unknowns_under_every_control(
    kind, interaction, thickness
):
    """The number of unknowns grows as the square root of the width over the thickness.

    The pressure is smooth except within about one thickness of the ends.
    """
    base, nu = kind
    layer = contact.Layer(thickness, nu, base)
    given = contact.solve(
        contact.Scene(WAVE, 1.0, interaction, substrate=layer, half_width=0.15), tol=1e-6
    )
    assert given.plan.counts["coupled_unknowns"] < 40 * np.sqrt(0.3 / thickness)
    for control in ("load", "approach") + ("contact_fraction",) * interaction.needs_period:
        again = contact.solve(
            contact.Scene(
                WAVE, 1.0, interaction, substrate=layer, **{control: getattr(given, control)}
            ),
            tol=1e-6,
        )
        assert true_error(again, given) < 3 * (again.error + given.error) + 1e-9
        assert again.plan.counts["solves"] < 15


@pytest.mark.parametrize(
    ("kind", "width"),
    quick(
        product(KINDS, [0.9, 1.02, 1.1, 1.5]),
        [(("bonded", 0.3), 1.5), (("smooth", 0.3), 0.9), (("bonded", 0.5), 1.02)],
    ),
)
def test_the_ends_on_a_thin_layer_are_found_from_zones_that_are_too_wide(kind, width):
    """Next to the ends of a zone that is too wide, the edge slopes have the wrong sign.

    Newton steps with the natural size of the slopes would be a hundred times too short.
    """
    base, nu = kind
    layer = contact.Layer(1e-3, nu, base)
    half = 0.15
    scene = contact.Scene(WAVE, 1.0, ALONE, substrate=layer, half_width=half)
    # With the modulus 1 the density is twice the pressure.
    total = sie.Total(2 * contact.solve(scene, tol=1e-7).load)
    equation = sie.Equation(scene.operator.kernel(1.0), sie.Forcing(WAVE.slope), (total,))
    free = sie.find_ends(equation, sie.Zones.of([[-width * half, width * half]]), 1e-7)
    assert free.converged
    assert len(free.trace) < 12
    assert np.allclose(free.next_zones.table, [[-half, half]], rtol=0, atol=1e-7)


@dataclass(frozen=True)
class Coth(contact.Substrate):
    """A substrate with the symbol coth(q h); its kernel is (pi/2h) coth(pi r/2h)."""

    h: float
    name = "coth"

    def symbol(self, q):
        return 1 / np.tanh(q * self.h)


@dataclass(frozen=True)
class Cosh(contact.Profile):
    """The profile whose slope is sinh(2v), with v = pi x/2h.

    Its pressure obeys (1/2h) PV int p(xi) coth(pi (x - xi)/2h) dxi = sinh(2v)/2 on the substrate
    `Coth`, for E* = 1.
    """

    h: float
    symmetric = True

    def height(self, x):
        return self.h / np.pi * np.cosh(np.pi * np.asarray(x) / self.h)

    def slope(self, x):
        return np.sinh(np.pi * np.asarray(x) / self.h)


@pytest.mark.parametrize("a", [0.01, 0.2, 0.5])
def test_the_coth_kernel_has_its_closed_form(a):
    h, t = 0.3, np.linspace(-0.999, 0.999, 33)
    v, end = np.pi * a * t / (2 * h), np.sinh(np.pi * a / (2 * h))
    solution = solve(Cosh(h), ALONE, tol=1e-12, substrate=Coth(h), load=h * end**2)
    expected = np.cosh(v) * np.sqrt(end**2 - np.sinh(v) ** 2)
    assert np.abs(solution.zones - [[-a, a]]).max() < 2e-12 * a
    assert np.abs(solution.pressure_at(t, 0) - expected).max() < 2e-12 * expected.max()


@pytest.mark.parametrize(
    "thickness, nu, base, fault",
    [
        (0.0, 0.3, "bonded", "thickness"),
        (-1.0, 0.3, "bonded", "thickness"),
        (np.inf, 0.3, "bonded", "thickness"),
        (1.0, 0.51, "bonded", "nu"),
        (1.0, -1.0, "smooth", "nu"),
        (1.0, np.nan, "bonded", "nu"),
        (1.0, 0.3, "smoth", "did you mean 'smooth'"),
        (1.0, 0.3, None, "base"),
        ("1", 0.3, "bonded", "thickness"),
    ],
)
def test_wrong_parameters_of_a_layer_are_refused(thickness, nu, base, fault):
    with pytest.raises(contact.SceneError, match=fault):
        contact.Layer(thickness, nu, base)
