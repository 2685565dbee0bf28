"""Hilbert transform of the slope of a uniform periodic cubic spline, exact to rounding.

With B-spline coefficients c_j and pitch h, f' = (1/h) sum_j c_j B'(t - j), t = (x - x0)/h, and H f' has the
same form with
    Phi(t) = H B'(t) = (1/2 pi) sum_l J_l (t - l)^2 ln|t - l|,   J = 1, -4, 6, -4, 1 at l = -2..2,
         ~ -(1/pi) sum_p (2p + 1) M_2p t^(-2p-2),                |t| large, M_2p the moments of B,
summed over the images t + nk by Hurwitz zeta. In each interval between knots the nearest six singularities
(1/2 pi) J tau^2 ln|tau| are kept in closed form; what is left is analytic there and is held as a Chebyshev
series, made for all intervals at once by convolutions. (Spline theory: Schoenberg 1946; the rest is derived
here and tested by quadrature.)
"""

from __future__ import annotations

from math import ceil, factorial, pi

import numpy as np
from numpy.typing import NDArray

from contact.lazy import scipy_special

Array = NDArray[np.float64]

_JUMPS = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
_FAR = 8.0  # from here the moment series: (2/8)^(2p) is below rounding at the last p
_MOMENTS = [(2.0 ** (2 * p + 5) - 8.0) * factorial(2 * p) / factorial(2 * p + 4) for p in range(14)]
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
        turn = 2 * pi * np.arange(self.n // 2 + 1) / self.n
        spectrum = 3 * np.fft.rfft(values - values.mean()) / (2 + np.cos(turn)) / self.pitch
        c = np.fft.irfft(spectrum, self.n)
        self.jumps = sum(j * np.roll(c, s) for j, s in zip(_JUMPS, range(-2, 3), strict=True))
        u = 0.5 - 0.5 * np.cos(pi * (np.arange(_NODES) + 0.5) / _NODES)
        rest = np.empty((_NODES, self.n))
        for q in range(_NODES):
            whole = np.fft.irfft(
                spectrum * np.fft.rfft(_phi_periodic(u[q] + np.arange(self.n), self.n)), self.n
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


def _phi(t: Array) -> Array:
    near = np.abs(t) < _FAR
    out = np.zeros(t.shape)
    out[near] = sum(j * _kappa(t[near] - k) for j, k in zip(_JUMPS, range(-2, 3), strict=True))
    square = t[~near] ** -2.0
    power = square.copy()
    far = np.zeros(square.shape)
    for p, moment in enumerate(_MOMENTS):
        far -= (2 * p + 1) * moment / pi * power
        power *= square
    out[~near] = far
    return out


def _phi_periodic(t: Array, n: int) -> Array:
    """sum_k Phi(t + nk): the images at less than _FAR + 4 by Phi itself, the rest by the moments."""
    t = t - n * np.rint(t / n)
    images = max(0, ceil((_FAR + 4) / n - 0.5))
    out = np.asarray(sum(_phi(t + n * k) for k in range(-images, images + 1)))
    zeta = scipy_special().zeta
    for p, moment in enumerate(_MOMENTS):
        s = 2 * p + 2
        tail = zeta(s, images + 1 + t / n) + zeta(s, images + 1 - t / n)
        out -= (2 * p + 1) * moment / pi * tail / float(n) ** s
    return out
