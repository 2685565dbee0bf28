"""Algebraic points of the right side as sums of poles: the error of such a sum, the closed forms
of a pole compared with its series, and equations with known solutions.
"""

from dataclasses import replace
from math import gamma, pi, sqrt

import mpmath
import numpy as np
import pytest

import sie
from sie.density.density import Density
from sie.density.plane import Plane
from sie.jumps.formulas import of_sines
from sie.jumps.poles import NO_POLES, Poles
from sie.jumps.right_side import ForcingJumps

ZONES = sie.Zones.of([[-1.3, 0.4], [0.5, 2.0]])
EXPONENTS = (-0.4, 0.001, 0.5, 1.0, 1.5, 1.999, 2.0, 3.3, 6.5, 11.0)


def powers(points, y):
    """The sum of the declared powers at the signed distances y from the only algebraic point."""
    return sum(
        np.where(y < 0, left, right) * np.abs(y) ** p
        for p, left, right in zip(points.exponents, points.left, points.right, strict=True)
    )


@pytest.mark.parametrize("p", EXPONENTS)
@pytest.mark.parametrize("left,right", [(-1.0, 1.0), (1.0, 1.0), (0.0, 1.0), (0.7, -0.2)])
def test_the_poles_equal_the_power_up_to_a_smooth_function(p, left, right):
    points = sie.AlgebraicPoints([0.0], [p], [left], [right])
    away, size = points.poles(0, 1.0)

    def rest(y):
        return powers(points, y) - np.real((size / (y[:, None] - 1j * away)).sum(axis=1))

    # The omitted poles are at distances from 1.28 on. So `rest` is analytic closer to the line,
    # and its Chebyshev coefficients on [-1/2, 1/2] fall by a factor of 5.3 each.
    nodes = np.cos(pi * (np.arange(60) + 0.5) / 60)
    coefficients = np.polynomial.chebyshev.chebfit(nodes, rest(0.5 * nodes), 59)
    # The remaining coefficients are round-off of the power |y|^p, which is large near y = 0 if
    # p < 0.
    assert np.abs(coefficients[28:]).max() < 3e-14 * np.abs(rest(0.5 * nodes)).max()


@pytest.mark.parametrize("of_density", (False, True))
def test_the_closed_forms_of_poles_are_their_series(of_density):
    points = sie.AlgebraicPoints(
        [0.1, 0.44, 0.1], [1.5, 2.0, 0.4], [-1.0, 0.3, 0.2], [0.7, 1.0, 0.5]
    )
    poles = Poles.of(ZONES, points, 6.0, of_density)
    # Poles closer to the zone are left out, because their series would need more than 20,000
    # terms.
    keep = poles.away > 2e-3
    poles = Poles(
        poles.zone[keep],
        poles.left[keep],
        poles.right[keep],
        poles.away[keep],
        poles.size[keep],
        NO_POLES.points,
    )
    kernel, table = sie.hilbert(6.0), of_sines(poles.sine_coefficients(2, 20_000))
    closed = Density(
        ZONES, kernel, np.zeros((2, 2)), replace(ForcingJumps.none(), poles=poles), np.zeros(0)
    )
    series = Density(ZONES, kernel, table, ForcingJumps.none(), np.zeros(0))
    x = np.array([-1.2, -0.5, 0.1, 0.39, 0.44, 0.45, 0.49, 0.51, 0.7, 1.9, 2.2, 2.7])
    z = x + 1j * np.array([0.3, 0.01, 0.0, 1.0, 0.2, 0.001, 0.5, 0.1, -0.2, -0.01, 0.3, 0.02])
    pairs = [
        (getattr(closed, name)(x), getattr(series, name)(x))
        for name in ("transform", "potential", "integral", "__call__")
    ]
    pairs += [
        (Plane(closed)(z, what), Plane(series)(z, what))
        for what in ("transform", "derivative", "potential")
    ]
    pairs += [
        (closed.totals, series.totals),
        *zip(closed.edge_slopes, series.edge_slopes, strict=True),
    ]
    for one, other in pairs:
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-14)
    j = np.arange(1.0, 20_001.0)
    offsets = np.where(j == 1, -0.25, np.where(j % 2 == 1, 1 / np.maximum(j * j - 1, 1), 0.0))
    np.testing.assert_allclose(
        poles.mean_offsets(2), poles.sine_coefficients(2, 20_000) @ offsets, rtol=1e-12, atol=1e-15
    )


def load(p):
    """The total of the density for g = sgn(x) |x|^p: int |x|^(p+1) / sqrt(1 - x^2) dx over
    [-1, 1].
    """
    return sqrt(pi) * gamma(p / 2 + 1) / gamma(p / 2 + 1.5)


@pytest.mark.parametrize("p", (-0.5, -0.2, *EXPONENTS[1:]))
def test_a_power_on_the_right_side_has_its_known_density(p):
    """The right side g = sgn(x) |x|^p has on [-1, 1] the bounded density
    phi(x) = (p + 1) (load/pi) int_x^1 s^p / sqrt(s^2 - x^2) ds.

    Here `load` is the total. The integral is computed with s = x cosh(y).
    """
    points = sie.AlgebraicPoints([0.0], [p], [-1.0], [1.0])
    forcing = sie.Forcing(lambda x: np.sign(x) * np.abs(x) ** p, jumps=sie.Jumps(algebraic=points))
    solution = sie.solve(
        sie.Equation(sie.cauchy(), forcing, (sie.Total(load(p)),)), sie.Zones.of([[-0.71, 1.23]])
    )
    assert np.abs(solution.zones.table - [-1.0, 1.0]).max() <= max(solution.error, 1e-15) <= 1e-10
    with mpmath.workdps(25):
        for t in (0.01, 0.3, 0.9):
            cuts = mpmath.linspace(0, mpmath.acosh(1 / mpmath.mpf(t)), 7)
            expected = (
                (p + 1)
                * load(p)
                / pi
                * float(mpmath.quad(lambda y, t=t: (mpmath.mpf(t) * mpmath.cosh(y)) ** p, cuts))
            )
            assert float(solution.density.at(0, 1 + t, 1 - t)) == pytest.approx(expected, rel=1e-9)


def test_a_density_with_an_algebraic_point_is_found_from_its_transform():
    """The right side is the transform of phi = (1 - x^2)^(1/2) |x|^(1/2), computed with 20
    digits.

    Close to x = 0 the transform contains a multiple of |x|^(1/2) sgn(x). The algebraic point is
    declared as one of the density.
    """
    p = 0.5
    # sqrt(1 - x^2) = 1 - x^2/2 - x^4/8 - x^6/16 - 5 x^8/128 - ...
    series = [1.0, -1 / 2, -1 / 8, -1 / 16, -5 / 128, -7 / 256, -21 / 1024, -33 / 2048]
    points = sie.AlgebraicPoints([0.0] * 8, [p + 2 * k for k in range(8)], series, series)

    def transform(x):
        """The transform of the even density phi,

        (2 x/pi) int_0^1 (phi(xi) - phi(x)) / (x^2 - xi^2) dxi + (phi(x)/pi) log((1 + x)/(1 - x)).
        """
        out = []
        with mpmath.workdps(20):
            for at in np.abs(x).tolist():
                a = mpmath.mpf(at)
                phi = lambda s: mpmath.sqrt((1 - s) * (1 + s)) * s ** mpmath.mpf(p)  # noqa: E731
                here = phi(a)
                smooth = mpmath.quad(
                    lambda s, a=a, here=here, phi=phi: (phi(s) - here) / (a * a - s * s), [0, a, 1]
                )
                out.append(
                    float(
                        2 * a / mpmath.pi * smooth
                        + here / mpmath.pi * mpmath.log((1 + a) / (1 - a))
                    )
                )
        return np.sign(x) * np.array(out)

    known = {}

    def value(x):
        flat = np.ravel(x)
        for at in flat.tolist():
            known.setdefault(at, None)
        missing = np.array([at for at, one in known.items() if one is None])
        if len(missing):
            known.update(zip(missing.tolist(), transform(missing).tolist(), strict=True))
        return np.array([known[at] for at in flat.tolist()]).reshape(np.shape(x))

    zones = sie.Zones.of([[-1.0, 1.0]], sie.BOUNDED, sie.SINGULAR)
    state = sie.solve_fixed(
        sie.Equation(
            sie.cauchy(),
            sie.Forcing(value, jumps=sie.Jumps(algebraic=points, of_density=True)).trusted(),
            (),
        ),
        zones,
        1e-9,
    )
    t = np.array([0.01, 0.2, 0.5, 0.8])
    np.testing.assert_allclose(
        state.density.at(0, 1 + t, 1 - t), np.sqrt(1 - t * t) * np.sqrt(t), atol=1e-8
    )


def test_exponents_of_minus_one_are_refused():
    with pytest.raises(ValueError, match="above -1"):
        sie.AlgebraicPoints([0.0], [-1.0], [1.0], [1.0])
