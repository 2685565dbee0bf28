"""Where a contact that was solved comes apart as its control falls: asked of a solution afterwards."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.formulation.controls import Control
from contact.formulation.equilibria import Equilibria
from contact.formulation.fields import ZoneFields
from contact.formulation.tension.cohesive import Cohesive, Loose
from contact.formulation.tension.fields import PulledFields
from contact.search.equilibria import tension_parting
from contact.search.equilibria.arc import SymmetryLost
from contact.search.equilibria.coming_apart import lowered_by_load, near_the_last, pull_off
from contact.search.equilibria.flow import receded
from contact.search.equilibria.relaxation import relaxed
from contact.solution.answer import PullOff
from contact.threads import one_of_blas


@dataclass(frozen=True)
class Parting:
    """Of a contact on a branch, under the control that holds it."""

    held: Control

    @one_of_blas()
    def __call__(self, fields: ZoneFields) -> PullOff:
        problem, units = fields.problem, fields.problem.units
        curve = Equilibria(problem, self.held)
        # Under a held approach ends that recede may drive others on.
        recede = receded if self.held.load is not None else relaxed
        try:
            here = curve.at(fields.density.zones.table, self.held.value)
            last = pull_off(curve, lowered_by_load(curve, here, near_the_last), recede)
        except SymmetryLost as lost:
            raise lost.located() from None
        approach = float(-last.level * units.height) if problem.operator.has_approach else None
        return PullOff(float(last.load * units.load), approach, np.asarray(units.x(last.table)))


@dataclass(frozen=True)
class PartingUnderTension:
    """The same where a tension acts beside the contact."""

    held: Control

    @one_of_blas()
    def __call__(self, fields: ZoneFields) -> PullOff:
        assert isinstance(fields, PulledFields) and fields.law_problem is not None
        problem, units, zones = fields.law_problem, fields.problem.units, fields.density.zones.table
        curve, tension = Cohesive(problem, self.held), fields.tension
        try:
            if tension.everywhere:
                last = tension_parting.pull_off_from_all(curve, zones, self.held.value)
            else:
                load = float(fields.density.total - tension.total)
                here = Loose.of(tension.table, self.held.value, load, float(fields.level), zones)
                last = tension_parting.pull_off(curve, here)
        except SymmetryLost as lost:
            raise lost.located() from None
        approach = float(-last.level * units.height) if problem.operator.has_approach else None
        return PullOff(float(last.load * units.load), approach, np.asarray(units.x(last.contact)))
