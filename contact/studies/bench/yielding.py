"""Flat punches that yield beside their corners: closed form under a limit of the pressure.

Punches of the width 2a stand at the period L. The contact is elastic for |x| < c, and the pressure
is the hardness H from there to the corners. With u = pi x / L, A = pi a / L and C = pi c / L,

    p = H (1 - (2/pi) arctan(tan(B) sqrt(sin^2 C - sin^2 u) / cos u)),   sin B = cos A / cos C,

and the mean pressure is (2/pi) H arccos(cos A / cos C). For L -> infinity, p follows from the
elastic pressure: p = (2/pi) H arcsin(pi p_elastic / (2 H)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class YieldingPunches:
    """Contact of flat punches [m] under a limit of the pressure.

    half_width: a; elastic: c, the half width of the elastic part; period: L; hardness: H [Pa].
    """

    half_width: float
    elastic: float
    period: float
    hardness: float

    @property
    def zones(self) -> Array:
        return np.array([[-self.half_width, self.half_width]])

    @property
    def mean_pressure(self) -> float:
        return float(2 / np.pi * self.hardness * np.arccos(self._ratio))

    @property
    def load(self) -> float:
        return self.mean_pressure * self.period

    @property
    def max_pressure(self) -> float:
        return self.hardness

    @property
    def _ratio(self) -> float:
        """cos A / cos C."""
        turn = np.pi / self.period
        return float(np.cos(turn * self.half_width) / np.cos(turn * self.elastic))

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Pressure at normalised positions t in a punch."""
        return self.pressure(self.half_width * np.asarray(t, dtype=float))

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure [Pa] at places x [m]; 0 between the punches."""
        x = np.asarray(x, dtype=float)
        x = x - self.period * np.round(x / self.period)
        u, edge = np.pi * x / self.period, np.pi * self.elastic / self.period
        root = np.sqrt(np.maximum(np.sin(edge + u) * np.sin(edge - u), 0.0))
        rise = np.tan(np.arcsin(self._ratio)) * root / np.cos(u)
        inside = np.abs(x) <= self.half_width
        return np.where(inside, self.hardness * (1 - 2 / np.pi * np.arctan(rise)), 0.0)
