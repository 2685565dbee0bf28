"""Normal and tangential contact on a periodic grid, step by step: an independent check of slip.

In each step of a history, the normal problem minimizes the energy under p >= 0. The tangential
problem minimizes the energy under |q| <= mu p at a given total q (J. J. Kalker's principle). Both
are solved by active sets.
"""

from __future__ import annotations

import numpy as np


class FrictionGrid:
    """n points in a period 1 of two like half-planes: traction and displacement at the points."""

    def __init__(self, n: int, height, friction: float, E_star: float = 1.0) -> None:
        self.n, self.mu = n, friction
        self.x = (np.arange(n) + 0.5) / n - 0.5
        self.f = height(self.x)
        symbol = np.zeros(n)
        waves = 2 * np.pi * np.abs(np.fft.fftfreq(n, 1 / n))
        symbol[1:] = 2.0 / (E_star * waves[1:])
        column = np.fft.ifft(symbol).real
        self.C = column[(np.arange(n)[:, None] - np.arange(n)) % n]
        self.p, self.q = np.zeros(n), np.zeros(n)
        self.lost = self.shift = 0.0

    def pressure(self, load: float) -> np.ndarray:
        """The p >= 0 of mean `load` with C p + f >= level, and C p + f = level where p > 0."""
        return self._bounded(self.f, load, np.zeros(self.n), np.full(self.n, np.inf))[0]

    def _bounded(self, force, mean, low, high):
        """The x in [low, high] of a mean that minimizes x C x / 2 + force x; and its level."""
        free = high > low
        x = np.where(free, 0.0, low)
        at_low, at_high = np.zeros(self.n, bool), np.zeros(self.n, bool)
        at_low[~free] = True
        for _ in range(300):
            free = ~(at_low | at_high)
            x = np.where(at_low, low, np.where(at_high, high, 0.0))
            k = int(free.sum())
            matrix = np.ones((k + 1, k + 1))
            matrix[:k, :k], matrix[-1, -1] = self.C[np.ix_(free, free)], 0.0
            right = np.append(-(force + self.C @ x)[free], mean * self.n - x.sum())
            found = np.linalg.solve(matrix, right)
            x[free], level = found[:k], -found[k]
            rate = self.C @ x + force - level
            size = np.abs(rate).max() + 1e-300
            low_now = free & (x < low)
            high_now = free & (x > high)
            back = (at_low & (rate < -1e-12 * size) & (high > low)) | (
                at_high & (rate > 1e-12 * size)
            )
            if not (low_now | high_now | back).any():
                return x, level
            at_low = (at_low | low_now) & ~back
            at_high = (at_high | high_now) & ~back
        raise AssertionError("the active sets do not settle")

    def step(self, load: float, shear: float) -> None:
        """Go to the mean pressure `load` and the mean shear `shear`; slip opposes the shear."""
        p = self.pressure(load) if load != self.p.mean() else self.p
        limit = self.mu * p
        change, level = self._bounded(
            np.zeros(self.n), shear - self.q.mean(), -limit - self.q, limit - self.q
        )
        self.p, self.q = p, self.q + change
        self.shift += level
        self.lost += float(self.q @ (level - self.C @ change)) / self.n
