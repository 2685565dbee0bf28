"""Loads, moment, mean gap and approach of a solution by quadrature of its fields.

The formulas of the solver are not used. Zones and gaps are cut where the profile or one of its
derivatives jumps. Double-exponential quadrature on each panel integrates roots and logarithms
at its ends (H. Takahasi and M. Mori, Publ. RIMS 9 (1974) 721-741).
"""

from __future__ import annotations

import numpy as np

_S = np.linspace(-3.3, 3.3, 133)
LEFT, RIGHT = (1 / (1 + np.exp(np.pi * sign * np.sinh(_S))) for sign in (-1.0, 1.0))
WEIGHT = (_S[1] - _S[0]) * np.pi * np.cosh(_S) * LEFT * RIGHT


def breaks_in(solution, lo, hi):
    """The cuts from `lo` to `hi`: both, and the breakpoints of the profile between them.

    Without breakpoints, the cuts are half the resolution of the profile apart.
    """
    profile = solution.scene.profile
    finest = (
        0
        if len(profile.breakpoints) or profile.resolution is None
        else int(2 * (hi - lo) / profile.resolution)
    )
    at = np.concatenate(
        (profile.breakpoints, lo + (hi - lo) * np.arange(1, finest) / max(finest, 1))
    )
    if solution.scene.period is not None and len(at):
        at = at + np.ceil((lo - at) / profile.period) * profile.period
    # A panel as narrow as round-off adds nothing to the integral.
    inner = np.unique(at[(at > lo + 1e-12 * (hi - lo)) & (at < hi - 1e-12 * (hi - lo))])
    return np.concatenate(([lo], inner, [hi]))


def pressures(solution, zone):
    """Nodes x and products of pressure and weight, p dx, in one zone."""
    a, b = solution.zones[zone]
    cuts = breaks_in(solution, a, b)
    lo, length = cuts[:-1, None], np.diff(cuts)[:, None]
    x = lo + length * LEFT
    left, right = (lo - a) + length * LEFT, (b - cuts[1:, None]) + length * RIGHT
    t = np.where(left < right, 2 * left / (b - a) - 1, 1 - 2 * right / (b - a))
    value = solution.pressure_at(np.clip(t, -1, 1), zone)
    return x.ravel(), (np.where(np.isfinite(value), value, 0.0) * length * WEIGHT).ravel()


def zone_loads(solution):
    return np.array([pressures(solution, k)[1].sum() for k in range(len(solution.zones))])


def moment(solution):
    return sum(
        float(x @ load) for x, load in (pressures(solution, k) for k in range(len(solution.zones)))
    )


def open_intervals(solution):
    """The intervals without contact in one period."""
    starts, ends = solution.zones.T
    return list(zip(ends, np.append(starts[1:], starts[0] + solution.scene.period), strict=True))


def mean_gap(solution):
    total = 0.0
    for lo, hi in open_intervals(solution):
        cuts = breaks_in(solution, lo, hi)
        x = cuts[:-1, None] + np.diff(cuts)[:, None] * LEFT
        total += float(np.sum(solution.gap(x) * np.diff(cuts)[:, None] * WEIGHT))
    return total / solution.scene.period


def approach(solution, x):
    """Approach u + f - gap at a point x outside the zones.

    f is counted from its lowest value; u is computed from the pressure by quadrature.
    """
    scene, u = solution.scene, 0.0
    for k in range(len(solution.zones)):
        xi, load = pressures(solution, k)
        d = x - xi
        log = np.log(
            np.abs(d / scene.interaction.datum)
            if scene.period is None
            else np.abs(2 * np.sin(np.pi * d / scene.period))
        )
        u -= 2 / (np.pi * scene.E_star) * float(log @ load)
    return (
        u + float(scene.profile.height(x) - solution.fields.problem.lowest) - float(solution.gap(x))
    )
