"""Holes in wide zones: where the density vanishes and the equation is released by an unknown s.

On a wide zone with holes the equation reads T[phi] = g - s, s zero off the holes and with no integral over any of them. Writing
phi = c + P[s], c the density of the smooth part, its own operator gives P[s] in closed form: with X = sqrt(1 - t^2),
sigma = s X and z the hole's own coordinate,

    X P[s] = (1/pi) PV int sigma / (t - tau) dtau,          T[P[s]] = -s on the zone,

so that phi = 0 on the holes is the same equation once more, with sigma = sum d_l T_l(z) / sqrt(1 - z^2) on each:

    sum d_l U_(l-1)(z) = sum c_k T_k(t) + X (jumps) + (what the other holes of the zone do),       int sigma / X = 0.

Off its own zone P[s] acts through its coefficients s_k = (2/pi) int s sin(k phi) dtau alone. (From Sum sin(k phi) cos(k theta)
= sin(phi) / 2 (cos(theta) - cos(phi)); derived here, see docs/theory.)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from sie.basis import chebyshev
from sie.basis.kept import Kept
from sie.jumps.forcing import HIGHEST, Steps
from sie.jumps.zone_spline import ZoneSpline
from sie.slits.kinks import Valley
from sie.slits.merged import Cut

Array = NDArray[np.float64]
Index = NDArray[np.intp]

LEAST, MOST = 12, 512
# Modes at most for a jump of g, of g' or of g'' beside a hole: of those in it nothing is left.
_BENT = (64, 256, 160)
# Coefficients of s that are told to the other zones, at least.
TOLD = 48


@dataclass(frozen=True, eq=False)
class Hole(Kept):
    """One hole of a wide zone, in units of that zone's half width: distances of its ends from the zone's ends, its half
    width; `modes`: the highest order of its series; `width`: half width in units of length."""

    start: float
    rest: float
    half: float
    width: float
    modes: int

    def angle(self, left: Array, right: Array) -> Array:
        """Angle theta in the wide zone, t = cos(theta), at distances from the hole's ends over its half width."""
        from_left, from_right = self.start + self.half * left, self.rest + self.half * right
        return np.asarray(2 * np.arctan2(np.sqrt(from_right), np.sqrt(from_left)))

    def root(self, left: Array, right: Array) -> Array:
        """X = sqrt(1 - t^2) there."""
        return np.sqrt((self.start + self.half * left) * (self.rest + self.half * right))

    @cached_property
    def nodes(self) -> int:
        """Gauss nodes for means over the hole."""
        return 2 * self.modes + 16

    @cached_property
    def gauss(self) -> tuple[Array, Array]:
        """(1 + z, 1 - z) at the Gauss nodes."""
        theta = (np.arange(self.nodes) + 0.5) * np.pi / self.nodes
        return 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2

    @cached_property
    def theta(self) -> Array:
        """Angles in the wide zone of the Gauss nodes."""
        return self.angle(*self.gauss)

    @cached_property
    def x_root(self) -> Array:
        return self.root(*self.gauss)

    def means(self, values: Array) -> Array:
        """Means of values (..., nodes) times T_l, l = 0 ... modes, with the weight 1 / sqrt(1 - z^2)."""
        return np.asarray(values @ chebyshev.t_matrix(self.nodes, self.modes + 1) / self.nodes)

    def at_gauss(self, d: Array) -> Array:
        """sum d_l T_l at the Gauss nodes."""
        return np.asarray(chebyshev.t_matrix(self.nodes, len(d)) @ d)

    def over(self, d: Array, power: int) -> Array:
        """T coefficients of sum d_l T_l / X^power."""
        values = self.at_gauss(d) / self.x_root**power
        out = 2 * chebyshev.t_means(values)
        out[0] *= 0.5
        return np.asarray(out)

    @cached_property
    def total_row(self) -> Array:
        """int s over the hole, by d."""
        return self.means(1 / self.x_root)

    @cached_property
    def mean_row(self) -> Array:
        """Mean over the wide zone of the integral of s (weight 1 / sqrt(1 - t^2)), by d."""
        middle = self.angle(np.ones(1), np.ones(1))
        return self.width * self.means((self.theta - middle) / self.x_root)

    def told(self, count: int) -> Array:
        """(count + 1, modes + 1): s_k by d, k = 0 ... count."""
        k = np.arange(count + 1)[:, None]
        return 2 * self.half * self.means(np.sin(k * self.theta) / self.x_root)


def beyond(excess: Array, sign: float, d: Array) -> Array:
    """(1/pi) PV int sigma / (t - tau) of T_l / sqrt series d, off the hole: at |z| - 1 = excess on the side `sign`."""
    root = np.sqrt(excess * (excess + 2))
    rho = sign / (1 + excess + root)
    alpha, beta, u = chebyshev.bounded_part(d[None])
    value = rho * np.polynomial.polynomial.polyval(rho, u[0]) if u.shape[1] else np.zeros_like(rho)
    edge = alpha[0] + beta[0] * rho
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(value + np.where(edge == 0, 0.0, sign * edge / root))


def beyond_rows(excess: Array, sign: float, count: int) -> Array:
    """What each of `count` terms does off the hole: (points, count)."""
    root = np.sqrt(excess * (excess + 2))
    rho = sign / (1 + excess + root)
    return np.asarray(sign * rho[:, None] ** np.arange(count) / root[:, None])


def _within(steps: Steps, zone: int, start: Array, length: Array) -> tuple[Index, Steps]:
    """(the jumps of a zone that lie in holes with these starts and lengths, by number; those of its spline's knots there)."""

    def inside(left: Array) -> NDArray[np.bool_]:
        hole = np.maximum(np.searchsorted(start, left, side="right") - 1, 0)
        return np.asarray((left > start[hole]) & (left < start[hole] + length[hole]))

    closed = steps.by_zone.get(zone, np.zeros(0, dtype=np.intp))
    closed = closed[inside(steps.left[closed])]
    spline = steps.splines.get(zone)
    if spline is None:
        return closed, Steps.none()
    assert isinstance(spline, ZoneSpline)
    some = np.flatnonzero(inside(spline.knots))
    left = spline.knots[some]
    count = len(some)
    return closed, Steps(np.full(count, zone), left, 2 - left, spline.jumps[some], np.full(count, HIGHEST))


class Holes(Kept):
    """The holes of one wide zone, and the density there made zero by them."""

    def __init__(self, cut: Cut, zone: int, modes: int, steps: Steps) -> None:
        self.zone = zone
        self.which = np.flatnonzero(cut.hole_zone == zone)
        a, b = cut.holes.a[self.which], cut.holes.b[self.which]
        w = self.w = float(cut.wide.half[zone])
        start, rest = (a - cut.wide.a[zone]) / w, (cut.wide.b[zone] - b) / w
        half = 0.5 * (b - a)
        # Distances to the far ends of the pieces on both sides, and to jumps: the nearest singularities.
        before = np.concatenate(([start[0] * w], a[1:] - b[:-1]))
        after = np.concatenate((a[1:] - b[:-1], [rest[-1] * w]))
        near = np.minimum(before, after) / half
        self._inside, self._knots = _within(steps, zone, start, 2 * half / w)
        self.valleys = [
            (i, Valley(height, float(start[i]), float(rest[i]), float(half[i]) / w, left, right, order))
            for jumps in (steps.chosen(self._inside), self._knots)
            for i, height, left, right, order in zip(
                (np.searchsorted(start, jumps.left, side="right") - 1).tolist(), jumps.height.tolist(), jumps.left.tolist(),
                jumps.right.tolist(), jumps.order.tolist(), strict=True,
            )
        ]
        sharp = np.setdiff1d(np.flatnonzero((steps.zone == zone) & (steps.order == 0)), self._inside)
        if len(sharp):
            away = np.abs(steps.left[sharp][:, None] - (start + half / w)) * w / half - 1
            near = np.minimum(near, away.min(axis=0))
        middle = 2 * np.arctan2(np.sqrt(rest + half / w), np.sqrt(start + half / w))
        waves = modes * half / w / np.sin(middle)
        need = 37 / np.arccosh(1 + np.maximum(near, 1e-4)) + 2 * waves
        if zone in steps.by_zone:
            # Jumps beside the hole: of their weak singularities the series soon leaves little.
            place, order = steps.places(zone)
            other = ~np.isin(place, np.append(steps.left[self._inside], self._knots.left))
            place, order = place[other], order[other]
            away = np.maximum(np.abs(place[:, None] - (start + half / w)) * w / half - 1, 1e-4)
            most = np.array(_BENT)[order][:, None]
            need = np.maximum(need, np.minimum(37 / np.arccosh(1 + away), most).max(axis=0, initial=0.0))
        size = np.clip(np.ceil(need), LEAST, MOST).astype(int)
        self.holes = [
            Hole(float(s), float(r), float(h) / w, float(h), int(n)) for s, r, h, n in zip(start, rest, half, size, strict=True)
        ]
        self.a, self.b = a, b
        self.offset = np.concatenate(([0], np.cumsum([hole.modes + 1 for hole in self.holes])))
        self.modes = modes
        self._angles = [self._lobatto(hole) for hole in self.holes]

    @staticmethod
    def _lobatto(hole: Hole) -> tuple[Array, Array]:
        _, right, left = chebyshev.lobatto(hole.modes)
        return left[1:-1], right[1:-1]

    def split(self, d: Array) -> list[Array]:
        return [d[s:e] for s, e in zip(self.offset[:-1], self.offset[1:], strict=True)]

    @cached_property
    def by_coefficients(self) -> Array:
        """Right sides of the holes' rows by the zone's smooth coefficients c_0 ... c_modes."""
        return self._rows(lambda hole, left, right: np.cos(hole.angle(left, right)[:, None] * np.arange(self.modes + 1)))

    def of_steps(self, steps: Steps) -> Array:
        """Right sides of the holes' rows by the jumps; those in a hole with the release they ask for."""
        if self.zone not in steps.by_zone:
            return np.zeros(self.offset[-1])
        keep = np.delete(np.arange(len(steps.zone)), self._inside)
        rest = replace(
            steps, zone=steps.zone[keep], left=steps.left[keep], right=steps.right[keep], height=steps.height[keep],
            order=steps.order[keep],
        )
        out = self._of_valleys()
        if self.zone not in rest.by_zone:
            return out

        def values(hole: Hole, left: Array, right: Array) -> Array:
            from_left, from_right = hole.start + hole.half * left, hole.rest + hole.half * right
            density = rest.density(self.zone, from_left, from_right)
            if len(self._knots):
                density -= self._knots.density(self.zone, from_left, from_right)
            return (hole.root(left, right) * density)[:, None]

        return out + self._rows(values)[:, 0]

    def _of_valleys(self) -> Array:
        """Right sides of the holes' rows by the jumps in them, and what their psi leaves to the integrals of s."""
        out = np.zeros(self.offset[-1])
        for i, valley in self.valleys:
            out[self.offset[i]] -= valley.total

            def values(hole: Hole, left: Array, right: Array, valley: Valley = valley) -> Array:
                from_left, from_right = hole.start + hole.half * left, hole.rest + hole.half * right
                own = hole.start == valley.start
                z = 0.5 * (left - right) if own else (from_left - valley.start) / valley.half - 1
                return valley.in_hole(from_left, from_right, z)[:, None]

            out += self._rows(values)[:, 0]
        return out

    def _rows(self, values) -> Array:  # type: ignore[no-untyped-def]
        """Projections on each hole, below a row for its condition."""
        blocks = []
        for hole, (left, right) in zip(self.holes, self._angles, strict=True):
            rows = chebyshev.project_rows(values(hole, left, right))
            blocks.append(np.concatenate((np.zeros((1, rows.shape[1])), rows)))
        return np.concatenate(blocks)

    @cached_property
    def _factors(self) -> tuple[Array, Index]:
        matrix = np.zeros((self.offset[-1], self.offset[-1]))
        for i, hole in enumerate(self.holes):
            rows = slice(self.offset[i] + 1, self.offset[i + 1])
            left, right = self._angles[i]
            for j, other in enumerate(self.holes):
                columns = slice(self.offset[j], self.offset[j + 1])
                if i == j:
                    matrix[self.offset[i], columns] = hole.total_row
                    matrix[rows, columns] = np.eye(hole.modes, hole.modes + 1, 1)
                    continue
                if j < i:
                    away, sign = self.a[i] - self.b[j] + hole.width * left, 1.0
                else:
                    away, sign = self.a[j] - self.b[i] + hole.width * right, -1.0
                matrix[rows, columns] = -chebyshev.project_rows(beyond_rows(away / other.width, sign, other.modes + 1))
        lu, pivots = lu_factor(matrix, check_finite=False)
        return lu, pivots

    def solve(self, right: Array) -> Array:
        """d of all holes from the right sides of their rows."""
        return np.asarray(lu_solve(self._factors, right, check_finite=False))

    @cached_property
    def told(self) -> Array:
        """(count + 1, all d): s_k of the zone, k = 0 ... max(modes, TOLD)."""
        return np.concatenate([hole.told(max(self.modes, TOLD)) for hole in self.holes], axis=1)

    @cached_property
    def told_by_valleys(self) -> Array:
        """What the jumps in holes add to s_k."""
        count = max(self.modes, TOLD)
        return np.sum([np.zeros(count + 1), *(valley.told(count) for _, valley in self.valleys)], axis=0)

    @property
    def mean_of_valleys(self) -> float:
        """What the jumps in holes add to the mean over the zone of the integral of s."""
        return self.w * sum(valley.mean_opening for _, valley in self.valleys)

    @cached_property
    def mean_row(self) -> Array:
        """Mean over the zone of the integral of s, by all d."""
        return np.concatenate([hole.mean_row for hole in self.holes])
