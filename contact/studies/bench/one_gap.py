"""Nearly full contact with one gap, under a Fourier series: closed form with two unknowns.

The unknowns are the middle c and the half width w of the gap. With y = tan(pi (x - c)/L) and
tau = tan(pi w/L), the gap is |t| < 1, t = y/tau. The kernel becomes Cauchy's: for y = tan(u) and
eta = tan(v), cot(u - v) dv = [1/(y - eta) + eta/(1 + eta^2)] deta. Let H f' be the conjugate of
the slope, pbar the mean pressure, and G = H f' - 2 pbar/E* = sum G_j T_j(t) on the gap. The slope
of the gap is then

    s = sqrt(1 - t^2) sum_j G_(j+1) U_j(t),

and c and w follow from

    G_0 = B := (1/pi) int s eta deta/(1 + eta^2),    int s deta/(1 + eta^2) = 0.

The pressure is p = pbar - (E*/2)(H f' - B - sum_j G_(j+1) rho^(j+1)), where z = y/tau and
rho = z - sgn(z) sqrt(z^2 - 1) (derived here). G is a small difference of large numbers, so it is
computed in extended precision.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.model.profiles import Fourier
from contact.model.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class OneGap:
    """A contact just below full contact, with one gap in each period.
    The period is 1 and E* = 1.
    """

    profile: Fourier
    mean: float
    middle: float
    half_gap: float
    nodes: int = 48

    @classmethod
    def of(cls, profile: Fourier, full: float, scene: Scene) -> OneGap:
        """The contact of a scene, found by Newton's method.
        The unknowns are the middle of the gap and ln(half width).

        The first guess replaces the conjugate H f' of the slope by a parabola with the same maximum
        and curvature.
        """
        assert scene.mean_pressure is not None
        x = np.linspace(-0.5, 0.5, 4001)
        top = float(x[np.argmax(profile.slope_conjugate(x))])
        k, c, s = _waves(profile)
        for _ in range(8):
            first = k * (s * np.cos(k * top) - c * np.sin(k * top))
            second = -(k**2) * (c * np.cos(k * top) + s * np.sin(k * top))
            top -= float(first.sum() / second.sum())
        curvature = float((k**2 * (c * np.cos(k * top) + s * np.sin(k * top))).sum())
        half = 2 * sqrt(2 * (full - scene.mean_pressure) / curvature)
        found = cls(profile, scene.mean_pressure, top, half)
        for _ in range(12):
            residual = found._residual
            jacobian = np.column_stack(
                [(found._moved(*d)._residual - residual) / 1e-4 for d in ((1e-4, 0.0), (0.0, 1e-4))]
            )
            found = found._moved(*-np.linalg.solve(jacobian, residual))
        return found

    def _moved(self, shift: float, stretch: float) -> OneGap:
        """The contact with its gap moved by `shift` half widths and widened by exp(`stretch`)."""
        middle, half = self.middle + shift * self.half_gap, self.half_gap * np.exp(stretch)
        return OneGap(self.profile, self.mean, float(middle), float(half))

    @property
    def _theta(self) -> Array:
        """Angles theta of the Chebyshev nodes y = tau cos(theta) on the gap (head of module)."""
        return np.asarray(np.pi * (np.arange(self.nodes) + 0.5) / self.nodes)

    @property
    def _tau(self) -> float:
        return float(np.tan(pi * self.half_gap))

    @property
    def _excess(self) -> tuple[Array, float]:
        """Chebyshev coefficients of the right side G on the gap, and the number B (head of module).

        G is H f' - 2 pbar/E*, with the conjugate H f' of the slope and the mean pressure pbar.
        """
        k, c, s = _waves(self.profile)
        y = self._tau * np.cos(self._theta)
        extended_pi = 4 * np.arctan(np.longdouble(1))
        x = np.longdouble(self.middle) + np.arctan(y) / extended_pi
        phase = np.round(k / (2 * pi)) * (2 * extended_pi) * x[:, None]
        series = np.cos(phase) @ c.astype(np.longdouble) + np.sin(phase) @ s.astype(np.longdouble)
        excess = series - 2 * np.longdouble(self.mean)
        # Double precision suffices from here on. Only `excess`, a small difference of large
        # numbers, needed extended precision.
        n = self.nodes
        g = 2 / n * np.cos(np.arange(n)[:, None] * self._theta) @ excess.astype(np.float64)
        g[0] *= 0.5
        return g, float(np.mean(self._slope_sine(g) * y / (1 + y**2)) * self._tau)

    def _slope_sine(self, series: Array) -> Array:
        """Slope of the gap times sin(theta) at the Chebyshev nodes.
        `series` has the Chebyshev coefficients of the right side G.

        The formula uses U_j sin(theta) = sin((j + 1) theta).
        """
        orders = np.arange(1, self.nodes)[:, None]
        return np.asarray(np.sin(self._theta) * (series[1:] @ np.sin(orders * self._theta)))

    @property
    def _residual(self) -> Array:
        """Residuals of the two conditions that determine the gap's middle and half width.
        The residuals are G_0 - B, and the integral of s/(1 + eta^2) over eta (head of this module).
        """
        series, moment = self._excess
        y = self._tau * np.cos(self._theta)
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
        lag = x - self.middle - np.round(x - self.middle)
        with np.errstate(over="ignore"):
            z = np.maximum(np.abs(np.tan(pi * lag)) / self._tau, 1.0)
        rho = np.where(lag < 0, -1, 1) / (z + np.sqrt((z - 1) * (z + 1)))
        inner = moment + np.polyval(np.append(series[:0:-1], 0.0), rho)
        value = self.mean - 0.5 * (self.profile.slope_conjugate(x) - inner)
        return np.asarray(np.where(np.abs(lag) > self.half_gap, value, 0.0))

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        a, b = self.zones[0]
        return self.pressure(0.5 * (a + b) + 0.5 * (b - a) * np.asarray(t, dtype=float))


def _waves(profile: Fourier) -> tuple[Array, Array, Array]:
    """Arrays k, c, s for the Hilbert transform of the slope: the sum of c cos(kx) + s sin(kx)."""
    given = [np.asarray(part, dtype=np.float64) for part in (profile.cosine, profile.sine)]
    cosine, sine = (np.pad(part, (0, max(map(len, given)) - len(part))) for part in given)
    k = 2 * pi * np.arange(1.0, len(cosine) + 1)
    return k, k * cosine, k * sine
