"""Gaps that passed the certificate, and what is stated of the error of the contact between them."""

from functools import cached_property

import numpy as np

from contact.formulation.fields import moved_ends
from contact.formulation.gaps import GapFields
from contact.verify.certificate import ROUNDING
from contact.verify.solved import Solved
from sie import Array, record, wrapped

# Pressures closer to a gap than this part of the period are as uncertain as the rounding of their own position makes them:
# what is stated is not about them.
_BESIDE = 1e-7

# Of a gap's width: where its ends are as uncertain, it is looked at whether they tell its place at all.
_UNCERTAIN = 1e-4

# The same for tips: over the half width, as for zones (`sie.Density.sensitivity`).
_BESIDE_TIPS = 0.01


@record
class FoundByGaps(Solved):
    """Gaps that passed. off: how far the mean pressure may be off where it was found from another control."""

    fields: GapFields

    @cached_property
    def error(self) -> float:
        """Estimated error of the pressure over its unit and of the zones' ends over their width.

        An end of a gap off by delta shifts the normalised positions in the zone beside it, by delta over its width; the
        pressure there by delta times its slope, beside a tip J / pi over the distance; and the pressure beside the gap, which is of the
        size of its slope on the length of its width, by delta over that width.
        """
        # The total of every gap is given: there are no slits.
        fields, state, gaps = self.fields, self.fields.state.whole, self.fields.density.zones
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
        zone = np.maximum(np.searchsorted(zones[:, 0], wrapped(at, zones[0, 0], fields.period), side="right") - 1, 0)
        count, largest = np.bincount(zone, minlength=len(zones)), np.zeros(len(zones))
        np.maximum.at(largest, zone, heights)
        nearest = np.minimum(_BESIDE_TIPS, 0.25 / np.maximum(count, 1)) * 0.5 * (zones[:, 1] - zones[:, 0])
        return np.asarray(largest / (np.pi * nearest))

    @property
    def widening(self) -> Array:
        """How far each end of the gaps (n, 2) moves by a unit of mean pressure."""
        return np.asarray(np.abs(moved_ends(self.fields.state)).T)
