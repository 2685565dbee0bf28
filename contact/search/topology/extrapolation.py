"""Zones of a contact extrapolated along a curve of values of one control.

Let s be the logarithm of the control's value. The middles and the squared half widths of zones and
gaps are smooth functions of s, through births and mergers too: a zone is born, and a gap closes,
where its squared half width is zero. An end is taken from the narrower of the zone and the gap that
it bounds. That interval is extrapolated by Hermite's polynomial through its values and rates at the
last solutions that have it. An interval whose squared half width becomes negative has vanished, and
a zone is born where a local minimum of the gap becomes negative.
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
from contact.search.options import SEARCH
from contact.search.topology.intervals import NEW_ZONE, merged
from contact.solution.solution import Solution
from sie import Array, Index, Mask, record


@record
class CurvePoint(sie.Kept):
    """One of several solutions at successive loads or widths, with derivatives of its zone ends."""

    solution: Solution

    @property
    def fields(self) -> ZoneFields | GapFields | None:
        """The fields of the solution, if they are those of zones or of gaps; else None."""
        fields = self.solution.fields
        return fields if isinstance(fields, ZoneFields | GapFields) else None

    @property
    def problem(self) -> Problem:
        """The scaled problem of the solution."""
        assert self.fields is not None
        return self.fields.problem

    @property
    def at(self) -> float:
        """The logarithm of the given load or width; the zone ends are differentiated by it."""
        return float(np.log(self.solution.scene.control[1]))

    @cached_property
    def zones(self) -> Array:
        """The scaled zones (n, 2) of the solution."""
        fields = self.fields
        assert fields is not None
        return fields.zones

    @cached_property
    def lowest(self) -> Array:
        """Places, values and curvatures (k, 3) of the local minima of the gap, scaled."""
        return self.solution.certificate.lowest

    @cached_property
    def rates(self) -> tuple[Array, Array]:
        """Derivatives of the ends, and of the minima of the gap, by the logarithm of load or width.

        Returns the outward rates of the ends (n, 2), and the rates at which the gap grows at its
        local minima `lowest` (k,).
        """
        fields = self.fields
        assert fields is not None
        outward, opening = fields.rates(self.lowest[:, 0])
        if self.solution.scene.held(Quantity.WIDTH) is None:
            return outward, opening
        # These derivatives are by ln(load). As the control is the width, they are converted to
        # derivatives by ln(width).
        per_width = float(np.diff(self.zones, axis=1).sum()) / float(outward.sum())
        return outward * per_width, opening * per_width

    @cached_property
    def zone_motion(self) -> Motion:
        """Middles and squared half widths of the zones, with derivatives by ln(load or width)."""
        left, right = self.rates[0].T
        return Motion.of(self.zones, -left, right)

    @cached_property
    def gap_motion(self) -> Motion:
        """Middles and squared half widths of the gaps, with derivatives by ln(load or width).
        Each gap lies to the right of a zone. The last gap crosses the border of the period.
        """
        left, right = self.rates[0].T
        return Motion.of(gaps_between(self.zones, self.problem.period), right, -np.roll(left, -1))


@record
class Motion:
    """Intervals (n, 2) with their middles, squared half widths, and derivatives of both.
    The derivatives are by ln(load or width).

    values: middles and squared half widths (2, n). rates: the rates of the values (2, n).
    """

    table: Array
    values: Array = field(repr=False)
    rates: Array = field(repr=False)

    @classmethod
    def of(cls, table: Array, left: Array, right: Array) -> Motion:
        """The `Motion` of the intervals `table`, from the derivatives of their two ends."""
        with np.errstate(invalid="ignore"):
            half = 0.5 * (table[:, 1] - table[:, 0])
            values = np.array([0.5 * (table[:, 0] + table[:, 1]), half**2])
            rates = np.array([0.5 * (left + right), half * (right - left)])
            # Without a period, the gap to the right of the last zone is infinite. The derivatives
            # of this gap are set to zero.
            rates = np.where(np.isfinite(values), rates, 0.0)
        return cls(table, values, rates)


def extrapolated(previous: tuple[CurvePoint, ...], at: float) -> tuple[Array, int]:
    """Extrapolated scaled zones (n, 2), and the number of zones and gaps that come or go.

    at: the logarithm of the control's value. The table is empty where the zones fill the period.
    """
    last = previous[-1]
    known = _alike(previous)
    period, distances = last.problem.period, [one.at - at for one in known]
    zones_then = _extrapolate([one.zone_motion for one in known], distances, period)
    gaps_then = _extrapolate([one.gap_motion for one in known], distances, period)
    zones, changes = _joined(last, zones_then, gaps_then)
    if len(zones) == 0:
        return zones, changes
    more = _with_new(zones, last, at - last.at)
    return more, changes + len(more) - len(zones)


def _alike(previous: tuple[CurvePoint, ...]) -> list[CurvePoint]:
    """The last points with the same units and distinct loads or widths, newest first."""
    last, known = previous[-1], [previous[-1]]
    for one in reversed(previous[:-1]):
        if (
            one.fields is None
            or one.problem.units != last.problem.units
            or any(one.at == other.at for other in known)
        ):
            break
        known.append(one)
    return known


def _extrapolate(known: list[Motion], away: list[float], period: float | None) -> Array:
    """Extrapolated middles and squared half widths (2, n) of the newest intervals, `known[0]`.

    away: ln(load or width) of each point, minus its wanted value. Each interval is extrapolated
    from all successive points that have it.
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
        by_value, by_rate = hermite_weights(np.array(away[:count]))
        further = np.tensordot(by_value, np.array(values), 1) + np.tensordot(
            by_rate, np.array(rates), 1
        )
        out = np.where(has, further, out)
    return np.asarray(out)


def hermite_weights(away: Array) -> tuple[Array, Array]:
    """Weights of values and of derivatives at the points `away` in Hermite interpolation at 0."""
    differences = away[:, None] - away
    np.fill_diagonal(differences, 1.0)
    others = ~np.eye(len(away), dtype=bool)
    square = np.prod(np.where(others, -away / differences, 1.0), axis=1) ** 2
    slope = np.sum(np.where(others, 1.0 / differences, 0.0), axis=1)
    return (1 + 2 * away * slope) * square, -away * square


def _partners(table: Array, other: Array, period: float | None) -> tuple[Index, Array]:
    """For each interval of `table`: the index of its partner in `other`, and the partner's shift.

    The index is -1 without a partner. The shift, a multiple of the period, moves the partner to the
    interval. Partners overlap each other and no third interval.
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


def _joined(last: CurvePoint, zones: Array, gaps: Array) -> tuple[Array, int]:
    """Zones (n, 2), and the number of zones and gaps that vanish.

    zones, gaps: extrapolated middles and squared half widths (2, n). Each end is taken from the
    narrower of the two intervals that it bounds.
    """
    period = last.problem.period
    width, gap = (motion.values[1] for motion in (last.zone_motion, last.gap_motion))
    before = np.roll(gap, 1)
    half, lost = _half_widths(zones[1], width)
    # If zones are the unknown, Newton's method cannot remove a gap. A gap that may have closed is
    # therefore taken as closed.
    by_gaps = isinstance(last.fields, GapFields)
    half_gap, closed = (
        _half_widths(gaps[1], gap)
        if by_gaps
        else (np.sqrt(np.maximum(gaps[1], 0.0)), gaps[1] <= 0.0)
    )
    with np.errstate(invalid="ignore"):  # a gap may be infinite
        left = np.where(width <= before, zones[0] - half, np.roll(gaps[0] + half_gap, 1))
        right = np.where(width <= gap, zones[0] + half, gaps[0] - half_gap)
    if period is not None and width[0] > before[0]:
        left[0] -= period
    lost = lost & (width <= np.minimum(before, gap)) | (right <= left)
    closed = closed & (gap <= np.minimum(width, np.roll(width, -1)))
    return _remaining(left, right, lost, closed, period), int(
        np.sum(zones[1] <= 0.0) + np.sum(gaps[1] <= 0.0)
    )


def _half_widths(square: Array, before: Array) -> tuple[Array, Mask]:
    """Half widths from their extrapolated squares, and a mask of the intervals that vanished.

    An interval that may have vanished keeps a small half width.
    """
    # An interval counts as vanished only if it has vanished at half of the step. If it vanishes
    # later in the step, Newton's method removes it.
    gone = square <= -0.5 * (before - square)
    return np.sqrt(np.maximum(square, SEARCH.doubtful_part**2 * before)), gone


def _remaining(left: Array, right: Array, lost: Mask, closed: Mask, period: float | None) -> Array:
    """The zones that have not vanished; zones are merged if the gap between them has closed.

    The table is empty where all gaps have closed, as contact is full.
    """
    if lost.all() or (period is not None and closed.all() and not lost.any()):
        return np.zeros((0, 2))
    zones = merged(np.column_stack((left, right))[~lost], np.flatnonzero(closed[~lost]), period)
    return united(zones)


def _with_new(zones: Array, last: CurvePoint, away: float) -> Array:
    """The zones, with new zones at the places where the extrapolated gap is negative."""
    place, value, bend = last.lowest.T
    change = away * last.rates[1]
    depth = np.where(
        value + change < SEARCH.doubtful_part * np.abs(change),
        np.maximum(-value - change, SEARCH.doubtful_part * np.abs(change)),
        0.0,
    )
    period = last.problem.period
    place = sie.wrapped(place, float(zones[0, 0]), period)
    with np.errstate(invalid="ignore", divide="ignore"):
        half = NEW_ZONE * np.sqrt(np.maximum(depth, 0.0) / bend)
    before = np.searchsorted(zones[:, 0], place, side="right") - 1
    gaps = gaps_between(zones, period)
    low, high = (
        np.where(before >= 0, gaps[before, 0], -np.inf),
        np.where(before >= 0, gaps[before, 1], zones[0, 0]),
    )
    # A new zone reaches at most halfway to the neighbouring zones.
    room = 0.5 * np.minimum(place - low, high - place)
    new = np.flatnonzero((depth > 0.0) & (bend > 0.0) & (room > 0.0))
    half = np.minimum(half, room)[new]
    return united(np.concatenate((zones, np.column_stack((place[new] - half, place[new] + half)))))
