"""The figure of a sweep: its lines show the table's numbers, in the units of the labels."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner

import contact
from contact.commands import cli

pytest.importorskip("xarray")
pytest.importorskip("h5netcdf")
pytest.importorskip("matplotlib")
figures = pytest.importorskip("contact.sweeps.sweep.figure")

WAVE = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Periodic(), mean_pressure=1e9)
PRESSURES = [1e7, 1e8, 1e9]
GRID = {"profile.amplitude": [1e-6, 2e-7], "control.mean_pressure": PRESSURES}
TEXT = """
profile = {shape = "sinusoid", amplitude = 1e-6, period = 1e-4}
material = {E_star = 1e11}
interaction = {model = "periodic"}
control = {mean_pressure = 1e9}
"""


@pytest.fixture(scope="module")
def table():
    return contact.sweep(WAVE, GRID, workers=1)


def test_each_panel_has_a_line_of_the_table_for_each_value_of_the_second_key(table):
    pressure, fraction = figures.plot_sweep(table).axes
    assert pressure.get_xlabel() == "mean pressure [MPa]"
    assert pressure.get_ylabel() == "largest pressure [MPa]"
    assert fraction.get_ylabel() == "contact fraction"
    for axes, name, factor in (
        (pressure, "max_pressure", 1e-6),
        (fraction, "contact_fraction", 1.0),
    ):
        assert axes.get_xscale() == axes.get_yscale() == "log"
        for line, amplitude in zip(axes.get_lines(), GRID["profile.amplitude"], strict=True):
            values = table[name].sel(profile_amplitude=amplitude).values
            np.testing.assert_allclose(line.get_ydata(), factor * values, rtol=1e-12)
            np.testing.assert_allclose(line.get_xdata(), 1e-6 * np.array(PRESSURES), rtol=1e-12)
            (low, high), data = axes.get_ylim(), line.get_ydata()
            assert low <= data.min() and data.max() <= high


def test_lines_differ_in_dashes_and_marks_and_are_named_in_one_unit(table):
    figure = figures.plot_sweep(table, ["approach"])
    (axes,) = figure.axes
    looks = {(line.get_linestyle(), line.get_marker()) for line in axes.get_lines()}
    assert len(looks) == 2 and axes.get_ylabel() == "approach [nm]"
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["amplitude 1 µm", "amplitude 0.2 µm"]


def test_a_long_legend_is_within_the_picture():
    over = {
        "profile.amplitude": [1e-6, 1.234e-6, 2e-6, 3.3e-6],
        "control.mean_pressure": [1e7, 1e8, 3e8, 6e8, 1e9],
    }
    figure = figures.plot_sweep(contact.sweep(WAVE, over, workers=1), ["approach"])
    figure.canvas.draw()
    box = figure.legends[0].get_window_extent()
    assert len(figure.legends) == 1 and len(figure.legends[0].get_texts()) == 4
    assert 0 <= box.x0 and box.x1 <= figure.bbox.width


def test_each_word_has_a_line_and_failed_points_are_missing_and_counted():
    over = {
        "interaction.closure": ["first-order", "self-consistent"],
        "control.load": [1e-6, 1.0, 1e9],
    }
    local = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Localized(), load=1.0)
    with pytest.warns(contact.ModelWarning):
        table = contact.sweep(local, over, workers=1)
    figure = figures.plot_sweep(table, ["max_pressure"])
    lines = figure.axes[0].get_lines()
    assert [line.get_label() for line in lines] == [
        f"closure {name}" for name in over["interaction.closure"]
    ]
    failed = int(table.failed.sum())
    assert failed == sum(int(np.isnan(line.get_ydata()).sum()) for line in lines) > 0
    assert f"{failed} of 6 points failed" in figure.get_supxlabel()


def test_the_command_draws_the_figure_and_refuses_wrong_options_before_solving(
    tmp_path, monkeypatch
):
    def run(*arguments):
        return CliRunner().invoke(cli.main, ["sweep", "-", *map(str, arguments)], input=TEXT)

    pressures = "control.mean_pressure=1e8,1e9"
    out, picture = tmp_path / "out.nc", tmp_path / "out.png"
    done = run("--vary", pressures, "--out", out, "--workers", 1, "--plot", picture)
    assert done.exit_code == 0 and f"written: {picture}" in done.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    monkeypatch.setattr("contact.commands.sweep.sweep", lambda *a, **k: pytest.fail("solved"))
    two = ("--vary", "profile.amplitude=1e-6,2e-6", "--vary", "profile.period=1e-4,2e-4")
    for arguments, said in (
        ((*two, "--plot", picture), "--plot"),
        (("--plot", tmp_path / "out.what"), "--plot"),
        (("--show", "approach"), "--show"),
        (("--show", "approaches", "--plot", picture), "approaches"),
    ):
        refused = run("--vary", pressures, "--out", out, *arguments)
        assert refused.exception is not None and said in str(refused.exception) + refused.stderr
