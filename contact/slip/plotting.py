"""Figure of a `Slip`: shear between plus and minus friction times pressure, shaded stick zones.

If there are many zones, or very narrow ones, a second panel shows the zones near the largest
pressure.
"""

from typing import Any

import numpy as np

from contact.model.units import scaled
from contact.slip.report import numbers
from contact.slip.result import Slip
from contact.solution.drawing import (
    BODY,
    CLOSE,
    FIGURE,
    SURFACE,
    Stretch,
    finish,
    legend_outside,
    new_figure,
    stretches,
)
from contact.solution.plotting import close_up, html_table, picture
from contact.solution.report import HEADS
from contact.solution.sampling import POINTS, positions, top_pressure, window
from sie import Array


def plot(slip: Slip) -> Any:
    """A matplotlib Figure of the shear and of the zones that stick."""
    whole = window(slip.solution)
    close = close_up(slip.solution, *whole)
    columns = stretches(whole) if close is None else stretches(whole, close)
    figure = new_figure(7.2 if close is None else 10.2, 3.9)
    ratios = [1.0] if close is None else [1.55, 1.0]
    axes = figure.subplots(1, len(columns), squeeze=False, width_ratios=ratios)[0]
    for panel, column in zip(axes, columns, strict=True):
        _draw(panel, slip, column)
    if close is not None:
        ends = (columns[0].along(end) for end in close)
        axes[0].axvspan(*ends, facecolor=BODY, alpha=0.16, edgecolor="none", zorder=0)
        axes[1].set_title("around the largest pressure", fontsize=9, color=BODY)
    legend_outside(figure, axes)
    figure.supxlabel(slip.summary, fontsize=8)
    return figure


def _draw(axes: Any, slip: Slip, column: Stretch) -> None:
    solution, lo, hi = slip.solution, column.lo, column.hi
    x = positions(solution, lo, hi, POINTS.screen_points)
    ends = np.concatenate((slip.stick_zones.ravel(), slip.slip_zones.ravel()))
    x = np.unique(np.concatenate((x, ends[(ends > lo) & (ends < hi)])))
    along, top = column.along(x), slip.friction * top_pressure(solution)
    up, unit = scaled(top, "Pa")
    limit = np.clip(slip.friction * solution.pressure(x), 0.0, 2.0 * top)
    shear = np.clip(slip.shear(x), -2.0 * top, 2.0 * top)
    line = {"color": BODY, "linewidth": 0.9, "linestyle": (0, (4, 2))}
    for sign, label in ((1.0, "friction times pressure"), (-1.0, None)):
        axes.plot(along, sign * limit * up, label=label, **line)
    axes.fill_between(along, 0.0, shear * up, color=SURFACE, alpha=0.25, linewidth=0)
    axes.plot(along, shear * up, color=SURFACE, linewidth=1.3, label="shear")
    sticks = column.along(_within(slip, lo, hi))
    if len(sticks) <= FIGURE.max_zones:
        for place, (left, right) in enumerate(sticks):
            label = "sticks" if place == 0 else None
            axes.axvspan(left, right, facecolor=CLOSE, alpha=0.14, edgecolor="none", label=label)
    else:
        at = np.repeat(sticks, [1, 2], axis=1)
        at[:, 2] = np.nan
        axes.plot(at.ravel(), np.zeros(at.size), color=CLOSE, linewidth=3.0, label="sticks")
    finish(axes, column.label, f"traction [{unit}]", legend=False)
    high = 1.08 * min(float(limit.max(initial=1e-3 * top)), top) * up
    axes.set(xlim=column.limits, ylim=(-high, high))
    axes.locator_params(axis="x", nbins=6)


def _within(slip: Slip, lo: float, hi: float) -> Array:
    """Intervals that stick and their periodic images, cut to [lo, hi]."""
    table, period = slip.stick_zones, slip.solution.scene.period
    if period is not None and len(table):
        table = np.concatenate((table - period, table, table + period))
    cut = np.clip(table, lo, hi)
    return np.asarray(cut[cut[:, 1] > cut[:, 0]])


def to_html(slip: Slip) -> str:
    """HTML table of numbers with units and errors, and the figure as an image."""
    return html_table(HEADS, numbers(slip)) + picture(slip, plot, "shear and what sticks")
