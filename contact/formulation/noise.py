"""Noise of a function: rounding of heights with a large constant, or of places far from x = 0.

A difference of high order of values at even places leaves their noise alone: that of order k of
independent values has the variance (2k)! / k!^2 times theirs (J. J. More & S. M. Wild, Estimating
Computational Noise, SIAM J. Sci. Comput. 33, 2011, 1292, doi 10.1137/100786125).
"""

import math

import numpy as np

from sie import Array

# The step is a part of the shortest wave: (2 pi step)^6 is below rounding. Places are rounded to
# less than a step up to 1e12 waves from x = 0.
ORDER = 6
PLACES = np.arange(ORDER + 1.0)
STEP = 3e-4
_SPREAD = math.sqrt(math.comb(2 * ORDER, ORDER))
# Median of the size of a normal variable, over its standard deviation.
_MEDIAN = 0.6745


def deviations(values: Array) -> Array:
    """Deviation of each group of values (7, n) at even places from a smooth function (n,)."""
    return np.asarray(np.abs(np.diff(values, ORDER, axis=0))[0] / _SPREAD)


def noise(values: Array) -> float:
    """Standard deviation of the noise of values (7, n) at even places.

    It is a median, so that a few groups may contain corners.
    """
    return float(np.median(deviations(values))) / _MEDIAN
