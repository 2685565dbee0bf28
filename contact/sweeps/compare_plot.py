"""One figure of a comparison: exact pressure, errors of each model's pressure, and solve times.

The pressures of good models can hardly be told apart in a figure. So their differences from the
exact pressure are drawn, on a logarithmic axis.
"""

from typing import Any

import numpy as np

from contact.model.units import quantity, scaled
from contact.solution.drawing import (
    BODY,
    FIGURE,
    PRESSURE,
    SURFACE,
    Stretch,
    inner_ticks,
    legend_outside,
    log_ticks,
    new_figure,
    ramp,
    stretches,
)
from contact.solution.sampling import POINTS, peak_position, positions, top_pressure, window
from contact.solution.solution import Solution
from contact.sweeps.compare import (
    NEIGHBOURS,
    Attempt,
    difference,
    ends_apart,
    pressure_apart,
    refusals,
)

Styles = dict[str, dict[str, Any]]


def styles_of(names: list[str]) -> Styles:
    """Colour and dashes of each model's line, by the model's name; the exact model comes last.

    A model with more neighbours has a darker line. The other models differ in dashes, too.
    """
    known: Styles = {
        "isolated": {"color": BODY, "linestyle": ":"},
        "first-order": {"color": "#d98e04", "linestyle": "--"},
        "self-consistent": {"color": PRESSURE, "linestyle": "-."},
        names[-1]: {"color": "black", "linestyle": "-"},
    }
    known |= {
        f"m = {m}": {"color": colour, "linestyle": "-"}
        for m, colour in zip(NEIGHBOURS, ramp(len(NEIGHBOURS)), strict=True)
    }
    other = {"color": "#8a2f7a", "linestyle": (0, (6, 1, 1, 1, 1, 1))}
    return {name: known.get(name, other) for name in names}


def plot_comparison(attempts: list[Attempt]) -> Any:
    """A matplotlib figure: exact pressure, deviations from the exact pressure, errors, times."""
    figure = new_figure(8.4, 9.0)
    layout = [["p", "p"], ["d", "d"], ["e", "t"]]
    top, apart, errors, times = figure.subplot_mosaic(
        layout, width_ratios=[1.5, 1.0], height_ratios=[0.7, 1.2, 1.2]
    ).values()
    styles = styles_of([attempt.name for attempt in attempts])
    solved = {a.name: a.solution for a in attempts if a.solution is not None}
    exact = attempts[-1].solution
    if exact is None:
        # Without an exact solution, the pressures of the models themselves are drawn.
        _draw_pressures(top, solved, styles)
        for axes in (apart, errors):
            axes.set_axis_off()
            text = "no exact solution to compare with"
            axes.text(0.5, 0.5, text, ha="center", transform=axes.transAxes)
    else:
        _draw_pressures(top, {attempts[-1].name: exact}, styles)
        _draw_differences(apart, attempts[:-1], exact, styles)
        _draw_errors(errors, attempts)
    _draw_times(times, attempts, styles)
    for axes in (top, apart, errors, times):
        inner_ticks(axes)
    legend_outside(figure, (top, apart))
    missing = refusals(attempts)
    if missing:
        figure.supxlabel(
            "\n".join(line if len(line) < 120 else f"{line[:117]}..." for line in missing),
            fontsize=7,
        )
    return figure


def _draw_pressures(axes: Any, solved: dict[str, Solution], styles: Styles) -> None:
    if not solved:
        axes.set_axis_off()
        return
    column = _stretch(next(reversed(solved.values())))
    highest = max(map(top_pressure, solved.values()))
    up, unit = scaled(highest, "Pa")
    for name, solution in solved.items():
        x = positions(solution, column.lo, column.hi, POINTS.screen_points)
        p = np.minimum(solution.pressure(x), 2.0 * highest)
        axes.plot(column.along(x), p * up, label=name, linewidth=1.4, **styles[name])
    axes.set(xlim=column.limits, ylim=(0.0, 1.08 * highest * up), ylabel=f"pressure [{unit}]")
    axes.tick_params(labelbottom=False)


def _draw_differences(axes: Any, attempts: list[Attempt], exact: Solution, styles: Styles) -> None:
    """Draw each model's pressure error, relative to the largest exact pressure."""
    column, scale = _stretch(exact), top_pressure(exact)
    lo, hi = column.lo, column.hi
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
            line = {"linewidth": 1.2, **styles[attempt.name]}
            axes.plot(column.along(x), shown, label=attempt.name, **line)
    axes.set(yscale="log", xlim=column.limits, xlabel=column.label)
    axes.set_ylabel("|pressure \N{MINUS SIGN} exact| / largest")
    log_ticks(axes.yaxis)
    axes.grid(axis="y", alpha=0.3)


def _draw_times(axes: Any, attempts: list[Attempt], styles: Styles) -> None:
    factor, unit = scaled(max(attempt.seconds for attempt in attempts), "s")
    bars = axes.barh(
        [a.name for a in attempts],
        [factor * a.seconds for a in attempts],
        color=[styles[a.name]["color"] for a in attempts],
    )
    labels = [quantity(a.seconds, "s", 3) for a in attempts]
    axes.bar_label(bars, labels, fontsize=8, padding=2)
    axes.margins(x=0.35)
    axes.invert_yaxis()
    axes.set_xlabel(f"time [{unit}]")


def _stretch(solution: Solution) -> Stretch:
    """The interval of the figure that shows the pressures and their differences.

    It is `window`, or the surroundings of the pressure peak if no zone would be visible in
    `window`.
    """
    lo, hi = window(solution)
    visible = FIGURE.min_visible * (hi - lo)
    if len(solution.zones) == 0 or np.max(solution.zone_widths) >= visible:
        return stretches((lo, hi))[0]
    x = positions(solution, lo, hi, POINTS.screen_points)
    centre = peak_position(solution, x, solution.pressure(x))
    own = float(solution.zone_widths[np.argmin(np.abs(solution.zones.mean(axis=1) - centre))])
    return stretches((max(lo, centre - own), min(hi, centre + own)))[0]


def _draw_errors(axes: Any, attempts: list[Attempt]) -> None:
    exact, names = attempts[-1], [a.name for a in attempts[:-1]]
    lines = {
        "load": [difference(a, exact, "load") for a in attempts[:-1]],
        "largest pressure": [difference(a, exact, "max_pressure") for a in attempts[:-1]],
        "zone ends": [ends_apart(a, exact) for a in attempts[:-1]],
        "pressure": [pressure_apart(a, exact) for a in attempts[:-1]],
    }
    # Values smaller than the stated errors of the solutions are not drawn.
    least = max(a.solution.error for a in attempts if a.solution is not None)
    colours = ("black", PRESSURE, "#d98e04", SURFACE)
    for (label, values), marker, colour in zip(lines.items(), "osd^", colours, strict=True):
        shown = [np.nan if value is None else abs(value) for value in values]
        shown = [value if value > least else np.nan for value in shown]
        if np.isfinite(shown).any():
            style = {"color": colour, "marker": marker, "linewidth": 1.0, "markersize": 6}
            axes.plot(range(len(names)), shown, label=label, markerfacecolor="none", **style)
    axes.set_yscale("log")
    axes.set_xticks(range(len(names)), names, rotation=35, ha="right", fontsize=8)
    axes.set_ylabel("|error| against exact")
    log_ticks(axes.yaxis)
    axes.grid(axis="y", alpha=0.3)
    if axes.get_legend_handles_labels()[0]:
        above = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "ncols": 2}
        axes.legend(frameon=False, fontsize=8, **above)
