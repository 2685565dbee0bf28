"""Axisymmetric asperities in three dimensions: one alone, on a lattice, and of several heights."""

from contact.axisymmetric.answer import Spot
from contact.axisymmetric.lattices import Density, Hexagonal, Lattice, Square, own_radius
from contact.axisymmetric.levels import Level, LevelsSolution, solve_levels, touch_pressures
from contact.axisymmetric.profiles import AxisymmetricProfile, Cone, PowerLaw, Revolved, Sphere
from contact.axisymmetric.spot import correction_share, first_step_load, solve_spot

__all__ = [
    "AxisymmetricProfile",
    "Cone",
    "Density",
    "Hexagonal",
    "Lattice",
    "Level",
    "LevelsSolution",
    "PowerLaw",
    "Revolved",
    "Sphere",
    "Spot",
    "Square",
    "correction_share",
    "first_step_load",
    "own_radius",
    "solve_levels",
    "solve_spot",
    "touch_pressures",
]
