"""Closed-form solutions of the engine's equation, independent of any solver.

    (1/pi) PV int phi(xi) K(x - xi) dxi = g(x) on the zones,   K = 1/(x - xi) or (pi/L) cot(pi (x - xi)/L).

Each object knows its zones, its right side g (`value`) with an antiderivative (`primitive`), the
density at a normalised position of a zone (`at`, to rounding up to the ends) and its total. On one
zone, x = middle + w t, all come from

    T_j / sqrt(1 - t^2) -> -U_{j-1},     sqrt(1 - t^2) U_j -> T_{j+1}

(F. G. Tricomi, Quart. J. Math. 2, 1951, 199-211). Periodic ones follow by tan(pi x / L).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.polynomial import chebyshev, polynomial
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class Exact:
    """The members of every closed form. By default there is one zone, centred on the origin."""

    period: float | None = None
    half_width: float

    @property
    def zones(self) -> Array:
        """Table (n, 2) of the zone ends."""
        return np.array([[-self.half_width, self.half_width]])

    @property
    def total(self) -> float:
        """Integral of the density over all zones."""
        raise NotImplementedError

    def value(self, x: ArrayLike) -> Array:
        """g(x)."""
        raise NotImplementedError

    def primitive(self, x: ArrayLike) -> Array:
        """An antiderivative of g."""
        raise NotImplementedError

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Density at the scaled position t in [-1, 1] of a zone."""
        raise NotImplementedError

    def density(self, x: ArrayLike) -> Array:
        """Density at x, zero off the zones."""
        x = np.asarray(x, dtype=float)
        out = np.zeros(x.shape)
        for i, (a, b) in enumerate(self.zones):
            inside = (x >= a) & (x <= b)
            out[inside] = self.at(((x[inside] - a) - (b - x[inside])) / (b - a), i)
        return out


def _root(t: ArrayLike) -> Array:
    """sqrt(1 - t^2)."""
    t = np.asarray(t, dtype=float)
    return np.sqrt((1 - t) * (1 + t))


def _floats(x: ArrayLike) -> Array:
    return np.asarray(x, dtype=float)


@dataclass(frozen=True)
class Flat(Exact):
    """Flat punch: g = 0, singular ends.

    phi = P / (pi sqrt(a^2 - x^2)) (M. Sadowsky, ZAMM 8, 1928, 107-121).
    """

    half_width: float
    load: float

    @property
    def total(self) -> float:
        return self.load

    def value(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def primitive(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        with np.errstate(divide="ignore"):
            return np.asarray(self.load / (math.pi * self.half_width * _root(t)))


@dataclass(frozen=True)
class Hertz(Exact):
    """Parabola: g = k x, free ends, phi = k sqrt(a^2 - x^2), P = pi k a^2 / 2 (H. Hertz 1882)."""

    half_width: float
    curvature: float = 1.0

    @property
    def total(self) -> float:
        return 0.5 * math.pi * self.curvature * self.half_width**2

    def value(self, x: ArrayLike) -> Array:
        return self.curvature * _floats(x)

    def primitive(self, x: ArrayLike) -> Array:
        return 0.5 * self.curvature * _floats(x) ** 2

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        return self.curvature * self.half_width * _root(t)


@dataclass(frozen=True)
class PrescribedIntensity(Exact):
    """Parabola with given intensity K: g = k x, phi ~ K / sqrt(d) at the distance d from an end.

    phi = k sqrt(a^2 - x^2) + K sqrt(2 a) / sqrt(a^2 - x^2), P = pi k a^2 / 2 + pi K sqrt(2 a). If
    K < 0, this is the adhering line contact (M. Barquins, J. Adhesion 26, 1988, 1-12).
    """

    half_width: float
    intensity: float
    curvature: float = 1.0

    @property
    def total(self) -> float:
        a = self.half_width
        return math.pi * (0.5 * self.curvature * a * a + self.intensity * math.sqrt(2 * a))

    def value(self, x: ArrayLike) -> Array:
        return self.curvature * _floats(x)

    def primitive(self, x: ArrayLike) -> Array:
        return 0.5 * self.curvature * _floats(x) ** 2

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        root = _root(t)
        with np.errstate(divide="ignore"):
            edge = self.intensity * math.sqrt(2 / self.half_width) / root
        return np.asarray(self.curvature * self.half_width * root + edge)


@dataclass(frozen=True)
class Tilted(Exact):
    """Tilted punch: g = -s, free left end a, singular right end b.

    phi = s sqrt((x - a)/(b - x)), P = pi s (b - a)/2 (N. I. Muskhelishvili, Singular Integral
    Equations, 1953, ch. 11).
    """

    left: float
    right: float
    slope: float = 1.0

    @property
    def zones(self) -> Array:
        return np.array([[self.left, self.right]])

    @property
    def total(self) -> float:
        return 0.5 * math.pi * self.slope * (self.right - self.left)

    def value(self, x: ArrayLike) -> Array:
        return np.full(np.shape(x), -self.slope)

    def primitive(self, x: ArrayLike) -> Array:
        return -self.slope * _floats(x)

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        t = _floats(t)
        with np.errstate(divide="ignore"):
            return np.asarray(self.slope * np.sqrt((1 + t) / (1 - t)))


@dataclass(frozen=True)
class Wedge(Exact):
    """Wedge: g = s sgn(x), free ends.

    phi = (2 s/pi) arcosh(a/|x|), P = 2 s a (K. L. Johnson, Contact Mechanics, 1985, sec. 5.2).
    """

    half_width: float
    slope: float = 1.0
    jumps_at: ClassVar[tuple[float, ...]] = (0.0,)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Heights of the jumps of g."""
        return (2 * self.slope,)

    @property
    def total(self) -> float:
        return 2 * self.slope * self.half_width

    def value(self, x: ArrayLike) -> Array:
        return self.slope * np.sign(_floats(x))

    def primitive(self, x: ArrayLike) -> Array:
        return self.slope * np.abs(_floats(x))

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        with np.errstate(divide="ignore"):
            # This is arcosh(1/|t|), without cancellation near the ends.
            return np.asarray(2 * self.slope / math.pi * np.arcsinh(_root(t) / np.abs(_floats(t))))


@dataclass(frozen=True)
class Crack(Exact):
    """Crack: g = s, singular ends, total zero.

    phi = -s x / sqrt(a^2 - x^2). Its integral from the left end, s sqrt(a^2 - x^2), is the
    opening of the crack (B. A. Bilby, J. D. Eshelby, Fracture I, 1968, 99-182).
    """

    half_width: float
    stress: float = 1.0

    @property
    def total(self) -> float:
        return 0.0

    def value(self, x: ArrayLike) -> Array:
        return np.full(np.shape(x), self.stress)

    def primitive(self, x: ArrayLike) -> Array:
        return self.stress * _floats(x)

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        with np.errstate(divide="ignore"):
            return np.asarray(-self.stress * _floats(t) / _root(t))

    def opening(self, x: ArrayLike) -> Array:
        """Integral of the density from the left end."""
        return self.stress * self.half_width * _root(_floats(x) / self.half_width)


@dataclass(frozen=True)
class TwoZones(Exact):
    """Two zones a < |x| < b with free ends: g = k x (x^2 - (a^2 + b^2)/2).

    phi = k |x| sqrt((x^2 - a^2)(b^2 - x^2)), P = pi k (b^2 - a^2)^2 / 8 (I. G. Goryacheva, I. Y.
    Tsukanov, Front. Mech. Eng. 6, 2020, 45, eqs. 32-33).
    """

    inner: float
    outer: float
    scale: float = 1.0

    @property
    def zones(self) -> Array:
        return np.array([[-self.outer, -self.inner], [self.inner, self.outer]])

    @property
    def total(self) -> float:
        return math.pi * self.scale * (self.outer**2 - self.inner**2) ** 2 / 8

    def value(self, x: ArrayLike) -> Array:
        x = _floats(x)
        return self.scale * x * (x * x - 0.5 * (self.inner**2 + self.outer**2))

    def primitive(self, x: ArrayLike) -> Array:
        square = _floats(x) ** 2
        return self.scale * square * (square - (self.inner**2 + self.outer**2)) / 4

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        w = 0.5 * (self.outer - self.inner)
        t = _floats(t) * (1 if zone == 1 else -1)
        x = 0.5 * (self.outer + self.inner) + w * t
        return self.scale * x * w * _root(t) * np.sqrt((x + self.inner) * (x + self.outer))


@dataclass(frozen=True)
class _Periodic(Exact):
    """One zone per period, centred on the origin."""

    half_width: float
    period: float

    def _turn(self, t: ArrayLike) -> tuple[Array, Array]:
        """Returns pi x/L and sqrt(sin^2(pi a/L) - sin^2(pi x/L)). The root is computed without
        cancellation.
        """
        t, edge = _floats(t), math.pi * self.half_width / self.period
        return edge * t, np.sqrt(np.sin(edge * (1 - t)) * np.sin(edge * (1 + t)))


@dataclass(frozen=True)
class PeriodicFlat(_Periodic):
    """Row of flat punches: g = 0, singular ends, period L.

    phi = (P/L) cos(pi x/L) / sqrt(sin^2(pi a/L) - sin^2(pi x/L)) (M. Sadowsky, ZAMM 8, 1928,
    107-121).
    """

    load: float = 1.0

    @property
    def total(self) -> float:
        return self.load

    def value(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def primitive(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        phase, root = self._turn(t)
        with np.errstate(divide="ignore"):
            return np.asarray(self.load / self.period * np.cos(phase) / root)


@dataclass(frozen=True)
class PeriodicCracks(_Periodic):
    """Row of cracks: g = s, singular ends, total zero, period L.

    phi = -s sin(pi x/L) / sqrt(sin^2(pi a/L) - sin^2(pi x/L)). The opening is s (L/pi)
    arcosh(cos(pi x/L)/cos(pi a/L)) (W. T. Koiter, Ingenieur-Archiv 28, 1959, 168-172).
    """

    stress: float = 1.0

    @property
    def total(self) -> float:
        return 0.0

    def value(self, x: ArrayLike) -> Array:
        return np.full(np.shape(x), self.stress)

    def primitive(self, x: ArrayLike) -> Array:
        return self.stress * _floats(x)

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        phase, root = self._turn(t)
        with np.errstate(divide="ignore"):
            return np.asarray(-self.stress * np.sin(phase) / root)

    def opening(self, x: ArrayLike) -> Array:
        """Integral of the density from the left end."""
        turn = math.pi / self.period
        ratio = np.cos(turn * _floats(x)) / math.cos(turn * self.half_width)
        return np.asarray(self.stress / turn * np.arccosh(ratio))


@dataclass(frozen=True)
class Westergaard(_Periodic):
    """Wave: g = A sin(2 pi x/L), free ends, period L.

    phi = 2 A cos(pi x/L) sqrt(sin^2(pi a/L) - sin^2(pi x/L)), P = A L sin^2(pi a/L) (H. M.
    Westergaard, J. Appl. Mech. 6, 1939, A49-A53).
    """

    amplitude: float = 1.0

    @property
    def total(self) -> float:
        return self.amplitude * self.period * math.sin(math.pi * self.half_width / self.period) ** 2

    def value(self, x: ArrayLike) -> Array:
        return self.amplitude * np.sin(2 * math.pi / self.period * _floats(x))

    def primitive(self, x: ArrayLike) -> Array:
        wave = 2 * math.pi / self.period
        return -self.amplitude / wave * np.cos(wave * _floats(x))

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        phase, root = self._turn(t)
        return 2 * self.amplitude * np.cos(phase) * root


@dataclass(frozen=True)
class Polynomial(Exact):
    """Polynomial g = sum c_k t^k = sum_j g_j U_{j-1}(t) with singular ends and a given total P.

    Here t = (x - middle)/w, and phi = (P/(pi w) - sum_j g_j T_j(t)) / sqrt(1 - t^2). The operator
    takes T_j / sqrt(1 - t^2) to -U_{j-1}, and T_0 / sqrt(1 - t^2) to 0.
    """

    left: float
    right: float
    coefficients: tuple[float, ...]
    load: float

    @property
    def zones(self) -> Array:
        return np.array([[self.left, self.right]])

    @property
    def total(self) -> float:
        return self.load

    @property
    def _half(self) -> float:
        return 0.5 * (self.right - self.left)

    def _t(self, x: ArrayLike) -> Array:
        x = _floats(x)
        return ((x - self.left) - (self.right - x)) / (self.right - self.left)

    def value(self, x: ArrayLike) -> Array:
        return np.asarray(polynomial.polyval(self._t(x), self.coefficients))

    def primitive(self, x: ArrayLike) -> Array:
        return np.asarray(
            self._half * polynomial.polyval(self._t(x), polynomial.polyint(self.coefficients))
        )

    def at(self, t: ArrayLike, zone: int = 0) -> Array:
        # The antiderivative of U_{j-1} is T_j / j. So the antiderivative of g has the
        # coefficients g_j / j.
        series = -chebyshev.poly2cheb(polynomial.polyint(self.coefficients))
        series *= np.arange(len(series))
        series[0] = self.load / (math.pi * self._half)
        with np.errstate(divide="ignore"):
            return np.asarray(chebyshev.chebval(_floats(t), series) / _root(t))
