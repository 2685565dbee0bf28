"""Chebyshev nodes, series and their parts on one zone, against closed forms and identities."""

import mpmath
import numpy as np
import pytest
from numpy.polynomial import chebyshev as np_chebyshev

from sie.basis import chebyshev

# Sizes below and above the size from which fast transforms replace a stored matrix.
SIZES = [1, 2, 5, 16, 127, 128, 129, 300]


def u(k, t):
    """U_{k-1}(cos theta) = sin(k theta) / sin(theta)."""
    theta = np.arccos(t)
    return np.sin(k * theta) / np.sin(theta)


@pytest.mark.parametrize("n", [1, 7, 1000])
def test_distances_to_the_ends_lose_no_digit(n):
    t, right, left = chebyshev.lobatto(n)
    with mpmath.workdps(30):
        for k in {0, 1, n // 2, n, n + 1}:
            cosine = mpmath.cos(mpmath.mpf(k) * mpmath.pi / (n + 1))
            assert right[k] == pytest.approx(float(1 - cosine), rel=4e-15, abs=0)
            assert left[k] == pytest.approx(float(1 + cosine), rel=4e-15, abs=0)
            assert t[k] == pytest.approx(float(cosine), abs=2e-16)


@pytest.mark.parametrize("n", SIZES)
def test_each_u_polynomial_has_one_coefficient(n):
    t = chebyshev.lobatto(n)[0][1:-1]
    values = np.array([u(k, t) for k in range(1, n + 1)])
    assert chebyshev.u_coefficients(values) == pytest.approx(np.eye(n), abs=1e-14 * n)


@pytest.mark.parametrize("n", SIZES)
def test_project_rows_gives_the_coefficients_of_each_column(n):
    values = np.random.default_rng(n).normal(size=(n, 3))
    assert chebyshev.project_rows(values) == pytest.approx(
        chebyshev.u_coefficients(values.T).T, abs=1e-13
    )


def test_coefficients_of_a_pole_decay_at_its_rate():
    pole = 1.25
    rho = pole - np.sqrt(pole**2 - 1)
    g = chebyshev.u_coefficients(1 / (pole - chebyshev.lobatto(64)[0][1:-1]))
    # With the pole z, 1/(z - t) = 2 sum rho^k U_{k-1}(t).
    k = np.arange(1, 33)
    assert g[:32] == pytest.approx(2 * rho**k, rel=1e-5, abs=1e-15)
    rate = np.polyfit(k, np.log(np.abs(g[:32])), 1)[0]
    assert rate == pytest.approx(np.log(rho), rel=1e-5)


@pytest.mark.parametrize("n", [1, 2, 9, 40])
def test_means_with_chebyshev_polynomials_are_orthogonal(n):
    t = chebyshev.gauss(n)
    for j in range(n):
        expected = np.zeros(n)
        expected[j] = 1.0 if j == 0 else 0.5
        assert chebyshev.t_means(np.cos(j * np.arccos(t))) == pytest.approx(expected, abs=1e-13)


def test_the_matrix_of_values_is_that_of_the_polynomials():
    n, count = 11, 8
    expected = np_chebyshev.chebvander(chebyshev.gauss(n), count - 1)
    assert chebyshev.t_matrix(n, count) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("n", [1, 2, 3, 10, 41])
def test_the_singular_and_the_bounded_part_add_up_to_the_density(n):
    rng = np.random.default_rng(n)
    c, t = rng.normal(size=(2, n)), rng.uniform(-0.99, 0.99, 9)
    alpha, beta, uk = chebyshev.bounded_part(c)
    root = np.sqrt(1 - t * t)
    for i in range(2):
        whole = np_chebyshev.chebval(t, c[i]) / root
        bounded = sum((uk[i, k] * u(k + 1, t) for k in range(uk.shape[1])), np.zeros_like(t))
        assert (alpha[i] + beta[i] * t) / root + root * bounded == pytest.approx(
            whole, rel=1e-12, abs=1e-12
        )


@pytest.mark.parametrize("n", [1, 2, 3, 10, 41])
def test_values_at_the_ends_are_those_of_the_singular_and_the_bounded_part(n):
    c = np.random.default_rng(n).normal(size=(3, n))
    alpha, beta, uk = chebyshev.bounded_part(c)
    k = np.arange(uk.shape[1])
    expected = uk @ ((k + 1) * (-1.0) ** k), uk @ (k + 1)
    assert np.array(chebyshev.slopes_at_ends(c)) == pytest.approx(
        np.array(expected), rel=1e-13, abs=1e-13 * n**2
    )
    assert np.array(chebyshev.edge_part(c)) == pytest.approx(np.array([alpha, beta]), abs=1e-14 * n)


def test_a_density_without_square_root_singularity_has_no_singular_part():
    # sqrt(1 - t^2) U_1 = (T_1 - T_3) / (2 sqrt(1 - t^2)).
    alpha, beta, uk = chebyshev.bounded_part(np.array([[0.0, 0.5, 0.0, -0.5]]))
    assert alpha[0] == 0 and beta[0] == 0
    assert uk[0] == pytest.approx([0.0, 1.0])


@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_a_series_on_moved_zones_has_the_same_values_at_the_same_places(n):
    from sie.basis.chebyshev import lobatto, u_coefficients, u_moved

    rng, t = np.random.default_rng(n), lobatto(n)[0][1:-1]
    g = rng.standard_normal((3, n)) * 0.3 ** np.arange(n)
    shift, stretch = np.array([0.0, 0.01, -0.2]), np.array([1.0, 0.98, 0.7])
    at = np.arccos(shift[:, None] + stretch[:, None] * t)
    values = (g[:, None, :] * np.sin(np.arange(1, n + 1) * at[..., None])).sum(axis=-1) / np.sin(at)
    assert u_moved(g, shift, stretch) == pytest.approx(u_coefficients(values), abs=1e-13)
