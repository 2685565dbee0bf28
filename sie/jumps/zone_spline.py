r"""A quadratic spline g inside a zone, and the density that the kernel turns into it: the place of
hundreds of jumps of g''.

With t = cos(theta), the density bounded at both ends that makes g of it, less its mean over theta,
is the conjugate of g(cos(theta)),

    sum_k g_k sin(k theta) = -(1/pi) PV int g / (t - tau) dtau + (1/pi) int_0^pi g(cos(phi))
    cot((theta + phi)/2) dphi.

The first part is that of `local_spline`; the second is analytic in theta. What the density does off
the zone, and its potential there,

    (2/pi) int g rho (cos(phi) - rho) / |1 - rho e^(i phi)|^2 dphi, (2/pi) int g sin(phi) arg(1 / (1
    - rho e^(i phi))) dphi - rho g_0 - c_0 ln(2 |rho|),    g_0, c_0: means of g, g cos(phi),

have singularities no nearer to a phi than the ends of the zone. Panels that double in length away
from these hold all that they see of g in a few moments each: the integrals are sums over some
hundred nodes, whatever the number of knots.
"""

from collections.abc import Callable
from dataclasses import field
from functools import cached_property

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Kept, legendre, record
from sie.basis.interval import Complex, InPlane, What, sides, theta
from sie.basis.sums import pair_blocks, waves
from sie.jumps.local_spline import NEAREST, LocalSpline, same_jumps
from sie.trees.piecewise import clenshaw

# Moments of a panel: it is seen from no nearer than twice its half width beyond its middle.
_TERMS = 24
# Of the size of g: as much as that is left to the outermost panels.
_NOTHING = 1e-12
# Gauss nodes on a piece of the spline, and largest angle over which a panel is turned when
# coefficients are found.
_NODES = 16
_TURN = 8.0


@record
class ZoneSpline(Kept):
    """spline: g by distance from the zone's left end over its half width, from one end to the
    other; zero there, and its slope too.
    """

    spline: LocalSpline
    known: dict[str, Array] = field(default_factory=dict)

    @classmethod
    def inside(
        cls, knots: Array, jumps: Array, g: Callable[[Array], Array]
    ) -> "tuple[ZoneSpline, Array, Array] | None":
        """(the spline, what is left of the jumps: none; place and height of another one); None if g
        has other jumps than these.

        What is left of g has its values and slopes at both ends, and two pieces: no number is
        larger than those slopes.
        """
        left = np.zeros_like(jumps)
        inner = np.minimum(knots, 2 - knots) > NEAREST
        knots, jumps = knots[inner], jumps[inner]
        piece = int(np.searchsorted(knots, 1.0))
        cut = 0.5 * float(np.append(0.0, knots)[piece] + np.append(knots, 2.0)[piece])
        ends = np.concatenate(([0.0], knots[:piece], [cut], knots[piece:], [2.0]))
        length, middles = np.diff(ends), 0.5 * (ends[1:] + ends[:-1])
        values, between = np.asarray(g(ends)), np.asarray(g(middles))
        # Control points of the first and the last piece: they tell the slopes at the ends.
        first, last = (
            2 * between[i] - 0.5 * (values[i] + values[j]) for i, j in ((0, 1), (-1, -2))
        )
        at_left = float(values[0]), float(2 * (first - values[0]) / length[0])
        at_right = float(values[-1]), float(2 * (values[-1] - last) / length[-1])
        rest, height = _two_pieces(cut, *at_left, *at_right)
        size = float(np.abs(values).max()) + abs(height)
        values, between = values - rest(ends), between - rest(middles)
        spline = LocalSpline.of(
            ends,
            np.concatenate(([0.0], (2 * between - 0.5 * (values[1:] + values[:-1]))[1:-1], [0.0])),
        )
        found = np.diff(spline.pieces[:, 2])
        if not same_jumps(found, np.insert(jumps, piece, -height), length, size):
            return None
        return cls(spline), left, np.array([[cut], [height]])

    @property
    def knots(self) -> Array:
        """Those inside."""
        return self.spline.knots[1:-1]

    @property
    def jumps(self) -> Array:
        """Half of the jumps of the second derivative at these."""
        return np.diff(self.spline.pieces[:, 2])

    @property
    def size(self) -> float:
        return self.spline.size

    @cached_property
    def _cuts(self) -> Array:
        """Of panels that double in length away from both ends, from so near to these that g, which
        goes as the fourth power of the angle there, is nothing to speak of within the first.
        """
        curved = np.abs(self.spline.pieces[[-1, 0], 2]) + 1e-300
        near = np.array([2 - self.knots[-1], self.knots[0]])
        outermost = theta(2 - near, near)
        first, last = np.clip(
            (_NOTHING * self.size / curved) ** 0.25, 1e-6, np.minimum(outermost, 0.5)
        )
        return _graded(float(first), float(last))

    # g by moments
    # ---------------------------------------------------------------------------------------------------
    def _moments(self, cuts: Array) -> tuple[Array, Array]:
        """(nodes phi, weights that hold g): int_0^pi g F dphi = sum of weights F(phi), F smooth on
        each panel between cuts.
        """
        ends = np.unique(np.concatenate((self.spline.knots, 1 + np.cos(cuts[1:-1]))))
        phi, weights = legendre(theta(ends, 2 - ends), _NODES)
        # From the left end to the right the angles fall.
        values = -weights * self.spline(sides(phi)[0])
        panel = np.clip(np.searchsorted(cuts, phi, side="right") - 1, 0, len(cuts) - 2)
        half, middle = 0.5 * np.diff(cuts), 0.5 * (cuts[1:] + cuts[:-1])
        u = (phi - middle[panel]) / half[panel]
        # T moments panel by panel, then the weights of Gauss-Chebyshev nodes with the same moments.
        moments = np.empty((len(half), _TERMS))
        one, two = np.ones(len(u)), u
        for k in range(_TERMS):
            moments[:, k] = np.bincount(panel, values * one, len(half))
            one, two = two, 2 * u * two - one
        moments[:, 1:] *= 2
        place = np.cos((np.arange(_TERMS) + 0.5) * np.pi / _TERMS)
        return (middle[:, None] + half[:, None] * place).ravel(), (
            moments @ chebyshev.t_matrix(_TERMS, _TERMS).T / _TERMS
        ).ravel()

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        """Nodes and weights of panels that double in length away from both ends."""
        return self._moments(self._cuts)

    @cached_property
    def mean(self) -> float:
        """Mean over theta."""
        return float(self._nodes[1].sum() / np.pi)

    def t_coefficients(self, count: int) -> Array:
        """First `count` coefficients of the density as a sum of T_l / sqrt(1 - t^2)."""
        known = self.known.get("c", np.zeros(0))
        if len(known) < count:
            panels = int(np.ceil(np.pi * (count + 1) / _TURN)) + 1
            phi, weight = self._moments(np.linspace(0.0, np.pi, panels + 1))
            known = 0.5 * waves((2 / np.pi) * weight, phi, count + 2).real[1:]
            known[2:] -= known[:-2].copy()
            self.known["c"] = known = known[:count]
        return known[:count]

    @cached_property
    def edge_slopes(self) -> tuple[float, float]:
        """Coefficient of the angle from the left and from the right end."""
        phi, weight = self._nodes
        left, right = (float((weight / side).sum() / np.pi) for side in sides(phi))
        return left, -right

    @cached_property
    def mean_offset(self) -> float:
        """Mean over theta of the primitive of g, less half of its values at both ends; over the
        half width.
        """
        phi, weight = self._nodes
        return float(weight @ ((phi - 0.5 * np.pi) * np.sin(phi))) / np.pi

    # on the zone
    # ----------------------------------------------------------------------------------------------------
    def own_transform(self, left: Array) -> Array:
        """g less its mean over theta."""
        return self.spline(left) - self.mean

    @cached_property
    def _cells(self) -> tuple[Array, Array]:
        """(ends in theta, series (TERMS, cells)) of what makes the density of the transform of g."""
        cuts = self._cuts[1:-1]
        nearest = np.array([0.25, 0.5])
        cuts = np.concatenate((nearest * cuts[0], cuts, np.pi - nearest[::-1] * (np.pi - cuts[-1])))
        half, middle = 0.5 * np.diff(cuts), 0.5 * (cuts[1:] + cuts[:-1])
        place = np.cos((np.arange(_TERMS) + 0.5) * np.pi / _TERMS)
        phi, weight = self._nodes
        theta = (middle[:, None] + half[:, None] * place).ravel()
        values = ((1 / np.tan(0.5 * (theta[:, None] + phi))) @ weight / np.pi).reshape(
            len(half), _TERMS
        )
        return cuts, np.ascontiguousarray((values @ chebyshev.to_series(_TERMS)).T)

    def density(self, left: Array, right: Array) -> Array:
        """The density at points given by their distances from both ends."""
        from_right, from_left = theta(left, right), theta(right, left)
        cuts = self._cells[0]
        close = (from_right >= cuts[0]) & (from_right <= cuts[-1])
        out = np.empty(from_right.shape)
        out[close] = self._on_cells(from_right[close], left[close])
        beside = (from_left, from_right > cuts[-1]), (from_right, from_right < cuts[0])
        for (angle, here), slope, cubic in zip(beside, self.edge_slopes, self._cubics, strict=True):
            out[here] = angle[here] * (slope + cubic * angle[here] ** 2)
        return out

    def _on_cells(self, theta: Array, left: Array) -> Array:
        cuts, series = self._cells
        cell = np.clip(np.searchsorted(cuts, theta, side="right") - 1, 0, len(cuts) - 2)
        u = (2 * theta - cuts[cell] - cuts[cell + 1]) / (cuts[cell + 1] - cuts[cell])
        return clenshaw(series, cell, u) - self.spline.own_transform(left)

    @cached_property
    def _cubics(self) -> tuple[float, float]:
        """Beside the left and the right end the density is a series of odd powers of the angle from
        there: coefficient of the second.
        """
        cuts = self._cells[0]
        theta, angle = cuts[[-1, 0]], np.array([np.pi - cuts[-1], cuts[0]])
        value = self._on_cells(theta, sides(theta)[0])
        left, right = (value / angle - np.array(self.edge_slopes)) / angle**2
        return float(left), float(right)

    # off the zone
    # ---------------------------------------------------------------------------------------------------
    def transform_off(self, z: Array, rho: Array) -> Array:
        """What the kernel makes of the density off the zone."""
        out = np.empty(rho.shape)
        (phi, weight), (left, right) = self._nodes, sides(self._nodes[0])
        for here in pair_blocks(len(rho), len(phi)):
            near = np.where(rho[here, None] > 0, right, left)
            size = np.abs(rho[here])[:, None]
            # rho (cos(phi) - rho) = |rho| (1 - |rho| - near), near the distance of cos(phi) from
            # the end on that side.
            out[here] = (
                (size * ((1 - size) - near) / ((1 - size) ** 2 + 2 * size * near))
                @ weight
                * (2 / np.pi)
            )
        return out

    def in_plane(self, seen: InPlane, what: What) -> Complex:
        """What the kernel makes of the density at complex points, or its derivative by zeta."""
        phi, weight = self._nodes
        rho, turn = seen.rho[:, None], np.exp(-1j * phi)
        b, own = (
            np.exp(seen.turned(np.cos(0.5 * phi), np.sin(0.5 * phi))),
            1j * self.spline.in_plane(seen, what),
        )
        if what == "transform":
            return np.asarray(own + (rho * turn / b) @ weight * (2 / np.pi))
        return np.asarray(own - (rho * turn / b**2) @ weight * (2 / np.pi) / seen.root)

    def integral(self, left: Array) -> Array:
        raise ValueError(
            "the integral along a zone is for kinks alone, or for densities without jumps of the right side"
        )

    def potential(self, left: Array, right: Array, rho: Array) -> Array:
        """Potential of the density over the half width, less c_0 log(half width), on the zone and
        off it.
        """
        phi, weight = self._nodes
        on = (left >= 0) & (right >= 0)
        rho = np.where(on, 1.0, rho)
        c_0 = float(weight @ np.cos(phi)) / np.pi
        out = -rho * self.mean - c_0 * np.log(2 * np.abs(rho))
        sine, cosine = np.sin(phi), np.cos(phi)
        end = float(weight @ (sine * 0.5 * (np.pi - phi))) * (2 / np.pi)
        off = np.flatnonzero(~on)
        for here in pair_blocks(len(off), len(phi)):
            r = rho[off[here], None]
            out[off[here]] += np.arctan2(r * sine, 1 - r * cosine) @ (weight * sine) * (2 / np.pi)
        whole = float(self.spline.integral(np.array([2.0]))[0])
        out[on] += end - (whole - self.spline.integral(left[on]) - self.mean * right[on])
        return out


def _graded(first: float, last: float) -> Array:
    """Cuts from 0 to pi: the panels at both ends have these lengths, and others are no longer than
    their distances from 0 and from pi.
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
    """(the function of two quadratic pieces with these values and slopes at 0 and 2, continuous at
    the cut with its slope; half of the jump of its second derivative there).
    """
    beyond = 2.0 - cut
    # Control points.
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
