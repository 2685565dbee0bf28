"""Errors of a solution against an exact solution, as `Solution.error` defines them."""

from __future__ import annotations

import numpy as np

import contact

# Scaled positions in a zone. None is 0, where some profiles have a kink. The last two are 1e-4
# of the half width from the ends.
T = np.append(np.cos((np.arange(24) + 0.5) * np.pi / 24), [-0.9999, 0.9999])


def solve(profile, interaction, E_star=1.0, tol=1e-10, **control):
    """The solution of a scene given in one line."""
    return contact.solve(contact.Scene(profile, E_star, interaction, **control), tol=tol)


def unit_pressure(solution):
    """Largest pressure, or the mean contact pressure if the largest pressure is infinite."""
    if np.isfinite(solution.max_pressure):
        return solution.max_pressure
    return solution.load / float(np.sum(solution.zone_widths))


def counterparts(solution, exact):
    """Indices and ends of the solution's zones, in the order of the exact zones.

    The ends are moved by whole periods to the exact zones. Round-off may move a left end at the
    border of the cell across it, which changes the order of the zones.
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
    """Largest difference of pressures at equal positions in corresponding zones, over the peak."""
    order, _ = counterparts(solution, exact)
    off = [
        np.max(np.abs(solution.pressure_at(t, k) - exact.pressure_at(t, i)))
        for i, k in enumerate(order)
    ]
    return max(off) / unit_pressure(exact)


def end_error(solution, exact):
    """Largest difference of the zone ends, each divided by the width of its zone."""
    _, zones = counterparts(solution, exact)
    return float(np.max(np.abs(zones - exact.zones) / exact.zone_widths[:, None]))


def true_error(solution, exact, t=T):
    """The error that `Solution.error` bounds: the larger of `pressure_error` and `end_error`."""
    return max(pressure_error(solution, exact, t), end_error(solution, exact))


def relative(a, b):
    """The largest |a - b|/|b|."""
    return float(np.max(np.abs(np.asarray(a) - np.asarray(b)) / np.abs(np.asarray(b))))
