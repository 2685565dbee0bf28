"""`contact stress` and its figures: printed lines, files, drawings and refusals."""

import json

import numpy as np
import pytest

import contact

pytest.importorskip("click")
pytest.importorskip("rich")
pytest.importorskip("matplotlib")

from click.testing import CliRunner  # noqa: E402

from contact.commands import cli  # noqa: E402
from contact.solution.stress_plot import SHOWN, plot_stress  # noqa: E402
from contact.solution.stress_report import stress_report  # noqa: E402
from tests.tiers import quick  # noqa: E402

SCENE = """
[profile]
shape = "parabola"
radius = 1.0
[material]
E_star = 1e9
[interaction]
model = "isolated"
[control]
load = 1e3
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return str(path)


def run(*arguments):
    return CliRunner().invoke(cli.main, arguments)


def test_the_command_says_where_a_cylinder_is_stressed_most_and_yields(scene):
    found = json.loads(run("stress", scene, "--strength", "1e6", "--json").stdout)
    peak = np.sqrt(1e3 * 1e9 / np.pi)
    assert found["largest_shear"]["stress"] == pytest.approx(0.3002831060 * peak, rel=1e-9)
    assert found["largest_mises"]["stress"] == pytest.approx(0.5575162162 * peak, rel=1e-9)
    assert found["first_yield"]["load"] == pytest.approx(
        np.pi * (1e6 / 0.5575162162) ** 2 / 1e9, rel=1e-8
    )
    printed = run("stress", scene, "--strength", "1e6")
    assert printed.exit_code == 0
    assert "largest shear stress" in printed.stdout
    assert "first yield at the load" in printed.stdout


def test_the_stresses_are_printed_even_if_there_is_no_first_yield(tmp_path):
    path = tmp_path / "scene.toml"
    shape = SCENE.replace('"parabola"', '"sinusoid"').replace("radius = 1.0", "amplitude = 1e-6")
    shape = shape.replace("[material]", "period = 1e-4\n[material]").replace("isolated", "periodic")
    path.write_text(shape)
    out = tmp_path / "out.json"
    arguments = ("stress", str(path), "--nu", "0.5", "--strength", "5e7", "--save", str(out))
    printed = run(*arguments, "--plot", str(tmp_path / "out.png"))
    assert printed.exit_code == 0
    assert "largest shear stress" in printed.stdout and "not found" in printed.stdout
    for text in (run(*arguments[:-2], "--json").stdout, out.read_text()):
        found = json.loads(text)
        assert found["largest_mises"]["stress"] > 0
        assert found["first_yield"]["load"] is None
        assert "no longer grows" in found["first_yield"]["note"]


@pytest.mark.slow
def test_stresses_are_written_as_netcdf(scene, tmp_path):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    out = tmp_path / "stress.nc"
    assert run("stress", scene, "--save", str(out), "-q").exit_code == 0
    with xarray.open_dataset(out) as data:
        solution = contact.solve(contact.load_scene(scene))
        stress = solution.stress(data.x.values, data.y.values[:, None])
        assert np.array_equal(data.xx.values, stress.xx)
        assert np.array_equal(data.shear.values, stress.shear)


@pytest.mark.parametrize("show", quick(SHOWN, ["mises"]))
def test_a_figure_has_depth_downwards_and_the_place_of_the_largest_stress(show):
    solution = contact.solve(
        contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), load=1e3)
    )
    figure = plot_stress(stress_report(solution, strength=5e5), show)
    above, below = figure.axes[:2]
    assert below.get_ylim()[0] > 0.0 == below.get_ylim()[1]
    assert above.get_xlim() == below.get_xlim()
    (mark,) = (line for line in below.lines if line.get_marker() == "x")
    depth = 0.7042916846 if show == "mises" else 0.7861513778
    half = 1e3 * solution.zones[0, 1]
    assert mark.get_ydata()[0] == pytest.approx(depth * half, rel=1e-5)
    assert abs(mark.get_xdata()[0]) < 1e-6 * half


def test_stresses_at_sharp_corners_are_drawn_and_reported_as_infinite():
    row = contact.Scene(contact.Flat(0.4, 1.0), 1e9, contact.Periodic(), mean_pressure=1e5)
    report = stress_report(contact.solve(row), strength=1e6)
    assert report.shear is None and report.mises is None
    assert report.to_dict()["first_yield"]["load"] == 0.0
    title = plot_stress(report).get_suptitle()
    assert "infinite" in title


def test_a_narrow_zone_with_the_largest_stress_has_its_own_column_in_the_figure():
    x = np.arange(400) / 400
    heights = 1e-4 * (np.cos(2 * np.pi * x) + 0.5 * np.cos(34 * np.pi * x + 1.0))
    scene = contact.Scene(contact.Sampled(x, heights, 1.0), 1e9, contact.Periodic(), load=2e3)
    figure = plot_stress(stress_report(contact.solve(scene)))
    titles = [axes.get_title() for axes in figure.axes]
    assert "around the largest stress" in titles


def test_wrong_options_are_refused_by_name(scene, tmp_path):
    for arguments, said in (
        (("--nu", "0.7"), "nu = 0.7 is refused"),
        (("--strength", "-1"), "strength = -1.0 is refused"),
        (("--plot", str(tmp_path / "out.xyz")), "--plot"),
        (("--show", "shears"), "shears"),
    ):
        found = run("stress", scene, *arguments)
        assert found.exit_code == 2
        assert said in found.stderr


def test_missing_netcdf_packages_are_reported_before_the_solve(scene, tmp_path, monkeypatch):
    def missing(name):
        raise contact.MissingExtra(f"{name}: pip install 'sie-contact[io]'")

    def solved(*_, **__):
        raise AssertionError("solved before the packages were asked for")

    monkeypatch.setattr("contact.commands.options.require", missing)
    monkeypatch.setattr("contact.commands.stress.solve", solved)
    done = run("stress", scene, "--save", str(tmp_path / "out.nc"))
    assert done.exit_code == 2
    assert "sie-contact[io]" in done.stderr
