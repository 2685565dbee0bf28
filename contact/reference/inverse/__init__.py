"""Inverse design: exact contact problems with any number of zones at any given places, to judge solvers
by."""

from contact.reference.inverse.designed import DesignedContact, design
from contact.reference.inverse.profile import DesignedProfile
from contact.reference.inverse.random import random_problem, random_zones

__all__ = ["DesignedContact", "DesignedProfile", "design", "random_problem", "random_zones"]
