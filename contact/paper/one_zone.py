"""What the paper's three one-zone examples share: the isolated solution of a family, corrected by (16)-(17).

With P0 the isolated load at half-width a and s = sqrt(L^2 - 4a^2)/L, the two readings of P_s in (16) are

    first-order       P_s = P0,  P = P0 (2 - s)      (23), (27), (30) of the paper's examples,
    self-consistent   P_s = P,   P = P0/s            (16) solved for P = P_s.

Every example knows the exact solution of the same half-width, which the errors are measured by.
"""

from typing import Any, Self

import numpy as np

from contact.model.checks import positive
from contact.reference.exact import PeriodicParabola, PeriodicWedge, Westergaard, localized_at_load
from contact.reference.exact.localized import FIRST_ORDER, Localized
from contact.reference.exact.parabola import HertzLine
from contact.reference.exact.sinusoid import IsolatedSinusoid
from contact.reference.exact.wedge import IsolatedWedge

Isolated = HertzLine | IsolatedWedge | IsolatedSinusoid
Periodic = PeriodicParabola | PeriodicWedge | Westergaard


class OneZone(Localized):
    """Base of the frozen dataclasses of the examples; a family gives `isolated` and `exact`."""

    _family: type[HertzLine] | type[IsolatedWedge] | type[IsolatedSinusoid]
    _shape: str

    @property
    def isolated(self) -> Isolated:
        """The isolated solution of the same half-width."""
        raise NotImplementedError

    @property
    def exact(self) -> Periodic:
        """The exact periodic solution of the same half-width."""
        raise NotImplementedError

    @classmethod
    def from_load(cls, load: float, *, period: float, E_star: float, closure: str = FIRST_ORDER, **shape: float) -> Self:
        """The solution at a load per period, on the branch from zero load; OutOfRange past its end."""
        zone = localized_at_load(cls._family, load, period, closure, E_star=E_star, **shape)
        fields: dict[str, Any] = {cls._shape: shape[cls._shape], "closure": closure}
        return cls(period=period, E_star=E_star, half_width=zone.half_width, **fields)  # type: ignore[call-arg]

    @classmethod
    def from_mean_pressure(cls, mean_pressure: float, *, period: float, **shape: Any) -> Self:
        """The solution at a mean pressure."""
        return cls.from_load(positive("mean_pressure", mean_pressure) * period, period=period, **shape)

    @property
    def load_error(self) -> float:
        """P/P_exact - 1 at the same half-width."""
        return self.load / self.exact.load - 1.0

    @property
    def isolated_load_error(self) -> float:
        """P0/P_exact - 1 at the same half-width: what leaving the neighbours out costs."""
        return self.isolated.load / self.exact.load - 1.0

    @property
    def peak_error(self) -> float:
        """p(0)/p_exact(0) - 1 at the same half-width; nan under a sharp tip."""
        if not np.isfinite(self.max_pressure):
            return float("nan")
        return self.max_pressure / self.exact.max_pressure - 1.0
