"""The energy that slip loses in a step of a history, from the contacts at its ends.

The pressure p and the profile f give the moment M(P) = int p f dx. With the approach delta(P),
Phi = int delta dP = (P delta + M)/2. The loss of `contact.slip.memory` is an integral over the load
S whose zones stick,

    W = mu change int [(P - S) C(S) - delta(P) + delta(S)] dS,

in which P is linear in S. It does not depend on the datum of the approach.
"""

import math
from dataclasses import dataclass

import numpy as np

from contact.formulation.energy import shape_moment
from contact.formulation.fields import ZoneFields
from contact.formulation.roots import maximum
from contact.slip.memory import SlipStep
from contact.solution.solution import Solution


@dataclass(frozen=True)
class LoadPoint:
    """`load` P [N/m], `approach` delta [m] and `work` = int delta dP [J/m] of one contact."""

    load: float
    approach: float
    work: float

    @classmethod
    def of(cls, solution: Solution) -> "LoadPoint":
        """The `LoadPoint` of a solution.
        If the solution has no datum, its approach is computed with the datum 1 m.
        """
        load, approach = solution.load, approach_of(solution)
        return cls(load, approach, 0.5 * (load * approach + shape_moment(solution.fields)))

    @classmethod
    def unloaded(cls, solution: Solution) -> "LoadPoint":
        """The state at zero load: the work is 0, the approach is that of the first touch."""
        return cls(0.0, first_approach(solution), 0.0)


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


def lost(step: SlipStep, friction: float, points: dict[float, LoadPoint]) -> float:
    """Energy [J/m] that slip dissipates in `step`.
    `points` maps each load that occurs in `step` to its contact.
    """
    high, low = (points[load] for load in step.stick)
    first, last = (points[load] for load in step.load)
    rest = (first.load - high.load) * high.approach - (last.load - low.load) * low.approach
    if high.load == low.load:
        return 0.0
    ratio = (first.load - last.load) / (high.load - low.load)
    above = (
        first.approach * (high.load - low.load)
        if first.load == last.load
        else (first.work - last.work) / ratio
    )
    return friction * step.change * (rest + (2.0 - ratio) * (high.work - low.work) - above)
