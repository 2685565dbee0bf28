"""Truths of nearly full contact: the gaps' formulation run tighter than `solve` asks of it, and one narrow gap by expansion."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.bench.cases import by_gaps
from contact.profiles import Fourier
from contact.scene import Scene

Array = NDArray[np.float64]


class FromGaps:
    """The gaps' formulation as a truth."""

    def __init__(self, scene: Scene) -> None:
        self.fields = by_gaps(scene, 2e-15)
        profile = scene.profile
        assert profile.period is not None
        table = self.fields.problem.units.x(self.fields.zones)
        table = table - np.floor((table[:, :1] - profile.x0) / profile.period) * profile.period
        self.order = np.argsort(table[:, 0])
        self.zones, self.load, self.max_pressure = table[self.order], self.fields.load, self.fields.max_pressure

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        return np.asarray(self.fields.pressure_at(int(self.order[zone]), t))

    def pressure(self, x: ArrayLike) -> Array:
        return np.asarray(self.fields.pressure(x))


@dataclass(frozen=True, eq=False)
class LoneGap:
    """The one gap of a nearly full contact, where H f' = m - k y^2/2 about its maximum at y = 0: with D = m - 2 pbar/E*,

    w = 2 sqrt(D / k),   p = pbar - (E*/2) (H f' + D rho^2),   rho = z - sgn(z) sqrt(z^2 - 1), z = y / w,

    since sqrt(1 - t^2) U_1 is transformed to T_2 in the gap and to rho^2 outside (derived here; relative error ~ w^2).
    """

    profile: Fourier
    place: float
    lack: float
    half_gap: float
    mean: float
    load: float

    @classmethod
    def of(cls, profile: Fourier, full: float, scene: Scene) -> LoneGap:
        x = np.linspace(-0.5, 0.5, 4001)
        place = float(x[np.argmax(profile.slope_conjugate(x))])
        k = 2 * pi * np.arange(1, len(profile.cosine) + 1)  # type: ignore[arg-type]
        c, s = k * np.asarray(profile.cosine), k * np.asarray(profile.sine)
        for _ in range(8):  # Newton for the maximum of H f' = sum c cos kx + s sin kx
            first = k * (s * np.cos(k * place) - c * np.sin(k * place))
            second = -(k**2) * (c * np.cos(k * place) + s * np.sin(k * place))
            place -= float(first.sum() / second.sum())
        assert scene.mean_pressure is not None
        lack = 2 * (full - scene.mean_pressure)
        bend = float((k**2 * (c * np.cos(k * place) + s * np.sin(k * place))).sum())
        return cls(profile, place, lack, 2 * sqrt(lack / bend), scene.mean_pressure, scene.mean_pressure)

    @property
    def zones(self) -> Array:
        return np.array([[self.place + self.half_gap, self.place - self.half_gap + 1.0]])

    @property
    def max_pressure(self) -> float:
        return float(self.pressure(np.linspace(-0.5, 0.5, 4001)).max())

    def pressure(self, x: ArrayLike) -> Array:
        x = np.asarray(x, dtype=float)
        y = x - self.place - np.round(x - self.place)
        z = np.maximum(np.abs(y) / self.half_gap, 1.0)
        rho = z - np.sqrt((z - 1) * (z + 1))
        value = self.mean - 0.5 * (self.profile.slope_conjugate(x) + self.lack * rho**2)
        return np.asarray(np.where(np.abs(y) > self.half_gap, value, 0.0))

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        a, b = self.zones[0]
        return self.pressure(0.5 * (a + b) + 0.5 * (b - a) * np.asarray(t, dtype=float))
