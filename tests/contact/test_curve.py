"""Curves of one control: the answers of single solves, at the price of few searches."""

import numpy as np
import pytest

import contact
import contact.search.shared
import contact.search.ways.guesses
from contact.search.topology.by_pressure import ByPressure
from contact.verify.certificate import certify

ROUGH = contact.Fourier(1.0, [-0.01, 0.004, 0.002], [0.003, -0.002, 0.004])
# Under growing loads its one zone becomes two, and one again, time and again.
BUMPY = contact.Fourier(1.0, [-0.01, 0, 0, 0, 0, 0, -0.0004], [0.002, 0, 0, 0, 0, 0, 0])


def scene(profile, interaction=None, **control):
    return contact.Scene(profile, 1.0, interaction or contact.Periodic(), **control or {"load": 1.0})


def full_load(profile):
    return contact.solve(scene(profile, contact_fraction=1.0)).load


@pytest.fixture
def counted(monkeypatch):
    """Counts the searches of a grid and the constructions of the limit of full contact."""
    count = {"grids": 0, "limits": 0}

    def counting(module, name, what):
        real = getattr(module, name)

        def call(*arguments, **options):
            count[what] += 1
            return real(*arguments, **options)

        monkeypatch.setattr(module, name, call)

    counting(contact.search.ways.guesses, "from_grid", "grids")
    counting(contact.search.shared, "FullLimit", "limits")
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
def test_each_solution_of_a_curve_is_that_of_a_solve_of_its_own(here, values):
    name = here.control[0]
    for value, one in zip(values, contact.solve_many(here, values), strict=True):
        control = {name: value}
        other = contact.solve(scene(here.profile, here.interaction, **control))
        assert one.scene.control == (name, value)
        assert one.certificate.holds and one.error <= 1e-8
        assert one.zones.shape == other.zones.shape
        width = np.diff(other.zones, axis=1)
        assert np.all(np.abs(one.zones - other.zones) <= (one.error + other.error) * width + 1e-15)


def test_a_curve_searches_one_grid_and_looks_for_full_contact_once(counted):
    loads = np.linspace(0.02, 0.6, 25) * 0.03
    contact.solve_many(scene(ROUGH), loads, "load")
    assert counted == {"grids": 1, "limits": 1}


def test_points_close_together_take_about_two_steps_of_newton():
    loads = np.linspace(0.2, 0.25, 21) * full_load(ROUGH)
    steps = [len(solution.trace) for solution in contact.solve_many(scene(ROUGH), loads)]
    assert np.mean(steps[4:]) <= 2.3


@pytest.mark.parametrize(("values", "control"), [([], None), ([np.nan], None), ([0.0], "load"), ([1.0], "weight")])
def test_values_and_controls_that_are_none_are_refused_by_name(values, control):
    with pytest.raises(contact.SceneError, match="values|load|control"):
        contact.solve_many(scene(ROUGH), values, control)


def test_the_certificate_sees_a_second_touch_right_beside_an_end_that_is_about_to_move_far():
    load = 0.0010874649540675919
    problem = contact.solve(scene(BUMPY, load=load)).fields.problem
    fields = ByPressure(problem).formal(load / problem.units.load, np.array([[-0.0842, 0.0234]]), 1e-10)
    beside = fields.density.zones.a[0] - np.linspace(0, 0.01, 101)
    assert fields.formal_gap(beside).min() < -1e-8
    assert not certify(fields, load / problem.units.load).holds


def test_a_grid_of_a_curve_begins_where_the_last_one_ended(monkeypatch):
    real, begun = contact.search.ways.guesses.proposed, []

    def proposed(*arguments, near=None, **options):
        begun.append(None if near is None else near.load)
        return real(*arguments, near=near, **options)

    monkeypatch.setattr(contact.search.ways.guesses, "proposed", proposed)
    waves = contact.Fourier(1.0, [0.0] * 69 + [-1e-4])
    loads = np.array([0.1, 0.11]) * np.pi * 70 * 1e-4
    first, second = contact.solve_many(scene(waves), loads)
    assert len(first.zones) == len(second.zones) == 70
    assert begun == [None, pytest.approx(loads[0])]
    assert second.zones == pytest.approx(contact.solve(scene(waves, load=loads[1])).zones, abs=1e-10)
