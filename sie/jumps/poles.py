r"""Algebraic points of the right side as sums of poles.

Close to an algebraic point s the right side g is a smooth function plus

    left (s - x)^p  for x < s,      right (x - s)^p  for x > s,      p > -1.

With y = x - s, the integrals of eta^(p+1) / (y^2 + eta^2) and eta^p y / (y^2 + eta^2) by eta from 0
to infinity are multiples of |y|^p and sgn(y) |y|^p, continued analytically in p. The trapezoidal
rule in log(eta), of step h, gives

    g = Re sum_k c_k / (y - i eta_k),
    c_k = (h/pi) eta_k^(p+1) (cos(pi p/2) (right - left) + i sin(pi p/2) (right + left)),

with an aliasing error of exp(-pi^2/h) relative to |y|^p, for all y (Trefethen, Weideman, SIAM
Rev. 56, 2014, 385-458). Poles with eta above the half width are omitted: their field is smooth on
the zone, so that the Chebyshev series of the zone represents it. The transform on the whole line
maps c_k to i c_k. So a density with such points causes a right side with the coefficients i c_k.

Let t = (x - middle)/w be the position of a point x in half widths w, z the position of a pole, and
rho = z - (z^2 - 1)^(1/2), q = -2 c / (z^2 - 1)^(1/2). For a point off the zone, rho_x is rho with t
in place of z. Let c_0 be the integral of a density divided by pi w. The density that a pole causes,
its transform off the zone, and its potential there, divided by w and without c_0 log(w), are

    Re (q/2) (1 - t^2)^(1/2) / (z - t),     Re q rho rho_x / (1 - rho rho_x),
    Re (q/2) ((rho - 1/rho) log(1 - rho rho_x) - rho_x - rho log(2 |rho_x|)).

On the zone the transform is Re c / (t - z), minus its mean Re q/2.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import cosdg, sindg

from sie.basis.data import DIGITS, Array, Complex, Index, record
from sie.basis.interval import InPlane, OnLine, What, root_weight, theta
from sie.basis.sums import PerZone
from sie.basis.zones import Zones
from sie.jumps.formulas import OPTIONS as JUMPS

# Step of the trapezoidal rule in log(eta), where eta is a pole's distance from the line. The rule's
# relative error is exp(-pi^2/step) = exp(-DIGITS).
_STEP = np.pi * np.pi / DIGITS


@dataclass(frozen=True, eq=False)
class AlgebraicPoints:
    """Points near which the right side, or the wanted density, is a power of the distance.

    Parameters
    ----------
    at : array_like
        Positions s (k,). For a kernel with a period they repeat.
    exponents : array_like
        Exponents p (k,), above -1.
    left, right : array_like
        Coefficients (k,): of (s - x)^p for x < s, and of (x - s)^p for x > s. The rest of the
        function is smooth at s.

    Raises
    ------
    ValueError
        If an exponent is -1 or less.

    Examples
    --------
    A contact of the shape 2|x|^(3/2) / 3, half width 1, bears the load int_-1^1 |x|^(3/2) / sqrt(1
    - x^2) dx.

    >>> import math
    >>> import numpy as np, sie
    >>> points = sie.AlgebraicPoints([0.0], [0.5], [-1.0], [1.0])
    >>> jumps = sie.Jumps(algebraic=points)
    >>> root = sie.Forcing(lambda x: np.sign(x) * np.sqrt(np.abs(x)), jumps=jumps)
    >>> load = math.sqrt(math.pi) * math.gamma(1.25) / math.gamma(1.75)
    >>> equation = sie.Equation(sie.cauchy(), root, (sie.Total(load),))
    >>> sie.solve(equation, sie.Zones.of([[-0.7, 1.2]])).zones.table.round(9).tolist()
    [[-1.0, 1.0]]
    """

    at: ArrayLike
    exponents: ArrayLike
    left: ArrayLike
    right: ArrayLike

    def __post_init__(self) -> None:
        for name in ("at", "exponents", "left", "right"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), dtype=float))
        if np.any(np.asarray(self.exponents) <= -1.0):
            raise ValueError(
                f"exponents of algebraic points must be above -1, got {self.exponents!r}"
            )

    def __len__(self) -> int:
        return len(np.asarray(self.at))

    @cached_property
    def weights(self) -> Complex:
        """For each algebraic point, the common factor of the coefficients of its poles."""
        p, left, right = (np.asarray(part) for part in (self.exponents, self.left, self.right))
        # `cosdg` and `sindg` (angles in degrees) are exactly zero at their zeros. So the weight of
        # a point is exactly zero if its powers left and right of it form one polynomial.
        odd, even = cosdg(90.0 * p) * (right - left), sindg(90.0 * p) * (right + left)
        return np.asarray((odd + 1j * even) / np.pi)

    @cached_property
    def places(self) -> Array:
        """The different positions of the algebraic points, in ascending order."""
        return np.unique(np.asarray(self.at))

    def lowest(self, place: int) -> float:
        """Least exponent p of the powers |x - s|^p at the position s with the index `place`."""
        return float(np.asarray(self.exponents)[self._at(place)].min())

    def poles(self, place: int, farthest: float) -> tuple[Array, Complex]:
        """Poles whose sum represents the powers |x - s|^p of a function at one position s.
        The result is (distances eta of the poles from the line, coefficients c of the poles).

        `place` is the index of the position in `places`. The largest distance is `farthest`. If
        there are several powers |x - s|^p at this position, they share the poles.
        """
        rows = self._at(place)
        p, weights = np.asarray(self.exponents)[rows], self.weights[rows]
        depth = DIGITS / np.minimum(1.0 + p, np.maximum(p, 1.0)).min()
        away = farthest * np.exp(-_STEP * np.arange(int(depth / _STEP) + 1))
        return away, _STEP * (away[:, None] ** (p + 1.0)) @ weights

    def left_out(self, place: int, farthest: float) -> complex:
        """Sum of c / eta over the omitted poles at the position with the index `place`.
        c is the coefficient of a pole and eta its distance from the line. The poles closest to the
        line are omitted.

        The omitted poles matter at the position itself only, and only for small
        exponents. The sum is infinite if an exponent is not positive.
        """
        p = np.asarray(self.exponents)[self._at(place)]
        with np.errstate(divide="ignore", invalid="ignore"):
            nearest = self.poles(place, farthest)[0][-1]
            parts = _STEP * self.weights[self._at(place)] * nearest**p / np.expm1(_STEP * p)
        return complex(parts.sum()) if np.all(p > 0.0) else complex(np.inf, -np.inf)

    def _at(self, place: int) -> Index:
        return np.flatnonzero(np.asarray(self.at) == self.places[place])


@record
class Poles(PerZone):
    """Poles whose sum represents the powers |x - s|^p of the right side in or near zones.

    All lengths are in half widths of the zone. zone: zone of each pole; left, right: distances of
    the point s from the zone's ends; away: distance eta of the pole from the line; size:
    coefficient c of the pole, divided by the half width. points: for each point s inside a zone,
    (zone, distance from the zone's left end, least exponent p, density of the omitted poles at s).
    """

    zone: Index
    left: Array
    right: Array
    away: Array
    size: Complex
    points: tuple[Index, Array, Array, Array]

    @classmethod
    def nothing(cls) -> "Poles":
        none, places = np.zeros(0, np.intp), np.zeros(0)
        return cls(
            none, places, places, places, np.zeros(0, complex), (none, places, places, places)
        )

    @classmethod
    def of(
        cls,
        zones: Zones,
        points: AlgebraicPoints | None,
        period: float | None,
        of_density: bool = False,
    ) -> "Poles":
        """The poles that represent all algebraic points in zones or close to zones.
        Close to an algebraic point, the right side or the density is a power of the distance.

        of_density: whether the points are those of the wanted density, not of the right side.
        """
        if points is None or not np.any(points.weights):
            return NO_POLES
        found, inside = [], []
        for place, i, left, right in _near_positions(zones, points.places, period):
            w = float(zones.half[i])
            away, size = points.poles(place, w)
            more = points.left_out(place, w)
            if of_density:
                size, more = 1j * size, complex(-more.imag, more.real)
            if size.any():
                one = np.ones(len(away))
                found.append((i * one, left / w * one, right / w * one, away / w, size / w))
                if min(left, right) > 0:
                    inside.append((i, left / w, points.lowest(place), more.real))
        if not found:
            return NO_POLES
        table = [np.concatenate(parts) for parts in zip(*found, strict=True)]
        own, at_left, exponent, unseen = np.array(inside, dtype=np.float64).reshape(-1, 4).T
        places = own.astype(np.intp), at_left, exponent, unseen
        return cls(table[0].astype(np.intp), table[1], table[2], table[3], table[4], places)

    @cached_property
    def roots(self) -> tuple[Complex, Complex]:
        """(sqrt(z + 1), sqrt(z - 1)) in the first quadrant for poles z, without cancellation."""
        return np.sqrt(self.left + 1j * self.away), np.sqrt(-self.right + 1j * self.away)

    @cached_property
    def z(self) -> Complex:
        return np.asarray(0.5 * (self.left - self.right) + 1j * self.away)

    @cached_property
    def rho(self) -> Complex:
        p, m = self.roots
        return np.asarray(2.0 / (p + m) ** 2)

    @cached_property
    def q(self) -> Complex:
        p, m = self.roots
        return np.asarray(-2.0 * self.size / (p * m))

    def summed(self, zone: Index, of: Callable[[Index, Index], Array]) -> Array:
        """For each point, a sum of terms over the poles of the zone that contains the point.

        of(points, poles): the real term of each pair of a point and a pole.
        """
        return self.grouped.summed(zone, np.ones(len(self.zone)), of)

    # The methods below give fields of the poles' density at points (n,). A point is given by its
    # zone and by its distances from the zone's ends, in half widths.
    def _past(self, at: Index, k: Index, left: Array, right: Array) -> Complex:
        """The differences t - z of points t and poles z, computed from the end nearer to t."""
        past = np.where(left[at] <= right[at], left[at] - self.left[k], self.right[k] - right[at])
        return np.asarray(past - 1j * self.away[k])

    def own_transform(self, zone: Index, left: Array) -> Array:
        """Transform, on the zone itself, of the density that the zone's poles cause."""

        def part(at: Index, k: Index) -> Array:
            return np.real(
                self.size[k] / (left[at] - self.left[k] - 1j * self.away[k]) - 0.5 * self.q[k]
            )

        return self.summed(zone, part)

    def density(self, zone: Index, left: Array, right: Array) -> Array:
        root = root_weight(np.maximum(left, 0.0), np.maximum(right, 0.0))
        out = root * self.summed(
            zone, lambda at, k: np.real(-0.5 * self.q[k] / self._past(at, k, left, right))
        )
        for own, at, _, more in zip(*self.points, strict=True):
            out[(zone == own) & (left == at)] += more
        return out

    def integral(self, zone: Index, left: Array, right: Array) -> Array:
        """Integral of the poles' density from the zone's left end, divided by the half width."""
        angle, sine = theta(right, left), root_weight(np.maximum(left, 0.0), np.maximum(right, 0.0))
        p, m = self.roots
        tangent = np.sqrt(left / np.maximum(right, 1e-300))

        def part(at: Index, k: Index) -> Array:
            whole = (
                self.z[k] * angle[at]
                - sine[at]
                - 2.0 * p[k] * m[k] * np.arctan(m[k] / p[k] * tangent[at])
            )
            return np.real(0.5 * self.q[k] * whole)

        return self.summed(zone, part)

    def transform(self, zone: Index, rho: Array) -> Array:
        """Transform of the poles' density at points off the zone.

        rho: zeta - sqrt(zeta^2 - 1) of each point, with its coordinate zeta relative to the zone.
        """

        def part(at: Index, k: Index) -> Array:
            both = self.rho[k] * rho[at]
            return np.real(self.q[k] * both / (1.0 - both))

        return self.summed(zone, part)

    def potential_on(self, zone: Index, left: Array, right: Array) -> Array:
        """Potential of the poles' density at points on the zone, divided by the half width w.
        The term c_0 log(w) is left out, with c_0 the integral of the density divided by pi w.
        """
        t = 0.5 * (left - right)

        def part(at: Index, k: Index) -> Array:
            rho = self.rho[k]
            log = np.log(-2.0 * rho * self._past(at, k, left, right))
            return np.real(
                0.5 * self.q[k] * (0.5 * (rho - 1.0 / rho) * log - t[at] - np.log(2) * rho)
            )

        return self.summed(zone, part)

    def potential_off(self, zone: Index, rho: Array) -> Array:
        """Potential of the poles' density at points off the zone, divided by the half width w.
        The term c_0 log(w) is left out, with c_0 the integral of the density divided by pi w.
        """

        def part(at: Index, k: Index) -> Array:
            return np.real(
                0.5
                * self.q[k]
                * self._potential(self.rho[k], rho[at], np.log(2.0 * np.abs(rho[at])))
            )

        return self.summed(zone, part)

    @staticmethod
    def _potential(rho: Complex, seen: Complex | Array, log: Complex | Array) -> Complex:
        return np.asarray((rho - 1.0 / rho) * np.log1p(-rho * seen) - seen - rho * log)

    def potential(self, zone: Index, seen: OnLine) -> Array:
        """Potential of the density that the poles cause, divided by the half width w of the zone.
        The term c_0 log(w) is left out, with c_0 the integral of the density divided by pi w.
        """
        out, on, off = np.empty(len(zone)), np.flatnonzero(seen.on), np.flatnonzero(~seen.on)
        out[on] = self.potential_on(zone[on], seen.left[on], seen.right[on])
        out[off] = self.potential_off(zone[off], seen.rho[off])
        return out

    # The methods below sum over the poles of each zone.
    def sine_coefficients(self, zones: int, count: int) -> Array:
        """Coefficients of sin(j theta), j = 1 ... count, in the density that a zone's poles cause.

        The right side has the same coefficients, of the polynomials T_j.
        """
        out, power = np.empty((count, zones)), self.q.copy()
        for j in range(count):
            power *= self.rho
            out[j] = np.bincount(self.zone, power.real, zones)
        return out.T

    def mean_offsets(self, zones: int) -> Array:
        """Contribution of the poles to the mean of the right side's primitive on each zone.

        The mean is that of `ForcingJumps.mean_offsets`. Each odd term c_j T_j of the right side's
        Chebyshev series contributes to it: -c_1 / 4 for j = 1, and c_j / (j^2 - 1) for j > 1.
        """
        p, m = self.roots
        parts = 0.25 * self.q * (1.0 / self.rho - self.rho) * np.log(4.0 * p * m / (p + m) ** 2)
        return np.asarray(np.bincount(self.zone, parts.real, zones), dtype=float)

    def edge_slopes(self, zones: int) -> tuple[Array, Array]:
        """Slopes of the poles' density at the zones' ends: (at left ends, at right ends).

        A slope is the derivative of the density by the angle from the end.
        """
        p, m = self.roots
        left, right = (0.5 * self.q / root**2 for root in (p, m))
        out = np.array(
            [np.bincount(self.zone, part.real, zones) for part in (left, right)], dtype=float
        )
        return out[0], out[1]

    def rounding(self, zones: int) -> Array:
        """Round-off of the sum over the poles of each zone."""
        return np.asarray(np.bincount(self.zone, 2.2e-16 * np.abs(self.q), zones), dtype=float)

    # The methods below give fields at complex points (see `sie.density.plane`).
    def in_plane(self, k: Index, seen: InPlane, what: What) -> Complex:
        """Transform, its derivative by zeta, or potential, of the density of the poles k.

        The potential is divided by the half width w. The term c_0 log(w) is left out, with c_0 the
        integral of the density divided by pi w.
        """
        at, rho = seen.rho[:, None], np.concatenate((self.rho[k], np.conj(self.rho[k])))
        weight = 0.5 * np.concatenate((self.q[k], np.conj(self.q[k])))
        if what == "potential":
            return np.asarray(
                (0.5 * self._potential(rho, at, np.log(2) - seen.log[:, None])) @ weight
            )
        both = rho * at
        if what == "transform":
            return np.asarray((both / (1.0 - both)) @ weight)
        return np.asarray(-((both / (1.0 - both) ** 2) @ weight) / seen.root)


def _near_positions(
    zones: Zones, places: Array, period: float | None
) -> Iterator[tuple[int, int, float, float]]:
    """Yield (position index, zone, distances from the zone's ends) for positions near a zone.
    The positions are those of algebraic points, where a function is a power of the distance.

    A position is close to a zone if it lies in it or within `JumpOptions.reach` half widths.
    """
    shifts = np.zeros(1)
    if period is not None:
        places = places + np.ceil((zones.a[0] - places) / period) * period
        shifts = period * np.arange(-2.0, 3.0)
    every = np.arange(len(zones))
    for place, shift in product(range(len(places)), shifts.tolist()):
        at = np.full(len(zones), places[place] + shift)
        left, right = zones.beyond_a(at, every), zones.before_b(at, every)
        near = np.flatnonzero(np.minimum(left, right) > -JUMPS.reach * zones.half)
        for i in near.tolist():
            yield place, i, float(left[i]), float(right[i])


NO_POLES = Poles.nothing()
