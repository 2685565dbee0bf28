"""The stated error of a contact that is one interval: of its ends over the width of a zone, and of its pressure over the mean on it, which
is at most its peak.

Ends are off by what Newton has left and by rounding. At a place of the interval that stays, the pressure follows them, and by what the
weight w changes; itself it is off by the coefficients that were left off, which fall as a geometric series, and by rounding.

Ends that move by parts of the half length add q(+-1) / sqrt(1 - t^2) to Phi, and the place moves with them. With t = cos(a) the first
changes sum k g_k sin(k a) by k g_k (1 - cos(a) cos(k a)) / sin(a) of odd orders as the half length grows, and so on of even ones, and as
the middle moves: (cos(a) - cos(k a)) / sin(a), (1 - cos(k a)) / sin(a) and cos(a) (1 - cos(k a)) / sin(a), none of them above k.
"""

import numpy as np

from contact.formulation.direct.ends import Ends
from contact.formulation.direct.numbers import Value, largest

# What sums of some hundred terms are rounded to: no error is stated below it, as by the other ways. Beside a singular end the pressure is
# several times the mean, to which its error is referred.
_ROUNDING, _SINGULAR = 4e-14, 8.0
# Of a unit in the last digit: what coefficients are rounded to, over their sum.
_EPS, _OF_SUM = 2.2e-16, 4.0
# Coefficients over which they fall to an e-th at the least, if so many bring them from 1 to rounding; with a margin.
_LEAST, _PER_NODE = 4.0, 1.0 / 16.0


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
    """(largest w in a zone, least at its ends, and what it changes by with the half length, in parts of that, from above)."""
    way = ends.sheet.map
    if way.period is None:
        return (ends.outer, ends.inner, 0.5 * ends.half / ends.inner) if way.pair else (1.0, 1.0, 0.0)
    outer = way.weight(ends.outer)
    if not way.pair:
        return 1.0, outer, 1.0 / outer
    least = np.minimum(outer, way.weight(ends.inner))
    return 1.0, least, 4.0 * ends.half / least
