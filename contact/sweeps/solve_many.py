"""`contact.solve_many`: one scene at many values of a control, in one or several processes."""

from collections.abc import Iterator
from contextlib import closing
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import ContactError, NotConverged, SceneError, unwarned, warn
from contact.model.checks import finite_array, integer, one_of
from contact.model.controls import known_controls
from contact.model.scene import Scene
from contact.search.topology.loop import Progress
from contact.solution.model_warnings import curve_warnings
from contact.solution.solution import Solution
from contact.solver import tolerance
from contact.sweeps.curve import Curve, FailureCollector
from contact.sweeps.sweep.chunks import Chunk
from contact.sweeps.sweep.processes import processors, solved_in_processes
from sie import Array


def solve_many(
    scene: Scene,
    values: ArrayLike,
    control: str | None = None,
    tol: float = 1e-8,
    progress: Progress | None = None,
    *,
    workers: int | None = 1,
) -> list[Solution]:
    """Solve a scene at many values of a control; each solution starts from an earlier one.

    Each answer is that of `contact.solve`, with its own stated error and certificate. Work that the
    solves share is done once. For the loads at which the number of zones changes, use
    `contact.path`.

    Parameters
    ----------
    scene : Scene
        The scene. The value of its own control is not used.
    values : array_like
        Values of the control in its unit, shape (n,), in any order.
    control : str or None
        A name from `contact.controls()`; None: the scene's own control.
    tol : float
        Largest stated error of each solution.
    progress : callable or None
        Called with (stage, done, total or None).
    workers : int or None
        Number of processes; 1: this process only; None: one process per processor. Several
        processes save time if the solves take many seconds. A script that asks for more than one
        process must call this function under `if __name__ == "__main__":`.

    Returns
    -------
    list of Solution
        One for each value, in the order of the values.

    Raises
    ------
    SceneError, OutOfRange, NotConverged
        As `contact.solve`. If some values miss the tolerance, NotConverged names them after all
        values were tried. Its `best` is the list of solutions, with the best state (or None) at
        each of these values; its `trace` has each of them with its own error.

    Warns
    -----
    RuntimeWarning
        If other processes cannot be started or cannot receive the scene. This process then solves
        all values.

    Examples
    --------
    >>> import contact
    >>> profile = contact.Sinusoid(amplitude=1e-6, period=1e-4)
    >>> wave = contact.Scene(profile, 1e9, contact.Periodic(), contact_fraction=0.5)
    >>> [round(s.contact_fraction, 6) for s in contact.solve_many(wave, [0.6, 0.2, 0.4])]
    [0.6, 0.2, 0.4]
    >>> [s.certificate.holds for s in contact.solve_many(wave, [1e2, 1e3], "load")]
    [True, True]
    """
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    name = scene.control[0] if control is None else control
    one_of("control", name, known_controls(scene.given))
    given = finite_array("values", values)
    several = workers is None or integer("workers", workers, 1) > 1
    curve = Curve(scene, name, tolerance(tol), progress)
    curve.solve_in_closed_form(given)
    found: dict[int, Solution] = {}
    best: dict[int, Any] = {}
    failures = FailureCollector(name)
    with unwarned():
        if several:
            for place, row in _in_processes(curve, given, workers):
                if isinstance(row, NotConverged):
                    failures.add(given[place], row)
                    best[place] = row.best
                else:
                    found[place] = row
                if progress is not None:
                    progress(name, len(found) + len(best), len(given))
        # Other processes have tried the values in `found` and `best`. This process solves the rest,
        # in ascending order.
        for place in np.argsort(given, kind="stable"):
            if int(place) not in found and int(place) not in best:
                if progress is not None:
                    progress(name, len(found) + len(best), len(given))
                try:
                    found[int(place)] = curve.at(float(given[place]))
                except NotConverged as failure:
                    failures.add(given[place], failure)
                    best[int(place)] = failure.best
    # Warnings are given once for the whole curve. They are those at the highest load, where slopes
    # and pressures are largest, and those about unmeasured intervals.
    failures.refuse(len(found), [(found | best)[k] for k in range(len(given))])
    warn(curve_warnings(found.values()))
    return [found[k] for k in range(len(given))]


def _in_processes(
    curve: Curve, values: Array, workers: int | None
) -> Iterator[tuple[int, Solution | NotConverged]]:
    """Yield the index and the solution of each value that is not in `curve.known`, in any order.
    A value that misses the tolerance has its error instead.
    """
    left = [
        int(place)
        for place in np.argsort(values, kind="stable")
        if float(values[place]) not in curve.known
    ]
    solvers = min(workers or processors(), len(left) // 2)
    if solvers > 1:
        # Each of n processes solves every n-th value, in ascending order, so that all processes
        # take about the same time. A process starts each solution from its previous one.
        chunks = [
            Chunk.of_curve(curve.control, left[first::solvers], values) for first in range(solvers)
        ]
        with closing(solved_in_processes(curve.scene, chunks, curve.tol, solvers)) as coming:
            for place, row in chain.from_iterable(coming):
                if "raised" in row:
                    if not isinstance(row["raised"], NotConverged):
                        raise row["raised"]
                    yield place, row["raised"]
                    continue
                if "solution" not in row:
                    raise ContactError(f"{curve.control} = {values[place]:g}: {row['reason']}")
                yield place, row["solution"]
