"""Measured traces: sorted, filled, filtered, evaluated and shown as the user asks, and never
otherwise.
"""

from __future__ import annotations

import json
import tomllib
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import contact
from contact.commands import cli
from contact.model.traces import instruments
from contact.model.traces.filters import ALPHA, low_pass
from contact.model.traces.roughness import height_distribution, power_spectrum, roughness

N = 60
X = 0.5e-6 * np.arange(N)
Z = 1e-7 * np.random.default_rng(5).normal(size=N)


def write(folder: Path, rows: list[str], header: str = "x [m];z [m]") -> Path:
    path = folder / "trace.txt"
    path.write_text("\n".join((header, *rows)) + "\n", encoding="utf-8")
    return path


def rows(heights: list[str] | None = None, order: np.ndarray | None = None) -> list[str]:
    told = [f"{z!r}" for z in Z.tolist()] if heights is None else heights
    lines = [f"{x!r};{z}" for x, z in zip(X.tolist(), told, strict=True)]
    return lines if order is None else [lines[i] for i in order]


def with_holes(*places: int, mark: str = "nan") -> list[str]:
    return [mark if i in places else f"{z!r}" for i, z in enumerate(Z.tolist())]


def refused(path: Path, *words: str, **keys: object) -> None:
    with pytest.raises(contact.SceneError) as caught:
        contact.read_trace(path, **keys)  # type: ignore[arg-type]
    assert all(word in str(caught.value) for word in words), caught.value


# Order and dropouts
# -----------------------------------------------------------------------------------------------------------
def test_descending_positions_are_reversed_and_the_history_says_so(tmp_path: Path) -> None:
    read = contact.read_trace(write(tmp_path, rows()[::-1]))
    assert np.array_equal(read.x, X) and np.array_equal(read.heights, Z)
    assert "order reversed" in read.history[1]


def test_points_out_of_order_are_sorted_only_if_asked(tmp_path: Path) -> None:
    path = write(tmp_path, rows(order=np.random.default_rng(1).permutation(N)))
    refused(path, "sort = true", "line")
    read = contact.read_trace(path, sort=True)
    assert (
        np.array_equal(read.x, X)
        and np.array_equal(read.heights, Z)
        and "sorted" in read.history[1]
    )
    refused(path, "sort = 'yes'", sort="yes")


@pytest.mark.parametrize("mark", ["nan", "***", "", "BAD", "inf", "n/a"])
def test_missing_heights_are_refused_unless_fill_is_given(tmp_path: Path, mark: str) -> None:
    path = write(tmp_path, rows(with_holes(3, 4, 10, mark=mark)))
    refused(path, "line 5", "2 more of 60", 'fill = "linear"', 'fill = "drop"')
    line, drop = contact.read_trace(path, fill="linear"), contact.read_trace(path, fill="drop")
    assert np.array_equal(line.x, X) and line.heights[3] == pytest.approx(Z[2] + (Z[5] - Z[2]) / 3)
    assert np.array_equal(drop.x, np.delete(X, [3, 4, 10])) and np.array_equal(
        drop.heights, np.delete(Z, [3, 4, 10])
    )
    assert "3 of 60" in line.history[1] and "in 2 gaps" in line.history[1]


@pytest.mark.parametrize("missing", [-32768, "x", -32768.0])
def test_a_mark_of_a_missing_height_may_be_named(tmp_path: Path, missing: object) -> None:
    path = write(tmp_path, rows(with_holes(20, mark=str(missing))))
    read = contact.read_trace(path, missing=missing, fill="drop")  # type: ignore[arg-type]
    assert read.x.size == N - 1


def test_ends_without_heights_are_cut_off_and_not_made_up(tmp_path: Path) -> None:
    read = contact.read_trace(write(tmp_path, rows(with_holes(0, 1, N - 1))), fill="linear")
    assert np.array_equal(read.x, X[2:-1]) and "3 at the ends cut off" in read.history[1]


@pytest.mark.parametrize("mark", ["***", "", "nan", "-"])
def test_heights_missing_from_the_first_row_on_are_no_header(tmp_path: Path, mark: str) -> None:
    """If rows with missing heights were taken for a header, the header with the units would be
    lost.
    """
    read = contact.read_trace(
        write(tmp_path, rows(with_holes(0, 1, 2, 3, mark=mark)), "x [um];z [nm]"), fill="drop"
    )
    assert read.x == pytest.approx(1e-6 * X[4:]) and "4 of 60" in read.history[1]
    alone = write(tmp_path, with_holes(0, 1, 2, 3, mark="***"), "z [nm]")
    assert "4 of 60" in contact.read_trace(alone, pitch=1e-6, fill="drop").history[1]


def test_a_repeated_value_that_may_mark_missing_heights_causes_a_warning(tmp_path: Path) -> None:
    path = write(tmp_path, rows(with_holes(20, 21, mark="-32768")), "x [m];z [m]")
    with pytest.warns(contact.ModelWarning, match="occurs 2 times"):
        contact.read_trace(path)


def test_many_missing_heights_are_warned_of(tmp_path: Path) -> None:
    path = write(tmp_path, rows(with_holes(*range(20, 30))))
    with pytest.warns(contact.ModelWarning, match="more than a tenth"):
        contact.read_trace(path, fill="linear")
    refused(write(tmp_path, rows(with_holes(*range(N - 3)))), "at least 4", fill="linear")


def test_an_empty_line_in_a_column_of_heights_is_refused_unless_all_alternate(
    tmp_path: Path,
) -> None:
    told = [f"{z!r}" for z in Z.tolist()]
    refused(
        write(tmp_path, [*told[:7], "", *told[7:]], "z [m]"), "empty line", "line 9", pitch=1e-6
    )
    apart = "\n\n".join(told).split("\n")
    assert contact.read_trace(write(tmp_path, apart, "z [m]"), pitch=1e-6).x.size == N


# Filters and forms
# ------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("wave", [40, 80, 160])
def test_a_gaussian_filter_multiplies_a_wave_by_the_transmission(wave: int) -> None:
    x = np.arange(1001.0)
    z = np.cos(2 * np.pi * x / wave)
    inner = slice(250, -250)
    expected = np.exp(-np.pi * (ALPHA * 80 / wave) ** 2)
    assert np.allclose(low_pass(x, z, 80.0, "lambda_c")[inner], expected * z[inner], atol=1e-12)
    assert expected == pytest.approx(0.5) or wave != 80


def test_a_gaussian_filter_is_a_weighted_fit_of_a_line_also_at_the_ends() -> None:
    rng = np.random.default_rng(2)
    x, z = np.arange(90.0), rng.normal(size=90)
    found = low_pass(x, z, 30.0, "lambda_c")
    for i in (0, 3, 45, 89):
        root = np.sqrt(np.exp(-np.pi * ((x - x[i]) / (ALPHA * 30.0)) ** 2))
        line = np.linalg.lstsq(root[:, None] * np.vander(x - x[i], 2), root * z, rcond=None)[0]
        assert found[i] == pytest.approx(line[1], abs=1e-12)
    assert np.allclose(low_pass(x, 3 + 0.2 * x, 30.0, "lambda_c"), 3 + 0.2 * x, atol=1e-12)


@pytest.mark.parametrize(
    ("key", "kept", "gone"), [("lambda_s", 20.0, 2.0), ("lambda_c", 2.0, 20.0)]
)
def test_each_filter_removes_the_waves_on_its_side_of_the_cut_off(
    tmp_path: Path, key: str, kept: float, gone: float
) -> None:
    x = np.arange(401) * 0.1
    wave, other = np.cos(2 * np.pi * x / kept), np.cos(2 * np.pi * x / gone)
    path = write(
        tmp_path,
        [f"{a!r};{b!r}" for a, b in zip(x.tolist(), (wave + other).tolist(), strict=True)],
        "x [um];z [nm]",
    )
    read = contact.read_trace(path, **{key: 6e-6})  # type: ignore[arg-type]
    assert 1e9 * read.heights[100:-100] == pytest.approx(wave[100:-100], abs=0.1)


def test_filters_in_a_scene_file_act_as_in_read_trace(tmp_path: Path) -> None:
    path = write(tmp_path, rows())
    keys = {"lambda_s": 2e-6, "lambda_c": 10e-6, "detrend": 3, "taper": 0.2, "period": True}
    read = contact.read_trace(path, **keys)  # type: ignore[arg-type]
    lines = "\n".join(f"{key} = {json.dumps(value)}" for key, value in keys.items())
    scene = f'[profile]\nshape = "sampled"\nfile = "{path.name}"\n{lines}\n[material]\nE_star = 1e11\n[interaction]\nmodel = "periodic"\n'
    (tmp_path / "scene.toml").write_text(f"{scene}[control]\nmean_pressure = 1e6\n")
    of_scene = contact.load_scene(tmp_path / "scene.toml").profile
    assert np.array_equal(read.heights, of_scene.heights)
    assert [
        word in said
        for word, said in zip(
            ("lambda_s", "degree 3", "lambda_c", "taper"), read.history[1:], strict=False
        )
    ] == [True] * 4
    assert read.heights.std() < Z.std()


@pytest.mark.parametrize(
    ("keys", "word"),
    [
        ({"lambda_c": 1.0}, "lambda_c = 1.0"), ({"lambda_s": 1e-9}, "lambda_s = 1e-09"),
        ({"lambda_c": 0.0}, "lambda_c = 0.0"),
        ({"lambda_s": 9e-6, "lambda_c": 5e-6}, "below lambda_c"), ({"lambda_c": "long"}, "lambda_c = 'long'"),
        ({"fill": "zero"}, "fill = "),
        ({"detrend": 13}, "detrend = 13"), ({"detrend": True}, "detrend = True"), ({"detrend": "cube"}, "detrend = 'cube'"),
        ({"missing": True}, "missing = True"), ({"missing": ""}, "missing = ''"),
        ({"channel": "Z"}, "channel = 'Z'"), ({"line": 3}, "line is only for a map"),
    ],
    ids=str,
)  # fmt: skip
def test_wrong_keys_of_a_trace_are_refused_by_name(tmp_path: Path, keys: dict, word: str) -> None:
    refused(write(tmp_path, rows()), word, **keys)


def test_a_filter_of_uneven_positions_asks_for_regrid(tmp_path: Path) -> None:
    path = write(tmp_path, rows(with_holes(30)))
    refused(path, "regrid = true", fill="drop", lambda_c=5e-6)
    assert contact.read_trace(path, fill="drop", regrid=60, lambda_c=5e-6).x.size == 60


# Numbers
# ----------------------------------------------------------------------------------------------------------------------
def test_the_roughness_of_a_wave_a_ramp_and_a_bowl_equals_closed_forms() -> None:
    x = np.arange(512) / 512
    wave = roughness(contact.Sampled(x, 3.0 + 2.0 * np.cos(2 * np.pi * x), period=1.0))
    found = (wave.Ra, wave.Rq, wave.Rsk, wave.Rku, wave.rms_slope)
    assert found == pytest.approx(
        (4 / np.pi, np.sqrt(2), 0.0, 1.5, 2 * np.pi * np.sqrt(2)), abs=1e-6
    )
    t = np.linspace(0.0, 2.0, 40)
    ramp = roughness(contact.Sampled(t, 0.3 * t))
    assert (ramp.Ra, ramp.Rq, ramp.Rsk, ramp.Rku) == pytest.approx(
        (0.15, 0.3 / np.sqrt(3), 0.0, 1.8), abs=1e-4
    )
    assert (ramp.rms_slope, ramp.length, ramp.pitch, ramp.points, ramp.even) == (
        pytest.approx(0.3),
        2.0,
        pytest.approx(2 / 39),
        40,
        True,
    )
    bowl = roughness(contact.Sampled(t, (t - 1.0) ** 2))
    assert bowl.Rsk == pytest.approx(16 / 945 / (4 / 45) ** 1.5, rel=1e-12)


@pytest.mark.parametrize("n", [256, 255])
def test_the_power_spectrum_sums_to_the_mean_square(n: int) -> None:
    z = np.random.default_rng(4).normal(size=n)
    trace = contact.Sampled(np.arange(n) * 0.1, z, period=0.1 * n)
    q, density = power_spectrum(trace)
    assert np.sum(density) * q[0] == pytest.approx(np.var(z), rel=1e-10)
    assert q[-1] == pytest.approx(np.pi / 0.1, rel=1.1 / n)
    edges, often = height_distribution(trace)
    assert np.sum(often * np.diff(edges)) == pytest.approx(1.0)


def test_a_self_affine_profile_has_its_slope_spectrum_and_seed() -> None:
    keys = {"hurst": 0.7, "period": 2e-3, "shortest": 1e-5, "rms_slope": 0.05}
    made = contact.self_affine(**keys, rolloff=2e-4, seed=7)
    x = 2e-3 * np.arange(1000) / 1000
    assert np.sqrt(np.mean(made.slope(x) ** 2)) == pytest.approx(0.05, rel=1e-12)
    power = made.cosine**2 + made.sine**2
    assert power.size == 200 and power[:10] / power[0] == pytest.approx(np.ones(10))
    assert power[199] / power[9] == pytest.approx(20 ** -(1 + 2 * 0.7), rel=1e-9)
    again, other = contact.self_affine(**keys, seed=7), contact.self_affine(**keys, seed=8)
    assert np.array_equal(
        again.cosine, contact.self_affine(**keys, seed=7).cosine
    ) and not np.array_equal(again.cosine, other.cosine)
    finer = contact.self_affine(**{**keys, "shortest": 5e-6}, seed=7)
    assert np.allclose(finer.sine[:200] / finer.cosine[:200], again.sine / again.cosine, rtol=1e-9)


@pytest.mark.parametrize(
    "bad",
    [{"hurst": 0}, {"hurst": 1.2}, {"period": -1}, {"shortest": 2.0}, {"rms_slope": 0}, {"seed": -1}, {"seed": 1.5}, {"rolloff": 1e-3},
     {"longest": 3.0}, {"shortest": 1e-9}],
    ids=str,
)  # fmt: skip
def test_wrong_parameters_of_a_self_affine_profile_are_refused_by_name(bad: dict) -> None:
    keys = {"hurst": 0.8, "period": 1.0, "shortest": 0.01, "rms_slope": 0.1, "seed": 0}
    with pytest.raises(contact.SceneError, match=f"^{next(iter(bad))} = "):
        contact.self_affine(**{**keys, **bad})


# Instruments' files
# -----------------------------------------------------------------------------------------------------------
MAP = np.random.default_rng(8).normal(size=(12, 9))


class Surface:
    """A stand-in for what a reader returns: a map of 12 um x 18 um with one height missing."""

    unit, dim, physical_sizes = "µm", 2, (12e-6, 18e-6)

    def to_unit(self, unit: str) -> Surface:
        return self

    def heights(self) -> np.ma.MaskedArray:
        return np.ma.masked_where(np.arange(108).reshape(12, 9) == 40, 1e-9 * MAP)


def stand_in(*names: str) -> SimpleNamespace:
    channels = [
        SimpleNamespace(name=name, is_height_channel=name != "Phase", topography=Surface)
        for name in names
    ]
    return SimpleNamespace(open_topography=lambda path: SimpleNamespace(channels=channels))


@pytest.fixture
def scan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(instruments, "require", lambda name: stand_in("Height", "Phase"))
    path = tmp_path / "scan.plu"
    path.write_bytes(bytes(64))
    return path


def test_a_line_is_picked_from_a_map_by_its_number(scan: Path) -> None:
    across, up = contact.read_trace(scan, line=2), contact.read_trace(scan, line=11, along="y")
    assert across.x == pytest.approx(1e-6 * np.arange(12)) and np.array_equal(
        across.heights, 1e-9 * MAP[:, 2]
    )
    assert up.x == pytest.approx(2e-6 * np.arange(9)) and np.array_equal(up.heights, 1e-9 * MAP[11])
    assert "line 2 (of 0 to 8) along x of a map of 12 x 9" in across.history[0]
    refused(scan, "no finite height", line=4)
    assert contact.read_trace(scan, line=4, fill="drop").x.size == 11


def test_a_profile_is_picked_from_a_map_between_two_points(scan: Path) -> None:
    read = contact.read_trace(scan, line=[[0.0, 0.0], [3e-6, 4e-6]])
    assert read.x[-1] == pytest.approx(5e-6) and read.x.size == 6
    assert read.heights[[0, -1]] == pytest.approx(1e-9 * MAP[[0, 3], [0, 2]])
    # The second point lies 0.6 pitches in x and 0.4 in y from the first. Its height is
    # interpolated bilinearly.
    corners = (
        MAP[0, 0] * 0.4 * 0.6
        + MAP[1, 0] * 0.6 * 0.6
        + MAP[0, 1] * 0.4 * 0.4
        + MAP[1, 1] * 0.6 * 0.4
    )
    assert read.heights[1] == pytest.approx(1e-9 * corners)


@pytest.mark.parametrize(
    ("keys", "word"),
    [
        ({}, "line = None"), ({"line": 9}, "line = 9"), ({"line": -1}, "line = -1"), ({"line": True}, "line = True"),
        ({"line": 1, "along": "z"}, "along = 'z'"), ({"line": [[0, 0], [1, 1]]}, "line = "), ({"line": [1, 2]}, "line = "),
        ({"line": 1, "channel": "Phase"}, "channel = 'Phase'"), ({"line": 1, "channel": 1}, "channel = 1"),
        ({"line": 1, "units": "um"}, "units = 'um'"), ({"line": 1, "columns": [0, 1]}, "columns = "),
        ({"line": 1, "pitch": 1e-6}, "pitch = "),
    ],
    ids=str,
)  # fmt: skip
def test_wrong_keys_of_a_map_are_refused_by_name(scan: Path, keys: dict, word: str) -> None:
    refused(scan, word, **keys)


def test_one_of_several_height_channels_must_be_named(
    scan: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        instruments, "require", lambda name: stand_in("Trace", "Phase", "Back", "Back")
    )
    refused(scan, "0 'Trace', 1 'Back', 2 'Back'", line=1)
    refused(scan, "channel = 'Back'", "a number", line=1, channel="Back")
    assert (
        contact.read_trace(scan, line=1, channel="Trace").x.size
        == contact.read_trace(scan, line=1, channel=2).x.size
        == 12
    )


def test_an_instruments_file_without_its_reader_names_the_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "SurfaceTopography", None)
    with zipfile.ZipFile(tmp_path / "scan.x3p", "w") as archive:
        archive.writestr("main.xml", "<x/>")
    with pytest.raises(contact.MissingExtra, match=r"\[instruments\]"):
        contact.read_trace(tmp_path / "scan.x3p")


def test_a_text_file_with_an_instruments_ending_is_still_a_table(tmp_path: Path) -> None:
    path = write(tmp_path, rows()).rename(tmp_path / "trace.dat")
    assert np.array_equal(contact.read_trace(path).heights, Z)


def test_files_of_instruments_are_read_by_their_own_reader(tmp_path: Path) -> None:
    package = pytest.importorskip("SurfaceTopography")
    surface = package.Topography(1e-3 * MAP, (12.0, 18.0), unit="µm")
    for ending in ("x3p", "gwy"):
        path = tmp_path / f"scan.{ending}"
        getattr(surface, f"to_{ending}")(str(path))
        read = contact.read_trace(path, line=2)
        assert np.allclose(1e6 * read.x, np.arange(12)) and np.allclose(
            read.heights, 1e-9 * MAP[:, 2], atol=1e-15
        )
    (tmp_path / "none.opd").write_bytes(bytes(range(256)))
    refused(tmp_path / "none.opd", "no reader")


# The command
# ------------------------------------------------------------------------------------------------------------------
def run(*arguments: object, status: int = 0) -> str:
    result = CliRunner().invoke(cli.main, [str(argument) for argument in arguments])
    assert result.exit_code == status, result.output
    return result.output


def test_a_trace_is_shown_and_its_scene_is_solved(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    path, scene, figure = (
        write(tmp_path, rows(with_holes(5))),
        tmp_path / "start.toml",
        tmp_path / "trace.png",
    )
    keys = (
        "--fill",
        "linear",
        "--lambda-s",
        "3e-6",
        "--detrend",
        "line",
        "--taper",
        "0.2",
        "--period",
        "true",
    )
    told = run("trace", path, *keys, "--scene", scene, "--plot", figure)
    for word in (
        "60",
        "29.5 µm",
        "500 nm",
        "Ra",
        "Rsk",
        "rms slope",
        "1 of 60 heights are missing",
        "lambda_s",
        "tapered",
    ):
        assert word in told
    assert figure.stat().st_size > 10_000
    assert tomllib.loads(scene.read_text())["profile"]["lambda_s"] == 3e-6
    assert "--overwrite" in run("trace", path, *keys, "--scene", scene, status=2)
    run("trace", path, *keys, "--scene", scene, "--overwrite")
    solved = run("solve", scene)
    assert (
        "1 of 60 heights are missing" in solved
        and "rms slope" in solved
        and "contact fraction" in solved
    )


def test_a_trace_without_a_period_starts_an_isolated_scene(tmp_path: Path) -> None:
    bump = [f"{x!r};{-((x - 15e-6) ** 2) / 1e-3!r}" for x in X.tolist()]
    run("trace", write(tmp_path, bump), "--scene", tmp_path / "start.toml")
    assert "isolated interaction" in run("solve", tmp_path / "start.toml")


def test_a_trace_as_json_has_plain_numbers(tmp_path: Path) -> None:
    told = json.loads(run("trace", write(tmp_path, rows()), "--json"))
    assert told["points"] == N and told["Rq"] == pytest.approx(Z.std(), rel=0.1) and told["history"]


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--columns", "0,0"),
        ("--lambda-c", "x"),
        ("--period", "-1"),
        ("--plot", "a.doc"),
        ("--scene", "a.txt"),
        ("--fill", "0"),
        ("--line", "3"),
    ],
)
def test_the_command_refuses_in_one_line_and_by_name(
    tmp_path: Path, option: str, value: str
) -> None:
    result = CliRunner().invoke(cli.main, ["trace", str(write(tmp_path, rows())), option, value])
    assert result.exit_code == 2 and result.stdout == "" and result.stderr.count("\n") == 1
    assert option.strip("-").replace("-", "_") in result.stderr


# Traces with faults: the message says what to do
# ------------------------------------------------------------------------------------
def test_for_repeated_positions_regrid_is_proposed_only_if_they_are_rounded_even_ones(
    tmp_path: Path,
) -> None:
    doubled = X.copy()
    doubled[30] = doubled[29]
    path = write(
        tmp_path, [f"{x!r};{z!r}" for x, z in zip(doubled.tolist(), Z.tolist(), strict=True)]
    )
    for keys in ({}, {"regrid": True}):
        refused(path, "line 32", "1.45e-05 m is repeated", "keep only one point", **keys)
    coarse = write(tmp_path, [f"{round(0.7 * k)}e-6;{z!r}" for k, z in enumerate(Z[:36].tolist())])
    refused(coarse, "line 4", "regrid = true")
    assert contact.read_trace(coarse, regrid=True).x.size == 36


@pytest.mark.parametrize("down", [False, True])
def test_swapped_columns_are_refused_with_the_columns_to_write(tmp_path: Path, down: bool) -> None:
    swapped = [f"{z!r};{x!r}" for x, z in zip(X.tolist(), Z.tolist(), strict=True)]
    path = write(tmp_path, swapped[::-1] if down else swapped)
    refused(path, "columns = [1, 0]")
    assert contact.read_trace(path, columns=[1, 0]).heights == pytest.approx(Z)
    # Heights that only rise could also be positions. Only their size shows that the columns may
    # be swapped, so there is a warning.
    rising = write(
        tmp_path, [f"{z!r};{x!r}" for x, z in zip(X.tolist(), np.sort(Z).tolist(), strict=True)]
    )
    with pytest.warns(contact.ModelWarning, match="columns may be the other way round"):
        contact.read_trace(rising)


def test_a_trace_given_as_a_scene_and_a_scene_given_as_a_trace_are_refused_with_advice(
    tmp_path: Path,
) -> None:
    path = write(tmp_path, rows())
    assert "contact trace trace.txt --scene NEW.toml" in run("solve", path, status=2)
    run("trace", path, "--scene", tmp_path / "start.toml")
    assert "a file with the points" in run("trace", tmp_path / "start.toml", status=2)


def test_a_path_says_at_which_load_there_is_no_contact_and_what_is_missing(tmp_path: Path) -> None:
    run("trace", write(tmp_path, rows()), "--scene", tmp_path / "start.toml")
    assert "at the load 1e+09 N/m: " in run(
        "path", tmp_path / "start.toml", "--loads", "1,1e9", status=2
    )
    assert "--loads is missing" in run("path", tmp_path / "start.toml", status=2)
    compared = run("compare", tmp_path / "start.toml")
    assert "period = true" in compared
