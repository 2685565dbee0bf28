"""The half width of the one zone of a symmetric profile."""

from dataclasses import dataclass
from typing import Any

from contact.errors import SceneError
from contact.model.controls.base import TURNING, Control, Held, Quantity
from contact.model.registry import register_control


@register_control("half_width")
@dataclass(frozen=True)
class HalfWidth(Control):
    """Half width [m]."""

    unit = "m"

    def check(self, scene: Any) -> None:
        profile = scene.profile
        if scene.turned:
            turning = next(name for name in TURNING if getattr(scene, name) is not None)
            allowed = "0 or left out with half_width, which means one zone about x = 0"
            raise SceneError.of(turning, getattr(scene, turning), allowed)
        if not profile.symmetric:
            self._refuse(f"left out: it means one zone about x = 0, and {profile.name} is not known to be symmetric")
        if profile.period is not None and not self.value < 0.5 * profile.period:
            self._refuse(f"less than half the period, {0.5 * profile.period:.17g}")
        if profile.support is None:
            return
        reach = profile.support[1]
        if self.value >= reach:
            self._refuse(f"less than the profile's own, {reach:.17g}, with which any load from some on is borne")
        if scene.is_flat_between(-self.value, self.value):
            self._refuse(f"left out: {profile.name} has no slope, any load has its half width {reach:.17g}; give a load")

    def _refuse(self, allowed: str) -> None:
        raise SceneError.of(self.name, self.value, allowed)

    def held(self, scene: Any) -> Held:
        return Held(Quantity.HALF_WIDTH, self.value)
