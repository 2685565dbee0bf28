"""One figure of a comparison: exact pressure, difference of each model from it, and solve times.

The pressures of useful models lie on each other, so their differences are drawn, on a logarithmic
axis.
"""

from typing import Any

import numpy as np

from contact.model.units import scaled
from contact.solution.drawing import FIGURE, new_figure
from contact.solution.sampling import POINTS, peak_position, positions, top_pressure, window
from contact.solution.solution import Solution
from contact.sweeps.compare import Attempt, difference, ends_apart, pressure_apart, refusals

_COLOURS = (
    "#9a9a9a",
    "#d98e04",
    "#b3261e",
    "#7a3b8f",
    "#5a56b0",
    "#2f7fb5",
    "#1d9a8a",
    "#3d7a4a",
    "#111111",
)


def plot_comparison(attempts: list[Attempt]) -> Any:
    """A matplotlib figure: exact pressure, deviations from the exact pressure, errors, times."""
    figure = new_figure(8.4, 9.0)
    panels = [["p", "p"], ["d", "d"], ["e", "t"]]
    top, apart, errors, times = figure.subplot_mosaic(
        panels, width_ratios=[1.8, 1.0], height_ratios=[0.7, 1.2, 1.2]
    ).values()
    colours = dict(zip((a.name for a in attempts[:-1]), _COLOURS, strict=False)) | {
        attempts[-1].name: _COLOURS[-1]
    }
    exact = attempts[-1].solution
    if exact is None:
        # Without an exact solution, the pressures of the models themselves are drawn.
        _draw_pressures(
            top, {a.name: a.solution for a in attempts if a.solution is not None}, colours
        )
        for axes in (apart, errors):
            axes.set_axis_off()
            axes.text(
                0.5, 0.5, "no exact solution to differ from", ha="center", transform=axes.transAxes
            )
    else:
        _draw_pressures(top, {attempts[-1].name: exact}, colours)
        _draw_differences(apart, attempts[:-1], exact, colours)
        _draw_errors(errors, attempts)
    _draw_times(times, attempts, colours)
    missing = refusals(attempts)
    if missing:
        figure.supxlabel(
            "\n".join(line if len(line) < 120 else f"{line[:117]}..." for line in missing),
            fontsize=7,
        )
    return figure


def _draw_pressures(axes: Any, solved: dict[str, Solution], colours: dict[str, str]) -> None:
    if not solved:
        axes.set_axis_off()
        return
    lo, hi = _stretch(next(reversed(solved.values())))
    along = _scale_positions(axes, lo, hi)
    highest = max(map(top_pressure, solved.values()))
    up, unit = scaled(highest, "Pa")
    for name, solution in solved.items():
        x = positions(solution, lo, hi, POINTS.screen_points)
        p = np.minimum(solution.pressure(x), 2.0 * highest)
        axes.plot(x * along, p * up, label=name, color=colours[name], linewidth=1.4)
    axes.set_ylim(0.0, 1.08 * highest * up)
    axes.set_ylabel(f"pressure [{unit}]")
    _name_lines(axes)


def _draw_differences(
    axes: Any, attempts: list[Attempt], exact: Solution, colours: dict[str, str]
) -> None:
    """Draw the pressure error relative to the exact peak, at sample points of both solutions."""
    lo, hi = _stretch(exact)
    along, scale = _scale_positions(axes, lo, hi), top_pressure(exact)
    for attempt in attempts:
        if attempt.solution is None:
            continue
        x = np.union1d(
            positions(exact, lo, hi, POINTS.screen_points),
            positions(attempt.solution, lo, hi, POINTS.screen_points),
        )
        with np.errstate(invalid="ignore"):
            apart = np.abs(attempt.solution.pressure(x) - exact.pressure(x)) / scale
        # Differences smaller than the stated errors of the solutions are not drawn.
        least = max(attempt.solution.error, exact.error)
        shown = np.where(np.isfinite(apart) & (apart > least), apart, np.nan)
        if np.isfinite(shown).any():
            axes.plot(
                x * along, shown, label=attempt.name, color=colours[attempt.name], linewidth=1.1
            )
    axes.set_yscale("log")
    axes.set_ylabel("|pressure - exact| / peak")
    axes.grid(axis="y", alpha=0.3)
    _name_lines(axes)


def _draw_times(axes: Any, attempts: list[Attempt], colours: dict[str, str]) -> None:
    bars = axes.barh(
        [a.name for a in attempts],
        [1e3 * a.seconds for a in attempts],
        color=[colours[a.name] for a in attempts],
    )
    axes.bar_label(bars, fmt="%.3g", fontsize=8, padding=2)
    axes.margins(x=0.28)
    axes.invert_yaxis()
    axes.set_xlabel("time [ms]")


def _scale_positions(axes: Any, lo: float, hi: float) -> float:
    along, unit = scaled(max(abs(lo), abs(hi)), "m")
    axes.set_xlim(lo * along, hi * along)
    axes.set_xlabel(f"$x$ [{unit}]")
    return along


def _name_lines(axes: Any) -> None:
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))


def _stretch(solution: Solution) -> tuple[float, float]:
    """The interval to draw.

    It is `window`, or the surroundings of the pressure peak if no zone would be visible in
    `window`.
    """
    lo, hi = window(solution)
    visible = FIGURE.min_visible * (hi - lo)
    if len(solution.zones) == 0 or np.max(solution.zone_widths) >= visible:
        return lo, hi
    x = positions(solution, lo, hi, POINTS.screen_points)
    centre = peak_position(solution, x, solution.pressure(x))
    own = float(solution.zone_widths[np.argmin(np.abs(solution.zones.mean(axis=1) - centre))])
    return max(lo, centre - own), min(hi, centre + own)


def _draw_errors(axes: Any, attempts: list[Attempt]) -> None:
    exact, names = attempts[-1], [a.name for a in attempts[:-1]]
    lines = {
        "load": [difference(a, exact, "load") for a in attempts[:-1]],
        "peak pressure": [difference(a, exact, "max_pressure") for a in attempts[:-1]],
        "zone ends": [ends_apart(a, exact) for a in attempts[:-1]],
        "pressure": [pressure_apart(a, exact) for a in attempts[:-1]],
    }
    for (label, values), marker in zip(lines.items(), "osd^", strict=True):
        # Zeros are left out, because the axis is logarithmic.
        shown = [np.nan if not v else abs(v) for v in values]
        if np.isfinite(shown).any():
            axes.plot(
                range(len(names)), shown, marker=marker, label=label, linewidth=1.0, markersize=5
            )
    axes.set_yscale("log")
    axes.set_xticks(range(len(names)), names, rotation=35, ha="right", fontsize=8)
    axes.set_ylabel("|error| against exact")
    axes.grid(axis="y", alpha=0.3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, fontsize=8)
