"""One figure of a comparison: the pressures the models give, and how far each is from the exact model and how long it took."""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.extras import require
from contact.model.units import prefix
from contact.solution.answer import Answer
from contact.solution.sampling import peak_position, positions, window
from contact.sweeps.compare import Attempt, difference, ends_apart, pressure_apart, refusals

_COLOURS = ("#9a9a9a", "#d98e04", "#b3261e", "#7a3b8f", "#5a56b0", "#2f7fb5", "#1d9a8a", "#3d7a4a", "#111111")
_POINTS = 4000

# Zones narrower than this part of the stretch cannot be told apart: only the surroundings of the highest are drawn.
_READABLE = 0.04

# What counts as no difference: the solutions' own errors are of this size, and zero has no place on a logarithmic axis.
_FLOOR = 1e-10


def plot_comparison(attempts: list[Attempt]) -> Any:
    """A matplotlib Figure: pressures above, errors against the exact model and times below."""
    figure = require("matplotlib.figure").Figure(figsize=(8.4, 7.0), layout="constrained")
    require("matplotlib.backends.backend_agg").FigureCanvasAgg(figure)
    top, errors, times = figure.subplot_mosaic([["p", "p"], ["e", "t"]], width_ratios=[1.8, 1.0]).values()
    colours = dict(zip((a.name for a in attempts[:-1]), _COLOURS, strict=False)) | {attempts[-1].name: _COLOURS[-1]}
    _draw_pressures(top, attempts, colours)
    _draw_errors(errors, attempts)
    times.barh([a.name for a in attempts], [1e3 * a.seconds for a in attempts], color=[colours.get(a.name) for a in attempts])
    times.set_xscale("log")
    times.invert_yaxis()
    times.set_xlabel("time [ms]")
    missing = refusals(attempts)
    if missing:
        figure.supxlabel("\n".join(line if len(line) < 120 else f"{line[:117]}..." for line in missing), fontsize=7)
    return figure


def _draw_pressures(axes: Any, attempts: list[Attempt], colours: dict[str, str]) -> None:
    solved = [a for a in attempts if a.solution is not None]
    if not solved:
        axes.set_axis_off()
        return
    lo, hi = _stretch(solved[-1].solution)  # the exact one if it is there
    along, letter = prefix(max(abs(lo), abs(hi)))
    highest = max(_top(a.solution) for a in solved)
    up, unit = prefix(highest)
    for attempt in solved:
        assert attempt.solution is not None
        x = positions(attempt.solution, lo, hi, _POINTS)
        p = np.minimum(attempt.solution.pressure(x), 2.0 * highest)
        last = attempt is attempts[-1]
        axes.plot(x * along, p * up, label=attempt.name, color=colours.get(attempt.name), linewidth=1.8 if last else 1.1,
                  linestyle="--" if last else "-", zorder=3 if last else 2)
    axes.set_xlim(lo * along, hi * along)
    axes.set_ylim(0.0, 1.08 * highest * up)
    axes.set_xlabel(f"$x$ [{letter}m]")
    axes.set_ylabel(f"pressure [{unit}Pa]")
    axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))


def _stretch(solution: Answer | None) -> tuple[float, float]:
    """The period, or the surroundings of the highest pressure where its zone would not be seen on it."""
    assert solution is not None
    lo, hi = window(solution)
    if len(solution.zones) == 0 or np.max(solution.zone_widths) >= _READABLE * (hi - lo):
        return lo, hi
    x = positions(solution, lo, hi, _POINTS)
    centre = peak_position(solution, x, solution.pressure(x))
    own = float(solution.zone_widths[np.argmin(np.abs(solution.zones.mean(axis=1) - centre))])
    return max(lo, centre - own), min(hi, centre + own)


def _top(solution: Answer | None) -> float:
    assert solution is not None
    if np.isfinite(solution.max_pressure):
        return solution.max_pressure
    return float(4.0 * solution.load / np.sum(solution.zone_widths))


def _draw_errors(axes: Any, attempts: list[Attempt]) -> None:
    exact, names = attempts[-1], [a.name for a in attempts[:-1]]
    lines = {
        "load": [difference(a, exact, "load") for a in attempts[:-1]],
        "peak pressure": [difference(a, exact, "max_pressure") for a in attempts[:-1]],
        "zone ends": [ends_apart(a, exact) for a in attempts[:-1]],
        "pressure": [pressure_apart(a, exact) for a in attempts[:-1]],
    }
    for (label, values), marker in zip(lines.items(), "osd^", strict=True):
        shown = [np.nan if v is None or abs(v) < _FLOOR else abs(v) for v in values]
        if np.isfinite(shown).any():
            axes.plot(range(len(names)), shown, marker=marker, label=label, linewidth=1.0, markersize=5)
    axes.set_yscale("log")
    axes.set_xticks(range(len(names)), names, rotation=35, ha="right", fontsize=8)
    axes.set_ylabel("|error| against exact")
    axes.grid(axis="y", alpha=0.3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, fontsize=8)
