"""First guesses of the zones, in the order in which they are tried.

    zones near by       zones of a similar solution, or its gaps where contact is wide
    the given zone      the one zone of a given half width
    one zone            one symmetric asperity: its half width in closed form
    a grid              a coarse contact on ever finer grids

A guess leads to a contact that passes the certificate, or to a `Failure` noted in the plan.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from contact.closed.half_width import guess_half_width, single_branch, widest
from contact.errors import ContactError, OutOfRange
from contact.formulation import claims
from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.model.units import counted
from contact.search.context import SolveContext
from contact.search.grid.nested_grids import MOST_POINTS, Proposal
from contact.search.grid.proposals import about, placed, proposed
from contact.search.grid.scaling import ScaledScene, meets_far_away
from contact.search.grid.tilt import known_part
from contact.search.options import SEARCH
from contact.search.strategies.full_contact import (
    Full,
    full_under,
    no_inverse,
    refuse_full_approach,
)
from contact.search.strategies.gaps import (
    by_gaps,
    by_gaps_if_better,
    gaps_are_better,
    record_failed_gaps,
)
from contact.search.strategies.load_controls import by_fraction
from contact.search.topology.failure import EXACT, NOT_APPLICABLE, Failure
from contact.verify.error import SolvedGaps, SolvedZones
from contact.verify.minima import SAMPLING
from sie import Array

Outcome: TypeAlias = SolvedZones | SolvedGaps | Full
Guess = Callable[[SolveContext, ScaledScene, Array | None], Outcome | Failure]


@dataclass(frozen=True)
class GuessOptions:
    """Refinement of grids, and limits beyond which a first guess is useless."""

    refinement: int = 4  # ratio of the numbers of points of successive grids
    # Full contact is tested only if the guessed zones fill more than this fraction of the period,
    # as the test takes time.
    maybe_full: float = 0.4
    # Smallest accepted gap between a zone and the border of a localized model's strip. It is
    # relative to the narrowest such gap in the table of `single_branch`. The modes of the pressure
    # do not resolve narrower gaps.
    narrowest_border_gap: float = 0.1
    # Contact is almost full if it is wider than this fraction of the largest possible width. If the
    # closed form gives a wider zone, this zone is useless as a first guess. If the search fails at
    # such a width, the error message names narrow gaps as a possible reason.
    almost_full: float = 0.99


OPTIONS = GuessOptions()

INSTEAD = (
    "use Localized('self-consistent', neighbours=4) or Periodic(), which are more accurate and "
    "allow wider contacts"
)
_AT_BORDER = (
    "a contact zone reaches the border of the known part of the profile: give the profile over a "
    "longer interval, or reduce the contact"
)
_AT_STRIP = (
    f"a contact zone reaches the border of the strip that the localized model solves; {EXACT}"
)


def search(context: SolveContext, scaled: ScaledScene, start: Array | None = None) -> Outcome:
    """The contact from the first successful guess. start: zones of a similar solution."""
    if scaled.control.approach is not None and (full := full_under(context, scaled.control)):
        return full
    refuse_full_approach(context, scaled.problem, scaled.control)
    # Whether the scene itself gives the contact width. A closure of the localized model (a rule
    # that determines the contact width) also prescribes a width, which does not count here.
    width_is_given = context.scene.given_fraction is not None
    if width_is_given and not context.single:
        return by_fraction(context, scaled)
    for name, guess in GUESSES:
        outcome = guess(context, scaled, start)
        if not isinstance(outcome, Failure):
            return outcome
        if outcome is not NOT_APPLICABLE:
            context.record_failure(name, outcome)
    if scaled.control.width is None:
        return from_grid(context, scaled)
    if not width_is_given:
        raise context.error(
            Failure("no zones with the total width that the closure prescribes were found"),
            scaled.problem,
        )
    return by_fraction(context, scaled)


def _similar_solution(
    context: SolveContext, scaled: ScaledScene, start: Array | None
) -> Outcome | Failure:
    """The contact from the zones of a similar solution; a Failure if Newton's method fails."""
    if start is None:
        return NOT_APPLICABLE
    problem, control = scaled.problem, scaled.control
    context.plan.decide("first guess", "the warm start", "a similar solution is available")
    width = float((start[:, 1] - start[:, 0]).sum())
    if gaps_are_better(context, problem, width):
        return by_gaps(context, problem, control, width, start, abandon_if_far=True)
    found = context.refine_topology(problem, control, start, abandon_if_far=True)
    if isinstance(found, Failure) and found.at_border:
        raise context.error(found, problem)
    return found


def _given_zone(
    context: SolveContext, scaled: ScaledScene, start: Array | None
) -> Outcome | Failure:
    """The contact whose only zone has the given half width."""
    a = scaled.control.half_width
    if a is None:
        return NOT_APPLICABLE
    context.plan.decide("first guess", "the given zone", "the half width is given")
    found = context.refine_topology(scaled.problem, scaled.control, np.array([[-a, a]]))
    if not isinstance(found, Failure):
        return found
    if found.at_border:
        raise context.error(found, scaled.problem)
    raise OutOfRange(
        "no contact was found with one zone of this half width and a pressure that is positive "
        f"everywhere: {found.reason}"
    )


def _one_zone(context: SolveContext, scaled: ScaledScene, start: Array | None) -> Outcome | Failure:
    """The contact of one symmetric asperity, from a guess of its only zone.

    If the guess is wide, full contact or the gaps between the periodic images are tried first.
    """
    problem, control = scaled.problem, scaled.control
    if not context.single or problem.amplitude is not None:
        return NOT_APPLICABLE
    context.plan.decide("first guess", "one zone", "the profile is one symmetric asperity")
    with context.plan.timed("zone ends"):
        guess = guess_half_width(problem, control)
    if (
        problem.period is not None
        and 2 * guess > OPTIONS.maybe_full * problem.period
        and (full := full_under(context, control))
    ):
        return full
    if gaps_are_better(context, problem, 2 * guess):
        found_by_gaps = by_gaps(context, problem, control, 2 * guess)
        if isinstance(found_by_gaps, SolvedGaps):
            return found_by_gaps
        record_failed_gaps(context, "gaps of one zone", found_by_gaps)
        if full := full_under(context, control, but_for_kinks=True):
            return full
    has_branch = control.load is not None or control.approach is not None
    # In a localized model with neighbours, contact never becomes full. A guess almost as wide as
    # the strip is useless, unless the corners of a punch limit the width. A better guess is found
    # along the branch of contacts from zero load.
    needs_branch = bool(
        has_branch
        and problem.interaction.neighbours
        and widest(problem) < problem.corners[1]
        and guess > OPTIONS.almost_full * widest(problem)
    )
    if needs_branch:
        guess = _half_width_on_branch(context, problem, control)
    found = context.refine_topology(problem, control, np.array([[-guess, guess]]))
    if isinstance(found, SolvedZones) or not has_branch:
        return found
    if found.at_border:
        raise context.error(found, problem)
    if context.scene.interaction.exact and (
        context.operator.is_periodic or not context.operator.is_plain
    ):
        return found
    if not needs_branch:
        _half_width_on_branch(context, problem, control)
    return found


def _half_width_on_branch(context: SolveContext, problem: Problem, control: Control) -> float:
    """Approximate half width of one zone, found along the branch of contacts from zero load.

    The controlled quantity grows with the width up to a maximum; a larger value raises OutOfRange.
    In a strip with neighbours there is no maximum: near the border of the strip the quantity is
    linear in the logarithm of the gap between zone and border.
    """
    with context.plan.timed("zone ends"):
        half_widths, values = single_branch(problem, control)
    highest, units = float(values[-1]), problem.units
    if control.value <= highest:
        return float(np.interp(control.value, values, half_widths))
    asked = control.described(units)
    at_most = (
        f"{highest * control.unit(units):.6g} at half width {half_widths[-1] * units.length:.6g} m"
    )
    if problem.interaction.neighbours and half_widths[-1] == widest(problem):
        border = 0.5 * problem.repeat_length
        before, last = border - half_widths[-2:]
        rate = np.log(before / last) / (highest - values[-2])
        gap = last * np.exp((highest - control.value) * rate)
        if gap > OPTIONS.narrowest_border_gap * last:
            return float(border - gap)
        raise OutOfRange(
            f"{asked} is beyond the largest value for one zone in the strip of the localized "
            f"model, {at_most}, where the zone nears the border of the strip; {EXACT}"
        )
    raise OutOfRange(
        f"{asked} is beyond the largest value on the branch from zero load, {at_most} "
        f"(interaction {context.scene.interaction.name!r})"
    )


GUESSES: tuple[tuple[str, Guess], ...] = (
    ("zones of a similar solution", _similar_solution),
    ("the given zone", _given_zone),
    ("one zone", _one_zone),
)


def from_grid(
    context: SolveContext, scaled: ScaledScene, points: int | None = None, allow_loss: bool = False
) -> Outcome:
    """The contact from the zones of a coarse grid; finer grids follow until the search succeeds.

    points: number of points of the first grid; None: as many as the profile needs. allow_loss: see
    `NewtonSettings`.
    """
    return _GridSearch(context, scaled, allow_loss).run(points)


class _GridSearch:
    """A search on finer and finer grids, which are widened if contact reaches their border."""

    def __init__(self, context: SolveContext, scaled: ScaledScene, allow_loss: bool) -> None:
        self.context, self.scaled, self.allow_loss = context, scaled, allow_loss
        self.most = SAMPLING.max_points
        # `touched`: whether contact on an earlier grid touched the border of the present search
        # interval. `widened`: number of times that the interval was widened.
        self.touched, self.widened = False, 0
        self.failure: Failure | None = None

    def run(self, points: int | None) -> Outcome:
        """The contact, from finer and finer grids. points: size of the coarsest grid."""
        context = self.context
        self._record_grid()
        proposal: Proposal | None = None
        while points is None or points <= self.most:
            proposal = self._proposed(points)
            if points is None:
                finer = min(OPTIONS.refinement * proposal.points, MOST_POINTS)
                self.most = max(self.most, finer)
            points = proposal.points
            if proposal.touches_border and context.scene.profile.support is None:
                points = self._beyond_border(points)
                continue
            found = self._from_proposal(proposal)
            if not isinstance(found, Failure):
                return found
            if found is not NOT_APPLICABLE:
                # If the profile declares a false property, such as a wrong slope, no grid leads to
                # a contact. This check raises an error before slow finer grids are tried.
                claims.of(context.scene.profile, np.asarray(proposal.zones))
                if self._is_hopeless(found, points):
                    break
            points *= OPTIONS.refinement
        raise self._error(proposal, points)

    def _record_grid(self) -> None:
        """Record the choice of a grid in the plan; raise OutOfRange if the load is not positive."""
        context, control = self.context, self.scaled.control
        part = context.plan["coarse search"]
        if not part.used:
            part.reason = "one zone did not pass the certificate"
        part.used = True
        if context.plan.decisions["first guess"].way != "a grid":
            context.plan.decide("first guess", "a grid", part.reason)
        if control.load is not None and not control.load > 0.0:
            raise OutOfRange(
                f"{control.described(self.scaled.problem.units)}: "
                f"the law {context.scene.law.name} has no `bare` law for a first guess, so that "
                "zones are searched for under loads above 0 only: give a half width"
            )

    def _proposed(self, points: int | None) -> Proposal:
        """Zones proposed by a grid of this number of points."""
        context, scaled = self.context, self.scaled
        control = scaled.control
        if context.progress is not None:
            context.progress("coarse grid", 0, None)
        part = context.plan["coarse search"]
        with context.plan.timed("coarse search"):
            proposal = proposed(scaled, control, points)
            # `grid` has the pressure at very many points. It takes much memory and is not needed
            # any more.
            proposal = replace(proposal, grid=None)
        part.detail = f"{proposal.points} points, {counted(len(proposal.zones), 'zone')} proposed"
        return proposal

    def _beyond_border(self, points: int) -> int | None:
        """Number of points of the next grid, if contact touched the border of the present grid.

        Contact on a coarse grid may touch the border because of the grid's error, so a finer grid
        is tried first. Then the window is widened: the few points of the first window may have
        missed zones outside it.
        """
        finer = OPTIONS.refinement * points
        if not self.touched and finer <= self.most:
            self.touched = True
            return finer
        wider = None if self.widened == SEARCH.max_attempts else self._wider_window()
        if wider is None:
            is_strip = self.scaled.problem.interaction.strip
            raise OutOfRange(_AT_STRIP if is_strip else _AT_BORDER)
        self.scaled, self.touched, self.widened = wider, False, self.widened + 1
        return None

    def _wider_window(self) -> ScaledScene | None:
        """The scene with the search interval doubled; None if it already is the whole profile."""
        lo, hi = self.scaled.cell
        known = known_part(self.context.scene.profile) or (-math.inf, math.inf)
        half = 0.5 * (hi - lo)
        cell = max(known[0], lo - half), min(known[1], hi + half)
        return None if cell == self.scaled.cell else replace(self.scaled, cell=cell)

    def _from_proposal(self, proposal: Proposal) -> Outcome | Failure:
        """The contact from the zones of a grid: full contact, or solved by gaps or by zones."""
        context, problem, control = self.context, self.scaled.problem, self.scaled.control
        width = proposal.width / problem.units.length
        if (
            problem.period is not None
            and width > OPTIONS.maybe_full * problem.period
            and (full := full_under(context, control))
        ):
            return full
        table, zones = placed(problem, proposal.zones), counted(len(proposal.zones), "zone")
        found_by_gaps = by_gaps_if_better(
            context,
            problem,
            control,
            width,
            table,
            strategy=f"gaps between {zones} of a grid of {proposal.points} points",
            allow_loss=self.allow_loss,
        )
        if found_by_gaps is not None:
            return found_by_gaps
        if proposal.full or not len(proposal.zones):
            return full_under(context, control, but_for_kinks=True) or NOT_APPLICABLE
        about_zones = about(problem, table)
        found = context.refine_topology(about_zones, control, table, allow_loss=self.allow_loss)
        if isinstance(found, Failure) and found.at_border:
            raise context.error(found, problem)
        return found

    def _is_hopeless(self, found: Failure, points: int) -> bool:
        """Record a failure in the plan; return whether a finer grid would fail in the same way."""
        self.context.record_failure(f"zones of a grid of {points} points", found)
        is_same = self.failure is not None and found.same(self.failure)
        self.failure = found
        return is_same or (found.unresolved and points >= SAMPLING.max_points)

    def _error(self, last: Proposal | None, points: int | None) -> ContactError:
        """The error to raise if no grid led to the contact."""
        context, problem, failure = self.context, self.scaled.problem, self.failure
        is_full = last is not None and last.full
        distance = meets_far_away(context.scene, self.scaled.cell)
        if distance is not None:
            return OutOfRange(
                "the profile levels off, and under this load the bodies also meet at a distance of "
                f"about {distance:.1g} m: give the profile an `extent`, or give a smaller load"
            )
        width = 0.0 if last is None else last.width / problem.units.length
        has_no_inverse = context.operator.is_periodic and not context.operator.has_inverse
        if is_full and has_no_inverse:
            return OutOfRange(
                no_inverse(
                    context,
                    f"contact is full, or nearer to full than a grid of {points} points resolves",
                )
            )
        if not (is_full or width):
            unseen = "the contact is narrower than the finest grid resolves; give a load"
            return context.error(failure or Failure(unseen), problem)
        if is_full and problem.interaction.strip:
            return OutOfRange(_AT_STRIP)
        narrow = "the gaps are narrower than the finest grid resolves"
        if has_no_inverse:
            narrow += (
                "; define the `symbol` of the interaction, so that the gaps can be the unknowns"
            )
            almost_full = width > OPTIONS.almost_full * (problem.period or math.inf)
            if failure is not None and almost_full:
                failure = Failure(f"{failure.reason}, and {narrow}", failure.free)
        return context.error(failure or Failure(narrow), problem)
