"""Newton's step of two free ends that face each other across a narrow gap.

On the scale of a gap |x| < c the intensities of its two ends are no straight lines in their motion, and K pollutes the
slope A that Newton divides by. But there the density is that of a crack under what the merged zones would bear,
P_0 + P_1 x + P_2 x^2/2: outside the gap

    phi = |x| / sqrt(x^2 - c^2) (P_0 + P_2 (x^2 - c^2/2)/2) + sgn(x) P_1 (x^2 - c^2/2) / sqrt(x^2 - c^2),

so the two K and the two A tell P_0, P_1, P_2, and these the place where both K vanish: the middle moves by -P_1/P_2,
and the new half gap is sqrt(-4 P_0/P_2) there. With rho = K / (c S), S what is left of A without K:

    middle / c = -(rho_right - rho_left),
    (new half gap / c)^2 = 1 - 2 (rho_right + rho_left) + 2 (rho_right - rho_left)^2.

If the density changes sign from one end to the other, what lies between has a density like X of its own, and the last square is absent.
With a jump J of the density in it (a logarithm of the right side: `jumps.density`) part of S is that of a kink, (J/pi) sqrt(2/c),
whose integral grows with c and not with c^2; then it is the sum of both integrals that changes by -K sqrt(2 c). For small K all of
this is the plain step 2 K / A.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.arrays import Array, Mask


def facing(of_ends: NDArray[Any]) -> NDArray[Any]:
    """(2, Z) values of the ends across the gap: the left end of a zone faces the right end of the one before."""
    left, right = of_ends
    return np.array([np.roll(right, 1), np.roll(left, -1)])


def gap_steps(
    gaps: Array, widths: Array, moves: Mask, k: Array, slopes: Array, alike: bool, tips: Array | float = 0.0
) -> tuple[Array, Mask]:
    """(outward steps (2, Z), where they hold): for moving pairs across gaps (2, Z) narrower than both zones.

    k, slopes: K less its target and A, positive where a density of the right sign pushes outward. alike: whether the
    density has the same sign at both ends of a gap. tips: heights J of the tips in the gaps (2, Z), if it has not.
    """
    of_both = np.array([widths, widths])
    pairs = moves & facing(moves) & (gaps < np.minimum(of_both, facing(of_both)))
    if not np.any(pairs):
        return np.zeros_like(k), pairs
    c = np.where(pairs, 0.5 * gaps, 1.0)
    other = facing(k)
    straight = slopes - (0.75 * k + 1.5 * (k - other) if alike else -0.25 * k + 0.5 * (k - other)) / c
    beyond = facing(straight)
    holds = pairs & (straight > 0) & (beyond > 0)
    rho = k / np.where(holds, c * straight, 1.0)
    rho_other = other / np.where(holds, c * beyond, 1.0)
    shift = rho - rho_other
    less = 2 * (rho + rho_other) - (2 * shift**2 if alike else 0.0)
    # 1 - sqrt(1 - less) without cancellation; a gap that wants to close altogether moves by all of its half.
    closing = np.where(less < 1, less / (1 + np.sqrt(np.maximum(1 - less, 0.0))), 1.0)
    # Shares of S that are a wedge's, and of what closes: load (1 - e)^2 (1 - share) / 2 + (1 - e) share of the new half gap.
    share = np.clip(np.asarray(tips) / np.pi * np.sqrt(2 / c) / np.where(holds, 0.5 * (straight + beyond), 1.0), 0.0, 1.0)
    left = np.maximum(0.5 * (1 + share) - (rho + rho_other), 0.0)
    wedged = 1 - 2 * left / np.maximum(share + np.sqrt(share**2 + 2 * (1 - share) * left), 1e-300)
    closing = np.where(share > 0, np.where(left > 0, wedged, 1.0), closing)
    return np.where(holds, c * (shift + closing), 0.0), holds
