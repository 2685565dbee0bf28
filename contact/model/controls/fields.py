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
                self.name,
                self.value,
                "left out, since a profile without a period has no mean pressure",
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
                f"left out, unless the {scene.interaction.name} interaction is given a datum: "
                f"without a datum, the approach is not defined on a {scene.substrate.name}"
            )
            raise SceneError.of(self.name, self.value, allowed)


@register_control("contact_fraction")
@dataclass(frozen=True)
class ContactFraction(Control):
    """Contact fraction [1]: the width in contact divided by the period, above 0 and at most 1."""

    def check(self, scene: Any) -> None:
        if scene.period is None:
            raise SceneError.of(
                self.name,
                self.value,
                f"left out, since a contact under the {scene.interaction.name} interaction has no "
                "period",
            )
        if self.value > 1.0:
            raise SceneError.of(self.name, self.value, "above 0 and at most 1")
        if scene.is_flat:
            allowed = (
                f"left out, since the {scene.profile.name} profile has the same contact width "
                "under any load: give a load"
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
                turning, value, "left out, since half_width means one zone centred at x = 0"
            )
        if not profile.symmetric:
            self._refuse(
                "left out, since half_width means one zone centred at x = 0, and the "
                f"{profile.name} profile is not known to be symmetric"
            )
        if profile.period is not None and not self.value < 0.5 * profile.period:
            self._refuse(f"less than half the period, {0.5 * profile.period:.17g}")
        if profile.support is None:
            return
        reach = profile.support[1]
        if self.value >= reach:
            self._refuse(
                f"less than the half width of the profile, {reach:.17g} m, which the contact has "
                "under any sufficiently large load"
            )
        if scene.is_flat_between(-self.value, self.value):
            self._refuse(
                f"left out, since the {profile.name} profile is flat up to this half width or "
                "beyond, and every load gives a wider zone: give a load"
            )

    def _refuse(self, allowed: str) -> None:
        raise SceneError.of(self.name, self.value, allowed)
