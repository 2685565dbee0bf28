"""`Reflected`: the mirror image f(-x) of a profile, or its negative -f(x)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

import contact
import sie

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Reflected(contact.Profile):
    """The profile f(-x), or -f(x) if `upside_down`. The latter needs a profile without corners."""

    profile: contact.Profile
    upside_down: bool = False

    @property
    def _x(self) -> float:
        return 1.0 if self.upside_down else -1.0

    @property
    def _f(self) -> float:
        return -1.0 if self.upside_down else 1.0

    @property
    def period(self) -> float | None:  # type: ignore[override]
        return self.profile.period

    @property
    def x0(self) -> float:
        first = self.profile.x0
        return first if self.period is None or self.upside_down else -first - self.period

    def height(self, x: ArrayLike) -> Array:
        return self._f * np.asarray(self.profile.height(self._x * np.asarray(x)))

    def slope(self, x: ArrayLike) -> Array:
        return self._f * self._x * np.asarray(self.profile.slope(self._x * np.asarray(x)))

    @property
    def kinks(self) -> Array:
        return self._placed(self.profile.kinks) * [1.0, self._f]

    @property
    def jumps(self) -> Array:
        rows = self._placed(self.profile.jumps)
        # Mirroring changes the sign of a jump of the second derivative, but not of the third.
        rows[:, 2] *= np.where(rows[:, 1] == 2, self._f * self._x, self._f)
        return rows

    @property
    def algebraic_points(self) -> Array:
        rows = self._placed(self.profile.algebraic_points) * [1.0, 1.0, self._f, self._f]
        return rows if self.upside_down else rows[:, [0, 1, 3, 2]]

    @property
    def support(self) -> tuple[float, float] | None:
        return self._interval(self.profile.support)

    @property
    def extent(self) -> tuple[float, float] | None:
        return self._interval(self.profile.extent)

    @property
    def resolution(self) -> float | None:
        return self.profile.resolution

    def _placed(self, rows: Array) -> Array:
        """A table of the profile with reflected places in its first column, in ascending order."""
        rows = np.array(rows, dtype=float)
        rows[:, 0] *= self._x
        if self.period is not None:
            rows[:, 0] = sie.wrapped(rows[:, 0], self.x0, self.period)
        return rows[np.argsort(rows[:, 0])]

    def _interval(self, ends: tuple[float, float] | None) -> tuple[float, float] | None:
        return (
            None
            if ends is None
            else (min(self._x * e for e in ends), max(self._x * e for e in ends))
        )
