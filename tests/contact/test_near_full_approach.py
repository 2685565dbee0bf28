"""Wide contacts: load, mean pressure, approach and contact fraction lead to the same solution."""

from __future__ import annotations

import numpy as np
import pytest

import contact
from tests.contact.judge import solve, true_error
from tests.tiers import diagonal

PLACES = np.arange(40) / 40


def tops(rng):
    """Heights of a flat profile with a few samples raised to one height, adjacent or scattered."""
    height = np.zeros(40)
    many = int(rng.integers(2, 9))
    chosen = (
        (rng.integers(0, 40) + np.arange(many)) % 40
        if rng.random() < 0.5
        else rng.choice(40, many, replace=False)
    )
    height[chosen] = 2.5e-5
    return height


def steps(rng):
    height = np.zeros(40)
    for _ in range(3):
        height[(rng.integers(0, 40) + np.arange(rng.integers(2, 20))) % 40] += 10 ** rng.uniform(
            -6, -4
        )
    return height


SUBSTRATES = [contact.HalfPlane(), contact.Layer(0.05, 0.3), contact.Layer(0.02, 0.4, "smooth")]


@pytest.mark.parametrize(
    ("shape", "seed", "substrate"), diagonal([tops, steps], range(2), SUBSTRATES)
)
def test_every_control_leads_to_the_same_wide_contact(shape, seed, substrate):
    rng = np.random.default_rng(seed)
    profile = contact.Sampled(PLACES, shape(rng), period=1.0)
    for fraction in (0.9, 0.97):
        model = dict(substrate=substrate)
        given = solve(
            profile, contact.Periodic(), E_star=1e11, tol=1e-8, contact_fraction=fraction, **model
        )
        for control in ("load", "mean_pressure", "approach"):
            again = solve(
                profile,
                contact.Periodic(),
                E_star=1e11,
                tol=1e-8,
                **{control: getattr(given, control)},
                **model,
            )
            assert true_error(again, given) < 3 * (again.error + given.error) + 1e-12


def test_an_approach_near_full_contact_is_found_from_a_given_solution_too():
    height = np.zeros(40)
    height[[3, 4, 5, 6]] = 2.5e-5
    profile = contact.Sampled(PLACES, height, period=1.0)
    near = solve(profile, contact.Periodic(), E_star=1e11, contact_fraction=0.5)
    given = solve(profile, contact.Periodic(), E_star=1e11, contact_fraction=0.95)
    again = contact.solve(
        contact.Scene(profile, 1e11, contact.Periodic(), approach=given.approach), near=near
    )
    assert true_error(again, given) < 3 * (again.error + given.error)
