"""Very large and small moduli and lengths, and slopes that are steep or almost jump."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from contact.model.interactions import Isolated, Periodic
from contact.model.profiles import Parabola, Polynomial, Wedge
from contact.model.scene import Scene
from contact.reference.exact import HertzLine, IsolatedWedge
from contact.reference.inverse import design
from contact.studies.bench.extremes.base import Extreme
from contact.studies.bench.extremes.loads import wave
from contact.studies.bench.hyperbola import BluntedWedge, IsolatedBluntedWedge
from contact.studies.bench.power import PowerPunch
from contact.studies.bench.truncated import IsolatedTruncatedWedge, TruncatedWedge
from contact.studies.bench.truth import Exact

_UNITS = "a unit changes nothing"


def units() -> Iterator[Extreme]:
    """Extreme scenes: ordinary contacts with very large or very small moduli and lengths."""
    for power in (-12, -6, 6, 12):
        yield Extreme("moduli", f"E* = 1e{power} Pa", partial(wave, 0.4, 10.0**power), 1.0, _UNITS)
        yield Extreme(
            "lengths",
            f"L = 1e{power} m",
            partial(wave, 0.4, 1.0, 10.0**power, 10.0 ** (power - 2)),
            1.0,
            _UNITS,
        )
    for power in (-12, 12):
        yield Extreme(
            "lengths",
            f"three zones, L = 1e{power} m, E* = 1e{-power} Pa",
            partial(_three, 10.0**power, 10.0**-power),
            1e2,
            "(widest over narrowest zone)^2",
        )
        yield Extreme(
            "lengths", f"Hertz, R = 1e{power} m", partial(_hertz, 10.0**power), 1.0, _UNITS
        )


def _hertz(radius: float) -> tuple[Scene, Exact]:
    exact = HertzLine(radius=radius, E_star=1e11, half_width=1e-3 * radius)
    return Scene(Parabola(radius), 1e11, Isolated(), load=exact.load), exact


def _three(length: float, E_star: float) -> tuple[Scene, Exact]:
    zones = length * np.array([[-0.4, -0.1], [0.0, 0.03], [0.1, 0.3]])
    exact = design(zones, E_star, 0.05 * E_star * length, length)
    return Scene(exact.profile, E_star, Periodic(), load=exact.load), exact


def slopes() -> Iterator[Extreme]:
    """Extreme scenes with steep slopes, high powers, or corners (declared or rounded)."""
    group = "slopes"
    for steep in (1e-6, 1e6):
        yield Extreme(
            group, f"wedge, slope {steep:g}", partial(_wedge, steep), 1.0, "linear in the slope"
        )
    yield Extreme(
        group, "wave, slope 6e6", partial(wave, 0.4, amplitude=1e6), 1.0, "linear in the slope"
    )
    yield Extreme(group, "x^20", partial(_power, 20), 20.0, "the order of the power")
    yield Extreme(group, "x^100", partial(_power, 100), 100.0, "the order of the power")
    for width in (0.5, 1e-3, 1e-6):
        yield Extreme(
            group,
            f"two corners {width:g} apart, declared",
            partial(_truncated, 0.5 * width),
            20.0,
            "p' ~ 1/d, compared no nearer to a corner than d = 0.05",
        )
    undeclared = (
        "an undeclared corner: its slope turns within less than 32,768 modes see; "
        "declare it as a kink"
    )
    for width in (1e-1, 1e-2, 1e-3, 1e-6):
        yield Extreme(
            group,
            f"wedge blunted over {width:g} of its contact",
            partial(_blunted, width),
            1.0,
            "p' ~ ln(a/x)",
            heavy=width < 1e-5,
            known=undeclared if width < 5e-4 else "",
        )


def _wedge(slope: float) -> tuple[Scene, Exact]:
    exact = IsolatedWedge(wedge_slope=slope, E_star=1.0, half_width=1.0)
    return Scene(Wedge(slope), 1.0, Isolated(), load=exact.load), exact


def _blunted(rounding: float) -> tuple[Scene, Exact]:
    exact = IsolatedBluntedWedge(0.1, rounding, 1.0, 1.0)
    return Scene(BluntedWedge(0.1, rounding), 1.0, Isolated(), load=exact.load), exact


def _truncated(half_top: float) -> tuple[Scene, Exact]:
    exact = IsolatedTruncatedWedge(0.1, half_top, 1.0, 1.0)
    return Scene(TruncatedWedge(0.1, half_top), 1.0, Isolated(), load=exact.load), exact


def _power(order: int) -> tuple[Scene, Exact]:
    exact = PowerPunch(order)
    coefficients = np.zeros(order + 1)
    coefficients[-1] = 1 / order
    return Scene(Polynomial(coefficients), 1.0, Isolated(), load=exact.load), exact
