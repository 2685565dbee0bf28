"""Closed-form parts of the density for an equation with kappa: jumps of g, values at ends.

If the right side g, or its derivative of the order k, jumps by J inside a zone, the density
contains

    J w^k / k! (t - s)^k J_s.

w is the half width, and t and s are the positions of a point and of the jump, scaled to -1 ... 1.
`sie.basis.power_jump` gives the density J_s. If the density has a prescribed value v at an end, it
contains v times the density of `sie.basis.value_mode`.
"""

import math
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import Array, Complex, Kept, record, wrapped
from sie.basis.interval import InPlane, Outside, complex_of
from sie.basis.power_jump import (
    FAR_TERMS,
    OPTIONS,
    PowerJump,
    rho_of,
    series,
    series_potential,
    series_slope,
)
from sie.basis.value_mode import ValueMode
from sie.basis.weighted import JacobiFunctions, from_ends
from sie.basis.zones import Zones
from sie.equation.forcing import Forcing

Number = NDArray[Any]


@record
class KnownJumps(Kept):
    """Jumps, on one zone, of the right side g or of its derivative of the order k = `order`.

    x: their places; closed: their closed forms; factors: J w^k / k! (see the head of this module).
    Far from the zone, all jumps of the zone together are one series of Chebyshev moments.
    """

    zone: int
    order: int
    x: Array
    closed: PowerJump
    factors: Array

    def _away(self, left: Array, right: Array) -> Array:
        """Differences t - s (P, jumps) of points t (P,) and the positions s of all jumps.
        The points are given by 1 + t and 1 - t.
        """
        from_left = left[:, None] - self.closed.left
        from_right = self.closed.right - right[:, None]
        return np.where((left < right)[:, None], from_left, from_right)

    def density(self, left: Array, right: Array) -> Array:
        """The density at points (P,) of the zone, given by 1 + t and 1 - t."""
        away = self._away(left, right)
        return self.closed.density(left[:, None], right[:, None], away, self.order) @ self.factors

    def own(self, left: Array, right: Array) -> Array:
        """The value of kappa phi + T phi at points (P,) of the zone.
        phi is the density that the jumps cause, and T phi its transform.
        """
        return self.closed.own(self._away(left, right), self.order) @ self.factors

    @cached_property
    def _by_parts(self) -> Array:
        """Coefficients of the S_n that integration by parts leaves, summed over all jumps.
        The integral of the density from the left end is a closed form plus an integral of sum c_n
        S_n, with S_n = weight * polynomial (`sie.basis.weighted`).
        """
        return self.closed.by_parts(self.order) @ self.factors

    def integral_to(self, left: Array, right: Array) -> Array:
        """Integral of the density from the left end to points (P,) of the zone.

        It is divided by the half width. Integration by parts gives it, see `sie.basis.power_jump`.
        """
        away = self._away(left, right)
        edge = self.closed.density(left[:, None], right[:, None], away, self.order) * away
        rest = self.closed.weighted.integral_to(self._by_parts, left, right)
        return np.asarray((np.where(away == 0, 0.0, edge) @ self.factors + rest) / (1 + self.order))

    def own_level(self, left: Array, right: Array) -> Array:
        """Potential of the density phi, plus kappa times the integral of phi, divided by w.
        This sum, at points on the zone of half width w, is a primitive of kappa phi + T phi.
        """
        higher = self.closed.own(self._away(left, right), self.order + 1) @ self.factors
        rest = self.closed.weighted.own_level(self._by_parts, left, right)
        return np.asarray((higher + rest) / (1 + self.order))

    def transform(self, points: Outside) -> Array:
        """Transform of the density at real points off the zone, of any shape."""
        return self._off_zone(points, lambda at: self._near_transform(at, self.order), series)

    def potential(self, points: Outside) -> Array:
        """Potential of the density, divided by the half width w, at real points off the zone."""

        def near(at: Outside) -> Array:
            rest = self.closed.weighted.potential_of(self._by_parts, at)
            return np.asarray((self._near_transform(at, self.order + 1) + rest) / (1 + self.order))

        return self._off_zone(points, near, series_potential)

    def _off_zone(
        self,
        points: Outside,
        near: Callable[[Outside], Array],
        far: Callable[[Array, Array, Array], Array],
    ) -> Array:
        """A field at points off the zone, by the function `near`, far away by the series `far`."""
        sign, excess = np.broadcast_arrays(np.asarray(points.sign), points.excess)
        left, less = from_ends(Outside(sign, excess))
        is_far = np.abs(rho_of(left, less)) < OPTIONS.far
        out = np.empty(excess.shape)
        if is_far.any():
            out[is_far] = far(self._moments, left[is_far], less[is_far])
        if not is_far.all():
            out[~is_far] = near(Outside(sign[~is_far], excess[~is_far]))
        return out

    def _near_transform(self, points: Outside, order: int) -> Array:
        """Transform, at points (P,) off the zone, of the sum over jumps of (t - s)^order J_s.
        J_s is the density of a jump at s; each term has its factor in `factors`.
        """
        at = Outside(np.asarray(points.sign)[..., None], points.excess[..., None])
        return np.asarray(self.closed.transform(at, order=order) @ self.factors)

    @cached_property
    def _moments(self) -> Array:
        """Chebyshev moments of the density, for `series`, which gives its field far away."""
        return self.moments(FAR_TERMS)

    def in_plane(self, points: InPlane, what: tuple[Array, Array, bool]) -> Complex:
        """Transform of the density, or its derivative by zeta, at complex points (P,).

        what: ((x - s) / w for points and jumps (P, jumps), y / w, whether the slope is wanted), for
        points x + iy, jumps at s and the half width w.
        """
        x, y, is_slope = what
        is_far = np.abs(rho_of(points.left, points.less)) < OPTIONS.far
        out, near = np.empty(points.less.shape, dtype=complex), ~is_far
        far = series_slope if is_slope else series
        out[is_far] = far(self._moments, points.left[is_far], points.less[is_far])
        away = complex_of(x[near], y[near, None])
        at = InPlane(points.left[near, None], points.less[near, None])
        of = self.closed.slope if is_slope else self.closed.transform
        out[near] = of(at, away, self.order) @ self.factors
        return out

    @cached_property
    def total(self) -> float:
        """Integral of the density over the zone, divided by the half width."""
        return float(self.closed.powers(self.order + 1)[-1] @ self.factors)

    def edge_slopes(self) -> tuple[float, float]:
        """Edge slopes A of the density at the left and the right end, for the half width 1.
        A is the coefficient of distance^(1 - p), with the exponent p of the end.
        """
        left, right = self.closed.edge_slopes(self.order)
        return float(left @ self.factors), float(right @ self.factors)

    def moments(self, length: int) -> Array:
        """Chebyshev moments of the density, which give its field outside the zone.
        See `JacobiFunctions.moments`.
        """
        return np.asarray(self.factors @ self.closed.moments(length, self.order))


_NO_POTENTIAL = "with kappa the potential is not known if the density has given values at ends"


@record
class KnownValue:
    """The closed-form part of the density due to its prescribed value at one end of a zone.

    It has the methods of `KnownJumps`. x: the end.
    """

    zone: int
    x: Array
    value: float
    closed: ValueMode

    def density(self, left: Array, right: Array) -> Array:
        return self.value * self.closed.density(left, right)

    def own(self, left: Array, right: Array) -> Array:
        return self.value * self.closed.own(left, right)

    def integral_to(self, left: Array, right: Array) -> Array:
        return self.value * self.closed.integral_to(left, right)

    def own_level(self, left: Array, right: Array) -> Array:
        raise ValueError(_NO_POTENTIAL)

    def potential(self, points: Outside) -> Array:
        raise ValueError(_NO_POTENTIAL)

    def transform(self, points: Outside) -> Array:
        return self.value * self.closed.transform(points)

    def in_plane(self, points: InPlane, what: tuple[Array, Array, bool]) -> Complex:
        _, _, is_slope = what
        of = self.closed.slope if is_slope else self.closed.transform
        return np.asarray(self.value * of(points), dtype=complex)

    @property
    def total(self) -> float:
        return self.value * self.closed.total

    def edge_slopes(self) -> tuple[float, float]:
        left, right = self.closed.edge_slopes()
        return self.value * left, self.value * right

    def moments(self, length: int) -> Array:
        return self.value * self.closed.moments(length)


Known = KnownJumps | KnownValue


def known_parts(forcing: Forcing, zones: Zones, period: float | None = None) -> tuple[Known, ...]:
    """The closed-form parts of the density; ValueError for jumps that have no closed form.

    period: period of the kernel, with which the jumps repeat; None if there is no period.
    """
    values = _values(zones) if zones.have_values else ()
    return (*_jumps_inside(forcing, zones, period), *values)


def _values(zones: Zones) -> Iterator[KnownValue]:
    kappa, values, ends = zones.weight.kappa, zones.values, np.array([zones.a, zones.b])
    assert kappa is not None
    for side, zone in np.argwhere(values != 0.0).tolist():
        closed = ValueMode(JacobiFunctions(float(kappa[zone])), at_left=side == 0)
        yield KnownValue(zone, ends[side, [zone]], float(values[side, zone]), closed)


def _jumps_inside(forcing: Forcing, zones: Zones, period: float | None) -> tuple[KnownJumps, ...]:
    """The jumps of the right side inside the zones; ValueError for those without a closed form."""
    jumps = forcing.jumps
    broken = wrapped(jumps.broken_at, float(zones.a[0]), period)
    zone = np.searchsorted(zones.a, broken, side="right") - 1
    if not np.any((zone >= 0) & (broken < zones.b[zone])):
        return ()
    if zones.weight.is_complex:
        raise ValueError("with a complex kappa the right side must be smooth inside zones")
    if jumps.of_density or jumps.spline is not None or jumps.algebraic is not None:
        raise ValueError(
            "with kappa, if a jump lies inside a zone, sie.Jumps may have only jumps of the right "
            "side and its derivatives: leave out spline, algebraic and of_density"
        )
    return tuple(_inside(forcing, zones, period))


def _inside(forcing: Forcing, zones: Zones, period: float | None) -> Iterator[KnownJumps]:
    heights, orders = forcing.jumps.heights, np.asarray(forcing.jumps.orders)
    at = wrapped(forcing.jumps.at, float(zones.a[0]), period)
    kappa = zones.weight.kappa
    assert kappa is not None
    for zone, w in enumerate(zones.half.tolist()):
        index = np.full(len(at), zone)
        left, right = zones.beyond_a(at, index) / w, zones.before_b(at, index) / w
        for order in sorted(set(orders.tolist())):
            here = (left > 0) & (right > 0) & (orders == order)
            if here.any():
                closed = PowerJump(JacobiFunctions(float(kappa[zone])), left[here], right[here])
                factors = heights[here] * w**order / math.factorial(order)
                yield KnownJumps(zone, order, at[here], closed, factors)
