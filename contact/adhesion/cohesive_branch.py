"""Branches of contacts under a tension of finite range (Dugdale).

The unknown intervals are those where the gap is below the reach of the tension.

    advancing    starts from the intervals of the contact without adhesion, or of the surfaces at
                 first touch: new intervals begin where the gap falls below the reach, and intervals
                 that meet merge. Under a negative load, or below first touch, the contact first
                 advances under no load, and recedes from there
    receding     starts from an interval so wide that its ends are driven inward, or, with a period,
                 from tension everywhere

A uniform tension everywhere does not deform a half-plane. So the contact under it is a contact
without adhesion, whose load is larger by the force of the tension.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

import sie
from contact.adhesion.cohesive_certificate import (
    SolvedCohesive,
    certified,
    certified_everywhere,
    end_error,
    rounded_load,
)
from contact.adhesion.cohesive_fields import CohesiveFields, CohesiveGapFields
from contact.adhesion.cohesive_flow import (
    TOO_NARROW,
    advanced,
    guide_down,
    guide_of,
    intervals_left,
    receded,
    settled,
)
from contact.adhesion.cohesive_pull_off import pull_off, pull_off_from_all
from contact.adhesion.cohesive_state import CohesiveState
from contact.adhesion.cohesive_zone import OPTIONS, CohesiveCurve
from contact.adhesion.curve import ACCURACY, Closed, State
from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.edge_branch import (
    branch_scaling,
    described_way,
    driven_inward,
    past_pull_off,
    start_contact,
)
from contact.adhesion.full_contact import closing_foreseen
from contact.adhesion.inner_contact import ContactLost, edge_slopes
from contact.adhesion.intervals import below, sample_points, united_about
from contact.adhesion.options import LIMITS, MOVES, SAMPLES
from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.tables import room_beside
from contact.model.profiles.noise import EPS
from contact.model.scene import Scene
from contact.model.units import quantity
from contact.search.context import SceneCache, SolveContext
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import ScaledScene
from contact.search.strategies.full_contact import full_by_adhesion
from contact.search.strategies.gaps import by_gaps, record_as_before
from contact.search.strategies.guesses import Outcome
from contact.search.topology.failure import Failure
from contact.solution.assemble import mean_height
from contact.verify.certificate import certify
from contact.verify.error import SolvedZones
from sie import Array


def followed_under_tension(context: SolveContext) -> Outcome:
    """The contact of the scene, on the branch of solutions that the context names.

    Raises OutOfRange past pull-off.
    """
    scene = context.scene
    work = scene.law.tension * scene.law.reach
    scaled = branch_scaling(context, math.sqrt(scene.E_star * work / math.pi))
    problem, control = scaled.problem, context.control(scaled.problem)
    curve, value = CohesiveCurve(problem, control), control.value
    context.plan["branch"].detail = f"{context.branch}, {described_way(context)}"
    try:
        with context.plan.timed("zone ends"):
            if context.branch == "receding":
                rest = _receding_contact(context, scaled, curve, value)
            else:
                rest = _advanced_contact(context, scaled, curve, value)
            if rest is not None:
                rest = settled(
                    curve, rest, -1.0 if context.branch == "receding" or value < 0.0 else 1.0
                )
    except Closed:
        return everywhere(context, problem)
    if rest is None:
        raise OutOfRange(past_pull_off(curve, _pulled_off(context, scaled, curve), context))
    return solved(context, curve, rest)


def _receding_contact(
    context: SolveContext, scaled: ScaledScene, curve: CohesiveCurve, value: float
) -> State | None:
    """The contact on the receding branch (reached from a larger contact) at a control value.

    Below the first touch of a periodic profile, a contact is first found at a positive approach:
    the first of several falling trial values at which the tension does not act everywhere. From
    there the approach is lowered.
    """
    if curve.problem.round is None:
        return _receded(context, scaled, curve, value)
    if curve.control.load is not None or value > 0.0:
        return _receded_from_all(context, curve, value)
    above = mean = mean_height(context.scene)
    while above > ACCURACY.coarse * mean:
        above *= MOVES.least_part
        higher = replace(context, scene=context.scene.under(context.scene.control[0], above))
        try:
            rest = _receded_from_all(higher, curve, above / curve.problem.units.height)
        except Closed:
            continue
        return None if rest is None else _lowered_to(curve, rest, value)
    return None


def _advanced_contact(
    context: SolveContext, scaled: ScaledScene, curve: CohesiveCurve, value: float
) -> State | None:
    """The contact whose ends have advanced to equilibrium at the control value `value`.
    If `value` < 0, they advance at the control value 0, and recede from there to `value`.
    """
    try:
        start = advancing(context, scaled, curve, max(value, 0.0))
    except Closed:
        if value >= 0.0:
            raise
        return _receding_contact(context, scaled, curve, value)
    return start if value >= 0.0 else _lowered_to(curve, start, value)


def _lowered_to(curve: CohesiveCurve, start: State, value: float) -> State | None:
    return receded(curve, start.table, value, guide_down(curve, len(start.contact), start.table))


def _pulled_off(context: SolveContext, scaled: ScaledScene, curve: CohesiveCurve) -> State:
    """The equilibrium at pull-off of a contact that has advanced at the control value 0."""
    try:
        return pull_off(curve, advancing(context, scaled, curve, 0.0))
    except Closed:
        nothing = replace(context, scene=context.scene.under(context.scene.control[0], 0.0))
        zones = under_all(nothing, curve.problem)
        if zones is None:
            raise OutOfRange(
                "the surfaces come apart before the given control is reached; their pull-off is "
                "not computed, since the contact is full at the control value 0"
            ) from None
        return pull_off_from_all(curve, zones, 0.0)


def advancing(
    context: SolveContext, scaled: ScaledScene, curve: CohesiveCurve, value: float
) -> CohesiveState:
    """The smallest contact in equilibrium that contains the point of first touch.

    value: value of the control, not negative.
    """
    with closing_foreseen(context, curve, value):
        return _advanced_from_touch(context, scaled, curve, value)


def _advanced_from_touch(
    context: SolveContext, scaled: ScaledScene, curve: CohesiveCurve, value: float
) -> CohesiveState:
    """The equilibrium that `advancing` returns, found by following the ends of intervals."""
    problem = scaled.problem
    if value == 0.0:
        table, zones = _touch_intervals(scaled, curve)
        if problem.period is None:
            # If `value` is 0 and there is no period, the contact is about as wide as the unit of
            # length.
            _refuse_narrow(context, problem.units.length)
    else:
        found = start_contact(context)
        if len(found.zones) == 0:
            raise Closed
        _refuse_many(len(found.zones))
        _refuse_narrow(context, float(found.zone_widths.max()))
        zones = curve.within(placed(problem, found.zones))
        fields, gap_samples = curve.contact_under(
            TractionLoaded.of(problem, 0.0, np.zeros((0, 2))), value, zones
        )
        zones, round_ = fields.density.zones.table, problem.round
        gap_samples = _sampled_farther(curve, fields, gap_samples)
        intervals = below(zones, gap_samples, curve.reach, round_, corners=problem.corners)
        table = curve.within(
            united_about(intervals, curve.within(_moved_outward(curve, fields)), round_)
        )
        zones = curve.fitted(zones, table)
    return advanced(curve, table, value, guide_of(curve, len(zones), table), zones)


def _refuse_many(zones: int) -> None:
    if zones > OPTIONS.max_zones:
        raise OutOfRange(
            f"without adhesion the contact has {zones} zones, but a tension of finite range is "
            f"solved for at most {OPTIONS.max_zones} zones: use a smoother or shorter profile, or "
            "JKR instead of Dugdale's law"
        )


def _refuse_narrow(context: SolveContext, width: float) -> None:
    """Raise NotConverged if strips of tension are too narrow next to a zone of this width [m]."""
    scene = context.scene
    strip = 0.25 * math.pi * scene.E_star * scene.law.reach / scene.law.tension
    if strip < OPTIONS.narrowest_strip * width:
        part = max(strip / width, np.finfo(np.float64).tiny)
        raise NotConverged(
            f"{TOO_NARROW}. The strips are {quantity(strip, 'm', 2)} wide beside a zone of "
            f"{quantity(width, 'm', 2)}: under JKR's law the ends of the zone differ by "
            f"{part:.0e} of its width"
        )


def _moved_outward(curve: CohesiveCurve, fields: ZoneFields) -> Array:
    """The zones of `fields`, with ends next to very narrow strips of tension moved outward.

    `fields` have no tension and no edge intensity. The motion is a fraction of the Newton step to
    the edge intensity `wanted` of adhesion without range (JKR). Afterwards the strips are wide
    enough to be resolved, and the ends are still driven outward.
    """
    problem, zones = curve.problem, fields.density.zones.table
    wanted = math.sqrt(2 * curve.stress * curve.reach / math.pi)
    strip, width = np.pi**2 / 4 * (wanted / curve.stress) ** 2, np.diff(zones, axis=1)
    slope = np.maximum(np.array(fields.density.edge_slopes).T, 1e-300)
    out = np.where(
        strip < OPTIONS.narrow_strip * width,
        np.minimum(
            MOVES.least_part * 2 * wanted / slope,
            MOVES.least_part * room_beside(zones, problem.round),
        ),
        0.0,
    )
    return zones + np.column_stack((-out[:, 0], out[:, 1]))


def _sampled_farther(
    curve: CohesiveCurve, fields: ZoneFields, gap_samples: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Samples (x, gap) outside the contact, out to points where the gap exceeds the reach.
    The reach is the largest gap at which the tension acts. The samples of a body with a period or
    with sharp corners are unchanged.

    Under a light load the gap exceeds the reach only far from the contact.
    """
    problem, (x, gap) = curve.problem, gap_samples
    if problem.round is not None or np.isfinite(problem.corners[0]):
        return gap_samples
    for _ in range(LIMITS.max_iterations):
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


def _touch_intervals(scaled: ScaledScene, curve: CohesiveCurve) -> tuple[Array, Array]:
    """(intervals where the tension acts at first touch, first guess of the zones of contact).
    The tension acts where the gap is below its reach.
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
    for _ in range(LIMITS.max_iterations):
        per_feature = (
            0.0 if profile.resolution is None else 8 * (hi - lo) * length / profile.resolution
        )
        x = np.linspace(
            lo, hi, int(np.clip(per_feature, SAMPLES.profile_samples, SAMPLES.max_samples))
        )
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
            half = 0.5 * MOVES.new_width * min([b - a, *(2 * one for one in away)])
            zones.append((inner[0] - half, inner[-1 if sharp else 0] + half))
    return curve.within(table), curve.within(np.array(zones))


def _receded(
    context: SolveContext, scaled: ScaledScene, curve: CohesiveCurve, value: float
) -> State | None:
    """The contact that is left after the ends of a wide interval of tension have receded.

    The wide interval contains all intervals of the advancing contact. Its ends, and the ends of
    wider intervals, are driven inward.
    """
    pressed = max(value, 0.0)
    here = advancing(context, scaled, curve, pressed)
    if np.isfinite(curve.problem.corners[0]):
        # The interval of tension extends from one sharp corner to the other corner.
        table, guide = np.array([curve.problem.corners]), None
        curve.from_zones(table, pressed, here.zones, ACCURACY.rough)
    else:
        table = _driven_inward_about(curve, here, pressed)
        guide = guide_of(curve, len(here.contact), table)
    rest = receded(curve, table, pressed, guide)
    return rest if rest is None or value >= 0.0 else _lowered_to(curve, rest, value)


def _driven_inward_about(curve: CohesiveCurve, here: CohesiveState, value: float) -> Array:
    """One interval around all intervals of `here`, so wide that its ends are driven inward."""
    first, last = float(here.table[0, 0]), float(here.table[-1, 1])
    middle, half = 0.5 * (first + last), 0.5 * (last - first)
    for _ in range(LIMITS.max_iterations):
        half *= MOVES.widening
        if driven_inward(curve, middle, half, value):
            return np.array([[middle - half, middle + half]])
    raise OutOfRange(
        'branch="receding" starts from the largest contact, but none was found: no interval of '
        'tension was so wide that all its ends recede. Use branch="advancing"'
    )


def _receded_from_all(context: SolveContext, curve: CohesiveCurve, value: float) -> State | None:
    """The equilibrium that the intervals of tension reach by receding from the whole period.

    None if contact is lost. Raises Closed if the gap stays below the reach on the whole period.
    """
    problem = curve.problem
    try:
        zones = under_all(context, problem)
        if zones is None:
            raise Closed
        fields, gap_samples = curve.contact_under(curve.everywhere, value, zones)
    except ContactLost:
        return None
    zones = fields.density.zones.table
    try:
        table = intervals_left(curve, value, zones, gap_samples)
    except ContactLost:
        return None
    return receded(curve, table, value, guide_of(curve, len(zones), table))


def under_all(context: SolveContext, problem: Problem) -> Array | None:
    """Scaled zones of contact if the tension acts on every open gap; None in full contact.

    Raises ContactLost if there is no contact.
    """
    scene, period = context.scene, context.scene.period
    assert period is not None
    if scene.given_load is not None and scene.given_load + scene.law.tension * period <= 0.0:
        raise ContactLost
    scene = _start_scene(context, problem)
    if scene.approach is not None and scene.approach <= 0.0:
        raise ContactLost
    found = context.solve_scene(scene, ACCURACY.resting_step)
    return placed(problem, found.zones) if len(found.zones) else None


def _start_scene(context: SolveContext, problem: Problem) -> Scene:
    """The scene without adhesion, with a load or approach raised to stand for the tension.
    A uniform tension on the whole period presses the surfaces together like an additional load.
    """
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


def solved(context: SolveContext, curve: CohesiveCurve, here: State) -> SolvedZones:
    """The solved zones at an equilibrium, with fields, certificate and error."""
    assert isinstance(here, CohesiveState)
    problem = curve.problem
    pulled = TractionLoaded.of(problem, curve.stress, here.table).over(here.zones)
    at_load = here
    if curve.control.load is None:
        at_load = CohesiveCurve(problem, Load(0.0)).from_zones(here.table, here.load, here.zones)
    fields, free, control = _solved_zones(
        context, pulled, at_load.load + pulled.pulling.total, here.zones
    )
    certificate = certify(ZoneFields(pulled, fields.state), control.load)
    whole = replace(fields, law_problem=problem, rate=at_load.rate)
    return SolvedCohesive(
        free,
        whole,
        certified(certificate, curve, here),
        1,
        control,
        context.tolerance,
        cohesive_error=end_error(curve, here, fields),
    )


def _solved_zones(
    context: SolveContext, pulled: TractionLoaded, load: float, zones: Array
) -> tuple[CohesiveFields, sie.Free, Load]:
    """(fields, result of the search for the zone ends, control) for contact under a tension.

    load: the integral of the contact pressure q, which is the pressure plus the tension.
    """
    if pulled.pulling.spread != (None, None):
        return _solved_at_corners(pulled, load - pulled.pulling.total, zones)
    control = Load(load)
    kinds = all_zones(pulled, zones)
    free = next(
        (
            found
            for tolerance in (10 * ACCURACY.density, ACCURACY.neutral)
            if (found := sie.find_ends(pulled.equation(control), kinds, tolerance)).converged
        ),
        None,
    ) or sie.find_ends(pulled.equation(control), kinds, ACCURACY.rough)
    if not free.converged:
        raise context.error(
            Failure(f"the zone ends under the final tension were not found: {free.reason}", free),
            pulled,
        )
    return CohesiveFields(pulled, free.state), free, control


def _solved_at_corners(
    pulled: TractionLoaded, load: float, zones: Array
) -> tuple[CohesiveFields, sie.Free, Load]:
    """The result of `_solved_zones` if some zones are pinned at sharp corners.

    The tension fades out over such a zone, so it depends on the position of the zone's free end.
    load: the given load.
    """
    before = np.inf
    while True:
        pulled = pulled.over(zones)
        control = Load(load + pulled.pulling.total)
        state = sie.solve_fixed(
            pulled.equation(control), all_zones(pulled, zones), ACCURACY.density
        )
        free = state.density.zones.moves
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(
                free, 2 * np.array(state.density.intensities) / edge_slopes(pulled, state), 0.0
            )
        end_error_of_step = np.abs(step).T / np.diff(zones, axis=1)
        if not end_error_of_step.max() < 0.5 * before or before < 4 * EPS:
            end_error_of_step += 4 * EPS * free.T
            found = sie.Free(
                state,
                True,
                end_error_of_step,
                end_error_of_step,
                (),
                None,
                stable=True,
                reason="the ends have converged",
            )
            return CohesiveFields(pulled, state), found, control
        zones, before = zones + np.column_stack((-step[0], step[1])), float(end_error_of_step.max())


def all_zones(pulled: TractionLoaded, zones: Array) -> sie.Zones:
    """The zones as `sie.Zones`; the density is singular at ends that lie at sharp corners."""
    left, right = (
        [sie.SINGULAR if place == corner else pulled.end for place in ends]
        for ends, corner in zip(zones.T, pulled.corners, strict=True)
    )
    return sie.Zones.of(zones, left, right)


def everywhere(context: SolveContext, problem: Problem) -> Outcome:
    """The contact under tension on the whole period, found from a contact without adhesion.
    The contact without adhesion has a raised load or approach (`_start_scene`). The tension is then
    subtracted from its pressure.
    """
    scene = _start_scene(context, problem)
    alone = replace(context, scene=scene, cache=SceneCache(scene))
    found = alone.solve_scene(scene, ACCURACY.resting_step)
    stress = context.scene.law.tension
    pulled = TractionLoaded.of(
        problem, stress / problem.units.pressure, np.zeros((0, 2)), everywhere=True
    )
    if len(found.zones) == 0:
        return full_by_adhesion(context)
    zones = placed(problem, found.zones)
    load = found.load / problem.units.load
    plain = replace(problem, law=scene.law)
    if isinstance(found.fields, GapFields):
        record_as_before(context.plan, found)
        gapped = by_gaps(alone, plain, Load(load), float(np.diff(zones, axis=1).sum()), zones)
        if isinstance(gapped, Failure):
            raise context.error(gapped, plain)
        here = gapped.fields
        lowered = CohesiveGapFields(
            here.problem, here.state, here.mean, here.relief, stress / problem.units.pressure
        )
        return replace(gapped, fields=lowered)
    fields, free, control = _solved_zones(context, pulled, load, zones)
    certificate = certify(ZoneFields(pulled, fields.state), control.load)
    curve = CohesiveCurve(problem, Load(0.0))
    fields = replace(fields, law_problem=problem)
    cohesive_error = 0.0 if context.scene.given_load is None else rounded_load(fields)
    return SolvedCohesive(
        free,
        fields,
        certified_everywhere(certificate, curve, fields),
        1,
        control,
        context.tolerance,
        cohesive_error=cohesive_error,
    )
