"""The paper, equation by equation and statement by statement.

Closed forms are compared with the solver under the same closure and with quadrature, printed
equations with correct ones, and the results section with exact solutions.
"""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import j0, j1

import contact
from contact import paper
from contact.reference import exact
from tests.contact import paper_forms, reference

L = 1e-4
E_STAR = 1.1e11
SHARES = (0.05, 0.2, 0.35, 0.45)  # a/L
CLOSURES = (paper.FIRST_ORDER, paper.SELF_CONSISTENT)

FAMILIES = {
    "wave": (
        paper.localized_wave,
        {"amplitude": 1e-6},
        contact.Sinusoid(1e-6, L),
        exact.Westergaard,
    ),
    "wedge": (
        paper.localized_wedge,
        {"wedge_slope": 0.02},
        contact.Wedge(0.02, L),
        exact.PeriodicWedge,
    ),
    "parabola": (
        paper.localized_parabola,
        {"radius": 2e-3},
        contact.Parabola(2e-3, L),
        exact.PeriodicParabola,
    ),
}
ALONE = {"wave": exact.IsolatedSinusoid, "wedge": exact.IsolatedWedge, "parabola": exact.HertzLine}
families = pytest.mark.parametrize("family", FAMILIES)
closures = pytest.mark.parametrize("closure", CLOSURES)

# The parameters of figure 13: E* = 1, R = 1, c = 0.05, L = 2.4c.
C = 0.05
PAIR = {"radius": 1.0, "spacing": 2 * C, "period": 2.4 * C, "E_star": 1.0, "mean_pressure": 0.00109}


def example(family, share, closure=paper.FIRST_ORDER):
    made, shape, _, _ = FAMILIES[family]
    return made(period=L, E_star=E_STAR, half_width=share * L, closure=closure, **shape)


def solved(family, closure, **control):
    return contact.solve(
        contact.Scene(FAMILIES[family][2], E_STAR, contact.Localized(closure), **control), tol=1e-11
    )


class TestOneZone:
    @families
    @closures
    @pytest.mark.parametrize("share", SHARES)
    def test_the_closed_form_is_the_solver_s_answer_with_the_same_closure(
        self, family, closure, share
    ):
        ours, theirs = (
            example(family, share, closure),
            solved(family, closure, half_width=share * L),
        )
        assert theirs.load == pytest.approx(ours.load, rel=1e-10)
        t = np.linspace(-0.99, 0.99, 34)  # without the tip, where a wedge's pressure is infinite
        scale = ours.load / (2 * ours.half_width)
        assert np.max(np.abs(theirs.pressure_at(t) - ours.pressure_at(t))) < 1e-9 * scale
        assert np.max(np.abs(1.00001 * theirs.pressure_at(t) - ours.pressure_at(t))) > 1e-9 * scale

    @families
    @closures
    @pytest.mark.parametrize("share", SHARES)
    def test_the_closed_form_is_the_quadrature_of_14_15_and_17(self, family, closure, share):
        ours = example(family, share, closure)
        slope = FAMILIES[family][2].slope
        shape = paper_forms.LocalizedShape(
            lambda x: np.asarray(slope(x)), E_STAR, L, share * L, closure
        )
        x = share * L * np.linspace(0.01, 0.999, 40)
        assert shape.load == pytest.approx(ours.load, rel=1e-13)
        assert shape.mean_pressure == pytest.approx(ours.mean_pressure, rel=1e-13)
        np.testing.assert_allclose(shape.pressure(x), ours.pressure(x), rtol=1e-11)
        np.testing.assert_allclose(shape.pressure_14(x), ours.pressure(x), rtol=1e-10)

    @families
    @closures
    def test_the_load_controls_the_half_width(self, family, closure):
        ours = example(family, 0.3, closure)
        again = exact.localized_at_load(
            ALONE[family], ours.load, L, closure, E_star=E_STAR, **FAMILIES[family][1]
        )
        assert again.half_width == pytest.approx(0.3 * L, rel=1e-13)
        assert solved(family, closure, mean_pressure=ours.mean_pressure).zones[
            0, 1
        ] == pytest.approx(0.3 * L, rel=1e-9)

    @pytest.mark.parametrize("share", SHARES)
    def test_the_wave_has_the_mean_and_the_peak_of_23_and_24(self, share):
        a, ours = share * L, example("wave", share)
        s = np.sqrt(1 - 4 * share**2)
        mean = np.pi**2 * 1e-6 * E_STAR / L**2 * a * j1(2 * np.pi * share) * (2 - s)
        own = np.pi * 1e-6 * E_STAR / L * quad(j0, 0, 2 * np.pi * share)[0]
        beside = (
            2 * np.pi * 1e-6 * E_STAR / L**2 * a * j1(2 * np.pi * share) * np.arctan(2 * share / s)
        )
        assert ours.mean_pressure == pytest.approx(mean, rel=1e-14)
        assert ours.max_pressure == pytest.approx(own + beside, rel=1e-13)
        assert ours.contact_fraction == 2 * share and ours.zones.tolist() == [[-a, a]]

    @pytest.mark.parametrize("share", SHARES)
    def test_wedge_and_parabola_have_the_pressures_and_loads_of_26_27_29_and_30(self, share):
        a, s = share * L, np.sqrt(1 - 4 * share**2)
        x = a * np.linspace(0.01, 0.99, 23)
        angle = np.arctan(2 * np.sqrt(a * a - x * x) / (L * s))
        wedge, parabola = example("wedge", share), example("parabola", share)
        unit = E_STAR * 0.02
        np.testing.assert_allclose(
            wedge.pressure(x),
            unit / np.pi * np.arccosh(a / x) + 2 * unit * a / (np.pi * L) * angle,
            rtol=1e-12,
        )
        assert wedge.mean_pressure == pytest.approx(unit * share * (2 - s), rel=1e-14)
        own = E_STAR / 4e-3 * np.sqrt(a * a - x * x)
        np.testing.assert_allclose(
            parabola.pressure(x), own + E_STAR * a * a / (4e-3 * L) * angle, rtol=1e-12
        )
        assert parabola.load == pytest.approx(np.pi * E_STAR * a * a / 8e-3 * (2 - s), rel=1e-14)

    def test_a_zone_as_wide_as_the_period_is_refused(self):
        with pytest.raises(contact.SceneError, match="half_width"):
            example("parabola", 0.5)

    def test_the_package_never_imports_the_solver(self):
        allowed = (
            "contact.reference.exact",
            "contact.paper",
            "contact.model.checks",
            "contact.errors",
        )
        for file in Path(paper.__file__).parent.glob("*.py"):
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("contact"):
                    assert node.module.startswith(allowed), f"{file.name}: {node.module}"


class TestErrata:
    def test_equation_6_holds_with_one_over_pi_and_gives_half_the_slope_as_printed(self):
        hertz = exact.HertzLine(2e-3, E_STAR, 0.3 * L)
        t = np.linspace(-0.95, 0.95, 21)
        right = paper_forms.cauchy_slope(hertz.pressure_at, hertz.half_width, E_STAR, t)
        np.testing.assert_allclose(right, 0.3 * L * t / 2e-3, atol=1e-12 * 0.3 * L / 2e-3)
        wrong = paper_forms.printed_cauchy_slope(hertz.pressure_at, hertz.half_width, E_STAR, t)
        np.testing.assert_allclose(wrong, 0.15 * L * t / 2e-3, atol=1e-12 * 0.3 * L / 2e-3)

    def test_equation_8_as_printed_has_the_sign_with_which_7_would_give_a_tension(self):
        shape = paper_forms.LocalizedShape(lambda x: x / 2e-3, E_STAR, L, 0.3 * L)
        x = 0.3 * L * np.linspace(0.1, 0.9, 9)
        np.testing.assert_array_equal(shape.printed_contact_slope(x), -shape.contact_slope(x))
        assert np.all(shape.contact_slope(x) > x / 2e-3) and np.all(shape.pressure(x) > 0)

    def test_equation_12_as_printed_is_minus_e_star_times_the_slope_that_the_strips_make(self):
        x = np.array([0.05, 0.12, 0.3, 0.42]) * L
        right = paper_forms.strip_slope(x, 0.4 * L, L, 2e7, E_STAR)
        wrong = paper_forms.printed_strip_slope(x, 0.4 * L, L, 2e7, terms=200_000)
        np.testing.assert_allclose(
            wrong, -E_STAR * right, rtol=1e-3
        )  # the truncation error of the sum is of order 1/terms
        # The same slope by its definition u' = -(2/(pi E*)) int p (pi/L) cot(pi (x - xi)/L) dxi, at
        # a point x outside the strips of pressure p.
        outside = 0.3 * L
        made = quad(lambda xi: np.pi / L / np.tan(np.pi * (outside - xi) / L), -0.2 * L, 0.2 * L)[0]
        assert right[2] == pytest.approx(-2 * 2e7 / (np.pi * E_STAR) * made, rel=1e-12)

    def test_a_uniform_pressure_everywhere_causes_no_slope(self):
        x = np.linspace(-0.45, 0.45, 7) * L
        assert (
            np.max(np.abs(paper_forms.strip_slope(x, L, L, 2e7, E_STAR)))
            < 1e-15 * 2e7 / E_STAR * 100
        )

    def test_equation_17_as_its_brackets_stand_gives_the_same_semi_ellipse_for_every_shape(self):
        x = 0.3 * L * np.linspace(0.05, 0.9, 8)
        a = 0.3 * L
        for slope in (lambda s: s / 2e-3, lambda s: 0.02 * np.sign(s)):
            printed = paper_forms.PrintedLocalizedShape(slope, E_STAR, L, a)
            right = paper_forms.LocalizedShape(slope, E_STAR, L, a)
            np.testing.assert_allclose(
                printed.isolated_pressure(x),
                np.sqrt(a * a - x * x) * right.isolated_load / np.pi,
                rtol=1e-13,
            )
            # The printed expression has the dimension of a load, not of a pressure. In these units
            # it is far too small.
            assert np.all(printed.isolated_pressure(x) < 1e-6 * right.isolated_pressure(x))

    def test_equation_18_as_printed_does_not_add_up_to_19(self):
        args = (1e-6, L, E_STAR, 0.3 * L)
        right, printed = exact.Westergaard(*args), paper_forms.PrintedWestergaard(*args)
        x = np.linspace(-0.29, 0.29, 11) * L
        np.testing.assert_allclose(
            printed.pressure(x), right.pressure(x) / np.sqrt(np.pi * E_STAR * 1e-6), rtol=1e-10
        )
        assert quad(right.pressure, -0.3 * L, 0.3 * L)[0] == pytest.approx(right.load, rel=1e-7)
        assert quad(printed.pressure, -0.3 * L, 0.3 * L)[0] / right.load == pytest.approx(
            1 / np.sqrt(np.pi * E_STAR * 1e-6)
        )

    def test_equation_26_as_printed_is_nan_on_the_left_half(self):
        printed = paper_forms.PrintedLocalizedWedge(exact.IsolatedWedge(0.02, E_STAR, 0.3 * L), L)
        x = 0.3 * L * np.linspace(0.05, 0.95, 7)
        np.testing.assert_allclose(
            printed.pressure(x), example("wedge", 0.3).pressure(x), rtol=1e-12
        )
        assert np.all(np.isnan(printed.pressure(-x)))

    @families
    def test_the_examples_take_the_isolated_load_for_p_s_and_16_gives_another_closure(self, family):
        first, consistent = example(family, 0.35), example(family, 0.35, paper.SELF_CONSISTENT)
        s = np.sqrt(1 - 0.49)
        assert first.load == pytest.approx(first.isolated.load * (2 - s), rel=1e-14)
        assert consistent.load == pytest.approx(first.isolated.load / s, rel=1e-14)
        assert (
            first.nominal_load == first.isolated.load and consistent.nominal_load == consistent.load
        )

    @families
    @pytest.mark.parametrize("fraction", np.linspace(0.2, 0.98, 14))
    def test_first_order_is_the_more_accurate_closure_at_every_width_from_a_fifth_on(
        self, family, fraction
    ):
        assert abs(example(family, fraction / 2).load_error) < abs(
            example(family, fraction / 2, paper.SELF_CONSISTENT).load_error
        )


class TestTwoZones:
    @pytest.mark.parametrize("share", (1e-4, 0.05, 0.5, 0.95))
    def test_the_exact_periodic_pair_solves_its_equation_and_carries_its_load(self, share):
        top = 0.0046  # the zones merge a little above this
        pair = exact.PeriodicBiquadratic(**{**PAIR, "mean_pressure": share * top})
        # The nearest zone of the next period is close, so the quadrature needs many nodes.
        assert reference.equation_error(pair, nodes=1200) < 1e-11 / min(1.0, 100 * share)
        assert reference.load_of(pair, 2000) == pytest.approx(pair.load, rel=1e-9)
        assert pair.pair.load == pytest.approx(pair.load, rel=1e-8)

    def test_a_pair_with_a_wrong_end_does_not_solve_the_equation(self):
        pair = exact.PeriodicBiquadratic(**PAIR)
        wrong = exact.EvenPair.on(
            1.0001 * pair.pair.middle, pair.pair.half, _ratio_of(pair), 1.0, np.inf, PAIR["period"]
        )
        assert abs(wrong.ratio[0]) > 1e-6 * abs(wrong.ratio[1])

    def test_the_exact_pair_is_the_solver_s_periodic_solution(self):
        pair = exact.PeriodicBiquadratic(**PAIR)
        theirs = contact.solve(_scene(contact.Periodic()), tol=1e-11)
        np.testing.assert_allclose(theirs.zones, pair.zones, rtol=0, atol=1e-10 * C)
        assert theirs.max_pressure == pytest.approx(pair.max_pressure, rel=1e-10)

    def test_in_a_long_period_the_exact_pair_is_the_isolated_pair(self):
        far = {**PAIR, "period": 4000 * C, "mean_pressure": 0.00109 * 2.4 / 4000}
        pair = exact.PeriodicBiquadratic(**far)
        alone = exact.IsolatedBiquadratic(1.0, 2 * C, 1.0, pair.load)
        np.testing.assert_allclose(pair.zones, alone.zones, rtol=1e-6)

    def test_36_with_the_full_artanh_is_the_solver_s_localization_of_the_same_strip(self):
        wide = {
            **PAIR,
            "period": 6 * C,
            "mean_pressure": 0.00109 / 2.5,
        }  # the widest gap lies between the pairs
        for closure in CLOSURES:
            ours = paper.LocalizedPair(**wide, closure=closure)
            theirs = contact.solve(_scene(contact.Localized(closure), wide), tol=1e-10)
            np.testing.assert_allclose(theirs.zones, ours.zones, rtol=0, atol=1e-8 * C)
        near = contact.solve(_scene(contact.Localized(paper.SELF_CONSISTENT)), tol=1e-10)
        np.testing.assert_allclose(
            near.zones, paper.LocalizedPair(**PAIR, centre="valley").zones, rtol=0, atol=1e-8 * C
        )

    @closures
    def test_36_solves_the_equation_of_35_by_quadrature(self, closure):
        pair = paper.LocalizedPair(**PAIR, closure=closure)
        n = 400
        phi = (np.arange(n) + 0.5) * np.pi / n
        (a, b), total = pair.ends, 0.0
        x = 0.5 * (a + b) + 0.5 * (b - a) * np.cos(np.arange(40, n, 80) * np.pi / n)
        for lo, hi in pair.zones:
            xi = 0.5 * (lo + hi) + 0.5 * (hi - lo) * np.cos(phi)
            weight = pair.pressure(xi) * 0.5 * (hi - lo) * np.sin(phi) * np.pi / n
            total = total + np.sum(weight / (x[:, None] - xi), axis=1) / np.pi
        slope = paper_forms.contact_slope(pair, x)
        np.testing.assert_allclose(total, 0.5 * slope, atol=1e-6 * 0.5 * np.max(np.abs(slope)))

    def test_the_cubic_is_the_same_pair_with_the_cubic_for_the_artanh(self):
        cubic = paper.CubicPair(**PAIR)

        def ratio(y, middle, half):
            return cubic.alpha * y - cubic.beta

        made = exact.pair.pair_at_load(ratio, cubic.load, 1.0, np.inf)
        np.testing.assert_allclose(made.ends, cubic.ends, rtol=1e-12)
        x = np.linspace(*cubic.ends, 17)
        np.testing.assert_allclose(
            made.pressure(x), cubic.pressure(x), atol=1e-12 * cubic.max_pressure
        )
        assert made.max_pressure == pytest.approx(cubic.max_pressure, rel=1e-12)
        far = {**PAIR, "period": 1e5 * C, "mean_pressure": 0.00109 * 2.4e-5}
        alone = exact.IsolatedBiquadratic(1.0, 2 * C, 1.0, paper.CubicPair(**far).load)
        np.testing.assert_allclose(paper.CubicPair(**far).zones, alone.zones, rtol=1e-9)

    def test_the_relation_of_the_ends_is_beta_over_alpha_and_not_two_c_squared(self):
        cubic, printed = paper.CubicPair(**PAIR), paper.PrintedCubicPair(**PAIR)
        a, b = cubic.ends
        assert 0.5 * (a * a + b * b) == pytest.approx(cubic.beta / cubic.alpha, rel=1e-14)
        # The pressure is bounded at the ends if int h' dxi/sqrt(Z) = 0. With the printed ends this
        # integral is not zero.
        for pair, vanishes in ((cubic, True), (printed, False)):
            a, b = pair.ends
            y = 0.5 * (a * a + b * b) + 0.5 * (b * b - a * a) * np.cos(
                (np.arange(32) + 0.5) * np.pi / 32
            )
            mean = np.mean(cubic.alpha * y - cubic.beta) / cubic.beta
            assert (abs(mean) < 1e-13) == vanishes
            assert vanishes or mean == pytest.approx(0.0597, abs=1e-4)

    def test_figure_13_has_the_ratios_that_the_errata_state(self):
        ratio = {
            name: 0.5 * np.sum(np.square(made(**PAIR).zones[1])) / C**2
            for name, made in (
                ("exact", exact.PeriodicBiquadratic),
                ("cubic", paper.CubicPair),
                ("printed", paper.PrintedCubicPair),
                ("artanh", paper.LocalizedPair),
            )
        }
        assert ratio["exact"] == pytest.approx(0.914, abs=5e-4)
        assert ratio["cubic"] == pytest.approx(0.944, abs=5e-4)
        assert ratio["artanh"] == pytest.approx(0.9328, abs=5e-5)
        assert ratio["printed"] == pytest.approx(1.0, rel=1e-15)

    def test_36_as_printed_leaves_out_the_other_zone(self):
        right, printed = paper.LocalizedPair(**PAIR), paper_forms.PrintedArtanhPair(**PAIR)
        x = np.linspace(*right.ends, 401)
        difference = np.abs(printed.pressure(x) - right.pressure(x))
        assert np.max(difference) / right.max_pressure == pytest.approx(0.00476, abs=2e-5)

        def literal(at):
            a, b = right.ends

            # In Gauss-Chebyshev quadrature, x is halfway between two nodes (in the angle). There
            # the rule holds for principal values.
            n = 2000
            m, w = 0.5 * (a + b), 0.5 * (b - a)
            xi = m + w * np.cos((np.arange(n) + 0.5) * np.pi / n)
            at = m + w * np.cos(np.round(np.arccos((at - m) / w) * n / np.pi) * np.pi / n)
            smooth = paper_forms.contact_slope(right, xi) / np.sqrt((b + xi) * (xi + a))
            root = np.sqrt((b * b - at * at) * (at * at - a * a))
            return at, root / (2 * np.pi) * np.sum(smooth / (xi - at)) * np.pi / n

        for start in (0.82 * C, 0.95 * C, 1.05 * C):
            at, value = literal(start)
            assert printed.pressure(at) == pytest.approx(value, rel=1e-10)

    def test_past_the_merge_the_pair_is_out_of_range(self):
        for made in (exact.PeriodicBiquadratic, paper.LocalizedPair, paper.CubicPair):
            with pytest.raises(contact.OutOfRange, match="merged"):
                solution = made(**{**PAIR, "mean_pressure": 0.008})
                _ = solution.zones

    def test_first_order_is_defined_about_the_pair_only(self):
        with pytest.raises(contact.SceneError, match="centre"):
            paper.LocalizedPair(**PAIR, closure=paper.FIRST_ORDER, centre="valley")


def _ratio_of(pair):
    def ratio(y, middle, half):
        x = pair.period / np.pi * np.arctan(np.sqrt(y))
        return pair.slope(x) / np.sqrt(y)

    return ratio


def _scene(model, shape=PAIR):
    profile = contact.Biquadratic(shape["radius"], shape["spacing"], shape["period"])
    return contact.Scene(profile, 1.0, model, mean_pressure=shape["mean_pressure"])


class TestResults:
    """The results section, statement by statement; see docs/paper."""

    @pytest.mark.parametrize(
        ("family", "error", "peak"),
        [("wave", -0.00964, -0.01187), ("wedge", -0.00905, None), ("parabola", -0.01565, -0.0202)],
    )
    def test_up_to_seven_tenths_of_the_period_the_load_is_within_two_percent(
        self, family, error, peak
    ):
        at = example(family, 0.35)
        assert at.load_error == pytest.approx(error, abs=5e-5)
        assert at.isolated_load_error == pytest.approx(-0.23, abs=0.005)
        for fraction in np.linspace(0.02, 0.69, 30):
            assert abs(example(family, fraction / 2).load_error) < 0.015
        if peak is not None:
            assert at.peak_error == pytest.approx(peak, abs=5e-5)

    @families
    def test_up_to_seven_tenths_of_the_period_the_pressure_is_close_also_near_an_infinite_peak(
        self, family
    ):
        t = np.linspace(0.001, 1.0, 400)
        for share, most in ((0.2, 0.012), (0.35, 0.021)):
            ours = example(family, share)
            peak = ours.exact.max_pressure
            scale = peak if np.isfinite(peak) else ours.exact.load / (2 * ours.half_width)
            assert np.max(np.abs(ours.pressure_at(t) - ours.exact.pressure_at(t))) < most * scale

    @families
    def test_beyond_seven_tenths_of_the_period_the_width_is_overestimated_more_and_more(
        self, family
    ):
        made, shape, _, _ = FAMILIES[family]
        off = [self._width_error(family, fraction) for fraction in (0.7, 0.72, 0.74)]
        assert 0.005 < off[0] < off[1] < off[2]

    @pytest.mark.parametrize("family", ["wedge", "parabola"])
    def test_the_self_consistent_closure_underestimates_the_width_instead(self, family):
        assert all(
            self._width_error(family, f, paper.SELF_CONSISTENT) < -0.01 for f in (0.5, 0.7, 0.9)
        )

    @pytest.mark.parametrize("fraction", [0.75, 0.8, 0.9])
    def test_the_parabola_overestimates_the_width_less_than_the_wedge_but_the_load_more(
        self, fraction
    ):
        assert self._width_error("parabola", fraction) < self._width_error("wedge", fraction)
        assert (
            example("parabola", fraction / 2).load_error
            < example("wedge", fraction / 2).load_error
            < 0
        )

    def test_the_wave_cannot_carry_loads_that_the_exact_wave_carries_at_eight_tenths(self):
        with pytest.raises(contact.OutOfRange):
            self._width_error("wave", 0.8)

    def test_hertz_is_within_three_percent_below_an_eighth_of_the_period_in_load_and_in_width(self):
        def errors(share):
            ours = example("parabola", share)
            hertz = exact.HertzLine.from_load(ours.exact.load, radius=2e-3, E_star=E_STAR)
            return ours.isolated_load_error, hertz.half_width / ours.half_width - 1

        load, width = errors(0.125)
        assert load == pytest.approx(-0.0261, abs=5e-5)
        assert width == pytest.approx(0.0133, abs=5e-5)
        for share in np.linspace(0.01, 0.124, 12):
            load, width = errors(share)
            assert -0.0261 < load < 0 < width < 0.0133
        assert errors(0.14)[0] < -0.03

    @families
    def test_at_a_given_load_neighbours_raise_the_peak_and_narrow_the_zone(self, family):
        made, shape, _, row = FAMILIES[family]
        alone = ALONE[family]
        given = shape | ({"wavelength": L} if family == "wave" else {})
        for share in (0.1, 0.25):
            load = example(family, share).exact.load
            one = alone.from_load(load, E_star=E_STAR, **given)
            assert one.half_width > share * L
            if family != "wedge":
                assert one.max_pressure < example(family, share).exact.max_pressure

    def test_almost_full_contact_can_be_taken_for_a_crack_at_these_widths(self):
        off = [self._crack_error(f) for f in (0.7, 0.8, 0.9)]
        assert off == pytest.approx([-0.0201, -0.00354, -0.000207], rel=0.01)
        # The crack has (pi b/L)^2 in place of sin^2(pi b/L), with the half width b of the gap. So
        # its error falls as b^4.
        rate = np.polyfit(
            np.log([0.1, 0.05, 0.025]),
            np.log([-self._crack_error(1 - b) for b in (0.1, 0.05, 0.025)]),
            1,
        )[0]
        assert rate == pytest.approx(4.0, abs=0.05)

    def test_figure_13_the_exact_pair_has_the_wider_zone_and_the_lower_peak_against_the_paper(self):
        """According to the paper, dense arrangement raises the peak and narrows the zone.

        The printed relation (38) does so, too. In the exact solution the peak falls and the zone
        widens.
        """
        true, printed, alone = (
            exact.PeriodicBiquadratic(**PAIR),
            paper.PrintedCubicPair(**PAIR),
            paper.CubicPair(**PAIR).isolated,
        )
        assert printed.max_pressure / alone.max_pressure - 1 == pytest.approx(0.0052, abs=2e-4)
        assert np.diff(printed.zones[1])[0] / alone.zone_widths[0] - 1 == pytest.approx(
            -0.0055, abs=2e-4
        )
        assert true.max_pressure / alone.max_pressure - 1 == pytest.approx(-0.0107, abs=2e-4)
        assert true.zone_widths[0] / alone.zone_widths[0] - 1 == pytest.approx(0.0170, abs=2e-4)
        for period in (3 * C, 4 * C, 6 * C, 10 * C):
            row = exact.PeriodicBiquadratic(**{**PAIR, "period": period})
            one = exact.IsolatedBiquadratic(1.0, 2 * C, 1.0, row.load)
            assert row.max_pressure < one.max_pressure and row.zone_widths[0] > one.zone_widths[0]

    def test_the_long_range_effect_is_below_the_short_range_one_in_peak_and_width_but_not_in_place(
        self,
    ):
        true = exact.PeriodicBiquadratic(**PAIR)
        pair = exact.IsolatedBiquadratic(1.0, 2 * C, 1.0, true.load)
        one = exact.HertzLine.from_load(0.5 * true.load, radius=1.0, E_star=1.0)
        long, short = (
            abs(p / q - 1)
            for p, q in (
                (true.max_pressure, pair.max_pressure),
                (pair.max_pressure, one.max_pressure),
            )
        )
        assert long < short
        assert true.zone_widths[0] - pair.zone_widths[0] < pair.zone_widths[0] - 2 * one.half_width
        middle, of_pair = np.mean(true.zones[1]) / C, np.mean(pair.zones[1]) / C
        assert of_pair - 1 == pytest.approx(-0.0174, abs=1e-4)
        assert middle - of_pair == pytest.approx(-0.0453, abs=1e-4)

    def test_the_adjacent_sides_of_a_pair_differ(self):
        pair = exact.IsolatedBiquadratic(
            1.0, 2 * C, 1.0, 0.5 * exact.IsolatedBiquadratic(1.0, 2 * C, 1.0, 1.0).merging_load
        )
        t = np.linspace(0.05, 0.95, 19)
        assert np.all(pair.pressure_at(t, 1) > 1.01 * pair.pressure_at(-t, 1))

    def test_the_long_range_effect_grows_up_to_the_merge(self):
        top = exact.IsolatedBiquadratic(1.0, 2 * C, 1.0, 1.0).merging_load / (6 * C)
        shifts = []
        for share in (0.1, 0.3, 0.5, 0.7, 0.9):
            row = exact.PeriodicBiquadratic(
                **{**PAIR, "period": 6 * C, "mean_pressure": share * top}
            )
            shifts.append(
                exact.IsolatedBiquadratic(1.0, 2 * C, 1.0, row.load).inner_end - row.inner_end
            )
        assert np.all(np.diff(shifts) > 0)

    @staticmethod
    def _width_error(family, fraction, closure=paper.FIRST_ORDER):
        load = example(family, fraction / 2).exact.load
        ours = exact.localized_at_load(
            ALONE[family], load, L, closure, E_star=E_STAR, **FAMILIES[family][1]
        )
        return ours.half_width / (0.5 * fraction * L) - 1

    @staticmethod
    def _crack_error(fraction):
        crack = paper_forms.AlmostFullWave(1e-6, L, E_STAR, 0.5 * fraction * L)
        return (
            crack.mean_pressure
            / exact.Westergaard(1e-6, L, E_STAR, 0.5 * fraction * L).mean_pressure
            - 1
        )


class TestNeighbours:
    @pytest.mark.parametrize("fraction", [0.5, 0.8, 0.9])
    def test_the_load_error_of_the_wave_falls_with_the_third_power_of_the_strip_and_its_predicted_factor(
        self, fraction
    ):
        true = exact.Westergaard(1e-6, L, E_STAR, 0.5 * fraction * L)
        m = np.array([1, 2, 4, 8, 16])
        error = np.array([self._load(fraction, k) / true.load - 1 for k in m])
        rate = np.polyfit(np.log(2 * m + 1), np.log(error), 1)[0]
        assert -3.1 < rate < -2.9
        # The factor (16/pi^2)(1/12 - mu/(P L^2)) ln(1/cos(pi a/L)) is derived in
        # docs/paper/neighbours.md; mu is the second moment of the pressure.
        phi, _, half, weight = reference.zone_rule(true, 0, 400)
        mu = np.sum(weight * (half * np.cos(phi)) ** 2) / (np.sum(weight) * L * L)
        factor = 16 / np.pi**2 * (1 / 12 - mu) * -np.log(np.cos(0.5 * np.pi * fraction))
        assert error[-1] * 33**3 == pytest.approx(factor, rel=2e-3)

    def test_one_neighbour_is_within_six_tenths_of_a_percent_at_nine_tenths_contact(self):
        true = exact.Westergaard(1e-6, L, E_STAR, 0.45 * L)
        assert 0.005 < self._load(0.9, 1) / true.load - 1 < 0.006

    @staticmethod
    def _load(fraction, m):
        model = contact.Localized(paper.SELF_CONSISTENT, int(m))
        return contact.solve(
            contact.Scene(FAMILIES["wave"][2], E_STAR, model, half_width=0.5 * fraction * L),
            tol=1e-12,
        ).load
