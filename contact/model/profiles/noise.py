"""Noise of a function: rounding of heights with a large constant, or of places far from x = 0.

In a difference of high order of values at equally spaced places, the smooth part vanishes and only
the noise remains. If the noise of the values is independent, the variance of the difference of
order k is (2k)! / k!^2 times the variance of the noise (J. J. More & S. M. Wild, Estimating
Computational Noise, SIAM J. Sci. Comput. 33, 2011, 1292, doi 10.1137/100786125).
"""

import math
from collections.abc import Callable

import numpy as np

from sie import Array

EPS = float(np.finfo(np.float64).eps)
# Two numbers whose relative difference is below this count as equal. The difference is then taken
# for round-off.
ROUND_OFF = 4096 * EPS
# Weights of the sixth difference of seven values at equally spaced places.
WEIGHTS = np.array([1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0])
PLACES = np.arange(len(WEIGHTS), dtype=np.float64)
# Step between two neighbouring places, relative to the shortest wavelength of a function. The sixth
# difference of a wave of this wavelength is about (2 pi STEP)^6 of its amplitude, below round-off.
# At up to 1e12 wavelengths from x = 0, the round-off of a place is smaller than a step.
STEP = 3e-4
# Median of the absolute value of a normal variable, in standard deviations.
MEDIAN = 0.6745
_SPREAD = math.sqrt(WEIGHTS @ WEIGHTS)


def deviations(values: Array) -> Array:
    """Deviation of seven equally spaced values from a smooth function, for each column (7, n).

    A column has the values at seven equally spaced places.
    """
    return np.asarray(np.abs(np.tensordot(WEIGHTS, values, axes=1)) / _SPREAD)


def noise(values: Array) -> float:
    """Standard deviation of the noise of `values` (7, n), with columns as in `deviations`.

    It is computed from a median, so that a few groups may contain corners.
    """
    return float(np.median(deviations(values))) / MEDIAN


def rounding(values: Array) -> float:
    """Round-off of the largest of the `values` (7, n), plus four times the noise of the values."""
    finite = np.isfinite(values)
    largest = float(np.abs(values).max(initial=0.0, where=finite))
    return EPS * largest + 4.0 * noise(values)


def noise_at(function: Callable[[Array], Array], x: Array, length: float) -> float:
    """Round-off and noise of the values of a function near the places x.

    length: the shortest wavelength of the function.
    """
    at = x + STEP * length * PLACES[:, None]
    return rounding(np.asarray(function(at), dtype=np.float64))
