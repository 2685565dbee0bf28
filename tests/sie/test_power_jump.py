"""Densities of the second-kind equation in closed form: those of jumps, and those with given
values at the ends.

They are compared with quadrature in high precision, and with the laws that they obey.
"""

import mpmath as mp
import numpy as np
import pytest

from sie.basis.interval import InPlane, OnLine, Outside
from sie.basis.lerch import lerch
from sie.basis.power_jump import PowerJump
from sie.basis.value_mode import ValueMode
from sie.basis.weighted import JacobiFunctions
from tests.tiers import diagonal

KAPPAS = (0.0, 0.4, -2.0, 25.0, -25.0)
PLACES = np.array([-0.999, -0.6, 0.0, 0.3, 0.98])
ANGLE = np.linspace(0.02, 3.12, 23)[:, None]
LEFT, RIGHT = 2 * np.cos(ANGLE / 2) ** 2, 2 * np.sin(ANGLE / 2) ** 2
# Points off the interval at which |rho|^150 is below round-off, so that 150 moments suffice.
AROUND = np.array([1.03, -1.2, 1.7, 0.3 + 0.4j, -0.9 + 0.3j, 4 + 1j, 300.0])[:, None]


def jumps(kappa, places=PLACES):
    return PowerJump(JacobiFunctions(kappa), 1 + places, 1 - places)


def in_plane(z):
    return InPlane(np.asarray(z + 1, dtype=complex), np.asarray(z - 1, dtype=complex))


def by_moments(table, z):
    """The transform of sum m_l T_l / sqrt(1 - t^2) at the points z (P, 1), with the moments m_l
    along the last axis of `table`.
    """
    rho = in_plane(z).rho
    powers = rho[..., None] ** np.arange(table.shape[-1])
    return (powers * table).sum(axis=-1) / in_plane(z).root


def derivative(f, z, h):
    """The derivative of an analytic function at z from 16 points on a circle of the radius h.
    The error is of the order h^16.
    """
    turns = np.exp(2j * np.pi * np.arange(16) / 16)
    return sum(f(z + h * turn) / turn for turn in turns) / (16 * h)


@pytest.mark.parametrize("a", [0.0127, 0.37, 0.987, 1.4])
def test_lerch(a):
    x = np.array(
        [0.3, 0.6, 0.93, -0.8, -1.0, 0.5 + 0.7j, 0.6j - 0.7, np.exp(1j), 0.8 * np.exp(0.6j)]
    )
    exact = np.array([complex(mp.hyp2f1(1, a, 1 + a, mp.mpmathify(complex(v))) / a) for v in x])
    assert lerch(a, x, 1 - x) == pytest.approx(exact, rel=3e-15)
    near = np.array([1e-3, 1e-15, 1e-40])
    with mp.workdps(60):
        exact = [float(mp.hyp2f1(1, a, 1 + a, 1 - mp.mpf(v)) / a) for v in near]
    assert lerch(a, 1 - near, near) == pytest.approx(exact, rel=1e-14)


@pytest.mark.parametrize(("kappa", "order"), diagonal([0.4, -2.0], [0, 1, 2]))
def test_the_transform_of_a_jump_is_its_integral(kappa, order):
    place, weighted = 0.3, JacobiFunctions(kappa)
    jump = jumps(kappa, np.array([place]))
    a = mp.mpf(weighted.alpha)

    def density(left, right):
        """The density (t - s)^k J_s of a jump at s, by the hypergeometric function."""
        near, far = left * mp.mpf(1 - place), right * mp.mpf(1 + place)
        away = (left - right) / 2 - mp.mpf(place)
        if min(near, far) == 0:
            return mp.mpf(0)
        low, b = near / far, 1 - a
        if low > 1:
            low, b = 1 / low, a
        scale = mp.sin(mp.pi * a) ** 2 / mp.pi / b
        return scale * low**b * mp.hyp2f1(1, b, 1 + b, low) * away**order

    def integral(z):
        def left(x):
            d = x ** (1 / (1 - a))
            return density(d, 2 - d) / (z + 1 - d) * x ** (1 / (1 - a) - 1) / (1 - a)

        def right(x):
            d = x ** (1 / a)
            return density(2 - d, d) / (z - 1 + d) * x ** (1 / a - 1) / a

        halves = mp.quad(left, [0, (1 + mp.mpf(place)) ** (1 - a)])
        return (halves + mp.quad(right, [0, (1 - mp.mpf(place)) ** a])) / mp.pi

    for z in (1.2, 0.25 + 0.4j):
        exact = complex(integral(mp.mpmathify(z)))
        scale = float(jump.total[0])
        assert abs(jump.transform(in_plane(np.array([z])), order=order)[0] - exact) < 1e-14 * scale
    line = OnLine.of(np.array([-0.1]), np.array([2.1]))
    exact = complex(integral(mp.mpf(-1.1)))
    assert jump.transform(line, order=order)[0] == pytest.approx(exact.real, abs=1e-14)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("kappa", KAPPAS)
def test_limits_at_the_interval_are_the_density_and_the_jump(kappa, order):
    jump = jumps(kappa)
    close = np.array([[-1e-12], [1e-12], [1e-3]])
    for away, left, right in (
        ((LEFT - RIGHT) / 2 - PLACES, LEFT, RIGHT),
        (close, 1 + PLACES + close, 1 - PLACES - close),
    ):
        inside = (left > 0) & (right > 0)
        away, left, right = np.broadcast_arrays(away, left, right)
        points = InPlane.of(left, -right, np.zeros(left.shape))
        upper = jump.transform(points, away.astype(complex), order)
        density, own = jump.density(left, right, away, order), jump.own(away, order)
        error = np.abs(upper + 1j * density - (own - kappa * density))
        scale = np.abs(density) * (1 + abs(kappa)) + np.abs(own) + 1e-2
        assert np.all((error < 2e-14 * scale) | ~inside)


def test_kappa_zero_is_the_logarithm():
    t, s = np.cos(ANGLE), PLACES
    away = t - s
    angles = ANGLE, np.arccos(s)
    sines = (np.sin(np.abs(angles[0] + sign * angles[1]) / 2) for sign in (1, -1))
    value = jumps(0.0).density(LEFT, RIGHT, away)
    assert value == pytest.approx(np.log(next(sines) / next(sines)) / np.pi, abs=1e-12)
    assert jumps(0.0).levels[0] == pytest.approx(
        -2 / np.pi * np.arctan2(np.sqrt(1 - s), np.sqrt(1 + s)), abs=5e-16
    )


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("kappa", KAPPAS)
def test_moments_and_slopes_of_jumps_are_those_of_the_transform(kappa, order):
    jump = jumps(kappa)
    table = jump.moments(150, order)
    scale = np.abs(table).max(axis=-1) / np.abs(in_plane(AROUND).root)
    exact = jump.transform(in_plane(AROUND), order=order)
    assert np.all(np.abs(by_moments(table, AROUND) - exact) < 1e-13 * scale)
    assert table[:, 0] * np.pi == pytest.approx(jump.powers(order + 1)[order], abs=1e-14)
    for z in (0.3 + 0.4j, 3 - 0.5 + 1j, -40 + 60j):
        slope = derivative(lambda z: jump.transform(in_plane(z), order=order), z, abs(z) / 10)
        value = jump.slope(in_plane(np.asarray(z)), order=order)
        assert value == pytest.approx(slope, abs=1e-12 * np.abs(slope).max())


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("kappa", KAPPAS)
def test_integrals_and_edge_slopes_of_jumps(kappa, order):
    jump, weighted = jumps(kappa), JacobiFunctions(kappa)
    whole = jump.powers(order + 1)[order]
    left, right = np.array([[2.0], [0.0]]), np.array([[0.0], [2.0]])
    ends = jump.integral_to(left, right, (left - right) / 2 - PLACES, order)
    assert ends[0] == pytest.approx(whole, abs=1e-15)
    assert np.abs(ends[1]).max() == 0.0
    # Gauss's rule on the interval from t = 0.5 to t = 0.7, which contains none of the jumps.
    nodes, weights = np.polynomial.legendre.leggauss(20)
    t = 0.6 + 0.1 * nodes[:, None]
    rule = 0.1 * weights @ jump.density(1 + t, 1 - t, t - PLACES, order)
    low, high = (jump.integral_to(1 + t, 1 - t, t - PLACES, order) for t in (0.5, 0.7))
    assert high - low == pytest.approx(rule, abs=2e-14 * np.abs(whole).max() + 1e-15)
    d = 1e-9
    for slope, sides, gamma in zip(
        jump.edge_slopes(order),
        ((d, 2 - d), (2 - d, d)),
        (weighted.rest, weighted.alpha),
        strict=True,
    ):
        density = jump.density(*sides, 0.5 * (sides[0] - sides[1]) - PLACES, order)
        assert density / d**gamma == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("at_left", [True, False])
@pytest.mark.parametrize("kappa", KAPPAS)
def test_the_value_mode(kappa, at_left):
    mode, left, right = ValueMode(JacobiFunctions(kappa), at_left), LEFT[:, 0], RIGHT[:, 0]
    density = mode.density(left, right)
    upper = mode.transform(InPlane.of(left, -right, np.zeros(len(left))))
    own = mode.own(left, right)
    scale = 1 + abs(kappa) + np.abs(own)
    assert np.all(np.abs(upper + 1j * density - (own - kappa * density)) < 1e-14 * scale)
    ends = mode.density(np.array([0.0, 2.0]), np.array([2.0, 0.0]))
    assert ends.tolist() == ([1.0, 0.0] if at_left else [0.0, 1.0])
    table = mode.moments(150)
    error = by_moments(table, AROUND) - mode.transform(in_plane(AROUND))
    assert np.abs(error).max() < 3e-14
    assert table[0] * np.pi == pytest.approx(mode.total, rel=1e-13)
    integral = mode.integral_to(np.array([0.0, 1.2, 1.4, 2.0]), np.array([2.0, 0.8, 0.6, 0.0]))
    assert integral[[0, 3]] == pytest.approx([0.0, mode.total], abs=1e-15)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    t = 0.3 + 0.1 * nodes
    rule = 0.1 * weights @ mode.density(1 + t, 1 - t)
    assert integral[2] - integral[1] == pytest.approx(rule, abs=1e-14)
    for z in (0.3 + 0.4j, -40 + 60j):
        slope = derivative(lambda z: mode.transform(in_plane(z)), np.asarray(z), abs(z) / 10)
        value = mode.slope(in_plane(np.asarray(z)))
        # `derivative` divides the round-off of the transform, whose terms are of the size 1, by
        # the radius of the circle.
        assert value == pytest.approx(slope, rel=1e-12, abs=5e-15 / abs(z))
    d = 1e-9
    weighted, (slope_left, slope_right) = JacobiFunctions(kappa), mode.edge_slopes()
    change_left = mode.density(d, 2 - d) - ends[0]
    change_right = mode.density(2 - d, d) - ends[1]
    assert change_left == pytest.approx(slope_left * d**weighted.rest, rel=1e-5, abs=1e-13)
    assert change_right == pytest.approx(slope_right * d**weighted.alpha, rel=1e-5, abs=1e-13)


def test_transforms_of_value_modes_are_integrals():
    for kappa in (0.4, -25.0):
        mode, a = ValueMode(JacobiFunctions(kappa)), mp.mpf(JacobiFunctions(kappa).alpha)
        for z in (1.01, 40.0, -1.0001, -5.0, 0.2 + 0.3j):
            u = (mp.mpmathify(z) - 1) / (mp.mpmathify(z) + 1)
            exact = mp.quad(lambda v, a=a: (1 - v ** (a - 1)) / (1 - v), [u, (1 + u) / 2, 1])
            exact = complex(-exact / mp.pi)
            point = in_plane(np.array([z]))
            if isinstance(z, float):
                point = Outside(np.sign(z), np.array([abs(z) - 1]))
            assert mode.transform(point)[0] == pytest.approx(exact, abs=2e-15, rel=1e-12)


def test_the_value_mode_of_the_first_kind():
    mode, points = ValueMode(JacobiFunctions(0.0)), in_plane(np.array([1.1, -3.0, 0.2 + 0.1j]))
    assert mode.transform(points) == pytest.approx(2 / np.pi * np.log(1 + points.rho), rel=1e-14)
