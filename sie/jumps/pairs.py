"""Jumps of very many zones with few of them each: all pairs of points and jumps at once, by the closed forms of `forcing`.

Zone by zone, a dozen operations on a dozen numbers take their time from being called, and there are thousands of zones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from sie.basis.arrays import Array, Index, Mask
from sie.basis.interval import LOG2, theta
from sie.basis.kept import Kept
from sie.basis.places import numbered

# Jumps of a zone at the most: of more the series of all of them is shorter beside the zone.
MOST = 9
# From so many zones on that have few jumps.
_LEAST = 32
# Seen from farther than this rho, closed forms cancel, and so many terms of the series are enough.
FAR, TERMS = 0.25, 32
# Pairs handled at once: they stay in the cache.
_PAIRS = 1 << 15
# Part of the distance over which one root outweighs the other: kappa is then taken from their ratio.
_FAR_APART = 0.5


def kappa(up: Array, vp: Array, away: Array) -> Array:
    """log(sin((theta + phi)/2) / |sin((theta - phi)/2)|) at points t = cos(theta), away = t - s, of jumps s = cos(phi), by the roots
    sin((theta +- phi)/2) = (up +- vp) / 2, whose product is (s - t)/2 without cancellation."""
    small, large = np.minimum(up, vp), np.maximum(up, vp)
    with np.errstate(divide="ignore", invalid="ignore"):
        # A jump beside an end, or a point, has little of it: then it is 2 artanh of the roots' ratio, to all digits.
        far = 2 * np.arctanh(np.minimum(small / large, _FAR_APART))
        return np.where(small < _FAR_APART * large, far, np.log((up + vp) ** 2 / (2 * np.abs(away))))


def far_transform(c: Array, rho: Array) -> Array:
    """sum_l c_l rho^l / R, c_l a number or one for each point."""
    total = np.zeros(len(rho))
    for one in c[::-1]:
        total = total * rho + one
    return total * (2 * rho / (1 - rho * rho))


def far_potential(c: Array, rho: Array) -> Array:
    """-c_0 log(2 |rho|) - sum_l c_l rho^l / l."""
    total = np.zeros(len(rho))
    for l in range(len(c) - 1, 0, -1):
        total = (total + c[l] / l) * rho
    return np.asarray(-c[0] * np.log(2 * np.abs(rho)) - total)


def potential_rest(q: int, s: Array, sine: Array, z: Any, grown: Any, root: Any) -> Any:
    """R_q of the potentials of jumps of order q (see `forcing`), at real or complex points."""
    if q == 0:
        return grown - LOG2 - 1
    if q == 1:
        return 0.5 * (root - s * grown) - z + s * (0.75 + 0.5 * LOG2)
    square = sine * sine
    rest = (grown * (0.5 + s * s) + root * (0.5 * z - 2 * s)) / 3 - z * (0.5 * z - 1.5 * s)
    return rest + (square / 9 - s * s / 2 - 1 / 12 - LOG2 * (square / 6 + s * s / 2))


@dataclass(frozen=True, eq=False)
class FewJumps(Kept):
    """Jumps zone after zone: count and first place of each zone's (Z,), 0 of zones that are not among them; then of every jump its
    distances from both ends, phi, pi - phi, sin(phi), h / pi, and the order; series: coefficients of each zone's parts (Z, TERMS).
    potentials: whether they have closed forms."""

    potentials: ClassVar[bool] = True

    count: Index
    first: Index
    left: Array
    right: Array
    phi: Array
    psi: Array
    sine: Array
    weight: Array
    order: Index
    series: Array

    @classmethod
    def none(cls) -> Self:
        nothing, nowhere = np.zeros(0), np.zeros(0, dtype=np.intp)
        return cls(nowhere, nowhere, nothing, nothing, nothing, nothing, nothing, nothing, nowhere, np.zeros((0, TERMS)))

    @classmethod
    def of(cls, zone: Index, others: Index, parts: tuple[Array, ...], order: Index, coefficients: Callable[..., Array]) -> Self:
        """Of jumps in these zones, none of them in the zones `others`; parts: left, right, phi, psi, sine, h / pi; coefficients(jumps,
        rows, number of rows, terms): of their series, added up in rows."""
        count = np.bincount(zone, minlength=1).astype(np.intp)
        count[(count > MOST) | np.isin(np.arange(len(count)), others)] = 0
        if np.count_nonzero(count) < _LEAST:
            return cls.none()
        k = np.flatnonzero(count[zone] > 0)
        k = k[np.argsort(zone[k], kind="stable")]
        series = coefficients(k, zone[k], len(count), TERMS)
        left, right, phi, psi, sine, weight = (part[k] for part in parts)
        return cls(count, np.cumsum(count) - count, left, right, phi, psi, sine, weight, order[k], series)

    def holds(self, zone: Index) -> Mask:
        """Whether the jumps of these zones are here, and there are any."""
        if len(self.count) == 0:
            return np.zeros(len(zone), dtype=bool)
        return np.asarray((zone < len(self.count)) & (self.count[np.minimum(zone, len(self.count) - 1)] > 0))

    def _blocks(self, zone: Index) -> list[tuple[slice, Index, Index]]:
        """(stretch of the points, pairs' points counted from its start, pairs' jumps)."""
        count = self.count[zone]
        total, out, begin = np.cumsum(count), [], 0
        while begin < len(zone):
            done = int(total[begin - 1]) if begin else 0
            end = max(begin + 1, int(np.searchsorted(total, done + _PAIRS)))
            here = count[begin:end]
            row = np.repeat(np.arange(end - begin), here)
            jump = numbered(here) + np.repeat(self.first[zone[begin:end]], here)
            out.append((slice(begin, end), row, jump))
            begin = end
        return out

    def _polynomial(self, k: Index, t: Array) -> Array:
        """P_q."""
        q, sine = self.order[k], self.sine[k]
        second = (t - 2 * (self.left[k] - 1)) * sine + np.sin(2 * self.phi[k]) / 4
        return np.where(q == 2, second, np.where(q == 1, sine, 0.0))

    def _power(self, away: Array, k: Index, more: int = 0) -> Array:
        """away^(q + more)."""
        q = self.order[k]
        out = np.where(q == 2, away * away, np.where(q == 1, away, 1.0))
        return out * away if more else out

    def smooth_part(self, zone: Index, left: Array) -> Array:
        """What to add to g at points of zones to make it smooth."""
        out = np.empty(len(left))
        for here, row, k in self._blocks(zone):
            at = left[here][row]
            away = at - self.left[k]
            value = (self._own(k, away) * self._power(away, k) + self._polynomial(k, at - 1)) * self.weight[k]
            out[here] = np.bincount(row, value, here.stop - here.start)
        return out

    def _own(self, k: Index, away: Array) -> Array:
        """What stands before (t - s)^q in `smooth_part`."""
        return np.where(away > 0, -self.psi[k], self.phi[k])

    def density(self, zone: Index, left: Array, right: Array) -> Array:
        """The parts of zones themselves, at points by their distances from both ends."""
        out = np.empty(len(left))
        for here, row, k in self._blocks(zone):
            away = left[here][row] - self.left[k]
            value = self._power(away, k) * self._shape(k, away, left[here][row], right[here][row])
            out[here] = np.bincount(row, np.where((away == 0) & (self.order[k] > 0), 0.0, value) * self.weight[k], here.stop - here.start)
        return out

    def _shape(self, k: Index, away: Array, left: Array, right: Array) -> Array:
        """kappa, see `ForcingJumps`."""
        return kappa(np.sqrt(right * self.left[k]), np.sqrt(left * self.right[k]), away)

    def transform(self, zone: Index, z: Array, rho: Array) -> Array:
        """Transform of the parts of zones at points off them."""
        out = np.empty(len(z))
        far = np.abs(rho) < FAR
        out[far] = far_transform(self.series[zone[far]].T, rho[far])
        near = np.flatnonzero(~far)
        z, rho, found = z[near], rho[near], np.empty(len(near))
        for here, row, k in self._blocks(zone[near]):
            at = z[here][row]
            value = self._power(at - (self.left[k] - 1), k) * self._angle(k, rho[here][row]) - self._polynomial(k, at)
            found[here] = np.bincount(row, value * self.weight[k], here.stop - here.start)
        out[near] = found
        return out

    def _angle(self, k: Index, rho: Array) -> Array:
        return np.asarray(2 * np.arctan2(rho * self.sine[k], 1 - rho * np.cos(self.phi[k])))

    def potential(self, zone: Index, left: Array, right: Array, rho: Array) -> Array:
        """Potential of the parts of zones over their half widths w, less c_0 log(w), by distances from the ends of the zones over w, and
        rho off them."""
        out = np.empty(len(left))
        on = (left >= 0) & (right >= 0)
        far = ~on & (np.abs(rho) < FAR)
        out[far] = far_potential(self.series[zone[far]].T, rho[far])
        near = np.flatnonzero(~far)
        left, right, rho, on = left[near], right[near], rho[near], on[near]
        beyond = np.where(on, 0.0, np.maximum(-left, -right))
        grown = 2 * np.arcsinh(np.sqrt(0.5 * beyond))
        root = np.where(left > 0, 1.0, -1.0) * np.sqrt(beyond * (beyond + 2))
        z, found = 0.5 * (left - right), np.empty(len(near))
        for here, row, k in self._blocks(zone[near]):
            away = left[here][row] - self.left[k]
            turn = np.where(away > 0, self.psi[k], -self.phi[k])
            off = np.flatnonzero(~on[here][row])
            turn[off] = self._angle(k[off], rho[here][row[off]])
            rest = self._rest(k, z[here][row], grown[here][row], root[here][row])
            value = self._power(away, k, 1) * turn / (self.order[k] + 1) + self.sine[k] * rest
            found[here] = np.bincount(row, value * self.weight[k], here.stop - here.start)
        out[near] = found
        return out

    def _rest(self, k: Index, z: Array, grown: Array, root: Array) -> Array:
        """R_q."""
        q, s, sine = self.order[k], self.left[k] - 1, self.sine[k]
        zeroth, first, second = (lambda q=q: potential_rest(q, s, sine, z, grown, root) for q in range(3))
        return second() if np.all(q == 2) else np.where(q == 2, second(), np.where(q == 1, first(), zeroth()))


class FewDensityJumps(FewJumps):
    """The same of jumps of the density's derivatives, by the closed forms of `density`; none of the density itself."""

    potentials = False

    def _polynomial(self, k: Index, t: Array) -> Array:
        q, s = self.order[k], self.left[k] - 1
        return np.where(q == 2, -(t - 2 * s) * s - np.cos(2 * self.phi[k]) / 4, -s)

    def _own(self, k: Index, away: Array) -> Array:
        size = 2 * np.abs(away)
        return -np.log(np.where(size > 0, size, 1.0))

    def _shape(self, k: Index, away: Array, left: Array, right: Array) -> Array:
        return np.where(away > 0, theta(left, right), -theta(right, left))

    def _angle(self, k: Index, rho: Array) -> Array:
        end = np.where(rho > 0, self.right[k], self.left[k])
        return np.asarray(np.log((1 - np.abs(rho)) ** 2 + 2 * np.abs(rho) * end))
