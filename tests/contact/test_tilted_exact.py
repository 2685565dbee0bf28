"""Closed forms of turned bodies, checked by laws that they do not contain: the singular integral
equation, the moment, the displacement.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from contact.errors import OutOfRange, SceneError
from contact.reference import exact
from tests.contact import reference

E = 2.0
PUNCHES = [
    exact.TiltedPunch(1.0, E, 0.3, 0.3 * e, datum=5.0)
    for e in (-0.9, -0.6, -0.3, 0.0, 0.1, 0.499, 0.501, 0.99)
]
SMOOTH = [
    *PUNCHES,
    exact.TiltedParabola(1.0, E, 0.1, 0.3, datum=2.0),
    exact.TiltedParabola(3.0, E, 0.2, -0.01, datum=2.0),
]
WEDGES = [
    exact.TiltedWedge(0.1, E, 0.3, tilt, datum=5.0) for tilt in (-0.09, -0.03, 0.0, 0.05, 0.099)
]


def name(solution):
    return f"{type(solution).__name__} e={solution.moment / solution.load:.3g}"


def moment_of(solution):
    """Returns int p x dx by Gauss-Chebyshev quadrature."""
    phi, middle, half, weight = reference.zone_rule(solution, 0, 4000)
    return float(np.sum(weight * (middle + half * np.cos(phi))))


def gap_by_displacement(solution, x):
    """Returns u + f - tilt x - approach, where u is the logarithmic potential of the pressure."""
    u = reference.displacement_of(solution, x, 4000)
    return u + solution.height(x) - solution.tilt * x - solution.approach


def beside(solution, *far):
    (a, b), w = solution.zones[0], solution.half_width
    return np.array([a - far_ * w for far_ in far] + [b + far_ * w for far_ in far])


@pytest.mark.parametrize("solution", SMOOTH, ids=name)
def test_the_pressure_solves_the_equation_with_the_slope_of_the_turned_body(solution):
    assert reference.equation_error(solution) < 1e-12


@pytest.mark.parametrize("solution", WEDGES, ids=name)
@pytest.mark.parametrize("t", [-0.95, -0.3, 0.01, 0.6, 0.999])
def test_the_pressure_of_a_wedge_solves_the_equation_by_folded_quadrature(solution, t):
    x = solution.middle + solution.half_width * t
    left = reference.folded_transform(solution, x, [*solution.zones[0], 0.0])
    assert left == pytest.approx(0.5 * E * float(solution.slope(x)), rel=1e-9)


@pytest.mark.parametrize("solution", SMOOTH, ids=name)
def test_load_and_moment_are_integrals_of_the_pressure(solution):
    assert reference.load_of(solution) == pytest.approx(solution.load, rel=1e-13)
    assert moment_of(solution) == pytest.approx(solution.moment, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("solution", WEDGES, ids=name)
def test_load_and_moment_of_a_wedge_are_integrals_of_its_pressure_within_the_quadrature_error(
    solution,
):
    assert reference.load_of(solution, 40000) == pytest.approx(solution.load, rel=3e-4)
    assert moment_of(solution) == pytest.approx(solution.moment, rel=3e-3, abs=1e-10)


@pytest.mark.parametrize(
    "solution", [s for s in SMOOTH if not isinstance(s, exact.TiltedPunch)], ids=name
)
def test_the_gap_follows_from_the_displacement_under_the_pressure(solution):
    x = beside(solution, 0.05, 1.0, 6.0)
    assert gap_by_displacement(solution, x) == pytest.approx(solution.gap(x), rel=1e-11)


@pytest.mark.parametrize(
    "solution", [s for s in PUNCHES if s.lifted and abs(s.moment) < 0.29], ids=name
)
def test_the_gap_of_a_lifted_punch_follows_from_the_displacement_under_the_pressure(solution):
    side = -np.sign(solution.moment)
    x = solution.middle + side * solution.half_width * np.array([1.01, 1.2])
    x = np.append(x, side * 0.999)
    assert gap_by_displacement(solution, x) == pytest.approx(solution.gap(x), rel=1e-10)
    assert np.all(solution.gap(x) > 0)
    assert solution.gap(side * 1.001) == np.inf


@pytest.mark.parametrize("solution", WEDGES, ids=name)
def test_the_gap_of_a_wedge_follows_from_the_displacement_within_the_quadrature_error(solution):
    x = beside(solution, 0.5, 2.0)
    assert gap_by_displacement(solution, x) == pytest.approx(solution.gap(x), rel=3e-3)


def test_without_tilt_the_closed_forms_are_the_symmetric_ones():
    t = np.linspace(-0.99, 0.99, 40)
    pairs = [
        (exact.TiltedParabola(1.0, E, 0.1, 0.0, 2.0), exact.HertzLine(1.0, E, 0.1, 2.0)),
        (exact.TiltedWedge(0.1, E, 0.3, 0.0, 5.0), exact.IsolatedWedge(0.1, E, 0.3, 5.0)),
        (exact.TiltedPunch(1.0, E, 0.3, 0.0, 5.0), exact.IsolatedPunch(1.0, E, 0.3, 5.0)),
    ]
    for turned, upright in pairs:
        assert turned.pressure_at(t) == pytest.approx(upright.pressure_at(t), rel=1e-13)
        assert turned.load == pytest.approx(upright.load, rel=1e-14)
        assert turned.approach == pytest.approx(upright.approach, rel=1e-14)
        x = beside(turned, 0.1, 3.0)
        assert turned.gap(x) == pytest.approx(upright.gap(x), rel=1e-12)


def test_a_punch_lifts_where_the_pressure_at_a_corner_would_turn_negative():
    before, after = (exact.TiltedPunch(1.0, E, 0.3, 0.3 * e) for e in (0.5, 0.5 + 1e-12))
    assert not before.lifted and after.lifted
    assert after.tilt == pytest.approx(before.tilt, rel=1e-11)
    t = np.linspace(-0.9, 0.9, 19)
    assert after.pressure_at(t) == pytest.approx(before.pressure_at(t), rel=1e-10)


@pytest.mark.parametrize("e", [0.2, 0.8])
def test_rotational_stiffness_is_the_slope_of_the_moment_over_the_tilt(e):
    h = 1e-6
    low, high = (exact.TiltedPunch(1.0, E, 0.3, 0.3 * (e + d)) for d in (-h, h))
    middle = exact.TiltedPunch(1.0, E, 0.3, 0.3 * e)
    assert 0.6 * h / (high.tilt - low.tilt) == pytest.approx(middle.rotational_stiffness, rel=1e-8)
    low, high = (exact.TiltedWedge.balanced(0.3, 0.3 * e + d, 0.1, E) for d in (-h, h))
    middle = exact.TiltedWedge.balanced(0.3, 0.3 * e, 0.1, E)
    assert 2 * h / (high.tilt - low.tilt) == pytest.approx(middle.rotational_stiffness, rel=1e-8)


def test_a_wedge_found_by_load_and_moment_has_them():
    wedge = exact.TiltedWedge.balanced(0.7, -1.3, 0.1, E)
    assert (wedge.load, wedge.moment) == pytest.approx((0.7, -1.3), rel=1e-13)


def test_bodies_without_equilibrium_and_wrong_numbers_are_refused():
    with pytest.raises(OutOfRange, match="corners"):
        exact.TiltedPunch(1.0, E, 0.3, 0.3)
    with pytest.raises(OutOfRange, match="flank"):
        exact.TiltedWedge(0.1, E, 0.3, -0.1)
    with pytest.raises(SceneError, match="load"):
        exact.TiltedPunch(1.0, E, -1.0, 0.0)
    with pytest.raises(SceneError, match="tilt"):
        exact.TiltedParabola(1.0, E, 0.1, np.nan)
    with pytest.raises(SceneError, match="zone"):
        PUNCHES[0].pressure_at(0.0, 1)


@dataclass
class Misplaced:
    """The pressure of a body at one tilt, with the slope of the body at another tilt."""

    right: exact.TiltedZone
    slope: Callable

    period = None
    zones = property(lambda self: self.right.zones)
    E_star = property(lambda self: self.right.E_star)

    def pressure_at(self, t, zone=0):
        return self.right.pressure_at(t, zone)


def test_a_tilt_wrong_by_a_millionth_violates_the_equation():
    solution = exact.TiltedParabola(1.0, E, 0.1, 0.3)
    assert reference.equation_error(Misplaced(solution, solution.slope)) < 1e-12
    assert (
        reference.equation_error(
            Misplaced(solution, replace(solution, tilt=0.3 * (1 + 1e-6)).slope)
        )
        > 1e-7
    )
