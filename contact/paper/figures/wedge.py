"""Figures 9 and 10: the wedge."""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.model.profiles import Wedge
from contact.paper import LocalizedWedge
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
    curve,
    label_panel,
    on_cell,
    pressures,
    solved,
    worst,
)

# E* = 1, L = 1; the slope is a scale only.
_SLOPE = 0.01
_WEDGE = Wedge(slope=_SLOPE, period=1.0)
FRACTIONS = (0.4, 0.7)
_MODELS = (EXACT, FIRST, SELF, ONE)


def figure_9() -> Figure:
    """Pressure under the wedge at two widths of contact."""
    every = {(f, m): solved(_WEDGE, m, half_width=0.5 * f) for f in FRACTIONS for m in _MODELS}
    x = on_cell(list(every.values()), 0.5)
    columns: dict[str, Array] = {"x/L": x}
    for (fraction, model), solution in every.items():
        columns[f"p/(E* tan b) {model} 2a/L={fraction}"] = pressures(solution, x) / _SLOPE
    apart, beside = [], []
    for fraction in FRACTIONS:
        closed = LocalizedWedge(_SLOPE, 1.0, 1.0, 0.5 * fraction)
        away = np.abs(x) > 1e-3
        for model, form in ((FIRST, closed.pressure(x)), (EXACT, closed.exact.pressure(x))):
            apart.append(worst(columns[f"p/(E* tan b) {model} 2a/L={fraction}"][away] * _SLOPE, form[away]))
        t = np.linspace(0.01, 0.99, 99)
        difference = np.max(np.abs(closed.pressure_at(t) - closed.exact.pressure_at(t))) / closed.exact.load * fraction
        beside.append(f"{100 * difference:.3g} % at 2a/L = {fraction}")

    def draw(figure: Any) -> None:
        for axes, fraction in zip(figure.subplots(1, 2), FRACTIONS, strict=True):
            for model in _MODELS:
                curve(axes, x, columns[f"p/(E* tan b) {model} 2a/L={fraction}"], model, model)
            axes.set_xlim(-0.5, 0.5)
            axes.set_ylim(0.0, 1.6)
            axes.set_title(f"2a/L = {fraction}", fontsize=9)
            label_panel(axes, "x/L", r"p/(E* tan$\,\beta$)")

    notes = (
        "b is the angle of the wedge. The paper gives no widths: 2a/L = 0.4 and 0.7 are chosen, as for the wave.",
        "The pressure is infinite at x = 0: no entry there. The paper's curve is the first-order one, (26) with |x| for x.",
        f"Solved from scenes; beyond |x| = 0.001 L they differ from (25) and (26) by at most {max(apart):.1e} of the greatest.",
        f"First-order against exact, greatest difference over the mean on the zone: {', '.join(beside)}.",
    )
    return Figure("9", "Pressure on a wedge", notes, columns, draw)


def figure_10() -> Figure:
    """Width of contact against the mean pressure."""
    fractions = np.round(np.arange(0.02, 0.985, 0.02), 10)
    columns: dict[str, Array] = {"2a/L": fractions}
    for model in MODELS:
        found = [solved(_WEDGE, model, half_width=0.5 * f) for f in fractions]
        columns[f"mean/(E* tan b) {model}"] = np.array([np.nan if s is None else s.load / _SLOPE for s in found])
    closed = [LocalizedWedge(_SLOPE, 1.0, 1.0, 0.5 * f) for f in fractions]
    apart = worst(columns[f"mean/(E* tan b) {FIRST}"], np.array([c.mean_pressure for c in closed]) / _SLOPE)
    at = LocalizedWedge(_SLOPE, 1.0, 1.0, 0.35)

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        for model in MODELS:
            curve(left, columns[f"mean/(E* tan b) {model}"], fractions, model, model)
        left.set_xlim(0.0, 1.1)
        left.set_ylim(0.0, 1.0)
        left.axhline(0.7, color="black", linewidth=0.6)
        label_panel(left, r"$\bar p$/(E* tan$\,\beta$)", "2a/L")
        for model in (FIRST, SELF, ONE, ALONE):
            error = columns[f"mean/(E* tan b) {model}"] / columns[f"mean/(E* tan b) {EXACT}"] - 1.0
            right.plot(fractions, 100.0 * error, **STYLE[model])
        right.set_xlim(0.0, 1.0)
        right.set_ylim(-30.0, 30.0)
        right.axvline(0.7, color="black", linewidth=0.6)
        right.axhline(0.0, color="black", linewidth=0.6)
        label_panel(right, "2a/L", "error of the mean pressure [%]", legend=False)

    notes = (
        "b is the wedge's angle. The paper's curves are the first-order (27) and the exact E* tan b artanh(sin(pi a/L))/pi.",
        f"Solved from scenes at given half-width; first-order differs from (27) by at most {apart:.1e} of its greatest.",
        f"At 2a/L = 0.7: first-order {100 * at.load_error:+.3g} %, isolated {100 * at.isolated_load_error:+.3g} %.",
    )
    return Figure("10", "Width of contact of a wedge", notes, columns, draw)
