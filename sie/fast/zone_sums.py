"""Sums over all zones in linear time, by a tree whose nodes are groups of zones.

Outside a zone, the field of the zone depends on the moments M_l = (1/pi) int phi T_l dxi of its
density phi alone. With the half width w and the coefficients c_l of the density, M_0 = w c_0 and
M_l = w c_l / 2. A node of the tree is treated as one zone that covers all zones of its group. The
field of the node follows in the same way from the node's moments (`sie.basis.interval`).

Moments of children become those of their parent by T_j(alpha + beta s) = sum_k A_jk T_k(s). The
same matrix A takes the Chebyshev series of the far field from a parent to its children. The
potential is stored at the middle of each node only, since its derivative is the transform. The
potential is summed in double-double arithmetic, because conditions use its small differences
between neighbours. So the far field needs no quadrature nodes on the zones. Only near zones
interact directly, by the closed forms of `sie.dense.system`. See L. Greengard
and V. Rokhlin, J. Comput. Phys. 73, 1987, 325-348, here in one dimension and with Chebyshev series.
"""

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any

import numpy as np

from sie.basis import chebyshev, compiled, lazy
from sie.basis.data import DIGITS, Array, Index, numbered
from sie.basis.interval import Outside, decay_rate
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.dense.system import Layout
from sie.trees.far import FarSum, Nested
from sie.trees.panels import Panels, panels_over
from sie.trees.skeleton import Skeleton
from sie.trees.tree import TERMS, Pairs, Tree, apart


class NearSums:
    """Fields of zones on neighbouring zones, in closed form.

    The fields are the transform at the inner Lobatto nodes of each solved zone, and the potential
    at the zone's middle. A large sum of transforms is computed by a compiled loop, a small sum by a
    product with a matrix.
    """

    def __init__(self, zones: Zones, kernel: Kernel, layout: Layout, far: FarSum) -> None:
        self.kernel, self.layout, self.far = kernel, layout, far
        pairs, solved = far.near, zones.solved
        other = ~((solved[pairs.target] == pairs.source) & (pairs.shift == 0.0))
        place, source, shift = pairs.target[other], pairs.source[other], pairs.shift[other]
        zone = solved[place]
        self.place, self.source = place, source
        self.sign, self.gap = apart(zones, Pairs(zone, source, shift))
        self.half, self.width = zones.half[source], zones.half[zone]
        self.nodes = layout.m[solved]  # number of nodes of each solved zone
        # The powers of rho decay most slowly at the node nearest to the source. The decay rate at
        # this node gives the number of powers above round-off.
        nearest = np.array(
            [chebyshev.lobatto(n)[1][min(1, n)] for n in range(int(self.nodes.max(initial=0)) + 1)]
        )
        e = (self.gap + self.width * nearest[self.nodes[place]]) / self.half
        need, most = np.ceil(DIGITS / decay_rate(e) / 8).astype(np.intp) * 8, layout.m[source] + 1
        self.terms = np.minimum(most, need)
        self.rough_terms = np.minimum(most, need // 2)

    @cached_property
    def size(self) -> int:
        """Number of terms of all transforms."""
        return int(self.terms @ self.nodes[self.place])

    def transform(self, y: Array, rough: bool = False) -> Array:
        """Transform at the nodes of all solved zones, from the unknowns y of all zones.

        rough: whether the terms that give half of the digits are enough.
        """
        loops = compiled.loops("near_sums", self.far.terms)
        if loops is None:
            return np.asarray(self._matrix @ y)
        first, nodes = self._by_target
        terms = self.rough_terms if rough else self.terms
        out = np.empty(nodes[0][-1])
        start = self.layout.offset[self.source]
        pairs = first, start, terms, self.sign, self.gap, self.half, self.width
        work = np.concatenate(([0], np.cumsum(terms * self.nodes[self.place])))[first]
        compiled.in_threads(loops.near_fields, work, pairs, y, nodes, out)
        return out

    @cached_property
    def _by_target(self) -> tuple[Index, tuple[Index, Array, Array]]:
        """(index of the first pair of each target zone, nodes of the target zones).

        A pair is a target zone and a source zone near to it. The nodes are three arrays: the index
        of each zone's first node, and the distances of all nodes from the left and the right end.
        """
        numbers, kind = np.unique(self.nodes, return_inverse=True)
        sides = [chebyshev.lobatto(n)[1:] for n in numbers.tolist()]
        start = np.cumsum(numbers) - numbers
        # Zones with equal numbers of nodes have equal nodes.
        at = np.repeat(start[kind], self.nodes) + numbered(self.nodes)
        from_right, from_left = (
            np.concatenate([side[k][1:-1] for side in sides])[at] for k in (0, 1)
        )
        first = np.searchsorted(self.place, np.arange(len(self.nodes) + 1))
        return first, (np.concatenate(([0], np.cumsum(self.nodes))), from_left, from_right)

    @cached_property
    def _matrix(self) -> Any:
        """Sparse matrix from the unknowns of all zones to the transform at all nodes."""
        pointer, at = self._entries(self.nodes)
        data, column = np.empty(pointer[-1]), np.empty(pointer[-1], dtype=np.int32)
        m = self.nodes[self.place]
        key = m * (int(self.terms.max(initial=0)) + 1) + self.terms
        order = np.argsort(key, kind="stable")
        cuts = np.flatnonzero(np.diff(key[order], prepend=-1, append=-1))
        for lo, hi in zip(cuts[:-1], cuts[1:], strict=True):
            group = order[lo:hi]
            nodes, count = int(m[group[0]]), int(self.terms[group[0]])
            if nodes == 0:
                continue
            _, from_right, from_left = chebyshev.lobatto(nodes)
            sign, half = self.sign[group][:, None], self.half[group][:, None]
            away = np.where(sign > 0, from_left[1:-1], from_right[1:-1])
            away = self.gap[group][:, None] + away * self.width[group][:, None]
            power = np.arange(count)
            into = at(group, nodes)[..., None] + power
            data[into] = Outside(sign, away / half).transforms(count)
            column[into] = self.layout.offset[self.source[group]][:, None, None] + power
        return self._sparse(data, column, pointer)

    @cached_property
    def potential(self) -> Any:
        """Sparse matrix from the unknowns of all zones to the potential at their middles."""
        pointer, at = self._entries(np.ones_like(self.nodes))
        data, column = np.empty(pointer[-1]), np.empty(pointer[-1], dtype=np.int32)
        for count in np.unique(self.terms).tolist():
            group, power = np.flatnonzero(self.terms == count), np.arange(count)
            half = self.half[group]
            middle = Outside(self.sign[group], (self.gap[group] + self.width[group]) / half)
            into = at(group, 1) + power
            data[into] = middle.potentials(count, half / self.kernel.datum) * half[:, None]
            column[into] = self.layout.offset[self.source[group]][:, None] + power
        return self._sparse(data, column, pointer)

    def _entries(self, rows: Index) -> tuple[Index, Callable[[Index, int], Index]]:
        """(row pointers of a matrix with `rows` rows for each solved zone, places of its entries).

        The places are returned as a function at(pairs, count), for pairs whose target zones have
        `count` rows. Its value is the place of each pair's first entry in each of these rows.
        """
        per_zone = np.bincount(self.place, self.terms, minlength=len(rows)).astype(np.intp)
        pointer = np.concatenate(([0], np.cumsum(np.repeat(per_zone, rows))))
        first_row = np.cumsum(rows) - rows
        in_row = np.cumsum(self.terms) - self.terms
        in_row -= (np.cumsum(per_zone) - per_zone)[self.place]

        def at(pairs: Index, count: int) -> Index:
            row = first_row[self.place[pairs]][:, None] + np.arange(count)
            return np.asarray(pointer[row] + in_row[pairs][:, None])

        return pointer, at

    def _sparse(self, data: Array, column: Index, pointer: Index) -> Any:
        """The sparse matrix with these entries, columns and row pointers.

        The pointers have the integer type of the columns if possible. Otherwise scipy would copy
        the columns.
        """
        wide = np.int32 if pointer[-1] <= np.iinfo(np.int32).max else np.int64
        return lazy.module("scipy.sparse").csr_array(
            (data, column, pointer.astype(wide)), shape=(len(pointer) - 1, self.layout.size)
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
        """Moments of the density with the unknowns y on the panels, which are parts of the line."""
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
    potential, with the weight 1 / sqrt(1 - t^2), in two parts.
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
        self.near = NearSums(zones, kernel, layout, self.far)
        self.far.near_terms = self.near.size
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
        """Number of terms in one evaluation of the field of all zones.
        These are terms of the fields of neighbouring zones, and of series for zones far apart.
        """
        return self.near.size + len(self.far.far) * TERMS

    def _of_near(self, y: Array, rough: bool) -> tuple[Array, Array]:
        """(transform at the nodes, potential at the middle) of solved zones, due to near zones."""
        return self.near.transform(y, rough), self.near.potential @ y

    def __call__(self, y: Array, rough: bool = False) -> tuple[Array, Array, Array]:
        """Coefficients in U_l of the field on solved zones, and the potential of the field.

        Returns (coefficients, potential at the zone's middle, mean potential minus the potential at
        the middle). rough: whether a far field with an error of 1e-7 of the whole field is accurate
        enough.
        """
        leaves = np.append(y, 0.0)[self.lead] * self.scale
        sums: list[Callable[[], Any]] = [
            partial(self.far, leaves, rough),
            partial(self._of_near, y, rough),
        ]
        # Much of the far sum runs in one thread. So another thread computes the near sum.
        is_long = self.far.terms > 2 * compiled.TERMS_PER_THREAD and compiled.threads() > 1
        far, near = compiled.together(sums) if is_long else [one() for one in sums]
        (series, middle, mean), (at_nodes, of_near) = far, near
        mean = mean + of_near
        if self.smooth is not None:
            seen, potential = self.smooth.at_targets(self.smooth.moments(y))
            at_nodes, middle = at_nodes + seen, middle + potential
        zones, solved = self.zones, self.zones.solved
        in_u = 0.5 * series
        in_u[:, :-2] -= 0.5 * series[:, 2:]
        in_u[:, 0] += 0.5 * series[:, 0]
        rows = np.empty(len(at_nodes))
        for m, group in self.groups:
            if m == 0:
                continue
            place = self.first_row[group][:, None] + np.arange(m)
            u = chebyshev.u_coefficients(at_nodes[place])
            count = min(m, TERMS)
            u[:, :count] += in_u[group, :count]
            rows[place] = u
            # The potential of U_{k-1} is T_k / k up to a constant. The mean of T_k / k over the
            # angle is 0, and T_k / k at the middle is cos(k pi / 2) / k. So `to_mean` is the mean
            # of the potential minus the potential at the middle.
            k = np.arange(2, m + 1, 2)
            to_mean = -np.cos(0.5 * np.pi * k) / k
            mean[group] += zones.half[solved[group]] * (u[:, 1::2] @ to_mean)
        return rows, middle, mean
