"""The contact of one strip as one of a period in the angle: its grids, its relief, its gaps, and the first-order closure by these."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import contact
import sie
from contact.formulation.strip_turn import StripTurn
from contact.search.grid.closure import ClosureGrid
from contact.search.grid.conjugate_gradient import Response
from contact.search.grid.scaling import scaled_scene
from contact.search.grid.strip import StripGrid
from contact.search.topology.by_pressure import ByPressure
from contact.search.ways import first_order_several
from contact.studies.trace_kinds import drawn

FIRST = contact.Localized("first-order")
ROUGH = contact.Fourier(1.0, [-0.01, 0.004, 0.002, -0.003], [0.003, -0.002, 0.004, 0.002])
TWO = contact.Fourier(1.0, [-0.004, -0.01], [0.003, 0.001])


def strip(profile, points=4096, centre=0.0):
    return StripTurn(scaled_scene(contact.Scene(profile, 1.0, FIRST, load=1.0), False).problem, centre, points)


def full_load(profile):
    return contact.solve(contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)).load


class TestGrids:
    @pytest.mark.parametrize("load", [1e-3, 1e-2, 3e-2])
    def test_grids_even_in_the_angle_and_in_x_tell_the_same_contact(self, load):
        of_x, of_angle = (StripGrid(Response(1.0, False), 1.0, 0.25, turns).contact(ROUGH.height, 0.1, load, 2048, 1e-6, None)
                          for turns in (False, True))
        assert of_x.zones.shape == of_angle.zones.shape and of_x.reaches == of_angle.reaches
        assert np.abs(of_x.zones - of_angle.zones).max() < 2 / 2048

    @pytest.mark.parametrize("turns", [False, True])
    def test_room_beside_a_border_falls_below_zero_as_the_strip_touches_it(self, turns):
        grid = StripGrid(Response(1.0, False), 1.0, 0.25, turns)
        found = [grid.contact(ROUGH.height, 0.1, load, 1024, 1e-6, None) for load in np.geomspace(1e-3, 0.2, 12)]
        for side in (0, 1):
            room = np.array([each.beside[side] for each in found])
            assert np.all((room < 0) == [each.reaches[side] for each in found]) and room[-1] < 0 < room[0]
            assert np.all(np.diff(room[room > 0]) < 0)

    @pytest.mark.parametrize("kind", ["plateaus", "ground"])
    def test_begun_from_one_beside_it_a_strip_is_the_same_and_found_sooner(self, kind):
        profile = drawn(np.random.default_rng(4), kind, 300)
        grid, load = StripGrid(Response(1.0, False), profile.period, profile.feature, True), 0.3 * full_load(profile)
        near = grid.contact(profile.height, 0.0, load, 8192, 1e-3, None)
        aside = 20 * near.cell
        moved, left, afresh = (grid.contact(profile.height, aside, load, 8192, 1e-3, start)
                               for start in (near, replace(near, middle=aside), None))
        assert abs(moved.width - afresh.width) < 1e-3 * afresh.width
        assert moved.state.iterations < 0.7 * left.state.iterations

    def test_a_flat_strip_is_pressed_as_by_a_punch(self):
        # p = P / (pi sqrt(h^2 - x^2)): even in the angle.
        found = StripGrid(Response(1.0, False), 2.0, 0.25, True).contact(np.zeros_like, 0.3, 5.0, 64, 1e-8, None)
        assert np.allclose(found.zones, [[-0.7, 1.3]]) and found.reaches == (True, True)
        assert np.allclose(found.state.pressure, 5.0 / np.pi)


class TestClosureOnGrids:
    @pytest.mark.parametrize(("seed", "kind", "part"), [(1, "rough", 0.97), (2, "honed", 0.9), (3, "texture", 1.2)])
    def test_nominal_pressures_that_fill_strip_and_profile_alone_are_told_at_once(self, seed, kind, part):
        profile = drawn(np.random.default_rng(seed), kind, 200)
        scaled = scaled_scene(contact.Scene(profile, 1.0, FIRST, load=part * full_load(profile)), False)
        grid = ClosureGrid(scaled, scaled.problem, scaled.control.load)
        low, high = grid.filled(0.1)
        assert high > 0.0
        for pressure, full in ((0.999 * high, False), (1.001 * high, True)):
            assert grid.alone(pressure, 0.1, grid.points, 1e-6, None).state.full is full
        for pressure, full in ((0.999 * low, True), (1.001 * low, False)) if low else ((0.5 * high, False),):
            assert grid.strip(pressure, 0.1, grid.points, 1e-6, None).state.full is full

    def test_beyond_full_contact_a_load_is_refused_after_few_grids(self, monkeypatch):
        profile = drawn(np.random.default_rng(0), "turned", 300, "uneven")
        grids = []
        contacts = StripGrid.contact
        monkeypatch.setattr(StripGrid, "contact", lambda self, *given: grids.append(given) or contacts(self, *given))
        with pytest.raises(contact.OutOfRange, match="reaches the border"):
            contact.solve(contact.Scene(profile, 1.0, FIRST, load=1.5 * full_load(profile)))
        assert 0 < len(grids) < 200


class TestRelief:
    def test_of_a_parabola_it_is_a_cosine_of_twice_the_angle(self):
        turn = strip(contact.Parabola(2.0, period=1.0))
        units, angle = turn.problem.units, np.linspace(-3, 9, 50)
        expected = (turn.half * units.length) ** 2 / (2 * 2.0) * np.cos(2 * angle) / units.height
        assert np.abs(turn.relief_at(angle) - expected).max() < 1e-9 * np.abs(expected).max()

    @pytest.mark.parametrize("centre", [0.0, 0.37])
    def test_by_that_of_the_whole_period_it_is_the_same(self, centre):
        # Of a wave the samples tell all of it; near the borders as well.
        turn = strip(ROUGH, 2**14, centre)
        angle = np.concatenate((np.linspace(0.1, 3.0, 40), [1e-5, 1e-3, np.pi - 1e-4, 4.0, -1.0]))
        assert np.abs(turn.exact_at(angle) - turn.relief_at(angle)).max() < 1e-9 * np.abs(turn.relief).max()

    def test_of_a_spline_samples_come_nearer_to_it_with_the_second_power_at_least(self):
        profile = drawn(np.random.default_rng(3), "rough", 100, "uneven")
        angle = np.linspace(0.05, 3.0, 300)
        exact = strip(profile).exact_at(angle)
        off = [np.abs(strip(profile, points).relief_at(angle) - exact).max() for points in (2**11, 2**13, 2**15)]
        assert off[1] < off[0] / 12 and off[2] < off[1] / 12

    def test_series_of_a_gap_over_many_knots_are_as_long_as_they_are_asked_to_be(self):
        # Before they tell the pieces between knots coefficients seem to have stopped falling.
        turn = strip(drawn(np.random.default_rng(0), "plateaus", 2000), centre=1.725073)
        gaps = sie.Zones.of([[-0.2717, 0.2717], [np.pi - 0.2717, np.pi + 0.2717]])
        assert sie.solve_zones(turn.equation(turn.exact_at, 0.0, 0.4), gaps, 1e-12).end_truncation.max() < 1e-8

    def test_how_it_follows_the_centre_is_its_derivative(self):
        angle, step = np.linspace(0.0, 3.0, 40), 1e-5
        rise = (strip(ROUGH, centre=0.2 + step).relief_at(angle) - strip(ROUGH, centre=0.2 - step).relief_at(angle)) / (2 * step)
        by_centre = strip(ROUGH, centre=0.2).by_centre_at(angle)
        assert np.abs(rise - by_centre).max() < 1e-6 * np.abs(by_centre).max()


class TestClosure:
    def test_zones_are_those_between_the_gaps_of_a_turn(self):
        turn, zones = strip(ROUGH, centre=0.2), np.array([[-0.25, -0.1], [0.0, 0.3], [0.31, 0.6]])
        assert np.allclose(turn.zones_of(turn.gaps_of(zones)), zones)
        touching = np.array([[-0.3, 0.0], [0.1, 0.4]])
        assert len(turn.gaps_of(touching)) == 3 and np.allclose(turn.zones_of(turn.gaps_of(touching)), touching)

    @pytest.mark.parametrize(
        "profile, part, tol", [pytest.param(TWO, 0.995, 1e-8, marks=pytest.mark.slow), (TWO, 0.99, 1e-8), (TWO, 0.99, 1e-10)]
    )
    def test_gaps_and_zones_lead_to_the_same_contact(self, monkeypatch, profile, part, tol):
        scene = contact.Scene(profile, 1.0, FIRST, load=part * full_load(profile))
        by_gaps = contact.solve(scene, tol)
        monkeypatch.setattr(StripTurn, "serves", lambda problem: False)
        by_zones = contact.solve(scene, tol)
        assert by_gaps.zones.shape == by_zones.zones.shape
        assert (np.abs(by_gaps.zones - by_zones.zones) / np.diff(by_zones.zones)).max() <= by_gaps.error + by_zones.error

    @pytest.mark.slow
    def test_the_stiffness_is_that_of_contacts_beside_it(self):
        load = 0.98 * full_load(TWO)
        at = [contact.solve(contact.Scene(TWO, 1.0, FIRST, load=load * (1 + off))) for off in (-1e-3, 0, 1e-3)]
        by_difference = (at[2].load - at[0].load) / (at[2].approach - at[0].approach)
        assert abs(at[1].stiffness / by_difference - 1) < 1e-4

    def test_of_a_rough_trace_the_strip_is_solved_by_its_zones_once(self, monkeypatch):
        profile = drawn(np.random.default_rng(6), "rough", 120, "uneven")
        scene, calls, moved = contact.Scene(profile, 1.0, FIRST, load=0.5 * full_load(profile)), [], ByPressure.moved

        def counted(form, control, zones, how):
            calls.append(form.problem.reference)
            return moved(form, control, zones, how)

        monkeypatch.setattr(ByPressure, "moved", counted)
        solution = contact.solve(scene)
        assert solution.certificate.holds and solution.error <= 1e-8 and solution.contact_fraction > 0.8
        assert len(calls) <= 4 and not any(calls)

    def test_a_strip_that_no_centre_balances_is_refused_by_grids_alone(self, monkeypatch):
        profile = drawn(np.random.default_rng(0), "rough", 2000)
        monkeypatch.setattr(first_order_several, "GapClosure", None)
        with pytest.raises(contact.OutOfRange, match="under the first-order closure"):
            contact.solve(contact.Scene(profile, 1.0, FIRST, load=0.9 * full_load(profile)))

    def test_more_zones_than_are_solved_near_full_contact_are_refused_before_that(self, monkeypatch):
        monkeypatch.setattr(first_order_several, "GapClosure", None)
        monkeypatch.setattr(first_order_several, "_MANY", 1)
        with pytest.raises(contact.OutOfRange, match="more zones than"):
            contact.solve(contact.Scene(TWO, 1.0, FIRST, load=0.99 * full_load(TWO)))

    @pytest.mark.slow
    def test_what_the_root_is_unsure_of_covers_what_a_closer_one_changes(self):
        scene = contact.Scene(TWO, 1.0, FIRST, load=0.97 * full_load(TWO))
        solution, tight = contact.solve(scene, tol=1e-6), contact.solve(scene, tol=1e-10)  # of 1e-11 rounding leaves more for some loads
        off = np.abs(solution.zones - tight.zones) / np.diff(tight.zones)
        assert off.max() <= solution.error + tight.error

    @pytest.mark.slow
    def test_short_series_beside_a_narrow_gap_are_stated(self):
        # A gap of 1e-3 of the zones: the pressure's slope reaches 250 times its peak a width, and 192 coefficients leave 2e-8.
        profile = drawn(np.random.default_rng([4242, 4, 6]), "wear_flats", 250, "uneven")
        scene = contact.Scene(profile, 1.0, FIRST, load=0.4 * full_load(profile))
        solutions = [contact.solve(scene, tol=tol) for tol in (1e-7, 1e-8)]
        along = (1 - np.cos(np.linspace(0.003, np.pi - 0.003, 400))) / 2
        first, second = ([each.pressure(a + along * (b - a)) for a, b in each.zones] for each in solutions)
        off = np.abs(np.array(first) - np.array(second)).max() / solutions[1].max_pressure
        assert 1e-8 < off <= sum(each.error for each in solutions)

    @pytest.mark.parametrize("seed, kind, points, part", [(0, "white_noise", 100, 0.9), (2, "ground", 200, 0.99)])
    def test_gaps_are_as_close_as_the_pressure_beside_them_asks_for(self, seed, kind, points, part):
        # Narrow gaps at the border: the pressure follows its ends several hundred times.
        profile = drawn(np.random.default_rng(seed), kind, points, "uneven")
        scene = contact.Scene(profile, 1.0, FIRST, load=part * full_load(profile))
        solution, tight = contact.solve(scene), contact.solve(scene, tol=1e-9)
        assert solution.error <= 1e-8
        along = (1 - np.cos(np.linspace(0.01, np.pi - 0.01, 400))) / 2
        pressures = [each.pressure(each.zones[0, 0] + along * np.diff(each.zones[0])) for each in (solution, tight)]
        assert np.abs(pressures[0] - pressures[1]).max() <= (solution.error + tight.error) * tight.max_pressure
