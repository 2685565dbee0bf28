"""Bodies that turn: a given tilt, or the tilt that a given moment asks for, against closed forms and against each other."""

import numpy as np
import pytest

import contact
from contact.exact.tilted import TiltedParabola, TiltedPunch, TiltedWedge
from contact.inverse import design

ALONE = contact.Isolated()
T = np.array([-0.99, -0.7, -0.2, 0.31, 0.8, 0.99])
E_STAR, LOAD = 1e9, 100.0


def solve(profile, tol=1e-10, interaction=ALONE, load=LOAD, **turned):
    return contact.solve(contact.Scene(profile, E_STAR, interaction, load=load, **turned), tol=tol)


def true_error(solution, exact, t=T):
    """Pressure over the peak (over the mean where that is infinite) and ends over the width."""
    width = np.diff(exact.zones, axis=1)[0, 0]
    peak = solution.max_pressure if np.isfinite(solution.max_pressure) else solution.load / width
    pressure = np.abs(solution.pressure_at(t) - exact.pressure_at(t)).max() / peak
    return max(pressure, np.abs(solution.zones - exact.zones).max() / width)


@pytest.mark.parametrize("moment", [0.0, 3e-4, -1e-3, 2e-3])
class TestParabola:
    def test_only_moves_its_zone(self, moment):
        """x^2/2R - tilt x is the same parabola about R tilt: M = P R tilt."""
        solution = solve(contact.Parabola(1e-2), moment=moment)
        tilt = moment / LOAD / 1e-2
        exact = TiltedParabola(1e-2, E_STAR, 0.5 * solution.zone_widths[0], tilt)
        assert solution.tilt == pytest.approx(tilt, rel=1e-11, abs=1e-15)
        assert solution.moment == pytest.approx(moment, rel=1e-11, abs=1e-14)
        assert true_error(solution, exact) <= solution.error <= 1e-10

    def test_the_tilt_given_back_has_that_moment(self, moment):
        turned = solve(contact.Parabola(1e-2), tilt=moment / LOAD / 1e-2)
        assert turned.moment == pytest.approx(moment, rel=1e-10, abs=1e-14)


@pytest.mark.parametrize("share", [0.05, 0.3, -0.49, 0.51, 0.7, -0.95])
def test_a_flat_punch_stands_on_all_of_its_face_up_to_a_quarter_of_it_and_then_on_one_corner(share):
    moment = LOAD * share * 5e-5
    solution = solve(contact.Flat(1e-4), tol=1e-8, moment=moment)
    exact = TiltedPunch(5e-5, E_STAR, LOAD, moment)
    assert exact.lifted == (abs(share) > 0.5)
    assert solution.tilt == pytest.approx(exact.tilt, rel=1e-9)
    assert true_error(solution, exact) <= solution.error <= 1e-8


@pytest.mark.parametrize("share", [0.1, 0.5, -0.9])
def test_a_wedge_leans_on_one_flank(share):
    moment = LOAD * share * 1e-5
    solution = solve(contact.Wedge(0.01), tol=1e-8, moment=moment)
    exact = TiltedWedge.balanced(LOAD, moment, 0.01, E_STAR)
    assert solution.tilt == pytest.approx(exact.tilt, rel=1e-8)
    # At the tip the pressure is infinite, and next to it as good as the tip's place.
    tip = -np.sin(0.5 * np.pi * exact.tilt / 0.01)
    assert true_error(solution, exact, T[np.abs(T - tip) > 0.05]) <= solution.error <= 1e-8


def test_a_moment_a_part_in_a_million_off_is_seen():
    moment = LOAD * 0.3 * 5e-5
    solution = solve(contact.Flat(1e-4), moment=moment)
    exact = TiltedPunch(5e-5, E_STAR, LOAD, moment * (1 + 1e-6))
    assert true_error(solution, exact) > 1e-7


@pytest.mark.parametrize("tilt", [-0.003, 0.002])
def test_designed_zones_come_back_when_the_body_they_belong_to_is_given_turned(tilt):
    """f + tilt x, turned by the tilt that its moment asks for, is f."""
    designed = design([[-0.31, -0.2], [-0.12, 0.02], [0.1, 0.27]], 1.0, 0.01)
    plain = contact.solve(contact.Scene(designed.profile, 1.0, ALONE, load=designed.load), tol=1e-10)

    class Leaning(contact.Profile):
        resolution = designed.profile.resolution

        def height(self, x):
            return designed.profile.height(x) + tilt * np.asarray(x)

        def slope(self, x):
            return designed.profile.slope(x) + tilt

    solution = contact.solve(contact.Scene(Leaning(), 1.0, ALONE, load=designed.load, moment=plain.moment), tol=1e-9)
    assert solution.tilt == pytest.approx(tilt, rel=1e-6)
    assert np.abs(solution.zones - designed.zones).max() < 1e-8
    assert solution.certificate.holds


def test_the_rotational_stiffness_is_the_slope_of_moment_against_tilt():
    step = 1e-3
    low, here, high = (solve(contact.Wedge(0.01), moment=LOAD * 3e-6 * (1 + s)) for s in (-step, 0.0, step))
    slope = (high.moment - low.moment) / (high.tilt - low.tilt)
    assert here.rotational_stiffness == pytest.approx(slope, rel=1e-5)


class TestRefused:
    @pytest.mark.parametrize("given", [{"tilt": 0.1, "moment": 1.0}, {"tilt": np.nan}, {"moment": "1"}, {"moment": np.inf}])
    def test_what_is_no_tilt_or_moment(self, given):
        with pytest.raises(contact.SceneError, match="tilt|moment"):
            contact.Scene(contact.Parabola(1e-2), E_STAR, ALONE, load=LOAD, **given)

    @pytest.mark.parametrize("interaction", [contact.Periodic(), contact.Localized()])
    def test_a_row_does_not_turn(self, interaction):
        with pytest.raises(contact.SceneError, match="does not turn"):
            contact.Scene(contact.Sinusoid(1e-6, 1e-4), E_STAR, interaction, load=LOAD, moment=1e-3)

    def test_a_load_beside_the_punch(self):
        with pytest.raises(contact.OutOfRange, match="not between the corners"):
            solve(contact.Flat(1e-4), moment=LOAD * 6e-5)


def test_a_path_keeps_the_tilt():
    """Two tips at one height, turned: the second one touches later, and at less load the less it is turned."""
    profile = contact.Biquadratic(radius=1e-3, spacing=4e-5)
    births = []
    for tilt in (1e-4, 3e-4):
        scene = contact.Scene(profile, E_STAR, ALONE, load=1.0, tilt=tilt)
        births += [e.load for e in contact.path(scene, np.geomspace(1e-3, 30, 5)).events if e.kind == "birth"]
    assert len(births) == 2 and births[0] < births[1]
