"""Figures 11 and 12: parabolic asperities."""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.model.profiles import Parabola
from contact.paper import LocalizedParabola
from contact.paper.figures.base import (
    ALONE,
    EXACT,
    FIRST,
    MODELS,
    ONE,
    SELF,
    STYLE,
    Array,
    Figure,
    alone_or_period,
    curve,
    label_panel,
    on_cell,
    pressures,
    solved,
    worst,
)
from contact.reference.exact import PeriodicParabola

# E* = 1, L = 1, R = L.
_PARABOLA = Parabola(radius=1.0, period=1.0)
PRESSURES = (0.05, 0.15)
_MODELS = (EXACT, FIRST, SELF, ALONE)


def figure_11() -> Figure:
    """Pressure under the parabola at two mean pressures, with the exact one that the paper lacks."""
    every = {(p, m): alone_or_period(_PARABOLA, m, p) for p in PRESSURES for m in _MODELS}
    x = on_cell(list(every.values()), 0.5)
    columns: dict[str, Array] = {"x/L": x}
    said, apart = [], []
    for (mean, model), solution in every.items():
        columns[f"p/E* {model} mean={mean}"] = pressures(solution, x)
    for mean in PRESSURES:
        closed = PeriodicParabola.from_mean_pressure(mean, period=1.0, radius=1.0, E_star=1.0)
        first = LocalizedParabola.from_mean_pressure(mean, period=1.0, radius=1.0, E_star=1.0)
        t = np.linspace(-1.0, 1.0, 201)
        for model, form in ((EXACT, closed), (FIRST, first)):
            solution = every[mean, model]
            assert solution is not None
            apart.append(worst(solution.pressure_at(t), form.pressure_at(t)))
        for model in _MODELS:
            s = every[mean, model]
            if s is not None:
                said.append(f"mean {mean}, {model}: a/L = {0.5 * s.zone_widths[0]:.5f}, peak {s.max_pressure:.5f} E*")

    def draw(figure: Any) -> None:
        for axes, mean in zip(figure.subplots(1, 2), PRESSURES, strict=True):
            for model in _MODELS:
                curve(axes, x, columns[f"p/E* {model} mean={mean}"], model, "Hertz" if model == ALONE else model)
            axes.set_xlim(-0.5, 0.5)
            axes.set_ylim(0.0, None)
            axes.set_title(rf"$\bar p$/E* = {mean}", fontsize=9)
            label_panel(axes, "x/L", "p/E*")

    notes = (
        "mean is the mean pressure over E*, 0.05 and 0.15 as in the paper, which leaves R/L open: R = L is chosen.",
        "Isolated is Hertz; exact is p = (L E*/2 pi R) arcosh(cos(pi x/L)/cos(pi a/L)), which the paper takes to be unknown.",
        f"Solved from scenes; exact and first-order differ from closed forms by at most {max(apart):.1e} of the peak.",
        *said,
    )
    return Figure("11", "Pressure on parabolic asperities", notes, columns, draw)


def figure_12() -> Figure:
    """Half-width of contact against the load."""
    shares = np.round(np.arange(0.01, 0.4925, 0.01), 10)
    columns: dict[str, Array] = {"a/L": shares}
    for model in MODELS:
        found = [solved(_PARABOLA, model, half_width=a) for a in shares]
        columns[f"P R/(L^2 E*) {model}"] = np.array([np.nan if s is None else s.load for s in found])
    closed = [LocalizedParabola(1.0, 1.0, 1.0, a) for a in shares]
    apart = worst(columns[f"P R/(L^2 E*) {FIRST}"], np.array([c.load for c in closed]))
    kuznetsov = worst(columns[f"P R/(L^2 E*) {EXACT}"], np.array([c.exact.load for c in closed]))
    end, low = LocalizedParabola(1.0, 1.0, 1.0, 0.35), LocalizedParabola(1.0, 1.0, 1.0, 0.125)
    hertz_width = float(np.sqrt(4.0 * low.exact.load / np.pi)) / 0.125 - 1.0

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        for model in MODELS:
            curve(left, columns[f"P R/(L^2 E*) {model}"], shares, model, "Hertz" if model == ALONE else model)
        left.set_xlim(0.0, 0.4)
        left.set_ylim(0.0, 0.5)
        for axes in (left.axhline, right.axvline):
            for share in (0.125, 0.35):
                axes(share, color="black", linewidth=0.6)
        label_panel(left, "P R/(L² E*)", "a/L")
        for model in (FIRST, SELF, ONE, ALONE):
            error = columns[f"P R/(L^2 E*) {model}"] / columns[f"P R/(L^2 E*) {EXACT}"] - 1.0
            right.plot(shares, 100.0 * error, **STYLE[model])
        right.set_xlim(0.0, 0.5)
        right.set_ylim(-30.0, 30.0)
        right.axhline(0.0, color="black", linewidth=0.6)
        label_panel(right, "a/L", "error of the load [%]", legend=False)

    notes = (
        "The paper's curves are the first-order (30), the exact (28) and Hertz.",
        f"Solved from scenes at given half-width; they differ from (30) by {apart:.1e} and from (28) by {kuznetsov:.1e} at most.",
        f"At a/L = 0.125 Hertz is {100 * low.isolated_load_error:+.3g} % off in load at the same width, "
        f"{100 * hertz_width:+.3g} % in width at the same load.",
        f"At a/L = 0.35: first-order {100 * end.load_error:+.3g} %, Hertz {100 * end.isolated_load_error:+.3g} % in load.",
    )
    return Figure("12", "Width of contact of parabolic asperities", notes, columns, draw)
