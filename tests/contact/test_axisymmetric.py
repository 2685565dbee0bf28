"""Round spots, isolated and in the first step of the localization.

They are compared with closed forms and with the kernel of the paper; load balance and scaling
are checked.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np
import pytest
from scipy.special import ellipkm1

from contact.axisymmetric import (
    AxisymmetricProfile,
    Cone,
    Density,
    Hexagonal,
    PowerLaw,
    Revolved,
    Sphere,
    Spot,
    Square,
    correction_share,
    first_step_load,
    own_radius,
    solve_spot,
)
from contact.axisymmetric.profiles import abel_kernel
from contact.axisymmetric.quadrature import panels
from contact.errors import NotConverged, OutOfRange, SceneError
from tests.contact.paper_forms import direct_kernel, direct_pressure
from tests.tiers import diagonal

R, E, A = 1.3, 2.0, 0.7
RADII = np.array([0.01, 0.2, 0.45, 0.69])


@dataclass(frozen=True)
class SlopeOnly(AxisymmetricProfile):
    """A shape known only by its slope: the base class computes all transforms by quadrature."""

    known: AxisymmetricProfile

    def slope(self, r):
        return self.known.slope(r)


SHAPES = [Sphere(R), Cone(0.2), PowerLaw(1.5, 0.3), PowerLaw(4.0, 0.3)]
TEN_ROUNDINGS = 1e-12  # ten times 24^2 eps: round-off in the derivative of a series of degree 24


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: type(s).__name__)
def test_closed_forms_agree_with_the_transforms_by_quadrature(shape):
    plain = SlopeOnly(shape)
    for name in ("height", "line", "line_slope", "r_laplacian"):
        assert getattr(plain, name)(RADII) == pytest.approx(
            getattr(shape, name)(RADII), rel=TEN_ROUNDINGS
        )
    assert plain.load_integral(A) == pytest.approx(shape.load_integral(A), rel=1e-14)
    assert plain.line_integral(A) == pytest.approx(shape.line_integral(A), rel=1e-13)
    assert plain.pressure_shape(RADII, A) == pytest.approx(
        shape.pressure_shape(RADII, A), rel=TEN_ROUNDINGS
    )


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: type(s).__name__)
def test_the_paper_s_kernel_gives_the_pressure_of_the_abel_transform(shape):
    assert direct_pressure(shape, E, A, RADII) == pytest.approx(
        E * shape.pressure_shape(RADII, A), rel=1e-12
    )


def test_the_printed_prefactor_does_not_give_hertz():
    hertz = E * Sphere(R).pressure_shape(RADII, A)
    printed = direct_pressure(Sphere(R), E, A, RADII) / pi  # E*/(4 pi^2)
    assert np.all(np.abs(printed / hertz - 1) > 0.6)


def test_the_paper_s_kernel_is_a_carlson_integral():
    r, s = np.meshgrid(RADII, RADII + 0.003)
    assert direct_kernel(r, s, A) == pytest.approx(4 * s * abel_kernel(r, s, A), rel=1e-12)


def test_a_paraboloid_alone_is_hertz():
    load = 0.05
    spot = solve_spot(Sphere(R), E, load=load)
    a = (3 * load * R / (4 * E)) ** (1 / 3)
    assert spot.radius == pytest.approx(a, rel=1e-13)
    assert spot.approach == pytest.approx(a**2 / R, rel=1e-13)
    assert spot.max_pressure == pytest.approx(1.5 * load / (pi * a**2), rel=1e-13)
    r = np.array([1.001, 1.5, 3.0, 20.0]) * a
    u = ((2 * a**2 - r**2) * np.arcsin(a / r) + a * np.sqrt(r**2 - a**2)) / (pi * R)
    # At r = 20 a, the displacement is a small difference of the gap and the height.
    assert spot.displacement(r) == pytest.approx(u, rel=1e-10)
    assert spot.gap(r) == pytest.approx(u + r**2 / (2 * R) - a**2 / R, rel=1e-11, abs=1e-15)
    assert spot.nominal_pressure is None and spot.contact_fraction is None
    assert spot.error <= 1e-13


def test_a_cone_alone_is_sneddon_s():
    spot = solve_spot(Cone(0.2), E, spot_radius=A)
    assert spot.load == pytest.approx(0.5 * pi * E * 0.2 * A**2, rel=1e-14)
    assert spot.approach == pytest.approx(0.5 * pi * 0.2 * A, rel=1e-14)
    assert spot.pressure(RADII) == pytest.approx(0.5 * E * 0.2 * np.arccosh(A / RADII), rel=1e-13)
    assert spot.max_pressure == inf and spot.pressure(0.0) == inf


def test_a_quartic_alone_has_its_closed_pressure():
    spot = solve_spot(PowerLaw(4.0, 0.3), E, spot_radius=A)
    r = np.append(0.0, RADII)
    exact = 32 * 0.3 * E / (9 * pi) * np.sqrt(A**2 - r**2) * (A**2 + 2 * r**2)
    assert spot.pressure(r) == pytest.approx(exact, rel=1e-12)
    at = A / sqrt(2.0)  # the place of the largest pressure
    assert spot.max_pressure == pytest.approx(float(spot.pressure(at)), rel=1e-12)


def flattened(b):
    """A paraboloid worn flat up to the radius b."""
    return Revolved(
        slope_of=lambda r: np.where(r < b, 0.0, r / R),
        second=lambda r: np.where(r < b, 0.0, 1 / R),
        breaks=(b,),
    )


def test_a_flattened_paraboloid_alone_carries_the_known_load():
    b = 0.3
    spot = solve_spot(flattened(b), E, spot_radius=A)
    assert spot.load == pytest.approx(
        2 * E / (3 * R) * (2 * A**2 + b**2) * sqrt(A**2 - b**2), rel=1e-13
    )
    g = (A * sqrt(A**2 - b**2)) / R  # int_b^a r dr/(R sqrt(a^2 - r^2)) times a
    assert spot.approach == pytest.approx(g, rel=1e-13)
    assert spot.max_pressure == inf and abs(spot.balance()) < 1e-12
    back = solve_spot(flattened(b), E, Hexagonal(3.0), load=spot.load / 2)
    assert b < back.radius < A


@pytest.mark.parametrize(
    "shape",
    [
        lambda r: r**2 / (2 * R),
        Revolved(slope_of=lambda r: r / R),
        Revolved(
            height_of=lambda r: 4.0 + np.hypot(r, 0.0) ** 2 / (2 * R), slope_of=lambda r: r / R
        ),
    ],
    ids=["height", "slope", "both"],
)
def test_a_callable_gives_the_same_spot_as_the_shape_it_stands_for(shape):
    lattice = Hexagonal(1.0)
    mine, known = (solve_spot(s, E, lattice, load=0.03, rings=1) for s in (shape, Sphere(R)))
    assert mine.radius == pytest.approx(known.radius, rel=1e-12)
    r = np.linspace(0, known.radius, 7)[:-1]
    assert mine.pressure(r) == pytest.approx(known.pressure(r), rel=1e-11)
    assert mine.gap(0.45) == pytest.approx(float(known.gap(0.45)), rel=1e-10)


def test_a_height_whose_tip_is_all_rounding_is_differentiated_exactly():
    spot = solve_spot(lambda r: 1 - np.cos(r), E, load=0.05)
    exact = Revolved(slope_of=np.sin, second=np.cos)
    assert spot.radius == pytest.approx(solve_spot(exact, E, load=0.05).radius, rel=1e-13)
    assert spot.error < 1e-12


@pytest.mark.parametrize(
    ("height", "radius"),
    diagonal(
        [lambda r: np.cosh(r) - 1, lambda r: np.sqrt(1 + r * r) - 1, lambda r: np.log(1 + r * r)],
        [1e-6, 1e-3, 0.1],
    ),
)
def test_a_spot_whose_tip_is_all_rounding_is_the_same_under_its_load(height, radius):
    # The search by load begins at small radii, where the heights consist of round-off.
    spot = solve_spot(height, E, spot_radius=radius)
    found = solve_spot(height, E, load=spot.load)
    assert found.radius == pytest.approx(radius, rel=1e-12)
    r = radius * np.linspace(0.01, 0.99, 9)
    assert found.pressure(r) == pytest.approx(spot.pressure(r), abs=1e-11 * spot.mean_pressure)


@pytest.mark.parametrize(
    ("shape", "radius"), diagonal(["catenary", "hyperboloid", "raised"], [1e-4, 0.01, 0.5])
)
def test_the_stated_error_covers_the_rounding_of_heights(shape, radius):
    hyperboloid, raised = (lambda r: np.sqrt(1 + r * r) - 1), (lambda r: 3.0 + r * r / (1 + r))
    height = {"catenary": lambda r: np.cosh(r) - 1, "hyperboloid": hyperboloid, "raised": raised}[
        shape
    ]
    exact = solve_spot(height, E, spot_radius=radius)
    rounded = solve_spot(
        lambda r: height(np.asarray(r, dtype=float)), E, spot_radius=radius, tol=0.1
    )
    r = radius * np.append(1e-6, np.geomspace(1e-3, 0.99, 30))
    off = np.max(np.abs(rounded.pressure(r) - exact.pressure(r))) / exact.mean_pressure
    assert off <= rounded.error < 1e6 * max(off, 1e-12)
    assert rounded.error < 2e-8 / radius
    with pytest.raises(NotConverged, match="rounding of the heights"):
        solve_spot(
            lambda r: height(np.asarray(r, dtype=float)),
            E,
            spot_radius=radius,
            tol=1e-3 * rounded.error,
        )


def test_a_height_that_takes_no_complex_numbers_and_has_a_kink_at_the_tip_will_do():
    lattice = Square(1.0)
    mine, cone = (
        solve_spot(s, E, lattice, load=0.03) for s in (lambda r: 0.1 * np.abs(r), Cone(0.1))
    )
    assert mine.radius == pytest.approx(cone.radius, rel=1e-12)
    assert mine.max_pressure == inf


# The first step on a lattice


@pytest.mark.parametrize(("spacing", "ratio"), [(1.0, 0.243), (0.25, 0.844), (0.2, 0.933)])
def test_the_spots_of_figure_2_have_their_radii(spacing, ratio):
    load = 0.0044 * 2 * E * R**2 / pi
    lattice = Hexagonal(spacing * R)
    spot = solve_spot(Sphere(R), E, lattice, load=load)
    assert spot.radius / spot.circle == pytest.approx(ratio, abs=0.0005)
    # The printed A = 1/(pi N) is not a length. In the paper's units (R = 1) it gives other
    # ratios.
    assert abs(spot.radius * pi * lattice.density * R - ratio) > 0.05


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("share", [0.05, 0.5, 0.9, 0.999])
def test_the_first_step_agrees_with_the_paper_s_form_to_1e_10(shape, share):
    lattice = Hexagonal(1.0)
    circle = own_radius(lattice.density)
    a = share * circle
    spot = solve_spot(shape, E, lattice, spot_radius=a)
    assert spot.load == pytest.approx(first_step_load(shape, E, lattice.density, a), rel=1e-12)
    r = a * np.array([0.02, 0.4, 0.8, 0.99])
    around = (
        2
        / pi
        * lattice.density
        * spot.load
        * np.arctan(np.sqrt(a**2 - r**2) / sqrt(circle**2 - a**2))
    )
    assert spot.pressure(r) == pytest.approx(direct_pressure(shape, E, a, r) + around, rel=1e-10)


@pytest.mark.parametrize("share", [0.01, 0.3, 0.9, 1.0])
def test_the_correction_carries_its_share_of_the_load(share):
    r, weight = panels([0.0, share])
    root = np.sqrt((share - r) * (share + r))
    load = 2 * pi * np.sum(weight * r * 2 / pi**2 * np.arctan2(root, sqrt(1 - share**2)))
    assert correction_share(share) == pytest.approx(load, rel=1e-13)


@pytest.mark.parametrize("control", ["load", "nominal_pressure", "spot_radius"])
@pytest.mark.parametrize("rings", [0, 2, inf])
def test_the_three_controls_name_the_same_spot(control, rings):
    lattice = Square(1.0)
    spot = solve_spot(Cone(0.1), E, lattice, load=0.03, rings=rings)
    value = {
        "load": spot.load,
        "nominal_pressure": spot.nominal_pressure,
        "spot_radius": spot.radius,
    }[control]
    again = solve_spot(Cone(0.1), E, lattice, rings=rings, **{control: value})
    assert (again.radius, again.load) == pytest.approx((spot.radius, spot.load), rel=1e-12)
    assert again.approach == pytest.approx(spot.approach, rel=1e-11)
    assert spot.nominal_pressure == pytest.approx(0.03 * lattice.density, rel=1e-12)


@pytest.mark.parametrize("rings", [0, 1, inf])
@pytest.mark.parametrize("shape", [Sphere(1.0), PowerLaw(3.0, 2.0)], ids=["sphere", "cubic"])
def test_lengths_and_modulus_scale(rings, shape):
    long, stiff = 1e-5, 7e10
    n = 2.0 if isinstance(shape, Sphere) else 3.0
    small = Sphere(long) if isinstance(shape, Sphere) else PowerLaw(n, 2.0 * long ** (1 - n))
    one = solve_spot(shape, 1.0, Hexagonal(0.3), load=1e-3, rings=rings)
    two = solve_spot(small, stiff, Hexagonal(0.3 * long), load=1e-3 * stiff * long**2, rings=rings)
    assert two.radius == pytest.approx(one.radius * long, rel=1e-11)
    assert two.max_pressure == pytest.approx(one.max_pressure * stiff, rel=1e-11)
    assert two.approach == pytest.approx(one.approach * long, rel=1e-10)


def test_sparse_spots_are_like_isolated_ones():
    alone = solve_spot(Sphere(R), E, load=1e-3)
    sparse = solve_spot(Sphere(R), E, Density(1e-6), load=1e-3)
    # The neighbours change the radius by a part of the order (a/A)^3.
    assert sparse.radius == pytest.approx(alone.radius, rel=(alone.radius / sparse.circle) ** 3)


def test_load_without_end_brings_the_spot_to_its_circle_and_no_further():
    lattice = Hexagonal(1.0)
    spot = solve_spot(Sphere(R), E, lattice, load=50.0)
    # The neighbours carry the share F of the load. With a = A (1 - eps), 1 - F is
    # (4/pi) sqrt(2 eps).
    eps = 0.5 * (pi / 4 * Sphere(R).load_integral(spot.circle) * E / 50.0) ** 2
    assert 1 - spot.radius / spot.circle == pytest.approx(eps, rel=0.01)
    with pytest.raises(OutOfRange):
        solve_spot(Sphere(R), E, lattice, spot_radius=spot.circle)
    with pytest.raises(OutOfRange):
        solve_spot(Sphere(R), E, lattice, load=1e9)
    with pytest.raises(OutOfRange):
        solve_spot(Sphere(R), E, lattice, load=50.0, rings=1)


def own_displacement(spot: Spot, r: float) -> float:
    """Displacement (4/pi E*) int p s K/(r + s) ds of an axisymmetric pressure, by quadrature."""
    s, w = panels([0.0, r, spot.radius])
    p = spot.pressure(np.minimum(s, spot.radius))
    apart = np.maximum(
        ((r - s) / (r + s)) ** 2, 1e-33
    )  # without this bound the logarithm in K is infinite at s = r, where the weights are tiny
    return float(4 / (pi * spot.E_star) * np.sum(w * p * s / (r + s) * ellipkm1(apart)))


def test_the_pressure_makes_the_displacement_of_the_contact():
    spot = solve_spot(Sphere(R), E, load=0.05)
    for share in (0.1, 0.5, 0.95):
        r = share * spot.radius
        assert own_displacement(spot, r) == pytest.approx(spot.approach - r**2 / (2 * R), rel=1e-12)
    wrong = solve_spot(Sphere(1.0001 * R), E, load=0.05)
    assert abs(own_displacement(wrong, 0.1) - (spot.approach - 0.01 / (2 * R))) > 1e-6


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"load": -1.0}, "load"),
        ({"load": float("nan")}, "load"),
        ({"load": True}, "load"),
        ({}, "exactly one"),
        ({"load": 1.0, "spot_radius": 1.0}, "exactly one"),
        ({"load": 1.0, "rings": -1}, "rings"),
        ({"load": 1.0, "rings": 1.5}, "rings"),
        ({"load": 1.0, "lattice": 3.0}, "lattice"),
        ({"load": 1.0, "lattice": Density(1.0), "rings": 1}, "rings"),
        ({"load": 1.0, "profile": 3.0}, "profile"),
        ({"nominal_pressure": 1.0, "lattice": None}, "nominal_pressure"),
        ({"load": 1.0, "E_star": 0.0}, "E_star"),
        ({"load": 1.0, "tol": 0.0}, "tol"),
    ],
)
def test_wrong_arguments_are_refused_by_name(change, word):
    given = {"profile": Sphere(R), "E_star": E, "lattice": Hexagonal(1.0)} | change
    with pytest.raises(SceneError, match=word):
        solve_spot(given.pop("profile"), given.pop("E_star"), given.pop("lattice"), **given)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Sphere(0.0),
        lambda: Cone(-1.0),
        lambda: Cone(inf),
        lambda: PowerLaw(0.5, 1.0),
        lambda: PowerLaw(2.0, "a"),
        lambda: Revolved(),
        lambda: Revolved(height_of=3),
        lambda: Revolved(lambda r: None),
        lambda: Revolved(lambda r: r, breaks=(1.0,)),
        lambda: Hexagonal(0.0),
        lambda: Density(-1.0),
    ],
)
def test_invalid_shapes_and_lattices_are_refused(make):
    with pytest.raises(SceneError):
        make()


def test_a_shape_that_would_touch_again_is_out_of_range():
    waves = Revolved(slope_of=lambda r: r + 0.9 * np.sin(20 * r))
    with pytest.raises(OutOfRange, match="meet again"):
        solve_spot(waves, 1.0, Hexagonal(1.0), load=0.02)
    falling = Revolved(slope_of=lambda r: np.sin(20 * r))
    with pytest.raises(OutOfRange, match="falls beyond"):
        solve_spot(falling, 1.0, load=0.02)
    hollow = Revolved(
        slope_of=lambda r: np.where(r < 0.2, 0.05, r),
        second=lambda r: 1.0 * (r > 0.2),
        breaks=(0.2,),
    )
    assert solve_spot(hollow, 1.0, spot_radius=0.4).load > 0


def test_a_false_second_derivative_is_noticed():
    lying = Revolved(slope_of=lambda r: r, second=lambda r: 2.0 + 0 * r)
    with pytest.raises(NotConverged, match="balance"):
        solve_spot(lying, 1.0, load=0.01)


def test_a_field_beyond_its_reach_is_refused():
    spot = solve_spot(Sphere(R), E, Hexagonal(1.0), load=0.01, rings=1)
    assert spot.reach == pytest.approx(1.0 - spot.radius)
    with pytest.raises(SceneError, match="neighbours"):
        spot.gap(0.9)
