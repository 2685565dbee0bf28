"""The paper's three one-zone examples of the localization principle.

They are the sinusoid f = Delta (1 - cos(2 pi x/L)), equations (18)-(24); the wedge f = tan(beta)
|x|, (25)-(27); and the parabola f = x^2/2R, (28)-(30), each in a row of period L. The isolated
solution is corrected by (16)-(17). With P0 the isolated load at half-width a and s = sqrt(L^2 -
4a^2)/L, the load P_s in (16) can be read in two ways:

    first-order       P_s = P0,  P = P0 (2 - s)      (23), (27), (30) of the paper's examples,
    self-consistent   P_s = P,   P = P0/s            (16) solved for P = P_s.

Each example gives its errors against the exact periodic solution of the same half-width.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.reference.exact.localized import FIRST_ORDER, LocalizedZone
from contact.reference.exact.parabola import HertzLine, PeriodicParabola
from contact.reference.exact.sinusoid import IsolatedSinusoid, Westergaard
from contact.reference.exact.wedge import IsolatedWedge, PeriodicWedge

Periodic = PeriodicParabola | PeriodicWedge | Westergaard

# For each isolated solution: the exact periodic solution, and the name of its parameter that gives
# the size of the profile.
_EXACT: dict[type, tuple[type[Periodic], str]] = {
    HertzLine: (PeriodicParabola, "radius"),
    IsolatedWedge: (PeriodicWedge, "wedge_slope"),
    IsolatedSinusoid: (Westergaard, "amplitude"),
}


@dataclass(frozen=True)
class OneZone(LocalizedZone):
    """A localized zone, compared with the exact periodic solution of the same half-width."""

    @property
    def exact(self) -> Periodic:
        """The exact periodic solution that has the same half width of the zone.

        Equations (18)-(19), Westergaard (1939); (25), Block & Keer (2008); (28), Kuznetsov (1976).
        """
        made, size = _EXACT[type(self.isolated)]
        given: dict[str, Any] = {size: getattr(self.isolated, size)}
        return made(period=self.period, E_star=self.E_star, half_width=self.half_width, **given)

    @property
    def load_error(self) -> float:
        """Relative error of the load at the same half-width: load / exact load - 1."""
        return self.load / self.exact.load - 1.0

    @property
    def isolated_load_error(self) -> float:
        """Relative error of the load of the isolated solution, which ignores the neighbours.

        It is isolated load / exact load - 1 at the same half-width.
        """
        return self.isolated.load / self.exact.load - 1.0

    @property
    def peak_error(self) -> float:
        """Relative error of the pressure at x = 0, at the same half-width; nan under a sharp tip.

        It is p(0) / exact p(0) - 1.
        """
        if not np.isfinite(self.max_pressure):
            return float("nan")
        return self.max_pressure / self.exact.max_pressure - 1.0


def localized_wave(
    amplitude: float, period: float, E_star: float, half_width: float, closure: str = FIRST_ORDER
) -> OneZone:
    """The localized zone of a sinusoid, equations (20)-(24) of the paper.

    With k = 2 pi/L and s = sqrt(L^2 - 4a^2)/L,

    (20) p0 = (2 pi Delta E*/L) sqrt(1 - t^2) sum (-1)^j J_(2j+1)(ka) U_2j(t),  t = x/a,
    (23) mean pressure = (pi^2 Delta E*/L^2) a J_1(ka) (2 - s),
    (24) p(0) = (pi Delta E*/L) int_0^ka J_0 + (2 pi Delta E*/L^2) a J_1(ka) arctan(2a/(L s)),

    (23) and (24) hold for the first-order closure. Raises OutOfRange if the pressure would be
    negative at the ends. Source: Goryacheva & Tsukanov (2020).
    """
    return OneZone(IsolatedSinusoid(amplitude, period, E_star, half_width), period, closure)


def localized_wedge(
    wedge_slope: float, period: float, E_star: float, half_width: float, closure: str = FIRST_ORDER
) -> OneZone:
    """The localized zone of a wedge, equations (26)-(27) of the paper.

    With `wedge_slope` = tan(beta) and s = sqrt(L^2 - 4a^2)/L,

    (26) p = (E* tan(beta)/pi) arcosh(a/|x|)
             + (2 E* a tan(beta)/pi L) arctan(2 sqrt(a^2 - x^2)/(L s)),
    (27) mean pressure = (E* a tan(beta)/L) (2 - s),

    both for the first-order closure. Source: Goryacheva & Tsukanov (2020).
    """
    return OneZone(IsolatedWedge(wedge_slope, E_star, half_width), period, closure)


def localized_parabola(
    radius: float, period: float, E_star: float, half_width: float, closure: str = FIRST_ORDER
) -> OneZone:
    """The localized zone of a parabola, equations (29)-(30) of the paper.

    With s = sqrt(L^2 - 4a^2)/L,

    (29) p = (E*/2R) sqrt(a^2 - x^2) + (E* a^2/2RL) arctan(2 sqrt(a^2 - x^2)/(L s)),
    (30) P = (pi E* a^2/4R) (2 - s),

    both for the first-order closure. Source: Goryacheva & Tsukanov (2020). The paper says that the
    exact pressure is not known in closed form; `PeriodicParabola` gives it.
    """
    return OneZone(HertzLine(radius, E_star, half_width), period, closure)
