"""Two parabolic asperities: f(x) = x^4/(8 R c^2) - x^2/(4R) + c^2/(8R).

Goryacheva & Tsukanov 2020, eq. (31), raised so that the tips are at height 0.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.checks import keep, positive, positive_or_none
from contact.model.profiles.base import Array, Profile, read_from
from contact.model.registry import register_profile


@register_profile("biquadratic")
@dataclass(frozen=True)
class Biquadratic(Profile):
    """f = (x^2 - c^2)^2/(8 radius c^2): two tips of this radius at x = c and -c, with spacing =
    2c.

    (I. G. Goryacheva & I. Y. Tsukanov, Front. Mech. Eng. 6:45, 2020, doi 10.3389/fmech.2020.00045,
    eq. (31).)

    Parameters
    ----------
    radius : float
        Radius of curvature [m] of both tips.
    spacing : float
        Distance [m] between the tips.
    period : float or None
        Length [m] after which the two tips repeat, larger than the spacing; None: they stand alone.

    Raises
    ------
    SceneError
        If a length is not a finite positive number, or the period is too short.

    Examples
    --------
    >>> import contact
    >>> pair = contact.Biquadratic(radius=1.0, spacing=0.2)
    >>> pair.height([-0.1, 0.0, 0.1]).round(12).tolist()
    [0.0, 0.00125, 0.0]
    """

    radius: float
    spacing: float
    period: float | None = None
    units = {"radius": "m", "spacing": "m", "period": "m"}
    symmetric = True
    resolution = read_from("spacing")

    def __post_init__(self) -> None:
        keep(self, positive, "radius", "spacing")
        keep(self, positive_or_none, "period")
        if self.period is not None and self.period <= self.spacing:
            raise SceneError.of(
                "period",
                self.period,
                f"larger than the spacing {self.spacing!r}, so that one period holds both tips",
            )

    def height(self, x: ArrayLike) -> Array:
        c = self.spacing / 2
        w = self.wrap(x)
        return np.asarray(((w - c) * (w + c) / c) ** 2 / (8 * self.radius))

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(self._slope_in_cell(np.asarray(self.wrap(x), dtype=np.float64)))

    def _slope_in_cell(self, w: Any) -> Any:
        c = self.spacing / 2
        return w * (w - c) * (w + c) * (0.5 / self.radius / c / c)

    @property
    def kinks(self) -> Array:
        if self.period is None:
            return np.empty((0, 2))
        # By symmetry, the slope left of the border between two cells is minus the slope right of
        # it. The jump of the slope is therefore twice the slope on the right.
        return np.array([[self.x0, 2 * self._slope_in_cell(self.x0)]])

    @property
    def jumps(self) -> Array:
        """The jump of the third derivative f''' = 3x/(R c^2) where the cells meet.

        R is the radius, and c half the spacing. The second derivative has no jump.
        """
        if self.period is None:
            return np.empty((0, 3))
        c = self.spacing / 2
        return np.array([[self.x0, 3.0, 6 * self.x0 / c / c / self.radius]])

    @property
    def summits(self) -> Array:
        return np.array([-self.spacing / 2, self.spacing / 2])
