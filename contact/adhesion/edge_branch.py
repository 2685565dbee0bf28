"""Branches of contacts under adhesion without range (JKR): advancing and receding.

    advancing    starts from the zones without adhesion, which lie inside the contact, or from first
                 touch: ends advance under the fixed control, zones begin where the surfaces would
                 overlap, zones that meet merge. Under a negative load, or below first touch, the
                 contact first advances under no load, and recedes from there
    receding     starts from a zone so wide that its ends are driven inward; with a period, it is
                 the full contact, which stays closed

No new gap begins inside a zone: an opening of zero width has no edge intensity to drive it.
"""

import math
from dataclasses import replace

import numpy as np

from contact.adhesion.curve import ACCURACY, Curve, State
from contact.adhesion.events import Events, Jump, PathState, moves_both_ways
from contact.adhesion.full_contact import closing_foreseen
from contact.adhesion.gradient_flow import Closed, receded
from contact.adhesion.loading_path import LoadingPath
from contact.adhesion.nucleation import grown, touched
from contact.adhesion.options import LIMITS, MOVES
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


def followed(context: SolveContext) -> Outcome:
    """The contact of the scene, on the branch of solutions that the context names.

    Raises OutOfRange past pull-off.
    """
    scene = context.scene
    context.plan["branch"].detail = f"{context.branch}, {described_way(context)}"
    if context.branch == "receding" and _closes(scene):
        return full_by_jkr(context)
    scaled, curve = curve_of(context)
    problem, control = curve.problem, curve.control
    rest: State | None
    try:
        with context.plan.timed("zone ends"):
            if moves_both_ways(curve):
                rest = _followed_by_approach(context, scaled, curve)
            elif context.branch == "receding":
                last = _widest_zone(curve, scaled, control.value)
                rest = receded(curve, last, control.value)
                start = None if rest is not None else _held_higher(curve, last, control.value)
            else:
                start = advancing(context, scaled, curve, max(control.value, 0.0))
                rest = start if control.value >= 0.0 else receded(curve, start.table, control.value)
    except Closed:
        return full_by_jkr(context)
    if rest is None:
        assert start is not None
        raise OutOfRange(past_pull_off(curve, pull_off(curve, start), context))
    found = context.refine_topology(
        problem, control, curve.settled(rest).table, abandon_if_far=True
    )
    if isinstance(found, Failure):
        raise context.error(found, problem)
    return found


def described_way(context: SolveContext) -> str:
    """Text for the plan that says by which path of loading the contact is reached."""
    scene = context.scene
    if context.branch == "receding":
        return "lowered from full contact" if _closes(scene) else "lowered from the largest contact"
    if scene.control[1] > 0.0:
        assert scene.law.bare is not None
        return f"grown from the smaller zones of the {scene.law.bare.name} contact"
    return "grown from first touch at the control value 0" + (
        ", then lowered" if scene.control[1] < 0.0 else ""
    )


def _closes(scene: Scene) -> bool:
    """Whether contact can fill a period: there is a period, and no sharp corner prevents it."""
    return scene.period is not None and scene.profile.support is None


def past_pull_off(curve: Curve, last: State, context: SolveContext) -> str:
    """The error message for a control past pull-off."""
    units, (name, value) = curve.problem.units, context.scene.control
    text = f"load {last.load * units.load:.10g} N/m"
    if context.scene.mean_pressure is not None and context.scene.period is not None:
        text += f", mean pressure {last.load * units.load / context.scene.period:.10g} Pa"
    if curve.problem.operator.has_approach:
        text += f", approach {-last.level * units.height:.10g} m"
    return f"{name} = {value:.6g} is past pull-off, which is at {text}: the surfaces come apart"


def full_by_jkr(context: SolveContext) -> full_contact.Full:
    """The full contact into which adhesion without range (JKR) has closed the surfaces."""
    scene = context.scene
    found = full_contact.full_by_adhesion(context)
    if not context.operator.has_inverse:
        raise OutOfRange(full_contact.no_inverse(context, "adhesion closes all gaps"))
    if len(scene.profile.kinks) and np.any(scene.profile.kinks[:, 1] < 0):
        raise OutOfRange(
            "adhesion closes all gaps, but the full contact cannot be solved: its pressure is "
            "infinite at the kinks of the valleys. Round the valleys, or use less adhesion"
        )
    return found


def curve_of(context: SolveContext) -> tuple[ScaledScene, Curve]:
    """(the scaled scene, the curve of equilibria under its control)."""
    scaled = branch_scaling(context, abs(context.scene.law.intensity(context.scene.E_star)))
    return scaled, Curve(scaled.problem, context.control(scaled.problem))


def branch_scaling(context: SolveContext, intensity: float) -> ScaledScene:
    """The scaled scene; without period or corners, a typical contact's width is the length unit.

    The typical contact (`_typical`) has no adhesion, and a load that stands for the adhesion.
    intensity: edge intensity, in absolute value, that the adhesion prescribes at ends of zones.
    """
    scene = context.scene
    if scene.profile.period is not None or scene.profile.support is not None:
        return scaled_scene(scene, context.single)
    zones = _typical(context, intensity).zones
    return scaled_scene_about(scene, 0.0, zones)


def _typical(context: SolveContext, intensity: float) -> Solution:
    """A contact without adhesion (law `bare`), about as wide as the adhesive contact.

    It is under a load of the size of the adhesive force, sqrt(pi E* w b), with the work of adhesion
    w and the width b in contact.
    """
    scene = context.scene
    strength = math.pi * intensity
    extent = scene.profile.extent
    size = scene.profile.resolution or (1.0 if extent is None else 0.1 * (extent[1] - extent[0]))
    load = max(strength * math.sqrt(size), scene.given_load or 0.0)
    found: Solution | None = None
    failure: OutOfRange | None = None
    for _ in range(LIMITS.patience):
        try:
            found = start_contact(context, load)
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


def start_contact(context: SolveContext, load: float | None = None) -> Solution:
    """The contact without adhesion (law `bare`), at the scene's control or a given load."""
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
            return context.solve_scene(alone, ACCURACY.resting_step)
        except NotConverged as failure:
            if failure.best is None or not failure.best.error < 1e-2:
                raise
            return failure.best  # type: ignore[no-any-return]


def advancing(context: SolveContext, scaled: ScaledScene, curve: Curve, value: float) -> State:
    """The equilibrium reached as zones grow from first touch, or from zones without adhesion.

    Of all equilibria whose zones contain the start, it has the smallest zones. value: value of the
    control. The start is first touch if `value` is 0, and the zones without adhesion above 0.
    """
    with closing_foreseen(context, curve, value):
        table = (
            touched(curve, scaled.cell)
            if value == 0.0
            else _zones_without_adhesion(context, scaled)
        )
        return grown(curve, table, value)


def _zones_without_adhesion(context: SolveContext, scaled: ScaledScene) -> Array:
    """Scaled zones of the contact without adhesion; adhesion drives all their ends outward."""
    found = start_contact(context)
    if len(found.zones) == 0:
        raise Closed
    return placed(scaled.problem, found.zones)


def _widest_zone(curve: Curve, scaled: ScaledScene, value: float) -> Array:
    """A zone so wide that its ends, and the ends of wider zones, tend to recede.

    If the approach is the control, and is measured from a datum, a load on a zone much wider than
    the distance of the datum lowers the approach. At such a zone the search gives up and raises
    OutOfRange. Between sharp corners the zone is the whole interval.
    """
    if curve.problem.profile.support is not None:
        return np.array([curve.problem.corners])
    lo, hi = scaled.problem.units.scaled(np.array(scaled.cell))
    middle, half = 0.5 * (lo + hi), 0.25 * (hi - lo)

    for _ in range(LIMITS.max_iterations):
        table = np.array([[middle - half, middle + half]])
        if np.any(curve.at(table, value).by_value < 0.0):
            break
        if driven_inward(curve, middle, half, value):
            return table
        half *= MOVES.widening
    raise OutOfRange(
        'branch="receding" starts from the largest contact, but none was found: no zone was so '
        'wide that all its ends recede. Use branch="advancing"'
    )


def driven_inward(curve: Curve, middle: float, half: float, value: float) -> bool:
    """Whether the ends of intervals with 1, 2, 4 and 8 times the half width `half` recede.

    All four intervals are tested, because the ends of a wider interval may advance again. An end
    whose residual falls as the control rises counts as receding.
    """
    for doublings in range(LIMITS.patience):
        width = half * 2**doublings
        here = curve.at(np.array([[middle - width, middle + width]]), value)
        if not np.all((here.residual < 0.0) | (here.by_value < 0.0)):
            return False
    return True


def _followed_by_approach(context: SolveContext, scaled: ScaledScene, curve: Curve) -> State:
    """The contact under a fixed approach, where ends that recede may make other ends advance.

    The contact is followed from the start of the branch, through all jumps.
    """
    value = curve.control.value
    if context.branch == "receding":
        here = curve.at(_widest_zone(curve, scaled, value), value)
        # The control value is raised until no end tends to recede, so that all ends are pinned at
        # the corners.
        slack = here.whole.residual / here.whole.by_value
        here = curve.at(
            here.table, value - min(0.0, float(slack.min()) * (1.0 + ACCURACY.resting_step))
        )
    else:
        here = advancing(context, scaled, curve, max(value, 0.0))
    last: State | None = None
    for found in LoadingPath(Events(curve, scaled.cell)).to(PathState(here.value, here), value):
        if isinstance(found, Jump):
            last = found.before.point
        elif found.point is not None:
            return found.point
        elif found.closed:
            raise Closed
    assert last is not None
    raise OutOfRange(past_pull_off(curve, last, context))


def _held_higher(curve: Curve, table: Array, value: float) -> State:
    """An equilibrium at a control above `value`; its ends have receded from zones `table`."""
    step = max(abs(value), curve.unit(curve.at(table, value)))
    for _ in range(LIMITS.max_iterations):
        value += step
        rest = receded(curve, table, value)
        if rest is not None:
            return rest
        step *= 2.0
    raise OutOfRange("the surfaces separate at every value of the control that was tried")
