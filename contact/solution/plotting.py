"""Figure of a solution: surfaces above, pressure below, over the same positions.

The profile is drawn where the approach puts it, touching the deformed surface along the zones.
Heights count from the undeformed surface if the displacement is known absolutely. The body is
above, with its asperities pointing down. The counter-face is below, flat or with heights of its
own, and is drawn with the displacement of both bodies. If there are many zones, or very narrow
ones, a second column shows both panels near the largest pressure.

In a notebook a solution shows as a table of its numbers, with its figure if matplotlib is
installed.
"""

import base64
import io
from collections.abc import Callable, Iterable, Sequence
from html import escape
from typing import Any, Self

import numpy as np

from contact.errors import MissingExtra
from contact.model.units import quantity, scaled
from contact.solution.drawing import (
    BODY,
    CLOSE,
    FIGURE,
    PRESSURE,
    SURFACE,
    ZONE,
    Stretch,
    inner_ticks,
    legend_outside,
    new_figure,
    shared_unit,
    stretches,
)
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
from sie import Array, record


@record
class Heights:
    """Heights [m] of the deformed surface and of the body at positions x [m]."""

    x: Array
    surface: Array
    body: Array

    @classmethod
    def of(cls, solution: Solution, column: Stretch) -> Self:
        """Heights over an interval."""
        x = positions(solution, column.lo, column.hi, POINTS.screen_points)
        return cls(x, *surfaces(solution, x))

    @property
    def limits(self) -> tuple[float, float]:
        """The lowest and the highest finite height of both surfaces [m]."""
        both = np.concatenate((self.surface, self.body))
        both = both[np.isfinite(both)]
        return float(both.min()), float(both.max())

    @property
    def size(self) -> float:
        """The length [m] by which the unit of the heights is chosen."""
        low, high = self.limits
        reach = high - low or max(abs(high), 1e-12)
        return max(reach, abs(low), abs(high)) if reach > 0.05 * abs(high) else reach


def plot(solution: Solution) -> Any:
    """A matplotlib Figure of profile, deformed surface, zones and pressure."""
    whole = window(solution)
    close = close_up(solution, *whole)
    columns = stretches(whole) if close is None else stretches(whole, close)
    figure = new_figure(7.2 if close is None else 10.2, 5.4)
    ratios = [1.0] if close is None else [1.55, 1.0]
    axes = figure.subplots(2, len(columns), sharex="col", squeeze=False, width_ratios=ratios)
    heights = [Heights.of(solution, column) for column in columns]
    up = shared_unit("m", *(one.size for one in heights))
    for (top, bottom), column, one in zip(axes.T, columns, heights, strict=True):
        marked = close is not None and column is columns[0]
        draw_surfaces(top, solution, column, (one, *up), marked)
        draw_pressure(bottom, solution, column)
        bottom.set(xlabel=column.label, xlim=column.limits)
        bottom.locator_params(axis="x", nbins=6)
        zones = zones_within(solution, column.lo, column.hi)
        for panel in (top, bottom):
            inner_ticks(panel)
            for left, right in column.along(zones) if len(zones) <= FIGURE.max_zones else ():
                panel.axvspan(left, right, facecolor=ZONE, alpha=0.18, edgecolor="none", zorder=0)
    if close is not None:
        mark_close_up(axes[:, 0], *columns)
        axes[0, 1].set_title("around the largest pressure", fontsize=9, color=CLOSE)
    legend_outside(figure, axes[:, 0])
    figure.supxlabel(summary(solution), fontsize=9)
    return figure


def summary(solution: Solution) -> str:
    """A line of text: model, load or mean pressure, largest pressure, and contact fraction."""
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


def draw_surfaces(
    axes: Any, solution: Solution, column: Stretch, drawn: tuple[Heights, float, str], marked: bool
) -> None:
    """Draw both surfaces.

    drawn: heights, with factor and unit of the axis; marked: whether a pointer to a close-up stands
    above the surfaces.
    """
    heights, up, unit = drawn
    seen, below = np.isfinite(heights.body), np.isfinite(heights.surface)
    low, high = heights.limits
    reach = high - low or max(abs(high), 1e-12)
    # The height of a body is infinite outside its sharp corners. There the body's outline is drawn
    # outside the panel.
    outline = up * np.where(seen, heights.body, high + reach)
    surface = up * np.where(below, heights.surface, low - reach)
    ceiling = up * (high + (0.22 if seen.all() else 0.6) * reach)
    floor = up * (low - (0.24 if below.all() else 0.6) * reach)
    x, zones = column.along(heights.x), zones_within(solution, column.lo, column.hi)
    axes.fill_between(x, outline, ceiling, color=BODY, alpha=0.22, linewidth=0)
    axes.fill_between(x, floor, surface, color=SURFACE, alpha=0.10, linewidth=0)
    axes.plot(x, outline, color=BODY, linewidth=1.2, label="profile")
    axes.plot(x, surface, color=SURFACE, linewidth=1.4, label="deformed surface")
    # Between the zones the values are NaN. One line object can then draw all zones.
    touching = np.where(on_zones(heights.x, zones), surface, np.nan)
    weight = 2.6 if len(zones) <= FIGURE.max_zones else 1.8
    axes.plot(x, touching, color=PRESSURE, linewidth=weight, label="contact")
    axes.set(ylim=(floor, ceiling), ylabel=f"height [{unit}]")
    # The label "body" is placed above a point in contact, since the body is always drawn at such a
    # point. It is moved to one side of the pointer to a close-up.
    middle = float(zones[len(zones) // 2].mean()) if len(zones) else 0.5 * (column.lo + column.hi)
    where = float(np.clip((middle - column.lo) / (column.hi - column.lo), 0.06, 0.94))
    side, shift = ("right", -8) if marked and where > 0.5 else ("left", 8)
    above = {"ha": side if marked else "center", "va": "top", "color": BODY}
    for place, height, away, name, style in (
        (where, 0.96, shift if marked else 0, "body", above),
        (0.015, 0.04, 0, "counter-face", {"va": "bottom", "color": SURFACE}),
    ):
        axes.annotate(
            name,
            (place, height),
            (away, 0),
            xycoords="axes fraction",
            textcoords="offset points",
            fontsize=8,
            fontweight="bold",
            **style,
        )


def draw_pressure(axes: Any, solution: Solution, column: Stretch, name: str = "pressure") -> None:
    """Draw the pressure over an interval, with plateaus, tension and, in sliding, the shear.

    name: the name of the vertical axis.
    """
    x = positions(solution, column.lo, column.hi, POINTS.screen_points)
    zones, along = zones_within(solution, column.lo, column.hi), column.along(x)
    pressure, top = solution.pressure(x), max(top_pressure(solution), 0.0)
    # At the end of an adhesive zone the tension may be infinite or much larger than the peak
    # pressure. The tension is drawn at most as far below zero as the peak pressure is above zero.
    # If the peak is small, as before pull-off, the median of |pressure| replaces the peak here.
    lowest = float(np.min(pressure, initial=0.0))
    touching = np.abs(pressure[on_zones(x, zones)])
    depth = max(top, float(np.median(touching))) if touching.size else np.inf
    if lowest < -depth:
        least = r"$p \to -\infty$" if np.isinf(lowest) else f"tension {quantity(-lowest, 'Pa')}"
        _note(axes, least, 0.05)
        lowest = max(float(np.min(pressure[np.isfinite(pressure)], initial=0.0)), -depth)
    if np.isinf(solution.max_pressure):
        _note(axes, r"$p \to \infty$", 0.92)
    elif column.hi - column.lo < np.ptp(window(solution)):
        top = max(float(pressure.max()), 1e-3 * top)
    if lowest == 0.0:
        top = top or 1.0  # without contact there is no pressure
    size = max(top, -lowest)
    scale, unit = scaled(max(top_pressure(solution), -lowest), "Pa")
    shown = np.clip(pressure, lowest - size, top + size) * scale
    fill = {"color": PRESSURE, "linewidth": 0}
    axes.fill_between(along, 0.0, shown, where=on_zones(x, zones), alpha=0.22, **fill)
    axes.plot(along, shown, color=PRESSURE, linewidth=1.2)
    if len(solution.cohesive):
        pulled = (shown < 0.0) & ~on_zones(x, zones)
        style = {"facecolor": "none", "edgecolor": PRESSURE, "linewidth": 0, "hatch": "////"}
        axes.fill_between(along, 0.0, shown, where=pulled, label="cohesive tension", **style)
    if len(solution.plateaus):
        highest = pressure >= solution.scene.law.pressure_range.highest
        axes.fill_between(along, 0.0, shown, where=highest, alpha=0.3, label="plateau", **fill)
    if solution.scene.law.shear_ratio:
        shear = np.clip(solution.shear(x), -2.0 * size, 2.0 * size)
        lowest = min(lowest, float(shear.min()))
        style = {"color": SURFACE, "linewidth": 1.2, "linestyle": (0, (4, 2))}
        axes.plot(along, shear * scale, label="shear", **style)
    mean = solution.mean_pressure
    if mean is not None and mean > FIGURE.min_visible * top:
        axes.axhline(mean * scale, color="black", linewidth=0.8, linestyle=(0, (6, 4)))
        axes.annotate(
            r"$\bar p$",
            (1.0, mean * scale),
            xycoords=("axes fraction", "data"),
            xytext=(-4, 3),
            textcoords="offset points",
            ha="right",
            fontsize=9,
        )
    low, high = 1.08 * lowest * scale, (top + 0.08 * size) * scale
    axes.set(ylim=(low, high), ylabel=f"{name} [{unit}]")


def _note(axes: Any, text: str, height: float) -> None:
    axes.annotate(
        text,
        (0.99, height),
        xycoords="axes fraction",
        ha="right",
        va="top" if height > 0.5 else "bottom",
        fontsize=9,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5, "alpha": 0.8},
    )


def close_up(solution: Solution, lo: float, hi: float) -> tuple[float, float] | None:
    """The interval around the largest pressure that a second column of panels enlarges.

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


def mark_close_up(panels: Iterable[Any], whole: Stretch, close: Stretch) -> None:
    """Mark the interval `close` in the panels that show the longer interval `whole`.

    Other panels show `close` enlarged. A pointer above each panel shows its place even if `close`
    is as narrow as a drawn line.
    """
    lo, hi = whole.along(close.lo), whole.along(close.hi)
    for panel in panels:
        panel.axvspan(lo, hi, facecolor=CLOSE, alpha=0.16, edgecolor="none", zorder=0)
        panel.plot(
            0.5 * (lo + hi),
            1.0,
            marker=11,
            markersize=7,
            color=CLOSE,
            linestyle="none",
            clip_on=False,
            transform=panel.get_xaxis_transform(),
            label="_close-up",
        )


def to_html(solution: Solution) -> str:
    """HTML table of numbers with units and errors, and the figure as an image."""
    return html_table(HEADS, numbers(solution)) + picture(solution, plot, "surfaces and pressure")


def html_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table as HTML; the first cell of each row is the name of the row."""
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
