"""Designs: the best data of a scene within bounds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import contact
from contact.model.scene import Scene


def periodic(profile: contact.Profile, **control: Any) -> Scene:
    return Scene(profile, 1e9, contact.Periodic(), **control)


WAVES = contact.Fourier(1e-4, [-1e-6, 5e-8])
BOUNDS = {"profile.cosine": ([-1.2e-6, -2e-7], [-8e-7, 2e-7])}


def test_a_wave_of_least_contact_has_the_amplitude_of_its_closed_form() -> None:
    """p = 2 sqrt(pbar p*) <= H, p* = pi E* amplitude / L: the largest amplitude that H allows."""
    scene = periodic(contact.Sinusoid(1e-6, 1e-4), mean_pressure=2e7)
    best = contact.optimize(
        scene,
        "contact_fraction",
        {"profile.amplitude": (8e-7, 5e-6)},
        [("max_pressure", None, 6e7)],
    )
    exact = 6e7**2 / 4 / 2e7 * 1e-4 / np.pi / 1e9
    assert np.isclose(best.data["profile.amplitude"], exact, rtol=1e-7)
    assert best.optimality < 1e-6
    assert np.isclose(best.solution.max_pressure, 6e7, rtol=1e-7)


def test_a_design_is_better_than_its_neighbours() -> None:
    scene = periodic(WAVES, mean_pressure=1e7)

    def apart(values: Any) -> tuple[float, list[float]]:
        """Fractions of 0.5 at the first and 0.7 at the second load are wanted."""
        away = np.array(values) - [0.5, 0.7]
        return float(away @ away), list(2 * away)

    wanted = contact.Objective("contact_fraction", apart)
    best = contact.optimize(scene, wanted, BOUNDS, at=(1e7, 1.6e7))
    assert len(best.solutions) == 2 and best.optimality < 1e-6
    assert best.objective <= min(step.objective for step in best.history) * (1 + 1e-12)
    rng = np.random.default_rng(0)
    for _ in range(4):
        low, high = (np.array(bound) for bound in BOUNDS["profile.cosine"])
        other = best.data["profile.cosine"] + 1e-2 * (high - low) * rng.uniform(-1, 1, 2)
        changed = replace(scene, profile=contact.Fourier(1e-4, np.clip(other, low, high)))
        values = [
            contact.solve(changed.under("mean_pressure", p)).contact_fraction for p in (1e7, 1.6e7)
        ]
        assert apart(values)[0] >= best.objective * (1 - 1e-9)


def test_data_behind_a_load_curve_are_found_with_their_covariance() -> None:
    pressures = (5e6, 1.6e7)
    true = periodic(contact.Fourier(1e-4, [-1e-6, 1e-7]), mean_pressure=1e7)
    exact = np.array([contact.solve(true.under("mean_pressure", p)).approach for p in pressures])
    measured = contact.Measured("approach", exact, deviation=1e-9)
    best = contact.optimize(periodic(WAVES, mean_pressure=1e7), measured, BOUNDS, at=pressures)
    assert np.allclose(best.data["profile.cosine"], [-1e-6, 1e-7], rtol=1e-6)
    slopes = np.array(
        [contact.sensitivity(one).of("approach", "profile.cosine").value for one in best.solutions]
    )
    assert np.allclose(best.covariance, np.linalg.inv(slopes.T @ slopes) * 1e-18, rtol=1e-6)


def test_what_cannot_be_designed_is_refused_by_name() -> None:
    scene = periodic(WAVES, mean_pressure=1e7)
    over = {"profile.cosine": (-2e-6, 2e-6)}
    for words, arguments in {
        "objective": ("pressure", over),
        "over": ("max_pressure", {"profile.length": (0, 1)}),
        "lowest below": ("max_pressure", {"material.E_star": (2e9, 1e9)}),
        "own value": ("max_pressure", {"material.E_star": (2e9, 3e9)}),
        "no array": ("zone_loads", over),
        "subject_to": ("max_pressure", over, [("zones", 0, 1)]),
        "one for each": (contact.Measured("load", [1.0, 2.0]), over),
    }.items():
        with pytest.raises(contact.SceneError, match=words):
            contact.optimize(scene, *arguments)
