"""Power law f = C |x|^n, n > 1, alone and in a row of period L (a sharp valley at L/2).

Alone the load grows as a^n, and everything is told by gamma and hypergeometric functions (derived
here from the head of contact.reference.exact.base; the plane contact of power laws: V. L. Popov, M.
Hess & E. Willert, Handbook of Contact Mechanics, 2019, doi 10.1007/978-3-662-58709-6). In a row the
load is one integral, taken by the double-exponential rule.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import gamma, log, pi, sqrt

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import betainc, hyp2f1
from scipy.special import gamma as gammas

from contact.errors import SceneError
from contact.reference.exact import base
from contact.reference.exact.base import Array, cosine, integrated, sine
from contact.reference.exact.roots import root

# Exponents below which the integral of the pressure is taken by its expansion about the tip,
# within this part of the half width.
_LOW = 2.5
_NEAR = 0.5
# Exponent up to which the pressure is highest in the middle.
_FLAT = 2.0


@dataclass(frozen=True)
class _Power(base.SymmetricZone):
    """What the two share: the profile."""

    coefficient: float
    exponent: float

    def __post_init__(self) -> None:
        super().__post_init__()  # type: ignore[misc]
        if not self.exponent > 1.0:
            raise SceneError.of("exponent", self.exponent, "above 1 (at 1 it is a wedge)")

    def _height(self, r: Array) -> Array:
        return np.asarray(self.coefficient * r**self.exponent)

    def _slope(self, r: Array) -> Array:
        return np.asarray(self.coefficient * self.exponent * r ** (self.exponent - 1.0))

    @property
    def max_pressure(self) -> float:
        """Peak pressure [Pa]; of steep powers, n > 2, it is off the middle, on both sides."""
        middle = float(self.pressure_at(0.0))
        if self.exponent <= _FLAT:
            return middle
        found = minimize_scalar(
            lambda t: -float(self.pressure_at(t)),
            bounds=(0.0, 1.0),
            method="bounded",
            options={"xatol": 1e-10},
        )
        return max(middle, -float(found.fun))


@dataclass(frozen=True)
class IsolatedPower(base.IsolatedZone, _Power):
    """A power law f = C |x|^n alone, with g = sqrt(pi) Gamma((n + 1)/2)/Gamma(n/2 + 1) and q^2 = 1
    - x^2/a^2:

    P = (E*/2) n C g a^n,   p = (n P/pi a) q 2F1(1, 1 - n/2; 3/2; q^2),   p(0) = n P/(pi (n - 1) a),
    gap slope = f'(x) I(1 - a^2/x^2; 1/2, n/2), I the regularized incomplete beta function,
    approach = (2 P/pi E*)(ln(2d/a) + 1/n).

    Derived here; n = 2 is Hertz's contact. V. L. Popov, M. Hess & E. Willert, Handbook of Contact
    Mechanics (2019),
    doi 10.1007/978-3-662-58709-6.

    Parameters
    ----------
    coefficient : float
        C [m^(1-n)].
    exponent : float
        n, above 1.
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width a of the zone [m].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it (None) there is no approach.

    Attributes
    ----------
    load : float
        P per unit thickness [N/m]; the class method `from_load` makes the solution at a given P.
    pressure, gap, zones, approach : as in `SymmetricZone`
        What every such zone has, and what else is there.

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the exponent is not above 1.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import HertzLine, IsolatedPower
    >>> power = IsolatedPower.from_load(1e4, coefficient=0.5, exponent=2.0, E_star=1e9)
    >>> hertz = HertzLine.from_load(1e4, radius=1.0, E_star=1e9)
    >>> bool(np.isclose(power.half_width, hertz.half_width))
    True
    """

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        n = shape["exponent"]
        unit = 0.5 * shape["E_star"] * n * shape["coefficient"] * _mean(n)
        return float((load / unit) ** (1.0 / n))

    @property
    def load(self) -> float:
        return (
            0.5
            * self.E_star
            * self.half_width
            * float(self._slope(np.array(self.half_width)))
            * _mean(self.exponent)
        )

    def load_rate(self, s: Array) -> Array:
        """dP/da at a = s."""
        return np.asarray(0.5 * self.E_star * self.exponent * _mean(self.exponent) * self._slope(s))

    def _pressure(self, r: Array, d: Array) -> Array:
        scale = self.exponent * self.load / (pi * self.half_width)
        return np.asarray(scale * _punches(self.exponent, r / self.half_width, d / self.half_width))

    def _gap_slope(self, e: Array) -> Array:
        a = self.half_width
        return np.asarray(
            self._slope(a + e) * betainc(0.5, 0.5 * self.exponent, e * (2.0 * a + e) / (a + e) ** 2)
        )

    def _gap(self, e: Array) -> Array:
        return base.abel_gap(self.load_rate, self.half_width, e, self.E_star)

    def _left(self) -> float:
        return 2.0 * self.load / (pi * self.E_star * self.exponent)


@dataclass(frozen=True)
class PeriodicPower(base.PeriodicZone, _Power):
    """A power law f = C |x|^n, |x| <= L/2, in a row: with sin(pi s/L) = t sin A, A = pi a/L,

    P = E* int_0^1 f'(s) (ds/dt) t / sqrt(1 - t^2) dt = (E* L/pi) int_0^artanh(sin A) f'(s) dw,
    sinh(w) = tan A sqrt(1 - t^2),

    and pressure and gap from these by the superposition of punches; all by the double-exponential
    rule (derived here; n = 2 is Kuznetsov's row of parabolas). Ye. A. Kuznetsov, Sov. Appl. Mech.
    12 (1976).

    Parameters
    ----------
    coefficient : float
        C [m^(1-n)].
    exponent : float
        n, above 1.
    period : float
        Period L [m].
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width a of the zone [m].

    Attributes
    ----------
    load : float
        P per period [N/m]; the class methods `from_load`, `from_mean_pressure` and
        `from_contact_fraction` start from one of these numbers.
    pressure, gap, zones, approach : as in `SymmetricZone`
        What every such zone has, and what else is there.

    Raises
    ------
    SceneError
        If a number is not positive and finite, the exponent is not above 1, or the zone is as wide
        as its period.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import PeriodicParabola, PeriodicPower
    >>> shape = dict(period=1e-2, E_star=1e9, half_width=2.5e-3)
    >>> row = PeriodicPower(coefficient=0.5, exponent=2.0, **shape)
    >>> bool(np.isclose(row.load, PeriodicParabola(radius=1.0, **shape).load))
    True
    """

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        half = 0.5 * shape["period"]

        def logarithm(part: float) -> float:
            return log(cls(half_width=half * part, **shape).load / load)

        return half * root(logarithm, 1e-12, 1.0 - 1e-12)

    @property
    def load(self) -> float:
        return float(self._loads(np.array(self.half_width)))

    def _places(self, a: Array, w: Array, rest: Array) -> tuple[Array, Array, Array]:
        """(s, cos(pi s/L), sin(pi s/L)) at (1 - t^2)^(1/2) tan A = sinh(w), rest = artanh(sin A) -
        w.
        """
        length = self._length()
        size, least = sine(a, length), cosine(a, length)
        # 1 - (sinh(w)/tan A)^2 without cancellation.
        less = 2.0 * np.cosh(w + 0.5 * rest) * np.sinh(0.5 * rest) * least / size
        sine_s = size * np.sqrt(less * (1.0 + np.sinh(w) * least / size))
        cosine_s = least * np.cosh(w)
        return length / pi * np.arctan2(sine_s, cosine_s), cosine_s, sine_s

    def _over(self, a: Array, integrand: Callable[[Array, Array], Array]) -> Array:
        """int integrand dw = sin A int integrand t / ((1 - t^2)^(1/2) cos(pi s/L)) dt for half
        widths.
        """
        length = self._length()
        return integrated(integrand, np.arcsinh(sine(a, length) / cosine(a, length)))

    def _loads(self, a: Array) -> Array:
        """P of half widths."""
        column = a[..., None]
        found = self._over(a, lambda w, rest: self._slope(self._places(column, w, rest)[0]))
        return np.asarray(self.E_star * self._length() / pi * found)

    def load_rate(self, s: Array) -> Array:
        """dP/da at a = s."""
        a, length = np.asarray(s, dtype=np.float64), self._length()
        column = a[..., None]

        def integrand(w: Array, rest: Array) -> Array:
            at, cosine_s, sine_s = self._places(column, w, rest)
            # d ln(f' sin A / cos(pi s/L)) / dA, with ds/dA = (L/pi) tan(pi s/L) cot A.
            grown = (self.exponent - 1.0) * length / (
                pi * np.maximum(at, 1e-300)
            ) + sine_s / cosine_s
            return np.asarray(self._slope(at) * (sine_s / cosine_s * grown + 1.0))

        return np.asarray(
            self.E_star * cosine(a, length) / sine(a, length) * self._over(a, integrand)
        )

    def _pressure(self, r: Array, d: Array) -> Array:
        length, a = self._length(), self.half_width
        r, d = np.broadcast_arrays(np.asarray(r, dtype=float), np.asarray(d, dtype=float))
        # S^2 = sin^2 u + (sin^2 A - sin^2 u) v^2.
        wide = sine(a + r, length) * sine(d, length)
        out = np.empty(r.shape)
        for at in np.ndindex(r.shape):
            low, size = float(sine(r[at], length)), float(wide[at])

            def integrand(v: Array, rest: Array, low: float = low, size: float = size) -> Array:
                big = np.hypot(low, sqrt(size) * v)
                cosine_s = np.hypot(float(cosine(a, length)), np.sqrt(size * rest * (1.0 + v)))
                return np.asarray(
                    self.load_rate(length / pi * np.arctan2(big, cosine_s)) / (cosine_s * big)
                )

            out[at] = (
                float(cosine(r[at], length))
                / pi
                * sqrt(size)
                * float(integrated(integrand, np.array(1.0)))
            )
        return out

    def _gap(self, e: Array) -> Array:
        length, a = self._length(), self.half_width

        def opened(y: Array, rest: Array) -> Array:
            return np.asarray(
                self.load_rate(a + y) * base.arcosh1p(base.sine_excess(a + y, rest, length))
            )

        return np.asarray(2.0 / (pi * self.E_star) * integrated(opened, e))

    def _left(self) -> float:
        a, length = self.half_width, self._length()

        def borne(y: Array, rest: Array) -> Array:
            return np.asarray(self._loads(y) * cosine(y, length) / sine(y, length))

        return 2.0 / (self.E_star * length) * float(integrated(borne, np.array(a)))


def _mean(n: float) -> float:
    """int_-1^1 |t|^n / sqrt(1 - t^2) dt."""
    return sqrt(pi) * gamma(0.5 * (n + 1.0)) / gamma(0.5 * n + 1.0)


def _punches(n: float, r: Array, d: Array) -> Array:
    """int_r^1 s^(n-1) / sqrt(s^2 - r^2) ds, d = 1 - r."""
    square = d * (1.0 + r)
    out = np.asarray(np.sqrt(square) * hyp2f1(1.0, 1.0 - 0.5 * n, 1.5, square))
    if n >= _LOW:
        return out
    # Next to the tip r^2 is lost in q^2: there by powers of r^2, and r^(n-1).
    small = np.minimum(r, _NEAR)
    even = (
        np.sqrt(1.0 - small**2) * hyp2f1(1.0, 1.0 - 0.5 * n, 0.5 * (3.0 - n), small**2) / (n - 1.0)
    )
    odd = 0.5 * sqrt(pi) * gammas(0.5 * (1.0 - n)) / gammas(1.0 - 0.5 * n) * small ** (n - 1.0)
    return np.where(r < _NEAR, even + odd, out)
