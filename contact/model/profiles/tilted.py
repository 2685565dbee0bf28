"""A body turned by a small angle about x = 0: the gap at zero load becomes f(x) - tilt x, so that x
> 0 comes down for tilt > 0.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from contact.model.profiles.base import Array, Profile, told_by


@dataclass(frozen=True)
class Tilted(Profile):
    """f(x) - tilt x of another profile; of a periodic one its cell alone, since what is turned does
    not repeat.
    """

    profile: Profile
    tilt: float
    name: ClassVar[str] = "tilted"

    slope_is_derived = told_by("profile.slope_is_derived")
    support = told_by("profile.support")
    extent = told_by("profile.known")
    resolution = told_by("profile.resolution")
    feature = told_by("profile.feature")

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(np.asarray(self.profile.height(x)) - self.tilt * np.asarray(x))

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(np.asarray(self.profile.slope(x)) - self.tilt)

    @property
    def kinks(self) -> Array:
        return self._within(self.profile.kinks)

    @property
    def jumps(self) -> Array:
        return self._within(self.profile.jumps)

    @property
    def algebraic_points(self) -> Array:
        return self._within(self.profile.algebraic_points)

    @property
    def breakpoints(self) -> Array:
        return self._within(np.asarray(self.profile.breakpoints)[:, None])[:, 0]

    def _within(self, rows: Array) -> Array:
        """Those of the cell that do not stand on its border, beyond which there is another cell no
        more.
        """
        if self.profile.period is None:
            return rows
        lo, hi = self.profile.x0, self.profile.x0 + self.profile.period
        return np.asarray(rows[(rows[:, 0] > lo) & (rows[:, 0] < hi)])
