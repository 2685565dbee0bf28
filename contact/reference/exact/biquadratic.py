"""Two asperities of one isolated punch, f = (x^2 - c^2)^2/8Rc^2: eq. (31)-(33).

G. M. L. Gladwell, Contact Problems in the Classical Theory of Elasticity (1980), as given by
Goryacheva & Tsukanov (2020), doi 10.3389/fmech.2020.00045. The regime of one zone, the gap and the
approach are derived: in y = x^2 the two zones are one Hertz zone.
"""

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.reference.exact.base import PressedBody, check_number
from contact.reference.exact.numerics import Array, arcosh1p, sinh_minus, zone_potential


@dataclass(frozen=True)
class IsolatedBiquadratic(PressedBody):
    """The contact of one punch with two tips at x = -c and c, f = (x^2 - c^2)^2/8Rc^2.

    While the total load is P < pi E* c^2/8R there are two zones a <= |x| <= b, a^2 + b^2 = 2c^2,
    h = (b^2 - a^2)/2:

    (32) p = (E*/4Rc^2) |x| sqrt((x^2 - a^2)(b^2 - x^2)),   (33) P = pi E* h^2/8Rc^2 (half of P on
    each zone), gap = (1/8Rc^2)(v sqrt(v^2 - h^2) - h^2 arcosh(v/h)), v = |x^2 - c^2|,
    approach = (h^2/8Rc^2)(ln(2d^2/h) + 1/2).

    Above that load there is one zone |x| <= b:   p = (E*/8Rc^2) sqrt(b^2 - x^2)(2x^2 + b^2 - 2c^2),
    P = pi E* b^2 (3b^2 - 4c^2)/32Rc^2.

    G. M. L. Gladwell, Contact Problems in the Classical Theory of Elasticity (1980), as given by
    Goryacheva & Tsukanov (2020), doi 10.3389/fmech.2020.00045; the one zone, the gap and the
    approach are derived here.

    Parameters
    ----------
    radius : float
        Radius of curvature R at the tips [m].
    spacing : float
        Distance 2c of the tips [m].
    E_star : float
        Reduced modulus [Pa].
    load : float
        P of both tips per unit thickness [N/m]. The class method `from_inner_end` starts from a.
    datum : float or None
        Distance at which the far field of u is zero [m]; without it there is no approach.

    Attributes
    ----------
    inner_end, outer_end : float
        a (0 once the zones have merged) and b [m].
    merging_load : float
        pi E* c^2/8R [N/m], at which two zones become one.
    merged : bool
        Whether there is one zone.
    zones : array, (2, 2) or (1, 2)
        Ends of the zones [m]; `zone_widths` [m] and `zone_loads` [N/m] are (2,) or (1,).
    max_pressure : float
        Largest pressure [Pa].
    approach, stiffness, punch_compliance : float or None
        Approach since the tips touch [m], d load/d approach [Pa], and its inverse [m^2/N]; None
        without a datum.
    pressure, gap, displacement, height, slope : callable
        p [Pa], gap [m], u [m] into the body, f [m] and f' at positions x [m] of any shape.
    pressure_at : callable
        p [Pa] at normalised positions t in [-1, 1] of a zone.

    Raises
    ------
    SceneError
        If a number is not positive and finite.

    Examples
    --------
    At the merging load the zones reach from -sqrt(2) c to sqrt(2) c.

    >>> import numpy as np
    >>> from contact.exact import IsolatedBiquadratic
    >>> tips = IsolatedBiquadratic(radius=1.0, spacing=2.0, E_star=1.0, load=np.pi / 8)
    >>> tips.merged, bool(np.allclose(tips.zones, [[-np.sqrt(2), np.sqrt(2)]]))
    (True, True)
    """

    radius: float
    spacing: float
    E_star: float
    load: float
    datum: float | None = None
    period = None

    def __post_init__(self) -> None:
        self._check("radius", "spacing", "E_star", "load")

    @classmethod
    def from_inner_end(cls, inner_end: float, **shape: float) -> "IsolatedBiquadratic":
        """The contact with two zones whose inner ends lie at |x| = `inner_end`."""
        c = 0.5 * shape["spacing"]
        h = (c - inner_end) * (c + inner_end)
        if not (h > 0.0 and inner_end > 0.0):
            raise SceneError.of("inner_end", inner_end, "above 0 and below half the spacing")
        return cls(load=pi * shape["E_star"] * h * h / (8.0 * shape["radius"] * c * c), **shape)

    @property
    def _c(self) -> float:
        return 0.5 * self.spacing

    @property
    def _unit(self) -> float:
        """The factor 1/8Rc^2 of the profile, with the radius R and half the spacing, c."""
        return 1.0 / (8.0 * self.radius * self._c**2)

    @property
    def merging_load(self) -> float:
        """The load at which the two zones become one [N/m]."""
        return pi * self.E_star * self._c**2 / (8.0 * self.radius)

    @property
    def merged(self) -> bool:
        """Whether the two zones have merged into one."""
        return self.load >= self.merging_load

    @property
    def _h(self) -> float:
        return self._c**2 * sqrt(self.load / self.merging_load)

    @property
    def outer_end(self) -> float:
        """Outer end b [m] of the zones a <= |x| <= b."""
        if not self.merged:
            return sqrt(self._c**2 + self._h)
        # With two zones merged into one, the load P and the outer end b satisfy
        # 3b^4 - 4b^2c^2 = 4c^4 P/P_merging.
        return self._c * sqrt((2.0 + sqrt(4.0 + 12.0 * self.load / self.merging_load)) / 3.0)

    @property
    def inner_end(self) -> float:
        """Inner end a [m] of the zones a <= |x| <= b; 0 once the two zones have merged into one."""
        return 0.0 if self.merged else sqrt(self._c**2 - self._h)

    @property
    def zones(self) -> Array:
        """Table of the ends of the zones [m]: (2, 2), or (1, 2) once the two zones have merged."""
        a, b = self.inner_end, self.outer_end
        return np.array([[-b, b]]) if self.merged else np.array([[-b, -a], [a, b]])

    @property
    def max_pressure(self) -> float:
        """Largest pressure [Pa] of the zone or the two zones.

        It is at x^2 = (3b^2 + 2c^2)/6 if there is one zone. For two zones it is at
        x^2 - c^2 = h^2/(c^2 + sqrt(c^4 + 3h^2)), h = (b^2 - a^2)/2.
        """
        c2, h = self._c**2, self._h
        one = (3.0 * self.outer_end**2 + 2.0 * c2) / 6.0
        y = one if self.merged else c2 + h * h / (c2 + sqrt(c2 * c2 + 3.0 * h * h))
        return float(self.pressure(sqrt(y)))

    def height(self, x: ArrayLike) -> Array:
        """Height f(x) [m] of the profile; it is 0 at the two tips."""
        x = np.asarray(x, dtype=float)
        return self._unit * ((x - self._c) * (x + self._c)) ** 2

    def slope(self, x: ArrayLike) -> Array:
        """Slope f'(x) of the profile f = (x^2 - c^2)^2/8Rc^2."""
        x = np.asarray(x, dtype=float)
        return 4.0 * self._unit * x * (x - self._c) * (x + self._c)

    def _pressure(self, r: Array, from_inner: Array, from_outer: Array) -> Array:
        b = self.outer_end
        if self.merged:
            shape = 2.0 * r * r + (b * b - 2.0 * self._c**2)
            return self.E_star * self._unit * np.sqrt(from_outer * (b + r)) * shape
        product = from_inner * (r + self.inner_end) * from_outer * (b + r)
        return 2.0 * self.E_star * self._unit * r * np.sqrt(product)

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Pressure [Pa] at the position t of a zone, from -1 at its left to 1 at its right end.
        It is accurate up to the ends.
        """
        check_number(zone, len(self.zones))
        t = np.asarray(t, dtype=float)
        b = self.outer_end
        if self.merged:
            return self._pressure(b * np.abs(t), t, b * (1.0 - np.abs(t)))
        outward = t if zone == 1 else -t
        # The half width (b - a)/2 of a zone is computed as h/(b + a), with h = (b^2 - a^2)/2. In
        # narrow zones the difference b - a would lose digits.
        half = self._h / (b + self.inner_end)
        inner = half * (1.0 + outward)
        return self._pressure(self.inner_end + inner, inner, half * (1.0 - outward))

    def pressure(self, x: ArrayLike) -> Array:
        """Contact pressure p(x) [Pa]; 0 outside the zones."""
        r = np.abs(np.asarray(x, dtype=float))
        a, b = self.inner_end, self.outer_end
        inside = (r < b) & ((r > a) | self.merged)
        r = np.where(inside, r, 0.5 * (a + b))
        return np.where(inside, self._pressure(r, r - a, b - r), 0.0)

    def gap(self, x: ArrayLike) -> Array:
        """Gap [m] between the surfaces: displacement + profile - approach; 0 in the zones."""
        r = np.abs(np.asarray(x, dtype=float))
        a, b, h = self.inner_end, self.outer_end, self._h
        e = np.maximum(r - b, 0.0)
        if self.merged:
            eta = arcosh1p(e / b)
            quartic = b**4 / 16.0 * sinh_minus(4.0 * eta)
            square = 0.25 * b * b * (b * b - 2.0 * self._c**2) * sinh_minus(2.0 * eta)
            return 2.0 * self._unit * (quartic + square)
        v_minus_h = e * (r + b) + np.maximum(a - r, 0.0) * (r + a)
        return self._unit * h * h * zone_potential(v_minus_h / h)

    @property
    def punch_compliance(self) -> float | None:
        """Compliance d approach/d load for fixed ends of the zones [m^2/N]; None without a datum.

        It is (1/pi E*) ln(2d^2/h) for two zones, with h = (b^2 - a^2)/2, and (2/pi E*) ln(2d/b) for
        one.
        """
        if self.datum is None:
            return None
        return float(self._compliance_of(self.outer_end if self.merged else sqrt(2.0 * self._h)))

    def _approach_by_parts(self) -> float:
        if not self.merged:
            return 0.5 * self._unit * self._h**2
        # The value returned is (2/pi E*) int_0^b P(s) ds/s + f(0), where P(s) is the load of one
        # zone of half width s. The formula for P(s) is used down to s = 0.
        b, c = self.outer_end, self._c
        return self._unit * (b * b * (3.0 * b * b - 8.0 * c * c) / 8.0 + c**4)
