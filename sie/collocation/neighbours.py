"""What the neighbours of a small zone do to it, where each holds its level.

To a load between them they are about the half-lines x < -g and x > g' of a grounded plane. z -> tan(asin(s)/2) takes the plane slit
along |s| > 1 to the disk, s counted from the middle of the gap in halves of it: so a load at the origin has the potential
log(r / R) near it, R = 4 g g' / (g + g') the conformal radius, and what the left one is lifted by is felt with the harmonic
measure 1/2 - asin(s) / pi, s = (g - g') / (g + g').
"""

import numpy as np

from sie.basis.arrays import Array


def conformal_radius(left: Array, right: Array) -> Array:
    """R, of distances to the neighbours; one of them may be infinite, and R is with both."""
    with np.errstate(divide="ignore"):
        return np.asarray(4 / (1 / left + 1 / right))


def felt(left: Array, right: Array) -> tuple[Array, Array]:
    """Parts of the left and of the right neighbour's level that are felt between them; they add up to one."""
    with np.errstate(invalid="ignore", divide="ignore"):
        # sqrt(left / right) is the tangent of half the angle that asin(s) is from -pi / 2.
        of_right = np.where(np.isinf(left) & np.isinf(right), 0.5, 2 / np.pi * np.arctan(np.sqrt(left / right)))
    return 1 - of_right, of_right
