"""Fields of one symmetric zone: pressure and integrals by series, the rest by the package `sie`.

`sie` solves the equation on the known zone as soon as a displacement or a gap is asked for.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.closed.series import SAMPLES_PER_DEGREE, summed
from contact.closed.zone import ClosedZone
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields, mean_shape
from contact.formulation.full_contact import lowest
from contact.formulation.problem import Problem
from contact.formulation.roots import maximum
from contact.formulation.tolerances import TOLERANCES
from contact.formulation.units import Units
from contact.model.scene import Scene
from sie import Array, Index, nearest_image


class ClosedFields(ZoneFields):
    """Fields of a contact with one zone, from -half_width to half_width, at one load."""

    scene: Scene
    zone: ClosedZone

    def __init__(self, scene: Scene, zone: ClosedZone) -> None:
        self.__dict__.update(scene=scene, zone=zone, amplitude_rate=0.0)

    def end_remainders(self, table: Array, order: Index) -> Array | None:
        return None  # the ends are known to the digits of `zone_table` only

    def __getstate__(self) -> dict[str, Any]:
        return {"scene": self.scene, "zone": self.zone, "amplitude_rate": 0.0}

    # The following quantities need a numerical solution of the contact equation.

    @cached_property
    def problem(self) -> Problem:  # type: ignore[override]
        """The scene as a problem in scaled variables."""
        scene, profile = self.scene, self.scene.profile
        width = self.zone.half_width if profile.period is None else profile.period
        length = 2.0 ** round(math.log2(width))
        units = Units(0.0, length, self.load / (scene.E_star * length), scene.E_star)
        return Problem(
            profile, scene.interaction, scene.substrate, scene.law, units, lowest(profile)
        )

    @cached_property
    def state(self) -> sie.AnyState:  # type: ignore[override]
        """Numerical solution of the contact equation on the known zone, whose ends are fixed."""
        problem = self.problem
        zones = np.asarray(problem.units.scaled(self.zone_table))
        end = problem.end if self.zone.problem.corner is None else sie.SINGULAR
        equation = problem.equation(Load(self.load / problem.units.load))
        on = sie.Zones.of(zones, end, end, symmetric=True)
        return sie.solve_zones(equation, on, TOLERANCES.rounding)

    # The following quantities are computed from the Chebyshev series of the pressure.

    @cached_property
    def zone_table(self) -> Array:
        """The ends of the zone [m], as a (1, 2) array."""
        return np.array([[-self.zone.half_width, self.zone.half_width]])

    @property
    def spreading(self) -> Array:
        growth = float(self.zone.growth)
        return np.array([[growth, growth]])

    @property
    def _unit(self) -> float:
        """The unit of pressure E*/2 [Pa]."""
        return 0.5 * self.scene.E_star

    @cached_property
    def load(self) -> float:  # type: ignore[override]
        given = self.scene.given_load
        return self._unit * float(self.zone.totals) if given is None else given

    @cached_property
    def loads(self) -> Array:
        return np.array([self.load])

    @property
    def contact_fraction(self) -> float:
        assert self.scene.period is not None
        return float(self.zone.widths) / self.scene.period

    def _pressure(self, x: Array, from_left: Array, to_right: Array) -> Array:
        """Pressure [Pa] at positions x in the zone.
        from_left, to_right: distances of x from the left and from the right end of the zone.
        """
        zone, way, kink = self.zone, self.zone.problem.map, self.zone.problem.kink
        y, weight, half = way.y(x), way.weight(x), zone.half
        root = way.rise(-zone.half_width, from_left) * way.rise(x, to_right)
        root = np.sqrt(np.maximum(root, 0.0)) / half
        out = root * summed(zone.g, y / half)
        with np.errstate(divide="ignore"):
            if zone.punch:
                out = out + zone.punch / root
            out = weight * out
            if kink:
                out = out + kink / math.pi * self._arcosh(y / weight, root / weight)
        return np.asarray(self._unit * out)

    def _arcosh(self, tangent: Array, over: Array) -> Array:
        """Part of the pressure that a kink of the profile causes, without its constant factor.
        With a period L it is arcosh(tan A / tan u), with A = pi a/L and u = pi x/L; a is the half
        width. Without a period it is arcosh(a / x).

        tangent: tan u, or x without a period. over: sqrt(1 - (tan u / tan A)^2), or
        sqrt(1 - (x / a)^2) without a period; it has more digits next to the ends than the quotient.
        """
        half = self.zone.half
        if self.zone.problem.map.period is not None:
            half = half / math.sqrt((1.0 - half) * (1.0 + half))
        near_end = np.arctanh(np.minimum(over, 0.5))
        return np.where(over < 0.5, near_end, np.log((1.0 + over) * half / np.abs(tangent)))

    def pressure(self, x: ArrayLike) -> Array:
        with np.errstate(invalid="ignore"):
            x = nearest_image(np.asarray(x, dtype=float), 0.0, self.scene.period)
        end = self.zone.half_width
        inside = np.abs(x) <= end
        at = np.where(inside, np.abs(x), end)
        outside = np.where(np.isfinite(x), 0.0, np.nan)
        return np.where(inside, self._pressure(at, end + at, end - at), outside)

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        t, half = np.asarray(t, dtype=float), self.zone.half_width
        return self._pressure(half * t, half * (1.0 + t), half * (1.0 - t))

    @property
    def _is_singular(self) -> bool:
        return bool(self.zone.problem.kink or self.zone.punch)

    @cached_property
    def max_pressure(self) -> float:
        if self._is_singular:
            return math.inf
        highest = maximum(
            lambda angle: self.pressure_at(-1, np.cos(angle)),
            np.linspace(0.0, math.pi, SAMPLES_PER_DEGREE * self.zone.nodes + 1),
            levels=7,
        )[1]
        return float(highest)

    @property
    def pressure_bound(self) -> float:  # type: ignore[override]
        return math.inf if self._is_singular else self._unit * float(self.zone.sums[1])

    @property
    def _even_level(self) -> float:
        return float(self.zone.problem.even_level(self.zone.half, self.scene.operator.datum))

    @cached_property
    def approach(self) -> float | None:  # type: ignore[override]
        """The approach [m]: mean profile height on the zone plus compliance times load.
        It is None for an isolated contact without a datum.
        """
        if not self.scene.operator.has_approach:
            return None
        flat = self.zone.problem.corner is not None
        height = 0.0 if flat else float(self.zone.problem.mean_height(self.zone.half))
        return height - float(self.zone.totals) / math.pi * self._even_level

    @cached_property
    def stiffness(self) -> float | None:
        if not self.scene.operator.has_approach:
            return None
        level = self._even_level
        # Next to full contact, the compliance of a flat punch, and with it `level`, may round to
        # zero.
        return -math.pi * self._unit / level if level else math.inf

    @cached_property
    def mean_gap(self) -> float:
        if self.zone.problem.corner is not None:
            return math.inf
        assert self.approach is not None
        return mean_shape(self.problem) * self.problem.units.height - self.approach
