"""Jumps of the right side inside zones, for an equation with kappa: densities in closed form.

If g, or its derivative of the order k, jumps by J at a place s of a zone, the density contains
J w^k / k! (t - s)^k J_s, with the half width w and J_s of `sie.basis.power_jump`.
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import Array, Complex, record
from sie.basis.interval import InPlane, Outside, complex_of
from sie.basis.power_jump import PowerJump
from sie.basis.weighted import Weighted
from sie.basis.zones import Zones
from sie.equation.forcing import Forcing

Number = NDArray[Any]


@record
class KnownJumps:
    """The jumps of g, or of its derivative of one order k, on one zone.

    x: their places; closed: their closed forms; factors: J w^k / k! (see the head of this module).
    """

    zone: int
    order: int
    x: Array
    closed: PowerJump
    factors: Array

    def _away(self, left: Array, right: Array) -> Array:
        """t - s at points t (P,) given by 1 + t and 1 - t, for all places s (P, places)."""
        from_left = left[:, None] - self.closed.left
        from_right = self.closed.right - right[:, None]
        return np.where((left < right)[:, None], from_left, from_right)

    def density(self, left: Array, right: Array) -> Array:
        """The density at points (P,) of the zone, given by 1 + t and 1 - t."""
        away = self._away(left, right)
        return self.closed.density(left[:, None], right[:, None], away, self.order) @ self.factors

    def own(self, left: Array, right: Array) -> Array:
        """kappa phi + T phi of the density at points (P,) of the zone."""
        return self.closed.own(self._away(left, right), self.order) @ self.factors

    def integral_to(self, left: Array, right: Array) -> Array:
        """Integral of the density from the left end to points (P,) of the zone, divided by w."""
        away = self._away(left, right)
        values = self.closed.integral_to(left[:, None], right[:, None], away, self.order)
        return np.asarray(values @ self.factors)

    def transform(self, points: Outside) -> Array:
        """Transform of the density at real points off the zone, of any shape."""
        at = Outside(np.asarray(points.sign)[..., None], points.excess[..., None])
        return np.asarray(self.closed.transform(at, order=self.order) @ self.factors)

    def in_plane(self, points: InPlane, what: tuple[Array, Array, bool]) -> Complex:
        """Transform, or its slope by zeta, at complex points (P,).

        what: ((x - s) / w for points and jumps (P, places), y / w, whether the slope is wanted).
        """
        x, y, is_slope = what
        away = complex_of(x, y[:, None])
        at = InPlane(points.left[:, None], points.less[:, None])
        of = self.closed.slope if is_slope else self.closed.transform
        return np.asarray(of(at, away, self.order) @ self.factors)

    @property
    def total(self) -> float:
        """Integral of the density over the zone, divided by the half width."""
        return float(self.closed.powers(self.order + 1)[-1] @ self.factors)

    def edge_slopes(self) -> tuple[float, float]:
        """Edge slopes A at the left and the right end, for the half width 1."""
        left, right = self.closed.edge_slopes(self.order)
        return float(left @ self.factors), float(right @ self.factors)

    def moments(self, length: int) -> Array:
        """Chebyshev coefficients of the density as seen from outside, see `Weighted.moments`."""
        return np.asarray(self.factors @ self.closed.moments(length, self.order))


def jumps_inside(forcing: Forcing, zones: Zones) -> tuple[KnownJumps, ...]:
    """The jumps of the right side inside the zones; ValueError for kinds that are not known."""
    jumps = forcing.jumps
    if not np.any((zones.a[:, None] < jumps.broken_at) & (jumps.broken_at < zones.b[:, None])):
        return ()
    if jumps.of_density or jumps.spline is not None or jumps.algebraic is not None:
        raise ValueError(
            "of an equation with kappa the right side may have jumps of itself and of its "
            "derivatives inside zones, but neither splines, algebraic points nor jumps of the "
            "density"
        )
    return tuple(_inside(forcing, zones))


def _inside(forcing: Forcing, zones: Zones) -> Iterator[KnownJumps]:
    at, heights, orders = forcing.jumps.at, forcing.jumps.heights, np.asarray(forcing.jumps.orders)
    kappa = zones.weight.kappa
    assert kappa is not None
    for zone, w in enumerate(zones.half.tolist()):
        index = np.full(len(at), zone)
        left, right = zones.beyond_a(at, index) / w, zones.before_b(at, index) / w
        for order in sorted(set(orders.tolist())):
            here = (left > 0) & (right > 0) & (orders == order)
            if here.any():
                closed = PowerJump(Weighted(float(kappa[zone])), left[here], right[here])
                factors = heights[here] * w**order / math.factorial(order)
                yield KnownJumps(zone, order, at[here], closed, factors)
