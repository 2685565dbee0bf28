"""Inverse design: exact contact problems with any number of zones at any given places, to judge
solvers by.
"""

from contact.reference.inverse.adhesive import (
    AdhesiveDesign,
    adhesive_design,
    is_stable,
    second_variation,
)
from contact.reference.inverse.cohesive import CohesiveDesign
from contact.reference.inverse.designed import DesignedContact, DesignedProfile, design
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
    "adhesive_design",
    "design",
    "is_stable",
    "random_adhesive_problem",
    "random_cohesive_problem",
    "random_problem",
    "random_zones",
    "second_variation",
]
