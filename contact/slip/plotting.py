"""Figure of a slip: shear between plus and minus friction times pressure; what sticks is shaded."""

from typing import Any

import numpy as np

from contact.model.units import scaled
from contact.slip.report import numbers
from contact.slip.result import Slip
from contact.solution.drawing import FIGURE, finish, new_figure
from contact.solution.plotting import html_table, picture
from contact.solution.report import HEADS
from contact.solution.sampling import POINTS, positions, top_pressure, window
from sie import Array

_LIMIT = "#7a7a7a"
_SHEAR = "#1f5a92"
_STICK = "#3d7a4a"


def plot(slip: Slip) -> Any:
    """A matplotlib Figure of the shear and of the zones that stick."""
    solution = slip.solution
    lo, hi = window(solution)
    x = positions(solution, lo, hi, POINTS.screen_points)
    ends = np.concatenate((slip.stick_zones.ravel(), slip.slip_zones.ravel()))
    x = np.unique(np.concatenate((x, ends[(ends > lo) & (ends < hi)])))
    along, unit = scaled(max(abs(lo), abs(hi)), "m")
    top = slip.friction * top_pressure(solution)
    up, unit_up = scaled(top, "Pa")
    figure = new_figure(7.2, 3.9)
    axes = figure.subplots()
    limit = np.clip(slip.friction * solution.pressure(x), 0.0, 2.0 * top) * up
    shear = np.clip(slip.shear(x), -2.0 * top, 2.0 * top) * up
    for sign, label in ((1.0, "friction times pressure"), (-1.0, None)):
        axes.plot(x * along, sign * limit, color=_LIMIT, linewidth=0.9, label=label)
    axes.fill_between(x * along, 0.0, shear, color=_SHEAR, alpha=0.25, linewidth=0)
    axes.plot(x * along, shear, color=_SHEAR, linewidth=1.3, label="shear")
    sticks = _within(slip, lo, hi)
    if len(sticks) <= FIGURE.max_zones:
        for place, (left, right) in enumerate(sticks * along):
            label = "sticks" if place == 0 else None
            axes.axvspan(left, right, facecolor=_STICK, alpha=0.14, edgecolor="none", label=label)
    else:
        at = np.repeat(sticks * along, [1, 2], axis=1)
        at[:, 2] = np.nan
        line = {"color": _STICK, "linewidth": 3.0, "label": "sticks"}
        axes.plot(at.ravel(), np.zeros(at.size), **line)
    finish(axes, f"$x$ [{unit}]", f"traction [{unit_up}]")
    axes.set_xlim(lo * along, hi * along)
    figure.supxlabel(slip.summary, fontsize=8)
    return figure


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
