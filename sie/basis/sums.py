"""Sums of power, sine and cosine series at many points on many zones."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis import compiled
from sie.basis.data import DIGITS, Array, Complex, Index, Kept, Mask, numbered, record


@dataclass(frozen=True)
class SumOptions:
    """Block sizes of sums and quadrature, and sizes above which other algorithms are used.

    Insensitive: a factor of two changes times by a few per cent, and no result beyond round-off.
    """

    # Number of (point, source) pairs whose arrays fit into the processor's cache.
    cache_pairs: int = 1 << 15
    # Largest number of (point, source) pairs in one matrix product, and of numbers in one table.
    # These arrays fill some megabytes.
    memory_pairs: int = 1 << 19
    # With at least this many (point, source) pairs or table entries, matrix operations are faster
    # than loops over pairs or columns.
    min_matrix_pairs: int = 1 << 12
    # Up to this number of terms, sums of sines, and sine and cosine transforms, are products with a
    # matrix. Longer sums of sines use the addition theorem (see `_sines`), and longer transforms
    # are fast transforms.
    max_direct_terms: int = 128
    # Number of nodes of Gauss's rule on a panel (one interval of the quadrature). With two nodes
    # for each radian of phase, the rule integrates a wave to round-off.
    gauss_nodes: int = 16

    @property
    def max_turn(self) -> float:
        """Largest change of the phase l theta over one panel, if cos(l theta) is integrated.
        A panel is one interval of the quadrature.
        """
        return self.gauss_nodes / 2


OPTIONS = SumOptions()


def pair_blocks(points: int, jumps: int) -> Iterator[slice]:
    """Blocks of points; each block has at most `memory_pairs` pairs of a point and a jump."""
    block = max(1, OPTIONS.memory_pairs // max(1, jumps))
    for begin in range(0, points, block):
        yield slice(begin, begin + block)


def stretches(counts: Index, most: int) -> Iterator[slice]:
    """Yield blocks of consecutive points that have at most `most` (point, item) pairs together.
    A point that has more pairs is a block of its own.

    counts: number of pairs of each point.
    """
    total, begin = np.cumsum(counts), 0
    while begin < len(counts):
        done = int(total[begin - 1]) if begin else 0
        end = max(begin + 1, int(np.searchsorted(total, done + most)))
        yield slice(begin, end)
        begin = end


@record
class Grouped:
    """Items (points, jumps or poles), sorted by the zone in which they lie.

    order: indices of the items, zone after zone. count: number of items in each zone; first:
    position in `order` of the zone's first item. Both have one further entry, for all zones after
    the last zone with items.
    """

    order: Index
    count: Index
    first: Index

    @classmethod
    def by(cls, zone: Index) -> "Grouped":
        """Items grouped by zone; zone (n,) is the zone index of each item."""
        count = np.bincount(zone, minlength=int(zone.max(initial=-1)) + 2)
        return cls(np.argsort(zone, kind="stable"), count, np.cumsum(count) - count)

    def rows(self, zone: Index) -> Index:
        """Index of each given zone in the arrays `count` and `first`.

        All zones after the last zone with items share the last entry, whose count is 0.
        """
        return np.minimum(zone, len(self.count) - 1)

    def places(self) -> dict[int, Index]:
        """The indices of the items in each zone, for the zones that contain items.

        Keys are zones in ascending order.
        """
        return {
            i: self.order[self.first[i] : self.first[i] + self.count[i]]
            for i in np.flatnonzero(self.count).tolist()
        }

    def summed(self, zone: Index, weight: Array, of: Callable[[Index, Index], Array]) -> Array:
        """For each point, the weighted sum of a function `of` over the items in the point's zone.

        zone: zone of each point; weight: weight of each item. of(points, items): the summand
        without its weight, pair by pair. In a zone with many pairs, `of` is called with points
        (n, 1) and all items of the zone. The result is then used as a matrix.
        """
        zone, out = self.rows(zone), np.zeros(len(zone))
        pairs = self.count * np.bincount(zone, minlength=len(self.count))
        many = pairs > (OPTIONS.min_matrix_pairs if np.count_nonzero(pairs) > 1 else 0)
        dense, some = np.flatnonzero(many[zone]), np.flatnonzero((pairs > 0)[zone] & ~many[zone])
        for i, places in Grouped.by(zone[dense]).places().items():
            at, things = dense[places], self.order[self.first[i] :][: self.count[i]]
            for here in pair_blocks(len(at), len(things)):
                out[at[here]] = of(at[here, None], things) @ weight[things]
        for here in stretches(self.count[zone[some]], OPTIONS.cache_pairs):
            at = some[here]
            count = self.count[zone[at]]
            row = np.repeat(np.arange(len(at)), count)
            thing = self.order[numbered(count) + np.repeat(self.first[zone[at]], count)]
            out[at] = np.bincount(row, of(at[row], thing) * weight[thing], len(at))
        return out


class PerZone(Kept):
    """Base class of records of n items; `zone` (n,) is the zone that each item belongs to."""

    zone: Index

    def __len__(self) -> int:
        return len(self.zone)

    @cached_property
    def grouped(self) -> Grouped:
        """The items sorted by zone."""
        return Grouped.by(self.zone)

    @cached_property
    def by_zone(self) -> dict[int, Index]:
        """The indices of the items in each zone, for the zones that contain items."""
        return self.grouped.places()

    def of_zone(self, zone: int) -> Index:
        """The indices of the items in one zone."""
        return self.by_zone.get(zone, np.zeros(0, dtype=np.intp))


def sum_of_powers(u: Array, rho: NDArray[Any], zone: Index) -> NDArray[Any]:
    """Power series sum_k u[zone, k] rho^k, for real or complex rho with |rho| < 1.

    The sum stops at the k at which rho^k is at round-off. rho and zone are pairs (n,), or rho has
    the shape (points, sources) and zone (sources,).
    """
    count = u.shape[1]
    if count == 0 or rho.size == 0:
        return np.zeros(rho.shape, dtype=rho.dtype)
    if rho.ndim == 2:
        if rho.size * count <= OPTIONS.memory_pairs:
            return _same_order(u[zone], rho)
        return sum_of_powers(u, rho.ravel(), np.tile(zone, rho.shape[0])).reshape(rho.shape)
    return _by_horner(u, rho, zone, _needed_terms(rho, count))


def sum_and_slope(u: Array, rho: NDArray[Any], zone: Index) -> tuple[NDArray[Any], NDArray[Any]]:
    """The sums of u[zone, k] rho^k and of k u[zone, k] rho^k, for pairs (n,) of rho and zone.

    Together they take little longer than `sum_of_powers` takes for one of them.
    """
    order, point_rho, row, active = _sorted_pairs(rho, zone, _needed_terms(rho, u.shape[1]))
    value, slope = np.zeros((2, len(order)), dtype=rho.dtype)
    for k in range(len(active) - 1, -1, -1):
        here, its_rho = slice(active[k]), point_rho[: active[k]]
        slope[here] *= its_rho
        slope[here] += value[here]
        value[here] *= its_rho
        value[here] += u[row[here], k]
    out = np.empty((2, len(order)), dtype=rho.dtype)
    out[:, order] = value, slope * point_rho
    return out[0], out[1]


def _needed_terms(rho: NDArray[Any], count: int) -> Index:
    """For each rho, the number of terms u_k rho^k, k < `count`, that are above round-off."""
    with np.errstate(divide="ignore"):
        seen = np.ceil(-DIGITS / np.log(np.minimum(np.abs(rho), 1 - 1e-12)))
    # For rho = 0 the formula gives no terms, but the term with k = 0 is still needed.
    return np.fmin(count, np.maximum(seen, 1)).astype(int)


def _by_horner(u: Array, rho: NDArray[Any], zone: Index, terms: Index) -> NDArray[Any]:
    """Power series sum_k u[zone, k] rho^k at pairs of a number rho and a zone, by Horner's rule.
    terms: number of terms of each pair's series.

    Without compiled loops there are two ways. If there are few zones, they are summed one after the
    other, because this takes fewer NumPy calls (see `_one_series`). Otherwise the pairs are sorted
    by the number of terms, so that Horner's rule works on a growing block.
    """
    loops = compiled.loops("power_series", float(terms.sum()))
    if loops is not None:
        starts = np.concatenate(([0], np.cumsum(terms)))
        values = np.empty(len(rho), dtype=rho.dtype)
        # A loop is compiled anew for arrays of another kind, such as arrays with steps.
        arrays = [np.require(array, requirements=("C", "W")) for array in (u, rho, zone, terms)]
        compiled.in_threads(loops.power_series, starts, *arrays, values)
        return values
    if 2 * len(u) < np.sqrt(terms.max(initial=0)):
        result = np.zeros(len(rho), dtype=rho.dtype)
        for i, places in Grouped.by(zone).places().items():
            for block in pair_blocks(len(places), int(np.sqrt(u.shape[1]))):
                some = places[block]
                result[some] = _one_series(u[i, : terms[some].max()], rho[some])
        return result
    order, point_rho, row, active = _sorted_pairs(rho, zone, terms)
    out = np.zeros(len(order), dtype=rho.dtype)
    for k in range(len(active) - 1, -1, -1):
        n = active[k]
        out[:n] = out[:n] * point_rho[:n] + u[row[:n], k]
    result = np.empty(len(order), dtype=rho.dtype)
    result[order] = out
    return result


def _one_series(c: Array, rho: NDArray[Any]) -> NDArray[Any]:
    """Power series sum_k c[k] rho^k at each rho (n,).

    The index k is written as m a + b. The sums over b are a product with the matrix of rho^b, and
    Horner's rule in rho^m adds them up. So far fewer NumPy calls than terms are needed.
    """
    m = 2 ** round(0.5 * np.log2(max(len(c), 1)))
    rows = np.zeros((max(1, -(-len(c) // m)), m))
    rows.ravel()[: len(c)] = c
    powers = np.empty((len(rho), m), dtype=rho.dtype)
    powers[:, 0], powers[:, 1:] = 1.0, rho[:, None]
    powers = np.cumprod(powers, axis=1)
    sums = (powers @ rows.T).T
    rho_to_m, out = powers[:, -1] * rho, sums[-1]
    for row in sums[-2::-1]:
        out = out * rho_to_m + row
    return np.asarray(out)


def _sorted_pairs(
    rho: NDArray[Any], zone: Index, terms: Index
) -> tuple[Index, NDArray[Any], Index, Index]:
    """Sort the pairs (rho, zone) of power series by falling number of terms.
    Returns the order, the sorted rho and zones, and for each k the number of pairs that have more
    than k terms.
    """
    last = int(terms.max(initial=0))
    fewer = last - terms
    # NumPy sorts 16-bit integers by radix sort, in a fifth of the time that longer integers take.
    order = np.argsort(fewer.astype(np.uint16) if last < 1 << 16 else fewer, kind="stable")
    active = len(terms) - np.cumsum(np.bincount(terms, minlength=last + 1))[:last]
    return order, rho[order], zone[order], active


def _same_order(c: Array, rho: NDArray[Any]) -> NDArray[Any]:
    """Power series sum_k c[source, k] rho^k for each point and source, without truncation."""
    count = c.shape[1]
    if rho.size > OPTIONS.max_direct_terms:
        out = np.zeros(rho.shape) + c[:, -1]
        for k in range(count - 2, -1, -1):
            out *= rho
            out += c[:, k]
        return out
    powers = np.empty((*rho.shape, count))
    powers[..., 0] = 1.0
    powers[..., 1:] = rho[..., None]
    return np.asarray(np.einsum("psk,sk->ps", np.cumprod(powers, axis=-1), c))


def waves(weight: Array, angle: Array, count: int) -> Complex:
    """Exponential sums sum_j weight_j exp(i k angle_j), for k = 0 ... count - 1."""
    turn, wave, out = np.exp(1j * angle), weight.astype(complex), np.empty(count, dtype=complex)
    for k in range(count):
        out[k] = wave.sum()
        wave *= turn
    return out


def sine_sum(u: Array, zone: Index, angle: Array, flip: Mask) -> Array:
    """Sine series sum_k u[zone, k] sin((k + 1) theta), given the angle from the nearer end.

    theta = pi - angle where `flip` is true, else theta = angle. So no digit is lost near either
    end. Arrays have any shape. If all zones have the same angles, and `zone` is broadcast from the
    shape (n, 1), the sum is faster.
    """
    if zone.ndim == 2 and zone.strides[1] == 0 == angle.strides[0]:
        return _same_places(u, zone[:, 0], angle[0], flip[0])
    shape, zone, angle, flip = angle.shape, zone.ravel(), angle.ravel(), flip.ravel()
    terms = _terms(u, zone)
    # The series is the imaginary part of sum_k u_k turn^(k+1), with turn = exp(i angle). Where
    # `flip` is true, it is the imaginary part of sum_k u_k turn (-turn)^k.
    turn = np.exp(1j * angle)
    out = (
        turn
        * _by_horner(
            u,
            np.where(flip, -turn, turn),
            zone,
            np.where(terms > OPTIONS.max_direct_terms, 0, terms),
        )
    ).imag
    many = np.flatnonzero(terms > OPTIONS.max_direct_terms)
    for i, some in Grouped.by(zone[many]).places().items():
        here = many[some]
        out[here] = _same_places(u, np.array([i]), angle[here], flip[here])[0]
    return out.reshape(shape)


def cosine_sum(c: Array, zone: Index, theta: Array) -> Array:
    """Cosine series sum_k c[zone, k] cos((k+1) theta), for n pairs of a zone and an angle theta."""
    turn = np.exp(1j * theta)
    return np.asarray((turn * _by_horner(c, turn, zone, _terms(c, zone))).real)


def _terms(table: Array, row: Index) -> Index:
    """Number of coefficients in each given row of `table`, up to the last one that is not zero."""
    named = np.flatnonzero(np.bincount(row, minlength=len(table)))
    used = table[named] != 0.0
    terms = np.zeros(len(table), dtype=np.intp)
    terms[named] = (
        used.any(axis=1) * (table.shape[1] - np.argmax(used[:, ::-1], axis=1))
        if table.shape[1]
        else 0
    )
    return terms[row]


def _same_places(u: Array, zones: Index, angle: Array, flip: Mask) -> Array:
    """Sine series of several zones at the same angles, by matrix products in blocks of angles.
    The series and the arguments are those of `sine_sum`.
    """
    rows = u[zones]
    k = np.arange(1, _terms(u, zones).max(initial=0) + 1)
    rows = rows[:, : len(k)]
    # sin(k (pi - angle)) = -(-1)^k sin(k angle). Where `flip` is true, terms of even k therefore
    # change their sign.
    turned = rows * (2.0 * (k % 2) - 1.0)
    out, block = np.empty((len(zones), len(angle))), max(1, OPTIONS.memory_pairs // max(1, len(k)))
    for start in range(0, len(angle), block):
        here = slice(start, start + block)
        some = flip[here].any()
        sums = _sines(angle[here], np.concatenate((rows, turned) if some else (rows,)).T).T
        out[:, here] = np.where(flip[here], sums[len(rows) :], sums[: len(rows)]) if some else sums
    return out


def _sines(angle: Array, columns: Array) -> Array:
    """Sine series sum_k columns[k - 1] sin(k angle), of shape (points, number of columns).

    With many terms, k is written as m a + b. Then sin(k angle) follows from the sines and cosines
    of m a angle and of b angle, so that few sines are evaluated.
    """
    count = len(columns) + 1
    if count <= OPTIONS.max_direct_terms:
        return np.asarray(np.sin(angle[:, None] * np.arange(1, count)) @ columns)
    m = 2 ** round(0.5 * np.log2(count))
    terms = np.zeros((-(-count // m), m, columns.shape[1]))
    terms.reshape(-1, columns.shape[1])[1:count] = columns
    near, far = angle[:, None] * np.arange(m), angle[:, None] * (m * np.arange(len(terms)))
    by_near = terms.transpose(1, 0, 2).reshape(m, -1)
    shape = (len(angle), *terms.shape[::2])
    cosines, sines = (np.reshape(wave @ by_near, shape) for wave in (np.cos(near), np.sin(near)))
    return np.asarray(
        np.einsum("pa,pac->pc", np.sin(far), cosines) + np.einsum("pa,pac->pc", np.cos(far), sines)
    )
