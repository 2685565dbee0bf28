r"""Axisymmetric asperities f(r), f(0) = 0, and the Abel transforms that solve their contact.

    g(x)     = x int_0^x f'(r) dr / sqrt(x^2 - r^2)             the equivalent plane profile
    P(a)     = 2 E* int_0^a r^2 f'(r) dr / sqrt(a^2 - r^2)      = 2 E* int_0^a x g'(x) dx
    p(r)     = (E*/pi) int_r^a g'(x) dx / sqrt(x^2 - r^2)
             = (E*/pi) int_0^a (s f')'(s) M(r, s) ds
    M(r, s)  = int_max(r,s)^a dx / sqrt((x^2 - r^2)(x^2 - s^2))

for a spot of radius a with the load P and the pressure p (Galin; Green & Collins; Sneddon 1965, doi
10.1016/0020-7225(65)90019-4; method of dimensionality reduction). f may have any shape; a subclass
must define the slope f' and may give the other functions in closed form.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import gamma, inf, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import elliprf

import sie
from contact.axisymmetric.octaves import LogDerivative, Octaves
from contact.axisymmetric.quadrature import panels, quarter
from contact.errors import SceneError
from contact.model.checks import checked_number, keep, positive
from sie import Array


class AxisymmetricProfile(sie.Kept):
    """Base class of axisymmetric asperities with the shape f(r), f(0) = 0.

    A subclass is a frozen dataclass that defines `slope`; closed forms of the other functions are
    optional. The equations are in the docstring of this module (I. N. Sneddon (1965), doi
    10.1016/0020-7225(65)90019-4).

    Attributes
    ----------
    height, slope, r_laplacian : callable
        f [m], f' and (r f')' at radii r >= 0 [m] of any shape.
    line, line_slope : callable
        g(x) [m], the equivalent plane profile (the penetration of an isolated spot of radius x),
        and g'(x).
    load_integral : callable
        P/E* of an isolated spot of radius a [m^2].
    pressure_shape : callable
        p/E* at radii r in an isolated spot of radius a.
    breakpoints, jumps : array
        Radii > 0 where f is not smooth, ascending [m], and the jumps of f' there.

    Raises
    ------
    NotImplementedError
        From every function, if the subclass does not define `slope`.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.axisymmetric import AxisymmetricProfile, PowerLaw
    >>> class Quartic(AxisymmetricProfile):
    ...     def slope(self, r):
    ...         return 4 * np.asarray(r) ** 3
    >>> exact = PowerLaw(exponent=4, scale=1.0)
    >>> bool(np.isclose(Quartic().load_integral(0.5), exact.load_integral(0.5)))
    True
    """

    def slope(self, r: ArrayLike) -> Array:
        """Slope f'(r) of the shape, for r >= 0."""
        raise NotImplementedError(f"{type(self).__name__} must define slope(r)")

    def height(self, r: ArrayLike) -> Array:
        """Height f(r) [m] of the shape with f(0) = 0: the integral of the slope."""
        r = np.asarray(r, dtype=np.float64)
        s, weight = panels([np.zeros_like(r), *(np.minimum(b, r) for b in self.breakpoints), r])
        return np.asarray(np.sum(weight * self.slope(s), axis=-1))

    def r_laplacian(self, r: ArrayLike) -> Array:
        """r times the Laplacian of the shape f: (r f')' = f' + r f''."""
        return self._octaves.derivative(np.asarray(r, dtype=np.float64))

    @cached_property
    def _octaves(self) -> Octaves:
        """Chebyshev series of r f'(r), needed if the derivative (r f')' has no closed form."""
        return Octaves(lambda r: r * self.slope(r))

    def derived_error(self, a: float) -> float:
        """Error of p/E* in a spot of radius a, due to numerical derivatives of the shape f.

        p/E* is the integral over s of (s f')'(s) M(r, s)/pi, and the integral of M over an octave
        of s is at most about pi/2.
        """
        return 0.5 * self._octaves.error(a) if "_octaves" in vars(self) else 0.0

    @property
    def breakpoints(self) -> Array:
        """Radii > 0 where the shape is not smooth, in ascending order."""
        return np.empty(0)

    @property
    def jumps(self) -> Array:
        """Jump of the slope f' at each breakpoint of the shape f.
        Where a jump is not 0, the pressure is infinite.
        """
        b = self.breakpoints
        return self.slope(np.nextafter(b, inf)) - self.slope(np.nextafter(b, 0.0))

    def edges(self, a: float = inf) -> list[tuple[float, float]]:
        """(radius, jump of the slope f') of each edge of the shape f inside the radius `a`."""
        return [
            (b, jump)
            for b, jump in zip(self.breakpoints, self.jumps, strict=True)
            if jump != 0 and b < a
        ]

    def pointed(self, a: float) -> bool:
        """Whether the tip is pointed: f'(0+) > 0.
        The slope at the tip is compared with slopes inside a spot of radius a.

        The pressure at a pointed tip is infinite.
        """
        tip, near, far = self.slope(a * np.array([1e-200, 1e-100, 0.5]))
        return bool(tip > 0.5 * near and tip > 1e-7 * abs(far))

    def line(self, x: ArrayLike) -> Array:
        """Equivalent plane profile g(x) [m]; g(a): penetration of an isolated spot of radius a."""
        r, weight = quarter(x, self.breakpoints)
        return np.asarray(np.asarray(x) * np.sum(weight * self.slope(r), axis=-1))

    def line_slope(self, x: ArrayLike) -> Array:
        """The derivative g'(x) of the equivalent plane profile.

        g'(x) = int_0^(pi/2) (r f')'(x sin phi) dphi + sum b J/sqrt(x^2 - b^2), where the sum is
        over the edges: the radii b < x at which f' jumps by J.
        """
        x = np.asarray(x, dtype=np.float64)
        r, weight = quarter(x, self.breakpoints)
        total = np.sum(weight * self.r_laplacian(r), axis=-1)
        for b, jump in self.edges():
            outside = x > b
            total = total + np.where(
                outside, b * jump / np.sqrt(np.where(outside, (x - b) * (x + b), 1.0)), 0.0
            )
        return np.asarray(total)

    def load_integral(self, a: float) -> float:
        """Load of an isolated spot of radius a, divided by E* [m^2]."""
        r, weight = quarter(np.float64(a), self.breakpoints)
        return float(2.0 * np.sum(weight * r**2 * self.slope(r)))

    def line_integral(self, a: float) -> float:
        """Integral of the equivalent plane profile g from 0 to a.

        It is a g(a) - P/(2 E*), with the load P.
        """
        return float(a * self.line(a)) - 0.5 * self.load_integral(a)

    def pressure_shape(self, r: ArrayLike, a: float) -> Array:
        """Pressure p(r)/E* of an isolated spot of radius a, for 0 <= r <= a."""
        r = np.asarray(r, dtype=np.float64)
        sharp = self.edges(a)
        infinite = np.isin(r, [b for b, _ in sharp]) | ((r == 0) & self.pointed(a))
        safe = np.where(infinite, 0.5 * a, r)
        edges = np.sort(
            np.stack(
                [np.broadcast_to(np.minimum(b, a), safe.shape) for b in (*self.breakpoints, safe)]
            ),
            0,
        )
        s, weight = panels([np.zeros_like(safe), *edges, np.full_like(safe, a)])
        total = np.sum(weight * self.r_laplacian(s) * abel_kernel(safe[..., None], s, a), axis=-1)
        for b, jump in sharp:
            total = total + b * jump * abel_kernel(safe, b, a)
        return np.asarray(np.where(infinite, inf, total / pi))


def abel_kernel(r: ArrayLike, s: ArrayLike, a: float) -> Array:
    """Kernel M(r, s) of the pressure integral, without cancellation at r = s and at the edge a.

    The head of this module defines M. It is computed by Carlson's integral R_F (DLMF 19.29.4).

    The function H1 of the paper's equation (3) is 4 s M(r, s).
    """
    far, near = np.maximum(r, s), np.minimum(r, s)
    whole = (a - near) * (a + near)
    with np.errstate(divide="ignore", invalid="ignore"):
        # `apart` is 0 at r = s, where the kernel is logarithmically infinite. The lower bound 1e-33
        # keeps the kernel finite. A quadrature node so close to r has a negligible weight.
        apart = np.maximum((far - near) * (far + near) / whole, 1e-33)
        value = (
            np.sqrt((a - far) * (a + far) / whole)
            / far
            * elliprf(apart, apart * (a / far) ** 2, 1.0)
        )
    return np.asarray(np.where((0 < far) & (far < a), value, 0.0))


class Power(AxisymmetricProfile):
    """Closed forms for the power-law shape f = scale r^n.

    g = k f(x) with k = sqrt(pi) Gamma(n/2 + 1)/Gamma((n + 1)/2), and P = 2 E* n/(n + 1) a g(a).
    """

    # The subclasses define the exponent and the scale, as fields or class attributes.
    exponent: float
    scale: float

    @property
    def _stretch(self) -> float:
        return sqrt(pi) * gamma(0.5 * self.exponent + 1.0) / gamma(0.5 * (self.exponent + 1.0))

    def height(self, r: ArrayLike) -> Array:
        return np.asarray(self.scale * np.asarray(r, dtype=np.float64) ** self.exponent)

    def slope(self, r: ArrayLike) -> Array:
        return np.asarray(
            self.exponent * self.scale * np.asarray(r, dtype=np.float64) ** (self.exponent - 1.0)
        )

    def r_laplacian(self, r: ArrayLike) -> Array:
        return self.exponent * self.slope(r)

    def pointed(self, a: float) -> bool:
        return self.exponent == 1.0

    def line(self, x: ArrayLike) -> Array:
        return self._stretch * self.height(x)

    def line_slope(self, x: ArrayLike) -> Array:
        return self._stretch * self.slope(x)

    def load_integral(self, a: float) -> float:
        return float(2.0 * self.exponent / (self.exponent + 1.0) * a * self.line(a))


@dataclass(frozen=True)
class Sphere(Power):
    """A paraboloid f = r^2/(2 R) with radius R at the tip: the contact of Hertz.

    g = x^2/R, P = 4 E* a^3/(3R), p = (2 E*/(pi R)) sqrt(a^2 - r^2). I. N. Sneddon (1965), doi
    10.1016/0020-7225(65)90019-4.

    Parameters
    ----------
    radius : float
        Radius of curvature R [m].

    Attributes
    ----------
    height, slope, line, load_integral, pressure_shape : as in `AxisymmetricProfile`
        The members that every shape has.

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

    exponent = 2.0
    scale = property(lambda self: 0.5 / self.radius)  # type: ignore[assignment]

    def pressure_shape(self, r: ArrayLike, a: float) -> Array:
        r = np.asarray(r, dtype=np.float64)
        return 2.0 / (pi * self.radius) * np.sqrt((a - r) * (a + r))


@dataclass(frozen=True)
class Cone(Power):
    """A cone f = m r with the `steepness` m.

    g = pi m x/2, P = pi E* m a^2/2, p = (E* m/2) arcosh(a/r). I. N. Sneddon (1965), doi
    10.1016/0020-7225(65)90019-4.

    Parameters
    ----------
    steepness : float
        The slope of the flank.

    Attributes
    ----------
    height, slope, line, load_integral, pressure_shape : as in `AxisymmetricProfile`
        The members that every shape has.

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

    exponent = 1.0
    scale = property(lambda self: self.steepness)  # type: ignore[assignment]

    def pressure_shape(self, r: ArrayLike, a: float) -> Array:
        r = np.asarray(r, dtype=np.float64)
        with np.errstate(divide="ignore"):
            return np.asarray(self.steepness * np.arcsinh(np.sqrt(0.5 * (a - r) / r)))


@dataclass(frozen=True)
class PowerLaw(Power):
    """A power-law shape f = scale r^n, n >= 1.

    Its equivalent plane profile is g = k scale x^n, and the load is P = 2 E* n/(n+1) a g(a).

    Here k = sqrt(pi) Gamma(n/2 + 1)/Gamma((n + 1)/2). Galin; Popov 2013; I. N. Sneddon (1965), doi
    10.1016/0020-7225(65)90019-4.

    Parameters
    ----------
    exponent : float
        n, from 1 to 300.
    scale : float
        The factor [m^(1 - n)].

    Attributes
    ----------
    height, slope, line, load_integral, pressure_shape : as in `AxisymmetricProfile`
        The members that every shape has.

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
    >>> pressure = PowerLaw(exponent=2.0, scale=0.5).pressure_shape(r, 1.0)
    >>> bool(np.allclose(pressure, Sphere(1.0).pressure_shape(r, 1.0)))
    True
    """

    exponent: float
    scale: float

    def __post_init__(self) -> None:
        exponent = checked_number(
            "exponent",
            self.exponent,
            "a finite number from 1 to 300",
            lambda exponent: 1.0 <= exponent <= 300.0,
        )
        object.__setattr__(self, "exponent", exponent)
        keep(self, positive, "scale")


@dataclass(frozen=True)
class Revolved(AxisymmetricProfile):
    """A shape of revolution given by functions f(r), f'(r) or both, which accept arrays r >= 0.

    Parameters
    ----------
    height_of, slope_of : callable or None
        f(r) [m] and f'(r); one of them may be left out.
    second : callable or None
        f''(r) [1/m]. If left out, it is computed: by a complex step if the slope accepts complex
        numbers, else from Chebyshev series.
    breaks : sequence of float
        Radii where f is not smooth, such as edges [m]; they require `slope_of` and `second`.

    Attributes
    ----------
    height, slope, line, load_integral, pressure_shape : as in `AxisymmetricProfile`
        The members that every shape has.

    Raises
    ------
    SceneError
        If neither f nor f' is given, if a function does not return real numbers in the shape of its
        argument, or if `breaks` are given without derivatives.

    Examples
    --------
    A height is enough.

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
        given = [
            field
            for field in ("height_of", "slope_of", "second")
            if getattr(self, field) is not None
        ]
        for field in given:
            if not callable(getattr(self, field)):
                raise SceneError.of(field, getattr(self, field), "a function of r, or left out")
        if self.height_of is None and self.slope_of is None:
            raise SceneError("height_of and slope_of are both left out: one of them must be given")
        breaks = tuple(sorted(positive("breaks", b) for b in self.breaks))
        if breaks and (self.slope_of is None or self.second is None):
            raise SceneError(
                "breaks need both slope_of and second: derivatives cannot be computed from "
                "differences across an edge"
            )
        object.__setattr__(self, "breaks", breaks)
        for field in given:
            self._called(field, np.array([0.25, 0.5]))

    def _called(self, field: str, r: Array) -> Array:
        """Values of a user's function at the radii r.
        Raises SceneError unless the function gives one real number for each radius.
        """
        value = np.asarray(getattr(self, field)(r))
        if value.dtype.kind not in "iuf" or value.shape not in ((), r.shape):
            raise SceneError.of(
                field,
                getattr(self, field),
                "a function that returns one real number for each radius of an array",
            )
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
        if self.second is None:
            return super().r_laplacian(r)
        r = np.asarray(r, dtype=np.float64)
        return np.asarray(self.slope(r) + r * self._called("second", r))

    @cached_property
    def _octaves(self) -> Octaves:
        return (
            Octaves(LogDerivative(self.height_of))
            if self.slope_of is None and self.height_of
            else super()._octaves
        )


def as_profile(shape: Any) -> AxisymmetricProfile:
    """The argument if it is a profile.
    A function f(r) becomes a `Revolved` profile with this height.
    """
    if isinstance(shape, AxisymmetricProfile):
        return shape
    if callable(shape):
        return Revolved(height_of=shape)
    raise SceneError.of("profile", shape, "an axisymmetric profile or a function f(r)")
