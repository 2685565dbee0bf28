"""Two zones a <= |x| <= b under an even pressure, isolated or once in every period.

Let v = x without a period and v = tan(pi x/L) with one; as the pressure is even, the Hilbert kernel
is the Cauchy kernel in v. With y = v^2 = m + h cos(theta), the two zones are one zone in y, of
middle m and half width h. The slope f' of the profile is odd, so f' = v G(y) with
G = sum g_n cos(n theta). Equation (34) of the paper below, with its boundary conditions, becomes

    bounded at all four ends   g_0 = 0,
    p = (E* |v|/2) sum g_n sin(n theta),
    P = pi E* h g_1/4 isolated,   P = (E* L/2) |sum g_n rho^n| periodic,

where rho = -1/(z + sqrt(z^2 - 1)) and z = (1 + m)/h. For G linear in y these are (32) and (33) of
Goryacheva & Tsukanov (2020), doi 10.3389/fmech.2020.00045. The rest is derived here.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import atan, ceil, exp, inf, log, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike
from scipy.fft import dct

from contact.errors import OutOfRange, SceneError
from contact.model.checks import keep, positive
from contact.reference.exact.base import check_number
from contact.reference.exact.numerics import Array, least_value, root

# Type of the function G(y, m, h) = f'/v, the profile's slope divided by v, as a function of y =
# v^2. Here v is x or, with a period L, tan(pi x/L). The zone in y has the middle m and the half
# width h.
Ratio = Callable[[Array, float, float], Array]


class Pair:
    """Two zones a <= |x| <= b, given by the inner end a and the outer end b."""

    @property
    def ends(self) -> tuple[float, float]:
        """(inner end a, outer end b) [m] of the two zones a <= |x| <= b."""
        raise NotImplementedError

    @property
    def zones(self) -> Array:
        """Table (2, 2) of the ends [m] of the two zones, from left to right."""
        a, b = self.ends
        return np.array([[-b, -a], [a, b]])


@dataclass(frozen=True, eq=False)
class EvenPair(Pair):
    """Two zones a <= |x| <= b with an even pressure, solved as one zone in the variable y = v^2.
    Here v is x or, with a period L, tan(pi x/L).

    With y = m + h cos(theta), the pressure is p = (E*/2)|v| sum g_n sin(n theta). An isolated pair
    carries the load P = pi E* h g_1/4; for the load with a period see the head of this module.
    Derived here; for f'/v linear in y the formulas are (32) and (33) of Goryacheva & Tsukanov
    (2020), doi 10.3389/fmech.2020.00045.

    Parameters
    ----------
    middle, half : float
        m and h, 0 < h < m; in m^2 if isolated, without unit with a period.
    ratio : array, (n,)
        Coefficients g_n of f'/v as a cosine series in theta; g_0 is 0 if the pressure is bounded at
        all ends.
    E_star : float
        Reduced modulus [Pa].
    period : float or None
        Period L [m]; None: the pair is isolated.

    Attributes
    ----------
    ends : tuple of float
        Inner and outer ends a and b of the zones [m].
    zones : array, (2, 2)
        Ends of both zones [m].
    load : float
        P of both zones [N/m].
    max_pressure : float
        Largest pressure [Pa].
    pressure, pressure_at, at_angle : callable
        p [Pa] at positions x [m], at t in [-1, 1] of a zone (`pressure_at`), or at angles theta.

    Raises
    ------
    SceneError
        From `pressure_at`, if the zone is neither 0 nor 1.

    Examples
    --------
    Gladwell's two tips, f'/x = (x^2 - c^2)/2Rc^2, have the one coefficient h/2Rc^2.

    >>> import numpy as np
    >>> from contact.exact import EvenPair, IsolatedBiquadratic
    >>> pair = EvenPair(middle=1.0, half=0.5, ratio=np.array([0.0, 0.25]), E_star=1.0)
    >>> tips = IsolatedBiquadratic(radius=1.0, spacing=2.0, E_star=1.0, load=pair.load)
    >>> bool(np.allclose(pair.zones, tips.zones))
    True
    >>> bool(np.allclose(pair.pressure([0.8, 1.1]), tips.pressure([0.8, 1.1])))
    True
    """

    middle: float
    half: float
    ratio: Array
    E_star: float
    period: float | None = None

    @classmethod
    def on(
        cls,
        middle: float,
        half: float,
        ratio: Ratio,
        E_star: float,
        limit: float,
        period: float | None = None,
    ) -> "EvenPair":
        """The pair of zones for a right side G = f'/v that is given as a function `ratio`.
        `ratio` is sampled at Chebyshev nodes. It is singular at y = `limit`; the distance of the
        zone from this singularity sets the number of nodes.
        """
        values = _values(ratio, middle, half, limit)
        g = dct(values, type=2) / len(values)
        g[0] *= 0.5
        return cls(middle, half, g, E_star, period)

    @property
    def ends(self) -> tuple[float, float]:
        """(inner end a, outer end b) [m] of the two zones a <= |x| <= b."""
        inner, outer = sqrt(self.middle - self.half), sqrt(self.middle + self.half)
        if self.period is None:
            return inner, outer
        return self.period / pi * atan(inner), self.period / pi * atan(outer)

    @cached_property
    def load(self) -> float:
        """Sum of the loads of the two zones [N/m]."""
        if self.period is None:
            return float(0.25 * pi * self.E_star * self.half * self.ratio[1])
        z = (1.0 + self.middle) / self.half
        rho = -1.0 / (z + sqrt((z - 1.0) * (z + 1.0)))
        series = abs(np.polynomial.polynomial.polyval(rho, self.ratio))
        return float(0.5 * self.E_star * self.period * series)

    def at_angle(self, theta: ArrayLike) -> Array:
        """Pressure [Pa] at the angle theta in a zone.
        The angle is defined by v^2 = middle + half cos(theta), with v = x or, with a period L, v =
        tan(pi x/L).
        """
        theta = np.asarray(theta, dtype=float)
        v = np.sqrt((self.middle - self.half) + 2.0 * self.half * np.cos(0.5 * theta) ** 2)
        series = np.sin(theta[..., None] * np.arange(len(self.ratio))) @ self.ratio
        return np.asarray(0.5 * self.E_star * v * series)

    def angle(self, x: ArrayLike) -> Array:
        """Angle theta of positions x in a zone, defined by v^2 = middle + half cos(theta).
        Here v is x or, with a period L, tan(pi x/L).

        Outside the zones it is 0 or pi, where the pressure is 0.
        """
        v = np.abs(np.asarray(x, dtype=float))
        if self.period is not None:
            v = np.abs(np.tan(pi / self.period * (v - self.period * np.round(v / self.period))))
        inner, outer = np.sqrt(self.middle - self.half), np.sqrt(self.middle + self.half)
        from_outer = np.maximum((outer - v) * (outer + v), 0.0)
        from_inner = np.maximum((v - inner) * (v + inner), 0.0)
        return np.asarray(2.0 * np.arctan2(np.sqrt(from_outer), np.sqrt(from_inner)))

    def pressure(self, x: ArrayLike) -> Array:
        """Contact pressure p(x) [Pa]; 0 outside the two zones."""
        return self.at_angle(self.angle(x))

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Pressure [Pa] at the position t of a zone, from -1 at its left to 1 at its right end."""
        check_number(zone, 2)
        a, b = self.ends
        outward = np.asarray(t, dtype=float) * (1.0 if zone == 1 else -1.0)
        return self.pressure(0.5 * (a + b) + 0.5 * (b - a) * outward)

    @cached_property
    def max_pressure(self) -> float:
        """Largest pressure [Pa]."""
        return -least_value(lambda theta: -self.at_angle(theta), 0.0, pi, 2001)


def _values(
    ratio: Ratio, middle: float, half: float, limit: float, least: int = 32, most: int = 8192
) -> Array:
    """Values of the right side G = f'/v (`ratio`) at Chebyshev nodes.
    There are as many nodes as the Chebyshev series of G needs.

    The number n of nodes is between `least` and `most`. The terms of the series of G fall as rho^n.
    The rate rho depends on the nearer singularity: y = -1, where arctan v branches, or `limit`. At
    -ln(rho) n = 38 round-off is reached. `most` bounds n if the zone nearly reaches a singularity.
    """
    nearest = min(1.0 + middle, limit - middle) / half
    rate = float(np.arccosh(max(nearest, 1.0)))
    n = most if rate * most < 38.0 else max(least, ceil(38.0 / rate))
    # The difference `middle - half` is computed first. It is small if the two zones nearly merge,
    # and then it must be exact.
    y = (middle - half) + 2.0 * half * np.cos(0.5 * pi * (np.arange(n) + 0.5) / n) ** 2
    return ratio(y, middle, half)


def bounded_middle(ratio: Ratio, half: float, limit: float) -> float | None:
    """Middle of a zone of half width `half` in y = v^2, with bounded pressure; or None.
    The pressure is bounded at both ends of this zone if g_0 = 0, where g_0 is the mean of G = f'/v
    over the angle theta (head of this module). There is no such middle if the zones have met at x =
    0, or if y reaches `limit`. g_0 grows with the middle: it is negative if the tip lies further
    out than the zone, and positive if the tip lies further in.
    """

    def g_0(middle: float) -> float:
        return float(np.mean(_values(ratio, middle, half, limit)))

    if 2.0 * half >= limit or g_0(half) >= 0.0:
        return None
    if limit < inf:
        high = (1.0 - 1e-12) * (limit - half)
        if high <= half or g_0(high) <= 0.0:
            return None
    else:
        high = 2.0 * half
        while g_0(high) <= 0.0:
            high *= 2.0
    return root(g_0, half, high)


def pair_at_load(
    ratio: Ratio, load: float, E_star: float, limit: float, period: float | None = None
) -> EvenPair:
    """The pair of zones that carries a load; raises OutOfRange if the zones have merged.

    The zone in y lies below `limit`. The load grows with the half width h of the zone in y, so h is
    found as a root. The middle m follows from h by `bounded_middle`.
    """

    def at(half: float) -> EvenPair | None:
        m = bounded_middle(ratio, half, limit)
        return None if m is None else EvenPair.on(m, half, ratio, E_star, limit, period)

    def log_excess(log_half: float) -> float:
        pair = at(exp(log_half))
        # If no pair of zones has this half width, the two zones have merged. Merged zones carry
        # more load than any pair.
        return inf if pair is None else log(pair.load / load)

    low = log(limit if np.isfinite(limit) else 1.0) - 1.0
    while log_excess(low) > 0.0:
        low -= 2.0
    step = 1.0
    while (ahead := log_excess(low + step)) <= 0.0 or ahead == inf:
        if ahead == inf:
            step *= 0.5
        else:
            low += step
        if step < 1e-13:
            raise OutOfRange(
                f"load = {load:.6g} N/m is out of range: at this load the two zones have merged"
            )
    pair = at(exp(root(log_excess, low, low + step)))
    assert pair is not None
    return pair


def tips_slope(x: Array, radius: float, spacing: float) -> Array:
    """Slope f' of the profile f = (x^2 - c^2)^2/8Rc^2, with 2c = `spacing`."""
    c = 0.5 * spacing
    return np.asarray(x * (x - c) * (x + c) / (2.0 * radius * c * c))


@dataclass(frozen=True)
class PairRow(Pair):
    """Two tips at the distance `spacing` in every period, each with its own contact zone.

    The mean pressure is the load of both tips, divided by the period. A subclass defines `pair`, or
    else the ends of the zones and the pressure.
    """

    radius: float
    spacing: float
    period: float
    E_star: float
    mean_pressure: float

    def __post_init__(self) -> None:
        keep(self, positive, "radius", "spacing", "period", "E_star", "mean_pressure")
        if not self.spacing < self.period:
            raise SceneError.of("spacing", self.spacing, f"below the period {self.period:.17g}")

    @property
    def load(self) -> float:
        """Sum of the loads of the two zones in one period [N/m]."""
        return self.mean_pressure * self.period

    @cached_property
    def pair(self) -> EvenPair:
        """The two zones as one zone in the variable y = v^2 (see `EvenPair`)."""
        raise NotImplementedError

    @property
    def ends(self) -> tuple[float, float]:
        """(inner end a, outer end b) [m] of the two zones a <= |x| <= b."""
        return self.pair.ends

    @property
    def max_pressure(self) -> float:
        """Largest pressure [Pa]."""
        return self.pair.max_pressure

    def pressure(self, x: ArrayLike) -> Array:
        """Contact pressure p(x) [Pa]; 0 outside the two zones."""
        return self.pair.pressure(x)


@dataclass(frozen=True)
class PeriodicBiquadratic(PairRow):
    """Two tips f = (x^2 - c^2)^2/8Rc^2 once in every period, each tip with its own zone.

    This is the exact solution in v = tan(pi x/L). Only the series of G = f'(x(v))/v is not
    elementary. Derived here, after (34) of Goryacheva & Tsukanov (2020), doi
    10.3389/fmech.2020.00045.

    Parameters
    ----------
    radius : float
        Radius of curvature R at the tips [m].
    spacing : float
        Distance 2c of the tips, below the period [m].
    period : float
        Period L [m].
    E_star : float
        Reduced modulus [Pa].
    mean_pressure : float
        Load of both tips, divided by the period [Pa].

    Attributes
    ----------
    load : float
        P per period [N/m].
    inner_end, outer_end : float
        Inner and outer ends a and b of the zones [m].
    zones : array, (2, 2)
        Ends of the zones [m]; `zone_widths` [m] and `zone_loads` [N/m] are (2,).
    contact_fraction, max_pressure : float
        2(b - a)/L, and the largest pressure [Pa].
    pair : EvenPair
        The solution in v.
    pressure, pressure_at, slope : callable
        p [Pa] and f' at positions x [m]; p at t in [-1, 1] of a zone (`pressure_at`).

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the spacing is not below the period.
    OutOfRange
        From every attribute, past the load at which the two zones meet.

    Examples
    --------
    In a long period the tips are those of `IsolatedBiquadratic`.

    >>> import numpy as np
    >>> from contact.exact import IsolatedBiquadratic, PeriodicBiquadratic
    >>> tips = dict(radius=1.0, spacing=2.0, E_star=1.0)
    >>> row = PeriodicBiquadratic(period=1e3, mean_pressure=1e-4, **tips)
    >>> bool(np.allclose(row.zones, IsolatedBiquadratic(load=0.1, **tips).zones, rtol=1e-4))
    True
    """

    @cached_property
    def pair(self) -> EvenPair:
        """The two zones as one zone in y = v^2, where v = tan(pi x/L) for the period L."""

        def ratio(y: Array, middle: float, half: float) -> Array:
            v = np.sqrt(y)
            return tips_slope(self.period / pi * np.arctan(v), self.radius, self.spacing) / v

        return pair_at_load(ratio, self.load, self.E_star, inf, self.period)

    zone_widths = property(lambda self: np.diff(self.zones, axis=1)[:, 0])
    zone_loads = property(lambda self: np.full(2, 0.5 * self.load))
    contact_fraction = property(lambda self: float(np.sum(self.zone_widths)) / self.period)
    inner_end = property(lambda self: self.ends[0])
    outer_end = property(lambda self: self.ends[1])

    def slope(self, x: ArrayLike) -> Array:
        """Slope f'(x) of the profile."""
        x = np.asarray(x, dtype=float)
        return tips_slope(x - self.period * np.round(x / self.period), self.radius, self.spacing)

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Pressure [Pa] at the position t of a zone, from -1 at its left to 1 at its right end."""
        return self.pair.pressure_at(t, zone)
