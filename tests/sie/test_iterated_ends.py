"""Prescribed intensities on very many zones. Iteration finds the same ends as the matrix of all
rates, and the number of its steps does not grow with the number of zones.
"""

import numpy as np
import pytest

import sie
from sie.dense.modes import ModeOptions
from sie.ends.motions import DirectMotions, IteratedMotions
from sie.states.solve import SolveOptions

BUMPS = sie.Forcing(
    lambda x: np.sin(2 * np.pi * x) / (2 * np.pi),
    lambda x: -np.cos(2 * np.pi * x) / (2 * np.pi) ** 2,
)
ADHERING = sie.free_with_intensity(-0.01)


def problem(count, name):
    """(equation, first guess of the ends) of adhering bumps, under the control `name`.

    loads: each bump has a given load; level: the bumps share a level and a total load; width: the
    bumps share a level, and the sum of their widths is given.
    """
    at = np.arange(count) - 0.5 * (count - 1) * (count % 2)
    half = 0.12 * (1 + 0.05 * np.random.default_rng(0).standard_normal(count))
    half = 0.5 * (half + half[::-1])
    kernel = sie.cauchy() if name == "loads" else sie.hilbert(1.0 * count)
    conditions, ends = {
        "loads": ((sie.ZoneTotals(0.01),), ()),
        "level": ((sie.Total(0.01 * count), sie.EqualPotential()), ()),
        "width": ((sie.Total(None), sie.EqualPotential()), (sie.TotalWidth(0.26 * count),)),
    }[name]
    table = np.column_stack((at - half, at + half))
    return sie.Equation(kernel, BUMPS, conditions, end_conditions=ends), table


def both(monkeypatch, solve):
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10**9))
    direct = solve()
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=1))
    return direct, solve()


@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("name", ["loads", "level"])
def test_rates_and_motions_of_ends_agree_between_fast_sums_and_the_matrix(
    monkeypatch, name, symmetric
):
    equation, table = problem(7, name)
    zones = sie.Zones.of(table, ADHERING, ADHERING, symmetric=symmetric)
    direct, iterated = both(monkeypatch, lambda: sie.solve_fixed(equation, zones))
    assert iterated.iterated and not direct.iterated
    one, by_matrix = sie.end_rates(direct), sie.end_rates(iterated)
    monkeypatch.setattr("sie.ends.motions.MODES", ModeOptions(max_matrix_numbers=1))
    for other in (by_matrix, sie.end_rates(iterated)):
        assert one.ends == other.ends
        assert other.intensities == pytest.approx(one.intensities, abs=1e-13)
        assert other.levels == pytest.approx(one.levels, abs=1e-14)
    change = np.random.default_rng(1).standard_normal((2, 7))
    change = change + change[::-1, ::-1] if symmetric else change
    (motions, levels), (found, of_found) = (
        sie.end_motions(state, change) for state in (direct, iterated)
    )
    assert found == pytest.approx(motions, rel=1e-10) and of_found == pytest.approx(
        levels, rel=1e-10
    )
    growth = IteratedMotions(iterated, iterated.iteration).growth(np.ones(2))
    assert growth == pytest.approx(DirectMotions(direct).growth(np.ones(2)), rel=1e-4)


@pytest.mark.parametrize("name", ["loads", "level", "width"])
def test_the_ends_found_are_those_found_with_all_rates(monkeypatch, name):
    equation, table = problem(10, name)
    zones = sie.Zones.of(table, ADHERING, ADHERING)
    direct, iterated = both(
        monkeypatch,
        lambda: sie.find_ends(
            equation, zones, 1e-9, start=sie.WarmStart(value=0.1 if name == "width" else 0.0)
        ),
    )
    assert direct.converged and iterated.converged and direct.stable and iterated.stable
    away = np.abs(direct.density.zones.table - iterated.density.zones.table) / np.diff(
        table, axis=1
    )
    assert away.max() < direct.end_error.max() + iterated.end_error.max() < 1e-8


def test_an_unstable_root_is_recognized_by_iteration_too(monkeypatch):
    equation, table = problem(6, "loads")
    middle = table.mean(axis=1)
    zones = sie.Zones.of(np.column_stack((middle - 0.01, middle + 0.01)), ADHERING, ADHERING)
    pulled = sie.Equation(equation.kernel, BUMPS, (sie.ZoneTotals(-0.004),))
    for found in both(monkeypatch, lambda: sie.find_ends(pulled, zones, 1e-9)):
        assert found.converged and found.stable is False


def test_ends_that_the_intensities_do_not_determine_have_no_small_stated_error(monkeypatch):
    """Cracks under a uniform load may be shifted along the line without a change. The iterative
    search must then fail, or state an error of the ends above 1e-8 of the widths.
    """
    even = sie.Equation(
        sie.hilbert(12.0), sie.Forcing(lambda x: -np.ones_like(x)), (sie.ZoneTotals(),)
    )
    at = 3.0 * np.arange(4)
    zones = sie.Zones.of(
        np.column_stack((at - 1.3, at + 1.2)),
        sie.free_with_intensity(-1.2),
        sie.free_with_intensity(1.2),
    )
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=1))
    found = sie.find_ends(even, zones, 1e-9, sie.NewtonOptions(signs=(-1.0, 1.0)))
    width = np.diff(found.density.zones.table, axis=1)
    assert not found.converged or found.end_error.max() > 1e-8 * width.max()


@pytest.mark.parametrize("name", ["loads", "level"])
def test_steps_do_not_grow_with_the_number_of_zones(monkeypatch, name):
    counts = []
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=1))
    for count in (12, 96):
        equation, table = problem(count, name)
        state = sie.solve_fixed(equation, sie.Zones.of(table, ADHERING, ADHERING))
        before = state.iteration.iterations
        IteratedMotions(state, state.iteration).meeting(np.ones(2 * count))
        counts.append(state.iteration.iterations - before)
    assert counts[1] <= counts[0] + 2 <= 12


def test_the_warm_start_on_moved_ends_has_an_error_of_second_order(monkeypatch):
    """If free ends move, the density at fixed places changes by the square of their motion. The
    next solution by iteration starts from this density.
    """
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=1))
    equation, table = problem(6, "level")
    found = sie.find_ends(equation, sie.Zones.of(table), 1e-13).density.zones
    direction = np.random.default_rng(2).uniform(0.5, 1.0, (2, 6))
    off = []
    for motion in (1e-2, 1e-3):
        first = sie.solve_fixed(equation, found)
        moved = sie.solve_fixed(equation, found.moved(0.2 * motion * direction))
        off.append(np.abs(first.sizes.carried.near(moved.system) - moved.folded_unknowns).max())
    assert np.log10(off[0] / off[1]) == pytest.approx(2.0, abs=0.1)
