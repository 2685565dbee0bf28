"""Spots with neighbours treated at their places.

Checked are lattice sums, the contact condition by direct summation, the rate of convergence,
and the agreement with a public 3D code.
"""

from __future__ import annotations

from math import inf, isinf, pi, sqrt

import mpmath
import numpy as np
import pytest
from scipy.special import ellipe, ellipk, ellipkm1

from contact.axisymmetric import Cone, Hexagonal, PowerLaw, Sphere, Square, own_radius, solve_spot
from contact.axisymmetric.neighbours import epstein
from contact.axisymmetric.quadrature import panels
from contact.errors import NotConverged

LATTICES = [Hexagonal(1.0), Square(1.0)]


@pytest.mark.parametrize("s", [1, 3, 5, 11, 31])
def test_lattice_sums_are_products_of_zeta_functions(s):
    """Glasser & Zucker: 6 zeta(s/2) L_-3(s/2) (hexagonal) and 4 zeta(s/2) beta(s/2) (square).

    A square lattice and the centres of its squares form a square lattice of half the cell area.
    So the sum over the centres is a difference of two sums over square lattices.
    """
    h = mpmath.mpf(s) / 2
    three = (mpmath.zeta(h, mpmath.mpf(1) / 3) - mpmath.zeta(h, mpmath.mpf(2) / 3)) / 3**h
    four = (mpmath.zeta(h, 0.25) - mpmath.zeta(h, 0.75)) / 4**h
    assert epstein(Hexagonal(2.0), (0.0, 0.0), s) == pytest.approx(
        float(6 * mpmath.zeta(h) * three), rel=1e-13
    )
    square = 4 * mpmath.zeta(h) * four
    assert epstein(Square(1.0), (0.0, 0.0), s) == pytest.approx(float(square), rel=1e-13)
    assert epstein(Square(1.0), (0.5, -1.5), s) == pytest.approx(
        float(square * (2**h - 1)), rel=1e-13
    )
    assert abs(epstein(Square(1.0), (0.5, 0.49), s) / float(square * (2**h - 1)) - 1) > 1e-5


def test_rings_hold_the_spots_of_the_lattice():
    radii, counts = Hexagonal(2.0).neighbours(5)
    assert radii / 2 == pytest.approx(np.sqrt([1, 3, 4, 7, 9])) and counts.tolist() == [
        6,
        6,
        6,
        12,
        6,
    ]
    radii, counts = Square(2.0).neighbours(5)
    assert radii / 2 == pytest.approx(np.sqrt([1, 2, 4, 5, 8])) and counts.tolist() == [
        4,
        4,
        4,
        8,
        4,
    ]
    assert (
        Hexagonal(2.0).density == pytest.approx(2 / (sqrt(3) * 4)) and Square(2.0).density == 0.25
    )


def ring_displacement(spot, lattice, rings, r):
    """Mean displacement at the radius r, summed directly over the pressures.

    It is the sum over the spot itself, the rings of neighbours at their places, and the nominal
    pressure of the other neighbours.
    """
    a, E = spot.radius, spot.E_star
    s, w = panels([0.0, r, a])
    apart = np.maximum(((r - s) / (r + s)) ** 2, 1e-33)
    u = 4 / (pi * E) * np.sum(w * spot.pressure(np.minimum(s, a)) * s / (r + s) * ellipkm1(apart))
    radii, counts = lattice.neighbours(rings)
    s, w = panels([0.0, a])
    theta = 2 * pi * np.arange(200) / 200
    for distance, count in zip(radii, counts, strict=True):
        # A unit force at the distance D displaces the ring by (2/(pi^2 E* D)) K(r/D) on
        # average.
        D = np.sqrt(distance**2 + s[:, None] ** 2 + 2 * distance * s[:, None] * np.cos(theta))
        mean = np.mean(2 / (pi**2 * E * D) * ellipk((r / D) ** 2), axis=1)
        u += count * 2 * pi * np.sum(w * s * spot.pressure(np.minimum(s, a)) * mean)
    # The nominal pressure acts outside the circle. The same pressure on the whole surface would
    # move only the mean plane, so its displacement inside the circle is subtracted.
    circle = sqrt((1 + np.sum(counts)) / (pi * lattice.density))
    return u - 4 * spot.load * lattice.density * circle / (pi * E) * ellipe((r / circle) ** 2)


@pytest.mark.parametrize("lattice", LATTICES, ids=["hexagonal", "square"])
@pytest.mark.parametrize(
    "shape", [Sphere(1.3), Cone(0.2), PowerLaw(3.0, 0.4)], ids=["sphere", "cone", "cubic"]
)
@pytest.mark.parametrize("rings", [1, 3])
def test_the_pressures_summed_directly_satisfy_the_contact_condition(lattice, shape, rings):
    spot = solve_spot(shape, 2.0, lattice, spot_radius=0.45, rings=rings)
    for r in (0.05, 0.3, 0.44):
        u = ring_displacement(spot, lattice, rings, r)
        assert u + float(shape.height(r)) == pytest.approx(spot.approach, abs=1e-12)
    assert (
        abs(
            ring_displacement(spot, lattice, rings + 1, 0.3)
            + float(shape.height(0.3))
            - spot.approach
        )
        > 1e-5
    )


@pytest.mark.parametrize("rings", [0, 1, 2, inf])
@pytest.mark.parametrize("lattice", LATTICES, ids=["hexagonal", "square"])
def test_load_and_pressure_balance_and_the_gap_opens(lattice, rings):
    spot = solve_spot(Sphere(1.3), 2.0, lattice, load=0.08, rings=rings)
    assert abs(spot.balance()) < 1e-13 and spot.error < 1e-10
    out = spot.radius + np.array([1e-9, 1e-4, 1e-2, 0.05])
    gap = spot.gap(out)
    assert np.all(np.diff(gap) > 0)
    # The gap grows as the power 3/2 of the distance from the edge.
    assert gap[1] / gap[0] == pytest.approx(1e5**1.5, rel=1e-2)
    assert spot.pressure(out).tolist() == [0, 0, 0, 0] and spot.gap(0.5 * spot.radius) == 0
    assert spot.displacement(0.0) == pytest.approx(spot.approach)


def test_the_error_falls_with_the_cube_of_the_circle():
    """The error falls as A^-3 with the radius A of the circle of the spots at their places.

    The nominal pressure begins sharply at A, while spots have a finite size. This leaves out
    (3/2) (N/A^3) x^2 int w t^2 dt, of the order A^-3. The circle also holds too few or too many
    spots by chance, which gives an error of the order A^-7/2. In plane contact the error likewise
    falls as (2m + 1)^-3.
    """
    for lattice in LATTICES:
        _, counts = lattice.neighbours(1000)
        kept = 1 + np.cumsum(counts)
        exact = solve_spot(Sphere(1.0), 1.0, lattice, spot_radius=0.45, rings=inf).load
        rings = np.unique(np.geomspace(1, 1000, 14).astype(int))
        errors = np.array(
            [
                solve_spot(Sphere(1.0), 1.0, lattice, spot_radius=0.45, rings=int(n)).load / exact
                - 1
                for n in rings
            ]
        )
        circles = np.sqrt(kept[rings - 1] / (pi * lattice.density))
        rate = np.polyfit(np.log(circles), np.log(np.abs(errors)), 1)[0]
        assert -3.4 < rate < -2.6
        assert np.all(np.abs(errors * circles**3) < 0.06)
        # For large circles the systematic error dominates. It has one sign.
        assert np.all(errors[circles > 40] < 0)


@pytest.mark.parametrize("lattice", LATTICES, ids=["hexagonal", "square"])
def test_one_ring_beats_none_by_ten(lattice):
    load = 0.02
    exact = solve_spot(Sphere(1.0), 1.0, lattice, load=load, rings=inf)
    off = [
        abs(solve_spot(Sphere(1.0), 1.0, lattice, load=load, rings=n).radius / exact.radius - 1)
        for n in (0, 1)
    ]
    assert off[1] < 0.1 * off[0]


def test_all_rings_of_a_lattice_are_those_of_a_lattice_cut_far_away():
    lattice = Hexagonal(1.0)
    far, all_of_them = (
        solve_spot(Sphere(1.0), 1.0, lattice, load=0.05, rings=n) for n in (800, inf)
    )
    assert far.radius == pytest.approx(all_of_them.radius, rel=1e-7)
    assert far.max_pressure == pytest.approx(all_of_them.max_pressure, rel=1e-6)


def test_spots_about_to_meet_are_refused():
    with pytest.raises(NotConverged):
        solve_spot(Sphere(1.0), 1.0, Square(1.0), spot_radius=0.4999999, rings=1)


def half_space(lattice, load, n=64):
    """Approach and largest pressure of paraboloids on the periodic half-space, by FFT on a grid.

    R = 1 and E* = 1. Polonsky & Keer's method with the grid's own Fourier modes; n points along
    the spacing.
    """
    tamaas = pytest.importorskip(
        "tamaas", reason="the public half-space code tamaas is not installed"
    )
    square = isinstance(lattice, Square)
    l = lattice.spacing
    size, points = ([l, l], [n, n]) if square else ([sqrt(3.0) * l, l], [2 * n, n])
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, size, points)
    model.E, model.nu = 1.0, 0.0
    x, y = (length * np.arange(count) / count for length, count in zip(size, points, strict=True))

    def height(cx, cy):
        dx, dy = (
            (z - c + z0 / 2) % z0 - z0 / 2 for z, c, z0 in ((x, cx, size[0]), (y, cy, size[1]))
        )
        return 0.5 * (dx[:, None] ** 2 + dy**2)

    f = (
        height(0.0, 0.0)
        if square
        else np.minimum(height(0.0, 0.0), height(size[0] / 2, size[1] / 2))
    )
    by_pressure = tamaas.PolonskyKeerRey.pressure
    solver = tamaas.PolonskyKeerRey(model, -f, 1e-9, by_pressure, by_pressure)
    solver.max_iter = 5000
    solver.solve(load * lattice.density)
    p, u = (np.array(field).reshape(points) for field in (model.traction, model.displacement))
    return float(np.mean((u + f)[p > 0]) - np.mean(u)), float(p[0, 0])


# `share` is the spot's radius divided by the spacing of the lattice. Without separate rings of
# neighbours (rings = 0), `first` bounds the relative errors: that of the largest pressure from
# below and above, then that of the approach. With all rings (rings = inf), `last` bounds both
# errors. The grid is accurate to about 1e-4. With all rings, the error is the part of the pressure
# that varies with the angle as cos 6 phi or cos 4 phi.
@pytest.mark.parametrize(
    ("lattice", "share", "first", "last"),
    [
        (Hexagonal(0.25), 0.3, (0.009, 0.012, 0.08, 0.10), (2e-4, 2e-4)),
        (Hexagonal(0.25), 0.4, (0.018, 0.021, 0.14, 0.17), (2e-4, 3e-4)),
        (Square(0.25), 0.3, (0.006, 0.009, 0.06, 0.09), (2e-4, 2e-4)),
        (Square(0.25), 0.4, (0.012, 0.017, 0.10, 0.14), (5e-4, 1.2e-3)),
    ],
)
def test_the_full_half_space_of_a_public_code_agrees(lattice, share, first, last):
    exact = solve_spot(Sphere(1.0), 1.0, lattice, spot_radius=share * lattice.spacing, rings=inf)
    approach, peak = half_space(lattice, exact.load)
    assert exact.max_pressure == pytest.approx(peak, rel=last[0])
    assert exact.approach == pytest.approx(approach, rel=last[1])
    none = solve_spot(Sphere(1.0), 1.0, lattice, load=exact.load)
    assert first[0] < none.max_pressure / peak - 1 < first[1]
    assert first[2] < none.approach / approach - 1 < first[3]
    for rings in (1, 2, 3):
        some = solve_spot(Sphere(1.0), 1.0, lattice, load=exact.load, rings=rings)
        assert abs(some.max_pressure / peak - 1) < 0.0025 < first[0]


def test_the_circle_of_a_spot_has_its_share_of_area():
    assert pi * own_radius(4.0) ** 2 * 4.0 == pytest.approx(1.0) and isinf(
        solve_spot(Sphere(1.0), 1.0, load=1.0).circle
    )
