"""Sliding of elastically different bodies: closed forms, symmetry, balances, refused scenes."""

import pickle

import numpy as np
import pytest
from scipy import optimize, special

import contact

pytestmark = pytest.mark.filterwarnings("ignore::contact.ModelWarning")

E_STAR = 2.0  # so that (E*/2) f' is the slope itself


def law_of(alpha: float) -> contact.Sliding:
    """A law with which the pressure has the exponent alpha at right and 1 - alpha at left ends."""
    kappa = 1 / np.tan(np.pi * alpha)
    return contact.Sliding(abs(kappa) / 0.5, 0.5, -1 if kappa > 0 else 1)


def solved(profile, alpha, tol=1e-11, interaction=None, **control):
    interaction = interaction or contact.Isolated(datum=10.0)
    scene = contact.Scene(profile, E_STAR, interaction, law=law_of(alpha), **control)
    return contact.solve(scene, tol=tol)


@pytest.mark.parametrize("alpha", [0.36, 0.55])
def test_a_sliding_cylinder_has_the_closed_form(alpha):
    found = solved(contact.Parabola(1.0), alpha, load=0.3)
    l, middle = found.zone_widths[0] / 2, found.zones.mean()
    t = np.linspace(-0.99, 0.99, 9)
    exact = l * np.sin(np.pi * alpha) * (1 - t) ** alpha * (1 + t) ** (1 - alpha)
    assert np.pi * alpha * (1 - alpha) * E_STAR * l**2 == pytest.approx(0.3, rel=1e-11)
    assert middle == pytest.approx(l * (1 - 2 * alpha), rel=1e-11)
    np.testing.assert_allclose(found.pressure_at(t), exact, rtol=1e-11)
    assert np.any(np.abs(found.pressure_at(t) - exact[::-1]) > 1e-3)
    assert found.tangential_load == pytest.approx(found.scene.law.shear_ratio * 0.3, rel=1e-14)
    np.testing.assert_array_equal(
        found.shear([0.0, 9.0]), found.scene.law.shear_ratio * found.pressure([0.0, 9.0])
    )


def test_a_sliding_wedge_has_the_closed_form():
    # The numbers hold for alpha = 0.36, the width 2 and E* slope = 1.
    found = solved(contact.Wedge(0.5), 0.36, load=0.914850713939)
    left = -0.503626200773
    np.testing.assert_allclose(found.zones, [[left, left + 2]], atol=2e-12)
    np.testing.assert_allclose(
        found.pressure([0.5, -0.2]), [0.5419536223609, 0.3594806247203], rtol=4e-12
    )
    assert special.betainc(0.36, 0.64, -found.zones[0, 0] / 2) == pytest.approx(0.5, rel=1e-11)
    assert found.max_pressure == np.inf
    again = solved(contact.Wedge(0.5), 0.36, approach=found.approach)
    assert again.load == pytest.approx(found.load, rel=1e-11)


def test_a_sliding_flat_punch_presses_on_its_trailing_corner():
    alpha, x = 0.36, np.linspace(-0.99, 0.99, 9)
    found = solved(contact.Flat(2.0), alpha, load=1.0)
    exact = np.sin(np.pi * alpha) / np.pi * (1 - x) ** (alpha - 1) * (1 + x) ** -alpha
    np.testing.assert_allclose(found.pressure(x), exact, rtol=1e-11)


PERIOD, HEIGHT = 2.0, 0.01
WAVE = contact.Sinusoid(HEIGHT, PERIOD)
FULL = np.pi * E_STAR * HEIGHT / PERIOD


@pytest.mark.parametrize("alpha, part", [(0.41, 0.01), (0.41, 0.4), (0.64, 0.8), (0.36, 0.98)])
def test_a_sliding_wave_has_the_closed_form(alpha, part):
    mean = part * FULL * np.sin(np.pi * alpha)
    found = solved(WAVE, alpha, interaction=contact.Periodic(), mean_pressure=mean)
    A, B = np.pi * found.zones[0] / PERIOD
    m = alpha * B + (1 - alpha) * A
    ends = np.cos(2 * m - np.pi * alpha)
    ends -= alpha * np.cos(2 * B + np.pi * alpha) + (1 - alpha) * np.cos(2 * A + np.pi * alpha)
    load = np.cos(2 * m) - alpha * np.cos(2 * B) - (1 - alpha) * np.cos(2 * A)
    u = A + (B - A) * np.linspace(0.02, 0.98, 9)
    exact = np.sin(np.pi * alpha) * np.sin(B - u) ** alpha * np.sin(u - A) ** (1 - alpha)
    exact *= 2 * FULL * np.cos(u + m)
    assert abs(ends) < 1e-11
    assert 0.5 * FULL * load == pytest.approx(mean, rel=1e-10)
    np.testing.assert_allclose(found.pressure(u * PERIOD / np.pi), exact, rtol=0, atol=1e-11 * FULL)
    # Without the term of the mean pressure, the condition on the ends is not fulfilled.
    assert abs(np.sin(2 * m) + alpha * np.sin(2 * B) + (1 - alpha) * np.sin(2 * A)) > 1e-6


def test_full_contact_in_sliding_begins_earlier_and_is_skew():
    alpha, periodic = 0.41, contact.Periodic()
    found = solved(WAVE, alpha, interaction=periodic, contact_fraction=1.0)
    assert found.mean_pressure == pytest.approx(FULL * np.sin(np.pi * alpha), rel=1e-11)
    found = solved(WAVE, alpha, interaction=periodic, mean_pressure=2 * FULL)
    x = np.linspace(0.0, PERIOD, 9)
    waves = np.cos(2 * np.pi * x / PERIOD - np.arctan(found.scene.law.kappa))
    exact = 2 * FULL + FULL * np.sin(np.pi * alpha) * waves
    np.testing.assert_allclose(found.pressure(x), exact, rtol=1e-11)


def _logarithm(w):
    """log sin w, analytic for Im w >= 0."""
    return -1j * w + 0.5j * np.pi - np.log(2) + np.log(1 - np.exp(2j * w))


def test_two_zones_in_a_period_fulfil_the_algebraic_conditions():
    """The ends of the two zones fulfil the algebraic conditions on the slope X M of the gap.

    The module test_sliding_designed.py defines X and M. The waves of X M that grow at i
    infinity are those of f'; the mean of X M has the mean pressure as its imaginary part; the
    integral of X M over each gap is zero.
    """
    alpha, mean, waves = 0.44, 0.25, np.array([0.1 + 0.3j, -0.05 + 0.6j])
    j = np.array([1, 2])
    profile = contact.Fourier(2 * np.pi, -2 / j * waves.imag, 2 / j * waves.real)
    found = solved(profile, alpha, interaction=contact.Periodic(), mean_pressure=mean)
    ends = np.sort((found.zones.ravel() + 1.0) % (2 * np.pi) - 1.0).reshape(2, 2)
    kappa = found.scene.law.kappa

    def product(z, ends, m):
        powers = sum(
            alpha * _logarithm((z - b) / 2) + (1 - alpha) * _logarithm((z - a) / 2) for a, b in ends
        )
        return np.exp(powers) * (m[0] + m[1] * np.cos(z) + m[2] * np.sin(z))

    height, points = 0.7, 2 * np.pi * np.arange(64) / 64
    t, weight = special.roots_jacobi(40, 1 - alpha, alpha)

    def missing(unknown):
        ends, m = unknown[:4].reshape(2, 2), unknown[4:]
        series = np.fft.fft(product(points + 1j * height, ends, m)) / 64
        grown = series[[0, -1, -2]] * np.exp(-height * np.arange(3))
        out = [*(grown[1:] - waves).view(float), (grown[0] - 1j * mean).imag]
        for (_, b), a in zip(ends, [ends[1, 0], ends[0, 0] + 2 * np.pi], strict=True):
            x = 0.5 * (a + b) + 0.5 * (a - b) * t
            slope = product(x + 0j, ends, m).real / ((1 - t) ** (1 - alpha) * (1 + t) ** alpha)
            out.append(weight @ slope)
        return np.array(out)

    rough = ends + 0.02 * np.array([[1, -1], [0.5, -1]])
    free = optimize.least_squares(lambda m: missing(np.append(rough, m)), [0.1, 0.1, 0.1]).x
    other = optimize.root(missing, np.append(rough, free), tol=1e-14).x
    np.testing.assert_allclose(other[:4].reshape(2, 2), ends, atol=1e-11)
    inside = ends.mean(axis=1)
    np.testing.assert_allclose(
        product(inside + 0j, ends, other[4:]).imag, found.pressure(inside), rtol=1e-10
    )
    assert kappa > 0 and found.certificate.holds and found.error < 1e-10


def test_a_mirrored_profile_slides_like_the_profile_in_the_opposite_direction():
    coefficients = [0.0, 0.02, 0.4, 0.3, 0.6]
    mirrored = [(-1) ** k * c for k, c in enumerate(coefficients)]
    one, other = (
        solved(contact.Polynomial(c), alpha, load=0.05)
        for c, alpha in ((coefficients, 0.4), (mirrored, 0.6))
    )
    x = np.linspace(-0.4, 0.4, 9)
    np.testing.assert_allclose(one.zones, -other.zones[:, ::-1], rtol=1e-11)
    np.testing.assert_allclose(one.gap(x), other.gap(-x), atol=1e-13)
    assert one.approach == pytest.approx(other.approach, rel=1e-11)


def test_without_mismatch_the_contact_is_the_frictionless_one():
    scene = contact.Scene(WAVE, E_STAR, contact.Periodic(), load=0.01)
    plain = contact.solve(scene)
    found = contact.solve(contact.Scene(*_parts(scene), law=contact.Sliding(0.3), load=0.01))
    x = np.linspace(0.0, PERIOD, 9)
    np.testing.assert_array_equal(found.zones, plain.zones)
    np.testing.assert_array_equal(found.pressure(x), plain.pressure(x))
    np.testing.assert_array_equal(found.shear(x), 0.3 * plain.pressure(x))
    assert found.tangential_load == 0.3 * plain.load
    assert plain.tangential_load == 0.0 and not np.any(plain.shear(x))
    assert found.approach == plain.approach and found.energy is None


def _parts(scene):
    return scene.profile, scene.E_star, scene.interaction


CONTROLS = [
    (contact.Parabola(1.0), contact.Isolated(datum=10.0), ("approach",)),
    (contact.Wedge(0.01, PERIOD), contact.Periodic(), ("approach", "contact_fraction")),
    (WAVE, contact.Periodic(), ("approach", "contact_fraction", "mean_pressure")),
]


@pytest.mark.parametrize("profile, interaction, names", CONTROLS)
def test_all_controls_lead_to_the_same_contact(profile, interaction, names):
    found = solved(profile, 0.4, interaction=interaction, load=0.02)
    for name in names:
        again = solved(profile, 0.4, interaction=interaction, **{name: getattr(found, name)})
        np.testing.assert_allclose(again.zones, found.zones, rtol=1e-9)
        assert again.load == pytest.approx(found.load, rel=1e-9)


@pytest.mark.parametrize("profile, interaction, names", CONTROLS)
def test_the_stiffness_is_the_slope_of_the_load_curve(profile, interaction, names):
    load, step = 0.02, 1e-6
    low, here, high = (
        solved(profile, 0.4, interaction=interaction, load=load + k * step) for k in (-1, 0, 1)
    )
    slope = 2 * step / (high.approach - low.approach)
    assert here.stiffness == pytest.approx(slope, rel=1e-7)


def test_a_trace_with_knots_obeys_its_own_equation():
    """In the zones T p + kappa (p - mean p) = f', because E* = 2.

    The mean gap is the mean of the gap's values, and displacements have zero mean.
    """
    x = np.arange(24) / 24
    heights = 1e-3 * (np.cos(2 * np.pi * x) + 0.3 * np.sin(6 * np.pi * x + 1))
    trace = contact.Sampled(x, heights, period=1.0)
    found = solved(trace, 0.4, interaction=contact.Periodic(), contact_fraction=0.3)
    density, problem = found.fields.density, found.fields.problem
    places = found.zones.mean(axis=1) + 0.1 * found.zone_widths
    scaled, mean = problem.units.scaled(places), found.mean_pressure / problem.units.pressure
    left = density.transform(scaled) + found.scene.law.kappa * (density(scaled) - mean)
    np.testing.assert_allclose(left, problem.slope(scaled), atol=1e-8)
    even = (np.arange(4000) + 0.5) / 4000
    assert np.mean(found.gap(even)) == pytest.approx(found.mean_gap, rel=1e-6)
    assert np.mean(found.displacement(even)) == pytest.approx(0.0, abs=1e-9)
    assert len(found.zones) > 1 and found.certificate.holds


def test_a_moment_turns_a_sliding_body():
    found = solved(contact.Flat(2.0), 0.4, load=1.0, moment=0.05)
    assert found.moment == pytest.approx(0.05, rel=1e-10) and found.tilt != 0
    given = solved(contact.Flat(2.0), 0.4, load=1.0, tilt=found.tilt)
    x = np.linspace(-0.9, 0.9, 5)
    np.testing.assert_allclose(given.pressure(x), found.pressure(x), rtol=1e-9)


def test_beta_follows_from_the_moduli_of_two_bodies(tmp_path):
    text = """
    profile = {shape = "parabola", radius = 1.0}
    material = {E1 = 1e9, nu1 = 0.3}
    interaction = {model = "isolated"}
    law = {model = "sliding", friction = 0.4, direction = -1}
    control = {load = 1e4}
    """
    file = tmp_path / "scene.toml"
    file.write_text(text)
    scene = contact.load_scene(file)
    assert scene.law == contact.Sliding(0.4, (1 - 0.6) / (2 - 0.6), -1)
    file.write_text(text.replace("friction = 0.4", "friction = 0.4, beta = 0.1"))
    assert contact.load_scene(file).law.beta == 0.1
    file.write_text(text.replace("nu1 = 0.3", "nu1 = 0.3, E2 = 1e9, nu2 = 0.3"))
    assert contact.load_scene(file).law.kappa == 0.0
    both = contact.dundurs_beta(1.0, 0.2, 3.0, 0.4)
    assert both == -contact.dundurs_beta(3.0, 0.4, 1.0, 0.2)
    G = 1 / 2.4, 3 / 2.8
    exact = (0.6 / G[0] - 0.2 / G[1]) / (0.8 / G[0] + 0.6 / G[1])
    assert 2 * both == pytest.approx(exact, rel=1e-14)


def test_a_sliding_solution_is_pickled_and_written():
    found = solved(WAVE, 0.4, interaction=contact.Periodic(), mean_pressure=0.3 * FULL)
    again, x = pickle.loads(pickle.dumps(found)), np.linspace(0.0, PERIOD, 5)
    np.testing.assert_array_equal(again.pressure(x), found.pressure(x))
    np.testing.assert_array_equal(again.gap(x), found.gap(x))
    assert again.stiffness == found.stiffness
    written = found.to_dict()
    assert written["tangential_load"] == found.tangential_load


SLIDING = contact.Sliding(0.4, 0.2)
REFUSED = [
    (lambda: contact.Sliding(-0.1), "friction"),
    (lambda: contact.Sliding(0.4, 0.6), "beta"),
    (lambda: contact.Sliding(0.4, 0.2, 2), "direction"),
    (lambda: contact.dundurs_beta(1.0, 0.3, 2.0), "nu2"),
    (dict(half_width=0.1), "half_width"),
    (dict(interaction=contact.Localized(), load=0.01), "localized"),
    (dict(substrate=contact.Layer(1.0, 0.3), load=0.01), "half-planes"),
    (dict(profile=contact.Power(1.0, 1.5, PERIOD), load=0.01), "power"),
]


@pytest.mark.parametrize("given, name", REFUSED)
def test_data_that_sliding_does_not_allow_are_refused_by_name(given, name):
    with pytest.raises(contact.SceneError, match=name):
        if callable(given):
            given()
        else:
            others = {"interaction": contact.Periodic(), "profile": WAVE, **given}
            contact.Scene(E_star=E_STAR, law=SLIDING, **others)


def test_the_stresses_below_a_sliding_cylinder_have_the_closed_form():
    alpha = 0.36
    found = solved(contact.Parabola(1.0), alpha, load=0.3)
    l, middle, q = found.zone_widths[0] / 2, found.zones.mean(), found.scene.law.shear_ratio
    x, y = np.array([0.1, -0.3, 0.5, 0.9]), np.array([0.2, 1e-6, 0.7, 0.01])

    def transform(z):
        t = (z - middle) / l
        return l * (t + 1 - 2 * alpha - (t - 1) ** alpha * (t + 1) ** (1 - alpha))

    z, step = x + 1j * y, 1e-7
    G, slope = transform(z), (transform(z + step * y) - transform(z - step * y)) / (2 * step)
    xx = G.imag + slope.real + q * (-2 * G.real + slope.imag)
    yy = G.imag - slope.real - q * slope.imag
    xy = -slope.imag + q * (G.imag + slope.real)
    stress = found.stress(x, y)
    for value, exact in ((stress.xx, xx), (stress.yy, yy), (stress.xy, xy)):
        np.testing.assert_allclose(value, exact, atol=1e-8)


@pytest.mark.parametrize("part", [0.3, 0.9, 1.5])
def test_the_stresses_at_the_surface_follow_from_pressure_and_slope(part):
    """At the surface s_yy = -p, s_xy = -q and s_xx = -p - 2 T q, with the shear q.

    In contact, T p = f' - kappa (p - mean p).
    """
    alpha = 0.36
    mean = part * FULL * np.sin(np.pi * alpha)
    found = solved(WAVE, alpha, interaction=contact.Periodic(), mean_pressure=mean)
    law, x = found.scene.law, np.array([-0.1, 0.03, 0.2])
    stress, p = found.stress(x, 1e-9 + 0 * x), found.pressure(x)
    transform = WAVE.slope(x) - law.kappa * (p - mean)
    np.testing.assert_allclose(stress.yy, -p, atol=1e-6 * FULL)
    np.testing.assert_allclose(stress.xy, -found.shear(x), atol=1e-6 * FULL)
    np.testing.assert_allclose(
        stress.xx, -p - 2 * law.shear_ratio * transform, atol=1e-6 * FULL * (1 + law.friction)
    )
    deep = found.stress(0.0, 50.0)
    assert float(deep.yy) == pytest.approx(-mean) and float(deep.xy) == pytest.approx(
        -law.shear_ratio * mean
    )


@pytest.mark.slow
def test_a_load_path_in_sliding_has_the_contacts_and_events_of_single_solutions():
    profile = contact.Fourier(1.0, [-0.01, 0.002, 0.004], [0.003, 0.001, 0.0])
    law = contact.Sliding(0.8, 0.4)
    scene = contact.Scene(profile, E_STAR, contact.Periodic(), law=law, load=1e-3)
    path = contact.path(scene, np.geomspace(1e-3, 0.08, 6))
    assert {event.kind for event in path.events} == {"birth", "merge"}
    for event in path.events:
        counts = [
            len(contact.solve(scene.under("load", float(event.load) * part)).zones)
            for part in (0.9999, 1.0001)
        ]
        assert counts[1] - counts[0] == (1 if event.kind == "birth" else -1)
    for solution in path.solutions:
        alone = contact.solve(scene.under("load", solution.load))
        np.testing.assert_allclose(alone.zones, solution.zones, atol=1e-8)
    for solution in contact.solve_many(scene, np.geomspace(1e-3, 0.08, 3)):
        alone = contact.solve(scene.under("load", solution.load))
        np.testing.assert_allclose(alone.zones, solution.zones, atol=1e-8)
