"""Pressures limited by a hardness: closed forms, a bounded grid, balances, and refused scenes."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy import special

import contact
from contact.model import scene_file
from contact.solution import export
from contact.studies.trace_kinds import drawn

pytestmark = pytest.mark.filterwarnings("ignore::contact.ModelWarning")

FOUR = contact.Fourier(1.0, [0.1, 0.05, 0.02], [0.03, -0.04, 0.05])


def solved(profile, hardness, E_star=1.0, interaction=None, tol=1e-10, **control):
    law = contact.Plastic(hardness)
    interaction = interaction or contact.Periodic()
    return contact.solve(contact.Scene(profile, E_star, interaction, law=law, **control), tol=tol)


ALONE = contact.Isolated(datum=1.0)


def test_a_cylinder_that_yields_has_the_closed_form():
    k = 0.6  # ratio of the widths of plateau and contact; half width 1, E*/R = 2
    hardness = np.pi / (2 * special.ellipk(k * k))
    load = hardness * (2 * special.ellipe(k * k) - (1 - k * k) * special.ellipk(k * k))
    found = solved(contact.Parabola(1.0), hardness, 2.0, ALONE, load=load)
    np.testing.assert_allclose(found.zones, [[-1, 1]], rtol=1e-10)
    np.testing.assert_allclose(found.plateaus, [[-k, k]], rtol=1e-10)
    assert found.pressure(0.8) == pytest.approx(0.6138418256, rel=2e-10)
    assert found.load == pytest.approx(load, rel=1e-13)
    assert found.max_pressure == found.pressure(0.0) == pytest.approx(hardness, rel=1e-14)
    assert found.certificate.holds and found.certificate.smallest_overlap > 0
    for control in {"approach": found.approach}, {"half_width": 1.0}:
        again = solved(contact.Parabola(1.0), hardness, 2.0, ALONE, **control)
        assert again.load == pytest.approx(load, rel=1e-10)


@pytest.mark.parametrize("control", ["mean_pressure", "contact_fraction", "half_width"])
def test_a_wave_that_yields_has_the_closed_form(control):
    A, C, peak = 0.9, 0.5, np.pi  # E* = amplitude = period = 1
    k = np.tan(C) / np.tan(A)
    hardness = peak * np.pi * np.sin(A) * np.cos(C) / special.ellipk(k * k)
    mean = 0.59267767061 * peak
    values = {"mean_pressure": mean, "contact_fraction": 2 * A / np.pi, "half_width": A / np.pi}
    found = solved(contact.Sinusoid(1.0, 1.0), hardness, **{control: values[control]})
    assert found.mean_pressure == pytest.approx(mean, rel=1e-11)
    np.testing.assert_allclose(found.zones * np.pi, [[-A, A]], rtol=1e-10)
    np.testing.assert_allclose(found.plateaus * np.pi, [[-C, C]], rtol=1e-10)


def test_a_flat_punch_yields_up_to_its_corners():
    found = solved(contact.Flat(4.0), 1.0, 1.0, contact.Isolated(), load=2 * np.sqrt(3))
    x = np.linspace(-0.99, 0.99, 9)
    exact = 2 / np.pi * np.arctan(np.sqrt(3) / np.sqrt(1 - x * x))
    np.testing.assert_allclose(found.pressure(x), exact, rtol=1e-10)
    np.testing.assert_allclose(found.plateaus, [[-2, -1], [1, 2]], rtol=1e-10)
    np.testing.assert_array_equal(found.zones, [[-2, 2]])
    assert np.any(np.abs(found.pressure(0.99 * x) - exact) > 1e-4)


@pytest.mark.parametrize("part, tol", [(1e-2, 1e-8), (1e-3, 1e-8), (1e-4, 1e-6)])
def test_very_narrow_plateaus_of_a_flat_punch_are_found(part, tol):
    found = solved(contact.Flat(4.0), 1.0, 1.0, contact.Isolated(), load=4 * part, tol=tol)
    width = (2 * part) ** 2 / (2 + 2 * np.sqrt(1 - part**2))  # P = 2 H sqrt(a^2 - c^2)
    assert np.diff(found.plateaus)[:, 0] == pytest.approx([width, width], rel=2 * found.error)
    assert found.error <= tol


def test_a_row_of_flat_punches_yields_up_to_the_corners():
    A, C = 0.9, 0.5
    mean = 2 / np.pi * np.arccos(np.cos(A) / np.cos(C))
    found = solved(contact.Flat(2 * A, period=np.pi), 1.0, mean_pressure=mean)
    np.testing.assert_allclose(found.plateaus, [[-A, -C], [C, A]], rtol=1e-10)
    u = np.array([-0.4, 0.1])
    tangent = np.tan(np.arcsin(np.cos(A) / np.cos(C)))
    root = np.sqrt(np.sin(C) ** 2 - np.sin(u) ** 2)
    exact = 1 - 2 / np.pi * np.arctan(root * tangent / np.cos(u))
    np.testing.assert_allclose(found.pressure(u), exact, rtol=1e-10)


@pytest.mark.parametrize("amplitude", [0.9, 0.999])
def test_full_contact_that_yields_mirrors_contact_of_the_troughs(amplitude):
    """The hardness minus the pressure is Westergaard's pressure for the mirrored wave."""
    hardness, mean = 2 * np.pi, np.pi * (2 - amplitude * np.sin(1.2) ** 2)
    found = solved(contact.Sinusoid(amplitude, 1.0), hardness, mean_pressure=mean)
    assert found.zones.shape == (0, 2) and found.contact_fraction == 1
    mirrored = contact.Scene(
        contact.Sinusoid(amplitude, 1.0), 1.0, contact.Periodic(), mean_pressure=hardness - mean
    )
    half = contact.solve(mirrored).zones[0, 1]
    np.testing.assert_allclose(found.plateaus, [[half - 0.5, 0.5 - half]], atol=1e-10)


def rough_scene(seed, points, slope_over_hardness, share):
    """A self-affine trace whose rms slope times E* is a multiple of the hardness."""
    k = np.arange(1, points // 8)
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(k))
    x = np.arange(points) / points
    profile = contact.Sampled(x, np.cos(2 * np.pi * x[:, None] * k + phase) @ k**-1.3, period=1.0)
    hardness = float(np.std(profile.slope(np.linspace(0, 1, 5000)))) / slope_over_hardness
    law = contact.Plastic(hardness)
    return contact.Scene(profile, 1.0, contact.Periodic(), law=law, mean_pressure=share * hardness)


@pytest.mark.parametrize("slope_over_hardness", [5.0, 60.0])
def test_steep_rough_traces_agree_with_tighter_solutions(slope_over_hardness):
    scene = rough_scene(3, 256, slope_over_hardness, 0.3)
    rough, fine = contact.solve(scene, tol=1e-3), contact.solve(scene, tol=1e-9)
    assert fine.certificate.holds and len(fine.plateaus) > 2
    width = np.diff(fine.zones, axis=1).min()
    np.testing.assert_allclose(rough.zones, fine.zones, atol=1e-3 * width)
    x = np.linspace(0, 1, 20001)[:-1]
    assert fine.pressure(x).mean() == pytest.approx(scene.mean_pressure, rel=2e-4)
    assert np.all(fine.gap(x) >= 0) and np.all(fine.pressure(x) <= scene.law.hardness)


def test_wide_rough_contact_with_plateaus_keeps_its_digits():
    """The plateaus at two tolerances agree within the stated errors.

    With truncated powers in place of integrals, round-off left a stated error of 6e-8.
    """
    profile = drawn(np.random.default_rng(0), "honed", 440, "uneven")
    full = contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)
    mean = 0.3 * contact.solve(full).mean_pressure
    law = contact.Plastic(2 * mean)
    scene = contact.Scene(profile, 1.0, contact.Periodic(), law=law, mean_pressure=mean)
    rough, fine = contact.solve(scene, tol=1e-4), contact.solve(scene, tol=1e-8)
    assert fine.certificate.holds and len(fine.plateaus) > 2 and fine.contact_fraction > 0.5
    assert rough.plateaus.shape == fine.plateaus.shape
    moved = np.abs(rough.plateaus - fine.plateaus) / np.diff(fine.plateaus)
    assert moved.max() < rough.error + fine.error


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("slope_over_hardness", [2.0, 20.0, 200.0])
@pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
def test_large_steep_traces_are_solved(seed, slope_over_hardness, share):
    found = contact.solve(rough_scene(seed, 2000, slope_over_hardness, share), tol=1e-6)
    assert found.certificate.holds and found.error <= 1e-6


def bounded_grid(profile, hardness, mean, count):
    """Grid points, and pressures with 0 <= p <= H there, by accelerated projected gradients.

    The pressures minimize the energy under the given mean pressure.
    """
    x = (np.arange(count) + 0.5) / count
    wave = np.fft.rfftfreq(count, 1 / count) * 2 * np.pi
    with np.errstate(divide="ignore"):
        compliance = np.where(wave > 0, 2 / wave, 0.0)
    height = profile.height(x)

    def slope(p):
        return np.fft.irfft(compliance * np.fft.rfft(p), count) + height

    def projected(p):
        low, high = -p.max() - hardness, hardness - p.min() + hardness
        for _ in range(40):
            shift = 0.5 * (low + high)
            low, high = (
                (shift, high) if np.clip(p + shift, 0, hardness).mean() < mean else (low, shift)
            )
        return np.clip(p + shift, 0, hardness)

    p = projected(np.full(count, mean))
    ahead, momentum = p, 1.0
    for _ in range(600):
        following = projected(ahead - slope(ahead) * np.pi)
        after = 0.5 * (1 + np.sqrt(1 + 4 * momentum**2))
        restart = np.dot(ahead - following, following - p) > 0
        after = 1.0 if restart else after
        ahead = following + (0.0 if restart else (momentum - 1) / after) * (following - p)
        p, momentum = following, after
    return x, p


@pytest.mark.parametrize("hardness, part", [(0.5, 0.4), (0.5, 0.9), (0.3, 0.3)])
def test_two_zones_agree_with_a_grid_with_bounds(hardness, part):
    mean = part * hardness
    found = solved(FOUR, hardness, mean_pressure=mean)
    x, p = bounded_grid(FOUR, hardness, mean, 128)
    away = np.abs(found.pressure(x) - p)
    assert np.sqrt(np.mean(away**2)) < 0.04 * hardness
    assert np.median(away) < 2e-3 * hardness
    plateaus = found.plateaus[:, 1] - found.plateaus[:, 0]
    assert plateaus.sum() == pytest.approx(np.mean(p >= hardness * (1 - 1e-9)), abs=4 / 128)


@pytest.fixture(scope="module")
def two():
    return solved(FOUR, 0.5, mean_pressure=0.2)


def test_fields_agree_with_each_other(two):
    x = np.linspace(0, 1, 40001)[:-1]
    pressure, gap, overlap = two.pressure(x), two.gap(x), two.overlap(x)
    assert pressure.mean() == pytest.approx(0.2, rel=1e-5)
    assert two.zone_loads.sum() == pytest.approx(two.load, rel=1e-14)
    assert two.mean_gap == pytest.approx(gap.mean(), rel=1e-5)
    profile = FOUR.height(x) - FOUR.height(x).min()
    np.testing.assert_allclose(two.approach - profile - two.displacement(x), -gap, atol=1e-8)
    assert np.all(overlap >= 0) and np.all((overlap > 0) <= (pressure == 0.5))
    stress = two.stress(x[:50], np.zeros(50))
    np.testing.assert_allclose(stress.yy, -pressure[:50], atol=1e-14)


def test_beside_a_plateau_the_pressure_falls_as_the_root_of_the_distance(two):
    for ends, inwards in zip(two.plateaus.T, (-1.0, 1.0), strict=True):
        np.testing.assert_allclose(two.pressure(ends), 0.5, rtol=1e-14)
        # Next to a plateau, H - p grows as the square root of the distance (H: the hardness).
        near, far = (0.5 - two.pressure(ends + inwards * d) for d in (1e-10, 1e-8))
        np.testing.assert_allclose(far / near, 10.0, rtol=1e-4)


def test_the_stiffness_is_the_derivative_of_the_load_by_the_approach(two):
    step = 1e-4
    more, less = (solved(FOUR, 0.5, mean_pressure=0.2 + sign * step) for sign in (1, -1))
    stiffness = (more.load - less.load) / (more.approach - less.approach)
    assert two.stiffness == pytest.approx(stiffness, rel=1e-5)
    again = solved(FOUR, 0.5, approach=two.approach)
    assert again.mean_pressure == pytest.approx(0.2, rel=1e-9)


def test_below_the_hardness_the_contact_is_the_elastic_one():
    plain = contact.solve(contact.Scene(FOUR, 1.0, contact.Periodic(), mean_pressure=0.2))
    capped = solved(FOUR, 10.0, mean_pressure=0.2, tol=1e-8)
    np.testing.assert_array_equal(capped.zones, plain.zones)
    assert capped.plateaus.shape == (0, 2) and capped.overlap([0.1, 0.2]).tolist() == [0, 0]
    assert capped.scene.law == contact.Plastic(10.0)


@pytest.mark.parametrize("fraction", [0.2, 0.8, 0.97])
def test_a_given_contact_fraction_is_that_of_its_load(fraction):
    found = solved(FOUR, 0.5, contact_fraction=fraction, tol=1e-6)
    exact = solved(FOUR, 0.5, load=found.load)
    assert exact.contact_fraction == pytest.approx(fraction, rel=found.error)
    np.testing.assert_allclose(found.zones, exact.zones, atol=found.error)
    for one in exact, contact.solve(exact.scene.under("load", 0.48)):  # the second has full contact
        again = contact.solve(found.scene, tol=1e-6, near=one)
        assert again.load == pytest.approx(found.load, rel=1e-6)


@pytest.mark.parametrize("profile", [FOUR, contact.Sinusoid(0.1, 1.0)])
def test_a_given_approach_at_a_small_hardness_is_that_of_its_load(profile):
    """At a small hardness, hardly any grid points lie between a plateau and a gap."""
    found = solved(profile, 0.02, approach=0.02, tol=1e-8)
    again = solved(profile, 0.02, load=found.load, tol=1e-8)
    assert again.approach == pytest.approx(0.02, rel=1e-7)
    more = solved(profile, 0.02, load=found.load * (1 + 1e-5), tol=1e-8)
    stiffness = (more.load - again.load) / (more.approach - again.approach)
    assert found.stiffness == pytest.approx(stiffness, rel=1e-4)


def test_a_half_width_is_that_of_one_contact_about_the_origin():
    with pytest.raises(contact.OutOfRange, match="one contact about x = 0"):
        solved(contact.Biquadratic(1.0, 0.2, period=1.0), 0.02, half_width=0.08, tol=1e-8)


def test_a_tip_always_yields():
    found = solved(contact.Wedge(0.1), 0.3, 1.0, contact.Isolated(), load=1.0, tol=1e-8)
    (left, right) = found.plateaus[0]
    assert left == pytest.approx(-right, rel=1e-7) and found.max_pressure == 0.3
    assert found.zone_peaks.tolist() == [0.3]


def test_solutions_are_pickled_and_exported(two, tmp_path):
    copy, x = pickle.loads(pickle.dumps(two)), np.linspace(0, 1, 9)
    np.testing.assert_array_equal(copy.pressure(x), two.pressure(x))
    np.testing.assert_array_equal(copy.overlap(x), two.overlap(x))
    assert export.to_dict(two)["plateaus"] == two.plateaus.tolist()
    assert "overlap" in export.fields_to_csv(two).splitlines()[0]
    assert export.to_xarray(two)["plateaus"].shape == (2, 2)


def test_a_scene_file_names_the_law(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(
        '[profile]\nshape = "sinusoid"\namplitude = 1e-6\nperiod = 1e-4\n'
        '[material]\nE_star = 1e9\n[interaction]\nmodel = "periodic"\n'
        '[law]\nmodel = "plastic"\nhardness = 2e7\n[control]\nmean_pressure = 1e7\n'
    )
    assert scene_file.load_scene(path).law == contact.Plastic(2e7)


REFUSED = [
    (lambda: contact.Plastic(0.0), "hardness"),
    (lambda: solved(FOUR, 0.5, mean_pressure=0.5), "bears less than its hardness"),
    (lambda: solved(contact.Flat(2.0), 1.0, 1.0, ALONE, load=2.0), "bears less than its hardness"),
    (lambda: solved(FOUR, 0.5, contact_fraction=1.0), "below 1 if the pressure reaches"),
    (
        lambda: solved(FOUR, 0.5, interaction=contact.Localized(), load=0.2),
        "not solved with the localized",
    ),
    (lambda: solved(contact.Parabola(1.0), 1.0, 1.0, ALONE, load=1.0, tilt=0.1), "plastic"),
]


@pytest.mark.parametrize("made, message", REFUSED)
def test_unsupported_scenes_are_refused_with_the_reason(made, message):
    with pytest.raises(contact.SceneError, match=message):
        made()


@pytest.mark.parametrize("modulus", [1e-2, 1e-4, 1e-8, 1e-16, 1e-60])
def test_rims_far_narrower_than_round_off(modulus):
    """The closed form of a cylinder: each elastic rim is modulus^2 / 2 of the half width wide."""
    first, second = special.ellipkm1(modulus**2), special.ellipe(1 - modulus**2)
    hardness = np.pi / (2 * first)
    load = hardness * (2 * second - modulus**2 * first)
    found = solved(contact.Parabola(1.0), hardness, 2.0, ALONE, load=load, tol=1e-8)
    plateau = np.sqrt(1 - modulus**2)
    np.testing.assert_allclose(found.zones, [[-1, 1]], rtol=1e-8)
    np.testing.assert_allclose(found.plateaus, [[-plateau, plateau]], rtol=1e-8)
    x = np.array([-0.999, 0.0, 0.5, 1 + 1e-8])
    np.testing.assert_array_equal(found.pressure(x), [hardness, hardness, hardness, 0.0])
    assert found.certificate.holds and found.error < 1e-8
    # From the rough solution, only the places of the two elastic rims are used. Their widths are
    # computed again.
    scene, rough = found.scene, solved(found.scene.profile, hardness, 2.0, ALONE, 1e-4, load=load)
    again = contact.solve(scene, tol=1e-8, near=rough)
    np.testing.assert_allclose(again.plateaus, [[-plateau, plateau]], rtol=1e-8)
    np.testing.assert_allclose(again.zones, [[-1, 1]], rtol=1e-8)
    if modulus < 1e-3:
        with pytest.raises(contact.SceneError, match="less steep profile"):
            found.worn()


def test_the_worn_profile_bears_the_same_load_elastically():
    hardness, load = 0.897211432115, 1.5393316172
    found = solved(contact.Parabola(1.0), hardness, 2.0, ALONE, load=load)
    worn, x = found.worn(), np.linspace(-0.95, 0.95, 101)
    np.testing.assert_allclose(worn.height(x), contact.Parabola(1.0).height(x) + found.overlap(x))
    h = 1e-6
    slope = (worn.height(x + h) - worn.height(x - h)) / (2 * h)
    np.testing.assert_allclose(worn.slope(x), slope, atol=1e-6)
    assert solved(FOUR, 10.0, mean_pressure=0.2, tol=1e-8).worn() is FOUR
    with pytest.raises(contact.SceneError, match="sharp corners"):
        solved(contact.Flat(4.0), 1.0, 1.0, contact.Isolated(), load=3.0).worn()


@pytest.mark.slow
def test_reloading_the_worn_profile_gives_the_same_pressure():
    found = solved(contact.Parabola(1.0), 0.897211432115, 2.0, ALONE, load=1.5393316172)
    scene = contact.Scene(found.worn(), 2.0, ALONE, load=found.load)
    again, x = contact.solve(scene, tol=1e-3), np.linspace(-0.95, 0.95, 101)
    np.testing.assert_allclose(again.zones, found.zones, rtol=1e-6)
    np.testing.assert_allclose(again.pressure(x), found.pressure(x), atol=1e-5)
    less = contact.Scene(found.worn(), 2.0, ALONE, load=0.3 * found.load)
    assert contact.solve(less, tol=1e-3).max_pressure < 0.6 * found.max_pressure


@pytest.mark.parametrize("period", [None, 1e-4])
def test_the_pressure_next_to_a_sharp_corner_stays_at_the_hardness(period):
    """The plateau has the width (pi K / (2 H))^2, with the hardness H.

    K is the intensity of the elastic contact, in which p ~ K / sqrt(distance).
    """
    way = contact.Isolated() if period is None else contact.Periodic()
    for load in (10.0, 30.0, 100.0):
        scene = contact.Scene(
            contact.Flat(4e-5, period), 1e9, way, law=contact.Plastic(2.4e7), load=load
        )
        found = contact.solve(scene)
        elastic = contact.solve(replace(scene, law=contact.Frictionless()))
        distance = 1e-12
        k = float(elastic.pressure(2e-5 - distance)) * distance**0.5
        width = 0.25 * (np.pi * k / 2.4e7) ** 2
        assert np.diff(found.plateaus)[:, 0] == pytest.approx([width, width], rel=5e-2)
        assert found.pressure(2e-5 - np.geomspace(1e-14, 1e-5, 40)).max() <= 2.4e7


def test_plastic_contact_of_an_isolated_cell_is_refused_at_the_border():
    wave = contact.Sinusoid(1e-6, 1e-4)
    scene = contact.Scene(wave, 1e9, contact.Isolated(), law=contact.Plastic(2e7), load=1e3)
    assert contact.solve_many(scene, [1e3, 1.2e3], control="load")[-1].zones.shape == (1, 2)
    with pytest.raises(contact.OutOfRange, match="border"):
        contact.solve_many(scene, [1e3, 1.5e3, 2e3], control="load")


def test_a_contact_too_narrow_for_the_first_grid_is_similar_to_a_wider_one():
    """The plateau is the same fraction of the contact at two small approaches.

    A wedge has no length scale, and the contact is far narrower than the period.
    """
    parts = []
    for approach in (1e-14, 1e-13):
        wedge = contact.Wedge(2.65e-3, 1.286e-6)
        law = contact.Plastic(7.74e6)
        scene = contact.Scene(wedge, 2.7e9, contact.Periodic(), law=law, approach=approach)
        solution = contact.solve(scene)
        parts.append(float(np.diff(solution.plateaus).sum() / solution.zone_widths.sum()))
    assert parts[0] == pytest.approx(parts[1], rel=1e-6)
