"""Two rough bodies face to face: the gap at zero load is the sum of their own, f(x) = f1(x) + f2(x
- shift).

The contact of two elastic bodies depends on their gap and on E* alone (K. L. Johnson, Contact
Mechanics, 1985, doi 10.1017/CBO9781139171731, section 4.1): two rough faces are one, of the sum of
their heights, on a flat one. Each f grows away from contact, that is, heights of both bodies are
counted towards the other body.
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
from contact.extras import require
from contact.model.checks import finite, keep
from contact.model.profiles.base import Array, Profile, onto
from sie import record

Window = tuple[float, float]

_EPS = float(np.finfo(np.float64).eps)
# Keys of a counter body's table that tell how it stands, and not what it is.
STANDS = ("shift", "mirrored")
# Cells of either body in the period that both have in common.
_MOST_CELLS = 10_000
# Of a body that repeats under one that does not and goes on for ever: cells on either side whose
# corners are told, within so many places.
_CELLS = (8, 200)
_PLACES = 20_000


@dataclass(frozen=True)
class Combined(Profile):
    """The profiles of two bodies that face each other, as one: f(x) = profile.f(x) + counter.f(x -
    shift).

    The period is that after which both repeat; with only one that has a period, there is none.

    Parameters
    ----------
    profile : Profile
        The one body, alone: the gap [m] over a flat counter-face.
    counter : Profile
        The other body in the same way, as if it were pressed on a flat; its x runs in the direction
        of the first's.
    shift : float
        How far the counter body stands to the right [m]: its x = 0 is at this x.
    mirrored : bool
        Whether its x runs against that of the first: of a trace read left to right as one looks at
        that body's face, which is then turned over like a page.

    Raises
    ------
    SceneError
        If one of them is no profile of one body, the periods have none in common, or the bodies do
        not face each other on one stretch.

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
                raise SceneError.of(
                    field,
                    body,
                    "the contact.Profile of one body, such as Sinusoid(amplitude=1e-6, period=1e-4)",
                )
        keep(self, finite, "shift")
        if not isinstance(self.mirrored, (bool, np.bool_)):
            raise SceneError.of("mirrored", self.mirrored, "True or False")
        object.__setattr__(self, "period", _common_period(self.profile.period, self.counter.period))
        # What does not go together is told now.
        assert self._faces is not None

    # what each body is
    # ------------------------------------------------------------------------------------------------
    @property
    def bodies(self) -> dict[str, Profile]:
        return {"profile": self.profile, "counter": self.counter}

    @cached_property
    def _stood(self) -> "dict[str, _Stood]":
        return {
            "profile": _Stood(self.profile),
            "counter": _Stood(self.counter, self.shift, self.mirrored),
        }

    def facing(self, x: ArrayLike) -> dict[str, Array]:
        w = np.asarray(self.wrap(np.asarray(x, dtype=np.float64)))
        off = 8 * _EPS * (np.abs(w) + abs(self.shift))
        return {place: stood.beneath(w, off) for place, stood in self._stood.items()}

    def _both(self, told: Callable[[Profile, Array], Any], x: ArrayLike) -> Iterator[Any]:
        """What is told of each body where they face x."""
        return (told(self.bodies[place], at) for place, at in self.facing(x).items())

    @property
    def title(self) -> str:
        return " on ".join(body.name for body in self.bodies.values())

    def tables(self) -> dict[str, dict[str, Any]]:
        told = {place: body.tables()["profile"] for place, body in self.bodies.items()}
        told["counter"] |= {"shift": self.shift} | ({"mirrored": True} if self.mirrored else {})
        return told

    def varied(self, changes: Mapping[str, Mapping[str, Any]]) -> Profile:
        changed = {key: value for key, value in changes.get("counter", {}).items() if key in STANDS}
        for place, body in self.bodies.items():
            others = {
                key: value
                for key, value in changes.get(place, {}).items()
                if place == "profile" or key not in STANDS
            }
            if others:
                changed[place] = body.varied({"profile": others})
        return replace(self, **changed)

    def trace_summary(self) -> dict[str, Any] | None:
        told = {
            place: summary
            for place, body in self.bodies.items()
            if (summary := body.trace_summary()) is not None
        }
        return told or None

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful about the points of either."""
        return tuple(
            line for body in self.bodies.values() for line in getattr(body, "warnings", ())
        )

    @property
    def no_period(self) -> str:
        without = " and ".join(place for place, body in self.bodies.items() if body.period is None)
        return (
            f"of profile and counter, {without} {'has' if without.count(' ') == 0 else 'have'} none"
        )

    def counter_height(self, x: ArrayLike) -> Array:
        return np.asarray(-np.asarray(self.counter.height(self.facing(x)["counter"])))

    # their sum
    # --------------------------------------------------------------------------------------------------------
    def height(self, x: ArrayLike) -> Array:
        one, other = self._both(lambda body, at: np.asarray(body.height(at)), x)
        return np.asarray(one + other)

    def slope(self, x: ArrayLike) -> Array:
        one, other = self._both(lambda body, at: np.asarray(body.slope(at)), x)
        return np.asarray(one - other if self.mirrored else one + other)

    def slope_conjugate(self, x: ArrayLike) -> Array | None:
        """The sum of both: a longer period of which its own is a part changes no conjugate."""
        if self.period is None:
            return None
        one, other = self._both(lambda body, at: body.slope_conjugate(at), x)
        # Turned round, the slope and the kernel both change their sign.
        return None if one is None or other is None else np.asarray(one + other)

    @property
    def slope_is_derived(self) -> bool:
        return self.profile.slope_is_derived or self.counter.slope_is_derived

    @property
    def symmetric(self) -> bool:
        if not (self.profile.symmetric and self.counter.symmetric):
            return False
        half = None if self.counter.period is None else 0.5 * self.counter.period
        off = sie.nearest_image(np.array(self.shift), 0.0, half)
        ends = self.support or self.extent
        centred = ends is None or abs(ends[0] + ends[1]) <= 8 * _EPS * (ends[1] - ends[0])
        return bool(abs(off) <= 8 * _EPS * (half or 0.0)) and centred

    @cached_property
    def kinks(self) -> Array:
        return np.asarray(self._broken[self._broken[:, 1] == 1][:, [0, 2]])

    @cached_property
    def jumps(self) -> Array:
        return np.asarray(self._broken[self._broken[:, 1] > 1])

    @cached_property
    def algebraic_points(self) -> Array:
        rows = np.concatenate(
            [self._repeated(stood.algebraic(), stood.body.period) for stood in self._stood.values()]
        )
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        # Those of both bodies at one place are at the very same number.
        apart = np.diff(rows[:, 0], prepend=-np.inf) > (
            self._alike(rows[:, 0]) if len(rows) else 0.0
        )
        rows[:, 0] = rows[apart, 0][np.cumsum(apart) - 1]
        return rows

    @cached_property
    def breakpoints(self) -> Array:
        at = np.append(self._broken[:, 0], self.support or ())
        return self._summed(np.column_stack((at, np.zeros(len(at)), np.ones(len(at)))))[:, 0]

    @property
    def support(self) -> Window | None:
        return self._faces[0]

    @property
    def extent(self) -> Window | None:
        return self._faces[1]

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
        """Where both have their one tip at one place: from there both only rise."""
        one, other = self.profile.summits, self.counter.summits
        if (
            one is None
            or other is None
            or self.support is not None
            or self.profile.period != self.counter.period
        ):
            return None
        if len(one) != 1 or len(other) != 1 or self.period is None and self.extent is not None:
            return None
        away = sie.nearest_image(
            self._stood["counter"].above(np.asarray(other)) - one, 0.0, self.period
        )
        return (
            np.array(one)
            if abs(away[0]) <= 8 * _EPS * (abs(self.shift) + (self.period or 0.0))
            else None
        )

    @property
    def resolution(self) -> float | None:
        return _least(self.profile.resolution, self.counter.resolution)

    @property
    def feature(self) -> float | None:
        return _least(self.profile.feature, self.counter.feature)

    # places
    # -----------------------------------------------------------------------------------------------------------
    @cached_property
    def _faces(self) -> tuple[Window | None, Window | None]:
        """(support, extent): where sharp corners bound what faces each other, or else what is known
        of both.
        """
        extents = [
            stood.window(stood.body.extent)
            for stood in self._stood.values()
            if stood.body.extent is not None
        ]
        known = (max(lo for lo, _ in extents), min(hi for _, hi in extents)) if extents else None
        if known is not None and not known[0] < known[1]:
            told = ", ".join(f"{lo:.6g} to {hi:.6g}" for lo, hi in extents)
            raise SceneError.of(
                "shift",
                self.shift,
                f"such that both bodies face each other (they are known from, to: {told})",
            )
        known = known or self._told_of()
        supports = self._supports(known)
        if supports is None:
            return None, known
        if len(supports) != 1:
            what = (
                "touch nowhere" if not supports else f"face each other on {len(supports)} stretches"
            )
            raise SceneError.of(
                "counter",
                self.counter,
                f"such that corners bound one stretch (and one a period): the two bodies {what}",
            )
        (lo, hi) = supports[0]
        if known is None or known[0] <= lo and hi <= known[1]:
            return (lo, hi), None
        if lo <= known[0] and known[1] <= hi:
            return None, known
        raise SceneError.of(
            "shift", self.shift, f"such that the corners at {lo:.6g} and {hi:.6g} both face what is known of the other body, "
            f"{known[0]:.6g} to {known[1]:.6g}, or neither does"
        )  # fmt: skip

    def _told_of(self) -> Window | None:
        """Of a body with corners that repeats under one that just goes on: as many cells as have
        their corners told.
        """
        one, other = self._stood.values()
        (lone, row), stood = (
            ((one.body, other.body), one)
            if one.body.period is None
            else ((other.body, one.body), other)
        )
        if self.period is not None or row.period is None or lone.support is not None:
            return None
        places = len(row.kinks) + len(row.jumps) + len(row.breakpoints)
        if not places:
            return None
        tips = (
            lone.kinks[lone.kinks[:, 1] > 0, 0]
            if lone.summits is None
            else np.asarray(lone.summits)
        )
        at = float(np.mean(tips)) if len(tips) else 0.0
        reach = row.period * int(np.clip(_PLACES // (2 * places), *_CELLS))
        return stood.window((at - reach, at + reach))

    def _supports(self, known: Window | None) -> list[Window] | None:
        """Stretches between sharp corners, of both at once: in a period, else all; None without any
        corners.
        """
        bodies = [(stood, stood.body.support, stood.body.period) for stood in self._stood.values()]
        found = [
            (stood.window(support), period)
            for stood, support, period in bodies
            if support is not None
        ]
        if not found:
            return None
        looked_at = known or next((first for first, period in found if period is None), None)
        if self.period is not None:
            looked_at = found[0][0][0], found[0][0][0] + self.period
        stretches = [self._copies(first, period, looked_at) for first, period in found]
        if len(stretches) == 1:
            return stretches[0]
        shared = [(max(a[0], b[0]), min(a[1], b[1])) for a in stretches[0] for b in stretches[1]]
        least = (
            8
            * _EPS
            * (
                abs(self.shift)
                + max((abs(end) for stretch in shared for end in stretch), default=0.0)
            )
        )
        return [(lo, hi) for lo, hi in shared if hi - lo > least]

    def _copies(
        self, first: Window, period: float | None, looked_at: Window | None
    ) -> list[Window]:
        """A stretch that repeats, as often as it reaches into what is looked at."""
        if period is None:
            return [first]
        if looked_at is None:
            allowed = "without a period of its own, or facing a body that ends: corners without end bound no one stretch"
            raise SceneError.of("counter", self.counter, allowed)
        (start, stop), slack = looked_at, self._alike(np.array(looked_at))
        turns = np.arange(
            np.floor((start - first[1]) / period), np.ceil((stop - first[0]) / period) + 1
        )
        copies = [
            (float(first[0] + turn * period), float(first[1] + turn * period)) for turn in turns
        ]
        return [copy for copy in copies if copy[1] > start + slack and copy[0] < stop - slack]

    @cached_property
    def _broken(self) -> Array:
        """Place, order and jump of all that is broken of both, where they stand, those at one place
        as one; of order 0 a mere place.
        """
        return self._summed(
            np.concatenate(
                [
                    self._repeated(stood.broken(), stood.body.period)
                    for stood in self._stood.values()
                ]
            )
        )

    def _repeated(self, rows: Array, period: float | None) -> Array:
        """Rows of a body that begin with a place, once for each of its cells."""
        ends = self.support or self.extent
        if period is not None and len(rows):
            if self.period is not None:
                turns = np.arange(round(self.period / period))
            else:
                assert ends is not None
                first, last = (
                    (ends[0] - rows[:, 0].max()) / period,
                    (ends[1] - rows[:, 0].min()) / period,
                )
                turns = np.arange(np.floor(first), np.ceil(last) + 1)
            rows = np.concatenate(
                [rows + np.eye(1, rows.shape[1]) * turn * period for turn in turns]
            )
        if self.period is not None and len(rows):
            rows[:, 0] = self.wrap(rows[:, 0])
            rows[rows[:, 0] >= self.x0 + self.period - self._alike(rows[:, 0]), 0] = self.x0
        if ends is not None:
            slack = self._alike(np.array(ends))
            rows = rows[(rows[:, 0] > ends[0] + slack) & (rows[:, 0] < ends[1] - slack)]
        return rows

    def _summed(self, rows: Array) -> Array:
        """Rows of place, order and jump, in order, with those of one place and order added; none of
        what cancels.
        """
        rows = rows[np.lexsort((rows[:, 0], rows[:, 1]))]
        if not len(rows):
            return rows
        apart = (np.diff(rows[:, 0]) > self._alike(rows[:, 0])) | (np.diff(rows[:, 1]) != 0)
        first = np.concatenate(([0], np.flatnonzero(apart) + 1))
        jump, size = np.add.reduceat(rows[:, 2], first), np.add.reduceat(np.abs(rows[:, 2]), first)
        summed = np.column_stack((rows[first, :2], jump))[np.abs(jump) > 8 * _EPS * size]
        return np.asarray(summed[np.argsort(summed[:, 0], kind="stable")])

    def _alike(self, places: Array) -> float:
        """Places that differ by no more are one: rounding of a sum."""
        return (
            16
            * _EPS
            * (float(np.max(np.abs(places), initial=0.0)) + abs(self.shift) + (self.period or 0.0))
        )


@record
class _Stood:
    """A body as it stands in the pair: its x = 0 is at `shift`, and its x runs backwards where it
    is mirrored.
    """

    body: Profile
    shift: float = 0.0
    mirrored: bool = False

    def above(self, places: Array) -> Array:
        """Where places of the body stand."""
        return np.asarray(self.shift - places if self.mirrored else self.shift + places)

    def beneath(self, x: Array, off: Array) -> Array:
        """The places of the body that face x, with those that rounding has put just beyond its end
        moved back onto it.
        """
        at = np.asarray(self.shift - x if self.mirrored else x - self.shift)
        ends = self.body.support or (self.body.extent if self.body.period is None else None)
        return at if ends is None else onto(ends, np.asarray(self.body.wrap(at)), off)

    def window(self, ends: Window) -> Window:
        """A stretch of the body as it stands."""
        lo, hi = np.sort(self.above(np.array(ends))).tolist()
        return lo, hi

    def algebraic(self) -> Array:
        """Its algebraic points where they stand; looked at from the other side right and left
        change places.
        """
        rows = np.array(self.body.algebraic_points, dtype=np.float64)[
            :, [0, 1, 3, 2] if self.mirrored else slice(None)
        ]
        rows[:, 0] = self.above(rows[:, 0])
        return rows

    def broken(self) -> Array:
        """Place, order and jump of its kinks (of order 1), its jumps and its other breakpoints (of
        order 0), where they stand.
        """
        body = self.body
        places = np.asarray(body.breakpoints)
        others = np.column_stack((places, np.zeros(len(places)), np.ones(len(places))))
        rows = np.concatenate((np.insert(body.kinks, 1, 1, axis=1), body.jumps, others))
        rows[:, 0] = self.above(rows[:, 0])
        if self.mirrored:
            # Looked at from the other side the odd derivatives change sign, and right and left
            # change places.
            rows[rows[:, 1] == 2, 2] *= -1
        return rows


def _least(*lengths: float | None) -> float | None:
    return min(
        (length for length in lengths if length is not None and isfinite(length)), default=None
    )


def _common_period(one: float | None, other: float | None) -> float | None:
    """The shortest length that is a whole number of both periods; None without one of them."""
    if one is None or other is None:
        return None
    cells = np.arange(1, _MOST_CELLS + 1, dtype=np.float64)
    others = np.round(cells * (one / other))
    fits = (
        (others >= 1)
        & (others <= _MOST_CELLS)
        & (np.abs(cells * one - others * other) <= 8 * _EPS * cells * one)
    )
    if fits.any():
        return float(cells[np.argmax(fits)] * one)
    Fraction = require("fractions").Fraction
    near = (
        Fraction(one / other).limit_denominator(10)
        if one > other
        else 1 / Fraction(other / one).limit_denominator(10)
    )
    told = f"{one * near.denominator / near.numerator!r} ({near.denominator} of the profile's on {near.numerator} of its own)"
    allowed = f"in a ratio of whole numbers, at most {_MOST_CELLS}, to the profile's {one!r}, so that both repeat together: such as {told}"
    raise SceneError.of("counter.period", other, allowed)
