"""Figure of a solution: surfaces above, pressure below, over the same positions.

The profile is drawn where the approach puts it, touching the deformed surface along the zones.
Heights count from the undeformed surface if the displacement is known absolutely. The body is
above, with its asperities pointing down. The counter-face is below, flat or with heights of its
own, and carries the displacement of both. If there are many zones, or very narrow ones, a second
column shows both panels near the highest pressure.

Figures are drawn by matplotlib's Agg without pyplot, so that no window, backend or setting changes.
In a notebook a solution shows as a table of its numbers, with its figure if matplotlib is
installed.
"""

import base64
import io
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from contact.errors import MissingExtra, SceneError
from contact.extras import require
from contact.model.units import quantity, scaled
from contact.solution.report import HEADS, numbers
from contact.solution.sampling import (
    POINTS,
    on_zones,
    peak_position,
    positions,
    surfaces,
    top_pressure,
    window,
    zones_within,
)
from contact.solution.solution import Solution
from sie import Array

_BODY = "#7a7a7a"
_SURFACE = "#1f5a92"
_PRESSURE = "#b3261e"
_ZONE = "#f2c14e"
_CLOSE = "#3d7a4a"


@dataclass(frozen=True)
class FigureOptions:
    """Options of the figures: the size of details that can be seen in print."""

    # Smallest size of a visible detail, relative to the width or the height of a panel.
    min_visible: float = 0.06

    @property
    def max_zones(self) -> int:
        """Largest number of zones that can be seen if zones and gaps have equal widths."""
        return int(0.5 / self.min_visible)


FIGURE = FigureOptions()


def plot(solution: Solution) -> Any:
    """A matplotlib Figure of profile, deformed surface, zones and pressure."""
    stretches = [window(solution)]
    close = close_up(solution, *stretches[0])
    if close is not None:
        stretches.append(close)
    figure = new_figure(7.2 if close is None else 10.2, 5.4)
    ratios = [1.0] if close is None else [1.55, 1.0]
    axes = figure.subplots(2, len(stretches), sharex="col", squeeze=False, width_ratios=ratios)
    for (top, bottom), (lo, hi) in zip(axes.T, stretches, strict=True):
        _draw(top, bottom, solution, lo, hi)
    if close is not None:
        _mark_close_up(axes, solution, *close)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside upper center", ncols=len(labels), frameon=False, fontsize=9
    )
    figure.supxlabel(summary(solution), fontsize=9)
    return figure


def summary(solution: Solution) -> str:
    """A line of text: model, load or mean pressure, peak pressure, and contact fraction."""
    scene = solution.scene
    parts = [
        f"{scene.profile.title}, {scene.interaction.name}",
        f"$E^*$ = {quantity(scene.E_star, 'Pa')}",
    ]
    if solution.mean_pressure is not None:
        parts.append(rf"$\bar p$ = {quantity(solution.mean_pressure, 'Pa')}")
    else:
        parts.append(f"$P$ = {quantity(solution.load, 'N/m')}")
    if scene.turned and solution.tilt is not None:
        parts.append(rf"tilt {solution.tilt:.3g}")
    peak = (
        quantity(solution.max_pressure, "Pa") if np.isfinite(solution.max_pressure) else r"$\infty$"
    )
    parts.append(rf"$p_\mathrm{{max}}$ = {peak}")
    if solution.contact_fraction is not None:
        parts.append(f"contact {100.0 * solution.contact_fraction:.3g} %")
    if len(solution.zones) > 1:
        parts.append(f"{len(solution.zones)} zones")
    return ",  ".join(parts)


def _draw(top: Any, bottom: Any, solution: Solution, lo: float, hi: float) -> None:
    """Draw the panel of the surfaces and the panel of the pressure from lo to hi."""
    x = positions(solution, lo, hi, POINTS.screen_points)
    zones = zones_within(solution, lo, hi)
    along, unit = scaled(max(abs(lo), abs(hi)), "m")
    bottom.set(xlabel=f"$x$ [{unit}]", xlim=(lo * along, hi * along))
    bottom.locator_params(axis="x", nbins=6)
    _draw_surfaces(top, solution, x, zones, along)
    _draw_pressure(bottom, solution, x, zones, along)
    for axes in (top, bottom):
        axes.tick_params(direction="in", top=True, right=True)
        for left, right in zones * along if len(zones) <= FIGURE.max_zones else ():
            axes.axvspan(left, right, facecolor=_ZONE, alpha=0.18, edgecolor="none", zorder=0)


def _draw_surfaces(axes: Any, solution: Solution, x: Array, zones: Array, along: float) -> None:
    surface, body = surfaces(solution, x)
    seen, below = np.isfinite(body), np.isfinite(surface)
    heights = np.concatenate((surface[below], body[seen]))
    low, high = float(heights.min()), float(heights.max())
    reach = high - low or max(abs(high), 1e-12)
    size = max(reach, abs(low), abs(high)) if reach > 0.05 * abs(high) else reach
    up, unit = scaled(size, "m")
    # A body's height is infinite outside the body's sharp corners. There the outline is drawn
    # outside the panel.
    outline, surface = np.where(seen, body, high + reach), np.where(below, surface, low - reach)
    ceiling = high + (0.22 if seen.all() else 0.6) * reach
    floor = low - (0.24 if below.all() else 0.6) * reach
    axes.fill_between(x * along, outline * up, ceiling * up, color=_BODY, alpha=0.22, linewidth=0)
    axes.fill_between(x * along, floor * up, surface * up, color=_SURFACE, alpha=0.10, linewidth=0)
    axes.plot(x * along, outline * up, color=_BODY, linewidth=1.2, label="profile")
    axes.plot(x * along, surface * up, color=_SURFACE, linewidth=1.4, label="deformed surface")
    # NaN values between the zones let one line object draw all zones.
    touching = np.where(on_zones(x, zones), surface, np.nan)
    weight = 2.6 if len(zones) <= FIGURE.max_zones else 1.8
    axes.plot(x * along, touching * up, color=_PRESSURE, linewidth=weight, label="contact")
    axes.set(ylim=(floor * up, ceiling * up), ylabel=f"height [{unit}]")
    # The label "body" is placed above a point in contact, since the body is always drawn there.
    middle = float(zones[len(zones) // 2].mean()) if len(zones) else float(0.5 * (x[0] + x[-1]))
    where = float(np.clip((middle - x[0]) / (x[-1] - x[0]), 0.06, 0.94))
    for place, height, side, style in (
        (where, 0.96, "body", {"ha": "center", "va": "top", "color": _BODY}),
        (0.015, 0.04, "counter-face", {"va": "bottom", "color": _SURFACE}),
    ):
        axes.text(
            place, height, side, transform=axes.transAxes, fontsize=8, fontweight="bold", **style
        )


def _draw_pressure(axes: Any, solution: Solution, x: Array, zones: Array, along: float) -> None:
    pressure = solution.pressure(x)
    top = top_pressure(solution)
    if np.isfinite(solution.max_pressure):
        top = float(max(pressure.max(), 1e-3 * top)) or 1.0
    scale, unit = scaled(top, "Pa")
    shown = np.clip(pressure, -2.0 * top, 2.0 * top) * scale
    axes.fill_between(
        x * along, 0.0, shown, where=on_zones(x, zones), color=_PRESSURE, alpha=0.22, linewidth=0
    )
    axes.plot(x * along, shown, color=_PRESSURE, linewidth=1.2)
    if solution.mean_pressure is not None and solution.mean_pressure > FIGURE.min_visible * top:
        axes.axhline(
            solution.mean_pressure * scale, color="black", linewidth=0.8, linestyle=(0, (6, 4))
        )
        axes.annotate(
            r"$\bar p$",
            (1.0, solution.mean_pressure * scale),
            xycoords=("axes fraction", "data"),
            xytext=(-4, 3),
            textcoords="offset points",
            ha="right",
            fontsize=9,
        )
    if np.isinf(solution.max_pressure):
        axes.annotate(
            r"$p \to \infty$",
            (0.99, 0.92),
            xycoords="axes fraction",
            ha="right",
            va="top",
            fontsize=9,
        )
    # The tension at the ends of adhesive zones is unbounded. It is drawn at most as far below zero
    # as the peak is above zero.
    lowest = max(float(np.min(pressure, initial=0.0)), -top)
    axes.set(ylim=(1.08 * lowest * scale, 1.08 * top * scale), ylabel=f"pressure [{unit}]")


def close_up(solution: Solution, lo: float, hi: float) -> tuple[float, float] | None:
    """The interval around the highest pressure that a second column of panels enlarges.

    It is up to six times as wide as the zone there. None if the whole figure shows the zones well
    enough.
    """
    zones = zones_within(solution, lo, hi)
    widths = np.diff(zones).ravel()
    if len(solution.zones) == 0 or (
        len(zones) <= FIGURE.max_zones and widths.max() >= FIGURE.min_visible * (hi - lo)
    ):
        return None
    x = positions(solution, lo, hi, POINTS.screen_points)
    centre = peak_position(solution, x, solution.pressure(x))
    own = float(widths[np.argmin(np.abs(zones.mean(axis=1) - centre))])
    reach = min(3.0 * own, 0.5 * (hi - lo))
    middle = float(np.clip(centre, lo + reach, hi - reach))
    return middle - reach, middle + reach


def _mark_close_up(axes: Any, solution: Solution, lo: float, hi: float) -> None:
    """Mark, in the first column of panels, the interval that the second column enlarges.

    The pointer shows the interval even if it is no wider than the line of the peak in it.
    """
    along, _ = scaled(max(abs(end) for end in window(solution)), "m")
    for whole in axes[:, 0]:
        whole.axvspan(
            lo * along, hi * along, facecolor=_CLOSE, alpha=0.22, edgecolor="none", zorder=0
        )
        whole.plot(
            0.5 * (lo + hi) * along,
            1.0,
            marker=11,
            markersize=7,
            color=_CLOSE,
            linestyle="none",
            clip_on=False,
            transform=whole.get_xaxis_transform(),
            label="_close-up",
        )
    axes[0, 1].set_title("around the highest pressure", fontsize=9, color=_CLOSE)


def new_figure(width: float, height: float) -> Any:
    """An empty figure of a given size [inch]."""
    figure = require("matplotlib.figure").Figure(figsize=(width, height), layout="constrained")
    require("matplotlib.backends.backend_agg").FigureCanvasAgg(figure)
    _show_in_notebooks(type(figure))
    return figure


def _show_in_notebooks(figure: type) -> None:
    """Tell IPython, where it runs, to show figures as pictures.

    IPython itself registers figures only once pyplot is imported, which this module leaves out.
    """
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is not None and not any(
        figure in shown for shown in shell.display_formatter.formatters.values()
    ):
        require("IPython.core.pylabtools").select_figure_formats(shell, {"png"})


def panels(ax: Any, count: int) -> tuple[Any, Sequence[Any]]:
    """A new figure with `count` axes side by side, or the given axes and their figure."""
    if ax is None:
        figure = new_figure(4.6 * count + 0.6, 3.9)
        return figure, figure.subplots(1, count, squeeze=False)[0]
    given = list(np.ravel(np.asarray(ax, dtype=object)))
    axes = require("matplotlib.axes").Axes
    if not 1 <= len(given) <= count or not all(isinstance(one, axes) for one in given):
        most = (
            "one matplotlib Axes, or two"
            if count == 2
            else "one matplotlib Axes: the scene has no approach"
        )
        raise SceneError.of("ax", ax, f"None, or {most}")
    return given[0].figure, given


def finish(axes: Any, across: str, up: str, legend: bool = True) -> None:
    """Set the axis labels, inner ticks, and a legend that shows each label once."""
    axes.set(xlabel=across, ylabel=up)
    axes.tick_params(direction="in", top=True, right=True)
    handles = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    if legend and len(handles) > 1:
        axes.legend(handles.values(), handles.keys(), frameon=False, fontsize=8)


def to_html(solution: Solution) -> str:
    """HTML table of numbers with units and errors, and the figure as an image."""
    return html_table(HEADS, numbers(solution)) + picture(solution, plot, "surfaces and pressure")


def html_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table as HTML; the first cell of each row is its name."""
    lines = ["".join(f"<th>{escape(head)}</th>" for head in heads)]
    for name, *cells in rows:
        values = "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        lines.append(f"<th>{escape(name)}</th>{values}")
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def picture(drawn: Any, draw: Callable[[Any], Any], what: str) -> str:
    """HTML image of the figure that `draw` makes of `drawn`; a text if matplotlib is missing."""
    stream = io.BytesIO()
    try:
        draw(drawn).savefig(stream, format="png", dpi=96)
    except MissingExtra as error:
        return f"<p>{escape(str(error))}</p>"
    data = base64.b64encode(stream.getvalue()).decode()
    return f'<img alt="{what}" src="data:image/png;base64,{data}">'
