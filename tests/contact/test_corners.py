"""Profiles with kinks, jumps of the curvature and sharp corners, against exact contacts.
The kinks, jumps and corners lie in zones, at their ends and outside them.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import contact
from contact.formulation.full_contact import lowest
from contact.reference import exact
from contact.search.strategies.gaps import GapOptions
from contact.studies.scene_families import piecewise
from contact.testing import check_profile
from tests.contact import reference
from tests.contact.corners import CorneredZone, FoldedContact, Power, Wave, polygon, rows
from tests.contact.judge import counterparts, end_error, solve, unit_pressure
from tests.tiers import quick

# The stated error holds for pressures at this distance from kinks and sharp corners, or farther
# away. The distance is in half widths of the zone.
NEAREST = 0.01
T = np.cos((np.arange(200) + 0.5) * np.pi / 200)

PUNCH = rows([(-1.0, -0.1), (1.0, 0.1)])  # a flat with parabolic shoulders
TIP = rows([(-0.2, 0.5), (0.2, -0.5)])  # a wedge with a parabolic tip
PAIR = rows([(-0.4, 0.3), (0.1, 0.5)])

SCENES = {
    "rounded punch": CorneredZone((-1.5, 1.5), bends=PUNCH),
    "rounded punch, tilt_search on one shoulder": CorneredZone((-0.4, 1.6), bends=PUNCH),
    "wedge with a rounded tip": CorneredZone((-1.5, 1.5), bends=TIP, bend=0.5),
    "wedge with a rounded tip, unsymmetric": CorneredZone((-1.1, 1.5), bends=TIP, bend=0.5),
    "truncated wedge": CorneredZone((-1.5, 1.5), rows([(-1, 0.1), (1, 0.1)])),
    "truncated wedge, two slopes": CorneredZone((-1.1, 1.5), rows([(-1, 0.1), (1, 0.2)])),
    "steep trapezoid": CorneredZone((-1.1 - 1e-3, 1.0 + 2e-3), rows([(-1.1, 50.0), (1.0, 80.0)])),
    "corners and bends": CorneredZone(
        (-1, 1), PAIR, rows([(-0.7, -0.2), (0.3, 0.4), (1.2, 0.1)]), 0.3
    ),
    "trapezoid row": CorneredZone((-0.3, 0.3), rows([(-0.2, 0.1), (0.2, 0.1)]), period=1.0),
    "sawtooth row": CorneredZone((-0.3, 0.2), rows([(0.1, 0.3)]), period=1.0),
    "polygon row": CorneredZone(
        (-0.3, 0.2),
        rows([(-0.25, 0.1), (-0.1, 0.04), (0.1, 0.3), (0.15, 0.1), (0.3, 0.01)]),
        period=1.0,
    ),
    "body that ends at corners": CorneredZone((-1, 1.2), PAIR, punch=0.2, tilted=0.1),
    "row of bodies that end at corners": CorneredZone(
        (-0.3, 0.2), rows([(-0.1, 0.3), (0.1, 0.2)]), period=1.0, punch=0.2, tilted=0.002
    ),
}
each_scene = pytest.mark.parametrize("answer", SCENES.values(), ids=SCENES)

UP, DOWN = (
    np.polynomial.chebyshev.cheb2poly([0, 0, 0, 1]) * 1.3,
    np.polynomial.chebyshev.cheb2poly([0, 0, 1]) * 1.3,
)
FOLDED = {
    "two zones, kinks and bends": FoldedContact(
        Power(tuple(DOWN)), CorneredZone((-0.8, 0.7), PAIR, rows([(-0.6, -0.1), (0.3, 0.2)]), 0.2)
    ),
    "three zones": FoldedContact(Power(tuple(UP)), CorneredZone((-0.8, 0.7), PAIR)),
    "three zones 1e-4 of a zone apart": FoldedContact(
        Power(tuple(UP / 1.3 * 1.0001)), CorneredZone((-0.99, 0.9999), PAIR)
    ),
    "three zones, kinks 1e-9 beside their ends": FoldedContact(
        Power(tuple(UP)),
        CorneredZone((-0.8, 0.7), rows([(-0.8 + 1e-9, 0.3), (0.1, 0.2), (0.7 + 1e-9, 0.1)])),
    ),
    "four zones a period": FoldedContact(
        Wave((0.1, 1.0), (0.2, 0.3), 2.0), CorneredZone((-0.6, 0.5), PAIR)
    ),
    "a valley's gap of a thousandth": FoldedContact(
        Wave((1.0,), (0.2,), 2.0), CorneredZone((-0.99, 0.999), PAIR)
    ),
}


def solved(answer, tol=1e-8, **control):
    """The solution for an exact contact's profile, under its load or the given control."""
    model = contact.Isolated() if answer.period is None else contact.Periodic()
    return solve(
        answer.profile, model, answer.E_star, tol=tol, **(control or {"load": answer.load})
    )


def off(solution, answer):
    """The larger of the errors of the pressure and of the ends; `Solution.error` bounds it.
    Pressures closer than NEAREST to a kink or a sharp corner are left out.
    """
    order, _ = counterparts(solution, answer)
    worst = 0.0
    for i, k in enumerate(order):
        a, b = answer.zones[i]
        away = 0.5 * (a + b) + 0.5 * (b - a) * T[:, None] - answer.profile.kinks[:, 0]
        if answer.period is not None:
            away = away - np.round(away / answer.period) * answer.period
        clear = np.all(np.abs(away) > 0.5 * NEAREST * (b - a), axis=1)
        if answer.profile.support is not None:
            clear &= np.abs(T) < 1 - NEAREST
        worst = max(
            worst,
            float(
                np.max(np.abs(solution.pressure_at(T[clear], k) - answer.pressure_at(T[clear], i)))
            ),
        )
    return max(worst / unit_pressure(answer), end_error(solution, answer))


class TestTheExactContacts:
    @pytest.mark.parametrize("answer", [*SCENES.values(), *FOLDED.values()], ids=[*SCENES, *FOLDED])
    def test_satisfy_the_equation(self, answer):
        breaks = np.concatenate(
            (answer.zones.ravel(), answer.profile.kinks[:, 0], answer.profile.jumps[:, 0])
        )
        # The inverse square root at a sharp corner costs double-exponential quadrature half of
        # its digits.
        tolerance = 1e-7 if answer.profile.support is not None else 1e-10
        for a, b in answer.zones:
            for part in (0.13, 0.47, 0.81):
                x = a + part * (b - a)
                slope = 0.5 * answer.E_star * float(answer.slope(np.array(x)))
                terms = 0.5 * answer.E_star * np.abs(answer.profile.kinks[:, 1]).max(initial=0.1)
                assert (
                    abs(reference.folded_transform(answer, x, breaks) - slope) < tolerance * terms
                )

    @each_scene
    def test_carry_their_load(self, answer):
        (a, b), kinks = answer.zone, answer.profile.kinks[:, 0]
        ends = np.unique(np.concatenate(([a, b], kinks[(kinks > a) & (kinks < b)])))

        # With the middle m and the half width h of a piece, x = m + h sin(y) makes the
        # integrand smooth at the ends of the zone and bounded at kinks.
        def inner(y, lo, hi):
            return (
                float(answer.pressure(np.array(0.5 * (lo + hi) + 0.5 * (hi - lo) * np.sin(y))))
                * 0.5
                * (hi - lo)
                * np.cos(y)
            )

        pieces = zip(ends[:-1], ends[1:], strict=True)
        total = sum(
            quad(inner, -np.pi / 2, np.pi / 2, piece, epsabs=1e-12, limit=200)[0]
            for piece in pieces
        )
        assert total == pytest.approx(answer.load, rel=1e-7)

    def test_are_those_known_of_wedges_and_of_the_rounded_punch(self):
        wedge = exact.PeriodicWedge(wedge_slope=0.1, period=1.0, E_star=2.0, half_width=0.3)
        tip = CorneredZone((-0.3, 0.3), rows([(0.0, 0.2)]), E_star=2.0, period=1.0)
        assert tip.pressure_at(T) == pytest.approx(wedge.pressure_at(T), rel=1e-13)
        assert tip.load == pytest.approx(wedge.load, rel=1e-14)
        # The punch has a flat of half width b and shoulders of radius R. In contact on the half
        # width a, its load P obeys, with sin(phi0) = b/a,
        # 4 P R/(E* b^2) = (pi - 2 phi0)/sin(phi0)^2 - 2 cot(phi0).
        # M. Ciavarella, D. A. Hills, G. Monno, Proc. IMechE C 212 (1998) 319,
        # doi 10.1243/0954406981521259.
        phi0 = np.arcsin(1 / 1.5)
        known = (np.pi - 2 * phi0) / np.sin(phi0) ** 2 - 2 / np.tan(phi0)
        assert 4 * SCENES["rounded punch"].load / 0.1 == pytest.approx(known, rel=1e-14)

    @pytest.mark.parametrize("answer", [*SCENES.values(), *FOLDED.values()], ids=[*SCENES, *FOLDED])
    def test_declare_their_corners_as_they_are(self, answer):
        if answer.profile.support is None:
            check_profile(answer.profile)

    def test_a_load_a_part_in_ten_thousand_off_is_seen(self):
        """The comparison of this file detects a load that is wrong by 1e-4."""
        answer = SCENES["corners and bends"]
        assert off(solved(answer, load=answer.load * (1 + 1e-4)), answer) > 1e-6


class TestOneZone:
    @each_scene
    @pytest.mark.parametrize("tol", [1e-8, 1e-11])
    def test_is_exact_and_its_error_honest(self, answer, tol):
        solution = solved(answer, tol)
        assert off(solution, answer) <= solution.error <= tol
        assert solution.load == pytest.approx(answer.load, rel=1e-12)
        assert solution.certificate.holds

    @pytest.mark.parametrize(
        "distance", quick([1e-1, 1e-3, 1e-6, 1e-9, 1e-12], [1e-1, 1e-6, 1e-12])
    )
    @pytest.mark.parametrize(
        "place", ["inside", "outside", "both sides, in a row", "two corners inside"]
    )
    def test_corners_may_lie_right_beside_the_ends(self, distance, place):
        r = distance
        answer = {
            "inside": lambda: CorneredZone((-1, 1), rows([(0.2, 0.1), (1 - r, 0.2)])),
            "outside": lambda: CorneredZone((-1, 1), rows([(0.2, 0.1), (1 + r, 0.2)])),
            "both sides, in a row": lambda: CorneredZone(
                (-0.3, 0.2),
                rows([(0.1, 0.1), (0.2 + r, 0.1), (0.2 - r, 0.05), (-0.3 - r, 0.1)]),
                period=1.0,
            ),
            # Only two corners carry load; they lie just inside the ends of the zone.
            "two corners inside": lambda: CorneredZone(
                (-1 - r, 1 + r), rows([(-1, 0.1), (1, 0.1)])
            ),
        }[place]()
        solution = solved(answer)
        assert off(solution, answer) <= solution.error <= 1e-8

    @pytest.mark.parametrize("distance", [1e-1, 1e-2, 1e-3])
    def test_shoulders_may_begin_right_beside_the_ends(self, distance):
        answer = CorneredZone((-1 - distance, 1 + distance), bends=PUNCH)
        solution = solved(answer)
        assert off(solution, answer) <= solution.error <= 1e-8
        assert solution.plan.counts["own_modes"] <= 64

    @settings(max_examples=12)
    @given(
        at=st.lists(st.floats(-0.45, 0.45), min_size=1, max_size=12, unique=True),
        sizes=st.lists(st.floats(0.01, 1.0), min_size=12, max_size=12),
        ends=st.tuples(st.floats(-0.4, -0.05), st.floats(0.05, 0.4)),
    )
    def test_any_convex_polygon(self, at, sizes, ends):
        # Corners closer to each other than 1e-3 are united. The corner added in the middle
        # makes sure that the zone contains a corner.
        at = np.append(np.unique(np.round(at, 3)), 0.5 * (ends[0] + ends[1]))
        answer = CorneredZone(
            ends, np.unique(np.column_stack((at, sizes[: len(at) - 1] + [0.5])), axis=0)
        )
        solution = solved(answer)
        assert off(solution, answer) <= solution.error <= 1e-8

    @pytest.mark.parametrize(
        ("name", "control"),
        [
            ("trapezoid row", "approach"),
            ("trapezoid row", "contact_fraction"),
            ("trapezoid row", "mean_pressure"),
            ("sawtooth row", "approach"),
            ("sawtooth row", "contact_fraction"),
            ("truncated wedge", "approach"),
            ("truncated wedge", "half_width"),
            ("rounded punch", "approach"),
            ("rounded punch", "half_width"),
        ],
    )
    def test_every_control_comes_to_the_same_contact(self, name, control):
        answer = SCENES[name]
        model = contact.Periodic() if answer.period else contact.Isolated(datum=10.0)
        by_load = solve(answer.profile, model, tol=1e-11, load=answer.load)
        value = answer.half if control == "half_width" else getattr(by_load, control)
        assert off(solve(answer.profile, model, tol=1e-8, **{control: value}), answer) < 1e-8


class TestASharpCorner:
    """The profile f = 0.05 |x| of a body that ends at sharp corners at x = -1 and x = 1."""

    def body(self):
        return CorneredZone((-1.0, 1.0), rows([(0.0, 0.1)]), punch=1.0).profile

    def test_is_no_end_of_a_light_contact(self):
        answer = CorneredZone((-0.9, 0.9), rows([(0.0, 0.1)]))
        solution = solve(self.body(), contact.Isolated(), load=answer.load)
        assert end_error(solution, answer) < 1e-8 and np.isinf(solution.max_pressure)

    @pytest.mark.parametrize("excess", [1e-9, 1e-4, 1.0])
    def test_is_the_end_of_every_heavier_one(self, excess):
        answer = CorneredZone((-1.0, 1.0), rows([(0.0, 0.1)]), punch=excess)
        solution = solve(self.body(), contact.Isolated(), load=answer.load)
        assert np.array_equal(solution.zones, answer.zones)
        assert off(solution, answer) <= solution.error <= 1e-8

    @pytest.mark.parametrize("excess", [1e-9, 1e-3, 0.2])
    def test_no_load_makes_a_contact_wider_than_the_body(self, excess):
        punch = contact.Combined(contact.Flat(0.8, 1.0), contact.Parabola(1.0, 1.0))
        scene = contact.Scene(punch, 1.0, contact.Periodic(), contact_fraction=0.8 + excess)
        with pytest.raises(
            contact.OutOfRange, match=r"above 0\.8: no load makes the contact wider than the body"
        ):
            contact.solve(scene)

    def test_a_flat_with_steep_sides_keeps_its_ends_at_its_corners_until_the_load_is_heavy(self):
        beyond = []
        for load in (1e-4, 1e-2, 1.0, 30.0):
            solution = solve(
                CorneredZone((-1.1, 1.1), rows([(-1, 20.0), (1, 20.0)])).profile,
                contact.Isolated(),
                load=load,
            )
            beyond.append(float(solution.zones[0, 1]) - 1)
            # P = E* s sqrt(a^2 - b^2), with the slope s of the sides, the half width a of the
            # zone, and the corners at -b and b.
            assert (1 + beyond[-1]) ** 2 - 1 == pytest.approx((load / 20.0) ** 2, rel=1e-4)
        assert beyond[0] < 1e-10 and beyond[-1] > 0.5


class TestManyZones:
    @pytest.mark.parametrize("answer", FOLDED.values(), ids=FOLDED)
    def test_with_corners_in_all_of_them_are_exact_and_their_error_honest(self, answer):
        solution = solved(answer)
        assert off(solution, answer) <= solution.error <= 1e-8
        assert solution.load == pytest.approx(answer.load, rel=1e-12)
        assert solution.zone_loads == pytest.approx(
            np.full(len(answer.zones), answer.base.load), rel=1e-7
        )


class TestNearlyFullContact:
    @pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-5, 1e-6])
    def test_the_gap_over_a_valley_between_two_corners(self, gap):
        answer = CorneredZone(
            (-0.5 + gap / 2, 0.5 - gap / 2), rows([(-0.2, 0.1), (0.2, 0.1)]), period=1.0
        )
        solution = solved(answer)
        assert off(solution, answer) <= solution.error <= 1e-8
        assert solution.certificate.note == "solved by its gaps"

    @pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-5])
    def test_the_gap_over_the_valley_of_a_sawtooth(self, gap):
        answer = CorneredZone((-0.5 + 0.8 * gap, 0.5 - 0.2 * gap), rows([(0.1, 0.3)]), period=1.0)
        solution = solved(answer)
        assert off(solution, answer) <= solution.error <= 1e-8


def measured(points, seed):
    """The positions and heights of a random trace with the period 1 and the rms height 0.01."""
    rng = np.random.default_rng(seed)
    k = np.arange(1, points // 2)
    spectrum = np.append(np.append(0.0, k**-1.5 * np.exp(2j * np.pi * rng.random(len(k)))), 0.0)
    heights = np.fft.irfft(spectrum, points)
    return np.arange(points) / points - 0.5, 0.01 * heights / np.std(heights)


class TestMeasuredProfiles:
    @pytest.mark.parametrize("seed", range(3))
    def test_joined_by_straight_lines_are_solved_at_three_quarters_of_contact(self, seed):
        solution = solve(
            polygon(*measured(32, seed), 1.0), contact.Periodic(), tol=1e-8, contact_fraction=0.75
        )
        assert solution.certificate.holds and solution.error <= 1e-8
        assert solution.contact_fraction == pytest.approx(0.75, abs=1e-12)

    def test_joined_by_straight_lines_have_gaps_of_a_thousandth_of_a_billionth(self):
        # One of the 41 gaps is only 2e-12 of the period wide. Round-off of its position leaves
        # few digits of its width, and the stated error must still be true.
        solution = solve(polygon(*measured(128, 1), 1.0), contact.Periodic(), tol=1e-8, load=0.06)
        assert solution.certificate.note.startswith("solved by its gaps") and solution.error <= 1e-8

    def test_joined_by_straight_lines_satisfy_the_equation(self):
        profile = polygon(*measured(16, 0), 1.0)
        solution = solve(profile, contact.Periodic(), tol=1e-10, contact_fraction=0.75)
        a, b = solution.zones[int(np.argmax(solution.zone_widths))]
        breaks = np.concatenate((solution.zones.ravel(), profile.kinks[:, 0]))
        for x in a + np.array([0.2137, 0.7713]) * (b - a):
            left = reference.folded_transform(
                Repeated(solution), x, np.unique(breaks - np.round(breaks))
            )
            assert left == pytest.approx(
                0.5 * float(profile.slope(np.array(x))),
                abs=1e-8 * np.abs(profile.kinks[:, 1]).max(),
            )

    @pytest.mark.parametrize("seed", range(3))
    def test_splines_at_three_quarters_of_the_load_of_full_contact_by_gaps_and_by_zones(
        self, seed, monkeypatch
    ):
        x, heights = measured(64, seed)
        profile = contact.Sampled(x, heights, period=1.0)
        full = solve(profile, contact.Periodic(), contact_fraction=1.0)
        by_gaps = solve(profile, contact.Periodic(), tol=1e-8, load=0.75 * full.load)
        monkeypatch.setattr("contact.search.strategies.gaps.OPTIONS", GapOptions(wide_contact=2.0))
        by_zones = solve(profile, contact.Periodic(), tol=1e-7, load=0.75 * full.load)
        assert by_gaps.certificate.note == "solved by its gaps" and by_zones.certificate.note == ""
        assert by_zones.zones == pytest.approx(by_gaps.zones, abs=1e-7)
        widest = int(np.argmax(by_gaps.zone_widths))
        difference = by_zones.pressure_at(T, widest) - by_gaps.pressure_at(T, widest)
        assert np.abs(difference).max() <= (by_zones.error + by_gaps.error) * by_gaps.max_pressure


class Repeated:
    """The pressure and the period of a solution, which are all that the quadrature uses."""

    def __init__(self, solution):
        self.pressure, self.period = solution.pressure, solution.scene.period


@pytest.mark.parametrize("seed", range(8))
def test_the_lowest_height_of_a_piecewise_linear_profile_is_that_of_its_lowest_corner(seed):
    """The least height of a piecewise linear profile is that of a corner, without round-off."""
    profile = piecewise(np.random.default_rng([44, seed]), 1.0)
    assert lowest(profile, (float(profile.at[0]), float(profile.at[-1]))) == profile.heights.min()
