"""Contact under a law with several equilibria: the branch that is asked for is followed, from first touch or from the greatest contact.

    advancing    from the zones of the bare law, which lie within it, or from first touch: ends advance under the control held, new
                 zones begin where the surfaces would overlap, zones that meet become one; under tension, or below first touch, from
                 there at no load back again
    receding     from a zone as wide as it takes to be driven inward; with a period full contact, which stays closed

Whatever is closed stays closed: an opening without width has no intensity. So there are no new gaps within zones.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import sie
from contact.errors import NotConverged, OutOfRange, unwarned
from contact.formulation.controls import Load
from contact.formulation.equilibria import Closed, Equilibria, Point, kind_of
from contact.formulation.fields import ZoneFields
from contact.formulation.maxima import maximum
from contact.formulation.problem import Problem
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import ScaledScene, scaled_scene, scaled_scene_about
from contact.search.task import Task
from contact.search.topology.missed import Missed
from contact.search.ways.full_contact import Full, no_inverse
from contact.search.ways.guesses import Outcome
from contact.solution.solution import Solution
from contact.verify.certificate import certify

Array = NDArray[np.float64]

# Tolerance of solutions under the bare law, from which the branch is followed.
_BARE = 1e-6
# First touch over the width that adhesion makes of it, and a new zone over the overlap it begins in.
_TOUCH, _NEW = 1e-3, 0.1
# Heights that differ by this part of their range touch together.
_TOGETHER = 1e-12
_ROUNDS, _SCALINGS, _WIDENINGS = 60, 6, 120
# The greatest contact is looked for in zones ever wider by this, and is one that is driven inward, as those so many times as wide are.
_WIDEN, _WIDER = 1.25, (1.25, 1.5, 2.0, 3.0, 5.0, 8.0)


def followed(task: Task) -> Outcome:
    """The contact of the scene on the branch that the task asks for; OutOfRange past pull-off."""
    scene = task.scene
    if task.branch == "receding" and scene.period is not None:
        return _full(task)
    scaled = frame(task, abs(scene.law.intensity(scene.E_star)))
    problem, control = scaled.problem, scaled.control
    curve = Equilibria(problem, kind_of(control))
    try:
        with task.plan.timed("zone ends"):
            if task.branch == "receding":
                last = _greatest(curve, scaled, control.value)
                rest = curve.receded(last, control.value)
                start: Point | None = None if rest is not None else _held_higher(curve, last, control.value)
            else:
                start = _advanced(task, scaled, curve, max(control.value, 0.0))
                rest = start if control.value >= 0.0 else curve.receded(start.table, control.value)
    except Closed:
        return _full(task)
    if rest is None:
        assert start is not None
        raise OutOfRange(past(curve, curve.pull_off(start), task))
    found = task.refine_topology(problem, control, rest.table, near=True)
    if isinstance(found, Missed):
        raise task.error(found, problem)
    return found


def past(curve: Equilibria, last: Point, task: Task) -> str:
    units, (name, value) = curve.problem.units, task.scene.control
    told = f"load {last.load * units.load:.10g} N/m"
    if task.scene.mean_pressure is not None and task.scene.period is not None:
        told += f", mean pressure {last.load * units.load / task.scene.period:.10g} Pa"
    if curve.problem.operator.has_approach:
        told += f", approach {-last.level * units.height:.10g} m"
    return f"{name} = {value:.6g} is past pull-off, which is at {told}: the surfaces come apart"


def _full(task: Task) -> Full:
    """Full contact under the scene's load."""
    scene = task.scene
    if scene.given_load is None or scene.period is None:
        raise OutOfRange("the surfaces close altogether, and in full contact the approach does not tell the load: give a load")
    if not task.operator.has_inverse:
        raise OutOfRange(no_inverse(task, "the surfaces close altogether"))
    if len(scene.profile.kinks) and np.any(scene.profile.kinks[:, 1] < 0):
        raise OutOfRange("the surfaces close altogether over valleys with kinks, where the pressure of full contact is infinite")
    return Full(scene.given_load / scene.period)


# frames ---------------------------------------------------------------------------------------------------------------
def frame(task: Task, intensity: float) -> ScaledScene:
    """The scaled problem: of a lone body about the contact that it has under no load, or more. intensity: with which its adhesion would
    act at the ends of zones."""
    scene = task.scene
    if scene.profile.period is not None:
        return scaled_scene(scene, task.single)
    zones = _typical(task, intensity).zones
    return scaled_scene_about(scene, 0.0, zones)


def _typical(task: Task, intensity: float) -> Solution:
    """A contact under the bare law about as wide as the adhesive one under no load, or under its load: the tension of adhesion,
    sqrt(pi E* w times the width in contact), is borne there by the profile."""
    scene = task.scene
    strength = math.pi * intensity
    size = scene.profile.resolution or _extent(task) or 1.0
    load = max(strength * math.sqrt(size), scene.given_load or 0.0)
    for _ in range(_SCALINGS):
        try:
            found = bare(task, load)
        except OutOfRange:
            load *= 1e-3
            continue
        last, load = load, max(strength * math.sqrt(float(np.sum(found.zone_widths))), scene.given_load or 0.0)
        if 0.5 < load / last < 2.0:
            break
    return found


def _extent(task: Task) -> float | None:
    extent = task.scene.profile.extent
    return None if extent is None else 0.1 * (extent[1] - extent[0])


def bare(task: Task, load: float | None = None) -> Solution:
    """The contact under the bare law, under the scene's control or a load."""
    scene = task.scene
    law = scene.law.bare
    assert law is not None
    alone = replace(scene, law=law) if load is None else replace(scene, law=law, mean_pressure=None, approach=None, load=load)
    with unwarned():
        try:
            return task.under(alone, _BARE, None, None)
        except NotConverged as failure:
            if failure.best is None or not failure.best.error < 1e-2:
                raise
            return failure.best  # type: ignore[no-any-return]


# starts ---------------------------------------------------------------------------------------------------------------
def _advanced(task: Task, scaled: ScaledScene, curve: Equilibria, value: float) -> Point:
    """The least equilibrium about first touch under a value of the control, not negative."""
    problem = scaled.problem
    table = _touched(scaled, curve) if value == 0.0 else _pressed(task, scaled)
    for _ in range(_ROUNDS):
        here = curve.advanced(table, value)
        new = _overlaps(problem, here)
        if len(new) == 0:
            return here
        table = _with(here.table, new)
    raise NotConverged("ever more zones begin under adhesion")


def _pressed(task: Task, scaled: ScaledScene) -> Array:
    """The zones under the bare law, in which all ends are driven outward."""
    found = bare(task)
    if len(found.zones) == 0:
        raise Closed
    return placed(scaled.problem, found.zones)


def _touched(scaled: ScaledScene, curve: Equilibria) -> Array:
    """Narrow zones about the lowest places."""
    problem, (lo, hi) = scaled.problem, scaled.cell
    period, profile = problem.period, problem.profile
    per_feature = 0.0 if profile.resolution is None else 8 * (hi - lo) / profile.resolution
    x = problem.units.scaled(np.linspace(lo, hi, int(np.clip(per_feature, 2049, 2**18))))
    kinks = problem.forcing.kinks[0]
    x = np.unique(np.concatenate((x, kinks[(kinks > x[0]) & (kinks < x[-1])])))
    f = problem.shape(x)
    least = f.min()
    low = np.flatnonzero((f[1:-1] <= f[:-2]) & (f[1:-1] <= f[2:])) + 1
    if period is not None and min(f[0], f[-1]) <= f[low].min(initial=np.inf):
        low = np.append(low, 0)
    step = float(np.diff(x).max())
    tips = []
    for i in low[f[low] - least <= 0.05 * np.ptp(f)]:
        around = np.linspace(x[i] - 2 * step, x[i] + 2 * step, 65)
        place, depth = maximum(lambda at: -problem.shape(np.asarray(at)), around)
        tips.append((float(place), -depth))
    lowest = min(depth for _, depth in tips)
    chosen = sorted(place for place, depth in tips if depth - lowest <= _TOGETHER * max(float(np.ptp(f)), 1.0))
    places = [p for k, p in enumerate(chosen) if k == 0 or p - chosen[k - 1] > step]
    if period is not None and len(places) > 1 and places[0] + period - places[-1] <= step:
        places = places[:-1]
    if problem.profile.symmetric and problem.units.origin == 0.0:
        places = [0.0 if abs(p) < 1e-6 * step else p for p in places]
    half = 0.25 * _TOUCH * (1.0 if period is None else min(period, step * 1e3))
    while True:
        table = np.array([[place - half, place + half] for place in places])
        if np.all(curve.at(table, 0.0).residual > 0.0) or half < 1e-12:
            return table
        half *= 0.1


def _overlaps(problem: Problem, here: Point) -> Array:
    """Where the surfaces would overlap."""
    zones = sie.Zones.of(here.table, problem.end, problem.end)
    state = sie.solve_zones(problem.equation(Load(here.load)), zones, 1e-12)
    return certify(ZoneFields(problem, state), here.load).overlaps


def _with(table: Array, overlaps: Array) -> Array:
    middle, half = overlaps.mean(axis=1), 0.5 * _NEW * np.diff(overlaps, axis=1)[:, 0]
    new = np.concatenate((table, np.column_stack((middle - half, middle + half))))
    return np.asarray(new[np.argsort(new[:, 0])])


def _greatest(curve: Equilibria, scaled: ScaledScene, value: float) -> Array:
    """A zone so wide that its ends are driven inward, and in wider ones still, as far as these feel the control as a body does: under an
    approach from a datum, zones much wider than that are lowered by a load."""
    lo, hi = scaled.problem.units.scaled(np.array(scaled.cell))
    middle, half = 0.5 * (lo + hi), 0.25 * (hi - lo)
    def driven_inward(half: float) -> bool:
        here = curve.at(np.array([[middle - half, middle + half]]), value)
        return bool(np.all((here.residual < 0.0) | (here.by_value < 0.0)))

    for _ in range(_WIDENINGS):
        table = np.array([[middle - half, middle + half]])
        if np.any(curve.at(table, value).by_value < 0.0):
            break
        if driven_inward(half) and all(driven_inward(half * wider) for wider in _WIDER):
            return table
        half *= _WIDEN
    raise OutOfRange("no zone is so wide that its ends recede: there is no greatest contact")


def _held_higher(curve: Equilibria, table: Array, value: float) -> Point:
    """An equilibrium under a larger value of the control, within zones from which it recedes."""
    unit = 1.0 / float(np.abs(curve.at(table, value).by_value).max())
    step = max(abs(value), unit)
    for _ in range(_WIDENINGS):
        value += step
        rest = curve.receded(table, value)
        if rest is not None:
            return rest
        step *= 2.0
    raise OutOfRange("the surfaces come apart under any control")
