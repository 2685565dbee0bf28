"""Bodies that turn: a given tilt, or an unknown tilt under a given moment, against closed forms
and designed contacts.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

import contact
import sie
from contact import path
from contact.model.profiles.tilted import Tilted
from contact.reference import exact
from contact.search.grid.scaling import scaled_scene
from contact.search.grid.tilt import hull_edge
from contact.search.grid.tilt_rate import AtTilt, balanced
from tests.contact.judge import relative, solve, true_error
from tests.contact.strategies import designed_contacts
from tests.tiers import diagonal, quick

E, DATUM = 2.0, 7.0
ISOLATED = contact.Isolated(datum=DATUM)
# Scaled positions in a zone. They leave out the ends, where the pressure may be infinite.
WITHIN = np.linspace(-0.99, 0.99, 40)


def parabola(half_width=0.1, tilt=0.3):
    return contact.Parabola(1.0), exact.TiltedParabola(1.0, E, half_width, tilt, DATUM), WITHIN


def wedge(tilt=0.04):
    answer = exact.TiltedWedge(0.1, E, 0.3, tilt, DATUM)
    tip = -answer.middle / answer.half_width
    return contact.Wedge(0.1), answer, WITHIN[np.abs(WITHIN - tip) > 0.1]


def punch(e=0.3):
    return contact.Flat(2.0), exact.TiltedPunch(1.0, E, 0.3, 0.3 * e, DATUM), WITHIN


BODIES = {
    "parabola": parabola(),
    "parabola far off": parabola(1e-3, -4.0),
    "wedge": wedge(),
    "wedge on its flank": wedge(-0.095),
    "punch": punch(),
    "punch lifted": punch(-0.7),
    "punch on its corner": punch(0.98),
}
CONTROLS = [("load", "moment"), ("load", "tilt"), ("approach", "tilt"), ("approach", "moment")]


def given_by(answer, *names):
    return {name: getattr(answer, name) for name in names}


class TestClosedForms:
    @pytest.mark.parametrize(("body", "names"), diagonal(BODIES, CONTROLS), ids=str)
    def test_pressure_zone_and_numbers_are_those_of_the_closed_form(self, body, names):
        profile, answer, t = BODIES[body]
        solution = solve(profile, ISOLATED, E, tol=1e-8, **given_by(answer, *names))
        assert true_error(solution, answer, t) <= solution.error <= 1e-8
        for name in ("load", "moment", "tilt", "approach"):
            assert relative(getattr(solution, name), getattr(answer, name)) < 1e-8, name
        assert solution.certificate.holds
        assert (
            solution.certificate.moment_balance is None
            or solution.certificate.moment_balance < 1e-14
        )

    @pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
    def test_a_tolerance_of_1e_10_is_met(self, body):
        profile, answer, t = body
        solution = solve(profile, ISOLATED, E, tol=1e-10, **given_by(answer, "load", "moment"))
        assert true_error(solution, answer, t) <= solution.error <= 1e-10

    @pytest.mark.parametrize(
        "body", [parabola(), wedge(), punch(0.6)], ids=["parabola", "wedge", "punch"]
    )
    def test_gap_and_displacement_are_those_of_the_turned_body(self, body):
        profile, answer, _ = body
        solution = solve(profile, ISOLATED, E, tol=1e-12, **given_by(answer, "load", "moment"))
        (a, b), w = answer.zones[0], answer.half_width
        x = np.array([a - 0.5 * w, a - 0.01 * w, b + 0.01 * w, b + 0.5 * w])
        x = x[np.isfinite(answer.height(x))]
        gap, approach = answer.gap(x), answer.approach
        assert solution.gap(x) == pytest.approx(gap, rel=1e-8)
        # The displacement u of the half-plane's surface is approach + tilt x - f + gap.
        moved = approach + answer.tilt * x - answer.height(x) + gap
        assert solution.displacement(x) == pytest.approx(moved, abs=1e-11)
        inside = a + (b - a) * np.array([0.2, 0.9])
        assert solution.displacement(inside) == pytest.approx(
            approach + answer.tilt * inside - answer.height(inside), abs=1e-12
        )

    def test_an_answer_off_by_a_millionth_is_told_from_the_right_one(self):
        profile, answer, t = parabola()
        solution = solve(profile, ISOLATED, E, load=answer.load, moment=answer.moment * (1 + 1e-6))
        assert true_error(solution, answer, t) > 1e-7

    @given(st.floats(-0.999, 0.999), st.floats(-3, 3), st.sampled_from(["tilt", "moment"]))
    def test_a_punch_of_any_centre_of_load(self, e, decade, name):
        answer = exact.TiltedPunch(1.0, E, 10.0**decade, 10.0**decade * e)
        solution = solve(
            contact.Flat(2.0), contact.Isolated(), E, tol=1e-7, **given_by(answer, "load", name)
        )
        assert true_error(solution, answer, WITHIN) <= solution.error <= 1e-7

    @given(st.floats(-0.98, 0.98), st.floats(-6, 3), st.sampled_from(["tilt", "moment"]))
    def test_a_wedge_of_any_tilt_below_its_slope(self, share, decade, name):
        answer = exact.TiltedWedge(0.1, E, 10.0**decade, 0.1 * share)
        t = WITHIN[np.abs(WITHIN + answer.middle / answer.half_width) > 0.1]
        solution = solve(
            contact.Wedge(0.1), contact.Isolated(), E, tol=1e-8, **given_by(answer, "load", name)
        )
        assert true_error(solution, answer, t) <= solution.error <= 1e-8


class TestOnTheFlank:
    """Wedges turned nearly to their slope. On one side the zone ends just beyond the tip. On the
    other side the turned wedge rises slowly.
    """

    @pytest.mark.parametrize("share", quick([0.99, -0.999, 0.9999], [-0.999]))
    @pytest.mark.parametrize("names", CONTROLS, ids=" and ".join)
    def test_a_tolerance_of_1e_10_is_met_for_tilts_within_1e_4_of_the_slope(self, share, names):
        answer = exact.TiltedWedge(0.1, E, 0.3, 0.1 * share, DATUM)
        t = WITHIN[np.abs(WITHIN + answer.middle / answer.half_width) > 0.1]
        solution = solve(contact.Wedge(0.1), ISOLATED, E, tol=1e-10, **given_by(answer, *names))
        assert true_error(solution, answer, t) <= solution.error <= 1e-10
        # The short side of the zone may be 1e-9 of the zone's width. Its error is small relative
        # to the short side itself.
        short = np.argmin(np.abs(answer.zones[0]))
        assert relative(solution.zones[0, short], answer.zones[0, short]) < 1e-9

    @pytest.mark.parametrize("start", [0.0, 1e-9, 1e-4, 1e-2])
    def test_newton_finds_the_end_beyond_a_tip_from_either_side_of_it(self, start):
        answer = exact.TiltedWedge(0.1, E, 0.3, 0.09999)
        frame = scaled_scene(
            contact.Scene(
                contact.Wedge(0.1), E, contact.Isolated(), load=answer.load, tilt=answer.tilt
            ),
            False,
        )
        units, right = frame.problem.units, answer.zones[0, 1]
        for left in (-start * right, start * right):
            table = units.scaled(np.array([[left, right]]))
            found = sie.find_ends(frame.problem.equation(frame.control), sie.Zones.of(table), 1e-10)
            assert found.converged and len(found.trace) < 12
            assert relative(units.x(found.density.zones.table), answer.zones) < 1e-6


class TestNoHold:
    """Bodies whose turned profile falls without bound on one side are refused before the search."""

    @pytest.mark.parametrize("tilt", [0.1, -0.1, 0.1 * (1 + 1e-12), 3.0])
    @pytest.mark.parametrize("name", ["load", "approach"])
    def test_a_wedge_turned_to_its_slope_or_beyond(self, tilt, name):
        side = "right" if tilt > 0 else "left"
        with pytest.raises(
            contact.OutOfRange,
            match=f"turned by {tilt:.6g}, .* on the {side}.* rises on both sides",
        ):
            solve(contact.Wedge(0.1), ISOLATED, E, tilt=tilt, **{name: 0.01})

    @pytest.mark.parametrize(
        "coefficients",
        [[0, 0, 0, 1.0], [0, 0, -1.0], [0, 1.0], [0, 0, 1, 0.1], [0, 0, 1, 0, -0.01]],
    )
    @pytest.mark.parametrize("turning", [{}, {"tilt": 0.1}, {"moment": 0.001}], ids=str)
    @pytest.mark.parametrize("name", ["load", "approach"])
    def test_a_polynomial_that_falls_on_one_side(self, coefficients, turning, name):
        with pytest.raises(
            contact.OutOfRange, match="falls without bound|does not rise on both sides"
        ):
            solve(contact.Polynomial(coefficients), ISOLATED, E, **{name: 0.01}, **turning)

    def test_a_moment_whose_tilt_is_within_round_off_of_the_slope(self):
        with pytest.raises(contact.OutOfRange, match="no tilt was found"):
            solve(contact.Wedge(0.1), contact.Isolated(), 1e9, load=0.01, moment=1e3)

    def test_one_period_of_such_a_polynomial_has_borders_and_is_solved(self):
        cell = contact.Polynomial([0, -0.025, 1, 0.1], period=1.0)
        assert contact.solve(
            contact.Scene(cell, 1.0, contact.Isolated(), load=1e-3)
        ).certificate.holds


class TestStiffness:
    @pytest.mark.parametrize("fixed", ["tilt", "moment"])
    @pytest.mark.parametrize(
        "body",
        [parabola(), wedge(), punch(0.3), punch(0.7)],
        ids=["parabola", "wedge", "punch", "lifted"],
    )
    def test_it_is_the_slope_of_the_load_over_the_approach_at_the_tilt_or_the_moment_that_is_given(
        self, body, fixed
    ):
        profile, answer, _ = body
        h = 1e-4 * answer.load
        low, middle, high = (
            solve(profile, ISOLATED, E, tol=1e-12, load=answer.load + d, **given_by(answer, fixed))
            for d in (-h, 0.0, h)
        )
        assert relative(2 * h / (high.approach - low.approach), middle.stiffness) < 1e-6

    @pytest.mark.parametrize("name", ["tilt", "moment"])
    @pytest.mark.parametrize(
        "body", [wedge(), punch(0.3), punch(0.7)], ids=["wedge", "punch", "lifted"]
    )
    def test_rotational_stiffness_is_that_of_the_closed_form(self, body, name):
        profile, answer, _ = body
        solution = solve(profile, contact.Isolated(), E, **given_by(answer, "load", name))
        assert relative(solution.rotational_stiffness, answer.rotational_stiffness) < 1e-9

    def test_an_upright_body_has_a_rotational_stiffness(self):
        solution = solve(contact.Parabola(3.0), contact.Isolated(), E, load=0.01)
        assert relative(solution.rotational_stiffness, 3.0 * 0.01) < 1e-10

    def test_a_body_that_may_turn_is_less_stiff(self):
        profile, answer, _ = wedge()
        held, free = (
            solve(profile, ISOLATED, E, load=answer.load, **given_by(answer, n)).stiffness
            for n in ("tilt", "moment")
        )
        assert 0 < free < held


def moment_of(problem):
    """Returns int p x dx of a designed contact, by the problem's own quadrature rule."""
    product = problem._product
    scale = 0.5 * problem.E_star * problem._scale
    nodes = [(left, *product.nodes(2 * k), k) for k, (left, _) in enumerate(problem.zones)]
    return sum(
        float(np.sum(w * (left + dl) * scale * product.magnitude(2 * k, dl, dr)))
        for left, dl, dr, w, k in nodes
    )


class TestDesignedContacts:
    """A designed profile has known zones. If it is turned first, the moment of its known pressure
    must turn it back.
    """

    @pytest.mark.slow
    @settings(max_examples=20)
    @given(designed_contacts(max_zones=6, periodic=False, nearest=0.1), st.floats(-3, 3))
    def test_the_moment_restores_the_tilt_and_the_designed_zones(self, problem, turn):
        tilt = turn * problem.load / (problem.E_star * np.ptp(problem.zones))
        scene = contact.Scene(
            Tilted(problem.profile, -tilt),
            problem.E_star,
            contact.Isolated(),
            load=problem.load,
            moment=moment_of(problem),
        )
        try:
            solution = contact.solve(scene)
        except contact.NotConverged as failure:
            # A zone that carries less than 1e-5 of the load is not known to the tolerance 1e-8.
            solution = failure.best
            assert np.min(problem.zone_loads) < 1e-5 * problem.load
        assert len(solution.zones) == len(problem.zones)
        assert true_error(solution, problem) <= solution.error
        assert abs(solution.tilt - tilt) < 1e-7 * max(
            abs(tilt), problem.load / (problem.E_star * np.ptp(problem.zones))
        )

    @settings(max_examples=10)
    @given(designed_contacts(max_zones=4, periodic=False, nearest=0.1), st.floats(-3, 3))
    def test_at_the_given_tilt_the_pressure_has_the_known_moment(self, problem, turn):
        tilt = turn * problem.load / (problem.E_star * np.ptp(problem.zones))
        scene = contact.Scene(
            Tilted(problem.profile, -tilt),
            problem.E_star,
            contact.Isolated(),
            load=problem.load,
            tilt=tilt,
        )
        solution = contact.solve(scene, tol=1e-6)
        reach = np.max(np.abs(problem.zones))
        assert abs(solution.moment - moment_of(problem)) < 1e-6 * problem.load * reach


class TestPlaces:
    """Profiles that are known only on an interval, and profiles whose lowest points lie far
    apart.
    """

    # The two minima lie 3.9 apart. Each zone is narrower than a thousandth of this distance.
    WELLS = contact.Polynomial([0.0, -1.71574031, 0.29032326, 1.51225252, 0.3203691])

    def test_zones_at_minima_far_apart_obey_the_lever_rule(self):
        load = 2.6e-5
        solution = solve(
            self.WELLS, contact.Isolated(), 1.0, tol=1e-8, load=load, moment=0.058 * load
        )
        left, right = solution.zones.mean(axis=1)
        # The lever rule gives the zone loads if each acts at the middle of its zone. The zones
        # are so narrow that this holds.
        assert solution.zone_loads[1] / load == pytest.approx(
            (0.058 - left) / (right - left), abs=1e-5
        )
        assert len(solution.zones) == 2 and right - left > 1000 * solution.zone_widths.max()

    def test_a_zone_far_outside_the_first_window_is_found_through_the_certificate(self):
        load = 2.6e-5
        tilt = solve(
            self.WELLS, contact.Isolated(), 1.0, tol=1e-8, load=load, moment=0.058 * load
        ).tilt
        turned = contact.Polynomial(
            np.asarray(self.WELLS.coefficients) - [0.0, tilt, 0.0, 0.0, 0.0]
        )
        for scene in (
            contact.Scene(self.WELLS, 1.0, contact.Isolated(), load=load, tilt=tilt),
            contact.Scene(turned, 1.0, contact.Isolated(), load=load),
        ):
            assert len(contact.solve(scene, tol=1e-7).zones) == 2

    def test_one_period_in_isolated_contact_turns(self):
        wave = contact.Sinusoid(1e-3, 1.0)
        turned = solve(wave, contact.Isolated(), 1.0, load=1e-4, moment=1e-5)
        again = solve(wave, contact.Isolated(), 1.0, load=1e-4, tilt=turned.tilt)
        assert again.zones == pytest.approx(turned.zones, abs=1e-9)
        assert 0.1 - turned.zone_widths[0] < turned.zones.mean() < 0.1 + turned.zone_widths[0]
        by_pressure = solve(wave, contact.Isolated(), 1.0, mean_pressure=1e-4, moment=1e-5)
        assert by_pressure.tilt == pytest.approx(turned.tilt, rel=1e-9)

    def test_a_trace_turns_only_if_its_contact_stays_within_the_measured_length(self):
        x = np.linspace(-1, 1, 201)
        trace = contact.Sampled(x, -0.1 * x**2 + 1e-4 * np.cos(40 * x))
        solution = solve(trace, contact.Isolated(), 1.0, tol=1e-8, load=1e-2, moment=2e-3)
        assert solution.moment == pytest.approx(2e-3, rel=1e-12)
        again = solve(trace, contact.Isolated(), 1.0, tol=1e-8, load=1e-2, tilt=solution.tilt)
        assert again.zones == pytest.approx(solution.zones, abs=1e-7)
        with pytest.raises(contact.OutOfRange, match="border"):
            solve(trace, contact.Isolated(), 1.0, tol=1e-8, load=1e-2, moment=9.5e-3)

    def test_the_rigid_body_s_tilt_is_an_edge_of_the_convex_hull(self):
        x = np.linspace(-2, 2, 4001)
        f = (x**2 - 1) ** 2 + 0.1 * x
        i, j = hull_edge(x, f, 0.2)
        assert (x[i], x[j]) == pytest.approx((-1, 1), abs=2e-3)
        assert (f[j] - f[i]) / (x[j] - x[i]) == pytest.approx(0.1, abs=1e-5)
        k, m = hull_edge(x, f, 1.5)
        assert m == k + 1 and x[k] <= 1.5 <= x[m]


class TestFindingTheTilt:
    """`balanced` finds the root of a function that grows with the tilt and may be out of range at
    some tilts.
    """

    @staticmethod
    def centre_of(function, slope, limit=np.inf, calls=None):
        def lean(tilt):
            if abs(tilt) > limit:
                raise contact.OutOfRange("runs off")
            if calls is not None:
                calls.append(tilt)
            return AtTilt(tilt, function(tilt), slope(tilt), 1e-9, None)

        return lean

    def test_tilts_out_of_range_bracket_the_root(self):
        calls = []
        lean = self.centre_of(np.tan, lambda t: 1 / np.cos(t) ** 2, limit=np.pi / 2, calls=calls)
        assert balanced(lean, 1e3, (0.0,), 60).centre == pytest.approx(1e3, abs=1e-8)
        assert len(calls) < 40

    def test_the_root_is_found_for_a_saturating_function_and_for_wrong_slopes(self):
        lean = self.centre_of(lambda t: t / (1 + abs(t)), lambda t: 1 / (1 + abs(t)) ** 2)
        assert balanced(lean, 0.99, (0.0,), 60).tilt == pytest.approx(99, rel=1e-4)
        lean = self.centre_of(np.tanh, lambda t: 10.0)
        assert balanced(lean, 0.5, (0.0, 5.0), 60).centre == pytest.approx(0.5, abs=1e-8)

    def test_at_a_jump_the_nearer_side_is_returned_and_guesses_out_of_range_are_refused(self):
        lean = self.centre_of(lambda t: -1.0 if t < 0.3 else 2.0, lambda t: 1.0)
        assert balanced(lean, 0.0, (0.0,), 200).centre == -1.0
        with pytest.raises(contact.OutOfRange, match="runs off"):
            balanced(self.centre_of(np.tan, np.cos, limit=0.1), 0.0, (1.0, 2.0), 10)


class TestWhatNeedsNoTurning:
    def test_no_moment_turns_a_symmetric_body(self):
        upright = solve(contact.Parabola(1.0), contact.Isolated(), E, load=0.01)
        for given_ in ({"moment": 0.0}, {"tilt": 0.0}):
            solution = solve(contact.Parabola(1.0), contact.Isolated(), E, load=0.01, **given_)
            assert np.array_equal(solution.zones, upright.zones)
            assert (
                solution.tilt == 0.0
                and not solution.plan["tilt"].used
                and solution.plan["symmetry"].used
            )
        assert (
            solve(contact.Parabola(1.0), contact.Isolated(), E, half_width=0.1, moment=0.0).tilt
            == 0.0
        )

    def test_an_asymmetric_body_turns_under_no_moment(self):
        lopsided = contact.Polynomial([0.0, 0.0, 1.0, 0.3, 1.0])
        solution = solve(lopsided, contact.Isolated(), E, load=0.1, moment=0.0)
        assert abs(solution.moment) < 1e-15 and abs(solution.tilt) > 1e-3
        left = solve(lopsided, contact.Isolated(), E, load=0.1)
        assert abs(left.moment) > 1e-5 and left.tilt == 0.0

    def test_the_plan_says_what_the_tilt_is(self):
        plans = {
            name: contact.plan(
                contact.Scene(contact.Wedge(0.1), E, contact.Isolated(), load=1.0, **given_)
            )
            for name, given_ in {
                "none": {},
                "given": {"tilt": 0.01},
                "unknown": {"moment": 0.1},
            }.items()
        }
        for name, plan in plans.items():
            assert plan["tilt"].used == (name != "none") and name in plan["tilt"].reason
            assert plan["symmetry"].used == (name == "none")

    def test_periodic_contact_has_neither_tilt_nor_moment(self):
        solution = solve(contact.Sinusoid(1e-6, 1e-4), contact.Periodic(), 1e11, load=100.0)
        assert solution.tilt is solution.moment is solution.rotational_stiffness is None

    def test_newton_s_method_is_quadratic_also_with_an_unknown_tilt(self):
        profile, answer, _ = parabola()
        solution = solve(
            profile, contact.Isolated(), E, tol=1e-13, load=answer.load, moment=answer.moment
        )
        moves = np.array([step.move for step in solution.trace])
        fast = moves[(moves < 0.2) & (moves > 1e-14)]
        assert np.all(fast[1:] <= 10 * fast[:-1] ** 2 + 1e-14)


class TestPaths:
    """The profile has three tips, at x = 1, 2 and 3. At a constant moment M the centre of load,
    M/load, moves towards x = 0 as the load grows. So the body rocks over.
    """

    TIPS = contact.Polynomial(
        (Polynomial([0, 0, 2.5e-3, 0, -3.75e-3, 0, 1e-2 / 6])(Polynomial([-2, 1]))).coef
    )
    MOMENT = 2e-5

    def scene(self, **given_):
        return contact.Scene(self.TIPS, 1.0, contact.Isolated(), **given_)

    @pytest.mark.slow
    def test_one_tip_lifts_off_and_another_comes_down_as_the_load_grows(self):
        found = path(self.scene(load=1.0, moment=self.MOMENT), self.MOMENT / np.array([2.6, 1.4]))
        assert [event.kind for event in found.events] == ["death", "birth"]
        death, birth = found.events
        assert (death.position, birth.position) == pytest.approx((3.0, 1.0), abs=0.05)
        for event, count in ((death, (2, 1)), (birth, (1, 2))):
            for part, zones in zip((1 - 1e-3, 1 + 1e-3), count, strict=True):
                assert (
                    len(contact.solve(self.scene(load=event.load * part, moment=self.MOMENT)).zones)
                    == zones
                )
        back = path(self.scene(load=1.0, moment=self.MOMENT), self.MOMENT / np.array([1.4, 2.6]))
        assert [event.kind for event in back.events] == ["death", "birth"]
        assert [e.load for e in back.events] == pytest.approx(
            [e.load for e in found.events[::-1]], rel=1e-9
        )

    def test_at_a_given_tilt_zones_only_grow(self):
        found = path(self.scene(load=1.0, tilt=1e-4), [1e-5, 1e-3])
        assert found.solutions[0].tilt == found.solutions[1].tilt == 1e-4
        assert {event.kind for event in found.events} == {"birth"}
        low, high = found.solutions
        for a, b in low.zones:
            assert np.any((high.zones[:, 0] < a) & (b < high.zones[:, 1]))
