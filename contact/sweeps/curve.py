"""A curve: one scene at many values of one control, each solution from the last ones."""

from contact.closed.solve import all_directly
from contact.model.scene import Scene
from contact.runtime import one_blas_thread
from contact.search.context import SceneCache
from contact.search.topology.extrapolation import CurvePoint
from contact.search.topology.loop import Progress
from contact.solution.solution import Solution
from contact.solver import solved_along
from sie import Array

# Zones are carried on from so many solutions.
_MOST = 2


class Curve:
    """Solves one scene at one value after another of a control, with what these have in common
    found once.

    A list of the last solutions is kept, from which the next one starts.
    """

    def __init__(
        self, scene: Scene, control: str, tol: float, progress: Progress | None = None
    ) -> None:
        self.scene, self.control, self.tol, self.progress = scene, control, tol, progress
        self.cache = SceneCache(scene)
        self.last: tuple[CurvePoint, ...] = ()
        self.known: dict[float, Solution] = {}

    def look_at(self, values: Array) -> None:
        """Solve those of the values at once that need no coupled system."""
        scenes = [self._scene(float(value)) for value in values]
        found = all_directly(scenes, self.tol)
        self.known = {
            float(value): solution
            for value, solution in zip(values, found, strict=True)
            if solution is not None
        }

    def at(self, value: float) -> Solution:
        """The next solution, from the last ones."""
        solution = self.known.get(value) or self.beside(value, self.last)
        self.last = (*self.last, CurvePoint(solution))[-_MOST:]
        return solution

    def beside(self, value: float, known: tuple[CurvePoint, ...], least: float = 0.0) -> Solution:
        """The solution at a value from known ones, the nearest last; to a tolerance of no less than
        that.
        """
        with one_blas_thread():
            return solved_along(
                self._scene(value), max(self.tol, least), self.progress, self.cache, known
            )

    def _scene(self, value: float) -> Scene:
        return self.scene.under(self.control, value)
