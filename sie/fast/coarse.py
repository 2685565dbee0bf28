"""The coarse problem of the preconditioner: zones that interact through their totals alone.

The density on each zone is c_0 / sqrt(1 - t^2), like the pressure under a flat punch. Its total is
the load of the zone.
"""

from dataclasses import dataclass

import numpy as np

from sie.basis.data import Array, Index
from sie.basis.zones import Zones
from sie.fast.system import IterativeSystem
from sie.trees.hierarchical import Inverse


@dataclass(frozen=True)
class CoarseOptions:
    """Options of the preconditioner's coarse problem, which has one unknown load for each zone."""

    # Relative accuracy of the hierarchical inverse of the coarse matrix, which has one unknown for
    # each zone. The coarse problem itself is less accurate, since it neglects how the field of one
    # zone varies over another zone. With tolerances from 1e-4 to 1e-2 the number of iterations is
    # the same.
    tolerance: float = 1e-2
    # The inverse of the coarse matrix is reused for moved zones if the ends' mean motion is at most
    # this fraction of the zone width, and no end has moved by more than one zone width. The
    # potential that a zone's own load causes on the zone may change by at most this fraction, too.
    # This potential contains the logarithm of the zone's width. Without this limit, the inverse
    # would be reused for a zone beside a plateau that becomes a thousand times narrower in a step.
    kept_move: float = 0.1


_OPTIONS = CoarseOptions()


class CoarseOperator:
    """Matrix from the coefficients c_0 of all zones to their mean potentials, and its inverse.

    The density of a zone is c_0 / sqrt(1 - t^2) in this coarse problem of the preconditioner. A
    constant (`lowered`) times the total load is subtracted from the potentials, which makes the
    matrix definite.
    """

    def __init__(self, zones: Zones, system: IterativeSystem) -> None:
        self.zones, self.kernel = zones, system.equation.kernel
        solved = zones.solved
        self.springs = np.zeros(len(solved))
        ends = np.array([0, len(solved) - 1])
        w = zones.half[solved]
        self.lowered = 0.0
        self.lowered = 1.0 + float(
            (
                self.entries(ends[:, None], np.arange(len(solved))) / (w * system.multiplicity())
            ).max()
        )
        self.springs, self.own = system.springs, self._own_potentials(system)
        self.inverse = Inverse(self.entries, len(solved), _OPTIONS.tolerance)

    def entries(self, rows: Index, columns: Index) -> Array:
        solved, count = self.zones.solved, len(self.zones)
        i, j = solved[rows], solved[columns]
        out = self._of(i, j)
        if self.zones.symmetric:
            mirror = count - 1 - j
            out = out + np.where(mirror == j, 0.0, self._of(i, mirror))
        return out + np.where(i == j, self.springs[rows], 0.0)

    def _of(self, i: Index, j: Index) -> Array:
        zones, kernel = self.zones, self.kernel
        x, xi, w = zones.middle[i], zones.middle[j], zones.half[j]
        # The density 1 / sqrt(w^2 - x^2) on a zone of half width w has, with D = `kernel.datum`,
        # the potential log((d + sqrt(d^2 - w^2)) / 2D) at the distance d from the zone's middle,
        # and log(w / 2D) on the zone. One logarithm of a product serves all poles of the kernel.
        product, away = np.ones(np.broadcast(i, j).shape), x - xi
        for shift in kernel.poles:
            d = np.maximum(np.abs(away - shift), w)
            product *= (0.5 / kernel.datum) * (d + np.sqrt((d - w) * (d + w)))
        out = np.log(product) + np.where(i == j, zones.depth[i], 0.0)
        if kernel.regular_potential is not None:
            out += kernel.regular_potential(x, xi)
        return np.asarray(w * (out - self.lowered))

    def _own_potentials(self, system: IterativeSystem) -> Array:
        """Mean potential on each solved zone by its own c_0 = 1, divided by the half width."""
        solved = system.zones.solved
        w, depth = system.zones.half[solved], system.zones.depth[solved]
        return np.asarray(
            np.log(w / (2 * self.kernel.datum)) + depth - self.lowered + system.springs / w
        )

    def serves(self, system: IterativeSystem) -> bool:
        """Whether the inverse may be reused for `system`, whose zones may have moved slightly."""
        zones, move = system.zones, _OPTIONS.kept_move
        if len(zones) != len(self.zones) or zones.symmetric != self.zones.symmetric:
            return False
        own = self._own_potentials(system)
        if np.any(np.abs(own - self.own) > move * np.abs(self.own)):
            return False
        moved = np.maximum(np.abs(zones.a - self.zones.a), np.abs(zones.b - self.zones.b))
        part = moved / (self.zones.b - self.zones.a)
        return bool(part.max() <= 1.0 and np.mean(part) <= move)
