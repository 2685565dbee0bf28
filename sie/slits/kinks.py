r"""A kink in a hole, or a jump of the curvature: what the right side jumps by in a hole of a wide zone, carried in closed form.

With h the jump (see `steps`), q = 0 that of the right side, q = 1 of its derivative, the zone's own part of it,
(h/pi)(t - s)^q kappa(t), is singular at s, and the slope of the gap with it. Let bars be means over the hole's equilibrium
measure, and chi = arccos(-z)/pi the step whose jump is spread like that. Then psi = h (H(t - s) - chi), or for q = 1, m being
the hole's middle, h ((t - s)_+ - bar((t - .)_+) - (m - s) chi), vanishes at both ends of the hole, and with psi taken out of s

    (h/pi) kappa + P[psi] = (h/pi) bar(kappa) + (a_0 + a_1 t) / X,           a_0 = (1/pi) int psi tau / X,  a_1 = (1/pi) int psi / X,
    (h/pi) (t - s) kappa + P[psi] = (h/pi)(bar((t - .) kappa) + (m - s) bar(kappa) - (phi - bar(phi)) X) + (a_0 + a_1 t) / X,

whose logarithms are, r the hole's half width, ln(r/2) and r z (ln(r/2) + 1) on the hole: what is left for its series is smooth.
Off the hole, with |z| = cosh u, they are ln(r/2) + u and r sgn(z) (|z| (ln(r/2) + 1 + u) - sinh u). (Derived here.)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sie.basis.kept import Kept

Array = NDArray[np.float64]

# Orders q that are carried.
HIGHEST = 1
_MEANS = 32
_LEGENDRE = 24


@dataclass(frozen=True, eq=False)
class Valley(Kept):
    """jump: h. start, rest, half: the hole, in the wide zone's half width: distances from that zone's ends, half width.
    from_left, from_right: distances of the jump from the ends of the wide zone. order: q."""

    jump: float
    start: float
    rest: float
    half: float
    from_left: float
    from_right: float
    order: int

    @cached_property
    def _beside(self) -> tuple[float, float]:
        """Distances of the jump from the left and right end of the hole, over the hole's half width."""
        return (self.from_left - self.start) / self.half, (self.from_right - self.rest) / self.half

    @property
    def zeta(self) -> float:
        """The jump's place in the hole."""
        left, right = self._beside
        return 0.5 * (left - right)

    @cached_property
    def mean_places(self) -> tuple[Array, Array, Array]:
        """Gauss nodes of the equilibrium measure: z, and distances from the wide zone's ends."""
        theta = (np.arange(_MEANS) + 0.5) * np.pi / _MEANS
        left, right = 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2
        return np.cos(theta), self.start + self.half * left, self.rest + self.half * right

    # psi ------------------------------------------------------------------------------------------------------------
    def slope(self, left: Array, right: Array) -> Array:
        """psi at distances from the hole's ends over its half width; the mean of both sides at a kink."""
        place, angle, z = left - self._beside[0], 2 * np.arctan2(np.sqrt(left), np.sqrt(right)), 0.5 * (left - right)
        if self.order == 0:
            return np.asarray(self.jump * (np.heaviside(place, 0.5) - angle / np.pi))
        spread = (z * angle + np.sqrt(left * right)) / np.pi
        return np.asarray(self.jump * self.half * (np.maximum(place, 0.0) - spread + self.zeta * angle / np.pi))

    def opening(self, left: Array, right: Array) -> Array:
        """Integral of psi from the hole's left end, over its half width."""
        angle, z = 2 * np.arctan2(np.sqrt(left), np.sqrt(right)), 0.5 * (left - right)
        root, place = np.sqrt(left * right), np.maximum(left - self._beside[0], 0.0)
        first = (z * angle + root) / np.pi
        if self.order == 0:
            return np.asarray(self.jump * (place - first))
        second = (angle * (0.5 * z * z + 0.25) + 0.75 * z * root) / np.pi
        return np.asarray(self.jump * self.half * (0.5 * place**2 - second + self.zeta * first))

    @property
    def at_ends(self) -> float:
        """J of psi = -+(J/pi) sqrt(2 delta) at the hole's ends, delta the distance over its half width."""
        return self.jump if self.order == 0 else -self.jump * self.half * self.zeta

    @cached_property
    def seen(self) -> tuple[Array, Array, Array, Array]:
        """(distances from the wide zone's ends, angles there, weights that hold psi): int psi f dt = sum W f."""
        border = 2 * np.arctan2(*np.sqrt(self._beside))
        x, w = np.polynomial.legendre.leggauss(_LEGENDRE)
        beta = np.concatenate((0.5 * border * (1 + x), border + 0.5 * (np.pi - border) * (1 + x)))
        weight = np.concatenate((0.5 * border * w, 0.5 * (np.pi - border) * w)) * np.sin(beta)
        left, right = 2 * np.sin(beta / 2) ** 2, 2 * np.cos(beta / 2) ** 2
        from_left, from_right = self.start + self.half * left, self.rest + self.half * right
        angle = 2 * np.arctan2(np.sqrt(from_right), np.sqrt(from_left))
        return from_left, from_right, angle, self.half * weight * self.slope(left, right)

    @property
    def total(self) -> float:
        """int psi dt over pi times the hole's half width."""
        return float(self.seen[3].sum()) / (np.pi * self.half)

    def told(self, count: int) -> Array:
        """s_k of psi, k = 0 ... count."""
        _, _, theta, weight = self.seen
        return np.asarray(2 / np.pi * np.sin(np.arange(count + 1)[:, None] * theta) @ weight)

    @property
    def mean_opening(self) -> float:
        """Mean over the wide zone of the integral of psi, over that zone's half width, as that of a hole's series is counted."""
        middle = 2 * np.arctan2(np.sqrt(self.rest + self.half), np.sqrt(self.start + self.half))
        _, _, theta, weight = self.seen
        return float((theta - middle) @ weight) / np.pi

    # what it makes of the density ---------------------------------------------------------------------------------------
    @cached_property
    def edge(self) -> tuple[float, float]:
        """(a_0, a_1): P[psi] has (a_0 + a_1 t) / X."""
        from_left, from_right, _, weight = self.seen
        over = weight / np.sqrt(from_left * from_right) / np.pi
        return float(over @ (0.5 * (from_left - from_right))), float(over.sum())

    @cached_property
    def turn(self) -> float:
        """(h/pi)(phi - bar(phi)), which multiplies X for q = 1; else 0."""
        if self.order == 0:
            return 0.0
        _, l, r = self.mean_places
        own = 2 * np.arctan2(np.sqrt(self.from_right), np.sqrt(self.from_left))
        return self.jump / np.pi * float(np.mean(own - 2 * np.arctan2(np.sqrt(r), np.sqrt(l))))

    def in_hole(self, from_left: Array, from_right: Array, z: Array) -> Array:
        """X ((h/pi)(t - s)^q kappa + P[psi]) at distances from the wide zone's ends, on this hole or another one; z: in this hole."""
        root, (a_0, a_1) = np.sqrt(from_left * from_right), self.edge
        value = self.jump / np.pi * self._spread(from_left, from_right, z) - self.turn * root
        return np.asarray(root * value + a_0 + a_1 * 0.5 * (from_left - from_right))

    def beside(self, from_left: Array, from_right: Array, outside: Array, past: NDArray[np.bool_]) -> Array:
        """P[psi] less (a_0 + a_1 t)/X, off the hole by `outside` of its half width. past: on its right."""
        z = np.where(past, 1.0, -1.0) * (1 + outside)
        away = outside + np.where(past, self._beside[1], self._beside[0])
        sums = 2 * np.log(np.sqrt(from_right * self.from_left) + np.sqrt(from_left * self.from_right)) - np.log(2.0)
        own = (sums - np.log(self.half * away)) * (self.half * np.where(past, away, -away)) ** self.order
        spread = self._spread(from_left, from_right, z)
        return np.asarray(-self.jump / np.pi * (own - spread) - self.turn * np.sqrt(from_left * from_right))

    def _spread(self, from_left: Array, from_right: Array, z: Array) -> Array:
        """bar(kappa); for q = 1 bar((t - .) kappa) + (m - s) bar(kappa)."""
        nodes, l, r = self.mean_places
        sums = 2 * np.log(np.sqrt(from_right[..., None] * l) + np.sqrt(from_left[..., None] * r)) - np.log(2.0)
        beyond = np.maximum(np.abs(z) - 1, 0.0)
        root = np.sqrt(beyond * (beyond + 2))
        u, constant = np.log1p(beyond + root), np.log(0.5 * self.half)
        plain = sums.mean(axis=-1) - constant - u
        if self.order == 0:
            return np.asarray(plain)
        moment = (sums * (z[..., None] - nodes)).mean(axis=-1)
        log = z * (constant + 1 + u) - np.sign(z) * root
        return np.asarray(self.half * (moment - log - self.zeta * plain))

    @cached_property
    def edge_slopes(self) -> tuple[float, float]:
        """Coefficient of the angle from the wide zone's left and right end in what `beside` gives."""
        _, l, r = self.mean_places
        out = []
        sides = ((-1.0, l, r, self.from_left, self.from_right), (1.0, r, l, self.from_right, self.from_left))
        for sign, near, far, own_near, own_far in sides:
            own = (sign * own_near) ** self.order * np.sqrt(own_far / own_near)
            spread = float(np.mean((sign * near) ** self.order * np.sqrt(far / near)))
            if self.order == 1:
                spread -= self.half * self.zeta * float(np.mean(np.sqrt(far / near)))
            out.append(-self.jump / np.pi * (own - spread) - self.turn)
        return out[0], out[1]
