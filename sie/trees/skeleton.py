"""Low-rank interpolation of a smooth kernel k(x, xi) from a few source positions on zones.

    k(x, xi) = sum_j k(x, s_j) P_j(xi)        x, xi on zones,

with interpolating functions P_j. The same P_j interpolate the potential of the kernel. A pivoted QR
decomposition of k at a few hundred positions selects the columns s_j and as many rows. P_j(xi)
solves this equation in the selected rows (H. Cheng, Z. Gimbutas, P. G. Martinsson and V. Rokhlin,
SIAM J. Sci. Comput. 26, 2005, 1389-1404). So sources of the strengths w_q at positions xi_q on the
zones have the same field as sources of the strengths sum_q w_q P_j(xi_q), the moments, at the
positions s_j. The kernel is called for positions on zones only, unless the field off the zones is
wanted.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import linalg

from sie.basis import chebyshev
from sie.basis.data import SUM_ROUNDING, Array, Index, Kept, record
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones


@dataclass(frozen=True)
class SkeletonOptions:
    """Options of a skeleton, which interpolates a smooth kernel from a few source positions."""

    # Largest accepted error of the interpolated kernel at positions not used to build the skeleton,
    # relative to the kernel's largest value.
    max_error: float = 1e-12
    # Numbers of nodes on each zone, tried in turn until they resolve the kernel's modes there. The
    # numbers from the third on are also tried as numbers of positions among which the skeleton is
    # chosen.
    sizes: tuple[int, ...] = (24, 48, 96, 192, 384, 768)
    # The numbers of modes of K(x, xi) on a zone are counted for x at fixed xi and for xi at fixed
    # x. The fixed argument takes about this many positions of the skeleton.
    sampled_places: int = 8


SKELETON = SkeletonOptions()
# Largest number of skeletons and of sets of panels that are stored with one kernel.
MAX_STORED = 24


@record
class Skeleton(Kept):
    """Interpolation sum_j K(x, s_j) P_j(xi) of a smooth kernel K from source positions s_j.

    `shares` gives the interpolating functions P_j.

    places: positions s_j (r,); of_row: function of each row (0: regular part, 1: potential);
    x_of_row: position x of each row; factors: LU factors of the functions in these rows at the
    places; scale: largest values of both functions, by which they are divided.
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
        """Number of moments, one for each source position of the skeleton."""
        return len(self.places)

    def modes(self, half: Array) -> Index:
        """Number of Chebyshev modes that resolve the kernel on each of the skeleton's zones.

        half: not used; it is the argument of `Panels.modes`.
        """
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
            seen = (size > SUM_ROUNDING * largest) * np.arange(q)
            last = seen.max(axis=1)
            known = last < q - q // 6
            out[pending[known]] = last[known] + 2
            pending = pending[~known]
            if len(pending) == 0:
                break
        return out

    def spread(self, x: Array) -> Seen:
        """The points x with the matrices between them and the skeleton, see `Seen`."""
        return Seen(self, x)

    def shares(self, xi: Array) -> Array:
        """Values (n, r), at xi (n,), of the functions P_j that interpolate from r sources."""
        functions = _functions(self.kernel)
        rows = np.empty((len(self.x_of_row), len(xi)))
        for number, function in enumerate(functions):
            here = np.flatnonzero(self.of_row == number)
            if len(here):
                rows[here] = function(self.x_of_row[here, None], xi) / self.scale[number]
        return np.asarray(linalg.lu_solve(self.factors, rows, check_finite=False).T)

    def moments(self, spread: Any, weights: Array) -> Array:
        """Moments (r, ...) of sources at n points with the given weights (n, ...).
        Moments are weights of equivalent sources at the r source positions of the skeleton.
        """
        return np.asarray(np.tensordot(spread.as_sources, weights, axes=(0, 0)))

    def at(self, spread: Any, moments: Array, potential: bool) -> Array:
        """Transform or potential at n points (n, ...), from moments (r, ...).
        Moments are weights of sources at the r source positions of the skeleton.
        """
        return np.asarray(spread.as_targets(potential) @ moments)


class Seen:
    """Points x (n,), and matrices between these points and the skeleton.
    One matrix is for the points as sources, the others are for the points as targets.
    """

    def __init__(self, skeleton: Skeleton, x: Array) -> None:
        self.skeleton, self.x = skeleton, x
        self._targets: dict[bool, Array] = {}

    @cached_property
    def as_sources(self) -> Array:
        """Values (n, r), at the points, of the functions P_j that interpolate from r sources."""
        return self.skeleton.shares(self.x)

    def as_targets(self, potential: bool) -> Array:
        """Kernel or its potential (n, r) at the points, for sources at the skeleton's `places`."""
        if potential not in self._targets:
            kernel = self.skeleton.kernel
            function = kernel.regular_potential if potential else kernel.regular
            if function is None:
                raise ValueError(
                    "a condition on potentials needs the potential of the regular kernel: "
                    "sie.Smooth(value, potential)"
                )
            self._targets[potential] = np.asarray(
                function(self.x[:, None], self.skeleton.places), dtype=float
            )
        return self._targets[potential]


def skeleton_of(kernel: Kernel, zones: Zones) -> Skeleton | None:
    """The skeleton of the kernel's regular part on the zones; None if it would be too large.
    It interpolates the kernel from a few source positions; their number is the kernel's rank.
    """
    # The search takes longest if it fails because the rank is too high. So a failure is stored, and
    # the search is not repeated for the same number of zones.
    key, too_high = zones.table.tobytes(), ("rank", len(zones))
    if too_high in kernel.kept_panels:
        return None
    if key not in kernel.kept_panels:
        if len(kernel.kept_panels) >= MAX_STORED:
            kernel.kept_panels.clear()
        kernel.kept_panels[key] = _made(kernel, zones)
    found: Skeleton | None = kernel.kept_panels[key]
    if found is None:
        kernel.kept_panels[too_high] = None
    return found


def _made(kernel: Kernel, zones: Zones) -> Skeleton | None:
    functions = _functions(kernel)
    for count in SKELETON.sizes[2:]:
        x, xi = _sample_positions(zones, count, 0), _sample_positions(zones, count, 1)
        tables = [np.asarray(function(x[:, None], xi), dtype=float) for function in functions]
        scale = np.array([np.abs(table).max() for table in tables])
        if not np.isfinite(scale).all():
            return None
        scale[scale == 0.0] = 1.0
        table = np.concatenate([one / size for one, size in zip(tables, scale, strict=True)])
        triangle, order = linalg.qr(table, mode="r", pivoting=True, check_finite=False)
        size = np.abs(np.diagonal(triangle))
        rank = max(int(np.count_nonzero(size > SUM_ROUNDING * size[0])), 1)
        if rank > len(xi) // 2:
            continue
        chosen = table[:, order[:rank]]
        rows = linalg.qr(chosen.T, mode="r", pivoting=True, check_finite=False)[1][:rank]
        # If the kernel is zero, the matrix of the chosen rows is singular. The factors are then
        # irrelevant, and those of the unit matrix are used.
        factors = linalg.lu_factor(
            chosen[rows] if size[0] > 0.0 else np.eye(rank), check_finite=False
        )
        found = Skeleton(
            kernel, zones, xi[order[:rank]], rows // len(x), x[rows % len(x)], factors, scale
        )
        if (
            _interpolation_error(
                found, _sample_positions(zones, count, 2), _sample_positions(zones, count, 3)
            )
            <= SKELETON.max_error
        ):
            return found
    return None


def _interpolation_error(skeleton: Skeleton, x: Array, xi: Array) -> float:
    """Largest error of the interpolated kernel at x and xi, divided by its largest value."""
    shares, worst = skeleton.shares(xi), 0.0
    for function, size in zip(_functions(skeleton.kernel), skeleton.scale, strict=True):
        error = np.asarray(function(x[:, None], skeleton.places)) @ shares.T - function(
            x[:, None], xi
        )
        worst = max(worst, float(np.abs(error).max()) / size)
    return worst


def _functions(kernel: Kernel) -> list[Any]:
    """The kernel's regular part, and the potential of this part if there is one."""
    assert kernel.regular is not None
    return (
        [kernel.regular]
        if kernel.regular_potential is None
        else [kernel.regular, kernel.regular_potential]
    )


def _sample_positions(zones: Zones, count: int, shift: int) -> Array:
    """About `count` positions, spread over the zones. Another `shift` gives other positions.

    Each zone gets a number of positions in proportion to its width, but at least two. If there are
    very many zones, only some of them are used.
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
