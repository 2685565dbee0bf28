"""The contact from the previous ones on a curve of values of one control.

The zones are extrapolated to the new value in the scaled problem of the last solution. Where the
extrapolation has the wrong number of zones, the topology loop corrects it, and needs no grid: zones
are born where the gap is negative, and gaps that close are dropped.
"""

import math
from dataclasses import dataclass

import numpy as np

from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.formulation.tables import gaps_between
from contact.model.controls import Quantity
from contact.search.context import SolveContext
from contact.search.grid.nested_grids import MOST_POINTS, points_for
from contact.search.grid.scaling import ScaledScene
from contact.search.strategies import gaps
from contact.search.strategies.full_contact import full_under
from contact.search.strategies.gaps import gaps_are_better, tightened_gaps
from contact.search.strategies.guesses import Outcome, from_grid
from contact.search.topology.extrapolation import CurvePoint, extrapolated
from contact.search.topology.failure import NOT_APPLICABLE, Failure, attempted
from contact.search.topology.gap_form import GapForm
from contact.search.topology.loop import NewtonSettings, Observer, refine_topology
from sie import Array


@dataclass(frozen=True)
class Effort:
    """Corrections of extrapolated zones before a search from the start is shorter."""

    max_rounds: int
    max_newton_steps: int  # in each round; 0: as many as the formulation allows
    max_changes: int  # zones that come or go


@dataclass(frozen=True)
class ContinuationOptions:
    """When extrapolated zones are corrected, and when a grid is the shorter way."""

    max_ratio: float = 16.0  # of values; beyond it the units of the last solution are unsuitable
    small_ratio: float = 1.08  # of values; below it hardly a zone comes or goes
    # A grid takes long, or there is none, or the values are close: correct for long.
    beside_long_search: Effort = Effort(max_rounds=6, max_newton_steps=0, max_changes=8)
    # A grid takes no time.
    beside_short_search: Effort = Effort(max_rounds=1, max_newton_steps=6, max_changes=2)
    # Points of a search from the start, over those of this grid: 4 with few zones, half with many,
    # where one more correction costs more than points.
    coarsening: int = 4
    many_zones: int = 400
    fewest_points: int = 256
    long_search_points: int = 2**15  # such a grid takes as long as several corrections


OPTIONS = ContinuationOptions()


def from_previous(context: SolveContext) -> Outcome | Failure:
    """The contact from the last solution of a curve and those before it."""
    if not context.previous or not _is_followed(context):
        return NOT_APPLICABLE
    last, value = context.previous[-1], context.scene.control[1]
    fields = last.fields
    log_ratio = abs(math.log(value / last.solution.scene.control[1]))
    if fields is None or not log_ratio <= math.log(OPTIONS.max_ratio):
        return NOT_APPLICABLE
    problem = fields.problem
    control = context.control(problem)
    if full := full_under(context, control):
        return full
    is_periodic = context.scene.profile.period is not None
    grid_possible = is_periodic and control.load is not None
    points = _grid_points(context) if is_periodic else OPTIONS.long_search_points
    search_is_short = points < OPTIONS.long_search_points and log_ratio > math.log(
        OPTIONS.small_ratio
    )
    effort = OPTIONS.beside_short_search if search_is_short else OPTIONS.beside_long_search
    recent = _recent_changes(context.previous)
    if grid_possible and recent > OPTIONS.beside_long_search.max_changes:
        _decide(context, "a grid", recent, OPTIONS.beside_long_search)
        return _by_grid(context, problem, control, points)
    zones, changes = extrapolated(context.previous, math.log(value))
    if len(zones) == 0:
        return NOT_APPLICABLE
    if changes > effort.max_changes and (grid_possible or search_is_short):
        _decide(context, "a grid", changes, effort)
        return _by_grid(context, problem, control, points) if grid_possible else NOT_APPLICABLE
    _decide(context, "the previous zones, extrapolated", changes, effort)
    use_gaps = gaps_are_better(context, problem, float(np.diff(zones, axis=1).sum()))
    correct = _by_gaps if use_gaps else _by_zones
    outcome: Outcome | Failure = attempted(
        lambda: correct(context, problem, control, zones, effort)
    )
    if isinstance(outcome, Failure) and grid_possible:
        context.record_failure("the last zones, carried on", outcome)
        return _by_grid(context, problem, control, points)
    return outcome


def _decide(context: SolveContext, way: str, changes: int, effort: Effort) -> None:
    """Keep in the plan where the first guess comes from."""
    because = "{} zones come or go from the last value"
    context.plan.decide("first guess", way, because, changes, effort.max_changes)


def _is_followed(context: SolveContext) -> bool:
    """Whether one scaled problem serves at all values, and signs tell which zones there are.

    A strip and a tilt change with the value.
    """
    scene = context.scene
    changes = scene.turned or scene.interaction.strip or scene.interaction.follows_isolated
    followed = any(scene.held(quantity) is not None for quantity in (Quantity.LOAD, Quantity.WIDTH))
    return scene.law.equilibria.unique and not changes and not scene.is_flat and followed


def _recent_changes(previous: tuple[CurvePoint, ...]) -> int:
    """By how much the number of zones changed between the last two values."""
    if len(previous) < 2:
        return 0
    before, last = previous[-2:]
    return abs(len(last.solution.zones) - len(before.solution.zones))


def _grid_points(context: SolveContext) -> int:
    """Points of a grid that finds which zones there are, but not all about them."""
    profile, zones = context.scene.profile, len(context.previous[-1].solution.zones)
    assert profile.period is not None
    coarsening = OPTIONS.coarsening // 2 if zones > OPTIONS.many_zones else OPTIONS.coarsening
    points = points_for(profile.period, profile.feature, MOST_POINTS)[0]
    return max(OPTIONS.fewest_points, points // coarsening)


def _by_grid(
    context: SolveContext, problem: Problem, control: Control, points: int
) -> Outcome | Failure:
    """The contact from a coarse grid: zones that it has in excess are dropped by Newton."""
    profile = context.scene.profile
    assert profile.period is not None
    scaled = ScaledScene(problem, control, (profile.x0, profile.x0 + profile.period))
    return attempted(lambda: from_grid(context, scaled, points=points, allow_loss=True))


def _by_zones(
    context: SolveContext, problem: Problem, control: Control, zones: Array, effort: Effort
) -> Outcome | Failure:
    """The contact from extrapolated zones."""
    load = context.previous[-1].solution.load / problem.units.load
    return context.refine_topology(
        problem,
        control,
        zones,
        load_guess=0.0 if control.load is not None else load,
        max_rounds=effort.max_rounds,
        max_steps=effort.max_newton_steps,
        allow_loss=True,
    )


def _by_gaps(
    context: SolveContext, problem: Problem, control: Control, zones: Array, effort: Effort
) -> Outcome | Failure:
    """The contact from the gaps between extrapolated zones."""
    period = problem.repeat_length
    form = GapForm(problem, context.cache.relief(problem))
    newton = NewtonSettings(
        gaps.OPTIONS.tolerance_factor * context.tolerance,
        load_guess=context.previous[-1].solution.load / problem.units.load / period,
        max_rounds=effort.max_rounds,
        max_steps=effort.max_newton_steps,
        allow_loss=True,
    )
    with context.plan.timed("zone ends"):
        found = refine_topology(
            form, control, gaps_between(zones, period), newton, Observer(context.progress)
        )
        if isinstance(found, Failure):
            return found
        found = tightened_gaps(context, found)
    return found if np.isfinite(found.error) else NOT_APPLICABLE
