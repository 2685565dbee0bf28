"""Figures 7 and 8: the sinusoid."""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.model.profiles import Sinusoid
from contact.paper import LocalizedWave
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

# E* = 1, L = 1; the amplitude is a scale only.
_WAVE = Sinusoid(amplitude=0.01, period=1.0)
_P_STAR = np.pi * 0.01
FRACTIONS = (0.4, 0.7)
_MODELS = (EXACT, FIRST, SELF, ONE)


def _closed(half_width: float) -> LocalizedWave:
    return LocalizedWave(0.01, 1.0, 1.0, half_width)


def figure_7() -> Figure:
    """Pressure under the wave at two widths of contact."""
    columns: dict[str, Array] = {}
    apart = []
    every = {(f, m): solved(_WAVE, m, half_width=0.5 * f) for f in FRACTIONS for m in _MODELS}
    x = on_cell(list(every.values()), 0.5)
    columns["x/L"] = x
    for (fraction, model), solution in every.items():
        columns[f"p/p* {model} 2a/L={fraction}"] = pressures(solution, x) / _P_STAR
    for fraction in FRACTIONS:
        closed = _closed(0.5 * fraction)
        apart.append(worst(columns[f"p/p* {FIRST} 2a/L={fraction}"] * _P_STAR, closed.pressure(x)))
        apart.append(worst(columns[f"p/p* {EXACT} 2a/L={fraction}"] * _P_STAR, closed.exact.pressure(x)))

    def draw(figure: Any) -> None:
        for axes, fraction in zip(figure.subplots(1, 2), FRACTIONS, strict=True):
            for model in _MODELS:
                curve(axes, x, columns[f"p/p* {model} 2a/L={fraction}"], model, model)
            axes.set_xlim(-0.5, 0.5)
            axes.set_ylim(0.0, None)
            axes.set_title(f"2a/L = {fraction}", fontsize=9)
            label_panel(axes, "x/L", "p/p*")

    errors = ", ".join(f"{100 * _closed(0.5 * f).peak_error:+.3g} % at 2a/L = {f}" for f in FRACTIONS)
    notes = (
        "p* = pi E* Delta/L. The paper gives no widths: 2a/L = 0.4 and 0.7, the latter where it says the discrepancy begins.",
        "The paper's curve is the first-order one. Self-consistent closure and one explicit neighbour are added.",
        f"Solved from scenes; first-order and exact differ from (20)-(24) and (18) by at most {max(apart):.1e} of the peak.",
        f"Peak pressure, first-order against exact: {errors}.",
    )
    return Figure("7", "Pressure on a wave", notes, columns, draw)


def figure_8() -> Figure:
    """Mean and greatest pressure against the width of contact, and their errors."""
    fractions = np.round(np.arange(0.02, 0.985, 0.02), 10)
    columns: dict[str, Array] = {"2a/L": fractions}
    for model in MODELS:
        found = [solved(_WAVE, model, half_width=0.5 * f) for f in fractions]
        columns[f"mean/p* {model}"] = np.array([np.nan if s is None else s.load / _P_STAR for s in found])
        columns[f"max/p* {model}"] = np.array([np.nan if s is None else s.max_pressure / _P_STAR for s in found])
    closed = [_closed(0.5 * f) for f in fractions if np.isfinite(columns[f"mean/p* {FIRST}"][list(fractions).index(f)])]
    written = np.array([c.mean_pressure for c in closed]) / _P_STAR
    apart = worst(columns[f"mean/p* {FIRST}"][: len(written)], written)
    at = _closed(0.35)

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        for model in MODELS:
            curve(left, fractions, columns[f"mean/p* {model}"], model, model)
            curve(left, fractions, columns[f"max/p* {model}"], model)
        left.annotate("greatest", (0.62, 1.42), fontsize=8)
        left.annotate("mean", (0.62, 0.45), fontsize=8)
        left.set_xlim(0.0, 1.0)
        left.set_ylim(0.0, 2.1)
        label_panel(left, "2a/L", "p/p*")
        for model in (FIRST, SELF, ONE, ALONE):
            for name, width in (("mean", 1.4), ("max", 0.7)):
                error = columns[f"{name}/p* {model}"] / columns[f"{name}/p* {EXACT}"] - 1.0
                right.plot(fractions, 100.0 * error, **{**STYLE[model], "linewidth": width})
        right.set_ylim(-15.0, 15.0)
        right.set_xlim(0.0, 1.0)
        right.axvline(0.7, color="black", linewidth=0.6)
        right.axhline(0.0, color="black", linewidth=0.6)
        label_panel(right, "2a/L", "error [%], thick: mean, thin: greatest", legend=False)

    notes = (
        "p* = pi E* Delta/L. The paper's curves are the first-order ones (23), (24) and the exact (18), (19).",
        f"Solved from scenes at given half-width; the first-order mean differs from (23) by at most {apart:.1e} of its peak.",
        f"At 2a/L = 0.7, first-order: mean {100 * at.load_error:+.3g} %, greatest {100 * at.peak_error:+.3g} %; "
        f"isolated: mean {100 * at.isolated_load_error:+.3g} %.",
        "Where a model has no entry it has no contact of that width: one wave alone would overlap the surface at |x| = L/2.",
    )
    return Figure("8", "Mean and greatest pressure on a wave", notes, columns, draw)

