r"""Loads of the zones of a nearly full contact, p = pbar - R + G s.

The load of a zone [a, b] is pbar (b - a) - int R + V(b) - V(a), V the potential of s, a closed form
(V' = G s): all that the gaps bring, the roots of the pressure at the zone's ends with it. R does
not know of the gaps. Its logarithms at kinks have the integral

    (J / pi) int ln|2 sin(pi (x - s)/L)| dx = -(J L / 2 pi^2) Cl_2(2 pi (x - s)/L),

and what is left is as smooth as f' between breakpoints, and like y^q ln|y|, q >= 1, beside them:
Gauss's rule on panels as short as anything varies, whose nodes crowd at their ends, is good to
rounding.

Rounding leaves about 1e-16 of the mean pressure times a zone's width, and of the potential, which
is of the size of the gaps' height: a zone of a millionth of its neighbours' gaps loses some ten
digits of its load.
"""

from math import pi

import numpy as np

from contact.formulation.conjugate import clausen2, over_jumps
from contact.formulation.quadrature import IN_PANEL, panels
from contact.formulation.relief import ScaledRelief
from sie import Array, wrapped

# Of a length: what rounding may make of one that is as short.
_SAME = 1e-6


def loads(mean: float, relief: ScaledRelief, zones: Array, rise: Array) -> Array:
    """Scaled loads of zones (n, 2), which follow each other within a period; rise: V(b) - V(a) of
    each.
    """
    start, period = float(zones[0, 0]), relief.period
    breaks = np.unique(np.concatenate((wrapped(relief.breakpoints, start, period), zones.ravel())))
    # Knots of a trace, as far apart as it varies, are cuts enough.
    parts = np.ceil((1 - _SAME) * np.diff(breaks) / relief.spacing).astype(int)
    part = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    cuts = np.append(
        np.repeat(breaks[:-1], parts) + np.repeat(np.diff(breaks) / parts, parts) * part, breaks[-1]
    )
    zone = np.searchsorted(zones[:, 0], cuts[:-1], side="right") - 1
    inside = cuts[:-1] < zones[zone, 1]
    x, weight = (part.reshape(-1, IN_PANEL)[inside] for part in panels(cuts))
    smooth = np.bincount(
        zone[inside], (weight * relief.smooth(x.ravel()).reshape(x.shape)).sum(axis=1), len(zones)
    )
    factor = -relief.heights * period / (2 * pi**2)
    sharp = np.diff(over_jumps(zones, relief.at, factor, period, clausen2), axis=1)[:, 0]
    return np.asarray(mean * (zones[:, 1] - zones[:, 0]) - (smooth + sharp) + rise)
