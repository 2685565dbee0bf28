r"""Places of the largest equivalent stress in the body, and derivatives of it there.

The derivative of the largest stress is that of the stress at a fixed place, since a motion of the
maximum changes nothing at first order (the envelope theorem). The derivative p' of the pressure
causes stresses xx, yy and xy at this place. The derivative of the equivalent stress is the sum of
these three, each times the derivative of the equivalent stress by this component. First yield is at
the load P at which the largest stress s equals the strength Y. At a fixed load, a change of the
scene changes s by s', and a unit of load by s_P, so that

    P' = -s' / s_P,    dP / dY = 1 / s_P.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev

import sie
from contact.derivatives.places import Window
from contact.derivatives.rates import Rate
from contact.errors import SceneError
from contact.formulation.protocol import Fields
from contact.formulation.quadrature import chebyshev_nodes
from contact.formulation.tolerances import TOLERANCES
from contact.inside.field import exact_stress
from contact.inside.largest import Criterion, peaks
from contact.inside.stress import Stress, Transform, stress_from
from contact.inside.yielding import infinite_at
from contact.solution.solution import Solution
from sie import Array, record

# Number of nodes along each side of the square in which a place is corrected by a polynomial. The
# stresses are analytic at distances from the place below its depth y. So in a square of the half
# width y / SHARE, the coefficients fall like (2 SHARE)^-n: with 16^-12 they end at round-off.
NODES = 13
SHARE = 8.0


@record
class StressPoint:
    """A point [m] of the largest equivalent stress, and the value [Pa] of this stress.
    `slopes` are its derivatives by the stress components xx, yy and xy at the point.

    transform: factors (A, B). At a given load, Re(A F + B F') is the derivative of the largest
    stress, with the transform F of p' at the point and the derivative F' of F.
    """

    x: float
    y: float
    stress: float
    slopes: Array
    branch: int
    transform: tuple[complex, complex]


class LargestStress(sie.Kept):
    """The points of the largest equivalent stress of one solution.

    Parameters
    ----------
    solution : Solution
        The solution.
    criterion : Criterion
        The criterion of the equivalent stress.
    yield_error : float
        Relative error of the load of first yield, if the solution is under this load.
    local : bool
        Whether all local maxima that the search finds count, also those below the largest.
    """

    def __init__(
        self,
        solution: Solution,
        criterion: Criterion,
        yield_error: float = 0.0,
        local: bool = False,
    ) -> None:
        self.solution, self.criterion, self.yield_error = solution, criterion, yield_error
        self.local = local
        if infinite_at(solution) is not None:
            raise SceneError(
                "the stress is infinite at a sharp corner or tip, or at the end of an adhesive "
                "zone: the largest stress has no derivatives",
                "solution",
            )

    @cached_property
    def points(self) -> tuple[StressPoint, ...]:
        """The points at which the equivalent stress is largest, the largest stress first.

        They are several if their stresses are equal, or if local maxima count.
        """
        solution = self.solution
        found = sorted(peaks(solution, self.criterion), key=lambda one: -one.stress)
        # The search finds a point to within a step of 1e-4. Since the stress is stationary at the
        # point, the relative error of the stress is below the square of this step.
        least = -np.inf if self.local else found[0].stress * (1 - 1e-6)
        points: list[StressPoint] = []
        for one in found:
            if one.stress < least:
                break
            new = self._settled(solution.fields, one.x, one.y)
            if not any(self._same(new, other) for other in points):
                points.append(new)
        points.sort(key=lambda one: -one.stress)
        if self.local:
            return tuple(points)
        best = points[0].stress
        slack = TOLERANCES.margin * max(TOLERANCES.rounding, solution.error)
        return tuple(one for one in points if one.stress >= best * (1 - slack))

    def _same(self, one: StressPoint, other: StressPoint) -> bool:
        away, period = one.x - other.x, self.solution.scene.period
        if period is not None:
            away -= period * round(away / period)
        size = max(one.y, other.y) or self._window.size(one.x)
        return max(abs(away), abs(one.y - other.y)) <= 0.5 * size

    @property
    def values(self) -> Array:
        """The largest stress at each of its places [Pa]."""
        return np.array([one.stress for one in self.points])

    def on(self, fields: Fields) -> tuple[StressPoint, ...]:
        """The points of the largest stress in `fields`, close to those of the solution."""
        if fields is self.solution.fields:
            return self.points
        return tuple(self._settled(fields, one.x, one.y) for one in self.points)

    def rates(self, fields: Fields, rate: Rate) -> Array:
        """Derivatives of the largest stress by the parameter of `rate`, one for each of `points`.
        They are taken at the points that `on` finds for `fields`.
        """
        if rate.fields is None:
            return np.full(len(self.points), np.nan)
        points = self.on(fields)
        x, y = np.array([[one.x, one.y] for one in points]).T
        found, _ = exact_stress(rate.fields, x, y, self.criterion.lateral, self.criterion.nu)
        changes = np.array([found.xx, found.yy, found.xy])
        return np.array([one.slopes @ changes[:, k] for k, one in enumerate(points)])

    @cached_property
    def by_shear(self) -> Array:
        """Derivatives of the largest stress by the ratio of shear to pressure."""
        out = []
        for one in self.points:
            normal = self._stress(self.solution.fields, one.x, one.y)[1]
            none = np.zeros(1, dtype=complex)
            found = stress_from(np.array([one.y]), (none, none), normal)
            out.append(one.slopes @ np.array([found.xx[0], found.yy[0], found.xy[0]]))
        return np.array(out)

    @cached_property
    def by_nu(self) -> Array:
        """Derivatives of the largest stress by Poisson's ratio, at given pressures."""
        rule, deep = self.criterion, self.solution.fields.deep_pressure
        along = -deep / (1 - rule.nu) ** 2 if rule.lateral == "confined" else 0.0
        out = []
        for one in self.points:
            found, _ = self._stress(self.solution.fields, one.x, one.y)
            mean = 0.5 * float(found.xx + found.yy)
            if rule.name == "mises":
                own = -2 * (1 - 2 * rule.nu) * mean**2 / one.stress
            else:
                own = -abs(mean) * one.branch
            out.append(own + one.slopes[0] * along)
        return np.array(out)

    def _settled(self, fields: Fields, x: float, y: float) -> StressPoint:
        """The point near (x, y) at which the equivalent stress is stationary.
        A point on the surface stays on the surface.
        """
        branch = self._branch(fields, x, y)
        if y > 0:
            x, y = _stationary(lambda a, b: self._value(fields, a, b, branch), x, y)
        else:
            self._refuse_ends(fields, x)
            x = self._window.corrected(
                lambda at: self._value(fields, at, np.zeros(len(at)), branch), x
            )
        return self._point(fields, x, y, branch)

    def _branch(self, fields: Fields, x: float, y: float) -> int:
        return self.criterion.branch(self._stress(fields, x, y)[0])

    def _value(self, fields: Fields, x: Array, y: Array, branch: int) -> Array:
        rule = self.criterion
        return rule.of_branch(exact_stress(fields, x, y, rule.lateral, rule.nu)[0], branch)

    def _stress(self, fields: Fields, x: float, y: float) -> tuple[Stress, Transform]:
        """(stress, transform of the pressure) at one point (x, y) of the body."""
        rule = self.criterion
        found, normal = exact_stress(fields, np.array([x]), np.array([y]), rule.lateral, rule.nu)
        return Stress(found.xx[0], found.yy[0], found.xy[0], np.zeros(())), normal

    def _point(self, fields: Fields, x: float, y: float, branch: int) -> StressPoint:
        found, _ = self._stress(fields, x, y)
        slopes = self.criterion.slopes(found, branch)
        value = float(self.criterion.of_branch(found, branch))
        return StressPoint(x, y, value, slopes, branch, _factors(slopes, y, self._ratio))

    @property
    def _ratio(self) -> float:
        return float(self.solution.scene.law.shear_ratio)

    @cached_property
    def _window(self) -> Window:
        return Window.of(self.solution)

    def _refuse_ends(self, fields: Fields, x: float) -> None:
        """Raise SceneError if a point of the surface is at a zone's end or outside all zones."""
        zones = fields.zone_table
        if len(zones) == 0:
            return
        length = self.solution.scene.period
        middle, half = zones.mean(axis=1), 0.5 * np.diff(zones, axis=1)[:, 0]
        away = x - middle
        if length is not None:
            away = away - length * np.round(away / length)
        # The search finds a point to within 1e-4 of the half width.
        if np.all(np.abs(away) > half * (1 - 1e-3)):
            raise SceneError(
                f"the largest stress is on the surface, at the end x = {x:.6g} m of a zone. "
                "Derivatives are not available there, since that of the pressure is infinite: use "
                "finite differences of solutions",
                "solution",
            )


def _factors(slopes: Array, y: float, ratio: float) -> tuple[complex, complex]:
    """(A, B) such that Re(A F + B F') is the sum of the slopes times the stresses under a pressure.
    F is the transform of the pressure at the point, and F' its derivative.

    See `contact.inside.stress`; the shear is `ratio` times the pressure.
    """
    xx, yy, xy = slopes.tolist()
    value = complex(-2 * ratio * xx, -(xx + yy + ratio * xy))
    rise = complex(xx - yy + ratio * xy, xy - ratio * (xx - yy))
    return value, y * rise


def _stationary(
    function: Callable[[Array, Array], Array], x: float, y: float, max_steps: int = 8
) -> tuple[float, float]:
    """The place near (x, y), y > 0, at which the gradient of an analytic function vanishes."""
    t = chebyshev_nodes(NODES)
    half, degree = y / SHARE, NODES - 1
    across, down = (part.ravel() for part in np.meshgrid(t, t, indexing="ij"))
    value = function(x + half * across, y + half * down).reshape(NODES, NODES)
    # Interpolation at Chebyshev nodes, along both sides of the square.
    of = chebyshev.chebvander(t, degree).T * (2 / NODES)
    of[0] *= 0.5
    series = of @ value @ of.T

    def at(place: Array, across: int, down: int) -> float:
        """Derivative of the series, of orders `across` and `down` in its two variables."""
        table = chebyshev.chebder(chebyshev.chebder(series, across, axis=0), down, axis=1)
        return float(chebyshev.chebval2d(float(place[0]), float(place[1]), table))

    place = np.zeros(2)
    for _ in range(max_steps):
        rise = np.array([at(place, 1, 0), at(place, 0, 1)])
        mixed = at(place, 1, 1)
        bend = np.array([[at(place, 2, 0), mixed], [mixed, at(place, 0, 2)]])
        place = place - np.linalg.lstsq(bend, rise, rcond=None)[0]
        if np.abs(place).max() > 1:
            return x, y
    return x + half * float(place[0]), y + half * float(place[1])
