"""Figures of the measurements: error against time for each scene, and cost against size."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from contact import lazy
from contact.bench.precision import Row
from contact.bench.report import OURS, names, of
from contact.bench.scaling import Scaled, exponent

_PEERS = {"tamaas": ("tab:orange", "s"), "ContactMechanics": ("tab:green", "^")}


def precision(rows: list[Row], path: Path) -> None:
    """Two lines of panels a scene: errors as stated (true and stated), and errors of p(x), where grids can be compared."""
    scenes = names(rows)
    figure = lazy.matplotlib_figure().Figure(figsize=(2.6 * len(scenes), 6.6), layout="constrained")
    axes = figure.subplots(2, len(scenes), squeeze=False, sharex=True, sharey=True)
    for column, scene in zip(axes.T, scenes, strict=True):
        ours = of(rows, scene, OURS)
        top, bottom = column
        _line(top, ours, "error", "tab:blue", "o-", "contact: true")
        _line(top, ours, "stated", "tab:blue", "o:", "contact: stated", mfc="none")
        hierarchy = [row for row in rows if row.scene == scene and row.method.startswith("localized, m")]
        _line(top, hierarchy, "error", "tab:purple", "D-", "localized, m = 0 ... 16")
        first = of(rows, scene, "localized, first order")
        _line(top, first, "error", "tab:red", "*", "localized, first order")
        _line(bottom, ours, "at_x", "tab:blue", "o-", "contact: true")
        _line(bottom, ours, "mean_at_x", "tab:blue", "o--", "contact: mean", mfc="none")
        for peer, (colour, marker) in _PEERS.items():
            _line(bottom, of(rows, scene, peer), "at_x", colour, marker + "-", peer + ", max")
            _line(bottom, of(rows, scene, peer), "mean_at_x", colour, marker + ":", peer + ", mean", mfc="none")
        top.set_title(scene, fontsize="medium")
        for axis in (top, bottom):
            axis.set(xscale="log", yscale="log", ylim=(1e-16, 2.0))
            axis.grid(True, alpha=0.3)
        bottom.set_xlabel("processor time [s]")
    axes[0, 0].set_ylabel("error of pressures at equal t and of ends")
    axes[1, 0].set_ylabel("error of p at equal x, over the peak")
    # One legend for all: labels in order of first appearance.
    found = {label: handle for a in axes.T.ravel() for handle, label in zip(*a.get_legend_handles_labels(), strict=True)}
    figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=5, fontsize="small")
    figure.savefig(path, dpi=110)


def scaling(rows: list[Scaled], path: Path) -> None:
    """Time, its floor, and memory against the size of each series."""
    series = list(dict.fromkeys(row.series for row in rows))
    figure = lazy.matplotlib_figure().Figure(figsize=(3.6 * len(series), 3.6), layout="constrained")
    for axis, name in zip(figure.subplots(1, len(series), squeeze=False)[0], series, strict=True):
        some = [row for row in rows if row.series == name]
        size = np.array([row.size for row in some], dtype=float)
        time = np.array([row.seconds for row in some])
        axis.loglog(size, time, "o-", label=f"time ~ size^{exponent(size, time):.2f}")
        axis.loglog(size, [row.floor for row in some], "k:", label="floor")
        memory = np.array([row.peak_bytes / 1e9 for row in some])
        axis.loglog(size, memory, "s--", color="tab:red", label=f"peak memory [GB] ~ size^{exponent(size, memory):.2f}")
        axis.set(title=name, xlabel="size", ylabel="processor time [s]")
        axis.set_xticks(size, [f"{n:g}" for n in size])
        axis.set_xticks([], minor=True)
        axis.grid(True, alpha=0.3)
        axis.legend(fontsize="small")
    figure.savefig(path, dpi=110)


def _line(axis: Any, rows: list[Row], what: str, colour: str, style: str, label: str, **more: Any) -> None:
    points = [(row.seconds, getattr(row, what)) for row in rows if getattr(row, what) is not None]
    if points:
        x, y = np.array(points).T
        axis.plot(x, np.maximum(y, 1e-16), style, color=colour, label=label, markersize=4, **more)

