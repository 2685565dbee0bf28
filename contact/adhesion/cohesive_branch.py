"""Contact under a law with a tension beside it: the branch that is asked for is followed by the
intervals where the gap is below its reach.

    advancing    from these intervals of the contact under the bare law, or of the surfaces as they touch; where the gap elsewhere comes
                 below the reach new intervals begin, and those that meet become one; under tension,
                 or below first touch, from there at no load back again
    receding     from one so wide that its ends are driven inward; with a period from tension everywhere

Tension everywhere moves no surface of a half-plane: that is the contact under the bare law at the
load with the tension added.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

import sie
from contact.adhesion.cohesive_certificate import FoundBeside, certified, rounded_load, uncertain
from contact.adhesion.cohesive_fields import PulledFields, PulledGapFields
from contact.adhesion.cohesive_flow import (
    TOO_NARROW,
    advanced,
    guide_down,
    guide_of,
    left_of_all,
    receded,
    settled,
)
from contact.adhesion.cohesive_pull_off import pull_off, pull_off_from_all
from contact.adhesion.cohesive_zone import Cohesive, CohesivePoint
from contact.adhesion.curve import Closed, Point
from contact.adhesion.deformed_profile import Pulled
from contact.adhesion.edge_branch import bare, frame, past, way
from contact.adhesion.full_contact import closing_foreseen
from contact.adhesion.gradient_flow import ROUGH
from contact.adhesion.inner_contact import TIGHT, Lost, edge_slopes
from contact.adhesion.intervals import below, sample_points, united_about
from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.tables import room_beside
from contact.model.scene import Scene
from contact.search.context import SceneCache, SolveContext
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import ScaledScene
from contact.search.strategies.full_contact import closed
from contact.search.strategies.gaps import by_gaps
from contact.search.strategies.guesses import Outcome
from contact.search.topology.failure import Failure
from contact.solution.assemble import mean_height
from contact.verify.certificate import certify
from contact.verify.error import SolvedZones
from sie import Array

# Tolerance of solutions under the bare law, from which the branch is followed.
_BARE = 1e-6
# Zones under the tension that was found: as tightly as they come to rest.
_TIGHT = (1e-13, 1e-11)
_LOOSE = 1e-9
# Rounding of ends over their zones.
_ROUNDED = 1e-15
# First zones over the intervals in which the surfaces touch.
_TOUCH = 1e-2
# Adhesion on a strip below this part of a zone is nearly without range; of the intensity it would
# have, and how far ends go for it.
_THIN = 0.02
_PART = 0.3
_FIRST = 0.3
# Zones under the bare law that a branch is followed from at the most.
_MOST_ZONES = 400
# Of a zone, the strips that are solved at the least; terms of a zone's pressure, times the root of
# its strips over it.
_NARROWEST = 5e-7
_MODES = 16.0
# Of the mean height of a profile: approaches above first touch.
_PARTS = (0.5, 0.2, 0.05, 0.01, 1e-3, 1e-4)
# Points at which the profile is looked at, and widenings of the window until the gap is above the
# reach at its border.
_LOOKS = 2049
_WINDOWS = 60
# The greatest contact is looked for in intervals ever wider by this, and is one that is driven
# inward, as those so many times as wide are.
_WIDENINGS = 120
_WIDEN = 1.25
_WIDER = (1.25, 1.5, 2.0, 3.0, 5.0, 8.0)


def followed_under_tension(context: SolveContext) -> Outcome:
    """The contact of the scene on the branch that the context asks for; OutOfRange past pull-off."""
    scene = context.scene
    work = scene.law.tension * scene.law.reach
    scaled = frame(context, math.sqrt(scene.E_star * work / math.pi))
    problem, held = scaled.problem, context.control(scaled.problem)
    curve, value = Cohesive(problem, held), held.value
    context.plan["branch"].detail = f"{context.branch}, {way(context)}"
    try:
        with context.plan.timed("zone ends"):
            if context.branch == "receding":
                rest = _greatest(context, scaled, curve, value)
            else:
                rest = _lowered(context, scaled, curve, value)
            if rest is not None:
                rest = settled(
                    curve, rest, -1.0 if context.branch == "receding" or value < 0.0 else 1.0
                )
    except Closed:
        return everywhere(context, problem)
    if rest is None:
        raise OutOfRange(past(curve, _pulled_off(context, scaled, curve), context))
    return solved(context, curve, rest)


def _greatest(
    context: SolveContext, scaled: ScaledScene, curve: Cohesive, value: float
) -> Point | None:
    """Receded under the value, or below first touch from where zones under tension everywhere are
    in contact, and then lowered to it.
    """
    if curve.problem.round is None:
        return _receded(context, scaled, curve, value)
    if curve.held.load is not None or value > 0.0:
        return _receded_from_all(context, curve, value)
    for part in _PARTS:
        above = part * mean_height(context.scene)
        higher = replace(context, scene=context.scene.under(context.scene.control[0], above))
        try:
            rest = _receded_from_all(higher, curve, above / curve.problem.units.height)
        except Closed:
            continue
        return None if rest is None else _lowered_to(curve, rest, value)
    return None


def _lowered(
    context: SolveContext, scaled: ScaledScene, curve: Cohesive, value: float
) -> Point | None:
    """Advanced under the value, or under none and then lowered to it."""
    try:
        start = advancing(context, scaled, curve, max(value, 0.0))
    except Closed:
        if value >= 0.0:
            raise
        return _greatest(context, scaled, curve, value)
    return start if value >= 0.0 else _lowered_to(curve, start, value)


def _lowered_to(curve: Cohesive, start: Point, value: float) -> Point | None:
    return receded(curve, start.table, value, guide_down(curve, len(start.contact), start.table))


def _pulled_off(context: SolveContext, scaled: ScaledScene, curve: Cohesive) -> Point:
    """Where a contact comes apart that has advanced under no load."""
    try:
        return pull_off(curve, advancing(context, scaled, curve, 0.0))
    except Closed:
        nothing = replace(context, scene=context.scene.under(context.scene.control[0], 0.0))
        zones = under_all(nothing, curve.problem)
        if zones is None:
            raise OutOfRange("the surfaces come apart from full contact") from None
        return pull_off_from_all(curve, zones, 0.0)


# starts
# ---------------------------------------------------------------------------------------------------------------
def advancing(
    context: SolveContext, scaled: ScaledScene, curve: Cohesive, value: float
) -> CohesivePoint:
    """The least equilibrium about first touch under a value of the control, not negative."""
    with closing_foreseen(context, curve, value):
        return _advanced_from_touch(context, scaled, curve, value)


def _advanced_from_touch(
    context: SolveContext, scaled: ScaledScene, curve: Cohesive, value: float
) -> CohesivePoint:
    problem = scaled.problem
    if value == 0.0:
        table, zones = _touched(scaled, curve)
        if problem.period is None:
            # A lone body is scaled by about what its contact is under no load.
            _refuse_narrow(context, problem.units.length)
    else:
        found = bare(context)
        if len(found.zones) == 0:
            raise Closed
        _refuse_many(len(found.zones))
        _refuse_narrow(context, float(found.zone_widths.max()))
        zones = curve.within(placed(problem, found.zones))
        fields, look = curve.contact_under(Pulled.of(problem, 0.0, np.zeros((0, 2))), value, zones)
        zones, round_ = fields.density.zones.table, problem.round
        look = _looked_on(curve, fields, look)
        near = below(zones, look, curve.reach, round_, corners=problem.corners)
        table = curve.within(united_about(near, curve.within(_begun(curve, fields)), round_))
        zones = curve.fitted(zones, table)
    return advanced(curve, table, value, guide_of(curve, len(zones), table), zones)


def _refuse_many(zones: int) -> None:
    if zones > _MOST_ZONES:
        raise OutOfRange(
            f"{zones} zones: under a tension beside the contact they are followed by steps that each take a matrix of all that is unknown "
            f"on them, which is done for {_MOST_ZONES} zones at the most: take a coarser trace, a part of it, or adhesion without range"
        )


def _refuse_narrow(context: SolveContext, width: float) -> None:
    """Where the tension would act on strips too narrow beside zones as wide as this [m]."""
    scene = context.scene
    strip = 0.25 * math.pi * scene.E_star * scene.law.reach / scene.law.tension
    if strip < _NARROWEST * width:
        part = max(strip / width, np.finfo(np.float64).tiny)
        raise NotConverged(
            f"{TOO_NARROW}. They are {strip:.2g} m beside {width:.2g} m, and the pressure, which bends within them, would take "
            f"{_MODES / math.sqrt(part):.1g} terms a zone: without range its ends differ by {part:.0e} of the zone"
        )


def _begun(curve: Cohesive, fields: ZoneFields) -> Array:
    """Zones whose ends have gone a part of the way that adhesion without range would drive them
    alone, where its tension would act on a narrow strip: from there on the strip is not too narrow
    to be told, and the ends are still driven outward.
    """
    problem, zones = curve.problem, fields.density.zones.table
    wanted = math.sqrt(2 * curve.stress * curve.reach / math.pi)
    strip, width = np.pi**2 / 4 * (wanted / curve.stress) ** 2, np.diff(zones, axis=1)
    slope = np.maximum(np.array(fields.density.edge_slopes).T, 1e-300)
    out = np.where(
        strip < _THIN * width,
        np.minimum(2 * _PART * wanted / slope, _FIRST * room_beside(zones, problem.round)),
        0.0,
    )
    return zones + np.column_stack((-out[:, 0], out[:, 1]))


def _looked_on(
    curve: Cohesive, fields: ZoneFields, look: tuple[Array, Array]
) -> tuple[Array, Array]:
    """The gap beside the zones of a lone body, as far as it comes to the reach: under a light load
    that is far from contact.
    """
    problem, (x, gap) = curve.problem, look
    if problem.round is not None or np.isfinite(problem.corners[0]):
        return look
    for _ in range(_WINDOWS):
        lo, hi = (
            max(problem.borders[0], 2 * x[0] - x[-1]),
            min(problem.borders[1], 2 * x[-1] - x[0]),
        )
        new = [
            sample_points(a, b, 0.25 * problem.detail)
            for a, b, at in ((lo, x[0], gap[0]), (x[-1], hi, gap[-1]))
            if at < curve.reach and a < b
        ]
        if not new:
            break
        x = np.concatenate((x, *new))
        order = np.argsort(x)
        x, gap = x[order], np.concatenate((gap, fields.formal_gap(np.concatenate(new))))[order]
    return x, gap


def _touched(scaled: ScaledScene, curve: Cohesive) -> tuple[Array, Array]:
    """(where the gap of the surfaces as they touch is below the reach, narrow zones about their
    lowest places).
    """
    problem, (lo, hi) = scaled.problem, scaled.problem.units.scaled(np.array(scaled.cell))
    profile, length, corners, round_ = (
        problem.profile,
        problem.units.length,
        problem.corners,
        problem.round,
    )
    border = problem.borders if round_ is None else (-math.inf, math.inf)
    if sharp := bool(np.isfinite(corners[0])):
        lo, hi = corners
    for _ in range(_WINDOWS):
        per_feature = (
            0.0 if profile.resolution is None else 8 * (hi - lo) * length / profile.resolution
        )
        x = np.linspace(lo, hi, int(np.clip(per_feature, _LOOKS, 2**18)))
        kinks = problem.forcing.kinks[0]
        x = np.unique(
            np.concatenate(
                (x, kinks[(kinks > lo) & (kinks < hi)], np.zeros(1) if lo < 0 < hi else np.zeros(0))
            )
        )
        f = problem.shape(x)
        f = f - f.min()
        if sharp or round_ is not None or (min(f[0], f[-1]) > curve.reach):
            break
        middle, half = 0.5 * (lo + hi), hi - lo
        lo, hi = max(middle - half, border[0]), min(middle + half, border[1])
    if round_ is not None:
        x, f = x[:-1], f[:-1]
        first = int(np.argmax(f))
        if f[first] <= curve.reach:
            raise Closed
        x = np.concatenate((x[first:], x[:first] + round_, [x[first] + round_]))
        f = np.concatenate((f[first:], f[: first + 1]))
    low = np.flatnonzero(f == 0.0)
    table = below(np.column_stack((x[low], x[low])), (x, f), curve.reach, None, corners=corners)
    places, zones = x[low], []
    for a, b in table:
        inner = places[(places >= a) & (places <= b)]
        if len(inner):
            away = [end - start for start, end in ((a, inner[0]), (inner[-1], b)) if end > start]
            half = 0.5 * _TOUCH * min([b - a, *(2 * one for one in away)])
            zones.append((inner[0] - half, inner[-1 if sharp else 0] + half))
    return curve.within(table), curve.within(np.array(zones))


def _receded(
    context: SolveContext, scaled: ScaledScene, curve: Cohesive, value: float
) -> Point | None:
    """From an interval about a lone body's least contact so wide that its ends are driven inward,
    and those of wider ones.
    """
    if np.isfinite(curve.problem.corners[0]):
        # All that lies between the corners.
        table = np.array([curve.problem.corners])
        curve.from_zones(
            table, max(value, 0.0), advancing(context, scaled, curve, max(value, 0.0)).zones, ROUGH
        )
        rest = receded(curve, table, max(value, 0.0))
        return rest if rest is None or value >= 0.0 else _lowered_to(curve, rest, value)
    here = advancing(context, scaled, curve, max(value, 0.0))
    middle, half = (
        0.5 * float(here.table[0, 0] + here.table[-1, 1]),
        0.5 * float(here.table[-1, 1] - here.table[0, 0]),
    )

    def inward(half: float) -> bool:
        at = curve.at(np.array([[middle - half, middle + half]]), max(value, 0.0))
        return bool(np.all((at.residual < 0.0) | (at.by_value < 0.0)))

    for _ in range(_WIDENINGS):
        half *= _WIDEN
        if inward(half) and all(inward(half * wider) for wider in _WIDER):
            table = np.array([[middle - half, middle + half]])
            rest = receded(curve, table, max(value, 0.0), guide_of(curve, len(here.contact), table))
            return rest if rest is None or value >= 0.0 else _lowered_to(curve, rest, value)
    raise OutOfRange(
        "no interval of tension is so wide that its ends recede: there is no greatest contact"
    )


def _receded_from_all(context: SolveContext, curve: Cohesive, value: float) -> Point | None:
    """From tension everywhere in a period; Closed where the gap stays below its reach, None where
    nothing is left.
    """
    problem = curve.problem
    try:
        zones = under_all(context, problem)
        if zones is None:
            raise Closed
        fields, look = curve.contact_under(curve.everywhere, value, zones)
    except Lost:
        return None
    zones = fields.density.zones.table
    try:
        table = left_of_all(curve, value, zones, look)
    except Lost:
        return None
    return receded(curve, table, value, guide_of(curve, len(zones), table))


def under_all(context: SolveContext, problem: Problem) -> Array | None:
    """Scaled zones under tension everywhere; None in full contact; Lost where there are none."""
    scene, period = context.scene, context.scene.period
    assert period is not None
    if scene.given_load is not None and scene.given_load + scene.law.tension * period <= 0.0:
        raise Lost
    scene = _bare_scene(context, problem)
    if scene.approach is not None and scene.approach <= 0.0:
        raise Lost
    found = context.solve_scene(scene, _BARE)
    return placed(problem, found.zones) if len(found.zones) else None


def _bare_scene(context: SolveContext, problem: Problem) -> Scene:
    """The scene with the tension everywhere put into its control, under the bare law."""
    scene, period = context.scene, context.scene.period
    assert period is not None and scene.law.bare is not None
    stress = scene.law.tension
    if scene.given_load is not None:
        return replace(
            scene, law=scene.law.bare, mean_pressure=None, load=scene.given_load + stress * period
        )
    sunk = problem.compression * stress / problem.units.pressure * problem.units.height
    assert scene.approach is not None
    return replace(scene, law=scene.law.bare, approach=scene.approach + sunk)


# what was found
# -------------------------------------------------------------------------------------------------------
def solved(context: SolveContext, curve: Cohesive, here: Point) -> SolvedZones:
    """The equilibrium as tightly as there is."""
    assert isinstance(here, CohesivePoint)
    problem = curve.problem
    pulled = Pulled.of(problem, curve.stress, here.table).over(here.zones)
    at_load = here
    if curve.held.load is None:
        at_load = Cohesive(problem, Load(0.0)).from_zones(here.table, here.load, here.zones)
    fields, free, control = _tight(context, pulled, at_load.load + pulled.pulling.total, here.zones)
    certificate = certify(ZoneFields(pulled, fields.state), control.load)
    whole = replace(fields, law_problem=problem, rate=at_load.rate)
    return FoundBeside(
        free,
        whole,
        certified(certificate, curve, here),
        1,
        control,
        context.tolerance,
        beside=uncertain(curve, here, fields),
    )


def _tight(
    context: SolveContext, pulled: Pulled, load: float, zones: Array
) -> tuple[PulledFields, sie.Free, Load]:
    """load: of q."""
    if pulled.pulling.spread != (None, None):
        return _tight_at_corners(pulled, load - pulled.pulling.total, zones)
    control = Load(load)
    kinds = whole(pulled, zones)
    free = next(
        (
            found
            for tolerance in _TIGHT
            if (found := sie.find_ends(pulled.equation(control), kinds, tolerance)).converged
        ),
        None,
    ) or sie.find_ends(pulled.equation(control), kinds, _LOOSE)
    if not free.converged:
        raise context.error(
            Failure(f"under the tension that was found {free.reason}", free), pulled
        )
    return PulledFields(pulled, free.state), free, control


def _tight_at_corners(
    pulled: Pulled, load: float, zones: Array
) -> tuple[PulledFields, sie.Free, Load]:
    """The same where a tension is spread over zones, and goes with their free ends. load: the given
    one.
    """
    before = np.inf
    while True:
        pulled = pulled.over(zones)
        control = Load(load + pulled.pulling.total)
        state = sie.solve_fixed(pulled.equation(control), whole(pulled, zones), TIGHT)
        free = state.density.zones.moves
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(
                free, 2 * np.array(state.density.intensities) / edge_slopes(pulled, state), 0.0
            )
        off = np.abs(step).T / np.diff(zones, axis=1)
        if not off.max() < 0.5 * before or before < _ROUNDED:
            off += _ROUNDED * free.T
            found = sie.Free(
                state, True, off, off, (), None, stable=True, reason="the ends are at rest"
            )
            return PulledFields(pulled, state), found, control
        zones, before = zones + np.column_stack((-step[0], step[1])), float(off.max())


def whole(pulled: Pulled, zones: Array) -> sie.Zones:
    """Zones that are all solved for, with the kinds of their ends."""
    left, right = (
        [sie.SINGULAR if place == corner else pulled.end for place in ends]
        for ends, corner in zip(zones.T, pulled.corners, strict=True)
    )
    return sie.Zones.of(zones, left, right)


def everywhere(context: SolveContext, problem: Problem) -> Outcome:
    """Tension in all of a period: the contact under the bare law, less the tension."""
    scene = _bare_scene(context, problem)
    alone = replace(context, scene=scene, cache=SceneCache(scene))
    found = alone.solve_scene(scene, _BARE)
    stress = context.scene.law.tension
    pulled = Pulled.of(problem, stress / problem.units.pressure, np.zeros((0, 2)), everywhere=True)
    if len(found.zones) == 0:
        return closed(context)
    zones = placed(problem, found.zones)
    load = found.load / problem.units.load
    plain = replace(problem, law=scene.law)
    if isinstance(found.fields, GapFields):
        gapped = by_gaps(alone, plain, Load(load), float(np.diff(zones, axis=1).sum()), zones)
        if isinstance(gapped, Failure):
            raise context.error(gapped, plain)
        here = gapped.fields
        lowered = PulledGapFields(
            here.problem, here.state, here.mean, here.relief, stress / problem.units.pressure
        )
        return replace(gapped, fields=lowered)
    fields, free, control = _tight(context, pulled, load, zones)
    certificate = certify(ZoneFields(pulled, fields.state), control.load)
    curve = Cohesive(problem, Load(0.0))
    fields = replace(fields, law_problem=problem)
    beside = 0.0 if context.scene.given_load is None else rounded_load(fields)
    return FoundBeside(
        free,
        fields,
        certified(certificate, curve, None, fields),
        1,
        control,
        context.tolerance,
        beside=beside,
    )
