"""Two published boundary-element codes on the same scenes: tamaas and ContactMechanics, an optional
extra.

Both put pressures on an even periodic grid and minimise by the conjugate gradients of Polonsky and
Keer. Each is shown at its best: its own tolerance is the loosest that leaves its discretization
error as it is, iteration limits are raised, convergence is asked for, and only the solver is timed,
not the making of surfaces, kernels and transforms.
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

_ITERATIONS = 20000
# tamaas does not stop at 1e-12 on large grids.
_TIGHTEST = 1e-10
_TOLERANCES = (1e-4, 1e-6, 1e-8)
# A looser tolerance is as good if it leaves the error within this factor.
_AS_GOOD = 1.1

Solver = Callable[[Array, Case, float], tuple[Callable[[], None], Callable[[], Array | None]]]


@dataclass(frozen=True)
class Peer:
    """A code: `prepare(heights, case, tolerance)` gives (run, read): read is the pressures, None if
    not converged.
    """

    name: str
    prepare: Solver


def tamaas(
    heights: Array, case: Case, tolerance: float
) -> tuple[Callable[[], None], Callable[[], Array | None]]:
    tm = require("tamaas")
    tm.set_log_level(tm.LogLevel.error)
    model = tm.ModelFactory.createModel(
        tm.model_type.basic_1d, [case.profile.period], [len(heights)]
    )
    model.E, model.nu = case.E_star, 0.0
    solver = tm.PolonskyKeerRey(model, heights, tolerance)
    solver.max_iter = _ITERATIONS
    solver.dump_freq = _ITERATIONS
    left = [np.inf]

    def run() -> None:
        model.traction[...] = case.mean_pressure
        left[0] = solver.solve(case.mean_pressure)

    return run, lambda: np.array(model.traction).ravel() if left[0] <= tolerance else None


def contact_mechanics(
    heights: Array, case: Case, tolerance: float
) -> tuple[Callable[[], None], Callable[[], Array | None]]:
    cm, topography = require("ContactMechanics"), require("SurfaceTopography")
    n, length = len(heights), case.profile.period
    assert length is not None
    surface = topography.UniformLineScan(heights, length, periodic=True)
    substrate = cm.PeriodicFFTElasticHalfSpace((n,), case.E_star, (length,))
    system = cm.Systems.NonSmoothContactSystem(substrate, surface)
    results: list[Any] = []

    def run() -> None:
        # The default penetration tolerance under-converges: it is taken from the height of the
        # surface here.
        results[:] = [
            system.minimize_proxy(
                external_force=case.mean_pressure * length,
                pentol=tolerance * float(np.ptp(heights)),
                forcetol=1e-5 * case.mean_pressure * length / n,
                thermotol=tolerance,
                maxiter=_ITERATIONS,
            )
        ]

    def read() -> Array | None:
        result = results[0]
        return np.asarray(result.jac).ravel() * n / length if result.success else None

    return run, read


PEERS = (Peer("tamaas", tamaas), Peer("ContactMechanics", contact_mechanics))


def grids(quick: bool) -> list[int]:
    """Even grids with small prime factors; the end of a zone falls at a new place between the
    points of each.
    """
    return [
        m * 2**k for k in range(5, 11 if quick else 15) for m in ((4, 6) if quick else (4, 5, 6, 7))
    ]


def rows(peer: Peer, case: Case, quick: bool, longest: float) -> Iterator[Row]:
    """The peer on ever finer grids, until a run takes longer than `longest` seconds."""
    profile = case.profile
    assert profile.period is not None
    for n in grids(quick):
        x = profile.x0 + profile.period * np.arange(n) / n
        heights = -np.asarray(profile.height(x))
        heights = heights - heights.max()
        tight = _measured(peer, case, x, heights, _TIGHTEST, 0.0)
        if tight is None:
            continue
        row = tight
        # From loose to tight, the first that is as good.
        for tolerance in _TOLERANCES:
            loose = _measured(peer, case, x, heights, tolerance, 0.05)
            if (
                loose is not None
                and loose.at_x <= _AS_GOOD * tight.at_x
                and loose.mean_at_x <= _AS_GOOD * tight.mean_at_x
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


def time_to(rows_of_one: list[Row], error: float, measure: str = "at_x") -> float | None:
    """Least time to an error for good: all finer runs of the method keep it (rows from coarse to
    fine); None if none does.
    """
    reached = None
    for row in reversed(rows_of_one):
        if getattr(row, measure) > error:
            break
        reached = row.seconds if reached is None else min(reached, row.seconds)
    return reached


def require_both() -> None:
    """MissingExtra, naming the extra, unless both codes are there."""
    require("tamaas")
    require("ContactMechanics")
