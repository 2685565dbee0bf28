"""What a solution offers a notebook and a script: a figure, a table, a dataset, and the package its version."""

from __future__ import annotations

import re

import pytest

import contact
from contact.errors import MissingExtra

WAVE = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Periodic(), mean_pressure=1e8)
SCENES = {
    "wave": WAVE,
    "full": contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Periodic(), mean_pressure=1e10),
    "lone": contact.Scene(contact.Parabola(1e-2), 1e11, contact.Isolated(), load=1e4),
    "layer": contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Periodic(), substrate=contact.Layer(1e-4, 0.3), mean_pressure=1e7),
}


@pytest.mark.parametrize("name", SCENES)
def test_a_notebook_shows_the_numbers_and_the_figure(name):
    pytest.importorskip("matplotlib")
    solution = contact.solve(SCENES[name])
    page = solution._repr_html_()
    assert f"<td>{len(solution.zones)}</td>" in page and f"{solution.error:.1e}" in page and "data:image/png;base64," in page


def test_without_matplotlib_a_notebook_shows_the_numbers_and_what_to_install(monkeypatch):
    def missing(name):
        raise MissingExtra(f"{name} is needed: pip install 'sie-contact[plot]'")

    monkeypatch.setattr("contact.solution.plotting.require", missing)
    page = contact.solve(WAVE)._repr_html_()
    assert "stated error" in page and "sie-contact[plot]" in page and "<img" not in page


def test_a_figure_is_one_of_its_own():
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
    assert CliRunner().invoke(main, ["-h"]).exit_code == 0 and "solve" in CliRunner().invoke(main, ["solve", "-h"]).output
