"""A curve: one scene at many values of one control, each solve warm-started from earlier ones."""

from typing import Any

from contact.closed.solve import solve_all_closed
from contact.errors import NotConverged
from contact.model.scene import Scene
from contact.model.units import counted
from contact.runtime import one_blas_thread
from contact.search.context import SceneCache
from contact.search.topology.extrapolation import CurvePoint
from contact.search.topology.loop import Progress
from contact.solution.solution import Solution
from contact.solver import solved_along
from sie import Array


class FailureCollector:
    """Collects the values of a control at which a solution misses the tolerance.
    The other values are solved before an error is raised for these values.
    """

    def __init__(self, control: str) -> None:
        self.control = control
        self.failures: list[tuple[float, NotConverged]] = []

    def add(self, value: float, failure: NotConverged) -> None:
        self.failures.append((float(value), failure))

    def refuse(self, solved: int, best: Any) -> None:
        """Raise NotConverged if any value missed the tolerance.

        solved: number of values that were solved. best: the attribute `best` of the error, with the
        solutions at the solved values.
        """
        if not self.failures:
            return
        value, failure = self.failures[0]
        if solved == 0:
            raise failure
        values = ", ".join(f"{one:.17g}" for one, _ in self.failures[1:])
        also = f"; also not converged at: {values}" if values else ""
        raise NotConverged(
            f"{self.control} = {value:.17g}: {failure} ({counted(solved, 'other value')} solved, "
            f"see the attribute `best` of this error{also})",
            self.failures,
            best,
        ) from failure


class Curve:
    """Solves one scene at one value of a control after another.

    Everything that does not depend on the value is computed once. The last solutions are kept as
    the start of the next one.
    """

    def __init__(
        self, scene: Scene, control: str, tol: float, progress: Progress | None = None
    ) -> None:
        self.scene, self.control, self.tol, self.progress = scene, control, tol, progress
        self.cache = SceneCache(scene)
        self.previous: tuple[CurvePoint, ...] = ()
        self.known: dict[float, Solution] = {}

    def solve_in_closed_form(self, values: Array) -> None:
        """Solve for all values of the control that have a closed form; keep their solutions."""
        scenes = [self._scene(float(value)) for value in values]
        found = solve_all_closed(scenes, self.tol)
        self.known = {
            float(value): solution
            for value, solution in zip(values, found, strict=True)
            if solution is not None
        }

    def at(self, value: float) -> Solution:
        """The solution at a control value, in closed form or started from previous solutions."""
        solution = self.known.get(value) or self.from_previous(value, self.previous)
        # Two solutions are kept, since the secant through them predicts the next solution.
        self.previous = (*self.previous[-1:], CurvePoint(solution))
        return solution

    def from_previous(
        self, value: float, previous: tuple[CurvePoint, ...], min_tol: float = 0.0
    ) -> Solution:
        """The solution at a control value, started from the solutions `previous`, the nearest last.

        The tolerance is that of the curve, or `min_tol` if that is larger.
        """
        with one_blas_thread():
            return solved_along(
                self._scene(value), max(self.tol, min_tol), self.progress, self.cache, previous
            )

    def _scene(self, value: float) -> Scene:
        return self.scene.under(self.control, value)
