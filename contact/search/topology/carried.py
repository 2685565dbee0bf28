"""Zones of the last solutions on a curve, carried on to another value of its control.

With s the logarithm of the value, middles and squared half widths of zones and of gaps are smooth in s, through birth and merger too: a
zone is born, and a gap closes, as the root of what is left. So each end goes by the narrower of the two intervals beside it, evenly in s;
where the last two solutions have the same zones, by Hermite's cubic through the values and rates of both. The rates are those of the
response to the load. Intervals whose square falls below zero are gone by then, and where the least gap of a place falls below zero there
is a new zone.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

import sie
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.tables import gaps_between
from contact.model.controls import Quantity
from contact.search.topology.intervals import merged, united
from contact.solution.solution import Solution
from sie import Array, Mask, record

# Of the overlap that a new zone makes good, its width at first.
_NEW = 0.7
# Of its width, what is left at first of an interval that may be gone; of a step, by how much it may be wrong about that.
_LEFT, _DOUBT, _SLIGHT = 0.1, 0.5, 0.1
# How near to its neighbours a new zone may begin, over its distance from these.
_CLEAR = 0.4


@record
class Passed(sie.Kept):
    """A solution on the curve, with what its zones do as the control goes on."""

    solution: Solution

    @property
    def fields(self) -> ZoneFields | GapFields | None:
        fields = self.solution.fields
        return fields if isinstance(fields, ZoneFields | GapFields) else None

    @property
    def at(self) -> float:
        """The logarithm of the control's value."""
        return float(np.log(self.solution.scene.control[1]))

    @cached_property
    def going(self) -> tuple[Array, Array, Array]:
        """(middles and squared half widths of the zones, and of the gaps right of them, the last one over the border of the period (4, n);
        their rates; rates of the least gaps of the certificate (k,)), scaled, a unit of the logarithm."""
        fields = self.fields
        assert fields is not None
        table = fields.scaled_zones
        outward, opening = fields.rates(self.solution.certificate.lowest[:, 0])
        if self.solution.scene.held(Quantity.WIDTH) is not None:
            # By the logarithm of the width in contact, not of the load.
            once = float(np.diff(table, axis=1).sum()) / float(outward.sum())
            outward, opening = outward * once, opening * once
        left, right = outward.T
        values, rates = [], []
        for (a, b), start, end in ((table.T, -left, right), (gaps_between(table, fields.problem.period).T, right, -np.roll(left, -1))):
            half = 0.5 * (b - a)
            values += [0.5 * (a + b), half**2]
            # What has no end goes nowhere.
            with np.errstate(invalid="ignore"):
                rates += [np.where(np.isfinite(half), rate, 0.0) for rate in (0.5 * (start + end), half * (end - start))]
        return np.array(values), np.array(rates), opening


def carried(along: tuple[Passed, ...], at: float) -> tuple[Array, int]:
    """(scaled zones (n, 2) where the logarithm of the control's value is `at`, none where they fill the period; how many come and go on
    the way, about)."""
    last = along[-1]
    fields, values, opening = last.fields, last.going[0], last.going[2]
    assert fields is not None
    period = fields.problem.period
    there = _carried_on(last, along[-2] if len(along) > 1 else None, at)
    zones = _joined(values, there, period, isinstance(fields, GapFields))
    changes = int(np.sum(there[1::2] <= 0.0))
    if len(zones) == 0:
        return zones, changes
    more = _with_new(zones, last.solution.certificate.lowest, (at - last.at) * opening, period)
    return more, changes + len(more) - len(zones)


def _carried_on(last: Passed, before: Passed | None, at: float) -> Array:
    """Middles and squared half widths (4, n)."""
    (values, rates, _), step = last.going, at - last.at
    there = values + step * rates
    if before is None or not _alike(last, before):
        return np.asarray(there)
    (old, old_rates, _), away = before.going, last.at - before.at
    with np.errstate(invalid="ignore"):  # a gap without end
        mean = (values - old) / away
        bent = there + step**2 * ((rates - mean) / away + (step + away) * (rates - 2 * mean + old_rates) / away**2)
    return np.where(np.isfinite(bent), bent, there)


def _alike(last: Passed, before: Passed) -> bool:
    """Whether both have the same zones, in the same units, at unlike values."""
    one, other = last.fields, before.fields
    if one is None or other is None or one.problem.units != other.problem.units or last.at == before.at:
        return False
    now, then = one.scaled_zones, other.scaled_zones
    return now.shape == then.shape and bool(np.all((now[:, 0] < then[:, 1]) & (then[:, 0] < now[:, 1])))


def _joined(values: Array, there: Array, period: float | None, by_gaps: bool) -> Array:
    """Zones by the ends of zones and of gaps (4, n) that are carried on from values, of each end by the narrower one."""
    (_, width, _, gap), (middle, square, middle_of_gap, square_of_gap) = values, there
    before = np.roll(gap, 1)
    half, lost = _left(square, width)
    # Of a contact solved by its zones a gap is no interval of its own that could be told to be gone.
    open_, closed = _left(square_of_gap, gap) if by_gaps else (np.sqrt(np.maximum(square_of_gap, 0.0)), square_of_gap <= 0.0)
    with np.errstate(invalid="ignore"):  # a gap without end
        left = np.where(width <= before, middle - half, np.roll(middle_of_gap + open_, 1))
        right = np.where(width <= gap, middle + half, middle_of_gap - open_)
    if period is not None and width[0] > before[0]:
        left[0] -= period
    lost = lost & (width <= np.minimum(before, gap)) | (right <= left)
    closed = closed & (gap <= np.minimum(width, np.roll(width, -1)))
    return _kept(left, right, lost, closed, period)


def _left(square: Array, before: Array) -> tuple[Array, Mask]:
    """(half widths by squares that are carried on from what they were before, which are gone): in doubt a little is left."""
    gone = square <= -_DOUBT * (before - square)
    return np.sqrt(np.maximum(square, _LEFT**2 * before)), gone


def _kept(left: Array, right: Array, lost: Mask, closed: Mask, period: float | None) -> Array:
    """The zones that are left, those over closed gaps joined; none where all gaps have closed: contact is full."""
    if lost.all() or (period is not None and closed.all() and not lost.any()):
        return np.zeros((0, 2))
    zones = merged(np.column_stack((left, right))[~lost], np.flatnonzero(closed[~lost]), period)
    return united(zones, None, False, "zone")


def _with_new(zones: Array, lowest: Array, change: Array, period: float | None) -> Array:
    """Zones, and new ones where the gap is carried on to below zero. lowest: see `carried`; change: of these gaps (k,)."""
    place, value, bend = lowest.T
    depth = np.where(value + change < _SLIGHT * np.abs(change), np.maximum(-value - change, _SLIGHT * np.abs(change)), 0.0)
    place = sie.wrapped(place, float(zones[0, 0]), period)
    with np.errstate(invalid="ignore", divide="ignore"):
        half = _NEW * np.sqrt(np.maximum(depth, 0.0) / bend)
    before = np.searchsorted(zones[:, 0], place, side="right") - 1
    gaps = gaps_between(zones, period)
    low, high = np.where(before >= 0, gaps[before, 0], -np.inf), np.where(before >= 0, gaps[before, 1], zones[0, 0])
    room = _CLEAR * np.minimum(place - low, high - place)
    new = np.flatnonzero((depth > 0.0) & (bend > 0.0) & (room > 0.0))
    half = np.minimum(half, room)[new]
    return united(np.concatenate((zones, np.column_stack((place[new] - half, place[new] + half)))), None, False, "zone")
