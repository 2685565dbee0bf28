"""The ends of the interval under given loads, all loads at once: Newton on one end or on two, and
the coefficients that are left.

Of a tip with a kink J = f'(0+) - f'(0-) the part J/2 sgn(x) is taken off f'; under it, with A = pi
a/L,

    p = (E*/2) (J/pi) arcosh(tan A / tan |u|),      load = (E*/2) (J L/pi) artanh(sin A)

(eq. (25) of Goryacheva & Tsukanov 2020, as corrected in docs/theory.md), and (J/pi) arcosh(a/|x|),
J a without a period. Between sharp corners, without slope, p = load cos u / (L sqrt(sin^2 A - sin^2
u)), load / (pi sqrt(a^2 - x^2)) (Sadowsky 1928).
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from contact.closed.maps import Map, Value, largest
from contact.closed.series import orders, powers, table
from contact.model.profiles.base import Profile
from sie import Array, Index, Mask, record

_EPS = float(np.finfo(float).eps)
# Nodes at first and at the most.
_FIRST = 8
_LARGEST = 512
# Part of the way to a border, or to each other, that ends of a pair go in a step; of that room what
# zones have at first.
_CUT = 0.8
_WITHIN = 0.95
_STEPS = 60
# Of the coefficients: what the last ones are beside the values, where the series is at its end.
_RESOLVED = 4.0
# And what is not kept of them at the end.
_NOTHING = 2.0
# Steps of an end in logarithms, after which it is at rest.
_AT_REST = 1e-9
# Steps of an end from which on the series is about that of the end; what falls as slowly is not
# told; and so many octaves of nodes too few may do all the same.
_ABOUT = 0.1
_SLOW = 0.9
_NEARLY = 0.1
# Below, numbers lose digits.
_SMALLEST = 1e-290
# Half lengths over middles of pairs, in y, beyond which they have merged.
_MERGED = 1.0 - 1e-9


@record
class Sheet:
    """What is common to all loads. kink: J at x = 0; corner: half width of a punch without slope,
    None where there are no corners; limit: the half width [m] that no zone exceeds; tip: half the
    distance of a pair's tips.
    """

    profile: Profile
    map: Map
    kink: float
    corner: float | None
    limit: float
    tip: float = 0.0

    @cached_property
    def top(self) -> float:
        """The limit in y."""
        return float(self.map.y(self.limit)) if math.isfinite(self.limit) else math.inf

    @cached_property
    def tip_at(self) -> float:
        """The tip in y."""
        return float(self.map.y(self.tip))


@record
class Ends:
    """Numbers of one load, or rows of several. inner, outer: ends of the right zone [m], of one
    zone -a and a; middle, half: of the interval in y; g: coefficients (..., orders); tail: the
    largest of the last ones, what was left off, over the largest value; off: what d ln(half) is off
    by; punch: load over E*/2 and pi times the half length of a flat punch; found: whether they came
    out.
    """

    sheet: Sheet
    inner: Value
    outer: Value
    middle: Value
    half: Value
    g: Array
    tail: Value
    off: Value
    steps: Value
    nodes: Value
    punch: Value
    found: Value

    def rows(self, chosen: Mask | int) -> "Ends":
        """Some of the loads, or one."""
        return replace(self, **{name: getattr(self, name)[chosen] for name in _ROWS})

    @property
    def odd(self) -> bool:
        """Whether the series has no even orders."""
        return not self.sheet.map.pair

    @property
    def first(self) -> Value:
        """g_1."""
        return self.g[..., 0] if self.g.shape[-1] else 0.0

    @cached_property
    def sums(self) -> tuple[Value, Value, Value]:
        """Of |g_k|, of k |g_k|, which no |q| exceeds, and of k^2 |g_k|."""
        plain, once, twice = np.abs(self.g).dot(powers(self.g.shape[-1], self.odd)).T
        return plain, once, twice

    @property
    def bound(self) -> Value:
        """What no pressure exceeds, over E*/2, but for kinks and corners."""
        return (
            self.outer if self.sheet.map.pair and self.sheet.map.period is None else 1.0
        ) * self.sums[1]

    @property
    def zones(self) -> int:
        return 2 if self.sheet.map.pair else 1

    @property
    def widths(self) -> Value:
        """Of one zone [m]."""
        return self.outer - self.inner

    @property
    def spreading(self) -> tuple[Value, Value]:
        """How far the inner and the outer end move outward in y as the load grows by a factor of e;
        zero at corners.
        """
        if self.sheet.corner is not None:
            return 0.0 * self.half, 0.0 * self.half
        way, total, k = self.sheet.map, self.totals, orders(self.g.shape[-1], self.odd)
        if way.pair:
            # By Newton's own matrix: each end by a half of the load over what q is there.
            upper, lower = self.g @ k, self.g @ (k * (2 * (k % 2) - 1))
            share = total / (way.load_factor * math.pi * self.half)
            return share * self.half / lower, share * self.half / upper
        rate = way.load_factor * math.pi * (self.g @ k) + _kink_load(self.sheet, self.half)[1]
        return total / rate, total / rate

    @property
    def rises(self) -> tuple[Value, Value]:
        """dy/dx at the inner and the outer end."""
        way = self.sheet.map
        inner, outer = (way.weight(np.abs(x)) / way.rise_factor for x in (self.inner, self.outer))
        return inner, outer

    @property
    def totals(self) -> Value:
        """Loads over E*/2, of all zones together [m]."""
        smooth = math.pi * self.half * (0.5 * self.first + self.punch)
        return self.sheet.map.load_factor * smooth + _kink_load(self.sheet, self.half)[0]


_ROWS = ("inner", "outer", "middle", "half", "g", "tail", "off", "steps", "nodes", "punch", "found")


def _kink_load(sheet: Sheet, half: Value) -> tuple[Value, Value]:
    """(load over E*/2 of the kink, its rate with the half length in y)."""
    if sheet.kink == 0.0:
        return 0.0, 0.0
    period = sheet.map.period
    if period is None:
        return sheet.kink * half, sheet.kink
    factor = sheet.kink * period / math.pi
    return factor * np.arctanh(half), factor / ((1.0 - half) * (1.0 + half))


def arcosh_over(ends: Ends, y: Array, over: Array, weight: Array | float) -> Array:
    """arcosh(tan A / tan u) at y, of one load; over: sqrt(1 - (tan u / tan A)^2), which is known to
    more digits next to the ends.
    """
    half = ends.half
    tangent = (
        half if ends.sheet.map.period is None else half / math.sqrt((1.0 - half) * (1.0 + half))
    )
    ratio = np.abs(y) / weight / tangent
    return np.where(over < 0.5, np.arctanh(np.minimum(over, 0.5)), np.log((1.0 + over) / ratio))


def ends_under(sheet: Sheet, loads: Value) -> Ends:
    """Loads over E*/2 [m], one or several."""
    if sheet.corner is not None:
        return _cornered(sheet, loads)
    if sheet.map.pair:
        return _pair_load(sheet, loads) if isinstance(loads, float) else _pair(sheet, loads)
    return _one_load(sheet, loads) if isinstance(loads, float) else _one(sheet, loads)


def ends_at(sheet: Sheet, half_width: float) -> Ends:
    """One zone of a given half width [m]."""
    half = float(sheet.map.y(half_width))

    def stands(middle: float, half: float, sums: list[float]) -> tuple[float, float, float, float]:
        return 0.0, 4.0 * _EPS, middle, half

    return replace(_settled(sheet, 0.0, half, stands), inner=-half_width, outer=half_width)


def _cornered(sheet: Sheet, loads: Value) -> Ends:
    assert sheet.corner is not None
    zero = 0.0 * loads
    outer = zero + sheet.corner
    half = sheet.map.y(outer)
    punch = loads / (sheet.map.load_factor * math.pi * half)
    none = np.zeros(np.shape(loads), dtype=np.intp)
    return Ends(
        sheet,
        -outer,
        outer,
        zero,
        half,
        np.zeros((*np.shape(loads), 0)),
        zero,
        zero,
        none,
        none + 1,
        punch,
        np.isfinite(punch),
    )


def _slopes(sheet: Sheet, y: Array) -> Array:
    """G at y, less the kink's part."""
    x, weight = sheet.map.at(y)
    slope = np.asarray(sheet.profile.slope(x), dtype=np.float64)
    if sheet.kink != 0.0:
        slope = slope - 0.5 * sheet.kink
    return np.asarray(slope / weight)


# One load, in numbers: there calls take longer than what they do
# ------------------------------------------------------ Of an interval, its middle and half length
# in y, and of what `Table.sums` makes of G there: how far Newton's step goes over the half length,
# what that is rounded to, and the next interval; None where there is no step.
_Step = Callable[[float, float, list[float]], tuple[float, float, float, float] | None]


def _settled(sheet: Sheet, middle: float, half: float, step: _Step) -> Ends:
    """Newton from a first interval: with few nodes first, and with as many as the series asks for
    where it has not come to its end.
    """
    odd, kink, wide = not sheet.map.pair, abs(sheet.kink), 4.0 * sheet.tip_at
    size, steps, rests = _FIRST if odd else 2 * _FIRST, 0, False
    while size <= _LARGEST:
        nodal, slowest = table(size, odd), None
        for _ in range(_STEPS):
            values = _slopes(sheet, half * nodal.t if odd else middle + half * nodal.t)
            sums = values.dot(nodal.sums).tolist()
            scale, last = largest(np.abs(values)) + kink, max(abs(sums[2]), abs(sums[3]))
            taken = step(middle, half, sums)
            if taken is None or not scale > 0.0:
                return _not_found(sheet)
            move, rounding, *to = taken
            steps += 1
            ended = last <= _EPS * (_RESOLVED + wide / half) * scale
            if ended and (rests or abs(move) <= 4.0 * rounding):
                series = nodal.coefficients(values)
                count, left = _without_last(np.abs(series).tolist())
                nodes = 2 * size if odd else size
                return _ends(
                    sheet,
                    middle,
                    half,
                    series[:count],
                    last / scale + left,
                    abs(move) + rounding,
                    steps,
                    nodes,
                )
            rests, (middle, half) = abs(move) <= _AT_REST, to
            if not ended and not abs(move) > _ABOUT:
                slowest = max(last / scale, _EPS)
                break
        if slowest is None:
            break
        size = _wider(size, slowest)
    return _not_found(sheet)


def _one_load(sheet: Sheet, load: float) -> Ends:
    """One zone: Newton on ln(half length), in which powers of the width are straight, from the
    second step on by the last two totals.
    """
    if not 0.0 < load < math.inf:
        return _not_found(sheet)
    top, factor = sheet.top, sheet.map.load_factor * math.pi
    # The logarithms of a total over the load and of its half length, and how that goes with the
    # total's.
    before: tuple[float, float, float] | None = None

    def step(
        middle: float, half: float, sums: list[float]
    ) -> tuple[float, float, float, float] | None:
        nonlocal before
        kinked, kinked_rate = _kink_load(sheet, half)
        total = 0.5 * factor * half * sums[0] + float(kinked)
        if not (total > 0.0 and 0.0 < load / total < math.inf):
            return None
        rate = half * (factor * sums[1] + float(kinked_rate)) / total
        if not 0.0 < abs(rate) < math.inf:
            return None
        here = -math.log(load / total), math.log(half), 1.0 / rate
        move = -here[0] / rate
        # Not past the widest, nor by many decades at once where the load hardly grows.
        way = (
            move
            if before is None or abs(here[0]) >= 0.5 * abs(before[0])
            else _by_both(before, here)
        )
        moved = half * math.exp(min(max(way, -40.0), 40.0))
        before = here
        return (
            move,
            4.0 * _EPS * (1.0 + 1.0 / abs(rate)),
            0.0,
            0.5 * (half + top) if moved >= top else moved,
        )

    return _settled(sheet, 0.0, 0.25 * top if math.isfinite(top) else 1.0, step)


def _by_both(before: tuple[float, float, float], here: tuple[float, float, float]) -> float:
    """How far it is in ln(half length) to the load that is asked for, by Hermite's cubic through
    two totals.
    """
    (a, at_a, rate_a), (b, at_b, rate_b) = before, here
    mean = (at_b - at_a) / (b - a)
    square = (rate_b - mean) / (b - a)
    cube = (square - (mean - rate_a) / (b - a)) / (b - a)
    return b * (b * (square - cube * a) - rate_b)


def _pair_load(sheet: Sheet, load: float) -> Ends:
    """Two zones: Newton on the middle and the half length of their interval, from narrow zones
    about the tips.
    """
    top, wanted = sheet.top, load / (sheet.map.load_factor * 0.5 * math.pi)

    def step(
        middle: float, half: float, sums: list[float]
    ) -> tuple[float, float, float, float] | None:
        missed, scale, by_middle, by_half = _of_pair(half, sums, wanted)
        if not (math.isfinite(missed) and scale != 0.0 and 0.0 < half < min(middle, top - middle)):
            return None
        by_middle, by_half = by_middle / scale, by_half / scale
        # Within the half of the period, and not past the middle.
        ahead = max(
            (by_half - by_middle) / (middle - half),
            (by_middle + by_half) / (top - middle - half),
            -by_half / half,
        )
        cut = min(1.0, _CUT / max(ahead, 1e-300))
        move, rounding = (
            (abs(by_middle) + abs(by_half)) / half,
            _EPS * (_RESOLVED + 4.0 * middle / half),
        )
        return move, rounding, middle + cut * by_middle, half + cut * by_half

    middle, half = _first_pair(sheet, wanted)
    return _settled(sheet, float(middle), float(half), step)


def _of_pair(half: Value, sums: Any, wanted: Value) -> tuple[Value, Value, Value, Value]:
    """(what the load is off by, a factor, and times it by how much Newton moves the middle and the
    half length): the solution of

    [odd / h, even / h; 2 even, 2 odd] (dm, dh) = -(mean, missed).
    """
    first, upper, _, _, lower, mean = sums
    missed, odd, even = half * first - wanted, 0.5 * (upper + lower), 0.5 * (upper - lower)
    return (
        missed,
        upper * lower,
        0.5 * even * missed - odd * mean * half,
        even * mean * half - 0.5 * odd * missed,
    )


def _wider(size: int, slowest: float) -> int:
    """How many nodes bring coefficients to rounding, of which the last were so large: they fall as
    a geometric series.
    """
    wanted = math.log(_EPS) / math.log(min(slowest, _SLOW))
    return size * int(2 ** max(1, math.ceil(math.log2(wanted) - _NEARLY)))


def _ends(
    sheet: Sheet,
    middle: Value,
    half: Value,
    g: Array,
    tail: Value,
    off: Value,
    steps: Value,
    nodes: Value,
) -> Ends:
    way = sheet.map
    outer = way.x(middle + half)
    inner = way.x(middle - half) if way.pair else -outer
    found = (outer < sheet.limit) & (off < 1e-6) & (half > _SMALLEST) & np.isfinite(tail)
    if way.pair:
        found = found & (half < _MERGED * middle)
    return Ends(sheet, inner, outer, middle, half, g, tail, off, steps, nodes, 0.0 * half, found)


def _not_found(sheet: Sheet) -> Ends:
    return Ends(sheet, 0.0, 0.0, 0.0, 0.0, np.zeros(0), 0.0, 0.0, 0, 0, 0.0, False)


# Several loads at once
# ------------------------------------------------------------------------------------------------
# As `_Step`, of rows: which they are, their middles, half lengths and sums (6, rows).
_Steps = Callable[[Index, Array, Array, Array], tuple[Array, Array, Array, Array]]


def _one(sheet: Sheet, loads: Array) -> Ends:
    """One zone."""
    top, factor = sheet.top, sheet.map.load_factor * math.pi

    def step(
        rows: Index, middle: Array, half: Array, sums: Array
    ) -> tuple[Array, Array, Array, Array]:
        kinked, kinked_rate = _kink_load(sheet, half)
        total = (0.5 * factor) * half * sums[0] + kinked
        rate = half * (factor * sums[1] + kinked_rate) / total
        move = np.log(loads[rows] / total) / rate
        moved = half * np.exp(np.clip(move, -40.0, 40.0))
        return (
            move,
            4.0 * _EPS * (1.0 + 1.0 / np.abs(rate)),
            middle,
            np.where(moved >= top, 0.5 * (half + top), moved),
        )

    return _settled_rows(
        sheet,
        np.zeros(len(loads)),
        np.full(len(loads), 0.25 * top if math.isfinite(top) else 1.0),
        step,
    )


def _pair(sheet: Sheet, loads: Array) -> Ends:
    """Two zones."""
    top, wanted = sheet.top, loads / (sheet.map.load_factor * 0.5 * math.pi)

    def step(
        rows: Index, middle: Array, half: Array, sums: Array
    ) -> tuple[Array, Array, Array, Array]:
        _, scale, by_middle, by_half = _of_pair(half, sums, wanted[rows])
        by_middle, by_half = by_middle / scale, by_half / scale
        ahead = np.maximum(
            (by_half - by_middle) / (middle - half), (by_middle + by_half) / (top - middle - half)
        )
        cut = np.minimum(1.0, _CUT / np.maximum(np.maximum(ahead, -by_half / half), 1e-300))
        move, rounding = (
            (np.abs(by_middle) + np.abs(by_half)) / half,
            _EPS * (_RESOLVED + 4.0 * middle / half),
        )
        return move, rounding, middle + cut * by_middle, half + cut * by_half

    return _settled_rows(sheet, *_first_pair(sheet, wanted), step)


def _settled_rows(sheet: Sheet, middle: Array, half: Array, step: _Steps) -> Ends:
    """Newton on each of the rows from its first interval, which is written over, those together
    that have come as far.
    """
    odd, kink, wide, count = not sheet.map.pair, abs(sheet.kink), 4.0 * sheet.tip_at, len(half)
    rests, off, tail = np.zeros(count, dtype=bool), np.full(count, np.inf), np.full(count, np.inf)
    steps, nodes = np.zeros(count, dtype=np.intp), np.zeros(count, dtype=np.intp)
    series: list[tuple[Index, Array]] = []
    pending, size = np.arange(count), _FIRST if odd else 2 * _FIRST
    while len(pending) and size <= _LARGEST:
        nodal, wider, slowest = table(size, odd), [], _EPS
        for _ in range(_STEPS):
            values = _slopes(sheet, middle[pending, None] + half[pending, None] * nodal.t)
            sums = (values @ nodal.sums).T
            scale, last = np.abs(values).max(axis=1) + kink, np.abs(sums[2:4]).max(axis=0)
            move, rounding, *to = step(pending, middle[pending], half[pending], sums)
            steps[pending] += 1
            ended = last <= _EPS * (_RESOLVED + wide / half[pending]) * scale
            # As many nodes as the series asks for are taken where it is about known.
            coarse, goes = ~ended & ~(np.abs(move) > _ABOUT), np.isfinite(move)
            done = ended & (rests[pending] | (np.abs(move) <= 4.0 * rounding))
            if done.any():
                rows = pending[done]
                series.append((rows, nodal.coefficients(values[done])))
                off[rows], tail[rows] = (
                    np.abs(move[done]) + rounding[done],
                    last[done] / scale[done],
                )
                nodes[rows] = 2 * size if odd else size
            going = pending[~done]
            middle[going], half[going] = (ahead[~done] for ahead in to)
            rests[going] = np.abs(move[~done]) <= _AT_REST
            wider.append(pending[coarse & goes])
            if coarse.any():
                slowest = max(slowest, float((last[coarse] / scale[coarse]).max()))
            pending = pending[~done & ~coarse & goes]
            if not len(pending):
                break
        pending, size = np.concatenate(wider), _wider(size, slowest)
    g = np.zeros((count, max((block.shape[1] for _, block in series), default=0)))
    for rows, block in series:
        g[rows, : block.shape[1]] = block
    # As many as some load needs.
    part = np.abs(g) / np.maximum(np.abs(g).max(axis=1, initial=0.0), _SMALLEST)[:, None]
    kept, _ = _without_last(part.max(axis=0, initial=0.0).tolist())
    return _ends(
        sheet, middle, half, g[:, :kept], tail + part[:, kept:].sum(axis=1), off, steps, nodes
    )


def _without_last(size: list[float]) -> tuple[int, float]:
    """(how many of these sizes of coefficients are kept, without the last ones that are rounding
    alone; what is left off over the largest of them).
    """
    scale = max(size, default=0.0)
    count = len(size)
    while count and not size[count - 1] > _NOTHING * _EPS * scale:
        count -= 1
    return count, sum(size[count:]) / scale if scale > 0.0 else 0.0


def _first_pair(sheet: Sheet, wanted: Value) -> tuple[Value, Value]:
    """(middles, half lengths) of the intervals of narrow zones, whose load goes with the square of
    their width; of wide ones these move over, for the room beside the tip.
    """
    tip, top = sheet.tip_at, sheet.top
    near, nodal = 0.01 * min(tip, top - tip), table(_FIRST, False)
    slope = float(_slopes(sheet, tip + near * nodal.t).dot(nodal.sums[:, 0])) / near
    half = np.minimum(np.sqrt(wanted / slope), 0.45 * top)
    return np.minimum(np.maximum(tip, half / _WITHIN), top - half / _WITHIN), half
