"""Solutions at many values of one control: as exact as single solves, with few searches."""

import dataclasses

import numpy as np
import pytest

import contact
import contact.search.context
import contact.search.grid.nested_grids
import contact.search.strategies.guesses
from contact.search import refine
from contact.search.topology.extrapolation import CurvePoint, extrapolated
from contact.search.topology.pressure_form import PressureForm
from contact.studies.trace_kinds import drawn
from contact.verify.certificate import certify

ROUGH = contact.Fourier(1.0, [-0.01, 0.004, 0.002], [0.003, -0.002, 0.004])
# Under growing loads, zones of this profile appear and merge again and again.
TRACE = contact.Sampled(
    np.arange(96) / 96, 1e-3 * np.random.default_rng(5).normal(size=96), period=1.0
)
BUMPY = contact.Fourier(1.0, [-0.01, 0, 0, 0, 0, 0, -0.0004], [0.002, 0, 0, 0, 0, 0, 0])


def scene(profile, interaction=None, **control):
    return contact.Scene(
        profile, 1.0, interaction or contact.Periodic(), **control or {"load": 1.0}
    )


def full_load(profile):
    return contact.solve(scene(profile, contact_fraction=1.0)).load


@pytest.fixture
def counted(monkeypatch):
    """The numbers of grid searches and of computed limits of full contact, in a dict."""
    count = {"grids": 0, "limits": 0}

    def counting(module, name, what):
        real = getattr(module, name)

        def call(*arguments, **options):
            count[what] += 1
            return real(*arguments, **options)

        monkeypatch.setattr(module, name, call)

    counting(contact.search.strategies.guesses, "from_grid", "grids")
    counting(contact.search.context, "FullLimit", "limits")
    return count


@pytest.mark.parametrize(
    ("here", "values"),
    [
        (scene(ROUGH), full_load(ROUGH) * np.array([0.7, 0.05, 1.2, 0.3, 0.31, 0.95])),
        (scene(ROUGH, contact_fraction=0.5), [0.2, 0.9, 0.5, 1.0]),
        (scene(contact.Sinusoid(1e-2, 1.0), approach=0.01), [0.004, 0.008, 0.0079]),
        (scene(contact.Biquadratic(1.0, 0.2), contact.Isolated()), [1e-4, 1e-2, 3e-3]),
        (scene(contact.Wedge(0.1, 1.0), mean_pressure=0.01), [0.03, 0.01]),
        (scene(contact.Sinusoid(1e-2, 1.0), contact.Localized()), [2e-3, 1e-3, 1.1e-3]),
        (scene(contact.Flat(0.5, 1.0)), [2e-3, 1e-3]),
    ],
    ids=["rough", "fraction", "approach", "two zones", "wedge", "localized", "punch"],
)
def test_each_solution_of_a_curve_is_that_of_a_single_solve(here, values):
    name = here.control[0]
    for value, one in zip(values, contact.solve_many(here, values), strict=True):
        control = {name: value}
        other = contact.solve(scene(here.profile, here.interaction, **control))
        assert one.scene.control == (name, value)
        assert one.certificate.holds and one.error <= 1e-8
        assert one.zones.shape == other.zones.shape
        width = np.diff(other.zones, axis=1)
        assert np.all(np.abs(one.zones - other.zones) <= (one.error + other.error) * width + 1e-15)


class TestProcesses:
    def test_solutions_of_several_processes_are_those_of_one(self):
        loads = full_load(ROUGH) * np.array([0.4, 0.05, 1.2, 0.3, 0.31, 0.4])
        steps = []
        found = contact.solve_many(
            scene(ROUGH),
            loads,
            workers=2,
            progress=lambda stage, done, total: steps.append((done, total)),
        )
        assert steps[-1] == (6, 6)
        for load, one, other in zip(
            loads, found, contact.solve_many(scene(ROUGH), loads), strict=True
        ):
            assert (
                one.load == pytest.approx(load, rel=1e-12)
                and one.scene.load == load
                and one.certificate.holds
                and one.error <= 1e-8
            )
            np.testing.assert_allclose(one.zones, other.zones, rtol=0, atol=2e-8)

    def test_values_that_no_contact_has_are_refused_as_in_one_process(self):
        lone = scene(contact.Sinusoid(1e-2, 1.0), contact.Isolated())
        for workers in (1, 2):
            with pytest.raises(contact.OutOfRange, match="border|beyond the largest"):
                contact.solve_many(lone, [1e-3, 1.1e-3, 1.0, 1.1], workers=workers)

    def test_no_process_is_started_for_scenes_in_closed_form(self, monkeypatch):
        monkeypatch.setattr("contact.sweeps.solve_many.solved_in_processes", None)
        found = contact.solve_many(
            scene(contact.Sinusoid(1e-2, 1.0)), [1e-3, 2e-3, 3e-3, 4e-3], workers=2
        )
        assert [solution.scene.load for solution in found] == [1e-3, 2e-3, 3e-3, 4e-3]

    def test_a_scene_that_cannot_be_sent_is_solved_here(self):
        class Own(contact.Fourier):
            """A class that other processes cannot import, since it is local."""

        loads = full_load(ROUGH) * np.array([0.2, 0.3, 0.4, 0.5])
        own = scene(Own(1.0, ROUGH.cosine, ROUGH.sine))
        with pytest.warns(RuntimeWarning, match="cannot be sent the scene"):
            found = contact.solve_many(own, loads, workers=2)
        assert [solution.scene.load for solution in found] == list(loads)

    def test_zero_workers_are_refused(self):
        with pytest.raises(contact.SceneError, match="workers"):
            contact.solve_many(scene(ROUGH), [1e-3], workers=0)


def test_a_curve_searches_one_grid_and_looks_for_full_contact_once(counted):
    loads = np.linspace(0.02, 0.6, 25) * 0.03
    contact.solve_many(scene(ROUGH), loads, "load")
    assert counted == {"grids": 1, "limits": 1}


def test_zones_that_come_and_go_at_close_loads_cost_little_more_than_searches_from_scratch(
    newton_steps,
):
    random, k = np.random.default_rng(3), np.arange(1, 25)
    profile = contact.Fourier(1.0, *(1e-3 * k**-1.3 * random.normal(size=24) for _ in range(2)))
    loads = full_load(profile) * 0.3 * 1.06 ** -np.arange(12.0, 18.0)
    together, along = newton_steps(lambda: contact.solve_many(scene(profile), loads))
    assert [len(one.zones) for one in along] == [4, 3, 3, 3, 3, 2]
    alone, _ = newton_steps(lambda: [contact.solve(scene(profile, load=load)) for load in loads])
    assert together < 1.5 * alone


def test_points_close_together_take_about_two_steps_of_newton():
    loads = np.linspace(0.2, 0.25, 21) * full_load(ROUGH)
    steps = [len(solution.trace) for solution in contact.solve_many(scene(ROUGH), loads)]
    assert np.mean(steps[4:]) <= 2.3


@pytest.mark.parametrize(
    ("values", "control"), [([], None), ([np.nan], None), ([0.0], "load"), ([1.0], "weight")]
)
def test_invalid_values_and_controls_are_refused_by_name(values, control):
    with pytest.raises(contact.SceneError, match="values|load|control"):
        contact.solve_many(scene(ROUGH), values, control)


def test_the_certificate_sees_a_second_touch_right_beside_an_end_that_is_about_to_move_far():
    """The surfaces overlap just outside the left end, so the certificate must not hold."""
    load = 0.0010874649540675919
    problem = contact.solve(scene(BUMPY, load=load)).fields.problem
    fields = PressureForm(problem).formal(
        load / problem.units.load, np.array([[-0.0842, 0.0234]]), 1e-10
    )
    beside = fields.density.zones.a[0] - np.linspace(0, 0.01, 101)
    assert fields.formal_gap(beside).min() < -1e-8
    assert not certify(fields, load / problem.units.load).holds


def passed(profile, *loads):
    """The solutions under the loads, as the points from which zones are extrapolated."""
    return tuple(CurvePoint(contact.solve(scene(profile, load=load), tol=1e-10)) for load in loads)


@pytest.mark.parametrize(("known", "order"), [(1, 2), (2, 4)])
def test_extrapolated_ends_have_the_order_of_the_known_values_and_rates(known, order):
    """Half the step in the logarithm of the load divides the error of the ends by 2^order.
    No zone appears and no zones merge at these loads.
    """
    profile, load = contact.Fourier(1.0, [0.0, 0.0, -0.01], [0.001, 0.002, 0.0]), 0.012
    missed = []
    for step in (0.08, 0.04):
        last = passed(profile, *(load * np.exp(-k * step) for k in range(known, 0, -1)))
        there = contact.solve(scene(profile, load=load), tol=1e-10)
        zones, changes = extrapolated(last, float(np.log(load)))
        assert len(there.zones) == 3 and changes == 0
        missed.append(np.abs(last[-1].problem.units.x(zones) - there.zones).max())
    assert missed[0] / missed[1] > 0.7 * 2**order


def test_extrapolation_finds_births_of_zones_and_gaps_that_close():
    """A wave with a lower crest between its main crests.
    The zone of the lower crest appears at the load of the birth. Later it merges with the other
    zone.
    """
    profile = contact.Fourier(1.0, [0.004, -0.01], [0.003, 0.0])
    events = contact.path(scene(profile), [1e-3, 0.9999 * full_load(profile)]).events
    assert [event.kind for event in events] == ["birth", "merge"]
    for event in events:
        before = passed(profile, 0.98 * event.load)
        assert (
            extrapolated(before, float(np.log(0.99 * event.load)))[1]
            == 0
            < extrapolated(before, float(np.log(1.01 * event.load)))[1]
        )
    birth = events[0]
    zones, _ = extrapolated(passed(profile, 0.98 * birth.load), float(np.log(1.01 * birth.load)))
    # The position of an event lies in the cell of the period; extrapolated zones may lie in the
    # next cell.
    middles = zones.mean(axis=1)
    away = np.abs(birth.position - middles - np.round(birth.position - middles))
    assert len(zones) == 2 and np.any(away < 0.5 * np.diff(zones, axis=1)[:, 0])


@pytest.mark.slow
@pytest.mark.parametrize("count", [4, 10])
def test_a_curve_of_many_zones_is_the_same_whatever_the_spacing_of_its_loads(count):
    full = full_load(TRACE)
    found = contact.solve_many(scene(TRACE), np.geomspace(2e-3, 0.6, count) * full)
    for one in found[-1], found[(count - 1) // 3]:
        other = contact.solve(one.scene)
        assert one.certificate.holds and one.zones.shape == other.zones.shape
        width = np.diff(other.zones, axis=1)
        assert np.all(np.abs(one.zones - other.zones) <= (one.error + other.error) * width + 1e-15)


@pytest.mark.slow
def test_a_curve_takes_half_the_grid_points_and_1_5_times_the_newton_steps_of_single_solves_at_most(
    monkeypatch, newton_steps
):
    points, grid = [0], contact.search.grid.nested_grids.solve_grid

    def gridded(f, *arguments, **options):
        points[0] += len(f)
        return grid(f, *arguments, **options)

    monkeypatch.setattr(contact.search.grid.nested_grids, "solve_grid", gridded)
    loads = np.geomspace(0.02, 0.04, 6) * full_load(TRACE)
    points[0] = 0
    together, _ = newton_steps(lambda: contact.solve_many(scene(TRACE), loads))
    points_together, points[0] = points[0], 0
    alone, _ = newton_steps(lambda: [contact.solve(scene(TRACE, load=load)) for load in loads])
    assert points_together < 0.5 * points[0] and together < 1.5 * alone


@pytest.mark.slow
def test_a_few_loads_far_apart_take_no_more_than_twice_the_solutions_of_searches_from_scratch(
    newton_steps,
):
    """Zones extrapolated over a long step are replaced by those of a grid, if the grid is fast."""
    profile = drawn(np.random.default_rng(3), "honed", 300)
    loads = np.geomspace(1e-3, 0.7, 12) * full_load(profile)
    together, _ = newton_steps(lambda: contact.solve_many(scene(profile), loads))
    alone, _ = newton_steps(lambda: [contact.solve(scene(profile, load=load)) for load in loads])
    assert together < 2 * alone


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "fractions"),
    [(600, np.linspace(0.02, 0.6, 20)[5:8]), (300, np.linspace(0.1, 0.6, 8)[3:6])],
)
def test_narrow_gaps_that_become_slits_of_wide_zones_or_cease_to_be_do_not_stop_a_curve(
    points, fractions
):
    profile = drawn(np.random.default_rng(5), "steps", points)
    for one in contact.solve_many(
        contact.Scene(profile, 2.3e11, contact.Periodic(), contact_fraction=0.1), fractions
    ):
        assert one.certificate.holds and one.error <= 1e-8


@pytest.mark.parametrize("near", [False, True], ids=["along a curve", "near"])
def test_an_inexact_solution_from_a_nearby_one_is_replaced_by_one_from_scratch(near, monkeypatch):
    """The first refinement is made to state the error 1e-6, so that a new search must follow."""
    real = refine._refined_once

    def off(context, found, again):
        outcome = real(context, found, again)
        return (
            dataclasses.replace(outcome, control_error=1e-6)
            if context.previous or context.warm_start
            else outcome
        )

    monkeypatch.setattr(refine, "_refined_once", off)
    loads = full_load(ROUGH) * np.array([0.2, 0.25])
    if near:
        first = contact.solve(scene(ROUGH, load=loads[0]))
        found = contact.solve(scene(ROUGH, load=loads[1]), near=first)
    else:
        found = contact.solve_many(scene(ROUGH), loads)[1]
    assert found.error <= 1e-8
    assert found.contact_fraction == pytest.approx(
        contact.solve(scene(ROUGH, load=loads[1])).contact_fraction, rel=1e-8
    )


def test_a_solution_that_is_inexact_from_scratch_too_is_refused_with_its_best_state(monkeypatch):
    """Both refinements, with and without the nearby solution, are made to state the error 1e-6."""
    full, real = full_load(ROUGH), refine._refined_once
    first = contact.solve(scene(ROUGH, load=0.2 * full))
    monkeypatch.setattr(
        refine,
        "_refined_once",
        lambda *given: dataclasses.replace(real(*given), control_error=1e-6),
    )
    with pytest.raises(contact.NotConverged) as refused:
        contact.solve(scene(ROUGH, load=0.25 * full), near=first)
    assert refused.value.best.error > 1e-8
