"""Unknowns of a symmetric set of zones: those that are kept, and how the mirrored ones follow from them."""

from __future__ import annotations

import numpy as np

from sie.basis.data import Array, Index, numbered, record
from sie.basis.zones import Zones
from sie.collocation.system import Layout


@record
class MirrorSymmetry:
    """keep: the kept unknowns; of a symmetric set, unknowns `follow` are `sign` times those at `source`."""

    whole: int
    keep: Index | None
    follow: Index
    sign: Array
    source: Index

    @classmethod
    def of(cls, zones: Zones, layout: Layout) -> MirrorSymmetry:
        none = np.zeros(0, dtype=np.intp)
        if not zones.symmetric:
            return cls(layout.size, None, none, np.zeros(0), none)
        count = len(zones)
        pairs = zones.solved[1:] if zones.central else zones.solved
        keep = []
        if zones.central:
            middle = zones.solved[0]
            keep.append(layout.offset[middle] + np.arange(0, layout.m[middle] + 1, 2))
        size = layout.m[pairs] + 1
        k = numbered(size)
        source = np.repeat(layout.offset[pairs], size) + k
        follow = np.repeat(layout.offset[count - 1 - pairs], size) + k
        keep += [source, layout.coefficients + np.arange(layout.columns)]
        return cls(layout.size, np.concatenate(keep), follow, np.asarray(1.0 - 2.0 * (k % 2), dtype=np.float64), source)

    @property
    def size(self) -> int:
        return self.whole if self.keep is None else len(self.keep)

    def position(self, unknowns: Index) -> Index:
        """Where kept unknowns stand among the kept ones."""
        if self.keep is None:
            return unknowns
        places = np.full(self.whole, -1, dtype=np.intp)
        places[self.keep] = np.arange(len(self.keep))
        return np.asarray(places[unknowns])

    def fold(self, matrix: Array) -> Array:
        """Columns of mirrored zones added to those they follow from; the others dropped."""
        if self.keep is None:
            return matrix
        matrix[:, self.source] += matrix[:, self.follow] * self.sign
        return np.asarray(matrix[:, self.keep])

    def unfold(self, y: Array) -> Array:
        if self.keep is None:
            return y
        out = np.zeros(self.whole)
        out[self.keep] = y
        out[self.follow] = self.sign * out[self.source]
        return out
