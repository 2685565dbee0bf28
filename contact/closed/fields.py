"""Fields of a contact that is one interval: the pressure and the numbers by its series, the rest by
the engine when it is asked for.
"""

from __future__ import annotations

import math
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.closed.ends import Ends, arcosh_over
from contact.closed.series import summed, table
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields, mean_shape
from contact.formulation.full_contact import lowest
from contact.formulation.problem import Problem
from contact.formulation.roots import maximum
from contact.formulation.units import Units
from contact.model.scene import Scene
from sie import Array, Index, nearest_image

# Angles at which the highest pressure is looked for.
_LOOKS = 64
# Nodes of Gauss and Legendre for the mean height of a zone with a kink.
_GAUSS = 64
# Places at which slopes are looked at for their size.
_SIZES = 32
_DECAY = 1e-13


class DirectFields(ZoneFields):
    """ends: of one load; the zones are -outer to -inner and inner to outer, or -outer to outer."""

    scene: Scene
    ends: Ends

    def __init__(self, scene: Scene, ends: Ends) -> None:
        self.__dict__.update(scene=scene, ends=ends, amplitude_rate=0.0)

    def end_remainders(self, table: Array, order: Index) -> Array | None:
        return None  # the ends have no more digits than their places

    def __getstate__(self) -> dict[str, Any]:
        return {"scene": self.scene, "ends": self.ends, "amplitude_rate": 0.0}

    # by the engine
    # ----------------------------------------------------------------------------------------------------
    @cached_property
    def problem(self) -> Problem:  # type: ignore[override]
        """The scene in scaled variables."""
        scene, profile = self.scene, self.scene.profile
        outer = self.ends.outer
        reach = 2 * outer if profile.period is None else 0.5 * profile.period
        slope = float(np.abs(profile.slope(reach * (np.arange(_SIZES) + 0.4142) / _SIZES)).max())
        length = 2.0 ** round(math.log2(outer if profile.period is None else profile.period))
        if self.ends.sheet.corner is not None:
            slope = self.load / (scene.E_star * length)
        units = Units(0.0, length, slope, scene.E_star)
        return Problem(
            profile, scene.interaction, scene.substrate, scene.law, units, lowest(profile)
        )

    @cached_property
    def state(self) -> sie.AnyState:  # type: ignore[override]
        """Solved on the zones as they are."""
        problem = self.problem
        zones = np.asarray(problem.units.scaled(self.zone_table))
        end = problem.end if self.ends.sheet.corner is None else sie.SINGULAR
        equation = problem.equation(Load(self.load / problem.units.load))
        return sie.solve_zones(equation, sie.Zones.of(zones, end, end, symmetric=True), _DECAY)

    # by the series
    # ----------------------------------------------------------------------------------------------------
    @cached_property
    def zone_table(self) -> Array:
        """Zones [m], (1, 2) or (2, 2)."""
        inner, outer = self.ends.inner, self.ends.outer
        return np.array([[-outer, -inner], [inner, outer]] if self._pair else [[inner, outer]])

    @property
    def spreading(self) -> Array:
        # Of the ends in y, by the rates of the load and, of a pair, of the mean of G, which stays
        # zero.
        outward, rate = self.ends.spreading, self.ends.rises
        inner, outer = (float(a / b) for a, b in zip(outward, rate, strict=True))
        return np.array([[outer, inner], [inner, outer]] if self._pair else [[inner, outer]])

    @property
    def _pair(self) -> bool:
        return self.ends.sheet.map.pair

    @property
    def _unit(self) -> float:
        """E*/2 [Pa]."""
        return 0.5 * self.scene.E_star

    @cached_property
    def load(self) -> float:  # type: ignore[override]
        given = self.scene.given_load
        return self._unit * float(self.ends.totals) if given is None else given

    @cached_property
    def loads(self) -> Array:
        count = len(self.zone_table)
        return np.full(count, self.load / count)

    @property
    def contact_fraction(self) -> float:
        assert self.scene.period is not None
        return float(np.diff(self.zone_table).sum()) / self.scene.period

    def _between(self, x: Array, from_inner: Array, to_outer: Array) -> Array:
        """Pressure [Pa] at places of the right zone, and their distances from its ends."""
        ends = self.ends
        way, kink, punch = ends.sheet.map, ends.sheet.kink, ends.punch
        middle, half = ends.middle, ends.half
        y = way.y(x)
        weight = way.weight(x)
        root = (
            np.sqrt(np.maximum(way.rise(ends.inner, from_inner) * way.rise(x, to_outer), 0.0))
            / half
        )
        out = root * summed(ends.g, ends.odd, (y - middle) / half)
        with np.errstate(divide="ignore"):
            if punch:
                out = out + punch / root
            out = weight * out
            if kink:
                out = out + kink / math.pi * arcosh_over(ends, y, root / weight, weight)
        return np.asarray(self._unit * out)

    def pressure(self, x: ArrayLike) -> Array:
        with np.errstate(invalid="ignore"):
            x = nearest_image(np.asarray(x, dtype=float), 0.0, self.scene.period)
        inner, outer = self.ends.inner, self.ends.outer
        place = np.abs(x)
        inside = (place <= outer) & (place >= inner)
        at = np.where(inside, place, outer)
        beside = np.where(np.isfinite(x), 0.0, np.nan)
        return np.where(inside, self._between(at, at - inner, outer - at), beside)

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        if self._pair and zone == 0:
            t = -t
        inner, outer = self.ends.inner, self.ends.outer
        half = 0.5 * (outer - inner)
        return self._between(0.5 * (inner + outer) + half * t, half * (1.0 + t), half * (1.0 - t))

    @cached_property
    def max_pressure(self) -> float:
        if self.ends.sheet.kink or self.ends.punch:
            return math.inf
        return maximum(
            lambda angle: self.pressure_at(-1, np.cos(angle)),
            np.linspace(0.0, math.pi, _LOOKS + 1),
            levels=7,
        )[1]

    @property
    def pressure_bound(self) -> float:  # type: ignore[override]
        return (
            math.inf
            if self.ends.sheet.kink or self.ends.punch
            else self._unit * float(self.ends.bound)
        )

    # Levels
    # -----------------------------------------------------------------------------------------------------------
    @property
    def _logarithm(self) -> float:
        """-d approach / d load at fixed ends, times pi E*/2: the potential of a unit of load that
        presses the zones evenly.
        """
        way, half = self.ends.sheet.map, self.ends.half
        if way.period is not None:
            return 0.5 * math.log(2.0 * half) if way.pair else math.log(half)
        datum = self.scene.operator.datum
        assert datum is not None
        return (0.5 if way.pair else 1.0) * math.log(0.5 * half) - math.log(datum)

    @cached_property
    def approach(self) -> float | None:  # type: ignore[override]
        """The mean height of the profile under the pressure of an even level, less what the load
        sinks under its own.
        """
        if not self.scene.operator.has_approach:
            return None
        return self._mean_height - float(self.ends.totals) / math.pi * self._logarithm

    @property
    def _mean_height(self) -> float:
        """Mean f - min f [m] over the angle on the interval."""
        ends, profile = self.ends, self.scene.profile
        if ends.sheet.corner is not None:
            return 0.0
        if self._pair:
            t = table(2 * int(ends.nodes), False).t
            weights = np.full(len(t), 1.0 / len(t))
        else:
            t, weights = _quarter()
        height = np.asarray(profile.height(ends.sheet.map.x(ends.middle + ends.half * t)))
        return float((height - lowest(profile)) @ weights)

    @cached_property
    def stiffness(self) -> float | None:
        return (
            None
            if not self.scene.operator.has_approach
            else -math.pi * self._unit / self._logarithm
        )

    @cached_property
    def mean_gap(self) -> float:
        if self.ends.sheet.corner is not None:
            return math.inf
        assert self.approach is not None
        return mean_shape(self.problem) * self.problem.units.height - self.approach


@lru_cache(maxsize=1)
def _quarter() -> tuple[Array, Array]:
    """Gauss and Legendre's places t = cos(angle) and weights for means over angles of a quarter
    turn.
    """
    s, weights = np.polynomial.legendre.leggauss(_GAUSS)
    return np.cos(0.25 * math.pi * (1.0 + s)), 0.5 * weights
