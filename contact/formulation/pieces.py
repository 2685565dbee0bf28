"""A periodic, piecewise quadratic function without mean, with given jumps: what is taken out of a
slope so that the rest is smooth.

Between places s_i the second derivative is constant, and it jumps by J2 where the slope does by J1
and the value by J0: sums from place to place, closed by the constants that make the function and
its slope periodic. A second derivative repeats only if its jumps add up to nothing.
"""

from functools import cached_property

import numpy as np

import sie
from sie import Array, record


@record
class Pieces(sie.Kept):
    """p_0 + p_1 (x - s_i) + p_2 (x - s_i)^2 from s_i to s_i+1, coefficients (n, 3), places s (n,)
    counted from the start of the period; jumps (n, 3): those of value, slope and second derivative.
    """

    start: float
    period: float
    places: Array
    jumps: Array
    coefficients: Array

    @classmethod
    def of(cls, start: float, period: float, at: Array, jumps: Array) -> "Pieces":
        """With these jumps (n, 3), of which those of the second derivative add up to nothing, at
        places x (n,) in any order; at one place they are added.
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
        # Before the first place lies the end of the last piece.
        away = t - self.places[piece] + np.where(piece < 0, self.period, 0.0)
        p = self.coefficients[piece].T
        return np.asarray(p[0] + away * (p[1] + away * p[2]))

    def conjugate(self, x: Array) -> Array:
        """(1/L) PV int f(xi) cot(pi (x - xi)/L) dxi where the value does not jump, in a time that
        does not grow with the jumps.
        """
        t = (np.asarray(x, dtype=float) - self.start) % self.period
        return self._transform(np.where(t < self.places[0], t + self.period, t))

    @cached_property
    def _transform(self) -> sie.PiecewiseTransform:
        ends = np.append(self.places, self.places[0] + self.period)
        kinks = self.jumps[:, 1] if self.jumps[:, 1].any() else None
        return sie.PiecewiseTransform(
            sie.hilbert(self.period), ends, self.coefficients, self.places, self.jumps[:, 2], kinks
        )


def _before(parts: Array) -> Array:
    """Sum of the parts before each."""
    return np.asarray(np.cumsum(parts) - parts)


def _closed(values: Array, length: Array, more: float) -> Array:
    """Values of the pieces, moved by one constant so that their integral and what is to be added to
    it are nothing.
    """
    return np.asarray(values - (values @ length + more) / length.sum()) if len(values) else values
