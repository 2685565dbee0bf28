r"""Loads of the zones of a nearly full contact, p = pbar - R + G s.

The load of a zone [a, b] is pbar (b - a) - int R + V(b) - V(a), V the potential of s, a closed form (V' = G s): all that the gaps
bring, the roots of the pressure at the zone's ends with it. R does not know of the gaps. Its logarithms at kinks have the
integral

    (J / pi) int ln|2 sin(pi (x - s)/L)| dx = -(J L / 2 pi^2) Cl_2(2 pi (x - s)/L),

and what is left is as smooth as f' between breakpoints, and like y^q ln|y|, q >= 1, beside them. Panels from breakpoint to breakpoint,
x = u^3 (10 - 15 u + 6 u^2), make that y^q ln|y| as smooth as u^(3 q + 2) ln u, and Gauss's rule good to rounding; panels where the
series of the integrand has not come to its end are halved. So the number of places goes with that of the breakpoints.

Rounding leaves about 1e-16 of the mean pressure times a zone's width, and of the potential, which is of the size of the gaps' height:
a zone of a millionth of its neighbours' gaps loses some ten digits of its load.
"""

from math import pi

import numpy as np

from contact.formulation.conjugate import clausen2, over_jumps
from contact.formulation.relief import ScaledRelief
from sie import Array, wrapped

_NODES = 16
# Of the largest R on a panel's length: what the last coefficients may be. Gauss's rule is good to about the square.
_TAIL = 1e-7
_HALVINGS = 40
# Even panels of a period at the least.
_LEAST = 16


def loads(mean: float, relief: ScaledRelief, zones: Array, rise: Array) -> Array:
    """Scaled loads of zones (n, 2), which follow each other within a period; rise: V(b) - V(a) of each."""
    return np.asarray(mean * (zones[:, 1] - zones[:, 0]) - integrals(relief, zones) + rise)


def integrals(relief: ScaledRelief, zones: Array) -> Array:
    """int R over each zone."""
    start, period = float(zones[0, 0]), relief.period
    breaks = np.concatenate((relief.breakpoints, start + period * np.arange(_LEAST) / _LEAST))
    cuts = np.unique(np.concatenate((wrapped(breaks, start, period), zones.ravel())))
    lo, hi = cuts[:-1], cuts[1:]
    zone = np.searchsorted(zones[:, 0], lo, side="right") - 1
    inside = lo < zones[zone, 1]
    lo, hi, zone = lo[inside], hi[inside], zone[inside]
    out = np.bincount(zone, _panels(relief, lo, hi), len(zones))
    factor = -relief.heights * period / (2 * pi**2)
    return np.asarray(out + np.diff(over_jumps(zones, relief.at, factor, period, clausen2), axis=1)[:, 0])


def _panels(relief: ScaledRelief, lo: Array, hi: Array) -> Array:
    """int over each panel of R less its logarithms."""
    node, weight = np.polynomial.legendre.leggauss(_NODES)
    u, v = 0.5 * (1 + node), 0.5 * (1 - node)
    # Distances from the nearer end over the length keep their digits.
    left, right = u**3 * (10 - 15 * u + 6 * u**2), v**3 * (10 - 15 * v + 6 * v**2)
    growth = 15 * weight * (u * v) ** 2
    last = weight[:, None] * np.polynomial.legendre.legvander(node, _NODES - 1)[:, -3:]
    out = np.zeros(len(lo))
    panel, largest = np.arange(len(lo)), 0.0
    for _ in range(_HALVINGS):
        length = (hi - lo)[:, None]
        x = np.where(left < right, lo[:, None] + length * left, hi[:, None] - length * right)
        value = relief.smooth(x.ravel()).reshape(x.shape)
        largest = max(largest, float(np.abs(value).max(initial=0.0)))
        tail = np.abs((value * growth / weight) @ last).max(axis=1)
        rough = tail > _TAIL * largest
        np.add.at(out, panel[~rough], ((hi - lo)[:, None] * value)[~rough] @ growth)
        if not rough.any():
            break
        middle = 0.5 * (lo + hi)[rough]
        panel = np.repeat(panel[rough], 2)
        lo, hi = np.column_stack((lo[rough], middle)).ravel(), np.column_stack((middle, hi[rough])).ravel()
    else:
        # Halved down to rounding: by their middles.
        np.add.at(out, panel, (hi - lo) * relief.smooth(0.5 * (lo + hi)))
    return out
