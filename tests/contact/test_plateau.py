"""Profiles with flat tops: contact is always wider, and a narrower given contact is refused."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import contact
from contact.search.feasibility import lowest_stretches
from contact.studies.bench.truncated import IsolatedTruncatedWedge, TruncatedWedge

E = 1e9
# The shapes are so steep and the loads so high that the model warns.
pytestmark = pytest.mark.filterwarnings("error", "ignore::contact.ModelWarning")


@dataclass(frozen=True)
class Plateaus(contact.Profile):
    """A profile of straight lines between the corners `at`, over a period of 1."""

    at: tuple[float, ...]
    heights: tuple[float, ...]
    symmetric: bool = False
    period = 1.0

    def height(self, x):
        return np.interp(self.wrap(x), self.at, self.heights)

    def slope(self, x):
        slopes = np.diff(self.heights) / np.diff(self.at)
        piece = np.searchsorted(self.at, self.wrap(x), side="right") - 1
        return slopes[np.minimum(piece, len(slopes) - 1)]

    @property
    def kinks(self):
        slopes = np.diff(self.heights) / np.diff(self.at)
        return np.column_stack((self.at[:-1], slopes - np.roll(slopes, 1)))


TRAPEZOID = Plateaus((-0.5, -0.1, 0.1, 0.5), (0.004, 0.0, 0.0, 0.004), symmetric=True)
LOPSIDED = Plateaus((-0.5, -0.1, 0.15, 0.5), (0.004, 0.0, 0.0, 0.004))
# The second of the lowest flats crosses the border of the period; the flat at 1e-4 is higher.
SEVERAL = Plateaus(
    (-0.5, -0.4, -0.3, -0.2, 0.0, 0.1, 0.15, 0.2, 0.22, 0.25, 0.5),
    (0, 0, 0.01, 0, 0, 0.01, 0.01, 1e-4, 1e-4, 0, 0),
)
WIDTHS = [(TRAPEZOID, 0.2), (LOPSIDED, 0.25), (SEVERAL, 0.55)]


@pytest.mark.parametrize(("profile", "width"), WIDTHS)
@pytest.mark.parametrize("part", [0.01, 0.5, 1 - 1e-12, 1.0])
def test_a_contact_fraction_that_flat_tops_exceed_is_refused_by_their_width(profile, width, part):
    scene = contact.Scene(profile, E, contact.Periodic(), contact_fraction=part * width)
    with pytest.raises(
        contact.OutOfRange, match=rf"contact_fraction .* is not above {width:.6g}: .* give a load"
    ):
        contact.solve(scene)


@pytest.mark.parametrize(("profile", "width"), WIDTHS)
def test_a_fraction_above_flat_tops_has_zones_that_contain_them(profile, width):
    solution = contact.solve(
        contact.Scene(profile, E, contact.Periodic(), contact_fraction=width + 0.01)
    )
    assert abs(solution.contact_fraction - width - 0.01) < 1e-12
    assert np.all(solution.gap(np.linspace(-0.5, 0.5, 4001)) >= 0)
    for lo, hi in lowest_stretches(profile):
        turns = np.round((solution.zones.mean(axis=1) - 0.5 * (lo + hi)) / profile.period)
        assert np.any((solution.zones[:, 0] - turns < lo) & (hi < solution.zones[:, 1] - turns))


def test_the_load_grows_as_the_root_of_the_excess_over_the_flat_top():
    # The fraction is rounded by 1e-16, that is, by 1e-7 of its excess over the flat top.
    loads = [
        contact.solve(
            contact.Scene(TRAPEZOID, E, contact.Periodic(), contact_fraction=0.2 * (1 + over))
        ).load
        for over in (1e-9, 1e-7)
    ]
    assert abs(loads[1] / loads[0] / 10 - 1) < 2e-7


@pytest.mark.parametrize("part", [1e-3, 0.5, 1.0])
@pytest.mark.parametrize(
    ("profile", "model"),
    [
        (TRAPEZOID, contact.Periodic()),
        (TRAPEZOID, contact.Localized()),
        (TruncatedWedge(0.01, 0.1), contact.Isolated()),
    ],
)
def test_a_half_width_of_the_flat_part_or_less_is_refused_by_its_width(profile, model, part):
    scene = contact.Scene(profile, E, model, half_width=0.1 * part)
    with pytest.raises(
        contact.OutOfRange, match=r"half_width .* is not above 0\.1 m: .* give a load"
    ):
        contact.solve(scene)


@pytest.mark.parametrize("over", [1e-12, 1e-6])
def test_a_half_width_a_hair_above_the_flat_part_has_the_load_of_the_closed_form(over):
    profile = TruncatedWedge(0.01, 0.1)
    half_width = 0.1 * (1 + over)
    solution = contact.solve(contact.Scene(profile, E, contact.Isolated(), half_width=half_width))
    assert abs(solution.load / IsolatedTruncatedWedge(0.01, 0.1, E, half_width).load - 1) < 1e-9


def test_smooth_tips_are_not_taken_for_flat_tops():
    for profile in (
        contact.Sinusoid(1e-6, 1e-4),
        contact.Polynomial([0, 0, 0, 0, 0, 0, 0, 0, 1e20], period=1e-3),
    ):
        assert len(lowest_stretches(profile)) == 0
        solution = contact.solve(
            contact.Scene(profile, E, contact.Periodic(), half_width=1e-6 * profile.period)
        )
        assert solution.load > 0


class TestLightLoads:
    """Contact that ends very close to the corners of a flat top of the half width d.

    The ends lie beyond the corners by (load / (E* slope))^2 / (2 d). This is far less than the
    round-off of their positions.
    """

    @pytest.mark.parametrize("load", 10.0 ** np.arange(4, -10, -2))
    def test_the_pressure_is_that_of_the_closed_form(self, load):
        slope, half_top, t = 0.01, 0.1, np.linspace(-0.999, 0.999, 41)
        passed = load / (E * slope)
        away = np.hypot(half_top, passed) * np.sqrt((1 - t) * (1 + t))
        inside = passed < away
        ratio = np.where(inside, passed / away, away / passed)
        exact = E * slope / np.pi * np.arctanh(ratio)
        solution = contact.solve(
            contact.Scene(TruncatedWedge(slope, half_top), E, contact.Isolated(), load=load),
            tol=1e-9,
        )
        assert np.abs(solution.pressure_at(t) / exact - 1).max() <= solution.error <= 1e-9
        assert solution.certificate.holds and not solution.certificate.undecided

    def test_unlike_corners_are_passed_by_distances_inverse_to_their_kinks_squared(self):
        """The distance r of an end beyond its corner is proportional to (load / J)^2.

        J is the change of the slope at the corner. A flat punch on |t| < 1 under the load P has
        the intensity K = P/(pi sqrt(2)). The corner at the distance r from the end must cancel
        it with (E* J/pi) sqrt(r).
        """
        profile = Plateaus((-0.5, -0.1, 0.1, 0.3, 0.5), (0.5, 0.0, 0.0, 0.6, 0.5))
        passed = []
        for load in (1e-9, 1e-10):
            solution = contact.solve(
                contact.Scene(profile, 1.0, contact.Isolated(), load=load), tol=1e-9
            )
            steps = solution.fields.density.jumps
            passed.append([steps.left.min(), steps.right.min()])
        left, right = np.transpose(passed)
        assert abs(left[0] / right[0] / (3.0 / 1.25) ** 2 - 1) < 1e-7
        assert np.abs(np.array([left[0] / left[1], right[0] / right[1]]) / 100 - 1).max() < 1e-7


@pytest.mark.parametrize(("load", "tol"), [(1e-7, 1e-8), (1e-9, 1e-6)])
def test_a_light_load_touches_only_the_lowest_of_the_sharp_tips(load, tol):
    """The width of contact is that of an isolated wedge.

    With the slopes s and s' and the ends a and b, the load is
    P = (E*/4) (b - a) (s + s') sin(pi s / (s + s')).
    """
    profile = Plateaus((-0.5, -0.21, 0.0, 0.1837, 0.5), (1.0, 0.0, 0.3, -1e-5, 1.0))
    solution = contact.solve(contact.Scene(profile, 1.0, contact.Isolated(), load=load), tol=tol)
    assert len(solution.zones) == 1
    left, right = 0.30001 / 0.1837, 1.00001 / 0.3163
    share = np.pi * right / (left + right)
    exact = 4 * load / ((left + right) * np.sin(share))
    # The positions of the ends are rounded, which limits the accuracy of the width.
    assert abs(np.diff(solution.zones)[0, 0] / exact - 1) < solution.error <= tol
    with pytest.raises(contact.NotConverged, match="positions so far from x = 0"):
        contact.solve(contact.Scene(profile, 1.0, contact.Isolated(), load=load), tol=1e-10)


@pytest.mark.slow
def test_a_row_of_flat_tops_is_solved_at_any_load_with_and_without_a_warm_start():
    """The distance of an end beyond its corner is proportional to the square of the load."""
    profile = Plateaus(
        (-0.5, -0.35, -0.25, 0.25, 0.35, 0.5), (0.2, 0.2, 0.0, 0.0, 0.2, 0.2), symmetric=True
    )
    passed, near = [], None
    for load in (1e-9, 3e-8, 1e-6, 1e-4):
        scene = contact.Scene(profile, 1.0, contact.Periodic(), load=load)
        alone, near = contact.solve(scene), contact.solve(scene, near=near)
        assert max(alone.error, near.error) <= 1e-8 and alone.certificate.holds
        assert np.abs(near.pressure_at(0.7) / alone.pressure_at(0.7) - 1) < 1e-8
        passed.append(alone.fields.density.jumps.right.min() / load**2)
    assert np.abs(np.array(passed) / passed[0] - 1).max() < 1e-6
