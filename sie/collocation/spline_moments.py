"""Zones with many jumps of the right side's derivatives: what other zones feel of them, from integrals between the jumps.

Truncated powers h (t - s)_+^q grow across a zone. Of n knots of a spline they and the polynomial that is left amount to n^2 times the
right side itself: in one zone that is no harm, but its neighbours, and the level that it shares with a lightly loaded one, would see the
rounding of a difference of large numbers. So the lowest coefficients and the mean of the primitive are taken from g itself,

    g_k = (2/pi) int_0^pi g sin(theta) sin(k theta) dtheta        mean = (1/pi) int_0^pi G dtheta,        G' = g,

by Gauss-Legendre rules on the stretches between jumps, where g is smooth. The unknowns are then those of the whole density, T_l
coefficients of the jumps' parts included.
"""

from functools import lru_cache

import numpy as np

from sie.basis.data import Array, Index, divided
from sie.basis.zones import Zones
from sie.equation.equation import Forcing
from sie.jumps.forcing import ForcingJumps

# From this number of jumps on in a zone: the powers are then some ten times the right side.
MANY_JUMPS = 32
# Nodes on a stretch, and the largest angle by which sin(k theta) turns on it: the rule is exact to rounding there.
_NODES, _TURN = 16, 2 * np.pi


@lru_cache(maxsize=1)
def _rule() -> tuple[Array, Array]:
    t, weights = np.polynomial.legendre.leggauss(_NODES)
    return np.asarray(0.5 * (1 + t)), np.asarray(0.5 * weights)


def many_jumps(forcing: Forcing, zones: Zones, jumps: ForcingJumps) -> Index:
    """Solved zones with many jumps of the right side's or of the density's derivatives, in order."""
    if len(forcing.jumps_at) == 0 and len(forcing.density_jumps_at) == 0:
        return np.zeros(0, dtype=np.intp)
    count = np.bincount(jumps.zone[jumps.order > 0], minlength=len(zones))
    count[list(jumps.splines)] += MANY_JUMPS
    return np.asarray(zones.solved[count[zones.solved] >= MANY_JUMPS])


class Stretches:
    """The rule on the stretches of chosen zones: angles, weights and distances from the left and right end over the half width, zone
    after zone; first: where each begins. turns: highest k per zone."""

    def __init__(self, jumps: ForcingJumps, chosen: Index, turns: Index) -> None:
        nodes, weights = _rule()
        starts, sizes, counts = [], [], []
        for zone, k in zip(chosen, turns, strict=True):
            cuts = np.concatenate(([0.0], np.sort(jumps.angles(int(zone))), [np.pi]))
            start, size = divided(cuts, np.maximum(np.ceil(np.diff(cuts) * (k / _TURN)), 1.0).astype(np.intp))
            starts.append(start)
            sizes.append(size)
            counts.append(len(size) * _NODES)
        size = np.concatenate(sizes)[:, None]
        self.theta = (np.concatenate(starts)[:, None] + size * nodes).ravel()
        self.weights = (size * weights).ravel()
        self.left, self.right = 2 * np.cos(0.5 * self.theta) ** 2, 2 * np.sin(0.5 * self.theta) ** 2
        self.counts = np.array(counts)
        self.first = np.cumsum(self.counts) - self.counts
        self.turns = turns

    def places(self, zones: Zones, chosen: Index) -> Array:
        """The nodes themselves."""
        w, a, b = (np.repeat(values[chosen], self.counts) for values in (zones.half, zones.a, zones.b))
        return np.where(self.left <= self.right, a + w * self.left, b - w * self.right)

    def sines(self, values: Array) -> Array:
        """(2/pi) int values sin(theta) sin(k theta) dtheta at [:, k], up to each zone's highest k, others zero."""
        out = np.zeros((len(self.turns), int(self.turns.max()) + 1))
        turn = np.exp(1j * self.theta)
        wave = (2 / np.pi) * values * np.sin(self.theta) * self.weights * turn
        # Zones with the most coefficients first: the others drop out on the way.
        order = np.argsort(-self.turns, kind="stable")
        at = np.concatenate([np.arange(self.first[i], self.first[i] + self.counts[i]) for i in order])
        wave, turn = wave[at], turn[at]
        first = np.concatenate(([0], np.cumsum(self.counts[order])))
        for k in range(1, out.shape[1]):
            left = int(np.count_nonzero(self.turns >= k))
            wave, turn = wave[: first[left]], turn[: first[left]]
            out[order[:left], k] = np.add.reduceat(wave.imag, first[:left])
            wave = wave * turn
        return out

    def means(self, values: Array) -> Array:
        """(1/pi) int values dtheta of every zone."""
        return np.asarray(np.add.reduceat(values * self.weights, self.first) / np.pi)


def coefficients(forcing: Forcing, zones: Zones, jumps: ForcingJumps, chosen: Index, m: Index) -> tuple[Array, Array]:
    """(g_k of the right side itself at [:, k], k = 1 ... m, others zero; mean of its primitive, 0 without one) on chosen zones."""
    stretches = Stretches(jumps, chosen, m[chosen])
    x = stretches.places(zones, chosen)
    means = np.zeros(len(chosen)) if forcing.primitive is None else stretches.means(np.asarray(forcing.primitive(x), dtype=float))
    return stretches.sines(np.asarray(forcing.value(x), dtype=float)), means
