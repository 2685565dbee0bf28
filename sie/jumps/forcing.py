"""Jumps of the right side or of its derivatives inside the zones, carried exactly.

With t = cos(theta), s = cos(phi) and

    kappa(t) = ln|sin((theta + phi)/2) / sin((theta - phi)/2)| = sum_j (2/j) sin(j phi) sin(j theta),

the kernel makes of (h/pi) (t - s)^q kappa(t), on the zone and off it,

    h (t - s)_+^q - C_q(t)                                  C_q(t) = (h/pi) (phi (t - s)^q + P_q(t))
    (h/pi) ((z - s)^q 2 Im(-ln(1 - rho e^{i phi})) - P_q(z))
    P_0 = 0,   P_1 = sin(phi),   P_2 = (t - 2 s) sin(phi) + sin(2 phi)/4,

P_q from (tau - s)^q = (t - s)^q - (t - tau)(...) and the moments of kappa. Their potentials are, by parts, with the angle F =
2 Im(-ln(1 - rho e^{i phi})) off the zone, dF/dz = -sin(phi) / ((z - s) |z^2 - 1|^(1/2)) sgn(z), and F = pi - phi or -phi on it,

    (h/pi) ((z - s)^{q+1} F/(q+1) + sin(phi) R_q) + c_0 ln(w),     A = arcosh|z|, B = sgn(z) (z^2 - 1)^(1/2), zero on the zone,
    R_0 = A - ln 2 - 1,        R_1 = (B - s A)/2 - z + s (3 + 2 ln 2)/4,
    R_2 = (A/2 + s^2 A + B z/2 - 2 s B)/3 - z^2/2 + 3 s z/2 + sin(phi)^2/9 - s^2/2 - 1/12 - ln(2) (sin(phi)^2/6 + s^2/2).

So a jump J of the q-th derivative of g,
with h = J w^q / q!, leaves a smooth right side once this is subtracted: q = 0 is a kink of the profile, q = 1 a jump of
its curvature, q = 2 a knot of a cubic spline.
"""

from collections.abc import Callable
from dataclasses import field, replace
from functools import cached_property, partial
from typing import Self

import numpy as np

from sie.basis.data import Array, Index, Mask, record
from sie.basis.interval import Complex, InPlane, OnLine, theta
from sie.basis.sums import of_zones, pair_blocks
from sie.basis.zones import Zones
from sie.jumps.exterior import NOWHERE, ExteriorLogarithms
from sie.jumps.formulas import HIGHEST, FewJumps, Jumps, far_potential, far_transform
from sie.jumps.local_spline import MANY, LocalSpline, with_jumps
from sie.jumps.zone_spline import ZoneSpline

# What takes the place of very many jumps of order 2 in one zone, of the right side's or of the density's own: with the same methods, of
# which each refuses those that have no use for its kind.
Spline = LocalSpline | ZoneSpline
MadeSpline = Callable[[Array, Array, Callable[[Array], Array]], tuple[Spline, Array, Array] | None]

# InPlane from farther than this rho, the closed form cancels and the series is short.
_FAR = 0.25
# Up to which rho how many terms of the series are enough.
_SERIES_TO = ((0.25, 32), (0.6, 80), (0.87, 288))
# Of the angle: by which slopes are found.
_STEP = 1e-5
# Kinks of a zone beside which it is looked how the density follows the ends.
_KINKS = 32
# Zones whose series are found together.
_TOGETHER = 256


@record
class ForcingJumps(Jumps):
    """Jumps inside the zones. splines: of zones with very many jumps of order 2, what carries most of these."""

    splines: dict[int, Spline] = field(default_factory=dict)

    @classmethod
    def none(cls) -> "ForcingJumps":
        return _NONE

    @classmethod
    def within(
        cls, zones: Zones, at: Array, jumps: Array, orders: Index, period: float | None, g: Callable[[Array], Array] | None = None
    ) -> "ForcingJumps":
        """The jumps at positions `at` (repeated with the period) that lie inside a zone. g: the right side, if it is known."""
        if len(at) == 0:
            return _NONE
        at, i, inside = cls.located(zones, at, period)
        i, at, q = i[inside], at[inside], orders[inside]
        w = zones.half[i]
        factorial = np.array([1.0, 1.0, 2.0])[q]
        found = cls(i, zones.beyond_a(at, i) / w, zones.before_b(at, i) / w, jumps[inside] * w**q / factorial, q)
        return found if g is None else found._with_splines(zones, g, ZoneSpline.inside)

    @staticmethod
    def located(zones: Zones, at: Array, period: float | None) -> tuple[Array, Index, Mask]:
        """(positions moved by periods to lie right of the first zone's left end, the last zone that starts before each,
        whether they lie inside it)."""
        if period is not None:
            at = at + np.ceil((zones.a[0] - at) / period) * period
        i = np.searchsorted(zones.a, at, side="right") - 1
        return at, np.maximum(i, 0), (i >= 0) & (zones.beyond_a(at, i) > 0) & (zones.before_b(at, i) > 0)

    def _with_splines(self, zones: Zones, f: Callable[[Array], Array], made: MadeSpline, least: int = MANY) -> Self:
        """The same with splines, made of knots, their jumps and f, in every zone of many jumps of order 2, at the least so many. Where f
        is more than a spline with these jumps, or jumps otherwise, they alone tell it."""
        height, more = self.height.copy(), []
        splines: dict[int, Spline] = {}
        for zone in np.flatnonzero(np.bincount(self.zone[self.order == HIGHEST], minlength=1) >= least).tolist():
            all_of_it = self.by_zone[zone]
            k = all_of_it[self.order[all_of_it] == HIGHEST]
            k = k[np.argsort(self.left[k])]
            left, jumps = self.left[k], height[k]
            found = made(left, jumps, partial(_from_left, f, zones, zone)) if len(k) == len(all_of_it) else None
            found = made(left, jumps, with_jumps(left, jumps)) if found is None else found
            if found is not None:
                splines[zone], height[k], others = found
                more.append(np.column_stack((np.full(others.shape[1], zone), others.T)))
        if not splines:
            return self
        keep = height != 0.0
        zone, left, jump = np.concatenate(more).T
        return replace(
            self, zone=np.append(self.zone[keep], zone.astype(np.intp)), left=np.append(self.left[keep], left),
            right=np.append(self.right[keep], 2.0 - left), height=np.append(height[keep], jump),
            order=np.append(self.order[keep], np.full(len(zone), HIGHEST)), splines=splines,
        )

    @property
    def count(self) -> Index:
        """Jumps in each zone, those of its spline included, as far as there are zones with any."""
        out = np.bincount(self.zone, minlength=max(self.splines, default=-1) + 1)
        for zone in self.splines:
            out[zone] = len(self.places(zone)[0])
        return out

    def places(self, zone: int) -> tuple[Array, Index]:
        """(distances from the left end over w, orders) of the jumps of a zone, those of its spline included."""
        k = self.by_zone[zone]
        if zone not in self.splines:
            return self.left[k], self.order[k]
        left = np.union1d(self.left[k], self.splines[zone].knots)
        order = np.full(len(left), HIGHEST)
        np.minimum.at(order, np.searchsorted(left, self.left[k]), self.order[k])
        return left, order

    def angles(self, zone: int) -> Array:
        """Angles of the same jumps, in no order."""
        if zone not in self.splines:
            return self.phi[self.by_zone[zone]]
        left = self.places(zone)[0]
        return theta(left, 2 - left)

    def rounding(self, count: int) -> Array:
        """What the sum of a zone's parts is rounded to, at the most, on each of so many zones."""
        out = np.asarray(2.2e-16 * np.bincount(self.zone, np.abs(self.height), minlength=count))
        for zone, spline in self.splines.items():
            out[zone] += 2.2e-16 * spline.size
        return out

    @cached_property
    def by_zone(self) -> dict[int, Index]:
        """Places of the jumps of each zone that has any."""
        return self.grouped()

    def grouped(self) -> dict[int, Index]:
        """See `by_zone`."""
        order = np.argsort(self.zone, kind="stable")
        zones, first = np.unique(self.zone[order], return_index=True)
        bounds = [*first.tolist(), len(order)]
        found = {zone: order[start:end] for zone, start, end in zip(zones.tolist(), bounds[:-1], bounds[1:], strict=True)}
        return {zone: np.zeros(0, np.intp) for zone in self.splines} | found

    def smooth_part(self, zone: int, left: Array) -> Array:
        """What to add to g at points of a zone, given by their distance from its left end over w, to make it smooth."""
        k = self.by_zone.get(zone)
        if k is None:
            return np.zeros(left.shape)
        out = -self._on_zone(k, left)
        if zone in self.splines:
            out -= self.splines[zone].own_transform(left)
        return out

    @cached_property
    def few(self) -> FewJumps:
        """The jumps of all zones with few of them, and no spline."""
        return FewJumps.of(self, list(self.splines))

    # pair by pair, few jumps of many zones together -----------------------------------------------------------------
    def density_at(self, zone: Index, left: Array, right: Array) -> Array:
        """`density` of zones (n,) at points."""
        return self._at(
            zone, lambda some: self.few.density(zone[some], left[some], right[some]),
            lambda i, some: self.density(i, left[some], right[some]),
        )

    def transform_at(self, zone: Index, seen: OnLine) -> Array:
        """`own_transform` on the zones, `transform` off them."""
        out, on, off = np.empty(len(zone)), np.flatnonzero(seen.on), np.flatnonzero(~seen.on)
        z, rho = 0.5 * (seen.left - seen.right), seen.rho
        out[on] = self._at(
            zone[on], lambda some: -self.few.smooth_part(zone[on[some]], seen.left[on[some]]),
            lambda i, some: self.own_transform(i, seen.left[on[some]]),
        )
        out[off] = self._at(
            zone[off], lambda some: self.few.transform(zone[off[some]], z[off[some]], rho[off[some]]),
            lambda i, some: self.transform(i, z[off[some]], rho[off[some]]),
        )
        return out

    def sharp_potential_at(self, zone: Index, left: Array, right: Array, rho: Array) -> Array:
        """`sharp_potential` of zones that have it."""
        return self._at(
            zone, lambda some: self.few.potential(zone[some], left[some], right[some], rho[some]),
            lambda i, some: self.sharp_potential(i, left[some], right[some], rho[some]),
        )

    def _at(self, zone: Index, of_few: Callable[[Index], Array], of_zone: Callable[[int, Index], Array]) -> Array:
        """What the jumps of zones do at points: of those with few by all these points, of each other zone by its own ones."""
        out, few = np.zeros(len(zone)), self.few.holds(zone)
        some, rest = np.flatnonzero(few), np.flatnonzero(~few)
        out[some] = of_few(some)
        for i, there in of_zones(zone[rest]):
            if i in self.by_zone:
                out[rest[there]] = of_zone(i, rest[there])
        return out

    def level_part(self, zone: int, left: Array) -> Array:
        """The same of the jumps of g itself alone: they have no slope."""
        if zone not in self.kinked:
            return np.zeros(left.shape)
        k = self.by_zone[zone]
        return -self._on_zone(k[self.order[k] == 0], left)

    def _summed(self, k: Index, points: int, of: Callable[[slice], Array]) -> Array:
        """Sums over jumps k; of: what is summed, over h / pi, at a stretch of the points by the jumps."""
        out, weight = np.empty(points), self.height[k] / np.pi
        for here in pair_blocks(points, len(k)):
            out[here] = of(here) @ weight
        return out

    def _on_zone(self, k: Index, left: Array) -> Array:
        """What the kernel makes of jumps k of one zone on it."""
        return self._summed(k, len(left), lambda here: self.on_zone(k, left[here, None]))

    def mean_offsets(self, zones: Zones) -> Array:
        """Mean over each zone of the primitive of g (zero where its values at the ends are), less what the smooth
        part's own coefficients say, over w: see `System.levels`."""
        phi, s, q = self.phi, self.s, self.order
        sine, double = self.sine, np.sin(2 * phi)
        # A jump of g itself by its distance from the nearer end: close to that the parts cancel to its square root, cubed.
        near, angle = np.minimum(self.left, self.right), np.minimum(phi, self.psi)
        kink = (sine - angle * (1 - near)) / np.pi - 0.5 * near
        # Primitives of (t - s)_+^q at t = 1, and their means.
        end = self.right ** (q + 1) / (q + 1)
        cubic = (sine - sine**3 / 3) - 3 * s * (phi / 2 + double / 4) + 3 * s * s * sine - s**3 * phi
        square = (phi / 2 + double / 4) - 2 * s * sine + s * s * phi
        mean = np.where(q == 1, square / 2, cubic / 3) / np.pi
        # Primitives of C_q, zero at t = 0: half the sum of those at both ends, and their means.
        ends_c = np.where(q == 1, phi / 2, -s * phi + sine / 2) / np.pi
        mean_c = np.where(q == 1, phi / 4, -s * phi / 2 + sine / 4) / np.pi
        parts = self.height * np.where(q == 0, kink, -0.5 * end + ends_c + mean - mean_c)
        out = np.asarray(np.bincount(self.zone, parts, minlength=len(zones)), dtype=float)
        for zone, spline in self.splines.items():
            out[zone] += spline.mean_offset
        return out

    def t_coefficients(self, zones: Zones, count: int) -> Array:
        """First `count` coefficients c_l of these parts as sums of T_l / sqrt(1 - t^2); shape (zones, count)."""
        out = self.coefficients(np.arange(len(self.zone)), self.zone, len(zones), count)
        for zone, spline in self.splines.items():
            out[zone] += spline.t_coefficients(count)
        return out

    def first_coefficients(self, zones: Zones, counts: Index) -> Array:
        """The same, of each zone so many (Z,), zeros after them."""
        out = np.zeros((len(zones), int(counts.max(initial=0))))
        row = np.zeros(len(zones), dtype=np.intp)
        for count in np.unique(counts):
            some = np.flatnonzero(counts == count)
            k = np.flatnonzero(counts[self.zone] == count)
            row[some] = np.arange(len(some))
            out[some, :count] = self.coefficients(k, row[self.zone[k]], len(some), int(count))
        for zone, spline in self.splines.items():
            out[zone, : counts[zone]] += spline.t_coefficients(int(counts[zone]))
        return out

    def high_coefficients(self, zones: Zones) -> Array:
        """Coefficients of the parts that have no closed potential, as many as potentials near an end need; (zones, 0) if none."""
        return np.zeros((len(zones), 0))

    def edge_slopes(self, zones: Zones) -> tuple[Array, Array]:
        """Coefficient of the angle from the left and from the right end, per zone: kappa ~ theta cot(phi/2)."""
        cot = np.sqrt(self.left / self.right)
        scale, n = self.height / np.pi, len(zones)
        from_left = scale * (-self.left) ** self.order / cot
        from_right = scale * self.right**self.order * cot
        out = np.array([np.bincount(self.zone, part, minlength=n) for part in (from_left, from_right)], dtype=float)
        for zone, spline in self.splines.items():
            out[:, zone] += spline.edge_slopes
        return out[0], out[1]

    def density(self, zone: int, left: Array, right: Array) -> Array:
        """Sum of the parts of a zone at points (n,) given by their distances from its ends over w."""
        k = self.by_zone[zone]
        out = self._summed(k, len(left), lambda here: self.of_density(k, left[here, None], right[here, None]))
        if zone in self.splines:
            out += self.splines[zone].density(left, right)
        return out

    def angular_slope(self, zone: int, left: Array, right: Array) -> Array:
        """d/dtheta of `density` at points that are no jumps, by differences."""
        angle = theta(left, right)
        step = np.minimum(_STEP, 0.5 * np.minimum(angle, np.pi - angle))

        def value(at: Array) -> Array:
            return self.density(zone, 2 * np.cos(0.5 * at) ** 2, 2 * np.sin(0.5 * at) ** 2)

        return np.asarray((value(angle + step) - value(angle - step)) / (2 * step))

    def beside_kinks(self, zone: int, nearest: float, theta: Array) -> Array:
        """Angles of a zone at which its density is asked for: those given, and right beside the largest kinks, but none nearer
        to a kink than `nearest` over w, or than a quarter of the kinks' mean distance; without kinks, beside jumps of the next order, at
        which the density is steepest."""
        k = self.by_zone[zone]
        k = k[self.order[k] == self.order[k].min(initial=2)]
        if len(k) == 0 or self.order[k[0]] > 1:
            return theta
        away, s = min(nearest, 0.25 / len(k)), np.sort(self.s[k])
        largest = self.s[k[np.argsort(-np.abs(self.height[k]))[:_KINKS]]]
        t = np.concatenate((np.cos(theta), largest - away, largest + away))
        place = np.searchsorted(s, t)
        distance = np.minimum(np.abs(t - s[np.maximum(place - 1, 0)]), np.abs(t - s[np.minimum(place, len(s) - 1)]))
        return np.asarray(np.arccos(t[(distance > 0.999 * away) & (np.abs(t) < 1)]))

    def transform(self, zone: int, z: Array, rho: Array) -> Array:
        """Transform of a zone's parts off the zone: by their closed forms, or by the series of all of them together where
        that is shorter or the closed forms cancel."""
        k = self.by_zone[zone]
        terms = self._terms(k, rho)
        out = np.empty(len(rho))
        near = np.flatnonzero(terms == 0)
        out[near] = self._summed(k, len(near), lambda here: self.off_zone(k, z[near[here], None], rho[near[here], None]))
        for count in np.unique(terms[terms > 0]):
            here = np.flatnonzero(terms == count)
            out[here] = far_transform(self._series(zone)[:count], rho[here])
        if zone in self.splines:
            out += self.splines[zone].transform_off(z, rho)
        return out

    @staticmethod
    def _terms(k: Index, rho: Array) -> Index:
        """How many terms of the series of jumps k take the place of their closed forms at rho; 0: none."""
        terms = np.zeros(len(rho), dtype=np.intp)
        for reach, count in _SERIES_TO:
            if reach <= _FAR or count <= 8 * len(k):
                terms[(terms == 0) & (np.abs(rho) < reach)] = count
        return terms

    def _series(self, zone: int) -> Array:
        """Coefficients of T_l / sqrt(1 - t^2) of all parts of a zone together."""
        if zone not in self._sums:
            # With the zones after it, which are asked for next: one by one takes several times as long.
            zones = [other for other in self.by_zone if zone <= other < zone + _TOGETHER]
            row = np.repeat(np.arange(len(zones)), [len(self.by_zone[other]) for other in zones])
            k = np.concatenate([self.by_zone[other] for other in zones])
            self._sums.update(zip(zones, self.coefficients(k, row, len(zones), _SERIES_TO[-1][1]), strict=True))
        return self._sums[zone]

    @cached_property
    def _sums(self) -> dict[int, Array]:
        return {}

    def adds_to(self, zone: int) -> bool:
        """Whether `smooth_part` has anything to add on a zone."""
        return zone in self.by_zone

    def own_transform(self, zone: int, left: Array) -> Array:
        """Transform of a zone's parts on the zone itself: minus what they add to make g smooth."""
        return -self.smooth_part(zone, left)

    def left_out(self, x: Array) -> Array:
        """What the right side has at points x beyond the values that the caller gives: nothing."""
        return np.zeros(x.shape)

    def integral(self, zone: int, left: Array, right: Array) -> Array:
        """Integral of a zone's parts from its left end, at distances from the ends over w, of kinks alone:
        int kappa dt = (t - s) kappa - theta sin(phi)."""
        k = self.by_zone[zone]
        if np.any(self.order[k] > 0):
            raise ValueError("the integral along a zone is for kinks alone, or for densities without jumps of the right side")
        away, own = left[:, None] - self.left[k], self.shape(k, left[:, None], right[:, None])
        behind = theta(right, left)
        parts = np.where(away == 0, 0.0, away) * np.where(away == 0, 0.0, own) + self.sine[k] * behind[:, None]
        return np.asarray(parts @ (self.height[k] / np.pi))

    def sharp_potential(self, zone: int, left: Array, right: Array, rho: Array) -> Array:
        """Potential of a zone's closed parts over w, less c_0 log(w), at points by their distances from its ends over w,
        positive on the zone, and rho off it (see the head of this file)."""
        out = self._by_reach(self.by_zone[zone], left, right, rho)
        if zone in self.splines:
            out += self.splines[zone].potential(left, right, rho)
        return out

    def _by_reach(self, k: Index, left: Array, right: Array, rho: Array) -> Array:
        """Potential of jumps k of one zone: by their series far from it, where the closed forms cancel."""
        out, on = np.empty(left.shape), (left >= 0) & (right >= 0)
        terms = np.where(on, 0, self._terms(k, rho))
        if terms.any():
            zone = int(self.zone[k[0]]) if len(k) else -1
            whole = zone in self.by_zone and len(k) == len(self.by_zone[zone])
            c = self._series(zone) if whole else self.coefficients(k, np.zeros_like(k), 1, _SERIES_TO[-1][1])[0]
            for count in np.unique(terms[terms > 0]):
                out[terms == count] = far_potential(c[:count], rho[terms == count])
        inside, near = np.flatnonzero(on), np.flatnonzero(~on & (terms == 0))
        l, r = left[:, None], right[:, None]
        out[inside] = self._summed(k, len(inside), lambda here: self.potential_on(k, l[inside[here]], r[inside[here]]))
        out[near] = self._summed(k, len(near), lambda here: self.potential_off(k, l[near[here]], r[near[here]], rho[near[here], None]))
        return out

    # at complex points (see `plane`) ----------------------------------------------------------------------------------
    def logarithm(self, k: Index, seen: InPlane, away: Complex) -> Complex:
        """-i log(B / A) of jumps k."""
        c, s = np.sqrt(0.5 * self.left[k]), np.sqrt(0.5 * self.right[k])
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(-1j * np.log((c - 1j * s) ** 2 * (c * seen.m[:, None] + 1j * s * seen.p[:, None]) ** 2 / away))

    def logarithm_slope(self, k: Index, seen: InPlane, away: Complex) -> Complex:
        """Its derivative by zeta."""
        return np.asarray(-self.sine[k] / (away * seen.root[:, None]))

    def polynomial_slope(self, k: Index) -> Array:
        """Derivative of P_q."""
        return np.where(self.order[k] == HIGHEST, self.sine[k], 0.0)

    def plane_potential(self, k: Index, seen: InPlane, away: Complex, log: Complex) -> Complex:
        """Potential of jumps k over w, less c_0 log(w)."""
        parts = self.potential_of(k, away, seen.zeta[:, None], log, seen.log[:, None], seen.root[:, None])
        return np.asarray(parts @ (self.height[k] / np.pi))

    @property
    def near(self) -> ExteriorLogarithms:
        """Logarithms of the right side that lie near zones, outside them."""
        return NOWHERE

    @cached_property
    def kinked(self) -> list[int]:
        """Zones with a jump of g itself."""
        return [int(i) for i in np.unique(self.zone[self.order == 0])]


def _from_left(f: Callable[[Array], Array], zones: Zones, zone: int, left: Array) -> Array:
    """f at distances from the zone's left end over its half width."""
    return f(zones.a[zone] + zones.half[zone] * left)


_NONE = ForcingJumps(np.zeros(0, np.intp), np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0, np.intp))
