"""Sweeps of a scene over a grid of values. Each point has the numbers of a single solve,
whichever process solves it and however often the sweep fails or is interrupted.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import contact
from contact.commands import cli
from contact.sweeps.points import NUMBERS, numbers
from contact.sweeps.sweep import chunks as chunks_module
from contact.sweeps.sweep import processes, run
from contact.sweeps.sweep.chunks import chunks_of, solve_chunk
from contact.sweeps.sweep.keys import axes_of

xarray = pytest.importorskip("xarray")
pytest.importorskip("h5netcdf")

WAVE = contact.Scene(contact.Sinusoid(1e-2, 1.0), 1.0, contact.Periodic(), load=1.0)
PUNCH = contact.Scene(contact.Flat(0.5, 1.0), 1.0, contact.Periodic(), load=1e-3)
GRID = {"profile.amplitude": [1e-2, 2e-2], "control.contact_fraction": [0.6, 0.2, 1.0]}


@pytest.fixture
def counted(monkeypatch):
    """Returns a list that receives the index of each point that this process solves."""
    places: list[int] = []
    real = processes.solved

    def counting(scene, chunk, tol):
        for place, row in real(scene, chunk, tol):
            places.append(place)
            yield place, row

    monkeypatch.setattr(processes, "solved", counting)
    return places


def test_a_file_with_keys_as_names_is_continued(tmp_path, counted):
    first = contact.sweep(WAVE, GRID, workers=1, out=tmp_path / "out.nc")
    old = first.rename({name: first[name].attrs["key"] for name in first.dims})
    old.to_netcdf(tmp_path / "old.nc", engine="h5netcdf")
    del counted[:]
    again = contact.sweep(WAVE, GRID, workers=1, out=tmp_path / "old.nc")
    assert counted == [] and again.identical(first)


def test_every_point_has_the_numbers_of_a_solve_of_its_own():
    table = contact.sweep(WAVE, GRID, workers=1)
    assert dict(table.sizes) == {"profile_amplitude": 2, "control_contact_fraction": 3}
    assert table.profile_amplitude.attrs["key"] == "profile.amplitude"
    assert {table[name].attrs["units"] for name in ("load", "approach", "profile_amplitude")} == {
        "N/m",
        "m",
    }
    for i, amplitude in enumerate(GRID["profile.amplitude"]):
        for j, fraction in enumerate(GRID["control.contact_fraction"]):
            scene = contact.Scene(
                contact.Sinusoid(amplitude, 1.0), 1.0, contact.Periodic(), contact_fraction=fraction
            )
            alone = numbers(contact.solve(scene))
            for name in set(NUMBERS) - {"error"}:
                # The errors are at most 1e-8. The mean gap is a difference of nearly equal
                # lengths, so its relative error is larger.
                assert float(table[name][i, j]) == pytest.approx(alone[name], rel=1e-6, abs=1e-9), (
                    name
                )
    assert not table["failed"].any() and float(table["error"].max()) <= 1e-8


@pytest.mark.parametrize(
    ("scene", "over", "name", "exact"),
    [
        (
            WAVE,
            {"profile.amplitude": [1e-2, 3e-2], "control.contact_fraction": [1.0]},
            "load",
            np.pi * np.array([[1e-2], [3e-2]]),
        ),
        (
            WAVE,
            {"material.E_star": [1.0, 7.0], "control.contact_fraction": [1.0]},
            "load",
            np.pi * 1e-2 * np.array([[1.0], [7.0]]),
        ),
        (PUNCH, {"profile.width": [0.25, 0.75]}, "contact_fraction", np.array([0.25, 0.75])),
        (
            WAVE,
            {"profile.period": [1.0, 2.0], "control.mean_pressure": [1e-2]},
            "load",
            np.array([[1e-2], [2e-2]]),
        ),
    ],
    ids=["amplitude", "modulus", "width", "period"],
)
def test_a_key_of_any_table_of_the_scene_can_be_varied(scene, over, name, exact):
    table = contact.sweep(scene, over, workers=1)
    assert table[name].values == pytest.approx(exact, rel=1e-8)


def test_values_may_be_words_and_whole_numbers():
    local = contact.Scene(
        contact.Sinusoid(1e-2, 1.0), 1.0, contact.Localized("self-consistent"), load=1e-2
    )
    table = contact.sweep(local, {"interaction.neighbours": [0.0, 1, np.int64(2)]}, workers=1)
    exact = contact.solve(
        contact.Scene(contact.Sinusoid(1e-2, 1.0), 1.0, contact.Periodic(), load=1e-2)
    ).max_pressure
    off = np.abs(table["max_pressure"].values / exact - 1)
    assert np.all(np.diff(off) < 0)
    layer = contact.Scene(
        contact.Sinusoid(1e-2, 1.0),
        1.0,
        contact.Periodic(),
        substrate=contact.Layer(0.2, 0.3),
        load=1e-3,
    )
    bases = contact.sweep(layer, {"substrate.base": ["bonded", "smooth"]}, workers=1)
    assert (
        bases.substrate_base.values.tolist() == ["bonded", "smooth"]
        and float(np.ptp(bases["approach"].values)) > 0
    )


def test_the_table_has_a_unit_if_a_user_s_profile_declares_it():
    class Declared(contact.Sinusoid):
        units = {"amplitude": "m"}

    class Undeclared(contact.Sinusoid):
        units = None

    for shape, unit in ((Declared, "m"), (Undeclared, None)):
        scene = contact.Scene(shape(1e-2, 1.0), 1.0, contact.Periodic(), load=1e-3)
        table = contact.sweep(scene, {"profile.amplitude": [1e-2]}, workers=1)
        assert table.profile_amplitude.attrs.get("units") == unit


def test_along_a_control_points_share_one_search(monkeypatch):
    searches = []
    real = contact.sweeps.curve.SceneCache
    monkeypatch.setattr(
        "contact.sweeps.curve.SceneCache", lambda scene: searches.append(1) or real(scene)
    )
    contact.sweep(
        WAVE,
        {"profile.amplitude": [1e-2, 2e-2], "control.load": [1e-3, 3e-3, 2e-3, 4e-3]},
        workers=1,
    )
    assert len(searches) == 2


def test_a_point_that_fails_says_why_and_the_others_are_solved():
    lone = contact.Scene(contact.Sinusoid(1e-2, 1.0), 1.0, contact.Isolated(), load=1e-3)
    with pytest.warns(
        contact.ModelWarning, match=r"1 of 3 points failed: at control.load = 1.0: OutOfRange"
    ):
        table = contact.sweep(lone, {"control.load": [1e-3, 1.0, 2e-3]}, workers=1)
    assert table["failed"].values.tolist() == [False, True, False] and np.isnan(
        table["load"].values[1]
    )
    reason = str(table["reason"].values[1])
    assert "border" in reason or "beyond the largest" in reason
    assert table["zone_count"].values[[0, 2]].tolist() == [1, 1]


def test_an_error_raised_by_a_user_s_profile_fails_only_its_point():
    class Broken(contact.Sinusoid):
        def slope(self, x):
            # When a scene is made, the check of its profile evaluates at most 20 points at once.
            # So the check passes, and only the solve raises.
            if self.amplitude == 2e-2 and np.size(x) > 20:
                raise ZeroDivisionError("by nothing")
            return super().slope(x)

    scene = contact.Scene(Broken(1e-2, 1.0), 1.0, contact.Periodic(), load=1e-3)
    with pytest.warns(contact.ModelWarning, match="failed"):
        table = contact.sweep(scene, {"profile.amplitude": [1e-2, 2e-2]}, workers=1)
    assert table["failed"].values.tolist() == [False, True] and "by nothing" in str(
        table["reason"].values[1]
    )


BAD = [
    ({}, "over"), (None, "over"), ({"profile.amplitud": [1.0]}, "did you mean 'profile.amplitude'"), ({"load": [1.0]}, "key"),
    ({"control.load": []}, "control.load"), ({"control.load": 1.0}, "control.load"), ({"control.load": [1.0, 1.0]}, "twice"),
    ({"control.load": [np.nan]}, "control.load"), ({"control.load": [True]}, "control.load"), ({"control.load": "many"}, "control.load"),
    ({"control.load": [1.0, -1.0]}, r"control.load = -1.0"), ({"profile.amplitude": [1.0, "high"]}, "profile.amplitude"),
    ({"control.load": [1.0], "control.approach": [1.0]}, "one control"), ({"profile.amplitude": ["high"]}, "high"),
]  # fmt: skip


@pytest.mark.parametrize(("over", "told"), BAD)
def test_wrong_keys_and_values_are_refused_by_name(over, told):
    with pytest.raises(contact.SceneError, match=told):
        contact.sweep(WAVE, over)


@pytest.mark.parametrize(
    "options",
    [
        {"workers": 0},
        {"workers": 1.5},
        {"tol": 2},
        {"out": "x.csv"},
        {"out": 3},
        {"out": "none/x.nc"},
    ],
)
def test_wrong_options_are_refused_by_name(options):
    with pytest.raises(contact.SceneError, match=next(iter(options))):
        contact.sweep(WAVE, {"control.load": [1e-3]}, **options)


def test_points_in_the_file_are_not_solved_again(tmp_path, counted):
    out = tmp_path / "sweep.nc"
    first = contact.sweep(WAVE, GRID, workers=1, out=out)
    assert len(counted) == 6
    wider = {"control.contact_fraction": [0.2, 0.6, 0.8, 1.0], "profile.amplitude": [1e-2, 2e-2]}
    second = contact.sweep(WAVE, wider, workers=1, out=out)
    assert len(counted) == 8
    with xarray.open_dataset(out, engine="h5netcdf") as kept:
        assert kept.load().identical(second)
    same = second.sel(control_contact_fraction=GRID["control.contact_fraction"]).transpose(
        *first["load"].dims
    )
    assert all(same[name].equals(first[name]) for name in first.data_vars)
    contact.sweep(WAVE, wider, workers=1, out=out, overwrite=True)
    assert len(counted) == 16
    # Only points whose stated error exceeds the new tolerance are solved again.
    tight = int((second["error"] > 1e-11).sum())
    contact.sweep(WAVE, wider, tol=1e-8, workers=1, out=out)
    assert len(counted) == 16
    contact.sweep(WAVE, wider, tol=1e-11, workers=1, out=out)
    assert len(counted) == 16 + tight


def test_an_interrupted_sweep_is_continued(tmp_path, counted):
    out = tmp_path / "sweep.nc"

    def stop(stage, done, total):
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        contact.sweep(WAVE, GRID, workers=1, out=out, progress=stop)
    with xarray.open_dataset(out, engine="h5netcdf") as kept:
        assert int(kept["error"].notnull().sum()) == 4
    assert not contact.sweep(WAVE, GRID, workers=1, out=out)["load"].isnull().any()
    assert sorted(counted) == [0, 1, 2, 3, 4, 5] and [p.name for p in tmp_path.iterdir()] == [
        "sweep.nc"
    ]


def test_failed_points_are_solved_again_only_on_request(tmp_path, counted):
    lone = contact.Scene(contact.Sinusoid(1e-2, 1.0), 1.0, contact.Isolated(), load=1e-3)
    for retry in (False, False, True):
        with pytest.warns(contact.ModelWarning, match="failed"):
            contact.sweep(
                lone,
                {"control.load": [1e-3, 1.0]},
                workers=1,
                out=tmp_path / "sweep.nc",
                retry=retry,
            )
    assert counted == [0, 1, 1]


CHANGED = [
    (
        contact.Scene(contact.Sinusoid(1e-2, 1.0), 2.0, contact.Periodic(), load=1.0),
        GRID,
        "material.E_star = 1.0",
    ),
    (
        contact.Scene(contact.Sinusoid(1e-2, 2.0), 1.0, contact.Periodic(), load=1.0),
        GRID,
        "profile.period = 1.0",
    ),
    (
        contact.Scene(contact.Fourier(1.0, [1e-2]), 1.0, contact.Periodic(), load=1.0),
        {"control.load": [1e-3]},
        "contact_fraction",
    ),
    (
        contact.Scene(
            WAVE.profile, 1.0, contact.Periodic(), substrate=contact.Layer(0.5, 0.3), load=1.0
        ),
        GRID,
        "substrate.model",
    ),
    (WAVE, {**GRID, "profile.amplitude": [1e-2]}, "profile.amplitude = 0.02"),
    (WAVE, {"profile.amplitude": [1e-2, 2e-2], "control.load": [1e-3]}, "contact_fraction"),
]


def test_a_file_of_another_scene_or_grid_is_refused_with_the_key_that_differs(tmp_path, counted):
    out = tmp_path / "sweep.nc"
    contact.sweep(WAVE, GRID, workers=1, out=out)
    for scene, over, told in CHANGED:
        with pytest.raises(contact.SceneError, match=told):
            contact.sweep(scene, over, workers=1, out=out)
    out.write_text("no such thing")
    with pytest.raises(contact.SceneError, match="a file that a sweep has written"):
        contact.sweep(WAVE, GRID, workers=1, out=out)
    contact.solve(WAVE).to_dataset().to_netcdf(out, engine="h5netcdf")
    with pytest.raises(contact.SceneError, match="missing"):
        contact.sweep(WAVE, GRID, workers=1, out=out)
    assert len(counted) == 6


def test_a_trace_with_one_height_changed_is_another_scene(tmp_path):
    x = np.linspace(0.0, 1.0, 129)
    heights = 1e-2 * np.cos(2 * np.pi * x)
    for place in (None, 70):
        changed = heights.copy()
        if place:
            changed[place] *= 1 + 1e-12
        scene = contact.Scene(contact.Sampled(x, changed, 1.0), 1.0, contact.Periodic(), load=1.0)
        if place is None:
            contact.sweep(scene, {"control.load": [1e-3]}, workers=1, out=tmp_path / "sweep.nc")
        else:
            with pytest.raises(contact.SceneError, match="profile.height"):
                contact.sweep(scene, {"control.load": [1e-3]}, workers=1, out=tmp_path / "sweep.nc")


def test_a_profile_with_a_function_as_a_field_is_recognized_when_made_again(tmp_path, counted):
    @dataclass(frozen=True)
    class Shaped(contact.Profile):
        shape: Callable[[np.ndarray], np.ndarray]
        scale: float

        def height(self, x):
            return self.scale * self.shape(np.asarray(x))

    for _ in range(2):
        scene = contact.Scene(Shaped(lambda x: x**2, 0.5), 1.0, contact.Isolated(), load=1e-3)
        contact.sweep(scene, {"profile.scale": [0.5, 1.0]}, workers=1, out=tmp_path / "sweep.nc")
    assert counted == [0, 1]


def test_a_scene_that_cannot_be_sent_is_solved_here(counted):
    class Local(contact.Sinusoid):
        """A profile that no other process can import."""

    scene = contact.Scene(Local(1e-2, 1.0), 1.0, contact.Periodic(), load=1.0)
    with pytest.warns(RuntimeWarning, match="cannot be sent the scene"):
        table = contact.sweep(scene, {"profile.amplitude": [1e-2, 2e-2]}, workers=2)
    assert sorted(counted) == [0, 1] and not table["failed"].any()


# A profile that writes to a file which process solves which amplitude.
TOLD = """
import os, time
from dataclasses import dataclass
import numpy as np
import contact

@dataclass(frozen=True)
class Told(contact.Sinusoid):
    log: str = ""

    def slope(self, x):
        if "told" not in vars(self):
            object.__setattr__(self, "told", True)
            with open(self.log, "a") as log:
                log.write(f"{os.getpid()} {self.amplitude!r}\\n")
            time.sleep(0.2)
            if self.amplitude == 0.99:
                os._exit(1)
        return super().slope(x)
"""
AMPLITUDES = np.linspace(1e-2, 2e-2, 9).round(5).tolist()


@pytest.fixture
def told(tmp_path, monkeypatch):
    (tmp_path / "told.py").write_text(TOLD)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv(
        "PYTHONPATH", os.pathsep.join([str(tmp_path), str(Path(contact.__file__).parents[1])])
    )
    import told

    yield contact.Scene(
        told.Told(1e-2, 1.0, str(tmp_path / "log")), 1.0, contact.Periodic(), load=1e-3
    )
    del sys.modules["told"]


def solved_by(log: Path) -> dict[str, list[int]]:
    """Returns, for each amplitude, the ids of the other processes that began to solve its point."""
    by: dict[str, list[int]] = {}
    for line in log.read_text().splitlines():
        pid, amplitude = line.split()
        if int(pid) != os.getpid():
            by.setdefault(amplitude, []).append(int(pid))
    return by


class Killer:
    """A `progress` callback. Once three points are done it kills a process that is solving a
    point.
    """

    def __init__(self, log: Path) -> None:
        self.log, self.killed, self.begun, self.done = log, 0, set(), 0

    def __call__(self, stage: str, done: int, total: int | None) -> None:
        if done >= 3 and not self.killed:
            self.killed = next(reversed(solved_by(self.log).values()))[-1]
            os.kill(self.killed, signal.SIGKILL)
            self.begun, self.done = set(solved_by(self.log)), done

    def check(self, table) -> None:
        """Asserts that all points are solved, and that done points are not solved again. So at
        most the points that were begun but not done at the kill are begun twice.
        """
        by = solved_by(self.log)
        assert self.killed and not table["failed"].any() and not table["load"].isnull().any()
        assert set(by) == {repr(a) for a in AMPLITUDES}
        assert len([a for a in self.begun if len(by[a]) > 1]) <= len(self.begun) - self.done


@pytest.mark.slow
def test_a_process_that_is_killed_loses_no_point_and_what_was_done_is_not_done_twice(
    told, tmp_path
):
    killer = Killer(tmp_path / "log")
    killer.check(contact.sweep(told, {"profile.amplitude": AMPLITUDES}, workers=2, progress=killer))


@pytest.mark.slow
def test_a_point_that_ends_its_process_fails_and_the_other_points_are_solved(told, monkeypatch):
    monkeypatch.setattr(run, "_check_values", lambda scene, axes: None)
    with pytest.warns(contact.ModelWarning, match="1 of 4 points failed"):
        table = contact.sweep(told, {"profile.amplitude": [1e-2, 0.99, 2e-2, 3e-2]}, workers=2)
    assert table["failed"].values.tolist() == [False, True, False, False] and "ended" in str(
        table["reason"].values[1]
    )


SCRIPT = """
import contact
scene = contact.Scene(contact.Sinusoid(1e-2, 1.0), 1.0, contact.Periodic(), load=1e-3)
table = contact.sweep(scene, {"profile.amplitude": [1e-2, 2e-2]}, workers=2)
print("failed:", int(table["failed"].sum()))
"""


@pytest.mark.slow
def test_a_script_without_a_main_guard_is_solved(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT)
    environment = {**os.environ, "PYTHONPATH": str(Path(contact.__file__).parents[1])}
    done = subprocess.run(
        [sys.executable, tmp_path / "script.py"],
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    assert (
        done.stdout == "failed: 0\n"
        and "__main__" in done.stderr
        and "Traceback" not in done.stderr
    )


@pytest.mark.slow
def test_a_worker_of_a_cluster_that_is_killed_loses_no_point_and_what_was_done_is_not_done_twice(
    told, tmp_path, monkeypatch
):
    pytest.importorskip("distributed")
    dask, where = str(Path(sys.executable).with_name("dask")), tmp_path / "scheduler.json"
    silent = {
        "stdout": subprocess.DEVNULL,
        "stderr": subprocess.DEVNULL,
        "stdin": subprocess.DEVNULL,
    }
    local = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    started = [subprocess.Popen([dask, "scheduler", *local, "--scheduler-file", where], **silent)]
    try:
        deadline = time.monotonic() + 60
        while not where.exists() and time.monotonic() < deadline:
            time.sleep(0.1)
        address = json.loads(where.read_text())["address"]
        started += [
            subprocess.Popen(
                [dask, "worker", address, "--nthreads", "1", "--no-dashboard"], **silent
            )
            for _ in range(2)
        ]
        killer, out = Killer(tmp_path / "log"), tmp_path / "sweep.nc"
        table = contact.sweep(
            told, {"profile.amplitude": AMPLITUDES}, address, out=out, progress=killer
        )
        killer.check(table)
        with xarray.open_dataset(out, engine="h5netcdf") as kept:
            assert kept.load().identical(table)
        by = solved_by(tmp_path / "log")
        contact.sweep(told, {"profile.amplitude": AMPLITUDES}, address, out=out)
        assert solved_by(tmp_path / "log") == by
        monkeypatch.setattr(chunks_module, "CHUNKS", chunks_module.ChunkOptions(seconds=0.0))
        along = contact.sweep(WAVE, {"control.load": [1e-3, 2e-3, 3e-3]}, address)
        assert along["load"].values == pytest.approx([1e-3, 2e-3, 3e-3])
    finally:
        # The scheduler is ended first. Its workers then end by themselves.
        for process in started:
            process.terminate()
            process.wait(30)


def test_an_address_at_which_nothing_answers_is_refused_by_name(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("contact.sweeps.sweep.processes._CONNECTION_TIMEOUT", "0.2s")
    for address in ("tcp://127.0.0.1:9", "nowhere", 3):
        with pytest.raises(contact.SceneError, match="scheduler"):
            contact.sweep(WAVE, {"control.load": [1e-3]}, address)


TEXT = """
profile = {shape = "sinusoid", amplitude = 0.01, period = 1.0}
material = {E_star = 1.0}
interaction = {model = "periodic"}
control = {load = 1.0}
"""


def command(*arguments, text=TEXT):
    return CliRunner().invoke(
        cli.main,
        ["sweep", "-", "--workers", "1", *(str(argument) for argument in arguments)],
        input=text,
    )


def test_the_command_writes_the_table_of_contact_sweep_and_continues_it(tmp_path, counted):
    out = tmp_path / "sweep.nc"
    given = [
        "--vary",
        "control.load=1e-3:1e-2:3:log",
        "--vary",
        "profile.amplitude=0.01,0.02",
        "--out",
        out,
    ]
    done = command(*given)
    assert done.exit_code == 0, done.output
    assert "points" in done.stdout and "[" not in done.stdout and str(out) in done.stdout
    table = contact.sweep(
        WAVE, {"control.load": [1e-3, 10**-2.5, 1e-2], "profile.amplitude": [0.01, 0.02]}, workers=1
    )
    with xarray.open_dataset(out, engine="h5netcdf") as kept:
        assert kept["load"].values == pytest.approx(table["load"].values) and dict(
            kept.sizes
        ) == dict(table.sizes)
    solved = len(counted)
    assert command(*given, "-q").output == "" and len(counted) == solved
    changed = command(*given, text=TEXT.replace("E_star = 1.0", "E_star = 2.0"))
    assert changed.exit_code == 2 and "material.E_star" in changed.stderr and changed.stdout == ""
    assert (
        command(*given, "--overwrite", text=TEXT.replace("E_star = 1.0", "E_star = 2.0")).exit_code
        == 0
    )


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--vary", "control.load"], "--vary"), (["--vary", "=1,2"], "--vary"), (["--vary", "control.load=1:2"], "--vary control.load"),
        (["--vary", "control.load=1,x"], "--vary control.load"), (["--vary", "control.lod=1,2"], "did you mean"),
        (["--vary", "control.load=1,2", "--vary", "control.load=3"], "is given twice"), ([], "--vary"),
        (["--vary", "control.load=1,2", "--scheduler", "tcp://a:1"], "--workers"),
    ],
)  # fmt: skip
def test_wrong_arguments_of_the_command_are_refused_by_name(tmp_path, arguments, told):
    refused = command(*arguments, "--out", tmp_path / "sweep.nc")
    assert (
        refused.exit_code == 2
        and told in refused.stderr
        and refused.stderr.count("\n") == 1
        and refused.stdout == ""
    )
    assert (
        "--out"
        in command("--vary", "control.load=1e-3,2e-3", "--out", tmp_path / "sweep.csv").stderr
    )


def test_if_no_point_is_solved_the_command_ends_as_contact_solve_would(tmp_path):
    text = TEXT.replace('"periodic"', '"isolated"')
    failed = command("--vary", "control.load=1,2", "--out", tmp_path / "sweep.nc", "-q", text=text)
    assert failed.exit_code == 2 and failed.stderr.splitlines()[-1].startswith(
        "contact: all points failed; the first one: OutOfRange"
    )


def test_a_sweep_without_xarray_says_what_to_install(monkeypatch):
    def missing(name):
        raise contact.MissingExtra(f"{name}: pip install 'sie-contact[io]'")

    monkeypatch.setattr(run, "require", missing)
    with pytest.raises(contact.MissingExtra, match="io"):
        contact.sweep(WAVE, GRID)


def test_a_slow_chunk_returns_its_done_points_and_a_chunk_of_the_rest(monkeypatch):
    monkeypatch.setattr(chunks_module, "CHUNKS", chunks_module.ChunkOptions(seconds=0.0))
    axes = axes_of(WAVE, {"control.load": [1e-3, 3e-3, 2e-3]})
    (chunk,) = chunks_of(axes, np.ones(3, dtype=bool), None)
    found = []
    while True:
        rows = solve_chunk(WAVE, chunk, 1e-8)
        found += [(place, row["load"]) for place, row in rows]
        if not chunk.without(rows):
            break
        (chunk,) = chunk.without(rows)
    assert [place for place, _ in found] == [0, 2, 1] and [
        load for _, load in found
    ] == pytest.approx([1e-3, 2e-3, 3e-3])


@pytest.mark.slow
def test_processes_return_points_before_their_chunk_is_done(monkeypatch):
    monkeypatch.setattr(chunks_module, "CHUNKS", chunks_module.ChunkOptions(seconds=0.0))
    steps = []
    loads = np.linspace(1e-3, 2e-3, 13).tolist()
    table = contact.sweep(
        WAVE,
        {"control.load": loads},
        workers=2,
        progress=lambda stage, done, total: steps.append(done),
    )
    assert steps == list(range(1, 14)) and table["load"].values == pytest.approx(loads)


def test_points_are_cut_evenly_and_none_is_in_two_chunks():
    axes = axes_of(
        WAVE, {"control.load": np.linspace(1, 2, 50)[::-1], "profile.amplitude": [1.0, 2.0, 3.0]}
    )
    wanted = np.ones(150, dtype=bool)
    wanted[::7] = False
    for solvers in (None, 1, 2, 16):
        chunks = chunks_of(axes, wanted, solvers)
        assert Counter(place for chunk in chunks for place in chunk.places) == Counter(
            np.flatnonzero(wanted).tolist()
        )
        for chunk in chunks:
            assert len({setting["profile.amplitude"] for setting in chunk.settings}) == 1
            assert np.all(np.diff([setting["control.load"] for setting in chunk.settings]) > 0)
    assert len(chunks_of(axes, wanted, None)) == 3 and len(chunks_of(axes, wanted, 2)) >= 8


def test_a_file_is_written_by_one_sweep_at_a_time_even_through_a_symbolic_link(tmp_path):
    out, over = tmp_path / "sweep.nc", {"control.load": [1e-3, 2e-3]}
    (tmp_path / "other.nc").symlink_to(out)
    refused = []

    def meanwhile(*_):
        for name in (out, tmp_path / "other.nc"):
            with pytest.raises(contact.SceneError, match="no other sweep is writing") as caught:
                contact.sweep(WAVE, over, out=name, workers=1)
            refused.append(caught.value.field)

    contact.sweep(WAVE, over, out=out, workers=1, progress=meanwhile)
    assert refused == ["out"] * 4 and sorted(os.listdir(tmp_path)) == ["other.nc", "sweep.nc"]
    assert not contact.sweep(WAVE, over, out=out, workers=1)["failed"].any()


def test_the_lock_on_a_file_is_released_when_its_process_is_killed(tmp_path):
    out = tmp_path / "sweep.nc"
    script = "import pathlib, sys\nfrom contact.sweeps.sweep.table import alone\nwith alone(pathlib.Path(sys.argv[1])):\n"
    script += "    print('held', flush=True)\n    sys.stdin.read()\n"
    other = subprocess.Popen(
        [sys.executable, "-c", script, str(out)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert other.stdout.readline() == "held\n"
        with pytest.raises(contact.SceneError, match="no other sweep is writing"):
            contact.sweep(WAVE, {"control.load": [1e-3]}, out=out, workers=1)
    finally:
        other.kill()
        other.communicate()
    assert not contact.sweep(WAVE, {"control.load": [1e-3]}, out=out, workers=1)["failed"].any()


@pytest.fixture
def trace(tmp_path):
    x = np.linspace(0.0, 1e-3, 200)
    heights = (
        1e-6 * np.sin(2e4 * x) + 3e-7 * np.random.default_rng(5).standard_normal(200) + 2e-3 * x
    )
    file = tmp_path / "trace.txt"
    np.savetxt(file, np.column_stack((x, heights)))
    keys = {"taper": 0.1, "period": True}
    return (
        file,
        keys,
        contact.Scene(
            contact.read_trace(file, **keys), 1e11, contact.Periodic(), mean_pressure=1e7
        ),
    )


def test_varying_the_preparation_of_a_trace_equals_reading_the_trace_each_way(trace, tmp_path):
    file, keys, scene = trace
    over = {
        "profile.lambda_c": [1e-4, 5e-4],
        "profile.detrend": ["none", "line"],
        "profile.lambda_s": [2e-5],
    }
    table = contact.sweep(scene, over, workers=1, out=tmp_path / "out.nc")
    assert table.profile_lambda_c.attrs["units"] == "m"
    for i, long in enumerate(over["profile.lambda_c"]):
        for j, detrend in enumerate(over["profile.detrend"]):
            alone = contact.read_trace(file, detrend=detrend, lambda_c=long, lambda_s=2e-5, **keys)
            one = contact.solve(contact.Scene(alone, 1e11, contact.Periodic(), mean_pressure=1e7))
            assert float(table["contact_fraction"][i, j, 0]) == pytest.approx(
                one.contact_fraction, rel=1e-6
            )
    # Whole numbers of `detrend` are degrees of a polynomial. The sweep does not read the file of
    # points again, so the file may be deleted.
    file.unlink()
    assert not contact.sweep(scene, {"profile.detrend": [1, 3]}, workers=1)["failed"].any()
    with pytest.raises(contact.SceneError, match=r"profile\.taper = 3"):
        contact.sweep(scene, {"profile.taper": [3.0]}, workers=1)
    with pytest.raises(contact.SceneError, match="not known"):
        contact.sweep(WAVE, {"profile.lambda_c": [1.0]}, workers=1)


def test_a_sweep_over_a_filter_is_continued_whatever_the_filter_of_the_scene_itself(
    trace, tmp_path, counted
):
    file, keys, scene = trace
    out = tmp_path / "out.nc"
    contact.sweep(scene, {"profile.lambda_c": [1e-4]}, workers=1, out=out)
    filtered = contact.Scene(
        contact.read_trace(file, lambda_c=3e-4, **keys), 1e11, contact.Periodic(), mean_pressure=1e7
    )
    contact.sweep(filtered, {"profile.lambda_c": [1e-4, 5e-4]}, workers=1, out=out)
    assert len(counted) == 2
    higher = np.loadtxt(file)
    higher[50, 1] += 1e-7
    np.savetxt(file, higher)
    other = contact.Scene(
        contact.read_trace(file, **keys), 1e11, contact.Periodic(), mean_pressure=1e7
    )
    with pytest.raises(contact.SceneError, match=r"profile\.height"):
        contact.sweep(other, {"profile.lambda_c": [1e-4, 5e-4]}, workers=1, out=out)


def test_under_adhesion_a_sweep_covers_one_branch_or_both(tmp_path):
    wave = contact.Scene(
        contact.Sinusoid(1e-7, 1e-4),
        1e9,
        contact.Periodic(),
        law=contact.JKR(0.02),
        mean_pressure=1e4,
    )
    pressures = [1e4, 1e6]
    both = contact.sweep(
        wave, {"control.mean_pressure": pressures, "branch": ["advancing", "receding"]}, workers=1
    )
    for branch in ("advancing", "receding"):
        one = contact.sweep(wave, {"control.mean_pressure": pressures}, workers=1, branch=branch)
        assert one["contact_fraction"].values == pytest.approx(
            both["contact_fraction"].sel(branch=branch).values, rel=1e-6
        )
    assert (
        both["contact_fraction"].sel(branch="receding")
        > both["contact_fraction"].sel(branch="advancing")
    ).all()
    contact.sweep(wave, {"control.mean_pressure": pressures}, workers=1, out=tmp_path / "out.nc")
    with pytest.raises(contact.SceneError, match="receding"):
        contact.sweep(
            wave,
            {"control.mean_pressure": pressures},
            workers=1,
            out=tmp_path / "out.nc",
            branch="receding",
        )
    with pytest.raises(contact.SceneError, match="advancing or receding"):
        contact.sweep(wave, {"branch": ["up"]}, workers=1)
    with pytest.raises(contact.SceneError, match="'branch' is not known"):
        contact.sweep(WAVE, {"branch": ["advancing"]}, workers=1)
