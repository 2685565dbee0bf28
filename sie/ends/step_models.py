"""Newton's step of a free end whose intensity is not linear in its motion.

The intensity K of an end is not linear close to a jump of the right side, or at a narrow gap. A
jump J > 0 of the right side at distance r inside an end adds C / sqrt(r) to the edge slope A. Here
C is (J/pi) sqrt(2 l), with l the distance of the jump from the other end in half widths. On the
scale of r, K is not linear in the motion of the end. Its nonlinear part is known, and the step
delta solves

    K - (A - C / sqrt(r)) delta / 2 - C (sqrt(r + delta) - sqrt(r)) = 0.

If an end moves inward past the jump, the term with the square root vanishes. If it moves outward
past a jump, the term appears.

A logarithm (J/pi) ln|x - s| of the right side, J > 0, at distance y outside an end is the mirror
image (`jumps.exterior`). It adds 2 J / (pi sqrt(y)) to A and 2 J sqrt(y) / pi to K, until the end
moves outward past it. An end never moves inward past a logarithm with J < 0, because the density
around it would have the wrong sign.

On the scale of a gap |x| < c the intensities of its two ends are not linear in their motions. The
slope A by which Newton's method divides depends on K. On this scale the density is that of a crack
under the traction P_0 + P_1 x + P_2 x^2/2 that the merged zones would bear. Outside the gap

    phi = |x| / sqrt(x^2 - c^2) (P_0 + P_2 (x^2 - c^2/2)/2)
          + sgn(x) P_1 (x^2 - c^2/2) / sqrt(x^2 - c^2).

K and A at the two ends determine P_0, P_1 and P_2. These determine the gap for which both K vanish:
its middle moves by -P_1/P_2, and its new half width is sqrt(-4 P_0/P_2). With rho = K / (c S),
where S is A without its dependence on K,

    middle / c = -(rho_right - rho_left),
    (new half gap / c)^2 = 1 - 2 (rho_right + rho_left) + 2 (rho_right - rho_left)^2.

If the density changes sign across the gap, the last square is absent. If the density jumps by J in
the gap (a logarithm of the right side, see `jumps.density`), a kink contributes (J/pi) sqrt(2/c) to
S. The load that closes a gap has a part proportional to c, due to this term, and a part
proportional to c^2, due to the rest of S. The step changes the sum of both parts by -K sqrt(2 c).
For small K the step is always the plain one, 2 K / A.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import Array, Mask, record, wrapped
from sie.basis.zones import Zones
from sie.equation.forcing import Forcing

# A jump of the right side is ignored if its distance from the end exceeds this multiple of the
# end's uncorrected Newton step. Such a jump changes the step by less than 2 %, which the next step
# corrects. A root search would lose the digits of small steps.
_FARTHEST_JUMP = 20.0
# Largest inward step of an end towards a downward jump of the density, as a fraction of the
# distance between end and jump. The jump comes from a logarithm of the right side, and the end must
# not pass it.
_STOP_BEFORE = 0.9


def facing(of_ends: NDArray[Any]) -> NDArray[Any]:
    """Values (2, Z) rearranged: each end gets the value of the end that it faces across a gap.

    The left end of a zone faces the right end of the previous zone.
    """
    left, right = of_ends
    return np.array([np.roll(right, 1), np.roll(left, -1)])


def gap_steps(
    gaps: Array, widths: Array, moves: Mask, k: Array, slopes: Array, tips: Array | None
) -> tuple[Array, Mask]:
    """(outward steps (2, Z) at narrow gaps, mask of the ends at which these steps are valid).

    A gap is narrow if it is narrower than both zones next to it. gaps, moves, k, slopes: values
    (2, Z) at both ends of all zones. k is the intensity K minus the prescribed one, and slopes is
    the edge slope A. Signs are such that a density of the right sign has A > 0, and that K > 0
    drives the end outward. tips: None if the density has the same sign on both sides of a gap, else
    the heights J of the logarithms in the gaps (2, Z).
    """
    alike = tips is None
    of_both = np.array([widths, widths])
    pairs = moves & facing(moves) & (gaps < np.minimum(of_both, facing(of_both)))
    if not np.any(pairs):
        return np.zeros_like(k), pairs
    c = np.where(pairs, 0.5 * gaps, 1.0)
    other = facing(k)
    by_k = 0.75 * k + 1.5 * (k - other) if alike else -0.25 * k + 0.5 * (k - other)
    straight = slopes - by_k / c
    across = facing(straight)
    holds = pairs & (straight > 0) & (across > 0)
    rho = k / np.where(holds, c * straight, 1.0)
    rho_other = other / np.where(holds, c * across, 1.0)
    shift = rho - rho_other
    less = 2 * (rho + rho_other) - (2 * shift**2 if alike else 0.0)
    # `closing` is the decrease of the half gap, divided by the half gap. It is 1 - sqrt(1 - less),
    # computed without cancellation. If the gap closes, `closing` is 1, and each end of the gap
    # moves by half the gap's width.
    closing = np.where(less < 1, less / (1 + np.sqrt(np.maximum(1 - less, 0.0))), 1.0)
    # If the density jumps inside the gap, the jump contributes the fraction `share` to S. S is the
    # edge slope A without its dependence on the intensity K (head of this file). A gap of half
    # width (1 - e) c closes under the load (1 - e)^2 (1 - share) / 2 + (1 - e) share. This load
    # equals `left`, which determines e (`wedged` below).
    mean = np.where(holds, 0.5 * (straight + across), 1.0)
    share = np.clip(
        np.asarray(0.0 if tips is None else tips) / np.pi * np.sqrt(2 / c) / mean, 0.0, 1.0
    )
    left = np.maximum(0.5 * (1 + share) - (rho + rho_other), 0.0)
    wedged = 1 - 2 * left / np.maximum(share + np.sqrt(share**2 + 2 * (1 - share) * left), 1e-300)
    closing = np.where(share > 0, np.where(left > 0, wedged, 1.0), closing)
    return np.where(holds, c * (shift + closing), 0.0), holds


@record
class StepAtJumps:
    """Newton steps of ends that are close to a jump or a logarithm of the right side.

    largest: largest steps inward and outward, relative to the width of the zone.
    """

    forcing: Forcing
    zones: Zones
    period: float | None
    largest: tuple[float, float]

    def steps(self, k: Array, slopes: Array, plain: Array) -> Array:
        """Outward steps (2, Z): the Newton steps `plain`, corrected at ends close to a jump.

        k: intensity K minus the prescribed one, positive if it drives the end outward; slopes: edge
        slope A, positive if it has the right sign, and 0 where it is not reliable.
        """
        zones, of_density = self.zones, self.forcing.density_jumps
        at, heights = self.forcing.logarithms if of_density else self.forcing.kinks
        width, steps = zones.b - zones.a, plain.copy()
        rises = heights > 0
        inside, outside = _nearest(zones, at[rises], heights[rises], self.period)
        # If the edge slope A is not reliable, a jump of the right side outside the zone still
        # limits the step. The end stops soon after this jump.
        guided = (slopes > 0) | ((not of_density) & (k > 0) & (outside[0] < width))
        closest = np.minimum(inside[0], outside[0])
        bent = (closest < np.minimum(width, _FARTHEST_JUMP * np.abs(plain))) & guided
        if np.any(bent):
            steps[bent] = self._bent(np.nonzero(bent), k, slopes, inside, outside)
        if not of_density:
            return steps
        falls = heights < 0
        negative = _nearest(zones, at[falls], heights[falls], self.period)[0][0]
        return np.maximum(steps, -_STOP_BEFORE * negative)

    def _bent(
        self,
        side: tuple[Any, ...],
        k: Array,
        slopes: Array,
        inside: tuple[Array, Array],
        outside: tuple[Array, Array],
    ) -> Array:
        """Outward steps delta of the ends `side`, each next to a jump, after which K is as wanted.

        The equation for delta is at the head of this file. side: indices of these ends; inside,
        outside: (distance, height) of the nearest jump inside and outside the zone.
        """
        of_density = self.forcing.density_jumps
        width = (self.zones.b - self.zones.a)[side[1]]
        (r, j_in), (y, j_out) = ((d[side], j[side]) for d, j in (inside, outside))
        c_in = np.where(r < width, 2 * j_in / np.pi, 0.0)
        c_out = np.where(y < width, 2 * j_out / np.pi, 0.0)
        if not of_density:
            c_in = c_in * np.sqrt(np.clip(1 - r / width, 0.0, 1.0))
        r, y = np.clip(r, 1e-300, width), np.clip(y, 1e-300, width)
        # `c` and `here` are the coefficient and the distance of the jump that contributes to the
        # edge slope A. `c_other` and `there` are those of the jump that the end reaches in the
        # opposite direction.
        (c, here), (c_other, there), sign = (
            ((c_out, y), (c_in, r), -1.0) if of_density else ((c_in, r), (c_out, y), 1.0)
        )
        # If the end is exactly on a jump, the edge slope A is infinite. Then the change of the
        # intensity K has only the part with the square root, and no part linear in the motion of
        # the end.
        with np.errstate(invalid="ignore"):
            rest = np.maximum(slopes[side] - c / np.sqrt(here), 0.0)
        straight = np.where(np.isinf(slopes[side]), 0.0, rest)

        def intensity(delta: Array) -> Array:
            moved = sign * delta
            bend = c * (np.sqrt(np.maximum(here + moved, 0)) - np.sqrt(here))
            bend = bend + c_other * np.sqrt(np.maximum(moved - there, 0))
            return np.asarray(k[side] - 0.5 * straight * delta - sign * bend)

        inward, outward = self.largest
        return _root(intensity, -inward * width, outward * width, np.where(r < y, -r, y))


def logarithms_in_gaps(forcing: Forcing, zones: Zones, period: float | None) -> Array:
    """Sum (2, Z) of the heights J > 0 of the right side's logarithms in the gap at each end."""
    at, heights = forcing.logarithms
    at, heights = wrapped(at[heights > 0], zones.a[0], period), heights[heights > 0]
    i = np.searchsorted(zones.a, at, side="right") - 1
    between = (i >= 0) & (at > zones.b[i])
    after = np.bincount(i[between], heights[between], minlength=len(zones))
    return np.array([np.roll(after, 1), after])


def corner_distances(forcing: Forcing, zones: Zones, period: float | None) -> Array:
    """Distance of each end from the nearest jump of the right side (2, Z); inf if none."""
    inside, outside = _nearest(zones, *forcing.kinks, period)
    return np.minimum(inside[0], outside[0])


def _root(decreasing: Callable[[Array], Array], low: Array, high: Array, kink: Array) -> Array:
    """Zeros of a decreasing function between the bounds `low` and `high`, by bisection.

    The bisected variable is sgn(x - kink) sqrt(|x - kink|). It resolves roots close to the kink,
    however large the bounds are.
    """

    def at(root: Array) -> Array:
        return np.asarray(kink + np.sign(root) * root**2)

    low, high = (np.sign(bound - kink) * np.sqrt(np.abs(bound - kink)) for bound in (low, high))
    for _ in range(np.finfo(np.float64).bits):  # halvings that exhaust the digits of a number
        middle = 0.5 * (low + high)
        positive = decreasing(at(middle)) > 0
        low, high = np.where(positive, middle, low), np.where(positive, high, middle)
    return at(0.5 * (low + high))


def _nearest(
    zones: Zones, at: Array, heights: Array, period: float | None
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Pairs (distance, height) of the jumps nearest to each end, inside and outside the zone.

    Each array is (2, Z). The distance is infinite if there is no such jump.
    """
    if period is not None:
        # The positions are shifted by periods exactly as in `ForcingJumps.located`, because a
        # distance from an end can be below the last digit of a position.
        turns = np.ceil((zones.a[0] - at) / period)
        at, heights = (
            np.concatenate([at + (turns + k) * period for k in (-1, 0, 1)]),
            np.tile(heights, 3),
        )
    order = np.argsort(at)
    at, heights = (
        np.concatenate(([-np.inf], at[order], [np.inf])),
        np.concatenate(([0.0], heights[order], [0.0])),
    )
    each = np.arange(len(zones))
    after_a, after_b = (
        np.searchsorted(at, zones.a, side="right"),
        np.searchsorted(at, zones.b, side="left"),
    )
    # A jump may be at the rounded position of an end. Then the digits of the end below the rounding
    # (`Zones.rest`) decide whether the jump is inside or outside.
    after_a = after_a - (zones.beyond_a(at[after_a - 1], each) > 0)
    after_b = after_b + (zones.before_b(at[after_b], each) > 0)
    inside = np.array([zones.beyond_a(at[after_a], each), zones.before_b(at[after_b - 1], each)])
    outside = -np.array([zones.beyond_a(at[after_a - 1], each), zones.before_b(at[after_b], each)])
    of_inside = np.array([heights[after_a], heights[after_b - 1]])
    of_outside = np.array([heights[after_a - 1], heights[after_b]])
    return (inside, of_inside), (outside, of_outside)
