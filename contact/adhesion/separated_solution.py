"""The solution of surfaces that attract each other without contact.

Only scenes with a cohesive law import this module.
"""

import numpy as np

from contact.adhesion.cohesive_fields import scaled_second_variation
from contact.adhesion.cohesive_state import CohesiveState
from contact.adhesion.separated_fields import SeparatedFields
from contact.formulation.tolerances import TOLERANCES
from contact.model.scene import Scene
from contact.solution.assemble import lawful
from contact.solution.plan import Plan
from contact.solution.solution import Solution
from contact.verify.certificate import Certificate, least_eigenvalue


def separated_solution(
    scene: Scene, fields: SeparatedFields, here: CohesiveState, plan: Plan, branch: str
) -> Solution:
    """The certified solution at an equilibrium without contact."""
    for name in ("zone ends", "coarse search"):
        plan[name].used, plan[name].reason = (
            False,
            "the surfaces attract each other without contact",
        )
    plan.decide("unknowns", "none", "the surfaces attract each other without contact")
    ends, least = len(here.table) > 0, float(here.gap_samples[1].min())
    residual = float(np.abs(here.residual).max(initial=0.0))
    stability = least_eigenvalue(scaled_second_variation(here)) if ends else None
    stable = stability is None or stability > 0.0
    holds = least > 0.0 and residual <= TOLERANCES.edge_condition and stable
    certificate = Certificate(
        smallest_pressure=-scene.law.tension,
        smallest_gap=least * fields.problem.units.height,
        points=len(here.gap_samples[0]),
        holds=holds,
        note="the surfaces attract each other without contact",
        intensity=residual,
        stability=stability,
    )
    end_errors = (
        np.abs(np.linalg.solve(here.rates, here.residual)) / here.widths if ends else np.zeros(1)
    )
    error = TOLERANCES.closed_form_rounding + float(end_errors.max())
    return lawful(
        Solution(scene, np.zeros((0, 2)), fields, error, certificate, plan, branch=branch)
    )
