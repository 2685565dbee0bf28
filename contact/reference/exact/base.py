"""Base classes of the exact solutions: fields and approach from a few closed forms.

A symmetric zone |x| <= a grows from 0 to its half width a; each step adds the load P'(s) ds of a
flat punch of half width s (J. R. Barber, Contact Mechanics, 2018, doi 10.1007/978-3-319-70939-0).
With u = pi x/L and S = sin(pi s/L),

    isolated    p = (1/pi) int_x^a P'(s) ds / sqrt(s^2 - x^2)
                gap = (2/pi E*) int_a^x P'(s) arcosh(x/s) ds
    periodic    p = (cos u/L) int_x^a P'(s) ds / sqrt(S^2 - sin^2 u)
                gap = (2/pi E*) int_a^x P'(s) arcosh(sin u/S) ds,

since tan(pi x/L) turns the Hilbert kernel into the Cauchy kernel for symmetric zones. Fields are
evaluated from distances to the ends of the zone, so that small distances do not cancel.
"""

from dataclasses import dataclass, fields
from math import inf, pi
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import OutOfRange, SceneError
from contact.model.checks import between, positive, positive_or_none
from contact.reference.exact.numerics import (
    Array,
    arcosh1p,
    cosine,
    integrated,
    log_of,
    sine,
    sine_excess,
)


def check_number(zone: int, count: int = 1) -> None:
    """Raise SceneError if there is no zone of this number."""
    if zone not in range(count):
        raise SceneError.of(
            "zone", zone, "0: there is one zone" if count == 1 else f"0 to {count - 1}"
        )


def refuse_load(load: float, most: float, why: str) -> None:
    """Raise OutOfRange if the load is not below `most`; `why` says what happens at `most`."""
    if not load < most:
        raise OutOfRange(f"load = {load:.6g} N/m is out of range: {why} at {most:.6g} N/m")


def with_datum(what: str, value: float | None) -> float:
    """Return the value; raise SceneError if it is None because a datum is missing.
    The datum is the distance at which the far field of an isolated body's displacement is zero.
    """
    if value is None:
        raise SceneError.of(
            "datum", None, f"a length > 0, as {what} of an isolated zone depends on it"
        )
    return value


class ExactContact:
    """Base class of all exact contacts: numbers that follow from zones, load and period."""

    if TYPE_CHECKING:

        @property
        def zones(self) -> Array: ...
        @property
        def load(self) -> float: ...
        @property
        def period(self) -> float | None: ...

    @property
    def zone_widths(self) -> Array:
        """Width of every zone [m], as an array (n,)."""
        return np.diff(self.zones, axis=1)[:, 0]

    @property
    def zone_loads(self) -> Array:
        """Load of every zone [N/m], an array (n,); equal loads unless a subclass overrides this."""
        return np.full(len(self.zones), self.load / len(self.zones))

    @property
    def mean_pressure(self) -> float | None:
        """Load divided by period [Pa]; None without a period."""
        return None if self.period is None else self.load / self.period

    @property
    def contact_fraction(self) -> float | None:
        """Fraction of the period that is in contact; None without a period."""
        return None if self.period is None else float(np.sum(self.zone_widths)) / self.period


class PressedBody(ExactContact):
    """A body under a load: approach, stiffness, compliance and displacement.

    The load P is applied in steps dP, each the load of a flat punch on the current zones. A step
    increases the approach by C dP, where C is the compliance of that punch. Integration by parts
    gives approach = C P + int P d(-C).
    """

    # Annotations only: a value here would become the default of the subclasses' dataclass field of
    # the same name.
    half_width: float
    E_star: float
    datum: float | None

    if TYPE_CHECKING:

        def height(self, x: ArrayLike) -> Array: ...
        def slope(self, x: ArrayLike) -> Array: ...
        def gap(self, x: ArrayLike) -> Array: ...

    def _check(self, *positives: str) -> None:
        """Raise SceneError if one of the attributes with these names is not positive and finite."""
        for name in positives:
            positive(name, getattr(self, name))
        positive_or_none("datum", self.datum)

    @property
    def punch_compliance(self) -> float | None:
        """Derivative of the approach by the load, at fixed zones [m^2/N].

        None for an isolated body without a datum.
        """
        if self.period is None and self.datum is None:
            return None
        return float(self._compliance_of(self.half_width))

    def _compliance_of(self, half_width: ArrayLike) -> Array:
        """Compliance [m^2/N] of a flat punch with the half width a = `half_width` [m].

        It is -(2/pi E*) ln sin(pi a/L) with a period L, and (2/pi E*) ln(2d/a) for an isolated
        punch with the datum d.
        """
        unit = 2.0 / (pi * self.E_star)
        if self.datum is not None:
            return unit * np.log(2.0 * self.datum / np.asarray(half_width))
        return -unit * log_of(sine(half_width, self.period), cosine(half_width, self.period))

    def _approach_by_parts(self) -> float:
        """The approach minus P C, with the load P and the punch compliance C.
        It is the integral int P d(-C) over growing zones.
        """
        raise NotImplementedError

    def _approach(self) -> float:
        """The approach [m]; raises SceneError for an isolated body without a datum."""
        compliance = with_datum("the approach", self.punch_compliance)
        return self.load * compliance + self._approach_by_parts()

    @property
    def approach(self) -> float | None:
        """Approach [m] for a profile whose minimum is 0; None for an isolated body without datum.

        The displacement u has zero mean over a period. Without a period its far field is zero at
        the distance `datum`.
        """
        return None if self.period is None and self.datum is None else self._approach()

    @property
    def stiffness(self) -> float | None:
        """Stiffness d load/d approach [Pa], equal to that of a flat punch on the same zones.

        None for an isolated body without a datum.
        """
        compliance = self.punch_compliance
        return None if compliance is None else (inf if compliance == 0.0 else 1.0 / compliance)

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement u(x) [m] into the body.

        It has zero mean over a period. Without a period it has the far field ln|x/d| with the
        datum d.
        """
        return with_datum("the displacement", self.approach) - self.height(x) + self.gap(x)


class SymmetricZone(PressedBody):
    """One zone [-a, a], isolated (period None) or once in every period.

    It is the base of all exact solutions of one symmetric zone. Equations: the head of this module
    (J. R. Barber, Contact Mechanics, 2018, doi 10.1007/978-3-319-70939-0).

    Attributes
    ----------
    half_width : float
        Half width a of the zone [m].
    E_star : float
        Reduced modulus [Pa].
    period : float or None
        Period L [m]; None: the zone is isolated.
    datum : float or None
        Distance at which the far field of u is zero [m]. An isolated zone without a datum has no
        approach.
    load : float
        P per unit thickness [N/m], per period if there is one.
    mean_pressure, contact_fraction : float or None
        P/L [Pa] and 2a/L; None without a period.
    max_pressure : float
        Largest pressure [Pa]; inf if the profile has a kink or a corner in the zone.
    approach : float or None
        Approach since first touch [m].
    stiffness, punch_compliance : float or None
        d load/d approach [Pa] of a flat punch on the same zone, and its inverse [m^2/N].
    zones : array, (1, 2)
        Ends of the zone [m]; `zone_widths` [m] and `zone_loads` [N/m] are (1,).
    pressure, gap, displacement, height, slope : callable
        p [Pa], gap [m], u [m] into the body, f [m] and f' at positions x [m] of any shape.
    pressure_at : callable
        p [Pa] at normalised positions t in [-1, 1] of the zone, accurate up to its ends.

    Raises
    ------
    SceneError
        From `displacement`, if an isolated zone has no datum.

    Examples
    --------
    The stiffness is that of a flat punch on the same zone.

    >>> import numpy as np
    >>> from contact.exact import HertzLine, IsolatedPunch, SymmetricZone
    >>> hertz = HertzLine(radius=1.0, E_star=1e9, half_width=1e-3, datum=1.0)
    >>> punch = IsolatedPunch(half_width=1e-3, E_star=1e9, load=1e3, datum=1.0)
    >>> isinstance(hertz, SymmetricZone)
    True
    >>> bool(np.isclose(hertz.stiffness, punch.load / punch.approach))
    True
    """

    # Every solution defines the next four formulas, with the half width a and r = |x|. For a point
    # in the zone, d = a - r is the distance from the zone's end. For a point outside the zone,
    # e = r - a is the distance from the zone's end.
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
        """Largest pressure [Pa], at the middle; inf if there is a kink or a corner in the zone."""
        return float(self._pressure(np.array(0.0), np.array(self.half_width)))

    def _check(self, *positives: str) -> None:
        """Raise SceneError if a value is not positive or the zone is as wide as its period."""
        super()._check(*positives)
        if self.period is not None:
            between("half_width", self.half_width, 0.0, 0.5 * self.period)

    @property
    def zones(self) -> Array:
        """Ends of the zone [m], (1, 2)."""
        return np.array([[-self.half_width, self.half_width]])

    def _reduced(self, x: ArrayLike) -> Array:
        """Positions shifted by periods into [-L/2, L/2]."""
        x = np.asarray(x, dtype=float)
        return x if self.period is None else x - self.period * np.round(x / self.period)

    def height(self, x: ArrayLike) -> Array:
        """Profile f(x) [m], with f(0) = 0."""
        return self._height(np.abs(self._reduced(x)))

    def slope(self, x: ArrayLike) -> Array:
        """Slope f'(x) of the profile."""
        x = self._reduced(x)
        return np.sign(x) * self._slope(np.abs(x))

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Pressure [Pa] at normalised positions t in [-1, 1] of the zone, accurate at its ends."""
        check_number(zone)
        r: Array = np.abs(np.asarray(t, dtype=np.float64))
        return self._pressure(self.half_width * r, self.half_width * (1.0 - r))

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure p(x) [Pa], 0 outside the zone."""
        r = np.abs(self._reduced(x))
        inside = r < self.half_width
        r = np.where(inside, r, 0.5 * self.half_width)
        return np.where(inside, self._pressure(r, self.half_width - r), 0.0)

    def gap(self, x: ArrayLike) -> Array:
        """Gap g(x) [m] between the surfaces: displacement + profile - approach; 0 in the zone."""
        e = np.abs(self._reduced(x)) - self.half_width
        return np.where(e > 0.0, self._gap(np.maximum(e, 0.0)), 0.0)

    def _sine(self) -> float:
        """sin(pi a/L) with the half width a and the period L; a itself without a period."""
        return float(sine(self.half_width, self.period))

    def _cosine(self) -> float:
        """cos(pi a/L) with the half width a and the period L; 1 without a period."""
        return float(cosine(self.half_width, self.period))

    @property
    def _sine_unit(self) -> float:
        """Factor that turns the result of `_sine` into a length [m]: L/pi with the period L.
        It is 1 for an isolated zone, where `_sine` is a length already.
        """
        return 1.0 if self.period is None else self.period / pi

    def _length(self) -> float:
        """The period [m]; raises SceneError if there is no period."""
        if self.period is None:
            raise SceneError.of("period", None, "a length > 0")
        return self.period


@dataclass(frozen=True)
class _FromLoad(SymmetricZone):
    """One zone whose half width follows from the load, in closed form or as a root.

    The class of a solution inherits from the class of its profile, and from `IsolatedZone` or
    `PeriodicZone`. It defines the profile, the pressure, the load, and the derivative of the load
    by the half width. Gap and approach follow by the integrals at the head of this module, to
    round-off.
    """

    def __post_init__(self) -> None:
        self._check(*(field.name for field in fields(self) if field.name != "datum"))

    def load_at(self, s: Array) -> Array:
        """Load P [N/m] of a zone of half width s."""
        raise NotImplementedError

    def load_rate(self, s: Array) -> Array:
        """Derivative dP/ds of the load P by the half width s."""
        raise NotImplementedError

    @property
    def load(self) -> float:
        return float(self.load_at(np.array(self.half_width)))

    def _gap(self, e: Array) -> Array:
        a, length = self.half_width, self.period

        def integrand(y: Array, rest: Array) -> Array:
            return self.load_rate(a + y) * arcosh1p(sine_excess(a + y, rest, length))

        return 2.0 / (pi * self.E_star) * integrated(integrand, e)

    def _gap_slope(self, e: Array) -> Array:
        a, length = self.half_width, self.period

        def integrand(y: Array, rest: Array) -> Array:
            square = sine(rest, length) * sine(2.0 * (a + y) + rest, length)
            return self.load_rate(a + y) / np.sqrt(square)

        unit = 2.0 / (pi * self.E_star * self._sine_unit)
        return unit * cosine(a, length, -e) * integrated(integrand, e)

    def _approach_by_parts(self) -> float:
        def integrand(s: Array, _: Array) -> Array:
            return self.load_at(s) * cosine(s, self.period) / sine(s, self.period)

        unit = 2.0 / (pi * self.E_star * self._sine_unit)
        return unit * float(integrated(integrand, self.half_width))

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        raise NotImplementedError

    @classmethod
    def from_load(cls, load: float, **shape: Any) -> Self:
        """The solution at a given load (per period); the other parameters are given by name."""
        numbers = {k: positive(k, v) for k, v in shape.items() if k != "datum"}
        half_width = cls._half_width_for(positive("load", load), **numbers)
        return cls(half_width=half_width, **shape)  # type: ignore[call-arg]


@dataclass(frozen=True)
class IsolatedZone(_FromLoad):
    """Base class of the solutions of one isolated zone.
    The approach is known only with a datum d: far away, the displacement is proportional to
    ln|x/d|.
    """

    E_star: float
    half_width: float
    datum: float | None = None
    period = None


@dataclass(frozen=True)
class PeriodicZone(_FromLoad):
    """Base class of the solutions with one zone in every period."""

    period: float
    E_star: float
    half_width: float
    datum = None

    @classmethod
    def from_mean_pressure(cls, mean_pressure: float, *, period: float, **shape: Any) -> Self:
        """The solution at a given mean pressure; the other parameters are given by name."""
        load = positive("mean_pressure", mean_pressure) * positive("period", period)
        return cls.from_load(load, period=period, **shape)

    @classmethod
    def from_contact_fraction(cls, contact_fraction: float, *, period: float, **shape: Any) -> Self:
        """The solution in which a given fraction of the period is in contact.

        The other parameters are given by name.
        """
        fraction = between("contact_fraction", contact_fraction, 0.0, 1.0)
        a = 0.5 * fraction * positive("period", period)
        return cls(half_width=a, period=period, **shape)  # type: ignore[call-arg]
