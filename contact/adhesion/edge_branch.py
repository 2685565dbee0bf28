"""Contact under a law with several equilibria: the branch that is asked for is followed, from first
touch or from the greatest contact.

    advancing    from the zones of the bare law, which lie within it, or from first touch: ends advance under the control held, new
                 zones begin where the surfaces would overlap, zones that meet become one; under
                 tension, or below first touch, from there at no load back again
    receding     from a zone as wide as it takes to be driven inward; with a period full contact, which stays closed

Whatever is closed stays closed: an opening without width has no intensity. So there are no new gaps
within zones.
"""

import math
from dataclasses import replace

import numpy as np

from contact.adhesion.curve import Equilibria, Point
from contact.adhesion.events import Following, Jump, Standing, followed_by_approach
from contact.adhesion.full_contact import closing_foreseen
from contact.adhesion.gradient_flow import Closed, receded
from contact.adhesion.loading_path import History
from contact.adhesion.nucleation import grown, touched
from contact.adhesion.pull_off import pull_off
from contact.errors import NotConverged, OutOfRange, unwarned
from contact.model.scene import Scene
from contact.search.context import SolveContext
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import ScaledScene, scaled_scene, scaled_scene_about
from contact.search.strategies import full_contact
from contact.search.strategies.guesses import Outcome
from contact.search.topology.failure import Failure
from contact.solution.solution import Solution
from sie import Array

# Tolerance of solutions under the bare law, from which the branch is followed.
_BARE = 1e-6
_SCALINGS = 6
_WIDENINGS = 120
# The greatest contact is looked for in zones ever wider by this, and is one that is driven inward,
# as those so many times as wide are.
_WIDEN = 1.25
_WIDER = (1.25, 1.5, 2.0, 3.0, 5.0, 8.0)
# How much farther a control is raised than it takes to hold all ends at sharp corners.
_ABOVE = 1.0 + 1e-6


def followed(context: SolveContext) -> Outcome:
    """The contact of the scene on the branch that the context asks for; OutOfRange past pull-off."""
    scene, told = context.scene, context.plan["branch"]
    told.detail = f"{context.branch}, {way(context)}"
    if context.branch == "receding" and _closes(scene):
        return closed(context)
    scaled, curve = to_follow(context)
    problem, control = curve.problem, curve.held
    rest: Point | None
    try:
        with context.plan.timed("zone ends"):
            if followed_by_approach(curve):
                rest = _lowered(context, scaled, curve)
            elif context.branch == "receding":
                last = _greatest(curve, scaled, control.value)
                rest = receded(curve, last, control.value)
                start = None if rest is not None else _held_higher(curve, last, control.value)
            else:
                start = advancing(context, scaled, curve, max(control.value, 0.0))
                rest = start if control.value >= 0.0 else receded(curve, start.table, control.value)
    except Closed:
        return closed(context)
    if rest is None:
        assert start is not None
        raise OutOfRange(past(curve, pull_off(curve, start), context))
    found = context.refine_topology(
        problem, control, curve.settled(rest).table, abandon_if_far=True
    )
    if isinstance(found, Failure):
        raise context.error(found, problem)
    return found


def way(context: SolveContext) -> str:
    """How the contact is come by, in words."""
    scene = context.scene
    if context.branch == "receding":
        return (
            "lowered from full contact" if _closes(scene) else "lowered from the greatest contact"
        )
    if scene.control[1] > 0.0:
        assert scene.law.bare is not None
        return f"raised from the {scene.law.bare.name} contact, which lies within it"
    return "raised from first touch" + (
        " to no load, then lowered" if scene.control[1] < 0.0 else ""
    )


def _closes(scene: Scene) -> bool:
    """Whether the greatest contact is that of a whole period; beyond sharp corners nothing touches."""
    return scene.period is not None and scene.profile.support is None


def past(curve: Equilibria, last: Point, context: SolveContext) -> str:
    units, (name, value) = curve.problem.units, context.scene.control
    told = f"load {last.load * units.load:.10g} N/m"
    if context.scene.mean_pressure is not None and context.scene.period is not None:
        told += f", mean pressure {last.load * units.load / context.scene.period:.10g} Pa"
    if curve.problem.operator.has_approach:
        told += f", approach {-last.level * units.height:.10g} m"
    return f"{name} = {value:.6g} is past pull-off, which is at {told}: the surfaces come apart"


def closed(context: SolveContext) -> full_contact.Full:
    """Full contact that adhesion without range has brought about."""
    scene = context.scene
    found = full_contact.closed(context)
    if not context.operator.has_inverse:
        raise OutOfRange(full_contact.no_inverse(context, "the surfaces close altogether"))
    if len(scene.profile.kinks) and np.any(scene.profile.kinks[:, 1] < 0):
        raise OutOfRange(
            "the surfaces close altogether over valleys with kinks, where the pressure of full contact is infinite"
        )
    return found


def to_follow(context: SolveContext) -> tuple[ScaledScene, Equilibria]:
    """The scaled scene, and its equilibria under its control."""
    scaled = frame(context, abs(context.scene.law.intensity(context.scene.E_star)))
    return scaled, Equilibria(scaled.problem, context.control(scaled.problem))


# frames
# ---------------------------------------------------------------------------------------------------------------
def frame(context: SolveContext, intensity: float) -> ScaledScene:
    """The scaled problem: of a lone body about the contact that it has under no load, or more.
    intensity: with which its adhesion would act at the ends of zones.
    """
    scene = context.scene
    if scene.profile.period is not None or scene.profile.support is not None:
        return scaled_scene(scene, context.single)
    zones = _typical(context, intensity).zones
    return scaled_scene_about(scene, 0.0, zones)


def _typical(context: SolveContext, intensity: float) -> Solution:
    """A contact under the bare law about as wide as the adhesive one under no load, or under its
    load: the tension of adhesion, sqrt(pi E* w times the width in contact), is borne there by the
    profile.
    """
    scene = context.scene
    strength = math.pi * intensity
    extent = scene.profile.extent
    size = scene.profile.resolution or (1.0 if extent is None else 0.1 * (extent[1] - extent[0]))
    load = max(strength * math.sqrt(size), scene.given_load or 0.0)
    found: Solution | None = None
    failure: OutOfRange | None = None
    for _ in range(_SCALINGS):
        try:
            found = bare(context, load)
        except OutOfRange as refused:
            load, failure = 1e-3 * load, refused
            continue
        last, load = (
            load,
            max(strength * math.sqrt(float(np.sum(found.zone_widths))), scene.given_load or 0.0),
        )
        if 0.5 < load / last < 2.0:
            break
    if found is None:
        assert failure is not None
        raise failure
    return found


def bare(context: SolveContext, load: float | None = None) -> Solution:
    """The contact under the bare law, under the scene's control or a load."""
    scene = context.scene
    law = scene.law.bare
    assert law is not None
    alone = (
        replace(scene, law=law)
        if load is None
        else replace(scene, law=law, mean_pressure=None, approach=None, load=load)
    )
    with unwarned():
        try:
            return context.solve_scene(alone, _BARE)
        except NotConverged as failure:
            if failure.best is None or not failure.best.error < 1e-2:
                raise
            return failure.best  # type: ignore[no-any-return]


# starts
# ---------------------------------------------------------------------------------------------------------------
def advancing(context: SolveContext, scaled: ScaledScene, curve: Equilibria, value: float) -> Point:
    """The least equilibrium about first touch under a value of the control, not negative."""
    with closing_foreseen(context, curve, value):
        table = touched(curve, scaled.cell) if value == 0.0 else _pressed(context, scaled)
        return grown(curve, table, value)


def _pressed(context: SolveContext, scaled: ScaledScene) -> Array:
    """The zones under the bare law, in which all ends are driven outward."""
    found = bare(context)
    if len(found.zones) == 0:
        raise Closed
    return placed(scaled.problem, found.zones)


def _greatest(curve: Equilibria, scaled: ScaledScene, value: float) -> Array:
    """A zone so wide that its ends are driven inward, and in wider ones still, as far as these feel
    the control as a body does: under an approach from a datum, zones much wider than that are
    lowered by a load. Between sharp corners it is all that lies there.
    """
    if curve.problem.profile.support is not None:
        return np.array([curve.problem.corners])
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


def _lowered(context: SolveContext, scaled: ScaledScene, curve: Equilibria) -> Point:
    """Under a held approach, where ends that recede may drive others on: followed from where the
    branch begins through all jumps.
    """
    value = curve.held.value
    if context.branch == "receding":
        here = curve.at(_greatest(curve, scaled, value), value)
        # Under so large a value all ends are held at the corners.
        slack = here.whole.residual / here.whole.by_value
        here = curve.at(here.table, value - min(0.0, float(slack.min()) * _ABOVE))
    else:
        here = advancing(context, scaled, curve, max(value, 0.0))
    last: Point | None = None
    for found in History(Following(curve, scaled.cell)).to(Standing(here.value, here), value):
        if isinstance(found, Jump):
            last = found.before.point
        elif found.point is not None:
            return found.point
        elif found.closed:
            raise Closed
    assert last is not None
    raise OutOfRange(past(curve, last, context))


def _held_higher(curve: Equilibria, table: Array, value: float) -> Point:
    """An equilibrium under a larger value of the control, within zones from which it recedes."""
    step = max(abs(value), curve.unit(curve.at(table, value)))
    for _ in range(_WIDENINGS):
        value += step
        rest = receded(curve, table, value)
        if rest is not None:
            return rest
        step *= 2.0
    raise OutOfRange("the surfaces come apart under any control")
