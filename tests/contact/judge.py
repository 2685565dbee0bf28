"""How far a solution is from an exact one, as `Solution.error` means it."""

from __future__ import annotations

import numpy as np

import contact

# No node is a kink in the middle of a zone; the ends are met to 1e-4 of the half width.
T = np.append(np.cos((np.arange(24) + 0.5) * np.pi / 24), [-0.9999, 0.9999])


def solve(profile, interaction, E_star=1.0, tol=1e-10, **control):
    """The solution of a scene given in one line."""
    return contact.solve(contact.Scene(profile, E_star, interaction, **control), tol=tol)


def unit_pressure(solution):
    """Largest pressure, or the mean contact pressure where the peak is infinite."""
    if np.isfinite(solution.max_pressure):
        return solution.max_pressure
    return solution.load / float(np.sum(solution.zone_widths))


def counterparts(solution, exact):
    """Zones of the solution in the order of the exact ones and moved to them: a left end at the
    border may round across it.
    """
    assert solution.zones.shape == exact.zones.shape
    order, zones = np.arange(len(exact.zones)), solution.zones
    if solution.scene.period is None:
        return order, zones
    first = np.argmin(
        np.abs((zones[:, 0] - exact.zones[0, 0]) / solution.scene.period % 1.0 - 0.5) * -1.0
    )
    order = np.roll(order, -first)
    turns = np.round((exact.zones[:, 0] - zones[order, 0]) / solution.scene.period)
    return order, zones[order] + solution.scene.period * turns[:, None]


def pressure_error(solution, exact, t=T):
    """Largest difference of the pressures at equal position in corresponding zones, over the peak."""
    order, _ = counterparts(solution, exact)
    off = [
        np.max(np.abs(solution.pressure_at(t, k) - exact.pressure_at(t, i)))
        for i, k in enumerate(order)
    ]
    return max(off) / unit_pressure(exact)


def end_error(solution, exact):
    """Largest difference of the ends over the width of their zone."""
    _, zones = counterparts(solution, exact)
    return float(np.max(np.abs(zones - exact.zones) / exact.zone_widths[:, None]))


def true_error(solution, exact, t=T):
    """What `Solution.error` bounds."""
    return max(pressure_error(solution, exact, t), end_error(solution, exact))


def relative(a, b):
    """|a - b| over |b|, the largest."""
    return float(np.max(np.abs(np.asarray(a) - np.asarray(b)) / np.abs(np.asarray(b))))
