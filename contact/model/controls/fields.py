"""The controls that are fields of a scene.

They are load, mean pressure, approach, contact fraction and half width.
"""

from dataclasses import dataclass
from typing import Any

from contact.errors import SceneError
from contact.model.controls.base import Control, Held, Quantity
from contact.model.registry import register_control


@register_control("load")
@dataclass(frozen=True)
class Load(Control):
    """Load [N/m]; in a periodic contact, the load on one period."""

    unit = "N/m"
    quantity = Quantity.LOAD

    def signed(self, scene: Any) -> bool:
        return scene.law.pressure_range.has_tension


@register_control("mean_pressure")
@dataclass(frozen=True)
class MeanPressure(Control):
    """Mean pressure [Pa]: the load on one period, divided by the period."""

    unit = "Pa"

    def signed(self, scene: Any) -> bool:
        return scene.law.pressure_range.has_tension

    def check(self, scene: Any) -> None:
        if scene.profile.period is None:
            raise SceneError.of(
                self.name, self.value, "left out: without a period there is no mean pressure"
            )

    def held(self, scene: Any) -> Held:
        return Held(Quantity.LOAD, self.value * scene.profile.period)


@register_control("approach")
@dataclass(frozen=True)
class Approach(Control):
    """Approach of the bodies [m]. Without a period, the approach needs a datum or a body with a
    base.
    """

    unit = "m"
    quantity = Quantity.APPROACH

    def signed(self, scene: Any) -> bool:
        # The approach may be zero or negative in two cases. A tilted body may touch elsewhere than
        # at its lowest point, from which the approach counts. An adhesive contact can carry
        # tension.
        return bool(scene.turned or scene.law.pressure_range.has_tension)

    def check(self, scene: Any) -> None:
        if not scene.operator.has_approach:
            allowed = (
                f"left out, or {scene.interaction.name} given a datum: without one a "
                f"{scene.substrate.name} has no approach"
            )
            raise SceneError.of(self.name, self.value, allowed)


@register_control("contact_fraction")
@dataclass(frozen=True)
class ContactFraction(Control):
    """Contact fraction [1]: the width in contact divided by the period, above 0 and at most 1."""

    def check(self, scene: Any) -> None:
        if scene.period is None:
            raise SceneError.of(
                self.name, self.value, f"left out: under {scene.interaction.name} nothing repeats"
            )
        if self.value > 1.0:
            raise SceneError.of(self.name, self.value, "above 0 and at most 1")
        if scene.is_flat:
            allowed = (
                f"left out: {scene.profile.name} has no slope, any load has its width; give a load"
            )
            raise SceneError.of(self.name, self.value, allowed)

    def held(self, scene: Any) -> Held:
        return Held(Quantity.WIDTH, self.value * scene.profile.period)


@register_control("half_width")
@dataclass(frozen=True)
class HalfWidth(Control):
    """Half width [m] of a single zone about x = 0."""

    unit = "m"
    quantity = Quantity.HALF_WIDTH

    def check(self, scene: Any) -> None:
        profile = scene.profile
        if scene.turned:
            ((turning, value),) = scene.turning.items()
            raise SceneError.of(
                turning, value, "0 or left out with half_width, which means one zone about x = 0"
            )
        if not profile.symmetric:
            self._refuse(
                f"left out: it means one zone about x = 0, and {profile.name} is not known to be "
                "symmetric"
            )
        if profile.period is not None and not self.value < 0.5 * profile.period:
            self._refuse(f"less than half the period, {0.5 * profile.period:.17g}")
        if profile.support is None:
            return
        reach = profile.support[1]
        if self.value >= reach:
            self._refuse(
                f"less than the profile's own, {reach:.17g}, with which any load from some on is "
                "borne"
            )
        if scene.is_flat_between(-self.value, self.value):
            self._refuse(
                f"left out: {profile.name} has no slope, any load has its half width "
                f"{reach:.17g}; give a load"
            )

    def _refuse(self, allowed: str) -> None:
        raise SceneError.of(self.name, self.value, allowed)
