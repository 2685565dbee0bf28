"""Figures of load paths.

Without adhesion: contact and approach over the load. Contact is the contact fraction, or the width
in contact without a period. Events are vertical lines and marks on the curve. A falling load is
drawn dashed, since its curve lies on that of the rising load.

With adhesion: load over approach, with dotted jumps, and the surfaces just before pull-off (at the
last value if there is no pull-off). Without an approach, the abscissa is the contact.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from contact.model.units import scaled
from contact.solution.drawing import finish, panels
from contact.solution.sampling import on_zones
from contact.solution.solution import Solution
from contact.sweeps.path_table import Passed, columns
from sie import Array, Mask

_FRACTION = "contact fraction"

_CURVE = "#1f5a92"
_EVENT = "#555555"
# Colour and mark of each kind of event; an unknown kind is drawn as a circle.
_MARKS = {
    "birth": ("#3d7a4a", "^"),
    "death": ("#3d7a4a", "v"),
    "merge": ("#b3261e", "D"),
    "split": ("#b3261e", "s"),
    "full": ("#111111", "*"),
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
        _draw(panel, table["load"], passed, label, values, unit)
    return figure


def _draw(axes: Any, loads: Array, passed: Passed, label: str, values: Array, unit: str) -> None:
    along, load_unit = scaled(float(np.abs(loads).max()), "N/m")
    up, value_unit = scaled(float(np.abs(values).max()), unit) if unit else (1.0, "")
    if _is_geometric(loads):
        axes.set_xscale("log")
        if np.all(values > 0):
            axes.set_yscale("log")
    x, y = _vertices(loads, values, passed, {"full": 1.0} if label == _FRACTION else {})
    for start, end, rising in _runs(x):
        axes.plot(
            x[start:end] * along,
            y[start:end] * up,
            color=_CURVE,
            linewidth=1.4,
            linestyle="-" if rising else (0, (4, 2)),
            label="load rising" if rising else "load falling",
        )
    events = [(event, k) for k, since in enumerate(passed) for event in since]
    for event, k in events:
        colour, mark = _MARKS.get(event.kind, (_EVENT, "o"))
        axes.axvline(event.load * along, color=colour, linewidth=0.6, alpha=0.45, zorder=0)
        # Marks under a falling load are hollow, so that marks under the rising load stay visible.
        face = colour if loads[k] >= loads[k - 1] else "none"
        style = {
            "linestyle": "none",
            "marker": mark,
            "color": colour,
            "markerfacecolor": face,
            "markersize": 6 if face == colour else 10,
        }
        step = (x >= min(loads[k - 1], loads[k])) & (x <= max(loads[k - 1], loads[k]))
        axes.plot(
            event.load * along,
            _on_line(axes, event.load, x[step], y[step]) * up,
            label=event.kind,
            **style,
        )
    axes.grid(alpha=0.25)
    finish(axes, f"load [{load_unit}]", f"{label} [{value_unit}]" if unit else label)


def _is_geometric(loads: Array) -> bool:
    """Whether positive loads are nearer to a geometric sequence than to an arithmetic one."""
    if not np.all(loads > 0):
        return False
    least, most, middle = loads.min(), loads.max(), np.median(loads)
    return bool(abs(middle - np.sqrt(least * most)) < abs(middle - 0.5 * (least + most)))


def _vertices(
    loads: Array, values: Array, passed: Passed, known: dict[str, float]
) -> tuple[Array, Array]:
    """Loads and ordinates of the curve's points: solutions, and events with a known ordinate."""
    points: list[tuple[float, float]] = []
    for load, value, since in zip(loads, values, passed, strict=True):
        points += [(event.load, known[event.kind]) for event in since if event.kind in known]
        points.append((float(load), float(value)))
    x, y = np.array(points).T
    return x, y


def _on_line(axes: Any, load: float, x: Array, y: Array) -> float:
    """The ordinate at a load, interpolated linearly in the scales of the axes (e.g.
    logarithmic).
    """
    order = np.argsort(x, kind="stable")
    to_x: Any = np.log if axes.get_xscale() == "log" else np.asarray
    to_y, back = (np.log, np.exp) if axes.get_yscale() == "log" else (np.asarray, np.asarray)
    return float(back(np.interp(to_x(load), to_x(x[order]), to_y(y[order]))))


def _runs(loads: Array) -> list[tuple[int, int, bool]]:
    """(start, stop, rising) of each monotone part of the loads; successive parts share an end."""
    runs: list[tuple[int, int, bool]] = []
    start = 0
    for k in range(1, len(loads)):
        if k + 1 == len(loads) or (loads[k + 1] > loads[k]) != (loads[k] > loads[k - 1]):
            runs.append((start, k + 1, bool(loads[k] > loads[k - 1])))
            start = k
    return runs or [(0, 1, True)]


_UP = "#1f5a92"
_DOWN = "#b3261e"
_BODY = "#7a7a7a"
_CONTACT = "#b3261e"
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
    """Draw the load over the abscissa values `across`, and the jumps of the path.

    across [m] and load: (n,), nan at jumps; rises: whether the control rises, (n,); jumps: (kind,
    abscissa and load before, abscissa and load after); label: of the abscissa.
    """
    far = np.nanmax(np.abs([*across, *(a for _, *both in jumps for a in both[::2]), 0.0]))
    high = np.nanmax(np.abs([*load, *(p for _, *both in jumps for p in both[1::2]), 0.0]))
    (x, along), (y, unit) = scaled(float(far), "m"), scaled(float(high), "N/m")
    for rising, colour, style, name in (
        (True, _UP, "-", "rising"),
        (False, _DOWN, (0, (5, 2)), "falling"),
    ):
        # A point at which the direction changes belongs to the rising curve and to the falling
        # curve.
        mine = (rises == rising) | (np.append(rises[1:], rises[-1]) == rising)
        axes.plot(
            np.where(mine, across, np.nan) * x,
            np.where(mine, load, np.nan) * y,
            color=colour,
            linestyle=style,
            linewidth=1.5,
            label=name,
        )
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
    axes.axhline(0.0, color=_BODY, linewidth=0.6, zorder=0)
    finish(axes, f"{label} [{along}]", f"load [{unit}]")


def draw_surfaces(
    axes: Any, title: str, places: Array, surface: Array, body: Array, zones: Array
) -> None:
    """Draw the profile and the deformed surface [m], and mark the zones [m] on the surface."""
    along, unit = scaled(float(np.abs(places).max()), "m")
    heights = np.concatenate((surface, body))
    size = float(np.abs(heights[np.isfinite(heights)]).max(initial=0.0))
    up, unit_up = scaled(size, "m")
    x = places * along
    axes.plot(x, body * up, color=_BODY, linewidth=1.2, label="profile")
    axes.plot(x, surface * up, color=_UP, linewidth=1.4, label="deformed surface")
    axes.plot(
        x,
        np.where(on_zones(places, zones), surface, np.nan) * up,
        color=_CONTACT,
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
