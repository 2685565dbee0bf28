r"""A kink in a hole: the right side jumps by J between the pieces on both sides, and so does the slope s of the gap.

The zone's own part of such a jump (see `steps`), (J/pi) kappa(t), is a logarithm at the kink, and s with it. With
chi = arccos(-z)/pi over the hole, the step whose jump is spread there as the equilibrium measure, and zeta the kink's place z,

    s = psi + (smooth over sqrt(1 - z^2)),      psi = J (H(z - zeta) - chi(z)),

    (J/pi) kappa + P[psi] = (J/pi) kappa_bar + (a_0 + a_1 t) / X,      a_0 = (J/pi)(sin phi - mean sin),  a_1 = (J/pi)(phi - mean phi),

means over that measure. Its logarithm is constant on the hole, ln(r/2), r the hole's half width, and ln(r / 2 rho) off it: so what is left
for the series of the hole is smooth. psi is bounded at the hole's ends, -+(J/pi) sqrt(2 delta), and its integral is -J zeta r.
(Derived here.)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_MEANS = 32
_LEGENDRE = 24


@dataclass(frozen=True, eq=False)
class Valley:
    """jump: J. start, rest, half: the hole, in the wide zone's half width: distances from that zone's ends, half width.
    from_left, from_right: distances of the kink from the ends of the wide zone."""

    jump: float
    start: float
    rest: float
    half: float
    from_left: float
    from_right: float

    @property
    def _beside(self) -> tuple[float, float]:
        """Distances of the kink from the left and right end of the hole, over the hole's half width."""
        return (self.from_left - self.start) / self.half, (self.from_right - self.rest) / self.half

    @property
    def zeta(self) -> float:
        left, right = self._beside
        return 0.5 * (left - right)

    @cached_property
    def _mean_places(self) -> tuple[Array, Array]:
        """Distances from the wide zone's ends of the Gauss nodes of the equilibrium measure."""
        theta = (np.arange(_MEANS) + 0.5) * np.pi / _MEANS
        return self.start + self.half * 2 * np.cos(theta / 2) ** 2, self.rest + self.half * 2 * np.sin(theta / 2) ** 2

    # psi ------------------------------------------------------------------------------------------------------------
    @cached_property
    def quadrature(self) -> tuple[Array, Array, Array]:
        """(distances from the hole's left and right end over its half width, weights that hold psi): int psi f dz = sum W f."""
        left, right = self._beside
        border = 2 * np.arctan2(np.sqrt(left), np.sqrt(right))
        x, w = np.polynomial.legendre.leggauss(_LEGENDRE)
        beta = np.concatenate((0.5 * border * (1 + x), border + 0.5 * (np.pi - border) * (1 + x)))
        weight = np.concatenate((0.5 * border * w, 0.5 * (np.pi - border) * w)) * np.sin(beta)
        step = np.concatenate((np.zeros(len(x)), np.ones(len(x))))
        return 2 * np.sin(beta / 2) ** 2, 2 * np.cos(beta / 2) ** 2, self.jump * (step - beta / np.pi) * weight

    def slope(self, left: Array, right: Array) -> Array:
        """psi at distances from the hole's ends over its half width; the mean of both sides at the kink."""
        place = left - self._beside[0]
        return self.jump * (np.heaviside(place, 0.5) - 2 * np.arctan2(np.sqrt(left), np.sqrt(right)) / np.pi)

    def opening(self, left: Array, right: Array) -> Array:
        """Integral of psi from the hole's left end, over its half width."""
        angle, z = 2 * np.arctan2(np.sqrt(left), np.sqrt(right)), 0.5 * (left - right)
        # int arccos(-z) = z arccos(-z) + sqrt(1 - z^2)
        return self.jump * (np.maximum(left - self._beside[0], 0.0) - (z * angle + np.sqrt(left * right)) / np.pi)

    # what it makes of the density ---------------------------------------------------------------------------------------
    @cached_property
    def edge(self) -> tuple[float, float]:
        """(a_0, a_1): P[psi] has (a_0 + a_1 t) / X."""
        l, r = self._mean_places
        phi, own = 2 * np.arctan2(np.sqrt(r), np.sqrt(l)), 2 * np.arctan2(np.sqrt(self.from_right), np.sqrt(self.from_left))
        scale = self.jump / np.pi
        return scale * float(np.mean(np.sin(own) - np.sin(phi))), scale * float(np.mean(own - phi))

    def in_hole(self, from_left: Array, from_right: Array, outside: Array) -> Array:
        """X ((J/pi) kappa + P[psi]) at distances from the wide zone's ends, on holes: outside, how far from this one's nearer end over
        its half width (0 on it)."""
        log = np.log(0.5 * self.half) - np.log(_rho(outside))
        kappa = self._mean_sum(from_left, from_right) - np.log(2.0) - log
        a_0, a_1 = self.edge
        return np.sqrt(from_left * from_right) * self.jump / np.pi * kappa + a_0 + a_1 * 0.5 * (from_left - from_right)

    def beside(self, from_left: Array, from_right: Array, outside: Array, past: NDArray[np.bool_] | bool) -> Array:
        """P[psi] less (a_0 + a_1 t)/X off the hole: -(J/pi)(kappa - kappa_bar). past: on the hole's right."""
        left, right = self._beside
        own = 2 * np.log(np.sqrt(from_right * self.from_left) + np.sqrt(from_left * self.from_right))
        away = outside + np.where(past, right, left)
        log = -np.log(2 * _rho(outside) * away)
        return -self.jump / np.pi * (own - self._mean_sum(from_left, from_right) + log)

    def _mean_sum(self, from_left: Array, from_right: Array) -> Array:
        l, r = self._mean_places
        both = np.sqrt(np.asarray(from_right)[..., None] * l) + np.sqrt(np.asarray(from_left)[..., None] * r)
        return np.asarray(2 * np.log(both).mean(axis=-1))

    @cached_property
    def edge_slopes(self) -> tuple[float, float]:
        """Coefficient of the angle from the wide zone's left and right end in what `beside` gives."""
        l, r = self._mean_places
        scale = -self.jump / np.pi
        return (
            scale * float(np.sqrt(self.from_right / self.from_left) - np.mean(np.sqrt(r / l))),
            scale * float(np.sqrt(self.from_left / self.from_right) - np.mean(np.sqrt(l / r))),
        )

    # what others see of psi -----------------------------------------------------------------------------------------------
    @cached_property
    def seen(self) -> tuple[Array, Array, Array, Array]:
        """(distances from the wide zone's ends, angles there, weights over that zone's half width): int psi f dt = sum W f."""
        left, right, weight = self.quadrature
        from_left, from_right = self.start + self.half * left, self.rest + self.half * right
        return from_left, from_right, 2 * np.arctan2(np.sqrt(from_right), np.sqrt(from_left)), self.half * weight

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


def _rho(outside: Array) -> Array:
    return np.asarray(1 / (1 + outside + np.sqrt(outside * (outside + 2))))
