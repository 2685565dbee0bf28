"""Fast sums of smooth kernels, by panels or a skeleton, are those of the kernel itself, for few
and many zones and beside slits.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import sie
from sie.states import solve as fixed
from sie.states.solve import SolveOptions
from sie.trees.panels import PanelOptions, Spread, panels_of, panels_over
from sie.trees.skeleton import Skeleton
from tests.tiers import diagonal

FEW = np.array([[-1.0, -0.5], [-0.2, 0.3], [0.35, 1.0]])
PERIOD = 2.5


def kernel(eps, depth, period=None, of_lag=True):
    """1/r + eps r/(r^2 + depth^2), r = x - xi; with a period, the sum of these over all periods."""
    if period is None:
        smooth = sie.Smooth(
            lambda x, xi: eps * (x - xi) / ((x - xi) ** 2 + depth**2),
            lambda x, xi: 0.5 * eps * np.log((x - xi) ** 2 + depth**2),
            of_lag=of_lag,
        )
        return sie.cauchy() + smooth
    k = 2 * np.pi / period
    r = np.exp(-k * depth)
    smooth = sie.Smooth(
        lambda x, xi: (
            k * eps * r * np.sin(k * (x - xi)) / (1 - 2 * r * np.cos(k * (x - xi)) + r * r)
        ),
        lambda x, xi: 0.5 * eps * np.log(1 - 2 * r * np.cos(k * (x - xi)) + r * r),
        of_lag=of_lag,
    )
    return sie.hilbert(period) + smooth


VARIED = sie.cauchy() + sie.Smooth(
    lambda x, xi: 0.3 * np.cos(2 * x) * np.exp(xi) + 0.2 / (1.5 + x * xi),
    lambda x, xi: 0.15 * np.sin(2 * x) * np.exp(xi) + _log(x, xi),
)


def _log(x, xi):
    """The antiderivative of 0.2 / (1.5 + x xi) by x, zero at x = 0."""
    xi = np.where(np.abs(xi) < 1e-9, 1e-9, xi)
    return 0.2 * np.log1p(x * xi / 1.5) / xi


def equation(of_kernel, total=1.0):
    right = sie.Forcing(lambda x: np.sin(3 * x) + 0.2, lambda x: -np.cos(3 * x) / 3 + 0.2 * x)
    return sie.Equation(of_kernel, right, (sie.Total(total), sie.EqualPotential()))


def scattered(count):
    return np.sort(np.random.default_rng(3).uniform(-1, 1, 2 * count)).reshape(count, 2)


@pytest.mark.parametrize("period", [None, PERIOD])
@pytest.mark.parametrize("depth", [0.02, 0.3, 3.0])
@pytest.mark.parametrize("potential", [False, True])
def test_sums_over_points_are_those_of_the_kernel(depth, period, potential):
    of, rng = kernel(0.8, depth, period), np.random.default_rng(1)
    xi, weights = rng.uniform(-1, 1, 50), rng.standard_normal(50)
    x = np.concatenate((rng.uniform(-1, 1, 40), [-1.2, 1.2], [] if period else [-3.0, 40.0, 1e6]))
    panels = panels_of(of, -1.0, 1.0)
    found = panels.at(
        Spread.of(panels, x), panels.moments(Spread.of(panels, xi), weights), potential
    )
    function = of.regular_potential if potential else of.regular
    exact = function(x[:, None], xi)
    size = np.abs(function(np.linspace(-2, 2, 4001)[:, None], np.zeros(1))).max()
    assert found == pytest.approx(
        exact @ weights, rel=1e-13, abs=2e-14 * size * np.abs(weights).sum()
    )


def test_which_kernels_have_panels_or_a_skeleton():
    assert panels_over(kernel(0.8, 0.1, of_lag=False), sie.Zones.of(FEW)) is None
    assert isinstance(panels_over(VARIED, sie.Zones.of(scattered(40))), Skeleton)
    assert panels_over(kernel(0.8, 1e-4, of_lag=False), sie.Zones.of(scattered(40))) is None
    assert panels_of(kernel(0.8, 1e-4), -1.0, 1.0) is None
    assert panels_of(sie.hilbert(PERIOD), -1.0, 1.0) is None  # kernels of the engine need no panels


@pytest.mark.parametrize("period", [None, PERIOD])
@pytest.mark.parametrize("depth", [0.1, 1.0])
def test_a_density_is_the_same_with_panels_and_without(depth, period):
    zones, x = sie.Zones.of(FEW), np.array([-1.2, -0.7, 0.1, 0.32, 1.1])
    one, other = (
        sie.solve_fixed(equation(kernel(0.8, depth, period, lag)), zones) for lag in (True, False)
    )
    size = np.abs(other.density.coefficients).max()
    assert one.density.coefficients[:, :12] == pytest.approx(
        other.density.coefficients[:, :12], abs=1e-12 * size
    )
    assert one.density.transform(x) == pytest.approx(other.density.transform(x), abs=1e-11 * size)
    assert one.density.potential(x) == pytest.approx(other.density.potential(x), abs=1e-12 * size)
    assert one.levels == pytest.approx(other.levels, abs=1e-12 * size)


@pytest.mark.parametrize("period", [None, PERIOD])
def test_the_smooth_part_acts_on_jumps_and_on_uncoupled_modes(period):
    # The right side has a kink in a zone and many more modes than zones have coupled unknowns.
    right = sie.Forcing(
        lambda x: np.sign(x - 0.1) + np.cos(120 * x),
        lambda x: np.abs(x - 0.1) + np.sin(120 * x) / 120,
        sie.Jumps(np.array([0.1]), np.array([2.0])),
    )
    conditions = (sie.Total(1.0), sie.EqualPotential())
    zones, x = sie.Zones.of(FEW), np.linspace(-0.95, 0.95, 31)
    state = sie.solve_fixed(sie.Equation(kernel(2.0, 0.1, period), right, conditions), zones)
    inside = np.any((x[:, None] > FEW[:, 0]) & (x[:, None] < FEW[:, 1]), axis=1)
    off = state.density.transform(x[inside]) - right.value(x[inside])
    assert np.abs(off).max() < 1e-10 and np.ptp(state.levels) < 1e-11


@pytest.mark.parametrize("period", [None, PERIOD])
def test_a_mode_beyond_the_coupled_ones_acts_through_the_smooth_part(period):
    # Without the smooth part, the density would be about -T_40 / sqrt(1 - t^2), whose total is
    # zero. The coupled modes are then zero and do not show that mode 40 matters.
    zones = sie.Zones.of([[-0.3, 0.3]])
    right = sie.Forcing(lambda x: np.sin(40 * np.arccos(x / 0.3)) / np.sqrt(1 - (x / 0.3) ** 2))
    wanted = sie.Equation(kernel(2.0, 0.1, period), right, (sie.Total(0.0),))
    sizes = fixed.first_sizes(wanted, zones)
    sizes.own[:] = 64
    state = sie.solve_fixed(wanted, zones, sizes=sizes)
    x = 0.3 * np.linspace(-0.95, 0.95, 21)
    assert np.abs(state.density.transform(x) - right.value(x)).max() < 1e-10


@pytest.mark.parametrize("period", [None, PERIOD])
def test_many_zones_are_summed_and_iterated_like_few(period, monkeypatch):
    zones, x = sie.Zones.of(scattered(30)), np.linspace(-1.1, 1.1, 301)
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10**9))
    direct = sie.solve_fixed(equation(kernel(0.8, 0.1, period)), zones)
    assert not direct.iterated
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=50))
    by_sums = sie.solve_fixed(equation(kernel(0.8, 0.1, period)), zones)
    assert by_sums.iterated
    size = np.abs(direct.density.coefficients).max()
    assert by_sums.density.coefficients[:, :8] == pytest.approx(
        direct.density.coefficients[:, :8], abs=1e-11 * size
    )
    assert by_sums.levels == pytest.approx(direct.levels, abs=1e-12 * size)
    assert by_sums.density.potential(x) == pytest.approx(
        direct.density.potential(x), abs=1e-12 * size
    )


def test_the_number_of_kernel_values_does_not_grow_with_the_zones():
    def counted(count):
        of, places = kernel(0.8, 0.3), [0]
        regular = of.regular

        def value(x, xi):
            places[0] += np.broadcast(x, xi).size
            return regular(x, xi)

        sie.solve_fixed(equation(replace(of, regular=value)), sie.Zones.of(scattered(count)))
        return places[0]

    asked = [counted(count) for count in (5, 40)]
    assert asked[1] <= 2 * asked[0]


def test_the_number_of_kernel_calls_does_not_grow_with_the_spread_of_points():
    of, calls = kernel(0.8, 0.3), [0]
    regular = of.regular_potential

    def potential(x, xi):
        calls[0] += 1
        return regular(x, xi)

    density = sie.solve_fixed(
        equation(replace(of, regular_potential=potential)), sie.Zones.of(scattered(5))
    ).density

    def asked(x):
        calls[0] = 0
        density.potential(x)
        return calls[0]

    assert asked(np.geomspace(10.0, 1e3, 400)) <= asked(np.linspace(10.0, 10.5, 400)) + 2


@pytest.mark.parametrize(
    "of", [VARIED, kernel(0.8, 0.3, of_lag=False), kernel(0.8, 0.3, PERIOD, of_lag=False)]
)
def test_over_many_zones_a_kernel_of_x_and_xi_is_summed_by_a_skeleton(of, monkeypatch):
    zones, x = sie.Zones.of(scattered(34)), np.linspace(-1.1, 1.1, 201)
    monkeypatch.setattr("sie.trees.panels.OPTIONS", PanelOptions(min_zones_of_skeleton=1000))
    direct = sie.solve_fixed(equation(of), zones)
    assert not direct.iterated
    monkeypatch.setattr("sie.trees.panels.OPTIONS", PanelOptions(min_zones_of_skeleton=32))
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=50))
    by_sums = sie.solve_fixed(equation(of), zones)
    assert by_sums.iterated
    size = np.abs(direct.density.coefficients).max()
    assert by_sums.density.coefficients[:, :8] == pytest.approx(
        direct.density.coefficients[:, :8], abs=1e-11 * size
    )
    assert by_sums.levels == pytest.approx(direct.levels, abs=1e-12 * size)
    assert by_sums.density.transform(x) == pytest.approx(
        direct.density.transform(x), abs=1e-9 * size
    )
    assert np.abs(by_sums.density.potential(x) - direct.density.potential(x)).max() < 1e-11 * size


@pytest.mark.parametrize(
    ("of", "at"),
    diagonal([*product([None, PERIOD], [True, False])], [*product([0.05, 0.5], [False, True])]),
)
def test_beside_a_slit_the_density_is_that_of_the_zones_by_themselves(of, at):
    (period, of_lag), (depth, symmetric) = of, at
    right = sie.Forcing(lambda x: x, lambda x: 0.5 * x * x)
    equation = sie.Equation(
        kernel(0.8, depth, period, of_lag), right, (sie.Total(1.0), sie.EqualPotential())
    )
    zones = sie.Zones.of(
        np.array([[-0.8, -0.004], [0.004, 0.8]] if symmetric else [[-0.8, 0.01], [0.018, 0.7]]),
        symmetric=symmetric,
    )
    one, other = sie.solve_zones(equation, zones), sie.solve_fixed(equation, zones)
    assert isinstance(one.density, sie.SlitDensity) and not isinstance(
        other.density, sie.SlitDensity
    )
    t = np.linspace(-0.9, 0.9, 7)
    for zone in (0, 1):
        assert one.density.at_t(zone, t) == pytest.approx(other.density.at_t(zone, t), rel=1e-9)
    assert np.array(one.density.intensities) == pytest.approx(
        np.array(other.density.intensities), rel=1e-7
    )
    assert one.density_error < 1e-9


def test_without_conditions_on_potentials_a_kernel_needs_no_potential(monkeypatch):
    zones, without = (
        sie.Zones.of(scattered(34), sie.SINGULAR, sie.SINGULAR),
        replace(VARIED, regular_potential=None),
    )
    right = sie.Forcing(np.sin, lambda x: -np.cos(x))
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10**9))
    direct = sie.solve_fixed(sie.Equation(VARIED, right, (sie.ZoneTotals(0.1),)), zones)
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=50))
    by_sums = sie.solve_fixed(sie.Equation(without, right, (sie.ZoneTotals(0.1),)), zones)
    assert by_sums.iterated and not direct.iterated
    assert by_sums.density.at_t(5, 0.3) == pytest.approx(direct.density.at_t(5, 0.3), rel=1e-11)
    with pytest.raises(ValueError, match="needs the potential of the regular kernel"):
        sie.solve_fixed(sie.Equation(without, right, (sie.Total(0.1), sie.EqualPotential())), zones)


@pytest.mark.parametrize("count", [3, 31, 32, 60])
@pytest.mark.parametrize("of_lag", [False, True])
def test_a_kernel_is_called_only_where_it_must_be_defined(count, of_lag):
    """A kernel of x and xi is called on zones only, a kernel of the lag from the first end to the
    last. Elsewhere a user's kernel need not be defined.
    """
    table = np.column_stack((np.arange(count) + 0.3, np.arange(count) + 0.9))

    def value(x, xi):
        for place in (x, xi):
            if of_lag:
                assert place.min() >= table[0, 0] - 1e-12 and place.max() <= table[-1, 1] + 1e-12
            else:
                inside = (place[..., None] >= table[:, 0] - 1e-12) & (
                    place[..., None] <= table[:, 1] + 1e-12
                )
                assert inside.any(axis=-1).all()
        return (
            0.1 * np.cos((x - xi) / count) / count if of_lag else 0.1 * np.sqrt(x * xi) / count**2
        )

    wanted = sie.Equation(
        sie.cauchy() + sie.Smooth(value, of_lag=of_lag), np.sin, sie.ZoneTotals(1.0)
    )
    assert sie.solve(wanted, sie.Zones.of(table, sie.SINGULAR, sie.SINGULAR), 1e-8).error < 1e-8


def test_a_kernel_of_low_rank_is_called_for_a_tenth_of_the_pairs_of_nodes():
    zones, places = sie.Zones.of(scattered(60)), [0]

    def value(x, xi):
        places[0] += np.broadcast(x, xi).size
        return VARIED.regular(x, xi)

    state = sie.solve_fixed(
        sie.Equation(replace(VARIED, regular=value), np.sin, sie.ZoneTotals(1.0)), zones
    )
    assert places[0] < 0.1 * state.system.layout.size**2


def test_a_kernel_that_is_zero_does_not_change_the_density():
    zones = sie.Zones.of(scattered(40))
    nothing = sie.Smooth(lambda x, xi: 0.0 * x * xi)
    one, other = (
        sie.solve_fixed(sie.Equation(of, np.sin, sie.ZoneTotals(1.0)), zones)
        for of in (sie.cauchy() + nothing, sie.cauchy())
    )
    assert one.density.coefficients[:, :6] == pytest.approx(
        other.density.coefficients[:, :6], abs=1e-11
    )
