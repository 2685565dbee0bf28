r"""A solved contact spot: pressure, gap and displacement from the Abel transforms, and its checks.

    p(r)   = E* p_f(r) + sum (2 N P/pi) arctan(sqrt(a^2 - r^2)/sqrt(A^2 - a^2))
             + (E*/pi) sqrt(a^2 - r^2) int_0^1 (e'(x)/x) ds,   x^2 = r^2 + (a^2 - r^2) s^2
    gap(r) = (2/pi) int_a^r [g(x) + d + e(x) - sum (2 N P/E*) sqrt(A^2 - x^2) - delta]
             dx / sqrt(r^2 - x^2)

Here a is the radius of the spot, delta the approach, and d the depth of the tip below the highest
tips. p_f is the pressure of the profile alone, divided by E*, and g the Abel transform of the
profile. e(x) is the effect of the neighbours that are treated at their places. The other neighbours
are N spots per unit area with the load P each, outside a circle of radius A; the sums are over the
kinds of spots (`system`). All fields are means over the angle. Displacements are measured from the
mean plane.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from math import inf, isinf, log, pi, sqrt

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

import sie
from contact.axisymmetric.lattices import own_radius
from contact.axisymmetric.octaves import SERIES
from contact.axisymmetric.profiles import AxisymmetricProfile
from contact.axisymmetric.quadrature import panels
from contact.axisymmetric.system import Surface
from contact.errors import OutOfRange, SceneError
from contact.model.checks import finite_array
from contact.model.profiles.noise import EPS, ROUND_OFF
from contact.model.units import quantity, text_table, with_error
from contact.reference.exact.numerics import least_value
from sie import Array, Mask


@dataclass(frozen=True)
class SpotOptions:
    """Numbers of radii at which the fields of a spot are evaluated and checked."""

    # Number of radii at which a field is evaluated together; it bounds the memory used.
    block: int = 64
    # Number of samples of the pressure, and of the gap, in `Spot.check`.
    samples: int = 48


_OPTIONS = SpotOptions()


@dataclass(frozen=True)
class Spot(sie.Kept):
    """One contact spot that was solved for, with the effect of its neighbours.
    `solve_spot` and `solve_levels` return such spots.

    The equations are in the docstring of this module. `error` bounds the relative errors of load
    and radius, and the error of the pressure divided by the mean pressure, as a solution of the
    model's equations. It does not include the error of the model itself.

    Parameters
    ----------
    profile : AxisymmetricProfile
        The shape.
    E_star : float
        Reduced modulus [Pa].
    radius : float
        Radius a of the spot [m].
    load : float
        Load P of the spot [N].
    depth : float
        Distance of its tip below the highest tips [m].
    approach : float
        Approach of the body since first touch, measured from the mean plane of the surface (for a
        spot alone, from the surface at infinity) [m].
    density : float
        Number of such spots per unit area [1/m^2]; 0 for a spot alone.
    rings : float
        Number of rings of neighbours treated at their places, up to inf.
    surface : Surface
        The effect of the other spots on this one.
    reach : float
        Distance at which the neighbours begin [m]; inf for a spot alone.
    error : float
        Bound of the relative error.

    Attributes
    ----------
    nominal_pressure, contact_fraction : float or None
        Load and contact area per unit area [Pa, 1]; None for a spot alone.
    mean_pressure, max_pressure : float
        Mean over the spot and peak [Pa]; the peak under a tip or an edge is inf.
    circle : float
        A = (pi N)^(-1/2), the radius of the circle whose area is the area per spot [m]; inf for a
        spot alone.
    pressure, gap, displacement : callable
        p [Pa], gap [m] and u [m] at radii r [m] of any shape, as means over the angle. Gap and
        displacement are defined up to `reach`.
    balance : callable
        Integral of the pressure over the spot, divided by the load, minus 1.

    Raises
    ------
    SceneError
        From `gap` and `displacement`, beyond `reach`.
    OutOfRange
        From `check`, if contact is not one full circle.

    Examples
    --------
    Hertz: the peak is 3/2 of the mean pressure, and the approach a^2/R.

    >>> import numpy as np
    >>> from contact.axisymmetric import Sphere, solve_spot
    >>> spot = solve_spot(Sphere(radius=1e-3), 1e11, load=1.0)
    >>> bool(np.isclose(spot.max_pressure / spot.mean_pressure, 1.5))
    True
    >>> bool(np.isclose(spot.approach, spot.radius**2 / 1e-3))
    True
    """

    profile: AxisymmetricProfile
    E_star: float
    radius: float
    load: float
    depth: float
    approach: float
    density: float
    rings: float
    surface: Surface = field(repr=False)
    reach: float
    error: float = 0.0

    def __str__(self) -> str:
        """A table of load, radius, pressures and other results, with units and error bounds."""
        mean = self.mean_pressure
        numbers = [
            ("load", self.load, "N", self.error * self.load),
            ("radius of the spot", self.radius, "m", self.error * self.radius),
            ("mean pressure", mean, "Pa", 3 * self.error * mean),
            ("largest pressure", self.max_pressure, "Pa", self.error * mean),
            ("nominal pressure", self.nominal_pressure, "Pa", None),
            ("contact fraction", self.contact_fraction, "", None),
            ("approach", self.approach, "m", None),
            ("depth of its tip", self.depth, "m", None),
        ]
        rows = [
            (name, *with_error(value, error, unit))
            for name, value, unit, error in numbers
            if value is not None
        ]
        rows += [("rings of neighbours", f"{self.rings:g}", "")] * (self.density > 0)
        columns = zip(("quantity", "value", "error at most"), zip(*rows, strict=True), strict=True)
        kind = type(self.profile).__name__.lower()
        return f"{kind}, E* = {quantity(self.E_star, 'Pa', 6)}\n\n{text_table(columns)}"

    @property
    def nominal_pressure(self) -> float | None:
        """Nominal pressure [Pa]: load per spot times the number of spots per area.
        It is None for a single spot.
        """
        return self.load * self.density if self.density > 0 else None

    @property
    def mean_pressure(self) -> float:
        """Mean pressure in the spot: load divided by the area of the spot [Pa]."""
        return self.load / (pi * self.radius**2)

    @property
    def contact_fraction(self) -> float | None:
        """Contact area per unit area of the surface; None for a single spot without neighbours."""
        return pi * self.radius**2 * self.density if self.density > 0 else None

    @property
    def circle(self) -> float:
        """Radius [m] of the circle whose area is the area per spot; inf for a single spot."""
        return own_radius(self.density) if self.density > 0 else inf

    def pressure(self, r: ArrayLike) -> Array:
        """Contact pressure p(r) [Pa] at the radius r; 0 outside the spot."""
        r = np.abs(finite_array("r", r, None))
        return _where(r < self.radius, r, self._pressure)

    def _pressure(self, r: Array) -> Array:
        a = self.radius
        flat = self.profile.pressure_shape(r, a)
        square = (a - r) * (a + r)
        for strength, around in self.surface.nominal:
            flat = flat + strength / pi * np.arctan(
                np.sqrt(square / ((around.circle - a) * (around.circle + a)))
            )
        if self.surface.sources:
            bend, nodes, weights = self._bend
            place = (r[:, None] ** 2 + square[:, None] * nodes**2) / a**2
            flat = flat + np.sqrt(square) / pi * (
                chebyshev.chebval(2.0 * place - 1.0, bend) @ weights
            )
        return np.asarray(self.E_star * flat)

    @cached_property
    def _bend(self) -> tuple[Array, Array, Array]:
        """(Chebyshev series of e'(x)/x, Gauss nodes, weights) for the pressure from other spots.
        e(x) is the effect of the other spots on the transformed displacement of this spot.

        The series is in x^2/a^2, with a the radius of the spot. Nodes and weights are those for the
        integral over s from 0 to 1 at the head of this module.

        The nearest singularity of e'(x)/x is at `rim`, where the neighbours begin. So the
        coefficients fall like (rim + sqrt(rim^2 - 1))^(-degree), to round-off at the chosen degree.
        """
        rim = 2.0 * (self.reach / self.radius) ** 2 - 1.0
        needed = 8 + int(-log(EPS) / log(rim + sqrt(rim**2 - 1.0)))
        degree = min(SERIES.degrees[-1], needed)

        def bend(z: Array) -> Array:
            x = self.radius * np.sqrt(0.5 * (1.0 + z))
            return self.surface.kept_slope(x) / x

        nodes, weights = np.polynomial.legendre.leggauss(degree + 1)
        return (
            np.asarray(chebyshev.chebinterpolate(bend, degree)),  # type: ignore[type-var]
            0.5 * (1.0 + nodes),
            0.5 * weights,
        )

    @property
    def max_pressure(self) -> float:
        """Largest pressure [Pa].
        It is inf if the spot contains a pointed tip or an edge (a jump of the profile's slope).
        """
        if self.profile.pointed(self.radius) or self.profile.edges(self.radius):
            return inf
        return -least_value(lambda r: -self.pressure(r), 0.0, self.radius, 129)

    def gap(self, r: ArrayLike) -> Array:
        """Gap g(r) [m] as a mean over the angle.
        It is 0 in the spot and defined for radii r up to `reach`, where the nearest neighbouring
        spot begins.
        """
        r = np.abs(finite_array("r", r, None))
        if np.any(r > self.reach):
            raise SceneError.of(
                "r",
                float(np.max(r)),
                f"at most {self.reach:.17g}, the radius at which the neighbours begin",
            )
        return _where(r > self.radius, r, self._gap)

    def _gap(self, r: Array) -> Array:
        breaks = [np.arcsin(np.clip(b / r, self.radius / r, 1.0)) for b in self.profile.breakpoints]
        phi, weight = panels([np.arcsin(self.radius / r), *breaks, np.full_like(r, 0.5 * pi)])
        x = np.minimum(r[:, None] * np.sin(phi), self.reach)
        above = self.profile.line(x) + self.surface.value(x) - (self.approach - self.depth)
        return np.asarray(2.0 / pi * np.sum(weight * above, axis=-1))

    def displacement(self, r: ArrayLike) -> Array:
        """Displacement of the surface into the body [m], averaged over the angle.

        It is measured from its mean over the surface; for a spot alone, from infinity.
        """
        r = np.abs(finite_array("r", r, None))
        return self.approach - self.depth - self.profile.height(r) + self.gap(r)

    def balance(self) -> float:
        """Relative error of the load balance: (integral of the pressure) / load - 1.

        It checks the transforms against each other.
        """
        nodes, weights = panels(
            [0.0, *np.minimum(self.profile.breakpoints, self.radius), self.radius]
        )
        pressure = self.pressure(nodes)
        known = np.isfinite(pressure)  # a node exactly on an edge has a negligible weight
        return float(2.0 * pi * np.sum((weights * nodes * pressure)[known]) / self.load) - 1.0

    def check(self) -> None:
        """Raise OutOfRange if contact is not one full circle.

        That is so if the pressure in the spot, or the gap around the spot, is negative somewhere.
        """
        count = _OPTIONS.samples
        angle = (np.arange(count) + 0.5) * (0.5 * pi / count)
        least = float(np.min(self.pressure(self.radius * np.cos(angle))))
        if least < -ROUND_OFF * self.mean_pressure:
            raise OutOfRange(
                "contact is not a full circle: inside the circle the pressure would be negative, "
                f"down to {quantity(least, 'Pa', 6)}"
            )
        # The gap is checked from the edge of this spot halfway to the edge of the nearest spot. The
        # checks of the neighbouring spots cover the other half.
        end = 3.0 * self.radius if isinf(self.reach) else 0.5 * (self.reach + self.radius)
        r = np.linspace(self.radius, end, count + 1)[1:]
        gap = self.gap(r)
        if np.min(gap) < -ROUND_OFF * float(np.max(np.abs(self.profile.height(r)))):
            at = int(np.argmin(gap))
            raise OutOfRange(
                "contact is not one circle: outside the circle the surfaces would meet again at "
                f"r = {quantity(float(r[at]), 'm', 6)}"
            )


def _where(chosen: Mask, r: Array, function: Callable[[Array], Array]) -> Array:
    """Values of a function at the chosen radii, evaluated in blocks; 0 at all other radii."""
    total, some, block = np.zeros(r.shape), r[chosen], _OPTIONS.block
    if some.size:
        total[chosen] = np.concatenate(
            [function(some[k : k + block]) for k in range(0, some.size, block)]
        )
    return total
