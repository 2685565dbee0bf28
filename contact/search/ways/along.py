"""The contact from the last ones on a curve of one control's values: their scaled problem, and zones or gaps carried on to here.

Ends go as polynomials of the logarithm of the value, as long as there are as many of them. A change of their number is left to the
corrections of the topology loop, which needs no grid for it: zones are born where the gap is negative, gaps that close are dropped.
"""

from __future__ import annotations

import numpy as np

from contact.formulation.controls import Control
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.units import Units
from contact.model.controls import Quantity
from contact.search.task import Task
from contact.search.topology.by_gaps import ByGaps
from contact.search.topology.loop import Newton, refine_topology
from contact.search.topology.missed import NOT_MINE, Missed, attempted
from contact.search.ways.full_contact import full_under
from contact.search.ways.gaps import OF_GAPS, by_gaps, tightened_gaps, worth_gaps
from contact.search.ways.guesses import Outcome
from contact.solution.solution import Solution
from sie import Array

# Values over one another between which a contact counted in the units of one is in good hands.
_FARTHEST = 16.0
# Of a zone, or of a gap, that must be left where it is carried on.
_KEPT = 0.1
# Corrections of the number of zones, after which a search from scratch is no longer.
_ROUNDS = 6
# Zones that come or go between two values times all that are moved at each correction for them, up to which that is the shorter way; and
# zones of a first value among which there are no more.
_OFTEN, _MANY = 100, 64


def from_last(task: Task) -> Outcome | Missed:
    """From the last solution of a curve and those before it."""
    if not task.along or not _is_followed(task):
        return NOT_MINE
    if _changes_often(task.along):
        return Missed("so many zones come and go that a grid tells them sooner")
    fields, value = task.along[-1].fields, task.scene.control[1]
    if not isinstance(fields, ZoneFields | GapFields) or not 1 / _FARTHEST <= value / task.along[-1].scene.control[1] <= _FARTHEST:
        return NOT_MINE
    problem = fields.problem
    control = task.control(problem)
    if full := full_under(task, control):
        return full
    table = _carried_on(task.along, value)
    if isinstance(fields, GapFields):
        outcome: Outcome | Missed = attempted(lambda: _from_gaps(task, problem, fields, control, table))
    else:
        outcome = attempted(lambda: _from_zones(task, problem, control, table))
    return outcome


def _changes_often(along: tuple[Solution, ...]) -> bool:
    """Whether so many zones come and go from one value to the next that a grid tells them sooner than corrections do."""
    if len(along) == 1:
        return len(along[-1].zones) > _MANY
    count, before = len(along[-1].zones), len(along[-2].zones)
    return abs(count - before) * max(count, before) > _OFTEN


def _is_followed(task: Task) -> bool:
    """Whether the same scaled problem serves at all values: not where a strip or a tilt goes with them, nor where no sign tells what else
    there is."""
    scene = task.scene
    moves = scene.turned or scene.interaction.strip or scene.interaction.follows_isolated
    followed = any(scene.held(quantity) is not None for quantity in (Quantity.LOAD, Quantity.WIDTH))
    return scene.law.convex and not moves and not scene.is_flat and followed


def _carried_on(along: tuple[Solution, ...], value: float) -> Array:
    """Scaled zones or gaps at a value, by the polynomial through those of the last values, of as many as are alike."""
    last = along[-1]
    tables: list[Array] = []
    at: list[float] = []
    for solution in reversed(along):
        known = _table(solution)
        if known is None or type(solution.fields) is not type(last.fields) or not _alike(solution, last):
            break
        tables.append(known)
        at.append(float(np.log(solution.scene.control[1] / value)))
    first = tables[0]
    if len(set(at)) < len(at):
        return first
    # Lagrange's weights at 0.
    weights = [np.prod([-other / (own - other) for other in at if other != own]) for own in at]
    table = np.asarray(sum(weight * known for weight, known in zip(weights, tables, strict=True)))
    # Nothing is carried over what narrows to nothing on the way.
    assert isinstance(last.fields, ZoneFields | GapFields)
    period = last.fields.problem.period
    kept = np.all(np.diff(table, axis=1) > _KEPT * np.diff(first, axis=1)) and np.all(_gaps(table, period) > _KEPT * _gaps(first, period))
    return table if kept else first


def _gaps(table: Array, period: float | None) -> Array:
    """Widths of what lies between intervals."""
    after = table[1:, 0] if period is None else np.append(table[1:, 0], table[0, 0] + period)
    return np.asarray(after - table[: len(after), 1])


def _table(solution: Solution) -> Array | None:
    fields = solution.fields
    return np.asarray(fields.density.zones.table) if isinstance(fields, ZoneFields | GapFields) else None


def _units(solution: Solution) -> Units | None:
    return solution.fields.problem.units if isinstance(solution.fields, ZoneFields | GapFields) else None


def _alike(one: Solution, other: Solution) -> bool:
    mine, others = _table(one), _table(other)
    if mine is None or others is None or mine.shape != others.shape or _units(one) != _units(other):
        return False
    # The same ones, and not as many others.
    return bool(np.all((mine[:, 0] < others[:, 1]) & (others[:, 0] < mine[:, 1])))


def _from_zones(task: Task, problem: Problem, control: Control, table: Array) -> Outcome | Missed:
    width = float(np.sum(table[:, 1] - table[:, 0]))
    if worth_gaps(task, problem, width):
        return by_gaps(task, problem, control, width, table)
    guess = 0.0 if control.load is not None else task.along[-1].load / problem.units.load
    return task.refine_topology(problem, control, table, value=guess, rounds=_ROUNDS)


def _from_gaps(task: Task, problem: Problem, fields: GapFields, control: Control, table: Array) -> Outcome | Missed:
    contact = fields.period - float(np.sum(table[:, 1] - table[:, 0]))
    if not worth_gaps(task, problem, contact):
        between = np.column_stack((table[:, 1], np.append(table[1:, 0], table[0, 0] + fields.period)))
        return task.refine_topology(problem, control, between, value=fields.mean * fields.period, rounds=_ROUNDS)
    form, newton = ByGaps(problem, fields.relief), Newton(OF_GAPS * task.tolerance, fields.mean)
    with task.plan.timed("zone ends"):
        found = refine_topology(form, control, table, newton, task.progress, rounds=_ROUNDS)
        if isinstance(found, Missed):
            return found
        found = tightened_gaps(task, found)
    return found if np.isfinite(found.error) else NOT_MINE
