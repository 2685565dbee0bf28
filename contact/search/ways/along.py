"""The contact from the last ones on a curve of one control's values: their scaled problem, and zones carried on to here.

What the carrying on has not told of their number is left to the corrections of the topology loop, which needs no grid for it: zones are
born where the gap is negative, gaps that close are dropped.
"""

import math

import numpy as np

from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.formulation.tables import gaps_between
from contact.model.controls import Quantity
from contact.search.grid.coarse import MOST_POINTS, asked
from contact.search.grid.scaling import ScaledScene
from contact.search.task import Task
from contact.search.topology.by_gaps import ByGaps
from contact.search.topology.carried import carried
from contact.search.topology.loop import Newton, refine_topology
from contact.search.topology.missed import NOT_MINE, Missed, attempted
from contact.search.ways.full_contact import full_under
from contact.search.ways.gaps import OF_GAPS, tightened_gaps, worth_gaps
from contact.search.ways.guesses import Outcome, from_grid
from sie import Array

# Values over one another between which a contact counted in the units of one is in good hands.
_FARTHEST = 16.0
# Rounds of corrections of the number of zones, after which a search from scratch is no longer, and steps of Newton's in each; zones that
# come and go up to which corrections are the shorter way.
_ROUNDS, _STEPS, _FEW = 3, 6, 4
# Points of a grid: by what part they are fewer than those of a search from scratch, with few zones and with many, one more of which is
# longer than more points; at the least.
_COARSER, _MANY, _FEWEST = (4, 2), 400, 256


def from_last(task: Task) -> Outcome | Missed:
    """From the last solution of a curve, and the one before it."""
    if not task.along or not _is_followed(task):
        return NOT_MINE
    last, fields, at = task.along[-1].solution, task.along[-1].fields, math.log(task.scene.control[1])
    if fields is None or not abs(at - task.along[-1].at) <= math.log(_FARTHEST):
        return NOT_MINE
    problem = fields.problem
    control = task.control(problem)
    if full := full_under(task, control):
        return full
    zones, changes = carried(task.along, at)
    if len(zones) == 0:
        return NOT_MINE
    by_grid = task.scene.profile.period is not None and control.load is not None
    if changes > _FEW:
        return _by_grid(task, problem, control, len(last.zones)) if by_grid else NOT_MINE
    way = _by_gaps if worth_gaps(task, problem, float(np.sum(zones[:, 1] - zones[:, 0]))) else _by_zones
    outcome: Outcome | Missed = attempted(lambda: way(task, problem, control, zones, last.load / problem.units.load))
    if isinstance(outcome, Missed) and by_grid:
        task.left("the last zones, carried on", outcome)
        return _by_grid(task, problem, control, len(last.zones))
    return outcome


def _is_followed(task: Task) -> bool:
    """Whether the same scaled problem serves at all values: not where a strip or a tilt goes with them, nor where no sign tells what else
    there is."""
    scene = task.scene
    moves = scene.turned or scene.interaction.strip or scene.interaction.follows_isolated
    followed = any(scene.held(quantity) is not None for quantity in (Quantity.LOAD, Quantity.WIDTH))
    return scene.law.convex and not moves and not scene.is_flat and followed


def _by_grid(task: Task, problem: Problem, control: Control, zones: int) -> Outcome | Missed:
    """Where many zones come and go a grid tells them, of which a few points are enough: what it is wrong about is dropped on the way.
    zones: how many there were last."""
    profile = task.scene.profile
    assert profile.period is not None
    points = max(_FEWEST, asked(profile.period, profile.feature, MOST_POINTS)[0] // _COARSER[zones > _MANY])
    scaled = ScaledScene(problem, control, (profile.x0, profile.x0 + profile.period))
    outcome: Outcome | Missed = attempted(lambda: from_grid(task, scaled, points=points, drops=True))
    return outcome


def _by_zones(task: Task, problem: Problem, control: Control, zones: Array, load: float) -> Outcome | Missed:
    guess = 0.0 if control.load is not None else load
    return task.refine_topology(problem, control, zones, value=guess, rounds=_ROUNDS, steps=_STEPS, drops=True)


def _by_gaps(task: Task, problem: Problem, control: Control, zones: Array, load: float) -> Outcome | Missed:
    period = problem.period
    assert period is not None
    form, newton = ByGaps(problem, task.shared.relief(problem)), Newton(OF_GAPS * task.tolerance, load / period, steps=_STEPS, drops=True)
    with task.plan.timed("zone ends"):
        found = refine_topology(form, control, gaps_between(zones, period), newton, task.progress, rounds=_ROUNDS)
        if isinstance(found, Missed):
            return found
        found = tightened_gaps(task, found)
    return found if np.isfinite(found.error) else NOT_MINE
