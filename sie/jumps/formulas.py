"""Jumps within zones: where they are, and the closed forms of each, at any points that broadcast with them; see `forcing`.

Of very many zones with few jumps each all pairs of points and jumps are taken at once: zone by zone, a dozen operations on a dozen
numbers take their time from being called, and there are thousands of zones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from sie.basis.data import Array, Index, Kept, Mask, numbered, record
from sie.basis.interval import LOG2, Outside, theta
from sie.basis.sums import PAIRS

HIGHEST = 2
# Of q over p; zero for p > q.
_BINOMIAL = np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 2.0, 1.0]])
# Part of the distance over which one root outweighs the other: kappa is then taken from their ratio.
_FAR_APART = 0.5


@record
class Jumps(Kept):
    """Jumps inside the zones: zone index, distances from the zone's ends over w, h = J w^q / q!, and q."""

    zone: Index
    left: Array
    right: Array
    height: Array
    order: Index

    def __len__(self) -> int:
        return len(self.zone)

    def chosen(self, which: Mask | Index) -> Self:
        """Those of the jumps alone."""
        zone, left, right = self.zone[which], self.left[which], self.right[which]
        return replace(self, zone=zone, left=left, right=right, height=self.height[which], order=self.order[which])

    @cached_property
    def phi(self) -> Array:
        """Angle of each jump, s = cos(phi)."""
        return theta(self.left, self.right)

    @cached_property
    def psi(self) -> Array:
        """pi - phi, to all its digits beside the left end."""
        return theta(self.right, self.left)

    @cached_property
    def sine(self) -> Array:
        """sin(phi), to all its digits beside either end."""
        return np.asarray(np.sin(np.minimum(self.phi, self.psi)))

    @cached_property
    def s(self) -> Array:
        return 0.5 * (self.left - self.right)

    # jumps k at points ------------------------------------------------------------------------------------------------
    def polynomial(self, k: Index, t: NDArray[Any]) -> NDArray[Any]:
        """P_q(t)."""
        sine, q, s = self.sine[k], self.order[k], self.s[k]
        second = (t - 2 * s) * sine + np.sin(2 * self.phi[k]) / 4
        return np.where(q == 0, 0.0, np.where(q == 1, sine, second))

    def turn(self, k: Index, away: Array) -> Array:
        """What stands before (t - s)^q, away = t - s, in what the kernel makes on the zone: its smooth part is taken out."""
        return np.where(away > 0, self.psi[k], -self.phi[k])

    def turn_off(self, k: Index, rho: Array) -> Array:
        """The same off the zone."""
        return np.asarray(2 * np.arctan2(rho * self.sine[k], 1 - rho * np.cos(self.phi[k])))

    def shape(self, k: Index, left: Array, right: Array) -> Array:
        """kappa, at points by their distances from the zone's ends over w."""
        return kappa(np.sqrt(right * self.left[k]), np.sqrt(left * self.right[k]), left - self.left[k])

    # what is made of them, over h / pi ----------------------------------------------------------------------------------
    def on_zone(self, k: Index, left: Array) -> Array:
        """What the kernel makes of them on the zone."""
        away = left - self.left[k]
        return self.turn(k, away) * power(away, self.order[k]) - self.polynomial(k, left - 1)

    def off_zone(self, k: Index, z: Array, rho: Array) -> Array:
        """And off it."""
        return power(z - self.s[k], self.order[k]) * self.turn_off(k, rho) - self.polynomial(k, z)

    def of_density(self, k: Index, left: Array, right: Array) -> Array:
        """They themselves."""
        away, q = left - self.left[k], self.order[k]
        with np.errstate(invalid="ignore"):
            return np.where((away == 0) & (q > 0), 0.0, power(away, q) * self.shape(k, left, right))

    def potential_on(self, k: Index, left: Array, right: Array) -> Array:
        """Their potentials on the zone over w, less c_0 log(w)."""
        away, nothing = left - self.left[k], np.zeros_like(left)
        return np.asarray(self.potential_of(k, away, 0.5 * (left - right), self.turn(k, away), nothing, nothing))

    def potential_off(self, k: Index, left: Array, right: Array, rho: Array) -> Array:
        """And off it."""
        seen = Outside(np.where(left > 0, 1.0, -1.0), np.maximum(-left, -right))
        return np.asarray(self.potential_of(k, left - self.left[k], 0.5 * (left - right), self.turn_off(k, rho), seen.log, seen.root))

    def potential_of(self, k: Index, away: Any, z: Any, turn: Any, grown: Any, root: Any) -> Any:
        """Closed potentials (see the head of `forcing`), z - s, F, A and B at hand, real or complex."""
        orders = self.order[k]
        if np.all(orders == orders[:1]):
            return self._potential(int(orders[0]), k, away, z, turn, grown, root) if len(k) else turn
        parts, out = np.broadcast_arrays(away, z, turn, grown, root), np.empty_like(turn)
        for q in np.unique(orders).tolist():
            of = np.flatnonzero(orders == q)
            out[..., of] = self._potential(q, k[of], *(part[..., of] for part in parts))
        return out

    def _potential(self, q: int, k: Index, away: Any, z: Any, turn: Any, grown: Any, root: Any) -> Any:
        """The same of jumps of order q."""
        s, sine = self.s[k], self.sine[k]
        if q == 0:
            rest = grown - LOG2 - 1
        elif q == 1:
            rest = 0.5 * (root - s * grown) - z + s * (0.75 + 0.5 * LOG2)
        else:
            square = sine * sine
            rest = (grown * (0.5 + s * s) + root * (0.5 * z - 2 * s)) / 3 - z * (0.5 * z - 1.5 * s)
            rest = rest + (square / 9 - s * s / 2 - 1 / 12 - LOG2 * (square / 6 + s * s / 2))
        return raised(away, q + 1) * turn / (q + 1) + sine * rest

    # their series -----------------------------------------------------------------------------------------------------
    def sine_weights(self, k: Index, j: Array) -> Array:
        """b_j of jumps k where their function is sum_j (2/j) b_j sin(j theta)."""
        from_left = (self.psi < self.phi)[k][:, None]
        sines = np.sin(j * np.minimum(self.phi, self.psi)[k][:, None])
        return np.asarray(np.where(from_left & (j % 2 == 0), -sines, sines))

    def coefficients(self, k: Index, row: Index, rows: int, count: int) -> Array:
        """Coefficients of jumps k, added up in rows (rows, count): (t - s)^q is expanded in powers of t, so that what is done with
        series is done once a row."""
        highest = int(self.order[k].max(initial=0))
        j = np.arange(1.0, count + highest + 2)
        powers = np.zeros((highest + 1, rows, len(j)))
        order = np.argsort(row, kind="stable")
        block = max(1, PAIRS // len(j))
        for begin in range(0, len(k), block):
            part = order[begin : begin + block]
            some, into = k[part], row[part]
            first = np.flatnonzero(np.diff(into, prepend=-1))
            sines = self.sine_weights(some, j) * (2 / (np.pi * j))
            q, s = self.order[some], self.s[some]
            for power in range(int(q.max()) + 1):
                weight = self.height[some] * _BINOMIAL[q, power] * (-s) ** np.maximum(q - power, 0)
                powers[power, into[first]] += np.add.reduceat(weight[:, None] * sines, first, axis=0)
        c = of_sines(powers[highest])
        for series in powers[:highest][::-1]:
            c = _times_t(c) + of_sines(series)
        return np.asarray(c[:, :count])


def kappa(up: Array, vp: Array, away: Array) -> Array:
    """log(sin((theta + phi)/2) / |sin((theta - phi)/2)|) at points t = cos(theta), away = t - s, of jumps s = cos(phi), by the roots
    sin((theta +- phi)/2) = (up +- vp) / 2, whose product is (s - t)/2 without cancellation."""
    small, large = np.minimum(up, vp), np.maximum(up, vp)
    with np.errstate(divide="ignore", invalid="ignore"):
        # A jump beside an end, or a point, has little of it: then it is 2 artanh of the roots' ratio, to all digits.
        far = 2 * np.arctanh(np.minimum(small / large, _FAR_APART))
        return np.where(small < _FAR_APART * large, far, np.log((up + vp) ** 2 / (2 * np.abs(away))))


def power(away: Array, order: Index) -> Array:
    """away^order, 0 to 2; general powers take ten times as long as squares, which knots of splines ask for alone."""
    return away * away if np.all(order == HIGHEST) else np.where(order == 0, 1.0, np.where(order == 1, away, away * away))


def raised(away: Any, q: int) -> Any:
    """away^q by products."""
    return math.prod([away] * (q - 1), start=away)


def of_sines(beta: Array) -> Array:
    """Coefficients of T_l / sqrt(1 - t^2), l = 0, 1, ..., from those of sin(j theta), j = 1, 2, ..., along the last axis."""
    c = 0.5 * beta
    c[..., 2:] -= 0.5 * beta[..., :-2]
    return np.asarray(c)


def _times_t(c: Array) -> Array:
    """Coefficients of t times sum c_l T_l, the last one lost."""
    out = np.zeros_like(c)
    out[:, 1:] += 0.5 * c[:, :-1]
    out[:, 1] += 0.5 * c[:, 0]
    out[:, :-1] += 0.5 * c[:, 1:]
    return out


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
