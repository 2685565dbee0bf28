"""How many modes each zone has: its own, from the right side's decay, and the coupled ones, from
its neighbours.

Coefficients of the right side decay as smoothness allows and are sampled on nodes that double until
they have decayed; this is cheap, because a zone's own operator is diagonal. What other zones do
decays as rho^k, where rho belongs to the nearest foreign end (or image, or singularity of a
column), so few coupled modes are enough for narrow zones far apart.

The neighbours of a small zone, where each holds its level: to a load between them they are about
the half-lines x < -g and x > g' of a grounded plane. z -> tan(asin(s)/2) takes the plane slit along
|s| > 1 to the disk, s counted from the middle of the gap in halves of it: so a load at the origin
has the potential log(r / R) near it, R = 4 g g' / (g + g') the conformal radius, and what the left
one is lifted by is felt with the harmonic measure 1/2 - asin(s) / pi, s = (g - g') / (g + g').
"""

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Index, record, root_of_squares, wrapped
from sie.basis.interval import decay_rate
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.equation.equation import Forcing
from sie.jumps.forcing import ForcingJumps

OWN_SIZES = np.array(
    [
        8,
        16,
        24,
        32,
        48,
        64,
        96,
        128,
        192,
        256,
        384,
        512,
        768,
        1024,
        1536,
        2048,
        3072,
        4096,
        6144,
        8192,
        12288,
        16384,
        24576,
        32768,
    ]
)
# Nodes at the most: of one of many zones, or of one whose last coefficients with so many are not
# below such a part of the largest; and of all together, of which each is given as many as any other
# has.
MOST_OWN = 8192
_NEARLY = 1e-6
_IN_ALL = 1 << 20
# Nodes to begin with of a smooth right side; of one that is singular beside the zones, so many that
# its coefficients fall to this part.
_FEW = 16
_FALLEN = 1e-12
# Only below this part of the largest coefficient can a plateau be rounding.
_NOISE = 1e-5
_TO_A_PIECE = 4
# Series so long are cut, if half of them are no more than so many times the last ones: coefficients
# of a jump would fall to half. How many more are kept at the least.
_LONG = 96
_PLATEAU = 1.5
_LEFT = 8
# Places rounded to less than this part of a zone are exact to all purposes.
_FINE = 1e-14
# No zone has this decay but one without neighbours.
ALONE = 690.0
# Coefficients among which the largest of a jump's part is.
_LEADING = 8
COUPLED_SIZES = np.array(
    [
        0,
        4,
        6,
        8,
        10,
        12,
        16,
        20,
        24,
        32,
        40,
        48,
        64,
        80,
        96,
        128,
        160,
        192,
        256,
        320,
        384,
        512,
        640,
        768,
        1024,
        1280,
        1536,
        2048,
        2560,
        3072,
    ]
)
# Modes at the most: as a rule, and of a regular kernel that is known to ask for more, or of zones
# beside narrow gaps whose ends stay, as long as the matrix has no more numbers than the last. Ends
# that move are not far from those of one zone with a slit, or of gaps.
_MOST = 768
_MOST_KNOWN = 3072
_OF_FEW = 4e7
# The rounding of a regular kernel's coefficients over its size: they fall no further.
_KERNEL_ROUNDING = 2e-15
# A user's kernel may be noisier. Its noise is what two more steps of COUPLED_SIZES, half as many
# modes again, do not halve, where the last coefficients are below this part of the largest: those
# of a kernel as rough as |x - xi| still fall by more.
_KERNEL_NOISE = 1e-5
# Modes to begin with, to a half width over the length of a regular kernel: coefficients have fallen
# to exp(-12).
_PER_LENGTH = 12.0
# The same of a wide zone, to the square root of that: its density varies over the length beside the
# ends alone, where modes are as dense as that. 24 leave about 1e-12; modes grow where they are too
# few.
_PER_ROOT = 24.0


def most(kernel: Kernel) -> int:
    """Coupled modes of a zone at the most."""
    return _MOST if np.isinf(kernel.length) else _MOST_KNOWN


def enough(kernel: Kernel, tolerance: float) -> float:
    """How far the coefficients of a regular part have to fall: where they fall as exponentials do,
    more costs little, and what is left of them may weigh more than they tell if the regular part
    nearly cancels the poles.
    """
    return max(10 * tolerance if np.isinf(kernel.length) else 0.01 * tolerance, _KERNEL_ROUNDING)


@record
class Growth:
    """How the last coefficients of each zone's fields fell while its modes grew.

    m: modes of the last solution (Z,); tails: its last coefficients, and before those the ones of
    the two sizes below (3, Z); floor: what is noise of a user's functions, which more modes leave
    as it is (Z,).
    """

    m: Index
    tails: Array
    floor: Array

    @classmethod
    def first(cls, m: Index, tails: Array) -> "Growth":
        """Of a first solution."""
        return cls(
            m, np.array([np.full(len(m), np.inf), np.full(len(m), np.inf), tails]), np.zeros(len(m))
        )

    def after(self, m: Index, tails: Array, own: Index) -> "Growth":
        """With the next solution; own: coefficients of the right side on each zone."""
        if len(m) != len(self.m):
            return Growth.first(m, tails)
        grew = m > self.m
        kept = np.where(grew, self.tails[1:], self.tails[:2])
        # Fewer modes than the right side has need not show all of the density: what follows may be
        # more than noise.
        noisy = grew & (m > own) & (tails < _KERNEL_NOISE) & (tails > 0.5 * kept[0])
        # Noise is not the same from one solution to the next.
        return Growth(
            m,
            np.array([*kept, tails]),
            np.where(noisy, np.maximum(self.floor, 4 * tails), self.floor),
        )


def least(zones: Zones, kernel: Kernel) -> Index:
    """Coupled modes of each zone to begin with, where the kernel's regular part is a user's own."""
    lengths = zones.half / kernel.length
    return np.maximum(
        16, np.ceil(np.minimum(_PER_LENGTH * lengths, _PER_ROOT * np.sqrt(lengths)))
    ).astype(np.intp)


def own_at_first(zones: Zones, singular_at: Array, period: float | None) -> Index:
    """Nodes of each zone to begin with."""
    if len(singular_at) == 0:
        return np.full(len(zones), _FEW)
    at = np.sort(wrapped(singular_at, float(zones.a[0]), period))
    at = np.concatenate(
        (
            [-np.inf],
            at if period is None else np.concatenate((at - period, at, at + period)),
            [np.inf],
        )
    )
    # Strictly beyond either end: nothing within a zone is singular, nor at an end of it.
    left, right = (
        at[np.searchsorted(at, zones.a) - 1],
        at[np.searchsorted(at, zones.b, side="right")],
    )
    by = decay_rate(np.minimum(np.minimum(zones.a - left, right - zones.b) / zones.half, 1e300))
    return OWN_SIZES[np.searchsorted(OWN_SIZES, np.clip(-np.log(_FALLEN) / by, _FEW, MOST_OWN))]


def most_own(zones: Zones) -> int:
    """Nodes of a zone at the most."""
    return int(
        OWN_SIZES[
            np.searchsorted(
                OWN_SIZES, np.clip(_IN_ALL / len(zones), MOST_OWN, OWN_SIZES[-1]), side="right"
            )
            - 1
        ]
    )


def coupled(zones: Zones, kernel: Kernel, tolerance: float, least: int | Index) -> Index:
    """Coupled modes per zone so that rho^m is below the tolerance at the nearest foreign end; at
    least `least`.
    """
    by = decay(zones, kernel)
    most_here = _MOST if zones.moves.any() else _MOST_KNOWN
    want = np.minimum(
        np.where(by < ALONE, -np.log(tolerance) / np.maximum(by, 1e-3), 0.0), most_here
    )
    # Those that ask for the most give way first.
    while want.max(initial=0.0) > _MOST and want.sum() ** 2 > _OF_FEW:
        want = np.minimum(want, max(_MOST, 0.8 * want.max()))
    return COUPLED_SIZES[
        np.searchsorted(COUPLED_SIZES, np.maximum(want, np.minimum(least, most(kernel))))
    ]


def decay(zones: Zones, kernel: Kernel) -> Array:
    """-log(rho) of the nearest foreign end: so fast do coefficients of what others do fall on each
    zone.
    """
    left, right = gaps(zones, kernel)
    return decay_rate(np.minimum(np.minimum(left, right) / zones.half, 1e300))


def gaps(zones: Zones, kernel: Kernel) -> tuple[Array, Array]:
    """Distance from each zone to the nearest zone or image on its left and on its right (inf if
    none).
    """
    between = zones.a[1:] - zones.b[:-1]
    shifts = [s for s in kernel.poles if s > 0]
    border = min(shifts) - (zones.b[-1] - zones.a[0]) if shifts else np.inf
    return np.concatenate(([border], between)), np.concatenate((between, [border]))


@record
class Samples:
    """U coefficients of the smooth right side, g_k at [:, k] (g_0 unused), the sizes used, the size
    of their last part and the largest coefficient, per zone.
    """

    coefficients: Array
    own: Index
    tail: Array
    evaluations: int


def sample(
    forcing: Forcing, zones: Zones, jumps: ForcingJumps, own: Index, tolerance: float, largest: int
) -> Samples:
    """Sample the right side on each zone and double the nodes of those whose coefficients have not
    decayed.

    A symmetric set is sampled on its right half only. Where jumps of g leave nothing smooth, as in
    a wedge, they are what the decay is measured by: of them rounding remains. Where derivatives
    alone jump it is g itself: their parts may be much larger than their sum.
    """
    own = own.copy()
    subtracted = np.abs(jumps.t_coefficients(zones, _LEADING)).max(axis=1)
    knots = np.bincount(jumps.zone[jumps.order > 0], minlength=len(zones))
    bent = knots > 0
    bent[jumps.kinked] = False
    # The largest of many coefficients of noise is some four times their standard deviation.
    noise = np.maximum(jumps.rounding(len(zones)), 4 * np.sqrt(2) * forcing.resolution.rounding)
    found: list[tuple[Index, Array]] = []
    # The last two sizes and tails of each zone so far.
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
            # Places are rounded to half a unit in their last digit: what that makes of the slope of
            # g is seen in all coefficients.
            rounded = (
                place_rounding(zones, group)
                * root_of_squares(g, np.arange(1.0, int(n) + 1))
                * (2 / np.sqrt(n))
            )
            grow = (
                last > np.maximum(tolerance * scale, np.maximum(rounded, noise[group] / np.sqrt(n)))
            ) & (n < largest)
            grow &= (n < MOST_OWN) | (last <= _NEARLY * scale)
            # A jump of g itself leaves coefficients ~ 1/n, rounding ~ 1/sqrt(n): what falls no
            # faster is rounding. Sizes two steps apart are in the ratio of two: beside knots what
            # one size tells may beat with the next.
            slow = (tails[group, 1] >= 0) & (
                last[:, None] > tails[group] * (sizes[group] / n) ** 0.75
            ).all(axis=1)
            sizes[group], tails[group] = sizes[group][:, [1, 1]], tails[group][:, [1, 1]]
            sizes[group, 1], tails[group, 1] = n, last
            # Nor do fewer nodes than tell the pieces between jumps show how what these leave falls.
            calm[group] += slow & (last < _NOISE * scale) & (n >= _TO_A_PIECE * knots[group])
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
    """Of long series whose coefficients have stopped falling half way to their end, those that are
    rounding are none: beside an end their sum grows as n^1.5, that of fewer from as many nodes by
    less.
    """
    for zone in zones[own[zones] >= _LONG]:
        n = int(own[zone])
        size = np.abs(table[zone, : n + 1])
        if size[n // 2 : n - n // 8].max() <= _PLATEAU * tail[zone] <= _NOISE * size.max():
            told = int(np.flatnonzero(size > 2 * tail[zone]).max(initial=0))
            table[zone, told + max(_LEFT, told // 8) + 1 :] = 0.0


def place_rounding(zones: Zones, group: Index) -> Array:
    """Spacing of numbers at zones over their half widths."""
    return np.asarray(
        np.spacing(np.maximum(np.abs(zones.a[group]), np.abs(zones.b[group]))) / zones.half[group]
    )


def mirror(zones: Zones, table: Array) -> None:
    """Fill the left half of a symmetric set's coefficient table from the right half: T_k(-t) =
    (-1)^k T_k(t).
    """
    left = np.arange(len(zones) // 2)
    table[left] = table[::-1][left] * (1.0 - 2.0 * (np.arange(table.shape[1]) % 2))


def _values(
    forcing: Forcing, zones: Zones, jumps: ForcingJumps, group: Index, n: int
) -> tuple[Array, Array]:
    """(the smooth part of g at the nodes of zones, the largest of g itself on each)."""
    _, right, left = chebyshev.lobatto(n)
    left, right = left[1:-1], right[1:-1]
    w = zones.half[group][:, None]
    end = np.where(left <= right, zones.a[group][:, None], zones.b[group][:, None])
    # From the ends as positions, of which rounding has cut off the rest.
    rest = zones.rest[:, group][:, :, None]
    away = w * np.where(left <= right, left, -right) + np.where(left <= right, rest[0], rest[1])
    # Each zone's nodes, one zone after the other.
    of_jumps = np.repeat(group, len(left)), np.tile(left, len(group))
    if float(place_rounding(zones, group).max()) > _FINE:
        # What a jump adds to the slope is none of g's on either side.
        levels = jumps.level_part(*of_jumps).reshape(len(group), -1)
        values = forcing.sampled(end, away, lambda g: chebyshev.slopes(g + levels) / w)
    else:
        x = end + away
        values = np.array(forcing.value(x.ravel()), dtype=float).reshape(x.shape)
    given = np.abs(values).max(axis=1)
    return values + jumps.smooth_part(*of_jumps).reshape(values.shape), given


def conformal_radius(left: Array, right: Array) -> Array:
    """R, of distances to the neighbours; one of them may be infinite, and R is with both."""
    with np.errstate(divide="ignore"):
        return np.asarray(4 / (1 / left + 1 / right))


def felt(left: Array, right: Array) -> tuple[Array, Array]:
    """Parts of the left and of the right neighbour's level that are felt between them; they add up
    to one.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        # sqrt(left / right) is the tangent of half the angle that asin(s) is from -pi / 2.
        of_right = np.where(
            np.isinf(left) & np.isinf(right), 0.5, 2 / np.pi * np.arctan(np.sqrt(left / right))
        )
    return 1 - of_right, of_right
