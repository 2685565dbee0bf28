"""Time and memory against zones, nodes and harmonics, and against the floor.

The floor is the least that a solver of this equation by direct sums can do: the profile once at the
final nodes and the kernel applied to them once, every node acting on every other, as numpy does it.
Fast sums go below it. Exponents are fitted to the larger sizes, all solved with the same machinery.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact.errors import NotConverged
from contact.formulation.fields import ZoneFields
from contact.model.interactions import Periodic
from contact.model.profiles import Fourier
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.solver import solve
from contact.studies.bench import clock
from contact.studies.bench.cases import biquadratic, designed, parabola, rough_profile, wave, wedge

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scaled:
    """One size of one series. seconds and bytes of `solve`, floor in seconds, and what the solution
    counts.
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
    """Processor time of one evaluation of the profile at the final nodes and one application of the
    kernel to them.
    """
    fields, profile = solution.fields, solution.scene.profile
    assert isinstance(fields, ZoneFields)
    zones = fields.density.zones
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
    """n equal waves a period, in contact on a fifth of it: mean pressure p* sin^2(pi/10), p* = pi
    E* n A / L.
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
    """One zone under a wave with a ripple of a high order, weak enough not to open it: 0.1 of the
    slope at most.
    """
    cosine = np.zeros(order)
    cosine[0], cosine[-1] = -1e-3, -1e-5 / order
    return Scene(
        Fourier(1.0, cosine),
        1.0,
        Periodic(),
        mean_pressure=np.pi * 1e-3 * np.sin(0.4 * np.pi / 2) ** 2,
    )


def rough_scene(harmonics: int) -> Scene:
    return Scene(rough_profile(harmonics), 1.0, Periodic(), mean_pressure=0.002)


def _designed(zones: int) -> Scene:
    """Widths within a factor 3: among many more unlike zones there is one of next to no load, a
    matter of stability.
    """
    return designed(zones, seed=2, spread=3.0).scene


def series(quick: bool) -> list[tuple[str, list[int], Callable[[int], Scene], float]]:
    """(name, sizes, scene of a size, tolerance)."""
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
    """Every series over its sizes."""
    for name, sizes, scene_of, tol in series(quick):
        for size in sizes:
            yield one(name, size, scene_of(size), tol, 0.2 if quick else 0.5)


def yardstick(patience: float) -> float:
    """Processor time of 100 solves of a dense system of 33 unknowns, as numpy does them."""
    rng = np.random.default_rng(0)
    matrix, right = rng.normal(size=(33, 33)), rng.normal(size=33)

    def solves() -> None:
        for _ in range(100):
            np.linalg.solve(matrix, right)

    return clock.seconds(solves, patience, 200)


SINGLE = (lambda: wave(0.4), lambda: wave(0.9), wedge, parabola, biquadratic)


def floors(quick: bool) -> Iterator[Scaled]:
    """Single scenes to 1e-12 against their floor."""
    for case in (make() for make in SINGLE):
        yield one(case.name, 1, case.scene, 1e-12, 0.2 if quick else 0.6)


def one(name: str, size: int, scene: Scene, tol: float, patience: float) -> Scaled:
    try:
        solution = solve(scene, tol)
    except NotConverged:
        # What cannot be had to this tolerance is measured at the next one; the row says at which.
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
    """The rows of a series to fit an exponent to: the upper half of those with fast sums if the
    largest has them, else of all; three at least, if there are so many.
    """
    same = [row for row in rows if row.fast == rows[-1].fast]
    same = same if len(same) >= 3 else rows
    return same[-max(3, (len(same) + 1) // 2) :]


def exponent(sizes: Array, values: Array) -> float:
    """Slope of log values over log sizes."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])
