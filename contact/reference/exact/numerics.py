"""Elementary functions without cancellation, quadrature and roots, for the exact solutions.

Only numpy and scipy are imported here, so that solvers are judged by code they do not share.
"""

from collections.abc import Callable
from math import atan2, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]


def _tanh_sinh() -> tuple[Array, Array, Array]:
    """Nodes and weights of the double-exponential rule on (0, 1).
    Each node is given by its distances from 0 and from 1.

    The rule is exact to round-off if the function grows more slowly than 1/sqrt(distance) at the
    ends (Takahasi & Mori 1974).
    """
    step = 0.08
    tau = np.arange(-45, 46) * step
    growth = pi * np.sinh(tau)
    left, right = 1.0 / (1.0 + np.exp(-growth)), 1.0 / (1.0 + np.exp(growth))
    return left, right, step * pi * np.cosh(tau) * left * right


FROM_LEFT, FROM_RIGHT, WEIGHT = _tanh_sinh()


def integrated(function: Callable[[Array, Array], Array], length: ArrayLike) -> Array:
    """Integral of a function from 0 to `length`.
    The arguments of the function are the distances from both ends of the interval. So the function
    can be computed accurately next to each end.

    `length` may be an array; the integral has its shape.
    """
    length = np.asarray(length, dtype=np.float64)
    values = function(length[..., None] * FROM_LEFT, length[..., None] * FROM_RIGHT)
    # A pairwise sum has less round-off than a product of vectors.
    return np.asarray(length * np.sum(WEIGHT * values, axis=-1))


def root(
    function: Callable[[float], float], low: float, high: float, xtol: float = 1e-300
) -> float:
    """The root to round-off between `low` and `high`, where the function has opposite signs."""
    return float(brentq(function, low, high, xtol=xtol, rtol=1e-15))


def roots(function: Callable[[float], float], samples: Array) -> list[float]:
    """One root between each two neighbouring samples at which the function has opposite signs."""
    values = np.array([function(float(s)) for s in samples])
    changes = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    return [root(function, samples[i], samples[i + 1]) for i in changes]


def least_value(function: Callable[[Array], Array], low: float, high: float, samples: int) -> float:
    """The smallest value of a smooth function between `low` and `high`.
    It is found by finer and finer samples around the smallest sample.
    """
    x = np.linspace(low, high, samples)
    y = function(x)
    best, half = float(x[np.argmin(y)]), float(x[1] - x[0])
    for _ in range(8):  # the bracket shrinks to 1e-7 of a sample: the value is right to round-off
        x = np.clip(best + half * np.linspace(-1.0, 1.0, 33), low, high)
        y = function(x)
        best, half = float(x[np.argmin(y)]), half / 8.0
    return float(np.min(y))


def arcosh1p(y: ArrayLike) -> Array:
    """arcosh(1 + y), accurate for small y >= 0."""
    return np.asarray(2.0 * np.arcsinh(np.sqrt(0.5 * np.asarray(y))))


def sinh_minus(y: ArrayLike) -> Array:
    """sinh(y) - y without cancellation."""
    y = np.asarray(y, dtype=float)
    z = np.where(np.abs(y) < 1.0, y, 0.0)
    series, term = np.zeros_like(z), z * z * z / 6.0
    for k in range(2, 11):  # 1/21! is below round-off at y = 1
        series += term
        term = term * z * z / (2 * k * (2 * k + 1))
    return np.where(np.abs(y) < 1.0, series, np.sinh(y) - y)


def zone_potential(z_minus_1: ArrayLike) -> Array:
    """z sqrt(z^2 - 1) - arcosh z: the shape of the gap outside a Hertz zone that ends at z = 1."""
    return np.asarray(0.5 * sinh_minus(2.0 * arcosh1p(z_minus_1)))


# The next functions are for a periodic zone. For an isolated zone (`period` None), sin(pi x/L) is
# replaced by x, and cos(pi x/L) by 1.


def sine(x: ArrayLike, period: float | None) -> Array:
    """Value of sin(pi x/L) for the period L; the value x if the period is None."""
    x = np.asarray(x, dtype=np.float64)
    return x if period is None else np.asarray(np.sin(pi / period * x))


def cosine(x: ArrayLike, period: float | None, inward: Array | float = 0.0) -> Array:
    """Value of cos(pi (x - inward)/L) without cancellation near L/2; 1 if the period L is None."""
    if period is None:
        return np.ones(np.shape(inward))
    return sine(0.5 * period - np.asarray(x) + inward, period)


def sine_excess(x: ArrayLike, e: ArrayLike, period: float | None) -> Array:
    """Value of sin(pi (x + e)/L)/sin(pi x/L) - 1, accurate for small e.
    If the period L is None, it is e/x.

    The arguments satisfy e >= 0 and x + e <= L/2.
    """
    half = 0.5 * np.asarray(e)
    cosine_middle = np.maximum(cosine(x, period, -half), 0.0)
    return np.asarray(2.0 * cosine_middle * sine(half, period) / sine(x, period))


def log_of(s: ArrayLike, c: ArrayLike) -> Array:
    """Logarithm ln(s) of a sine s > 0 whose cosine is c >= 0, accurate for s near 1."""
    s, c = np.asarray(s), np.asarray(c)
    return np.asarray(np.where(s < c, np.log(s), 0.5 * np.log1p(-(np.minimum(s, c) ** 2))))


def half_width_from_sine(s: float, c: float, period: float) -> float:
    """The half width a with sin(pi a/L) = s and cos(pi a/L) = c."""
    return period / pi * atan2(s, c)
