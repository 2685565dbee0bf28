"""Singular quadrature for tests of exact solutions, independent of engine and closed forms.

It uses only `pressure_at(t, zone)`, `pressure(x)`, `zones`, `period` and other plain attributes of
a solution.
"""

from __future__ import annotations

import numpy as np

FOLD = np.arange(-56, 57) * 0.06
FOLD_LEFT = 1.0 / (1.0 + np.exp(-np.pi * np.sinh(FOLD)))
FOLD_WEIGHT = 0.06 * np.pi * np.cosh(FOLD) * FOLD_LEFT * (1.0 - FOLD_LEFT)


def zone_rule(solution, zone, nodes):
    """Angles, centre, half-width and weights p dx of Gauss-Chebyshev quadrature in one zone.

    The rule holds for free ends and for ends at sharp corners.
    """
    a, b = solution.zones[zone]
    phi = (np.arange(nodes) + 0.5) * np.pi / nodes
    half = 0.5 * (b - a)
    t = np.cos(phi)
    # The sine is computed from the rounded t. p sin(phi) is smooth in t, but p alone is steep
    # at the ends.
    weight = solution.pressure_at(t, zone) * np.sqrt((1.0 - t) * (1.0 + t)) * half * np.pi / nodes
    return phi, 0.5 * (a + b), half, weight


def load_of(solution, nodes=400):
    """The integral of p over all zones."""
    return sum(float(np.sum(zone_rule(solution, k, nodes)[3])) for k in range(len(solution.zones)))


def transform(solution, zone, period, nodes=400, points=9):
    """Points x of a zone, and (1/pi) PV int p K dxi at these points.

    The points lie halfway between the nodes, where the rule holds for principal values.
    """
    step = max(nodes // (points + 1), 1)
    psi = np.arange(1, nodes, step) * np.pi / nodes
    _, centre, half, _ = zone_rule(solution, zone, 1)
    x = centre + half * np.cos(psi)
    total = np.zeros_like(x)
    for k in range(len(solution.zones)):
        phi, middle, width, weight = zone_rule(solution, k, nodes)
        if k == zone:  # cos psi - cos phi without cancellation
            d = 2.0 * half * np.sin(0.5 * (phi + psi[:, None])) * np.sin(0.5 * (phi - psi[:, None]))
        else:
            d = x[:, None] - (middle + width * np.cos(phi))
        total += kernel(d, period) @ weight / np.pi
    return x, total


def kernel(d, period):
    """The kernel K: 1/d, or (pi/L) cot(pi d/L) with a period L."""
    return 1.0 / d if period is None else np.pi / period / np.tan(np.pi * d / period)


def folded_transform(solution, x, breaks):
    """(1/pi) PV int p K dxi at one x, folded about x: (1/pi) int_0 [p(x - s) - p(x + s)] K(s) ds.

    The quadrature is divided at `breaks`, the places x at which the pressure is not smooth.
    """
    period = solution.period
    breaks = np.asarray(breaks, dtype=float)
    if period is None:
        edges = np.abs(x - breaks)
    else:
        edges = np.abs(x - (breaks[:, None] + period * np.array([-1.0, 0.0, 1.0]))).ravel()
        edges = np.append(edges[edges < 0.5 * period], 0.5 * period)
    edges = np.unique(np.append(edges, 0.0))
    total = 0.0
    for lo, hi in zip(edges[:-1], edges[1:], strict=True):
        s = lo + (hi - lo) * FOLD_LEFT if lo > 0.0 else hi * FOLD_LEFT
        jump = solution.pressure(x - s) - solution.pressure(x + s)
        # Round-off can put a node onto a kink, where p is infinite. The weight of such a node
        # is below round-off.
        jump = np.where(np.isfinite(jump), jump, 0.0)
        total += float(np.sum((hi - lo) * FOLD_WEIGHT * jump * kernel(s, period)))
    return total / np.pi


def displacement_of(solution, x, nodes=400):
    """u(x) outside the zones: -(2/pi E*) int p ln|2 sin(pi (x - xi)/L)| dxi.

    Without a period the logarithm is ln|(x - xi)/datum|.
    """
    total = np.zeros_like(x)
    for k in range(len(solution.zones)):
        phi, middle, half, weight = zone_rule(solution, k, nodes)
        d = x[:, None] - (middle + half * np.cos(phi))
        if solution.period is None:
            logs = np.log(np.abs(d / solution.datum))
        else:
            logs = np.log(np.abs(2.0 * np.sin(np.pi * d / solution.period)))
        total += logs @ weight
    return -2.0 / (np.pi * solution.E_star) * total


def equation_error(solution, nominal=None, nodes=400):
    """Largest |(1/pi) PV int p K - (E*/2) f'| over all zones, divided by the largest term.

    A localized solution has the kernel 1/(x - xi), and `nominal(x)` is added on the right.
    """
    period = solution.period if nominal is None else None
    worst, scale = 0.0, 0.0
    for zone in range(len(solution.zones)):
        x, left = transform(solution, zone, period, nodes)
        right = 0.5 * solution.E_star * solution.slope(x) + (0.0 if nominal is None else nominal(x))
        worst = max(worst, float(np.max(np.abs(left - right))))
        scale = max(scale, float(np.max(np.abs(right))))
    mean = load_of(solution, nodes) / float(np.sum(np.diff(solution.zones, axis=1)))
    return worst / max(scale, mean)
