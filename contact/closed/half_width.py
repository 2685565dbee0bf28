"""The half width of one symmetric zone about the origin, and the branch from zero load.

The load P of a zone of half width a is an integral of the forcing g, the right side of the contact
equation. The approach is minus the level given below. Let F be the primitive of g, d the datum,
u = pi xi/L and A = pi a/L. Substitute xi = a t for an isolated zone, and sin u = t sin A for a zone
in each period L. Then

    P = int g(xi) xi / sqrt(a^2 - xi^2) dxi                     level = (P/pi) ln(a / 2d) - mean F
    P = int g(xi) sin u / sqrt(sin^2 A - sin^2 u) dxi           level = (P/pi) ln sin A - mean F

The first line, for the isolated zone, is Shtaerman's (1949). The second line follows from it by the
map tan u, which turns the Hilbert kernel into Cauchy's kernel. The levels follow from the
equilibrium measure of the zone. The integrals and the mean of F are computed by Gauss-Chebyshev
quadrature in t. The localized model corrects the load by equation (16) of Goryacheva & Tsukanov
(2020).
"""

import math

import numpy as np

import sie
from contact.closed.zone import OPTIONS
from contact.errors import OutOfRange
from contact.extras import require
from contact.formulation.controls import Control, HalfWidth
from contact.formulation.problem import Problem
from contact.formulation.roots import smooth_root
from contact.model.profiles.noise import EPS
from sie import Array

NODES = np.cos((np.arange(8) + 0.5) * np.pi / 16)  # positive half of 16 Gauss-Chebyshev nodes


# Relative tolerance of the half width at which the load or the approach is largest. Near the
# maximum the load or approach hardly changes, so that a rough tolerance suffices.
MAXIMUM_TOLERANCE = math.sqrt(EPS)


def guess_half_width(problem: Problem, control: Control) -> float:
    """The scaled half width at which one zone has about the controlled load or approach.

    If no zone reaches the controlled value, this is the half width at the first maximum of the load
    or approach.
    """
    if control.half_width is not None:
        return control.half_width
    if control.width is not None:
        return 0.5 * control.width
    limit = widest(problem)
    steps = OPTIONS.decades * OPTIONS.points_per_decade
    if math.isfinite(limit):
        a = limit * np.logspace(-OPTIONS.decades, 0, steps + 1)
    else:
        a = np.logspace(-OPTIONS.decades, OPTIONS.decades, 2 * steps + 1)
    value = _controlled_quantity(problem, control, a)
    above = np.flatnonzero(value >= control.value)
    if len(above) == 0:
        # If the controlled load or approach is above all scanned values, its maximum between two
        # scanned half widths may still reach it. Of equal maxima the widest is taken. A flat punch
        # has the same zero load at all half widths up to its corners.
        k = int(np.clip(np.flatnonzero(value == value.max())[-1], 1, len(a) - 2))
        top = require("scipy.optimize").minimize_scalar(
            lambda x: -float(_controlled_quantity(problem, control, np.array([x]))[0]),
            bounds=(float(a[k - 1]), float(a[k + 1])),
            method="bounded",
            options={"xatol": MAXIMUM_TOLERANCE * float(a[k])},
        )
        if -top.fun < control.value:
            return float(top.x)
        a, value = np.array([a[k - 1], top.x]), np.array([value[k - 1], -top.fun])
        above = np.array([1])
    k = int(above[0])
    if k == 0:
        return float(a[0])
    low, high, at_low, at_high = float(a[k - 1]), float(a[k]), float(value[k - 1]), float(value[k])
    if at_low <= 0:
        return low * math.sqrt(high / low)

    def above_goal(logarithm: float) -> float:
        carried = float(_controlled_quantity(problem, control, np.array([math.exp(logarithm)]))[0])
        return math.log(carried / control.value) if carried > 0 else -math.inf

    # The controlled quantity is roughly a power of the half width. So its logarithm is interpolated
    # as a function of the logarithm of the half width.
    known = {
        math.log(a): math.log(carried / control.value)
        for a, carried in ((low, at_low), (high, at_high))
    }
    return math.exp(smooth_root(above_goal, known))


def widest(problem: Problem) -> float:
    """The largest scaled half width of a zone about the origin; inf if nothing limits it."""
    cell = 0.4999 * problem.cell if problem.cell is not None else math.inf
    return min(cell, problem.borders[1], problem.corners[1])


def _controlled_quantity(problem: Problem, control: Control, a: Array) -> Array:
    """Load or approach, whichever is controlled, of one zone of each half width a.
    The value is -inf for half widths beyond its first maximum.
    """
    period, poles = problem.period, len(problem.kernel.poles)
    if period is not None and poles > 1:
        sine = np.sin(np.pi * a / period)
        u = np.arcsin(sine[:, None] * NODES)
        x, weight, size = u * period / np.pi, NODES / np.cos(u), sine * period / np.pi
    else:
        x, weight, size = a[:, None] * NODES, NODES, a
    with np.errstate(over="ignore", invalid="ignore"):
        g = problem.forcing.value(x.ravel()).reshape(x.shape)
        value = size * np.pi / len(NODES) * (g * weight).sum(axis=1)
        if period is not None and poles <= 1:
            root = np.sqrt(np.maximum(1 - (2 * a / period) ** 2, 1e-300))
            value = value * (2 - root) if problem.interaction.follows_isolated else value / root
        if control.approach is not None:
            shape = problem.shape(x.ravel()).reshape(x.shape).mean(axis=1)
            half = (
                np.sin(np.pi * a / period) if period is not None else 0.5 * a / problem.kernel.datum
            )
            value = shape - value / np.pi * np.log(half)
    value = np.where(np.isfinite(value), value, -np.inf)
    falls = np.flatnonzero(value[1:] < value[:-1])
    if len(falls):
        value[falls[0] + 1 :] = -np.inf
    if value.max() == -np.inf:
        raise OutOfRange(
            "no zone that was tried as a first guess has a finite load or approach: check that the "
            "heights and slopes of the profile are finite"
        )
    return np.asarray(value)


def carried_by(problem: Problem, control: Control, a: float) -> float:
    """The exact load or approach of one zone of half width a, with bounded pressure at its ends."""
    zones = sie.Zones.of([[-a, a]], problem.held_end, problem.held_end, symmetric=True)
    state = sie.solve_fixed(problem.equation(HalfWidth(a)), zones, 1e-13)
    if control.load is not None:
        return state.density.total
    return -float(state.levels[0])


def single_branch(problem: Problem, control: Control) -> tuple[Array, Array]:
    """(half widths, load or approach at each), up to the first maximum of the load or approach.

    The second array has the quantity that `control` prescribes.
    """
    limit = widest(problem)
    if not math.isfinite(limit):
        limit = 1e3 * guess_half_width(problem, control)
    # The half widths are evenly spaced if a period limits them. Without a period their spacing is
    # geometric.
    steps = OPTIONS.decades * OPTIONS.points_per_decade
    a = limit * (
        np.linspace(0, 1, steps + 1)[1:]
        if problem.cell is not None
        else np.geomspace(1e-4, 1, steps)
    )
    values = np.array([carried_by(problem, control, float(x)) for x in a])
    falls = np.flatnonzero(np.diff(values) < 0)
    if len(falls) == 0:
        return a, values
    k = int(falls[0])
    low, high = float(a[max(k - 1, 0)]), float(a[k + 1])
    best = require("scipy.optimize").minimize_scalar(
        lambda x: -carried_by(problem, control, x),
        bounds=(low, high),
        method="bounded",
        options={"xatol": MAXIMUM_TOLERANCE * high},
    )
    return np.append(a[: max(k, 1)], best.x), np.append(values[: max(k, 1)], -best.fun)
