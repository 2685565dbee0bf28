"""Jumps in slits: their closed forms against quadrature of the principal values."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import sie
from sie.jumps.right_side import ForcingJumps
from sie.slits.kinks import SlitKink

ORDERS = [0, 1, 2]


def slit_kink(order: int, seed: int) -> tuple[SlitKink, float, float, float]:
    """(jump in a slit, middle m and half width r of the slit, position zeta of the jump in it)."""
    rng = np.random.default_rng(seed)
    m = float(rng.uniform(-0.95, 0.95))
    r, zeta = float(10 ** rng.uniform(-3, -1.4) * (1 - abs(m))), float(rng.uniform(-0.9, 0.9))
    return (
        SlitKink(r**-order, 1 + m - r, 1 - m - r, r, 1 + m + r * zeta, 1 - m - r * zeta, order),
        m,
        r,
        zeta,
    )


def quadrature(one: SlitKink, m: float, r: float, zeta: float, z: float) -> float:
    """(1/pi) PV int psi X / (t - tau) dtau at t = m + r z, by quadrature over an angle.

    psi is `slope`, and X = sqrt(1 - tau^2). If t lies on the slit, the value of psi X at t is
    subtracted from psi X, and its principal value is added in closed form.
    """

    def weighted(place: float) -> float:
        slope = one.slope(np.array([1 + place]), np.array([1 - place]))
        return float(slope[0]) * np.sqrt(1 - (m + r * place) ** 2)

    at = weighted(z) if abs(z) < 1 else 0.0
    cuts = [0.0, *sorted(np.arccos([p for p in (z, zeta) if abs(p) < 1])), np.pi]
    parts = [
        quad(
            lambda b: (weighted(np.cos(b)) - at) / (z - np.cos(b)) * np.sin(b),
            low,
            high,
            limit=100,
            epsabs=1e-11,
        )[0]
        for low, high in zip(cuts[:-1], cuts[1:], strict=True)
    ]
    return (sum(parts) + (at * np.log((1 + z) / (1 - z)) if at else 0.0)) / np.pi


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("seed", [1, 2])
def test_the_density_due_to_a_jump_and_its_slope_in_the_slit_is_that_by_quadrature(
    order: int, seed: int
) -> None:
    one, m, r, zeta = slit_kink(order, seed)
    jump = ForcingJumps(
        np.array([0]),
        np.array([one.from_left]),
        np.array([one.from_right]),
        np.array([one.jump]),
        np.array([order]),
    )
    for z in (-0.73, 0.94):
        t = m + r * z
        left, right = np.array([1 + t]), np.array([1 - t])
        own = np.sqrt(1 - t * t) * float(jump.density(0, left, right)[0])
        assert own + quadrature(one, m, r, zeta, z) == pytest.approx(
            one.in_slit(left, right, np.array([z]))[0], abs=1e-10
        )
    a_0, a_1 = one.edge
    for z in (-7.0, -1.3, 2.5, 12.0):
        t = m + r * z
        wanted = (quadrature(one, m, r, zeta, z) - a_0 - a_1 * t) / np.sqrt(1 - t * t)
        found = one.outside_slit(
            np.array([1 + t]), np.array([1 - t]), np.array([abs(z) - 1]), np.array([z > 0])
        )
        assert found[0] == pytest.approx(wanted, abs=1e-10)


@pytest.mark.parametrize("order", ORDERS)
def test_the_opening_is_the_integral_of_the_slope(order: int) -> None:
    one, _, _, zeta = slit_kink(order, 3)
    z = np.array([-0.6, 0.2, 0.97, 1.0])
    for place, opened in zip(z, one.opening(1 + z, 1 - z), strict=True):
        slope, cuts = (
            (lambda x: float(one.slope(np.array([1 + x]), np.array([1 - x]))[0])),
            [-1.0, zeta, place],
        )
        parts = [
            quad(slope, low, min(high, place))[0]
            for low, high in zip(cuts[:-1], cuts[1:], strict=True)
            if low < place
        ]
        assert opened == pytest.approx(sum(parts), abs=1e-8)


@pytest.mark.parametrize("order", ORDERS)
def test_edge_slopes_are_the_derivatives_of_the_density_by_the_angle(order: int) -> None:
    one, m, r, _ = slit_kink(order, 4)
    e = 1e-8
    for side, slope in zip((-1.0, 1.0), one.edge_slopes, strict=True):
        outside = np.array([(1 - side * m - r - e) / r])
        near, far = np.array([e]), np.array([2 - e])
        value = one.outside_slit(
            *((near, far) if side < 0 else (far, near)), outside, np.array([side > 0])
        )
        assert value[0] / np.sqrt(2 * e) == pytest.approx(slope, rel=1e-4)


@pytest.mark.parametrize("kink", [None, 0.5, -0.3])
def test_integrals_up_to_a_point_agree_with_and_without_slits(kink: float | None) -> None:
    """The total is the given one. Integrals up to a point are the same with a slit and with
    separate zones.
    """
    jumps = sie.Jumps() if kink is None else sie.Jumps([kink], [2.0])
    s = 0.0 if kink is None else kink
    height = 0.0 if kink is None else 1.0
    g = sie.Forcing(
        lambda x: x + height * np.sign(x - s), lambda x: x * x / 2 + height * np.abs(x - s), jumps
    )
    zones = sie.Zones.of([[-1.0, -0.001], [0.001, 1.0], [2.0, 3.0]])
    equation = sie.Equation(sie.cauchy(), g, (sie.Total(1.0), sie.EqualPotential()))
    slits = sie.solve_zones(equation, zones).density
    separate = sie.solve_fixed(equation, zones).density
    assert type(slits) is sie.SlitDensity and abs(slits.totals.sum() - 1.0) < 1e-12
    x = np.array([-0.99, -0.3, -0.002, -0.001, 0.0, 0.001, 0.002, 0.5, 0.51, 1.0, 1.5, 2.5, 3.0])
    assert np.abs(slits.integral(x) - separate.integral(x)).max() < 1e-11
    assert np.abs(slits.integral(zones.b) - slits.totals).max() < 1e-14
