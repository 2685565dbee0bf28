"""Lowest coefficients of the right side on zones with many jumps of its derivatives.

Truncated powers h (t - s)_+^q grow across a zone. For n knots of a spline, they and the remaining
polynomial are up to n^2 times the right side g itself. Within the zone that does no harm. But the
zone's field on its neighbours, and the level that the zone shares with a lightly loaded zone, would
have the round-off of a difference of large numbers. So the lowest coefficients of g and the mean of
its primitive G are computed from g itself,

    g_k = (2/pi) int_0^pi g sin(theta) sin(k theta) dtheta,    mean = (1/pi) int_0^pi G dtheta,

by Gauss-Legendre rules on the intervals between jumps, where g is smooth. The unknowns are then the
coefficients of the whole density, those of the jumps included.
"""

from dataclasses import dataclass

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Index, legendre
from sie.basis.interval import sides
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.sums import waves
from sie.basis.zones import Zones
from sie.equation.equation import Forcing
from sie.jumps.right_side import ForcingJumps


@dataclass(frozen=True)
class MomentOptions:
    """Options for computing coefficients of the right side by integrals between its jumps."""

    # A zone with at least this number of jumps gets its coefficients from integrals between the
    # jumps. The other method subtracts one truncated power for each jump. For so many jumps, these
    # powers would be some ten times as large as the right side, and their sum would lose digits.
    min_jumps: int = 32


OPTIONS = MomentOptions()


def many_jumps(forcing: Forcing, zones: Zones, jumps: ForcingJumps) -> Index:
    """Indices of zones on which derivatives of the right side jump `min_jumps` times or more.

    The indices are ascending. If the zones are symmetric, only those of the right half are listed.
    """
    if len(forcing.jumps) == 0:
        return np.zeros(0, dtype=np.intp)
    count = np.bincount(jumps.zone[jumps.order > 0], minlength=len(zones))
    count[list(jumps.splines)] += OPTIONS.min_jumps
    # Near an algebraic point, the right side or the density is a power of the distance. Integrals
    # between jumps need a right side that is smooth there, so zones with such points are left out.
    count[list(jumps.poles.by_zone)] = 0
    return np.asarray(zones.solved[count[zones.solved] >= OPTIONS.min_jumps])


def rule(jumps: ForcingJumps, zone: int, highest: int) -> tuple[Array, Array]:
    """(angles, weights) of the quadrature on the intervals between the jumps of a zone.

    For sin(k theta) up to k = `highest` it has no error above round-off.
    """
    cuts = np.concatenate(([0.0], np.sort(jumps.angles(zone)), [np.pi]))
    parts = np.maximum(np.ceil(np.diff(cuts) * (highest / SUMS.max_turn)), 1.0).astype(np.intp)
    return legendre(cuts, SUMS.gauss_nodes, parts)


def coefficients(
    forcing: Forcing, zones: Zones, jumps: ForcingJumps, chosen: Index, m: Index
) -> tuple[Array, Array]:
    """(coefficients g_k of the right side, mean of its primitive), each on all zones `chosen`.

    The coefficients are at [:, k]. The means are 0 if the right side has no primitive.
    """
    rules = [rule(jumps, int(zone), int(m[zone])) for zone in chosen]
    first = np.cumsum([0, *(len(theta) for theta, _ in rules)])
    theta, weights = (np.concatenate(parts) for parts in zip(*rules, strict=True))
    left, right = sides(theta)
    zone = np.repeat(chosen, np.diff(first))
    x = np.where(
        left <= right,
        zones.a[zone] + zones.half[zone] * left,
        zones.b[zone] - zones.half[zone] * right,
    )
    turned = (2 / np.pi) * np.asarray(forcing.value(x), dtype=float) * np.sin(theta) * weights
    out = np.zeros((len(chosen), int(m[chosen].max()) + 1))
    for row, k, start, end in zip(out, m[chosen], first[:-1], first[1:], strict=True):
        row[: k + 1] = waves(turned[start:end], theta[start:end], int(k) + 1).imag
    if forcing.primitive is None:
        return out, np.zeros(len(chosen))
    return out, np.add.reduceat(
        np.asarray(forcing.primitive(x), dtype=float) * weights, first[:-1]
    ) / np.pi


def of_logarithms(
    zones: Zones, jumps: ForcingJumps, chosen: Index, counts: Index
) -> tuple[Array, Array]:
    """(coefficients of the logarithms of plateaus, mean of their primitive) on the zones `chosen`.

    `counts` is the number of coefficients of each zone. The coefficients at [:, k] leave out
    logarithms close to the zone, whose densities are known in closed form. The means include all
    logarithms.
    """
    out = np.zeros((len(chosen), int(counts.max()) + 1))
    if jumps.logarithms is None:
        return out, np.zeros(len(chosen))
    for count in np.unique(counts):
        row = np.flatnonzero(counts == count)
        left = chebyshev.lobatto(int(count))[2][1:-1]
        at = np.repeat(chosen[row], count), np.tile(left, len(row))
        values = jumps.logarithms.on_zones(*at).reshape(len(row), -1)
        out[row, 1 : count + 1] = chebyshev.u_coefficients(values)
    ends = jumps.primitive_left_out(np.array([zones.a[chosen], zones.b[chosen]]))
    even = out[:, 2::2] @ (0.5 / np.arange(1.0, 1 + out[:, 2::2].shape[1]))
    closed = jumps.near.mean_offsets(len(zones))[chosen]
    return out, 0.5 * ends.sum(axis=0) + zones.half[chosen] * (closed - even)
