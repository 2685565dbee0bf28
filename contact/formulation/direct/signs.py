"""Signs of a contact that is one interval: the pressure inside, the gap outside, of all rows at once.

Inside, p / sqrt(1 - t^2) is a polynomial (and a part of the kink, which is positive), sampled so closely that nothing is hidden between.
Outside the slope of the gap is

    gap' = w (G - sum g_k rho^k)     and     J/pi arccos(tan A / tan u)     of the kink,

and where it is nowhere negative outwards, and nowhere positive between the zones of a pair, the gap is least at the ends, where it is zero.
Where it is, as beside the border of a lone wave, the gap itself is looked at.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from contact.formulation.direct.ends import Ends
from contact.formulation.direct.series import WIDENED, off, off_integral, table

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Places outside: beside the zones, per length over which the shape varies, at the most; and how far away, in half lengths.
_BESIDE, _PER_FEATURE, _MOST, _FARTHEST = 32, 4, 4096, 1e12
_FAR = 512
# Of the largest gap slope, or gap: what is not told from rounding, over the coarseness of the values next to an end.
_CLEAR = 1e-12
_EPS = float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class Signs:
    """holds: whether both are right, beyond doubt; least, peak: of p / sqrt(1 - t^2), and of p, over E*/2; gap: the least at a place that
    was looked at [m], where it was looked at itself; points: looked at."""

    holds: Mask
    least: Array
    peak: Array
    gap: Array
    points: int

    def rows(self, chosen: Mask) -> Signs:
        return Signs(self.holds[chosen], self.least[chosen], self.peak[chosen], self.gap[chosen], self.points)


def signs(ends: Ends) -> Signs:
    with np.errstate(all="ignore"):
        holds, least, peak, inside = _inside(ends)
        if ends.sheet.corner is not None:
            return Signs(holds, least, peak, np.full(len(least), np.inf), inside)
        opens, gap, outside = _outside(ends)
        return Signs(holds & opens, least, peak, gap, inside + outside)


def _inside(ends: Ends) -> tuple[Mask, Array, Array, int]:
    sheet = ends.sheet
    way = sheet.map
    nodes = max(int(ends.nodes.max(initial=2)), 2)
    looks = table(nodes if way.pair else nodes // 2, not way.pair)
    if ends.sheet.corner is not None:
        ones = ends.punch > 0
        return ones, ends.punch, ends.punch, 0
    q = looks.samples(ends.g)
    y = ends.middle[:, None] + ends.half[:, None] * looks.cosines
    x = way.x(y)
    weight = np.broadcast_to(way.weight(x, y), y.shape)
    value, root = q, looks.sines
    if sheet.kink > 0.0:
        kinked = np.arctanh(np.minimum(root / weight, 1.0)) * (sheet.kink / math.pi)
        # Over sqrt(1 - t^2) it is least at the ends.
        value = q + sheet.kink / math.pi
        peak = (root * weight * q + kinked).max(axis=1)
    else:
        peak = (root * weight * q).max(axis=1)
    low, high = value.min(axis=1), value.max(axis=1)
    clear = low - 0.5 * WIDENED * (high - low) > 1e-3 * high
    if not clear.all():
        # Not so even that the hull would tell: by how much a polynomial falls below its samples where it bends as they do, twice over.
        bend = np.abs(value[:, :-2] - 2.0 * value[:, 1:-1] + value[:, 2:])
        clear |= (np.minimum(low, (value[:, 1:-1] - 0.25 * bend).min(axis=1)) > 1e-9 * high)
    return np.asarray(clear & (peak > 0)), np.asarray((value * weight).min(axis=1)), peak, q.shape[1]


def _outside(ends: Ends) -> tuple[Mask, Array, int]:
    way, limit = ends.sheet.map, ends.sheet.limit
    last = np.full(len(ends.half), float(way.y(np.array(limit))) if math.isfinite(limit) else np.inf)
    right = (last - ends.middle) / ends.half
    z = _places(ends, right)
    x = way.x(ends.middle[:, None] + ends.half[:, None] * z)
    opens, gap = _opening(ends, z, x, 1.0)
    if not way.pair:
        return opens, gap, z.shape[1]
    # Between the two zones, from the inner end to x = 0.
    z = 1.0 + (ends.middle / ends.half - 1.0)[:, None] * _squares(_BESIDE)
    x = way.x(ends.middle[:, None] - ends.half[:, None] * z)
    between, gap_between = _opening(ends, z, x, -1.0)
    return opens & between, np.minimum(gap, gap_between), 2 * z.shape[1]


def _places(ends: Ends, right: Array) -> Array:
    """z > 1 up to `right`, closer beside the zone, and as close everywhere as the shape varies, where that is known."""
    profile, limit = ends.sheet.profile, ends.sheet.limit
    feature = profile.resolution
    if math.isfinite(limit):
        open_ = float((limit - ends.outer).max())
        count = _BESIDE if feature is None else int(np.clip(_PER_FEATURE * open_ / feature, _BESIDE, _MOST))
        return np.asarray(1.0 + (right - 1.0)[:, None] * _squares(count))
    return np.tile(_to_far_away(), (len(right), 1))


@lru_cache(maxsize=8)
def _squares(count: int) -> Array:
    """Places in (0, 1), closer next to 0."""
    return np.asarray(((np.arange(count) + 0.5) / count) ** 2)


@lru_cache(maxsize=1)
def _to_far_away() -> Array:
    """Places from 1 on, closer there, and evenly in the logarithm far away."""
    return np.concatenate((1.0 + 3.0 * _squares(_BESIDE), np.geomspace(4.5, _FARTHEST, _FAR)))


def _opening(ends: Ends, z: Array, x: Array, side: float) -> tuple[Mask, Array]:
    """(whether the gap opens away from the zone, or at least stays open; the least gap that was seen where it was looked at)."""
    sheet = ends.sheet
    way, kink = sheet.map, sheet.kink
    y = ends.middle[:, None] + side * ends.half[:, None] * z
    weight = way.weight(x, y)
    slope = np.asarray(sheet.profile.slope(x), dtype=float)
    g = ends.g if side > 0 else ends.g * (-1.0) ** (ends.orders % 2)
    own = (slope - 0.5 * kink) / weight
    rises = side * (own - off(g, ends.orders, z))
    if kink > 0.0:
        ratio = (1.0 / z) if way.period is None else weight / (z * np.sqrt(1.0 - ends.half[:, None] ** 2))
        rises = rises + kink / math.pi * np.arccos(np.minimum(ratio, 1.0)) / weight
    # Far away heights may overflow: nothing touches there.
    rises = np.where(np.isposinf(slope), np.inf, rises)
    rounding = _rounding(ends)[:, None] * (np.abs(own) + np.abs(ends.g).sum(axis=1)[:, None] + abs(kink))
    opens = (rises > -rounding).all(axis=1) & (rises.max(axis=1) > 0)
    gap = np.full(len(opens), np.inf)
    for k in map(int, np.flatnonzero(~opens)):
        opens[k], gap[k] = _stays_open(ends, k, z[k], x[k], g[k], side)
    return opens, gap


def _rounding(ends: Ends) -> Array:
    """Of values of G, over their size: what the places of narrow zones are rounded to."""
    places = 4.0 * ends.middle / ends.half
    return np.asarray(16.0 * _EPS * (1.0 + places))


def _stays_open(ends: Ends, k: int, z: Array, x: Array, g: Array, side: float) -> tuple[bool, float]:
    """Of one row whose gap does not open all the way: whether it is clearly above zero where it does not."""
    sheet = ends.sheet
    if sheet.kink or not math.isfinite(sheet.limit):
        return False, math.inf
    end = ends.outer[k] if side > 0 else ends.inner[k]
    height = np.asarray(sheet.profile.height(x)) - float(sheet.profile.height(end))
    sunk = sheet.map.rise_factor * float(ends.half[k]) * off_integral(g, ends.orders, z) * side
    gap = height - (sunk if side > 0 else sunk)
    top = int(np.argmax(gap))
    rising = bool(np.all(np.diff(gap[: top + 1]) >= -_CLEAR * gap[top]))
    # Past its top no sample comes near zero: between samples it may not fall by as much as it has fallen in all.
    return rising and float(gap[top:].min()) > 0.05 * float(gap[top]) > 0.0, float(gap[top:].min())
