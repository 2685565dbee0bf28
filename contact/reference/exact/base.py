"""What every symmetric one-zone solution |x| <= a shares: zones and fields built on a few closed
forms.

The superposition behind them (J. R. Barber, Contact Mechanics, 2018, doi
10.1007/978-3-319-70939-0): the load grows by P'(s) ds through flat punches of half-width s. With u
= pi x/L, S = sin(pi s/L),

    isolated    p = (1/pi) int_x^a P'(s) ds / sqrt(s^2 - x^2)
                gap = (2/pi E*) int_a^x P'(s) arcosh(x/s) ds
    periodic    p = (cos u/L) int_x^a P'(s) ds / sqrt(S^2 - sin^2 u)
                gap = (2/pi E*) int_a^x P'(s) arcosh(sin u/S) ds

since tan(pi x/L) turns the Hilbert kernel into the Cauchy one for symmetric zones. Fields are
evaluated from distances to the zone's ends, so nothing cancels where a distance is small.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from math import atan2, inf, pi
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.errors import OutOfRange, SceneError
from contact.model.checks import between, positive, positive_or_none

# Of numpy alone: what solvers are judged by imports none of them.
Array = NDArray[np.float64]


def _tanh_sinh() -> tuple[Array, Array, Array]:
    """Double-exponential rule on (0, 1): distances from 0, from 1, weights. Exact to rounding for
    end singularities milder than 1/sqrt (Takahasi & Mori 1974).
    """
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


def integrated(function: Callable[[Array, Array], Array], length: ArrayLike) -> Array:
    """int_0^length of a function of the distances from both ends, by the double-exponential rule;
    lengths of any shape.
    """
    length = np.asarray(length, dtype=np.float64)
    # Summed in pairs, which rounds less than a product of vectors.
    return np.asarray(
        length
        * np.sum(
            WEIGHT * function(length[..., None] * FROM_LEFT, length[..., None] * FROM_RIGHT),
            axis=-1,
        )
    )


def check_number(zone: int, count: int = 1) -> None:
    """SceneError if there is no zone of this number."""
    if zone not in range(count):
        raise SceneError.of(
            "zone", zone, "0: there is one zone" if count == 1 else f"0 to {count - 1}"
        )


class Zoned:
    """What follows from zones and load, whatever they are: of one zone, or of several that carry
    the same.
    """

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


class Pressed(Zoned):
    """A body pressed in, and how far: as the load grows through flat punches, its approach is int
    (compliance of the punch) dP, that is,

    P times the compliance of the flat punch on the same zones, and int P d(-compliance), which is
    left when the punch is taken away.
    """

    # Annotations only: a value here would become the default of a subclass's dataclass field of
    # that name.
    half_width: float
    E_star: float
    datum: float | None

    if TYPE_CHECKING:

        def height(self, x: ArrayLike) -> Array: ...
        def slope(self, x: ArrayLike) -> Array: ...
        def gap(self, x: ArrayLike) -> Array: ...

    def _check(self, *positives: str) -> None:
        """Refuse by name what is not positive and finite."""
        for name in positives:
            positive(name, getattr(self, name))
        positive_or_none("datum", self.datum)

    @property
    def punch_compliance(self) -> float | None:
        """d approach/d load at fixed a [m^2/N]: -(2/pi E*) ln sin(pi a/L), isolated (2/pi E*)
        ln(2d/a), and None without a datum.
        """
        if self.period is None and self.datum is None:
            return None
        return float(self._compliance_of(self.half_width))

    def _compliance_of(self, width: ArrayLike) -> Array:
        """That of flat punches of these half widths."""
        if self.datum is not None:
            return np.log(2.0 * self.datum / np.asarray(width)) * 2.0 / (pi * self.E_star)
        return (
            log_of(sine(width, self.period), cosine(width, self.period)) * -2.0 / (pi * self.E_star)
        )

    def _left(self) -> float:
        """The approach less load times punch compliance."""
        raise NotImplementedError

    def _approach(self) -> float:
        """The approach; called only where there is one."""
        return self.load * known("the approach", self.punch_compliance) + self._left()

    @property
    def approach(self) -> float | None:
        """min f = 0 and, periodic, mean u = 0; None for an isolated body without a datum."""
        return None if self.period is None and self.datum is None else self._approach()

    @property
    def stiffness(self) -> float | None:
        """d load/d approach [Pa]: that of the flat punch on the same zones; None where the approach
        is None.
        """
        compliance = self.punch_compliance
        return None if compliance is None else (inf if compliance == 0.0 else 1.0 / compliance)

    def displacement(self, x: ArrayLike) -> Array:
        """u(x) [m] into the body; periodic: of zero mean; isolated: zero of ln|x/d| at the datum d."""
        return known("u", self.approach) - self.height(x) + self.gap(x)


def known(what: str, value: float | None) -> float:
    """What a body that is alone has with a datum only; SceneError without it."""
    if value is None:
        raise SceneError.of(
            "datum", None, f"a length > 0 where {what} of an isolated zone is asked for"
        )
    return value


class SymmetricZone(Pressed):
    """One zone [-a, a], isolated (period None) or once in every period; the base of the exact
    solutions of one symmetric zone.

    Equations: the head of this module (J. R. Barber, Contact Mechanics, 2018, doi
    10.1007/978-3-319-70939-0).

    Attributes
    ----------
    half_width : float
        Half width a of the zone [m].
    E_star : float
        Reduced modulus [Pa].
    period : float or None
        Period L [m]; None: the zone is alone.
    datum : float or None
        Distance at which the far field of u is zero [m]; a zone that is alone has no approach
        without it (None).
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

    # What a family gives: formulas of r = |x| and of the distances d = a - r inside, e = r - a
    # outside.
    def _height(self, r: Array) -> Array:
        raise NotImplementedError

    def _slope(self, r: Array) -> Array:
        raise NotImplementedError

    def _pressure(self, r: Array, d: Array) -> Array:
        raise NotImplementedError

    def _gap_slope(self, e: Array) -> Array:
        raise NotImplementedError

    def _gap(self, e: Array) -> Array:
        return integrated(lambda y, _: self._gap_slope(y), e)

    def load_rate(self, s: Array) -> Array:
        """dP/da at a = s."""
        raise NotImplementedError

    @property
    def max_pressure(self) -> float:
        """Peak pressure [Pa], in the middle; inf where the profile has a kink or a corner in the
        zone.
        """
        return float(self._pressure(np.array(0.0), np.array(self.half_width)))

    def _check(self, *positives: str) -> None:
        """Refuse by name what is not positive and finite, and a zone as wide as its cell."""
        super()._check(*positives)
        if self.period is not None:
            between("half_width", self.half_width, 0.0, 0.5 * self.period)

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
        """Pressure [Pa] at the normalised position t in [-1, 1] of the zone, to rounding up to its
        ends.
        """
        check_number(zone)
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

    # Of the half angle A = pi a/L; alone a and 1
    def _sine(self) -> float:
        return float(sine(self.half_width, self.period))

    def _cosine(self) -> float:
        return float(cosine(self.half_width, self.period))

    @property
    def _turn(self) -> float:
        """L/pi, alone 1: what the sine of a small angle is to be multiplied by to be a length."""
        return 1.0 if self.period is None else self.period / pi

    def _length(self) -> float:
        if self.period is None:
            raise SceneError.of("period", None, "a length > 0")
        return self.period


@dataclass(frozen=True)
class _LoadControlled(SymmetricZone):
    """One zone whose half-width the load gives in closed form, or by one root.

    A family is a profile, which has the fields of the shape, and one of the two classes below,
    which have the others.
    """

    def __post_init__(self) -> None:
        self._check(*(field.name for field in fields(self) if field.name != "datum"))

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        raise NotImplementedError

    @classmethod
    def from_load(cls, load: float, **shape: Any) -> Self:
        """The solution at a given load (per period); the other parameters by name."""
        numbers = {k: positive(k, v) for k, v in shape.items() if k != "datum"}
        half_width = cls._half_width_for(positive("load", load), **numbers)
        return cls(half_width=half_width, **shape)  # type: ignore[call-arg]


@dataclass(frozen=True)
class IsolatedZone(_LoadControlled):
    """Base of the solutions of one zone alone, with a datum for the approach."""

    E_star: float
    half_width: float
    datum: float | None = None
    period = None


@dataclass(frozen=True)
class PeriodicZone(_LoadControlled):
    """Base of the solutions of one zone a period."""

    period: float
    E_star: float
    half_width: float
    datum = None

    @classmethod
    def from_mean_pressure(cls, mean_pressure: float, *, period: float, **shape: Any) -> Self:
        """The solution at a given load per period over the period."""
        load = positive("mean_pressure", mean_pressure) * positive("period", period)
        return cls.from_load(load, period=period, **shape)

    @classmethod
    def from_contact_fraction(cls, contact_fraction: float, *, period: float, **shape: Any) -> Self:
        """The solution at a given 2a/L."""
        a = (
            0.5
            * between("contact_fraction", contact_fraction, 0.0, 1.0)
            * positive("period", period)
        )
        return cls(half_width=a, period=period, **shape)  # type: ignore[call-arg]


def sine(x: ArrayLike, period: float | None) -> Array:
    """sin(pi x/L); alone x: one form is that of a zone in a row and of a zone alone."""
    x = np.asarray(x, dtype=np.float64)
    return x if period is None else np.asarray(np.sin(pi / period * x))


def cosine(x: ArrayLike, period: float | None, inward: Array | float = 0.0) -> Array:
    """cos(pi (x - inward)/L) by the distance of x from L/2, which keeps its digits; alone 1."""
    return (
        np.ones(np.shape(inward))
        if period is None
        else sine(0.5 * period - np.asarray(x) + inward, period)
    )


def sine_excess(x: ArrayLike, e: ArrayLike, period: float | None) -> Array:
    """sin(pi (x + e)/L)/sin(pi x/L) - 1, 0 <= e and x + e up to L/2; alone e/x."""
    half = 0.5 * np.asarray(e)
    return np.asarray(
        2.0 * np.maximum(cosine(x, period, -half), 0.0) * sine(half, period) / sine(x, period)
    )


def log_of(s: ArrayLike, c: ArrayLike) -> Array:
    """ln s of a sine s > 0 whose cosine is c >= 0, with its digits where s is near 1."""
    s, c = np.asarray(s), np.asarray(c)
    return np.asarray(np.where(s < c, np.log(s), 0.5 * np.log1p(-(np.minimum(s, c) ** 2))))


def half_width_from_sine(s: float, c: float, period: float) -> float:
    """a with sin(pi a/L) = s and cos = c."""
    return period / pi * atan2(s, c)


def abel_gap(load_rate: Callable[[Array], Array], a: float, e: Array, E_star: float) -> Array:
    """(2/pi E*) int_a^(a+e) P'(s) arcosh((a+e)/s) ds (see the head of this file)."""
    return (
        2.0
        / (pi * E_star)
        * integrated(lambda y, rest: load_rate(a + y) * arcosh1p(rest / (a + y)), e)
    )


def refuse_load(load: float, most: float, why: str) -> None:
    """OutOfRange if the load is not below `most`."""
    if not load < most:
        raise OutOfRange(f"load = {load:.6g} N/m is out of range: {why} at {most:.6g} N/m")


def least_value(function: Callable[[Array], Array], low: float, high: float, samples: int) -> float:
    """Smallest value of a smooth function, by samples and closer samples around the smallest."""
    x = np.linspace(low, high, samples)
    y = function(x)
    best, half = float(x[np.argmin(y)]), float(x[1] - x[0])
    for _ in range(
        8
    ):  # the bracket shrinks to 1e-9 of a sample, far below the square root of rounding
        x = np.clip(best + half * np.linspace(-1.0, 1.0, 33), low, high)
        y = function(x)
        best, half = float(x[np.argmin(y)]), half / 8.0
    return float(np.min(y))
