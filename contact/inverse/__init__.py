"""Inverse design: exact contact problems with any number of zones at any given places, to judge solvers
by."""

from contact.inverse.designed import DesignedContact, design
from contact.inverse.profile import DesignedProfile
from contact.inverse.random import random_problem, random_zones

__all__ = ["DesignedContact", "DesignedProfile", "design", "random_problem", "random_zones"]
