"""Plane elastic contact of rough and textured profiles, solved exactly and with a stated error."""

from typing import TYPE_CHECKING, Any

# This import comes first, so that an interrupt by the user is handled during all other imports.
from contact import interrupts  # noqa: F401  isort: skip
from contact.extras import require, version
from sie import uncollected

with uncollected():
    from contact.errors import (
        ContactError,
        MissingExtra,
        ModelWarning,
        NotConverged,
        OutOfRange,
        SceneError,
    )
    from contact.model.controls import Control
    from contact.model.interactions import Interaction, Isolated, Localized, Periodic
    from contact.model.laws import JKR, Dugdale, Frictionless, Law, Plastic, Sliding, dundurs_beta
    from contact.model.profiles import (
        Biquadratic,
        Combined,
        Flat,
        Fourier,
        Parabola,
        Polynomial,
        Power,
        Profile,
        Sampled,
        Sinusoid,
        Wedge,
        read_trace,
        self_affine,
    )
    from contact.model.registry import (
        controls,
        interaction,
        interactions,
        law,
        laws,
        profile,
        profiles,
        register_control,
        register_interaction,
        register_law,
        register_profile,
        register_substrate,
        substrate,
        substrates,
    )
    from contact.model.scene import E_star, Scene
    from contact.model.substrates import HalfPlane, Layer, Substrate
    from contact.solution.plan import Plan, plan
    from contact.solution.solution import Solution
    from contact.solver import solve

if TYPE_CHECKING:
    from contact.derivatives.response import Derivative, Response
    from contact.derivatives.result import Sensitivity, sensitivity
    from contact.design.objective import Measured, Objective, StressObjective
    from contact.design.optimize import optimize
    from contact.design.result import Design
    from contact.explorer.explore import explore
    from contact.inside.stress import Stress
    from contact.inside.yielding import Yield
    from contact.model.scene_file import load_scene
    from contact.slip.history import load_history
    from contact.slip.partial_slip import partial_slip
    from contact.slip.result import Slip
    from contact.slip.rolling import rolling
    from contact.sweeps.adhesive import AdhesiveEvent, AdhesivePath
    from contact.sweeps.path import path
    from contact.sweeps.path_table import Event
    from contact.sweeps.paths import Path
    from contact.sweeps.solve_many import solve_many
    from contact.sweeps.sweep.run import sweep

# Public names with the modules that define them. A single solve needs none of these modules, so
# each module is imported when one of its names is first used. Readers and type checkers find the
# names in the imports above.
_HOMES = {
    "contact.explorer.explore": "explore",
    "contact.inside.stress": "Stress",
    "contact.inside.yielding": "Yield",
    "contact.model.scene_file": "load_scene",
    "contact.sweeps.adhesive": "AdhesiveEvent AdhesivePath",
    "contact.sweeps.solve_many": "solve_many",
    "contact.sweeps.path": "path",
    "contact.sweeps.path_table": "Event",
    "contact.sweeps.paths": "Path",
    "contact.sweeps.sweep.run": "sweep",
    "contact.design.objective": "Measured Objective StressObjective",
    "contact.design.optimize": "optimize",
    "contact.design.result": "Design",
    "contact.derivatives.response": "Derivative Response",
    "contact.derivatives.result": "Sensitivity sensitivity",
    "contact.slip.history": "load_history",
    "contact.slip.partial_slip": "partial_slip",
    "contact.slip.rolling": "rolling",
    "contact.slip.result": "Slip",
}
_HOME = {name: module for module, names in _HOMES.items() for name in names.split()}
# Submodules that a user reaches as attributes of `contact` after `import contact` alone.
_MODULES = ("axisymmetric", "exact", "inverse", "paper", "testing")

if not TYPE_CHECKING:  # so that a type checker still reports unknown names

    def __getattr__(name: str) -> Any:
        if name == "__version__":  # read from the installed package, which takes time
            return version()
        if name in _MODULES:
            return require(f"contact.{name}")
        if name not in _HOME:
            raise AttributeError(f"module 'contact' has no attribute {name!r}")
        found = globals()[name] = getattr(require(_HOME[name]), name)
        return found

else:
    __version__: str


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])


__all__ = [
    "AdhesiveEvent",
    "AdhesivePath",
    "Biquadratic",
    "Combined",
    "ContactError",
    "Control",
    "Derivative",
    "Design",
    "Dugdale",
    "E_star",
    "Event",
    "Flat",
    "Fourier",
    "Frictionless",
    "HalfPlane",
    "Interaction",
    "Isolated",
    "JKR",
    "Law",
    "Layer",
    "Localized",
    "Measured",
    "MissingExtra",
    "ModelWarning",
    "NotConverged",
    "Objective",
    "OutOfRange",
    "Parabola",
    "Path",
    "Periodic",
    "Plan",
    "Polynomial",
    "Power",
    "Profile",
    "Sampled",
    "Scene",
    "Response",
    "SceneError",
    "Sensitivity",
    "Sinusoid",
    "Plastic",
    "Sliding",
    "Slip",
    "Solution",
    "Stress",
    "StressObjective",
    "Substrate",
    "Wedge",
    "Yield",
    "controls",
    "dundurs_beta",
    "explore",
    "interaction",
    "interactions",
    "law",
    "laws",
    "load_history",
    "load_scene",
    "optimize",
    "partial_slip",
    "path",
    "plan",
    "profile",
    "profiles",
    "read_trace",
    "register_control",
    "register_interaction",
    "register_law",
    "register_profile",
    "register_substrate",
    "rolling",
    "self_affine",
    "sensitivity",
    "solve",
    "solve_many",
    "substrate",
    "substrates",
    "sweep",
]
