"""r f'(r) and its derivative for a shape given by f or f' only: Chebyshev series on octaves of r.

An octave is [2^(k-1), 2^k]. On an octave any power of r is resolved by the same number of terms, so
a cone and r^1.5 are as accurate as a paraboloid. Octaves are computed when first needed.

The derivative of f is taken with respect to ln r, so that no step leaves r > 0. It is a complex
step if the user's function accepts complex numbers, and a finite difference otherwise. The second
derivative is computed from the series. Towards the tip, differences of heights become round-off.
There r f' may be replaced by a power of r that is fitted to the octave above. This power is used
from the first octave on which it is more accurate than the series. The last coefficients of the
series give the error.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from contact.model.profiles.derive import complex_value, differences, verdicts
from contact.model.profiles.noise import EPS
from sie import Array, record


@dataclass(frozen=True)
class OctaveOptions:
    """Degrees of the Chebyshev series on an octave [half/2, half], and their tolerances."""

    # Degrees of the series that are tried in turn; the first degree resolves any power of r.
    degrees: tuple[int, ...] = (24, 96, 384)
    # A higher degree should reduce the last coefficients of a series. If they stay above this
    # fraction of their size at the lower degree, they are round-off.
    min_decay: float = 0.2
    # A coefficient of a series counts as zero if it is below this multiple of the series' noise.
    # Two series count as equal if their values differ by less than this multiple of the noise.
    noise_factor: float = 10.0
    # A series is long enough if its last coefficients are below this fraction of the largest one.
    # If the relative error of the derivative on an octave exceeds this number, a power law fitted
    # to the octave above may replace the series.
    exact: float = 1e-13


SERIES = OctaveOptions()
# Exponent k of the lowest octave [2^(k-1), 2^k] of radii. The squares of much smaller radii would
# underflow to 0.
_LOWEST = -500


class LogDerivative:
    """The derivative r F'(r) = dF/d ln r of a function, by a complex step or by differences.

    A complex step is used if differences confirm it at the first radii where they are accurate.
    Near the tip, differences are inaccurate: heights such as 1 - cos r are round-off there.
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
        """Derivative of the function by t = log r, from a complex step.
        It is None unless it is finite at every t.
        """
        slope = self._finite_or_nan(t)
        return slope if np.isfinite(slope).all() else None

    def _finite_or_nan(self, t: Array) -> Array:
        # The step is so small that its square is far below round-off, and so large that no product
        # underflows.
        step = EPS**2
        value = complex_value(self._function, np.exp(t) * complex(1.0, step))
        return np.full(t.shape, np.nan) if value is None else value.imag / step


@record
class Octave:
    """Chebyshev series of r f' on [half/2, half] for the shape f, and errors of the series.

    noise: error of the values of the series; error: error of the derivative of the series, which
    enters pressures.
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
        """Largest absolute value of the derivative of the series."""
        return _largest(self.derivative)

    @property
    def is_exact(self) -> bool:
        return self.error <= SERIES.exact * self.size and (
            self.size > 0.0 or self.half <= np.ldexp(1.0, _LOWEST)
        )

    def equals(self, other: "Octave", noise: float) -> bool:
        """Whether the series of this octave and of `other` agree to within their noise."""
        difference = chebyshev.chebsub(self.series, other.series)
        return _largest(difference) <= SERIES.noise_factor * noise


@record
class PowerFit:
    """The power law `value` (r / `radius`)^`exponent`, an approximation of r f'(r) at small r.
    It is used at r < `radius`.

    relative_error: error of the power law's derivative, divided by this derivative.
    """

    radius: float
    value: float
    exponent: float
    relative_error: float

    @classmethod
    def of(cls, octave: Octave) -> "PowerFit | None":
        """The power law that has an octave's value and slope at the octave's lower end.
        It is None unless the value and the slope are positive.

        The deviation of the power law from the series on this octave is taken as the error of the
        power law below the octave.
        """
        r = 0.5 * octave.half
        value, slope = (
            float(chebyshev.chebval(-1.0, octave.series)),
            float(chebyshev.chebval(-1.0, octave.derivative)),
        )
        if not (value > 0.0 and slope > 0.0):
            return None
        power = cls(r, value, slope * r / value, 0.0)
        fitted = power.on(octave.half)
        difference = chebyshev.chebsub(fitted.derivative, octave.derivative)
        error = _largest(difference) / fitted.size
        return replace(power, relative_error=error + octave.error / octave.size)

    def on(self, half: float) -> Octave:
        """The series of this power law on the octave [half/2, half]."""
        series = _interpolated(
            lambda r: self.value * (r / self.radius) ** self.exponent, half, SERIES.degrees[0]
        )
        octave = Octave(half, series, 0.0, 0.0)
        return replace(octave, error=self.relative_error * octave.size)


class Octaves:
    """The functions r f' and (r f')' of a shape f, as Chebyshev series on octaves.
    An octave is an interval [2^(k-1), 2^k] of radii. The series are computed from a function that
    gives r f' at r > 0.
    """

    def __init__(self, r_slope: Callable[[Array], Array]) -> None:
        self._r_slope = r_slope
        self._from_values: dict[int, Octave] = {}
        self._known: dict[int, Octave] = {}
        self._highest = _LOWEST
        self._power: PowerFit | None = None

    def r_slope(self, r: Array) -> Array:
        """Value of r f'(r) for the shape f; 0 at r = 0."""
        value = self._evaluate(r, lambda octave: octave.series)
        return np.where(r > 0, value, 0.0)

    def derivative(self, r: Array) -> Array:
        """Derivative (r f')'(r) for the shape f; at r = 0, the value on the lowest octave."""
        return self._evaluate(r, lambda octave: octave.derivative)

    def error(self, a: float) -> float:
        """Estimated error of (r f')' at radii r < a.
        It is the sum of the errors on all octaves below a that were used so far. An octave is an
        interval [half/2, half].
        """
        return sum(octave.error for octave in self._known.values() if octave.half < 2.0 * a)

    def _evaluate(self, r: Array, series: Callable[[Octave], Array]) -> Array:
        fraction, exponent = np.frexp(r)
        exponent = np.where(r > 0, np.maximum(exponent, _LOWEST), _LOWEST)
        value = np.zeros(r.shape)
        # Octaves of large radii are computed first. At large radii, difference quotients are
        # accurate enough to confirm the derivative that is computed by a complex step.
        for k in np.unique(exponent)[::-1]:
            here = exponent == k
            # The fraction given by frexp lies in [1/2, 1). It is mapped to [-1, 1).
            value[here] = chebyshev.chebval(
                4.0 * fraction[here] - 3.0, series(self._octave(int(k)))
            )
        return value

    def _octave(self, k: int) -> Octave:
        """The series on octave k, computed when it is first needed.
        Octave k is the interval [2^(k-1), 2^k] of radii. The series comes from values of the
        function, or from the power law fitted to a higher octave.

        The power law is used if it is more accurate.
        """
        if k > self._highest:
            # A power law fitted to the new highest octave k may serve the octaves below. So the
            # lower octaves that are not exact are computed again.
            self._highest, self._power = k, None
            self._known = {one: octave for one, octave in self._known.items() if octave.is_exact}
        if k not in self._known:
            exact = (octave := self._computed(k)).is_exact
            for one in [k] if exact else range(self._highest, k - 1, -1):
                if self._power is not None:
                    self._known[k] = self._best(k)
                    break
                if one not in self._known:
                    self._known[one] = octave if exact else self._best(one)
        return self._known[k]

    def _best(self, k: int) -> Octave:
        """The series on octave k, which is the interval [2^(k-1), 2^k] of radii.
        It comes from values of the function, or from a power law fitted to a higher octave.

        The power law is used if its error is smaller and the values agree with it within noise; it
        then also serves all octaves below.
        """
        above, half = self._known.get(k + 1), float(np.ldexp(1.0, k))
        if self._power is not None and half <= self._power.radius:
            return self._power.on(half)
        octave, power = self._computed(k), None if above is None else PowerFit.of(above)
        if above is not None and power is not None:
            fitted = power.on(half)
            better = fitted.error < octave.error or octave.size == 0.0
            if better and octave.equals(fitted, max(octave.noise, above.noise)):
                self._power, octave = power, fitted
        return octave

    def _computed(self, k: int) -> Octave:
        """The series on octave k, from values of the function at Chebyshev nodes.
        The number of nodes grows until the last coefficients stop decreasing fast.

        The loop also ends once these last coefficients are negligible.
        """
        if k in self._from_values:
            return self._from_values[k]
        half, left = float(np.ldexp(1.0, k)), inf
        for degree in SERIES.degrees:
            series = _interpolated(self._r_slope, half, degree)
            size, before = np.max(np.abs(series)), left
            left = float(np.max(np.abs(series[-degree // 4 :])))
            if not left > SERIES.exact * size:
                break
            if left > SERIES.min_decay * before:
                left = float(np.max(np.abs(series[-degree // 2 :])))
                break
        # Coefficients near the noise are dropped, since the derivative amplifies them. A
        # coefficient is a weighted mean of n values, each with a relative round-off of up to EPS/2.
        # So its noise is at least EPS `size` / sqrt(6 n).
        noise = max(left, EPS * size / np.sqrt(6.0 * len(series)))
        above = np.flatnonzero(np.abs(series) > SERIES.noise_factor * noise)
        series = series[: above[-1] + 1] if above.size else series[:1]
        self._from_values[k] = Octave(half, series, noise, noise * len(series) ** 1.5 * 4.0 / half)
        return self._from_values[k]


def _largest(series: NDArray[np.floating]) -> float:
    """Largest absolute value of a Chebyshev series on a grid of Chebyshev points."""
    points = chebyshev.chebpts2(len(series) + 1)
    return float(np.max(np.abs(chebyshev.chebval(points, series))))


def _interpolated(function: Callable[[Array], Array], half: float, degree: int) -> Array:
    """Chebyshev series of a function on [half/2, half]."""
    series: Array = np.asarray(
        chebyshev.chebinterpolate(  # type: ignore[type-var]
            lambda t: function(0.25 * half * (t + 3.0)), degree
        )
    )
    return series
