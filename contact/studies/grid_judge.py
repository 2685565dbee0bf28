"""A contact on an even grid by projected conjugate gradients, for any kernel: a second opinion that
shares nothing with the package.

    p >= 0,  gap = S p + f - level >= 0,  p gap = 0,  sum p h = load                (Polonsky & Keer 1999, Wear 231, 206-219)

S comes from a symbol, u_q = 2 L(q) p_q / (E q) over a period, or from what the potential of a lone
body's kernel has beyond the logarithm. Its own error is that of the cells: zones are known to about
a cell, the load and the level to about N^-1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Judged:
    """Places, pressure, gap, level (of a period: u without mean), and whether the iterations came
    to their end.
    """

    x: Array
    pressure: Array
    gap: Array
    level: float
    settled: bool

    @property
    def contact(self) -> NDArray[np.bool_]:
        return np.asarray(self.pressure > 0)

    @property
    def fraction(self) -> float:
        return float(np.mean(self.contact))


def _heights(height: Callable[..., Any], x: Array) -> Array:
    out: Array = np.asarray(height(x), dtype=np.float64)
    return out


def judge_period(
    height: Callable[..., Any],
    cell: tuple[float, float],
    E: float,
    symbol: Callable[..., Array],
    load: float,
    n: int = 4096,
) -> Judged:
    """One period."""
    h = (cell[1] - cell[0]) / n
    x = np.asarray(cell[0] + h * (np.arange(n) + 0.5), dtype=np.float64)
    q = 2 * np.pi / (n * h) * np.arange(1, n // 2 + 1)
    compliance = np.append(0.0, 2 * symbol(q) / (E * q))
    return _solved(
        x, _heights(height, x), lambda p: np.fft.irfft(compliance * np.fft.rfft(p), n), load, h
    )


def judge_line(
    height: Callable[..., Any],
    window: tuple[float, float],
    E: float,
    rest: Callable[..., Array],
    load: float,
    n: int = 1024,
) -> Judged:
    """A lone body in a window that holds its contact; rest: of the potential, beyond ln|lag|."""
    h = (window[1] - window[0]) / n
    x = np.asarray(window[0] + h * (np.arange(n) + 0.5), dtype=np.float64)
    lag = np.arange(-n, n) * h
    edge = np.stack((lag - 0.5 * h, lag + 0.5 * h))
    whole = edge * (np.log(np.abs(edge)) - 1)
    potential = -2 / (np.pi * E) * (whole[1] - whole[0] + h * rest(lag))
    spectrum = np.fft.rfft(np.roll(potential, n))
    return _solved(
        x,
        _heights(height, x),
        lambda p: np.fft.irfft(spectrum * np.fft.rfft(p, 2 * n), 2 * n)[:n],
        load,
        h,
    )


def _solved(
    x: Array,
    f: Array,
    displaced: Callable[[Array], Array],
    load: float,
    h: float,
    most: int = 20_000,
) -> Judged:
    p = np.full(len(x), load / (len(x) * h))
    allowed = np.isfinite(f)
    f = np.where(allowed, f, np.max(f[allowed]) + 1e3 * np.ptp(f[allowed]))
    p = np.where(allowed, p, 0.0) * load / (h * p[allowed].sum())
    t, size_before, keep, settled = np.zeros(len(x)), 1.0, 0.0, False
    for _ in range(most):
        touching = p > 0
        g = displaced(p) + f
        g -= g[touching].mean()
        size = float(g[touching] @ g[touching])
        t = np.where(touching, g + keep * size / size_before * t, 0.0)
        r = displaced(t)
        r -= r[touching].mean()
        curvature = float(r[touching] @ t[touching])
        if not curvature > 0:
            settled = size == 0.0
            break
        step = float(g[touching] @ t[touching]) / curvature
        before, p = p, np.maximum(p - step * t, 0.0)
        overlap = (p == 0) & (g < 0) & allowed
        p[overlap] -= step * g[overlap]
        keep, size_before = (0.0, size) if np.any(overlap) else (1.0, size)
        p *= load / (h * p.sum())
        if float(np.abs(p - before).sum()) < 1e-9 * float(p.sum()):
            settled = True
            break
    u = displaced(p) + f
    level = float(u[p > 0].mean())
    return Judged(x, p, u - level, level, settled)
