"""Long trigonometric sums at any points, by a fast Fourier transform onto a finer grid.

The sum Re sum_k c_k exp(2 pi i k x) over k = 1 ... K is computed in three steps. The c_k are
divided by the Fourier transform of a short kernel psi; the result is transformed to a grid of
n > 4 K points; the values on the grid are convolved with psi. This kernel is
psi(d) = exp(b (sqrt(1 - d^2) - 1)), with d the distance in units of W/2 grid cells. W = 16 leaves
an error of 1e-15. A. H. Barnett, J. Magland & L. af Klinteberg (2019), SIAM J. Sci. Comput. 41,
C479-C504, doi 10.1137/18M120885X.
"""

from functools import lru_cache
from typing import Any

import numpy as np
import scipy.fft

import sie
from sie import Array, Complex, record

# Half width and width of the spreading kernel psi, in cells of the grid.
_HALF = 8
WIDTH = _HALF + _HALF
# Steepness b of the spreading kernel for a grid twice as fine as necessary: section 4 of the paper
# cited at the head of this module.
_STEEP = 0.98 * np.pi * WIDTH * 0.75
# Number of points that are computed at once, so that the values of their kernels stay in the
# processor's cache.
BLOCK = 1 << 14
# Time to compute the sum at one point, in units of the time of a term of `sie.in_threads`.
TERMS_PER_POINT = 300


@lru_cache(maxsize=4)
def _transform(harmonics: int, n: int) -> Array:
    """Fourier transform of the spreading kernel psi (head of this module) at k = 1 ...
    `harmonics`, on a grid of n points.
    """
    t, weights = np.polynomial.legendre.leggauss(4 * WIDTH)
    right = t > 0
    values = 2 * _HALF * weights[right] * np.exp(_STEEP * (np.sqrt(1 - t[right] ** 2) - 1))
    wave = 2 * np.pi / n * _HALF * np.arange(1, harmonics + 1)
    out = np.zeros(harmonics)
    for place, value in zip(t[right], values, strict=True):
        out += value * np.cos(wave * place)
    out.setflags(write=False)
    return out


@record
class Sum:
    """The sum Re sum_{k >= 1} c_k exp(2 pi i k x), stored as its values at n points of a grid.
    The unit of x is the period.

    The first values are repeated at the end.
    """

    values: Array
    n: int

    @classmethod
    def of(cls, c: Complex) -> "Sum":
        # If n is a power of two, multiplying a place by n causes no round-off.
        n = 1 << int(np.ceil(np.log2(4 * (c.size + 1))))
        spectrum = np.zeros(n // 2 + 1, dtype=np.complex128)
        spectrum[1 : c.size + 1] = 0.5 * n * c / _transform(c.size, n)
        values = scipy.fft.irfft(spectrum, n)
        return cls(values[np.arange(n + WIDTH) % n], n)  # a short grid is repeated more than once

    def __call__(self, turns: Array, rest: Array | None = None) -> Array:
        """Values (m,) of the sum at the places turns + rest, counted in periods.
        `rest` is the round-off of `turns`, if it is known.

        Sums of many terms need `rest`.
        """
        out = np.empty(turns.size)

        def blocks(begin: int, end: int) -> None:
            for start in range(begin * BLOCK, min(end * BLOCK, turns.size), BLOCK):
                here = slice(start, start + BLOCK)
                out[here] = self._block(turns[here], None if rest is None else rest[here])

        starts = np.arange(0, turns.size + BLOCK, BLOCK) * TERMS_PER_POINT
        sie.in_threads(blocks, starts)
        return out

    def _block(self, turns: Array, rest: Array | None) -> Array:
        """The values of the sum at one block of places; `turns` and `rest` are as in `__call__`."""
        place = turns * self.n
        first = np.ceil(place - _HALF)
        away = place - first
        if rest is not None:
            away += rest * self.n
        away /= _HALF
        with np.errstate(invalid="ignore"):
            index = first.astype(np.intp) % self.n
        total = np.zeros(place.size)
        for j in range(WIDTH):
            d = away - j / _HALF
            total += self.values[index + j] * np.exp(
                _STEEP * (np.sqrt(np.maximum(1 - d * d, 0.0)) - 1)
            )
        return total


def coefficients(weights: Array, turns: Array, count: int) -> Complex:
    """The sums over j of w_j exp(-2 pi i k x_j) for k = 1 ... `count`.
    Here w_j are the `weights` (m,), and x_j are the places `turns` (m,), counted in periods.

    This is the transpose of evaluating a `Sum`. The error is about 1e-15 sum |w_j|.
    """
    n = 1 << int(np.ceil(np.log2(4 * (count + 1))))
    place = turns * n
    first = np.ceil(place - _HALF)
    away, index = (place - first) / _HALF, first.astype(np.intp)
    grid = np.zeros(n)
    for j in range(WIDTH):
        d = away - j / _HALF
        psi = np.exp(_STEEP * (np.sqrt(np.maximum(1 - d * d, 0.0)) - 1))
        grid += np.bincount((index + j) % n, weights * psi, minlength=n)
    return np.asarray(scipy.fft.rfft(grid)[1 : count + 1] / _transform(count, n))


def in_turns(x: Array, period: float) -> tuple[Array, Array]:
    """x / period as two floats: the quotient, and its round-off error.

    (T. J. Dekker's exact product, Numer. Math. 18, 1971, 224.)
    """
    turns = x / period
    product = turns * period
    (high, low), (period_high, period_low) = _halves(turns), _halves(np.float64(period))
    error = (
        (high * period_high - product) + high * period_low + low * period_high
    ) + low * period_low
    return turns, np.asarray(((x - product) - error) / period)


def _halves(x: Any) -> tuple[Any, Any]:
    """x as the sum of two numbers, each of which has half the digits."""
    large = 134217729.0 * x
    high = large - (large - x)
    return high, x - high
