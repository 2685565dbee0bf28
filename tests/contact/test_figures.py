"""The figures of the paper are drawn, and their numbers are in CSV files.
The numbers agree with the statements of docs/paper.
"""

from __future__ import annotations

import csv
import warnings

import numpy as np
import pytest
from click.testing import CliRunner

import contact
from contact import paper
from contact.commands.cli import main
from contact.reference import exact

pytest.importorskip("matplotlib")
figures = pytest.importorskip("contact.paper.figures")


@pytest.fixture(scope="module")
def made():
    """Function that returns a figure by its number; each figure is made once."""
    kept = {}

    def of(number):
        if number not in kept:
            kept[number] = figures.FIGURES[number]()
        return kept[number]

    return of


def column(figure, *words):
    """The only column whose name contains all words."""
    names = [name for name in figure.columns if all(word in name for word in words)]
    assert len(names) == 1, names
    return figure.columns[names[0]]


# Making one of these figures takes seconds.
LONG = ("2B", "8", "10", "12", "13")
EVERY = [pytest.param(n, marks=pytest.mark.slow if n in LONG else ()) for n in figures.FIGURES]


@pytest.mark.parametrize("number", EVERY)
def test_a_figure_is_a_picture_and_its_numbers(number, made, tmp_path):
    picture, numbers = made(number).write(tmp_path / "new")
    assert picture.read_bytes().startswith(b"\x89PNG") and picture.stat().st_size > 10_000
    lines = numbers.read_text(encoding="utf-8").splitlines()
    head = [line for line in lines if line.startswith("#")]
    assert head[0] == f"# Figure {number}. {made(number).title}" and len(head) > 2
    names, *rows = csv.reader(lines[len(head) :])
    assert names == list(made(number).columns)
    read = np.array([[float(word or "nan") for word in row] for row in rows])
    np.testing.assert_allclose(
        read, np.column_stack(list(made(number).columns.values())), rtol=1e-11
    )


@pytest.mark.parametrize("number", EVERY)
def test_every_curve_has_numbers_and_no_pressure_is_negative(number, made):
    for name, values in made(number).columns.items():
        if number == "2A" and name == "p/E* all neighbours l/R=0.2":
            assert np.isnan(values).all()  # the spots would overlap
            continue
        assert np.isfinite(values).any(), name
        assert not name.startswith(("p/", "max", "mean")) or np.nanmin(values) >= 0, name


def test_figures_7_and_9_are_the_closed_forms(made):
    for number, form, shape, unit in (
        ("7", paper.localized_wave, {"amplitude": 0.01}, np.pi * 0.01),
        ("9", paper.localized_wedge, {"wedge_slope": 0.01}, 0.01),
    ):
        x = column(made(number), "x/L")
        away = np.abs(x) > 1e-3
        for fraction in (0.4, 0.7):
            closed = form(period=1.0, E_star=1.0, half_width=0.5 * fraction, **shape)
            drawn = column(made(number), "first-order", f"={fraction}") * unit
            np.testing.assert_allclose(drawn[away], closed.pressure(x)[away], atol=1e-9 * unit)
            drawn = column(made(number), "exact", f"={fraction}") * unit
            np.testing.assert_allclose(
                drawn[away], closed.exact.pressure(x)[away], atol=1e-9 * unit
            )


@pytest.mark.slow
def test_figure_8_has_the_first_order_maximum_and_the_end_of_the_isolated_wave(made):
    fraction, first = column(made("8"), "2a/L"), column(made("8"), "mean", "first-order")
    assert fraction[np.nanargmax(first)] == pytest.approx(0.88, abs=0.011)  # a/L near 0.44
    alone = column(made("8"), "mean", "isolated")
    # By (20)-(22), p > 0 up to a/L = 0.3827. But from a/L = 0.304 on, the isolated wave would
    # overlap the other surface at its valley.
    assert fraction[np.isfinite(alone)].max() == pytest.approx(0.6)
    gap = [float(exact.IsolatedSinusoid(0.01, 1.0, 1.0, a).gap(0.5)) for a in (0.303, 0.305)]
    assert gap[0] > 0 > gap[1]
    true = column(made("8"), "mean", "exact")
    np.testing.assert_allclose(true, np.sin(0.5 * np.pi * fraction) ** 2, rtol=1e-9)


@pytest.mark.slow
def test_figures_10_and_12_overestimate_the_width_beyond_seven_tenths(made):
    for number, share in (("10", "2a/L"), ("12", "a/L")):
        at = column(
            made(number), *([share] if number == "10" else []), *([] if number == "10" else ["a/L"])
        )
        true, first = column(made(number), "exact"), column(made(number), "first-order")
        beyond = at > (0.7 if number == "10" else 0.35)
        assert np.all(first[beyond] < true[beyond])


def test_figure_11_has_the_exact_pressure_of_the_closed_form(made):
    x = column(made("11"), "x/L")
    for mean in (0.05, 0.15):
        closed = exact.PeriodicParabola.from_mean_pressure(mean, period=1.0, radius=1.0, E_star=1.0)
        drawn = column(made("11"), "exact", f"mean={mean}")
        # Near an end, the pressure at a fixed x changes by the square root of the error of the
        # end.
        np.testing.assert_allclose(drawn, closed.pressure(x), atol=1e-5 * closed.max_pressure)
        assert np.max(drawn) > np.max(column(made("11"), "isolated", f"mean={mean}"))


@pytest.mark.slow
def test_figure_13_orders_the_pairs_by_how_far_they_are_from_the_exact_one(made):
    true = column(made("13"), "exact")
    names = ("cut", "artanh", "cubic", "printed")
    off = [np.max(np.abs(column(made("13"), name) - true)) for name in names]
    assert np.all(np.diff(off) > 0)
    assert (
        np.max(true) < np.max(column(made("13"), "alone")) < np.max(column(made("13"), "printed"))
    )


def test_figure_2_reads_the_caption_as_a_load_per_spot(made):
    notes = "\n".join(made("2A").notes)
    for spacing, ratio in (("1.0", "0.2434"), ("0.25", "0.8443"), ("0.2", "0.9331")):
        assert f"(1)-(4), l/R = {spacing}: " in notes and f"a/A = {ratio}" in notes
    r = column(made("2A"), "r/R")
    for name in ("Hertz", "(1)-(4) l/R=0.25", "all neighbours l/R=0.25"):
        p = column(made("2A"), name)
        total = 2 * np.pi * np.trapezoid(p * r, r)
        assert total == pytest.approx(0.0044 * 2 / np.pi, rel=2e-3)


@pytest.mark.slow
def test_figure_2b_has_hertz_below_and_the_first_step_above_the_pressure_of_all_neighbours(made):
    for spacing in ("1.0", "0.5", "0.2"):
        hertz, first, every = (
            column(made("2B"), "p/E*", f"{name} l/R={spacing}")
            for name in ("Hertz", "(1)-(4)", "all neighbours")
        )
        assert np.all(hertz < every) and np.all(every < first)


def test_the_command_writes_what_is_asked_for(tmp_path):
    result = CliRunner().invoke(
        main, ["figures", "11", "--out", str(tmp_path)], standalone_mode=False
    )
    assert result.exception is None
    assert sorted(file.name for file in tmp_path.iterdir()) == ["figure-11.csv", "figure-11.png"]


def test_all_figures_are_wanted_where_none_is_named_and_unknown_ones_are_refused():
    assert figures.chosen([]) == ["2A", "2B", "7", "8", "9", "10", "11", "12", "13"]
    assert figures.chosen(["13", "2a"]) == ["2A", "13"]
    with pytest.raises(contact.SceneError, match="figure = '3'"):
        figures.chosen(["3"])


def test_a_figure_in_the_units_of_the_paper_gives_no_warning(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(figures.write("11", tmp_path)) == 2
