"""Flat punch with sharp corners (Sadowsky 1928): f = 0 for |x| <= width/2 and +inf beyond."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.checks import keep, positive, positive_or_none
from contact.model.profiles.base import AT_ORIGIN, Array, Profile, read_from
from contact.model.profiles.noise import EPS
from contact.model.registry import register_profile


@register_profile("flat")
@dataclass(frozen=True)
class Flat(Profile):
    """A flat punch with sharp corners; with a period, there is one punch in each cell.

    f = 0 for |x| <= width/2 and +inf outside: the pressure is infinite as 1/sqrt(d) at the corners
    (M. Sadowsky, ZAMM 8, 1928, 107, doi 10.1002/zamm.19280080203).

    Parameters
    ----------
    width : float
        Width of the punch [m].
    period : float or None
        Length [m] after which the punch repeats, larger than the width; None: it stands alone.

    Raises
    ------
    SceneError
        If a length is not a finite positive number, or the period is too short.

    Examples
    --------
    >>> import contact
    >>> contact.Flat(width=2.0).height([0.0, 1.0, 1.1]).tolist()
    [0.0, 0.0, inf]
    """

    width: float
    period: float | None = None
    units = {"width": "m", "period": "m"}
    symmetric = True
    summits = AT_ORIGIN
    resolution = read_from("width")

    def __post_init__(self) -> None:
        keep(self, positive, "width")
        keep(self, positive_or_none, "period")
        if self.period is not None and self.period <= self.width:
            raise SceneError.of("period", self.period, f"larger than the width {self.width!r}")

    def height(self, x: ArrayLike) -> Array:
        x = np.asarray(x, dtype=np.float64)
        # By round-off, the computed place of a corner (middle + half width, plus whole periods) may
        # lie outside the punch. Such a place still counts as part of the punch.
        slack = 4 * EPS * (self.width + np.abs(x))
        return np.where(np.abs(self.wrap(x)) <= self.width / 2 + slack, 0.0, np.inf)

    def slope(self, x: ArrayLike) -> Array:
        """The slope is 0 on the punch. Outside, where there is no surface, the value is 0, too."""
        return np.zeros(np.shape(x))

    @property
    def support(self) -> tuple[float, float]:
        return -self.width / 2, self.width / 2

    @property
    def breakpoints(self) -> Array:
        return np.array(self.support)
