"""Scenes that need no coupled system: one zone about a symmetric tip, or a pair about two tips, in one interval of a line.

A half-plane, without friction or adhesion, alone or with all periods. What is found is certified by its signs and has a stated error, or
is left to the general ways: by doubt at a sign, by a series that does not end, by an error above the tolerance.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from contact.formulation.direct.accuracy import stated
from contact.formulation.direct.ends import Ends, Sheet, ends_at, ends_under
from contact.formulation.direct.fields import DirectFields
from contact.formulation.direct.maps import Map
from contact.formulation.direct.signs import Signs, signs
from contact.model.controls import Quantity
from contact.model.interactions import Interaction
from contact.model.laws import Law
from contact.model.scene import Scene
from contact.solution.plan import Plan, plan
from contact.solution.solution import Solution
from contact.verify.certificate import Certificate
from sie import Array, Mask

# Of the period in contact, beyond which the gaps are the better unknowns.
_WIDEST = 0.95
# Kinks nearer to the origin than this part of a cell are at the tip.
_AT_TIP = 1e-15
# What rounding may do to a gap, over the height of the profile at the end of a zone.
_ROUNDING = 64 * 2.2e-16
_NOTE = "one interval: the signs of its series, inside and outside"


def sheets(scene: Scene) -> tuple[Sheet, ...]:
    """What a scene may be solved by directly, the likelier one first; none where it may not."""
    profile = scene.profile
    tips = profile.summits
    if tips is None or not 1 <= len(tips) <= 2 or not profile.symmetric or profile.slope_is_derived or profile.extent is not None:
        return ()
    if scene.turned or not _asks_no_more(scene.law, scene.E_star) or not _is_half_plane(scene):
        return ()
    limit = math.inf if profile.period is None else 0.5 * profile.period
    return _of_tips(scene, np.asarray(tips, dtype=float), limit)


def _asks_no_more(law: Law, E_star: float) -> bool:
    """Whether all that a law asks for is a pressure that pushes, and vanishes at the ends."""
    return law.convex and not law.pulls and law.intensity(E_star) == 0.0 and type(law).fault is Law.fault


def _is_half_plane(scene: Scene) -> bool:
    """Whether half-plane sources are all there is, of one body or of all periods."""
    kind, operator = type(scene.interaction), scene.operator
    conditions = kind.side_conditions is Interaction.side_conditions and kind.placed_conditions is Interaction.placed_conditions
    return kind.exact and not kind.strip and conditions and not operator.own_columns and not operator.is_own and operator.is_plain


def _of_tips(scene: Scene, tips: Array, limit: float) -> tuple[Sheet, ...]:
    profile, period = scene.profile, scene.period
    corner = None
    if profile.support is not None:
        # Zones that end at corners under other slopes are the general machine's.
        if not scene.is_flat or scene.given_load is None:
            return ()
        corner = profile.support[1]
    kink = 0.0
    for at, height in profile.kinks:
        if len(tips) == 1 and abs(at) <= _AT_TIP * (period or 1.0) and height > 0.0:
            kink = float(height)
        elif abs(at) < limit * (1.0 - 1e-12):
            return ()
    if len(profile.jumps) and np.any(np.abs(profile.jumps[:, 0]) < limit * (1.0 - 1e-12)):
        return ()
    one = Sheet(profile, Map(period, False), kink, corner, limit)
    if len(tips) == 1:
        return (one,) if tips[0] == 0.0 else ()
    low, high = sorted(tips)
    if not (high > 0.0 and low == -high) or kink:
        return ()
    return Sheet(profile, Map(period, True), 0.0, None, limit, float(high)), one


@dataclass(frozen=True, eq=False)
class Direct:
    """The rows that came out, with their signs and stated errors; holds: of all that were asked for, which these are."""

    ends: Ends
    signs: Signs | None
    error: Array
    holds: Mask


def directly(scene: Scene, tol: float) -> Solution | None:
    """The solution of a scene that needs no coupled system; None where it does, or where anything is in doubt."""
    start = time.perf_counter()
    held = scene.control_object.held(scene)
    if held is None or held.quantity is Quantity.APPROACH or scene.contact_fraction is not None and scene.contact_fraction > _WIDEST:
        return None
    load = scene.given_load
    for sheet in sheets(scene):
        if load is not None:
            found = _judged(scene, ends_under(sheet, np.array([load / (0.5 * scene.E_star)])), tol)
        elif sheet.map.pair or len(sheet.profile.summits) > 1:  # type: ignore[arg-type]
            return None
        else:
            half = held.value if held.quantity is Quantity.HALF_WIDTH else 0.5 * held.value
            found = _judged(scene, ends_at(sheet, np.array([half])), tol)
        if found.holds[0]:
            return _solution(scene, found, 0, time.perf_counter() - start)
    return None


def all_directly(scenes: Sequence[Scene], tol: float) -> list[Solution | None]:
    """The same of scenes that differ in their loads alone, all at once."""
    start = time.perf_counter()
    out: list[Solution | None] = [None] * len(scenes)
    if not scenes or scenes[0].given_load is None:
        return [directly(scene, tol) for scene in scenes]
    loads = np.array([scene.given_load for scene in scenes])
    left = np.arange(len(scenes))
    for sheet in sheets(scenes[0]):
        if not len(left):
            break
        found = _judged(scenes[0], ends_under(sheet, loads[left] / (0.5 * scenes[0].E_star)), tol)
        took = (time.perf_counter() - start) / len(scenes)
        for row, place in enumerate(left[found.holds]):
            out[place] = _solution(scenes[place], found, row, took)
        left = left[~found.holds]
    return out


def _judged(scene: Scene, ends: Ends, tol: float) -> Direct:
    """With signs and stated errors: which rows may be given out."""
    period, holds = scene.period, ends.found
    if period is not None and ends.sheet.corner is None:
        holds = holds & (ends.widths * (2 if ends.sheet.map.pair else 1) <= _WIDEST * period)
    if not holds.any():
        return Direct(ends, None, np.zeros(0), holds)
    if not holds.all():
        ends = ends.rows(holds)
    seen = signs(ends)
    error = stated(ends, seen)
    good = seen.holds & (error <= tol)
    if not good.all():
        holds = holds.copy()
        holds[holds] = good
        ends, seen, error = ends.rows(good), seen.rows(good), error[good]
    return Direct(ends, seen, error, holds)


def _solution(scene: Scene, found: Direct, row: int, took: float) -> Solution:
    seen, ends = found.signs, found.ends
    assert seen is not None
    if len(ends.half) > 1:
        ends = ends.rows(slice(row, row + 1))
    fields = DirectFields(scene, ends)
    parts: dict[str, Any] = {
        "certificate": partial(_certificate, scene, ends, float(seen.least[row]), float(seen.gap[row]), seen.points),
        "plan": partial(_plan, scene, ends, took),
    }
    return Solution.unfolding(scene, fields.zone_table, fields, float(found.error[row]), parts)


def _certificate(scene: Scene, ends: Ends, least: float, gap: float, points: int) -> Certificate:
    load = scene.given_load
    unit = 0.5 * scene.E_star
    balance = 0.0 if load is None else abs(unit * float(ends.totals[0]) / load - 1.0)
    # Where the gap grows all the way, it is least at the ends.
    smallest = None if ends.sheet.corner is not None else gap if math.isfinite(gap) else 0.0
    height = float(np.abs(scene.profile.height(ends.outer[0])))
    return Certificate(
        smallest_pressure=unit * least, smallest_gap=smallest, gap_rounding=_ROUNDING * height, load_balance=balance, level_spread=0.0,
        points=points, holds=True, note=_NOTE,
    )


def _plan(scene: Scene, ends: Ends, took: float) -> Plan:
    told = plan(scene)
    given = scene.half_width is not None or ends.sheet.corner is not None
    for part in told.parts:
        if part.name == "coarse search":
            part.used, part.reason = False, "one interval of a line, without a coupled system"
        elif part.name == "zone ends":
            part.detail = "" if given else f"{int(ends.steps[0])} Newton steps in one series of {int(ends.nodes[0])} nodes"
            part.seconds = took if part.used else None
        elif part.name == "kinks":
            part.used = ends.sheet.kink > 0.0
            part.reason = "1 jumps of the slope or its derivatives inside zones" if part.used else part.reason
        elif part.name == "symmetry":
            part.used = True
        elif part.name == "certificate":
            part.detail = "by the signs of the series"
    zones = 1 + ends.sheet.map.pair
    nodes = int(ends.nodes[0])
    told.counts.update(
        zones=zones, own_modes=zones * nodes, coupled_unknowns=1, kernel_evaluations=0,
        profile_evaluations=nodes * int(ends.steps[0] + 1), solves=1,
    )
    told.seconds = took
    return told
