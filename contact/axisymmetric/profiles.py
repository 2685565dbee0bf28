r"""Axisymmetric asperities f(r), f(0) = 0, and what their Abel transform says of a round spot of radius a.

    g(x)     = x int_0^x f'(r) dr / sqrt(x^2 - r^2)             the equivalent plane profile
    P(a)     = 2 E* int_0^a r^2 f'(r) dr / sqrt(a^2 - r^2)      = 2 E* int_0^a x g'(x) dx
    p(r)     = (E*/pi) int_r^a g'(x) dx / sqrt(x^2 - r^2)       = (E*/pi) int_0^a (s f')'(s) M(r, s) ds
    M(r, s)  = int_max(r,s)^a dx / sqrt((x^2 - r^2)(x^2 - s^2))

(Galin; Green & Collins; Sneddon 1965, doi 10.1016/0020-7225(65)90019-4; method of dimensionality reduction). Any f will
do; a subclass needs its slope alone, and may give the rest in closed form.

Of a shape whose author gave only f or f', r f'(r) is told by Chebyshev series on octaves [2^k, 2^(k+1)] of r. Octaves follow any power of
r down to the tip, so a cone and r^1.5 are as good as a paraboloid; each one is made when first met. The values come from a derivative in
ln r (no step leaves r > 0), by a complex step where the author's function takes complex numbers; one more derivative is the series' own.
Towards the tip differences of heights are ever more their rounding: from where a power of r, fitted to the octave above, is better, r f' is
that. What rounding leaves of the pressure is told by the series' last coefficients.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import gamma, inf, pi, sqrt
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike
from scipy.special import elliprf

import sie
from contact.axisymmetric.quadrature import panels, quarter
from contact.errors import SceneError
from contact.model.checks import keep, positive, such
from contact.model.profiles.derive import borne_out, by_ladder, imaginary
from sie import Array, record

_DEGREES = (24, 96, 384)
_RESOLVED = 1e-12  # of the largest coefficient, where the series may end
# Last coefficients that tell what is left; what falls by less than this with four times as many is rounding; the largest of that over
# theirs; the least, over the largest coefficient; a derivative that nothing is wrong with, over itself; and values that are the same, over
# noise.
_LAST, _FALLS, _ABOVE, _LEAST, _EXACT, _SAME = 6, 0.2, 4.0, 2e-17, 1e-13, 30.0
# Radii whose squares are 0.
_UNDERFLOW = 2.0**-500
_ENDS = np.linspace(-1.0, 1.0, 9)
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
        by_differences, doubt = by_ladder(self._of_log, t, 1.0, doubted=True)
        if by_step is None:
            return by_differences
        self._trusted = borne_out(self._of_log, t, 1.0, by_step, by_differences, doubt)
        return by_differences if self._trusted is False else by_step

    def _of_log(self, t: Array) -> Array:
        return np.asarray(self._function(np.exp(t)))

    def _complex_step(self, r: Array) -> Array | None:
        value = imaginary(self._function, r * complex(1.0, _STEP))
        return None if value is None else value / _STEP


@record
class Octave:
    """r f' on [half/2, half] by its series, that of its derivative, and by how much it may be off: noise its values, error the derivative,
    but for what evens out in pressures."""

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
        return bool(np.max(np.abs(chebyshev.chebval(_ENDS, chebyshev.chebsub(self.series, other.series)))) <= _SAME * noise)


@record
class Law:
    """r f' = value (r / radius)^exponent, as it goes on towards the tip; off: what its derivative may be off by, over itself."""

    radius: float
    value: float
    exponent: float
    off: float

    @classmethod
    def of(cls, octave: Octave) -> "Law | None":
        """From the lower end of an octave; how it leaves the rest of it, which is farther from the tip, tells how good it is."""
        r = 0.5 * octave.half
        value, slope = float(chebyshev.chebval(-1.0, octave.series)), float(chebyshev.chebval(-1.0, octave.derivative))
        if not (value > 0.0 and slope > 0.0):
            return None
        law = cls(r, value, slope * r / value, 0.0)
        there = law.on(octave.half)
        off = np.max(np.abs(chebyshev.chebval(_ENDS, chebyshev.chebsub(there.derivative, octave.derivative)))) / there.size
        return replace(law, off=float(off + octave.error / octave.size))

    def on(self, half: float) -> Octave:
        """The octave below half."""
        octave = Octave(half, _interpolated(lambda r: self.value * (r / self.radius) ** self.exponent, half, _DEGREES[0]), 0.0, 0.0)
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
        """By how much the derivative may be off below a, added up over the octaves that were asked for."""
        return sum(octave.error for octave in self._known.values() if octave.half < 2.0 * a)

    def _evaluate(self, r: Array, series: Callable[[Octave], Array]) -> Array:
        fraction, exponent = np.frexp(r)
        exponent = np.where(r > 0, np.maximum(exponent, _LOWEST), _LOWEST)
        value = np.zeros(r.shape)
        for k in np.unique(exponent)[::-1]:  # large radii first: they tell which derivative to trust
            here = exponent == k
            # frexp's fraction is in [1/2, 1): the octave in [-1, 1).
            value[here] = chebyshev.chebval(4.0 * fraction[here] - 3.0, series(self._octave(int(k))))
        return value

    def _octave(self, k: int) -> Octave:
        """Below where rounding of the heights leaves less of the derivative than how it goes on from the octave above, that is taken."""
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
        """What its values tell, or what goes on from the octaves above: where that is better and the values are that but for noise, and
        from there on."""
        above, half = self._known.get(k + 1), float(np.ldexp(1.0, k))
        if self._law is not None and half <= self._law.radius:
            return self._law.on(half)
        octave, law = self._told(k), None if above is None else Law.of(above)
        if above is not None and law is not None:
            on = law.on(half)
            if (on.error < octave.error or octave.size == 0.0) and octave.follows(on, max(octave.noise, above.noise)):
                self._law, octave = law, on
        return octave

    def _told(self, k: int) -> Octave:
        """From values: on more and more nodes, until their series has ended, in rounding if need be."""
        if k in self._from_values:
            return self._from_values[k]
        half, left = float(np.ldexp(1.0, k)), inf
        for degree in _DEGREES:
            series = _interpolated(self._r_slope, half, degree)
            size, before, left = np.max(np.abs(series)), left, float(np.max(np.abs(series[-_LAST:])))
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
    series: Array = np.asarray(chebyshev.chebinterpolate(lambda t: function(0.25 * half * (t + 3.0)), degree))  # type: ignore[type-var]
    return series


class AxisymmetricProfile(sie.Kept):
    """An axisymmetric asperity f(r), f(0) = 0; the base of all shapes.

    A subclass is a frozen dataclass that defines `slope`, and closed forms of the rest where it has them. Equations: the head of this
    module (I. N. Sneddon (1965), doi 10.1016/0020-7225(65)90019-4).

    Attributes
    ----------
    height, slope, r_laplacian : callable
        f [m], f' and (r f')' at radii r >= 0 [m] of any shape.
    line, line_slope : callable
        g(x) [m], the equivalent plane profile (the penetration of a spot of radius x alone), and g'(x).
    load_integral : callable
        P/E* of a spot of radius a alone [m^2].
    pressure_shape : callable
        p/E* at radii r in a spot of radius a alone.
    breakpoints, jumps : array
        Radii > 0 where f is not smooth, ascending [m], and by how much f' jumps there.

    Raises
    ------
    NotImplementedError
        From the calls, if the subclass does not define `slope`.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.axisymmetric import AxisymmetricProfile, PowerLaw
    >>> class Quartic(AxisymmetricProfile):
    ...     def slope(self, r):
    ...         return 4 * np.asarray(r) ** 3
    >>> bool(np.isclose(Quartic().load_integral(0.5), PowerLaw(exponent=4, scale=1.0).load_integral(0.5)))
    True
    """

    def slope(self, r: ArrayLike) -> Array:
        """f'(r), r >= 0."""
        raise NotImplementedError(f"{type(self).__name__} must define slope(r)")

    def height(self, r: ArrayLike) -> Array:
        """f(r) [m], f(0) = 0; the integral of the slope."""
        r = np.asarray(r, dtype=np.float64)
        s, weight = panels([np.zeros_like(r), *(np.minimum(b, r) for b in self.breakpoints), r])
        return np.asarray(np.sum(weight * self.slope(s), axis=-1))

    def r_laplacian(self, r: ArrayLike) -> Array:
        """r times the Laplacian of f, (r f')' = f' + r f''."""
        r = np.asarray(r, dtype=np.float64)
        return self._octaves.derivative(r)

    @cached_property
    def _octaves(self) -> Octaves:
        """r f', where its derivative is not given."""
        return Octaves(lambda r: r * self.slope(r))

    def derived_error(self, a: float) -> float:
        """By how much what was derived of the shape may make p/E* of a spot of radius a wrong: of (r f')' the integral of M(r, s) over an
        octave of s is at most about pi/2."""
        return 0.5 * self._octaves.error(a) if "_octaves" in vars(self) else 0.0

    @property
    def breakpoints(self) -> Array:
        """Radii > 0 where f is not smooth, ascending."""
        return np.empty(0)

    @property
    def jumps(self) -> Array:
        """f'(b+) - f'(b-) at the breakpoints: an edge, and a logarithmic peak of pressure, where not 0."""
        b = self.breakpoints
        return self.slope(np.nextafter(b, inf)) - self.slope(np.nextafter(b, 0.0))

    def pointed(self, a: float) -> bool:
        """Whether f'(0+) is not 0, seen from a spot of radius a: the pressure at the tip is infinite."""
        tip, near, far = self.slope(a * np.array([1e-200, 1e-100, 0.5]))
        return bool(tip > 0.5 * near and tip > 1e-7 * abs(far))

    def line(self, x: ArrayLike) -> Array:
        """g(x) [m], the equivalent plane profile; g(a) is the penetration of an isolated spot of radius a."""
        r, weight = quarter(x, self.breakpoints)
        return np.asarray(np.asarray(x) * np.sum(weight * self.slope(r), axis=-1))

    def line_slope(self, x: ArrayLike) -> Array:
        """g'(x) = int_0^(pi/2) (r f')'(x sin phi) dphi + sum of b J/sqrt(x^2 - b^2) over the edges inside x."""
        x = np.asarray(x, dtype=np.float64)
        r, weight = quarter(x, self.breakpoints)
        total = np.sum(weight * self.r_laplacian(r), axis=-1)
        for b, jump in zip(self.breakpoints, self.jumps, strict=True):
            outside = x > b
            total = total + np.where(outside, b * jump / np.sqrt(np.where(outside, (x - b) * (x + b), 1.0)), 0.0)
        return np.asarray(total)

    def load_integral(self, a: float) -> float:
        """P/E* of an isolated spot [m^2]."""
        r, weight = quarter(np.float64(a), self.breakpoints)
        return float(2.0 * np.sum(weight * r**2 * self.slope(r)))

    def line_integral(self, a: float) -> float:
        """int_0^a g dx = a g(a) - P/(2 E*)."""
        return float(a * self.line(a)) - 0.5 * self.load_integral(a)

    def pressure_shape(self, r: ArrayLike, a: float) -> Array:
        """p(r)/E* of an isolated spot, 0 <= r <= a."""
        r = np.asarray(r, dtype=np.float64)
        infinite = np.isin(r, self.breakpoints[(self.jumps != 0) & (self.breakpoints < a)])
        infinite = infinite | ((r == 0) & self.pointed(a))
        safe = np.where(infinite, 0.5 * a, r)
        edges = np.sort(np.stack([np.broadcast_to(np.minimum(b, a), safe.shape) for b in (*self.breakpoints, safe)]), 0)
        s, weight = panels([np.zeros_like(safe), *edges, np.full_like(safe, a)])
        total = np.sum(weight * self.r_laplacian(s) * abel_kernel(safe[..., None], s, a), axis=-1)
        for b, jump in zip(self.breakpoints, self.jumps, strict=True):
            if b < a and jump != 0:
                total = total + b * jump * abel_kernel(safe, np.full_like(safe, b), a)
        return np.asarray(np.where(infinite, inf, total / pi))


def abel_kernel(r: ArrayLike, s: ArrayLike, a: float) -> Array:
    """M(r, s) of this file's head, by Carlson's R_F (DLMF 19.29.4): no cancellation at r = s nor at a.

    H1 of the paper's (3) is 4 s M(r, s).
    """
    far, near = np.maximum(r, s), np.minimum(r, s)
    whole = (a - near) * (a + near)
    with np.errstate(divide="ignore", invalid="ignore"):
        # The logarithm at r = s is cut below rounding: a node that falls there has no weight to speak of.
        apart = np.maximum((far - near) * (far + near) / whole, 1e-33)
        value = np.sqrt((a - far) * (a + far) / whole) / far * elliprf(apart, apart * (a / far) ** 2, 1.0)
    return np.asarray(np.where((0 < far) & (far < a), value, 0.0))


class Power(AxisymmetricProfile):
    """f = scale r^exponent in closed form: g = k f(x), k = sqrt(pi) Gamma(n/2 + 1)/Gamma((n + 1)/2); P = 2 E* n/(n + 1) a g(a)."""

    @property
    def _power(self) -> tuple[float, float]:
        """(exponent n, scale)."""
        raise NotImplementedError(f"{type(self).__name__} must define _power")

    @property
    def _stretch(self) -> float:
        n, _ = self._power
        return sqrt(pi) * gamma(0.5 * n + 1.0) / gamma(0.5 * (n + 1.0))

    def height(self, r: ArrayLike) -> Array:
        n, scale = self._power
        return np.asarray(scale * np.asarray(r, dtype=np.float64) ** n)

    def slope(self, r: ArrayLike) -> Array:
        n, scale = self._power
        return np.asarray(n * scale * np.asarray(r, dtype=np.float64) ** (n - 1.0))

    def r_laplacian(self, r: ArrayLike) -> Array:
        return self._power[0] * self.slope(r)

    def pointed(self, a: float) -> bool:
        return self._power[0] == 1.0

    def line(self, x: ArrayLike) -> Array:
        return self._stretch * self.height(x)

    def line_slope(self, x: ArrayLike) -> Array:
        return self._stretch * self.slope(x)

    def load_integral(self, a: float) -> float:
        n, _ = self._power
        return float(2.0 * n / (n + 1.0) * a * self.line(a))


@dataclass(frozen=True)
class Sphere(Power):
    """A paraboloid f = r^2/(2 radius), the contact of Hertz: g = x^2/R, P = 4 E* a^3/(3R), p = (2 E*/(pi R)) sqrt(a^2 - r^2).

    I. N. Sneddon (1965), doi 10.1016/0020-7225(65)90019-4.

    Parameters
    ----------
    radius : float
        Radius of curvature R [m].

    Attributes
    ----------
    height, slope, line, load_integral, pressure_shape : as in `AxisymmetricProfile`
        What every shape has, and what else is there.

    Raises
    ------
    SceneError
        If a number is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.axisymmetric import Sphere
    >>> bool(np.isclose(Sphere(radius=1e-3).load_integral(1e-5), 4e-15 / 3e-3))
    True
    """

    radius: float

    def __post_init__(self) -> None:
        keep(self, positive, "radius")

    @property
    def _power(self) -> tuple[float, float]:
        return 2.0, 0.5 / self.radius

    def pressure_shape(self, r: ArrayLike, a: float) -> Array:
        r = np.asarray(r, dtype=np.float64)
        return 2.0 / (pi * self.radius) * np.sqrt((a - r) * (a + r))


@dataclass(frozen=True)
class Cone(Power):
    """A cone f = slope r (Sneddon): g = pi slope x/2, P = pi E* slope a^2/2, p = (E* slope/2) arcosh(a/r).

    I. N. Sneddon (1965), doi 10.1016/0020-7225(65)90019-4.

    Parameters
    ----------
    steepness : float
        The slope of the flank.

    Attributes
    ----------
    height, slope, line, load_integral, pressure_shape : as in `AxisymmetricProfile`
        What every shape has, and what else is there.

    Raises
    ------
    SceneError
        If a number is not positive and finite.

    Examples
    --------
    The mean pressure is E* slope/2 at any load.

    >>> import numpy as np
    >>> from contact.axisymmetric import Cone, solve_spot
    >>> spots = [solve_spot(Cone(steepness=0.01), 1e9, load=load) for load in (1.0, 10.0)]
    >>> bool(np.allclose([spot.mean_pressure for spot in spots], 5e6))
    True
    """

    steepness: float

    def __post_init__(self) -> None:
        keep(self, positive, "steepness")

    @property
    def _power(self) -> tuple[float, float]:
        return 1.0, self.steepness

    def pressure_shape(self, r: ArrayLike, a: float) -> Array:
        r = np.asarray(r, dtype=np.float64)
        with np.errstate(divide="ignore"):
            return np.asarray(self.steepness * np.arcsinh(np.sqrt(0.5 * (a - r) / r)))


@dataclass(frozen=True)
class PowerLaw(Power):
    """A shape f = scale r^exponent, exponent n >= 1: g = k scale x^n, P = 2 E* n/(n+1) a g(a).

    k = sqrt(pi) Gamma(n/2 + 1)/Gamma((n + 1)/2). Galin; Popov 2013; I. N. Sneddon (1965), doi 10.1016/0020-7225(65)90019-4.

    Parameters
    ----------
    exponent : float
        n, from 1 to 300.
    scale : float
        The factor [m^(1 - n)].

    Attributes
    ----------
    height, slope, line, load_integral, pressure_shape : as in `AxisymmetricProfile`
        What every shape has, and what else is there.

    Raises
    ------
    SceneError
        If the exponent is not from 1 to 300, or the scale not positive and finite.

    Examples
    --------
    n = 2 is the paraboloid.

    >>> import numpy as np
    >>> from contact.axisymmetric import PowerLaw, Sphere
    >>> r = np.linspace(0.0, 0.9, 4)
    >>> bool(np.allclose(PowerLaw(exponent=2.0, scale=0.5).pressure_shape(r, 1.0), Sphere(1.0).pressure_shape(r, 1.0)))
    True
    """

    exponent: float
    scale: float

    def __post_init__(self) -> None:
        exponent = such("exponent", self.exponent, "a finite number from 1 to 300", lambda exponent: 1.0 <= exponent <= 300.0)
        object.__setattr__(self, "exponent", exponent)
        keep(self, positive, "scale")

    @property
    def _power(self) -> tuple[float, float]:
        return self.exponent, self.scale


@dataclass(frozen=True)
class Revolved(AxisymmetricProfile):
    """Any shape of revolution, from a callable f(r), or f'(r), or both, of arrays r >= 0.

    Parameters
    ----------
    height_of, slope_of : callable or None
        f(r) [m] and f'(r); one of them may be left out.
    second : callable or None
        f''(r) [1/m]; else it is derived (exactly, by a complex step, where the slope takes complex numbers).
    breaks : sequence of float
        Radii where f is not smooth, an edge for instance [m]; with them `slope_of` and `second` must be given.

    Attributes
    ----------
    height, slope, line, load_integral, pressure_shape : as in `AxisymmetricProfile`
        What every shape has, and what else is there.

    Raises
    ------
    SceneError
        If neither f nor f' is given, one is no function of an array that returns as many real numbers, or a break lacks its derivatives.

    Examples
    --------
    A bare height is enough.

    >>> import numpy as np
    >>> from contact.axisymmetric import Revolved, Sphere
    >>> shape = Revolved(height_of=lambda r: r**2 / 2e-3)
    >>> bool(np.isclose(shape.load_integral(1e-5), Sphere(1e-3).load_integral(1e-5), rtol=1e-9))
    True
    """

    height_of: Callable[[Any], Any] | None = None
    slope_of: Callable[[Any], Any] | None = None
    second: Callable[[Any], Any] | None = None
    breaks: Sequence[float] = ()

    def __post_init__(self) -> None:
        for field in ("height_of", "slope_of", "second"):
            value = getattr(self, field)
            if value is not None and not callable(value):
                raise SceneError.of(field, value, "a callable of r, or left out")
        if self.height_of is None and self.slope_of is None:
            raise SceneError("height_of and slope_of are both left out: one of them must be given")
        breaks = tuple(sorted(positive("breaks", b) for b in self.breaks))
        if breaks and (self.slope_of is None or self.second is None):
            raise SceneError("breaks need slope_of and second: a difference across an edge is not a derivative")
        object.__setattr__(self, "breaks", breaks)
        probe = np.array([0.25, 0.5])
        for field in ("height_of", "slope_of", "second"):
            if getattr(self, field) is not None:
                self._called(field, probe)

    def _called(self, field: str, r: Array) -> Array:
        """What the author's function makes of r, refused if it is not as many real numbers."""
        value = np.asarray(getattr(self, field)(r))
        if value.dtype.kind not in "iuf" or value.shape not in ((), r.shape):
            raise SceneError.of(field, getattr(self, field), "a function of an array that returns as many real numbers")
        return np.broadcast_to(value, r.shape).astype(np.float64)

    @property
    def breakpoints(self) -> Array:
        return np.array(self.breaks, dtype=np.float64)

    def height(self, r: ArrayLike) -> Array:
        if self.height_of is None:
            return super().height(r)
        r = np.asarray(r, dtype=np.float64)
        return np.asarray(self._called("height_of", r) - self._called("height_of", np.zeros(1))[0])

    def slope(self, r: ArrayLike) -> Array:
        r = np.asarray(r, dtype=np.float64)
        if self.slope_of is not None:
            return self._called("slope_of", r)
        safe = np.where(r > 0, r, 1e-200)
        return np.asarray(self._octaves.r_slope(safe) / safe)

    def r_laplacian(self, r: ArrayLike) -> Array:
        r = np.asarray(r, dtype=np.float64)
        if self.second is not None:
            return np.asarray(self.slope(r) + r * self._called("second", r))
        return self._octaves.derivative(r)

    @cached_property
    def _octaves(self) -> Octaves:
        slope, height = self.slope_of, self.height_of
        if slope is not None:
            return Octaves(lambda r: r * self._called("slope_of", r))
        assert height is not None
        return Octaves(LogDerivative(height))


def as_profile(shape: Any) -> AxisymmetricProfile:
    """A shape as it is, or a bare callable taken as f(r)."""
    if isinstance(shape, AxisymmetricProfile):
        return shape
    if callable(shape):
        return Revolved(height_of=shape)
    raise SceneError.of("profile", shape, "an axisymmetric profile or a callable f(r)")
