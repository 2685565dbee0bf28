"""The wedge f = tan(beta) |x| in a row of period L by the localization principle: equations (25)-(27)."""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from contact.paper.one_zone import OneZone
from contact.reference.exact import PeriodicWedge
from contact.reference.exact.base import Array
from contact.reference.exact.localized import FIRST_ORDER
from contact.reference.exact.wedge import IsolatedWedge


@dataclass(frozen=True)
class LocalizedWedge(OneZone):
    """(26)-(27), Goryacheva & Tsukanov (2020), wedge_slope = tan(beta), s = sqrt(L^2 - 4a^2)/L:

    (26) p = (E* tan(beta)/pi) arcosh(a/|x|) + (2 E* a tan(beta)/pi L) arctan(2 sqrt(a^2 - x^2)/(L s)),
    (27) mean pressure = (E* a tan(beta)/L) (2 - s),

    both first-order.
    """

    wedge_slope: float
    period: float
    E_star: float
    half_width: float
    closure: str = FIRST_ORDER
    _family = IsolatedWedge
    _shape = "wedge_slope"

    @property
    def isolated(self) -> IsolatedWedge:
        return IsolatedWedge(self.wedge_slope, self.E_star, self.half_width)

    @property
    def exact(self) -> PeriodicWedge:
        """(25), Block & Keer (2008)."""
        return PeriodicWedge(self.wedge_slope, self.period, self.E_star, self.half_width)


@dataclass(frozen=True)
class PrintedLocalizedWedge(LocalizedWedge):
    """(26) as printed, arcosh(a/x): the same for x > 0, and not a number for x < 0."""

    def pressure(self, x: ArrayLike) -> Array:
        """(26) as printed; nan on the left half of the zone."""
        x = np.asarray(x, dtype=float)
        inside = np.abs(x) < self.half_width
        with np.errstate(divide="ignore", invalid="ignore"):
            own = np.arccosh(np.where(inside, self.half_width / x, 1.0))
        alone = self.E_star * self.wedge_slope / pi
        return np.where(inside, alone * own + (super().pressure(x) - self.isolated.pressure(x)), 0.0)
