"""Isolated contact of two tips with a sharp valley between them: gaps down to 1e-8 of a zone.

Such a narrow gap is a slit in a wide zone, with the kink of the valley in the slit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.special import ellipe, ellipkm1

import contact
from tests.contact.judge import solve


@dataclass(frozen=True)
class RoundTips(contact.Profile):
    """The profile f = steepness ((|x| - 1)^2 - 1) / 2: a sharp valley between two round tips.

    unequal: ratio of the slopes of the left tip to those of the right tip.
    """

    steepness: float = 0.1
    unequal: float = 1.0

    def height(self, x):
        x = np.asarray(x, dtype=float)
        side = np.where(x < 0, self.unequal, 1.0)
        return 0.5 * self.steepness * side * ((np.abs(x) - 1) ** 2 - 1)

    def slope(self, x):
        x = np.asarray(x, dtype=float)
        return self.steepness * np.where(x < 0, self.unequal, 1.0) * np.sign(x) * (np.abs(x) - 1)

    @property
    def symmetric(self):
        return self.unequal == 1.0

    @property
    def kinks(self):
        return np.array([[0.0, -self.steepness * (1 + self.unequal)]])

    @property
    def jumps(self):
        return np.array([[0.0, 2, self.steepness * (1 - self.unequal)]])[self.unequal == 1.0 :]

    def closed(self, a):
        """The right end b and the load over E*, if equal tips touch at a < |x| < b.

        In y = x^2 the two zones are one zone. With k^2 = 1 - a^2/b^2 its conditions are
        b = (2/pi) K(k) and P = (E* slope/2) (pi (a^2 + b^2)/2 - 2 b E(k)), derived here. K and
        E are the complete elliptic integrals, and slope is the steepness.
        """
        b = 1.0
        for _ in range(200):
            b = 2 / np.pi * ellipkm1((a / b) ** 2)
        return b, 0.5 * self.steepness * (
            0.5 * np.pi * (a * a + b * b) - 2 * b * ellipe(1 - (a / b) ** 2)
        )


class TestSharpValley:
    """The gap over the kink never closes.

    Its width decreases exponentially with the mean pressure.
    """

    @pytest.mark.parametrize("a", [0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8])
    def test_ends_and_load_are_those_of_the_closed_form(self, a):
        b, load = RoundTips().closed(a)
        solution = solve(RoundTips(), contact.Isolated(), 1.0, tol=1e-8, load=load)
        exact = np.array([[-b, -a], [a, b]])
        assert np.abs(solution.zones - exact).max() / (b - a) <= solution.error <= 1e-8
        assert abs(solution.zones[1, 0] / a - 1) < 1e-5 and solution.certificate.holds
        assert solution.plan["slits"].used == (a < 0.02)
        inside = np.array([-0.5, 0.0, 0.5]) * a
        assert np.all(solution.gap(inside) > 0) and np.all(solution.pressure(inside) == 0)

    def test_unequal_tips_keep_their_certificate_and_share_an_approach(self):
        gaps = []
        for load in (1.0, 3.0, 5.0, 8.0, 15.0):
            solution = solve(
                RoundTips(unequal=1.5), contact.Isolated(datum=50.0), 1.0, tol=1e-8, load=load
            )
            left, right = solution.zones
            assert solution.certificate.holds and left[1] < 0.0 < right[0]
            gaps.append(right[0] - left[1])
            x = np.concatenate(
                [zone[0] + (zone[1] - zone[0]) * np.array([0.1, 0.6]) for zone in solution.zones]
            )
            flat = solution.displacement(x) + RoundTips(unequal=1.5).height(x)
            assert np.ptp(flat) < 1e-12 * load and gaps == sorted(gaps, reverse=True)
        assert gaps[-1] < 1e-6
