"""Solutions of scenes with one symmetric contact zone, about one tip or about two tips.

The scene is a half-plane without friction or adhesion, isolated or periodic. The zone is
certified by the signs of pressure and gap, computed from its series, and has a stated error. The
general search solves the scene instead if a sign is in doubt, if the series is not resolved by the
largest number of nodes, or if the error is above the tolerance.
"""

import math
import time
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from contact.closed.fields import ClosedFields
from contact.closed.line import LineMap, Value
from contact.closed.signs import least_inside, places, signs, stated
from contact.closed.zone import (
    SUM_ROUND_OFF,
    ClosedZone,
    OneZoneProblem,
    zone_at_approach,
    zone_of_width,
    zone_under,
)
from contact.formulation import claims
from contact.formulation.tolerances import allowed_overlap
from contact.model.controls import Quantity
from contact.model.interactions import Interaction
from contact.model.laws import Law
from contact.model.profiles.base import is_of_package
from contact.model.scene import Scene
from contact.model.units import counted
from contact.solution.plan import Plan, plan
from contact.solution.solution import Solution
from contact.verify.certificate import Certificate
from contact.verify.law_checks import has_checks, held_to_law

# If a larger fraction of the period is in contact, the general search is used instead of the closed
# form. The search solves for the gap and so keeps the digits of the gap's width. The choice is
# uncritical: results for limits from 0.9 to 0.999 differ in those digits only.
WIDEST = 0.95
_NOTE = "one zone: the signs of pressure and gap follow from its series"


def one_zone_problem(scene: Scene) -> OneZoneProblem | None:
    """The problem of one contact zone symmetric about x = 0; None if the scene has no such zone."""
    profile, law = scene.profile, scene.law
    tips = profile.summits
    if (
        tips is None
        or not _may_be_one_zone(scene, np.asarray(tips, dtype=float).tolist())
        or not profile.symmetric
        or profile.slope_is_derived
        or profile.extent is not None
        or scene.turned
        or _refusal(law, scene.E_star)
        or not _is_half_plane(scene)
    ):
        return None
    limit = math.inf if profile.period is None else 0.5 * profile.period
    corner = None
    if profile.support is not None:
        # If the zone ends at corners, only a flat profile under a given load has a closed form
        # here. All other profiles with corners are left to the general search.
        if not scene.is_flat or scene.given_load is None:
            return None
        corner = profile.support[1]
    kink, inside = 0.0, limit * (1.0 - SUM_ROUND_OFF)
    for at, height in np.asarray(profile.kinks).tolist():
        if abs(at) <= SUM_ROUND_OFF * (scene.period or 1.0) and height > 0.0:
            kink = height
        elif abs(at) < inside:
            return None
    broken = np.append(np.asarray(profile.jumps)[:, 0], np.asarray(profile.algebraic_points)[:, 0])
    if any(abs(at) < inside for at in broken.tolist()):
        return None
    return OneZoneProblem(profile, LineMap(scene.period), kink, corner, limit)


def _may_be_one_zone(scene: Scene, tips: list[float]) -> bool:
    """Whether the contact may be one zone symmetric about 0, for a profile with these tips.
    That is so for one tip at 0, or two at equal distances from 0.

    About two tips, the contact is one zone only if two zones have merged. If the load or the
    approach is given, the signs of pressure and gap show whether they have. A given width may also
    be that of two zones.
    """
    if tips == [0.0]:
        return True
    held = scene.control_object.held(scene)
    by_width = held is not None and held.quantity in (Quantity.WIDTH, Quantity.HALF_WIDTH)
    return len(tips) == 2 and tips[0] == -tips[1] and not by_width


def why_not_closed(law: Law, E_star: float) -> str:
    """The reason why a scene with this contact law was not solved in closed form."""
    return _refusal(law, E_star) or (
        "the closed form needs one symmetric zone of a half-plane, and a profile that gives its "
        "slope"
    )


def _refusal(law: Law, E_star: float) -> str:
    """The reason why a contact law has no closed form, as a message; empty if it has one."""
    if law.routes.module is not None:
        return f"the law {law.name} is solved by {law.routes.module}"
    if not law.equilibria.unique:
        return (
            f"under the law {law.name} correct signs of pressure and gap do not prove that the "
            "contact is unique"
        )
    if law.pressure_range.has_tension or law.intensity(E_star) != 0.0:
        return f"the closed form has no tension, but the law {law.name} has"
    return (
        f"the law {law.name} requires more than the right signs of pressure and gap"
        if has_checks(law)
        else ""
    )


def _is_half_plane(scene: Scene) -> bool:
    """Whether the equation is that of a plain half-plane, isolated or periodic."""
    kind, operator = type(scene.interaction), scene.operator
    conditions = (
        kind.side_conditions is Interaction.side_conditions
        and kind.placed_conditions is Interaction.placed_conditions
    )
    return (
        kind.exact
        and not kind.strip
        and conditions
        and not operator.own_columns
        and not operator.is_own
        and operator.is_plain
    )


def solve_closed(scene: Scene, tol: float) -> Solution | None:
    """The closed solution of a scene with one symmetric zone; None if a check is in doubt."""
    start = time.perf_counter()
    held = scene.control_object.held(scene)
    problem = None if held is None else one_zone_problem(scene)
    if held is None or problem is None:
        return None
    with np.errstate(all="ignore"):
        if held.quantity is Quantity.LOAD:
            zone = zone_under(problem, held.value / (0.5 * scene.E_star))
        elif held.quantity is Quantity.APPROACH:
            zone = zone_at_approach(problem, held.value, scene.operator.datum)
        else:
            half = 1.0 if held.quantity is Quantity.HALF_WIDTH else 0.5
            zone = zone_of_width(problem, half * held.value)
        if not zone.found:
            return None
        holds, error, gap = _judged(zone, tol)
    took = time.perf_counter() - start
    return _solution(scene, zone, float(error), float(gap), took) if holds else None


def solve_all_closed(scenes: Sequence[Scene], tol: float) -> list[Solution | None]:
    """The closed solutions of scenes that differ only in their loads, computed all at once."""
    start = time.perf_counter()
    if not scenes or scenes[0].given_load is None:
        return [solve_closed(scene, tol) for scene in scenes]
    out: list[Solution | None] = [None] * len(scenes)
    problem = one_zone_problem(scenes[0])
    if problem is None:
        return out
    with np.errstate(all="ignore"):
        loads = np.array([scene.given_load for scene in scenes]) / (0.5 * scenes[0].E_star)
        zone = zone_under(problem, loads)
        rows = np.flatnonzero(zone.found)
        if len(rows):
            zone = zone.rows(zone.found)
            holds, error, gap = _judged(zone, tol)
            gap, took = np.broadcast_to(gap, holds.shape), (time.perf_counter() - start) / len(rows)
            for k in map(int, np.flatnonzero(holds)):
                one = zone.rows(k)
                out[rows[k]] = _solution(scenes[rows[k]], one, float(error[k]), float(gap[k]), took)
    return out


def _judged(zone: ClosedZone, tol: float) -> tuple[Any, Value, Value]:
    """(whether a zone's signs are certified within tol, stated error, least sampled gap)."""
    problem = zone.problem
    holds, gap = signs(zone)
    error = stated(zone)
    if not is_of_package(problem.profile):
        outer = np.ravel(zone.half_width)
        errors = [claims.of(problem.profile, np.array([[-half, half]])).error for half in outer]
        error = error + np.reshape(errors, np.shape(zone.half_width))
    if problem.map.period is not None and problem.corner is None:
        holds = holds & (zone.widths <= WIDEST * problem.map.period)
    return holds & (error <= tol), error, gap


def _solution(scene: Scene, zone: ClosedZone, error: float, gap: float, took: float) -> Solution:
    fields = ClosedFields(scene, zone)
    parts: dict[str, Any] = {
        "certificate": partial(_certificate, scene, zone, gap, fields),
        "plan": partial(_plan, scene, zone, took),
    }
    return Solution.deferred(scene, fields.zone_table, fields, error, parts)


def _certificate(scene: Scene, zone: ClosedZone, gap: float, fields: ClosedFields) -> Certificate:
    load, corner = scene.given_load, zone.problem.corner is not None
    unit = 0.5 * scene.E_star
    with np.errstate(all="ignore"):
        least, inside = least_inside(zone)
        points = inside if corner else inside + places(zone).size
    certificate = Certificate(
        smallest_pressure=unit * least,
        # `gap` is inf if the gap rises everywhere outside the zone. The smallest gap is then 0, at
        # the ends of the zone.
        smallest_gap=None if corner else gap if math.isfinite(gap) else 0.0,
        gap_rounding=allowed_overlap(heights=abs(float(scene.profile.height(zone.half_width)))),
        load_balance=0.0 if load is None else abs(unit * float(zone.totals) / load - 1.0),
        points=points,
        holds=True,
        note=_NOTE,
    )
    return held_to_law(certificate, scene.law, fields, load)


def _plan(scene: Scene, zone: ClosedZone, took: float) -> Plan:
    record = plan(scene)
    record.decide(
        "solver", "closed form", "one symmetric zone of a half-plane needs no coupled system"
    )
    record.decide("unknowns", "zones", "the closed form is a series of the pressure on the zone")
    given = scene.held(Quantity.HALF_WIDTH) is not None or zone.problem.corner is not None
    for part in record.parts:
        if part.name == "coarse search":
            part.used, part.reason = False, "the closed form of one zone needs no coarse search"
        elif part.name == "zone ends":
            steps = counted(zone.steps, "Newton step")
            steps += f", one series from {counted(zone.nodes, 'node')}"
            part.detail = "" if given else steps
            part.seconds = took if part.used else None
        elif part.name == "kinks":
            part.used = zone.problem.kink > 0.0
            if part.used:
                part.reason = "1 jump of the slope or its derivatives inside zones"
        elif part.name == "symmetry":
            part.used = True
        elif part.name == "certificate":
            part.detail = "from the signs of the series"
    record.counts.update(
        zones=1,
        own_modes=zone.nodes,
        coupled_unknowns=1,
        kernel_evaluations=0,
        profile_evaluations=zone.nodes * (zone.steps + 1),
        solves=1,
    )
    record.seconds = took
    return record
