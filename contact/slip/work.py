"""The energy that slip dissipates in a step of a history, from the contacts at the step's ends.

The pressure p and the profile f give the moment M(P) = int p f dx. With the approach delta(P),
Phi = int delta dP = (P delta + M)/2. The energy W that slip dissipates (see `contact.slip.memory`)
is an integral over the load S whose zones stick,

    W = mu change int [(P - S) C(S) - delta(P) + delta(S)] dS,

where `change` is the absolute change of h, and P is linear in S. W does not depend on the datum of
the approach. Let m be the mean of delta(S) over the step, and n the mean of delta(P). S falls from
S_1 to S_2, and P goes from P_1 to P_2. With partial integration,

    W = mu change ((P_1 - S_1) (delta(S_1) - m) + (P_2 - S_2) (m - delta(S_2))
                   + (S_1 - S_2) (m - n)).

The mean m or n is the difference of Phi between both ends of the step, divided by the difference of
the load S or P. If the difference of the load is small, the mean follows more exactly from the
compliance C = d delta / dP, which falls as P grows.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contact.formulation.energy import shape_moment
from contact.formulation.fields import ZoneFields
from contact.formulation.roots import maximum
from contact.inside.field import unit_pressure
from contact.slip.memory import SlipStep
from contact.solution.report import crowding
from contact.solution.solution import Solution

# Bound of the error of displacements, in units of the stated error times `displacement_unit`.
OF_DISPLACEMENT = 3.0


def displacement_unit(solution: Solution) -> float:
    """The largest pressure times a width, divided by E* [m].
    The width is the period or, without a period, that from the first to the last zone.
    """
    zones, period = solution.zones, solution.scene.period
    width = period if period is not None else float(zones[-1, 1] - zones[0, 0])
    return unit_pressure(solution.fields) * width / solution.scene.E_star


@dataclass(frozen=True)
class LoadPoint:
    """`load` P [N/m], `approach` delta [m] and `work` = int delta dP [J/m] of one contact.
    `error` bounds the error of the approach [m], and that of the work divided by the load.

    compliance: d delta / dP [m^2/N], infinite if it is not known; compliance_error: bound of the
    error of the compliance.
    """

    load: float
    approach: float
    work: float
    error: float
    compliance: float = math.inf
    compliance_error: float = 0.0

    @classmethod
    def of(cls, solution: Solution) -> "LoadPoint":
        """The `LoadPoint` of a solution.
        If the solution has no datum, its approach is computed with the datum 1 m.
        """
        load, approach = solution.load, approach_of(solution)
        work = 0.5 * (load * approach + shape_moment(solution.fields))
        moved = OF_DISPLACEMENT * solution.error * displacement_unit(solution)
        error = moved + solution.certificate.gap_rounding
        stiffness = solution.stiffness
        compliance = math.inf if stiffness is None else 1.0 / stiffness
        of_compliance = 4 * solution.error / solution.scene.E_star * crowding(solution)
        return cls(load, approach, work, error, compliance, of_compliance)

    @classmethod
    def unloaded(cls, solution: Solution) -> "LoadPoint":
        """The state at zero load: the work is 0, the approach is that of the first touch."""
        return cls(0.0, first_approach(solution), 0.0, 0.0)


def approach_of(solution: Solution) -> float:
    """Approach [m] of a solution; without a datum, the approach for the datum 1 m."""
    fields = solution.fields
    if fields.approach is not None:
        return fields.approach
    units = fields.problem.units
    level = float(np.mean(fields.levels)) * units.height
    # Without a datum, the constant potentials `levels` of the zones contain ln(x / `units.length`).
    # The last term turns this logarithm into ln(x / 1 m).
    return -level - 2.0 / (math.pi * units.E_star) * fields.load * math.log(units.length)


def first_approach(solution: Solution) -> float:
    """Approach [m] at which the bodies touch first on loading: 0 unless the body is tilted."""
    fields = solution.fields
    if not solution.scene.turned or not isinstance(fields, ZoneFields):
        return 0.0
    # The point of first touch is in contact under any load. So it is searched for in the zones
    # only.
    zones = fields.zones
    t = np.linspace(0.0, 1.0, 65)
    x = np.unique((zones[:, :1] + np.diff(zones) * t).ravel())
    return -maximum(lambda at: -fields.standing_shape(at), x)[1] * fields.problem.units.height


def dissipated_energy(
    step: SlipStep, friction: float, points: dict[float, LoadPoint]
) -> tuple[float, float]:
    """Energy that slip dissipates in `step`, and the bound of its error [J/m].
    `points` maps each load that occurs in `step` to its contact.
    """
    high, low = (points[load] for load in step.stick)
    first, last = (points[load] for load in step.load)
    sticks = ApproachRise.between(low, high)
    loads = ApproachRise.between(*sorted((first, last), key=_load))
    # The fall S_1 - S_2 of the stick load, and the excess P - S of the load in both states.
    stick_drop = high.load - low.load
    first_excess, last_excess = first.load - high.load, last.load - low.load
    energy = first_excess * sticks.above + last_excess * sticks.below
    energy += stick_drop * (sticks.mean - loads.mean)
    error = (abs(first_excess) + abs(last_excess) + stick_drop) * sticks.error
    error += stick_drop * (loads.error + sticks.upper_error + loads.upper_error)
    size = friction * step.change
    return size * energy, size * error


def _load(point: LoadPoint) -> float:
    return point.load


class ApproachRise(NamedTuple):
    """The mean of the approach delta(P) over a range of loads, and delta at both ends [m].

    below: the mean minus delta at the lower end. above: delta at the upper end minus the mean.
    error: bound of the errors of `below` and `above`. upper_error: bound of the error of delta at
    the upper end.
    """

    mean: float
    below: float
    above: float
    error: float
    upper_error: float

    @classmethod
    def between(cls, low: LoadPoint, high: LoadPoint) -> "ApproachRise":
        """The rise from the contact `low` to the contact `high`, which has a larger load."""
        width = high.load - low.load
        if width == 0.0:
            return cls(high.approach, 0.0, 0.0, 0.0, high.error)
        mean = (high.work - low.work) / width
        error = (high.load * high.error + low.load * low.error) / width
        error += max(high.error, low.error)
        # The compliance falls as the load grows, so it lies between its values at both ends. It is
        # taken as linear in the load; `bound` limits the resulting errors of `above` and `below`.
        bound = width * (
            abs(high.compliance - low.compliance) / 3
            + max(high.compliance_error, low.compliance_error)
        )
        if bound < error:
            above = width * (2 * high.compliance + low.compliance) / 6
            below = width * (high.compliance + 2 * low.compliance) / 6
            return cls(high.approach - above, below, above, bound, high.error)
        return cls(mean, mean - low.approach, high.approach - mean, error, high.error)
