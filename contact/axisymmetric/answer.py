r"""A solved spot: pressure, gap and displacement from the Abel transforms, and what was checked.

    p(r)   = E* p_f(r) + sum (2 N P/pi) arctan(sqrt(a^2 - r^2)/sqrt(A^2 - a^2))
             + (E*/pi) sqrt(a^2 - r^2) int_0^1 (e'(x)/x) ds,   x^2 = r^2 + (a^2 - r^2) s^2
    gap(r) = (2/pi) int_a^r [g(x) + d + e(x) - sum (2 N P/E*) sqrt(A^2 - x^2) - delta] dx / sqrt(r^2
    - x^2)

p_f the profile's own, e and A as in `system`. All is the mean over the angle; displacements count
from the mean plane.
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
from contact.axisymmetric.profiles import AxisymmetricProfile
from contact.axisymmetric.quadrature import panels
from contact.axisymmetric.system import Surface
from contact.errors import OutOfRange, SceneError
from contact.model.checks import finite_array
from contact.reference.exact.numerics import least_value
from sie import Array, Mask

_ROWS = 64  # radii taken together: bounds the memory of a field
_SAMPLES = 48
_TENSION = 1e-9  # relative to the mean pressure, or to the height met: rounding of the checks below


@dataclass(frozen=True)
class Spot(sie.Kept):
    """One solved round spot of contact and its surroundings, as `solve_spot` and `solve_levels`
    give it.

    Equations: the head of this module. `error` bounds the relative error of load, radius and
    pressure (to the mean pressure of the spot) as a solution of the equations of its model; it does
    not know the model's own.

    Parameters
    ----------
    profile : AxisymmetricProfile
        The shape.
    E_star : float
        Reduced modulus [Pa].
    radius : float
        Radius a of the spot [m].
    load : float
        P of the spot [N].
    depth : float
        How far its tip stands below the highest ones [m].
    approach : float
        By how much the body has come down from first touch, to the mean plane of the surface
        (alone: to the surface at infinity) [m].
    density : float
        Such spots per unit area [1/m^2]; 0 for a spot alone.
    rings : float
        Rings of neighbours kept in their places, up to inf.
    surface : Surface
        What the other spots do to this one.
    reach : float
        Where the neighbours begin [m]; inf for a spot alone.
    error : float
        Bound of the relative error.

    Attributes
    ----------
    nominal_pressure, contact_fraction : float or None
        Load and area of contact over the area [Pa, 1]; None for a spot alone.
    mean_pressure, max_pressure : float
        Over the spot, and its peak [Pa]; inf under a point or an edge.
    circle : float
        A = (pi N)^(-1/2), the circle whose area is a spot's share [m]; inf for a spot alone.
    pressure, gap, displacement : callable
        p [Pa], gap [m] and u [m] at radii r [m] of any shape, in the mean over the angle; the last
        two up to `reach`.
    balance : callable
        int p dA over the load, less one.

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
    >>> bool(np.isclose(spot.max_pressure / spot.mean_pressure, 1.5)), bool(np.isclose(spot.approach, spot.radius**2 / 1e-3))
    (True, True)
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

    @property
    def nominal_pressure(self) -> float | None:
        """Load times density [Pa]; None for a spot alone."""
        return self.load * self.density if self.density > 0 else None

    @property
    def mean_pressure(self) -> float:
        """Load over the area of the spot [Pa]."""
        return self.load / (pi * self.radius**2)

    @property
    def contact_fraction(self) -> float | None:
        """Area of contact over area; None for a spot alone."""
        return pi * self.radius**2 * self.density if self.density > 0 else None

    @property
    def circle(self) -> float:
        """A = (pi N)^(-1/2) [m], the circle whose area is a spot's share; inf for a spot alone."""
        return own_radius(self.density) if self.density > 0 else inf

    def pressure(self, r: ArrayLike) -> Array:
        """p(r) [Pa], 0 outside the spot."""
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
        """e'(x)/x as Chebyshev series in x^2/a^2, its degree set by the neighbours' rim, where it
        is singular; and Gauss's rule for it.
        """
        rim = 2.0 * (self.reach / self.radius) ** 2 - 1.0
        degree = min(400, 8 + int(36.0 / log(rim + sqrt(rim**2 - 1.0))))

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
        """Peak pressure [Pa]; inf under a point or an edge."""
        if self.profile.pointed(self.radius) or self.profile.edges(self.radius):
            return inf
        return -least_value(lambda r: -self.pressure(r), 0.0, self.radius, 129)

    def gap(self, r: ArrayLike) -> Array:
        """Mean over the angle of the gap [m], 0 in the spot, up to `reach`, where the neighbours
        begin.
        """
        r = np.abs(finite_array("r", r, None))
        if np.any(r > self.reach):
            raise SceneError.of(
                "r", float(np.max(r)), f"at most {self.reach:.17g}: there the neighbours begin"
            )
        return _where(r > self.radius, r, self._gap)

    def _gap(self, r: Array) -> Array:
        breaks = [np.arcsin(np.clip(b / r, self.radius / r, 1.0)) for b in self.profile.breakpoints]
        phi, weight = panels([np.arcsin(self.radius / r), *breaks, np.full_like(r, 0.5 * pi)])
        x = np.minimum(r[:, None] * np.sin(phi), self.reach)
        above = self.profile.line(x) + self.surface.value(x) - (self.approach - self.depth)
        return np.asarray(2.0 / pi * np.sum(weight * above, axis=-1))

    def displacement(self, r: ArrayLike) -> Array:
        """Mean over the angle of the displacement into the body [m], from its mean (alone: from
        that at infinity).
        """
        r = np.abs(finite_array("r", r, None))
        return self.approach - self.depth - self.profile.height(r) + self.gap(r)

    def balance(self) -> float:
        """int p dA over the load, less one: the transforms against one another."""
        nodes, weights = panels(
            [0.0, *np.minimum(self.profile.breakpoints, self.radius), self.radius]
        )
        pressure = self.pressure(nodes)
        known = np.isfinite(pressure)  # a node on an edge itself has no weight
        return float(2.0 * pi * np.sum((weights * nodes * pressure)[known]) / self.load) - 1.0

    def check(self) -> None:
        """OutOfRange if contact is not one full circle: tension in it, or another contact around
        it.
        """
        angle = (np.arange(_SAMPLES) + 0.5) * (0.5 * pi / _SAMPLES)
        least = float(np.min(self.pressure(self.radius * np.cos(angle))))
        if least < -_TENSION * self.mean_pressure:
            raise OutOfRange(
                f"contact is not a full circle: the pressure would fall to {least:.6g} Pa in the spot"
            )
        # Beyond half the way to the neighbours stands their share of the surface.
        end = 3.0 * self.radius if isinf(self.reach) else 0.5 * (self.reach + self.radius)
        r = np.linspace(self.radius, end, _SAMPLES + 1)[1:]
        gap = self.gap(r)
        if np.min(gap) < -_TENSION * float(np.max(np.abs(self.profile.height(r)))):
            at = int(np.argmin(gap))
            raise OutOfRange(
                f"contact is not one circle: the surfaces would meet again at r = {r[at]:.6g} m"
            )


def _where(chosen: Mask, r: Array, function: Callable[[Array], Array]) -> Array:
    """A function at the radii chosen, so many at a time; 0 at the others."""
    total, some = np.zeros(r.shape), r[chosen]
    if some.size:
        total[chosen] = np.concatenate(
            [function(some[k : k + _ROWS]) for k in range(0, some.size, _ROWS)]
        )
    return total
