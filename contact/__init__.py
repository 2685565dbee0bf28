"""Plane elastic contact solved exactly: zones, pressure and gap of rough and textured profiles, with a stated error."""

# First: a command may be interrupted while the rest is imported.
from contact import interrupts  # noqa: F401  isort: skip
from contact.errors import ContactError, MissingExtra, ModelWarning, NotConverged, OutOfRange, SceneError
from contact.model.interactions import Interaction, Isolated, Localized, Periodic
from contact.model.profiles import Biquadratic, Flat, Fourier, Parabola, Polynomial, Profile, Sampled, Sinusoid, Wedge
from contact.model.registry import (
    interaction,
    interactions,
    profile,
    profiles,
    register_interaction,
    register_profile,
)
from contact.model.scene import E_star, Scene
from contact.model.scene_file import load_scene
from contact.solution.plan import Plan, plan
from contact.solution.solution import Solution
from contact.solver import solve
from contact.sweeps.paths import Event, Path, path

__all__ = [
    "Biquadratic", "ContactError", "E_star", "Event", "Flat", "Fourier", "Interaction", "Isolated", "Localized", "MissingExtra",
    "ModelWarning", "NotConverged", "OutOfRange", "Parabola", "Path", "Periodic", "Plan", "Polynomial", "Profile", "Sampled", "Scene",
    "SceneError",
    "Sinusoid", "Solution", "Wedge", "interaction", "interactions", "load_scene", "path", "plan", "profile", "profiles",
    "register_interaction", "register_profile", "solve",
]
