"""Solutions at a contact fraction or approach, found by a bracket on the load.

They take few solutions at other loads, also near births and mergers of zones.
"""

import numpy as np
import pytest

import contact
import sie
from contact import solver
from contact.search.grid.scaling import scaled_scene
from contact.search.strategies.load_search import KnownLoads, approach, contact_fraction, nearer
from contact.search.topology.loop import NewtonSettings, refine_topology
from contact.search.topology.pressure_form import PressureForm
from tests.tiers import quick

TIPS = contact.Fourier(1e-4, [-1e-6, -0.3e-6, 0.2e-6], [0.1e-6, 0.25e-6, 0.0])


def scene(profile, **control):
    return contact.Scene(profile, 1e11, contact.Periodic(), **control)


def honed(points, seed=3):
    """A plateau of fine roughness cut by grooves: a little more load gives much more contact.

    The positions deviate from even ones by up to 0.4 of the pitch.
    """
    rng = np.random.default_rng(seed)
    k = np.arange(1, points // 4)
    at = np.arange(points) + rng.uniform(-0.4, 0.4, points)
    height = np.sum(
        k**-1.3 * np.cos(2 * np.pi * np.outer(at / points, k) + rng.uniform(0, 2 * np.pi, len(k))),
        axis=1,
    )
    height *= 0.05 / height.std()
    for centre, depth in zip(rng.uniform(0, points, 6), rng.uniform(1, 5, 6), strict=True):
        away = np.abs((at - centre + 0.5 * points) % points - 0.5 * points)
        height -= depth * np.maximum(1 - away / 12, 0.0)
    return contact.Sampled(at * 1e-6, 1e-7 * height, period=points * 1e-6)


@pytest.fixture
def loads(monkeypatch):
    """List of the loads that the solver solves on the way to a solution, in their order."""
    asked = []
    plain = solver._solved

    def noted(scene, *rest):
        if scene.load is not None:
            asked.append(scene.load)
        return plain(scene, *rest)

    monkeypatch.setattr(solver, "_solved", noted)
    return asked


@pytest.mark.parametrize("fraction", [0.02, 0.3, 0.6, 0.9, 0.98])
def test_a_contact_fraction_of_a_rough_trace_takes_few_loads(loads, fraction):
    solution = contact.solve(scene(honed(120), contact_fraction=fraction))
    assert solution.contact_fraction == pytest.approx(fraction, rel=1e-9)
    assert solution.certificate.holds and len(loads) <= 5
    again = contact.solve(scene(honed(120), load=solution.load))
    assert again.contact_fraction == pytest.approx(fraction, rel=1e-6)


def test_a_contact_fraction_near_a_solution_needs_no_grid(loads, monkeypatch):
    first = contact.solve(
        scene(
            honed(120),
            mean_pressure=contact.solve(scene(honed(120), contact_fraction=0.3)).mean_pressure,
        )
    )
    loads.clear()
    monkeypatch.setattr(
        "contact.search.strategies.guesses.proposed", lambda *_: pytest.fail("a grid")
    )
    beside = contact.solve(scene(honed(120), contact_fraction=0.305), near=first)
    assert beside.contact_fraction == pytest.approx(0.305, rel=1e-9) and len(loads) <= 2


def birth():
    full = contact.solve(scene(TIPS, contact_fraction=1.0)).load
    events = contact.path(scene(TIPS, load=full), np.array([0.05, 0.3]) * full).events
    return next(event for event in events if event.kind == "birth")


def test_a_zone_that_was_just_born_is_found_under_its_load():
    event = birth()
    with pytest.raises(contact.NotConverged, match="rounding") as failure:
        contact.solve(scene(TIPS, load=event.load * (1 + 1e-9)))
    best = failure.value.best
    assert len(best.zones) == 2 and best.certificate.holds
    # The new zone is a shallow cap. Its load is about 1e-9 of the whole load, and its relative
    # width is about the square root of that.
    assert 1e-7 < best.zone_widths.min() / best.zone_widths.max() < 1e-4


@pytest.mark.parametrize("off", quick([0.0, 1e-15, -1e-15, -1e-12], [0.0, -1e-12]))
def test_right_at_a_birth_there_is_one_number_of_zones_to_any_tolerance(off):
    load = birth().load * (1 + off)
    for tol in (1e-6, 1e-10):
        solution = contact.solve(scene(TIPS, load=load), tol)
        assert len(solution.zones) == 1 and solution.certificate.holds


def test_the_contact_fraction_of_a_birth_and_of_a_merger_are_found():
    full = contact.solve(scene(TIPS, contact_fraction=1.0)).load
    events = contact.path(scene(TIPS, load=full), np.linspace(0.05, 0.9, 6) * full).events
    assert {"birth", "merge"} <= {event.kind for event in events}
    for event in events:
        fraction = contact.solve(scene(TIPS, load=event.load)).contact_fraction
        solution = contact.solve(scene(TIPS, contact_fraction=fraction))
        assert solution.load == pytest.approx(event.load, rel=1e-9)


class Made:
    """A stand-in for a solution, whose contact fraction and approach are functions of the load."""

    def __init__(self, load, value, slope):
        self.load, self.contact_fraction, self.fields = (
            load,
            value,
            type("F", (), {"widening_rate": slope}),
        )
        self.approach, self.stiffness = value, 1 / slope


@pytest.mark.parametrize("goal", [1e-5, 0.2, 0.4999999, 0.5000001, 0.9, 0.999])
@pytest.mark.parametrize("grown", [approach, contact_fraction])
def test_a_square_root_in_the_growth_is_bracketed_in_few_solutions(goal, grown):
    """The value has an infinite rate at a load, as at births and mergers."""

    def solved(load, near):
        root = np.sqrt(abs(load - 0.25))
        value = 0.5 + np.sign(load - 0.25) * root
        return Made(load, value, 0.5 / root if root else np.inf)

    found = []
    for here, off in nearer(solved, grown, goal, 0.1, KnownLoads(closed=1e-14)):
        found.append(here)
        if off < 1e-12:
            break
    assert here.contact_fraction == pytest.approx(goal, abs=1e-6) and len(found) <= 60


def test_a_load_without_a_solution_is_skipped():
    def solved(load, near):
        if 0.191 < load < 0.1925 and near is not None:
            raise contact.NotConverged("not here", (), None)
        return Made(load, load**0.5, 0.5 * load**-0.5)

    *_, (here, off) = nearer(solved, contact_fraction, 0.44, 0.3, KnownLoads(closed=1e-12))
    assert here.contact_fraction == pytest.approx(0.44) and off < 1e-6


@pytest.mark.parametrize("gap", [1e-3, 1e-8])
def test_a_gap_that_must_close_is_closed_in_few_steps_at_any_initial_width(gap, monkeypatch):
    steps, plain = [], sie.find_ends

    def counted(*args, **named):
        found = plain(*args, **named)
        steps.append(len(found.trace))
        return found

    monkeypatch.setattr(sie, "find_ends", counted)
    wave = scaled_scene(scene(contact.Sinusoid(1e-6, 1.0), mean_pressure=1e5), False)
    alone = refine_topology(
        PressureForm(wave.problem), wave.control, np.array([[-0.3, 0.3]]), NewtonSettings(1e-9)
    )
    steps.clear()
    (a, b), off = alone.free.density.zones.table[0], 0.02
    found = refine_topology(
        PressureForm(wave.problem),
        wave.control,
        np.array([[a - off, -gap], [gap, b + off]]),
        NewtonSettings(1e-9),
    )
    assert len(found.free.density.zones) == 1 and sum(steps) <= 6


def test_a_contact_fraction_of_a_rough_trace_takes_no_solution_under_another_load(monkeypatch):
    rng = np.random.default_rng(11)
    trace = contact.Sampled(np.arange(400.0), 0.05 * rng.normal(size=400), period=400.0)

    def refused(*_):
        raise AssertionError("a load on the way was solved")

    monkeypatch.setattr("contact.search.strategies.load_controls._solver_of_loads", refused)
    solution = contact.solve(
        contact.Scene(trace, 1.0, contact.Periodic(), contact_fraction=0.3), tol=1e-6
    )
    assert solution.contact_fraction == pytest.approx(0.3, abs=1e-6)
    assert solution.certificate.holds
