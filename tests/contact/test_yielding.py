"""First yield: Hertz's contact, the largest stress of rough contact, corners, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import contact
from contact.inside.largest import Criterion, largest
from contact.studies import random_scenes
from tests.tiers import quick

ISOLATED, PERIODIC = contact.Isolated(), contact.Periodic()
WAVE = contact.Sinusoid(1e-6, 1e-4)
E = 1e9


def on_axis(criterion, nu):
    """Returns (depth, value) of the largest stress on the axis below a cylinder with p_0 = a = 1."""

    def value(y):
        root = np.hypot(1, y)
        xx, yy = 2 * y - (1 + 2 * y * y) / root, -1 / root
        zz = nu * (xx + yy)
        if criterion == "tresca":
            return 0.5 * (max(xx, yy, zz) - min(xx, yy, zz))
        return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2))

    found = minimize_scalar(
        lambda y: -value(y), bounds=(0.3, 1.5), method="bounded", options={"xatol": 1e-12}
    )
    return (found.x, -found.fun) if -found.fun > value(0.0) else (0.0, value(0.0))


@pytest.mark.parametrize(
    ("criterion", "nu", "control"),
    [
        ("mises", 0.3, {"load": 1e3}),
        ("tresca", 0.3, {"half_width": 1e-4}),
        ("mises", 0.1, {"load": 1e7}),
    ],
)
def test_a_cylinder_yields_at_the_load_and_depth_of_hertz_s_solution(criterion, nu, control):
    scene = contact.Scene(contact.Parabola(1.0), E, ISOLATED, **control)
    found = contact.solve(scene).first_yield(1e6, nu, criterion)
    depth, part = on_axis(criterion, nu)
    half, peak = found.solution.zones[0, 1], 1e6 / part
    assert found.load == pytest.approx(np.pi * peak**2 / E, rel=1e-10)
    assert abs(found.load * E / (np.pi * peak**2) - 1) <= found.error + 1e-14
    assert (found.x / half, found.y / half) == pytest.approx((0.0, depth), abs=1e-6)
    assert found.note == ""


@pytest.mark.parametrize(
    ("friction", "part"), quick([(0.1, 0.3048), (0.3, 0.3449), (0.6, 0.6)], [(0.3, 0.3449)])
)
def test_friction_raises_the_largest_shear_and_brings_it_to_the_surface(friction, part):
    law = contact.Sliding(friction)
    scene = contact.Scene(contact.Parabola(1.0), E, ISOLATED, law=law, load=1e3)
    solution = contact.solve(scene)
    peak = largest(solution, Criterion("shear", 0.3, "as loaded"))
    assert peak.stress / solution.max_pressure == pytest.approx(part, abs=6e-5)
    assert (peak.y == 0.0) == (friction > 0.4)


@pytest.mark.parametrize(
    ("profile", "control"),
    [
        (contact.Fourier(1e-4, [1e-6, 2e-7, -1e-7], [1e-7, 3e-7, 2e-7]), {"mean_pressure": 1e6}),
        pytest.param(
            contact.self_affine(hurst=0.8, period=1e-3, shortest=2e-5, rms_slope=0.02, seed=2),
            {"mean_pressure": 1e6},
            marks=pytest.mark.slow,
        ),
    ],
)
@pytest.mark.parametrize("lateral", quick(["as loaded", "free"], ["free"]))
def test_at_first_yield_no_point_of_a_fine_grid_is_above_the_strength(profile, control, lateral):
    solution = contact.solve(contact.Scene(profile, E, PERIODIC, **control))
    found = solution.first_yield(5e6, 0.3, lateral=lateral)
    assert found.solution.stress(found.x, found.y, lateral).mises(0.3) == pytest.approx(
        5e6, rel=1e-8
    )
    period = profile.period
    x = period * np.arange(1200) / 1200
    for depth in period * 10 ** np.linspace(-4, -0.3, 40):
        assert found.solution.stress(x, depth, lateral).mises(0.3).max() < 5e6 * (1 + 1e-9)
    assert found.solution.stress(x, 0.0, lateral).mises(0.3).max() < 5e6 * (1 + 1e-9)


@pytest.mark.slow
def test_a_narrow_zone_beside_a_wide_one_is_not_missed():
    # The profile has fine ridges on a flat wave.
    x = np.arange(4000) / 4000
    heights = 1e-3 * np.cos(2 * np.pi * x) + 2e-7 * np.cos(2 * np.pi * 500 * (x - 0.02)) * np.exp(
        -(((x - 0.02) / 0.003) ** 2)
    )
    scene = contact.Scene(contact.Sampled(x, heights, period=1.0), E, PERIODIC, mean_pressure=2e5)
    solution = contact.solve(scene)
    peak = largest(solution, Criterion("mises", 0.3, "as loaded"))
    grid = np.concatenate([np.linspace(a, b, 300) for a, b in solution.zones])
    brute = max(
        solution.stress(grid, depth).mises(0.3).max() for depth in 10 ** np.linspace(-5, -0.5, 60)
    )
    assert brute <= peak.stress * (1 + 1e-9)
    assert brute > 0.98 * peak.stress


@pytest.mark.parametrize(
    ("profile", "law"),
    [
        (contact.Flat(1e-4), contact.Frictionless()),
        (contact.Wedge(0.01), contact.Frictionless()),
        (contact.Parabola(1.0), contact.JKR(0.01)),
    ],
)
def test_corners_tips_and_adhesive_ends_yield_at_zero_load_with_a_note(profile, law):
    solution = contact.solve(contact.Scene(profile, E, ISOLATED, law=law, load=10.0))
    found = solution.first_yield(1e6, 0.3)
    assert found.load == 0.0 and found.solution is None
    assert "sharp corner" in found.note


@pytest.mark.slow
def test_a_sharp_tip_beside_the_contact_yields_once_it_touches():
    ridge = contact.Wedge(1e-3, period=1e-4)
    profile = contact.Combined(WAVE, ridge, shift=2e-5)
    loads = []
    for pressure in (1e4, 1e7):
        solution = contact.solve(contact.Scene(profile, E, PERIODIC, mean_pressure=pressure))
        found = solution.first_yield(2e8, 0.3)
        assert (found.x, found.y) == (pytest.approx(2e-5), 0.0)
        assert "sharp tip" in found.note
        loads.append(found.load)
    assert loads[0] == pytest.approx(loads[1], rel=2 * found.error)


def test_first_yield_is_out_of_range_if_the_stress_of_full_contact_stays_below_the_strength():
    solution = contact.solve(contact.Scene(WAVE, E, PERIODIC, mean_pressure=1e6))
    with pytest.raises(contact.OutOfRange, match="no longer grows"):
        solution.first_yield(5e7, 0.5)


def test_the_cusp_of_a_power_law_is_the_place_of_the_largest_stress():
    profile = contact.Power(0.45, 1.3, period=4e-4)
    solution = contact.solve(contact.Scene(profile, E, PERIODIC, load=4.0))
    peak = largest(solution, Criterion("mises", 0.3, "as loaded"))
    assert (peak.x, peak.y) == pytest.approx((0.0, 0.0), abs=1e-15 * profile.period)
    assert peak.stress == pytest.approx(0.4 * solution.max_pressure, rel=1e-12)


def test_wrong_numbers_are_refused_by_name():
    solution = contact.solve(contact.Scene(WAVE, E, PERIODIC, mean_pressure=1e6))
    for arguments, name in (
        ((-1.0, 0.3), "strength"),
        ((1e6, 0.7), "nu"),
        ((1e6, 0.3, "mohr"), "criterion"),
        ((1e6, 0.3, "mises", "fixed"), "lateral"),
    ):
        with pytest.raises(contact.SceneError, match=name):
            solution.first_yield(*arguments)


def under_a_limit(pressure, profile=WAVE):
    law = contact.Plastic(2.4e7)
    return contact.solve(contact.Scene(profile, E, PERIODIC, law=law, mean_pressure=pressure))


@pytest.mark.parametrize("strength", quick([1.2e7, 1.36e7], [1.36e7]))
def test_first_yield_under_a_limit_of_the_pressure_is_the_least_load_from_any_start(strength):
    # Up to the mean pressure 1.3e7 Pa the largest stress grows with the load. Then it falls.
    found = [under_a_limit(start).first_yield(strength, 0.3) for start in (1e5, 2.2e7)]
    for one in found:
        assert one.load == pytest.approx(found[0].load, rel=found[0].error + one.error)
    rule = Criterion("mises", 0.3, "as loaded")
    for part in (0.25, 0.5, 0.9, 0.99):
        assert largest(under_a_limit(part * found[0].load / 1e-4), rule).stress < strength
    assert largest(found[0].solution, rule).stress == pytest.approx(strength, rel=1e-9)


def test_below_the_hardness_first_yield_is_elastic_and_its_load_grows_with_the_strength():
    elastic = contact.solve(contact.Scene(WAVE, E, PERIODIC, mean_pressure=1e6))
    strengths = (5e6, 1.2e7, 1.366e7)
    loads = [under_a_limit(2.2e7).first_yield(one, 0.3).load for one in strengths]
    assert loads[0] == pytest.approx(elastic.first_yield(5e6, 0.3).load, rel=1e-9)
    assert np.all(np.diff(loads) > 0)


def test_a_strength_above_every_stress_under_a_limit_of_the_pressure_is_said_to_be_out_of_range():
    with pytest.raises(contact.OutOfRange, match=r"the largest stress is 1.367e\+07 Pa, at 119"):
        under_a_limit(2.2e7).first_yield(1.6e7, 0.3)
    # The law bounds the stress: the largest shear stress in the plane is at most H / pi, and the
    # mean stress at most H.
    with pytest.raises(contact.OutOfRange, match=r"at most 1.635e\+07 Pa"):
        under_a_limit(2.2e7).first_yield(1.64e7, 0.3)


@pytest.mark.slow
def test_an_isolated_body_without_a_border_says_that_larger_loads_were_not_tried():
    scene = contact.Scene(
        contact.Parabola(1.0), 2.0, contact.Isolated(), law=contact.Plastic(0.9), load=1.5
    )
    with pytest.raises(contact.OutOfRange, match="no larger load was tried"):
        contact.solve(scene, tol=1e-6).first_yield(0.3, 0.3, "tresca")


def test_sharp_corners_at_the_hardness_yield_under_any_load():
    # Next to a step of the pressure from H to 0, the largest shear stress is H / pi.
    punch = under_a_limit(5e6, contact.Flat(4e-5, 1e-4))
    found = punch.first_yield(0.999 * 2.4e7 / np.pi, 0.3, "tresca")
    assert found.load == 0.0 and "any load" in found.note
    with pytest.raises(contact.SceneError, match="sharp corners"):
        punch.first_yield(1.001 * 2.4e7 / np.pi, 0.3, "tresca")


def test_first_yield_under_a_limit_is_sought_up_to_the_largest_load_of_an_isolated_wave():
    # The largest stress, 1.4109e7 Pa, occurs under the load 1196 N/m. No contact is found above
    # 1490 N/m.
    law, loads = contact.Plastic(2.4e7), []
    for start in (10.0, 300.0, 1200.0):
        scene = contact.Scene(WAVE, E, contact.Isolated(), law=law, load=start)
        loads.append(contact.solve(scene).first_yield(1.41e7, 0.3).load)
        with pytest.raises(
            contact.OutOfRange, match=r"the largest stress is 1.411e\+07 Pa, at 1(19|20)"
        ):
            contact.solve(scene).first_yield(1.42e7, 0.3)
    assert np.ptp(loads) < 1e-8 * loads[0]


def test_a_wedge_under_a_limit_of_the_pressure_yields_under_any_load_or_none():
    """A wedge has no length of its own, so its largest stress does not depend on the load."""
    law = contact.Plastic(3e7)
    rule, stresses = Criterion("mises", 0.3, "as loaded"), []
    for load in (1e-2, 1e4):
        scene = contact.Scene(contact.Wedge(0.05), E, contact.Isolated(), law=law, load=load)
        wedge = contact.solve(scene)
        stresses.append(largest(wedge, rule).stress)
        with pytest.raises(contact.OutOfRange, match=r"1.733e\+07 Pa under any load"):
            wedge.first_yield(1.74e7, 0.3)
        assert wedge.first_yield(1.73e7, 0.3).load == 0.0
    assert stresses[0] == pytest.approx(stresses[1], rel=1e-9)


@pytest.mark.parametrize("load", [1e-8, 1e-4, 3e1, 5e2])
@pytest.mark.parametrize("period", [None, 1e-4])
def test_the_largest_stress_of_a_flat_punch_at_its_limit_is_that_beside_the_corner(load, period):
    way = contact.Isolated() if period is None else PERIODIC
    law = contact.Plastic(2.4e7)
    punch = contact.solve(contact.Scene(contact.Flat(4e-5, period), E, way, law=law, load=load))
    found = largest(punch, Criterion("tresca", 0.3, "as loaded"))
    assert found.stress == pytest.approx(2.4e7 / np.pi, rel=1e-7)
    assert abs(found.x) == 2e-5


def test_first_yield_of_a_tip_under_a_limit_is_found_although_heights_round_at_small_loads():
    law = contact.Plastic(237.3)
    scene = replace(random_scenes.draw(51030).scene, law=law).under("load", 5.767e-8)
    found = contact.solve(scene).first_yield(0.4 * 237.3, 0.3)
    assert found.load == 0.0 and "any load" in found.note
