"""Errors for solutions whose derivatives are not known."""

from __future__ import annotations

from contact.errors import SceneError
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import FullFields
from contact.formulation.gaps import GapFields
from contact.solution.solution import Solution


def refuse(solution: Solution) -> None:
    """Raise SceneError for solutions whose derivatives are not known."""
    if not isinstance(solution, Solution):
        raise SceneError.of("solution", solution, "a contact.Solution")
    scene, fields = solution.scene, solution.fields
    if not isinstance(fields, (ZoneFields, GapFields, FullFields)):
        raise SceneError(
            "derivatives are available only for a contact with zones or in full contact, not for "
            f"this solution under the law {scene.law.name} ({type(fields).__name__})",
            "solution",
        )
    if scene.law.tension or isinstance(fields, ZoneFields) and len(fields.cohesive):
        raise SceneError(
            f"derivatives are not available under the law {scene.law.name}, whose tension acts "
            "over a range of gaps: use finite differences of solutions",
            "law",
        )
    if len(fields.plateaus):
        raise SceneError(
            "derivatives are available only for elastic contact, not for plateaus of the "
            "pressure: use finite differences of solutions",
            "solution",
        )
    if scene.interaction.strip:
        raise SceneError(
            f"derivatives are not available with the {scene.interaction.name} interaction, whose "
            "strip is centred on the zones: use contact.Isolated() or contact.Periodic()",
            "interaction",
        )
    if scene.control_object.held(scene) is None:
        raise SceneError(
            f"derivatives are not available at a given {scene.control[0]}: give the load, mean "
            "pressure, approach, half width or contact fraction instead",
            "control",
        )
    if isinstance(fields, FullFields) and scene.given_fraction is not None:
        raise SceneError(
            "in full contact, derivatives are not available at a given contact fraction: give the "
            "load instead",
            "control",
        )
