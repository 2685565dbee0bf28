"""Two bodies face to face: where each stands, the common period, and the interval they share.

A body is placed by a shift and perhaps mirrored. Sharp corners (`support`) and the ends of measured
traces (`extent`) bound the interval in which the bodies face each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contact.errors import SceneError
from contact.extras import require
from contact.model.profiles.base import Profile, onto
from contact.model.profiles.noise import EPS
from sie import Array, record

Window = tuple[float, float]


@dataclass(frozen=True)
class CombinedLimits:
    """Limits on the number of cells for which two bodies are combined cell by cell.

    cells_in_period: largest number of cells of either body in the common period.
    repeats: number of cells, on either side, of a periodic body with corners that faces a body
        without ends. Together the cells have at most 2 cells_in_period corners.
    """

    cells_in_period: int = 10_000
    repeats: int = 200


_LIMITS = CombinedLimits()


@record
class PlacedBody:
    """A body whose x = 0 is at `shift` in the common coordinate. If the body is mirrored, its
    own x increases to the left.
    """

    body: Profile
    shift: float = 0.0
    mirrored: bool = False

    def common_x(self, places: Array) -> Array:
        """Coordinates x common to both bodies, from coordinates `places` of this body itself."""
        return np.asarray(self.shift - places if self.mirrored else self.shift + places)

    def own_x(self, x: Array, slack: Array) -> Array:
        """Coordinates of the body itself, from coordinates x common to both bodies.

        Coordinates that round-off has put just outside the body are moved onto its ends.
        """
        at = np.asarray(self.shift - x if self.mirrored else x - self.shift)
        ends = self.body.support or (self.body.extent if self.body.period is None else None)
        return at if ends is None else onto(ends, np.asarray(self.body.wrap(at)), slack)

    def window(self, ends: Window) -> Window:
        """An interval of the body, converted to the coordinate x common to both bodies."""
        lo, hi = np.sort(self.common_x(np.array(ends))).tolist()
        return lo, hi

    def algebraic_rows(self) -> Array:
        """The body's algebraic points as rows, in the coordinate x common to both bodies.
        A row holds the place, the exponent, and the coefficients on the left and on the right.

        A mirror exchanges left and right.
        """
        columns = [0, 1, 3, 2] if self.mirrored else slice(None)
        rows = np.array(self.body.algebraic_points, dtype=np.float64)[:, columns]
        rows[:, 0] = self.common_x(rows[:, 0])
        return rows

    def jump_rows(self) -> Array:
        """The body's kinks, jumps and other breakpoints as rows.
        A row holds the place, the order of the derivative that jumps, and the jump.

        Places are in the coordinate common to both bodies. Kinks have order 1, jumps order 2 or 3,
        and breakpoints order 0.
        """
        body = self.body
        places = np.asarray(body.breakpoints)
        others = np.column_stack((places, np.zeros(len(places)), np.ones(len(places))))
        rows = np.concatenate((np.insert(body.kinks, 1, 1, axis=1), body.jumps, others))
        rows[:, 0] = self.common_x(rows[:, 0])
        if self.mirrored:
            # A mirror changes the sign of odd derivatives and exchanges the two sides of a jump.
            # Both together change the sign of jumps of even order only.
            rows[rows[:, 1] == 2, 2] *= -1
        return rows


@record
class Overlap:
    """The interval in which two placed bodies face each other.

    support: the interval between sharp corners; None without corners. extent: the interval in which
    both bodies are known; None if they are known everywhere.
    """

    support: Window | None
    extent: Window | None

    @classmethod
    def of(cls, placed: Sequence[PlacedBody], period: float | None) -> "Overlap":
        """The interval in which two placed bodies face each other; SceneError if there is not
        exactly one.
        """
        shift = placed[1].shift
        extents = [one.window(one.body.extent) for one in placed if one.body.extent is not None]
        known = (max(lo for lo, _ in extents), min(hi for _, hi in extents)) if extents else None
        if known is not None and not known[0] < known[1]:
            ends = " and from ".join(f"{lo:.6g} to {hi:.6g}" for lo, hi in extents)
            allowed = f"such that the known parts of the bodies overlap (they reach from {ends})"
            raise SceneError.of("shift", shift, allowed)
        if known is None and period is None:
            known = _cells_under_lone_body(placed)
        supports = _supports(placed, period, known)
        if supports is None:
            return cls(None, known)
        if len(supports) != 1:
            many = f"face each other on {len(supports)} intervals"
            what = many if supports else "never face each other"
            allowed = (
                f"such that corners bound one common interval (one in each period): the bodies "
                f"{what}"
            )
            raise SceneError.of("counter", placed[1].body, allowed)
        (lo, hi) = supports[0]
        if known is None or known[0] <= lo and hi <= known[1]:
            return cls((lo, hi), None)
        if lo <= known[0] and known[1] <= hi:
            return cls(None, known)
        allowed = (
            f"such that the known part of the other body, {known[0]:.6g} to {known[1]:.6g}, "
            f"contains both corners, {lo:.6g} and {hi:.6g}, or lies between them"
        )
        raise SceneError.of("shift", shift, allowed)

    @property
    def ends(self) -> Window | None:
        """The interval between sharp corners (the support), or the known interval if there are no
        corners.
        """
        return self.support or self.extent


def _cells_under_lone_body(placed: Sequence[PlacedBody]) -> Window | None:
    """Interval in which corners of a periodic body are listed if the other body has no period.

    The interval contains `repeats` cells on each side of the other body's tip. The result is None
    unless exactly one body has a period; also if the other body ends at corners, or if there are no
    corners to list.
    """
    lone, row = sorted(placed, key=lambda one: one.body.period is not None)
    body, period = row.body, row.body.period
    if period is None or lone.body.period is not None or lone.body.support is not None:
        return None
    corners = len(body.kinks) + len(body.jumps) + len(body.breakpoints)
    if not corners:
        return None
    tips = lone.body.summits
    if tips is None:
        tips = lone.body.kinks[lone.body.kinks[:, 1] > 0, 0]
    at = float(np.mean(tips)) if len(tips) else 0.0
    repeats = min(_LIMITS.repeats, max(1, _LIMITS.cells_in_period // corners))
    return lone.window((at - repeats * period, at + repeats * period))


def _supports(
    placed: Sequence[PlacedBody], period: float | None, known: Window | None
) -> list[Window] | None:
    """Intervals between sharp corners in which both bodies exist; None if neither body has
    corners.

    With a common period, these are the intervals of one period; otherwise all of them.
    """
    found = [
        (one.window(one.body.support), one.body.period)
        for one in placed
        if one.body.support is not None
    ]
    if not found:
        return None
    searched = known or next((first for first, own in found if own is None), None)
    if period is not None:
        searched = found[0][0][0], found[0][0][0] + period
    lists = [_copies(placed, first, own, searched) for first, own in found]
    if len(lists) == 1:
        return lists[0]
    shared = [(max(a[0], b[0]), min(a[1], b[1])) for a in lists[0] for b in lists[1]]
    largest = max((abs(end) for window in shared for end in window), default=0.0)
    least = 8 * EPS * (abs(placed[1].shift) + largest)
    return [(lo, hi) for lo, hi in shared if hi - lo > least]


def _copies(
    placed: Sequence[PlacedBody], first: Window, period: float | None, searched: Window | None
) -> list[Window]:
    """Copies of an interval, shifted by whole periods, that overlap the interval `searched`."""
    if period is None:
        return [first]
    if searched is None:
        allowed = (
            "such that corners bound one common interval: a periodic body with corners needs an "
            "opposite body that has ends or a period"
        )
        raise SceneError.of("counter", placed[1].body, allowed)
    start, stop = searched
    slack = same_place(np.array(searched), placed[1].shift, None)
    turns = np.arange(
        np.floor((start - first[1]) / period), np.ceil((stop - first[0]) / period) + 1
    )
    copies = [(float(first[0] + turn * period), float(first[1] + turn * period)) for turn in turns]
    return [copy for copy in copies if copy[1] > start + slack and copy[0] < stop - slack]


def same_place(places: Array, shift: float, period: float | None) -> float:
    """Distance below which two places count as one: the round-off of the sum of a place and the
    shift.
    """
    largest = float(np.max(np.abs(places), initial=0.0))
    return 16 * EPS * (largest + abs(shift) + (period or 0.0))


def common_period(one: float | None, other: float | None) -> float | None:
    """The shortest length that is a whole multiple of both periods; None if a period is None."""
    if one is None or other is None:
        return None
    most = _LIMITS.cells_in_period
    cells = np.arange(1, most + 1, dtype=np.float64)
    others = np.round(cells * (one / other))
    rest = np.abs(cells * one - others * other)
    fits = (others >= 1) & (others <= most) & (rest <= 8 * EPS * cells * one)
    if fits.any():
        return float(cells[np.argmax(fits)] * one)
    Fraction = require("fractions").Fraction
    ratio = (
        Fraction(one / other).limit_denominator(10)
        if one > other
        else 1 / Fraction(other / one).limit_denominator(10)
    )
    length = one * ratio.denominator / ratio.numerator
    example = (
        f"{length!r} ({ratio.numerator} times this is {ratio.denominator} times the profile's "
        "period)"
    )
    allowed = (
        f"a fraction of whole numbers (at most {most}) times the profile's period {one!r}, "
        f"so that the pair has a common period: such as {example}"
    )
    raise SceneError.of("counter.period", other, allowed)
