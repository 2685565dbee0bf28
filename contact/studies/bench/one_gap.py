"""Nearly full contact but for one gap under a Fourier series, in closed form but for two unknowns:
its middle c and half width w.

With y = tan(pi (x - c)/L), tau = tan(pi w/L), t = y/tau, the kernel becomes Cauchy's: cot(u - v) dv
= [1/(y - eta) + eta/(1 + eta^2)] deta. Of G = H f' - 2 pbar/E* = sum G_j T_j(t) on the gap, the
slope of the gap is then

    s = sqrt(1 - t^2) sum_j G_(j+1) U_j(t),    G_0 = B := (1/pi) int s eta deta/(1 + eta^2),    int s deta/(1 + eta^2) = 0,

the last two for c and w, and the pressure p = pbar - (E*/2)(H f' - B - sum_j G_(j+1) rho^(j+1)),
rho = z - sgn(z) sqrt(z^2 - 1), z = y/tau (derived here). G is a small difference of large numbers:
it is formed with 64 bits.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.model.profiles import Fourier
from contact.model.scene import Scene

Array = NDArray[np.float64]

_NODES = 48
_THETA = np.pi * (np.arange(_NODES) + 0.5) / _NODES
_PI = np.longdouble(pi) + np.longdouble(1.2246467991473532e-16)  # pi to 64 bits


@dataclass(frozen=True, eq=False)
class OneGap:
    """The contact of period 1 and E* = 1 with one gap, of a mean pressure below that of full
    contact.
    """

    profile: Fourier
    mean: float
    middle: float
    half_gap: float

    @classmethod
    def of(cls, profile: Fourier, full: float, scene: Scene) -> OneGap:
        """From the parabola about the maximum of H f', w = 2 sqrt((full - pbar) 2/E* / k), by
        Newton on (c/w, ln w).
        """
        assert scene.mean_pressure is not None
        x = np.linspace(-0.5, 0.5, 4001)
        top = float(x[np.argmax(profile.slope_conjugate(x))])
        k, c, s = _waves(profile)
        for _ in range(8):
            first = k * (s * np.cos(k * top) - c * np.sin(k * top))
            second = -(k**2) * (c * np.cos(k * top) + s * np.sin(k * top))
            top -= float(first.sum() / second.sum())
        bend = float((k**2 * (c * np.cos(k * top) + s * np.sin(k * top))).sum())
        found = cls(
            profile, scene.mean_pressure, top, 2 * sqrt(2 * (full - scene.mean_pressure) / bend)
        )
        for _ in range(12):
            residual = found._residual
            jacobian = np.column_stack(
                [(found._moved(*d)._residual - residual) / 1e-4 for d in ((1e-4, 0.0), (0.0, 1e-4))]
            )
            found = found._moved(*-np.linalg.solve(jacobian, residual))
        return found

    def _moved(self, shift: float, stretch: float) -> OneGap:
        """c moved by a part of w, ln w by a number."""
        middle, half = self.middle + shift * self.half_gap, self.half_gap * np.exp(stretch)
        return OneGap(self.profile, self.mean, float(middle), float(half))

    @property
    def _tau(self) -> float:
        return float(np.tan(pi * self.half_gap))

    @property
    def _excess(self) -> tuple[Array, float]:
        """Chebyshev coefficients G_j on the gap, and B."""
        k, c, s = _waves(self.profile)
        y = self._tau * np.cos(_THETA)
        x = np.longdouble(self.middle) + np.arctan(y) / _PI
        phase = np.round(k / (2 * pi)) * (2 * _PI) * x[:, None]
        excess = (
            np.cos(phase) @ c.astype(np.longdouble) + np.sin(phase) @ s.astype(np.longdouble)
        ) - 2 * np.longdouble(self.mean)
        # sum over the nodes of a few times what is left: no longer small differences
        series = (
            2 / _NODES * np.cos(np.arange(_NODES)[:, None] * _THETA) @ excess.astype(np.float64)
        )
        series[0] *= 0.5
        return series, float(np.mean(self._slope_sine(series) * y / (1 + y**2)) * self._tau)

    def _slope_sine(self, series: Array) -> Array:
        """s sin(theta) at the nodes: U_j sin(theta) = sin((j + 1) theta)."""
        orders = np.arange(1, _NODES)[:, None]
        return np.asarray(np.sin(_THETA) * (series[1:] @ np.sin(orders * _THETA)))

    @property
    def _residual(self) -> Array:
        """(G_0 - B, int s deta/(1 + eta^2)), which vanish at the right ends."""
        series, moment = self._excess
        y = self._tau * np.cos(_THETA)
        return np.array([series[0] - moment, np.mean(self._slope_sine(series) / (1 + y**2))])

    @property
    def zones(self) -> Array:
        a, b = self.middle + self.half_gap, self.middle - self.half_gap + 1.0
        turn = np.floor(a + 0.5)
        return np.array([[a - turn, b - turn]])

    @property
    def load(self) -> float:
        return self.mean

    @property
    def max_pressure(self) -> float:
        return float(self.pressure(np.linspace(-0.5, 0.5, 2001)).max())

    def pressure(self, x: ArrayLike) -> Array:
        x = np.asarray(x, dtype=float)
        series, moment = self._excess
        off = x - self.middle - np.round(x - self.middle)
        with np.errstate(over="ignore"):
            z = np.maximum(np.abs(np.tan(pi * off)) / self._tau, 1.0)
        rho = np.where(off < 0, -1, 1) / (z + np.sqrt((z - 1) * (z + 1)))
        value = self.mean - 0.5 * (
            self.profile.slope_conjugate(x)
            - moment
            - np.polyval(np.append(series[:0:-1], 0.0), rho)
        )
        return np.asarray(np.where(np.abs(off) > self.half_gap, value, 0.0))

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        a, b = self.zones[0]
        return self.pressure(0.5 * (a + b) + 0.5 * (b - a) * np.asarray(t, dtype=float))


def _waves(profile: Fourier) -> tuple[Array, Array, Array]:
    """H f' = sum c cos kx + s sin kx: wave numbers and coefficients."""
    given = [np.asarray(part, dtype=np.float64) for part in (profile.cosine, profile.sine)]
    cosine, sine = (np.pad(part, (0, max(map(len, given)) - len(part))) for part in given)
    k = 2 * pi * np.arange(1.0, len(cosine) + 1)
    return k, k * cosine, k * sine
