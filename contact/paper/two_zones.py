"""Pairs of parabolic asperities in a row of period L, with zones a <= |x| <= b: equations
(31)-(39).

The profile f = (x^2 - c^2)^2/8Rc^2 is (31) with its tips at height 0. The neighbouring pairs act by
the nominal pressure p outside a strip of width L around the pair, so that on the zones

    (35) h'(x) = x^3/2Rc^2 - x/2R + (4 p/pi E*) artanh(2x/L),
    (36) p(x) = (E* sqrt(Z)/pi) x PV int_a^b h'(xi) dxi/((xi^2 - x^2) sqrt(Z(xi))),
         Z = (b^2 - x^2)(x^2 - a^2),

with int_a^b h' dxi/sqrt(Z) = 0, the condition for a bounded pressure at the ends. Equation (36) is
corrected here: as printed it leaves out the second zone. There are three solutions.
`LocalizedPair` has the full artanh. `CubicPair` has the cubic approximation (37) of artanh, and the
relation between a and b that follows from it. `PrintedCubicPair` has the relation between a and b
as printed. The exact solution is `contact.exact.PeriodicBiquadratic`.
"""

from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import OutOfRange, SceneError
from contact.model.checks import one_of
from contact.reference.exact import IsolatedBiquadratic, PeriodicBiquadratic
from contact.reference.exact.localized import FIRST_ORDER, SELF_CONSISTENT
from contact.reference.exact.numerics import Array
from contact.reference.exact.pair import EvenPair, PairRow, pair_at_load, tips_slope

CENTRES = ("pair", "valley")


class TwoZones(PairRow):
    """Base class of three approximate solutions for two asperities in each period.

    It adds the isolated and the exact solution at the same load, for comparison.
    """

    @property
    def isolated(self) -> IsolatedBiquadratic:
        """The isolated pair of equations (32)-(33) under the same load.
        Its mean pressure is (39).
        """
        return IsolatedBiquadratic(self.radius, self.spacing, self.E_star, self.load)

    @property
    def exact(self) -> PeriodicBiquadratic:
        """The exact periodic solution at the same mean pressure."""
        return PeriodicBiquadratic(
            self.radius, self.spacing, self.period, self.E_star, self.mean_pressure
        )


@dataclass(frozen=True)
class LocalizedPair(TwoZones):
    """The solution of the paper's equation (35), in which artanh is not approximated.

    The pressure (36) is evaluated by a Chebyshev series in x^2.

    closure: the nominal pressure outside the strip. "self-consistent" is the given mean pressure,
    as in the paper. "first-order" is the load of the isolated pair whose zones have the same width,
    divided by L. centre: the strip is centred on the "pair" (as in the paper) or on the "valley" at
    L/2 between two pairs. The valley is the better choice if L < 4c, since the nearest asperities
    then belong to different pairs.
    """

    closure: str = SELF_CONSISTENT
    centre: str = "pair"

    def __post_init__(self) -> None:
        super().__post_init__()
        one_of("closure", self.closure, (FIRST_ORDER, SELF_CONSISTENT))
        one_of("centre", self.centre, CENTRES)
        if self.closure == FIRST_ORDER and self.centre != "pair":
            raise SceneError.of(
                "centre",
                self.centre,
                "'pair' if closure is 'first-order', which uses the isolated pair of the paper",
            )

    @cached_property
    def pair(self) -> EvenPair:
        """The pair as one zone in y = s^2, where s is the distance from the middle of the strip."""

        def ratio(y: Array, middle: float, half: float) -> Array:
            s = np.sqrt(y)
            x = s if self.centre == "pair" else s - 0.5 * self.period
            width = 2.0 * half / (sqrt(middle + half) + sqrt(max(middle - half, 0.0)))
            bend = (
                4.0 * self._nominal(width) / (pi * self.E_star) * np.arctanh(2.0 * s / self.period)
            )
            return np.asarray((tips_slope(x, self.radius, self.spacing) + bend) / s)

        return pair_at_load(ratio, self.load, self.E_star, 0.25 * self.period**2)

    def _nominal(self, width: float) -> float:
        """Nominal pressure outside the strip of one period, if each zone of the pair has this
        width.
        """
        if self.closure == SELF_CONSISTENT:
            return self.mean_pressure
        # The isolated pair has a^2 + b^2 = 2c^2 for its ends a and b. So the width b - a determines
        # `half` = (b^2 - a^2)/2.
        c = 0.5 * self.spacing
        half = 0.5 * width * sqrt(max(4.0 * c * c - width * width, 0.0))
        return pi * self.E_star * half * half / (8.0 * self.radius * c * c) / self.period

    @property
    def ends(self) -> tuple[float, float]:
        inner, outer = self.pair.ends
        return (
            (inner, outer)
            if self.centre == "pair"
            else (0.5 * self.period - outer, 0.5 * self.period - inner)
        )

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure p(x) [Pa] for |x| < L/2 (one period); 0 outside the contact zones."""
        r = np.abs(np.asarray(x, dtype=float))
        return super().pressure(r if self.centre == "pair" else 0.5 * self.period - r)


@dataclass(frozen=True)
class CubicPair(TwoZones):
    """The solution in which the paper's cubic (37) approximates artanh in equation (35).

    The ends of the zones follow from the cubic.

    h' = alpha x^3 - beta x,  alpha = 1/2Rc^2 + 32 p/3 pi E* L^3,  beta = 1/2R - 8 p/pi E* L,
    p(x) = (E* alpha/2) |x| sqrt(Z),  P = pi E* alpha (b^2 - a^2)^2/16,  (a^2 + b^2)/2 = beta/alpha.

    The cubic replaces artanh(z), z = 2x/L; at z = 0.94 it is 1.22 instead of 1.74.
    """

    @property
    def alpha(self) -> float:
        c = 0.5 * self.spacing
        bend = 32.0 * self.mean_pressure / (3.0 * pi * self.E_star * self.period**3)
        return 1.0 / (2.0 * self.radius * c * c) + bend

    @property
    def beta(self) -> float:
        return 1.0 / (2.0 * self.radius) - 8.0 * self.mean_pressure / (
            pi * self.E_star * self.period
        )

    @property
    def _middle(self) -> float:
        """(a^2 + b^2)/2, where a and b are the inner and the outer end of a zone."""
        return self.beta / self.alpha

    @property
    def _half(self) -> float:
        """(b^2 - a^2)/2 from the load, where a and b are the inner and the outer end of a zone."""
        return sqrt(4.0 * self.load / (pi * self.E_star * self.alpha))

    @property
    def ends(self) -> tuple[float, float]:
        middle, half = self._middle, self._half
        if half >= middle:
            raise OutOfRange(
                f"mean_pressure = {self.mean_pressure:.6g} Pa is out of range: "
                "the two zones have merged"
            )
        return sqrt(middle - half), sqrt(middle + half)

    @property
    def max_pressure(self) -> float:
        # With y = x^2, the square of the pressure is proportional to y (half^2 - (y - middle)^2).
        # This function is largest at 3 (y - middle) = -middle + sqrt(middle^2 + 3 half^2).
        middle, half = self._middle, self._half
        rise = half * half / (middle + sqrt(middle * middle + 3.0 * half * half))
        return (
            0.5 * self.E_star * self.alpha * sqrt((middle + rise) * (half - rise) * (half + rise))
        )

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure p(x) [Pa] for |x| < L/2 (one period); 0 outside the contact zones."""
        r = np.abs(np.asarray(x, dtype=float))
        a, b = self.ends
        root = np.sqrt(np.maximum((b - r) * (b + r) * (r - a) * (r + a), 0.0))
        return 0.5 * self.E_star * self.alpha * r * root


@dataclass(frozen=True)
class PrintedCubicPair(CubicPair):
    """The solution (38) as printed in the paper, where the zone ends satisfy a^2 + b^2 = 2c^2.

    These are the ends a and b of the isolated pair. The pressure (36) is not bounded at them.
    """

    @property
    def _middle(self) -> float:
        return 0.25 * self.spacing**2
