"""Very small and nearly full contact, and loads close to a merge or to full contact."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import pi, sin, sqrt, tan

import numpy as np

from contact.model.interactions import Isolated, Periodic
from contact.model.profiles import Biquadratic, Fourier, Parabola, Sinusoid, Wedge
from contact.model.scene import Scene
from contact.reference.exact import (
    IsolatedBiquadratic,
    PeriodicParabola,
    PeriodicWedge,
    Westergaard,
)
from contact.solver import solve
from contact.studies.bench.extremes.base import Extreme
from contact.studies.bench.one_gap import OneGap
from contact.studies.bench.truth import Exact


def fractions() -> Iterator[Extreme]:
    """Extreme scenes with contact fractions near 0 and near 1.

    Let p be the mean pressure, a the half width, and p* the pressure of full contact. Westergaard's
    wave has p/p* = sin^2 A with A = pi a/L, so that d ln a/d ln p = tan(A)/2A. The valleys of
    periodic wedges and parabolas are kinks, which close only exponentially as the mean pressure
    grows. There p ~ artanh(sin A) for wedges and p ~ -ln cos A for parabolas, and d ln a/d ln p is
    below one.
    """
    group = "contact fraction"
    for rest in (1e-6, 1e-3, 0.1):
        angle = 0.5 * pi * rest
        yield Extreme(
            group, f"wave, {rest:g}", partial(wave, rest), tan(angle) / (2 * angle), "tan(A)/2A"
        )
    for rest in (0.5, 1e-2, 1e-3, 1e-4, 1e-6):
        # `near_full` rounds the mean pressure to a double, as the solver needs, and gives the exact
        # half width for the rounded pressure.
        angle = 0.5 * pi * (1 - rest)
        yield Extreme(
            group,
            f"wave, 1 - {rest:g}",
            partial(near_full, sin(0.5 * pi * rest) ** 2),
            tan(angle) / (2 * angle),
            "tan(A)/2A",
        )
    for name, fraction in (("1e-6", 1e-6), ("1 - 1e-3", 1 - 1e-3), ("1 - 1e-6", 1 - 1e-6)):
        yield Extreme(
            group,
            f"row of wedges, {name}",
            partial(_row_of_wedges, fraction),
            1.0,
            "d ln a/d ln p < 1",
        )
        yield Extreme(
            group,
            f"row of parabolas, {name}",
            partial(_row_of_parabolas, fraction),
            1.0,
            "d ln a/d ln p < 1",
        )


def wave(
    fraction: float, E_star: float = 1.0, period: float = 1.0, amplitude: float = 1e-2
) -> tuple[Scene, Exact]:
    """(scene, exact solution) of Westergaard's wave at a given contact fraction."""
    exact = Westergaard.from_contact_fraction(
        fraction, amplitude=amplitude, period=period, E_star=E_star
    )
    return Scene(
        Sinusoid(amplitude, period), E_star, Periodic(), mean_pressure=exact.mean_pressure
    ), exact


def near_full(below: float) -> tuple[Scene, Exact]:
    """(scene, exact solution) of a wave at `1 - below` times the pressure of full contact.

    The mean pressure is rounded to a double; the zone is exact for the rounded pressure.
    """
    amplitude = 1 / pi  # p* = E* pi Delta/L = 1 for this amplitude Delta, up to round-off
    pressure = 1.0 - below
    half = 0.5 - np.arcsin(sqrt(_deficit(amplitude, pressure))) / pi
    exact = Westergaard(amplitude=amplitude, period=1.0, E_star=1.0, half_width=float(half))
    return Scene(Sinusoid(amplitude, 1.0), 1.0, Periodic(), mean_pressure=pressure), exact


def _deficit(amplitude: float, pressure: float) -> float:
    """Relative difference between the full-contact pressure and `pressure`, to full precision.

    The number pi is taken in extended precision.
    """
    high = np.longdouble(pi) + np.longdouble(1.2246467991473532e-16)
    full = high * np.longdouble(amplitude)
    return float((full - np.longdouble(pressure)) / full)


def _row_of_wedges(fraction: float) -> tuple[Scene, Exact]:
    exact = PeriodicWedge.from_contact_fraction(fraction, wedge_slope=0.1, period=1.0, E_star=1.0)
    return Scene(Wedge(0.1, 1.0), 1.0, Periodic(), load=exact.load), exact


def _row_of_parabolas(fraction: float) -> tuple[Scene, Exact]:
    exact = PeriodicParabola.from_contact_fraction(fraction, radius=1.0, period=1.0, E_star=1.0)
    return Scene(Parabola(1.0, 1.0), 1.0, Periodic(), load=exact.load), exact


def loads_near_full() -> Iterator[Extreme]:
    """Extreme scenes with mean pressures just below the mean pressure of full contact."""
    group = "load below full contact"
    for part in (1e-6, 1e-9, 1e-12):
        yield Extreme(
            group,
            f"by {part:g}",
            partial(near_full, part),
            1 / (pi * sqrt(part)),
            "1/(pi sqrt(part)): tan(A)/2A",
        )
    for part in (1e-6, 1e-9, 1e-12):
        yield Extreme(
            group,
            f"by {part:g}, six harmonics",
            partial(_series_near_full, part),
            1 / sqrt(part),
            "1/sqrt(part)",
        )


def _series_near_full(part: float) -> tuple[Scene, Exact]:
    """A profile of six random harmonics, just below full contact, where a single gap is left."""
    rng = np.random.default_rng(1)
    profile = Fourier(1.0, 1e-3 * rng.normal(size=6), 1e-3 * rng.normal(size=6))
    full = solve(Scene(profile, 1.0, Periodic(), contact_fraction=1.0)).mean_pressure
    assert full is not None
    scene = Scene(profile, 1.0, Periodic(), mean_pressure=full * (1 - part))
    return scene, OneGap.of(profile, full, scene)


def merges() -> Iterator[Extreme]:
    """Extreme scenes with loads close to the load at which the zones of two tips merge.

    At the relative distance `part` below this merging load, the gap between the zones of width w is
    g ~ w sqrt(part). A relative change eps of the load changes g/w by eps w/g. Above the merging
    load the solution is smooth in the load.
    """
    groups = ("load below a merge", "load above a merge")
    for part in (1e-3, 1e-6, 1e-9, 1e-12):
        yield Extreme(
            groups[0],
            f"by {part:g}",
            partial(_biquadratic, 1 - part),
            1 / sqrt(part),
            "w/g = 1/sqrt(part)",
            hair=sqrt(part),
        )
    for part in (1e-3, 1e-6, 1e-9, 1e-12):
        yield Extreme(
            groups[1], f"by {part:g}", partial(_biquadratic, 1 + part), 1.0, "smooth in the load"
        )


def _biquadratic(share: float) -> tuple[Scene, Exact]:
    """(scene, exact solution) of two tips, at `share` times the load at which their zones merge."""
    merging = IsolatedBiquadratic(radius=1.0, spacing=2.0, E_star=1.0, load=1.0).merging_load
    exact = IsolatedBiquadratic(radius=1.0, spacing=2.0, E_star=1.0, load=share * merging)
    return Scene(Biquadratic(1.0, 2.0), 1.0, Isolated(), load=exact.load), exact
