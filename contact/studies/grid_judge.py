"""Contact on an even grid by projected conjugate gradients: an independent check of the solver.

The method (Polonsky & Keer 1999, Wear 231, 206-219) shares no code with the solver and takes any
kernel. On cells of width h, with the pressure p, the displacement S p and the profile f, it solves

    p >= 0,  gap = S p + f - level >= 0,  p gap = 0,  sum p h = load.

In periodic contact the symbol L(q) of the body gives the matrix S: a wave of the pressure with wave
number q and amplitude p_q displaces the surface by u_q = 2 L(q) p_q/(E* q). In isolated contact S
comes from the potential of the body's kernel. On n cells the ends of zones have an error of about
one cell. The relative error of the load and the level is about 1/n.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contact
from contact.studies.scene_families import Bed, Buried, Waves

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Judged:
    """A contact that was found on a grid, as a check of the solver.

    `level` is displacement plus profile in contact [m]; over a period the displacement has zero
    mean. `settled` says whether the iterations converged.
    """

    x: Array
    pressure: Array
    gap: Array
    level: float
    settled: bool

    @property
    def contact(self) -> NDArray[np.bool_]:
        """Mask of the cells in contact."""
        return np.asarray(self.pressure > 0)

    @property
    def fraction(self) -> float:
        """Fraction of the cells that are in contact."""
        return float(np.mean(self.contact))


def _heights(height: Callable[..., Any], x: Array) -> Array:
    out: Array = np.asarray(height(x), dtype=np.float64)
    return out


def judge_period(
    height: Callable[..., Any],
    cell: tuple[float, float],
    E_star: float,
    symbol: Callable[..., Array],
    load: float,
    n: int = 4096,
) -> Judged:
    """Solve the contact of one period on a grid of n cells.
    The substrate is given by its symbol, the Fourier multiplier of its kernel.
    """
    h = (cell[1] - cell[0]) / n
    x = np.asarray(cell[0] + h * (np.arange(n) + 0.5), dtype=np.float64)
    q = 2 * np.pi / (n * h) * np.arange(1, n // 2 + 1)
    compliance = np.append(0.0, 2 * symbol(q) / (E_star * q))

    def displacement(p: Array) -> Array:
        return np.fft.irfft(compliance * np.fft.rfft(p), n)

    return _solve(x, _heights(height, x), displacement, load)


def judge_line(
    height: Callable[..., Any],
    window: tuple[float, float],
    E_star: float,
    rest: Callable[..., Array],
    load: float,
    n: int = 1024,
) -> Judged:
    """Solve the contact of an isolated body on a grid of n cells in the interval `window`.

    The interval must contain the contact. `rest` is the potential of the kernel minus ln|lag|.
    """
    h = (window[1] - window[0]) / n
    x = np.asarray(window[0] + h * (np.arange(n) + 0.5), dtype=np.float64)
    lag = np.arange(-n, n) * h
    edge = np.stack((lag - 0.5 * h, lag + 0.5 * h))
    primitive = edge * (np.log(np.abs(edge)) - 1)
    influence = -2 / (np.pi * E_star) * (primitive[1] - primitive[0] + h * rest(lag))
    spectrum = np.fft.rfft(np.roll(influence, n))

    def displacement(p: Array) -> Array:
        return np.fft.irfft(spectrum * np.fft.rfft(p, 2 * n), 2 * n)[:n]

    return _solve(x, _heights(height, x), displacement, load)


def _solve(
    x: Array,
    f: Array,
    displacement: Callable[[Array], Array],
    load: float,
    max_steps: int = 20_000,
    converged_step: float = 1e-9,
) -> Judged:
    """Polonsky and Keer's method, until the pressure changes by less than `converged_step`."""
    h = float(x[1] - x[0])
    allowed = np.isfinite(f)
    f = np.where(allowed, f, np.max(f[allowed]) + 1e3 * np.ptp(f[allowed]))
    p = allowed * load / (h * np.count_nonzero(allowed))
    direction, norm_before, conjugate, settled = np.zeros(len(x)), 1.0, 0.0, False
    for _ in range(max_steps):
        touching = p > 0
        g = displacement(p) + f
        g -= g[touching].mean()
        norm = float(g[touching] @ g[touching])
        direction = np.where(touching, g + conjugate * norm / norm_before * direction, 0.0)
        r = displacement(direction)
        r -= r[touching].mean()
        curvature = float(r[touching] @ direction[touching])
        if not curvature > 0:
            settled = norm == 0.0
            break
        step = float(g[touching] @ direction[touching]) / curvature
        before, p = p, np.maximum(p - step * direction, 0.0)
        overlap = (p == 0) & (g < 0) & allowed
        p[overlap] -= step * g[overlap]
        conjugate, norm_before = (0.0 if np.any(overlap) else 1.0), norm
        p *= load / (h * p.sum())
        if float(np.abs(p - before).sum()) < converged_step * float(p.sum()):
            settled = True
            break
    gap = displacement(p) + f
    level = float(gap[p > 0].mean())
    return Judged(x, p, gap - level, level, settled)


def judge(
    scene: contact.Scene, load: float, window: tuple[float, float] | None = None, n: int = 4096
) -> Judged:
    """Solve a scene with a model of `scene_families` on a grid, under a load [N/m].

    An isolated body needs a `window` that contains its contact.
    """
    profile, model, period = scene.profile, scene.interaction, scene.period
    if period is None:
        assert isinstance(model, Buried) and window is not None
        return judge_line(profile.height, window, scene.E_star, model.rest, load, n)
    assert isinstance(model, (Waves, Bed))
    cell = profile.x0, profile.x0 + period
    return judge_period(
        profile.height, cell, scene.E_star, lambda q: model.multiplier(q, period), load, n
    )


def fault(scene: contact.Scene, solution: contact.Solution, cells: int = 4) -> str:
    """Return a message if a solution contradicts the grid; empty if they agree.

    They agree if the ends of zones differ by at most `cells` cells on average, and the approaches
    by at most 2 %. The message is also empty if the iterations on the grid did not converge.
    """
    window = None
    if scene.period is None:
        lo, hi = float(solution.zones[0, 0]), float(solution.zones[-1, 1])
        window = lo - 0.6 * (hi - lo), hi + 0.6 * (hi - lo)
        if scene.profile.period is not None:
            window = scene.profile.x0, scene.profile.x0 + scene.profile.period
    found = judge(scene, solution.load, window)
    if not found.settled:
        return ""
    pressed = solution.pressure(found.x) > 0
    ends = max(len(solution.zones), int(np.count_nonzero(np.diff(found.contact))) // 2) + 1
    wrong = int(np.count_nonzero(pressed != found.contact))
    if wrong > 2 * cells * ends:
        return (
            f"{wrong} of {len(found.x)} cells differ from an independent grid, "
            f"contact {np.mean(pressed):.4f} against {found.fraction:.4f}"
        )
    if scene.period is not None and solution.approach is not None:
        # The approach is measured from first touch at the highest summit. This summit may lie
        # between the middles of the grid's cells.
        fine = scene.profile.x0 + scene.period * np.linspace(0.0, 1.0, 2**18, endpoint=False)
        heights = np.asarray(scene.profile.height(fine))
        level = found.level - float(heights.min())
        span = float(np.ptp(heights[np.isfinite(heights)]))
        if abs(level - solution.approach) > 0.02 * max(span, solution.approach):
            return f"approach {solution.approach:.6g}, on an independent grid {level:.6g}"
    return ""


def wrongly_refused(scene: contact.Scene, error: contact.ContactError, cells: int = 4) -> str:
    """Return a message if full contact was reported although a grid finds gaps; else ''."""
    load = scene.given_load
    if load is None or scene.period is None or "gives a kernel and no symbol" not in str(error):
        return ""
    found = judge(scene, load)
    if not found.settled or found.fraction > 1 - 2 * cells / len(found.x):
        return ""
    return f"refused as full contact, of which an independent grid has {found.fraction:.4f}"
