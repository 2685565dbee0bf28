r"""Nearly full contact by its gaps: the unknown is the slope of the gap on the few places without contact.

With s the slope of the gap (zero in contact), u' = s - f', and on a body of symbol L the pressure is p = pbar + (E*/2) G u', G of
symbol 1/L: on a half-plane H, the periodic Hilbert transform, else H and a smooth part. With R = G f' (contact.relief), no pressure in
the gaps means

    (1/pi) PV int_gaps s(xi) K(x - xi) dxi = R(x) - 2 pbar / E*     on the gaps,     int_gap s = 0 on each,

K the kernel of G: the same equation as that of the zones, with the roles of contact and gap exchanged, bounded at free ends. Its
unknowns are few where the contact is nearly full, however narrow the gaps (theory: derived here from (5); see docs/theory).

Where f' jumps inside a gap so does s, by as much, and R has the logarithm of that (sie.breaks): a valley with a kink.
About such a valley alone, R = C + (J/pi) ln|2 sin(pi y/l)|, J < 0, and C constant, the gap is |y| < w,
w = (l/pi) exp(-pi (2 pbar/E* - C)/|J|): it never closes, and is narrower than any number soon.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import sie
from contact import zone_loads
from contact.certificate import ROUNDING, Certificate
from contact.extrema import maximum
from contact.fields import mean_shape, moved_ends
from contact.problem import Problem
from contact.relief import ScaledRelief

Array = NDArray[np.float64]

# Pressures closer to a gap than this part of the period are as uncertain as the rounding of their own position makes them:
# what is stated is not about them.
_BESIDE = 1e-7

# Of a gap's width: where its ends are as uncertain, it is looked at whether they tell its place at all.
_UNCERTAIN = 1e-4

# The same for tips: over the half width, as for zones (`sie.Density.sensitivity`).
_BESIDE_TIPS = 0.01


@dataclass(frozen=True, eq=False)
class GapFields(sie.Kept):
    """Fields of a periodic contact from the slope of its gaps; scaled inside, SI in the public methods.

    mean: scaled mean pressure. relief: R over the unit slope, of scaled x. In pickles and copies the state with its matrices is
    left out, and what it tells beyond the density is worked out before.
    """

    problem: Problem
    state: sie.AnyState = field(repr=False)
    mean: float
    relief: ScaledRelief

    def __getstate__(self) -> dict[str, Any]:
        kept = {"problem": self.problem, "mean": self.mean, "relief": self.relief}
        return kept | {"density": self.density, "stiffness": self.stiffness}

    @cached_property
    def density(self) -> sie.Density:
        """Slope of the gap on the gaps."""
        assert isinstance(self.state.density, sie.Density)
        return self.state.density

    @property
    def period(self) -> float:
        assert self.problem.period is not None
        return self.problem.period

    @cached_property
    def zones(self) -> Array:
        """Scaled contact zones, between the gaps."""
        gaps = self.density.zones
        return np.column_stack((gaps.b, np.append(gaps.a[1:], gaps.a[0] + self.period)))

    # scaled -----------------------------------------------------------------------------------------------------------
    def scaled_pressure(self, x: Array) -> Array:
        """pbar - R + G s where there is contact, zero in the gaps."""
        inside = self.density.locate(x)[2]
        with np.errstate(invalid="ignore"):
            return np.where(inside, 0.0, self.bearing(x))

    def bearing(self, x: Array) -> Array:
        """pbar - R + G s wherever it is asked for."""
        return np.asarray(self.mean - self.relief(x) + self.density.transform(x))

    def pressure_in(self, zone: int | NDArray[np.intp], left: Array, right: Array) -> Array:
        """Scaled pressure at distances over the half width from the ends of contact zones."""
        a, b = self.zones[zone].T
        half = 0.5 * (b - a)
        x = np.where(left <= right, a + half * left, b - half * right)
        # Next to an end the pressure goes with the root of the distance, of which x has lost digits.
        nearer, kept = half * np.minimum(left, right), np.where(left <= right, x - a, b - x)
        return np.asarray(self.bearing(x) * np.sqrt(nearer / np.where(kept > 0, kept, np.inf)))

    # SI ---------------------------------------------------------------------------------------------------------------
    def pressure(self, x: ArrayLike) -> Array:
        return self.scaled_pressure(self.problem.units.scaled(np.asarray(x, dtype=float))) * self.problem.units.pressure

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        value = self.pressure_in(zone, 1 + t, 1 - t)
        return np.where(np.abs(t) == 1, 0.0, value) * self.problem.units.pressure

    def gap(self, x: ArrayLike) -> Array:
        scaled = self.problem.units.scaled(np.asarray(x, dtype=float))
        return np.maximum(self.density.integral(scaled), 0.0) * self.problem.units.height

    def displacement(self, x: ArrayLike) -> Array:
        """u = approach - f + gap."""
        height = np.asarray(self.problem.profile.height(x)) - self.problem.lowest
        return np.asarray(self.approach - height + self.gap(x))

    @property
    def starts(self) -> Array:
        return self.problem.units.x(self.zones[:, 0])

    @property
    def contact_fraction(self) -> float:
        gaps = self.density.zones
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
        rise = np.diff(self.density.potential(self.zones), axis=1)[:, 0]
        return zone_loads.loads(self.mean, self.relief, self.zones, rise) * self.problem.units.load

    @cached_property
    def max_pressure(self) -> float:
        tips = self.relief.at[self.relief.heights > 0]
        if not np.all(self.density.locate(tips)[2]):
            return np.inf
        x, value = self._samples
        return maximum(self.scaled_pressure, x, value=value)[1] * self.problem.units.pressure

    @cached_property
    def _samples(self) -> tuple[Array, Array]:
        """(places over the period, closer than the profile varies, the scaled pressure there)."""
        resolution = self.problem.profile.resolution or self.problem.units.length * self.period / 16
        n = int(np.clip(16 * self.period * self.problem.units.length / resolution, 256, 2**17))
        x = self.period * (np.arange(n + 1) / n) + self.density.zones.a[0]
        return x, self.scaled_pressure(x)

    @cached_property
    def steepest(self) -> float:
        """Largest slope of the scaled pressure between samples, but for those beside the ends of zones, where it is a root that moves
        with the end, and those of tips, where it is infinite."""
        x, value = self._samples
        bears = value > 0
        inner = bears[:-3] & bears[1:-2] & bears[2:-1] & bears[3:]
        with np.errstate(invalid="ignore"):
            slopes = np.abs(np.diff(value) / np.diff(x))[1:-1]
        return float(slopes[inner & np.isfinite(slopes)].max(initial=0.0))

    @cached_property
    def unit_pressure(self) -> float:
        """What errors are referred to: the peak pressure, or the mean contact pressure where the peak is infinite [Pa]."""
        if np.isfinite(self.max_pressure):
            return self.max_pressure
        return self.mean / self.contact_fraction * self.problem.units.pressure

    @cached_property
    def approach(self) -> float:
        """min f = 0 and mean u = 0: the mean of f less the mean gap [m]."""
        return mean_shape(self.problem) * self.problem.units.height - self.mean_gap

    @property
    def mean_gap(self) -> float:
        """The gap vanishes at the ends, so its integral is minus the moment of its slope [m]."""
        return -self.density.moment() / self.period * self.problem.units.height

    @cached_property
    def stiffness(self) -> float:
        """d load / d approach [N/m^2]: the gap's response to the mean pressure, ends held."""
        values = np.zeros(len(self.state.condition_scale))
        values[self.state.condition_index[0]] = 1.0
        response = self.state.response(values)
        rate = response.moment() / self.period * self.problem.units.height
        return self.period * self.problem.units.load / rate


@dataclass(frozen=True, eq=False)
class Gapped:
    """Gaps that passed: the Newton result, the fields, the certificate, and how far the mean pressure may be off where it
    was found from another control."""

    free: sie.Free
    fields: GapFields
    certificate: Certificate
    off: float = 0.0

    @cached_property
    def error(self) -> float:
        """Estimated error of the pressure over its unit and of the zones' ends over their width.

        An end of a gap off by delta shifts the normalised positions in the zone beside it, by delta over its width; the
        pressure there by delta times its slope, beside a tip J / pi over the distance; and the pressure beside the gap, which is of the
        size of its slope on the length of its width, by delta over that width.
        """
        fields, state, gaps = self.fields, self.fields.state, self.fields.density.zones
        assert isinstance(state, sie.State)  # the total of every gap is given: no holes
        units, profile = fields.problem.units, fields.problem.profile
        width = (gaps.b - gaps.a)[:, None]
        moved = self.free.end_error + state.end_truncation + self.off * self.widening / width
        shift = np.maximum(moved * width, self._adrift[:, None])
        # The zone before the first gap is the last.
        zones = fields.zones[:, 1] - fields.zones[:, 0]
        ends = float((shift / np.column_stack((np.roll(zones, 1), zones))).max())
        varies = (profile.resolution or units.length * fields.period) / units.length / (2 * np.pi)
        unit = fields.unit_pressure / units.pressure
        if not unit > 0.0:
            return np.inf  # zones so narrow that no sample lies in them
        slope = min(fields.steepest / unit, 1 / varies)
        # Away from a gap this falls as the square of width over distance.
        seen = np.minimum((gaps.b - gaps.a) / (_BESIDE * fields.period), 1.0) ** 2
        beside = float((moved.sum(axis=1) * state.zone_sizes * seen).max()) / unit
        # Beside a kink the logarithms that cancel are several times the pressure.
        rounding = (3 if len(fields.relief.at) else 1) * ROUNDING * (1 + abs(fields.mean) / unit) + fields.relief.rounding / unit
        on_zones = state.density_error * state.size / unit + rounding
        tips = float((np.maximum(shift[:, 1], np.roll(shift[:, 0], -1)) * self._steepest).max()) / unit
        return 2 * (ends + float(shift.max()) * slope + beside + tips) + on_zones

    @property
    def _adrift(self) -> Array:
        """How far each gap may be from its place where its ends do not tell: on a smooth top of R of curvature k it may be anywhere
        where R is within rounding r of the top, by sqrt(2 r / k). 0 for gaps wider than that, and for those over kinks."""
        fields, profile = self.fields, self.fields.problem.profile
        gaps, relief = fields.density.zones, fields.relief
        out = np.zeros(len(gaps))
        _, gap, inside = fields.density.locate(relief.at)
        narrow = np.flatnonzero(self.free.end_error.max(axis=1) > _UNCERTAIN)
        some = np.setdiff1d(narrow, gap[inside & (relief.heights < 0)])
        if len(some):
            step = (profile.resolution or fields.problem.units.length * fields.period) / fields.problem.units.length / 64
            middle = gaps.middle[some]
            top, beside = relief(middle), 0.5 * (relief(middle - step) + relief(middle + step))
            curvature = 2 * np.maximum(top - beside, 0.0) / step**2
            rounding = 8 * float(np.finfo(np.float64).eps) * (abs(fields.mean) + np.abs(top))
            reach = np.sqrt(2 * rounding / np.maximum(curvature, 2 * rounding / step**2))
            out[some] = np.where(reach > 0.5 * gaps.half[some], reach, 0.0)
        return out

    @property
    def _steepest(self) -> Array:
        """Slope of the pressure in each zone beside the largest of its tips, no nearer than stated (J / pi over the distance)."""
        fields = self.fields
        zones, convex = fields.zones, fields.relief.heights > 0
        at, heights = fields.relief.at[convex], fields.relief.heights[convex]
        at = at - np.floor((at - zones[0, 0]) / fields.period) * fields.period
        zone = np.maximum(np.searchsorted(zones[:, 0], at, side="right") - 1, 0)
        count, largest = np.bincount(zone, minlength=len(zones)), np.zeros(len(zones))
        np.maximum.at(largest, zone, heights)
        nearest = np.minimum(_BESIDE_TIPS, 0.25 / np.maximum(count, 1)) * 0.5 * (zones[:, 1] - zones[:, 0])
        return np.asarray(largest / (np.pi * nearest))

    @property
    def widening(self) -> Array:
        """How far each end of the gaps (n, 2) moves by a unit of mean pressure."""
        return np.asarray(np.abs(moved_ends(self.fields.state)).T)
