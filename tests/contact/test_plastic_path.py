"""Load paths with a hardness: closed forms, mirrored profiles, equal summits."""

import numpy as np
import pytest

import contact

pytestmark = pytest.mark.filterwarnings("ignore::contact.ModelWarning")

FOUR = contact.Fourier(1.0, [0.1, 0.05, 0.02], [0.03, -0.04, 0.05])


def path_of(profile, hardness, parts):
    law = contact.Plastic(hardness)
    scene = contact.Scene(profile, 1.0, contact.Periodic(), law=law, load=0.1 * hardness)
    return contact.path(scene, hardness * np.asarray(parts))


def test_events_of_a_cylinder_and_a_wave_have_closed_forms():
    law = contact.Plastic(0.01)
    scene = contact.Scene(contact.Parabola(2.0), 3.0, contact.Isolated(), law=law, load=1.0)
    (event,) = contact.path(scene, [1e-4, 4e-4]).events
    assert event.kind == "onset" and event.change() == "plateaus: 0 to 1"
    assert event.load == pytest.approx(np.pi * 2.0 * 0.01**2 / 3.0, rel=1e-11)
    for hardness in (3.0, 8.0):
        # Contact |x| < A/pi of a wave has the mean pressure p* sin^2 A and the peak 2 p* sin A;
        # here p* = pi.
        kinds = ["onset", "full"] if hardness < 2 * np.pi else ["full", "onset"]
        loads = [hardness**2 / (4 * np.pi), hardness - hardness**2 / (4 * np.pi)]
        loads = loads if hardness < 2 * np.pi else [np.pi, hardness - np.pi]
        events = path_of(contact.Sinusoid(1.0, 1.0), hardness, [0.2, 0.9]).events
        assert [one.kind for one in events] == kinds
        np.testing.assert_allclose([one.load for one in events], loads, rtol=1e-11)


MIRRORED = {"birth": "join", "join": "birth", "merge": "onset", "full": "onset", "onset": "merge"}


def mirrors(cosine, sine, hardness, parts):
    """Events of a profile and of the mirrored profile, as sorted lists of (load, kind, error).

    The hardness minus the pressure of one profile is the pressure of the other: the gaps of one
    are the plateaus of the other. The loads and kinds of the second list are converted
    accordingly.
    """
    parts = np.array(parts)
    one = path_of(contact.Fourier(1.0, cosine, sine), hardness, parts).events
    other = path_of(
        contact.Fourier(1.0, [-c for c in cosine], [-s for s in sine]), hardness, 1 - parts[::-1]
    ).events
    first = sorted((e.load, e.kind.replace("full", "merge"), e.error) for e in one)
    last = sorted((hardness - e.load, MIRRORED[e.kind], e.error) for e in other)
    return first, last


def assert_mirrors(first, last, hardness):
    assert [kind for _, kind, _ in first] == [kind for _, kind, _ in last]
    a, b = (np.array([load for load, _, _ in events]) for events in (first, last))
    # Events of elastic contact state no error.
    errors = [
        (one or 1e-12) + (two or 1e-12) for (*_, one), (*_, two) in zip(first, last, strict=True)
    ]
    assert np.all(np.abs(a - b) <= hardness * np.array(errors))


def test_a_profile_and_its_mirror_image_have_the_same_events():
    first, last = mirrors([0.1, 0.07], [0.03, -0.04], 0.4, [0.15, 0.6])
    assert len(first) > 1
    assert_mirrors(first, last, 0.4)


@pytest.mark.slow
def test_no_event_is_missed_up_to_the_hardness():
    first, last = mirrors(FOUR.cosine, FOUR.sine, 0.5, [0.02, 0.4, 0.9, 0.99])
    assert [kind for _, kind, _ in first] == ["onset", "birth", "onset", "merge", "join", "merge"]
    assert_mirrors(first, last, 0.5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_events_at_one_load_are_mirrored_too(seed):
    random = np.random.default_rng(seed)
    cosine = random.normal(size=4) / np.arange(1, 5) ** 1.3
    hardness = float(np.abs(cosine).max() * random.uniform(1.0, 5.0))
    first, last = mirrors(cosine, np.zeros(4), hardness, [0.01, 0.5, 0.99])
    # Round-off decides the order of events at equal loads.
    first, last = (
        sorted(events, key=lambda e: (round(e[0] / hardness, 8), e[1])) for events in (first, last)
    )
    assert_mirrors(first, last, hardness)


def test_two_equal_summits_yield_at_one_load():
    law = contact.Plastic(0.01)
    pair = contact.Biquadratic(1.0, 0.2)
    scene = contact.Scene(pair, 1.0, contact.Isolated(), law=law, load=1.0)
    first, second, *_ = contact.path(scene, [1e-5, 2e-3]).events
    assert first.kind == second.kind == "onset"
    assert first.load == pytest.approx(second.load, rel=1e-9)
    assert first.position == pytest.approx(-second.position, rel=1e-6)
    bare = contact.Scene(pair, 1.0, contact.Isolated(), load=first.load)
    assert contact.solve(bare).max_pressure == pytest.approx(0.01, rel=1e-8)


def test_falling_paths_are_refused_and_lists_of_loads_are_solved():
    scene = contact.Scene(
        FOUR, 1.0, contact.Periodic(), law=contact.Plastic(0.5), mean_pressure=0.2
    )
    with pytest.raises(contact.SceneError, match="for unloading, solve"):
        contact.path(scene, [0.2, 0.1])
    many = contact.solve_many(scene, [0.01, 0.1, 0.3])
    assert [len(one.plateaus) for one in many] == [0, 1, 2]
