"""Measures time and memory of `solve` for growing numbers of zones, nodes and harmonics.

Each time is compared with a lower estimate, the floor. The floor is the time in which numpy
evaluates the profile once at the final nodes and sums the kernel once over all pairs of nodes. Any
solver with direct sums needs this time; fast sums can take less. Exponents of power laws are fitted
to the larger sizes, which all use fast sums or all use a matrix.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact.errors import NotConverged
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.model.interactions import Periodic
from contact.model.profiles import Fourier
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.solver import solve
from contact.studies.bench import clock
from contact.studies.bench.cases import designed, rough_profile

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scaled:
    """Measurement of one scene: time and memory of `solve`, and sizes of the solution.
    `floor` is a lower estimate of the time [s], see `floor_seconds`.
    """

    series: str
    size: int
    tol: float
    seconds: float
    peak_bytes: int
    floor: float
    zones: int
    nodes: int
    unknowns: int
    fast: bool


def floor_seconds(solution: Solution) -> float:
    """Lower estimate of the solver's time [s]: one evaluation of the profile, one kernel sum."""
    fields, profile = solution.fields, solution.scene.profile
    assert isinstance(fields, ZoneFields | GapFields)
    # Near full contact the solver's unknown is the slope of the gap. Otherwise it is the pressure.
    zones = (fields.density if isinstance(fields, ZoneFields) else fields.gap_slope).zones
    per_zone = max(1, solution.plan.counts["own_modes"] // len(zones))
    theta = (np.arange(per_zone) + 0.5) * np.pi / per_zone
    x = (zones.middle[:, None] + zones.half[:, None] * np.cos(theta)).ravel()
    places = fields.problem.units.x(x)
    period = fields.problem.period
    assert period is not None
    weights = np.repeat(zones.half / per_zone, per_zone)
    targets = x + 0.01 * weights
    block = max(1, 4_000_000 // len(x))

    def apply() -> None:
        profile.slope(places)
        for s in range(0, len(x), block):
            distance = targets[s : s + block, None] - x
            (1.0 / np.tan(np.pi / period * distance)) @ weights

    return clock.short_seconds(apply) if len(x) < 2000 else clock.seconds(apply, 0.2)


def equal_waves(zones: int) -> Scene:
    """A scene of `zones` equal waves in a period; a fifth of the period is in contact.

    The mean pressure is p* sin^2(pi/10). Here p* = pi E* n A/L is the mean pressure of full contact
    for n waves of amplitude A in the period L.
    """
    amplitude = 1e-3 / zones
    profile = Fourier(1.0, [0.0] * (zones - 1) + [-amplitude])
    return Scene(
        profile,
        1.0,
        Periodic(),
        mean_pressure=float(np.pi * zones * amplitude * np.sin(np.pi / 10) ** 2),
    )


def rippled(order: int) -> Scene:
    """A scene of one zone: a long wave with a short ripple that is too weak to open the zone."""
    cosine = np.zeros(order)
    cosine[0], cosine[-1] = -1e-3, -1e-5 / order
    return Scene(
        Fourier(1.0, cosine),
        1.0,
        Periodic(),
        mean_pressure=np.pi * 1e-3 * np.sin(0.4 * np.pi / 2) ** 2,
    )


def rough_scene(harmonics: int) -> Scene:
    """A scene of a self-affine profile at the mean pressure 0.002 E*."""
    return Scene(rough_profile(harmonics), 1.0, Periodic(), mean_pressure=0.002)


def _designed(zones: int) -> Scene:
    """A scene with a given number of zones, whose profile is computed from the zones.
    No zone is more than 3 times as wide as another.

    With larger ratios of widths, zones may be nearly unloaded.
    """
    return designed(zones, seed=2, spread=3.0).scene


def series(quick: bool) -> list[tuple[str, list[int], Callable[[int], Scene], float]]:
    """Return (name, sizes, function from a size to its scene, tolerance) of every series."""
    return [
        (
            "zones, inverse design",
            [2, 4, 8, 16] if quick else [2, 4, 8, 16, 32, 64],
            _designed,
            1e-8,
        ),
        (
            "zones, equal",
            [3, 9, 27] if quick else [3, 9, 27, 81, 243, 729, 2187],
            equal_waves,
            1e-8,
        ),
        ("nodes of one zone", [8, 32, 128] if quick else [8, 32, 128, 512, 2048], rippled, 1e-10),
        (
            "harmonics, rough",
            [16, 32, 64] if quick else [16, 64, 256, 512, 1024, 2048, 4096, 8192],
            rough_scene,
            1e-8,
        ),
    ]


def measure(quick: bool) -> Iterator[Scaled]:
    """Measure time and memory of `solve` for every size of every series of scenes."""
    for name, sizes, scene_of, tol in series(quick):
        for size in sizes:
            yield one(name, size, scene_of(size), tol, 0.2 if quick else 0.5)


def one(name: str, size: int, scene: Scene, tol: float, patience: float) -> Scaled:
    """Measure one scene; `patience` is the time [s] spent on repeated runs."""
    try:
        solution = solve(scene, tol)
    except NotConverged:
        # If the tolerance is not reached, ten times this tolerance is tried. The row states the
        # tolerance that was used.
        if tol > 1e-3:
            raise
        return one(name, size, scene, 10 * tol, patience)
    counts = solution.plan.counts
    return Scaled(
        name,
        size,
        tol,
        clock.seconds(lambda: solve(scene, tol), patience, 200),
        clock.peak_bytes(lambda: solve(scene, tol)),
        floor_seconds(solution),
        len(solution.zones),
        counts["own_modes"],
        counts.get("coupled_unknowns", 0),
        solution.plan["fast sums"].used,
    )


def fitted(rows: list[Scaled]) -> list[Scaled]:
    """Return the rows from which the exponent of a power law is fitted.
    The rows belong to the larger half of the sizes; there are at least three. If at least three
    rows have the same kind of sums (fast or by a matrix) as the largest size, all other rows are
    left out first.
    """
    same = [row for row in rows if row.fast == rows[-1].fast]
    same = same if len(same) >= 3 else rows
    return same[-max(3, (len(same) + 1) // 2) :]


def exponent(sizes: Array, values: Array) -> float:
    """Exponent e of the power law values ~ sizes^e, by a linear fit of the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])
