"""Figures 2A and 2B: spherical asperities on a hexagonal lattice.

They are computed by equations (1)-(4), and with all neighbours at their true positions.
"""

from dataclasses import dataclass
from math import inf, pi
from typing import Any

import numpy as np

from contact.axisymmetric import Hexagonal, Sphere, Spot, own_radius, solve_spot
from contact.errors import OutOfRange
from contact.paper.figures.base import Array, Figure, label_panel


@dataclass(frozen=True)
class SpotsOfThePaper:
    """The scenes of figures 2A and 2B, with E* = 1 and R = 1."""

    # Load P of one spot, divided by E* R^2. The number 0.0044 in the caption is pi P/(2 E* R^2).
    load: float = 0.0044 * 2.0 / pi
    spacings_a: tuple[float, ...] = (1.0, 0.25, 0.2)
    spacings_b: tuple[float, ...] = (1.0, 0.5, 0.2)
    radius: float = 1.0


_SCENES = SpotsOfThePaper()
_COLOURS = ("#2f7fb5", "#d98e04", "#b3261e")
# Names of the models in the figures. `_RINGS` gives, for each model, the number of rings of
# neighbouring spots that are taken at their true positions. `_LINES` gives the line styles.
_FIRST = "(1)-(4)"
_ALL = "all neighbours"
_HERTZ = "Hertz"
_RINGS = {_FIRST: 0, _ALL: inf}
_LINES: dict[str, Any] = {_FIRST: "-", _ALL: "--", _HERTZ: (0, (1, 1))}


def _solved(spacing: float, rings: float, **control: float) -> Spot | None:
    try:
        return solve_spot(Sphere(_SCENES.radius), 1.0, Hexagonal(spacing), rings=rings, **control)
    except OutOfRange:
        return None


def figure_2a() -> Figure:
    """Figure 2A: pressure on one spot of a lattice, at a given load of each spot."""
    alone = solve_spot(Sphere(_SCENES.radius), 1.0, load=_SCENES.load)
    spots = {
        (name, s): _solved(s, rings, load=_SCENES.load)
        for name, rings in _RINGS.items()
        for s in _SCENES.spacings_a
    }
    radii = [alone.radius, *(spot.radius for spot in spots.values() if spot is not None)]
    r = np.unique(np.concatenate([a * np.sin(np.linspace(0.0, 0.5 * pi, 81)) for a in radii]))
    columns: dict[str, Array] = {"r/R": r, "p/E* Hertz": alone.pressure(r)}
    lines = [f"Hertz: a/R = {alone.radius:.6f}, peak {float(alone.pressure(0.0)):.6f} E*"]
    for (name, spacing), spot in spots.items():
        columns[f"p/E* {name} l/R={spacing}"] = (
            np.full(r.shape, np.nan) if spot is None else spot.pressure(r)
        )
        text = "no solution, because neighbouring spots would overlap"
        if spot is not None:
            text = (
                f"a/R = {spot.radius:.6f}, a/A = {spot.radius / spot.circle:.4f}, peak "
                f"{float(spot.pressure(0.0)):.6f} E*"
            )
        lines.append(f"{name}, l/R = {spacing}: {text}")

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        axes.plot(r, columns["p/E* Hertz"], color="#7a7a7a", linestyle=_LINES[_HERTZ], label=_HERTZ)
        for spacing, colour in zip(_SCENES.spacings_a, _COLOURS, strict=True):
            for name in _RINGS:
                if spots[name, spacing] is not None:
                    style = {
                        "color": colour,
                        "linestyle": _LINES[name],
                        "label": f"{name}, l/R = {spacing}",
                    }
                    axes.plot(r, columns[f"p/E* {name} l/R={spacing}"], **style)
        label_panel(axes, "r/R", "p/E*", xlim=(0.0, None), ylim=(0.0, None))

    notes = (
        "Spheres of radius R on a hexagonal lattice of spacing l. In pi P/2E*R^2 = 0.0044, P is "
        "taken as the load of one spot, not as a pressure.",
        "(1)-(4): with E*/4pi, A = (pi N)^(-1/2) and self-consistent P_s. All neighbours: every "
        "spot of the lattice is taken at its true position.",
        *lines,
    )
    return Figure(
        "2A", "Pressure on a spherical asperity among others", notes, columns, draw, (6.4, 4.4)
    )


def figure_2b() -> Figure:
    """Figure 2B: radius of the spots as a function of the nominal pressure."""
    shares = np.concatenate([np.linspace(0.02, 0.9, 45), np.linspace(0.91, 0.95, 5)])
    columns: dict[str, Array] = {"a/A": shares}
    lines = []
    unit = {}
    for name, rings in _RINGS.items():
        spots = [
            _solved(1.0, rings, spot_radius=float(a))
            for a in shares * own_radius(Hexagonal(1.0).density)
        ]
        unit[name] = np.array([np.nan if s is None else s.nominal_pressure for s in spots])
    for spacing in _SCENES.spacings_b:
        lattice = Hexagonal(spacing)
        a = shares * own_radius(lattice.density)
        columns[f"a/R l/R={spacing}"] = a
        columns[f"p/E* Hertz l/R={spacing}"] = 4.0 / 3.0 * a**3 * lattice.density
        # The heights of a paraboloid scale as the square of lengths. Therefore the nominal pressure
        # p, in the form p R/(E* l), is the same function of a/A for all spacings l of the lattice.
        for name, pressure in unit.items():
            columns[f"p/E* {name} l/R={spacing}"] = spacing * pressure
    for share in (0.2, 0.5, 0.8):
        i = int(np.argmin(np.abs(shares - share)))
        error = columns["p/E* (1)-(4) l/R=0.5"][i] / columns[f"p/E* {_ALL} l/R=0.5"][i] - 1.0
        hertz = columns["p/E* Hertz l/R=0.5"][i] / columns[f"p/E* {_ALL} l/R=0.5"][i] - 1.0
        lines.append(
            f"a/A = {shares[i]:.2f}: (1)-(4) {100 * error:+.3g} %, Hertz {100 * hertz:+.3g} %"
        )

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        left.set(xlim=(0.0, 0.2), ylim=(0.0, 0.5))
        right.set(xscale="log", yscale="log", xlim=(1e-5, 1.0), ylim=(1e-2, 0.6))
        for axes in (left, right):
            for name in (_ALL, _HERTZ):
                axes.plot([], [], color="black", linestyle=_LINES[name], label=name)
            for spacing, colour in zip(_SCENES.spacings_b, _COLOURS, strict=True):
                for name, line in _LINES.items():
                    label = f"{name}, l/R = {spacing}" if name == _FIRST else None
                    of_spacing = (
                        columns[f"p/E* {name} l/R={spacing}"],
                        columns[f"a/R l/R={spacing}"],
                    )
                    axes.plot(*of_spacing, color=colour, linestyle=line, label=label)
            label_panel(axes, r"$\bar p$/E*", "a/R", legend=axes is right)

    notes = (
        "Spheres of radius R on a hexagonal lattice of spacing l; p is the nominal pressure. The "
        "paper does not state the range of p.",
        "Solid: (1)-(4) with E*/4pi and A = (pi N)^(-1/2), self-consistent. Dashed: all neighbours "
        "at their true positions. Dotted: Hertz.",
        "Computed for l = R only, since p R/E* l is the same function of a/A for every l. Spots "
        "touch at a = l/2, where a/A = 0.952.",
        "Errors of the pressure relative to the solution with all neighbours, at any l/R:",
        *lines,
    )
    return Figure("2B", "Radius of the spots against the nominal pressure", notes, columns, draw)
