"""The stated error of a contact that is one interval: of its ends over the width of a zone, and of its pressure over the peak.

Ends are off by what Newton has left and by rounding. At a place of the interval that stays, the pressure follows them at the rates of
`Table.followed`, and by what the weight w changes; itself it is off by the coefficients that were left off, which fall
as a geometric series, and by rounding.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact.formulation.direct.ends import Ends
from contact.formulation.direct.series import table
from contact.formulation.direct.signs import Signs

Array = NDArray[np.float64]

# What sums of some hundred terms are rounded to: no error is stated below it, as by the other ways. Beside a singular end the pressure is
# several times the mean, to which its error is referred.
_ROUNDING, _SINGULAR = 4e-14, 8.0
# Of a unit in the last digit: what coefficients are rounded to, over their sum.
_EPS, _OF_SUM = 2.2e-16, 4.0
# Coefficients over which they fall to an e-th at the least, if so many bring them from 1 to rounding; with a margin.
_LEAST, _PER_NODE = 4.0, 1.0 / 16.0


def stated(ends: Ends, seen: Signs) -> Array:
    sheet = ends.sheet
    if sheet.corner is not None:
        return np.full(len(ends.half), _SINGULAR * _ROUNDING)
    way = sheet.map
    with np.errstate(all="ignore"):
        looks = table(int(ends.nodes.max()) // (1 if way.pair else 2), not way.pair)
        by_half, by_middle = looks.followed(ends.g)
        follows = by_half + by_middle if way.pair else by_half
        size = np.abs(ends.g)
        scale = size.sum(axis=1) + abs(sheet.kink)
        left = size.max(axis=1, initial=0.0) * (_LEAST + _PER_NODE * ends.nodes) * ends.tail
        most, least, turns = _weights(ends)
        moved = ends.off * (follows * most + scale * turns)
        pressure = (moved + (left + _OF_SUM * _EPS * scale) * most) / seen.peak
        # dy/dx = w / rise_factor, least at one of the ends.
        of_ends = ends.off * ends.half * way.rise_factor / least / ends.widths + _EPS * ends.outer / ends.widths
    return np.asarray(_ROUNDING + np.maximum(of_ends, pressure))


def _weights(ends: Ends) -> tuple[Array, Array, Array]:
    """(largest w in a zone, least at its ends, and what it changes by with the half length, in parts of that, from above)."""
    way, ones = ends.sheet.map, np.ones(len(ends.half))
    if way.period is None:
        return (ends.outer, ends.inner, 0.5 * ends.half / ends.inner) if way.pair else (ones, ones, 0.0 * ones)
    outer = np.asarray(way.weight(ends.outer, way.y(ends.outer)))
    if not way.pair:
        return ones, outer, 1.0 / outer
    least = np.minimum(outer, way.weight(ends.inner, way.y(ends.inner)))
    return ones, least, 4.0 * ends.half / least
