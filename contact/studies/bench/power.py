"""Exact solutions of an isolated even power, and of many equal waves."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.reference.exact import SymmetricZone, Westergaard

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PowerPunch(SymmetricZone):
    """The contact of the profile f = x^n/n, n even, on [-1, 1] with E* = 1 (Shtaerman 1949).

    The pressure is p = (1/2) sqrt(1 - x^2) sum_k b_k x^(n-2-2k), b_k = (2k choose k)/4^k, from the
    polynomial part of x^(n-1)/sqrt(x^2 - 1). The residue of this function at infinity gives the
    load P = (pi/2) b_(n/2).
    """

    order: int
    half_width = 1.0
    period = None

    @property
    def _series(self) -> Array:
        k = np.arange(1, self.order // 2 + 1)
        return np.concatenate(([1.0], np.cumprod((2 * k - 1) / (2 * k))))

    @property
    def load(self) -> float:
        return float(self._series[-1] * pi / 2)

    def _pressure(self, r: Array, d: Array) -> Array:
        return np.asarray(0.5 * np.sqrt(d * (1 + r)) * np.polyval(self._series[:-1], r * r))

    @property
    def max_pressure(self) -> float:
        return float(self.pressure_at(np.cos(np.linspace(0, pi / 2, 20001))).max())


@dataclass(frozen=True, eq=False)
class Repeated:
    """The contact of `count` equal waves in a period of length 1.

    The first tip is at x = shift/count. The left ends of the zones lie in [-1/2, 1/2).
    """

    one: Westergaard
    count: int
    shift: float = 0.0

    @property
    def zones(self) -> Array:
        first = self.shift / self.count + float(self.one.zones[0, 0])
        k = np.arange(self.count) + np.ceil((-0.5 - first) * self.count)
        return np.asarray(((k + self.shift) / self.count)[:, None] + self.one.zones)

    @property
    def load(self) -> float:
        return self.count * self.one.load

    @property
    def max_pressure(self) -> float:
        return self.one.max_pressure

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        return self.one.pressure_at(np.asarray(t))

    def pressure(self, x: ArrayLike) -> Array:
        return self.one.pressure(np.asarray(x) - self.shift / self.count)
