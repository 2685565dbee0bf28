"""Time of load curves: many loads of one scene, each with stated error and certificate."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from contact.model.interactions import Isolated, Periodic
from contact.model.profiles import Biquadratic, Sinusoid
from contact.model.scene import Scene
from contact.model.units import quantity
from contact.studies.bench import clock
from contact.studies.bench.cases import rough_profile
from contact.studies.bench.report import Table
from contact.sweeps.solve_many import solve_many

Array = NDArray[np.float64]


def _waves(count: int) -> tuple[Scene, Array]:
    full = np.pi * 1e9 * 1e-6
    scene = Scene(Sinusoid(1e-6, 1e-4), 1e9, Periodic(), load=1.0)
    return scene, np.linspace(0.005, 0.975, count) * full


def _pair(count: int) -> tuple[Scene, Array]:
    return Scene(Biquadratic(1.0, 0.1), 1e9, Isolated(), load=1.0), np.geomspace(1e4, 5e6, count)


def _rough(count: int) -> tuple[Scene, Array]:
    return Scene(rough_profile(64), 1.0, Periodic(), load=1.0), np.geomspace(2e-4, 4e-3, count)


CURVES: dict[str, tuple[Callable[[int], tuple[Scene, Array]], int, int]] = {
    "a wave, up to 0.975 of its full load": (_waves, 200, 50),
    "two tips, through their merger": (_pair, 200, 50),
    "rough, 64 harmonics": (_rough, 50, 10),
}


def table(quick: bool) -> Table:
    """Table with a row for each load curve: processor time, numbers of zones, stated errors."""
    rows: list[tuple[str, ...]] = []
    for name, (make, many, few) in CURVES.items():
        scene, loads = make(few if quick else many)
        found = solve_many(scene, loads)
        taken = clock.seconds(partial(solve_many, scene, loads), 0.2 if quick else 0.6)
        zones = [len(solution.zones) for solution in found]
        certified = sum(solution.certificate.holds for solution in found)
        rows.append(
            (
                name,
                str(len(loads)),
                quantity(taken, "s", 3),
                f"{min(zones)} to {max(zones)}",
                f"{max(s.error for s in found):.1e}",
                f"{certified} of {len(found)}",
            )
        )
    return Table(
        "curves",
        "curves of many loads",
        ("curve", "loads", "time", "zones", "largest stated error", "certified"),
        rows,
    )
