"""Derivatives of a solution by all data of its scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

import contact
from contact.derivatives.parameters import OF_PRESSURE
from contact.derivatives.response import NUMBERS
from contact.derivatives.stresses import LargestStress
from contact.inside.largest import Criterion
from contact.model.scene import Scene
from contact.sweeps.sweep.keys import varied

WAVE = contact.Sinusoid(1e-6, 1e-4)
SERIES = contact.Fourier(1e-4, [-2e-7, -1e-6, 1e-7], [1e-7, 3e-7])
ALONE = contact.Isolated(datum=1.0)


def isolated(profile: contact.Profile, **control: Any) -> Scene:
    return Scene(profile, 1e9, ALONE, **(control or {"load": 1e4}))


def periodic(profile: contact.Profile, **more: Any) -> Scene:
    return Scene(profile, 1e9, contact.Periodic(), **more)


# The logarithmic derivative of a product of powers by one factor is the exponent of this
# factor. The profile f |x|^n has the half width a ~ (P / (E* f))^(1/n) and the pressure
# p ~ P / a.
POWERS = {
    "cylinder": (isolated(contact.Parabola(1.0)), "profile.radius", 2.0, -1.0),
    "wedge": (isolated(contact.Wedge(0.01)), "profile.slope", 1.0, 1.0),
    "power": (isolated(contact.Power(2.0, 1.5)), "profile.coefficient", 1.5, 1.0),
    "quartic": (isolated(contact.Power(5.0, 4.0)), "profile.coefficient", 4.0, 1.0),
}


@pytest.mark.parametrize("name", POWERS)
def test_powers_of_the_data_are_logarithmic_derivatives(name: str) -> None:
    scene, key, n, sign = POWERS[name]
    by = contact.sensitivity(contact.solve(scene, tol=1e-11))
    size = {"control.load": 1e4, "material.E_star": 1e9, key: 1.0 / sign}
    size[key] = sign * next(iter(scene.profile.parameters().values()))
    for to, power in (("control.load", 1 / n), ("material.E_star", -1 / n), (key, -1 / n)):
        wider = by.of("zone_widths", to).value * size[to] / by.solution.zone_widths
        assert np.allclose(wider, power, rtol=1e-9)
        if np.isfinite(by.solution.max_pressure):
            higher = by.of("max_pressure", to)
            of_load = 1.0 if to == "control.load" else 0.0
            assert np.isclose(
                higher.value * size[to] / by.solution.max_pressure, of_load - power, rtol=1e-8
            )
            assert higher.error < 1e-6 * abs(higher.value)


def test_a_wave_has_the_derivatives_of_its_closed_form() -> None:
    """The half angle A = pi a/L obeys sin^2 A = pbar / p*; the largest pressure is 2 p* sin A.

    Here p* = pi E* amplitude / L.
    """
    solution = contact.solve(periodic(WAVE, mean_pressure=1e7), tol=1e-12)
    by, full = contact.sensitivity(solution), np.pi * 1e9 * 1e-2
    angle = np.arcsin(np.sqrt(1e7 / full))
    per_mean = {"contact_fraction": np.tan(angle) / np.pi, "max_pressure": full * np.sin(angle)}
    for number, grown in per_mean.items():
        assert np.isclose(by.of(number, "control.mean_pressure").value * 1e7, grown, rtol=1e-10)
        # Pressures are proportional to E*, and to amplitude / period.
        for to, size, sign in (
            ("material.E_star", 1e9, 1.0),
            ("profile.amplitude", 1e-6, 1.0),
            ("profile.period", 1e-4, -1.0),
        ):
            own = solution.max_pressure if number == "max_pressure" else 0.0
            expected = sign * (own - grown)
            assert np.isclose(by.of(number, to).value * size, expected, rtol=1e-10)


# A scene for each way of solution, and the data by which its numbers are differentiated.
ROUTES: dict[str, tuple[Scene, tuple[str, ...]]] = {
    "zones": (periodic(SERIES, mean_pressure=2e7), ("profile.cosine[0]", "profile.period")),
    "zones at a fraction": (
        periodic(SERIES, contact_fraction=0.3),
        ("profile.sine[1]", "control.contact_fraction"),
    ),
    "zones at an approach": (
        periodic(SERIES, approach=1e-6),
        ("profile.sine[1]", "material.E_star"),
    ),
    "gaps": (periodic(SERIES, contact_fraction=0.9), ("profile.cosine[1]", "profile.period")),
    "full contact": (periodic(SERIES, mean_pressure=1e8), ("profile.cosine[1]", "profile.period")),
    "layer": (
        periodic(SERIES, substrate=contact.Layer(2e-5, 0.3), contact_fraction=0.4),
        ("profile.sine[0]", "material.E_star"),
    ),
    "layer by gaps": (
        periodic(SERIES, substrate=contact.Layer(2e-5, 0.3), contact_fraction=0.9),
        ("profile.sine[0]",),
    ),
    "one zone": (isolated(contact.Biquadratic(1.0, 1e-3)), ("profile.spacing", "profile.radius")),
    "exponent": (isolated(contact.Power(2.0, 1.7)), ("profile.exponent",)),
    "tilt": (isolated(contact.Parabola(1.0), load=1e4, tilt=1e-4), ("control.tilt",)),
    "moment": (isolated(contact.Power(1.0, 4.0), load=1e4, moment=10.0), ("control.moment",)),
    "half width": (isolated(contact.Power(1.0, 4.0), half_width=1e-3), ("profile.exponent",)),
    "sliding": (
        periodic(SERIES, law=contact.Sliding(0.5, 0.3), mean_pressure=2e7),
        ("profile.sine[0]", "control.mean_pressure"),
    ),
    "adhesion": (
        periodic(WAVE, law=contact.JKR(0.01), mean_pressure=1e7),
        ("profile.amplitude", "law.work", "profile.period"),
    ),
}
TOL = 1e-11


def changed(scene: Scene, to: str, factor: float) -> Scene:
    """The scene with one of its data multiplied by `factor`."""
    name, _, index = to.partition("[")
    value = contact.sensitivity(contact.solve(scene))._rates.values[name]
    if not index:
        return varied(scene, {name: float(value) * factor})
    table, _, key = name.partition(".")
    other = np.array(value, dtype=float)
    other[int(index[:-1])] *= factor
    return replace(scene, profile=scene.profile.varied({table: {key: other}}))


def by_differences(scene: Scene, to: str, of: Callable[[Any], Any], step: float = 2e-3) -> Any:
    """The derivative with respect to the logarithm of one datum, by differences of order 6."""
    total = 0.0
    for k, weight in enumerate((3 / 4, -3 / 20, 1 / 60), 1):
        for sign in (1.0, -1.0):
            other = contact.solve(changed(scene, to, 1 + sign * k * step), TOL)
            total = total + sign * weight / step * np.asarray(of(other), dtype=float)
    return total


def numbers_of(solution: contact.Solution) -> Any:
    """All numbers of the solution that have derivatives, in one array."""
    return np.concatenate(
        [np.ravel(getattr(solution, name)) for name in NUMBERS if defined(solution, name)]
    )


def defined(solution: contact.Solution, name: str) -> bool:
    value = getattr(solution, name)
    known = not solution.scene.law.kappa and not solution.scene.law.intensity(1.0)
    return value is not None and np.isfinite(value).all() and (name != "stiffness" or known)


QUICK = ("zones", "full contact", "one zone", "tilt", "moment", "half width")


@pytest.mark.parametrize(
    "route", [pytest.param(r, marks=[] if r in QUICK else pytest.mark.slow) for r in ROUTES]
)
def test_derivatives_are_those_of_differences_on_every_route(route: str) -> None:
    scene, keys = ROUTES[route]
    solution = contact.solve(scene, TOL)
    by = contact.sensitivity(solution)
    names = [name for name in NUMBERS if defined(solution, name)]
    sizes = np.concatenate([size_of(solution, name) for name in names])
    for to in keys:
        value = abs(np.ravel(by._rates.values[to.partition("[")[0]]))
        unit = value[int(to.partition("[")[2][:-1])] if "[" in to else value[0]
        found = np.concatenate([np.ravel(by.of(name, to).value) for name in names]) * unit
        expected = by_differences(scene, to, numbers_of)
        if "[" in to and np.ravel(by._rates.values[to.partition("[")[0]])[int(to[-2])] < 0:
            expected = -expected
        assert np.abs((found - expected) / sizes).max() < 1e-8, (to, names)


def size_of(solution: contact.Solution, name: str) -> Any:
    """The size relative to which errors of a number count; for ends, the width in contact."""
    value = np.ravel(getattr(solution, name))
    size = (
        np.abs(np.diff(solution.zones)).sum() if name == "zones" else np.abs(value).max(initial=0)
    )
    if name == "mean_gap":
        size = solution.approach or 1.0
    return np.full(len(value), size)


@pytest.mark.parametrize("route", ["zones", "gaps", "full contact", "layer", "sliding", "one zone"])
def test_without_adhesion_no_derivative_depends_on_an_edge_intensity(route: str) -> None:
    """The derivative of a number J(E*, P, K) by the edge intensity K is zero.

    J is homogeneous of a known degree. So without K, E* dJ/dE* + P dJ/dP is the degree times J.
    """
    by = contact.sensitivity(contact.solve(ROUTES[route][0], TOL))
    left, values = by._rates._intensity.values, by.linearized.values
    for name in OF_PRESSURE:
        rest, size = np.asarray(getattr(left, name)), np.asarray(getattr(values, name))
        if np.isfinite(rest).all() and name != "stiffness":
            assert np.abs(rest).max(initial=0) <= 1e-9 * np.abs(size).max(initial=0)
    assert np.abs(left.zones).max(initial=0) <= 1e-9 * np.abs(values.zones).max(initial=1)


@pytest.mark.parametrize(
    "route",
    ["zones", "one zone"]
    + [pytest.param(r, marks=pytest.mark.slow) for r in ("gaps", "layer", "adhesion")],
)
def test_the_stated_error_of_a_derivative_bounds_its_error(route: str) -> None:
    scene, keys = ROUTES[route]
    exact = contact.sensitivity(contact.solve(scene, TOL))
    for tol in (1e-4, 1e-8):
        by = contact.sensitivity(contact.solve(scene, tol))
        for to in keys:
            for name in NUMBERS:
                if defined(exact.solution, name):
                    one, other = by.of(name, to), exact.of(name, to)
                    missed = np.abs(np.asarray(one.value) - other.value)
                    slack = 1e-13 * np.abs(np.asarray(other.value)).max()
                    assert np.all(missed <= np.asarray(one.error) + other.error + slack)


def test_a_response_contains_the_change_of_the_pressure() -> None:
    scene, q = periodic(SERIES, mean_pressure=2e7), 2 * np.pi / 1e-4
    solution = contact.solve(scene, TOL)
    by = contact.sensitivity(solution)
    rise = by.response(lambda x: 1e-7 * np.sin(q * x), lambda x: 1e-7 * q * np.cos(q * x))
    x = np.concatenate([np.linspace(a, b, 9)[2:-2] for a, b in solution.zones])

    def at(step: float) -> Any:
        other = contact.Fourier(1e-4, SERIES.cosine, np.add(SERIES.sine, [1e-7 * step, 0, 0]))
        return contact.solve(replace(scene, profile=other), TOL).pressure(x)

    h = 1e-2
    difference = (8 * (at(h) - at(-h)) - at(2 * h) + at(-2 * h)) / (12 * h)
    assert np.abs(rise.pressure(x) - difference).max() < 1e-7 * solution.max_pressure
    assert np.isclose(rise.of("zone_loads").value.sum(), 0.0, atol=1e-9 * solution.load)


def test_derivatives_by_different_coefficients_differ() -> None:
    by = contact.sensitivity(contact.solve(ROUTES["zones"][0], TOL))
    one, other = (by.of("max_pressure", f"profile.cosine[{k}]").value for k in (0, 1))
    assert abs(one - other) > 1e-2 * abs(one)


def test_at_an_event_and_at_equal_peaks_a_note_says_that_derivatives_are_one_sided() -> None:
    begins = contact.solve(periodic(WAVE, mean_pressure=np.pi * 1e7))
    assert "one-sided" in contact.sensitivity(begins).of("approach", "profile.amplitude").note
    twins = contact.Fourier(1e-4, [0.0, -1e-6])
    by = contact.sensitivity(contact.solve(periodic(twins, mean_pressure=1e7), 1e-11))
    assert "one-sided" in by.of("max_pressure", "profile.cosine[0]").note
    assert by.of("max_pressure", "profile.cosine[1]").note == ""


REFUSED = {
    "localized": Scene(WAVE, 1e9, contact.Localized(), load=500.0),
    "dugdale": periodic(WAVE, law=contact.Dugdale(0.01, 1e7), mean_pressure=1e7),
    "plateaus": periodic(WAVE, law=contact.Plastic(1.5e7), mean_pressure=1e7),
}


@pytest.mark.parametrize("name", REFUSED)
def test_laws_and_models_without_exact_derivatives_are_refused_by_name(name: str) -> None:
    with pytest.raises(contact.SceneError, match=f"{name}|not known"):
        contact.sensitivity(contact.solve(REFUSED[name]))


def test_parameters_that_move_corners_or_change_the_kernel_are_refused_by_name() -> None:
    by = contact.sensitivity(contact.solve(isolated(contact.Flat(1e-3))))
    with pytest.raises(contact.SceneError, match="moves corners"):
        by.of("approach", "profile.width")
    with pytest.raises(contact.SceneError, match="infinite"):
        by.of("max_pressure", "control.load")
    for to in ("profile.length", "substrate.nu", "profile.width[0]"):
        with pytest.raises(contact.SceneError, match="to"):
            by.of("approach", to)
    sliding = contact.sensitivity(contact.solve(ROUTES["sliding"][0]))
    with pytest.raises(contact.SceneError, match="friction"):
        sliding.of("approach", "law.friction")
    assert sliding.of("approach", "control.mean_pressure").value > 0


@pytest.mark.parametrize(
    ("friction", "beta", "to"), [(0.0, 0.2, "law.friction"), (0.3, 0.0, "law.beta")]
)
def test_a_law_parameter_of_zero_that_moves_the_zones_is_refused(
    friction: float, beta: float, to: str
) -> None:
    law = contact.Sliding(friction, beta, 1)
    scene = contact.Scene(contact.Parabola(0.01), 1e9, contact.Isolated(), law=law, load=1e4)
    with pytest.raises(contact.SceneError, match=to):
        contact.sensitivity(contact.solve(scene)).of("zones", to)


def measured(count: int = 48) -> contact.Sampled:
    """A period of a rough surface with random phases, measured at `count` points."""
    rng, x = np.random.default_rng(3), 1e-4 * np.arange(count) / count
    waves = (
        2e-6 / k**1.7 * np.cos(2 * np.pi * k * x / 1e-4 + rng.uniform(0, 6))
        for k in range(1, count // 4)
    )
    return contact.Sampled(x, sum(waves), 1e-4)


ROUGH = measured()
LONE = contact.Sampled(ROUGH.x, ROUGH.heights - 4e-5 * (ROUGH.x / 1e-4 - 0.5) ** 2)
MEASURED = {
    "zones": periodic(ROUGH, contact_fraction=0.3),
    "gaps": periodic(ROUGH, contact_fraction=0.9),
    "full contact": periodic(ROUGH, mean_pressure=8e8),
    "approach": periodic(ROUGH, approach=2e-6),
    "layer": periodic(ROUGH, substrate=contact.Layer(2e-5, 0.3), contact_fraction=0.3),
    "alone": isolated(LONE, load=1e3),
    "moment": isolated(LONE, load=1e3, moment=0.05),
}
FEW = ("zones", "alone", "full contact")


@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
@pytest.mark.parametrize(
    "name", [pytest.param(r, marks=[] if r in FEW else pytest.mark.slow) for r in MEASURED]
)
def test_all_heights_at_once_and_one_at_a_time_have_the_same_derivatives(name: str) -> None:
    """The adjoint equation (all heights at once) against the linear equation for each height."""
    solution = contact.solve(MEASURED[name], 1e-9)
    by = contact.sensitivity(solution)
    for number, index in (
        ("max_pressure", ()),
        ("approach", ()),
        ("stiffness", ()),
        ("mean_gap", ()),
        ("zones", (0, 1)),
        ("zone_loads", (0,)),
    ):
        one = getattr(solution, number)
        if one is None or not np.size(one) or not np.isfinite(one).all():
            continue
        table = by.to_heights(number, index)
        size = np.abs(table.value).max()
        for k in (0, 7, int(np.argmax(np.abs(table.value)))):
            single = by.by(f"profile.height[{k}]").of(number)
            missed = np.abs(np.asarray(single.value)[index] - table.value[k])
            assert missed <= table.error[k] + np.asarray(single.error)[index]
            assert missed <= 1e-9 * size or size <= np.max(table.error)


def test_arrays_of_coefficients_have_the_derivatives_of_their_entries() -> None:
    by = contact.sensitivity(contact.solve(ROUTES["zones"][0], TOL))
    table = by.of("max_pressure", "profile.sine")
    single = [by.of("max_pressure", f"profile.sine[{k}]").value for k in range(3)]
    assert np.allclose(table.value, single, rtol=1e-9)
    adhesive = contact.sensitivity(contact.solve(ROUTES["adhesion"][0]))
    with pytest.raises(contact.SceneError, match="no heights"):
        adhesive.to_heights("max_pressure")


def test_pull_off_of_a_cylinder_has_the_powers_of_its_closed_form() -> None:
    """The pull-off load is P = -3 (pi E* w^2 R / 16)^(1/3) (M. Barquins, J. Adhesion 26, 1988, 1)."""
    scene = Scene(contact.Parabola(1e-3), 1e9, contact.Isolated(), law=contact.JKR(0.05), load=0.0)
    by = contact.sensitivity(contact.solve(scene, 1e-10))
    load = by.solution.pull_off.load
    for to, size, power in (
        ("profile.radius", 1e-3, 1 / 3),
        ("law.work", 0.05, 2 / 3),
        ("material.E_star", 1e9, 1 / 3),
        ("control.load", 1.0, 0.0),
    ):
        found = by.of("pull_off", to)
        assert abs(found.value * size / load - power) <= 1e-9
        assert abs(found.value * size - power * load) <= found.error * size + 1e-12 * abs(load)
    free = contact.sensitivity(contact.solve(replace(scene, law=contact.Frictionless(), load=1.0)))
    with pytest.raises(contact.SceneError, match="pull-off"):
        free.of("pull_off", "profile.radius")


@pytest.mark.slow
def test_pull_off_of_a_texture_has_the_derivatives_of_differences() -> None:
    def scene(factor: float, to: str) -> Scene:
        of = {name: factor if name == to else 1.0 for name in ("wave", "period", "work")}
        wave = contact.Fourier(1e-4 * of["period"], [-1e-6, 2e-7 * of["wave"]], [1e-7, 3e-7])
        law = contact.JKR(0.02 * of["work"])
        return periodic(wave, law=law, mean_pressure=2e7)

    by = contact.sensitivity(contact.solve(scene(1.0, ""), 1e-10))
    for to, key, size in (
        ("wave", "profile.cosine[1]", 2e-7),
        ("period", "profile.period", 1e-4),
        ("work", "law.work", 0.02),
    ):
        total = 0.0
        for k, weight in enumerate((3 / 4, -3 / 20, 1 / 60), 1):
            for sign in (1.0, -1.0):
                other = contact.solve(scene(1 + 2e-3 * sign * k, to), 1e-10)
                total += sign * weight / 2e-3 * other.pull_off.load
        assert np.isclose(by.of("pull_off", key).value * size, total, rtol=1e-7)


@pytest.mark.parametrize("criterion", ["mises", "tresca"])
def test_the_load_of_first_yield_of_a_cylinder_has_the_powers_of_its_closed_form(
    criterion: str,
) -> None:
    """The load of first yield is proportional to Y^2 R / E*, with the strength Y.

    The largest stress is proportional to the largest pressure p_0 = sqrt(P E* / (pi R)).
    """
    scene = isolated(contact.Parabola(2.0), load=1e3)
    found = contact.solve(scene).first_yield(1e6, 0.3, criterion, tol=1e-12)
    by = contact.sensitivity(found)
    for to, size, power in (
        ("profile.radius", 2.0, 1.0),
        ("material.E_star", 1e9, -1.0),
        ("strength", 1e6, 2.0),
        ("control.load", found.load, 0.0),
    ):
        one, stress = by.of("first_yield", to), by.of("max_stress", to)
        assert abs(one.value * size / found.load - power) <= 1e-9
        assert abs(one.value * size - power * found.load) <= one.error * size + 1e-12 * found.load
        of_load = {"control.load": 0.5, "strength": 0.0}.get(to, -0.5 * power)
        assert np.isclose(stress.value * size / 1e6, of_load, rtol=1e-9)


LIKE = contact.Sliding(0.2)
STRESSED: dict[str, tuple[Scene, str, str, tuple[str, ...]]] = {
    "zones": (*ROUTES["zones"][:1], "mises", "free", ("profile.cosine[0]", "profile.period")),
    "fraction": (*ROUTES["zones at a fraction"][:1], "tresca", "confined", ("profile.sine[1]",)),
    "gaps": (*ROUTES["gaps"][:1], "mises", "as loaded", ("profile.cosine[1]", "profile.period")),
    "full contact": (
        *ROUTES["full contact"][:1],
        "tresca",
        "free",
        ("profile.cosine[1]", "profile.period"),
    ),
    "one zone": (*ROUTES["one zone"][:1], "mises", "as loaded", ("profile.spacing",)),
    "exponent": (*ROUTES["exponent"][:1], "mises", "as loaded", ("profile.exponent",)),
    "sliding": (
        periodic(SERIES, law=LIKE, mean_pressure=2e7),
        "mises",
        "as loaded",
        ("profile.sine[0]", "law.friction", "profile.period"),
    ),
    # In this scene the largest stress is on the surface.
    "unlike": (*ROUTES["sliding"][:1], "tresca", "as loaded", ("profile.sine[0]",)),
}


def largest_stress(solution: contact.Solution, criterion: str, lateral: str) -> float:
    return float(LargestStress(solution, Criterion(criterion, 0.3, lateral)).values.max())


@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(n, marks=[] if n in ("full contact", "one zone") else pytest.mark.slow)
        for n in STRESSED
    ],
)
def test_the_largest_stress_has_the_derivatives_of_differences(name: str) -> None:
    scene, criterion, lateral, keys = STRESSED[name]
    solution = contact.solve(scene, TOL)
    by = contact.sensitivity(solution, 0.3, criterion, lateral)
    size = largest_stress(solution, criterion, lateral)
    for to in keys:
        table = np.ravel(by._rates.values[to.partition("[")[0]])
        unit = table[int(to[-2])] if "[" in to else table[0]
        expected = by_differences(scene, to, lambda one: largest_stress(one, criterion, lateral))
        found = by.of("max_stress", to)
        assert abs(found.value * unit - expected) <= 1e-8 * size
        for tol in (1e-4, 1e-7):
            rough = contact.sensitivity(contact.solve(scene, tol), 0.3, criterion, lateral)
            one = rough.of("max_stress", to)
            assert abs(one.value - found.value) <= one.error + found.error


@pytest.mark.slow
def test_the_load_of_first_yield_has_the_derivatives_of_differences() -> None:
    scene, to = ROUTES["zones"][0], "profile.sine[1]"

    def load(other: Scene, nu: float) -> float:
        return contact.solve(other).first_yield(1e7, nu, lateral="free", tol=TOL).load

    found = contact.solve(scene).first_yield(1e7, 0.3, lateral="free", tol=TOL)
    by, step = contact.sensitivity(found), 2e-3
    pairs = [(k, changed(scene, to, 1 + k * step)) for k in (-2, -1, 1, 2)]
    weights = {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}
    expected = sum(weights[k] * load(one, 0.3) for k, one in pairs) / step
    assert np.isclose(by.of("first_yield", to).value * 3e-7, expected, rtol=1e-7)
    expected = sum(w * load(scene, 0.3 + k * step) for k, w in weights.items()) / step
    assert np.isclose(by.of("first_yield", "nu").value, expected, rtol=1e-7)


STRESSED_HEIGHTS = {
    "inside": (MEASURED["alone"], 0.3),
    "on the surface": (MEASURED["moment"], 0.0),
    "gaps": (MEASURED["gaps"], 0.3),
    "full contact": (replace(MEASURED["full contact"], law=LIKE), 0.3),
    "sliding": (replace(MEASURED["zones"], law=LIKE), 0.3),
}


@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(n, marks=[] if n in ("inside", "full contact") else pytest.mark.slow)
        for n in STRESSED_HEIGHTS
    ],
)
def test_all_heights_at_once_have_the_derivatives_of_first_yield(name: str) -> None:
    scene, nu = STRESSED_HEIGHTS[name]
    by = contact.sensitivity(contact.solve(scene, 1e-9), nu, "mises" if nu else "tresca")
    for number in ("max_stress", "first_yield"):
        table = by.to_heights(number)
        size = np.abs(table.value).max()
        for k in (7, int(np.argmax(np.abs(table.value)))):
            single = by.by(f"profile.height[{k}]").of(number)
            assert abs(single.value - table.value[k]) <= min(
                table.error[k] + single.error, 1e-9 * size
            )


def test_stresses_without_derivatives_are_refused_by_name() -> None:
    hertz = contact.solve(isolated(contact.Parabola(1.0)))
    with pytest.raises(contact.SceneError, match="criterion"):
        contact.sensitivity(hertz).of("first_yield", "profile.radius")
    adhesive = isolated(contact.Parabola(1.0), law=contact.JKR(0.01), load=1.0)
    for scene in (isolated(contact.Wedge(0.1)), adhesive):
        with pytest.raises(contact.SceneError, match="infinite"):
            contact.sensitivity(contact.solve(scene), 0.3)
    none = contact.solve(isolated(contact.Flat(1e-3))).first_yield(1e6, 0.3)
    with pytest.raises(contact.SceneError, match="sharp corner"):
        contact.sensitivity(none)
    pulled = contact.solve(periodic(SERIES, law=contact.Sliding(0.4), mean_pressure=2e7))
    with pytest.raises(contact.SceneError, match="end x"):
        contact.sensitivity(pulled, 0.3, lateral="free").of("max_stress", "profile.period")


def test_derivatives_at_places_that_yield_together_are_noted_as_one_sided() -> None:
    twins = contact.Fourier(1e-4, [0.0, -1e-6])
    by = contact.sensitivity(contact.solve(periodic(twins, mean_pressure=1e7), 1e-11), 0.3)
    for number in ("max_stress", "first_yield"):
        assert "one-sided" in by.of(number, "profile.cosine[0]").note
        assert by.of(number, "profile.cosine[1]").note == ""


@dataclass(frozen=True, eq=False)
class NarrowBumps(contact.Profile):
    """Gaussian bumps 1e-4 apart, with given heights and one width."""

    heights: Any
    width: float

    def height(self, x: Any) -> Any:
        return -np.tensordot(self.heights, np.exp(-0.5 * self._away(x) ** 2), 1)

    def slope(self, x: Any) -> Any:
        away = self._away(x)
        return -np.tensordot(self.heights, away * np.exp(-0.5 * away**2), 1) / self.width

    def _away(self, x: Any) -> Any:
        return np.subtract.outer(1e-4 * np.arange(-1, 2), np.asarray(x)) / self.width


@pytest.mark.parametrize("width", [2e-6, 2e-7])
def test_bumps_that_are_narrow_and_far_apart_have_derivatives(width: float) -> None:
    """Derivatives with respect to three heights by one adjoint solve agree with those by one linear
    solve for each height. The linear solves need no fields far from a zone.
    """
    shape = NarrowBumps(0.05 * width * np.array([1.0, 1.02, 1.01]), width)
    scene = isolated(shape, load=3e5 * width)
    by = contact.sensitivity(contact.solve(scene, 1e-10))
    assert len(by.solution.zones) == 3
    for number in ("max_pressure", "approach", "stiffness"):
        table = by.of(number, "profile.heights")
        single = np.array([by.of(number, f"profile.heights[{k}]").value for k in range(3)])
        assert np.abs(table.value - single).max() <= 1e-9 * np.abs(single).max()
