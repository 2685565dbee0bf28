r"""The profile deformed by a uniform tension on given intervals, and its frictionless contact.

Let the pressure be p = q - s on the intervals I of the tension s, including the zones within them.
Then q solves the frictionless contact of the profile that the tension alone has deformed,

    (1/pi) PV int q K = f' + s T(x),

with the kernel K. Here T is the slope, and V the height, that a unit tension on I adds to the
profile f (contact.adhesion.uniform_tension). So the deformed profile has the height f + s V. T is
infinite only at the ends of I, which lie outside the zones, so that q vanishes at the ends of a
zone.

If a zone is pinned at a sharp corner, its interval of tension ends at this corner, too. In this
zone p = q - s eta, where eta falls from 1 at the other end of the zone to 0 at the corner, linearly
in the angle arccos(t) of the zone. This is a tension whose end is spread over the zone
(contact.adhesion.spread_end), and q has square roots at both ends of the zone.
"""

from __future__ import annotations

from dataclasses import field, replace
from functools import cached_property

import numpy as np

import sie
from contact.adhesion.spread_end import SpreadEnd
from contact.adhesion.uniform_tension import UniformTension
from contact.formulation.problem import Problem
from sie import Array, Index, record


@record
class TractionLoaded(Problem):
    """The frictionless contact problem of a profile that a uniform tension has deformed.
    Its pressure q is the true pressure plus the tension.
    """

    tension: UniformTension | None = field(default=None)

    @classmethod
    def of(
        cls, problem: Problem, stress: float, table: Array, everywhere: bool = False
    ) -> TractionLoaded:
        """The problem under a scaled tension on intervals, or everywhere on a period."""
        operator = problem.operator
        # The kernel of a half-plane, alone or with periodic images, has poles and no regular part.
        plain = operator.is_half_plane or problem.kernel.regular is None
        tension = UniformTension(
            stress, np.asarray(table), problem.kernel, plain, everywhere, problem.compression
        )
        law = problem.law.bare
        assert law is not None
        return cls(
            problem.profile,
            problem.interaction,
            problem.substrate,
            law,
            problem.units,
            problem.lowest,
            tension=tension,
        )

    def over(self, zones: Array) -> TractionLoaded:
        """This problem, with the tension spread over zones that are pinned at sharp corners.
        If the first or the last zone is pinned at a corner, the end of the tension there is not
        abrupt: the tension fades out over this zone.
        """
        tension, (lo, hi) = self.pulling, self.corners
        if len(tension.table) == 0 or len(zones) == 0 or not np.isfinite(lo):
            return self
        left = SpreadEnd(*zones[0].tolist()) if zones[0, 0] == tension.table[0, 0] == lo else None
        right = (
            SpreadEnd(*zones[-1].tolist()) if zones[-1, 1] == tension.table[-1, 1] == hi else None
        )
        return (
            self
            if tension.spread == (left, right)
            else replace(self, tension=replace(tension, spread=(left, right)))
        )

    def bearing(
        self, density: sie.AnyDensity, zone: Index | int, left: Array, right: Array
    ) -> Array:
        """Contact pressure p + s on the zones: the pressure p plus the full tension s."""
        last, tension = len(density.zones) - 1, self.pulling
        return super().bearing(density, zone, left, right) + tension.stress * tension.lacks(
            zone, last, left, right
        )

    def borne(self, density: sie.AnyDensity) -> float:
        tension = self.pulling
        return density.total + tension.stress * sum(zone.half for _, zone in tension.spreads)

    @property
    def pulling(self) -> UniformTension:
        assert self.tension is not None
        return self.tension

    @cached_property
    def forcing(self) -> sie.Forcing:
        # The slope of the deformed profile is singular at the ends of the intervals of tension
        # (`ends`), which lie outside the zones. `trusted` saves the checks that `sie` makes of
        # every new forcing (right side).
        bare, ends = super().forcing, self.pulling.table
        return replace(
            bare,
            jumps=replace(bare.jumps, spline=self.own_slope, singular_at=ends.ravel()),
            resolution=replace(bare.resolution, length=None),
        ).trusted()

    def slope(self, x: Array) -> Array:
        return super().slope(x) + self.pulling.slope(x)

    def shape(self, x: Array) -> Array:
        return super().shape(x) + self.pulling.height(x)

    def own_slope(self, x: Array) -> Array:
        """The slope of the undeformed profile."""
        return super().slope(x)

    def own_shape(self, x: Array) -> Array:
        """The height of the undeformed profile."""
        return super().shape(x)
