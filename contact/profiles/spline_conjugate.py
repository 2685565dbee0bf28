"""Hilbert transform of the slope of a uniform periodic cubic spline, exact to rounding.

With B-spline coefficients c_j and pitch h, f' = (1/h) sum_j (c_j - c_(j-1)) B(t - j + 1/2), t = (x - x0)/h, B the
quadratic B-spline, and H f' has the same form with
    Psi(t) = H B(t) = (1/2 pi) sum_l J_l (t - l)^2 ln|t - l|,   J = 1, -3, 3, -1 at l = -3/2, -1/2, 1/2, 3/2,
           = (1/pi) sum_p M_2p t^(-2p-1) for large |t|,         M_2p the moments of B,
summed over the images t + nk by Hurwitz zeta. In each interval between knots the nearest six singularities
(1/2 pi) J tau^2 ln|tau| of H f' are kept in closed form; what is left is analytic there and is held as a
Chebyshev series, made for all intervals at once by convolutions. Differences of c, not c itself: the slope of a
smooth profile is small beside c/h and would be lost in its rounding. (B-splines: Schoenberg 1946; the rest is
derived here and tested against polylogarithms.)
"""

from __future__ import annotations

from math import ceil, factorial, pi

import numpy as np
from numpy.typing import NDArray

from contact.lazy import scipy_special

Array = NDArray[np.float64]

_KNOTS = (-1.5, -0.5, 0.5, 1.5)
_JUMPS = (1.0, -3.0, 3.0, -1.0)
_FAR = 8.0  # from here the moment series: (1.5/8)^(2p) is below rounding at the last p
_MOMENTS = [
    (2 * 1.5 ** (2 * p + 3) - 6 * 0.5 ** (2 * p + 3)) * factorial(2 * p) / factorial(2 * p + 3)
    for p in range(12)
]
_NEAR = np.arange(-2, 4)  # knots kept in closed form, counted from the left end of the interval
_NODES = (
    16  # the nearest knot left out is 3 pitches off the interval: an error of (3.5*2 + sqrt(48))^-16 = 4e-19
)


class SplineConjugate:
    """H f' for the periodic spline through `values` at x0 + h j, j = 0..n-1, n >= 4, of period n h."""

    def __init__(self, values: Array, x0: float, period: float) -> None:
        self.n = values.size
        self.x0 = x0
        self.pitch = period / self.n
        half_turn = pi * np.arange(self.n // 2 + 1) / self.n
        coefficients = 3 * np.fft.rfft(values - values.mean()) / (2 + np.cos(2 * half_turn)) / self.pitch
        # The factor of a backward difference, without the rounding of 1 - exp(-2i half_turn).
        difference = 2j * np.sin(half_turn) * np.exp(-1j * half_turn)
        spectrum = coefficients * difference
        # The fourth difference about each point, again by its factor.
        self.jumps = np.fft.irfft(coefficients * (2 * np.sin(half_turn)) ** 4, self.n)
        u = 0.5 - 0.5 * np.cos(pi * (np.arange(_NODES) + 0.5) / _NODES)
        rest = np.empty((_NODES, self.n))
        for q in range(_NODES):
            whole = np.fft.irfft(
                spectrum * np.fft.rfft(_periodic(u[q] + 0.5 + np.arange(self.n), self.n)), self.n
            )
            rest[q] = whole - self._near(np.arange(self.n), np.full(self.n, u[q]))
        angle = pi * (np.arange(_NODES) + 0.5) / _NODES
        transform = 2 / _NODES * np.cos(np.outer(np.arange(_NODES), angle))
        transform[0] /= 2
        # The nodes run from u = 0 up, that is from s = 2u - 1 = -1 up: T_k changes sign with k odd.
        self.series = (-1.0) ** np.arange(_NODES)[:, None] * (transform @ rest)

    def __call__(self, x: Array) -> Array:
        t = (x - self.x0) / self.pitch
        interval = np.floor(t)
        u = t - interval
        i = interval.astype(np.int64) % self.n
        s = 2 * u - 1
        b1 = np.zeros(x.shape)
        b2 = np.zeros(x.shape)
        for row in self.series[:0:-1]:
            b1, b2 = row[i] + 2 * s * b1 - b2, b1
        return np.asarray(self.series[0][i] + s * b1 - b2 + self._near(i, u))

    def _near(self, i: NDArray[np.int64], u: Array) -> Array:
        total = np.zeros(u.shape)
        for knot in _NEAR:
            total += self.jumps[(i + knot) % self.n] * _kappa(u - knot)
        return total


def _kappa(tau: Array) -> Array:
    """(1/2 pi) tau^2 ln|tau|: what a unit jump of f''' leaves in H f'."""
    size = np.abs(tau)
    return np.asarray(tau * tau * np.log(np.where(size == 0, 1.0, size)) / (2 * pi))


def _alone(t: Array) -> Array:
    """Psi(t)."""
    near = np.abs(t) < _FAR
    out = np.zeros(t.shape)
    out[near] = sum(j * _kappa(t[near] - k) for j, k in zip(_JUMPS, _KNOTS, strict=True))
    inverse = 1 / t[~near]
    power = inverse / pi
    far = np.zeros(inverse.shape)
    for moment in _MOMENTS:
        far += moment * power
        power *= inverse * inverse
    out[~near] = far
    return out


def _periodic(t: Array, n: int) -> Array:
    """sum_k Psi(t + nk): the images nearer than _FAR + 4 by Psi itself, the rest by the moments."""
    t = t - n * np.rint(t / n)
    images = max(0, ceil((_FAR + 4) / n - 0.5))
    out = np.asarray(sum(_alone(t + n * k) for k in range(-images, images + 1)))
    special = scipy_special()
    ahead, behind = images + 1 + t / n, images + 1 - t / n
    for p, moment in enumerate(_MOMENTS):
        s = 2 * p + 1
        # Pairs k and -k: the series of s = 1 converges as they stand together.
        if s == 1:
            tail = special.digamma(behind) - special.digamma(ahead)
        else:
            tail = special.zeta(s, ahead) - special.zeta(s, behind)
        out += moment / pi * tail / float(n) ** s
    return out
