"""Load paths: events are where their conditions hold, and unloading gives the states of loading."""

from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest

import contact
from contact import path
from contact.formulation.roots import smooth_root
from contact.reference import exact
from contact.studies.trace_kinds import drawn
from contact.sweeps import event_search, paths

BIQUADRATIC = contact.Biquadratic(radius=1.0, spacing=0.1)
MERGING = exact.IsolatedBiquadratic(1.0, 0.1, 1.0, 1e-4).merging_load
ROUGH = contact.Fourier(1.0, cosine=[-0.01, -0.003, -0.004], sine=[0.001, 0.002, 0.001])
# As the load grows, its one zone becomes two and then one again, several times.
BUMPY = contact.Fourier(1.0, [-0.01, 0, 0, 0, 0, 0, -0.0004], [0.002, 0, 0, 0, 0, 0, 0])


def scene(profile, interaction):
    return contact.Scene(profile, E_star=1.0, interaction=interaction, load=1.0)


@lru_cache
def rough_path(count, falling=False):
    full = contact.solve(contact.Scene(ROUGH, 1.0, contact.Periodic(), contact_fraction=1.0)).load
    loads = np.geomspace(1e-3, 1.1, count) * full
    return path(scene(ROUGH, contact.Periodic()), loads[::-1] if falling else loads)


def test_the_two_zones_of_the_biquadratic_merge_at_the_closed_form_load():
    found = path(scene(BIQUADRATIC, contact.Isolated()), [0.3 * MERGING, 3 * MERGING])
    (event,) = found.events
    assert event.kind == "merge"
    assert event.load == pytest.approx(MERGING, rel=1e-11, abs=0)
    assert event.position == pytest.approx(0.0, abs=1e-9)
    assert (len(event.before), len(event.after)) == (2, 1)
    assert not event.load == pytest.approx(MERGING * (1 + 1e-9), rel=1e-11, abs=0)


@pytest.mark.slow
def test_unloading_meets_the_same_events_under_their_other_names():
    up, down = rough_path(5), rough_path(5, falling=True)
    other = {"birth": "death", "merge": "split", "full": "full"}
    assert [other[e.kind] for e in up.events] == [e.kind for e in reversed(down.events)]
    assert [e.load for e in up.events] == pytest.approx(
        [e.load for e in reversed(down.events)], rel=1e-10
    )
    for one, two in zip(up.solutions, reversed(down.solutions), strict=True):
        assert one.zones == pytest.approx(two.zones, abs=1e-9)


def test_the_number_of_zones_is_that_of_the_events_passed():
    found = rough_path(5)
    assert {e.kind for e in found.events} == {"birth", "merge", "full"}
    assert [e.load for e in found.events] == sorted(e.load for e in found.events)
    for solution in found.solutions:
        passed = [e.kind for e in found.events if e.load < solution.load]
        assert len(solution.zones) == 1 + passed.count("birth") - passed.count(
            "merge"
        ) - passed.count("full")


def test_events_take_at_most_four_states_each_and_no_loads_between(monkeypatch):
    count = {"_solved": 0, "intermediate": 0}

    def counting(of, name):
        real = getattr(of, name)

        def call(*arguments):
            count[name] += 1
            return real(*arguments)

        monkeypatch.setattr(of, name, call)

    counting(event_search.EventSearch, "_solved")
    counting(paths.PathSearch, "intermediate")
    random, k = np.random.default_rng(3), np.arange(1, 25)
    profile = contact.Fourier(1.0, *(1e-3 * k**-1.3 * random.normal(size=24) for _ in range(2)))
    full = contact.solve(contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)).load
    found = path(scene(profile, contact.Periodic()), full * 0.3 * 1.06 ** np.array([-17.0, -11.0]))
    assert [event.kind for event in found.events] == ["birth", "merge", "birth", "birth"]
    assert count["_solved"] <= 16 and count["intermediate"] == 0


@pytest.mark.parametrize(("kind", "seed", "points", "low", "high"), [
    ("honed", 1, 200, 0.0225, 0.0265),
    ("ground", 1, 200, 0.095, 0.105),
    ("honed", 3, 600, 0.0066, 0.0084),
])  # fmt: skip
def test_zones_that_live_for_a_small_change_of_the_load_are_seen(kind, seed, points, low, high):
    profile = drawn(np.random.default_rng(seed), kind, points)
    rough = contact.Scene(profile, 1e11, contact.Periodic(), contact_fraction=1.0)
    full = contact.solve(rough, tol=1e-6).load
    loads = np.geomspace(low, high, 2) * full
    events = path(rough.under("load", full), loads, tol=1e-6).events
    assert min(e.load / d.load - 1 for d, e in pairwise(events)) < 0.03
    between = np.sqrt([d.load * e.load for d, e in pairwise(events)])
    start = None
    for load, event in zip(between, events[1:], strict=True):
        start = contact.solve(rough.under("load", load), tol=1e-5, near=start)
        assert len(start.zones) == len(event.before)


def test_just_beside_a_birth_the_solver_finds_the_zones_it_predicts():
    birth = next(e for e in rough_path(5).events if e.kind == "birth")
    below = contact.solve(
        contact.Scene(ROUGH, 1.0, contact.Periodic(), load=birth.load * (1 - 1e-4))
    )
    above = contact.solve(
        contact.Scene(ROUGH, 1.0, contact.Periodic(), load=birth.load * (1 + 1e-4))
    )
    assert len(above.zones) == len(below.zones) + 1
    assert np.abs(above.zones.mean(axis=1) - birth.position).min() < 1e-2


def test_full_contact_is_reached_at_the_closed_form_load():
    wave = contact.Sinusoid(amplitude=1e-6, period=1e-4)
    full = np.pi * 1.1e11 * 1e-6
    waves = contact.Scene(wave, 1.1e11, contact.Periodic(), load=1.0)
    found = path(waves, [0.5 * full, 2 * full])
    (event,) = found.events
    assert event.kind == "full"
    assert event.load == pytest.approx(full, rel=1e-13)
    assert abs(event.position) == pytest.approx(0.5e-4, rel=1e-6)


@pytest.mark.parametrize("loads", [[], [0.0], [-1.0], [np.nan], "many", None])
def test_values_that_are_no_loads_are_refused_by_name(loads):
    with pytest.raises(contact.SceneError, match="values"):
        path(scene(BIQUADRATIC, contact.Isolated()), loads)


def test_zones_that_are_born_and_merge_between_two_loads_of_one_zone_each_are_seen():
    bumpy = scene(BUMPY, contact.Periodic())
    full = contact.solve(contact.Scene(BUMPY, 1.0, contact.Periodic(), contact_fraction=1.0)).load
    found = path(bumpy, np.array([0.3, 0.65, 1.1]) * full)
    assert [len(solution.zones) for solution in found.solutions] == [1, 1, 0]
    assert [event.kind for event in found.events] == ["birth", "merge", "birth", "merge", "full"]
    for event in found.events[:-1]:
        before, after = (
            len(s.zones)
            for s in contact.solve_many(bumpy, event.load * np.array([1 - 1e-5, 1 + 1e-5]))
        )
        assert after - before == (1 if event.kind == "birth" else -1)


@pytest.mark.parametrize(("function", "low", "high", "root"), [
    (lambda x: np.exp(x) - 2, 0.0, 2.0, np.log(2)),
    (lambda x: x**3 - 2, 0.0, 5.0, 2 ** (1 / 3)),
    (lambda x: 1 - 2 * x, 0.0, 1.0, 0.5),
    (lambda x: np.copysign(np.sqrt(abs(x - 1.1)), x - 1.1), 0.0, 3.0, 1.1),
])  # fmt: skip
def test_the_root_of_a_function_takes_few_evaluations(function, low, high, root):
    asked = []

    def told(x):
        asked.append(x)
        return function(x)

    found = smooth_root(told, {low: function(low), high: function(high)})
    assert found == pytest.approx(root, rel=1e-11) and len(asked) <= (10 if root != 1.1 else 40)
