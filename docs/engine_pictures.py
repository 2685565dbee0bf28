"""Pictures of examples of the engine that say more than the density of their last solution.

Each function takes what the main function of its example returns. `docs/pictures.py` calls them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import sie
from contact.extras import require

COLOURS = ("#1f5a92", "#b3261e", "#3d7a4a", "#8a5a00", "#6a3d8a")


def panels(columns: int, **options: Any) -> tuple[Any, Any]:
    """An empty figure and its axes, side by side."""
    figure = require("matplotlib.figure").Figure(figsize=(7.0, 3.2), layout="constrained")
    return figure, figure.subplots(1, columns, **options)


def draw_density(axes: Any, found: sie.Solution, colour: str, label: str) -> None:
    """Draw the density of every zone between free ends or singular ends."""
    t = np.sin(np.linspace(-0.5, 0.5, 403) * np.pi)[1:-1]
    for zone, (a, b) in enumerate(found.zones.table):
        x = 0.5 * (a + b) + 0.5 * (b - a) * t
        density = found.density.at_t(zone, t)
        if found.zones.moves[:, zone].all():
            x, density = np.r_[a, x, b], np.r_[0.0, density, 0.0]
        axes.plot(x, density, color=colour, lw=1.3, label=label if zone == 0 else None)


def sliding_punch(rows: Any) -> Any:
    """Pressures under the flat punch and under the cylinder."""
    figure, (left, right) = panels(2, sharey=True)
    for (mu, flat, _, cylinder, _), colour in zip(rows, COLOURS, strict=False):
        draw_density(left, flat, colour, f"$\\mu$ = {mu:g}")
        draw_density(right, cylinder, colour, f"$\\mu$ = {mu:g}")
    left.set(title="flat punch", xlabel="x [mm]", ylabel="pressure [MPa]", ylim=(0, 150))
    right.set(title="cylinder", xlabel="x [mm]")
    right.axvline(0.0, color="#999999", lw=0.6, ls=":")
    for axes in (left, right):
        axes.annotate("sliding", (0.95, 0.93), (0.7, 0.93), "axes fraction", va="center",
                      fontsize=8, arrowprops={"arrowstyle": "->", "lw": 0.8})  # fmt: skip
    right.legend(fontsize=8, frameon=False, loc="upper left")
    return figure


def interface_crack(rows: Any) -> Any:
    """Opening of one crack, and opening and slip in the last hundredth before its tip."""
    figure, (left, right) = panels(2)
    distance = np.geomspace(1e-12, 1.0, 400)
    x = np.r_[-1 + distance, (1 - distance)[::-1]]
    for (beta, one, *_), colour in zip(rows, COLOURS, strict=False):
        opening = one.density.integral(x)
        left.plot(x, opening.real, color=colour, lw=1.3, label=f"$\\beta$ = {beta:g}")
        left.plot(x, opening.imag, color=colour, lw=1.1, ls="--")
        near = opening[: len(distance)] / np.sqrt(distance)
        right.semilogx(distance, near.real, color=colour, lw=1.3)
        right.semilogx(distance, near.imag, color=colour, lw=1.1, ls="--")
    left.set(title="opening, and slip (dashed)", xlabel="x / a")
    right.set(title=r"both over $\sqrt{d}$", xlabel="distance d / a from the tip")
    left.legend(fontsize=8, frameon=False, loc="center")
    return figure


def porous_aerofoil(rows: Any) -> Any:
    """Difference of the pressures along the chord."""
    figure, axes = panels(1)
    near = np.geomspace(1e-9, 0.2, 150)
    x = np.sort(np.r_[near, np.linspace(0.2, 0.6, 50), 0.75 - near, 0.75 + near, 1 - near])
    x = x[(x > 0) & (x < 1)]
    for (kappa, found, lift, _), colour in zip(rows, COLOURS, strict=False):
        label = f"$\\kappa$ = {kappa:g}, $c_L$ = {lift:.3f}"
        axes.plot(x, 2 * found.density(x), color=colour, lw=1.3, label=label)
    axes.annotate("hinge", (0.765, 1.4), fontsize=8, color="#666666")
    axes.set(xlabel="x / chord", ylabel=r"pressure difference $\Delta c_p = 2\gamma/U$")
    axes.set(xlim=(0, 1), ylim=(0, 1.5))
    axes.legend(fontsize=8, frameon=False, loc="upper center")
    return figure


def thin_ligament(rows: Any) -> Any:
    """Stress intensity factors at both tips, over that of one long crack."""
    figure, axes = panels(1)
    widths = np.array([found.zones.a[1] - found.zones.b[0] for found, _, _ in rows])
    one = np.sqrt(np.pi)
    for tip, name in enumerate(("outer", "inner")):
        got, closed = (np.array([row[k][tip] for row in rows]) / one for k in (1, 2))
        axes.loglog(widths / 2, closed, color=COLOURS[tip], lw=1.2, label=f"{name} tip, Willmore")
        axes.loglog(widths / 2, got, "o", color=COLOURS[tip], ms=5, mfc="none", label=f"{name} tip")
    axes.axhline(1.0, color="#999999", lw=0.6, ls=":")
    axes.annotate("one long crack", (0.75e-8, 1.12), fontsize=8, color="#666666")
    axes.set(xlabel="ligament / length of both cracks", ylabel=r"$K_I / (s\sqrt{\pi b})$")
    axes.legend(fontsize=8, frameon=False)
    return figure


def splitting_cut(rows: Any) -> Any:
    """Densities before, at and after the splitting."""
    figure, axes = panels(1)
    for (t, found, _), colour in zip(rows, COLOURS, strict=False):
        draw_density(axes, found, colour, f"t = {t:g}")
    axes.axhline(0.0, color="black", lw=0.5)
    axes.set(xlabel="eigenvalue x", ylabel=r"density $\varphi$", ylim=(0, None))
    axes.legend(fontsize=8, frameon=False, ncols=5, loc="upper center", columnspacing=1.0)
    axes.set_ylim(top=1.18 * axes.get_ylim()[1])
    return figure


def birth_of_a_cut(returned: Any) -> Any:
    """Densities, and how far the potential less V / 2 pi is below its level on the cuts."""
    birth, at, found = returned
    figure, (left, right) = panels(2)
    for one, colour in zip(found, COLOURS, strict=False):
        total = one.density.totals.sum()
        draw_density(left, one, colour, f"T = {total / birth:.4g} $T_c$")
        x = np.linspace(-2.2, 2.2, 441)
        primitive = one.state.equation.forcing.primitive
        level = one.density.potential(x) - primitive(x)
        middle = one.zones.middle[:1]
        level = level - one.density.potential(middle) + primitive(middle)
        right.plot(x, level, color=colour, lw=1.1)
    left.set(xlabel="eigenvalue x", ylabel=r"density $\varphi$", ylim=(0, None))
    left.legend(fontsize=8, frameon=False, loc="upper center")
    right.axhline(0.0, color="black", lw=0.5)
    right.axvline(at, color="#999999", lw=0.6, ls=":")
    right.set(xlabel="x", ylabel=r"potential $-\;V/2\pi$, over its level", ylim=(-0.35, 0.03))
    return figure


DRAWINGS: dict[str, Callable[[Any], Any]] = {
    "sliding_punch": sliding_punch,
    "interface_crack": interface_crack,
    "porous_aerofoil": porous_aerofoil,
    "thin_ligament": thin_ligament,
    "splitting_cut": splitting_cut,
    "birth_of_a_cut": birth_of_a_cut,
}
