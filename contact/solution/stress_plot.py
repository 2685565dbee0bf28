"""Figure of the stresses below a contact: pressure above, contours or fringes below.

Depth points downwards, with the scale of x. If the surroundings of the largest stress are small
compared with the whole figure, they are shown in a second column of panels. The depth axis of the
first column is then logarithmic. Fringes are those of photoelasticity in a dark field: bright where
the largest shear stress in the plane is (n + 1/2) times a constant.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.extras import require
from contact.model.units import quantity, scaled
from contact.solution.drawing import (
    CLOSE,
    FIGURE,
    PRESSURE,
    Stretch,
    inner_ticks,
    legend_outside,
    log_ticks,
    new_figure,
    outlined,
    stretches,
)
from contact.solution.plotting import draw_pressure, mark_close_up, summary
from contact.solution.sampling import window, zones_within
from contact.solution.solution import Solution
from contact.solution.stress_report import StressReport, depth_of, grid
from sie import Array, record

# Places (n,) [m], depths (m,) [m] and stresses (m, n) [Pa].
Field = tuple[Array, Array, Array]
SHOWN = ("shear", "mises", "fringes")


@dataclass(frozen=True)
class StressFigureOptions:
    """Options of the figures of stresses."""

    levels: int = 16  # largest number of contours up to the largest stress
    fringes: int = 10  # number of fringe orders up to the largest shear stress
    reach: float = 1.6  # half width of a close-up, divided by the size of the peak
    zones: int = 400  # number of widest zones with extra points; also of evenly spaced points
    singular_part: float = 0.995  # quantile that is the highest contour if the peak is infinite
    round_place: float = 1e-6  # places closer to 0 than this part of the depth are 0


OPTIONS = StressFigureOptions()
_NAMES = {"shear": r"$\tau_\mathrm{max}$", "mises": r"von Mises stress", "fringes": "fringes"}


@record
class Column:
    """A column of panels over an interval, down to the depth `below` [m].

    above: where a logarithmic depth begins [m]; 0 if the depth is not logarithmic.
    """

    along: Stretch
    below: float
    above: float = 0.0

    def field(self, report: StressReport, show: str) -> Field:
        """Places x (n,) [m], depths y (m,) [m] and the shown stress (m, n) [Pa] at these points."""
        lo, hi = self.along.lo, self.along.hi
        if not self.above:
            x, y, stress = grid(report, lo, hi, self.below)
            return x, y, _value(report, stress, show)
        zones = zones_within(report.solution, lo, hi)
        some = zones[np.argsort(zones[:, 0] - zones[:, 1])[: OPTIONS.zones]]
        wide = np.diff(some, axis=1)
        near = some.mean(axis=1)[:, None] + wide * np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
        x = np.union1d(np.linspace(lo, hi, OPTIONS.zones), near.ravel())
        x = x[(x >= lo) & (x <= hi)]
        y = np.geomspace(self.above, self.below, 80)
        return x, y, _value(report, report.stress(x, y[:, None]), show)


def plot_stress(report: StressReport, show: str = "shear") -> Any:
    """A matplotlib Figure of the pressure and of the stresses below the surface.

    show: "shear" for the largest shear stress in the plane, "mises", or "fringes".
    """
    columns = columns_of(report, show)
    lo, hi = columns[0].along.lo, columns[0].along.hi
    ratio = 0.45 if len(columns) > 1 else columns[0].below / (hi - lo)
    wide = 6.4 if len(columns) == 1 else 10.6
    figure = new_figure(wide, 1.9 + 5.2 * ratio)
    axes = figure.subplots(
        2, len(columns), squeeze=False, sharex="col", height_ratios=[1.2, 5.2 * ratio]
    )
    fields = [column.field(report, show) for column in columns]
    top, shading = top_stress(report, show, fields), None
    for pair, column, field in zip(axes.T, columns, fields, strict=True):
        draw_pressure(pair[0], report.solution, column.along, "$p$")
        inner_ticks(pair[0])
        shading = draw_stress(pair[1], report, show, field, (column, top))
    if shading is not None:
        bar = figure.colorbar(shading, ax=list(axes.ravel()), pad=0.01, aspect=30, format="%.3g")
        bar.set_label(label_of(show, top))
    if len(columns) > 1:
        axes[0, 1].set_title("around the largest stress", fontsize=9, color=CLOSE)
        mark_close_up(axes[:1, 0], *(column.along for column in columns))
    legend_outside(figure, axes[0], "lower")
    figure.suptitle(_title(report, show), fontsize=9)
    return figure


def columns_of(report: StressReport, show: str) -> list[Column]:
    """One column of panels for the whole interval, and a second one if the largest stress is local.
    The second column shows the surroundings of the largest stress.
    """
    solution = report.solution
    lo, hi = window(solution)
    below = depth_of(solution, lo, hi)
    peak, zones = _peak(report, show), zones_within(solution, lo, hi)
    if peak is None or len(solution.zones) == 0:
        return [Column(stretches((lo, hi))[0], below)]
    at = _image(peak.x, lo, hi, solution)
    away = np.maximum(np.maximum(zones[:, 0] - at, at - zones[:, 1]), 0.0)
    width = float(np.diff(zones, axis=1)[np.argmin(away), 0])
    # Below a smooth peak of pressure, the largest stress is as deep as a third of the peak's width.
    size = min(width, 3.0 * peak.y) if peak.y > 0 else width
    if size > 2.0 * FIGURE.min_visible * (hi - lo):
        return [Column(stretches((lo, hi))[0], below)]
    reach = OPTIONS.reach * size
    whole, close = stretches((lo, hi), (at - reach, at + reach))
    return [Column(whole, 0.5 * (hi - lo), above=0.1 * size), Column(close, 0.9 * reach)]


def _image(place: float, lo: float, hi: float, solution: Solution) -> float:
    """The place, moved by whole periods, that is nearest to the middle of the interval (lo, hi)."""
    period = solution.scene.period
    if period is None:
        return place
    return float(place - period * np.round((place - 0.5 * (lo + hi)) / period))


def _value(report: StressReport, stress: Any, show: str) -> Array:
    value = stress.mises(report.nu) if show == "mises" else stress.shear
    return np.asarray(np.where(np.isfinite(value), value, np.nan))


def _peak(report: StressReport, show: str) -> Any:
    return report.mises if show == "mises" else report.shear


def top_stress(report: StressReport, show: str, fields: list[Field]) -> float:
    """The stress [Pa] at which the highest contour is drawn.
    `fields` holds the stresses of all columns of panels.
    """
    peak = _peak(report, show)
    if peak is not None and peak.stress > 0:
        return float(peak.stress)
    parts = (float(np.nanquantile(value, OPTIONS.singular_part)) for *_, value in fields)
    return max(parts) or 1.0


def label_of(show: str, top: float) -> str:
    """Label with the name and the unit of the stress that is shown.
    `top` is the stress of the highest contour [Pa]; the unit suits its size.
    """
    return f"{_NAMES[show]} [{scaled(top, 'Pa')[1]}]"


def draw_stress(
    axes: Any, report: StressReport, show: str, field: Field, frame: tuple[Column, float]
) -> Any:
    """Draw the stresses in one column of the figure.

    frame: the column and its highest contour [Pa]. Returns the filled contours, or None for
    fringes.
    """
    (x, y, value), (column, top) = field, frame
    along, scale = column.along, scaled(top, "Pa")[0]
    places, depths, shading = along.along(x), y * along.factor, None
    if show == "fringes":
        fringes = np.sin(np.pi * OPTIONS.fringes * value / top) ** 2
        axes.pcolormesh(places, depths, fringes, cmap="gray", shading="gouraud")
    else:
        levels = levels_to(top * scale)
        capped = np.minimum(value, top) * scale  # at sharp corners stresses are infinite
        shading = axes.contourf(places, depths, capped, levels, cmap="magma_r")
        if not column.above:
            axes.contour(
                places, depths, value * scale, levels[1:-1], colors="black", linewidths=0.3
            )
            if report.strength is not None and show == report.criterion:
                line = {"colors": "white", "linewidths": 1.6, "linestyles": "--"}
                yielded = axes.contour(places, depths, value, [report.strength], **line)
                yielded.set(path_effects=outlined(1.6))
    zones = zones_within(report.solution, float(x[0]), float(x[-1]))
    left, right = along.along(zones.T)
    line = {"lw": 3.0, "clip_on": False, "zorder": 5}
    axes.hlines(np.full(len(zones), depths[0]), left, right, PRESSURE, **line)
    axes.set(
        xlim=(places[0], places[-1]),
        ylim=(depths[-1], depths[0]),
        xlabel=along.label,
        ylabel=f"depth $y$ [{along.unit}]",
    )
    axes.locator_params(axis="x", nbins=6)
    if column.above:
        axes.set_yscale("log")
        log_ticks(axes.yaxis)
    inner_ticks(axes)
    peak = _peak(report, show)
    if peak is not None:
        at = _image(peak.x, float(x[0]), float(x[-1]), report.solution)
        if x[0] <= at <= x[-1] and peak.y <= y[-1]:
            style = {"markersize": 8, "markeredgewidth": 1.8, "clip_on": False, "zorder": 6}
            place = along.along(at), max(peak.y * along.factor, depths[0])
            axes.plot(*place, marker="x", color="white", path_effects=outlined(1.8), **style)
    return shading


def levels_to(top: float) -> Array:
    """Levels of the contours: round values from 0 to the first one that is not below `top`."""
    locator = require("matplotlib.ticker").MaxNLocator(OPTIONS.levels, steps=[1, 2, 2.5, 5, 10])
    levels = np.asarray(locator.tick_values(0.0, top))
    return levels[levels >= 0.0]


def place_of(x: float, y: float) -> float:
    """The place x, or 0 if x is round-off relative to the depth y."""
    return 0.0 if abs(x) < OPTIONS.round_place * y else x


def _title(report: StressReport, show: str) -> str:
    lines = [summary(report.solution)]
    peak, name = _peak(report, show), _NAMES["mises" if show == "mises" else "shear"]
    if peak is None:
        lines.append(f"{name} is infinite at a sharp corner, a sharp tip or an adhesive end")
    else:
        x = quantity(place_of(peak.x, peak.y), "m")
        place = f"$x$ = {x}, depth {quantity(peak.y, 'm')}"
        lines.append(rf"largest {name} {quantity(peak.stress, 'Pa')} (cross) at {place}")
    if show == "fringes":
        lines[-1] += f"; {OPTIONS.fringes} fringes up to this stress"
    if report.yields is not None and report.strength is not None:
        words = "von Mises" if report.criterion == "mises" else "Tresca"
        lines.append(
            f"first yield ({words}, {quantity(report.strength, 'Pa')}) at "
            f"$P$ = {quantity(report.yields.load, 'N/m')}"
        )
    return "\n".join(lines)
