"""Inverse design: exact contact problems with given zones, to judge solvers by.

`design(zones, E_star, load, ...)` makes a profile whose exact contact has the given zones.
Nothing here imports the solver.
"""

from contact.reference.inverse.adhesive import AdhesiveDesign, is_stable, second_variation
from contact.reference.inverse.cohesive import CohesiveDesign
from contact.reference.inverse.design_for_law import design
from contact.reference.inverse.designed import DesignedContact, DesignedProfile
from contact.reference.inverse.random import (
    random_adhesive_problem,
    random_cohesive_problem,
    random_problem,
    random_zones,
)

__all__ = [
    "AdhesiveDesign",
    "CohesiveDesign",
    "DesignedContact",
    "DesignedProfile",
    "design",
    "is_stable",
    "random_adhesive_problem",
    "random_cohesive_problem",
    "random_problem",
    "random_zones",
    "second_variation",
]
