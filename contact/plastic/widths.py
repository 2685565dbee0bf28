"""Contacts of a given contact fraction or half width, under a limit of the pressure.

Contacts grow with the load: a bracket on the load finds the load at which the width has the given
value. A contact of width w bears less than H w, with the hardness H. So no larger load is tried.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contact.errors import NotConverged, OutOfRange, SceneError
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.model.controls import Quantity
from contact.model.profiles.noise import EPS
from contact.plastic.fields import PlasticFields
from contact.search.context import SolveContext
from contact.search.options import SEARCH
from contact.search.strategies.load_search import KnownLoads, contact_fraction, nearer
from contact.search.topology.failure import Failure
from contact.solution.solution import Solution
from contact.verify.error import SolvedZones
from sie import nearest_image

# Type of a function that solves again under the load of a solution, started from this solution.
SolveAgain = Callable[[SolveContext, Solution], SolvedZones | Failure]


def at_width(context: SolveContext, solve_again: SolveAgain) -> SolvedZones:
    """The contact that has the contact fraction or the half width that the scene gives.

    solve_again: see `SolveAgain`. Raises OutOfRange if no load gives this width.
    """
    scene, half = context.scene, context.scene.held(Quantity.HALF_WIDTH)
    fraction = scene.given_fraction
    if fraction is not None and fraction >= 1.0:
        raise SceneError.of(
            "contact_fraction",
            fraction,
            "below 1 if the pressure reaches the limit of the law; use the event 'full' of "
            "contact.path for the load at which the last gap closes",
        )
    of, goal = (half_width, half) if half is not None else (contact_fraction, fraction)
    assert goal is not None
    period = scene.period
    width = 2 * goal if half is not None else goal * (period or 0.0)
    scale = 0.0 if period is None else np.pi / 2 if half is None else np.pi / period
    bearing = scene.law.pressure_range.highest * width
    tolerance = max(SEARCH.tight_factor * context.tol, SEARCH.least_error)

    def solve(load: float, nearest: Solution | None) -> Solution:
        if load >= bearing:
            raise OutOfRange("no contact of this width carries so large a load")
        try:
            return context.solve_scene(scene.under("load", load), tolerance, nearest or start)
        except NotConverged as failure:
            if failure.best is None or not failure.best.error < context.tol:
                raise
            return failure.best

    # First guess of the load. Two contacts of the wanted width carry more than the wanted contact:
    # the elastic contact (usually `start`), and a single plateau (`bearing`). So the guess is below
    # both loads.
    start = context.warm_start
    first = 1.0 / ((1.0 / start.load if start else 0.0) + 1.0 / bearing)

    def quantity(solution: Solution) -> tuple[float, float]:
        value, rate = of(solution)
        return _evened(value, scale), rate * _evened_slope(value, scale)

    best, error = None, np.inf
    limits = KnownLoads(bounded=True, closed=64 * EPS)
    for here, load_error in nearer(solve, quantity, _evened(goal, scale), first, limits):
        value, rate = of(here)
        own = 2 * here.error * abs(value) / (rate * here.load) if rate > 0.0 else np.inf
        if load_error + own < error:
            best, error = here, load_error + own
        if load_error <= own < np.inf:
            break
    name, given = scene.control
    alone = half is None or best is None or len(best.zones) == 1 and half_width(best)[0] > 0.0
    if best is None or not alone:
        what = "one contact about x = 0" if half is not None else "a contact"
        raise OutOfRange(f"no load gives {what} with {name} = {given:.15g}")
    found = solve_again(context, best) if isinstance(best.fields, PlasticFields) else None
    if not isinstance(found, SolvedZones):
        raise NotConverged(f"not converged: no load with {name} = {given:.15g} was found", (), best)
    because = "the contact width grows with the load"
    context.plan.decide("control", "a load search", because)
    return _with_error_of_load(found, error)


def _evened(width: float, scale: float) -> float:
    """A function of the contact width whose value grows almost linearly with the load.

    It is sin^2(scale * width), with the sign of the width, for periodic contact. It is exactly
    linear in the load for an elastic wave (`contact.Sinusoid`). For isolated contact, scale is 0
    and the value is the width itself.
    """
    return float(np.copysign(np.sin(scale * width) ** 2, width)) if scale else width


def _evened_slope(width: float, scale: float) -> float:
    """Derivative of `_evened` by the contact width."""
    return scale * abs(float(np.sin(2 * scale * width))) if scale else 1.0


def half_width(solution: Solution) -> tuple[float, float]:
    """Half width [m] of the contact about x = 0, and its derivative by the load.

    If there is a gap about x = 0, the first number is minus the half width of the gap.
    """
    period, table = solution.scene.period, solution.fields.zone_table
    if len(table) == 0:
        return 0.5 * (period or np.inf), 0.0
    away = np.abs(nearest_image(table, 0.0, period))
    k, side = np.unravel_index(np.argmin(away), away.shape)
    middle = nearest_image(np.array(table[k].mean()), 0.0, period)
    around = abs(float(middle)) < 0.5 * float(np.diff(table[k])[0])
    fields = solution.fields
    assert isinstance(fields, ZoneFields | GapFields)
    rate = float(fields.spreading[k, side]) / solution.load
    return (1.0 if around else -1.0) * float(away[k, side]), rate


def _with_error_of_load(found: SolvedZones, error: float) -> SolvedZones:
    """The contact with additional errors of its ends, due to a relative error of its load."""
    fields = found.fields
    assert isinstance(fields, PlasticFields)
    moved = np.abs(fields.moves).T * abs(fields.density.total) * error
    shifts = moved / found.free.end_scales[:, None]
    return replace(found, control_error=found.control_error + shifts)
