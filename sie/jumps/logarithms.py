"""Logarithmic terms of the right side, which jumps of the density cause.

For a jump J of the density at s the caller omits (J/pi) Lambda(x, s) from the values of the right
side, with Lambda the kernel's potential. This module adds the omitted term, computed from distances
that lose no digit even on very narrow zones.

A plateau is an interval beside a zone on which the density has a given value v. It is not a zone.
So without the plateaus, the density jumps by -v where a plateau begins and by v where it ends. The
terms of these two jumps are minus the transform of the plateau.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np

from sie.basis.data import Array, Index, Kept, nearest_image, record, wrapped
from sie.basis.interval import Complex, What, complex_of
from sie.basis.kernels import Kernel, is_hilbert
from sie.basis.potential_primitive import potential_primitive
from sie.basis.sums import OPTIONS as BLOCKS
from sie.basis.zones import End, Zones
from sie.jumps.exterior import ExteriorLogarithms
from sie.jumps.plateau_sums import PlateauSums
from sie.trees.cells import cells_around


@record
class Plateaus:
    """Intervals next to the zones; on each of them the density has a given constant value.

    table: the intervals (m, 2); values: the value on each (m,).
    """

    table: Array
    values: Array

    @classmethod
    def beside(cls, zones: Zones, period: float | None) -> Self:
        """The plateaus next to zones; ValueError if the two ends of a gap contradict each other."""
        found: list[tuple[float, float, float]] = []
        a, b = zones.a.tolist(), zones.b.tolist()
        lefts: list[tuple[End | None, float]] = [*zip(zones.left, a, strict=True)]
        rights: list[tuple[End | None, float]] = [*zip(zones.right, b, strict=True)]
        if period is None:
            lefts, rights = [*lefts, (None, math.inf)], [(None, -math.inf), *rights]
        else:
            first, begin = zones.left[0], a[0]
            if first.until is not None:
                first = replace(first, until=first.until + period)
            lefts = [*lefts[1:], (first, begin + period)]
        for i, (left, right) in enumerate(zip(rights, lefts, strict=True)):
            found.extend(_in_gap(i - (period is None), left, right))
        if period is not None and zones.left[0].until is not None:
            # The last plateau found ends at the image of the first zone. It is moved back by one
            # period, to the first zone itself.
            _, _, value = found.pop()
            found.insert(0, (zones.left[0].until, a[0], value))
        table = np.array(found).reshape(-1, 3)
        return cls(table[:, :2], table[:, 2])

    @property
    def total(self) -> float:
        """Integral of the density over all plateaus."""
        return float(self.values @ np.diff(self.table, axis=1)[:, 0])

    def integral(self, weight: Callable[[Array], Array]) -> float:
        """Integral of weight(x) times the density over all plateaus, by Gauss quadrature."""
        t, rule = np.polynomial.legendre.leggauss(BLOCKS.max_direct_terms)
        half, middle = 0.5 * np.diff(self.table, axis=1), self.table.mean(axis=1)[:, None]
        x = middle + half * t
        values = np.broadcast_to(np.asarray(weight(x.ravel()), dtype=float), (x.size,))
        return float(self.values @ (half * (values.reshape(x.shape) * rule)).sum(axis=1))

    def density(self, x: Array, period: float | None) -> Array:
        """The density on plateaus at points x (any shape), and 0 elsewhere."""
        out = np.zeros(x.shape)
        if len(self.table):
            place = wrapped(x, self.table[0, 0], period)
            i = np.maximum(np.searchsorted(self.table[:, 0], place, side="right") - 1, 0)
            inside = (place >= self.table[i, 0]) & (place <= self.table[i, 1])
            out[inside] = self.values[i[inside]]
        return out


def _in_gap(
    i: int, left: tuple[End | None, float], right: tuple[End | None, float]
) -> list[tuple[float, float, float]]:
    """Plateaus (begin, end, density) in the gap after zone i.

    left, right: (kind, position) of the zone's end on each side of the gap; the kind is None if
    there is no zone on that side.
    """
    (one, begin), (other, end) = left, right
    out = []
    if one is not None and one.value != 0.0 and one.until is not None:
        out.append((begin, one.until, one.value))
    if other is not None and other.value != 0.0 and other.until is not None:
        out.append((other.until, end, other.value))
    rest = [e for e in (one, other) if e is not None and e.value != 0.0 and e.until is None]
    if rest and not out and one is not None and other is not None and one.value == other.value:
        return [(begin, end, one.value)]
    if rest:
        raise ValueError(
            f"in the gap after zone {i} (-1: before the first zone) a plateau has only one end: "
            "give the same value at both ends of the gap, or set `until`"
        )
    places = [p for plateau in out for p in plateau[:2]]
    if any(begin >= end for begin, end, _ in out) or places != sorted(places):
        raise ValueError(
            f"in the gap after zone {i} `until` lies on the wrong side of the zone's end, or two "
            "plateaus overlap"
        )
    if places and not (begin <= places[0] and places[-1] <= end):
        raise ValueError(
            f"in the gap after zone {i} a plateau reaches into the zone on the other side: move "
            "`until` into the gap"
        )
    return out


@record
class Logarithms(Kept):
    """Terms of the right side for jumps J of the density: J/pi times the kernel's potential.

    at: positions s of the jumps; weight: J/pi; own: the zone that contains s, or -1; near: pairs of
    a zone and a term whose s lies outside this zone but close to it, or at its end.
    """

    kernel: Kernel
    zones: Zones
    at: Array
    weight: Array
    own: Index
    near: ExteriorLogarithms
    plateaus: Plateaus | None = None

    @classmethod
    def of_plateaus(cls, zones: Zones, kernel: Kernel) -> Self:
        """The logarithmic terms of the right side for the plateaus beside the zones."""
        plateaus = Plateaus.beside(zones, kernel.period)
        at = plateaus.table.T.ravel()
        if kernel.period is not None:  # the end of a zone itself, not its rounded image
            at = np.where(at == zones.a[0] + kernel.period, zones.a[0], at)
        weight = np.concatenate((-plateaus.values, plateaus.values)) / np.pi
        near = ExteriorLogarithms.near(zones, at, weight, kernel.period)
        return cls(kernel, zones, at, weight, np.full(len(at), -1), near, plateaus)

    def at_points(self, x: Array) -> Array:
        """Sum of the logarithmic terms of the right side at points x (n,)."""
        if not self._are_many(len(x)):
            return self._summed(x, self._of_lag)
        return -self._of_plateaus(x, False)

    def primitive_at(self, x: Array) -> Array:
        """Antiderivative, at points x (n,), of the sum of the right side's logarithmic terms."""
        if not self._are_many(len(x)):
            return self._summed(x, lambda away: potential_primitive(self.kernel, away))
        return -self._of_plateaus(x, True)

    def in_plane(self, z: Complex, what: What) -> Complex:
        """Sum of the logarithmic terms, its derivative or its antiderivative, at complex z (n,).

        In the lower half plane the result is the conjugate of the result at conj(z).
        """
        assert self.plateaus is not None
        x, y, at = self.off_positions(z.real), np.abs(z.imag), self.plateaus.table.T.ravel()
        out = np.empty(len(x), dtype=complex)
        for some in self._blocks(len(x)):
            lag = x[some, None] - at
            away = complex_of(lag, np.broadcast_to(y[some, None], lag.shape))
            out[some] = self._of_complex_lag(away, what) @ self.weight
        return np.where(z.imag < 0, np.conj(out), out)

    def off_positions(self, x: Array) -> Array:
        """Points x, but points exactly at a logarithm of the right side are moved by round-off.

        The points have any shape. At its position s, a logarithmic term is infinite, and so is the
        transform of a zone that ends at s; their sum is finite.
        """
        period = self.kernel.period
        low = float(self.at.min(initial=0.0))
        return np.where(
            np.isin(wrapped(x, low, period), wrapped(self.at, low, period)),
            np.nextafter(x, np.inf),
            x,
        )

    def _of_complex_lag(self, away: Complex, what: What) -> Complex:
        """Kernel's potential, its derivative or its primitive, at lags z - s with Im(z - s) >= 0.

        what: "transform" for the kernel's potential, "derivative" for the derivative of this
        potential, or "potential" for its primitive. These are the names of the plateaus' fields to
        which the result contributes.
        """
        kernel = self.kernel
        if is_hilbert(kernel) and what != "potential":
            assert kernel.period is not None
            turn = 2j * np.pi / kernel.period
            with np.errstate(over="ignore"):
                q = np.exp(turn * away)
            if what == "derivative":
                return np.asarray(0.5 * turn * (-1 - 2 * q / (1 - q)))
            return np.asarray(0.5j * np.pi - 0.5 * turn * away + np.log1p(-q))
        if kernel.regular is not None:
            raise ValueError(
                f"at complex points the {what} of plateaus needs a kernel without a regular part"
                + ("" if what == "potential" else ", or sie.hilbert(L)")
            )
        out = np.zeros(away.shape, dtype=complex)
        for pole in kernel.poles:
            lag = away - pole
            if what == "derivative":
                out += 1 / lag
            else:
                log = np.log(np.where(lag == 0, 1.0, lag) / kernel.datum)
                out += log if what == "transform" else lag * (log - 1)
        return out

    def on_zones(self, zone: Index, left: Array) -> Array:
        """Sum of the logarithmic terms at points on zones, without singularities near the points.

        left: distances from the zones' left ends in half widths. For a jump at s in the zone of the
        point t, (J/pi) ln(2 |t - s|) is omitted; for a jump outside but close to this zone,
        (J/pi) ln(2 |rho| |t - s|) is omitted, with the rho of `ExteriorLogarithms`.
        """
        if self._are_many(len(zone)):
            return -self._sums_on_zones(zone, self.zones.half[zone] * left, self._near_zones)
        out = np.empty(len(zone))
        for some in self._blocks(len(zone)):
            out[some] = self._on_zones(zone[some], left[some])
        return out

    def _are_many(self, points: int) -> bool:
        """Whether the terms of plateaus at this number of points are summed over a tree."""
        kernel = self.kernel
        return (
            self.plateaus is not None
            and (kernel.regular is None or kernel.sure)
            and points * len(self.at) > BLOCKS.memory_pairs
        )

    @cached_property
    def _sums_on_zones(self) -> PlateauSums:
        """Fast sums over the plateaus at points on zones.

        The cells of `PlateauSums`, each with one Chebyshev series, are the zones.
        """
        return self._sums_on(self.zones.a, self.zones.b)

    @cached_property
    def _sums_on_line(self) -> PlateauSums:
        """Fast sums over the plateaus at points of one period, from the first zone or plateau on.
        Without a period, they apply from the first to the last end of zones and plateaus.
        """
        assert self.plateaus is not None
        a, b = self.plateaus.table[np.argsort(self.plateaus.table[:, 0])].T
        period, lo = self.kernel.period, min(a[0], self.zones.a[0])
        hi = max(b[-1], self.zones.b[-1]) if period is None else lo + period
        ends = cells_around(a, b, lo, hi)
        return self._sums_on(ends[:-1], ends[1:])

    def _sums_on(self, a: Array, b: Array) -> PlateauSums:
        assert self.plateaus is not None
        return PlateauSums((self.plateaus.table, self.plateaus.values), a, b, self.kernel)

    def _of_plateaus(self, x: Array, potential: bool) -> Array:
        """Transform of the plateaus at points x (n,), or the potential if `potential` is true."""
        sums, kernel = self._sums_on_line, self.kernel

        def near(cell: Index, away: Array, which: Index, shift: Array) -> Array:
            log = np.log(np.maximum(np.abs(away), 1e-300) / kernel.datum)
            return np.asarray(away * (log - 1.0) if potential else log)

        def alone(away: Array) -> Array:
            return potential_primitive(kernel, away) if potential else self._of_lag(away)

        x = self.off_positions(wrapped(x, float(sums.a[0]), kernel.period))
        cell = np.clip(np.searchsorted(sums.a, x, side="right") - 1, 0, len(sums.a) - 1)
        left, out = x - sums.a[cell], np.empty(len(x))
        beyond = (x < sums.a[0]) | (left > 2 * sums.half[cell] + 8 * np.spacing(np.abs(x)))
        out[~beyond] = sums(cell[~beyond], left[~beyond], near, potential)
        out[beyond] = -self._summed(x[beyond], alone)
        return out

    @cached_property
    def _singular(self) -> tuple[Index, Array, Array]:
        """Logarithms near a zone: (numbers of pairs, positions of logarithms, constants).
        The pair of zone i and term k has the number i n + k, with the number n of all terms. The
        constant ln(|x - s| / datum) - ln(2 |rho| |t - s|) remains of the term if its singularity is
        left out, see `on_zones`.
        """
        near, zones, count = self.near, self.zones, len(self.at)
        number = near.zone * count + near.which
        order = np.argsort(number, kind="stable")
        zone, which = near.zone[order], near.which[order]
        place, period = self.at[which], self.kernel.period
        if period is not None:
            place = place + np.round((zones.middle[zone] - place) / period) * period
        size = np.abs(near.rho[order])
        left = np.log(zones.half[zone] / (2 * size * self.kernel.datum))
        return number[order], place, left

    def _near_zones(self, zone: Index, away: Array, which: Index, shift: Array) -> Array:
        """Terms (2, pairs) of the ends of plateaus near zones; see `OfPairs`.
        Near the zone of a point, ln(2 |rho| |t - s|) is left out of the term, as in `on_zones`.
        """
        numbers, places, left = self._singular
        with np.errstate(divide="ignore"):
            log = np.log(np.abs(away) / self.kernel.datum)
        if len(numbers) == 0:
            return np.asarray(log)
        assert self.plateaus is not None
        for side, term in enumerate((which, which + len(self.plateaus.table))):
            number = zone * len(self.at) + term
            k = np.minimum(np.searchsorted(numbers, number), len(numbers) - 1)
            found = numbers[k] == number
            if self.kernel.period is not None:
                # Only one periodic image of the logarithm is near the zone.
                place = self.plateaus.table[which, side] + shift
                found &= np.abs(place - places[k]) < 0.25 * self.kernel.period
            log[side] = np.where(found, left[k], log[side])
        return np.asarray(log)

    def _on_zones(self, zone: Index, left: Array) -> Array:
        zones, kernel = self.zones, self.kernel
        w = zones.half[zone]
        away = (w * left)[:, None] + (zones.a[zone][:, None] - self.at)
        point, which, size = self._nearby(zone)
        beside = away[point, which]
        away[point, which] = 1.0
        values = self._of_lag(away)
        if kernel.period is not None:
            # The distance of a point from a logarithm counts from the periodic image of the
            # logarithm that is nearest to the middle of the zone. Logarithms in the zone itself are
            # not shifted.
            turns = np.round((zones.middle[zone[point]] - self.at[which]) / kernel.period)
            outside = self.own[which] != zone[point]
            beside = np.where(outside, beside - turns * kernel.period, beside)
        without = np.log(w[point] / (2 * size * kernel.datum))
        values[point, which] = without + self._rest(beside)
        return np.asarray(values @ self.weight)

    def _nearby(self, zone: Index) -> tuple[Index, Index, Array]:
        """Pairs of a point and a logarithm in or near its zone: (point, term, |rho|).

        rho belongs to the position of the logarithm relative to the zone; |rho| = 1 on the zone.
        """
        term = np.flatnonzero(self.own >= 0)
        of_zone = np.concatenate((self.own[term], self.near.zone))
        which = np.concatenate((term, self.near.which))
        size = np.concatenate((np.ones(len(term)), np.abs(self.near.rho)))
        order = np.argsort(of_zone, kind="stable")
        start, stop = (np.searchsorted(of_zone[order], zone, side=s) for s in ("left", "right"))
        count = stop - start
        point = np.repeat(np.arange(len(zone)), count)
        pair = order[np.arange(count.sum()) - np.repeat(np.cumsum(count) - count - start, count)]
        return point, which[pair], size[pair]

    def _summed(self, x: Array, of: Callable[[Array], Array]) -> Array:
        out = np.empty(len(x))
        for some in self._blocks(len(x)):
            out[some] = of(x[some, None] - self.at) @ self.weight
        return out

    def _blocks(self, points: int) -> Iterator[slice]:
        rows = max(1, BLOCKS.cache_pairs // max(1, len(self.at)))
        for start in range(0, points, rows):
            yield slice(start, start + rows)

    def _of_lag(self, away: Array) -> Array:
        """The kernel's potential at distances x - s."""
        kernel = self.kernel
        with np.errstate(divide="ignore"):
            if is_hilbert(kernel):
                assert kernel.period is not None
                return np.asarray(np.log(np.abs(2 * np.sin(np.pi / kernel.period * away))))
            near = nearest_image(away, 0.0, kernel.period)
            return np.asarray(np.log(np.abs(near) / kernel.datum) + self._rest(near))

    def _rest(self, away: Array) -> Array:
        """The kernel's potential at distances x - s, without the logarithm of the pole at 0."""
        kernel = self.kernel
        out = np.zeros(away.shape)
        for shift in kernel.poles:
            if shift != 0.0:
                out += np.log(np.abs(away - shift) / kernel.datum)
        if kernel.regular_potential is not None:
            out += kernel.regular_potential(away, np.zeros(1))
        return out
