"""Designs under Dugdale's law: checks of pressure, gap and load, and the solver against them."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import contact
from contact.errors import SceneError
from contact.inverse import CohesiveDesign, random_cohesive_problem
from tests.tiers import quick

# Admissible designs: (seed, number of zones, whether two zones share a cohesive interval, `part`).
# The reach is `part` times 4 s d/(pi E*), where s is the tension and d the mean width of its
# strips.
DESIGNS = [
    (0, 1, False, 5.0),
    (1, 1, False, 10.0),
    (0, 2, False, 5.0),
    (1, 2, False, 3.0),
    (0, 2, True, 10.0),
    (1, 2, True, 10.0),
    (1, 3, False, 10.0),
    (7, 3, False, 20.0),
]


def drawn(seed, count, shared, part):
    """A random design: zones of different widths, with strips of tension of different widths."""
    rng = np.random.default_rng(seed)
    widths, gaps, strip = (
        rng.uniform(0.7, 1.3, count),
        rng.uniform(0.8, 1.5, count),
        rng.uniform(0.05, 0.2),
    )
    left = np.cumsum(widths + gaps) - widths - gaps
    zones = np.column_stack((left, left + widths))
    strips = strip * rng.uniform(0.93, 1.07, (count, 2))
    cohesive = np.column_stack((zones[:, 0] - strips[:, 0], zones[:, 1] + strips[:, 1]))
    if shared:
        k = int(rng.integers(0, count - 1))
        cohesive = np.concatenate(
            (cohesive[:k], [[cohesive[k, 0], cohesive[k + 1, 1]]], cohesive[k + 2 :])
        )
    rise = 10 ** rng.uniform(-3, -2)
    stress = 0.15 * rise
    return CohesiveDesign(zones, cohesive, 1.0, 4 * stress**2 / np.pi * strip * part, stress, rise)


def on_zones(made, count):
    """(Positions on the zones, weights of an integral, pressure): Gauss's rule in the angle."""
    u, weight = np.polynomial.legendre.leggauss(count)
    theta, half = 0.5 * np.pi * (1 + u), 0.5 * np.diff(made.zones)
    x = made.zones.mean(axis=1, keepdims=True) - half * np.cos(theta)
    return (
        x.ravel(),
        (half * np.sin(theta) * 0.5 * np.pi * weight).ravel(),
        made.pressure(x.ravel()),
    )


@pytest.mark.parametrize("drawing", DESIGNS)
def test_the_pressure_makes_the_slope_of_the_gap_and_the_load(drawing):
    made = drawn(*drawing)
    x, weight, p = on_zones(made, 400)
    strips = np.sum(np.diff(made.cohesive)) - np.sum(np.diff(made.zones))
    assert weight @ p - made.stress * strips == pytest.approx(
        made.load, abs=1e-10 * (weight @ np.abs(p))
    )
    # The density is p + s on the zones, and -s on all of each cohesive interval. The transform of
    # the constant -s is a difference of logarithms.
    at = np.array(
        [made.cohesive[0, 0] - 0.7, made.cohesive[-1, 1] + 0.4, made.cohesive[-1, 1] + 1.3]
    )
    transform = (weight * (p + made.stress) / (at[:, None] - x)).sum(axis=1) / np.pi
    left, right = made.cohesive.T
    transform -= (
        made.stress / np.pi * np.log((at[:, None] - left) / (at[:, None] - right)).sum(axis=1)
    )
    d = 1e-4
    slope = (made.gap(at + d) - made.gap(at - d)) / (2 * d)
    wanted = made.profile.slope(at) - 2 / made.E_star * transform
    assert slope == pytest.approx(wanted, rel=1e-5)


@pytest.mark.parametrize("drawing", DESIGNS)
def test_the_gap_is_the_reach_where_the_tension_ends_and_the_zone_ends_bear_the_tension(drawing):
    made = drawn(*drawing)
    assert made.gap(made.cohesive.ravel()) == pytest.approx(
        np.full(made.cohesive.size, made.reach), rel=1e-10
    )
    inside = made.zones + np.array([1.0, -1.0]) * 1e-9
    assert made.pressure(inside.ravel()) == pytest.approx(
        np.full(made.zones.size, -made.stress), rel=1e-2
    )


@pytest.mark.parametrize(
    "drawing",
    [
        each if k % 2 else pytest.param(each, marks=pytest.mark.slow)
        for k, each in enumerate(DESIGNS)
    ],
)
def test_designed_contacts_of_unlike_zones_are_solved_to_nine_digits(drawing):
    made = drawn(*drawing)
    assert made.is_admissible
    law = contact.Dugdale(made.work, made.stress)
    scene = contact.Scene(made.profile, made.E_star, contact.Isolated(), law=law, load=made.load)
    # The stated error is up to a hundred times the true error.
    found = contact.solve(scene, tol=3e-8)
    least = float(np.diff(made.zones).min())
    assert found.zones == pytest.approx(made.zones, abs=1e-9 * least)
    assert found.cohesive == pytest.approx(made.cohesive, abs=1e-9 * least)
    # The pressures are compared at equal scaled positions t in the zones. At a fixed x near an end,
    # the pressure would change by the square root of the error of this end.
    x, _, p = on_zones(made, 9)
    t = (x.reshape(-1, 9) - made.zones.mean(axis=1, keepdims=True)) / (0.5 * np.diff(made.zones))
    pressures = np.concatenate([found.pressure_at(t[k], k) for k in range(len(t))])
    assert pressures == pytest.approx(p, abs=1e-9 * np.abs(p).max())


def is_met(made):
    """Whether the solver finds the design, or cohesive intervals inside those of the design.

    The solver follows the advancing branch. A design is not always on this branch.
    """
    law = contact.Dugdale(made.work, made.stress)
    found = contact.solve(
        contact.Scene(made.profile, made.E_star, contact.Isolated(), law=law, load=made.load), 1e-2
    )
    least = float(np.diff(made.zones).min())
    if found.zones.shape == made.zones.shape and found.cohesive.shape == made.cohesive.shape:
        off = (
            max(
                np.abs(found.zones - made.zones).max(), np.abs(found.cohesive - made.cohesive).max()
            )
            / least
        )
        if off < 1e-9 + 10 * found.error:
            return True
    return all(
        np.any((made.cohesive[:, 0] <= a + 1e-9) & (b - 1e-9 <= made.cohesive[:, 1]))
        for a, b in found.cohesive
    )


@pytest.mark.parametrize(
    ("seed", "count"), quick([(0, 1), (2, 2), (1, 3), (2, 6)], always=[(0, 1), (2, 2), (1, 3)])
)
def test_a_random_design_carries_its_load_and_is_found(seed, count):
    made = random_cohesive_problem(np.random.default_rng(seed), count, spread=2.0)
    x, weight, p = on_zones(made, 400)
    strips = np.sum(np.diff(made.cohesive)) - np.sum(np.diff(made.zones))
    assert weight @ p - made.stress * strips == pytest.approx(made.given_load, rel=1e-9)
    assert made.load == pytest.approx(made.given_load, rel=1e-10) and made.condition < 1e7
    assert is_met(made)


@pytest.mark.slow
@settings(max_examples=24, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.integers(0, 10**6), st.integers(1, 6))
def test_designs_of_one_to_six_unlike_zones_are_found(seed, count):
    made = random_cohesive_problem(np.random.default_rng(seed), count, spread=2.0)
    assert is_met(made)


def test_a_design_of_other_zones_is_another_contact():
    made = drawn(*DESIGNS[2])
    other = CohesiveDesign(
        made.zones * (1 + 1e-6), made.cohesive, made.E_star, made.work, made.stress, made.rise
    )
    assert np.abs(other.profile.coefficients - made.profile.coefficients).max() > 1e-9 * made.rise


def test_intervals_without_a_zone_and_ends_in_descending_order_are_refused():
    with pytest.raises(SceneError, match="each contain a zone"):
        CohesiveDesign([[-1, 1]], [[-2, 2], [3, 4]], 1.0, 1e-3, 1e-2, 0.1)
    with pytest.raises(SceneError, match="strictly increasing"):
        CohesiveDesign([[1, -1]], [[-2, 2]], 1.0, 1e-3, 1e-2, 0.1)
