"""JKR adhesion of bodies with sharp corners.

An end is held at a corner while its edge intensity is above that of a free end. Otherwise it leaves
the corner.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np
import pytest

import contact
import sie

E, WORK, RADIUS = 1.0, 1e-4, 1.0
LAW = contact.JKR(WORK)
K = sqrt(E * WORK / pi)
INSIDE = np.array([-0.97, -0.6, 0.0, 0.3, 0.9])


def free_load(c):
    """Load under which an isolated cylinder has free ends at -c and c (Barquins 1988)."""
    return pi * E * c**2 / (4 * RADIUS) - pi * K * np.sqrt(2 * c)


# Half width of the isolated cylinder at pull-off.
LAST = (RADIUS / (pi * E) * sqrt(2 * pi * E * WORK)) ** (2 / 3)


def cut(a, slope=0.0, period=None):
    """A cylinder with sharp corners at -a and a, turned by the angle `slope`."""
    return contact.Combined(
        contact.Flat(2 * a, period), contact.Polynomial([0.0, slope, 0.5 / RADIUS])
    )


def solve(profile, branch="advancing", law=LAW, **control):
    model = contact.Isolated(datum=1.0) if profile.period is None else contact.Periodic()
    return contact.solve(contact.Scene(profile, E, model, law=law, **control), branch=branch)


def agrees(solution, x, pressure):
    assert solution.certificate.holds and solution.certificate.stability > 0.0
    assert np.abs(solution.pressure(x) - pressure).max() < 1e-10 * np.abs(pressure).max()
    assert solution.error < 1e-8


@pytest.mark.parametrize("branch", ["advancing", "receding"])
def test_a_flat_punch_under_tension_has_its_closed_form_and_keeps_its_full_width_until_pull_off(
    branch,
):
    width, period, x = 0.6, 1.0, 0.3 * INSIDE
    least, angle = -pi * K * sqrt(width), pi * width / (2 * period)
    load = 0.4 * least
    solution = solve(contact.Flat(width), branch, load=load)
    agrees(solution, x, load / (pi * np.sqrt(0.3**2 - x**2)))
    assert solution.certificate.stability == np.inf
    assert solution.pull_off.load == pytest.approx(least, rel=1e-12)
    with pytest.raises(contact.OutOfRange, match="past pull-off"):
        solve(contact.Flat(width), branch, load=1.001 * least)
    solution = solve(contact.Flat(width, period), branch, load=load)
    agrees(
        solution, x, load / period * np.cos(pi * x) / np.sqrt(sin(angle) ** 2 - np.sin(pi * x) ** 2)
    )
    assert solution.pull_off.load == pytest.approx(
        -K * sqrt(2 * pi * period * sin(angle) / cos(angle)), rel=1e-9
    )


@pytest.mark.parametrize(
    ("part", "branch"),
    [(0.5, "advancing"), (0.5, "receding"), (1.5, "receding"), (3.0, "advancing")],
)
def test_ends_of_a_cut_cylinder_are_held_above_the_load_at_which_free_ends_reach_the_corners(
    part, branch
):
    a = part * LAST
    # If free ends at the corners would be unstable (a < LAST), pull-off is at the load where the
    # held ends leave the corners. Otherwise the ends leave the corners first and pull-off comes
    # later.
    least = free_load(min(a, LAST))
    for load in (free_load(a) + 1e-6 * abs(free_load(a)), free_load(a) + 0.01, 0.5 * least):
        solution = solve(cut(a), branch, load=load)
        c = float(solution.zones[0, 1])
        if load > free_load(a):
            assert c == a
        else:
            assert free_load(c) == pytest.approx(load, rel=1e-9)
        x = c * INSIDE
        root = np.sqrt(c**2 - x**2)
        agrees(
            solution,
            x,
            E / (2 * RADIUS) * root + (load - pi * E * c**2 / (4 * RADIUS)) / (pi * root),
        )
    assert solution.pull_off.load == pytest.approx(least, rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_one_end_held_at_its_corner_and_the_other_one_free(seed):
    rng = np.random.default_rng(seed)
    a, work = 0.3, 10 ** rng.uniform(-7, -5)
    k, slope = sqrt(E * work / pi), rng.uniform(0.3, 0.7) * a / RADIUS
    b = a - rng.uniform(0.1, 1.5) * slope * RADIUS
    c, middle = 0.5 * (a + b), 0.5 * (b - a)
    tilt = middle / RADIUS + slope
    # The right end has the intensity of a free end. The intensity of the left end is larger, so
    # this end stays at its corner.
    punch = 0.5 * E * tilt * c - k * sqrt(2 * c)
    assert 0.5 * E * tilt * c + punch > -k * sqrt(2 * c)
    load = pi * E * c**2 / (4 * RADIUS) + pi * punch
    for branch in ("advancing", "receding"):
        solution = solve(cut(a, slope), branch, contact.JKR(work), load=load)
        assert solution.zones == pytest.approx(np.array([[-a, b]]), abs=1e-11)
        y = c * INSIDE
        pressure = (E / (2 * RADIUS) * (c**2 - y**2) - 0.5 * E * tilt * y + punch) / np.sqrt(
            c**2 - y**2
        )
        agrees(solution, middle + y, pressure)
        # At pull-off both ends are free, as on the whole cylinder.
        assert solution.pull_off.load == pytest.approx(
            -3 * (pi * E * work**2 * RADIUS / 16) ** (1 / 3), rel=1e-9
        )


def test_a_cut_wave_is_held_at_its_corners_in_every_period():
    size, a, x = 0.01, 0.25, 0.25 * INSIDE
    wave = contact.Combined(contact.Sinusoid(size, 1.0), contact.Flat(2 * a, 1.0))
    root = np.sqrt(sin(pi * a) ** 2 - np.sin(pi * x) ** 2)
    westergaard = pi * E * size * sin(pi * a) ** 2
    reached = westergaard - K * sqrt(2 * pi * sin(pi * a) / cos(pi * a))
    for load in (reached + 1e-6, 0.03):
        solution = solve(wave, load=load)
        assert solution.zones[0, 1] == a
        agrees(
            solution, x, np.cos(pi * x) * (2 * pi * E * size * root + (load - westergaard) / root)
        )


def test_a_path_reports_where_ends_are_held_and_freed_and_no_energy_is_lost_there():
    a = 3 * LAST
    scene = contact.Scene(cut(a), E, contact.Isolated(datum=1.0), law=LAW, load=0.0)
    loop = contact.path(scene, [-0.01, 0.02, -0.01])
    assert [event.kind for event in loop.events] == ["jump-in", "held", "freed", "pull-off"]
    assert [event.load for event in loop.events] == pytest.approx(
        [0.0, free_load(a), free_load(a), free_load(LAST)], rel=1e-10
    )
    assert loop.events[1].lost == loop.events[2].lost == 0.0
    assert loop.work == pytest.approx(loop.dissipated, rel=1e-9)
    # On a narrower body free ends would be unstable. Both held ends leave their corners together,
    # and energy is lost.
    narrow = contact.Scene(cut(0.5 * LAST), E, contact.Isolated(datum=1.0), law=LAW, load=0.0)
    last = contact.path(narrow, [-0.01, 0.02, -0.01]).events[-1]
    assert last.kind == "pull-off" and last.lost > 0.0
    assert last.load == pytest.approx(free_load(0.5 * LAST), rel=1e-10)


def test_the_work_of_the_load_through_the_kink_of_the_curve_is_the_change_of_energy():
    a = 3 * LAST
    scene = contact.Scene(cut(a), E, contact.Isolated(datum=1.0), law=LAW, load=0.0)
    low, high, kink = 0.5 * free_load(a), 2 * free_load(a), free_load(a)
    nodes, weights = np.polynomial.legendre.leggauss(6)
    parts = [(low, kink), (kink, high)]
    loads = np.concatenate([0.5 * (p + q) + 0.5 * (q - p) * nodes for p, q in parts])
    share = np.concatenate([0.5 * (q - p) * weights for p, q in parts])
    first, *between, last = contact.path(scene, [low, *loads, high]).solutions
    work = (
        last.load * last.approach
        - first.load * first.approach
        - share @ [state.approach for state in between]
    )
    assert last.energy.total - first.energy.total == pytest.approx(work, rel=1e-10)


def test_a_contact_whose_place_on_a_level_stretch_is_undetermined_is_refused_with_this_reason():
    scene = contact.Scene(contact.Flat(1.0), E, contact.Isolated(datum=1.0), law=LAW, load=0.0)
    assert contact.path(scene, [-0.01, 0.1, -0.01], control="approach").solutions[-1].load < 0.0
    with pytest.raises(contact.NotConverged, match="level stretch"):
        contact.path(scene, [0.0, -0.1], control="approach")


@pytest.mark.slow
def test_when_a_zone_under_tension_is_lost_at_a_fixed_approach_the_surface_touches_elsewhere():
    waves = np.arange(1, 5)
    phase = np.array([5.2, 3.7, 1.8, 0.3])
    size = 0.015 * waves**-1.5
    profile = contact.Combined(
        contact.Flat(0.9, 1.0), contact.Fourier(1.0, size * np.cos(phase), size * np.sin(phase))
    )
    scene = contact.Scene(profile, E, contact.Periodic(), law=contact.JKR(1e-6), load=0.0)
    loop = contact.path(scene, [-1e-3, 0.02, -0.1], control="approach")
    assert any(
        event.kind == "jump" and len(event.after) > len(event.before) for event in loop.events
    )
    # Pull-off is below the approach of first touch, which is zero.
    assert loop.events[-1].kind == "pull-off" and loop.events[-1].value < 0.0


def rough_row(work):
    """A periodic scene with JKR adhesion: rough bodies with sharp corners, at zero approach."""
    waves, phase = np.arange(1, 5), np.array([0.3, 2.1, 4.4, 1.2])
    size = 0.01 * waves**-1.5
    profile = contact.Combined(
        contact.Flat(0.8, 1.0), contact.Fourier(1.0, size * np.cos(phase), size * np.sin(phase))
    )
    return contact.Scene(profile, E, contact.Periodic(), law=contact.JKR(work), approach=0.0)


@pytest.mark.slow
@pytest.mark.parametrize("approach", [3e-3, 1e-4, -5e-6])
def test_the_receding_branch_under_a_fixed_approach_is_where_a_path_down_arrives(approach):
    scene = rough_row(1e-7)
    solution = contact.solve(replace(scene, approach=approach), branch="receding")
    path = contact.path(scene, [1.0, approach, -1.0], control="approach")
    assert (
        solution.zones == pytest.approx(path.solutions[1].zones, abs=1e-9)
        and solution.certificate.holds
    )
    assert solution.pull_off.load == pytest.approx(path.events[-1].load, rel=1e-9)
    # At a positive approach the bodies touch, so pull-off is at a negative approach.
    assert path.events[-1].kind == "pull-off" and path.events[-1].value < 0.0


def test_after_one_end_reaches_its_corner_the_other_end_moves_on():
    scene = replace(rough_row(3e-4), approach=-1e-6)
    found = contact.solve(scene)
    assert found.certificate.holds and found.zones[0, 0] > -0.4 * (1 - 1e-9)


def test_the_half_width_at_the_corners_is_refused_since_many_loads_have_it():
    with pytest.raises(contact.SceneError, match="less than the half width of the profile"):
        solve(cut(0.3), half_width=0.3)


@pytest.mark.parametrize("above", [1e-4, -1e-4])
def test_an_end_at_a_limit_is_released_if_its_intensity_is_below_that_of_a_free_end(above):
    k = 0.1
    reached = 0.5 * pi - pi * k * sqrt(2)
    equation = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(reached + above),))
    end = sie.free_with_intensity(-k)
    for start in (
        sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR),
        sie.Zones.of([[-0.9, 0.95]], end, end),
    ):
        free = sie.find_ends(
            equation, start, options=sie.NewtonOptions(limits=(-1.0, 1.0), released_end=end)
        )
        c = free.density.zones.b[0]
        assert free.converged and (c == 1.0 if above > 0 else c < 1.0)
        if above < 0:
            assert 0.5 * pi * c**2 - pi * k * sqrt(2 * c) == pytest.approx(
                reached + above, rel=1e-12
            )
