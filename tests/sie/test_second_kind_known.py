"""Equations of the second kind, compared with published numbers and with closed forms.

The first part has numbers from the tests of the package SingularIntegralEquations.jl (S. Olver
and R. M. Slevinsky, MIT licence), for intervals. Most of them were computed with Mathematica.
That package does not solve equations of the second kind with constant factors on intervals. It
computes transforms of (1 - x)^p (1 + x)^q times a function. Only if p + q is an integer, such a
product is the density of an equation with kappa. Then come equations of the package, one of them
with a factor that varies. The last part has closed forms.

With alpha as in docs/engine.md, s = sin(pi alpha) and |X| = (b - x)^alpha (x - a)^(1 - alpha),
the density of one zone with bounded ends is

    phi = (kappa g - |X| (1/pi) PV int g(xi) / (|X(xi)| (x - xi)) dxi) / (1 + kappa^2),

for any right side with int g/|X| = 0. Its total is s int xi g/|X| (N. I. Muskhelishvili,
Singular Integral Equations, 1953, sect. 107). For one singular end at a,
|X| = (b - x)^alpha (x - a)^(-alpha). Then g need not meet a condition, and the total is s
int g/|X|.
"""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from scipy.special import betainc, betaincinv

import sie
from tests.tiers import quick

KAPPAS = [-3.0, -0.3, 0.05, 0.7, 12.0]
S, B = sie.SINGULAR, sie.BOUNDED
NO_KAPPA = 1e-300  # the exponents are exactly 1/2, but the solver is that for equations with kappa


def alpha_of(kappa):
    return np.arctan2(1.0, kappa) / np.pi


def given_density(f, ends, powers, kappa):
    """The density f(x) (x - a)^p (b - x)^q with (p, q) = powers and a smooth f, as a
    `SecondKindDensity`.

    p is -alpha or 1 - alpha, and q is alpha - 1 or alpha. The 30 coefficients are found by
    interpolation.
    """
    a, b = ends
    equation = sie.Equation(sie.cauchy(), np.zeros_like, kappa=kappa)
    zones = equation.weighted(sie.Zones.of([[a, b]], S, S))
    t = np.cos((np.arange(30) + 0.5) * np.pi / 30)
    left, right = 0.5 * (b - a) * (1 + t), 0.5 * (b - a) * (1 - t)
    unit = sie.SecondKindDensity(zones, sie.cauchy(), np.eye(30)[:1])
    columns = [replace(unit, coefficients=row[None]).at_t(0, t) for row in np.eye(30)]
    weight = left ** powers[0] * right ** powers[1]
    scale = weight / unit.at_t(0, t)
    table = np.transpose(columns) / unit.at_t(0, t)[:, None]
    c = np.linalg.solve(table, f(a + left) * scale)
    return replace(unit, coefficients=c[None])


def by_quadrature(f, powers, ends, kernel):
    """The integral of f(xi) (xi - a)^p (b - xi)^q kernel(xi) by xi from a to b, with about 15
    digits. `f` and `kernel` are functions of mpmath numbers.
    """
    with mp.workdps(20):
        a, b = map(mp.mpf, ends)
        p, q = map(mp.mpf, powers)

        def part(s):  # xi = a + (b - a) / (1 + exp(-s)), which keeps the distances from both ends
            left, right = (b - a) / (1 + mp.exp(-s)), (b - a) / (1 + mp.exp(s))
            return f(a + left) * left ** (p + 1) * right ** (q + 1) * kernel(a + left) / (b - a)

        far = 44 / min(p + 1, q + 1)
        points = [-far, -16, -6, -2, 2, 6, 16, far]
        return mp.quad(part, points)


# Numbers of the package for the density e^x (x - a)^power (b - x)^power on [a, b]: (ends, power,
# x, transform at x, potential at x or None). The package's Hilbert transform has 1/(xi - x)
# where the transform here has 1/(x - xi).
ON_THE_INTERVAL = [
    ((-2, -1), 0.5, -1.2, 0.057515957831535571, -0.05044654410790341),
    ((-2, -1), -0.5, -1.2, -0.26527878405434321204, -0.39563660592242765),
    ((-1, 1), -0.5, 0.1, -1.1404096104609646386, -0.8545003781055088),
    ((-1, 2), -0.5, 0.1, -1.6649936695644078289, 0.49127801561694168644),
    ((-1, 1), 0.5, 0.1, -0.43723982258866913063, None),
    ((-1, 2), 0.5, 0.1, -2.1380903070701673244, None),
]
# (power, point z, int phi/(z - xi) dxi, int phi log(z - xi) dxi) for phi = e^x (1 - x^2)^power.
OFF_THE_INTERVAL = [
    (-0.5, 3 + 1.5j, 1.1589646343327455 - 0.7273679005911283j, None),
    (0.5, 3.0, 0.661642255728541, 1.7772163062194637),
    (-0.5, 3.0, None, 3.6322473044237515),
]


@pytest.mark.parametrize(("ends", "power", "x", "transform", "potential"), ON_THE_INTERVAL)
def test_numbers_on_the_interval(ends, power, x, transform, potential):
    density = given_density(np.exp, ends, (power, power), NO_KAPPA)
    assert float(density.transform(x)) == pytest.approx(transform, rel=1e-12)
    if potential is not None:
        assert float(density.potential(x)) == pytest.approx(potential, rel=1e-12)


@pytest.mark.parametrize(("power", "z", "transform", "potential"), OFF_THE_INTERVAL)
def test_numbers_off_the_interval(power, z, transform, potential):
    density = given_density(np.exp, (-1, 1), (power, power), NO_KAPPA)
    if transform is not None:
        assert np.pi * complex(density.transform(z)) == pytest.approx(transform, rel=1e-12)
    if potential is not None:
        assert np.pi * float(density.potential(z)) == pytest.approx(potential, rel=1e-12)


# Ten coefficients of a series of Jacobi polynomials, from SingularIntegralEquations.jl.
TEN = [
    0.9731840665678853,
    0.11644664868790366,
    0.8961305368364185,
    0.30663942299763747,
    0.4564158422422153,
    0.7262396331533589,
    0.6448725310785985,
    0.05623500638232981,
    0.8452582204677404,
    0.25385833878392283,
]
# Powers of the distances from the left and the right end.
JACOBI = [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)]
JACOBI += [(0.123, -0.123), (-0.123, 0.123), (-0.123, -0.877), (0.544, 0.456), (-0.9, -0.1)]


def kappa_of(powers):
    """The kappa of an equation whose densities have these powers at the left and right end."""
    exact_half = abs(powers[1]) == 0.5
    return NO_KAPPA if exact_half else float(mp.cot(mp.pi * mp.mpf(str(powers[1] % 1.0))))


def jacobi(n, powers, x):
    """The Jacobi polynomial of the order n for the weight (1 + x)^p (1 - x)^q, (p, q) = powers."""
    p, q = map(mp.mpf, powers)
    return (
        sum(
            mp.binomial(n + q, n - k) * mp.binomial(n + p, k) * (x - 1) ** k * (x + 1) ** (n - k)
            for k in range(n + 1)
        )
        / mp.mpf(2) ** n
    )


@pytest.mark.parametrize(
    ("left", "right"), quick(JACOBI, [(-0.5, 0.5), (-0.123, -0.877), (0.544, 0.456)])
)
def test_transforms_of_jacobi_series(left, right):
    """The transform agrees with quadrature at points of the package's tests. Among them is
    0.1 + 0.1i, close to the interval, where 1/(z - xi) is steep. The jump of the transform
    across the interval gives the density.
    """
    powers = left, right
    with mp.workdps(40):
        x = [mp.mpf(k - 4.5) / 5 for k in range(10)]
        values = [sum(c * jacobi(n, powers, one) for n, c in enumerate(TEN)) for one in x]
        powers_of_x = mp.matrix([[one ** (9 - n) for n in range(10)] for one in x])
        polynomial = list(mp.lu_solve(powers_of_x, mp.matrix(values)))
    series = lambda x: sum(c * x ** (9 - n) for n, c in enumerate(polynomial))  # noqa: E731
    float_series = np.vectorize(lambda x: float(series(mp.mpf(x))), otypes=[float])
    density = given_density(float_series, (-1, 1), powers, kappa_of(powers))
    for z in (1 + 1j, 0.1 + 0.1j, 2.12312231 + 1.433453443534j):
        exact = complex(
            by_quadrature(series, powers, (-1, 1), lambda xi, z=z: 1 / (mp.mpc(z) - xi))
        )
        assert np.pi * complex(density.transform(z)) == pytest.approx(exact, rel=1e-11)
    above, below = (complex(density.transform(0.1 + side * 1e-16j)) for side in (1, -1))
    assert (below - above) / 2j == pytest.approx(float(density(0.1)), rel=1e-12)


@pytest.mark.parametrize("powers", [(-0.1, 0.1), (0.1, -0.1), (0.9, 0.1), (-0.1, -0.9)])
def test_transforms_and_potentials_of_a_weighted_exponential(powers):
    density = given_density(np.exp, (-1, 1), powers, kappa_of(powers))
    for x in (2.0, -10.0):
        transform, potential = (
            float(by_quadrature(mp.exp, powers, (-1, 1), kernel).real)
            for kernel in (lambda xi, x=x: 1 / (x - xi), lambda xi, x=x: mp.log(abs(x - xi)))
        )
        assert np.pi * float(density.transform(x)) == pytest.approx(transform, rel=1e-12)
        assert np.pi * float(density.potential(x)) == pytest.approx(potential, rel=1e-12)


# Equations from the package's tests.
def test_ideal_flow_around_two_plates():
    """In the notation of the package, H f + a on the left plate and H f + b on the right plate
    are equal to -2 x sin(1.3), for 0.3 < |x| < 1. The package gives a, b and f(1/2).
    """
    plates = sie.Zones.of([[-1.0, -0.3], [0.3, 1.0]], B, B)
    columns = (lambda x: 1.0 * (x < 0), lambda x: 1.0 * (x > 0))
    for kappa in (0.0, NO_KAPPA):
        equation = sie.Equation(
            sie.cauchy(), lambda x: 2 * x * np.sin(1.3), (), columns, kappa=kappa
        )
        found = sie.solve(equation, plates, tol=1e-12)
        assert found.amplitudes == pytest.approx([1.151966678272007, -1.151966678272007], rel=1e-11)
        assert found.density(0.5) == pytest.approx(0.6384624727021831, rel=1e-11)


def test_flow_at_an_angle_around_two_plates():
    """The complex velocity potential at 0.1 + 0.2i of a flow past plates on [-1, -0.5] and
    [-0.3, 1].
    """
    turn = np.exp(114j / 50)
    plates = sie.Zones.of([[-1.0, -0.5], [-0.3, 1.0]], B, B)
    columns = (lambda x: 1.0 * (x < -0.4), lambda x: 1.0 * (x > -0.4))
    equation = sie.Equation(sie.cauchy(), lambda x: -(turn * x).imag, (), columns, kappa=NO_KAPPA)
    density = sie.solve(equation, plates, tol=1e-12).density
    z = 0.1 + 0.2j
    value = turn * z + 1j * complex(density.transform(z))
    assert value == pytest.approx(-0.5762722129639637 + 0.04348367760228282j, rel=1e-10)


@pytest.mark.parametrize("a", [np.sqrt(np.sqrt(5) - 2) / 2, 1.0, 10.0])
def test_an_equation_with_a_varying_factor(a):
    """In the notation of the package, H (w u) + x u / (a sqrt(1 + a^2)) = 0, with
    w = (1 - x^2)^(-1/2) and u(-1) = 1.

    The solution is u = (1 + a^2) / (x^2 + a^2). In this test the second term, with the known u,
    is moved to the right side.
    """
    u = lambda x: (1 + a * a) / (x * x + a * a)  # noqa: E731
    equation = sie.Equation(
        sie.cauchy(),
        lambda x: x * u(x) / (a * np.sqrt(1 + a * a)),
        sie.Total(np.pi * np.sqrt(1 + a * a) / a),
        kappa=NO_KAPPA,
    )
    found = sie.solve(equation, sie.Zones.of([[-1.0, 1.0]], S, S), tol=1e-11)
    x = np.array([-0.999, -0.3, 0.0, 0.6])
    assert found.density(x) * np.sqrt(1 - x * x) == pytest.approx(u(x), rel=1e-10)
    assert found.density.intensities[0][0] * np.sqrt(2.0) == pytest.approx(1.0, rel=1e-10)


# Closed forms.
def density_by_quadrature(g, powers, ends, kappa, x, split=()):
    """phi at x, by the formula at the head of this module. If the first number of `powers` is
    negative, the left end is singular.

    g is a function of mpmath numbers, smooth between the points `split`. Only g - g(x) is
    integrated numerically. The principal value for the constant g(x) is g(x) times `_constant`.
    """
    p, q = powers
    with mp.workdps(20):
        alpha = mp.atan2(1, kappa) / mp.pi
        p = -alpha if p < 0 else 1 - alpha
        size = lambda t: (t - ends[0]) ** p * (ends[1] - t) ** alpha  # noqa: E731
        points = sorted([*map(mp.mpf, ends), *map(mp.mpf, split), mp.mpf(x)])
        total = mp.mpf(0)
        off = lambda t: (g(t) - g(x)) / (x - t) if t != x else mp.mpf(0)  # noqa: E731
        for low, high in zip(points, points[1:], strict=False):
            total += _piece(off, (low, high), ends, (p, alpha))
        sine = mp.sin(mp.pi * alpha)
        principal = total / mp.pi + g(x) * _constant(p, alpha, size(x), kappa, sine, ends, x)
        return float((kappa * g(x) - size(x) * principal) * sine**2)


def _constant(p, alpha, size, kappa, sine, ends, x):
    """(1/pi) PV int dxi / (|X(xi)| (x - xi)), from the behaviour of 1/X at infinity."""
    # (s/pi) int dxi / (|X| (z - xi)) is 1/X for bounded ends, and 1/X - 1 for a singular left end.
    at_infinity = 1 if p < 0 else 0
    return (kappa * sine / size - at_infinity) / sine


def _piece(f, piece, ends, powers):
    """The integral of f / ((t - a)^p (b - t)^q) over a piece between two neighbouring points.
    [a, b] are the `ends`, (p, q) are the `powers`.
    """
    low, high = piece

    def part(s):
        left, right = (high - low) / (1 + mp.exp(-s)), (high - low) / (1 + mp.exp(s))
        t = low + left if left < right else high - right
        from_a = left if low == ends[0] else t - ends[0]
        to_b = right if high == ends[1] else ends[1] - t
        return f(t) * from_a ** -powers[0] * to_b ** -powers[1] * left * right / (high - low)

    far = 44 / min(1 - powers[0], 1 - powers[1], 1)
    return mp.quad(part, [-far, -16, -6, 0, 6, 16, far])


@pytest.mark.parametrize("kappa", quick(KAPPAS, [-3.0, 0.7]))
def test_a_sliding_wedge(kappa):
    """A sliding wedge, g = sign(x), on a zone of the width 1: the apex is at the median of a
    beta distribution. The total is pi times the mean of |x|.

    Both follow from the formulas at the head of this module, as s / (pi |X|) is the density of
    the distribution. D. A. Hills, D. Nowell, A. Sackfield, Mechanics of Elastic Contacts, 1993,
    solve the same problem.
    """
    a = alpha_of(kappa)
    share = betaincinv(a, 1 - a, 0.5)
    ends = -share, 1 - share
    # `mean` is the mean of |x| with x = B - share, where B has the distribution
    # beta(alpha, 1 - alpha).
    upper = lambda p: a * (1 - betainc(a + 1, 1 - a, share)) if p else 0.5  # noqa: E731
    mean = 2 * (upper(1) - 0.5 * share) - (a - share)
    total = np.pi * mean
    equation = sie.Equation(
        sie.cauchy(),
        sie.Forcing(np.sign, np.abs, sie.Jumps([0.0], [2.0])),
        sie.Total(total),
        kappa=kappa,
    )
    start = [[ends[0] - 0.1 * share, ends[1] + 0.04]]
    found = sie.solve(equation, sie.Zones.of(start), tol=1e-11)
    assert found.zones.table[0] == pytest.approx(ends, abs=1e-9)
    for x in (ends[0] * 0.6, ends[1] * 0.01, ends[1] * 0.7):
        exact = density_by_quadrature(lambda t: mp.sign(t), (1, 1), ends, kappa, x, [0.0])
        assert float(found.density(x)) == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize("kappa", quick(KAPPAS, [-3.0, 0.7]))
def test_a_sliding_profile_of_the_fourth_power(kappa):
    """A sliding profile with the slope g = x^3, on a zone of the width 1: the mean of x^3 over a
    beta distribution is 0. The total is pi times the mean of x^4.
    """
    a = alpha_of(kappa)
    raw = [1.0]
    for n in range(5):
        raw.append(raw[-1] * (a + n) / (1 + n))
    roots = np.roots([-1.0, 3 * raw[1], -3 * raw[2], raw[3]])
    share = float(roots[np.abs(roots.imag) < 1e-9].real[0])
    fourth = sum(c * raw[4 - k] for k, c in enumerate(np.poly([share] * 4)))
    total = np.pi * fourth
    equation = sie.Equation(sie.cauchy(), lambda x: x**3, sie.Total(total), kappa=kappa)
    found = sie.solve(equation, sie.Zones.of([[-share - 0.05, 1.06 - share]]), tol=1e-11)
    ends = found.zones.table[0]
    assert ends == pytest.approx([-share, 1 - share], abs=1e-8)
    for x in (-0.5 * share, 0.9 - share):
        exact = density_by_quadrature(lambda t: t**3, (1, 1), (-share, 1 - share), kappa, x)
        assert float(found.density(x)) == pytest.approx(exact, abs=1e-7)


@pytest.mark.parametrize("kappa", KAPPAS)
def test_a_tilted_sliding_punch_leaves_the_ground(kappa):
    """A tilted flat punch, g = 0.7, has a corner at -1 and loses contact at b. The density is
    phi = 0.7 s ((b - x) / (x + 1))^alpha, with the total 0.7 pi alpha (b + 1).
    """
    a = alpha_of(kappa)
    width = 1 / (0.7 * np.pi * a)
    equation = sie.Equation(
        sie.cauchy(), lambda x: np.full_like(x, 0.7), sie.Total(1.0), kappa=kappa
    )
    found = sie.solve(equation, sie.Zones.of([[-1.0, 0.9 * width - 1]], S, sie.FREE), tol=1e-11)
    assert found.zones.b[0] + 1 == pytest.approx(width, rel=1e-9)
    x = -1 + width * np.array([0.01, 0.5, 0.99])
    exact = 0.7 * np.sin(np.pi * a) * ((width - 1 - x) / (x + 1)) ** a
    assert found.density(x) == pytest.approx(exact, rel=1e-7)
    # The moment is int (x + 1) phi dx = 0.7 pi width^2 alpha (1 - alpha) / 2.
    moment = 0.7 * np.pi * width**2 * a * (1 - a) / 2
    assert found.density.moment(-1.0) == pytest.approx(moment, rel=1e-8)


@pytest.mark.parametrize("kappa", quick([0.0001, 0.1, 0.7, 5.0], [0.0001, 0.7]))
def test_a_porous_aerofoil_with_a_flap(kappa):
    """The right side is the incidence 0.3, the camber -0.2 x and a flap turned by 0.1 from x =
    0.4 on. The Kutta condition holds at x = 1.

    Seepage through the plate, proportional to the pressure jump, gives this equation (P. J.
    Baddoo, R. Hajian, J. W. Jaworski, arXiv:1911.07382). With incidence alone, the lift is 2
    alpha times that of a plate without pores.
    """
    a = alpha_of(kappa)
    flap = 0.1 * (1 - betainc(1 + a, 1 - a, 0.7))
    unit = 2 * np.pi * a  # s times the integral of (1 - x)^(-alpha) (1 + x)^alpha
    # Let (1 + x) / 2 have the distribution beta(1 + alpha, 1 - alpha), whose density has the
    # same powers. Then the mean of x is alpha.
    total = unit * (0.3 - 0.2 * a + flap)
    forcing = sie.Forcing(lambda x: 0.3 - 0.2 * x + 0.1 * (x > 0.4), None, sie.Jumps([0.4], [0.1]))
    equation = sie.Equation(sie.cauchy(), forcing, kappa=kappa)
    found = sie.solve(equation, sie.Zones.of([[-1.0, 1.0]], S, B), tol=1e-12)
    assert found.density.total == pytest.approx(total, rel=1e-10)
    g = lambda t: mp.mpf("0.3") - mp.mpf("0.2") * t + (mp.mpf("0.1") if t > 0.4 else 0)  # noqa: E731
    for x in (-0.8, 0.39, 0.9):
        exact = density_by_quadrature(g, (-1, 1), (-1, 1), kappa, x, [0.4])
        assert float(found.density(x)) == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize("kappa", quick(KAPPAS, [-3.0, 0.7]))
def test_two_sliding_punches(kappa):
    """Two sliding flat punches have phi = +-s (d + e x) / |X|, with the minus sign on the left
    zone. |X| is the product of (x - a)^alpha (b - x)^(1 - alpha) in absolute value over both
    zones [a, b].

    Quadrature of the totals gives d and e.
    """
    ends, a = [(-1.0, -0.2), (0.3, 1.1)], alpha_of(kappa)

    def others(x, zone):
        low, high = ends[1 - zone]
        return abs(x - low) ** -a * abs(high - x) ** (a - 1)

    sine = np.sin(np.pi * a)
    matrix = np.array(
        [
            [
                sign
                * sine
                * float(
                    by_quadrature(
                        lambda x, zone=zone, n=n: x**n * others(x, zone),
                        (-a, a - 1),
                        ends[zone],
                        lambda _: 1,
                    )
                )
                for n in (0, 1)
            ]
            for zone, sign in ((0, -1), (1, 1))
        ]
    )
    d, e = np.linalg.solve(matrix, [0.3, 0.7])
    zones = sie.Zones.of(ends, S, S)
    equation = sie.Equation(sie.cauchy(), np.zeros_like, sie.ZoneTotals((0.3, 0.7)), kappa=kappa)
    density = sie.solve(equation, zones, tol=1e-12).density
    for zone, sign in ((0, -1), (1, 1)):
        low, high = ends[zone]
        x = low + (high - low) * np.array([0.05, 0.4, 0.9])
        own = (x - low) ** -a * (high - x) ** (a - 1)
        exact = sign * sine * (d + e * x) * own * others(x, zone)
        assert density(x) == pytest.approx(exact, rel=1e-10)
    z = 0.05 + 0.2j
    product = np.prod([(z - high) ** (a - 1) * (z - low) ** -a for low, high in ends])
    assert complex(density.transform(z)) == pytest.approx((d + e * z) * product, rel=1e-10)


@pytest.mark.parametrize("kappa", KAPPAS)
def test_a_row_of_sliding_flat_punches(kappa):
    """A periodic row of sliding flat punches, with the total 1 in each period L.

    The density is phi =
    s/L cos(pi x/L - mu) sin(pi (b - x)/L)^(alpha - 1) sin(pi (x - a)/L)^(-alpha). The transform
    far above the line gives mu = (1 - alpha) pi b/L + alpha pi a/L.
    """
    (low, high), period, a = (-0.5, 0.9), 2.0, alpha_of(kappa)
    equation = sie.Equation(sie.hilbert(period), np.zeros_like, sie.Total(1.0), kappa=kappa)
    density = sie.solve(equation, sie.Zones.of([[low, high]], S, S), tol=1e-12).density
    x, unit = np.array([-0.49, 0.1, 0.85]), np.pi / period
    mu = unit * ((1 - a) * high + a * low)
    exact = np.sin(np.pi * a) / period * np.cos(unit * x - mu)
    exact *= np.sin(unit * (high - x)) ** (a - 1) * np.sin(unit * (x - low)) ** -a
    assert density(x) == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize("kappa", KAPPAS)
@pytest.mark.parametrize("width", [0.3, 0.9, 1.4])
def test_a_sliding_wavy_surface(kappa, width):
    """A sliding wave, g = sin(2 pi x/L) with L = 2, has the density
    phi = 2 s cos(pi x/L + mu) |X|.

    Here |X| = sin(B - pi x/L)^alpha sin(pi x/L - A)^(1 - alpha), with the ends A = pi a/L and
    B = pi b/L, and mu = alpha B + (1 - alpha) A. The transform far above the line gives

        exp(2 i mu) - alpha exp(-2 i B) - (1 - alpha) exp(-2 i A) = 2 total/L.

    The imaginary part of this equation gives A for a given width B - A. Without friction the
    solution is that of Westergaard.
    """
    a, unit = alpha_of(kappa), np.pi / 2
    low = -0.5 * np.angle(np.exp(2j * a * width) + a * np.exp(2j * width) + 1 - a)
    high, mu = low + width, low + a * width
    total = (np.exp(2j * mu) - a * np.exp(-2j * high) - (1 - a) * np.exp(-2j * low)).real
    equation = sie.Equation(
        sie.hilbert(2.0), lambda x: np.sin(np.pi * x), sie.Total(total), kappa=kappa
    )
    start = np.array([[low - 0.02 * width, high + 0.05 * width]]) / unit
    found = sie.solve(equation, sie.Zones.of(start), tol=1e-11)
    assert found.zones.table[0] * unit == pytest.approx([low, high], abs=1e-8)
    x = low + width * np.array([0.1, 0.5, 0.9])
    exact = 2 * np.sin(np.pi * a) * np.cos(x + mu)
    exact *= np.sin(high - x) ** a * np.sin(x - low) ** (1 - a)
    assert found.density(x / unit) == pytest.approx(exact, rel=1e-6)
