"""The solutions of all routes have the same fields, which obey the same laws."""

from dataclasses import replace

import numpy as np
import pytest

import contact
from contact.model.laws.base import Equilibria, PressureRange, Routes
from contact.search.find import found

E = 1e9
WAVE = contact.Sinusoid(1e-6, 1e-4)
ROUGH = contact.self_affine(
    hurst=0.8, period=1e-4, shortest=1e-5, rolloff=5e-5, rms_slope=0.05, seed=3
)


def _periodic(profile=WAVE, **more):
    return contact.Scene(profile, E, contact.Periodic(), **more)


SCENES = {
    "closed form": _periodic(mean_pressure=1e7),
    "zones": _periodic(ROUGH, mean_pressure=2e6),
    "gaps": _periodic(ROUGH, contact_fraction=0.95),
    "full contact": _periodic(mean_pressure=4e7),
    "full contact on a base": _periodic(substrate=contact.Layer(2e-5, 0.3), mean_pressure=8e7),
    "edge intensity": _periodic(law=contact.JKR(1e-2), mean_pressure=1e6),
    "cohesive zone": _periodic(law=contact.Dugdale(1e-2, 2e6), mean_pressure=1e6),
    "one zone on a line": contact.Scene(
        contact.Parabola(1e-3), E, contact.Isolated(datum=1e-3), load=1.0
    ),
    "strip": contact.Scene(
        WAVE, E, contact.Localized(closure="self-consistent"), mean_pressure=1e6
    ),
}


@pytest.fixture(scope="module", params=SCENES)
def solution(request):
    return contact.solve(SCENES[request.param])


def test_the_loads_of_the_zones_and_the_integral_of_the_pressure_are_the_load(solution):
    fields, zones = solution.fields, solution.fields.zone_table
    outside = np.sum(np.diff(fields.cohesive)) - np.sum(np.diff(zones)) if len(zones) else 0.0
    pull = getattr(solution.scene.law, "tension", 0.0) * (outside if len(fields.cohesive) else 0.0)
    if len(zones):
        assert fields.loads.sum() - pull == pytest.approx(solution.load, rel=1e-9)
        s, weight = np.polynomial.legendre.leggauss(200)
        # With t = sin(pi s / 2), square roots at the ends of a zone are smooth in s.
        t, weight = np.sin(0.5 * np.pi * s), 0.5 * np.pi * np.cos(0.5 * np.pi * s) * weight
        half = 0.5 * np.diff(zones)[:, 0]
        borne = [h * weight @ fields.pressure_at(k, t) for k, h in enumerate(half)]
        assert borne == pytest.approx(fields.loads, rel=1e-4)
    else:
        x = solution.scene.period * (np.arange(256) + 0.5) / 256
        mean = float(fields.pressure(x).mean())
        assert mean * solution.scene.period == pytest.approx(solution.load, rel=1e-9)


def test_the_gap_is_height_plus_displacement_minus_approach(solution):
    fields, profile = solution.fields, solution.scene.profile
    zones = fields.zone_table
    lo, hi = (zones[0, 0], zones[-1, 1]) if len(zones) else (0.0, solution.scene.period)
    x = np.linspace(lo - 0.2 * (hi - lo), hi + 0.2 * (hi - lo), 41)
    height = profile.height(x) - solution.fields.problem.lowest
    expected = height + fields.displacement(x) - (fields.approach or 0.0)
    scale = np.ptp(height) + abs(fields.approach or 0.0)
    assert fields.gap(x) == pytest.approx(expected, abs=1e-7 * scale)


def test_levels_are_minus_the_approach_and_agree(solution):
    """The level of a zone is -(u + f) on it, so all levels are minus the approach."""
    fields, unit = solution.fields, solution.fields.problem.units.height
    if fields.approach is None:
        return
    assert -fields.levels * unit == pytest.approx(
        np.full(len(fields.levels), fields.approach),
        abs=(1e-9 + 100 * fields.gap_rounding) * unit + 1e-9 * abs(fields.approach),
    )


def test_stiffness_is_the_slope_of_the_load_over_the_approach(solution):
    scene, stiffness = solution.scene, solution.fields.stiffness
    if stiffness is None or not np.isfinite(stiffness):
        return
    name, value = scene.control
    if name == "contact_fraction":
        name, value = "load", solution.load
    low, high = (contact.solve(scene.under(name, value * (1 + s)), 1e-10) for s in (-1e-4, 1e-4))
    slope = (high.load - low.load) / (high.approach - low.approach)
    assert slope == pytest.approx(stiffness, rel=1e-4)


def test_laws_declare_pressure_range_equilibria_and_routes():
    plain, adhesive = contact.Frictionless(), contact.JKR(0.1)
    assert plain.pressure_range == PressureRange(0.0) and adhesive.pressure_range.has_tension
    assert plain.equilibria == Equilibria(True) and adhesive.equilibria.start == plain
    assert plain.routes == Routes(True, True) and adhesive.routes == Routes(False, False)


def test_a_law_may_name_the_module_that_solves_its_scenes(monkeypatch):
    class Own(contact.Law):
        name, convex = "own", True
        routes = Routes(False, False, module="contact.testing")

    scene = _periodic(law=Own(), mean_pressure=1e7)
    asked = []
    monkeypatch.setattr(contact.testing, "found", asked.append, raising=False)
    with pytest.raises(AttributeError):
        contact.solve(scene)
    assert [task.scene for task in asked] == [scene]


def test_the_result_of_the_module_of_a_law_is_not_refined(monkeypatch):
    class Own(contact.Frictionless):
        name = "own"
        routes = Routes(False, False, module="contact.testing")

    def loosely(context):
        return found(replace(context, tolerance=1e-4))

    monkeypatch.setattr(contact.testing, "found", loosely, raising=False)
    rough = contact.Fourier(1e-4, [-1e-7, 4e-8], [3e-8, -2e-8])
    scene = _periodic(rough, law=Own(), mean_pressure=1e6)
    with pytest.raises(contact.NotConverged, match="above the tolerance") as failed:
        contact.solve(scene, tol=1e-10)
    best = failed.value.best
    assert np.array_equal(contact.solve(scene, tol=2 * best.error).zones, best.zones)
    assert contact.solve(replace(scene, law=contact.Frictionless()), tol=1e-10).error <= 1e-10
