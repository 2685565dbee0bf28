"""Figures of the measurements: error against time per scene, and cost against size."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from contact.extras import require
from contact.studies.bench.precision import Row
from contact.studies.bench.report import OURS, names, of
from contact.studies.bench.scaling import Scaled, exponent, fitted

_PEERS = {"tamaas": ("tab:orange", "s"), "ContactMechanics": ("tab:green", "^")}


def precision(rows: list[Row], path: Path) -> None:
    """Draw errors against time, one panel for each scene.

    The errors are the solver's true and stated error, and the true errors of localized models.
    """
    figure, panels = _panels(rows, "error of pressures at equal t and of ends")
    for scene, axis in panels.items():
        ours = of(rows, scene, OURS)
        _line(axis, ours, "error", "tab:blue", "o-", "contact: true")
        _line(axis, ours, "stated", "tab:blue", "o:", "contact: stated", mfc="none")
        hierarchy = [
            row for row in rows if row.scene == scene and row.method.startswith("localized, m")
        ]
        _line(
            axis,
            hierarchy,
            "error",
            "tab:purple",
            "D-",
            "localized, m = 0 ... 16 neighbours a side",
        )
        _line(
            axis,
            of(rows, scene, "localized, first order"),
            "error",
            "tab:red",
            "*",
            "localized, first order",
        )
    _finish(figure, panels, path)


def peers(rows: list[Row], path: Path) -> None:
    """Draw errors of the pressure p(x) against time for this solver and other codes.
    There is one panel for each scene.
    """
    figure, panels = _panels(rows, "error of p at equal x, over the peak")
    for scene, axis in panels.items():
        for method, (colour, marker) in {OURS: ("tab:blue", "o"), **_PEERS}.items():
            _line(axis, of(rows, scene, method), "at_x", colour, marker + "-", method + ", largest")
            _line(
                axis,
                of(rows, scene, method),
                "mean_at_x",
                colour,
                marker + ":",
                method + ", mean",
                mfc="none",
            )
    _finish(figure, panels, path)


def _panels(rows: list[Row], label: str) -> tuple[Any, dict[str, Any]]:
    scenes = names(rows)
    across = min(3, len(scenes))
    down = -(-len(scenes) // across)
    figure = require("matplotlib.figure").Figure(
        figsize=(3.1 * across, 2.6 * down + 0.7), layout="constrained"
    )
    grid = figure.subplots(down, across, squeeze=False, sharex=True, sharey=True)
    for axis in grid.ravel()[len(scenes) :]:
        axis.set_visible(False)
    for axis in grid[:, 0]:
        axis.set_ylabel(label, fontsize="small")
    panels = dict(zip(scenes, grid.ravel(), strict=False))
    for scene, axis in panels.items():
        axis.set(xscale="log", yscale="log", ylim=(1e-16, 2.0))
        axis.set_title(scene, fontsize="medium")
        axis.grid(True, alpha=0.3)
        axis.set_xlabel("processor time [s]", fontsize="small")
        axis.tick_params(labelbottom=True)
    return figure, panels


def _finish(figure: Any, panels: dict[str, Any], path: Path) -> None:
    # The figure has one legend for all panels.
    found = {
        label: handle
        for axis in panels.values()
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)
    }
    figure.legend(
        found.values(), found.keys(), loc="outside lower center", ncols=3, fontsize="small"
    )
    figure.savefig(path, dpi=90)


def scaling(rows: list[Scaled], path: Path) -> None:
    """Draw time, its lower estimate (floor) and memory against size: one panel for each series."""
    series = list(dict.fromkeys(row.series for row in rows))
    across = min(2, len(series))
    down = -(-len(series) // across)
    figure = require("matplotlib.figure").Figure(
        figsize=(4.4 * across, 3.4 * down), layout="constrained"
    )
    panels = dict(zip(series, figure.subplots(down, across, squeeze=False).ravel(), strict=False))
    for name, axis in panels.items():
        some = [row for row in rows if row.series == name]
        power = np.array([float(row.size) for row in fitted(some)])
        grows = [
            f"{what} ~ size^{exponent(power, np.array(values)):.2f}"
            for what, values in (
                ("time", [row.seconds for row in fitted(some)]),
                ("memory", [float(row.peak_bytes) for row in fitted(some)]),
            )
        ]
        size = np.array([row.size for row in some])
        axis.loglog(size, [row.seconds for row in some], "o-", label="time [s]")
        axis.loglog(
            size, [row.floor for row in some], "k:", label="lower estimate, by direct sums [s]"
        )
        memory = [row.peak_bytes / 1e9 for row in some]
        axis.loglog(size, memory, "s--", color="tab:red", mfc="none", label="peak memory [GB]")
        axis.set(xlabel="size", ylabel="processor time [s], memory [GB]")
        axis.set_title(f"{name}\n{', '.join(grows)}", fontsize="medium")
        axis.set_xticks(size, [f"{n:g}" for n in size], fontsize="x-small")
        axis.set_xticks([], minor=True)
        axis.grid(True, alpha=0.3)
    _finish(figure, panels, path)


def _line(
    axis: Any, rows: list[Row], what: str, colour: str, style: str, label: str, **more: Any
) -> None:
    points = [(row.seconds, getattr(row, what)) for row in rows if getattr(row, what) is not None]
    if points:
        x, y = np.array(points).T
        axis.plot(x, np.maximum(y, 1e-16), style, color=colour, label=label, markersize=4, **more)
