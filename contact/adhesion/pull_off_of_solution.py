"""The pull-off of a solution, which is computed only when a user asks for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.adhesion import cohesive_pull_off
from contact.adhesion.arc_length import SymmetryLost
from contact.adhesion.cohesive_fields import CohesiveFields
from contact.adhesion.cohesive_state import StateOutline
from contact.adhesion.cohesive_zone import CohesiveCurve
from contact.adhesion.curve import ACCURACY, Curve, State
from contact.adhesion.energy_descent import relaxed
from contact.adhesion.gradient_flow import receded
from contact.adhesion.pull_off import lowered_by_load, near_the_last, pull_off
from contact.formulation.controls import Control
from contact.formulation.fields import ZoneFields
from contact.runtime import one_blas_thread
from contact.solution.quantities import PullOff


@dataclass(frozen=True)
class PullOffFinder:
    """A function that finds the pull-off of a contact on a branch.

    control: the control under which the contact was found.
    """

    control: Control

    @one_blas_thread()
    def __call__(self, fields: ZoneFields) -> PullOff:
        problem, units = fields.problem, fields.problem.units
        try:
            last = (
                _by_cohesive_zone(fields, self.control)
                if isinstance(fields, CohesiveFields)
                else _by_edge_intensity(fields, self.control)
            )
        except SymmetryLost as lost:
            raise lost.located() from None
        approach = float(-last.level * units.height) if problem.operator.has_approach else None
        return PullOff(float(last.load * units.load), approach, np.asarray(units.x(last.contact)))


def _by_edge_intensity(fields: ZoneFields, control: Control) -> State:
    """The equilibrium at pull-off of a contact without tension outside its zones."""
    curve = Curve(fields.problem, control)
    # Under a fixed approach, ends that recede may make other ends advance, which `relaxed` allows.
    recede = receded if control.load is not None else relaxed
    here = curve.at(fields.density.zones.table, control.value)
    return _on_its_zones(
        curve, pull_off(curve, lowered_by_load(curve, here, near_the_last), recede)
    )


def _on_its_zones(curve: Curve, last: State) -> State:
    """The equilibrium `last` at pull-off, with the control value recomputed from its zones.

    The curve may begin at control values 1e10 times as large, and the value at pull-off contains
    the round-off of these values. At a turning point, the matrix dr/ds of the residuals r, with the
    displacements s of the ends, has a left null vector y. So y r does not depend on the ends to
    first order. The equation y r = 0 then gives the control value up to the square of the error of
    the zones.
    """
    here = curve.at(last.table, last.value)
    y = np.linalg.svd(here.rates)[0][:, -1]
    by_value = float(y @ here.by_value)
    if here.pinned.any() or abs(by_value) < ACCURACY.coarse * float(np.linalg.norm(here.by_value)):
        return last
    return curve.at(last.table, last.value - float(y @ here.residual) / by_value)


def _by_cohesive_zone(fields: CohesiveFields, control: Control) -> State:
    """The equilibrium at pull-off of a contact under a cohesive tension."""
    assert fields.law_problem is not None
    curve, tension, zones = CohesiveCurve(fields.law_problem, control), fields.tension, fields.zones
    if tension.everywhere:
        return cohesive_pull_off.pull_off_from_all(curve, zones, control.value)
    load = float(fields.density.total - tension.total)
    return cohesive_pull_off.pull_off(
        curve, StateOutline.of(tension.table, control.value, load, float(fields.level), zones)
    )
