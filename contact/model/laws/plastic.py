"""A limit of the pressure: 0 <= p <= hardness, the law of a body that yields at its surface.

Where the pressure reaches the hardness H, the surfaces overlap: there the body has yielded by

    w = approach - f - u >= 0,

f the profile and u the elastic displacement. Of all pressures with 0 <= p <= H, the pressure is the
one with the least complementary energy; there is only one such pressure. The law holds for first
loading and has no memory: for unloading, the plastically deformed profile makes another scene.
B. N. J. Persson's theory and most codes for rough contact use the same limit.
"""

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

from contact.model.checks import keep, positive
from contact.model.laws.base import Law, PressureRange, Routes
from contact.model.laws.frictionless import Frictionless
from contact.model.registry import register_law
from contact.model.substrates.half_plane import HalfPlane


@register_law("plastic")
@dataclass(frozen=True)
class Plastic(Law):
    """Contact without friction or adhesion in which the pressure is at most the hardness.

    Parameters
    ----------
    hardness : float
        The largest pressure [Pa] that the softer body bears, about three times its yield strength.

    Examples
    --------
    A wave under a load at which half of the pressure's peak is cut off.

    >>> import contact
    >>> wave, law = contact.Sinusoid(amplitude=1e-6, period=1e-4), contact.Plastic(hardness=2.4e7)
    >>> scene = contact.Scene(wave, 1e9, contact.Periodic(), law=law, mean_pressure=1e7)
    >>> solution = contact.solve(scene)
    >>> solution.plateaus.shape, float(solution.pressure(0.0)), bool(solution.overlap(0.0) > 0.0)
    ((1, 2), 24000000.0, True)
    """

    hardness: float
    units = {"hardness": "Pa"}

    convex = True

    def __post_init__(self) -> None:
        keep(self, positive, "hardness")

    @cached_property
    def pressure_range(self) -> PressureRange:
        return PressureRange(0.0, self.hardness)

    @cached_property
    def routes(self) -> Routes:
        return Routes(False, False, "contact.plastic.search", first=Frictionless())

    def refuses(self, scene: Any) -> str | None:
        if scene.interaction.strip or scene.interaction.follows_isolated:
            return (
                f"is not solved with the {scene.interaction.name} interaction: use "
                "contact.Isolated() or contact.Periodic()"
            )
        if not isinstance(scene.substrate, HalfPlane) or scene.operator.is_own:
            return "is solved only for half-planes, without a kernel or symbol of your own"
        if scene.turned:
            return "is not solved for tilted bodies: leave out tilt and moment"
        if len(scene.profile.algebraic_points):
            return (
                f"is not solved for the {scene.profile.name} profile, whose slope is a power of "
                "the distance from a point"
            )
        load, width = scene.given_load, bearing_width(scene)
        if load is not None and not load < self.hardness * width:
            return (
                f"bears less than its hardness of {self.hardness:.6g} Pa on the width of "
                f"{width:.6g} m, but the load gives a mean of {load / width:.6g} Pa: give a "
                "smaller load or a larger hardness"
            )
        return None


def bearing_width(scene: Any) -> float:
    """Width [m] of the surface that can bear pressure.
    It is the distance between the sharp corners of a punch, else the period, else infinite.
    """
    support, period = scene.profile.support, scene.period
    if support is not None:
        return float(support[1] - support[0])
    return inf if period is None else float(period)
