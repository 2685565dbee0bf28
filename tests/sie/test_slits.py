"""Narrow gaps as slits of wide zones: the solution agrees with that without slits, and the cost
does not grow as a gap narrows.
"""

from dataclasses import replace

import numpy as np
import pytest

import sie
from contact.reference.inverse import design
from sie.fast.iteration import Iterative
from sie.slits.slits import merge, outside_slit
from sie.slits.system import SlitState, solve_zones
from sie.states.solve import SolveOptions
from tests.tiers import quick

T = np.array([-0.999, -0.9, -0.5, 0.1, 0.7, 0.999])
KERNELS = (sie.cauchy(), sie.hilbert(1.0), sie.images(1.3, 1))


def equation(kernel, *jumps):
    forcing = sie.Forcing(
        lambda x: np.sin(7 * x) + 2 * x + sum(j * (x > s) for s, j in jumps),
        lambda x: -np.cos(7 * x) / 7 + x * x + sum(j * np.maximum(x - s, 0.0) for s, j in jumps),
        sie.Jumps(np.array([s for s, _ in jumps]), np.array([j for _, j in jumps])),
    )
    return sie.Equation(kernel, forcing, (sie.Total(0.3), sie.EqualPotential()))


TABLES = (
    [[-0.2, -0.03], [-0.029, 0.15]],
    [[-0.2, -0.03], [-0.029, 0.05], [0.0505, 0.15], [0.25, 0.31]],
    [[-0.2, -0.03], [-0.0285, -0.026], [-0.025, 0.15]],
)


# Positions and heights of jumps of the right side: none, one in a gap, or one in each narrow gap
# of `TABLES` and one in a zone.
KINKS = ((), ((-0.0297, -0.7),), ((-0.0291, 0.4), (-0.0253, -2.0), (0.0501, -1.0), (0.1, 0.3)))


@pytest.mark.parametrize("kernel", quick(KERNELS, KERNELS[:2]), ids=["line", "period", "images"])
@pytest.mark.parametrize("table", TABLES, ids=["two", "four", "island"])
@pytest.mark.parametrize(
    "kinks",
    [KINKS[0], pytest.param(KINKS[1], marks=pytest.mark.slow), KINKS[2]],
    ids=["smooth", "kink", "kinks"],
)
class TestAgainstZoneByZone:
    """States with slits agree with states without slits. The ends of the zones are not those of
    a solution, so that the density is singular at every end.
    """

    @pytest.fixture
    def both(self, kernel, table, kinks):
        problem, zones = equation(kernel, *kinks), sie.Zones.of(table)
        plain, slit = sie.solve_fixed(problem, zones), solve_zones(problem, zones)
        assert isinstance(slit, SlitState)
        return plain, slit

    def test_density_on_every_piece(self, both, table):
        plain, slit = both
        size = np.abs(plain.density.coefficients).max()
        for piece in range(len(table)):
            difference = plain.density.at_t(piece, T) - slit.density.at_t(piece, T)
            assert np.abs(difference).max() < 3e-12 * size

    def test_intensities_and_edge_slopes(self, both):
        plain, slit = (state.density for state in both)
        for name, error in (("intensities", 1e-12), ("edge_slopes", 1e-10)):
            one, other = np.array(getattr(plain, name)), np.array(getattr(slit, name))
            assert np.abs(one - other).max() < error * np.abs(one).max()

    def test_transform_and_potential_on_the_line(self, both):
        plain, slit = (state.density for state in both)
        x = np.array([-0.5, -0.21, -0.0295, -0.1, 0.05, 0.1, 0.2, 0.3, 0.4])
        assert np.abs(plain.transform(x) - slit.transform(x)).max() < 1e-12
        assert np.abs(plain.potential(x) - slit.potential(x)).max() < 1e-14

    def test_totals_levels_and_response(self, both):
        plain, slit = both
        assert slit.density.total == pytest.approx(plain.density.total, rel=1e-14)
        assert slit.density.moment(0.1) == pytest.approx(plain.density.moment(0.1), rel=1e-12)
        assert np.ptp(np.concatenate((plain.levels, slit.levels))) < 1e-14
        unit = np.zeros(len(plain.condition_scale))
        unit[0] = 1.0
        other = np.zeros(len(slit.condition_scale))
        other[0] = 1.0
        one, two = (
            np.array(plain.response(unit).intensities),
            np.array(slit.response(other).intensities),
        )
        assert np.abs(one - two).max() < 1e-12 * np.abs(one).max()
        assert plain.level_rates(unit).mean() == pytest.approx(
            slit.level_rates(other).mean(), rel=1e-12
        )

    def test_a_wrong_sign_of_the_slits_would_show(self, both, table):
        """Without the part that slits add to the density, the density differs by more than 1e-4.
        So the tests above would show a wrong sign of this part.
        """
        plain, slit = both
        smooth = slit.density.smooth
        i = slit.geometry.piece_zone[0]
        half, w = slit.geometry.pieces.half[0], slit.geometry.wide.half[i]
        left = (slit.geometry.start[0] + half * (1 + T)) / w
        without = smooth.at(np.full(len(T), i), left, 2 - left)
        assert np.abs(without - plain.density.at_t(0, T)).max() > 1e-4 * np.abs(without).max()


def test_a_kink_beside_a_slit_is_taken_into_account():
    problem, zones = equation(sie.hilbert(1.0), (-0.02, 0.7)), sie.Zones.of(TABLES[0])
    plain, slit = sie.solve_fixed(problem, zones), solve_zones(problem, zones)
    for piece in range(2):
        assert plain.density.at_t(piece, T) == pytest.approx(slit.density.at_t(piece, T), abs=1e-12)


@pytest.mark.parametrize("half", [1e-12, 1e-15, 1e-16, 1e-18, 1e-20])
@pytest.mark.parametrize("place", [-1.0, 0.0, 0.3, 1.0])
def test_a_kink_in_a_gap_narrower_than_round_off_is_taken_into_account(half, place):
    """For such a gap, of the half width `half`, the density is that for the half width 1e-9
    within 1e-7, wherever in the gap the right side jumps.
    """
    found = [
        solve_zones(
            equation(sie.cauchy(), (part * one, -0.7)), sie.Zones.of([[-1, -one], [one, 1]])
        )
        for one, part in ((half, place), (1e-9, 0.0))
    ]
    values = [one.density.at_t(np.array([[0], [1]]), T[1:-1]) for one in found]
    assert values[0] == pytest.approx(values[1], abs=1e-7)


@pytest.mark.parametrize("kernel", quick(KERNELS, KERNELS[1:]), ids=["line", "period", "images"])
def test_jumps_of_the_right_side_and_of_its_slope_in_one_gap_are_taken_into_account(kernel):
    at, first, second = -0.0293, -0.7, 30.0

    def value(x):
        return np.sin(7 * x) + (first + second * (x - at)) * (x > at)

    def primitive(x):
        return -np.cos(7 * x) / 7 + np.where(
            x > at, first * (x - at) + 0.5 * second * (x - at) ** 2, 0.0
        )

    forcing = sie.Forcing(
        value, primitive, sie.Jumps(np.array([at, at]), np.array([first, second]), np.array([0, 1]))
    )
    problem, zones = (
        sie.Equation(kernel, forcing, (sie.Total(0.3), sie.EqualPotential())),
        sie.Zones.of(TABLES[0]),
    )
    plain, slit = sie.solve_fixed(problem, zones), solve_zones(problem, zones)
    assert isinstance(slit, SlitState)
    size = np.abs(plain.density.coefficients).max()
    for piece in range(2):
        assert plain.density.at_t(piece, T) == pytest.approx(
            slit.density.at_t(piece, T), abs=3e-12 * size
        )
    for name, error in (("intensities", 1e-12), ("edge_slopes", 1e-10)):
        one, other = (np.array(getattr(state.density, name)) for state in (plain, slit))
        assert np.abs(one - other).max() < error * np.abs(one).max()
    x = np.array([-0.5, -0.21, -0.0297, -0.0292, -0.1, 0.05, 0.2, 0.4])
    assert np.abs(plain.density.transform(x) - slit.density.transform(x)).max() < 1e-11
    # On the wide zone, the potential of a jump of the slope is a series. So potentials are
    # compared off the wide zone.
    off = x[[0, 1, 6, 7]]
    assert np.abs(plain.density.potential(off) - slit.density.potential(off)).max() < 1e-15
    # If only one of the two jumps is declared, the other one would be a jump inside the wide
    # zone, and no slit is made. Without slits the zones do not contain the gap, so both jumps
    # are outside.
    jumps = forcing.jumps
    for some in ([0], [1]):
        less = sie.Forcing(
            value, primitive, sie.Jumps(jumps.at[some], jumps.heights[some], jumps.orders[some])
        )
        other = solve_zones(sie.Equation(kernel, less, problem.conditions), zones)
        assert not isinstance(other, SlitState)
        assert np.abs(other.density.at_t(0, T) - slit.density.at_t(0, T)).max() < 1e-12 * size


@pytest.mark.parametrize("gap", [1e-3, 1e-5])
def test_the_opening_of_a_slit_with_a_kink_is_the_integral_of_its_slope(gap):
    """The slope s of the gap, `slack`, integrates to zero over the slit, so the opening is zero
    at both ends of the slit. At the kink s jumps as the right side g does. On the slit
    T phi = g - s.
    """
    kink = -0.03 + 0.3 * gap
    problem = equation(sie.cauchy(), (kink, -0.7))
    slit = solve_zones(problem, sie.Zones.of([[-0.2, -0.03], [-0.03 + gap, 0.15]]))
    assert isinstance(slit, SlitState)
    a, b = slit.geometry.slits.a[0], slit.geometry.slits.b[0]
    assert np.abs(slit.density.opening(np.array([a, b]))[1]).max() < 1e-10 * gap
    places = np.array([kink - 1e-3 * gap, kink + 1e-3 * gap])
    before, after = slit.density.slack(places)
    assert after - before == pytest.approx(-0.7, abs=0.02)
    x = np.linspace(a + 0.05 * gap, b - 0.05 * gap, 9)
    opening = slit.density.opening(x)[1]
    rule = np.array([_integral(slit.density.slack, a, x_i, kink) for x_i in x])
    assert opening == pytest.approx(rule, abs=1e-6 * gap)
    # On the slit the equation is T phi = g - s.
    assert slit.density.transform(x) == pytest.approx(
        problem.forcing.value(x) - slit.density.slack(x), abs=1e-9
    )


def _integral(function, a, b, kink):
    """The integral of a function from a to b by Gauss's rule in the angle, split at the kink."""
    nodes, weights = np.polynomial.legendre.leggauss(400)
    cuts = [a, *([kink] if kink < b else []), b]
    total = 0.0
    for lo, hi in zip(cuts[:-1], cuts[1:], strict=True):
        angle = 0.5 * np.pi * (1 + nodes)
        x, weight = (
            0.5 * (lo + hi) - 0.5 * (hi - lo) * np.cos(angle),
            0.5 * (hi - lo) * np.sin(angle) * 0.5 * np.pi,
        )
        total += float((weights * weight) @ function(x))
    return total


def test_wide_gaps_and_cracks_are_no_slits():
    wide = sie.Zones.of([[-0.2, -0.03], [0.02, 0.15]])
    assert merge(equation(sie.cauchy()), wide) is None
    cracks = sie.Equation(sie.cauchy(), sie.Forcing(np.sin), (sie.ZoneTotals(0.0),))
    assert merge(cracks, sie.Zones.of(TABLES[0])) is None


def test_a_period_is_cut_where_its_gap_is_widest():
    zones = sie.Zones.of([[-0.4999, -0.3], [-0.2, 0.1], [0.3, 0.4999]])
    wave = 2 * np.pi
    forcing = sie.Forcing(
        lambda x: np.sin(wave * x + 0.3), lambda x: -np.cos(wave * x + 0.3) / wave
    )
    problem = sie.Equation(sie.hilbert(1.0), forcing, (sie.Total(0.3), sie.EqualPotential()))
    found = merge(problem, zones)
    assert found is not None and len(found.wide) == 2 and len(found.slits) == 1
    assert found.slits.table[0] == pytest.approx([0.4999, 0.5001])
    plain, slit = (solve(problem, zones) for solve in (sie.solve_fixed, solve_zones))
    for piece in range(3):
        assert plain.density.at_t(piece, T) == pytest.approx(slit.density.at_t(piece, T), rel=1e-10)


def test_the_field_of_a_slit_at_points_off_the_slit_is_a_cauchy_integral():
    d = np.array([0.3, -0.2, 0.5])
    theta = (np.arange(400) + 0.5) * np.pi / 400
    for z in (1.2, -3.0):
        integral = np.mean(np.polynomial.chebyshev.chebval(np.cos(theta), d) / (z - np.cos(theta)))
        assert outside_slit(np.array([abs(z) - 1]), np.sign(z), d)[0] == pytest.approx(
            integral, rel=1e-13
        )


@pytest.mark.parametrize("period", [None, 1.0])
def test_cost_does_not_grow_as_the_gap_narrows(period):
    """The number of unknowns of the wide zones plus the number of modes of the slit is the same
    for gaps of 1e-3 to 1e-7 of a zone's width.
    """
    kernel = sie.cauchy() if period is None else sie.hilbert(period)
    sizes = []
    for gap in 10.0 ** -np.arange(3, 8):
        state = solve_zones(
            equation(kernel), sie.Zones.of([[-0.2, -0.03], [-0.03 + 0.17 * gap, 0.15]])
        )
        assert isinstance(state, SlitState)
        sizes.append(state.solver.size + sum(here.offset[-1] for here in state.slit_system.slits))
    assert max(sizes) == min(sizes) < 40


@pytest.mark.parametrize("gap", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("period", [None, 1.0])
def test_newton_finds_designed_ends_across_a_narrow_gap(gap, period):
    """A gap lowers the pressure around it by a fraction of about gap^2, with the gap in widths
    of a zone. Round-off in the pressure therefore moves the ends of the gap by eps / gap of a
    width.
    """
    designed = design([[-0.2, -0.03], [-0.03 + 0.17 * gap, 0.15]], 2.0, 1.0, period)
    kernel = sie.cauchy() if period is None else sie.hilbert(period)
    profile = designed.profile
    problem = sie.Equation(
        kernel,
        sie.Forcing(profile.slope, profile.height),
        (sie.Total(designed.load), sie.EqualPotential()),
    )
    start = designed.zones + 0.1 * gap * 0.17 * np.array([[1, -0.5], [0.7, 1]])
    free = sie.find_ends(problem, sie.Zones.of(start), 1e-12)
    width = np.diff(designed.zones, axis=1)
    assert np.abs((free.density.zones.table - designed.zones) / width).max() < max(
        1e-12, 20 * 2.2e-16 / gap
    )
    for piece in range(2):
        error = np.abs(free.density.at_t(piece, T) - designed.pressure_at(T, piece))
        assert error.max() < max(1e-12, 20 * 2.2e-16 / gap) * designed.max_pressure


@pytest.mark.parametrize("gap", [1e-3, 0.1])
def test_the_sensitivity_to_motions_of_ends_includes_all_ripples_of_the_density(gap):
    """`sensitivity` agrees with its definition, evaluated at 20,000 angles. The profile has two
    packets of about eight ripples. Between the zones is a slit (gap 1e-3) or a wide gap (0.1).
    """
    designed, packets = (
        design([[-0.2, -0.03], [-0.03 + 0.17 * gap, 0.15]], 2.0, 1.0),
        ((-0.12, 1300.0), (0.07, 900.0)),
    )

    def height(x):
        return designed.profile.height(x) + sum(
            3e-4 * np.exp(-(((x - c) / 0.018) ** 2)) * np.cos(k * x) for c, k in packets
        )

    def slope(x):
        parts = [(c, k, 3e-4 * np.exp(-(((x - c) / 0.018) ** 2))) for c, k in packets]
        return designed.profile.slope(x) - sum(
            size * (k * np.sin(k * x) + 2 * (x - c) / 0.018**2 * np.cos(k * x))
            for c, k, size in parts
        )

    problem = sie.Equation(
        sie.cauchy(), sie.Forcing(slope, height), (sie.Total(designed.load), sie.EqualPotential())
    )
    free = sie.find_ends(problem, sie.Zones.of(designed.zones), 1e-12)
    density = free.density
    assert free.converged and isinstance(free.state, SlitState) == (gap < 0.02)
    theta, step = np.linspace(2e-3, np.pi - 2e-3, 20_000), 1e-6
    for piece in range(2):
        before, here, after = (
            density.at_t(piece, np.cos(theta + move)) for move in (-step, 0.0, step)
        )
        slope, half = (after - before) / (2 * step), np.tan(theta / 2)
        at_left, at_right = (
            each[piece] * np.sqrt(density.zones.half[piece] / 2) for each in density.edge_slopes
        )
        exact = (
            np.abs(here).max(),
            np.abs((slope + at_left) * half).max(),
            np.abs((slope - at_right) / half).max(),
        )
        assert [each[piece] for each in density.sensitivity] == pytest.approx(exact, rel=0.1)


def many(first, second):
    """A periodic equation, and 24 zones of which two gaps are narrow, of the widths `first` and
    `second`.
    """
    rng = np.random.default_rng(3)
    table = np.cumsum(rng.uniform(0.5, 1.5, 48)).reshape(24, 2) / 60
    table[5, 0], table[17, 0] = table[4, 1] + first, table[16, 1] + second
    wave = 2 * np.pi
    forcing = sie.Forcing(
        lambda x: np.sin(wave * x + 0.3), lambda x: -np.cos(wave * x + 0.3) / wave
    )
    return sie.Equation(
        sie.hilbert(1.0), forcing, (sie.Total(0.3), sie.EqualPotential())
    ), sie.Zones.of(table)


def test_the_first_guess_for_more_modes_includes_the_high_coefficients_due_to_slits(monkeypatch):
    """A wide zone with slits has more coefficients than it would need without slits. If a solution
    with few modes is the first guess for more modes, the guess contains the additional
    coefficients.
    """
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10))
    problem, zones = many(3e-4, 3e-4)
    few, more = (solve_zones(problem, zones, tolerance) for tolerance in (1e-5, 1e-12))
    start, found = few.sizes.carried.near(more.whole.system), more.whole.folded_unknowns
    assert np.abs(start - found).max() < 1e-5 * np.abs(found).max()


def test_many_zones_by_fast_sums_have_the_same_slits(monkeypatch):
    """The iterative solution without a matrix agrees with that by a matrix, for the same
    equation and zones.
    """
    problem, zones = many(1e-5, 1e-6)
    direct = solve_zones(problem, zones)
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10))
    iterated = solve_zones(problem, zones)
    assert isinstance(iterated.solver, Iterative) and not isinstance(direct.solver, Iterative)
    size = np.abs(direct.density.coefficients).max()
    for piece in range(24):
        assert direct.density.at_t(piece, T) == pytest.approx(
            iterated.density.at_t(piece, T), abs=1e-12 * size
        )


def test_totals_of_pieces_add_up_where_the_ends_are_no_solution_and_the_density_is_singular_there():
    """The totals of the zones add up to the given total 1, although the density is singular at
    all ends.
    """
    still = sie.Forcing(np.zeros_like, np.zeros_like)
    zones = sie.Zones.of([[-1.0, -0.001], [0.001, 0.6], [0.601, 1.0]])
    density = solve_zones(
        sie.Equation(sie.cauchy(), still, (sie.Total(1.0), sie.EqualPotential())), zones
    ).density
    assert abs(density.totals.sum() - 1) < 1e-12


@pytest.mark.parametrize("most", [10**9, 10], ids=["matrix", "sums"])
@pytest.mark.parametrize("resolution", [None, 0.5], ids=["heights", "slopes"])
def test_zones_far_from_the_origin_keep_the_digits_that_their_places_lose(
    monkeypatch, most, resolution
):
    """At the distance 4096 from the origin, the ends of a zone of the width 1e-7 have a
    round-off of 1e-5 of this width. `Zones.rest` has the digits that are lost, and slits and
    fast sums use them. Without these digits (`cut`) the intensities are wrong by more than 1e-7.
    """
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=most))
    table = np.cumsum(np.random.default_rng(3).uniform(0.5, 1.5, 48)).reshape(24, 2) / 60
    table[5, 0], table[17, 0], table[9, 1] = (
        table[4, 1] + 1e-5,
        table[16, 1] + 1e-6,
        table[9, 0] + 1e-7,
    )
    away = 4096.0

    def solved(zones, by):
        forcing = sie.Forcing(
            lambda x: np.sin(6 * (x - by)),
            lambda x: -np.cos(6 * (x - by)) / 6,
            resolution=sie.Resolution(length=resolution, exact_places=True),
        ).trusted()
        return solve_zones(
            sie.Equation(sie.cauchy(), forcing, (sie.Total(0.3), sie.EqualPotential())), zones
        ).density

    near = sie.Zones.of(table)
    far = near.moved(away * np.array([[-1.0], [1.0]]) * np.ones((2, 24)))
    here, there, cut = (
        solved(near, 0.0),
        solved(far, away),
        solved(replace(far, rest=np.zeros((2, 24))), away),
    )

    def most_apart(one):
        size = np.abs(np.array(here.intensities))
        return float((np.abs(np.array(one.intensities) - here.intensities) / size).max())

    assert most_apart(there) < 1e-9 < 1e-7 < most_apart(cut)
