"""The contact at one value of a control, from the contacts at previous values.

The zones are extrapolated to the new value in the scaled problem of the last solution. If these
zones prove to be far from the solution, the zones of a grid are tried next. If only the number of
zones is wrong, the topology loop corrects it without a grid: zones are born where the gap is
negative, and gaps that close are dropped.
"""

import math
from dataclasses import dataclass

import numpy as np

from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.formulation.tables import gaps_between
from contact.model.controls import Quantity
from contact.search.context import SolveContext
from contact.search.grid import nested_grids
from contact.search.grid.scaling import ScaledScene
from contact.search.options import SEARCH
from contact.search.strategies import guesses
from contact.search.strategies.full_contact import full_under
from contact.search.strategies.gaps import gap_tolerance, gaps_are_better, tightened_gaps
from contact.search.strategies.guesses import Outcome, from_grid
from contact.search.topology.extrapolation import extrapolated
from contact.search.topology.failure import NOT_APPLICABLE, Failure, attempted
from contact.search.topology.gap_form import GapForm
from contact.search.topology.loop import NewtonSettings, Observer, refine_topology
from sie import Array


@dataclass(frozen=True)
class ContinuationOptions:
    """Limits beyond which extrapolated zones are not tried as a first guess.

    With `max_changes` from 2 to 8, load curves of 5 to 80 values take the same time. Without this
    limit, load curves of contacts with many zones take a tenth longer.
    """

    # Largest ratio of successive loads or widths. Above this ratio, the units of length and slope
    # chosen for the last solution do not suit the size of the new contact.
    max_ratio: float = 16.0
    max_changes: int = 4  # largest number of zones that appear or vanish


OPTIONS = ContinuationOptions()


def from_previous(context: SolveContext) -> Outcome | Failure:
    """The contact from zones extrapolated from the solutions at the last loads or widths."""
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
    has_grid = _has_grid(context, control)
    zones, changes = extrapolated(context.previous, math.log(value))
    if len(zones) == 0:
        return NOT_APPLICABLE
    if has_grid and changes > OPTIONS.max_changes:
        _decide(context, "a grid", changes)
        return _by_grid(context, problem, control)
    _decide(context, "the previous zones, extrapolated", changes)
    use_gaps = gaps_are_better(context, problem, float(np.diff(zones, axis=1).sum()))
    correct = _by_gaps if use_gaps else _by_zones
    outcome: Outcome | Failure = attempted(lambda: correct(context, problem, control, zones))
    if isinstance(outcome, Failure) and has_grid:
        context.record_failure("zones extrapolated from the last ones", outcome)
        return _by_grid(context, problem, control)
    return outcome


def _has_grid(context: SolveContext, control: Control) -> bool:
    """Whether one grid gives a first guess; unless a load is given, several grids are needed."""
    return context.scene.profile.period is not None and control.load is not None


def _decide(context: SolveContext, way: str, changes: int) -> None:
    """Record in the plan the source of the first guess, and how many zones came or went."""
    because = "the number of zones that appear or vanish after the last value is {}"
    context.plan.decide("first guess", way, because, changes, OPTIONS.max_changes)


def _is_followed(context: SolveContext) -> bool:
    """Whether zones can be extrapolated: the scaled problem is constant, equilibrium is unique.

    In a localized model, or with an unknown tilt, the scaled problem changes with the control's
    value.
    """
    scene = context.scene
    changes = scene.turned or scene.interaction.strip or scene.interaction.follows_isolated
    followed = any(scene.held(quantity) is not None for quantity in (Quantity.LOAD, Quantity.WIDTH))
    return scene.law.equilibria.unique and not changes and not scene.is_flat and followed


def _by_grid(context: SolveContext, problem: Problem, control: Control) -> Outcome | Failure:
    """The contact from a coarse grid; Newton's method removes superfluous zones of the grid."""
    profile = context.scene.profile
    assert profile.period is not None
    scaled = ScaledScene(problem, control, (profile.x0, profile.x0 + profile.period))
    least, most = nested_grids.points_for(profile.period, None, nested_grids.MOST_POINTS)
    points = nested_grids.points_for(profile.period, profile.feature, most)[0]
    points = max(least, points // guesses.OPTIONS.refinement)
    return attempted(lambda: from_grid(context, scaled, points=points, allow_loss=True))


def _by_zones(
    context: SolveContext, problem: Problem, control: Control, zones: Array
) -> Outcome | Failure:
    """The contact from extrapolated zones, with the pressure on the zones as the unknown."""
    load = context.previous[-1].solution.load / problem.units.load
    return context.refine_topology(
        problem,
        control,
        zones,
        load_guess=0.0 if control.load is not None else load,
        max_rounds=SEARCH.max_attempts,
        abandon_if_far=_has_grid(context, control),
        allow_loss=True,
    )


def _by_gaps(
    context: SolveContext, problem: Problem, control: Control, zones: Array
) -> Outcome | Failure:
    """The contact with the gaps as the unknown, from the gaps between the guessed `zones`."""
    period = problem.repeat_length
    form = GapForm(problem, context.cache.relief(problem))
    newton = NewtonSettings(
        gap_tolerance(context),
        load_guess=context.previous[-1].solution.load / problem.units.load / period,
        max_rounds=SEARCH.max_attempts,
        abandon_if_far=_has_grid(context, control),
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
