"""Two rough bodies face to face: the gap at zero load is f(x) = f1(x) + f2(x - shift).

The contact of two elastic bodies depends on their gap and on E* alone (K. L. Johnson, Contact
Mechanics, 1985, doi 10.1017/CBO9781139171731, section 4.1): two rough faces act as one rough face
on a flat one. f1 and f2 are the gaps [m] of each body alone over a flat, and f is their sum.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.errors import SceneError
from contact.model.checks import finite, keep
from contact.model.profiles.base import Array, Profile
from contact.model.profiles.noise import EPS
from contact.model.profiles.placement import Overlap, PlacedBody, common_period, same_place

# Keys of the table of a counter body that say where the body is, not which shape it has.
PLACEMENT_KEYS = ("shift", "mirrored")


@dataclass(frozen=True)
class Combined(Profile):
    """Two bodies that face each other, as one profile.

    The gap at zero load is f(x) = profile.f(x) + counter.f(x - shift).

    The period is the shortest one after which both bodies repeat. If one body has no period, the
    pair has none.

    Parameters
    ----------
    profile : Profile
        One body, alone: the gap [m] over a flat counter-face.
    counter : Profile
        The other body in the same way, as if it were pressed on a flat. Its x runs in the same
        direction as the x of the first body.
    shift : float
        Distance [m] by which the counter body stands to the right: its own x = 0 is at x = shift.
    mirrored : bool
        Whether the x of the counter body runs against the x of the first body. This is so for a
        trace that was read from left to right with the counter body's face in view: to face the
        first body, it is turned over like a page.

    Raises
    ------
    SceneError
        If `profile` or `counter` is not the profile of one body, the two periods have no common
        multiple, or the bodies do not face each other on one interval.

    Examples
    --------
    Two waves of one period are one wave: aligned, their amplitudes add; crest on valley, they
    subtract.

    >>> import contact
    >>> body, counter = contact.Sinusoid(2e-6, 1e-4), contact.Sinusoid(1e-6, 1e-4)
    >>> for shift in (0.0, 5e-5):
    ...     pair = contact.Combined(body, counter, shift=shift)
    ...     one = contact.solve(contact.Scene(pair, 1e11, contact.Periodic(), contact_fraction=0.5))
    ...     print(f"{one.mean_pressure:.6g}")
    4.71239e+09
    1.5708e+09
    """

    profile: Profile
    counter: Profile
    shift: float = 0.0
    mirrored: bool = False
    name: ClassVar[str] = "combined"
    units = {"shift": "m"}

    def __post_init__(self) -> None:
        for field in ("profile", "counter"):
            body = getattr(self, field)
            if not isinstance(body, Profile) or len(body.bodies) != 1:
                example = "Sinusoid(amplitude=1e-6, period=1e-4)"
                raise SceneError.of(
                    field, body, f"the contact.Profile of one body, such as {example}"
                )
        keep(self, finite, "shift")
        if not isinstance(self.mirrored, (bool, np.bool_)):
            raise SceneError.of("mirrored", self.mirrored, "True or False")
        object.__setattr__(self, "period", common_period(self.profile.period, self.counter.period))
        # Computing the attribute `_overlap` raises SceneError if the bodies do not face each other.
        assert self._overlap is not None

    @cached_property
    def _placed(self) -> dict[str, PlacedBody]:
        return {
            "profile": PlacedBody(self.profile),
            "counter": PlacedBody(self.counter, self.shift, self.mirrored),
        }

    @cached_property
    def _overlap(self) -> Overlap:
        return Overlap.of(tuple(self._placed.values()), self.period)

    # The properties and methods below describe the two bodies.

    @property
    def bodies(self) -> dict[str, Profile]:
        return {"profile": self.profile, "counter": self.counter}

    def facing(self, x: ArrayLike) -> dict[str, Array]:
        w = np.asarray(self.wrap(np.asarray(x, dtype=np.float64)))
        slack = 8 * EPS * (np.abs(w) + abs(self.shift))
        return {place: one.own_x(w, slack) for place, one in self._placed.items()}

    @property
    def title(self) -> str:
        return " on ".join(body.name for body in self.bodies.values())

    def tables(self) -> dict[str, dict[str, Any]]:
        tables = {place: body.tables()["profile"] for place, body in self.bodies.items()}
        tables["counter"] |= {"shift": self.shift} | ({"mirrored": True} if self.mirrored else {})
        return tables

    def varied(self, changes: Mapping[str, Mapping[str, Any]]) -> Profile:
        changed = {
            key: value for key, value in changes.get("counter", {}).items() if key in PLACEMENT_KEYS
        }
        for place, body in self.bodies.items():
            others = {
                key: value
                for key, value in changes.get(place, {}).items()
                if place == "profile" or key not in PLACEMENT_KEYS
            }
            if others:
                changed[place] = body.varied({"profile": others})
        return replace(self, **changed)

    def trace_summary(self) -> dict[str, Any] | None:
        summaries = {place: body.trace_summary() for place, body in self.bodies.items()}
        return {place: one for place, one in summaries.items() if one is not None} or None

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the measured points of both bodies."""
        return tuple(
            line for body in self.bodies.values() for line in getattr(body, "warnings", ())
        )

    @property
    def no_period(self) -> str:
        without = [place for place, body in self.bodies.items() if body.period is None]
        have = "has" if len(without) == 1 else "have"
        return f"the {' and the '.join(without)} {have} no period"

    def counter_height(self, x: ArrayLike) -> Array:
        return np.asarray(-np.asarray(self.counter.height(self.facing(x)["counter"])))

    # The properties and methods below are sums of the values of the two bodies.

    def _both(self, function: Callable[[Profile, Array], Any], x: ArrayLike) -> Iterator[Any]:
        """Values of `function` for each body, at the place on the body that is opposite x."""
        return (function(self.bodies[place], at) for place, at in self.facing(x).items())

    def height(self, x: ArrayLike) -> Array:
        one, other = self._both(lambda body, at: np.asarray(body.height(at)), x)
        return np.asarray(one + other)

    def slope(self, x: ArrayLike) -> Array:
        one, other = self._both(lambda body, at: np.asarray(body.slope(at)), x)
        return np.asarray(one - other if self.mirrored else one + other)

    def slope_conjugate(self, x: ArrayLike) -> Array | None:
        """The sum of the Hilbert transforms H f' of the bodies. A body's own period may be a
        fraction of the common period: the transform over either period is the same.
        """
        if self.period is None:
            return None
        one, other = self._both(lambda body, at: body.slope_conjugate(at), x)
        # If a body is mirrored, the slope and the kernel of the transform both change sign. So the
        # transform keeps its sign.
        return None if one is None or other is None else np.asarray(one + other)

    @property
    def slope_is_derived(self) -> bool:
        return self.profile.slope_is_derived or self.counter.slope_is_derived

    @property
    def symmetric(self) -> bool:
        if not (self.profile.symmetric and self.counter.symmetric):
            return False
        half = None if self.counter.period is None else 0.5 * self.counter.period
        from_axis = float(sie.nearest_image(np.array(self.shift), 0.0, half))
        ends = self._overlap.ends
        centred = ends is None or abs(ends[0] + ends[1]) <= 8 * EPS * (ends[1] - ends[0])
        return abs(from_axis) <= 8 * EPS * (half or 0.0) and centred

    @property
    def support(self) -> tuple[float, float] | None:
        return self._overlap.support

    @property
    def extent(self) -> tuple[float, float] | None:
        return self._overlap.extent

    @property
    def x0(self) -> float:
        if self.period is None:
            return -np.inf
        if self.support is not None:
            return 0.5 * (self.support[0] + self.support[1]) - 0.5 * self.period
        first, length = self.profile.x0, self.profile.period or 0.0
        return -0.5 * self.period if first == -0.5 * length else first

    @property
    def summits(self) -> Array | None:
        """The common tip if both bodies have one tip and the tips are at one place.
        It is None otherwise.
        """
        one, other = self.profile.summits, self.counter.summits
        unknown = one is None or other is None or len(one) != 1 or len(other) != 1
        if unknown or self.support is not None or self.profile.period != self.counter.period:
            return None
        if self.period is None and self.extent is not None:
            return None
        distance = self._placed["counter"].common_x(np.asarray(other)) - np.asarray(one)
        apart = float(np.abs(sie.nearest_image(distance, 0.0, self.period))[0])
        return np.array(one) if apart <= 8 * EPS * (abs(self.shift) + (self.period or 0)) else None

    @property
    def resolution(self) -> float | None:
        return _least(self.profile.resolution, self.counter.resolution)

    @property
    def feature(self) -> float | None:
        return _least(self.profile.feature, self.counter.feature)

    # The properties and methods below collect kinks, jumps and algebraic points of the two bodies.

    @property
    def kinks(self) -> Array:
        return np.asarray(self._jump_rows[self._jump_rows[:, 1] == 1][:, [0, 2]])

    @property
    def jumps(self) -> Array:
        return np.asarray(self._jump_rows[self._jump_rows[:, 1] > 1])

    @cached_property
    def algebraic_points(self) -> Array:
        rows = self._in_cells(PlacedBody.algebraic_rows)
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        # Places of algebraic points that are equal but for round-off become exactly equal.
        apart = np.diff(rows[:, 0], prepend=-np.inf) > self._same(rows[:, 0])
        rows[:, 0] = rows[apart, 0][np.cumsum(apart) - 1]
        return rows

    @cached_property
    def breakpoints(self) -> Array:
        at = np.append(self._jump_rows[:, 0], self.support or ())
        return self._added(np.column_stack((at, np.zeros(len(at)), np.ones(len(at)))))[:, 0]

    @cached_property
    def _jump_rows(self) -> Array:
        """Jumps of both bodies in the cell, as rows of place, order of the derivative, and jump.
        The order 0 marks a breakpoint without a known jump.
        """
        return self._added(self._in_cells(PlacedBody.jump_rows))

    def _in_cells(self, rows_of: Callable[[PlacedBody], Array]) -> Array:
        """Jumps or algebraic points of both bodies, repeated in all cells of their body.
        Each is a row of the array, with its place in column 0.
        """
        parts = [self._repeated(rows_of(one), one.body.period) for one in self._placed.values()]
        return np.concatenate(parts)

    def _repeated(self, rows: Array, period: float | None) -> Array:
        """The given rows of one body, repeated in all cells of the body.
        Each row is a jump or an algebraic point, with its place in column 0.
        """
        ends = self._overlap.ends
        if period is not None and len(rows):
            if self.period is not None:
                turns = np.arange(round(self.period / period))
            else:
                assert ends is not None
                first = np.floor((ends[0] - rows[:, 0].max()) / period)
                last = np.ceil((ends[1] - rows[:, 0].min()) / period)
                turns = np.arange(first, last + 1)
            moved = np.eye(1, rows.shape[1]) * period
            rows = np.concatenate([rows + turn * moved for turn in turns])
        if self.period is not None and len(rows):
            rows[:, 0] = self.wrap(rows[:, 0])
            at_border = rows[:, 0] >= self.x0 + self.period - self._same(rows[:, 0])
            rows[at_border, 0] = self.x0
        if ends is not None:
            slack = self._same(np.array(ends))
            rows = rows[(rows[:, 0] > ends[0] + slack) & (rows[:, 0] < ends[1] - slack)]
        return rows

    def _added(self, rows: Array) -> Array:
        """The rows (place, order of the derivative, jump), added up and sorted by place.

        If several rows have the same place and order, their jumps are added. A row is left out if
        this sum is zero within round-off.
        """
        rows = rows[np.lexsort((rows[:, 0], rows[:, 1]))]
        if not len(rows):
            return rows
        apart = (np.diff(rows[:, 0]) > self._same(rows[:, 0])) | (np.diff(rows[:, 1]) != 0)
        first = np.concatenate(([0], np.flatnonzero(apart) + 1))
        jump, size = np.add.reduceat(rows[:, 2], first), np.add.reduceat(np.abs(rows[:, 2]), first)
        added = np.column_stack((rows[first, :2], jump))[np.abs(jump) > 8 * EPS * size]
        return np.asarray(added[np.argsort(added[:, 0], kind="stable")])

    def _same(self, places: Array) -> float:
        return same_place(places, self.shift, self.period)


def _least(*lengths: float | None) -> float | None:
    known = [length for length in lengths if length is not None and isfinite(length)]
    return min(known, default=None)
