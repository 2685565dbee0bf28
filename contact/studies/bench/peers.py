"""Two published boundary-element codes on the same scenes: tamaas and ContactMechanics.

Both compute pressures on an even periodic grid and minimise the energy by the conjugate gradients
of Polonsky and Keer. The comparison favours them: each runs at the loosest tolerance that does not
increase its discretization error, iteration limits are raised, and only the solver is timed, not
the setup of surfaces, kernels and transforms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.extras import require
from contact.studies.bench import clock, truth
from contact.studies.bench.cases import Case
from contact.studies.bench.precision import Row

Array = NDArray[np.float64]


Solver = Callable[[Array, Case, float], tuple[Callable[[], None], Callable[[], Array | None]]]


@dataclass(frozen=True)
class Peer:
    """Another contact code, given by its name and a function that prepares a run.

    `prepare(heights, case, tolerance)` returns two functions (run, read). After `run()`, `read()`
    returns the pressures, or None if the run did not converge.
    """

    name: str
    prepare: Solver


def tamaas(
    heights: Array, case: Case, tolerance: float, max_iterations: int = 20_000
) -> tuple[Callable[[], None], Callable[[], Array | None]]:
    """Prepare a run of Polonsky and Keer's solver in tamaas; `Peer` explains the arguments."""
    tm = require("tamaas")
    tm.set_log_level(tm.LogLevel.error)
    model = tm.ModelFactory.createModel(
        tm.model_type.basic_1d, [case.profile.period], [len(heights)]
    )
    model.E, model.nu = case.E_star, 0.0
    solver = tm.PolonskyKeerRey(model, heights, tolerance)
    solver.max_iter = max_iterations
    solver.dump_freq = max_iterations
    residual = [np.inf]

    def run() -> None:
        model.traction[...] = case.mean_pressure
        residual[0] = solver.solve(case.mean_pressure)

    return run, lambda: np.array(model.traction).ravel() if residual[0] <= tolerance else None


def contact_mechanics(
    heights: Array, case: Case, tolerance: float, max_iterations: int = 20_000
) -> tuple[Callable[[], None], Callable[[], Array | None]]:
    """Prepare a run of ContactMechanics' NonSmoothContactSystem; `Peer` explains the arguments."""
    cm, topography = require("ContactMechanics"), require("SurfaceTopography")
    n, length = len(heights), case.profile.period
    assert length is not None
    surface = topography.UniformLineScan(heights, length, periodic=True)
    substrate = cm.PeriodicFFTElasticHalfSpace((n,), case.E_star, (length,))
    system = cm.Systems.NonSmoothContactSystem(substrate, surface)
    results: list[Any] = []

    def run() -> None:
        # The default penetration tolerance is too loose. The tolerance used here is relative to the
        # range of the heights.
        results[:] = [
            system.minimize_proxy(
                external_force=case.mean_pressure * length,
                pentol=tolerance * float(np.ptp(heights)),
                forcetol=1e-5 * case.mean_pressure * length / n,
                thermotol=tolerance,
                maxiter=max_iterations,
            )
        ]

    def read() -> Array | None:
        result = results[0]
        return np.asarray(result.jac).ravel() * n / length if result.success else None

    return run, read


PEERS = (Peer("tamaas", tamaas), Peer("ContactMechanics", contact_mechanics))


def grids(quick: bool) -> list[int]:
    """Return numbers of grid points that have only small prime factors, for fast transforms.

    The numbers are not all multiples of each other, so that zone ends fall anywhere in the cells.
    """
    return [
        m * 2**k for k in range(5, 11 if quick else 15) for m in ((4, 6) if quick else (4, 5, 6, 7))
    ]


def rows(
    peer: Peer,
    case: Case,
    quick: bool,
    longest: float,
    tolerances: tuple[float, ...] = (1e-4, 1e-6, 1e-8, 1e-10),
) -> Iterator[Row]:
    """Run another code (peer) on ever finer grids, until a run takes longer than `longest` s.

    The run at the last tolerance gives the error of the grid. (At 1e-12 tamaas does not stop on
    large grids.) A looser tolerance is used if the error then grows by at most a tenth.
    """
    profile = case.profile
    assert profile.period is not None
    for n in grids(quick):
        x = profile.x0 + profile.period * np.arange(n) / n
        heights = -np.asarray(profile.height(x))
        heights = heights - heights.max()
        tight = _measured(peer, case, x, heights, tolerances[-1], 0.0)
        if tight is None:
            continue
        row = tight
        # The other code (peer) runs with the loosest tolerance that increases its error by at most
        # a tenth. This favours the other code in the comparison of times.
        for tolerance in tolerances[:-1]:
            loose = _measured(peer, case, x, heights, tolerance, 0.05)
            if (
                loose is not None
                and loose.at_x <= 1.1 * tight.at_x
                and loose.mean_at_x <= 1.1 * tight.mean_at_x
            ):
                row = loose if loose.seconds < tight.seconds else tight
                break
        yield row
        if tight.seconds > longest:
            return


def _measured(
    peer: Peer, case: Case, x: Array, heights: Array, tolerance: float, patience: float
) -> Row | None:
    run, read = peer.prepare(heights, case, tolerance)
    seconds = clock.seconds(run, patience, most=8)
    pressure = read()
    if pressure is None:
        return None
    largest, mean = truth.at_places(x, pressure, case.exact)
    return Row(case.name, peer.name, len(x), seconds, largest, mean, None, None, len(x), True)


def time_to(rows: list[Row], error: float, measure: str = "at_x") -> float | None:
    """Least time of the runs that reach an error; None if the run on the finest grid does not.
    The rows go from coarse to fine grids. A run counts only if all runs on finer grids reach the
    error as well.
    """
    reached = None
    for row in reversed(rows):
        if getattr(row, measure) > error:
            break
        reached = row.seconds if reached is None else min(reached, row.seconds)
    return reached


def require_both() -> None:
    """Raise MissingExtra, with the extra's name, unless both other contact codes are installed."""
    require("tamaas")
    require("ContactMechanics")
