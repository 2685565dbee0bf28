"""Narrow zones: the influence of their neighbours, zones that vanish or merge in a search, and
the round-off of positions in them.
"""

import mpmath
import numpy as np
import pytest

import sie
from contact.reference.inverse import random_problem
from sie.dense import modes
from sie.dense.modes import conformal_radius, felt
from sie.jumps.right_side import ForcingJumps


def equation(problem):
    kernel = sie.hilbert(problem.period)
    forcing = sie.Forcing(
        problem.profile.slope,
        problem.profile.height,
        resolution=sie.Resolution(length=problem.period / 64),
    )
    return sie.Equation(kernel, forcing, (sie.Total(problem.load), sie.EqualPotential()))


class TestBetweenNeighbours:
    """Wide zones at given potentials with a narrow zone between them, against closed forms for
    two half-lines and a point.
    """

    LONG, SMALL = 4000.0, 1e-4

    def levels(self, zones, heights):
        """The density of isolated zones with the given potentials `heights`."""
        edges = 0.5 * (zones[:-1, 1] + zones[1:, 0])
        forcing = sie.Forcing(
            lambda x: 0 * x, lambda x: np.asarray(heights)[np.searchsorted(edges, x)]
        )
        held = sie.Zones.of(zones, sie.SINGULAR, sie.SINGULAR)
        return sie.solve_fixed(
            sie.Equation(sie.cauchy(), forcing, (sie.Level(0.0),)), held, 1e-12
        ).density

    @pytest.mark.parametrize("left, right", [(1.0, 1.0), (0.3, 2.0), (5.0, 0.7)])
    def test_the_load_of_a_narrow_zone_follows_from_the_conformal_radius(self, left, right):
        w = self.SMALL
        zones = np.array([[-left - self.LONG, -left], [-w, w], [right, right + self.LONG]])
        density = self.levels(zones, [0.0, 1.0, 0.0])
        # The potential on the narrow zone is c_0 w log(w / 2R) = 1.
        radius = 0.5 * w * np.exp(-1 / (w * density.coefficients[1, 0]))
        assert radius == pytest.approx(
            float(conformal_radius(np.array(left), np.array(right))), rel=3e-3
        )

    @pytest.mark.parametrize("left, right", [(1.0, 1.0), (0.3, 2.0), (5.0, 0.7)])
    def test_weights_of_the_neighbours_potentials_are_harmonic_measures(self, left, right):
        zones = np.array([[-left - self.LONG, -left], [right, right + self.LONG]])
        potential = float(self.levels(zones, [1.0, -1.0]).potential(0.0))
        of_left, of_right = felt(np.array(left), np.array(right))
        assert potential == pytest.approx(float(of_left - of_right), abs=2e-3)
        assert of_left + of_right == 1.0


class TestPlacesBeyondTheLastDigit:
    """A zone of the width 1e-8 at 0.3. The round-off of its nodes is about 1e-8 of this width."""

    WAVE = 3e7

    def zones(self):
        a = 0.3
        return sie.Zones.of([[a, a + 1e-8]])

    def exact(self, n):
        """U coefficients of sin(WAVE x) from nodes with 40 digits."""
        zones = self.zones()
        with mpmath.workdps(40):
            middle = (mpmath.mpf(zones.a[0]) + mpmath.mpf(zones.b[0])) / 2
            half = (mpmath.mpf(zones.b[0]) - mpmath.mpf(zones.a[0])) / 2
            angles = [mpmath.pi * k / (n + 1) for k in range(1, n + 1)]
            values = [
                mpmath.sin(self.WAVE * (middle + half * mpmath.cos(angle))) for angle in angles
            ]
            return np.array(
                [
                    float(
                        2
                        * sum(
                            v * mpmath.sin(k * t) * mpmath.sin(t)
                            for v, t in zip(values, angles, strict=True)
                        )
                        / (n + 1)
                    )
                    for k in range(1, n + 1)
                ]
            )

    def found(self, forcing, n=16):
        sampled = modes.sample(forcing, self.zones(), ForcingJumps.none(), np.array([n]), 1e-13, n)
        return sampled.coefficients[0, 1:]

    def value(self, x):
        # The sine of WAVE times the given double, computed with 40 digits.
        with mpmath.workdps(40):
            return np.array(
                [float(mpmath.sin(self.WAVE * mpmath.mpf(place))) for place in np.ravel(x)]
            )

    @pytest.mark.parametrize(
        ("n", "wave"),
        [(16, 3e7), (128, 3e9)],
        ids=["a few", "many waves, whose nodes no matrix holds"],
    )
    def test_coefficients_are_exact_to_the_digits_of_the_function(self, monkeypatch, n, wave):
        monkeypatch.setattr(self, "WAVE", wave)
        error = np.abs(self.found(sie.Forcing(self.value), n) - self.exact(n)).max()
        assert error < 1e-14

    def test_without_the_correction_the_round_off_of_nodes_changes_the_coefficients(
        self, monkeypatch
    ):
        monkeypatch.setattr(modes, "SUM_ROUNDING", np.inf)
        error = np.abs(self.found(sie.Forcing(self.value)) - self.exact(16)).max()
        assert error > 1e-10

    def test_a_function_that_rounds_its_places_must_declare_it(self):
        """The function is evaluated at x rounded to multiples of `step`. With `rounded_place`,
        the coefficients are corrected for this rounding; without it, they are wrong.
        """
        step = 2.0**-52

        def placed(x):
            return np.round(x / step) * step

        told = sie.Forcing(
            lambda x: self.value(placed(x)), resolution=sie.Resolution(rounded_place=placed)
        )
        untold = sie.Forcing(lambda x: self.value(placed(x)))
        errors = [np.abs(self.found(f) - self.exact(16)).max() for f in (told, untold)]
        assert errors[0] < 1e-13 < 1e-9 < errors[1]


@pytest.mark.parametrize("width", [1e-9, 1e-13])
@pytest.mark.filterwarnings("error")
def test_a_narrow_zone_where_none_belongs_shrinks_away_without_a_division_by_its_width(width):
    problem = random_problem(np.random.default_rng(3), zones=6, period=1.0, E_star=2.0)
    middle = problem.zones[2, 1] + 0.37 * (problem.zones[3, 0] - problem.zones[2, 1])
    table = np.insert(problem.zones, 3, [middle - 0.5 * width, middle + 0.5 * width], axis=0)
    assert list(sie.find_ends(equation(problem), sie.Zones.of(table), 1e-10).lost) == [3]


def test_wrong_zones_of_a_first_guess_are_dropped_or_merged():
    """The first guess for a row of bumps has a zone between two bumps, where nothing touches, and
    a gap inside the contact of another bump. With `allow_loss` the search drops the zone and
    closes the gap. It finds the same ends as from the right number of zones.
    """
    wave = sie.Forcing(
        lambda x: np.sin(2 * np.pi * x), lambda x: -np.cos(2 * np.pi * x) / (2 * np.pi)
    )
    equation = sie.Equation(sie.hilbert(8.0), wave, (sie.Total(2.0), sie.EqualPotential()))
    table = np.arange(-3.0, 4.0)[:, None] + [-0.2, 0.2]
    right = sie.find_ends(equation, sie.Zones.of(table), 1e-11)
    doubtful = np.sort(np.concatenate((table.ravel(), [0.49, 0.51], [1.0, 1.001]))).reshape(-1, 2)
    assert not sie.find_ends(equation, sie.Zones.of(doubtful), 1e-11).converged
    found = sie.find_ends(
        equation, sie.Zones.of(doubtful), 1e-11, sie.NewtonOptions(allow_loss=True)
    )
    assert found.converged and found.density.zones.table == pytest.approx(
        right.density.zones.table, abs=1e-10
    )


def test_zones_joined_across_the_border_of_the_period_go_on_beyond_it():
    zones, kept = sie.Zones.of([[0.1, 0.2], [0.3, 0.4], [0.5, 0.6], [0.9, 1.0]]).changed(
        np.array([1]), np.array([2, 3]), 1.0
    )
    assert zones.table.round(12).tolist() == [[0.5, 1.2]] and kept.tolist() == [2]
