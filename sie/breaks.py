r"""Jumps of the density or of its derivatives inside the zones, carried exactly: the mirror image of `steps`.

Where the wanted density is known to jump, the right side has a logarithm. With t = cos(theta), s = cos(phi) and

    eta(t) = theta/pi  (t > s),   theta/pi - 1  (t < s)      = -(2/pi) sum_j (1/j) cos(j phi) sin(j theta),

which vanishes at both ends like a square root and jumps by 1 at s, the kernel makes of h (t - s)^q eta(t)

    (h/pi) ((t - s)^q ln(2 |t - s|) - P_q(t))                       on the zone,
    (h/pi) ((z - s)^q ln(1 - 2 rho cos(phi) + rho^2) - P_q(z))      off it,
    P_0 = 0,   P_1 = -s,   P_2 = -(t - 2 s) s - cos(2 phi)/4,

P_q from (tau - s)^q = (t - s)^q - (t - tau)(...) and the moments of eta. So where the q-th derivative of the density
jumps by J, h = J w^q / q!, the right side is smooth once this is subtracted: q = 0 is the slope of a gap over a kink of
the profile, q = 1 over a jump of its curvature, q = 2 over a knot of a cubic spline.

For q = 0 the caller leaves (J/pi) Lambda(x, s), Lambda the kernel's potential, out of the right side's values
altogether: it is added here, from distances that lose no digit however narrow the zone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sie.kernels import Kernel
from sie.steps import Steps
from sie.zones import Zones

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Logarithms:
    """Terms (J/pi) Lambda(x, s) of the right side: places s, and J/pi. own: the zone that holds s, or -1."""

    kernel: Kernel
    zones: Zones
    at: Array
    weight: Array
    own: Index

    def at_points(self, x: Array) -> Array:
        """Their sum at points x (n,)."""
        away = x[:, None] - self.at
        with np.errstate(divide="ignore"):
            return np.asarray((np.log(np.abs(away) / self.kernel.datum) + self._far(away)) @ self.weight)

    def on_zone(self, zone: int, left: Array) -> Array:
        """Their sum at distances over w from a zone's left end, less (J/pi) ln(2 |t - s|) for those that lie in it."""
        w, kernel = self.zones.half[zone], self.kernel
        away = w * left[:, None] + (self.zones.a[zone] - self.at)
        mine = self.own == zone
        with np.errstate(divide="ignore"):
            near = np.where(mine, np.log(w / (2 * kernel.datum)), np.log(np.abs(away) / kernel.datum))
        return np.asarray((near + self._far(away)) @ self.weight)

    def _far(self, away: Array) -> Array:
        """Lambda less its nearest logarithm."""
        kernel = self.kernel
        out = np.zeros(away.shape)
        for shift in kernel.poles:
            if shift != 0.0:
                out += np.log(np.abs(away - shift) / kernel.datum)
        if kernel.regular_potential is not None:
            out += kernel.regular_potential(away, np.zeros(1))
        return out


@dataclass(frozen=True, eq=False)
class Breaks(Steps):
    """Jumps of the density's derivatives, h = J w^q / q!; `logarithms`: all those of order 0, wherever they are."""

    logarithms: Logarithms | None = None

    @classmethod
    def inside(cls, zones: Zones, at: Array, jumps: Array, orders: Index, kernel: Kernel) -> Breaks:
        """The jumps at positions `at` (repeated with the kernel's period) that lie inside a zone."""
        at, i, inside = cls.located(zones, at, kernel.period)
        w = zones.half[i]
        size = jumps * w**orders / np.array([1.0, 1.0, 2.0])[orders]
        kinks = orders == 0
        logarithms = None
        if np.any(kinks):
            own = np.where(inside, i, -1)[kinks]
            logarithms = Logarithms(kernel, zones, at[kinks], jumps[kinks] / np.pi, own)
        i, at, w = i[inside], at[inside], w[inside]
        return cls(i, (at - zones.a[i]) / w, (zones.b[i] - at) / w, size[inside], orders[inside], logarithms)

    def _polynomial(self, k: Index, t: Array) -> Array:
        q, s = self.order[k], self.s[k]
        second = -(t - 2 * s) * s - np.cos(2 * self.phi[k]) / 4
        return np.where(q == 0, 0.0, np.where(q == 1, -s, second))

    def smooth_part(self, zone: int, left: Array) -> Array:
        out = np.zeros(left.shape) if self.logarithms is None else self.logarithms.on_zone(zone, left)
        return out - self._on_zone(zone, left, 1)

    def adds_to(self, zone: int) -> bool:
        return self.logarithms is not None or zone in self.by_zone

    def own_transform(self, zone: int, left: Array) -> Array:
        return self._on_zone(zone, left, 0)

    def left_out(self, x: Array) -> Array:
        return np.zeros(x.shape) if self.logarithms is None else self.logarithms.at_points(x)

    def _on_zone(self, zone: int, left: Array, least: int) -> Array:
        """Transform on the zone itself of its parts of order `least` and above."""
        k = self.by_zone.get(zone)
        k = None if k is None else k[self.order[k] >= least]
        if k is None or len(k) == 0:
            return np.zeros(left.shape)
        away, q = left[..., None] - self.left[k], self.order[k]
        with np.errstate(divide="ignore", invalid="ignore"):
            logs = np.log(2 * np.abs(away))
            value = np.where((q > 0) & (away == 0), 0.0, away**q * logs) - self._polynomial(k, left[..., None] - 1)
        return np.asarray(value @ (self.height[k] / np.pi))

    def _sine_weights(self, k: Index, j: Array) -> Array:
        return -np.cos(j * self.phi[k][:, None])

    def mean_offsets(self, zones: Zones) -> Array:
        raise ValueError("a condition on potentials is for right sides without logarithms")

    def edge_slopes(self, zones: Zones) -> tuple[Array, Array]:
        scale, n = self.height / np.pi, len(zones)
        left = np.bincount(self.zone, -scale * (-self.left) ** self.order, minlength=n)
        right = np.bincount(self.zone, scale * self.right**self.order, minlength=n)
        return np.asarray(left, dtype=float), np.asarray(right, dtype=float)

    def density(self, zone: int, left: Array, right: Array) -> Array:
        k = self.by_zone[zone]
        away = left[:, None] - self.left[k]
        from_right, from_left = 2 * np.arctan2(np.sqrt(right), np.sqrt(left)), 2 * np.arctan2(np.sqrt(left), np.sqrt(right))
        eta = np.where(away > 0, from_right[:, None], -from_left[:, None])
        eta = np.where(away == 0, 0.5 * (from_right - from_left)[:, None], eta)
        return np.asarray((away ** self.order[k] * eta) @ (self.height[k] / np.pi))

    def _plain(self, k: Index, rho: Array) -> Array:
        # |1 - rho e^{i phi}|^2 from the distance to the nearer end, where both terms are positive.
        rho = rho[:, None]
        end = np.where(rho > 0, self.right[k], self.left[k])
        return np.asarray(np.log((1 - np.abs(rho)) ** 2 + 2 * np.abs(rho) * end))

    def integral(self, zone: int, left: Array, right: Array) -> Array:
        """Integral of a zone's parts from its left end, at distances from the ends over w; over w.

        From the ends inwards: int_t^1 (tau - s)^q eta = (1/pi) int_0^theta (cos a - s)^q a sin(a) da for t > s.
        """
        k = self.by_zone[zone]
        s, q = self.s[k], self.order[k]
        beyond = left[:, None] > self.left[k]
        inner = np.where(beyond, 2 * np.arctan2(np.sqrt(right), np.sqrt(left))[:, None],
                         2 * np.arctan2(np.sqrt(left), np.sqrt(right))[:, None])
        # Seen from the left end, t and s change sign, and so does (tau - s)^q for odd q.
        shift = np.where(beyond, s, -s)
        sine, cosine = np.sin(inner), np.cos(inner)
        first = sine - inner * cosine
        second = np.sin(2 * inner) / 8 - inner * np.cos(2 * inner) / 4
        third = (sine - sine**3 / 3 - inner * cosine**3) / 3
        square = third - 2 * shift * second + shift**2 * first
        part = np.where(q == 0, first, np.where(q == 1, second - shift * first, square))
        total = np.pi * self._coefficients(k, 1)[:, 0]
        sign = np.where(q == 1, 1.0, -1.0)
        value = np.where(beyond, total - self.height[k] / np.pi * part, sign * self.height[k] / np.pi * part)
        return np.asarray(value.sum(axis=1))

    def _phased(self, place: int, by_phase: tuple[NDArray[np.complex128], NDArray[np.complex128]]) -> Array:
        return -np.real(by_phase[0] + by_phase[1]) / 2

    def _first(self, place: int) -> float:
        return float(-np.cos(self.phi[place]))
