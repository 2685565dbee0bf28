r"""The profile that a constant tension on given intervals has deformed, and its frictionless
contact.

With p = q - s on the intervals I, contact within them included, the equation for q on the zones is
that of frictionless contact of the profile that the tension alone has deformed,

    (1/pi) PV int q K = f' + s T(x),

of height f + s V (contact.adhesion.uniform_tension), and q vanishes where a zone ends: the
logarithms of T lie at the ends of I, outside the zones.

Where a zone is held at a sharp corner its interval ends there, too, and p has no tension in it:
there p = q - s eta, eta falling from 1 at the zone's other end to 0 at the corner as the angle over
pi does. That is a tension whose end is spread over the zone (contact.adhesion.spread_end),
and q has roots alone at both ends.
"""

from __future__ import annotations

from dataclasses import field, replace
from functools import cached_property

import numpy as np

import sie
from contact.adhesion.spread_end import Spread
from contact.adhesion.uniform_tension import Tension
from contact.formulation.problem import Problem
from sie import Array, Index, record


@record
class Pulled(Problem):
    """The frictionless problem of the profile that the tension alone has deformed: its pressure is
    q.
    """

    tension: Tension | None = field(default=None)

    @classmethod
    def of(cls, problem: Problem, stress: float, table: Array, everywhere: bool = False) -> Pulled:
        """stress: scaled."""
        operator = problem.operator
        # Of a strip and its images, too, nothing is beyond poles.
        plain = operator.is_half_plane or problem.kernel.regular is None
        tension = Tension(
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

    def over(self, zones: Array) -> Pulled:
        """The same with the tension's ends spread over the first and the last zone where these are
        held at sharp corners.
        """
        tension, (lo, hi) = self.pulling, self.corners
        if len(tension.table) == 0 or len(zones) == 0 or not np.isfinite(lo):
            return self
        left = Spread(*zones[0].tolist()) if zones[0, 0] == tension.table[0, 0] == lo else None
        right = Spread(*zones[-1].tolist()) if zones[-1, 1] == tension.table[-1, 1] == hi else None
        return (
            self
            if tension.spread == (left, right)
            else replace(self, tension=replace(tension, spread=(left, right)))
        )

    def bearing(
        self, density: sie.AnyDensity, zone: Index | int, left: Array, right: Array
    ) -> Array:
        """p + s."""
        last, tension = len(density.zones) - 1, self.pulling
        return super().bearing(density, zone, left, right) + tension.stress * tension.lacks(
            zone, last, left, right
        )

    def borne(self, density: sie.AnyDensity) -> float:
        tension = self.pulling
        return density.total + tension.stress * sum(zone.half for _, zone in tension.spreads)

    @property
    def pulling(self) -> Tension:
        assert self.tension is not None
        return self.tension

    @cached_property
    def forcing(self) -> sie.Forcing:
        # Between zones the ends of the intervals lie. The profile was looked at under the bare law,
        # and what the tension adds is known.
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
        """f' without the tension's."""
        return super().slope(x)

    def own_shape(self, x: Array) -> Array:
        """F without the tension's."""
        return super().shape(x)
