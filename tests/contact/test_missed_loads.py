"""Lists of loads, some of which miss the tolerance: the other loads are solved and returned."""

import json
from pathlib import Path

import numpy as np
import pytest

import contact
from contact.model.scene_file import to_toml

# A zone appears at 303.7 N/m. Just above this load, round-off determines the ends of the new zone.
WAVES = contact.Fourier(1e-4, [-1e-6, 3e-7, 2e-7], [2e-7, 1e-7, 1e-8])
SCENE = contact.Scene(WAVES, 1e9, contact.Periodic(), load=1.0)
BIRTH = contact.path(SCENE, [290.0, 320.0]).events[0]
MISSED = BIRTH.load * (1 + 1e-9)
LOADS = [250.0, MISSED, 400.0, 300.0]


@pytest.mark.parametrize("workers", [1, 2])
def test_one_load_that_misses_the_tolerance_leaves_the_others_solved(workers: int) -> None:
    with pytest.raises(contact.NotConverged, match="load = 303.7.*3 other values solved") as error:
        contact.solve_many(SCENE, LOADS, "load", workers=workers)
    found = error.value.best
    assert [one.load for one in found] == pytest.approx(LOADS)
    assert [one.error < 1e-8 for one in found] == [True, False, True, True]
    ((value, own),) = error.value.trace
    assert value == MISSED and own.best is found[1]
    alone = contact.solve_many(SCENE, LOADS[2:], "load")
    for one, other in zip(found[2:], alone, strict=True):
        assert one.zones == pytest.approx(other.zones, abs=1e-12)


def test_a_path_goes_on_past_a_load_that_misses_the_tolerance() -> None:
    loads = [250.0, MISSED, 400.0]
    with pytest.raises(contact.NotConverged, match="load = 303.7.*2 other values solved") as error:
        contact.path(SCENE, loads)
    found = error.value.best
    assert isinstance(found, contact.Path)
    assert [one.load for one in found.solutions] == pytest.approx([250.0, 400.0])
    assert [event.kind for event in found.events] == ["birth"]
    assert found.events[0].load == pytest.approx(BIRTH.load, rel=1e-6)


def test_a_load_that_is_alone_or_out_of_range_is_refused_as_by_solve() -> None:
    with pytest.raises(contact.NotConverged, match="stated error") as error:
        contact.solve_many(SCENE, [MISSED], "load")
    assert isinstance(error.value.best, contact.Solution)
    wave = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Isolated(), load=1.0)
    with pytest.raises(contact.OutOfRange):
        contact.solve_many(wave, [1e2, 1e4], "load")


def test_all_missed_loads_are_named() -> None:
    loads = BIRTH.load * (1 + np.array([1e-9, 1e-8, 1e-1]))
    with pytest.raises(contact.NotConverged, match=f"also not converged at: {loads[1]:.17g}"):
        contact.solve_many(SCENE, loads, "load")


@pytest.mark.parametrize("events", [True, False])
def test_the_command_prints_the_loads_that_were_solved(events: bool, tmp_path: Path) -> None:
    testing = pytest.importorskip("click.testing")
    pytest.importorskip("rich")
    from contact.commands import cli

    file = tmp_path / "scene.toml"
    file.write_text(to_toml(SCENE))
    more = [] if events else ["--no-events"]
    run = testing.CliRunner().invoke(
        cli.main, ["path", str(file), "--loads", f"250,{MISSED!r},400", "--json", *more]
    )
    assert run.exit_code == 3 and "303.7" in run.stderr
    assert json.loads(run.stdout)["points"]["load"] == pytest.approx([250.0, 400.0])
