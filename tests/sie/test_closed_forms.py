"""The closed forms of `exact` satisfy the singular integral equation, by adaptive quadrature."""

import ast
import math
from pathlib import Path

import numpy as np
import pytest

from tests.sie import exact, reference

FORMS = [
    exact.Flat(0.7, 2.0),
    exact.Hertz(0.7, 3.0),
    exact.PrescribedIntensity(0.7, -0.2, 3.0),
    exact.Tilted(-0.3, 0.9, 2.0),
    exact.Wedge(0.7, 1.5),
    exact.Crack(0.7, 2.0),
    exact.TwoZones(0.3, 0.8, 2.0),
    exact.PeriodicFlat(0.3, 1.0, 2.0),
    exact.PeriodicCracks(0.3, 1.0, 2.0),
    exact.Westergaard(0.3, 1.0, 2.0),
    exact.Polynomial(-0.3, 0.9, (1.0, 2.0, -3.0, 0.5), 0.8),
]
each_form = pytest.mark.parametrize("form", FORMS, ids=lambda form: type(form).__name__)

# The quadrature has the tolerance 1e-12. The sum over its pieces and the singular ends cost two
# digits.
TOL = 1e-10


def kernel(form):
    return reference.cauchy if form.period is None else reference.hilbert(form.period)


def points(form):
    return [a + (b - a) * share for a, b in form.zones for share in (0.07, 0.31, 0.62, 0.9)]


@each_form
def test_the_density_solves_its_equation(form):
    kinks = getattr(form, "jumps_at", ())
    for x in points(form):
        found = reference.transform(form.at, form.zones, x, kernel(form), kinks)
        assert found == pytest.approx(float(form.value(x)), abs=TOL)


@each_form
def test_the_density_adds_up_to_the_total(form):
    found = reference.integral(form.at, form.zones, getattr(form, "jumps_at", ()))
    assert found == pytest.approx(form.total, abs=TOL)


@each_form
def test_the_right_side_is_the_derivative_of_its_primitive(form):
    h = 1e-3
    for x in points(form):
        nodes = np.array([-2, -1, 1, 2]) * h
        slope = np.dot(form.primitive(x + nodes), [1 / 12, -2 / 3, 2 / 3, -1 / 12]) / h
        # The difference has an error of h^4 times a fifth derivative of at most (2 pi)^5.
        assert slope == pytest.approx(float(form.value(x)), abs=2e-8)


@each_form
def test_density_by_place_is_density_by_normalised_position_and_zero_off_the_zones(form):
    for i, (a, b) in enumerate(form.zones):
        t = np.array([-0.9, 0.2, 0.7])
        assert form.density(0.5 * (a + b) + 0.5 * (b - a) * t) == pytest.approx(
            form.at(t, i), rel=1e-13
        )
    assert np.all(form.density(np.array([form.zones[0, 0] - 0.01, form.zones[-1, 1] + 0.01])) == 0)


def test_a_period_much_longer_than_the_zone_leaves_the_isolated_forms():
    t = np.linspace(-0.9, 0.9, 7)
    a, far = 0.01, 1e3
    pairs = [
        (exact.PeriodicFlat(a, far, 2.0), exact.Flat(a, 2.0)),
        (exact.PeriodicCracks(a, far, 2.0), exact.Crack(a, 2.0)),
        (exact.Westergaard(a, far, 2.0), exact.Hertz(a, 2.0 * 2 * math.pi / far)),
    ]
    for periodic, isolated in pairs:
        # The periodic images change the density by about (pi a / L)^2 / 6 of itself.
        assert periodic.at(t) == pytest.approx(isolated.at(t), rel=(math.pi * a / far) ** 2 + 1e-14)


@pytest.mark.parametrize("form", [exact.Crack(0.7, 2.0), exact.PeriodicCracks(0.3, 1.0, 2.0)])
def test_the_opening_of_a_crack_is_the_integral_of_its_density(form):
    a = form.half_width
    for x in (-0.8 * a, 0.0, 0.5 * a):
        angle = math.acos(x / a)
        found = reference.quad(
            lambda theta: float(form.at(np.cos(theta))) * a * np.sin(theta), angle, np.pi
        )[0]
        assert found == pytest.approx(float(form.opening(x)), rel=1e-10)


def test_a_prescribed_intensity_is_what_remains_at_the_end():
    form = exact.PrescribedIntensity(0.7, -0.2, 3.0)
    d = 1e-12
    assert float(form.at(1 - d / 0.7)) * math.sqrt(d) == pytest.approx(
        -0.2, rel=1e-4
    )  # 1 - t = d / a has a round-off of 1e-16


def test_the_slope_of_the_gap_between_two_zones_integrates_to_zero():
    form = exact.TwoZones(0.3, 0.8, 2.0)
    gap = reference.quad(
        lambda x: (
            reference.transform(form.at, form.zones, x, reference.cauchy) - float(form.value(x))
        ),
        -0.3,
        0.3,
    )[0]
    assert gap == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize(
    "wrong", [exact.Hertz(0.7, 3.0 * (1 + 1e-6)), exact.Wedge(0.7 * (1 + 1e-6), 3.0)]
)
def test_a_density_wrong_by_a_millionth_is_detected(wrong):
    right = exact.Hertz(0.7, 3.0)
    x = 0.31
    found = reference.transform(
        wrong.at, wrong.zones, x, reference.cauchy, getattr(wrong, "jumps_at", ())
    )
    assert abs(found - float(right.value(x))) > 1e3 * TOL


def test_the_closed_forms_do_not_import_the_solver():
    tree = ast.parse(Path(exact.__file__).read_text())
    modules = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    modules |= {
        name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names
    }
    assert not any(module.startswith("sie") for module in modules)
