"""Punches tilted by a small angle: the gap at zero load is f(x) - tilt x.

The moment is M = int p x dx. e = M/P is the centre of the load. The tilted flat punch in full
contact is that of N. I. Muskhelishvili (1953), sec. 116, and K. L. Johnson, Contact Mechanics
(1985), sec. 2.8. If its pressure would be negative at a corner of the punch, this corner lifts off,
and the pressure is bounded at the new end of the zone. A tilt only moves the zone of a parabola.
The flanks of a tilted wedge have unequal slopes. The pressure under the wedge is bounded at both
ends of the zone if the tip is at x = middle + w cos phi, with the half width w of the zone and
cos phi = -sin(pi tilt/2 slope). All but the punch in full contact is derived here.
"""

from dataclasses import dataclass
from math import atan, cos, inf, pi, sin, tan

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import OutOfRange
from contact.model.checks import finite, positive
from contact.reference.exact.base import PressedBody, check_number
from contact.reference.exact.numerics import Array, arcosh1p, integrated, zone_potential


class TiltedZone(PressedBody):
    """One isolated zone under a tilted punch, whose gap at zero load is f(x) - tilt x.

    This is the base class of the tilted solutions. M = int p x dx is the moment about x = 0, and
    e = M/P is the centre of the load. Derived here, see the head of this module.

    Attributes
    ----------
    half_width, middle : float
        Half width and middle of the zone [m].
    E_star : float
        Reduced modulus [Pa].
    tilt : float
        Small angle [rad], positive if the right side goes down.
    load, moment : float
        P [N/m] and M [N] per unit thickness.
    datum : float or None
        Distance at which the far field of u is zero [m].
    approach : float or None
        Approach at x = 0 since first touch of an untilted body [m]; None without a datum.
    stiffness, punch_compliance : float or None
        d load/d approach at a given tilt [Pa], of a flat punch on the same zone, and its inverse
        [m^2/N].
    max_pressure : float
        Largest pressure [Pa]; inf if there is a corner or a tip in the zone.
    zones : array, (1, 2)
        Ends of the zone [m]; `zone_widths` [m] and `zone_loads` [N/m] are (1,).
    pressure, gap, displacement, height, slope : callable
        p [Pa], gap [m], u [m] into the body, f [m] of the untilted body and the slope f' - tilt of
        the tilted one, at positions x [m] of any shape.
    pressure_at : callable
        p [Pa] at normalised positions t in [-1, 1] of the zone.

    Raises
    ------
    SceneError
        From `pressure_at`, if the zone is not 0; from `displacement`, without a datum.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import TiltedParabola, TiltedZone
    >>> turned = TiltedParabola(radius=1.0, E_star=1e9, half_width=1e-3, tilt=5e-4)
    >>> t, weights = np.polynomial.chebyshev.chebgauss(100)  # for int f/sqrt(1 - t^2) dt
    >>> arm = turned.middle + 1e-3 * t
    >>> moment = 1e-3 * np.sum(weights * np.sqrt(1 - t**2) * turned.pressure_at(t) * arm)
    >>> isinstance(turned, TiltedZone), bool(np.isclose(moment, turned.moment))
    (True, True)
    """

    # These are annotations only: a value would become the default of a dataclass field.
    tilt: float
    moment: float
    period = None

    @property
    def middle(self) -> float:
        """Middle of the zone [m]."""
        raise NotImplementedError

    @property
    def max_pressure(self) -> float:
        """Largest pressure [Pa]; inf if there is a corner or a tip in the zone."""
        return inf

    def _pressure(self, left: Array, right: Array) -> Array:
        """Pressure [Pa] of a point in the zone, given its distances from the ends.

        The distances `left` and `right` are divided by the half width.
        """
        raise NotImplementedError

    def _gap(self, e: Array, side: int) -> Array:
        """Gap [m] at a point outside the right (`side` 1) or left (-1) end of the zone.

        The distance e from this end is divided by the half width.
        """
        raise NotImplementedError

    @property
    def zones(self) -> Array:
        """Ends of the zone [m], (1, 2)."""
        return np.array([[self.middle - self.half_width, self.middle + self.half_width]])

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Pressure [Pa] at the normalised position t in [-1, 1] of the zone."""
        check_number(zone)
        t = np.asarray(t, dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            return self._pressure(1.0 + t, 1.0 - t)

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure p(x) [Pa], 0 outside the zone."""
        t = (np.asarray(x, dtype=float) - self.middle) / self.half_width
        inside = np.abs(t) < 1.0
        return np.where(inside, self.pressure_at(np.where(inside, t, 0.5)), 0.0)

    def gap(self, x: ArrayLike) -> Array:
        """Gap [m], displacement + profile - tilt x - approach; 0 in the zone."""
        z = (np.asarray(x, dtype=float) - self.middle) / self.half_width
        e = np.maximum(np.abs(z) - 1.0, 0.0)
        return np.where(e > 0.0, np.where(z > 0.0, self._gap(e, 1), self._gap(e, -1)), 0.0)

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement u(x) [m] into the body; far away it is proportional to ln|x/d|, datum d."""
        return super().displacement(x) + self.tilt * np.asarray(x, dtype=float)


@dataclass(frozen=True)
class TiltedParabola(TiltedZone):
    """The contact of a tilted parabola f = x^2/2R: Hertz's zone with the middle at R tilt.

    The moment is M = P R tilt; the approach is Hertz's less R tilt^2/2. Fields are in
    `TiltedZone`. Derived here.

    Parameters
    ----------
    radius : float
        Radius R [m].
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width a of the zone [m].
    tilt : float
        Small angle [rad].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it there is no approach.

    Attributes
    ----------
    load, moment, middle : float
        P [N/m], M [N] and R tilt [m].

    Raises
    ------
    SceneError
        If a length or the modulus is not positive and finite, or the tilt not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import TiltedParabola
    >>> turned = TiltedParabola(radius=1.0, E_star=1e9, half_width=1e-3, tilt=5e-4)
    >>> bool(np.allclose(turned.zones, [[-5e-4, 1.5e-3]]))
    True
    >>> bool(np.isclose(turned.moment / turned.load, 5e-4))
    True
    """

    radius: float
    E_star: float
    half_width: float
    tilt: float
    datum: float | None = None

    def __post_init__(self) -> None:
        self._check("radius", "E_star", "half_width")
        finite("tilt", self.tilt)

    @property
    def middle(self) -> float:
        return self.radius * self.tilt

    @property
    def load(self) -> float:
        return pi * self.E_star * self.half_width**2 / (4.0 * self.radius)

    @property
    def moment(self) -> float:  # type: ignore[override]
        return self.load * self.middle

    @property
    def max_pressure(self) -> float:
        return self.E_star * self.half_width / (2.0 * self.radius)

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(np.asarray(x, dtype=float) ** 2 / (2.0 * self.radius))

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray((np.asarray(x, dtype=float) - self.middle) / self.radius)

    def _pressure(self, left: Array, right: Array) -> Array:
        return np.asarray(self.max_pressure * np.sqrt(left * right))

    def _gap(self, e: Array, side: int) -> Array:
        return self.half_width**2 / (2.0 * self.radius) * zone_potential(e)

    def _approach_by_parts(self) -> float:
        return self.half_width**2 / (4.0 * self.radius) - 0.5 * self.radius * self.tilt**2


@dataclass(frozen=True)
class TiltedWedge(TiltedZone):
    """The contact of a tilted wedge f = slope |x|, whose gap at zero load is f(x) - tilt x.

    The zone has the half width w and its middle at w sin alpha, with alpha = (pi/2) tilt/slope.
    With x = w (t + sin alpha), so that the tip is at t = -sin alpha,

    P = E* slope w cos alpha,   M = P w sin alpha / 2 = (P^2 / 2 E* slope) tan alpha,
    p = (E* slope/pi) arcosh((1 + t sin alpha)/|t + sin alpha|),
    approach = (2P/pi E*)(ln(2d/w) + 1).

    The class method `balanced` starts from P and M. Fields are in `TiltedZone`. Derived here.

    Parameters
    ----------
    wedge_slope : float
        Slope of the flanks of the untilted wedge.
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width w of the zone [m].
    tilt : float
        Angle [rad], smaller than the slope.
    datum : float or None
        Distance at which the far field of u is zero [m]; without it there is no approach.

    Attributes
    ----------
    load, moment : float
        P [N/m] and M [N].
    rotational_stiffness : float
        dM/d tilt at a given load [N].

    Raises
    ------
    SceneError
        If a length, slope or modulus is not positive and finite, or the tilt not finite.
    OutOfRange
        If the wedge would lie on one of its flanks.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import TiltedWedge
    >>> wedge = TiltedWedge.balanced(load=1e4, moment=5.0, wedge_slope=0.01, E_star=1e9)
    >>> bool(np.isclose(wedge.moment, 1e8 / (2 * 1e7) * np.tan(np.pi * wedge.tilt / 0.02)))
    True
    """

    wedge_slope: float
    E_star: float
    half_width: float
    tilt: float
    datum: float | None = None

    def __post_init__(self) -> None:
        self._check("wedge_slope", "E_star", "half_width")
        finite("tilt", self.tilt)
        if abs(self.tilt) >= self.wedge_slope:
            raise OutOfRange(
                f"tilt = {self.tilt:.6g} is out of range: its absolute value must be below the "
                f"slope {self.wedge_slope:.6g} of the wedge, which otherwise lies on its flank"
            )

    @classmethod
    def balanced(
        cls,
        load: float,
        moment: float,
        wedge_slope: float,
        E_star: float,
        datum: float | None = None,
    ) -> "TiltedWedge":
        """The wedge contact with a given load and moment."""
        alpha = atan(2.0 * E_star * wedge_slope * moment / positive("load", load) ** 2)
        w = load / (E_star * wedge_slope * cos(alpha))
        return cls(wedge_slope, E_star, w, 2.0 * wedge_slope * alpha / pi, datum)

    @property
    def _alpha(self) -> float:
        return pi * self.tilt / (2.0 * self.wedge_slope)

    @property
    def _tip(self) -> tuple[float, float]:
        """Distances of the wedge's tip from the left and right end, divided by the half width.

        They are 1 -+ sin alpha with alpha = (pi/2) tilt/slope.
        """
        unit = pi / (4.0 * self.wedge_slope)
        left = 2.0 * sin(unit * (self.wedge_slope - self.tilt)) ** 2
        return left, 2.0 * sin(unit * (self.wedge_slope + self.tilt)) ** 2

    @property
    def _cos_alpha(self) -> float:
        return sin(pi * (self.wedge_slope - abs(self.tilt)) / (2.0 * self.wedge_slope))

    @property
    def middle(self) -> float:
        return self.half_width * sin(self._alpha)

    @property
    def zones(self) -> Array:
        left, right = self._tip
        return np.array([[-self.half_width * left, self.half_width * right]])

    @property
    def load(self) -> float:
        return self.E_star * self.wedge_slope * self.half_width * self._cos_alpha

    @property
    def moment(self) -> float:  # type: ignore[override]
        return 0.5 * self.load * self.middle

    @property
    def rotational_stiffness(self) -> float:
        """Derivative [N] of the moment by the tilt, at a given load."""
        return pi * self.load**2 / (4.0 * self.E_star * (self.wedge_slope * self._cos_alpha) ** 2)

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(self.wedge_slope * np.abs(x))

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(self.wedge_slope * np.sign(x) - self.tilt)

    def _pressure(self, left: Array, right: Array) -> Array:
        # The pressure is E* slope/pi arcosh(1 + `excess`), by the formula in the docstring of the
        # class. The distances from the ends of the zone and from the tip give `excess` without
        # cancellation.
        tip_left, tip_right = self._tip
        excess = np.where(
            left > tip_left,
            right * tip_left / (left - tip_left),
            left * tip_right / (right - tip_right),
        )
        return self.E_star * self.wedge_slope / pi * arcosh1p(np.abs(excess))

    def _gap(self, e: Array, side: int) -> Array:
        # The slope of the gap is (4 slope/pi) arctan((s + root)/((2 + s + root) tan(phi/2))), with
        # root = sqrt(s (s + 2)). Here s is the distance from the end of the zone, and 1 - cos phi
        # is the distance of the tip from this end. Both are divided by the half width.
        tangent = tan(0.25 * pi + 0.5 * side * self._alpha)

        def gap_slope(s: Array, _: Array) -> Array:
            root = np.sqrt(s * (s + 2.0))
            return np.arctan2(s + root, (2.0 + s + root) * tangent)

        return 4.0 * self.wedge_slope / pi * self.half_width * integrated(gap_slope, e)

    def _approach_by_parts(self) -> float:
        return 2.0 * self.load / (pi * self.E_star)


@dataclass(frozen=True)
class TiltedPunch(TiltedZone):
    """The contact of a flat punch |x| <= a with sharp corners under a load P and a moment M.

    The centre of the load is e = M/P. Up to |e| = a/2 the whole punch is in contact,

    p = (P + 2 M x/a^2) / (pi sqrt(a^2 - x^2)),   tilt = 4 M/(pi E* a^2),
    approach = (2P/pi E*) ln(2d/a).

    For larger |e| the zone ends at one corner, where t = 1, and has the half width w = 2 (a - |e|),

    p = (P/pi w) sqrt((1 + t)/(1 - t)),   |tilt| = 2P/(pi E* w),
    approach = w |tilt| ln(2d/w) - (a - w)|tilt|.

    Fields are in `TiltedZone`. Full contact: N. I. Muskhelishvili (1953), sec. 116, and K. L.
    Johnson, Contact Mechanics (1985), sec. 2.8; the rest is derived here.

    Parameters
    ----------
    corner : float
        Half width a of the punch [m].
    E_star : float
        Reduced modulus [Pa].
    load : float
        P per unit thickness [N/m].
    moment : float
        M per unit thickness about the middle of the punch [N], smaller than P a.
    datum : float or None
        Distance at which the far field of u is zero [m]; without it there is no approach.

    Attributes
    ----------
    lifted : bool
        Whether one corner of the punch is out of contact.
    half_width, middle, tilt : float
        Half width and middle of the zone [m], and the angle [rad].
    rotational_stiffness : float
        dM/d tilt at a given load [N].

    Raises
    ------
    SceneError
        If a length, the modulus or the load is not positive and finite, or the moment not finite.
    OutOfRange
        If the centre of the load is not between the corners.

    Examples
    --------
    One end lifts off if the centre of the load is more than half way to a corner.

    >>> import numpy as np
    >>> from contact.exact import TiltedPunch
    >>> punch = dict(corner=1.0, E_star=1e9, load=1e4)
    >>> flat, lifted = (TiltedPunch(moment=1e4 * e, **punch) for e in (0.49, 0.6))
    >>> flat.lifted, lifted.lifted, bool(np.allclose(lifted.zones, [[-0.6, 1.0]]))
    (False, True, True)
    """

    corner: float
    E_star: float
    load: float
    moment: float
    datum: float | None = None

    def __post_init__(self) -> None:
        self._check("corner", "E_star", "load")
        finite("moment", self.moment)
        if not abs(self.moment) < self.load * self.corner:
            raise OutOfRange(
                f"moment = {self.moment:.6g} N is out of range: the centre of the load, "
                "moment / load, must lie between the corners of the punch"
            )

    @property
    def lifted(self) -> bool:
        """Whether one corner of the punch is out of contact."""
        return abs(self.moment) > 0.5 * self.load * self.corner

    @property
    def half_width(self) -> float:  # type: ignore[override]
        return 2.0 * (self.corner - abs(self.moment) / self.load) if self.lifted else self.corner

    @property
    def middle(self) -> float:
        return float(np.sign(self.moment)) * (self.corner - self.half_width)

    @property
    def tilt(self) -> float:  # type: ignore[override]
        if not self.lifted:
            return 4.0 * self.moment / (pi * self.E_star * self.corner**2)
        size = 2.0 * self.load / (pi * self.E_star * self.half_width)
        return float(np.sign(self.moment)) * size

    @property
    def rotational_stiffness(self) -> float:
        """Derivative [N] of the moment by the tilt, at a given load.

        It is pi E* w^2/4 with the half width w of the zone.
        """
        return 0.25 * pi * self.E_star * self.half_width**2

    def height(self, x: ArrayLike) -> Array:
        return np.where(np.abs(x) <= self.corner, 0.0, inf)

    def slope(self, x: ArrayLike) -> Array:
        return np.full(np.shape(x), -self.tilt)

    def _pressure(self, left: Array, right: Array) -> Array:
        mean = self.load / (pi * self.half_width)
        if self.lifted:
            ratio = left / right if self.moment > 0 else right / left
            return np.asarray(mean * np.sqrt(ratio))
        share = 2.0 * self.moment / (self.load * self.corner)
        return np.asarray(mean * (1.0 + share * 0.5 * (left - right)) / np.sqrt(left * right))

    def _gap(self, e: Array, side: int) -> Array:
        if not self.lifted or side * self.moment > 0:
            return np.full_like(e, inf)
        # Up to the lifted corner, the gap at the distance d = e w from the end of the zone is
        # |tilt| int_0^d sqrt(s/(s + 2w)) ds, where w is the half width of the zone.
        y = 0.5 * e
        unit = 2.0 * self.half_width * abs(self.tilt)
        gap = unit * (np.sqrt(y * (y + 1.0)) - np.arcsinh(np.sqrt(y)))
        return np.where(e * self.half_width <= 2.0 * (self.corner - self.half_width), gap, inf)

    def _approach_by_parts(self) -> float:
        return -abs(self.tilt * self.middle)
