"""First-order closure: the nominal pressure of a strip follows from an isolated contact.

The nominal pressure is the load of the isolated contact divided by the period. The isolated contact
is that of one period of the profile, without images. Its zones have the same total width as those
of the strip.

For one zone the isolated solution is formal, as in the paper (Goryacheva and Tsukanov 2020): the
signs of its pressure and gap are not checked. For several zones, these signs are checked and wrong
ones are corrected.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from contact.closed.half_width import guess_half_width
from contact.errors import OutOfRange
from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.localized.derivatives import table_of
from contact.localized.one_zone import OneZoneClosure
from contact.localized.several_zones import SeveralZones
from contact.localized.strips import centred
from contact.model.interactions.periodic import Periodic
from contact.search.context import SolveContext
from contact.search.grid.proposals import proposed
from contact.search.grid.scaling import ScaledScene
from contact.search.topology.failure import EXACT, Failure, attempted
from contact.search.topology.loop import NewtonSettings, refine_topology
from contact.search.topology.pressure_form import PressureForm
from contact.verify.error import SolvedZones
from sie import Array

# Number of samples of the profile height on a zone, among which local minima are counted. If a
# minimum is missed, the search only takes longer.
SAMPLES_PER_ZONE = 2**10


def first_order(
    context: SolveContext, scaled: ScaledScene, found: SolvedZones | None = None
) -> SolvedZones:
    """Zones of the strip under the nominal pressure P0 / period of the first-order closure.
    Under the load P0, the contact without periodic images has the same total width.

    found: the zones of the same strip, solved to a larger tolerance; None if there are none.
    """

    def strip(problem: Problem, control: Control, start: Array | None) -> SolvedZones:
        return centred(context, replace(scaled, problem=problem, control=control), start)

    solve_reference = partial(_reference, context)
    if scaled.control.half_width is not None:
        guess = 2 * scaled.control.half_width
    elif context.single:
        guess = 2 * guess_half_width(scaled.problem, scaled.control)
    else:
        several = SeveralZones(context, scaled, strip)
        if found is not None:
            assert found.fields.problem.amplitude is not None
            pressure, zones = found.fields.problem.amplitude, table_of(found)
        else:
            with context.plan.timed("coarse search"):
                pressure = _about_load(scaled) / scaled.problem.repeat_length
            given = scaled.problem.with_amplitude(pressure)
            zones = table_of(strip(given, scaled.control, None))
        if not _is_asperity(scaled.problem, zones):
            return several.found(pressure, zones)
        one = OneZoneClosure(scaled.problem, strip, solve_reference, zones, context.tol)
        with context.plan.timed("isolated reference"):
            outcome: SolvedZones | Failure = attempted(
                lambda: one.found(scaled.control, float(np.ptp(zones)))
            )
        if not isinstance(outcome, Failure):
            return outcome
        if isinstance(outcome.refusal, OutOfRange):
            raise outcome.refusal
        # The search for a single zone may fail because more zones come into contact. So several
        # zones are searched for.
        context.record_failure("a single zone, sought by its width", outcome)
        return several.found(pressure, zones)
    with context.plan.timed("isolated reference"):
        return OneZoneClosure(scaled.problem, strip, solve_reference, None, context.tol).found(
            scaled.control, guess
        )


def _is_asperity(problem: Problem, zones: Array) -> bool:
    """Whether there is a single zone in which the profile has at most one local minimum."""
    if len(zones) != 1:
        return False
    inside = np.linspace(float(zones[0, 0]), float(zones[0, 1]), SAMPLES_PER_ZONE)
    height = problem.shape(inside)
    return int(np.sum((height[1:-1] < height[:-2]) & (height[1:-1] <= height[2:]))) <= 1


def _about_load(scaled: ScaledScene) -> float:
    """The scaled load; if none is given, the load of the exact periodic contact on a grid."""
    problem, control = scaled.problem, scaled.control
    if control.load is not None:
        return control.load
    exact = replace(problem, interaction=Periodic())
    return proposed(replace(scaled, problem=exact), control, None).load / problem.units.load


def _reference(
    context: SolveContext, problem: Problem, control: Control, start: Array | None
) -> SolvedZones:
    """The contact of the profile without periodic images; wrong signs are not corrected."""
    if control.half_width is not None:
        start = np.array([[-control.half_width, control.half_width]])
    assert start is not None
    middle = 0.5 * float(start[0, 0] + start[-1, 1])
    if len(start) > 1 or abs(middle) > 0.25 * float(start[0, 1] - start[0, 0]):
        problem = problem.about(middle)
    found = refine_topology(
        PressureForm(problem), control, start, NewtonSettings(context.tolerance), formal=True
    )
    if isinstance(found, Failure):
        raise context.error(
            Failure(
                "the isolated reference contact of the first-order closure was not found: "
                f"{found.reason}; {EXACT}",
                found.free,
            ),
            problem,
        )
    return found
