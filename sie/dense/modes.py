"""Two numbers of modes for each zone: of the right side, and of the coupling to other zones.

The right side is sampled with a number of nodes that doubles until its coefficients have decayed.
This is cheap, because a zone's own operator is diagonal. The field of the other zones has
coefficients that decay as rho^k. Here rho < 1 belongs to the nearest end of another zone (or of an
image), or to the nearest singularity of a column. So narrow zones far apart need few coupled modes.

`conformal_radius` and `felt` follow from a model: a narrow zone with a load lies between two
neighbours that keep their levels (constant potentials). They act on the load like the grounded
half-lines x < -g and x > g', with g and g' their distances from the load. Let s be the position
from the middle between the half-lines, divided by half their distance. The map
s -> tan(asin(s)/2) takes the plane slit along |s| > 1 to the unit disk. So at the distance r from a
load at the origin, the potential is log(r / R), with the conformal radius R = 4 g g' / (g + g'). A
level of the left half-line contributes to the potential at the load with the harmonic measure
1/2 - asin(s) / pi, where s = (g - g') / (g + g').
"""

import math
from dataclasses import dataclass

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import EPS, SUM_ROUNDING, Array, Index, record, root_of_squares, wrapped
from sie.basis.interval import decay_rate, excess_of
from sie.basis.kernels import Kernel
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.zones import Zones
from sie.equation.equation import Forcing
from sie.jumps.right_side import ForcingJumps


def _for_transforms(sizes: Index) -> Index:
    """The sizes n; those above `max_direct_terms` are reduced by one to suit fast transforms.

    Then n + 1 has small prime factors only. A fast transform of n values is an FFT of length
    2 (n + 1). With n = 192 the prime number 193 made it twenty times slower than with n = 191.
    """
    return np.where(sizes > SUMS.max_direct_terms, sizes - 1, sizes)


OWN_SIZES = _for_transforms(
    np.sort(np.concatenate((8 * 2 ** np.arange(13), 24 * 2 ** np.arange(11))))
)


@dataclass(frozen=True)
class ModeOptions:
    """Limits of the numbers of nodes and modes of zones, and tolerances for choosing them."""

    # Largest number of nodes at which the right side is sampled on a zone. A zone whose last
    # Chebyshev coefficients have nearly decayed may have more nodes, as long as the table of all
    # zones has at most `memory_pairs` numbers.
    max_nodes: int = 8191
    # Chebyshev coefficients on a zone have nearly decayed if the last ones are below this fraction
    # of the largest one. If 1.5 times as many modes do not halve such small coefficients, they are
    # noise: even for a kernel as rough as |x - xi| they would be more than halved.
    nearly_decayed: float = 1e-5
    # First number of nodes of a zone. A zone begins with more nodes if the right side is singular
    # close to the zone. This number of first coefficients also gives the size of the functions with
    # jumps that are subtracted from the right side.
    first_nodes: int = 16
    # The decay of the right side's coefficients on a zone is judged only if the zone has at least
    # this number of nodes for each jump of the right side.
    nodes_per_piece: int = 4
    # Largest number of modes of a zone that enter the linear system for all zones. For a regular
    # kernel that needs more modes, the last of `COUPLED_SIZES` applies instead. If a zone beside a
    # narrow gap would need more modes, the gap is treated as a cut inside one wide zone
    # (`sie.slits`), provided that the gap's ends are free. Zones next to a gap with a fixed end get
    # graded coordinates (`sie.graded`).
    max_modes: int = 767
    # If the matrix of the linear system would have more entries than this, the rates at which a
    # solution changes with the positions of the ends are found by iteration.
    max_matrix_numbers: float = 4e7
    # First number of modes of a zone, divided by sqrt(half width / L). L is the length over which
    # the kernel's regular part varies. The square root suffices, because the density varies over L
    # only close to the ends, where Chebyshev nodes are dense. The factor 24 gives an error of about
    # 1e-12, and modes are added where they are too few.
    first_modes_per_root: float = 24.0


OPTIONS = ModeOptions()

COUPLED_SIZES = _for_transforms(
    np.concatenate(([0, 4, 6], np.outer(2 ** np.arange(9), [8, 10, 12]).ravel()))
)


def most(kernel: Kernel) -> int:
    """Largest number of modes of a zone that enter the linear system, for the given kernel."""
    return OPTIONS.max_modes if np.isinf(kernel.length) else int(COUPLED_SIZES[-1])


def enough(kernel: Kernel, tolerance: float) -> float:
    """Relative size to which the Chebyshev coefficients of the kernel's regular part must decay.

    If `kernel.length` is declared, the coefficients decay exponentially, so that a smaller size
    costs little. The smaller size is needed if the regular part nearly cancels the poles, since the
    truncation error is then relatively large.
    """
    return max(10 * tolerance if np.isinf(kernel.length) else 0.01 * tolerance, SUM_ROUNDING)


@record
class Growth:
    """Record of the last coefficients of the field on each zone, for growing numbers of modes.
    The field is that of the other zones. Its last coefficients show how many modes are needed.

    m: numbers of modes of the last solution (Z,); tails: sizes of the field's last coefficients
    with the last three numbers of modes, the newest last (3, Z); floor: noise of a user's
    functions, which more modes do not reduce (Z,).
    """

    m: Index
    tails: Array
    floor: Array

    @classmethod
    def first(cls, m: Index, tails: Array) -> "Growth":
        """The `Growth` after the first solution (m modes, last coefficients `tails`)."""
        return cls(
            m, np.array([np.full(len(m), np.inf), np.full(len(m), np.inf), tails]), np.zeros(len(m))
        )

    def after(self, m: Index, tails: Array, own: Index) -> "Growth":
        """The `Growth` after one more solution, with m modes and the last coefficients `tails`.

        own: number of coefficients of the right side on each zone.
        """
        if len(m) != len(self.m):
            return Growth.first(m, tails)
        grew = m > self.m
        kept = np.where(grew, self.tails[1:], self.tails[:2])
        # A zone is tested for noise only if it has more modes than the right side has coefficients.
        # With fewer modes, the last coefficients may belong to the right side and not to noise.
        noisy = grew & (m > own) & (tails < OPTIONS.nearly_decayed) & (tails > 0.5 * kept[0])
        # The factor 4 is a safety margin, because the noise differs from solution to solution.
        return Growth(
            m,
            np.array([*kept, tails]),
            np.where(noisy, np.maximum(self.floor, 4 * tails), self.floor),
        )


def least(zones: Zones, kernel: Kernel) -> Index:
    """Initial number of modes of each zone for a kernel whose regular part a user defines.

    The solver starts with this number of modes and adds more. The number grows with the square root
    of the half width divided by `kernel.length`.
    """
    lengths = zones.half / kernel.length
    return np.maximum(
        OPTIONS.first_nodes, np.ceil(OPTIONS.first_modes_per_root * np.sqrt(lengths))
    ).astype(np.intp)


def own_at_first(zones: Zones, singular_at: Array, period: float | None) -> Index:
    """Initial number of nodes of each zone, from its distance to the right side's singularities."""
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
    # Only singularities strictly outside the zone count, not those at the zone's ends.
    left, right = (
        at[np.searchsorted(at, zones.a) - 1],
        at[np.searchsorted(at, zones.b, side="right")],
    )
    by = decay_rate(np.minimum(np.minimum(zones.a - left, right - zones.b) / zones.half, 1e300))
    return OWN_SIZES[
        np.searchsorted(
            OWN_SIZES, np.clip(-np.log(EPS) / by, OPTIONS.first_nodes, OPTIONS.max_nodes)
        )
    ]


def most_own(zones: Zones) -> int:
    """Largest allowed number of nodes of one zone; it is smaller if there are many zones."""
    return int(
        OWN_SIZES[
            np.searchsorted(
                OWN_SIZES,
                np.clip(SUMS.memory_pairs / len(zones), OPTIONS.max_nodes, OWN_SIZES[-1]),
                side="right",
            )
            - 1
        ]
    )


def coupled(zones: Zones, kernel: Kernel, tolerance: float, least: int | Index) -> Index:
    """Number m of modes of each zone (Z,) that enter the linear system for all zones.

    Unless `max_modes` limits m, rho^m is below the tolerance, where -log(rho) is `decay`.
    """
    by = decay(zones, kernel)
    want = np.minimum(-np.log(tolerance) / np.maximum(by, 1e-3), OPTIONS.max_modes)
    return COUPLED_SIZES[
        np.searchsorted(COUPLED_SIZES, np.maximum(want, np.minimum(least, most(kernel))))
    ]


def decay(zones: Zones, kernel: Kernel) -> Array:
    """Decay rate of the coefficients of the other zones' field on each zone (Z,).

    The coefficients fall as rho^k. The rate is -log(rho), where rho belongs to the nearest end of
    another zone or of an image; it is inf if there is no other zone.
    """
    left, right = gaps(zones, kernel)
    return decay_rate(np.minimum(left, right) / zones.half)


def least_distance() -> float:
    """Least distance of a singularity from a zone for which `max_nodes` nodes are enough.

    The distance is divided by the zone's width.
    """
    rate = -math.log(OPTIONS.nearly_decayed) / OPTIONS.max_nodes
    return 0.5 * excess_of(rate)


def gaps(zones: Zones, kernel: Kernel) -> tuple[Array, Array]:
    """Distance of each zone from the nearest zone or image, on its left and right; inf if none."""
    between = zones.a[1:] - zones.b[:-1]
    shifts = [s for s in kernel.poles if s > 0]
    border = min(shifts) - (zones.b[-1] - zones.a[0]) if shifts else np.inf
    return np.concatenate(([border], between)), np.concatenate((between, [border]))


@record
class Samples:
    """Chebyshev coefficients of the smooth part of the right side, from samples on each zone.

    coefficients: U coefficients g_k at [:, k] (g_0 unused); own: number of nodes of each zone;
    tail: size of the last coefficients of each zone; evaluations: number of values computed.
    """

    coefficients: Array
    own: Index
    tail: Array
    evaluations: int


def sample(
    forcing: Forcing, zones: Zones, jumps: ForcingJumps, own: Index, tolerance: float, largest: int
) -> Samples:
    """Sample the right side on each zone, with more nodes until its coefficients have decayed.

    Of symmetric zones, only the right half is sampled. The decay is measured relative to the
    coefficients of the smooth part or of the subtracted jumps, whichever are larger: if g is a
    step, the smooth part is only the round-off of the jump. If only derivatives of the right side
    g jump, the decay is measured relative to g itself, because the terms of the jumps may be much
    larger than their sum.
    """
    own = own.copy()
    subtracted = np.abs(jumps.t_coefficients(zones, OPTIONS.first_nodes)).max(axis=1)
    knots = np.bincount(jumps.zone[jumps.order > 0], minlength=len(zones))
    bent = knots > 0
    bent[jumps.kinked] = False
    # The largest of many coefficients that are noise is about four times their standard deviation.
    noise = np.maximum(jumps.rounding(len(zones)), 4 * np.sqrt(2) * forcing.resolution.rounding)
    found: list[tuple[Index, Array]] = []
    # `sizes`: the numbers of nodes of each zone in its last two evaluations. `tails`: the largest
    # of the last coefficients in each of these two evaluations.
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
            # A position is rounded to half a unit in its last digit. This rounding, multiplied by
            # the slope of the right side g, causes noise in all coefficients of g.
            rounded = (
                place_rounding(zones, group)
                * root_of_squares(g, np.arange(1.0, int(n) + 1))
                * (2 / np.sqrt(n))
            )
            grow = (
                last > np.maximum(tolerance * scale, np.maximum(rounded, noise[group] / np.sqrt(n)))
            ) & (n < largest)
            grow &= (n < OPTIONS.max_nodes) | (last <= OPTIONS.nearly_decayed * scale)
            # The last of n coefficients decrease as 1/n if the right side g jumps, and as 1/sqrt(n)
            # if they are round-off. So they count as round-off if they decrease more slowly than
            # n^-0.75 from both previous numbers of nodes. If the right side has knots, one of the
            # two decreases may be slow by chance.
            slow = (tails[group, 1] >= 0) & (
                last[:, None] > tails[group] * (sizes[group] / n) ** 0.75
            ).all(axis=1)
            sizes[group], tails[group] = sizes[group][:, [1, 1]], tails[group][:, [1, 1]]
            sizes[group, 1], tails[group, 1] = n, last
            # `calm` counts the evaluations in which the last coefficients of a zone look like
            # round-off. Only evaluations with enough nodes between the jumps count. With too few
            # nodes, the coefficients do not yet show how they decay.
            calm[group] += (
                slow
                & (last < OPTIONS.nearly_decayed * scale)
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
    """Set the end of long series to zero, in place, if their second half is only round-off.

    From the middle of a series to its end, the coefficients of a jump decrease to one half, while
    round-off stays constant. The limit sqrt(2) is the geometric mean of the ratios 2 and 1.
    Close to an end of the zone, the sum of the round-off of n coefficients grows as n^1.5. This sum
    is smaller with fewer coefficients from the same number of nodes.
    """
    for zone in zones[own[zones] >= SUMS.max_direct_terms]:
        n = int(own[zone])
        size = np.abs(table[zone, : n + 1])
        last_half = size[n // 2 : n - n // 8].max()
        noise = OPTIONS.nearly_decayed * size.max()
        if last_half <= np.sqrt(2) * tail[zone] <= noise:
            last = int(np.flatnonzero(size > 2 * tail[zone]).max(initial=0))
            table[zone, last + max(OPTIONS.first_nodes, last // 8) + 1 :] = 0.0


def place_rounding(zones: Zones, group: Index) -> Array:
    """Spacing of floating-point numbers at each zone, divided by the zone's half width."""
    return np.asarray(
        np.spacing(np.maximum(np.abs(zones.a[group]), np.abs(zones.b[group]))) / zones.half[group]
    )


def mirror(zones: Zones, table: Array) -> None:
    """Fill the rows of the left half of symmetric zones from their mirror images, in place."""
    left = np.arange(len(zones) // 2)
    table[left] = table[::-1][left] * (1.0 - 2.0 * (np.arange(table.shape[1]) % 2))


def _values(
    forcing: Forcing, zones: Zones, jumps: ForcingJumps, group: Index, n: int
) -> tuple[Array, Array]:
    """(smooth part of the right side g at the nodes of zones, largest |g| on each zone)."""
    _, right, left = chebyshev.lobatto(n)
    left, right = left[1:-1], right[1:-1]
    w = zones.half[group][:, None]
    end = np.where(left <= right, zones.a[group][:, None], zones.b[group][:, None])
    # Nodes are measured from the rounded positions of the ends; `rest` is the exact position of an
    # end minus the rounded one.
    rest = zones.rest[:, group][:, :, None]
    away = w * np.where(left <= right, left, -right) + np.where(left <= right, rest[0], rest[1])
    # (zone of every node, the node's distance from the zone's left end in half widths). The nodes
    # are listed one zone after another.
    of_jumps = np.repeat(group, len(left)), np.tile(left, len(group))
    if float(place_rounding(zones, group).max()) > SUM_ROUNDING:
        # The values at rounded nodes are corrected by the slope of g. Jumps of g are removed first,
        # so that the slope can be computed from values on both sides of a jump.
        levels = jumps.level_part(*of_jumps).reshape(len(group), -1)
        values = forcing.sampled(end, away, lambda g: chebyshev.slopes(g + levels) / w)
    else:
        x = end + away
        values = np.array(forcing.value(x.ravel()), dtype=float).reshape(x.shape)
    given = np.abs(values).max(axis=1)
    return values + jumps.smooth_part(*of_jumps).reshape(values.shape), given


def conformal_radius(left: Array, right: Array) -> Array:
    """Conformal radius R = 4 g g' / (g + g') for a narrow zone between two half-lines.
    The zone is treated as a point. The head of this file explains the radius.

    left, right: distances g and g' of the half-lines from the zone. One of them may be infinite.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(4 / (1 / left + 1 / right))


def felt(left: Array, right: Array) -> tuple[Array, Array]:
    """Weights of the constant potentials of two zones in the potential at a point between them.

    `left` and `right` are the distances of the point from the zone on its left and on its right.
    The weights are harmonic measures (see the head of this file), and their sum is one.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        # The weight of the right neighbour is 1/2 + asin(s) / pi, with s from -1 to 1 between the
        # neighbours. Here sqrt(left / right) is the tangent of half the angle asin(s) + pi / 2.
        of_right = np.where(
            np.isinf(left) & np.isinf(right), 0.5, 2 / np.pi * np.arctan(np.sqrt(left / right))
        )
    return 1 - of_right, of_right
