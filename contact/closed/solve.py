"""Scenes that need no coupled system: one zone about a symmetric tip, or a pair about two tips, in
one interval of a line.

A half-plane, without friction or adhesion, alone or with all periods. What is found is certified by
its signs and has a stated error, or is left to the general ways: by doubt at a sign, by a series
that does not end, by an error above the tolerance.
"""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from contact.closed.ends import Ends, Sheet, ends_at, ends_under
from contact.closed.fields import DirectFields
from contact.closed.maps import Map
from contact.closed.signs import least_inside, places, signs, stated
from contact.formulation import claims
from contact.formulation.full_contact import lowest
from contact.model.controls import Quantity
from contact.model.interactions import Interaction
from contact.model.laws import Law
from contact.model.profiles.base import is_of_package
from contact.model.scene import Scene
from contact.solution.plan import Plan, plan
from contact.solution.solution import Solution
from contact.verify.certificate import Certificate

# Of the period in contact, beyond which the gaps are the better unknowns.
_WIDEST = 0.95
# Kinks nearer to the origin than this part of a cell are at the tip.
_AT_TIP = 1e-15
# What rounding may do to a gap, over the height of the profile at the end of a zone.
_ROUNDING = 64 * 2.2e-16
# Steps to a given approach, how far one goes in the logarithm of the load, after which one the next
# is the last, and how many may lead to more than the interval can bear; what rounding does to an
# approach.
_STEPS = 40
_FAR = 4.0
_NEAR = 1e-8
_MISSES = 4
_EPS = 4 * 2.2e-16
_NOTE = "one interval: the signs of its series, inside and outside"


def sheets(scene: Scene) -> Iterator[Sheet]:
    """What a scene may be solved by directly, the likelier one first; none where it may not."""
    profile = scene.profile
    tips = profile.summits
    if (
        tips is None
        or not 1 <= len(tips) <= 2
        or not profile.symmetric
        or profile.slope_is_derived
        or profile.extent is not None
    ):
        return
    if scene.turned or not _asks_no_more(scene.law, scene.E_star) or not _is_half_plane(scene):
        return
    limit = math.inf if profile.period is None else 0.5 * profile.period
    yield from _of_tips(scene, np.asarray(tips, dtype=float).tolist(), limit)


def _asks_no_more(law: Law, E_star: float) -> bool:
    """Whether all that a law asks for is a pressure that pushes, and vanishes at the ends."""
    return (
        law.routes.module is None
        and law.equilibria.unique
        and not law.pressure_range.has_tension
        and law.intensity(E_star) == 0.0
        and type(law).fault is Law.fault
    )


def _is_half_plane(scene: Scene) -> bool:
    """Whether half-plane sources are all there is, of one body or of all periods."""
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


def _of_tips(scene: Scene, tips: list[float], limit: float) -> Iterator[Sheet]:
    profile, period = scene.profile, scene.period
    corner = None
    if profile.support is not None:
        # Zones that end at corners under other slopes are the general machine's.
        if not scene.is_flat or scene.given_load is None:
            return
        corner = profile.support[1]
    kink, inside = 0.0, limit * (1.0 - 1e-12)
    for at, height in np.asarray(profile.kinks).tolist():
        if len(tips) == 1 and abs(at) <= _AT_TIP * (period or 1.0) and height > 0.0:
            kink = height
        elif abs(at) < inside:
            return
    broken = np.append(np.asarray(profile.jumps)[:, 0], np.asarray(profile.algebraic_points)[:, 0])
    if any(abs(at) < inside for at in broken.tolist()):
        return
    low, high = min(tips), max(tips)
    if low != -high:
        return
    if high > 0.0:
        yield Sheet(profile, Map(period, True), 0.0, None, limit, high)
    yield Sheet(profile, Map(period, False), kink, corner, limit)


def directly(scene: Scene, tol: float) -> Solution | None:
    """The solution of a scene that needs no coupled system; None where it does, or where anything
    is in doubt.
    """
    start = time.perf_counter()
    held = scene.control_object.held(scene)
    if held is None:
        return None
    if (
        held.quantity is Quantity.WIDTH
        and scene.profile.period is not None
        and held.value > _WIDEST * scene.profile.period
    ):
        return None
    with np.errstate(all="ignore"):
        for sheet in sheets(scene):
            if held.quantity is Quantity.LOAD:
                ends = ends_under(sheet, held.value / (0.5 * scene.E_star))
            elif held.quantity is Quantity.APPROACH:
                ends = _ends_approached(scene, sheet, held.value)
            elif sheet.map.pair or len(sheet.profile.summits) > 1:  # type: ignore[arg-type]
                return None
            else:
                ends = ends_at(
                    sheet, held.value if held.quantity is Quantity.HALF_WIDTH else 0.5 * held.value
                )
            if ends.found and _narrow(ends):
                holds, error, gap = _judged(ends, tol)
                if holds:
                    return _solution(
                        scene, ends, float(error), float(gap), time.perf_counter() - start
                    )
    return None


def all_directly(scenes: Sequence[Scene], tol: float) -> list[Solution | None]:
    """The same of scenes that differ in their loads alone, all at once."""
    start = time.perf_counter()
    out: list[Solution | None] = [None] * len(scenes)
    if not scenes or scenes[0].given_load is None:
        return [directly(scene, tol) for scene in scenes]
    left = np.arange(len(scenes))
    with np.errstate(all="ignore"):
        loads = np.array([scene.given_load for scene in scenes]) / (0.5 * scenes[0].E_star)
        for sheet in sheets(scenes[0]):
            if not len(left):
                break
            ends = ends_under(sheet, loads[left])
            may = ends.found & _narrow(ends)
            if not may.any():
                continue
            ends, mine = ends.rows(may), left[may]
            holds, error, gap = _judged(ends, tol)
            gap = np.broadcast_to(gap, holds.shape)
            took = (time.perf_counter() - start) / len(scenes)
            for row in map(int, np.flatnonzero(holds)):
                scene = scenes[mine[row]]
                out[mine[row]] = _solution(
                    scene, ends.rows(row), float(error[row]), float(gap[row]), took
                )
            left = np.setdiff1d(left, mine[holds])
    return out


def _ends_approached(scene: Scene, sheet: Sheet, approach: float) -> Ends:
    """Newton on the logarithm of the load. The approach follows the load as if the ends stood
    still: pressure and gap vanish there.
    """
    unit, least, most, misses, rests = 0.5 * scene.E_star, 0.0, math.inf, 0, False
    load = unit * approach
    for _ in range(_STEPS):
        ends = ends_under(sheet, load / unit)
        if ends.found:
            fields = DirectFields(scene, ends)
            here, share = fields.approach, load / fields.stiffness  # type: ignore[operator]
            if here is None or not (here > 0.0 and 0.0 < share < math.inf):
                break
            move = math.log(approach / here) * here / share
            rounding = _EPS * (abs(lowest(scene.profile)) + approach + share) / share
            if rests or abs(move) <= rounding:
                rate = max(*ends.spreading) / ends.half
                return replace(ends, off=ends.off + rate * (abs(move) + rounding))
            least, most = (load, most) if move > 0.0 else (least, load)
            load, rests = load * math.exp(min(max(move, -_FAR), _FAR)), abs(move) <= _NEAR
        else:
            # More than the interval can bear.
            most, misses = load, misses + 1
        if misses > _MISSES:
            break
        if not (rests or least < load < most):
            load = 0.5 * (least + most)
    return replace(ends, found=False)


def _narrow(ends: Ends) -> Any:
    """Whether the gaps are not the better unknowns."""
    period = ends.sheet.map.period
    return (
        period is None
        or ends.sheet.corner is not None
        or ends.widths * ends.zones <= _WIDEST * period
    )


def _judged(ends: Ends, tol: float) -> tuple[Any, Any, Any]:
    """(which of the loads may be given out, the stated errors, the least gaps that were looked at)."""
    holds, gap = signs(ends)
    error = stated(ends) + _of_claims(ends)
    return holds & (error <= tol), error, gap


def _of_claims(ends: Ends) -> Any:
    """Errors that the claims of the profile add, see contact.formulation.claims."""
    profile, outer = ends.sheet.profile, np.ravel(ends.outer)
    if is_of_package(profile):
        return 0.0
    errors = [claims.of(profile, np.array([[-half, half]])).error for half in outer]
    return np.reshape(errors, np.shape(ends.outer))


def _solution(scene: Scene, ends: Ends, error: float, gap: float, took: float) -> Solution:
    fields = DirectFields(scene, ends)
    parts: dict[str, Any] = {
        "certificate": partial(_certificate, scene, ends, gap),
        "plan": partial(_plan, scene, ends, took),
    }
    return Solution.deferred(scene, fields.zone_table, fields, error, parts)


def _certificate(scene: Scene, ends: Ends, gap: float) -> Certificate:
    load, corner = scene.given_load, ends.sheet.corner is not None
    unit = 0.5 * scene.E_star
    with np.errstate(all="ignore"):
        least, inside = least_inside(ends)
        points = inside if corner else inside + places(ends).size
    return Certificate(
        smallest_pressure=unit * least,
        # Where the gap grows all the way, it is least at the ends.
        smallest_gap=None if corner else gap if math.isfinite(gap) else 0.0,
        gap_rounding=_ROUNDING * abs(float(scene.profile.height(ends.outer))),
        load_balance=0.0 if load is None else abs(unit * float(ends.totals) / load - 1.0),
        points=points,
        holds=True,
        note=_NOTE,
    )


def _plan(scene: Scene, ends: Ends, took: float) -> Plan:
    told = plan(scene)
    told.decide(
        "solver", "closed form", "one symmetric interval of a half-plane needs no coupled system"
    )
    given = scene.held(Quantity.HALF_WIDTH) is not None or ends.sheet.corner is not None
    for part in told.parts:
        if part.name == "coarse search":
            part.used, part.reason = False, "one interval of a line, without a coupled system"
        elif part.name == "zone ends":
            part.detail = (
                ""
                if given
                else f"{int(ends.steps)} Newton steps in one series of {int(ends.nodes)} nodes"
            )
            part.seconds = took if part.used else None
        elif part.name == "kinks":
            part.used = ends.sheet.kink > 0.0
            part.reason = (
                "1 jumps of the slope or its derivatives inside zones" if part.used else part.reason
            )
        elif part.name == "symmetry":
            part.used = True
        elif part.name == "certificate":
            part.detail = "by the signs of the series"
    zones, nodes = ends.zones, int(ends.nodes)
    told.counts.update(
        zones=zones,
        own_modes=zones * nodes,
        coupled_unknowns=1,
        kernel_evaluations=0,
        profile_evaluations=nodes * int(ends.steps + 1),
        solves=1,
    )
    told.seconds = took
    return told
