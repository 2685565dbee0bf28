"""A stand-in for a solution, for tests of code that only reads solutions.

It is Westergaard's contact in closed form, with one or several waves in the period of the scene.

p = (2 pi E* D/L) cos(pi x/L) sqrt(S^2 - s^2) on |x| < a, with s = sin(pi x/L), S = sin(pi a/L); the
gap outside is 2 D (s sqrt(s^2 - S^2) - S^2 arcosh(s/S)) (Johnson 1985, section 13.2; Goryacheva &
Tsukanov 2020, (18)-(19)).
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from contact.model.scene import Scene


@dataclass(frozen=True)
class StandInReport:
    """A stand-in for a certificate or a plan; it returns the values that it was given."""

    values: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        return dict(self.values)


@dataclass(frozen=True)
class StandIn:
    """Westergaard's solution for waves of `amplitude`, `waves` of them in the scene's period."""

    scene: Scene
    amplitude: float
    half_width: float
    waves: int = 1
    peak: float | None = None
    error: float = 1e-14
    tangential_load: float = 0.0
    tilt: float | None = None
    moment: float | None = None
    rotational_stiffness: float | None = None
    certificate: StandInReport = StandInReport(
        {"smallest_pressure": np.float64(0.0), "largest_gap": np.inf}
    )
    plan: StandInReport = StandInReport({"rows": [{"name": "search", "used": False}]})
    warnings: tuple[str, ...] = ()

    @property
    def cohesive(self) -> np.ndarray:
        return np.zeros((0, 2))

    @property
    def plateaus(self) -> np.ndarray:
        return np.zeros((0, 2))

    @property
    def fields(self) -> SimpleNamespace:
        """A stand-in for the fields: no bound of the pressure is known."""
        return SimpleNamespace(pressure_bound=np.inf)

    @property
    def wave(self) -> float:
        return self.scene.profile.period / self.waves

    @property
    def _sine(self) -> float:
        return float(np.sin(np.pi * self.half_width / self.wave))

    @property
    def zones(self) -> np.ndarray:
        if self.half_width >= self.wave / 2:
            return np.empty((0, 2))
        middles = self.wave * (np.arange(self.waves) - self.waves // 2)
        return middles[:, None] + np.array([-self.half_width, self.half_width])

    @property
    def zone_widths(self) -> np.ndarray:
        return np.diff(self.zones).ravel()

    @property
    def zone_loads(self) -> np.ndarray:
        return np.full(len(self.zones), self.mean_pressure * self.wave)

    @property
    def zone_peaks(self) -> np.ndarray:
        return np.full(len(self.zones), self.max_pressure)

    @property
    def mean_pressure(self) -> float:
        return float(np.pi * self.scene.E_star * self.amplitude / self.wave * self._sine**2)

    @property
    def load(self) -> float:
        return self.mean_pressure * self.wave * self.waves

    @property
    def max_pressure(self) -> float:
        return self.peak if self.peak is not None else 2.0 * self.mean_pressure / self._sine

    @property
    def contact_fraction(self) -> float:
        return min(2.0 * self.half_width / self.wave, 1.0)

    @property
    def stiffness(self) -> float:
        # d approach / d load of one wave is -(2 / pi E*) ln sin(pi a/L). All waves share the
        # load equally.
        if self._sine == 1.0:
            return float(np.inf)
        return float(-self.waves * np.pi * self.scene.E_star / (2.0 * np.log(self._sine)))

    @property
    def mean_gap(self) -> float:
        return self.amplitude - self.approach

    @property
    def approach(self) -> float:
        x = self.wave * (np.arange(4000) + 0.5) / 4000
        return self.amplitude - float(np.mean(self.gap(x)))

    def _s(self, x: Any) -> np.ndarray:
        return np.abs(np.sin(np.pi * np.asarray(x, dtype=float) / self.wave))

    def pressure(self, x: Any) -> np.ndarray:
        s, sine = self._s(x), self._sine
        factor = 2.0 * np.pi * self.scene.E_star * self.amplitude / self.wave
        return factor * np.sqrt(1.0 - s**2) * np.sqrt(np.maximum(sine**2 - s**2, 0.0))

    def gap(self, x: Any) -> np.ndarray:
        sine = self._sine
        s = np.maximum(self._s(x), sine)
        return 2.0 * self.amplitude * (s * np.sqrt(s**2 - sine**2) - sine**2 * np.arccosh(s / sine))

    def displacement(self, x: Any) -> np.ndarray:
        return self.approach - 2.0 * self.amplitude * self._s(x) ** 2 + self.gap(x)
