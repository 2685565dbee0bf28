"""Methods of a solution: residual, report, capacity, figure and pickling."""

import copy
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import sie

ENDS = (sie.SINGULAR, sie.SINGULAR)
ZERO = sie.Forcing(np.zeros_like, np.zeros_like)
CONDUCTORS = (sie.Total(1.0), sie.EqualPotential())


def solved(kernel, ends, conditions=CONDUCTORS):
    return sie.solve(sie.Equation(kernel, ZERO, conditions), sie.Zones.of(ends, *ENDS))


def test_the_residual_is_zero_on_the_zones_and_not_a_number_off_them():
    wave = sie.Forcing(lambda x: np.sin(2 * np.pi * x))
    tilted = sie.Equation(
        sie.hilbert(1.0), wave, (sie.Total(0.2), sie.Amplitude(0, 0.3)), np.ones_like
    )
    found = sie.solve(tilted, sie.Zones.of([[-0.2, 0.3]], *ENDS))
    x = np.array([[-0.15, 0.0, 0.29], [1.1, -0.9, 0.5]])
    residual = found.residual(x)
    assert np.abs(residual[0]).max() < 1e-12 and np.abs(residual[1, :2]).max() < 1e-12
    assert np.isnan(residual[1, 2])
    # The residual of the whole equation includes the column. Without the column, it would be the
    # amplitude 0.3.
    off = found.density.transform(x[0]) - wave.value(x[0])
    assert np.abs(off - 0.3).max() < 1e-12


def test_the_residual_counts_logarithms_of_densities_that_jump():
    jumps = sie.Jumps([0.1], [2.0], of_density=True)
    found = sie.solve(
        sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x, jumps=jumps), sie.Total(1.0)),
        sie.Zones.of([[-1.0, 1.0]], *ENDS),
    )
    assert np.abs(found.residual([-0.5, 0.05, 0.2, 0.9])).max() < 1e-11


def test_an_unresolved_right_side_shows_in_the_residual():
    rough = sie.Equation(sie.cauchy(), lambda x: np.abs(x - 0.1), sie.Total(1.0))
    with pytest.raises(sie.NotConverged) as stopped:
        sie.solve(rough, sie.Zones.of([[-1.0, 1.0]], *ENDS))
    best = stopped.value.best
    residual = np.abs(best.residual(0.1 + np.linspace(-1e-3, 1e-3, 21))).max()
    assert residual > 1e-7


@pytest.mark.parametrize("length", [1e-6, 1.0, 3e5])
def test_an_interval_has_a_quarter_of_its_length_as_capacity(length):
    found = solved(sie.cauchy(7.0), [[0.5, 0.5 + length]], sie.Total(-2.0))
    assert abs(found.capacity / (0.25 * length) - 1) < 1e-9 * max(1.0, 1e-6 / length)


@pytest.mark.parametrize("a", [1e-3, 0.5, 0.999])
def test_two_symmetric_intervals_have_the_known_capacity(a):
    found = solved(sie.cauchy(), [[-1.0, -a], [a, 1.0]])
    assert abs(found.capacity / (0.5 * np.sqrt(1 - a * a)) - 1) < 1e-10
    level = sie.solve(
        sie.Equation(sie.cauchy(), ZERO, sie.Level(2.0)), sie.Zones.of([[-1, -a], [a, 1]], *ENDS)
    )
    assert abs(level.capacity / found.capacity - 1) < 1e-10


def test_the_capacity_scales_with_length_and_grows_with_the_set():
    two = solved(sie.cauchy(), [[0.0, 1.0], [1.5, 1.7]]).capacity
    scaled = solved(sie.cauchy(), [[0.0, 3.0], [4.5, 5.1]]).capacity
    assert abs(scaled / two - 3) < 1e-11
    assert 0.25 < two < 0.25 * 1.7


def test_with_a_period_the_zones_are_arcs_of_a_circle():
    """An arc of the angle a on the unit circle has the capacity sin(a/4), and two opposite arcs
    of this angle have sqrt(sin(a/2)).
    """
    circle, angle = sie.hilbert(2 * np.pi), 1.1
    one = solved(circle, [[0.3, 0.3 + angle]], sie.Total(1.0))
    two = solved(circle, [[0.0, angle], [np.pi, np.pi + angle]])
    assert abs(one.capacity / np.sin(angle / 4) - 1) < 1e-11
    assert abs(two.capacity / np.sqrt(np.sin(angle / 2)) - 1) < 1e-11
    wide = solved(sie.hilbert(1e4), [[0.0, 1.0], [1.5, 1.7]]).capacity
    assert abs(wide / solved(sie.cauchy(), [[0.0, 1.0], [1.5, 1.7]]).capacity - 1) < 1e-7


def test_other_problems_have_no_capacity():
    plates = [[-2.0, -1.0], [1.0, 2.2]]
    with pytest.raises(ValueError, match="one potential on all zones"):
        solved(sie.cauchy(), plates, sie.ZoneTotals((1.0, 2.0))).capacity  # noqa: B018
    with pytest.raises(ValueError, match="circumference"):
        solved(sie.images(9.0, 1), plates).capacity  # noqa: B018
    with pytest.raises(ValueError, match="total is not zero"):
        solved(sie.cauchy(), plates, (sie.Total(0.0), sie.EqualPotential())).capacity  # noqa: B018
    hertz = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(1.0))
    with pytest.raises(ValueError, match="the right side zero"):
        sie.solve(hertz, sie.Zones.of([[-1.0, 1.0]])).capacity  # noqa: B018


def test_the_report_says_what_is_known_of_each_zone():
    found = sie.solve(
        sie.Equation(sie.cauchy(), np.cos, sie.ZoneTotals((1.0, -2.0))),
        sie.Zones.of([[-1.0, 0.0], [0.5, 2.0]], *ENDS),
    )
    report = found.report()
    assert np.abs(report.totals - [1.0, -2.0]).max() < 1e-12
    assert np.array_equal(report.intensities, np.array(found.density.intensities))
    assert (report.last < 1e-9).all() and report.steps is None and report.iterations == 0
    assert report.unknowns == (report.coupled + 1).sum()
    assert np.array_equal(report.errors, found.errors) and report.error == found.error
    lines = str(report).splitlines()
    assert len(lines) == 5 and "condition number" in lines[-1]


def test_the_condition_number_is_that_of_the_matrix():
    found = sie.solve(
        sie.Equation(sie.cauchy(), np.cos, sie.ZoneTotals(0.0)),
        sie.Zones.of([[-1.0, 0.0], [0.01, 2.0]], *ENDS),
    )
    state = found.state.whole
    inverse = state.solver(np.eye(state.solver.size))
    # The estimate is a lower bound, in practice within a factor of three (N. J. Higham).
    exact = np.abs(np.linalg.inv(inverse)).sum(axis=0).max() * np.abs(inverse).sum(axis=0).max()
    assert exact / 3 < found.report().condition < exact * (1 + 1e-8)


def test_the_report_of_free_ends_and_of_narrow_gaps_counts_steps_and_pieces():
    still = sie.Forcing(lambda x: x * (x * x - 1.001), lambda x: x**4 / 4 - 1.001 * x**2 / 2)
    equation = sie.Equation(sie.cauchy(), still, CONDUCTORS)
    found = sie.solve(equation, sie.Zones.of([[-1.6, -0.05], [0.05, 1.6]]))
    report = found.report()
    assert report.steps >= 2 and len(str(report).splitlines()) == 5
    assert np.abs(report.totals.sum() - 1.0) < 1e-9


def test_many_zones_are_reported_by_those_with_the_largest_errors():
    zones = sie.Zones.of(np.arange(80)[:, None] + [0.0, 0.5], *ENDS)
    found = sie.solve(sie.Equation(sie.cauchy(), np.zeros_like, sie.ZoneTotals(1.0)), zones)
    report = found.report()
    text = str(report)
    assert len(text.splitlines()) < 30 and "24 of 80 zones" in text
    assert f"\n{int(np.argmax(report.errors)):>4} " in text
    if report.condition is None:
        assert "no matrix" in text and report.iterations > 0


def line(x):
    return 1.0 * x


def test_a_solution_of_named_functions_is_pickled():
    found = sie.solve(sie.Equation(sie.cauchy(), line, sie.Total(1.0)), sie.Zones.of([[-1.0, 1.0]]))
    # The module of a test has no importable name, so that the pickled function is one of numpy.
    plain = sie.solve(
        sie.Equation(sie.cauchy(), np.sin, sie.Total(1.0)), sie.Zones.of([[-1.0, 1.0]])
    )
    back = pickle.loads(pickle.dumps(plain))
    assert back.density(0.1) == plain.density(0.1) and back.residual(0.1) == plain.residual(0.1)
    assert copy.deepcopy(found).density(0.1) == copy.copy(found).density(0.1) == found.density(0.1)


LAMBDAS = {
    "the right side": "sie.Equation(sie.cauchy(), lambda x: x, sie.Total(1.0))",
    "the kernel": "sie.Equation(sie.cauchy() + (lambda x, s: x * s), np.sin, sie.Total(1.0))",
    "the condition Weighted": "sie.Equation(sie.cauchy(), np.sin,"
    " sie.Weighted(lambda x: 1 + 0 * x, 1.0))",
    "column 0": "sie.Equation(sie.cauchy(), np.sin, (sie.Total(1.0), sie.Amplitude(0, 0.1)),"
    " lambda x: 1 + 0 * x)",
}


def test_a_lambda_that_cannot_be_pickled_is_named():
    code = f"""
import pickle, copy, numpy as np, sie
for equation in [{", ".join(LAMBDAS.values())}]:
    found = sie.solve(equation, sie.Zones.of([[-1.0, 1.0]]))
    assert copy.deepcopy(found).error == found.error
    try:
        pickle.dumps(found)
    except pickle.PicklingError as error:
        print(error)
"""
    run = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        cwd=Path(__file__).parents[2],
    )
    for part, said in zip(LAMBDAS, run.stdout.splitlines(), strict=True):
        assert part in said and "<lambda>" in said and "`def`" in said


def test_cloudpickle_stores_lambdas():
    cloudpickle = pytest.importorskip("cloudpickle")
    found = sie.solve(
        sie.Equation(sie.cauchy(), lambda x: x, sie.Total(1.0)), sie.Zones.of([[-1.0, 1.0]])
    )
    back = pickle.loads(cloudpickle.dumps(found))
    assert back.residual(0.1) == found.residual(0.1)


def test_the_figure_shows_every_zone_and_draws_on_given_axes():
    figures = pytest.importorskip("matplotlib.figure")
    found = solved(sie.cauchy(), [[-2.0, -1.0], [1.0, 2.2]])
    axes = found.plot().axes[0]
    assert len([one for one in axes.lines if len(one.get_xdata()) > 2]) == 2
    x, phi = axes.lines[0].get_data()
    assert np.abs(found.density(x) / phi - 1).max() < 1e-9
    assert axes.get_ylim()[1] < phi.max()  # large values at singular ends are cut off
    own = figures.Figure().subplots()
    assert found.plot(own) is own.figure and len(own.lines) == 3
    with pytest.raises(ValueError, match="matplotlib Axes"):
        found.plot(3)


def test_without_matplotlib_the_figure_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in [one for one in sys.modules if one.startswith("matplotlib.")]:
        monkeypatch.setitem(sys.modules, name, None)
    found = solved(sie.cauchy(), [[-2.0, -1.0]], sie.Total(1.0))
    with pytest.raises(ImportError, match="pip install matplotlib"):
        found.plot()
