r"""Quadratic splines inside one zone, in place of hundreds of truncated powers.

The truncated powers of n jumps of a second derivative grow to n^2 times their sum, so that the
relative round-off of the sum grows by the factor n^2. This module evaluates a spline f with these
jumps piece by piece instead.

`QuadraticSpline` is a spline f that is a part of the density itself. It is a sum of B-splines,
sum_j d_j B_j, each three pieces wide. With u, v the inner knots of B_j, the coefficient is the
blossom d_j = 2 f((u + v)/2) - (f(u) + f(v))/2 (L. Ramshaw, Comput. Aided Geom. Des. 6 (1989)
323-358). The sum of the B-splines inside the zone is nowhere larger than f. It has the jumps of f
at all knots except the first three and the last three.

`ConjugateSpline` is the density, bounded at both ends, whose transform is a spline g minus the mean
of g over theta. With t = cos(theta) this density is the conjugate of g(cos(theta)),

    sum_k g_k sin(k theta) = -(1/pi) PV int g / (t - tau) dtau
                             + (1/pi) int_0^pi g(cos(phi)) cot((theta + phi)/2) dphi.

The first part is minus the transform of a `QuadraticSpline`. The second is analytic in theta. Off
the zone the transform and the potential of this density are

    (2/pi) int g rho (cos(phi) - rho) / |1 - rho e^(i phi)|^2 dphi,
    (2/pi) int g sin(phi) arg(1 / (1 - rho e^(i phi))) dphi - rho g_0 - c_0 ln(2 |rho|),

with g_0 the mean over phi of g, and c_0 the mean of g cos(phi). As functions of phi, the factors of
g in these integrals are singular at the ends of the zone only. Panels that double in length away
from the ends resolve these factors. On each panel g enters through a few moments. So the integrals
are sums over some hundred nodes, whatever the number of knots.

Positions are distances from the zone's left end, in half widths.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from sie.basis import chebyshev
from sie.basis.data import (
    EPS,
    HALF_DIGITS,
    SUM_ROUNDING,
    Array,
    Index,
    Kept,
    Mask,
    legendre,
    record,
)
from sie.basis.interval import Complex, InPlane, Outside, What, of_t, sides, theta
from sie.basis.kernels import cauchy
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.sums import pair_blocks, sum_of_powers, waves
from sie.jumps.formulas import OPTIONS as FAR
from sie.trees.piecewise import PiecesInPlane, PiecewiseTransform, clenshaw
from sie.trees.tree import SEPARATION, TERMS


@dataclass(frozen=True)
class SplineOptions:
    """Least numbers of jumps that a spline replaces, and the length of the spline's series."""

    # If a zone has at least this many jumps of g'', the second derivative of the right side, a
    # spline replaces them. With fewer jumps, the closed forms of single jumps are faster.
    min_jumps: int = 400
    # If a zone has at least this many jumps of the density's second derivative, a spline replaces
    # them. The number is smaller than `min_jumps`, because the round-off of n jumps grows as n^2
    # and affects other zones.
    min_density_jumps: int = 128
    # The potential of a spline of the density is a series with this number of Chebyshev
    # coefficients for each knot.
    coefficients_per_knot: int = 8


OPTIONS = SplineOptions()


def same_jumps(found: Array, wanted: Array, length: Array, size: float) -> bool:
    """Whether the second derivative's jumps `found` equal the `wanted` ones, up to round-off.

    length: lengths of the pieces; size: size of the values from which the jumps were found.
    """
    rounding = SUM_ROUNDING * size / np.minimum(length[1:], length[:-1]) ** 2
    return not np.any(
        np.abs(found - wanted) > np.maximum(HALF_DIGITS * np.abs(wanted).max(initial=0.0), rounding)
    )


def with_jumps(knots: Array, jumps: Array) -> Callable[[Array], Array]:
    """The quadratic spline with given `jumps` and the least sum of squared values at the knots.

    `jumps` are half of the jumps of the second derivative. If a function is not itself a quadratic
    spline, this spline is the part of it that has the jumps.
    """
    ends = np.concatenate(([0.0], knots, [2.0]))
    length, bend, before = np.diff(ends), np.concatenate(([0.0], np.cumsum(jumps))), np.zeros(3)
    for _ in range(2):
        # The quadratic trend is subtracted twice, because the round-off of the first subtraction
        # may exceed small values of the spline.
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
class QuadraticSpline(Kept):
    """A quadratic spline on part of a zone, used as a part of the density.

    knots: (n,) ascending; pieces: (n - 1, 3) coefficients of powers of the distance from the left
    knot of each piece.
    """

    knots: Array
    pieces: Array

    @classmethod
    def of(cls, knots: Array, control: Array) -> "QuadraticSpline":
        """The spline whose quadratic pieces have the middle Bezier control points `control`.

        It is zero at the first and the last knot. If the first and the last of the control points
        are zero, so are the slopes there.
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
    ) -> "tuple[QuadraticSpline, Array, Array] | None":
        """Spline that replaces most jumps of f'', and the jumps that remain.
        The result is (spline, remaining jumps, added jumps). This spline adds no jumps, but
        `ConjugateSpline.inside` does. The result is None if f does not have the given `jumps`.

        The spline consists of those B-splines of f that lie inside the zone. `jumps` are the jumps
        of the second derivative of f, divided by two.
        """
        within = np.flatnonzero(np.minimum(knots, 2 - knots) > HALF_DIGITS)
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
        """Values of the spline at points given by their distances from both ends of the zone."""
        return self(left)

    @property
    def jumps(self) -> Array:
        """Half of the jumps of the spline's second derivative at the knots."""
        return np.diff(self.pieces[:, 2], prepend=0.0, append=0.0)

    @property
    def mean_offset(self) -> float:
        raise ValueError(
            "a condition on potentials cannot be combined with declared jumps of the density"
        )

    def potential(self, left: Array, right: Array, rho: Array) -> Array:
        raise ValueError("the potential of a spline of the density has no closed form")

    def transform_off(self, z: Array, rho: Array) -> Array:
        """Transform of the spline at points z off the zone (half widths from the middle)."""
        return self.own_transform(1 + z)

    @property
    def edge_slopes(self) -> tuple[float, float]:
        """Slopes of the spline at the zone's ends: zero, since the spline is zero near the ends."""
        return 0.0, 0.0

    @property
    def size(self) -> float:
        return float(np.abs(self.pieces[:, 0]).max())

    @cached_property
    def _before(self) -> Array:
        """Integral of the spline from its first knot to each knot."""
        y, p = np.diff(self.knots), self.pieces
        return np.concatenate(
            ([0.0], np.cumsum(y * (p[:, 0] + y * (p[:, 1] / 2 + y * p[:, 2] / 3))))
        )

    def integral(self, x: Array) -> Array:
        """Integral of the spline from its first knot to x."""
        i, y, inside = self._locate(x)
        p = self.pieces[i]
        part = self._before[i] + y * (p[..., 0] + y * (p[..., 1] / 2 + y * p[..., 2] / 3))
        return np.where(inside, part, np.where(x < self.knots[0], 0.0, self._before[-1]))

    def t_coefficients(self, count: int) -> Array:
        """The first `count` coefficients c_l of the spline as a sum of c_l T_l / sqrt(1 - t^2).

        They are (2/pi) int f T_l dt, and half of it for l = 0.
        """
        angle = np.arccos(np.clip(self.knots - 1, -1.0, 1.0))
        parts = np.maximum(np.ceil(-np.diff(angle) * (count / SUMS.max_turn)), 1.0).astype(np.intp)
        # The knots ascend, so that their angles descend and the quadrature weights are negative.
        theta, weights = legendre(angle, SUMS.gauss_nodes, parts)
        out = waves(
            (-2 / np.pi) * weights * np.sin(theta) * self(sides(theta)[0]), theta, count
        ).real
        out[:1] *= 0.5
        return out

    # The methods below give the transform of the spline.
    @cached_property
    def _reach(self) -> tuple[float, float]:
        half = 0.5 * (self.knots[-1] - self.knots[0])
        return self.knots[0] - SEPARATION * half, self.knots[-1] + SEPARATION * half

    @cached_property
    def _close(self) -> PiecewiseTransform:
        """The transform on and near the spline's interval: Chebyshev series on short intervals."""
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
        """Moments (1/pi) int f T_k dt of the spline f on its own interval, doubled for k > 0."""
        x, weights = legendre(self.knots, TERMS)
        u = (x - 0.5 * (self.knots[0] + self.knots[-1])) / (0.5 * (self.knots[-1] - self.knots[0]))
        return ((self(x) * weights) @ chebvander(u, TERMS - 1)) * (
            np.where(np.arange(TERMS), 2.0, 1.0) / np.pi
        )

    def own_transform(self, x: Array) -> Array:
        """Transform (1/pi) PV int f(xi) / (x - xi) dxi of the spline f at all real points x."""
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
        """Transform (1/pi) int f / (zeta - tau) dtau of the spline f, or its derivative by zeta."""
        return self._sources.field(seen.left, what)

    @cached_property
    def _sources(self) -> PiecesInPlane:
        return PiecesInPlane.of(self.knots, self.pieces)


@record
class ConjugateSpline(Kept):
    """The bounded density whose transform is a spline minus its mean over theta = arccos(t).

    spline: the spline g from one end of the zone to the other, as a function of the distance from
    the left end in half widths. Its value and slope are zero at both ends. known: the coefficients
    that have been computed.
    """

    spline: QuadraticSpline
    known: dict[str, Array] = field(default_factory=dict)

    @classmethod
    def inside(
        cls, knots: Array, jumps: Array, g: Callable[[Array], Array]
    ) -> "tuple[ConjugateSpline, Array, Array] | None":
        """Spline that replaces all jumps of g'', and one added jump; None if `jumps` do not fit g.
        The result is (spline, zeros, position and height of the added jump).

        The zeros are the heights of the given jumps after the spline is subtracted: no jump
        remains. The spline is g minus a function of two quadratic pieces that has the values and
        slopes of g at both ends. The added jump is the jump of this function's second derivative
        where the two pieces meet.
        """
        left = np.zeros_like(jumps)
        inner = np.minimum(knots, 2 - knots) > HALF_DIGITS
        knots, jumps = knots[inner], jumps[inner]
        piece = int(np.searchsorted(knots, 1.0))
        cut = 0.5 * float(np.append(0.0, knots)[piece] + np.append(knots, 2.0)[piece])
        ends = np.concatenate(([0.0], knots[:piece], [cut], knots[piece:], [2.0]))
        length, middles = np.diff(ends), 0.5 * (ends[1:] + ends[:-1])
        values, between = np.asarray(g(ends)), np.asarray(g(middles))
        # `first` and `last` are the middle Bezier control points of the first and the last piece.
        # They determine the slopes at the ends.
        first, last = (
            2 * between[i] - 0.5 * (values[i] + values[j]) for i, j in ((0, 1), (-1, -2))
        )
        at_left = float(values[0]), float(2 * (first - values[0]) / length[0])
        at_right = float(values[-1]), float(2 * (values[-1] - last) / length[-1])
        rest, height = _two_pieces(cut, *at_left, *at_right)
        size = float(np.abs(values).max()) + abs(height)
        values, between = values - rest(ends), between - rest(middles)
        spline = QuadraticSpline.of(
            ends,
            np.concatenate(([0.0], (2 * between - 0.5 * (values[1:] + values[:-1]))[1:-1], [0.0])),
        )
        found = np.diff(spline.pieces[:, 2])
        if not same_jumps(found, np.insert(jumps, piece, -height), length, size):
            return None
        return cls(spline), left, np.array([[cut], [height]])

    @property
    def knots(self) -> Array:
        """The spline's knots, without the two ends of the zone."""
        return self.spline.knots[1:-1]

    @property
    def jumps(self) -> Array:
        """Half of the jumps of the spline's second derivative at the inner knots."""
        return np.diff(self.spline.pieces[:, 2])

    @property
    def size(self) -> float:
        return self.spline.size

    @cached_property
    def _cuts(self) -> Array:
        """Angles that cut (0, pi) into panels whose lengths double away from both ends.

        Close to an end g grows as the fourth power of the angle. The first panel is so short that g
        is negligible within it.
        """
        curved = np.abs(self.spline.pieces[[-1, 0], 2]) + 1e-300
        near = np.array([2 - self.knots[-1], self.knots[0]])
        outermost = theta(2 - near, near)
        first, last = np.clip(
            (EPS**0.75 * self.size / curved) ** 0.25, 1e-6, np.minimum(outermost, 0.5)
        )
        return _graded(float(first), float(last))

    # The methods below integrate the spline g times smooth functions.
    def _rule(self, cuts: Array) -> tuple[Array, Array]:
        """Nodes phi and weights of a quadrature rule for integrals int g F dphi, with the spline g.
        The rule is int g F dphi = sum of weights * F(phi).

        F is any function that is smooth between the cuts.
        """
        ends = np.unique(np.concatenate((self.spline.knots, 1 + np.cos(cuts[1:-1]))))
        phi, weights = legendre(theta(ends, 2 - ends), SUMS.gauss_nodes)
        # The knots ascend, so that their angles descend and the quadrature weights are negative.
        values = -weights * self.spline(sides(phi)[0])
        panel = np.clip(np.searchsorted(cuts, phi, side="right") - 1, 0, len(cuts) - 2)
        half, middle = 0.5 * np.diff(cuts), 0.5 * (cuts[1:] + cuts[:-1])
        u = (phi - middle[panel]) / half[panel]
        # The moments of the spline with the Chebyshev polynomials are computed on each panel. The
        # weights at Gauss-Chebyshev nodes follow from these moments.
        moments = np.empty((len(half), TERMS))
        one, two = np.ones(len(u)), u
        for k in range(TERMS):
            moments[:, k] = np.bincount(panel, values * one, len(half))
            one, two = two, 2 * u * two - one
        moments[:, 1:] *= 2
        place = np.cos((np.arange(TERMS) + 0.5) * np.pi / TERMS)
        return (middle[:, None] + half[:, None] * place).ravel(), (
            moments @ chebyshev.t_matrix(TERMS, TERMS).T / TERMS
        ).ravel()

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        """Nodes and weights of `_rule`, on panels that grow away from both ends."""
        return self._rule(self._cuts)

    @cached_property
    def mean(self) -> float:
        """Mean of the spline over the angle theta, with the place t = cos(theta)."""
        return float(self._nodes[1].sum() / np.pi)

    def t_coefficients(self, count: int) -> Array:
        """First `count` coefficients c_l of the density as a sum of c_l T_l / sqrt(1 - t^2)."""
        known = self.known.get("c", np.zeros(0))
        if len(known) < count:
            panels = int(np.ceil(np.pi * (count + 1) / SUMS.max_turn)) + 1
            phi, weight = self._rule(np.linspace(0.0, np.pi, panels + 1))
            known = 0.5 * waves((2 / np.pi) * weight, phi, count + 2).real[1:]
            known[2:] -= known[:-2].copy()
            self.known["c"] = known = known[:count]
        return known[:count]

    @cached_property
    def edge_slopes(self) -> tuple[float, float]:
        """Derivatives of the density by the angle from each end, at (left end, right end)."""
        phi, weight = self._nodes
        left, right = (float((weight / side).sum() / np.pi) for side in sides(phi))
        return left, -right

    @cached_property
    def mean_offset(self) -> float:
        """Mean over theta of the spline's primitive, minus the mean of its two end values.

        It is divided by the half width of the zone.
        """
        phi, weight = self._nodes
        return float(weight @ ((phi - 0.5 * np.pi) * np.sin(phi))) / np.pi

    # The methods below give the transform and the density on the zone.
    def own_transform(self, left: Array) -> Array:
        """Transform of the density, at points on the zone.
        It equals the spline minus the spline's mean over theta.
        """
        return self.spline(left) - self.mean

    @cached_property
    def _cells(self) -> tuple[Array, Array]:
        """Chebyshev series of the density's analytic part, on cells (intervals of the angle theta).
        The result is (ends of the cells, coefficients on the cells).
        """
        cuts = self._cuts[1:-1]
        nearest = np.array([0.25, 0.5])
        cuts = np.concatenate((nearest * cuts[0], cuts, np.pi - nearest[::-1] * (np.pi - cuts[-1])))
        half, middle = 0.5 * np.diff(cuts), 0.5 * (cuts[1:] + cuts[:-1])
        place = np.cos((np.arange(TERMS) + 0.5) * np.pi / TERMS)
        phi, weight = self._nodes
        theta = (middle[:, None] + half[:, None] * place).ravel()
        values = ((1 / np.tan(0.5 * (theta[:, None] + phi))) @ weight / np.pi).reshape(
            len(half), TERMS
        )
        return cuts, np.ascontiguousarray((values @ chebyshev.to_series(TERMS)).T)

    def density(self, left: Array, right: Array) -> Array:
        """The density at points given by their distances from both ends of the zone."""
        from_right, from_left = theta(left, right), theta(right, left)
        cuts = self._cells[0]
        close = (from_right >= cuts[0]) & (from_right <= cuts[-1])
        out = np.empty(from_right.shape)
        out[close] = self._on_cells(from_right[close], left[close])
        at_ends = (from_left, from_right > cuts[-1]), (from_right, from_right < cuts[0])
        for (angle, here), slope, cubic in zip(
            at_ends, self.edge_slopes, self._cubics, strict=True
        ):
            out[here] = angle[here] * (slope + cubic * angle[here] ** 2)
        return out

    def _on_cells(self, theta: Array, left: Array) -> Array:
        cuts, series = self._cells
        cell = np.clip(np.searchsorted(cuts, theta, side="right") - 1, 0, len(cuts) - 2)
        u = (2 * theta - cuts[cell] - cuts[cell + 1]) / (cuts[cell + 1] - cuts[cell])
        return clenshaw(series, cell, u) - self.spline.own_transform(left)

    @cached_property
    def _cubics(self) -> tuple[float, float]:
        """Coefficients of angle^3 in the density close to the zone's ends: (left end, right end).

        Close to an end the density is a series of odd powers of the angle from this end.
        """
        cuts = self._cells[0]
        theta, angle = cuts[[-1, 0]], np.array([np.pi - cuts[-1], cuts[0]])
        value = self._on_cells(theta, sides(theta)[0])
        left, right = (value / angle - np.array(self.edge_slopes)) / angle**2
        return float(left), float(right)

    # The methods below give the transform of the density off the zone, and the density's potential.
    def transform_off(self, z: Array, rho: Array) -> Array:
        """Transform of the density at points off the zone."""
        out, is_far = np.empty(rho.shape), np.abs(rho) < FAR.far_rho[-1]
        out[is_far] = self._series(self._cosines[1:], rho[is_far])
        (phi, weight), (left, right) = self._nodes, sides(self._nodes[0])
        close = np.flatnonzero(~is_far)
        for block in pair_blocks(len(close), len(phi)):
            here = close[block]
            near = np.where(rho[here, None] > 0, right, left)
            size = np.abs(rho[here])[:, None]
            # `near` is the distance of cos(phi) from the right end for rho > 0, and from the left
            # end for rho < 0. With it, rho (cos(phi) - rho) is |rho| (1 - |rho| - near), without
            # cancellation.
            out[here] = (
                (size * ((1 - size) - near) / ((1 - size) ** 2 + 2 * size * near))
                @ weight
                * (2 / np.pi)
            )
        return out

    @cached_property
    def _cosines(self) -> Array:
        """Integrals (2/pi) int g cos(k phi) dphi, k = 0, 1, ..., for series in powers of rho.

        They replace the sums over nodes at points with |rho| < `far_rho`. The transform is the sum
        of the integrals times rho^k, k > 0.
        """
        phi, weight = self._nodes
        return waves((2 / np.pi) * weight, phi, FAR.far_terms[-1] + 2).real

    def _series(self, coefficients: Array, rho: Array) -> Array:
        """The sum over k > 0 of coefficients_(k-1) rho^k."""
        return rho * sum_of_powers(coefficients[None], rho, np.zeros(len(rho), dtype=np.intp))

    def in_plane(self, seen: InPlane, what: What) -> Complex:
        """Transform of the density, or its derivative by zeta, at complex points zeta."""
        phi, weight = self._nodes
        half = np.exp(-0.5j * phi)
        of_m, of_p = 2 * half * np.cos(0.5 * phi), 2j * half * np.sin(0.5 * phi)
        weight = weight * half * half * (2 / np.pi)
        out = 1j * self.spline.in_plane(seen, what)
        scale = seen.rho if what == "transform" else -seen.rho / seen.root
        one, other = seen.m / (seen.p + seen.m), seen.p / (seen.p + seen.m)
        block = max(1, SUMS.cache_pairs // len(phi))
        for start in range(0, len(out), block):
            here = slice(start, start + block)
            # `b` is 1 - rho e^(-i phi) with rho of the points and phi of the nodes, computed
            # without cancellation (see `InPlane.turned`).
            b = np.multiply.outer(one[here], of_m)
            b += np.multiply.outer(other[here], of_p)
            if what == "derivative":
                b *= b
            out[here] += scale[here] * (np.divide(1.0, b, out=b) @ weight)
        return np.asarray(out)

    def integral(self, left: Array) -> Array:
        raise ValueError(
            "the integral along a zone is not known for jumps of derivatives of the right side, "
            "as in a spline: only the right side itself may jump"
        )

    def potential(self, left: Array, right: Array, rho: Array) -> Array:
        """Potential of this density, divided by the half width w of the zone.
        The term c_0 log(w) is left out, with c_0 the integral of the density divided by pi w.

        It holds on the zone and off it.
        """
        phi, weight = self._nodes
        on = (left >= 0) & (right >= 0)
        rho = np.where(on, 1.0, rho)
        c_0 = float(weight @ np.cos(phi)) / np.pi
        out = -rho * self.mean - c_0 * np.log(2 * np.abs(rho))
        sine, cosine = np.sin(phi), np.cos(phi)
        end = float(weight @ (sine * 0.5 * (np.pi - phi))) * (2 / np.pi)
        is_far = np.abs(rho) < FAR.far_rho[-1]
        # The argument arg(1 / (1 - rho e^(i phi))) is the sum of rho^k sin(k phi) / k.
        c = self._cosines
        k = np.arange(1, len(c) - 1)
        out[is_far] += self._series((c[:-2] - c[2:]) / (2 * k), rho[is_far])
        near = np.flatnonzero(~on & ~is_far)
        for here in pair_blocks(len(near), len(phi)):
            r = rho[near[here], None]
            out[near[here]] += np.arctan2(r * sine, 1 - r * cosine) @ (weight * sine) * (2 / np.pi)
        whole = float(self.spline.integral(np.array([2.0]))[0])
        out[on] += end - (whole - self.spline.integral(left[on]) - self.mean * right[on])
        return out


def _graded(first: float, last: float) -> Array:
    """Ends of panels that cover (0, pi), which are shorter towards 0 and pi.

    The first panel has the length `first`, and the last one the length `last`. Towards
    the middle of (0, pi), the lengths double. No inner panel is longer than its distance from 0 and
    from pi.
    """
    middle = 0.5 * np.pi
    low, high = (size * 2.0 ** np.arange(60) for size in (first, last))
    return np.concatenate(
        (
            [0.0],
            low[low < 0.75 * middle],
            [middle],
            np.pi - high[high < 0.75 * middle][::-1],
            [np.pi],
        )
    )


def _two_pieces(
    cut: float, left: float, left_slope: float, right: float, right_slope: float
) -> tuple[Callable[[Array], Array], float]:
    """A function of two quadratic pieces on [0, 2], and half of its second derivative's jump.

    The function has the given values and slopes at 0 and 2. At the cut, it is continuous and has a
    continuous slope.
    """
    beyond = 2.0 - cut
    # `before`, `middle` and `after` are Bezier control points of the two quadratic pieces.
    before, after = left + 0.5 * cut * left_slope, right - 0.5 * beyond * right_slope
    middle = 0.5 * (beyond * before + cut * after)
    bends = (left - 2 * before + middle) / cut**2, (right - 2 * after + middle) / beyond**2

    def pieces(x: Array) -> Array:
        y = 2.0 - x
        return np.where(
            x < cut,
            left + x * (left_slope + x * bends[0]),
            right - y * (right_slope - y * bends[1]),
        )

    return pieces, bends[1] - bends[0]
