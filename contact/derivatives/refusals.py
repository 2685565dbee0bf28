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
            f"derivatives are known for contact that {scene.law.name} bodies have on zones, on "
            f"gaps or everywhere, not for this one ({type(fields).__name__})",
            "solution",
        )
    if scene.law.tension or isinstance(fields, ZoneFields) and len(fields.cohesive):
        raise SceneError(
            f"the law {scene.law.name}: the ends of its tension move with a condition on the gap, "
            "and derivatives by that are not known: use differences of solutions",
            "law",
        )
    if len(fields.plateaus):
        raise SceneError(
            "contact with plateaus of the pressure: derivatives are known for elastic contact "
            "only: use differences of solutions",
            "solution",
        )
    if scene.interaction.strip:
        raise SceneError(
            "localized: the strip and its nominal pressure follow the zones, and derivatives by "
            "that are not known: use contact.Isolated() or contact.Periodic()",
            "interaction",
        )
    if scene.control_object.held(scene) is None:
        raise SceneError(
            f"the control {scene.control[0]}: derivatives are known at a given load, mean "
            "pressure, approach, half width or contact fraction",
            "control",
        )
    if isinstance(fields, FullFields) and scene.given_fraction is not None:
        raise SceneError(
            "full contact under a given contact fraction: state the load instead", "control"
        )
