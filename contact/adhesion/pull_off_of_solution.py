"""Where a contact that was solved comes apart as its control falls: asked of a solution afterwards."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.adhesion import cohesive_pull_off
from contact.adhesion.arc_length import SymmetryLost
from contact.adhesion.cohesive_fields import PulledFields
from contact.adhesion.cohesive_zone import Cohesive, Loose
from contact.adhesion.curve import Equilibria, Point
from contact.adhesion.energy_descent import relaxed
from contact.adhesion.gradient_flow import receded
from contact.adhesion.pull_off import lowered_by_load, near_the_last, pull_off
from contact.formulation.controls import Control
from contact.formulation.fields import ZoneFields
from contact.runtime import one_blas_thread
from contact.solution.quantities import PullOff

# Part of the rate with the value that lies along the null vector: below it the value does not move
# the turning point. Insensitive.
_SEEN = 1e-3


@dataclass(frozen=True)
class Parting:
    """Of a contact on a branch, under the control that holds it."""

    held: Control

    @one_blas_thread()
    def __call__(self, fields: ZoneFields) -> PullOff:
        problem, units = fields.problem, fields.problem.units
        try:
            last = (
                _under_tension(fields, self.held)
                if isinstance(fields, PulledFields)
                else _without_range(fields, self.held)
            )
        except SymmetryLost as lost:
            raise lost.located() from None
        approach = float(-last.level * units.height) if problem.operator.has_approach else None
        return PullOff(float(last.load * units.load), approach, np.asarray(units.x(last.contact)))


def _without_range(fields: ZoneFields, held: Control) -> Point:
    """The last equilibrium, of a contact beside which nothing acts."""
    curve = Equilibria(fields.problem, held)
    # Under a held approach ends that recede may drive others on.
    recede = receded if held.load is not None else relaxed
    here = curve.at(fields.density.zones.table, held.value)
    return _on_its_zones(
        curve, pull_off(curve, lowered_by_load(curve, here, near_the_last), recede)
    )


def _on_its_zones(curve: Equilibria, last: Point) -> Point:
    """The last equilibrium, its control's value found anew on its zones.

    The curve was followed from values that may be 1e10 times as large, and its own value is rounded
    to what these are. At a turning point the residual r changes with the zones in all directions
    but one, y, the left null vector of its rates: y r = 0 gives the value up to the square of the
    error of the zones.
    """
    here = curve.at(last.table, last.value)
    y = np.linalg.svd(here.rates)[0][:, -1]
    by_value = float(y @ here.by_value)
    if here.held.any() or abs(by_value) < _SEEN * float(np.linalg.norm(here.by_value)):
        return last
    return curve.at(last.table, last.value - float(y @ here.residual) / by_value)


def _under_tension(fields: PulledFields, held: Control) -> Point:
    """The same where a tension acts beside the contact."""
    assert fields.law_problem is not None
    curve, tension, zones = Cohesive(fields.law_problem, held), fields.tension, fields.zones
    if tension.everywhere:
        return cohesive_pull_off.pull_off_from_all(curve, zones, held.value)
    load = float(fields.density.total - tension.total)
    return cohesive_pull_off.pull_off(
        curve, Loose.of(tension.table, held.value, load, float(fields.level), zones)
    )
