r"""`GapFields`: nearly full contact, with the slope of the gap on the gaps as the unknown.

Let s be the slope of the gap (zero in contact), so that the displacement has the slope u' = s - f'.
On a body of symbol L the pressure is p = pbar + (E*/2) G u', with the operator G of symbol 1/L. On
a half-plane G is the periodic Hilbert transform H; on other bodies it is H plus a smooth part. With
R = G f' (contact.formulation.relief), zero pressure in the gaps means

    (1/pi) PV int_gaps s(xi) K(x - xi) dxi = R(x) - 2 pbar / E*     on the gaps,
    int_gap s = 0                                                   on each of them,

with K the kernel of G. This is the equation of the zones with contact and gap exchanged; s vanishes
at free ends. In nearly full contact the unknowns are few, however narrow the gaps are (derived from
equation (5); see docs/theory).

Where f' jumps inside a gap, at a concave kink, s jumps as much, and R has a logarithm there
(sie.jumps.density). With a jump J < 0 of f', the period l and the distance y from the kink, R is
C + (J/pi) ln|2 sin(pi y/l)| around a single kink. If C is constant, the gap is |y| < w = (l/pi)
exp(-pi (2 pbar/E* - C)/|J|): no load closes it, and a moderate load makes it narrower than the
smallest floating-point number.
"""

from __future__ import annotations

import math
from dataclasses import field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.extras import require
from contact.formulation import zone_loads
from contact.formulation.fields import OPTIONS, NoPlateaus, mean_shape, moved_ends
from contact.formulation.problem import Problem
from contact.formulation.relief import ScaledRelief
from contact.formulation.roots import maximum
from contact.formulation.tables import gaps_between
from contact.formulation.tolerances import allowed_overlap
from sie import Array, Complex, Index, record


@record
class GapFields(NoPlateaus, sie.Kept):
    """Fields of a periodic contact whose unknown is the slope of the gap on the gaps.

    mean: scaled mean pressure. relief: the relief R (head of this file) divided by the unit of
    slope, as a function of scaled x. Pickles and copies leave out `state` with its matrices;
    members that depend on `state` are computed before.
    """

    problem: Problem
    state: sie.AnyState = field(repr=False)
    mean: float
    relief: ScaledRelief
    pressure_bound = math.inf
    cohesive = np.zeros((0, 2))
    borne_beside = 0.0
    tilt = moment = rotational_stiffness = None

    def end_remainders(self, table: Array, order: Index) -> Array | None:
        return None

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in super().__getstate__().items() if name != "state"}
        return kept | {"gap_slope": self.gap_slope, "stiffness": self.stiffness}

    @cached_property
    def gap_slope(self) -> sie.Density:
        """The slope of the gap, as a density on the gaps."""
        return self.state.whole.density

    @property
    def solved_zones(self) -> sie.Zones:
        """The scaled gaps, on which the slope of the gap is the unknown."""
        return self.gap_slope.zones

    @property
    def period(self) -> float:
        return self.problem.repeat_length

    @cached_property
    def zones(self) -> Array:
        """Ends of the zones between the gaps, scaled (n, 2)."""
        gaps = self.gap_slope.zones
        return gaps_between(gaps.table, self.period)

    def formal_gap(self, x: Array) -> Array:
        """Scaled gap by its formula, the integral of the gap's slope; it may be negative."""
        return np.asarray(self.gap_slope.integral(x))

    def formal_pressure(self, x: Array) -> Array:
        """Scaled pressure: zero in the gaps; in contact by its formula, which may be negative."""
        inside = self.gap_slope.locate(x)[2]
        with np.errstate(invalid="ignore"):
            return np.where(inside, 0.0, self.bearing(x))

    def bearing(self, x: Array) -> Array:
        """Scaled pressure by its formula at all scaled places; about zero in the gaps.

        It is pbar - R + G s. Here pbar is the mean pressure, R the relief, and G s the transform of
        the slope s of the gap.
        """
        return np.asarray(self.mean - self.relief(x) + self._by_gaps(self.gap_slope.transform(x)))

    def _by_gaps(self, value: Array) -> Array:
        """Scaled pressure that the gaps add, from `value`, the transform of the gap's slope."""
        kappa = self.problem.kappa
        return value / (1 + kappa**2) if kappa else value

    def pressure_in(self, zone: int | Index, left: Array, right: Array) -> Array:
        """Scaled pressure in zones at places given by their distances from both ends.

        left, right: the distances, divided by the half width of the zone.
        """
        a, b = self.zones[zone].T
        half = 0.5 * (b - a)
        x = np.where(left <= right, a + half * left, b - half * right)
        # Near an end, the pressure is proportional to the square root of the distance from the end.
        # The rounded x has the distance `kept`, and the exact distance is `nearer`. The square root
        # of `ratio` corrects the pressure at x.
        nearer, kept = half * np.minimum(left, right), np.where(left <= right, x - a, b - x)
        ratio = nearer / np.where(kept > 0, kept, np.inf)
        if not self.problem.kappa:
            return np.asarray(self.bearing(x) * np.sqrt(ratio))
        # With kappa (bodies that slide and differ elastically), the pressure has different
        # exponents at the two ends of a zone. The left end of a zone is the right end of a gap.
        at_right, at_left = 1 - self.gap_slope.zones.weight.exponent[:, 0]
        return np.asarray(self.bearing(x) * ratio ** np.where(left <= right, at_left, at_right))

    def bounded_weight(self, left: Array, right: Array) -> Array:
        """Factor of the pressure that vanishes at both ends of a zone: sqrt(1 - t^2), |t| <= 1.
        With kappa (bodies that slide and differ elastically), the exponents are not 1/2.
        """
        if not self.problem.kappa:
            return np.asarray(np.sqrt(left * right))
        at_right, at_left = 1 - self.gap_slope.zones.weight.exponent[:, 0]
        return np.asarray(left**at_left * right**at_right)

    @property
    def zone_table(self) -> Array:
        """Ends of the zones [m] (n, 2)."""
        return np.asarray(self.problem.units.x(self.zones))

    @cached_property
    def spreading(self) -> Array:
        """Derivatives of the ends of the zones by ln(load), outward positive [m] (n, 2)."""
        return self._of_zones(moved_ends(self.state)) * self.problem.units.length

    def _of_zones(self, rates: Array) -> Array:
        """Derivatives of zone ends by ln(load), outward (n, 2), from derivatives of the gap ends.

        rates: derivatives of the gap ends by the mean pressure, outward (2, n). The left end of a
        gap is the right end of the zone before it.
        """
        return -np.column_stack((rates[1], np.roll(rates[0], -1))) * self.mean

    def rates(self, x: Array, tolerance: float = OPTIONS.guess_tolerance) -> tuple[Array, Array]:
        """Scaled derivatives by ln(load): of the zones' ends, outward (n, 2), and of the gap at x.

        tolerance: tolerance of the iteration for the response to the load, if one is needed. The
        default is sufficient for a first guess.
        """
        response = self.state.response(self.state.values(), tolerance)
        return self._of_zones(moved_ends(self.state, 0, response)), np.asarray(
            response.whole.integral(x) * self.mean
        )

    def pressure_rates(self, x: Array, tolerance: float) -> Array:
        """Derivatives by ln(load) of the scaled pressure at scaled places in contact.

        tolerance: tolerance of the iteration for the response to the load, if one is needed.
        """
        response = self.state.response(self.state.values(), tolerance)
        return np.asarray(self.mean * (1.0 + self._by_gaps(response.whole.transform(x))))

    @property
    def spacing(self) -> float:
        """Smallest scaled length over which the profile varies."""
        return self.relief.spacing

    def pressure(self, x: ArrayLike) -> Array:
        return (
            self.formal_pressure(self.problem.units.scaled(np.asarray(x, dtype=float)))
            * self.problem.units.pressure
        )

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        value = self.pressure_in(zone, 1 + t, 1 - t)
        return np.where(np.abs(t) == 1, 0.0, value) * self.problem.units.pressure

    def pressure_transform(self, x: Array, y: Array) -> tuple[Complex, Complex]:
        # On the surface, the pressure is the real part of mean - skew (R - S). R is the transform
        # of the profile's slope, and S the transform of the gap's slope.
        units = self.problem.units
        relief, bend = self._slope_inside(x, y)
        z = units.scaled(x) + 1j * (y / units.length)
        opened, opens = self.gap_slope.transform_with_slope(z)
        skew = self.problem.skew
        value = self.mean - skew * (relief / units.slope - opened)
        slope = -skew * (bend / units.slope - opens / units.length)
        return -1j * units.pressure * value, -1j * units.pressure * slope

    @cached_property
    def _slope_inside(self) -> Any:
        """The transform of the profile's slope in the half plane (`ContinuedSlope`)."""
        return require("contact.formulation.continued").ContinuedSlope(self.problem.profile)

    @property
    def deep_pressure(self) -> float:
        return self.load / (self.period * self.problem.units.length)

    def gap(self, x: ArrayLike) -> Array:
        scaled = self.problem.units.scaled(np.asarray(x, dtype=float))
        return np.maximum(self.gap_slope.integral(scaled), 0.0) * self.problem.units.height

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement into the body [m], which is approach - profile + gap."""
        height = np.asarray(self.problem.profile.height(x)) - self.problem.lowest
        return np.asarray(self.approach - height + self.gap(x))

    @property
    def contact_fraction(self) -> float:
        gaps = self.gap_slope.zones
        return 1.0 - float((gaps.b - gaps.a).sum()) / self.period

    @cached_property
    def widening_rate(self) -> float:
        """Derivative of the contact fraction by the load [m/N]: the rate at which gaps shrink."""
        return -float(moved_ends(self.state).sum()) / self.period**2 / self.problem.units.load

    @property
    def load(self) -> float:
        return self.mean * self.period * self.problem.units.load

    @cached_property
    def loads(self) -> Array:
        """Load of each zone [N/m]."""
        rise = np.diff(self._by_gaps(self.gap_slope.potential(self.zones)), axis=1)[:, 0]
        return zone_loads.loads(self.mean, self.relief, self.zones, rise) * self.problem.units.load

    @cached_property
    def max_pressure(self) -> float:
        tips = self.relief.at[self.relief.heights > 0]
        if not np.all(self.gap_slope.locate(tips)[2]):
            return np.inf
        x, value = self.samples
        highest = maximum(self.formal_pressure, x, value=value)[1]
        if self.problem.algebraic is not None:
            # At the tip of a power law, the pressure has a cusp. Samples may miss it.
            highest = max(
                highest, float(self.formal_pressure(np.asarray(self.problem.algebraic.at)).max())
            )
        return highest * self.problem.units.pressure

    @cached_property
    def samples(self) -> tuple[Array, Array]:
        """Evenly spaced places over a period starting at the first gap, and the pressure there.

        The spacing of the places is smaller than the length on which the profile varies.
        """
        x, relief = self.relief.samples
        start = self.gap_slope.zones.a[0]
        turns = np.ceil((start - x) / self.period)
        first = int(np.argmin(x + turns * self.period))
        x, relief = (
            np.concatenate((part[first:], part[:first]))
            for part in (x + turns * self.period, relief)
        )
        bears, value = ~self.gap_slope.locate(x)[2], np.zeros(len(x))
        value[bears] = self.mean - relief[bears] + self._by_gaps(self.gap_slope.transform(x[bears]))
        return x, value

    @cached_property
    def steepest(self) -> float:
        """Largest slope of the scaled pressure between samples inside zones.

        Samples next to ends are left out: there the pressure is proportional to the square root of
        the distance from the end, so that its slope is unbounded. Next to tips the slope is
        infinite, so the samples there are left out as well.
        """
        x, value = self.samples
        bears = value > 0
        inner = bears[:-3] & bears[1:-2] & bears[2:-1] & bears[3:]
        with np.errstate(invalid="ignore"):
            slopes = np.abs(np.diff(value) / np.diff(x))[1:-1]
        return float(slopes[inner & np.isfinite(slopes)].max(initial=0.0))

    @cached_property
    def unit_pressure(self) -> float:
        """The pressure [Pa] relative to which errors are stated: the largest pressure if finite.

        If the largest pressure is infinite, it is the mean pressure over the contact.
        """
        if np.isfinite(self.max_pressure):
            return self.max_pressure
        return self.mean / self.contact_fraction * self.problem.units.pressure

    @cached_property
    def approach(self) -> float:
        """Approach [m]: mean height above the lowest place, minus mean gap, plus compression."""
        return (
            mean_shape(self.problem) + self.problem.compression * self.mean
        ) * self.problem.units.height - self.mean_gap

    @property
    def levels(self) -> Array:
        """Scaled level (minus the approach) of each zone; all are equal by construction."""
        return np.full(len(self.zones), -self.approach / self.problem.units.height)

    @property
    def gap_rounding(self) -> float:
        """Scaled error of the gap due to round-off; the gap is an integral of its slope."""
        return allowed_overlap(series=float(self.gap_sizes.max()))

    @property
    def gap_sizes(self) -> Array:
        """Upper bound of each scaled gap: half its width times a bound of the slope of the gap."""
        slope, gaps = self.gap_slope, self.gap_slope.zones
        jumps = np.bincount(slope.jumps.zone, np.abs(slope.jumps.height), len(gaps))
        return np.asarray(gaps.half * (np.abs(slope.coefficients).sum(axis=1) + jumps))

    @property
    def mean_gap(self) -> float:
        """Mean gap [m]: minus the moment of the gap's slope, divided by the period.

        This follows by integration by parts.
        """
        return -self.gap_slope.moment() / self.period * self.problem.units.height

    @cached_property
    def stiffness(self) -> float:
        """Derivative of the load by the approach [N/m^2].

        It follows from the response of the gaps at fixed ends, and from the compression.
        """
        response = self.state.response(self.state.values())
        rate = (
            response.moment() / self.period + self.problem.compression
        ) * self.problem.units.height
        return self.period * self.problem.units.load / rate
