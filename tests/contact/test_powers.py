"""Power laws and algebraic points, against closed forms, 30-digit integrals and the equation.

The residual of the equation is computed by Gauss's rule on panels that halve in length towards
every algebraic point, every end and the point of evaluation. This rule does not use the
solver's treatment of algebraic points. Its own error is about 1e-11 of the steepest slope.
"""

from dataclasses import dataclass
from math import factorial, pi, sqrt

import mpmath
import numpy as np
import pytest

import contact
from contact import (
    JKR,
    Combined,
    Isolated,
    Layer,
    Localized,
    Parabola,
    Periodic,
    Power,
    Scene,
    SceneError,
    Wedge,
)
from contact.exact import HertzLine, IsolatedPower, PeriodicParabola, PeriodicPower
from contact.testing import check_profile

E_STAR, L = 1e9, 1e-3
EXPONENTS = (1.001, 1.1, 1.5, 1.999, 2.0, 2.001, 2.5, 3.0, 3.7, 4.0, 7.5, 12.0)
T = np.array([0.02, 0.3, 0.7, 0.95])


def power(n, period=None):
    """A power-law profile, whose slope at x = L/2 is 0.005 n."""
    return Power(0.005 * (L / 2) ** (1 - n), n, period)


def alone(n, half_width=2e-5):
    return IsolatedPower(power(n).coefficient, n, E_STAR, half_width, datum=1e-2)


def in_a_row(n, fraction):
    return PeriodicPower.from_contact_fraction(
        fraction, coefficient=power(n).coefficient, exponent=n, period=L, E_star=E_STAR
    )


# the closed forms ---------------------------------------------------------------------------------
@pytest.mark.parametrize("n", EXPONENTS)
def test_load_and_pressure_of_an_isolated_power_are_integrals_over_punches(n):
    """The load is P = E* int_0^a f'(x) x / sqrt(a^2 - x^2) dx.

    The pressure is p = (1/pi) int_x^a P'(s) / sqrt(s^2 - x^2) ds with s = x cosh(y), where
    P'(s) is the derivative of the load by the half width, at the half width s.
    """
    exact = IsolatedPower(0.3, n, 2.0, 1.7)
    with mpmath.workdps(30):
        n_, a = mpmath.mpf(n), mpmath.mpf(1.7)
        load = (
            2
            * n_
            * mpmath.mpf(0.3)
            * mpmath.quad(lambda turn: (a * mpmath.sin(turn)) ** n_, [0, mpmath.pi / 2])
        )
        assert exact.load == pytest.approx(float(load), rel=2e-15)
        for t in (1e-6, 0.2, 0.49, 0.51, 0.9, 0.999):
            cuts = mpmath.linspace(0, mpmath.acosh(1 / mpmath.mpf(t)), 9)
            punches = mpmath.quad(lambda y, t=t: (mpmath.mpf(t) * mpmath.cosh(y)) ** (n_ - 1), cuts)
            # `exact` sums two series for the pressure near the tip. If n is close to 1, their sum
            # is only about n - 1 times each of them, so that digits cancel.
            expected = float(n_ * load / (mpmath.pi * a) * punches)
            assert exact.pressure_at(t) == pytest.approx(expected, rel=1e-13 + 1e-15 / (n - 1))


@pytest.mark.parametrize("fraction", (0.05, 0.6, 0.9))
def test_the_power_two_is_the_parabola(fraction):
    row = PeriodicPower.from_contact_fraction(
        fraction, coefficient=0.5, exponent=2.0, period=1.3, E_star=2.0
    )
    parabola = PeriodicParabola.from_contact_fraction(fraction, radius=1.0, period=1.3, E_star=2.0)
    x = 0.65 * np.array([0.1, 0.4, 0.59, 0.7, 0.95])
    for name in ("load", "approach", "stiffness"):
        assert getattr(row, name) == pytest.approx(getattr(parabola, name), rel=1e-13)
    np.testing.assert_allclose(row.pressure(x), parabola.pressure(x), rtol=1e-12)
    np.testing.assert_allclose(row.gap(x), parabola.gap(x), rtol=1e-12)
    lone, hertz = IsolatedPower(0.5, 2.0, 2.0, 0.1, datum=3.0), HertzLine(1.0, 2.0, 0.1, datum=3.0)
    np.testing.assert_allclose(lone.gap(x), hertz.gap(x), rtol=1e-12)
    assert lone.approach == pytest.approx(hertz.approach, rel=1e-14)


@pytest.mark.parametrize(
    "exact", [alone(1.5), alone(6.3), in_a_row(1.3, 0.5), in_a_row(3.3, 0.8)], ids=str
)
def test_exact_powers_follow_again_from_their_loads(exact):
    shape = {name: getattr(exact, name) for name in ("coefficient", "exponent", "E_star")}
    shape |= {"datum": exact.datum} if exact.period is None else {"period": exact.period}
    assert type(exact).from_load(exact.load, **shape).half_width == pytest.approx(
        exact.half_width, rel=1e-13
    )


def test_the_peak_of_a_steep_power_is_off_the_middle():
    exact = alone(6.0)
    highest = exact.pressure_at(np.linspace(0, 1, 20001)).max()
    assert highest <= exact.max_pressure * (1 + 1e-15) and exact.max_pressure == pytest.approx(
        highest, rel=1e-7
    )
    assert exact.max_pressure > 1.5 * exact.pressure_at(0.0)


# the solver against the closed forms --------------------------------------------------------------
def off(solution, exact):
    """The larger of the end error over the width and the pressure error over the peak."""
    ends = np.abs(solution.zones - [[-exact.half_width, exact.half_width]]).max() / (
        2 * exact.half_width
    )
    return max(
        ends, np.abs(solution.pressure_at(T) - exact.pressure_at(T)).max() / solution.max_pressure
    )


@pytest.mark.parametrize("n", EXPONENTS)
def test_an_isolated_power_has_its_closed_form_over_ten_decades_of_load(n):
    for half_width in (1e-9, 1e-6, 1e-3):
        exact = alone(n, half_width)
        solution = contact.solve(Scene(power(n), E_STAR, Isolated(datum=1e-2), load=exact.load))
        assert off(solution, exact) <= solution.error <= 1e-8
        assert solution.approach == pytest.approx(exact.approach, rel=1e-8)
        assert solution.max_pressure == pytest.approx(exact.max_pressure, rel=1e-8)


@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize("fraction", (1e-4, 0.3, 0.7, 0.95))
def test_a_periodic_power_agrees_with_its_integral(n, fraction):
    exact = in_a_row(n, fraction)
    solution = contact.solve(Scene(power(n, L), E_STAR, Periodic(), load=exact.load))
    # The reference solution has an error of about 1e-12.
    assert off(solution, exact) <= solution.error + 1e-12 and solution.error <= 1e-8
    assert solution.approach == pytest.approx(exact.approach, rel=1e-8)
    x = exact.half_width + (L / 2 - exact.half_width) * np.array([0.1, 0.6, 0.99])
    np.testing.assert_allclose(solution.gap(x), exact.gap(x), rtol=1e-8)


@pytest.mark.parametrize("control", ("mean_pressure", "approach", "half_width", "contact_fraction"))
@pytest.mark.parametrize(("n", "fraction"), [(1.2, 0.4), (2.7, 0.9)])
def test_every_control_finds_the_same_periodic_contact(control, n, fraction):
    exact = in_a_row(n, fraction)
    solution = contact.solve(
        Scene(power(n, L), E_STAR, Periodic(), **{control: getattr(exact, control)})
    )
    assert off(solution, exact) <= solution.error <= 1e-8
    assert solution.load == pytest.approx(exact.load, rel=1e-8)


@pytest.mark.parametrize(("n", "fraction"), [(3.3, 1e-6), (8.6, 0.008), (11.3, 1e-6)])
def test_an_approach_far_below_the_largest_height_gives_a_tiny_contact(n, fraction):
    exact = in_a_row(n, fraction)
    scene = Scene(power(n, L), E_STAR, Periodic(), approach=exact.approach)
    assert off(contact.solve(scene), exact) <= 1e-8


@pytest.mark.parametrize("n", (1.5, 6.3))
def test_an_isolated_power_has_approach_and_half_width_controls(n):
    exact = alone(n)
    for control in ("approach", "half_width"):
        solution = contact.solve(
            Scene(power(n), E_STAR, Isolated(datum=1e-2), **{control: getattr(exact, control)})
        )
        assert solution.load == pytest.approx(exact.load, rel=1e-8)


def test_the_power_one_is_the_wedge():
    for period, load in ((None, 3.0), (L, 3e3)):
        model = Isolated() if period is None else Periodic()
        one, other = (
            contact.solve(Scene(shape, E_STAR, model, load=load))
            for shape in (Power(0.01, 1.0, period), Wedge(0.01, period))
        )
        np.testing.assert_allclose(one.zones, other.zones, rtol=1e-10)


@pytest.mark.parametrize("n", (1.5, 2.7, 5.2))
def test_jkr_adhesion_adds_the_load_of_a_flat_punch(n):
    """The load is P = P_0(a) + pi K sqrt(2 a) (M. Barquins, J. Adhesion 26, 1988, 1-12).

    P_0 is the load without adhesion, a the half width and K < 0 the edge intensity.
    """
    exact, law = alone(n), JKR(work=1e-3)
    solution = contact.solve(
        Scene(power(n), E_STAR, Isolated(), law=law, half_width=exact.half_width)
    )
    expected = exact.load + pi * law.intensity(E_STAR) * sqrt(2 * exact.half_width)
    assert solution.load == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("n", (1.3, 3.3))
@pytest.mark.parametrize("fraction", (0.2, 0.7, 0.95))
def test_the_localized_contact_tends_to_the_periodic_one_as_neighbours_are_added(n, fraction):
    exact, off_by = in_a_row(n, fraction), []
    for neighbours in (2, 6):
        model = Localized(closure="self-consistent", neighbours=neighbours)
        solution = contact.solve(Scene(power(n, L), E_STAR, model, half_width=exact.half_width))
        assert solution.error <= 1e-8
        off_by.append(abs(solution.load / exact.load - 1))
    # The error of the model falls as (2m + 1)^-3 with m neighbours (docs/theory.md).
    assert off_by[0] / off_by[1] == pytest.approx((13 / 5) ** 3, rel=0.1)


@pytest.mark.parametrize("fraction", (0.3, 0.9))
def test_a_thick_layer_is_a_half_plane(fraction):
    exact = in_a_row(1.7, fraction)
    solution = contact.solve(
        Scene(
            power(1.7, L),
            E_STAR,
            Periodic(),
            substrate=Layer(8 * L, 0.3),
            contact_fraction=fraction,
        )
    )
    assert solution.load == pytest.approx(exact.load, rel=1e-8)


# profiles of users --------------------------------------------------------------------------------
@dataclass(frozen=True)
class Tips(contact.Profile):
    """The parabola x^2/(2 R) plus powers of the distance from several places.

    Each row has a place, an exponent, and the coefficients to the left and to the right.
    """

    rows: tuple
    radius: float
    period: float | None = None

    def height(self, x):
        x = np.asarray(x, dtype=float)
        return x**2 / (2 * self.radius) + sum(
            np.where(x < s, l, r) * np.abs(x - s) ** n for s, n, l, r in self.rows
        )

    def slope(self, x):
        x = np.asarray(x, dtype=float)
        return x / self.radius + sum(
            np.where(x < s, -l, r) * n * np.abs(x - s) ** (n - 1) for s, n, l, r in self.rows
        )

    @property
    def algebraic_points(self):
        return np.array(self.rows)


@dataclass(frozen=True)
class Row(contact.Profile):
    """A periodic profile: a wave of amplitude A plus terms c |(L/pi) sin(pi (x - s)/L)|^n.

    Each row has the place s, the exponent n and the coefficient c. The algebraic points come
    from the series (sin v)^n = v^n (1 - n v^2/6 + ...).
    """

    rows: tuple
    amplitude: float = 0.0
    period: float = L

    def height(self, x):
        u = pi * np.asarray(x, dtype=float) / L
        tips = sum(c * (L / pi * np.abs(np.sin(u - pi * s / L))) ** n for s, n, c in self.rows)
        return 2 * self.amplitude * np.sin(u) ** 2 + tips

    def slope(self, x):
        u = pi * np.asarray(x, dtype=float) / L
        out = 2 * self.amplitude * pi / L * np.sin(2 * u)
        for s, n, c in self.rows:
            v = u - pi * s / L
            v = v - pi * np.round(v / pi)
            out = out + c * n * (L / pi * np.abs(np.sin(v))) ** (n - 1) * np.sign(v) * np.cos(v)
        return out

    @property
    def algebraic_points(self):
        out, terms = [], 8
        sinc = [(-1) ** k / factorial(2 * k + 1) for k in range(terms)]
        for s, n, c in self.rows:
            series = [1.0]
            for m in range(1, terms):
                series.append(
                    sum((k * n - (m - k)) * sinc[k] * series[m - k] for k in range(1, m + 1)) / m
                )
            out += [
                [s, n + 2 * k, c * one * (pi / L) ** (2 * k), c * one * (pi / L) ** (2 * k)]
                for k, one in enumerate(series)
            ]
        return np.array(out)


def rule(a, b, places):
    """Nodes and weights of Gauss's rule on panels that halve towards places and both ends."""
    halved = (b - a) * 0.5 ** np.arange(1, 45)
    cuts = np.concatenate(
        [[a, b], *(s + sign * halved for s in (a, b, *places) for sign in (-1, 1)), places]
    )
    cuts = np.unique(cuts[(cuts >= a) & (cuts <= b)])
    cuts = cuts[np.append(True, np.diff(cuts) > 1e-15 * (abs(a) + abs(b)))]
    t, weight = np.polynomial.legendre.leggauss(20)
    half, middle = 0.5 * np.diff(cuts)[:, None], 0.5 * (cuts[1:] + cuts[:-1])[:, None]
    return (middle + half * t).ravel(), (half * weight).ravel()


def residual(solution):
    """The largest |(2/E*) (1/pi) PV int p K - f'| at points in contact, over the largest |f'|."""
    profile, zones = solution.scene.profile, solution.zones
    period = profile.period
    tips = np.unique(profile.algebraic_points[:, 0])
    tips = tips if period is None else np.concatenate([tips + turn * period for turn in (-1, 0, 1)])
    at = np.concatenate([a + (b - a) * np.array([0.07, 0.33, 0.52, 0.8, 0.95]) for a, b in zones])
    out = []
    for x in at:
        total = 0.0
        for a, b in zones:
            own = a < x < b
            xi, weight = rule(a, b, [s for s in (*tips, *([x] if own else [])) if a < s < b])
            here = solution.pressure(np.array([x]))[0] if own else 0.0
            away = np.where(xi == x, np.inf, x - xi)  # a node equal to x has a negligible weight
            kernel = (
                1 / away
                if period is None
                else pi / period / np.tan(pi * np.where(xi == x, period / 2, away) / period)
            )
            total += weight @ ((solution.pressure(xi) - here) * kernel)
            if own:
                ends = (
                    np.array([x - a, b - x])
                    if period is None
                    else np.sin(pi * np.array([x - a, b - x]) / period)
                )
                total += here * np.log(ends[0] / ends[1])
        out.append(2 / (pi * E_STAR) * total - profile.slope(np.array([x]))[0])
    return np.abs(out).max() / np.abs(profile.slope(at)).max()


UNLIKE = {
    "two far tips": Tips(((-1e-3, 1.5, 0.3, 0.3), (1e-3, 2.5, 30.0, 30.0)), 1.0),
    "skew tips": Tips(((-1e-3, 1.3, 0.01, 0.02), (1e-3, 1.7, 0.05, 0.03)), 1e3),
    "one side alone": Tips(((0.0, 1.5, 0.0, 0.01), (3e-5, 3.0, 10.0, 20.0)), 1e-2),
    "tips and a valley": Tips(
        ((-3e-5, 1.05, 0.0, 0.001), (3e-5, 1.9, 0.1, 0.2), (1e-6, 1.5, -1e-3, -1e-3)), 1e-2
    ),
}


@pytest.mark.parametrize("shape", UNLIKE)
@pytest.mark.parametrize("load", (0.013, 110.0, pytest.param(1e4, marks=pytest.mark.slow)))
def test_user_profiles_with_unlike_powers_solve_the_equation(shape, load):
    solution = contact.solve(Scene(UNLIKE[shape], E_STAR, Isolated(), load=load))
    assert residual(solution) < 10 * solution.error + 1e-11 and solution.error <= 1e-8


ROWS = {
    "tip": Row(((0.0, 1.5, 0.1),)),
    "two tips": Row(((-0.2 * L, 1.5, 0.02), (0.23 * L, 2.7, 5.0)), 1e-6),
    "valley": Row(((-0.5 * L, 1.4, -0.02),), 2e-6),
    "tip and valley": Row(((0.01 * L, 1.6, 0.02), (0.45 * L, 1.2, -0.005)), 2e-6),
}


@pytest.mark.parametrize("shape", ROWS)
@pytest.mark.parametrize("fraction", (0.01, 0.5, 0.9, pytest.param(0.999, marks=pytest.mark.slow)))
def test_periodic_user_profiles_solve_the_equation_by_zones_and_by_gaps(shape, fraction):
    solution = contact.solve(Scene(ROWS[shape], E_STAR, Periodic(), contact_fraction=fraction))
    assert residual(solution) < 10 * solution.error + 1e-11 and solution.error <= 1e-8


@pytest.mark.parametrize("shape", ROWS)
def test_full_contact_of_algebraic_points_follows_from_the_hilbert_transform(shape):
    """The pressure is p = pbar - (E*/2) (1/L) PV int f'(xi) cot(pi (x - xi)/L) dxi.

    The contact fraction 1 is the beginning of full contact, where the least pressure is zero.
    """
    profile = ROWS[shape]
    solution = contact.solve(Scene(profile, E_STAR, Periodic(), contact_fraction=1.0))
    tips = np.unique(profile.algebraic_points[:, 0])
    for x in (-0.31 * L, 0.07 * L, 0.2 * L):
        xi, weight = rule(
            x - L / 2,
            x + L / 2,
            [s for t in tips for s in (t - L, t, t + L) if abs(s - x) < L / 2] + [x],
        )
        cot = 1 / np.tan(pi * (x - xi) / L)
        conjugate = weight @ ((profile.slope(xi) - profile.slope(np.array([x]))) * cot) / L
        expected = solution.mean_pressure - 0.5 * E_STAR * conjugate
        assert solution.pressure(np.array([x]))[0] == pytest.approx(
            expected, abs=1e-10 * solution.max_pressure
        )
    least = solution.pressure(np.append(np.linspace(-L / 2, L / 2, 2001), tips)).min()
    assert -1e-10 * solution.max_pressure < least < 1e-4 * solution.max_pressure


@pytest.mark.slow
def test_two_bodies_with_powers_solve_the_equation():
    profile = Combined(Power(0.2, 1.5, L), Power(0.02, 1.7, L), 0.17 * L, mirrored=True)
    for fraction in (0.3, 0.9):
        solution = contact.solve(Scene(profile, E_STAR, Periodic(), contact_fraction=fraction))
        assert residual(solution) < 10 * solution.error + 1e-11


def test_a_turned_power_is_the_mirror_image_of_one_turned_the_other_way():
    one, other = (
        contact.solve(Scene(power(1.5), E_STAR, Isolated(), load=30.0, moment=moment))
        for moment in (5e-4, -5e-4)
    )
    np.testing.assert_allclose(one.zones, -other.zones[:, ::-1], rtol=1e-9)
    assert one.zones[0, 0] + one.zones[0, 1] > 1e-6


@pytest.mark.slow
def test_an_algebraic_point_that_is_not_declared_prevents_convergence():
    """Without a declared algebraic point, the coefficients fall too slowly."""

    class Undeclared(Power):
        algebraic_points = np.empty((0, 4))

    with pytest.raises(contact.NotConverged):
        contact.solve(Scene(Undeclared(power(1.5).coefficient, 1.5), E_STAR, Isolated(), load=30.0))


# refused input, checks of profiles, and the plan --------------------------------------------------
@pytest.mark.parametrize("exponent", (0.0, -1.0, 0.3, 0.999, np.nan, np.inf, "2", True))
def test_exponents_below_one_are_refused_by_name(exponent):
    with pytest.raises(SceneError, match="exponent"):
        Power(1.0, exponent)


@pytest.mark.parametrize(
    "rows",
    ([[0.0, 1.0, 1.0, 1.0]], [[0.0, 0.5, 1.0, 1.0]], [[0.0, 1.5, 1.0]], [[0.0, 1.5, np.nan, 1.0]]),
)
def test_invalid_algebraic_points_are_refused_by_name(rows):
    class Odd(Parabola):
        algebraic_points = np.array(rows)

    with pytest.raises(SceneError, match="algebraic_points"):
        Scene(Odd(1e-2), E_STAR, Isolated(), load=1.0)


@pytest.mark.parametrize("n", (1.001, 1.5, 2.5, 3.0, 4.7, 12.0))
@pytest.mark.parametrize("period", (None, L))
def test_a_power_passes_check_profile(n, period):
    assert check_profile(Power(0.01, n, period)).ok


@pytest.mark.parametrize("n", (1.05, 1.5, 1.999, 2.5, 4.7, 6.3))
def test_check_profile_finds_an_error_of_one_percent_in_a_coefficient(n):
    class Off(Power):
        @property
        def algebraic_points(self):
            return super().algebraic_points * [[1.0, 1.0, 1.0, 1.01]]

    report = check_profile(Off(0.01, n), raises=False)
    assert any("algebraic_points" in fault and "right" in fault for fault in report.faults)


def test_the_plan_counts_algebraic_points():
    solution = contact.solve(Scene(power(1.5), E_STAR, Isolated(), load=1.0))
    assert solution.plan["kinks"].used and "1 algebraic point" in solution.plan["kinks"].reason
