"""Blunt wedge, alone or in a row: f(x) = slope |x| (Goryacheva & Tsukanov 2020, eq. 24-26)."""

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.model.checks import positive, positive_or_none
from contact.model.profiles.base import AT_ORIGIN, Array, Profile, read_from
from contact.model.registry import register_profile


@register_profile("wedge")
@dataclass(frozen=True, init=False, repr=False)
class Wedge(Profile):
    """f = slope |x| on the cell; if there is a period, there is a sharp valley where two cells
    meet.

    The parameter is called `slope`; it is stored as `tangent` because `slope(x)` is f' for every
    profile.

    Parameters
    ----------
    slope : float
        Tangent [1] of the small angle between flank and counter-face.
    period : float or None
        Length [m] after which the wedge repeats; None: it stands alone.

    Raises
    ------
    SceneError
        If one of them is not a finite positive number.

    Examples
    --------
    The half width of a lone wedge is load / (E* slope) (K. L. Johnson, Contact Mechanics, 1985, doi
    10.1017/CBO9781139171731, section 5.2).

    >>> import contact
    >>> scene = contact.Scene(contact.Wedge(slope=0.1), 1e9, contact.Isolated(), load=1e3)
    >>> wedge = contact.solve(scene)
    >>> float(wedge.zones[0, 1].round(12))
    1e-05
    """

    tangent: float
    period: float | None = None
    units = {"slope": "1", "period": "m"}
    symmetric = True
    summits = AT_ORIGIN
    resolution = read_from("period")

    def __init__(self, slope: float, period: float | None = None) -> None:
        object.__setattr__(self, "tangent", positive("slope", slope))
        object.__setattr__(self, "period", positive_or_none("period", period))

    def __repr__(self) -> str:
        return f"Wedge(slope={self.tangent!r}, period={self.period!r})"

    def parameters(self) -> dict[str, Any]:
        return {"slope": self.tangent, "period": self.period}

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(self.tangent * np.abs(self.wrap(x)), dtype=np.float64)

    def slope(self, x: ArrayLike) -> Array:
        # Adding 0.0 turns -0.0 into 0.0, so that the slope is the same at x = -0.0 and x = 0.0.
        return np.asarray(
            np.copysign(self.tangent, np.asarray(self.wrap(x), dtype=np.float64) + 0.0)
        )

    def slope_conjugate(self, x: ArrayLike) -> Array | None:
        """The Hilbert transform of f': (2 slope/pi) ln|tan(pi x/L)| with L the period; -inf at the
        tip, +inf at the valley.
        """
        if self.period is None:
            return None
        turn = pi * np.asarray(self.wrap(x)) / self.period
        with np.errstate(divide="ignore"):
            return np.asarray(
                2
                * self.tangent
                / pi
                * (np.log(np.abs(np.sin(turn))) - np.log(np.abs(np.cos(turn))))
            )

    @property
    def kinks(self) -> Array:
        tip = [0.0, 2 * self.tangent]
        return np.array([tip] if self.period is None else [[self.x0, -2 * self.tangent], tip])
