"""Density, transform and potential of a solution anywhere, against quadrature and identities."""

import numpy as np
import pytest

import sie
from sie.basis import sums
from tests.sie import reference
from tests.tiers import quick

ENDS = np.array([[-0.42, -0.15], [-0.05, 0.03], [0.1, 0.38]])
KINK = 0.2
FEW, MORE = [-0.4, -0.14, 0.2499, 0.45], [-0.1, 0.0, 0.035, 0.15, 0.385]
at_places = pytest.mark.parametrize("places", quick([FEW, MORE], [FEW]), ids=["few", "more"])


def value(x):
    return np.sin(2 * np.pi * x) + 0.4 * (x > KINK)


def primitive(x):
    return -np.cos(2 * np.pi * x) / (2 * np.pi) + 0.4 * np.maximum(x - KINK, 0)


def solved(kernel, kinds=sie.SINGULAR, ends=ENDS, total=0.3):
    forcing = sie.Forcing(value, primitive, sie.Jumps(np.array([KINK]), np.array([0.4])))
    equation = sie.Equation(kernel, forcing, (sie.Total(total), sie.EqualPotential()))
    return sie.solve_fixed(equation, sie.Zones.of(ends, kinds, kinds)).density


KERNELS = {
    "cauchy": (sie.cauchy(), reference.cauchy, reference.log_cauchy),
    "hilbert": (sie.hilbert(1.0), reference.hilbert(1.0), reference.log_hilbert(1.0)),
}


@pytest.fixture(scope="module", params=KERNELS)
def case(request):
    kernel, k, logarithm = KERNELS[request.param]
    return solved(kernel), k, logarithm


def at(density):
    return lambda t, zone: density.at_t(zone, t)


@at_places
def test_the_transform_is_the_principal_value_integral(case, places):
    density, kernel, _ = case
    for x in places:
        expected = reference.transform(at(density), ENDS, x, kernel, [KINK])
        assert density.transform(x) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@at_places
def test_the_potential_is_the_logarithmic_integral(case, places):
    density, _, logarithm = case
    for x in places:
        expected = reference.potential(at(density), ENDS, x, logarithm, [KINK])
        assert density.potential(x) == pytest.approx(expected, abs=1e-10)


def test_the_potential_of_a_density_wrong_by_1e_8_is_detected(case):
    density, _, logarithm = case
    wrong = reference.potential(
        lambda t, zone: density.at_t(zone, t) * (1 + 1e-8), ENDS, 0.25, logarithm, [KINK]
    )
    assert abs(density.potential(0.25) - wrong) > 1e-10


def test_the_transform_is_the_right_side_between_the_nodes(case):
    density, _, _ = case
    x = np.concatenate([a + (b - a) * np.linspace(1e-4, 1 - 1e-4, 97) for a, b in ENDS])
    assert density.transform(x) == pytest.approx(value(x), abs=2e-13)


def test_all_zones_share_one_level(case):
    density, _, _ = case
    x = np.concatenate([np.linspace(a, b, 23) for a, b in ENDS])
    assert np.ptp(density.potential(x) - primitive(x)) < 1e-14


def test_the_derivative_of_the_potential_is_the_transform(case):
    density, _, _ = case
    h = 1e-4
    for x in (-0.3, -0.1, 0.0, 0.065, 0.3, 0.41, 0.48):
        slope = (
            np.dot(
                density.potential(x + h * np.array([-2, -1, 1, 2])),
                [1 / 12, -2 / 3, 2 / 3, -1 / 12],
            )
            / h
        )
        # The fourth-order difference has an error of about h^4 / d^5, where d > 0.02 is the
        # distance from the nearest end, plus round-off of 1e-16 / h.
        assert slope == pytest.approx(float(density.transform(x)), abs=1e-7)


def test_the_potential_is_continuous_across_the_ends(case):
    density, _, _ = case
    for end in ENDS.ravel():
        beside = density.potential(end + np.array([-1e-14, 0.0, 1e-14]))
        # At the distance d from a singular end, the potential differs from that at the end by
        # about sqrt(d).
        assert np.ptp(beside) < 1e-6


def test_the_total_and_the_moment_are_those_of_the_density(case):
    density, _, _ = case
    assert density.total == pytest.approx(0.3, abs=1e-15)
    assert reference.integral(at(density), ENDS, [KINK]) == pytest.approx(0.3, abs=1e-11)
    moment = reference.integral(at(density), ENDS, [KINK], lambda x: x - 0.1)
    assert density.moment(0.1) == pytest.approx(moment, abs=1e-11)


def test_far_away_the_transform_decays_like_total_over_distance():
    density = solved(sie.cauchy())
    distances = np.array([1e2, 1e4, 1e6, 1e8])
    for sign in (-1, 1):
        x = sign * distances
        leading = density.transform(x) * np.pi * x / density.total
        # The next term of the expansion is moment / (total x), relative to the leading term.
        assert leading - 1 == pytest.approx(
            density.moment() / density.total / x, rel=0.02, abs=1e-14
        )
        assert density.potential(x) == pytest.approx(
            density.total / np.pi * np.log(distances), rel=1e-2
        )


def test_the_intensities_and_slopes_are_the_expansion_at_the_ends():
    density = solved(sie.cauchy())
    w = density.zones.half
    for side in (0, 1):
        k, a = density.intensities[side], density.edge_slopes[side]
        for i in range(3):
            d = 1e-6 * w[i]
            near, far = (d / w[i], 2 - d / w[i]) if side == 0 else (2 - d / w[i], d / w[i])
            found = float(density.at(i, near, far))
            assert found * np.sqrt(d) == pytest.approx(k[i] + a[i] * d, rel=1e-10)
            assert (found * np.sqrt(d) - k[i]) / d == pytest.approx(a[i], rel=1e-3)


def test_the_density_vanishes_exactly_at_bounded_ends_and_keeps_its_digits_beside_them():
    equation = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(np.pi / 2),))
    free = sie.find_ends(equation, sie.Zones.of([[-0.6, 0.9]]), 1e-13).density
    held = sie.solve_fixed(
        sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), ()),
        sie.Zones.of([[-1, 1]], sie.BOUNDED, sie.BOUNDED, symmetric=True),
    ).density
    d = 10.0 ** np.arange(-30, -3)
    for density in (free, held):
        assert np.all(density(density.zones.table.ravel()) == 0)
    for beside in (free.at(0, d, 2 - d), free.at(0, 2 - d, d)):
        assert beside == pytest.approx(np.sqrt(d * (2 - d)), rel=1e-12)


def test_a_singular_end_is_infinite_and_the_middle_is_not():
    equation = sie.Equation(
        sie.cauchy(), sie.Forcing(np.zeros_like, np.zeros_like), (sie.Total(1.0),)
    )
    density = sie.solve_fixed(equation, sie.Zones.of([[-1, 1]], sie.SINGULAR, sie.SINGULAR)).density
    assert np.all(np.isposinf(density([-1, 1])))
    assert density(0.0) == pytest.approx(1 / np.pi)
    assert density.transform([-1, 0, 1]) == pytest.approx(np.zeros(3), abs=1e-15)


@pytest.mark.parametrize("function", ["__call__", "transform", "potential"])
def test_results_have_the_shape_of_the_array_of_places(case, function):
    density, _, _ = case
    f = getattr(density, function)
    assert f([]).shape == (0,)
    assert f(np.zeros((0, 3))).shape == (0, 3)
    assert f(0.22).shape == ()
    grid = np.array([[0.22, 0.21, 0.5], [0.0, -0.3, 0.07]])
    flat = np.array([float(f(x)) for x in grid.ravel()])
    assert f(grid) == pytest.approx(flat.reshape(grid.shape), abs=1e-15)


@pytest.mark.parametrize("function", ["__call__", "transform", "potential"])
def test_a_place_nan_gives_nan(case, function):
    density, _, _ = case
    with np.errstate(all="ignore"):
        found = getattr(density, function)([np.nan, 0.25])
    assert np.isnan(found[0])
    assert np.isfinite(found[1])


@pytest.mark.parametrize("periods", [-3, 1, 7, 1000])
def test_with_a_period_everything_repeats(periods):
    density = solved(sie.hilbert(1.0))
    x = np.array(FEW + MORE)
    for f in (density, density.transform, density.potential):
        # After 1000 periods, the distance d from an end has a round-off of 1e-16 * 1000. Next to
        # a singular end, the relative error of the density is this round-off divided by d.
        assert f(x + periods) == pytest.approx(f(x), rel=1e-8)


@pytest.mark.parametrize("periods", [-2, 5, 100])
def test_zones_several_periods_away_are_the_same_zones(periods):
    here = solved(sie.hilbert(1.0))

    def there(x):
        return value(x - periods)

    forcing = sie.Forcing(
        there, lambda x: primitive(x - periods), sie.Jumps(np.array([KINK]), np.array([0.4]))
    )
    equation = sie.Equation(sie.hilbert(1.0), forcing, (sie.Total(0.3), sie.EqualPotential()))
    moved = sie.solve_fixed(
        equation, sie.Zones.of(ENDS + periods, sie.SINGULAR, sie.SINGULAR)
    ).density
    t = np.linspace(-0.9, 0.9, 9)
    for i in range(3):
        # The ends have a round-off of 100 eps, to be divided by the narrowest zone's width 0.08.
        assert moved.at_t(i, t) == pytest.approx(here.at_t(i, t), rel=1e-10, abs=1e-11)


def test_many_places_evaluated_in_blocks_have_the_values_of_few_places():
    density = solved(sie.cauchy())
    x = np.linspace(-0.5, 0.5, 150_001)
    some = np.arange(0, len(x), 7919)
    assert density.transform(x)[some] == pytest.approx(density.transform(x[some]), rel=1e-14)


def test_equal_positions_in_all_zones_are_evaluated_by_one_matrix_product(monkeypatch):
    density = solved(sie.hilbert(1.0))
    angle = (np.arange(40) + 0.3) * np.pi / 40
    left, right = 2 * np.cos(angle / 2) ** 2, 2 * np.sin(angle / 2) ** 2
    one_by_one = np.array([density.at(zone, left, right) for zone in range(3)])
    rows = []
    products = sums._same_places
    monkeypatch.setattr(sums, "_same_places", lambda *given: rows.append(1) or products(*given))
    together = density.at(np.arange(3)[:, None], left, right)
    assert rows == [1]
    assert np.abs(together - one_by_one).max() <= 1e-13 * np.abs(one_by_one).max()


def test_sums_of_many_sines_keep_their_digits_beside_the_end():
    rng = np.random.default_rng(4)
    angle, k = np.geomspace(1e-9, 0.5 * np.pi, 60), np.arange(1, 3001)
    columns = rng.normal(size=(3000, 2)) / k[:, None] ** 2
    whole = np.sin(angle[:, None] * k) @ columns
    assert np.abs((sums._sines(angle, columns) - whole) / np.sin(angle)[:, None]).max() < 1e-12
