"""Transform and potential of a density with many zones at many points, by a tree.

The line is cut into cells: the zones, and parts of the gaps between them. On each cell, the field
of all distant zones is one Chebyshev series, computed once by a fast sum. At a point, this series
is evaluated and the fields of the few near zones are added in closed form.
"""

import weakref
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebint

from sie.basis.data import Array, Index, numbered
from sie.basis.interval import What
from sie.basis.sums import OPTIONS, stretches
from sie.density.plane import Plane
from sie.density.series import Series, from_zones
from sie.trees.cells import cells_around
from sie.trees.far import FarSum, Nested
from sie.trees.piecewise import clenshaw
from sie.trees.tree import TERMS, Tree


class Treecode:
    """Transform and potential of a density with many zones, by Chebyshev series on cells.
    A cell is a zone or a part of a gap in the central period. Its series is the field of distant
    zones.
    """

    def __init__(self, density: Series) -> None:
        # `self.density` is a weak reference, because the density refers to this object. A reference
        # cycle would delay the release of both objects.
        self.density: Series = weakref.proxy(density)  # type: ignore[assignment]
        zones, period = density.zones, density.kernel.period
        first, last = float(zones.a[0]), float(zones.b[-1])
        middle = 0.5 * (first + last)
        # Without a period, the cells extend beyond all zones on either side by `last` - `first`,
        # the distance from the first to the last end. At points farther away, the moments of all
        # zones together suffice.
        reach = 0.5 * period if period is not None else 1.5 * (last - first)
        self.ends = ends = cells_around(
            zones.a, zones.b, min(middle - reach, first), max(middle + reach, last)
        )
        self.middle, self.half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
        sources = Nested(Tree.over(zones.a, zones.b, zones.rest), kept=False)
        far = FarSum(sources, Nested(Tree.over(ends[:-1], ends[1:]), kept=False), density.kernel)
        near = far.near
        self.source, self.shift = near.source, near.shift
        self.start = np.searchsorted(near.target, np.arange(len(self.middle) + 1))
        self.series, value, rest = far(
            density.first(TERMS) * zones.half[:, None] * np.where(np.arange(TERMS), 0.5, 1.0)
        )
        self.value = value + rest

    @cached_property
    def potential_series(self) -> Array:
        """Chebyshev series of the potential of distant zones, on each cell of the line.
        A cell is a zone or a part of a gap.

        It is the primitive of the transform's series that has the known value at the middle.
        """
        out = chebint(self.series, axis=1) * self.half[:, None]
        out[:, 0] += self.value
        return np.asarray(out)

    def transform(self, x: Array) -> Array:
        """Transform of the density at real points x (n,) within the central period."""
        return self._summed(x, self.series, False)

    def potential(self, x: Array) -> Array:
        """Potential of the density at real points x (n,) within the central period."""
        return self._summed(x, self.potential_series, True)

    def _summed(self, x: Array, series: Array, potential: bool) -> Array:
        """Transform at points x, or the potential if `potential` is true.

        It is the sum of `series` of the point's cell and of closed forms of near zones.
        """
        out = np.empty(len(x))
        order = np.argsort(x, kind="stable")
        cell = np.searchsorted(self.ends, x[order], side="right") - 1
        # With a period, points can be outside the cells by round-off only.
        outside = ((cell < 0) | (x[order] > self.ends[-1])) & (self.density.kernel.period is None)
        beyond = order[outside]
        if len(beyond):
            out[beyond] = self._beyond(x[beyond], potential)
        order, cell = order[~outside], np.clip(cell[~outside], 0, len(self.middle) - 1)
        table = np.ascontiguousarray(series.T)
        for here in stretches(self.start[cell + 1] - self.start[cell] + 4, OPTIONS.memory_pairs):
            places, cells = order[here], cell[here]
            part = x[places]
            with np.errstate(divide="ignore", invalid="ignore"):
                t = np.where(
                    self.half[cells] > 0, (part - self.middle[cells]) / self.half[cells], 0.0
                )
            value = clenshaw(table, cells, np.clip(t, -1.0, 1.0))
            count = self.start[cells + 1] - self.start[cells]
            row = np.repeat(np.arange(len(part)), count)
            pair = numbered(count) + np.repeat(self.start[cells], count)
            near = self._near(part[row], self.source[pair], self.shift[pair], potential)
            out[places] = value + np.bincount(row, near, minlength=len(part))
        return out

    def _beyond(self, x: Array, potential: bool) -> Array:
        """Transform, or potential if `potential` is true, at points x outside all cells."""
        plane: Plane = self.density.plane  # type: ignore[assignment]
        what: What = "potential" if potential else "transform"
        return np.asarray(plane.poles(x, np.zeros(len(x)), (what,))[0].real)

    def _near(self, x: Array, source: Index, shift: Array, potential: bool) -> Array:
        """Closed-form field, at each point x, of the zone `source`, which is moved by `shift`."""
        return from_zones(self.density, x, source, shift, potential)
