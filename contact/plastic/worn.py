"""The profile that yielding leaves: f + w, with the overlap w of the plateaus.

The elastic contact of this profile under the same load has the same pressure, so that unloading
begins from this contact. On the plateaus the profile's slope is the slope of the displaced surface,
(2/E*) T p, with the transform T p of the pressure. Outside a plateau, at the distance d from its
end, the pressure is its limit minus |A| sqrt(d), with a constant A. Inside the plateau, at the same
distance, w = (4/3) |A| d^(3/2) / E*.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.profiles.base import Profile, read_from
from contact.plastic.fields import PlasticFields
from contact.solution.solution import Solution
from sie import Array, Mask, wrapped


@dataclass(frozen=True)
class Worn(Profile):
    """The profile that remains after yielding under a load and unloading; see `Solution.worn`.

    Parameters
    ----------
    profile : Profile
        The profile before it yielded.
    fields : PlasticFields
        The fields of the contact under the largest load.
    """

    profile: Profile
    fields: PlasticFields = field(repr=False)
    name: ClassVar[str] = "worn"

    period = read_from("profile.period")  # type: ignore[assignment]
    symmetric = read_from("profile.symmetric")
    extent = read_from("profile.extent")
    x0 = read_from("profile.x0")
    resolution = read_from("profile.resolution")
    feature = read_from("profile.feature")

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(self.profile.height(x)) + self.fields.overlap(x)

    def slope(self, x: ArrayLike) -> Array:
        x = np.asarray(x, dtype=float)
        slope = np.array(self.profile.slope(x), dtype=float)
        inside = self._on_plateaus(x)
        fields = self.fields
        scaled = fields.problem.units.scaled(x[inside])
        slope[inside] = fields.problem.units.slope * fields.density.transform(scaled)
        return slope

    def _on_plateaus(self, x: Array) -> Mask:
        table = self.fields.plateaus
        place = wrapped(x, float(table[0, 0]), self.period)
        i = np.maximum(np.searchsorted(table[:, 0], place, side="right") - 1, 0)
        return np.asarray((place > table[i, 0]) & (place < table[i, 1]))

    @property
    def kinks(self) -> Array:
        return self._outside(self.profile.kinks)

    @property
    def jumps(self) -> Array:
        return self._outside(self.profile.jumps)

    def _outside(self, rows: Array) -> Array:
        """The rows of a table whose place x lies on no plateau.
        On plateaus the old shape has yielded.
        """
        return np.asarray(rows[~self._on_plateaus(rows[:, 0])])

    @cached_property
    def _points(self) -> Array:
        density, units = self.fields.density, self.fields.problem.units
        zones, slopes = density.zones, np.abs(np.array(density.edge_slopes))
        factor = 2 / 3 * slopes * units.height / units.length**1.5
        rows = [
            (end, 1.5, *((0.0, one) if side else (one, 0.0)))
            for side, ends in enumerate((zones.a, zones.b))
            for end, one, value in zip(
                units.x(ends).tolist(), factor[side].tolist(), zones.values[side], strict=True
            )
            if value != 0.0
        ]
        table = np.array(rows).reshape(-1, 4)
        if self.period is not None:
            table[:, 0] = wrapped(table[:, 0], self.x0, self.period)
        return np.asarray(table[np.argsort(table[:, 0])])

    @property
    def algebraic_points(self) -> Array:
        return self._points


def worn(solution: Solution) -> Profile:
    """The profile that remains after unloading; unchanged if nothing has yielded."""
    fields, profile = solution.fields, solution.scene.profile
    if not isinstance(fields, PlasticFields):
        return profile
    if profile.support is not None:
        raise SceneError(
            "the body has yielded at its sharp corners: Solution.worn() cannot represent the "
            "profile that remains; use a profile without sharp corners",
            "profile",
            profile,
        )
    if fields.density.zones.depth.any():
        raise SceneError(
            "the pressure falls from the hardness to zero over a length that is not resolved, and "
            "the slope of the remaining profile rises there like a logarithm: Solution.worn() "
            "cannot represent it; use a less steep profile",
            "profile",
            profile,
        )
    return Worn(profile, fields)
