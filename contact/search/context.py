"""What a search goes by: the scene, how tightly it is solved, a solution near by, and where it is
told how it went; and what solves of one scene under many controls have in common, found when first
asked for, and once.
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
from contact.errors import ContactError, NotConverged, OutOfRange, SceneError
from contact.formulation import height_rounding
from contact.formulation.controls import Control, Machine, scaled_control
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import FullLimit
from contact.formulation.problem import Problem
from contact.formulation.relief import ScaledRelief
from contact.formulation.units import Units
from contact.model.controls import Quantity
from contact.model.operator import Operator
from contact.model.scene import Scene
from contact.search.topology.extrapolation import CurvePoint
from contact.search.topology.failure import Failure
from contact.search.topology.gap_guesses import GapGuesses
from contact.search.topology.loop import ROUNDS, NewtonSettings, Progress, refine_topology
from contact.search.topology.pressure_form import PressureForm
from contact.solution.assemble import in_cell, profile_fault
from contact.solution.plan import Plan, plan, starts_from_one_zone
from contact.solution.solution import Solution
from contact.verify.certificate import NOT_CHECKED
from contact.verify.error import SolvedZones
from sie import Array, record


class SceneCache(sie.Kept):
    """Of a scene whatever its control is. single: the contact begins as one zone about x = 0; full:
    where full contact begins.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def of(self, scene: Scene) -> SceneCache:
        """The same for a scene that differs in its control alone."""
        own = self.scene
        same = (
            scene.profile is own.profile
            and scene.interaction is own.interaction
            and scene.substrate is own.substrate
        )
        return (
            self
            if same and scene.law is own.law and scene.E_star == own.E_star
            else SceneCache(scene)
        )

    @cached_property
    def operator(self) -> Operator:
        return self.scene.operator

    @cached_property
    def full(self) -> FullLimit:
        return FullLimit(self.scene.profile, self.scene.E_star, self.operator, self.scene.law)

    @cached_property
    def single(self) -> bool:
        return starts_from_one_zone(self.scene)

    def relief(self, problem: Problem) -> ScaledRelief:
        """R in the units of a problem: the same samples for all problems in the same units."""
        return self.first_gaps(problem).relief

    def first_gaps(self, problem: Problem) -> GapGuesses:
        """First guesses of the gaps, likewise."""
        key = problem.units, problem.centre
        if key not in self._first_gaps:
            self._first_gaps[key] = GapGuesses(ScaledRelief.of(self.full.relief, problem))
        return self._first_gaps[key]

    @cached_property
    def _first_gaps(self) -> dict[tuple[Units, float], GapGuesses]:
        return {}


# Solves a scene: (scene, tol, progress, near, what it has in common with others).
Solver = Callable[[Scene, float, Progress | None, Solution | None, SceneCache], Solution]

# The smallest tolerance that is asked of the engine.
LEAST = 2e-15


@record
class SolveContext:
    """Everything that one solve needs to know.

    tol: the wanted error. tolerance: of the ends and of the density. cache: what scenes of the same
    profile and model share. solver: solves other scenes on the way to this one. warm_start: a
    solution of the same profile and model. previous: the last points of a curve of values of the
    control, the nearest one last. branch: which of several equilibria is wanted.
    spring_compliance: of a spring between the body and the prescribed approach [m per N/m].
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
        progress: Progress | None,
        warm_start: Solution | None,
        solver: Solver,
        cache: SceneCache,
        branch: str = "advancing",
    ) -> SolveContext:
        return cls(
            scene,
            tol,
            plan(scene),
            cache,
            max(0.1 * tol, LEAST),
            solver,
            progress,
            warm_start,
            branch,
        )

    def solve_scene(
        self,
        scene: Scene,
        tol: float,
        warm_start: Solution | None = None,
        progress: Progress | None = None,
    ) -> Solution:
        """The solution of another scene on the way to this one."""
        return self.solver(scene, tol, progress, warm_start, self.cache.of(scene))

    @property
    def operator(self) -> Operator:
        return self.cache.operator

    @property
    def full(self) -> FullLimit:
        """Where full contact begins."""
        return self.cache.full

    @property
    def single(self) -> bool:
        """Whether the contact begins as one zone about x = 0."""
        return self.cache.single

    @property
    def follows_branch(self) -> bool:
        """Whether there are several equilibria, of which a branch is followed."""
        return self.scene.law.equilibria.several and self.scene.held(Quantity.HALF_WIDTH) is None

    def with_warm_start(self, solution: Solution | None) -> SolveContext:
        return replace(self, warm_start=solution)

    def control(self, problem: Problem) -> Control:
        """The scene's own control, scaled."""
        control, units = scaled_control(self.scene, problem.units), problem.units
        return (
            control
            if self.spring_compliance is None
            else Machine(control.value, self.spring_compliance * units.load / units.height)
        )

    def refine_topology(
        self,
        problem: Problem,
        control: Control,
        table: Array,
        rounds: int = ROUNDS,
        **settings: Any,
    ) -> SolvedZones | Failure:
        """Zones that pass, from proposed ones. settings: of `NewtonSettings`, but for the tolerance."""
        newton = NewtonSettings(self.tolerance, **settings)
        # Given ends are not searched for.
        with self.plan.timed("zone ends") if self.plan["zone ends"].used else nullcontext():
            form = PressureForm(problem)
            return refine_topology(
                form,
                control,
                form.begun(table),
                newton,
                self.progress,
                timed=self.plan.timed,
                rounds=rounds,
            )

    def record_failure(self, strategy: str, failure: Failure) -> None:
        """Say in the plan what was tried and why it led to nothing."""
        self.plan.tried.append(f"{strategy}: {failure.reason}")

    def error(self, failure: Failure, problem: Problem) -> ContactError:
        """What is raised where no other way is left."""
        if failure.at_border:
            return OutOfRange(failure.reason)
        free = failure.free
        if free is None:
            return NotConverged(f"not converged: {failure.reason}{profile_fault(self.scene)}")
        rounded = height_rounding.told(problem, free.density.zones.table)
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
