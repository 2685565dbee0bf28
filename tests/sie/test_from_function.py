"""Densities given as functions: their fields, and the reasons for which functions are refused."""

import mpmath as mp
import numpy as np
import pytest

import sie

# For the kinds of the left and the right end, the powers of the distances from these ends.
ENDS = {
    (sie.SINGULAR, sie.SINGULAR): (-0.5, -0.5),
    (sie.SINGULAR, sie.FREE): (-0.5, 0.5),
    (sie.BOUNDED, sie.SINGULAR): (0.5, -0.5),
    (sie.FREE, sie.BOUNDED): (0.5, 0.5),
}


def by_quadrature(powers, a, b, z):
    """(1/pi) int e^xi (xi - a)^p (b - xi)^q / (z - xi) over (a, b), xi = a + (b - a) sin^2(u)."""
    p, q = powers

    def part(u):
        left, right = (b - a) * mp.sin(u) ** 2, (b - a) * mp.cos(u) ** 2
        weight = 2 * left ** (p + 0.5) * right ** (q + 0.5)
        return mp.exp(a + left) * weight / (z - a - left)

    with mp.workdps(25):
        return complex(mp.quad(part, mp.linspace(0, mp.pi / 2, 6)) / mp.pi)


@pytest.mark.parametrize(("ends", "powers"), ENDS.items())
def test_the_field_of_a_given_density_is_its_integral(ends, powers):
    a, b = -0.5, 0.75
    density = sie.Density.from_function(
        lambda x: np.exp(x) * (x - a) ** powers[0] * (b - x) ** powers[1],
        sie.Zones.of([[a, b]], *ends),
    )
    for z in (0.9 + 0.0j, 0.2 + 0.1j, -0.5 - 0.01j, 3.0 - 2.0j):
        exact = by_quadrature(powers, a, b, z)
        assert abs(density.transform(z) - exact) < 1e-12 * max(abs(exact), 1.0)


def test_a_given_density_solves_the_equation_of_its_own_transform():
    """Two zones with a period: the transform as right side gives the density back."""
    zones = sie.Zones.of([[-0.3, -0.1], [0.05, 0.4]], sie.SINGULAR, [sie.SINGULAR, sie.BOUNDED])

    def f(x):
        first = np.cos(3 * x) / np.sqrt(np.abs((x + 0.3) * (-0.1 - x)))
        second = np.sin(5 * x) * np.sqrt(np.abs((0.4 - x) / (x - 0.05)))
        return np.where(x < 0, first, second)

    given = sie.Density.from_function(f, zones, sie.hilbert(1.0))
    equation = sie.Equation(given.kernel, given.transform, sie.Total(given.total))
    found = sie.solve(equation, zones).density
    x = np.array([-0.29, -0.2, 0.06, 0.2, 0.399])
    assert np.abs(found(x) / f(x) - 1).max() < 1e-10
    assert np.abs(given(x) / f(x) - 1).max() < 1e-12
    assert np.abs(found.potential(0.0) - given.potential(0.0)) < 1e-11


def test_bounded_ends_keep_their_digits():
    zone = sie.Zones.of([[-1.0, 1.0]])
    density = sie.Density.from_function(lambda x: np.sqrt((1 - x) * (1 + x)), zone)
    d = np.array([1e-3, 1e-8, 1e-13])
    assert np.abs(density.at(0, 2 - d, d) / np.sqrt(d * (2 - d)) - 1).max() < 1e-12
    assert density.intensities[0][0] == density.intensities[1][0] == 0.0


@pytest.mark.parametrize(
    ("f", "kind", "message"),
    [
        (lambda x: 1 + 0 * x, sie.SINGULAR, r"near the left end it varies as d\^-?0.00"),
        (lambda x: 1 / np.sqrt(1 - x * x), sie.FREE, "declare this end sie.SINGULAR"),
        (lambda x: np.abs(x - 0.1) * np.sqrt(1 - x * x), sie.FREE, "a jump, a kink"),
        (lambda x: np.log(x), sie.FREE, "not finite at x"),
        (lambda x: 1j * x, sie.FREE, "real values"),
        (lambda x: 1.0, sie.FREE, "array of shape"),
        (3.0, sie.FREE, "must be a function"),
    ],
)
def test_a_function_that_is_no_density_is_refused_with_its_reason(f, kind, message):
    with pytest.raises(ValueError, match=message):
        sie.Density.from_function(f, sie.Zones.of([[-1.0, 1.0]], kind, kind))


def test_wrong_arguments_are_named():
    zone = sie.Zones.of([[-1.0, 1.0]])
    with pytest.raises(ValueError, match="tol"):
        sie.Density.from_function(np.sin, zone, tol=2.0)
    with pytest.raises(ValueError, match="zones"):
        sie.Density.from_function(np.sin, [[-1, 1]])
    with pytest.raises(ValueError, match="kernel"):
        sie.Density.from_function(np.sin, zone, kernel=sie.cauchy)
