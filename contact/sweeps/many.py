"""`contact.solve_many`: a curve of solutions, in this process or in several."""

from collections.abc import Iterator
from contextlib import closing
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import ContactError, SceneError, unwarned, warn
from contact.model.checks import finite_array, integer, one_of
from contact.model.controls import known_controls
from contact.model.scene import Scene
from contact.search.topology.loop import Progress
from contact.solution.model_warnings import curve_warnings
from contact.solution.solution import Solution
from contact.solver import tolerance
from contact.sweeps.curve import Curve
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
    """Solve a scene at many values of one control, each from the zones of its neighbours.

    The answers are those of `contact.solve`, each with its own stated error and certificate; what
    the solves have in common is found once. Where the number of zones changes, and at which load,
    is told by `contact.path`.

    Parameters
    ----------
    scene : Scene
        What is pressed, under any control.
    values : array_like
        Of the control, in its unit, (n,), in any order.
    control : str or None
        Whose values they are: a name of `contact.controls()`; None: that of the scene.
    tol : float
        Largest stated error of each solution.
    progress : callable or None
        Called with (stage, done, total or None).
    workers : int or None
        Processes of this machine that solve what takes a search, which pay where that takes many
        seconds; 1: none but this one; None: as many as there are processors. A script that asks for
        more than one has its calls under `if __name__ == "__main__":`.

    Returns
    -------
    list of Solution
        One for each value, in the order of the values.

    Raises
    ------
    SceneError, OutOfRange, NotConverged
        As `contact.solve`.

    Warns
    -----
    RuntimeWarning
        Where other processes cannot be started or sent the scene; this one solves.

    Examples
    --------
    >>> import contact
    >>> wave = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), contact_fraction=0.5)
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
    curve.look_at(given)
    found: dict[int, Solution] = {}
    with unwarned():
        if several:
            for place, solution in _in_processes(curve, given, workers):
                found[place] = solution
                if progress is not None:
                    progress(name, len(found), len(given))
        # What is left, if anything is.
        for place in np.argsort(given, kind="stable"):
            if int(place) not in found:
                if progress is not None:
                    progress(name, len(found), len(given))
                found[int(place)] = curve.at(float(given[place]))
    # Of the highest load, where slopes and pressures are.
    warn(curve_warnings(found.values()))
    return [found[k] for k in range(len(given))]


def _in_processes(
    curve: Curve, values: Array, workers: int | None
) -> Iterator[tuple[int, Solution]]:
    """Solutions by place, in any order, of the values that are not known at once."""
    left = [
        int(place)
        for place in np.argsort(values, kind="stable")
        if float(values[place]) not in curve.known
    ]
    solvers = min(workers or processors(), len(left) // 2)
    if solvers > 1:
        # Each goes all along the curve: none searches from nothing on the way, and all take about
        # as long.
        chunks = [
            Chunk.of_curve(curve.control, left[first::solvers], values) for first in range(solvers)
        ]
        with closing(solved_in_processes(curve.scene, chunks, curve.tol, solvers)) as coming:
            for place, row in chain.from_iterable(coming):
                if "raised" in row:
                    raise row["raised"]
                if "solution" not in row:
                    raise ContactError(f"{curve.control} = {values[place]:g}: {row['reason']}")
                yield place, row["solution"]
