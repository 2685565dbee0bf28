"""A density at complex points, against closed forms, quadrature, and values on the line."""

import math

import mpmath
import numpy as np
import pytest

import sie
from sie.jumps.density import DensityJumps
from sie.jumps.right_side import ForcingJumps
from sie.slits.system import SlitState, solve_zones
from tests.sie import exact
from tests.tiers import diagonal

# Points in both half planes: 1e-8 from an end, 1e-6 from the zone, on the line, and far away.
PLACES = [
    1.3 + 1e-8j,
    1.3 - 1e-8 + 1e-8j,
    1.3 - 1e-8,
    1.31,
    0.5 + 1e-6j,
    0.5 - 1e-6j,
    0.5,
    3 + 4j,
    1e6 - 1e6j,
    0.2j,
    -1.4,
    -1.4 - 1e-9j,
]
METHODS = ("transform", "transform_slope", "potential")


def asked(density, z):
    return [getattr(density, name)(np.asarray(z, dtype=complex)) for name in METHODS]


def solved(form, kernel=None, kinds=sie.SINGULAR, conditions=None):
    conditions = (sie.Total(form.total), sie.EqualPotential()) if conditions is None else conditions
    equation = sie.Equation(
        kernel or sie.cauchy(), sie.Forcing(form.value, form.primitive), conditions
    )
    return sie.solve(equation, sie.Zones.of(form.zones, kinds, kinds), 1e-10).density


def assert_near(got, expected, tolerance):
    assert np.abs(np.asarray(got) / np.array([complex(e) for e in expected]) - 1).max() < tolerance


def test_a_singular_end_has_all_its_digits_at_every_distance():
    density = solved(exact.Flat(1.3, 2.0))
    with mpmath.workdps(30):
        points = [
            mpmath.mpc(z) if complex(z).imag < 0 else mpmath.mpc(complex(z).real, complex(z).imag)
            for z in PLACES
        ]
        roots = [
            mpmath.sqrt(z - mpmath.mpf(1.3)) * mpmath.sqrt(z + mpmath.mpf(1.3)) for z in points
        ]
        closed = (
            [2 / mpmath.pi / r for r in roots],
            [-2 / mpmath.pi * z / r**3 for z, r in zip(points, roots, strict=True)],
            [2 / mpmath.pi * mpmath.log((z + r) / 2) for z, r in zip(points, roots, strict=True)],
        )
    for got, expected in zip(asked(density, PLACES), closed, strict=True):
        assert_near(got, expected, 4e-15)
    # A relative change of 1e-12 in the distance from the end changes the transform visibly.
    assert abs(density.transform(1.3 + 1.000000000001e-8j) / complex(closed[0][0]) - 1) > 1e-13


def test_bounded_ends_of_two_zones_have_the_field_of_the_closed_form():
    form = exact.TwoZones(0.3, 1.0)
    density = solved(form, kinds=sie.FREE)
    z = np.array([1 + 1e-8j, 0.3 - 1e-8j, 0.7 + 1e-6j, 0.6 - 0.3j, -0.2 + 0.1j, 0.0001j])
    with mpmath.workdps(30):
        a2, b2 = mpmath.mpf(0.3) ** 2, mpmath.mpf(1)
        for got, place in zip(density.transform(z), z, strict=True):
            s = mpmath.mpc(place)
            root = (
                mpmath.sqrt(s - 1)
                * mpmath.sqrt(s + 1)
                * mpmath.sqrt(s - mpmath.mpf(0.3))
                * mpmath.sqrt(s + mpmath.mpf(0.3))
            )
            expected = complex(s * (s * s - (a2 + b2) / 2) - s * root)
            assert abs(got - expected) < 1e-10 * abs(expected) + 2e-11


def test_a_periodic_field_has_a_limit_and_its_potential_changes_by_a_constant_per_period():
    form = exact.PeriodicFlat(0.2, 1.0)
    density = solved(form, sie.hilbert(1.0), conditions=(sie.Total(1.0),))
    z = np.array([0.2 + 1e-8j, 0.1 + 1e-6j, 0.3 - 0.2j, -0.4 + 0.7j])
    sine = np.sin(np.pi * z)
    root = np.sqrt(np.sin(np.pi * (z - 0.2)) * np.sin(np.pi * (z + 0.2)))
    root = root * np.sign((root * np.conj(sine)).real)
    assert np.abs(density.transform(z) / (np.cos(np.pi * z) / root) - 1).max() < 1e-13
    turned = density.potential(z + 1.0) - density.potential(z)
    assert (
        np.abs(turned + 1j * np.sign(z.imag))[1:].max() < 1e-13
    )  # z[0] is left out: 1e-8 from an end, the round-off of z[0] + 1 is too large
    assert abs(density.transform(40j) + 1j) < 1e-13  # -i load / L


def jumping(kind, kernel, order):
    zones = sie.Zones.of([[-0.5, 0.9]])
    at, heights, orders = np.array([0.3, -0.45]), np.array([0.7, -1.1]), np.full(2, order)
    if kind == "exterior logarithms":  # logarithms of the right side outside the zone
        at, heights, orders = np.array([0.95, -0.6]), np.array([0.7, -1.1]), np.zeros(2, dtype=int)
    if kind == "forcing jumps":
        jumps = ForcingJumps.within(zones, at, heights, orders, None)
    else:
        jumps = DensityJumps.inside(zones, at, heights, orders, kernel)
    return sie.Density(zones, kernel, np.zeros((1, 3)), jumps, np.zeros(0))


def integrated(density, z, kernels):
    """Integrals of the density times each of `kernels` over the zone, by Gauss's rule on panels
    of theta. The panels become shorter towards the jumps and towards z.
    """
    zones, jumps = density.zones, density.jumps
    w, middle = zones.half[0], zones.middle[0]
    marks = np.sort(np.concatenate((jumps.phi, [np.arccos(np.clip((z.real - middle) / w, -1, 1))])))
    near = np.concatenate([m + s * 0.5 ** np.arange(1, 36) for m in marks for s in (-1, 1)])
    cuts = np.unique(np.concatenate(([0, np.pi], marks, near)))
    cuts = cuts[(cuts >= 0) & (cuts <= np.pi)]
    # Two marks that differ by round-off only would make a panel whose nodes lie on the jump.
    cuts = cuts[np.append(True, np.diff(cuts) > 1e-13)]
    nodes, weights = np.polynomial.legendre.leggauss(20)
    half, centre = 0.5 * np.diff(cuts)[:, None], 0.5 * (cuts[1:] + cuts[:-1])[:, None]
    theta, weight = (centre + half * nodes).ravel(), (half * weights).ravel()
    phi = density.at(0, 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2)
    return [
        np.sum(weight * phi * w * np.sin(theta) * k(z - middle - w * np.cos(theta))) / np.pi
        for k in kernels
    ]


OF_CAUCHY = (lambda d: 1 / d, lambda d: -1 / d**2, np.log)


@pytest.mark.parametrize(
    ("kind", "order"),
    [
        *((kind, order) for kind in ("forcing jumps", "density jumps") for order in (0, 1, 2)),
        ("exterior logarithms", 0),
    ],
)
def test_fields_of_jumps_are_those_by_quadrature(kind, order):
    density = jumping(kind, sie.cauchy(), order)
    for z in (
        0.31 + 1e-2j,
        0.3 + 1e-3j,
        0.9 + 1e-3j,
        -0.5 + 3e-3j,
        0.1 + 0.36j,
        -2 + 30j,
        1.3 + 0.01j,
    ):
        expected = integrated(density, z, OF_CAUCHY)
        for got, true in zip(asked(density, z), expected, strict=True):
            assert abs(got - true) < 3e-10 * max(
                abs(true), 0.01
            )  # round-off of the angles of the quadrature


@pytest.mark.parametrize(
    "kernel", [sie.cauchy(), sie.hilbert(1.9), sie.images(1.9, 1)], ids=["line", "period", "images"]
)
@pytest.mark.parametrize(
    ("kind", "order"), [("forcing jumps", 0), ("density jumps", 0), ("exterior logarithms", 0)]
)
def test_values_on_both_sides_of_the_line_fit_those_on_the_line(kernel, kind, order):
    """On the upper side of the line, F = T - i phi (Plemelj), and Re W is the potential on the
    line.

    Off the line, W' = F, and F' is the derivative of F.
    """
    density = jumping(kind, kernel, order)
    x = np.array([-0.3, 0.1, 0.55, 0.899, 0.93, -0.7])
    assert (
        np.abs(density.transform(x + 0j) - (density.transform(x) - 1j * density(x))).max() < 1e-13
    )
    if kind == "forcing jumps":
        assert np.abs(density.potential(x + 0j).real - density.potential(x)).max() < 1e-13
    z, h = x + np.array([0.2j, 0.01j, -0.1j, 0.1j, 3j, -0.3j]), 1e-4
    first, second = (
        (8 * (f(z + h) - f(z - h)) - (f(z + 2 * h) - f(z - 2 * h))) / (12 * h)
        for f in (density.potential, density.transform)
    )
    assert np.abs(first - density.transform(z)).max() < 1e-6
    assert np.abs(second - density.transform_slope(z)).max() < 1e-5
    assert np.array_equal(density.transform(np.conj(z)), np.conj(density.transform(z)))


def many(kernel, count=80):
    rng = np.random.default_rng(5)
    table = np.sort(rng.uniform(0, 1, 2 * count)).reshape(count, 2)
    table[:, 1] = table[:, 0] + 0.7 * np.diff(table)[:, 0]
    coefficients = rng.standard_normal((count, 12)) * 0.5 ** np.arange(12)
    return sie.Density(sie.Zones.of(table), kernel, coefficients, ForcingJumps.none(), np.zeros(0))


@pytest.mark.parametrize("what", ["transform", "derivative", "potential"])
def test_the_tree_gives_the_sum_of_the_fields_of_all_zones(what):
    density = many(sie.cauchy())
    rng = np.random.default_rng(6)
    z = rng.uniform(-0.2, 1.2, 60) + 1j * 10.0 ** rng.uniform(-8, 1, 60)
    zone = np.arange(len(density.zones))
    expected = np.array(
        [
            density.plane.of_zones(
                np.full(len(zone), s.real), np.full(len(zone), s.imag), zone, (what,)
            )[0].sum()
            for s in z
        ]
    )
    got = density.plane(z, what)
    assert np.abs(got - expected).max() < 1e-14 * np.abs(expected).max()
    assert np.all(np.abs(got - expected) < 1e-11 * np.abs(expected))


def test_a_period_of_many_zones_is_the_sum_of_very_many_images():
    density = many(sie.hilbert(1.2), 9)
    z = np.array([0.3 + 1e-3j, 0.7 + 0.4j, -0.1 - 0.05j])
    alone = many(sie.cauchy(), 9)
    images = sum(alone.transform(z - 1.2 * k) for k in range(-400, 401))
    # The images left out add -2 (z - xi) / (L^2 (n + 1/2)), up to terms of the order n^-3.
    rest = -2 * (z * density.total - density.moment()) / np.pi / 1.44 / 400.5
    assert np.abs(density.transform(z) - images - rest).max() < 1e-8


SLITS = [[-0.2, -0.03], [-0.029, 0.05], [0.0502, 0.15], [0.25, 0.31]]
NEAR_SLITS = [
    -0.1 + 1e-6j,
    -0.0295 + 1e-6j,
    -0.0299 - 1e-5j,
    -0.03 + 1e-8j,
    -0.0294,
    -0.02,
    0.05012 + 1e-4j,
    0.05015,
    0.1 - 0.3j,
    0.6 + 2j,
]


@pytest.mark.parametrize(
    ("order", "kernel"), diagonal([None, 0, 1, 2], [sie.cauchy(), sie.hilbert(1.0)])
)
def test_fields_with_slits_are_those_of_separate_zones(order, kernel):
    # A slit with a jump of the second derivative must be much narrower (`max_gap_with_jumps`).
    at, jump = (
        np.array([0.0501 if order == 2 else -0.0297]),
        np.array([{0: -2.0, 1: -40.0}.get(order, -3e3)]),
    )
    scale = jump[0] / math.factorial(order or 0)
    bent = (
        (lambda x: 0 * x)
        if order is None
        else lambda x: scale * np.maximum(x - at[0], 0.0) ** order * (x > at[0])
    )
    forcing = sie.Forcing(
        lambda x: np.sin(7 * x) + 2 * x + bent(x),
        lambda x: (
            -np.cos(7 * x) / 7
            + x * x
            + (0 if order is None else bent(x) * (x - at[0]) / (order + 1))
        ),
        sie.Jumps(at, jump, order) if order is not None else sie.Jumps(),
    )
    equation = sie.Equation(kernel, forcing, (sie.Total(0.3), sie.EqualPotential()))
    plain, slit = (
        sie.solve_fixed(equation, sie.Zones.of(SLITS)),
        solve_zones(equation, sie.Zones.of(SLITS)),
    )
    assert isinstance(slit, SlitState)
    for one, other in zip(
        asked(plain.density, NEAR_SLITS), asked(slit.density, NEAR_SLITS), strict=True
    ):
        assert np.abs(one - other).max() < 3e-11 * np.abs(one).max()


def test_fields_of_a_zone_with_very_many_knots_fit_those_on_the_line():
    knots = np.linspace(-0.95, 1.05, 700)
    zones, slope = sie.Zones.of([[-0.5, 0.9]]), 9.0
    values = np.cumsum(np.cumsum(np.sin(slope * knots))) * (knots[1] - knots[0]) ** 2

    def spline(x):  # quadratic: the integral of a piecewise linear function
        line = np.interp(knots, knots, values)
        rise = np.concatenate(([0.0], np.cumsum(0.5 * (line[1:] + line[:-1]) * np.diff(knots))))
        i = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, len(knots) - 2)
        d = x - knots[i]
        return np.interp(knots[i], knots, rise) + d * (
            line[i] + 0.5 * d * (line[i + 1] - line[i]) / (knots[i + 1] - knots[i])
        )

    heights = np.diff(np.diff(values) / np.diff(knots))
    orders = np.full(len(heights), 2)
    made = (
        ForcingJumps.within(zones, knots[1:-1], heights, orders, None, spline),
        DensityJumps.inside(zones, knots[1:-1], heights, orders, sie.cauchy(), spline),
    )
    for jumps in made:
        density = sie.Density(zones, sie.cauchy(), np.zeros((1, 3)), jumps, np.zeros(0))
        assert jumps.splines
        x = np.array([-0.3, 0.1, 0.55, 0.95, -0.7])
        size = np.abs(density(x)).max()
        assert (
            np.abs(density.transform(x + 0j) - (density.transform(x) - 1j * density(x))).max()
            < 1e-10 * size
        )
        z, h = np.array([0.1 + 1e-2j, 0.95 + 0.05j, 0.4 - 2j]), 1e-4
        for f, g in (
            (density.potential, density.transform),
            (density.transform, density.transform_slope),
        ):
            slope_of = (8 * (f(z + h) - f(z - h)) - (f(z + 2 * h) - f(z - 2 * h))) / (12 * h)
            assert np.abs(slope_of - g(z)).max() < 1e-5 * np.abs(g(z)).max()


def test_the_derivative_of_a_periodic_field_is_that_of_the_closed_form():
    density = solved(exact.PeriodicFlat(0.2, 1.0), sie.hilbert(1.0), conditions=(sie.Total(1.0),))
    z = np.array([0.2 + 1e-8j, 0.1 + 1e-6j, 0.3 - 0.2j, -0.4 + 0.7j])
    field = density.transform(z)
    square = np.sin(np.pi * (z - 0.2)) * np.sin(np.pi * (z + 0.2))
    slope = -np.pi * field * (np.tan(np.pi * z) + np.sin(np.pi * z) * np.cos(np.pi * z) / square)
    assert np.abs(density.transform_slope(z) / slope - 1).max() < 1e-13


def test_results_have_the_shape_of_the_points_and_nan_stays_nan():
    density = solved(exact.Flat(1.3, 2.0))
    for got in asked(density, [[1j, complex(np.nan, 1)], [2.0, 3j]]):
        assert got.shape == (2, 2) and np.isnan(got[0, 1]) and np.isfinite(got[1]).all()
    assert density.transform(1j).shape == () and density.transform(
        np.zeros(0, dtype=complex)
    ).shape == (0,)


def of_kernel(value, potential=None):
    kernel = sie.cauchy() + sie.Smooth(value, potential)
    forcing = sie.Forcing(lambda x: x)
    return sie.solve(
        sie.Equation(kernel, forcing, (sie.Total(1.0),)),
        sie.Zones.of([[-0.5, 0.6]], sie.SINGULAR, sie.SINGULAR),
    ).density


def test_a_user_s_regular_kernel_is_continued_to_complex_points():
    density = of_kernel(lambda x, xi: np.sin(x - xi), lambda x, xi: -np.cos(x - xi))
    z, h = np.array([0.1 + 0.3j, -0.2 - 0.1j]), 1e-4
    slope = (density.potential(z + h) - density.potential(z - h)) / (2 * h)
    assert np.abs(slope - density.transform(z)).max() < 1e-7
    with pytest.raises(ValueError, match="the regular kernel has no slope"):
        density.transform_slope(z)


def test_the_slope_of_a_user_s_regular_kernel_gives_derivatives_of_the_transform():
    parts = (lambda x, xi: np.sin(x - xi), None, lambda x, xi: np.cos(x - xi))
    kernel = sie.hilbert(2.0) + sie.Smooth(*parts)
    equation = sie.Equation(kernel, sie.Forcing(lambda x: x), (sie.Total(1.0),))
    density = sie.solve(equation, sie.Zones.of([[-0.5, 0.6]], sie.SINGULAR, sie.SINGULAR)).density
    z, h = np.array([0.1 + 0.3j, -0.2 - 0.1j]), 1e-4
    slope = (density.transform(z + h) - density.transform(z - h)) / (2 * h)
    assert np.abs(slope - density.transform_slope(z)).max() < 1e-6


def test_a_regular_kernel_that_is_not_analytic_is_refused():
    density = of_kernel(lambda x, xi: np.cos(np.abs(x - xi)) + np.real(x - xi))
    with pytest.raises(ValueError, match="must be the analytic continuation"):
        density.transform(np.array([0.1 + 0.3j]))
    with pytest.raises(ValueError, match="no potential"):
        density.potential(np.array([0.1 + 0.3j]))


@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(1.0)], ids=["line", "period"])
def test_with_slits_weighted_integrals_are_prescribed_and_changed_to_another_value(kernel):
    forcing = sie.Forcing(lambda x: np.sin(7 * x) + 2 * x, lambda x: x * x - np.cos(7 * x) / 7)
    equations = [
        sie.Equation(
            kernel, forcing, (sie.Weighted(lambda x: np.cos(40 * x), value), sie.EqualPotential())
        )
        for value in (0.3, 0.4)
    ]
    slit = solve_zones(equations[0], sie.Zones.of(SLITS))
    for state, equation in zip((slit, slit.with_value(0, 0.1)), equations, strict=True):
        plain = sie.solve_fixed(equation, sie.Zones.of(SLITS))
        assert isinstance(state, SlitState)
        assert np.abs(state.density.totals - plain.density.totals).max() < 1e-13
