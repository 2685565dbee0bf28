"""Punches turned by a small angle on a half-plane: the gap at zero load is f(x) - tilt x, and M =
int p x dx.

Derived here, e = M/P being the centre of the load. The pressure of a turned flat punch in full
contact is that of N. I. Muskhelishvili (1953), sec. 116, and K. L. Johnson, Contact Mechanics
(1985), sec. 2.8; where it would pull, one end lifts off and the zone is bounded there. A parabola
only moves its zone. A turned wedge has unequal slopes, and the angle phi of its tip, cos phi =
-sin(pi tilt / 2 slope), makes both ends free.
"""

from dataclasses import dataclass
from math import atan, cos, inf, pi, sin, tan

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import OutOfRange
from contact.model.checks import finite, positive
from contact.reference.exact.base import (
    Array,
    Pressed,
    arcosh1p,
    check_number,
    integrated,
    zone_potential,
)


class TiltedZone(Pressed):
    """One zone under a turned punch, the gap at no load being f(x) - tilt x; the base of its
    solutions.

    M = int p x dx is the moment about the middle of the body, e = M/P the centre of the load.
    Derived here, see the head of this module.

    Attributes
    ----------
    half_width, middle : float
        Half width and middle of the zone [m].
    E_star : float
        Reduced modulus [Pa].
    tilt : float
        The angle, small [rad]; positive where the right side goes down.
    load, moment : float
        P [N/m] and M [N] per unit thickness.
    datum : float or None
        Distance at which the far field of u is zero [m].
    approach : float or None
        By how much the body has come down at x = 0, from f(0) = 0 on [m]; None without a datum.
    stiffness, punch_compliance : float or None
        d load/d approach at a given tilt [Pa], that of a flat punch on the same zone, and its
        inverse [m^2/N].
    max_pressure : float
        Peak pressure [Pa]; inf where there is a corner or a tip in the zone.
    zones : array, (1, 2)
        The ends [m]; beside them `zone_widths` [m] and `zone_loads` [N/m], both (1,).
    pressure, gap, displacement, height, slope : callable
        p [Pa], gap [m], u [m] into the body, f [m] of the body as it is given and f' - tilt as it
        stands, at positions x [m] of any shape.
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
    >>> x, weights = np.polynomial.chebyshev.chebgauss(100)  # for int f/sqrt(1 - x^2) dx
    >>> moment = 1e-3 * np.sum(weights * np.sqrt(1 - x**2) * turned.pressure_at(x) * (turned.middle + 1e-3 * x))
    >>> isinstance(turned, TiltedZone), bool(np.isclose(moment, turned.moment))
    (True, True)
    """

    # Annotations only, as in `Pressed`.
    tilt: float
    moment: float
    period = None

    @property
    def middle(self) -> float:
        """Middle of the zone [m]."""
        raise NotImplementedError

    @property
    def max_pressure(self) -> float:
        """Peak pressure [Pa]; inf where there is a corner or a tip in the zone."""
        return inf

    def _pressure(self, left: Array, right: Array) -> Array:
        """p at distances from the ends over the half width, left + right = 2."""
        raise NotImplementedError

    def _gap(self, beyond: Array, side: int) -> Array:
        """Gap at a distance beyond the right (side 1) or left (-1) end, over the half width."""
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
        """p(x) [Pa], 0 outside the zone."""
        t = (np.asarray(x, dtype=float) - self.middle) / self.half_width
        inside = np.abs(t) < 1.0
        return np.where(inside, self.pressure_at(np.where(inside, t, 0.5)), 0.0)

    def gap(self, x: ArrayLike) -> Array:
        """u + f - tilt x - approach [m], 0 in the zone."""
        z = (np.asarray(x, dtype=float) - self.middle) / self.half_width
        beyond = np.maximum(np.abs(z) - 1.0, 0.0)
        right, left = self._gap(beyond, 1), self._gap(beyond, -1)
        return np.where(beyond > 0.0, np.where(z > 0.0, right, left), 0.0)

    def displacement(self, x: ArrayLike) -> Array:
        """u(x) [m] into the body, zero of ln|x/d| at the datum d."""
        return super().displacement(x) + self.tilt * np.asarray(x, dtype=float)


@dataclass(frozen=True)
class TiltedParabola(TiltedZone):
    """A turned parabola f = x^2/2R: the zone of Hertz about x = R tilt, M = P R tilt, approach =
    that of Hertz - R tilt^2/2.

    Derived here: a parabola only moves its zone.

    Parameters
    ----------
    radius : float
        Radius R [m].
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width a of the zone [m].
    tilt : float
        The angle, small [rad].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it (None) there is no approach.

    Attributes
    ----------
    load, moment, middle : float
        P [N/m], M [N] and R tilt [m].
    pressure, gap, zones, approach : as in `TiltedZone`
        What every such zone has, and what else is there.

    Raises
    ------
    SceneError
        If a length or the modulus is not positive and finite, or the tilt not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import TiltedParabola
    >>> turned = TiltedParabola(radius=1.0, E_star=1e9, half_width=1e-3, tilt=5e-4)
    >>> bool(np.allclose(turned.zones, [[-5e-4, 1.5e-3]])), bool(np.isclose(turned.moment / turned.load, 5e-4))
    (True, True)
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

    def _gap(self, beyond: Array, side: int) -> Array:
        return self.half_width**2 / (2.0 * self.radius) * zone_potential(beyond)

    def _left(self) -> float:
        return self.half_width**2 / (4.0 * self.radius) - 0.5 * self.radius * self.tilt**2


@dataclass(frozen=True)
class TiltedWedge(TiltedZone):
    """A turned wedge f = slope |x|, alpha = pi tilt / 2 slope, of half width w about w sin alpha,
    the tip at t = -sin alpha in the zone:

    P = E* slope w cos alpha,   M = P w sin alpha / 2 = (P^2 / 2 E* slope) tan alpha, p = (E*
    slope/pi) arcosh((1 + t sin alpha)/|t + sin alpha|),   approach = (2P/pi E*)(ln(2d/w) + 1).

    Derived here.

    Parameters
    ----------
    wedge_slope : float
        The slope of the flanks before it is turned.
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width w of the zone [m].
    tilt : float
        The angle, below the slope in size [rad].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it (None) there is no approach.

    Attributes
    ----------
    load, moment : float
        P [N/m] and M [N]; the class method `balanced` starts from these.
    rotational_stiffness : float
        dM/d tilt at a given load [N].
    pressure, gap, zones, approach : as in `TiltedZone`
        What every such zone has, and what else is there.

    Raises
    ------
    SceneError
        If a length, slope or modulus is not positive and finite, or the tilt not finite.
    OutOfRange
        If the wedge would lie on its flank.

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
                f"tilt = {self.tilt:.6g}: a wedge of slope {self.wedge_slope:.6g} turned so far lies on its flank"
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
        """The solution of given load and moment."""
        alpha = atan(2.0 * E_star * wedge_slope * moment / positive("load", load) ** 2)
        w = load / (E_star * wedge_slope * cos(alpha))
        return cls(wedge_slope, E_star, w, 2.0 * wedge_slope * alpha / pi, datum)

    @property
    def _alpha(self) -> float:
        return pi * self.tilt / (2.0 * self.wedge_slope)

    @property
    def _tip(self) -> tuple[float, float]:
        """Distances of the tip from the left and right end over the half width, 1 -+ sin alpha,
        near either end too.
        """
        left, right = (
            2.0 * sin(pi * (self.wedge_slope - turn) / (4.0 * self.wedge_slope)) ** 2
            for turn in (self.tilt, -self.tilt)
        )
        return left, right

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
        """dM/d tilt at given load [N]."""
        return pi * self.load**2 / (4.0 * self.E_star * (self.wedge_slope * self._cos_alpha) ** 2)

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(self.wedge_slope * np.abs(x))

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(self.wedge_slope * np.sign(x) - self.tilt)

    def _pressure(self, left: Array, right: Array) -> Array:
        at_left, at_right = self._tip
        ratio = np.where(
            left > at_left, right * at_left / (left - at_left), left * at_right / (right - at_right)
        )
        return self.E_star * self.wedge_slope / pi * arcosh1p(np.abs(ratio))

    def _gap(self, beyond: Array, side: int) -> Array:
        # The gap opens with the slope (4 slope/pi) arctan((1 - rho) / ((1 + rho) tan(phi/2))), by
        # the angle phi of the tip from the end it opens at and rho = z - sqrt(z^2 - 1), z = 1 + s.
        turn = tan(0.25 * pi + 0.5 * side * self._alpha)

        def opening(s: Array, _: Array) -> Array:
            root = np.sqrt(s * (s + 2.0))
            return np.arctan2(s + root, (2.0 + s + root) * turn)

        return 4.0 * self.wedge_slope / pi * self.half_width * integrated(opening, beyond)

    def _left(self) -> float:
        return 2.0 * self.load / (pi * self.E_star)


@dataclass(frozen=True)
class TiltedPunch(TiltedZone):
    """A flat punch |x| <= a with sharp corners under P and M, e = M/P. Up to |e| = a/2 all of it is
    in contact,

    p = (P + 2 M x/a^2) / (pi sqrt(a^2 - x^2)),   tilt = 4 M/(pi E* a^2),   approach = (2P/pi E*)
    ln(2d/a); beyond, a zone of half width w = 2 (a - |e|) at one corner, t = 1 there, p = (P/pi w)
    sqrt((1 + t)/(1 - t)),   |tilt| = 2P/(pi E* w),   approach = w |tilt| ln(2d/w) - (a - w)|tilt|.

    Full contact: N. I. Muskhelishvili (1953), sec. 116, and K. L. Johnson, Contact Mechanics
    (1985), sec. 2.8; the rest derived here.

    Parameters
    ----------
    corner : float
        Half width a of the punch [m].
    E_star : float
        Reduced modulus [Pa].
    load : float
        P per unit thickness [N/m].
    moment : float
        M per unit thickness about the middle of the punch, below P a in size [N].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it (None) there is no approach.

    Attributes
    ----------
    lifted : bool
        Whether one end is out of contact.
    half_width, middle, tilt : float
        Of the zone [m], and the angle [rad].
    rotational_stiffness : float
        dM/d tilt at a given load [N].
    pressure, gap, zones, approach : as in `TiltedZone`
        What every such zone has, and what else is there.

    Raises
    ------
    SceneError
        If a length, the modulus or the load is not positive and finite, or the moment not finite.
    OutOfRange
        If the centre of the load is not between the corners.

    Examples
    --------
    One end lifts off where the centre of the load is more than half way to a corner.

    >>> import numpy as np
    >>> from contact.exact import TiltedPunch
    >>> punches = [TiltedPunch(corner=1.0, E_star=1e9, load=1e4, moment=1e4 * e) for e in (0.49, 0.6)]
    >>> [punch.lifted for punch in punches], bool(np.allclose(punches[1].zones, [[-0.6, 1.0]]))
    ([False, True], True)
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
                f"moment = {self.moment:.6g} N: the load's centre is not between the corners"
            )

    @property
    def lifted(self) -> bool:
        """Whether one end is out of contact."""
        return abs(self.moment) > 0.5 * self.load * self.corner

    @property
    def half_width(self) -> float:  # type: ignore[override]
        return 2.0 * (self.corner - abs(self.moment) / self.load) if self.lifted else self.corner

    @property
    def middle(self) -> float:
        return float(np.sign(self.moment)) * (self.corner - self.half_width)

    @property
    def tilt(self) -> float:  # type: ignore[override]
        if self.lifted:
            return (
                float(np.sign(self.moment)) * 2.0 * self.load / (pi * self.E_star * self.half_width)
            )
        return 4.0 * self.moment / (pi * self.E_star * self.corner**2)

    @property
    def rotational_stiffness(self) -> float:
        """dM/d tilt at given load [N]: pi E* w^2/4, with w = a in full contact."""
        return 0.25 * pi * self.E_star * self.half_width**2

    def height(self, x: ArrayLike) -> Array:
        return np.where(np.abs(x) <= self.corner, 0.0, inf)

    def slope(self, x: ArrayLike) -> Array:
        return np.full(np.shape(x), -self.tilt)

    def _pressure(self, left: Array, right: Array) -> Array:
        mean = self.load / (pi * self.half_width)
        if self.lifted:
            return np.asarray(
                mean * (np.sqrt(left / right) if self.moment > 0 else np.sqrt(right / left))
            )
        share = 2.0 * self.moment / (self.load * self.corner)
        return np.asarray(mean * (1.0 + share * 0.5 * (left - right)) / np.sqrt(left * right))

    def _gap(self, beyond: Array, side: int) -> Array:
        if not self.lifted or side * self.moment > 0:
            return np.full_like(beyond, inf)
        # |tilt| int sqrt(y/(y + 2w)) dy from the lifted end to the other corner.
        y = 0.5 * beyond
        gap = (
            2.0
            * self.half_width
            * abs(self.tilt)
            * (np.sqrt(y * (y + 1.0)) - np.arcsinh(np.sqrt(y)))
        )
        return np.where(beyond * self.half_width <= 2.0 * (self.corner - self.half_width), gap, inf)

    def _left(self) -> float:
        return -abs(self.tilt * self.middle)
