"""What solves of one scene under many controls have in common: found when first asked for, and once."""

from functools import cached_property

import sie
from contact.formulation.full import FullLimit
from contact.formulation.problem import Problem
from contact.formulation.relief import ScaledRelief
from contact.formulation.units import Units
from contact.model.operator import Operator
from contact.model.scene import Scene
from contact.search.topology.first_gaps import FirstGaps
from contact.solution.plan import starts_from_one_zone


class Shared(sie.Kept):
    """Of a scene whatever its control is. single: the contact begins as one zone about x = 0; full: where full contact begins."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

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
        key = problem.units, problem.centre
        if key not in self._reliefs:
            self._reliefs[key] = ScaledRelief.of(self.full.relief, problem)
        return self._reliefs[key]

    def first_gaps(self, problem: Problem) -> FirstGaps:
        """First guesses of the gaps, likewise."""
        key = problem.units, problem.centre
        if key not in self._first_gaps:
            self._first_gaps[key] = FirstGaps.of(problem, self.relief(problem))
        return self._first_gaps[key]

    @cached_property
    def _reliefs(self) -> dict[tuple[Units, float], ScaledRelief]:
        return {}

    @cached_property
    def _first_gaps(self) -> dict[tuple[Units, float], FirstGaps]:
        return {}
