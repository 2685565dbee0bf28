"""Signs of a contact that is one interval: the pressure inside, the gap outside, of one load or of
several in rows; and its stated error.

Inside, p / sqrt(1 - t^2) is a polynomial (and a part of the kink, which is positive): no lower than
its first coefficient less what all others can make, by k |g_k|; where that does not tell it is
sampled so closely that nothing is hidden between. Outside the slope of the gap is

    gap' = w (G - sum g_k rho^k)     and     J/pi arccos(tan A / tan u)     of the kink,

and where it is nowhere negative outwards, and nowhere positive between the zones of a pair, the gap
is least at the ends, where it is zero. Where it is, as beside the border of a lone wave, the gap
itself is looked at.

The stated error is that of the ends over the width of a zone, and of the pressure over the mean on
it, which is at most its peak.

Ends are off by what Newton has left and by rounding. At a place of the interval that stays, the
pressure follows them, and by what the weight w changes; itself it is off by the coefficients that
were left off, which fall as a geometric series, and by rounding.

Ends that move by parts of the half length add q(+-1) / sqrt(1 - t^2) to Phi, and the place moves
with them. With t = cos(a) the first changes sum k g_k sin(k a) by k g_k (1 - cos(a) cos(k a)) /
sin(a) of odd orders as the half length grows, and so on of even ones, and as the middle moves:
(cos(a) - cos(k a)) / sin(a), (1 - cos(k a)) / sin(a) and cos(a) (1 - cos(k a)) / sin(a), none of
them above k.
"""

import math
from functools import lru_cache

import numpy as np

from contact.closed.ends import Ends
from contact.closed.maps import Value, column, everywhere, largest, least, smallest
from contact.closed.series import WIDENED, Table, off, off_integral, table
from sie import Array

# Places outside: beside the zones, per length over which the shape varies, at the most; and how far
# away, in half lengths.
_BESIDE = 32
_PER_FEATURE = 4
_MOST = 4096
_FARTHEST = 1e12
_FAR = 512
# Of the largest gap slope, or gap: what is not told from rounding, over the coarseness of the
# values next to an end.
_CLEAR = 1e-12
# Of the largest q: what is clear of zero.
_PLAIN = 1e-3
_SAMPLED = 1e-9
_EPS = float(np.finfo(float).eps)


def signs(ends: Ends) -> tuple[Value, Value]:
    """(whether both are right, beyond doubt; the least gap [m] at a place that was looked at, inf
    where the gap opens all the way).
    """
    if ends.sheet.corner is not None:
        return ends.punch > 0.0, math.inf
    pushes = _pushes(ends)
    opens, gap = _opens(ends)
    return pushes & opens, gap


# inside
# ---------------------------------------------------------------------------------------------------------------
def _pushes(ends: Ends) -> Value:
    """Whether q, and the kink's part where it is least, are clear of zero."""
    _, most, _ = ends.sums
    kinked, first = ends.sheet.kink / math.pi, ends.first
    clear = kinked + first + abs(first) - most > _PLAIN * (kinked + most)
    if everywhere(clear):
        return clear
    value = _looks(ends).samples(ends.g) + kinked
    low, high = least(value), largest(value)
    clear = clear | (low - 0.5 * WIDENED * (high - low) > _PLAIN * high)
    if everywhere(clear):
        return clear
    # Not so even that the hull would tell: by how much a polynomial falls below its samples where
    # it bends as they do, twice over.
    bend = np.abs(value[..., :-2] - 2.0 * value[..., 1:-1] + value[..., 2:])
    return clear | (np.minimum(low, least(value[..., 1:-1] - 0.25 * bend)) > _SAMPLED * high)


def _looks(ends: Ends) -> Table:
    nodes = max(int(np.max(ends.nodes)), 2)
    return table(nodes if ends.sheet.map.pair else nodes // 2, ends.odd)


def least_inside(ends: Ends) -> tuple[float, int]:
    """(the least p / sqrt(1 - t^2) of one load, over E*/2, at places as close as signs may be told
    by; how many).
    """
    if ends.sheet.corner is not None:
        return float(ends.punch), 0
    way, looks = ends.sheet.map, _looks(ends)
    y = ends.middle + ends.half * looks.cosines
    return float(((looks.samples(ends.g) + ends.sheet.kink / math.pi) * way.at(y)[1]).min()), y.size


# outside
# --------------------------------------------------------------------------------------------------------------
def places(ends: Ends) -> Array:
    """Places t (..., places) at which the gap is looked at: above 1 beyond the outer end, below -1
    between the zones of a pair. They are closer beside a zone, and as close everywhere as the shape
    varies, where that is known.
    """
    profile, limit, middle, half = (
        ends.sheet.profile,
        ends.sheet.limit,
        column(ends.middle),
        column(ends.half),
    )
    if not math.isfinite(limit):
        beyond = _to_far_away() + 0.0 * half
    else:
        feature, count = profile.resolution, _BESIDE
        if feature is not None:
            count = int(
                min(max(_PER_FEATURE * (limit - smallest(ends.outer)) / feature, _BESIDE), _MOST)
            )
        beyond = 1.0 + ((ends.sheet.top - middle) / half - 1.0) * _squares(count)
    if not ends.sheet.map.pair:
        return beyond
    return np.concatenate((beyond, -1.0 - (middle / half - 1.0) * _squares(_BESIDE)), axis=-1)


@lru_cache(maxsize=8)
def _squares(count: int) -> Array:
    """Places in (0, 1), closer next to 0."""
    return np.asarray(((np.arange(count) + 0.5) / count) ** 2)


@lru_cache(maxsize=1)
def _to_far_away() -> Array:
    """Places from 1 on, closer there, and evenly in the logarithm far away."""
    return np.concatenate((1.0 + 3.0 * _squares(_BESIDE), np.geomspace(4.5, _FARTHEST, _FAR)))


def _opens(ends: Ends) -> tuple[Value, Value]:
    """(whether the gap opens away from the zones, or at least stays open; the least gap that was
    seen where it was looked at).
    """
    sheet, t = ends.sheet, places(ends)
    y = column(ends.middle) + column(ends.half) * t
    x, weight = sheet.map.at(y)
    slope = np.asarray(sheet.profile.slope(x), dtype=float)
    own = (slope - 0.5 * sheet.kink if sheet.kink else slope) / weight
    rises = own - off(ends.g, ends.odd, t)
    if sheet.map.pair:
        rises *= np.sign(t)
    if sheet.kink > 0.0:
        ratio = (
            1.0 / t
            if sheet.map.period is None
            else weight / (t * np.sqrt(1.0 - column(ends.half) ** 2))
        )
        rises += sheet.kink / math.pi * np.arccos(np.minimum(ratio, 1.0)) / weight
    opens = least(rises) > 0.0
    if everywhere(opens):
        return opens, math.inf
    # Far away heights may overflow: nothing touches there.
    rises[np.isposinf(slope)] = math.inf
    if rises.ndim == 1:
        return _stays_open(ends, t, own, rises)
    gap = np.full(len(opens), math.inf)
    for k in map(int, np.flatnonzero(~opens)):
        opens[k], gap[k] = _stays_open(ends.rows(k), t[k], own[k], rises[k])
    return opens, gap


def _stays_open(ends: Ends, t: Array, own: Array, rises: Array) -> tuple[bool, float]:
    """Of one load whose gap does not open all the way: whether it does to rounding, or else is
    clearly above zero where it does not; and how small it is seen to be there.
    """
    # What the places of narrow zones are rounded to.
    rounding = 16.0 * _EPS * (1.0 + 4.0 * ends.middle / ends.half)
    falls = ~(rises > -rounding * (np.abs(own) + ends.sums[0] + abs(ends.sheet.kink)))
    opens, gap = True, math.inf
    for side in (1.0, -1.0) if ends.sheet.map.pair else (1.0,):
        here = t * side > 0.0
        if falls[here].any() or not rises[here].max() > 0.0:
            stays, seen = _smallest(ends, t[here], side)
            opens, gap = opens and stays, min(gap, seen)
    return opens, gap


def _smallest(ends: Ends, t: Array, side: float) -> tuple[bool, float]:
    """Whether the gap on one side is clearly above zero past where it is widest, and the least of
    it there.
    """
    sheet = ends.sheet
    if sheet.kink or not math.isfinite(sheet.limit):
        return False, math.inf
    height = np.asarray(sheet.profile.height(sheet.map.x(ends.middle + ends.half * t)), dtype=float)
    start = float(sheet.profile.height(ends.outer if side > 0 else ends.inner))
    gap = height - start - sheet.map.rise_factor * ends.half * off_integral(ends.g, ends.odd, t)
    top = int(np.argmax(gap))
    rising = bool(np.all(np.diff(gap[: top + 1]) >= -_CLEAR * gap[top]))
    # Past its top no sample comes near zero: between samples it may not fall by as much as it has
    # fallen in all.
    return rising and float(gap[top:].min()) > 0.05 * float(gap[top]) > 0.0, float(gap[top:].min())


# What sums of some hundred terms are rounded to: no error is stated below it, as by the other ways.
# Beside a singular end the pressure is several times the mean, to which its error is referred.
_ROUNDING = 4e-14
_SINGULAR = 8.0
# Of a unit in the last digit: what coefficients are rounded to, over their sum.
_OF_SUM = 4.0
# Coefficients over which they fall to an e-th at the least, if so many bring them from 1 to
# rounding; with a margin.
_LEAST = 4.0
_PER_NODE = 1.0 / 16.0


def stated(ends: Ends) -> Value:
    sheet = ends.sheet
    if sheet.corner is not None:
        return _SINGULAR * _ROUNDING + 0.0 * ends.half
    way, (scale, _, follows) = sheet.map, ends.sums
    mean = ends.totals / (ends.zones * ends.widths)
    scale = scale + abs(sheet.kink)
    most_of = largest(np.abs(ends.g)) if ends.g.size else 0.0
    left = most_of * (_LEAST + _PER_NODE * ends.nodes) * ends.tail
    most, least, turns = _weights(ends)
    moved = ends.off * (follows * most + scale * turns)
    pressure = (moved + (left + _OF_SUM * _EPS * scale) * most) / mean
    # dy/dx = w / rise_factor, least at one of the ends.
    of_ends = (ends.off * ends.half * way.rise_factor / least + _EPS * ends.outer) / ends.widths
    return _ROUNDING + np.maximum(of_ends, pressure)


def _weights(ends: Ends) -> tuple[Value, Value, Value]:
    """(largest w in a zone, least at its ends, and what it changes by with the half length, in
    parts of that, from above).
    """
    way = ends.sheet.map
    if way.period is None:
        return (
            (ends.outer, ends.inner, 0.5 * ends.half / ends.inner) if way.pair else (1.0, 1.0, 0.0)
        )
    outer = way.weight(ends.outer)
    if not way.pair:
        return 1.0, outer, 1.0 / outer
    least = np.minimum(outer, way.weight(ends.inner))
    return 1.0, least, 4.0 * ends.half / least
