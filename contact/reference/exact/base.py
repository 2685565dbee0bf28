"""What every symmetric one-zone solution |x| <= a shares: zones and fields built on a few closed forms.

The superposition behind them (J. R. Barber, Contact Mechanics, 2018, doi 10.1007/978-3-319-70939-0): the load
grows by P'(s) ds through flat punches of half-width s. With u = pi x/L, S = sin(pi s/L),

    isolated    p = (1/pi) int_x^a P'(s) ds / sqrt(s^2 - x^2)
                gap = (2/pi E*) int_a^x P'(s) arcosh(x/s) ds
    periodic    p = (cos u/L) int_x^a P'(s) ds / sqrt(S^2 - sin^2 u)
                gap = (2/pi E*) int_a^x P'(s) arcosh(sin u/S) ds

since tan(pi x/L) turns the Hilbert kernel into the Cauchy one for symmetric zones. Fields are evaluated from
distances to the zone's ends, so nothing cancels where a distance is small.
"""

from collections.abc import Callable
from math import asin, inf, log, log1p, pi
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.errors import OutOfRange, SceneError
from contact.model.checks import between, positive, positive_or_none

# Of numpy alone: what solvers are judged by imports none of them.
Array = NDArray[np.float64]


def _tanh_sinh() -> tuple[Array, Array, Array]:
    """Double-exponential rule on (0, 1): distances from 0, from 1, weights. Exact to rounding for end
    singularities milder than 1/sqrt (Takahasi & Mori 1974)."""
    tau = np.arange(-45, 46) * 0.08
    grow = pi * np.sinh(tau)
    left = 1.0 / (1.0 + np.exp(-grow))
    right = 1.0 / (1.0 + np.exp(grow))
    return left, right, 0.08 * pi * np.cosh(tau) * left * right


FROM_LEFT, FROM_RIGHT, WEIGHT = _tanh_sinh()


def arcosh1p(y: ArrayLike) -> Array:
    """arcosh(1 + y), accurate for small y >= 0."""
    return np.asarray(2.0 * np.arcsinh(np.sqrt(0.5 * np.asarray(y))))


def arccos1m(y: ArrayLike) -> Array:
    """arccos(1 - y), accurate for small y >= 0."""
    return np.asarray(2.0 * np.arcsin(np.sqrt(0.5 * np.minimum(y, 2.0))))


def sinh_minus(y: ArrayLike) -> Array:
    """sinh(y) - y without cancellation."""
    y = np.asarray(y, dtype=float)
    z = np.where(np.abs(y) < 1.0, y, 0.0)
    series, term = np.zeros_like(z), z * z * z / 6.0
    for k in range(2, 11):  # (1/21!) is below rounding at y = 1
        series += term
        term = term * z * z / (2 * k * (2 * k + 1))
    return np.where(np.abs(y) < 1.0, series, np.sinh(y) - y)


def zone_potential(z_minus_1: ArrayLike) -> Array:
    """z sqrt(z^2 - 1) - arcosh z, the shape of a gap that opens from a bounded end at z = 1."""
    return np.asarray(0.5 * sinh_minus(2.0 * arcosh1p(z_minus_1)))


class Zoned:
    """What follows from zones and load, whatever they are: of one zone, or of several that carry the same."""

    if TYPE_CHECKING:

        @property
        def zones(self) -> Array: ...
        @property
        def load(self) -> float: ...
        @property
        def period(self) -> float | None: ...

    @property
    def zone_widths(self) -> Array:
        """Width of every zone [m], (n,)."""
        return np.diff(self.zones, axis=1)[:, 0]

    @property
    def zone_loads(self) -> Array:
        """Load of every zone [N/m], (n,)."""
        return np.full(len(self.zones), self.load / len(self.zones))

    @property
    def mean_pressure(self) -> float | None:
        """Load over period [Pa]; None without one."""
        return None if self.period is None else self.load / self.period

    @property
    def contact_fraction(self) -> float | None:
        """The share of the period in contact; None without a period."""
        return None if self.period is None else float(np.sum(self.zone_widths)) / self.period


class SymmetricZone(Zoned):
    """One zone [-a, a], isolated (period None) or once in every period; the base of the exact solutions of one symmetric zone.

    Equations: the head of this module (J. R. Barber, Contact Mechanics, 2018, doi 10.1007/978-3-319-70939-0).

    Attributes
    ----------
    half_width : float
        Half width a of the zone [m].
    E_star : float
        Reduced modulus [Pa].
    period : float or None
        Period L [m]; None: the zone is alone.
    datum : float or None
        Distance at which the far field of u is zero [m]; a zone that is alone has no approach without it (None).
    load : float
        P per unit thickness [N/m], per period if there is one.
    mean_pressure, contact_fraction : float or None
        P/L [Pa] and 2a/L; None without a period.
    max_pressure : float
        Peak pressure [Pa]; inf where the profile has a kink or a corner in the zone.
    approach : float or None
        By how much the body has come down, from first touch on [m].
    stiffness, punch_compliance : float or None
        d load/d approach [Pa], that of a flat punch on the same zone, and its inverse [m^2/N].
    zones : array, (1, 2)
        The ends [m]; beside them `zone_widths` [m] and `zone_loads` [N/m], both (1,).
    pressure, gap, displacement, height, slope : callable
        p [Pa], gap [m], u [m] into the body, f [m] and f' at positions x [m] of any shape.
    pressure_at : callable
        p [Pa] at normalised positions t in [-1, 1] of the zone, to rounding up to its ends.

    Raises
    ------
    SceneError
        From `displacement`, if a zone that is alone has no datum.

    Examples
    --------
    The stiffness is that of a flat punch on the same zone.

    >>> import numpy as np
    >>> from contact.exact import HertzLine, IsolatedPunch, SymmetricZone
    >>> hertz = HertzLine(radius=1.0, E_star=1e9, half_width=1e-3, datum=1.0)
    >>> punch = IsolatedPunch(half_width=1e-3, E_star=1e9, load=1e3, datum=1.0)
    >>> isinstance(hertz, SymmetricZone), bool(np.isclose(hertz.stiffness, punch.load / punch.approach))
    (True, True)
    """

    # Annotations only: a value here would become the default of a subclass's dataclass field of that name.
    half_width: float
    E_star: float
    period: float | None
    datum: float | None

    if TYPE_CHECKING:

        @property
        def load(self) -> float:
            """P, per unit thickness [N/m]; per period if there is one."""

    # What a family gives: formulas of r = |x| and of the distances d = a - r inside, e = r - a outside.
    def _height(self, r: Array) -> Array:
        raise NotImplementedError

    def _slope(self, r: Array) -> Array:
        raise NotImplementedError

    def _pressure(self, r: Array, d: Array) -> Array:
        raise NotImplementedError

    def _gap(self, e: Array) -> Array:
        raise NotImplementedError

    @property
    def max_pressure(self) -> float:
        """Peak pressure [Pa], in the middle; inf where the profile has a kink or a corner in the zone."""
        return float(self._pressure(np.array(0.0), np.array(self.half_width)))

    def _approach(self) -> float:
        """Approach; called only where it is defined (a period, or a datum)."""
        raise NotImplementedError

    def _check(self, *positives: str, extent: float | None = None) -> None:
        """Refuse by name what is not positive and finite, and a zone as wide as its cell."""
        for name in (*positives, "E_star", "half_width"):
            positive(name, getattr(self, name))
        if self.period is not None:
            positive("period", self.period)
            extent = 0.5 * self.period
        if extent is not None:
            between("half_width", self.half_width, 0.0, extent)
        positive_or_none("datum", self.datum)

    # Geometry
    @property
    def zones(self) -> Array:
        """Ends of the zone [m], (1, 2)."""
        return np.array([[-self.half_width, self.half_width]])

    def _reduced(self, x: ArrayLike) -> Array:
        x = np.asarray(x, dtype=float)
        return x if self.period is None else x - self.period * np.round(x / self.period)

    def height(self, x: ArrayLike) -> Array:
        """f(x) [m], f(0) = 0."""
        return self._height(np.abs(self._reduced(x)))

    def slope(self, x: ArrayLike) -> Array:
        """f'(x)."""
        x = self._reduced(x)
        return np.sign(x) * self._slope(np.abs(x))

    # Fields
    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Pressure [Pa] at the normalised position t in [-1, 1] of the zone, to rounding up to its ends."""
        if zone != 0:
            raise SceneError.of("zone", zone, "0: there is one zone")
        r: Array = np.abs(np.asarray(t, dtype=np.float64))
        return self._pressure(self.half_width * r, self.half_width * (1.0 - r))

    def pressure(self, x: ArrayLike) -> Array:
        """p(x) [Pa], 0 outside the zone."""
        r = np.abs(self._reduced(x))
        inside = r < self.half_width
        r = np.where(inside, r, 0.5 * self.half_width)
        return np.where(inside, self._pressure(r, self.half_width - r), 0.0)

    def gap(self, x: ArrayLike) -> Array:
        """u + f - approach [m], 0 in the zone."""
        e = np.abs(self._reduced(x)) - self.half_width
        return np.where(e > 0.0, self._gap(np.maximum(e, 0.0)), 0.0)

    def displacement(self, x: ArrayLike) -> Array:
        """u(x) [m] into the body; periodic: of zero mean; isolated: zero of ln|x/d| at the datum d."""
        approach = self.approach
        if approach is None:
            raise SceneError.of("datum", None, "a length > 0 where u of an isolated zone is asked for")
        return approach - self.height(x) + self.gap(x)

    # Approach
    @property
    def approach(self) -> float | None:
        """min f = 0 and, periodic, mean u = 0; None for an isolated zone without a datum."""
        return None if self.period is None and self.datum is None else self._approach()

    @property
    def punch_compliance(self) -> float | None:
        """d approach/d load at fixed a [m^2/N]: -(2/pi E*) ln sin(pi a/L), isolated (2/pi E*) ln(2d/a)."""
        if self.period is not None:
            return -2.0 * self._log_sine() / (pi * self.E_star)
        if self.datum is None:
            return None
        return 2.0 * log(2.0 * self.datum / self.half_width) / (pi * self.E_star)

    @property
    def stiffness(self) -> float | None:
        """d load/d approach [Pa]: that of the flat punch on the same zone; None where the approach is
        None."""
        compliance = self.punch_compliance
        return None if compliance is None else (inf if compliance == 0.0 else 1.0 / compliance)

    # Of the half angle A = pi a/L; alone a and 1
    def _sine(self) -> float:
        return float(sine(self.half_width, self.period))

    def _cosine(self) -> float:
        return float(cosine(self.half_width, self.period))

    @property
    def _turn(self) -> float:
        """L/pi, alone 1: what the sine of a small angle is to be multiplied by to be a length."""
        return 1.0 if self.period is None else self.period / pi

    def _log_sine(self) -> float:
        s, c = self._sine(), self._cosine()
        return log(s) if s < c else 0.5 * log1p(-c * c)

    def _length(self) -> float:
        if self.period is None:
            raise SceneError.of("period", None, "a length > 0")
        return self.period


class _LoadControlled(SymmetricZone):
    """One zone whose half-width the load gives in closed form, or by one root."""

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        raise NotImplementedError

    @classmethod
    def from_load(cls, load: float, **shape: Any) -> Self:
        """The solution at a given load (per period); the other parameters by name."""
        numbers = {k: positive(k, v) for k, v in shape.items() if k != "datum"}
        half_width = cls._half_width_for(positive("load", load), **numbers)
        return cls(half_width=half_width, **shape)  # type: ignore[call-arg]


class IsolatedZone(_LoadControlled):
    """Base of the solutions of one zone alone: frozen dataclasses with a field `datum` for the approach."""

    period = None


class PeriodicZone(_LoadControlled):
    """Base of the solutions of one zone a period: frozen dataclasses with a field `period`."""

    datum = None

    @classmethod
    def from_mean_pressure(cls, mean_pressure: float, *, period: float, **shape: Any) -> Self:
        """The solution at a given load per period over the period."""
        load = positive("mean_pressure", mean_pressure) * positive("period", period)
        return cls.from_load(load, period=period, **shape)

    @classmethod
    def from_contact_fraction(cls, contact_fraction: float, *, period: float, **shape: Any) -> Self:
        """The solution at a given 2a/L."""
        a = 0.5 * between("contact_fraction", contact_fraction, 0.0, 1.0) * positive("period", period)
        return cls(half_width=a, period=period, **shape)  # type: ignore[call-arg]


def sine(x: ArrayLike, period: float | None) -> Array:
    """sin(pi x/L); alone x: one form is that of a zone in a row and of a zone alone."""
    x = np.asarray(x, dtype=np.float64)
    return x if period is None else np.asarray(np.sin(pi / period * x))


def cosine(x: ArrayLike, period: float | None, inward: Array | float = 0.0) -> Array:
    """cos(pi (x - inward)/L) by the distance of x from L/2, which keeps its digits; alone 1."""
    return np.ones(np.shape(inward)) if period is None else sine(0.5 * period - np.asarray(x) + inward, period)


def half_width_from_sine(s: float, c: float, period: float) -> float:
    """a with sin(pi a/L) = s and cos = c: the inverse of the smaller of the two keeps the digits."""
    return period / pi * (asin(s) if s < c else 0.5 * pi - asin(c))


def abel_gap(load_rate: Callable[[Array], Array], a: float, e: Array, E_star: float) -> Array:
    """(2/pi E*) int_a^(a+e) P'(s) arcosh((a+e)/s) ds, by a double-exponential rule (see the head of this file)."""
    e = np.asarray(e, dtype=float)[..., None]
    s, rest = a + e * FROM_LEFT, e * FROM_RIGHT
    return 2.0 / (pi * E_star) * np.sum(e * WEIGHT * load_rate(s) * arcosh1p(np.maximum(rest / s, 0.0)), axis=-1)


def refuse_load(load: float, most: float, why: str) -> None:
    """OutOfRange if the load is not below `most`."""
    if not load < most:
        raise OutOfRange(f"load = {load:.6g} N/m is out of range: {why} at {most:.6g} N/m")


def least_value(function: Callable[[Array], Array], low: float, high: float, samples: int) -> float:
    """Smallest value of a smooth function, by samples and closer samples around the smallest."""
    x = np.linspace(low, high, samples)
    y = function(x)
    best, half = float(x[np.argmin(y)]), float(x[1] - x[0])
    for _ in range(8):  # the bracket shrinks to 1e-9 of a sample, far below the square root of rounding
        x = np.clip(best + half * np.linspace(-1.0, 1.0, 33), low, high)
        y = function(x)
        best, half = float(x[np.argmin(y)]), half / 8.0
    return float(np.min(y))
