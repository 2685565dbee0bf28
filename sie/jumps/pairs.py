"""Jumps of very many zones with few of them each: all pairs of points and jumps at once, by the closed forms of `formulas`.

Zone by zone, a dozen operations on a dozen numbers take their time from being called, and there are thousands of zones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.polynomial import polyval

from sie.basis.arrays import Array, Index, Mask
from sie.basis.kept import Kept
from sie.basis.places import numbered
from sie.basis.record import record
from sie.jumps.formulas import Jumps

# Jumps of a zone at the most: of more the series of all of them is shorter beside the zone.
MOST = 9
# From so many zones on that have few jumps.
_LEAST = 32
# Seen from farther than this rho, closed forms cancel, and so many terms of the series are enough.
FAR, TERMS = 0.25, 32
# Pairs handled at once: they stay in the cache.
_PAIRS = 1 << 15


def far_transform(c: Array, rho: Array) -> Array:
    """sum_l c_l rho^l / R, c_l a number or one for each point."""
    return polyval(rho, c, tensor=False) * (2 * rho / (1 - rho * rho))


def far_potential(c: Array, rho: Array) -> Array:
    """-c_0 log(2 |rho|) - sum_l c_l rho^l / l."""
    return np.asarray(-c[0] * np.log(2 * np.abs(rho)) - rho * polyval(rho, (c[1:].T / np.arange(1, len(c))).T, tensor=False))


@record
class FewJumps(Kept):
    """jumps, zone after zone: count and first of each zone's (Z,), 0 of zones that are not among them; series: coefficients of each zone's
    parts (Z, TERMS)."""

    jumps: Jumps
    count: Index
    first: Index
    series: Array

    @classmethod
    def of(cls, jumps: Jumps, others: Sequence[int] | Index) -> FewJumps:
        """Those of jumps in zones that are none of the others and have few of them."""
        count = np.bincount(jumps.zone, minlength=1).astype(np.intp)
        count[(count > MOST) | np.isin(np.arange(len(count)), others)] = 0
        if np.count_nonzero(count) < _LEAST:
            count[:] = 0
        k = np.flatnonzero(count[jumps.zone] > 0)
        few = jumps.chosen(k[np.argsort(jumps.zone[k], kind="stable")])
        return cls(few, count, np.cumsum(count) - count, few.coefficients(np.arange(len(k)), few.zone, len(count), TERMS))

    def holds(self, zone: Index) -> Mask:
        """Whether the jumps of these zones are here, and there are any."""
        return np.asarray((zone < len(self.count)) & (self.count[np.minimum(zone, len(self.count) - 1)] > 0))

    def _summed(self, zone: Index, of: Callable[[Index, Index], Array]) -> Array:
        """Sums over the jumps of points' zones; of: what is summed, over h / pi, by points and jumps, pair by pair."""
        count, weight = self.count[zone], self.jumps.height / np.pi
        total, out, begin = np.cumsum(count), np.empty(len(zone)), 0
        while begin < len(zone):
            done = int(total[begin - 1]) if begin else 0
            end = max(begin + 1, int(np.searchsorted(total, done + _PAIRS)))
            here = count[begin:end]
            row = np.repeat(np.arange(end - begin), here)
            jump = numbered(here) + np.repeat(self.first[zone[begin:end]], here)
            out[begin:end] = np.bincount(row, of(begin + row, jump) * weight[jump], end - begin)
            begin = end
        return out

    def smooth_part(self, zone: Index, left: Array) -> Array:
        """What to add to g at points of zones to make it smooth."""
        return -self._summed(zone, lambda at, k: self.jumps.on_zone(k, left[at]))

    def density(self, zone: Index, left: Array, right: Array) -> Array:
        """The parts of zones themselves, at points by their distances from both ends."""
        return self._summed(zone, lambda at, k: self.jumps.of_density(k, left[at], right[at]))

    def transform(self, zone: Index, z: Array, rho: Array) -> Array:
        """Transform of the parts of zones at points off them."""
        out, far = np.empty(len(z)), np.abs(rho) < FAR
        out[far] = far_transform(self.series[zone[far]].T, rho[far])
        near = np.flatnonzero(~far)
        out[near] = self._summed(zone[near], lambda at, k: self.jumps.off_zone(k, z[near[at]], rho[near[at]]))
        return out

    def potential(self, zone: Index, left: Array, right: Array, rho: Array) -> Array:
        """Potential of the parts of zones over their half widths w, less c_0 log(w), by distances from the ends of the zones over w, and
        rho off them."""
        out, on = np.empty(len(left)), (left >= 0) & (right >= 0)
        far = ~on & (np.abs(rho) < FAR)
        out[far] = far_potential(self.series[zone[far]].T, rho[far])
        inside, near = np.flatnonzero(on), np.flatnonzero(~on & ~far)
        out[inside] = self._summed(zone[inside], lambda at, k: self.jumps.potential_on(k, left[inside[at]], right[inside[at]]))
        out[near] = self._summed(zone[near], lambda at, k: self.jumps.potential_off(k, left[near[at]], right[near[at]], rho[near[at]]))
        return out
