r"""Loads of the zones of a nearly full contact with the pressure p = pbar - R + G s.

Here pbar is the mean pressure, R the relief and s the slope of the gap (contact.formulation.gaps).
The load of a zone [a, b] is pbar (b - a) - int R + V(b) - V(a). V is the potential of s, V' = G s,
in closed form; it contains the effect of the gaps and the square roots of the pressure at the ends.
R does not depend on the gaps. At a kink x_k, where f' jumps by J, R has a logarithm with the
integral

    (J / pi) int ln|2 sin(pi (x - x_k)/L)| dx = -(J L / 2 pi^2) Cl_2(2 pi (x - x_k)/L),

with the period L and Clausen's function Cl_2. The rest of R is as smooth as f' between breakpoints.
At the distance y from a breakpoint it may vary as y^q ln|y|, q >= 1. Gauss panels whose nodes crowd
at both ends integrate it to rounding.

The rounding error of a load is about 1e-16 times the sum of two numbers: the mean pressure times
the zone's width, and the potential V. The potential is as large as the height of the gaps. So a
zone a million times narrower than the gaps next to it loses some ten digits of its load.
"""

from math import pi

import numpy as np

from contact.formulation.conjugate import clausen2, over_jumps
from contact.formulation.quadrature import IN_PANEL, panels
from contact.formulation.relief import ScaledRelief
from contact.model.profiles.noise import EPS
from sie import Array, wrapped


def loads(mean: float, relief: ScaledRelief, zones: Array, rise: Array) -> Array:
    """Scaled loads (n,) of the `zones` (n, 2), which follow one another within one period.

    rise: V(b) - V(a) of each zone.
    """
    start, period = float(zones[0, 0]), relief.period
    breaks = np.unique(np.concatenate((wrapped(relief.breakpoints, start, period), zones.ravel())))
    # Each interval between breakpoints is cut into equal parts no longer than the spacing. The
    # factor just below 1 keeps round-off from cutting an interval that is exactly as long as the
    # spacing.
    parts = np.ceil((1 - EPS**0.5) * np.diff(breaks) / relief.spacing).astype(int)
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
