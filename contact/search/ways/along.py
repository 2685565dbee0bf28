"""The contact from the last ones on a curve of one control's values: their scaled problem, and zones carried on to here.

What the carrying on has not told of their number is left to the corrections of the topology loop, which needs no grid for it: zones are
born where the gap is negative, gaps that close are dropped.
"""

from __future__ import annotations

import numpy as np

from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.formulation.tables import gaps_between
from contact.model.controls import Quantity
from contact.search.grid.coarse import MOST_POINTS, asked
from contact.search.grid.scaling import ScaledScene
from contact.search.task import Task
from contact.search.topology.by_gaps import ByGaps
from contact.search.topology.carried import Passed, carried
from contact.search.topology.loop import Newton, refine_topology
from contact.search.topology.missed import NOT_MINE, Missed, attempted
from contact.search.ways.full_contact import full_under
from contact.search.ways.gaps import OF_GAPS, tightened_gaps, worth_gaps
from contact.search.ways.guesses import Outcome, from_grid
from sie import Array

# Values over one another between which a contact counted in the units of one is in good hands.
_FARTHEST = 16.0
# Corrections of the number of zones, after which a search from scratch is no longer.
_ROUNDS = 6
# Zones that come and go up to which corrections are the shorter way. Else the points of a grid: by what part they are fewer than those of a
# search from scratch, with few zones and with many, one more of which is longer than more points; and at the least.
_FEW, _COARSER, _MANY, _FEWEST = 8, (4, 2), 400, 256


def from_last(task: Task) -> Outcome | Missed:
    """From the last solution of a curve and those before it."""
    if not task.along or not _is_followed(task):
        return NOT_MINE
    last, value = task.along[-1], task.scene.control[1]
    fields = last.fields
    if fields is None or not 1 / _FARTHEST <= value / last.solution.scene.control[1] <= _FARTHEST:
        return NOT_MINE
    problem = fields.problem
    control = task.control(problem)
    if full := full_under(task, control):
        return full
    by_grid = task.scene.profile.period is not None and control.load is not None
    if by_grid and _changes_often(task.along):
        # Not even asked how the ends move.
        return _by_grid_or_missed(task, problem, control)
    zones, changes = carried(task.along, float(np.log(value)))
    if len(zones) == 0:
        return NOT_MINE
    if by_grid and changes > _FEW:
        return _by_grid_or_missed(task, problem, control)
    if worth_gaps(task, problem, float(np.sum(zones[:, 1] - zones[:, 0]))):
        outcome: Outcome | Missed = attempted(lambda: _by_gaps(task, problem, control, zones))
    else:
        outcome = attempted(lambda: _by_zones(task, problem, control, zones))
    return outcome


def _is_followed(task: Task) -> bool:
    """Whether the same scaled problem serves at all values: not where a strip or a tilt goes with them, nor where no sign tells what else
    there is."""
    scene = task.scene
    moves = scene.turned or scene.interaction.strip or scene.interaction.follows_isolated
    followed = any(scene.held(quantity) is not None for quantity in (Quantity.LOAD, Quantity.WIDTH))
    return scene.law.convex and not moves and not scene.is_flat and followed


def _changes_often(along: tuple[Passed, ...]) -> bool:
    """Whether more zones have come or gone between the last two values than corrections are the shorter way for."""
    return len(along) > 1 and abs(len(along[-1].solution.zones) - len(along[-2].solution.zones)) > _FEW


def _by_grid_or_missed(task: Task, problem: Problem, control: Control) -> Outcome | Missed:
    """Where many zones come and go a grid tells them, of which a few points are enough: what it is wrong about is dropped on the way."""
    profile, many = task.scene.profile, len(task.along[-1].solution.zones) > _MANY
    assert profile.period is not None
    points = max(_FEWEST, asked(profile.period, profile.feature, MOST_POINTS)[0] // _COARSER[many])
    scaled = ScaledScene(problem, control, (profile.x0, profile.x0 + profile.period))
    outcome: Outcome | Missed = attempted(lambda: from_grid(task, scaled, points=points, drops=True))
    return outcome


def _by_zones(task: Task, problem: Problem, control: Control, zones: Array) -> Outcome | Missed:
    guess = 0.0 if control.load is not None else task.along[-1].solution.load / problem.units.load
    return task.refine_topology(problem, control, zones, value=guess, rounds=_ROUNDS, drops=True)


def _by_gaps(task: Task, problem: Problem, control: Control, zones: Array) -> Outcome | Missed:
    period = problem.period
    assert period is not None
    mean = task.along[-1].solution.load / problem.units.load / period
    form, newton = ByGaps(problem, task.shared.relief(problem)), Newton(OF_GAPS * task.tolerance, mean, drops=True)
    with task.plan.timed("zone ends"):
        found = refine_topology(form, control, gaps_between(zones, period), newton, task.progress, rounds=_ROUNDS)
        if isinstance(found, Missed):
            return found
        found = tightened_gaps(task, found)
    return found if np.isfinite(found.error) else NOT_MINE
