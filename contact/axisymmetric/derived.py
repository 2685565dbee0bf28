"""r f'(r) of a shape whose author gave only f or f', as Chebyshev series on octaves [2^k, 2^(k+1)] of r.

Octaves follow any power of r down to the tip, so a cone and r^1.5 are as good as a paraboloid; each one is made when
first met. The values come from a derivative in ln r (no step leaves r > 0), by a complex step where the author's
function takes complex numbers; one more derivative is the series' own.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from contact.model.profiles.derive import agree, by_ladder, imaginary
from sie import Array

_DEGREES = (24, 96, 384)
_RESOLVED = 1e-12  # of the largest coefficient, where the series may end
_LOWEST = -1000
_STEP = 1e-30  # relative; its square is far below rounding, and no product underflows


class LogDerivative:
    """r F'(r) = dF/d ln r: by a complex step, if differences bear it out at the first radii where they are good.

    Near the tip f itself may be all rounding, 1 - cos r for one, and differences no judge.
    """

    def __init__(self, function: Callable[[Any], Any]) -> None:
        self._function = function
        self._trusted: bool | None = None

    def __call__(self, r: Array) -> Array:
        t = np.log(r)
        by_step = None if self._trusted is False else self._complex_step(r)
        if by_step is not None and self._trusted:
            return by_step
        by_differences, doubt = by_ladder(lambda t: self._function(np.exp(t)), t, 1.0)
        if by_step is None:
            return by_differences
        self._trusted = agree(by_step, by_differences, doubt)
        return by_differences if self._trusted is False else by_step

    def _complex_step(self, r: Array) -> Array | None:
        value = imaginary(self._function, r * complex(1.0, _STEP))
        return None if value is None else value / _STEP


class Octaves:
    """r f' and (r f')' from a function that gives r f' at r > 0."""

    def __init__(self, r_slope: Callable[[Array], Array]) -> None:
        self._r_slope = r_slope
        self._series: dict[int, tuple[Array, Array]] = {}

    def r_slope(self, r: Array) -> Array:
        """r f'(r); 0 at r = 0."""
        return self._evaluate(r, 0)

    def derivative(self, r: Array) -> Array:
        """(r f')'(r); at r = 0 its value at the smallest octave."""
        return self._evaluate(r, 1)

    def _evaluate(self, r: Array, which: int) -> Array:
        fraction, exponent = np.frexp(r)
        exponent = np.where(r > 0, np.maximum(exponent, _LOWEST), _LOWEST)
        value = np.zeros(r.shape)
        for k in np.unique(exponent)[::-1]:  # large radii first: they tell which derivative to trust
            here = exponent == k
            # frexp's fraction is in [1/2, 1): the octave in [-1, 1).
            value[here] = chebyshev.chebval(4.0 * fraction[here] - 3.0, self._octave(int(k))[which])
        return np.where(r > 0, value, 0.0) if which == 0 else value

    def _octave(self, k: int) -> tuple[Array, Array]:
        if k not in self._series:
            half = np.ldexp(1.0, k)

            def at(t: Array) -> Array:
                return self._r_slope(0.25 * half * (t + 3.0))

            for degree in _DEGREES:
                series: Array = np.asarray(chebyshev.chebinterpolate(at, degree))  # type: ignore[type-var]
                size = np.max(np.abs(series))
                if not np.max(np.abs(series[-4:])) > _RESOLVED * size:
                    break
            # What is below rounding of the values would be blown up by the derivative.
            above = np.flatnonzero(np.abs(series) > 1e-15 * size)
            series = series[: above[-1] + 1] if above.size else series[:1]
            self._series[k] = (series, chebyshev.chebder(series) * 4.0 / half)
        return self._series[k]
