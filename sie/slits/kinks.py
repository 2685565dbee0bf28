r"""A jump of the right side in a slit of a wide zone, in closed form.

Let h be the jump at s (see `sie.jumps.right_side`): of the right side for q = 0, of its q-th
derivative for q = 1, 2. It causes a density (h/pi)(t - s)^q kappa(t) on the wide zone, where the
logarithm kappa is infinite at s. The slack of the slit is singular at s, too. The singular part psi
of the slack is known and given here.

Let bar(f(.)) be the mean of f over the slit's equilibrium measure, where the dot is the place in
the slit. Let chi = arccos(-z)/pi be the distribution function of that measure, H the unit step and
m the middle of the slit. Then

    psi = h (H(t - s) - chi)                                for q = 0,
    psi = h ((t - s)_+ - bar((t - .)_+) - (m - s) chi)      for q = 1.

psi vanishes at both ends of the slit. P[psi] is the density that psi causes. With X = sqrt(1 - t^2)
and the angle phi of the jump, s = cos(phi),

    (h/pi) kappa + P[psi] = (h/pi) bar(kappa) + (a_0 + a_1 t) / X,
    (h/pi) (t - s) kappa + P[psi]
        = (h/pi)(bar((t - .) kappa) + (m - s) bar(kappa) - (phi - bar(phi)) X) + (a_0 + a_1 t) / X,
    a_0 = (1/pi) int psi tau / X,   a_1 = (1/pi) int psi / X.

Let r be the slit's half width. The means that occur are smooth on the slit, so that the rest of the
slack, which is computed as a series on the slit, is smooth, too:

    bar(ln|t - .|) = ln(r/2),   bar((t - .) ln|t - .|) = r z (ln(r/2) + 1)     on the slit,
    ln(r/2) + u   and   r sgn(z) (|z| (ln(r/2) + 1 + u) - sinh u)              off it, |z| = cosh u.

For q = 2, let t - m = r z, s - m = r zeta and b_k = bar((z - .)_+^k). Then

    psi = h r^2 ((z - zeta)_+^2 - b_2 + 2 zeta b_1 - (zeta^2 - 1/2) b_0),

and (t - s)^2 kappa is replaced by

    bar((t - .)^2 kappa) - 2 r zeta bar((t - .) kappa) + r^2 (zeta^2 - 1/2) bar(kappa).

The mean of (z - .)^2 ln|z - .| is z^2 (3/2 - ln 2) + 1/4 - (ln 2)/2 on the slit. It is (z^2 + 1/2)
(u - ln 2) + 2 |z| e^-u - e^-2u / 4 off the slit. The transforms of (t - s)^2 kappa and of its
replacement differ by a polynomial. A term of the density, X times another polynomial, cancels this
difference. Let D be phi - phi(.), y = t - m, and c the place in the slit, from -1 to 1, over which
the mean is taken. The term is (derived here)

    -(h/pi) X (bar(sin(phi) - sin(phi(.))) - 2 (s - m) bar(D) - 2 r bar(c D) + (y - m) bar(D)).
"""

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import Any

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Kept, Mask, legendre, record
from sie.basis.interval import Outside, root_weight, sides, theta
from sie.basis.sums import OPTIONS as SUMS
from sie.jumps.formulas import HIGHEST
from sie.trees.tree import SEPARATION

# Number of nodes of Gauss's rules for means over a slit, and for integrals over the slit's parts
# left and right of the jump. A narrow zone next to the slit requires twice the usual number of
# nodes.
_NODES = 2 * SUMS.gauss_nodes


@record
class SlitKink(Kept):
    """A jump of the right side, or of a derivative, in a slit (narrow gap inside a wide zone).

    jump: the scaled height h. start, rest, half: distances of the slit from the ends of the wide
    zone, and half width of the slit. from_left, from_right: distances of the jump from the ends of
    the wide zone. All five are divided by the zone's half width. order: the order q of the
    derivative that jumps.
    """

    jump: float
    start: float
    rest: float
    half: float
    from_left: float
    from_right: float
    order: int

    @cached_property
    def _jump_distances(self) -> tuple[float, float]:
        """Distances of the jump from the slit's left and right end, in half widths of the slit.

        Their exact sum is 2. In a slit as narrow as the round-off of positions, the differences
        `left` and `right` have another sum, so both are scaled.
        """
        left, right = max(self.from_left - self.start, 0.0), max(self.from_right - self.rest, 0.0)
        width = left + right
        return (2 * left / width, 2 * right / width) if width > 0.0 else (1.0, 1.0)

    @property
    def zeta(self) -> float:
        """Position of the jump in the slit's coordinate, which runs from -1 to 1."""
        left, right = self._jump_distances
        return 0.5 * (left - right)

    @cached_property
    def mean_places(self) -> tuple[Array, Array, Array]:
        """(Gauss nodes z of the slit, their distances from the wide zone's left end and right end).

        The distances are divided by the half width of the wide zone.
        """
        left, right = chebyshev.gauss_sides(_NODES)
        return (
            chebyshev.gauss(_NODES),
            self.start + self.half * left,
            self.rest + self.half * right,
        )

    # The methods below give psi. This is the part of the slack (the slit's unknown function) that
    # the jump causes, and it is known in closed form.
    @cached_property
    def _weights(self) -> tuple[float, ...]:
        """Coefficients e_j, j = 0 ... q, of the sum in `mixed`; q is the order of the jump."""
        return ((1.0,), (-self.zeta, 1.0), (self.zeta**2 - 0.5, -2 * self.zeta, 1.0))[self.order]

    def mixed(self, of_powers: Iterable[Any]) -> Any:
        """half^q times the sum of e_j `of_powers`[j] over j = 0 ... q, the order of the jump.
        The e_j are those of `_weights`. This sum forms psi, the part of the slack (the slit's
        unknown function) that the jump causes.

        psi is h half^q (z - zeta)_+^q, minus h times this sum of the means b_j of (z - .)_+^j, with
        the slit's coordinate z and the jump's place zeta in it. The same sum acts on every function
        derived from the powers.
        """
        return self.half**self.order * sum(
            e * part for e, part in zip(self._weights, of_powers, strict=False)
        )

    def slope(self, left: Array, right: Array) -> Array:
        """The part psi of the slack (the slit's unknown) due to the jump, at points of the slit.

        left, right: distances of the points from the slit's ends, in half widths of the slit.

        At the jump itself, psi is the mean of the values on both sides.
        """
        place = left - self._jump_distances[0]
        own = np.heaviside(place, 0.5) * (self.half * place) ** self.order
        return np.asarray(self.jump * (own - self.mixed(_spread_powers(left, right))))

    def opening(self, left: Array, right: Array) -> Array:
        """Integral of psi, the jump's part of the slack (see `slope`), from the slit's left end.

        The unit of length is the slit's half width.
        """
        place, q = np.maximum(left - self._jump_distances[0], 0.0), self.order
        integrals = (b / k for k, b in enumerate(_spread_powers(left, right)) if k)
        return np.asarray(
            self.jump * (self.half**q * place ** (q + 1) / (q + 1) - self.mixed(integrals))
        )

    @property
    def end_factor(self) -> float:
        """Factor J of the jump's part of the slack (the slit's unknown function) close to its ends.
        This part psi, see `slope`, is -(J/pi) sqrt(2 delta) at the small distance delta from the
        left end, and +(J/pi) sqrt(2 delta) at the distance delta from the right end. delta is
        divided by the slit's half width.
        """
        return self.jump * self.half**self.order * self._weights[0]

    @cached_property
    def quadrature(self) -> tuple[Array, Array, Array, Array]:
        """Quadrature rule (from_left, from_right, angles, weights W): int psi f dt = sum W f.
        The integral runs over the slit. psi is the part of the slack (the slit's unknown function)
        that the jump causes, and f is any smooth function.

        from_left, from_right: distances of the nodes from the ends of the wide zone; angles: of the
        nodes in that zone.
        """
        border = float(theta(*self._jump_distances[::-1]))
        beta, weights = legendre(np.array([0.0, border, np.pi]), _NODES)
        weight = weights * np.sin(beta)
        right, left = sides(beta)
        from_left, from_right = self.start + self.half * left, self.rest + self.half * right
        angle = theta(from_left, from_right)
        return from_left, from_right, angle, self.half * weight * self.slope(left, right)

    @cached_property
    def _weights_over_root(self) -> Array:
        """Weights of a quadrature rule for integrals of psi f / (pi X), with X = sqrt(1 - t^2).
        psi is the part of the slack due to the jump (see `slope`), f is any smooth function, and t
        is the coordinate of the wide zone.
        """
        from_left, from_right, _, weight = self.quadrature
        return np.asarray(weight / root_weight(from_left, from_right) / np.pi)

    @property
    def total(self) -> float:
        """Integral of psi over the slit, divided by pi times the slit's half width.
        psi is the part of the slack (the unknown function in the slit) that the jump causes.
        """
        return float(self.quadrature[3].sum()) / (np.pi * self.half)

    def slack_coefficients(self, count: int) -> Array:
        """Sine coefficients s_k, k = 0 ... `count`, of psi on the wide zone.
        psi is the part of the slack (the unknown function in the slit) that the jump causes.
        """
        _, _, angle, weight = self.quadrature
        return np.asarray(2 / np.pi * np.sin(np.arange(count + 1)[:, None] * angle) @ weight)

    @property
    def mean_opening(self) -> float:
        """Mean over the wide zone of the opening due to psi, divided by the zone's half width.
        psi is the jump's part of the slack, the slit's unknown function (see `slope`). The opening
        is the integral of psi from the slit's left end. The mean has the weight
        1 / sqrt(1 - t^2).
        """
        middle = theta(self.start + self.half, self.rest + self.half)
        _, _, angle, weight = self.quadrature
        return float((angle - middle) @ weight) / np.pi

    # The methods below give the density that psi causes on the wide zone. psi is the part of the
    # slack (the slit's unknown function) that belongs to the jump.
    @cached_property
    def edge(self) -> tuple[float, float]:
        """(a_0, a_1) of the part (a_0 + a_1 t) / sqrt(1 - t^2) of the density that psi causes.
        psi is the jump's part of the slack (the slit's unknown function), see `slope`.
        """
        from_left, from_right, _, _ = self.quadrature
        return float(self._weights_over_root @ (0.5 * (from_left - from_right))), float(
            self._weights_over_root.sum()
        )

    @cached_property
    def polynomial(self) -> tuple[float, float]:
        """(value at the slit's middle, slope) of a linear function P of the coordinate t.
        -P sqrt(1 - t^2) is a term of the density that the jump and psi (see `slope`) cause. P is
        zero for a jump of order 0 and constant for order 1.
        """
        if self.order == 0:
            return 0.0, 0.0
        cosine, l, r = self.mean_places
        s, places = 0.5 * (self.from_left - self.from_right), 0.5 * (l - r)
        # The differences between the jump's angle phi and the nodes' angles, and between the sines
        # of these angles, are computed without cancellation.
        away, roots = (
            self.half * (cosine - self.zeta),
            root_weight(self.from_left, self.from_right) + root_weight(l, r),
        )
        angles = 2 * np.arctan2(away, roots)
        mean = float(np.mean(angles))
        if self.order == 1:
            return self.jump / np.pi * mean, 0.0
        middle = 0.5 * (self.start - self.rest)
        sines = float(np.mean((s + places) * away / roots - middle * angles))
        value = sines - 2 * self.half * (self.zeta * mean + float(np.mean(cosine * angles)))
        return self.jump / np.pi * value, self.jump / np.pi * mean

    def _linear_term(self, from_left: Array, from_right: Array) -> Array:
        """Values of the linear function given by `polynomial`, at points of the wide zone.

        from_left, from_right: distances from the zone's ends, in half widths of the zone.
        """
        value, slope = self.polynomial
        return np.asarray(
            value + slope * 0.5 * ((from_left - self.start) - (from_right - self.rest))
        )

    def in_slit(self, from_left: Array, from_right: Array, z: Array) -> Array:
        """Density in the slit due to the jump and to psi (see `slope`), times sqrt(1 - t^2).

        The density is (h/pi)(t - s)^q kappa + P[psi]. from_left, from_right: distances from the
        wide zone's ends; z: the same places in the coordinate of this slit.
        """
        root, (a_0, a_1) = root_weight(from_left, from_right), self.edge
        value = (
            self.jump / np.pi * self._smoothed(from_left, from_right, z)
            - self._linear_term(from_left, from_right) * root
        )
        return np.asarray(root * value + a_0 + a_1 * 0.5 * (from_left - from_right))

    def outside_slit(
        self, from_left: Array, from_right: Array, outside: Array, past: Mask
    ) -> Array:
        """Density outside the slit due to psi (see `slope`), without the terms a_0, a_1 of `edge`.

        outside: distance from the slit in its half widths; past: whether a point is right of it.
        """
        # Far from the slit the closed forms for order 2 lose digits by cancellation. The integral
        # over psi (see `slope`) is computed numerically there.
        if self.order == HIGHEST and np.any(outside > SEPARATION):
            out, far = np.empty(outside.shape), outside > SEPARATION
            out[far] = self._summed(from_left[far], from_right[far], outside[far], past[far])
            out[~far] = self.outside_slit(
                from_left[~far], from_right[~far], outside[~far], past[~far]
            )
            return out
        z = np.where(past, 1.0, -1.0) * (1 + outside)
        away = outside + np.where(past, self._jump_distances[1], self._jump_distances[0])
        sums = 2 * np.log(
            np.sqrt(from_right * self.from_left) + np.sqrt(from_left * self.from_right)
        ) - np.log(2.0)
        own = (sums - np.log(self.half * away)) * (
            self.half * np.where(past, away, -away)
        ) ** self.order
        smoothed = self._smoothed(from_left, from_right, z)
        return np.asarray(
            -self.jump / np.pi * (own - smoothed)
            - self._linear_term(from_left, from_right) * root_weight(from_left, from_right)
        )

    def _summed(self, from_left: Array, from_right: Array, outside: Array, past: Mask) -> Array:
        """The density of `outside_slit` at points far from the slit, by numerical quadrature.

        It is (X(t)/pi) int psi / (X(tau) (t - tau)) dtau, with X(t) = sqrt(1 - t^2).
        """
        lefts = self.quadrature[0]
        inward = np.where(past[:, None], self.start + 2 * self.half - lefts, lefts - self.start)
        away = np.where(past, 1.0, -1.0)[:, None] * (self.half * outside[:, None] + inward)
        return np.asarray(
            root_weight(from_left, from_right) * ((1 / away) @ self._weights_over_root)
        )

    def _smoothed(self, from_left: Array, from_right: Array, z: Array) -> Array:
        """The smooth function that replaces the jump's singular density (t - s)^q kappa.
        kappa is a logarithm that is infinite at the jump's position s, and q is the jump's order.
        For q = 0 the smooth function is the mean of kappa over all positions s in the slit. The
        head of this file has the functions for q = 1 and 2.
        """
        nodes, l, r = self.mean_places
        sums = 2 * np.log(
            np.sqrt(from_right[..., None] * l) + np.sqrt(from_left[..., None] * r)
        ) - np.log(2.0)
        seen = Outside(np.sign(z), np.maximum(np.abs(z) - 1, 0.0))
        u, constant = seen.log, np.log(0.5 * self.half)

        def means() -> Iterator[Array]:
            yield sums.mean(axis=-1) - (constant + u)
            away = z[..., None] - nodes
            yield (sums * away).mean(axis=-1) - (z * (constant + 1 + u) - seen.root)
            fall, on = np.exp(-u), z * z * (constant + 1.5) + 0.25 + 0.5 * constant
            off = (z * z + 0.5) * (constant + u) + (2 * np.abs(z) - 0.25 * fall) * fall
            yield (sums * away**2).mean(axis=-1) - np.where(np.abs(z) > 1, off, on)

        return np.asarray(self.mixed(means()))

    @cached_property
    def edge_slopes(self) -> tuple[float, float]:
        """Derivatives of the density `outside_slit` by the angle from each end of the wide zone."""
        if self.order == HIGHEST:
            lefts, rights, _, _ = self.quadrature
            return -float(self._weights_over_root @ (1 / lefts)), float(
                self._weights_over_root @ (1 / rights)
            )
        _, l, r = self.mean_places
        out = []
        sides = (
            (-1.0, l, r, self.from_left, self.from_right),
            (1.0, r, l, self.from_right, self.from_left),
        )
        for sign, near, far, own_near, own_far in sides:
            own = (sign * own_near) ** self.order * np.sqrt(own_far / own_near)
            spread = float(
                self.mixed(
                    np.mean((sign * near / self.half) ** j * np.sqrt(far / near))
                    for j in range(HIGHEST)
                )
            )
            out.append(-self.jump / np.pi * (own - spread) - self.polynomial[0])
        return out[0], out[1]


def _spread_powers(left: Array, right: Array) -> tuple[Array, Array, Array, Array]:
    """Means over the slit's places z' of (z - z')^k if z > z', and of 0 if z < z', k = 0 ... 3.

    The mean over z' has the weight 1 / (pi sqrt(1 - z'^2)). left, right: distances of z from the
    slit's ends, in its half widths.
    """
    angle, z, root = (
        theta(right, left) / np.pi,
        0.5 * (left - right),
        root_weight(left, right) / np.pi,
    )
    second, third = (
        angle * (z * z + 0.5) + 1.5 * z * root,
        angle * z * (z * z + 1.5) + root * (11 * z * z + 4) / 6,
    )
    return angle, z * angle + root, second, third
