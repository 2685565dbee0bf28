"""Solve a scene.

The steps of a solution and the modules that do them are, in this order:

    scene          what is given, checked when it is made            contact.model
    formulation    a scaled equation by the pressure or the gaps     contact.formulation
    first guess    strategies in order; the plan keeps failures      contact.search.find
    zones          Newton on their ends, signs, corrections          contact.search.topology
    certificate    checks on the whole line, and the stated error    contact.verify
    solution       in SI units, with its plan                        contact.solution
"""

import time
from contextlib import nullcontext
from dataclasses import dataclass, replace
from numbers import Real

from contact.closed.solve import solve_closed
from contact.errors import NotConverged, OutOfRange, SceneError, warn
from contact.extras import require
from contact.formulation import claims
from contact.model.checks import one_of
from contact.model.scene import Scene
from contact.runtime import keep_freed_memory, one_blas_thread
from contact.search.context import SceneCache, SolveContext
from contact.search.find import found
from contact.search.options import SEARCH
from contact.search.refine import refined
from contact.search.strategies.full_contact import Full
from contact.search.strategies.gaps import record_unknowns
from contact.search.strategies.guesses import Outcome
from contact.search.strategies.load_search import by_quantity
from contact.search.topology.extrapolation import CurvePoint
from contact.search.topology.loop import Progress
from contact.solution import assemble, model_warnings
from contact.solution.solution import Solution
from contact.verify.error import SolvedGaps


@dataclass(frozen=True)
class SolverOptions:
    """Sizes of a scene (as `_features` measures them) above which process settings are changed.

    A size is the number of shortest lengths of the profile in its period.
    """

    # Above this size, BLAS runs on one thread, because several threads would wait for each other.
    one_blas_thread: int = 2**6
    # Above this size (see `_features`), the process keeps freed memory. Otherwise the system would
    # clear the pages of this memory again and again.
    keep_memory: int = 2**17


_OPTIONS = SolverOptions()


def solve(
    scene: Scene,
    tol: float = 1e-8,
    progress: Progress | None = None,
    near: Solution | None = None,
    branch: str = "advancing",
) -> Solution:
    """Solve a scene for its zones, pressure and gap, with a stated error of at most `tol`.

    Parameters
    ----------
    scene : Scene
        The scene.
    tol : float
        Largest stated error (`Solution.error`), relative, 1e-13 <= tol < 1.
    progress : callable or None
        Called with (stage, done, total or None).
    near : Solution or None
        A solution of the same profile and model with similar zones. It saves the search and never
        changes the answer.
    branch : str
        Chooses the equilibrium under laws that have several. "advancing" is reached from first
        touch by raising the control to its value (for tension: by raising it to zero load, then
        lowering it). "receding" is reached by lowering the control from the largest contact.

    Returns
    -------
    Solution

    Raises
    ------
    SceneError
        If the input is bad.
    OutOfRange
        If no contact has the given value of the control.
    NotConverged
        If the tolerance was not met; the error contains the best solution that was found.

    Warns
    -----
    ModelWarning
        If the model hardly holds; also in the `warnings` of the solution.

    Examples
    --------
    Half of a wave in contact carries half the load of full contact (H. M. Westergaard, J. Appl.
    Mech. 6, 1939, A49, doi 10.1115/1.4008919).

    >>> import contact
    >>> import numpy as np
    >>> wave = contact.Sinusoid(amplitude=1e-6, period=1e-4)
    >>> scene = contact.Scene(wave, 1e9, contact.Periodic(), contact_fraction=0.5)
    >>> solution = contact.solve(scene, tol=1e-10)
    >>> bool(np.isclose(solution.mean_pressure, 0.5 * np.pi * 1e9 * 1e-2, rtol=1e-10))
    True
    >>> solution.error <= 1e-10, solution.certificate.holds
    (True, True)
    """
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    tol = tolerance(tol)
    one_of("branch", branch, ("advancing", "receding"))
    if near is not None and not isinstance(near, Solution):
        raise SceneError.of("near", near, "None, or a contact.Solution")
    if near is not None and _of(near.scene) != _of(scene):
        raise SceneError(
            "near must be a solution of the same profile, interaction model, substrate and law",
            "near",
            near.scene,
        )
    warn(model_warnings.scene_warnings(scene))
    solution = _solved(scene, tol, progress, near, SceneCache(scene), branch)
    warn(model_warnings.solution_warnings(solution))
    return solution


def tolerance(tol: object) -> float:
    """The tolerance as a float; raises SceneError if it is not a valid tolerance."""
    if (
        isinstance(tol, bool)
        or not isinstance(tol, Real)
        or not SEARCH.least_error <= float(tol) < 1.0
    ):
        raise SceneError.of("tol", tol, "a number, at least 1e-13 and below 1")
    return float(tol)


def _of(scene: Scene) -> tuple[object, ...]:
    """The profile, interaction, substrate and law of a scene."""
    return scene.profile, scene.interaction, scene.substrate, scene.law


def solved_along(
    scene: Scene,
    tol: float,
    progress: Progress | None,
    cache: SceneCache,
    previous: tuple[CurvePoint, ...],
) -> Solution:
    """The solution of one of several scenes that differ only in the value of the control.
    It starts from the solutions of the previous scenes.

    cache: results shared with the other scenes. previous: the last solutions on the curve.
    """
    near = previous[-1].solution if previous else None
    if scene.control_object.held(scene) is None or scene.law.routes.first is not None:
        return _solved(scene, tol, progress, near, cache)
    claims.of(scene.profile)
    direct = solve_closed(scene, tol)
    if direct is not None:
        return direct
    return _run(
        SolveContext.of(
            scene, tol, _solved, cache, progress=progress, warm_start=near, previous=previous
        )
    )


def context_of(scene: Scene, tol: float) -> SolveContext:
    """The `SolveContext` of a scene whose contact is found by following a branch of equilibria.
    See `solved_at`.
    """
    return SolveContext.of(scene, tol, _solved)


def solved_at(context: SolveContext, found: Outcome, message: str) -> Solution:
    """The `Solution` of a contact `found` by following its branch of equilibria.

    message: how the contact was reached, noted in the plan. The contact is refined already.
    """

    context.plan["branch"].detail = message
    return _solution(context, found)


def _solved(
    scene: Scene,
    tol: float,
    progress: Progress | None,
    near: Solution | None,
    cache: SceneCache,
    branch: str = "advancing",
) -> Solution:
    if scene.control_object.held(scene) is None:
        return by_quantity(
            scene,
            tol,
            near,
            lambda loaded, tighter, near: _solved(loaded, tighter, progress, near, cache),
        )
    claims.of(scene.profile)
    direct = solve_closed(scene, tol)
    if direct is not None:
        return direct
    first = _of_first_law(scene, tol, progress, near)
    if first is not None:
        if first.max_pressure <= scene.law.pressure_range.highest:
            return replace(first, scene=scene)
        near = near or first
    context = SolveContext.of(
        scene, tol, _solved, cache, progress=progress, warm_start=near, branch=branch
    )
    return _run(context)


def _of_first_law(
    scene: Scene, tol: float, progress: Progress | None, near: Solution | None
) -> Solution | None:
    """The solution under the law `Routes.first`, which is tried before the scene's own law.
    It is None if there is no such law or no such solution.

    Pressures grow with the load. So the law `Routes.first` is not tried above the load of a contact
    with plateaus.
    """
    law, load = scene.law.routes.first, scene.given_load
    if law is None:
        return None
    if near is not None and load is not None and load >= near.load and len(near.plateaus):
        return None
    bare = replace(scene, law=law)
    try:
        return _solved(bare, tol, progress, None, SceneCache(bare))
    except (NotConverged, OutOfRange):
        return None


def _run(context: SolveContext) -> Solution:
    start, features = time.perf_counter(), _features(context.scene)
    try:
        with (
            keep_freed_memory(features > _OPTIONS.keep_memory),
            one_blas_thread() if features > _OPTIONS.one_blas_thread else nullcontext(),
        ):
            return _solution(context, _found(context))
    finally:
        context.plan.seconds = time.perf_counter() - start


def _found(context: SolveContext) -> Outcome:
    """Find the contact of a scene by one of three ways.
    The ways are a module of the law, the branch of equilibria of an adhesive law, and a search.

    The contact that a module returns is final, see `contact.model.laws.base.Routes`.
    """
    module = context.scene.law.routes.module
    if module is None and context.follows_branch:
        module = "contact.adhesion.branch"
    if module is not None:
        outcome: Outcome = require(module).found(context)
        return outcome
    return refined(context, found(context), found)


def _features(scene: Scene) -> float:
    """Size of a scene: the profile's period or known length, divided by its `feature` length."""
    profile = scene.profile
    known = profile.known
    return (
        0.0 if profile.feature is None or known is None else (known[1] - known[0]) / profile.feature
    )


def _solution(context: SolveContext, outcome: Outcome) -> Solution:
    scene, plan, tol = context.scene, context.plan, context.tol
    followed = context.follows_branch
    branch = context.branch if followed else None
    if isinstance(outcome, Full):
        return assemble.full_contact_solution(
            scene, context.full, outcome.mean_pressure, plan, tol, branch
        )
    record_unknowns(context, outcome)
    if isinstance(outcome, SolvedGaps):
        return assemble.gap_solution(scene, outcome, plan, tol)
    find_pull_off = (
        require("contact.adhesion.pull_off_of_solution").PullOffFinder(
            context.control(outcome.fields.problem)
        )
        if followed
        else None
    )
    return assemble.zone_solution(scene, outcome, plan, tol, branch, find_pull_off)
