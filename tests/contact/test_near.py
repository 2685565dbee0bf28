"""Warm starts from a given solution: few steps if it is near, few extra steps if it is not."""

import numpy as np
import pytest

import contact
from contact import path

ROUGH = contact.Fourier(1.0, [-0.01, 0.004, 0.002], [0.003, -0.002, 0.004])
WAVE = contact.Sinusoid(1e-2, 1.0)


def scene(profile, **control):
    return contact.Scene(profile, 1.0, contact.Periodic(), **control)


def full_load(profile):
    return contact.solve(scene(profile, contact_fraction=1.0)).load


@pytest.mark.parametrize("profile", [WAVE, ROUGH], ids=["one zone", "several"])
@pytest.mark.parametrize("part", [0.01, 0.29, 0.31, 0.6, 0.95, 1.2])
def test_a_start_from_a_distant_solution_takes_at_most_a_few_steps_more_than_no_start(
    newton_steps, profile, part
):
    full = full_load(profile)
    near = contact.solve(scene(profile, load=0.3 * full))
    cold, one = newton_steps(lambda: contact.solve(scene(profile, load=part * full)))
    warm, other = newton_steps(lambda: contact.solve(scene(profile, load=part * full), near=near))
    assert warm <= cold + 5
    assert len(one.zones) == len(other.zones)
    assert np.all(np.abs(one.zones - other.zones) < 1e-8)


def test_a_start_from_the_solution_itself_takes_one_step(newton_steps):
    here = scene(ROUGH, load=0.3 * full_load(ROUGH))
    near = contact.solve(here)
    assert newton_steps(lambda: contact.solve(here, near=near))[0] == 1


def test_a_path_past_full_contact_takes_at_most_sixty_steps_per_event(newton_steps):
    full = full_load(ROUGH)
    taken, along = newton_steps(lambda: path(scene(ROUGH, load=1.0), [0.02 * full, 1.1 * full]))
    assert along.events[-1].kind == "full"
    assert taken <= 60 * len(along.events)
