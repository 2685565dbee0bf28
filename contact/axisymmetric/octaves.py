"""r f'(r) of an axisymmetric shape whose author gave only f or f', and its derivative, by Chebyshev
series on octaves [2^k, 2^(k+1)] of r.

Octaves follow any power of r down to the tip, so a cone and r^1.5 are as good as a paraboloid; each
one is made when first met. The values come from a derivative in ln r (no step leaves r > 0), by a
complex step where the author's function takes complex numbers; one more derivative is the series'
own. Towards the tip differences of heights are ever more their rounding: from where a power of r,
fitted to the octave above, is better, r f' is that. What rounding leaves of the pressure is told by
the series' last coefficients.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from math import inf
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from contact.model.profiles.derive import complex_value, differences, verdicts
from sie import Array, record

_DEGREES = (24, 96, 384)
_RESOLVED = 1e-12  # of the largest coefficient, where the series may end
# Last coefficients that tell what is left; what falls by less than this with four times as many is
# rounding; the largest of that over theirs; the least, over the largest coefficient; a derivative
# that nothing is wrong with, over itself; and values that are the same, over noise.
_LAST = 6
_FALLS = 0.2
_ABOVE = 4.0
_LEAST = 2e-17
_EXACT = 1e-13
_SAME = 30.0
# Radii whose squares are 0.
_UNDERFLOW = 2.0**-500
_ENDS = np.linspace(-1.0, 1.0, 9)
_LOWEST = -1000
_STEP = 1e-30  # relative; its square is far below rounding, and no product underflows


class LogDerivative:
    """r F'(r) = dF/d ln r: by a complex step, if differences bear it out at the first radii where
    they are good.

    Near the tip f itself may be all rounding, 1 - cos r for one, and differences no judge.
    """

    def __init__(self, function: Callable[[Any], Any]) -> None:
        self._function = function
        self._trusted: bool | None = None

    def __call__(self, r: Array) -> Array:
        t = np.log(r)
        by_step = None if self._trusted is False else self._by_step(t)
        if by_step is not None and self._trusted is None:
            judged = verdicts(self._of_log, self._finite_or_nan, t, np.ones(t.shape))
            if judged.contradicted.any() or judged.confirmed.any():
                self._trusted = not judged.contradicted.any()
        return (
            differences(self._of_log, t, np.ones(t.shape))[0]
            if by_step is None or self._trusted is False
            else by_step
        )

    def _of_log(self, t: Array) -> Array:
        return np.asarray(self._function(np.exp(t)))

    def _by_step(self, t: Array) -> Array | None:
        """None where the height takes no complex numbers, or is not finite."""
        slope = self._finite_or_nan(t)
        return slope if np.isfinite(slope).all() else None

    def _finite_or_nan(self, t: Array) -> Array:
        value = complex_value(self._function, np.exp(t) * complex(1.0, _STEP))
        return np.full(t.shape, np.nan) if value is None else value.imag / _STEP


@record
class Octave:
    """r f' on [half/2, half] by its series, that of its derivative, and by how much it may be off:
    noise its values, error the derivative, but for what evens out in pressures.
    """

    half: float
    series: Array
    noise: float
    error: float

    @cached_property
    def derivative(self) -> Array:
        return np.asarray(chebyshev.chebder(self.series) * 4.0 / self.half)

    @property
    def size(self) -> float:
        """Of the derivative."""
        return float(np.max(np.abs(chebyshev.chebval(_ENDS, self.derivative))))

    @property
    def is_exact(self) -> bool:
        return self.error <= _EXACT * self.size and (self.size > 0.0 or self.half < _UNDERFLOW)

    def follows(self, other: "Octave", noise: float) -> bool:
        """Whether the other one's values are these, but for noise."""
        return bool(
            np.max(np.abs(chebyshev.chebval(_ENDS, chebyshev.chebsub(self.series, other.series))))
            <= _SAME * noise
        )


@record
class Law:
    """r f' = value (r / radius)^exponent, as it goes on towards the tip; off: what its derivative
    may be off by, over itself.
    """

    radius: float
    value: float
    exponent: float
    off: float

    @classmethod
    def of(cls, octave: Octave) -> "Law | None":
        """From the lower end of an octave; how it leaves the rest of it, which is farther from the
        tip, tells how good it is.
        """
        r = 0.5 * octave.half
        value, slope = (
            float(chebyshev.chebval(-1.0, octave.series)),
            float(chebyshev.chebval(-1.0, octave.derivative)),
        )
        if not (value > 0.0 and slope > 0.0):
            return None
        law = cls(r, value, slope * r / value, 0.0)
        there = law.on(octave.half)
        off = (
            np.max(
                np.abs(
                    chebyshev.chebval(_ENDS, chebyshev.chebsub(there.derivative, octave.derivative))
                )
            )
            / there.size
        )
        return replace(law, off=float(off + octave.error / octave.size))

    def on(self, half: float) -> Octave:
        """The octave below half."""
        octave = Octave(
            half,
            _interpolated(
                lambda r: self.value * (r / self.radius) ** self.exponent, half, _DEGREES[0]
            ),
            0.0,
            0.0,
        )
        return replace(octave, error=self.off * octave.size)


class Octaves:
    """r f' and (r f')' from a function that gives r f' at r > 0."""

    def __init__(self, r_slope: Callable[[Array], Array]) -> None:
        self._r_slope = r_slope
        self._from_values: dict[int, Octave] = {}
        self._known: dict[int, Octave] = {}
        self._highest = _LOWEST
        self._law: Law | None = None

    def r_slope(self, r: Array) -> Array:
        """r f'(r); 0 at r = 0."""
        value = self._evaluate(r, lambda octave: octave.series)
        return np.where(r > 0, value, 0.0)

    def derivative(self, r: Array) -> Array:
        """(r f')'(r); at r = 0 its value at the smallest octave."""
        return self._evaluate(r, lambda octave: octave.derivative)

    def error(self, a: float) -> float:
        """By how much the derivative may be off below a, added up over the octaves that were asked
        for.
        """
        return sum(octave.error for octave in self._known.values() if octave.half < 2.0 * a)

    def _evaluate(self, r: Array, series: Callable[[Octave], Array]) -> Array:
        fraction, exponent = np.frexp(r)
        exponent = np.where(r > 0, np.maximum(exponent, _LOWEST), _LOWEST)
        value = np.zeros(r.shape)
        for k in np.unique(exponent)[
            ::-1
        ]:  # large radii first: they tell which derivative to trust
            here = exponent == k
            # frexp's fraction is in [1/2, 1): the octave in [-1, 1).
            value[here] = chebyshev.chebval(
                4.0 * fraction[here] - 3.0, series(self._octave(int(k)))
            )
        return value

    def _octave(self, k: int) -> Octave:
        """Below where rounding of the heights leaves less of the derivative than how it goes on
        from the octave above, that is taken.
        """
        if k > self._highest:
            # What goes on may do so from higher up.
            self._highest, self._law = k, None
            self._known = {one: octave for one, octave in self._known.items() if octave.is_exact}
        if k not in self._known:
            exact = (octave := self._told(k)).is_exact
            for one in [k] if exact else range(self._highest, k - 1, -1):
                if self._law is not None:
                    self._known[k] = self._best(k)
                    break
                if one not in self._known:
                    self._known[one] = octave if exact else self._best(one)
        return self._known[k]

    def _best(self, k: int) -> Octave:
        """What its values tell, or what goes on from the octaves above: where that is better and
        the values are that but for noise, and from there on.
        """
        above, half = self._known.get(k + 1), float(np.ldexp(1.0, k))
        if self._law is not None and half <= self._law.radius:
            return self._law.on(half)
        octave, law = self._told(k), None if above is None else Law.of(above)
        if above is not None and law is not None:
            on = law.on(half)
            if (on.error < octave.error or octave.size == 0.0) and octave.follows(
                on, max(octave.noise, above.noise)
            ):
                self._law, octave = law, on
        return octave

    def _told(self, k: int) -> Octave:
        """From values: on more and more nodes, until their series has ended, in rounding if need
        be.
        """
        if k in self._from_values:
            return self._from_values[k]
        half, left = float(np.ldexp(1.0, k)), inf
        for degree in _DEGREES:
            series = _interpolated(self._r_slope, half, degree)
            size, before, left = (
                np.max(np.abs(series)),
                left,
                float(np.max(np.abs(series[-_LAST:]))),
            )
            if not left > _RESOLVED * size:
                break
            if left > _FALLS * before:
                left = float(np.max(np.abs(series[-degree // 2 :])))
                break
        # What is below rounding of the values would be blown up by the derivative.
        above = np.flatnonzero(np.abs(series) > max(1e-15 * size, _ABOVE * left))
        series = series[: above[-1] + 1] if above.size else series[:1]
        noise = max(left, _LEAST * size)
        self._from_values[k] = Octave(half, series, noise, noise * len(series) ** 1.5 * 4.0 / half)
        return self._from_values[k]


def _interpolated(function: Callable[[Array], Array], half: float, degree: int) -> Array:
    """Chebyshev series of a function on [half/2, half]."""
    series: Array = np.asarray(
        chebyshev.chebinterpolate(  # type: ignore[type-var]
            lambda t: function(0.25 * half * (t + 3.0)), degree
        )
    )
    return series
