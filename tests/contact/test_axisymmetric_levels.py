"""Asperities of several heights: when each level touches, and how the levels share the load.

Levels of equal height must give the same contact as one lattice.
"""

from __future__ import annotations

from math import inf, sqrt

import numpy as np
import pytest

from contact.axisymmetric import (
    Cone,
    Density,
    Hexagonal,
    Level,
    PowerLaw,
    Sphere,
    Square,
    solve_levels,
    solve_spot,
    touch_pressures,
)
from contact.errors import OutOfRange, SceneError
from tests.tiers import quick

CENTRES = [(0.5, 0.5)]
CORNERS = [(0.0, 0.0)]


def chequered(depth, shape=None):
    """Two levels; the tips of the lower one are at the centres of the squares of the higher one."""
    return [
        Level(Sphere(1.0), 0.0, sites=CORNERS),
        Level(shape or Sphere(1.0), depth, sites=CENTRES),
    ]


def test_two_levels_of_one_height_are_one_lattice():
    two = solve_levels(chequered(0.0), 1.0, Square(0.25), nominal_pressure=0.02, rings=inf)
    one = solve_spot(Sphere(1.0), 1.0, Square(0.25 / sqrt(2)), nominal_pressure=0.02, rings=inf)
    assert two.radii == pytest.approx([one.radius] * 2, rel=1e-12)
    assert two.approach == pytest.approx(one.approach, rel=1e-12)
    assert two.touch_pressures.tolist() == [0, 0]
    inside, outside = (
        np.linspace(0, 0.9, 7),
        np.array([1.0, 1.1, 1.2]),
    )  # the edge is left out: the pressure there is the square root of a round-off
    assert two.spots[1].pressure(inside * one.radius) == pytest.approx(
        one.pressure(inside * one.radius), rel=1e-11
    )
    assert two.spots[1].gap(outside * one.radius) == pytest.approx(
        one.gap(outside * one.radius), abs=1e-15
    )


def test_three_sublattices_of_one_height_are_one_lattice():
    sites = [(1 / 3, 1 / 3), (2 / 3, 2 / 3)]
    levels = [Level(Cone(0.1), 0.0, sites=CORNERS), Level(Cone(0.1), 0.0, sites=sites)]
    three = solve_levels(levels, 1.0, Hexagonal(1.0), nominal_pressure=0.02, rings=inf)
    one = solve_spot(Cone(0.1), 1.0, Hexagonal(1 / sqrt(3)), nominal_pressure=0.02, rings=inf)
    assert three.radii == pytest.approx([one.radius] * 2, rel=1e-12)
    assert three.shares == pytest.approx([1 / 3, 2 / 3], rel=1e-12)


@pytest.mark.parametrize("rings", [0, 1, 3, inf])
def test_below_its_pressure_a_level_is_not_there_and_just_above_it_carries_little(rings):
    lattice, levels = Square(0.25), chequered(0.002)
    first, second = touch_pressures(levels, 1.0, lattice, rings=rings)
    assert first == 0
    below, above = (
        solve_levels(levels, 1.0, lattice, nominal_pressure=second * k, rings=rings)
        for k in (1 - 1e-4, 1 + 1e-4)
    )
    assert below.touching == (True, False) and above.touching == (True, True)
    assert below.spots[1] is None and below.shares.tolist() == [1, 0]
    assert 0 < above.shares[1] < 1e-4
    assert above.radii[0] == pytest.approx(below.radii[0], rel=1e-3)
    if rings == inf:
        alone = solve_spot(
            Sphere(1.0), 1.0, lattice, nominal_pressure=second * (1 - 1e-4), rings=inf
        )
        assert below.radii[0] == pytest.approx(alone.radius, rel=1e-12)


@pytest.mark.parametrize("rings", [0, 1, inf])
@pytest.mark.parametrize("over", [1e-5, 1e-3])
def test_a_level_just_born_is_accurate_to_the_digits_of_its_depth(over, rings):
    """The accuracy of a new level is limited only by the round-off of its penetration.

    The penetration is the approach less the depth of the level.
    """
    lattice, levels = Square(0.25), chequered(0.002)
    second = touch_pressures(levels, 1.0, lattice, rings=rings)[1]
    solution = solve_levels(
        levels, 1.0, lattice, nominal_pressure=second * (1 + over), rings=rings, tol=1e-8
    )
    born = solution.spots[1]
    digits = (
        4
        * np.finfo(float).eps
        * (abs(solution.approach) + born.depth)
        / born.profile.line(born.radius)
    )
    assert abs(born.balance()) < digits and born.error < 1e-13 / over


def test_the_lower_tip_touches_where_the_surface_in_the_middle_meets_it():
    """The lower tips touch when the displacement at the centres of the squares is approach - depth.

    By lattice sums Z over the spots around a centre, this displacement from the mean plane is
    u = (P/(pi E* l)) [Z(1) + (P's second moment) Z(3)/2 + ...].
    """
    from_sum = (
        4 * -1.4603545088 * 0.6676914571896 * (sqrt(2) - 1)
    )  # 4 zeta(1/2) beta(1/2) (sqrt 2 - 1)
    depth, lattice = 1e-5, Square(1.0)
    levels = chequered(depth)
    second = touch_pressures(levels, 1.0, lattice, rings=inf)[1]
    alone = solve_spot(Sphere(1.0), 1.0, lattice, nominal_pressure=second, rings=inf)
    tip = from_sum * alone.load / np.pi
    # A point force in place of the pressure gives a relative error of the order (a/l)^2.
    assert alone.approach - depth == pytest.approx(tip, rel=3 * alone.radius**2)


@pytest.mark.parametrize("rings", quick([0, 2, inf], [0, inf]))
def test_all_levels_share_the_pressure_and_the_approach(rings):
    levels = [
        Level(Sphere(1.0), 0.0, sites=CORNERS),
        Level(Cone(0.05), 0.004, sites=[(0.5, 0.0), (0.0, 0.5)]),
        Level(PowerLaw(3.0, 3.0), 0.006, sites=CENTRES),
    ]
    solution = solve_levels(levels, 2.0, Square(0.5), nominal_pressure=0.05, rings=rings)
    assert solution.touching == (True, True, True)
    assert np.sum(solution.shares) == pytest.approx(1, rel=1e-12)
    assert 4 * (solution.loads @ [1, 2, 1]) == pytest.approx(0.05, rel=1e-12)
    assert np.all(np.diff(solution.touch_pressures) > 0)
    for spot in solution.spots:
        assert abs(spot.balance()) < 1e-11
        u = (
            spot.displacement(0.7 * spot.radius)
            + spot.profile.height(0.7 * spot.radius)
            + spot.depth
        )
        assert u == pytest.approx(solution.approach, rel=1e-12)
    back = solve_levels(levels, 2.0, Square(0.5), approach=solution.approach, rings=rings)
    if rings:
        assert back.nominal_pressure == pytest.approx(0.05, rel=1e-9)
        assert back.radii == pytest.approx(solution.radii, rel=1e-9)
    else:  # for rings = 0 the approach is largest at the pressure 0.035; the state below is found
        assert back.approach == pytest.approx(solution.approach, rel=1e-12)
        assert back.nominal_pressure < 0.03


def test_densities_alone_will_do_for_the_first_step():
    levels = [Level(Sphere(1.0), 0.0, density=10.0), Level(Cone(0.1), 0.002, density=20.0)]
    solution = solve_levels(levels, 1.0, nominal_pressure=0.01)
    assert solution.touching == (True, True)
    assert solution.loads @ [10, 20] == pytest.approx(0.01, rel=1e-12)
    # At a tip of the second level, the pressure of the first level acts outside a circle. The
    # area of the circle is the area per asperity of both levels.
    pressure, approach = solution.touch_pressures[1], solution.touch_approaches[1]
    alone = solve_spot(Sphere(1.0), 1.0, Density(10.0), nominal_pressure=pressure)
    assert alone.approach == pytest.approx(approach, rel=1e-12)
    assert approach + 2 * pressure / np.sqrt(np.pi * 30) == pytest.approx(0.002, rel=1e-12)


def test_one_level_is_the_spot_of_the_lattice():
    for rings in (0, 1, inf):
        level = solve_levels(
            [Level(Sphere(1.0), sites=CORNERS)],
            1.0,
            Hexagonal(0.3),
            nominal_pressure=0.03,
            rings=rings,
        )
        spot = solve_spot(Sphere(1.0), 1.0, Hexagonal(0.3), nominal_pressure=0.03, rings=rings)
        assert level.radii[0] == pytest.approx(spot.radius, rel=1e-12)
        assert level.approach == pytest.approx(spot.approach, rel=1e-11)


def test_a_level_too_deep_never_touches():
    levels = chequered(0.1)
    assert touch_pressures(levels, 1.0, Square(0.25), rings=inf).tolist() == [0, inf]
    with pytest.raises(OutOfRange):
        solve_levels(levels, 1.0, Square(0.25), nominal_pressure=10.0, rings=inf)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Level(Sphere(1.0)),
        lambda: Level(Sphere(1.0), -1.0, density=1.0),
        lambda: Level(Sphere(1.0), 0.0, density=1.0, sites=CORNERS),
        lambda: Level(Sphere(1.0), 0.0, sites=[(0.0, 0.0), (1.0, 0.0)]),
        lambda: Level(Sphere(1.0), 0.0, sites=[0.0, 1.0]),
        lambda: solve_levels([], 1.0, nominal_pressure=1.0),
        lambda: solve_levels([Level(Sphere(1.0), 1.0, density=1.0)], 1.0, nominal_pressure=1.0),
        lambda: solve_levels(chequered(0.0), 1.0, nominal_pressure=1.0),
        lambda: solve_levels(
            [Level(Sphere(1.0), density=1.0)], 1.0, Square(1.0), nominal_pressure=1.0
        ),
        lambda: solve_levels(chequered(0.0), 1.0, Square(1.0)),
        lambda: solve_levels(
            [Level(Sphere(1.0), sites=[(0.0, 0.0), (0.5, 0.0), (0.2, 0.3)])],
            1.0,
            Square(1.0),
            approach=1.0,
        ),
    ],
)
def test_levels_that_make_no_sense_are_refused(make):
    with pytest.raises(SceneError):
        make()


def test_a_public_half_space_code_agrees_on_two_levels():
    tamaas = pytest.importorskip(
        "tamaas", reason="the public half-space code tamaas is not installed"
    )
    n, l = 64, 0.25
    x = l * np.arange(n) / n

    def height(c):
        d = (x - c + l / 2) % l - l / 2
        return 0.5 * (d[:, None] ** 2 + d**2)

    f = np.minimum(height(0.0), height(l / 2) + 0.002)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [l, l], [n, n])
    model.E, model.nu = 1.0, 0.0
    by_pressure = tamaas.PolonskyKeerRey.pressure
    solver = tamaas.PolonskyKeerRey(model, -f, 1e-9, by_pressure, by_pressure)
    solver.max_iter = 5000
    solver.solve(0.02)
    p = np.array(model.traction).reshape(n, n)
    share = np.sum(p[height(0.0) < height(l / 2)]) / np.sum(p)
    ours = solve_levels(chequered(0.002), 1.0, Square(l), nominal_pressure=0.02, rings=inf)
    # The grid is accurate to 1e-3 here. The model leaves out the part that varies with the
    # angle.
    assert ours.shares[0] == pytest.approx(share, rel=1e-3)
    assert [s.max_pressure for s in ours.spots] == pytest.approx(
        [p[0, 0], p[n // 2, n // 2]], rel=1e-3
    )
