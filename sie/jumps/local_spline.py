r"""A quadratic spline inside one zone, known point by point: what takes the place of hundreds of
truncated powers.

Of n jumps of a second derivative, truncated powers grow to n^2 times their sum. The spline f with
these jumps is a sum of B-splines sum_j d_j B_j, each no wider than three pieces, d_j = 2 f((u +
v)/2) - (f(u) + f(v))/2 with u, v the inner knots of B_j (its blossom; L. Ramshaw, Comput. Aided
Geom. Des. 6 (1989) 323-358). Those that lie inside the zone make a part of the density that is
nowhere larger than f, and leave jumps at the first and last three knots alone. Places are distances
from the zone's left end over its half width.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

from sie.basis.data import Array, Index, Kept, Mask, legendre, record
from sie.basis.interval import Complex, InPlane, Outside, What, of_t, sides
from sie.basis.kernels import cauchy
from sie.basis.sums import pair_blocks, waves
from sie.trees.piecewise import PiecewiseTransform
from sie.trees.tree import TERMS

# From this number of jumps on: below, their powers lose few digits, and the closed forms of all of
# them are as fast.
MANY = 400
# Knots nearer to an end of the zone than this are no knots of the spline. (Beyond one, g changes by
# its jump times the square of that.)
NEAREST = 1e-9
# Jumps that are left over inside, over the largest: more than rounding leaves means that f is no
# quadratic spline.
_SAME = 1e-8
_ROUNDED = 1e-14
# Nodes on a piece, and the largest angle by which cos(l theta) turns on it.
_NODES = 8
_TURN = 1.5
# Gauss nodes on a piece, seen from farther than so many of its lengths.
_GAUSS = 8
_NEARBY = 2.5
# Up to this place on either side of the spline its transform is a series on cells; beyond, one of
# the whole.
_REACH = 4.0


def same_jumps(found: Array, wanted: Array, length: Array, size: float) -> bool:
    """Whether the jumps found between pieces of such lengths are those wanted, as far as rounding
    of values of such a size allows.
    """
    rounding = _ROUNDED * size / np.minimum(length[1:], length[:-1]) ** 2
    return not np.any(
        np.abs(found - wanted) > np.maximum(_SAME * np.abs(wanted).max(initial=0.0), rounding)
    )


def with_jumps(knots: Array, jumps: Array) -> Callable[[Array], Array]:
    """Of all quadratic splines on a zone with these jumps at its knots, half of those of the second
    derivative, the one whose squares add up to least: where f is more than such a spline, this is
    the part of it that jumps.
    """
    ends = np.concatenate(([0.0], knots, [2.0]))
    length, bend, before = np.diff(ends), np.concatenate(([0.0], np.cumsum(jumps))), np.zeros(3)
    for _ in range(2):
        # Once more from what is left: the first time a trend may hide what it goes beside.
        slope = before[1] + np.concatenate(([0.0], np.cumsum(2 * bend * length)[:-1]))
        value = before[0] + np.concatenate(([0.0], np.cumsum(length * (slope + bend * length))))
        trend = np.polynomial.polynomial.polyfit(ends, value, 2)
        bend, before = bend - trend[2], before - trend
    first = ends[:-1]
    pieces = np.column_stack(
        (
            value[:-1] - trend[0] - first * (trend[1] + first * trend[2]),
            slope - trend[1] - 2 * first * trend[2],
            bend,
        )
    )

    def of(x: Array) -> Array:
        i = np.clip(np.searchsorted(ends, x, side="right") - 1, 0, len(pieces) - 1)
        y, part = x - ends[i], pieces[i]
        return np.asarray(part[..., 0] + y * (part[..., 1] + y * part[..., 2]))

    return of


@record
class LocalSpline(Kept):
    """knots: (n,) ascending; pieces: (n - 1, 3) coefficients of powers of the distance from each
    piece's left knot.
    """

    knots: Array
    pieces: Array

    @classmethod
    def of(cls, knots: Array, control: Array) -> "LocalSpline":
        """With the middle control points of its pieces, zero at the first and at the last knot;
        where the first and the last of these points are zero, so is its slope.
        """
        length = np.diff(knots)
        at_knots = np.zeros(len(knots))
        at_knots[1:-1] = (length[1:] * control[:-1] + length[:-1] * control[1:]) / (
            length[1:] + length[:-1]
        )
        first, last = at_knots[:-1], at_knots[1:]
        return cls(
            knots,
            np.column_stack(
                (first, 2 * (control - first) / length, (first - 2 * control + last) / length**2)
            ),
        )

    @classmethod
    def inside(
        cls, knots: Array, jumps: Array, f: Callable[[Array], Array]
    ) -> "tuple[LocalSpline, Array, Array] | None":
        """(the B-splines of f between these knots, what is left of the jumps: half of those of the
        second derivative; places and heights of others: none); None if f has other jumps than
        these.
        """
        within = np.flatnonzero(np.minimum(knots, 2 - knots) > NEAREST)
        knots = knots[within]
        u, v = knots[1:-2], knots[2:-1]
        values = np.asarray(f(knots))
        d = np.concatenate(
            ([0.0], 2 * np.asarray(f(0.5 * (u + v))) - 0.5 * (values[1:-2] + values[2:-1]), [0.0])
        )
        spline, length = cls.of(knots, d), np.diff(knots)
        found = np.diff(spline.pieces[:, 2], prepend=0.0, append=0.0)
        if not same_jumps(
            found[3:-3], jumps[within][3:-3], length[2:-2], float(np.abs(values).max())
        ):
            return None
        left = jumps.copy()
        left[within] -= found
        left[within[3:-3]] = 0.0
        return spline, left, np.zeros((2, 0))

    def _locate(self, x: Array) -> tuple[Index, Array, Mask]:
        i = np.searchsorted(self.knots, x, side="right") - 1
        inside = (i >= 0) & (i < len(self.pieces))
        i = np.clip(i, 0, len(self.pieces) - 1)
        return i, x - self.knots[i], inside

    def __call__(self, x: Array) -> Array:
        i, y, inside = self._locate(x)
        p = self.pieces[i]
        return np.where(inside, p[..., 0] + y * (p[..., 1] + y * p[..., 2]), 0.0)

    def density(self, left: Array, right: Array) -> Array:
        """What it is of the density at distances from both ends of the zone."""
        return self(left)

    @property
    def jumps(self) -> Array:
        """Half of the jumps of its second derivative at the knots."""
        return np.diff(self.pieces[:, 2], prepend=0.0, append=0.0)

    @property
    def mean_offset(self) -> float:
        raise ValueError("a condition on potentials is for right sides without logarithms")

    def potential(self, left: Array, right: Array, rho: Array) -> Array:
        raise ValueError("the potential of a spline of the density is no closed form")

    def transform_off(self, z: Array, rho: Array) -> Array:
        """What the kernel makes of it off the zone, at z counted from its middle."""
        return self.own_transform(1 + z)

    @property
    def edge_slopes(self) -> tuple[float, float]:
        """Coefficient of the angle from either end: it is zero there."""
        return 0.0, 0.0

    @property
    def size(self) -> float:
        return float(np.abs(self.pieces[:, 0]).max())

    @cached_property
    def _before(self) -> Array:
        """Integral up to each knot."""
        y, p = np.diff(self.knots), self.pieces
        return np.concatenate(
            ([0.0], np.cumsum(y * (p[:, 0] + y * (p[:, 1] / 2 + y * p[:, 2] / 3))))
        )

    def integral(self, x: Array) -> Array:
        """Integral up to x."""
        i, y, inside = self._locate(x)
        p = self.pieces[i]
        part = self._before[i] + y * (p[..., 0] + y * (p[..., 1] / 2 + y * p[..., 2] / 3))
        return np.where(inside, part, np.where(x < self.knots[0], 0.0, self._before[-1]))

    def t_coefficients(self, count: int) -> Array:
        """First `count` coefficients of the spline as a sum of T_l / sqrt(1 - t^2): (2/pi) int f
        T_l dt, half of it for l = 0.
        """
        angle = np.arccos(np.clip(self.knots - 1, -1.0, 1.0))
        parts = np.maximum(np.ceil(-np.diff(angle) * (count / _TURN)), 1.0).astype(np.intp)
        # From the right end to the left: the angles fall.
        theta, weights = legendre(angle, _NODES, parts)
        out = waves(
            (-2 / np.pi) * weights * np.sin(theta) * self(sides(theta)[0]), theta, count
        ).real
        out[:1] *= 0.5
        return out

    # what the kernel makes of it
    # --------------------------------------------------------------------------------------
    @cached_property
    def _reach(self) -> tuple[float, float]:
        half = 0.5 * (self.knots[-1] - self.knots[0])
        return self.knots[0] - _REACH * half, self.knots[-1] + _REACH * half

    @cached_property
    def _close(self) -> PiecewiseTransform:
        """On the spline and beside it, in cells that double in length away from it."""
        lo, hi = self._reach
        first, last = np.diff(self.knots)[[0, -1], None] * (2.0 ** np.arange(1, 60) - 1)
        before = self.knots[0] - first[first < 0.75 * (self.knots[0] - lo)]
        after = self.knots[-1] + last[last < 0.75 * (hi - self.knots[-1])]
        ends = np.concatenate(([lo], before[::-1], self.knots, after, [hi]))
        pieces = np.zeros((len(ends) - 1, 3))
        start = len(before) + 1
        pieces[start : start + len(self.pieces)] = self.pieces
        jumps = 2 * np.diff(self.pieces[:, 2], prepend=0.0, append=0.0)
        return PiecewiseTransform(cauchy(), ends, pieces, self.knots, jumps)

    @cached_property
    def _moments(self) -> Array:
        """int f T_k dt over pi, twice for k > 0, T_k of the spline's own width."""
        x, weights = legendre(self.knots, TERMS)
        u = (x - 0.5 * (self.knots[0] + self.knots[-1])) / (0.5 * (self.knots[-1] - self.knots[0]))
        values, angle = self(x) * weights, np.arccos(np.clip(u, -1.0, 1.0))
        return np.array([float(values @ np.cos(k * angle)) for k in range(TERMS)]) * (
            np.where(np.arange(TERMS), 2.0, 1.0) / np.pi
        )

    def own_transform(self, x: Array) -> Array:
        """(1/pi) PV int f / (x - xi) at points on the zone and off it."""
        lo, hi = self._reach
        close = (x >= lo) & (x <= hi)
        out = np.empty(x.shape)
        out[close] = self._close(x[close])
        half = 0.5 * (self.knots[-1] - self.knots[0])
        z = (x[~close] - 0.5 * (self.knots[0] + self.knots[-1])) / half
        seen, row = Outside(np.sign(z), np.abs(z) - 1), np.zeros(len(z), dtype=np.intp)
        out[~close] = of_t(self._moments[None] / half, seen, half, 1.0, row, "transform")
        return out

    def in_plane(self, seen: InPlane, what: What) -> Complex:
        """(1/pi) int f / (zeta - tau) dtau, f the spline, or its derivative: piece by piece, by
        Gauss's rule or, nearby, in closed form

        int_0^h (p_0 + p_1 y + p_2 y^2) / (Y - y) dy = p(Y) log(Y / (Y - h)) - p_1 h - p_2 (h Y +
        h^2/2).
        """
        knots, p = self.knots, self.pieces
        h = np.diff(knots)
        places, weights = legendre(knots, _GAUSS)
        held = self(places) * weights
        power = 1 if what == "transform" else 2
        sign = 1.0 if what == "transform" else -1.0
        out = np.empty(seen.left.shape, dtype=complex)
        for here in pair_blocks(len(out), len(places)):
            at = seen.left[here]
            # Distances from both knots of a piece, whichever of them rounding spares.
            close = np.abs(at[:, None] - (knots[:-1] + 0.5 * h)) < _NEARBY * h
            terms = sign * held / (at[:, None] - places) ** power
            value = np.where(np.repeat(close, _GAUSS, axis=1), 0.0, terms).sum(axis=1)
            i, j = np.nonzero(close)
            one, two, three, size = *p[j].T, h[j]
            past, before = at[i] - knots[j], at[i] - knots[j + 1]
            with np.errstate(divide="ignore", invalid="ignore"):
                log = np.log(past) - np.log(before)
                f = one + past * (two + past * three)
                # At a knot both pieces have the same value: its logarithms cancel.
                log = np.where(
                    (past == 0) | (before == 0),
                    np.where(past == 0, -1.0, 1.0) * np.log(size) - 1j * np.pi * (past == 0),
                    log,
                )
                if what == "transform":
                    closed = f * log - two * size - three * (size * past + 0.5 * size**2)
                else:
                    closed = (
                        (two + 2 * three * past) * log - f * size / (past * before) - three * size
                    )
            np.add.at(value, i, closed)
            out[here] = value / np.pi
        return out
