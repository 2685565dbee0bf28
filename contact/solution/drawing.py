"""Helpers of all figures: colours, units and ticks of axes, legends, new figures.

The colours differ in hue for readers who confuse red and green, and lines that lie close together
also differ in width or in dashes, so that a figure can be read in grey. A figure has one unit for
all its positions, and one for all its heights.

Figures are drawn by matplotlib's Agg without pyplot, so that no window, backend or setting changes.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.extras import require
from contact.model.units import scaled
from sie import Array, record

BODY = "#7a7a7a"
SURFACE = "#1f5a92"
PRESSURE = "#b3261e"
ZONE = "#f2c14e"
CLOSE = "#3d7a4a"


@dataclass(frozen=True)
class FigureOptions:
    """Options of the figures: the size of details that can be seen in print."""

    # Smallest size of a visible detail, relative to the width or the height of a panel.
    min_visible: float = 0.06
    # Largest number of digits for positions along an axis. If more digits would be needed,
    # positions are counted from a place near the drawn interval.
    max_digits: int = 4

    @property
    def max_zones(self) -> int:
        """Largest number of zones that can be seen if zones and gaps have equal widths."""
        return int(0.5 / self.min_visible)


FIGURE = FigureOptions()


@record
class Stretch:
    """An interval [m] on the axis of a figure, with the origin and the unit of its positions."""

    lo: float
    hi: float
    origin: float
    factor: float
    unit: str

    def along(self, x: Any) -> Any:
        """Positions x [m], converted to distances from the origin in the unit of the axis."""
        return (x - self.origin) * self.factor

    @property
    def limits(self) -> tuple[float, float]:
        """Ends of the interval, as distances from the origin in the unit of the axis."""
        return self.along(self.lo), self.along(self.hi)

    @property
    def label(self) -> str:
        """Label of the axis, such as `$x$ [µm]` or `$x$ - 1308.74 µm [µm]`."""
        if self.origin == 0.0:
            return f"$x$ [{self.unit}]"
        # The label gives the origin to a tenth of the width of the interval, or more closely.
        decimals = 1 - math.floor(math.log10(self.factor * (self.hi - self.lo)))
        sign = "\N{MINUS SIGN}" if self.origin > 0 else "+"
        place = f"{abs(self.origin) * self.factor:.{max(decimals, 0)}f}"
        return f"$x$ {sign} {place} {self.unit} [{self.unit}]"


def stretches(*intervals: tuple[float, float]) -> list[Stretch]:
    """The intervals (lo, hi) [m] as `Stretch` objects that have one common unit."""
    found = []
    for lo, hi in intervals:
        middle, half = 0.5 * (lo + hi), 0.5 * (hi - lo)
        far = abs(middle) > 10.0 ** (FIGURE.max_digits - 1) * half
        found.append((lo, hi, middle if far else 0.0))
    sizes = (min(max(abs(lo - at), abs(hi - at)), hi - lo) for lo, hi, at in found)
    factor, unit = shared_unit("m", *sizes)
    return [Stretch(*one, factor, unit) for one in found]


def shared_unit(unit: str, *sizes: float) -> tuple[float, str]:
    """Factor and name of one unit that suits the geometric mean of the smallest and largest size.
    For the unit m the name may be µm.
    """
    known = [size for size in sizes if math.isfinite(size) and size > 0.0]
    return scaled(math.sqrt(min(known) * max(known)) if known else 0.0, unit)


def unit_of(values: Array, unit: str, log: bool = False) -> tuple[float, str]:
    """Factor and name of a unit for the values along an axis, which is linear or logarithmic."""
    sizes = np.abs(values[np.isfinite(values) & (values != 0.0)])
    least = sizes.min(initial=np.inf) if log else np.inf
    return shared_unit(unit, float(least), float(sizes.max(initial=0.0)))


def is_geometric(values: Array) -> bool:
    """Whether positive values are nearer to a geometric sequence than to an arithmetic one."""
    if not np.all(values > 0):
        return False
    least, most, middle = values.min(), values.max(), np.median(values)
    return bool(abs(middle - np.sqrt(least * most)) < abs(middle - 0.5 * (least + most)))


def log_ticks(axis: Any) -> None:
    """Set the ticks of a logarithmic axis: plain numbers, or powers of ten if some would be long.

    The limits of the axis must be set before.
    """
    ticker = require("matplotlib.ticker")
    low, high = sorted(axis.get_view_interval())
    plain = low >= 1e-4 and high < 1e6
    if high < 100.0 * low:
        axis.set_major_locator(ticker.LogLocator(subs=(1.0, 2.0, 5.0)))
    text = "{:g}".format if plain else _power
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: text(value)))
    axis.set_minor_formatter(ticker.NullFormatter())


def _power(value: float) -> str:
    mantissa, exponent = f"{value:e}".split("e")
    times = "" if float(mantissa) == 1.0 else rf"{float(mantissa):g}\times "
    return rf"${times}10^{{{int(exponent)}}}$"


def inner_ticks(axes: Any) -> None:
    """Let ticks point inwards, on all sides."""
    axes.tick_params(direction="in", which="both", top=True, right=True)


def outlined(width: float) -> list[Any]:
    """Path effects that put a black edge around a white line.
    The line is then visible on any shade of grey.
    """
    effects = require("matplotlib.patheffects")
    return [effects.Stroke(linewidth=width + 1.4, foreground="black"), effects.Normal()]


def ramp(count: int) -> list[str]:
    """Colours from light (yellowish) to dark (blue), so that they also differ in a grey print."""
    shades = np.linspace(0.85, 0.15, count) if count > 1 else np.array([0.5])
    # The lightness of the colours falls evenly. So a colour-blind reader and a grey print show the
    # same order.
    colours = require("matplotlib").colormaps["cividis"](shades)
    return [require("matplotlib.colors").to_hex(colour) for colour in colours]


def new_figure(width: float, height: float) -> Any:
    """An empty figure of a given size [inch]."""
    figure = require("matplotlib.figure").Figure(figsize=(width, height), layout="constrained")
    require("matplotlib.backends.backend_agg").FigureCanvasAgg(figure)
    _show_in_notebooks(type(figure))
    return figure


def _show_in_notebooks(figure: type) -> None:
    """Make IPython, if it runs, show figures as pictures.

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
    """Set the axis labels, the ticks, and a legend that shows each label once."""
    axes.set(xlabel=across, ylabel=up)
    inner_ticks(axes)
    for axis in (axes.xaxis, axes.yaxis):
        if axis.get_scale() == "log":
            log_ticks(axis)
    handles = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    if legend and len(handles) > 1:
        axes.legend(handles.values(), handles.keys(), frameon=False, fontsize=8)


def legend_outside(figure: Any, axes: Sequence[Any], side: str = "upper", columns: int = 5) -> None:
    """Draw a legend outside all panels, where it covers no data; it shows each label once.

    side: "upper" or "lower". columns: their largest number; there are fewer if the legend would be
    wider than the figure.
    """
    handles: dict[str, Any] = {}
    for one in axes:
        handles |= dict(zip(*reversed(one.get_legend_handles_labels()), strict=True))
    for count in range(min(columns, len(handles)), 0, -1):
        legend = figure.legend(
            handles.values(),
            handles.keys(),
            loc=f"outside {side} center",
            ncols=count,
            frameon=False,
            fontsize=9,
        )
        if count == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()
