"""The ends of the interval under given loads, all loads at once: Newton on one end or on two, and the coefficients that are left.

Of a tip with a kink J = f'(0+) - f'(0-) the part J/2 sgn(x) is taken off f'; under it, with A = pi a/L,

    p = (E*/2) (J/pi) arcosh(tan A / tan |u|),      load = (E*/2) (J L/pi) artanh(sin A)

(eq. (25) of Goryacheva & Tsukanov 2020, as corrected in docs/theory.md), and (J/pi) arcosh(a/|x|), J a without a period. Between sharp
corners, without slope, p = load cos u / (L sqrt(sin^2 A - sin^2 u)), load / (pi sqrt(a^2 - x^2)) (Sadowsky 1928).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contact.formulation.direct.maps import Map
from contact.formulation.direct.series import Table, table
from contact.model.profiles.base import Profile

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Index = NDArray[np.intp]

_EPS = float(np.finfo(float).eps)
# Nodes at first and at the most.
_FIRST, _LARGEST = 8, 512
_STEPS = 60
# Of the coefficients: what the last ones are beside the values, where the series is at its end.
_RESOLVED = 4.0
# And what is not kept of them at the end.
_NOTHING = 2.0
# Steps of an end in logarithms, after which it is at rest.
_AT_REST = 1e-9
# Steps of an end from which on the series is about that of the end; what falls as slowly is not told; and so many octaves of nodes too few
# may do all the same.
_ABOUT, _SLOW, _NEARLY = 0.1, 0.9, 0.1
# Below, numbers lose digits.
_SMALLEST = 1e-290
# Half lengths over middles of pairs, in y, beyond which they have merged.
_MERGED = 1.0 - 1e-9


@dataclass(frozen=True, eq=False)
class Sheet:
    """What is common to all loads. kink: J at x = 0; corner: half width of a punch without slope, None where there are no corners;
    limit: the half width [m] that no zone exceeds; tip: half the distance of a pair's tips."""

    profile: Profile
    map: Map
    kink: float
    corner: float | None
    limit: float
    tip: float = 0.0


@dataclass(frozen=True, eq=False)
class Ends:
    """One row a load. inner, outer: ends of the right zone [m], of one zone -a and a; middle, half: of the interval in y; g: coefficients
    (rows, orders); tail: the largest of the last ones, what was left off, over the largest value; off: what d ln(half) is off by; punch:
    load over E*/2 and pi times the half length of a flat punch; found: whether a row came out."""

    sheet: Sheet
    inner: Array
    outer: Array
    middle: Array
    half: Array
    g: Array
    orders: Index
    tail: Array
    off: Array
    steps: NDArray[np.intp]
    nodes: NDArray[np.intp]
    punch: Array
    found: Mask

    def rows(self, chosen: Mask | slice) -> Ends:
        """Some of the rows."""
        return replace(self, **{name: getattr(self, name)[chosen] for name in _ROWS})

    @property
    def widths(self) -> Array:
        """Of one zone [m]."""
        return self.outer - self.inner

    @property
    def spreading(self) -> tuple[Array, Array]:
        """How far the inner and the outer end move outward in y as the load grows by a factor of e; zero at corners."""
        if self.sheet.corner is not None:
            return 0.0 * self.half, 0.0 * self.half
        way, total = self.sheet.map, self.totals
        if way.pair:
            # By Newton's own matrix: each end by a half of the load over what q is there.
            upper, lower = self.g @ self.orders, self.g @ (self.orders * (2 * (self.orders % 2) - 1))
            share = total / (way.load_factor * math.pi * self.half)
            return share * self.half / lower, share * self.half / upper
        rate = way.load_factor * math.pi * (self.g @ self.orders) + _kink_load(self.sheet, self.half)[1]
        return total / rate, total / rate

    @property
    def rises(self) -> tuple[Array, Array]:
        """dy/dx at the inner and the outer end."""
        way = self.sheet.map
        inner, outer = np.abs(self.inner), self.outer
        return tuple(np.asarray(way.weight(x, way.y(x)) / way.rise_factor + 0.0 * x) for x in (inner, outer))  # type: ignore[return-value]

    @property
    def totals(self) -> Array:
        """Loads over E*/2, of all zones together [m]."""
        smooth = 0.5 * math.pi * self.half * (self.g[:, 0] if self.g.shape[1] else 0.0)
        total = self.sheet.map.load_factor * (smooth + math.pi * self.half * self.punch)
        return np.asarray(total + _kink_load(self.sheet, self.half)[0])


_ROWS = ("inner", "outer", "middle", "half", "g", "tail", "off", "steps", "nodes", "punch", "found")


def _kink_load(sheet: Sheet, half: Array) -> tuple[Array | float, Array | float]:
    """(load over E*/2 of the kink, its rate with the half length in y)."""
    if sheet.kink == 0.0:
        return 0.0, 0.0
    period = sheet.map.period
    if period is None:
        return sheet.kink * half, sheet.kink
    factor = sheet.kink * period / math.pi
    return factor * np.arctanh(half), factor / ((1.0 - half) * (1.0 + half))


def arcosh_over(ends: Ends, y: Array, over: Array, weight: Array | float) -> Array:
    """arcosh(tan A / tan u) at y, of one row; over: sqrt(1 - (tan u / tan A)^2), which is known to more digits next to the ends."""
    half = float(ends.half[0])
    tangent = half if ends.sheet.map.period is None else half / math.sqrt((1.0 - half) * (1.0 + half))
    ratio = np.abs(y) / weight / tangent
    return np.where(over < 0.5, np.arctanh(np.minimum(over, 0.5)), np.log((1.0 + over) / ratio))


def ends_under(sheet: Sheet, loads: Array) -> Ends:
    """Loads over E*/2 [m]."""
    with np.errstate(all="ignore"):
        if sheet.corner is not None:
            return _cornered(sheet, loads)
        if sheet.map.pair:
            return _pair_load(sheet, float(loads[0])) if len(loads) == 1 else _pair(sheet, loads)
        return _one_load(sheet, float(loads[0])) if len(loads) == 1 else _one(sheet, loads)


def ends_at(sheet: Sheet, half_widths: Array) -> Ends:
    """One zone of given half widths [m]."""
    with np.errstate(all="ignore"):
        return _one(sheet, np.full(len(half_widths), np.nan), sheet.map.y(half_widths), half_widths)


def _cornered(sheet: Sheet, loads: Array) -> Ends:
    rows = len(loads)
    assert sheet.corner is not None
    outer = np.full(rows, sheet.corner)
    half = np.asarray(sheet.map.y(outer))
    zero, none = np.zeros(rows), np.zeros(rows, dtype=np.intp)
    punch = loads / (sheet.map.load_factor * math.pi * half)
    return Ends(
        sheet, -outer, outer, zero, half, np.zeros((rows, 0)), np.zeros(0, dtype=np.intp), zero, zero, none, none + 1, punch,
        np.isfinite(punch),
    )


def _slopes(sheet: Sheet, y: Array) -> Array:
    """G at y, less the kink's part."""
    x = sheet.map.x(y)
    slope = np.asarray(sheet.profile.slope(x), dtype=np.float64)
    if sheet.kink != 0.0:
        slope = slope - 0.5 * sheet.kink
    return np.asarray(slope / sheet.map.weight(x, y))


def _one(sheet: Sheet, loads: Array, given: Array | None = None, widths: Array | None = None) -> Ends:
    """One zone: Newton on ln(half length), in which powers of the width are straight. given: half lengths, and widths, that stand."""
    top, factor = float(sheet.map.y(np.array(sheet.limit))), sheet.map.load_factor * math.pi
    book = _Book(len(loads), 0.25 * top if math.isfinite(top) else 1.0)
    if given is not None:
        book.half, book.rests = given, np.ones(len(loads), dtype=bool)

    def step(rows: Index, nodal: Table) -> tuple[Array, Array, Array]:
        half = book.half[rows]
        values = _slopes(sheet, half[:, None] * nodal.t)
        kinked, kinked_rate = _kink_load(sheet, half)
        total = (0.5 * factor) * half * (values @ nodal.first) + kinked
        rate = half * (factor * (values @ nodal.edge) + kinked_rate) / total
        move = np.log(loads[rows] / total) / rate if given is None else np.zeros(len(rows))
        # Not past the widest, nor by many decades at once where the load hardly grows.
        moved = half * np.exp(np.clip(move, -40.0, 40.0))
        book.next_half[rows] = np.where(moved >= top, 0.5 * (half + top), moved)
        return values, move, 4.0 * _EPS * (1.0 + 1.0 / np.abs(rate))

    book.settle(step, True, abs(sheet.kink), np.zeros(len(loads)))
    half = book.half
    outer = np.asarray(sheet.map.x(half)) if widths is None else widths
    return book.ends(sheet, -outer, outer, np.zeros(len(loads)), book.came_out & (outer < sheet.limit), True)


def _one_load(sheet: Sheet, load: float) -> Ends:
    """The same of one load, in numbers: there calls take longer than what they do."""
    way = sheet.map
    top, factor, kink = float(way.y(np.array(sheet.limit))), way.load_factor * math.pi, abs(sheet.kink)
    half, size, steps, rests = 0.25 * top if math.isfinite(top) else 1.0, _FIRST, 0, False
    while size <= _LARGEST:
        nodal, slowest, coarse = table(size, True), _EPS, False
        for _ in range(_STEPS):
            values = _slopes(sheet, half * nodal.t)
            first, edge, *ending = (values @ nodal.sums[:, :4]).tolist()
            kinked, kinked_rate = _kink_load(sheet, half)  # type: ignore[arg-type]
            total = 0.5 * factor * half * first + float(kinked)
            rate = half * (factor * edge + float(kinked_rate)) / total if total else math.nan
            if not (load / total > 0.0 and abs(rate) > 0.0 and math.isfinite(rate)):
                return _not_found(sheet)
            move, rounding = math.log(load / total) / rate, 4.0 * _EPS * (1.0 + 1.0 / abs(rate))
            scale, last = float(np.abs(values).max()) + kink, max(map(abs, ending))
            steps += 1
            ended = last <= _EPS * _RESOLVED * scale
            if ended and (rests or abs(move) <= 4.0 * rounding):
                return _of_series(sheet, half, nodal.coefficients(values[None]), last / scale, abs(move) + rounding, steps, 2 * size)
            # As in the rows of a book: as many nodes as the series asks for, not past the widest, nor by many decades at once.
            coarse = not ended and not abs(move) > _ABOUT
            moved = half * math.exp(min(max(move, -40.0), 40.0))
            half, rests = 0.5 * (half + top) if moved >= top else moved, abs(move) <= _AT_REST
            if coarse:
                slowest = max(last / scale, _EPS)
                break
        if not coarse:
            return _not_found(sheet)
        size = _wider(size, slowest)
    return _not_found(sheet)


def _wider(size: int, slowest: float) -> int:
    """How many nodes bring coefficients to rounding, of which the last were so large: they fall as a geometric series."""
    wanted = math.log(_EPS) / math.log(min(slowest, _SLOW))
    return size * int(2 ** max(1, math.ceil(math.log2(wanted) - _NEARLY)))


def _of_series(sheet: Sheet, half: float, series: Array, tail: float, off: float, steps: int, nodes: int) -> Ends:
    """One row of one zone."""
    g, left = _without_last(series)
    outer, zero = np.array([float(sheet.map.x(np.array(half)))]), np.zeros(1)
    found = np.array([outer[0] < sheet.limit and off < 1e-6 and half > _SMALLEST])
    return Ends(
        sheet, -outer, outer, zero, np.array([half]), g, 2 * np.arange(g.shape[1]) + 1, tail + left, np.array([off]),
        np.array([steps], dtype=np.intp), np.array([nodes], dtype=np.intp), zero, found,
    )


def _not_found(sheet: Sheet) -> Ends:
    zero, none = np.zeros(1), np.zeros(1, dtype=np.intp)
    return Ends(
        sheet, zero, zero, zero, zero, np.zeros((1, 0)), none[:0], zero, zero, none, none, zero, np.zeros(1, dtype=bool),
    )


class _Book:
    """Rows on their way: Newton on each with few nodes first, and with twice as many where the series has not come to its end."""

    def __init__(self, rows: int, half: float | Array) -> None:
        self.half = np.full(rows, half) if isinstance(half, float) else half
        self.next_half = self.half.copy()
        self.middle = self.next_middle = np.zeros(rows)
        self.rests, self.came_out = np.zeros(rows, dtype=bool), np.zeros(rows, dtype=bool)
        self.off, self.tail = np.full(rows, np.inf), np.full(rows, np.inf)
        self.steps, self.nodes = np.zeros(rows, dtype=np.intp), np.zeros(rows, dtype=np.intp)
        self.series: list[tuple[Index, Array]] = []

    def settle(self, step: Callable[[Index, Table], tuple[Array, Array, Array]], odd: bool, kink: float, rounded: Array) -> None:
        """step: of rows with the nodes of a table, (values, how far it goes over the half length, its rounding), which leaves the next half
        lengths and middles. rounded: places over half lengths, to whose rounding values are known."""
        pending, size = np.arange(len(self.half)), _FIRST if odd else 2 * _FIRST
        while len(pending) and size <= _LARGEST:
            nodal, wider, slowest = table(size, odd), [], _EPS
            for _ in range(_STEPS):
                values, move, rounding = step(pending, nodal)
                scale = np.abs(values).max(axis=1) + kink
                last = np.abs(values @ nodal.last).max(axis=1)
                self.steps[pending] += 1
                far = ~(np.abs(move) <= _AT_REST)
                ended = last <= _EPS * (_RESOLVED + rounded[pending] / self.half[pending]) * scale
                # As many nodes as the series asks for are taken where it is about known.
                coarse = ~ended & ~(np.abs(move) > _ABOUT)
                done = ended & (self.rests[pending] | (np.abs(move) <= 4.0 * rounding))
                if done.any():
                    rows = pending[done]
                    self.series.append((rows, nodal.coefficients(values[done])))
                    self.off[rows], self.tail[rows] = np.abs(move[done]) + rounding[done], last[done] / scale[done]
                    self.nodes[rows], self.came_out[rows] = 2 * size if odd else size, True
                going = pending[~done]
                self.half[going], self.middle[going] = self.next_half[going], self.next_middle[going]
                self.rests[going] = ~far[~done]
                wider.append(pending[coarse & np.isfinite(move)])
                if coarse.any():
                    slowest = max(slowest, float((last[coarse] / scale[coarse]).max()))
                pending = pending[~done & ~coarse & np.isfinite(move)]
                if not len(pending):
                    break
            pending, size = np.concatenate(wider), _wider(size, slowest)

    def ends(self, sheet: Sheet, inner: Array, outer: Array, middle: Array, found: Mask, odd: bool) -> Ends:
        most = max((block.shape[1] for _, block in self.series), default=0)
        series = np.zeros((len(self.half), most))
        for rows, block in self.series:
            series[rows, : block.shape[1]] = block
        g, left = _without_last(series)
        orders = 2 * np.arange(g.shape[1]) + 1 if odd else np.arange(1, g.shape[1] + 1)
        found = found & np.isfinite(self.tail) & (self.off < 1e-6) & (self.half > _SMALLEST)
        none = np.zeros(len(self.half))
        return Ends(sheet, inner, outer, middle, self.half, g, orders, self.tail + left, self.off, self.steps, self.nodes, none, found)


def _without_last(series: Array) -> tuple[Array, Array]:
    """Coefficients without the last columns that are rounding alone, and what was left off over the largest."""
    size = np.abs(series)
    scale = size.max(axis=1, initial=0.0)
    kept = np.flatnonzero((size > _NOTHING * _EPS * scale[:, None]).any(axis=0))
    count = int(kept[-1]) + 1 if len(kept) else 0
    left = size[:, count:].sum(axis=1) / np.where(scale > 0, scale, 1.0)
    return np.ascontiguousarray(series[:, :count]), left


def _pair(sheet: Sheet, loads: Array) -> Ends:
    """Two zones: Newton on the middle and the half length of their interval, from narrow zones about the tips."""
    tip, top = float(sheet.map.y(np.array(sheet.tip))), float(sheet.map.y(np.array(sheet.limit)))
    wanted_of = loads / (sheet.map.load_factor * 0.5 * math.pi)
    book = _Book(len(loads), _first_halves(sheet, wanted_of, tip, top))
    book.middle, book.next_middle = np.full(len(loads), tip), np.full(len(loads), tip)

    def step(rows: Index, nodal: Table) -> tuple[Array, Array, Array]:
        middle, half = book.middle[rows], book.half[rows]
        values = _slopes(sheet, middle[:, None] + half[:, None] * nodal.t)
        mean = values.mean(axis=1)
        missed = half * (values @ nodal.first) - wanted_of[rows]
        upper, lower = values @ nodal.edge, values @ nodal.far_edge
        odd, even = 0.5 * (upper + lower), 0.5 * (upper - lower)
        # [odd / h, even / h; 2 even, 2 odd] (dm, dh) = -(mean, missed)
        scale = upper * lower
        by_middle = (0.5 * even * missed - odd * mean * half) / scale
        by_half = (even * mean * half - 0.5 * odd * missed) / scale
        # Within the half of the period, and not past the middle.
        up, down = by_middle + by_half, by_half - by_middle
        ahead = np.maximum(np.maximum(down / (middle - half), up / (top - middle - half)), -by_half / half)
        cut = np.minimum(1.0, 0.5 / np.maximum(ahead, 1e-300))
        book.next_middle[rows], book.next_half[rows] = middle + cut * by_middle, half + cut * by_half
        return values, (np.abs(by_middle) + np.abs(by_half)) / half, _EPS * (_RESOLVED + 4.0 * middle / half)

    book.settle(step, False, 0.0, np.full(len(loads), 4.0 * tip))
    low, middle, half = book.middle - book.half, book.middle, book.half
    inner, outer = np.asarray(sheet.map.x(low)), np.asarray(sheet.map.x(middle + half))
    return book.ends(sheet, inner, outer, middle, book.came_out & (outer < sheet.limit) & (half < _MERGED * middle) & (low > 0.0), False)


def _pair_load(sheet: Sheet, load: float) -> Ends:
    """The same of one load, in numbers."""
    way = sheet.map
    tip, top = float(way.y(np.array(sheet.tip))), float(way.y(np.array(sheet.limit)))
    wanted = load / (way.load_factor * 0.5 * math.pi)
    middle, half = tip, float(_first_halves(sheet, np.array(wanted), tip, top))
    size, steps, rests = 2 * _FIRST, 0, False
    while size <= _LARGEST:
        nodal, slowest, coarse = table(size, False), _EPS, False
        for _ in range(_STEPS):
            values = _slopes(sheet, middle + half * nodal.t)
            first, upper, *ending, lower, mean = (values @ nodal.sums).tolist()
            missed, odd, even = half * first - wanted, 0.5 * (upper + lower), 0.5 * (upper - lower)
            if not (math.isfinite(missed) and upper * lower != 0.0 and 0.0 < half < middle):
                return _not_found(sheet)
            by_middle = (0.5 * even * missed - odd * mean * half) / (upper * lower)
            by_half = (even * mean * half - 0.5 * odd * missed) / (upper * lower)
            move, rounding = (abs(by_middle) + abs(by_half)) / half, _EPS * (_RESOLVED + 4.0 * middle / half)
            scale, last = float(np.abs(values).max()), max(map(abs, ending))
            steps += 1
            ended = last <= _EPS * (_RESOLVED + 4.0 * tip / half) * scale
            if ended and (rests or move <= 4.0 * rounding):
                return _of_pair(sheet, middle, half, nodal.coefficients(values[None]), last / scale, move + rounding, steps, size)
            coarse = not ended and not move > _ABOUT
            # Within the half of the period, and not past the middle.
            ahead = max((by_half - by_middle) / (middle - half), (by_middle + by_half) / (top - middle - half), -by_half / half)
            cut = min(1.0, 0.5 / max(ahead, 1e-300))
            middle, half, rests = middle + cut * by_middle, half + cut * by_half, move <= _AT_REST
            if coarse:
                slowest = max(last / scale, _EPS)
                break
        if not coarse:
            return _not_found(sheet)
        size = _wider(size, slowest)
    return _not_found(sheet)


def _of_pair(
    sheet: Sheet, middle: float, half: float, series: Array, tail: float, off: float, steps: int, nodes: int
) -> Ends:
    """One row of a pair."""
    g, left = _without_last(series)
    inner, outer = np.asarray(sheet.map.x(np.array([[middle - half], [middle + half]])))
    found = np.array([outer[0] < sheet.limit and half < _MERGED * middle and off < 1e-6 and half > _SMALLEST])
    return Ends(
        sheet, inner, outer, np.array([middle]), np.array([half]), g, np.arange(1, g.shape[1] + 1), tail + left, np.array([off]),
        np.array([steps], dtype=np.intp), np.array([nodes], dtype=np.intp), np.zeros(1), found,
    )


def _first_halves(sheet: Sheet, wanted: Array, tip: float, top: float) -> Array:
    """Half lengths of narrow zones, whose load goes with the square of their width; not so wide that they would meet."""
    room = min(tip, top - tip)
    near, nodal = 0.01 * room, table(_FIRST, False)
    slope = float(_slopes(sheet, np.array([tip + near * nodal.t])) [0] @ nodal.first) / near
    return np.asarray(np.minimum(np.sqrt(wanted / slope), 0.9 * room))
