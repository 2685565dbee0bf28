"""Sums over the basis functions of many intervals at many points: powers of rho, sines and cosines of multiples of theta."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import Array, Index, Mask

# Below this number of multiplications all pairs are summed to the same order; of few pairs, all powers are formed at once.
_SMALL, _FEW = 200_000, 256
# (point, jump) pairs handled at once.
PAIRS = 1 << 19
# Sines of multiples that are all taken.
_FEW_SINES = 256
# Sines and cosines held at once.
_BLOCK = 800_000
# Zones that are named less often are summed together, by numbers of terms that are rounded up to a multiple.
_POOLED, _SIZES = 48, 8


def of_zones(zone: Index) -> Iterator[tuple[int, Index]]:
    """Every zone that is named, with the places that name it, in ascending order."""
    order = np.argsort(zone, kind="stable")
    cuts = np.flatnonzero(np.diff(zone[order], prepend=-1, append=-1))
    for start, end in zip(cuts[:-1], cuts[1:], strict=True):
        yield int(zone[order[start]]), order[start:end]


def pair_blocks(points: int, jumps: int) -> Iterator[slice]:
    """Stretches of points whose pairs with so many jumps are held at once."""
    block = max(1, PAIRS // max(1, jumps))
    for begin in range(0, points, block):
        yield slice(begin, begin + block)


def sum_of_powers(u: Array, rho: NDArray[Any], zone: Index) -> NDArray[Any]:
    """sum_k u[zone, k] rho^k, rho real or complex, as far as rho^k is seen: pair by pair, rho and zone (n,), or for every point and
    source, rho (points, sources) and zone (sources,)."""
    count = u.shape[1]
    if count == 0 or rho.size == 0:
        return np.zeros(rho.shape, dtype=rho.dtype)
    if rho.ndim == 2:
        if rho.size * count <= _SMALL:
            return _same_order(u[zone], rho)
        return sum_of_powers(u, rho.ravel(), np.tile(zone, rho.shape[0])).reshape(rho.shape)
    flat = np.abs(rho)
    with np.errstate(divide="ignore"):
        need = np.fmin(count, np.ceil(-40.0 / np.log(np.minimum(flat, 1 - 1e-12)))).astype(int)
    need = np.maximum(need, 1)
    order = np.argsort(-need, kind="stable")
    point_rho, row = rho[order], zone[order]
    counts = need[order]
    out = np.zeros(len(order), dtype=rho.dtype)
    active = np.searchsorted(-counts, -np.arange(1, counts[0] + 1), side="right")
    for k in range(int(counts[0]) - 1, -1, -1):
        n = active[k]
        out[:n] = out[:n] * point_rho[:n] + u[row[:n], k]
    result = np.empty(len(order), dtype=rho.dtype)
    result[order] = out
    return result


def _same_order(c: Array, rho: NDArray[Any]) -> NDArray[Any]:
    """sum_k c[source, k] rho^k for every (point, source)."""
    count = c.shape[1]
    if rho.size > _FEW:
        out = np.zeros(rho.shape) + c[:, -1]
        for k in range(count - 2, -1, -1):
            out *= rho
            out += c[:, k]
        return out
    powers = np.empty((*rho.shape, count))
    powers[..., 0] = 1.0
    powers[..., 1:] = rho[..., None]
    return np.asarray(np.einsum("psk,sk->ps", np.cumprod(powers, axis=-1), c))


def sine_sum(u: Array, zone: Index, angle: Array, flip: Mask) -> Array:
    """sum_k u[zone, k] sin((k+1) theta), by the angle from the nearer end, theta = pi - angle where `flip`: no digit is lost near either
    end. zone of any shape; one column of zones, (n, 1), with the same places in each is faster."""
    if zone.ndim == 2 and zone.strides[1] == 0 == angle.strides[0]:
        return _same_places(u, zone[:, 0], angle[0], flip[0])
    out = np.zeros(angle.shape)
    flat_zone, flat_angle, flat_flip, flat_out = zone.ravel(), angle.ravel(), flip.ravel(), out.reshape(-1)
    for here, sines, rows in _pooled(u, flat_zone, flat_angle, np.sin):
        k = np.arange(1, rows.shape[1] + 1)
        turned = np.einsum("pk,pk,k->p", sines, rows, 2.0 * (k % 2) - 1.0)
        flat_out[here] = np.where(flat_flip[here], turned, np.einsum("pk,pk->p", sines, rows))
    for i, here in of_zones(flat_zone):
        if len(here) < _POOLED:
            continue
        row = np.trim_zeros(u[i], "b")
        if len(row) == 0:
            continue
        k = np.arange(1, len(row) + 1)
        # In both directions: seen from the left end, t changes sign.
        both = np.column_stack((row, row * (2.0 * (k % 2) - 1.0)))
        for part in _blocks(here, len(row)):
            sums = _sines(flat_angle[part], both)
            flat_out[part] = np.where(flat_flip[part], sums[:, 1], sums[:, 0])
    return out


def _same_places(u: Array, zones: Index, angle: Array, flip: Mask) -> Array:
    """`sine_sum` at the same places of several zones, as matrix products of bounded size."""
    rows = u[zones]
    used = np.flatnonzero(np.any(rows != 0, axis=0))
    k = np.arange(1, used[-1] + 2 if len(used) else 1)
    rows = rows[:, : len(k)]
    # Seen from the left end, t changes sign: even modes do too.
    turned = rows * (2.0 * (k % 2) - 1.0)
    out = np.empty((len(zones), len(angle)))
    for here in _blocks(np.arange(len(angle)), len(k)):
        some = flip[here].any()
        sums = _sines(angle[here], np.concatenate((rows, turned) if some else (rows,)).T).T
        out[:, here] = np.where(flip[here], sums[len(rows) :], sums[: len(rows)]) if some else sums
    return out


def _sines(angle: Array, columns: Array) -> Array:
    """sum_k columns[k - 1] sin(k angle), (points, columns). Of many terms k = m a + b, by sin(m a angle + b angle): few sines are taken."""
    count = len(columns) + 1
    if count <= _FEW_SINES:
        return np.asarray(np.sin(angle[:, None] * np.arange(1, count)) @ columns)
    m = 2 ** round(0.5 * np.log2(count))
    terms = np.zeros((-(-count // m), m, columns.shape[1]))
    terms.reshape(-1, columns.shape[1])[1:count] = columns
    near, far = angle[:, None] * np.arange(m), angle[:, None] * (m * np.arange(len(terms)))
    by_near = terms.transpose(1, 0, 2).reshape(m, -1)
    shape = (len(angle), *terms.shape[::2])
    cosines, sines = (np.reshape(wave @ by_near, shape) for wave in (np.cos(near), np.sin(near)))
    return np.asarray(np.einsum("pa,pac->pc", np.sin(far), cosines) + np.einsum("pa,pac->pc", np.cos(far), sines))


def cosine_sum(c: Array, zone: Index, theta: Array) -> Array:
    """sum_k c[zone, k] cos((k+1) theta), pair by pair (n,)."""
    out = np.zeros(theta.shape)
    for here, cosines, rows in _pooled(c, zone, theta, np.cos):
        out[here] = np.einsum("pk,pk->p", cosines, rows)
    for i, here in of_zones(zone):
        if len(here) < _POOLED:
            continue
        row = np.trim_zeros(c[i], "b")
        k = np.arange(1, len(row) + 1)
        for part in _blocks(here, len(row)):
            out[part] = np.cos(theta[part][:, None] * k) @ row
    return out


def _pooled(
    table: Array, zone: Index, angle: Array, wave: Callable[[Array], Array]
) -> Iterator[tuple[Index, Array, Array]]:
    """Points of zones that are named fewer than _POOLED times, those of about as many terms together: (places, waves of k times their
    angles, their rows of the table)."""
    some = np.flatnonzero(np.bincount(zone, minlength=1)[zone] < _POOLED) if len(zone) else zone
    if len(some) == 0 or table.shape[1] == 0:
        return
    named = np.unique(zone[some])
    used = table[named] != 0
    terms = np.zeros(len(table), dtype=np.intp)
    terms[named] = np.where(used.any(axis=1), table.shape[1] - np.argmax(used[:, ::-1], axis=1), 0)
    # Rounded up, so that there are few sizes.
    size = np.minimum(-(-terms[zone[some]] // _SIZES) * _SIZES, table.shape[1])
    for count, here in of_zones(size):
        for part in _blocks(some[here], max(count, 1)):
            k = np.arange(1, count + 1)
            yield part, wave(angle[part][:, None] * k), table[zone[part], :count]


def _blocks(places: Index, count: int) -> Iterator[Index]:
    block = max(1, _BLOCK // max(1, count))
    for s in range(0, len(places), block):
        yield places[s : s + block]
