"""Equations with kappa on many zones: fast sums compared with a matrix, and with exact laws."""

import numpy as np
import pytest

import sie
from sie.second_kind import density as densities
from sie.second_kind import solve as solving
from sie.second_kind.many_state import ManyState
from tests.tiers import diagonal

S = sie.SINGULAR


def row(count, seed=0):
    """Zones of random widths with random gaps, and the length of the row."""
    random = np.random.default_rng(seed)
    width, gap = random.uniform(0.3, 1.0, count), random.uniform(0.1, 1.0, count)
    left = np.cumsum(width + gap) - (width + gap)
    return sie.Zones.of(np.column_stack((left, left + width)), S, S), float((width + gap).sum())


def by_matrix(monkeypatch, equation, zones):
    """The solution on the zones with a matrix, even if fast sums could replace it."""
    with monkeypatch.context() as patch:
        for module in (solving, solving.many_levels):
            patch.setattr(module, "unfit", lambda *_: "a matrix is wanted")
        return sie.solve_zones(equation, zones)


@pytest.mark.parametrize(("periodic", "seed"), diagonal([False, True], [None, 3]))
def test_sums_and_matrix_agree_within_the_stated_error(monkeypatch, periodic, seed):
    zones, length = row(45)
    kappa = 0.3 if seed is None else np.random.default_rng(seed).choice([-1.0, 0.2, 3.0], 45)
    kernel = sie.hilbert(length) if periodic else sie.cauchy()
    equation = sie.Equation(kernel, np.cos, sie.ZoneTotals(0.2), kappa=kappa)
    fast, dense = sie.solve_zones(equation, zones), by_matrix(monkeypatch, equation, zones)
    assert isinstance(fast, ManyState) and not isinstance(dense, ManyState)
    count = min(one.density.coefficients.shape[1] for one in (fast, dense))
    change = fast.density.coefficients[:, :count] - dense.density.coefficients[:, :count]
    assert np.abs(change).max() <= min(1e-12, fast.density_error) * dense.size
    assert fast.density_error < 1e-10
    # The response to other totals is computed by the same fast sums.
    values = np.linspace(1.0, 2.0, 45)
    both = [one.response(values).totals for one in (fast, dense)]
    assert both[0] == pytest.approx(values, rel=1e-13)
    assert both[1] == pytest.approx(values, rel=1e-12)


def test_aerofoils_with_one_bounded_end_each(monkeypatch):
    zones, _ = row(45)
    zones = sie.Zones.of(zones.table, S, sie.BOUNDED)
    equation = sie.Equation(sie.cauchy(), np.cos, kappa=-0.3)
    fast, dense = sie.solve_zones(equation, zones), by_matrix(monkeypatch, equation, zones)
    assert isinstance(fast, ManyState)
    x = zones.middle + 0.3 * zones.half
    assert fast.density(x) == pytest.approx(dense.density(x), abs=1e-12 * dense.size)
    assert fast.density.totals == pytest.approx(dense.density.totals, abs=1e-12 * dense.size)
    assert fast.density_error < 1e-10


def test_fast_sums_include_the_closed_form_parts_of_jumps(monkeypatch):
    zones, _ = row(45)
    places = zones.middle[[3, 40]]
    jumps = sie.Jumps(places, [1.0, -2.0], [0, 0])
    right = sie.Forcing(
        lambda x: 0.5 * np.sign(x - places[0]) - np.sign(x - places[1]), None, jumps
    )
    equation = sie.Equation(sie.cauchy(), right, sie.ZoneTotals(0.0), kappa=0.4)
    fast, dense = sie.solve_zones(equation, zones), by_matrix(monkeypatch, equation, zones)
    assert isinstance(fast, ManyState)
    x = zones.middle + 0.3 * zones.half
    assert fast.density(x) == pytest.approx(dense.density(x), abs=1e-12 * dense.size)
    assert np.abs(fast.density.totals).max() < 1e-13


MEAN = sie.Forcing(np.ones_like, lambda x: np.asarray(x, float), resolution=sie.Resolution(modes=1))
LEVELLED = [
    (sie.cauchy(), (sie.Total(1.0), sie.EqualPotential()), ()),
    (sie.hilbert(60.0), (sie.Level(0.7), sie.moment(0.2)), (MEAN,)),
    (
        sie.hilbert(60.0),
        (sie.Total(1.0), sie.EqualPotential(), sie.Amplitude(0, 0.0, per_total=0.005)),
        (MEAN,),
    ),
]


@pytest.mark.parametrize("kernel, conditions, columns", LEVELLED)
def test_levels_of_many_zones_with_kinks_agree_with_the_matrix(
    monkeypatch, kernel, conditions, columns
):
    zones, _ = row(37)
    places = zones.middle[[3, 30]] + 0.1 * zones.half[[3, 30]]
    right = sie.Forcing(
        lambda x: np.cos(x) + np.maximum(x - places[0], 0) - 2 * np.maximum(x - places[1], 0),
        lambda x: (
            np.sin(x) + 0.5 * np.maximum(x - places[0], 0) ** 2 - np.maximum(x - places[1], 0) ** 2
        ),
        sie.Jumps(places, [1.0, -2.0], [1, 1]),
    )
    equation = sie.Equation(kernel, right, conditions, columns, kappa=0.3)
    fast, dense = sie.solve_zones(equation, zones), by_matrix(monkeypatch, equation, zones)
    assert isinstance(fast, ManyState) and not isinstance(dense, ManyState)
    x = zones.middle + 0.3 * zones.half
    error = np.abs(fast.density(x) - dense.density(x)).max() / dense.size
    assert error < min(1e-10, fast.density_error + dense.density_error)
    assert fast.levels == pytest.approx(dense.levels, abs=1e-10 * dense.size)
    assert fast.density.amplitudes == pytest.approx(
        dense.density.amplitudes, abs=1e-10 * dense.size
    )
    # A tree sums the fields at points; at complex points all zones are summed one by one.
    places = np.linspace(zones.a[0] - 5.0, zones.b[-1] + 5.0, 400)
    off = places[~fast.density.locate(places)[2]]
    plane = fast.density.transform(off + 0j).real
    assert fast.density.transform(off) == pytest.approx(plane, abs=1e-12 * dense.size)
    by_tree = fast.density.potential(places)
    monkeypatch.setattr(densities, "TREES", densities.TreeOptions(min_zones=10**6))
    summed = dense.density.potential(places)
    assert by_tree == pytest.approx(summed, abs=1e-10 * dense.size)
    values = fast.values()
    rates = fast.level_rates(values), dense.level_rates(values)
    assert rates[0] == pytest.approx(rates[1], rel=1e-9)


def test_a_small_kappa_gives_the_solution_of_the_first_kind():
    zones, _ = row(60)
    found = [
        sie.solve_zones(sie.Equation(sie.cauchy(), np.cos, sie.ZoneTotals(0.0), kappa=one), zones)
        for one in (0.0, 1e-9)
    ]
    left, right = (np.array(one.density.intensities) for one in found)
    assert right == pytest.approx(left, abs=1e-8)


def test_a_row_of_many_sliding_waves_has_the_ends_of_one():
    """The equation T p + kappa (p - mean p) = sin 2x has the pressure p on one zone [A, B] in
    each period pi; alpha is 0.41.

    The ends obey
    cos(2 m - pi alpha) = alpha cos(2 B + pi alpha) + (1 - alpha) cos(2 A + pi alpha) with
    m = alpha B + (1 - alpha) A. The mean is (cos 2m - alpha cos 2B - (1 - alpha) cos 2A) / 2.
    """
    alpha, mean, count = 0.41, 0.3, 60
    kappa = 1 / np.tan(np.pi * alpha)
    equation = sie.Equation(
        sie.hilbert(count * np.pi),
        lambda x: np.sin(2 * x) + kappa * mean,
        sie.ZoneTotals(mean * np.pi),
        kappa=kappa,
    )
    start = np.arange(count)[:, None] * np.pi + np.array([-0.6, 0.6])
    found = sie.solve(equation, sie.Zones.of(start), tol=1e-9)
    assert isinstance(found.state, ManyState)
    a, b = (found.zones.table - np.arange(count)[:, None] * np.pi).T
    m = alpha * b + (1 - alpha) * a
    sides = alpha * np.cos(2 * b + np.pi * alpha) + (1 - alpha) * np.cos(2 * a + np.pi * alpha)
    assert np.cos(2 * m - np.pi * alpha) == pytest.approx(sides, abs=1e-9)
    carried = np.cos(2 * m) - alpha * np.cos(2 * b) - (1 - alpha) * np.cos(2 * a)
    assert 0.5 * carried == pytest.approx(np.full(count, mean), abs=1e-9)
    assert found.error < 1e-9


def test_hundreds_of_cracks_satisfy_the_equation_at_other_points():
    zones, _ = row(600)
    equation = sie.Equation(sie.cauchy(), np.ones_like, sie.ZoneTotals(0.0), kappa=0.3)
    found = sie.solve(equation, zones)
    assert found.error < 1e-10
    x = (zones.middle + 0.37 * zones.half)[::333]
    assert np.abs(found.residual(x)).max() < 1e-11


def test_other_conditions_on_too_many_zones_are_refused_by_name():
    zones, _ = row(1500)
    still = sie.Forcing(np.zeros_like, np.zeros_like)
    conditions = sie.ZoneTotals(0.0), sie.moment(1.0)
    equation = sie.Equation(sie.cauchy(), still, conditions, (np.ones_like,), kappa=0.3)
    with pytest.raises(sie.SingularSystem, match="need a condition on potentials"):
        sie.solve_zones(equation, zones)
