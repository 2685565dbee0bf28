"""Power law f = C |x|^n, n > 1, isolated and periodic (a sharp valley at L/2).

The isolated load grows as a^n with the half width a. All fields are gamma and hypergeometric
functions, derived from the flat punches of contact.reference.exact.base. The periodic load is one
integral. Power laws in plane contact: V. L. Popov, M. Hess & E. Willert, Handbook of Contact
Mechanics, 2019, doi 10.1007/978-3-662-58709-6.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import gamma, log, pi, sqrt

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import gamma as gamma_of_array
from scipy.special import hyp2f1

from contact.errors import SceneError
from contact.reference.exact.base import IsolatedZone, PeriodicZone, SymmetricZone
from contact.reference.exact.numerics import Array, cosine, integrated, root, sine


@dataclass(frozen=True)
class _Power(SymmetricZone):
    """The profile f = C |x|^n, and the search for the largest pressure."""

    coefficient: float
    exponent: float

    def __post_init__(self) -> None:
        super().__post_init__()  # type: ignore[misc]
        if not self.exponent > 1.0:
            raise SceneError.of("exponent", self.exponent, "above 1 (the exponent 1 gives a wedge)")

    def _height(self, r: Array) -> Array:
        return np.asarray(self.coefficient * r**self.exponent)

    def _slope(self, r: Array) -> Array:
        return np.asarray(self.coefficient * self.exponent * r ** (self.exponent - 1.0))

    @property
    def max_pressure(self) -> float:
        """Largest pressure [Pa].
        It is at x = 0 for exponents up to 2, and at two points +-x for larger exponents.
        """
        middle = float(self.pressure_at(0.0))
        if self.exponent <= 2.0:
            return middle
        found = minimize_scalar(
            lambda t: -float(self.pressure_at(t)),
            bounds=(0.0, 1.0),
            method="bounded",
            options={"xatol": 1e-10},
        )
        return max(middle, -float(found.fun))


@dataclass(frozen=True)
class IsolatedPower(IsolatedZone, _Power):
    """The contact of an isolated power law f = C |x|^n.

    With g = sqrt(pi) Gamma((n + 1)/2)/Gamma(n/2 + 1) and q^2 = 1 - x^2/a^2,

    P = (E*/2) n C g a^n,   p = (n P/pi a) q 2F1(1, 1 - n/2; 3/2; q^2),   p(0) = n P/(pi (n - 1) a),
    gap slope = f'(x) I(1 - a^2/x^2; 1/2, n/2), with I the regularized incomplete beta function,
    approach = (2 P/pi E*)(ln(2d/a) + 1/n).

    Derived here; n = 2 is Hertz's contact. The class method `from_load` makes the solution at a
    given load; everything else is in `SymmetricZone`. V. L. Popov, M. Hess & E. Willert, Handbook
    of Contact Mechanics (2019), doi 10.1007/978-3-662-58709-6.

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
        Distance at which the far field of u is zero [m]; without it there is no approach.

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
        unit = 0.5 * shape["E_star"] * n * shape["coefficient"] * _chebyshev_moment(n)
        return float((load / unit) ** (1.0 / n))

    def load_at(self, s: Array) -> Array:
        """Load P [N/m] of a zone of half width s."""
        return 0.5 * self.E_star * _chebyshev_moment(self.exponent) * s * self._slope(s)

    def load_rate(self, s: Array) -> Array:
        """Derivative dP/ds of the load P by the half width s."""
        n = self.exponent
        return np.asarray(0.5 * self.E_star * n * _chebyshev_moment(n) * self._slope(s))

    def _pressure(self, r: Array, d: Array) -> Array:
        a, n = self.half_width, self.exponent
        return np.asarray(n * self.load / (pi * a) * _abel_of_power(n, r / a, d / a))


@dataclass(frozen=True)
class PeriodicPower(PeriodicZone, _Power):
    """The contact of a periodic power law f = C |x|^n, |x| <= L/2.

    With sin(pi s/L) = t sin A, A = pi a/L, and sinh w = tan A sqrt(1 - t^2),

    P = E* int_0^1 f'(s) (ds/dt) t / sqrt(1 - t^2) dt = (E* L/pi) int_0^artanh(sin A) f'(s) dw.

    Pressure and gap follow from the flat punches; all integrals are taken by the double-exponential
    rule (derived here; n = 2 is Kuznetsov's periodic parabola). The class methods `from_load`,
    `from_mean_pressure` and `from_contact_fraction` start from one of these numbers; everything
    else is in `SymmetricZone`. Ye. A. Kuznetsov, Sov. Appl. Mech. 12 (1976).

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

        def log_ratio(part: float) -> float:
            return log(cls(half_width=half * part, **shape).load / load)

        return half * root(log_ratio, 1e-12, 1.0 - 1e-12)

    def _position(self, a: Array, w: Array, rest: Array) -> tuple[Array, Array, Array]:
        """Half width s, cos(pi s/L) and sin(pi s/L) as functions of the integration variable w.
        The half width s solves sinh w = sqrt(sin^2 A - sin^2(pi s/L))/cos A, A = pi a/L. `rest` is
        the distance artanh(sin A) - w from the upper limit, where s = 0.
        """
        length = self._length()
        sin_a, cos_a = sine(a, length), cosine(a, length)
        # The variable `difference` is 1 - sinh(w)/tan(pi a/L), computed without cancellation.
        difference = 2.0 * np.cosh(w + 0.5 * rest) * np.sinh(0.5 * rest) * cos_a / sin_a
        sin_s = sin_a * np.sqrt(difference * (1.0 + np.sinh(w) * cos_a / sin_a))
        cos_s = cos_a * np.cosh(w)
        return length / pi * np.arctan2(sin_s, cos_s), cos_s, sin_s

    def _integral(self, a: Array, integrand: Callable[[Array, Array], Array]) -> Array:
        """Integral of `integrand` from 0 to artanh(sin(pi a/L)), for half widths a."""
        length = self._length()
        return integrated(integrand, np.arcsinh(sine(a, length) / cosine(a, length)))

    def load_at(self, s: Array) -> Array:
        """Load P [N/m] of a zone of half width s."""
        a, column = s, s[..., None]
        found = self._integral(a, lambda w, rest: self._slope(self._position(column, w, rest)[0]))
        return np.asarray(self.E_star * self._length() / pi * found)

    def load_rate(self, s: Array) -> Array:
        """Derivative dP/ds of the load P by the half width s."""
        a, length = np.asarray(s, dtype=np.float64), self._length()
        column = a[..., None]

        def integrand(w: Array, rest: Array) -> Array:
            at, cos_s, sin_s = self._position(column, w, rest)
            # With A = pi a/L, s = `at` and a fixed ratio sin(pi s/L)/sin A, the load's integrand is
            # proportional to f'(s) sin A/cos(pi s/L). The derivative of the integrand by A is the
            # integrand times cot A (tan(pi s/L) `growth` + 1).
            by_slope = (self.exponent - 1.0) * length / (pi * np.maximum(at, 1e-300))
            growth = by_slope + sin_s / cos_s
            return np.asarray(self._slope(at) * (sin_s / cos_s * growth + 1.0))

        cotangent = cosine(a, length) / sine(a, length)
        return np.asarray(self.E_star * cotangent * self._integral(a, integrand))

    def _pressure(self, r: Array, d: Array) -> Array:
        r, d = np.broadcast_arrays(np.asarray(r, dtype=float), np.asarray(d, dtype=float))
        values = [self._pressure_at(float(r[i]), float(d[i])) for i in np.ndindex(r.shape)]
        return np.reshape(values, r.shape)

    def _pressure_at(self, r: float, d: float) -> float:
        """Pressure at r = |x| from flat punches of all half widths s between r and a.

        The integration variable v is 0 at s = r and 1 at s = a. With u = pi r/L and A = pi a/L,
        sin^2(pi s/L) = sin^2 u + (sin^2 A - sin^2 u) v^2.
        """
        length, a = self._length(), self.half_width
        sin_u, cos_a = float(sine(r, length)), float(cosine(a, length))
        size = float(sine(a + r, length) * sine(d, length))

        def integrand(v: Array, rest: Array) -> Array:
            sin_s = np.hypot(sin_u, sqrt(size) * v)
            cos_s = np.hypot(cos_a, np.sqrt(size * rest * (1.0 + v)))
            s = length / pi * np.arctan2(sin_s, cos_s)
            return np.asarray(self.load_rate(s) / (cos_s * sin_s))

        return float(cosine(r, length)) / pi * sqrt(size) * float(integrated(integrand, 1.0))


def _chebyshev_moment(n: float) -> float:
    """Integral of |t|^n / sqrt(1 - t^2) over t from -1 to 1."""
    return sqrt(pi) * gamma(0.5 * (n + 1.0)) / gamma(0.5 * n + 1.0)


def _abel_of_power(
    n: float, r: Array, d: Array, expand_below: float = 2.5, radius: float = 0.5
) -> Array:
    """Integral of s^(n-1) / sqrt(s^2 - r^2) over s from r to 1; d is 1 - r.

    For exponents n below `expand_below` the hypergeometric function of 1 - r^2 loses the digits of
    r^(n-1) near the tip r = 0. For r < `radius` an expansion in r^2 and r^(n-1) replaces it. That
    expansion has poles at n = 3, 5, ..., but there the loss of digits is small.
    """
    square = d * (1.0 + r)
    out = np.asarray(np.sqrt(square) * hyp2f1(1.0, 1.0 - 0.5 * n, 1.5, square))
    if n >= expand_below:
        return out
    small = np.minimum(r, radius)
    even = hyp2f1(1.0, 1.0 - 0.5 * n, 0.5 * (3.0 - n), small**2)
    even = np.sqrt(1.0 - small**2) * even / (n - 1.0)
    gammas = gamma_of_array(0.5 * (1.0 - n)) / gamma_of_array(1.0 - 0.5 * n)
    odd = 0.5 * sqrt(pi) * gammas * small ** (n - 1.0)
    return np.where(r < radius, even + odd, out)
