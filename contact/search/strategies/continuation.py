"""The contact from the last ones on a curve of one control's values: their scaled problem, and
zones carried on to here.

What the carrying on has not told of their number is left to the corrections of the topology loop,
which needs no grid for it: zones are born where the gap is negative, gaps that close are dropped.
"""

import math

import numpy as np

from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.formulation.tables import gaps_between
from contact.model.controls import Quantity
from contact.search.context import SolveContext
from contact.search.grid.nested_grids import MOST_POINTS, asked
from contact.search.grid.scaling import ScaledScene
from contact.search.strategies.full_contact import full_under
from contact.search.strategies.gaps import OF_GAPS, tightened_gaps, worth_gaps
from contact.search.strategies.guesses import Outcome, from_grid
from contact.search.topology.extrapolation import CurvePoint, carried
from contact.search.topology.failure import NOT_APPLICABLE, Failure, attempted
from contact.search.topology.gap_form import GapForm
from contact.search.topology.loop import NewtonSettings, refine_topology
from sie import Array

# Values over one another between which a contact counted in the units of one is in good hands.
_FARTHEST = 16.0
# Rounds of corrections of the number of zones, after which a search from scratch is no longer, and
# steps of Newton's in each: where a grid takes long, or there is none, or little changes; and where
# it takes no time, and the values are far apart.
_ROUNDS = (6, 1)
_STEPS = (0, 6)
# Zones that come and go up to which corrections are the shorter way, likewise.
_FEW = 8, 2
# Values over one another up to which little changes.
_NEAR = 1.08
# Points of a grid: by what part they are fewer than those of a search from scratch, with few zones
# and with many, one more of which is longer than more points; at the least; and from which on it
# takes long.
_COARSER = (4, 2)
_MANY = 400
_FEWEST = 256
_DEAR = 2**15


def from_last(context: SolveContext) -> Outcome | Failure:
    """From the last solution of a curve and those before it."""
    if not context.previous or not _is_followed(context):
        return NOT_APPLICABLE
    last, value = context.previous[-1], context.scene.control[1]
    fields = last.fields
    apart = abs(math.log(value / last.solution.scene.control[1]))
    if fields is None or not apart <= math.log(_FARTHEST):
        return NOT_APPLICABLE
    problem = fields.problem
    control = context.control(problem)
    if full := full_under(context, control):
        return full
    periodic = context.scene.profile.period is not None
    by_grid = periodic and control.load is not None
    points = _points(context) if periodic else _DEAR
    cheap = points < _DEAR and apart > math.log(_NEAR)
    if by_grid and _changes_often(context.previous):
        # Not even asked how the ends move.
        return _by_grid_or_missed(context, problem, control, points)
    zones, changes = carried(context.previous, math.log(value))
    if len(zones) == 0:
        return NOT_APPLICABLE
    if changes > _FEW[cheap] and (by_grid or cheap):
        return _by_grid_or_missed(context, problem, control, points) if by_grid else NOT_APPLICABLE
    if worth_gaps(context, problem, float(np.sum(zones[:, 1] - zones[:, 0]))):
        outcome: Outcome | Failure = attempted(
            lambda: _by_gaps(context, problem, control, zones, cheap)
        )
    else:
        outcome = attempted(lambda: _by_zones(context, problem, control, zones, cheap))
    if isinstance(outcome, Failure) and by_grid:
        context.record_failure("the last zones, carried on", outcome)
        return _by_grid_or_missed(context, problem, control, points)
    return outcome


def _is_followed(context: SolveContext) -> bool:
    """Whether the same scaled problem serves at all values: not where a strip or a tilt goes with
    them, nor where no sign tells what else there is.
    """
    scene = context.scene
    moves = scene.turned or scene.interaction.strip or scene.interaction.follows_isolated
    followed = any(scene.held(quantity) is not None for quantity in (Quantity.LOAD, Quantity.WIDTH))
    return scene.law.equilibria.unique and not moves and not scene.is_flat and followed


def _changes_often(along: tuple[CurvePoint, ...]) -> bool:
    """Whether more zones have come or gone between the last two values than corrections are the
    shorter way for.
    """
    return len(along) > 1 and abs(
        len(along[-1].solution.zones) - len(along[-2].solution.zones)
    ) > max(_FEW)


def _points(context: SolveContext) -> int:
    """Of a grid that tells which zones there are, if not all about them."""
    profile, many = context.scene.profile, len(context.previous[-1].solution.zones) > _MANY
    assert profile.period is not None
    return max(_FEWEST, asked(profile.period, profile.feature, MOST_POINTS)[0] // _COARSER[many])


def _by_grid_or_missed(
    context: SolveContext, problem: Problem, control: Control, points: int
) -> Outcome | Failure:
    """Where many zones come and go a grid tells them, of which a few points are enough: what it is
    wrong about is dropped on the way.
    """
    profile = context.scene.profile
    assert profile.period is not None
    scaled = ScaledScene(problem, control, (profile.x0, profile.x0 + profile.period))
    return attempted(lambda: from_grid(context, scaled, points=points, allow_loss=True))


def _by_zones(
    context: SolveContext, problem: Problem, control: Control, zones: Array, cheap: bool
) -> Outcome | Failure:
    guess = (
        0.0 if control.load is not None else context.previous[-1].solution.load / problem.units.load
    )
    return context.refine_topology(
        problem,
        control,
        zones,
        load_guess=guess,
        rounds=_ROUNDS[cheap],
        max_steps=_STEPS[cheap],
        allow_loss=True,
    )


def _by_gaps(
    context: SolveContext, problem: Problem, control: Control, zones: Array, cheap: bool
) -> Outcome | Failure:
    period = problem.repeat_length
    mean = context.previous[-1].solution.load / problem.units.load / period
    form, newton = (
        GapForm(problem, context.cache.relief(problem)),
        NewtonSettings(OF_GAPS * context.tolerance, mean, max_steps=_STEPS[cheap], allow_loss=True),
    )
    with context.plan.timed("zone ends"):
        found = refine_topology(
            form,
            control,
            gaps_between(zones, period),
            newton,
            context.progress,
            rounds=_ROUNDS[cheap],
        )
        if isinstance(found, Failure):
            return found
        found = tightened_gaps(context, found)
    return found if np.isfinite(found.error) else NOT_APPLICABLE
