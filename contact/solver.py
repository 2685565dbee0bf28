"""Scene -> formulation -> first guess -> zones -> certificate -> solution.

scene          what is given, checked when it is made
contact.model formulation    a scaled equation, by the pressure, by the gaps, or none in full
contact   contact.formulation first guess    ways to the zones, in order; what was left and why is
in the plan        contact.search.find zones          Newton on their ends, signs, corrections, and
again                      contact.search.topology certificate    what was looked at on the whole
line, and the stated error               contact.verify solution       in SI units, with its plan
contact.solution
"""

import time
from contextlib import nullcontext
from numbers import Real

from contact.closed.solve import directly
from contact.errors import NotConverged, SceneError, warn
from contact.extras import require
from contact.formulation import claims
from contact.model.checks import one_of
from contact.model.scene import Scene
from contact.runtime import keep_freed_memory, one_blas_thread
from contact.search.context import SceneCache, SolveContext
from contact.search.find import found
from contact.search.refine import refined
from contact.search.strategies.full_contact import Full
from contact.search.strategies.guesses import Outcome
from contact.search.strategies.load_search import by_quantity
from contact.search.topology.extrapolation import CurvePoint
from contact.search.topology.loop import Progress
from contact.solution import assemble, model_warnings
from contact.solution.solution import Solution
from contact.verify.error import SolvedGaps

# Smallest lengths of a shape in its period, or where it is known: from where on BLAS takes one
# thread, and memory is kept.
_ROUGH = 2**6
_LARGE = 2**17


def solve(
    scene: Scene,
    tol: float = 1e-8,
    progress: Progress | None = None,
    near: Solution | None = None,
    branch: str = "advancing",
) -> Solution:
    """Solve a scene: zones, pressure, gap, and numbers, with error at most `tol` (see
    `Solution.error`).

    Parameters
    ----------
    scene : Scene
        What is asked.
    tol : float
        Largest stated error, relative, 1e-13 <= tol < 1.
    progress : callable or None
        Called with (stage, done, total or None).
    near : Solution or None
        A solution of the same profile and model whose zones are a good start; it saves the search,
        and never changes the answer.
    branch : str
        Which of several equilibria is meant, under laws that have more than one: "advancing",
        reached from first touch by raising the control to its value (under tension: raised to no
        load, then lowered), or "receding", reached by lowering it from the greatest contact.

    Returns
    -------
    Solution

    Raises
    ------
    SceneError
        If the input is bad.
    OutOfRange
        If no contact answers the control.
    NotConverged
        If the tolerance was not met; it carries the best state.

    Warns
    -----
    ModelWarning
        What the model hardly covers; also in the `warnings` of the solution.

    Examples
    --------
    Half of a wave in contact carries half the load of full contact (H. M. Westergaard, J. Appl.
    Mech. 6, 1939, A49, doi 10.1115/1.4008919).

    >>> import contact
    >>> import numpy as np
    >>> wave = contact.Sinusoid(amplitude=1e-6, period=1e-4)
    >>> solution = contact.solve(contact.Scene(wave, 1e9, contact.Periodic(), contact_fraction=0.5), tol=1e-10)
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
    """A tolerance as it was given, checked."""
    if isinstance(tol, bool) or not isinstance(tol, Real) or not 1e-13 <= float(tol) < 1.0:
        raise SceneError.of("tol", tol, "a number from 1e-13 to below 1")
    return float(tol)


def _of(scene: Scene) -> tuple[object, ...]:
    """All of a scene but its control and its modulus."""
    return scene.profile, scene.interaction, scene.substrate, scene.law


def solved_along(
    scene: Scene,
    tol: float,
    progress: Progress | None,
    cache: SceneCache,
    previous: tuple[CurvePoint, ...],
) -> Solution:
    """One scene on a curve of its control's values. cache: what it has in common with the others;
    previous: the last of them.
    """
    near = previous[-1].solution if previous else None
    if scene.control_object.held(scene) is None:
        return _solved(scene, tol, progress, near, cache)
    claims.of(scene.profile)
    direct = directly(scene, tol)
    if direct is not None:
        return direct
    return _run(
        SolveContext.of(
            scene, tol, _solved, cache, progress=progress, warm_start=near, previous=previous
        )
    )


def context_of(scene: Scene, tol: float) -> SolveContext:
    """The context of a scene, for contacts that are followed (`solved_at`)."""
    return SolveContext.of(scene, tol, _solved)


def solved_at(context: SolveContext, found: Outcome, told: str) -> Solution:
    """A contact that was followed to where it is, by the branch of the context; told: how it was come
    by.
    """

    def lost(_: SolveContext) -> Outcome:
        raise NotConverged(
            "only the contact that was followed is meant, and no other search for it"
        )

    context.plan["branch"].detail = told
    return _solution(context, refined(context, found, lost))


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
            lambda loaded, tighter, beside: _solved(loaded, tighter, progress, beside, cache),
        )
    claims.of(scene.profile)
    direct = directly(scene, tol)
    if direct is not None:
        return direct
    context = SolveContext.of(
        scene, tol, _solved, cache, progress=progress, warm_start=near, branch=branch
    )
    return _run(context)


def _run(context: SolveContext) -> Solution:
    start, features = time.perf_counter(), _features(context.scene)
    try:
        with (
            keep_freed_memory(features > _LARGE),
            one_blas_thread() if features > _ROUGH else nullcontext(),
        ):
            return _solution(context, refined(context, _found(context), _found))
    finally:
        context.plan.seconds = time.perf_counter() - start


def _found(context: SolveContext) -> Outcome:
    """The contact of a scene: by the law's own module, on a branch of equilibria, or by search."""
    module = context.scene.law.routes.module
    if module is None and context.follows_branch:
        module = "contact.adhesion.branch"
    return found(context) if module is None else require(module).found(context)


def _features(scene: Scene) -> float:
    """How many of its smallest lengths a shape has in its period, or where it is known."""
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
    if isinstance(outcome, SolvedGaps):
        return assemble.gap_solution(scene, outcome, plan, tol)
    find_pull_off = (
        require("contact.adhesion.pull_off_of_solution").Parting(
            context.control(outcome.fields.problem)
        )
        if followed
        else None
    )
    return assemble.zone_solution(scene, outcome, plan, tol, branch, find_pull_off)
