"""Designs: the data of a scene, within bounds, that are best for an objective."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import contact
from contact.derivatives.places import tops
from contact.derivatives.result import Sensitivity
from contact.design import search
from contact.design.problem import Problem
from contact.design.variables import Variables
from contact.model.scene import Scene


def periodic(profile: contact.Profile, **control: Any) -> Scene:
    return Scene(profile, 1e9, contact.Periodic(), **control)


WAVES = contact.Fourier(1e-4, [-1e-6, 5e-8])
BOUNDS = {"profile.cosine": ([-1.2e-6, -2e-7], [-8e-7, 2e-7])}


def test_a_wave_of_least_contact_has_the_amplitude_of_its_closed_form() -> None:
    """The largest pressure is 2 sqrt(pbar p*), with p* = pi E* amplitude / L and the mean pbar.
    Contact is least at the largest amplitude whose largest pressure is within the bound 6e7.
    """
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
        """The squared distance from the wanted fractions 0.5 and 0.7, and its gradient."""
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


def even(scene: Scene, bounds: Any, **more: Any) -> contact.Design:
    return contact.optimize(scene, "max_pressure", {"profile.cosine": bounds}, **more)


def test_the_lowest_highest_pressure_is_that_of_several_equal_peaks() -> None:
    """At the optimum no small change of the data lowers all of the highest peaks.
    The search minimizes a level t under the conditions t >= p_k for the peaks p_k.
    """
    middle = np.array([-1e-6, 0.0, 0.0])
    size = np.array([1e-8, 2e-7, 1e-7])
    scene = Scene(contact.Fourier(1e-4, middle), 1e10, contact.Periodic(), mean_pressure=8e7)
    best = even(scene, (middle - size, middle + size))
    found = best.solution
    peaks = found.pressure(tops(found, 9))
    assert len(peaks) == 2 and np.ptp(peaks) < 1e-6 * found.max_pressure
    assert best.optimality < 1e-4 and best.objective == found.max_pressure
    rng = np.random.default_rng(0)
    for scale in (1e-3, 1e-1):
        away = scale * rng.uniform(-1, 1, (4, 3)) * size
        for other in np.clip(best.data["profile.cosine"] + away, middle - size, middle + size):
            changed = contact.solve(replace(scene, profile=contact.Fourier(1e-4, other)))
            assert changed.max_pressure >= best.objective * (1 - 1e-7)


@pytest.mark.slow
def test_the_mean_of_the_highest_pressures_at_several_loads_is_made_small() -> None:
    middle, size = np.array([-1e-6, 0.0, 0.0]), np.array([1e-8, 2e-7, 1e-7])
    scene = Scene(contact.Fourier(1e-4, middle), 1e10, contact.Periodic(), mean_pressure=8e7)
    loads, bounds = (4e7, 1.2e8), (middle - size, middle + size)
    best = even(scene, bounds, at=loads, subject_to=[("contact_fraction", 0.3, None)])
    assert best.optimality < 1e-4
    assert np.isclose(best.objective, np.mean([one.max_pressure for one in best.solutions]))
    rng = np.random.default_rng(0)
    for away in 0.05 * rng.uniform(-1, 1, (6, 3)) * size:
        other = np.clip(best.data["profile.cosine"] + away, *bounds)
        profile = contact.Fourier(1e-4, other)
        some = [
            contact.solve(replace(scene.under("mean_pressure", p), profile=profile)) for p in loads
        ]
        allowed = min(one.contact_fraction for one in some) >= 0.3
        highest = np.mean([one.max_pressure for one in some])
        assert not allowed or highest >= best.objective * (1 - 1e-7)


def test_local_maxima_of_the_pressure_have_the_derivatives_of_differences() -> None:
    """The derivatives come from adjoint equations (fewer maxima than waves), and wave by wave."""
    waves = contact.Fourier(1e-4, [-1e-6, 2e-7, 3e-7], [1e-7, 0.0, -2e-7])

    def peaks(profile: contact.Profile) -> Any:
        found = contact.solve(periodic(profile, mean_pressure=1e7), 1e-11)
        return found.pressure(tops(found, 6))

    solution = contact.solve(periodic(waves, mean_pressure=1e7), 1e-11)
    places = tops(solution, 6)
    assert len(places) == 2
    by = Sensitivity(solution, stated=False, tops=places)
    table = by.of_tops("profile.sine")
    for k in range(3):
        step = 2e-10 * np.eye(3)[k]
        some = [peaks(contact.Fourier(1e-4, waves.cosine, waves.sine + s * step)) for s in (-1, 1)]
        assert np.allclose((some[1] - some[0]) / 4e-10, table[k], rtol=1e-5, atol=1e6)
        assert np.allclose(by.by(f"profile.sine[{k}]").change.values.max_pressure, table[k])


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


def test_invalid_designs_are_refused_by_name() -> None:
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


@pytest.mark.parametrize(
    ("values", "deviation", "field"),
    [
        (["a", 1.0], 1.0, "values"),
        ([np.nan, 1.0], 1.0, "values"),
        ([2.0, 1.0], "much", "deviation"),
        ([2.0, 1.0], 0.0, "deviation"),
        ([2.0, 1.0], [1.0, -1.0], "deviation"),
        ([2.0, 1.0], [1.0, 1.0, 1.0], "deviation"),
        ([2.0, 1.0], np.inf, "deviation"),
    ],
)
def test_measured_values_that_cannot_be_used_are_refused_by_name(
    values: Any, deviation: Any, field: str
) -> None:
    with pytest.raises(contact.SceneError, match=f"^{field} = "):
        contact.Measured("load", values, deviation)


def visiting(*vectors: float) -> Any:
    """A search like scipy's `minimize` that evaluates given designs and ends at the last one."""

    def minimize(value: Any, start: Any, **_: Any) -> Any:
        for vector in vectors:
            value(np.full(len(start), vector))
        return SimpleNamespace(x=np.full(len(start), vectors[-1]), message="stopped")

    return SimpleNamespace(minimize=minimize)


@pytest.mark.parametrize("number", ["contact_fraction", "-max_pressure"])
def test_the_best_design_that_satisfies_the_conditions_is_returned_and_not_the_last(
    number: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the amplitude grows, the contact shrinks and the largest pressure grows.
    So 0.12 (in units of the bounds) is the best of the visited designs that are allowed.
    """
    scene = periodic(contact.Sinusoid(1e-6, 1e-4), mean_pressure=2e7)
    over, allowed = {"profile.amplitude": (8e-7, 5e-6)}, [("max_pressure", None, 6e7)]
    for last in (0.9, 0.05):
        monkeypatch.setattr(search, "require", lambda _: visiting(0.1, 0.12, 0.5, last))  # noqa: B023
        best = contact.optimize(scene, number, over, allowed)
        assert np.isclose(best.data["profile.amplitude"], 8e-7 + 0.12 * 4.2e-6)
        assert best.objective == min(
            step.objective for step in best.history if step.conditions[0] <= 6e7
        )


def test_a_search_that_finds_no_allowed_design_says_so() -> None:
    scene = periodic(contact.Sinusoid(1e-6, 1e-4), mean_pressure=2e7)
    over = {"profile.amplitude": (8e-7, 5e-6)}
    with pytest.raises(contact.NotConverged, match="no evaluated design") as error:
        contact.optimize(scene, "contact_fraction", over, [("max_pressure", None, 2e7)])
    nearest = error.value.best
    assert np.isclose(nearest.data["profile.amplitude"], 8e-7)
    assert nearest.objective in [step.objective for step in error.value.trace]


UNEVEN = contact.Fourier(1e-4, [-1e-6, 3e-7, 0.0], [0.0, 1e-8, 0.0])
WIDE = {"profile.cosine": ([-1.01e-6, -3e-7, -3e-7], [-9.9e-7, 4e-7, 3e-7])}
STRESSED = {
    "mises": contact.StressObjective("max_stress", 0.3),
    "tresca": contact.StressObjective("max_stress", 0.3, criterion="tresca"),
    "yield": contact.StressObjective("-first_yield", 0.3, 1e7),
}


@pytest.mark.parametrize("name", STRESSED)
def test_stresses_at_competing_places_have_the_derivatives_of_differences(name: str) -> None:
    """At a place that yields at a larger load, the derivative of this load is approximate.
    Its error is proportional to the distance from yield, so it is not compared.
    """
    scene = periodic(UNEVEN, mean_pressure=4e6)
    problem = Problem(Variables.of(scene, WIDE), STRESSED[name], (), (4e6,), 1e-11)
    vector, step = problem.variables.start, 1e-5
    values = problem.competing(vector)[0]
    assert np.count_nonzero(values) == 2
    slopes = problem.competing_slopes(vector)[0]
    for k, unit in enumerate(np.eye(3)):
        low, high = (problem.competing(vector + s * step * unit)[0] for s in (-1, 1))
        found = (high - low) / (2 * step)
        close = 1e-6 * np.abs(slopes).max()
        assert abs(found[0] - slopes[0, k]) < close
        if name != "yield":
            assert abs(found[1] - slopes[1, k]) < close
        one, two = (problem.value(vector + s * step * unit) for s in (-1, 1))
        of = problem.gradient(vector)
        assert abs((two - one) / (2 * step) - of[k]) < 1e-6 * np.abs(of).max()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mises", "yield"])
def test_the_design_of_least_stress_is_better_than_its_neighbours(name: str) -> None:
    """Two places have the largest stress there; first yield is designed with two waves only."""
    scene, wanted, count = periodic(UNEVEN, mean_pressure=4e6), STRESSED[name], 3
    if name == "yield":
        scene, count = replace(scene, profile=contact.Fourier(1e-4, UNEVEN.cosine[:2])), 2
    over = {key: tuple(bound[:count] for bound in bounds) for key, bounds in WIDE.items()}
    best = contact.optimize(scene, wanted, over)
    assert best.optimality < 1e-4
    assert best.objective < best.history[0].objective
    problem = Problem(Variables.of(best.scene, over), wanted, (), (4e6,), 1e-9)
    values = problem.competing(problem.variables.start)[0]
    assert name == "yield" or np.isclose(*np.sort(values)[-2:], rtol=1e-6)
    rng = np.random.default_rng(0)
    for scale in (1e-3, 1e-1):
        for away in scale * rng.uniform(-1, 1, (3, count)):
            other = np.clip(problem.variables.start + away, 0, 1)
            assert problem.value(other) >= best.objective - 1e-7 * abs(best.objective)
