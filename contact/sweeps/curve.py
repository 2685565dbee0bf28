"""A curve: one scene at many values of one control, each solution from the last ones."""

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError, unwarned, warn
from contact.model.checks import finite_array
from contact.model.registry import CONTROLS
from contact.model.scene import Scene
from contact.search.shared import Shared
from contact.search.topology.carried import Passed
from contact.search.topology.loop import Progress
from contact.search.ways.direct import all_directly
from contact.solution.solution import Solution
from contact.solution.validity import of_solution
from contact.solver import solved_along, tolerance
from sie import Array

# Zones are carried on from so many solutions.
_MOST = 2


class Curve:
    """Solves one scene at one value after another of a control, with what these have in common found once.

    A list of the last solutions is kept, from which the next one starts.
    """

    def __init__(self, scene: Scene, control: str, tol: float, progress: Progress | None = None) -> None:
        self.scene, self.control, self.tol, self.progress = scene, control, tol, progress
        self.shared = Shared(scene)
        self.last: tuple[Passed, ...] = ()
        self.known: dict[float, Solution] = {}

    def look_at(self, values: Array) -> None:
        """Solve those of the values at once that need no coupled system."""
        scenes = [self._scene(float(value)) for value in values]
        found = all_directly(scenes, self.tol)
        self.known = {float(value): solution for value, solution in zip(values, found, strict=True) if solution is not None}

    def at(self, value: float) -> Solution:
        """The next solution, from the last ones."""
        solution = self.known.get(value) or self.beside(value, self.last)
        self.last = (*self.last, Passed(solution))[-_MOST:]
        return solution

    def beside(self, value: float, known: tuple[Passed, ...], least: float = 0.0) -> Solution:
        """The solution at a value from known ones, the nearest last; to a tolerance of no less than that."""
        return solved_along(self._scene(value), max(self.tol, least), self.progress, self.shared, known)

    def _scene(self, value: float) -> Scene:
        return self.scene.under(self.control, value)


def solve_many(
    scene: Scene, values: ArrayLike, control: str | None = None, tol: float = 1e-8, progress: Progress | None = None
) -> list[Solution]:
    """Solve a scene at many values of one control, each from the zones of its neighbours.

    The answers are those of `contact.solve`, each with its own stated error and certificate; what the solves have in common is found
    once. Where the number of zones changes, and at which load, is told by `contact.path`.

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

    Returns
    -------
    list of Solution
        One for each value, in the order of the values.

    Raises
    ------
    SceneError, OutOfRange, NotConverged
        As `contact.solve`.

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
    CONTROLS.find(name, "control")
    given = finite_array("values", values)
    curve = Curve(scene, name, tolerance(tol), progress)
    found: dict[int, Solution] = {}
    curve.look_at(given)
    with unwarned():
        for done, k in enumerate(np.argsort(given, kind="stable")):
            if progress is not None:
                progress(name, done, len(given))
            found[int(k)] = curve.at(float(given[k]))
    # Of the highest load, where slopes and pressures are.
    warn(of_solution(max(found.values(), key=lambda solution: solution.load)))
    return [found[k] for k in range(len(given))]
