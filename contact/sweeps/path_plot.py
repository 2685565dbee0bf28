"""One figure of a load path: contact and approach over the load, with the events marked.

Contact is the contact fraction, or the width in contact where there is no period. Events are lines at their own loads, and marks on the
curve as it is drawn; a jump of surfaces that adhere is a part of the curve from where it begins to where it ends. What is drawn of a load
that falls is broken: without adhesion it lies on what is drawn of a rising one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.errors import SceneError
from contact.extras import require
from contact.model.units import prefix
from contact.solution.answer import Answer
from contact.sweeps.path_table import Passed, columns

Array = NDArray[np.float64]

_CURVE, _EVENT = "#1f5a92", "#555555"
# Colours and marks of the kinds of events; others, of someone's own, are drawn as circles.
_MARKS = {
    "birth": ("#3d7a4a", "^"), "death": ("#3d7a4a", "v"), "merge": ("#b3261e", "D"), "split": ("#b3261e", "s"), "full": ("#111111", "*"),
    "jump-in": ("#7a3b8f", "^"), "jump": ("#7a3b8f", "D"), "pull-off": ("#7a3b8f", "v"),
}
# A path most of whose loads are below this part of the highest is drawn over the logarithm of the load.
_MOSTLY_LOW = 0.1
# Lines of more events than this would be all that is seen.
_LINES = 40


def plot_path(solutions: Sequence[Answer], passed: Passed, ax: Any = None) -> Any:
    """A matplotlib Figure: contact over the load, and where there is one the approach over the load."""
    table = {name: np.array(values, dtype=float) for name, values in columns(solutions).items()}
    period = solutions[0].scene.period
    width = _Curve("width in contact", "m", table["total_width"], lambda kind, zones, approach: _width(zones))
    if period is not None:
        fractions = table["contact_fraction"]
        width = _Curve("contact fraction", "", fractions, lambda kind, zones, approach: _fraction(kind, zones, period))
    curves = [width]
    if np.isfinite(table["approach"]).any():
        curves.append(_Curve("approach", "m", table["approach"], lambda kind, zones, approach: approach))
    figure, panels = _panels(ax, len(curves))
    for panel, curve in zip(panels, curves, strict=False):
        _draw(panel, table["load"], passed, curve)
    return figure


@dataclass(frozen=True)
class _Curve:
    """What is drawn over the load; at: its value in a state of some kind of event, zones (n, 2) and approach, or None."""

    label: str
    unit: str
    values: Array
    at: Callable[[str, Array, float | None], float | None]

    def vertices(self, loads: Array, passed: Passed) -> tuple[Array, Array]:
        """Its points, and those of the events that are known."""
        points: list[tuple[float, float | None]] = []
        for load, value, since in zip(loads, self.values, passed, strict=True):
            for event in since:
                # Only after it an event has made of the contact what its kind says.
                for kind, (at, zones, approach) in zip(("", event.kind), event.states, strict=False):
                    points.append((at, self.at(kind, zones, approach)))
                if event.kind == "full" and not event.states and not self.unit:
                    points.append((event.load, 1.0))
            points.append((float(load), float(value)))
        # A break of the line where there is no value, as of the approach of surfaces apart under a load.
        x, y = np.array([(at, value if value is not None and np.isfinite(value) else np.nan) for at, value in points]).T
        return x, y


def _width(zones: Array) -> float:
    return float(np.sum(zones[:, 1] - zones[:, 0]))


def _fraction(kind: str, zones: Array, period: float) -> float:
    return 1.0 if kind == "full" else _width(zones) / period


def _panels(ax: Any, count: int) -> tuple[Any, Sequence[Any]]:
    """The figure and its axes, or those given."""
    if ax is None:
        figure = require("matplotlib.figure").Figure(figsize=(4.6 * count + 0.6, 3.9), layout="constrained")
        require("matplotlib.backends.backend_agg").FigureCanvasAgg(figure)
        return figure, figure.subplots(1, count, squeeze=False)[0]
    given = list(np.ravel(np.asarray(ax, dtype=object)))
    axes = require("matplotlib.axes").Axes
    if not 1 <= len(given) <= count or not all(isinstance(one, axes) for one in given):
        most = "one matplotlib Axes, or two" if count == 2 else "one matplotlib Axes: the scene has no approach"
        raise SceneError.of("ax", ax, f"None, or {most}")
    return given[0].figure, given


def _draw(axes: Any, loads: Array, passed: Passed, curve: _Curve) -> None:
    x, y = curve.vertices(loads, passed)
    along, along_letter = prefix(float(np.abs(x).max()))
    up, letter = prefix(float(np.nanmax(np.abs(y)))) if curve.unit else (1.0, "")
    if np.all(x > 0) and np.median(loads) < _MOSTLY_LOW * loads.max():
        axes.set_xscale("log")
        if np.all(y > 0):
            axes.set_yscale("log")
    for start, end, rising in _runs(x):
        axes.plot(
            x[start:end] * along, y[start:end] * up, color=_CURVE, linewidth=1.4, linestyle="-" if rising else (0, (4, 2)),
            marker="." if end - start <= _LINES else None, markersize=4, label="load rising" if rising else "load falling",
        )
    events = [(event, k) for k, since in enumerate(passed) for event in since]
    for event, k in events:
        colour, mark = _MARKS.get(event.kind, (_EVENT, "o"))
        if len(events) <= _LINES:
            axes.axvline(event.load * along, color=colour, linewidth=0.6, alpha=0.45, zorder=0)
        # Hollow where the load falls: the same states on the way up stay seen.
        face = colour if loads[k] >= loads[k - 1] else "none"
        style = {"linestyle": "none", "marker": mark, "color": colour, "markerfacecolor": face, "markersize": 6 if face == colour else 10}
        step = (x >= min(loads[k - 1], loads[k])) & (x <= max(loads[k - 1], loads[k]))
        height = curve.at("", event.states[0][1], event.states[0][2]) if event.states else _on_line(axes, event.load, x[step], y[step])
        if height is not None:
            axes.plot(event.load * along, height * up, label=event.kind, **style)
    axes.set_xlabel(f"load [{along_letter}N/m]")
    axes.set_ylabel(f"{curve.label} [{letter}{curve.unit}]" if curve.unit else curve.label)
    axes.tick_params(direction="in", top=True, right=True)
    axes.grid(alpha=0.25)
    handles = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    if len(handles) > 1:
        axes.legend(handles.values(), handles.keys(), frameon=False, fontsize=8)


def _on_line(axes: Any, load: float, x: Array, y: Array) -> float:
    """Where the line through points is at a load, as it is drawn."""
    order = np.argsort(x, kind="stable")
    to_x: Any = np.log if axes.get_xscale() == "log" else np.asarray
    to_y, back = (np.log, np.exp) if axes.get_yscale() == "log" else (np.asarray, np.asarray)
    return float(back(np.interp(to_x(load), to_x(x[order]), to_y(y[order]))))


def _runs(loads: Array) -> list[tuple[int, int, bool]]:
    """(first, behind the last, whether the load rises) of each stretch of the path that goes one way; neighbours share their ends."""
    runs: list[tuple[int, int, bool]] = []
    start = 0
    for k in range(1, len(loads)):
        if k + 1 == len(loads) or (loads[k + 1] >= loads[k]) != (loads[k] >= loads[k - 1]):
            runs.append((start, k + 1, bool(loads[k] >= loads[k - 1])))
            start = k
    return runs or [(0, 1, True)]
