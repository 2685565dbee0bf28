r"""Nearly full contact by its gaps: the unknown is the slope of the gap on the few places without
contact.

With s the slope of the gap (zero in contact), u' = s - f', and on a body of symbol L the pressure
is p = pbar + (E*/2) G u', G of symbol 1/L: on a half-plane H, the periodic Hilbert transform, else
H and a smooth part. With R = G f' (contact.formulation.relief), no pressure in the gaps means

    (1/pi) PV int_gaps s(xi) K(x - xi) dxi = R(x) - 2 pbar / E*     on the gaps,     int_gap s = 0 on each,

K the kernel of G: the same equation as that of the zones, with the roles of contact and gap
exchanged, bounded at free ends. Its unknowns are few where the contact is nearly full, however
narrow the gaps (theory: derived here from (5); see docs/theory).

Where f' jumps inside a gap so does s, by as much, and R has the logarithm of that
(sie.jumps.density): a valley with a kink. About such a valley alone, R = C + (J/pi) ln|2 sin(pi
y/l)|, J < 0, and C constant, the gap is |y| < w, w = (l/pi) exp(-pi (2 pbar/E* - C)/|J|): it never
closes, and is narrower than any number soon.
"""

from __future__ import annotations

import math
from dataclasses import field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.formulation import zone_loads
from contact.formulation.fields import EPS, OPTIONS, mean_shape, moved_ends
from contact.formulation.problem import Problem
from contact.formulation.relief import ScaledRelief
from contact.formulation.roots import maximum
from contact.formulation.tables import gaps_between
from sie import Array, Index, record


@record
class GapFields(sie.Kept):
    """Fields of a periodic contact from the slope of its gaps; scaled inside, SI in the public
    methods.

    mean: scaled mean pressure. relief: R over the unit slope, of scaled x. In pickles and copies
    the state with its matrices is left out, and what it tells beyond the density is worked out
    before.
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
        """Slope of the gap on the gaps."""
        return self.state.whole.density

    @property
    def solved_zones(self) -> sie.Zones:
        """The intervals of the unknown, scaled: the gaps."""
        return self.gap_slope.zones

    @property
    def period(self) -> float:
        return self.problem.repeat_length

    @cached_property
    def zones(self) -> Array:
        """Scaled contact zones, between the gaps."""
        gaps = self.gap_slope.zones
        return gaps_between(gaps.table, self.period)

    # Functions of scaled places.

    def formal_gap(self, x: Array) -> Array:
        """Scaled, whatever its sign: the integral of its slope."""
        return np.asarray(self.gap_slope.integral(x))

    def formal_pressure(self, x: Array) -> Array:
        """Scaled, whatever its sign: pbar - R + G s where there is contact, zero in the gaps."""
        inside = self.gap_slope.locate(x)[2]
        with np.errstate(invalid="ignore"):
            return np.where(inside, 0.0, self.bearing(x))

    def bearing(self, x: Array) -> Array:
        """pbar - R + G s wherever it is asked for."""
        return np.asarray(self.mean - self.relief(x) + self.gap_slope.transform(x))

    def pressure_in(self, zone: int | Index, left: Array, right: Array) -> Array:
        """Scaled pressure at distances over the half width from the ends of contact zones."""
        a, b = self.zones[zone].T
        half = 0.5 * (b - a)
        x = np.where(left <= right, a + half * left, b - half * right)
        # Next to an end the pressure goes with the root of the distance, of which x has lost
        # digits.
        nearer, kept = half * np.minimum(left, right), np.where(left <= right, x - a, b - x)
        return np.asarray(self.bearing(x) * np.sqrt(nearer / np.where(kept > 0, kept, np.inf)))

    # Functions of x [m].

    @property
    def zone_table(self) -> Array:
        """Ends of the zones [m] (n, 2)."""
        return np.asarray(self.problem.units.x(self.zones))

    @cached_property
    def spreading(self) -> Array:
        """How far the ends of the zones move outward as the load grows by a factor of e [m] (n, 2)."""
        return self._of_zones(moved_ends(self.state)) * self.problem.units.length

    def _of_zones(self, rates: Array) -> Array:
        """How far the ends of zones move (n, 2) as the load grows by a factor of e: a gap loses on
        its left what the zone before it gains on its right. rates: of the gaps' ends (2, n), a unit
        of mean pressure.
        """
        return -np.column_stack((rates[1], np.roll(rates[0], -1))) * self.mean

    def rates(self, x: Array) -> tuple[Array, Array]:
        """See `ZoneFields.rates`."""
        response = self.state.response(self.state.values(), OPTIONS.guess_tolerance)
        return self._of_zones(moved_ends(self.state, 0, response)), np.asarray(
            response.whole.integral(x) * self.mean
        )

    def pressure(self, x: ArrayLike) -> Array:
        return (
            self.formal_pressure(self.problem.units.scaled(np.asarray(x, dtype=float)))
            * self.problem.units.pressure
        )

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        value = self.pressure_in(zone, 1 + t, 1 - t)
        return np.where(np.abs(t) == 1, 0.0, value) * self.problem.units.pressure

    def gap(self, x: ArrayLike) -> Array:
        scaled = self.problem.units.scaled(np.asarray(x, dtype=float))
        return np.maximum(self.gap_slope.integral(scaled), 0.0) * self.problem.units.height

    def displacement(self, x: ArrayLike) -> Array:
        """u = approach - f + gap."""
        height = np.asarray(self.problem.profile.height(x)) - self.problem.lowest
        return np.asarray(self.approach - height + self.gap(x))

    @property
    def contact_fraction(self) -> float:
        gaps = self.gap_slope.zones
        return 1.0 - float((gaps.b - gaps.a).sum()) / self.period

    @cached_property
    def widening_rate(self) -> float:
        """d contact fraction / d load [m/N]: what the gaps lose."""
        return -float(moved_ends(self.state).sum()) / self.period**2 / self.problem.units.load

    @property
    def load(self) -> float:
        return self.mean * self.period * self.problem.units.load

    @cached_property
    def loads(self) -> Array:
        """Load of each contact zone [N/m]."""
        rise = np.diff(self.gap_slope.potential(self.zones), axis=1)[:, 0]
        return zone_loads.loads(self.mean, self.relief, self.zones, rise) * self.problem.units.load

    @cached_property
    def max_pressure(self) -> float:
        tips = self.relief.at[self.relief.heights > 0]
        if not np.all(self.gap_slope.locate(tips)[2]):
            return np.inf
        x, value = self.samples
        highest = maximum(self.formal_pressure, x, value=value)[1]
        if self.problem.algebraic is not None:
            # The tips of low powers: there the pressure has a cusp.
            highest = max(
                highest, float(self.formal_pressure(np.asarray(self.problem.algebraic.at)).max())
            )
        return highest * self.problem.units.pressure

    @cached_property
    def samples(self) -> tuple[Array, Array]:
        """(even places over the period from the first gap on, closer than the profile varies, the
        scaled pressure there).
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
        value[bears] = self.mean - relief[bears] + self.gap_slope.transform(x[bears])
        return x, value

    @cached_property
    def steepest(self) -> float:
        """Largest slope of the scaled pressure between samples, but for those beside the ends of
        zones, where it is a root that moves with the end, and those of tips, where it is infinite.
        """
        x, value = self.samples
        bears = value > 0
        inner = bears[:-3] & bears[1:-2] & bears[2:-1] & bears[3:]
        with np.errstate(invalid="ignore"):
            slopes = np.abs(np.diff(value) / np.diff(x))[1:-1]
        return float(slopes[inner & np.isfinite(slopes)].max(initial=0.0))

    @cached_property
    def unit_pressure(self) -> float:
        """What errors are referred to: the peak pressure, or the mean contact pressure where the
        peak is infinite [Pa].
        """
        if np.isfinite(self.max_pressure):
            return self.max_pressure
        return self.mean / self.contact_fraction * self.problem.units.pressure

    @cached_property
    def approach(self) -> float:
        """min f = 0, and u has the mean of the compression: the mean of f less the mean gap, and
        that [m].
        """
        return (
            mean_shape(self.problem) + self.problem.compression * self.mean
        ) * self.problem.units.height - self.mean_gap

    @property
    def levels(self) -> Array:
        """Scaled minus-approach of each zone: one number, by construction."""
        return np.full(len(self.zones), -self.approach / self.problem.units.height)

    @property
    def gap_rounding(self) -> float:
        """Scaled effect of rounding on the gap, an integral of its slope."""
        return 64 * EPS * float(self.gap_sizes.max())

    @property
    def gap_sizes(self) -> Array:
        """A bound of the scaled gap in each interval, by its half width and its series."""
        slope, gaps = self.gap_slope, self.gap_slope.zones
        jumps = np.bincount(slope.jumps.zone, np.abs(slope.jumps.height), len(gaps))
        return np.asarray(gaps.half * (np.abs(slope.coefficients).sum(axis=1) + jumps))

    @property
    def mean_gap(self) -> float:
        """The gap vanishes at the ends, so its integral is minus the moment of its slope [m]."""
        return -self.gap_slope.moment() / self.period * self.problem.units.height

    @cached_property
    def stiffness(self) -> float:
        """d load / d approach [N/m^2]: the gap's response to the mean pressure, ends held, and the
        compression's.
        """
        response = self.state.response(self.state.values())
        rate = (
            response.moment() / self.period + self.problem.compression
        ) * self.problem.units.height
        return self.period * self.problem.units.load / rate
