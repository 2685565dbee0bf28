"""Figures of load paths.

Without adhesion: contact fraction and approach against the load; without a period, the width in
contact replaces the contact fraction. Events are vertical lines and marks on the curve. The curve
of a falling load is dashed and red, since it lies on the curve of the rising load.

With adhesion: load against approach, with dotted jumps, and the surfaces just before pull-off (at
the last value if there is no pull-off). If approaches are undefined, the abscissa is the width in
contact.

Small dots are the computed contacts. The lines between them are straight without adhesion. With
adhesion the computed equilibria may be far apart, and the lines are monotone cubics.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from contact.extras import require
from contact.formulation.tables import runs_of
from contact.model.profiles.noise import EPS
from contact.model.units import scaled
from contact.solution.drawing import (
    BODY,
    CLOSE,
    FIGURE,
    PRESSURE,
    SURFACE,
    finish,
    is_geometric,
    legend_outside,
    panels,
    unit_of,
)
from contact.solution.sampling import on_zones
from contact.solution.solution import Solution
from contact.sweeps.path_table import Passed, columns
from sie import Array, Mask

_FRACTION = "contact fraction"

# Colour and mark of each kind of event; an unknown kind is drawn as a circle.
_MARKS = {
    "birth": (CLOSE, "^"),
    "death": (CLOSE, "v"),
    "merge": (PRESSURE, "D"),
    "split": (PRESSURE, "s"),
    "full": ("black", "*"),
    "onset": (BODY, "^"),
    "join": (BODY, "D"),
}
_DOTS: dict[str, Any] = {"marker": "o", "markersize": 2.5}
_LINES: dict[bool, dict[str, Any]] = {
    True: {"color": SURFACE, "linestyle": "-", "linewidth": 1.5, **_DOTS},
    False: {"color": PRESSURE, "linestyle": (0, (5, 2)), "linewidth": 1.2, **_DOTS},
}


def plot_path(solutions: Sequence[Solution], passed: Passed, ax: Any = None) -> Any:
    """A matplotlib figure of the contact fraction, or of the width in contact, against the load.

    If all approaches are finite, a second panel shows the approach against the load.
    """
    table = {name: np.array(values, dtype=float) for name, values in columns(solutions).items()}
    fraction, width = table["contact_fraction"], table["total_width"]
    curves = [
        (_FRACTION, fraction, "")
        if np.isfinite(fraction).all()
        else ("width in contact", width, "m")
    ]
    if np.isfinite(table["approach"]).all():
        curves.append(("approach", table["approach"], "m"))
    figure, given = panels(ax, len(curves))
    for panel, (label, values, unit) in zip(given, curves, strict=False):
        _draw(panel, table["load"], passed, (label, values, unit))
        name, of = panel.get_xlabel(), panel.get_ylabel()
        finish(panel, name, of, legend=ax is not None)
    if ax is None:
        legend_outside(figure, given)
    return figure


def _draw(axes: Any, loads: Array, passed: Passed, curve: tuple[str, Array, str]) -> None:
    """Draw a curve, given by the label, values and unit of its ordinate."""
    label, values, unit = curve
    log = is_geometric(loads)
    log_up = log and bool(np.all(values > 0))
    along, load_unit = unit_of(loads, "N/m", log)
    up, value_unit = unit_of(values, unit, log_up) if unit else (1.0, "")
    axes.set(xscale="log" if log else "linear", yscale="log" if log_up else "linear")
    x, y = _vertices(loads, values, passed, {"full": 1.0} if label == _FRACTION else {})
    for start, end, rising in _runs(x):
        name = "load rising" if rising else "load falling"
        axes.plot(x[start:end] * along, y[start:end] * up, label=name, **_LINES[rising])
    _draw_events(axes, loads, passed, (x, y), (along, up))
    axes.grid(alpha=0.25)
    axes.set_xlabel(f"load [{load_unit}]")
    axes.set_ylabel(f"{label} [{value_unit}]" if unit else label)


def _draw_events(
    axes: Any,
    loads: Array,
    passed: Passed,
    curve: tuple[Array, Array],
    factors: tuple[float, float],
) -> None:
    """Draw a mark on the curve for each event, and a vertical line at the load of the event.
    If there are many events, the line is only a short tick at the lower edge of the panel.

    Marks under a falling load are larger and hollow, so that marks under the rising load stay
    visible. The more events, the smaller the marks.
    """
    (x, y), (along, up) = curve, factors
    places: dict[tuple[str, bool], list[tuple[float, float]]] = {}
    for k, since in enumerate(passed):
        for event in since:
            low, high = sorted((loads[k - 1], loads[k]))
            step = (x >= low) & (x <= high)
            place = event.load * along, _on_line(axes, event.load, x[step], y[step]) * up
            places.setdefault((event.kind, bool(loads[k] >= loads[k - 1])), []).append(place)
    count = sum(map(len, places.values()))
    height = 0.03 if count > FIGURE.max_zones else 1.0
    for (kind, rising), marked in places.items():
        colour, mark = _MARKS.get(kind, (BODY, "o"))
        part = min(1.0, np.sqrt(FIGURE.max_zones / len(marked)))
        axes.plot(
            *np.transpose(marked),
            linestyle="none",
            marker=mark,
            color=colour,
            markerfacecolor=colour if rising else "none",
            markersize=max(6.0 * part, 3.0) if rising else max(10.0 * part, 5.5),
            markeredgewidth=0.9,
            label=kind if len(marked) == 1 else f"{kind} ({len(marked)})",
        )
        for load, _ in marked:
            axes.axvline(load, ymax=height, color=colour, linewidth=0.6, alpha=0.6, zorder=0)


def _vertices(
    loads: Array, values: Array, passed: Passed, known: dict[str, float]
) -> tuple[Array, Array]:
    """Loads and ordinates of the curve's points.
    These are the solutions, and the events whose kind has a known ordinate.
    """
    points: list[tuple[float, float]] = []
    for load, value, since in zip(loads, values, passed, strict=True):
        points += [(event.load, known[event.kind]) for event in since if event.kind in known]
        points.append((float(load), float(value)))
    x, y = np.array(points).T
    return x, y


def _on_line(axes: Any, load: float, x: Array, y: Array) -> float:
    """The ordinate of a curve at a load, by interpolation.
    It is linear in the scales of the axes, which may be logarithmic.
    """
    order = np.argsort(x, kind="stable")
    to_x: Any = np.log if axes.get_xscale() == "log" else np.asarray
    to_y, back = (np.log, np.exp) if axes.get_yscale() == "log" else (np.asarray, np.asarray)
    return float(back(np.interp(to_x(load), to_x(x[order]), to_y(y[order]))))


def _runs(loads: Array) -> list[tuple[int, int, bool]]:
    """Monotone parts of the loads, each as (start, stop, rising). Successive parts share an end."""
    runs: list[tuple[int, int, bool]] = []
    start = 0
    for k in range(1, len(loads)):
        if k + 1 == len(loads) or (loads[k + 1] > loads[k]) != (loads[k] > loads[k - 1]):
            runs.append((start, k + 1, bool(loads[k] > loads[k - 1])))
            start = k
    return runs or [(0, 1, True)]


_JUMP_MARKS = {
    "jump-in": ">",
    "birth": "^",
    "merge": "D",
    "full": "*",
    "jump": "s",
    "death": "v",
    "pull-off": "X",
}


def draw_curve(
    axes: Any,
    across: Array,
    load: Array,
    rises: Mask,
    jumps: Sequence[tuple[str, float, float, float, float]],
    label: str,
) -> None:
    """Draw the load against the values `across` of the abscissa, and the jumps of the path.

    across [m] and load [N/m]: (n,), nan at jumps; rises: whether the control rises, (n,); jumps:
    (kind, abscissa and load before, abscissa and load after); label: label of the abscissa.
    """
    far = np.nanmax(np.abs([*across, *(a for _, *both in jumps for a in both[::2]), 0.0]))
    high = np.nanmax(np.abs([*load, *(p for _, *both in jumps for p in both[1::2]), 0.0]))
    (x, along), (y, unit) = scaled(float(far), "m"), scaled(float(high), "N/m")
    points = np.column_stack((across * x, load * y))
    for rising, name in ((True, "rising"), (False, "falling")):
        # A point at which the load path reverses belongs to the rising curve and to the falling
        # one.
        mine = (rises == rising) | (np.append(rises[1:], rises[-1:]) == rising)
        for first, last in runs_of(mine & np.isfinite(points).all(axis=1)):
            curve, given = _through(points[first : last + 1])
            axes.plot(*curve.T, label=name, markevery=given, **_LINES[rising])
    for kind, before, load_before, after, load_after in jumps:
        axes.plot(
            [before * x, after * x],
            [load_before * y, load_after * y],
            color="black",
            linewidth=1.0,
            linestyle=":",
        )
        axes.plot(
            before * x,
            load_before * y,
            color="black",
            marker=_JUMP_MARKS.get(kind, "o"),
            markersize=5,
            linestyle="none",
            label=kind,
        )
    axes.axhline(0.0, color=BODY, linewidth=0.6, zorder=0)
    finish(axes, f"{label} [{along}]", f"load [{unit}]")


def _through(points: Array) -> tuple[Array, list[int]]:
    """Points (m, 2) of a smooth curve through given points (n, 2), and their indices among the m.

    Both coordinates are monotone between two given points. According to measurements, this curve is
    ten times closer to the true curve of equilibria than straight lines are.
    """
    spans = np.ptp(points, axis=0)
    steps = np.diff(points, axis=0) / np.where(spans > 0.0, spans, 1.0)
    lengths = np.hypot(*steps.T)
    some = np.append(True, lengths > EPS)
    points, along = points[some], np.append(0.0, np.cumsum(lengths[some[1:]]))
    if len(points) < 3:
        return points, list(range(len(points)))
    fine = np.union1d(np.linspace(0.0, along[-1], 400), along)
    cubic = require("scipy.interpolate").PchipInterpolator(along, points)
    return np.asarray(cubic(fine)), np.searchsorted(fine, along).tolist()


def draw_surfaces(
    axes: Any, title: str, places: Array, surface: Array, body: Array, zones: Array
) -> None:
    """Draw the profile and the deformed surface [m], and mark the zones [m] on the surface."""
    along, unit = scaled(float(np.abs(places).max()), "m")
    heights = np.concatenate((surface, body))
    size = float(np.abs(heights[np.isfinite(heights)]).max(initial=0.0))
    up, unit_up = scaled(size, "m")
    x = places * along
    axes.plot(x, body * up, color=BODY, linewidth=1.2, label="profile")
    axes.plot(x, surface * up, color=SURFACE, linewidth=1.4, label="deformed surface")
    axes.plot(
        x,
        np.where(on_zones(places, zones), surface, np.nan) * up,
        color=PRESSURE,
        linewidth=2.6,
        label="contact",
    )
    # The body may be much higher than the deformed surface. The view is therefore three times as
    # high as the deformed surface, which is in its middle.
    low, high, span = float(surface.min()), float(surface.max()), float(np.ptp(surface))
    if span > 0.0:
        axes.set_ylim((low - span) * up, (high + span) * up)
    axes.set_title(title, fontsize=9)
    finish(axes, f"$x$ [{unit}]", f"height [{unit_up}]")
