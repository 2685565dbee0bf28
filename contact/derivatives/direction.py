"""`Direction`: a change of a profile, as a profile of its own.

The derivative of a contact by a parameter of its profile is again a contact field. Its equation has
the slope of the change on the right side. So a change has all that a profile has: height, slope,
kinks and jumps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.formulation.relief import period_samples
from contact.formulation.tolerances import TOLERANCES
from contact.model.profiles.base import Array, Profile
from contact.model.profiles.derive import DETAIL
from contact.model.profiles.noise import EPS

Function = Callable[[Array], Array]


class MovedPlaces(Exception):
    """Raised if a parameter moves kinks, jumps or corners, so that differences of heights fail."""


# Step of the differences by a parameter, divided by the parameter. Their round-off, EPS divided by
# this step, is 1e-13. Their truncation is the eighth power of (this step times the relative change
# of a height by the parameter). It is 1e-11 for |x|^n at |x| = 1e-4, where the exponent n changes
# the height by the factor ln|x|.
STEP = EPS ** (1 / 6)
# Steps of the differences, divided by the parameter, for a profile that is linear in the parameter.
# The difference is then exact, and a larger step gives less round-off. The smaller step is for
# parameters for which a value far away is not allowed.
LINEAR_STEPS = (2.0**10, 0.5)

# Weights of the central difference of order 8 at the steps 1, 2, 3, 4 (B. Fornberg, Math. Comp. 51,
# 1988, 699-706).
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)


@dataclass(frozen=True, eq=False)
class Given(Profile):
    """A smooth change of a profile's heights, given by functions of x for height and slope."""

    dheight: Function
    dslope: Function
    name = "given change"

    def height(self, x: ArrayLike) -> Array:
        at = np.asarray(self.wrap(np.asarray(x, dtype=float)))
        return np.asarray(self.dheight(at), dtype=float) + np.zeros(at.shape)

    def slope(self, x: ArrayLike) -> Array:
        at = np.asarray(self.wrap(np.asarray(x, dtype=float)))
        return np.asarray(self.dslope(at), dtype=float) + np.zeros(at.shape)


@dataclass(frozen=True, eq=False)
class Direction(Profile):
    """A change of a profile, as a sum of weights times other profiles.
    The change has the period and the corners of the profile `like`.

    stretch: a factor for each part. At a place x of the cell, the part is taken at x times its
    factor, see `by_period`.
    """

    like: Profile
    parts: tuple[Profile, ...]
    weights: tuple[float, ...]
    stretch: tuple[float, ...] = ()
    name = "change"

    def __post_init__(self) -> None:
        object.__setattr__(self, "period", self.like.period)

    @classmethod
    def given(cls, like: Profile, dheight: Any, dslope: Any) -> Direction:
        """A change of heights that the user gives: functions for height and slope, or a profile."""
        if isinstance(dheight, Profile):
            if dslope is not None:
                raise SceneError.of("dslope", dslope, "left out if dheight is a contact.Profile")
            if dheight.period not in (None, like.period):
                raise SceneError.of("dheight.period", dheight.period, f"{like.period} or None")
            return cls(like, (dheight,), (1.0,))
        for name, one in (("dheight", dheight), ("dslope", dslope)):
            if not callable(one):
                raise SceneError.of(
                    name, one, "a function of x [m], or dheight must be a contact.Profile"
                )
        change = Given(dheight, dslope)
        object.__setattr__(change, "period", like.period)
        object.__setattr__(change, "_cell", like.x0)
        return cls(like, (change,), (1.0,))

    @classmethod
    def itself(cls, like: Profile) -> Direction:
        """The change in which all heights of the profile `like` grow in proportion."""
        return cls(like, (like,), (1.0,))

    @classmethod
    def none(cls, like: Profile) -> Direction:
        """The change that is zero everywhere."""
        return cls(like, (), ())

    @property
    def x0(self) -> float:
        return self.like.x0

    @property
    def support(self) -> tuple[float, float] | None:
        return self.like.support

    @property
    def extent(self) -> tuple[float, float] | None:
        return self.like.extent

    @property
    def resolution(self) -> float | None:
        return self.like.resolution

    @property
    def feature(self) -> float | None:
        return self.like.feature

    @property
    def slope_rounding(self) -> float:  # type: ignore[override]
        return float(
            sum(
                abs(weight) * (part.slope_rounding + 8 * EPS * part.slope_sizes[0])
                for weight, part in zip(self.weights, self.parts, strict=True)
            )
        )

    @property
    def is_round_off(self) -> bool:
        """Whether the change differs from a constant only by round-off of its parts."""
        x = places_of(self.like)
        parts = [np.asarray(part.height(x)) for part in self.parts]
        sizes = (
            abs(weight) * float(np.ptp(part[np.isfinite(part)]))
            for weight, part in zip(self.weights, parts, strict=True)
        )
        height = self.height(x)
        return float(np.ptp(height[np.isfinite(height)])) <= TOLERANCES.apart_rounding * sum(sizes)

    def _sum(self, x: ArrayLike, of: Callable[[Profile, Array], Array], power: int) -> Array:
        """Sum of weight * stretch**power * of(part, stretched x) over the parts.
        The exponent `power` is the order of the derivative.
        """
        at = np.asarray(x, dtype=float)
        out = np.zeros(at.shape)
        factors = self.stretch or (1.0,) * len(self.parts)
        if self.stretch:
            at = np.asarray(self.wrap(at))
        for part, weight, factor in zip(self.parts, self.weights, factors, strict=True):
            out = out + weight * factor**power * np.asarray(of(part, at * factor))
        return np.asarray(out)

    def height(self, x: ArrayLike) -> Array:
        return self._sum(x, lambda part, at: np.asarray(part.height(at)), 0)

    def slope(self, x: ArrayLike) -> Array:
        return self._sum(x, lambda part, at: np.asarray(part.slope(at)), 1)

    def slope_conjugate(self, x: ArrayLike) -> Array | None:
        at = np.asarray(x, dtype=float)
        some = [part.slope_conjugate(at) for part in self.parts]
        if any(one is None for one in some):
            return None
        return self._sum(at, lambda part, at: np.asarray(part.slope_conjugate(at)), 1)

    @cached_property
    def kinks(self) -> Array:
        return self._rows(lambda part: part.kinks, 1)

    @cached_property
    def jumps(self) -> Array:
        return self._rows(lambda part: part.jumps, 2)

    @cached_property
    def algebraic_points(self) -> Array:
        tables = [np.array(part.algebraic_points, dtype=float) for part in self.parts]
        for table, weight, factor in zip(
            tables, self.weights, self.stretch or (1.0,) * len(tables), strict=True
        ):
            table[:, 0] /= factor
            table[:, 2:] *= weight * factor ** table[:, 1:2]
        _same_places(self.like, [table[:, 0] for table in tables])
        return np.concatenate([np.empty((0, 4)), *tables])

    def _rows(self, of: Callable[[Profile], Array], value: int) -> Array:
        """Table of the kinks (or jumps) of the change; column 0 has their places.
        Column `value` has their jumps, summed over the parts. The parts share all other columns.
        """
        tables = [np.array(of(part), dtype=float) for part in self.parts]
        width = value + 1
        if not tables:
            return np.empty((0, width))
        factors = self.stretch or (1.0,) * len(tables)
        for table, factor in zip(tables, factors, strict=True):
            order = table[:, 1] if value == 2 else np.ones(len(table))
            table[:, 0] /= factor
            table[:, value] *= factor**order
        _same_places(self.like, [table[:, 0] for table in tables])
        out = np.array(tables[0])
        out[:, value] = sum(
            (w * table[:, value] for w, table in zip(self.weights, tables, strict=True)),
            np.zeros(len(out)),
        )
        return out

    @classmethod
    def by_parameter(cls, profile: Profile, to: Parameter, x: Array) -> tuple[Direction, float]:
        """Derivative of the heights at fixed x by one parameter, and its relative error.

        x: places [m] at which differences with two different steps are compared.

        Raises
        ------
        MovedPlaces
            If the parameter moves kinks, jumps or corners.
        """
        of = _Varied(profile, to)
        unit = None if to.index is None else profile.unit_of(to.name, to.index)
        if unit is not None:
            return cls(profile, (unit,), (1.0,)), TOLERANCES.rounding
        for step in LINEAR_STEPS:
            try:
                one, other = of.stencil(cls, (0.5,), step), of.stencil(cls, (0.5,), 0.5 * step)
                if _differ(one, other, x) <= TOLERANCES.rounding:  # linear in the parameter
                    _ = one.kinks, one.jumps, one.algebraic_points
                    return one, TOLERANCES.rounding
            except (SceneError, MovedPlaces):  # a value so far away is not allowed
                continue
        one, other = of.stencil(cls, WEIGHTS, STEP), of.stencil(cls, WEIGHTS, 0.5 * STEP)
        return one, _differ(one, other, x)

    @classmethod
    def by_period(cls, profile: Profile) -> Direction:
        """The derivative by ln(period) of the heights at a fixed fraction x / period.

        The cell of every part is stretched to that of the profile, so that no place moves.
        """
        of = _Varied(profile, Parameter("profile.period"))
        found = of.stencil(cls, WEIGHTS, STEP)
        length = profile.period
        assert length is not None
        factors = tuple((part.period or length) / length for part in found.parts)
        weights = tuple(length * weight for weight in found.weights)
        found = replace(found, weights=weights, stretch=factors)
        return cls.none(profile) if found.is_round_off else found


@dataclass(frozen=True)
class Parameter:
    """A parameter of a scene: its key, as "profile.amplitude" in a scene file, and an index.
    The index is that of an entry of an array; None for a number.
    """

    key: str
    index: int | None = None

    @classmethod
    def parsed(cls, to: Any) -> Parameter:
        """The parameter with a name such as "profile.amplitude" or "profile.cosine[2]"."""
        if not isinstance(to, str):
            raise SceneError.of("to", to, "a name such as 'profile.amplitude'")
        key, bracket, index = to.partition("[")
        if not bracket:
            return cls(key)
        if not (index.endswith("]") and index[:-1].isdigit()):
            allowed = "a name, or a name with an index such as profile.cosine[2]"
            raise SceneError.of("to", to, allowed)
        return cls(key, int(index[:-1]))

    @property
    def table(self) -> str:
        """The table of the parameter in a scene file."""
        return self.key.partition(".")[0]

    @property
    def name(self) -> str:
        """The name of the parameter in its table."""
        return self.key.partition(".")[2]


@dataclass(frozen=True)
class _Varied:
    """A profile as a function of one of its parameters."""

    profile: Profile
    to: Parameter

    @cached_property
    def value(self) -> Any:
        return self.profile.tables()[self.to.table][self.to.name]

    @cached_property
    def at(self) -> float:
        index = self.to.index
        return float(self.value if index is None else np.asarray(self.value)[index])

    @cached_property
    def size(self) -> float:
        """The size of the parameter, by which the relative step of a difference is multiplied.
        For an entry of an array, it is the largest absolute value in the array. It is 1 if all
        values are 0.
        """
        largest = float(np.abs(np.asarray(self.value, dtype=float)).max())
        return abs(self.at) if self.to.index is None and self.at else largest or 1.0

    def stencil(self, kind: type[Direction], weights: tuple[float, ...], step: float) -> Direction:
        """The derivative by the parameter, as a central difference with these weights.
        The steps are 1, 2, ... times `step` times the size of the parameter.
        """
        parts, factors, h = [], [], step * self.size
        for k, weight in enumerate(weights, 1):
            for sign in (1.0, -1.0):
                parts.append(self._changed(self.at + sign * k * h))
                factors.append(sign * weight / h)
        found = kind(self.profile, tuple(parts), tuple(factors))
        if any(part.support != self.profile.support for part in parts):
            raise MovedPlaces
        return found

    def _changed(self, value: float) -> Profile:
        new: Any = value
        if self.to.index is not None:
            new = np.array(self.value, dtype=float)
            new[self.to.index] = value
        return self.profile.varied({self.to.table: {self.to.name: new}})


def _differ(one: Direction, other: Direction, x: Array) -> float:
    """Relative difference of two changes of the heights, as the largest over the places x.
    A constant difference is not counted, since it does not change a contact.
    """
    with np.errstate(all="ignore"):
        first, second = one.height(x), other.height(x)
    known = np.isfinite(first) & np.isfinite(second)
    if not known.any():
        return np.inf
    size = float(np.ptp(first[known]))
    return float(np.ptp(first[known] - second[known])) / size if size else 0.0


def places_of(profile: Profile, zones: Array | None = None) -> Array:
    """Places at which two changes of a profile are compared: in the cell, and on each zone.

    Zones may be much narrower than the cell, so that evenly spaced places alone could miss them.
    """
    known = profile.support or profile.known or (-1.0, 1.0)
    t = (np.arange(DETAIL.min_samples) + 0.4142) / DETAIL.min_samples
    if zones is None or len(zones) == 0:
        if profile.period is not None:
            return period_samples(profile)
        return np.asarray(known[0] + (known[1] - known[0]) * t)
    lo, hi = float(zones.min()), float(zones.max())
    share = t[:: int(np.clip(len(zones) // 2, 1, len(t) // 8))]
    on_zones = zones[:, :1] + np.diff(zones, axis=1) * share
    return np.concatenate((lo + (hi - lo) * t, on_zones.ravel()))


def _same_places(like: Profile, places: list[Array]) -> None:
    """Raise MovedPlaces unless all parts of a sum have kinks or jumps at the same places."""
    if len({len(at) for at in places}) > 1:
        raise MovedPlaces
    known = like.known
    width = 0.0 if known is None else known[1] - known[0]
    for at in places[1:]:
        scale = max(width, float(np.abs(at).max(initial=0.0)))
        if np.abs(at - places[0]).max(initial=0.0) > 1e-12 * scale:
            raise MovedPlaces
