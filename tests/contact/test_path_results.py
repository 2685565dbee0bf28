"""The figure, the table and the command of a load path agree with its solutions and events."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from functools import cache, lru_cache

import numpy as np
import pytest
from click.testing import CliRunner

import contact
from contact.commands import cli
from contact.sweeps.path_plot import plot_path
from contact.sweeps.path_report import value_columns
from contact.sweeps.path_table import Event
from contact.sweeps.points import NUMBERS, numbers

PAIR = contact.Scene(contact.Biquadratic(1.0, 0.1), 1.0, contact.Isolated(), load=1.0)
WAVE = contact.Scene(contact.Sinusoid(1e-2, 1.0), 1.0, contact.Periodic(), load=1.0)
TEXT = """
profile = {%s}
material = {E_star = 1.0}
interaction = {model = "%s"}
control = {load = 1.0}
"""
PAIR_TEXT = TEXT % ('shape = "biquadratic", radius = 1.0, spacing = 0.1', "isolated")
WAVE_TEXT = TEXT % ('shape = "sinusoid", amplitude = 0.01, period = 1.0', "periodic")
STICKY_TEXT = WAVE_TEXT + 'law = {model = "jkr", work = 1e-5}\n'
# Values of --loads that the command refuses: wrong syntax, bad numbers or counts, or equal
# ends.
NO_LOADS = [
    "1:2",
    "1:2:x",
    "1:2:1",
    "a:2:3",
    "1:2:3:lin",
    "0:2:3:log",
    "1:1:3",
    "1:2:3:log:4",
    "",
    ",",
    "nan",
    "1:inf:3",
    "0",
    "1:2:1e9",
]


@lru_cache
def loop(name):
    scene, loads = {
        "pair": (PAIR, [9e-4, 1e-3, 1.1e-3, 1e-3, 9e-4]),
        "wave": (WAVE, [0.025, 0.03, 0.035, 0.03, 0.025]),
    }[name]
    return contact.path(scene, loads)


def run(text, *arguments):
    return CliRunner().invoke(
        cli.main, ["path", "-", *(str(argument) for argument in arguments)], input=text
    )


def test_each_event_is_listed_at_the_first_load_after_it():
    found = loop("pair")
    assert [[e.kind for e in since] for since in found.passed] == [[], ["merge"], [], [], ["split"]]
    assert [e.kind for e in found.events] == ["merge", "split"]


def test_rows_of_the_table_have_the_numbers_of_the_solutions(tmp_path):
    found = loop("wave")
    found.save(tmp_path / "path.csv")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "path.csv").read_text())))
    assert list(rows[0]) == [*NUMBERS, "events"]
    for row, solution in zip(rows, found.solutions, strict=True):
        assert [float(row[name]) for name in NUMBERS] == list(numbers(solution).values())
    kind, load, _ = rows[2]["events"].split()
    assert (
        kind == "full"
        and float(load) == pytest.approx(np.pi * 1e-2, rel=1e-12)
        and rows[1]["events"] == ""
    )


def test_undefined_numbers_are_nan_in_python_and_null_in_json(tmp_path):
    found = loop("pair")
    found.save(tmp_path / "path.json")
    points = json.loads((tmp_path / "path.json").read_text())["points"]
    assert points["approach"] == [None] * 5 and points["zone_count"] == [2, 1, 1, 1, 2]
    assert np.isnan(numbers(found.solutions[0])["mean_pressure"])
    with pytest.raises(contact.SceneError, match="overwrite=True"):
        found.save(tmp_path / "path.json")
    with pytest.raises(contact.SceneError, match=r"\.csv or \.json"):
        found.save(tmp_path / "path.txt")


def test_the_figure_has_contact_and_approach_and_a_line_for_each_event():
    pytest.importorskip("matplotlib")
    figure = loop("wave").plot()
    area, approach = figure.axes
    full = np.pi * 1e-2 * 1e3  # in mN/m
    for axes in (area, approach):
        lines = [
            line
            for line in axes.lines
            if len(line.get_xdata()) == 2 and np.ptp(np.asarray(line.get_xdata(), float)) == 0
        ]
        assert [line.get_xdata()[0] for line in lines] == pytest.approx([full, full], rel=1e-9)
    (rising,) = (line for line in area.lines if line.get_label() == "load rising")
    # The load of full contact is an additional point of the line.
    fractions = [s.contact_fraction for s in loop("wave").solutions]
    assert rising.get_ydata() == pytest.approx([*fractions[:2], 1.0, fractions[2]])
    assert rising.get_xdata()[2] == pytest.approx(full, rel=1e-9)
    assert len(loop("pair").plot().axes) == 1


def test_marks_of_many_events_are_small_and_counted_and_do_not_hide_each_other():
    pytest.importorskip("matplotlib")
    kinds, back = 9 * ["birth", "merge"], {"birth": "death", "merge": "split"}
    none = np.zeros((0, 2))
    up = [Event(kinds[k], 2e-3 + 5e-4 * k, 0.0, none, none) for k in range(len(kinds))]
    down = [Event(back[e.kind], e.load, 0.0, none, none) for e in reversed(up)]
    figure = plot_path(contact.solve_many(WAVE, [1e-3, 2e-2, 1e-3], "load"), ((), up, down))
    kinds += [event.kind for event in down]
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {f"{kind} ({kinds.count(kind)})" for kind in set(kinds)} < set(names)
    for axes in figure.axes:
        marks = {
            line.get_label().split()[0]: line for line in axes.lines if line.get_marker() != "None"
        }
        for over, under in (("split", "merge"), ("death", "birth")):
            assert marks[over].get_markerfacecolor() == "none"
            assert marks[over].get_markersize() > marks[under].get_markersize()
        ticks = [line.get_ydata()[1] for line in axes.lines if line.get_label().startswith("_")]
        assert len(ticks) == len(kinds) and max(ticks) < 0.1


def test_a_path_is_drawn_on_the_given_axes():
    pyplot = pytest.importorskip("matplotlib.figure")
    figure = pyplot.Figure()
    axes = figure.subplots(1, 2)
    assert loop("wave").plot(axes) is figure and loop("wave").plot(axes[0]) is figure
    for wrong in ("axes", [1, 2], [*axes, axes[0]]):
        with pytest.raises(contact.SceneError, match="ax"):
            loop("wave").plot(wrong)
    with pytest.raises(contact.SceneError, match="no approach"):
        loop("pair").plot(axes)


def test_the_command_unloads_with_back_and_prints_points_and_events(tmp_path):
    done = run(WAVE_TEXT, "--loads", "0:3.6e-2:4", "--back", "--json")
    assert done.exit_code == 0, done.output
    read = json.loads(done.stdout)
    assert read["points"]["load"] == pytest.approx([0.012, 0.024, 0.036, 0.024, 0.012])
    assert [
        (e["kind"], e["point"], e["zones_before"], e["zones_after"]) for e in read["events"]
    ] == [("full", 2, 1, 0), ("full", 3, 0, 1)]
    assert set(read["units"]) == {*NUMBERS, "position"} and "control" not in read["scene"]


def test_the_printed_table_has_one_unit_per_column_and_fits_in_80_columns():
    told = run(WAVE_TEXT, "--loads", "1e-6:3e-2:7:log", "--no-events").stdout
    assert max(len(line.rstrip()) for line in told.splitlines()) <= 80
    rows = [
        line.split()
        for line in told.splitlines()
        if line.split()[-1:] and line.split()[-1].count("e-") == 1
    ]
    assert len(rows) == 7 and all(len(row) == 9 for row in rows)
    assert told.count("[mN/m]") == 1
    assert "full contact" in run(WAVE_TEXT, "--loads", "3e-2,3.2e-2").stdout


def test_without_events_the_solutions_are_those_of_solve_many(monkeypatch):
    monkeypatch.setattr(
        "contact.commands.path.path", lambda *a, **k: pytest.fail("events looked for")
    )
    read = json.loads(run(PAIR_TEXT, "--loads", "5e-4,2e-3", "--no-events", "--json").stdout)
    assert read["events"] == [] and read["points"]["zone_count"] == [2, 1]
    assert read["points"]["load"] == [s.load for s in contact.solve_many(PAIR, [5e-4, 2e-3])]
    by_two = json.loads(
        run(PAIR_TEXT, "--loads", "5e-4:2e-3:4", "--no-events", "--json", "--workers", "2").stdout
    )
    assert by_two["points"]["load"] == pytest.approx([5e-4, 1e-3, 1.5e-3, 2e-3])


@pytest.mark.parametrize("loads", NO_LOADS)
def test_invalid_loads_are_refused_with_the_name_of_the_option(loads):
    refused = run(WAVE_TEXT, "--loads", loads)
    assert (
        refused.exit_code == 2
        and refused.stdout == ""
        and refused.stderr.startswith("contact: --loads = ")
    )
    assert refused.stderr.count("\n") == 1


def test_a_negative_load_an_existing_file_and_an_unknown_format_are_refused(tmp_path):
    (tmp_path / "out.csv").write_text("mine")
    assert "loads" in run(WAVE_TEXT, "--loads", "-1:1:3").stderr
    assert "--overwrite" in run(WAVE_TEXT, "--loads", "1:2:3", "--csv", tmp_path / "out.csv").stderr
    assert "--plot" in run(WAVE_TEXT, "--loads", "1:2:3", "--plot", tmp_path / "out.what").stderr


@pytest.mark.parametrize("more", [(), ("--no-events",)])
@pytest.mark.parametrize(("loads", "back"), [("1e-3:2e-3:3", "--back"), ("2e-3,1e-3", "-q")])
def test_falling_loads_are_refused_for_a_plastic_law(loads, back, more):
    text = WAVE_TEXT + 'law = {model = "plastic", hardness = 2.0}\n'
    said = run(text, "--loads", loads, back, *more)
    assert said.exit_code == 2 and "Solution.worn()" in said.stderr
    assert said.stderr.startswith(f"contact: {'--back' if back == '--back' else '--loads'} = ")


def test_the_quiet_command_writes_its_files_and_prints_nothing(tmp_path):
    pytest.importorskip("matplotlib")
    done = run(
        WAVE_TEXT,
        "--loads",
        "1e-2,2e-2",
        "-q",
        "--csv",
        tmp_path / "out.csv",
        "--plot",
        tmp_path / "out.png",
    )
    assert (done.exit_code, done.output) == (0, "")
    assert (tmp_path / "out.csv").read_text().count("\n") == 3 and (
        tmp_path / "out.png"
    ).read_bytes().startswith(b"\x89PNG")


def test_a_loop_with_adhesion_states_its_dissipated_energy_and_is_drawn(tmp_path):
    pytest.importorskip("matplotlib")
    arguments = ["--loads=-1.5e-3,1e-3", "--back"]
    read = json.loads(
        run(STICKY_TEXT, *arguments, "--json", "--plot", tmp_path / "loop.png").stdout
    )
    assert [e["kind"] for e in read["events"]] == ["jump-in", "pull-off"]
    assert read["dissipated"] == pytest.approx(sum(e["lost"] for e in read["events"])) and read[
        "work"
    ] == pytest.approx(read["dissipated"])
    assert (tmp_path / "loop.png").stat().st_size > 10_000
    assert (
        read["points"]["zone_count"][0]
        == read["points"]["zone_count"][-1]
        == read["points"]["total_width"][0]
        == 0
    )
    told = run(STICKY_TEXT, *arguments).stdout
    assert "apart to 1" in told and "1 to apart" in told and "energy lost in all jumps" in told


def test_exactly_one_of_loads_mean_pressures_and_approaches_is_accepted():
    by_pressure = json.loads(run(WAVE_TEXT, "--pressures", "1e-2,1.1e-2", "--json").stdout)
    assert by_pressure["points"]["mean_pressure"] == pytest.approx([1e-2, 1.1e-2])
    by_approach = json.loads(run(STICKY_TEXT, "--approaches", "1e-3,2e-3", "--json").stdout)
    assert (
        by_approach["points"]["approach"] == pytest.approx([1e-3, 2e-3])
        and by_approach["control"] == "approach"
    )
    for text, arguments, told in (
        (WAVE_TEXT, [], "--loads"), (WAVE_TEXT, ["--loads", "1,2", "--pressures", "1,2"], "--loads and --pressures"),
        (WAVE_TEXT, ["--approaches", "1e-3,2e-3"], "approach"), (STICKY_TEXT, ["--loads", "1e-3,2e-3", "--no-events"], "--no-events"),
        (STICKY_TEXT, ["--loads", "1e-3,2e-3", "--stiffness", "1"], "stiffness"),
        (WAVE_TEXT, ["--loads", "1e-3,2e-3", "--workers", "2"], "--no-events"),
    ):  # fmt: skip
        refused = run(text, *arguments)
        assert refused.exit_code == 2 and told in refused.stderr and refused.stderr.count("\n") == 1


STICKY = contact.Scene(
    contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), law=contact.JKR(0.05), load=0.0
)
PATHS = {
    "pair": lambda: loop("pair"),
    "wave": lambda: loop("wave"),
    "plastic": lambda: contact.path(
        replace(WAVE, E_star=1e9, law=contact.Plastic(2e7)), [1e4, 1e7, 1.5e7]
    ),
    "load": lambda: contact.path(STICKY, [-200.0, 500.0, -200.0]),
    "mean_pressure": lambda: contact.path(STICKY, [-2e6, 5e6, -2e6], control="mean_pressure"),
    "approach": lambda: contact.path(STICKY, [-1e-6, 1e-7, -1e-6], control="approach"),
    "spring": lambda: contact.path(
        STICKY, [-1.2345e-6, 1e-7, -1e-6], control="approach", stiffness=1e9
    ),
}


@cache
def printed(name):
    return PATHS[name]()


@pytest.mark.parametrize("name", PATHS)
def test_a_path_prints_a_row_for_each_value_and_each_event_in_80_columns(name):
    found = printed(name)
    lines = str(found).splitlines()
    assert max(map(len, lines)) <= 80
    values, events = "\n".join(lines[2:]).split("\n\n")
    rows = [line.split() for line in values.splitlines() if line.split()[0][-1].isdigit()]
    zones = ["full" if s.contact_fraction else "apart" for s in found.solutions]
    zones = [str(len(s.zones) or text) for s, text in zip(found.solutions, zones, strict=True)]
    assert [row[-2] for row in rows] == zones
    kinds = [line.split()[0] for line in events.splitlines()[1:] if "lost in all" not in line]
    assert kinds == [event.kind for event in found.events] != []
    assert len(repr(found)) < 120 and str(len(found.solutions)) in repr(found)


@pytest.mark.parametrize("name", ["load", "mean_pressure", "approach", "spring"])
def test_separated_surfaces_are_named_and_the_given_value_is_in_their_row(name):
    found = printed(name)
    table = value_columns(found)
    header, cells = table["far_end" if name == "spring" else name]
    given, zones = np.array(cells, dtype=float), table["zone_count"][1]
    assert given == pytest.approx(found.values * given[0] / found.values[0], rel=1e-3)
    assert zones[0] == zones[-1] == "apart" and zones[1] == "1" and "[" in header


def test_an_event_prints_in_one_line_with_units_and_has_plain_numbers():
    for name in PATHS:
        for event in printed(name).events:
            (line,) = str(event).splitlines()
            assert line.startswith(f"{event.kind} at ") and event.change() in line
            assert "N/m" in line and (getattr(event, "lost", None) is None or "J/m" in line)
            assert type(event.load) is type(event.position) is float
            assert event.error is None or type(event.error) is float
    last = printed("load").solutions[1].pull_off
    assert "N/m" in repr(last) and "0x" not in repr(last)
