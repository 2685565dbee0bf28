"""Zones of the last solutions on a curve, carried on to another value of its control.

With s the logarithm of the value, middles and squared half widths of zones and of gaps are smooth
in s, through birth and merger too: a zone is born, and a gap closes, as the root of what is left.
So each end goes by the narrower of the two intervals beside it, by Hermite's polynomial through the
values and rates of the last solutions that have it; the rates are those of the response to the
load. Intervals whose square falls below zero are gone by then, and where the least gap of a place
falls below zero there is a new zone.
"""

from __future__ import annotations

from dataclasses import field
from functools import cached_property

import numpy as np

import sie
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.tables import gaps_between, united
from contact.model.controls import Quantity
from contact.search.topology.intervals import merged
from contact.solution.solution import Solution
from sie import Array, Index, Mask, record

# Of the overlap that a new zone makes good, its width at first.
_NEW = 0.7
# Of its width, what is left at first of an interval that may be gone; of a step, by how much it may
# be wrong about that.
_LEFT = 0.1
_DOUBT = 0.5
_SLIGHT = 0.1
# How near to its neighbours a new zone may begin, over its distance from these.
_CLEAR = 0.4


@record
class CurvePoint(sie.Kept):
    """A solution on the curve, with what its ends do as the control goes on."""

    solution: Solution

    @property
    def fields(self) -> ZoneFields | GapFields | None:
        fields = self.solution.fields
        return fields if isinstance(fields, ZoneFields | GapFields) else None

    @property
    def problem(self) -> Problem:
        assert self.fields is not None
        return self.fields.problem

    @property
    def at(self) -> float:
        """The logarithm of the control's value."""
        return float(np.log(self.solution.scene.control[1]))

    @cached_property
    def zones(self) -> Array:
        """Scaled (n, 2)."""
        fields = self.fields
        assert fields is not None
        return fields.zones

    @cached_property
    def lowest(self) -> Array:
        """Places, values and curvatures of the least gaps between zones, scaled (k, 3)."""
        return self.solution.certificate.lowest

    @cached_property
    def rates(self) -> tuple[Array, Array]:
        """(how far each end moves outward, a unit of the logarithm (n, 2), by how much the lowest
        places open (k,)).
        """
        fields = self.fields
        assert fields is not None
        outward, opening = fields.rates(self.lowest[:, 0])
        if self.solution.scene.held(Quantity.WIDTH) is None:
            return outward, opening
        # By the logarithm of the width in contact, not of the load.
        once = float(np.diff(self.zones, axis=1).sum()) / float(outward.sum())
        return outward * once, opening * once

    @cached_property
    def own(self) -> Motion:
        """Of the zones."""
        left, right = self.rates[0].T
        return Motion.of(self.zones, -left, right)

    @cached_property
    def between(self) -> Motion:
        """Of the gaps right of each zone, the last one over the border of the period."""
        left, right = self.rates[0].T
        return Motion.of(gaps_between(self.zones, self.problem.period), right, -np.roll(left, -1))


@record
class Motion:
    """Intervals (n, 2) with middle and squared half width, and the rates of these: values (2, n),
    rates (2, n).
    """

    table: Array
    values: Array = field(repr=False)
    rates: Array = field(repr=False)

    @classmethod
    def of(cls, table: Array, left: Array, right: Array) -> Motion:
        with np.errstate(invalid="ignore"):
            half = 0.5 * (table[:, 1] - table[:, 0])
            values = np.array([0.5 * (table[:, 0] + table[:, 1]), half**2])
            rates = np.array([0.5 * (left + right), half * (right - left)])
            # What has no end goes nowhere.
            rates = np.where(np.isfinite(values), rates, 0.0)
        return cls(table, values, rates)


def carried(along: tuple[CurvePoint, ...], at: float) -> tuple[Array, int]:
    """(scaled zones (n, 2) where the logarithm of the control's value is `at`, none where they fill
    the period; how many come and go on the way, about).
    """
    last = along[-1]
    known = _alike(along)
    period = last.problem.period
    own = _carried_on([one.own for one in known], [one.at - at for one in known], period)
    between = _carried_on([one.between for one in known], [one.at - at for one in known], period)
    zones, changes = _joined(last, own, between)
    if len(zones) == 0:
        return zones, changes
    more = _with_new(zones, last, at - last.at)
    return more, changes + len(more) - len(zones)


def _alike(along: tuple[CurvePoint, ...]) -> list[CurvePoint]:
    """The last ones in the same units, each at a value of its own, the nearest first."""
    last, known = along[-1], [along[-1]]
    for one in reversed(along[:-1]):
        if (
            one.fields is None
            or one.problem.units != last.problem.units
            or any(one.at == other.at for other in known)
        ):
            break
        known.append(one)
    return known


def _carried_on(known: list[Motion], away: list[float], period: float | None) -> Array:
    """Middles and squared half widths (2, n) of the first ones' intervals, `away` back; each by as
    many as have it.
    """
    first = known[0]
    out = first.values - away[0] * first.rates
    has = np.isfinite(first.values).all(axis=0)
    values, rates = [np.where(has, first.values, 0.0)], [first.rates]
    for count, other in enumerate(known[1:], start=2):
        partner, turn = _partners(first.table, other.table, period)
        has = has & (partner >= 0)
        if not has.any():
            break
        moved = other.values[:, partner].copy()
        moved[0] += turn
        values.append(np.where(has, moved, 0.0))
        rates.append(other.rates[:, partner])
        by_value, by_rate = _hermite(np.array(away[:count]))
        further = np.tensordot(by_value, np.array(values), 1) + np.tensordot(
            by_rate, np.array(rates), 1
        )
        out = np.where(has, further, out)
    return np.asarray(out)


def _hermite(away: Array) -> tuple[Array, Array]:
    """Weights at 0 of values and of rates at these places."""
    differences = away[:, None] - away
    np.fill_diagonal(differences, 1.0)
    others = ~np.eye(len(away), dtype=bool)
    square = np.prod(np.where(others, -away / differences, 1.0), axis=1) ** 2
    slope = np.sum(np.where(others, 1.0 / differences, 0.0), axis=1)
    return (1 + 2 * away * slope) * square, -away * square


def _partners(table: Array, other: Array, period: float | None) -> tuple[Index, Array]:
    """(the one of the others that an interval overlaps, where that overlaps no second one, else -1;
    by how much it is to be moved).
    """
    turn = (
        np.zeros(len(other))
        if period is None
        else np.floor((other.mean(axis=1) - table[0, 0]) / period) * -period
    )
    moved = other + turn[:, None]
    order = np.argsort(moved[:, 0])
    moved = moved[order]
    first, end = (
        np.searchsorted(moved[:, 1], table[:, 0], side="right"),
        np.searchsorted(moved[:, 0], table[:, 1], side="left"),
    )
    alone = end - first == 1
    partner = np.where(alone, np.minimum(first, len(order) - 1), -1)
    often = (
        np.bincount(
            np.concatenate([np.arange(lo, hi) for lo, hi in zip(first, end, strict=True)]),
            minlength=len(order),
        )
        > 1
    )
    partner = np.where(alone & ~often[partner], partner, -1)
    return np.where(partner >= 0, order[partner], -1), np.where(
        partner >= 0, turn[order[partner]], 0.0
    )


def _joined(last: CurvePoint, own: Array, between: Array) -> tuple[Array, int]:
    """(zones by the ends of zones and gaps (2, n) that are carried on, of each end by the narrower
    one; how many of these are gone, or in doubt).
    """
    period = last.problem.period
    width, gap = (motion.values[1] for motion in (last.own, last.between))
    before = np.roll(gap, 1)
    half, lost = _left(own[1], width)
    # Of a contact solved by its zones a gap is no interval of its own that could be told to be
    # gone.
    by_gaps = isinstance(last.fields, GapFields)
    open_, closed = (
        _left(between[1], gap)
        if by_gaps
        else (np.sqrt(np.maximum(between[1], 0.0)), between[1] <= 0.0)
    )
    with np.errstate(invalid="ignore"):  # a gap without end
        left = np.where(width <= before, own[0] - half, np.roll(between[0] + open_, 1))
        right = np.where(width <= gap, own[0] + half, between[0] - open_)
    if period is not None and width[0] > before[0]:
        left[0] -= period
    lost = lost & (width <= np.minimum(before, gap)) | (right <= left)
    closed = closed & (gap <= np.minimum(width, np.roll(width, -1)))
    return _kept(left, right, lost, closed, period), int(
        np.sum(own[1] <= 0.0) + np.sum(between[1] <= 0.0)
    )


def _left(square: Array, before: Array) -> tuple[Array, Mask]:
    """(half widths by squares that are carried on from what they were before, which are gone): in
    doubt a little is left.
    """
    gone = square <= -_DOUBT * (before - square)
    return np.sqrt(np.maximum(square, _LEFT**2 * before)), gone


def _kept(left: Array, right: Array, lost: Mask, closed: Mask, period: float | None) -> Array:
    """The zones that are left, those over closed gaps joined; none where all gaps have closed:
    contact is full.
    """
    if lost.all() or (period is not None and closed.all() and not lost.any()):
        return np.zeros((0, 2))
    zones = merged(np.column_stack((left, right))[~lost], np.flatnonzero(closed[~lost]), period)
    return united(zones)


def _with_new(zones: Array, last: CurvePoint, away: float) -> Array:
    """Zones, and new ones where the gap is carried on to below zero."""
    place, value, bend = last.lowest.T
    change = away * last.rates[1]
    depth = np.where(
        value + change < _SLIGHT * np.abs(change),
        np.maximum(-value - change, _SLIGHT * np.abs(change)),
        0.0,
    )
    period = last.problem.period
    place = sie.wrapped(place, float(zones[0, 0]), period)
    with np.errstate(invalid="ignore", divide="ignore"):
        half = _NEW * np.sqrt(np.maximum(depth, 0.0) / bend)
    before = np.searchsorted(zones[:, 0], place, side="right") - 1
    gaps = gaps_between(zones, period)
    low, high = (
        np.where(before >= 0, gaps[before, 0], -np.inf),
        np.where(before >= 0, gaps[before, 1], zones[0, 0]),
    )
    room = _CLEAR * np.minimum(place - low, high - place)
    new = np.flatnonzero((depth > 0.0) & (bend > 0.0) & (room > 0.0))
    half = np.minimum(half, room)[new]
    return united(np.concatenate((zones, np.column_stack((place[new] - half, place[new] + half)))))
