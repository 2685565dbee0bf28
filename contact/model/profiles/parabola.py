"""Parabolic asperity (Hertz line contact), alone or in a row: f(x) = x^2/(2R)."""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from contact.model.checks import keep, positive, positive_or_none
from contact.model.profiles.base import AT_ORIGIN, Array, Profile, read_from
from contact.model.registry import register_profile


@register_profile("parabola")
@dataclass(frozen=True)
class Parabola(Profile):
    """f = x^2/(2 radius) on the cell; if there is a period, there is a corner where two cells
    meet.

    The line contact of H. Hertz (J. reine angew. Math. 92, 1882, 156, doi
    10.1515/9783112342404-004): the half width under the load P is a = sqrt(4 P R / (pi E*)).

    Parameters
    ----------
    radius : float
        Radius of curvature R [m].
    period : float or None
        Length [m] after which the parabola repeats; None: it stands alone.

    Raises
    ------
    SceneError
        If a length is not a finite positive number.

    Examples
    --------
    >>> import contact
    >>> import numpy as np
    >>> scene = contact.Scene(contact.Parabola(radius=1.0), 1e9, contact.Isolated(), load=1e4)
    >>> hertz = contact.solve(scene)
    >>> bool(np.isclose(hertz.zones[0, 1], np.sqrt(4e4 / (np.pi * 1e9)), rtol=1e-10))
    True
    """

    radius: float
    period: float | None = None
    units = {"radius": "m", "period": "m"}
    symmetric = True
    summits = AT_ORIGIN
    resolution = read_from("period")

    def __post_init__(self) -> None:
        keep(self, positive, "radius")
        keep(self, positive_or_none, "period")

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(self.wrap(x) ** 2 / (2 * self.radius))

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(self.wrap(x) / self.radius, dtype=np.float64)

    def slope_conjugate(self, x: ArrayLike) -> Array | None:
        """The Hilbert transform of f', a saw-tooth: -(L/(pi R)) ln(2 |cos(pi x/L)|) with L the
        period and R the radius. It is +inf at the border of the cell.
        """
        if self.period is None:
            return None
        turn = pi * np.asarray(self.wrap(x)) / self.period
        with np.errstate(divide="ignore"):
            return np.asarray(-self.period / (pi * self.radius) * np.log(2 * np.abs(np.cos(turn))))

    @property
    def kinks(self) -> Array:
        return (
            np.empty((0, 2))
            if self.period is None
            else np.array([[self.x0, -self.period / self.radius]])
        )
