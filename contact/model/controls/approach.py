"""The approach of the bodies."""

from dataclasses import dataclass
from typing import Any

from contact.errors import SceneError
from contact.model.controls.base import Control, Held, Quantity
from contact.model.registry import register_control


@register_control("approach")
@dataclass(frozen=True)
class Approach(Control):
    """Approach [m]; needs a datum where nothing repeats."""

    unit = "m"

    def signed(self, scene: Any) -> bool:
        # A turned body touches at some other place than its lowest: there the approach counts from there. Adhesion bears tension.
        return bool(scene.turned or scene.law.pulls)

    def check(self, scene: Any) -> None:
        if not scene.operator.has_approach:
            allowed = f"left out, or {scene.interaction.name} given a datum: without one a {scene.substrate.name} has no approach"
            raise SceneError.of(self.name, self.value, allowed)

    def held(self, scene: Any) -> Held:
        return Held(Quantity.APPROACH, self.value)
