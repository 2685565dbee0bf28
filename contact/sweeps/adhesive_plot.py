"""The figure of a path of surfaces that adhere: load over approach, up and down with its jumps, and the surfaces as they come apart.

The curve goes through what was followed, solved or not; jumps are dotted, from where the contact was to where it came to rest. Without an
approach, contact is drawn in its place. The surfaces are those just before pull-off, or, of a path without it, those of its last value.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contact.model.units import prefix
from contact.solution.plotting import finish, panels
from sie import Array, Mask, record

_UP, _DOWN, _BODY, _CONTACT = "#1f5a92", "#b3261e", "#7a7a7a", "#b3261e"
# Of the heights of the deformed surface, what is shown above its lowest place.
_SHOWN = 3.0
_MARKS = {"jump-in": ">", "birth": "^", "merge": "D", "full": "*", "jump": "s", "death": "v", "pull-off": "X"}


@record
class Drawn:
    """across, load: (n,) of what was followed, nan where a jump breaks it; rises: whether the control did, (n,); jumps: (kind, across and
    load before, after); label, unit: of what is across; places, surface, body: (m,) [m], of what title says; zones: (k, 2)."""

    across: Array
    load: Array
    rises: Mask
    jumps: Sequence[tuple[str, tuple[float, float], tuple[float, float]]]
    label: str
    unit: str
    places: Array
    surface: Array
    body: Array
    zones: Array
    title: str


def draw(what: Drawn, ax: Any = None) -> Any:
    """A matplotlib Figure of its own, or of the one or two axes given."""
    figure, given = panels(ax, 2)
    _curve(given[0], what)
    if len(given) > 1:
        _surfaces(given[1], what)
    return figure


def _curve(axes: Any, what: Drawn) -> None:
    ends = [end for _, *both in what.jumps for end in both]
    x, along = prefix(float(np.nanmax(np.abs(np.concatenate((what.across, [a for a, _ in ends], [0.0])))))) if what.unit else (1.0, "")
    y, letter = prefix(float(np.nanmax(np.abs(np.concatenate((what.load, [p for _, p in ends], [0.0]))))))
    for rising, colour, style, label in ((True, _UP, "-", "rising"), (False, _DOWN, (0, (5, 2)), "falling")):
        # Where the sense changes, both have the point.
        mine = (what.rises == rising) | (np.append(what.rises[1:], what.rises[-1]) == rising)
        axes.plot(
            np.where(mine, what.across, np.nan) * x, np.where(mine, what.load, np.nan) * y, color=colour, linestyle=style, linewidth=1.5,
            label=label,
        )
    for kind, before, after in what.jumps:
        axes.plot([before[0] * x, after[0] * x], [before[1] * y, after[1] * y], color="black", linewidth=1.0, linestyle=":")
        axes.plot(
            before[0] * x, before[1] * y, color="black", marker=_MARKS.get(kind, "o"), markersize=5, linestyle="none", label=kind,
        )
    axes.axhline(0.0, color=_BODY, linewidth=0.6, zorder=0)
    finish(axes, f"{what.label} [{along}{what.unit}]" if what.unit else what.label, f"load [{letter}N/m]")


def _surfaces(axes: Any, what: Drawn) -> None:
    along, letter = prefix(float(np.abs(what.places).max()))
    heights = np.concatenate((what.surface, what.body))
    up, high = prefix(float(np.abs(heights[np.isfinite(heights)]).max(initial=0.0)))
    x = what.places * along
    axes.plot(x, what.body * up, color=_BODY, linewidth=1.2, label="profile")
    axes.plot(x, what.surface * up, color=_UP, linewidth=1.4, label="deformed surface")
    inside = np.any((what.places[:, None] >= what.zones[:, 0]) & (what.places[:, None] <= what.zones[:, 1]), axis=1)
    axes.plot(x, np.where(inside, what.surface, np.nan) * up, color=_CONTACT, linewidth=2.6, label="contact")
    # So that the neck is seen, and not the height of the body beside it.
    low, span = float(what.surface.min()), float(np.ptp(what.surface))
    if span > 0.0:
        axes.set_ylim((low - 0.2 * span) * up, (low + _SHOWN * span) * up)
    axes.set_title(what.title, fontsize=9)
    finish(axes, f"$x$ [{letter}m]", f"height [{high}m]")
