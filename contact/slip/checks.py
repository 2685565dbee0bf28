"""Checks that refuse scenes and values for which the formulas of contact.slip are not exact.

Shear and slip follow from contacts without friction under smaller loads if the bodies are alike
(Dundurs' beta = 0), both bodies are half-planes, and the body keeps its tilt.
"""

from contact.errors import SceneError
from contact.model.checks import finite, positive
from contact.model.laws import Frictionless
from contact.model.scene import Scene
from contact.slip.memory import SAME_LOAD


def require_similar(scene: Scene) -> None:
    """Raise SceneError unless shear and pressure obey the same equation.
    Only then does the shear follow from pressures under smaller loads.
    """
    law, model, body = scene.law, scene.interaction, scene.substrate
    if not isinstance(law, Frictionless):
        raise SceneError(
            f"law = {law.name}: shear is computed only without adhesion and yielding, and only if "
            "it does not change the pressure (Dundurs' constant beta = 0): leave the law out",
            "law",
        )
    if model.strip:
        raise SceneError(
            f"interaction = {model.name}: the nominal pressure of a localized model has no "
            "counterpart in the shear: use contact.Periodic() or contact.Isolated()",
            "interaction",
        )
    if scene.operator.is_own or scene.operator.own_columns:
        raise SceneError(
            f"interaction = {model.name}: its kernel for the pressure is known, but not its kernel "
            "for the shear: use contact.Periodic() or contact.Isolated()",
            "interaction",
        )
    if not scene.operator.is_plain:
        raise SceneError(
            f"substrate = {body.name}: shear and pressure displace this body by different "
            "kernels: use contact.HalfPlane()",
            "substrate",
        )
    if scene.moment is not None and scene.turned:
        raise SceneError(
            "moment: a body that turns freely has another tilt under each load, so that its stick "
            "zones may lie outside the contact: give a tilt",
            "moment",
        )


def friction_of(value: object) -> float:
    """The coefficient of friction, checked. Raises SceneError unless it is a finite number > 0."""
    return positive("friction", value)


def tangential_load_of(value: object, friction: float, load: float) -> float:
    """The tangential load [N/m], checked.
    Raises SceneError if its absolute value exceeds friction * load.
    """
    number, most = finite("tangential_load", value), friction * load
    if abs(number) > most * (1.0 + SAME_LOAD):
        raise SceneError.of(
            "tangential_load",
            value,
            f"at most friction * load = {most:.17g} in absolute value: above it the whole contact "
            "slides",
        )
    return max(-most, min(number, most))


def bulk_stress_of(value: object, scene: Scene, tangential_load: float) -> float:
    """The bulk stress [Pa], checked: a finite number that is allowed for this scene.

    A bulk stress other than 0 raises SceneError in periodic contact or without tangential load.
    """
    stress = finite("bulk_stress", value)
    if stress == 0.0:
        return stress
    if not scene.interaction.turns:
        raise SceneError.of(
            "bulk_stress",
            value,
            "0 in periodic contact: a bulk stress stretches one body more than the other, by a "
            "length that grows from period to period, so that nothing sticks",
        )
    if tangential_load == 0.0:
        raise _two_signs(value)
    return stress


def _two_signs(value: object) -> SceneError:
    return SceneError.of(
        "bulk_stress",
        value,
        "so small relative to the tangential load that the stick zones lie within the contact: "
        "otherwise the two ends slip in opposite directions, a case that is not solved",
    )


def nested_or_refused(is_nested: bool, bulk_stress: float) -> None:
    """Raise SceneError if, under a bulk stress, the stick zones do not lie within the contact."""
    if not is_nested:
        raise _two_signs(bulk_stress)
