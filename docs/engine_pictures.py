"""Pictures of examples of the engine that say more than the density of their last solution.

Each function takes what the main function of its example returns, and the lines: keyword arguments
of matplotlib for one curve after the other. `docs/pictures.py` calls them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import sie
from contact.solution.drawing import inner_ticks, legend_outside, new_figure, ramp

Line = dict[str, Any]
Lines = Sequence[Line]


def panels(columns: int, **options: Any) -> tuple[Any, Any]:
    """An empty figure and its axes, side by side."""
    figure = new_figure(7.0, 3.2)
    axes = figure.subplots(1, columns, **options)
    for one in np.ravel(axes):
        inner_ticks(one)
    return figure, axes


def of_densities(found: Sequence[sie.Solution], name: str, lines: Lines) -> Any:
    """The densities of solutions on their intervals. name: what the density is."""
    figure, axes = panels(1)
    t = np.sin(np.linspace(-0.5, 0.5, 301) * np.pi)[1:-1]
    top = low = 0.0
    for one, line in zip(found, lines, strict=False):
        label = " and ".join(f"[{a:g}, {b:g}]" for a, b in one.zones.table.round(3))
        for zone, (a, b) in enumerate(one.zones.table):
            density = one.density.at_t(zone, t)
            top = max(top, 4.0 * float(np.median(np.abs(density))))
            low = min(low, float(np.min(density)))
            x = 0.5 * (a + b) + 0.5 * (b - a) * t
            axes.plot(x, density, label=label if zone == 0 else None, **line)
    axes.axhline(0.0, color="black", lw=0.5)
    axes.set(xlabel="$x$", ylabel=name, ylim=(max(low, -top) - 0.02 * top, top))
    if len(found) > 1:
        legend_outside(figure, (axes,))
    return figure


def draw_density(axes: Any, found: sie.Solution, line: Line, label: str) -> None:
    """Draw the density of every zone between free ends or singular ends."""
    t = np.sin(np.linspace(-0.5, 0.5, 403) * np.pi)[1:-1]
    for zone, (a, b) in enumerate(found.zones.table):
        x = 0.5 * (a + b) + 0.5 * (b - a) * t
        density = found.density.at_t(zone, t)
        if found.zones.moves[:, zone].all():
            x, density = np.r_[a, x, b], np.r_[0.0, density, 0.0]
        axes.plot(x, density, label=label if zone == 0 else None, **line)


def sliding_punch(rows: Any, lines: Lines) -> Any:
    """Pressures under the flat punch and under the cylinder."""
    figure, (left, right) = panels(2, sharey=True)
    for (mu, flat, _, cylinder, _), line in zip(rows, lines, strict=False):
        draw_density(left, flat, line, f"$\\mu$ = {mu:g}")
        draw_density(right, cylinder, line, f"$\\mu$ = {mu:g}")
    left.set(title="flat punch", xlabel="$x$ [mm]", ylabel="pressure [MPa]", ylim=(0, 150))
    right.set(title="cylinder", xlabel="$x$ [mm]")
    right.axvline(0.0, color="#999999", lw=0.6, ls=":")
    for axes in (left, right):
        axes.annotate("sliding", (0.95, 0.93), (0.7, 0.93), "axes fraction", va="center",
                      fontsize=8, arrowprops={"arrowstyle": "->", "lw": 0.8})  # fmt: skip
    right.legend(fontsize=8, frameon=False, loc="upper left")
    return figure


def interface_crack(rows: Any, lines: Lines) -> Any:
    """Opening of one crack, and opening and slip in the last hundredth before its tip."""
    figure, (left, right) = panels(2)
    distance = np.geomspace(1e-12, 1.0, 400)
    x = np.r_[-1 + distance, (1 - distance)[::-1]]
    # The dashes mean slip, so that the values of beta differ in the lightness of their colours.
    for (beta, one, *_), colour in zip(rows, ramp(len(rows)), strict=True):
        opening = one.density.integral(x)
        left.plot(x, opening.real, color=colour, lw=1.3, label=f"$\\beta$ = {beta:g}")
        left.plot(x, opening.imag, color=colour, lw=1.1, ls="--")
        near = opening[: len(distance)] / np.sqrt(distance)
        right.semilogx(distance, near.real, color=colour, lw=1.3)
        right.semilogx(distance, near.imag, color=colour, lw=1.1, ls="--")
    left.set(title="opening, and slip (dashed)", xlabel="$x / a$")
    right.set(title=r"both over $\sqrt{d}$", xlabel="distance $d / a$ from the tip")
    left.legend(fontsize=8, frameon=False, loc="center")
    return figure


def porous_aerofoil(rows: Any, lines: Lines) -> Any:
    """Difference of the pressures along the chord."""
    figure, axes = panels(1)
    near = np.geomspace(1e-9, 0.2, 150)
    x = np.sort(np.r_[near, np.linspace(0.2, 0.6, 50), 0.75 - near, 0.75 + near, 1 - near])
    x = x[(x > 0) & (x < 1)]
    for (kappa, found, lift, _), line in zip(rows, lines, strict=False):
        label = f"$\\kappa$ = {kappa:g}, $c_L$ = {lift:.3f}"
        axes.plot(x, 2 * found.density(x), label=label, **line)
    axes.annotate("hinge", (0.765, 1.4), fontsize=8, color="#666666")
    axes.set(xlabel="$x$ / chord", ylabel=r"pressure difference $\Delta c_p = 2\gamma/U$")
    axes.set(xlim=(0, 1), ylim=(0, 1.5))
    axes.legend(fontsize=8, frameon=False, loc="upper center")
    return figure


def thin_ligament(rows: Any, lines: Lines) -> Any:
    """Stress intensity factors at both tips, over that of one long crack."""
    figure, axes = panels(1)
    widths = np.array([found.zones.a[1] - found.zones.b[0] for found, _, _ in rows])
    one = np.sqrt(np.pi)
    for tip, name in enumerate(("outer", "inner")):
        got, closed = (np.array([row[k][tip] for row in rows]) / one for k in (1, 2))
        axes.loglog(widths / 2, closed, label=f"{name} tip, Willmore", **lines[tip])
        marks = {"color": lines[tip]["color"], "marker": "os"[tip], "ms": 5, "mfc": "none"}
        axes.loglog(widths / 2, got, ls="none", label=f"{name} tip", **marks)
    axes.axhline(1.0, color="#999999", lw=0.6, ls=":")
    axes.annotate("one long crack", (0.75e-8, 1.12), fontsize=8, color="#666666")
    axes.set(xlabel="ligament / length of both cracks", ylabel=r"$K_I / (s\sqrt{\pi b})$")
    axes.legend(fontsize=8, frameon=False)
    return figure


def splitting_cut(rows: Any, lines: Lines) -> Any:
    """Densities before, at and after the splitting."""
    figure, axes = panels(1)
    for (t, found, _), line in zip(rows, lines, strict=False):
        draw_density(axes, found, line, f"t = {t:g}")
    axes.axhline(0.0, color="black", lw=0.5)
    axes.set(xlabel="eigenvalue $x$", ylabel=r"density $\varphi$", ylim=(0, None))
    axes.legend(fontsize=8, frameon=False, ncols=5, loc="upper center", columnspacing=1.0)
    axes.set_ylim(top=1.18 * axes.get_ylim()[1])
    return figure


def birth_of_a_cut(returned: Any, lines: Lines) -> Any:
    """Densities, and how far the potential less V / 2 pi is below its level on the cuts."""
    birth, at, found = returned
    figure, (left, right) = panels(2)
    for one, line in zip(found, lines, strict=False):
        total = one.density.totals.sum()
        draw_density(left, one, line, f"T = {total / birth:.4g} $T_c$")
        x = np.linspace(-2.2, 2.2, 441)
        primitive = one.state.equation.forcing.primitive
        level = one.density.potential(x) - primitive(x)
        middle = one.zones.middle[:1]
        level = level - one.density.potential(middle) + primitive(middle)
        right.plot(x, level, **line)
    left.set(xlabel="eigenvalue $x$", ylabel=r"density $\varphi$", ylim=(0, None))
    left.legend(fontsize=8, frameon=False, loc="upper center")
    right.axhline(0.0, color="black", lw=0.5)
    right.axvline(at, color="#999999", lw=0.6, ls=":")
    right.set(xlabel="$x$", ylabel=r"potential $-\;V/2\pi$, over its level", ylim=(-0.35, 0.03))
    return figure


DRAWINGS: dict[str, Callable[[Any, Lines], Any]] = {
    "sliding_punch": sliding_punch,
    "interface_crack": interface_crack,
    "porous_aerofoil": porous_aerofoil,
    "thin_ligament": thin_ligament,
    "splitting_cut": splitting_cut,
    "birth_of_a_cut": birth_of_a_cut,
}
# What the density of an example is, for the pictures of `of_densities`.
DENSITIES = {
    "aerofoils": r"vortex sheet $\gamma$ / speed",
    "capacity": "charge density",
    "cracks": "dislocation density",
    "equilibrium": "density of eigenvalues",
    "stresses": "dislocation density",
}
