"""Sums over all zones in linear time, by a tree whose nodes are equivalent zones.

Outside a zone its field depends on the moments M_l = (1/pi) int phi T_l dxi of its density phi
alone. With the half width w and the coefficients c_l of the density, M_0 = w c_0 and
M_l = w c_l / 2. A node of the tree is a group of zones, treated as one zone that covers them all.
Its field follows in the same way from its moments (`sie.basis.interval`).

Moments of children become those of their parent by T_j(alpha + beta s) = sum_k A_jk T_k(s). The
same matrix A takes the Chebyshev series of the far field from a parent to its children. Of the
potential only the value at the middle of each node is stored, since its derivative is the
transform. The potential is summed in double-double arithmetic, because conditions use its small
differences between neighbours. So the far field needs no quadrature nodes on the zones. Only near
zones interact directly, by the closed forms of `sie.dense.system`. See L. Greengard
and V. Rokhlin, J. Comput. Phys. 73, 1987, 325-348, here in one dimension and with Chebyshev series.
"""

from typing import Any

import numpy as np

from sie.basis import chebyshev, lazy
from sie.basis.data import DIGITS, Array, record
from sie.basis.interval import Outside, decay_rate
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.dense.system import Layout
from sie.trees.far import FarSum, Nested
from sie.trees.panels import Panels, panels_over
from sie.trees.skeleton import Skeleton
from sie.trees.tree import TERMS, Pairs, Tree


@record
class NearRows:
    """Sparse matrices from the unknowns of zones to their fields on neighbouring zones.

    transform: at the inner Lobatto nodes of each solved zone; potential: at their middles.
    """

    transform: Any
    potential: Any

    @classmethod
    def of(cls, zones: Zones, kernel: Kernel, layout: Layout, pairs: Pairs) -> "NearRows":
        solved = zones.solved
        other = ~((solved[pairs.target] == pairs.source) & (pairs.shift == 0.0))
        place, source, shift = pairs.target[other], pairs.source[other], pairs.shift[other]
        zone = solved[place]
        right = zones.middle[zone] > zones.middle[source] + shift
        sign = np.where(right, 1.0, -1.0)
        past = (zones.a[zone] - (zones.b[source] + shift)) + (
            zones.rest[0, zone] - zones.rest[1, source]
        )
        before_it = ((zones.a[source] + shift) - zones.b[zone]) + (
            zones.rest[0, source] - zones.rest[1, zone]
        )
        gap = np.where(right, past, before_it)
        half, width, m = zones.half[source], zones.half[zone], layout.m[zone]
        # The powers of rho decay most slowly at the node nearest to the source. The decay rate at
        # this node gives the number of powers above round-off.
        e = (
            gap
            + width
            * np.array(
                [chebyshev.lobatto(int(n))[1][min(1, n)] for n in range(int(m.max(initial=0)) + 1)]
            )[m]
        ) / half
        need = np.ceil(DIGITS / decay_rate(e) / 8).astype(np.intp) * 8
        terms = np.minimum(layout.m[source] + 1, need)
        per_zone = np.bincount(place, terms, minlength=len(solved)).astype(np.intp)
        before = np.cumsum(terms) - terms
        start = np.concatenate(([0], np.cumsum(per_zone)))[place]
        in_row = before - start
        rows = layout.m[solved]
        pointer = np.concatenate(([0], np.cumsum(np.repeat(per_zone, rows))))
        first_row = np.concatenate(([0], np.cumsum(rows)))
        data, column = np.empty(pointer[-1]), np.empty(pointer[-1], dtype=np.int32)
        pot_data, pot_column = (
            np.empty(int(per_zone.sum())),
            np.empty(int(per_zone.sum()), dtype=np.int32),
        )
        key = m * (int(terms.max(initial=0)) + 1) + terms
        order = np.argsort(key, kind="stable")
        cuts = np.flatnonzero(np.diff(key[order], prepend=-1, append=-1))
        for lo, hi in zip(cuts[:-1], cuts[1:], strict=True):
            group = order[lo:hi]
            nodes, count = int(m[group[0]]), int(terms[group[0]])
            power = np.arange(count)
            columns = layout.offset[source[group]][:, None] + power
            middle = Outside(sign[group], (gap[group] + width[group]) / half[group])
            values = middle.potentials(count, half[group] / kernel.datum)
            at = before[group][:, None] + power
            pot_data[at], pot_column[at] = values * half[group][:, None], columns
            if nodes == 0:
                continue
            _, from_right, from_left = chebyshev.lobatto(nodes)
            away = (
                np.where(right[group][:, None], from_left[1:-1], from_right[1:-1])
                * width[group][:, None]
            )
            seen = Outside(
                sign[group][:, None], (gap[group][:, None] + away) / half[group][:, None]
            )
            row = first_row[place[group]][:, None] + np.arange(nodes)
            into = (pointer[row] + in_row[group][:, None])[..., None] + power
            data[into] = seen.transforms(count)
            column[into] = columns[:, None, :]
        sparse = lazy.module("scipy.sparse")
        size = layout.size
        potential_pointer = np.concatenate(([0], np.cumsum(per_zone)))
        # The row pointers have the integer type of the column indices if possible. Otherwise scipy
        # would copy the column indices.
        wide = np.int32 if pointer[-1] <= np.iinfo(np.int32).max else np.int64
        return cls(
            sparse.csr_array((data, column, pointer.astype(wide)), shape=(len(pointer) - 1, size)),
            sparse.csr_array(
                (pot_data, pot_column, potential_pointer.astype(wide)), shape=(len(solved), size)
            ),
        )


class PanelSums:
    """Field of the kernel's smooth regular part on the solved zones, by sums over panels."""

    def __init__(self, panels: Panels | Skeleton, zones: Zones, layout: Layout) -> None:
        self.panels, self.zones = panels, zones
        modes, solved = panels.modes(zones.half), zones.solved
        count = np.minimum(layout.m, modes) + 1
        self.groups = []
        nodes = []
        for q, k in np.unique(np.column_stack((modes + 2, count)), axis=0):
            some = np.flatnonzero((modes + 2 == q) & (count == k))
            self.groups.append(
                (layout.offset[some][:, None] + np.arange(k), zones.half[some][:, None] / q, int(q))
            )
            nodes.append(
                (
                    zones.middle[some][:, None]
                    + zones.half[some][:, None] * chebyshev.gauss(int(q))
                ).ravel()
            )
        self.sources = panels.spread(np.concatenate(nodes))
        inner = [
            zones.middle[i] + zones.half[i] * chebyshev.lobatto(int(layout.m[i]))[0][1:-1]
            for i in solved
        ]
        self.targets, self.middles = (
            panels.spread(np.concatenate(inner)),
            panels.spread(zones.middle[solved]),
        )

    def moments(self, y: Array) -> Array:
        """Moments, on the panels, of the density with unknowns y.
        Panels are equal parts of the line.
        """
        weights = [
            (chebyshev.t_values(y[columns], q) * scale).ravel() for columns, scale, q in self.groups
        ]
        return self.panels.moments(self.sources, np.concatenate(weights))

    def at_targets(self, moments: Array) -> tuple[Array, Array]:
        """(transform at the inner nodes, potential at the middle) of each solved zone.
        Both are fields of the kernel's regular part.
        """
        transform = self.panels.at(self.targets, moments, False)
        if self.panels.kernel.regular_potential is None:  # then no condition asks for potentials
            return transform, np.zeros(len(self.zones.solved))
        return transform, self.panels.at(self.middles, moments, True)


class ZoneSums:
    """Field of all zones and their images on each solved zone, without the zone's own field.

    Calls return the coefficients of the transform in Chebyshev polynomials U, and the mean of the
    potential with weight 1 / sqrt(1 - t^2).
    """

    def __init__(self, zones: Zones, kernel: Kernel, layout: Layout) -> None:
        self.zones, self.kernel, self.layout = zones, kernel, layout
        solved = zones.solved
        sources = Nested(Tree.over(zones.a, zones.b, zones.rest))
        part = zones.rest[:, solved]
        targets = (
            Nested(Tree.over(zones.a[solved], zones.b[solved], part))
            if zones.symmetric
            else sources
        )
        self.far = FarSum(sources, targets, kernel)
        self.near = NearRows.of(zones, kernel, layout, self.far.near)
        m = layout.m[solved]
        self.first_row = np.concatenate(([0], np.cumsum(m)))
        self.groups = [(int(n), np.flatnonzero(m == n)) for n in np.unique(m)]
        k = np.arange(TERMS)
        self.lead = np.where(k <= layout.m[:, None], layout.offset[:, None] + k, layout.size)
        self.scale = zones.half[:, None] * np.where(k, 0.5, 1.0)
        panels = panels_over(kernel, zones)
        self.smooth = None if panels is None else PanelSums(panels, zones, layout)

    @property
    def size(self) -> int:
        """Number of terms of one evaluation of the field of all zones.
        Counted are entries of the matrix for neighbouring zones, and terms of series for zones far
        apart.
        """
        return int(self.near.transform.nnz) + len(self.far.far) * TERMS

    def __call__(self, y: Array, rough: bool = False) -> tuple[Array, Array, Array]:
        """Coefficients in U_l of the field on solved zones, and the potential of the field.

        Returns (coefficients, potential at the zone's middle, mean potential minus that). rough:
        whether a far field with an error of 1e-7 of the whole field is accurate enough.
        """
        leaves = np.append(y, 0.0)[self.lead] * self.scale
        series, middle, mean = self.far(leaves, rough)
        mean = mean + self.near.potential @ y
        at_nodes = self.near.transform @ y
        if self.smooth is not None:
            seen, potential = self.smooth.at_targets(self.smooth.moments(y))
            at_nodes, middle = at_nodes + seen, middle + potential
        zones, solved = self.zones, self.zones.solved
        far = 0.5 * series
        far[:, :-2] -= 0.5 * series[:, 2:]
        far[:, 0] += 0.5 * series[:, 0]
        rows = np.empty(len(at_nodes))
        for m, group in self.groups:
            if m == 0:
                continue
            place = self.first_row[group][:, None] + np.arange(m)
            u = chebyshev.u_coefficients(at_nodes[place])
            count = min(m, TERMS)
            u[:, :count] += far[group, :count]
            rows[place] = u
            # The potential of U_{k-1} is T_k / k up to a constant. The mean of T_k / k over the
            # angle is 0, and T_k / k at the middle is cos(k pi / 2) / k. So `to_mean` is the mean
            # of the potential minus the potential at the middle.
            k = np.arange(2, m + 1, 2)
            to_mean = -np.cos(0.5 * np.pi * k) / k
            mean[group] += zones.half[solved[group]] * (u[:, 1::2] @ to_mean)
        return rows, middle, mean
