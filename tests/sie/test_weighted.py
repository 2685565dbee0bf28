"""Densities of the second-kind equation on one interval, compared with quadrature and
recurrences in high precision, and with the laws that they obey.
"""

from functools import lru_cache

import mpmath as mp
import numpy as np
import pytest

from sie.basis.chebyshev import bounded_part, u_values
from sie.basis.interval import InPlane, OnLine, Outside
from sie.basis.weighted import JacobiFunctions, Split, exponent_of
from tests.tiers import quick

KAPPAS = (0.0, 0.4, -2.0, 25.0, -25.0)
RNG = np.random.default_rng(43)


def alpha_of(kappa):
    return mp.acot(mp.mpf(kappa)) / mp.pi if kappa > 0 else 1 - mp.acot(mp.mpf(-kappa)) / mp.pi


def polynomial(kappa, n, t):
    """The polynomial p_n at t, as a multiple of the Jacobi polynomial of mpmath."""
    a = alpha_of(kappa)
    scale = mp.factorial(n) / mp.sqrt(mp.rf(a, n) * mp.rf(1 - a, n))
    return scale * mp.jacobi(n, a - 1, -a, t)


def quadrature(kappa, n, of):
    """The integral of the density S_n = sin(pi alpha) (1 - t)^-alpha (1 + t)^(alpha - 1) p_n(t)
    times the function `of`.

    On each half of the interval, a substitution removes the singularity at the end.
    """
    a = alpha_of(kappa)

    def right(x):
        d = x ** (1 / a)
        return (2 - d) ** -a * polynomial(kappa, n, 1 - d) * of(1 - d) / a

    def left(x):
        d = x ** (1 / (1 - a))
        return (2 - d) ** (a - 1) * polynomial(kappa, n, d - 1) * of(d - 1) / (1 - a)

    return mp.sin(mp.pi * a) * (mp.quad(right, [0, 0.5, 1]) + mp.quad(left, [0, 0.5, 1]))


@lru_cache
def forward(kappa, count, left, less):
    """The transforms of S_n, n < count, by the forward recurrence. It is computed with 40 digits
    more than it loses.
    """
    growth = abs(mp.log(abs((left + less) / 2 + mp.sqrt(left) * mp.sqrt(less))))
    with mp.workdps(40 + int(growth * count)):
        a, z = alpha_of(kappa), (left + less) / 2

        def diagonal(k):
            return (2 * a - 1) / mp.mpf(4 * k * k - 1)

        def beside(k):
            return mp.sqrt((k - 1 + a) * (k - a)) / (2 * k - 1)

        out = [mp.power(less, a - 1) * mp.power(left, -a)]
        out.append(((z - diagonal(0)) * out[0] - 1) / (2 * beside(1)))
        for k in range(1, count - 1):
            out.append(((z - diagonal(k)) * out[k] - beside(k) * out[k - 1]) / beside(k + 1))
    return np.array([complex(value) for value in out])


def near_ends(distance, angle):
    """The two points at a distance and an angle from the right and from the left end. Each is
    (zeta + 1, zeta - 1), with 50 digits and as doubles.
    """
    away = mp.mpc(complex(distance * np.cos(angle), distance * np.sin(angle)))
    with mp.workdps(50):
        right, left = (away + 2, away), (-mp.conj(away), -mp.conj(away) - 2)
    for pair in (right, left):
        yield pair, InPlane(*(np.array([complex(value)]) for value in pair))


def test_the_exponent_has_all_its_digits():
    for kappa in (*KAPPAS, 1e8, -1e8):
        assert exponent_of(kappa) == pytest.approx(float(alpha_of(kappa)), rel=4e-16)
        assert JacobiFunctions(kappa).rest == pytest.approx(float(1 - alpha_of(kappa)), rel=4e-16)
    assert exponent_of(0.0) == 0.5


@pytest.mark.parametrize("kappa", quick([0.4, -2.0, 12.0], [-2.0]))
def test_transforms_and_slopes_are_integrals(kappa):
    weighted = JacobiFunctions(kappa)
    for z in (1.3, -1.05, 0.2 + 0.3j, 5 + 1j):
        points = InPlane.of(np.array([z + 1]).real, np.array([z - 1]).real, np.array([z]).imag)
        if z.imag == 0:
            points = OnLine.of(np.array([1 + z]), np.array([1 - z]))
        scale = abs(weighted.transforms(1, points)[0, 0])
        for n in (0, 3):
            value = quadrature(kappa, n, lambda t, z=z: 1 / (mp.mpmathify(z) - t)) / mp.pi
            slope = -quadrature(kappa, n, lambda t, z=z: 1 / (mp.mpmathify(z) - t) ** 2) / mp.pi
            c = np.eye(5)[n]
            assert abs(weighted.transforms(5, points)[0, n] - complex(value)) < 1e-14 * scale
            assert abs(weighted.transform_of(c, points)[0] - complex(value)) < 1e-14 * scale
            assert abs(weighted.slope_of(c, points)[0] - complex(slope)) < 1e-13 * scale


@pytest.mark.parametrize("kappa", quick([0.4, -2.0, 12.0], [-2.0]))
def test_norms_moments_and_integrals(kappa):
    weighted, c = JacobiFunctions(kappa), np.array([0.3, -0.2, 0.7])
    for n in range(3):
        norm = quadrature(kappa, n, lambda t, n=n: polynomial(kappa, n, t))
        assert float(norm) == pytest.approx(np.pi if n == 0 else np.pi / 2, rel=1e-14)
    first = sum(quadrature(kappa, n, lambda t: t) * mp.mpf(x) for n, x in enumerate(c))
    assert weighted.first_moment(c) == pytest.approx(float(first), rel=1e-13)
    assert weighted.total(c) == pytest.approx(0.3 * np.pi, rel=1e-15)
    angle = np.array([1e-7, 0.4, 1.3, 2.0, 3.1])
    left, right = 2 * np.cos(angle / 2) ** 2, 2 * np.sin(angle / 2) ** 2
    table = weighted.moments(3, 6)
    for l, n in ((0, 0), (3, 0), (2, 1), (5, 2), (1, 2)):
        exact = quadrature(kappa, n, lambda t, l=l: mp.chebyt(l, t)) * (1 if l == 0 else 2) / mp.pi
        assert table[l, n] == pytest.approx(float(exact), abs=1e-14)
    a = alpha_of(kappa)

    def part(distance):
        """The integral of the density over a piece of the length `distance` at the right end."""

        def of(x):
            d = x ** (1 / a)
            return (2 - d) ** -a * sum(
                mp.mpf(v) * polynomial(kappa, n, 1 - d) for n, v in enumerate(c)
            )

        return mp.sin(mp.pi * a) / a * mp.quad(of, [0, mp.mpf(distance) ** a])

    exact = np.array([float(mp.mpf(c[0]) * mp.pi - part(r)) for r in right])
    assert weighted.integral_to(c, left, right) == pytest.approx(exact, abs=2e-14)


@pytest.mark.parametrize("kappa", KAPPAS)
@pytest.mark.parametrize("count", [6, 60, pytest.param(1000, marks=pytest.mark.slow)])
def test_transforms_near_and_far_are_the_minimal_solution(kappa, count):
    weighted, c = JacobiFunctions(kappa), np.cos(np.arange(count) ** 2)
    for distance in (1e-12, 1e-6, 3e-4, 0.02, 0.15, 1.0, 30.0, 1e6)[: 8 if count < 1000 else 5]:
        for angle in (0.0, 0.7, 2.0, 3.1):
            for exact_point, points in near_ends(distance, angle):
                exact = forward(kappa, count, *exact_point)
                table = weighted.transforms(count, points)[0]
                assert np.abs(table - exact).max() < 5e-13 * abs(exact[0])
                error = abs(weighted.transform_of(c, points)[0] - c @ exact)
                assert error < 1e-13 * np.abs(c * exact).sum()


def test_kappa_zero_is_chebyshev():
    weighted = JacobiFunctions(0.0)
    points = Outside(np.array([1.0, -1.0, 1.0, -1.0]), np.array([1e-12, 1e-3, 0.5, 1e3]))
    assert weighted.transforms(50, points) == pytest.approx(points.transforms(50), rel=1e-11)
    assert np.array_equal(weighted.from_u(20), np.eye(20))
    assert weighted.moments(20, 30) == pytest.approx(np.eye(30, 20), abs=1e-14)
    c = RNG.standard_normal(12)
    alpha, beta, u = bounded_part(c[None])
    left, right, q = weighted.split(c)
    assert (left, right) == pytest.approx((alpha[0] - beta[0], alpha[0] + beta[0]), abs=1e-14)
    assert q == pytest.approx(u[0], abs=1e-13)


@pytest.mark.parametrize("kappa", KAPPAS)
def test_limits_at_the_interval_are_the_density_and_its_own_transform(kappa):
    weighted, c = JacobiFunctions(kappa), RNG.standard_normal(30)
    angle = np.linspace(0.05, 3.1, 40)
    left, right = 2 * np.cos(angle / 2) ** 2, 2 * np.sin(angle / 2) ** 2
    upper = weighted.transform_of(c, InPlane.of(left, -right, np.zeros(40)))
    density = weighted.weight(left, right) * weighted.values(c, left, right)
    table = weighted.table(30, left, right)
    assert table @ c == pytest.approx(
        weighted.values(c, left, right), abs=1e-13 * np.abs(table).max()
    )
    scale = np.abs(upper).max() * (1 + abs(kappa))
    assert upper.imag == pytest.approx(-density, abs=1e-13 * scale)
    own = weighted.own(c, left, right)
    assert upper.real + kappa * density == pytest.approx(own, abs=1e-13 * scale)
    assert np.all(weighted.own(np.ones(1), left, right) == 0.0)


@pytest.mark.parametrize("kappa", KAPPAS)
def test_u_is_a_sum_of_the_polynomials_of_the_right_side(kappa):
    weighted, g = JacobiFunctions(kappa), RNG.standard_normal(80) * 0.95 ** np.arange(80)
    matrix = weighted.from_u(80)
    assert np.array_equal(matrix, np.triu(matrix))
    t = np.cos(np.linspace(0, np.pi, 33)[1:-1])
    # All polynomials are of the same size if they are multiplied by `root`.
    root = np.sqrt(weighted.bounded_weight(1 - t, 1 + t) * np.sqrt(1 - t * t))
    error = weighted.own(np.concatenate(([0.0], -matrix @ g)), 1 + t, 1 - t) - u_values(
        g[None], t[None]
    )
    assert np.abs(root * error).max() < 3e-14 * np.abs(g).sum()


@pytest.mark.parametrize("kappa", KAPPAS)
def test_a_split_density_is_the_same_and_vanishes_at_bounded_ends(kappa):
    weighted, c = JacobiFunctions(kappa), RNG.standard_normal(30) * 0.8 ** np.arange(30)
    angle = np.linspace(1e-4, np.pi - 1e-4, 40)
    left, right = 2 * np.cos(angle / 2) ** 2, 2 * np.sin(angle / 2) ** 2
    plain = weighted.weight(left, right) * weighted.values(c, left, right)
    scale = weighted.weight(left, right) * np.abs(weighted.table(30, left, right) * c).sum(axis=-1)
    assert np.all(np.abs(weighted.density(weighted.split(c), left, right) - plain) < 4e-14 * scale)
    for points in (
        Outside(np.array([1.0, -1.0, 1.0]), np.array([1e-8, 1e-3, 2.0])),
        InPlane.of(np.array([0.5, 2.01]), np.array([-1.5, 0.01]), np.array([0.0, 0.01])),
    ):
        parts = np.abs(weighted.transforms(30, points) * c).sum(axis=-1)
        split = weighted.split_transform(weighted.split(c), points)
        assert np.all(np.abs(split - weighted.transform_of(c, points)) < 1e-12 * parts)
    split = weighted.split(c, left_bounded=True, right_bounded=True)
    at_end, none = np.array([0.0, 2.0]), np.zeros(2)
    assert np.array_equal(weighted.density(split, at_end, at_end[::-1]), none)
    beside = Outside(np.array([1.0, -1.0]), np.full(2, 1e-200))
    assert np.all(np.isfinite(weighted.split_transform(split, beside)))


@pytest.mark.parametrize("kappa", KAPPAS)
def test_intensities_and_edge_slopes_are_the_first_terms_at_the_ends(kappa):
    """The density times d^(1 - gamma) is K + A d + O(d^2), where d is the distance from the end.
    At d = 1e-5 half widths, the last term is negligible.
    """
    weighted, c = JacobiFunctions(kappa), np.array([0.3, -0.7, 0.2, 0.5])
    d = np.array([1e-5, 3e-5])
    for k, slope, sides, gamma in zip(
        weighted.intensities(c),
        weighted.edge_slopes(c),
        ((d, 2 - d), (2 - d, d)),
        (weighted.rest, weighted.alpha),
        strict=True,
    ):
        density = weighted.weight(*sides) * weighted.values(c, *sides) * d ** (1 - gamma)
        scale = abs(k) + abs(slope)
        assert (3 * density[0] - density[1]) / 2 == pytest.approx(k, abs=1e-7 * scale)
        assert (density[1] - density[0]) / 2e-5 == pytest.approx(slope, abs=2e-3 * scale)
        assert density == pytest.approx(k + slope * d, abs=2e-8 * scale)


def test_mirror_images():
    weighted, c = JacobiFunctions(1.7), RNG.standard_normal(9)
    mirrored, d = weighted.mirrored, c * (-1.0) ** np.arange(9)
    left = np.array([0.2, 1.0, 1.9])
    assert weighted.values(c, left, 2 - left) == pytest.approx(mirrored.values(d, 2 - left, left))
    assert weighted.intensities(c) == pytest.approx(mirrored.intensities(d)[::-1])
    assert weighted.edge_slopes(c) == pytest.approx(mirrored.edge_slopes(d)[::-1])
    points = InPlane(np.array([1.2 + 0.5j]), np.array([-0.8 + 0.5j]))
    opposite = InPlane(np.array([0.8 + 0.5j]), np.array([-1.2 + 0.5j]))
    value, other = (
        w.transform_of(x, p)[0] for w, x, p in ((weighted, c, points), (mirrored, d, opposite))
    )
    assert value == pytest.approx(-np.conj(other), rel=1e-14)


def test_the_split_slope_is_the_derivative_of_the_split_transform():
    weighted, split = JacobiFunctions(-0.8), Split(0.3, -0.6, np.array([0.5, -0.2, 0.1]))
    for z in (0.4 + 0.7j, -1.5 + 0.1j):
        h = 1e-3

        def at(z):
            return weighted.split_transform(split, InPlane(np.array([z + 1]), np.array([z - 1])))

        slope = (8 * (at(z + h) - at(z - h)) - (at(z + 2 * h) - at(z - 2 * h))) / (12 * h)
        points = InPlane(np.array([z + 1]), np.array([z - 1]))
        assert weighted.split_slope(split, points) == pytest.approx(slope, rel=1e-8)


@pytest.mark.parametrize("kappa", KAPPAS)
def test_potentials_are_continuous_and_their_slopes_are_transforms(kappa):
    weighted, c = JacobiFunctions(kappa), RNG.standard_normal(12)
    angle = np.linspace(0.05, 3.1, 20)
    left, right = 2 * np.cos(angle / 2) ** 2, 2 * np.sin(angle / 2) ** 2
    upper = weighted.potential_of(c, InPlane.of(left, -right, np.zeros(20)))
    own = weighted.own_potential(c, left, right)
    scale = 1 / min(weighted.alpha, weighted.rest) + np.abs(upper).max()
    assert upper.real == pytest.approx(own, abs=2e-14 * scale)
    # The imaginary part of the potential above the interval is the integral of the density from
    # the point to the right end.
    integral = weighted.total(c) - weighted.integral_to(c, left, right)
    assert upper.imag == pytest.approx(integral, abs=2e-14 * scale)
    turns = np.exp(2j * np.pi * np.arange(16) / 16)
    for z, radius in ((0.3 + 0.4j, 0.05), (-1.4 + 0.9j, 0.1), (300j, 30.0)):
        around = z + radius * turns
        points = InPlane(around + 1, around - 1)
        values = weighted.potential_of(c, points)
        assert weighted.potentials(12, points) @ c == pytest.approx(values, abs=1e-13 * scale)
        slope = (values / turns).mean() / radius
        exact = weighted.transform_of(c, InPlane(np.array([z + 1]), np.array([z - 1])))
        assert exact[0] == pytest.approx(slope, abs=1e-14 * scale / radius)
    line = Outside(np.array([1.0, -1.0, -1.0]), np.array([0.2, 0.3, 5.0]))
    ends = np.array([2.2, -0.3, -5.0]), np.array([0.2, -2.3, -7.0])
    plane = weighted.potential_of(c, InPlane.of(*ends, np.zeros(3)))
    assert weighted.potential_of(c, line) == pytest.approx(plane.real, abs=1e-13 * scale)


def test_the_potential_of_the_first_kind():
    weighted, points = JacobiFunctions(0.0), Outside(np.array([1.0, -1.0]), np.array([1e-9, 3.0]))
    assert weighted.potentials(9, points) == pytest.approx(points.potentials(9, 1.0), abs=1e-14)
    assert weighted.level == pytest.approx(-np.log(2), rel=1e-15)
