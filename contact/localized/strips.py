"""The zones of the localized model: the strip is centred on its own zones.

The strip's centre c is the middle between the outermost ends of its zones. For a given centre, the
zones are found as in any other scene, and middle(c) is the middle of these zones. The secant method
finds the root c of middle(c) - c.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from contact.errors import ContactError, OutOfRange
from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.formulation.tolerances import TOLERANCES
from contact.search.context import SolveContext
from contact.search.grid.proposals import about
from contact.search.grid.scaling import ScaledScene
from contact.search.options import SEARCH
from contact.search.strategies.guesses import INSTEAD, search
from contact.search.topology.failure import EXACT
from contact.verify.error import SolvedZones
from sie import Array


@dataclass(frozen=True)
class CentringOptions:
    """Options of the secant method for the position of the centre of a strip."""

    # Largest secant step of the centre. It is relative to the previous step or to the distance of
    # the centre from the middle of the zones, whichever is larger.
    longest_step: float = 4.0


OPTIONS = CentringOptions()


def centred(context: SolveContext, scaled: ScaledScene, start: Array | None) -> SolvedZones:
    """The contact zones of a strip whose centre is the middle of these zones."""
    problem, load = scaled.problem, scaled.control.load
    if load is not None and not context.single and not problem.interaction.follows_isolated:
        # Under a given load the nominal pressure is known, so its term joins the right side of the
        # equation. The right side gets as many modes as it needs near the border of the strip. A
        # term of unknown amplitude would get only the modes of the zones.
        problem = problem.with_amplitude(load / problem.repeat_length)
    if start is not None:
        problem = about(problem, start)
    scaled = replace(scaled, problem=problem)
    first = search(context, scaled, start)
    assert isinstance(first, SolvedZones)  # full contact does not occur in a strip
    found = _centre_strip(context, scaled, first)
    if found.fields.problem.amplitude is None or problem.interaction.follows_isolated:
        return found
    return replace(found, fields=replace(found.fields, amplitude_rate=1 / problem.repeat_length))


def _centre_strip(context: SolveContext, scaled: ScaledScene, found: SolvedZones) -> SolvedZones:
    """The zones after the strip was moved until its centre is the middle of its zones."""
    before: tuple[float, float, Array] | None = None
    offsets, stalled, failed = [math.inf], math.inf, 0
    for _ in range(SEARCH.max_steps):
        zones, centre = found.free.density.zones, found.fields.problem.centre
        width = float((zones.b - zones.a).min())
        offset = 0.0 if zones.symmetric else 0.5 * float(zones.a[0] + zones.b[-1]) - centre
        step, follows, expected, is_secant = offset, 1.0, zones.table, False
        if before is not None and before[2].shape == zones.table.shape and before[1] != offset:
            shift, is_secant = centre - before[0], True
            longest = OPTIONS.longest_step * max(abs(offset), abs(shift))
            secant = offset * shift / (before[1] - offset)
            step = min(max(secant, -longest), longest)
            rate = (zones.table - before[2]) / shift
            follows = max(float(np.abs(rate).max()) * abs(shift / (before[1] - offset)), 1.0)
            expected = zones.table + step * rate
        close = 0.1 * context.tolerance * width + float(np.spacing(abs(centre)))
        if abs(offset) * follows <= close or stalled < abs(offset) < TOLERANCES.noise * width:
            left = abs(offset) * follows / width
            return replace(found, control_error=found.control_error + left)
        # If a secant step does not reduce a small `offset` (distance from the strip's centre to the
        # middle of the zones) to a quarter, the remaining `offset` is round-off. Small means below
        # `TOLERANCES.noise` times `width`.
        stalled = 0.25 * abs(offset) if is_secant else math.inf
        offsets.append(abs(offset))
        # The search ends if `offset` has not halved within a few steps. Such a failure shows that
        # the middle of the zones jumps.
        recent = offsets[-SEARCH.max_attempts :]
        if len(offsets) > len(recent) and min(recent) > 0.5 * min(offsets[: -SEARCH.max_attempts]):
            break
        before = centre, offset, zones.table
        # The step is halved until zones are found. If this fails many times, a zone comes or goes
        # between the present centre and the wanted one.
        problem = found.fields.problem
        while True:
            there = problem.about(problem.centre + step)
            moved = context.refine_topology(there, scaled.control, expected)
            if isinstance(moved, SolvedZones):
                break
            failed += 1
            if failed > SEARCH.max_attempts:
                raise no_centre(problem, scaled.control)
            step, expected = 0.5 * step, 0.5 * (zones.table + expected)
        found = moved
    raise no_centre(scaled.problem, scaled.control)


def no_centre(problem: Problem, control: Control) -> ContactError:
    """The error to raise if no strip has its centre in the middle of its zones."""
    first = problem.interaction.follows_isolated
    closure, instead = ("first-order", INSTEAD) if first else ("self-consistent", EXACT)
    return OutOfRange(
        f"{control.described(problem.units)}: under the {closure} closure no strip is centred on "
        "its zones, since a zone beside the border of the strip appears or disappears as the strip "
        f"is moved; {instead}"
    )
