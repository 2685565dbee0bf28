"""Newton's step of a free end that has something close by: a jump of the right side, or another end
across a narrow gap.

A jump J > 0 at distance r inside an end puts C / sqrt(r) into the slope A of the density there, C =
(J/pi) sqrt(2 l), l the distance of the jump from the other end over the half width: on the scale of
r, K is no straight line in the end's motion. The part that is not is known, so the step solves

    K - (A - C / sqrt(r)) delta / 2 - C (sqrt(r + delta) - sqrt(r)) = 0,

where an end that passes the jump inward leaves the root behind, and one that passes a jump outward
takes it up.

A logarithm (J/pi) ln|x - s| of the right side, J > 0, at distance y outside an end does the same
mirrored (`jumps.exterior`): it puts 2 J / (pi sqrt(y)) into A, and 2 J sqrt(y) / pi into K, which
it leaves where the end passes it outward. An end never passes one with J < 0 inward: the density
would have the wrong sign all about it.

On the scale of a gap |x| < c the intensities of its two ends are no straight lines in their motion,
and K pollutes the slope A that Newton divides by. But there the density is that of a crack under
what the merged zones would bear, P_0 + P_1 x + P_2 x^2/2: outside the gap

    phi = |x| / sqrt(x^2 - c^2) (P_0 + P_2 (x^2 - c^2/2)/2) + sgn(x) P_1 (x^2 - c^2/2) / sqrt(x^2 -
    c^2),

so the two K and the two A tell P_0, P_1, P_2, and these the place where both K vanish: the middle
moves by -P_1/P_2, and the new half gap is sqrt(-4 P_0/P_2) there. With rho = K / (c S), S what is
left of A without K:

    middle / c = -(rho_right - rho_left),
    (new half gap / c)^2 = 1 - 2 (rho_right + rho_left) + 2 (rho_right - rho_left)^2.

If the density changes sign from one end to the other, what lies between has a density like X of its
own, and the last square is absent. With a jump J of the density in it (a logarithm of the right
side: `jumps.density`) part of S is that of a kink, (J/pi) sqrt(2/c), whose integral grows with c
and not with c^2; then it is the sum of both integrals that changes by -K sqrt(2 c). For small K all
of this is the plain step 2 K / A.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import Array, Mask, wrapped
from sie.basis.zones import Zones
from sie.equation.equation import Forcing


def facing(of_ends: NDArray[Any]) -> NDArray[Any]:
    """(2, Z) values of the ends across the gap: the left end of a zone faces the right end of the
    one before.
    """
    left, right = of_ends
    return np.array([np.roll(right, 1), np.roll(left, -1)])


def gap_steps(
    gaps: Array,
    widths: Array,
    moves: Mask,
    k: Array,
    slopes: Array,
    alike: bool,
    tips: Array | float = 0.0,
) -> tuple[Array, Mask]:
    """(outward steps (2, Z), where they hold): for moving pairs across gaps (2, Z) narrower than
    both zones.

    k, slopes: K less its target and A, positive where a density of the right sign pushes outward.
    alike: whether the density has the same sign at both ends of a gap. tips: heights J of the tips
    in the gaps (2, Z), if it has not.
    """
    of_both = np.array([widths, widths])
    pairs = moves & facing(moves) & (gaps < np.minimum(of_both, facing(of_both)))
    if not np.any(pairs):
        return np.zeros_like(k), pairs
    c = np.where(pairs, 0.5 * gaps, 1.0)
    other = facing(k)
    straight = (
        slopes - (0.75 * k + 1.5 * (k - other) if alike else -0.25 * k + 0.5 * (k - other)) / c
    )
    beyond = facing(straight)
    holds = pairs & (straight > 0) & (beyond > 0)
    rho = k / np.where(holds, c * straight, 1.0)
    rho_other = other / np.where(holds, c * beyond, 1.0)
    shift = rho - rho_other
    less = 2 * (rho + rho_other) - (2 * shift**2 if alike else 0.0)
    # 1 - sqrt(1 - less) without cancellation; a gap that wants to close altogether moves by all of
    # its half.
    closing = np.where(less < 1, less / (1 + np.sqrt(np.maximum(1 - less, 0.0))), 1.0)
    # Shares of S that are a wedge's, and of what closes: load (1 - e)^2 (1 - share) / 2 + (1 - e)
    # share of the new half gap.
    share = np.clip(
        np.asarray(tips) / np.pi * np.sqrt(2 / c) / np.where(holds, 0.5 * (straight + beyond), 1.0),
        0.0,
        1.0,
    )
    left = np.maximum(0.5 * (1 + share) - (rho + rho_other), 0.0)
    wedged = 1 - 2 * left / np.maximum(share + np.sqrt(share**2 + 2 * (1 - share) * left), 1e-300)
    closing = np.where(share > 0, np.where(left > 0, wedged, 1.0), closing)
    return np.where(holds, c * (shift + closing), 0.0), holds


# A jump farther than this many plain steps away does not bend K noticeably: the plain step is
# quadratic there.
_FAR = 20.0
_HALVINGS = 60
# An end stops at this part of its way to a jump that it must not pass.
_SHORT_OF = 0.9


def bent_steps(
    forcing: Forcing,
    zones: Zones,
    period: float | None,
    k: Array,
    slopes: Array,
    plain: Array,
    inward: float,
    outward: float,
) -> Array:
    """Steps (2, Z) of the left and right ends: `plain` = 2 K / A but where a jump is near. No step
    is longer than `inward` or `outward` of the width there. k, slopes: K less its target, and A,
    positive where they push outward; A is 0 where it is not to be relied on.
    """
    of_density = forcing.density_jumps
    at, heights = forcing.logarithms if of_density else forcing.kinks
    width, steps = zones.b - zones.a, plain.copy()
    inside, outside = _nearest(zones, at[heights > 0], heights[heights > 0], period)
    # Where A is no guide yet, a jump outside is one: the end stops soon after it.
    guided = (slopes > 0) | ((not of_density) & (k > 0) & (outside[0] < width))
    bent = (np.minimum(inside[0], outside[0]) < np.minimum(width, _FAR * np.abs(plain))) & guided
    if np.any(bent):
        side = np.nonzero(bent)
        width = width[side[1]]
        (r, j_in), (y, j_out) = ((d[side], j[side]) for d, j in (inside, outside))
        c_in, c_out = (
            np.where(r < width, 2 * j_in / np.pi, 0.0),
            np.where(y < width, 2 * j_out / np.pi, 0.0),
        )
        if not of_density:
            c_in = c_in * np.sqrt(np.clip(1 - r / width, 0.0, 1.0))
        r, y = np.clip(r, 1e-300, width), np.clip(y, 1e-300, width)
        # What is in A already, and what lies on the other side of the end, by motions towards that.
        (c, here), (beyond, there), sign = (
            ((c_out, y), (c_in, r), -1.0) if of_density else ((c_in, r), (c_out, y), 1.0)
        )
        # Right on a jump A is infinite, and all of it is bent.
        with np.errstate(invalid="ignore"):
            straight = np.where(
                np.isinf(slopes[side]), 0.0, np.maximum(slopes[side] - c / np.sqrt(here), 0.0)
            )

        def intensity(delta: Array) -> Array:
            moved = sign * delta
            bend = c * (np.sqrt(np.maximum(here + moved, 0)) - np.sqrt(here)) + beyond * np.sqrt(
                np.maximum(moved - there, 0)
            )
            return np.asarray(k[side] - 0.5 * straight * delta - sign * bend)

        steps[side] = _root(intensity, -inward * width, outward * width, np.where(r < y, -r, y))
    if not of_density:
        return steps
    negative = _nearest(zones, at[heights < 0], heights[heights < 0], period)[0][0]
    return np.maximum(steps, -_SHORT_OF * negative)


def tips_between(forcing: Forcing, zones: Zones, period: float | None) -> Array:
    """Heights J > 0 of the logarithms of the right side that lie between zones, added up, on both
    sides (2, Z) of each.
    """
    at, heights = forcing.logarithms
    at, heights = wrapped(at[heights > 0], zones.a[0], period), heights[heights > 0]
    i = np.searchsorted(zones.a, at, side="right") - 1
    between = (i >= 0) & (at > zones.b[i])
    after = np.bincount(i[between], heights[between], minlength=len(zones))
    return np.array([np.roll(after, 1), after])


def corner_distances(forcing: Forcing, zones: Zones, period: float | None) -> Array:
    """Distance of each end (2, Z) from the nearest jump of g itself, within its zone or beyond;
    infinite where there is none.
    """
    inside, outside = _nearest(zones, *forcing.kinks, period)
    return np.minimum(inside[0], outside[0])


def _root(falls: Callable[[Array], Array], low: Array, high: Array, kink: Array) -> Array:
    """Where a function that falls passes zero between bounds, by halving the root of the distance
    from a kink: an end may come to lie nearer to it than any part of the step.
    """

    def at(root: Array) -> Array:
        return np.asarray(kink + np.sign(root) * root**2)

    low, high = (np.sign(bound - kink) * np.sqrt(np.abs(bound - kink)) for bound in (low, high))
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        further = falls(at(middle)) > 0
        low, high = np.where(further, middle, low), np.where(further, high, middle)
    return at(0.5 * (low + high))


def _nearest(
    zones: Zones, at: Array, heights: Array, period: float | None
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """(distance, height) of the nearest jump on the zone's side of each end, and of the nearest
    beyond it, (2, Z) each; infinite where there is none.
    """
    if period is not None:
        # Places as they are where kinks are located in zones: their distances from ends count
        # beyond the last digit.
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
    # One at the very place of an end lies on the side of what was cut off that.
    after_a = after_a - (zones.beyond_a(at[after_a - 1], each) > 0)
    after_b = after_b + (zones.before_b(at[after_b], each) > 0)
    inside = np.array([zones.beyond_a(at[after_a], each), zones.before_b(at[after_b - 1], each)])
    outside = -np.array([zones.beyond_a(at[after_a - 1], each), zones.before_b(at[after_b], each)])
    of_inside = np.array([heights[after_a], heights[after_b - 1]])
    of_outside = np.array([heights[after_a - 1], heights[after_b]])
    return (inside, of_inside), (outside, of_outside)
