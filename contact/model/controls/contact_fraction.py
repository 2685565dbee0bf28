"""The part of the period in contact."""

from dataclasses import dataclass
from typing import Any

from contact.errors import SceneError
from contact.model.controls.base import Control, Held, Quantity
from contact.model.registry import register_control


@register_control("contact_fraction")
@dataclass(frozen=True)
class ContactFraction(Control):
    """Width in contact over the period [1], above 0 and at most 1."""

    def check(self, scene: Any) -> None:
        if self.value > 1.0:
            raise SceneError.of(self.name, self.value, "above 0 and at most 1")
        if scene.is_flat:
            allowed = f"left out: {scene.profile.name} has no slope, any load has its width; give a load"
            raise SceneError.of(self.name, self.value, allowed)

    def held(self, scene: Any) -> Held:
        return Held(Quantity.WIDTH, self.value * scene.profile.period)
