"""A body turned by a small angle about x = 0: the gap at zero load is f(x) - tilt x.

With tilt > 0 the side x > 0 comes down.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from contact.model.profiles.base import Array, Profile, read_from


@dataclass(frozen=True)
class Tilted(Profile):
    """A tilted profile f(x) - tilt x. Of a periodic profile, only a single cell is used."""

    profile: Profile
    tilt: float
    name: ClassVar[str] = "tilted"

    slope_is_derived = read_from("profile.slope_is_derived")
    support = read_from("profile.support")
    extent = read_from("profile.known")
    resolution = read_from("profile.resolution")
    feature = read_from("profile.feature")

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
        """The rows whose place (first column) lies inside the periodic cell.
        If the profile has no period, these are all rows.

        A periodic profile is cut at the border of its cell, since it is tilted.
        """
        if self.profile.period is None:
            return rows
        lo, hi = self.profile.x0, self.profile.x0 + self.profile.period
        return np.asarray(rows[(rows[:, 0] > lo) & (rows[:, 0] < hi)])
