"""`Pieces`: a periodic, piecewise quadratic function of mean zero with given jumps.

This function is subtracted from the slope of a profile so that the rest is smooth. Its second
derivative is constant between the places s_i of the jumps, and jumps there by J2. Its first
derivative jumps by J1 and its value by J0. All three follow by summation from place to place, up to
constants that make the value and the first derivative periodic. A second derivative is periodic
only if its jumps add up to 0.
"""

from functools import cached_property

import numpy as np

import sie
from sie import Array, Complex, record


@record
class Pieces(sie.Kept):
    """A periodic function that is a quadratic polynomial between neighbouring jumps.

    It is p_0 + p_1 (x - s_i) + p_2 (x - s_i)^2 between the places s_i and s_i+1.

    places: distances s_i (n,) from the start of the period. jumps: jumps of value, slope and second
    derivative (n, 3). coefficients: p_0, p_1, p_2 of each interval (n, 3).
    """

    start: float
    period: float
    places: Array
    jumps: Array
    coefficients: Array

    @classmethod
    def of(cls, start: float, period: float, at: Array, jumps: Array) -> "Pieces":
        """The periodic function with given jumps of its value, slope and second derivative.
        Row k of `jumps` (n, 3) holds the three jumps at the place `at[k]`.

        The jumps of the second derivative add up to 0. Jumps at one place are added.
        """
        places, which = np.unique((at - start) % period, return_inverse=True)
        value, slope, bend = (np.bincount(which, column, len(places)) for column in jumps.T)
        length = np.diff(places, append=places[:1] + period)
        second = _closed(np.cumsum(bend), length, slope.sum())
        first = _closed(
            np.cumsum(slope) + _before(second * length),
            length,
            value.sum() + 0.5 * float(second @ length**2),
        )
        zeroth = _closed(
            np.cumsum(value) + _before(first * length + 0.5 * second * length**2),
            length,
            float(0.5 * first @ length**2 + second @ length**3 / 6),
        )
        return cls(
            start,
            period,
            places,
            np.column_stack((value, slope, bend)),
            np.column_stack((zeroth, first, 0.5 * second)),
        )

    def __call__(self, x: Array) -> Array:
        t = (np.asarray(x, dtype=float) - self.start) % self.period
        if len(self.places) == 0:
            return np.zeros(t.shape)
        piece = np.searchsorted(self.places, t, side="right") - 1
        # A point before the first place (`piece` is -1) lies in the last interval, one period
        # earlier.
        away = t - self.places[piece] + np.where(piece < 0, self.period, 0.0)
        p = self.coefficients[piece].T
        return np.asarray(p[0] + away * (p[1] + away * p[2]))

    def conjugate(self, x: Array) -> Array:
        """The periodic Hilbert transform of this function f.

        It is (1/L) PV int f(xi) cot(pi (x - xi)/L) dxi, with the period L.

        The value must not jump. The time does not grow with the number of jumps.
        """
        t = (np.asarray(x, dtype=float) - self.start) % self.period
        return self._transform(np.where(t < self.places[0], t + self.period, t))

    def continued(self, t: Array, y: Array) -> tuple[Complex, Complex]:
        """The Hilbert transform of this function and its derivative, continued to points y >= 0.

        t: distances from the start of the period, moved to lie between the first place and the same
        place one period later.
        """
        return self._transform.in_plane(t + 1j * y)

    @cached_property
    def _transform(self) -> sie.PiecewiseTransform:
        ends = np.append(self.places, self.places[0] + self.period)
        kinks = self.jumps[:, 1] if self.jumps[:, 1].any() else None
        return sie.PiecewiseTransform(
            sie.hilbert(self.period), ends, self.coefficients, self.places, self.jumps[:, 2], kinks
        )


def _before(parts: Array) -> Array:
    """For each element of `parts`, the sum of all elements before it."""
    return np.asarray(np.cumsum(parts) - parts)


def _closed(values: Array, length: Array, more: float) -> Array:
    """Values on intervals, all shifted by one constant.
    `length` holds the widths of the intervals. After the shift, the sum of value times width is
    -`more`.
    """
    return np.asarray(values - (values @ length + more) / length.sum()) if len(values) else values
