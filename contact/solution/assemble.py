"""A `Solution` from the result of a search: zones in metres, stated error, plan."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

import sie
from contact.errors import NotConverged
from contact.extras import require
from contact.formulation import claims, tables
from contact.formulation.fields import ZoneFields, mean_shape
from contact.formulation.full_contact import (
    ApartFields,
    FullFields,
    FullLimit,
    lowest,
    period_samples,
)
from contact.formulation.problem import Problem
from contact.formulation.tolerances import TOLERANCES
from contact.formulation.units import Units
from contact.model.profiles.base import is_of_package
from contact.model.scene import Scene
from contact.model.units import counted, quantity
from contact.solution.plan import Plan
from contact.solution.quantities import PullOff
from contact.solution.solution import Solution, limit_of_approach
from contact.verify.certificate import Certificate, unresolved_gaps_note
from contact.verify.error import SolvedGaps, SolvedZones, body_limit, limit, position_rounding
from contact.verify.law_checks import held_to_law
from sie import Array


def zone_solution(
    scene: Scene,
    found: SolvedZones,
    plan: Plan,
    tol: float,
    branch: str | None,
    find_pull_off: Callable[[ZoneFields], PullOff] | None,
) -> Solution:
    """The solution from the solved zones.
    Raises NotConverged, which contains the solution, if the error of the solution is too large.

    branch, find_pull_off: see `Solution`.
    """
    density = found.fields.density
    zones = density.zones
    plan["symmetry"].used = zones.symmetric
    if not zones.symmetric and scene.profile.symmetric and not scene.law.kappa:
        plan["symmetry"].reason = "the zones are not computed as mirror images of each other"
    plan["zone ends"].detail = ", ".join(
        (counted(len(found.free.trace), "Newton step"), counted(found.rounds, "round"))
    )
    plan["certificate"].detail = counted(found.certificate.points, "point")
    poles = density.jumps.poles
    jumps = len(density.jumps) - len(poles)
    plan["kinks"].used = jumps > 0 or len(poles.points[0]) > 0
    if plan["kinks"].used:
        of = "of the slope or its derivatives inside zones"
        powers = f", {counted(count, 'algebraic point')}" if (count := len(poles.points[0])) else ""
        plan["kinks"].reason = counted(jumps, f"jump {of}", f"jumps {of}") + powers
    if density.slit_count:
        plan["slits"].used, plan["slits"].reason = True, "narrow gaps between zones"
        joined = counted(len(zones) - density.slit_count, "wide zone")
        plan["slits"].detail = f"{counted(density.slit_count, 'slit')}, {joined}"
    else:
        plan["slits"].reason = "no narrow gaps between zones"
    _record_sizes(plan, len(zones), found.free.state)
    table = in_cell(scene, found.fields.zone_table)
    claimed = claims.of(scene.profile, table)
    error = found.error_with(claimed.error)
    solution = Solution(
        scene, table, found.fields, error, found.certificate, plan, found.free.trace
    )
    solution = replace(solution, branch=branch, find_pull_off=find_pull_off)
    cause = claimed.limit if error > 2 * found.error else found.main_cause
    return _checked(tol, solution, found.free, "zone", position_rounding(found), cause)


def gap_solution(scene: Scene, found: SolvedGaps, plan: Plan, tol: float) -> Solution:
    """The solution of a nearly full contact that was solved for its gaps instead of its zones.

    Raises NotConverged with the solution if its error exceeds the tolerance.
    """
    fields = found.fields
    plan["zone ends"].reason = "nearly full contact: the gaps are the unknowns"
    plan["zone ends"].detail = ", ".join(
        (counted(len(found.free.trace), "Newton step"), counted(len(fields.zones), "gap"))
    )
    if not scene.law.kappa:
        plan["symmetry"].used, plan["symmetry"].reason = False, "the gaps are the unknowns"
    _record_sizes(plan, len(fields.zones), found.free.state)
    table = in_cell(scene, np.asarray(fields.problem.units.x(fields.zones)))
    claimed = claims.of(scene.profile)
    error = found.error_with(claimed.error)
    solution = Solution(scene, table, fields, error, found.certificate, plan, found.free.trace)
    cause = claimed.limit if error > 2 * found.error else found.main_cause
    return _checked(tol, solution, found.free, "gap", cause=cause)


def full_contact_solution(
    scene: Scene, full: FullLimit, mean_pressure: float, plan: Plan, tol: float, branch: str | None
) -> Solution:
    """The solution in full contact.

    Raises NotConverged, with this solution, if rounding of the heights makes the error exceed the
    tolerance.
    """
    profile = scene.profile
    fields = FullFields(period_problem(scene), mean_pressure, full.relief, mean_height(scene))
    least = mean_pressure - full.onset_pressure
    unresolved = 0 if scene.law.pressure_range.has_tension else int(np.sum(profile.kinks[:, 1] < 0))
    certificate = Certificate(
        smallest_pressure=least,
        smallest_gap=None,
        points=len(period_samples(profile)),
        holds=True,
        undecided=unresolved > 0,
        note=_full_contact_note(scene, least, unresolved),
    )
    for name in ("zone ends", "coarse search"):
        plan[name].used, plan[name].reason = False, "full contact"
    plan.decide("unknowns", "none", "the pressure of full contact has a closed form")
    # The error is relative to the largest pressure, or to the mean pressure if the largest is
    # infinite.
    peak = (
        max(abs(fields.max_pressure), abs(least))
        if math.isfinite(fields.max_pressure)
        else abs(mean_pressure)
    )
    claimed = claims.of(profile)
    error = TOLERANCES.closed_form_rounding + full.error / peak + claimed.error
    solution = Solution(scene, np.zeros((0, 2)), fields, error, certificate, plan, branch=branch)
    if error > tol:
        why = (
            f"the stated error {error:.2g} of full contact is above the tolerance {tol:.2g}: "
            f"{claimed.limit or full.relief.limit}"
        )
        raise NotConverged(why, (), solution)
    return lawful(solution)


def apart_solution(scene: Scene, problem: Problem, approach: float | None, plan: Plan) -> Solution:
    """The solution for surfaces that do not touch.
    approach [m]: None if no approach is given.
    """
    for name in ("zone ends", "coarse search"):
        plan[name].used, plan[name].reason = False, "the surfaces are apart"
    plan.decide("unknowns", "none", "the surfaces are apart")
    gap, holds = (None, True) if approach is None else (-approach, approach <= 0.0)
    certificate = Certificate(
        smallest_pressure=0.0,
        smallest_gap=gap,
        points=0,
        holds=holds,
        note="the surfaces are apart",
    )
    fields = ApartFields(problem, approach)
    return lawful(
        Solution(scene, np.zeros((0, 2)), fields, 0.0, certificate, plan, branch="receding")
    )


def lawful(solution: Solution) -> Solution:
    """Return the solution if it obeys the law of the interface; else raise NotConverged with it."""
    scene, certificate = solution.scene, solution.certificate
    checked = held_to_law(certificate, scene.law, solution.fields, scene.given_load)
    if checked is certificate:
        return solution
    raise NotConverged(
        f"not converged: {checked.note}", solution.trace, replace(solution, certificate=checked)
    )


def _full_contact_note(scene: Scene, least: float, unresolved: int) -> str:
    if unresolved:
        return f"full contact; {unresolved_gaps_note(unresolved, 'the period')}"
    if least >= 0.0 or not scene.law.pressure_range.has_tension:
        return "full contact: the pressure is nowhere negative"
    if scene.law.tension:
        return "full contact, under tension in places: nowhere above the tension of the law"
    # A flaw is a place where the surfaces are open. Under the tension s = -`least`, a flaw of half
    # width c opens further if s sqrt(c/2) reaches the law's `intensity`. `flaw` is the smallest c.
    flaw = 2 * (scene.law.intensity(scene.E_star) / least) ** 2
    message = "full contact, under tension in places: closed surfaces stay closed"
    return f"{message}; a flaw of half width {quantity(flaw, 'm', 3)} would open there"


def period_problem(scene: Scene) -> Problem:
    """The scaled problem of a scene, with the period as the unit of length."""
    profile = scene.profile
    units = Units(0.0, profile.period or 1.0, 1.0, scene.E_star)
    return Problem(profile, scene.interaction, scene.substrate, scene.law, units, lowest(profile))


def mean_height(scene: Scene) -> float:
    """Mean of f - min f over the period [m], where f is the height of the profile."""
    problem = period_problem(scene)
    return mean_shape(problem) * problem.units.height


def in_cell(scene: Scene, table: Array) -> Array:
    """Zones [m] in ascending order, with left ends in [x0, x0 + L), where L is the period."""
    return tables.in_cell(table, scene.profile.x0, scene.period)


def profile_fault(scene: Scene, zones: Array | None = None) -> str:
    """The first fault of a user's profile, in words; an empty string if there is no fault.

    zones: zones of the contact [m]. Corners are searched for in these zones. A profile that is
    defined on the whole line is checked in an interval around them.
    """
    if corner := undeclared_corner(scene, zones):
        return f"; {corner}"
    for profile in scene.profile.bodies.values():
        if is_of_package(profile):
            continue
        window = None
        if zones is not None and len(zones) and not (profile.known or profile.support):
            lo, hi = float(zones.min()), float(zones.max())
            window = lo - (hi - lo), hi + (hi - lo)
        faults = require("contact.testing").check_profile(profile, window, raises=False).faults
        if faults:
            return (
                f"; the profile contradicts itself (see contact.testing.check_profile): {faults[0]}"
            )
    return ""


def undeclared_corner(scene: Scene, zones: Array | None) -> str:
    """Message on an undeclared corner of a user's profile in the zones; "" if there is none."""
    profile = scene.profile
    if zones is None or len(profile.bodies) > 1 or is_of_package(profile):
        return ""
    return str(require("contact.model.plugin_checks.corners").undeclared_corner(profile, zones))


def _record_sizes(plan: Plan, zones: int, state: sie.AnyState) -> None:
    sizes = state.sizes
    if sizes.iterations:
        sums = plan["fast sums"]
        sums.used, sums.reason = True, "many unknowns: sums by trees, linear systems by GMRES"
        sums.detail = counted(sizes.iterations, "iteration")
    plan.counts.update(
        zones=zones,
        own_modes=int(sizes.own.sum()),
        coupled_unknowns=state.coupled,
        kernel_evaluations=sizes.kernel_evaluations,
        profile_evaluations=sizes.profile_evaluations,
        solves=sizes.solves,
    )


def _checked(
    tol: float, solution: Solution, free: sie.Free, of: str, positions: float = 0.0, cause: str = ""
) -> Solution:
    """Return the solution; raise NotConverged if its error is too large or it violates the law.

    The error of the solution has to be at most the tolerance `tol`. cause: main cause of the error,
    in words, if the law or the profile adds most of the error.
    """
    if solution.error > tol:
        fields = solution.fields
        body = (
            body_limit(fields.problem, fields.density.zones.table, tol)
            if isinstance(fields, ZoneFields)
            else ""
        )
        end = fields.problem.end if isinstance(fields, ZoneFields) else sie.FREE
        why = (
            limit_of_approach(solution, tol)
            or body
            or cause
            or limit(free, tol, of, positions, end, solution.error)
        )
        message = (
            f"the stated error {solution.error:.2g} is above the tolerance "
            f"{tol:.2g}{': ' if why else ''}{why}"
        )
        fault = "" if why else profile_fault(solution.scene, solution.zones)
        raise NotConverged(f"{message}{fault}", solution.trace, solution)
    return lawful(solution)
