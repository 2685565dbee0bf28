"""Plane elastic contact solved exactly: zones, pressure and gap of rough and textured profiles, with a stated error."""

# First: a command may be interrupted while the rest is imported.
from contact import interrupts  # noqa: F401  isort: skip
from contact.errors import ContactError, MissingExtra, ModelWarning, NotConverged, OutOfRange, SceneError
from contact.explorer.explore import explore
from contact.extras import version
from contact.model.interactions import Interaction, Isolated, Localized, Periodic
from contact.model.laws import JKR, Dugdale, Frictionless, Law
from contact.model.profiles import (
    Biquadratic,
    Flat,
    Fourier,
    Parabola,
    Polynomial,
    Profile,
    Sampled,
    Sinusoid,
    Wedge,
    read_trace,
    self_affine,
)
from contact.model.registry import (
    interaction,
    interactions,
    law,
    laws,
    profile,
    profiles,
    register_interaction,
    register_law,
    register_profile,
    register_substrate,
    substrate,
    substrates,
)
from contact.model.scene import E_star, Scene
from contact.model.scene_file import load_scene
from contact.model.substrates import HalfPlane, Layer, Substrate
from contact.solution.plan import Plan, plan
from contact.solution.solution import Solution
from contact.solver import solve
from contact.sweeps.adhesive import AdhesiveEvent, AdhesivePath
from contact.sweeps.curve import solve_many
from contact.sweeps.path import path
from contact.sweeps.paths import Event, Path
from contact.sweeps.sweep.run import sweep


def __getattr__(name: str) -> str:
    # Looked up when it is asked for: what is installed says it, and saying it takes time.
    if name == "__version__":
        return version()
    raise AttributeError(f"module 'contact' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])


__all__ = [
    "AdhesiveEvent", "AdhesivePath", "Biquadratic", "ContactError", "Dugdale", "E_star", "Event", "Flat", "Fourier", "Frictionless",
    "HalfPlane", "Interaction", "Isolated", "JKR", "Law", "Layer", "Localized", "MissingExtra",
    "ModelWarning", "NotConverged", "OutOfRange", "Parabola", "Path", "Periodic", "Plan", "Polynomial", "Profile", "Sampled", "Scene",
    "SceneError",
    "Sinusoid", "Solution", "Substrate", "Wedge", "explore",
    "interaction", "interactions", "law", "laws", "load_scene", "path", "plan", "profile",
    "profiles", "read_trace", "register_interaction", "register_law", "register_profile", "register_substrate", "self_affine",
    "solve", "solve_many", "substrate", "substrates", "sweep",
]
