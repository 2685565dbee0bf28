"""The load, as such or by the mean pressure."""

from dataclasses import dataclass
from typing import Any

from contact.errors import SceneError
from contact.model.controls.base import Control, Held, Quantity
from contact.model.registry import register_control


@register_control("load")
@dataclass(frozen=True)
class Load(Control):
    """Load [N/m], per period where there is one."""

    unit = "N/m"

    def signed(self, scene: Any) -> bool:
        return bool(scene.law.pulls)

    def held(self, scene: Any) -> Held:
        return Held(Quantity.LOAD, self.value)


@register_control("mean_pressure")
@dataclass(frozen=True)
class MeanPressure(Control):
    """Load over the profile's period [Pa]."""

    unit = "Pa"

    def signed(self, scene: Any) -> bool:
        return bool(scene.law.pulls)

    def check(self, scene: Any) -> None:
        if scene.profile.period is None:
            raise SceneError.of(self.name, self.value, "left out: without a period there is no mean pressure")

    def held(self, scene: Any) -> Held:
        return Held(Quantity.LOAD, self.value * scene.profile.period)
