"""First-order closure of several zones: one scalar root for the nominal pressure.

    W(q) = W0(q L)

W(q) is the total width of the zones of the strip, under the scene's own control and the nominal
pressure q outside the strip. W0(q L) is the total width for the profile alone, cut off at the
borders of the strip, under the load q L, with L the period. Both contacts solve convex problems. W
falls with q and W0 grows, so there is one root. One evaluation solves two contacts; the root is
found by Newton's method in a bracket.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from contact.errors import OutOfRange
from contact.formulation.controls import Control, Load
from contact.formulation.problem import Problem
from contact.formulation.tolerances import TOLERANCES
from contact.localized.derivatives import (
    ContactRates,
    TwoContacts,
    middle_motion,
    spread,
    table_of,
    width_of,
)
from contact.localized.strips import no_centre
from contact.model.interactions.isolated import Isolated
from contact.search.context import SolveContext
from contact.search.grid.conjugate_gradient import Response
from contact.search.grid.nested_grids import grid_height, propose
from contact.search.grid.scaling import ScaledScene
from contact.search.options import SEARCH
from contact.search.strategies.guesses import INSTEAD
from contact.search.topology.failure import NOT_APPLICABLE, Failure
from contact.search.topology.loop import NewtonSettings, refine_topology
from contact.search.topology.pressure_form import PressureForm
from contact.verify.error import SolvedZones
from sie import Array

Strip = Callable[[Problem, Control, Array | None], SolvedZones]


@dataclass(frozen=True)
class ClosureOptions:
    """Options of the search for the nominal pressure of a strip with several zones."""

    widening: float = 1.5  # factor between trial nominal pressures while the root has no bracket
    # If Newton's steps from both ends of the bracket exceed this many bracket widths, W - W0 is
    # assumed to jump across zero. W and W0 are the total widths at the head of this module.
    jump: float = 3.0
    margin: float = 2.0  # stated error of the root, divided by its last Newton step


class SeveralZones:
    """The search for the nominal pressure; `strip` solves the strip under a trial pressure."""

    def __init__(self, context: SolveContext, scaled: ScaledScene, strip: Strip) -> None:
        self.context, self.scaled, self.strip, self.options = (
            context,
            scaled,
            strip,
            ClosureOptions(),
        )
        assert scaled.problem.period is not None
        self.period = scaled.problem.period

    def found(self, pressure: float, start: Array | None) -> SolvedZones:
        """Zones at the nominal pressure for which W = W0, by Newton's method with a bracket.
        W and W0 are the total zone widths at the head of this module.

        `pressure`: a first nominal pressure; `start`: a first guess of the zones.
        """
        low, high, before, factor = 0.0, math.inf, math.inf, self.options.widening
        at: TwoContacts | None = None
        newton = [0.0, 0.0]  # Newton's steps from the lower and the upper end of the bracket
        for _ in range(SEARCH.max_steps):
            at = self._at(pressure, start, at)
            rates = ContactRates(at)
            excess = width_of(at.strip) - width_of(at.reference)
            step = self._step(rates, excess)
            error = np.abs(self._step(rates, self._width_error(at)))
            # `error` is the step that an error of the widths causes. The search ends if `step`
            # moves the ends by no more than `error` does, or by no more than the tolerance.
            least = max(self.context.tolerance, float(rates.of_ends(error).max()))
            if float(rates.of_ends(step).max()) <= least:
                bound = np.abs(step) + error
                return self._solved(at, rates, rates.of_ends(self.options.margin * bound))
            newton[excess < 0.0] = abs(step[1])
            low, high = (pressure, high) if excess > 0.0 else (low, pressure)
            if min(newton) > self.options.jump * (high - low):
                raise no_centre(self.scaled.problem, self.scaled.control)
            bracketed, there = low > 0.0 and high < math.inf, pressure + float(step[1])
            # Bisection replaces Newton's method if Newton's steps decrease slowly. The steps may
            # even cycle, since the slope of W - W0 (difference of total widths) jumps where zones
            # come or go.
            slow = abs(step[1]) > 0.5 * before
            before = abs(step[1])
            if bracketed and (slow or not low < there < high):
                there = 0.5 * (low + high)
            elif not low < there < high:
                there = pressure * factor if excess > 0.0 else pressure / factor
            part = (there - pressure) / float(step[1]) if step[1] else 0.0
            start = spread(table_of(at.strip), rates.of_strip(part * step))
            pressure = there
        assert at is not None
        reason = f"the nominal pressure of the first-order closure did not settle; {INSTEAD}"
        raise self.context.error(Failure(reason, at.strip.free), at.strip.fields.problem)

    def _step(self, rates: ContactRates, excess: float) -> Array:
        """Newton's step of (centre, nominal pressure, load) that removes the `excess` width.

        The excess is W - W0 (head of this module).
        """
        held = np.array([0.0, 0.0, 1.0]) if self.scaled.control.load is not None else rates.approach
        by_load = np.array([[rates.by_load.sum()], [middle_motion(rates.by_load)]])
        matrix = np.vstack((np.hstack((rates.matrix, by_load)), held))
        width, pressure = width_of(rates.at.strip), float(rates.at.unknowns[1])
        if abs(matrix[0, 1]) * pressure <= TOLERANCES.rounding * width:
            raise no_isolated_load()
        return np.asarray(np.linalg.solve(matrix, [-excess, 0.0, 0.0]))

    def _solved(self, at: TwoContacts, rates: ContactRates, ends: Array) -> SolvedZones:
        """The zones of the strip, with the errors of their ends and two derivatives by the load.

        amplitude_rate: derivative of the nominal pressure by the load. centring: the part of the
        derivative of the approach by the load that comes from the motion of the strip's centre.
        """
        follows = rates.following
        fields = replace(
            at.strip.fields,
            amplitude_rate=float(follows[1]),
            centring=float(rates.approach[0] * follows[0]),
        )
        return replace(
            at.strip,
            fields=fields,
            control=self.scaled.control,
            control_error=at.strip.control_error + ends,
        )

    def _width_error(self, at: TwoContacts) -> float:
        """Bound of the error of W - W0, a difference of total zone widths (head of this module)."""
        error = 0.0
        for found in (at.strip, at.reference):
            ends = found.free.end_error + found.fields.state.end_truncation
            error += float((ends * np.diff(table_of(found), axis=1)).sum())
        return error

    def _at(self, pressure: float, start: Array | None, last: TwoContacts | None) -> TwoContacts:
        """(contact of the strip, contact of the profile without images) at one nominal pressure."""
        strip = self.strip(self.scaled.problem.with_amplitude(pressure), self.scaled.control, start)
        centre = strip.fields.problem.centre
        with self.context.plan.timed("isolated reference"):
            reference = self._reference(centre, pressure * self.period, last)
        return TwoContacts(
            np.array([centre, pressure, strip.fields.density.total]), strip, reference
        )

    def _reference(self, centre: float, load: float, last: TwoContacts | None) -> SolvedZones:
        """The contact of the profile without images, cut off at the borders of the strip."""
        problem = replace(
            self.scaled.problem,
            interaction=Isolated(),
            amplitude=None,
            reference=True,
            centre=centre,
        )
        starts = [partial(_from_grid, problem, load)]
        if last is not None:
            starts.insert(0, partial(_moved, last, problem))
        failure = NOT_APPLICABLE
        for start in starts:
            found = refine_topology(
                PressureForm(problem),
                Load(load),
                start(),
                NewtonSettings(self.context.tolerance),
                self.context.observer,
            )
            if isinstance(found, SolvedZones):
                return found
            failure = found
        reason = (
            "the isolated reference contact of the first-order closure was not found: "
            f"{failure.reason}; {INSTEAD}"
        )
        raise self.context.error(replace(failure, reason=reason), problem)


def no_isolated_load() -> OutOfRange:
    """The error that is raised if the contact width hardly depends on the isolated load."""
    return OutOfRange(
        "the first-order closure finds an isolated load from the width of the zones, but the zones "
        f"reach from corner to corner and have this width under every isolated load; {INSTEAD}"
    )


def _from_grid(problem: Problem, load: float) -> Array:
    """Contact zones of the profile without images, from a grid between the borders of the strip."""
    profile, units = problem.profile, problem.units
    left, right = units.x(np.array(problem.cut))
    found = propose(
        partial(grid_height, profile),
        (float(left), float(right)),
        Response(units.E_star, False, rest=problem.operator.strip_rest),
        resolution=None if profile.feature is None else 0.25 * profile.feature,
        load=load * units.load,
        tol=SEARCH.rough,
    )
    return np.asarray(units.scaled(found.zones))


def _moved(last: TwoContacts, problem: Problem) -> Array:
    """Zones of the profile without images, from the previous step of the search.
    Ends at the borders of the strip are moved to its new borders.
    """
    table = table_of(last.reference).copy()
    table.flat[[0, -1]] = np.where(last.cut_off, np.array(problem.cut), table.flat[[0, -1]])
    return table
