"""Roots of functions of one variable, to rounding."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from contact.reference.exact.base import Array


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """The root between two places of opposite sign."""
    return float(brentq(function, low, high, xtol=1e-300, rtol=1e-15))


def roots(function: Callable[[float], float], samples: Array) -> list[float]:
    """Every root between samples of opposite sign."""
    values = np.array([function(float(s)) for s in samples])
    changes = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    return [root(function, samples[i], samples[i + 1]) for i in changes]
