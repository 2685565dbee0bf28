"""Error messages are short and name the caller's values; events of a path lie in the cell."""

import numpy as np
import pytest

import contact

WAVE = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), load=1.0)


@pytest.mark.parametrize(
    "refused",
    [
        lambda: contact.path(WAVE, -np.arange(1.0, 4000.0)),
        lambda: contact.path(WAVE, ["word" * 50] * 500),
        lambda: contact.solve_many(WAVE, -np.arange(1.0, 4000.0)),
        lambda: contact.Sampled(np.arange(4000.0), np.full(4000, np.nan)),
        lambda: contact.profile("x" * 5000),
        lambda: contact.Scene(
            contact.Sinusoid(np.arange(5000.0), 1.0), 1.0, contact.Periodic(), load=1.0
        ),
        lambda: (_ for _ in ()).throw(contact.NotConverged("y" * 9000)),
    ],
)
def test_no_message_is_longer_than_five_lines(refused):
    with pytest.raises(contact.ContactError) as raised:
        refused()
    assert len(str(raised.value)) <= 400 and "array(" not in str(raised.value)


def test_a_path_names_its_values():
    with pytest.raises(contact.SceneError, match=r"^values = .*positive loads \(element 1 is -2\)"):
        contact.path(WAVE, [1.0, -2.0])


def test_events_lie_in_the_cell():
    profile = contact.Sampled(
        np.arange(8) / 8, np.random.default_rng(0).normal(size=8) * 1e-3, period=1.0
    )
    found = contact.path(
        contact.Scene(profile, 1.0, contact.Periodic(), load=1.0), np.geomspace(1e-5, 0.03, 7)
    )
    assert {event.kind for event in found.events} == {"birth", "merge", "full"}
    assert all(profile.x0 <= event.position < profile.x0 + 1.0 for event in found.events)
