"""The parabola f = x^2/2R in a row of period L by the localization principle: equations (28)-(30)."""

from dataclasses import dataclass

from contact.paper.one_zone import OneZone
from contact.reference.exact import HertzLine, PeriodicParabola
from contact.reference.exact.localized import FIRST_ORDER


@dataclass(frozen=True)
class LocalizedParabola(OneZone):
    """(29)-(30), Goryacheva & Tsukanov (2020), s = sqrt(L^2 - 4a^2)/L:

    (29) p = (E*/2R) sqrt(a^2 - x^2) + (E* a^2/2RL) arctan(2 sqrt(a^2 - x^2)/(L s)),
    (30) P = (pi E* a^2/4R) (2 - s),

    both first-order. The exact pressure, which the paper says is not known in closed form, is that of `PeriodicParabola`.
    """

    radius: float
    period: float
    E_star: float
    half_width: float
    closure: str = FIRST_ORDER
    _family = HertzLine
    _shape = "radius"

    @property
    def isolated(self) -> HertzLine:
        """Hertz."""
        return HertzLine(self.radius, self.E_star, self.half_width)

    @property
    def exact(self) -> PeriodicParabola:
        """(28), Kuznetsov (1976), with its pressure."""
        return PeriodicParabola(self.radius, self.period, self.E_star, self.half_width)
