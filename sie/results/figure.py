"""The figure of a density over its zones; matplotlib is imported only when it is drawn."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from sie.basis import lazy
from sie.slits.system import AnyDensity


@dataclass(frozen=True)
class FigureOptions:
    """Points at which a density is drawn, and the range of its values that is shown."""

    # Number of points of each zone. Twice as many points change no pixel of a figure of `size`.
    points: int = 400
    # Largest number of points of all zones together. With many zones, each zone gets fewer points.
    max_points: int = 100_000
    # Least number of points of a zone. With this number a semicircle still looks round.
    least_points: int = 12
    # Fraction of each half width, about the middle of the zone, in which the values set the range
    # of the ordinate. It leaves out the infinite values at singular ends.
    shown: float = 0.98
    # Width and height of the figure in inches.
    size: tuple[float, float] = (5.2, 3.6)


OPTIONS = FigureOptions()


def draw(density: AnyDensity, ax: Any = None) -> Any:
    """Draw the density on matplotlib's `ax` or on a new figure; return the figure.

    The imaginary part of a complex density has another colour and is dashed.
    """
    try:
        figures = lazy.module("matplotlib.figure")
        agg = lazy.module("matplotlib.backends.backend_agg")
    except ImportError as error:
        raise ImportError("a figure needs matplotlib: pip install matplotlib") from error
    if ax is None:
        figure = figures.Figure(figsize=OPTIONS.size, layout="constrained")
        agg.FigureCanvasAgg(figure)  # no window, backend or setting of pyplot is touched
        ax = figure.subplots()
    elif not isinstance(ax, lazy.module("matplotlib.axes").Axes):
        raise ValueError(f"ax must be None or a matplotlib Axes, got {type(ax).__name__}")
    zones = density.zones
    count = int(np.clip(OPTIONS.max_points // len(zones), OPTIONS.least_points, OPTIONS.points))
    t = -np.cos((np.arange(count) + 0.5) * (np.pi / count))
    values = np.array([density.at_t(i, t) for i in range(len(zones))])
    parts = [values.real, values.imag] if np.iscomplexobj(values) else [values]
    styles = (("C0", "-", "real part"), ("C1", "--", "imaginary part"))
    for part, (colour, dashes, name) in zip(parts, styles, strict=False):
        for middle, half, phi in zip(zones.middle, zones.half, part, strict=True):
            (line,) = ax.plot(middle + half * t, phi, color=colour, linestyle=dashes)
        line.set_label(name)
    if len(parts) > 1:
        ax.legend(frameon=False)
    inner = np.array(parts)[..., np.abs(t) <= OPTIONS.shown]
    low, high = min(0.0, float(inner.min())), max(0.0, float(inner.max()))
    if high > low:
        margin = 0.05 * (high - low)
        ax.set_ylim(low - margin if low < 0.0 else 0.0, high + margin if high > 0.0 else 0.0)
    ax.axhline(0.0, color="0.6", linewidth=0.8)
    ax.set(xlabel="x", ylabel="density")
    return ax.figure
