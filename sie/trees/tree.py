"""A binary tree over ascending intervals, and the pairs of nodes far from each other.

Nodes are the hulls of the intervals they hold. A node is split at the middle of its hull, and a
leaf is one interval. Two nodes are *far* if the gap between them is at least `SEPARATION` times the
larger half width. Let z be a distance from the middle of one node, divided by its half width. All
points of the other node then have z >= 1 + SEPARATION. So series of `TERMS` Chebyshev terms have
the error rho^TERMS < 1e-16, with rho = z - sqrt(z^2 - 1).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from sie.basis.data import Array, Index, record
from sie.basis.zones import Zones

TERMS = 24
SEPARATION = 1.45


@record
class Tree:
    """Binary tree over intervals; its n nodes are stored level by level, with the root first.

    lo, hi: ends of their hulls; left, right: children (-1 for a leaf); parent: parent (-1 for the
    root); item: the interval of a leaf (-1 for other nodes); levels: first node of every level,
    then n; rest: part of the ends of leaves below the last digit (2, n), zero for other nodes;
    parted: for each two neighbouring intervals, the width of the smallest node that contains both.
    """

    lo: Array
    hi: Array
    left: Index
    right: Index
    parent: Index
    item: Index
    levels: list[int]
    rest: Array
    parted: Array

    @cached_property
    def half(self) -> Array:
        return np.asarray(0.5 * ((self.hi - self.lo) + (self.rest[1] - self.rest[0])))

    @classmethod
    def over(cls, a: Array, b: Array, rest: Array | None = None) -> Tree:
        """The tree over the intervals [a, b], which are in ascending order.

        rest: part of their ends below the last digit (2, n).
        """
        middle, parted = 0.5 * (a + b), np.zeros(max(len(a) - 1, 0))
        narrower = np.minimum((b - a)[1:], (b - a)[:-1])
        first, last = np.zeros(1, dtype=np.intp), np.array([len(a) - 1])
        parents = [np.array([-1], dtype=np.intp)]
        firsts, lasts, lefts, levels = [first], [last], [], [0]
        count = 1
        while True:
            inner = first < last
            left = np.full(len(first), -1, dtype=np.intp)
            lefts.append(left)
            levels.append(count)
            if not inner.any():
                break
            f, e = first[inner], last[inner]
            cut = np.searchsorted(middle, 0.5 * (a[f] + b[e]))
            cut = _between_wide(np.clip(cut, f + 1, e), f, e, narrower)
            parted[cut - 1] = b[e] - a[f]
            left[inner] = count + 2 * np.arange(len(f))
            parents.append(np.repeat(np.flatnonzero(inner) + levels[-2], 2))
            first, last = np.column_stack((f, cut)).ravel(), np.column_stack((cut - 1, e)).ravel()
            firsts.append(first)
            lasts.append(last)
            count += len(first)
        start, end, children = np.concatenate(firsts), np.concatenate(lasts), np.concatenate(lefts)
        item = np.where(start == end, start, -1)
        right = np.where(children >= 0, children + 1, -1)
        kept = np.zeros((2, len(item)))
        if rest is not None:
            kept[:, item >= 0] = rest[:, item[item >= 0]]
        return cls(
            a[start], b[end], children, right, np.concatenate(parents), item, levels, kept, parted
        )

    def __len__(self) -> int:
        return len(self.lo)

    @cached_property
    def leaves(self) -> Index:
        """Index of the leaf of each interval, in the order of the intervals."""
        nodes = np.flatnonzero(self.item >= 0)
        return nodes[np.argsort(self.item[nodes])]


def _between_wide(cut: Index, first: Index, last: Index, narrower: Array) -> Index:
    """Positions at which nodes are split, moved to where the intervals on both sides are wide.

    A cut is moved by at most the square root of the number of intervals in the node.
    The potential difference of two intervals separated by a cut has a round-off that is relative to
    the whole node. Narrow intervals would be affected most.
    """
    reach = np.sqrt(last - first).astype(np.intp)
    at = cut[:, None] + np.arange(-reach.max(), reach.max() + 1)
    within = (np.abs(at - cut[:, None]) <= reach[:, None]) & (at > first[:, None])
    within &= at <= last[:, None]
    width = np.where(within, narrower[np.clip(at - 1, 0, len(narrower) - 1)], -1.0)
    return at[np.arange(len(cut)), np.argmax(width, axis=1)]


@record
class Pairs:
    """Pairs of a target and a source (nodes or intervals); each source is moved by `shift`."""

    target: Index
    source: Index
    shift: Array

    @classmethod
    def joined(cls, parts: list[Pairs]) -> Pairs:
        """All pairs of several lists of pairs, sorted by their target."""
        target = np.concatenate([p.target for p in parts])
        order = np.argsort(target, kind="stable")
        source, shift = (
            np.concatenate([getattr(p, name) for p in parts])[order] for name in ("source", "shift")
        )
        return cls(target[order], source, shift)

    def __len__(self) -> int:
        return len(self.target)


def apart(zones: Zones, pairs: Pairs) -> tuple[Array, Array]:
    """(1 or -1 if the target zone is right or left of the source zone, gap between them)."""
    t, s, shift = pairs.target, pairs.source, pairs.shift
    right = zones.middle[t] > zones.middle[s] + shift
    past = (zones.a[t] - (zones.b[s] + shift)) + (zones.rest[0, t] - zones.rest[1, s])
    before = ((zones.a[s] + shift) - zones.b[t]) + (zones.rest[0, s] - zones.rest[1, t])
    return np.where(right, 1.0, -1.0), np.where(right, past, before)


def interactions(targets: Tree, sources: Tree, shifts: tuple[float, ...]) -> tuple[Pairs, Pairs]:
    """(pairs of nodes far from each other, pairs of intervals near each other).

    Together they contain each pair of intervals exactly once for each shift.
    """
    far, near = [], []
    t_half, s_half = targets.half, sources.half
    for shift in shifts:
        t, s = np.zeros(1, dtype=np.intp), np.zeros(1, dtype=np.intp)
        while len(t):
            gap = np.maximum(
                targets.lo[t] - (sources.hi[s] + shift), (sources.lo[s] + shift) - targets.hi[t]
            )
            apart = gap >= SEPARATION * np.maximum(t_half[t], s_half[s])
            far.append(Pairs(t[apart], s[apart], np.full(int(apart.sum()), shift)))
            t, s = t[~apart], s[~apart]
            t_leaf, s_leaf = targets.left[t] < 0, sources.left[s] < 0
            both = t_leaf & s_leaf
            near.append(
                Pairs(targets.item[t[both]], sources.item[s[both]], np.full(int(both.sum()), shift))
            )
            # The wider of the two nodes is split, or the other one if the wider one is a leaf.
            cut_t = ~t_leaf & (s_leaf | (t_half[t] >= s_half[s]))
            cut_s = ~both & ~cut_t
            t, s = (
                np.concatenate(
                    (targets.left[t[cut_t]], targets.right[t[cut_t]], t[cut_s], t[cut_s])
                ),
                np.concatenate(
                    (s[cut_t], s[cut_t], sources.left[s[cut_s]], sources.right[s[cut_s]])
                ),
            )
    return Pairs.joined(far), Pairs.joined(near)
