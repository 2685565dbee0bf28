"""Figures of matplotlib's own, drawn by Agg without pyplot: no window, no backend and no setting is touched."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.extras import require


def new_figure(width: float, height: float) -> Any:
    """An empty figure of a size [inch]."""
    figure = require("matplotlib.figure").Figure(figsize=(width, height), layout="constrained")
    require("matplotlib.backends.backend_agg").FigureCanvasAgg(figure)
    return figure


def panels(ax: Any, count: int) -> tuple[Any, Sequence[Any]]:
    """A new figure and so many axes beside each other; or those given, one or as many, and their figure."""
    if ax is None:
        figure = new_figure(4.6 * count + 0.6, 3.9)
        return figure, figure.subplots(1, count, squeeze=False)[0]
    given = list(np.ravel(np.asarray(ax, dtype=object)))
    axes = require("matplotlib.axes").Axes
    if not 1 <= len(given) <= count or not all(isinstance(one, axes) for one in given):
        most = "one matplotlib Axes, or two" if count == 2 else "one matplotlib Axes: the scene has no approach"
        raise SceneError.of("ax", ax, f"None, or {most}")
    return given[0].figure, given


def finish(axes: Any, across: str, up: str, legend: bool = True) -> None:
    """Names of the axes, ticks inside, each label once in a legend."""
    axes.set(xlabel=across, ylabel=up)
    axes.tick_params(direction="in", top=True, right=True)
    handles = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    if legend and len(handles) > 1:
        axes.legend(handles.values(), handles.keys(), frameon=False, fontsize=8)
