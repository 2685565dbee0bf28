"""The load curve of a scene, a point at a time: so that the page goes on answering while it is drawn."""

from collections.abc import Iterator

import numpy as np

from contact.errors import ContactError, unwarned
from contact.explorer.handles import Handle, with_number
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.solver import solve
from contact.sweeps.curve import Curve

_VALUES = 33


def along(scene: Scene, control: Handle, tol: float, branch: str) -> Iterator[Solution]:
    """Solutions of a scene all along its control, upwards; values that have none are left out."""
    name = scene.control[0]
    values = np.geomspace(control.low, control.high, _VALUES) if control.log else np.linspace(control.low, control.high, _VALUES)
    # Under a law that pulls the branch matters, which each is solved on by itself.
    curve = None if scene.law.pulls else Curve(scene, name, tol)
    for value in values:
        try:
            with unwarned():
                here = curve.at(float(value)) if curve else solve(with_number(scene, name, float(value)), tol=tol, branch=branch)
        except ContactError:
            continue
        yield here
        if len(here.zones) == 0:
            return  # full contact: nothing more happens


def same_curve(one: Scene, other: Scene) -> bool:
    """Whether two scenes differ in the value of their control only."""
    name, value = other.control
    return one.control[0] == name and with_number(one, name, value) == other
