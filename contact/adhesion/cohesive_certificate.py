"""The certificate of a contact under a tension that acts where the gap is below its reach.

It checks the frictionless contact under the pressure q, the gap at the ends of the intervals of
tension, and the stability. Inside the zones, the pressure p is at least minus the tension s, so
that q = p + s >= 0. The certificate of the frictionless contact tests the sign of q, overlaps of
the surfaces, and the balance of the load that q carries.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np

from contact.adhesion.cohesive_fields import CohesiveFields, scaled_second_variation
from contact.adhesion.cohesive_state import CohesiveState
from contact.adhesion.cohesive_zone import CohesiveCurve
from contact.adhesion.inner_signs import sampled_gap
from contact.adhesion.options import SAMPLES
from contact.formulation.fields import ZoneFields
from contact.formulation.tables import gaps_between, located
from contact.formulation.tolerances import TOLERANCES
from contact.model.units import quantity
from contact.verify.certificate import Certificate, least_eigenvalue
from contact.verify.error import SolvedZones, reference
from sie import AnyDensity, Array, record, wrapped


@record
class SolvedCohesive(SolvedZones):
    """Solved zones of contact under a tension that also acts outside the zones.

    cohesive_error: the part of the error due to the ends of the intervals of tension.
    """

    cohesive_error: float = 0.0

    @cached_property
    def error(self) -> float:
        return super().error + self.cohesive_error

    @property
    def main_cause(self) -> str:
        if self.cohesive_error < 0.5 * self.error:
            return ""
        return (
            "round-off of the heights or of the load under the tension adds "
            f"{self.cohesive_error:.1e}; "
            "allow a larger tol, or use a law with a smaller stress and a longer range"
        )


def certified_everywhere(
    plain: Certificate, curve: CohesiveCurve, fields: CohesiveFields
) -> Certificate:
    """The certificate of a contact whose tension acts on the whole period.

    plain: certificate of the frictionless contact, whose pressure is q = pressure + tension.
    """
    inside = bool(np.all(sampled_gap(fields)[1] < curve.reach * (1 + TOLERANCES.edge_condition)))
    note = (
        "the gap is below the range of the tension everywhere: the pressure is that of the "
        "frictionless contact minus the tension, and the contact is as stable"
    )
    return replace(
        plain,
        smallest_pressure=plain.smallest_pressure - curve.stress * curve.problem.units.pressure,
        holds=plain.holds and inside,
        note=note if inside else "the gap exceeds the range of the tension somewhere",
    )


def certified(plain: Certificate, curve: CohesiveCurve, here: CohesiveState) -> Certificate:
    """The certificate `plain`, with checks of stability and of the gap at ends of tension.
    These are the ends of the intervals in which the tension acts.

    plain: certificate of the frictionless contact, whose pressure is q = pressure + tension.
    """
    assert here.q is not None
    rounding, name = here.q.gap_rounding, curve.control.name
    reach_error = max(float(np.abs(here.residual).max()), float(-here.whole.residual.min()))
    largest = TOLERANCES.edge_condition + TOLERANCES.reach_multiple * rounding / curve.reach
    stability = least_eigenvalue(scaled_second_variation(here))
    failure = _on_wrong_side(curve, here, rounding)
    if not plain.holds:
        failure = plain.note or "a sign of pressure or gap, or the load balance, is wrong"
    elif reach_error > largest:
        failure = (
            "at an end of the tension the gap differs from the range of the tension by "
            f"{reach_error:.1e} of this range"
        )
    elif not failure and not stability > 0.0:
        failure = f"unstable at a fixed {name}: the second variation of the energy is not positive"
    note = (
        "one of several equilibria: pressure above minus the tension in contact, no overlap, "
        "load balance, gap below the range of the tension where "
        "the tension acts, above it elsewhere and equal to it at the ends of the tension, "
        f"locally stable at a fixed {name}"
    )
    return replace(
        plain,
        smallest_pressure=plain.smallest_pressure - curve.stress * curve.problem.units.pressure,
        holds=not failure,
        note=failure or note,
        intensity=reach_error,
        stability=stability,
    )


def _on_wrong_side(curve: CohesiveCurve, here: CohesiveState, rounding: float) -> str:
    """A message that says where the gap is on the wrong side of the reach; empty if nowhere.
    The gap is wrong if it is above the reach inside the intervals of tension, or below it outside.
    Places next to the ends of the intervals do not count. rounding: round-off of the gap.
    """
    (x, gap), table, period = here.gap_samples, here.table, curve.problem.round
    place = wrapped(x, table[0, 0], period)
    i, within = located(table, place)
    ends = np.array([table[i, 0], table[i, 1], gaps_between(table, period)[i, 1]])
    clear_of_ends = np.abs(place - ends).min(axis=0) > TOLERANCES.reach_distance * (
        table[i, 1] - table[i, 0]
    )
    wrong_side = clear_of_ends & np.where(
        within, gap > curve.reach + rounding, gap < curve.reach - rounding
    )
    if not wrong_side.any():
        return ""
    at = quantity(float(curve.problem.units.x(place[wrong_side])[0]), "m", 6)
    return (
        f"at x = {at} the gap is above the range of the tension although the tension acts there, "
        "or below it although no tension acts there"
    )


def end_error(curve: CohesiveCurve, here: CohesiveState, fields: ZoneFields) -> float:
    """Bound of the solution's error caused by errors of the ends of the intervals of tension.

    It is the larger of two errors: the error of these ends, divided by the width of their interval;
    and the error that it causes in the pressure and in the ends of the zones.
    """
    assert here.q is not None
    rounding = here.q.gap_rounding / TOLERANCES.rounding_margin / curve.reach
    ends = np.abs(np.linalg.solve(here.rates, here.residual)) + np.abs(
        np.linalg.inv(here.rates)
    ) @ np.full(len(here.residual), rounding)
    # The contact pressure q carries the given load and the force of the tension. The variable
    # `load` below is the round-off of their sum.
    load = (
        4.0 * np.finfo(np.float64).eps * (abs(here.load) + curve.stress * float(here.widths.sum()))
    )
    follow = (
        np.abs(here.by_ends[:, :-1]) @ ends
        + np.abs(here.by_ends[:, -1]) * curve.value_per_load * load
    )
    followed = follow.reshape(2, -1).T / np.diff(here.zones, axis=1)
    density, problem = fields.density, fields.problem
    largest = max(
        reference(density, problem.end, problem.borne(density)), np.finfo(np.float64).tiny
    )
    steep = np.maximum(TOLERANCES.tension_factor, _steepness(density) / largest)
    return max(
        TOLERANCES.tension_factor * float((ends / here.widths).max()),
        float((steep * followed.max(axis=1)).max()),
    )


def _steepness(density: AnyDensity) -> Array:
    """Largest slope (Z,) of the pressure in each zone, times the zone's width.

    Places near the ends of the zone are left out.
    """
    out = np.zeros(len(density.zones))
    for zone, count in enumerate(np.minimum(density.sampling, SAMPLES.profile_samples).tolist()):
        theta = np.linspace(TOLERANCES.least_angle, np.pi - TOLERANCES.least_angle, count)
        out[zone] = 2 * float((np.abs(density.by_angle(zone, theta)[1]) / np.sin(theta)).max())
    return out


def rounded_load(fields: CohesiveFields) -> float:
    """Relative error of the zones' ends due to round-off of the load, under tension everywhere.

    The load of q, which is the pressure plus the tension, is the sum of the tension's force and the
    given load. The two may nearly cancel.
    """
    total, pull = fields.density.total, fields.tension.total
    rounding = 2 * np.finfo(np.float64).eps * (abs(total - pull) + pull) / total
    widening = np.abs(fields.spreading) / np.diff(fields.zone_table, axis=1)
    return float(rounding * max(1.0, widening.max()))
