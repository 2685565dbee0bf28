"""The low rank of a smooth kernel of both places: a few places on zones stand for all of them.

    k(x, xi) = sum_j k(x, s_j) P_j(xi)        x, xi on zones,

and the same for its potential, with the same P. The places s_j are the columns that a pivoted QR of
k on a few hundred places picks, and P_j(xi) solves the equation at as many rows (H. Cheng, Z.
Gimbutas, P. G. Martinsson and V. Rokhlin, SIAM J. Sci. Comput. 26, 2005, 1389-1404). The field of
zones follows from the moments sum_q w_q P_j(xi_q), charges at s_j. So the kernel is called on zones
only, and off them where a value there is asked for.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import linalg

from sie.basis import chebyshev
from sie.basis.data import Array, Index, Kept, record
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones


@dataclass(frozen=True)
class SkeletonOptions:
    """Options of the skeleton of a smooth kernel."""

    # A column that adds less than this, relative to the largest, is rounding. `max_error` is the
    # largest error of the skeleton at other places.
    decayed: float = 1e-15
    max_error: float = 1e-12
    # Nodes on each zone, in turn, that show the number of modes of the kernel there; coefficients
    # below `rounding` are noise; `sampled_places` places of the skeleton are sampled for that.
    sizes: tuple[int, ...] = (24, 48, 96, 192, 384, 768)
    rounding: float = 1e-14
    sampled_places: int = 8
    # Skeletons kept with a kernel.
    kept_with_kernel: int = 24


SKELETON = SkeletonOptions()


@record
class Skeleton(Kept):
    """Places s (r,) that stand for all sources, and rows that determine the shares of others.

    of_row, x_of_row: function (0: regular part, 1: potential) and place x of each row; factors: LU
    factors of the kernel there; scale: largest values of both functions.
    """

    kernel: Kernel
    zones: Zones
    places: Array
    of_row: Index
    x_of_row: Array
    factors: Any
    scale: Array

    @property
    def size(self) -> int:
        """Number of moments."""
        return len(self.places)

    def modes(self, half: Array) -> Index:
        """Number of modes by which the kernel acts on each zone of `zones`."""
        return self._modes

    @cached_property
    def _modes(self) -> Index:
        some = self.places[:: max(1, len(self.places) // SKELETON.sampled_places)]
        regular = _functions(self.kernel)[0]
        out, pending, largest = (
            np.full(len(self.zones), SKELETON.sizes[-1]),
            np.arange(len(self.zones)),
            self.scale[0],
        )
        for q in SKELETON.sizes:
            x = self.zones.middle[pending, None] + self.zones.half[pending, None] * chebyshev.gauss(
                q
            )
            values = np.array([regular(x, some[:, None, None]), regular(some[:, None, None], x)])
            size = np.abs(chebyshev.t_means(values)).max(axis=(0, 1))
            seen = (size > SKELETON.rounding * largest) * np.arange(q)
            last = seen.max(axis=1)
            known = last < q - q // 6
            out[pending[known]] = last[known] + 2
            pending = pending[~known]
            if len(pending) == 0:
                break
        return out

    def spread(self, x: Array) -> Seen:
        """Points, as sources or as targets."""
        return Seen(self, x)

    def shares(self, xi: Array) -> Array:
        """P_j at sources xi (n,), (n, r)."""
        functions = _functions(self.kernel)
        rows = np.empty((len(self.x_of_row), len(xi)))
        for number, function in enumerate(functions):
            here = np.flatnonzero(self.of_row == number)
            if len(here):
                rows[here] = function(self.x_of_row[here, None], xi) / self.scale[number]
        return np.asarray(linalg.lu_solve(self.factors, rows, check_finite=False).T)

    def moments(self, spread: Any, weights: Array) -> Array:
        """Moments (r, ...) of weights (n, ...) at points."""
        return np.asarray(np.tensordot(spread.as_sources, weights, axes=(0, 0)))

    def at(self, spread: Any, moments: Array, potential: bool) -> Array:
        """Transform or potential at points, (n, ...), from moments (r, ...)."""
        return np.asarray(spread.as_targets(potential) @ moments)


class Seen:
    """Points (n,) with the skeleton's matrices for them."""

    def __init__(self, skeleton: Skeleton, x: Array) -> None:
        self.skeleton, self.x = skeleton, x
        self._targets: dict[bool, Array] = {}

    @cached_property
    def as_sources(self) -> Array:
        """P_j at the points (n, r)."""
        return self.skeleton.shares(self.x)

    def as_targets(self, potential: bool) -> Array:
        """The kernel or its potential between the points and the places of the skeleton (n, r)."""
        if potential not in self._targets:
            kernel = self.skeleton.kernel
            function = kernel.regular_potential if potential else kernel.regular
            if function is None:
                raise ValueError("a condition on potentials needs the regular kernel's potential")
            self._targets[potential] = np.asarray(
                function(self.x[:, None], self.skeleton.places), dtype=float
            )
        return self._targets[potential]


def skeleton_of(kernel: Kernel, zones: Zones) -> Skeleton | None:
    """The skeleton of the kernel's regular part on zones; None if its rank is too high."""
    # To find that the rank is too high takes longest, so it is not tried again for as many zones.
    key, too_high = zones.table.tobytes(), ("rank", len(zones))
    if too_high in kernel.kept_panels:
        return None
    if key not in kernel.kept_panels:
        if len(kernel.kept_panels) >= SKELETON.kept_with_kernel:
            kernel.kept_panels.clear()
        kernel.kept_panels[key] = _made(kernel, zones)
    found: Skeleton | None = kernel.kept_panels[key]
    if found is None:
        kernel.kept_panels[too_high] = None
    return found


def _made(kernel: Kernel, zones: Zones) -> Skeleton | None:
    functions = _functions(kernel)
    for count in SKELETON.sizes[2:]:
        x, xi = _some(zones, count, 0), _some(zones, count, 1)
        tables = [np.asarray(function(x[:, None], xi), dtype=float) for function in functions]
        scale = np.array([np.abs(table).max() for table in tables])
        if not np.isfinite(scale).all():
            return None
        scale[scale == 0.0] = 1.0
        table = np.concatenate([one / size for one, size in zip(tables, scale, strict=True)])
        triangle, order = linalg.qr(table, mode="r", pivoting=True, check_finite=False)
        size = np.abs(np.diagonal(triangle))
        rank = max(int(np.count_nonzero(size > SKELETON.decayed * size[0])), 1)
        if rank > len(xi) // 2:
            continue
        chosen = table[:, order[:rank]]
        rows = linalg.qr(chosen.T, mode="r", pivoting=True, check_finite=False)[1][:rank]
        # For a kernel that is zero, any place serves.
        factors = linalg.lu_factor(
            chosen[rows] if size[0] > 0.0 else np.eye(rank), check_finite=False
        )
        found = Skeleton(
            kernel, zones, xi[order[:rank]], rows // len(x), x[rows % len(x)], factors, scale
        )
        if _misses(found, _some(zones, count, 2), _some(zones, count, 3)) <= SKELETON.max_error:
            return found
    return None


def _misses(skeleton: Skeleton, x: Array, xi: Array) -> float:
    """Largest error of the skeleton at other places, over the kernel's largest value."""
    shares, worst = skeleton.shares(xi), 0.0
    for function, size in zip(_functions(skeleton.kernel), skeleton.scale, strict=True):
        off = np.asarray(function(x[:, None], skeleton.places)) @ shares.T - function(
            x[:, None], xi
        )
        worst = max(worst, float(np.abs(off).max()) / size)
    return worst


def _functions(kernel: Kernel) -> list[Any]:
    """The regular part, and its potential if there is one."""
    assert kernel.regular is not None
    return (
        [kernel.regular]
        if kernel.regular_potential is None
        else [kernel.regular, kernel.regular_potential]
    )


def _some(zones: Zones, count: int, shift: int) -> Array:
    """About `count` places on zones; another shift gives other places.

    Each zone gets places in proportion to its width, but at least two. Of very many zones only some
    are taken.
    """
    number = min(len(zones), count // 3)
    chosen = np.unique(
        (np.linspace(0, len(zones) - 1, number).astype(np.intp) + shift * (len(zones) > number))
        % len(zones)
    )
    half = zones.half[chosen]
    nodes = 2 + shift % 2 + np.floor(0.5 * count * half / half.sum()).astype(np.intp)
    return np.concatenate(
        [
            zones.middle[i] + zones.half[i] * chebyshev.gauss(int(q))
            for i, q in zip(chosen, nodes, strict=True)
        ]
    )
