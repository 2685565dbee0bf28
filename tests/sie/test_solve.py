"""Solutions on given zones: kinds of ends, number of side conditions, side conditions, symmetry,
and kernels with a regular part.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.special import j0, j1

import sie
from sie.equation.conditions import Condition
from tests.sie import exact

T = np.linspace(-0.97, 0.97, 29)
NOTHING = sie.Forcing(np.zeros_like, np.zeros_like)
LINEAR = sie.Forcing(lambda x: x, lambda x: 0.5 * x * x)


def solve(forcing, conditions, ends, left=sie.SINGULAR, right=sie.SINGULAR, kernel=None, **options):
    equation = sie.Equation(kernel or sie.cauchy(), forcing, tuple(conditions), **options)
    return sie.solve_fixed(equation, sie.Zones.of(ends, left, right))


def forcing_of(form):
    at = np.array(getattr(form, "jumps_at", ()))
    return sie.Forcing(
        form.value, form.primitive, sie.Jumps(at, np.array(getattr(form, "jumps", ())))
    )


# Closed forms
# ------------------------------------------------------------------------------------------------------
def all_zones(form):
    return [sie.Total(form.total), sie.EqualPotential()]


def each_zone(form):
    return [sie.ZoneTotals()]


def nothing(form):
    return []


CASES = [
    (exact.Flat(0.7, 2.0), sie.SINGULAR, all_zones),
    (exact.Hertz(0.7, 3.0), sie.SINGULAR, all_zones),
    (exact.PrescribedIntensity(0.7, -0.2, 3.0), sie.SINGULAR, all_zones),
    (exact.Tilted(-0.3, 0.9, 2.0), sie.BOUNDED, nothing),
    (exact.Tilted(-0.3, 0.9, 2.0), sie.SINGULAR, all_zones),
    (exact.Wedge(0.7, 1.5), sie.SINGULAR, all_zones),
    (exact.Crack(0.7, 2.0), sie.SINGULAR, each_zone),
    (exact.TwoZones(0.3, 0.8, 2.0), sie.SINGULAR, all_zones),
    (exact.PeriodicFlat(0.3, 1.0, 2.0), sie.SINGULAR, all_zones),
    (exact.PeriodicCracks(0.3, 1.0, 2.0), sie.SINGULAR, each_zone),
    (exact.Westergaard(0.3, 1.0, 2.0), sie.SINGULAR, all_zones),
    (exact.Polynomial(-0.3, 0.9, (1.0, 2.0, -3.0, 0.5), 0.8), sie.SINGULAR, all_zones),
]


@pytest.mark.parametrize(("form", "left", "conditions"), CASES)
def test_the_closed_forms_are_found(form, left, conditions):
    kernel = sie.cauchy() if form.period is None else sie.hilbert(form.period)
    density = solve(forcing_of(form), conditions(form), form.zones, left, kernel=kernel).density
    for i in range(len(form.zones)):
        wanted = form.at(T, i)
        # The tolerance allows for the round-off of the 20 modes that the solution needs.
        assert density.at_t(i, T) == pytest.approx(
            wanted, rel=1e-12, abs=2e-14 * np.abs(wanted).max()
        )
    assert density.total == pytest.approx(form.total, abs=1e-14)


def test_a_right_side_off_by_a_millionth_does_not_pass():
    form = exact.Hertz(0.7, 3.0)
    wrong = solve(sie.Forcing(lambda x: 3.000003 * x), [sie.Total(form.total)], form.zones).density
    assert np.abs(wrong.at_t(0, T) - form.at(T)).max() > 1e-7


# The four pairs of ends of a zone, and the number of conditions
# ----------------------------------------------------------------------------
def field(t, left, right):
    """A density on (-1, 1) that is singular or bounded at each end as given, with the factor
    2 + t.
    """
    power_left = 0.5 if left == sie.BOUNDED else -0.5
    power_right = 0.5 if right == sie.BOUNDED else -0.5
    return (1 + t) ** power_left * (1 - t) ** power_right * (2 + t)


def transformed(left, right):
    """The right side for the density `field`, as a polynomial. The transform of
    T_j / sqrt(1 - t^2) is -U_{j-1}, and that of sqrt(1 - t^2) U_j is T_{j+1}.
    """
    if left == right == sie.SINGULAR:  # (2 + t) / sqrt
        return lambda t: -np.ones_like(t)
    if left == right == sie.BOUNDED:  # sqrt (2 U_0 + U_1 / 2)
        return lambda t: 2 * t + (2 * t * t - 1) / 2
    if left == sie.BOUNDED:  # (1 + t)(2 + t) / sqrt = (2.5 + 3 T_1 + T_2 / 2) / sqrt
        return lambda t: -3 - t
    return lambda t: 1 + t  # (1 - t)(2 + t) / sqrt = (1.5 - T_1 - T_2 / 2) / sqrt


KINDS = list(itertools.product([sie.SINGULAR, sie.BOUNDED], repeat=2))


@pytest.mark.parametrize(("left", "right"), KINDS)
def test_each_pair_of_kinds_of_ends_has_its_index_and_its_density(left, right):
    g, index = transformed(left, right), (left == sie.SINGULAR) + (right == sie.SINGULAR) - 1
    w, middle = 0.8, 0.3
    theta = (np.arange(40) + 0.5) * math.pi / 40
    total = w * float(np.sum(field(np.cos(theta), left, right) * np.sin(theta))) * math.pi / 40
    forcing = sie.Forcing(lambda x: g((x - middle) / w))
    ends = [[middle - w, middle + w]]
    if index < 0:
        # A solution that is bounded at both ends exists only if g meets one condition. A
        # constant of unknown amplitude, added to g, makes it meet this condition.
        column = sie.Forcing(np.ones_like)
        density = solve(forcing, [], ends, left, right, columns=(column,)).density
        assert density.amplitudes == pytest.approx([0.0], abs=1e-14)
    else:
        density = solve(forcing, [sie.Total(total)][:index], ends, left, right).density
    assert density.at_t(0, T) == pytest.approx(field(T, left, right), rel=1e-12)


@pytest.mark.parametrize(("left", "right"), KINDS)
@pytest.mark.parametrize("extra", [-1, 1])
def test_one_condition_too_few_or_too_many_is_refused_by_name(left, right, extra):
    index = (left == sie.SINGULAR) + (right == sie.SINGULAR) - 1
    if index + extra < 0:
        with pytest.raises(sie.CountError, match="1 too many|2 too many"):
            solve(NOTHING, [sie.Total(1.0)], [[-1, 1]], left, right)
        return
    conditions = [sie.Total(1.0), sie.moment(0.0)][: index + extra]
    wanted = "1 more needed" if extra < 0 else "1 too many"
    with pytest.raises(sie.CountError, match=wanted):
        solve(NOTHING, conditions, [[-1, 1]], left, right)


def test_the_message_tells_index_amplitudes_and_what_was_given():
    with pytest.raises(
        sie.CountError, match=r"3 side conditions are needed \(index 2, 1 unknown amplitudes"
    ) as caught:
        solve(NOTHING, [sie.Total(1.0)], [[-2, -1], [1, 2]], columns=(sie.Forcing(np.ones_like),))
    assert "Total(value=1.0)" in str(caught.value)


def test_each_zone_adds_its_own_index():
    kinds = [sie.SINGULAR, sie.BOUNDED, sie.FREE]
    for left, right in itertools.product(kinds, kinds):
        zones = sie.Zones.of([[-2, -1], [1, 2]], [sie.SINGULAR, left], [sie.SINGULAR, right])
        index = 1 + left.surplus + right.surplus - 1
        conditions = tuple([sie.Total(1.0)] * max(index, 0))
        if index >= 0:
            sie.Equation(sie.cauchy(), NOTHING, conditions).check_count(zones)
        with pytest.raises(sie.CountError):
            sie.Equation(sie.cauchy(), NOTHING, (*conditions, sie.Total(2.0))).check_count(zones)


def test_a_condition_of_unknown_value_needs_one_on_the_ends():
    for conditions, on_ends in [
        ((sie.Total(None),), ()),
        ((sie.Total(1.0),), (sie.TotalWidth(1.0),)),
    ]:
        with pytest.raises(sie.CountError, match="unknown value.* one of each"):
            solve(NOTHING, conditions, [[-1, 1]], end_conditions=on_ends)


def test_conditions_that_depend_on_each_other_are_refused():
    same = [sie.Total(0.3), sie.Weighted(np.ones_like, 0.3)]
    with pytest.raises(sie.SingularSystem, match="depend on each other"):
        solve(NOTHING, same, [[-2, -1], [1, 2]])


def test_the_width_of_unit_logarithmic_capacity_has_no_level():
    # For the half width w = 2, log(w / 2) = 0. So the potential of the flat density vanishes on
    # the zone, whatever the total.
    with pytest.raises(sie.SingularSystem):
        solve(NOTHING, [sie.Level(1.0)], [[-2, 2]])


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_right_side_that_is_not_finite_is_refused(bad):
    with (
        np.errstate(invalid="ignore"),
        pytest.raises(
            sie.SingularSystem,
            match="the right side is not finite on the zones, for example at x = ",
        ),
    ):
        solve(sie.Forcing(lambda x: np.where(x > 0.5, bad, x)), [sie.Total(1.0)], [[-1, 1]])
    with pytest.raises(ValueError, match="Total: its value must be a finite number"):
        sie.Total(bad)


def test_zones_that_do_not_fit_into_a_period_are_refused():
    with pytest.raises(ValueError, match="the period 1"):
        solve(LINEAR, [sie.Total(1.0)], [[-0.7, 0.6]], kernel=sie.hilbert(1.0))
    with pytest.raises(ValueError, match="the period 1"):
        solve(LINEAR, [sie.Total(1.0)], [[-0.7, 0.6]], kernel=sie.images(1.0, 3))


# Side conditions
# -----------------------------------------------------------------------------------------------------
def test_a_moment_shifts_the_density():
    # The density T_1 / sqrt(1 - t^2) has the moment pi w^2 / 2 and the total zero. Its transform
    # is a constant on the zone, namely the column times its amplitude.
    conditions = [sie.Total(2.0), sie.moment(0.6)]
    density = solve(
        NOTHING, conditions, [[-0.5, 0.5]], columns=(sie.Forcing(np.ones_like),)
    ).density
    assert density.total == pytest.approx(2.0, abs=1e-15)
    assert density.moment() == pytest.approx(0.6, abs=1e-15)
    assert density.amplitudes[0] == pytest.approx(-0.6 * 2 / math.pi / 0.25, rel=1e-14)


def test_a_moment_about_another_point_subtracts_the_total():
    conditions = [sie.Total(2.0), sie.moment(0.6, about=0.3)]
    density = solve(
        NOTHING, conditions, [[-0.5, 0.5]], columns=(sie.Forcing(np.ones_like),)
    ).density
    assert density.moment(0.3) == pytest.approx(0.6, abs=1e-15)
    assert density.moment() == pytest.approx(0.6 + 0.3 * 2.0, abs=1e-14)


@pytest.mark.parametrize("frequency", [1.0, 20.0, 300.0])
def test_a_weight_may_oscillate(frequency):
    # int cos(f x) / (pi sqrt(1 - x^2)) dx = J_0(f)
    weighted = sie.Weighted(lambda x: np.cos(frequency * x), 0.25)
    density = solve(NOTHING, [weighted], [[-1, 1]]).density
    # The integral J_0(f) has the round-off of terms of the size 1. So its relative error is
    # large where J_0(f) is small.
    assert density.total == pytest.approx(0.25 / j0(frequency), rel=1e-14 / abs(j0(frequency)))


def test_a_weight_sees_all_coefficients_and_kinks():
    form = exact.Wedge(1.0, 1.0)
    # int x^2 (2/pi) arcosh(1/|x|) dx = (2/pi) (1/3) int x^2/sqrt(1 - x^2) dx = 1/3
    weighted = sie.Weighted(lambda x: x * x, 1.0 / 3.0)
    density = solve(forcing_of(form), [weighted], form.zones).density
    assert density.total == pytest.approx(form.total, rel=1e-13)


def test_totals_of_each_zone_are_met_one_by_one():
    density = solve(LINEAR, [sie.ZoneTotals((0.3, -0.1))], [[-2, -1], [1, 3]]).density
    assert density.totals == pytest.approx([0.3, -0.1], abs=1e-15)


def test_potentials_of_zones_are_equal_and_at_the_given_level():
    ends, total = [[-2, -1], [0.5, 0.7], [1, 3]], 0.4
    x = np.concatenate([np.linspace(a, b, 11) for a, b in ends])
    density = solve(LINEAR, [sie.Total(total), sie.EqualPotential()], ends).density
    levels = density.potential(x) - LINEAR.primitive(x)
    assert np.ptp(levels) < 1e-13
    again = solve(LINEAR, [sie.Level(float(levels[0]))], ends).density
    assert again.total == pytest.approx(total, rel=1e-12)
    assert again.potential(x) - LINEAR.primitive(x) == pytest.approx(levels, abs=1e-13)


def test_a_column_enters_with_its_amplitude():
    column = sie.Forcing(lambda x: np.sin(3 * x), lambda x: -np.cos(3 * x) / 3)
    ends = [[-1.0, 0.4], [0.9, 2.0]]
    known = sie.Forcing(
        lambda x: x + 0.7 * np.sin(3 * x), lambda x: 0.5 * x * x - 0.7 * np.cos(3 * x) / 3
    )
    expected = solve(known, [sie.Total(1.0), sie.EqualPotential()], ends).density
    conditions = [sie.Total(1.0), sie.EqualPotential(), sie.Amplitude(0, 0.7)]
    found = solve(LINEAR, conditions, ends, columns=(column,)).density
    assert found.amplitudes == pytest.approx([0.7], abs=1e-15)
    for i in (0, 1):
        assert found.at_t(i, T) == pytest.approx(expected.at_t(i, T), abs=1e-12)


def test_an_amplitude_may_follow_the_total():
    column = sie.Forcing(lambda x: x)
    conditions = [sie.Total(2.0), sie.Amplitude(0, 0.1, per_total=0.5)]
    density = solve(NOTHING, conditions, [[-1, 1]], columns=(column,)).density
    assert density.amplitudes == pytest.approx([1.1], abs=1e-15)
    assert density.transform(0.3) == pytest.approx(1.1 * 0.3, abs=1e-14)


@dataclass(frozen=True)
class EqualIntensities(Condition):
    """A user's own condition: the intensities at the leftmost and at the rightmost end are
    equal. It uses only the protocol of `Condition`.
    """

    def count(self, zones):
        return 1

    def rows(self, system):
        (left, left_constant), (right, right_constant) = system.intensities()
        return left[:1] - right[-1:], left_constant[:1] - right_constant[-1:], np.zeros(1)


def test_a_condition_of_the_user_is_one_class():
    column = sie.Forcing(np.ones_like)
    density = solve(
        LINEAR, [sie.Total(1.0), EqualIntensities()], [[-0.3, 0.9]], columns=(column,)
    ).density
    left, right = density.intensities
    assert left[0] == pytest.approx(right[0], rel=1e-13)
    # With equal intensities, the right side x + lambda is odd about the middle 0.3 of the zone.
    assert density.amplitudes == pytest.approx([-0.3], abs=1e-14)


# Half of a symmetric problem
# -----------------------------------------------------------------------------------------
KINKED = sie.Forcing(
    lambda x: np.sin(2 * np.pi * x) + 0.2 * np.sign(x) * (np.abs(x) > 0.38),
    lambda x: -np.cos(2 * np.pi * x) / (2 * np.pi) + 0.2 * np.maximum(np.abs(x) - 0.38, 0),
    sie.Jumps(np.array([-0.38, 0.38]), np.array([0.2, 0.2])),
)
SYMMETRIC = [
    [[-0.4, 0.4]],
    [[-0.4, -0.1], [0.1, 0.4]],
    [[-0.45, -0.3], [-0.1, 0.1], [0.3, 0.45]],
    [[-0.45, -0.35], [-0.3, -0.1], [0.1, 0.3], [0.35, 0.45]],
]


@pytest.mark.parametrize("ends", SYMMETRIC, ids=len)
@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(1.0)], ids=["cauchy", "hilbert"])
def test_a_symmetric_problem_solved_by_half_agrees_with_the_whole(ends, kernel):
    conditions = (sie.Total(0.3), sie.EqualPotential())
    equation = sie.Equation(kernel, KINKED, conditions)
    half = sie.solve_fixed(equation, sie.Zones.of(ends, sie.SINGULAR, sie.SINGULAR, symmetric=True))
    whole = sie.solve_fixed(equation, sie.Zones.of(ends, sie.SINGULAR, sie.SINGULAR))
    # The symmetric problem has at most half of the unknowns plus one.
    assert half.solver.size <= 0.5 * whole.solver.size + 1
    for i in range(len(ends)):
        assert half.density.at_t(i, T) == pytest.approx(
            whole.density.at_t(i, T), rel=1e-11, abs=1e-12
        )


@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(1.0)], ids=["cauchy", "hilbert"])
def test_a_central_zone_with_bounded_ends_needs_no_constant(kernel):
    """A solution with bounded ends exists for an odd right side. The whole problem needs a
    column, which gets the amplitude zero; the symmetric problem needs none.
    """
    half = sie.solve_fixed(
        sie.Equation(kernel, KINKED, ()),
        sie.Zones.of([[-0.4, 0.4]], sie.BOUNDED, sie.BOUNDED, symmetric=True),
    )
    whole = solve(
        KINKED,
        [],
        [[-0.4, 0.4]],
        sie.BOUNDED,
        sie.BOUNDED,
        kernel,
        columns=(sie.Forcing(np.ones_like),),
    )
    assert whole.density.amplitudes == pytest.approx([0.0], abs=1e-14)
    assert half.density.at_t(0, T) == pytest.approx(whole.density.at_t(0, T), rel=1e-11, abs=1e-12)


@pytest.mark.parametrize("ends", SYMMETRIC[1:], ids=len)
def test_an_even_weight_counts_both_halves_and_an_odd_one_neither(ends):
    zones = sie.Zones.of(ends, sie.SINGULAR, sie.SINGULAR, symmetric=True)
    conditions = (sie.Weighted(lambda x: 1 + x * x + 5 * x, 0.3), sie.EqualPotential())
    half = sie.solve_fixed(sie.Equation(sie.cauchy(), LINEAR, conditions), zones)
    whole = solve(LINEAR, [sie.Weighted(lambda x: 1 + x * x, 0.3), sie.EqualPotential()], ends)
    assert half.density.total == pytest.approx(whole.density.total, rel=1e-13)
    with pytest.raises(sie.SingularSystem, match="does not depend on the density"):
        sie.solve_fixed(
            sie.Equation(sie.cauchy(), LINEAR, (sie.moment(0.3), sie.EqualPotential())), zones
        )


def test_symmetric_zones_must_be_mirror_images():
    with pytest.raises(ValueError, match="mirror images"):
        sie.Zones.of([[0.0, 1.0]], symmetric=True)
    with pytest.raises(ValueError, match="same kind of end"):
        sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.BOUNDED, symmetric=True)


@pytest.mark.parametrize(
    "ends",
    [[], [[0, 1, 2]], [[1, 0]], [[0, 1], [1, 2]], [[0, np.nan]], [[0, np.inf]], [[0, 2], [1, 3]]],
)
def test_invalid_zones_are_refused(ends):
    with pytest.raises(ValueError, match="zone"):
        sie.Zones.of(ends)


# Regular kernels
# -----------------------------------------------------------------------------------------------------
def manufactured(k, phi, g, n=600):
    """The right side for a given density phi on (-1, 1): its Cauchy transform g, plus the
    integral with the regular kernel k by Gauss's rule.
    """
    theta = (np.arange(n) + 0.5) * math.pi / n
    xi, weight = np.cos(theta), np.sin(theta) / n

    def value(x):
        x = np.asarray(x, dtype=float)
        return g(x) + k(x[..., None], xi) @ (phi(xi) * weight)

    return value


def half_disc(t):
    return (1 + 0.3 * t) * np.sqrt(1 - t * t)


REGULAR = {
    "gauss": lambda x, xi: np.exp(-((x - xi) ** 2)),
    "odd": lambda x, xi: np.tanh(20 * (x - xi)),
    "layer": lambda x, xi: -(x - xi) / ((x - xi) ** 2 + 0.04),
    "sources only": lambda x, xi: np.cos(100 * xi) + 0 * x,
    "targets only": lambda x, xi: np.cos(100 * x) + 0 * xi,
    "both": lambda x, xi: np.sin(30 * (x - xi)) * x,
}


@pytest.mark.parametrize("name", REGULAR)
def test_a_regular_kernel_of_ones_own_is_resolved_in_both_variables(name):
    k = REGULAR[name]
    value = manufactured(k, half_disc, lambda x: x + 0.3 * (x * x - 0.5))
    state = solve(
        sie.Forcing(value), [sie.Total(math.pi / 2)], [[-1, 1]], kernel=sie.cauchy() + sie.Smooth(k)
    )
    # The tolerance is round-off of sums over up to 400 modes.
    assert state.density.at_t(0, T) == pytest.approx(half_disc(T), abs=1e-12)
    assert state.density.transform(T) == pytest.approx(value(T), abs=1e-12)


def test_a_regular_kernel_with_its_potential_levels_the_zones():
    k = sie.Smooth(lambda x, xi: np.cos(x - xi), lambda x, xi: np.sin(x - xi))
    ends = [[-2, -1], [1, 3]]
    density = solve(
        LINEAR, [sie.Total(1.0), sie.EqualPotential()], ends, kernel=sie.cauchy() + k
    ).density
    x = np.concatenate([np.linspace(a, b, 11) for a, b in ends])
    assert np.ptp(density.potential(x) - LINEAR.primitive(x)) < 1e-12
    assert density.transform(x[1:-1]) == pytest.approx(x[1:-1], abs=1e-12)


def test_a_missing_potential_or_primitive_is_named():
    kernel = sie.cauchy() + sie.Smooth(lambda x, xi: np.cos(x - xi))
    with pytest.raises(ValueError, match="potential"):
        solve(LINEAR, [sie.Total(1.0), sie.EqualPotential()], [[-2, -1], [1, 3]], kernel=kernel)
    with pytest.raises(ValueError, match="primitive"):
        solve(sie.Forcing(lambda x: x), [sie.Total(1.0), sie.EqualPotential()], [[-2, -1], [1, 3]])


# Extreme zones
# -------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("ratio", [1e-2, 1e-4, 1e-6])
def test_a_zone_a_millionth_as_wide_is_solved_beside_a_wide_one(ratio):
    ends = np.array([[-1.0, 1.0], [2.0, 2.0 + ratio]])
    density = solve(LINEAR, [sie.Total(1.0), sie.EqualPotential()], ends).density
    # On the narrow zone, the density has the round-off of the wide zone's field, which is
    # relatively large. So the transform and the potential are compared.
    x = np.concatenate(
        (np.linspace(-0.99, 0.99, 21), ends[1, 0] + ratio * np.linspace(0.01, 0.99, 21))
    )
    assert density.transform(x) == pytest.approx(x, abs=1e-12)
    assert np.ptp(density.potential(x) - LINEAR.primitive(x)) < 1e-12


@pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-5, 1e-7])
def test_bounded_densities_are_right_however_close_the_zones(gap):
    form = exact.TwoZones(0.5 * gap, 1.0)
    density = solve(
        forcing_of(form), [sie.Total(form.total), sie.EqualPotential()], form.zones
    ).density
    for i in (0, 1):
        # The density is a sum of up to 767 modes, and each mode is rounded.
        assert density.at_t(i, T) == pytest.approx(form.at(T, i), abs=1e-12)


@pytest.mark.parametrize("scale", 10.0 ** np.arange(-9, 4))
def test_the_unit_of_length_does_not_matter(scale):
    one = exact.TwoZones(0.3, 0.8)
    forcing = sie.Forcing(
        lambda x: one.value(x / scale), lambda x: scale * one.primitive(x / scale)
    )
    conditions = [sie.Total(one.total * scale), sie.EqualPotential()]
    density = solve(forcing, conditions, one.zones * scale).density
    for i in (0, 1):
        assert density.at_t(i, T) == pytest.approx(one.at(T, i), rel=1e-12, abs=1e-14)


def test_the_moment_under_a_wave_is_a_bessel_function():
    frequency = 25.0
    density = solve(
        sie.Forcing(lambda x: np.cos(frequency * x)), [sie.Total(0.0)], [[-1, 1]]
    ).density
    # The right side is cos(f t) = sum g_k U_{k-1}(t), and the moment is -pi/2 g_1. Here
    # g_1 = (2/pi) int_0^pi cos(f cos(theta)) sin(theta)^2 dtheta = 2 J_1(f) / f.
    assert density.moment() == pytest.approx(
        -math.pi / 2 * 2 * j1(frequency) / frequency, rel=1e-12
    )


def test_a_fixed_end_has_its_prescribed_intensity():
    end = sie.End(moves=False, intensity=0.7)
    forcing = sie.Forcing(lambda x: np.asarray(x, dtype=float))
    state = sie.solve_fixed(
        sie.Equation(sie.cauchy(), forcing, ()),
        sie.Zones.of([[-0.5, 0.5]], end, end, symmetric=True),
        1e-12,
    )
    assert np.allclose(state.density.intensities, 0.7, rtol=1e-13)
    # The solution of (1/pi) PV int phi / (x - xi) dxi = x is
    # phi = sqrt(w^2 - x^2) + C / sqrt(w^2 - x^2), with the half width w and C = K sqrt(2 w).
    x = np.linspace(-0.49, 0.49, 21)
    root = np.sqrt(0.25 - x * x)
    assert np.allclose(state.density(x), root + 0.7 / root, rtol=1e-12)
