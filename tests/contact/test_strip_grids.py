"""The contact of one strip on grids that are even in the angle of the strip, or in x."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import contact
from contact.search.grid.conjugate_gradient import Response
from contact.search.grid.strip import StripGrid
from contact.studies.trace_kinds import drawn

ROUGH = contact.Fourier(1.0, [-0.01, 0.004, 0.002, -0.003], [0.003, -0.002, 0.004, 0.002])


def full_load(profile):
    return contact.solve(contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)).load


class TestGrids:
    @pytest.mark.parametrize("load", [1e-3, 1e-2, 3e-2])
    def test_grids_even_in_the_angle_and_in_x_tell_the_same_contact(self, load):
        of_x, of_angle = (
            StripGrid(Response(1.0, False), 1.0, 0.25, turns).contact(
                ROUGH.height, 0.1, load, 2048, 1e-6, None
            )
            for turns in (False, True)
        )
        assert of_x.zones.shape == of_angle.zones.shape and of_x.reaches == of_angle.reaches
        assert np.abs(of_x.zones - of_angle.zones).max() < 2 / 2048

    @pytest.mark.parametrize("turns", [False, True])
    def test_room_beside_a_border_falls_below_zero_as_the_strip_touches_it(self, turns):
        grid = StripGrid(Response(1.0, False), 1.0, 0.25, turns)
        found = [
            grid.contact(ROUGH.height, 0.1, load, 1024, 1e-6, None)
            for load in np.geomspace(1e-3, 0.2, 12)
        ]
        for side in (0, 1):
            room = np.array([each.beside[side] for each in found])
            assert (
                np.all((room < 0) == [each.reaches[side] for each in found])
                and room[-1] < 0 < room[0]
            )
            assert np.all(np.diff(room[room > 0]) < 0)

    @pytest.mark.parametrize("kind", ["plateaus", "ground"])
    def test_begun_from_one_beside_it_a_strip_is_the_same_and_found_sooner(self, kind):
        profile = drawn(np.random.default_rng(4), kind, 300)
        grid, load = (
            StripGrid(Response(1.0, False), profile.period, profile.feature, True),
            0.3 * full_load(profile),
        )
        near = grid.contact(profile.height, 0.0, load, 8192, 1e-3, None)
        aside = 20 * near.cell
        moved, left, afresh = (
            grid.contact(profile.height, aside, load, 8192, 1e-3, start)
            for start in (near, replace(near, middle=aside), None)
        )
        assert abs(moved.width - afresh.width) < 1e-3 * afresh.width
        assert moved.state.iterations < 0.7 * left.state.iterations

    def test_a_flat_strip_is_pressed_as_by_a_punch(self):
        # p = P / (pi sqrt(h^2 - x^2)): even in the angle.
        found = StripGrid(Response(1.0, False), 2.0, 0.25, True).contact(
            np.zeros_like, 0.3, 5.0, 64, 1e-8, None
        )
        assert np.allclose(found.zones, [[-0.7, 1.3]]) and found.reaches == (True, True)
        assert np.allclose(found.state.pressure, 5.0 / np.pi)
