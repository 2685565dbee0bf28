"""Jumps of the right side or of its derivatives inside the zones, in closed form.

Positions are in half widths w from the middle of a zone: t = cos(theta) of a point on the zone, z
of a point off it, and s = cos(phi) of a jump. For a point z, rho = z - sgn(z) sqrt(z^2 - 1). With

    kappa(t) = ln|sin((theta + phi)/2) / sin((theta - phi)/2)|
             = sum_j (2/j) sin(j phi) sin(j theta),

the density (h/pi) (t - s)^q kappa(t) has the transform, on the zone and off it,

    h (t - s)_+^q - C_q(t),                     C_q(t) = (h/pi) (phi (t - s)^q + P_q(t)),
    (h/pi) ((z - s)^q 2 Im(-ln(1 - rho e^{i phi})) - P_q(z)),
    P_0 = 0,   P_1 = sin(phi),   P_2 = (t - 2 s) sin(phi) + sin(2 phi)/4.

P_q follows from (tau - s)^q = (t - s)^q - (t - tau)(...) and the moments of kappa, with tau the
variable of integration. The potentials follow from integration by parts. Off the zone let F be the
angle 2 Im(-ln(1 - rho e^{i phi})), with dF/dz = -sin(phi) / ((z - s) |z^2 - 1|^(1/2)) sgn(z). On
the zone let z be t, and let F = pi - phi right of s, and -phi left of s. Let c_0 be the integral of
the density divided by pi w. Then the potentials, divided by w, are

    (h/pi) ((z - s)^{q+1} F/(q+1) + sin(phi) R_q) + c_0 ln(w),
    A = arcosh|z|, B = sgn(z) (z^2 - 1)^(1/2), both zero on the zone,
    R_0 = A - ln 2 - 1,        R_1 = (B - s A)/2 - z + s (3 + 2 ln 2)/4,
    R_2 = (A/2 + s^2 A + B z/2 - 2 s B)/3 - z^2/2 + 3 s z/2 + sin(phi)^2/9 - s^2/2 - 1/12
          - ln(2) (sin(phi)^2/6 + s^2/2).

Where the q-th derivative of the right side g jumps by J, h is J w^q / q!. Once the transform of
these densities is subtracted, the right side is smooth. If g is the slope of a profile, q = 0 is a
kink, q = 1 a jump of the curvature, q = 2 a knot of a cubic spline.

The jumps, splines, poles and nearby logarithms of a zone are its closed-form parts. The density
that they cause is the closed-form density.
"""

from collections.abc import Callable, Iterator
from dataclasses import field, replace
from functools import cached_property, partial
from typing import Self

import numpy as np

from sie.basis import compiled
from sie.basis.data import Array, Index, Mask, record
from sie.basis.interval import Complex, InPlane, OnLine, half_angles, of_t, root_weight, theta
from sie.basis.sums import Grouped
from sie.basis.zones import Zones
from sie.jumps.exterior import NOWHERE, ExteriorLogarithms
from sie.jumps.formulas import HIGHEST, OPTIONS, PlacedJumps, of_sines
from sie.jumps.logarithms import Logarithms, Plateaus
from sie.jumps.poles import NO_POLES, Poles
from sie.jumps.spline import OPTIONS as SPLINES
from sie.jumps.spline import ConjugateSpline, QuadraticSpline, with_jumps

# One spline replaces many jumps of order 2, that is, of the second derivative. It is a
# ConjugateSpline for jumps of the right side, and a QuadraticSpline for jumps of the density. Both
# classes have the same methods. A method raises ValueError if its spline has no closed form for the
# wanted quantity.
Spline = QuadraticSpline | ConjugateSpline
MakeSpline = Callable[[Array, Array, Callable[[Array], Array]], tuple[Spline, Array, Array] | None]
# The term of one pair of a point and a jump has a logarithm. It takes as long as this number of
# terms of a plain sum.
_TERMS_OF_A_SHAPE = 16


@record
class ForcingJumps(PlacedJumps):
    """Jumps of the right side or its derivatives inside zones, with splines and poles.

    splines: the spline of each zone with very many jumps of order 2; it replaces most of them.
    poles: the poles of algebraic points in zones and close to them. logarithms: logarithmic terms
    of the right side, due to jumps of the density or to given values of the density at zone ends.
    """

    splines: dict[int, Spline] = field(default_factory=dict)
    poles: Poles = NO_POLES
    logarithms: Logarithms | None = None

    def __len__(self) -> int:
        return len(self.zone) + len(self.near) + len(self.poles)

    @classmethod
    def none(cls) -> "ForcingJumps":
        return _NONE

    @classmethod
    def within(
        cls,
        zones: Zones,
        at: Array,
        jumps: Array,
        orders: Index,
        period: float | None,
        g: Callable[[Array], Array] | None = None,
    ) -> "ForcingJumps":
        """The jumps at positions `at` (repeated with the period) that lie inside a zone.

        g: the right side, if known. Then a spline replaces the jumps of its second derivative in
        zones with very many of them.
        """
        found = cls.placed(zones, at, jumps, orders, period) if len(at) else _NONE
        return (
            found
            if g is None
            else found._with_splines(zones, g, ConjugateSpline.inside, SPLINES.min_jumps)
        )

    @classmethod
    def placed(
        cls, zones: Zones, at: Array, jumps: Array, orders: Index, period: float | None
    ) -> Self:
        """The jumps that lie inside zones, with no jump replaced by a spline."""
        at, i, inside = cls.located(zones, at, period)
        i, at, q = i[inside], at[inside], orders[inside]
        w = zones.half[i]
        factorial = np.array([1.0, 1.0, 2.0])[q]
        return cls(
            i,
            zones.beyond_a(at, i) / w,
            zones.before_b(at, i) / w,
            jumps[inside] * w**q / factorial,
            q,
        )

    @staticmethod
    def located(zones: Zones, at: Array, period: float | None) -> tuple[Array, Index, Mask]:
        """(moved positions, a zone for each of them, whether the position lies inside this zone).

        Positions are moved by periods to lie right of the first zone's left end. The zone is the
        last one that starts before the position.
        """
        if period is not None:
            at = at + np.ceil((zones.a[0] - at) / period) * period
        i = np.searchsorted(zones.a, at, side="right") - 1
        return (
            at,
            np.maximum(i, 0),
            (i >= 0) & (zones.beyond_a(at, i) > 0) & (zones.before_b(at, i) > 0),
        )

    def _with_splines(
        self, zones: Zones, f: Callable[[Array], Array], make: MakeSpline, least: int
    ) -> Self:
        """The jumps, with a spline in zones that have at least `least` jumps of order 2.
        Jumps of order 2 are jumps of the second derivative; the spline replaces them.

        make: makes a spline from the knots, their jumps and the function f. If f is not a quadratic
        spline with these jumps, the spline is made from the jumps alone.
        """
        height, more = self.height.copy(), []
        splines: dict[int, Spline] = {}
        for zone in np.flatnonzero(
            np.bincount(self.zone[self.order == HIGHEST], minlength=1) >= least
        ).tolist():
            all_of_it = self.by_zone[zone]
            k = all_of_it[self.order[all_of_it] == HIGHEST]
            k = k[np.argsort(self.left[k])]
            left, jumps = self.left[k], height[k]
            found = (
                make(left, jumps, partial(_from_left, f, zones, zone))
                if len(k) == len(all_of_it)
                else None
            )
            found = make(left, jumps, with_jumps(left, jumps)) if found is None else found
            if found is not None:
                splines[zone], height[k], others = found
                more.append(np.column_stack((np.full(others.shape[1], zone), others.T)))
        if not splines:
            return self
        keep = height != 0.0
        zone, left, jump = np.concatenate(more).T
        return replace(
            self,
            zone=np.append(self.zone[keep], zone.astype(np.intp)),
            left=np.append(self.left[keep], left),
            right=np.append(self.right[keep], 2.0 - left),
            height=np.append(height[keep], jump),
            order=np.append(self.order[keep], np.full(len(zone), HIGHEST)),
            splines=splines,
        )

    @property
    def count(self) -> Index:
        """Number of jumps and singular points of each zone, knots of the zone's spline included.

        The array ends with the last zone that has any.
        """
        out = np.bincount(
            self.zone, minlength=max((*self.splines, *self.poles.by_zone), default=-1) + 1
        )
        for zone in self.splines:
            out[zone] = len(self.places(zone)[0])
        return out + np.bincount(self.poles.points[0], minlength=len(out))

    def places(self, zone: int) -> tuple[Array, Index]:
        """For the jumps of a zone, the distances from its left end in half widths, and the orders.
        The order of a jump is the number of the derivative that jumps.

        The knots of the zone's spline are included.
        """
        k = self.by_zone[zone]
        if zone not in self.splines:
            return self.left[k], self.order[k]
        left = np.union1d(self.left[k], self.splines[zone].knots)
        order = np.full(len(left), HIGHEST)
        np.minimum.at(order, np.searchsorted(left, self.left[k]), self.order[k])
        return left, order

    def angles(self, zone: int) -> Array:
        """Angles of the jumps of a zone and of the knots of the zone's spline, unsorted."""
        if zone not in self.splines:
            return self.phi[self.by_zone[zone]]
        left = self.places(zone)[0]
        return theta(left, 2 - left)

    def rounding(self, count: int) -> Array:
        """Upper bound of the round-off of closed forms (of jumps, splines, poles) on each zone."""
        out = np.asarray(2.2e-16 * np.bincount(self.zone, np.abs(self.height), minlength=count))
        for zone, spline in self.splines.items():
            out[zone] += 2.2e-16 * spline.size
        return out + self.poles.rounding(count)

    @cached_property
    def by_zone(self) -> dict[int, Index]:
        """Indices of the jumps of each zone that has jumps, splines, poles or nearby logarithms.

        A zone with only a spline, poles or nearby logarithms has an empty array.
        """
        others = *self.splines, *self.near.by_zone, *self.poles.by_zone
        return {zone: np.zeros(0, np.intp) for zone in others} | self.grouped.places()

    # The methods below give values at points (n,). A point is given by its zone and by its
    # distances from the zone's ends, in half widths.
    def smooth_part(self, zone: Index, left: Array) -> Array:
        """The function that cancels jumps and singular points of the right side g.
        The sum of this function and g is smooth.
        """
        out = -self.carried(zone, left)
        return out if self.logarithms is None else out + self.logarithms.on_zones(zone, left)

    def level_part(self, zone: Index, left: Array) -> Array:
        """Piecewise constant function that cancels the jumps of the right side g itself.
        It is a part of `smooth_part`, which also cancels the jumps of derivatives of g.
        """
        return -replace(self.chosen(self.order == 0), splines={}, poles=NO_POLES).carried(
            zone, left
        )

    def carried(self, zone: Index, left: Array) -> Array:
        """Transform, on the zones, of the density of jumps, splines and poles."""
        out = self.summed(zone, lambda at, k: self.on_zone(k, left[at]))
        for spline, here in self._in_splines(zone):
            out[here] += spline.own_transform(left[here])
        return out + self.poles.own_transform(zone, left) if len(self.poles) else out

    def own_transform(self, zone: Index, left: Array) -> Array:
        """Transform, on the zones, of the density of jumps, splines, poles and near logarithms."""
        return self.carried(zone, left) + self.near.own_transform(zone, left)

    def density(self, zone: Index | int, left: Array, right: Array) -> Array:
        """Density that jumps, splines, poles and nearby logarithms of the right side cause.
        It is a sum of closed forms.
        """
        zone = np.broadcast_to(zone, left.shape)
        out = self._densities(zone, left, right)
        for spline, here in self._in_splines(zone):
            out[here] += spline.density(left[here], right[here])
        if len(self.poles):
            out += self.poles.density(zone, left, right)
        return out + self.near.density(zone, left, right) if len(self.near) else out

    def _densities(self, zone: Index, left: Array, right: Array) -> Array:
        """For each point, the sum of the densities that all jumps in the point's zone cause."""
        grouped, row = self.grouped, self.grouped.rows(zone)
        pairs = np.concatenate(([0], np.cumsum(grouped.count[row])))
        loops = compiled.loops("jump_sums", _TERMS_OF_A_SHAPE * int(pairs[-1]))
        if loops is None:
            return self.summed(zone, lambda at, k: self.of_density(k, left[at], right[at]))
        out = np.empty(len(zone))
        compiled.in_threads(
            loops.densities,
            _TERMS_OF_A_SHAPE * pairs,
            (self.left, np.sqrt(self.left), np.sqrt(self.right), self.order, self.height / np.pi),
            (grouped.order, grouped.first, grouped.count),
            tuple(np.array(part) for part in (row, left, right)),
            out,
        )
        return out

    def integral(self, zone: Index, left: Array, right: Array) -> Array:
        """Integral of the closed-form density from the zone's left end to each point.
        It is divided by the half width of the zone.
        """
        out = self.summed(zone, lambda at, k: self.integral_of(k, left[at], right[at]))
        for spline, here in self._in_splines(zone):
            out[here] += spline.integral(left[here])
        if len(self.poles):
            out += self.poles.integral(zone, left, right)
        return out + self.near.integral(zone, left, right) if len(self.near) else out

    def transform(self, zone: Index, seen: OnLine) -> Array:
        """Transform, on and off the zones, of the density of jumps, splines, poles and logarithms.

        Off the zones one Chebyshev series of all jumps of a zone replaces the closed forms where
        the series is shorter, or where the closed forms cancel each other.
        """
        out, off = np.empty(len(zone)), np.flatnonzero(~seen.on)
        on = np.flatnonzero(seen.on)
        out[on] = self.own_transform(zone[on], seen.left[on])
        out[off] = self._off(zone[off], seen[off])
        return out

    def _off(self, zone: Index, seen: OnLine) -> Array:
        z, rho, far = seen.zeta, seen.rho, self._far(zone, seen)
        out, near = np.empty(len(zone)), np.flatnonzero(~far)
        out[far] = of_t(
            self._series, seen[far], np.ones(1), 1.0, self.grouped.rows(zone[far]), "transform"
        )
        out[near] = self.summed(
            zone[near], lambda at, k: self.off_zone(k, z[near[at]], rho[near[at]])
        )
        for spline, here in self._in_splines(zone):
            out[here] += spline.transform_off(z[here], rho[here])
        return out + self.near.transform(zone, rho) + self.poles.transform(zone, rho)

    def sharp_potential(self, zone: Index, seen: OnLine) -> Array:
        """Potential at points due to the closed-form density of each point's zone, divided by w.
        w is the half width of this zone. The term c_0 log(w) is left out, with c_0 the integral of
        the density divided by pi w.

        The formulas are at the head of this file.
        """
        out = self._closed_potential(zone, seen)
        for spline, here in self._in_splines(zone):
            out[here] += spline.potential(seen.left[here], seen.right[here], seen.rho[here])
        if len(self.near):
            rho = on_circle(seen)
            out += self.near.potential(zone, np.log(2 * np.abs(rho)), rho)
        return out + self.poles.potential(zone, seen) if len(self.poles) else out

    def _closed_potential(self, zone: Index, seen: OnLine) -> Array:
        l, r, rho, far = seen.left, seen.right, seen.rho, self._far(zone, seen)
        out, on, near = (
            np.empty(len(zone)),
            np.flatnonzero(seen.on),
            np.flatnonzero(~seen.on & ~far),
        )
        out[far] = of_t(
            self._series, seen[far], np.ones(1), 1.0, self.grouped.rows(zone[far]), "potential"
        )
        out[on] = self.summed(zone[on], lambda at, k: self.potential_on(k, l[on[at]], r[on[at]]))
        out[near] = self.summed(
            zone[near], lambda at, k: self.potential_off(k, l[near[at]], r[near[at]], rho[near[at]])
        )
        return out

    def summed(self, zone: Index, of: Callable[[Index, Index], Array]) -> Array:
        """For each point, the weighted sum of a function `of` over the jumps in the point's zone.
        The weight of a jump is its height h divided by pi.

        of(points, jumps): values for pairs of a point and a jump.
        """
        return self.grouped.summed(zone, self.height / np.pi, of)

    def _in_splines(self, zone: Index) -> Iterator[tuple[Spline, Index]]:
        """Yield (spline, indices of points on the spline's zone) for each zone with a spline."""
        for i, here in Grouped.by(zone).places().items() if self.splines else ():
            if i in self.splines:
                yield self.splines[i], here

    def _far(self, zone: Index, seen: OnLine) -> Mask:
        """Whether a point is so far from its zone that a series replaces the closed forms.
        The series and the closed forms are those of all jumps of the zone.
        """
        return np.asarray(
            ~seen.on
            & (np.abs(seen.rho) < np.array(OPTIONS.far_rho)[self._length[self.grouped.rows(zone)]])
        )

    @cached_property
    def _length(self) -> Index:
        """For each zone, the index of its entry in `JumpOptions.far_rho` and `far_terms`.
        The entry depends on the number of jumps in the zone. Where |rho| is below this `far_rho`,
        one series replaces the closed forms of the zone's jumps.
        """
        return np.searchsorted(OPTIONS.far_jumps, self.grouped.count, side="right")

    @cached_property
    def _series(self) -> Array:
        """Coefficients of T_l / sqrt(1 - t^2) in the density of all jumps of each zone."""
        return self._coefficients(OPTIONS.far_terms[self._length])

    def mean_offsets(self, zones: Zones) -> Array:
        """Contribution of the closed-form parts to the mean of the right side's primitive.

        It has one value for each zone, divided by the half width of the zone. The mean is over
        theta, and the primitive is shifted so that its values at both ends add up to zero.
        `System.levels` adds the contribution of the smooth remainder of the right side.
        """
        phi, s, q = self.phi, self.s, self.order
        sine, double = self.sine, np.sin(2 * phi)
        # The contribution of a jump of the right side g itself is computed from the jump's distance
        # d to the nearer end of the zone. Otherwise terms would cancel close to the end, where the
        # result is of the order d^(3/2).
        near, angle = np.minimum(self.left, self.right), np.minimum(phi, self.psi)
        kink = (sine - angle * (1 - near)) / np.pi - 0.5 * near
        # `end` is the primitive of (t - s)_+^q at t = 1, and `mean` is the mean of this primitive
        # over theta.
        end = self.right ** (q + 1) / (q + 1)
        cubic = (
            (sine - sine**3 / 3) - 3 * s * (phi / 2 + double / 4) + 3 * s * s * sine - s**3 * phi
        )
        square = (phi / 2 + double / 4) - 2 * s * sine + s * s * phi
        mean = np.where(q == 1, square / 2, cubic / 3) / np.pi
        # The transform of a jump's density, for the height 1, is the truncated power (t - s)_+^q
        # minus a polynomial C_q. Let P be the primitive of C_q that vanishes at t = 0. `ends_c` is
        # half the sum of the values of P at both ends, `mean_c` is the mean of P over theta.
        ends_c = np.where(q == 1, phi / 2, -s * phi + sine / 2) / np.pi
        mean_c = np.where(q == 1, phi / 4, -s * phi / 2 + sine / 4) / np.pi
        parts = self.height * np.where(q == 0, kink, -0.5 * end + ends_c + mean - mean_c)
        out = np.asarray(np.bincount(self.zone, parts, minlength=len(zones)), dtype=float)
        for zone, spline in self.splines.items():
            out[zone] += spline.mean_offset
        if len(self.near):
            out += self.near.mean_offsets(len(zones))
        return out + self.poles.mean_offsets(len(zones)) if len(self.poles) else out

    def t_coefficients(self, zones: Zones, count: int) -> Array:
        """The first `count` coefficients of T_l / sqrt(1 - t^2) in the closed-form density.

        The shape is (zones, count).
        """
        out = self.coefficients(np.arange(len(self.zone)), self.zone, len(zones), count)
        for zone, spline in self.splines.items():
            out[zone] += spline.t_coefficients(count)
        return out + self._other_coefficients(zones, count)

    def _other_coefficients(self, zones: Zones, count: int, counts: Index | None = None) -> Array:
        """The part of `t_coefficients` that nearby logarithms and poles cause.
        counts: see `near_coefficients`.
        """
        out = self.near_coefficients(zones, count, counts)
        if len(self.poles):
            out += of_sines(self.poles.sine_coefficients(len(zones), count + 1))[:, :count]
        return out

    def near_coefficients(self, zones: Zones, count: int, counts: Index | None = None) -> Array:
        """The part of `t_coefficients` that the logarithms outside but close to zones cause.
        counts: the number of coefficients that each zone needs (Z,); None: `count` for all zones.
        """
        out = np.zeros((len(zones), count))
        if len(self.near):
            wanted = np.full(len(self.near), count) if counts is None else counts[self.near.zone]
            for number in np.unique(wanted).tolist():
                some = np.flatnonzero(wanted == number)
                own = of_sines(self.near.sine_coefficients(number + 1, some))[:, :number]
                np.add.at(out[:, :number], self.near.zone[some], own)
        return out

    def first_coefficients(self, zones: Zones, counts: Index) -> Array:
        """Coefficients of T_l / sqrt(1 - t^2) in the closed-form density, in one row per zone.
        counts: the number of coefficients of each zone (Z,). Later coefficients are zero.
        """
        out = self._coefficients(counts)
        for zone, spline in self.splines.items():
            out[zone, : counts[zone]] += spline.t_coefficients(int(counts[zone]))
        if len(self.near) or len(self.poles):
            others = self._other_coefficients(zones, out.shape[1], counts)
            out += np.where(np.arange(out.shape[1]) < counts[:, None], others, 0.0)
        return out

    def _coefficients(self, counts: Index) -> Array:
        out = np.zeros((len(counts), int(counts.max(initial=0))))
        row = np.zeros(len(counts), dtype=np.intp)
        for count in np.unique(counts):
            some = np.flatnonzero(counts == count)
            k = np.flatnonzero(counts[self.zone] == count)
            row[some] = np.arange(len(some))
            out[some, :count] = self.coefficients(k, row[self.zone[k]], len(some), int(count))
        return out

    def high_coefficients(self, zones: Zones) -> Array:
        """An empty table (zones, 0): the whole density here has a potential in closed form."""
        return np.zeros((len(zones), 0))

    def edge_slopes(self, zones: Zones) -> tuple[Array, Array]:
        """Slopes of the closed-form density at the zones' ends: (at left ends, at right ends).

        Close to an end, the density is the slope times the angle from that end: theta from a right
        end, pi - theta from a left end.
        """
        out = np.array(
            [np.bincount(self.zone, part, minlength=len(zones)) for part in self._edge_slopes()],
            dtype=float,
        )
        if len(self.near):
            out += [
                np.bincount(self.near.zone, part, minlength=len(zones))
                for part in self.near.edge_slopes()
            ]
        for zone, spline in self.splines.items():
            out[:, zone] += spline.edge_slopes
        if len(self.poles):
            out += self.poles.edge_slopes(len(zones))
        return out[0], out[1]

    def _edge_slopes(self) -> tuple[Array, Array]:
        """Slopes, as in `edge_slopes`, of the density of each jump: (at left ends, at right ends).

        Close to the right end, kappa is about theta cot(phi/2).
        """
        cot, scale = np.sqrt(self.left / self.right), self.height / np.pi
        return scale * (-self.left) ** self.order / cot, scale * self.right**self.order * cot

    def sharpest(self, zone: int) -> tuple[Array, Array]:
        """(distances from the left end, heights) of points where a zone's density is steepest.

        They are the jumps of the lowest order in the zone, if this order is 0 or 1, and algebraic
        points with exponents below 1. The height of an algebraic point is infinite.
        """
        k = self.by_zone.get(zone, np.zeros(0, dtype=np.intp))
        k = k[(self.order[k] == self.order[k].min(initial=2)) & (self.order[k] < HIGHEST)]
        of_zone, left, exponent, _ = self.poles.points
        steep = left[(of_zone == zone) & (exponent < 1.0)]
        return np.append(self.left[k], steep), np.append(
            self.height[k], np.full(len(steep), np.inf)
        )

    def left_out(self, x: Array) -> Array:
        """Sum at points x (n,) of the logarithmic terms that a user omits from the right side.

        It is 0 if there are plateaus (stretches of constant density beside the zones). Then the
        logarithmic terms are minus the transform of the plateaus, which the solver adds itself.
        """
        if self.logarithms is None or self.plateaus is not None:
            return np.zeros(x.shape)
        return self.logarithms.at_points(x)

    @property
    def plateaus(self) -> Plateaus | None:
        """Plateaus (stretches of constant density) beside the zones; None if there are none."""
        return None if self.logarithms is None else self.logarithms.plateaus

    def primitive_left_out(self, x: Array) -> Array:
        """Antiderivative at points x of the sum of all logarithmic terms of the right side.
        The terms of plateaus (stretches of constant density) are included.
        """
        if self.logarithms is None:
            return np.zeros(x.shape)
        return self.logarithms.primitive_at(x.ravel()).reshape(x.shape)

    # The methods below give fields at complex points (see `sie.density.plane`).
    def logarithm(self, k: Index, seen: InPlane, away: Complex) -> Complex:
        """The logarithmic factor in the transform of each jump k, at complex points.
        It is -i log(B / A) with A = 1 - rho e^(i phi) and B = 1 - rho e^(-i phi). rho is zeta -
        sqrt(zeta^2 - 1) of the point zeta, and phi is the angle of the jump.
        """
        c, s = half_angles(self.left[k], self.right[k])
        with np.errstate(divide="ignore", invalid="ignore"):
            out = -1j * np.log(
                (c - 1j * s) ** 2 * (c * seen.m[:, None] + 1j * s * seen.p[:, None]) ** 2 / away
            )
        # The logarithm of B / A loses digits if B is nearly A, as for jumps close to an end.
        # There -i log(B / A) is computed as 2 arctan(rho sin(phi) / (1 - rho cos(phi))), with
        # 1 - rho cos(phi) as a sum of two terms that do not cancel.
        rho, (from_left, from_right) = seen.rho[:, None], (e[:, None] for e in seen.from_ends)
        nearer = np.where(c < s, from_left - 2 * rho * c**2, from_right + 2 * rho * s**2)
        over = rho * self.sine[k]
        small = np.abs(over) < 0.5 * np.abs(nearer)
        out[small] = 2 * np.arctan(over[small] / nearer[small])
        return np.asarray(out)

    def logarithm_slope(self, k: Index, seen: InPlane, away: Complex) -> Complex:
        """Derivative by zeta of `logarithm`, the logarithmic factor in the jumps' transforms."""
        return np.asarray(-self.sine[k] / (away * seen.root[:, None]))

    def plane_potential(self, k: Index, seen: InPlane, away: Complex, log: Complex) -> Complex:
        """Potential of the density of jumps k at complex points, divided by the half width w.
        The term c_0 log(w) is left out, with c_0 the integral of the density divided by pi w.
        """
        parts = self.potential_of(
            k, away, seen.zeta[:, None], log, seen.log[:, None], seen.root[:, None]
        )
        return np.asarray(parts @ (self.height[k] / np.pi))

    @property
    def near(self) -> ExteriorLogarithms:
        """Logarithms of the right side outside but close to a zone, or at its end."""
        return NOWHERE if self.logarithms is None else self.logarithms.near

    @cached_property
    def kinked(self) -> list[int]:
        """Zones with a jump of the right side itself, or with a logarithm close to the zone."""
        return sorted({*self.zone[self.order == 0].tolist(), *self.near.by_zone})


def on_circle(seen: OnLine) -> Complex:
    """The number rho of points off the zone, and e^(i theta) of points cos(theta) on the zone.
    rho is zeta - sqrt(zeta^2 - 1) of the point zeta.
    """
    root = root_weight(np.maximum(seen.left, 0.0), np.maximum(seen.right, 0.0))
    return np.where(seen.on, 0.5 * (seen.left - seen.right) + 1j * root, seen.rho)


def _from_left(f: Callable[[Array], Array], zones: Zones, zone: int, left: Array) -> Array:
    """Values of f at places given by distances from the zone's left end, in half widths."""
    return f(zones.a[zone] + zones.half[zone] * left)


_NONE = ForcingJumps(*PlacedJumps.nothing())
