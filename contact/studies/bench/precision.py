"""Work and precision: errors against processor time, for tolerances 1e-2 to 1e-13.

The localized models run on the same scenes. They are solved accurately, so that their error is the
error of the model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from contact.errors import NotConverged, OutOfRange
from contact.model.interactions import Localized
from contact.model.interactions.base import Interaction
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.solver import solve
from contact.studies.bench import clock, truth
from contact.studies.bench.cases import Case


@dataclass(frozen=True)
class Row:
    """One run of one method on one scene, with the time that it took and its errors.

    `error` is the true error, measured as the stated error is: the larger of the errors of
    pressures at equal normalised positions and of ends relative to widths. `at_x` and `mean_at_x`
    are the largest and mean error of the pressure at equal x. Pressures are relative to the peak.
    `error` and `stated` are None for a method that has no zones or states no error.
    """

    scene: str
    method: str
    setting: float
    seconds: float
    at_x: float
    mean_at_x: float
    error: float | None
    stated: float | None
    unknowns: int
    met: bool


def tolerances(quick: bool) -> list[float]:
    """The tolerances of the solver's runs, descending from 1e-2 to 1e-13."""
    return [10.0**-k for k in ((2, 4, 6, 8, 10, 12, 13) if quick else range(2, 14))]


def ours(case: Case, quick: bool) -> Iterator[Row]:
    """Run the solver at each tolerance; stop at the first tolerance that is not reached."""
    scene = case.scene
    for tol in tolerances(quick):
        row, found = _run(case, "contact", tol, scene, tol, quick)
        yield row
        if not found:
            break


def hierarchy(case: Case, quick: bool) -> Iterator[Row]:
    """Run the localized models of a case, each to a tolerance of 1e-8.

    They are self-consistent models with 0 to 16 neighbours a side, and the first-order model.
    """
    models: list[tuple[str, float, Interaction]] = [
        (f"localized, m={m}", m, Localized("self-consistent", neighbours=m))
        for m in (0, 1, 2, 4, 8, 16)
    ]
    models.append(("localized, first order", 0.0, Localized("first-order")))
    for name, setting, model in models:
        scene = Scene(case.profile, case.E_star, model, mean_pressure=case.mean_pressure)
        try:
            yield _run(case, name, setting, scene, 1e-8, quick)[0]
        except (OutOfRange, NotConverged):  # the closure has no solution at this load
            continue


def _run(
    case: Case, method: str, setting: float, scene: Scene, tol: float, quick: bool
) -> tuple[Row, bool]:
    call: Callable[[], Solution] = lambda: solve(scene, tol)  # noqa: E731
    met = True
    try:
        solution = call()
        seconds = clock.seconds(call, 0.1)
    except NotConverged as error:
        if error.best is None:
            raise
        solution, met = error.best, False
        seconds = clock.seconds(lambda: _refused(scene, tol), 0.0)
    x = truth.comb(case.exact)
    largest, mean = truth.at_places(x, solution.pressure(x), case.exact)
    row = Row(
        case.name,
        method,
        setting,
        seconds,
        largest,
        mean,
        truth.stated_measure(solution, case.exact),
        solution.error,
        solution.plan.counts.get("own_modes", 0),
        met,
    )
    return row, met


def _refused(scene: Scene, tol: float) -> None:
    try:
        solve(scene, tol)
    except NotConverged:
        pass
