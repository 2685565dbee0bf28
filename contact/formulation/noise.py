"""Noise of a function of an author's: rounding in heights that carry a constant, or in places that are counted from far away.

Differences of high order of values at even places leave noise alone: the k-th of independent values has the variance (2k)!/k!^2 times
theirs (J. J. More & S. M. Wild, Estimating Computational Noise, SIAM J. Sci. Comput. 33, 2011, 1292, doi 10.1137/100786125).
"""

import math

import numpy as np

from sie import Array

# The order of a difference, the places that it takes, and their step over a length on which a function goes through one wave at the most:
# (2 pi step)^6 is below rounding, and rounding of places up to 1e12 waves away makes shorter steps in the values.
ORDER = 6
PLACES = np.arange(ORDER + 1.0)
STEP = 3e-4
_SPREAD = math.sqrt(math.comb(2 * ORDER, ORDER))
# Median size of a normal variable over its standard deviation.
_MEDIAN = 0.6745


def deviations(values: Array) -> Array:
    """What each group of values (7, n) at even places differs from a smooth function by, as a standard deviation (n,)."""
    return np.asarray(np.abs(np.diff(values, ORDER, axis=0))[0] / _SPREAD)


def noise(values: Array) -> float:
    """Standard deviation of the noise of values (7, n) at even places, a few groups of which may meet corners."""
    return float(np.median(deviations(values))) / _MEDIAN
