r"""Exact contacts of profiles with corners: one zone in closed form, and many zones by folding.

**One zone** [a, b] has the middle m and the half width w. The slope of the profile is

    f' = c0 + c1 (x - m) + sum J H(x - s) + sum Q (x - s)_+ ,

with the unit step H and with jumps J of the slope and Q of the curvature at the places s. A point
has the angle theta and the scaled position t = cos(theta), so that
x - a : b - x = 1 + cos(theta) : 1 - cos(theta). The angle of s is phi. A unit step has the
Chebyshev series (2/pi) sum sin(k phi) cos(k theta)/k + phi/pi. So the pressure p and the load P are

    p = (E*/2 pi) sum J kappa(theta, phi)
        + (E* w/2 pi) sum Q [(t - cos phi) kappa + phi sin(theta)]
        + (E* w/2) c1 sin(theta) + (C - D cos(theta))/sin(theta),
    kappa = ln|sin((theta + phi)/2)/sin((theta - phi)/2)|,
    P = (E* w/2) sum J sin(phi) + (E* w^2/4) sum Q (phi - sin(phi) cos(phi))
        + pi E* w^2 c1/4 + pi w C.

Here D is E*/2 times the mean of f' with the weight 1/(pi sin theta). If p is bounded at b, then
C = D; if p is bounded at a, then C = -D. With walls at both ends, C is free.

With a period L there are no Q and no c1. Let A = pi w/L. The map y = tan(pi(x - m)/L)/tan A turns
Hilbert's kernel into Cauchy's kernel plus a constant. With psi = arccos(sin(pi(s - m)/L)/sin A),

    D = (E*/2)(c0 + sum J psi/pi),   the last term of p  (C - D cos(theta)/cos A)/sin(theta),
    P = (E* L/2 pi) sum J artanh(sin A sin phi) + L sin A C.

**Many zones.** Let a profile h(y) have the one zone [alpha, beta], the pressure q and the gap d.
Let Q be a polynomial or trigonometric polynomial, such that all n roots x of Q(x) = y are real for
every y of the zone. Then the profile f(x) = h(Q(x)) has the n zones Q^-1([alpha, beta]), the
pressure |Q'| q(Q(x)) and the gap d(Q(x)). The reason is sum_k K(x - xi_k) = Q'(x)/(Q(x) - y) over
the roots xi_k. Every zone has corners, all at the same heights, and no two zones are alike.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import factorial

import numpy as np
from numpy.polynomial import Polynomial as Series

import contact

NONE = np.empty((0, 2))


def rows(values):
    return np.asarray(values, dtype=float).reshape(-1, 2)


@dataclass(frozen=True, eq=False)
class Bent(contact.Profile):
    """A profile with corners; f = 0 at `middle`.

    f' = flat + bend (x - middle) + sum J H(x - s) + sum Q (x - s)_+ over jumps s right of `middle`,
    with -J H(s - x) and +Q (s - x)_+ for jumps s left of it. Rows of `steps` are (s, J), rows of
    `bends` are (s, Q). Sums outward from the middle keep a flat middle exactly flat. With a period
    the cell begins at `start`, where a valley has its corner. `walls` are the ends of the body,
    `finest` is its resolution.
    """

    middle: float
    flat: float = 0.0
    bend: float = 0.0
    steps: np.ndarray = field(default_factory=lambda: NONE)
    bends: np.ndarray = field(default_factory=lambda: NONE)
    period: float | None = None
    start: float = 0.0
    walls: tuple[float, float] | None = None
    finest: float | None = None

    x0 = property(lambda self: self.start)
    support = property(lambda self: self.walls)
    resolution = property(lambda self: self.finest)

    def _beyond(self, x, at):
        """Side of `middle` (-1 or 1) of each jump; distance of x beyond the jump, or 0."""
        side = np.where(at < self.middle, -1.0, 1.0)
        return side, np.maximum(side * (np.asarray(self.wrap(x))[..., None] - at), 0.0)

    def height(self, x):
        y = np.asarray(self.wrap(x)) - self.middle
        out = (
            y * (self.flat + 0.5 * self.bend * y)
            + self._beyond(x, self.steps[:, 0])[1] @ self.steps[:, 1]
        )
        side, past = self._beyond(x, self.bends[:, 0])
        out = out + 0.5 * past**2 @ (side * self.bends[:, 1])
        if self.walls is None:
            return out
        return np.where((x >= self.walls[0]) & (x <= self.walls[1]), out, np.inf)

    def slope(self, x):
        y = np.asarray(self.wrap(x)) - self.middle
        side, past = self._beyond(x, self.steps[:, 0])
        out = self.flat + self.bend * y + (past > 0) @ (side * self.steps[:, 1])
        return out + self._beyond(x, self.bends[:, 0])[1] @ self.bends[:, 1]

    @property
    def kinks(self):
        if self.period is None:
            return self.steps
        # f repeats, so at the border of the cell the slope jumps back by the sum of its jumps.
        return np.vstack(([[self.start, -self.steps[:, 1].sum()]], self.steps))

    @property
    def jumps(self):
        return np.column_stack((self.bends[:, 0], np.full(len(self.bends), 2.0), self.bends[:, 1]))

    @property
    def symmetric(self):
        mirrored = (
            np.array_equal(of, of[::-1] * [-1.0, sign])
            for of, sign in ((self.steps, 1.0), (self.bends, -1.0))
        )
        cell = self.period is None or self.start == -0.5 * self.period
        return bool(self.middle == 0 and self.flat == 0 and cell and all(mirrored))


def polygon(x, height, period):
    """The periodic profile of straight lines through measured points; heights count upwards."""
    ends = np.append(x, x[0] + period)
    slopes = -np.diff(np.append(height, height[0])) / np.diff(ends)
    k = len(x) // 2
    steps = np.column_stack((x[1:], np.diff(slopes)))
    return Bent(
        0.5 * (ends[k] + ends[k + 1]),
        slopes[k],
        0.0,
        steps,
        period=period,
        start=x[0],
        finest=float(np.diff(ends).min()),
    )


def _load_of_ramp(phi):
    """phi - sin(phi) cos(phi), without cancellation for small phi."""
    series = sum(
        (-1) ** (k + 1) * (2 * phi) ** (2 * k + 1) / factorial(2 * k + 1) for k in range(1, 12)
    )
    return np.where(phi < 0.5, 0.5 * series, phi - np.sin(phi) * np.cos(phi))


def _mean_of_ramp(phi):
    """sin(phi) - phi cos(phi), without cancellation for small phi."""
    series = sum(
        (-1) ** (k + 1) * 2 * k * phi ** (2 * k + 1) / factorial(2 * k + 1) for k in range(1, 12)
    )
    return np.where(phi < 1, series, np.sin(phi) - phi * np.cos(phi))


@dataclass(frozen=True, eq=False)
class CorneredZone:
    """Exact contact of a `Bent` profile on one zone (a, b), by the formulas of this file.

    The slope left of the zone is chosen so that the contact is this zone; see `profile`. For
    walls at both ends, `punch` is C - |D| (C - |D|/cos A with a period) and `tilted` is
    D/(E*/2).
    """

    zone: tuple[float, float]
    steps: np.ndarray = field(default_factory=lambda: NONE)
    bends: np.ndarray = field(default_factory=lambda: NONE)
    bend: float = 0.0
    E_star: float = 1.0
    period: float | None = None
    punch: float = 0.0
    tilted: float = 0.0

    @property
    def zones(self):
        return np.array([self.zone])

    @property
    def zone_widths(self):
        return np.diff(self.zones).ravel()

    @property
    def half(self):
        return 0.5 * (self.zone[1] - self.zone[0])

    def _sine(self, distance):
        """sin(pi d/L), or d itself without a period: a distance d as in the formulas."""
        return (
            np.asarray(distance)
            if self.period is None
            else np.sin(np.pi / self.period * np.asarray(distance))
        )

    def _angle(self, left, right):
        """The angle theta of points, from their distances to the left and the right end."""
        left, right = self._sine(left), self._sine(right)
        return 2 * np.arctan2(np.sqrt(np.maximum(right, 0.0)), np.sqrt(np.maximum(left, 0.0)))

    @property
    def middle(self):
        return 0.5 * (self.zone[0] + self.zone[1])

    def _from_end(self, places):
        """Angles of jumps from the nearer end of the zone, and the signs of their halves.

        The angle is 0 for a jump outside the zone.
        """
        a, b = self.zone
        s = np.clip(places, a, b)
        left = s < self.middle
        return self._angle(np.where(left, b - s, s - a), np.where(left, s - a, b - s)), np.where(
            left, -1.0, 1.0
        )

    @property
    def turn(self):
        """A = pi w/L; 0 without a period."""
        return 0.0 if self.period is None else np.pi * self.half / self.period

    @property
    def cosine(self):
        """cos A, computed from the gap between the zone and its next image to keep digits."""
        a, b = self.zone
        return (
            1.0
            if self.period is None
            else np.sin(0.5 * np.pi / self.period * (a + self.period - b))
        )

    @cached_property
    def profile(self):
        """The profile whose contact is this zone.

        A periodic profile has a corner in its valley, outside the zone, which makes it
        periodic.
        """
        a, b = self.zone
        side, bent = self._from_end(self.steps[:, 0])[1], self._from_end(self.bends[:, 0])[0]
        s = np.clip(self.steps[:, 0], a, b)
        # sin(A - u) sin(A + u) = sin^2 A - sin^2 u. The angle psi is measured from the zone's
        # nearer end.
        psi = np.arctan2(
            np.sqrt(self._sine(s - a) * self._sine(b - s)), self._sine(np.abs(s - self.middle))
        )
        # Steps and bends are summed separately, so that equal terms of the two halves cancel.
        mean = (self.steps[:, 1] * side * psi).sum() + self.half * (
            self.bends[:, 1] * _mean_of_ramp(bent)
        ).sum()
        flat = self.tilted - mean / np.pi
        walls = self.zone if self.punch > 0 else None
        if self.period is None:
            return Bent(self.middle, flat, self.bend, self.steps, self.bends, walls=walls)
        at, J = self.steps.T
        first = flat - J[at < self.middle].sum()
        # f is periodic if first L + sum J (v - s) = 0, with the right border v of the cell.
        v = (J @ at - first * self.period) / J.sum() if len(J) else b + 0.5 * (self.period - b + a)
        assert b < v < a + self.period and np.all((at > v - self.period) & (at < v)), (
            "the valley falls into the zone"
        )
        return Bent(self.middle, flat, 0.0, self.steps, NONE, self.period, v - self.period, walls)

    @property
    def excess(self):
        return self.punch + 0.5 * self.E_star * abs(self.tilted) / self.cosine

    @property
    def load(self):
        phi, E, w = self._from_end(self.steps[:, 0])[0], self.E_star, self.half
        J = self.steps[:, 1]
        if self.period is not None:
            # artanh z = ln((1 + z)/sqrt(1 - z^2)) with z = sin A sin phi.
            # Here 1 - z^2 = (cos A/cos u)^2 with u = pi (s - m)/L.
            inside = phi > 0
            u = np.pi / self.period * (self.steps[inside, 0] - self.middle)
            grown = np.log((1 + np.sin(self.turn) * np.sin(phi[inside])) * np.cos(u) / self.cosine)
            bounded = E * self.period / (2 * np.pi) * J[inside] @ grown
            return float(bounded + self.period * np.sin(self.turn) * self.excess)
        at, side = self._from_end(self.bends[:, 0])
        curved = (
            0.25 * E * w**2 * (self.bends[:, 1] @ (side * _load_of_ramp(at)) + np.pi * self.bend)
        )
        return float(0.5 * E * w * J @ np.sin(phi) + curved + np.pi * w * self.excess)

    def pressure_at(self, t, zone=0):
        t = np.asarray(t, dtype=float)
        w, E = self.half, self.E_star
        left, right = w * (1 + t), w * (1 - t)
        theta = self._angle(left, right)
        out = 0.5 * E * w * self.bend * np.sin(theta)
        for s, size in self.steps:
            out = out + E * size / (2 * np.pi) * self._kappa(left, right, s)[0]
        for s, size in self.bends:
            kappa, away = self._kappa(left, right, s)
            phi, side = self._from_end(s)
            bent = away * np.where(away == 0, 0.0, kappa) + w * side * phi * np.sin(theta)
            out = out + E * size / (2 * np.pi) * bent
        if self.punch == 0 and self.tilted == 0:
            return out
        with np.errstate(divide="ignore", invalid="ignore"):
            lean = 0.5 * E * self.tilted / self.cosine
            return out + (self.excess - lean * np.cos(theta)) / np.sin(theta)

    def _kappa(self, left, right, s):
        """kappa for a jump at s (0 outside the zone), and x - s, for points x.

        The points are given by their distances to both ends, which keep digits near the ends.
        """
        a, b = self.zone
        away = left - (s - a)
        if not a < s < b:
            return np.zeros_like(left), away
        up, down = (
            np.sqrt(self._sine(right) * self._sine(s - a)),
            np.sqrt(self._sine(left) * self._sine(b - s)),
        )
        small, large = np.minimum(up, down), np.maximum(up, down)
        with np.errstate(divide="ignore", invalid="ignore"):
            # up^2 - down^2 = sin(b - a) sin(s - x)
            near = np.log((up + down) ** 2 / np.abs(self._sine(b - a) * self._sine(away)))
            return np.where(
                small < 0.5 * large, 2 * np.arctanh(np.minimum(small / large, 0.5)), near
            ), away

    def pressure(self, x):
        x = np.asarray(x, dtype=float)
        if self.period is not None:
            x = x - self.period * np.round((x - self.middle) / self.period)
        inside = (x > self.zone[0]) & (x < self.zone[1])
        t = np.where(inside, ((x - self.zone[0]) - (self.zone[1] - x)) / (2 * self.half), 0.0)
        return np.where(inside, self.pressure_at(t), 0.0)

    def slope(self, x):
        return self.profile.slope(x)

    @property
    def max_pressure(self):
        a, b = self.zone
        infinite = (
            self.punch > 0
            or self.tilted != 0
            or np.any((self.steps[:, 0] > a) & (self.steps[:, 0] < b))
        )
        return np.inf if infinite else float(np.max(self.pressure_at(np.linspace(-1, 1, 20001))))


@dataclass(frozen=True)
class Wave:
    """Q(x) = sum c_k cos(2 pi k x/L) + s_k sin(2 pi k x/L), k = 1 ...: its roots and derivatives."""

    cosine: tuple[float, ...]
    sine: tuple[float, ...]
    period: float

    def derivative(self, x, n=0):
        k = 2 * np.pi / self.period * np.arange(1, len(self.cosine) + 1)
        z = (np.array(self.cosine) - 1j * np.array(self.sine)) * (1j * k) ** n
        return np.real(np.exp(1j * np.asarray(x)[..., None] * k) @ z)

    def roots(self, y):
        n = len(self.cosine)
        z = 0.5 * (np.array(self.cosine) - 1j * np.array(self.sine))
        powers = np.concatenate((np.conj(z[::-1]), [-y], z))
        found = np.roots(powers[::-1])
        x = self.period / (2 * np.pi) * np.angle(found[np.abs(np.abs(found) - 1) < 1e-6])
        assert len(x) == 2 * n
        return np.sort(polished(self, x, y))


@dataclass(frozen=True)
class Power:
    """The polynomial Q(x), lowest power first: its derivatives and roots."""

    coefficients: tuple[float, ...]
    period = None

    def derivative(self, x, n=0):
        series = Series(self.coefficients)
        return (series.deriv(n) if n else series)(np.asarray(x, dtype=float))

    def roots(self, y):
        found = (Series(self.coefficients) - y).roots()
        x = np.real(found[np.abs(np.imag(found)) < 1e-6])
        assert len(x) == len(self.coefficients) - 1
        return np.sort(polished(self, x, y))


def polished(map_, x, y):
    for _ in range(4):
        x = x - (map_.derivative(x) - y) / map_.derivative(x, 1)
    return x


@dataclass(frozen=True, eq=False)
class FoldedProfile(contact.Profile):
    """The profile h(Q(x)). It has the jumps of h on every monotone branch of Q."""

    map_: Wave | Power
    base: contact.Profile
    period: float | None = None

    def height(self, x):
        return self.base.height(self.map_.derivative(self.wrap(x)))

    def slope(self, x):
        x = self.wrap(x)
        return self.base.slope(self.map_.derivative(x)) * self.map_.derivative(x, 1)

    @cached_property
    def _places(self):
        """(place, jump of h', jump of h'') in every branch of Q; jumps count for growing y."""
        J, Q = self.base.steps, self.base.bends
        return [(x, size, 0.0) for y, size in J for x in self.map_.roots(y)] + [
            (x, 0.0, size) for y, size in Q for x in self.map_.roots(y)
        ]

    @property
    def kinks(self):
        return rows([(x, J * abs(self.map_.derivative(x, 1))) for x, J, _ in self._places if J])

    @property
    def jumps(self):
        """Jumps of f'' = h'' Q'^2 + h' Q'' and of f''' = h''' Q'^3 + 3 h'' Q' Q'' + h' Q'''.

        A jump of h counts with the sign of Q'.
        """
        out = []
        for x, J, Q in self._places:
            d = [self.map_.derivative(x, n) for n in (1, 2, 3)]
            side = np.sign(d[0])
            out.append((x, 2, side * (J * d[1] + Q * d[0] ** 2)))
            out.append((x, 3, side * (J * d[2] + 3 * Q * d[0] * d[1])))
        return np.array(out).reshape(-1, 3)

    @property
    def resolution(self):
        return None if self.period is None else self.period / (4 * len(self.map_.cosine))


@dataclass(frozen=True, eq=False)
class FoldedContact:
    """The contact of the profile h(Q(x)), computed from the contact of h(y)."""

    map_: Wave | Power
    base: CorneredZone

    @property
    def E_star(self):
        return self.base.E_star

    @property
    def period(self):
        return self.map_.period

    @cached_property
    def profile(self):
        return FoldedProfile(self.map_, self.base.profile, self.map_.period)

    @cached_property
    def zones(self):
        low, high = (self.map_.roots(y) for y in self.base.zone)
        both = np.sort(np.concatenate((low, high)))
        between = self.map_.derivative(0.5 * (both[0] + both[1]))
        if self.period is not None and not self.base.zone[0] < between < self.base.zone[1]:
            both = np.append(both[1:], both[0] + self.period)
        return both.reshape(-1, 2)

    @property
    def zone_widths(self):
        return np.diff(self.zones).ravel()

    @property
    def load(self):
        return self.base.load * len(self.zones)

    def pressure_at(self, t, zone=0):
        a, b = self.zones[zone]
        return self.pressure(0.5 * (a + b) + 0.5 * (b - a) * np.asarray(t, dtype=float))

    def pressure(self, x):
        """|Q'| q(Q(x)). For x outside the zones, Q(x) is outside the zone of h, where q = 0."""
        return np.abs(self.map_.derivative(x, 1)) * self.base.pressure(self.map_.derivative(x))

    def slope(self, x):
        return self.profile.slope(x)

    @property
    def max_pressure(self):
        if np.isinf(self.base.max_pressure):
            return np.inf
        return float(
            np.max([self.pressure_at(np.linspace(-1, 1, 20001), k) for k in range(len(self.zones))])
        )
