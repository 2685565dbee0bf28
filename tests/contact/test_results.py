"""Outputs of a solution: notebook page, figure, data set, tables and files; the version."""

from __future__ import annotations

import json
import re
import sys

import numpy as np
import pytest

import contact
from contact.errors import MissingExtra
from contact.solution import export

WAVE = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Periodic(), mean_pressure=1e8)
SCENES = {
    "wave": WAVE,
    "full": contact.Scene(
        contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Periodic(), mean_pressure=1e10
    ),
    "lone": contact.Scene(contact.Parabola(1e-2), 1e11, contact.Isolated(), load=1e4),
    "layer": contact.Scene(
        contact.Sinusoid(1e-6, 1e-4),
        1e11,
        contact.Periodic(),
        substrate=contact.Layer(1e-4, 0.3),
        mean_pressure=1e7,
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_a_notebook_shows_the_numbers_and_the_figure(name):
    pytest.importorskip("matplotlib")
    solution = contact.solve(SCENES[name])
    page = solution._repr_html_()
    assert (
        f"<td>{len(solution.zones) or 'full contact'}</td>" in page
        and f"<td>{solution.error:.2g}</td>" in page
        and "data:image/png;base64," in page
    )


def test_without_matplotlib_a_notebook_shows_the_numbers_and_what_to_install(monkeypatch):
    def missing(name):
        raise MissingExtra(f"{name} is needed: pip install 'sie-contact[plot]'")

    monkeypatch.setattr("contact.solution.drawing.require", missing)
    page = contact.solve(WAVE)._repr_html_()
    assert "largest pressure" in page and "sie-contact[plot]" in page and "<img" not in page


def test_each_plot_is_a_new_figure():
    figures = pytest.importorskip("matplotlib.figure")
    solution = contact.solve(WAVE)
    assert isinstance(solution.plot(), figures.Figure) and solution.plot() is not solution.plot()


def test_a_dataset_has_the_zones_and_their_units():
    pytest.importorskip("xarray")
    solution = contact.solve(WAVE)
    data = solution.to_dataset()
    assert any(data[name].attrs.get("units") == "Pa" for name in data.data_vars)
    assert float(data["pressure"].max()) <= solution.max_pressure * (1 + 1e-12)


def test_the_package_says_its_version_and_what_is_public():
    assert re.fullmatch(r"\d+\.\d+\.\d+\S*", contact.__version__)
    assert dir(contact) == sorted([*contact.__all__, "__version__"])
    with pytest.raises(AttributeError, match="no attribute 'wedge'"):
        contact.wedge  # noqa: B018


def test_the_command_says_its_version_and_helps():
    from click.testing import CliRunner

    from contact.commands.cli import main

    told = CliRunner().invoke(main, ["--version"])
    assert told.exit_code == 0 and told.output.strip() == f"contact {contact.__version__}"
    assert (
        CliRunner().invoke(main, ["-h"]).exit_code == 0
        and "solve" in CliRunner().invoke(main, ["solve", "-h"]).output
    )


PAIR = contact.Scene(contact.Biquadratic(1.0, 0.1), 1.0, contact.Isolated(), load=3e-4)
PUNCH = contact.Scene(contact.Flat(0.5, 1.0), 1.0, contact.Periodic(), load=1e-3)
ROUGH = contact.self_affine(hurst=0.8, period=1e-3, shortest=2e-5, rms_slope=0.01, seed=3)
TRACE = contact.Scene(ROUGH, 1e9, contact.Periodic(), mean_pressure=1e6)


@pytest.mark.parametrize("scene", [WAVE, PAIR, TRACE], ids=["wave", "pair", "trace"])
def test_zone_peaks_are_the_largest_pressures_of_the_zones_and_of_the_solution(scene):
    solution = contact.solve(scene)
    assert solution.zone_peaks.max() == pytest.approx(solution.max_pressure, rel=1e-9)
    t = np.sin(np.linspace(-0.5, 0.5, 801) * np.pi)
    for zone, peak in enumerate(solution.zone_peaks):
        sampled = solution.pressure_at(t, zone).max()
        assert sampled <= peak * (1 + 1e-9) and peak <= 1.001 * sampled


def test_a_peak_under_a_corner_or_a_tip_is_infinite_and_full_contact_has_none():
    assert contact.solve(PUNCH).zone_peaks.tolist() == [np.inf]
    wedge = contact.Scene(contact.Wedge(0.1), 1.0, contact.Isolated(), load=1e-3)
    assert contact.solve(wedge).zone_peaks.tolist() == [np.inf]
    assert contact.solve(SCENES["full"]).zone_peaks.shape == (0,)


def test_a_table_of_the_zones_has_a_row_a_zone_and_units():
    solution = contact.solve(PAIR)
    table = solution.zone_table()
    assert tuple(table) == export.ZONE_COLUMNS == tuple(table.attrs["units"])
    assert np.array_equal(table["load"], solution.zone_loads)
    assert np.array_equal(table["max_pressure"], solution.zone_peaks)
    assert contact.solve(SCENES["full"]).zone_table().shape == (0, len(export.ZONE_COLUMNS))


def test_without_pandas_a_table_of_the_zones_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(MissingExtra, match=r"pandas.*\[io\]"):
        contact.solve(PAIR).zone_table()


def test_a_saved_solution_names_its_scene_its_units_and_the_version(tmp_path):
    solution = contact.solve(WAVE)
    solution.save(tmp_path / "wave.json")
    read = json.loads((tmp_path / "wave.json").read_text())
    assert read["version"] == contact.__version__ and read["scene"] == export.describe(WAVE)
    assert (
        set(read["units"]) <= set(read)
        and read["units"]["zone_peaks"] == "Pa"
        and read["trace"] is None
    )
    pytest.importorskip("h5py")
    xarray = pytest.importorskip("xarray")
    solution.save(tmp_path / "wave.nc")
    with xarray.open_dataset(tmp_path / "wave.nc", engine="h5netcdf") as data:
        assert data.attrs["version"] == contact.__version__ and json.loads(
            data.attrs["scene"]
        ) == export.describe(WAVE)
        assert np.array_equal(data.zone_peak, solution.zone_peaks)
        assert json.loads(data.attrs["units"])["stiffness"] == "N/m^2"


def test_a_written_solution_describes_its_measured_trace():
    x = np.linspace(0.0, 1e-3, 65)
    trace = contact.Scene(
        contact.Sampled(x, 1e-6 * np.cos(2e3 * np.pi * x), 1e-3), 1e9, contact.Periodic(), load=1.0
    )
    told = contact.solve(trace).to_dict()["trace"]
    assert (
        told["points"] == 64
        and told["history"] == []
        and told["Rq"] == pytest.approx(1e-6 / np.sqrt(2), rel=1e-4)
    )


@pytest.mark.parametrize("write", ["save", "save_zones", "save_fields"])
def test_an_existing_file_is_overwritten_only_on_request(tmp_path, write):
    path = tmp_path / ("out.json" if write == "save" else "out.csv")
    path.write_text("mine")
    solution = contact.solve(WAVE)
    with pytest.raises(contact.SceneError, match=r"out\..*overwrite=True"):
        getattr(solution, write)(path)
    assert path.read_text() == "mine"
    getattr(solution, write)(path, overwrite=True)
    assert path.read_text() != "mine"


@pytest.mark.parametrize("path", ["out.xyz", "out", "none/out.json", ".", None, 3])
def test_an_invalid_file_name_is_refused(tmp_path, monkeypatch, path):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(contact.SceneError, match="path"):
        contact.solve(WAVE).save(path)


def test_saved_fields_read_back_and_their_pressure_makes_the_load(tmp_path):
    solution = contact.solve(WAVE)
    solution.save_fields(tmp_path / "fields.csv")
    table = np.genfromtxt(tmp_path / "fields.csv", delimiter=",", names=True)
    assert table.dtype.names == export.FIELD_COLUMNS
    # The positions are about a hundredth of a zone apart, and closer at its ends. So the
    # trapezoidal rule has an error of about 1e-3.
    assert np.trapezoid(table["pressure"], table["x"]) == pytest.approx(solution.load, rel=1e-3)
    assert np.array_equal(table["gap"], solution.gap(table["x"]))
