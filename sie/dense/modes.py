"""Numbers of modes of each zone: its own, by the decay of the right side, and the coupled ones.

Coefficients of the right side decay by its smoothness. It is sampled on nodes that double until
they have decayed, which is cheap, because a zone's own operator is diagonal. The field of the other
zones decays as rho^k, where rho belongs to the nearest foreign end (or image, or singularity of a
column). So narrow zones far apart need few coupled modes.

The neighbours of a small zone, where each holds its level, are to a load between them like the
half-lines x < -g and x > g' of a grounded plane. z -> tan(asin(s)/2) takes the plane slit along |s|
> 1 to the disk, where s is measured from the middle of the gap in half gaps. So a load at the
origin has the potential log(r / R) near it, R = 4 g g' / (g + g') is the conformal radius, and the
level of the left half-line is felt with the harmonic measure 1/2 - asin(s) / pi, s = (g - g') / (g
+ g').
"""

import math
from dataclasses import dataclass

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Index, record, root_of_squares, wrapped
from sie.basis.interval import decay_rate
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.equation.equation import Forcing
from sie.jumps.forcing import ForcingJumps

OWN_SIZES = np.sort(np.concatenate((8 * 2 ** np.arange(13), 24 * 2 ** np.arange(11))))


@dataclass(frozen=True)
class ModeOptions:
    """Limits and tolerances of the numbers of modes."""

    # Nodes at most: of one of many zones, or of one whose last coefficients are not below
    # `nearly_decayed` of the largest; and of all zones together, each counted with the largest
    # number.
    max_nodes: int = 8192
    nearly_decayed: float = 1e-6
    max_nodes_together: int = 1 << 20
    # First nodes of a smooth right side. If it is singular next to the zones, as many that its
    # coefficients fall to `first_decay`.
    first_nodes: int = 16
    first_decay: float = 1e-12
    # A plateau of coefficients is noise only below this part of the largest. Coefficients of a
    # kernel as rough as |x - xi| fall by more than half with half as many modes again.
    noise_plateau: float = 1e-5
    nodes_per_piece: int = 4
    # Series from this length on are cut if half of their coefficients are at most `plateau_ratio`
    # times the last ones, since those of a jump would fall to half. `kept_beyond` more are kept.
    long_series: int = 96
    plateau_ratio: float = 1.5
    kept_beyond: int = 8
    # Places rounded to less than this part of a zone count as exact.
    exact_places: float = 1e-14
    # The largest coefficient of a jump's part is among so many.
    leading_coefficients: int = 8
    # Modes at most: as a rule; for a regular kernel that needs more, or next to narrow gaps with
    # fixed ends; and numbers in the matrix for which the second holds. Zones with moving ends need
    # not more, since narrow gaps between them are slits.
    max_modes: int = 768
    max_modes_regular: int = 3072
    max_matrix_numbers: float = 4e7
    # Rounding of a regular kernel's coefficients over its size.
    kernel_rounding: float = 2e-15
    # First modes of a zone per square root of its half width over the length of a regular kernel:
    # the density varies over the length next to the ends only, where modes are as dense. 24 leave
    # about 1e-12, and modes grow where they are too few.
    first_modes_per_root: float = 24.0


OPTIONS = ModeOptions()

# Decay of a zone without neighbours: exp(-ALONE) is the smallest number.
ALONE = -math.log(np.finfo(float).tiny)
COUPLED_SIZES = np.concatenate(([0, 4, 6], np.outer(2 ** np.arange(9), [8, 10, 12]).ravel()))


def most(kernel: Kernel) -> int:
    """Largest number of coupled modes of a zone."""
    return OPTIONS.max_modes if np.isinf(kernel.length) else OPTIONS.max_modes_regular


def enough(kernel: Kernel, tolerance: float) -> float:
    """Part of the largest coefficient to which those of a regular part have to fall.

    Where they fall exponentially, more costs little. What is left of them may count more than it
    seems if the regular part nearly cancels the poles.
    """
    return max(
        10 * tolerance if np.isinf(kernel.length) else 0.01 * tolerance, OPTIONS.kernel_rounding
    )


@record
class Growth:
    """Last coefficients of each zone's fields while its modes grew.

    m: modes of the last solution (Z,); tails: its last coefficients, after those of the two sizes
    before (3, Z); floor: noise of a user's functions, which more modes do not reduce (Z,).
    """

    m: Index
    tails: Array
    floor: Array

    @classmethod
    def first(cls, m: Index, tails: Array) -> "Growth":
        """The growth after a first solution."""
        return cls(
            m, np.array([np.full(len(m), np.inf), np.full(len(m), np.inf), tails]), np.zeros(len(m))
        )

    def after(self, m: Index, tails: Array, own: Index) -> "Growth":
        """The growth after the next solution; own: number of coefficients of the right side on each
        zone.
        """
        if len(m) != len(self.m):
            return Growth.first(m, tails)
        grew = m > self.m
        kept = np.where(grew, self.tails[1:], self.tails[:2])
        # With fewer modes than the right side has, what follows may be more than noise.
        noisy = grew & (m > own) & (tails < OPTIONS.noise_plateau) & (tails > 0.5 * kept[0])
        # Noise differs from one solution to the next, so four times it is taken.
        return Growth(
            m,
            np.array([*kept, tails]),
            np.where(noisy, np.maximum(self.floor, 4 * tails), self.floor),
        )


def least(zones: Zones, kernel: Kernel) -> Index:
    """First coupled modes of each zone if the kernel's regular part is a user's own."""
    lengths = zones.half / kernel.length
    return np.maximum(
        OPTIONS.first_nodes, np.ceil(OPTIONS.first_modes_per_root * np.sqrt(lengths))
    ).astype(np.intp)


def own_at_first(zones: Zones, singular_at: Array, period: float | None) -> Index:
    """First number of nodes of each zone."""
    if len(singular_at) == 0:
        return np.full(len(zones), OPTIONS.first_nodes)
    at = np.sort(wrapped(singular_at, float(zones.a[0]), period))
    at = np.concatenate(
        (
            [-np.inf],
            at if period is None else np.concatenate((at - period, at, at + period)),
            [np.inf],
        )
    )
    # Singularities lie strictly outside the zone; at its ends there is none.
    left, right = (
        at[np.searchsorted(at, zones.a) - 1],
        at[np.searchsorted(at, zones.b, side="right")],
    )
    by = decay_rate(np.minimum(np.minimum(zones.a - left, right - zones.b) / zones.half, 1e300))
    return OWN_SIZES[
        np.searchsorted(
            OWN_SIZES,
            np.clip(-np.log(OPTIONS.first_decay) / by, OPTIONS.first_nodes, OPTIONS.max_nodes),
        )
    ]


def most_own(zones: Zones) -> int:
    """Largest number of nodes of a zone."""
    return int(
        OWN_SIZES[
            np.searchsorted(
                OWN_SIZES,
                np.clip(OPTIONS.max_nodes_together / len(zones), OPTIONS.max_nodes, OWN_SIZES[-1]),
                side="right",
            )
            - 1
        ]
    )


def coupled(zones: Zones, kernel: Kernel, tolerance: float, least: int | Index) -> Index:
    """Coupled modes per zone, so that rho^m at the nearest foreign end is below the tolerance.

    They are at least `least`.
    """
    by = decay(zones, kernel)
    most_here = OPTIONS.max_modes if zones.moves.any() else OPTIONS.max_modes_regular
    want = np.minimum(
        np.where(by < ALONE, -np.log(tolerance) / np.maximum(by, 1e-3), 0.0), most_here
    )
    # Zones that need the most give way first.
    while (
        want.max(initial=0.0) > OPTIONS.max_modes and want.sum() ** 2 > OPTIONS.max_matrix_numbers
    ):
        want = np.minimum(want, max(OPTIONS.max_modes, 0.8 * want.max()))
    return COUPLED_SIZES[
        np.searchsorted(COUPLED_SIZES, np.maximum(want, np.minimum(least, most(kernel))))
    ]


def decay(zones: Zones, kernel: Kernel) -> Array:
    """-log(rho) of the nearest foreign end (Z,): the rate at which coefficients of fields fall."""
    left, right = gaps(zones, kernel)
    return decay_rate(np.minimum(np.minimum(left, right) / zones.half, 1e300))


def gaps(zones: Zones, kernel: Kernel) -> tuple[Array, Array]:
    """Distances from each zone to the nearest zone or image on its left and right (inf if none)."""
    between = zones.a[1:] - zones.b[:-1]
    shifts = [s for s in kernel.poles if s > 0]
    border = min(shifts) - (zones.b[-1] - zones.a[0]) if shifts else np.inf
    return np.concatenate(([border], between)), np.concatenate((between, [border]))


@record
class Samples:
    """The sampled smooth part of the right side.

    coefficients: U coefficients g_k at [:, k] (g_0 unused); own: number of nodes per zone; tail:
    size of the last coefficients per zone; evaluations: number of values.
    """

    coefficients: Array
    own: Index
    tail: Array
    evaluations: int


def sample(
    forcing: Forcing, zones: Zones, jumps: ForcingJumps, own: Index, tolerance: float, largest: int
) -> Samples:
    """Sample the right side on each zone, with nodes doubled until the coefficients have decayed.

    A symmetric set is sampled on its right half only. Where jumps of g leave nothing smooth, as in
    a wedge, the decay is measured relative to them, since their rounding remains. Where only
    derivatives jump it is measured relative to g itself, because their parts may be much larger
    than their sum.
    """
    own = own.copy()
    subtracted = np.abs(jumps.t_coefficients(zones, OPTIONS.leading_coefficients)).max(axis=1)
    knots = np.bincount(jumps.zone[jumps.order > 0], minlength=len(zones))
    bent = knots > 0
    bent[jumps.kinked] = False
    # The largest of many coefficients of noise is some four times their standard deviation.
    noise = np.maximum(jumps.rounding(len(zones)), 4 * np.sqrt(2) * forcing.resolution.rounding)
    found: list[tuple[Index, Array]] = []
    # The last two sizes and tails of each zone.
    sizes, tails = np.ones((len(zones), 2)), np.full((len(zones), 2), -np.inf)
    calm = np.zeros(len(zones), dtype=np.intp)
    pending = zones.solved
    evaluations = 0
    while len(pending):
        retry = []
        for n in np.unique(own[pending]):
            group = pending[own[pending] == n]
            values, largest_value = _values(forcing, zones, jumps, group, int(n))
            evaluations += values.size
            g = chebyshev.u_coefficients(values)
            if zones.central and group[0] == zones.solved[0]:
                g[0, ::2] = 0.0
            last = np.abs(g[:, -max(4, int(n) // 8) :]).max(axis=1)
            scale = np.where(
                bent[group], largest_value, np.maximum(np.abs(g).max(axis=1), subtracted[group])
            )
            # Places are rounded to half a unit in their last digit, which the slope of g turns into
            # noise in all coefficients.
            rounded = (
                place_rounding(zones, group)
                * root_of_squares(g, np.arange(1.0, int(n) + 1))
                * (2 / np.sqrt(n))
            )
            grow = (
                last > np.maximum(tolerance * scale, np.maximum(rounded, noise[group] / np.sqrt(n)))
            ) & (n < largest)
            grow &= (n < OPTIONS.max_nodes) | (last <= OPTIONS.nearly_decayed * scale)
            # A jump of g leaves coefficients ~ 1/n and rounding ~ 1/sqrt(n): what falls no faster
            # is rounding. Sizes two steps apart have the ratio two; next to knots, two successive
            # sizes may differ by chance.
            slow = (tails[group, 1] >= 0) & (
                last[:, None] > tails[group] * (sizes[group] / n) ** 0.75
            ).all(axis=1)
            sizes[group], tails[group] = sizes[group][:, [1, 1]], tails[group][:, [1, 1]]
            sizes[group, 1], tails[group, 1] = n, last
            # Too few nodes do not resolve the pieces between jumps, and do not show how
            # coefficients fall.
            calm[group] += (
                slow
                & (last < OPTIONS.noise_plateau * scale)
                & (n >= OPTIONS.nodes_per_piece * knots[group])
            )
            found.append((group, g))
            grow &= calm[group] < 3
            bad = group[grow]
            own[bad] = OWN_SIZES[np.searchsorted(OWN_SIZES, n, side="right")] if len(bad) else n
            retry.append(bad)
        pending = np.concatenate(retry)
    table = np.zeros((len(zones), int(own[zones.solved].max()) + 1))
    for group, g in found:
        table[group, 1 : g.shape[1] + 1] = g
    tail = np.maximum(tails[:, 1], 0.0)
    _cut(table, own, tail, zones.solved)
    if zones.symmetric:
        mirror(zones, table)
        left = np.arange(len(zones) // 2)
        own[left], tail[left] = own[::-1][left], tail[::-1][left]
    return Samples(table, own, tail, evaluations)


def _cut(table: Array, own: Index, tail: Array, zones: Index) -> None:
    """Cut long series that have stopped falling half way: the rest is rounding.

    Next to an end their sum grows as n^1.5, and that of fewer coefficients from as many nodes by
    less.
    """
    for zone in zones[own[zones] >= OPTIONS.long_series]:
        n = int(own[zone])
        size = np.abs(table[zone, : n + 1])
        last_half = size[n // 2 : n - n // 8].max()
        noise = OPTIONS.noise_plateau * size.max()
        if last_half <= OPTIONS.plateau_ratio * tail[zone] <= noise:
            last = int(np.flatnonzero(size > 2 * tail[zone]).max(initial=0))
            table[zone, last + max(OPTIONS.kept_beyond, last // 8) + 1 :] = 0.0


def place_rounding(zones: Zones, group: Index) -> Array:
    """Spacing of numbers at zones over their half widths."""
    return np.asarray(
        np.spacing(np.maximum(np.abs(zones.a[group]), np.abs(zones.b[group]))) / zones.half[group]
    )


def mirror(zones: Zones, table: Array) -> None:
    """Fill the left half of a symmetric set's table from the right one: T_k(-t) = (-1)^k T_k(t)."""
    left = np.arange(len(zones) // 2)
    table[left] = table[::-1][left] * (1.0 - 2.0 * (np.arange(table.shape[1]) % 2))


def _values(
    forcing: Forcing, zones: Zones, jumps: ForcingJumps, group: Index, n: int
) -> tuple[Array, Array]:
    """(smooth part of g at the nodes of zones, largest |g| on each)."""
    _, right, left = chebyshev.lobatto(n)
    left, right = left[1:-1], right[1:-1]
    w = zones.half[group][:, None]
    end = np.where(left <= right, zones.a[group][:, None], zones.b[group][:, None])
    # Nodes are measured from the ends as rounded positions; `rest` is the part below the last
    # digit.
    rest = zones.rest[:, group][:, :, None]
    away = w * np.where(left <= right, left, -right) + np.where(left <= right, rest[0], rest[1])
    # The nodes of each zone, one zone after the other.
    of_jumps = np.repeat(group, len(left)), np.tile(left, len(group))
    if float(place_rounding(zones, group).max()) > OPTIONS.exact_places:
        # What a jump adds to the slope does not belong to g on either side.
        levels = jumps.level_part(*of_jumps).reshape(len(group), -1)
        values = forcing.sampled(end, away, lambda g: chebyshev.slopes(g + levels) / w)
    else:
        x = end + away
        values = np.array(forcing.value(x.ravel()), dtype=float).reshape(x.shape)
    given = np.abs(values).max(axis=1)
    return values + jumps.smooth_part(*of_jumps).reshape(values.shape), given


def conformal_radius(left: Array, right: Array) -> Array:
    """R by the distances to the neighbours, of which one may be infinite."""
    with np.errstate(divide="ignore"):
        return np.asarray(4 / (1 / left + 1 / right))


def felt(left: Array, right: Array) -> tuple[Array, Array]:
    """Parts of the left and of the right neighbour's level that are felt between them; their sum is
    one.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        # sqrt(left / right) is the tangent of half the angle of asin(s) from -pi / 2.
        of_right = np.where(
            np.isinf(left) & np.isinf(right), 0.5, 2 / np.pi * np.arctan(np.sqrt(left / right))
        )
    return 1 - of_right, of_right
