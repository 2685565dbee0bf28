"""The picture of a trace: the points as read, after each step and as they are solved; how often heights occur; the power spectrum."""

from typing import Any

import numpy as np

from contact.model.traces.prepare import Trace
from contact.model.traces.roughness import Roughness
from contact.model.units import prefix, quantity
from contact.solution.panels import new_figure
from sie import Array

_BEFORE, _AFTER, _LOST = "#9a9a9a", "#1f5a92", "#b3261e"
_LONGEST = 90  # letters of a title


def plot_trace(trace: Trace, measured: Roughness, spectrum: tuple[Array, Array], heights: tuple[Array, Array]) -> Any:
    """A matplotlib Figure: a row for each step, and below heights and spectrum of the last."""
    stages = list(trace.stages)
    figure = new_figure(9.0, 1.7 * len(stages) + 3.0)
    grid = figure.add_gridspec(len(stages) + 1, 2, height_ratios=[1.0] * len(stages) + [1.7])
    longest = max(float(np.nanmax(x) - np.nanmin(x)) for _, x, _ in stages)
    along, along_unit = prefix(longest)
    for row, (name, x, height) in enumerate(stages):
        axes = figure.add_subplot(grid[row, :])
        up, up_unit = prefix(float(np.nanmax(height) - np.nanmin(height)))
        axes.plot(along * x, up * height, color=_AFTER if row == len(stages) - 1 else _BEFORE, lw=0.7)
        for at in x[~np.isfinite(height)]:
            axes.axvline(along * at, color=_LOST, lw=0.5, alpha=0.5)
        axes.set_title(name if len(name) <= _LONGEST else name[: _LONGEST - 3] + "...", fontsize=8, loc="left")
        axes.set_ylabel(f"height [{up_unit}m]", fontsize=8)
        axes.tick_params(labelsize=8)
        axes.margins(x=0.0)
    axes.set_xlabel(f"x [{along_unit}m]", fontsize=8)
    _distribution(figure.add_subplot(grid[-1, 0]), measured, *heights)
    _spectrum(figure.add_subplot(grid[-1, 1]), measured, *spectrum)
    return figure


def _distribution(axes: Any, measured: Roughness, edges: Array, density: Array) -> None:
    up, unit = prefix(measured.Rq)
    axes.stairs(density / up, up * edges, fill=True, color=_BEFORE, alpha=0.5)
    z = np.linspace(edges[0], edges[-1], 200)
    gauss = np.exp(-0.5 * (z / measured.Rq) ** 2) / (measured.Rq * np.sqrt(2 * np.pi))
    axes.plot(up * z, gauss / up, color=_AFTER, lw=1.0, label=f"Gauss, Rq = {quantity(measured.Rq, 'm', 3)}")
    axes.set_xlabel(f"height above the mean [{unit}m]", fontsize=8)
    axes.set_ylabel(f"density [1/{unit}m]", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.legend(fontsize=8, frameon=False)


def _spectrum(axes: Any, measured: Roughness, q: Array, density: Array) -> None:
    seen = density > 1e-12 * density.max()
    axes.loglog(q[seen], density[seen], color=_AFTER, lw=0.7)
    axes.set_xlabel(r"wavenumber $q = 2\pi/\lambda$ [1/m]", fontsize=8)
    axes.set_ylabel("power spectrum C [m$^3$]", fontsize=8)
    axes.set_title(f"rms slope {measured.rms_slope:.3g}", fontsize=8, loc="left")
    axes.tick_params(labelsize=8)
