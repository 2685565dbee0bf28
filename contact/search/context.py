"""The context of one search: scene, tolerance, similar solutions, and the plan.

Solves of one profile and model under many controls share a `SceneCache`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

import sie
from contact.closed.solve import why_not_closed
from contact.errors import ContactError, NotConverged, OutOfRange, SceneError
from contact.formulation import input_checks
from contact.formulation.controls import Control, Machine, scaled_control
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import FullLimit
from contact.formulation.problem import Problem
from contact.formulation.relief import ScaledRelief
from contact.formulation.units import Units
from contact.model.controls import Quantity
from contact.model.operator import Operator
from contact.model.scene import Scene
from contact.search.options import LEAST
from contact.search.topology.extrapolation import CurvePoint
from contact.search.topology.failure import Failure
from contact.search.topology.gap_guesses import GapGuesses
from contact.search.topology.loop import NewtonSettings, Observer, Progress, refine_topology
from contact.search.topology.pressure_form import PressureForm
from contact.solution.assemble import in_cell, profile_fault
from contact.solution.plan import Plan, plan, starts_from_one_zone
from contact.solution.solution import Solution
from contact.verify.certificate import NOT_CHECKED
from contact.verify.error import SolvedZones
from sie import Array, record


class SceneCache(sie.Kept):
    """Results shared by scenes that differ only in the given load, approach or width.
    Each result is computed once.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def of(self, scene: Scene) -> SceneCache:
        """This cache if its profile, interaction, substrate, law and E* are those of `scene`.
        Otherwise a new, empty cache.
        """
        own = self.scene
        same = (
            scene.profile is own.profile
            and scene.interaction is own.interaction
            and scene.substrate is own.substrate
            and scene.law is own.law
            and scene.E_star == own.E_star
        )
        return self if same else SceneCache(scene)

    @cached_property
    def operator(self) -> Operator:
        """The elastic operator of the cache's scenes; it gives displacement from pressure."""
        return self.scene.operator

    @cached_property
    def full(self) -> FullLimit:
        """The mean pressure at which full contact begins (see `FullLimit`)."""
        return FullLimit(self.scene.profile, self.scene.E_star, self.operator, self.scene.law)

    @cached_property
    def single(self) -> bool:
        """Whether the first guess of the contact is one zone about x = 0."""
        return starts_from_one_zone(self.scene)

    def relief(self, problem: Problem) -> ScaledRelief:
        """The scaled relief R: minus the pressure that would flatten the profile.

        R has mean zero (see `Relief`). It is sampled once and shared.
        """
        return self.gap_guesses(problem).relief

    def gap_guesses(self, problem: Problem) -> GapGuesses:
        """First guesses of the gaps between the contact zones, in the units of `problem`."""
        key = problem.units, problem.centre
        if key not in self._gap_guesses:
            self._gap_guesses[key] = GapGuesses(ScaledRelief.of(self.full.relief, problem))
        return self._gap_guesses[key]

    @cached_property
    def _gap_guesses(self) -> dict[tuple[Units, float], GapGuesses]:
        return {}


# A solver takes a scene, its tolerance, a progress callback, a similar solution to start from, and
# a cache. It returns the scene's solution.
Solver = Callable[[Scene, float, Progress | None, Solution | None, SceneCache], Solution]

# Tolerance of the zone ends and of the density (the unknown function, such as the pressure),
# divided by the wanted error of the solution. This fraction is below one, as several truncation
# errors add up.
INNER = 0.1


@record
class SolveContext:
    """The inputs of one solve: scene, tolerances, similar solutions, cache of shared results.
    The plan records the decisions of the solve.

    tol: the wanted error. tolerance: tolerance of the zone ends and of the density. cache: results
    shared with scenes of the same profile and model. solver: a function that solves intermediate
    scenes. warm_start: a solution of the same profile and model. previous: the solutions at the
    last values of the control on a curve, the nearest one last. branch: which of several equilibria
    is wanted. spring_compliance: compliance of a spring between the body and the prescribed
    approach [m per N/m].
    """

    scene: Scene
    tol: float
    plan: Plan
    cache: SceneCache
    tolerance: float
    solver: Solver
    progress: Progress | None = None
    warm_start: Solution | None = None
    branch: str = "advancing"
    previous: tuple[CurvePoint, ...] = ()
    spring_compliance: float | None = None

    @classmethod
    def of(
        cls,
        scene: Scene,
        tol: float,
        solver: Solver,
        cache: SceneCache | None = None,
        **others: Any,
    ) -> SolveContext:
        """The context for a scene, with a new plan (log of decisions). others: its other fields."""
        made = plan(scene)
        way, because = "coupled system", why_not_closed(scene.law, scene.E_star)
        if scene.law.routes.module is not None:
            way = "the module of the law"
        made.decide("solver", way, because)
        tolerance = max(INNER * tol, LEAST)
        return cls(scene, tol, made, cache or SceneCache(scene), tolerance, solver, **others)

    def solve_scene(
        self,
        scene: Scene,
        tol: float,
        warm_start: Solution | None = None,
        progress: Progress | None = None,
    ) -> Solution:
        """The solution of an intermediate scene that this search needs."""
        return self.solver(scene, tol, progress, warm_start, self.cache.of(scene))

    @property
    def observer(self) -> Observer:
        """The observer to which a search reports its progress and its times."""
        return Observer(self.progress, self.plan.timed)

    @property
    def operator(self) -> Operator:
        """The elastic operator of the scene, which gives displacement from pressure."""
        return self.cache.operator

    @property
    def full(self) -> FullLimit:
        """The mean pressure at which full contact begins (see `FullLimit`)."""
        return self.cache.full

    @property
    def single(self) -> bool:
        """Whether the first guess of the contact is one zone about x = 0."""
        return self.cache.single

    @property
    def follows_branch(self) -> bool:
        """Whether the law allows several equilibria under one load, and no half width is given."""
        return self.scene.law.equilibria.several and self.scene.held(Quantity.HALF_WIDTH) is None

    def with_warm_start(self, solution: Solution | None) -> SolveContext:
        """A copy of this context that starts from another similar solution."""
        return replace(self, warm_start=solution)

    def control(self, problem: Problem) -> Control:
        """The given quantity of the scene, such as its load or approach, in scaled units.
        It is a `Machine` if a spring is in series with the body.
        """
        control, units = scaled_control(self.scene, problem.units), problem.units
        return (
            control
            if self.spring_compliance is None
            else Machine(control.value, self.spring_compliance * units.load / units.height)
        )

    def refine_topology(
        self, problem: Problem, control: Control, table: Array, **settings: Any
    ) -> SolvedZones | Failure:
        """Zones that pass the check of signs, found from the first guess `table`; or a Failure.

        settings: those of `NewtonSettings`, except the tolerance.
        """
        newton = NewtonSettings(self.tolerance, **settings)
        # If the ends of the zones are given, there is no Newton iteration to time.
        with self.plan.timed("zone ends") if self.plan["zone ends"].used else nullcontext():
            form = PressureForm(problem)
            return refine_topology(form, control, form.begun(table), newton, self.observer)

    def record_failure(self, strategy: str, failure: Failure) -> None:
        """Record in the plan that a strategy failed, and why."""
        self.plan.tried.append(f"{strategy}: {failure.reason}")

    def error(self, failure: Failure, problem: Problem) -> ContactError:
        """The error to raise if no strategy is left; the error contains the best result reached."""
        if failure.at_border:
            return OutOfRange(failure.reason)
        free = failure.free
        if free is None:
            return NotConverged(f"not converged: {failure.reason}{profile_fault(self.scene)}")
        rounded = input_checks.height_rounding(problem, free.density.zones.table)
        if rounded:
            return SceneError(rounded, "profile", self.scene.profile)
        table = in_cell(self.scene, np.asarray(problem.units.x(free.density.zones.table)))
        certificate = replace(NOT_CHECKED, holds=False, note=failure.reason)
        best = Solution(
            self.scene,
            table,
            ZoneFields(problem, free.state),
            math.inf,
            certificate,
            self.plan,
            free.trace,
        )
        return NotConverged(
            f"not converged: {failure.reason}{profile_fault(self.scene, table)}", free.trace, best
        )
