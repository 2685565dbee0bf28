"""Fields, in SI units, of a contact under a cohesive law, from q: the pressure plus the tension."""

import math
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from contact.adhesion.cohesive_state import CohesiveState
from contact.adhesion.cohesive_zone import CohesiveCurve
from contact.adhesion.curve import State
from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.separated_fields import SeparatedFields, integral_on_zones, integral_outside
from contact.adhesion.uniform_tension import UniformTension
from contact.formulation.fields import ZoneFields, mean_shape
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from sie import Array, Complex, record


@record
class CohesiveFields(ZoneFields):
    """The fields of a contact with a tension around its zones.

    problem: the frictionless contact of the deformed profile (`TractionLoaded`), whose pressure is
    q; law_problem: the problem with the scene's law; rate: the derivative d load/d approach,
    scaled, None under tension everywhere.
    """

    law_problem: Problem | None = None
    rate: float | None = None

    @property
    def pulled(self) -> TractionLoaded:
        assert isinstance(self.problem, TractionLoaded)
        return self.problem

    @property
    def tension(self) -> UniformTension:
        return self.pulled.pulling

    @property
    def cohesive(self) -> Array:  # type: ignore[override]
        """The intervals (m, 2) [m] of tension, including the zones inside the intervals."""
        units, tension = self.problem.units, self.tension
        if tension.everywhere:
            first = float(self.density.zones.middle[0]) - 0.5 * tension.width
            return np.asarray(units.x(np.array([[first, first + tension.width]])))
        return np.asarray(units.x(tension.table))

    def standing_shape(self, x: Array) -> Array:
        # The gap is measured from the undeformed profile; the deformation by the tension is part of
        # the displacement.
        return self.pulled.own_shape(x)

    def _raised(self, x: Array, potential: Array) -> Array:
        return np.asarray(super()._raised(x, potential) + self.tension.height(x))

    @cached_property
    def stiffness(self) -> float | None:
        if self.tension.everywhere:
            return super().stiffness
        if self.approach is None or self.rate is None:
            return None
        units = self.problem.units
        return units.load / units.height * self.rate

    @property
    def mean_displacement(self) -> float:
        return (
            self.problem.compression
            * (self.density.total - self.tension.total)
            / self.problem.repeat_length
        )

    @cached_property
    def mean_gap(self) -> float:
        own = self.law_problem
        assert own is not None
        if own.corners != (-np.inf, np.inf):
            return np.inf
        return (mean_shape(own) + self.mean_displacement + self.level) * self.problem.units.height

    @property
    def load(self) -> float:
        return (self.density.total - self.tension.total) * self.problem.units.load

    @cached_property
    def loads(self) -> Array:
        """Loads [N/m] on the zones, without the tension that acts outside the zones."""
        zones = self.density.zones
        own = self.tension.stress * (zones.b - zones.a)
        for end, _ in self.tension.spreads:
            own[end] -= self.tension.stress * zones.half[end]
        return (self.density.totals - own) * self.problem.units.load

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        t, last = np.asarray(t, dtype=float), len(self.density.zones) - 1
        return super().pressure_at(zone, t) - self._law_tension * (
            1 - self.tension.lacks(zone % (last + 1), last, 1 + t, 1 - t)
        )

    @property
    def pressure_bound(self) -> float:
        """Upper bound of the pressure [Pa], from samples."""
        if self._is_infinite:
            return math.inf
        return float(self._sampled[0].max() * self.problem.units.pressure - self._law_tension)

    @cached_property
    def max_pressure(self) -> float:
        return float(super().max_pressure - self._law_tension)

    def pressure(self, x: ArrayLike) -> Array:
        scaled = self._scaled(x)
        q = self.density(scaled)
        return np.asarray(
            q * self.problem.units.pressure - self._law_tension * self.tension.share(scaled)
        )

    def pressure_transform(self, x: Array, y: Array) -> tuple[Complex, Complex]:
        units, (value, slope) = self.problem.units, super().pressure_transform(x, y)
        pull, bend = self.tension.in_plane(self._scaled(x) + 1j * (y / units.length))
        rate = units.pressure / units.length
        return value - pull * units.pressure, slope - bend * rate

    @property
    def _law_tension(self) -> float:
        """The tension [Pa] as given in the law, not rescaled."""
        assert self.law_problem is not None
        return self.law_problem.law.tension

    @cached_property
    def borne_beside(self) -> float:  # type: ignore[override]
        stress, zones = self.tension.stress, self.density.zones.table
        apart = integral_outside(
            lambda x: self.standing_shape(x) - self.scaled_gap(x), self.pulled, zones, self.spacing
        )
        return -stress * (
            apart
            + integral_on_zones(self.standing_shape, self.pulled, zones, self.spacing)
            - self._not_pulled
        )

    @property
    def _not_pulled(self) -> float:
        """Integral, over zones pinned at sharp corners, of the profile's height times 1 - eta.
        On these zones only the fraction eta of the tension acts.
        """
        out, breaks = 0.0, self.pulled.forcing.jumps.broken_at
        for end, zone in self.tension.spreads:
            places, weights = zone.lacking(end, int(np.ceil(4 * zone.half / self.spacing)), breaks)
            out += float(self.standing_shape(places) @ weights)
        return out

    @cached_property
    def opened(self) -> float:
        """Integral of the gap over the intervals of tension [m^2]."""
        units = self.problem.units
        return (
            integral_outside(self.scaled_gap, self.pulled, self.density.zones.table, self.spacing)
            * units.length
            * units.height
        )


def fields_of(curve: CohesiveCurve, here: State) -> CohesiveFields | SeparatedFields:
    """The fields at a state of the curve, with or without contact."""
    problem, everywhere = curve.problem, isinstance(here, CohesiveState) and here.everywhere
    if isinstance(here, CohesiveState) and here.q is not None:
        return CohesiveFields(here.q.problem, here.q.state, law_problem=problem)
    return SeparatedFields(
        problem,
        curve.everywhere if everywhere else TractionLoaded.of(problem, curve.stress, here.table),
        here.level,
    )


def scaled_second_variation(here: CohesiveState) -> Array:
    """Scaled second derivatives of the energy with respect to the free ends of tension.
    These are the ends of the intervals of tension that are not pinned at sharp corners.

    s_i is the outward displacement of end i. The entry for ends i and j is d^2 energy/ds_i ds_j
    times the square roots of the widths of their intervals, divided by twice the work of adhesion.
    """
    free = ~here.pinned
    root = np.sqrt(here.widths[free])
    return np.asarray(-0.5 * root[:, None] * here.rates[np.ix_(free, free)] * root)


@record
class CohesiveGapFields(GapFields):
    """Fields of nearly full contact under tension everywhere, with the gaps as unknowns.

    The pressure is that of a frictionless contact, minus the uniform tension `stress` (scaled).
    """

    stress: float = 0.0

    @property
    def opened(self) -> float:
        """Integral of the gap over the period [m^2]."""
        return self.mean_gap * self.period * self.problem.units.length

    @property
    def borne_beside(self) -> float:  # type: ignore[override]
        # In the energy, the integral over the zones is that of q = p + stress, so it leaves out the
        # tension. The tension is therefore integrated over the whole period here: -stress times the
        # integral of (height of the profile - gap).
        own = mean_shape(self.problem) - self.mean_gap / self.problem.units.height
        return -self.stress * self.period * own

    @property
    def _lower(self) -> float:
        return self.stress * self.problem.units.pressure

    @property
    def cohesive(self) -> Array:  # type: ignore[override]
        units, first = self.problem.units, float(self.gap_slope.zones.middle[0])
        return np.asarray(units.x(np.array([[first, first + self.period]])))

    @property
    def load(self) -> float:
        return super().load - self._lower * self.period * self.problem.units.length

    @cached_property
    def loads(self) -> Array:
        return (
            super().loads
            - self._lower * np.diff(self.zones, axis=1)[:, 0] * self.problem.units.length
        )

    def pressure(self, x: ArrayLike) -> Array:
        return super().pressure(x) - self._lower

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        return super().pressure_at(zone, t) - self._lower

    def pressure_transform(self, x: Array, y: Array) -> tuple[Complex, Complex]:
        value, slope = super().pressure_transform(x, y)
        return value + 1j * self._lower, slope

    @cached_property
    def max_pressure(self) -> float:
        return float(super().max_pressure - self._lower)
